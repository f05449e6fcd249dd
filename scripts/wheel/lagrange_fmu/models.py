"""Wrap FMUs of FMI 2.0 and 3.0, in model exchange and in co-simulation, so that all have the same calls."""

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

DISCARD = 2  # fmi3Discard; lower values of fmi3Status are OK and Warning


def numbers_of(values):
    """Return a pointer to the values of a contiguous array of float64, as an argument of a C function."""
    return values.ctypes.data_as(POINTER(c_double))


class Model:
    """
    Wrap a model of FMPy and delegate all other calls to it.

    Inheritance does not work: FMPy chooses the C functions by the module in which the class of the model is defined.
    """

    def __init__(self, **options):
        self.fmu = self.kind(**options)

    def __getattr__(self, name):
        return getattr(self.fmu, name)


class _Model2(Model):
    def begin(self, messages):
        """Instantiate the FMU; append its log messages to the list `messages`."""
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
    """An FMU of FMI 2.0 in co-simulation, which has no event mode and no continuous-time mode: these calls do nothing."""

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
    options = {}  # further arguments of instantiate()

    def begin(self, messages):
        """Instantiate the FMU; append its log messages of status Discard and worse to the list `messages`."""

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
        """Return the adjoint derivative seed^T d(unknowns)/d(knowns), an array with an element for each known."""
        return np.array(self.getAdjointDerivative(unknowns, knowns, seed, len(knowns)))


class Slave3(_Model3):
    """An FMU of FMI 3.0 in co-simulation with event mode and early return: it ends its steps at events."""

    kind = FMU3Slave
    options = {"eventModeUsed": True, "earlyReturnAllowed": True}
    start_time, tolerance = 0.0, None

    def enterInitializationMode(self):
        self.fmu.enterInitializationMode(tolerance=self.tolerance, startTime=self.start_time)

    def enterContinuousTimeMode(self):
        self.enterStepMode()
