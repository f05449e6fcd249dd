"""
How well data determine values. Residuals r(x) in units of the noise have the slopes J = dr/dx at the least squares; to first order the covariance of x is
v (J^T J)^-1, where v is the variance of what remains. Columns of J are scaled to length 1 first, so that units decide nothing (A. van der Sluis: Condition
numbers and equilibration of matrices, 1969). A direction whose singular value is not above the error of J is undetermined: whatever has a share in it has no
finite deviation. Robust losses have the covariance of M-estimates (P. Huber: Robust regression, 1973).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr
from scipy.stats import chi2, norm
from scipy.stats import t as student

from .problem import Problem

PROBABILITY = 0.95
FAR, SIGNIFICANT = 2.0, 1e-3  # times the stated noise; and the probability of as much by chance
CORRELATED, ENOUGH = 0.5, 20  # from row to row; of so many rows
AT_LIMIT = 1e-2  # of the deviation, within which a value is at its limit
NEAR = 1e-6  # relative, likewise for values without a finite deviation
SHARE = 10.0  # errors of an undetermined direction, below which a share is none


def _linear(z):
    return np.stack([z, np.ones_like(z), np.zeros_like(z)])


def _soft_l1(z):
    root = np.sqrt(1 + z)
    return np.stack([2 * root - 2, 1 / root, -0.5 / root**3])


def _huber(z):
    root = np.sqrt(np.maximum(z, 1.0))
    return np.where(z <= 1, _linear(z), np.stack([2 * root - 1, 1 / root, -0.5 / root**3]))


def _cauchy(z):
    return np.stack([np.log1p(z), 1 / (1 + z), -1 / (1 + z) ** 2])


LOSSES = {"linear": _linear, "soft_l1": _soft_l1, "huber": _huber, "cauchy": _cauchy}  # rho, rho', rho'' of squares of residuals


def loss_of(name):
    if name not in LOSSES:
        raise Problem(f"the loss is '{name}'; expected one of {', '.join(LOSSES)}")
    return LOSSES[name]


@dataclass(frozen=True)
class Estimate:
    """In the order of the values; infinite where the data determine nothing."""

    values: np.ndarray  # at its limit where they are close
    deviations: np.ndarray
    intervals: np.ndarray  # n x 2
    correlation: np.ndarray
    undetermined: np.ndarray  # k x n, directions along which residuals stay; their largest component is 1
    at_limit: np.ndarray  # True where a value is at its limit
    freedom: int


def _directions(slopes, accuracy):
    """
    Lengths of the columns of J; of J with columns of length 1 the inverse singular values times right singular vectors, k x n, and the null space, (n - k) x n,
    in which components below its error are 0.
    """
    sizes = np.linalg.norm(slopes, axis=0)
    sizes[sizes == 0] = 1.0
    triangle = np.linalg.qr(slopes / sizes, mode="r")
    _, found, directions = np.linalg.svd(triangle)
    singular = np.zeros(len(directions))
    singular[: len(found)] = found
    is_determined = singular > accuracy * max(1.0, singular[0])
    least = singular[is_determined].min(initial=1.0)
    null = directions[~is_determined]
    null = np.where(np.linalg.norm(null, axis=0) > min(0.1, SHARE * accuracy / least), null, 0.0)
    return sizes, directions[is_determined] / singular[is_determined, None], null


def without_undetermined(slopes, accuracy):
    """The slopes, of which steps of least squares leave undetermined directions as they are."""
    sizes, _, null = _directions(slopes, accuracy)
    return slopes - (slopes / sizes @ np.linalg.pinv(null)) @ null * sizes if len(null) else slopes


def _sparse(null, sizes):
    """A basis of these directions, in units of the values, each with as few values as Gaussian elimination leaves."""
    if not len(null):
        return null
    pivots = qr(null, mode="r", pivoting=True)[1][: len(null)]
    basis = np.linalg.solve(null[:, pivots], null)
    basis[abs(basis) < 1e-4] = 0.0  # rounding of the elimination, in units of equal effect
    basis = basis / sizes
    return basis / np.take_along_axis(basis, np.argmax(abs(basis), axis=1)[:, None], axis=1)


def _variance(residuals, freedom, noise_is_known, loss):
    """Of the residuals that remain; of stated noise 1, unless they are far above it."""
    if loss is not _linear:
        _, first, second = loss(residuals**2)
        slope = np.mean(first + 2 * second * residuals**2)
        return np.mean((first * residuals) ** 2) / slope**2 * len(residuals) / freedom if freedom and slope > 0 else np.inf
    square = residuals @ residuals
    if noise_is_known and not is_misfit(square, freedom):
        return 1.0
    return square / freedom if freedom else np.inf


def is_misfit(square, freedom):
    """True if residuals, whose squares have this sum, are far above the stated noise."""
    return freedom > 0 and square > FAR**2 * freedom and chi2.sf(square, freedom) < SIGNIFICANT


def estimate(values, limits, slopes, residuals, accuracy, noise_is_known, loss):
    """limits: 2 x n; slopes, N x n, and residuals are in units of the noise; accuracy: relative, of the slopes."""
    sizes, inner, null = _directions(slopes, accuracy)
    freedom = max(0, len(residuals) - len(inner))
    variance = _variance(residuals, freedom, noise_is_known, loss)
    unit = inner.T @ inner  # the covariance at variance 1 of the scaled values
    spread = np.sqrt(np.diag(unit))
    correlation = unit / np.outer(*[np.where(spread > 0, spread, 1.0)] * 2)
    deviations = np.sqrt(variance) * spread / sizes if np.isfinite(variance) else np.full(len(values), np.inf)
    deviations[null.any(axis=0)] = np.inf
    law = norm if noise_is_known else student(max(1, freedom))
    reach = AT_LIMIT * np.where(np.isfinite(deviations), deviations, 0.0) + NEAR * np.where(np.isfinite(limits), abs(limits), abs(values))
    is_near = abs(values - limits) <= reach
    step = -unit @ (slopes / sizes).T @ (loss(residuals**2)[1] * residuals) / sizes
    intervals = [_interval(*parts, law) for parts in zip(values, step, deviations, limits.T, is_near.T)]
    values = np.where(is_near[0], limits[0], np.where(is_near[1], limits[1], values))
    return Estimate(values, deviations, np.array(intervals), correlation, _sparse(null, sizes), is_near.any(axis=0), freedom)


def _interval(value, step, deviation, limits, is_near, law):
    """Of 95 %, within the limits; of a value at one of these, of the normal law that the limit cuts, whose mean is where the value would go to."""
    low, high = limits
    if not np.isfinite(deviation):
        return low, high
    if is_near.any():
        side = 1.0 if is_near[0] else -1.0
        end = low if is_near[0] else high
        cut = side * (end - value - step) / deviation
        beyond = law.isf((1 - PROBABILITY) * law.sf(cut)) - cut
        far = end + side * deviation * (beyond if np.isfinite(beyond) else 0.0)
        return (end, min(far, high)) if is_near[0] else (max(far, low), end)
    width = law.ppf((1 + PROBABILITY) / 2) * deviation
    return max(low, value - width), min(high, value + width)


def correlation_of_rows(parts):
    """Of residuals, an array of each experiment, with those of the row before; 0 of few."""
    pairs = np.concatenate([np.stack([part[:-1], part[1:]]) for part in parts], axis=1)
    total = sum(part @ part for part in parts)
    return float(np.sum(pairs[0] * pairs[1]) / total) if pairs.shape[1] >= ENOUGH and total > 0 else 0.0
