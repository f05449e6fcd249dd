"""
Bodies on two points of a line, whose frictions along the line are indeterminate one by one. They stick if any forces in the Coulomb cones carry the
load, however it is shared.
"""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import fmu
from building import build_systems

pytestmark = pytest.mark.long

M, G, SLOPE = 2.0, 9.81, 0.3
HEAD = f"""<parameter name="mu" start="0.3" unit="1"/><gravity x="{G}*sin({SLOPE})" z="-{G}*cos({SLOPE})"/><shape name="floor" type="plane"/>"""
FREE = (
    "".join(f'<coordinate name="{x}" velocity="v{x}" unit="m"/>' for x in "xyz")
    + "".join(f'<coordinate name="q{i}" velocity="r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
    + '<frame name="a"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>'
)
RADIUS, LENGTH = 0.1, 0.3
HALF = np.array([0.2, 0.15, 0.1])
CONTACT = '<contact name="c" between="floor" and="skin" friction="mu"/>'
TEXTS = {
    "LyingCapsule": f'<body name="b" in="a" mass="{M}" Ixx="0.032" Iyy="0.032" Izz="0.01"/><shape name="skin" in="a" type="capsule" radius="{RADIUS}" length="{LENGTH}"/>',
    "TippingBox": f'<body name="b" in="a" mass="{M}" Ixx="0.02" Iyy="0.03" Izz="0.04"/><shape name="skin" in="a" type="box" sizeX="0.4" sizeY="0.3" sizeZ="0.2"/>',
}


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("shared-frictions", {
        name: f'<system name="{name}">{HEAD}{FREE}{body}{CONTACT}<solver tolerance="1e-9"/><experiment stopTime="1"/></system>' for name, body in TEXTS.items()
    })  # fmt: skip


def at_rest(name, turn, height, mu):
    quaternion = turn.as_quat()[[3, 0, 1, 2]]
    return fmu.Instance(name).initialize({"mu": mu, "z": height} | {f"q{i}": quaternion[i] for i in range(4)})


def whole(instance, *names):
    return instance.fmu.getInteger(instance.vr(*names))


def forces(instance, contact):
    """Normal force, and friction along x and y."""
    name = f"c[{contact}]"
    return np.array(instance.get(f"{name}.force", f"{name}.friction.force", f"{name}.friction.across.force"))


AXIS = 0.9  # from the line of steepest descent to the axis of the capsule
ALONG, ROLLING = M * G * np.sin(SLOPE) * np.cos(AXIS), M * G * np.sin(SLOPE) * np.sin(AXIS) / 3
LEAN = 2 * ALONG * RADIUS / LENGTH  # excess of the lower point's normal force over the upper one's
PRESSING = np.array([1, -1]) * LEAN / 2 + M * G * np.cos(SLOPE) / 2


def left_along(mu):
    """Capacity of the two cones along the axis that rolling leaves, minus the friction needed along the axis."""
    return np.sqrt(np.maximum((mu * PRESSING) ** 2 - ROLLING**2 / 4, 0)).sum() - ALONG


LEAST = brentq(left_along, 0.05, 1)


def lying_capsule(mu):
    turn = Rotation.from_euler("z", AXIS) * Rotation.from_euler("y", np.pi / 2)
    return at_rest("LyingCapsule", turn, RADIUS, mu)


def test_equal_shares_would_exceed_the_limit():
    """At the least sufficient friction, half of the load at the upper point exceeds its limit."""
    assert np.hypot(ALONG / 2, ROLLING / 2) > 1.02 * LEAST * PRESSING[1]


@pytest.mark.parametrize("share", [1 + 1e-8, 1.001, 1.01, 1.5])
def test_capsule_rolls(share):
    """Oblique rolling down a slope without slip along the axis, with the acceleration 2/3 g sin(slope) sin(axis) of a solid cylinder."""
    mu = share * LEAST
    instance = lying_capsule(mu)
    instance.step(0.5)
    across = np.array([np.sin(AXIS), -np.cos(AXIS)])
    assert np.array(instance.get("x", "y")) == pytest.approx(G * np.sin(SLOPE) * np.sin(AXIS) / 3 * 0.5**2 * across, abs=1e-9)
    pressing, friction = np.split(np.array([forces(instance, i) for i in (1, 2)]), [1], axis=1)
    assert sorted(pressing.ravel()) == pytest.approx(sorted(PRESSING), rel=1e-9)
    axis = np.array([np.cos(AXIS), np.sin(AXIS)])
    assert -friction.sum(axis=0) == pytest.approx(ALONG * axis + ROLLING * across, rel=1e-9)
    assert (np.hypot(*friction.T) <= mu * pressing.ravel() * (1 + 1e-12)).all()
    assert whole(instance, "events")[0] < 20
    instance.free()


def test_capsule_slips():
    """A thousandth below the least friction it starts to slip along its axis at both points."""
    instance = lying_capsule(0.999 * LEAST)
    instance.step(0.5)
    assert np.array(instance.get("x", "y")) @ np.array([np.cos(AXIS), np.sin(AXIS)]) > 1e-6
    assert whole(instance, "c[1].friction.sliding", "c[2].friction.sliding") == [1, 1]
    instance.free()


def accelerations(mu, inertia, points, y, creep):
    """
    Accelerations of a body whose points stay on the floor, with the friction mu N v/sqrt(v^2 + creep^2); y: position, quaternion,
    velocities.
    """
    turn, velocity, spin = Rotation.from_quat(y[3:7]).as_matrix(), y[7:10], y[10:13]
    moments = turn @ np.diag(inertia) @ turn.T
    mass = np.block([[M * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), moments]])
    load = np.r_[M * G * np.sin(SLOPE), 0, -M * G * np.cos(SLOPE), -np.cross(spin, moments @ spin)]
    arms = points @ turn.T
    slip = velocity + np.cross(spin, arms)
    directions = np.c_[-mu * slip[:, :2] / np.sqrt((slip[:, :2] ** 2).sum(axis=1) + creep**2)[:, None], np.ones(len(points))]
    gaps, directions = (np.c_[p, np.cross(arms, p)] for p in (np.tile([0, 0, 1], (len(points), 1)), directions))
    lacks = np.cross(spin, np.cross(spin, arms))[:, 2] + 20 * slip[:, 2] + 100 * (y[2] + arms[:, 2])
    free, answer = np.linalg.solve(mass, load), np.linalg.solve(mass, directions.T)
    return free + answer @ np.linalg.solve(gaps @ answer, -gaps @ free - lacks)


