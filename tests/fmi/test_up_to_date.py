"""
Values that depend on parameters, inputs, time and state are recomputed after a change, by every solver: against closed forms of an
oscillator, m x'' = -k x + u + c time. Each error comes from its own check.
"""

import math
import struct
from ctypes import c_double

import pytest
from fmpy.fmi2 import FMU2Model

import fmu
from fmu import DISCARD, ERROR
from test_state import serialized

pytestmark = pytest.mark.release

OSCILLATOR = """<system name="{name}">
  <parameter name="m" start="2" min="0" max="10"/><parameter name="k" start="3"/>{drift}<input name="u"/>
  <coordinate name="x" velocity="v" start="1"/>
  <particle name="p" mass="m" x="x"/>
  <potential>k*x^2/2</potential><force coordinate="x">{force}</force>
  <output name="y">{output}</output><output name="z">x*sqrt(k/m)</output>
  <solver method="{method}"/>
</system>"""
PRESCRIBED = dict(drift='<parameter name="c" start="0.7"/>', force="u + c*time", output="x*time + 2*u + der(v)")
LINEAR = dict(drift="", force="u", output="x + 2*u + der(v)")
FALL = """<system name="FallByErk">
  <coordinate name="x" velocity="v" start="1"/>
  <particle name="p" mass="1" x="x"/>
  <force coordinate="x">-1/x^2</force>
  <solver method="erk" tolerance="1e-9"/>
</system>"""
TEXTS = {
    f"OscillatorBy{method.title()}": OSCILLATOR.format(name=f"OscillatorBy{method.title()}", method=method, **words)
    for method, words in dict(taylor=PRESCRIBED, erk=PRESCRIBED, bdf=PRESCRIBED, exact=LINEAR).items()
} | {"FallByErk": FALL}
NAMES = [name for name in TEXTS if name != "FallByErk"]


@pytest.fixture(scope="module", autouse=True)
def systems():
    fmu.build_systems("up-to-date", TEXTS)


def drift_of(name):
    return 0.0 if name == "OscillatorByExact" else 0.7


def motion(x, v, t, duration, m, k, u, c):
    """x and v after the duration: the particular solution (u + c t)/k and a free oscillation."""
    w = math.sqrt(k / m)
    x, v = x - (u + c * t) / k, v - c / k
    cosine, sine = math.cos(w * duration), math.sin(w * duration)
    return x * cosine + v / w * sine + (u + c * (t + duration)) / k, v * cosine - x * w * sine + c / k


@pytest.mark.parametrize("name", NAMES)
def test_parameters_between_steps(name, open_fmu):
    """No matrix, series or history of the old parameters is used."""
    instance = open_fmu(name).initialize(tolerance=1e-10)
    x, v, c = 1.0, 0.0, drift_of(name)
    for i, (m, k, u) in enumerate([(2, 3, 0), (2, 5, 0), (1, 5, 0), (1, 5, 0.4), (2, 3, 0.4)]):
        instance.set(m=m, k=k, u=u)
        instance.fmu.doStep(0.25 * i, 0.25)
        x, v = motion(x, v, 0.25 * i, 0.25, m, k, u, c)
        assert instance.get("x", "v") == pytest.approx([x, v], abs=1e-7)


@pytest.mark.parametrize("name", NAMES)
def test_a_restored_state_brings_its_parameters(name, open_fmu):
    instance = open_fmu(name).initialize(dict(m=2.0, k=3.0))
    assert instance.get("der(v)") == pytest.approx(-1.5)
    state = instance.fmu.getFMUstate()
    instance.set(m=4.0, k=9.0)
    assert instance.get("der(v)") == pytest.approx(-2.25)
    instance.fmu.setFMUstate(state)
    assert instance.get("der(v)") == pytest.approx(-1.5)
    instance.fmu.doStep(0.0, 0.25)
    expected = motion(1.0, 0.0, 0.0, 0.25, 2.0, 3.0, 0.0, drift_of(name))
    assert instance.get("x", "v") == pytest.approx(expected, abs=1e-6)
    instance.free_state(state)


