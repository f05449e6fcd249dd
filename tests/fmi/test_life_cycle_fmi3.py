"""Allowed calls of FMI 3.0 by state: sections 2.3, 3.2 and 4.2 of the standard, typed again."""

from ctypes import POINTER, byref, c_bool, c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3Slave

import fmi3
from fmu import ERROR
from test_fmi3 import FUNCTIONS

NAME = "ParticlePolar"
# Allowed while the FMU requests inputs at times within a step.
REQUEST = {"fmi3SetDebugLogging", "fmi3SetFloat64", "fmi3SetFloat32"}
CS_STATES = ["instantiated", "initialization", "step", "intermediate", "terminated", "error"]
ME_STATES = ["instantiated", "initialization", "event", "continuous", "terminated", "error"]

READ = {"CS": "-    x    x    x    x    x", "ME": "-    x    x    x    x    x"}
WRITE = {"CS": "x    x    x    -    -    -", "ME": "x    x    x    -    -    -"}
FLOAT = {"CS": "x    x    x    -    -    -", "ME": "x    x    x    x    -    -"}
STATE = {"CS": "x    x    x    -    x    x", "ME": "x    x    x    x    x    x"}
NEVER = {"CS": "-    -    -    -    -    -", "ME": "-    -    -    -    -    -"}
TYPES = ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Boolean", "String", "Binary"]
TABLE = {
    #                                        inst init step intm term erro        inst init evnt cont term erro
    "fmi3SetDebugLogging":            {"CS": "x    x    x    x    x    x", "ME": "x    x    x    x    x    x"},
    "fmi3EnterInitializationMode":    {"CS": "x    -    -    -    -    -", "ME": "x    -    -    -    -    -"},
    "fmi3ExitInitializationMode":     {"CS": "-    x    -    -    -    -", "ME": "-    x    -    -    -    -"},
    "fmi3Terminate":                  {"CS": "-    -    x    -    -    -", "ME": "-    -    x    x    -    -"},
    "fmi3Reset": STATE,
    "fmi3GetFMUState": STATE, "fmi3FreeFMUState": STATE,
    "fmi3GetFloat32": READ, "fmi3GetFloat64": READ, **{f"fmi3Get{name}": READ for name in TYPES},
    "fmi3SetFloat32": FLOAT, "fmi3SetFloat64": FLOAT, **{f"fmi3Set{name}": WRITE for name in TYPES},
    "fmi3GetDirectionalDerivative":   {"CS": "-    x    x    -    x    x", "ME": "-    x    x    x    x    x"},
    "fmi3GetAdjointDerivative":       {"CS": "-    x    x    -    x    x", "ME": "-    x    x    x    x    x"},
    "fmi3EnterEventMode":             {"CS": "-    -    -    -    -    -", "ME": "-    -    -    x    -    -"},
    "fmi3UpdateDiscreteStates":       {"CS": "-    -    -    -    -    -", "ME": "-    -    x    -    -    -"},
    "fmi3EnterContinuousTimeMode":    {"CS": "-    -    -    -    -    -", "ME": "-    -    x    -    -    -"},
    "fmi3CompletedIntegratorStep":    {"CS": "-    -    -    -    -    -", "ME": "-    -    -    x    -    -"},
    "fmi3SetTime":                    {"CS": "-    -    -    -    -    -", "ME": "-    -    -    x    -    -"},
    "fmi3SetContinuousStates":        {"CS": "-    -    -    -    -    -", "ME": "-    -    -    x    -    -"},
    "fmi3GetContinuousStateDerivatives": {"CS": NEVER["CS"], "ME": "-    x    x    x    x    x"},
    "fmi3GetContinuousStates":        {"CS": "-    -    -    -    -    -", "ME": "-    x    x    x    x    x"},
    "fmi3GetNominalsOfContinuousStates": {"CS": NEVER["CS"], "ME": "-    x    x    x    x    x"},
    "fmi3GetEventIndicators":         {"CS": "-    -    -    -    -    -", "ME": "-    x    x    x    x    x"},
    "fmi3GetNumberOfContinuousStates": {"CS": NEVER["CS"], "ME": "x    -    x    -    -    -"},
    "fmi3GetNumberOfEventIndicators": {"CS": "-    -    -    -    -    -", "ME": "x    -    x    -    -    -"},
    "fmi3GetOutputDerivatives":       {"CS": "-    -    x    x    x    x", "ME": "-    -    -    -    -    -"},
    "fmi3DoStep":                     {"CS": "-    -    x    -    -    -", "ME": "-    -    -    -    -    -"},
    # Features that the FMU does not declare: structural parameters, clocks, event mode of co-simulation, model partitions.
    **{f"fmi3{name}": NEVER for name in (
        "EnterConfigurationMode", "ExitConfigurationMode", "EvaluateDiscreteStates", "EnterStepMode", "ActivateModelPartition",
        "GetClock", "SetClock", "GetIntervalDecimal", "GetIntervalFraction", "SetIntervalDecimal", "SetIntervalFraction",
        "GetShiftDecimal", "GetShiftFraction", "SetShiftDecimal", "SetShiftFraction")},
}  # fmt: skip
WITHOUT_TABLE = {
    "fmi3GetVersion", "fmi3FreeInstance", "fmi3InstantiateModelExchange", "fmi3InstantiateCoSimulation",
    "fmi3InstantiateScheduledExecution", "fmi3SetFMUState", "fmi3SerializedFMUStateSize", "fmi3SerializeFMUState",
    "fmi3DeserializeFMUState", "fmi3GetNumberOfVariableDependencies", "fmi3GetVariableDependencies",
}  # fmt: skip


