"""Shapes out of each other's reach: their contacts have no events, and act as ever when they come near. Speeds follow from the law of the contact."""

import html

import numpy as np
import pytest
from scipy.optimize import brentq

import fmu
from building import build_systems

K, C = 1e5, 0.5  # N/m, s/m
AWAY, FAST = 10.0, 20.0  # m, m/s

QUATERNION = '<coordinate name="q0" velocity="r0" unit="1" start="1"/>' + "".join(f'<coordinate name="q{i}" velocity="r{i}" unit="1"/>' for i in (1, 2, 3))
FREE = f"""<coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="z" velocity="vz" unit="m"/>
  {QUATERNION}<frame name="b"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>
  <body name="body" in="b" mass="2" Ixx="0.03" Iyy="0.05" Izz="0.04"/>"""
SHAPES = {
    "box": '<shape name="s" in="b" type="box" sizeX="0.3" sizeY="0.2" sizeZ="0.4"/>',
    "cylinder": '<shape name="s" in="b" type="cylinder" radius="0.1" length="0.3" axis="z"/>',
    "capsule": '<shape name="s" in="b" type="capsule" radius="0.1" length="0.3" axis="z"/>',
}
# The second shape, and the z of the first one at which they touch.
OTHERS = {
    "plane": ('<shape name="o" type="plane"/>', 0.0),
    "ball": ('<shape name="o" type="sphere" radius="0.2"/>', 0.2),
    "pill": ('<shape name="o" type="capsule" radius="0.2" length="1" axis="x"/>', 0.2),
    "brick": ('<shape name="o" type="box" sizeX="1" sizeY="1" sizeZ="0.4"/>', 0.2),
}
HALF = {"box": 0.2, "cylinder": 0.15, "capsule": 0.25}
PAIRS = {"BoxOnPlane": ("box", "plane"), "CanOnPlane": ("cylinder", "plane"), "PillOnPill": ("capsule", "pill"), "PillOnBall": ("capsule", "ball"), "PillOnBrick": ("capsule", "brick"), "BoxOnBrick": ("box", "brick")}
TOUCHING = {name: HALF[first] + OTHERS[second][1] for name, (first, second) in PAIRS.items()}

CONTACT = f'<contact name="c" between="s" and="o" stiffness="{K}" damping="{C}"/>'
SCENES = {name: f'<system name="{name}">{FREE}{SHAPES[first]}{OTHERS[second][0]}{CONTACT}</system>' for name, (first, second) in PAIRS.items()}
SCENES["Between"] = f"""<system name="Between">{FREE}{SHAPES["box"]}{OTHERS["plane"][0]}{CONTACT}<frame name="above"><translate z="5"/><rotate axis="x" angle="pi"/></frame>
  <shape name="ceiling" in="above" type="plane"/><contact name="top" between="s" and="ceiling" stiffness="{K}" damping="{C}"/></system>"""
SCENES["Upright"] = f"""<system name="Upright"><coordinate name="z" velocity="vz" unit="m" start="1"/><frame name="b"><translate z="z"/></frame>
  <body name="body" in="b" mass="2"/><shape name="s" in="b" type="box" sizeX="0.1" sizeY="0.1" sizeZ="0.2"/>{OTHERS["plane"][0]}{CONTACT}</system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("reach", SCENES)


def speed_behind(speed):
    """The speed after a contact with the force k d (1 + c d'), without gravity: c v - ln(1 + c v) is the same for the velocities before and after."""

    def invariant(velocity):
        return C * velocity - np.log1p(C * velocity)

    return brentq(lambda after: invariant(-after) - invariant(speed), 0.0, (1.0 - 1e-12) / C, xtol=1e-14)


@pytest.mark.parametrize("name", PAIRS)
def test_a_fast_shape_from_far_away(open_fmu, name):
    """Found out of reach, struck, and left behind: the time and the speed of the rebound."""
    instance = open_fmu(name).initialize({"z": TOUCHING[name] + AWAY, "vz": -FAST}, tolerance=1e-9)
    instance.run(AWAY / FAST + 1.0, AWAY / FAST + 1.0)
    after = speed_behind(FAST)
    assert instance.get("vz") == pytest.approx(after, rel=1e-6)
    assert [instance.get(f"r{i}") for i in range(4)] == pytest.approx([0] * 4, abs=1e-6)
    # Both motions meet within the contact, which lasts a few ms.
    assert instance.get("z") == pytest.approx(TOUCHING[name] + after, abs=0.03 * after)


@pytest.mark.parametrize("name", PAIRS)
def test_nothing_happens_out_of_reach(open_fmu, name):
    """A shape that tumbles 10 m away passes the kinks of its nearest points, without an event."""
    instance = open_fmu(name).initialize({"z": TOUCHING[name] + AWAY, "r1": 3.0, "r2": 2.0, "r3": 1.0})
    instance.run(2.0, 2.0)
    assert instance.fmu.getInteger(instance.vr("events"))[0] == 0


def test_a_shape_that_left_faster_than_damping_allows(open_fmu):
    """
    Faster than 1/c the damped force would pull: a box that starts within the floor leaves it freely. The force on the ceiling has its full damping
    again.
    """
    speed = 1.5 / C
    instance = open_fmu("Between").initialize({"z": 0.2 - 0.01, "vz": speed}, tolerance=1e-9)
    instance.run(1.0, 1.0)
    assert instance.get("vz") == speed and instance.get("z") == pytest.approx(0.19 + speed, rel=1e-14)
    instance.run(2.0, 1.0)
    assert instance.get("vz") == pytest.approx(-speed_behind(speed), rel=1e-6)


def test_a_page_shows_the_law_alone():
    """Four lower and four upper corners: a condition on each gap, and the bound of each force."""
    page = html.unescape((fmu.unpacked("Upright") / "documentation" / "index.html").read_text())
    law = "if(1 - vz/2 > 0, 1 - vz/2, 0)"
    assert f"4*if(z - 1/10 > 0, 0, 10000*{law}*(1 - 10*z)) + 4*if(z + 1/10 > 0, 0, -10000*{law}*(10*z + 1))" in page
