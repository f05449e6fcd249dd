"""Shapes out of each other's reach: their contacts have no events, and act as ever when they come near. Speeds follow from the law of the contact."""

import html

import fmpy
import numpy as np
import pytest
from scipy.optimize import brentq

import fmu
from building import build_systems

pytestmark = pytest.mark.long

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
BALL = """<coordinate name="z" velocity="v" unit="m" start="10" velocityStart="-30"/><particle name="p" mass="0.1" z="z"/>
  <shape name="s" in="p" type="sphere" radius="0.02"/>"""
TARGETS = {"Bullet": '<shape name="o" type="capsule" radius="0.05" length="1" axis="x"/>', "TwoBalls": '<shape name="o" type="sphere" radius="0.05"/>'}
SCENES |= {name: f'<system name="{name}">{BALL}{target}{CONTACT}</system>' for name, target in TARGETS.items()}
SCENES["Rising"] = f"""<system name="Rising"><input name="u" start="-0.31" unit="m" derivatives="2"/><coordinate name="z" velocity="vz" unit="m"/>
  <frame name="b"><translate z="z"/></frame><body name="body" in="b" mass="2"/><frame name="f"><translate z="u"/></frame>
  {SHAPES["box"]}<shape name="o" in="f" type="plane"/>{CONTACT}</system>"""
SCENES["PillAlong"] = f"""<system name="PillAlong">{FREE}<shape name="s" in="b" type="capsule" radius="0.1" length="0.3" axis="x"/>{OTHERS["brick"][0]}
  {CONTACT}</system>"""
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


@pytest.mark.parametrize("name", TARGETS)
def test_importers_notice_fast_balls(name):
    """In 0.1 s the ball moves by 3 m, through the other shape of 10 cm. The importer sees the sign of the damping change, from the first point on."""
    result = fmpy.simulate_fmu(fmu.archive(name), fmi_type="ModelExchange", stop_time=0.6, output_interval=0.1, relative_tolerance=1e-6, output=["v"])
    assert result["v"][-1] == pytest.approx(speed_behind(30.0), rel=1e-3)


def test_an_input_that_is_held_at_the_border_of_reach(open_fmu):
    """A held input contradicts its derivative: a floor that recedes as fast again as the box that leaves it does not stop the motion."""
    instance = open_fmu("Rising").initialize({"vz": -1.0, "der(u)": -2.0}, tolerance=1e-8)
    for i in range(10):
        instance.fmu.setReal(instance.vr("u"), [-0.31 - 0.2 * i])
        instance.run(0.1 * (i + 1), 0.1)
    assert instance.get("z") == pytest.approx(-1.0, rel=1e-12) and instance.fmu.getInteger(instance.vr("events"))[0] == 0


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9])
def test_a_capsule_that_spins_along_an_edge(open_fmu, tolerance):
    """Its axis stays parallel to edges of the box, where any of their points is nearest."""
    instance = open_fmu("PillAlong").initialize({"z": 1.0, "vz": -2.0, "r1": 1.5}, tolerance=tolerance)
    instance.run(1.0, 1.0)
    assert instance.get("vz") == pytest.approx(speed_behind(2.0), rel=100 * tolerance)


def test_a_linearization_within_reach(tmp_path):
    """Its expressions have no modes. The springs of the four lower corners act on the mass of 2 kg."""
    (tmp_path / "system.xml").write_text(SCENES["Upright"])
    result = fmu.lagc("--linearize", "system.xml", "--at", "z=0.09", cwd=tmp_path)
    assert result.returncode == 0 and f"[-{4 * K / 2:.0f}, " in result.stdout
