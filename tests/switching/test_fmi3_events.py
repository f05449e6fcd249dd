"""Event mode in co-simulation of FMI 3.0: a step ends at an event, which the importer handles (sections 4.2.1 and 2.3.5)."""

import contextlib

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import fmi3
import fmu
from fmi3 import Importer, observed
from fmu import ERROR
from test_switching import SWITCHED, bounces

# Bounces caused by an event, infinitely many in finite time (Zeno behaviour).
ZENO = """
<system name="Zeno">
  <coordinate name="h" velocity="v" start="1"/>
  <particle mass="1" y="h"/>
  <potential>9.81*h</potential>
  <event when="h"><set velocity="v">-0.5*v</set></event>
</system>
"""
# The gap is a distance minus a radius: near 0 it has fewer significant digits than the state.
FAR_GROUND = """
<system name="{name}">
  <parameter name="e" start="0.5"/>
  <parameter name="R" start="1"/>
  <coordinate name="h" velocity="v" start="1"/>
  <particle mass="1" y="h"/>
  <potential>9.81*h</potential>
  <contact name="ground" gap="sqrt((0.6*R)^2 + (h + 0.8*R)^2) - R" restitution="e"/>
  <solver method="{method}" tolerance="1e-10"/>
</system>
"""
# A gap in units that make it small.
SMALL_GAP = """
<system name="SmallGap">
  <parameter name="s" start="1"/>
  <coordinate name="h" velocity="v" start="1"/>
  <particle mass="1" y="h"/>
  <potential>9.81*h</potential>
  <contact name="ground" gap="s*h" restitution="0.5"/>
</system>
"""
# A block whose velocity leaves 0 as it slips, with an acceleration of 0 at first.
SLIPPING = """
<system name="Slipping">
  <coordinate name="x" velocity="v"/>
  <mode name="slips"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">2*time</force>
  <friction name="rub" coordinate="x" force="1"/>
  <event when="v" direction="both"><set mode="slips">slips + 1</set></event>
</system>
"""
FAR_METHODS = ["taylor", "radau", "erk"]
EVENTS = dict(eventModeUsed=True, earlyReturnAllowed=True)


def far_ground(method):
    return f"FarGround{method.title()}"


@pytest.fixture(scope="module", autouse=True)
def built():
    far = {name: FAR_GROUND.format(name=name, method=name[9:].lower()) for name in map(far_ground, FAR_METHODS)}
    fmu.build_systems("fmi3-events", {"Zeno": ZENO, "SmallGap": SMALL_GAP, "Slipping": SLIPPING, **far}, versions=[3])


def go_through(instance, updates=1):
    *_, changed, defined, _ = update = instance.fmu.updateDiscreteStates()
    for _ in range(updates - 1):
        assert not any(instance.fmu.updateDiscreteStates()), "nothing has changed since"
    assert update[:3] == (False, False, False) and not defined
    instance.fmu.enterStepMode()
    return changed


def start(opened, name, values=(), **options):  # noqa: F811
    instance = opened(name, **(EVENTS | options)).initialize(values)
    assert not go_through(instance), "the start is resolved in initialization mode"
    return instance


def to(instance, end, at_event=lambda: None, updates=1):
    """Step through all events; return their number."""
    count = 0
    while instance.time < end:
        need, terminate, early, last = instance.step(end - instance.time)
        assert not terminate and early == (last < end) and (need or last == end)
        if need:
            at_event()
            instance.fmu.enterEventMode()
            go_through(instance, updates)
            count += 1
    return count


def test_who_has_event_mode(opened):
    for name in fmu.all_names():
        has = name in SWITCHED or bool(fmi3.description(name).eventIndicators)
        assert fmi3.description(name).coSimulation.hasEventMode == has


def test_an_importer_sees_both_sides_of_a_bounce(opened):
    h, e = 0.7, 0.6
    instance = start(opened, "BouncingBall", {"h": h, "e": e})
    times, speeds = bounces(h, e, 8)
    before = np.concatenate([[speeds[0] / e], speeds[:-1]])
    for time, into, out in zip(times, before, speeds):
        need, _, early, last = instance.step(2.0)
        assert need and early and last == pytest.approx(time, rel=1e-13)
        assert instance.get("h", "v") == pytest.approx([0, -into], abs=1e-11)
        instance.fmu.enterEventMode()
        assert instance.get("v") == pytest.approx(-into, abs=1e-11)
        assert go_through(instance)
        assert instance.get("h", "v") == pytest.approx([0, out], abs=1e-11)


