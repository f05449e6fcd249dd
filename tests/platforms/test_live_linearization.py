"""Equilibria and linearizations of live pages, against those of the Python package; and second runs beside the first one."""

import numpy as np
import pytest

import fmu
from driven_chromium import browser, opened, page_of_fmu  # noqa: F401
from motions import lagrange_fmu  # noqa: F401

G = 9.81


def found_in(page):
    page.click("text=Equilibrium and linearization")
    page.wait_for_function("live.linearization")
    return page.evaluate("live.linearization")


def matched(found, expected):
    """The largest distance of an expected complex number from the nearest one that was found."""
    numbers = np.array([complex(*pair) for pair in found])
    assert len(numbers) == len(expected)
    return max(np.abs(numbers - value).min() for value in expected)


# Start values from which the search begins: hanging pendulums, one that stands, a linkage (constraints), and an input.
CASES = {
    "DoublePendulum": {"theta1": 0.4, "theta2": -0.3},
    "InvertedPendulumCart": {"theta": 0.1},
    "FourBar": {},
    "MotorPendulum": {"voltage": 0},
    "PendulumCartesian": {},
    "ElasticPendulum": {},
}


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_equilibria_and_linearizations(browser, page_of_fmu, lagrange_fmu, name):
    """A, B, C, D and eigenvalues are those of the package at the same point, which is an equilibrium for the package, too."""
    address = "#" + "&".join(f"{key}={value}" for key, value in CASES[name].items())
    with opened(browser, page_of_fmu(name), address) as page:
        found = found_in(page)
        assert found.get("problem") is None
        model = found["model"]
        shown = page.locator("#linearization table").count()
        assert shown == sum(1 for part in "ABCD" if np.size(model[part]))
    states = fmu.states_of(name)
    point = dict(zip([name for name in states if name != "nonConservativeWork"], model["at"], strict=True))
    rest = lagrange_fmu.equilibrium(fmu.archive(name), point | {key: value for key, value in CASES[name].items() if key not in point})
    assert {key: rest.point[key] for key in point} == pytest.approx(point, rel=1e-8, abs=1e-8)
    linear = rest.linearization
    assert (model["states"], model["inputs"], model["outputs"]) == (linear.states, linear.inputs, linear.outputs)
    for part, expected in zip("ABCD", linear[:4], strict=True):
        size = np.abs(expected).max(initial=1.0)
        assert np.array(model[part]).reshape(expected.shape) == pytest.approx(expected, rel=1e-6, abs=1e-7 * size)
    assert matched(found["eigenvalues"], np.linalg.eigvals(linear.A)) < 1e-6 * np.abs(linear.A).max()
    assert found["stability"] == rest.stability


def test_a_linear_ghost(browser, page_of_fmu):
    """The linearized motion of the hanging double pendulum is that of the exponential of A, and its potential energy follows from its angles."""
    with opened(browser, page_of_fmu("DoublePendulum"), "#theta1=0.3&theta2=0.2") as page:
        page.select_option("#ghost", "linear")
        page.wait_for_function("live.history.runs === 2")
        page.click("#play")
        page.wait_for_function("live.history.length > 60")
        page.click("#play")
        rods = """() => { const at = live.history.length - 1; live.scene.draw(live.history, at);
          return [live.scene.ghostLines.map(({ group, line }) => [line.from, line.to, group.visible, Math.atan2(group.matrix.elements[4], -group.matrix.elements[5])]),
                  [...live.history.samples[at][1]]]; }"""
        drawn, last = page.evaluate(rods)  # in one call, since the last samples may still be on their way
        names, times, runs = page.evaluate("[live.names, live.history.times, live.history.samples.map(runs => runs.map(run => [...run]))]")
    rows, states = np.array([run[1] for run in runs]), fmu.states_of("DoublePendulum")
    places = [names.index(state) for state in states]
    assert [rod[:3] for rod in drawn] == [["", "upper", True], ["upper", "lower", True]]
    assert [rod[3] for rod in drawn] == pytest.approx([last[place] for place in places[:2]], abs=1e-6)
    frequencies, shapes = np.sqrt(G * (2 + np.array([-1, 1]) * np.sqrt(2))), np.array([[1, np.sqrt(2)], [1, -np.sqrt(2)]]).T
    amplitudes = np.linalg.solve(shapes, [0.3, 0.2])
    expected = np.array([shapes @ (amplitudes * np.cos(frequencies * time)) for time in times])
    assert rows[:, places[:2]] == pytest.approx(expected, abs=1e-8)
    heights = -2 * np.cos(rows[:, places[0]]) - np.cos(rows[:, places[1]])
    assert rows[:, names.index("potentialEnergy")] - G * heights == pytest.approx(rows[0, names.index("potentialEnergy")] - G * heights[0], abs=1e-9)
    assert np.abs(rows - np.array([run[0] for run in runs])).max() > 1e-3


def test_a_ghost_keeps_its_values(browser, page_of_fmu):
    """Parameters change in the first run alone; a key pushes both; without an equilibrium there is no linear ghost, and the page says why."""
    with opened(browser, page_of_fmu("InvertedPendulumCart")) as page:
        page.select_option("#ghost", "kept")
        page.wait_for_function("live.history.runs === 2")
        page.get_by_role("spinbutton", name="g", exact=True).fill("1.62")
        page.get_by_role("spinbutton", name="g", exact=True).press("Enter")
        page.click("#reset")
        place = page.evaluate("live.names.indexOf('der(omega)')")
        page.wait_for_function(f"live.history.length === 1 && live.history.samples[0][0][{place}] !== live.history.samples[0][1][{place}]")
        first, second = page.evaluate(f"live.history.samples[0].map(run => run[{place}])")
        assert first / second == pytest.approx(1.62 / G, rel=1e-9)
        page.get_by_role("spinbutton", name="F", exact=True).fill("1")
        page.get_by_role("spinbutton", name="F", exact=True).press("Enter")
        page.wait_for_function(f"live.history.samples[0][1][{place}] !== {second}")
        page.select_option("#ghost", "linear")
        page.wait_for_function("document.getElementById('ghost').value === 'none' && live.history.runs === 1")
        assert "no equilibrium" in page.inner_text("#message")
