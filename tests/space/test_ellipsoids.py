"""
Ellipsoids on planes: gaps against a search for the lowest point, and a rattleback against the Newton-Euler equations, integrated by SciPy.
"""

import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import fmu
from building import LAGC, build_systems

G = 9.81
SIZES = np.array([0.2, 0.04, 0.03])  # m
YAW = 0.1  # rad, of the shell against the principal axes of inertia, which gives it a preferred direction of spin
MOMENTS = np.diag([1.5e-4, 1.5e-3, 1.55e-3])  # kg m2, of 1 kg
# The rows are the shape's own axes.
SHELL = np.diag(SIZES / 2) @ Rotation.from_euler("z", YAW).as_matrix().T

FREE = "".join(f'<coordinate name="{x}" velocity="v{x}" unit="m"/>' for x in "xyz") + "".join(
    f'<coordinate name="q{i}" velocity="r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4)
)
BODY = f"""{FREE}<frame name="f"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>
  <body name="stone" in="f" mass="1" Ixx="1.5e-4" Iyy="1.5e-3" Izz="1.55e-3"/><gravity z="-9.81"/>"""
SHAPE = '<shape name="shell" in="f" type="ellipsoid" sizeX="0.2" sizeY="0.04" sizeZ="0.03" yaw="0.1"/>'
RATTLEBACK = f"""<system name="Rattleback">{BODY}{SHAPE}<shape name="table" type="plane"/>
  <contact name="touch" between="shell" and="table" friction="10"/><experiment stopTime="2" stepSize="0.05"/></system>"""
# The plane is the first of the pair, is tilted, and has a stiffness of 1 N/m.
TILTED = f"""<system name="EggOverPlane">{BODY}{SHAPE.replace('yaw="0.1"', 'yaw="0.1" x="0.02" z="-0.01"')}
  <shape name="table" type="plane" axis="x" roll="0.3" pitch="-0.9" z="2"/>
  <contact name="touch" between="table" and="shell" stiffness="1"/><experiment stopTime="2"/></system>"""

THROWN = f"""<system name="ThrownEgg">{BODY}{SHAPE}<shape name="table" type="plane"/>
  <contact name="touch" between="shell" and="table"/><experiment stopTime="2"/></system>"""

TUMBLING = f"""<system name="TumblingEgg">{FREE}<parameter name="mu" start="1"/><frame name="f"><translate x="x" y="y" z="z"/>
  <rotate quaternion="q0 q1 q2 q3"/></frame><body name="egg" in="f" mass="1" Ixx="0.0065" Iyy="0.01" Izz="0.0125"/><gravity x="9.81*sin(0.3)" z="-9.81*cos(0.3)"/>
  <shape name="shell" in="f" type="ellipsoid" sizeX="0.4" sizeY="0.3" sizeZ="0.2"/><shape name="slope" type="plane"/>
  <contact name="touch" between="shell" and="slope" friction="mu"/><experiment stopTime="2"/></system>"""

# A tilted ground in a frame; visual planes, and further ones, have no contacts.
SCENE = """<mujoco model="eggs"><compiler angle="radian"/><worldbody>
  <geom type="plane" size="1 1 1" pos="0 0 9" contype="0" conaffinity="0"/>
  <frame pos="0.1 0 0.2" euler="0.3 -0.2 0.5"><geom type="plane" size="1 1 1" pos="0 0 -0.1" euler="0.2 0.1 0"/></frame>
  <body name="egg"><freejoint/><geom type="ellipsoid" size="0.2 0.1 0.05" pos="0.02 0 -0.01" euler="0.1 0.2 0.3"/></body>
  <body name="rod"><freejoint/><geom type="ellipsoid" size="0.05 0.1" fromto="0.1 0 0 -0.2 0.1 0.3"/>{}</body>
</worldbody></mujoco>"""
STANDING = '<system name="EggsOfMujoco"><include file="eggs.xml" as="r" ground="true"/><experiment stopTime="1"/></system>'
SECOND = '<geom type="plane" size="1 1 1"/>'


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"Rattleback": RATTLEBACK, "EggOverPlane": TILTED, "ThrownEgg": THROWN, "EggsOfMujoco": STANDING, "TumblingEgg": TUMBLING}
    build_systems("ellipsoids", texts, files={"EggsOfMujoco/eggs.xml": SCENE.format("")})


def quaternion(turn, spin=(0, 0, 0)):
    """Quaternion of a rotation, and its rate for an angular velocity along the base axes."""
    q, w = turn.as_quat()[[3, 0, 1, 2]], np.array(spin)
    rate = 0.5 * np.r_[-w @ q[1:], q[0] * w + np.cross(w, q[1:])]
    return {f"q{i}": q[i] for i in range(4)} | {f"r{i}": rate[i] for i in range(4)}


def to_contact(up):
    """Vector from the centre of the shell to its lowest point, along the body axes."""
    return -SHELL.T @ SHELL @ up / np.linalg.norm(SHELL @ up)


