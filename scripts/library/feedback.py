"""Feedback: inputs computed by a function of the time and of the present values of a simulation. Also a module of the wheel."""

import inspect
from collections.abc import Mapping

import numpy as np

from .named_values import NamedValues, numbers_for
from .problem import Problem
from .variables import known


def is_feedback(data):
    """Return True for a function of two arguments, the time and the simulation."""
    try:
        parameters = inspect.signature(data).parameters.values() if callable(data) else ()
    except ValueError:  # NumPy's functions have no signature
        return False
    return sum(p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD) for p in parameters) == 2


class Feedback:
    """Inputs that are constant over a step: function(time, values) returns a dict of numbers by name, or a number for each input."""

    def __init__(self, function, slave, description):
        self.function, self.slave = function, slave
        self.values = NamedValues(slave.fmu, description, None)
        self.inputs = [v.name for v in description.modelVariables if v.causality == "input"]

    def apply(self, time):
        """Evaluate and set the inputs."""
        self.values.time = time
        given = self._by_name(self.function(time, self.values), time)
        found = [(self.values.variables[name], numbers_for(self.values.variables[name], value)) for name, value in given.items()]
        self.slave.change(lambda: [self.values.set(variable, numbers) for variable, numbers in found])

    def _by_name(self, given, time):
        if isinstance(given, Mapping):
            known(given, self.inputs, self.values.description, "is not an input")
            return given
        own = [name for name in self.inputs if not name.startswith("der(")]
        numbers = np.ravel(given)
        if len(numbers) != len(own):
            raise Problem(f"the input at {time:.15g} s has {len(numbers)} numbers; expected {len(own)}, of {', '.join(own) or 'no inputs'}, or a dict of numbers by name")
        return dict(zip(own, numbers.tolist()))
