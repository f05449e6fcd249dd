"""Accelerations of real robots at random states, against Pinocchio's for the same URDF files."""

import xml.etree.ElementTree as ET
from ctypes import c_double
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from fmpy.fmi2 import FMU2Model

import fmu
from fmu import build_systems, lagc
from numerics.space.accelerations import chain

pytestmark = pytest.mark.release

ROBOTS = Path(pin.__file__).parents[4] / "share" / "example-robot-data" / "robots"
# The file, and True for a floating base.
FILES = {
    "Ur5": ("ur_description/urdf/ur5_robot.urdf", False),
    "Panda": ("panda_description/urdf/panda.urdf", False),  # one finger mimics the other
    "Anymal": ("anymal_b_simple_description/robots/anymal.urdf", True),
    "Chain": (chain(200), False),
    "Humanoid": ("simple_humanoid_description/urdf/simple_humanoid.urdf", True),
}
BASE = ["base_x", "base_y", "base_z", "base_qw", "base_qx", "base_qy", "base_qz"]
STATES = 200


def system(name):
    path, floats = FILES[name]
    base = "floating" if floats else "fixed"
    return f'<system name="{name}"><include file="{ROBOTS / path}" as="robot" base="{base}"/></system>'


@pytest.fixture(scope="module", autouse=True)
def robots():
    build_systems("pinocchio", {name: system(name) for name in FILES})


def product(a, b):
    """Product of quaternions, the real part first."""
    return np.array([a[0] * b[0] - a[1:] @ b[1:], *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))])


def vector(v):
    return np.array([0, *v])


