"""Coordinates without inertia that constraints tie to others, against the same mechanisms without them."""

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from scipy.integrate import solve_ivp

import fmu
from fmu import lagc
from constrained_systems import METHODS

CRANK = """
<system name="{name}" description="slider crank with a connecting rod that has no mass">
  <parameter name="J" start="0.4"/><parameter name="m" start="1.5"/><parameter name="r" start="0.3"/>
  <parameter name="l" start="0.7"/><parameter name="k" start="20"/>
  <coordinate name="p" velocity="w" start="0.5" velocityStart="4" fixed="true"/>
  <coordinate name="q" velocity="wq" start="0.1"/>
  <coordinate name="x" velocity="v" start="0.9"/>
  <body name="crank" mass="0" inertia="J" x="r*cos(p)" y="r*sin(p)" angle="p"/>
  <particle name="slider" mass="m" x="x"/>
  <potential>k*(x - 0.6)^2/2</potential>
  <constraint name="along">x - r*cos(p) - l*cos(q)</constraint>
  <constraint name="across">r*sin(p) + l*sin(q)</constraint>
  <output name="F">along.force</output>
  {solver}
  <experiment stopTime="5"/>
</system>
"""
# Two particles on a rod whose angle is a coordinate. Each constraint loses its hold on the angle at some positions.
DUMBBELL = """
<system name="Dumbbell">
  <parameter name="m1" start="2"/><parameter name="m2" start="3"/><parameter name="l" start="0.8"/>
  <coordinate name="x1" velocity="vx1"/><coordinate name="y1" velocity="vy1"/>
  <coordinate name="x2" velocity="vx2" start="0.8"/><coordinate name="y2" velocity="vy2" velocityStart="1.6"/>
  <coordinate name="theta" velocity="omega" velocityStart="2"/>
  <particle name="one" mass="m1" x="x1" y="y1"/><particle name="two" mass="m2" x="x2" y="y2"/>
  <constraint name="cx">x2 - x1 - l*cos(theta)</constraint>
  <constraint name="cy">y2 - y1 - l*sin(theta)</constraint>
  <experiment stopTime="10"/>
</system>
"""
# A rack turns a wheel, which turns another wheel with a spring; neither wheel has inertia.
GEARS = """
<system name="Gears">
  <parameter name="m" start="2"/><parameter name="R" start="0.1"/><parameter name="k" start="3"/>
  <coordinate name="x" velocity="v" start="0.2"/>
  <coordinate name="a" velocity="wa" start="2"/><coordinate name="b" velocity="wb" start="1"/>
  <particle mass="m" x="x"/>
  <potential>k*b^2/2</potential>
  <constraint name="rack">x - R*a</constraint>
  <constraint name="gear">a - 2*b</constraint>
  <experiment stopTime="2"/>
</system>
"""
# A torque on a massless wheel that rolls; and two angles, only the sum of which moves a mass.
ROLLING = """
<system name="RollingWheel">
  <coordinate name="x" velocity="v"/><coordinate name="phi" velocity="w"/>
  <particle mass="4" x="x"/>
  <force coordinate="phi">0.6*cos(time)</force>
  <constraint name="contact">v - 0.2*w</constraint>
  <experiment stopTime="2"/>
</system>
"""
SUM = """
<system name="SumOfAngles">
  <coordinate name="a" velocity="wa"/><coordinate name="b" velocity="wb" start="1"/>
  <particle name="bob" mass="2" x="0.5*sin(a + b)" y="-0.5*cos(a + b)"/>
  <potential>2*9.81*bob.y</potential>
  <constraint name="given">a - 0.3*sin(2*time)</constraint>
  <experiment stopTime="2"/>
</system>
"""
TEXTS = {f"Crank{m}": CRANK.format(name=f"Crank{m}", solver=f'<solver method="{m}" tolerance="1e-10"/>') for m in METHODS}
TEXTS |= {"Dumbbell": DUMBBELL, "Gears": GEARS, "RollingWheel": ROLLING, "SumOfAngles": SUM}


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("massless", TEXTS)


