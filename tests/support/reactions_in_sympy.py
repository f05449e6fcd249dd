"""
Systems with displacements and driven coordinates, typed again in SymPy. Each displaced or driven coordinate is an ordinary one with a
constraint and a Lagrange multiplier.
"""

from dataclasses import dataclass, field

import numpy as np
import sympy as sp
from sympy import cos, sin, symbols

from mechanics import System, kinetic, time, velocity


@dataclass
class ConstrainedSystem:
    """
    System whose coordinates `prescribed` (by index) have these accelerations; those of displacements are 0, as are their values. forces: the
    names of the multipliers and the sign of each in M a = Q + ... - J^T F.
    """

    system: System
    prescribed: dict
    forces: dict
    outputs: dict = field(default_factory=dict)

    def __post_init__(self):
        values = [*self.prescribed.values()]
        self.evaluate = self.system.evaluator("numpy")
        self.given = sp.lambdify(self.system.arguments, [sp.sympify(value) for value in values], modules="numpy")

    def solve(self, *arguments):
        """Solve [[M, J^T], [J, 0]] [a, F] = [Q + ..., given]; return the accelerations, and the multipliers F by name."""
        mass, terms = self.evaluate(*arguments)
        n, prescribed = len(mass), list(self.prescribed)
        matrix, right = np.zeros((n + len(prescribed), n + len(prescribed))), np.zeros(n + len(prescribed))
        matrix[:n, :n] = mass
        right[:n] = [sum(row) for row in terms]
        for k, (i, given) in enumerate(zip(prescribed, self.given(*arguments))):
            matrix[i, n + k] = matrix[n + k, i] = 1.0
            right[n + k] = given
        solution = np.linalg.solve(matrix, right)
        names = zip(self.forces.items(), solution[n:])
        return solution[:n], {name: sign * value for (name, sign), value in names}


m, l, g, b, k, J, F, tau, u = symbols("m l g b k J F tau u")


def constrained_system(q, v, particles, potential, forces, parameters, inputs, constrained, names, rotations=(), dissipation=0, further=0):
    """
    Build a ConstrainedSystem. particles: (mass, position); rotations: (inertia, angle); forces: (F, position), in addition to those of the dissipation.
    """
    T = kinetic(particles, q, v) + kinetic([(inertia, (angle,)) for inertia, angle in rotations], q, v) + further
    Q = [sum(f * sp.diff(x, qi) for f, x in forces) - sp.diff(dissipation, vi) for qi, vi in zip(q, v)]
    return ConstrainedSystem(System(q, v, T, sp.sympify(potential), Q, inputs, parameters), constrained, names)


def bearing():
    """Rod with inertia on a damped hinge, with a force at its end and a torque; its pivot and its angle have displacements."""
    theta, stretch, px, py, turn, omega, vs, vpx, vpy, vt = symbols("theta stretch px py turn omega vs vpx vpy vt")
    q, v = [theta, stretch, px, py, turn], [omega, vs, vpx, vpy, vt]
    angle = theta + turn
    bob = (px + (l + stretch) * sin(angle), py - (l + stretch) * cos(angle))
    drag = b * (velocity(bob[0], q, v) ** 2 + velocity(bob[1], q, v) ** 2) / 2
    return constrained_system(
        q, v, [(m, bob)], m * g * bob[1], [(F, bob[0]), (-2 * F, bob[1]), (tau, theta)], [m, l, g, b, J], [F, tau],
        {1: 0, 2: 0, 3: 0, 4: 0}, {"stretch.force": 1, "px.force": 1, "py.force": 1, "turn.force": 1},
        rotations=[(J, angle)], dissipation=drag,
    )  # fmt: skip


def chain(count=3):
    """Rods with displaced lengths, on a pivot that moves with time; the mass matrix is factored at run time."""
    names = ("theta", "omega", "stretch", "rate")
    theta, omega, stretch, rate = ([sp.Symbol(f"{name}[{i + 1}]") for i in range(count)] for name in names)
    q, v = [*theta, *stretch], [*omega, *rate]
    x, y, bobs = sin(2 * time) / 10, sp.Integer(0), []
    for i in range(count):
        x, y = x + (l + stretch[i]) * sin(theta[i]), y - (l + stretch[i]) * cos(theta[i])
        bobs.append((x, y))
    forces = {f"stretch[{i + 1}].force": 1 for i in range(count)}
    return constrained_system(
        q, v, [(m, bob) for bob in bobs], sum(m * g * bob[1] for bob in bobs), [(F, bobs[-1][0])], [m, l, g], [F],
        {count + i: 0 for i in range(count)}, forces,
    )  # fmt: skip


def charged():
    """Bead on a rotating wire in a magnetic field, with an extra kinetic energy; the displacement is across the wire."""
    s, d, v, vd = symbols("s d v vd")
    q, rates = [s, d], [v, vd]
    x, y = s * cos(u) - d * sin(u), s * sin(u) + d * cos(u)
    vx, vy = velocity(x, q, rates), velocity(y, q, rates)
    potential = -b * (x * vy - y * vx) / 2 + k * (s - l + d / 3) ** 2 / 2
    further = J * (vx + 2 * vy) ** 2 / 2
    return constrained_system(q, rates, [(m, (x, y))], potential, [], [m, l, b, k, J, u], [], {1: 0}, {"d.force": 1}, further=further)


