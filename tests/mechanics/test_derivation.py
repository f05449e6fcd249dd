"""Derived accelerations, energies and positions against SymPy's, at random states and parameters."""

import numpy as np
import pytest
import sympy as sp

import fmu
from systems_in_sympy import DEFINITIONS, system
from mechanics import time

CASES = 60
TOLERANCE = 1e-11


def sample(name, definition, random):
    """Random time, coordinates, velocities, inputs and parameters, away from singular points."""
    values = {time: random.uniform(0, 3)}
    for symbol in [*definition.q, *definition.v, *definition.inputs]:
        values[symbol] = random.uniform(-3, 3)
    limits = {v.name: (float(v.min or 0.2), float(v.max or 3)) for v in fmu.description(name).modelVariables}
    for symbol in definition.parameters:
        low, high = limits[symbol.name]
        values[symbol] = random.uniform(max(low, 0.2), min(high, 3))
    for symbol in definition.q:
        if symbol.name in ("r", "rho"):
            values[symbol] = random.uniform(0.3, 3)
        if symbol.name == "phi" and name == "ParticleSpherical" or symbol.name == "theta" and name in ("SphericalPendulum", "HeavyTop"):
            values[symbol] = random.uniform(0.3, 2.8)
    return values


def random_states(name, open_fmu):
    """Yield the instance in initialization mode at random values, and these values, CASES times."""
    definition = system(name)
    instance = open_fmu(name)
    random = np.random.default_rng(sum(map(ord, name)))
    for _ in range(CASES):
        values = sample(name, definition, random)
        instance.reset()
        instance.fmu.setupExperiment(startTime=values[time])
        instance.set({symbol.name: value for symbol, value in values.items() if symbol is not time
                      and symbol not in definition.inputs})
        instance.fmu.enterInitializationMode()
        instance.set({symbol.name: values[symbol] for symbol in definition.inputs})
        yield instance, [values[symbol] for symbol in definition.arguments]


@pytest.mark.parametrize("name", DEFINITIONS)
def test_accelerations(name, open_fmu):
    definition = system(name)
    for instance, values in random_states(name, open_fmu):
        exact, scale = definition.accelerations(values)
        ours = np.array(instance.fmu.getReal(instance.vr(*[f"der({v.name})" for v in definition.v])))
        assert np.all(np.abs(ours - exact) <= TOLERANCE * scale)
        velocities = instance.fmu.getReal(instance.vr(*[f"der({q.name})" for q in definition.q]))
        assert velocities == [values[1 + len(definition.q) + i] for i in range(len(definition.q))]


def test_every_system_is_compared():
    variants = {"LongChain", "BouncingSpring"}  # ChainPendulum with more rods, ElasticPendulum with another solver
    variants.add("Rope")  # too large for SymPy; see test_rope.py
    variants |= {"Actuator", "Network"}  # with states of first order; see test_states.py
    variants.add("HangingCable")  # see test_hanging_cable.py
    variants |= {"PidController", "BristleFriction", "HydraulicCylinder", "GantryCrane", "SpinningBeam", "DigitalServo", "HalfCar"}  # see test_systems_with_states.py, test_spinning_beam.py
    variants.add("RobotArm")  # against Newton and Euler; see test_bodies_in_space.py
    variants |= {name for name in fmu.moving_names() if fmu.is_constrained(name)}  # see test_constraints.py
    assert set(DEFINITIONS) | variants == set(fmu.moving_names()) | set(fmu.further_names())


def terms_up_to(order, expression, variables):
    """Taylor polynomial about the origin of the variables."""
    e = sp.Symbol("e")
    moved = sp.sympify(expression).subs({variable: e * variable for variable in variables}, simultaneous=True)
    return sum(sp.diff(moved, e, k).subs(e, 0) / sp.factorial(k) for k in range(order + 1))


def energies_and_positions(name, definition):
    """Expressions by variable name. Linear systems have energies of second order and positions of first order."""
    T = definition.T
    if name == "RelativisticParticle":  # its Lagrangian's kinetic term is not its kinetic energy
        T = sum(v * sp.diff(T, v) for v in definition.v) - T
    energies = {"kineticEnergy": T, "potentialEnergy": definition.U}
    positions = {
        f"{particle}.{axis}": value
        for particle, position in definition.positions.items()
        for axis, value in zip("xyz", position)
        if value != 0 or name != "SeatSuspension"
    }
    if name.endswith("Linear"):
        variables = [*definition.q, *definition.v]
        energies = {key: terms_up_to(2, value, variables) for key, value in energies.items()}
        positions = {key: terms_up_to(1, value, variables) for key, value in positions.items()}
    return energies | positions


@pytest.mark.parametrize("name", DEFINITIONS)
def test_energies_and_positions(name, open_fmu):
    definition = system(name)
    expected = energies_and_positions(name, definition)
    evaluate = sp.lambdify(definition.arguments, list(expected.values()), modules="numpy", cse=True)
    for instance, values in random_states(name, open_fmu):
        instance.fmu.exitInitializationMode()
        ours = instance.get("totalEnergy", *expected)
        np.testing.assert_allclose(ours[1:], evaluate(*values), rtol=1e-11, atol=1e-11)
        assert ours[0] == pytest.approx(ours[1] + ours[2], rel=1e-13, abs=1e-13)


CART_EQUATIONS = """
    (F + m*l*omega**2*sin(theta) - m*g*sin(theta)*cos(theta))/(M + m*sin(theta)**2)
    ((M + m)*g*sin(theta) - F*cos(theta) - m*l*omega**2*sin(theta)*cos(theta))/(l*(M + m*sin(theta)**2))
"""
PIVOT_EQUATION = "-g/l*sin(theta - gamma) - r*w**2/l*sin(theta + w*time)"


@pytest.mark.parametrize(
    "name, equations",
    [
        ("SimplePendulum", "-g/l*sin(theta)"),
        ("InvertedPendulumCart", CART_EQUATIONS),
        ("RotatingPivotPendulum", PIVOT_EQUATION),
        ("BeadOnHoop", "(W**2*cos(theta) - g/R)*sin(theta)"),
    ],
)
def test_published_equations(name, equations, open_fmu):
    """Accelerations agree with equations typed as textbooks print them, which also checks SymPy's derivation."""
    definition = system(name)
    names = {symbol.name: symbol for symbol in definition.arguments}
    formulas = [sp.sympify(line, locals=names) for line in equations.split("\n") if line.strip()]
    evaluate = sp.lambdify(definition.arguments, formulas, modules="numpy")
    for instance, values in random_states(name, open_fmu):
        ours = instance.fmu.getReal(instance.vr(*[f"der({v.name})" for v in definition.v]))
        np.testing.assert_allclose(ours, evaluate(*values), rtol=1e-11, atol=1e-10)
