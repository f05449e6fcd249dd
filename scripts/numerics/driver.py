"""Runs FMUs in a small C program, so that no Python is in the times."""

import functools
import subprocess
from dataclasses import dataclass

import fmpy
import numpy as np

from fmu import ROOT, Instance

BUILD = ROOT / "build"
SOLVERS = ["taylor", "erk", "bdf"]  # each has a build of all systems
POINTS = 100


@dataclass
class Stepped:
    seconds: float
    names: list
    rows: np.ndarray  # a row for each recorded communication point

    def columns(self, names):
        return self.rows[:, [self.names.index(name) for name in names]]


def folder_of(solver):
    """The build in which every system has this solver; "shipped" is the system's own."""
    return BUILD if solver == "shipped" else BUILD / solver


@functools.cache
def description_of(solver, name):
    return fmpy.read_model_description(folder_of(solver) / "fmu" / f"{name}.fmu")


def step(solver, name, starts, end, tolerance, steps, repeats, points=POINTS, timeout=60):
    """The time and the states of a simulation; None where the FMU gives up or takes longer than the timeout."""
    description = description_of(solver, name)
    references = {v.name: v.valueReference for v in description.modelVariables}
    names = [v.name for v in description.modelVariables if v.type == "Real"]
    names = [n for n in names if references[n] <= max(references.get(last, 0) for last in ("totalEnergy", names[0]))]
    library = folder_of(solver) / "systems" / name / "binaries" / "linux64" / f"{name}.so"
    words = [BUILD / "bin/stepping", library, description.guid, tolerance, end, steps, repeats, len(names), points,
             *(f"{references[variable]}={value!r}" for variable, value in starts.items())]  # fmt: skip
    try:
        result = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return None
    if result.returncode != 0:
        return None
    first, *rows = result.stdout.splitlines()
    return Stepped(float(first), names, np.array([[float(x) for x in row.split()] for row in rows]))


def work(solver, name, starts, end, tolerance, steps):
    """(steps of the solver, evaluations of the equations) of a simulation of the shipped FMU, in this process."""
    instance = Instance(name)
    try:
        instance.initialize(starts, tolerance)
        for k in range(steps):
            target = end * (k + 1) / steps
            instance.step(target - instance.time)
            instance.time = target
        names = ["solverSteps", "derivativeEvaluations"]
        return [instance.fmu.getInteger([instance.references[n]])[0] if n in instance.references else 0 for n in names]
    finally:
        instance.free()
