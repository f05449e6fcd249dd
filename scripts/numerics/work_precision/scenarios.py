"""Define the simulated scenarios and their references: SymPy's equations with 20 digits, checked by closed forms where these exist."""

import functools
import hashlib
import json

import numpy as np

from closed_forms import kepler, pendulum_angle, pericentre_velocity
from fmu import ROOT, start_values
from numerics.driver import POINTS
from references import ExactMotion
from systems_in_sympy import system

# Start values other than the FMU's, and the end in s, which is early for chaotic systems.
SCENARIOS = {
    "SimplePendulum": (dict(theta=2.0), 10.0),
    "InvertedPendulumCart": ({}, 10.0),
    "ParticlePolar": (dict(r=0.1, omega=float(pericentre_velocity(1, 1, 0.9))), 10.0),
    "DoublePendulum": ({}, 5.0),
    "ElasticPendulum": ({}, 2.0),
    "DampedPendulum": (dict(tau=0.5), 10.0),
    "RotatingPivotPendulum": ({}, 10.0),
    "ChainPendulum": ({}, 1.0),
    "InvertedPendulumCartTorque": (dict(F=0.5, tau=-0.2), 5.0),
    "ParticleCylindrical": ({}, 10.0),
    "ParticleSpherical": (dict(vr=1.0, omegaPhi=-0.5), 1.0),
    "ParticleCartesian": (dict(Fx=0.5), 10.0),
    "SimplePendulumLinear": (dict(theta=0.4), 10.0),
    "InvertedPendulumCartLinear": (dict(theta=0.01), 2.0),
    "InvertedPendulumCartTorqueLinear": (dict(theta=0.01), 2.0),
}
QUICK = ["SimplePendulum", "InvertedPendulumCart", "ParticlePolar", "DoublePendulum", "ElasticPendulum"]


def values_of(name):
    """Return all start values and parameters of a scenario by name."""
    return start_values(name) | SCENARIOS[name][0]


def states_of(name):
    definition = system(name)
    return [s.name for s in [*definition.q, *definition.v]]


def times_of(name, points=POINTS):
    return SCENARIOS[name][1] * np.arange(1, points + 1) / points


@functools.cache
def reference(name):
    """Return the states at times_of(name), a row each; they are cached in build/report/references."""
    values, times = values_of(name), times_of(name)
    key = hashlib.sha256(json.dumps([name, values, list(times), repr(system(name).terms)]).encode()).hexdigest()[:16]
    path = ROOT / "build" / "report" / "references" / f"{name}-{key}.npy"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        np.save(path, ExactMotion(system(name), values, 30).trajectory(times))
    return np.load(path)


def pendulum(name, values, times):
    rate = np.sqrt(values["g"] / values["l"])
    return ["theta"], np.array([[pendulum_angle(values["theta"], rate, t)] for t in times])


def orbit(name, values, times):
    """Return r, from the position on the ellipse."""
    return ["r"], np.array([[np.hypot(*kepler(values["mu"], values["r"], values["omega"], t))] for t in times])


def oscillators(name, values, times):
    columns = []
    for axis in "xyz":
        force = values[f"F{axis}"] - (values["m"] * values["g"] if axis == "z" else 0)
        rest, w = force / values[f"k{axis}"], np.sqrt(values[f"k{axis}"] / values["m"])
        columns.append(rest + (values[axis] - rest) * np.cos(w * times) + values[f"v{axis}"] / w * np.sin(w * times))
    return list("xyz"), np.array(columns).T


def cylinder(name, values, times):
    """Return rho, from harmonic motions in x and y, and z in free fall."""
    w = np.sqrt(values["k"] / values["m"])
    x = values["rho"] * np.cos(w * times) + values["vrho"] / w * np.sin(w * times)
    y = values["rho"] * values["omega"] / w * np.sin(w * times)
    z = values["z"] + values["vz"] * times - values["g"] * times**2 / 2
    return ["rho", "z"], np.array([np.hypot(x, y), z]).T


def throw(name, values, times):
    """Return r and phi on a parabola."""
    r, phi = values["r"], values["phi"]
    radial = np.array([np.sin(phi), 0.0, np.cos(phi)])
    velocity = values["vr"] * radial + r * values["omegaPhi"] * np.array([np.cos(phi), 0.0, -np.sin(phi)])
    velocity = velocity + np.array([0.0, r * np.sin(phi) * values["omegaTheta"], 0.0])
    position = r * radial + np.outer(times, velocity) - np.outer(values["g"] * times**2 / 2, [0, 0, 1])
    distance = np.linalg.norm(position, axis=1)
    return ["r", "phi"], np.array([distance, np.arccos(position[:, 2] / distance)]).T


def swing(name, values, times):
    return ["theta"], (values["theta"] * np.cos(np.sqrt(values["g"] / values["l"]) * times))[:, None]


def fall(name, values, times):
    rate = np.sqrt((values["M"] + values["m"]) * values["g"] / (values["M"] * values["l"]))
    return ["theta"], (values["theta"] * np.cosh(rate * times))[:, None]


CLOSED_FORMS = {
    "SimplePendulum": ("Jacobi's elliptic function", pendulum), "ParticlePolar": ("Kepler's equation", orbit),
    "ParticleCartesian": ("harmonic oscillators", oscillators), "ParticleCylindrical": ("harmonic x and y, parabola in z", cylinder),
    "ParticleSpherical": ("parabola", throw), "SimplePendulumLinear": ("cosine", swing),
    "InvertedPendulumCartLinear": ("hyperbolic cosine", fall), "InvertedPendulumCartTorqueLinear": ("hyperbolic cosine", fall),
}  # fmt: skip


def check_of_reference(name):
    """Return a description of the reference's check, a closed form or the same series with 6 more digits, and the largest difference."""
    if name in CLOSED_FORMS:
        text, exact = CLOSED_FORMS[name]
        columns, values = exact(name, values_of(name), times_of(name))
        indices = [states_of(name).index(column) for column in columns]
        return text, np.max(np.abs(reference(name)[:, indices] - values) / np.maximum(1, np.abs(values)))
    last = ExactMotion(system(name), values_of(name), 36).trajectory(times_of(name)[-1:])[0]
    return "series with 6 digits more, at the end", error_at_end(name, last)


def errors(name, states):
    """Return the error of each row of states, at equally spaced times up to the end, in units of max(1, |state|)."""
    stride = POINTS // len(states)
    exact = reference(name)[stride - 1 :: stride]
    return np.max(np.abs(states - exact) / np.maximum(1, np.abs(exact)), axis=1)


def error_at_end(name, state):
    exact = reference(name)[-1]
    return np.max(np.abs(np.asarray(state) - exact) / np.maximum(1, np.abs(exact)))
