"""
Compute a motion and its derivatives by the FMU's own solver.

`lagc --along NAME` appends the variational equations (see sensitivity.py) to the system. Where lagc cannot do this, or its equations are wrong
at the start (redundant constraints), the motion is integrated by SciPy instead.
"""

import tempfile
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fmpy.fmi1 import FMICallException

from . import with_scipy  # noqa: F401, first, since it raises Problem if SciPy is missing
from .building import derive
from .event_motion import EventMotion
from .model_exchange import along, opened, lagc_options
from .models import Slave2
from .problem import Problem
from .running import is_fmu
from .sensitivity import DifferentiableMotion, acting_of, check_names, start_slopes

CHECKED = 1e-6  # relative tolerance of the comparison with directional derivatives at the start
DIFFERENCE = 1e-4  # first step of differences, relative to the value
LEAST_CHANGE, LARGEST_CHANGE = 1e-5, 1e-2  # change of a motion, relative to its size, that differences aim at: above rounding, below curvature
FURTHEST, TRIALS = 10.0, 8  # largest step of differences, relative to the value; number of steps that are tried
LARGEST = 500_000  # bytes of a system.c that compiles in seconds; larger systems use SciPy


def _indicators_of(system, by):
    """
    Return the number of event indicators of the system with its variational equations.

    Return None if lagc cannot derive them or system.c is too large. Errors of the system itself are reported when it is built without them.
    """
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            description = derive(system, Path(folder), None, lagc_options(by))
        except Problem:
            return None
        return int(description.get("numberOfEventIndicators", 0)) if (Path(folder) / "system.c").stat().st_size < LARGEST else None


@dataclass(frozen=True)
class Sensitivities:
    """
    Values of variables at n times and their derivatives, in SI units.

    Examples
    --------
    >>> found.values["theta"], found.derivatives["theta", "l"]
    """

    time: np.ndarray  # n times, in s
    values: dict  # arrays of n values by name
    derivatives: dict  # arrays of n derivatives by (of, by)


@contextmanager
def followed(system, values, by):
    """
    Yield the Point of a system or an FMU, from which motion() makes motions with derivatives by these names.

    It is in co-simulation for a system without events whose variational equations are right. A system with events gets a Point in model
    exchange, whose `in_series` is one in co-simulation.
    """
    indicators = None if is_fmu(system) or not by else _indicators_of(system, by)
    if indicators == 0:
        with opened(system, values, what="be followed", by=by) as point:
            if SeriesMotion(point, [], by, CHECKED).starts_consistently():
                yield point
                return
    with opened(system, values, what="be followed") as point:
        if not indicators:
            yield point
            return
        with opened(system, values, what="be followed", by=by, stops_at_events=True, messages=point.messages) as point.in_series:
            yield point


def motion(point, of, by, tolerance):
    """Return the motion with derivatives that suits the Point: a SeriesMotion, an EventMotion or a DifferentiableMotion."""
    kind = SeriesMotion if isinstance(point.model, Slave2) else EventMotion if point.in_series is not None else DifferentiableMotion
    return kind(point, of, by, tolerance)


class SeriesMotion:
    """A motion with derivatives, as DifferentiableMotion, in communication steps of co-simulation from one time to the next."""

    def __init__(self, point, of, by, tolerance):
        self.point, self.model, self.of, self.by = point, point.model, list(of), list(by)
        self.model.tolerance = tolerance
        self.references = [point.references[name] for name in self.of] + [point.references[along(name, value)] for name in self.of for value in self.by]

    def start(self, values):
        """Start at these values; return the derivatives of the states, a row for each name of `by`."""
        _, slopes = start_slopes(self.point, self.by, values)
        starts = {along(name, by): slope for by, row in zip(self.by, slopes) for name, slope in zip(self.point.states, row)}
        self.point.start(values=values | starts)
        return slopes

    def starts_consistently(self):
        """
        Return True if the rates of the sensitivities at the start are equal to the FMU's directional derivatives.

        They differ for redundant constraints, which the directional derivatives leave out and the variational equations of lagc do not.
        """
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
        """
        Return the values at n times, n x of, and the derivatives, n x of x by. The motion starts at the first time.

        inputs(time) returns names and values, which are linear between the times and `kinks`.
        """
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
        """Take a communication step; raise Problem if it fails."""
        try:
            self.model.doStep(begin, end - begin)
        except FMICallException:
            why = "; ".join(self.point.messages)
            self.point.messages.clear()
            raise Problem(f"the motion cannot be followed with its derivatives: {why}; expected an earlier end") from None

    def set_inputs(self, begin, end, inputs):
        """Set the inputs and their slopes until the time `end`; no slopes if it is None."""
        if inputs is None:
            return
        names, values = inputs(begin)
        references = [self.point.references[name] for name in names]
        self.model.setReal(references, values)
        if end is not None:
            rates = (np.array(inputs(end)[1]) - values) / (end - begin)
            self.model.setRealInputDerivatives(references, [1] * len(names), rates)


