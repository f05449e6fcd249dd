"""Shapes in contact: gaps against a search for the nearest points, forces and motions against closed forms and conserved quantities."""

import itertools
import math
import random
import subprocess

import numpy as np
import pytest
from scipy.optimize import brentq, minimize
from scipy.spatial.transform import Rotation

import fmu
from building import LAGC, build_systems
from fmu import DISCARD, ERROR

pytestmark = pytest.mark.long

HEAD = """<constant name="g" value="9.81" unit="m/s2"/><parameter name="m" start="2" unit="kg"/><parameter name="r" start="0.1" unit="m"/>
  <parameter name="k" start="1e5" unit="N/m"/><parameter name="c" start="0" unit="s/m"/><parameter name="mu" start="0" unit="1"/>"""


def free(name, x="0", velocity=""):
    """A freely moving frame with a body like a solid ball."""
    quaternion = " ".join(f'<coordinate name="{name}q{i}" velocity="{name}r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
    return f"""<coordinate name="{name}x" velocity="{name}vx" unit="m" start="{x}"/><coordinate name="{name}y" velocity="{name}vy" unit="m"/>
  <coordinate name="{name}z" velocity="{name}vz" unit="m"/>{quaternion}
  <frame name="{name}"><translate x="{name}x" y="{name}y" z="{name}z"/><rotate quaternion="{name}q0 {name}q1 {name}q2 {name}q3"/></frame>
  <body name="{name}Body" in="{name}" mass="m" Ixx="0.4*m*r^2" Iyy="0.4*m*r^2" Izz="0.4*m*r^2"/>"""


# A capsule that may tilt above one that stands still, and is parallel to it.
PARALLEL = """<system name="Parallel"><parameter name="k" start="1e5" unit="N/m"/><parameter name="c" start="0" unit="s/m"/>
  <coordinate name="z" velocity="vz" unit="m"/><coordinate name="a" velocity="va" unit="rad"/><gravity z="-9.81"/>
  <parameter name="loss" start="0" unit="N.m.s/rad"/><dissipation>loss*va^2/2</dissipation>
  <frame name="f"><translate z="z"/><rotate axis="y" angle="a"/></frame><body name="b" in="f" mass="2" Ixx="0.1" Iyy="0.1" Izz="0.1"/>
  <shape name="low" type="capsule" radius="0.1" length="0.6" axis="x"/><shape name="high" in="f" type="capsule" radius="0.1" length="0.6" axis="x"/>
  <contact name="touch" between="high" and="low" stiffness="k" damping="c"/><experiment stopTime="1"/></system>"""
CONTACT = '<contact name="touch" between="{}" and="{}" stiffness="k" damping="c" friction="mu"/>'
SHAPES = {
    "Sphere": '<shape name="{0}" in="{1}" type="sphere" radius="0.3" x="0.02"/>',
    "Capsule": '<shape name="{0}" in="{1}" type="capsule" radius="0.2" length="0.8" axis="y" z="0.05"/>',
    "Box": '<shape name="{0}" in="{1}" type="box" sizeX="0.6" sizeY="0.8" sizeZ="1" y="-0.1"/>',
    "Cylinder": '<shape name="{0}" in="{1}" type="cylinder" radius="0.35" length="0.7" axis="x" y="0.03"/>',
}
PAIRS = [("Sphere", "Sphere"), ("Sphere", "Capsule"), ("Box", "Sphere"), ("Sphere", "Cylinder"), ("Capsule", "Capsule")]
ON_BOX = ("Capsule", "Box")  # these touch at the ends of the capsule and at the edges of the box
PAIR = """<system name="{0}{1}">{HEAD}{a}{b}
  {first}{second}{contact}<experiment stopTime="1"/></system>"""
SLOPE = f"""<system name="Slope">{HEAD}<parameter name="slope" start="0.3" unit="rad"/>
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="z" velocity="vz" unit="m"/><coordinate name="phi" velocity="w" unit="rad"/>
  <frame name="ball"><translate x="x" z="z"/><rotate axis="y" angle="phi"/></frame>
  <body name="solid" in="ball" mass="m" Ixx="0.4*m*r^2" Iyy="0.4*m*r^2" Izz="0.4*m*r^2"/>
  <gravity x="g*sin(slope)" z="-g*cos(slope)"/>
  <shape name="skin" in="ball" type="sphere" radius="r"/><shape name="floor" type="plane"/>
  {CONTACT.format("skin", "floor")}<experiment stopTime="2" stepSize="0.01"/></system>"""
STAND = f"""<system name="Stand">{HEAD}{free("a")}<gravity z="-g"/>
  <shape name="block" in="a" type="box" sizeX="0.4" sizeY="0.6" sizeZ="0.2"/><shape name="floor" type="plane"/>
  {CONTACT.format("floor", "block")}<experiment stopTime="2" stepSize="0.01"/></system>"""
HARD = f"""<system name="Hard">{HEAD}<parameter name="e" start="0.5" unit="1"/>{free("a")}<gravity z="-g"/>
  <shape name="block" in="a" type="box" sizeX="0.4" sizeY="0.6" sizeZ="0.2"/><shape name="floor" type="plane"/>
  <contact name="touch" between="block" and="floor" restitution="e"/><experiment stopTime="2" stepSize="0.01"/></system>"""
SIDES = "".join(f'<parameter name="{side}" start="0.4" unit="m"/>' for side in "ABC")
CRATE = f"""<system name="Crate">{HEAD}{SIDES}{free("a").replace('Ixx="0.4*m*r^2" Iyy="0.4*m*r^2" Izz="0.4*m*r^2"', 'Ixx="m*(B^2+C^2)/12" Iyy="m*(A^2+C^2)/12" Izz="m*(A^2+B^2)/12"')}
  <shape name="block" in="a" type="box" sizeX="A" sizeY="B" sizeZ="C"/><shape name="floor" type="plane"/><gravity z="-g"/>
  <contact name="touch" between="block" and="floor"/><solver method="taylor"/><experiment stopTime="2" stepSize="0.01"/></system>"""

BENCH = f"""<system name="OnBench">{HEAD}<parameter name="length" start="1" unit="m"/>{free("a")}<gravity z="-g"/>
  <shape name="rod" in="a" type="capsule" axis="y" radius="r" length="length"/><shape name="bench" type="box" sizeX="0.3" sizeY="0.4" sizeZ="0.2" z="-0.1"/>
  <contact name="touch" between="rod" and="bench" friction="0.5"/><experiment stopTime="1"/></system>"""

# A crate in planar motion, at depth d in a floor that may move up and down.
FLAT = """<system name="Flat"><constant name="a" value="0.4" unit="m"/><constant name="h" value="0.2" unit="m"/>
  <parameter name="m" start="2" unit="kg"/><parameter name="I" start="0.3" unit="kg.m2"/><parameter name="k" start="1e4" unit="N/m"/><parameter name="c" start="0.5" unit="s/m"/>
  <parameter name="mu" start="0.3" unit="1"/><parameter name="d" start="1e-3" unit="m"/><parameter name="heave" start="0" unit="m"/><parameter name="rate" start="3" unit="rad/s"/>
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="phi" velocity="w" unit="rad"/>
  <frame name="crate"><translate x="x" y="y" z="h/2 - d"/><rotate axis="z" angle="phi"/></frame><body name="mass" in="crate" mass="m" Ixx="I" Iyy="I" Izz="I"/>
  <frame name="below"><translate z="heave*sin(rate*time)"/></frame><gravity z="-9.81"/>
  <shape name="block" in="crate" type="box" sizeX="a" sizeY="a" sizeZ="h"/><shape name="floor" in="below" type="plane"/>
  <contact name="touch" between="block" and="floor" stiffness="k" damping="c" friction="mu" creep="1e-6"/><solver method="radau" tolerance="1e-9"/></system>"""

THREE = """<system name="Three"><parameter name="k" start="1e4" unit="N/m"/><shape name="floor" type="plane"/>
  <for index="i" from="1" to="3"><coordinate name="z[i]" velocity="v[i]" unit="m"/><particle name="p[i]" mass="1" z="z[i]"/>
  <shape name="s[i]" in="p[i]" type="sphere" radius="0.1*i"/><contact name="c[i]" between="s[i]" and="floor" stiffness="k"/></for>
  <gravity z="-9.81"/></system>"""
TWICE = """<system name="Twice"><include file="../Three/system.xml" as="a"/><include file="../Three/system.xml" as="b"/>
  <contact name="both" between="a.s[1]" and="b.s[2]" stiffness="1e3"/></system>"""

LEVER = """<system name="Lever"><coordinate name="z" velocity="v" unit="m"/><coordinate name="turn" velocity="w" unit="rad"/>
  <frame name="f"><translate z="z"/><rotate axis="x" angle="turn"/></frame><body name="b" in="f" mass="2" y="0.3" Ixx="0.1"/>
  <particle name="p" in="f" mass="1" y="0.45"/><shape name="floor" type="plane"/>
  <shape name="s" in="b" type="sphere" radius="0.4" y="0.05"/><shape name="q" in="p" type="sphere" radius="0.4" y="-0.2"/>
  <contact name="one" between="s" and="floor" stiffness="1e4"/><contact name="two" between="q" and="floor" stiffness="1e4"/></system>"""


# A ball on a soft obstacle, whose top is at 0.1 m.
OBSTACLES = {"Box": 'type="box" sizeX="1" sizeY="1" sizeZ="0.2"', "Cylinder": 'type="cylinder" radius="0.5" length="0.2"', "Sphere": 'type="sphere" radius="0.1"',
             "Capsule": 'type="capsule" radius="0.1" length="0.3" axis="x"'}  # fmt: skip
SINKING = """<system name="{name}">{HEAD}<coordinate name="z" velocity="v" unit="m" start="0.3"/><particle name="ball" mass="m" x="0" y="0" z="z"/><gravity z="-g"/>
  <shape name="skin" type="sphere" radius="r" in="ball"/><shape name="obstacle" {obstacle}/>{contact}<solver method="{method}"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"Slope": SLOPE, "Stand": STAND, "Hard": HARD, "Crate": CRATE, "Three": THREE, "Twice": TWICE, "Lever": LEVER, "Flat": FLAT, "OnBench": BENCH}
    for first, second in [*PAIRS, ON_BOX]:
        parts = {"first": SHAPES[first].format("one", "a"), "second": SHAPES[second].format("other", "b"), "contact": CONTACT.format("one", "other")}
        texts[first + second] = PAIR.format(first, second, HEAD=HEAD, a=free("a"), b=free("b", "1"), **parts)
    for kind, obstacle in OBSTACLES.items():
        for method in ("taylor", "radau"):
            name = f"Sinking{kind}{method.title()}"
            texts[name] = SINKING.format(name=name, HEAD=HEAD, obstacle=obstacle, contact=CONTACT.format("skin", "obstacle"), method=method)
    texts["Parallel"] = PARALLEL
    build_systems("shapes", texts)


class Running:
    """Context manager that frees the FMU."""

    def __init__(self, name, values):
        self.instance = fmu.Instance(name, logging=False)
        self.values = values

    def __enter__(self):
        return self.instance.initialize(self.values)

    def __exit__(self, *_):
        self.instance.free()


def pose(name, place, turn):
    x, y, z, w = turn.as_quat()
    return dict(zip((f"{name}x", f"{name}y", f"{name}z"), place)) | dict(zip((f"{name}q{i}" for i in range(4)), (w, x, y, z)))


# The solids without their rounding, in their own axes: the point nearest to a given one, by clamped coordinates.
def nearest(kind, place):
    x, y, z = place
    if kind == "Sphere":
        return np.array([0.02, 0, 0])
    if kind == "Capsule":
        return np.array([0, np.clip(y, -0.4, 0.4), 0.05])
    if kind == "Box":
        return np.array([np.clip(x, -0.3, 0.3), np.clip(y, -0.5, 0.3), np.clip(z, -0.5, 0.5)])
    across = math.hypot(y - 0.03, z)
    share = min(1.0, 0.35 / across)
    return np.array([np.clip(x, -0.35, 0.35), 0.03 + share * (y - 0.03), share * z])


RADIUS = {"Sphere": 0.3, "Capsule": 0.2, "Box": 0.0, "Cylinder": 0.0}


def distance(kinds, places, rotations):
    """Distance by alternating projections onto the two convex solids, which converge to the nearest points."""
    point = np.array(places[0], dtype=float)
    for _ in range(2000):
        other = places[1] + rotations[1].apply(nearest(kinds[1], rotations[1].inv().apply(point - places[1])))
        point = places[0] + rotations[0].apply(nearest(kinds[0], rotations[0].inv().apply(other - places[0])))
    return np.linalg.norm(point - other) - RADIUS[kinds[0]] - RADIUS[kinds[1]]


@pytest.mark.parametrize("kinds", PAIRS, ids="".join)
def test_depths(kinds):
    """Without damping the force is stiffness times depth."""
    chance, deep = random.Random(1), 0
    for _ in range(60):
        rotations = [Rotation.from_quat([chance.gauss(0, 1) for _ in range(4)]) for _ in range(2)]
        places = [np.zeros(3), np.array([chance.uniform(-0.8, 0.8) for _ in range(3)])]
        gap = distance(kinds, places, rotations)
        if gap < -0.9 * sum(RADIUS[kind] for kind in kinds):
            continue  # one centre may be inside the other solid
        with Running("".join(kinds), pose("a", places[0], rotations[0]) | pose("b", places[1], rotations[1])) as instance:
            assert instance.get("touch.force") == pytest.approx(1e5 * max(0.0, -gap), rel=1e-6, abs=1e-3)
        deep += gap < 0
    assert 5 < deep < 60


def gaps_of_ends_and_edges(places, rotations):
    """Gaps of the ends of the capsule, and of its axis at each edge of the box, by alternating projections onto both segments."""
    seen = lambda point: rotations[1].inv().apply(places[0] + rotations[0].apply(point) - places[1])
    ends = [seen(np.array([0, y, 0.05])) for y in (-0.4, 0.4)]
    gaps = [np.linalg.norm(end - nearest("Box", end)) - 0.2 for end in ends]
    middle, direction = (ends[0] + ends[1]) / 2, (ends[1] - ends[0]) / 0.8
    low, high = np.array([-0.3, -0.5, -0.5]), np.array([0.3, 0.3, 0.5])
    for axis in range(3):
        for corner in itertools.product((0, 1), repeat=2):
            first = np.insert([(low, high)[side][k] for side, k in zip(corner, [k for k in range(3) if k != axis])], axis, low[axis])
            last = np.where(np.arange(3) == axis, high, first)
            other = (first + last) / 2
            for _ in range(400):
                whole = direction @ (other - middle)
                point = middle + np.clip(whole, -0.4, 0.4) * direction
                other = np.where(np.arange(3) == axis, np.clip(point, low, high), first)
            excess = max(abs(whole) - 0.4, 0)
            gaps.append(np.linalg.norm(point - other) - 0.2 + excess**2 / 0.2)
    return gaps


def test_depths_of_a_capsule_in_a_box():
    """The least gap of the ends and the edges is that of the solids, and the force adds up the depths of all."""
    chance, touching = random.Random(2), 0
    for _ in range(16):
        rotations = [Rotation.from_quat([chance.gauss(0, 1) for _ in range(4)]) for _ in range(2)]
        places = [np.zeros(3), np.array([chance.uniform(-0.7, 0.7) for _ in range(3)])]
        gaps, gap = gaps_of_ends_and_edges(places, rotations), distance(ON_BOX, places, rotations)
        if gap < -0.19:
            continue  # the axis enters the box
        assert min(gaps) == pytest.approx(gap, abs=1e-6)
        with Running("CapsuleBox", pose("a", places[0], rotations[0]) | pose("b", places[1], rotations[1])) as instance:
            assert instance.get("touch.force") == pytest.approx(1e5 * sum(max(0.0, -gap) for gap in gaps), rel=1e-5, abs=0.1)
        touching += gap < 0
    assert touching >= 5


def test_a_capsule_hits_a_box():
    """With friction and damping, momentum and angular momentum are conserved, and energy decreases, by impacts of an end and of an edge."""
    for side in (0.0, 0.35):
        values = pose("a", np.array([-1.0, 0.2, side]), Rotation.from_euler("xz", [0.5, 1.0])) | {"avx": 2.0, "bx": 0.0, "c": 0.3, "mu": 0.5}
        with Running("CapsuleBox", values) as instance:
            before = momenta(instance)
            instance.run(1.0, 0.01)
            after = momenta(instance)
            assert instance.get("bvx") > 0.2
        assert after[0] == pytest.approx(before[0], abs=1e-8) and after[1] == pytest.approx(before[1], abs=1e-8)
        assert after[2] < 0.999 * before[2]


def test_a_capsule_lies_across_a_box():
    """A rigid capsule on two edges of a narrower box: the edges carry it by the law of the lever. On its top, both ends do."""
    weight = 2 * 9.81
    for length, place, expected in [(1.0, 0.05, [weight * 5 / 8, weight * 3 / 8]), (0.3, 0.04, [weight / 2, weight / 2])]:
        with Running("OnBench", {"length": length, "ay": place, "az": 0.1}) as instance:
            forces = [instance.get(f"touch[{i}].force") for i in range(1, 15)]
            assert sorted(force for force in forces if force > 1e-9) == pytest.approx(sorted(expected), rel=1e-9)
            instance.run(1.0, 0.1)
            assert [instance.get(name) for name in ("ax", "ay", "az")] == pytest.approx([0, place, 0.1], abs=1e-9)


def momenta(instance, moment=0.4 * 2 * 0.1**2):
    """Linear and angular momentum about the origin, and the kinetic energy, of two balls."""
    linear, angular, energy = np.zeros(3), np.zeros(3), 0.0
    for name in "ab":
        place, speed = (np.array([instance.get(f"{name}{part}{axis}") for axis in "xyz"]) for part in ("", "v"))
        rotation = np.array([[instance.get(f"{name}.R{i}{j}") for j in (1, 2, 3)] for i in (1, 2, 3)])
        spin = rotation @ np.array([instance.get(f"{name}Body.omega{axis}") for axis in "XYZ"])
        linear += 2 * speed
        angular += np.cross(place, 2 * speed) + moment * spin
        energy += speed @ speed + moment * spin @ spin / 2
    return linear, angular, energy


def test_impact_of_spheres():
    """
    Head-on without damping, equal balls exchange their velocities. Oblique, with friction and damping, momentum and angular momentum are
    conserved and energy decreases.
    """
    still = {"ax": -1.0, "avx": 2.0, "bx": 0.6}
    with Running("SphereSphere", still) as instance:
        instance.run(1.0, 0.01)
        assert [instance.get("avx"), instance.get("bvx")] == pytest.approx([0, 2], abs=1e-6)
    with Running("SphereSphere", still | {"az": 0.25, "c": 0.3, "mu": 0.5}) as instance:
        before = momenta(instance)
        instance.run(1.0, 0.01)
        after = momenta(instance)
        assert instance.get("bvx") > 0.5
    assert after[0] == pytest.approx(before[0], abs=1e-8) and after[1] == pytest.approx(before[1], abs=1e-8)
    assert 0.3 * before[2] < after[2] < 0.999 * before[2]


def test_nothing_sticks():
    """Contacts that open faster than 1/damping have no tensile force."""
    deep = {"ax": 0.5, "bx": 1.0, "c": 0.5}
    for speed, factor in ((1.0, 0.5), (3.0, 0.0)):
        with Running("SphereSphere", deep | {"avx": -speed}) as instance:
            depth = 0.6 - 0.5
            assert instance.get("touch.force") == pytest.approx(1e5 * depth * factor, rel=1e-9)


@pytest.mark.parametrize("mu", [0.4, 0.05])
def test_ball_on_a_slope(mu):
    """It rolls at 5/7 g sin a if mu >= 2/7 tan a, up to the creep of the friction; otherwise it slides."""
    g, slope, m, r = 9.81, 0.3, 2.0, 0.1
    weight = m * g * math.cos(slope)
    with Running("Slope", {"mu": mu, "z": r - weight / 1e5, "c": 0.5}) as instance:
        instance.run(1.0, 0.01)
        assert instance.get("touch.force") == pytest.approx(weight, rel=1e-7)
        creeping = instance.get("vx") - instance.get("w") * r
        if mu > 2 / 7 * math.tan(slope):
            needed = 2 / 7 * m * g * math.sin(slope)
            assert instance.get("der(vx)") == pytest.approx(5 / 7 * g * math.sin(slope), rel=1e-4)
            assert creeping == pytest.approx(1e-3 * needed / math.sqrt((mu * weight) ** 2 - needed**2), rel=1e-2)
            # Creep makes the friction stiff, so that auto continues by Radau IIA.
            assert instance.fmu.getInteger(instance.vr("jacobianEvaluations"))[0] > 0
        else:
            assert instance.get("der(vx)") == pytest.approx(g * (math.sin(slope) - mu * math.cos(slope)), rel=1e-6)
            assert instance.get("der(w)") == pytest.approx(mu * weight * r / (0.4 * m * r**2), rel=1e-3)


def test_a_size_that_is_tuned():
    """A radius in use cannot be set below 0, which would turn the ball inside out."""
    with Running("Slope", {}) as instance:
        with instance.fails(DISCARD, "-0.1 for 'r' is below its minimum, 0"):
            instance.set({"r": -0.1})


def test_shapes_of_a_loop_and_of_included_files():
    """Each shape has its own name."""
    with Running("Twice", {f"a.z[{i}]": 0.05 for i in (1, 2, 3)} | {f"b.z[{i}]": 0.3 for i in (1, 2, 3)}) as instance:
        assert [instance.get(f"a.c[{i}].force") for i in (1, 2, 3)] == pytest.approx([500, 1500, 2500])
        assert [instance.get(f"b.c[{i}].force") for i in (1, 2, 3)] == pytest.approx([0, 0, 0], abs=1e-9)
        assert instance.get("both.force") == pytest.approx(1e3 * (0.3 - 0.25))


def test_where_shapes_of_bodies_are():
    """A body's shape is at its centre of mass, shifted along the axes of the frame."""
    values = {"turn": 0.7, "z": 0.1}
    with Running("Lever", values) as instance:
        # Positions along the frame's y axis: the body is at 0.3 and its shape 0.05 further; the particle's shape is at 0.25.
        heights = [0.1 + length * math.sin(0.7) for length in (0.35, 0.25)]
        assert [instance.get(f"{name}.force") for name in ("one", "two")] == pytest.approx([1e4 * (0.4 - height) for height in heights])


def test_a_block_that_stands():
    """Dropped flat, with damping, it rests on four corners that carry its weight, and does not rotate."""
    with Running("Stand", {"az": 0.11, "c": 5.0, "mu": 0.5}) as instance:
        instance.run(3.0, 0.01)
        assert instance.get("touch.force") == pytest.approx(2 * 9.81, rel=1e-6)
        assert instance.get("az") == pytest.approx(0.1 - 2 * 9.81 / 4e5, rel=1e-9)
        assert [instance.get(f"aq{i}") for i in (1, 2, 3)] == pytest.approx([0, 0, 0], abs=1e-9)


def test_hard_contacts():
    """
    A block falls on a corner and tumbles on a smooth floor. Its energy never grows, no part is below the floor, and at rest the eight forces carry
    the weight. A flat block bounces like a ball.
    """
    turn = Rotation.from_euler("xyz", [0.4, 0.3, 0.1])
    corners = np.array([[x, y, z] for x in (-0.2, 0.2) for y in (-0.3, 0.3) for z in (-0.1, 0.1)])
    with Running("Hard", pose("a", [0, 0, 0.6], turn) | {"e": 0.3}) as instance:
        energy = instance.get("totalEnergy")
        for _ in range(200):
            instance.run(instance.time + 0.02, 0.02)
            now = instance.get("totalEnergy")
            rotation = np.array([[instance.get(f"a.R{i}{j}") for j in (1, 2, 3)] for i in (1, 2, 3)])
            assert now < energy + 1e-7
            assert min(instance.get("az") + (rotation @ corner)[2] for corner in corners) > -1e-7
            energy = now
    with Running("Hard", {"az": 0.6, "e": 0.5}) as instance:
        fall = math.sqrt(2 * 0.5 / 9.81)
        instance.run(2 * fall, fall / 10)
        time = fall
        speed = 0.5 * 9.81 * fall
        assert instance.get("az") == pytest.approx(0.1 + speed * time - 9.81 / 2 * time**2, abs=1e-7)


def test_a_block_that_falls_flat():
    """From any height it rests on four corners at once: rotations by rounding cost no steps."""
    for sides in np.random.default_rng(5).uniform(0.1, 1.0, (25, 3)).round(2):
        with Running("Crate", dict(zip("ABC", sides)) | {"az": 2 * sides[0] + 1.0}) as instance:
            instance.run(1.5, 0.1)
            assert instance.get("az") == pytest.approx(sides[2] / 2, abs=1e-9)
            assert instance.fmu.getInteger(instance.vr("solverSteps"))[0] < 100


def test_friction_where_nothing_moves_along_the_normal(open_fmu):
    """Four corners press with k d each: the crate decelerates by mu N/m, or its rotation by mu N R/I."""
    pressing = 4 * 1e4 * 1e-3
    rows = open_fmu("Flat").initialize({"vx": 6.0, "vy": -8.0}).run(1, 0.25, "touch.force", "vx", "vy", "w", "x")
    for time, force, vx, vy, w, x in rows:
        slower = 0.3 * pressing / 2 * time
        assert force == pytest.approx(pressing, rel=1e-12)
        assert (vx, vy, w) == pytest.approx((0.6 * (10 - slower), -0.8 * (10 - slower), 0), abs=1e-6)
        assert x == pytest.approx(0.6 * (10 * time - slower * time / 2), abs=1e-6)
    for time, w in open_fmu("Flat").initialize({"w": 20.0}).run(1, 0.25, "w"):
        assert w == pytest.approx(20 - 0.3 * pressing * 0.2 * 2**0.5 / 0.3 * time, abs=1e-6)


def test_pressing_where_time_alone_moves_along_the_normal(open_fmu):
    """The force is k d (1 + c d') while the floor penetrates the crate, and 0 otherwise."""
    for time, force in open_fmu("Flat").initialize({"heave": 0.01, "d": 0.0, "mu": 0.0}).run(2, 0.125, "touch.force"):
        depth, rate = 0.01 * math.sin(3 * time), 0.03 * math.cos(3 * time)
        assert force == pytest.approx(max(0, 4e4 * depth * (1 + 0.5 * rate)), abs=1e-9)


BOXES = """<shape name="s" type="box" sizeX="r" sizeY="r"{}/><shape name="t" type="box" sizeX="r" sizeY="r" sizeZ="r"/>
  <contact name="q" between="s" and="t"{}/>"""


@pytest.mark.parametrize(
    "text, message",
    [
        ('<contact between="skin" and="flor" stiffness="k"/>', "there is no shape 'flor' above this <contact>; did you mean 'floor'?"),
        ('<contact name="q" between="skin"/>', "names one shape; expected and"),
        ('<contact name="q" between="skin" and="floor" creep="1"/>', "a <contact> between shapes has creep without stiffness"),
        ('<contact between="floor" and="floor2" stiffness="k"/>', "there is no <contact> between such shapes as 'floor' and 'floor2'"),
        ('<shape name="s" type="sphere"/>', "the sphere 's' has no radius"),
        ('<shape name="s" type="sphere" radius="r" sizeX="r"/>', "is a sphere, which has no sizeX"),
        (BOXES.format(' sizeZ="r"', ""), "the <contact> of the boxes 's' and 't' is rigid; expected stiffness="),
        (BOXES.format("", ' stiffness="k"'), "the box 's' has no size along z, and touches no other box"),
        ('<contact between="skin" and="skin" stiffness="k"/>', "a <contact> is between 'skin' and itself"),
        ('<contact between="skin" and="floor" stiffness="k" friction="mu" creep="0"/>', "the creep of a <contact> is 0"),
        ('<shape name="s" type="sphere" radius="r" axis="x"/>', "is a sphere, which takes no axis"),
        ('<shape name="s" type="sphere" radius="-2*r"/>', "the radius of the sphere 's' is -0.2 at the start values; expected a number above 0"),
        ('<shape name="s" type="sphere" radius="r*sqrt(mu - 1)"/>', "nan at the start values; expected a number above 0"),
        ('<shape name="s" type="capsule" radius="0" length="r"/>', "the radius of the capsule 's' is 0 at the start values; expected a number above 0"),
        ('<shape name="s" type="cylinder" radius="r" length="0"/>', "the length of the cylinder 's' is 0 at the start values; expected a number above 0"),
        ('<shape name="s" type="ellipsoid" sizeX="0" sizeY="1" sizeZ="1"/>', "the sizeX of the ellipsoid 's' is 0 at the start values; expected a number above 0"),
        ('<shape name="s" type="box" sizeX="1" sizeY="-r"/>', "the sizeY of the box 's' is -0.1 at the start values; expected none below 0"),
        ('<shape name="s" type="box" sizeX="0"/>', "the diagonal of the box 's' is 0 at the start values; expected a number above 0"),
        ('<shape name="s" in="bal" type="sphere" radius="r"/>', "there is nothing named 'bal' for this <shape>"),
        ('<contact gap="z"/>', "a <contact> has neither a name with a gap nor two shapes"),

        ('<shape name="t" type="sphere" radius="r"/><contact between="t" and="floor" stiffness="k"/>', "nothing moves 't' against 'floor'"),
        ('<shape name="wall" type="plane" axis="y"/><contact name="q" between="skin" and="wall" friction="mu"/>', "no coordinate moves 'skin' towards 'wall' or away from it, so that the force between them is not determined; expected such a coordinate, or stiffness"),
    ],
)
def test_messages(tmp_path, text, message):
    (tmp_path / "system.xml").write_text(SLOPE.replace("<experiment", f'<shape name="floor2" type="plane"/>{text}<experiment'))
    found = subprocess.run([LAGC, tmp_path / "system.xml", "-o", tmp_path / "out"], capture_output=True, text=True)
    assert found.returncode == 1 and message in found.stderr


OTHERS = {"sphere": 'type="sphere" radius="0.4"', "box": 'type="box" sizeX="1" sizeY="1" sizeZ="1"', "can": 'type="cylinder" radius="0.4" length="1"'}


@pytest.mark.parametrize("height, warns", [(0.1, True), (1.0, False)])
@pytest.mark.parametrize("other", OTHERS)
def test_centres_inside(other, height, warns, tmp_path):
    """A ball with its centre in the other shape has no normal; that shape is rotated, so that rounding must not invent one."""
    z = 0 if warns and other == "sphere" else height
    (tmp_path / "system.xml").write_text(f"""<system name="S"><coordinate name="z" velocity="v" unit="m" start="{z}"/>
    <particle name="p" mass="1" z="z"/><frame name="tilted"><rotate axis="y" angle="0.3"/></frame><shape name="ball" in="p" type="sphere" radius="0.1"/>
    <shape name="other" in="tilted" {OTHERS[other]}/><contact name="c" between="ball" and="other" stiffness="100"/></system>""")
    result = subprocess.run([LAGC, "system.xml", "-o", "out"], cwd=tmp_path, capture_output=True, text=True)
    message = "system.xml:3: warning: the distance of 'ball' and 'other' without their radii is 0 at the start values; expected a number above 0"
    assert result.returncode == 0 and (message in result.stderr) == warns


@pytest.mark.parametrize("method", ["taylor", "radau"])
@pytest.mark.parametrize("kind", OBSTACLES)
def test_centres_that_come_inside(kind, method, open_fmu):
    """
    The ball touches after a fall of 0.1 m. From then on its height above this is -h + h cos(p t) - V/p sin(p t). This ends when its centre is at the
    top of the box, 0.1 m below, or at the centre of the round obstacle, 0.2 m below.
    """
    k, m, g = 10, 2, 9.81
    depth, p = 0.1 if kind in ("Box", "Cylinder") else 0.2, math.sqrt(k / m)
    h, speed = g / p**2, math.sqrt(0.2 * g)
    after = brentq(lambda t: -h + h * math.cos(p * t) - speed / p * math.sin(p * t) + depth, 0, 0.3)
    instance = open_fmu(f"Sinking{kind}{method.title()}").initialize({"k": k})
    with instance.fails(DISCARD, "at the contact 'touch' the centre of a ball has come into the other shape, .*; expected a larger stiffness"):
        instance.run(1, 0.05)
    stopped = [text for _, _, text in instance.messages if " stopped at time " in text][0]
    assert float(stopped.split(" stopped at time ")[1].split()[0]) == pytest.approx(math.sqrt(0.2 / g) + after, abs=1e-6)
    assert stopped.endswith("; retrying will not help; restore an earlier state, and follow the last message")


def test_nearly_parallel_capsules_balance(open_fmu):
    """
    A tilt a moves the point of contact by s = d a (1 + 1/e) from the middle. d is the distance of the axes, and e = 1e-3 the squared sine of the angle
    below which it moves so. The capsule oscillates about the other one by I a'' = -m g s.
    """
    d = 0.2 - 2 * 9.81 / 1e5
    rate = math.sqrt(2 * 9.81 * d * (1 + 1e3) / 0.1)
    instance = open_fmu("Parallel").initialize({"z": d, "a": 1e-5}, tolerance=1e-10)
    for i in range(1, 6):
        instance.step(0.01)
        assert instance.get("a") == pytest.approx(1e-5 * math.cos(rate * 0.01 * i), abs=2e-8)


def test_a_capsule_comes_to_rest_on_a_parallel_one(open_fmu):
    instance = open_fmu("Parallel").initialize({"z": 0.21, "a": 0.02, "c": 2.0, "loss": 1.0}, tolerance=1e-6)
    instance.run(3.0, 0.1)
    assert instance.get("touch.force") == pytest.approx(2 * 9.81, rel=1e-5)
    assert instance.get("z", "a") == pytest.approx([0.2 - 2 * 9.81 / 1e5, 0], abs=1e-6)
