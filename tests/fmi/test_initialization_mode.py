"""
Values in initialization mode are those after it: constraints are satisfied, modes are determined, and events at the start have occurred.
"""

from ctypes import c_double

import fmi3
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

import fmu

KINDS = {2: (FMU2Slave, FMU2Model), 3: (FMU3Slave, FMU3Model)}
# Displaced balls that touch would overlap, so that no simulation starts there.
WITHOUT_START_BESIDE = {"NewtonsCradle"}


# Their first sample happens as initialization ends, or in the first event iteration.
SAMPLED = {"DigitalServo", "HalfCar"}


def instances(name):
    """Yield an instance of each version and kind, in initialization mode."""
    for version, kinds in KINDS.items():
        for kind in kinds:
            instance = (fmu if version == 2 else fmi3).Instance(name, kind=kind)
            if version == 2:
                instance.fmu.setupExperiment()
            instance.fmu.enterInitializationMode()
            yield version, kind, instance
            instance.free()


def array_of(function, count):
    values = (c_double * count)()
    function(values, count)
    return list(values)


def read_directional(version, instance, unknowns, knowns):
    """Derivatives along one direction of the states and inputs; or the status of the failed call."""
    seed = [np.cos(i + 1.0) for i in range(sum(size_of(v) for v in knowns))]
    try:
        if version == 3:
            return list(instance.partial("Directional", [v.name for v in unknowns], [v.name for v in knowns], seed))
        return instance.fmu.getDirectionalDerivative([v.valueReference for v in unknowns], [v.valueReference for v in knowns], seed)
    except FMICallException as error:
        return error.status


def size_of(variable):
    return int(np.prod(variable.shape)) if getattr(variable, "shape", None) else 1


def states_of(instance):
    return [unknown.variable.derivative for unknown in instance.description.derivatives]


def has_constraints(name):
    """True if the system has constraints, including that of a quaternion's norm."""
    text = (fmu.ROOT / "fmu" / name / "system.xml").read_text()
    return "<constraint" in text or "quaternion=" in text


def without_derivatives(values, name):
    """
    Omit directional derivatives of constrained systems. In initialization mode they include the projection
    (test_initialization_derivatives.py); afterwards the states themselves are the knowns.
    """
    return repr([value for value in values if not (has_constraints(name) and isinstance(value, list))])


def read_all(version, kind, instance):
    """Values of every variable, and results of the functions for this kind of instance."""
    result = []
    for types, getter in ((("Real", "Float64"), "Float64" if version == 3 else "Real"), (("Integer", "Int32"), "Int32" if version == 3 else "Integer"),
                          (("Boolean",), "Boolean"), (("Int64",), "Int64")):  # fmt: skip
        variables = [v for v in instance.description.modelVariables if v.type in types]
        sizes = [sum(size_of(v) for v in variables)] if version == 3 else []
        if variables:
            result += getattr(instance.fmu, "get" + getter)([v.valueReference for v in variables], *sizes)
    derivatives = [unknown.variable for unknown in instance.description.derivatives]
    inputs = [v for v in instance.description.modelVariables if v.causality == "input"]
    outputs = [unknown.variable for unknown in instance.description.outputs]
    if derivatives and instance.description.modelName not in WITHOUT_START_BESIDE:
        result.append(read_directional(version, instance, derivatives + outputs, states_of(instance) + inputs))
    if kind in (FMU2Model, FMU3Model) and derivatives:
        count = sum(size_of(v) for v in derivatives)
        result += array_of(instance.fmu.getContinuousStates, count)
        result += array_of(instance.fmu.getDerivatives if version == 2 else instance.fmu.getContinuousStateDerivatives, count)
        indicators = instance.description.numberOfEventIndicators
        result += array_of(instance.fmu.getEventIndicators, indicators) if indicators else []
    return result