def arguments(instance, function):
    """Valid arguments for each function, wherever the call is allowed."""
    vr = lambda name: (c_uint32 * 1)(*instance.vr(name))
    one, real, flag = c_size_t(1), lambda value=0.0: (c_double * 1)(value), lambda: byref(c_bool())
    states = lambda: (c_double * 4)(0.9, 0.2, 0.3, 0.4)
    none = (None, c_size_t(0), None, c_size_t(0))
    return {
        "fmi3SetDebugLogging": (c_bool(True), c_size_t(0), None),
        "fmi3EnterInitializationMode": (c_bool(False), c_double(0), c_double(0), c_bool(False), c_double(0)),
        "fmi3GetFloat64": (vr("theta"), one, real(), one),
        "fmi3SetFloat64": (vr("Fr"), one, real(0.5), one),
        "fmi3GetBinary": (None, c_size_t(0), None, None, c_size_t(0)),
        "fmi3SetBinary": (None, c_size_t(0), None, None, c_size_t(0)),
        "fmi3GetFMUState": (byref(c_void_p()),),
        "fmi3FreeFMUState": (byref(c_void_p()),),
        "fmi3GetDirectionalDerivative": (vr("der(omega)"), one, vr("theta"), one, real(1.0), one, real(), one),
        "fmi3GetAdjointDerivative": (vr("der(omega)"), one, vr("theta"), one, real(1.0), one, real(), one),
        "fmi3UpdateDiscreteStates": (flag(), flag(), flag(), flag(), flag(), byref(c_double())),
        "fmi3CompletedIntegratorStep": (c_bool(True), flag(), flag()),
        "fmi3SetTime": (c_double(0.1),),
        "fmi3SetContinuousStates": (states(), c_size_t(4)),
        "fmi3GetContinuousStateDerivatives": (states(), c_size_t(4)),
        "fmi3GetContinuousStates": (states(), c_size_t(4)),
        "fmi3GetNominalsOfContinuousStates": (states(), c_size_t(4)),
        "fmi3GetEventIndicators": (None, c_size_t(0)),
        "fmi3GetNumberOfContinuousStates": (byref(c_size_t()),),
        "fmi3GetNumberOfEventIndicators": (byref(c_size_t()),),
        "fmi3GetOutputDerivatives": (vr("theta"), one, (c_int32 * 1)(1), real(), one),
        "fmi3DoStep": (c_double(0.0), c_double(0.1), c_bool(True), flag(), flag(), flag(), byref(c_double())),
        "fmi3ActivateModelPartition": (c_uint32(0), c_double(0.0)),
    }.get(function, none if function[:7] in ("fmi3Get", "fmi3Set") else ())  # fmt: skip


def call(instance, function, *words):
    """Call the library directly and return the status."""
    raw = instance.fmu.dll[function]
    raw.restype, raw.argtypes = c_int, None
    return raw(c_void_p(instance.fmu.component), *words)


class Caller:
    """Callback that calls a function within a step, while the FMU requests inputs or offers values."""

    def __init__(self, function=None, requested=False):
        self.function, self.requested = function, requested
        self.instance, self.status, self.messages = None, None, None

    def __call__(self, environment, time, set_requested, *words):
        if self.function is None or self.status is not None or set_requested != self.requested:
            return
        before = len(self.instance.messages)
        self.status = call(self.instance, self.function, *arguments(self.instance, self.function))
        self.messages = self.instance.messages[before:]


