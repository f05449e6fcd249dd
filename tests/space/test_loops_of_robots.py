"""
Robots with loops: a URDF is a tree, and each <joint> beside its <include> closes a loop. Accelerations and forces against the constrained
equations by Pinocchio's mass matrices and Jacobians of the same files; motions against closed forms of where the platforms of parallel
robots are.
"""

from ctypes import c_double

import numpy as np
import pinocchio as pin
import pytest
from fmpy.fmi2 import FMU2Model

import fmu
from fmu import build_systems

INERTIA = '<inertia ixx="{0}" iyy="{1}" izz="{2}" ixy="0" ixz="0" iyz="0"/>'
ROD_INERTIA = INERTIA.format(2e-3, 2e-3, 1e-9)


def link(name, mass=None, centre="0 0 0", inertia=""):
    inside = "" if mass is None else f'<inertial><origin xyz="{centre}"/><mass value="{mass}"/>{inertia}</inertial>'
    return f'<link name="{name}">{inside}</link>'


def joint(name, kind, parent, child, place=(0, 0, 0), axis="0 0 1", yaw=0.0):
    place = " ".join(map(repr, map(float, place)))
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{place}" rpy="0 0 {yaw!r}"/>'
        f'<axis xyz="{axis}"/></joint>'
    )


def turns(name, parent, child, axes):
    """What turns about one axis after the other, with links without mass between."""
    links = [parent, *(f"{name}_{i}" for i in range(1, len(axes))), child]
    between = "".join(map(link, links[1:-1]))
    return between + "".join(joint(f"{name}_{'xyz'['xyz'.index(axis)]}{i}", "continuous", links[i], links[i + 1], axis=" ".join(str(int(axis == a)) for a in "xyz")) for i, axis in enumerate(axes))


def fixed(name, parent, place, yaw=0.0):
    return link(name) + joint(f"{name}_mount", "fixed", parent, name, place, yaw=yaw)


# Two fingers, each on a crank and a rocker of one length, on a palm that leans: the axes of the hinges are the y axes of the links.
def finger(side, sign):
    crank = link(f"{side}_crank_link", 0.05, "0 0.003 0.03", INERTIA.format(2e-5, 3e-5, 1e-5))
    rocker = link(f"{side}_rocker_link", 0.04, "0.001 0 0.03", INERTIA.format(2e-5, 2e-5, 1e-5))
    tip = link(f"{side}_finger", 0.08, f"{0.01 * sign} 0 0.03", INERTIA.format(4e-5, 5e-5, 2e-5))
    hinge = {"kind": "continuous", "axis": "0 1 0"}
    return (
        crank + rocker + tip + joint(f"{side}_crank", parent="palm", child=f"{side}_crank_link", place=(0.02 * sign, 0, 0.05), **hinge)
        + joint(f"{side}_knuckle", parent=f"{side}_crank_link", child=f"{side}_finger", place=(0, 0, 0.06), **hinge)
        + joint(f"{side}_rocker", parent="palm", child=f"{side}_rocker_link", place=(0.05 * sign, 0, 0.05), **hinge)
        + fixed(f"{side}_end", f"{side}_rocker_link", (0, 0, 0.06)) + fixed(f"{side}_pin", f"{side}_finger", (0.03 * sign, 0, 0))
    )  # fmt: skip


LEANING = '<joint name="mount" type="fixed"><parent link="wall"/><child link="palm"/><origin xyz="0.1 0.2 0.3" rpy="0.3 0.4 0.5"/></joint>'
GRIPPER = f'<robot name="gripper">{link("wall")}{link("palm")}{LEANING}{finger("left", -1)}{finger("right", 1)}</robot>'

# A delta robot: three arms, two parallel rods on each, and a platform that these keep from turning. It hangs on the first rod in the file.
SHOULDER, ARM, ROD, ANKLE, HALF = 0.2, 0.15, 0.4, 0.05, 0.04
ARMS, RODS = range(3), [(arm, sign) for arm in range(3) for sign in (-1, 1)]


