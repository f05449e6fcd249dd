"""Runs FMUs in a small C program, so that no Python is in the times."""

import functools
import subprocess
from dataclasses import dataclass, replace

import fmpy
import numpy as np

from fmu import ROOT

BUILD = ROOT / "build"
SOLVERS = ["taylor", "erk", "bdf"]  # each has a build of all systems, as have those of numerics.stiff
POINTS = 100


@dataclass
class Stepped:
    seconds: float
    names: list
    rows: np.ndarray  # a row for each recorded communication point
    steps: int  # of the solver, 0 where it does not count them
    evaluations: int  # of the equations of motion
    events: int  # that switched it

    def columns(self, names):
        return self.rows[:, [self.names.index(name) for name in names]]


def folder_of(solver):
    """The build in which every system has this solver; "shipped" is the system's own."""
    return BUILD if solver == "shipped" else BUILD / solver


@functools.cache
def description_of(solver, name):
    return fmpy.read_model_description(folder_of(solver) / "fmu" / f"{name}.fmu")


def changing_input(amplitude, k):
    """The value of an input that changes at every step, in step k; the same as in tests/c/stepping.c."""
    return amplitude * (7 * k % 11 - 5) / 5


def step(solver, name, starts, end, tolerance, steps, repeats, points=POINTS, timeout=60, changing=(), importer=False):
    """
    The time and the states of a simulation; None where the FMU gives up or takes longer than the timeout.
    changing: (input, amplitude), an input that changes at every step. The points are recorded in a run of their own; without
    repeats that one is timed, and without points there is none. importer: by CVODE in model exchange in place of the solver.
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
    """The same, with as many repeats as a twentieth of a second has room for, but at least 3."""
    first = step(solver, name, starts, end, tolerance, steps, 0)
    if first is None:
        return None
    again = step(solver, name, starts, end, tolerance, steps, int(min(max(0.05 / first.seconds, 3), 500)), 0)
    return first if again is None else replace(first, seconds=min(first.seconds, again.seconds))
