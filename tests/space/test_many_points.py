"""Compliant contacts of shapes with many points: accelerations against Newton's and Euler's equations with a sum over the points."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from building import build_systems

M, G, K, C, MU, CREEP = 2.0, 9.81, 1e4, 0.5, 0.4, 1e-3
INERTIA = np.array([0.03, 0.05, 0.04])
TILT, SPIN, RISE = 0.3, 0.7, 0.2  # of the floor, which rotates about y and moves along z
NORMAL = Rotation.from_euler("y", TILT).apply([0, 0, 1])

# Offsets of the points in the body's frame; each gap is the height of its point.
RIM = [(np.cos(k * np.pi / 4), np.sin(k * np.pi / 4)) for k in range(8)]
BOX = [(np.array([0.02, 0, 0.01]) + 0.5 * np.array(signs) * (0.3, 0.2, 0.4), 0.0) for signs in itertools.product((-1, 1), repeat=3)]
ENDS = [np.array([0, -0.05, 0.3 * z]) for z in (-0.5, 0.5)]
STANDING = [end + 0.1 * np.array([c, s, 0]) for end in ENDS for c, s in RIM]
CAPSULE = [(np.array([z, 0.03, 0]), 0.0) for z in (-0.25, 0.25)]
SHAPES = """<shape name="{0}Box" in="{0}" type="box" sizeX="0.3" sizeY="0.2" sizeZ="0.4" x="0.02" z="0.01"/>
  <shape name="{0}Can" in="{0}" type="cylinder" radius="0.1" length="0.3" axis="z" y="-0.05"/>
  <shape name="{0}Pill" in="{0}" type="capsule" radius="0.08" length="0.5" axis="x" y="0.03"/>"""
NAMES = ("a", "b", "c")


def body(name):
    quaternion = " ".join(f'<coordinate name="{name}q{i}" velocity="{name}r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
    position = " ".join(f'<coordinate name="{name}{x}" velocity="{name}v{x}" unit="m"/>' for x in "xyz")
    contacts = "".join(
        f'<contact name="{name}{shape}Contact" between="{pair[0]}" and="{pair[1]}" stiffness="{K}" damping="{C}" friction="{MU}"/>'
        for shape, pair in (("Box", (f"{name}Box", "floor")), ("Can", ("floor", f"{name}Can")), ("Pill", (f"{name}Pill", "floor")))
    )
    return f"""{position}{quaternion}<frame name="{name}"><translate x="{name}x" y="{name}y" z="{name}z"/>
  <rotate quaternion="{name}q0 {name}q1 {name}q2 {name}q3"/></frame>
  <body name="{name}Body" in="{name}" mass="{M}" Ixx="{INERTIA[0]}" Iyy="{INERTIA[1]}" Izz="{INERTIA[2]}"/>{SHAPES.format(name)}{contacts}"""


SCENE = f"""<system name="{{}}"><frame name="below"><translate z="{RISE}*time"/><rotate axis="y" angle="{TILT} + {SPIN}*time"/></frame>
  <shape name="floor" in="below" type="plane"/>{"".join(body(name) for name in NAMES)}<gravity z="-{G}"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("many points", {"ManyPoints": SCENE.format("ManyPoints")})


def points_of_cylinder(rotation):
    """
    The lowest points of its rims in the body's frame, and the points on which it stands. The latter rise by 0.04 sin(tilt)^4 along the
    normal, the former by 0.0004 (1 - (sin(tilt)/0.3)^2)^2 up to 0.3. Both move with the gradient of that by the normal's part across the axis.
    """
    across = rotation.inv().apply(NORMAL) * (1, 1, 0)
    sine = np.linalg.norm(across)
    rise, shift = 0.04 * sine**4, 0.16 * sine**2 * across
    above = max(1 - sine**2 / 0.09, 0)
    rims = [(end - 0.1 * across / sine, -0.0016 / 0.09 * above * across, 0.0004 * above**2) for end in ENDS]
    return [(point + moved, gap - NORMAL @ rotation.apply(moved)) for point, moved, gap in rims] + [(point + shift, rise - NORMAL @ rotation.apply(shift)) for point in STANDING]


