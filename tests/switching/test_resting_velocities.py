"""Velocities that frictions, constraints and contacts keep at 0 together are exactly 0 for limits, events and outputs."""

import math

import fmpy
import numpy as np
import pytest

import fmu
from ensemble_runs import ensemble
from fmu import build_systems

pytestmark = pytest.mark.long

METHODS = ["taylor", "erk", "bdf", "radau", "auto"]
ANGLES = [0.1, 0.3, 0.5, 0.6, 0.7, math.pi / 4, 0.9, 1.0, 1.1, 1.2, 1.3, 1.5]
RATIOS = [0.3, 0.7, 1.5, 2**0.5, 2, 3, 5, 7]
PUSH = "if(time &lt; 1, 0, -push*(time - 1))"
SYSTEM = """<system name="{name}">
  <parameter name="push" start="2"/>
  {elements}
  <solver method="{method}" tolerance="1e-9"/>
</system>
"""
# A block on a slope: it moves up at 1 m/s, comes to rest, and is pushed down from 1 s on.
SLOPE = f"""<parameter name="al" start="0.5" unit="rad"/>
  <coordinate name="x" velocity="vx" velocityStart="cos(al)"/><coordinate name="y" velocity="vy" velocityStart="sin(al)"/>
  <particle mass="1" x="x" y="y"/>
  <friction name="rub" velocity="vx*cos(al) + vy*sin(al)" force="{{limit}}"/>
  <force coordinate="x">cos(al)*{PUSH}</force><force coordinate="y">sin(al)*{PUSH}</force>
  <output name="speed">vx*cos(al) + vy*sin(al)</output>
  <output name="signs">abs(sign(vx)) + abs(sign(vy))</output><output name="sizes">max(abs(vx), abs(vy))</output>
  <output name="direction">atan2(vy, vx)</output>
"""
CONSTRAINT = '<constraint name="slope">y - x*tan(al)</constraint>'
TILT = """<potential>9.81*(y*cos(al) - x*sin(al))</potential><contact name="slope" gap="y*cos(al) - x*sin(al)"/>"""
RATES = '<constraint name="slope">vy*cos(al) - vx*sin(al)</constraint>'
# Two disks in gear, with friction between them.
DIFFERENCE = f"""<parameter name="k" start="3"/>
  <coordinate name="a" velocity="w1" unit="rad" velocityStart="0.1"/><coordinate name="b" velocity="w2" unit="rad" velocityStart="0.1/k"/>
  <kinetic>w1^2/2 + 1.5*w2^2/2</kinetic>
  <constraint name="gear" unit="rad">a - k*b</constraint>
  <friction name="rub" velocity="w1 - w2" force="{{limit}}"/>
  <force coordinate="a">{PUSH}</force>
  <output name="speed">w1</output><output name="signs">abs(sign(w1)) + abs(sign(w2))</output><output name="sizes">max(abs(w1), abs(w2))</output>
  <output name="direction">atan2(w2, w1)</output>
"""
# Three blocks on each other; the friction of the floor depends on the velocity of one of them.
STACK = f"""<coordinate name="x1" velocity="v1" velocityStart="1"/><coordinate name="x2" velocity="v2" velocityStart="1"/>
  <coordinate name="x3" velocity="v3" velocityStart="1"/>
  <kinetic>v1^2/2 + 1.1*v2^2/2 + 0.9*v3^2/2</kinetic>
  <friction name="floor" velocity="v1" force="{{limit}}"/>
  <friction name="lower" velocity="1.3*(v2 - v1)" force="20"/><friction name="upper" velocity="v3 - v2" force="20"/>
  <force coordinate="x3">{PUSH}</force>
  <output name="speed">v3</output><output name="signs">abs(sign(v1)) + abs(sign(v2)) + abs(sign(v3)) + abs(sign(v3 - v1))</output>
  <output name="sizes">max(abs(v2), abs(v3))</output><output name="direction">atan2(v2, v3)</output>
"""
# A skate that comes to rest, and is pushed back; each event notes its time.
SKATE = f"""<parameter name="al" start="0.5" unit="rad"/>
  <coordinate name="x" velocity="vx" velocityStart="cos(al)"/><coordinate name="y" velocity="vy" velocityStart="-sin(al)"/>
  <coordinate name="phi" velocity="w" unit="rad" start="-al"/>
  <kinetic>(vx^2 + vy^2 + w^2)/2</kinetic>
  <constraint name="edge">vx*sin(phi) - vy*cos(phi)</constraint>
  <friction name="ice" velocity="vx*cos(phi) + vy*sin(phi)" force="2"/><friction name="pivot" coordinate="phi" force="1"/>
  <force coordinate="x">cos(phi)*{PUSH}</force><force coordinate="y">sin(phi)*{PUSH}</force>
  <mode name="rise" start="-1"/><mode name="back" start="-1"/><mode name="turn" start="-1"/>
  <event when="vy > 0"><set mode="rise">time</set></event><event when="vx &lt; 0"><set mode="back">time</set></event>
  <event when="w &lt; 0 or w > 0"><set mode="turn">time</set></event>
"""
# The friction acts along x, but its velocity rotates away from this axis after the start.
TURNING = """<system name="RestingTurning">
  <coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/>
  <coordinate name="phi" velocity="w" unit="rad" velocityStart="1"/>
  <kinetic>(vx^2 + vy^2 + w^2)/2</kinetic>
  <friction name="rub" velocity="vx*cos(phi) + vy*sin(phi)" force="100"/>
  <force coordinate="y">1</force>
  <output name="sign1">sign(vx)</output><output name="seen">vx</output>
</system>
"""
# Disks on each other: the two upper frictions keep w1 - w3 at 0 together, while the disks turn on a floor.
DISKS = f"""<parameter name="j" start="1.1"/>
  <coordinate name="a" velocity="w1" unit="rad" velocityStart="0.1"/><coordinate name="b" velocity="w2" unit="rad" velocityStart="0.1"/>
  <coordinate name="c" velocity="w3" unit="rad" velocityStart="0.1"/>
  <kinetic>w1^2/2 + j*w2^2/2 + 0.9*w3^2/2</kinetic>
  <friction name="upper" velocity="1.3*(w1 - w2)" force="20"/><friction name="lower" velocity="w2 - w3" force="20"/>
  <friction name="floor" coordinate="c" force="{{limit}}"/>
  <force coordinate="a">{PUSH}</force>
  <mode name="ahead" start="-1"/><mode name="behind" start="-1"/>
  <event when="w1 - w3 > 0"><set mode="ahead">time</set></event><event when="w1 - w3 &lt; 0"><set mode="behind">time</set></event>
  <output name="speed">w1</output><output name="order">sign(w1 - w3)</output><output name="distance">abs(3*w3 - 3*w1)</output>
  <output name="which">if(w1 &lt; w3, 1, if(w1 - w3 > 0, 2, 3))</output>
"""
DISK_LIMITS = {"If": "if(w1 - w3 > 0, 4, 1)", "Back": "if(w3 - w1 > 0, 4, 1)", "Sign": "2.5 + 1.5*sign(w1 - w3)"}
INERTIAS = [0.3, 0.7, 1.1, 1.7, 2.3, 3.1]
SCENES = {
    "Slope": (SLOPE + CONSTRAINT, {"X": "if(vx > 0, 4, 1)", "Y": "if(vy > 0, 4, 1)", "Sign": "2.5 + 1.5*sign(vx)"}),
    "Rates": (SLOPE + RATES, {"X": "if(vx > 0, 4, 1)", "Y": "if(vy > 0, 4, 1)"}),
    "Tilt": (SLOPE + TILT, {"X": "if(vx > 0, 4, 1)", "Y": "if(vy > 0, 4, 1)"}),
    "Difference": (DIFFERENCE, {"A": "if(w1 > 0, 4, 1)", "B": "2.5 + 1.5*sign(w2)"}),
    "Stack": (STACK, {"Upper": "if(v3 > 0, 4, 1)", "Middle": "2.5 + 1.5*sign(v2)"}),
}
CASES = [(scene, law) for scene, (_, laws) in SCENES.items() for law in laws]


