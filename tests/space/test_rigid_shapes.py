"""Rigid contacts of shapes with friction: closed forms of rolling, sliding, stopping, sticking and tipping, and conserved quantities."""

import math
import subprocess

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import fmu
from building import LAGC, build_systems

pytestmark = pytest.mark.long

G = 9.81
HEAD = """<parameter name="m" start="2" unit="kg"/><parameter name="r" start="0.1" unit="m"/><parameter name="mu" start="0.3" unit="1"/>
  <parameter name="stick" start="1" unit="1"/><parameter name="e" start="0" unit="1"/><parameter name="slope" start="0" unit="rad"/>"""
BALL = 'Ixx="0.4*m*r^2" Iyy="0.4*m*r^2" Izz="0.4*m*r^2"'
BOX = 'Ixx="m*(B^2+C^2)/12" Iyy="m*(A^2+C^2)/12" Izz="m*(A^2+B^2)/12"'
CONTACT = '<contact name="touch" between="{}" and="{}" restitution="e" friction="mu" stiction="stick*mu"/>'


def free(name, inertia, height):
    """A freely moving frame with a body."""
    quaternion = " ".join(f'<coordinate name="{name}q{i}" velocity="{name}r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
    places = " ".join(f'<coordinate name="{name}{x}" velocity="{name}v{x}" unit="m" start="{height if x == "z" else 0}"/>' for x in "xyz")
    return f"""{places}{quaternion}
  <frame name="{name}"><translate x="{name}x" y="{name}y" z="{name}z"/><rotate quaternion="{name}q0 {name}q1 {name}q2 {name}q3"/></frame>
  <body name="{name}Body" in="{name}" mass="m" {inertia}/>"""


WEIGHT = '<gravity x="9.81*sin(slope)" z="-9.81*cos(slope)"/>'
# The plane is the first of the pair; its normal is its x axis, rotated up, and its tangents are rotated by an angle.
ON_PLANE = f"""<system name="OnPlane">{HEAD}<parameter name="turned" start="0" unit="rad"/>{free("a", BALL, "r")}{WEIGHT}
  <shape name="floor" type="plane" axis="x" roll="turned" pitch="-pi/2"/><shape name="ball" in="a" type="sphere" radius="r"/>
  {CONTACT.format("floor", "ball")}<experiment stopTime="2" stepSize="0.01"/></system>"""
SIDES = "".join(f'<parameter name="{side}" start="{size}" unit="m"/>' for side, size in zip("ABC", (0.4, 0.6, 0.2)))
CRATE = f"""<system name="RigidCrate">{HEAD}{SIDES}{free("a", BOX, "C/2")}{WEIGHT}
  <parameter name="shake" start="0" unit="m"/><frame name="plate"><translate x="shake*sin(10*time)"/></frame>
  <shape name="box" in="a" type="box" sizeX="A" sizeY="B" sizeZ="C"/><shape name="floor" in="plate" type="plane"/>
  {CONTACT.format("box", "floor")}<experiment stopTime="2" stepSize="0.01"/></system>"""
BALLS = f"""<system name="TwoBalls">{HEAD}{free("a", BALL, "r")}{free("b", BALL, "0")}
  <shape name="one" in="a" type="sphere" radius="r"/><shape name="other" in="b" type="sphere" radius="r"/>
  {CONTACT.format("one", "other")}<solver tolerance="1e-10"/><experiment stopTime="2" stepSize="0.01"/></system>"""
ON_BALL = f"""<system name="OnBall">{HEAD}{free("a", BALL, "0.6")}{WEIGHT}
  <shape name="ball" in="a" type="sphere" radius="r"/><shape name="hill" type="sphere" radius="0.5"/>
  {CONTACT.format("hill", "ball")}<solver tolerance="1e-10"/><experiment stopTime="2" stepSize="0.01"/></system>"""

# One component of its friction is 0.
IN_PLANE = f"""<system name="InPlane">{HEAD}<coordinate name="x" velocity="vx" unit="m"/><coordinate name="z" velocity="vz" unit="m" start="r"/>
  <coordinate name="phi" velocity="w" unit="rad"/><frame name="f"><translate x="x" z="z"/><rotate axis="y" angle="phi"/></frame>
  <body name="solid" in="f" mass="m" {BALL}/>{WEIGHT}
  <shape name="ball" in="f" type="sphere" radius="r"/><shape name="floor" type="plane"/>
  {CONTACT.format("ball", "floor")}<experiment stopTime="2" stepSize="0.01"/></system>"""
# Its two lower corners slide along one line, so that one of them alone could carry the friction.
BOX_IN_PLANE = f"""<system name="BoxInPlane">{HEAD}{SIDES}<parameter name="tilt" start="0" unit="rad/s"/>
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="z" velocity="vz" unit="m" start="C/2"/><coordinate name="phi" velocity="w" unit="rad"/>
  <frame name="f"><translate x="x" z="z"/><rotate axis="y" angle="phi"/></frame><body name="solid" in="f" mass="m" {BOX}/>
  <force on="solid" x="m*9.81*sin(slope + tilt*time)" z="-m*9.81*cos(slope + tilt*time)"/>
  <shape name="box" in="f" type="box" sizeX="A" sizeZ="C"/><shape name="floor" type="plane"/>
  {CONTACT.format("box", "floor")}<experiment stopTime="2" stepSize="0.01"/></system>"""
# A ball whose centre of mass is below its centre.
TOP = f"""<system name="TippeTop">{HEAD}{free("a", BALL, "r").replace("<body", '<body z="-0.15*r"')}{WEIGHT}
  <shape name="ball" in="a" type="sphere" radius="r"/><shape name="floor" type="plane"/>
  {CONTACT.format("ball", "floor")}<experiment stopTime="2" stepSize="0.01"/></system>"""
CRADLE = f"""<system name="Cradle3D">{HEAD}<for index="i" from="1" to="4"><coordinate name="x[i]" velocity="vx[i]" unit="m" start="0.2*i"/>
  <coordinate name="y[i]" velocity="vy[i]" unit="m"/><coordinate name="z[i]" velocity="vz[i]" unit="m"/>
  <particle name="p[i]" mass="m" x="x[i]" y="y[i]" z="z[i]"/><shape name="s[i]" in="p[i]" type="sphere" radius="r"/></for>
  <for index="i" from="2" to="4"><contact name="c[i]" between="s[i]" and="s[i-1]" restitution="e" friction="mu"/></for>
  <experiment stopTime="2" stepSize="0.01"/></system>"""


def column(boxes):
    """Boxes stacked on each other; the sole of each stands on a plane at the top of the one below."""
    every = "".join(
        free(f"b{k}", BOX, f"{k - 0.5}*C")
        + f'''<shape name="sole{k}" in="b{k}" type="box" sizeX="A" sizeY="B" z="-C/2"/><shape name="top{k}" in="b{k}" type="plane" z="C/2"/>
  {CONTACT.format(f"sole{k}", f"top{k - 1}").replace("touch", f"c{k}")}'''
        for k in range(1, boxes + 1)
    )
    return f"""<system name="Column{boxes}">{HEAD}{SIDES}{WEIGHT}<shape name="top0" type="plane"/>{every}<experiment stopTime="2"/></system>"""
# A stone near the ball: their distance contains a square root, so that the search for events bounds its intervals.
BESIDE_STONE = ON_PLANE.replace("OnPlane", "BesideStone").replace("<experiment", """<coordinate name="h" velocity="vh" unit="m" start="3"/>
  <particle name="stone" mass="m" x="0.5" y="1" z="h"/><shape name="pebble" in="stone" type="sphere" radius="r"/>
  <contact name="hit" between="ball" and="pebble"/><solver tolerance="1e-8"/><experiment""")


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"BesideStone": BESIDE_STONE, "OnPlane": ON_PLANE, "RigidCrate": CRATE, "TwoBalls": BALLS, "OnBall": ON_BALL, "InPlane": IN_PLANE, "BoxInPlane": BOX_IN_PLANE, "TippeTop": TOP, "Cradle3D": CRADLE}
    build_systems("rigid-shapes", texts | {"Column2": column(2)})


