"""
Couple a cart and a pendulum that are split at the hinge.

The input of the cart is the force H of the rod, and its output the acceleration a. The pendulum has the input a and the output H. Both have direct
feedthrough, so that each communication point is an algebraic loop:

    H = h(theta, omega) - m sin(theta)^2 a,    M a = H

The loop gain is -m sin(theta)^2 / M. Schemes without iteration, or with fixed-point iteration, converge up to a limit of m / M only, whatever the
step (R. Kuebler, W. Schiehlen: Two methods of simulator coupling, 2000). Newton's method, with the loop gain from the FMUs' directional
derivatives, has no limit.
"""

import numpy as np
from scipy.integrate import solve_ivp

from coupling.master import DEGREES, SCHEMES, Diverged, Master, body_on_axis, derivatives_at_start, extrapolated, push
from coupling.slaves import FMUS, ROOT, Slave
from scripts.pages.html_page import paragraphs, table

PENDULUM = ROOT / "build" / "coupling" / "fmu" / "HingedPendulum.fmu"
START, END, G = [0.0, 0.0, np.pi / 2, 0.0], 1.0, 9.81  # x, v, theta, omega: the rod starts horizontal, where the loop gain is -m / M
LARGEST = 1e4  # m/s2, a thousand times the accelerations of the motion: larger ones mean divergence
RATIOS = [0.1, 0.5, 0.9, 1.1, 2.0, 10.0]  # values of m / M


class Hinge(Master):
    """A master of the cart, a ParticleCartesian on the x axis (left), and HingedPendulum (right). `now` is (H, a)."""

    def __init__(self, M, m, l=0.5):
        self.starts = body_on_axis(M), dict(m=m, l=l, g=G)
        self.left, self.right = (Slave(archive, **start) for archive, start in zip((FMUS / "ParticleCartesian.fmu", PENDULUM), self.starts))
        self.inverse_mass = self.left.partial("der(vx)", "Fx")

    def begin(self, state, past=()):
        """Start at the state x, v, theta, omega; `past` has (H, a) at earlier communication points, the latest first."""
        x, v, theta, omega = state
        self.left.restart(**(self.starts[0] | dict(x=x, vx=v)))
        self.right.restart(**(self.starts[1] | dict(theta=theta, omega=omega)))
        force = self.right.get("H") / (1.0 - self.slope())
        self.now = force, self.inverse_mass * force
        self.past = list(past)

    def slope(self):
        """Return the gain of the algebraic loop, dH/da * da/dH."""
        return self.right.partial("H", "a") * self.inverse_mass

    def state(self):
        return [*self.left.get("x", "vx"), *self.right.get("theta", "omega")]

    def observe(self):
        return self.now

    def swing(self, times, accelerations, end):
        """Step the pendulum with the polynomial through these accelerations; return its force at the end."""
        if not np.max(np.abs(accelerations)) < LARGEST:
            raise Diverged
        push(self.right, "a", derivatives_at_start(times, accelerations), end)
        self.right.set(a=extrapolated(end - self.start, times, accelerations))
        return self.right.get("H")

    def drive(self, times, forces, end):
        """Step the cart with the polynomial through these forces; return its acceleration at the end."""
        self.start = self.left.time
        push(self.left, "Fx", derivatives_at_start(times, forces), end)
        self.left.set(Fx=extrapolated(end - self.start, times, forces))
        return self.left.get("der(vx)")

    def advance(self, times, forces, end):
        """Step the cart with the forces, then the pendulum with the resulting acceleration; return the force at the end."""
        acceleration = self.drive(times, forces, end)
        before = [row[1] for row in self.past[: len(times) - 1]]
        force = self.swing(times, [acceleration, *before], end)
        self.now = force, acceleration
        return force

    def jacobi(self, degree, step):
        """Step both with extrapolated inputs; they could run in parallel."""
        end = self.left.time + step
        acceleration = self.drive(*self.known(0, degree + 1, step), end)
        self.now = self.swing(*self.known(1, degree + 1, step), end), acceleration

    def gauss_seidel(self, degree, step):
        """Step the cart with the extrapolated force, then the pendulum with the resulting acceleration, interpolated."""
        times, values = self.known(0, degree, step)
        self.advance([step, *times], [extrapolated(step, *self.known(0, degree + 1, step)), *values], self.left.time + step)

    def newton(self, degree, step):
        """Iterate with the loop gain at the start of the step, which differs from that at the end by O(step)."""
        slope = self.slope()
        self.iterate(degree, step, lambda residual: residual / (1.0 - slope))