a, M, h = symbols("a M h")


def crane():
    """Load on a crane whose trolley acceleration is an input; the rope's length has a displacement, and a force acts on the trolley."""
    x, theta, stretch, v, omega, vs = symbols("x theta stretch v omega vs")
    q, rates = [x, theta, stretch], [v, omega, vs]
    load = (x + (l + stretch) * sin(theta), -(l + stretch) * cos(theta))
    damping = b * v**2 / 2 + b * omega**2 / 2
    return constrained_system(
        q, rates, [(M, (x,)), (m, load)], m * g * load[1] + k * x**2 / 2, [(F, x)], [M, m, l, g, b, k], [F, u],
        {0: u, 2: 0}, {"x.force": -1, "stretch.force": 1}, dissipation=damping,
    )  # fmt: skip


def robot(count=4):
    """Chain of rods: the second has an acceleration prescribed in time and the last one an input; the others are free."""
    theta, omega = ([sp.Symbol(f"{name}[{i + 1}]") for i in range(count)] for name in ("theta", "omega"))
    x, y, bobs = sp.Integer(0), sp.Integer(0), []
    for i in range(count):
        x, y = x + l * sin(theta[i]), y - l * cos(theta[i])
        bobs.append((x, y))
    return constrained_system(
        theta, omega, [(m, bob) for bob in bobs], sum(m * g * bob[1] for bob in bobs), [], [m, l, g, a], [u],
        {1: a * cos(3 * time), 3: 2 * u}, {"theta[2].force": -1, "theta[4].force": -1},
    )  # fmt: skip


def arm():
    """Arm with both joints driven: only the torques are unknown."""
    alpha, beta, va, vb = symbols("alpha beta va vb")
    q, v = [alpha, beta], [va, vb]
    elbow = (l * cos(alpha), l * sin(alpha))
    hand = (elbow[0] + 2 * l * cos(alpha + beta), elbow[1] + 2 * l * sin(alpha + beta))
    weight = m * g * (elbow[1] + 3 * hand[1])
    return constrained_system(q, v, [(m, elbow), (3 * m, hand)], weight, [], [m, l, g], [u], {0: u, 1: 0}, {"alpha.force": -1, "beta.force": -1})


def moved(name):
    """Symbols of an input and its derivatives: coordinate, velocity, and prescribed acceleration."""
    return sp.Symbol(name), sp.Symbol(f"der({name})"), sp.Symbol(f"der(der({name}))")


def seat():
    """Seat with a driver on a moved floor; the tests ask for the force in the seat, not for that on the floor."""
    x, y, s, v, w, vs = symbols("x y s v w vs")
    zb, rate, acceleration = moved("zb")
    q, rates = [x, y, s, zb], [v, w, vs, rate]
    damping = b * (v - rate) ** 2 / 2 + a * (w - v) ** 2 / 2
    potential = k * (x + s - zb) ** 2 / 2 + 2 * k * (y - x) ** 2 / 2 + M * g * x + m * g * y
    return constrained_system(
        q, rates, [(M, (x,)), (m, (y,))], potential, [(F, x + zb**2 / h / 2)], [M, m, g, b, k, a, h],
        [F, acceleration], {2: 0, 3: acceleration}, {"s.force": 1}, dissipation=damping,
    )  # fmt: skip


def hoist(count=3):
    """Chain on a pivot that moves in x, with an input as length of the first rod: M depends on an input."""
    theta, omega = ([sp.Symbol(f"{name}[{i + 1}]") for i in range(count)] for name in ("theta", "omega"))
    (xp, rate, acceleration), (L, drawn, jerked) = moved("xp"), moved("L")
    x, y, bobs = xp, sp.Integer(0), []
    for i in range(count):
        length = L if i == 0 else l
        x, y = x + length * sin(theta[i]), y - length * cos(theta[i])
        bobs.append((x, y))
    return constrained_system(
        [*theta, xp, L], [*omega, rate, drawn], [(m, bob) for bob in bobs], sum(m * g * bob[1] for bob in bobs), [],
        [m, l, g], [acceleration, jerked], {count: acceleration, count + 1: jerked}, {},
    )  # fmt: skip


def table():
    """Bead on a table whose angle is an input, in a magnetic field, with inertias that rotate with the table."""
    r, vr = symbols("r vr")
    phi, rate, acceleration = moved("phi")
    q, v = [r, phi], [vr, rate]
    x, y = r * cos(phi), r * sin(phi)
    potential = -b * (x * velocity(y, q, v) - y * velocity(x, q, v)) / 2 + k * r**2 / 2
    further = J * (vr / l + rate) ** 2 / 2
    return constrained_system(q, v, [(m, (x, y))], potential, [], [m, l, b, k, J], [acceleration], {1: acceleration}, {}, further=further)


CASES = {
    "DisplacedBearing": bearing,
    "DisplacedChain": chain,
    "DisplacedWire": charged,
    "DrivenCrane": crane,
    "DrivenRobot": robot,
    "DrivenArm": arm,
    "MovedSeat": seat,
    "MovedHoist": hoist,
    "MovedTable": table,
}
