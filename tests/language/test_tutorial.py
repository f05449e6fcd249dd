"""fmu/TUTORIAL.md: every file builds, every command runs, and every number is that of a closed form and of the FMU."""

import re

import numpy as np
import pytest
from scipy.optimize import fsolve

import examples
import fmu
from closed_forms import pendulum_angle, pendulum_half_period
from examples import settings_of
from fmu import ROOT, build_systems, lagc

TUTORIAL = (ROOT / "fmu" / "TUTORIAL.md").read_text()
SYSTEMS = {re.search(r' name="(\w+)"', text).group(1): text for text in re.findall(r"```xml\n(<system .*?)```", TUTORIAL, re.S)}
STEPS = re.split(r"^## \d\. .*$", TUTORIAL, flags=re.M)  # the first part precedes step 1
G, L = 9.81, 0.5
RATE = np.sqrt(G / L)


@pytest.fixture(scope="module", autouse=True)
def systems():
    build_systems("tutorial", SYSTEMS, files={"ArmAtWindow/Arm.xml": SYSTEMS["Arm"]})


def check_numbers(step, *expected):
    """Check that the bold numbers of a step are these, to the digits shown."""
    examples.check_numbers(STEPS[step], expected)


def moved(open_fmu, step, command=0, until=None):
    """The system of a step started by its command, at a time or at the end of its experiment."""
    name, settings = re.findall(r"lagrange-fmu run (\w+)\.xml *([^`\n]*)", STEPS[step])[command]
    instance = open_fmu(name).initialize(settings_of(settings))
    instance.step(until or float(re.search(r'stopTime="(.*?)"', SYSTEMS[name]).group(1)))
    return instance


def test_commands_name_files_and_variables_of_the_page():
    commands = re.findall(r"lagrange-fmu (?:run|check|build) (\w+)\.xml *([^`\n]*)", TUTORIAL)
    assert len(commands) >= 14
    for name, words in commands:
        variables = {variable.name for variable in fmu.description(name).modelVariables}
        assert set(settings_of(words)) <= variables, name


def test_the_files_give_no_warning(tmp_path):
    for name, text in SYSTEMS.items():
        (tmp_path / f"{name}.xml").write_text(text)
    for name in SYSTEMS:
        result = lagc(f"{name}.xml", "-o", f"{name}.out", cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, ""), name


def test_pendulum(open_fmu):
    periods = [2 * pendulum_half_period(start, RATE) for start in (1, 3)]
    check_numbers(1, periods[0], periods[1])
    assert f"only {2 * np.pi / RATE:.3f} s" in STEPS[1]
    for command, (period, start) in enumerate(zip(periods, (1, 3))):
        assert moved(open_fmu, 1, command, period).get("theta") == pytest.approx(start, abs=1e-6)
        assert moved(open_fmu, 1, command, period / 3).get("theta") == pytest.approx(pendulum_angle(start, RATE, period / 3), abs=1e-6)


def test_parameters_and_output(open_fmu):
    period = 2 * pendulum_half_period(1, np.sqrt(G / 2))
    check_numbers(2, L * (1 - np.cos(1)), period)
    assert moved(open_fmu, 2, 0, 1e-9).get("height") == pytest.approx(L * (1 - np.cos(1)), abs=1e-12)
    assert moved(open_fmu, 2, 1, period).get("theta") == pytest.approx(1, abs=1e-6)


def test_mistake_in_a_unit(tmp_path):
    (tmp_path / "system.xml").write_text(SYSTEMS["NamedPendulum"].replace("m*g*bob.y", "m*bob.y"))
    message = re.search(r"\n    lagrange-fmu: \S+:\d+: (unit mismatch.*)\n", STEPS[2]).group(1)
    assert message in lagc("system.xml", "-o", "out", cwd=tmp_path).stderr


def test_friction_and_motor(open_fmu):
    check_numbers(3, np.arcsin(2 / (G * L)))
    assert f"{G * L:.3f} N.m" in STEPS[3]
    assert moved(open_fmu, 3).get("theta") == pytest.approx(np.arcsin(2 / (G * L)), abs=1e-6)
    assert moved(open_fmu, 3, 1).get("theta") > 8 * np.pi


