"""Rules of FMI 2.0 that exporters often violate, and the log (section 2.1.5)."""

import ctypes
import math
import re
import subprocess
import sys
from ctypes import byref

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave

import fmu
from closed_forms import pendulum_angle
from fmu import DISCARD, ERROR, OK, WARNING

CATEGORIES = ["logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal", "logAll"]


def test_functions_of_the_other_interface_return_an_error(open_fmu):
    """Both interfaces export all functions; those of the other interface return an error."""
    slave = open_fmu("SimplePendulum").initialize()
    slave.fmu.dll.fmi2EnterContinuousTimeMode.restype = ctypes.c_int
    with_model = slave.fmu.dll.fmi2EnterContinuousTimeMode(ctypes.c_void_p(slave.fmu.component))
    assert with_model == ERROR


@pytest.mark.parametrize("name", fmu.all_names())
def test_reading_in_initialization_mode(name, open_fmu):
    """
    Outputs and InitialUnknowns are readable in initialization mode. So are all other variables, without a message, since libcosim reads
    them.
    """
    instance = open_fmu(name)
    with instance.fails(ERROR, "not allowed in the state 'instantiated'"):
        instance.fmu.getReal([0])
    instance.reset()
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    count = len(instance.messages)
    reals = [variable for variable in instance.description.modelVariables if variable.type == "Real"]
    values = dict(zip((variable.name for variable in reals), instance.get(*(variable.name for variable in reals))))
    for variable in reals:
        if variable.causality == "parameter":
            assert values[variable.name] == float(variable.start)
    if "solverSteps" in instance.references:
        assert instance.fmu.getInteger(instance.vr("solverSteps")) == [0]
    assert instance.messages[count:] == []


def test_setting_by_state(open_fmu):
    """A variable is settable in the states that its causality and variability allow."""
    name = "DampedPendulum"
    instance = open_fmu(name)
    allowed = {"tau": "isc", "theta": "is", "omega": "is", "b": "isc", "der(omega)": "", "kineticEnergy": "", "bob.x": ""}
    for variable, states in allowed.items():
        for state in "isc":  # instantiated, initialization, step complete
            instance.reset()
            if state != "i":
                instance.fmu.setupExperiment()
                instance.fmu.enterInitializationMode()
            if state == "c":
                instance.fmu.exitInitializationMode()
            if state in states:
                instance.set({variable: 0.5})
            else:
                with instance.fails(ERROR, f"'{re.escape(variable)}' cannot be set"):
                    instance.set({variable: 0.5})


def test_parameters_of_model_exchange_wait_for_an_event(open_fmu):
    instance = open_fmu("DampedPendulum", kind=FMU2Model).initialize()
    instance.set(b=0.7)
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    instance.set(tau=0.1)
    with instance.fails(ERROR, "'b' cannot be set"):
        instance.set(b=0.5)


def test_setup_is_required(open_fmu):
    """fmi2EnterInitializationMode requires fmi2SetupExperiment."""
    instance = open_fmu("SimplePendulum")
    with instance.fails(ERROR, "fmi2SetupExperiment"):
        instance.fmu.enterInitializationMode()


@pytest.mark.parametrize(
    "words, message",
    [
        (dict(startTime=math.nan), "startTime is nan"),
        (dict(stopTime=-1.0), "stopTime is -1"),
        (dict(stopTime=math.inf), "stopTime is inf"),
        (dict(tolerance=0.0), "tolerance is 0"),
        (dict(tolerance=-1e-6), "tolerance is -1e-06"),
        (dict(tolerance=math.nan), "tolerance is nan"),
        (dict(tolerance=2.0), "tolerance is 2"),
    ],
)
def test_bad_experiments(words, message, open_fmu):
    instance = open_fmu("SimplePendulum")
    with instance.fails(ERROR, message):
        instance.fmu.setupExperiment(**words)


def test_undefined_values_are_not_looked_at(open_fmu):
    instance = open_fmu("SimplePendulum")
    instance.fmu.fmi2SetupExperiment(instance.fmu.component, 0, math.nan, 2.0, 0, math.nan)
    instance.fmu.enterInitializationMode()
    instance.fmu.exitInitializationMode()
    instance.fmu.doStep(2.0, 0.1)
    assert instance.fmu.getRealStatus(2) == 2.1