def delta():
    text = [link("top"), link("plate", 0.4, "0 0 -0.01", INERTIA.format(4e-4, 5e-4, 6e-4))]
    for arm in ARMS:
        yaw = 2 * np.pi / 3 * arm
        text.append(link(f"arm{arm}", 0.3, "0.075 0 0", INERTIA.format(1e-4, 7e-4, 7e-4)))
        text.append(joint(f"drive{arm}", "continuous", "top", f"arm{arm}", (SHOULDER * np.cos(yaw), SHOULDER * np.sin(yaw), 0), "0 1 0", yaw))
    for arm, sign in RODS:
        rod = f"rod{arm}{'ab'[sign > 0]}"
        text += [fixed(f"{rod}_elbow", f"arm{arm}", (ARM, HALF * sign, 0)), link(rod, 0.05, f"0 0 {-ROD / 2}", ROD_INERTIA)]
        text += [turns(rod, f"{rod}_elbow", rod, "yx"), fixed(f"{rod}_end", rod, (0, 0, -ROD))]
        yaw = 2 * np.pi / 3 * arm
        text.append(fixed(f"{rod}_ankle", "plate", (ANKLE * np.cos(yaw) - HALF * sign * np.sin(yaw), ANKLE * np.sin(yaw) + HALF * sign * np.cos(yaw), 0)))
    x, y = ANKLE, -HALF  # where the first rod ends in the plate
    return f'<robot name="delta">{"".join(text)}{turns("wrist", "rod0a_end", "knot", "xyz")}{link("knot")}{joint("hold", "fixed", "knot", "plate", (-x, -y, 0))}</robot>'


# Stewart's platform: six legs, each a cylinder with a piston, from the floor to a platform, which is on the first of them in the file.
LEGS = range(6)
FLOOR = [np.array([0.5 * np.cos(a), 0.5 * np.sin(a), 0.0]) for a in np.radians([10, 110, 130, 230, 250, 350])]
CEILING = [np.array([0.3 * np.cos(a), 0.3 * np.sin(a), -0.02]) for a in np.radians([50, 70, 170, 190, 290, 310])]


def stewart():
    text = [link("floor"), link("plate", 5, "0.02 0.01 0.03", INERTIA.format(0.1, 0.12, 0.2))]
    for leg in LEGS:
        text += [fixed(f"foot{leg}", "floor", FLOOR[leg]), link(f"cylinder{leg}", 0.8, "0 0 0.1", INERTIA.format(4e-3, 4e-3, 3e-4))]
        text += [turns(f"foot{leg}", f"foot{leg}", f"cylinder{leg}", "xy"), link(f"piston{leg}", 0.4, "0 0 -0.1", INERTIA.format(2e-3, 2e-3, 1e-4))]
        text += [joint(f"piston{leg}", "prismatic", f"cylinder{leg}", f"piston{leg}"), fixed(f"head{leg}", "plate", CEILING[leg])]
    return f'<robot name="stewart">{"".join(text)}{turns("neck", "piston0", "knot", "xyz")}{link("knot")}{joint("hold", "fixed", "knot", "plate", -CEILING[0])}</robot>'


URDF = {"Gripper": GRIPPER, "Delta": delta(), "Stewart": stewart()}
# The two links that each <joint> holds together, and its type.
LOOPS = {
    "Gripper": [(f"{side}_end", f"{side}_pin", 'type="revolute" axis="y"') for side in ("left", "right")],
    "Delta": [(f"rod{arm}{'ab'[sign > 0]}_end", f"rod{arm}{'ab'[sign > 0]}_ankle", 'type="spherical"') for arm, sign in RODS[1:]],
    "Stewart": [(f"piston{leg}", f"head{leg}", 'type="spherical"') for leg in LEGS[1:]],
}


def system(name):
    joints = "".join(f'<joint name="loop{i}" {kind} from="r.{one}" to="r.{other}"/>' for i, (one, other, kind) in enumerate(LOOPS[name]))
    return f'<system name="{name}"><include file="robot.urdf" as="r"/>{joints}</system>'


@pytest.fixture(scope="module", autouse=True)
def robots():
    build_systems("loops", {name: system(name) for name in URDF}, files={f"{name}/robot.urdf": text for name, text in URDF.items()})


