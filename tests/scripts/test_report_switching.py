"""Basis of the report of switching: closed forms, phases for other programs, and its section."""

import importlib.util
import math
import re

import numpy as np
import pytest

from numerics import __main__ as report
from numerics.switching import comparison as switching
from numerics.switching.comparison import Sample, first_run
from numerics.switching.peers import METHODS
from numerics.switching.problems import BALL, BLOCK, CRADLE, GROWING, LOSSLESS_PENDULUM, PENDULUM, PROBLEMS, RESTING_BALL, quarter

pytestmark = pytest.mark.release

INSTALLED = {"SciPy": "scipy", "heyoka": "heyoka", "MuJoCo": "mujoco"}


def name_of(value):
    return getattr(value, "name", value)


def positions(problem, *times):
    return [float(x) for x in np.ravel(problem.positions(problem.all_values, times))]


def test_bounces():
    """At impacts the height is 0; each flight is e^2 times as high; the ball rests after sqrt(2 h/g) (1 + e)/(1 - e)."""
    fall = math.sqrt(2 / 9.81)
    assert positions(BALL, fall, 2 * fall, 3 * fall, 20 * fall) == pytest.approx([0, 1, 0, 1], abs=1e-13)
    first, second = fall * (1 + 0.8), fall * (1 + 2 * 0.8 + 0.64)
    assert positions(RESTING_BALL, fall, first, second, 8.99 * fall, 9.01 * fall) == pytest.approx([0, 0.64, 0.64**2, 0, 0], abs=1e-4)
    assert positions(RESTING_BALL, 9.01 * fall) == [0.0]


def test_swings_to_the_stop():
    """Each swing ends at the stop; an impact reduces the height at the turning points."""
    first = float(quarter(PENDULUM.all_values, math.sin(0.5)))
    height = lambda angle: 1 - math.cos(angle)
    kept = 0.81 * (height(1.0) - height(0.2)) + height(0.2)
    second = float(quarter(PENDULUM.all_values, math.sqrt(kept / 2)))
    at_stop, rotated, again = positions(PENDULUM, first, first + second, first + 2 * second)
    assert (at_stop, again) == pytest.approx((-0.2, -0.2), abs=1e-12)
    assert height(rotated) == pytest.approx(kept, rel=1e-12)


def test_slips():
    """The block slips when the spring's force equals the stiction; afterwards the motion is periodic."""
    sticking = 10 - 0.5 * (1 - math.sqrt(0.96)) / 0.1 + math.asin(0.2)
    period = math.pi + 2 * math.atan(0.2) + 10
    assert positions(BLOCK, 0.1, sticking, sticking + 3 * period) == pytest.approx([0.5 * (1 - math.cos(0.1)), 1.0, 1.0], rel=1e-12)
    assert positions(BLOCK, sticking + math.pi + 2 * math.atan(0.2)) == pytest.approx([0.0], abs=1e-12)


def test_cradle():
    half = (float(CRADLE.end_of(CRADLE.all_values, 2)) - float(CRADLE.end_of(CRADLE.all_values, 1))) / 2
    assert positions(CRADLE, 2 * half) == pytest.approx([0, 0, 0, 0, 0.5], abs=1e-12)
    assert positions(CRADLE, 4 * half) == pytest.approx([-0.5, 0, 0, 0, 0], abs=1e-12)


@pytest.mark.parametrize("problem", [*PROBLEMS, LOSSLESS_PENDULUM], ids=name_of)
def test_fmu(problem):
    """The error is small in 100 communication steps and in one."""
    for method in ("FMU", "FMU, one step"):
        runner, sample = first_run(problem, method, 1e-10, 10.0)
        assert runner.run() > 0 and sample.error < 1e-9 and sample.events > 5


@pytest.mark.parametrize("problem", GROWING, ids=name_of)
def test_events(problem):
    """There are as many events as requested; those of the cradle come in groups."""
    _, sample = first_run(problem.with_events(10), "FMU", 1e-10, 10.0)
    assert 10 <= sample.events <= 11


@pytest.mark.parametrize("method", ["CVODE in C (model exchange)", "FMPy CVode (model exchange)"])
@pytest.mark.parametrize("problem", PROBLEMS, ids=name_of)
def test_importers(problem, method):
    """Model exchange has the same events, up to the error of BDF."""
    _, sample = first_run(problem, method, 1e-10, 10.0)
    assert sample.error < 1e-5


