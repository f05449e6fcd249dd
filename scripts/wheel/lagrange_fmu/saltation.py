"""
Compute the saltation matrix, by which derivatives of a motion jump at an event.

A neighbouring motion x + s d meets the event later by the delay t(s), at another state, and leaves it at x+(s). Compared at the same time, the
derivative after the event is s+ = dx+/ds - f+ dt/ds, where f+ are the rates after the event (M. A. Aizerman, F. R. Gantmacher: Determination of
stability by linear approximation of a periodic solution of a system of differential equations with discontinuous right-hand sides, 1958).
The FMU itself handles the events of neighbours; finite differences of fourth order give dx+/ds and dt/ds. The secant method finds the delay.
The step shrinks until rules of second and fourth order agree. Each direction costs four events for each step that is tried.
"""

import itertools

import numpy as np
from fmpy.fmi1 import FMICallException
from scipy.optimize import brentq

from .differences import CENTRAL, difference, relevant, rules_within
from .problem import Problem

STEP = 1e-3  # first step of differences, relative to states and parameters
SHRINKING = 0.1  # factor of the next step after one that is too long
SHORTEST_OF_STATES, SHORTEST_OF_PARAMETERS = 1e-11, 1e-2  # shortest step, relative to the first one
ROUGH, UNKNOWN = 1e-5, 1e-2  # relative difference of second and fourth order: below ROUGH a step is short enough; above UNKNOWN there is no derivative
ROUNDING = 1e-16  # relative rounding error of states and times
TINY = 1e-300  # avoids divisions by 0
CROSSING_DELAY = 1e-12  # delay after a crossing at which the event is handled, in s; relative to the time after 1 s
SIMULTANEOUS = 1e-9  # events closer together than this count as simultaneous, in s; relative to the time after 1 s
ROUNDS = 100  # iterations of event mode at most
PERTURBATION = 1e-6  # relative and absolute perturbation of the states that violates constraints
EARLIER = 1e-2  # share of the flight before an event by which constraints are applied earlier
TRIALS, NEAR, CONVERGED = 30, 1e-16, 1e-13  # iterations of the secant method; its tolerances: in s, relative to the time after 1 s, and relative to the delay


def crossing_of(indicators, begin, end):
    """
    Locate the first change of sign of an event indicator between two times by Brent's method; indicators(time) returns an array.

    Return the time just after it and the index of the indicator, or None. Raise Problem if several events are simultaneous.
    """
    first, last = indicators(begin), indicators(end)
    crossing = np.flatnonzero(np.sign(first) * np.sign(last) < 0)
    if len(crossing) == 0:
        return None
    times = [brentq(lambda time: indicators(time)[k], begin, end, xtol=1e-15, rtol=4 * np.finfo(float).eps) for k in crossing]
    nearest = int(np.argmin(times))
    unit = max(1.0, abs(times[nearest]))
    if np.count_nonzero(np.array(times) < times[nearest] + SIMULTANEOUS * unit) > 1:
        raise Problem(f"several events coincide at {times[nearest]:g} s, so that the motion has no derivatives there; expected a stop time before them")
    return times[nearest] + CROSSING_DELAY * unit, crossing[nearest]


def stored_in_a_state(modes):
    """Return the remedy for modes that events set to values that depend on the motion."""
    return f"expected <state name=\"{modes[0]}\" rate=\"0\"/> with <set state> in place of the mode"


class OtherModes(Problem):
    """Neighbouring motions enter other modes at an event, so that the motion has no derivative."""