def wrench(points, radius, position, rotation, velocity, spin):
    """
    The sum of the normal forces, of the forces, and of the torques about the body's origin, along the base's axes. points: offsets, and what
    the gap exceeds the height of each by.
    """
    floor_spin, floor_velocity = np.array([0, SPIN, 0]), np.array([0, 0, RISE])
    pressing, force, torque = 0.0, np.zeros(3), np.zeros(3)
    for offset, excess in points:
        arm = rotation.apply(offset) - radius * NORMAL
        gap = NORMAL @ (position + arm) + excess
        sliding = velocity + np.cross(spin, arm) - floor_velocity - np.cross(floor_spin, position + arm)
        if gap >= 0:
            continue
        size = K * -gap * max(0.0, 1 - C * (NORMAL @ sliding))
        sliding = sliding - (NORMAL @ sliding) * NORMAL
        one = size * NORMAL - MU * size * sliding / np.sqrt(sliding @ sliding + CREEP**2)
        pressing, force, torque = pressing + size, force + one, torque + np.cross(arm, one)
    return pressing, force, torque


@pytest.mark.parametrize("seed", range(6))
def test_accelerations_are_those_of_all_points(seed, open_fmu):
    """Shapes in every attitude, some deep in the floor, some just above, and those of the last body out of reach."""
    random = np.random.default_rng(seed)
    instance = open_fmu("ManyPoints")
    states = {}
    for name in NAMES:
        rotation = Rotation.random(random_state=seed * 7 + ord(name))
        position = np.array([0.3, -0.2, -0.1]) + random.uniform(-0.1, 0.1, 3) + (0, 0, 3.0 * (name == "c"))
        velocity, own = random.normal(size=3), random.normal(size=3)  # own: the angular velocity along the body's axes
        q = rotation.as_quat()[[3, 0, 1, 2]]
        rate = 0.5 * np.array([-q[1:] @ own, *(q[0] * own + np.cross(q[1:], own))])
        states[name] = (position, rotation, velocity, own, q)
        instance.set(**{f"{name}{x}": position[i] for i, x in enumerate("xyz")}, **{f"{name}v{x}": velocity[i] for i, x in enumerate("xyz")})
        instance.set(**{f"{name}q{i}": q[i] for i in range(4)}, **{f"{name}r{i}": rate[i] for i in range(4)})
    instance.initialize()
    touched = set()
    for name, (position, rotation, velocity, own, q) in states.items():
        force, torque = np.array([0, 0, -M * G]), np.zeros(3)
        for shape, points, radius in [("Box", BOX, 0.0), ("Can", points_of_cylinder(rotation), 0.0), ("Pill", CAPSULE, 0.08)]:
            pressing, on_shape, turning = wrench(points, radius, position, rotation, velocity, rotation.apply(own))
            force, torque = force + on_shape, torque + turning
            touched |= {name} if pressing > 0 else set()
            assert instance.get(f"{name}{shape}Contact.force") == pytest.approx(pressing, rel=1e-11, abs=1e-9)
        linear = [instance.get(f"der({name}v{x})") for x in "xyz"]
        second = np.array([instance.get(f"der({name}r{i})") for i in range(4)])
        angular = 2 * (q[0] * second[1:] - second[0] * q[1:] - np.cross(q[1:], second[1:]))
        own_torque = rotation.inv().apply(torque) - np.cross(own, INERTIA * own)
        assert linear == pytest.approx(force / M, rel=1e-11, abs=1e-9)
        assert angular == pytest.approx(own_torque / INERTIA, rel=1e-10, abs=1e-8)
    assert touched == {"a", "b"}
