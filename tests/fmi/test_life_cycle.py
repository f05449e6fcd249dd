"""Allowed calls by state: the tables of FMI 2.0.4, sections 3.2.3 and 4.2.4, typed again."""

import re
from ctypes import byref, c_double, c_int, c_size_t, c_void_p

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2EventInfo

import fmu
from fmu import DISCARD, ERROR

NAME = "ParticlePolar"

# Columns of the table for co-simulation, then for model exchange.
CS_STATES = ["instantiated", "initialization", "step complete", "step failed", "terminated", "error"]
ME_STATES = ["instantiated", "initialization", "event", "continuous", "terminated", "error"]

COMMON_CS = {
    #                               inst init comp fail term error
    "fmi2SetDebugLogging":          "x    x    x    x    x    x",
    "fmi2SetupExperiment":          "x    -    -    -    -    -",
    "fmi2EnterInitializationMode":  "x    -    -    -    -    -",
    "fmi2ExitInitializationMode":   "-    x    -    -    -    -",
    "fmi2Terminate":                "-    -    x    x    -    -",
    "fmi2Reset":                    "x    x    x    x    x    x",
    "fmi2GetReal":                  "-    x    x    x    x    x",
    "fmi2GetInteger":               "-    x    x    x    x    x",
    "fmi2GetBoolean":               "-    x    x    x    x    x",
    "fmi2GetString":                "-    x    x    x    x    x",
    "fmi2SetReal":                  "x    x    x    -    -    -",
    "fmi2SetInteger":               "x    x    x    -    -    -",
    "fmi2SetBoolean":               "x    x    x    -    -    -",
    "fmi2SetString":                "x    x    x    -    -    -",
    "fmi2GetFMUstate":              "x    x    x    x    x    x",
    "fmi2FreeFMUstate":             "x    x    x    x    x    x",
    "fmi2SerializedFMUstateSize":   "x    x    x    x    x    x",
    "fmi2GetDirectionalDerivative": "-    x    x    x    x    x",
    "fmi2SetRealInputDerivatives":  "x    x    x    -    -    -",
    "fmi2GetRealOutputDerivatives": "-    -    x    x    x    x",
    "fmi2DoStep":                   "-    -    x    -    -    -",
    "fmi2CancelStep":               "-    -    -    -    -    -",
    "fmi2GetStatus":                "-    -    x    x    x    -",
    "fmi2GetRealStatus":            "-    -    x    x    x    -",
    "fmi2GetIntegerStatus":         "-    -    x    x    x    -",
    "fmi2GetBooleanStatus":         "-    -    x    x    x    -",
    "fmi2GetStringStatus":          "-    -    x    x    x    -",
    "fmi2EnterEventMode":           "-    -    -    -    -    -",
    "fmi2NewDiscreteStates":        "-    -    -    -    -    -",
    "fmi2EnterContinuousTimeMode":  "-    -    -    -    -    -",
    "fmi2CompletedIntegratorStep":  "-    -    -    -    -    -",
    "fmi2SetTime":                  "-    -    -    -    -    -",
    "fmi2SetContinuousStates":      "-    -    -    -    -    -",
    "fmi2GetDerivatives":           "-    -    -    -    -    -",
    "fmi2GetEventIndicators":       "-    -    -    -    -    -",
    "fmi2GetContinuousStates":      "-    -    -    -    -    -",
    "fmi2GetNominalsOfContinuousStates": "-    -    -    -    -    -",
}  # fmt: skip
ME = {
    #                               inst init event cont term error
    "fmi2SetDebugLogging":          "x    x    x    x    x    x",
    "fmi2SetupExperiment":          "x    -    -    -    -    -",
    "fmi2EnterInitializationMode":  "x    -    -    -    -    -",
    "fmi2ExitInitializationMode":   "-    x    -    -    -    -",
    "fmi2Terminate":                "-    -    x    x    -    -",
    "fmi2Reset":                    "x    x    x    x    x    x",
    "fmi2GetReal":                  "-    x    x    x    x    x",
    "fmi2GetInteger":               "-    x    x    x    x    x",
    "fmi2GetBoolean":               "-    x    x    x    x    x",
    "fmi2GetString":                "-    x    x    x    x    x",
    "fmi2SetReal":                  "x    x    x    x    -    -",
    "fmi2SetInteger":               "x    x    x    -    -    -",
    "fmi2SetBoolean":               "x    x    x    -    -    -",
    "fmi2SetString":                "x    x    x    -    -    -",
    "fmi2GetFMUstate":              "x    x    x    x    x    x",
    "fmi2FreeFMUstate":             "x    x    x    x    x    x",
    "fmi2SerializedFMUstateSize":   "x    x    x    x    x    x",
    "fmi2GetDirectionalDerivative": "-    x    x    x    x    x",
    "fmi2EnterEventMode":           "-    -    x    x    -    -",
    "fmi2NewDiscreteStates":        "-    -    x    -    -    -",
    "fmi2EnterContinuousTimeMode":  "-    -    x    -    -    -",
    "fmi2CompletedIntegratorStep":  "-    -    -    x    -    -",
    "fmi2SetTime":                  "-    -    -    x    -    -",
    "fmi2SetContinuousStates":      "-    -    -    x    -    -",
    "fmi2GetDerivatives":           "-    x    x    x    x    x",
    "fmi2GetEventIndicators":       "-    x    x    x    x    x",
    "fmi2GetContinuousStates":      "-    x    x    x    x    x",
    "fmi2GetNominalsOfContinuousStates": "x    x    x    x    x    x",
    "fmi2SetRealInputDerivatives":  "-    -    -    -    -    -",
    "fmi2GetRealOutputDerivatives": "-    -    -    -    -    -",
    "fmi2DoStep":                   "-    -    -    -    -    -",
    "fmi2CancelStep":               "-    -    -    -    -    -",
    "fmi2GetStatus":                "-    -    -    -    -    -",
    "fmi2GetRealStatus":            "-    -    -    -    -    -",
    "fmi2GetIntegerStatus":         "-    -    -    -    -    -",
    "fmi2GetBooleanStatus":         "-    -    -    -    -    -",
    "fmi2GetStringStatus":          "-    -    -    -    -    -",
}  # fmt: skip


