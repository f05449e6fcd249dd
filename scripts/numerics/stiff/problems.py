"""Define stiff problems and their references: collocation of two orders, which must agree, for SymPy's equations."""

import functools
import hashlib
import json
from dataclasses import dataclass, field, replace

import numpy as np
from sympy import Rational, cos, diff, sin, sqrt, symbols

import systems_in_sympy
from fmu import ROOT
from mechanics import System, kinetic, velocity
from numerics.driver import POINTS, changing_input, description_of, step
from numerics.stiff.collocation import extended_right_side, trajectory

REFERENCES = ROOT / "build" / "report" / "references"
STAGES = (12, 9)  # stages of the reference, and of its check
# Method and tolerance of the reference and of its check, for systems without a derivation by SymPy; limit of time in s for each.
# Below 1e-10 rounding errors dominate bdf.
BY_SOLVERS, LIMIT = (("radau", 1e-11), ("bdf", 1e-10)), 200


@functools.cache
def van_der_pol():
    x, v, F, mu = symbols("x v F mu")
    return System([x], [v], v**2 / 2, x**2 / 2, [mu * (1 - x**2) * v + F], [F], [mu])


@functools.cache
def flyball_governor():
    """Return the governor with mass points; each rod has masses at its ends and its middle by Simpson's rule, which is exact for a rod."""
    q, v = symbols("psi alpha s"), symbols("Omega nu vs")
    m, mArm, mSlider, J, L, a, k, c, g, tau = symbols("m mArm mSlider J L a k c g tau")
    psi, alpha, s = q
    out = lambda way, side: (side * way * sin(alpha) * cos(psi), side * way * sin(alpha) * sin(psi), -way * cos(alpha))
    points = [(mSlider, (0, 0, -s))]
    for side in (1, -1):
        points += [(m + mArm / 6, out(L, side)), (mArm * Rational(2, 3), out(L / 2, side))]
    U = sum(mass * g * position[2] for mass, position in points)
    length = sqrt(sum((x - y) ** 2 for x, y in zip(out(a, 1), (0, 0, -s)))).simplify()
    rate = velocity(length, q, v)
    Q = [-2 * c * rate * diff(length, x) for x in q]
    T = kinetic(points, q, v).simplify() + J * v[0] ** 2 / 2
    return System(list(q), list(v), T, U + k * (length - a) ** 2, [Q[0] + tau, *Q[1:]], [tau], [m, mArm, mSlider, J, L, a, k, c, g])


DEFINITIONS = {"VanDerPol": van_der_pol, "StiffGovernor": flyball_governor}


@dataclass
class StiffProblem:
    """A stiff problem."""

    name: str
    system: str  # name of the FMU
    end: float  # s
    steps: int  # number of communication steps, where there are many: a multiple of POINTS
    values: dict = field(default_factory=dict)  # start values and parameters other than the FMU's
    input: tuple = ()  # (name, amplitude) of an input that can change at every step
    tightest: float = 1e-12  # tightest tolerance; below it rounding errors dominate

    @property
    def ways(self):
        return ["one step", "many steps"] + (["an input that changes at every step"] if self.input else [])

    def communication(self, way):
        """Return the number of communication steps and the changing input, or (), of a way of communication."""
        return (1 if way == "one step" else self.steps), (self.input if way.startswith("an input") else ())

    @property
    def times(self):
        return self.end * np.arange(1, POINTS + 1) / POINTS

    @functools.cached_property
    def definition(self):
        """SymPy's derivation of the system; None if there is none."""
        if self.system in DEFINITIONS:
            return DEFINITIONS[self.system]()
        return systems_in_sympy.system(self.system) if self.system in systems_in_sympy.DEFINITIONS else None

    @functools.cached_property
    def all_values(self):
        """All start values and parameters by name."""
        variables = description_of("auto", self.system).modelVariables
        return {v.name: float(v.start) for v in variables if v.start is not None} | self.values

    @functools.cached_property
    def states(self):
        derivatives = description_of("auto", self.system).derivatives
        names = [unknown.variable.derivative.name for unknown in derivatives]
        return [name for name in names if name != "nonConservativeWork"]


