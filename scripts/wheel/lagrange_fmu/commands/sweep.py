"""Simulates a system from a grid or a random sample of start values and parameters, on all cores; leaves a Parquet file, a run in each row."""

import os
import tempfile
from pathlib import Path

from .. import caching
from ..building import runtime_key, take_or_compile
from ..problem import Problem
from ..runtime.scripts.cross import zig
from ..sweep_words import sweep_words
from .words_of_systems import SYSTEM_OR_FMU

PACKAGE = Path(__file__).parent.parent
RUNTIME = PACKAGE / "runtime"
HOW = (PACKAGE / "ensembles.py", Path(__file__))  # what tells how the libraries are compiled


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    sweep_words(parser, "SYSTEM-sweep.parquet in the current folder")


def compiled(place, name, key, what, words_for):
    """The library that zig makes by words_for(library), in a folder of its own in the place; compiled when it is needed first."""
    library = place / name / name

    def compile_library():
        library.parent.mkdir()
        zig("cc", *words_for(library), cache=place / "cache")

    take_or_compile(caching.key_of(runtime_key(), *(file.read_bytes() for file in HOW), *key), library.parent, what, compile_library)
    return library


def runner(place):
    """What calls the FMU."""
    words = ["-std=c11", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-I", RUNTIME / "include", RUNTIME / "scripts" / "sweep_runs.c"]
    return compiled(place, "sweep_runs", ["sweep"], "the library that runs sweeps cannot be compiled", lambda library: [*words, "-o", library])


def ensemble_runtime(place):
    """What runs in lanes have of the runtime of FMUs, as an object: all in one piece, once for all systems."""
    from ..ensembles import includes, runtime_sources

    source, runtime = place / "ensemble_runtime.c", RUNTIME / "src" / "runtime"
    source.write_text("".join(f'#include "{file.relative_to(runtime).as_posix()}"\n' for file in runtime_sources(RUNTIME)), encoding="utf-8")
    words = ["-std=c11", "-O2", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-c", *includes(RUNTIME), source]
    what = "the runtime of many runs at once cannot be compiled"
    return compiled(place, "ensemble_runtime.o", ["ensemble_runtime"], what, lambda library: [*words, "-o", library])


def compile_ensemble(place, source, lanes):
    """What runs many at once; not on Windows, where nobody has tried it."""
    from ..ensembles import words

    if os.name == "nt":
        return None
    rest = [*sorted((RUNTIME / "src" / "ensemble").rglob("*.c")), ensemble_runtime(place), "-lm"]
    what = "the FMU's equations cannot be compiled for many runs at once"
    return compiled(place, "ensemble", ["ensemble", source, lanes], what, lambda library: [*words(RUNTIME, lanes, source, place, library), *rest])


def run(arguments):
    try:
        from ..sweeping import sweep
    except ModuleNotFoundError as missing:
        raise Problem(f"{missing.name} is not installed; it comes with pip install pyarrow") from None
    from ..running import fmu_of

    with fmu_of(arguments.system) as fmu, tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        sweep(fmu, ".", arguments, runner(place), lambda source, lanes: compile_ensemble(place, source, lanes))