def name_of(scene, law, method="taylor"):
    return f"Resting{scene}{law}{method.title()}"


def text_of(scene, law, method="taylor"):
    elements, laws = SCENES[scene]
    return SYSTEM.format(name=name_of(scene, law, method), elements=elements.format(limit=laws[law]), method=method)


def starts_of(scene):
    """Different values of the parameter of a scene."""
    return [{"k": k} for k in RATIOS] if scene == "Difference" else [{}] if scene == "Stack" else [{"al": angle} for angle in ANGLES]


def speed_of(scene, law, time, k=3, push=2, **others):
    """
    The velocity after the slip: at rest the limit is 1, or 2.5 with sign(), and 1 while it slides back. The force acts along w1, and the
    friction along w1 (1 - 1/k).
    """
    stiction, share, mass = 2.5 if law in ("Sign", "B", "Middle") else 1, 1, 1
    if scene == "Difference":
        share, mass = abs(1 - 1 / k), 1 + 1.5 / k**2
    if scene == "Stack":
        mass = 3
    slip = 1 + stiction * share / push
    return -max(push / 2 * ((time - 1) ** 2 - (slip - 1) ** 2) - share * (time - slip), 0) / mass


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("resting-tables", {f"{name}Tables": text_of(*case).replace(name, f"{name}Tables") for case, name in
                                     ((case, name_of(*case)) for case in CASES[::2])}, "--form", "tables")  # fmt: skip
    build_systems("resting-skate", {f"RestingSkate{method.title()}": SYSTEM.format(name=f"RestingSkate{method.title()}", elements=SKATE, method=method)
                                    for method in METHODS} | {"RestingTurning": TURNING})  # fmt: skip
    build_systems("resting-disks", {name_of("Disks", law, method): SYSTEM.format(name=name_of("Disks", law, method), method=method,
                                                                                 elements=DISKS.format(limit=limit))
                                    for law, limit in DISK_LIMITS.items() for method in METHODS})  # fmt: skip
    build_systems("resting", {name_of(scene, law, method): text_of(scene, law, method) for scene, law in CASES for method in METHODS})


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene, law", CASES)
def test_limits_at_rest(open_fmu, scene, law, method):
    for start in starts_of(scene) if method == "taylor" else starts_of(scene)[::5]:
        instance = open_fmu(name_of(scene, law, method)).initialize(start)
        instance.run(1.1, 0.1, "speed")
        assert instance.get("signs", "sizes", "direction") == [0, 0, 0], start
        instance.run(4, 0.1, "speed")
        assert instance.get("speed") == pytest.approx(speed_of(scene, law, 4, **start), abs=1e-7), start