def test_an_importer_may_update_discrete_states_again(opened):
    instance = start(opened, "Slipping")
    to(instance, 2.0, updates=3)
    assert instance.get("v", "slips") == pytest.approx([2.25, 0], abs=1e-12)


@pytest.mark.parametrize("name", SWITCHED)
def test_event_mode_does_not_change_the_motion(opened, name):  # noqa: F811
    """Event mode does not change the motion. For the ball on the table, differences grow tenfold per bounce."""
    end, bound = (0.6, 1e-10) if name == "VibratingTable" else (3.0, 1e-11)
    handled, inside, late = start(opened, name), opened(name).initialize(), start(opened, name, earlyReturnAllowed=False)
    count = sum(to(handled, time) for time in np.linspace(0.1, end, 29))
    inside.step(end)
    late_events = to(late, end)
    states = [variable.name for variable in fmi3.description(name).modelVariables if variable.causality == "output"]
    assert handled.get(*states) == pytest.approx(inside.get(*states), abs=bound)
    assert list(late.get(*states)) == list(inside.get(*states)) and late_events == 1, "at the end of the step"
    assert count > 0


def test_a_step_to_an_event_and_no_further(opened):
    """If the communication point is the time of the event up to rounding, the event occurs at that point or right after it."""
    first = start(opened, "BouncingBall")
    _, _, _, impact = first.step(1.0)
    for ulps in range(-3, 4):
        instance = start(opened, "BouncingBall")
        end = impact + ulps * 2.0**-54
        need, _, early, last = instance.step(end)
        assert early == (last < end) and last <= end
        if not need:
            assert last == end
            need, _, early, last = instance.step(0.1)
            assert need and early
        assert last == pytest.approx(impact, rel=1e-14)


def test_an_event_must_be_gone_through(opened):
    instance = start(opened, "BouncingBall")
    instance.step(1.0)
    with pytest.raises(FMICallException) as raised:
        instance.step(1.0)
    assert raised.value.status == ERROR and "expected fmi3EnterEventMode" in instance.messages[-1][2]


def test_event_mode_without_an_event(opened):
    """An importer may enter event mode at any communication point, for instance to change a parameter."""
    instance, plain = start(opened, "BouncingBall", {"h": 0.3}), opened("BouncingBall").initialize({"h": 0.3})
    for one in (instance, plain):
        one.step(0.1)
    instance.fmu.enterEventMode()
    for one in (instance, plain):
        one.set(g=20.0)
    assert not go_through(instance)
    to(instance, 0.8)
    plain.step(0.7)
    assert instance.get("h", "v") == pytest.approx(plain.get("h", "v"), abs=1e-12)


def test_a_state_at_an_event_is_kept(opened):
    instance = start(opened, "NewtonsCradle")
    while not instance.step(0.1)[0]:
        pass
    state, time = instance.fmu.getFMUState(), instance.time
    bytes_ = instance.fmu.serializeFMUState(state)

    def continue_run(one):
        one.time = time
        one.fmu.enterEventMode()
        go_through(one)
        to(one, time + 2)
        return one.get("totalEnergy", "time").tobytes()

    first = continue_run(instance)
    instance.fmu.setFMUState(state)
    assert continue_run(instance) == first
    instance.fmu.freeFMUState(state)
    other = start(opened, "NewtonsCradle")
    copy = other.fmu.deserializeFMUState(bytes_)
    other.fmu.setFMUState(copy)
    assert continue_run(other) == first
    other.fmu.freeFMUState(copy)
    plain = opened("NewtonsCradle").initialize()
    with pytest.raises(FMICallException):
        plain.fmu.deserializeFMUState(bytes_)
    assert "values that no instance can have saved" in plain.messages[-1][2]


