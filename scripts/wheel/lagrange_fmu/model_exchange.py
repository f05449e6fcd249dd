"""An FMU in model exchange: started at values, with its derivatives and their directional derivatives."""

import shutil
from contextlib import contextmanager

import numpy as np
from fmpy import extract
from fmpy.fmi1 import FMICallException

from .models import Model2, Model3
from .problem import Problem
from .running import fmu_of, is_fmu
from .simulation import check_start, described
from .variables import settable

ADJOINT = ("--adjoint", "--scalars")  # words for lagc


class Point:
    """An FMU that is started again and again at a point."""

    def __init__(self, model, description, values):
        self.model, self.values = model, values
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.names = {reference: name for name, reference in self.references.items()}
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
        self.model.start_over()
        if values:
            self.model.setReal([self.references[name] for name in values], list(values.values()))
        self.model.enterInitializationMode()
        self.model.exitInitializationMode()
        self.model.newDiscreteStates()
        self.model.enterContinuousTimeMode()
        return self.read(self.states)

    def set_states(self, states):
        """In the order of `states`."""
        self.model.set_states(np.ascontiguousarray(states, dtype=float))

    def indicators(self):
        """What changes its sign at events."""
        return self.model.indicators(self.indicator_count) if self.indicator_count else np.empty(0)

    def jacobian(self, unknowns, knowns):
        references = [self.references[name] for name in unknowns]
        columns = [self.model.getDirectionalDerivative(references, [self.references[name]], [1.0]) for name in knowns] if unknowns else []
        return np.array(columns).T.reshape(len(unknowns), len(knowns))


@contextmanager
def _opened(fmu, description):
    """The FMU as a model, and what it logs."""
    folder, messages = extract(str(fmu)), []
    kind = Model3 if description.fmiVersion == "3.0" else Model2
    try:
        model = kind(guid=description.guid, unzipDirectory=folder, instanceName="model", modelIdentifier=description.modelExchange.modelIdentifier)
        model.begin(messages)
        try:
            yield model, messages
        finally:
            model.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _check_abilities(fmu, description, adjoint):
    version, kind, what = ("3.0", "adjoint", "providesAdjointDerivatives") if adjoint else ("2.0", "directional", "providesDirectionalDerivative")
    if description.fmiVersion != version or not getattr(description.modelExchange, what, False):
        raise Problem(f"{fmu} has no {kind} derivatives of FMI {version}; expected a system, or an FMU that was built of it with --fmi {version[0]}")
    array = next((v.name for v in description.modelVariables if v.dimensions), None)
    if array is not None:
        raise Problem(f"'{array}' of {fmu} is an array, whose elements have no names; expected the system that the FMU was built of")


@contextmanager
def opened(system, values, method=None, what="be linearized there", adjoint=False):
    """
    The Point of an FMU, or of a system that is built for it, with values by name; what it cannot do is a Problem. It has directional derivatives,
    as FMI 2.0 has them, or adjoint ones, of FMI 3.0.
    """
    with fmu_of(system, method=method, fmi=3 if adjoint and not is_fmu(system) else None, words=ADJOINT if adjoint else ()) as fmu:
        description = described(fmu)
        _check_abilities(fmu, description, adjoint)
        check_start(values, description)
        with _opened(fmu, description) as (model, messages):
            try:
                yield Point(model, description, values)
            except FMICallException as problem:
                raise Problem("; ".join([f"{description.modelName} cannot {what}", *(messages or [str(problem)])])) from None