def bring_to(instance, state):
    if state == "instantiated":
        return
    instance.fmu.enterInitializationMode()
    if state == "initialization":
        return
    instance.fmu.exitInitializationMode()
    if isinstance(instance.fmu, FMU3Model):
        instance.fmu.updateDiscreteStates()
    if state == "continuous":
        instance.fmu.enterContinuousTimeMode()
    if state == "terminated":
        instance.fmu.terminate()
    if state == "error":
        with pytest.raises(FMICallException):
            instance.fmu.setFloat64([9999], [0.0])


def status_in(function, state, kind):
    is_inside = state in ("intermediate", "request")
    caller = Caller(function if is_inside else None, state == "request")
    force = [variable.valueReference for variable in fmi3.description(NAME).modelVariables if variable.name == "Fr"]
    options = dict(intermediateUpdate=caller, requiredIntermediateVariables=force) if kind is FMU3Slave else {}
    instance = caller.instance = fmi3.Instance(NAME, kind=kind, **options)
    try:
        bring_to(instance, state)
        if is_inside:
            try:
                instance.step(0.5)
                stopped = False
            except FMICallException:
                stopped = True
            assert stopped == (caller.status != 0)
            return caller.status, caller.messages
        before = len(instance.messages)
        return call(instance, function, *arguments(instance, function)), instance.messages[before:]
    finally:
        instance.free()


@pytest.mark.parametrize("interface, kind, states", [("CS", FMU3Slave, CS_STATES), ("ME", FMU3Model, ME_STATES)])
@pytest.mark.parametrize("function", sorted(TABLE))
def test_life_cycle(function, interface, kind, states):
    for state, allowed in zip(states, TABLE[function][interface].split(), strict=True):
        status, messages = status_in(function, state, kind)
        if allowed == "x":
            assert status == 0, (state, messages)
        else:
            assert status == ERROR, state
            assert f"{function} is not allowed in the state" in messages[0][2]


@pytest.mark.parametrize("function", sorted(TABLE))
def test_calls_while_inputs_are_requested(function):
    status, messages = status_in(function, "request", FMU3Slave)
    assert status == (0 if function in REQUEST else ERROR), messages
    assert status == 0 or f"{function} is not allowed in the state" in messages[0][2]


def test_table_is_complete():
    assert set(TABLE) == FUNCTIONS - WITHOUT_TABLE


@pytest.mark.parametrize("kind", [FMU3Slave, FMU3Model])
def test_every_function_survives_null(kind):
    """A NULL instance, or NULL in place of an array, is an error and causes no crash."""
    instance = fmi3.Instance(NAME, kind=kind)
    for function in sorted(TABLE):
        raw = instance.fmu.dll[function]
        raw.restype, raw.argtypes = c_int, None
        assert raw(None, *arguments(instance, function)) == ERROR, function
    instance.fmu.dll["fmi3FreeInstance"](None)
    one = c_size_t(1)
    for words in (
        ("fmi3GetFloat64", None, one, None, one),
        ("fmi3SetFloat64", (c_uint32 * 1)(0), one, None, one),
        ("fmi3GetDirectionalDerivative", (c_uint32 * 1)(0), one, None, one, None, one, None, one),
        ("fmi3GetFMUState", None),
        ("fmi3SetFMUState", None),
        ("fmi3SerializeFMUState", None, None, c_size_t(0)),
        ("fmi3DeserializeFMUState", None, c_size_t(10), byref(c_void_p())),
        ("fmi3GetVariableDependencies", c_uint32(0), None, None, None, None, c_size_t(0)),
        ("fmi3GetNumberOfVariableDependencies", c_uint32(0), None),
        ("fmi3DoStep", c_double(0), c_double(0.1), c_bool(True), None, None, None, None),
        ("fmi3UpdateDiscreteStates", None, None, None, None, None, None),
    ):
        instance.initialize()
        assert call(instance, *words) == ERROR, words[0]
        instance.fmu.reset()
    raw = instance.fmu.dll["fmi3InstantiateScheduledExecution"]
    raw.restype, raw.argtypes = POINTER(c_int), None
    assert not raw(b"a", b"b", None, c_bool(False), c_bool(False), None, None, None, None, None)
    instance.free()
