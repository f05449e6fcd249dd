"""
Roots that begin and end at an event, such as sqrt(max(0, h - 1)) of a weir, against closed forms, with all methods and in model exchange.

The slope of a root is infinite where it begins, but the motion is unique there: of u' = q - k sqrt(u) from 0, w = sqrt(u) is
given by t = -2 w/k - 2 q/k^2 log(1 - k w/q).
"""

import math

import fmpy
import mpmath
import numpy as np
import pytest

from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from fmu import Instance, archive, build_systems

METHODS = ["taylor", "auto", "radau", "bdf", "erk"]
K = 0.5
# Cases: water rises to the crest of a weir; a crest rises, too; an orifice has flow in both directions; a spring begins at x = 0.
SYSTEMS = {
    "Weir": """<input name="q" unit="m/s" start="0.1"/><parameter name="c" start="1" unit="m"/><parameter name="k" start="0.5" unit="m0.5/s"/>
      <state name="h" unit="m" start="0.5" rate="q - k*sqrt(max(0, h - c))"/>""",
    "RisingCrest": '<state name="h" start="-0.5" rate="2 - 0.5*sqrt(max(0, h - time))"/>',
    "Orifice": '<state name="p" start="-1" rate="1 - 0.5*if(p > 0, sqrt(p), -sqrt(-p))"/>',
    "Spring": '<parameter name="n" start="1.5"/><coordinate name="x" velocity="v" start="-1" velocityStart="1"/><particle mass="1" x="x"/><potential>max(0, x)^n</potential>',
    "Pulses": '<state name="y" rate="sqrt(max(0, sin(time)))"/>',
    "Tank": '<state name="h" start="1" rate="-0.5*sqrt(max(0, h))"/><output name="flow">0.5*sqrt(max(0, h))</output>',
    "CheckValve": '<state name="a" start="1" rate="if(a > b, -0.5*sqrt(a - b), 0)"/><state name="b" rate="if(a > b, 0.5*sqrt(a - b), 0)"/>',
    "Levels": '<state name="a" start="1" rate="if(a > b, -0.5*sqrt(a - b), 0.5*sqrt(b - a))"/><state name="b" rate="if(a > b, 0.5*sqrt(a - b), -0.5*sqrt(b - a))"/>',
    "Tide": '<state name="h" start="1" rate="0.3*sin(2*time) - 0.5*sqrt(max(0, h))"/>',
    "TwoWeirs": """<state name="h" start="-1" rate="1 - 0.5*sqrt(max(0, h))"/><state name="g" start="-0.25" rate="0.5*exp(-g)*sqrt(max(0, h)) - 0.4*sqrt(max(0, g))"/>""",
}


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {f"{name}By{method.title()}": f'<system name="{name}By{method.title()}">{body}<solver method="{method}"/></system>' for name, body in SYSTEMS.items() for method in METHODS}
    build_systems("roots", texts)


def outflow(t, q):
    """u(t) of u' = q - k sqrt(u), u(0) = 0."""
    if t <= 0:
        return 0.0
    steady = q / K
    time = lambda w: -2 * w / K - 2 * steady / K * math.log1p(-w / steady)
    root = brentq(lambda w: time(w) - t, 0.0, steady * (1 - 1e-15), xtol=1e-15)
    return root**2


def motion(name, method, step, stop, *names, **values):
    """The names at the communication points, up to `stop`; inputs are set before each step, as importers do."""
    with_inputs = [word for word in values if word == "q"]
    instance = Instance(f"{name}By{method.title()}").initialize(values)
    rows = [[0.0, *instance.fmu.getReal(instance.vr(*names))]]
    while instance.time < stop - step / 2:
        instance.set({word: values[word] for word in with_inputs})
        instance.step(step)
        rows.append([instance.time, *instance.fmu.getReal(instance.vr(*names))])
    instance.free()
    return np.array(rows).T


EVERY = pytest.mark.parametrize("method", METHODS)
STEPS = pytest.mark.parametrize("step", [0.125, 1.0, 10.0])


@EVERY
@STEPS
@pytest.mark.parametrize("q, start", [(0.1, 0.5), (0.1, 1), (0.125, 0.25), (0.3, 0.9)])
def test_water_rises_to_a_crest_and_over_it(method, step, q, start):
    """It comes to the crest at (1 - start)/q, also where this is a communication point, up to rounding."""
    time, h = motion("Weir", method, step, 10.0, "h", q=q, h=start)
    np.testing.assert_allclose(h, [min(1, start + q * t) + outflow(t - (1 - start) / q, q) for t in time], rtol=0, atol=2e-7)


