"""
Robots with loops: a URDF is a tree, and each <joint> beside its <include> closes a loop. Accelerations and forces agree with the
constrained equations by Pinocchio's mass matrices and Jacobians; motions agree with the closed-form kinematics of parallel robots.
"""

from ctypes import c_double

import numpy as np
import pinocchio as pin
import pytest
from fmpy.fmi2 import FMU2Model

import fmu
from fmu import build_systems

pytestmark = pytest.mark.long

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


def rotations(name, parent, child, axes):
    """Revolute joints about one axis after the other, with massless links in between."""
    links = [parent, *(f"{name}_{i}" for i in range(1, len(axes))), child]
    between = "".join(map(link, links[1:-1]))
    return between + "".join(joint(f"{name}_{'xyz'['xyz'.index(axis)]}{i}", "continuous", links[i], links[i + 1], axis=" ".join(str(int(axis == a)) for a in "xyz")) for i, axis in enumerate(axes))


def fixed(name, parent, place, yaw=0.0):
    return link(name) + joint(f"{name}_mount", "fixed", parent, name, place, yaw=yaw)


# Two fingers, each on a crank and a rocker of the same length, on an inclined palm. The hinges' axes are the y axes of the links.
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

# A delta robot: three arms, two parallel rods on each, and a platform that they keep from rotating. In the file the platform is attached to
# the first rod.
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
        text += [rotations(rod, f"{rod}_elbow", rod, "yx"), fixed(f"{rod}_end", rod, (0, 0, -ROD))]
        yaw = 2 * np.pi / 3 * arm
        text.append(fixed(f"{rod}_ankle", "plate", (ANKLE * np.cos(yaw) - HALF * sign * np.sin(yaw), ANKLE * np.sin(yaw) + HALF * sign * np.cos(yaw), 0)))
    x, y = ANKLE, -HALF  # end of the first rod in the plate
    return f'<robot name="delta">{"".join(text)}{rotations("wrist", "rod0a_end", "knot", "xyz")}{link("knot")}{joint("hold", "fixed", "knot", "plate", (-x, -y, 0))}</robot>'


# Stewart's platform: six legs, each a cylinder with a piston, from the floor to a platform. In the file the platform is attached to the first leg.
LEGS = range(6)
FLOOR = [np.array([0.5 * np.cos(a), 0.5 * np.sin(a), 0.0]) for a in np.radians([10, 110, 130, 230, 250, 350])]
CEILING = [np.array([0.3 * np.cos(a), 0.3 * np.sin(a), -0.02]) for a in np.radians([50, 70, 170, 190, 290, 310])]


def stewart():
    text = [link("floor"), link("plate", 5, "0.02 0.01 0.03", INERTIA.format(0.1, 0.12, 0.2))]
    for leg in LEGS:
        text += [fixed(f"foot{leg}", "floor", FLOOR[leg]), link(f"cylinder{leg}", 0.8, "0 0 0.1", INERTIA.format(4e-3, 4e-3, 3e-4))]
        text += [rotations(f"foot{leg}", f"foot{leg}", f"cylinder{leg}", "xy"), link(f"piston{leg}", 0.4, "0 0 -0.1", INERTIA.format(2e-3, 2e-3, 1e-4))]
        text += [joint(f"piston{leg}", "prismatic", f"cylinder{leg}", f"piston{leg}"), fixed(f"head{leg}", "plate", CEILING[leg])]
    return f'<robot name="stewart">{"".join(text)}{rotations("neck", "piston0", "knot", "xyz")}{link("knot")}{joint("hold", "fixed", "knot", "plate", -CEILING[0])}</robot>'


