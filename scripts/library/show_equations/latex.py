"""Print a listing as a LaTeX document, which needs amsmath alone. The formulas are those of lagc, see modelDescription/page/latex.h."""

import re

from .expression import is_cut
from .listing import DerivationStep, Equation

LINE = 75  # approximate length of a line of an equation, in characters

# Characters of texts that have a special meaning in LaTeX, or none.
SPECIAL = {"\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "_": r"\_", "^": r"\^{}", "&": r"\&", "%": r"\%", "#": r"\#", "$": r"\$", "~": r"\~{}", "<": "$<$", ">": "$>$",
           "λ": r"$\lambda$", "ω": r"$\omega$", "″": "$''$", "′": "$'$", "ᵀ": r"$^{T}$", "°": r"$^{\circ}$"}  # fmt: skip


def plain(text):
    """Return the text with the special characters of LaTeX escaped."""
    return "".join(SPECIAL.get(letter, letter if letter.isascii() else "?") for letter in text)


def parts_of(formula):
    """Return the terms of both sides of an equation, each with the sign before it."""
    parts, depth = [""], 0
    for word in formula.split(" "):
        if depth == 0 and word in ("+", "-", "="):
            parts.append("")
        parts[-1] += f" {word}" if parts[-1] else word
        depth += len(re.findall(r"[{(]", word)) - len(re.findall(r"[)}]", word))
    return parts


def length(part):
    """Return about how many letters of a formula are visible."""
    return len(re.sub(r"\\(left|right|frac|mathrm|operatorname|dot|,)|[{}\\ ]", "", part))


def equation(formula):
    """Return an equation, with line breaks between terms."""
    lines, room = [], 0
    for part in parts_of(formula):
        if lines and length(part) <= room:
            lines[-1] += f" {part}"
        else:
            lines.append((r"& \quad " if lines else "& ") + part)
            room = LINE
        room -= length(part)
    return [r"\begin{align*}", " \\\\\n".join(lines), r"\end{align*}"]


def latex_of(listing):
    lines = [r"\documentclass{article}", r"\usepackage{amsmath}", r"\allowdisplaybreaks", r"\begin{document}", rf"\section*{{{plain(listing.name)}}}", plain(listing.description)]
    for heading, entries in listing.sections.items():
        lines += ["", rf"\subsection*{{{plain(heading)}}}"]
        for entry in entries:
            if isinstance(entry, DerivationStep):
                lines += ["", rf"\subsubsection*{{{plain(entry.title)}}}"]
            elif not isinstance(entry, Equation):
                lines += ["", plain(entry.text)]
            elif not entry.latex or is_cut(entry.left) or is_cut(entry.right):
                lines += ["", plain(f"{entry.label or entry.left[:60]}: an equation that is too long to be shown.")]
            else:
                lines += ["", rf"\noindent {plain(entry.label)}"] if entry.label else [""]
                lines += equation(entry.latex)
    return "\n".join([*lines, "", rf"\medskip\noindent Derived by lagrange-fmu {listing.version}.", r"\end{document}"])
