"""Simulates a system from a grid or a random sample of start values and parameters, on all cores; leaves a Parquet file, a run in each row."""

import tempfile
from pathlib import Path

from .. import caching
from ..building import runtime_key, take_or_compile
from ..problem import Problem
from ..runtime.scripts.cross import zig
from ..sweep_words import sweep_words
from .words_of_systems import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    sweep_words(parser, "SYSTEM-sweep.parquet in the current folder")


def runner():
    """What calls the FMU, compiled when it is needed first."""
    runtime = Path(__file__).parent.parent / "runtime"
    with tempfile.TemporaryDirectory() as place:
        library = Path(place) / "library" / "sweep_runs"

        def compile_library():
            library.parent.mkdir()
            words = ["-std=c11", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-I", runtime / "include"]
            zig("cc", *words, runtime / "scripts" / "sweep_runs.c", "-o", library, cache=Path(place) / "cache")

        take_or_compile(caching.key_of(runtime_key(), "sweep"), library.parent, "the library that runs sweeps cannot be compiled", compile_library)
        return library.read_bytes()


def run(arguments):
    try:
        from ..sweeping import sweep
    except ModuleNotFoundError as missing:
        raise Problem(f"{missing.name} is not installed; it comes with pip install pyarrow") from None
    from ..running import fmu_of

    with fmu_of(arguments.system) as fmu:
        sweep(fmu, ".", arguments, runner())
