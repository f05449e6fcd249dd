"""
Derivatives through events. Of a neighbouring motion, which meets the event a little earlier or later and elsewhere, what follows is compared at the
same time (M. A. Aizerman, F. R. Gantmacher: Determination of stability by linear approximation of a periodic solution of a system of differential
equations with discontinuous right-hand sides, 1958). What the event makes of neighbours is seen by differences of fourth order, in the FMU itself.
"""

import numpy as np
from scipy.optimize import brentq

from .problem import Problem

STEP = 1e-3  # of differences, as a share of the states and parameters
PAST = 1e-12  # s, by which an event is passed when it is handled, in units of the time where that is more than 1 s
AT_ONCE = 1e-9  # s, likewise, within which events are not told apart
ROUNDS = 100  # of an event
TRIALS, NEAR = 30, 1e-14  # for the time of a neighbour's event; s, likewise


def crossing_of(indicators, begin, end):
    """The first time at which one of these changes its sign, and which; None where none does. indicators(time): an array."""
    first, last = indicators(begin), indicators(end)
    crossing = np.flatnonzero(first * last < 0)
    if len(crossing) == 0:
        return None
    times = [brentq(lambda time: indicators(time)[k], begin, end, xtol=1e-15, rtol=4 * np.finfo(float).eps) for k in crossing]
    place = int(np.argmin(times))
    unit = max(1.0, abs(times[place]))
    if np.count_nonzero(np.array(times) < times[place] + AT_ONCE * unit) > 1:
        raise Problem(f"there are several events at once at {times[place]:g} s, through which there are no derivatives; expected a stop time before them")
    return times[place] + PAST * unit, crossing[place]


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

    def neighbour(self, direction, acting, share):
        """The state behind the event, and the delay of a neighbour: so many steps along the direction, with the acting parameters changed as much."""
        self.model.setFMUState(self.saved)
        if acting and share != 0.0:
            values = np.array(self.model.getReal(acting)) + share
            self.model.enterEventMode()
            self.model.setReal(acting, values)
            self.model.newDiscreteStates()
            self.model.enterContinuousTimeMode()
        state = self.state + share * direction
        delay = self.delay_of(state)
        self.motion.place(self.time + delay, state + delay * self.rates, self.inputs)
        return np.append(self.update(), delay)

    def step_along(self, direction, acting):
        """A small share of what the states and the acting parameters are."""
        sizes = [*(np.maximum(abs(self.state), 0.1) / np.maximum(abs(direction), 1e-300)), *(abs(value) or 1.0 for value in (self.model.getReal(acting) if acting else []))]
        return STEP * min(sizes)

    def pass_over(self, slopes):
        """Leaves the FMU behind the event. Returns its state there, and the slopes of that."""
        found = []
        for direction, acting in zip(slopes, self.motion.acting):
            if not direction.any() and not acting:
                found.append((np.zeros_like(direction), 0.0))
                continue
            step = self.step_along(direction, acting)
            one, two = (self.neighbour(direction, acting, k * step) - self.neighbour(direction, acting, -k * step) for k in (1, 2))
            change = (8 * one - two) / (12 * step)
            found.append((change[:-1], change[-1]))
        self.model.setFMUState(self.saved)
        self.motion.place(self.time, self.state, self.inputs)
        state = self.update()
        self.model.freeFMUState(self.saved)
        self.motion.place(self.time, state, self.inputs)
        rates = np.array(self.model.getReal(self.motion.rate_references))
        return state, np.array([change - delay * rates for change, delay in found])
