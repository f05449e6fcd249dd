"""Declare the arguments of a sweep on a command line. Also a module of the wheel."""

import argparse
from pathlib import Path


def variation(text):
    """
    Parse NAME=FROM:TO:COUNT, NAME=FROM:TO (for --random) or NAME=VALUE,VALUE,...

    Return the name, and a tuple (FROM, TO, COUNT or None) or a list of values, all as texts.
    """
    name, separator, values = text.partition("=")
    try:
        if not separator:
            raise ValueError
        if ":" not in values:
            return name, values.split(",")
        first, last, *count = values.split(":")
        if len(count) > 1 or (count and int(count[0]) < 1):
            raise ValueError
        return name, (first, last, int(count[0]) if count else None)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not a range; expected NAME=FROM:TO:COUNT or NAME=VALUE,VALUE,...") from None


def add_sweep_arguments(parser, output):
    """Declare the arguments; `output` describes the default file."""
    parser.add_argument("--vary", action="append", type=variation, required=True, metavar="NAME=FROM:TO:COUNT",
                        help="range of a start value or parameter, or NAME=VALUE,VALUE,...; several make a grid; theta0 is the start value of theta")  # fmt: skip
    parser.add_argument("--random", type=int, metavar="RUNS", help="number of runs of a random sample from the ranges NAME=FROM:TO, in place of a grid")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random sample")
    parser.add_argument("--stop-time", "--stop", type=float, metavar="S", help="end of each run in s; default: that of the FMU")
    parser.add_argument("--step", type=float, metavar="S", help="communication step in s; default: the whole run")
    parser.add_argument("--tolerance", type=float, help="relative tolerance; default: that of the FMU")
    parser.add_argument("--record", action="append", metavar="ITEM,...", help="columns beside the states at the end: NAME.max, NAME.min, NAME@end, NAME@TIME, events, events.first; of a single contact NAME.events, NAME.first")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="address of a Dask cluster; default: a thread for each core")
    parser.add_argument("--output", type=Path, metavar="FILE.parquet", help=f"file to write; default: {output}")