def test_steps_end_where_they_say(name, open_fmu):
    """Steps end at the time that the caller gives, without drift or rounding to a grid."""
    instance = open_fmu(name).initialize(start_time=0.25)
    with instance.fails(ERROR, "currentCommunicationPoint is 0; expected 0.25"):
        instance.fmu.doStep(0.0, 0.1)
    instance.reset().initialize(start_time=0.25)
    time = 0.25
    for i in range(1, 200):
        size = 0.0015 * (1 + i % 3)
        instance.fmu.doStep(time, size)
        time += size
        assert instance.fmu.getRealStatus(2) == time
        if i == 100:
            time = math.nextafter(time, 10)  # a caller with other rounding
    with instance.fails(ERROR, "currentCommunicationPoint"):
        instance.fmu.doStep(time + 1e-5, 0.1)


def test_step_that_is_too_short_for_the_time(name, open_fmu):
    instance = open_fmu(name).initialize(start_time=1e9)
    with instance.fails(ERROR, "step 1e-09 does not advance the time 1e\\+09"):
        instance.fmu.doStep(1e9, 1e-9)


def test_states_are_those_of_the_end(name, open_fmu):
    """Many uneven steps reach the state of one long step, not that before the last step."""
    states, sizes = fmu.states_of(name), [0.003 * (1 + i % 3) for i in range(60)]
    start = {"BristleFriction": {"v": 1.0}, "DigitalServo": {"kp": 0.3}}.get(name, {})  # these would stick at first, or come to rest
    many, one, early = (open_fmu(name).initialize(start, tolerance=1e-8) for _ in range(3))
    for size in sizes:
        many.step(size)
    one.step(sum(sizes))
    early.step(sum(sizes[:-1]))
    if not states:
        return
    apart = lambda other: max(abs(a - b) for a, b in zip(many.fmu.getReal(many.vr(*states)), other.fmu.getReal(other.vr(*states))))
    assert apart(one) < 1e-6 < 1e-4 < apart(early)


@pytest.mark.parametrize("name", ["SimplePendulum", "SimplePendulumLinear"])
def test_every_step_end_is_on_the_closed_form(name, open_fmu):
    instance = open_fmu(name).initialize(dict(theta=1.0, omega=0.0), tolerance=1e-10, start_time=0.25)
    rate = math.sqrt(9.81)
    for i in range(40):
        instance.step(0.01 * (1 + i % 4))
        past = instance.time - 0.25
        angle = math.cos(rate * past) if name.endswith("Linear") else pendulum_angle(1.0, rate, past)
        assert instance.get("theta") == pytest.approx(angle, abs=1e-8)


def test_the_tolerance_of_the_communication_point(open_fmu):
    """The communication point may differ by rounding, not by a fraction of a step."""
    instance = open_fmu("SimplePendulum")
    for share, message in ((0.5, "expected 0.25"), (-0.5, "expected 0.25"), (1e-5, "expected 0.25")):
        instance.reset().initialize(start_time=0.25)
        with instance.fails(ERROR, message):
            instance.fmu.doStep(0.25 + share * 0.1, 0.1)
    instance.reset().initialize(start_time=0.25)
    instance.fmu.doStep(0.25 + 1e-8, 0.1)


@pytest.mark.parametrize("name", ["SimplePendulumLinear", "StateFeedback"])
@pytest.mark.parametrize("size", [0.1, 0.01, 0.001])
@pytest.mark.parametrize("count", [10, 1000, 10**5, 10**6, 10**7])
def test_a_sum_of_steps_ends_at_the_stop_time(count, size, name, open_fmu):
    """Rounding in t += h accumulates, so that the last step may miss the stop time by far more than one rounding error; it is accepted."""
    start = 3.0
    times = np.add.accumulate(np.concatenate([[start], np.full(count, size)]))
    stop = start + count * size
    instance = open_fmu(name).initialize(start_time=start, stop_time=stop)
    before = float(times[-2])
    instance.fmu.doStep(start, before - start)
    instance.time = instance.fmu.getRealStatus(2)
    instance.fmu.doStep(before, size)
    assert instance.fmu.getRealStatus(2) == min(before + size, stop)
    for excess in (0.6, 1.0):
        instance.reset().initialize(start_time=start, stop_time=stop)
        instance.fmu.doStep(start, before - start)
        with instance.fails(ERROR, "past stopTime"):
            instance.fmu.doStep(before, stop - before + excess * size)


