"""Sweep systems, which are built first, and FMUs, with libraries that zig compiles for this purpose."""

import math
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace

from . import caching
from .building import runtime_key, take_or_compile
from .problem import Problem
from .running import fmu_of
from .runtime.scripts.package.cross import zig

PACKAGE = Path(__file__).parent
RUNTIME = PACKAGE / "runtime"
HOW = (PACKAGE / "ensembles.py", Path(__file__))  # files that define how the libraries are compiled; a part of their key in the cache


def compiled(place, name, key, what, arguments_for):
    """
    Return the path of a library, in the folder place/name, which zig compiles with the arguments arguments_for(library).

    A library whose key is in the cache is copied from it. Raise Problem, whose text begins with `what`, if the compilation fails.
    """
    library = place / name / name

    def compile_library():
        library.parent.mkdir()
        zig("cc", *arguments_for(library), cache=place / "cache")

    take_or_compile(caching.key_of(runtime_key(), *(file.read_bytes() for file in HOW), *key), library.parent, what, compile_library)
    return library


def runner(place):
    """Return the path of the library that performs the runs of one FMU, one after another."""
    words = ["-std=c11", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-I", RUNTIME / "include", PACKAGE / "sweeping" / "single_runs.c"]
    return compiled(place, "sweep_runs", ["sweep"], "the library that runs sweeps cannot be compiled", lambda library: [*words, "-o", library])


def ensemble_runtime(place):
    """Return the path of the object file with the FMU runtime for runs in lanes; it is the same for all systems."""
    from .ensembles import includes, runtime_sources

    source, runtime = place / "ensemble_runtime.c", RUNTIME / "src" / "runtime"
    source.write_text("".join(f'#include "{file.relative_to(runtime).as_posix()}"\n' for file in runtime_sources(RUNTIME)), encoding="utf-8")
    words = ["-std=c11", "-O2", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-c", *includes(RUNTIME), source]
    what = "the runtime of many runs at once cannot be compiled"
    return compiled(place, "ensemble_runtime.o", ["ensemble_runtime"], what, lambda library: [*words, "-o", library])


def compile_ensemble(place, source, lanes):
    """
    Return the path of the library that computes many runs of a system at once, in SIMD lanes; `source` is its system.c.

    Return None on Windows, where this is untested.
    """
    from .ensembles import words

    if os.name == "nt":
        return None
    rest = [*sorted((RUNTIME / "src" / "ensemble").rglob("*.c")), ensemble_runtime(place), "-lm"]
    what = "the FMU's equations cannot be compiled for many runs at once"
    return compiled(place, "ensemble", ["ensemble", source, lanes], what, lambda library: [*words(RUNTIME, lanes, source, place, library), *rest])


def sweeping():
    """Import and return the module sweeping.runs; raise Problem if pyarrow is missing."""
    try:
        from .sweeping import runs
    except ModuleNotFoundError as missing:
        raise Problem(f"{missing.name} is not installed; it comes with pip install pyarrow") from None
    return runs


def sweep_by_words(system, words):
    """Sweep by the arguments that sweeping/arguments.py declares; return the path of the Parquet file."""
    sweep = sweeping().sweep
    with fmu_of(system) as fmu, tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        return sweep(fmu, ".", words, runner(place), lambda source, lanes: compile_ensemble(place, source, lanes))


def variation(name, values, random):
    """Check a range or values; return (name, values) as sweeping.arguments.variation does: a tuple (FROM, TO, COUNT or None), or a list."""
    try:
        numbers = [] if isinstance(values, str) else [value if isinstance(value, str) else float(value) for value in values]
    except (TypeError, ValueError):
        numbers = []
    if not numbers or not all(isinstance(number, str) or math.isfinite(number) for number in numbers):
        raise Problem(f"vary has {values!r} for '{name}'; expected (FROM, TO, COUNT), or a list of finite numbers")
    if not isinstance(values, tuple):
        return name, numbers
    if len(numbers) == 2 and random is not None:
        return name, (*numbers, None)
    if len(numbers) != 3 or isinstance(numbers[2], str) or numbers[2] < 1 or numbers[2] % 1 != 0:
        raise Problem(f"vary has {values!r} for '{name}'; expected (FROM, TO, COUNT), (FROM, TO) with random=RUNS, or a list of values")
    return name, (*numbers[:2], int(numbers[2]))


def sweep(system, vary, **words):
    """See lagrange_fmu.sweep."""
    if not isinstance(vary, Mapping) or not vary:
        raise Problem(f"vary is {vary!r}; expected a dict of ranges or values by name, such as {{'l': (0.5, 2, 50), 'm': [1, 2]}}")
    return sweep_by_words(system, SimpleNamespace(vary=[variation(name, values, words["random"]) for name, values in vary.items()], **words))