@pytest.fixture(scope="module")
def column_of_five():
    build_systems("rigid-column", {"Column5": column(5)})


class Running:
    """Context manager that frees the FMU."""

    def __init__(self, name, values):
        self.instance = fmu.Instance(name)
        self.values = values

    def __enter__(self):
        return self.instance.initialize(self.values)

    def __exit__(self, *_):
        self.instance.free()


def whole(instance, *names):
    return instance.fmu.getInteger(instance.vr(*names))


def pose(name, turn, spin=(0, 0, 0)):
    """Quaternion of a rotation, and its rate for an angular velocity along the base axes."""
    q = turn.as_quat()[[3, 0, 1, 2]]
    w = np.array(spin)
    rate = 0.5 * np.r_[-w @ q[1:], q[0] * w + np.cross(w, q[1:])]
    return {f"{name}q{i}": q[i] for i in range(4)} | {f"{name}r{i}": rate[i] for i in range(4)}


def rotation(instance, name):
    return np.array([[instance.get(f"{name}.R{i}{j}") for j in (1, 2, 3)] for i in (1, 2, 3)])


@pytest.mark.parametrize("rotated", [0.0, 0.7])
def test_thrown_ball(rotated):
    """
    The path is a parabola until the ball rolls, with 5/7 of its velocity and 2/7 of that of rolling with its spin (CueBall of the
    reference).
    """
    r, mu, speed, spin = 0.1, 0.3, np.array([1.0, 0.4]), np.array([3.0, -8.0])
    with Running("OnPlane", {"avx": speed[0], "avy": speed[1], "turned": rotated} | pose("a", Rotation.identity(), [*spin, 5.0])) as instance:
        rolling = r * np.array([spin[1], -spin[0]])
        slip = speed - rolling
        end = 2 * np.linalg.norm(slip) / (7 * mu * G)
        direction = slip / np.linalg.norm(slip)
        instance.run(end / 2, 0.01)
        assert math.hypot(instance.get("touch.friction.force"), instance.get("touch.friction.across.force")) == pytest.approx(mu * 2 * G)
        assert whole(instance, "touch.friction.sliding", "touch.closed") == [1, 1]
        instance.run(1.5, 0.01)
        final = 5 / 7 * speed + 2 / 7 * rolling
        place = speed * end - mu * G * direction * end**2 / 2 + final * (1.5 - end)
        assert [instance.get("avx"), instance.get("avy")] == pytest.approx(final, abs=1e-9)
        assert [instance.get("ax"), instance.get("ay")] == pytest.approx(place, abs=1e-9)
        assert whole(instance, "touch.friction.sliding") == [0]