def sensitivities(system, of, by, times, start_values, tolerance):
    """See lagrange_fmu.sensitivities."""
    try:
        times = np.atleast_1d(np.asarray(times, dtype=float))
    except (TypeError, ValueError):
        raise Problem(f"the times are {times}; expected numbers, in s") from None
    if times.ndim > 1:
        raise Problem(f"the times have the shape {times.shape}; expected a list of numbers, in s")
    if not times.size:
        raise Problem("times is empty; expected one time at least, in s")
    if not (np.isfinite(times).all() and times[0] >= 0 and (np.diff(times) > 0).all()):
        raise Problem(f"the times are {', '.join(f'{time:g}' for time in times)} s; expected one at least, from 0 s on, each later than the one before")
    with followed(system, dict(start_values), by) as point:
        check_names(point, of, by)
        found = motion(point, of, by, tolerance).over(np.union1d([0.0], times))
    values, derivatives = (part[-len(times) :] for part in found)
    named = {(name, other): derivatives[:, i, k] for i, name in enumerate(of) for k, other in enumerate(by)}
    return Sensitivities(times, dict(zip(of, values.T)), named)


@contextmanager
def stepped(system, values):
    """Yield the Point of a system or an FMU in co-simulation, without derivatives."""
    with opened(system, values, what="be followed", in_steps=True) as point:
        yield point


class SteppedMotion(SeriesMotion):
    """A SeriesMotion without derivatives."""

    def __init__(self, point, of, tolerance):
        super().__init__(point, of, [], tolerance)

    def start(self, values):
        self.point.start(values=values)


class DifferencedMotion:
    """
    A motion in the FMU's own solver, through all events, with derivatives by finite differences.

    The differences are central, of second order, or one-sided, of first order, at a limit. `steps` remembers the step for each name.
    """

    def __init__(self, point, of, by, tolerance):
        self.point, self.by = point, by
        self.series = SteppedMotion(point, of, tolerance)
        self.steps = {}

    def values(self, times, values, inputs=None, kinks=()):
        """Return the values at n times, n x of; raise Problem if the motion fails."""
        try:
            return self.series.over(times, values, inputs, kinks)[0]
        except FMICallException as problem:
            why = "; ".join(self.point.messages) or str(problem)
            self.point.messages.clear()
            raise Problem(f"the motion cannot be computed: {why}") from None

    def slopes(self, times, values, inputs, kinks, found):
        """Return the derivatives at n times, n x of x by; `found` is the motion at `values`."""
        size = np.max(np.abs(found - found[0]), axis=0)
        size = np.where(size > 0, size, np.maximum(np.max(np.abs(found), axis=0), 1e-300))

        def motion_at(name, step):
            value = values[name] + step
            low, high = self.point.limits[name]
            try:
                return self.values(times, values | {name: value}, inputs, kinks) if low <= value <= high else None
            except Problem:
                return None

        return np.stack([self._slope(lambda step: motion_at(name, step), name, values[name], found, size) for name in self.by], axis=-1)

    def _slope(self, motion_at, name, value, found, size):
        """
        Return the derivative by one value; motion_at(step) returns the motion at value + step, or None.

        The step is adapted until it changes the motion by LEAST_CHANGE to LARGEST_CHANGE of its size.
        """
        step = self.steps.get(name, DIFFERENCE * (abs(value) or 1.0))
        for _ in range(TRIALS):
            ends = {end: motion for end in (step, -step) if (motion := motion_at(end)) is not None}
            if not ends:
                step *= 0.1
                continue
            self.steps[name] = step
            above, below = ends.get(step, found), ends.get(-step, found)
            change = np.max(np.abs(above - below) / size)
            slope = (above - below) / (step * len(ends))
            if change > LARGEST_CHANGE:
                step *= 0.1
            elif change < LEAST_CHANGE and step < FURTHEST * (abs(value) or 1.0):
                step *= 10.0
            else:
                return slope
        if not ends:
            raise Problem(f"the motion cannot be computed for any value of '{name}' near {value:g}; expected another value")
        return slope
