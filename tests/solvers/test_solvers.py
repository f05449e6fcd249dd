"""Difficult cases for the methods with error estimates, erk, bdf and radau."""

import io
import math
import re
import zipfile

import matplotlib.image
import mpmath
import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fmu
from fmu import DISCARD, ERROR

METHODS = ("erk", "bdf", "radau")

# A unit mass at x with velocity v: the force, and the initial values.
FORCES = {
    "Collision": ("-a/x^2", 1, 0, ""),
    "Logarithm": ("-a/x", 1, 0, ""),
    "Tangent": ("a*tan(x)", 0.5, 0, ""),
    "Power": ("x^a", -2, 0, ""),
    "Stiff": ("-1e12*v - 1e12*x", 1, 0, ""),
    "Wall": ("a - exp(50*(x - 3))", 0, 0, ""),
    "Pulse": ("exp(-((time - 5)/0.01)^2)", 0, 0, 'maxStep="0.01"'),
}

HUNG = """<system name="Hung"><coordinate name="x" velocity="v" start="1"/><coordinate name="y" velocity="w"/><particle mass="1" x="x" y="y"/>
  <gravity y="-9.81"/><constraint name="rod">x^2 + y^2 - 1</constraint><solver method="taylor" maxSteps="30"/></system>"""


def text(name, force, x, v, solver):
    return f"""<system name="{name}">
  <parameter name="a" start="1"/>
  <coordinate name="x" velocity="v" start="{x}" velocityStart="{v}"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">{force}</force>
  <solver {solver}/>
  <experiment stopTime="0.1"/>
</system>
"""


@pytest.fixture(scope="module", autouse=True)
def systems():
    """Build every force with each method: PulseErk, PulseBdf, ..."""
    texts = {}
    for name, (force, x, v, solver) in FORCES.items():
        for method in METHODS:
            whole = name + method.capitalize()
            texts[whole] = text(whole, force, x, v, f'method="{method}" {solver}')
    for method in ("taylor", *METHODS):
        whole = f"Few{method.capitalize()}"
        texts[whole] = text(whole, "-1e4*x", 1, 0, f'method="{method}" maxSteps="30"')
    texts["Oscillator"] = text("Oscillator", "-1e8*x", 1, 0, 'method="taylor"')
    texts["Spiral"] = text("Spiral", "-4e7*x - 50*v", 1, 0, 'method="taylor"')
    texts["Hung"] = HUNG
    fmu.build_systems("solver-systems", texts)


@pytest.mark.parametrize("method", ["Erk", "Bdf", "Radau"])
def test_the_longest_step_finds_a_pulse(method, open_fmu):
    """A pulse of 0.01 s within a communication step of 10 s; its integral is 0.01 sqrt(pi)."""
    instance = open_fmu(f"Pulse{method}").initialize(tolerance=1e-8)
    instance.step(10.0)
    assert instance.get("v") == pytest.approx(0.01 * math.sqrt(math.pi), rel=1e-6)


@pytest.mark.parametrize("method", ["Taylor", "Erk", "Bdf"])
def test_a_number_of_steps_that_the_author_sets(method, open_fmu):
    """maxSteps counts within one communication step: 30 suffice for a short one, and for the next one again."""
    instance = open_fmu(f"Few{method}").initialize(tolerance=1e-4)
    for _ in range(3):
        instance.step(0.001)
    assert instance.get("x") == pytest.approx(math.cos(0.3), abs=1e-2)
    with instance.fails(2, "maxSteps of <solver> is reached in one communication step"):
        instance.step(100.0)


def test_a_limit_of_steps_blames_no_constraint(open_fmu):
    """The rod of a pendulum is far from singular; only the limit of steps ends the motion."""
    instance = open_fmu("Hung").initialize()
    with instance.fails(DISCARD, "maxSteps of <solver> is reached"):
        instance.step(100.0)
    assert not any("'rod'" in text for _, _, text in instance.messages)


@pytest.mark.parametrize("method", ["taylor", *METHODS])
def test_a_method_that_stops_advises_others(method, open_fmu):
    instance = open_fmu(f"Few{method.capitalize()}").initialize(tolerance=1e-4)
    with instance.fails(DISCARD, "retrying will not help; .* or build with another <solver>: "):
        instance.step(100.0)
    advice = instance.messages[-1][2].split("another <solver>: ")[1]
    assert set(re.findall("taylor|erk|radau|bdf|auto", advice)) == {"auto"} - {method}


def test_many_steps_give_a_warning(open_fmu):
    """A communication step of 50000 steps logs one warning and succeeds."""
    instance = open_fmu("Oscillator").initialize(tolerance=1e-8)
    instance.step(40.0)
    reported = [(status, text) for status, _, text in instance.messages if "maxSteps" in text]
    assert len(reported) == 1 and reported[0][0] == 1
    limit = re.search(r"has taken 50000 steps from time 0 .* stops after (\d+), which maxSteps .* can change ", reported[0][1])
    assert 5e6 < int(limit[1]) < 1e8  # 10 s at 0.1 to 2 microseconds per step
    assert instance.get("x") == pytest.approx(math.cos(4e5), abs=1e-2)


