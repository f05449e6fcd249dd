"""Directional derivatives, and derivatives of inputs and of outputs."""

import numpy as np
import pytest
import sympy as sp
from fmpy.fmi2 import FMU2Model

import fmu
from fmu import ERROR
from systems_in_sympy import DEFINITIONS, system

# The system Functions has kinks: min, max, abs and sign.
SMOOTH = [name for name in DEFINITIONS if name != "Functions"]


def set_up(name, instance, random):
    """Initialize the instance at random values; return these."""
    definition = system(name)
    values = {symbol: random.uniform(0.3, 1.2) for symbol in definition.arguments}
    instance.reset()
    instance.initialize(
        {symbol.name: value for symbol, value in values.items() if symbol.name != "time"},
        start_time=values[definition.arguments[0]],
    )
    return values


def derivative_of_accelerations(evaluate, values, direction, fixed):
    """Derivative of M a - f at fixed accelerations by a complex step, which has no truncation or cancellation error."""
    step = 1e-30
    mass, terms = evaluate(*(value + 1j * step * direction.get(symbol, 0) for symbol, value in values.items()))
    residual = np.array(mass) @ fixed - np.array([sum(row) for row in terms])
    return -np.linalg.solve(np.array(mass).real, residual.imag / step)


@pytest.mark.parametrize("kind", ["co-simulation", "model exchange"])
@pytest.mark.parametrize("name", SMOOTH)
def test_directional_derivatives_of_accelerations(name, kind, open_fmu):
    """Derivatives along random directions in states, inputs and parameters agree with those of SymPy's M a = f."""
    definition = system(name)
    instance = open_fmu(name, **({} if kind == "co-simulation" else {"kind": FMU2Model}))
    random, evaluate = np.random.default_rng(2), definition.evaluator("numpy")
    knowns = [*definition.q, *definition.v, *definition.inputs, *definition.parameters]
    accelerations = instance.vr(*[f"der({v.name})" for v in definition.v])
    for _ in range(10):
        values = set_up(name, instance, random)
        fixed = instance.fmu.getReal(accelerations)
        direction = random.uniform(-1, 1, len(knowns))
        expected = derivative_of_accelerations(evaluate, values, dict(zip(knowns, direction)), fixed)
        ours = instance.fmu.getDirectionalDerivative(accelerations, instance.vr(*[s.name for s in knowns]), list(direction))
        np.testing.assert_allclose(ours, expected, rtol=1e-10, atol=1e-10 * np.max(np.abs(expected) + 1))


