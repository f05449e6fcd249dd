"""Correctness of the systems with which scripts/bench/cost measures the cost of derivation."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu import ROOT, build_systems, lagc

pytestmark = pytest.mark.release

SYSTEMS = ROOT / "scripts" / "numerics" / "systems"
JOINTS = 7
MASS, LENGTH, ACROSS, ALONG, GRAVITY = 2, 0.3, 0.02, 0.004, 9.81


@pytest.mark.parametrize("name", sorted(path.parent.name for path in SYSTEMS.glob("*/system.xml")))
def test_derived_without_messages(name, tmp_path):
    result = lagc(SYSTEMS / name / "system.xml", "-o", tmp_path / "out")
    assert (result.returncode, result.stderr) == (0, "")


def inertia_and_potential(angles):
    """M and V of the arm, from the geometric Jacobians of its links."""
    turn, end, joints = np.eye(3), np.zeros(3), []
    inertia, potential = np.zeros((JOINTS, JOINTS)), 0.0
    for i, angle in enumerate(angles):
        axis = 2 if i % 2 == 0 else 1
        joints.append((turn[:, axis], end))
        turn = turn @ Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix()
        centre, end = end + turn[:, 2] * LENGTH / 2, end + turn[:, 2] * LENGTH
        moving, turning = np.zeros((3, JOINTS)), np.zeros((3, JOINTS))
        for j, (direction, place) in enumerate(joints):
            moving[:, j], turning[:, j] = np.cross(direction, centre - place), direction
        inertia += MASS * moving.T @ moving + turning.T @ turn @ np.diag([ACROSS, ACROSS, ALONG]) @ turn.T @ turning
        potential += MASS * GRAVITY * centre[2]
    return inertia, potential


def accelerations(angles, rates, torques, h=1e-5):
    around = [[inertia_and_potential(angles + s * h * e) for s in (1, -1)] for e in np.eye(JOINTS)]
    change = np.array([(above[0] - below[0]) / (2 * h) for above, below in around])
    slope = np.array([(above[1] - below[1]) / (2 * h) for above, below in around])
    gyroscopic = np.einsum("kij,k,j->i", change, rates, rates) - np.einsum("kij,i,j->k", change, rates, rates) / 2
    return np.linalg.solve(inertia_and_potential(angles)[0], torques - gyroscopic - slope)


def test_arm(open_fmu):
    build_systems("large", {"Arm7": (SYSTEMS / "Arm7" / "system.xml").read_text()})
    instance, random = open_fmu("Arm7"), np.random.default_rng(1)
    for _ in range(5):
        values = random.uniform(0.2, 1.2, (3, JOINTS))
        named = {f"{name}[{i + 1}]": values[k, i] for k, name in enumerate(["q", "dq", "tau"]) for i in range(JOINTS)}
        instance.reset().initialize(named)
        ours = [instance.get(f"der(dq[{i + 1}])") for i in range(JOINTS)]
        expected = accelerations(*values)
        assert np.max(np.abs(ours - expected)) < 1e-7 * np.max(np.abs(expected))
