"""Simulations that a program advances step by step."""

import math
import shutil
import weakref
from contextlib import contextmanager
from numbers import Real

from fmpy import extract
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, calloc, fmi2CallbackAllocateMemoryTYPE, fmi2CallbackFreeMemoryTYPE, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, free
from fmpy.simulation import instantiate_fmu

from .co_simulation import Slave2, Slave3, check_platform
from .loading import loading
from .named_values import NamedValues, numbers_for
from .problem import Problem
from .quantities import number_of
from .running import fmu_of
from .saved_state import State, check_ability, check_state, content2, content3, go_to2, go_to3
from .simulation import described, experiment_of, log_into, tolerance_of
from .variables import checked_start, numbers_by_name, startable, unsettable_reason


def _release(folder, instances):
    """Free the instance in the list `instances`, if there is one, and its files."""
    while instances:
        instances.pop().freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


ARGUMENTS = "start_values", "fmi", "solver", "tolerance"  # arguments of start() beside the names of variables


def _instantiate(folder, description, logger, has_events):
    """
    Return an instance for co-simulation with a logger of its own. FMPy's instantiate_fmu() sends the messages of all FMUs of FMI 2.0 to the logger of
    the last one, even after that one is freed.
    """
    if description.fmiVersion.startswith("3"):
        return instantiate_fmu(folder, description, "CoSimulation", False, True, logger, None, None, has_events, has_events)
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=description.coSimulation.modelIdentifier)

    def log(*words):  # a message is a format of printf()
        logger(*words[:-1], words[-1].replace(b"%%", b"%"))

    memory = fmi2CallbackAllocateMemoryTYPE(calloc), fmi2CallbackFreeMemoryTYPE(free)
    fmu.instantiate(callbacks=fmi2CallbackFunctions(fmi2CallbackLoggerTYPE(log), *memory), loggingOn=True)
    return fmu