# Two legs of a running robot. Each has a stiff leaf spring in the shin and one at the heel, which a rod connects with the thigh. A crank moves the
# foot by another rod. The rods are massless distance constraints.
BONES = {  # for each joint its parent, position and axis, then mass and centre of its link
    "roll": (None, (0.02, 0.135, 0), "1 0 0", 1.8, "-0.02 0 -0.04"),
    "yaw": ("roll", (0, 0, -0.07), "0 0 1", 1.2, "0 0 -0.03"),
    "pitch": ("yaw", (0, 0, -0.09), "0 1 0", 5.5, "0.06 0.03 0"),
    "knee": ("pitch", (0.12, 0, 0), "0 1 0", 0.8, "0.03 0 -0.02"),
    "shin": ("knee", (0.06, 0, -0.05), "0 1 0", 0.6, "0.18 0 0"),
    "tarsus": ("shin", (0.43, 0, -0.02), "0 1 0", 0.8, "0.11 0 0.03"),
    "heel": ("tarsus", (-0.01, 0, 0.03), "0 1 0", 0.13, "-0.08 0 0"),
    "crank": ("tarsus", (0.06, -0.02, 0.03), "0 1 0", 0.13, "0 0 0.01"),
    "foot": ("tarsus", (0.41, 0, 0.04), "0 1 0", 0.15, "0 0 0.03"),
}
SPRINGS = {"shin": 1500, "heel": 1250}
RODS_OF_LEG = {"achilles": [("pitch", (0, -0.045, 0)), ("heel", (-0.1, 0.01, 0))], "plantar": [("crank", (0, -0.01, 0.055)), ("foot", (0, -0.02, 0.05))]}
USUAL = {"pitch": 0.5, "knee": 1.2, "tarsus": -1.4}
SIDES = {"left": 1, "right": -1}


def legs():
    text = [link("pelvis")]
    for side, sign in SIDES.items():
        mirrored = lambda place: (place[0], sign * place[1], place[2])
        for name, (parent, place, axis, mass, centre) in BONES.items():
            above = "pelvis" if parent is None else f"{side}_{parent}_link"
            text.append(link(f"{side}_{name}_link", mass, centre, INERTIA.format(*(mass * np.array([2e-3, 3e-3, 2.5e-3])))))
            text.append(joint(f"{side}_{name}", "continuous", above, f"{side}_{name}_link", mirrored(place), axis))
        for rod, ends in RODS_OF_LEG.items():
            text += [fixed(f"{side}_{rod}_{i}", f"{side}_{name}_link", mirrored(place)) for i, (name, place) in enumerate(ends)]
    return f'<robot name="legs">{"".join(text)}</robot>'


URDF = {"Gripper": GRIPPER, "Delta": delta(), "Stewart": stewart(), "Legs": legs()}
# The two links that each <joint> connects, and its type.
LOOPS = {
    "Gripper": [(f"{side}_end", f"{side}_pin", 'type="revolute" axis="y"') for side in ("left", "right")],
    "Delta": [(f"rod{arm}{'ab'[sign > 0]}_end", f"rod{arm}{'ab'[sign > 0]}_ankle", 'type="spherical"') for arm, sign in RODS[1:]],
    "Stewart": [(f"piston{leg}", f"head{leg}", 'type="spherical"') for leg in LEGS[1:]],
    "Legs": [(f"{side}_{rod}_0", f"{side}_{rod}_1", "") for side in SIDES for rod in RODS_OF_LEG],
}


def system(name):
    joints = "".join(f'<joint name="loop{i}" {kind} from="r.{one}" to="r.{other}"/>' for i, (one, other, kind) in enumerate(LOOPS[name]))
    return f'<system name="{name}"><include file="robot.urdf" as="r"/>{joints}</system>'


def system_of_legs():
    ends = zip(LOOPS["Legs"], Legs("Legs").lengths)
    rods = "".join(f'<constraint name="rod{i}">distance(r.{one}, r.{other}) - {float(length)!r}</constraint>' for i, ((one, other, _), length) in enumerate(ends))
    springs = "".join(f"<potential>{stiffness}*r.{side}_{name}^2/2</potential>" for side in SIDES for name, stiffness in SPRINGS.items())
    return f'<system name="Legs"><include file="robot.urdf" as="r"/>{rods}{springs}</system>'


@pytest.fixture(scope="module", autouse=True)
def robots():
    texts = {name: system_of_legs() if name == "Legs" else system(name) for name in URDF}
    build_systems("loops", texts, files={f"{name}/robot.urdf": text for name, text in URDF.items()})


