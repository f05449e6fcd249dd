"""Builds the FMU of a system, and prints where it is."""

from ..building import NATIVE, build
from ..runtime.scripts.cross import PLATFORM_NAMES
from .words_of_systems import SYSTEM, add_fmi, add_output


def arguments(parser):
    parser.add_argument("system", **SYSTEM)
    parser.add_argument("--platforms", nargs="+", metavar="PLATFORM", help=f"of {', '.join(PLATFORM_NAMES)}; {NATIVE} where none are given")
    parser.add_argument("--solver", metavar="METHOD", help="in place of the system's own")
    parser.add_argument("--arrays", action="store_true", help="what <for> makes are arrays in FMI 3.0, not scalars")
    add_fmi(parser)
    add_output(parser, "the FMU goes")


def run(arguments):
    print(build(arguments.system, arguments.platforms, arguments.solver, arguments.output, arguments.fmi, arguments.arrays))