def crank_motion(times, J=0.4, m=1.5, r=0.3, l=0.7, k=20.0, p=0.5, w=4.0):
    """Motion of the crank's angle alone, with the slider at x(p): (J + m x'^2) p'' + m x' x'' w^2 = -k (x - 0.6) x'."""

    def slider(p):
        root = np.sqrt(l**2 - (r * np.sin(p)) ** 2)
        slope = -r * np.sin(p) - r**2 * np.sin(p) * np.cos(p) / root
        bend = -r * np.cos(p) - r**2 * np.cos(2 * p) / root - (r**2 * np.sin(p) * np.cos(p)) ** 2 / root**3
        return r * np.cos(p) + root, slope, bend

    def derivative(t, state):
        x, slope, bend = slider(state[0])
        return [state[1], -(m * slope * bend * state[1] ** 2 + k * (x - 0.6) * slope) / (J + m * slope**2)]

    states = solve_ivp(derivative, (0, times[-1]), [p, w], method="DOP853", rtol=1e-12, atol=1e-12, t_eval=times).y
    rows = []
    for t, p, w in zip(times, *states):
        x, slope, bend = slider(p)
        force = -k * (x - 0.6) - m * (slope * derivative(t, [p, w])[1] + bend * w**2)
        rows.append([p, w, x, np.arcsin(-r * np.sin(p) / l), force])
    return rows


@pytest.mark.parametrize("method", METHODS)
def test_slider_crank(method, open_fmu):
    instance = open_fmu(f"Crank{method}").initialize()
    energy, times = instance.get("totalEnergy"), np.linspace(0.25, 5, 20)
    assert energy == pytest.approx(0.2 * 16 + 0.75 * instance.get("v") ** 2 + 10 * (instance.get("x") - 0.6) ** 2, rel=1e-14)
    for t, expected in zip(times, crank_motion(times)):
        instance.step(t - instance.time)
        allowed = 1e-4 if method == "bdf" else 1e-6
        assert instance.get("p", "w", "x", "q") == pytest.approx(expected[:4], abs=allowed)
        assert instance.get("F") == pytest.approx(expected[4], abs=100 * allowed)
        assert instance.get("totalEnergy") == pytest.approx(energy, abs=10 * allowed)
        p, q, x = instance.get("p", "q", "x")
        assert abs(x - 0.3 * np.cos(p) - 0.7 * np.cos(q)) < 1e-13 and abs(0.3 * np.sin(p) + 0.7 * np.sin(q)) < 1e-13


def test_massless_coordinates_move_at_the_start(open_fmu):
    """Initialization moves only the angle of the massless rod, which costs nothing in the mass norm; the other coordinates already fit."""
    x = 0.3 * np.cos(0.5) + np.sqrt(0.49 - (0.3 * np.sin(0.5)) ** 2)
    instance = open_fmu("Cranktaylor").initialize({"x": x, "q": 0.2})
    assert instance.get("p", "x") == pytest.approx([0.5, x], abs=1e-9)
    assert instance.get("q") == pytest.approx(np.arcsin(-0.3 * np.sin(0.5) / 0.7), abs=1e-12)


@pytest.mark.parametrize("m1, m2", [(2, 3), (1e-6, 1), (1, 1e-6), (1e6, 1), (1e6, 1e6), (1e-6, 1e-6), (1e-6, 1e6)])
def test_dumbbell_of_any_masses(m1, m2, open_fmu):
    """The centre of mass moves uniformly, and the rod rotates at constant rate with the tension m1 m2/(m1 + m2) l omega^2."""
    instance = open_fmu("Dumbbell").initialize({"m1": m1, "m2": m2}, tolerance=1e-10)
    reduced = m1 * m2 / (m1 + m2)
    for _ in range(20):
        instance.step(0.5)
        t = instance.time
        assert instance.get("theta", "omega") == pytest.approx([2 * t, 2], abs=1e-6)
        x1, y1, vy1, theta = instance.get("x1", "y1", "vy1", "theta")
        v = m2 * 1.6 / (m1 + m2)
        centre = np.array([m2 * 0.8 / (m1 + m2), v * t])
        lever = 0.8 * m2 / (m1 + m2) * np.array([np.cos(2 * t), np.sin(2 * t)])
        np.testing.assert_allclose([x1, y1], centre - lever, atol=1e-6)
        tension = np.array(instance.get("cx.force", "cy.force")) @ [np.cos(theta), np.sin(theta)]
        assert tension == pytest.approx(reduced * 0.8 * 4, rel=1e-6)
        assert instance.get("der(omega)") == pytest.approx(0, abs=1e-6)
    assert instance.get("kineticEnergy") == pytest.approx(m2 * 1.6**2 / 2, rel=1e-7)


@pytest.mark.parametrize("R, m", [(0.1, 2), (1e-4, 2), (10, 1e-5), (0.1, 1e5)])
def test_a_chain_of_massless_wheels(R, m, open_fmu):
    """The effective stiffness of the spring at the rack is k/(2 R)^2."""
    instance = open_fmu("Gears").initialize({"R": R, "m": m, "x": 0.2, "a": 0.2 / R, "b": 0.1 / R}, tolerance=1e-10)
    rate = np.sqrt(3 / m) / (2 * R)
    for _ in range(20):
        instance.step(0.1 / rate)
        t = instance.time
        x, a, b, rack = instance.get("x", "a", "b", "rack.force")
        assert [x, a * R, 2 * b * R] == pytest.approx([0.2 * np.cos(rate * t)] * 3, abs=1e-8)
        assert rack == pytest.approx(-m * -(rate**2) * x, rel=1e-6, abs=1e-6 * m * rate**2)