def test_the_last_step_ends_at_the_stop_time(open_fmu):
    """The state is that at the stop time even if the sum of the steps leads past it."""
    size, count = 0.01, 10**6
    before = float(np.add.accumulate(np.full(count - 1, size))[-1])
    stop = before + 0.9 * size
    instance = open_fmu("SimplePendulumLinear").initialize(dict(theta=0.3), stop_time=stop)
    instance.fmu.doStep(0.0, before)
    theta, omega = instance.get("theta", "omega")
    instance.fmu.doStep(before, (stop - before) * (1 + 1e-7))
    w = math.sqrt(9.81 / fmu.start_values("SimplePendulumLinear")["l"])
    phase = w * (stop - before)
    assert instance.fmu.getRealStatus(2) == stop
    assert instance.get("theta") == pytest.approx(theta * math.cos(phase) + omega / w * math.sin(phase), abs=1e-12)


def test_steps_past_the_stop_time(name, open_fmu):
    """A step past the stop time is an error; without a stop time there is no limit."""
    instance = open_fmu(name).initialize(stop_time=0.3)
    for i in range(3):
        instance.fmu.doStep(i * 0.1, 0.1)  # 0.1 * 3 is not 0.3 in binary
    with instance.fails(ERROR, "past stopTime 0.3"):
        instance.fmu.doStep(0.3, 0.1)
    instance.reset().initialize()
    instance.step(0.5)


def test_discard_reports_the_last_time(open_fmu):
    """fmi2GetRealStatus returns the time reached by a discarded step, and the state belongs to that time."""
    instance = open_fmu("ParticlePolar").initialize(dict(omega=0))
    instance.step(1.0)
    with instance.fails(DISCARD, "stopped at time 1.1"):
        instance.step(1.0)
    reached = instance.fmu.getRealStatus(2)
    assert 1.0 < reached < 1.12
    assert instance.fmu.getBooleanStatus(3) is False
    assert instance.get("r") < 0.1
    with instance.fails(ERROR, "not allowed in the state 'step failed'"):
        instance.step(0.1)


def test_after_an_error(open_fmu):
    """After an error neither steps nor fmi2Terminate are allowed; a reset or a saved state recovers."""
    instance = open_fmu("SimplePendulum").initialize()
    state = instance.fmu.getFMUstate()
    for recover in (lambda: instance.fmu.setFMUstate(state), lambda: instance.reset().initialize()):
        with instance.fails(ERROR, "unknown"):
            instance.fmu.getReal([9999])
        for call in (lambda: instance.fmu.doStep(0.0, 0.1), instance.fmu.terminate):
            with instance.fails(ERROR, "not allowed in the state 'error'"):
                call()
        assert math.isfinite(instance.get("theta"))
        recover()
        instance.time = 0.0
        instance.step(0.1)
    instance.free_state(state)
    instance.fmu.fmi2FreeInstance(None)


def test_guid_must_match(capsys):
    """A failed instantiation logs the cause, even with logging off."""
    messages = []
    callbacks = fmu.callbacks_of(lambda *words: messages.append(words[4].decode()))
    with pytest.raises(Exception, match="Failed to instantiate"):
        fmu.Instance("SimplePendulum", guid="{other}", callbacks=callbacks, logging=False)
    expected = fmu.description("SimplePendulum").guid
    assert messages == [f"fmi2Instantiate: the GUID is '{{other}}'; expected '{expected}', that of this binary"]
    with pytest.raises(Exception, match="Failed to instantiate"):
        fmu.Instance("SimplePendulum", instance_name="", callbacks=callbacks, logging=False)
    assert "name" in messages[-1]


