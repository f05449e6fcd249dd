"""Read what `lagc --equations` prints: the variables of a system and the sections of its documentation with equations."""

import subprocess
import sys
from typing import NamedTuple


class Variable(NamedTuple):
    name: str
    unit: str
    start: float
    description: str


class Equation(NamedTuple):
    label: str  # the coordinate or the constraint; "" for values
    left: str
    right: str
    latex: str  # of both sides; "" if they are too long


class Text(NamedTuple):
    text: str


class DerivationStep(NamedTuple):
    title: str


class Listing(NamedTuple):
    name: str
    description: str
    version: str
    variables: dict  # lists of Variable by their kind: parameter, input, coordinate, velocity, state
    multipliers: dict  # constraint by the name of its force
    switches: dict  # (contact or friction, its mode) by the name of the constraint
    sections: dict  # lists of Equation, Text and DerivationStep by heading


def listing_of(text):
    """Return the Listing of lagc's lines."""
    system, sections, multipliers, switches = None, {}, {}, {}
    variables = {kind: [] for kind in ("parameter", "input", "coordinate", "velocity", "state")}
    for line in text.splitlines():
        kind, *fields = line.split("\t")
        if kind == "system":
            system = fields
        elif kind in variables:
            variables[kind].append(Variable(fields[0], fields[1], float(fields[2]), fields[3]))
        elif kind == "multiplier":
            multipliers[fields[0]] = fields[1]
        elif kind in ("contact", "friction"):
            switches[fields[0]] = (kind, fields[1])
        elif kind == "heading":
            section = sections.setdefault(fields[0], [])
        elif kind == "equation":
            section.append(Equation(*fields))
        elif kind == "line":
            section.append(Equation("", *fields))
        else:
            section.append({"text": Text, "step": DerivationStep}[kind](fields[0]))
    return Listing(*system, variables, multipliers, switches, sections)


class Mistake(Exception):
    """The file of a system has mistakes; the text is lagc's messages."""


def listing(lagc, system):
    """Return the Listing of a system's file. Raise Mistake if it has mistakes; warnings of lagc go to stderr."""
    result = subprocess.run([lagc, "--equations", system], capture_output=True, text=True, encoding="utf-8")
    if result.returncode != 0:
        raise Mistake(result.stderr.strip())
    print(result.stderr, end="", file=sys.stderr)
    return listing_of(result.stdout)