def test_two_bodies(open_fmu):
    period = 2 * np.pi / np.sqrt((2 - np.sqrt(2)) * RATE**2)
    check_numbers(4, period)
    end = moved(open_fmu, 4, 1, period)
    # Beyond small oscillations the period grows in proportion to the square of the angle.
    assert end.get("theta1", "theta2") == pytest.approx([0.01, 0.01 * np.sqrt(2)], rel=1e-4)
    half = moved(open_fmu, 4, 1, period / 3)
    assert half.get("theta2") == pytest.approx(np.sqrt(2) * half.get("theta1"), rel=1e-3)


def test_stop(open_fmu):
    hit, height = pendulum_half_period(1, RATE) / 2, L * (1 - np.cos(1))
    check_numbers(5, hit, 0.64 * height)
    assert "0.2298 m" in STEPS[5]
    before, after = moved(open_fmu, 5, until=hit - 1e-6), moved(open_fmu, 5, until=hit + 1e-6)
    assert after.get("omega") == pytest.approx(-0.8 * before.get("omega"), rel=1e-8) and after.get("omega") > 0
    top = np.arccos(1 - 0.64 * height / L)
    after.step(pendulum_half_period(top, RATE) / 2 - 1e-6)
    assert after.get("height") == pytest.approx(0.64 * height, abs=1e-7)


def test_closed_loop(open_fmu):
    piston = lambda angle: 0.1 * np.cos(angle) + np.sqrt(0.09 - 0.01 * np.sin(angle) ** 2)
    check_numbers(6, piston(np.pi), piston(0), piston(2), -0.1 * 10 / 0.3)
    assert moved(open_fmu, 6, until=0.2).get("x") == pytest.approx(piston(2), abs=1e-9)
    start = open_fmu("SliderCrank").initialize({})
    assert start.get("omegaRod") == pytest.approx(-10 / 3, rel=1e-9)
    # The motor's power equals the rate of the kinetic energy.
    before, at, behind = (moved(open_fmu, 6, until=time).get("kineticEnergy") for time in (0.2 - 1e-4, 0.2, 0.2 + 1e-4))
    assert at > 0 and moved(open_fmu, 6, until=0.2).get("torque") * 10 == pytest.approx((behind - before) / 2e-4, rel=1e-4)


def weight(q):
    """Torques of gravity at the joints, from the middle of the forearm, and from the upper arm and the elbow."""
    forearm = 1 * G * 0.2 * np.cos(q[0] + q[1])
    return np.array([(2 * 0.25 + 1 * 0.5) * G * np.cos(q[0]) + forearm, forearm])


def tip(q):
    return np.array([0.5 * np.cos(q[0]) + 0.4 * np.cos(q[0] + q[1]), 0.5 * np.sin(q[0]) + 0.4 * np.sin(q[0] + q[1])])


TARGET = np.array([0.9, -0.6])


def test_arm(open_fmu):
    sagged = fsolve(lambda q: 100 * (TARGET - q) - weight(q), TARGET, xtol=1e-13)
    check_numbers(7, sagged[0], TARGET[0], *tip(TARGET))
    assert moved(open_fmu, 7).get("q1", "q2") == pytest.approx(sagged, abs=2e-5)
    assert moved(open_fmu, 7, 1).get("q1", "q2", "reach", "height") == pytest.approx([*TARGET, *tip(TARGET)], abs=2e-5)


def test_arm_at_window(open_fmu):
    """At rest the motors' torques balance the force of the pane, whose moment arms are the heights of the tip over the joints."""

    def unbalanced(unknowns):
        q, force = unknowns[:2], unknowns[2]
        levers = np.array([tip(q)[1], 0.4 * np.sin(q[0] + q[1])])
        return [*(100 * (TARGET - q) + force * levers), tip(q)[0] - 0.65]

    *q, pressure = fsolve(unbalanced, [*TARGET, 0], xtol=1e-13)
    check_numbers(8, tip(q)[1], pressure)
    up, down = moved(open_fmu, 8), moved(open_fmu, 8, 1)
    assert up.get("arm.height", "pressure") == pytest.approx([tip(q)[1], pressure], abs=1e-4)
    assert down.get("arm.height", "pressure") == pytest.approx([-tip(q)[1], pressure], abs=1e-4)
    assert down.get("arm.reach") == pytest.approx(0.65, abs=1e-12)
