"""
Linearize a system at a point, by the directional derivatives of its FMU.

With constraints the states x lie on a manifold. Initialization and event mode project states onto it. The derivative P of this projection at a point
of the manifold is itself a projection (P^2 = P) onto the tangent space. Finite differences of fourth order give P, a singular value decomposition its
range T, orthonormal columns. The first rows that are far from dependent choose independent states, x_i = T_i z, and then A = (df/dx)_i T T_i^-1. The
cost is four projections for each state.
"""

import warnings
from typing import NamedTuple

import numpy as np
from fmpy.fmi1 import FMICallException

from . import responses
from .calls import checked
from .model_exchange import opened
from .problem import Problem

STEP = 1e-3  # relative step of the differences: errors of truncation and rounding are both about 1e-12
HALVINGS = 8  # largest number of halvings of the step; rounding errors are then 3e-10
COORDINATE, OTHER = 0.02, 0.3  # length of a row relative to the longest one, above which a state is independent: coordinates are preferred
UNEVEN = 1e-6  # relative difference of P^2 and P above which a mode has switched


def values_as_text(values):
    """Return "name = value" for each of these; rounding errors of 0 are 0."""
    return [f"{name} = {value if abs(value) > 1e-15 else 0:.9g}" for name, value in values.items()]


class Linearization(NamedTuple):
    """
    A linearized system: der(x - x0) = A (x - x0) + B (u - u0) + der(x0),  y - y0 = C (x - x0) + D (u - u0), in SI units.

    It has n states, m inputs and p outputs. In a system with constraints the states are a set of independent states.

    Examples
    --------
    >>> A, B, C, D = lagrange_fmu.linearize("cart.xml")[:4]
    >>> lagrange_fmu.linearize("cart.xml").bode("theta").plot()
    """

    A: np.ndarray  # n x n
    B: np.ndarray  # n x m
    C: np.ndarray  # p x n
    D: np.ndarray  # p x m
    states: list[str]  # names, in the order of x
    inputs: list[str]  # names, in the order of u
    outputs: list[str]  # names, in the order of y
    point: dict[str, float]  # x0, after projection onto the constraints, and u0, by name
    constraints: list[str]  # names of the contacts that are closed and the friction that sticks at x0, which count as constraints

    def poles(self):
        """Return the eigenvalues of A in 1/s, those of the least absolute value first."""
        return responses.poles(self)

    @checked
    def bode(self, of=None, by=None, frequencies=None):
        """
        Return the frequency response of the outputs `of` to the inputs `by`, by default of all to all.

        It has `frequency` in rad/s, by default around the poles, complex `values`, `magnitude`, `phase` in degrees, and plot(). bode["theta", "F"] is
        the response of one output to one input. Jupyter shows the plot.
        """
        return responses.bode(self, of, by, frequencies)

    @checked
    def step(self, of=None, by=None, times=None):
        """
        Return the response of the outputs `of` to a unit step of each input `by`, as changes from the operating point. By default all outputs and
        inputs are taken.

        It has `time` in s, by default until the slowest poles have decayed, `values`, and plot(); step["theta", "F"] is the response of one output to
        one input. Jupyter shows the plot.
        """
        return responses.step(self, of, by, times)


class SwitchesEverywhere(Problem):
    """Raised at a point next to which modes switch in every direction, so that it has no linearization."""


def _column(point, at, i, share):
    """Return the column i of the projection's derivative, by steps of `share` times the state, and None; or None and the reason of failure."""
    step = np.eye(len(at))[i] * share * max(1.0, abs(at[i]))
    moved, logged = {}, len(point.messages)
    for k in (1, -1, 2, -2):
        try:
            moved[k] = point.projected(at, at + k * step)
        except FMICallException as problem:
            return None, "; ".join(point.messages[logged:] or [str(problem)])
        if moved[k] is None:
            return None, "a contact that is closed opens, or a friction that sticks slides"
    return (8 * (moved[1] - moved[-1]) - (moved[2] - moved[-2])) / (12 * step[i]), None


