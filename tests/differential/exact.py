"""Values at one point to 60 digits: accelerations, results, directional and time derivatives."""

import functools

import sympy as sp
from flint import arb, arb_series

import references
from references import coefficient, precision, solve

DIGITS = 60


def leading(x):
    return x[0] if isinstance(x, arb_series) else arb(x)


NOTHING = arb("nan")  # values at a kink are one-sided, and not compared


def sign(x):
    value = leading(x)
    return arb(1) if value > 0 else arb(-1) if value < 0 else NOTHING


def absolute(x):
    return arb(0) if not isinstance(x, arb_series) and leading(x) == 0 else sign(x) * x


def less(a, b):
    return (1 - sign(a - b)) / 2


def minimum(a, b):
    return (a + b - absolute(a - b)) / 2


def atan2(y, x):
    """atan2 of series, on the branch of C's atan2."""
    a, b = leading(y), leading(x)
    if b > 0 and b >= abs(a):
        return references.FUNCTIONS["atan"](y / x)
    if abs(a) > abs(b) or (b == 0 and a != 0):
        half = arb.pi() / 2 if a > 0 else -arb.pi() / 2
        return half - references.FUNCTIONS["atan"](x / y)
    if a == 0 and b == 0:
        return arb(0)
    return references.FUNCTIONS["atan"](y / x) + (arb.pi() if a >= 0 else -arb.pi())


def tanh(x):
    """tanh without overflow of exp."""
    negative = leading(x) < 0
    e = references.FUNCTIONS["exp"](2 * x if negative else -2 * x)
    return (e - 1) / (e + 1) if negative else (1 - e) / (1 + e)


FUNCTIONS = references.FUNCTIONS | {
    "atan2": atan2, "tanh": tanh, "Sign": sign, "sign": sign, "Absolute": absolute, "Abs": absolute, "Less": less,
    "Minimum": minimum, "Maximum": lambda a, b: -minimum(-a, -b), "Raised": lambda a, b: a**b,
}  # fmt: skip


def or_nothing(function):
    """Raise NoValue if FLINT cannot divide a series by 0."""

    @functools.wraps(function)
    def guarded(self, *arguments):
        try:
            return function(self, *arguments)
        except (ZeroDivisionError, ValueError):
            raise NoValue from None

    return guarded


class NoValue(Exception):
    """The exact value does not exist at this point."""


class Exact:
    """Values of one system at points."""

    def __init__(self, derivation):
        mechanics = derivation.mechanics
        self.n, self.rows, self.names = len(mechanics.q), len(mechanics.terms), list(derivation.results)
        flat = [*mechanics.mass, *(sp.sympify(sum(terms)) for terms in mechanics.terms), *derivation.results.values()]
        terms = [term for row in mechanics.terms for term in row]
        self.arguments = derivation.arguments
        with precision(DIGITS, 1):
            functions = FUNCTIONS | {"pi": arb.pi()}
        self.evaluate = sp.lambdify(mechanics.arguments, flat, modules=[functions, "mpmath"], cse=True)
        self.evaluate_terms = sp.lambdify(
            mechanics.arguments, [*mechanics.mass, *terms], modules=[functions, "mpmath"], cse=True
        )

    def _split(self, numbers):
        """Accelerations and results; rows of constraints follow those of the coordinates."""
        n = self.rows
        mass = [numbers[i * n : (i + 1) * n] for i in range(n)]
        return solve(mass, numbers[n * n : n * n + n])[: self.n], numbers[n * n + n :]

    @or_nothing
    def values(self, at):
        """Values of der(v) and of the results, from numbers by name."""
        with precision(DIGITS, 1):
            accelerations, results = self._split(self.evaluate(*[arb(at[name]) for name in self.arguments]))
            return [float(coefficient(x, 0)) for x in [*accelerations, *results]]

    @or_nothing
    def magnitudes(self, at):
        """Magnitudes of the terms that cancel in the accelerations."""
        n = self.rows
        with precision(DIGITS, 1):
            numbers = self.evaluate_terms(*[arb(at[name]) for name in self.arguments])
            mass = [numbers[i * n : (i + 1) * n] for i in range(n)]
            width = (len(numbers) - n * n) // n
            rows = [numbers[n * n + i * width : n * n + (i + 1) * width] for i in range(n)]
            sizes = [
                sum(abs(float(coefficient(arb(term) if not isinstance(term, arb_series) else term, 0))) for term in row)
                for row in rows
            ]
            columns = [solve(mass, [arb(i == j) for i in range(n)]) for j in range(n)]
            return [sum(abs(float(columns[j][i])) * sizes[j] for j in range(n)) for i in range(self.n)]

    @or_nothing
    def along(self, at, direction):
        """Derivative of values() along {name: part}."""
        with precision(DIGITS, 2):
            arguments = [arb_series([arb(at[name]), arb(direction.get(name, 0.0))]) for name in self.arguments]
            accelerations, results = self._split(self.evaluate(*arguments))
            return [float(coefficient(x, 1)) for x in [*accelerations, *results]]

    @or_nothing
    def in_time(self, at, inputs, order):
        """Rows of the coordinates, velocities and results: time derivatives 0..order; inputs: coefficients by name."""
        n = self.n
        states = self.arguments[1 : 1 + 2 * n]
        x = [[arb(at[name])] for name in states]
        for k in range(order + 1):
            with precision(DIGITS, k + 1):
                arguments = {name: arb(at[name]) for name in self.arguments}
                arguments["time"] = arb_series([arb(at["time"]), 1])
                arguments |= {name: arb_series([arb(c) for c in coefficients]) for name, coefficients in inputs.items()}
                arguments |= {name: arb_series(row) for name, row in zip(states, x)}
                accelerations, results = self._split(self.evaluate(*[arguments[name] for name in self.arguments]))
                if k < order:
                    for i in range(n):
                        x[i].append((x[n + i][k] / (k + 1)).mid())
                        x[n + i].append((coefficient(accelerations[i], k) / (k + 1)).mid())
        factorials = [1, 1, 2, 6]
        derivatives = lambda row: [float(row(k)) * factorials[k] for k in range(order + 1)]
        rows = [derivatives(lambda k, row=row: row[k]) for row in x]
        return rows + [derivatives(lambda k, r=r: coefficient(r, k)) for r in results]
