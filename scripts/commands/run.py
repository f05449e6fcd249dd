"""Simulate an FMU with FMPy and write a CSV, a plot and an animation: run.py FMU [NAME=VALUE ...]"""

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
    arguments = parser.parse_args()
    try:
        print_results(write_motion(lambda: simulate(arguments.fmu, dict(arguments.start)), Path("build/results")))
    except Problem as problem:
        sys.exit(f"scripts/run: {problem}")


if __name__ == "__main__":
    main()