def set_beside(instance, share):
    """Displace each state from its start value, so that constraints are violated."""
    values = {}
    for i, variable in enumerate(states_of(instance)):
        start = np.array([float(word) for word in str(variable.start).split()])
        start = np.resize(start, size_of(variable))
        values[variable.name] = start + share * float(variable.nominal or 1) * np.sin(1.0 + i + np.arange(len(start)))
    instance.set(values if hasattr(instance, "variables") else {name: value[0] for name, value in values.items()})


def warnings_of(instance):
    return [text for _, _, text in instance.messages if "there is no consistent start" in text]


@pytest.mark.parametrize("name", fmu.all_names())
def test_values_before_equal_those_after(name):
    """Values agree bit by bit before and after the end of initialization mode, and reading does not affect later settings."""
    for version, kind, instance in instances(name):
        before = read_all(version, kind, instance)
        set_beside(instance, 2e-3)
        read_all(version, kind, instance)
        set_beside(instance, 0.0)
        again = read_all(version, kind, instance)
        instance.fmu.exitInitializationMode()
        assert repr(before) == repr(again), (version, kind)
        if name in SAMPLED and kind in (FMU2Slave, FMU3Slave):
            continue
        assert without_derivatives(again, name) == without_derivatives(read_all(version, kind, instance), name), (version, kind)
        assert warnings_of(instance) == [] or name in WITHOUT_START_BESIDE


@pytest.mark.parametrize("name", fmu.all_names())
def test_start_off_the_constraints(name):
    for version, kind, instance in instances(name):
        set_beside(instance, 2e-3)
        read = read_all(version, kind, instance)
        if name in WITHOUT_START_BESIDE:
            with pytest.raises(FMICallException):
                instance.fmu.exitInitializationMode()
            assert len(warnings_of(instance)) == 1
            continue
        instance.fmu.exitInitializationMode()
        if name in SAMPLED and kind in (FMU2Slave, FMU3Slave):
            continue
        assert without_derivatives(read, name) == without_derivatives(read_all(version, kind, instance), name), (version, kind)
        assert warnings_of(instance) == []


@pytest.mark.parametrize("version", KINDS)
def test_values_of_the_start(version):
    """The linkage closes; the belt drags the block along."""
    for _, _, instance in (one for one in instances("StickSlip") if one[0] == version):
        instance.set(v=0.0)
        assert instance.get("der(v)") == 0.5
        instance.set(v=0.2)
        assert instance.get("der(v)") == -0.5
    for _, _, instance in (one for one in instances("FourBar") if one[0] == version):
        names = "theta", "phi", "psi", "omega", "omegaCoupler", "omegaRocker", "a", "b", "c", "d"
        theta, phi, psi, *rates, a, b, c, d = instance.get(*names)
        lengths = np.array([a, b, -c])
        assert lengths @ np.exp(1j * np.array([theta, phi, psi])) - d == pytest.approx(0, abs=1e-12)
        assert lengths @ (np.array(rates) * np.exp(1j * np.array([theta, phi, psi]))) == pytest.approx(0, abs=1e-12)
        assert rates[2] != 0


def test_without_a_start(open_fmu):
    """Without a consistent start, values stay as set, with one warning; later settings are accepted."""
    instance = open_fmu("FourBar")
    instance.fmu.setupExperiment()
    instance.set(phi=0.7)
    instance.fmu.enterInitializationMode()
    theta = instance.get("theta")
    instance.set(d=100.0)
    for _ in range(3):
        assert instance.get("phi") == 0.7
    instance.set(theta=0.3)
    assert instance.get("theta") == 0.3
    (warning,) = warnings_of(instance)
    assert "fulfil the constraint" in warning
    with instance.fails(fmu.ERROR, "fulfil the constraint"):
        instance.fmu.exitInitializationMode()
    instance = instance.reset().initialize({"phi": 0.7})
    assert instance.get("theta") == theta


def test_an_error_while_reading_lasts(open_fmu):
    instance = open_fmu("FourBar")
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    with pytest.raises(FMICallException):
        instance.fmu.getReal([instance.references["theta"], 9999])
    with instance.fails(fmu.ERROR, "not allowed in the state 'error'"):
        instance.fmu.exitInitializationMode()

