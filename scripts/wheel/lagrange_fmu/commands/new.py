"""Writes NAME.xml, a system with comments to begin with."""

from ..building import new


def arguments(parser):
    parser.add_argument("name", metavar="NAME")


def run(arguments):
    path = new(arguments.name)
    print(f"{path} is a pendulum to begin with; next: lagrange-fmu run {path}")
