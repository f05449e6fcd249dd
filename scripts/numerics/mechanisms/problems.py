"""Define mechanisms with known solutions, and planar models of bodies and joints from which other programs are built."""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from closed_forms import pendulum_angle
from fmu import start_values
from numerics.driver import POINTS

GRAVITY = 9.81  # m/s2, along -y
GROUND = None  # in place of a body's index


@dataclass
class Body:
    """A planar body at the start, where its angle is 0. An inertia of 0 means a mass point."""

    mass: float  # kg
    inertia: float  # kg m2, about the centre of mass
    centre: np.ndarray  # centre of mass, in m
    velocity: tuple = (0.0, 0.0)  # m/s
    rate: float = 0.0  # rad/s


@dataclass
class Joint:
    """A hinge. The first hinge of a body connects it to the tree; further ones close loops."""

    body: int  # index
    other: int | None  # index, or GROUND
    point: np.ndarray  # position at the start


@dataclass
class Planar:
    """A planar mechanism."""

    bodies: list
    joints: list
    gravity: float = GRAVITY
    torque: tuple = (0, 0.0)  # (body, torque in N m)
    spring: tuple | None = None  # (body, its point at the start, point of the ground, stiffness in N/m, natural length in m)
    damping: float = 0.0  # damping of the spring in N s/m
    drag: float = 0.0  # drag of a single mass point in N s/m

    def start_energy(self):
        rows = [[np.array([*body.centre, 0.0]), np.array([*body.velocity, body.rate])] for body in self.bodies]
        positions, velocities = (np.concatenate([row[i] for row in rows]) for i in (0, 1))
        return float(self.energy(positions, velocities))

    def energy(self, positions, velocities):
        """Return the energies for rows of (x, y, angle) of each body and of their rates, without the energy of springs."""
        masses = np.array([[body.mass, body.mass, body.inertia] for body in self.bodies]).ravel()
        weights = np.array([[0.0, self.gravity * body.mass, 0.0] for body in self.bodies]).ravel()
        return velocities**2 @ masses / 2 + positions @ weights


@dataclass
class Mechanism:
    """A mechanism of the comparison, with its reference."""

    system: str  # name of the FMU
    title: str
    end: float  # s
    reference: str  # description of the reference
    expected: Callable | None  # function of times that returns rows of the compared quantities; None if only the energy is known
    compared: list  # names of the compared variables of the FMU
    levels: list  # errors at which times are compared: ("drift" in J or "error", level, origin of the level)
    model: object  # Planar, or Spatial of space/problems.py; None if the other programs cannot express it
    steps: list  # numbers of fixed steps, multiples of POINTS
    at_end: bool = False  # True if the reference is known at the end only
    from_bodies: Callable | None = None  # function of rows of (x, y, angle), or of LinkMotions in space, that returns the compared quantities
    programs: tuple = ("exudyn", "MuJoCo")  # programs that can express it
    quick: bool = True  # True if the quick report contains it

    @property
    def times(self):
        return np.array([self.end]) if self.at_end else self.end * np.arange(1, POINTS + 1) / POINTS

    @functools.cached_property
    def exact(self):
        return self.expected(self.times)

    def error(self, rows):
        """Return the largest error at the communication points, relative for values above 1; NaN without a reference."""
        if self.expected is None:
            return np.nan
        rows, exact = rows[-len(self.exact) :], self.exact
        return float(np.max(np.abs(rows - exact) / np.maximum(1.0, np.abs(exact))))


def direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def pendulum():
    """Return a mass of 1 kg on a rod of 1 m, released from the horizontal."""
    return Planar([Body(1.0, 0.0, np.array([-1.0, 0.0]))], [Joint(0, GROUND, np.zeros(2))])


def pendulum_positions(times):
    angles = np.array([pendulum_angle(-np.pi / 2, np.sqrt(GRAVITY), t) for t in times])
    return np.array([np.sin(angles), -np.cos(angles)]).T


def four_bars(count):
    """Return a row of four-bar linkages of uniform rods of 1 kg and 1 m, upright, whose upper joints move to the right with 1 m/s."""
    pillars = [Body(1.0, 1 / 12, np.array([i, 0.5]), (0.5, 0.0), -1.0) for i in range(count + 1)]
    beams = [Body(1.0, 1 / 12, np.array([i + 0.5, 1.0]), (1.0, 0.0)) for i in range(count)]
    feet = [Joint(i, GROUND, np.array([i, 0.0])) for i in range(count + 1)]
    left = [Joint(count + 1 + i, i, np.array([i, 1.0])) for i in range(count)]
    right = [Joint(count + 1 + i, i + 1, np.array([i + 1, 1.0])) for i in range(count)]
    return Planar(pillars + beams, feet + left + right)


