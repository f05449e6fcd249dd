"""Basis of the report of mechanisms: references, models for other programs, and its section."""

import importlib.util
import math
from dataclasses import replace

import numpy as np
import pytest

import fmu
from numerics import __main__ as report
from numerics import driver
from numerics.mechanisms import comparison as mechanisms
from numerics.mechanisms.comparison import METHODS, Fmu, Sample, first_run
from numerics.mechanisms.problems import ANGLES, PROBLEMS, squeezer_angles

pytestmark = pytest.mark.release

PENDULUM, FOUR_BARS, SQUEEZER, KNIFE_EDGE = PROBLEMS


@pytest.fixture(autouse=True)
def built(monkeypatch):
    """Use the FMUs as shipped in place of the builds with each solver."""
    monkeypatch.setattr(driver, "folder_of", lambda solver: fmu.BUILD)


def start_of(planar):
    positions = np.concatenate([[*body.centre, 0.0] for body in planar.bodies])
    return positions, np.concatenate([[*body.velocity, body.rate] for body in planar.bodies])


@pytest.mark.parametrize("problem", [PENDULUM, FOUR_BARS], ids=lambda problem: problem.system)
def test_energy_at_the_start(problem, open_fmu):
    """41 pillars rotate about their feet, 40 beams translate; all are upright. The pendulum is at rest at the height of its pivot."""
    expected = 41 * (1 / 6 + 9.81 / 2) + 40 * (1 / 2 + 9.81) if problem is FOUR_BARS else 0.0
    assert problem.model.start_energy() == pytest.approx(expected, rel=1e-14)
    assert open_fmu(problem.system).initialize().get("totalEnergy") == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("problem", [PENDULUM, FOUR_BARS, SQUEEZER], ids=lambda problem: problem.system)
def test_bodies_move_with_their_joints(problem):
    """At the start both sides of each joint have the same velocity."""
    planar = problem.model
    for joint in planar.joints:
        velocities = []
        for number in (joint.body, joint.other):
            body = planar.bodies[number] if number is not None else None
            arm = joint.point - body.centre if body else np.zeros(2)
            velocities.append(np.array(body.velocity) + body.rate * np.array([-arm[1], arm[0]]) if body else np.zeros(2))
        assert velocities[0] == pytest.approx(velocities[1], abs=1e-15)


def test_lengths_of_the_squeezer():
    """Distances between the joints, where the crank alone gives the knee: the start values close all three loops."""
    value = fmu.start_values("AndrewsSqueezer")
    hinge, tip, b, a, _, left, right, knee, *_ = (joint.point for joint in SQUEEZER.model.joints)
    sides = dict(rr=(hinge, tip), d=(tip, knee), ss=(b, knee), e=(left, knee), zf=(right, knee), zt=(a, left), u=(a, right))
    for name, (one, other) in sides.items():
        assert np.linalg.norm(one - other) == pytest.approx(value[name], rel=1e-12)


def test_errors():
    """The reference has the error 0, and a deviation of 1e-6 that error."""
    angles = PENDULUM.expected(PENDULUM.times)
    assert PENDULUM.error(angles) == 0.0
    angles[37, 1] += 1e-6
    assert PENDULUM.error(angles) == pytest.approx(1e-6, rel=1e-6)
    assert math.isnan(FOUR_BARS.error(np.zeros((100, 0))))
    positions, velocities = start_of(FOUR_BARS.model)
    positions[1] += 0.01
    assert FOUR_BARS.model.energy(positions, velocities) - FOUR_BARS.model.start_energy() == pytest.approx(0.0981, rel=1e-9)


def test_angles_of_the_squeezer():
    """Bodies that rotate together keep their relative angles."""
    value = fmu.start_values("AndrewsSqueezer")
    rotated = np.zeros((1, 21))
    rotated[0, 2::3] = [0.1, 0.1, 0.2, 0.3, 0.3, 0.4, 0.5]
    expected = [0.1, 0.0, 0.2, 0.0, 0.3, -0.1, 0.5]
    assert squeezer_angles(rotated)[0] == pytest.approx([value[name] + d for name, d in zip(ANGLES, expected)], abs=1e-15)


