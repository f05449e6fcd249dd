"""Writes NAME.xml, a system with comments to begin with."""

from ..building import TEMPLATES, new


def arguments(parser):
    parser.add_argument("name", metavar="NAME")
    parser.add_argument("--template", choices=TEMPLATES, default="pendulum", help="what to begin with; the pendulum where none is given")


def run(arguments):
    path = new(arguments.name, arguments.template)
    print(f"{path} is a {arguments.template} to begin with; next: lagrange-fmu run {path}")
