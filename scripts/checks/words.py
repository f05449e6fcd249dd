"""
Find words, sentences and paragraphs that src/STYLE.md excludes, in pages, in comments of C and Python, and in the last commit's subject.
Find functions that comments name and no code has, and messages of lagc without a remedy. Print each with its place and what to write instead; the status is 1 if there are any.
"""

import io
import re
import subprocess
import sys
import textwrap
import tokenize
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("fmu", "src", "include", "modelDescription", "scripts", "tests")
LONGEST_SENTENCE = 25  # words
MOST_SENTENCES = 4  # of a paragraph of a page
LONGEST_SUBJECT = 60  # characters
INSTEAD = {
    r"(is|are|was|were|be|been) told": "reported, or determined",
    r"tells? (of|what|how|which|whether|where|when)": "reports, shows or says",
    r"to be had": "available",
    r"any more": "nothing: comments speak of the present",
    r"without end(?! \((Zeno|chatter))": "endlessly, or Zeno behaviour",
    r"whether what": "a noun in place of the clause",
    r"behind which": "followed by",
}

NAMES = {
    r"told|untold|tells?": "report, determine or show",
    r"settle[sd]?|settlement": "resolve or resolution",
    r"situations?": "snapshot",
    r"refuse[sd]?|refusals?": "reject or report",
    r"held": "constrained, closed, fixed or sticking",
    r"pushes": "impulses or forces",
    r"turned": "rotated",
    r"oblique": "nonsymmetric",
    r"mobility": "inverse mass or Delassus matrix",
    r"bordered": "constrained",
    r"stillness": "regularization",
    r"promised|crawls?": "predicted or stagnation",
    r"facts": "metadata",
    r"openers?": "guard conditions",
    r"gathered|crowded": "Zeno counters",
    r"wished": "options or requested",
    r"go_on|goes_on": "continue",
}


def wrong_words(text):
    for words, instead in INSTEAD.items():
        for match in re.finditer(rf"\b({words})\b", text, re.IGNORECASE):
            yield f"'{match[0]}'", instead


def c_comments(source):
    for match in re.finditer(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', source, re.DOTALL):
        if not match[0].startswith('"'):
            yield source.count("\n", 0, match.start()) + 1, match[0]


def python_comments(source):
    """Comments, and strings that are statements."""
    before = tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and before in (tokenize.NEWLINE, tokenize.INDENT, tokenize.ENCODING)):
            yield token.start[0], token.string
        if token.type not in (tokenize.COMMENT, tokenize.NL):
            before = token.type


@cache
def comments_of(path):
    """Return the comments of a file of C, JavaScript or Python, with the numbers of their first lines."""
    return list((python_comments if path.suffix == ".py" else c_comments)(path.read_text()))


