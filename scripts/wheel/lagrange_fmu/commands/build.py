"""Build the FMU of a system, and print its path."""

from ..building import NATIVE, build
from ..runtime.scripts.package.cross import PLATFORM_NAMES
from .shared_arguments import SYSTEM, add_fmi, add_output, add_robot, robot_of


def arguments(parser):
    parser.add_argument("system", **SYSTEM)
    parser.add_argument("--platforms", nargs="+", metavar="PLATFORM", help=f"platforms of the FMU: {', '.join(PLATFORM_NAMES)}; default: {NATIVE}")
    parser.add_argument("--solver", metavar="METHOD", help="solver method in place of the system's own")
    parser.add_argument("--arrays", action="store_true", help="declare the variables that <for> repeats as arrays, in FMI 3.0")
    add_robot(parser)
    add_fmi(parser)
    add_output(parser, "the FMU")


def run(arguments):
    print(build(arguments.system, arguments.platforms, arguments.solver, arguments.output, arguments.fmi, arguments.arrays, robot_of(arguments)))
