"""Events in both directions that reverse the quantity they watch: each arrival is one event, and the return is none."""

import math
from ctypes import c_double

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

import fmi3
import fmu
from fmu import Instance, build_systems

METHODS = ["taylor", "radau", "bdf", "erk"]
EVENT = '<event when="x - {place}" direction="both"><set velocity="v">-0.7*v</set><set mode="n">n + 1</set></event><mode name="n"/>'
FREE = """<system name="{name}"><coordinate name="x" velocity="v" unit="m" velocityStart="1"/><particle mass="1" x="x"/>{event}<solver method="{method}"/></system>"""
SPRING = """<system name="{name}"><coordinate name="x" velocity="v" unit="m" velocityStart="1"/><particle mass="1" x="x"/><potential>10*x^2/2</potential>
  {event}<solver method="{method}"/></system>"""
OTHERS = {
    name: f'<system name="{name}">{text}</system>'
    for name, text in {
        "Throttled": '<coordinate name="x" velocity="v" unit="m" velocityStart="1"/><particle mass="1" x="x"/><force coordinate="x">1</force>'
        '<mode name="n"/><event when="v - 2" direction="both"><set velocity="v">v - 0.5</set><set mode="n">n + 1</set></event>',
        "Stopped": '<input name="u" unit="m" start="2"/><coordinate name="x" velocity="v" unit="m" velocityStart="1"/><particle mass="1" x="x"/><mode name="n"/>'
        '<event when="x - u" direction="both"><set velocity="v">-0.7*v</set><set mode="n">n + 1</set></event>',
    }.items()
}


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {f"{title}_{method}": text.format(name=f"{title}_{method}", method=method, event=EVENT.format(place=place))
             for title, text, place in (("Free", FREE, 0.7), ("Spring", SPRING, 0.2)) for method in METHODS}  # fmt: skip
    build_systems("reversing-events", texts | OTHERS, versions=(2, 3))


@pytest.mark.parametrize("start, speed", [(0.0, 1.0), (1.4, -1.0)])
@pytest.mark.parametrize("method", METHODS)
def test_an_event_turns_a_body_back(method, start, speed):
    """The body arrives after 0.7 s, and then moves back with 0.7 of its speed, on the side that it came from."""
    instance = Instance(f"Free_{method}").initialize({"x": start, "v": speed}, tolerance=1e-9)
    instance.step(2)
    assert instance.get("x", "v", "n") == pytest.approx([0.7 - 0.7 * 1.3 * speed, -0.7 * speed, 1], abs=1e-7)


def spring_after_five_events():
    """
    State 0.1 s after the fifth event, and the time of this state. The mass starts with 0.3 J, loses 0.51 of its kinetic energy at x = 0.2,
    and each time returns to this point.
    """
    w, energy, time = math.sqrt(10), 0.3, math.asin(0.2 * math.sqrt(10)) / math.sqrt(10)
    for _ in range(4):
        energy *= 0.49
        # From 0.2 with the velocity -u round to 0.2 with u the phase advances by pi + 2 atan(0.2 w/u).
        time += (math.pi + 2 * math.atan(0.2 * w / math.sqrt(2 * energy))) / w
    after = 0.1
    u = 0.7 * math.sqrt(2 * energy)
    x, v = 0.2 * math.cos(w * after) - u / w * math.sin(w * after), -u * math.cos(w * after) - 0.2 * w * math.sin(w * after)
    return time + after, [x, v, 5]


@pytest.mark.parametrize("method", METHODS)
def test_a_spring_brings_it_back_each_time(method):
    end, expected = spring_after_five_events()
    instance = Instance(f"Spring_{method}").initialize(tolerance=1e-9)
    instance.step(end)
    assert instance.get("x", "v", "n") == pytest.approx(expected, abs=2e-6)


