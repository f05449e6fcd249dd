"""Measure the times of runs in turns, and compare them at equal error."""

import math

import numpy as np

from numerics.plots import front

LONG = 0.5  # s, from which on two rounds are enough


def take_turns(runners, quick):
    """Run all runners in turns; add the seconds of each round to their samples."""
    for turn in range(2 if quick else 5):
        for runner, sample in runners:
            if turn < 2 or min(sample.times) < LONG:
                sample.times.append(runner.run())


def time_to(points, level):
    """Return the time to an error, by log-log interpolation between points (seconds, error); infinite if no point reaches it."""
    points = [(seconds, max(error, 1e-17)) for seconds, error in points]
    if min((error for _, error in points), default=math.inf) > level:
        return math.inf
    seconds, errors = np.log(front(points))[::-1].T
    return float(np.exp(np.interp(math.log(level), errors, seconds)))


def ratio(numerator, denominator):
    """Return the ratio of times, which may be infinite; NaN if both are."""
    if math.isinf(denominator):
        return math.nan if math.isinf(numerator) else 0.0
    return numerator / denominator
