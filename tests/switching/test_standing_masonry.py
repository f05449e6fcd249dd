"""
Masonry stands for 100 s or falls: an arch of stones, a house of cards and a column of ten boxes. Limit analysis says whether an
arch stands, by a linear program without motion (Livesley, Limit analysis of structures formed from rigid blocks, 1978).
"""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

import fmu
from building import build_systems

pytestmark = pytest.mark.long

G, TINY = 9.81, 1e-3  # TINY: the radius of the balls that are corners
CONTACT = '<contact name="{}" between="{}" and="{}" friction="mu"/>'


def corner(name, frame, x, z):
    return f'<shape name="{name}" in="{frame}" type="sphere" radius="{TINY}" x="{x}" z="{z}"/>'


def stone(name, x, z, angle, moment):
    """A body of mass 1 in the plane of x and z. Its frame is rotated about y."""
    return f"""<coordinate name="{name}x" velocity="{name}vx" start="{x!r}"/><coordinate name="{name}z" velocity="{name}vz" start="{z!r}"/>
  <coordinate name="{name}a" velocity="{name}w" start="{angle!r}"/>
  <frame name="{name}"><translate x="{name}x" z="{name}z"/><rotate axis="y" angle="{name}a"/></frame><body name="{name}B" in="{name}" mass="1" Iyy="{moment}"/>"""


def system(text, floor, further=""):
    return f"""<system name="{{name}}"><parameter name="mu" start="0.5"/>{further}<gravity z="-{G}"/>
  <shape name="floor" type="plane" z="{floor}"/>{text}<experiment stopTime="100"/></system>"""


def arch(count):
    """Half a circle of equal stones, whose mean radius is 1 and whose thickness is twice `half`. Both ends stand on the floor."""
    text, width = "", math.pi / count
    for i in range(count):
        middle = width * (i + 0.5)
        text += stone(f"b{i}", math.cos(middle), math.sin(middle), math.pi / 2 - middle, 0.03)
        for face, sign in (("right", 1), ("left", -1)):  # the z axis of a face's frame points from the centre of the arch along the face
            text += f'<frame name="{face}{i}" in="b{i}"><translate z="-1"/><rotate axis="y" angle="{sign * width / 2!r}"/></frame>'
            if face == "left" or i == 0:
                text += corner(f"{face}{i}in", f"{face}{i}", -sign * TINY, "1 - half") + corner(f"{face}{i}out", f"{face}{i}", -sign * TINY, "1 + half")
        text += f'<shape name="seat{i}" in="right{i}" type="plane" axis="x"/>'
    for side in ("in", "out"):
        text += CONTACT.format(f"foot{side}", f"right0{side}", "floor")
        text += "".join(CONTACT.format(f"c{i}{side}", f"left{i}{side}", f"seat{i + 1}" if i + 1 < count else "floor") for i in range(count))
    return system(text, floor=0, further='<parameter name="half" start="0.1"/>')


def house(lean=0.25, apart=0.6):
    """Two pairs of leaning cards of length 1, a card that lies on these, and a pair on that. Planes lie behind the faces by the radius of the balls."""

    def card(name, x, z, angle):
        return stone(name, x, z, angle, 1 / 12) + corner(f"{name}low", name, 0, -0.5) + corner(f"{name}high", name, 0, 0.5)

    def pair(name, x, z, below):
        across, up = math.sin(lean) / 2, z + math.cos(lean) / 2
        return (
            card(f"{name}l", x - across, up, lean)
            + card(f"{name}r", x + across, up, -lean)
            + f'<frame name="{name}turned" in="{name}r"><rotate axis="y" angle="pi"/></frame><shape name="{name}face" in="{name}turned" type="plane" axis="x" x="{-TINY}"/>'
            + CONTACT.format(f"{name}top", f"{name}lhigh", f"{name}face")
            + CONTACT.format(f"{name}left", f"{name}llow", below)
            + CONTACT.format(f"{name}right", f"{name}rlow", below)
        )

    text = pair("p", -apart / 2, 0, "floor") + pair("q", apart / 2, 0, "floor") + stone("flat", 0, math.cos(lean), 0, 1 / 12)
    text += f'<shape name="upper" in="flat" type="plane" z="{-TINY}"/><frame name="turned" in="flat"><rotate axis="y" angle="pi"/></frame>'
    text += f'<shape name="lower" in="turned" type="plane" z="{-TINY}"/>'
    text += "".join(CONTACT.format(f"{name}{side}under", f"{name}{side}high", "lower") for name in "pq" for side in "lr")
    return system(text + pair("u", 0, math.cos(lean), "upper"), floor=-TINY)


