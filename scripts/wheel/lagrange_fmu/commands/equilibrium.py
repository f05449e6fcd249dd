"""Find an equilibrium of a system near a guess; print the point, and its stability by the eigenvalues of the linearization."""

from ..quantities import assignment
from .shared_arguments import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("guess", nargs="*", type=assignment, metavar="NAME=VALUE", help="initial guess, and parameters; default: their start values")
    parser.add_argument("--hold", nargs="+", action="extend", default=[], type=assignment, metavar="NAME=VALUE", help="values at the equilibrium: of coordinates, states, outputs")
    parser.add_argument("--vary", nargs="+", action="extend", default=[], metavar="NAME", help="inputs and parameters to find, too")


def run(arguments):
    from .. import equilibrium

    print(equilibrium(arguments.system, dict(arguments.guess), hold=dict(arguments.hold), vary=arguments.vary))
