"""Reference equations of a system: SymPy's Lagrange equation from the generator's trees, independent of lagc."""

import numpy as np
import sympy as sp
from scipy.interpolate import CubicSpline, PchipInterpolator

from mechanics import System as Mechanics
from mechanics import kinetic, time, velocity

from .expressions import Maximum, Minimum, in_sympy

AXES = "xyz"


def curve(table):
    """SciPy's cubics by the distance in each interval, with linear extrapolation."""
    x, y = table.x, table.y
    cubics = {
        "monotone": lambda: PchipInterpolator(x, y).c,
        "spline": lambda: CubicSpline(x, y).c,
        "linear": lambda: np.array([np.zeros(len(x) - 1), np.zeros(len(x) - 1), np.diff(y) / np.diff(x), y[:-1]]),
    }[table.interpolation]()
    width = x[-1] - x[-2]
    slope = ((3 * cubics[0, -1] * width) + 2 * cubics[1, -1]) * width + cubics[2, -1]
    number = lambda value: sp.Float(float(value), 40)

    def at(u):
        """At a knot the slope is that of the interval to its right."""
        beyond = [Maximum(u - number(knot), 0) for knot in x]
        value = number(y[0]) + number(cubics[2, 0]) * Minimum(u - number(x[0]), 0) + number(slope) * beyond[-1]
        for i, (d, c, b, _) in enumerate(cubics.T):
            way = beyond[i] - beyond[i + 1]
            value += way * (number(b) + way * (number(c) + way * number(d)))
        return value

    return at


def integral(s, low, high, integrand):
    """Integrate a sum of products of powers and cosines of s, with factors without s, in closed form."""
    total = sp.Integer(0)
    for term in sp.Add.make_args(sp.expand(integrand)):
        factor, rest = term.as_independent(s, as_Add=False)
        primitive = sp.integrate(rest, s)
        total += factor * (primitive.subs(s, high) - primitive.subs(s, low))
    return total


class Derivation:
    """
    Equations of a system. mechanics: mass matrix and right side. results: outputs, positions and energies by name. arguments: the FMU's names of the
    symbols of mechanics, which are time, coordinates, velocities, inputs, parameters, and modes that samples set.
    """

    def __init__(self, system):
        self.system = system
        symbol = lambda label: sp.Symbol(label.replace(".", "_"), real=True)  # valid names in C, too
        self.symbols = {"time": time}
        q = [symbol(c.name) for c in system.coordinates]
        v = [symbol(c.velocity) for c in system.coordinates]
        inputs, parameters = [symbol(u) for u in system.inputs], [symbol(p) for p in [*system.parameters, *system.modes]]
        labels = [*system.positions, *system.velocities, *system.inputs, *system.parameters, *system.modes]
        self.arguments = ["time", *labels]
        self.symbols |= dict(zip(labels, [*q, *v, *inputs, *parameters]))
        self.rate = lambda expression: velocity(sp.sympify(expression), q, v)
        self.results = {}
        self.symbols |= {displacement: sp.Integer(0) for displacement in system.displacements}
        self.symbols |= {table.name: curve(table) for table in system.tables}
        self.symbols |= {mode: symbol(mode) for mode in system.switches.modes}
        self.symbols |= {dummy: sp.Symbol(dummy, real=True) for dummy in system.dummies} | {"integral": integral}
        self.symbols |= {label: self._function(one) for label, one in system.functions.items()}
        self._define(system)
        self.bodies = self._bodies(q, v) + sum(frame.kinetic(self.convert, q, v) for frame in system.frames)
        energy = sp.sympify(self.bodies + sum(map(self.convert, system.kinetic)))
        potential = sum(map(self.convert, system.potentials))
        potential += sum(self.symbols[c.name] ** 2 for c in system.coordinates if c.part)
        dissipation = sp.sympify(sum(map(self.convert, system.dissipations)))
        forces = [sp.sympify(-sp.diff(dissipation, vi)) for vi in v]
        self.prescribed_power = sp.Integer(0)  # power of forces whose points have prescribed motions
        for label, force in system.forces:
            forces[[c.name for c in system.coordinates].index(label)] += self.convert(force)
        for label, force in system.cartesian_forces:
            for axis, value in force.items():
                self.prescribed_power += self.convert(value) * sp.diff(self.symbols[f"{label}.{axis}"], time)
                for i, qi in enumerate(q):
                    forces[i] += self.convert(value) * sp.diff(self.symbols[f"{label}.{axis}"], qi)
        for i, c in enumerate(system.coordinates):
            if c.rate is not None:
                energy += v[i] ** 2 / 2
                forces[i] += self.convert(c.rate)
        constraints = [sp.sympify(self.convert(c)) for c in [*system.constraints, *system.prescribed_velocities]]
        self.mechanics = Mechanics(
            q, v, energy, sp.sympify(potential), forces, inputs=inputs, parameters=parameters, constraints=constraints
        )
        for label, expression in system.outputs.items():
            self.results[label] = sp.sympify(self.convert(expression))
        self._add_energies(potential, v)

    def _function(self, one):
        """Return what computes a <function> from SymPy's arguments, which hide variables of the same name."""
        return lambda *values: in_sympy(one.expression, self.symbols | dict(zip(one.arguments, values)), self.rate)

    def convert(self, tree):
        return in_sympy(tree, self.symbols, self.rate)

    def _define(self, system):
        for body in system.bodies:
            for axis, tree in body.position.items():
                label = f"{body.name}.{axis}"
                self.symbols[label] = self.results[label] = sp.sympify(self.convert(tree))
            if body.angle is not None:
                self.symbols[f"{body.name}.angle"] = self.results[f"{body.name}.angle"] = self.convert(body.angle)
        for frame in system.frames:
            for label, place in frame.places(self.convert).items():
                for axis, x in zip(AXES, place):
                    self.symbols[f"{label}.{axis}"] = self.results[f"{label}.{axis}"] = x
        for label, tree in system.definitions.items():
            self.symbols[label] = self.convert(tree)

    def _bodies(self, q, v):
        """Kinetic energy of the bodies."""
        energy = sp.Integer(0)
        for body in self.system.bodies:
            position = [self.symbols[f"{body.name}.{axis}"] for axis in body.position]
            energy += kinetic([(self.convert(body.mass), position)], q, v)
            if body.angle is not None:
                rate = self.rate(self.symbols[f"{body.name}.angle"])
                energy += self.convert(body.inertia) * rate**2 / 2
        return energy

    def _add_energies(self, potential, v):
        """Energies as the README defines them: the Jacobi integral for terms that are not quadratic in the velocities."""
        kept = lambda term: sum(sp.diff(term, vi) * vi for vi in v) - term
        energy = self.bodies
        for term in map(self.convert, self.system.kinetic):
            energy += term if sp.Poly(term, *v).total_degree() == 2 else kept(term)
        stored = sp.sympify(-kept(sp.sympify(potential)))
        self.results |= {"kineticEnergy": energy, "potentialEnergy": stored, "totalEnergy": energy + stored}
