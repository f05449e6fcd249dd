"""scripts/optimize: a swing-up through the FMU, held against the cart's equations as they stand in textbooks."""

import numpy as np
import optimize
import pytest
from scipy.integrate import solve_ivp

import fmu

pytestmark = pytest.mark.release

M, m, l, g = 1.0, 0.1, 0.5, 9.81


def rates(time, state, force):
    _, theta, v, omega = state
    sine, cosine, mass = np.sin(theta), np.cos(theta), M + m * np.sin(theta) ** 2
    return [v, omega, (force + m * l * omega**2 * sine - m * g * sine * cosine) / mass,
            ((M + m) * g * sine - force * cosine - m * l * omega**2 * sine * cosine) / (l * mass)]  # fmt: skip


def test_it_stands_in_the_end():
    """By the FMU that plays the forces back, and by SciPy; nothing leaves its bounds, and the force is at one of them most of the time, as it has to be in the least one."""
    unpacked = fmu.unpacked("InvertedPendulumCart")
    motion = optimize.swing_up(unpacked)
    played = optimize.play_back(unpacked, motion)
    assert abs(played - motion.states).max() < 1e-6
    state = np.array([0, np.pi, 0, 0])
    for start, end, force in zip(motion.times, motion.times[1:], motion.forces):
        state = solve_ivp(rates, (start, end), state, "DOP853", args=(force,), rtol=1e-12, atol=1e-12).y[:, -1]
    assert abs(state).max() < 1e-6
    assert abs(motion.forces).max() <= optimize.FORCE + 1e-6 and abs(motion.states[:, 0]).max() <= optimize.TRACK + 1e-6
    assert np.count_nonzero(abs(motion.forces) > 0.99 * optimize.FORCE) > 0.7 * len(motion.forces)