@pytest.mark.parametrize("scene, law", CASES)
def test_in_model_exchange(scene, law):
    name = name_of(scene, law)
    for start in starts_of(scene):
        rows = fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type="ModelExchange", stop_time=4, output_interval=0.1, relative_tolerance=1e-9,
                                 start_values=start, output=["speed", "signs", "sizes", "direction"])  # fmt: skip
        rest = rows[(rows["time"] > 0.9) & (rows["time"] < 1.1)]
        assert len(rest) > 1 and not any(np.any(rest[output]) for output in ("signs", "sizes", "direction")), start
        assert rows["speed"][-1] == pytest.approx(speed_of(scene, law, 4, **start), abs=5e-6), start


@pytest.mark.parametrize("scene, law, parameter, values", [("Slope", "X", "al", ANGLES), ("Difference", "B", "k", RATIOS)])
def test_in_ensembles(scene, law, parameter, values):
    results, _ = ensemble(name_of(scene, law), [parameter], ["speed", "signs"], [1.1, 4.0]).run([[value] for value in values])
    for value, ((_, signs), (speed, _)) in zip(values, results):
        assert signs == 0 and speed == pytest.approx(speed_of(scene, law, 4, **{parameter: value}), abs=1e-8)


@pytest.mark.parametrize("scene, law", CASES[::2])
def test_in_tables(open_fmu, scene, law):
    start = starts_of(scene)[0]
    instance = open_fmu(f"{name_of(scene, law)}Tables").initialize(start)
    instance.run(1.1, 0.1, "speed")
    assert instance.get("signs", "sizes", "direction") == [0, 0, 0]
    instance.run(4, 0.1, "speed")
    assert instance.get("speed") == pytest.approx(speed_of(scene, law, 4, **start), abs=1e-7)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("method", METHODS)