@pytest.mark.parametrize("name, velocity", [("OnPlane", "avx"), ("InPlane", "vx")])
def test_ball_on_a_slope(name, velocity):
    """It rolls exactly if mu >= 2/7 tan(slope), without creep."""
    slope = 0.3
    for mu, rolls in ((2 / 7 * math.tan(slope) * 1.001, True), (2 / 7 * math.tan(slope) * 0.999, False)):
        with Running(name, {"mu": mu, "slope": slope}) as instance:
            instance.run(1.0, 0.1)
            expected = 5 / 7 * G * math.sin(slope) if rolls else G * (math.sin(slope) - mu * math.cos(slope))
            assert instance.get(velocity) == pytest.approx(expected, rel=1e-10)
            assert whole(instance, "touch.friction.sliding") == [0 if rolls else 1]


def test_ball_that_falls_along_a_slope():
    """From rest above the slope: during the flight friction has no effect at any speed."""
    slope, time = -0.5, 0.45
    with Running("OnPlane", {"slope": slope, "turned": 1, "az": 1.1}) as instance:
        instance.run(time, 0.1)
        fall = G * time**2 / 2
        assert instance.get("ax", "az") == pytest.approx([math.sin(slope) * fall, 1.1 - math.cos(slope) * fall], rel=1e-12)