class Integrator:
    """An importer of either version of FMI with fixed steps, which detects events up to a step late."""

    def __init__(self, name, version, values=()):
        module, kind = (fmu, FMU2Model) if version == 2 else (fmi3, FMU3Model)
        self.version, self.instance = version, module.Instance(name, kind=kind).initialize(values)
        self.model, self.time = self.instance.fmu, 0.0
        self.count = 2
        self.resolve_event()

    def update(self):
        if self.version == 3:
            return self.model.updateDiscreteStates()[0]
        return self.model.newDiscreteStates()[0] == 1

    def resolve_event(self):
        while self.update():
            pass
        self.model.enterContinuousTimeMode()

    def vector(self, function, count=None):
        values = (c_double * (count or self.count))()
        getattr(self.model, function)(values, len(values))
        return np.array(values)

    def to(self, end, step):
        rates = "getContinuousStateDerivatives" if self.version == 3 else "getDerivatives"
        count = round((end - self.time) / step)
        start = self.time
        for k in range(1, count + 1):
            state, rate, before = self.vector("getContinuousStates"), self.vector(rates), self.vector("getEventIndicators", 1)
            # Exact for constant accelerations.
            state = state + step * rate + [step**2 / 2 * rate[1], 0]
            self.time = start + (end - start) * k / count
            self.model.setTime(self.time)
            self.model.setContinuousStates((c_double * self.count)(*state), self.count)
            called = self.model.completedIntegratorStep()[0]
            if called or before[0] * self.vector("getEventIndicators", 1)[0] < 0:
                self.model.enterEventMode()
                self.resolve_event()

    def get(self, *names):
        return list(self.instance.get(*names))


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("step", [0.1, 0.03, 0.001])
@pytest.mark.parametrize("start, speed", [(0.0, 1.0), (1.4, -1.0)])
def test_an_importer_that_comes_late_turns_it_back(version, step, start, speed):
    """Late detection leaves no error: the body is where an event at the zero itself would have put it."""
    importer = Integrator("Free_taylor", version, {"x": start, "v": speed})
    end = 0.03 * 66 if step == 0.03 else 2.0
    importer.to(end, step)
    assert importer.get("x", "v", "n") == pytest.approx([0.7 - 0.7 * (end - 0.7) * speed, -0.7 * speed, 1], abs=1e-12)


@pytest.mark.parametrize("version", [2, 3])
def test_a_velocity_that_is_set_back_is_one_event(version):
    """It reaches 2 after 1 s, and again 0.5 s after being set to 1.5: at 1, 1.5, 2, 2.5, ... s."""
    importer = Integrator("Throttled", version)
    importer.to(2.8, 0.07)
    assert importer.get("x", "v", "n") == pytest.approx([1.5 + 3 * (1.5 * 0.5 + 0.125) + 1.5 * 0.3 + 0.045, 1.8, 4], abs=1e-12)
    instance = Instance("Throttled").initialize()
    instance.step(2.8)
    assert instance.get("x", "v", "n") == pytest.approx(importer.get("x", "v", "n"), abs=1e-9)


@pytest.mark.parametrize("version", [2, 3])
def test_a_zero_that_an_input_moves_is_no_lateness(version):
    """The input changes from 2 to 0.1 while the body is at 0.5: the body reverses there, passes 0.1 on its way back, and reverses again."""
    importer = Integrator("Stopped", version)
    importer.to(0.5, 0.1)
    importer.model.enterEventMode()
    importer.instance.set({"u": 0.1})
    importer.resolve_event()
    assert importer.get("x", "v", "n") == pytest.approx([0.5, -0.7, 1], abs=1e-15)
    importer.to(1.5, 0.1)
    back = 0.4 / 0.7
    assert importer.get("x", "v", "n") == pytest.approx([0.1 + 0.49 * (1 - back), 0.49, 2], abs=1e-12)


@pytest.mark.parametrize("version", [2, 3])
def test_cvode_of_an_importer_comes_to_the_same(version):
    """The spring above, with an importer's own solver and event detection."""
    archive = fmu.archive("Spring_taylor") if version == 2 else fmi3.archive("Spring_taylor")
    end, expected = spring_after_five_events()
    words = dict(fmi_type="ModelExchange", stop_time=end, output_interval=0.05, relative_tolerance=1e-9, output=["x", "v", "n"])
    result = simulate_fmu(str(archive), **words)
    assert [result[name][-1] for name in "xvn"] == pytest.approx(expected, abs=1e-5)


def test_event_mode_of_steps_turns_it_back():
    instance = fmi3.Instance("Free_taylor", eventModeUsed=True, earlyReturnAllowed=True).initialize()
    instance.fmu.updateDiscreteStates()
    instance.fmu.enterStepMode()
    events = 0
    while instance.time < 2.0:
        if instance.step(2.0 - instance.time)[0]:
            instance.fmu.enterEventMode()
            instance.fmu.updateDiscreteStates()
            instance.fmu.enterStepMode()
            events += 1
    assert list(instance.get("x", "v", "n")) == pytest.approx([0.7 - 0.7 * 1.3, -0.7, 1], abs=1e-12) and events == 1