def exact(M, m, l, state, times):
    """Return x, v, theta, omega at these times, from the equations of the whole system."""

    def rates(t, y):
        sine, cosine = np.sin(y[2]), np.cos(y[2])
        a, alpha = np.linalg.solve([[M + m, m * l * cosine], [cosine, l]], [m * l * sine * y[3] ** 2, G * sine])
        return [y[1], a, y[3], alpha]

    return solve_ivp(rates, (0, times[-1]), state, method="DOP853", t_eval=times, rtol=1e-12, atol=1e-13).y.T


def error_of(ratio, scheme, degree, steps):
    """Return the largest error of x (m) and theta (rad) at communication points, with M = 1 kg; infinite if the scheme diverges."""
    try:
        states = Hinge(1.0, ratio).run(scheme, degree, START, END, steps)
    except Diverged:
        return np.inf
    return float(np.max(np.abs(states - exact(1.0, ratio, 0.5, START, np.linspace(0, END, steps + 1)))[:, [0, 2]]))


def theory(scheme, degree):
    """
    Return the limit of r = m / M in the limit of short steps, in which the rod stays horizontal.

    An error of the force is multiplied by z in each step: z = -r e(z) for Gauss-Seidel, z^2 = -r e(z)^2 for Jacobi. Here e is the extrapolation by a
    polynomial of this degree from 1, 1/z, 1/z^2. A scheme is stable if all |z| <= 1.
    """
    if scheme in ("fixed_point", "newton"):
        return 1.0 if scheme == "fixed_point" else np.inf
    e = np.poly1d([[1.0], [2.0, -1.0], [3.0, -3.0, 1.0]][degree])  # times z^degree
    power = 1 if scheme == "gauss_seidel" else 2
    left = np.poly1d([1.0] + [0.0] * (power * (degree + 1)))
    grows = lambda r: np.max(np.abs((left + r * e**power).roots)) > 1.0
    return bisected(grows, 1e-3, 1e3)


def bisected(grows, low, high):
    """Return the ratio above which errors grow, by bisection of the logarithm."""
    while high / low > 1.01:
        middle = np.sqrt(low * high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return low


def limit(scheme, degree):
    """Return the observed limit of m / M, by steps of 1e-5 s from a force with an error of 1e-3; infinite if there is none."""

    def grows(ratio):
        master = Hinge(1.0, ratio)
        master.iterations, steps = 2000, 1 if scheme in ("fixed_point", "newton") else 100
        master.begin(START)
        force, acceleration = master.now
        master.now, master.past = (force + 1e-3, acceleration), [master.now] * degree
        try:
            for _ in range(steps):
                master.step(scheme, degree, 1e-5)
        except Diverged:
            return True
        return abs(master.now[0] - force) > 1e-3

    return bisected(grows, 1e-3, 1e3) if grows(1e3) else np.inf


def sections():
    """Return head and rows of the table, and the section of the page on coupling."""
    text = lambda number: f"{number:.3g}" if np.isfinite(number) else "none"
    errors = lambda *scheme: ["diverges" if np.isinf(e) else f"{e:.1e}" for e in (error_of(ratio, *scheme, 200) for ratio in RATIOS)]
    rows = [[f"{words}, {DEGREES[degree]}", text(theory(scheme, degree)), text(limit(scheme, degree)), *errors(scheme, degree)]
            for scheme, words in SCHEMES.items() for degree in DEGREES]  # fmt: skip
    head = ["scheme", "limit of m/M, theory", "found", *(f"m/M = {ratio:g}" for ratio in RATIOS)]
    first = ["A cart of mass M and a pendulum of mass m are split at the hinge: the cart takes the force of the rod and gives its "
             "acceleration, the pendulum takes the acceleration and gives the force. Both outputs depend on inputs at the same time, "
             "an algebraic loop.",
             f"The rod starts level and falls for {END:g} s in 200 steps. Errors are the largest of x [m] and theta [rad]. Beyond its "
             "limit of m/M a scheme diverges, however short the step; Newton's method with directional derivatives has no limit."]  # fmt: skip
    return head, rows, [("Split at the hinge: the cart and the pendulum", paragraphs(first) + table(head, rows))]
