"""Read and check the measurements of an experiment."""

import os
from collections.abc import Mapping

import numpy as np

from .input_file import read_table
from .problem import Problem
from .signals import columns_of


def _rows_of(columns):
    """Return columns by name as a structured array that begins with the time; raise Problem for others than numbers of one length."""
    names = sorted(columns, key=lambda name: name != "time")
    for name in names:
        if len(columns[name]) != len(columns[names[0]]):
            raise Problem(f"'{name}' of the data has {len(columns[name])} values and '{names[0]}' {len(columns[names[0]])}; expected one for each time")
        try:
            columns[name] = np.asarray(columns[name], dtype=float)
        except (TypeError, ValueError):
            raise Problem(f"'{name}' of the data has values that are not numbers; expected numbers, and NaN where one is missing") from None
    return np.rec.fromarrays([columns[name] for name in names], names=names).view(np.ndarray)


def _table_of(data, point):
    if isinstance(data, (str, os.PathLike)):
        return read_table(data, point.units)
    if isinstance(data, Mapping) or hasattr(data, "reset_index"):
        data = _rows_of(columns_of(data))
    names = getattr(getattr(data, "dtype", None), "names", None) or ()
    if names[:1] != ("time",) or len(names) < 2:
        raise Problem("the data have no time with measurements; expected a CSV, a dict of arrays, a DataFrame or a structured array, with time first")
    return data


def _check_times(times):
    if len(times) < 2:
        raise Problem("the data have fewer than two rows; expected a motion over some time")
    if not np.isfinite(times).all():
        raise Problem("the data have a row without a finite time; expected a time in each")
    back = np.flatnonzero(np.diff(times) <= 0)
    if len(back):
        raise Problem(f"the time {times[back[0] + 1]:.15g} s of the data follows {times[back[0]]:.15g} s; expected sorted rows, each time once (of a simulation: record_events=False), and further experiments in files of their own")


class Experiment:
    """
    Measurements of one motion.

    `measured` and `inputs` are the names of the columns, `values` (n x measured) the measurements, with angles unwrapped, and `is_measured`
    is False where a measurement is missing.
    """

    def __init__(self, data, point, noise):
        """
        Check the data against the Point of an FMU; raise Problem if they do not fit it.

        `data` is a CSV or a structured array, in which NaN is a missing measurement. `noise` has standard deviations by measured name; the
        default is 1.
        """
        self.data = _table_of(data, point)
        names = self.data.dtype.names[1:]
        self.inputs = [name for name in names if name in point.inputs]
        self.measured = [name for name in names if name not in point.inputs]
        _check_times(self.data["time"])
        self._check_columns(point)
        self.noise = np.array([noise.get(name, 1.0) for name in self.measured])
        if not (np.isfinite(self.noise) & (self.noise > 0)).all():
            raise Problem(f"the noise is {', '.join(f'{name}={noise[name]:g}' for name in self.measured if name in noise)}; expected positive numbers")
        self.values = np.stack([self.data[name] for name in self.measured], axis=1)
        self.is_measured = np.isfinite(self.values)
        self.wraps = {}  # time of the first jump, in s, by name of a measured angle that is wrapped to one turn
        for i, name in enumerate(self.measured):
            if point.units.get(name) == "rad":
                self._unwrap(i, name)

    def _unwrap(self, i, name):
        """
        Unwrap an angle that jumps and lies within one turn.

        If half of the steps or more are jumps, the rows are too sparse to distinguish jumps from motion. The angle then stays as it is.
        """
        rows = self.is_measured[:, i]
        values, times = self.values[rows, i], self.data["time"][rows]
        jumps = np.flatnonzero(abs(np.diff(values)) > np.pi)
        if len(jumps) and np.ptp(values) < 2 * np.pi + 0.1 and 2 * len(jumps) < len(values) - 1:
            self.values[rows, i], self.wraps[name] = np.unwrap(values), float(times[jumps[0] + 1])

    def unwrapped(self):
        """Return a copy of the data with unwrapped angles."""
        data = np.array(self.data)
        for name in self.wraps:
            data[name] = self.values[:, self.measured.index(name)]
        return data

    def _check_columns(self, point):
        read = [*dict.fromkeys([*point.outputs, *point.states, *point.derivatives])]
        for name in self.measured:
            if name not in read:
                raise Problem(f"'{name}' of the data is not an output, a state or its derivative, nor an input; expected no such column, or one of these names: {', '.join([*read, *point.inputs])}")
        if not self.measured:
            raise Problem(f"no column of the data is an output or state of the system; expected some of {', '.join(read)}")
        for name in [*self.inputs, *self.measured]:
            values = self.data[name]
            if np.isinf(values).any() or not np.isfinite(values).any():
                raise Problem(f"'{name}' of the data has an infinite value, or none at all; expected finite numbers, and nothing where it was not measured")
            if name in self.inputs and not np.isfinite(values).all():
                raise Problem(f"the input '{name}' of the data has rows without a value; expected one in each, since the motion needs it")

    def off(self, found):
        """
        Return the residuals of a motion `found`, n x measured, in units of the noise; 0 for missing measurements.

        An angle that was unwrapped is known up to full turns only; those that bring its first residual closest to 0 are subtracted.
        """
        off = found - self.values
        for name in self.wraps:
            i = self.measured.index(name)
            off[:, i] -= 2 * np.pi * np.round(off[self.is_measured[:, i], i][0] / (2 * np.pi))
        return np.where(self.is_measured, off / self.noise, 0.0)

    @property
    def signals(self):
        """A function of time that returns names and values of the inputs, interpolated linearly; None without inputs."""
        if not self.inputs:
            return None
        return lambda time: (self.inputs, [float(np.interp(time, self.data["time"], self.data[name])) for name in self.inputs])

    def kinks(self):
        """Return the inner times at which the slope of an input changes."""
        time = self.data["time"]
        bends = np.zeros(len(time) - 2)
        for name in self.inputs:
            bends = np.maximum(bends, abs(np.diff(np.diff(self.data[name]) / np.diff(time))))
        return time[1:-1][bends > 0]


def check_noise(noise, experiments):
    """Raise Problem if `noise` has a name that no experiment measured."""
    measured = {name for experiment in experiments for name in experiment.measured}
    for name in noise:
        if name not in measured:
            raise Problem(f"the noise of '{name}' is given, which was not measured; expected some of {', '.join(sorted(measured))}")