def squeezer():
    """Return Andrews' squeezer mechanism, with the numbers and names of the test set for initial value problems, as in fmu/AndrewsSqueezer."""
    value = start_values("AndrewsSqueezer")
    lengths = ["rr", "ra", "d", "da", "e", "ea", "sa", "sb", "sc", "sd", "ta", "tb", "u", "ua", "ub", "zf", "zt", "fa"]
    rr, ra, d, da, e, ea, sa, sb, sc, sd, ta, tb, u, ua, ub, zf, zt, fa = (value[name] for name in lengths)
    a, b, c = (np.array([value[f"x{name}"], value[f"y{name}"]]) for name in "abc")
    crank, rod, lever = (direction(value["beta"]), direction(value["beta"] + value["theta"]), direction(value["gamma"]))
    left, upper = direction(value["phi"] + value["delta"]), direction(value["delta"])
    right, lower = direction(value["omega"] + value["epsilon"]), direction(value["epsilon"])
    below = lambda way: np.array([way[1], -way[0]])  # rotates by -90 degrees
    knee, left_joint, right_joint = rr * crank - d * rod, a + zt * upper, a + u * below(lower)
    centres = [ra * crank, rr * crank - da * rod, b + sa * below(lever) + sb * lever, left_joint + (e - ea) * below(left),
               a + ta * upper - tb * below(upper), right_joint + (zf - fa) * right, a + ua * below(lower) - ub * lower]  # fmt: skip
    bodies = [Body(value[f"m{i}"], value[f"I{i}"], centre) for i, centre in enumerate(centres, 1)]
    joints = [Joint(0, GROUND, np.zeros(2)), Joint(1, 0, rr * crank), Joint(2, GROUND, b), Joint(4, GROUND, a),
              Joint(6, GROUND, a), Joint(3, 4, left_joint), Joint(5, 6, right_joint),
              Joint(2, 1, knee), Joint(3, 1, knee), Joint(5, 1, knee)]  # fmt: skip
    spring = (2, b + sc * below(lever) + sd * lever, c, value["c0"], value["l0"])
    return Planar(bodies, joints, 0.0, (0, value["torque"]), spring)


ANGLES = ["beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"]
# Angles at 0.03 s from the test set for initial value problems (F. Mazzia, C. Magherini).
SQUEEZED = [15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
            0.5244099658805304, 0.5347301163226948, 1.048080741042263]  # fmt: skip


def squeezer_angles(positions):
    """Return the angles of the test set, some of which are relative, from the rotations of the seven bodies."""
    value = start_values("AndrewsSqueezer")
    one, two, three, four, five, six, seven = positions[:, 2::3].T
    return np.array([one, two - one, three, four - five, five, six - seven, seven]).T + [value[name] for name in ANGLES]


def cycloid(times):
    """Return the positions of the knife edge, on a cycloid (J. Neimark, N. Fufaev: Dynamics of nonholonomic systems)."""
    scale = GRAVITY * np.sin(0.2) / 2
    return scale * np.array([np.sin(times) ** 2, times - np.sin(2 * times) / 2]).T


PROBLEMS = [
    Mechanism("PendulumCartesian", "pendulum in x and y (A01)", 10.0, "Jacobi's elliptic function", pendulum_positions, ["x", "y"],
              [("drift", 5e-5, "IFToMM"), ("error", 1e-4, "ours"), ("error", 1e-8, "ours")], pendulum(),
              [100, 200, 300, 1000, 3000, 10000, 30000, 100000], from_bodies=lambda positions: positions[:, :2]),
    Mechanism("NFourBar", "row of 40 four-bar linkages (A02)", 10.0, "its energy", None, [],
              [("drift", 0.1, "IFToMM"), ("drift", 1e-4, "ours")], four_bars(40), [200, 500, 1000, 2000, 5000, 10000]),
    Mechanism("AndrewsSqueezer", "Andrews' mechanism (A03)", 0.03, "values of the IVP test set at 0.03 s", lambda times: np.array([SQUEEZED]), ANGLES,
              [("error", 1e-2, "ours"), ("error", 1e-4, "ours"), ("error", 1e-8, "ours")], squeezer(), [100, 200, 300, 1000, 3000, 10000, 30000],
              at_end=True, from_bodies=squeezer_angles),
    Mechanism("KnifeEdge", "knife edge on a slope", 10.0, "cycloid", cycloid, ["x", "y"],
              [("error", 1e-4, "ours"), ("error", 1e-8, "ours")], None, [], programs=()),
]  # fmt: skip
