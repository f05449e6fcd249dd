"""A motion that was measured."""

import os

import numpy as np

from .input_file import read_table
from .problem import Problem


def _table_of(data, point):
    if isinstance(data, (str, os.PathLike)):
        return read_table(data, point.units)
    names = getattr(getattr(data, "dtype", None), "names", None) or ()
    if names[:1] != ("time",) or len(names) < 2:
        raise Problem("the data are neither a CSV nor a structured array whose first name is time; expected one, such as frame.to_records(index=False) of pandas")
    return data


def _check_times(times):
    if len(times) < 2:
        raise Problem("the data have fewer than two rows; expected a motion over some time")
    if not np.isfinite(times).all():
        raise Problem("the data have a row without a finite time; expected a time in each")
    back = np.flatnonzero(np.diff(times) <= 0)
    if len(back):
        raise Problem(f"the time {times[back[0] + 1]:.15g} s of the data follows {times[back[0]]:.15g} s; expected sorted rows, each time once, and further experiments in files of their own")


class Experiment:
    def __init__(self, data, point, noise):
        """data: a CSV, or a structured array, in which NaN is what was not measured; noise: standard deviations by measured name."""
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
        self.wraps = {}  # of measured angles that do, the time of the first jump
        for i, name in enumerate(self.measured):
            if point.units.get(name) == "rad":
                self._unwrap(i, name)

    def _unwrap(self, i, name):
        """Removes the jumps of an angle that lies within a turn, unless they are as frequent as steps: that is a motion of few rows."""
        rows = self.is_measured[:, i]
        values, times = self.values[rows, i], self.data["time"][rows]
        jumps = np.flatnonzero(abs(np.diff(values)) > np.pi)
        if len(jumps) and np.ptp(values) < 2 * np.pi + 0.1 and 2 * len(jumps) < len(values) - 1:
            self.values[rows, i], self.wraps[name] = np.unwrap(values), float(times[jumps[0] + 1])

    def unwrapped(self):
        """The data, of which angles do not wrap."""
        data = np.array(self.data)
        for name in self.wraps:
            data[name] = self.values[:, self.measured.index(name)]
        return data

    def _check_columns(self, point):
        read = [*dict.fromkeys([*point.outputs, *point.states, *point.derivatives])]
        for name in self.measured:
            if name not in read:
                raise Problem(f"'{name}' of the data is not an output, a state or its derivative, nor an input; expected a column less, or one of these names: {', '.join([*read, *point.inputs])}")
        if not self.measured:
            raise Problem(f"the data have no column that the system has as an output or state; expected some of {', '.join(read)}")
        for name in [*self.inputs, *self.measured]:
            values = self.data[name]
            if np.isinf(values).any() or not np.isfinite(values).any():
                raise Problem(f"'{name}' of the data has an infinite value, or none at all; expected finite numbers, and nothing where it was not measured")
            if name in self.inputs and not np.isfinite(values).all():
                raise Problem(f"the input '{name}' of the data has rows without a value; expected one in each, since the motion needs it")

    def off(self, found):
        """By how much a motion, n x measured, misses the data, in units of the noise; 0 of what was not measured. Angles that wrap are known but for whole turns."""
        off = found - self.values
        for name in self.wraps:
            i = self.measured.index(name)
            off[:, i] -= 2 * np.pi * np.round(off[self.is_measured[:, i], i][0] / (2 * np.pi))
        return np.where(self.is_measured, off / self.noise, 0.0)

    @property
    def signals(self):
        """Names and values of the inputs at a time; None without any."""
        if not self.inputs:
            return None
        return lambda time: (self.inputs, [float(np.interp(time, self.data["time"], self.data[name])) for name in self.inputs])

    def kinks(self):
        """The inner times where an input, which is linear between the rows, changes its slope."""
        time = self.data["time"]
        bends = np.zeros(len(time) - 2)
        for name in self.inputs:
            bends = np.maximum(bends, abs(np.diff(np.diff(self.data[name]) / np.diff(time))))
        return time[1:-1][bends > 0]


def check_noise(noise, experiments):
    measured = {name for experiment in experiments for name in experiment.measured}
    for name in noise:
        if name not in measured:
            raise Problem(f"the noise of '{name}' is given, which was not measured; expected some of {', '.join(sorted(measured))}")
