"""
Differentiate one number of a motion by many parameters, start values and inputs.

For x' = f(t, x, p) and the number G = sum_i g_i(x(t_i)) + integral of h(x) dt, the adjoint equation is a' = -(df/dx)^T a - (dh/dx)^T, solved
backwards, with a jump of (dg_i/dx)^T at t_i. Then dG/dp = integral of (df/dp)^T a dt + (dx(0)/dp)^T a(0). The FMU evaluates (df/dx)^T a and
(df/dp)^T a in one reverse sweep (adjoint derivatives of FMI 3.0). At an event a is multiplied by the transposed saltation matrix. The cost does
not depend on the number of parameters, unless an event or the start depends on them (Y. Cao, S. Li, L. Petzold, R. Serban: Adjoint sensitivity
analysis for differential-algebraic equations, 2003).
"""

from dataclasses import dataclass

import numpy as np

from .experiment import Experiment, check_noise
from .model_exchange import opened
from .problem import Problem
from .quantities import numbers_of
from .sensitivity import Motion, acting_of, check_names, check_tolerance, start_slopes
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
    times: list  # of the steps: one more than steps
    steps: list  # dense outputs of SciPy

    def states(self):
        """Return the states as a function of time."""
        return OdeSolution(self.times, self.steps)


@dataclass
class Jump:
    """The derivatives of the states after an event (transposed saltation matrix): a row for each state before it, and for each parameter."""

    by_states: np.ndarray  # n x n
    by_acting: np.ndarray  # parameters x n


class Trail(Motion):
    """A motion that records its phases and jumps, so that the adjoint equation can follow it back."""

    def __init__(self, point, of, acting, tolerance):
        super().__init__(point, of, [], tolerance)
        self.known_acting, self.trail = acting, []

    def begin_phase(self, time):
        self.trail.append(Phase(self.model.getFMUState(), [time], []))

    def add_step(self, end, dense):
        phase = self.trail[-1]
        if end > phase.times[-1]:
            phase.times.append(end)
            phase.steps.append(dense)

    def pass_over(self, event, dense, before, inputs):
        count, more = len(self.state_references), len(self.known_acting)
        slopes = np.vstack([np.eye(count), np.zeros((more, count))])
        acting = [*([] for _ in range(count)), *([reference] for reference in self.known_acting)]
        state, found = self.saltation(event, dense, before, inputs).pass_over(slopes, acting)
        self.trail.append(Jump(found[:count], found[count:]))
        return state

    def forget(self):
        """Free the FMU states of all phases."""
        for part in self.trail:
            if isinstance(part, Phase):
                self.model.freeFMUState(part.saved)


class WayBack:
    """
    The adjoint equation along a Trail.

    The vector `now` has the n adjoint variables, the derivatives by the parameters accumulated so far, and the value of the integral.
    """

    def __init__(self, trail, running, inputs):
        """Begin at the end of the trail; `running` lists the references of the integrated variables."""
        self.trail, self.model, self.running, self.inputs = trail, trail.model, list(running), inputs
        self.state_count = len(trail.state_references)
        self.knowns = [*trail.state_references, *trail.known_acting]
        self.now = np.zeros(len(self.knowns) + 1)
        self.step = None

    def rates(self, time, now, states):
        """Return the right-hand side of the adjoint equation; states(time) is the motion."""
        self.trail.place(time, states(time), self.inputs)
        found = self.back([*self.trail.rate_references, *self.running], [*now[: self.state_count], *(1.0 for _ in self.running)])
        return -np.append(found, sum(self.model.getReal(self.running)) if self.running else 0.0)

    def jacobian(self, time, states):
        """Return the derivative of rates() by the vector `now`."""
        self.trail.place(time, states(time), self.inputs)
        found = np.zeros((len(self.now), len(self.now)))
        for i, seed in enumerate(np.eye(self.state_count)):
            found[:-1, i] = -self.back(self.trail.rate_references, seed)
        return found

    def go(self, begin, end, states):
        """Integrate backwards from `end` to `begin`."""
        if not begin < end:
            return
        first = None if self.step is None else min(self.step, end - begin)
        span, what = (end, begin), "the motion cannot be followed back"
        steps = Steps(lambda time, now: self.rates(time, now, states), lambda time, now: self.jacobian(time, states), span, self.now, self.trail.tolerance, what, first)
        sizes = []
        while steps.take():
            sizes.append(steps.solver.step_size)
        self.now = steps.solver.y
        self.step = sizes[-2] if len(sizes) > 1 else max(self.step or 0.0, sizes[-1])  # the last step is shortened to end at `begin`

    def add(self, time, weights, states):
        """Add the jump of the adjoint variables by the variables that are read at this time, times their weights."""
        self.trail.place(time, states(time), self.inputs)
        self.now[:-1] += self.back(self.trail.read_references, weights)

    def back(self, unknowns, weights):
        """Return the derivatives of the weighted sum of the unknowns by each known."""
        hidden, pairs = self.trail.hidden, list(zip(unknowns, weights))
        asked = [pair for pair in pairs if pair[0] not in hidden]
        found = self.model.adjoint([unknown for unknown, _ in asked], self.knowns, [weight for _, weight in asked]) if asked else np.zeros(len(self.knowns))
        for reference, weight in pairs:
            if reference in hidden:
                found[hidden[reference]] += weight
        return found

    def along(self, phase, readings):
        """Integrate backwards through a phase; pop its readings, (time, weights), from the end of the list `readings`."""
        states, end, begin = phase.states(), phase.times[-1], phase.times[0]
        self.model.setFMUState(phase.saved)
        while readings and readings[-1][0] > begin:
            time, weights = readings.pop()
            self.go(time, end, states)
            self.add(time, weights, states)
            end = time
        self.go(begin, end, states)

    def over(self, jump):
        """Apply the jump of an event to the adjoint variables and the derivatives."""
        by_state = self.now[: self.state_count].copy()
        self.now[: self.state_count] = jump.by_states @ by_state
        self.now[self.state_count : -1] += jump.by_acting @ by_state