def test_callbacks_are_copied(open_fmu):
    """The structure of callbacks and the strings are valid during the call only, so that the FMU must copy them."""
    instance = open_fmu("DampedPendulum")
    ctypes.memset(byref(instance.callbacks), 0xAB, ctypes.sizeof(instance.callbacks))
    instance.initialize()
    instance.step(0.1)
    with pytest.raises(FMICallException):
        instance.fmu.getReal([9999])
    assert "9999" in instance.messages[-1][2]


def test_versions(open_fmu):
    instance = open_fmu("SimplePendulum")
    assert instance.fmu.getTypesPlatform() == "default" and instance.fmu.getVersion() == "2.0"


def test_resources_may_come_in_any_form(open_fmu):
    """FMUs accept any resource location, since none needs resources."""
    instance = open_fmu("SimplePendulum")
    instantiate = instance.fmu.dll.fmi2Instantiate
    instantiate.restype = ctypes.c_void_p
    for location in (None, b"", b"file:/tmp/x", b"file:///tmp/x", b"http://nowhere"):
        component = instantiate(b"i", 1, instance.description.guid.encode(), location, byref(instance.callbacks), 0, 0)
        assert component
        instance.fmu.fmi2FreeInstance(component)


def test_velocities_are_read_where_there_are_no_accelerations(open_fmu):
    """
    An explicit method of an importer may reach a state without accelerations: der(theta) is then the finite omega, and the log has one
    line.
    """
    name, speed = "ParticleSpherical", 3.0
    instance = open_fmu(name, kind=FMU2Model).initialize()
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    states = fmu.states_of(name)
    values = dict.fromkeys(states, 1.0) | {states[0]: 0.0, states[3]: speed}  # at the centre, where accelerations are undefined
    instance.fmu.setContinuousStates((ctypes.c_double * 6)(*values.values()), 6)
    count = len(instance.messages)
    assert instance.get(f"der({states[0]})") == speed
    for _ in range(3):
        for state in states[3:]:
            with pytest.raises(FMICallException) as raised:
                instance.get(f"der({state})")
            assert raised.value.status == DISCARD
        with pytest.raises(FMICallException):
            instance.fmu.getDerivatives((ctypes.c_double * 6)(), 6)
    assert [m[:2] for m in instance.messages[count:]] == [(DISCARD, "logStatusDiscard")]
    assert "mass matrix is singular" in instance.messages[-1][2]
    instance.fmu.setTime(0.5)
    with instance.fails(DISCARD, "time 0.5: the mass matrix is singular"):
        instance.get(f"der({states[3]})")


# --- The log ---


def provoke(instance):
    """Provoke messages of every category."""
    instance.initialize(dict(omega=0))
    with pytest.raises(FMICallException):
        instance.step(5.0)  # discarded
    with pytest.raises(FMICallException):
        instance.fmu.getReal([9999])  # an error
    instance.reset()
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    instance.fmu.setRealInputDerivatives(instance.vr("Fr"), [4], [1.0])  # a warning: the FMU ignores it
    instance.reset()


def test_errors_are_logged_without_debug_logging(open_fmu):
    """Without loggingOn only the debug messages about events are omitted."""
    everything = open_fmu("ParticlePolar")
    provoke(everything)
    instance = open_fmu("ParticlePolar", logging=False)
    provoke(instance)
    assert instance.messages == [entry for entry in everything.messages if entry[1] != "logEvents"]
    assert {entry[0] for entry in instance.messages} == {WARNING, DISCARD, ERROR}
    instance.fmu.setDebugLogging(True, [])
    provoke(instance)
    instance.fmu.setDebugLogging(False, [])
    before = len(instance.messages)
    provoke(instance)
    assert {entry[0] for entry in instance.messages[before:]} == {WARNING, DISCARD, ERROR}
    instance.fmu.setDebugLogging(False, CATEGORIES)
    before = len(instance.messages)
    provoke(instance)
    assert len(instance.messages) == before