class Reference:
    """
    Pinocchio's model in the FMU's coordinates. Pinocchio has a coordinate for each joint, also for mimicking ones. It describes an unlimited angle by
    its cosine and sine, and the velocity of a free base along its own axes.
    """

    def __init__(self, name):
        path, self.floats = str(ROBOTS / FILES[name][0]), FILES[name][1]
        self.model = pin.buildModelFromUrdf(path, *([pin.JointModelFreeFlyer()] if self.floats else []))
        self.data = self.model.createData()
        mimics = {j.get("name"): j.find("mimic") for j in ET.parse(path).iter("joint") if j.find("mimic") is not None}
        joints = [*self.model.names[2 if self.floats else 1 :]]
        self.joints = [joint for joint in joints if joint not in mimics]
        free = 6 if self.floats else 0
        # Velocities of all joints, and their positions minus an offset, are this matrix times those of the independent ones.
        self.shares = np.zeros((self.model.nv, free + len(self.joints)))
        self.shares[:free, :free] = np.eye(free)
        self.offsets = np.zeros(len(self.joints + [*mimics]))
        self.placed = [self.model.joints[self.model.getJointId(joint)] for joint in joints]
        for row, joint in enumerate(joints):
            mimic = mimics.get(joint)
            leader = joint if mimic is None else mimic.get("joint")
            share = 1.0 if mimic is None else float(mimic.get("multiplier", 1))
            self.shares[self.placed[row].idx_v, free + self.joints.index(leader)] = share
            self.offsets[row] = 0.0 if mimic is None else float(mimic.get("offset", 0))

    def accelerations(self, position, velocity, torques):
        """Second derivatives of the FMU's coordinates: those of the base, then the joints."""
        n = len(self.joints)
        base, base_rate = position[:-n], velocity[:-n]
        q, v = np.zeros(self.model.nq), np.zeros(self.shares.shape[1])
        v[-n:] = velocity[-n:]
        if self.floats:
            rotated = base[3:]
            axes = pin.Quaternion(*rotated).toRotationMatrix()
            conjugate = rotated * [1, -1, -1, -1]
            v[:3], v[3:6] = axes.T @ base_rate[:3], 2 * product(conjugate, base_rate[3:])[1:]
            q[:7] = [*base[:3], *rotated[1:], rotated[0]]
        positions = self.shares[:, -n:] @ position[-n:]
        for joint, offset in zip(self.placed, self.offsets):
            angle = positions[joint.idx_v] + offset
            q[joint.idx_q : joint.idx_q + joint.nq] = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
        mass = pin.crba(self.model, self.data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(self.model, self.data, q, self.shares @ v)
        right = np.zeros(len(v)) - self.shares.T @ bias
        right[-n:] += torques
        a = np.linalg.solve(self.shares.T @ mass @ self.shares, right)
        if not self.floats:
            return a
        linear = axes @ (a[:3] + np.cross(v[3:6], v[:3]))
        turning = (product(rotated, vector(a[3:6])) + product(base_rate[3:], vector(v[3:6]))) / 2
        return np.array([*linear, *turning, *a[-n:]])


class Evaluation:
    """Derivatives of the FMU's states at any state, in model exchange."""

    def __init__(self, name, open_fmu):
        self.instance = open_fmu(name, kind=FMU2Model)
        description = self.instance.description
        losses = [v.name for v in description.modelVariables if v.name.endswith(("_damping", "_friction"))]
        self.instance.initialize(dict.fromkeys(losses, 0.0))
        self.instance.fmu.newDiscreteStates()
        self.instance.fmu.enterContinuousTimeMode()
        self.states = fmu.states_of(name)
        self.inputs = fmu.names_of(name, "input")
        self.state, self.derivatives = (c_double * len(self.states))(), (c_double * len(self.states))()

    def __call__(self, state, inputs):
        self.instance.set(dict(zip(self.inputs, inputs)))
        self.state[:] = state
        self.instance.fmu.setContinuousStates(self.state, len(state))
        self.instance.fmu.getDerivatives(self.derivatives, len(state))
        return np.array(self.derivatives)


def random_state(random, floats, n):
    position, velocity = random.uniform(-2, 2, n), random.uniform(-2, 2, n)
    if floats:
        rotated = random.normal(size=4)
        rotated /= np.linalg.norm(rotated)
        turning = product(rotated, vector(random.uniform(-2, 2, 3))) / 2
        position = [*random.uniform(-2, 2, 3), *rotated, *position]
        velocity = [*random.uniform(-2, 2, 3), *turning, *velocity]
    return np.array(position), np.array(velocity), random.uniform(-20, 20, n)


@pytest.mark.parametrize("name", FILES)
def test_accelerations(name, open_fmu):
    reference, evaluate = Reference(name), Evaluation(name, open_fmu)
    names = [*(BASE if reference.floats else []), *reference.joints]
    order = [evaluate.states.index(f"robot.{joint}") for joint in names]
    order += [evaluate.states.index(f"robot.{joint}_velocity") for joint in names]
    motors = [next(i for i in (f"robot.{j}_torque", f"robot.{j}_force") if i in evaluate.inputs) for j in reference.joints]
    assert len(names) * 2 == len(evaluate.states) and sorted(motors) == sorted(evaluate.inputs)
    random, state = np.random.default_rng(1), np.zeros(len(order))
    for _ in range(STATES):
        position, velocity, torques = random_state(random, reference.floats, len(reference.joints))
        state[order] = [*position, *velocity]
        derivatives = evaluate(state, [torques[motors.index(name)] for name in evaluate.inputs])[order]
        expected = reference.accelerations(position, velocity, torques)
        np.testing.assert_array_equal(derivatives[: len(names)], velocity)
        error = np.max(np.abs(derivatives[len(names) :] - expected))
        digits = 1e-8 if name == "Chain" else 1e-10  # the mass matrix of so many joints is ill-conditioned
        assert error < digits * np.max(np.abs(expected)), error / np.max(np.abs(expected))


@pytest.mark.parametrize("path", ["talos_data/robots/talos_full_v2.urdf", "centauro_description/urdf/centauro.urdf", "tiago_description/robots/tiago_dual.urdf"])
def test_robots_of_forty_joints_and_more_are_derived(path, tmp_path):
    """Their mass matrices have a thousand elements, which must share their common factors."""
    (tmp_path / "system.xml").write_text(f'<system name="R"><include file="{ROBOTS / path}" as="robot" base="floating"/></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
