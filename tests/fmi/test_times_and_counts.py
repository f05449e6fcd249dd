"""Times in event mode, modes that end with events pending, and discrete counters (FMI 2.0.4, section 3.2; FMI 3.0.2, section 2.4.7)."""

from ctypes import c_double

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model

import fmi3
import fmu
from fmu import ERROR

TIMER = """
<system name="Timer">
  <parameter name="t0" start="0.5" unit="s"/>
  <coordinate name="x" velocity="v"/>
  <mode name="on"/>
  <particle mass="1" x="x"/>
  <event when="time > t0"><set mode="on">1</set></event>
</system>
"""


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("times-and-counts", {"Timer": TIMER}, versions=[2])


def test_time_is_set_in_continuous_time_mode(open_fmu):
    """In event mode only FMUs without continuous-time mode accept a time (FMI 2.0.4, section 3.2.3)."""
    ball = open_fmu("BouncingBall", kind=FMU2Model).initialize()
    with ball.fails(ERROR, "fmi2SetTime is not allowed in the state 'event mode'"):
        ball.fmu.setTime(0.1)


def test_events_that_are_pending_as_continuous_time_begins(open_fmu):
    """Pending events are errors, whether a parameter set after the last update causes them, also in the first event mode, or the time is due."""
    timer = fmu.Instance("Timer", kind=FMU2Model).initialize()
    timer.set(t0=-1.0)
    with timer.fails(ERROR, "expected an update of the discrete states before it"):
        timer.fmu.enterContinuousTimeMode()
    timer.reset().initialize()
    timer.fmu.newDiscreteStates()
    timer.set(t0=-1.0)
    state = timer.fmu.getFMUstate()
    with timer.fails(ERROR, "an event is due"):
        timer.fmu.enterContinuousTimeMode()
    timer.fmu.setFMUstate(state)
    with timer.fails(ERROR, "an event is due"):
        timer.fmu.enterContinuousTimeMode()
    timer.free_state(state)
    timer.reset().initialize()
    timer.fmu.newDiscreteStates()
    timer.fmu.enterContinuousTimeMode()
    timer.fmu.setTime(0.5)
    timer.fmu.enterEventMode()
    with timer.fails(ERROR, "expected an update of the discrete states before it"):
        timer.fmu.enterContinuousTimeMode()
    timer.free()


def counts(instance, *names):
    return list(instance.fmu.getInt64(instance.vr(*names)))


@pytest.mark.parametrize("early", [True, False])
def test_counts_change_in_event_mode_alone(early):
    names = ["solverSteps", "derivativeEvaluations", "events"]
    ball = fmi3.Instance("BouncingBall", eventModeUsed=True, earlyReturnAllowed=early).initialize()
    ball.fmu.updateDiscreteStates()
    ball.fmu.enterStepMode()
    before = counts(ball, *names)
    for _ in range(3):
        needed, *_ = ball.step(1.0)
        assert counts(ball, *names) == before
        ball.fmu.enterEventMode()
        assert counts(ball, *names) == before
        ball.fmu.updateDiscreteStates()
        after = counts(ball, *names)
        assert after[0] > before[0] and after[2] >= before[2] + needed
        ball.fmu.enterStepMode()
        before = after


def test_events_without_early_return():
    """
    An importer that uses event mode without early return sees an event at the end of its step (FMI 3.0.2, section 4.2.1). The ball, released at 1 m,
    hits the ground at sqrt(2/g) = 0.4515 s. Event mode then has nothing more to do.
    """
    ball = fmi3.Instance("BouncingBall", eventModeUsed=True, earlyReturnAllowed=False).initialize({"h": 1.0, "v": 0.0})
    assert ball.get("g") == 9.81
    ball.fmu.updateDiscreteStates()
    ball.fmu.enterStepMode()
    signals = []
    for k in range(1, 7):
        needed, _, early, time = ball.step(0.1)
        assert not early and time == pytest.approx(0.1 * k, rel=1e-14)
        signals.append(needed)
        if needed:
            before = list(ball.get("h", "v"))
            ball.fmu.enterEventMode()
            assert not any(ball.fmu.updateDiscreteStates())
            assert list(ball.get("h", "v")) == before and before[1] > 0
            ball.fmu.enterStepMode()
    assert signals == [False, False, False, False, True, False]


def test_events_at_the_end_of_a_step():
    """An event that is due at the end of a step is signalled there, and left to event mode."""
    servo = fmi3.Instance("DigitalServo", eventModeUsed=True, earlyReturnAllowed=False).initialize()
    for _ in range(3):
        following = servo.fmu.updateDiscreteStates()[-1]
        servo.fmu.enterStepMode()
        before = servo.get("u")
        assert not servo.step((following - servo.time) / 2)[0]
        needed, _, early, time = servo.step(following - servo.time)
        assert needed and not early and time == following
        assert list(servo.get("u")) == list(before)
        servo.fmu.enterEventMode()


def test_step_mode_without_an_update():
    """Step mode begins after an update of the discrete states if an event is due, as continuous-time mode does (FMI 3.0.2, section 2.3.5)."""
    fmi3.Instance("BouncingBall", eventModeUsed=True).initialize().fmu.enterStepMode()
    servo = fmi3.Instance("DigitalServo", eventModeUsed=True).initialize()
    with pytest.raises(FMICallException):
        servo.fmu.enterStepMode()
    assert "an event is due; expected an update of the discrete states before it" in servo.messages[-1][2]


def test_counts_without_event_mode_are_present_ones():
    ball = fmi3.Instance("BouncingBall").initialize()
    ball.step(1.0)
    assert counts(ball, "events")[0] > 0 and counts(ball, "solverSteps")[0] > 0


def test_calls_that_may_not_be_discarded(open_fmu):
    """
    fmi2GetReal and fmi2GetDerivatives may return Discard in model exchange, directional derivatives never (FMI 2.0.4, section 2.1.3); an
    error ends the simulation.
    """
    particle = open_fmu("ParticleSpherical", kind=FMU2Model).initialize()
    particle.fmu.newDiscreteStates()
    particle.fmu.enterContinuousTimeMode()
    particle.fmu.setContinuousStates((c_double * 6)(1.0, 0.0, 0.0, 0.0, 0.0, 0.0), 6)
    with particle.fails(fmu.DISCARD, "singular"):
        particle.fmu.getDerivatives((c_double * 6)(), 6)
    with pytest.raises(FMICallException) as raised:
        particle.get("der(omegaTheta)")
    assert raised.value.status == fmu.DISCARD
    with pytest.raises(FMICallException) as raised:
        particle.fmu.getDirectionalDerivative(particle.vr("der(omegaTheta)"), particle.vr("phi"), [1.0])
    assert raised.value.status == ERROR
    with particle.fails(ERROR, "not allowed in the state 'error'"):
        particle.fmu.setTime(0.5)
