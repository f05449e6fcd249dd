"""
Lagrange's equation for bodies in space, purely numerical. Velocities follow from positions and rotation matrices by complex steps, the derivatives by
central differences of order 8, in long doubles.
"""

import numpy as np

REAL, COMPLEX = np.longdouble, np.clongdouble
TINY, STEP = REAL("1e-60"), REAL("0.002")
WEIGHTS = [REAL(4) / 5, REAL(-1) / 5, REAL(4) / 105, REAL(-1) / 280]


def array(*values):
    return np.array([COMPLEX(value) for value in values])


def rotation(axis, angle):
    """Rotation matrix by Rodrigues' formula."""
    e = np.array([REAL(str(x)) for x in axis])
    e = e / np.sqrt(np.sum(e * e))
    cross = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]], dtype=COMPLEX)
    return np.eye(3, dtype=COMPLEX) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def rotation_of_quaternion(a, b, c, d):
    """Rotation matrix of v -> q v conj(q)."""
    return np.array([[a*a + b*b - c*c - d*d, 2*(b*c - a*d), 2*(b*d + a*c)], [2*(b*c + a*d), a*a - b*b + c*c - d*d, 2*(c*d - a*b)],
                     [2*(b*d - a*c), 2*(c*d + a*b), a*a - b*b - c*c + d*d]])  # fmt: skip


def slope(function, at=0.0):
    """Derivative d function(s) / ds at 0, by central differences."""
    return sum(w * (function(STEP * k) - function(-STEP * k)) for k, w in enumerate(WEIGHTS, 1)) / STEP


class Mechanism:
    """
    Mechanism of rigid bodies. places(time, q, inputs): bodies as (mass, rotation matrix, position, tensor). power(velocity, spin): power of the other
    forces. Its arguments return the velocity of a position, and the angular velocity of a rotation, as functions of (time, q, inputs). Inputs are
    given with their rates.
    """

    def __init__(self, places, gravity=(0, 0, 0), power=None, potential=lambda time, q, inputs: 0):
        self.places, self.gravity, self.power_of, self.potential = places, gravity, power, potential

    def _moved(self, at, s):
        """Return (time, q, inputs) a time s later; at: time, q, v, inputs and their rates."""
        t, q, v, u, ru = at
        return t + s, q + s * v, u + s * ru

    def velocity(self, function, at):
        return np.imag(function(*self._moved(at, 1j * TINY))) / TINY

    def spin(self, matrix, at):
        """Angular velocity along the rotated axes, from R^T dR/dt."""
        W = np.real(matrix(*self._moved(at, 0))).T @ self.velocity(matrix, at)
        return np.array([W[2, 1], W[0, 2], W[1, 0]])

    def energies(self, at):
        kinetic, potential = REAL(0), np.real(self.potential(*self._moved(at, 0)))
        now, later = self.places(*self._moved(at, 0)), self.places(*self._moved(at, 1j * TINY))
        for (mass, R, position, tensor), (_, rotated, moved, _) in zip(now, later):
            W = np.real(R).T @ (np.imag(rotated) / TINY)
            w, v = np.array([W[2, 1], W[0, 2], W[1, 0]]), np.imag(moved) / TINY
            kinetic += REAL(mass) * (v @ v) / 2 + w @ np.array(tensor, REAL) @ w / 2
            potential -= REAL(mass) * (np.array(self.gravity, REAL) @ np.real(position))
        return kinetic, potential

    def power(self, at):
        if self.power_of is None:
            return REAL(0)
        return self.power_of(lambda f: self.velocity(f, at), lambda f: self.spin(f, at), at)

    def _by_velocity(self, function, at, i):
        """Partial derivative by velocity i of a function that is a polynomial of degree 2 in the velocities."""
        t, q, v, u, ru = at
        e = np.eye(len(q), dtype=REAL)[i]
        return (function((t, q, v + e, u, ru)) - function((t, q, v - e, u, ru))) / 2

    def residual(self, at, a, au):
        """M a - f for accelerations a of the coordinates and au of the inputs."""
        t, q, v, u, ru = at
        later = lambda s: (t + s, q + s * v + s * s * a / 2, v + s * a, u + s * ru + s * s * au / 2, ru + s * au)
        rows = []
        for i in range(len(q)):
            e = np.eye(len(q), dtype=REAL)[i]
            momentum = slope(lambda s: self._by_velocity(lambda x: self.energies(x)[0], later(s), i))
            lagrangian = slope(lambda s: np.subtract(*self.energies((t, q + s * e, v, u, ru))))
            rows.append(momentum - lagrangian - self._by_velocity(self.power, at, i))
        return np.array(rows)

    def accelerations(self, time, q, v, inputs=(), rates=(), input_accelerations=(), constraint=None):
        """Solve for the accelerations; constraint: (J, right side) of J a = right side."""
        make = lambda values: np.array([REAL(x) for x in values], dtype=REAL)
        at, n, au = (REAL(time), make(q), make(v), make(inputs), make(rates)), len(q), make(input_accelerations)
        rest = self.residual(at, np.zeros(n, REAL), au)
        mass = np.array([self.residual(at, e, au) - rest for e in np.eye(n, dtype=REAL)]).T
        J, right = (np.zeros((0, n)), np.zeros(0)) if constraint is None else constraint
        matrix = np.block([[mass, np.transpose(J)], [J, np.zeros((len(J), len(J)))]])
        return np.linalg.solve(np.array(matrix, float), np.array([*-rest, *right], float))[:n]
