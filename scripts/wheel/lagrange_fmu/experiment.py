"""A motion that was measured."""

import numpy as np

from .input_file import read_input
from .problem import Problem


class Experiment:
    def __init__(self, data, point, noise):
        """data: a CSV, or a structured array; noise: standard deviations by measured name."""
        self.data = read_input(data) if not isinstance(data, np.ndarray) else data
        names = self.data.dtype.names[1:]
        self.inputs = [name for name in names if name in point.inputs]
        self.measured = [name for name in names if name not in point.inputs]
        if len(self.data) < 2 or (np.diff(self.data["time"]) <= 0).any():
            raise Problem("data need at least two rows, and times that increase")
        if not self.measured:
            raise Problem(f"the data have no column that the system has as an output or state; expected some of {', '.join([*point.outputs, *point.states])}")
        self.noise = np.array([noise.get(name, 1.0) for name in self.measured])
        self.values = np.stack([self.data[name] for name in self.measured], axis=1)

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
