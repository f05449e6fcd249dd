"""High-order derivatives of outputs, against 50-digit series and closed forms."""

import mpmath
import numpy as np
import pytest
from flint import arb_series

import fmu
from fmu import ERROR
from references import exact_series, precision
from systems_in_sympy import DEFINITIONS, system

SERIES = [name for name in DEFINITIONS if fmu.description(name).coSimulation.maxOutputDerivativeOrder > 1]
ORDERS = range(1, 9)


def derivatives_of(instance, name, orders=ORDERS):
    return np.array(instance.fmu.getRealOutputDerivatives(instance.vr(name) * len(orders), list(orders)))


def at_random_values(name, instance):
    definition = system(name)
    random = np.random.default_rng(31)
    values = {symbol: random.uniform(0.4, 1.3) for symbol in definition.arguments}
    start = values[definition.arguments[0]]
    instance.initialize({s.name: v for s, v in values.items() if s.name != "time"}, start_time=start)
    return definition, values


@pytest.mark.parametrize("name", SERIES)
def test_coordinates_and_velocities(name, open_fmu):
    instance = open_fmu(name)
    definition, values = at_random_values(name, instance)
    exact = exact_series(definition, values, max(ORDERS))
    factorials = np.array([float(mpmath.factorial(m)) for m in ORDERS])
    size = np.max(np.abs(exact), axis=0)[1:] * factorials
    for i, state in enumerate([*definition.q, *definition.v]):
        error = np.abs(derivatives_of(instance, state.name) - exact[i][1:] * factorials)
        assert np.all(error <= 1e-11 * size), state


def test_expression_of_coordinates(open_fmu):
    instance = open_fmu("InvertedPendulumCart")
    definition, values = at_random_values("InvertedPendulumCart", instance)
    length = {s.name: v for s, v in values.items()}["l"]
    exact = exact_series(definition, values, max(ORDERS))
    with precision(20, len(exact[0])):
        bob = arb_series(exact[0].tolist()) + arb_series(exact[1].tolist()).sin() * length
        expected = [float(bob[m]) * float(mpmath.factorial(m)) for m in ORDERS]
    np.testing.assert_allclose(derivatives_of(instance, "xBob"), expected, rtol=1e-11)


def test_expression_of_accelerations(open_fmu):
    """On a circle x = R (1 - cos wt), y = R sin wt: x y'' - y x'' = -R^2 w^2 sin wt."""
    instance = open_fmu("ChargedParticle").initialize(dict(m=2.0, qB=3.0, vx=0, vy=1.2))
    instance.step(0.4)
    w, sign = 1.5, np.sign(instance.get("x"))
    radius = 1.2 / w
    phase = lambda m: np.sin(0.4 * w + m * np.pi / 2)
    expected = [-sign * radius**2 * w ** (2 + m) * phase(m) for m in ORDERS]
    assert instance.get("areaRate") == pytest.approx(-sign * radius**2 * w**2 * phase(0))
    np.testing.assert_allclose(derivatives_of(instance, "areaRate"), expected, rtol=1e-11)


def test_at_the_end_of_a_step(open_fmu):
    """Derivatives are those at the present time, not at the expansion point of the solver's series."""
    instance = open_fmu("SimplePendulum").initialize(dict(g=1, l=1, theta=2.0), 1e-14)
    instance.run(1.5, 0.25)
    k = mpmath.sin(1)
    angle = lambda t: 2 * mpmath.asin(k * mpmath.ellipfun("cd", t, m=k * k))
    with mpmath.workdps(30):
        expected = [float(mpmath.diff(angle, mpmath.mpf("1.5"), m)) for m in range(1, 6)]
    np.testing.assert_allclose(derivatives_of(instance, "theta", range(1, 6)), expected, rtol=1e-11)


def test_inputs_are_followed_to_the_end_of_the_step(open_fmu):
    """m x'' = u without a spring: derivatives 2 to 5 of x are those of u."""
    instance = open_fmu("ParticleCartesian").initialize(dict(m=0.5, kx=0, x=0, Fx=1.0))
    instance.fmu.setRealInputDerivatives(instance.vr("Fx") * 3, [1, 2, 3], [2.0, -3.0, 4.0])
    h = 0.7
    instance.step(h)
    u = [1 + h * (2 + h * (-1.5 + h * 4 / 6)), 2 + h * (-3 + h * 2), -3 + 4 * h, 4.0, 0.0]
    assert derivatives_of(instance, "x", range(2, 7)) == pytest.approx(np.array(u) / 0.5, rel=1e-13)


def test_a_value_ends_the_polynomial_of_its_input(open_fmu):
    """F1 = k (x2 - x1): after x1 is set, only x2 still moves."""
    instance = open_fmu("SpringDamper").initialize(dict(k=7, c=0, l0=0))
    instance.fmu.setRealInputDerivatives(instance.vr("x1", "x2"), [1, 1], [0.2, 0.5])
    instance.step(0.1)
    instance.set(x1=3.0)
    assert derivatives_of(instance, "F1", [1, 2]) == pytest.approx([7 * 0.5, 0])


@pytest.mark.parametrize("derivatives_first", [True, False])
def test_a_value_and_its_derivatives_may_come_in_either_order(derivatives_first, open_fmu):
    instance = open_fmu("SpringDamper").initialize(dict(k=7, c=0, l0=0))
    if derivatives_first:
        instance.fmu.setRealInputDerivatives(instance.vr("x2"), [1], [0.5])
    instance.set(x2=3.0)
    if not derivatives_first:
        instance.fmu.setRealInputDerivatives(instance.vr("x2"), [1], [0.5])
    instance.step(0.1)
    assert instance.get("F1") == pytest.approx(7 * 3.05)


def test_derivatives_beyond_all_numbers(open_fmu):
    instance = open_fmu("StateFeedback").initialize(dict(theta=1e308))
    instance.fmu.setRealInputDerivatives(instance.vr("x", "theta", "v"), [1, 1, 1], [1e308, 1e308, 1e308])
    with instance.fails(ERROR, "derivative of 'F' is not finite"):
        instance.step(0.1)
        derivatives_of(instance, "F", [1])


def test_without_coordinates(open_fmu):
    instance = open_fmu("SpringDamper").initialize(dict(k=7, c=3, l0=0))
    instance.fmu.setRealInputDerivatives(instance.vr("x1", "x2", "v2"), [2, 3, 2], [0.2, 0.5, -1.0])
    instance.step(0.1)
    assert derivatives_of(instance, "F1", [2, 3, 4]) == pytest.approx([7 * (0.5 * 0.1 - 0.2) - 3, 7 * 0.5, 0])


@pytest.mark.parametrize("name", ["StateFeedback", "FurutaPendulum"])
def test_only_the_first_where_there_are_no_series(name, open_fmu):
    assert fmu.description(name).coSimulation.maxOutputDerivativeOrder == 1
    instance = open_fmu(name).initialize()
    output = fmu.names_of(name, "output")[0]
    with instance.fails(ERROR, f"order 2 for '{output}' is out of range; expected 1 to 1"):
        derivatives_of(instance, output, [2])


def test_highest_order(open_fmu):
    instance = open_fmu("SimplePendulumLinear").initialize(dict(g=1, l=1, theta=1.0))
    highest = fmu.description("SimplePendulumLinear").coSimulation.maxOutputDerivativeOrder
    assert highest == 20
    assert derivatives_of(instance, "theta", [2, highest]) == pytest.approx([-1, 1])
    with instance.fails(ERROR, "order 21 for 'theta' is out of range; expected 1 to 20"):
        derivatives_of(instance, "theta", [highest + 1])