def test_zeno_behaviour_ends_the_step(opened):
    instance = start(opened, "Zeno")
    end = 3 * np.sqrt(2 / 9.81)
    with pytest.raises(FMICallException):
        for _ in range(2000):
            if instance.step(5.0)[0]:
                instance.fmu.enterEventMode()
                go_through(instance)
    assert any("events accumulate (Zeno behaviour)" in text for _, _, text in instance.messages)
    assert instance.time == pytest.approx(end, rel=1e-6)


def test_intermediate_update_and_event_mode(opened):
    """Intermediate update reports the state before the event at the end of the step."""
    importer = Importer()
    ball = observed(opened, "BouncingBall", importer, ["h", "v"], **EVENTS).initialize()
    go_through(ball)
    ball.step(1.0)
    time, _, (height, velocity) = importer.calls[-1]
    assert time == ball.time and height == pytest.approx(0, abs=1e-12) and velocity == pytest.approx(-np.sqrt(2 * 9.81), rel=1e-12)


@pytest.mark.parametrize("name", ["BouncingBall", "StickSlip", "HardStopPendulum"])
def test_fmpy_goes_through_events(name):
    words = dict(stop_time=2.0, output_interval=0.1, output=fmu.names_of(name, "output"))
    plain = fmpy.simulate_fmu(str(fmi3.unpacked(name)), **words)
    events = fmpy.simulate_fmu(str(fmi3.unpacked(name)), use_event_mode=True, early_return_allowed=True, **words)
    assert len(events) > len(plain), "the importer sees the times of events"
    for variable in words["output"]:
        last = [np.asarray(result[variable])[-1] for result in (events, plain)]
        assert last[0] == pytest.approx(last[1], abs=1e-10)


def test_no_event_mode_where_it_was_not_asked_for(opened):
    instance = opened("BouncingBall").initialize()
    with pytest.raises(FMICallException):
        instance.fmu.enterEventMode()
    assert "eventModeUsed" in instance.messages[-1][2]


@pytest.mark.parametrize("options", [EVENTS, {}], ids=["event mode", "alone"])
@pytest.mark.parametrize("radius", [1.0, 1e3, 6.4e6])
@pytest.mark.parametrize("method", FAR_METHODS)
def test_a_ball_rests_on_a_gap_whose_terms_cancel(opened, method, radius, options):
    e, at_impacts = 0.8, []
    instance = opened(far_ground(method), **options).initialize({"e": e, "R": radius})
    if options:
        go_through(instance)
    times, _ = bounces(1.0, e, 10)
    rest = np.sqrt(2 / 9.81) * (1 + e) / (1 - e)
    to(instance, 1.001 * rest, lambda: at_impacts.append(instance.time))
    assert instance.get("h", "v") == pytest.approx([0, 0], abs=1e-9 + 1e-15 * radius)
    assert instance.get("ground.force") == pytest.approx(9.81 / 0.8, rel=1e-9)
    assert not options or at_impacts[:10] == pytest.approx(times, rel=1e-8)
    assert len(at_impacts) < 100


def test_a_step_that_loses_an_event_ends_before_it(opened):
    """After fading bounces erk tries a step of seconds: the step fails, without a state beyond the ground."""
    instance = opened(far_ground("erk"), **EVENTS).initialize({"e": 0.95, "h": 1e-9, "v": 0.001})
    go_through(instance)
    with contextlib.suppress(FMICallException):
        to(instance, 3.0, lambda: instance.get("h") == pytest.approx(0, abs=1e-9))
    assert instance.get("h") > -1e-6


@pytest.mark.parametrize("scale", [1, 1e-14, 1e-30])
def test_importers_find_small_gaps(scale):
    """In model exchange, indicators exceed 0 after events by an amount that scales with the gap."""
    archive = fmu.archive("SmallGap")
    archive = archive.parent.parent / "fmi3" / archive.name
    result = fmpy.simulate_fmu(str(archive), fmi_type="ModelExchange", stop_time=3, relative_tolerance=1e-8, start_values={"s": scale}, output=["h", "ground.closed"])
    assert min(result["h"]) > -1e-9 and result["h"][-1] == pytest.approx(0, abs=1e-9) and result["ground.closed"][-1] == 1
