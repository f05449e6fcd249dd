"""Compare the FMUs as shipped, at their own tolerance, with closed forms, published values and tight references; each row names its source."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from numerics.driver import POINTS, description_of, step
from numerics.mechanisms.comparison import PROBLEMS as MECHANISMS
from numerics.switching.problems import PROBLEMS as SWITCHING
from numerics.work_precision import scenarios

HEADER = ["system", "simulated [s]", "compared", "reference", "tolerance", "largest error", "error / tolerance", "time [µs]"]
LARGEST = 1e3  # error relative to the tolerance above which a result is wrong; unstable motions, such as that of FreeBody, amplify errors
REPEATS = 3  # runs; the fastest counts

DLMF = "NIST Digital Library of Mathematical Functions"
SERIES = "Taylor series of SymPy's equations in 30 digits, local error 1e-20"
SOURCES = {
    "SimplePendulum": f"Jacobi's elliptic function cd; {DLMF}, 22.19(i)",
    "ParticlePolar": "Kepler's equation; H. Goldstein, C. Poole, J. Safko: Classical Mechanics, 2002, 3.8",
    "ParticleCartesian": "harmonic oscillators; Goldstein, 2.6",
    "ParticleCylindrical": "harmonic motion in x and y, parabola in z",
    "ParticleSpherical": "parabola of a throw",
    "SimplePendulumLinear": "cosine",
    "InvertedPendulumCartLinear": "hyperbolic cosine",
    "InvertedPendulumCartTorqueLinear": "hyperbolic cosine",
    "BouncingBall": "geometric series of the bounces; B. Brogliato: Nonsmooth Mechanics, 2016",
    "HardStopPendulum": f"elliptic integrals between impacts; {DLMF}, 19.2 and 22.19(i)",
    "StickSlip": "harmonic motion while it slides, uniform motion while it sticks",
    "NewtonsCradle": "elliptic functions between impacts, in which equal masses exchange velocities",
    "PendulumCartesian": f"Jacobi's elliptic function cd; {DLMF}, 22.19(i); problem A01 of IFToMM's benchmark library",
    "AndrewsSqueezer": "published values; F. Mazzia, C. Magherini: Test Set for Initial Value Problem Solvers, 2008, Andrews' squeezing mechanism",
    "KnifeEdge": "cycloid; J. Neimark, N. Fufaev: Dynamics of Nonholonomic Systems, 1972",
    "HeavyTop": "nutation by Jacobi's elliptic function sn; Goldstein, 5.7",
    "FreeBody": "Jacobi's elliptic functions; L. Landau, E. Lifshitz: Mechanics, 1976, section 37",
    "FlyballGovernor": "collocation of SymPy's equations in extended precision; problem A05 of IFToMM's benchmark library",
    "RobotArm": "Pinocchio's articulated-body algorithm, integrated by a method of order 8",
}


class Case(NamedTuple):
    """A motion with a known solution."""

    system: str
    starts: dict  # start values and parameters other than the FMU's
    end: float  # s
    compared: list  # names of variables
    source: str
    exact: Callable  # returns rows of the compared variables, for the last communication points


def _of_scenario(name):
    if name in scenarios.CLOSED_FORMS:
        compared, _ = scenarios.CLOSED_FORMS[name][1](name, scenarios.values_of(name), scenarios.times_of(name)[:1])
        exact = lambda: scenarios.CLOSED_FORMS[name][1](name, scenarios.values_of(name), scenarios.times_of(name))[1]
    else:
        compared, exact = scenarios.states_of(name), lambda: scenarios.reference(name)
    return Case(name, *scenarios.SCENARIOS[name], compared, SOURCES.get(name, SERIES), exact)


def cases(quick):
    """Return the cases; the quick ones lack references that take long."""
    found = [_of_scenario(name) for name in scenarios.SCENARIOS if not quick or name in scenarios.CLOSED_FORMS]
    found += [Case(p.system, {}, p.end, p.compared, SOURCES[p.system], lambda p=p: p.exact) for p in MECHANISMS if p.expected and (p.quick or not quick)]
    return found + [Case(p.system, p.values, p.end, p.compared, SOURCES[p.system], lambda p=p: p.exact) for p in SWITCHING]


def row_of(case):
    """Return the row of a case, with NaN for a run that fails."""
    tolerance = float(description_of("shipped", case.system).defaultExperiment.tolerance)
    run = step("shipped", case.system, case.starts, case.end, tolerance, POINTS, REPEATS)
    exact = np.asarray(case.exact(), dtype=float)
    error = np.nan if run is None else float(np.max(np.abs(run.columns(case.compared)[-len(exact) :] - exact) / np.maximum(1.0, np.abs(exact))))
    return [case.system, case.end, ", ".join(case.compared), case.source, tolerance, error, error / tolerance, np.nan if run is None else run.seconds * 1e6]


def is_wrong(row):
    """Return True if the error of a row is NaN or too large for its tolerance."""
    return not row[HEADER.index("error / tolerance")] <= LARGEST