@pytest.mark.parametrize("method", [m for m, (program, _) in METHODS.items() if program in ("SciPy", "heyoka")])
@pytest.mark.parametrize("problem", PROBLEMS[:4], ids=name_of)
def test_phases(problem, method):
    """Other programs' events on phases written for them."""
    if importlib.util.find_spec(INSTALLED[METHODS[method][0]]) is None:
        pytest.skip(f"{method} is not installed")
    _, sample = first_run(problem, method, 1e-10, 20.0)
    assert sample.error < 1e-8


@pytest.mark.parametrize("problem", [BALL, RESTING_BALL, PENDULUM], ids=name_of)
def test_soft_contacts(problem):
    """Peers with soft contacts model the same systems: with shorter steps, which allow stiffer contacts, errors decrease."""
    if importlib.util.find_spec("mujoco") is None:
        pytest.skip("MuJoCo is not installed")
    rough, fine = (first_run(problem, "MuJoCo implicitfast", steps, 20.0)[1].error for steps in (3000, 300000))
    assert fine < 0.3 * rough


def test_section(monkeypatch, tmp_path):
    """The section of a small run, with or without other programs; times are not judged."""
    monkeypatch.setattr(report, "FOLDER", tmp_path)
    monkeypatch.setattr(switching, "PROBLEMS", [BLOCK])
    monkeypatch.setattr(switching, "GROWING", [BALL])
    monkeypatch.setattr(switching, "COUNTS", [2, 4])
    monkeypatch.setattr(switching, "TOLERANCES", [1e-8])
    monkeypatch.setattr(switching, "TOLERANCE", 1e-10)
    steps = []
    sentences, content, wrong, _ = report.switching_section(True, steps.append)
    assert len(steps) == 2 and len(sentences) == 2 and wrong == 0
    assert content.count("<svg") == 3 and content.count("<table>") == 2 and "block that sticks and slips on a belt" in content
    assert all((tmp_path / name).exists() for name in ("switching.csv", "switching_events.csv", "switching_ratios.csv"))


def test_failing_problems(monkeypatch, tmp_path):
    """A failing problem gives a sentence, and the others continue; a program that is not installed is named."""
    def absent(problem, setting, patience):
        raise ImportError

    def fail(problem):
        raise ArithmeticError("it has no motion")

    monkeypatch.setattr(report, "FOLDER", tmp_path)
    monkeypatch.setattr(switching, "PROBLEMS", [BLOCK, BALL])
    monkeypatch.setattr(switching, "GROWING", [])
    monkeypatch.setattr(switching, "TOLERANCES", [1e-8])
    monkeypatch.setitem(METHODS, "SciPy DOP853 with events", ("SciPy", absent))
    methods_of = switching.methods_of
    monkeypatch.setattr(switching, "methods_of", lambda problem: fail(problem) if problem is BLOCK else methods_of(problem))
    content = report.switching_section(True, lambda what: None).content
    assert "Left out, block that sticks and slips on a belt: it has no motion." in content
    missing = re.search("Not installed here: (.*?)\\.</p>", content)[1].split(", ")
    assert "SciPy DOP853 with events" in missing and "ball that bounces without loss" in content


def test_ratios():
    """A method twice as slow at equal errors, one that never reaches the error, one that is not installed."""
    settings = range(2, 12)
    ours = [Sample(BALL.name, "FMU", 10.0, 0.0, 10.0**-k, 0, [1e-3 * 2**k, 3e-3 * 2**k]) for k in settings]
    slower = [Sample(s.problem, "SciPy DOP853 with events", 10.0, 0.0, s.error, 0, [2 * t for t in s.times]) for s in ours]
    soft = [Sample(BALL.name, "MuJoCo RK4", 10.0, 1000, 0.1, 0, [1e-3])]
    line = dict(zip(switching.HEADER, switching.row([*ours, *slower, *soft], {"heyoka with events"}, BALL, 1e-6)))
    assert line["FMU [µs]"] == pytest.approx(64e3) and line["SciPy DOP853 with events / FMU"] == pytest.approx(2.0)
    assert line["MuJoCo RK4 / FMU"] == math.inf and math.isnan(line["heyoka with events / FMU"])
