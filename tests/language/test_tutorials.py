"""fmu/tutorials: every file builds, and every number is that of a closed form, or of an independent simulation."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_are

import fmu
from closed_forms import pendulum_half_period
from examples import check_numbers, examples_of, settings_of
from fmu import ROOT, build_systems
from motions import lagrange_fmu  # noqa: F401

PAGES = {path.stem: path.read_text() for path in sorted((ROOT / "fmu" / "tutorials").glob("*.md"))}
EXAMPLES = {name: text for page in PAGES.values() for name, text in examples_of(page).items()}
CRANE, BROWSER = PAGES["crane-for-simulink"], PAGES["pendulum-in-the-browser"]
G = 9.81
RATE = np.sqrt(G / 0.5)
M, m, L, C = 2.0, 1.0, 1.0, 0.5  # of the crane


@pytest.fixture(scope="module", autouse=True)
def examples():
    build_systems("tutorials", EXAMPLES)


def crane(t, state, force):
    """Lagrange's equations of the crane, worked out by hand."""
    _, v, theta, omega = state
    matrix = [[M + m, m * L * np.cos(theta)], [m * L * np.cos(theta), m * L**2]]
    acceleration, turning = np.linalg.solve(matrix, [force - C * v + m * L * omega**2 * np.sin(theta), -m * G * L * np.sin(theta)])
    return [v, acceleration, omega, turning]


def loop(step, delay=0):
    """States of the crane at the samples of the controller, which acts by the state `delay` samples before."""
    states = [np.zeros(4)]
    for k in range(round(10 / step)):
        force = np.dot([10, 8, -9, 0], [2, 0, 0, 0] - states[max(0, k - delay)])
        states.append(solve_ivp(crane, (0, step), states[-1], args=(force,), rtol=1e-10, atol=1e-12).y[:, -1])
    return np.array(states)


def test_numbers_of_the_crane():
    states, coarse, late = loop(0.01), loop(0.1), loop(0.01, delay=1)
    largest = lambda states: max(abs(states[:, 2]))
    check_numbers(CRANE, [2 * m * L * np.sin(0.5) / (M + m), states[100, 0], states[500, 0], largest(states), largest(late), largest(coarse)])


def test_trolley_moves_under_the_swinging_load(open_fmu):
    swinging = open_fmu("Crane").initialize({"theta": 0.5, "c": 0})
    x, load = np.array(swinging.run(10, 0.01, "x", "loadX"))[:, -2:].T
    travel = 2 * m * L * np.sin(0.5) / (M + m)
    assert np.ptp(x) == pytest.approx(travel, abs=1e-4) and np.ptp(load) == pytest.approx(2 * np.sin(0.5) - travel, abs=1e-4)


def test_gains_are_those_of_the_regulator(lagrange_fmu):  # noqa: F811
    """The page's weights and gains are in the order of the states that linearize() returns."""
    A, B, _, _, states = lagrange_fmu.linearize(fmu.archive("Crane"))[:5]
    assert ", ".join(states) == re.search(r"in the order (\w+, \w+, \w+, \w+)\.", CRANE)[1]
    by_hand = [[0, 0, 1, 0], [0, 0, 0, 1], [0, m * G / M, -C / M, 0], [0, -(M + m) * G / (M * L), C / (M * L), 0]]
    np.testing.assert_allclose(A, by_hand, atol=1e-12)
    weights = [float(weight) for weight in re.search(r"Q = diag\((.*?)\)", CRANE)[1].split(",")]
    gains = 5 * np.transpose(B) @ solve_continuous_are(A, B, np.diag(weights), [[0.2]])
    shown = re.search(r"the gains\s+(\S+) N/m, (\S+) N/rad, (\S+) N.s/m and (\S+) N.s/rad", CRANE).groups()
    np.testing.assert_allclose(gains[0], [float(value) for value in shown], atol=5e-3)


def test_loop_in_python(lagrange_fmu, tmp_path, monkeypatch, capsys):  # noqa: F811
    """The program of the page gives the numbers below it."""
    monkeypatch.chdir(tmp_path)
    code = re.search(r"```python\n(.*?)```", CRANE, re.S).group(1)
    exec(code.replace('"Crane.xml"', repr(str(fmu.archive("Crane")))), {})
    printed = [float(word) for word in capsys.readouterr().out.split()]
    states = loop(0.01)
    load = states[:, 0] + L * np.sin(states[:, 2])
    assert printed == pytest.approx([1, states[100, 0], load[100], 5, states[500, 0], load[500], max(abs(states[:, 2]))], abs=1e-7)


def test_numbers_of_the_browser():
    energy = -G * 0.5 * 3 * np.cos(2)
    mode = 2 * np.pi / np.sqrt((2 - np.sqrt(2)) * G / 0.5)
    check_numbers(BROWSER, [2 * pendulum_half_period(1, RATE), 2 * np.pi / RATE, energy, mode, pendulum_half_period(1, RATE) / 2])


def test_systems_of_the_browser(open_fmu):
    swing = open_fmu("Swing").initialize()
    swing.step(2 * pendulum_half_period(1, RATE))
    assert swing.get("theta") == pytest.approx(1, abs=1e-7)
    double = open_fmu("Double").initialize()
    double.step(20)
    assert double.get("totalEnergy") == pytest.approx(-G * 0.5 * 3 * np.cos(2), rel=1e-6)
    wall = open_fmu("Wall").initialize()
    wall.step(pendulum_half_period(1, RATE) / 2 - 1e-6)
    assert wall.get("omega") < 0
    wall.step(1e-5)
    assert wall.get("omega") > 0


@pytest.mark.parametrize("page", PAGES)
def test_commands_name_variables_of_the_page(page):
    for name, words in re.findall(r"lagrange-fmu run (\w+)\.xml *([^`\n#]*)", PAGES[page]):
        assert set(settings_of(words)) <= {variable.name for variable in fmu.description(name).modelVariables}, name
