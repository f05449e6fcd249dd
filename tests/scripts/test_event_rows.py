"""
Simulations have two rows at each event, one before and one after it, with the same time; against closed forms, in both versions of FMI.
"""

import math
import sys

import numpy as np
import pytest

import fmi3
import fmu
import package
from building import build_systems
from fmu import ROOT

sys.path.insert(0, str(ROOT))
from scripts.library.simulation import event_times, simulate  # noqa: E402

SWITCHED = """<system name="Switched"><coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/><force coordinate="x">if(time &lt; 0.35, 1, -3)</force>
  <output name="a" unit="m/s2">der(v)</output><experiment stopTime="1" stepSize="0.1"/></system>"""
CROWD = """<system name="Crowd"><for index="i" from="1" to="40"><coordinate name="h[i]" velocity="v[i]" unit="m" start="1 + i/100"/><particle name="p[i]" mass="1" y="h[i]"/>
  <contact name="floor[i]" gap="h[i]" unit="m" restitution="0.5"/></for><gravity y="-9.81"/><experiment stopTime="1" stepSize="0.5"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("events", {"Switched": SWITCHED, "Crowd": CROWD}, versions=(2, 3))
    build_systems("halved", {"Halved": SWITCHED.replace('"Switched"', '"Halved"').replace("0.35", "0.5")}, versions=(2, 3))


@pytest.mark.parametrize("of", [fmu, fmi3])
def test_bounces(of):
    """
    Events are at the times of the closed form; there the velocity changes by the coefficient of restitution. Between events the motion is
    the same to the last bit.
    """
    words = dict(stop_time=2.0, output_interval=0.25)
    motion = simulate(of.archive("BouncingBall"), {"h": 1.0, "e": 0.8}, **words).outputs
    fall, e = math.sqrt(2 / 9.81), 0.8
    bounces = [fall * (1 + 2 * sum(e**k for k in range(1, i + 1))) for i in range(3)]
    after = np.flatnonzero(np.diff(motion["time"]) == 0) + 1
    np.testing.assert_allclose(motion["time"][after], bounces, atol=1e-10)
    np.testing.assert_allclose(motion["v"][after - 1], [-9.81 * fall * e**k for k in range(3)], rtol=1e-9)
    np.testing.assert_allclose(motion["v"][after], [9.81 * fall * e ** (k + 1) for k in range(3)], rtol=1e-9)
    np.testing.assert_allclose(motion["h"][after], 0, atol=1e-9)
    even = simulate(of.archive("BouncingBall"), {"h": 1.0, "e": 0.8}, record_events=False, **words).outputs
    others = np.setdiff1d(np.arange(len(motion)), [*after, *(after - 1)])
    assert even["time"].tolist() == np.arange(0, 2.1, 0.25).tolist() and motion[others].tobytes() == even.tobytes()


def test_searches_end(monkeypatch):
    """Once they have taken too long, a warning says so, and further events have no rows: here after the step with the first one, at 0.4515 s."""
    monkeypatch.setattr("scripts.library.co_simulation.LONGEST_SEARCH", 0.0)
    with pytest.warns(UserWarning, match=r"^events after 0\.5 s have no rows, .*; expected --fmi 3 \(fmi=3\), with which the FMU stops at them"):
        motion = simulate(fmu.archive("BouncingBall"), {"h": 1.0, "e": 0.8}, stop_time=2.0, output_interval=0.25).outputs
    assert np.flatnonzero(np.diff(motion["time"]) == 0).size == 1 and len(motion) == 9 + 2


@pytest.mark.parametrize("of", [fmu, fmi3])
def test_a_force_that_switches(of):
    """At 0.35 s the acceleration changes from 1 to -3; the velocity is 0.35 in both rows."""
    motion = simulate(of.archive("Switched"), {}).outputs
    [after] = np.flatnonzero(np.diff(motion["time"]) == 0) + 1
    assert motion["time"][after] == pytest.approx(0.35, abs=1e-9) and motion["a"][[after - 1, after]].tolist() == [1, -3]
    np.testing.assert_allclose(motion["v"][[after - 1, after]], 0.35, atol=1e-9)
    assert len(motion) == 11 + 2


@pytest.mark.parametrize("of", [fmu, fmi3])
def test_an_event_at_a_communication_point(of):
    """The force changes from 1 to -3 N at 0.5 s, where a step of 0.25 s ends: two rows, before and after; x = t^2/2 until then."""
    motion = simulate(of.archive("Halved"), {}, stop_time=1.0, output_interval=0.25).outputs
    at = np.abs(motion["time"] - 0.5) < 1e-9
    np.testing.assert_allclose(motion["a"][at], [1, -3])
    np.testing.assert_allclose(motion["x"][at], 0.125, rtol=1e-9)
    assert len(motion["time"]) == 6


def test_many_events_of_a_step():
    """Forty balls fall from different heights: FMI 3.0 reports all events, FMI 2.0 the first ones of a step; other values agree."""
    all_of = simulate(fmi3.archive("Crowd"), {})
    first = simulate(fmu.archive("Crowd"), {})
    falls = np.sqrt(2 * (1 + np.arange(1, 41) / 100) / 9.81)
    assert np.max(abs(event_times(all_of.values)[:40] - falls)) < 1e-9
    found = event_times(first.values)
    assert 10 <= len(found) <= 42 and np.max(abs(found[:20] - falls[:20])) < 1e-9
    assert first.values["events"][-1] == all_of.values["events"][-1] >= 40


def test_the_command(tmp_path):
    folder = package.assemble(tmp_path / "package")
    words = ["run", fmu.archive("BouncingBall"), "h=1", "--stop-time", "0.6", "--step", "0.1", "--output", "v"]
    for further, rows in (([], 9), (["--no-events"], 7), (["--no-events", "v=0"], 7)):
        result = package.run(folder, *words, *further, cwd=tmp_path)
        assert result.returncode == 0, result.stderr
        assert len((tmp_path / "BouncingBall.csv").read_text().splitlines()) == 1 + rows
