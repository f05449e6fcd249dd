"""Builds the FMU of a system and simulates it; leaves a CSV, a plot and an animation."""

from .words_of_systems import SYSTEM_OR_FMU, add_output


def start_value(text):
    from ..simulation import start_value

    return start_value(text)


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("start", nargs="*", type=start_value, metavar="VARIABLE=VALUE", help="start values")
    add_output(parser, "the results go")


def run(arguments):
    from ..running import run
    from ..simulation import print_results

    print_results(run(arguments.system, dict(arguments.start), arguments.output))
