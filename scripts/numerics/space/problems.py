"""Define mechanisms of bodies in space with known solutions, and models of links and joints from which other programs are built."""

import functools
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from closed_forms import free_body_velocity, top_cosine
from fmu import start_values
from numerics.mechanisms.problems import GRAVITY, GROUND, Mechanism
from numerics.stiff.problems import StiffProblem, right_states


@dataclass
class Link:
    """A rigid body at the start, where its axes are parallel to the ground's, and the joint to its parent."""

    mass: float  # kg
    inertia: np.ndarray  # about the centre of mass, 3 x 3, in kg m2
    centre: np.ndarray  # centre of mass, in m
    joint: str  # "hinge", "slide", "ball" or "free"
    above: int | None = GROUND  # index of the parent
    point: tuple = (0.0, 0.0, 0.0)  # position of the joint
    axis: tuple = (0.0, 0.0, 1.0)  # axis of the joint
    velocity: tuple = (0.0, 0.0, 0.0)  # velocity of the centre of mass in m/s
    angular_velocity: tuple = (0.0, 0.0, 0.0)  # in rad/s
    motor: float = 0.0  # inertia of the drive, reduced to the joint, in kg m2
    friction: float = 0.0  # viscous, in N m s/rad


@dataclass
class Spring:
    """A spring and a damper between points of two links."""

    ends: tuple  # ((link, point), (link, point))
    stiffness: float  # N/m
    length: float  # natural length, in m
    damping: float  # N s/m


@dataclass
class Closing:
    """A hinge that closes a loop."""

    link: int
    other: int | None
    point: tuple
    axes: np.ndarray  # columns; the third is the axis of the hinge
    constrained: tuple  # 1 for each constrained translation and rotation, without redundant constraints; see CONSTRAINED of peers.py


class LinkMotions(NamedTuple):
    """The motion of all links (second index) at several times (first index)."""

    centres: np.ndarray  # centres of mass
    axes: np.ndarray  # rotation matrices, the identity at the start
    velocities: np.ndarray  # of the centres of mass
    angular_velocities: np.ndarray  # in the links' axes


@dataclass
class Spatial:
    """A mechanism of links, springs and hinges that close loops."""

    links: list
    gravity: tuple = (0.0, 0.0, -GRAVITY)
    springs: list = field(default_factory=list)
    closings: list = field(default_factory=list)

    def energy(self, motion):
        """Return the energies of LinkMotions, without those of springs and drives."""
        energies = 0.0
        for i, link in enumerate(self.links):
            velocity, angular_velocity = motion.velocities[:, i], motion.angular_velocities[:, i]
            energies = energies + link.mass * (np.sum(velocity**2, axis=1) / 2 - motion.centres[:, i] @ self.gravity)
            energies = energies + np.sum(angular_velocity @ link.inertia * angular_velocity, axis=1) / 2
        return energies

    def start(self):
        rows = lambda name: np.array([[getattr(link, name) for link in self.links]], float)
        return LinkMotions(rows("centre"), np.array([[np.eye(3)] * len(self.links)]), rows("velocity"), rows("angular_velocity"))

    def start_energy(self):
        return float(self.energy(self.start())[0])


def prism(mass, length, width, direction):
    """Return the inertia tensor of a square prism along one of the axes."""
    return np.diag([mass * (width**2 / 6 if i == direction else (length**2 + width**2) / 12) for i in range(3)])


def bricard():
    """Return Bricard's mechanism: rods along the edges of a cube, with a closing hinge about x."""
    value, links = start_values("Bricard"), []
    m, l, w = (value[name] for name in "mlw")
    corner, way = np.zeros(3), np.array([[1, 0, 0], [0, -1, 0], [0, 0, 1], [-1, 0, 0], [0, 1, 0]]) * l
    for i, (axis, rod) in enumerate(zip("yzxyz", way)):
        inertia = prism(m, l, w, int(np.argmax(np.abs(rod))))
        links.append(Link(m, inertia, corner + rod / 2, "hinge", i - 1 if i else GROUND, tuple(corner), tuple(np.eye(3)["xyz".index(axis)])))
        corner = corner + rod
    axes = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])  # columns y, z, x
    return Spatial(links, (0.0, -value["g"], 0.0), closings=[Closing(4, GROUND, tuple(corner), axes, (1, 1, 1, 1, 0, 0))])


def third_joint(motion):
    """Return the positions of the end of the third rod, which is along z at the start."""
    return motion.centres[:, 2] + start_values("Bricard")["l"] / 2 * motion.axes[:, 2, :, 2]