@dataclass(frozen=True)
class Aim:
    """The number to differentiate: a function of the values at n times, or the integral of the values."""

    of: list  # names of the variables that it depends on
    times: np.ndarray  # n, in s
    value: object  # function of the values, an array n x of, that returns the number
    weights: object  # function of the values that returns the derivatives of the number by them, n x of
    is_integral: bool = False
    inputs: object = None  # function of time that returns names and values, or None
    kinks: object = ()  # times, in s, at which an input changes its slope


def _aim_at_end(name, stop_time, integral):
    return Aim([name], np.array([0.0, stop_time]), lambda values: values[-1, 0], lambda values: np.array([[0.0], [1.0]]), integral)


def _aim_at_data(experiment):
    return Aim(
        experiment.measured,
        experiment.data["time"],
        lambda values: (experiment.off(values) ** 2).sum(),
        lambda values: 2 * experiment.off(values) / experiment.noise,
        inputs=experiment.signals,
        kinks=experiment.kinks(),
    )


def _aim(point, of, data, stop_time, integral, noise):
    if (of is None) == (data is None):
        raise Problem("expected the name of a variable to differentiate, or data whose squared differences are differentiated")
    if data is not None:
        experiment = Experiment(data, point, noise)
        check_noise(noise, [experiment])
        return _aim_at_data(experiment)
    if stop_time is None or not 0 < stop_time < np.inf:
        raise Problem(f"the stop time is {stop_time}; expected one later than 0 s")
    return _aim_at_end(of, stop_time, integral)


def gradient(system, of, by, stop_time, data, integral, noise, start_values, tolerance):
    """See lagrange_fmu.gradient."""
    check_tolerance(tolerance)
    with opened(system, dict(start_values), what="be followed", adjoint=True) as point:
        aim = _aim(point, of, data, stop_time, integral, numbers_of(noise, point.units))
        check_names(point, aim.of, by)
        acting = acting_of(point, by)
        start, slopes = start_slopes(point, by, {})
        trail = Trail(point, aim.of, [reference for references in acting for reference in references], tolerance)
        values, _ = trail.over(aim.times, {}, aim.inputs, aim.kinks)
        found = _back(trail, aim, values)
        trail.forget()
    count = len(start)
    derivatives = slopes @ found[:count]
    derivatives[[bool(references) for references in acting]] += found[count:-1]
    return Gradient(float(found[-1] if aim.is_integral else aim.value(values)), dict(zip(by, derivatives.tolist())))


def _back(trail, aim, values):
    weights = np.zeros_like(values) if aim.is_integral else aim.weights(values)
    size = np.max(abs(weights)) or 1.0  # scaling to 1 makes the tolerance relative to the weights
    readings = [(time, row) for time, row in zip(aim.times, weights / size) if row.any()]
    way = WayBack(trail, trail.read_references if aim.is_integral else [], aim.inputs)
    for part in reversed(trail.trail):
        if isinstance(part, Jump):
            way.over(part)
        else:
            way.along(part, readings)
    if readings:
        first = trail.trail[0]
        way.add(*readings.pop(), first.states())
    return way.now * size
