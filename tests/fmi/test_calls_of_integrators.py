"""Calls that an integrator may make: nonfinite trial states, times before the start, event mode while events are due."""

from ctypes import c_double

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

import fmi3
import fmu
from fmu import DISCARD, ERROR


def array(*values):
    return (c_double * len(values))(*values), len(values)


def falling_ball(open_fmu):
    """BouncingBall in continuous-time mode."""
    ball = open_fmu("BouncingBall", kind=FMU2Model).initialize()
    ball.fmu.newDiscreteStates()
    ball.fmu.enterContinuousTimeMode()
    return ball


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_states_that_are_not_finite(value, open_fmu):
    """A nonfinite trial state is discarded, so that the integrator can try a shorter step (FMI 2.0.4, section 2.1.3); nothing changes."""
    ball = falling_ball(open_fmu)
    before = ball.get("h", "v")
    with ball.fails(DISCARD, "expected a finite number"):
        ball.fmu.setContinuousStates(*array(1.0, value))
    with ball.fails(DISCARD, "'h'.*expected a finite number"):
        ball.set(h=value)
    assert ball.get("h", "v") == before
    ball.fmu.setContinuousStates(*array(0.5, 0.0))
    assert ball.get("h") == 0.5


def test_a_time_before_the_start(open_fmu):
    ball = open_fmu("BouncingBall", kind=FMU2Model).initialize(start_time=2.0)
    ball.fmu.newDiscreteStates()
    ball.fmu.enterContinuousTimeMode()
    ball.fmu.setTime(2.0)
    with ball.fails(ERROR, "the time is 1.5; expected none before startTime 2"):
        ball.fmu.setTime(1.5)


def test_a_time_before_the_last_step(open_fmu):
    """Within the last step values may be read; not beyond the second last call of fmi2CompletedIntegratorStep (FMI 2.0.4, section 3.2.1)."""
    ball = falling_ball(open_fmu)
    for time in (0.1, 0.2):
        ball.fmu.setTime(time)
        ball.fmu.completedIntegratorStep()
    ball.fmu.setTime(0.15)
    ball.fmu.setTime(0.1)
    state = ball.fmu.getFMUstate()
    with ball.fails(ERROR, "the time is 0.05; expected none before 0.1, that of the last event or of the second last completed step; restore a saved state"):
        ball.fmu.setTime(0.05)
    ball.fmu.setFMUstate(state)
    ball.fmu.setTime(0.3)
    ball.fmu.enterEventMode()
    ball.fmu.newDiscreteStates()
    ball.fmu.enterContinuousTimeMode()
    ball.fmu.setTime(0.3)
    with ball.fails(ERROR, "the time is 0.25; expected none before 0.3"):
        ball.fmu.setTime(0.25)
    ball.fmu.setFMUstate(state)  # which goes back
    ball.fmu.setTime(0.12)
    ball.free_state(state)


@pytest.mark.parametrize("kind", [FMU2Model, FMU3Model])
def test_times_past_the_stop_time(kind):
    """
    Nothing is computed past stopTime (FMI 2.0.4, section 2.1.6; FMI 3.0.2, section 2.3.2): no step is completed and no event handled there. An
    integrator such as CVode may still evaluate beyond it, and interpolate back.
    """
    module = fmu if kind is FMU2Model else fmi3
    opened = lambda: module.Instance("BouncingBall", kind=kind)

    def falling(instance):
        if kind is FMU2Model:
            instance.initialize(stop_time=1.0).fmu.newDiscreteStates()
        else:
            instance.initialize(stopTime=1.0).fmu.updateDiscreteStates()
        instance.fmu.enterContinuousTimeMode()
        return instance

    for call in ("completedIntegratorStep", "enterEventMode"):
        ball = falling(opened())
        ball.fmu.setTime(1.5)
        ball.get("der(v)")
        ball.fmu.setTime(1.0 + 1e-15)
        ball.fmu.completedIntegratorStep()
        ball.fmu.setTime(1.0 + 1e-6)
        with pytest.raises(FMICallException) as raised:
            getattr(ball.fmu, call)()
        assert raised.value.status == ERROR
        assert "the time is 1.000001; expected none past stopTime 1" in ball.messages[-1][2]
        ball.free()