class Saltation:
    """
    An event of a motion.

    `time` is just after the crossing of the event indicator `indicator`, and `state` the state there before the event is handled. `saved` is an
    FMU state before the event, `rates` are the rates before it, and `level` is the indicator's value at `time`.
    """

    def __init__(self, motion, time, state, before, indicator, inputs):
        """Handle the event once to find the modes after it; `before` is a time and a state at which the event is not due yet."""
        self.motion, self.model, self.point, self.inputs = motion, motion.model, motion.point, inputs
        self.time, self.state, self.before, self.indicator = time, state, before, indicator
        motion.set_point(*before, inputs)
        self.saved = self.model.getFMUState()
        is_constrained = self.moves_onto_constraints()
        self.model.setFMUState(self.saved)
        motion.set_point(time, state, inputs)
        self.rates = np.array(self.model.getReal(motion.rate_references))
        self.level = self.point.indicators()[indicator]
        after = self.update()
        self.noise = ROUNDING / ROUGH * np.append(np.maximum(abs(state), abs(after)), max(1.0, abs(time)))
        self.modes = self.point.modes()
        self.back, self.own = EARLIER * (time - before[0]) if is_constrained else 0.0, 0.0
        if is_constrained:
            self.model.setFMUState(self.saved)
            self.own = self.by_constraints(state)

    def moves_onto_constraints(self):
        """Return True if event mode before the event moves perturbed states, that is, if the system has constraints there."""
        time, state = self.before
        off = state * (1 + PERTURBATION) + PERTURBATION
        self.motion.set_point(time, off, self.inputs)
        try:
            return (self.update() != off).any()
        except (Problem, FMICallException):
            self.point.messages.clear()
            return True

    def along(self, delay, state, span):
        """Return the state after a further time `span` from `state` at self.time + delay, by one step of the classical Runge-Kutta method."""

        def rates(share, state):
            self.motion.set_point(self.time + delay + share * span, state, self.inputs)
            return np.array(self.model.getReal(self.motion.rate_references))

        first = rates(0.0, state)
        second = rates(0.5, state + span / 2 * first)
        third = rates(0.5, state + span / 2 * second)
        return state + span / 6 * (first + 2 * second + 2 * third + rates(1.0, state + span * third))

    def by_constraints(self, state):
        """
        Return the displacement at the event by which the constraints move a neighbouring state.

        A projection at the event could undo or trigger it. The neighbour therefore goes back in time by `self.back`, is projected there, and returns.
        """
        delay = self.delay_of(state)
        early = self.along(delay, state + delay * self.rates, -self.back)
        self.motion.set_point(self.time + delay - self.back, early, self.inputs)
        return self.along(delay - self.back, self.update(), self.back) - (state + delay * self.rates)

    def update(self):
        """Iterate event mode at the present state until no further iteration is needed; return the states after it."""
        self.model.enterEventMode()
        for _ in range(ROUNDS):
            is_needed, ends, *_ = self.model.newDiscreteStates()
            if not is_needed or ends:
                break
        if is_needed or ends:
            raise Problem(f"{self.point.name} cannot continue after the event at {self.time:g} s")
        self.model.enterContinuousTimeMode()
        return self.point.read(self.point.states)

    def value_at(self, state, delay):
        """Return the event indicator at a state that has moved for a time `delay`."""
        self.motion.set_point(self.time + delay, state + delay * self.rates, self.inputs)
        return self.point.indicators()[self.indicator]

    def delay_of(self, state):
        """Return the delay of a neighbour's event in s, by the secant method. Raise Problem at a grazing event, which some neighbours miss."""
        unit = max(1.0, abs(self.time))
        known, value, delay = 0.0, self.value_at(state, 0.0), 1e-6 * unit
        for _ in range(TRIALS):
            now = self.value_at(state, delay)
            if now == value or abs(delay - known) < max(NEAR * unit, CONVERGED * abs(delay)):
                break
            known, value, delay = delay, now, delay - (now - self.level) * (delay - known) / (now - value)
        if not abs(delay) < 0.1 * unit:
            raise Problem(f"the event at {self.time:g} s is grazing: some neighbouring motions miss it, so that there is no derivative through it; expected other values, or a stop time before it")
        return delay

    def neighbour(self, shift, changes):
        """
        Return the state after the event followed by the delay, of a neighbour whose state is shifted.

        `changes` has the changes of parameters by reference. Raise Problem if the event fails, or leads to other modes.
        """
        self.model.setFMUState(self.saved)
        if changes:
            values = np.array(self.model.getReal([*changes])) + [*changes.values()]
            self.model.enterEventMode()
            self.model.setReal([*changes], values)
            self.model.newDiscreteStates()
            self.model.enterContinuousTimeMode()
        state = self.state + shift
        by = f"by {', '.join(self.point.names[reference] for reference in changes)} " if changes else ""
        try:
            if self.back > 0:
                state = state + self.by_constraints(state) - self.own
            delay = self.delay_of(state)
            self.motion.set_point(self.time + delay, state + delay * self.rates, self.inputs)
            after = self.update()
        except FMICallException:
            why = "; ".join(self.point.messages)
            raise Problem(f"the event at {self.time:g} s fails {by}for some neighbouring motions, so that there is no derivative: {why}; expected other values, or a min and a max that exclude them") from None
        differing = self.point.differing(self.modes, self.point.modes())
        if differing:
            raise OtherModes(self.mode_message(differing, by))
        return np.append(after, delay)

    def mode_message(self, names, by):
        """Return the message for a neighbour whose modes with these names differ after the event."""
        quoted = ", ".join(f"'{name}'" for name in names)
        if {*names} <= {*self.point.numbers}:
            return f"the event at {self.time:g} s sets {quoted} to numbers that vary {by}between neighbouring motions: derivatives by modes are not available, even where nothing depends on them; {stored_in_a_state(names)}, or a stop time before the event"
        return f"the event at {self.time:g} s leads some neighbouring motions into other modes, of {quoted}, so that there is no derivative {by}through it; expected other values, or a stop time before it"

    def sizes_of(self, acting):
        """Return the magnitudes of parameters by reference, 1 for zeros."""
        return {reference: abs(value) or 1.0 for reference, value in zip(acting, self.model.getReal(acting) if acting else ())}

    def rule_of(self, reference, step):
        """Return the difference rule whose points lie within the limits of a parameter."""
        self.model.setFMUState(self.saved)
        (value,) = self.model.getReal([reference])
        return rules_within(value, step, self.point.limits[self.point.names[reference]])[0]

    def change_along(self, direction):
        """Return the directional derivative of the state after the event and of the delay."""
        step = STEP * min(np.maximum(abs(self.state), 0.1) / np.maximum(abs(direction), TINY))
        return self.change(lambda length: self.neighbour(length * direction, {}), lambda step: CENTRAL, step, SHORTEST_OF_STATES)

    def change_by(self, reference):
        """Return the derivative of the state after the event and of the delay by a parameter."""
        self.model.setFMUState(self.saved)
        unchanged, step = np.zeros_like(self.state), STEP * self.sizes_of([reference])[reference]
        return self.change(lambda length: self.neighbour(unchanged, {reference: length}), lambda step: self.rule_of(reference, step), step, SHORTEST_OF_PARAMETERS)

    def change(self, function, rule_of, step, shortest):
        """
        Return the derivative of function(length) at 0.

        The step shrinks from `step` to `shortest` times it, until differences of second and fourth order agree to ROUGH. Bounces of micrometres
        need such short steps. Raise Problem if they do not agree to UNKNOWN.
        """
        best, problem, shortest = None, None, shortest * step
        while step > 0.5 * shortest:
            try:
                change, error = difference(lambda steps: function(steps * step), rule_of(step))
            except Problem as found:
                problem = found
                self.point.messages.clear()
            else:
                change, error = change / step, error / step
                sizes = abs(change) + abs(change[-1]) * np.append(abs(self.rates), 1.0) + self.noise / step + TINY
                off = np.max(error / sizes)
                if best is None or off < best[0]:
                    best = off, change
                if off < ROUGH:
                    break
            step *= SHRINKING
        if best is None:
            raise problem
        if not best[0] < UNKNOWN:
            raise Problem(f"no derivative is found through the event at {self.time:g} s, since differences of neighbouring motions do not converge; expected other values, or a stop time before it")
        return best[1]

    def change_anything(self, acting):
        """Return True if changing all these parameters together changes the event."""
        self.model.setFMUState(self.saved)
        steps = {reference: STEP * size for reference, size in self.sizes_of(acting).items()}
        ends = {reference: self.rule_of(reference, step)[-1][0] * step for reference, step in steps.items()}
        unchanged = np.zeros_like(self.state)
        try:
            return (self.neighbour(unchanged, ends) != self.neighbour(unchanged, {})).any()
        except Problem:
            return True

    def handle_event(self, slopes, acting):
        """
        Handle the event in the FMU; return the state after it and its derivatives.

        `slopes` are the derivatives before the event, a row each; `acting` has for each row the references of the parameters that vary with it.
        """
        try:
            return self._handle_event(slopes, acting)
        finally:
            self.model.freeFMUState(self.saved)

    def _handle_event(self, slopes, acting):
        by_parameter = {reference: self.change_by(reference) for reference in relevant(self.change_anything, sorted({*itertools.chain(*acting)}))}
        unchanged = np.zeros(len(self.state) + 1)
        found = [(self.change_along(direction) if direction.any() else unchanged) + sum(by_parameter.get(reference, unchanged) for reference in references) for direction, references in zip(slopes, acting)]
        self.model.setFMUState(self.saved)
        self.motion.set_point(self.time, self.state, self.inputs)
        state = self.update()
        self.motion.set_point(self.time, state, self.inputs)
        rates = np.array(self.model.getReal(self.motion.rate_references))
        return state, np.array([change[:-1] - change[-1] * rates for change in found]).reshape(-1, len(state))