@pytest.mark.parametrize("name", [*fmu.all_names(), "Functions", "Actuator", "Network"])
def test_directional_derivatives_by_differences(name, open_fmu):
    """Derivatives of every unknown by every known agree with difference quotients, which finds wrong pairs and missing terms."""
    is_constrained = fmu.is_constrained(name)
    instance = open_fmu(name, kind=FMU2Model) if is_constrained else open_fmu(name)
    every = {v.name: v for v in instance.description.modelVariables}
    unknowns = [n for n, v in every.items() if v.causality == "output" or (n.startswith("der(") and v.causality != "input")]
    knowns = [n for n, v in every.items() if v.causality in ("input", "parameter")] + fmu.states_of(name)
    random = np.random.default_rng(8)
    start = {n: random.uniform(0.3, 0.8) for n in knowns}
    if name == "StateFeedback":
        start["umax"] = 1e3
    if name == "HangingCable":
        start["L"] = 20.0  # elements of 1 m, so that stretches and accelerations are of the size of 1
    if name == "GantryCrane":
        start |= dict(lMin=0.1, lMax=10.0, track=5.0)  # between its stops

    def values_at(point):
        if is_constrained:  # put() leaves the state off the constraints
            instance.put(point)
        else:
            instance.reset().initialize(point)
        return np.array(instance.fmu.getReal(instance.vr(*unknowns)))

    for known in knowns[:: 1 + len(knowns) // 20]:
        h = 1e-4
        plus, minus = (values_at({**start, known: start[known] + sign * h}) for sign in (1, -1))
        values_at(start)
        exact = instance.fmu.getDirectionalDerivative(instance.vr(*unknowns), instance.vr(known), [1.0])
        quotient = (plus - minus) / (2 * h)
        np.testing.assert_allclose(exact, quotient, rtol=1e-4, atol=1e-5 * (1 + np.max(np.abs(quotient))))


def test_long_lists(open_fmu):
    """4000 unknowns along 4000 knowns, each of which stands 200 times: the seeds of one known add up."""
    chain = open_fmu("ChainPendulum", kind=FMU2Model).initialize()
    states = fmu.states_of("ChainPendulum")
    unknowns, knowns = chain.vr(*[f"der({name})" for name in states]), chain.vr(*states)
    seeds = np.random.default_rng(1).uniform(-1, 1, 200 * len(knowns))
    single = [chain.fmu.getDirectionalDerivative(unknowns, [known], [1.0]) for known in knowns]
    expected = np.array(single).T @ seeds.reshape(200, -1).sum(axis=0)
    found = chain.fmu.getDirectionalDerivative(unknowns * 200, knowns * 200, list(seeds))
    np.testing.assert_allclose(np.reshape(found, (200, -1)), np.tile(expected, (200, 1)), rtol=1e-10, atol=1e-10)


def test_errors_of_directional_derivatives(open_fmu):
    instance = open_fmu("DampedPendulum").initialize()
    for unknown, known, seed, message in (
        ("theta", "der(omega)", 1.0, "'der\\(omega\\)' is not a known"),
        ("m", "theta", 1.0, "'m' is not an unknown"),
        ("der(omega)", "theta", float("nan"), "finite"),
    ):
        with instance.fails(ERROR, message):
            instance.fmu.getDirectionalDerivative(instance.vr(unknown), instance.vr(known), [seed])
        instance.reset().initialize()


# Systems that integrate an input twice: the inertia, and the settings that remove other forces.
INTEGRATORS = [
    ("ParticleCartesian", "Fx", "x", dict(m=0.5, kx=0, x=0), 0.5, 1e-13),
    ("DampedPendulum", "tau", "theta", dict(m=0.5, l=2, g=0, b=0, theta=0), 2.0, 1e-9),
    ("InvertedPendulumCart", "F", "x", dict(M=1.5, m=0.5, g=0, theta=0, l=1), None, 1e-9),
    ("FurutaPendulum", "tau", "alpha", dict(Ja=2, m=1e-6, J=1e-9, a=1e-6, l=1e-6, b=0, g=0, theta=0), 2.0, 1e-5),
]


@pytest.mark.parametrize("name, force, position, values, inertia, accuracy", INTEGRATORS)
@pytest.mark.parametrize("order", [1, 2, 3])
def test_inputs_are_polynomials(name, force, position, values, inertia, accuracy, order, open_fmu):
    """u(t) = t^order / order! in three steps: its derivatives at the start of each step give the exact position."""
    instance = open_fmu(name).initialize(values, tolerance=1e-10)
    factorial = lambda n: float(sp.factorial(n))
    for start, size in ((0.0, 0.3), (0.3, 0.5), (0.8, 0.2)):
        instance.set({force: start**order / factorial(order)})
        derivatives = [start ** (order - k) / factorial(order - k) for k in range(1, order + 1)]
        instance.fmu.setRealInputDerivatives(
            instance.vr(*[force] * order), list(range(1, order + 1)), derivatives
        )
        instance.step(size)
    if inertia is None:
        # The rod swings; the force accelerates the centre of mass.
        theta, x = instance.get("theta", "x")
        M, m, l = values["M"], values["m"], values["l"]
        centre = (M * x + m * (x + l * np.sin(theta))) / (M + m)
        assert centre == pytest.approx(1 / factorial(order + 2) / (M + m), abs=accuracy)
    else:
        assert instance.get(position) == pytest.approx(1 / factorial(order + 2) / inertia, abs=accuracy)
    # The input itself is at the end of its polynomial.
    assert instance.get(force) == pytest.approx(1 / factorial(order), abs=1e-13)


def test_input_derivatives_apply_to_one_step(open_fmu):
    instance = open_fmu("ParticleCartesian").initialize(dict(m=1, kx=0, x=0))
    instance.fmu.setRealInputDerivatives(instance.vr("Fx"), [1], [1.0])
    instance.step(1.0)
    assert instance.get("Fx", "vx") == pytest.approx([1.0, 0.5])
    instance.step(1.0)
    assert instance.get("Fx", "vx") == pytest.approx([1.0, 1.5])


@pytest.mark.parametrize("order", [0, -1])
def test_input_derivative_orders(order, open_fmu):
    """Order 0 and other orders out of range are errors."""
    instance = open_fmu("ParticleCartesian").initialize()
    with instance.fails(ERROR, f"order {order} for 'Fx' is out of range"):
        instance.fmu.setRealInputDerivatives(instance.vr("Fx"), [order], [1.0])
    instance.reset().initialize()
    with instance.fails(ERROR, "is not an input"):
        instance.fmu.setRealInputDerivatives(instance.vr("x"), [1], [1.0])


@pytest.mark.parametrize("name", fmu.moving_names())
def test_output_derivatives(name, open_fmu):
    """At the end of a step, output derivatives of coordinates and velocities equal the values of der(...)."""
    instance = open_fmu(name).initialize()
    instance.step(0.01 if name == "Motor" else 0.1)  # later its voltages nearly cancel
    states = [state for state in fmu.states_of(name) if state in fmu.names_of(name, "output")]
    derivatives = instance.fmu.getRealOutputDerivatives(instance.vr(*states), [1] * len(states))
    expected = instance.fmu.getReal(instance.vr(*[f"der({state})" for state in states]))
    np.testing.assert_allclose(derivatives, expected, rtol=1e-13, atol=1e-15)


def test_output_derivative_of_an_expression(open_fmu):
    instance = open_fmu("InvertedPendulumCart").initialize(dict(theta=0.7, omega=1.1, v=0.3, l=0.8))
    instance.step(0.1)
    v, theta, omega = instance.get("v", "theta", "omega")
    derivative = instance.fmu.getRealOutputDerivatives(instance.vr("xBob"), [1])[0]
    assert derivative == pytest.approx(v + 0.8 * omega * np.cos(theta), rel=1e-13)


def test_output_derivatives_follow_the_inputs(open_fmu):
    """The force of a spring between two moving ends changes as the ends move."""
    instance = open_fmu("SpringDamper").initialize(dict(k=7, c=3, l0=0))
    instance.fmu.setRealInputDerivatives(instance.vr("x1", "x2", "v2"), [1, 1, 1], [0.2, 0.5, -1.0])
    instance.step(0.1)
    assert instance.get("F1") == pytest.approx(7 * 0.1 * 0.3 - 3 * 0.1)
    derivative = instance.fmu.getRealOutputDerivatives(instance.vr("F1", "F2"), [1, 1])
    assert derivative == pytest.approx([7 * 0.3 - 3, -(7 * 0.3 - 3)])


@pytest.mark.parametrize("order", [0, -1])
def test_output_derivative_orders(order, open_fmu):
    instance = open_fmu("SimplePendulum").initialize()
    with instance.fails(ERROR, f"order {order} for 'theta' is out of range"):
        instance.fmu.getRealOutputDerivatives(instance.vr("theta"), [order])


def test_features_are_declared_if_they_apply(name):
    section = fmu.description(name).coSimulation
    assert section.providesDirectionalDerivative and section.canSerializeFMUstate and section.canGetAndSetFMUstate
    assert section.canInterpolateInputs == bool(fmu.names_of(name, "input"))
    assert section.maxOutputDerivativeOrder >= 1