def test_a_due_event_cannot_be_skipped(open_fmu):
    """Event mode cannot end without an update of the discrete states if an event is due. If none is due, it can, as some importers do at the start."""
    missing = "an event is due; expected an update of the discrete states before it"
    servo = open_fmu("DigitalServo", kind=FMU2Model).initialize()  # its first sample is due
    state = servo.fmu.getFMUstate()
    with servo.fails(ERROR, missing):
        servo.fmu.enterContinuousTimeMode()
    servo.fmu.setFMUstate(state)
    with servo.fails(ERROR, missing):
        servo.fmu.enterContinuousTimeMode()
    servo.free_state(state)
    ball = open_fmu("BouncingBall", kind=FMU2Model).initialize()
    ball.fmu.enterContinuousTimeMode()
    ball.fmu.setContinuousStates(*array(-1e-6, -1.0))
    ball.fmu.enterEventMode()
    with ball.fails(ERROR, missing):
        ball.fmu.enterContinuousTimeMode()
    ball.reset().initialize()
    ball.fmu.newDiscreteStates()
    ball.fmu.enterContinuousTimeMode()
    ball.fmu.setContinuousStates(*array(-1e-6, -1.0))
    ball.fmu.enterEventMode()
    ball.fmu.newDiscreteStates()
    ball.fmu.enterContinuousTimeMode()
    assert ball.get("v") > 0.0


@pytest.mark.parametrize("order", [4, 20, 100])
def test_input_derivatives_of_high_order(order, open_fmu):
    """Inputs are at most cubic over a step. Higher derivatives give a warning, and the motion without them."""
    ends = []
    for orders in ([1], [1, order]):
        particle = open_fmu("ParticleCartesian").initialize({"x": 0.0, "vx": 0.0})
        particle.fmu.setRealInputDerivatives(particle.vr("Fx") * len(orders), orders, [6.0, 1.0][: len(orders)])
        particle.step(1.0)
        ends.append(particle.get("x", "vx"))
    assert any(f"the derivative {order} of 'Fx' is ignored" in text for _, _, text in particle.messages)
    assert ends[0] == ends[1] != [0.0, 0.0]


def integrate(name, end, tolerance):
    """Integrate by CVode (BDF), step by step; return the numbers of steps and events, and the states at the end."""
    from ctypes import byref

    from fmpy.sundials import CVode, CVodeSolver, realtype

    normal, one_step = 1, 2
    instance = fmu.Instance(name, kind=FMU2Model).initialize(tolerance=tolerance)
    model, size = instance.fmu, instance.description.numberOfContinuousStates
    model.newDiscreteStates()
    model.enterContinuousTimeMode()

    class NoInput:
        def apply(self, *arguments, **words):
            pass

    solver = CVodeSolver(nx=size, nz=0, get_x=model.getContinuousStates, set_x=model.setContinuousStates, get_dx=model.getDerivatives, get_z=model.getEventIndicators,
                         get_nominals=model.getNominalsOfContinuousStates, set_time=model.setTime, input=NoInput(), startTime=0.0, relativeTolerance=tolerance,
                         maxNumSteps=100000)  # fmt: skip
    time, steps, events = 0.0, 0, 0
    while time < end:
        reached = realtype(0.0)
        assert CVode(solver.cvode_mem, end, solver.x, byref(reached), one_step) >= 0
        if reached.value > end:
            assert CVode(solver.cvode_mem, end, solver.x, byref(reached), normal) >= 0
        time, steps = min(reached.value, end), steps + 1
        model.setTime(time)
        model.setContinuousStates(solver.px, size)
        if model.completedIntegratorStep()[0]:
            events += 1
            model.enterEventMode()
            model.newDiscreteStates()
            model.enterContinuousTimeMode()
            solver.reset(time)
    states = instance.get(*(unknown.variable.derivative.name for unknown in instance.description.derivatives))
    instance.free()
    return steps, events, np.array(states)


@pytest.mark.parametrize("name, others", [("PendulumCartesian", "SimplePendulum"), ("FreeBody", None), ("FourBar", None), ("RollingDisk", None), ("KnifeEdge", None)])
def test_few_events_project_onto_the_constraints(name, others):
    """
    Projection causes at most 10 events a second. A pendulum in Cartesian coordinates takes at most three times the steps of one by its
    angle.
    """
    end, tolerance = 10.0, 1e-9
    steps, events, state = integrate(name, end, tolerance)
    assert events <= 10 * end
    if others is None:
        return
    assert steps <= 3 * integrate(others, end, tolerance)[0]
    assert abs(np.hypot(*state[:2]) - 1.0) < np.sqrt(tolerance)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_few_events_beside_a_redundant_constraint(tolerance):
    """Bricard's loop moves at every tolerance with few events, and within the tolerance of the steps as in co-simulation."""
    steps, events, state = integrate("Bricard", 2.0, tolerance)
    exact = fmu.Instance("Bricard").initialize(tolerance=1e-12)
    exact.step(2.0)
    expected = exact.get(*(unknown.variable.derivative.name for unknown in exact.description.derivatives))
    exact.free()
    assert events <= 20
    np.testing.assert_allclose(state, expected, rtol=0, atol=steps * tolerance)


