"""
Differentiate one number of a motion by many parameters, start values and inputs.

For x' = f(t, x, p) and the number G = sum_i g_i(x(t_i)) + integral of h(x) dt, the adjoint equation is a' = -(df/dx)^T a - (dh/dx)^T. It is solved
backwards, with a jump of (dg_i/dx)^T at t_i. Then dG/dp = integral of (df/dp)^T a dt + (dx(0)/dp)^T a(0). The FMU evaluates (df/dx)^T a and (df/dp)^T
a in one reverse sweep (adjoint derivatives of FMI 3.0). At an event a is multiplied by the transposed saltation matrix. The cost does not depend on
the number of parameters, unless an event or the start depends on them (Y. Cao, S. Li, L. Petzold, R. Serban: Adjoint sensitivity analysis for
differential-algebraic equations, 2003).
"""

from dataclasses import dataclass

import numpy as np

from . import with_scipy  # noqa: F401, first, since it raises Problem if SciPy is missing
from .experiment import Experiment, check_noise
from .model_exchange import opened
from .problem import Problem
from .quantities import numbers_of
from .sensitivity import DifferentiableMotion, acting_of, check_names, start_slopes
from .stepping import Steps

from scipy.integrate import OdeSolution  # isort: skip


@dataclass(frozen=True)
class Gradient:
    """A number and its derivatives, in SI units."""

    value: float
    derivatives: dict  # by name


@dataclass
class Phase:
    """A phase of smooth motion, between events and kinks of inputs."""

    saved: object  # the FMU state at its begin, with the modes of the phase
    times: list  # ends of the steps: one more than steps
    steps: list  # dense outputs of SciPy

    def states(self):
        """Return the states as a function of time."""
        return OdeSolution(self.times, self.steps)


@dataclass
class Jump:
    """The derivatives of the states after an event (transposed saltation matrix): a row for each state before it, and for each parameter."""

    by_states: np.ndarray  # n x n
    by_acting: np.ndarray  # parameters x n


class RecordedMotion(DifferentiableMotion):
    """A motion that records its phases and jumps, so that the adjoint equation can follow it back."""

    def __init__(self, point, of, acting, tolerance):
        super().__init__(point, of, [], tolerance)
        self.known_acting, self.parts = acting, []

    def begin_phase(self, time):
        self.parts.append(Phase(self.model.getFMUState(), [time], []))

    def add_step(self, end, dense):
        phase = self.parts[-1]
        if end > phase.times[-1]:
            phase.times.append(end)
            phase.steps.append(dense)

    def handle_event(self, event, dense, before, inputs):
        count, more = len(self.state_references), len(self.known_acting)
        slopes = np.vstack([np.eye(count), np.zeros((more, count))])
        acting = [*([] for _ in range(count)), *([reference] for reference in self.known_acting)]
        state, found = self.saltation(event, dense, before, inputs).handle_event(slopes, acting)
        self.parts.append(Jump(found[:count], found[count:]))
        return state

    def free(self):
        """Free the FMU states of all phases."""
        for part in self.parts:
            if isinstance(part, Phase):
                self.model.freeFMUState(part.saved)


class AdjointMotion:
    """
    The adjoint equation along a RecordedMotion.

    The vector `adjoint` has the n adjoint variables, the derivatives by the parameters accumulated so far, and the value of the integral.
    """

    def __init__(self, motion, running, inputs):
        """Begin at the end of the trail; `running` lists the references of the integrated variables."""
        self.motion, self.model, self.running, self.inputs = motion, motion.model, list(running), inputs
        self.state_count = len(motion.state_references)
        self.knowns = [*motion.state_references, *motion.known_acting]
        self.adjoint = np.zeros(len(self.knowns) + 1)
        self.step = None

    def rates(self, time, adjoint, states):
        """Return the right-hand side of the adjoint equation; states(time) is the motion."""
        self.motion.set_point(time, states(time), self.inputs)
        found = self.weighted_derivatives([*self.motion.rate_references, *self.running], [*adjoint[: self.state_count], *(1.0 for _ in self.running)])
        return -np.append(found, sum(self.model.getReal(self.running)) if self.running else 0.0)

    def jacobian(self, time, states):
        """Return the derivative of rates() by the vector `adjoint`."""
        self.motion.set_point(time, states(time), self.inputs)
        found = np.zeros((len(self.adjoint), len(self.adjoint)))
        for i, seed in enumerate(np.eye(self.state_count)):
            found[:-1, i] = -self.weighted_derivatives(self.motion.rate_references, seed)
        return found

    def integrate(self, begin, end, states):
        """Integrate backwards from `end` to `begin`."""
        if not begin < end:
            return
        first = None if self.step is None else min(self.step, end - begin)
        span, what = (end, begin), "the motion cannot be followed back"
        steps = Steps(lambda time, adjoint: self.rates(time, adjoint, states), lambda time, adjoint: self.jacobian(time, states), span, self.adjoint, self.motion.tolerance, what, first)
        sizes = []
        while steps.take():
            sizes.append(steps.solver.step_size)
        self.adjoint = steps.solver.y
        self.step = sizes[-2] if len(sizes) > 1 else max(self.step or 0.0, sizes[-1])  # the last step is shortened to end at `begin`

    def add_weights(self, time, weights, states):
        """Add the jump of the adjoint variables by the variables that are read at this time, times their weights."""
        self.motion.set_point(time, states(time), self.inputs)
        self.adjoint[:-1] += self.weighted_derivatives(self.motion.read_references, weights)

    def weighted_derivatives(self, unknowns, weights):
        """Return the derivatives of the weighted sum of the unknowns by each known."""
        hidden, pairs = self.motion.hidden, list(zip(unknowns, weights))
        visible = [pair for pair in pairs if pair[0] not in hidden]
        found = self.model.adjoint([unknown for unknown, _ in visible], self.knowns, [weight for _, weight in visible]) if visible else np.zeros(len(self.knowns))
        for reference, weight in pairs:
            if reference in hidden:
                found[hidden[reference]] += weight
        return found

    def pass_phase(self, phase, readings):
        """Integrate backwards through a phase; pop its readings, (time, weights), from the end of the list `readings`."""
        states, end, begin = phase.states(), phase.times[-1], phase.times[0]
        self.model.setFMUState(phase.saved)
        while readings and readings[-1][0] > begin:
            time, weights = readings.pop()
            self.integrate(time, end, states)
            self.add_weights(time, weights, states)
            end = time
        self.integrate(begin, end, states)

    def pass_jump(self, jump):
        """Apply the jump of an event to the adjoint variables and the derivatives."""
        by_state = self.adjoint[: self.state_count].copy()
        self.adjoint[: self.state_count] = jump.by_states @ by_state
        self.adjoint[self.state_count : -1] += jump.by_acting @ by_state