def elastic(k, ratio):
    values = dict(m=1.0, k=k, c=2 * ratio * float(np.sqrt(k)))
    name = f"ElasticPendulum, k = {k:g}, damping ratio {ratio:g}"
    return StiffProblem(name, "ElasticPendulum", 5.0, 500, values, tightest=1e-12 if k < 1e8 else 1e-10)


def damped(b):
    """Return the damped pendulum, over the time in which it creeps down."""
    return StiffProblem(f"DampedPendulum, b = {b:g}", "DampedPendulum", round(b / 9.81), 200, dict(b=b), ("tau", 5.0))


def relaxation(mu):
    """Return van der Pol's oscillator, over two of its periods, (3 - 2 log 2) mu each."""
    return StiffProblem(f"VanDerPol, mu = {mu:g}", "VanDerPol", 3.2 * mu, 200, dict(mu=mu), ("F", 0.1))


PROBLEMS = [
    *(elastic(k, ratio) for k in (1e4, 1e6, 1e8, 1e10) for ratio in (0.01, 0.1, 1.0, 10.0)),
    *map(damped, (1e2, 1e4, 1e6, 1e8)),
    *map(relaxation, (1e2, 1e4, 1e6)),
    StiffProblem("StiffGovernor", "StiffGovernor", 10.0, 200, input=("tau", 5.0)),
]
if (ROOT / "fmu" / "Rope").exists():
    PROBLEMS.append(StiffProblem("Rope", "Rope", 2.0, 200, tightest=1e-10))
QUICK = [replace(elastic(1e6, 1.0), steps=200), damped(1e6), relaxation(1e2)]


def right_states(problem, way):
    """
    Return the reference: the states at the problem's times, a row each; a description of its check; and the largest difference.

    The reference is cached in build/report/references.
    """
    steps, changing = problem.communication(way)
    if not changing:
        steps = POINTS
    equations = repr(problem.definition.terms) if problem.definition else problem.system
    levels = [changing_input(changing[1], k) for k in range(steps)] if changing else []
    words = [problem.all_values, problem.end, steps, changing, levels, STAGES if problem.definition else BY_SOLVERS, equations]
    key = hashlib.sha256(json.dumps(words).encode()).hexdigest()[:16]
    path = REFERENCES / f"{problem.system}-{key}.npz"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        both = (by_collocation if problem.definition else by_solvers)(problem, steps, changing)
        np.savez(path, states=both[0], difference=np.max(relative(both[1], both[0])))
    kept = np.load(path)
    names = [f"{solver} at {tolerance:g}" for solver, tolerance in BY_SOLVERS]
    text = f"collocation with {STAGES[0]} and {STAGES[1]} stages" if problem.definition else " and ".join(names)
    return kept["states"], text, float(kept["difference"])


def by_collocation(problem, steps, changing):
    f = extended_right_side(problem.definition, problem.all_values)
    start = [problem.all_values[state] for state in problem.states]
    changes = lambda k: {changing[0]: changing_input(changing[1], k)} if changing else {}
    return [trajectory(f, start, problem.times, steps, changes, stages) for stages in STAGES]


def by_solvers(problem, steps, changing):
    """Return the reference and its check by two methods at tight tolerances, for systems without a derivation by SymPy."""
    runs = []
    for solver, tolerance in BY_SOLVERS:
        runs.append(step(solver, problem.system, problem.values, problem.end, tolerance, steps, 0, timeout=LIMIT, changing=changing))
        if runs[-1] is None:
            raise ArithmeticError(f"{solver} did not come to the end of its reference, at a tolerance of {tolerance:g}, within {LIMIT} s")
    return [run.columns(problem.states) for run in runs]


def relative(states, exact):
    """Return the differences in units of max(1, |state|)."""
    return np.abs(states - exact) / np.maximum(1, np.abs(exact))
