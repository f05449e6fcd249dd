"""An FMU of FMI 2.0 in model exchange: started at values, with its derivatives and their directional derivatives."""

import shutil
from collections.abc import Callable
from contextlib import contextmanager
from ctypes import POINTER, c_double

import numpy as np
from fmpy import calloc, extract, free
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Model,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

from .problem import Problem
from .running import fmu_of
from .simulation import check_start, described
from .variables import settable


class Point:
    """An FMU that is started again and again at a point."""

    def __init__(self, model, description, values):
        self.model, self.values = model, values
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.derivatives = [unknown.variable.name for unknown in description.derivatives]
        self.states = [unknown.variable.derivative.name for unknown in description.derivatives]
        self.inputs = [v.name for v in description.modelVariables if v.causality == "input"]
        self.name = description.modelName
        self.limits = {v.name: tuple(float(end) if end is not None else none for end, none in ((v.min, -np.inf), (v.max, np.inf))) for v in description.modelVariables}
        self.settable = settable(description)
        self.indicator_count = description.numberOfEventIndicators
        self.outputs = [v.name for v in description.modelVariables if v.causality == "output"]

    def read(self, names):
        return np.array(self.model.getReal([self.references[name] for name in names])) if names else np.empty(0)

    def start(self, states=None, values=None):
        """The states that initialization makes of those, and of values by name."""
        values = self.values | (values or {}) | (dict(zip(self.states, states)) if states is not None else {})
        self.model.reset()
        self.model.setupExperiment(startTime=0.0)
        if values:
            self.model.setReal([self.references[name] for name in values], list(values.values()))
        self.model.enterInitializationMode()
        self.model.exitInitializationMode()
        self.model.newDiscreteStates()
        self.model.enterContinuousTimeMode()
        return self.read(self.states)

    def set_states(self, states):
        """In the order of `states`."""
        values = np.ascontiguousarray(states, dtype=float)
        self.model.fmi2SetContinuousStates(self.model.component, values.ctypes.data_as(POINTER(c_double)), len(values))

    def indicators(self):
        """What changes its sign at events."""
        values = np.zeros(self.indicator_count)
        if len(values):
            self.model.fmi2GetEventIndicators(self.model.component, values.ctypes.data_as(POINTER(c_double)), len(values))
        return values

    def jacobian(self, unknowns, knowns):
        references = [self.references[name] for name in unknowns]
        columns = [self.model.getDirectionalDerivative(references, [self.references[name]], [1.0]) for name in knowns] if unknowns else []
        return np.array(columns).T.reshape(len(unknowns), len(knowns))


def _callbacks(log: Callable[[str], None]):
    callbacks = fmi2CallbackFunctions()
    callbacks.logger = fmi2CallbackLoggerTYPE(lambda *words: log(words[4].decode()))
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    return callbacks


@contextmanager
def _opened(fmu, description):
    """The FMU as a model, and what it logs."""
    folder, messages = extract(str(fmu)), []
    try:
        model = FMU2Model(
            guid=description.guid, unzipDirectory=folder, instanceName="model", modelIdentifier=description.modelExchange.modelIdentifier
        )
        callbacks = _callbacks(messages.append)  # which lives as long as the model
        model.instantiate(callbacks=callbacks)
        try:
            yield model, messages
        finally:
            model.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def opened(system, values, method=None, what="be linearized there"):
    """The Point of an FMU, or of a system that is built for it, with values by name; what it cannot do is a Problem."""
    with fmu_of(system, method=method) as fmu:
        description = described(fmu)
        if description.fmiVersion != "2.0" or description.modelExchange is None or not description.modelExchange.providesDirectionalDerivative:
            raise Problem(f"{fmu} has no directional derivatives of FMI 2.0; expected a system, or an FMU that was built of it with --fmi 2")
        check_start(values, description)
        with _opened(fmu, description) as (model, messages):
            try:
                yield Point(model, description, values)
            except FMICallException as problem:
                raise Problem("; ".join([f"{description.modelName} cannot {what}", *(messages or [str(problem)])])) from None
