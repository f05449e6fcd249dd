"""Bodies in the plane x-z that friction alone holds: a house of cards, an arch of blocks, and a cube between two fingers."""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linprog

import fmu
from building import build_systems

pytestmark = pytest.mark.long

G = 9.81
HEAD = '<parameter name="mu" start="1" unit="1"/><gravity z="-9.81"/><shape name="floor" type="plane"/>'


def body(name, x, z, angle, mass, inertia):
    return f"""<coordinate name="{name}x" velocity="{name}vx" unit="m" start="{x!r}"/><coordinate name="{name}z" velocity="{name}vz" unit="m" start="{z!r}"/>
  <coordinate name="{name}a" velocity="{name}w" unit="rad" start="{angle!r}"/>
  <frame name="{name}"><translate x="{name}x" z="{name}z"/><rotate axis="y" angle="{name}a"/></frame>
  <body name="{name}Body" in="{name}" mass="{mass}" Ixx="{inertia}" Iyy="{inertia}" Izz="{inertia}"/>"""


def contact(name, points, plane):
    return f'<contact name="{name}" between="{points}" and="{plane}" friction="mu"/>'


LEAN, CARD = 0.35, 0.1


def cards():
    """Two cards, lines in this plane, that lean against each other; the second one has a plane on its side."""
    both = "".join(
        body(name, -s * CARD / 2 * math.sin(LEAN), CARD / 2 * math.cos(LEAN), s * LEAN, 0.01, 0.01 * CARD**2 / 12)
        + f'<shape name="{name}Ends" in="{name}" type="box" sizeX="0" sizeZ="{CARD}"/>'
        + contact(f"{name}Foot", f"{name}Ends", "floor")
        for name, s in (("left", 1), ("right", -1))
    )
    side = '<frame name="turned" in="right"><rotate axis="y" angle="-pi/2"/></frame><shape name="side" in="turned" type="plane"/>'
    return both + side + contact("top", "leftEnds", "side")


BLOCKS, RADIUS, DEPTH = 5, 1.0, 0.25
HALF = math.pi / BLOCKS / 2  # half of the angle of a block
WEIGHT = 100 * 2 * HALF * RADIUS * DEPTH * G  # of 100 kg for each square metre


def arch():
    """A half circle of equal blocks between two planes of the floor. Each has two points on its right face, on the left face of the next one."""
    text, mass = "", WEIGHT / G
    for k in range(BLOCKS):
        turn = (2 * k + 1) * HALF - math.pi / 2
        text += body(f"b{k}", RADIUS * math.sin(turn), RADIUS * math.cos(turn), turn, mass, mass * (DEPTH**2 + (2 * HALF * RADIUS) ** 2) / 12)
        for s, face in ((-1, "l"), (1, "r")):
            text += f'<frame name="b{k}{face}" in="b{k}"><translate z="{-RADIUS}"/><rotate axis="y" angle="{s * HALF}"/></frame>'
        text += f'<frame name="b{k}p" in="b{k}l"><rotate axis="y" angle="-pi/2"/></frame><shape name="left{k}" in="b{k}p" type="plane"/>'
        text += f'<shape name="right{k}" in="b{k}r" type="box" sizeX="0" sizeZ="{DEPTH}" z="{RADIUS}"/>'
        text += contact(f"j{k}", f"right{k - 1}", f"left{k}") if k else ""
    text += f'<shape name="first" in="b0l" type="box" sizeX="0" sizeZ="{DEPTH}" z="{RADIUS}"/>'
    return text + contact("left", "first", "floor") + contact("right", f"right{BLOCKS - 1}", "floor")


CUBE, FINGER, SPRING, DAMPING, RISE, BEGIN = 0.1, 0.2, 200.0, 20.0, 0.1, 0.3


def gripper(tip):
    """A cube on the floor between two fingers, which press from both sides, and which springs lift from BEGIN on with the speed RISE."""
    text = body("cube", 0.0, 0.02, 0.0, CUBE, CUBE * 0.04**2 / 6) + '<shape name="box" in="cube" type="box" sizeX="0.04" sizeZ="0.04"/>'
    text += contact("ground", "box", "floor") + '<parameter name="grip" start="5" unit="N"/>'
    for name, s in (("left", -1), ("right", 1)):
        text += f"""<coordinate name="{name}x" velocity="{name}vx" unit="m" start="{0.02 * s if tip == "face" else 0.025 * s}"/>
  <coordinate name="{name}z" velocity="{name}vz" unit="m" start="0.02"/><frame name="{name}"><translate x="{name}x" z="{name}z"/></frame>
  <body name="{name}Body" in="{name}" mass="{FINGER}"/><force coordinate="{name}x">{-s}*grip</force>
  <force coordinate="{name}z">{SPRING}*(0.02 + {RISE}*max(time - {BEGIN}, 0) - {name}z) - {DAMPING}*{name}vz + {FINGER * G}</force>"""
        if tip == "face":
            text += f'<frame name="{name}Face" in="{name}"><rotate axis="y" angle="{-s}*pi/2"/></frame><shape name="{name}Tip" in="{name}Face" type="plane"/>'
            text += contact(f"{name}Grip", "box", f"{name}Tip")
        else:
            text += f'<shape name="{name}Tip" in="{name}" type="sphere" radius="0.005"/>' + contact(f"{name}Grip", f"{name}Tip", "box")
    return text


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"CardHouse": cards(), "BlockArch": arch(), "GripperFace": gripper("face"), "GripperBall": gripper("ball")}
    build_systems("standing-by-friction", {name: f'<system name="{name}">{HEAD}{text}<experiment stopTime="100"/></system>' for name, text in texts.items()})


