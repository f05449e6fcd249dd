"""Fit parameters and start values to measurements; print them with standard deviations, and write a page and the fitted system."""

import argparse
import sys
import warnings
from pathlib import Path

from ..quantities import assignment
from .shared_arguments import SYSTEM_OR_FMU


def bounds(text):
    name, _, ends = text.partition("=")
    if ends.count(":") != 1:
        raise argparse.ArgumentTypeError(f"'{text}' has no two bounds; expected NAME=LOW:HIGH")
    return name, tuple(ends.split(":"))


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("data", nargs="+", metavar="DATA.csv", help="measurements, a file for each experiment; the first line names the columns: time, measured variables and inputs")
    parser.add_argument("--vary", nargs="+", default=[], metavar="NAME", help="parameters and start values to fit for all experiments together")
    parser.add_argument("--each", nargs="+", default=[], metavar="NAME", help="start values, parameters or inputs to fit for each experiment separately")
    parser.add_argument("--bounds", nargs="+", action="extend", default=[], type=bounds, metavar="NAME=LOW:HIGH", help="bounds of fitted values; default: min and max of the variables")
    parser.add_argument("--set", nargs="+", action="extend", default=[], type=assignment, metavar="NAME=VALUE", help="initial guesses of fitted values, and values of other variables")
    parser.add_argument("--noise", nargs="+", action="extend", default=[], type=assignment, metavar="NAME=VALUE", help="standard deviations of measured variables")
    parser.add_argument("--loss", default="linear", metavar="LOSS", help="loss function for data with outliers: soft_l1, huber or cauchy; default: linear, the sum of squares")
    parser.add_argument("-o", "--output", default=".", metavar="FOLDER", help="folder of NAME-fit.html and NAME-fit.xml; default: the current folder")


def run(arguments):
    from ..fitting import fit

    warnings.filterwarnings("ignore", "misfit: ")  # printed with the values
    found = fit(arguments.system, arguments.data, arguments.vary, dict(arguments.set), dict(arguments.bounds), dict(arguments.noise), arguments.each, arguments.loss)
    print(found)
    folder = Path(arguments.output)
    folder.mkdir(parents=True, exist_ok=True)
    print(found.write_page(folder / f"{found.name}-fit.html").resolve())
    if found.system is not None and found.system.suffix == ".xml":
        print(found.write_system(folder / f"{found.name}-fit.xml").resolve())
    if not found.is_finished:
        sys.exit(130)
