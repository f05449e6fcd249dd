"""Run FMUs in a small C program, so that times do not include Python."""

import functools
import subprocess
from dataclasses import dataclass, replace

import fmpy
import numpy as np

from fmu import ROOT

BUILD = ROOT / "build"
SOLVERS = ["taylor", "erk", "bdf"]  # each has a build folder of all systems, as have the methods of numerics.stiff
POINTS = 100  # recorded communication points of a run


@dataclass
class Stepped:
    """A run of an FMU."""

    seconds: float
    names: list  # names of the recorded variables
    rows: np.ndarray  # a row for each recorded communication point
    steps: int  # steps of the solver; 0 if the FMU does not count them
    evaluations: int  # evaluations of the equations of motion
    events: int

    def columns(self, names):
        """Return the columns of these variables."""
        return self.rows[:, [self.names.index(name) for name in names]]


def folder_of(solver):
    """Return the build folder in which every system has this solver; "shipped" is the system's own."""
    return BUILD if solver == "shipped" else BUILD / solver


@functools.cache
def description_of(solver, name):
    return fmpy.read_model_description(folder_of(solver) / "fmu" / f"{name}.fmu")


def changing_input(amplitude, k):
    """Return the value in step k of an input that changes at every step, as in tests/c/stepping.c."""
    return amplitude * (7 * k % 11 - 5) / 5


def step(solver, name, starts, end, tolerance, steps, repeats, points=POINTS, timeout=60, changing=(), importer=False):
    """
    Simulate an FMU; return a Stepped, or None if the FMU fails or takes longer than `timeout` s.

    The points are recorded in a separate run, which is timed if `repeats` is 0, and left out if `points` is 0. `changing` is (input, amplitude) of
    an input that changes at every step. If `importer`, CVODE integrates the FMU in model exchange.
    """
    description = description_of(solver, name)
    references = {v.name: v.valueReference for v in description.modelVariables}
    names = [v.name for v in description.modelVariables if v.type == "Real"]
    names = [n for n in names if references[n] <= references["totalEnergy"]]
    library = folder_of(solver) / "systems" / name / "binaries" / "linux64" / f"{name}.so"
    listed = lambda names: ",".join(str(references[name]) for name in names)
    counted = [name for name in ("solverSteps", "derivativeEvaluations", "events") if name in references]
    words = [BUILD / "bin" / ("exchange" if importer else "stepping"), library, description.guid, tolerance, end, steps, repeats,
             listed(names), points, listed(counted),
             *([description.numberOfContinuousStates, description.numberOfEventIndicators] if importer else []),
             *(f"{references[variable]}={value!r}" for variable, value in starts.items()),
             *([f"{references[changing[0]]}~{changing[1]!r}"] if changing else [])]  # fmt: skip
    try:
        result = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return None
    if result.returncode != 0:
        return None
    *rows, seconds, last = result.stdout.splitlines()
    counts = dict(zip(counted, map(int, last.split())))
    return Stepped(float(seconds), names, np.array([[float(x) for x in row.split()] for row in rows]),
                   counts.get("solverSteps", 0), counts.get("derivativeEvaluations", 0), counts.get("events", 0))  # fmt: skip


def step_repeatedly(solver, name, starts, end, tolerance, steps):
    """Simulate as step() does, with the repeats that fit into 0.05 s, from 3 to 500."""
    first = step(solver, name, starts, end, tolerance, steps, 0)
    if first is None:
        return None
    again = step(solver, name, starts, end, tolerance, steps, int(min(max(0.05 / first.seconds, 3), 500)), 0)
    return first if again is None else replace(first, seconds=min(first.seconds, again.seconds))
