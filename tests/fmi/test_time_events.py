"""
Switches that depend on time alone are time events (FMI 2.0.4, sections 3.1 and 3.2.2; FMI 3.0.2, section 2.3.5), so that importers with
fixed steps miss no pulse.
"""

import math
from ctypes import c_double

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

import fmi3
import fmu

# A pulse of 1 ms, a velocity that is doubled, a ramp, and a knot of a table, all at known times.
PULSE = """
<system name="Pulse">
  <parameter name="t0" start="0.1234" unit="s"/>
  <parameter name="width" start="0.001" unit="s"/>
  <coordinate name="x" velocity="v"/>
  <mode name="next" start="0.2077"/>
  <mode name="count"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">if(time &gt; t0 and time &lt; t0 + width, 1/width, 0)</force>
  <event when="time - next" direction="rising">
    <set mode="next">next + 0.1</set>
    <set mode="count">count + 1</set>
    <set velocity="v">v + 1</set>
  </event>
</system>
"""
# Conditions that depend on an input or a state remain event indicators.
UNKNOWN = """
<system name="UnknownTimes">
  <input name="u"/>
  <coordinate name="x" velocity="v"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">if(x + sin(3*time) &gt; 0.5, 1, 0) + abs(time - u)</force>
</system>
"""
# Conditions of time with zeros in closed form, until 0.99 s.
CURVES = {
    "if(sin(3*time) &gt; 0.5, 1, 0)": [math.asin(0.5) / 3, (math.pi - math.asin(0.5)) / 3],
    "if(time^2 &gt; t0, 1, 0)": [math.sqrt(0.3)],
    "if(exp(-2*time) &lt; 0.5, 1, 0)": [math.log(2) / 2],
    "if(mod(time, 0.25) &lt; 1e-4, 1, 0)": [1e-4, 0.25, 0.2501, 0.5, 0.5001, 0.75, 0.7501],
    "floor(4*time)": [0.25, 0.5, 0.75],
    "round(4*time)": [0.125, 0.375, 0.625, 0.875],
    "max(0, cos(8*time))": [math.pi / 16, 3 * math.pi / 16, 5 * math.pi / 16],
    "if((time - 0.4)*(time - 0.4001) &lt; 0, 1, 0)": [0.4, 0.4001],
    "if(exp(-time) &gt; 2, 1, 0)": [],
    "if(sin(9*time) &gt; 2, 1, 0)": [],
}
CURVED = """
<system name="Curved{number}">
  <parameter name="t0" start="0.3"/>
  <coordinate name="x" velocity="v"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">{force}</force>
</system>
"""
KNOTS = """
<system name="Knots">
  <table name="f" interpolation="linear" extrapolation="constant">
    0 0
    0.3 3
    0.7 -1
  </table>
  <coordinate name="x" velocity="v"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">f(time) + max(0, 2*time - 1)</force>
</system>
"""
STEP = 0.01


@pytest.fixture(scope="module", autouse=True)
def built():
    curved = {f"Curved{i}": CURVED.format(number=i, force=force) for i, force in enumerate(CURVES)}
    fmu.build_systems("time-events", {"Pulse": PULSE, "UnknownTimes": UNKNOWN, "Knots": KNOTS, **curved}, versions=[2, 3])


def opened_for_exchange(version, name, values=(), **words):
    if version == 2:
        return fmu.Instance(name, kind=FMU2Model).initialize(values, **words)
    return fmi3.Instance(name, kind=FMU3Model).initialize(values, **words)


def update(model, version):
    """Update discrete states and enter continuous-time mode; return the time of the next event, or None."""
    if version == 2:
        needs, terminates, _, _, defined, time = model.newDiscreteStates()
    else:
        needs, terminates, _, _, defined, time = model.updateDiscreteStates()
    assert not needs and not terminates
    model.enterContinuousTimeMode()
    return time if defined else None


def get_array(function, size):
    values = (c_double * size)()
    function(values, size)
    return np.array(values)


