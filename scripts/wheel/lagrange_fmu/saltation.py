"""
Derivatives through events. Of a neighbouring motion, which meets the event a little earlier or later and elsewhere, what follows is compared at the
same time (M. A. Aizerman, F. R. Gantmacher: Determination of stability by linear approximation of a periodic solution of a system of differential
equations with discontinuous right-hand sides, 1958). What the event makes of neighbours is seen by differences of fourth order, in the FMU itself.
"""

import itertools

import numpy as np
from fmpy.fmi1 import FMICallException
from scipy.optimize import brentq

from .differences import CENTRAL, difference, relevant, rules_within
from .problem import Problem

STEP = 1e-3  # of differences at first, as a share of the states and parameters
SHRINKING = 0.1  # of that, where it turns out too long
SHORTEST_OF_STATES, SHORTEST_OF_PARAMETERS = 1e-11, 1e-2  # of that
ROUGH = 1e-5  # relative, what second order may be off in a step that is short enough
ROUNDING = 1e-16  # relative, of states and times
TINY = 1e-300  # more than 0
PAST = 1e-12  # s, by which an event is passed when it is handled, in units of the time where that is more than 1 s
AT_ONCE = 1e-9  # s, likewise, within which events are not told apart
ROUNDS = 100  # of an event
AWAY = 1e-6  # of the states, by which constraints are left
NEARBY, CLEAR = 1e-6, 1e-10  # of the flight before; by how much an indicator tells that its event has not come
CORRECTIONS = 3
UNKNOWN = 1e-2  # as ROUGH, of what is no derivative
TRIALS, NEAR = 30, 1e-16  # for the time of a neighbour's event; s, likewise
CONVERGED = 1e3


def crossing_of(indicators, begin, end):
    """The first time at which one of these changes its sign, and which; None where none does. indicators(time): an array."""
    first, last = indicators(begin), indicators(end)
    crossing = np.flatnonzero(np.sign(first) * np.sign(last) < 0)
    if len(crossing) == 0:
        return None
    times = [brentq(lambda time: indicators(time)[k], begin, end, xtol=1e-15, rtol=4 * np.finfo(float).eps) for k in crossing]
    place = int(np.argmin(times))
    unit = max(1.0, abs(times[place]))
    if np.count_nonzero(np.array(times) < times[place] + AT_ONCE * unit) > 1:
        raise Problem(f"there are several events at once at {times[place]:g} s, through which there are no derivatives; expected a stop time before them")
    return times[place] + PAST * unit, crossing[place]


class OtherModes(Problem):
    """What neighbours of a motion do behind an event."""


