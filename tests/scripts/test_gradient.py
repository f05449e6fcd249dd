"""Gradients of one number of a motion by the adjoint equation, in the package: against closed forms, and their cost."""

import math

import mpmath
import numpy as np
import pytest

import fmu
from building import BUILD, archive_of, build_systems
from motions import BALL, BELT, DOUBLE, DOUBLE_AT, OSCILLATOR, STIFF, WORKED, allow_calls, belt, bounce, creep, energy_of_double, lagrange_fmu, measured, oscillation, slopes, small_bounces, work  # noqa: F401

CONSTRAINED = (fmu.ROOT / "fmu" / "PendulumCartesian" / "system.xml").read_text().replace('name="PendulumCartesian"', 'name="Held"')
MANY = """<system name="Many"><constant name="L" value="1" unit="m"/><constant name="k" value="10" unit="N/m"/>
  <for index="i" from="1" to="100"><parameter name="c[i]" start="0.01" unit="N"/></for>
  <coordinate name="x" velocity="v" unit="m" start="1"/><particle mass="1" x="x"/><potential>k*x^2/2</potential>
  <for index="i" from="1" to="100"><force coordinate="x">-c[i]*sin(i*x/L/10)</force></for></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    systems = {"Oscillator": OSCILLATOR, "Ball": BALL, "Belt": BELT, "Held": CONSTRAINED, "Double": DOUBLE, "Many": MANY, "Worked": WORKED, "Stiff": STIFF}
    build_systems("gradients", systems, "--adjoint", versions=(3,))


def archive(name):
    return archive_of(BUILD / "gradients", name, 3)


AT = {"m": 2.0, "k": 50.0, "d": 1.0, "x": 0.3, "F": 4.0}


@pytest.mark.long
@pytest.mark.parametrize("integral", [False, True])
def test_a_value_at_the_end_and_an_integral(lagrange_fmu, integral):  # noqa: F811
    """Derivatives for an oscillation by parameters, a start value and a constant input."""

    def number(*at):
        return mpmath.quad(lambda t: oscillation(t, *at), [0, 1, 2, 3, 4]) if integral else oscillation(4, *at)

    found = lagrange_fmu.gradient(archive("Oscillator"), "x", list(AT), 4, integral=integral, start_values={"F": 4.0})
    assert found.value == pytest.approx(float(number(*AT.values())), rel=1e-9)
    assert found.derivatives == pytest.approx(slopes(number, AT), rel=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("integral", [False, True])
def test_of_a_state_that_is_no_output(lagrange_fmu, integral):  # noqa: F811
    expected = slopes(lambda *at: mpmath.quad(lambda t: work(t, *at), [0, 1, 2, 3, 4]) if integral else work(4, *at), AT)
    found = lagrange_fmu.gradient(archive("Worked"), "nonConservativeWork", list(AT), 4, integral=integral, start_values={"F": 4.0})
    assert found.derivatives == pytest.approx(expected, rel=1e-7)


def test_of_a_stiff_motion(lagrange_fmu, monkeypatch):  # noqa: F811
    """Forward and backward integration take steps that an explicit method could not."""
    from lagrange_fmu.adjoint import AdjointMotion, DifferentiableMotion

    for owner in (AdjointMotion, DifferentiableMotion):
        allow_calls(monkeypatch, owner, "rates", 20000)
    at = {"m": 2.0, "k": 50.0, "d": 1e6, "x": 0.3}
    found = lagrange_fmu.gradient(archive("Stiff"), "x", list(at), 2)
    assert found.derivatives == pytest.approx(slopes(lambda *values: creep(mpmath.mpf(2), *values), at), rel=1e-7, abs=1e-11)


def test_squares(lagrange_fmu):  # noqa: F811
    """The sum of squares of the residuals, with a measured input."""
    data = measured(np.random.default_rng(3), {"m": 1.7, "k": 61.0, "d": 0.8, "x": 0.25}, F=4.0)[::10]
    varied = {name: AT[name] for name in ("m", "k", "d", "x")}

    def number(*at):
        return sum(((oscillation(mpmath.mpf(row["time"]), *at, F=4) - row["x"]) / mpmath.mpf(0.02)) ** 2 for row in data)

    found = lagrange_fmu.gradient(archive("Oscillator"), by=list(varied), data=data, noise={"x": 0.02})
    assert found.value == pytest.approx(float(number(*varied.values())), rel=1e-9)
    assert found.derivatives == pytest.approx(slopes(number, varied), rel=1e-8)


def test_through_impacts(lagrange_fmu):  # noqa: F811
    """A ball after three bounces; without loss, e is at its maximum."""
    for e in (0.7, 1.0):
        at = {"h": 1.3, "g": 9.81, "e": e}
        fall = math.sqrt(2 * 1.3 / 9.81)
        time = fall + 2 * (e + e * e) * fall + 0.1
        found = lagrange_fmu.gradient(archive("Ball"), "h", list(at), time, start_values=at)
        assert found.derivatives == pytest.approx(slopes(lambda *at: bounce(mpmath.mpf(time), *at, 3), at), rel=1e-7)


def test_through_small_bounces(lagrange_fmu):  # noqa: F811
    """Bounces of micrometres and milliseconds, where a delay of 1e-11 m in handling them matters."""
    for at, time, expected in small_bounces():
        assert lagrange_fmu.gradient(archive("Ball"), "v", list(at), time, start_values=at).derivatives == pytest.approx(expected, rel=2e-6)


def test_to_rest(lagrange_fmu):  # noqa: F811
    """Gradient of the integral of the height, through all bounces until rest."""
    at = {"h": 0.2, "g": 9.81, "e": 0.5}
    height = lambda h, g, e: mpmath.mpf(2) / 3 * h * mpmath.sqrt(2 * h / g) * (1 + 2 * e**3 / (1 - e**3))  # integral of each parabola: 2/3 of its height times its length
    found = lagrange_fmu.gradient(archive("Ball"), "h", list(at), 1.0, integral=True, start_values=at)
    assert found.value == pytest.approx(float(height(*at.values())), rel=1e-8)
    assert found.derivatives == pytest.approx(slopes(height, at), rel=1e-6)


def test_through_friction(lagrange_fmu):  # noqa: F811
    at = {"k": 20.0, "F": 3.0, "u": 0.4}
    found = lagrange_fmu.gradient(archive("Belt"), "x", list(at), 0.9, start_values=at)
    assert found.derivatives == pytest.approx(slopes(lambda *at: belt([mpmath.mpf(0.9)], *at)[0], at), rel=1e-6)


def test_through_a_constraint(lagrange_fmu):  # noqa: F811
    """Gradient of a pendulum in x and y with respect to gravity and to its length, which also changes the start."""

    def x(l, g):
        angle = mpmath.atan2(3, 4)
        k = mpmath.sin(angle / 2)
        return l * mpmath.sin(2 * mpmath.asin(k * mpmath.ellipfun("cd", mpmath.sqrt(g / l) * 3, m=k * k)))

    found = lagrange_fmu.gradient(archive("Held"), "x", ["l", "g"], 3, start_values={"x": 0.6, "y": -0.8, "l": 1.0, "g": 9.81})
    assert found.derivatives == pytest.approx(slopes(x, {"l": 1.0, "g": 9.81}), rel=1e-7)


def test_energy_is_that_of_the_start(lagrange_fmu):  # noqa: F811
    """The motion is chaotic, so that its states depend on the start hundreds of times more strongly than the energy."""
    found = lagrange_fmu.gradient(archive("Double"), "energy", list(DOUBLE_AT), 3)
    assert found.derivatives == pytest.approx(slopes(energy_of_double, DOUBLE_AT), rel=1e-6, abs=1e-6)
    by_start = lagrange_fmu.gradient(archive("Double"), "a", ["a", "b", "l2"], 3).derivatives
    assert max(map(abs, by_start.values())) > 100


def test_cost(lagrange_fmu, monkeypatch):  # noqa: F811
    """One parameter and a hundred take the same numbers of evaluations and initializations."""
    from lagrange_fmu.models import Model3

    counts = {}

    def counted(name):
        function = getattr(Model3, name)

        def call(*words):
            counts[name] = counts.get(name, 0) + 1
            return function(*words)

        monkeypatch.setattr(Model3, name, call)

    for name in ("adjoint", "getReal", "start_over"):
        counted(name)
    spent = []
    for number in (1, 10, 100):
        counts.clear()
        lagrange_fmu.gradient(archive("Many"), "x", [f"c[{i}]" for i in range(1, number + 1)], 2)
        spent.append(dict(counts))
    for other in spent[1:]:
        assert other["start_over"] == spent[0]["start_over"]
        assert other["adjoint"] + other["getReal"] < 1.3 * (spent[0]["adjoint"] + spent[0]["getReal"])


def test_errors(lagrange_fmu):  # noqa: F811
    for words, why in (({}, "by is empty"), ({"by": ["k"]}, "expected the name"), ({"of": "x", "by": ["k"]}, "stop time is None"), ({"of": "x", "by": ["k"], "stop_time": math.inf}, "stop_time is inf"), ({"of": "x", "stop_time": 1, "by": ["kk"]}, "'kk' is not a parameter"),
                       ({"of": "x", "stop_time": 1, "by": ["k"], "tolerance": math.nan}, "the tolerance is nan")):  # fmt: skip
        with pytest.raises(lagrange_fmu.Problem, match=why):
            lagrange_fmu.gradient(archive("Oscillator"), **words)
    with pytest.raises(lagrange_fmu.Problem, match="no adjoint derivatives of FMI 3.0"):
        lagrange_fmu.gradient(fmu.archive("SimplePendulum"), "theta", ["l"], 1)