def integrate(instance, version, end, sees_indicators=True):
    """Integrate by fixed steps, shortened at the next known event, exact for constant accelerations; return the times of the events."""
    model, events, time, k = instance.fmu, [], 0.0, 0
    following = update(model, version)
    while time < end:
        while k * STEP <= time:
            k += 1
        target = min(k * STEP, end)
        is_due = following is not None and following <= target
        target = following if is_due else target
        derivatives = model.getDerivatives if version == 2 else model.getContinuousStateDerivatives
        x, dx = get_array(model.getContinuousStates, 2), get_array(derivatives, 2)
        h = target - time
        time = target
        model.setTime(time)
        model.setContinuousStates((c_double * 2)(x[0] + h * x[1] + h * h / 2 * dx[1], x[1] + h * dx[1]), 2)
        asks, _ = model.completedIntegratorStep()
        if is_due or (asks and sees_indicators):
            events.append(time)
            model.enterEventMode()
            following = update(model, version)
            assert following is None or following > time
    return events


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("t0, width", [(0.1234, 0.001), (0.05, 0.0001), (0.1999, 1e-5)])
def test_a_short_pulse_is_not_missed(version, t0, width):
    instance = opened_for_exchange(version, "Pulse", {"t0": t0, "width": width})
    events = integrate(instance, version, 0.5)
    passages = [0.2077, 0.3077, 0.4077]
    assert events == pytest.approx(sorted([t0, t0 + width, *passages]), rel=1e-15)
    v = 1.0 + len(passages)
    x = width / 2 + (0.5 - t0 - width) + sum(0.5 - t for t in passages)
    count, v_end, x_end = instance.get("count", "v", "x")
    assert count == 3 and [v_end, x_end] == pytest.approx([v, x], rel=1e-11)


@pytest.mark.parametrize("version", [2, 3])
def test_the_knots_of_a_table(version):
    """There is no event at 0 after initialization, and none after the last knot."""
    instance = opened_for_exchange(version, "Knots")
    assert integrate(instance, version, 1.0) == pytest.approx([0.3, 0.5, 0.7], rel=1e-15)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("force", CURVES)
def test_curved_conditions_of_time(version, force):
    """Conditions that are not affine in time: each zero is a time event, at which importers with fixed steps and no event location stop."""
    instance = opened_for_exchange(version, f"Curved{list(CURVES).index(force)}")
    events = integrate(instance, version, 0.99, sees_indicators=False)
    assert events == pytest.approx(CURVES[force], rel=1e-13)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["UnknownTimes", "BouncingBall", "SimplePendulum"])
def test_there_is_no_event_that_is_not_known(version, name):
    assert update(opened_for_exchange(version, name).fmu, version) is None


@pytest.mark.parametrize("version", [2, 3])
def test_parameters_move_the_next_event(version):
    instance = opened_for_exchange(version, "Pulse")
    assert update(instance.fmu, version) == 0.1234
    instance.fmu.enterEventMode()
    instance.set(t0=0.2)
    assert update(instance.fmu, version) == 0.2
    instance.fmu.setTime(0.15)
    instance.fmu.enterEventMode()
    instance.set(t0=0.149)
    assert update(instance.fmu, version) == pytest.approx(0.2077)


@pytest.mark.parametrize("early", [True, False])
def test_event_mode_of_steps(early):
    """An importer of FMI 3.0 that steps exactly to the next event and enters event mode there continues after it."""
    instance = fmi3.Instance("Pulse", eventModeUsed=True, earlyReturnAllowed=early).initialize()
    times = []
    while len(times) < 4:
        _, _, _, _, defined, time = instance.fmu.updateDiscreteStates()
        instance.fmu.enterStepMode()
        assert defined and time > instance.time
        times.append(time)
        _, _, _, last = instance.step(time - instance.time)
        assert last == time
        instance.fmu.enterEventMode()
    assert times == pytest.approx([0.1234, 0.1244, 0.2077, 0.3077], rel=1e-15)
    assert instance.get("v") == pytest.approx([2.0]), "the last event is due"
    instance.fmu.updateDiscreteStates()
    assert instance.get("v", "count") == pytest.approx([3.0, 2.0])


def test_steps_of_co_simulation_are_as_before():
    for opened in (fmu, fmi3):
        instance = opened.Instance("Pulse").initialize()
        for _ in range(50):
            instance.step(STEP)
        assert instance.get("v", "count") == pytest.approx([4.0, 3.0], rel=1e-12)