@pytest.mark.parametrize("problem, largest", [(PENDULUM, 1e-7), (SQUEEZER, 1e-9), (KNIFE_EDGE, 1e-7)], ids=lambda value: getattr(value, "system", ""))
def test_errors_of_the_fmu(problem, largest):
    runner, sample = first_run(problem, "taylor", 1e-8)
    assert isinstance(runner, Fmu) and runner.run() > 0
    assert sample.error < largest


@pytest.mark.parametrize("peer", METHODS[2:])
@pytest.mark.parametrize("problem, measure", [(PENDULUM, "error"), (FOUR_BARS, "drift"), (SQUEEZER, "error")], ids=["A01", "A02", "A03"])
def test_peers_converge(peer, problem, measure):
    """
    Peers model the same mechanism: their errors decrease with the step, at least with order 1. 10 J are a tenth of the exchanged energy.
    """
    if importlib.util.find_spec(peer.split()[0].lower()) is None:
        pytest.skip(f"{peer} is not installed")
    if problem is FOUR_BARS and "index 2" in peer:
        pytest.skip("it stops where the rods lie flat")
    rough, fine = (first_run(problem, peer, steps)[1].measured(measure) for steps in (500, 2000))
    assert fine < 0.3 * rough and fine < (10 if measure == "drift" else 0.02)


def test_section(monkeypatch, tmp_path):
    """The section of a small run, with or without other programs; times are not judged."""
    monkeypatch.setattr(report, "FOLDER", tmp_path)
    monkeypatch.setattr(mechanisms, "PROBLEMS", [PENDULUM, KNIFE_EDGE])
    monkeypatch.setattr(mechanisms, "settings_of", lambda problem, method, quick: [1e-4, 1e-8] if method in mechanisms.SOLVERS else [100, 200])
    steps = []
    monkeypatch.setattr(report.accelerations, "rows", lambda quick: ([["UR5", "6 axes", 500, math.nan, math.nan]], ["No Pinocchio."]))
    sentences, content, *_ = report.mechanisms_section(True, steps.append)
    assert len(steps) == 3 and len(sentences) == 1 and "a drift of the energy of 5e-05 J" in sentences[0]
    assert content.count("<svg") == 3 and content.count("<table>") == 3 and "knife edge on a slope" in content
    assert "<p>No Pinocchio.</p>" in content and "<td>UR5</td>" in content
    assert all((tmp_path / name).exists() for name in ("mechanisms.csv", "mechanism_ratios.csv", "accelerations.csv"))


def test_a_slow_reference(monkeypatch):
    """The time of the reference does not count as that of the first run, after which finer settings would be skipped."""
    clock = [0.0]

    def slow(times):
        clock[0] += 2 * mechanisms.PATIENCE
        return KNIFE_EDGE.expected(times)

    monkeypatch.setattr(mechanisms.time, "perf_counter", lambda: clock[0])
    runners, _ = mechanisms.runners_of(replace(KNIFE_EDGE, expected=slow), False)
    assert len(runners) == 2 * len(mechanisms.TOLERANCES)


def test_ratios():
    """A method twice as slow at equal errors, one that never reaches the error, one that is not installed."""
    taylor = [Sample(PENDULUM.system, "taylor", 0.0, 10.0**-k, 10.0**-k, [1e-3 * 2**k, 3e-3 * 2**k]) for k in range(10)]
    slower = [Sample(s.system, "radau", 0.0, s.drift, s.error, [2 * t for t in s.times]) for s in taylor]
    rough = [Sample(PENDULUM.system, "MuJoCo RK4", 100, 0.1, 0.1, [1e-3])]
    line = mechanisms.row([*taylor, *slower, *rough], {METHODS[2]}, PENDULUM, "drift", 1e-3, "IFToMM")
    values = dict(zip(mechanisms.HEADER, line))
    assert values["taylor [ms]"] == pytest.approx(8.0) and values["radau / taylor, medians"] == pytest.approx(2.0)
    assert values["MuJoCo RK4 / taylor"] == math.inf and math.isnan(values[f"{METHODS[2]} / taylor"])
    assert values["the FMU reaches"] == 1e-9 and values["times below"] == pytest.approx(1e6)