def test_box_that_slides_and_stops():
    """
    It stops after v^2/(2 mu g) without rotation. The moment of friction changes the forces at the corners; at rest these share the weight.
    """
    m, mu, speed, sizes = 2.0, 0.3, np.array([1.0, 0.5]), np.array([0.4, 0.6, 0.2])
    corners = np.array([[x, y] for y in (-1, 1) for x in (-1, 1)]) * sizes[:2] / 2
    with Running("RigidCrate", {"avx": speed[0], "avy": speed[1]}) as instance:
        # Forces of least norm: n = a + b x + c y, whose moments balance those of the friction about the centre.
        slowing = mu * G * speed / np.linalg.norm(speed)
        slopes = [m * slowing[i] * sizes[2] / 2 / (corners[:, i] @ corners[:, i]) for i in (0, 1)]
        forces = m * G / 4 + corners @ np.array(slopes)
        assert [instance.get(f"touch[{i}].force") for i in (1, 2, 3, 4)] == pytest.approx(forces, rel=1e-9)
        instance.run(2.0, 0.1)
        assert [instance.get("ax"), instance.get("ay"), instance.get("az")] == pytest.approx([*(speed * 0.5 * np.linalg.norm(speed) / (mu * G)), 0.1], abs=1e-9)
        assert [instance.get(f"touch[{i}].force") for i in range(1, 9)] == pytest.approx([m * G / 4] * 4 + [0] * 4, rel=1e-9, abs=1e-12)
        before = [instance.get(name) for name in ("ax", "ay", "az", "aq1", "aq2", "aq3")]
        instance.run(100.0, 1.0)
        assert [instance.get(name) for name in ("ax", "ay", "az", "aq1", "aq2", "aq3")] == pytest.approx(before, abs=1e-10)


@pytest.mark.parametrize("stick, height", [(1.0, 0.2), (1.2, 1e-4)])
def test_box_on_a_slope(stick, height):
    """It sticks up to tan(slope) equal to the coefficient of stiction, and slides beyond."""
    for factor, slides in ((0.999, False), (1.001, True)):
        slope = math.atan(0.3 * stick * factor)
        with Running("RigidCrate", {"slope": slope, "stick": stick, "C": height, "az": height / 2}) as instance:
            instance.run(1.0, 0.1)
            expected = G * (math.sin(slope) - 0.3 * math.cos(slope)) if slides else 0.0
            assert instance.get("avx") == pytest.approx(expected, rel=1e-9, abs=1e-12)
            assert instance.get("az") == pytest.approx(height / 2, abs=1e-12)


@pytest.mark.parametrize("slope, mu, speed", [(0.3, 0.32, 0), (0.3, 0.5, 0), (0.3, 2, 0), (0.2, 0.25, 0), (0.2, 0.32, 0.5), (-0.2, 0.32, -0.5)])
def test_box_in_a_plane_on_a_slope(slope, mu, speed):
    """
    It stands, or comes to rest, if tan(slope) < mu and tan(slope) < width/height. Half of the friction nevertheless exceeds the limit of the corner
    with less load.
    """
    m, width, height = 2.0, 0.2, 0.6
    with Running("BoxInPlane", {"slope": slope, "mu": mu, "A": width, "C": height, "z": height / 2, "vx": speed}) as instance:
        instance.run(1.0, 0.1)
        stops = speed * abs(speed) / (2 * G * (mu * math.cos(slope) - abs(math.sin(slope))))
        assert instance.get("x", "vx", "z", "phi", "w") == pytest.approx([stops, 0, height / 2, 0, 0], abs=1e-9)
        weight, moment = m * G * math.cos(slope), m * G * math.sin(slope) * height / 2
        forces = np.array([instance.get(f"touch[{i}].force", f"touch[{i}].friction.force") for i in (1, 2)])
        assert forces[:, 0] == pytest.approx([weight / 2 - moment / width, weight / 2 + moment / width], rel=1e-9)
        assert forces[:, 1].sum() == pytest.approx(m * G * math.sin(slope), rel=1e-9)
        assert np.all(abs(forces[:, 1]) <= mu * forces[:, 0] * (1 + 1e-9))