@pytest.mark.parametrize("distance", [1e-7, 1e-5, 1e-3])
def test_accelerations_near_redundant_constraints(distance, open_fmu):
    """
    Near the constraints the accelerations of Bricard's loop are those on them, up to the distance, also of GetReal; velocities are those that were
    set.
    """
    loop = open_fmu("Bricard", kind=FMU2Model).initialize()
    names = [unknown.variable.name for unknown in loop.description.derivatives]
    states = np.array(loop.get(*(unknown.variable.derivative.name for unknown in loop.description.derivatives)))
    loop.fmu.newDiscreteStates()
    loop.fmu.enterContinuousTimeMode()
    there = np.array(loop.get(*names))
    for seed in range(5):
        trial = states + distance * np.random.default_rng(seed).uniform(-1, 1, len(states))
        loop.fmu.setContinuousStates(*array(*trial))
        nearby = np.array(loop.get(*names))
        np.testing.assert_array_equal(nearby[:5], trial[5:])
        np.testing.assert_allclose(nearby[5:], there[5:], rtol=0, atol=100 * distance)
        np.testing.assert_array_equal(loop.get(*(unknown.variable.derivative.name for unknown in loop.description.derivatives)), trial)


@pytest.mark.parametrize("rows", [0.01, 0.1])
@pytest.mark.parametrize("name", ["PendulumCartesian", "FourBar"])
def test_few_events_without_a_tolerance(name, rows, monkeypatch):
    """FMPy passes no tolerance in model exchange. Its CVode at 1e-6 then needs no more than 10 projections a second either, at any rows."""
    events, enter = [], FMU2Model.enterEventMode
    monkeypatch.setattr(FMU2Model, "enterEventMode", lambda model: events.append(1) or enter(model))
    fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type="ModelExchange", stop_time=10.0, relative_tolerance=1e-6, output_interval=rows)
    assert len(events) <= 100


def test_drift_is_within_the_tolerance_of_the_steps():
    """
    The drift of a pendulum released from the level of its pivot stays within the tolerance times the steps. The elliptic integral gives its period.
    """
    from scipy.special import ellipk

    period = 4 * ellipk(0.5) * np.sqrt(1.0 / 9.81)
    steps, _, state = integrate("PendulumCartesian", 4 * period, 1e-9)
    largest_speed = np.sqrt(2 * 9.81)
    scales = np.array([1.0, 1.0, largest_speed, largest_speed])
    assert np.max(np.abs(state - [-1.0, 0.0, 0.0, 0.0]) / scales) < steps * 1e-9


OPEN = """
<system name="RodBesideOpenContact">
  <coordinate name="x" velocity="vx" unit="m" start="0.6"/>
  <coordinate name="y" velocity="vy" unit="m" start="-0.8"/>
  <coordinate name="s" velocity="u" unit="m" velocityStart="1"/>
  <particle name="bob" mass="1" x="x" y="y"/>
  <particle name="block" mass="1" x="s"/>
  <constraint name="rod" unit="m">sqrt(x^2 + y^2) - 1</constraint>
  <contact name="ground" gap="y + 2" unit="m"/>
  <friction name="rub" velocity="u" force="1"/>
</system>
"""


def test_open_contacts_are_not_redundant(open_fmu):
    """Beside an open contact and a friction that slides, a drift of 1e-6 is below a tolerance of 1e-5, and needs no event; one of 1e-4 does."""
    fmu.build_systems("open-contacts", {"RodBesideOpenContact": OPEN}, versions=[2])
    rod = open_fmu("RodBesideOpenContact", kind=FMU2Model).initialize(tolerance=1e-5)
    rod.fmu.newDiscreteStates()
    rod.fmu.enterContinuousTimeMode()
    for drift, needs_event in ((1e-6, False), (1e-4, True)):
        rod.fmu.setContinuousStates(*array(0.6 * (1 + drift), -0.8 * (1 + drift), 0.0, 0.0, 0.0, 1.0))
        assert bool(rod.fmu.completedIntegratorStep()[0]) == needs_event


def test_changed_states_are_reported_at_events(open_fmu):
    """valuesOfContinuousStatesChanged is true at an impact, and false at a sample that sets only modes (FMI 2.0.4, section 3.2.2)."""
    ball = falling_ball(open_fmu)
    ball.fmu.setTime(0.5)
    ball.fmu.setContinuousStates(*array(-1e-12, -3.0))
    ball.fmu.enterEventMode()
    assert ball.fmu.newDiscreteStates()[3] and ball.get("v") > 0
    servo = open_fmu("DigitalServo", kind=FMU2Model).initialize()
    servo.fmu.newDiscreteStates()
    for _ in range(5):
        _, _, _, changed, defined, time = servo.fmu.newDiscreteStates()
        assert defined and not changed
        servo.fmu.enterContinuousTimeMode()
        servo.fmu.setTime(time)
        servo.fmu.enterEventMode()
        assert not servo.fmu.newDiscreteStates()[3]
