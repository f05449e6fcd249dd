"""Two boxes touch where they overlap, in the direction of the least overlap: separating axes, balances of momentum, and areas of support by geometry."""

import subprocess

import numpy as np
import pytest
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.spatial.transform import Rotation

import fmu
from building import LAGC, build_systems

G, MASS, STIFFNESS = 9.81, 2.0, 2e4
LOWER, UPPER = np.array([0.2, 0.15, 0.1]), np.array([0.12, 0.05, 0.08])  # half sizes


BEAMS = """<system name="BeamOnBeam"><parameter name="yaw" start="0" unit="rad"/><coordinate name="z" velocity="v" unit="m" start="0.00999"/>
  <frame name="a"><translate z="z"/><rotate axis="z" angle="yaw"/></frame><body name="beam" in="a" mass="1"/>
  <shape name="upper" in="a" type="box" sizeX="4" sizeY="0.01" sizeZ="0.01"/><shape name="lower" type="box" sizeX="4" sizeY="0.01" sizeZ="0.01"/>
  <contact name="touch" between="upper" and="lower" stiffness="1e5"/><solver tolerance="1e-8"/></system>"""


def body(name, half):
    sizes = "".join(f' size{axis}="{2 * size}"' for axis, size in zip("XYZ", half))
    moments = "".join(f' I{axis}{axis}="{MASS * (half @ half - size**2) / 3}"' for axis, size in zip("xyz", half))
    places = "".join(f'<coordinate name="{name}{x}" velocity="{name}v{x}" unit="m"/>' for x in "xyz")
    quaternion = "".join(f'<coordinate name="{name}q{i}" velocity="{name}r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
    return f"""{places}{quaternion}<frame name="{name}"><translate x="{name}x" y="{name}y" z="{name}z"/><rotate quaternion="{name}q0 {name}q1 {name}q2 {name}q3"/></frame>
  <body name="{name}B" in="{name}" mass="{MASS}" {moments}/><shape name="{name}S" in="{name}" type="box"{sizes}/>"""


def system(name, text, gravity=G, damping=1, first="aS", second="table"):
    return f"""<system name="{name}"><parameter name="mu" start="0.5" unit="1"/><gravity z="-{gravity}"/>{text}
  <contact name="touch" between="{first}" and="{second}" stiffness="{STIFFNESS}" damping="{damping}" friction="mu"/><solver tolerance="1e-8"/><experiment stopTime="1"/></system>"""


def gripper():
    """Two fingers squeeze a cube of 0.2 kg with 10 N each, and a spring of the hand lifts it from 0.5 s on."""
    cube = body("a", np.array([0.02, 0.02, 0.02])).replace(f'mass="{MASS}"', 'mass="0.2"')
    text = """<parameter name="mu" start="0.5" unit="1"/><gravity z="-9.81"/><coordinate name="h" velocity="hv" unit="m" start="0.03"/>
      <frame name="hand"><translate z="h"/></frame><body name="palm" in="hand" mass="0.5"/><shape name="floor" type="plane"/>
      <force coordinate="h">0.9*9.81 + 200*(0.03 + 0.1*max(0, time - 0.5) - h) - 20*hv</force>"""
    contact = '<contact name="{}" between="{}" and="aS" stiffness="2e4" damping="1" friction="mu" creep="1e-4"/>'
    for side, sign in (("l", -1), ("r", 1)):
        text += f"""<coordinate name="{side}" velocity="{side}v" unit="m" start="{sign * 0.031}"/><frame name="{side}F" in="hand"><translate x="{side}"/></frame>
          <body name="{side}B" in="{side}F" mass="0.1"/><shape name="{side}S" in="{side}F" type="box" sizeX="0.02" sizeY="0.03" sizeZ="0.03"/>
          <force coordinate="{side}">{-sign * 10} - 20*{side}v</force>"""
    contacts = contact.format("ground", "floor") + contact.format("left", "lS") + contact.format("right", "rS")
    return f'<system name="BoxesGrip">{cube}{text}{contacts}<experiment stopTime="2"/></system>'


def table(half):
    return '<shape name="table" type="box"' + "".join(f' size{axis}="{2 * size}"' for axis, size in zip("XYZ", half)) + f' z="{-half[2]}"/>'


@pytest.fixture(scope="module", autouse=True)
def built():
    upper = body("a", UPPER)
    texts = {
        "BoxOnTable": system("BoxOnTable", upper + table(LOWER)),
        "TableUnderBox": system("TableUnderBox", upper + table(LOWER), first="table", second="aS"),
        "BoxOnWideTable": system("BoxOnWideTable", upper + table(np.array([9.0, 9.0, 0.1]))),
        "BoxOnPlane": system("BoxOnPlane", upper + '<shape name="table" type="plane"/>'),
        "BoxesGrip": gripper(),
        "BeamOnBeam": BEAMS,
        "BoxesInSpace": system("BoxesInSpace", upper + body("b", LOWER), gravity=0, damping=0.5, second="bS"),
    }
    build_systems("boxes-on-boxes", texts)


def pose(name, place, rotation):
    x, y, z, w = rotation.as_quat()
    return dict(zip([f"{name}x", f"{name}y", f"{name}z", f"{name}q0", f"{name}q1", f"{name}q2", f"{name}q3"], [*place, w, x, y, z]))


def distance(apart, rotation, half, other):
    """The largest distance of the boxes' shadows on the axes of faces and on perpendiculars of two edges. other: at the origin, along its axes."""
    own = rotation.as_matrix().T
    axes = [*np.eye(3), *own, *(np.cross(a, b) for a in np.eye(3) for b in own)]
    lengths = [np.linalg.norm(axis) for axis in axes]
    return max((abs(apart @ axis) - abs(axis) @ other - abs(own @ axis) @ half) / size for axis, size in zip(axes, lengths) if size > 0.01)


@pytest.mark.long
@pytest.mark.parametrize("name", ["BoxOnTable", "TableUnderBox"])
def test_boxes_touch_where_they_overlap(name):
    """At random poses near the first contact, there is a force if and only if the boxes overlap. Mostly it is that of the overlap."""
    random, touched = np.random.default_rng(1), []
    instance = fmu.Instance(name, logging=False)
    try:
        for seed in range(400):
            rotation, direction = Rotation.random(random_state=seed), random.normal(size=3)
            direction /= np.linalg.norm(direction)
            low, high, wanted = 0.0, 1.0, random.uniform(-2e-3, 2e-3)
            while high - low > 1e-12:
                middle = (low + high) / 2
                low, high = (middle, high) if distance(middle * direction, rotation, UPPER, LOWER) < wanted else (low, middle)
            instance.reset().initialize({**pose("a", high * direction - [0, 0, LOWER[2]], rotation), "mu": 0})
            force, overlap = instance.get("touch.force"), -distance(high * direction, rotation, UPPER, LOWER)
            assert (force > 0) == (overlap > 0), (seed, force, overlap)
            if overlap > 0:
                touched.append(force / (STIFFNESS * overlap))
    finally:
        instance.free()
    # One point that touches has the boxes' overlap, but for places where features change.
    assert len(touched) > 150 and np.median(touched) == pytest.approx(1, abs=1e-6) and np.mean(np.abs(np.array(touched) - 1) < 1e-6) > 0.9


@pytest.mark.parametrize("tilt", [0.0, 0.4, 1.2])
def test_a_wide_box_is_a_plane(tilt):
    """A box that is thrown on a wide table moves as on a plane."""
    values = {**pose("a", [0, 0, 0.2], Rotation.from_euler("xyz", [tilt, tilt / 2, 0.3])), "avx": 0.5, "avy": 0.2}
    names = ["ax", "ay", "az", "aq0", "aq1", "aq2", "aq3"]
    ends = []
    for name in ("BoxOnWideTable", "BoxOnPlane"):
        instance = fmu.Instance(name, logging=False)
        try:
            instance.initialize(values)
            instance.fmu.doStep(0, 0.4)
            ends.append(instance.get(*names))
        finally:
            instance.free()
    assert ends[0] == pytest.approx(ends[1], abs=1e-5)


def momenta(values):
    """Momentum and angular momentum of both boxes about the origin."""
    linear, angular = np.zeros(3), np.zeros(3)
    for name, half in (("a", UPPER), ("b", LOWER)):
        place, velocity = (np.array([values[f"{name}{p}{x}"] for x in "xyz"]) for p in ("", "v"))
        w, x, y, z = (values[f"{name}q{i}"] for i in range(4))
        dw, dx, dy, dz = (values[f"{name}r{i}"] for i in range(4))
        # The angular velocity along the base's axes is 2 dq/dt times the conjugate of q.
        spin = 2 * np.array([-dw * x + dx * w - dy * z + dz * y, -dw * y + dx * z + dy * w - dz * x, -dw * z - dx * y + dy * x + dz * w])
        matrix = Rotation.from_quat([x, y, z, w]).as_matrix()
        moments = MASS * (half @ half - half**2) / 3
        linear += MASS * velocity
        angular += np.cross(place, MASS * velocity) + matrix @ (moments * (matrix.T @ spin))
    return [*linear, *angular]


@pytest.mark.parametrize("seed", range(6))
def test_collision_in_space(seed):
    """Two free boxes that collide keep their momentum and angular momentum. They lose energy by damping."""
    random = np.random.default_rng(seed)
    values = {**pose("a", [0.5, *random.uniform(-0.05, 0.05, 2)], Rotation.random(random_state=seed)), "avx": -1.0}
    values |= {**pose("b", [0, 0, 0], Rotation.random(random_state=seed + 100)), "mu": 0.5 if seed % 2 else 0.0}
    names = [f"{body}{p}{x}" for body in "ab" for p in ("", "v") for x in "xyz"] + [f"{body}{p}{i}" for body in "ab" for p in "qr" for i in range(4)]
    instance = fmu.Instance("BoxesInSpace", logging=False)
    try:
        instance.initialize(values)
        states = [dict(zip(names, instance.get(*names)))]
        energy = instance.get("totalEnergy")
        instance.fmu.doStep(0, 0.6)
        states.append(dict(zip(names, instance.get(*names))))
        left = instance.get("totalEnergy") / energy
        assert instance.get("touch.force") == 0 and states[1]["avx"] > -0.99
    finally:
        instance.free()
    before, after = map(momenta, states)
    assert after == pytest.approx(before, abs=1e-6)
    assert 0.1 < left < 0.95


def support(turn, shift):
    """The half planes of the area on which the upper box stands on the lower one, as rows (normal, -reach), about the lower one's centre."""
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    rows = [[*(sign * axis), -half] for axis, half in zip(np.eye(2), LOWER[:2]) for sign in (1, -1)]
    return rows + [[*(sign * axis), -half - sign * (axis @ shift)] for axis, half in zip(axes, UPPER[:2]) for sign in (1, -1)]


@pytest.mark.long
@pytest.mark.parametrize("turn", [0.0, 0.005, 0.8])
@pytest.mark.parametrize("heading", [0.5, 1.6])
def test_a_box_that_sticks_out_tips(turn, heading):
    """
    A box that lies across the edges of another one stands if its centre is above both faces, and tips if it is beyond. The depth at rest is that of its
    weight on the corners of the area where both faces meet.
    """
    direction = np.array([np.cos(heading), np.sin(heading)])
    edge = min(half / abs(part) for half, part in zip(LOWER[:2], direction) if abs(part) > 1e-9)
    rows = []
    for share in (0.95, 1.05):
        shift = share * edge * direction
        instance = fmu.Instance("BoxOnTable", logging=False)
        try:
            instance.initialize({**pose("a", [*shift, UPPER[2]], Rotation.from_euler("z", turn)), "mu": 0.8})
            instance.fmu.doStep(0, 0.5)
            rows.append(instance.get("az", "aq1", "aq2", "touch.force"))
        finally:
            instance.free()
    assert max(np.abs(rows[0][1:3])) < 0.02 and rows[0][0] < UPPER[2] and rows[0][3] > 0
    assert max(np.abs(rows[1][1:3])) > 0.1


def test_area_of_support():
    """Four corners of crossed boxes carry the weight: none of these is a corner of a box. Across long boxes, the crossed faces are a rectangle."""
    instance = fmu.Instance("BoxOnTable", logging=False)
    try:
        instance.initialize({**pose("a", [0, 0, UPPER[2]], Rotation.from_euler("z", 0.6)), "mu": 0.8})
        instance.fmu.doStep(0, 1)
        height = instance.get("az")
    finally:
        instance.free()
    area = ConvexHull(HalfspaceIntersection(np.array(support(0.6, np.zeros(2))), np.zeros(2)).intersections)
    count = len(area.vertices)
    assert height == pytest.approx(UPPER[2] - MASS * G / (count * STIFFNESS), abs=2e-6)


@pytest.mark.long
@pytest.mark.parametrize("mu, lifts", [(0.8, True), (0.11, True), (0.09, False)])
def test_fingers_lift_a_cube(mu, lifts):
    """Fingers that are boxes hold a cube by friction if 2 mu 10 N exceed its weight of 1.96 N: from mu = 0.098 on. The creep lets it slip by 0.4 mm."""
    instance = fmu.Instance("BoxesGrip", logging=False)
    try:
        instance.initialize({"az": 0.02, "mu": mu})
        instance.fmu.doStep(0, 2)
        hand, cube, forces = instance.get("h"), instance.get("az"), instance.get("left.force", "right.force")
    finally:
        instance.free()
    assert cube == pytest.approx(hand - 0.01 if lifts else 0.02, abs=1e-3)
    assert not lifts or forces == pytest.approx([10, 10], rel=1e-3)


@pytest.mark.parametrize("yaw", [0.0, 1e-4, 1e-3, 0.004, 0.006, 0.0095, 0.02, 1.0])
def test_beams_that_are_almost_parallel(yaw):
    """The faces of long beams share a parallelogram, hexagon or octagon. Its corners are points, whatever the angle between the beams."""
    half = np.array([2, 0.005])
    axes = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    rows = [[*(sign * axis), -size] for frame in (np.eye(2), axes) for axis, size in zip(frame, half) for sign in (1, -1)]
    corners = len(ConvexHull(HalfspaceIntersection(np.array(rows), np.zeros(2)).intersections).vertices) if yaw > 0 else 4
    instance = fmu.Instance("BeamOnBeam", logging=False)
    try:
        force = instance.initialize({"yaw": yaw}).get("touch.force")
    finally:
        instance.free()
    assert force == pytest.approx(corners * 1e5 * 1e-5, rel=1e-6)


def test_a_pile_of_boxes_is_within_the_limits(tmp_path):
    """Six pairs of boxes that may touch: two on a table, and one on both."""
    shapes = "".join(body(name, UPPER) for name in "abc") + table(LOWER)
    pairs = [("aS", "table"), ("bS", "table"), ("cS", "table"), ("aS", "bS"), ("aS", "cS"), ("bS", "cS")]
    contacts = "".join(f'<contact name="c{i}" between="{one}" and="{other}" stiffness="2e4" friction="0.5"/>' for i, (one, other) in enumerate(pairs))
    path = tmp_path / "system.xml"
    path.write_text(f'<system name="PileOfBoxes"><gravity z="-{G}"/>{shapes}{contacts}</system>')
    assert subprocess.run([LAGC, path, "-o", tmp_path], capture_output=True).returncode == 0
