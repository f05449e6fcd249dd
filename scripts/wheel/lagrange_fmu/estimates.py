"""
Estimate covariances and confidence intervals of fitted values.

Let r(x) be the residuals in units of the noise, and J = dr/dx at the minimum. To first order the covariance of x is v (J^T J)^-1, where v is
the variance of the residuals. The columns of J are scaled to length 1 first, so that the result does not depend on units (A. van der Sluis:
Condition numbers and equilibration of matrices, 1969). A singular value decomposition of the scaled J finds the null space: right singular
vectors whose singular values are within the error of J. These directions are undetermined; a value with a component in one of them has an
infinite deviation. Robust losses have the covariance of M-estimates (P. Huber: Robust regression, 1973). The cost is one QR factorization of J.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr
from scipy.stats import chi2, norm
from scipy.stats import t as student

from .problem import Problem

PROBABILITY = 0.95  # probability of the confidence intervals
FAR, SIGNIFICANT = 2.0, 1e-3  # a misfit: root mean square above FAR times the stated noise, with a probability below SIGNIFICANT
CORRELATED, ENOUGH = 0.5, 20  # autocorrelation of residuals that is worth a remark; pairs of rows that are enough to estimate it
AT_LIMIT = 1e-2  # distance to a limit, in standard deviations, within which a value is at the limit
NEAR = 1e-6  # additional distance, relative to the limit, which decides if the deviation is infinite
SHARE = 10.0  # components of a null-space vector below this multiple of their error count as 0


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


LOSSES = {"linear": _linear, "soft_l1": _soft_l1, "huber": _huber, "cauchy": _cauchy}  # functions of z = r^2 that return rho, rho', rho''


def loss_of(name):
    """Return the loss function of this name; raise Problem if there is none."""
    if name not in LOSSES:
        raise Problem(f"the loss is '{name}'; expected one of {', '.join(LOSSES)}")
    return LOSSES[name]


@dataclass(frozen=True)
class Estimate:
    """Estimates of n values, all in the same order. Deviations of undetermined values are infinite."""

    values: np.ndarray  # a value close to a limit is set to the limit
    deviations: np.ndarray  # standard deviations
    intervals: np.ndarray  # n x 2, low and high
    correlation: np.ndarray  # n x n
    undetermined: np.ndarray  # k x n, a basis of the directions that do not change residuals; the largest component of each is 1
    at_limit: np.ndarray  # True for a value at a limit
    freedom: int  # number of residuals minus number of determined directions


def _directions(slopes, accuracy):
    """
    Decompose J, the slopes, whose relative error is `accuracy`.

    Return the lengths of its columns, the right singular vectors of the scaled J divided by their singular values, k x n, and a basis of its null
    space, (n - k) x n. Components of the basis below their error are 0.
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
    """Return the slopes without their components in undetermined directions, so that steps of least squares do not move along these."""
    sizes, _, null = _directions(slopes, accuracy)
    return slopes - (slopes / sizes @ np.linalg.pinv(null)) @ null * sizes if len(null) else slopes


def _sparse(null, sizes):
    """Return a sparse basis of the null space, in units of the values, by Gaussian elimination with pivots from a QR factorization."""
    if not len(null):
        return null
    pivots = qr(null, mode="r", pivoting=True)[1][: len(null)]
    basis = np.linalg.solve(null[:, pivots], null)
    basis[abs(basis) < 1e-4] = 0.0  # errors of the elimination, in scaled units
    basis = basis / sizes
    return basis / np.take_along_axis(basis, np.argmax(abs(basis), axis=1)[:, None], axis=1)


def _variance(residuals, freedom, noise_is_known, loss):
    """Return the variance of the residuals: 1 if the noise is known and there is no misfit, Huber's formula for robust losses."""
    if loss is not _linear:
        _, first, second = loss(residuals**2)
        slope = np.mean(first + 2 * second * residuals**2)
        return np.mean((first * residuals) ** 2) / slope**2 * len(residuals) / freedom if freedom and slope > 0 else np.inf
    square = residuals @ residuals
    if noise_is_known and not is_misfit(square, freedom):
        return 1.0
    return square / freedom if freedom else np.inf


def is_misfit(square, freedom):
    """Return True if the sum of squared residuals is far above that of the stated noise."""
    return freedom > 0 and square > FAR**2 * freedom and chi2.sf(square, freedom) < SIGNIFICANT


def estimate(values, limits, slopes, residuals, accuracy, noise_is_known, loss):
    """
    Return the Estimate of n values from N residuals at the minimum.

    `limits` is 2 x n. `slopes`, N x n, and `residuals` are in units of the noise. `accuracy` is the relative error of the slopes.
    """
    sizes, inner, null = _directions(slopes, accuracy)
    freedom = max(0, len(residuals) - len(inner))
    variance = _variance(residuals, freedom, noise_is_known, loss)
    unit = inner.T @ inner  # the covariance at variance 1 of the scaled values
    spread = np.sqrt(np.diag(unit))
    correlation = unit / np.outer(*[np.where(spread > 0, spread, 1.0)] * 2)
    deviations = np.sqrt(variance) * spread / sizes if np.isfinite(variance) else np.full(len(values), np.inf)
    deviations[null.any(axis=0)] = np.inf
    distribution = norm if noise_is_known else student(max(1, freedom))
    reach = AT_LIMIT * np.where(np.isfinite(deviations), deviations, 0.0) + NEAR * np.where(np.isfinite(limits), abs(limits), abs(values))
    is_near = abs(values - limits) <= reach
    step = -unit @ (slopes / sizes).T @ (loss(residuals**2)[1] * residuals) / sizes
    intervals = [_interval(*parts, distribution) for parts in zip(values, step, deviations, limits.T, is_near.T)]
    values = np.where(is_near[0], limits[0], np.where(is_near[1], limits[1], values))
    return Estimate(values, deviations, np.array(intervals), correlation, _sparse(null, sizes), is_near.any(axis=0), freedom)


def _interval(value, step, deviation, limits, is_near, distribution):
    """
    Return the interval (low, high) of probability PROBABILITY within the limits.

    For a value at a limit it is that of `distribution`, truncated at the limit, with its mean at the unconstrained minimum, value + step.
    """
    low, high = limits
    if not np.isfinite(deviation):
        return low, high
    if is_near.any():
        side = 1.0 if is_near[0] else -1.0
        end = low if is_near[0] else high
        cut = side * (end - value - step) / deviation
        beyond = distribution.isf((1 - PROBABILITY) * distribution.sf(cut)) - cut
        far = end + side * deviation * (beyond if np.isfinite(beyond) else 0.0)
        return (end, min(far, high)) if is_near[0] else (max(far, low), end)
    width = distribution.ppf((1 + PROBABILITY) / 2) * deviation
    return max(low, value - width), min(high, value + width)


def correlation_of_rows(parts):
    """Return the autocorrelation of residuals at lag 1; `parts` has an array for each experiment. Return 0 for fewer than ENOUGH pairs."""
    pairs = np.concatenate([np.stack([part[:-1], part[1:]]) for part in parts], axis=1)
    total = sum(part @ part for part in parts)
    return float(np.sum(pairs[0] * pairs[1]) / total) if pairs.shape[1] >= ENOUGH and total > 0 else 0.0
