"""Simulate a grid or a random sample of start values and parameters, on all cores; write a Parquet file with a row for each run."""

from ..sweeping.arguments import add_sweep_arguments
from .shared_arguments import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    add_sweep_arguments(parser, "SYSTEM-sweep.parquet in the current folder")


def run(arguments):
    from ..sweeps import sweep_by_words, sweeping

    sweeping().report(lambda: sweep_by_words(arguments.system, arguments))
