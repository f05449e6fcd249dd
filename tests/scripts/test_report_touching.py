"""Bodies in contact in the report: closed forms against integration, and the table."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu import lagc
from numerics.touching import comparison
from numerics.touching.comparison import Sample
from numerics.touching.problems import GRAVITY, PROBLEMS, SYSTEMS


def test_cue_ball_by_integration():
    """Newton's and Euler's laws with friction opposite to the slip, regularized where the slip ends."""
    problem = next(p for p in PROBLEMS if p.name == "billiard")
    radius, mu, (wx, wy, _) = problem.body["radius"], problem.friction, problem.spin

    def right(t, state):
        velocity, spin = state[2:4], state[4:]
        slip = velocity + radius * np.array([-spin[1], spin[0]])
        push = -mu * GRAVITY * slip / math.hypot(*slip, 1e-4)
        return [*velocity, *push, 2.5 / radius * push[1], -2.5 / radius * push[0]]

    state = solve_ivp(right, (0, problem.end), [0, 0, *problem.velocity[:2], wx, wy], "LSODA", rtol=1e-10, atol=1e-12).y[:, -1]
    assert problem.place(problem.end)[:2] == pytest.approx(state[:2], abs=1e-5)


def test_bounces():
    """Each bounce keeps the share e^2 of the height; the ball is on the ground at the sum of the times, and highest halfway."""
    problem = next(p for p in PROBLEMS if p.name == "drop")
    fall, e = math.sqrt(2 / GRAVITY), problem.restitution
    for n in range(3):
        hit = fall * (1 + 2 * sum(e**k for k in range(1, n + 1)))
        assert problem.place(hit + 1e-12)[2] == pytest.approx(0, abs=1e-9)
        assert problem.place(hit + fall * e ** (n + 1))[2] == pytest.approx(e ** (2 * n + 2), abs=1e-12)


def test_sliding_and_rolling():
    box, incline = (next(p for p in PROBLEMS if p.name == name) for name in ("box", "incline"))
    assert box.place(box.end)[0] == pytest.approx(2.0**2 / (2 * 0.3 * GRAVITY)) and box.error(box.place(box.end)) == 0
    # Work of the weight: 7/10 m v^2, with v = 2 x/t.
    x = incline.place(2.0)[0]
    assert 0.7 * (2 * x / 2.0) ** 2 == pytest.approx(GRAVITY * x * math.sin(0.3))


def test_the_table():
    samples = [Sample("box", "MuJoCo", 1e-2, 9e-3, [1e-3, 2e-3]), Sample("box", "MuJoCo", 1e-3, 9e-4, [1e-2]), Sample("quadruped", "Drake, discrete", 1e-2, 1e-9, [0.2])]
    rows = {(row[0], row[2]): dict(zip(comparison.METHODS, row[3:])) for row in comparison.rows(samples)}
    box = [rows["box that slides to rest", level]["MuJoCo"] for level in comparison.LEVELS]
    assert box[0] == pytest.approx(1.0) and 1 < box[1] <= 10 and box[2:] == ["never", "never"]
    assert rows["box that slides to rest", 1e-2]["Drake, discrete"] == "" and rows["quadruped that stands for 10 s", 1e-8]["Drake, discrete"] == pytest.approx(200)


@pytest.mark.parametrize("name", sorted(path.name for path in SYSTEMS.iterdir()))
def test_its_systems_are_right(name, tmp_path):
    result = lagc(SYSTEMS / name / "system.xml", "-o", tmp_path)
    assert result.returncode == 0, result.stderr
