"""The Taylor solver: coefficients against 50 digits, order, and accuracy at the limit of doubles."""

import re
import struct

import numpy as np
import pytest
import sympy as sp
from fmpy.fmi2 import FMU2Slave

import fmu
from closed_forms import kepler, pendulum_angle, pericentre_velocity
from fmu import build_systems
from mechanics import System, time
from references import exact_series
from systems_in_sympy import DEFINITIONS, system
from test_motion import largest_error

LENGTH = 24  # coefficients of a series in the saved state
ORDER = 12

SYSTEMS = [name for name in DEFINITIONS if fmu.description(name) and name in fmu.all_names()
           and not name.endswith("Linear")
           and name not in ("ParticleCartesian", "DampedPendulum", "ElasticPendulum", "Motor", "MotorPendulum", "SeatSuspension", "FlyballGovernor", "Gyrocompass")]


def series_of(instance):
    """Series of the instance from its serialized state: (origin, interval of validity, order, coefficients[state][order])."""
    state = instance.fmu.getFMUstate()
    data = instance.fmu.serializeFMUstate(state)
    instance.free_state(state)
    count = instance.description.numberOfContinuousStates
    block = count * LENGTH * 8
    x = np.frombuffer(data[-block:]).reshape(count, LENGTH)
    origin, reach, order = struct.unpack_from("=ddq", data, len(data) - block - count * 8 - 24)
    return origin, reach, order, x


def compare(name, values, instance, bound=1e-12):
    exact = exact_series(system(name), values, ORDER)
    _, _, highest, ours = series_of(instance)
    assert highest >= ORDER
    ours = ours[: len(exact), : ORDER + 1]
    # Errors are relative to the largest coefficient of each order, since c_k grows like radius^-k.
    size = np.max(np.abs(exact), axis=0)
    assert np.all(np.abs(ours - exact) <= bound * (size + np.abs(exact)))


@pytest.mark.parametrize("name", SYSTEMS)
def test_coefficients(name, open_fmu):
    definition = system(name)
    random = np.random.default_rng(12)
    instance = open_fmu(name)
    for _ in range(2):
        values = {symbol: random.uniform(0.4, 1.3) for symbol in definition.arguments}
        instance.reset()
        start = values[definition.arguments[0]]
        instance.initialize({s.name: v for s, v in values.items() if s.name != "time"}, 1e-12, start_time=start)
        instance.step(1e-9)
        compare(name, values, instance)


OPERATIONS = [
    "q*w + q/(2 + w)", "q^2 + q^3 + q^4 + q^5 + q^7", "q^-1 + q^-2 + q^-3", "q^0.5 + q^-0.5 + q^1.5 + q^-2.7",
    "q^p + 2^q + q^w", "sqrt(q*w)", "sin(q)", "cos(q)", "sin(q*w) + cos(q*w)", "tan(q/2)", "exp(q) + exp(q*w)",
    "log(q + w)", "asin(q/3)", "acos(q/3)", "atan(q*w)", "atan2(q, w)", "sinh(q)", "cosh(q*w)", "tanh(q)", "asinh(q)",
    "2^-q + q^-w", "p^(2*q) + (1 + q^2)^-q", "1^q*q + (u^0)^w", "acosh(1 + q*w)", "atanh(q/4)", "time*q + sin(time) + exp(-time^2)", "u*q",
]  # fmt: skip


