"""Simulate a grid or a random sample of start values and parameters, on all cores; write a Parquet file with a row for each run."""

from ..sweep_words import sweep_words
from .words_of_systems import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    sweep_words(parser, "SYSTEM-sweep.parquet in the current folder")


def run(arguments):
    from ..sweeps import sweep_by_words, sweeping

    sweeping().report(lambda: sweep_by_words(arguments.system, arguments))
