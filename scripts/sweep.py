"""
Runs an FMU over a grid or a random sample of start values and parameters, on all cores or on a Dask cluster. Each run is a row of a
Parquet file: what varied, the states at the end, the error of the energy, the run time, and what went wrong.
"""

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from scripts.problem import Problem
from scripts.sweep_words import sweep_words
from scripts.sweeping import sweep


def main():
    parser = argparse.ArgumentParser(prog="scripts/sweep", description=__doc__)
    parser.add_argument("system", help="the name of a system, or an FMU")
    sweep_words(parser, "build/results/SYSTEM-sweep.parquet")
    arguments = parser.parse_args()
    path = Path(arguments.system)
    path = path if path.suffix == ".fmu" else ROOT / "build" / "fmu" / f"{arguments.system}.fmu"
    try:
        if not path.exists():
            raise Problem(f"there is no {path}")
        sweep(path, ROOT / "build" / "results", arguments, (ROOT / "build" / "libsweep_runs.so").read_bytes())
    except Problem as problem:
        sys.exit(f"scripts/sweep: {problem}")


if __name__ == "__main__":
    main()
