"""Build the FMU of a system and simulate it; write a CSV, a plot and an animation."""

import argparse
import math

from ..quantities import assignment
from .shared_arguments import SYSTEM_OR_FMU, add_robot, robot_of


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
    parser.add_argument("--stop-time", type=positive, metavar="S", help="end of the simulation in s; default: that of <experiment>")
    parser.add_argument("--step", type=positive, metavar="S", help="communication step in s, the time between rows of the CSV; default: that of <experiment>")
    parser.add_argument("--tolerance", type=positive, help="relative tolerance; default: that of <solver>")
    parser.add_argument("--solver", metavar="METHOD", help="solver method in place of the system's own")
    parser.add_argument("--fmi", type=int, choices=(2, 3), help="version of FMI; default: 2")
    parser.add_argument("--input", metavar="FILE.csv", help="inputs: a first line time,NAME,... and lines of numbers; inputs are linear between lines, and two lines of one time are a jump")
    parser.add_argument("--hold", action="store_true", help="hold the inputs from line to line instead of interpolating")
    parser.add_argument("--no-events", action="store_true", help="omit the two rows of each event, before it and after it")
    parser.add_argument("--output", nargs="+", metavar="NAME", help="variables to record in place of all outputs")
    add_robot(parser)
    parser.add_argument("-o", "--folder", default=".", metavar="FOLDER", help="folder of the results; default: the current folder")


def run(arguments):
    from ..running import run
    from ..simulation import print_results

    written = run(
        arguments.system, dict(arguments.start), arguments.folder, output=arguments.output, input=arguments.input, hold=arguments.hold, record_events=not arguments.no_events,
        solver=arguments.solver, fmi=arguments.fmi, stop_time=arguments.stop_time, step=arguments.step, tolerance=arguments.tolerance, robot=robot_of(arguments),
    )  # fmt: skip
    print_results(written)
