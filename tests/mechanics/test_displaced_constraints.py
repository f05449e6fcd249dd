"""Reaction forces beside constraints and driven coordinates, against an independent derivation with multipliers."""

import numpy as np
import pytest
import sympy as sp
from sympy import cos, sin, sqrt

import fmu
from mechanics import System, kinetic

# A bob on a rod, which is a constraint. A second rod with inertia hangs from the bob; its length, its angle and its joint have
# displacements. A mass driven along a rail pulls the bob by a spring.
HANGING = """
<system name="{name}">
  <parameter name="m" start="1.3"/><parameter name="M" start="0.8"/><parameter name="J" start="0.2"/>
  <parameter name="l" start="0.6"/><parameter name="h" start="0.9"/><parameter name="k" start="7"/>
  <parameter name="g" start="9.81"/><parameter name="b" start="0.3"/>
  <input name="F" start="0.7"/>
  <coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy" start="-0.6"/>
  <coordinate name="t" velocity="w" start="0.3"/>
  <coordinate name="d" velocity="vd" velocityStart="0.5" acceleration="cos(2*time)"/>
  <displacement name="stretch"/><displacement name="turn"/><displacement name="slip"/>
  <particle name="bob" mass="m" x="x" y="y"/>
  <body name="rod" mass="M" inertia="J" angle="t + turn"
        x="x + slip + (h + stretch)*sin(t + turn)" y="y - (h + stretch)*cos(t + turn)"/>
  <particle name="drive" mass="2" x="d"/>
  <potential>g*(m*y + M*rod.y) + k*(x - d)^2/2</potential>
  <dissipation>b*der(rod.x)^2/2</dissipation>
  <force on="rod" x="F"/>
  <constraint name="held">sqrt(x^2 + y^2) - l</constraint>
  <output name="tension">stretch.force + 0.5*held.force</output>
  <experiment stopTime="2"/>
</system>
"""
NAMES = ["Hanging", "HangingT"]


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("hanging", {"Hanging": HANGING.format(name="Hanging")})
    fmu.build_systems("hanging-tables", {"HangingT": HANGING.format(name="HangingT")}, "--form", "tables")


@pytest.fixture(scope="module")
def solve():
    """Accelerations of x, y, t, and the multipliers of the rod, the drive, the stretch, the turn and the slip."""
    q = x, y, t, d, s, u, a = sp.symbols("x y t d s u a")
    v = sp.symbols("vx vy w vd vs vu va")
    m, M, J, l, h, k, g, b, F, time = sp.symbols("m M J l h k g b F time")
    rod = (x + a + (h + s) * sin(t + u), y - (h + s) * cos(t + u))
    T = kinetic([(m, (x, y)), (M, rod), (J, (t + u,)), (2, (d,))], q, v)
    rate = sum(sp.diff(rod[0], qi) * vi for qi, vi in zip(q, v))
    Q = [sp.diff(rod[0], qi) * (F - b * rate) for qi in q]
    motion = sp.sin(2 * time) / 2  # prescribed velocity of d; its acceleration is cos(2 t)
    constraints = [sqrt(x**2 + y**2) - l, v[3] - motion, s, u, a]
    system = System(list(q), list(v), T, g * (m * y + M * rod[1]) + k * (x - d) ** 2 / 2, Q, inputs=[F],
                    parameters=[m, M, J, l, h, k, g, b], constraints=constraints)  # fmt: skip
    evaluate = system.evaluator("numpy")

    def at(time, state, F=0.7):
        values = [time, *state[:4], 0, 0, 0, *state[4:], 0, 0, 0, F, 1.3, 0.8, 0.2, 0.6, 0.9, 7, 9.81, 0.3]
        matrix, terms = evaluate(*values)
        solution = np.linalg.solve(np.array(matrix, float), [sum(row) for row in terms])
        return [*solution[:3], solution[7], -solution[8], *solution[9:]]

    return at


FORCES = ["der(vx)", "der(vy)", "der(w)", "held.force", "d.force", "stretch.force", "turn.force", "slip.force"]
STATES = ["x", "y", "t", "d", "vx", "vy", "w", "vd"]


def place(angle, rate, rest):
    return dict(zip(STATES, [0.6 * np.sin(angle), -0.6 * np.cos(angle), *rest[:2],
                             0.6 * rate * np.cos(angle), 0.6 * rate * np.sin(angle), *rest[2:]]))  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_forces_are_multipliers(name, solve, open_fmu):
    random = np.random.default_rng(2)
    for _ in range(15):
        angle, rate, start, *rest = random.uniform(-2, 2, 7)
        instance = open_fmu(name).initialize(place(angle, rate, rest), start_time=start)
        expected = solve(start, instance.get(*STATES))
        np.testing.assert_allclose(instance.get(*FORCES), expected, rtol=1e-10, atol=1e-10)
        assert instance.get("tension") == pytest.approx(expected[5] + 0.5 * expected[3], rel=1e-10)
        instance.free()


def test_forces_along_a_motion(solve, open_fmu):
    instance = open_fmu("Hanging").initialize(place(0.8, 1.0, [0.3, 0.1, -2.0, 0.5]))
    for _ in range(40):
        instance.step(0.05)
        np.testing.assert_allclose(instance.get(*FORCES), solve(instance.time, instance.get(*STATES)), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_derivative_of_an_output(name, open_fmu):
    """Derivatives agree with central differences along directions that keep the constraint satisfied."""
    instance = open_fmu(name)
    instance.fmu.setupExperiment(startTime=0.4)
    instance.fmu.enterInitializationMode()
    rest = [0.3, 0.1, -2.0, 0.5]
    slope = (np.array(list(place(0.5 + 1e-5, 1.1, rest).values())) - np.array(list(place(0.5 - 1e-5, 1.1, rest).values()))) / 2e-5
    for known, seed, change in [
        (STATES, list(slope), lambda h: place(0.5 + h, 1.1, rest)),
        (["w"], [1.0], lambda h: {"w": rest[2] + h}),
        (["F"], [1.0], lambda h: {"F": 0.7 + h}),
        (["k"], [1.0], lambda h: {"k": 7 + h}),
    ]:
        instance.set(place(0.5, 1.1, rest))
        (ours,) = instance.fmu.getDirectionalDerivative(instance.vr("tension"), instance.vr(*known), seed)
        values = []
        for sign in (1, -1):
            instance.set(change(sign * 1e-5))
            values.append(instance.get("tension"))
        instance.set(change(0.0))
        assert ours == pytest.approx((values[0] - values[1]) / 2e-5, rel=1e-6, abs=1e-7), known
