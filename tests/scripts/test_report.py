"""Basis of the report of stiff systems: references, models, inputs and ratios."""

import importlib.util
import math
import shutil
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fmu
from fmu import ROOT
from numerics import driver
from numerics.stiff import comparison as stiff
from numerics.stiff import peers as stiff_peers
from numerics.stiff import problems as stiff_problems
from numerics.stiff.collocation import trajectory
from numerics.stiff.comparison import Sample
from numerics.stiff.problems import DEFINITIONS, PROBLEMS, StiffProblem, damped as damped_pendulum, elastic, right_states
from numerics.work_precision import comparison as work_precision
from numerics.work_precision.compiled import odeint
from numerics.work_precision.scenarios import CLOSED_FORMS, states_of, times_of, values_of
from rope import START, accelerations

pytestmark = pytest.mark.release

SYSTEMS = ROOT / "scripts" / "numerics" / "systems"


@pytest.fixture(scope="module", autouse=True)
def systems():
    fmu.build_systems("stiff-systems", {name: (SYSTEMS / name / "system.xml").read_text() for name in DEFINITIONS})


@pytest.fixture
def built(monkeypatch, tmp_path):
    """Use the FMUs of this test in place of the builds with each solver, without stored references."""
    monkeypatch.setattr(stiff_problems, "REFERENCES", tmp_path)
    monkeypatch.setattr(driver, "folder_of", lambda solver: fmu.BUILD / "stiff-systems")
    monkeypatch.setattr(stiff, "METHODS", ["auto", "radau"])


@mpmath.workdps(40)
def damped(b, k, level, t):
    """x'' = -b x' - k x + level from rest at 1, underdamped or overdamped."""
    root = mpmath.sqrt(mpmath.mpc(b * b / 4 - k))
    one, other = -mpmath.mpf(b) / 2 + root, -mpmath.mpf(b) / 2 - root
    rest = mpmath.mpf(level) / k
    return float(mpmath.re(rest + (1 - rest) * (one * mpmath.exp(other * t) - other * mpmath.exp(one * t)) / (one - other)))


@pytest.mark.parametrize("b, k", [(0.1, 1.0), (1e2, 1e6), (1e7, 1e3), (1e4, 1e8)])
@pytest.mark.parametrize("stages", [8, 12])
def test_collocation(b, k, stages):
    times = 2 * np.arange(1, 5) / 4
    states = trajectory(lambda x, u: np.array([x[1], u - b * x[1] - k * x[0]]), [1, 0], times, 8, lambda step: 2.0, stages)
    assert states[:, 0] == pytest.approx([damped(b, k, 2.0, t) for t in times], abs=1e-12)


@pytest.mark.parametrize("name", DEFINITIONS)
def test_definitions(name, open_fmu):
    """The equations that SymPy derives for the references are those of the FMU."""
    instance, definition, random = open_fmu(name), DEFINITIONS[name](), np.random.default_rng(1)
    values = fmu.start_values(name)
    states, inputs = [s.name for s in [*definition.q, *definition.v]], [s.name for s in definition.inputs]
    for _ in range(5):
        values |= dict(zip(states + inputs, random.uniform(0.3, 1.2, len(states + inputs))))
        instance.reset().initialize(values)
        right_side = definition.right_side(lambda t: [values[u] for u in inputs], [values[p.name] for p in definition.parameters])
        expected = right_side(0.0, np.array([values[s] for s in states]))
        assert [instance.get(f"der({s})") for s in states] == pytest.approx(expected, rel=1e-9)


def test_a_small_problem(built):
    """Every way of communication reaches the reference, including changing inputs."""
    problem = StiffProblem("small", "VanDerPol", 5.0, 100, dict(mu=20.0), ("F", 5.0))
    for way in problem.ways:
        _, _, difference = right_states(problem, way)
        assert difference < 1e-12
        samples = stiff.sample_fmus(problem, way, [1e-6, 1e-9], 2)
        assert [(s.method, s.tolerance) for s in samples] == [("auto", 1e-6), ("radau", 1e-6), ("auto", 1e-9), ("radau", 1e-9)]
        assert all(s.error < 100 * s.tolerance and s.seconds > 0 for s in samples)
    changed, constant = (right_states(problem, way)[0][-1] for way in (problem.ways[-1], problem.ways[0]))
    assert np.max(np.abs(changed - constant)) > 1e-4


def samples_of(method, factor):
    """Samples with errors of 1e-2, 1e-4, ..., and times that are powers of the errors."""
    return [Sample("P", "one step", method, 0.0, factor * error**-0.25, error) for error in (1e-2, 1e-4, 1e-6, 1e-8)]


def test_times_are_interpolated():
    """Time is a power of the error. A run that misses the error by little does not make the next tolerance count in whole."""
    samples = [work_precision.Sample("P", method, 0.0, 0.0, error**-0.25, error, error) for method in ("a", "b") for error in (1e-2, 1.2e-10, 1e-14)]
    assert work_precision.best_seconds(samples, "P", ["a", "b"], 1e-10) == pytest.approx(1e-10**-0.25)
    assert work_precision.best_seconds(samples, "P", ["a"], 1e-15) == math.inf


