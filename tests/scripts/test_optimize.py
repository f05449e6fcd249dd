"""scripts/optimize: minimum-time motions of FMUs, against textbook equations."""

import re

import numpy as np
import pytest
from optimization.__main__ import words
from optimization.closed_loop import CONTROLLERS, TRACK, plant_of, run
from optimization.collocation import least_time, play_back, slopes_of
from optimization.tasks import ARM, CART, DOUBLE_PENDULUM, with_values
from scipy.integrate import solve_ivp

import fmu
from building import ROOT, build_systems
from scripts.library.problem import Problem

pytestmark = pytest.mark.release


def cart(time, state, force):
    M, m, l, g = 1.0, 0.1, 0.5, 9.81
    _, theta, v, omega = state
    sine, cosine, mass = np.sin(theta), np.cos(theta), M + m * np.sin(theta) ** 2
    return [v, omega, (force + m * l * omega**2 * sine - m * g * sine * cosine) / mass,
            ((M + m) * g * sine - force * cosine - m * l * omega**2 * sine * cosine) / (l * mass)]  # fmt: skip


def double_pendulum(time, state, torque):
    """Two uniform rods, by Lagrange's equations with angles from the vertical."""
    m, l, g, b1, b2 = 1.0, 0.5, 9.81, 0.05, 0.02
    first, second, w1, w2 = state
    across = m * l**2 / 2 * np.cos(first - second)
    mass = np.array([[m * l**2 * 4 / 3, across], [across, m * l**2 / 3]])
    turning = m * l**2 / 2 * np.sin(first - second)
    forces = [torque - turning * w2**2 - 1.5 * m * g * l * np.sin(first) - b1 * w1 + b2 * (w2 - w1),
              turning * w1**2 - 0.5 * m * g * l * np.sin(second) - b2 * (w2 - w1)]  # fmt: skip
    return [w1, w2, *np.linalg.solve(mass, forces)]


def check(task, unpacked):
    """Check that the co-simulation FMU reproduces the motion, all bounds are satisfied, and the system is at rest at the end."""
    motion = least_time(unpacked, task)
    assert abs(play_back(unpacked, task, motion) - motion.states).max() < 1e-6
    assert (abs(motion.inputs) <= task.strength * (1 + 1e-7)).all()
    assert all(abs(motion.states[:, row]).max() <= bound + 1e-6 for row, bound in task.state_bounds.items())
    np.testing.assert_allclose(motion.states[[0, -1]], [task.start, task.end], atol=1e-8)
    return motion, abs(motion.inputs) > 0.99 * task.strength


@pytest.mark.parametrize("task, rates", [(CART, cart), (DOUBLE_PENDULUM, double_pendulum)], ids=["cart", "double pendulum"])
def test_it_is_at_rest_at_the_end(task, rates):
    """SciPy's motion ends at rest too. The input is at a bound most of the time, as in any minimum-time solution."""
    if task is DOUBLE_PENDULUM:
        build_systems("optimization", {task.fmu: (ROOT / "scripts" / "optimization" / task.fmu / "system.xml").read_text()})
    motion, at_bound = check(task, fmu.unpacked(task.fmu))
    state = task.start
    for start, end, inputs in zip(motion.times, motion.times[1:], motion.inputs):
        state = solve_ivp(rates, (start, end), state, "DOP853", args=(inputs[0],), rtol=1e-12, atol=1e-12).y[:, -1]
    assert abs(state - task.end).max() < 1e-5
    assert np.count_nonzero(at_bound) > 0.7 * len(motion.inputs)


def test_an_arm():
    """For a robot of six joints, at nearly every time some motor gives its full torque."""
    motion, at_bound = check(ARM, fmu.unpacked("RobotArm"))
    assert motion.times[-1] < 1.0 and np.count_nonzero(at_bound.any(axis=1)) > 0.8 * len(motion.inputs)


def test_values_of_a_task():
    """A shorter pendulum that starts elsewhere, with units: the FMU's slopes and its motion are those of the textbook with these values."""
    unpacked = fmu.unpacked("InvertedPendulumCart")
    task = with_values(CART, {"l": "40cm", "x": "5cm"}, fmu.description("InvertedPendulumCart"))
    assert task.parameters == {"l": 0.4} and list(task.start) == [0.05, np.pi, 0, 0]
    sine, cosine = np.sin(0.3), np.cos(0.3)
    expected = [0, 0, -0.1 * 9.81 * sine * cosine / (1 + 0.1 * sine**2), 1.1 * 9.81 * sine / (0.4 * (1 + 0.1 * sine**2))]
    np.testing.assert_allclose(np.array(slopes_of(unpacked, task)([0, 0.3, 0, 0], 0))[:, 0], expected, rtol=1e-12)
    check(task, unpacked)
    for values, message in (({"F": 1}, "'F' is an input of InvertedPendulumCart, which the optimization finds"), ({"L": 1}, "'L' is not a variable of InvertedPendulumCart; did you mean 'l'?")):
        with pytest.raises(Problem, match=re.escape(message)):
            with_values(CART, values, fmu.description("InvertedPendulumCart"))


@pytest.mark.parametrize("arguments, message", [(["carts"], "there is no task 'carts'"), (["cart", "=3"], "'=3' is not NAME=VALUE")])
def test_wrong_words(arguments, message):
    with pytest.raises(Problem, match=re.escape(message)):
        words(arguments)
    assert words(["cart", "l=40cm"]) == (["cart"], {"l": "40cm"})


def test_controllers():
    """Both controllers balance the cart with noise and delay; the predictive one stays on its track, which the other leaves."""
    unpacked = fmu.unpacked("InvertedPendulumCart")
    plant = plant_of(unpacked)
    # The linearization without force, from M, m, l as in textbooks.
    np.testing.assert_allclose((plant.a[2:4, 1] / 1e-3)[:2], [-0.1 * 9.81, 1.1 * 9.81 / 0.5], rtol=1e-4)
    reached = {}
    for name, controller in CONTROLLERS.items():
        found = run(unpacked, plant, controller(plant), seed=3)
        assert abs(found.states[-1000:, 1]).max() < 5e-3 and abs(found.states[-1000:, 0]).max() < 5e-3
        reached[name] = abs(found.states[:, 0]).max()
    assert reached["LQR"] > TRACK + 0.02 and reached["MPC"] < TRACK + 0.01
