"""Writes a page in which the FMU of a system runs, in any browser and without a network, with its parameters and inputs at hand."""

from .words_of_systems import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("--edit", action="store_true", help="the system can be changed in the page, which derives it anew")
    parser.add_argument("-o", "--output", metavar="PAGE.html", help="the page; else NAME.html, or with --edit NAME-edit.html, in the current folder")


def run(arguments):
    from ..pages import live

    print(live(arguments.system, arguments.output, arguments.edit).resolve())
