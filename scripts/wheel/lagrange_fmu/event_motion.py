"""Motions through events with their derivatives: in the series of the FMU between events, which it locates; over these by differences."""

import numpy as np
from fmpy.fmi1 import FMICallException

from .model_exchange import along
from .problem import Problem
from .saltation import PAST, Saltation
from .sensitivity import Motion, as_arrays

CHECKED = 1e-6  # relative, to which the two FMUs agree behind an event
NEGLIGIBLE = 1e-9  # of the flight before an event
FURTHEST = 1e-4  # s, by which an event is passed when it is seen at the latest, in units of the time where that is more than 1 s


class Lost(Exception):
    """What the series does not follow."""


class Series:
    """An FMU in co-simulation that stops at events, with the derivatives of its states by values among its states."""

    def __init__(self, point, of, by, tolerance):
        self.point, self.model, self.by = point, point.model, by
        self.model.tolerance = tolerance
        self.read_references = self.references(of, by)
        self.state_references, self.rate_references = (self.references(names, by) for names in (point.states, point.derivatives))

    def references(self, names, by):
        """Of these, and then of their derivatives by the first value, the second and so on."""
        return [self.point.references[name] for name in [*names, *(along(name, value) for value in by for name in names)]]

    def rows(self, references):
        """Values in the first row, below it their derivatives by each value."""
        return np.array(self.model.getReal(references)).reshape(len(self.by) + 1, -1)

    def start(self, time, values, slopes):
        self.model.start_time = time
        starts = dict(zip((along(name, value) for value in self.by for name in self.point.states), slopes))
        self.point.start(values=values | starts)

    def step(self, begin, end):
        """To the end, or the next event. Returns the time; and where it is an event, a time well before it and the states there, else None."""
        saved = self.model.getFMUState()
        time, is_at_event = self._go(begin, end)
        early = None
        if is_at_event:
            self.model.setFMUState(saved)
            middle, _ = self._go(begin, (begin + time) / 2)
            early = middle, self.rows(self.state_references)[0]
            time, is_at_event = self._go(middle, end)
        self.model.freeFMUState(saved)
        if (early is not None) != is_at_event:
            raise Lost
        return time, early

    def _go(self, begin, end):
        is_at_event, *_, reached = self.model.doStep(begin, end - begin)
        return (reached if is_at_event else end), is_at_event

    def row(self):
        values, *derivatives = self.rows(self.read_references)
        return values, np.array(derivatives).T

    def pass_over(self, slopes):
        """Goes through the event, behind which the derivatives are these."""
        self.model.enterEventMode()
        self.model.newDiscreteStates()
        self.model.setReal(self.state_references[len(self.point.states) :], slopes.ravel())
        self.model.enterContinuousTimeMode()


class EventMotion(Motion):
    """Follows the motion as its base class does from where the series cannot."""

    def __init__(self, point, of, by, tolerance):
        super().__init__(point, of, by, tolerance)
        self.series = Series(point.in_series, self.of, self.by, tolerance)

    def over(self, times, values=None, inputs=None, kinks=()):
        if inputs is None:
            try:
                return self.in_series(times, values or {})
            except Problem:  # where bounces come to rest, one is easily met at which neighbours rest already
                self.point.messages.clear()
        return super().over(times, values, inputs, kinks)

    def in_series(self, times, values):
        both = self.start(values)
        rows, known = [self.read(times[0], both, None)], (times[0], both, self.model.getFMUState())
        try:
            self.series.start(times[0], values, both[len(self.state_references) :])
            self.check(times[0], both)
            time, early = times[0], None
            for due in times[1:]:
                while time < due:
                    if early is not None:
                        known = self.jump(time, early, known)
                    time, early = self.series.step(time, due)
                rows.append(self.series.row())
        except (Lost, Problem, FMICallException):
            self.point.messages.clear()
            time, both, saved = known
            self.model.setFMUState(saved)
            rows += self.go_on(time, both, times[len(rows) :])
        self.model.freeFMUState(known[2])
        return as_arrays(rows)

    def check(self, time, both):
        """
        Whether the series goes on so from there. Its forces are wrong where constraints follow from others; and in model exchange what bounces
        comes to rest a little sooner.
        """
        count = len(self.state_references)
        slopes = both[count:].reshape(-1, count)
        self.place(time, both[:count], None)
        values, rates = self.series.rows(self.series.state_references), self.series.rows(self.series.rate_references)
        expected = self.along(self.rate_references, slopes)
        pairs = ((values, both.reshape(-1, count)), (rates[1:], expected))
        are_close = all(np.allclose(part, other, rtol=CHECKED, atol=CHECKED * np.max(np.abs(other), initial=0.0)) for part, other in pairs)
        if not are_close or self.series.point.modes() != self.point.modes():
            raise Lost

    def jump(self, time, early, known):
        """Over the event that the series came to; early: a time well before it, and the states there. Returns what is known behind it in place of what was."""
        values, rates = self.series.rows(self.series.state_references), self.series.rows(self.series.rate_references)
        delay, indicator = self.event_at(time, values[0], rates[0])
        at_event = self.at_event(time, (values, rates), delay, early, indicator, is_extrapolated=delay > NEGLIGIBLE * (time - known[0]))
        self.series.pass_over(at_event[1:])
        self.check(time, at_event.ravel())
        self.model.freeFMUState(known[2])
        return time + delay, self.moved(at_event, delay).ravel(), self.model.getFMUState()

    def at_event(self, time, both, delay, early, indicator, is_extrapolated):
        """The states and their derivatives behind it; of a short flight extrapolated from twice the delay, of which much happens within it."""
        saved, later = self.model.getFMUState(), None
        try:
            if is_extrapolated:
                later, modes = self.handled(time, both, 2 * delay, early, indicator), self.point.modes()
                self.model.setFMUState(saved)
            found = self.handled(time, both, delay, early, indicator)
        finally:
            self.model.freeFMUState(saved)
        if later is not None and self.point.modes() == modes:
            found[1:] += found[1:] - later[1:]
        return found

    def handled(self, time, both, delay, early, indicator):
        """Likewise, where the event is handled so much later."""
        values, rates = both
        later = values + delay * self.rates_between(time, values, rates, delay)
        states, slopes = Saltation(self, time + delay, later[0], early, indicator, None).pass_over(later[1:], self.acting)
        return self.moved(np.vstack([states, slopes]), -delay)

    def moved(self, both, delay):
        """By the rates that it has where the FMU is."""
        return both + delay * np.vstack([self.model.getReal(self.rate_references), self.along(self.rate_references, both[1:])])

    def rates_between(self, time, values, rates, delay):
        """Of states and their derivatives, in the middle of the delay."""
        middle = values + delay / 2 * rates
        self.place(time + delay / 2, middle[0], None)
        return np.vstack([self.model.getReal(self.rate_references), self.along(self.rate_references, middle[1:])])

    def event_at(self, time, state, rates):
        """By how much later model exchange sees it, and its indicator."""
        unit = max(1.0, abs(time))
        delay = PAST * unit
        while delay < FURTHEST * unit:
            found = []
            for moved in (-delay, delay):
                self.place(time + moved, state + moved * rates, None)
                found.append(self.point.indicators())
            crossing = np.flatnonzero(np.sign(found[0]) * np.sign(found[1]) < 0)
            if len(crossing) == 1:
                return delay, crossing[0]
            if len(crossing) > 1:
                break
            delay *= 10
        raise Lost
