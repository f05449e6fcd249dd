"""
Derivatives through events. Of a neighbouring motion, which meets the event a little earlier or later and elsewhere, what follows is compared at the
same time (M. A. Aizerman, F. R. Gantmacher: Determination of stability by linear approximation of a periodic solution of a system of differential
equations with discontinuous right-hand sides, 1958). What the event makes of neighbours is seen by differences of fourth order, in the FMU itself.
"""

import numpy as np
from fmpy.fmi1 import FMICallException
from scipy.optimize import brentq

from .differences import CENTRAL, difference, relevant, rules_within
from .problem import Problem

STEP = 1e-3  # of differences, as a share of the states and parameters
PAST = 1e-12  # s, by which an event is passed when it is handled, in units of the time where that is more than 1 s
AT_ONCE = 1e-9  # s, likewise, within which events are not told apart
ROUNDS = 100  # of an event
TRIALS, NEAR = 30, 1e-14  # for the time of a neighbour's event; s, likewise


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
        motion.place(time, state, inputs)
        self.rates = np.array(self.model.getReal(motion.rate_references))
        self.level = self.point.indicators()[indicator]
        self.update()
        self.modes = self.point.modes()

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

    def delay_of(self, state):
        """By how much later the event comes from a neighbouring state."""
        unit = max(1.0, abs(self.time))
        known, value, delay = 0.0, self.value_at(state, 0.0), 1e-6 * unit
        for _ in range(TRIALS):
            now = self.value_at(state, delay)
            if now == value or abs(delay - known) < NEAR * unit:
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
        state = self.state + shift
        delay = self.delay_of(state)
        self.motion.place(self.time + delay, state + delay * self.rates, self.inputs)
        by = f"by {', '.join(self.point.names[reference] for reference in changes)} " if changes else ""
        try:
            after = self.update()
        except FMICallException:
            why = "; ".join(self.point.messages)
            raise Problem(f"the event at {self.time:g} s cannot be had {by}for some neighbours, so that there is no derivative: {why}; expected other values, or a min and a max that keep to what there is") from None
        if self.point.modes() != self.modes:
            raise OtherModes(f"the event at {self.time:g} s leads some neighbours into other modes than this motion, so that there is no derivative {by}through it; expected other values, or a stop time before it")
        return np.append(after, delay)

    def sizes_of(self, acting):
        return {reference: abs(value) or 1.0 for reference, value in zip(acting, self.model.getReal(acting) if acting else ())}

    def rule_of(self, acting, step):
        if not acting:
            return CENTRAL
        (value,), (reference,) = self.model.getReal(acting), acting
        return rules_within(value, step, self.point.limits[self.point.names[reference]])[0]

    def change_along(self, direction, acting):
        """By how much the state behind the event, and the delay, change along the direction, with the acting parameters growing with it."""
        self.model.setFMUState(self.saved)
        step = STEP * min([*(np.maximum(abs(self.state), 0.1) / np.maximum(abs(direction), 1e-300)), *self.sizes_of(acting).values()])
        rule = self.rule_of(acting, step)
        return difference(lambda steps: self.neighbour(steps * step * direction, dict.fromkeys(acting, steps * step)), rule) / step

    def change_anything(self, acting):
        """Whether the event is another one with these parameters changed."""
        self.model.setFMUState(self.saved)
        steps = {reference: STEP * size for reference, size in self.sizes_of(acting).items()}
        ends = {reference: self.rule_of([reference], step)[-1][0] * step for reference, step in steps.items()}
        still = np.zeros_like(self.state)
        try:
            return (self.neighbour(still, ends) != self.neighbour(still, {})).any()
        except OtherModes:
            return True

    def pass_over(self, slopes, acting):
        """Leaves the FMU behind the event. Returns its state there, and the slopes of that; acting: of each slope, the parameters that change with it."""
        try:
            return self._pass_over(slopes, acting)
        finally:
            self.model.freeFMUState(self.saved)

    def _pass_over(self, slopes, acting):
        alone = [references[0] for direction, references in zip(slopes, acting) if references and not direction.any()]
        idle = {*alone} - {*relevant(self.change_anything, alone)}
        found = []
        for direction, references in zip(slopes, acting):
            is_idle = not direction.any() and idle.issuperset(references)
            found.append(np.zeros(len(direction) + 1) if is_idle else self.change_along(direction, references))
        self.model.setFMUState(self.saved)
        self.motion.place(self.time, self.state, self.inputs)
        state = self.update()
        self.motion.place(self.time, state, self.inputs)
        rates = np.array(self.model.getReal(self.motion.rate_references))
        return state, np.array([change[:-1] - change[-1] * rates for change in found]).reshape(-1, len(state))