def column(count):
    """Boxes of 0.4 m x 0.6 m x 0.2 m on each other in space. Each stands on four corners, and nothing says what part of its weight each one carries."""
    text = ""
    for i in range(1, count + 1):
        text += "".join(f'<coordinate name="{x}{i}" velocity="v{x}{i}" start="{round(0.2 * i - 0.1, 3) if x == "z" else 0}"/>' for x in "xyz")
        text += "".join(f'<coordinate name="q{j}{i}" velocity="r{j}{i}" start="{int(j == 0)}"/>' for j in range(4))
        text += f"""<frame name="b{i}"><translate x="x{i}" y="y{i}" z="z{i}"/><rotate quaternion="q0{i} q1{i} q2{i} q3{i}"/></frame>
          <body name="b{i}B" in="b{i}" mass="1" Ixx="0.03" Iyy="0.02" Izz="0.05"/><shape name="sole{i}" in="b{i}" type="box" sizeX="0.4" sizeY="0.6" z="-0.1"/>
          <shape name="top{i}" in="b{i}" type="plane" z="0.1"/>""" + CONTACT.format(f"c{i}", f"sole{i}", f"top{i - 1}" if i > 1 else "floor")
    return system(text, floor=0)


def can_stand(count, half, mu):
    """
    True if forces in the cones of friction at all corners carry the stones of an arch. Each force has two parts, along the edges of its cone, which are not
    negative: equilibrium is linear in these.
    """
    balance, weight = np.zeros((count, 3, 4 * (count + 1))), np.tile([0.0, G, 0.0], count)
    for joint in range(count + 1):
        angle = math.pi * joint / count
        outward, along = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
        parts = [((1 + side * half) * outward, along + sign * mu * outward) for side in (-1, 1) for sign in (-1, 1)]
        for i, (place, force) in enumerate(parts):
            for body, sign in ((joint, 1), (joint - 1, -1)):
                if 0 <= body < count:
                    middle = math.pi * (body + 0.5) / count
                    arm = place - [math.cos(middle), math.sin(middle)]
                    balance[body, :, 4 * joint + i] = sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
    return linprog(np.zeros(4 * (count + 1)), A_eq=balance.reshape(3 * count, -1), b_eq=weight, bounds=(0, None), method="highs").status == 0


def least(condition, low, high):
    """The least value from which on the condition is true, by bisection."""
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (low, middle) if condition(middle) else (middle, high)
    return high


def after(name, values, stop, *results):
    """How much a state changes at most until a time, and the values of results then."""
    instance = fmu.Instance(name)
    try:
        instance.initialize(values, tolerance=1e-6)
        states = fmu.states_of(name)
        start = np.array(instance.get(*states))
        instance.fmu.doStep(0, stop)
        return max(abs(np.array(instance.get(*states)) - start)), instance.get(*results) if results else []
    finally:
        instance.free()


STONES = [4, 7]


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {**{f"Arch{count}": arch(count) for count in STONES}, "HouseOfCards": house(), "ColumnOfTen": column(10)}
    build_systems("standing-masonry", {name: text.format(name=name) for name, text in texts.items()})


@pytest.mark.parametrize("count", STONES)
def test_thickness_of_an_arch(count):
    """An arch stands exactly from the thickness on that limit analysis gives, here 5 to 10 % of the radius."""
    limit = least(lambda half: can_stand(count, half, 0.8), 1e-3, 0.5)
    assert after(f"Arch{count}", {"half": limit * 1.0001, "mu": 0.8}, 100)[0] < 1e-9
    assert after(f"Arch{count}", {"half": limit * 0.9999, "mu": 0.8}, 2)[0] > 1


@pytest.mark.parametrize("count", STONES)
def test_friction_of_an_arch(count):
    """A thick arch slides apart below the friction that limit analysis gives, and stands above it."""
    limit = least(lambda mu: can_stand(count, 0.2, mu), 1e-3, 2)
    assert after(f"Arch{count}", {"half": 0.2, "mu": limit * 1.001}, 100)[0] < 1e-9
    assert after(f"Arch{count}", {"half": 0.2, "mu": limit * 0.99}, 2)[0] > 0.1


def test_house_of_cards():
    """Cards of length 1 that lean by 0.25 stand by friction. A pair alone needs tan(0.25)/2 at the floor; with mu = 0.1 the house falls."""
    assert after("HouseOfCards", {"mu": 0.6}, 100)[0] < 1e-9
    assert after("HouseOfCards", {"mu": 0.1}, 2)[0] > 0.1


def test_column_of_ten():
    """Each box carries the weight of those above it, and by least norm a quarter on each corner."""
    change, forces = after("ColumnOfTen", {}, 100, *[f"c{i}[{j}].force" for i in range(1, 11) for j in range(1, 5)])
    assert change < 1e-9
    assert forces == pytest.approx(np.repeat(np.arange(10, 0, -1) * G / 4, 4), rel=1e-6)
