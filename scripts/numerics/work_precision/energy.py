"""Measure the drift of the energy over long runs, an invariant that no tolerance controls directly."""

import numpy as np

from closed_forms import pericentre_velocity
from numerics.driver import step

RUNS = {
    "SimplePendulum": dict(theta=2.0),
    "ParticlePolar": dict(r=0.5, omega=float(pericentre_velocity(1, 1, 0.5))),
    "DoublePendulum": dict(theta1=1.0, theta2=-0.5),
}
METHODS = [("taylor", 1e-15), ("taylor", 1e-10), ("erk", 1e-10), ("bdf", 1e-8)]


def drifts(name, solver, tolerance, end):
    """Return times, and changes of the energy relative to the largest kinetic energy, at 1000 communication points; None if the FMU fails."""
    stepped = step(solver, name, RUNS[name], end, tolerance, 1000, 0, points=1000, timeout=300)
    if stepped is None:
        return None
    energy, kinetic = stepped.columns(["totalEnergy"])[:, 0], stepped.columns(["kineticEnergy"])[:, 0]
    return end * np.arange(1, 1001) / 1000, np.abs(energy - energy[0]) / np.max(kinetic)