def test_box_in_a_plane_on_a_slope_that_tilts():
    """It starts to slide exactly at tan(slope) = mu."""
    tilt, mu, time = 0.1, 0.32, 4.0
    with Running("BoxInPlane", {"tilt": tilt, "mu": mu, "A": 0.2, "C": 0.6, "z": 0.3}) as instance:
        instance.run(time, 0.1)
        first, last = math.atan(mu), tilt * time
        path = math.sin(first) - math.sin(last) + math.cos(first) * (last - first)
        path += mu * (math.cos(last) - math.cos(first) + math.sin(first) * (last - first))
        assert instance.get("x", "phi") == pytest.approx([G / tilt**2 * path, 0], rel=1e-8, abs=1e-9)


def test_box_that_tips_over():
    """It tips once tan(slope) > width/height, as a pendulum about the edge."""
    width, height = 0.4, 0.8
    sizes = {"A": width, "C": height, "az": height / 2, "mu": 2.0}
    with Running("RigidCrate", sizes | {"slope": math.atan(0.5) - 1e-3}) as instance:
        instance.run(1.0, 0.1)
        assert abs(instance.get("aq2")) < 1e-12
    slope = math.atan(0.5) + 1e-3
    with Running("RigidCrate", sizes | {"slope": slope}) as instance:
        energy = instance.get("totalEnergy")
        instance.run(1.0, 0.01)
        arm, diagonal = math.hypot(width, height) / 2, math.atan2(width, height)
        rotated = 2 * math.asin(instance.get("aq2"))
        inertia = 2 * (width**2 + height**2) / 3
        fall = 2 * G * arm * (math.cos(diagonal - slope) - math.cos(rotated - diagonal + slope))
        speed = 2 * instance.get("ar2") / instance.get("aq0")
        assert 0.01 < rotated and speed == pytest.approx(math.sqrt(2 * fall / inertia), rel=1e-6)
        assert instance.get("totalEnergy") == pytest.approx(energy, rel=1e-9)
        assert whole(instance, *[f"touch[{i}].closed" for i in (1, 2, 3, 4)]) == [0, 1, 0, 1]


def test_rocking_block():
    """
    Housner's block in space: when the supporting edge changes, the angular velocity is multiplied by 1 - 1.5 sin(a)^2, where tan(a) =
    width/height.
    """
    width, height = 0.2, 0.8
    a, start = math.atan2(width, height), 0.1
    arm = math.hypot(width, height) / 2
    turn = Rotation.from_euler("y", start)
    place = turn.apply([-width / 2, 0, height / 2]) + np.array([width / 2, 0, 0])
    with Running("RigidCrate", {"A": width, "C": height, "mu": 10.0, "ax": place[0], "az": place[2]} | pose("a", turn)) as instance:
        speeds = []
        while len(speeds) < 3 and instance.time < 5:
            before, energy = instance.get("aq2"), instance.get("totalEnergy")
            instance.run(instance.time + 0.005, 0.005)
            if before * instance.get("aq2") < 0:
                lost = instance.get("totalEnergy") - 2 * G * height / 2
                speeds.append((energy - 2 * G * height / 2, lost))
        top = 2 * G * arm * (math.cos(a - start) - math.cos(a))
        factor = 1 - 1.5 * math.sin(a) ** 2
        for k, (before, after) in enumerate(speeds):
            assert [before, after] == pytest.approx([top * factor ** (2 * k), top * factor ** (2 * k + 2)], rel=1e-6)
        assert len(speeds) == 3


def test_ball_rolls_off_a_ball():
    """
    Rolling without slipping it leaves a fixed ball at cos = 10/17 of that at the start. The direction is arbitrary: the axes of the friction do not matter.
    """
    start = 0.1
    for way in (0.0, 2.0):
        place = 0.6 * np.array([math.sin(start) * math.cos(way), math.sin(start) * math.sin(way), math.cos(start)])
        with Running("OnBall", {"mu": 1e4} | dict(zip(("ax", "ay", "az"), place))) as instance:
            energy = instance.get("totalEnergy")
            while whole(instance, "touch.closed") == [1]:
                instance.run(instance.time + 1e-3, 1e-3)
            # It has flown for less than 1 ms.
            assert 0.0 < 10 / 17 * math.cos(start) - instance.get("az") / 0.6 < 3e-3
            assert instance.get("ay") / instance.get("ax") == pytest.approx(math.tan(way), abs=1e-9)
            assert instance.get("totalEnergy") == pytest.approx(energy, abs=1e-6)


