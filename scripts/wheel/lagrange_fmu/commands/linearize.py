"""Linearize a system at a point: print the matrices A, B, C, D and the eigenvalues of A, in independent states if there are constraints."""

from ..quantities import assignment
from .shared_arguments import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("--at", nargs="+", action="extend", default=[], type=assignment, metavar="NAME=VALUE", help="coordinates, velocities and inputs of the point; default: their start values")
    parser.add_argument("--set", nargs="+", action="extend", default=[], type=assignment, metavar="NAME=VALUE", help="values of parameters; default: their start values")


def table(name, matrix, rows, columns):
    """Return a matrix as text, with names of its rows and columns."""
    cells = [[name, *columns], *([row, *(f"{value + 0.0:.9g}" for value in line)] for row, line in zip(rows, matrix))]
    widths = [max(map(len, column)) for column in zip(*cells)]
    return "\n".join("  ".join([line[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(line[1:], widths[1:]))]) for line in cells)


def text_of(found):
    """Return a linearization as text."""
    import numpy as np

    from ..linearization import values_as_text

    parts = ["at " + ", ".join(values_as_text(found.point))]
    if found.constraints:
        parts.append(f"contacts that stay closed and frictions that stay stuck: {', '.join(found.constraints)}")
    rates = [f"der({state})" for state in found.states]
    for name, matrix, rows, columns in (
        ("A", found.A, rates, found.states),
        ("B", found.B, rates, found.inputs),
        ("C", found.C, found.outputs, found.states),
        ("D", found.D, found.outputs, found.inputs),
    ):
        if matrix.size:
            parts.append(f"\n{table(name, matrix, rows, columns)}")
    parts.append("\neigenvalues of A: " + ", ".join(f"{value:.6g}" for value in np.linalg.eigvals(found.A)))
    return "\n".join(parts)


def run(arguments):
    from ..linearization import linearize

    print(text_of(linearize(arguments.system, dict(arguments.at + arguments.set))))