@pytest.mark.parametrize("name", NAMES)
def test_parameters_before_each_call_that_needs_them(name, open_fmu):
    """Each call is the first one after a change of the parameter."""
    instance = open_fmu(name).initialize()
    instance.set(m=4.0)
    assert instance.fmu.getDirectionalDerivative(instance.vr("der(v)"), instance.vr("x"), [1.0]) == pytest.approx([-0.75])
    instance.set(m=5.0)
    assert instance.fmu.getRealOutputDerivatives(instance.vr("v"), [1]) == pytest.approx([-0.6])
    instance.set(m=6.0)
    assert instance.get("der(v)") == pytest.approx(-0.5)
    instance.set(m=1.0)
    assert instance.get("y") - (0 if drift_of(name) else 1) == pytest.approx(-3.0)
    instance.set(m=0.75)
    assert instance.get("z") == pytest.approx(2.0)
    exchange = open_fmu(name, kind=FMU2Model).initialize()
    exchange.set(m=8.0)
    derivatives = (c_double * 2)()
    exchange.fmu.getDerivatives(derivatives, 2)
    assert list(derivatives) == pytest.approx([0.0, -0.375])


def derivatives_of_output(name, x, v, t, u, orders):
    """y^(n), from x^(n + 2) = (-k x^(n) + u^(n) + c t^(n))/m; u holds the input and its derivatives."""
    m, k, c = 2.0, 3.0, drift_of(name)
    of_time = [t, 1.0] + [0.0] * 10
    of_x = [x, v]
    for n in range(max(orders) + 1):
        of_x.append((-k * of_x[n] + u[n] + c * of_time[n]) / m)
    product = lambda n: of_x[n] if not c else t * of_x[n] + n * of_x[n - 1]
    return [product(n) + 2 * u[n] + of_x[n + 2] for n in orders]


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_of_an_output_in_time(name, open_fmu):
    """
    Derivatives of an output that depends on time, an input and an acceleration; each order is requested alone, so that each is once the
    highest.
    """
    instance = open_fmu(name).initialize(tolerance=1e-10, start_time=0.5)
    slope, curvature, third, h = 0.3, -0.2, 0.9, 0.25
    instance.fmu.setRealInputDerivatives(instance.vr("u") * 3, [1, 2, 3], [slope, curvature, third])
    instance.fmu.doStep(0.5, h)
    x, v, u = instance.get("x", "v", "u")
    inputs = [h * slope + h**2 / 2 * curvature + h**3 / 6 * third, slope + h * curvature + h**2 / 2 * third, curvature + h * third, third]
    inputs += [0.0] * 6
    assert u == pytest.approx(inputs[0])
    orders = range(1, min(6, instance.description.coSimulation.maxOutputDerivativeOrder) + 1)
    for order in orders:
        expected = derivatives_of_output(name, x, v, 0.75, inputs, [order])
        assert instance.fmu.getRealOutputDerivatives(instance.vr("y"), [order]) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_of_inputs_after_steps_without(name, open_fmu):
    """No series for the earlier constant input is used: x'' = u with u = s t gives s t^3/6."""
    instance = open_fmu(name).initialize(dict(k=0.0, x=0.0, m=1.0) | ({"c": 0.0} if drift_of(name) else {}), 1e-10)
    instance.fmu.doStep(0.0, 0.5)
    instance.fmu.setRealInputDerivatives(instance.vr("u"), [1], [6.0])
    instance.fmu.doStep(0.5, 0.5)
    assert instance.get("x", "v", "u") == pytest.approx([0.5**3, 3 * 0.5**2, 3.0], abs=1e-8)


# --- Checks, one by one ---


def test_a_value_above_its_maximum(open_fmu):
    instance = open_fmu("OscillatorByTaylor").initialize()
    instance.set(m=10.0)
    with instance.fails(DISCARD, "10.5 for 'm' is above its maximum, 10"):
        instance.set(m=10.5)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_numbers_that_are_not_finite(value, open_fmu):
    instance = open_fmu("OscillatorByTaylor").initialize()
    with instance.fails(ERROR, "the value for 'u'.*finite"):
        instance.fmu.setRealInputDerivatives(instance.vr("u"), [1], [value])
    instance.reset().initialize()
    with instance.fails(ERROR, "the seed of 'x'.*finite"):
        instance.fmu.getDirectionalDerivative(instance.vr("der(v)"), instance.vr("x"), [value])
    exchange = open_fmu("OscillatorByTaylor", kind=FMU2Model).initialize()
    exchange.fmu.enterContinuousTimeMode()
    with exchange.fails(DISCARD, "state 2 is.*finite"):
        exchange.fmu.setContinuousStates((c_double * 2)(1.0, value), 2)
    with exchange.fails(ERROR, "the time is.*finite"):
        exchange.fmu.setTime(value)