def test_a_wheel_that_rolls(open_fmu):
    instance = open_fmu("RollingWheel").initialize(tolerance=1e-10)
    for _ in range(20):
        instance.step(0.1)
        assert instance.get("x", "v") == pytest.approx([0.75 * (1 - np.cos(instance.time)), 0.75 * np.sin(instance.time)], abs=1e-9)
        assert instance.get("contact.force") == pytest.approx(-3 * np.cos(instance.time), abs=1e-9)


def test_two_angles_of_one_motion(open_fmu):
    """a is given. a + b swings as a pendulum, since a has no inertia and no force apart from its constraint."""
    times = np.linspace(0.1, 2, 20)
    expected = solve_ivp(lambda t, s: [s[1], -2 * 9.81 * np.sin(s[0])], (0, 2), [1.0, 0.6], rtol=1e-12, atol=1e-12, t_eval=times).y[0]
    instance = open_fmu("SumOfAngles").initialize({"wa": 0.6, "wb": 0.0}, tolerance=1e-10)
    for t, angle in zip(times, expected):
        instance.step(0.1)
        a, b = instance.get("a", "b")
        assert [a, a + b] == pytest.approx([0.3 * np.sin(2 * t), angle], abs=1e-7)
        assert instance.get("given.force") == pytest.approx(0, abs=1e-9)


def test_a_motion_of_three_coordinates_without_inertia(tmp_path):
    """Masses at a + b and b + c have no inertia along (1, -1, 1); the constraint on a + b + c determines that motion."""
    (tmp_path / "system.xml").write_text(
        '<system name="Three"><coordinate name="a" velocity="va"/><coordinate name="b" velocity="vb"/>'
        '<coordinate name="c" velocity="vc"/><particle mass="1" x="a + b" y="b + c"/>'
        '<constraint name="given">a + b + c - 0.3*sin(time)</constraint></system>'
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr


def test_motions_without_inertia_one_after_the_other(tmp_path):
    """
    A mass at a + b + c has no inertia along (1, -1, 0), which 'equal' constrains, nor along (1, 1, -2), which 'equal' leaves free and
    'total' constrains.
    """
    (tmp_path / "system.xml").write_text(
        '<system name="Two"><coordinate name="a" velocity="va"/><coordinate name="b" velocity="vb"/><coordinate name="c" velocity="vc"/>'
        '<particle mass="1" x="a + b + c"/><constraint name="equal">a - b</constraint><constraint name="total">c - a - b</constraint></system>'
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr


def test_rounding_leaves_no_inertia(tmp_path):
    """Three of four motions have no inertia. Their pivots of 1e-17, left by rounding in the elimination, count as 0."""
    (tmp_path / "system.xml").write_text(
        '<system name="Four">'
        + "".join(f'<coordinate name="{q}" velocity="v{q}"/>' for q in "abcd")
        + '<particle mass="0.37" x="1.481*a + 1.953*b + 0.537*c + 1.941*d"/>'
        + "".join(f'<constraint name="{p}{q}">{p} - {q}</constraint>' for p, q in zip("abc", "bcd"))
        + "</system>"
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr


def test_model_exchange(open_fmu):
    instance = open_fmu("Dumbbell", kind=FMU2Model)
    instance.initialize()
    assert instance.get("der(vx1)", "der(vx2)", "der(omega)") == pytest.approx([0.6 * 3.2, -0.4 * 3.2, 0], abs=1e-12)
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    assert instance.fmu.completedIntegratorStep()[0] in (0, False)


REJECTED = [
    ('<constraint name="c">x - y</constraint>', "the coordinate 'a' has no inertia: no mass moves with it"),
    ('<constraint name="c">x - a - b</constraint>', "the velocity of 'v(a|b)' is not independent"),
    ('<constraint name="c">x - a*b</constraint><constraint name="d">y - 2*a*b</constraint>', "the velocity of 'v(a|b)' is not independent"),
    ('<constraint name="c">x - a</constraint>', "the coordinate 'b' has no inertia"),
]


@pytest.mark.parametrize("lines, message", REJECTED)
def test_errors(lines, message, tmp_path):
    import re

    (tmp_path / "system.xml").write_text(
        '<system name="Loose"><coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/>'
        '<coordinate name="a" velocity="va" start="1"/><coordinate name="b" velocity="vb" start="1"/>'
        f'<particle mass="1" x="x" y="y"/>{lines}</system>'
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(message, result.stderr), result.stderr
