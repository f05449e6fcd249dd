"""Solve the stiff problems by other programs: SciPy, with SymPy's equations, and exudyn, with bodies, springs and dampers."""

import contextlib
import io
import time
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from numerics.mechanisms.peers import Exudyn
from numerics.mechanisms.problems import GROUND, Body, Joint, Planar
from numerics.programs import with_time_limit, silence

PATIENCE = 5.0  # s, after which a run is stopped
STEPS = [100, 300, 1000, 3000, 10000, 30000, 100000, 300000]  # numbers of steps of exudyn, whose implicit methods have no error control


def scipy_method(method):
    """Return a function that solves a problem by a method of SciPy, with the right-hand side that SymPy writes for NumPy."""

    def run(problem, tolerance):
        definition, values = problem.definition, problem.all_values
        inputs, parameters = [values[u.name] for u in definition.inputs], [values[p.name] for p in definition.parameters]
        right_side = with_time_limit(definition.right_side(lambda t: inputs, parameters), PATIENCE)
        start, begin = [values[state] for state in problem.states], time.process_time()
        solution = solve_ivp(right_side, (0, problem.end), start, method=method, rtol=tolerance, atol=tolerance, t_eval=[problem.end])
        return (time.process_time() - begin, solution.y[:, -1]) if solution.success else None

    return run


def bob(values, length, **what):
    """Return a mass point that is released at the angle theta from the downward vertical."""
    centre = length * np.array([np.sin(values["theta"]), -np.cos(values["theta"])])
    return Planar([Body(values["m"], 0.0, centre)], gravity=values["g"], **what)


def on_a_spring(values):
    start = bob(values, values["r"], joints=[]).bodies[0].centre
    return bob(values, values["r"], joints=[], spring=(0, start, np.zeros(2), values["k"], values["l0"]), damping=values["c"])


def on_a_rod(values):
    """Return a mass point on a rod. The damping of the hinge is equivalent to drag, since the mass moves perpendicular to the rod."""
    return bob(values, values["l"], joints=[Joint(0, GROUND, np.zeros(2))], drag=values["b"] / values["l"] ** 2)


PLANAR = {"ElasticPendulum": on_a_spring, "DampedPendulum": on_a_rod}
# Relative and absolute tolerance of exudyn's Newton method, where its own (1e-8, 1e-10) mistake creep for rest. Stiff springs do not allow these.
NEWTON = {"DampedPendulum": (1e-12, 1e-14)}


@dataclass
class Mechanism:
    """The attributes of a mechanism that Exudyn needs."""

    model: Planar
    end: float  # s


def polar(position, velocity):
    """Return length, angle from the downward vertical in [-pi, pi], and their rates."""
    (x, y, _), (vx, vy, _) = position, velocity
    length = np.hypot(x, y)
    return {"r": length, "theta": np.arctan2(x, -y), "vr": (x * vx + y * vy) / length, "omega": (x * vy - y * vx) / length**2}


def exudyn_method(solver):
    """Return a function that solves a problem by an implicit method of exudyn, with a number of fixed steps."""

    def run(problem, steps):
        with silence(), contextlib.redirect_stdout(io.StringIO()):
            model = Exudyn(Mechanism(PLANAR[problem.system](problem.all_values), problem.end), steps, solver)
            newton = model.settings.timeIntegration.newton
            if problem.system in NEWTON:
                newton.relativeTolerance, newton.absoluteTolerance = NEWTON[problem.system]
            begin = time.process_time()
            model.run()
            seconds = time.process_time() - begin
        state = polar(*(rows[-1] for rows in model.recorded(1)))
        return seconds, np.array([state[name] for name in problem.states])

    return run


TOLERANCES = [1e-4, 1e-6, 1e-8, 1e-10]

# Name: (function, tolerances or numbers of steps, systems that it can express; None: all systems with a derivation by SymPy).
PEERS = {
    "SciPy Radau": (scipy_method("Radau"), TOLERANCES, None),
    "SciPy LSODA": (scipy_method("LSODA"), TOLERANCES, None),
    "exudyn generalized-alpha": (exudyn_method("GeneralizedAlpha"), STEPS, PLANAR),
    "exudyn trapezoidal, index 2": (exudyn_method("TrapezoidalIndex2"), STEPS, PLANAR),
}


def can_express(peer, problem):
    _, _, systems = PEERS[peer]
    return problem.definition is not None if systems is None else problem.system in systems