def speed(instance):
    return max(abs(instance.get(unknown.variable.derivative.name)) for unknown in instance.description.derivatives[len(instance.description.derivatives) // 2 :])


@pytest.mark.parametrize("share", [0.5, 0.99, 1.01, 3.0])
def test_card_house(share):
    """
    By symmetry the cards press each other horizontally. This force is at the angle LEAN to the normal of the right card's side, so that the least
    coefficient is tan(LEAN). At the feet tan(LEAN)/2 suffices: by the moments, the force towards the middle is tan(LEAN)/2 of the weight.
    """
    instance = fmu.Instance("CardHouse").initialize({"mu": share * math.tan(LEAN)})
    if share > 1:
        instance.step(100.0)
        assert speed(instance) < 1e-12
        feet = [sum(instance.get(*(f"{name}Foot[{i}].force" for i in (1, 2)))) for name in ("left", "right")]
        assert feet == pytest.approx([0.01 * G] * 2, rel=1e-9)
    else:
        instance.step(0.05)
        assert speed(instance) > 1e-3
    instance.free()


def stands(mu):
    """True if forces within the cones at all faces can balance each block (static theorem of limit analysis, as a linear program)."""
    faces = BLOCKS + 1
    columns = 4 * faces  # of each face: normal and tangential force at the inner and the outer point, on the block to its right
    equations, right = np.zeros((3 * BLOCKS, columns)), np.zeros(3 * BLOCKS)
    for k in range(faces):
        angle = 2 * k * HALF - math.pi / 2
        radial, tangent = np.array([math.sin(angle), math.cos(angle)]), np.array([math.cos(angle), -math.sin(angle)])
        for p, distance in enumerate((RADIUS - DEPTH / 2, RADIUS + DEPTH / 2)):
            point = distance * radial
            for d, direction in enumerate((tangent, radial)):
                moment = point[0] * direction[1] - point[1] * direction[0]
                for block, sign in ((k, 1), (k - 1, -1)):
                    if 0 <= block < BLOCKS:
                        equations[3 * block : 3 * block + 3, 4 * k + 2 * p + d] = sign * np.array([*direction, moment])
    for block in range(BLOCKS):
        x = RADIUS * math.sin((2 * block + 1) * HALF - math.pi / 2)
        right[3 * block : 3 * block + 3] = [0, WEIGHT, x * WEIGHT]
    cones = np.zeros((columns, columns))
    for pair in range(columns // 2):
        cones[2 * pair, 2 * pair], cones[2 * pair, 2 * pair + 1] = -mu, 1
        cones[2 * pair + 1, 2 * pair], cones[2 * pair + 1, 2 * pair + 1] = -mu, -1
    bounds = [(0, None) if i % 2 == 0 else (None, None) for i in range(columns)]
    return linprog(np.zeros(columns), cones, np.zeros(len(cones)), equations, right, bounds).status == 0


def test_arch():
    """It stands for 100 s with the least friction by the linear program and a thousandth more, and slides with 2 % less."""
    low, high = 0.0, 2.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stands(middle) else (middle, high)
    for share in (1.001, 1.01, 1.1, 1.5):
        instance = fmu.Instance("BlockArch").initialize({"mu": share * high})
        instance.step(100.0)
        assert speed(instance) < 1e-12
        assert sum(instance.get(*(f"{name}[{i}].force" for name in ("left", "right") for i in (1, 2)))) == pytest.approx(BLOCKS * WEIGHT, rel=1e-9)
        instance.free()
    instance = fmu.Instance("BlockArch").initialize({"mu": 0.98 * high})
    instance.step(0.05)
    assert speed(instance) > 1e-4
    instance.free()


def height(time):
    """Height of the cube, which leaves the floor when both springs carry its weight, and then moves with the fingers."""
    leaves = BEGIN + CUBE * G / (2 * SPRING * RISE)
    if time <= leaves:
        return 0.02
    mass = 2 * FINGER + CUBE
    # State: rise above 0.02 m, velocity, time since the springs carry the weight, 1.
    matrix = np.array([[0, 1, 0, 0], [-2 * SPRING / mass, -2 * DAMPING / mass, 2 * SPRING * RISE / mass, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    return 0.02 + (expm(matrix * (time - leaves)) @ [0, 0, 0, 1])[0]


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-8, 1e-10])
@pytest.mark.parametrize("mu", [0.3, 0.8, 1.5])
@pytest.mark.parametrize("name", ["GripperFace", "GripperBall"])
def test_gripper(name, mu, tolerance):
    """The cube rises with the fingers, without slip: its weight and its acceleration are below 2 mu grip."""
    instance = fmu.Instance(name).initialize({"mu": mu}, tolerance=tolerance)
    for _ in range(30):
        instance.step(0.05)
        assert instance.get("cubez") == pytest.approx(height(instance.time), abs=max(1e-9, 0.1 * tolerance))
    assert instance.get("cubea", "cubex") == pytest.approx([0, 0], abs=1e-9)
    instance.free()
