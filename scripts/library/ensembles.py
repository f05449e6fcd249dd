"""
Compute many runs of an FMU at once, in SIMD lanes.

The equations in the FMU's C sources are compiled over the vectors of this machine's processor (src/ensemble). They are compiled once more for a
single run, which handles events and constraints. This works for systems with Taylor series. Also a module of the wheel.
"""

import sys
import zipfile
from ctypes import CDLL, Structure, byref, c_bool, c_double, c_size_t, c_void_p

import numpy as np

MARK = "#ifdef LANES"  # in sources that can be compiled over lanes
NOT_IN_LANES = ("fmi2", "fmi3", "methods", "sundials")  # rooms of src/runtime that are left out: FMI functions, and solvers, which src/ensemble replaces
COMPLETE = ["-Wl,-z,defs"] if sys.platform == "linux" else []  # reports missing functions when linking instead of when loading
LANES_HEAD = '#include "generated.h"\n'
ONE_MARKS = (".event_laws = ", ".constraints.projection = ")  # in sources of systems with events or constraints, which are handled for a single run
SYSTEM, NO_SYSTEM = '#include "system.c"\n', "const struct Lagrangian lagrangian = {0};\n"
ONE_HEAD = '#undef LANES\n#define LANES 1\n#include "lagrangian.h"\n#include "instructions.h"\n#include "ldlt.h"\n#include "saddle.h"\n'


def runtime_sources(root):
    """Return the runtime sources to which a system in lanes may refer."""
    files = sorted((root / "src" / "runtime").rglob("*.c"))
    return [file for file in files if file.parent.name not in NOT_IN_LANES or file.name == "projection.c"]


def lanes_here(runner):
    """Return the number of lanes of this machine's processor; `runner` is the library of sweeping/single_runs.c."""
    return CDLL(str(runner)).sweep_lanes()


def source_of(fmu):
    """Return the FMU's C source, or None if its equations cannot be compiled over lanes."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if name.startswith("sources/") and name.endswith(".c")]
        texts = [archive.read(name).decode() for name in names]
    return next((text for text in texts if MARK in text), None)


def words(root, lanes, source, folder, library):
    """
    Return the arguments with which a C compiler makes the library of an FMU's source, without the C of src/ensemble and of the runtime.

    Write the compiled files into `folder`: the equations over lanes, and those of a single run.
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
        *((f"{what}_count", c_size_t) for what in ("varied", "recorded", "time")),
        *((name, c_void_p) for name in ("varied", "recorded", "times")),
        ("tolerance", c_double),
        *((name, c_void_p) for name in ("start", "values", "needs_fmu")),
    ]


class Ensemble:
    """Runs of a compiled library from 0 s on; `varied` and `recorded` are value references."""

    def __init__(self, library, varied, recorded, times, tolerance=None):
        self.library = CDLL(str(library))
        self.varied, self.recorded = (np.array(references, dtype=np.uintc) for references in (varied, recorded))
        self.times, self.tolerance = np.array(times, dtype=float), tolerance or 0.0
        for function in (self.library.ensemble_supports, self.library.ensemble_run):
            function.restype = c_bool

    def request(self, start, values, needs_fmu):
        arrays = self.varied, self.recorded, self.times
        return Request(*map(len, arrays), *(a.ctypes.data for a in arrays), self.tolerance, *(a.ctypes.data for a in (start, values, needs_fmu)))

    def supports(self):
        """Return True if the library can vary and record these variables."""
        nothing = np.empty(0)
        return self.library.ensemble_supports(byref(self.request(nothing, nothing, nothing)))

    def run(self, start):
        """
        Perform n runs with the start values `start`, n x varied.

        Return the recorded values, n x times x variables, and a mask of the runs that the FMU itself must perform.
        """
        start = np.ascontiguousarray(start, dtype=float)
        values = np.full((len(start), len(self.times), len(self.recorded)), np.nan)
        needs_fmu = np.zeros(len(start), dtype=bool)
        if not self.library.ensemble_run(byref(self.request(start, values, needs_fmu)), c_size_t(0), c_size_t(len(start))):
            raise MemoryError
        values[needs_fmu] = np.nan
        return values, needs_fmu