def test_events_wait_for_motion(open_fmu, method, angle):
    """The skate slips when the push, 2 (t - 1), exceeds the friction of 2: at 2 s. It never turns."""
    instance = open_fmu(f"RestingSkate{method.title()}").initialize({"al": angle})
    instance.run(1.9, 0.1, "vx")
    assert instance.get("rise", "back", "turn") == [-1, -1, -1]
    instance.run(3, 0.1, "vx")
    assert instance.get("rise", "back") == pytest.approx([2, 2], abs=1e-6) and instance.get("turn") == -1
    assert instance.get("vx") == pytest.approx(-math.cos(angle), abs=1e-6)


def test_events_wait_in_model_exchange():
    for angle in ANGLES:
        rows = fmpy.simulate_fmu(str(fmu.archive("RestingSkateTaylor")), fmi_type="ModelExchange", stop_time=3, output_interval=0.1,
                                 relative_tolerance=1e-9, start_values={"al": angle}, output=["rise", "back", "turn", "vx"])  # fmt: skip
        assert all(row["rise"] == -1 and row["back"] == -1 for row in rows if row["time"] < 1.95), angle
        assert rows["rise"][-1] == pytest.approx(2, abs=1e-4) and rows["back"][-1] == pytest.approx(2, abs=1e-4)
        assert rows["turn"][-1] == -1 and rows["vx"][-1] == pytest.approx(-math.cos(angle), abs=5e-6)


def speed_of_disks(law, j):
    """At 4 s: the disks come to rest before the push, slip at the limit, and turn as one body of inertia j + 1.9 from then on."""
    limit = 2.5 if law == "Sign" else 1
    slip = 1 + limit / 2
    return -(9 - (slip - 1) ** 2 - limit * (4 - slip)) / (j + 1.9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("law", DISK_LIMITS)
def test_sums_of_velocities_at_rest(open_fmu, law, method):
    for j in INERTIAS:
        instance = open_fmu(name_of("Disks", law, method)).initialize({"j": j})
        for time, *decisions in instance.run(4, 0.1, "order", "distance", "which"):
            assert decisions == [0, 0, 3], (j, time)
        assert instance.get("speed") == pytest.approx(speed_of_disks(law, j), abs=1e-7), j
        assert instance.get("ahead", "behind") == [-1, -1], j


@pytest.mark.parametrize("law", DISK_LIMITS)
def test_sums_of_velocities_at_rest_elsewhere(law):
    """In model exchange and in an ensemble."""
    name = name_of("Disks", law)
    results, _ = ensemble(name, ["j"], ["speed"], [4.0]).run([[j] for j in INERTIAS])
    for j, ((speed,),) in zip(INERTIAS, results):
        rows = fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type="ModelExchange", stop_time=4, output_interval=0.1, relative_tolerance=1e-9,
                                 start_values={"j": j}, output=["speed", "ahead", "behind", "order", "distance", "which"])  # fmt: skip
        assert speed == pytest.approx(speed_of_disks(law, j), abs=1e-7), j
        assert rows["speed"][-1] == pytest.approx(speed_of_disks(law, j), abs=5e-6), j
        assert (rows["ahead"][-1], rows["behind"][-1]) == (-1, -1), j
        assert not rows["order"].any() and not rows["distance"].any() and set(rows["which"]) == {3}, j


def test_pages_show_outputs_as_written():
    page = (fmu.unpacked(name_of("Disks", "If")) / "documentation" / "index.html").read_text()
    assert "order = sign(w1 - w3)<" in page and "speed = w1<" in page and ".moves" not in page


def test_a_velocity_that_is_0_for_an_instant_is_not_at_rest(open_fmu):
    """vx and the friction's direction: vx = -vy tan(phi), which is 0 at the start, where phi = 0."""
    instance = open_fmu("RestingTurning").initialize()
    instance.run(0.5, 0.1, "seen")
    phi, vx, vy = instance.get("phi", "vx", "vy")
    assert vx == pytest.approx(-vy * math.tan(phi), abs=1e-9) and vx < -0.1
    assert instance.get("sign1", "seen") == [-1, vx]