def creeping_box(mu, turn, height, end, creep):
    """Final position and velocity of a box on its lower edge, with friction that creeps instead of sticking."""
    inertia, points = np.array([0.02, 0.03, 0.04]), HALF * np.array([[-1, -1, -1], [1, -1, -1]])

    def slopes(time, y):
        x, spin = y[3:7], y[10:13]
        turning = 0.5 * np.r_[x[3] * spin + np.cross(spin, x[:3]), -spin @ x[:3]]
        return np.r_[y[7:10], turning, accelerations(mu, inertia, points, y, creep)]

    start = np.r_[0, 0, height, turn.as_quat(), np.zeros(6)]
    return solve_ivp(slopes, (0, end), start, method="Radau", rtol=1e-8, atol=1e-10).y[[0, 1, 2, 7, 8, 9], -1]


@pytest.mark.parametrize("mu, slides, error", [(0.3, True, 4e-5), (0.4, False, 2e-6)])
def test_box_tips(mu, slides, error):
    """Tipping on an edge oblique to the slope; with little friction it starts to slip on the way. `error` is that of the reference with creep."""
    turn, end = Rotation.from_euler("xz", [60, 20], degrees=True), 0.12
    height = np.abs(turn.as_matrix()[2]) @ HALF
    instance = at_rest("TippingBox", turn, height, mu)
    instance.step(end)
    place = creeping_box(mu, turn, height, end, 1e-6)
    assert np.array(instance.get("x", "y", "z", "vx", "vy", "vz")) == pytest.approx(place, abs=error)
    pressed = [i for i in range(1, 9) if forces(instance, i)[0] > 0]
    assert len(pressed) == 2 and all(whole(instance, f"c[{i}].friction.sliding") == [int(slides)] for i in pressed)
    assert whole(instance, "events")[0] < 100
    instance.free()


