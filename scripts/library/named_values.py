"""The values of an instance of an FMU by the names of its variables. Also a module of the wheel."""

import numpy as np

from .problem import Problem
from .quantities import number_of, truth_of
from .signals import REAL
from .variables import known


def accessor(verb, variable, description):
    """Return the name of FMPy's function that gets or sets variables of this type."""
    is_second = description.fmiVersion == "2.0"
    return verb + (("Integer" if is_second else "Int64") if variable.type == "Enumeration" else variable.type)


def _count(variable):
    return int(np.prod(variable.shape)) if variable.shape else 1


def numbers_for(variable, value):
    """Return the value as a list of numbers of the variable's type; raise Problem if it does not fit."""
    name, count = variable.name, _count(variable)
    try:
        numbers = np.asarray(number_of(name, truth_of(variable, value), variable.unit or "1"), dtype=float).ravel()
    except (TypeError, ValueError):
        raise Problem(f"'{name}' is set to {value!r}; expected a number") from None
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise Problem(f"'{name}' is set to {value!r}; expected {'a finite number' if count == 1 else f'{count} finite numbers'}")
    if variable.type in REAL:
        return numbers.tolist()
    if (numbers % 1 != 0).any() or variable.type == "Boolean" and not np.isin(numbers, (0, 1)).all():
        raise Problem(f"'{name}' is set to {value!r}; expected {'True or False' if variable.type == 'Boolean' else 'a whole number'}")
    return [bool(number) if variable.type == "Boolean" else int(number) for number in numbers]


class NamedValues:
    """Variables by name: values["theta"] is a number or an array, values["theta", "omega"] an array of both; `time` is in s."""

    def __init__(self, fmu, description, time):
        self.fmu, self.description, self.time = fmu, description, time
        self.variables = {variable.name: variable for variable in description.modelVariables}

    def variable(self, name):
        if not isinstance(name, str):
            raise Problem(f"{name!r} is not the name of a variable; expected a text, such as '{next(iter(self.variables), 'time')}'")
        known([name], self.variables, self.description)
        return self.variables[name]

    def __getitem__(self, name):
        if isinstance(name, (tuple, list)):
            return np.array([self[one] for one in name])
        if name == "time":
            return self.time
        variable = self.variable(name)
        get = getattr(self.fmu, accessor("get", variable, self.description))
        if variable.shape:
            return np.array(get([variable.valueReference], _count(variable))).reshape(variable.shape)
        [value] = get([variable.valueReference])
        return bool(value) if variable.type == "Boolean" else value

    def __setitem__(self, name, value):
        raise Problem(f"'{name}' cannot be set here; expected a function that returns the inputs")

    def set(self, variable, numbers):
        getattr(self.fmu, accessor("set", variable, self.description))([variable.valueReference], numbers)

    def __contains__(self, name):
        return name in self.variables

    def __iter__(self):
        return iter(self.variables)

    def keys(self):
        return self.variables.keys()

    def _ipython_key_completions_(self):
        return list(self.variables)