def arguments(instance, function):
    """Valid arguments for each function, wherever the call is allowed."""
    vr = lambda name: (c_int * 1)(*instance.vr(name))
    real = lambda value=0.0: (c_double * 1)(value)
    states = lambda: (c_double * 4)(0.9, 0.2, 0.3, 0.4)
    return {
        "fmi2SetDebugLogging": (1, 0, None),
        "fmi2SetupExperiment": (0, c_double(0), c_double(0), 0, c_double(0)),
        "fmi2GetReal": (vr("theta"), c_size_t(1), real()),
        "fmi2GetInteger": (None, c_size_t(0), None),
        "fmi2GetBoolean": (None, c_size_t(0), None),
        "fmi2GetString": (None, c_size_t(0), None),
        "fmi2SetReal": (vr("Fr"), c_size_t(1), real(0.5)),
        "fmi2SetInteger": (None, c_size_t(0), None),
        "fmi2SetBoolean": (None, c_size_t(0), None),
        "fmi2SetString": (None, c_size_t(0), None),
        "fmi2GetFMUstate": (byref(c_void_p()),),
        "fmi2FreeFMUstate": (byref(c_void_p()),),
        "fmi2SerializedFMUstateSize": (c_void_p(), byref(c_size_t())),
        "fmi2GetDirectionalDerivative": (vr("der(omega)"), c_size_t(1), vr("theta"), c_size_t(1), real(1.0), real()),
        "fmi2SetRealInputDerivatives": (vr("Fr"), c_size_t(1), (c_int * 1)(1), real(0.1)),
        "fmi2GetRealOutputDerivatives": (vr("theta"), c_size_t(1), (c_int * 1)(1), real()),
        "fmi2DoStep": (c_double(0.0), c_double(0.1), 1),
        "fmi2GetStatus": (0, byref(c_int())),
        "fmi2GetRealStatus": (2, byref(c_double())),
        "fmi2GetIntegerStatus": (0, byref(c_int())),
        "fmi2GetBooleanStatus": (3, byref(c_int())),
        "fmi2GetStringStatus": (0, byref(c_void_p())),
        "fmi2NewDiscreteStates": (byref(fmi2EventInfo()),),
        "fmi2CompletedIntegratorStep": (1, byref(c_int()), byref(c_int())),
        "fmi2SetTime": (c_double(0.1),),
        "fmi2SetContinuousStates": (states(), c_size_t(4)),
        "fmi2GetDerivatives": (states(), c_size_t(4)),
        "fmi2GetEventIndicators": (None, c_size_t(0)),
        "fmi2GetContinuousStates": (states(), c_size_t(4)),
        "fmi2GetNominalsOfContinuousStates": (states(), c_size_t(4)),
    }.get(function, ())


