"""Times of runs: taken by turns, and compared at the same error."""

import math

import numpy as np

from numerics.plots import front

LONG = 0.5  # seconds, from which on two rounds are enough


def take_turns(runners, quick):
    """Adds the seconds of each round to the samples of what runs."""
    for turn in range(2 if quick else 5):
        for runner, sample in runners:
            if turn < 2 or min(sample.times) < LONG:
                sample.times.append(runner.run())


def time_to(points, level):
    """The time to this error, between points of (seconds, error) by powers; infinite where they never get there."""
    points = [(seconds, max(error, 1e-17)) for seconds, error in points]
    if min((error for _, error in points), default=math.inf) > level:
        return math.inf
    seconds, errors = np.log(front(points))[::-1].T
    return float(np.exp(np.interp(math.log(level), errors, seconds)))


def ratio(numerator, denominator):
    """Not a number where neither method gets there."""
    if math.isinf(denominator):
        return math.nan if math.isinf(numerator) else 0.0
    return numerator / denominator