def test_every_operation(tmp_path):
    """Each operation of the expression language is the force on a mass of its own."""
    names = [(f"q{i}", f"w{i}") for i in range(len(OPERATIONS))]
    own = lambda text, i: re.sub(r"\b([qw])\b", rf"\g<1>{i}", text)
    parts = [
        f'<coordinate name="q{i}" velocity="w{i}" start="0.7" velocityStart="0.9"/><particle mass="1" x="q{i}"/>'
        f'<force coordinate="q{i}">{own(expression, i)}</force>'
        for i, expression in enumerate(OPERATIONS)
    ]
    text = (
        '<system name="Operations"><parameter name="p" start="1.7"/><input name="u" start="0.6"/>'
        + "".join(parts) + '<solver method="taylor" tolerance="1e-12"/></system>'
    )
    build_systems("operations", {"Operations": text})
    description, unzipped = fmu.description("Operations"), str(fmu.unpacked("Operations"))
    slave = FMU2Slave(guid=description.guid, unzipDirectory=unzipped, modelIdentifier="Operations", instanceName="i")
    slave.instantiate()
    slave.setupExperiment(startTime=0.3)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.3, 1e-9)
    state = slave.getFMUstate()
    data = slave.serializeFMUstate(state)
    slave.freeFMUstate(state)
    slave.terminate()
    slave.freeInstance()
    rows = np.frombuffer(data[-2 * len(names) * LENGTH * 8 :]).reshape(2, len(names), LENGTH)[:, :, : ORDER + 1]
    q, w, u, p = sp.symbols("q w u p")
    for i, expression in enumerate(OPERATIONS):
        force = sp.sympify(expression.replace("^", "**"), locals=dict(q=q, w=w, u=u, p=p, time=time))
        definition = System([q], [w], w**2 / 2, sp.Integer(0), [force], [u], [p])
        exact = exact_series(definition, {time: 0.3, q: 0.7, w: 0.9, u: 0.6, p: 1.7}, ORDER)
        size = np.max(np.abs(exact), axis=0)
        assert np.all(np.abs(rows[:, i] - exact) <= 1e-12 * (size + np.abs(exact))), expression


def test_truncation_has_the_order_of_the_series(open_fmu):
    """The error of the series cut off after term m is of order m + 1."""
    instance = open_fmu("SimplePendulum").initialize(dict(theta=2.0, l=1.0, g=1.0), 1e-14)
    instance.step(1e-9)
    _, _, _, x = series_of(instance)
    for m in (5, 9, 13):
        error = lambda h: abs(sum(x[0][j] * h**j for j in range(m + 1)) - pendulum_angle(2.0, 1, h))
        order = np.log2(error(0.8) / error(0.4))
        # Odd coefficients vanish at the turning point, so that the first omitted term is of even order.
        assert order == pytest.approx(m + 1, abs=0.8)


def test_order_and_steps_follow_the_tolerance(open_fmu):
    instance = open_fmu("DoublePendulum")
    orders, steps = [], []
    for tolerance in (1e-3, 1e-6, 1e-10, 1e-15):
        instance.reset().initialize(tolerance=tolerance)
        instance.run(5, 0.5)
        orders.append(series_of(instance)[2])
        steps.append(instance.fmu.getInteger(instance.vr("solverSteps"))[0])
    assert orders == sorted(set(orders)) and orders[-1] <= LENGTH - 2
    assert max(steps) < 3 * min(steps), "the order grows instead of the number of steps"


def test_dense_output_spares_series(open_fmu):
    """Without changes, short communication steps read the existing series."""
    instance = open_fmu("SimplePendulum").initialize(tolerance=1e-12)
    instance.run(10, 10)
    once = instance.fmu.getInteger(instance.vr("solverSteps"))[0]
    instance.reset().initialize(tolerance=1e-12)
    instance.run(10, 0.001)
    often = instance.fmu.getInteger(instance.vr("solverSteps"))[0]
    assert once == often


@pytest.mark.parametrize("e", [0.0, 0.9])
def test_kepler_at_the_limit_of_doubles(open_fmu, e):
    values = dict(m=1, mu=1, r=1 - e, vr=0, theta=0, omega=pericentre_velocity(1, 1, e))
    rows = open_fmu("ParticlePolar").initialize(values, 1e-14).run(10, 0.5, "particle.x", "particle.y")
    # Near the centre the motion amplifies rounding errors.
    assert largest_error(rows, lambda t: kepler(1, values["r"], values["omega"], t)) < (2e-14 if e == 0 else 2e-12)


@pytest.mark.parametrize("theta0", [0.3, 2.0, 3.0])
def test_pendulum_at_the_limit_of_doubles(open_fmu, theta0):
    rows = open_fmu("SimplePendulum").initialize(dict(g=1, l=1, theta=theta0), 1e-14).run(20, 0.5, "theta")
    exact = lambda t: [pendulum_angle(theta0, 1, t)]
    assert largest_error(rows, exact) < 2e-14 / np.cos(theta0 / 2) ** 2


def test_fmus_with_series_link_nothing():
    for name in SYSTEMS:
        assert b"SUNDIALS" not in fmu.library(name).read_bytes()