@EVERY
@STEPS
def test_water_sinks_to_a_crest_and_rests_there(method, step):
    time, h = motion("Weir", method, step, 10.0, "h", q=0.0, h=2)
    np.testing.assert_allclose(h, 1 + np.maximum(0, 1 - K * time / 2) ** 2, rtol=0, atol=2e-7)
    assert np.ptp(motion("Weir", method, step, 10.0, "h", q=0.0, h=1)[1]) < 1e-12


@EVERY
@STEPS
def test_a_crest_rises(method, step):
    """h - time obeys the same equation with q = 1, from 0.5 s on."""
    time, h = motion("RisingCrest", method, step, 10.0, "h")
    np.testing.assert_allclose(h, [-0.5 + 2 * t if t < 0.5 else t + outflow(t - 0.5, 1) for t in time], rtol=0, atol=2e-7)


@EVERY
@STEPS
def test_flow_turns_round(method, step):
    """With p = -w^2, t = 4 (1 - w) - 8 log((1 + w/2)/(1 + 1/2)) up to p = 0. The equation of a weir follows."""
    passes = 4 - 8 * np.log(1.5)
    time, p = motion("Orifice", method, step, 10.0, "p")
    w = [float(mpmath.findroot(lambda w: 4 * (1 - w) + 8 * mpmath.log((1 + w / 2) / 1.5) - t, 0.5)) if t < passes else 0 for t in time]
    np.testing.assert_allclose(p, [-a * a + outflow(t - passes, 1) for a, t in zip(w, time)], rtol=0, atol=2e-7)


@EVERY
@pytest.mark.parametrize("step", [0.125, 0.25])
def test_a_spring_begins_with_a_root(method, step):
    """
    The energy is that of the start; the mass leaves the spring with the opposite velocity, after 2 (integral of dx/sqrt(1 - 2 x^1.5)), a beta
    function.
    """
    time, x, v = motion("Spring", method, step, 5.0, "x", "v")
    np.testing.assert_allclose(v**2 / 2 + np.maximum(0, x) ** 1.5, 0.5, rtol=0, atol=2e-7)
    contact = float(mpmath.mpf(4) / 3 * mpmath.mpf(0.5) ** (mpmath.mpf(2) / 3) * mpmath.beta(mpmath.mpf(2) / 3, 0.5))
    late = time > 1 + contact
    np.testing.assert_allclose(x[late], 1 + contact - time[late], rtol=0, atol=2e-6)
    assert late.sum() > 5


@EVERY
@pytest.mark.parametrize("step", [0.5, 2.0, 10.0])
def test_pulses_of_time(method, step):
    """The integral of sqrt(sin(t)) over a half period is that by mpmath."""
    area = float(mpmath.quad(lambda t: mpmath.sqrt(mpmath.sin(t)), [0, mpmath.pi / 2, mpmath.pi]))
    time, y = motion("Pulses", method, step, 10.0, "y")
    pauses = [i for i, t in enumerate(time) if t in (4, 6, 10)]
    np.testing.assert_allclose(y[pauses], [2 * area if time[i] == 10 else area for i in pauses], rtol=0, atol=1e-6)


def test_methods_agree_about_two_weirs():
    ends = [motion("TwoWeirs", method, 0.25, 5.0, "h", "g")[1:, -1] for method in METHODS]
    np.testing.assert_allclose([end[0] for end in ends], outflow(4, 1), rtol=0, atol=2e-7)
    np.testing.assert_allclose([end[1] for end in ends], ends[0][1], rtol=0, atol=2e-7)


def test_a_root_that_has_not_begun_has_the_derivative_0():
    """Below the crest the flow does not depend on the level, although the root of 0 has an infinite slope."""
    for method in METHODS:
        instance = Instance(f"WeirBy{method.title()}").initialize({"h": 0.5})
        rate = [instance.fmu.getDirectionalDerivative(instance.vr("der(h)"), instance.vr(name), [1.0])[0] for name in ("q", "k", "c", "h")]
        np.testing.assert_array_equal(rate, [1, 0, 0, 0])
        instance.free()


def drained(t):
    """h' = -sqrt(h)/2 from 1: it ends at 4 s."""
    return np.maximum(0, 1 - np.asarray(t) / 4) ** 2


