"""Print the equations of a system: python3 -m show_equations LAGC FILE [--latex | --python]"""

import argparse
import sys

from .latex import latex_of
from .listing import Mistake, listing
from .sympy_script import script_of
from .text import text_of

FORMATS = {"latex": latex_of, "python": script_of, "text": text_of}


def main():
    parser = argparse.ArgumentParser(prog="scripts/show", description="Print the equations of a system as a textbook prints them.")
    parser.add_argument("lagc", help=argparse.SUPPRESS)
    parser.add_argument("system", help="a system in XML")
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--latex", action="store_const", dest="format", const="latex", help="as a LaTeX document")
    kinds.add_argument("--python", action="store_const", dest="format", const="python", help="as a script for SymPy")
    arguments = parser.parse_args()
    try:
        print(FORMATS[arguments.format or "text"](listing(arguments.lagc, arguments.system)))
    except Mistake as mistake:
        sys.exit(str(mistake))


if __name__ == "__main__":
    main()
