"""Show the reference of the language, or its paragraphs about a word, such as stop or inertia."""

import pydoc
import sys


def arguments(parser):
    parser.add_argument("word", nargs="?", metavar="WORD", help="an element, attribute or function; default: show the whole reference")


def run(arguments):
    from ..reference import words

    text = words(arguments.word)
    if sys.stdout.isatty():
        pydoc.pager(text)
    else:
        print(text)