def levelled(t):
    """a - b = (1 - t/2)^2, and a + b = 1."""
    return 0.5 + 0.5 * np.maximum(0, 1 - np.asarray(t) / 2) ** 2


@EVERY
@STEPS
@pytest.mark.parametrize("name, state, exact", [("Tank", "h", drained), ("CheckValve", "a", levelled), ("Levels", "a", levelled)])
def test_a_root_ends(method, step, name, state, exact):
    time, value = motion(name, method, step, 10.0, state)
    np.testing.assert_allclose(value, exact(time), rtol=0, atol=2e-8)


@EVERY
@STEPS
@pytest.mark.long
def test_a_tide_falls_below_the_end_of_a_root_and_rises_again(method, step):
    time, h = motion("Tide", method, step, 10.0, "h")
    np.testing.assert_allclose(h, tide(time), rtol=0, atol=3e-7)


def tide(times):
    """h by SciPy, from one zero to the next."""
    values, t, h = {}, 0.0, 1.0
    while t < 10:
        flow = 0.5 if h > 0 or (h == 0 and math.sin(2 * t) > 0) else 0.0
        zero = lambda t, y: y[0]
        zero.terminal, zero.direction = True, -1 if flow else 1
        rate = lambda t, y, flow=flow: [0.3 * math.sin(2 * t) - flow * math.sqrt(max(0, y[0]))]
        run = solve_ivp(rate, [t, 10], [h], "Radau" if flow else "DOP853", rtol=1e-10, atol=1e-12, events=zero, dense_output=True)
        values.update({s: run.sol(s)[0] for s in times if t <= s <= run.t[-1]})
        t, h = run.t[-1], 0.0
    return [values[s] for s in times]


def exchanged(name, step, tolerance, *names, **values):
    """Returns the time, and the names, by the CVODE of FMPy, whose trial steps lead beyond the ends of roots."""
    result = fmpy.simulate_fmu(
        str(archive(f"{name}ByTaylor")), fmi_type="ModelExchange", start_values=values, stop_time=10, output_interval=step, relative_tolerance=tolerance, output=names
    )
    assert result["time"][-1] == pytest.approx(10)
    return [result["time"], *(result[word] for word in names)]


EXCHANGES = pytest.mark.parametrize("step, tolerance", [(0.5, 1e-5), (0.5, 1e-8), (10, 1e-7)])


@EXCHANGES
@pytest.mark.long
def test_model_exchange_passes_ends_of_roots(step, tolerance):
    time, h, flow = exchanged("Tank", step, tolerance, "h", "flow")
    np.testing.assert_allclose(h, drained(time), rtol=0, atol=10 * tolerance)
    np.testing.assert_allclose(flow, 0.5 * np.sqrt(drained(time)), rtol=0, atol=10 * tolerance**0.5)
    for name in ("CheckValve", "Levels"):
        time, a = exchanged(name, step, tolerance, "a")
        np.testing.assert_allclose(a, levelled(time), rtol=0, atol=10 * tolerance)
    time, h = exchanged("Weir", step, tolerance, "h", q=0, h=2)
    np.testing.assert_allclose(h, 1 + drained(time), rtol=0, atol=20 * tolerance)
    time, h = exchanged("Tide", step, tolerance, "h")
    np.testing.assert_allclose(h, tide(time), rtol=0, atol=100 * tolerance)


@EXCHANGES
def test_model_exchange_passes_onsets_of_roots(step, tolerance):
    time, h = exchanged("Weir", step, tolerance, "h")
    np.testing.assert_allclose(h, [min(1, 0.5 + 0.1 * t) + outflow(t - 5, 0.1) for t in time], rtol=0, atol=100 * tolerance)
    time, h = exchanged("RisingCrest", step, tolerance, "h")
    np.testing.assert_allclose(h, [-0.5 + 2 * t if t < 0.5 else t + outflow(t - 0.5, 1) for t in time], rtol=0, atol=100 * tolerance)
    time, p = exchanged("Orifice", step, tolerance, "p")
    passes = 4 - 8 * np.log(1.5)
    late = time > passes
    np.testing.assert_allclose(p[late], [outflow(t - passes, 1) for t in time[late]], rtol=0, atol=100 * tolerance)
    time, x, v = exchanged("Spring", step, tolerance, "x", "v")
    np.testing.assert_allclose(v**2 / 2 + np.maximum(0, x) ** 1.5, 0.5, rtol=0, atol=500 * tolerance)