def wrong_names(source):
    """Yield the names in code that have a word of NAMES, with the line of the first use. Comments and strings are ignored."""
    found = {}
    for match in re.finditer(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|(?://|#)[^\n]*|/\*.*?\*/|[A-Za-z_]\w*', source, re.DOTALL):
        if match[0][0].isalpha() or match[0][0] == "_":
            found.setdefault(match[0], source.count("\n", 0, match.start()) + 1)
    for name, number in found.items():
        words = "_".join(re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name)).lower()
        for pattern, instead in NAMES.items():
            if re.search(rf"(^|_)({pattern})(_|$)", words):
                yield number, f"the name '{name}'", instead


def messages_without_remedy(source):
    """Messages of lagc that neither say what to write instead nor get it by a last %s, with their lines."""
    literal = r'"(?:\\.|[^"\\\n])*"'
    for match in re.finditer(rf"\b(?:report_error|report_warning|report_at|FAIL)\([^;\"]*?((?:{literal}\s*)+)", source):
        message = "".join(text[1:-1] for text in re.findall(literal, match[1]))
        if len(message.split()) > 2 and not re.search(r"; |found %s|does%s|%s$", message):
            yield source.count("\n", 0, match.start(1)) + 1, f"the message '{message}'", "what to write instead after a semicolon"


ITEM = r"\s*([-*]|\d+\.) "


def paragraphs(page):
    """Yield the paragraphs and list items of a page with their first lines, without code, tables and headings."""
    lines, fenced = page.split("\n"), False
    text, start = [], 0
    for number, line in enumerate([*lines, ""], 1):
        fence = line.lstrip().startswith("```")
        fenced ^= fence
        is_item = re.match(ITEM, line) and not fenced
        is_other = fence or fenced or not line.strip() or re.match(r"(    |\t|\||#|<|!\[)", line)
        if text and (is_other or is_item):
            yield start, " ".join(text)
            text = []
        if is_item or not is_other:
            start = start if text else number
            text.append(line.strip())


def paragraphs_of_comment(comment):
    """Yield the paragraphs of a comment with their first lines. Each line that is indented further, such as a formula, is one of its own."""
    lines = [re.sub(r"^\s*(/\*+|\*/|\* |\*$|//|#|\"\"\")|(\*/|\"\"\")$", "", line) for line in comment.split("\n")]
    lines[1:] = textwrap.dedent("\n".join(lines[1:])).split("\n")
    text, start = [], 0
    for number, line in enumerate([lines[0].strip(), *lines[1:], ""]):
        is_separate = line.startswith(" ") or re.match(ITEM, line)
        if text and (is_separate or not line.strip()):
            yield start, " ".join(text)
            text = []
        if line.strip():
            start = start if text else number
            text.append(line.strip())


def sentences(text):
    return [sentence for sentence in re.split(r"(?<=[.!?])\s+", text) if sentence]


def word_count(sentence):
    """Return the number of words; code is one word, formulas and numbers are none."""
    prose = re.sub(r"\]\([^)]*\)", "]", re.sub(r"`[^`]*`", "code", sentence))
    return len(re.findall(r"\b[A-Za-z][\w'’./-]*[A-Za-z]\b(?!\()|\ba\b", prose))


def long_sentences(paragraphs):
    for number, text in paragraphs:
        for sentence in sentences(text):
            if word_count(sentence) > LONGEST_SENTENCE:
                yield number, f"a sentence of {word_count(sentence)} words", "two sentences"


def faults_of_page(page):
    for number, text in paragraphs(page):
        if len(sentences(text)) > MOST_SENTENCES and not re.match(ITEM, text):
            yield number, f"a paragraph of {len(sentences(text))} sentences", "a list, a table, or two paragraphs"
    yield from long_sentences(paragraphs(page))
    for number, line in enumerate(page.split("\n"), 1):
        yield from ((number, *fault) for fault in wrong_words(line))


def faults_of(path):
    text = path.read_text()
    if path.suffix == ".md":
        yield from faults_of_page(text)
    else:
        for number, comment in comments_of(path):
            yield from ((number, *fault) for fault in wrong_words(comment))
            yield from ((number + line, *fault) for line, *fault in long_sentences(paragraphs_of_comment(comment)))
        if {"compiler", "import"} & set(path.parts) and path.suffix == ".c":
            yield from messages_without_remedy(text)
        code = re.sub(r'(?s)""".*?"""', lambda match: "\n" * match[0].count("\n"), text)
        yield from ((number, name, instead) for number, name, instead in wrong_names(code) if "tests" not in path.parts or "held" not in name)


def files():
    yield from ROOT.glob("*.md")
    for folder in FOLDERS:
        for suffix in ("md", "py", "c", "h", "js"):
            yield from (ROOT / folder).rglob(f"*.{suffix}")


def missing_functions(paths):
    """Functions that comments name as NAME() and no code has."""
    words, named = set(), []
    for path in paths:
        text = path.read_text()
        for number, comment in comments_of(path):
            text = text.replace(comment, "", 1)
            lines = enumerate(comment.split("\n"), number)
            named += [(path, line, name) for line, part in lines for name in re.findall(r"\b(\w+)\(\)", part) if not name.endswith("_NAME")]
        words.update(re.findall(r"\w+", text))
    return [(path, number, f"{name}(), which does not exist", "the present name") for path, number, name in named if name not in words]


def fault_of_subject():
    subject = subprocess.run(["git", "log", "-1", "--format=%s"], cwd=ROOT, capture_output=True, text=True).stdout.strip()
    if len(subject) > LONGEST_SUBJECT or ": " in subject:
        yield f"the last commit: '{subject}'", f"at most {LONGEST_SUBJECT} characters and one clause"


def main():
    paths = [path for path in sorted(files()) if path.name != "STYLE.md"]
    found = [(path, *fault) for path in paths for fault in faults_of(path)] + missing_functions([path for path in paths if path.suffix != ".md"])
    faults = [(f"{path.relative_to(ROOT)}:{number}: {what}", instead) for path, number, what, instead in found]
    faults += fault_of_subject()
    for what, instead in faults:
        print(f"{what}; write {instead}")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
