"""A system to first order at a point, by the directional derivatives of its FMU."""

import warnings
from typing import NamedTuple

import numpy as np
from fmpy.fmi1 import FMICallException

from .model_exchange import opened
from .problem import Problem

STEP = 1e-3  # of differences of fourth order, in which what is cut off and roundings are both about 1e-12
HALVINGS = 8  # of the step, behind which roundings are 3e-10
UNEVEN = 1e-6  # by which the square of a projection may differ from it


class Linearization(NamedTuple):
    """
    der(x - x0) = A (x - x0) + B (u - u0) + der(x0),  y - y0 = C (x - x0) + D (u - u0), all in SI units: n states, m inputs, p outputs. Where
    there are constraints, the states are as many of the system's as are independent; the others follow.
    """

    A: np.ndarray  # n x n
    B: np.ndarray  # n x m
    C: np.ndarray  # p x n
    D: np.ndarray  # p x m
    states: list[str]
    inputs: list[str]
    outputs: list[str]
    point: dict[str, float]  # x0, as initialization moved it, and u0, by name
    constraints: list[str]  # the contacts that are closed and the frictions that stick at x0, by name: they stay so


def _column(point, at, i, share):
    """What moving the state i by a share of it does to the states that fulfil the constraints, to first order; or None, and why there is no such column."""
    step = np.eye(len(at))[i] * share * max(1.0, abs(at[i]))
    moved, logged = {}, len(point.messages)
    for k in (1, -1, 2, -2):
        try:
            moved[k] = point.held(at, at + k * step)
        except FMICallException as problem:
            return None, "; ".join(point.messages[logged:] or [str(problem)])
        if moved[k] is None:
            return None, "a contact that is closed opens, or a friction that sticks slides"
    return (8 * (moved[1] - moved[-1]) - (moved[2] - moved[-2])) / (12 * step[i]), None


def _projection(point, at, share):
    """What moving each state does, by columns; or None, and why there is no such matrix. Where nothing switches on the way its square is the same."""
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


def _tangents(point, at):
    """
    The directions in which the states can move, as orthonormal columns. States are projected onto those that fulfil the constraints, among
    them closed contacts and sticking frictions; what that does to first order is a projection onto these directions, whose singular values are 0, or 1
    and more. The steps are the largest ones at which what is closed stays closed, and what is open open.
    """
    for halving in range(HALVINGS + 1):
        projection, problem = _projection(point, at, STEP / 2**halving)
        if projection is not None:
            left, singular, _ = np.linalg.svd(projection)
            return left[:, : np.count_nonzero(singular > 0.5)]
    raise Problem(f"{point.name} has no linearization at this point: beside it, {problem}; expected a point whose contacts are clearly open or closed by a force, and whose frictions are within their limits")


def independent(tangents):
    """As many rows as there are columns: the first ones that are far from what those before them span."""
    rows, chosen = tangents.copy(), []
    for _ in range(tangents.shape[1]):
        lengths = np.linalg.norm(rows, axis=1)
        chosen.append(int(np.argmax(lengths >= 0.3 * lengths.max())))
        direction = rows[chosen[-1]] / lengths[chosen[-1]]
        rows -= np.outer(rows @ direction, direction)
    return sorted(chosen)


def linearize(system, at=None, method=None):
    with opened(system, dict(at or {}), method) as point:
        return _linearization(point)


def _linearization(point):
    at = point.start()
    constraints = point.constraining()
    tangents = _tangents(point, at) if len(at) else np.empty((0, 0))
    chosen = independent(tangents)
    basis = tangents @ np.linalg.inv(tangents[chosen])
    point.start(at)
    derivatives = dict(zip(point.derivatives, point.read(point.derivatives)))
    moving = [f"{name} = {value:.6g}" for name, value in derivatives.items() if abs(value) > 1e-6]
    if moving:
        warnings.warn(f"the point is not an equilibrium: {', '.join(moving)}", stacklevel=4)
    rates = [point.derivatives[i] for i in chosen]
    return Linearization(
        point.jacobian(rates, point.states) @ basis,
        point.jacobian(rates, point.inputs),
        point.jacobian(point.outputs, point.states) @ basis,
        point.jacobian(point.outputs, point.inputs),
        [point.states[i] for i in chosen],
        point.inputs,
        point.outputs,
        dict(zip(point.states, at.tolist())) | dict(zip(point.inputs, point.read(point.inputs).tolist())),
        constraints,
    )
