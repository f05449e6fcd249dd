"""lagc --pull: the forces with which a page's pointer pulls bodies, against moments computed by hand."""

import math
import random

import numpy as np
import pytest

import fmu
from building import build_systems

ROD = """<system name="PulledRod">
  <parameter name="l" start="0.7" unit="m"/>
  <coordinate name="theta" velocity="omega" unit="rad"/>
  <body name="rod" mass="2" x="l*cos(theta)" y="l*sin(theta)" inertia="0.3" angle="theta"/>
  <particle name="still" mass="1" x="1" y="2"/>
</system>"""
WHEEL = """<system name="PulledWheel">
  <coordinate name="turn" velocity="rate" unit="rad"/>
  <frame name="hub"><translate x="0.2" y="-0.1" z="0.5"/><rotate axis="x" angle="turn"/></frame>
  <body name="wheel" mass="3" in="hub" Ixx="0.4" Iyy="0.2" Izz="0.2"/>
</system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("pulled", {"PulledRod": ROD, "PulledWheel": WHEEL}, "--pull")


def inputs_of(name, body, chance):
    """Random pointer, grasped point, time and stiffness, and the values of the FMU's inputs."""
    pointer, offset = np.array([chance.uniform(-2, 2) for _ in range(3)]), np.array([chance.uniform(-0.5, 0.5) for _ in range(3)])
    time, stiffness = chance.uniform(0, 0.5), chance.uniform(10, 100)
    values = dict(zip(("pull.x", "pull.y", "pull.z", "pull.u", "pull.v", "pull.w"), [*pointer, *offset]))
    return pointer, offset, time, stiffness, values | {"pull.time": time, f"pull.of.{body}": stiffness}


def acceleration(name, values, variable):
    instance = fmu.Instance(name, logging=False)
    try:
        return instance.initialize(values).get(variable)
    finally:
        instance.free()


@pytest.mark.parametrize("seed", range(3))
def test_a_planar_body(seed):
    chance = random.Random(seed)
    pointer, offset, time, stiffness, values = inputs_of("PulledRod", "rod", chance)
    theta, omega = chance.uniform(-3, 3), chance.uniform(-2, 2)
    axis, across = np.array([math.cos(theta), math.sin(theta)]), np.array([-math.sin(theta), math.cos(theta)])
    point, moves = (0.7 + offset[0]) * axis + offset[1] * across, (0.7 + offset[0]) * across - offset[1] * axis
    moment = stiffness * (pointer[:2] - point - time * omega * moves) @ moves
    found = acceleration("PulledRod", values | {"theta": theta, "omega": omega}, "der(omega)")
    assert found == pytest.approx(moment / (0.3 + 2 * 0.7**2), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_a_body_in_space(seed):
    """The moment is right even for a body whose centre of mass does not move."""
    chance = random.Random(seed)
    pointer, offset, time, stiffness, values = inputs_of("PulledWheel", "wheel", chance)
    turn, rate = chance.uniform(-3, 3), chance.uniform(-2, 2)
    rotation = np.array([[1, 0, 0], [0, math.cos(turn), -math.sin(turn)], [0, math.sin(turn), math.cos(turn)]])
    lever = rotation @ offset
    force = stiffness * (pointer - np.array([0.2, -0.1, 0.5]) - lever - time * np.cross([rate, 0, 0], lever))
    found = acceleration("PulledWheel", values | {"turn": turn, "rate": rate}, "der(rate)")
    assert found == pytest.approx(np.cross(lever, force)[0] / 0.4, rel=1e-12)


def test_fixed_bodies():
    names = {variable.name for variable in fmu.description("PulledRod").modelVariables}
    assert "pull.of.rod" in names and "pull.of.still" not in names
