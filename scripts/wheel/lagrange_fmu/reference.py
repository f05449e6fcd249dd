"""Search the reference of the language for a word."""

import re
from pathlib import Path

from .problem import Problem
from .variables import nearest

REFERENCE = Path(__file__).resolve().parent / "reference.md"


def about(word, text):
    """
    Return the paragraphs and rows of tables that contain the word, each group under its heading.

    A code block directly after such a paragraph is its example and is returned, too.
    """
    found, heading, shown, follows = [], None, None, False
    for block in re.split(r"\n{2,}(?![^`]*\n```(?:\n|$))", text):
        if block.startswith("#"):
            heading, _, block = block.partition("\n")
        has = re.search(rf"(?<!\w){re.escape(word)}(?!\w)", block)
        if has or (follows and block.startswith("```")):
            if heading != shown:
                found.append(heading)
                shown = heading
            lines = block.split("\n")
            rows = [line for line in lines if not line.startswith("|") or re.search(rf"(?<!\w){re.escape(word)}(?!\w)", line)]
            found.append("\n".join(rows))
        follows = bool(has)
    return "\n\n".join(found)


def words(word=None):
    """See lagrange_fmu.words."""
    text = REFERENCE.read_text(encoding="utf-8")
    if word is None:
        return text
    found = about(word.strip("<>/"), text)
    if not found:
        near = nearest(word, dict.fromkeys(re.findall(r"[A-Za-z]\w{2,}", text)))
        remedy = f"did you mean '{near}'?" if near else "lagrange-fmu words shows all of it"
        raise Problem(f"the reference says nothing about '{word}'; {remedy}")
    return found
