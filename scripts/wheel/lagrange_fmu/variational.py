"""
Motions with their derivatives by the FMU's own solver: of systems that lagc derives so that the variational equations are a part of the motion.
"""

import tempfile
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fmpy.fmi1 import FMICallException

from .building import derive
from .event_motion import EventMotion
from .model_exchange import along, opened, words_for
from .models import Slave2
from .problem import Problem
from .running import is_fmu
from .sensitivity import Motion, acting_of, check_names, check_tolerance, start_slopes

CHECKED = 1e-6  # relative, to which rates are right at the start
LARGEST = 500_000  # bytes of a system in C that is compiled in seconds


def _indicators_of(system, by):
    """How many events may come from, where lagc derives it so; None where not: what is wrong is told where it is built without derivatives."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            description = derive(system, Path(folder), None, words_for(by))
        except Problem:
            return None
        return int(description.get("numberOfEventIndicators", 0)) if (Path(folder) / "system.c").stat().st_size < LARGEST else None


@dataclass(frozen=True)
class Sensitivities:
    """At n times: `values[of]`, and `derivatives[of, by]` of them, all in SI units."""

    time: np.ndarray
    values: dict
    derivatives: dict


@contextmanager
def followed(system, values, by):
    """The Point of a system or an FMU, of which motion() makes motions with derivatives by these names."""
    indicators = None if is_fmu(system) or not by else _indicators_of(system, by)
    if indicators == 0:
        with opened(system, values, what="be followed", by=by) as point:
            if SeriesMotion(point, [], by, CHECKED).begins_right():
                yield point
                return
    with opened(system, values, what="be followed") as point:
        if not indicators:
            yield point
            return
        with opened(system, values, what="be followed", by=by, stops_at_events=True, messages=point.messages) as point.in_series:
            yield point


def motion(point, of, by, tolerance):
    kind = SeriesMotion if isinstance(point.model, Slave2) else EventMotion if point.in_series is not None else Motion
    return kind(point, of, by, tolerance)


class SeriesMotion:
    """As Motion, in communication steps from one time to the next."""

    def __init__(self, point, of, by, tolerance):
        self.point, self.model, self.of, self.by = point, point.model, list(of), list(by)
        self.model.tolerance = tolerance
        self.references = [point.references[name] for name in self.of] + [point.references[along(name, value)] for name in self.of for value in self.by]

    def start(self, values):
        """The derivatives of the states, a row for each value."""
        _, slopes = start_slopes(self.point, self.by, values)
        starts = {along(name, by): slope for by, row in zip(self.by, slopes) for name, slope in zip(self.point.states, row)}
        self.point.start(values=values | starts)
        return slopes

    def begins_right(self):
        """Whether the rates are what the FMU's directional derivatives give, which go without constraints that follow from others; those in the series do not."""
        reference, rates = self.point.references, self.point.derivatives
        try:
            slopes = self.start({})
            found = [self.model.getReal([reference[along(name, by)] for name in rates]) for by in self.by]
            expected = [
                self.model.getDirectionalDerivative([reference[name] for name in rates], [*(reference[name] for name in self.point.states), *acting], [*slope, *[1.0] * len(acting)])
                for acting, slope in zip(acting_of(self.point, self.by), slopes)
            ]
        except FMICallException:
            self.point.messages.clear()
            return False
        return bool(np.allclose(found, expected, rtol=CHECKED, atol=CHECKED * np.max(np.abs(expected), initial=0.0)))

    def over(self, times, values=None, inputs=None, kinks=()):
        """At these times, the first of which is where it starts: n x of, and n x of x by. inputs(time): names and values, linear between times and kinks."""
        self.model.start_time = times[0]
        self.start(values or {})
        rows, stops = [], np.union1d(times, kinks)
        for begin, end in zip(stops, [*stops[1:], None]):
            self.set_inputs(begin, end, inputs)
            if begin in times:
                rows.append(self.model.getReal(self.references))
            if end is not None:
                self.step(begin, end)
        found = np.array(rows)
        return found[:, : len(self.of)], found[:, len(self.of) :].reshape(len(rows), len(self.of), len(self.by))

    def step(self, begin, end):
        try:
            self.model.doStep(begin, end - begin)
        except FMICallException:
            why = "; ".join(self.point.messages)
            self.point.messages.clear()
            raise Problem(f"the motion cannot be followed with its derivatives: {why}; expected an earlier end") from None

    def set_inputs(self, begin, end, inputs):
        if inputs is None:
            return
        names, values = inputs(begin)
        references = [self.point.references[name] for name in names]
        self.model.setReal(references, values)
        if end is not None:
            rates = (np.array(inputs(end)[1]) - values) / (end - begin)
            self.model.setRealInputDerivatives(references, [1] * len(names), rates)


def sensitivities(system, of, by, times, start_values, tolerance):
    try:
        times = np.atleast_1d(np.asarray(times, dtype=float))
    except (TypeError, ValueError):
        raise Problem(f"the times are {times}; expected numbers, in s") from None
    if not (times.size and np.isfinite(times).all() and times[0] >= 0 and (np.diff(times) > 0).all()):
        raise Problem(f"the times are {', '.join(f'{time:g}' for time in times)} s; expected one at least, from 0 s on, each later than the one before")
    check_tolerance(tolerance)
    with followed(system, dict(start_values), by) as point:
        check_names(point, of, by)
        found = motion(point, of, by, tolerance).over(np.union1d([0.0], times))
    values, derivatives = (part[-len(times) :] for part in found)
    named = {(name, other): derivatives[:, i, k] for i, name in enumerate(of) for k, other in enumerate(by)}
    return Sensitivities(times, dict(zip(of, values.T)), named)
