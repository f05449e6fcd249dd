"""
Eight spheres with friction that have come to lie in a box.

They carry their load with more forces than are determined. One friction begins to creep and stops again and again: the forces at rest and in
motion are not those of one another. creeping_heap.csv has such a state, from a simulation of the fall.
"""

import csv
import pathlib

import numpy as np
import pytest

import fmu
from building import build_systems

pytestmark = pytest.mark.long

RADIUS, HALF_WIDTH, MASS, GRAVITY = 0.1, 0.25, 2.0, 9.81
WALLS = [("left", "x", -1, "y", "pi/2"), ("right", "x", 1, "y", "-pi/2"), ("front", "y", -1, "x", "-pi/2"), ("back", "y", 1, "x", "pi/2")]
with open(pathlib.Path(__file__).with_name("creeping_heap.csv"), encoding="utf-8") as file:
    STATES = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


def sphere(k):
    coordinates = "".join(
        f'<coordinate name="b{k}{name}" velocity="b{k}{rate}" unit="{unit}" start="{STATES[k][name]}" velocityStart="{STATES[k][rate]}"/>'
        for unit, pairs in (("m", [(x, f"v{x}") for x in "xyz"]), ("1", [(f"q{i}", f"r{i}") for i in range(4)]))
        for name, rate in pairs
    )
    others = ["floor", *(wall[0] for wall in WALLS), *(f"s{j}" for j in range(k))]
    return f"""{coordinates}<frame name="b{k}"><translate x="b{k}x" y="b{k}y" z="b{k}z"/><rotate quaternion="b{k}q0 b{k}q1 b{k}q2 b{k}q3"/></frame>
      <body name="body{k}" in="b{k}" mass="{MASS}" Ixx="0.008" Iyy="0.008" Izz="0.008"/><shape name="s{k}" in="b{k}" type="sphere" radius="{RADIUS}"/>""" + "".join(
        f'<contact name="c{k}_{other}" between="s{k}" and="{other}" restitution="0" friction="0.3"/>' for other in others
    )


@pytest.fixture(scope="module", autouse=True)
def built():
    walls = "".join(
        f'<frame name="at_{name}"><translate {axis}="{side * HALF_WIDTH}"/><rotate axis="{turn}" angle="{angle}"/></frame>'
        f'<shape name="{name}" in="at_{name}" type="plane"/>'
        for name, axis, side, turn, angle in WALLS
    )
    spheres = "".join(sphere(k) for k in range(len(STATES)))
    text = f'<system name="CreepingHeap"><gravity z="-{GRAVITY}"/><shape name="floor" type="plane"/>{walls}{spheres}<solver tolerance="1e-6"/></system>'
    build_systems("creeping-heap", {"CreepingHeap": text})


def test_a_friction_that_creeps_and_stops():
    """
    Time steps pass the events of the friction: otherwise there are some 350. The energy does not grow, and no spheres overlap. Both steps take long;
    there is one warning.
    """
    instance = fmu.Instance("CreepingHeap").initialize()
    energy = instance.get("totalEnergy")
    for _ in range(2):
        instance.step(0.005)
    assert instance.fmu.getInteger(instance.vr("events"))[0] < 250
    assert sum(text.startswith("slow: ") for _, _, text in instance.messages) == 1
    assert instance.get("totalEnergy") <= energy + 1e-9
    places = np.array([instance.get(*(f"b{k}{x}" for x in "xyz")) for k in range(len(STATES))])
    distances = [np.linalg.norm(places[i] - places[k]) for i in range(len(STATES)) for k in range(i)]
    assert min(distances) > 2 * RADIUS - 1e-7 and places[:, 2].min() > RADIUS - 1e-7
    assert np.abs(places[:, :2]).max() < HALF_WIDTH - RADIUS + 1e-7
    instance.free()