def call(instance, function, *words):
    """Call the library directly and return the status; FMPy binds only the functions of one interface."""
    raw = instance.fmu.dll[function]
    raw.restype = c_int
    return raw(c_void_p(instance.fmu.component), *words)


def bring_to(instance, state):
    order = ["instantiated", "initialization"]
    if state in order[:1]:
        return
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    if state == "initialization":
        return
    if state == "step failed":
        instance.set(omega=0.0)  # it falls into the centre
    instance.fmu.exitInitializationMode()
    if state == "step failed":
        with pytest.raises(FMICallException) as raised:
            instance.step(2.0)
        assert raised.value.status == DISCARD
    if isinstance(instance.fmu, FMU2Model):
        instance.fmu.newDiscreteStates()
    if state == "continuous":
        instance.fmu.enterContinuousTimeMode()
    if state == "terminated":
        instance.fmu.terminate()
    if state == "error":
        with pytest.raises(FMICallException):
            instance.fmu.setReal([9999], [0.0])


def check(instance, function, state, allowed):
    bring_to(instance, state)
    if function == "fmi2EnterInitializationMode" and state == "instantiated":
        instance.fmu.setupExperiment()  # required first
    before = len(instance.messages)
    status = call(instance, function, *arguments(instance, function))
    rejected = [text for _, _, text in instance.messages[before:] if "is not allowed in the state" in text]
    if allowed == "x":
        # Allowed calls succeed, except for unknown kinds of status and a NULL state.
        unknown = function in ("fmi2GetStatus", "fmi2GetIntegerStatus", "fmi2GetStringStatus")
        null = function == "fmi2SerializedFMUstateSize"
        assert not rejected
        assert status == (DISCARD if unknown else ERROR if null else 0)
    else:
        assert status == ERROR and rejected and function in rejected[0]


@pytest.mark.parametrize("function", COMMON_CS)
def test_co_simulation(function, open_fmu):
    for state, allowed in zip(CS_STATES, COMMON_CS[function].split(), strict=True):
        check(open_fmu(NAME), function, state, allowed)


@pytest.mark.parametrize("function", ME)
def test_model_exchange(function, open_fmu):
    for state, allowed in zip(ME_STATES, ME[function].split(), strict=True):
        check(open_fmu(NAME, kind=FMU2Model), function, state, allowed)


def test_tables_are_complete(open_fmu):
    without_state = {"fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate", "fmi2FreeInstance",
                     "fmi2SetFMUstate", "fmi2SerializeFMUstate", "fmi2DeSerializeFMUstate"}
    header = (fmu.ROOT / "include" / "fmi2.h").read_text()
    every = set(re.findall(r"FMI2_EXPORT .*?\b(fmi2\w+)\(", header))
    assert set(COMMON_CS) == set(ME) == every - without_state


@pytest.mark.parametrize("kind", [FMU2Slave, FMU2Model])
def test_every_function_survives_null(kind, open_fmu):
    """A NULL instance, or NULL in place of an array, is an error and causes no crash."""
    instance = open_fmu(NAME, kind=kind)
    for function in COMMON_CS:
        raw = instance.fmu.dll[function]
        raw.restype = c_int
        assert raw(None, *arguments(instance, function)) == ERROR
    instance.initialize()
    if kind is FMU2Model:
        instance.fmu.newDiscreteStates()
        instance.fmu.enterContinuousTimeMode()
    for function in ("fmi2GetReal", "fmi2SetReal", "fmi2GetInteger"):
        assert call(instance, function, None, c_size_t(1), None) == ERROR
        assert "is NULL" in instance.messages[-1][2]
        instance.reset().initialize()
    vr = (c_int * 1)(0)
    for words in (
        ("fmi2GetDirectionalDerivative", vr, c_size_t(1), None, c_size_t(1), None, None),
        ("fmi2GetFMUstate", None),
        ("fmi2SetFMUstate", None),
        ("fmi2SerializeFMUstate", None, None, c_size_t(0)),
        ("fmi2DeSerializeFMUstate", None, c_size_t(10), byref(c_void_p())),
    ):
        assert call(instance, *words) == ERROR, words[0]
        instance.reset().initialize()
    assert call(instance, "fmi2FreeFMUstate", None) == 0