class Reference:
    """Pinocchio's tree with the loops as constraints, at states that satisfy them."""

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
        """Nearest configuration in which the loops are closed."""
        for _ in range(50):
            q = q - np.linalg.pinv(self.jacobian(q), rcond=1e-9) @ self.misfit(q)
        assert np.max(np.abs(self.misfit(q))) < 1e-12
        return q

    def accelerations(self, q, v, torques):
        """Accelerations, and the force of each loop's second link on its first one, along the world axes."""
        mass = pin.crba(self.model, self.data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(self.model, self.data, q, v)
        jacobian, drift = self.jacobian(q), self.drift(q, v)
        m, n = len(drift), len(v)
        matrix = np.block([[mass, jacobian.T], [jacobian, np.zeros((m, m))]])
        solution = np.linalg.lstsq(matrix, np.concatenate([torques - bias, -drift]), rcond=1e-12)[0]
        return solution[:n], solution[n:].reshape(len(self.loops), -1)

    def parting(self, q, v):
        """Relative velocities of the ends of each loop, and their rates at constant joint velocities."""
        pin.forwardKinematics(self.model, self.data, q, v, np.zeros_like(v))
        pin.updateFramePlacements(self.model, self.data)
        axes = pin.LOCAL_WORLD_ALIGNED
        velocity = lambda frame: pin.getFrameVelocity(self.model, self.data, frame, axes).linear
        acceleration = lambda frame: pin.getFrameClassicalAcceleration(self.model, self.data, frame, axes).linear
        return [np.array([of(other) - of(one) for one, other in self.loops]) for of in (velocity, acceleration)]

    def drift(self, q, v):
        return self.parting(q, v)[1].reshape(-1)


class Legs(Reference):
    """Each loop is a rod, as long as the distance of its ends in the usual pose."""

    def __init__(self, name):
        super().__init__(name)
        self.lengths = np.linalg.norm(self.lines(np.array([USUAL.get(joint.split("_")[1], 0.0) for joint in self.names])), axis=1)

    def lines(self, q):
        return Reference.misfit(self, q).reshape(-1, 3)

    def misfit(self, q):
        return np.linalg.norm(self.lines(q), axis=1) - self.lengths

    def directions(self, q):
        lines = self.lines(q)
        return lines / np.linalg.norm(lines, axis=1)[:, None]

    def jacobian(self, q):
        return np.einsum("ri,rij->rj", self.directions(q), Reference.jacobian(self, q).reshape(len(self.loops), 3, -1))

    def drift(self, q, v):
        velocity, acceleration = self.parting(q, v)
        along = self.directions(q)
        across = np.sum(velocity**2, axis=1) - np.sum(along * velocity, axis=1) ** 2
        return np.sum(along * acceleration, axis=1) + across / np.linalg.norm(self.lines(q), axis=1)


def start_of(name, reference, random):
    """Random open configuration near the usual one."""
    start = {joint: random.uniform(-0.2, 0.2) for joint in reference.names}
    for joint in reference.names:
        if name == "Gripper" and "knuckle" not in joint:
            start[joint] += 0.4
        if name == "Delta" and joint.startswith("drive"):
            start[joint] += 0.5
        if name == "Stewart" and joint.startswith("piston"):
            start[joint] += 0.6
        if name == "Legs":
            start[joint] += USUAL.get(joint.split("_")[1], 0.0)
    return reference.closed(np.array([start[joint] for joint in reference.names]))


@pytest.mark.parametrize("name", URDF)
def test_accelerations_and_forces(name, open_fmu):
    reference, instance = (Legs if name == "Legs" else Reference)(name), open_fmu(name, kind=FMU2Model)
    states, random = fmu.states_of(name), np.random.default_rng(1)
    order = [states.index(f"r.{joint}") for joint in reference.names] + [states.index(f"r.{joint}_velocity") for joint in reference.names]
    instance.initialize({f"r.{joint}": float(q) for joint, q in zip(reference.names, start_of(name, reference, random))})
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    state, derivatives = (c_double * len(states))(), (c_double * len(states))()
    torque_of = lambda joint: f"r.{joint}_{'force' if joint.startswith('piston') else 'torque'}"
    for _ in range(10):
        q = start_of(name, reference, random)
        jacobian = reference.jacobian(q)
        v = random.uniform(-1, 1, len(q))
        v -= np.linalg.pinv(jacobian, rcond=1e-9) @ (jacobian @ v)
        torques = random.uniform(-1, 1, len(q))
        springs = [SPRINGS.get(joint.split("_")[-1], 0.0) if name == "Legs" else 0.0 for joint in reference.names]
        expected, forces = reference.accelerations(q, v, torques - springs * q)
        values = np.zeros(len(states))
        values[order] = [*q, *v]
        state[:] = values
        instance.set({torque_of(joint): torque for joint, torque in zip(reference.names, torques)})
        instance.fmu.setContinuousStates(state, len(states))
        instance.fmu.getDerivatives(derivatives, len(states))
        found = np.array(derivatives)[order][len(q) :]
        assert np.max(np.abs(found - expected)) < 1e-8 * max(1, np.max(np.abs(expected)))
        reference.misfit(q)
        if name == "Legs":
            reported = [[instance.get(f"rod{i}.force")] for i in range(len(forces))]
            assert np.max(np.abs(reported - forces)) < 1e-8 * max(1, np.max(np.abs(forces)))
            continue
        for i, (one, _, _) in enumerate(LOOPS[name]):
            axes = reference.place(one).rotation
            reported = axes @ [instance.get(f"loop{i}.force{axis}") for axis in "XYZ"]
            assert np.max(np.abs(reported - forces[i])) < 1e-8 * max(1, np.max(np.abs(forces)))


def run(instance, reference, name, end):
    """Simulate; return the change of the energy, and check that the loops stay closed."""
    random = np.random.default_rng(3)
    instance.initialize({f"r.{joint}": float(q) for joint, q in zip(reference.names, start_of(name, reference, random))})
    energy = instance.get("totalEnergy")
    instance.run(end, 0.05)
    q = np.array([instance.get(f"r.{joint}") for joint in reference.names])
    assert np.max(np.abs(reference.misfit(q))) < 1e-9
    return instance.get("totalEnergy") - energy


def test_gripper_keeps_its_fingers_parallel(open_fmu):
    """The fingers stay parallel and the energy is constant; reaction forces across the plane of motion are 0."""
    instance = open_fmu("Gripper")
    assert abs(run(instance, Reference("Gripper"), "Gripper", 0.125)) < 1e-9  # from 0.136 s on the parallelograms lie flat, where they could fold
    for side in ("left", "right"):
        rotated = instance.get(f"r.{side}_crank") + instance.get(f"r.{side}_knuckle")
        assert abs(np.sin(rotated)) < 1e-9
    idle = [f"loop{i}.{force}" for i in range(2) for force in ("forceY", "torqueX", "torqueZ")]
    assert [instance.get(force) for force in idle] == [0.0] * 6


def test_delta_by_inverse_kinematics(open_fmu):
    """Each arm's angle follows from the plate's position: the arm's tip is on a circle, and a rod's length from the plate's ankle."""
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
    rotated = np.array([[instance.get(f"r.plate.R{i}{j}") for j in (1, 2, 3)] for i in (1, 2, 3)])
    for leg in LEGS:
        assert instance.get(f"r.piston{leg}") == pytest.approx(np.linalg.norm(plate + rotated @ CEILING[leg] - FLOOR[leg]), abs=1e-9)


WELD = """<mujoco><option gravity="0 0 0"/><worldbody><body name="a"><freejoint/><geom type="box" size="0.1 0.2 0.3"/></body></worldbody>
<equality><weld name="w" body1="a" relpose="0 0 0 {}"/></equality></mujoco>"""
START = '<system name="W"><include file="a.xml" as="r">{}</include></system>'


@pytest.mark.parametrize("axis", "xyz")
def test_a_weld_has_one_pose(axis, tmp_path):
    """A half rotation satisfies the constraints of a weld too; only relpose excludes it."""
    quaternion = [float(name == f"q{axis}") for name in ("qw", "qx", "qy", "qz")]

    def compiled(pose, angle):
        """Compile with the body rotated by an angle from its placement in the file."""
        parts = zip(("qw", f"q{axis}"), (np.cos(angle / 2), np.sin(angle / 2)))
        (tmp_path / "a.xml").write_text(WELD.format(" ".join(map(str, pose))))
        (tmp_path / "system.xml").write_text(START.format("".join(f'<coordinate name="a_{name}" start="{value!r}"/>' for name, value in ((n, float(v)) for n, v in parts))))
        return fmu.lagc("system.xml", "-o", "out", cwd=tmp_path)

    message = f"the joint 'w_loop' starts nearer to a half turn about {axis} than to its pose"
    for pose, angle, is_right in (([1, 0, 0, 0], np.pi, False), ([1, 0, 0, 0], 2.0, False), ([1, 0, 0, 0], 1.5, True), (quaternion, 0.0, False), (quaternion, 1.0, False), (quaternion, np.pi, True), (quaternion, 2.0, True)):
        result = compiled(pose, angle)
        assert result.returncode == 0 and (message in result.stderr) != is_right, (pose, angle, result.stderr)
