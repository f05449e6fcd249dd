"""
The motion of constrained FMUs in minimal coordinates y, for comparison: the same derivatives, by the same integrator, without a drift.

A form maps y to the states of the FMU, which then satisfy the constraints, and the derivatives there to those of y. With constraints g(q) = 0
of coordinates alone, y has independent coordinates and their velocities. The other coordinates follow by Newton's method, and their
velocities from the Jacobian of g, by differences along the imaginary axis (W. Squire, G. Trapp: Using complex variables to estimate
derivatives of real functions, SIAM Review 40, 1998).
"""

import ctypes

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Model
from fmpy.sundials import CVodeSolver

NEWTON_STEPS = 50
REDUNDANT = 1e-8  # relative singular values below which constraints depend on each other


def jacobian(constraints, q):
    """Return dg/dq, exact up to rounding."""
    columns = [np.imag(constraints(q + 1e-30j * unit)) / 1e-30 for unit in np.eye(len(q))]
    return np.array(columns).T


class Independent:
    """The first coordinate and its velocity, of a mechanism with one degree of freedom."""

    def __init__(self, constraints, q):
        self.constraints, self.q = constraints, np.array(q)

    def minimal(self, states):
        return states[[0, len(states) // 2]]

    def states(self, y):
        q = np.r_[y[0], self.q[1:]]
        for _ in range(NEWTON_STEPS):
            change = np.linalg.lstsq(jacobian(self.constraints, q)[:, 1:], -np.real(self.constraints(q)), rcond=REDUNDANT)[0]
            q[1:] += change
            if np.max(np.abs(change)) < 1e-15 * max(1.0, np.max(np.abs(q))):
                break
        self.q, slopes = q, jacobian(self.constraints, q)
        return np.r_[q, y[1], np.linalg.lstsq(slopes[:, 1:], -slopes[:, 0] * y[1], rcond=REDUNDANT)[0]]

    def rates(self, _, derivatives):
        return self.minimal(derivatives)


class Pendulum:
    """The angle of a pendulum of length l whose states are x, y, vx, vy."""

    def __init__(self, l):
        self.l = l

    def minimal(self, states):
        x, y, vx, vy = states
        return np.array([np.arctan2(x, -y), (x * vy - y * vx) / self.l**2])

    def states(self, y):
        sine, cosine = self.l * np.sin(y[0]), self.l * np.cos(y[0])
        return np.array([sine, -cosine, cosine * y[1], sine * y[1]])

    def rates(self, y, derivatives):
        return np.array([y[1], (derivatives[2] * np.cos(y[0]) + derivatives[3] * np.sin(y[0])) / self.l])


class Edge:
    """The coordinates x, y, phi of a knife edge, its speed along the edge, and its angular velocity."""

    def minimal(self, states):
        return np.r_[states[:3], states[3] * np.cos(states[2]) + states[4] * np.sin(states[2]), states[5]]

    def states(self, y):
        return np.r_[y[:3], y[3] * np.cos(y[2]), y[3] * np.sin(y[2]), y[4]]

    def rates(self, y, derivatives):
        ax, ay = derivatives[3:5]
        return np.r_[derivatives[:3], ax * np.cos(y[2]) + ay * np.sin(y[2]), derivatives[5]]


class Disk:
    """All coordinates x, y, yaw, lean, spin of a rolling disk of radius R, and the velocities of its three angles."""

    def __init__(self, R):
        self.R = R

    def minimal(self, states):
        return np.r_[states[:5], states[7:]]

    def states(self, y):
        (yaw, lean), (vyaw, vlean, vspin) = y[2:4], y[5:]
        along = self.R * (vspin + np.sin(lean) * vyaw)
        across = -self.R * np.cos(lean) * vlean
        velocity = along * np.cos(yaw) - across * np.sin(yaw), along * np.sin(yaw) + across * np.cos(yaw)
        return np.r_[y[:5], velocity, y[5:]]

    def rates(self, _, derivatives):
        return self.minimal(derivatives)


class Quaternion:
    """The states of a free body, whose quaternion is scaled to length 1 and moves along the sphere."""

    def minimal(self, states):
        return states

    def states(self, y):
        states = y.copy()
        states[:4] /= np.linalg.norm(states[:4])
        states[7:11] -= states[:4] * (states[:4] @ states[7:11])
        return states

    def rates(self, _, derivatives):
        return derivatives


def rotation(axis, angle):
    """Return the matrix of a rotation about the axis of this number, also for complex angles."""
    matrix, (i, j) = np.eye(3, dtype=complex), ((axis + 1) % 3, (axis + 2) % 3)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i], matrix[i, j] = np.sin(angle), -np.sin(angle)
    return matrix


def four_bar(p):
    def constraints(q):
        (theta, phi, psi), (a, b, c, d) = q, (p[name] for name in "abcd")
        return np.array([a * np.cos(theta) + b * np.cos(phi) - d - c * np.cos(psi), a * np.sin(theta) + b * np.sin(phi) - c * np.sin(psi)])

    return constraints


def bricard(p):
    rods = [(1, [1, 0, 0]), (2, [0, -1, 0]), (0, [0, 0, 1]), (1, [-1, 0, 0]), (2, [0, 1, 0])]  # axis of the joint, and direction

    def constraints(q):
        frame, end = np.eye(3), -p["l"] * np.array([0, 0, 1])
        for angle, (axis, direction) in zip(q, rods):
            frame = frame @ rotation(axis, angle)
            end = end + p["l"] * frame @ direction
        return np.r_[end, frame[1, 0], frame[2, 0]]

    return constraints


def squeezer(p):
    def constraints(q):
        beta, theta, gamma, phi, delta, omega, epsilon = q
        knee = p["rr"] * np.cos(beta) - p["d"] * np.cos(beta + theta), p["rr"] * np.sin(beta) - p["d"] * np.sin(beta + theta)
        loops = [
            (p["ss"] * np.sin(gamma) + p["xb"], -p["ss"] * np.cos(gamma) + p["yb"]),
            (p["e"] * np.sin(phi + delta) + p["zt"] * np.cos(delta) + p["xa"], -p["e"] * np.cos(phi + delta) + p["zt"] * np.sin(delta) + p["ya"]),
            (p["zf"] * np.cos(omega + epsilon) + p["u"] * np.sin(epsilon) + p["xa"], p["zf"] * np.sin(omega + epsilon) - p["u"] * np.cos(epsilon) + p["ya"]),
        ]
        return np.array([knee[axis] - loop[axis] for loop in loops for axis in (0, 1)])

    return constraints


# A form by the name of the FMU, from its parameters and its states at the start.
FORMS = {
    "PendulumCartesian": lambda p, _: Pendulum(p["l"]),
    "FourBar": lambda p, start: Independent(four_bar(p), start[:3]),
    "Bricard": lambda p, start: Independent(bricard(p), start[:5]),
    "FreeBody": lambda p, _: Quaternion(),
    "RollingDisk": lambda p, _: Disk(p["R"]),
    "KnifeEdge": lambda p, _: Edge(),
    "AndrewsSqueezer": lambda p, start: Independent(squeezer(p), start[:7]),
}


class NoInput:
    """The inputs keep their start values."""

    def apply(self, *_, **__):
        pass


def array(pointer, count):
    return np.ctypeslib.as_array(pointer, (count,))


def motion(archive, times, tolerance, start):
    """Return the states of the FMU at the times, by FMPy's CVode in minimal coordinates. start: the states at the first time."""
    description = fmpy.read_model_description(archive)
    parameters = {v.name: float(v.start) for v in description.modelVariables if v.causality == "parameter" and v.type == "Real"}
    form = FORMS[description.modelName](parameters, start)
    model = FMU2Model(guid=description.guid, unzipDirectory=fmpy.extract(archive), modelIdentifier=description.modelExchange.modelIdentifier)
    model.instantiate()
    model.setupExperiment()
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    y, derivatives = np.array(form.minimal(start)), (ctypes.c_double * len(start))()

    def write_rates(pointer, count):
        states = form.states(y)
        model.setContinuousStates(states.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), len(states))
        model.getDerivatives(derivatives, len(states))
        array(pointer, count)[:] = form.rates(y, np.array(derivatives))

    solver = CVodeSolver(
        len(y), 0,
        get_x=lambda pointer, count: np.copyto(array(pointer, count), y), set_x=lambda pointer, count: np.copyto(y, array(pointer, count)),
        get_dx=write_rates, get_z=lambda *_: None, get_nominals=lambda pointer, count: array(pointer, count).fill(1.0),
        set_time=model.setTime, input=NoInput(), startTime=times[0], maxStep=(times[-1] - times[0]) / 50, relativeTolerance=tolerance, maxNumSteps=100000,
    )  # fmt: skip
    rows, time = [start], times[0]
    for end in times[1:]:
        while time < end:
            *_, time = solver.step(time, end)
        rows.append(form.states(y))
    model.terminate()
    model.freeInstance()
    return np.array(rows)