class Saltation:
    """An event of a motion, at a time just past it, in an FMU that is placed there and has not handled it yet."""

    def __init__(self, motion, time, state, before, indicator, inputs):
        """before: a time and state at which the event was not due yet."""
        self.motion, self.model, self.point, self.inputs = motion, motion.model, motion.point, inputs
        self.time, self.state, self.before, self.indicator = time, state, before, indicator
        motion.place(*before, inputs)
        self.saved = self.model.getFMUState()
        self.is_held = self.moves_onto_constraints()
        self.model.setFMUState(self.saved)
        motion.place(time, state, inputs)
        self.rates = np.array(self.model.getReal(motion.rate_references))
        self.level = self.point.indicators()[indicator]
        self.back = self.time_before()
        self.motion.place(time, state, inputs)
        after = self.update()
        self.noise = ROUNDING / ROUGH * np.append(np.maximum(abs(state), abs(after)), max(1.0, abs(time)))
        self.modes = self.point.modes()

    def moves_onto_constraints(self):
        """Whether states that are a little off are moved, before the event."""
        time, state = self.before
        off = state * (1 + AWAY) + AWAY
        self.motion.place(time, off, self.inputs)
        try:
            return (self.update() != off).any()
        except (Problem, FMICallException):
            self.point.messages.clear()
            return True

    def update(self):
        """What the event makes of the present state."""
        self.model.enterEventMode()
        for _ in range(ROUNDS):
            is_needed, ends, *_ = self.model.newDiscreteStates()
            if not is_needed or ends:
                break
        if is_needed or ends:
            raise Problem(f"{self.point.name} has no way on from the event at {self.time:g} s")
        self.model.enterContinuousTimeMode()
        return self.point.read(self.point.states)

    def value_at(self, state, delay):
        self.motion.place(self.time + delay, state + delay * self.rates, self.inputs)
        return self.point.indicators()[self.indicator]

    def time_before(self):
        """So much earlier it is clear that the event has not come."""
        flight = self.time - self.before[0]
        rate = abs(self.value_at(self.state, -NEARBY * flight) - self.level) / (NEARBY * flight)
        return min(CLEAR / rate, 0.1 * flight) if rate > 0 else 0.1 * flight

    def onto_constraints(self, state):
        """The neighbour that constraints make of it before its event, which they would undo else."""
        for _ in range(CORRECTIONS):
            delay = self.delay_of(state) - self.back
            early = state + delay * self.rates
            self.motion.place(self.time + delay, early, self.inputs)
            state = state + (self.update() - early)
        return state

    def delay_of(self, state):
        """By how much later the event comes from a neighbouring state."""
        unit = max(1.0, abs(self.time))
        known, value, delay = 0.0, self.value_at(state, 0.0), 1e-6 * unit
        for _ in range(TRIALS):
            now = self.value_at(state, delay)
            if now == value or abs(delay - known) < NEAR * max(unit, CONVERGED * abs(delay)):
                break
            known, value, delay = delay, now, delay - (now - self.level) * (delay - known) / (now - value)
        if not abs(delay) < 0.1 * unit:
            raise Problem(f"the event at {self.time:g} s is only touched, and comes for some neighbours not at all: there is no derivative through it")
        return delay

    def neighbour(self, shift, changes):
        """The state behind the event, and the delay, of a neighbour whose state is shifted, with parameters changed: by reference, by how much."""
        self.model.setFMUState(self.saved)
        if changes:
            values = np.array(self.model.getReal([*changes])) + [*changes.values()]
            self.model.enterEventMode()
            self.model.setReal([*changes], values)
            self.model.newDiscreteStates()
            self.model.enterContinuousTimeMode()
        by = f"by {', '.join(self.point.names[reference] for reference in changes)} " if changes else ""
        try:
            state = self.onto_constraints(self.state + shift) if self.is_held else self.state + shift
            delay = self.delay_of(state)
            self.motion.place(self.time + delay, state + delay * self.rates, self.inputs)
            after = self.update()
        except FMICallException:
            why = "; ".join(self.point.messages)
            raise Problem(f"the event at {self.time:g} s cannot be had {by}for some neighbours, so that there is no derivative: {why}; expected other values, or a min and a max that keep to what there is") from None
        if self.point.modes() != self.modes:
            raise OtherModes(f"the event at {self.time:g} s leads some neighbours into other modes than this motion, so that there is no derivative {by}through it; expected other values, or a stop time before it")
        return np.append(after, delay)

    def sizes_of(self, acting):
        return {reference: abs(value) or 1.0 for reference, value in zip(acting, self.model.getReal(acting) if acting else ())}

    def rule_of(self, reference, step):
        self.model.setFMUState(self.saved)
        (value,) = self.model.getReal([reference])
        return rules_within(value, step, self.point.limits[self.point.names[reference]])[0]

    def change_along(self, direction):
        """By how much the state behind the event, and the delay, change along the direction."""
        step = STEP * min(np.maximum(abs(self.state), 0.1) / np.maximum(abs(direction), 1e-300))
        return self.change(lambda length: self.neighbour(length * direction, {}), lambda step: CENTRAL, step, SHORTEST_OF_STATES)

    def change_by(self, reference):
        """Likewise by a parameter."""
        self.model.setFMUState(self.saved)
        still, step = np.zeros_like(self.state), STEP * self.sizes_of([reference])[reference]
        return self.change(lambda length: self.neighbour(still, {reference: length}), lambda step: self.rule_of(reference, step), step, SHORTEST_OF_PARAMETERS)

    def change(self, function, rule_of, step, shortest):
        """
        The derivative of function(length) in steps that are as short as the motion asks for: what bounces by micrometres has no other neighbours. Those
        are short enough in which second order says the same.
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
            raise Problem(f"no derivative is found through the event at {self.time:g} s, of which neighbours make something else however near they are; expected other values, or a stop time before it")
        return best[1]

    def change_anything(self, acting):
        """Whether the event is another one with these parameters changed."""
        self.model.setFMUState(self.saved)
        steps = {reference: STEP * size for reference, size in self.sizes_of(acting).items()}
        ends = {reference: self.rule_of(reference, step)[-1][0] * step for reference, step in steps.items()}
        still = np.zeros_like(self.state)
        try:
            return (self.neighbour(still, ends) != self.neighbour(still, {})).any()
        except Problem:
            return True

    def pass_over(self, slopes, acting):
        """Leaves the FMU behind the event. Returns its state there, and the slopes of that; acting: of each slope, the parameters that change with it."""
        try:
            return self._pass_over(slopes, acting)
        finally:
            self.model.freeFMUState(self.saved)

    def _pass_over(self, slopes, acting):
        by_parameter = {reference: self.change_by(reference) for reference in relevant(self.change_anything, sorted({*itertools.chain(*acting)}))}
        still = np.zeros(len(self.state) + 1)
        found = [(self.change_along(direction) if direction.any() else still) + sum(by_parameter.get(reference, still) for reference in references) for direction, references in zip(slopes, acting)]
        self.model.setFMUState(self.saved)
        self.motion.place(self.time, self.state, self.inputs)
        state = self.update()
        self.motion.place(self.time, state, self.inputs)
        rates = np.array(self.model.getReal(self.motion.rate_references))
        return state, np.array([change[:-1] - change[-1] * rates for change in found]).reshape(-1, len(state))