def governor():
    """Return the flyball governor: the shaft, the slider, and two arms, each with its ball as one body."""
    value = start_values("FlyballGovernor")
    L, w, e, h, ball, s = (value[name] for name in ("L", "w", "e", "h", "mBall", "s"))
    arm, slider, rate = value["rho"] * L * w**2, value["rho"] * e**3, value["Omega"]
    spin = np.array([0.0, 0.0, rate])
    links = [Link(arm, prism(arm, L, w, 2), np.array([0, 0, L / 2]), "hinge", angular_velocity=tuple(spin)),
             Link(slider, np.eye(3) * slider * e**2 / 6, np.array([0, 0, s]), "slide", 0, angular_velocity=tuple(spin))]  # fmt: skip
    springs, alpha = [], value["alpha[1]"]
    for side in (1, -1):
        out = np.array([side * np.cos(alpha), 0.0, -np.sin(alpha)])
        hinge, mass = np.array([side * h, 0.0, L]), arm + ball
        place = (arm * L / 2 + ball * L) / mass
        turn = np.array([out, [0, 1, 0], np.cross(out, [0, 1, 0])]).T
        across = np.diag([0.0, 1.0, 1.0]) * (arm * (place - L / 2) ** 2 + ball * (L - place) ** 2)
        inertia = turn @ (prism(arm, L, w, 0) + across) @ turn.T
        centre = hinge + place * out
        links.append(Link(mass, inertia, centre, "hinge", 0, tuple(hinge), (0.0, 1.0, 0.0), tuple(np.cross(spin, centre)), tuple(spin)))
        ends = ((len(links) - 1, hinge + L / 2 * out), (1, np.array([side * h, 0.0, s])))
        springs.append(Spring(ends, value["k"], value["l0"], value["c"]))
    return Spatial(links, springs=springs)


def top_axis(theta):
    """Return the axis of the top at the start, with the nutation angle about x."""
    return np.array([0.0, -np.sin(theta), np.cos(theta)])


def top():
    value = start_values("HeavyTop")
    axis = top_axis(value["theta"])
    inertia = value["I1"] * np.eye(3) + (value["I3"] - value["I1"]) * np.outer(axis, axis)
    return Spatial([Link(value["m"], inertia, value["l"] * axis, "ball", angular_velocity=tuple(value["vpsi"] * axis))])


def top_nutations(times):
    value = start_values("HeavyTop")
    A, weight = value["I1"] + value["m"] * value["l"] ** 2, value["m"] * value["g"] * value["l"]
    cosine = functools.partial(top_cosine, A, value["I3"], weight, value["theta"], value["vphi"], value["vtheta"], value["vpsi"])
    return np.arccos([[cosine(t)] for t in times])


def nutation(motion):
    return np.arccos(motion.axes[:, 0, 2] @ top_axis(start_values("HeavyTop")["theta"]))[:, None]


def free_body():
    value = start_values("FreeBody")
    inertia = np.diag([value[name] for name in ("I1", "I2", "I3")])
    return Spatial([Link(value["m"], inertia, np.zeros(3), "free", angular_velocity=tuple(value[name] for name in ("w1", "w2", "w3")))], (0.0, 0.0, 0.0))


def free_velocities(times):
    value = start_values("FreeBody")
    return np.array([free_body_velocity(*(value[name] for name in ("I1", "I2", "I3", "w1", "w2", "w3")), t) for t in times])


def slider_heights(times):
    """Return the slider's heights, by collocation of SymPy's equations (stiff/problems.py)."""
    problem = StiffProblem("FlyballGovernor", "FlyballGovernor", times[-1], len(times))
    return right_states(problem, "one step")[0][:, [problem.states.index("s")]]


def robot_arm():
    """
    Return the PUMA 560 by its modified Denavit-Hartenberg parameters, with all angles 0 at the start.

    Source: B. Armstrong, O. Khatib, J. Burdick: The explicit dynamic model and inertial parameters of the PUMA 560 arm, 1986.
    """
    value, links = start_values("RobotArm"), []
    a2, a3, d2, d3, d4 = (value[name] for name in ("a2", "a3", "d2", "d3", "d4"))
    # Twist and length before the joint, offset along its axis, centre of mass, moments of inertia. The first link needs only its moment about the axis.
    table = [(0, 0, 0, (0, 0, 0), (0.35, 0.35, 0.35)),
             (-np.pi / 2, 0, d2, (0.068, 0.006, -0.016), (0.13, 0.524, 0.539)),
             (0, a2, d3, (0, -0.070, 0.014), (0.066, 0.0125, 0.066)),
             (np.pi / 2, a3, d4, (0, 0, -0.019), (1.8e-3, 1.8e-3, 1.3e-3)),
             (-np.pi / 2, 0, 0, (0, 0, 0), (0.3e-3, 0.3e-3, 0.4e-3)),
             (np.pi / 2, 0, 0, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3))]  # fmt: skip
    masses = [1e-9, *(value[f"m{i}"] for i in range(2, 7))]  # the mass of the first link has no effect, since its centre does not move
    place, turn = np.zeros(3), np.eye(3)
    for i, ((twist, length, offset, centre, moments), mass) in enumerate(zip(table, masses)):
        place = place + turn @ [length, 0, 0]
        turn = turn @ Rotation.from_euler("X", twist).as_matrix()
        place = place + turn @ [0, 0, offset]
        gear, friction = value[f"n[{i + 1}]"] ** 2, value[f"bm[{i + 1}]"]
        links.append(Link(mass, turn @ np.diag(moments) @ turn.T, place + turn @ centre, "hinge", i - 1 if i else GROUND, tuple(place), tuple(turn[:, 2]),
                          motor=gear * value[f"Jm[{i + 1}]"], friction=gear * friction))  # fmt: skip
    return Spatial(links)


