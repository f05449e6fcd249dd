"""A system to first order at a point, by the directional derivatives of its FMU."""

import shutil
import warnings
from collections.abc import Callable
from contextlib import contextmanager
from typing import NamedTuple

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

STEP = 1e-3  # of differences of fourth order, in which what is cut off and roundings are both about 1e-12


class Linearization(NamedTuple):
    """
    der(x - x0) = A (x - x0) + B (u - u0) + der(x0),  y - y0 = C (x - x0) + D (u - u0), all in SI units: n states, m inputs, p outputs. Where
    there are constraints, the states are as many of the system's as are independent; the others follow.
    """

    A: np.ndarray  # n x n
    B: np.ndarray  # n x m
    C: np.ndarray  # p x n
    D: np.ndarray  # p x m
    states: list[str]
    inputs: list[str]
    outputs: list[str]
    point: dict[str, float]  # x0, as initialization moved it, and u0, by name


class _Point:
    """An FMU that is started again and again at a point."""

    def __init__(self, model, description, values):
        self.model, self.values = model, values
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.derivatives = [unknown.variable.name for unknown in description.derivatives]
        self.states = [unknown.variable.derivative.name for unknown in description.derivatives]
        self.inputs = [v.name for v in description.modelVariables if v.causality == "input"]
        self.outputs = [v.name for v in description.modelVariables if v.causality == "output"]

    def read(self, names):
        return np.array(self.model.getReal([self.references[name] for name in names])) if names else np.empty(0)

    def start(self, states=None):
        """The states that initialization makes of those."""
        values = self.values | (dict(zip(self.states, states)) if states is not None else {})
        self.model.reset()
        self.model.setupExperiment(startTime=0.0)
        if values:
            self.model.setReal([self.references[name] for name in values], list(values.values()))
        self.model.enterInitializationMode()
        self.model.exitInitializationMode()
        self.model.newDiscreteStates()
        self.model.enterContinuousTimeMode()
        return self.read(self.states)

    def jacobian(self, unknowns, knowns):
        references = [self.references[name] for name in unknowns]
        columns = [self.model.getDirectionalDerivative(references, [self.references[name]], [1.0]) for name in knowns] if unknowns else []
        return np.array(columns).T.reshape(len(unknowns), len(knowns))

    def tangents(self, at):
        """
        The directions in which the states can move, as orthonormal columns. Initialization projects onto the states that fulfil the constraints;
        what it does to first order is a projection onto these directions, whose singular values are 0, or 1 and more.
        """
        columns = []
        for i in range(len(at)):
            step = np.eye(len(at))[i] * STEP * max(1.0, abs(at[i]))
            one, two = (self.start(at + k * step) - self.start(at - k * step) for k in (1, 2))
            columns.append((8 * one - two) / (12 * step[i]))
        left, singular, _ = np.linalg.svd(np.array(columns).T)
        return left[:, : np.count_nonzero(singular > 0.5)]


def independent(tangents):
    """As many rows as there are columns: the first ones that are far from what those before them span."""
    rows, chosen = tangents.copy(), []
    for _ in range(tangents.shape[1]):
        lengths = np.linalg.norm(rows, axis=1)
        chosen.append(int(np.argmax(lengths >= 0.3 * lengths.max())))
        direction = rows[chosen[-1]] / lengths[chosen[-1]]
        rows -= np.outer(rows @ direction, direction)
    return sorted(chosen)


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
            guid=description.guid, unzipDirectory=folder, instanceName="linearize", modelIdentifier=description.modelExchange.modelIdentifier
        )
        callbacks = _callbacks(messages.append)  # which lives as long as the model
        model.instantiate(callbacks=callbacks)
        try:
            yield model, messages
        finally:
            model.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def linearize(system, at=None, method=None):
    with fmu_of(system, method=method) as fmu:
        description = described(fmu)
        if description.fmiVersion != "2.0" or description.modelExchange is None or not description.modelExchange.providesDirectionalDerivative:
            raise Problem(f"{fmu} has no directional derivatives of FMI 2.0; expected a system, or an FMU that was built of it with --fmi 2")
        values = dict(at or {})
        check_start(values, description)
        with _opened(fmu, description) as (model, messages):
            try:
                return _linearization(_Point(model, description, values))
            except FMICallException as problem:
                raise Problem("; ".join([f"{description.modelName} cannot be linearized there", *(messages or [str(problem)])])) from None


def _linearization(point):
    at = point.start()
    tangents = point.tangents(at) if len(at) else np.empty((0, 0))
    chosen = independent(tangents)
    basis = tangents @ np.linalg.inv(tangents[chosen])
    point.start(at)
    derivatives = dict(zip(point.derivatives, point.read(point.derivatives)))
    moving = [f"{name} = {value:.6g}" for name, value in derivatives.items() if abs(value) > 1e-6]
    if moving:
        warnings.warn(f"the point is not an equilibrium: {', '.join(moving)}", stacklevel=4)
    rates = [point.derivatives[i] for i in chosen]
    return Linearization(
        point.jacobian(rates, point.states) @ basis,
        point.jacobian(rates, point.inputs),
        point.jacobian(point.outputs, point.states) @ basis,
        point.jacobian(point.outputs, point.inputs),
        [point.states[i] for i in chosen],
        point.inputs,
        point.outputs,
        dict(zip(point.states, at.tolist())) | dict(zip(point.inputs, point.read(point.inputs).tolist())),
    )