def test_balls_that_meet():
    """
    Oblique impact with spins: momentum and angular momentum are conserved, energy decreases; sticking balls separate rolling on each other.
    """
    values = {"ax": -1.0, "az": 0.0, "by": 0.1, "bz": 0.05, "avx": 2.0, "e": 0.5} | pose("a", Rotation.from_euler("x", 1.0), [6, 3, 5])
    values |= pose("b", Rotation.from_euler("y", 0.5), [0, 4, -2])
    for mu, sticks in ((0.1, False), (2.0, True)):
        with Running("TwoBalls", values | {"mu": mu}) as instance:
            momenta = []
            for time in (0.01, 1.0):
                instance.run(time, 0.01)
                linear, angular, energy, rims = np.zeros(3), np.zeros(3), 0.0, []
                for name in "ab":
                    place, speed = (np.array([instance.get(f"{name}{part}{axis}") for axis in "xyz"]) for part in ("", "v"))
                    spin = rotation(instance, name) @ np.array([instance.get(f"{name}Body.omega{axis}") for axis in "XYZ"])
                    linear += 2 * speed
                    angular += np.cross(place, 2 * speed) + 0.008 * spin
                    energy += speed @ speed + 0.004 * spin @ spin
                    rims.append((place, speed, spin))
                momenta.append((*linear, *angular, energy))
            assert momenta[1][:6] == pytest.approx(momenta[0][:6], abs=1e-12) and momenta[1][6] < 0.95 * momenta[0][6]
            # The balls separated 1 - t before the end. At that time their distance was the sum of the radii, which gives t.
            (a, va, wa), (b, vb, wb) = rims
            away, speed = a - b, va - vb
            back = np.roots([speed @ speed, -2 * speed @ away, away @ away - 0.04]).real.min()
            normal = (away - speed * back) / np.linalg.norm(away - speed * back)
            slip = speed - np.cross(wa + wb, 0.1 * normal)
            slip -= (slip @ normal) * normal
            assert (np.linalg.norm(slip) < 1e-9) == sticks


@pytest.mark.parametrize("seed", range(4))
def test_dice(seed):
    """Thrown with spin it tumbles, loses energy at each impact, and comes to rest on a face."""
    chance = np.random.default_rng(seed)
    mu, e = [(0.3, 0.0), (1.0, 0.3), (0.1, 0.5), (0.6, 0.4)][seed]
    turn = Rotation.from_quat(chance.normal(size=4))
    values = {"A": 0.2, "B": 0.2, "C": 0.2, "az": 0.5, "mu": mu, "e": e, "avx": chance.uniform(-2, 2)} | pose("a", turn, chance.normal(0, 8, 3))
    with Running("RigidCrate", values) as instance:
        energy = instance.get("totalEnergy")
        while instance.time < 4:
            instance.run(instance.time + 0.02, 0.02)
            assert instance.get("totalEnergy") < energy + 1e-9
            energy = instance.get("totalEnergy")
        assert energy == pytest.approx(2 * G * 0.1, abs=1e-9)
        assert sorted(abs(rotation(instance, "a")[2])) == pytest.approx([0, 0, 1], abs=1e-9)
        assert sum(whole(instance, *[f"touch[{i}].closed" for i in range(1, 9)])) == 4


