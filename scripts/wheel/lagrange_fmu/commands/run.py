"""Builds the FMU of a system and simulates it; leaves a CSV, a plot and an animation."""

import argparse
import math

from ..quantities import assignment
from .words_of_systems import SYSTEM_OR_FMU


def positive(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is not a positive number")
    return value


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("start", nargs="*", type=assignment, metavar="NAME=VALUE", help="start values and parameters, such as l=0.5, l=20cm or theta=pi/2")
    parser.add_argument("--stop-time", type=positive, metavar="S", help="when it ends; else as the system's <experiment> says")
    parser.add_argument("--step", type=positive, metavar="S", help="the communication step, at whose ends the CSV has rows; else as the experiment says")
    parser.add_argument("--tolerance", type=positive, help="the relative tolerance; else as the system's <solver> says")
    parser.add_argument("--solver", metavar="METHOD", help="in place of the system's own")
    parser.add_argument("--fmi", type=int, choices=(2, 3), help="the version of FMI; 2 where none is given")
    parser.add_argument("--input", metavar="FILE.csv", help="the inputs: first line time,NAME,..., then numbers; linear between the lines, two lines of one time are a jump")
    parser.add_argument("--hold", action="store_true", help="the values of the input are held from line to line instead")
    parser.add_argument("--no-events", action="store_true", help="no rows at events, of which each has one before and one behind it")
    parser.add_argument("--output", nargs="+", metavar="NAME", help="the variables to record, in place of all outputs")
    parser.add_argument("-o", "--folder", default=".", metavar="FOLDER", help="where the results go; else the current folder")


def run(arguments):
    from ..running import run
    from ..simulation import print_results

    written = run(
        arguments.system, dict(arguments.start), arguments.folder, output=arguments.output, input=arguments.input, hold=arguments.hold, record_events=not arguments.no_events,
        solver=arguments.solver, fmi=arguments.fmi, stop_time=arguments.stop_time, step=arguments.step, tolerance=arguments.tolerance,
    )  # fmt: skip
    print_results(written)
