"""
Motions in least time, by collocation: CasADi reads the FMU, IPOPT solves the collocated problem with the FMU's derivatives, and the
co-simulation FMU plays the inputs back.
"""

from typing import NamedTuple

import casadi
import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

LONGEST = 10.0  # s


class Task(NamedTuple):
    """From rest to rest, and back to the same inputs' bounds."""

    fmu: str  # its name
    states: list  # names, and of the inputs
    inputs: list
    start: np.ndarray
    end: np.ndarray
    strength: np.ndarray  # the bounds of the inputs, on both sides
    reach: dict  # by the number of a state: its bounds, on both sides
    duration: float  # a guess, in s
    swings: float  # how often the inputs change their sign, as a guess
    intervals: int  # of constant inputs
    points: int  # Radau points in each, so that the error at its end is of order 2 points - 1
    has_hessian: bool  # by differences of the FMU's derivatives; else IPOPT gathers it, which is cheaper with many states


class Motion(NamedTuple):
    times: np.ndarray  # s, of the intervals' ends
    states: np.ndarray  # a row for each of them
    inputs: np.ndarray  # a row for each interval
    iterations: int  # of IPOPT


def slopes_of(unpacked, task):
    """d state / dt of states and inputs, evaluated by the FMU, with derivatives."""
    builder = casadi.DaeBuilder("system", str(unpacked), {})
    states, inputs = casadi.MX.sym("x", len(task.states)), casadi.MX.sym("u", len(task.inputs))
    inner = casadi.vertcat(*(states[task.states.index(name)] for name in builder.x()))
    outer = casadi.vertcat(*(inputs[task.inputs.index(name)] for name in builder.u()))
    slopes = builder.create("f", ["x", "u"], ["ode"])(inner, outer)
    return casadi.Function("slopes", [states, inputs], [slopes[[builder.x().index(name) for name in task.states]]])


def _guess(task, taus):
    """Straight from the start to the end: the states at the intervals' ends and within, and the inputs."""
    way = lambda share: task.start + share * (task.end - task.start)
    shares = np.arange(task.intervals + 1) / task.intervals
    within = [(k + tau) / task.intervals for k in range(task.intervals) for tau in taus]
    swinging = np.sin(2 * np.pi * task.swings * shares[:-1])
    return np.transpose([way(share) for share in shares]), np.transpose([way(share) for share in within]), np.outer(task.strength, swinging) / 2


def least_time(unpacked, task):
    """The fastest Motion that IPOPT finds."""
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
    for row, bound in task.reach.items():
        problem.subject_to(problem.bounded(-bound, casadi.vec(starts[row, 1 : task.intervals]), bound))
    problem.subject_to(problem.bounded(0.1, duration, LONGEST))
    problem.minimize(duration)
    problem.set_initial(duration, task.duration)
    for variable, value in zip((starts, within, inputs), _guess(task, taus)):
        problem.set_initial(variable, value)
    options = {} if task.has_hessian else {"hessian_approximation": "limited-memory", "limited_memory_max_history": 50}
    problem.solver("ipopt", {"print_time": False}, {"tol": 1e-9, "max_iter": 3000, "print_level": 0, "sb": "yes", **options})
    solution = problem.solve()
    times = np.linspace(0.0, solution.value(duration), task.intervals + 1)
    return Motion(times, np.transpose(solution.value(starts)), np.transpose(np.atleast_2d(solution.value(inputs))), solution.stats()["iter_count"])


def play_back(unpacked, task, motion):
    """The states at the intervals' ends by the co-simulation FMU, whose inputs are those of each interval."""
    description = fmpy.read_model_description(str(unpacked))
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = FMU2Slave(guid=description.guid, unzipDirectory=str(unpacked), modelIdentifier=description.coSimulation.modelIdentifier, instanceName="player")
    slave.instantiate()
    slave.setupExperiment(tolerance=1e-12, startTime=0.0)
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