def test_a_step_to_the_end_of_all_numbers_ends(open_fmu):
    instance = open_fmu("StickSlip").initialize()
    with instance.fails(DISCARD, "stopped at time"):
        instance.step(1e307)


def collision_time(name, a):
    """Time to the pole of the force, from energy: v^2 = 2 (U(x0) - U(x))."""
    start, pole, potential = {
        "Collision": (mpmath.mpf(1), 0, lambda x: -a / x),
        "Logarithm": (mpmath.mpf(1), 0, lambda x: a * mpmath.log(x)),
        "Tangent": (mpmath.mpf(0.5), mpmath.pi / 2, lambda x: a * mpmath.log(mpmath.cos(x))),
    }[name]
    integrand = lambda x: 1 / mpmath.sqrt(2 * (potential(start) - potential(x)))
    return abs(mpmath.quad(integrand, [start, (start + pole) / 2, pole]))


@pytest.mark.parametrize("name", ["Collision", "Logarithm", "Tangent"])
@pytest.mark.parametrize("method", ["Erk", "Bdf", "Radau"])
def test_no_step_passes_through_a_singularity(name, method, open_fmu):
    instance, end = open_fmu(name + method, logging=True), 4.0
    for a in (0.5, 1.0, 1.3):
        last = float(collision_time(name, a))
        for tolerance in (1e-3, 1e-5, 1e-8, 1e-11):
            for step in (0.01, 0.3, 4.0):
                instance.reset().initialize({"a": a}, tolerance)
                with instance.fails(DISCARD, "singularity|no solution|steps were rejected too often"):
                    instance.run(end, step)
                assert instance.fmu.getRealStatus(2) == pytest.approx(last, abs=max(1e-6, 20 * tolerance))


@pytest.mark.parametrize("method", ["Erk", "Bdf", "Radau"])
def test_a_trial_stage_may_fail(method, open_fmu):
    """Steps grow before the wall, so that a trial stage overflows beyond it; the motion agrees with SciPy's."""
    instance = open_fmu(f"Wall{method}").initialize({"a": 1.0}, tolerance=1e-9)
    force = lambda x: 1 - math.exp(50 * (x - 3))
    exact = solve_ivp(lambda t, y: [y[1], force(y[0])], (0, 3), [0, 0], method="DOP853", rtol=1e-13, atol=1e-13)
    instance.step(3.0)
    assert [instance.get("x"), instance.get("v")] == pytest.approx(exact.y[:, -1], abs=1e-6)


def test_a_division_by_zero(open_fmu):
    """x^-1 at x = 0: the message states the likely cause."""
    instance = open_fmu("PowerErk")
    instance.fmu.setupExperiment()
    instance.set(a=-1.0, x=0.0)
    instance.fmu.enterInitializationMode()
    with pytest.raises(FMICallException):
        instance.fmu.exitInitializationMode()
    assert any("as when something is divided by 0" in text for _, _, text in instance.messages)


def test_a_parameter_that_is_not_varied_contributes_nothing(open_fmu):
    """x^3 has a derivative by x for x < 0, but none by the exponent."""
    instance = open_fmu("PowerErk").initialize({"a": 3.0})
    along = lambda name: instance.fmu.getDirectionalDerivative(instance.vr("der(v)"), instance.vr(name), [1.0])
    assert along("x") == pytest.approx([12.0], rel=1e-15)
    with instance.fails(ERROR, "not finite"):  # FMI 2.0.4, section 2.1.3 lists no Discard for this call
        along("a")
    instance.reset().initialize({"a": 3.0, "x": 2.0})
    assert along("a") == pytest.approx([8 * math.log(2)], rel=1e-15)


def test_events_cost_erk_no_digits():
    """The state at an event lies within a step; a dense output of lower order than the step would lose accuracy."""
    system = (
        '<system name="Kicked"><coordinate name="x" velocity="v" start="-0.2"/><kinetic>v^2/2</kinetic><force coordinate="x">3*sin(4*time)</force>'
        '<event when="x" direction="rising"><set velocity="v">v + 1</set></event><solver method="erk"/></system>'
    )
    fmu.build_systems("kicked", {"Kicked": system})
    # v = 3/4 (1 - cos(4 t)); after the event at x = 0 it is larger by 1.
    x = lambda t: -0.2 + 0.75 * (t - np.sin(4 * t) / 4)
    event = brentq(x, 0, 1, xtol=1e-15)
    for tolerance in (1e-10, 1e-12):
        words = dict(stop_time=1.5, output_interval=1.5, relative_tolerance=tolerance, output=["x"])
        result = simulate_fmu(fmu.archive("Kicked"), **words)["x"][-1]
        assert result == pytest.approx(x(1.5) + 1.5 - event, abs=tolerance), tolerance