@dataclass(frozen=True)
class Objective:
    """The number to differentiate: a function of the values at n times, or the integral of the values."""

    of: list  # names of the variables that it depends on
    times: np.ndarray  # n, in s
    value: object  # function of the values, an array n x of, that returns the number
    weights: object  # function of the values that returns the derivatives of the number by them, n x of
    is_integral: bool = False
    inputs: object = None  # function of time that returns names and values, or None
    kinks: object = ()  # times, in s, at which an input changes its slope


def _objective_at_end(name, stop_time, integral):
    return Objective([name], np.array([0.0, stop_time]), lambda values: values[-1, 0], lambda values: np.array([[0.0], [1.0]]), integral)


def _objective_of_data(experiment):
    return Objective(
        experiment.measured,
        experiment.data["time"],
        lambda values: (experiment.off(values) ** 2).sum(),
        lambda values: 2 * experiment.off(values) / experiment.noise,
        inputs=experiment.signals,
        kinks=experiment.kinks(),
    )


def _objective(point, of, data, stop_time, integral, noise):
    if (of is None) == (data is None):
        raise Problem("expected the name of a variable to differentiate, or data whose squared differences are differentiated")
    if data is not None:
        experiment = Experiment(data, point, noise)
        check_noise(noise, [experiment])
        return _objective_of_data(experiment)
    if stop_time is None or not 0 < stop_time < np.inf:
        raise Problem(f"the stop time is {stop_time}; expected one later than 0 s")
    return _objective_at_end(of, stop_time, integral)


def gradient(system, of, by, stop_time, data, integral, noise, start_values, tolerance):
    """See lagrange_fmu.gradient."""
    with opened(system, dict(start_values), what="be followed", adjoint=True) as point:
        objective = _objective(point, of, data, stop_time, integral, numbers_of(noise, point.units))
        check_names(point, objective.of, by)
        acting = acting_of(point, by)
        start, slopes = start_slopes(point, by, {})
        motion = RecordedMotion(point, objective.of, [reference for references in acting for reference in references], tolerance)
        values, _ = motion.over(objective.times, {}, objective.inputs, objective.kinks)
        found = _integrate_backwards(motion, objective, values)
        motion.free()
    count = len(start)
    derivatives = slopes @ found[:count]
    derivatives[[bool(references) for references in acting]] += found[count:-1]
    return Gradient(float(found[-1] if objective.is_integral else objective.value(values)), dict(zip(by, derivatives.tolist())))


def _integrate_backwards(motion, objective, values):
    weights = np.zeros_like(values) if objective.is_integral else objective.weights(values)
    size = np.max(abs(weights)) or 1.0  # scaling to 1 makes the tolerance relative to the weights
    readings = [(time, row) for time, row in zip(objective.times, weights / size) if row.any()]
    backwards = AdjointMotion(motion, motion.read_references if objective.is_integral else [], objective.inputs)
    for part in reversed(motion.parts):
        if isinstance(part, Jump):
            backwards.pass_jump(part)
        else:
            backwards.pass_phase(part, readings)
    if readings:
        first = motion.parts[0]
        backwards.add_weights(*readings.pop(), first.states())
    return backwards.adjoint * size
