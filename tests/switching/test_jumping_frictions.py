"""
Friction along a velocity that jumps, such as that of a belt that starts instantly. A sticking body slides, and sticks again at the new velocity.
"""

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model

import fmu
from fmu import build_systems

BODY = '<coordinate name="x" velocity="v"/><particle mass="2" x="x"/>'
PLANE = '<coordinate name="y" velocity="w"/><particle mass="2" y="y"/>'
METHODS = ["taylor", "erk", "radau", "bdf"]
# Further elements, and the friction with the limit 50 N; from 0.55 s on v approaches 1 m/s at 25 m/s2.
BELTS = {
    "Time": ("", 'velocity="v - if(time &lt; 0.55, 0, 1)"'),
    "Step": ("", 'velocity="v - 0.5*(1 + sign(time - 0.55))"'),
    "Mode": ('<mode name="belt" start="0"/><event when="time &gt; 0.55"><set mode="belt">1</set></event>', 'velocity="v - belt"'),
    "Plane": (PLANE, 'velocity="v - if(time &lt; 0.55, 0, 1)" across="w"'),
    # The belt reverses: it moves at -1 m/s from 0.25 s on, and at 1 m/s from 0.55 s on.
    "Turned": ("", 'velocity="v - if(time &lt; 0.25, 0, if(time &lt; 0.55, -1, 1))"'),
    # Only the reaction of the other body acts on it.
    "Between": ('<coordinate name="y" velocity="w"/><particle mass="2" x="y"/>', 'velocity="v - w - if(time &lt; 0.55, 0, 2)"'),
}
SET = {"Parameter": ('<parameter name="u" start="0" unit="m/s"/>', 'velocity="v - u"')}


def name_of(belt, method):
    return f"Jumps{belt}{method.title()}"


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {}
    for belt, (elements, friction) in (BELTS | SET).items():
        for method in METHODS if belt in BELTS else METHODS[:1]:
            name = name_of(belt, method)
            body = f'{BODY}{elements}<friction name="rub" {friction} force="50"/>'
            texts[name] = f'<system name="{name}">{body}<solver method="{method}" tolerance="1e-9"/></system>'
    build_systems("jumping-frictions", texts)


def speed_and_force(belt, time):
    """It slides for 0.04 s after a jump by 1, and for 0.08 s after a jump by 2."""
    if belt == "Turned":
        return np.interp(time, [0.25, 0.29, 0.55, 0.63], [0, -1, -1, 1]), 50 * (0.25 < time < 0.29) - 50 * (0.55 < time < 0.63)
    return np.interp(time, [0.55, 0.59], [0, 1]), -50 * (0.55 < time < 0.59)


@pytest.mark.parametrize("method, kind", [*((method, "CoSimulation") for method in METHODS), ("taylor", "ModelExchange")])
@pytest.mark.parametrize("belt", BELTS)
def test_a_belt_that_jumps(belt, method, kind):
    rows = fmpy.simulate_fmu(str(fmu.archive(name_of(belt, method))), fmi_type=kind, stop_time=0.7, output_interval=0.007,
                             output=["v", "rub.force"], relative_tolerance=1e-9)  # fmt: skip
    assert rows["time"][-1] == pytest.approx(0.7)
    for time, *found in rows:
        if min(abs(time - event) for event in (0.25, 0.29, 0.55, 0.59, 0.63)) > 1e-6:
            assert found == pytest.approx(speed_and_force(belt, time), abs=1e-4 if kind == "ModelExchange" else 1e-7), time


def test_a_belt_that_a_parameter_starts(open_fmu):
    instance = open_fmu(name_of("Parameter", "taylor")).initialize()
    instance.step(0.3)
    instance.set(u=1)
    assert instance.get("v", "rub.force") == [0, -50]
    for time in (0.01, 0.02, 0.03):
        instance.step(0.01)
        assert instance.get("v", "rub.force") == pytest.approx([time / 0.04, -50], abs=1e-12)
    instance.step(0.02)
    assert instance.get("v", "rub.force") == pytest.approx([1, 0], abs=1e-12)
    assert not any("moved" in text for _, _, text in instance.messages)


def test_a_belt_that_an_importer_starts():
    instance = fmu.Instance(name_of("Parameter", "taylor"), kind=FMU2Model).initialize()
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    instance.fmu.setTime(0.3)
    instance.fmu.enterEventMode()
    instance.set(u=1)
    instance.fmu.newDiscreteStates()
    assert instance.get("v", "rub.force", "der(v)") == [0, -50, 25]
