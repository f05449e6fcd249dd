"""Print the equations of a system and their derivation as a textbook does: as text, as a LaTeX document, or as a script for SymPy."""

from ..quantities import assignment
from .shared_arguments import SYSTEM


def arguments(parser):
    parser.add_argument("system", **SYSTEM)
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--latex", action="store_true", help="print a LaTeX document")
    kinds.add_argument("--python", action="store_true", help="print a script for SymPy, which solves the equations for the accelerations")
    parser.add_argument("--linear", nargs="*", type=assignment, metavar="NAME=VALUE", help="add an equilibrium near the start values, or near these, and A, B, C, D and eigenvalues there; builds the FMU")


def linear_text(system, guess):
    """Return an equilibrium near the guess, and the linearization there, as text."""
    from .. import equilibrium
    from ..linearization import linearize
    from .linearize import text_of

    rest = equilibrium(system, dict(guess))
    return f"Equilibrium near the start\n--------------------------\n{rest}\n\nLinearized there\n----------------\n{text_of(linearize(system, rest.point))}"


def run(arguments):
    from ..building import system_file
    from ..language import LAGC
    from ..problem import Problem
    from ..show_equations.latex import latex_of
    from ..show_equations.listing import Mistake, listing
    from ..show_equations.sympy_script import script_of
    from ..show_equations.text import text_of

    formatted = latex_of if arguments.latex else script_of if arguments.python else text_of
    if arguments.linear is not None and formatted is not text_of:
        raise Problem("--linear goes with plain text; leave out --latex and --python")
    try:
        print(formatted(listing(LAGC, system_file(arguments.system))))
    except Mistake as mistake:
        raise Problem(str(mistake)) from None
    if arguments.linear is not None:
        print(f"\n{linear_text(arguments.system, arguments.linear)}")