def rolling(_, state):
    """
    Newton-Euler equations with the force F at a contact point at rest: v = r x w, F = m (dv/dt + g up), I dw/dt + w x I w = r x F, along
    the body axes. dr/dt follows from the rate of the upward direction.
    """
    turn, w = Rotation.from_quat(state[3:7]), state[7:]
    up = turn.as_matrix()[2]
    up_rate, reach, r = np.cross(up, w), np.linalg.norm(SHELL @ up), to_contact(up)
    r_rate = -SHELL.T @ SHELL @ up_rate / reach - ((SHELL @ up) @ (SHELL @ up_rate)) / reach**2 * r
    v = np.cross(r, w)
    without = np.cross(r_rate, w) + np.cross(w, v) + G * up  # F without the part of dw/dt, r x dw/dt
    cross = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
    spin_rate = np.linalg.solve(MOMENTS - cross @ cross, np.cross(r, without) - np.cross(w, MOMENTS @ w))
    x, y, z, s = state[3:7]
    rotation_rate = 0.5 * np.array([[s, -z, y], [z, s, -x], [-y, x, s], [-x, -y, -z]]) @ w
    return np.r_[turn.apply(v), rotation_rate, spin_rate]


@pytest.mark.long
@pytest.mark.parametrize("spin", [5.0, -5.0])
def test_rattleback(spin):
    """Spun in one direction it starts to rattle and reverses; in the other it continues. It rolls without slip or dissipation."""
    turn = Rotation.from_euler("y", 0.02)
    up, w = turn.as_matrix()[2], np.array([0, 0, spin])
    start = np.r_[0, 0, np.linalg.norm(SHELL @ up), turn.as_quat(), w]
    truth = solve_ivp(rolling, (0, 1.5), start, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    velocity = turn.apply(np.cross(to_contact(up), w))
    values = dict(zip(("x", "y", "z"), start)) | dict(zip(("vx", "vy", "vz"), velocity)) | quaternion(turn, turn.apply(w))
    instance = fmu.Instance("Rattleback").initialize(values)
    energy = instance.get("totalEnergy")
    instance.run(1.5, 0.05)
    assert instance.get("x", "y", "z") == pytest.approx(list(truth[:3]), abs=1e-8)
    spins = instance.get("stone.omegaX", "stone.omegaY", "stone.omegaZ")
    assert spins == pytest.approx(list(truth[7:]), rel=1e-6)
    assert Rotation.from_quat(instance.get("q1", "q2", "q3", "q0")).apply(spins)[2] < -4
    assert instance.get("totalEnergy") == pytest.approx(energy, abs=1e-10)
    assert instance.fmu.getInteger(instance.vr("touch.friction.sliding")) == [0]
    instance.free()


def test_gap():
    """The gap agrees with a numerical search for the point of the surface nearest to the plane."""
    chance = np.random.default_rng(1)
    base = Rotation.from_euler("xyz", [0.3, -0.9, 0])
    normal = base.apply([1, 0, 0])
    for _ in range(5):
        turn = Rotation.from_quat(chance.normal(size=4))
        place = chance.normal(0, 0.1, 3)
        instance = fmu.Instance("EggOverPlane").initialize(dict(zip("xyz", place)) | quaternion(turn))

        def height(angles):
            on_ball = np.array([np.cos(angles[0]) * np.cos(angles[1]), np.sin(angles[0]) * np.cos(angles[1]), np.sin(angles[1])])
            point = place + turn.apply([0.02, 0, -0.01] + SHELL.T @ on_ball)
            return (point - [0, 0, 2]) @ normal

        least = min(minimize(height, guess, tol=1e-12).fun for guess in ([0, 0], [2, 0.5], [4, -0.5], [1, 1.2], [1, -1.2]))
        assert instance.get("touch.force") == pytest.approx(-least, abs=1e-9)
        instance.free()


def test_mjcf():
    """MuJoCo's penetration depths of ellipsoids in a tilted plane equal those of the springs."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(SCENE.format(""))
    data = mujoco.MjData(model)
    chance = np.random.default_rng(4)
    for _ in range(10):
        values, data.qpos = {}, 0
        for i, name in enumerate(("egg", "rod")):
            q = chance.normal(size=4)
            pose = np.r_[chance.normal(0, 0.1, 2), -0.05 * i, q / np.linalg.norm(q)]
            data.qpos[7 * i : 7 * i + 7] = pose
            values |= dict(zip((f"r.{name}_{part}" for part in ("x", "y", "z", "qw", "qx", "qy", "qz")), pose))
        mujoco.mj_forward(model, data)
        depths = np.zeros(2)
        for contact in data.contact[: data.ncon]:
            if min(contact.geom) < 2:  # contacts between the ellipsoids are ignored
                depths[max(contact.geom) - 2] = -contact.dist
        instance = fmu.Instance("EggsOfMujoco").initialize(values)
        forces = np.array(instance.get("r.egg_ground1.force", "r.rod_ground1.force"))
        assert np.max(depths) > 0 and forces / instance.get("r.ground_stiffness") == pytest.approx(depths, abs=1e-9)
        instance.free()


def test_planes_of_moving_bodies_touch_nothing(tmp_path):
    (tmp_path / "eggs.xml").write_text(SCENE.format(SECOND))
    (tmp_path / "system.xml").write_text(STANDING)
    found = subprocess.run([LAGC, tmp_path / "system.xml", "-o", tmp_path / "out"], capture_output=True, text=True)
    assert found.returncode == 0 and "a <geom> of type plane of the body 'rod' touches nothing; expected it in a body that does not move" in found.stderr


@pytest.mark.parametrize(
    "shapes, message",
    [
        (SHAPE.replace(' sizeY="0.04"', ""), "the ellipsoid 'shell' has no sizeY; expected sizeY=\"...\" in m"),
        (SHAPE.replace("yaw", "radius"), "the shape 'shell' is an ellipsoid, which has no radius"),
        (SHAPE + '<shape name="ball" type="sphere" radius="1"/><contact name="c" between="shell" and="ball"/>', "of which one is an ellipsoid; expected a plane for it"),
    ],
)
def test_messages(tmp_path, shapes, message):
    (tmp_path / "system.xml").write_text(f'<system name="Egg">{BODY}{shapes}</system>')
    found = subprocess.run([LAGC, tmp_path / "system.xml", "-o", tmp_path / "out"], capture_output=True, text=True)
    assert found.returncode == 1 and message in found.stderr


def flying(_, state):
    """The same without the table; state: height of the centre, its rate, the quaternion, and w."""
    x, y, z, s = state[2:6]
    w = state[6:]
    rotation_rate = 0.5 * np.array([[s, -z, y], [z, s, -x], [-y, x, s], [-x, -y, -z]]) @ w
    return np.r_[state[1], -G, rotation_rate, np.linalg.solve(MOMENTS, np.cross(MOMENTS @ w, w))]


def gap(_, state):
    return state[0] - np.linalg.norm(SHELL @ Rotation.from_quat(state[2:6]).as_matrix()[2])


gap.terminal, gap.direction = True, -1


def test_an_egg_that_lands_without_a_bounce_and_lifts_off_again():
    """
    Rotation lifts the egg off a smooth table at once. At a loose tolerance the norm of the quaternion has an error. Its correction at the impact
    moves the gap by more than rounding, to either side of 0.
    """
    random = np.random.default_rng(9)
    for _ in range(25):
        turn, spin = Rotation.random(rng=random), random.normal(0, 8, 3)
        start = np.r_[0.15, -1, turn.as_quat(), turn.inv().apply(spin)]
        landed = solve_ivp(flying, (0, 0.2), start, method="DOP853", rtol=1e-12, atol=1e-14, events=gap)
        state = landed.y_events[0][0]
        up = Rotation.from_quat(state[2:6]).as_matrix()[2]
        arm = np.cross(to_contact(up), up)
        closing = state[1] + arm @ state[6:]
        push = -closing / (1 + arm @ np.linalg.solve(MOMENTS, arm))
        instance = fmu.Instance("ThrownEgg").initialize({"z": 0.15, "vz": -1} | quaternion(turn, spin), tolerance=1e-6)
        energy = instance.get("totalEnergy")
        instance.step(landed.t_events[0][0] + 1e-4)
        assert instance.get("totalEnergy") - energy == pytest.approx(push * closing / 2, abs=1e-5)


def test_an_egg_that_rolls_down_a_slope_and_lifts_off():
    """At lift-off from sliding, force and acceleration along the normal are 0 up to rounding; then the egg flies."""
    random, parted = np.random.default_rng(3), 0
    for _ in range(40):
        start = dict(zip(("z", "vx", "vy", "vz"), np.r_[0.25, random.normal(0, 2, 2), -1])) | quaternion(Rotation.random(rng=random), random.normal(0, 5, 3))
        instance = fmu.Instance("TumblingEgg").initialize(start | {"mu": random.uniform(0.3, 1)}, tolerance=1e-6)
        energy, was_closed = instance.get("totalEnergy"), False
        for _ in range(200):
            instance.step(0.01)
            before, energy = energy, instance.get("totalEnergy")
            assert energy <= before + 1e-6
            is_closed = instance.fmu.getInteger(instance.vr("touch.closed")) == [1]
            parted += was_closed and not is_closed
            was_closed = is_closed
            assert is_closed or instance.get("der(vz)") == pytest.approx(-G * np.cos(0.3), rel=1e-12)
        instance.free()
    assert parted > 30


def test_scene():
    """modelDescription.xml has type and sizes of the shapes, for drawings."""
    shapes = ElementTree.parse(fmu.unpacked("Rattleback") / "modelDescription.xml").iter("shape")
    assert {(shape.get("type"), *(shape.get(f"size{axis}") for axis in "XYZ")) for shape in shapes} == {
        ("ellipsoid", "0.2", "0.04", "0.03"), ("plane", None, None, None)}  # fmt: skip
