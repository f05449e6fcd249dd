"""Independent derivation: SymPy applies Lagrange's equation to energies typed in SymPy's notation."""

from dataclasses import dataclass, field

import mpmath
import numpy as np
import sympy as sp

time = sp.Symbol("time")


@dataclass
class System:
    """System with kinetic energy T, potential U and generalized forces Q as functions of the symbols below; positions by particle name."""

    q: list
    v: list
    T: sp.Expr
    U: sp.Expr
    Q: list
    inputs: list = field(default_factory=list)
    parameters: list = field(default_factory=list)
    positions: dict = field(default_factory=dict)
    linearized_at: dict = None
    constraints: list = field(default_factory=list)  # each 0 at all times: functions of q and time, or linear in v
    rates: dict = field(default_factory=dict)  # time derivatives of inputs, for inputs given with them

    def __post_init__(self):
        self.Q = self.Q or [sp.Integer(0)] * len(self.q)
        L = self.T - self.U
        a = [sp.Symbol(f"a{i}") for i in range(len(self.q))]
        self.mass, self.terms = sp.zeros(len(a)), []
        for i, (qi, vi) in enumerate(zip(self.q, self.v)):
            momentum = sp.diff(L, vi)
            for j, vj in enumerate(self.v):
                self.mass[i, j] = sp.diff(momentum, vj)
            self.terms.append(
                [self.Q[i], sp.diff(L, qi), -sp.diff(momentum, time)]
                + [-sp.diff(momentum, qj) * vj for qj, vj in zip(self.q, self.v)]
                + [-sp.diff(momentum, u) * rate for u, rate in self.rates.items()]
            )
        if self.linearized_at is not None:
            self._linearize()
        if self.constraints:
            self._add_constraints()
        self.arguments = [time, *self.q, *self.v, *self.inputs, *self.parameters]

    def _add_constraints(self):
        """Extend mass to (M J^T; J 0) and terms by the right side of J a; evaluator() then returns more rows than q has."""
        rates = [c if c.has(*self.v) else velocity(c, self.q, self.v) for c in map(sp.sympify, self.constraints)]
        jacobian = sp.Matrix(len(rates), len(self.q), lambda i, j: sp.diff(rates[i], self.v[j]))
        self.mass = sp.Matrix(sp.BlockMatrix([[self.mass, jacobian.T], [jacobian, sp.zeros(len(rates))]]))
        for rate in rates:
            terms = [-sp.diff(rate, time), *(-sp.diff(rate, qj) * vj for qj, vj in zip(self.q, self.v))]
            self.terms.append(terms + [sp.Integer(0)] * (len(self.terms[0]) - len(terms)))

    def _linearize(self):
        """
        Linearize at an equilibrium: M a = rhs becomes M0 a = d rhs / d(q, v, u) (q, v, u). The derivative of M drops out since a = 0.
        """
        point = {symbol: self.linearized_at.get(symbol, 0) for symbol in [*self.q, *self.v, *self.inputs]}
        self.mass = self.mass.subs(point)
        for i, terms in enumerate(self.terms):
            right = sum(terms)
            assert sp.simplify(right.subs(point)) == 0, "this point is no equilibrium"
            self.terms[i] = [sp.diff(right, s).subs(point) * (s - value) for s, value in point.items()]

    def evaluator(self, module):
        """Compile a function of the arguments that returns the rows of M and the terms of the right side, one row per equation."""
        n = len(self.terms)
        flat = [*self.mass, *(term for terms in self.terms for term in terms)]
        compiled = sp.lambdify(self.arguments, flat, modules=module, cse=True)

        def evaluate(*values):
            numbers = compiled(*values)
            width = (len(numbers) - n * n) // n
            rows = [numbers[n * n + i * width : n * n + (i + 1) * width] for i in range(n)]
            return [numbers[i * n : (i + 1) * n] for i in range(n)], rows

        return evaluate

    def accelerations(self, values):
        """
        Accelerations, exact to 40 digits, and their scales: the sum of the magnitudes of the terms that cancel in each. values: time, q, v,
        inputs and parameters.
        """
        with mpmath.workdps(40):
            mass, terms = self.precise(*map(mpmath.mpf, values))
            inverse = mpmath.matrix(mass) ** -1
            exact = inverse * mpmath.matrix([sum(row) for row in terms])
            sizes = [sum(abs(term) for term in row) for row in terms]
            n = len(terms)
            scale = [sum(abs(inverse[i, j]) * sizes[j] for j in range(n)) for i in range(n)]
            return np.array([float(x) for x in exact]), np.array([float(s) for s in scale])

    @property
    def precise(self):
        if not hasattr(self, "_precise"):
            self._precise = self.evaluator("mpmath")
        return self._precise

    def right_side(self, inputs, parameters):
        """Return f(t, x) for SciPy's integrators; inputs is a function of time."""
        evaluate = self.evaluator("numpy")
        n = len(self.q)

        def derivative(t, x):
            mass, terms = evaluate(t, *x, *inputs(t), *parameters)
            right = np.array([sum(row) for row in terms], float)
            return np.concatenate([x[n:], np.linalg.solve(np.array(mass, float), right)])

        return derivative


def velocity(expression, q, v):
    """Time derivative of an expression of q and time."""
    return sp.diff(expression, time) + sum(sp.diff(expression, qi) * vi for qi, vi in zip(q, v))


def kinetic(masses_and_positions, q, v):
    return sum(
        m / 2 * sum(velocity(sp.sympify(x), q, v) ** 2 for x in position) for m, position in masses_and_positions
    )


def rotation(axis, angle):
    """Matrix that maps components along the rotated axes to components along the original axes."""
    turn = {"x": sp.rot_ccw_axis1, "y": sp.rot_ccw_axis2, "z": sp.rot_ccw_axis3}[axis]
    return turn(angle)


def angular_velocity(turn, q, v):
    """Angular velocity along the body axes, from the skew-symmetric matrix R^T dR/dt."""
    cross = turn.T * turn.applyfunc(lambda element: velocity(element, q, v))
    return sp.Matrix([cross[2, 1], cross[0, 2], cross[1, 0]])


def turning(turn, moments, q, v):
    """Kinetic energy of rotation of a body, by its principal moments of inertia."""
    return sum(J / 2 * rate**2 for J, rate in zip(moments, angular_velocity(turn, q, v)))


class Constrained:
    """Equations of a constrained system by SymPy: M a + J^T F = right side, J a + (velocity terms of the second derivatives) = 0."""

    def __init__(self, q, v, T, U, Q, constraints, parameters):
        L = T - U
        momenta = [sp.diff(L, vi) for vi in v]
        mass = sp.Matrix(len(q), len(q), lambda i, j: sp.diff(momenta[i], v[j]))
        right = [Qi + sp.diff(L, qi) - velocity(p, q, v) for Qi, qi, p in zip(Q, q, momenta)]
        rates = [c if c.has(*v) else velocity(c, q, v) for c in constraints]
        jacobian = sp.Matrix(len(constraints), len(q), lambda i, j: sp.diff(rates[i], v[j]))
        rest = [-velocity(rate, q, v) for rate in rates]
        self.arguments = [time, *q, *v, *parameters]
        matrix = sp.Matrix(sp.BlockMatrix([[mass, jacobian.T], [jacobian, sp.zeros(len(rest))]]))
        self.system = sp.lambdify(self.arguments, [matrix, sp.Matrix([*right, *rest])], modules="numpy", cse=True)

    def solve(self, values):
        matrix, right = self.system(*values)
        return np.linalg.solve(np.array(matrix, float), np.array(right, float).ravel())
