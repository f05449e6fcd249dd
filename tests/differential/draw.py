"""Random choices that are the same on every machine, and random smooth expressions."""

import math
import random

from .expressions import function, name, node


class Draw:
    """Random choices for one system, and the parameters that its expressions need."""

    def __init__(self, key, system):
        self.random, self.system = random.Random(key), system

    def chance(self, probability):
        return self.random.random() < probability

    def choice(self, values):
        return self.random.choice(list(values))

    def whole(self, low, high):
        return self.random.randint(low, high)

    def value(self, low, high):
        """Random number with three digits, so that files stay readable."""
        return float(f"{self.random.uniform(low, high):.3g}")

    def logarithmic(self, low, high):
        return float(f"{math.exp(self.random.uniform(math.log(low), math.log(high))):.2g}")

    def weighted(self, weights):
        return self.random.choices(list(weights), list(weights.values()))[0]

    def parameter(self, value, fixed=False):
        label = f"p{len(self.system.parameters) + 1}"
        self.system.parameters[label] = value
        if fixed:
            self.system.fixed.add(label)
        return name(label)

    def quantity(self, low, high):
        """A number or a parameter."""
        value = self.value(low, high)
        return self.parameter(value) if self.chance(0.5) else node(value)

    def width(self, low=1e-5, high=1.0):
        value = self.logarithmic(low, high)
        return value, (self.parameter(value, fixed=True) if self.chance(0.4) else node(value))


def call(operation):
    return lambda *operands: function(operation, *operands)


sin, cos, tan, exp, log, sqrt = map(call, ("sin", "cos", "tan", "exp", "log", "sqrt"))
asin, acos, atan, atan2 = map(call, ("asin", "acos", "atan", "atan2"))
sinh, cosh, tanh, asinh, acosh, atanh = map(call, ("sinh", "cosh", "tanh", "asinh", "acosh", "atanh"))
absolute, sign, minimum, maximum, power = map(call, ("abs", "sign", "min", "max", "pow"))

UNARY = [
    sin, cos, lambda u: tan(0.6 * sin(u)), lambda u: asin(0.8 * sin(u)), lambda u: acos(0.8 * cos(u)), atan,
    lambda u: sinh(sin(u)), lambda u: cosh(u / 3), tanh, asinh, lambda u: acosh(u**2 + 1.5),
    lambda u: atanh(0.7 * sin(u)), lambda u: exp(-(u**2)), lambda u: exp(sin(u)), lambda u: log(u**2 + 2),
    lambda u: sqrt(1 + u**2), lambda u: 1 / (1 + u**2), lambda u: (2 + sin(u)) ** -2, lambda u: u**2, lambda u: u**3,
    lambda u: (1 + u**2) ** 0.7, lambda u: (u**2 + 1) ** -1.5, lambda u: 2 ** sin(u), lambda u: 2 ** -(u**2), lambda u: -u,
    lambda u: power(cosh(u / 2), 0.5),
]  # fmt: skip
BINARY = [
    lambda u, w: u + w, lambda u, w: u - w, lambda u, w: u * w, lambda u, w: u * w, lambda u, w: u / (2 + w**2),
    lambda u, w: atan2(u, 2 + w**2), lambda u, w: atan2(1 + u**2, w), lambda u, w: (1.5 + sin(u)) ** cos(w),
    lambda u, w: sqrt(u**2 + w**2 + 0.5),
]  # fmt: skip


def smooth(draw, atoms, depth=2):
    """A smooth expression of the atoms, regular everywhere."""
    if depth == 0 or draw.chance(0.15):
        atom = draw.choice(atoms)
        return atom if draw.chance(0.6) else draw.quantity(0.4, 1.8) * atom
    if draw.chance(0.6):
        return draw.choice(UNARY)(smooth(draw, atoms, depth - 1))
    return draw.choice(BINARY)(smooth(draw, atoms, depth - 1), smooth(draw, atoms, depth - 1))
