"""Simulate an FMU with FMPy and write a CSV, a plot and an animation: run.py FMU [NAME=VALUE ...] [OPTIONS]"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from scripts.library.problem import Problem
from scripts.library.quantities import assignment
from scripts.library.simulation import print_results, simulate, write_motion


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path, help="the FMU")
    parser.add_argument("start", nargs="*", type=assignment, metavar="NAME=VALUE", help="start values and parameters")
    parser.add_argument("--stop-time", type=float, metavar="S", dest="stop_time", help="end of the simulation in s; default: that of <experiment>")
    parser.add_argument("--step", type=float, metavar="S", dest="output_interval", help="communication step in s; default: that of <experiment>")
    parser.add_argument("--no-events", action="store_false", dest="record_events", help="omit the two rows of each event")
    arguments = vars(parser.parse_args())
    fmu, start = arguments.pop("fmu"), dict(arguments.pop("start"))
    options = {name: value for name, value in arguments.items() if value is not None}
    try:
        print_results(write_motion(lambda: simulate(fmu, start, **options), Path("build/results")))
    except Problem as problem:
        sys.exit(f"scripts/run: {problem}")


if __name__ == "__main__":
    main()