class Reference:
    """Pinocchio's tree with the loops as constraints, at states that fulfil them."""

    def __init__(self, name):
        urdf = URDF[name].replace("continuous", "revolute").replace("<axis", '<limit lower="-9" upper="9" effort="9" velocity="9"/><axis')
        self.model = pin.buildModelFromXML(urdf)
        self.data = self.model.createData()
        self.names = [*self.model.names[1:]]
        self.loops = [[self.model.getFrameId(end, pin.FrameType.BODY) for end in loop[:2]] for loop in LOOPS[name]]

    def place(self, link):
        return self.data.oMf[self.model.getFrameId(link, pin.FrameType.BODY)]

    def misfit(self, q):
        pin.framesForwardKinematics(self.model, self.data, q)
        return np.concatenate([self.data.oMf[other].translation - self.data.oMf[one].translation for one, other in self.loops])

    def jacobian(self, q):
        pin.computeJointJacobians(self.model, self.data, q)
        of = lambda frame: pin.getFrameJacobian(self.model, self.data, frame, pin.LOCAL_WORLD_ALIGNED)[:3]
        pin.updateFramePlacements(self.model, self.data)
        return np.concatenate([of(other) - of(one) for one, other in self.loops])

    def closed(self, q):
        """The nearest configuration in which the loops are closed."""
        for _ in range(50):
            q = q - np.linalg.pinv(self.jacobian(q), rcond=1e-9) @ self.misfit(q)
        assert np.max(np.abs(self.misfit(q))) < 1e-12
        return q

    def accelerations(self, q, v, torques):
        """And the force of each loop's other link on its first one, along the axes of the world."""
        mass = pin.crba(self.model, self.data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(self.model, self.data, q, v)
        jacobian = self.jacobian(q)
        pin.forwardKinematics(self.model, self.data, q, v, np.zeros_like(v))
        of = lambda frame: pin.getFrameClassicalAcceleration(self.model, self.data, frame, pin.LOCAL_WORLD_ALIGNED).linear
        drift = np.concatenate([of(other) - of(one) for one, other in self.loops])
        m, n = len(drift), len(v)
        matrix = np.block([[mass, jacobian.T], [jacobian, np.zeros((m, m))]])
        solution = np.linalg.lstsq(matrix, np.concatenate([torques - bias, -drift]), rcond=1e-12)[0]
        return solution[:n], solution[n:].reshape(-1, 3)


def start_of(name, reference, random):
    """An open robot in a usual position, moved about."""
    start = {joint: random.uniform(-0.2, 0.2) for joint in reference.names}
    for joint in reference.names:
        if name == "Gripper" and "knuckle" not in joint:
            start[joint] += 0.4
        if name == "Delta" and joint.startswith("drive"):
            start[joint] += 0.5
        if name == "Stewart" and joint.startswith("piston"):
            start[joint] += 0.6
    return reference.closed(np.array([start[joint] for joint in reference.names]))


@pytest.mark.parametrize("name", URDF)
def test_accelerations_and_forces(name, open_fmu):
    reference, instance = Reference(name), open_fmu(name, kind=FMU2Model)
    states, random = fmu.states_of(name), np.random.default_rng(1)
    order = [states.index(f"r.{joint}") for joint in reference.names] + [states.index(f"r.{joint}_velocity") for joint in reference.names]
    instance.initialize({f"r.{joint}": float(q) for joint, q in zip(reference.names, start_of(name, reference, random))})
    instance.fmu.enterContinuousTimeMode()
    state, derivatives = (c_double * len(states))(), (c_double * len(states))()
    torque_of = lambda joint: f"r.{joint}_{'force' if joint.startswith('piston') else 'torque'}"
    for _ in range(10):
        q = start_of(name, reference, random)
        jacobian = reference.jacobian(q)
        v = random.uniform(-1, 1, len(q))
        v -= np.linalg.pinv(jacobian, rcond=1e-9) @ (jacobian @ v)
        torques = random.uniform(-1, 1, len(q))
        expected, forces = reference.accelerations(q, v, torques)
        values = np.zeros(len(states))
        values[order] = [*q, *v]
        state[:] = values
        instance.set({torque_of(joint): torque for joint, torque in zip(reference.names, torques)})
        instance.fmu.setContinuousStates(state, len(states))
        instance.fmu.getDerivatives(derivatives, len(states))
        found = np.array(derivatives)[order][len(q) :]
        assert np.max(np.abs(found - expected)) < 1e-8 * max(1, np.max(np.abs(expected)))
        reference.misfit(q)
        for i, (one, _, _) in enumerate(LOOPS[name]):
            axes = reference.place(one).rotation
            told = axes @ [instance.get(f"loop{i}.force{axis}") for axis in "XYZ"]
            assert np.max(np.abs(told - forces[i])) < 1e-8 * max(1, np.max(np.abs(forces)))


def run(instance, reference, name, end):
    """The energy's change, and where the robot is in the end."""
    random = np.random.default_rng(3)
    instance.initialize({f"r.{joint}": float(q) for joint, q in zip(reference.names, start_of(name, reference, random))})
    energy = instance.get("totalEnergy")
    instance.run(end, 0.05)
    q = np.array([instance.get(f"r.{joint}") for joint in reference.names])
    assert np.max(np.abs(reference.misfit(q))) < 1e-9
    return instance.get("totalEnergy") - energy


def test_gripper_keeps_its_fingers_parallel(open_fmu):
    """And its energy; what the hinges hold across the plane of motion, they hold by no force."""
    instance = open_fmu("Gripper")
    assert abs(run(instance, Reference("Gripper"), "Gripper", 0.25)) < 1e-9
    for side in ("left", "right"):
        turned = instance.get(f"r.{side}_crank") + instance.get(f"r.{side}_knuckle")
        assert abs(np.sin(turned)) < 1e-9
    idle = [f"loop{i}.{force}" for i in range(2) for force in ("forceY", "torqueX", "torqueZ")]
    assert [instance.get(force) for force in idle] == [0.0] * 6


def test_delta_by_inverse_kinematics(open_fmu):
    """Each arm's angle follows from the plate's place: the tip of the arm is on a circle, and a rod's length from the plate's ankle."""
    reference, instance = Reference("Delta"), open_fmu("Delta")
    assert abs(run(instance, reference, "Delta", 1.0)) < 1e-8
    plate = np.array([instance.get(f"r.plate.{axis}") for axis in "xyz"])
    assert np.max(np.abs([instance.get(f"r.plate.R{i}{j}") - (i == j) for i in (1, 2, 3) for j in (1, 2, 3)])) < 1e-9
    for arm in ARMS:
        yaw = 2 * np.pi / 3 * arm
        along = plate @ [np.cos(yaw), np.sin(yaw), 0] + ANKLE - SHOULDER
        across = plate @ [-np.sin(yaw), np.cos(yaw), 0]
        # |(ARM cos a - along, across, -ARM sin a - z)| = ROD: along cos a - z sin a = k, the larger root.
        k = (ARM**2 + along**2 + across**2 + plate[2] ** 2 - ROD**2) / (2 * ARM)
        middle, spread = np.arctan2(-plate[2], along), np.arccos(k / np.hypot(along, plate[2]))
        angle = instance.get(f"r.drive{arm}")
        assert min(abs(np.sin((angle - middle - sign * spread) / 2)) for sign in (-1, 1)) < 1e-9


def test_stewart_by_inverse_kinematics(open_fmu):
    reference, instance = Reference("Stewart"), open_fmu("Stewart")
    assert abs(run(instance, reference, "Stewart", 0.3)) < 1e-7
    plate = np.array([instance.get(f"r.plate.{axis}") for axis in "xyz"])
    turned = np.array([[instance.get(f"r.plate.R{i}{j}") for j in (1, 2, 3)] for i in (1, 2, 3)])
    for leg in LEGS:
        assert instance.get(f"r.piston{leg}") == pytest.approx(np.linalg.norm(plate + turned @ CEILING[leg] - FLOOR[leg]), abs=1e-9)
