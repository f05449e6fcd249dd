"""Simulates a system from a grid or a random sample of start values and parameters, on all cores; leaves a Parquet file, a run in each row."""

import subprocess
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

from .. import caching
from ..problem import Problem
from ..sweep_words import sweep_words
from .words_of_systems import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    sweep_words(parser, "SYSTEM-sweep.parquet in the current folder")


def runner():
    """What calls the FMU, compiled when it is needed first."""
    runtime = Path(__file__).parent.parent / "runtime"
    source = runtime / "scripts" / "sweep_runs.c"
    key = caching.key_of(version("ziglang"), source.read_bytes())
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "library"
        if not caching.take(key, folder):
            folder.mkdir()
            words = ["-std=c11", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-I", runtime / "include", source, "-o", folder / "sweep_runs"]
            compiled = subprocess.run([sys.executable, "-m", "ziglang", "cc", *words], capture_output=True, text=True)
            if compiled.returncode != 0:
                raise Problem(f"the library that runs sweeps cannot be compiled: {compiled.stderr.strip()}")
            caching.keep(key, folder)
        return (folder / "sweep_runs").read_bytes()


def run(arguments):
    try:
        from ..sweeping import sweep
    except ModuleNotFoundError as missing:
        raise Problem(f"{missing.name} is not installed; it comes with pip install pyarrow") from None
    from ..running import fmu_of

    with fmu_of(arguments.system) as fmu:
        sweep(fmu, ".", arguments, runner())
