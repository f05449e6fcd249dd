"""Cylinders on a plane touch it with the lowest points of their rims: closed forms of rolling, and Newton's and Euler's equations by SciPy."""

import math
import re
import subprocess

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import fmu
from building import LAGC, build_systems

pytestmark = pytest.mark.long

G, MASS, RADIUS, LENGTH = 9.81, 2.0, 0.1, 0.06
ACROSS, ALONG = MASS * (3 * RADIUS**2 + LENGTH**2) / 12, MASS * RADIUS**2 / 2  # moments of inertia
SOFT = 'stiffness="1e4" damping="0.5" friction="0.8"'
RIGID = 'restitution="0" friction="mu"'


def system(name, stands, law):
    """A free cylinder on a plane. Its axis is y at the start."""
    places = "".join(f'<coordinate name="{x}" velocity="v{x}" unit="m" start="{RADIUS if x == "z" else 0}"/>' for x in "xyz")
    quaternion = "".join(f'<coordinate name="q{i}" velocity="r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
    return f"""<system name="{name}"><parameter name="mu" start="0.8" unit="1"/><parameter name="slope" start="0" unit="rad"/>{places}{quaternion}
  <frame name="wheel"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>
  <body name="solid" in="wheel" mass="{MASS}" Ixx="{ACROSS}" Iyy="{ALONG}" Izz="{ACROSS}"/><gravity x="{G}*sin(slope)" z="-{G}*cos(slope)"/>
  <shape name="round" in="wheel" type="cylinder" axis="y" radius="{RADIUS}" length="{LENGTH}" stands="{stands}"/><shape name="floor" type="plane"/>
  <contact name="touch" between="round" and="floor" {law}/><solver tolerance="1e-9"/><experiment stopTime="1"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"RollingCan": system("RollingCan", "true", RIGID), "RollingWheel": system("RollingWheel", "false", RIGID), "SoftCan": system("SoftCan", "true", SOFT)}
    build_systems("rolling-cylinders", texts)


def start_of(rotation, spin):
    """Start values of a quaternion and its velocity, by the angular velocity along the base's axes."""
    x, y, z, w = rotation.as_quat()
    p, q, r = spin
    rates = 0.5 * np.array([-x * p - y * q - z * r, w * p + q * z - r * y, w * q + r * x - p * z, w * r + p * y - q * x])
    return dict(zip(["q0", "q1", "q2", "q3", "r0", "r1", "r2", "r3"], [w, x, y, z, *rates]))


def running(name, values, stop, step, *results):
    """Values of results at multiples of the step, and the number of events."""
    instance = fmu.Instance(name)
    try:
        instance.initialize(values)
        rows = [[instance.get(result) for result in results]]
        for i in range(round(stop / step)):
            instance.fmu.doStep(i * step, step)
            rows.append([instance.get(result) for result in results])
        return np.array(rows), instance.fmu.getInteger(instance.vr("events"))[0]
    finally:
        instance.free()


@pytest.mark.parametrize("name", ["RollingCan", "RollingWheel"])
def test_rolling_down_a_slope(name):
    """A solid cylinder has the acceleration 2/3 g sin(slope), also across the slope: no force turns it."""
    slope, heading = 0.3, 0.4
    rows, _ = running(name, {"slope": slope, **start_of(Rotation.from_euler("z", heading), (0, 0, 0))}, 1.0, 0.1, "x", "y", "z")
    way = 0.5 * 2 / 3 * G * math.sin(slope) * math.cos(heading) * np.arange(11) ** 2 * 0.01
    assert rows == pytest.approx(np.transpose([way * math.cos(heading), way * math.sin(heading), 0 * way + RADIUS]), abs=1e-9)


def arm_of(rotation):
    """The vector from the centre of the wheel to the lowest point of its lower rim."""
    axis = rotation[:, 1]
    below = np.array([0, 0, 1]) - axis[2] * axis
    return -math.copysign(LENGTH / 2, axis[2]) * axis - RADIUS * below / np.linalg.norm(below)


def rates(_, state):
    """
    Rolling: the velocity of the centre is -w x arm. The force at the rim follows from its acceleration, and its moment is that of Euler's
    equations. Both are linear in the angular acceleration.
    """
    rotation, spin = Rotation.from_quat(state[:4] / np.linalg.norm(state[:4])), state[4:7]
    matrix = rotation.as_matrix()
    arm, h = arm_of(matrix), 1e-6
    ahead, behind = (arm_of((Rotation.from_rotvec(s * h * spin) * rotation).as_matrix()) for s in (1, -1))
    arm_rate = (ahead - behind) / (2 * h)
    inertia = matrix @ np.diag([ACROSS, ALONG, ACROSS]) @ matrix.T
    cross = lambda v: np.cross(np.eye(3), v).T  # cross(v) @ u = v x u
    left = inertia + MASS * cross(arm).T @ cross(arm)
    weight = np.array([0, 0, MASS * G])
    right = np.cross(arm, weight - MASS * np.cross(spin, arm_rate)) - np.cross(spin, inertia @ spin)
    quaternion = np.concatenate([np.cross(spin, state[:3]) + state[3] * spin, [-spin @ state[:3]]]) / 2
    return np.concatenate([quaternion, np.linalg.solve(left, right), -np.cross(spin, arm)])


@pytest.mark.parametrize("name", ["RollingCan", "RollingWheel"])
@pytest.mark.parametrize("tilt, turning", [(0.45, 4.0), (0.8, 4.0), (-0.6, -4.0)])
def test_tilted_rolling(name, tilt, turning):
    """A tilted wheel rolls on one rim, and turns as it leans: its path agrees with that of Newton's and Euler's equations in SciPy."""
    rotation, spin = Rotation.from_euler("x", tilt), np.array([0.0, 18.0, turning])
    centre = -arm_of(rotation.as_matrix())
    values = {**start_of(rotation, spin), **dict(zip(["z", "vx", "vy", "vz"], [centre[2], *np.cross(spin, centre)])), "mu": 10.0}
    rows, _ = running(name, values, 0.5, 0.05, "x", "y", "z", "q0", "q1", "q2", "q3")
    start = np.concatenate([rotation.as_quat(), spin, [0, 0, centre[2]]])
    solution = solve_ivp(rates, (0, 0.5), start, rtol=1e-10, atol=1e-12, t_eval=np.arange(11) * 0.05)
    assert rows[:, :3] == pytest.approx(solution.y[7:10].T, abs=1e-6)
    assert rows[:, 3:] == pytest.approx(solution.y[[3, 0, 1, 2]].T, abs=1e-5)


def test_landing_takes_few_events():
    """A wheel that falls with its axis level lands once, on both rims, and rolls on."""
    rows, events = running("RollingWheel", {"z": 0.2, "vx": 1.0}, 1.0, 0.1, "z", "vx")
    assert rows[-1] == pytest.approx([RADIUS, 2 / 3], abs=1e-9)  # the impact's friction makes it roll with 2/3 of its velocity
    assert events <= 2


def test_standing():
    """Upright it stands on points of its end without moving, and lying it has the depth of its weight on two rims."""
    rows, _ = running("RollingCan", {"z": LENGTH / 2, **start_of(Rotation.from_euler("x", math.pi / 2), (0, 0, 0))}, 1.0, 0.1, "x", "y", "z", "q0", "q1")
    assert np.ptp(rows, axis=0) == pytest.approx(0, abs=1e-12)
    depth = MASS * G / 2 / 1e4
    rows, _ = running("SoftCan", {"z": RADIUS - depth}, 1.0, 0.1, "z", "q1", "touch.force")
    assert rows == pytest.approx(np.full((11, 3), [RADIUS - depth, 0, MASS * G]), abs=1e-9)


def test_standing_on_a_slope():
    """A compliant can on a slope below its friction's stays upright and creeps: by the regularized law with v = creep r/sqrt(1 - r^2)."""
    share = 0.9  # r: of the friction that the slope needs
    values = {"slope": math.atan(share * 0.8), "z": LENGTH / 2 - 2e-4, **start_of(Rotation.from_euler("x", math.pi / 2), (0, 0, 0))}
    rows, events = running("SoftCan", values, 1.0, 0.1, "x", "q0", "q1", "q2")
    speed = 1e-3 * share / math.sqrt(1 - share**2)
    assert np.diff(rows[5:, 0]) == pytest.approx(0.1 * speed, rel=0.02)
    assert np.max(np.abs(2 * (rows[:, 1] * rows[:, 3]))) < 1e-3 and events < 20


@pytest.mark.parametrize("tilt", [0.0, 0.2, 0.8])
def test_a_wheel_falls_on_its_side(tilt):
    """It rocks on the middle of its end, where its rims have no lowest point, without energy from nothing."""
    values = {"z": 0.13, **start_of(Rotation.from_euler("x", math.pi / 2 - tilt), (0, 0, 0))}
    rows, _ = running("RollingWheel", values, 1.5, 0.01, "totalEnergy", "z")
    assert np.max(np.diff(rows[:, 0])) < 1e-8 and np.min(rows[:, 1]) > LENGTH / 2


def test_tipping():
    """A can that is thrown lands on an edge, turns over it and rolls: energy never grows, and no rim was below the floor."""
    rows, _ = running("RollingCan", {"z": 0.2, **start_of(Rotation.from_euler("x", math.pi / 2 - 0.4), (-9.0, 0, 0))}, 3.0, 0.01, "totalEnergy", "z", "q0", "q1", "q2", "q3")
    assert np.max(np.diff(rows[:, 0])) < 1e-8
    for _, z, w, x, y, q in rows:
        matrix = Rotation.from_quat([x, y, q, w]).as_matrix()
        lowest = z - LENGTH / 2 * abs(matrix[2, 1]) - RADIUS * math.sqrt(max(1 - matrix[2, 1] ** 2, 0))
        assert lowest > -1e-9


def indicators_of_car(folder, kind, angle):
    """The number of event indicators of a URDF with a cylinder, at an angle to y, that turns about y."""
    inertial = '<inertial><mass value="1"/><inertia ixx="1e-2" ixy="0" ixz="0" iyy="1e-2" iyz="0" izz="1e-2"/></inertial>'
    round = f'<collision><origin rpy="{angle} 0 0"/><geometry><cylinder radius="0.1" length="0.05"/></geometry></collision>'
    limit = '<limit lower="-9" upper="9" effort="1" velocity="1"/>' if kind == "revolute" else ""
    joint = f'<joint name="hub" type="{kind}"><parent link="cart"/><child link="wheel"/><axis xyz="0 1 0"/>{limit}</joint>'
    (folder / "car.urdf").write_text(f'<robot name="Car"><link name="cart">{inertial}</link><link name="wheel">{inertial}{round}</link>{joint}</robot>')
    words = [word for option in ("base=floating", "ground=true") for word in ("--robot", option)]
    done = subprocess.run([LAGC, folder / "car.urdf", *words, "-o", folder], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return int(re.search(r'numberOfEventIndicators="(\d+)"', (folder / "modelDescription.xml").read_text())[1])


def test_wheels_of_a_urdf(tmp_path):
    """A cylinder about the axis of a joint without limits touches with its rims alone. Each of 16 other points has two indicators, and the tilt and the reach have one each."""
    wheel = indicators_of_car(tmp_path, "continuous", math.pi / 2)
    assert indicators_of_car(tmp_path, "revolute", math.pi / 2) == indicators_of_car(tmp_path, "continuous", 0) == wheel + 34