def tip_of_tool(motion):
    """Return the positions of the tool's tip, d6 along the flange's z axis from the wrist; the centre of mass is at 0.032 m."""
    reach = start_values("RobotArm")["d6"] - 0.032
    return motion.centres[:, 5] + reach * motion.axes[:, 5] @ np.array(robot_arm().links[5].axis)


def tips_of_tool(times):
    """Return the reference positions of the tool's tip, by Pinocchio's articulated-body algorithm and SciPy's method of order 8, for the same links."""
    import pinocchio as pin
    from scipy.integrate import solve_ivp

    arm, model = robot_arm(), pin.Model()
    for i, link in enumerate(arm.links):
        joint = pin.JointModelRevoluteUnaligned(np.array(link.axis))
        above = arm.links[link.above].point if link.above is not GROUND else np.zeros(3)
        model.addJoint(i, joint, pin.SE3(np.eye(3), np.array(link.point) - above), f"joint{i}")
        model.appendBodyToJoint(i + 1, pin.Inertia(link.mass, np.array(link.centre) - link.point, link.inertia), pin.SE3.Identity())
    model.armature, friction = np.array([link.motor for link in arm.links]), np.array([link.friction for link in arm.links])
    data = model.createData()
    derivative = lambda t, x: np.concatenate([x[6:], pin.aba(model, data, x[:6], x[6:], -friction * x[6:])])
    states = solve_ivp(derivative, (0, times[-1]), np.zeros(12), method="DOP853", rtol=1e-13, atol=1e-13, t_eval=times).y.T
    flange, tips = arm.links[5], []
    for state in states:
        pin.forwardKinematics(model, data, state[:6])
        tips.append(data.oMi[6].act(start_values("RobotArm")["d6"] * np.array(flange.axis)))
    return np.array(tips)


# Numbers of steps, multiples of numerics.driver.POINTS.
STEPS = [100, 200, 500, 1000, 2000, 5000, 10000, 30000, 100000]
PROBLEMS = [
    Mechanism("Bricard", "Bricard's mechanism (A04)", 10.0, "its energy", None, ["x", "y", "z"],
              [("drift", 1e-3, "IFToMM"), ("drift", 1e-7, "ours")], bricard(), STEPS, from_bodies=third_joint),
    Mechanism("FlyballGovernor", "flyball governor with stiff springs (A05)", 10.0, "collocation of SymPy's equations", slider_heights, ["s"],
              [("error", 1e-4, "ours"), ("error", 1e-7, "ours")], governor(), STEPS,
              from_bodies=lambda motion: motion.centres[:, 1, 2:], quick=False),
    Mechanism("HeavyTop", "heavy top, nutation", 10.0, "Jacobi's elliptic function", top_nutations, ["theta"],
              [("error", 1e-4, "ours"), ("error", 1e-8, "ours")], top(), STEPS, from_bodies=nutation),
    Mechanism("FreeBody", "free body that flips, angular velocity", 20.0, "Jacobi's elliptic functions", free_velocities,
              ["body.omegaX", "body.omegaY", "body.omegaZ"], [("error", 1e-4, "ours"), ("error", 1e-8, "ours")], free_body(), STEPS,
              from_bodies=lambda motion: motion.angular_velocities[:, 0], quick=False),
    Mechanism("RobotArm", "robot arm that falls, tip of the tool", 2.0, "Pinocchio with a method of order 8", tips_of_tool, ["tool.x", "tool.y", "tool.z"],
              [("error", 1e-4, "ours"), ("error", 1e-8, "ours")], robot_arm(), STEPS, from_bodies=tip_of_tool, programs=("MuJoCo",), quick=False),
]  # fmt: skip
