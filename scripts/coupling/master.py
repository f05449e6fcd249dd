"""
Implement a small co-simulation master for two bodies and a spring between them, each an FMU.

The schemes are Jacobi, Gauss-Seidel, and iteration with rollback, by fixed point or Newton's method. Between communication points the force is a
polynomial of a chosen degree, which the bodies get as derivatives of their input (M. Busch: Continuous approximation techniques for
co-simulation methods, 2016).
"""

import numpy as np

from coupling.slaves import FMUS, Slave


SCHEMES = {"jacobi": "Jacobi", "gauss_seidel": "Gauss-Seidel", "fixed_point": "fixed point", "newton": "Newton"}
DEGREES = {0: "held", 1: "linear", 2: "quadratic"}


class Diverged(Exception):
    """An iteration did not converge."""


def polynomial(times, values):
    """Return the coefficients, in ascending order, of the polynomial through the points (times, values)."""
    return np.linalg.solve(np.vander(times, increasing=True), values)


def derivatives_at_start(times, values):
    """Return value and derivatives at time 0 of the polynomial through the points (times, values)."""
    coefficients = polynomial(times, values)
    return coefficients * [1.0, 1.0, 2.0, 6.0][: len(coefficients)]


def extrapolated(time, times, values):
    """Evaluate the polynomial through the points (times, values) at another time."""
    return np.polynomial.polynomial.polyval(time, polynomial(times, values))


def push(body, name, derivatives, end):
    """Step a body to `end`, with a polynomial input, given by value and derivatives."""
    body.set(**{name: derivatives[0]})
    body.set_derivatives(name, derivatives[1:])
    body.step_to(end)


def body_on_axis(m, kx=0.0):
    """Return start values of a ParticleCartesian that moves along x only, on its own spring of stiffness kx."""
    return dict(m=m, kx=kx, ky=0.0, kz=0.0, g=0.0, x=0.0, y=0.0, z=0.0, vx=0.0, vy=0.0, vz=0.0)


class Master:
    """
    A master of two ParticleCartesian on the x axis and a SpringDamper without state; the force is F on the left body and -F on the right one.

    `past` has the observations (F, x2, v2) at the last communication points, the latest first.
    """

    iterations = 60  # at most, in a communication step

    def __init__(self, m1, m2, k, c, own=0.0, l0=0.0):
        self.starts = [body_on_axis(m1, own), body_on_axis(m2, own)]
        self.left, self.right = (Slave(FMUS / "ParticleCartesian.fmu", **start) for start in self.starts)
        self.spring = Slave(FMUS / "SpringDamper.fmu", k=k, c=c, l0=l0)
        # Derivatives for Newton's method: of the force by position and velocity of one end, and of the relative acceleration by the force.
        self.stiffness, self.damping = self.spring.partial("F1", "x1"), self.spring.partial("F1", "v1")
        self.inverse_mass = self.left.partial("der(vx)", "Fx") + self.right.partial("der(vx)", "Fx")

    def begin(self, state, past=()):
        """Start at the state x1, v1, x2, v2, with the `past` of earlier communication points."""
        for body, start, (x, v) in zip((self.left, self.right), self.starts, (state[:2], state[2:])):
            body.restart(**(start | dict(x=x, vx=v)))
        self.past = [tuple(row) for row in past]

    def state(self):
        return [*self.left.get("x", "vx"), *self.right.get("x", "vx")]

    def force(self, x1, v1, x2, v2):
        self.spring.set(x1=x1, v1=v1, x2=x2, v2=v2)
        return self.spring.get("F1")

    def advance(self, times, values, end):
        """Step both bodies with the polynomial through these forces; return the spring's force at the end."""
        force = derivatives_at_start(times, values)
        push(self.left, "Fx", force, end)
        push(self.right, "Fx", -force, end)
        return self.force(*self.state())

    def observe(self):
        """Return the observation (F, x2, v2) that later extrapolations need."""
        x1, v1, x2, v2 = self.state()
        return self.force(x1, v1, x2, v2), x2, v2

    def known(self, column, count, step):
        """Return the last `count` times, relative to the step's start, and values of F, x2 or v2, the latest first."""
        values = [row[column] for row in self.past[:count]]
        return [-i * step for i in range(len(values))], values

    def step(self, scheme, degree, step):
        """Take a communication step, and record the observation before it."""
        self.past.insert(0, self.observe())
        # While the past is too short for the extrapolation, Newton's scheme, which needs one point less, keeps the order.
        getattr(self, scheme if len(self.past) > degree else "newton")(degree, step)
        del self.past[3:]

    def jacobi(self, degree, step):
        """Step both bodies with the extrapolated force; they could run in parallel."""
        self.advance(*self.known(0, degree + 1, step), self.left.time + step)

    def gauss_seidel(self, degree, step):
        """Step the left body with the extrapolated force, then the right one with the force at the left one's new position, interpolated."""
        end = self.left.time + step
        push(self.left, "Fx", derivatives_at_start(*self.known(0, degree + 1, step)), end)
        ahead = [extrapolated(step, *self.known(column, degree + 1, step)) for column in (1, 2)]
        new = self.force(*self.left.get("x", "vx"), *ahead)
        times, values = self.known(0, degree, step)
        push(self.right, "Fx", -derivatives_at_start([step, *times], [new, *values]), end)

    def fixed_point(self, degree, step):
        """Iterate the force at the end by fixed point."""
        self.iterate(degree, step, lambda residual: residual)

    def newton(self, degree, step):
        """
        Iterate the force at the end by Newton's method.

        A change of this force changes velocities and positions by the first and second integrals of its basis polynomial over the masses.
        """
        times, values = self.known(0, degree, step)
        basis = derivatives_at_start([step, *times], [1.0, *(0.0 for _ in values)])
        velocity = sum(d * step ** (i + 1) / np.prod(range(1, i + 2)) for i, d in enumerate(basis))
        position = sum(d * step ** (i + 2) / np.prod(range(1, i + 3)) for i, d in enumerate(basis))
        slope = self.inverse_mass * (self.stiffness * position + self.damping * velocity)
        self.iterate(degree, step, lambda residual: residual / (1.0 - slope))

    def iterate(self, degree, step, correction):
        """Repeat the step from saved states until the force at its end is equal to the assumed one; raise Diverged if that fails."""
        times, values = self.known(0, degree, step)
        new, end = self.past[0][0], self.left.time + step
        for _ in range(self.iterations):
            saved = self.left.save(), self.right.save()
            residual = self.advance([step, *times], [new, *values], end) - new
            if abs(residual) <= 1e-11 * max(1.0, abs(new)):
                for body, (state, _) in zip((self.left, self.right), saved):
                    body.fmu.freeFMUstate(state)
                return
            self.left.restore(saved[0])
            self.right.restore(saved[1])
            new += correction(residual)
            if not abs(new) < 1e12:
                break
        raise Diverged

    def run(self, scheme, degree, state, end, steps):
        """Return the states at all communication points."""
        self.begin(state)
        rows = [self.state()]
        for _ in range(steps):
            self.step(scheme, degree, end / steps)
            rows.append(self.state())
        return np.array(rows)