@pytest.mark.parametrize("seed", range(12))
def test_hostile_starts(seed):
    """
    Boxes start on a corner, an edge or a face, without friction or with very much. Energy never grows, or the simulation fails with the cause.
    """
    chance = np.random.default_rng(seed)
    turn = [Rotation.from_euler("zyx", [chance.uniform(0, 6), *angles]) for angles in (chance.uniform(0.1, 1.4, 2), (chance.uniform(0.1, 1.4), 0), (0, 0))][seed % 3]
    corners = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
    values = {"A": 0.2, "B": 0.2, "C": 0.2, "az": -turn.apply(corners)[:, 2].min(), "mu": [0.0, 10.0][seed // 3 % 2], "e": [0.0, 1.0][seed // 6]}
    instance = fmu.Instance("RigidCrate")
    try:
        instance.initialize(values | pose("a", turn, chance.normal(0, 2, 3)) | {"avx": chance.normal()})
        energy = instance.get("totalEnergy")
        while instance.time < 1:
            instance.run(instance.time + 0.05, 0.05)
            assert instance.get("totalEnergy") < energy + 1e-9
            energy = instance.get("totalEnergy")
    except FMICallException:
        reasons = " ".join(message[2] for message in instance.messages)
        assert values["mu"] > 1 and any(words in reasons for words in ("solution, as", "without end", "accelerations do not exist")), reasons
    instance.free()


@pytest.mark.parametrize("slip", [0.02, 0.0])
def test_tippe_top(slip):
    """
    The spin inverts the top and dissipates energy. Jellett's integral is conserved: the angular momentum times the vector from the centre of mass to
    the contact point.
    """
    m, r, moment = 1.0, 0.02, 0.4 * 0.02**2
    values = {"m": m, "r": r, "az": r, "mu": 0.1, "avy": slip} | pose("a", Rotation.from_euler("x", 0.3), [0, 0, 150.0])
    with Running("TippeTop", values) as instance:
        jellett, energies, ups = [], [], []
        for time in np.arange(1, 31) * 0.1:
            instance.run(time, 0.1)
            matrix = rotation(instance, "a")
            angular = moment * matrix @ np.array([instance.get(f"aBody.omega{axis}") for axis in "XYZ"])
            jellett.append(angular @ (matrix @ [0, 0, 0.15 * r] - [0, 0, r]))
            energies.append(instance.get("totalEnergy"))
            ups.append(matrix[2, 2])
        assert jellett == pytest.approx([jellett[0]] * len(jellett), rel=1e-9)
        assert np.all(np.diff(energies) < 1e-9) and energies[-1] < 0.8 * energies[0]
        assert ups[0] > 0.9 and ups[-1] < -0.9


def test_row_of_balls():
    """A ball that hits a row of equal touching balls passes its velocity to the last and stops, for any direction of the row."""
    way = np.array([2.0, -1.0, 2.0]) / 3
    values = {f"{x}[{i}]": 0.2 * i * way[k] for i in (2, 3, 4) for k, x in enumerate("xyz")}
    values |= {f"{x}[1]": -0.3 * way[k] for k, x in enumerate("xyz")} | {f"v{x}[1]": way[k] for k, x in enumerate("xyz")}
    with Running("Cradle3D", values | {"e": 1.0}) as instance:
        instance.run(2.0, 0.1)
        for i in (1, 2, 3, 4):
            assert [instance.get(f"v{x}[{i}]") for x in "xyz"] == pytest.approx(way * (i == 4), abs=1e-12)


@pytest.mark.parametrize("mu, shake", [(0.3, 0.05), (1.0, 0.1)])
def test_box_on_a_shaken_plate(mu, shake):
    """
    All corners reach their friction limit together, when the plate's acceleration exceeds mu g; the box slides until the velocities are
    equal, and sticks again.
    """
    speed = lambda t: 10 * shake * math.cos(10 * t)
    begins = math.asin(mu * G / (100 * shake)) / 10
    slides = lambda t: speed(begins) - mu * G * (t - begins)
    ends = brentq(lambda t: speed(t) - slides(t), begins + 0.01, begins + 0.35)
    with Running("RigidCrate", {"mu": mu, "shake": shake, "avx": speed(0)}) as instance:
        for time, velocity in ((begins / 2, speed), ((begins + ends) / 2, slides), (ends + 0.01, speed)):
            instance.run(time, 0.1)
            assert instance.get("avx") == pytest.approx(velocity(time), rel=1e-9)


def check_column(boxes, time):
    """Check that at rest each corner carries a quarter of the weight above, without creep."""
    places = [f"b{k}{x}" for k in range(1, boxes + 1) for x in ("x", "y", "z", "q1", "q2", "q3")]
    with Running(f"Column{boxes}", {"mu": 0.5}) as instance:
        before = [instance.get(name) for name in places]
        instance.run(time, time / 10)
        assert [instance.get(name) for name in places] == pytest.approx(before, abs=1e-9)
        for k in range(1, boxes + 1):
            assert [instance.get(f"c{k}[{i}].force") for i in (1, 2, 3, 4)] == pytest.approx([(boxes - k + 1) * 2 * G / 4] * 4, rel=1e-9)


def test_column():
    """Also on a slope; and the upper box, thrown along the lower one, stops after the distance given by friction."""
    check_column(2, 10.0)
    with Running("Column2", {"mu": 0.5, "slope": 0.4}) as instance:
        instance.run(1.0, 0.1)
        assert [instance.get(f"b{k}v{x}") for k in (1, 2) for x in "xyz"] == pytest.approx([0] * 6, abs=1e-12)
    with Running("Column2", {"mu": 0.1, "b2vx": 0.2}) as instance:
        # The upper box decelerates by mu g; the lower one stays, since two weights press it to the ground.
        instance.run(1.0, 0.1)
        assert [instance.get("b1x"), instance.get("b2x")] == pytest.approx([0, 0.2**2 / (2 * 0.1 * G)], abs=1e-9)


@pytest.mark.release
def test_column_of_five(column_of_five):
    """A column of five stays at rest for 100 s."""
    check_column(5, 100.0)


@pytest.mark.parametrize(
    "attributes, message",
    [
        ('name="q" stiction="1"', "a <contact> has stiction without friction; expected friction"),
        ('name="q" friction="mu" stiffness="1e5" stiction="1"', "a <contact> has both stiffness and stiction; expected creep"),
        ('name="q" friction="mu" creep="1e-3"', "a <contact> between shapes has creep without stiffness"),
        ('friction="mu"', "a rigid <contact> has no name"),
    ],
)
def test_messages(tmp_path, attributes, message):
    (tmp_path / "system.xml").write_text(ON_BALL.replace("<solver", f'<contact between="ball" and="hill" {attributes}/><solver'))
    found = subprocess.run([LAGC, tmp_path / "system.xml", "-o", tmp_path / "out"], capture_output=True, text=True)
    assert found.returncode == 1 and message in found.stderr


@pytest.mark.parametrize("v, mu", [(1, 0.1), (2.5, 0.1), (0.4, 0.3)])
def test_ball_that_begins_to_roll_beside_a_stone(v, mu):
    """It slides until 2 v/(7 mu g), and then rolls at 5/7 v."""
    with Running("BesideStone", {"mu": mu, "avx": 0.6 * v, "avy": 0.8 * v}) as instance:
        instance.step(2 * v / (7 * mu * G) + 0.01)
        assert instance.get("avx", "avy") == pytest.approx([5 / 7 * 0.6 * v, 5 / 7 * 0.8 * v], rel=1e-7)


@pytest.mark.parametrize("side, count", [("", 4), ('sizeY="0"', 4), ('sizeY="0.0"', 4), ('sizeY="0.1"', 8)])
def test_flat_boxes_touch_at_four_vertices(side, count, tmp_path):
    """A side of 0 is the same whether it is written or left out."""
    (tmp_path / "system.xml").write_text(BOX_IN_PLANE.replace('sizeX="A"', f'sizeX="A" {side}'))
    result = fmu.lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out" / "modelDescription.xml").read_text().count('.closed"') == count


@pytest.mark.parametrize("name", ["touch.force", "touch.friction.force"])
def test_forces_of_several_points_need_an_index(name, tmp_path):
    item, text = name.replace(".", "[{}].", 1), BOX_IN_PLANE.replace("</system>", f'<output name="o">{name}</output></system>')
    (tmp_path / "system.xml").write_text(text)
    result = fmu.lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1
    assert f"unknown name '{name}'; expected {item.format(1)}, ..., {item.format(4)}, or sum(i, 1, 4, {item.format('i')})" in result.stderr