def test_results_that_are_not_finite(open_fmu):
    """At finite states of 1e300 the energy, the acceleration, or a derivative overflows, which is an error."""
    exchange = open_fmu("OscillatorByTaylor", kind=FMU2Model).initialize(dict(k=3.0))
    exchange.fmu.enterContinuousTimeMode()
    exchange.fmu.setContinuousStates((c_double * 2)(1e200, 1e200), 2)
    with exchange.fails(DISCARD, "'kineticEnergy' has no finite value"):
        exchange.get("kineticEnergy")
    exchange.fmu.enterEventMode()
    exchange.set(k=1e300)
    with exchange.fails(DISCARD, "the accelerations are not finite"):
        exchange.get("der(v)")
    exchange.fmu.enterContinuousTimeMode()
    exchange.fmu.setTime(1.0)
    with exchange.fails(DISCARD, "the accelerations are not finite"):
        exchange.fmu.getDerivatives((c_double * 2)(), 2)
    exchange.fmu.setTime(2.0)
    state = exchange.fmu.getFMUstate()
    with exchange.fails(ERROR, "the accelerations are not finite"):
        exchange.fmu.getDirectionalDerivative(exchange.vr("der(v)"), exchange.vr("x"), [1.0])
    exchange.fmu.setFMUstate(state)
    exchange.free_state(state)
    exchange.fmu.enterEventMode()
    exchange.set(k=3.0)
    with exchange.fails(ERROR, r"the derivative of 'der\(v\)' is not finite"):
        exchange.fmu.getDirectionalDerivative(exchange.vr("der(v)"), exchange.vr("k"), [1e200])


@pytest.mark.parametrize("name, message", [("OscillatorByTaylor", "derivative 4 of 'y' is"), ("OscillatorByErk", "accelerations are|derivative of 'y' is")])
def test_derivatives_of_outputs_that_are_not_finite(name, message, open_fmu):
    instance = open_fmu(name).initialize(dict(k=3.0))
    instance.set(k=1e150 if name == "OscillatorByTaylor" else 1e308, m=1.0 if name == "OscillatorByTaylor" else 1e-10)
    order = 4 if name == "OscillatorByTaylor" else 1
    with instance.fails(ERROR, message):
        instance.fmu.getRealOutputDerivatives(instance.vr("y"), [order])


@pytest.mark.parametrize("name", ["OscillatorByTaylor", "OscillatorByExact", "ElasticPendulum", "StateFeedback"])
def test_a_step_too_short_for_the_time(name, open_fmu):
    instance = open_fmu(name).initialize(start_time=1e6)
    with instance.fails(ERROR, "step 1e-11 does not advance the time 1e\\+06"):
        instance.fmu.doStep(1e6, 1e-11)


@pytest.mark.parametrize("name", NAMES)
def test_steps_with_singular_parameters(name, open_fmu):
    instance = open_fmu(name).initialize()
    instance.step(0.1)
    instance.set(m=0.0)
    with instance.fails(ERROR, "the accelerations cannot be computed with these parameters at time 0.1"):
        instance.step(0.1)


def test_variables_of_the_other_type(open_fmu):
    instance = open_fmu("OscillatorByTaylor").initialize()
    with instance.fails(ERROR, "'x' is a Real variable"):
        instance.fmu.getInteger(instance.vr("x"))
    instance.reset().initialize()
    with instance.fails(ERROR, "'solverSteps' is an Integer variable"):
        instance.fmu.getReal(instance.vr("solverSteps"))


def test_states_of_another_version(open_fmu):
    instance = open_fmu("OscillatorByTaylor").initialize()
    data = bytearray(serialized(instance))
    struct.pack_into("=I", data, 8, struct.unpack_from("=I", data, 8)[0] - 1)
    with instance.fails(ERROR, "they come from another version"):
        instance.fmu.deSerializeFMUstate(bytes(data))


def test_a_discarded_step_reports_where_the_state_is(open_fmu):
    """A fall from 1 into the centre takes pi/sqrt(8); the state of the discarded step belongs to the reported time."""
    instance = open_fmu("FallByErk").initialize()
    with instance.fails(DISCARD, "stopped at time"):
        instance.fmu.doStep(0.0, 2.0)
    x, reached = instance.get("x"), instance.fmu.getRealStatus(2)
    fall = math.sqrt(0.5) * (math.acos(math.sqrt(x)) + math.sqrt(x * (1 - x)))
    assert 0 < x < 0.1 and reached == pytest.approx(fall, abs=1e-6)
