"""
Compute references of stiff problems, by collocation at Radau points of any order, in extended precision.

A step solves Z = h A F(x + Z) for all s stages at once by Newton's method, with Jacobians by differences (E. Hairer, G. Wanner: Solving Ordinary
Differential Equations II, section IV.5). The last two Legendre coefficients of the collocation polynomial estimate its error and control the
step. A step costs LU factorizations of size s n. No code is shared with the FMUs.
"""

import functools

import mpmath
import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import lu_factor, lu_solve

from references import solve

Extended = np.longdouble
TOLERANCE = 1e-13  # bound of the last two Legendre coefficients, in units of max(1, |state|)
ITERATION_LIMIT = 12  # iterations of Newton's method; a step that needs more is shortened


@functools.cache
def method(stages):
    """Return the Radau points in (0, 1], the matrix A, and the matrix from stages to the last two Legendre coefficients."""
    with mpmath.workdps(40):
        points = radau_points(stages)
        powers = mpmath.matrix(stages, stages)
        integrals = mpmath.matrix(stages, stages)
        for i, c in enumerate(points):
            for j in range(stages):
                powers[i, j], integrals[i, j] = c**j, c ** (j + 1) / (j + 1)
        A = integrals * powers**-1
        A = np.array([[Extended(mpmath.nstr(A[i, j], 25)) for j in range(stages)] for i in range(stages)])
        points = np.array([Extended(mpmath.nstr(c, 25)) for c in points])
    nodes = 2 * np.concatenate([[0], points]).astype(float) - 1
    return points, A, np.linalg.inv(legendre.legvander(nodes, stages))[-2:, 1:]


def radau_points(stages):
    """Return the roots of P_s(x) - P_(s-1)(x), one of which is x = 1, mapped to [0, 1]."""
    guesses = legendre.legroots([*[0] * (stages - 1), -1, 1])
    difference = lambda x: mpmath.legendre(stages, x) - mpmath.legendre(stages - 1, x)
    inner = [mpmath.findroot(difference, mpmath.mpf(float(x.real))) for x in sorted(guesses)[:-1]]
    return [(x + 1) / 2 for x in [*inner, mpmath.mpf(1)]]


def extended_right_side(definition, values):
    """
    Return the right-hand side f(x, changes) of an autonomous system of SymPy, in extended precision.

    Each state in x may be an array. `changes` has values of inputs and parameters by name that replace `values`.
    """
    evaluate, n = definition.evaluator("numpy"), len(definition.q)
    names = [symbol.name for symbol in [*definition.inputs, *definition.parameters]]

    def derivative(x, changes):
        mass, terms = evaluate(Extended(0), *x, *(Extended((values | changes)[name]) for name in names))
        rows = solve(mass, [sum(row) for row in terms])
        return np.array([*x[n:], *(row + 0 * x[0] for row in rows)])

    return derivative


def jacobians(f, x):
    """Return the Jacobians at the columns of x, by differences with about nine correct digits, which suffice for Newton's method."""
    f0, count = f(x), len(x)
    result = np.empty((x.shape[1], count, count))
    for j in range(count):
        h = Extended(1e-9) * np.maximum(1, np.abs(x[j]))
        moved = x.copy()
        moved[j] += h
        result[:, :, j] = ((f(moved) - f0) / h).T
    return result


def stages_of_step(f, x, h, points, A):
    """Solve Z = h F(x + Z) A^T, with a column for each stage, by simplified Newton iterations; return None if they do not converge."""
    stages, count = len(points), len(x)
    scale = np.maximum(1, np.abs(x))[:, None]
    Z, factors, before = np.zeros((count, stages), Extended), None, np.inf
    for _ in range(ITERATION_LIMIT):
        Y = x[:, None] + Z
        if factors is None:
            J = jacobians(f, Y)
            if not np.all(np.isfinite(J)):
                return None
            blocks = np.einsum("ij,jab->iajb", float(h) * A.astype(float), J).reshape(stages * count, -1)
            factors = lu_factor(np.eye(stages * count) - blocks)
        residual = h * f(Y) @ A.T - Z
        change = lu_solve(factors, residual.T.reshape(-1).astype(float)).reshape(stages, count).T
        if not np.all(np.isfinite(change)):
            return None
        Z = Z + change
        size = float(np.max(np.abs(change) / scale))
        if size < 1e-16 or (size < 1e-13 and size > 0.1 * before):
            return Z
        if size > 1e-3 * before:
            factors = None
        before = size
    return None


class Collocation:
    """The motion x' = f(x, changes); the step size is kept from one call of advance() to the next."""

    def __init__(self, f, x, stages):
        self.f, self.x, self.h = f, np.array(x, Extended), Extended(1e-6)
        self.stages = stages
        self.points, self.A, self.last_coefficients = method(stages)

    def advance(self, time, end, changes):
        """Integrate from `time` to `end`, with constant inputs and parameters `changes`."""
        f, time, end = lambda x: self.f(x, changes), Extended(time), Extended(end)
        while time < end:
            is_last = time + self.h * Extended(1.001) >= end
            h = end - time if is_last else self.h
            Z = stages_of_step(f, self.x, h, self.points, self.A)
            growth = 0.25
            if Z is not None:
                scale = np.maximum(1, np.max(np.abs(self.x[:, None] + Z), axis=1))
                coefficients = np.abs(self.last_coefficients @ Z.T.astype(float)) / scale.astype(float)
                error = float(np.max(coefficients))
                growth = min(4.0, max(0.2, 0.9 * (TOLERANCE / max(error, 1e-300)) ** (1 / self.stages)))
                if error <= TOLERANCE:
                    self.x, time = self.x + Z[:, -1], end if is_last else time + h
                    self.h = max(self.h, h * Extended(growth)) if is_last else h * Extended(growth)
                    continue
            if h < Extended(1e-17) * (end + 1):
                raise ArithmeticError(f"no step of the reference is small enough at {float(time)}")
            self.h = h * Extended(min(growth, 0.8))


def trajectory(f, start, times, steps, changes, stages):
    """Return the states at `times`, which are ends of some of the equal steps; changes(k) has the inputs in step k."""
    motion, end, rows = Collocation(f, start, stages), times[-1], []
    wanted = {round(steps * t / end) for t in times}
    for k in range(steps):
        motion.advance(end * k / steps, end * (k + 1) / steps, changes(k))
        if k + 1 in wanted:
            rows.append(motion.x.astype(float))
    return np.array(rows)
