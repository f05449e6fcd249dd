"""FMI 2.0 instances through FMPy, with variable names instead of value references."""

import functools
import re
import subprocess
import tempfile
from contextlib import contextmanager
from ctypes import byref, c_double
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

from building import BUILD, LAGC, ROOT, build_systems, built_by_tests  # noqa: F401, for tests that import from here

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


def all_names():
    return sorted(path.parent.name for path in (ROOT / "fmu").glob("*/system.xml"))


temporary_folders = []  # folders of unpacked FMUs, which are removed when the process ends


def small_names():
    """Return all names but those of systems with hundreds of states. These take minutes under sanitizers, or where every pair of variables is tried."""
    return [name for name in all_names() if name not in ("HangingCable", "NFourBar", "Rope")]


# One system for each kind of runtime: taylor, auto, exact, no solver; tables; constraints, contacts, frictions. Daily tests of many systems take these alone.
OF_EACH_KIND = (ROOT / "tests" / "of_each_kind.txt").read_text().split()


@functools.cache
def unpacked_archive(path):
    folder = tempfile.TemporaryDirectory(prefix=path.stem)
    temporary_folders.append(folder)
    return Path(fmpy.extract(path, folder.name))


def unpacked(name):
    """Return the folder of an unpacked FMU of fmu/, of tests/systems/, or of build_systems(). Systems of different origins may share a name."""
    return unpacked_archive(archive(name))


def archive(name):
    if name in built_by_tests:
        return built_by_tests[name]
    folder = BUILD if (ROOT / "fmu" / name).exists() else BUILD / "test-systems"
    return folder / "fmu" / f"{name}.fmu"


read_description = functools.cache(fmpy.read_model_description)


def description(name):
    return read_description(unpacked(name))


def library(name):
    return unpacked(name) / "binaries" / "linux64" / f"{name}.so"


def further_names():
    """Names of the systems of tests/systems, which cover features that those of fmu/ do not use."""
    return sorted(path.parent.name for path in (ROOT / "tests" / "systems").glob("*/system.xml"))


def moving_names():
    """Names of the systems with coordinates."""
    return [name for name in all_names() if description(name).numberOfContinuousStates > 0]


def is_constrained(name):
    return any(variable.name.endswith(".force") for variable in description(name).modelVariables)


def references(name):
    return {variable.name: variable.valueReference for variable in description(name).modelVariables}


def names_of(name, causality):
    return [v.name for v in description(name).modelVariables if v.causality == causality]


def start_values(name):
    """Start values of states, inputs and parameters by name."""
    return {v.name: float(v.start) for v in description(name).modelVariables if v.start is not None}


def states_of(name):
    """Names of the states: coordinates, then velocities, then the work if the system computes it."""
    return [unknown.variable.derivative.name for unknown in description(name).derivatives]


def callbacks_of(logger, allocate=fmpy.calloc, release=fmpy.free, environment=None):
    """Callbacks for fmi2Instantiate; None stands for NULL."""
    callbacks = fmi2CallbackFunctions()
    if logger is not None:
        callbacks.logger = fmi2CallbackLoggerTYPE(logger)
    if allocate is not None:
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(allocate)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(release)
    callbacks.componentEnvironment = environment
    return callbacks


class Memory:
    """Allocation callbacks that count their calls."""

    def __init__(self):
        self.alive, self.count = set(), 0

    def allocate(self, number, size):
        self.count += 1
        address = fmpy.calloc(number, size)
        self.alive.add(address)
        return address

    def release(self, address):
        if address:
            self.alive.remove(address)
            fmpy.free(address)


class Instance:
    """
    Instance of an FMU. messages collects its log as (status, category, text). Calls raise FMICallException if their status is worse than a
    warning; fails() expects that.
    """

    def __init__(self, name, kind=FMU2Slave, logging=True, guid=None, callbacks=None, instance_name="instance"):
        self.description = description(name)
        self.references = references(name)
        self.messages = []
        section = self.description.coSimulation if kind is FMU2Slave else self.description.modelExchange
        self.fmu = kind(
            guid=guid or self.description.guid,
            unzipDirectory=str(unpacked(name)),
            modelIdentifier=section.modelIdentifier,
            instanceName=instance_name,
        )
        self.callbacks = callbacks or callbacks_of(self._log)
        self.time = 0.0
        self.fmu.component = None
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=logging)

    def _log(self, environment, instance_name, status, category, message):
        self.messages.append((status, category.decode(), message.decode().replace("%%", "%")))

    def vr(self, *names):
        return [self.references[name] for name in names]

    def get(self, *names):
        values = self.fmu.getReal(self.vr(*names))
        return values[0] if len(names) == 1 else values

    def set(self, values=(), **named):
        values = {**dict(values), **named}
        self.fmu.setReal(self.vr(*values), list(values.values()))

    def initialize(self, values=(), tolerance=None, start_time=0.0, stop_time=None):
        self.fmu.setupExperiment(tolerance=tolerance, startTime=start_time, stopTime=stop_time)
        self.set(values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = start_time
        return self

    def put(self, values, time=0.0):
        """Enter continuous-time mode of model exchange at these values, whose states need not satisfy the constraints."""
        values, states = dict(values), [unknown.variable.derivative.name for unknown in self.description.derivatives]
        self.reset().initialize(start_time=time)
        self.fmu.newDiscreteStates()
        self.set({name: value for name, value in values.items() if name not in states})
        if self.description.numberOfEventIndicators:
            self.fmu.newDiscreteStates()
        self.fmu.enterContinuousTimeMode()
        state = (c_double * len(states))(*(values.get(name, self.get(name)) for name in states))
        self.fmu.setContinuousStates(state, len(states))
        return self

    def reset(self):
        self.fmu.reset()
        return self

    def step(self, size):
        self.fmu.doStep(self.time, size)
        self.time += size

    def run(self, end, step, *names):
        """Step to the end; return one row (time, values of names) per communication point, including the start."""
        count = max(1, round((end - self.time) / step))
        start = self.time
        rows = [[self.time, *self.fmu.getReal(self.vr(*names))]]
        for i in range(1, count + 1):
            target = start + (end - start) * i / count
            self.step(target - self.time)
            self.time = target
            rows.append([self.time, *self.fmu.getReal(self.vr(*names))])
        return rows

    @contextmanager
    def fails(self, status, message):
        """Check that the enclosed call ends with this status and logs a message that matches the pattern."""
        before = len(self.messages)
        with pytest.raises(FMICallException) as raised:
            yield
        assert raised.value.status == status
        texts = [text for _, _, text in self.messages[before:]]
        assert any(re.search(message, text) for text in texts), f"{message!r} is not in {texts}"

    def free(self):
        if self.fmu.component is not None:
            self.fmu.fmi2FreeInstance(self.fmu.component)
            self.fmu.component = None
            self.fmu.freeLibrary()

    def free_state(self, state):
        self.fmu.fmi2FreeFMUstate(self.fmu.component, byref(state))


def complaints_about(source, compiler):
    """Warnings and errors of a plain C11 compiler for an FMU's source, with all warnings on; empty if there are none."""
    words = [compiler, "-std=c11", "-pedantic-errors", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-fsyntax-only", source]
    return subprocess.run(words, capture_output=True, text=True).stderr


def lagc(*words, cwd=None):
    return subprocess.run([LAGC, *map(str, words)], capture_output=True, text=True, cwd=cwd, timeout=120)

