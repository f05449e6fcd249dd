"""A system to first order at a point, by the directional derivatives of its FMU."""

import warnings
from typing import NamedTuple

import numpy as np

from .model_exchange import opened

STEP = 1e-3  # of differences of fourth order, in which what is cut off and roundings are both about 1e-12


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


def _tangents(point, at):
    """
    The directions in which the states can move, as orthonormal columns. States are projected onto those that fulfil the constraints;
    what that does to first order is a projection onto these directions, whose singular values are 0, or 1 and more.
    """
    columns = []
    for i in range(len(at)):
        step = np.eye(len(at))[i] * STEP * max(1.0, abs(at[i]))
        one, two = (point.held(at + k * step) - point.held(at - k * step) for k in (1, 2))
        columns.append((8 * one - two) / (12 * step[i]))
    left, singular, _ = np.linalg.svd(np.array(columns).T)
    return left[:, : np.count_nonzero(singular > 0.5)]


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
    )
