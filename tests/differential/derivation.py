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
        self.bodies = self._bodies(q, v)
        energy = sp.sympify(self.bodies + sum(map(self.convert, system.kinetic)))
        potential = sum(map(self.convert, system.potentials))
        dissipation = sp.sympify(sum(map(self.convert, system.dissipations)))
        forces = [sp.sympify(-sp.diff(dissipation, vi)) for vi in v]
        self.driven_power = sp.Integer(0)  # of forces whose points move in a given way
        for label, force in system.forces:
            forces[[c.name for c in system.coordinates].index(label)] += self.convert(force)
        for label, force in system.cartesian_forces:
            for axis, value in force.items():
                self.driven_power += self.convert(value) * sp.diff(self.symbols[f"{label}.{axis}"], time)
                for i, qi in enumerate(q):
                    forces[i] += self.convert(value) * sp.diff(self.symbols[f"{label}.{axis}"], qi)
        constraints = [sp.sympify(self.convert(c)) for c in system.constraints]
        self.mechanics = Mechanics(
            q, v, energy, sp.sympify(potential), forces, inputs=inputs, parameters=parameters, constraints=constraints
        )
        for label, expression in system.outputs.items():
            self.results[label] = sp.sympify(self.convert(expression))
        self._add_energies(potential, v)

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

    def _bodies(self, q, v):
        """Their kinetic energy."""
        energy = sp.Integer(0)
        for body in self.system.bodies:
            position = [self.symbols[f"{body.name}.{axis}"] for axis in body.position]
            energy += kinetic([(self.convert(body.mass), position)], q, v)
            if body.angle is not None:
                rate = self.rate(self.symbols[f"{body.name}.angle"])
                energy += self.convert(body.inertia) * rate**2 / 2
        return energy

    def _add_energies(self, potential, v):
        """As the README defines them: the energy that motion keeps."""
        kept = lambda term: sum(sp.diff(term, vi) * vi for vi in v) - term
        energy = self.bodies
        for term in map(self.convert, self.system.kinetic):
            energy += term if sp.Poly(term, *v).total_degree() == 2 else kept(term)
        stored = sp.sympify(-kept(sp.sympify(potential)))
        self.results |= {"kineticEnergy": energy, "potentialEnergy": stored, "totalEnergy": energy + stored}
