"""
Compute time-optimal motions by direct collocation.

The problem is min T subject to x' = f(x, u), x(0) = start, x(T) = end, and bounds on inputs and states. The inputs are constant in each interval. The
states are polynomials that satisfy the equations at Radau points, of order 2 points - 1 at the intervals' ends (L. Biegler: Nonlinear programming,
2010, chapter 10). IPOPT solves the nonlinear program; CasADi gets f and its derivatives from the FMU. The co-simulation FMU with these inputs
verifies the motion.
"""

from typing import NamedTuple

import casadi
import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

from scripts.library.problem import Problem

LONGEST = 10.0  # s, upper bound of T


class Task(NamedTuple):
    """A time-optimal motion between two states, with bounded inputs."""

    fmu: str  # name of the FMU
    states: list  # names
    inputs: list  # names
    start: np.ndarray  # states
    end: np.ndarray  # states
    strength: np.ndarray  # bounds of |input|
    state_bounds: dict  # bounds of |state|, by the index of the state
    duration: float  # initial guess of T, in s
    swings: float  # periods of a sine, the initial guess of the inputs
    intervals: int  # number of intervals with constant inputs
    points: int  # Radau points in each interval
    parameters: dict  # values by name, where they differ from those of the FMU
    has_hessian: bool  # True for a Hessian by differences of the FMU's derivatives; False for IPOPT's limited-memory BFGS, cheaper with many states


class OptimalMotion(NamedTuple):
    """A time-optimal motion."""

    times: np.ndarray  # times of the intervals' boundaries in s
    states: np.ndarray  # a row for each boundary
    inputs: np.ndarray  # a row for each interval
    iterations: int  # iterations of IPOPT


def slopes_of(unpacked, task):
    """Return the CasADi function f(x, u) of the FMU, with derivatives; x and u are in the order of the task."""
    builder = casadi.DaeBuilder("system", str(unpacked), {})
    for name, value in task.parameters.items():
        builder.set(name, value)
    states, inputs = casadi.MX.sym("x", len(task.states)), casadi.MX.sym("u", len(task.inputs))
    inner = casadi.vertcat(*(states[task.states.index(name)] for name in builder.x()))
    outer = casadi.vertcat(*(inputs[task.inputs.index(name)] for name in builder.u()))
    slopes = builder.create("f", ["x", "u"], ["ode"])(inner, outer)
    return casadi.Function("slopes", [states, inputs], [slopes[[builder.x().index(name) for name in task.states]]])


def _guess(task, taus):
    """Return the initial guess: states on a straight line, at the intervals' boundaries and at the Radau points, and sinusoidal inputs."""
    way = lambda share: task.start + share * (task.end - task.start)
    shares = np.arange(task.intervals + 1) / task.intervals
    within = [(k + tau) / task.intervals for k in range(task.intervals) for tau in taus]
    swinging = np.sin(2 * np.pi * task.swings * shares[:-1])
    return np.transpose([way(share) for share in shares]), np.transpose([way(share) for share in within]), np.outer(task.strength, swinging) / 2


def least_time(unpacked, task):
    """Return the OptimalMotion, a local minimum that IPOPT finds."""
    taus = casadi.collocation_points(task.points, "radau")
    slope_matrix, end_row, _ = casadi.collocation_coeff(taus)
    slopes = slopes_of(unpacked, task).map(task.intervals * task.points)
    problem = casadi.Opti()
    duration, count = problem.variable(), len(task.states)
    starts, within = problem.variable(count, task.intervals + 1), problem.variable(count, task.intervals * task.points)
    inputs = problem.variable(len(task.inputs), task.intervals)
    rates = duration / task.intervals * slopes(within, casadi.kron(inputs, casadi.DM.ones(1, task.points)))
    for k in range(task.intervals):
        part = slice(k * task.points, (k + 1) * task.points)
        values = casadi.horzcat(starts[:, k], within[:, part])
        problem.subject_to(casadi.mtimes(values, slope_matrix) == rates[:, part])
        problem.subject_to(starts[:, k + 1] == casadi.mtimes(values, end_row))
    problem.subject_to(starts[:, 0] == task.start)
    problem.subject_to(starts[:, task.intervals] == task.end)
    for row, bound in enumerate(task.strength):
        problem.subject_to(problem.bounded(-bound, casadi.vec(inputs[row, :]), bound))
    for row, bound in task.state_bounds.items():
        problem.subject_to(problem.bounded(-bound, casadi.vec(starts[row, 1 : task.intervals]), bound))
    problem.subject_to(problem.bounded(0.1, duration, LONGEST))
    problem.minimize(duration)
    problem.set_initial(duration, task.duration)
    for variable, value in zip((starts, within, inputs), _guess(task, taus)):
        problem.set_initial(variable, value)
    options = {} if task.has_hessian else {"hessian_approximation": "limited-memory", "limited_memory_max_history": 50}
    problem.solver("ipopt", {"print_time": False}, {"tol": 1e-9, "max_iter": 3000, "print_level": 0, "sb": "yes", **options})
    try:
        solution = problem.solve()
    except RuntimeError:
        status = problem.stats()["return_status"].replace("_", " ")
        raise Problem(f"IPOPT finds no motion of {task.fmu} between the two states: {status}; expected other parameters, or another start") from None
    times = np.linspace(0.0, solution.value(duration), task.intervals + 1)
    return OptimalMotion(times, np.transpose(solution.value(starts)), np.transpose(np.atleast_2d(solution.value(inputs))), solution.stats()["iter_count"])


def play_back(unpacked, task, motion):
    """Return the states at the intervals' boundaries, simulated by the co-simulation FMU with the inputs of the motion."""
    description = fmpy.read_model_description(str(unpacked))
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = FMU2Slave(guid=description.guid, unzipDirectory=str(unpacked), modelIdentifier=description.coSimulation.modelIdentifier, instanceName="player")
    slave.instantiate()
    slave.setupExperiment(tolerance=1e-12, startTime=0.0)
    slave.setReal([references[name] for name in task.parameters], list(task.parameters.values()))
    places, inputs = ([references[name] for name in names] for names in (task.states, task.inputs))
    slave.setReal(places, motion.states[0])
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    rows = [slave.getReal(places)]
    for start, end, values in zip(motion.times, motion.times[1:], motion.inputs):
        slave.setReal(inputs, values)
        slave.doStep(start, end - start)
        rows.append(slave.getReal(places))
    slave.terminate()
    slave.freeInstance()
    return np.array(rows)
