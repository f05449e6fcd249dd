"""
A body comes to rest in the corner of one gap with several pieces. The message names the contact and asks for one contact per piece, which works.
"""

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import fmu
from fmu import DISCARD, build_systems

BODY = '<coordinate name="x" velocity="v" {0}/><coordinate name="y" velocity="w" {1}/><particle mass="1" x="x" y="y"/>'
FORCES = '<force coordinate="x">-0.1</force><force coordinate="y">-2</force>'
SLIDES = BODY.format('start="1" velocityStart="-1"', "") + FORCES
FALLS = BODY.format('start="-1" velocityStart="1"', 'start="1"') + '<force coordinate="y">-2</force>'
REACHED = 10 * (np.sqrt(1.2) - 1)  # solves 1 - t - 0.05 t^2 = 0
# The gap, its piecewise function in the message, and the time at which the corner is reached; None if bounces do not end before.
CORNERS = {
    "Min": (SLIDES, "min(x, y)", "min", REACHED),
    "Max": (SLIDES, "-max(-x, -y)", "max", REACHED),
    "Condition": (SLIDES, "if(x &lt; y, x, y)", "a condition", REACHED),
    "Abs": (SLIDES, "(x + y - abs(x - y))/2", "abs", REACHED),
    "Vee": (FALLS, "if(x &gt; 0, y - x, y + x)", "a condition", None),
}
METHODS = ["taylor", "radau"]
# A body falls 1.5 m onto a slope of 45 degrees without friction, and bounces along it.
SLOPE = BODY.format('start="0.5"', 'start="1"') + '<force coordinate="y">-9.81</force><contact name="slope" gap="y + x" {}/>'


@pytest.fixture(scope="module", autouse=True)
def built():
    text = '<system name="{}">{}<contact name="corner" gap="{}" restitution="0"/><solver method="{}"/></system>'
    texts = {f"Corner{name}{method.title()}": text.format(f"Corner{name}{method.title()}", body, gap, method)
             for name, (body, gap, _, _) in CORNERS.items() for method in METHODS}  # fmt: skip
    both = '<contact name="wall" gap="x" restitution="0"/><contact name="floor" gap="y" restitution="0"/>'
    texts["CornerBoth"] = f'<system name="CornerBoth">{SLIDES}{both}</system>'
    bounces = SLOPE.format('restitution="0.5"')
    texts["CornerSlope"] = f'<system name="CornerSlope">{bounces}</system>'
    build_systems("corners-of-gaps", texts)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("corner", CORNERS)
def test_a_corner_asks_for_two_contacts(open_fmu, corner, method):
    _, _, function, reached = CORNERS[corner]
    instance = open_fmu(f"Corner{corner}{method.title()}").initialize()
    with instance.fails(DISCARD, f"the gap of the contact 'corner' has a corner, by {function}, line 1 .* expected a <contact> for each piece"):
        instance.step(3.0)
    text = next(text for _, _, text in instance.messages if "has a corner" in text)
    assert reached is None or float(text.split()[1][:-1]) == pytest.approx(reached, abs=1e-5)


@pytest.mark.parametrize("corner", CORNERS)
def test_a_corner_asks_for_two_contacts_in_model_exchange(corner):
    """The integrator's error in the body's position would move it from one piece to the other, endlessly."""
    messages, function = [], CORNERS[corner][2]
    log = lambda *words: messages.append(words[-1].decode())
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(str(fmu.archive(f"Corner{corner}Taylor")), fmi_type="ModelExchange", stop_time=3, relative_tolerance=1e-6, logger=log)
    assert any(f"the gap of the contact 'corner' has a corner, by {function}" in message for message in messages), messages


def test_bounces_along_a_slope_end_in_model_exchange():
    """After low bounces, the integrator's first step is longer than the next flight: it must not end on the slope while the body departs."""
    archive = str(fmu.archive("CornerSlope"))
    rows = fmpy.simulate_fmu(archive, fmi_type="ModelExchange", stop_time=3, output_interval=0.1, relative_tolerance=1e-6, output=["x", "y", "v", "w"])
    speed = 9.81 / np.sqrt(2) * (3 - np.sqrt(2 * 1.5 / 9.81)) + np.sqrt(9.81 * 1.5)  # along the slope, which has no friction
    x, y, v, w = (rows[-1][name] for name in "xyvw")
    assert [x + y, v + w, (v - w) / np.sqrt(2)] == pytest.approx([0, 0, speed], abs=1e-3)


def test_two_contacts_close_in_a_corner(open_fmu):
    instance = open_fmu("CornerBoth").initialize()
    instance.step(3.0)
    assert instance.get("x", "y", "v", "w", "wall.force", "floor.force") == pytest.approx([0, 0, 0, 0, 0.1, 2], abs=1e-12)
