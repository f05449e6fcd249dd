"""
Motions to any number of digits: Taylor series of SymPy's equations in FLINT's ball arithmetic. The FMUs share none of it: SymPy derives,
FLINT computes functions of series, and Gaussian elimination solves with the mass matrix.
"""

from contextlib import contextmanager

import numpy as np
import sympy as sp
from flint import arb, arb_series, ctx


def on_series(name):
    def function(x):
        return getattr(x if isinstance(x, arb_series) else arb(x), name)()

    return function


def on_exponentials(name):
    """Hyperbolic functions of series, from exponentials; FLINT has them for numbers only."""
    def function(x):
        if not isinstance(x, arb_series):
            return getattr(arb(x), name)()
        root = lambda sign: (x * x + sign).sqrt()
        formulas = {
            "sinh": lambda: (x.exp() - (-x).exp()) / 2, "cosh": lambda: (x.exp() + (-x).exp()) / 2,
            "tanh": lambda: 1 - 2 / ((2 * x).exp() + 1), "asinh": lambda: (x + root(1)).log(),
            "acosh": lambda: (x + root(-1)).log(), "atanh": lambda: ((1 + x) / (1 - x)).log() / 2,
        }  # fmt: skip
        return formulas[name]()

    return function


def number(value):
    """Convert a number of SymPy: an integer, or mpmath's (sign, mantissa, exponent, bits)."""
    if not isinstance(value, tuple):
        return arb(value)
    sign, mantissa, exponent, _ = value
    return (-1) ** sign * arb(int(mantissa)) * arb(2) ** int(exponent)


FUNCTIONS = {name: on_series(name) for name in ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt")}
FUNCTIONS |= {name: on_exponentials(name) for name in ("sinh", "cosh", "tanh", "asinh", "acosh", "atanh")}
FUNCTIONS |= {"atan2": lambda y, x: FUNCTIONS["atan"](y / x), "mpf": number}
FUNCTIONS |= {"Raised": lambda base, exponent: FUNCTIONS["exp"](exponent * FUNCTIONS["log"](base))}


@contextmanager
def precision(digits, length):
    """Set FLINT's working precision and the number of series coefficients that it keeps."""
    before = ctx.prec, ctx.cap
    ctx.dps, ctx.cap = digits, length
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


def solve(matrix, right):
    """Solve by Gaussian elimination; the elements are numbers or series."""
    n = len(right)
    rows = [[*row, r] for row, r in zip(matrix, right)]
    for k in range(n):
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = rows[i][: k + 1] + [a - factor * b for a, b in zip(rows[i][k + 1 :], rows[k][k + 1 :])]
    solution = [None] * n
    for k in reversed(range(n)):
        total = rows[k][n]
        for j in range(k + 1, n):
            total = total - rows[k][j] * solution[j]
        solution[k] = total / rows[k][k]
    return solution


def coefficient(series, k):
    if isinstance(series, arb_series):
        return series[k] if k < len(series) else arb(0)
    return arb(series) if k == 0 else arb(0)


class ExactMotion:
    """Motion of a system of systems_in_sympy from values by symbol name, as trajectory() or coefficients()."""

    def __init__(self, definition, values, digits=40):
        self.definition, self.digits = definition, digits
        n = len(definition.q)
        self.constants = [values[s.name] for s in [*definition.inputs, *definition.parameters]]
        self.start = [values[s.name] for s in [*definition.q, *definition.v]]
        flat = [*definition.mass, *(sum(terms) for terms in definition.terms)]
        with precision(digits, 1):
            functions = FUNCTIONS | {"pi": arb.pi()}
        self.evaluate = sp.lambdify(definition.arguments, flat, modules=[functions, "mpmath"], cse=True)
        self.n = n

    def _accelerations(self, time, states):
        numbers = self.evaluate(time, *states, *map(arb, self.constants))
        mass = [numbers[i * self.n : (i + 1) * self.n] for i in range(self.n)]
        return solve(mass, numbers[self.n * self.n :])

    def coefficients(self, time, state, order):
        """
        Taylor coefficients of the states up to order: each order of the accelerations gives the next order of the states. The radii of the
        balls are dropped at each order, since they would grow far beyond the true rounding errors.
        """
        n, x = self.n, [[arb(value)] for value in state]
        for k in range(order):
            with precision(self.digits, k + 1):
                a = self._accelerations(arb_series([time, 1]), [arb_series(row) for row in x])
                for i in range(n):
                    x[i].append((x[n + i][k] / (k + 1)).mid())
                    x[n + i].append((coefficient(a[i], k) / (k + 1)).mid())
        return x

    def trajectory(self, times, start_time=0.0):
        """States at ascending times, as arrays of doubles; the error is about 10^(10 - digits) a step."""
        order, rows = self.digits, []
        time, state = arb(start_time), [arb(value) for value in self.start]
        with precision(self.digits, order + 1):
            x, reach = self._series(time, state, order)
            for target in map(arb, times):
                while target > time + reach:
                    time, state = time + reach, self._at(x, reach)
                    x, reach = self._series(time, state, order)
                rows.append([float(value) for value in self._at(x, target - time)])
        return np.array(rows)

    def _series(self, time, state, order):
        x = self.coefficients(time, state, order)
        tolerance = 10.0 ** (10 - self.digits)
        size = lambda k: max(abs(float(row[k])) for row in x) or 1e-300
        reach = min((tolerance / size(k)) ** (1 / k) for k in (order - 1, order))
        return x, arb(float(reach)).mid()

    @staticmethod
    def _at(x, s):
        """Evaluate the series by Horner's rule."""
        values = []
        for row in x:
            total = arb(0)
            for c in reversed(row):
                total = total * s + c
            values.append(total.mid())
        return values


def exact_series(definition, values, order):
    """Taylor coefficients of the states to 50 digits, as an array of doubles."""
    motion = ExactMotion(definition, {s.name: v for s, v in values.items()}, 50)
    start_time = next(v for s, v in values.items() if s.name == "time")
    rows = motion.coefficients(start_time, motion.start, order)
    return np.array([[float(c) for c in row] for row in rows])
