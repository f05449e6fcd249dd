"""The truth about a system: SymPy's Lagrange equation from the generator's trees; nothing of lagc's is read."""

import sympy as sp

from mechanics import System as Mechanics
from mechanics import kinetic, time, velocity

from .expressions import in_sympy

AXES = "xyz"


class Derivation:
    """
    mechanics: mass matrix and right side; results: outputs, positions and energies by name; symbols in the order of
    mechanics.arguments are time, coordinates, velocities, inputs, parameters.
    """

    def __init__(self, system):
        self.system = system
        symbol = lambda label: sp.Symbol(label, real=True)
        self.symbols = {"time": time}
        q = [symbol(c.name) for c in system.coordinates]
        v = [symbol(c.velocity) for c in system.coordinates]
        inputs, parameters = [symbol(u) for u in system.inputs], [symbol(p) for p in system.parameters]
        self.symbols |= {s.name: s for s in [*q, *v, *inputs, *parameters]}
        self.rate = lambda expression: velocity(sp.sympify(expression), q, v)
        self.results = {}
        self._define(system)
        energy = self._kinetic(q, v)
        potential = sum(map(self.convert, system.potentials))
        dissipation = sp.sympify(sum(map(self.convert, system.dissipations)))
        forces = [sp.sympify(-sp.diff(dissipation, vi)) for vi in v]
        for label, force in system.forces:
            forces[[c.name for c in system.coordinates].index(label)] += self.convert(force)
        for label, force in system.cartesian_forces:
            for axis, value in force.items():
                for i, qi in enumerate(q):
                    forces[i] += self.convert(value) * sp.diff(self.symbols[f"{label}.{axis}"], qi)
        self.mechanics = Mechanics(q, v, energy, sp.sympify(potential), forces, inputs=inputs, parameters=parameters)
        for label, expression in system.outputs.items():
            self.results[label] = sp.sympify(self.convert(expression))
        stored = potential - sum(sp.diff(potential, vi) * vi for vi in v)
        self.results |= {"kineticEnergy": energy, "potentialEnergy": sp.sympify(stored), "totalEnergy": energy + stored}

    def convert(self, tree):
        return in_sympy(tree, self.symbols, self.rate)

    def _define(self, system):
        for body in system.bodies:
            for axis, tree in body.position.items():
                label = f"{body.name}.{axis}"
                self.symbols[label] = self.results[label] = sp.sympify(self.convert(tree))
            if body.angle is not None:
                self.symbols[f"{body.name}.angle"] = self.results[f"{body.name}.angle"] = self.convert(body.angle)
        for label, tree in system.definitions.items():
            self.symbols[label] = self.convert(tree)

    def _kinetic(self, q, v):
        energy = sum(map(self.convert, self.system.kinetic))
        for body in self.system.bodies:
            position = [self.symbols[f"{body.name}.{axis}"] for axis in body.position]
            energy += kinetic([(self.convert(body.mass), position)], q, v)
            if body.angle is not None:
                rate = self.rate(self.symbols[f"{body.name}.angle"])
                energy += self.convert(body.inertia) * rate**2 / 2
        return sp.sympify(energy)
