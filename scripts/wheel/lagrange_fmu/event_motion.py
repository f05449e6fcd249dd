"""
Compute motions with events and their derivatives.

Between events an FMU in co-simulation integrates the motion with its variational equations, and locates the events. At an event the same
system in model exchange gives the saltation matrix by finite differences, see saltation.py.
"""

import numpy as np
from fmpy.fmi1 import FMICallException

from .model_exchange import along
from .problem import Problem
from .saltation import CROSSING_DELAY, Saltation
from .sensitivity import DifferentiableMotion, as_arrays

CHECKED = 1e-6  # relative tolerance to which both FMUs agree after an event
NEGLIGIBLE = 1e-9  # delay, relative to the flight before the event, that needs no extrapolation
FURTHEST = 1e-4  # largest delay at which model exchange detects the event, in s; relative to the time after 1 s


class CannotFollow(Exception):
    """The co-simulation cannot follow the motion: SciPy takes over."""


class Series:
    """An FMU in co-simulation that stops at events, with the sensitivities of its states among its states."""

    def __init__(self, point, of, by, tolerance):
        self.point, self.model, self.by = point, point.model, by
        self.model.tolerance = tolerance
        self.read_references = self.references(of, by)
        self.state_references, self.rate_references = (self.references(names, by) for names in (point.states, point.derivatives))

    def references(self, names, by):
        """Return the references of these variables, then those of their derivatives by the first name of `by`, the second, and so on."""
        return [self.point.references[name] for name in [*names, *(along(name, value) for value in by for name in names)]]

    def rows(self, references):
        """Return the values in the first row, and below it their derivatives, a row for each name of `by`."""
        return np.array(self.model.getReal(references)).reshape(len(self.by) + 1, -1)

    def start(self, time, values, slopes):
        """Initialize at `values` by name, with these sensitivities of the states."""
        self.model.start_time = time
        starts = dict(zip((along(name, value) for value in self.by for name in self.point.states), slopes))
        self.point.start(values=values | starts)

    def step(self, begin, end):
        """
        Step to `end`, or to the next event.

        Return the time; and at an event (time, states) in the middle before it, else None.
        """
        saved = self.model.getFMUState()
        time, is_at_event = self._step_to(begin, end)
        early = None
        if is_at_event:
            self.model.setFMUState(saved)
            middle, _ = self._step_to(begin, (begin + time) / 2)
            early = middle, self.rows(self.state_references)[0]
            time, is_at_event = self._step_to(middle, end)
        self.model.freeFMUState(saved)
        if (early is not None) != is_at_event:
            raise CannotFollow
        return time, early

    def _step_to(self, begin, end):
        is_at_event, *_, reached = self.model.doStep(begin, end - begin)
        return (reached if is_at_event else end), is_at_event

    def rows_after(self, time, delay):
        """Return the rows of states and of rates after a further `delay`. The motion stays at `time`."""
        saved = self.model.getFMUState()
        if delay > 0:
            self.model.doStep(time, delay)
        rows = self.rows(self.state_references), self.rows(self.rate_references)
        self.model.setFMUState(saved)
        self.model.freeFMUState(saved)
        return rows

    def row(self):
        """Return the values of the variables `of`, and their derivatives, (len(of), len(by))."""
        values, *derivatives = self.rows(self.read_references)
        return values, np.array(derivatives).T

    def handle_event(self, slopes):
        """Handle the event; set the sensitivities after it to `slopes`."""
        self.model.enterEventMode()
        self.model.newDiscreteStates()
        self.model.setReal(self.state_references[len(self.point.states) :], slopes.ravel())
        self.model.enterContinuousTimeMode()