def _projection(point, at, share):
    """
    Return the derivative P of the projection onto the constraints and None; or None and the reason of failure.

    P^2 differs from P if a mode switches between the points of the differences.
    """
    columns = []
    for i in range(len(at)):
        column, problem = _column(point, at, i, share)
        if column is None:
            return None, f"where '{point.states[i]}' moves by {share:.1g}, {problem}"
        columns.append(column)
    projection = np.array(columns).T
    if point.indicator_count and not np.allclose(projection @ projection, projection, rtol=0.0, atol=UNEVEN * np.abs(projection).max()):
        return None, "something switches, such as a contact that touches without force"
    return projection, None


def _is_free(point, at):
    """Return True if initialization leaves a random state near `at` unchanged, so that there are no constraints."""
    nearby = at + STEP / 2**HALVINGS * np.maximum(1.0, np.abs(at)) * np.random.default_rng(len(at)).uniform(0.5, 1.0, len(at))
    try:
        return bool((point.start(nearby) == nearby).all())
    except FMICallException:
        point.messages.clear()
        return False


def tangents(point, at):
    """
    Return an orthonormal basis of the tangent space of the constraints, among them closed contacts and sticking friction, as columns.

    The singular values of a projection are 0, or 1 and more. The step is the largest of STEP / 2^k at which no mode switches. Raise Problem if
    there is none.
    """
    if not point.indicator_count and _is_free(point, at):
        return np.eye(len(at))
    for halving in range(HALVINGS + 1):
        projection, problem = _projection(point, at, STEP / 2**halving)
        if projection is not None:
            left, singular, _ = np.linalg.svd(projection)
            return left[:, : np.count_nonzero(singular > 0.5)]
    raise SwitchesEverywhere(f"{point.name} has no linearization at this point: near it, {problem}; expected a point whose contacts are clearly open or closed by a force, and whose frictions are within their limits")


def independent(directions, shares):
    """
    Return the indices of as many independent rows as there are columns. They are the first whose distance from the span of those before exceeds
    `shares` of the largest one.
    """
    rows, chosen = directions.copy(), []
    for _ in range(directions.shape[1]):
        lengths = np.linalg.norm(rows, axis=1)
        chosen.append(int(np.argmax(lengths >= shares * lengths.max())))
        direction = rows[chosen[-1]] / lengths[chosen[-1]]
        rows -= np.outer(rows @ direction, direction)
    return sorted(chosen)


def linearize(system, at=None, method=None):
    """See lagrange_fmu.linearize; `method` is a solver in place of the system's own."""
    with opened(system, dict(at or {}), method) as point:
        found = linearization_at(point)
        rates = dict(zip(point.derivatives, point.read(point.derivatives)))
        moving = [f"{name} = {value:.6g}" for name, value in rates.items() if abs(value) > 1e-6]
        if moving:
            warnings.warn(f"the operating point is not an equilibrium: {', '.join(moving)}; expected one, such as 'equilibrium' finds", stacklevel=4)
        return found


def linearization_at(point):
    """Return the Linearization at the start of the point, which is then there."""
    at = point.start()
    constraints = point.constraining()
    directions = tangents(point, at) if len(at) else np.empty((0, 0))
    point.start(at)
    slopes = point.jacobian(point.derivatives, point.states)
    is_coordinate = (np.count_nonzero(slopes, axis=1) == 1) & (slopes.max(axis=1, initial=0.0) == 1)  # der(x) = v
    chosen = independent(directions, np.where(is_coordinate, COORDINATE, OTHER))
    basis = directions @ np.linalg.inv(directions[chosen])
    return Linearization(
        slopes[chosen] @ basis,
        point.jacobian([point.derivatives[i] for i in chosen], point.inputs),
        point.jacobian(point.outputs, point.states) @ basis,
        point.jacobian(point.outputs, point.inputs),
        [point.states[i] for i in chosen],
        point.inputs,
        point.outputs,
        dict(zip(point.states, at.tolist())) | dict(zip(point.inputs, point.read(point.inputs).tolist())),
        constraints,
    )
