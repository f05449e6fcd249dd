"""
Run an FMU over a grid or a random sample of start values and parameters, on all cores or on a Dask cluster.

Each run is a row of a Parquet file. It has the varied values, the states at the end, the error of the energy, the run time, and the message of a failure.
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from scripts.library.ensembles import words
from scripts.library.problem import Problem
from scripts.library.sweeping.arguments import add_sweep_arguments
from scripts.library.sweeping.runs import report, sweep


def compile_ensemble(source, lanes):
    """
    Compile the library of ensembles.py for a system.c, unless it exists; return its path.

    The optimization is -O1: higher levels take long and make the equations no faster. clang and gcc give the same bits; clang is preferred.
    """
    archives = [ROOT / "build" / f"lib{name}.a" for name in (f"ensemble{lanes}", "ensemble_runtime", "solvers")]
    parts = [*archives, *sorted((ROOT / "src" / "ensemble").glob("*.*")), *sorted((ROOT / "include").iterdir())]
    key = hashlib.sha256(b"".join([source.encode(), *(part.read_bytes() for part in parts)])).hexdigest()[:32]
    library = ROOT / "build" / "ensembles" / f"{key}.so"
    if library.exists():
        return library
    library.parent.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        unfinished = Path(folder) / "unfinished.so"
        whole, *needed = archives
        compiler = [os.environ.get("CC") or shutil.which("clang") or "cc", *words(ROOT, lanes, source, Path(folder), unfinished), "-O1",
                    "-Wl,--whole-archive", whole, "-Wl,--no-whole-archive", *needed, "-lm"]  # fmt: skip
        result = subprocess.run(compiler, capture_output=True, text=True)
        if result.returncode != 0:
            raise Problem(f"the FMU's equations cannot be compiled for many runs at once: {result.stderr.strip()}")
        unfinished.replace(library)
    return library


def main():
    parser = argparse.ArgumentParser(prog="scripts/sweep", description=__doc__)
    parser.add_argument("system", help="name of a system, or an FMU")
    add_sweep_arguments(parser, "build/results/SYSTEM-sweep.parquet")
    arguments = parser.parse_args()
    path = Path(arguments.system)
    path = path if path.suffix == ".fmu" else ROOT / "build" / "fmu" / f"{arguments.system}.fmu"
    try:
        if not path.exists():
            raise Problem(f"there is no {path}; expected the name of a system that is built, or an FMU")
        report(lambda: sweep(path, ROOT / "build" / "results", arguments, ROOT / "build" / "libsweep_runs.so", compile_ensemble))
    except Problem as problem:
        sys.exit(f"scripts/sweep: {problem}")


if __name__ == "__main__":
    main()