class EventMotion(DifferentiableMotion):
    """A DifferentiableMotion in co-simulation as far as possible; its base class takes over from the time at which co-simulation fails."""

    def __init__(self, point, of, by, tolerance):
        super().__init__(point, of, by, tolerance)
        self.series = Series(point.in_series, self.of, self.by, tolerance)

    def over(self, times, values=None, inputs=None, kinks=()):
        if inputs is None:
            try:
                return self.in_series(times, values or {})
            except Problem:  # for example a small bounce that neighbours do not have; the base class may succeed
                self.point.messages.clear()
        return super().over(times, values, inputs, kinks)

    def in_series(self, times, values):
        """Return the arrays of over() by co-simulation; `known` is the last time, vector `both` and FMU state from which SciPy can continue."""
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
        except (CannotFollow, Problem, FMICallException):
            self.point.messages.clear()
            time, both, saved = known
            self.model.setFMUState(saved)
            rows += self.continue_to(time, both, times[len(rows) :])
        self.model.freeFMUState(known[2])
        return as_arrays(rows)

    def check(self, time, both, delay=0.0):
        """
        Raise CannotFollow if co-simulation and model exchange disagree at this time and vector `both`.

        Co-simulation is `delay` earlier and is taken ahead, since model exchange does not go back over an event. The variational equations of
        co-simulation are wrong for redundant constraints. In model exchange bounces come to rest slightly earlier.
        """
        count = len(self.state_references)
        slopes = both[count:].reshape(-1, count)
        self.set_point(time, both[:count], None)
        values, rates = self.series.rows_after(time - delay, delay)
        expected = self.along(self.rate_references, slopes)
        pairs = ((values, both.reshape(-1, count)), (rates[1:], expected))
        are_close = all(np.allclose(part, other, rtol=CHECKED, atol=CHECKED * np.max(np.abs(other), initial=0.0)) for part, other in pairs)
        if not are_close or self.series.point.modes() != self.point.modes():
            raise CannotFollow

    def jump(self, time, early, known):
        """
        Handle the event at which co-simulation stopped; `early` is a time and the states before it.

        Return the tuple (time, vector `both`, FMU state) after it, which replaces `known`.
        """
        values, rates = self.series.rows(self.series.state_references), self.series.rows(self.series.rate_references)
        delay, indicator = self.event_at(time, values[0], rates[0])
        at_event = self.at_event(time, (values, rates), delay, early, indicator, is_extrapolated=delay > NEGLIGIBLE * (time - known[0]))
        self.series.handle_event(at_event[1:])
        after = self.moved(at_event, delay).ravel()
        self.check(time + delay, after, delay)
        self.model.freeFMUState(known[2])
        return time + delay, after, self.model.getFMUState()

    def at_event(self, time, both, delay, early, indicator, is_extrapolated):
        """
        Return the states and their derivatives after the event, at its time.

        The event is handled late by `delay`, with an error of first order. After a short flight the derivatives are extrapolated linearly
        from delays of one and two times `delay`.
        """
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
        """Return the states and their derivatives after the event, moved back to its time, where it is handled `delay` later."""
        values, rates = both
        later = values + delay * self.rates_between(time, values, rates, delay)
        states, slopes = Saltation(self, time + delay, later[0], early, indicator, None).handle_event(later[1:], self.acting)
        return self.moved(np.vstack([states, slopes]), -delay)

    def moved(self, both, delay):
        """Return states and derivatives after a further time `delay`, by the present rates of the FMU."""
        return both + delay * np.vstack([self.model.getReal(self.rate_references), self.along(self.rate_references, both[1:])])

    def rates_between(self, time, values, rates, delay):
        """Return the rates of states and derivatives in the middle of the delay, as the midpoint rule needs them."""
        middle = values + delay / 2 * rates
        self.set_point(time + delay / 2, middle[0], None)
        return np.vstack([self.model.getReal(self.rate_references), self.along(self.rate_references, middle[1:])])

    def event_at(self, time, state, rates):
        """Return the smallest delay at which model exchange detects the event, and the index of its indicator; raise CannotFollow if there is none."""
        unit = max(1.0, abs(time))
        delay = CROSSING_DELAY * unit
        while delay < FURTHEST * unit:
            found = []
            for moved in (-delay, delay):
                self.set_point(time + moved, state + moved * rates, None)
                found.append(self.point.indicators())
            crossing = np.flatnonzero(np.sign(found[0]) * np.sign(found[1]) < 0)
            if len(crossing) == 1:
                return delay, crossing[0]
            if len(crossing) > 1:
                break
            delay *= 10
        raise CannotFollow