def feet(count):
    return np.array([[np.cos(2 * k * np.pi / count), np.sin(2 * k * np.pi / count)] for k in range(count)])


def table_on(count, friction):
    """A table on a ring of feet, pushed and tilted, with its centre of mass at ground level."""
    parameters = "".join(f'<parameter name="{name}" start="0"/>' for name in ("Fx", "Fy", "Fz", "Tz", "Tx", "Ty"))
    coordinates = "".join(f'<coordinate name="{name}" velocity="v{name}"/>' for name in ("x", "y", "z", "yaw", "pitch", "roll"))
    rotations = "".join(f'<rotate axis="{axis}" angle="{angle}"/>' for axis, angle in {"z": "yaw", "y": "pitch", "x": "roll"}.items())
    legs = "".join(
        f'<shape name="foot{k}" in="a" type="sphere" radius="0.05" x="{float(x)}" y="{float(y)}" z="0.05"/>'
        f'<contact name="c{k}" between="floor" and="foot{k}"{friction}/>'
        for k, (x, y) in enumerate(feet(count))
    )
    return f"""<system name="Table{count}"><parameter name="mu" start="0.5"/>{parameters}<gravity z="-{G}"/><shape name="floor" type="plane"/>{coordinates}
<frame name="a"><translate x="x" y="y" z="z"/>{rotations}</frame><body name="b" in="a" mass="{M}" Ixx="0.3" Iyy="0.4" Izz="0.5"/><force on="b" x="Fx*time" y="Fy*time" z="Fz"/><torque on="b" x="Tx" y="Ty" z="Tz*time"/>{legs}<experiment stopTime="1"/></system>"""


def pressing_forces(count, weight, tilting):
    """Normal forces of least norm, by the moments about x and y."""
    places = feet(count)
    return np.linalg.lstsq(np.array([np.ones(count), places[:, 1], -places[:, 0]]), [weight, -tilting[0], -tilting[1]], rcond=None)[0]


@pytest.fixture(scope="module")
def tables():
    build_systems("shared-frictions", {"Table8": table_on(8, ' friction="mu"'), "Table12": table_on(12, "")})


def test_pressing_forces_are_of_least_norm(tables):
    """Normal forces have least norm, also where a foot alone would lift off."""
    for tilting in itertools.product(np.arange(0, 6, 0.5), repeat=2):
        expected = pressing_forces(12, M * G, tilting)
        if min(expected) < 0.01:
            continue
        instance = fmu.Instance("Table12").initialize({"Tx": tilting[0], "Ty": tilting[1]})
        assert instance.get(*(f"c{k}.force" for k in range(12))) == pytest.approx(expected, abs=1e-9)
        instance.free()


def test_pushed_feet_share_their_load(tables):
    """
    At 1 s forces in the cones still carry the growing load, as a separate program has found. Forces of the feet balance the weight and what tilts
    it, and are in the cones.
    """
    values = {"Fx": 3.169332221483987, "Fy": 5.365724363902007, "Tz": 3.764532498141972, "Fz": 2.8736791329964166, "mu": 0.4878756629363105}
    tilting = {"Tx": -1.8820708939303965, "Ty": 0.39850565083107337}
    places = feet(8)
    instance = fmu.Instance("Table8").initialize(values | tilting)
    for k in range(1, 99):
        instance.run(0.01 * k, 0.01)
        found = np.array([instance.get(f"c{i}.force", f"c{i}.friction.force", f"c{i}.friction.across.force") for i in range(8)])
        pressing, friction = found[:, 0], found[:, 1:]
        moments = [pressing.sum(), places[:, 1] @ pressing, -places[:, 0] @ pressing]
        assert moments == pytest.approx([M * G - values["Fz"], -tilting["Tx"], -tilting["Ty"]], abs=1e-6)
        assert (np.hypot(*friction.T) <= values["mu"] * pressing * (1 + 1e-9)).all()
        assert np.max(np.abs(instance.get("vx", "vy", "vyaw"))) < 1e-9
    instance.free()
