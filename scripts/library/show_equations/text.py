"""Print a listing as plain text, in lines that fit into a terminal."""

import re
import textwrap

from .listing import Equation, DerivationStep

WIDTH = 110


def wrapped(text, indent="", further="    "):
    """Break a text at blanks; an equation is broken before the signs of its terms where it can."""
    return textwrap.fill(text, WIDTH, initial_indent=indent, subsequent_indent=indent + further, break_long_words=False, break_on_hyphens=False)


def equation_lines(equation):
    """Yield the lines of an equation: its label, and both sides with line breaks between terms."""
    label = f"{equation.label}: " if equation.label else ""
    parts = re.split(r" (?=[+-] )", f"{equation.left} = {equation.right}")
    line = f"  {label}{parts[0]}"
    for part in parts[1:]:
        if len(line) + len(part) >= WIDTH:
            yield line
            line = f"      {part}"
        else:
            line += f" {part}"
    yield line


def text_of(listing):
    lines = [listing.name + (f": {listing.description}" if listing.description else "")]
    for heading, entries in listing.sections.items():
        lines += ["", heading, "-" * len(heading)]
        for entry in entries:
            if isinstance(entry, Equation):
                lines += equation_lines(entry)
            elif isinstance(entry, DerivationStep):
                lines += ["", entry.title]
            else:
                lines.append(wrapped(entry.text, further=""))
    if listing.multipliers:
        lines += ["", wrapped("Multipliers: " + ", ".join(f"{force} is λ of {name}" for force, name in listing.multipliers.items()) + ".", further="")]
    return "\n".join([*lines, "", f"Derived by lagrange-fmu {listing.version}."])
