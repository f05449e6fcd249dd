"""Tells what is wrong with a system, or that it is right."""

from ..building import check
from .words_of_systems import SYSTEM


def arguments(parser):
    parser.add_argument("system", **SYSTEM)


def run(arguments):
    print(check(arguments.system))
