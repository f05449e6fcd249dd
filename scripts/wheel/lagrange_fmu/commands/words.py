"""Shows the reference of the language; with a word, such as stop or inertia, what it says about that."""

import pydoc
import sys


def arguments(parser):
    parser.add_argument("word", nargs="?", metavar="WORD", help="an element, attribute or function")


def run(arguments):
    from ..reference import words

    text = words(arguments.word)
    if sys.stdout.isatty():
        pydoc.pager(text)
    else:
        print(text)