class Simulation(NamedValues):
    """
    A running FMU.

    `sim["theta"]` reads a variable, `sim["theta", "omega"]` an array of several. `sim["tau"] = 0.5` sets an input or a parameter, which keeps this value.
    close(), or the end of a `with`, ends the simulation. `time` is in s; `inputs` and `outputs` are lists of names.
    """

    def __init__(self, system, start_values, fmi=None, solver=None, tolerance=None):
        with fmu_of(system, method=solver, fmi=fmi) as archive:
            description = described(archive)
            if description.coSimulation is None:
                raise Problem(f"{archive} does not support co-simulation; expected an FMU that does")
            check_platform(archive)
            folder, instances = extract(str(archive)), []
        self._close = weakref.finalize(self, _release, folder, instances)
        self._begin, *_ = experiment_of(description)
        super().__init__(None, description, self._begin)
        self._tolerance, self._problems = tolerance_of(description, tolerance), []
        self._start = self._checked(start_values)
        self.inputs, self.outputs = ([v.name for v in description.modelVariables if v.causality == kind] for kind in ("input", "output"))
        self._is_third = description.fmiVersion.startswith("3")
        has_events = self._is_third and description.coSimulation.hasEventMode
        try:
            with self._named("cannot start"):
                with loading():
                    self.fmu = _instantiate(folder, description, log_into(self._problems), has_events)
                instances.append(self.fmu)
                self._slave = (Slave3 if self._is_third else Slave2)(self.fmu, description, None)
                self._initialize(self._start)
        except Problem:
            self.close()
            raise
        self._is_ready = True

    def __getattr__(self, name):
        hint = f"; expected sim['{name}']" if name in self.__dict__.get("variables", ()) else ""
        raise AttributeError(f"a simulation has no attribute '{name}'{hint}")

    def __setattr__(self, name, value):
        if self.__dict__.get("_is_ready") and name not in self.__dict__ and name in self.variables:
            raise Problem(f"'{name}' is a variable, not an attribute; expected sim['{name}'] = ...")
        super().__setattr__(name, value)

    def _checked(self, start_values):
        """Return start values by name as numbers of their variables' types, lists for arrays."""
        found = {name: numbers_for(self.variables[name], value) for name, value in checked_start(start_values, self.description, startable(self.description), ARGUMENTS).items()}
        return {name: numbers if self.variables[name].shape else numbers[0] for name, numbers in found.items()}

    @contextmanager
    def _named(self, what):
        """Raise Problem for a call that fails, with the FMU's messages."""
        self._problems.clear()
        try:
            yield
        except FMICallException as problem:
            raise Problem(f"{self.description.modelName} {what}: {'; '.join(dict.fromkeys(self._problems)) or problem}") from None

    def _initialize(self, start_values):
        self._lacks_start = ""
        self._slave.initialize(start_values, None, self._begin, None, self._tolerance)
        self._slave.begin()
        self.time = self._begin

    def _check_started(self):
        self._check_open()
        if self._lacks_start:
            raise Problem(f"{self.description.modelName} has not started, since {self._lacks_start}; expected reset() with other start values")

    def _check_open(self):
        if self.fmu is None:
            raise Problem(f"the simulation of {self.description.modelName} is closed; expected lagrange_fmu.start(...) again")

    def __getitem__(self, name):
        self._check_started()
        with self._named(f"has no value of {name!r}"):
            return super().__getitem__(name)

    def __setitem__(self, name, value):
        self._check_started()
        variable = self.variable(name)
        self._check_settable(variable)
        numbers = numbers_for(variable, value)
        with self._named(f"does not take {value!r} for '{name}'"):
            self._slave.change(lambda: self.set(variable, numbers))

    def _check_settable(self, variable):
        if variable.causality == "input" or variable.causality == "parameter" and variable.variability == "tunable":
            return
        name = variable.name
        if name in startable(self.description):
            raise Problem(f"'{name}' can be set at the start only; expected start(..., {{'{name}': ...}}) or reset({{'{name}': ...}})")
        raise Problem(f"'{name}' of {self.description.modelName} cannot be set{unsettable_reason(name, self.description)}; these are inputs: {', '.join(self.inputs) or 'none'}")

    def step(self, length):
        """Advance by a length in s, with constant inputs. Raise Problem if the step fails; then the time is unchanged, and restore() and reset() are possible."""
        self._check_started()
        length = number_of("the step", length, "s")
        if not (isinstance(length, Real) and 0 < length < math.inf):
            raise Problem(f"the step is {length!r}; expected a positive number of seconds")
        end = self.time + float(length)
        if end == self.time:
            raise Problem(f"the step of {length:g} s is below the resolution of time at {end:.9g} s; expected a longer one")
        with self._named(f"cannot step from {self.time:.9g} s to {end:.9g} s"):
            self._slave.step(self.time, end, None, None)
        self.time = end

    def save(self):
        """Return the State for restore()."""
        self._check_started()
        check_ability(self.description)
        with self._named("cannot save its state"):
            return State(self.time, self.description.guid, (content3 if self._is_third else content2)(self.fmu))

    def restore(self, state):
        """Return to a saved State, bit for bit."""
        self._check_open()
        check_state(state, self.description)
        with self._named("cannot restore the state"):
            (go_to3 if self._is_third else go_to2)(self.fmu, state.content)
        self._lacks_start = ""
        self.time = state.time

    def reset(self, start_values=None, /, **values):
        """Start again; these start values replace those of start()."""
        self._check_open()
        start_values = self._checked(numbers_by_name(start_values) | numbers_by_name(values))
        try:
            with self._named("cannot start"):
                self.fmu.reset()
                self._initialize(self._start | start_values)
        except Problem as problem:
            self._lacks_start = str(problem)
            raise

    def close(self):
        self._close()
        self.fmu = self._slave = None

    def __enter__(self):
        self._check_open()
        return self

    def __exit__(self, *problem):
        self.close()

    def __reduce__(self):
        raise Problem("a simulation can be neither copied nor pickled; expected its save(), and restore() in another simulation")

    def __repr__(self):
        return f"<{'closed simulation' if self.fmu is None else 'simulation'} of {self.description.modelName} at {self.time:.9g} s>"
