"""Finds parameters and start values with which the motion meets measurements; tells how sure they are, and writes a page and the system with the new values."""

import argparse
import sys
import warnings
from pathlib import Path

from ..quantities import assignment
from .words_of_systems import SYSTEM_OR_FMU


def bounds(text):
    name, _, ends = text.partition("=")
    if ends.count(":") != 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=LOW:HIGH with two values")
    return name, tuple(ends.split(":"))


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("data", nargs="+", metavar="DATA.csv", help="time and measured variables, and perhaps inputs, by names in the first line; several are several experiments")
    parser.add_argument("--vary", nargs="+", default=[], metavar="NAME", help="parameters and start values to be found")
    parser.add_argument("--each", nargs="+", default=[], metavar="NAME", help="start values and the like that each experiment has of its own, to be found too")
    parser.add_argument("--bounds", nargs="+", action="extend", default=[], type=bounds, metavar="NAME=LOW:HIGH", help="in place of the variables' min and max")
    parser.add_argument("--set", nargs="+", action="extend", default=[], type=assignment, metavar="NAME=VALUE", help="values to begin with, or to keep")
    parser.add_argument("--noise", nargs="+", action="extend", default=[], type=assignment, metavar="NAME=VALUE", help="standard deviations of measured variables")
    parser.add_argument("--loss", default="linear", metavar="LOSS", help="soft_l1, huber or cauchy for data with outliers, in place of squares")
    parser.add_argument("-o", "--output", default=".", metavar="FOLDER", help="for NAME-fit.html and NAME-fit.xml")


def run(arguments):
    from ..fitting import fit

    warnings.filterwarnings("ignore", "misfit: ")  # which is printed with the values
    found = fit(arguments.system, arguments.data, arguments.vary, dict(arguments.set), dict(arguments.bounds), dict(arguments.noise), arguments.each, arguments.loss)
    print(found)
    folder = Path(arguments.output)
    folder.mkdir(parents=True, exist_ok=True)
    print(found.write_page(folder / f"{found.name}-fit.html").resolve())
    if found.system is not None and found.system.suffix == ".xml":
        print(found.write_system(folder / f"{found.name}-fit.xml").resolve())
    if not found.is_finished:
        sys.exit(130)