def test_ratios():
    samples = [*samples_of("auto", 1.2), *samples_of("taylor", 8.0), *samples_of("radau", 1.0)]
    samples += [s for s in samples_of("bdf", 3.0) if s.error > 1e-5]
    assert stiff.seconds_to(samples, "P", "one step", "auto", 1e-5) == pytest.approx(1.2 * 1e-5**-0.25)
    assert stiff.seconds_to(samples, "P", "one step", "auto", 1.0) == pytest.approx(1.2 * 1e-2**-0.25)
    assert stiff.ratios(samples, "P", "one step", 1e-3) == pytest.approx((1.2, 3.0))
    assert stiff.ratios(samples, "P", "one step", 1e-7) == pytest.approx((1.2, math.inf))
    assert all(math.isnan(value) for value in stiff.ratios(samples, "P", "one step", 1e-9))


def test_summary():
    rows = [["A", "one step", 1.0, 1.1, 4.0, 1.2, 5.0, 20.0, math.nan], ["B", "many steps", 1.0, 1.5, 3.0, 1.25, math.inf, 30.0, math.nan],
            ["C", "one step", 1.0, *[math.nan] * 6]]  # fmt: skip
    sentences = stiff.summary(rows)
    assert "1 of 2 cases; at worst 1.50 times (B, many steps)" in sentences[0] and "3.00 to 4.00 times" in sentences[1]
    assert "on 2 of 2 problems, in 20.00 to 30.00 times the time of auto" in sentences[2]
    assert "2 of 2 cases; at worst 1.25 times (B, many steps)" in sentences[3] and "5.00 to infinitely many times" in sentences[4]
    assert len(sentences) == 5  # none of exudyn, which was not run


def test_the_rope(monkeypatch, tmp_path):
    """The rope's reference by two methods, here for a short time, against forces written by hand."""
    monkeypatch.setattr(stiff_problems, "REFERENCES", tmp_path)
    monkeypatch.setattr(driver, "folder_of", lambda solver: fmu.BUILD)
    monkeypatch.setattr(stiff, "METHODS", ["auto"])
    (rope,) = (replace(problem, end=0.004) for problem in PROBLEMS if problem.name == "Rope")
    samples = stiff.sample_fmus(rope, "one step", [1e-6, 1e-12], 1)
    assert [s.tolerance for s in samples] == [1e-6] and samples[0].error < 1e-7

    def derivative(time, state):
        places, velocities = state.reshape(2, -1, 2)
        return np.stack([velocities, accelerations(START, places, velocities)]).ravel()

    places = [[rope.all_values[f"{letter}[{i}]"] for letter in "xy"] for i in range(1, 201)]
    start = np.stack([np.array(places), np.zeros((200, 2))]).ravel()
    by_hand = solve_ivp(derivative, (0, rope.end), start, method="DOP853", rtol=1e-9, atol=1e-9).y[:, -1].reshape(2, 200, 2)
    names = [f"{letter}[{i}]" for letter in ("x", "vx", "y", "vy") for i in range(1, 201)]
    expected = dict(zip(names, np.concatenate([by_hand[0, :, 0], by_hand[1, :, 0], by_hand[0, :, 1], by_hand[1, :, 1]])))
    states, text, difference = right_states(rope, "one step")
    assert "radau" in text and "bdf" in text and difference < 1e-7
    assert states[-1] == pytest.approx([expected[name] for name in rope.states], abs=1e-7)


@pytest.mark.parametrize("peer", [name for name in stiff_peers.PEERS if name.startswith("exudyn")])
@pytest.mark.parametrize("problem", [elastic(1e4, 0.1), damped_pendulum(1e2)], ids=lambda problem: problem.system)
def test_exudyn(peer, problem, monkeypatch, tmp_path):
    """Exudyn models the same system: its methods of order 2 converge to the reference."""
    if importlib.util.find_spec("exudyn") is None:
        pytest.skip("exudyn is not installed")
    monkeypatch.setattr(stiff_problems, "REFERENCES", tmp_path)
    monkeypatch.setattr(driver, "folder_of", lambda solver: fmu.BUILD)
    problem = replace(problem, end=1.0)
    exact = right_states(problem, "one step")[0][-1]
    rough, fine = (np.max(np.abs(stiff_peers.PEERS[peer][0](problem, steps)[1] - exact)) for steps in (1000, 4000))
    assert fine < 0.15 * rough and fine < 1e-3


def test_polar_coordinates():
    """Polar coordinates of a point at length 2 and angle 0.3, with radial velocity 0.5 and angular velocity -0.7."""
    out, across = np.array([np.sin(0.3), -np.cos(0.3), 0.0]), np.array([np.cos(0.3), np.sin(0.3), 0.0])
    state = stiff_peers.polar(2 * out, 0.5 * out - 1.4 * across)
    assert state == pytest.approx({"r": 2.0, "theta": 0.3, "vr": 0.5, "omega": -0.7})


@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no C++ compiler")
@pytest.mark.parametrize("name", ["SimplePendulum", "ParticleSpherical"])
def test_boost_odeint(name):
    """The compiled Runge-Kutta method reaches the closed form at the end."""
    columns, exact = CLOSED_FORMS[name][1](name, values_of(name), times_of(name)[-1:])
    _, [state] = odeint(name, 1e-12)
    order = states_of(name)
    assert [state[order.index(column)] for column in columns] == pytest.approx(list(exact[0]), abs=1e-9)
