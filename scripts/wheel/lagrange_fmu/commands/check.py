"""Tells what is wrong in the file of a system, or that it is right; start values are tried by run."""

from ..building import check
from .words_of_systems import SYSTEM


def arguments(parser):
    parser.add_argument("system", **SYSTEM)


def run(arguments):
    print(check(arguments.system))
