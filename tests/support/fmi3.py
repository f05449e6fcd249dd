"""FMI 3.0 instances through FMPy, with variable names instead of value references."""

from ctypes import c_double, c_uint32

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3Slave

import fmu


def archive(name):
    return fmu.archive(name).parent.parent / "fmi3" / f"{name}.fmu"


def unpacked(name):
    return fmu.unpacked_archive(archive(name))


def description(name):
    return fmu.read_description(unpacked(name))


def library(name):
    return unpacked(name) / "binaries" / "x86_64-linux" / f"{name}.so"


class Instance:
    """
    Instance of an FMU. messages collects its log as (status, category, text). Calls raise FMICallException if their status is worse than a
    warning.
    """

    def __init__(self, name, kind=FMU3Slave, logging=True, token=None, instance_name="instance", **options):
        self.description = description(name)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.messages = []
        self.fmu = kind(
            guid=token or self.description.instantiationToken, unzipDirectory=str(unpacked(name)), modelIdentifier=name,
            instanceName=instance_name,
        )  # fmt: skip
        self.fmu.component = None
        self.time = 0.0
        self.fmu.instantiate(loggingOn=logging, logMessage=self._log, **options)

    def _log(self, environment, status, category, message):
        self.messages.append((status, category.decode(), message.decode()))

    def vr(self, *names):
        return [self.variables[name].valueReference for name in names]

    def size(self, *names):
        return sum(int(np.prod(self.variables[name].shape)) if self.variables[name].shape else 1 for name in names)

    def get(self, *names):
        return np.array(self.fmu.getFloat64(self.vr(*names), self.size(*names)))

    def set(self, values=(), **named):
        values = {**dict(values), **named}
        flat = [float(number) for value in values.values() for number in np.atleast_1d(value)]
        self.fmu.setFloat64(self.vr(*values), flat)

    def initialize(self, values=(), **words):
        self.set(values)
        self.fmu.enterInitializationMode(**words)
        self.fmu.exitInitializationMode()
        self.time = words.get("startTime", 0.0)
        return self

    def step(self, size):
        """Return the output arguments of fmi3DoStep: eventHandlingNeeded, terminateSimulation, earlyReturn, lastSuccessfulTime."""
        result = self.fmu.doStep(self.time, size)
        self.time = result[3]
        return result

    def partial(self, what, unknowns, knowns, seed):
        """Call fmi3GetDirectionalDerivative or fmi3GetAdjointDerivative."""
        of_seed, of_result = (knowns, unknowns) if what == "Directional" else (unknowns, knowns)
        values = (c_double * self.size(*of_seed))(*seed)
        result = (c_double * self.size(*of_result))()
        references = [(c_uint32 * len(names))(*self.vr(*names)) for names in (unknowns, knowns)]
        function = getattr(self.fmu, f"fmi3Get{what}Derivative")
        function(self.fmu.component, references[0], len(unknowns), references[1], len(knowns), values, len(values), result, len(result))
        return np.array(result)

    def free(self):
        if self.fmu.component:
            self.fmu.fmi3FreeInstance(self.fmu.component)
            self.fmu.freeLibrary()
            self.fmu.component = None


class Importer:
    """Callback for intermediate update: reads variables within steps, and may request an early return."""

    def __init__(self, end_at=None):
        self.calls, self.end_at, self.instance, self.names, self.problem = [], end_at, None, [], None

    def __call__(self, environment, time, set_requested, get_allowed, finished, can_return, requested, return_time):
        assert get_allowed and finished and not set_requested
        try:
            self.calls.append((time, can_return, self.instance.get(*self.names) if self.names else None))
        except FMICallException as problem:
            self.problem = problem
        if self.end_at is not None and can_return:
            requested[0] = True
            return_time[0] = self.end_at


class Supplier:
    """Callback that sets inputs within steps, {name: function of time}, and calls `action` with the instance at each request."""

    def __init__(self, signals, action=None):
        self.signals, self.action, self.times, self.instance, self.problem = signals, action, [], None, None

    def __call__(self, environment, time, set_requested, get_allowed, finished, can_return, requested, return_time):
        if not set_requested:
            return
        assert not get_allowed and not finished and not can_return
        self.times.append(time)
        try:
            if self.signals:
                self.instance.set({name: signal(time) for name, signal in self.signals.items()})
            if self.action is not None:
                self.action(self.instance)
        except FMICallException as problem:
            self.problem = problem


def supplied(opened, name, supplier, variables, **options):
    references = [v.valueReference for v in description(name).modelVariables if v.name in variables]
    supplier.instance = opened(name, intermediateUpdate=supplier, requiredIntermediateVariables=references, **options)
    return supplier.instance


def observed(opened, name, importer, variables, **options):
    references = [v.valueReference for v in description(name).modelVariables if v.name in variables]
    importer.names = variables
    importer.instance = opened(name, intermediateUpdate=importer, requiredIntermediateVariables=references, **options)
    return importer.instance
