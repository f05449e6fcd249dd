"""Events that look both ways and turn back what they look at: each arrival is one event, as the way back is no passage."""

import math

import pytest

from fmu import Instance, build_systems

METHODS = ["taylor", "radau", "bdf", "erk"]
EVENT = '<event when="x - {place}" direction="both"><set velocity="v">-0.7*v</set><set mode="n">n + 1</set></event><mode name="n"/>'
FREE = """<system name="{name}"><coordinate name="x" velocity="v" unit="m" velocityStart="1"/><particle mass="1" x="x"/>{event}<solver method="{method}"/></system>"""
SPRING = """<system name="{name}"><coordinate name="x" velocity="v" unit="m" velocityStart="1"/><particle mass="1" x="x"/><potential>10*x^2/2</potential>
  {event}<solver method="{method}"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {f"{title}_{method}": text.format(name=f"{title}_{method}", method=method, event=EVENT.format(place=place))
             for title, text, place in (("Free", FREE, 0.7), ("Spring", SPRING, 0.2)) for method in METHODS}  # fmt: skip
    build_systems("reversing-events", texts)


@pytest.mark.parametrize("start, speed", [(0.0, 1.0), (1.4, -1.0)])
@pytest.mark.parametrize("method", METHODS)
def test_an_event_turns_a_body_back(method, start, speed):
    """It meets the place after 0.7 s, and has 0.7 of its speed from there on, on the side that it came from."""
    instance = Instance(f"Free_{method}").initialize({"x": start, "v": speed}, tolerance=1e-9)
    instance.step(2)
    assert instance.get("x", "v", "n") == pytest.approx([0.7 - 0.7 * 1.3 * speed, -0.7 * speed, 1], abs=1e-7)


@pytest.mark.parametrize("method", METHODS)
def test_a_spring_brings_it_back_each_time(method):
    """It loses 0.51 of its kinetic energy, 0.3 J at first, at x = 0.2, and each time it swings round from there: after 4 events that of 0.7^8."""
    w, energy, time = math.sqrt(10), 0.3, math.asin(0.2 * math.sqrt(10)) / math.sqrt(10)
    for _ in range(4):
        energy *= 0.49
        # From 0.2 with the velocity -u round to 0.2 with u: the phase passes pi + 2 atan(0.2 w/u).
        time += (math.pi + 2 * math.atan(0.2 * w / math.sqrt(2 * energy))) / w
    after = 0.1
    u = 0.7 * math.sqrt(2 * energy)
    instance = Instance(f"Spring_{method}").initialize(tolerance=1e-9)
    instance.step(time + after)
    x, v = 0.2 * math.cos(w * after) - u / w * math.sin(w * after), -u * math.cos(w * after) - 0.2 * w * math.sin(w * after)
    assert instance.get("x", "v", "n") == pytest.approx([x, v, 5], abs=2e-6)
