"""
A small master for two bodies and a spring between them, each an FMU, with the schemes of co-simulation side by side:
Jacobi, Gauss-Seidel, and iterated with rollback, by fixed point or by Newton's method. Between communication points
the force is a polynomial of a chosen degree, which the bodies get as derivatives of their input.
"""

import numpy as np

from coupling.slaves import FMUS, Slave


SCHEMES = {"jacobi": "Jacobi", "gauss_seidel": "Gauss-Seidel", "fixed_point": "fixed point", "newton": "Newton"}
DEGREES = {0: "held", 1: "linear", 2: "quadratic"}


class Diverged(Exception):
    """An iteration did not converge."""


def polynomial(times, values):
    """The coefficients, that of order 0 first, of the polynomial through the points (times, values)."""
    return np.linalg.solve(np.vander(times, increasing=True), values)


def derivatives_at_start(times, values):
    """Value and derivatives at time 0 of the polynomial through the points (times, values)."""
    coefficients = polynomial(times, values)
    return coefficients * [1.0, 1.0, 2.0, 6.0][: len(coefficients)]


def extrapolated(time, times, values):
    """The polynomial through the points (times, values), at another time."""
    return np.polynomial.polynomial.polyval(time, polynomial(times, values))


def push(body, name, derivatives, end):
    """Steps a body with a polynomial as an input."""
    body.set(**{name: derivatives[0]})
    body.set_derivatives(name, derivatives[1:])
    body.step_to(end)


def body_on_axis(m, kx=0.0):
    """Start values of a ParticleCartesian that moves along x alone, on a spring of its own."""
    return dict(m=m, kx=kx, ky=0.0, kz=0.0, g=0.0, x=0.0, y=0.0, z=0.0, vx=0.0, vy=0.0, vz=0.0)


class Master:
    """Two ParticleCartesian on the x axis, and a SpringDamper that has no state: force F on the left, -F on the right."""

    iterations = 60  # at most, of one communication step

    def __init__(self, m1, m2, k, c, own=0.0, l0=0.0):
        self.starts = [body_on_axis(m1, own), body_on_axis(m2, own)]
        self.left, self.right = (Slave(FMUS / "ParticleCartesian.fmu", **start) for start in self.starts)
        self.spring = Slave(FMUS / "SpringDamper.fmu", k=k, c=c, l0=l0)
        # The force by position and velocity of one end, and the acceleration by the force, for Newton's method.
        self.stiffness, self.damping = self.spring.partial("F1", "x1"), self.spring.partial("F1", "v1")
        self.mobility = self.left.partial("der(vx)", "Fx") + self.right.partial("der(vx)", "Fx")

    def begin(self, state, past=()):
        """state: x1, v1, x2, v2; past: (F, x2, v2) of earlier communication points, the latest first."""
        for body, start, (x, v) in zip((self.left, self.right), self.starts, (state[:2], state[2:])):
            body.restart(**(start | dict(x=x, vx=v)))
        self.past = [tuple(row) for row in past]

    def state(self):
        return [*self.left.get("x", "vx"), *self.right.get("x", "vx")]

    def force(self, x1, v1, x2, v2):
        self.spring.set(x1=x1, v1=v1, x2=x2, v2=v2)
        return self.spring.get("F1")

    def advance(self, times, values, end):
        """Steps both bodies under the polynomial through these forces; the spring's force at the end."""
        force = derivatives_at_start(times, values)
        push(self.left, "Fx", force, end)
        push(self.right, "Fx", -force, end)
        return self.force(*self.state())

    def observe(self):
        """What later extrapolations need, the coupling force first."""
        x1, v1, x2, v2 = self.state()
        return self.force(x1, v1, x2, v2), x2, v2

    def known(self, column, count, step):
        """Times before the step's start and values there of F, x2 or v2: the present, then the past."""
        values = [row[column] for row in self.past[:count]]
        return [-i * step for i in range(len(values))], values

    def step(self, scheme, degree, step):
        """One communication step; remembers what later extrapolations need."""
        self.past.insert(0, self.observe())
        # Where the past is too short to extrapolate from, a step that needs less of it keeps the order.
        getattr(self, scheme if len(self.past) > degree else "newton")(degree, step)
        del self.past[3:]

    def jacobi(self, degree, step):
        """Both bodies under the extrapolated force; they could run in parallel."""
        self.advance(*self.known(0, degree + 1, step), self.left.time + step)

    def gauss_seidel(self, degree, step):
        """The left body first; the right one under the force that the left one's new place gives, interpolated."""
        end = self.left.time + step
        push(self.left, "Fx", derivatives_at_start(*self.known(0, degree + 1, step)), end)
        ahead = [extrapolated(step, *self.known(column, degree + 1, step)) for column in (1, 2)]
        new = self.force(*self.left.get("x", "vx"), *ahead)
        times, values = self.known(0, degree, step)
        push(self.right, "Fx", -derivatives_at_start([step, *times], [new, *values]), end)

    def fixed_point(self, degree, step):
        self.iterate(degree, step, lambda residual: residual)

    def newton(self, degree, step):
        """The force at the end moves the bodies by double integrals of its basis polynomial over their masses."""
        times, values = self.known(0, degree, step)
        basis = derivatives_at_start([step, *times], [1.0, *(0.0 for _ in values)])
        velocity = sum(d * step ** (i + 1) / np.prod(range(1, i + 2)) for i, d in enumerate(basis))
        position = sum(d * step ** (i + 2) / np.prod(range(1, i + 3)) for i, d in enumerate(basis))
        slope = self.mobility * (self.stiffness * position + self.damping * velocity)
        self.iterate(degree, step, lambda residual: residual / (1.0 - slope))

    def iterate(self, degree, step, correction):
        """Repeats the step from saved states until the coupling force at its end is the one that was assumed."""
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
        """The states at all communication points."""
        self.begin(state)
        rows = [self.state()]
        for _ in range(steps):
            self.step(scheme, degree, end / steps)
            rows.append(self.state())
        return np.array(rows)
