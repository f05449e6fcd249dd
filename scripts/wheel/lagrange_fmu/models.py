"""FMUs in model exchange, of FMI 2.0 and 3.0, and in co-simulation, with the same calls."""

from ctypes import POINTER, c_double

import numpy as np
from fmpy import calloc, free
from fmpy.fmi2 import (
    FMU2Model,
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Model, FMU3Slave

DISCARD = 2  # fmi3Discard; what is less is no problem


def numbers_of(values):
    """The argument of a function of C."""
    return values.ctypes.data_as(POINTER(c_double))


class Model:
    """Has the calls of FMPy's model too, which cannot be inherited from: FMPy tells by the module of the class which C functions it has."""

    def __init__(self, **options):
        self.fmu = self.kind(**options)

    def __getattr__(self, name):
        return getattr(self.fmu, name)


class _Model2(Model):
    def begin(self, messages):
        """Instantiates it; what it logs is appended to the list."""
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(lambda *words: messages.append(words[4].decode()))
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.instantiate(callbacks=callbacks)


class Model2(_Model2):
    kind = FMU2Model

    def start_over(self):
        self.reset()
        self.setupExperiment(startTime=0.0)

    def set_states(self, values):
        self.fmi2SetContinuousStates(self.component, numbers_of(values), len(values))

    def indicators(self, count):
        values = np.zeros(count)
        self.fmi2GetEventIndicators(self.component, numbers_of(values), count)
        return values

    def whole_numbers(self, references):
        return self.getInteger(references)


class Slave2(_Model2):
    """In co-simulation, which knows no modes of model exchange."""

    kind = FMU2Slave
    start_time, tolerance = 0.0, None

    def start_over(self):
        self.reset()
        self.setupExperiment(startTime=self.start_time, tolerance=self.tolerance)

    def newDiscreteStates(self):
        pass

    def enterContinuousTimeMode(self):
        pass


class _Model3(Model):
    options = {}  # of an instance

    def begin(self, messages):
        """Instantiates it; the problems that it logs are appended to the list."""

        def log(environment, status, category, message):
            if status >= DISCARD:
                messages.append(message.decode())

        self.instantiate(loggingOn=True, logMessage=log, **self.options)

    def start_over(self):
        self.reset()

    def getReal(self, references):
        return self.fmu.getFloat64(references)

    def setReal(self, references, values):
        self.fmu.setFloat64(references, values)

    def whole_numbers(self, references):
        return self.fmu.getInt32(references)

    def newDiscreteStates(self):
        return self.fmu.updateDiscreteStates()


class Model3(_Model3):
    kind = FMU3Model

    def set_states(self, values):
        self.fmi3SetContinuousStates(self.component, numbers_of(values), len(values))

    def indicators(self, count):
        values = np.zeros(count)
        self.fmi3GetEventIndicators(self.component, numbers_of(values), count)
        return values

    def adjoint(self, unknowns, knowns, seed):
        """seed^T d unknowns / d knowns, as an array."""
        return np.array(self.getAdjointDerivative(unknowns, knowns, seed, len(knowns)))


class Slave3(_Model3):
    """In co-simulation, which ends its steps at events."""

    kind = FMU3Slave
    options = {"eventModeUsed": True, "earlyReturnAllowed": True}
    start_time, tolerance = 0.0, None

    def enterInitializationMode(self):
        self.fmu.enterInitializationMode(tolerance=self.tolerance, startTime=self.start_time)

    def enterContinuousTimeMode(self):
        self.enterStepMode()
