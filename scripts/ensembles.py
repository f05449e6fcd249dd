"""
Many runs of an FMU at once: its equations, which stand in its sources, compiled over the vectors of this machine's processor (src/ensemble), and
once more for one run, for its events and constraints. Those of systems with Taylor series can be. Also a module of the wheel.
"""

import sys
import zipfile
from ctypes import CDLL, Structure, byref, c_bool, c_double, c_size_t, c_void_p

import numpy as np

MARK = "#ifdef LANES"  # of sources that can be compiled over lanes
NOT_IN_LANES = ("fmi2", "fmi3", "methods", "sundials")  # rooms of src/runtime: what calls an FMU, and solvers, which src/ensemble replaces
COMPLETE = ["-Wl,-z,defs"] if sys.platform == "linux" else []  # a missing function fails when the library is made, not when it is loaded
LANES_HEAD = '#include "generated.h"\n'
ONE_MARKS = (".event_laws = ", ".constraints.projection = ")  # of those with something that is done for one run alone
SYSTEM, NO_SYSTEM = '#include "system.c"\n', "const struct Lagrangian lagrangian = {0};\n"
ONE_HEAD = '#undef LANES\n#define LANES 1\n#include "lagrangian.h"\n#include "instructions.h"\n#include "ldlt.h"\n#include "saddle.h"\n'


def runtime_sources(root):
    """Returns all that a system in lanes may refer to."""
    files = sorted((root / "src" / "runtime").rglob("*.c"))
    return [file for file in files if file.parent.name not in NOT_IN_LANES or file.name == "projection.c"]


def lanes_here(runner):
    """How many lanes this machine's processor computes at once; runner: the library of sweep_runs.c."""
    return CDLL(str(runner)).sweep_lanes()


def source_of(fmu):
    """The FMU's source in C, or None where its equations cannot be had over lanes."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if name.startswith("sources/") and name.endswith(".c")]
        texts = [archive.read(name).decode() for name in names]
    return next((text for text in texts if MARK in text), None)


def words(root, lanes, source, folder, library):
    """
    What a C compiler takes to make the library of an FMU's source, but for the C in src/ensemble and in the runtime, compiled or not. Leaves in the
    folder what it compiles: the equations over lanes, and those of one run.
    """
    ensemble, needs_one = root / "src" / "ensemble", any(mark in source for mark in ONE_MARKS)
    texts = {"system": source, "lanes": f"{LANES_HEAD}{SYSTEM}", "one": f"{ONE_HEAD}{SYSTEM if needs_one else NO_SYSTEM}"}
    for name, text in texts.items():
        (folder / f"{name}.c").write_text(text, encoding="utf-8")
    return [f"@{ensemble / 'lanes.flags'}", f"@{ensemble / f'lanes{lanes}.flags'}", "-fPIC", "-shared", *COMPLETE, *includes(root),
            *(folder / f"{name}.c" for name in ("lanes", "one")), "-o", library]  # fmt: skip


def includes(root):
    return [word for path in ("src/ensemble", "include", "src/runtime") for word in ("-I", root / path)]


class Request(Structure):
    """struct Ensemble of ensemble.h."""

    _fields_ = [
        *((f"{what}_count", c_size_t) for what in ("varied", "asked", "time")),
        *((name, c_void_p) for name in ("varied", "asked", "times")),
        ("tolerance", c_double),
        *((name, c_void_p) for name in ("start", "values", "is_left")),
    ]


class Ensemble:
    """Runs from 0 on, by a library; varied and asked are value references."""

    def __init__(self, library, varied, asked, times, tolerance=None):
        self.library = CDLL(str(library))
        self.varied, self.asked = (np.array(references, dtype=np.uintc) for references in (varied, asked))
        self.times, self.tolerance = np.array(times, dtype=float), tolerance or 0.0
        for function in (self.library.ensemble_serves, self.library.ensemble_run):
            function.restype = c_bool

    def request(self, start, values, is_left):
        arrays = self.varied, self.asked, self.times
        return Request(*map(len, arrays), *(a.ctypes.data for a in arrays), self.tolerance, *(a.ctypes.data for a in (start, values, is_left)))

    def serves(self):
        """Whether all that varies can be given, and all that is asked be told."""
        nothing = np.empty(0)
        return self.library.ensemble_serves(byref(self.request(nothing, nothing, nothing)))

    def run(self, start):
        """What is asked at each time of each run, whose start values are rows; and which runs are left to the FMU itself."""
        start = np.ascontiguousarray(start, dtype=float)
        values = np.full((len(start), len(self.times), len(self.asked)), np.nan)
        is_left = np.zeros(len(start), dtype=bool)
        if not self.library.ensemble_run(byref(self.request(start, values, is_left)), c_size_t(0), c_size_t(len(start))):
            raise MemoryError
        values[is_left] = np.nan
        return values, is_left