def test_a_simulation_that_cannot_start_logs_the_cause():
    """FMPy's short form leaves debug logging off and prints the log."""
    call = f"import fmpy; fmpy.simulate_fmu({str(fmu.archive('SimplePendulum'))!r}, start_values={{'l': 0}})"
    result = subprocess.run([sys.executable, "-c", call], capture_output=True, text=True)
    assert result.returncode != 0 and "mass matrix is singular" in result.stdout


@pytest.mark.parametrize("category", CATEGORIES)
def test_only_what_is_enabled(category, open_fmu):
    """Logging can be enabled for one category, and for all by logAll."""
    everything = open_fmu("ParticlePolar")
    provoke(everything)
    found = {entry[1] for entry in everything.messages}
    assert found == {"logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError"}
    instance = open_fmu("ParticlePolar", logging=False)
    instance.fmu.setDebugLogging(True, [category])
    provoke(instance)
    expected = [entry for entry in everything.messages if category in (entry[1], "logAll")]
    if category in ("logEvents", "logAll"):
        expected = expected[1:]  # without the message about instantiation, which comes first
    assert instance.messages == expected
    instance.fmu.setDebugLogging(False, [category])
    before = len(instance.messages)
    provoke(instance)
    assert len(instance.messages) == before


def test_unknown_category(open_fmu):
    instance = open_fmu("SimplePendulum")
    with instance.fails(ERROR, "no log category 'logNothing'"):
        instance.fmu.setDebugLogging(True, ["logNothing"])


def test_messages_are_formats_and_lines(open_fmu):
    """Messages end without a newline, have '%' and '#' doubled, and a category that fits the status."""
    instance = open_fmu("ParticlePolar")
    provoke(instance)
    for status, category, text in instance.messages:
        assert not text.endswith("\n") and text
        assert "%" not in text.replace("%%", "")
        expected = {OK: "logEvents", WARNING: "logStatusWarning", DISCARD: "logStatusDiscard", ERROR: "logStatusError"}
        assert category == expected[status]


def test_escapes_in_messages():
    messages = []
    callbacks = fmu.callbacks_of(lambda *words: messages.append(words[4].decode()))
    with pytest.raises(Exception, match="Failed to instantiate"):
        fmu.Instance("SimplePendulum", guid="100%s #r1#", callbacks=callbacks)
    # FMPy's proxy prints the format, which turns '%%' into '%'; '##' remains for the importer to decode.
    assert "'100%s ##r1##'" in messages[0] or "'100%%s ##r1##'" in messages[0]


def test_null_logger():
    """A NULL logger causes no crash, whatever fails."""
    callbacks = fmu.callbacks_of(None)
    instance = fmu.Instance("ParticlePolar", callbacks=callbacks)
    provoke(instance)
    instance.free()
    with pytest.raises(Exception, match="Failed to instantiate"):
        fmu.Instance("ParticlePolar", guid="{other}", callbacks=callbacks)


# --- Memory ---


def test_memory_of_the_caller(name):
    """All memory comes from the caller's functions and is freed (for failing allocations see tests/c/out_of_memory.c)."""
    memory = fmu.Memory()
    instance = fmu.Instance(name, callbacks=fmu.callbacks_of(None, memory.allocate, memory.release)).initialize()
    instance.step(0.1)
    instance.free_state(instance.fmu.getFMUstate())
    instance.free()
    assert memory.alive == set() and memory.count > 3


@pytest.mark.parametrize("name", ["ParticleCartesian", "SimplePendulum", "ElasticPendulum"])
def test_steps_allocate_nothing(name):
    result = subprocess.run([fmu.BUILD / "bin" / f"overhead_{name}", "500"], capture_output=True, text=True)
    assert result.returncode == 0 and ", 0 allocations in 3500 steps" in result.stdout


@pytest.mark.parametrize("kind", [FMU2Slave, FMU2Model])
def test_names_of_instances_are_passed_on(kind):
    """The logger receives the instance's name and the environment."""
    seen = []
    callbacks = fmu.callbacks_of(lambda environment, name, *rest: seen.append((environment, name)), environment=1234)
    instance = fmu.Instance("SimplePendulum", kind=kind, callbacks=callbacks, instance_name="pendulum 7").initialize()
    instance.free()
    assert set(seen) == {(1234, b"pendulum 7")}
