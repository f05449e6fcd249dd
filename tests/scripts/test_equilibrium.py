"""Equilibria against closed forms, and the report on their linearization."""

import math
import warnings

import numpy as np
import pytest
from scipy.optimize import brentq

import fmu
import package
from building import build_systems
from motions import lagrange_fmu  # noqa: F401

G = 9.81
# An inverted pendulum on a torsion spring that is too weak to keep it upright: it leans.
LEANING = """<system name="Leaning"><parameter name="m" start="2" unit="kg"/><parameter name="l" start="0.5" unit="m"/><parameter name="k" start="6" unit="N.m/rad"/>
  <parameter name="b" start="0.3" unit="N.m.s/rad"/><parameter name="g" start="9.81" unit="m/s2"/><input name="tau" unit="N.m"/>
  <coordinate name="theta" velocity="omega" unit="rad"/><particle name="bob" mass="m" x="l*sin(theta)" y="l*cos(theta)"/>
  <potential>m*g*bob.y + k*theta^2/2</potential><dissipation>b*omega^2/2</dissipation><force coordinate="theta">tau</force>
  <output name="height" unit="m">bob.y</output></system>"""
LINKS = 8
# A chain of massless rods with bobs between them, held at both ends, in Cartesian coordinates.
CHAIN = f"""<system name="HangingChain"><parameter name="L" start="0.25" unit="m"/><parameter name="span" start="1.2" unit="m"/><constant name="g" value="9.81" unit="m/s2"/>
  <for index="i" from="1" to="{LINKS - 1}"><coordinate name="x[i]" velocity="vx[i]" unit="m" start="1.2*i/{LINKS}"/><coordinate name="y[i]" velocity="vy[i]" unit="m" start="-0.5*sin(pi*i/{LINKS})"/>
    <particle name="bob[i]" mass="0.1" x="x[i]" y="y[i]"/></for><gravity y="-g"/>
  <constraint name="c[1]" unit="m2">x[1]^2 + y[1]^2 - L^2</constraint>
  <for index="i" from="2" to="{LINKS - 1}"><constraint name="c[i]" unit="m2">(x[i] - x[i-1])^2 + (y[i] - y[i-1])^2 - L^2</constraint></for>
  <constraint name="c[{LINKS}]" unit="m2">(span - x[{LINKS - 1}])^2 + y[{LINKS - 1}]^2 - L^2</constraint></system>"""
# A piston against a spring: the flow of oil through a valve follows the square-root law, and the cylinder leaks.
CYLINDER = """<system name="Piston"><parameter name="A" start="1e-3" unit="m2"/><parameter name="k" start="2e5" unit="N/m"/><parameter name="ps" start="2e7" unit="Pa"/>
  <parameter name="E" start="1e9" unit="Pa"/><parameter name="V" start="1e-3" unit="m3"/><parameter name="leak" start="1e-11" unit="m3/(s.Pa)"/>
  <parameter name="C" start="1e-7" unit="m3/(s.Pa0.5)"/><input name="u" unit="1" start="0.5"/>
  <coordinate name="x" velocity="v" unit="m" nominal="0.01"/><particle mass="20" x="x"/><potential>k*x^2/2</potential><dissipation>500*v^2/2</dissipation>
  <state name="p" unit="Pa" nominal="1e6" start="1e6" rate="E/(V + A*x)*(C*u*sqrt(ps - p) - leak*p - A*v)"/><force coordinate="x">p*A</force></system>"""
# A cart under a constant load, whose controller has an integrator.
CART = """<system name="Controlled"><parameter name="m" start="3" unit="kg"/><parameter name="r" start="0.4" unit="m"/><parameter name="d" start="7" unit="N"/>
  <coordinate name="x" velocity="v" unit="m"/><particle mass="m" x="x"/><state name="z" unit="m.s" rate="r - x"/>
  <force coordinate="x">40*(r - x) + 30*z - 12*v - d</force></system>"""
FREE = """<system name="Rolling"><coordinate name="x" velocity="v" unit="m"/><coordinate name="y" velocity="w" unit="m" start="0.3"/><particle mass="2" x="x"/><particle mass="1" y="y"/>
  <potential>8*(y - 1)^2/2</potential><dissipation>(v^2 + w^2)/2</dissipation><force coordinate="y">1.6</force></system>"""
FALLING = """<system name="Landed"><coordinate name="h" velocity="v" unit="m" start="0"/><coordinate name="x" velocity="w" unit="m"/><input name="F" unit="N" start="3"/>
  <particle mass="2" x="x" y="h"/><gravity y="-9.81"/><contact name="floor" gap="h" unit="m"/><potential>50*x^2/2</potential><dissipation>4*w^2/2</dissipation><force coordinate="x">F</force></system>"""
STUCK = """<system name="Stuck"><coordinate name="x" velocity="v" unit="m" start="0.02"/><particle mass="1" x="x"/><potential>50*x^2/2</potential><friction name="rub" velocity="v" force="2"/></system>"""
# A climber beside the hook of a rope, and a box that falls on an edge.
CLIMBER = """<system name="Climber"><coordinate name="x" velocity="vx" unit="m" start="3"/><coordinate name="y" velocity="vy" unit="m"/><particle name="bob" mass="80" x="x" y="y"/>
  <gravity y="-9.81"/><parameter name="d" start="1" unit="N.s/m"/><dissipation>d*(vx^2 + vy^2)</dissipation><contact name="rope" gap="5 - sqrt(x^2 + y^2)" unit="m"/></system>"""
TILTED = """<system name="TiltedBox"><coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m" start="0.3"/><coordinate name="q" velocity="w" unit="rad" start="0.2"/>
  <body name="box" mass="2" x="x" y="y" inertia="0.05" angle="q"/><gravity y="-9.81"/><shape name="b" in="box" type="box" sizeX="0.4" sizeY="0.2" sizeZ="0"/>
  <shape name="g" type="plane" axis="y"/><contact name="c" between="b" and="g" friction="0.5"/></system>"""

# Systems that never rest: a fall without a floor, and a force that only decreases; and a system without states.
LIFTED = """<system name="Lifted"><coordinate name="h" velocity="v" unit="m" start="0.3"/><input name="F" unit="N"/><particle name="p" mass="2" y="h"/>
  <constant name="g" value="9.81" unit="m/s2"/><constant name="m" value="2" unit="kg"/><potential>m*g*h</potential><force coordinate="h">F</force>
  <contact name="floor" gap="h"/><output name="N" unit="N">floor.force</output></system>"""
DOWN = FALLING.replace("Landed", "Falling").replace('<contact name="floor" gap="h" unit="m"/>', "")
REPELLED = """<system name="Repelled"><coordinate name="x" velocity="v" unit="m" start="1"/><particle mass="1" x="x"/><potential>1/x</potential></system>"""
GAIN = """<system name="Gain"><input name="u" unit="1" start="2"/><output name="y" unit="1">3*u</output></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"Leaning": LEANING, "HangingChain": CHAIN, "Piston": CYLINDER, "Controlled": CART, "Rolling": FREE, "Landed": FALLING, "Stuck": STUCK, "Falling": DOWN, "Lifted": LIFTED, "Climber": CLIMBER, "TiltedBox": TILTED, "Repelled": REPELLED, "Gain": GAIN}
    build_systems("equilibria", texts)


def test_a_pendulum_on_a_spring(lagrange_fmu):  # noqa: F811
    """Equilibria satisfy k theta = m g l sin(theta), and their eigenvalues m l^2 s^2 + b s + k - m g l cos(theta) = 0."""
    weight, inertia = 2 * G * 0.5, 2 * 0.25
    leaning = brentq(lambda theta: 6 * theta - weight * math.sin(theta), 0.5, 3, xtol=1e-15)
    for guess, theta, stability in (("60deg", leaning, "stable"), (-2, -leaning, "stable"), (0.01, 0, "unstable")):
        found = lagrange_fmu.equilibrium(fmu.archive("Leaning"), {"theta": guess})
        assert found.point["theta"] == pytest.approx(theta, abs=1e-14) and found.point["omega"] == 0
        assert found.outputs["height"] == pytest.approx(0.5 * math.cos(theta), abs=1e-14)
        roots = np.roots([inertia, 0.3, 6 - weight * math.cos(theta)])
        np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(roots), rtol=1e-9)
        assert found.stability == stability and found.constraints == []
    swinging = lagrange_fmu.equilibrium(fmu.archive("Leaning"), {"theta": 1.5, "b": 0})
    assert swinging.stability == "undecided" and swinging.point["b"] == 0


def test_values_that_are_held(lagrange_fmu):  # noqa: F811
    """The torque, or the stiffness, that holds a pendulum at a given angle: tau = k theta - m g l sin(theta)."""
    found = lagrange_fmu.equilibrium(fmu.archive("Leaning"), {}, hold={"theta": "30deg"}, vary=["tau"])
    assert found.point["theta"] == pytest.approx(math.pi / 6, abs=1e-14)
    assert found.point["tau"] == pytest.approx(6 * math.pi / 6 - 2 * G * 0.5 * 0.5, rel=1e-12)
    found = lagrange_fmu.equilibrium(fmu.archive("Leaning"), {"theta": 0.6}, hold={"height": "400mm"}, vary="k")
    assert found.point["theta"] == pytest.approx(math.acos(0.8), rel=1e-12)
    assert found.point["k"] == pytest.approx(2 * G * 0.5 * 0.6 / math.acos(0.8), rel=1e-12)
    found = lagrange_fmu.equilibrium(fmu.archive("Leaning"), {"theta": 1}, hold={"tau": 2, "m": 1})
    theta = found.point["theta"]
    assert 6 * theta == pytest.approx(2 + G * 0.5 * math.sin(theta), rel=1e-13) and found.point["m"] == 1
    motion = lagrange_fmu.simulate(fmu.archive("Leaning"), found.point, stop_time=5)
    np.testing.assert_allclose(motion["theta"], theta, atol=1e-12)  # it stays at rest


def test_a_hanging_chain(lagrange_fmu):  # noqa: F811
    """The horizontal force is the same in all links, and each bob adds its weight: tan(angle) grows by m g/H from link to link."""
    step = brentq(lambda s: sum(0.25 * math.cos(math.atan(s * (i - (LINKS - 1) / 2))) for i in range(LINKS)) - 1.2, 0.1, 10)
    angles = np.arctan(step * (np.arange(LINKS) - (LINKS - 1) / 2))
    found = lagrange_fmu.equilibrium(fmu.archive("HangingChain"), {})
    x, y = (np.array([found.point[f"{name}[{i}]"] for i in range(1, LINKS)]) for name in "xy")
    np.testing.assert_allclose(x, 0.25 * np.cumsum(np.cos(angles))[:-1], atol=1e-9)
    np.testing.assert_allclose(y, 0.25 * np.cumsum(np.sin(angles))[:-1], atol=1e-9)
    assert found.stability == "undecided"  # undamped
    assert len(found.linearization.states) == 2 * (2 * (LINKS - 1) - LINKS)


def test_a_hydraulic_cylinder(lagrange_fmu):  # noqa: F811
    """C u sqrt(ps - p) = leak p: with a = (C u/leak)^2, p^2 + a p - a ps = 0; x = p A/k."""
    a = (1e-7 * 0.5 / 1e-11) ** 2
    pressure = (-a + math.sqrt(a**2 + 4 * a * 2e7)) / 2
    found = lagrange_fmu.equilibrium(fmu.archive("Piston"), {"p": "5bar"})
    assert (found.point["p"], found.point["x"]) == pytest.approx((pressure, pressure * 1e-3 / 2e5), rel=1e-12)
    assert found.stability == "stable"
    valve = lagrange_fmu.equilibrium(fmu.archive("Piston"), {}, hold={"x": "2cm"}, vary=["u"])
    assert valve.point["u"] == pytest.approx(1e-11 * 4e6 / (1e-7 * math.sqrt(1.6e7)), rel=1e-12)


def test_too_many_values_that_vary(lagrange_fmu):  # noqa: F811
    """A held pressure needs C u sqrt(ps - p) = leak p, by u or by C, but does not determine both; k follows from x."""
    with pytest.warns(UserWarning, match="equilibria near the guess exist for any u and C within limits"):
        found = lagrange_fmu.equilibrium(fmu.archive("Piston"), {}, hold={"p": 4e6}, vary=["u", "C"])
    assert found.point["u"] * found.point["C"] == pytest.approx(1e-11 * 4e6 / 4000, rel=1e-9)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = lagrange_fmu.equilibrium(fmu.archive("Piston"), {}, hold={"p": 4e6, "x": 0.02}, vary=["u", "k"])
    assert found.point["k"] == pytest.approx(4e6 * 1e-3 / 0.02, rel=1e-9)


def test_an_integrator(lagrange_fmu):  # noqa: F811
    """The integrator carries the whole load: 30 z = d at x = r."""
    found = lagrange_fmu.equilibrium(fmu.archive("Controlled"), {"x": 5})
    assert (found.point["x"], found.point["z"]) == pytest.approx((0.4, 7 / 30), rel=1e-13)
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(np.roots([3, 12, 40, 30])), rtol=1e-9)


def test_what_nothing_moves_stays_at_the_guess(lagrange_fmu):  # noqa: F811
    found = lagrange_fmu.equilibrium(fmu.archive("Rolling"), {"x": 0.7, "v": 3, "w": 2})
    assert (found.point["x"], found.point["y"]) == pytest.approx((0.7, 1.2), rel=1e-13)
    assert found.point["v"] == found.point["w"] == 0 and found.stability == "undecided"


def test_contacts_and_friction(lagrange_fmu):  # noqa: F811
    """A body rests on a floor at x = F/k; a sticking body rests in place."""
    for height in (0, 1):
        found = lagrange_fmu.equilibrium(fmu.archive("Landed"), {"h": height})
    assert found.constraints == ["floor"] and found.point["h"] == 0 and found.point["x"] == pytest.approx(3 / 50, rel=1e-13)
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(np.roots([2, 4, 50])), rtol=1e-7)
    found = lagrange_fmu.equilibrium(fmu.archive("Stuck"), {})
    assert found.point["x"] == 0.02 and found.constraints == ["rub"] and found.stability == "undecided" and found.eigenvalues.tolist() == [0]  # neighbouring positions are equilibria, too


@pytest.mark.parametrize("height", [0.3, 0.0])
def test_a_held_force_of_a_contact(height, lagrange_fmu):  # noqa: F811
    """The search starts on or above the floor: N = m g - F. A held height of 0 does not determine the force: F changes only if the contact is open."""
    found = lagrange_fmu.equilibrium(fmu.archive("Lifted"), {"h": height}, hold={"N": 10}, vary=["F"])
    assert found.point["F"] == pytest.approx(2 * G - 10, rel=1e-12) and found.point["h"] == pytest.approx(0, abs=1e-12)
    assert found.constraints == ["floor"] and found.stability == "stable"
    found = lagrange_fmu.equilibrium(fmu.archive("Lifted"), {"h": height}, hold={"h": 0}, vary=["F"])
    assert found.point["F"] == pytest.approx(2 * G if height > 0 else 0.0, rel=1e-9) and (found.linearization is None) == (height > 0)


def test_falls_into_a_rope(lagrange_fmu):  # noqa: F811
    """The climber hangs 5 m below the hook, and swings as a pendulum of this length: m s^2 + 2 s + m g/5 = 0 along the arc."""
    found = lagrange_fmu.equilibrium(fmu.archive("Climber"), {})
    assert (found.point["x"], found.point["y"]) == pytest.approx((0, -5), abs=1e-9) and found.constraints == ["rope"] and found.stability == "stable"
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(np.roots([80, 2, 80 * G / 5])), rtol=1e-7)


def test_falls_on_a_side(lagrange_fmu):  # noqa: F811
    found = lagrange_fmu.equilibrium(fmu.archive("TiltedBox"), {})
    assert (found.point["y"], found.point["q"]) == pytest.approx((0.1, 0), abs=1e-9)
    assert found.constraints == ["c[1]", "c[2]", "c[1].friction", "c[2].friction"]  # friction of vertices in the air holds nothing


def test_rests_where_it_switches(lagrange_fmu):  # noqa: F811
    """At the limit of the friction, 50 x = 2, and in a contact without force, on a floor that only just carries: there is no linearization."""
    for system, guess, name, value in (("Stuck", {"x": 1}, "x", 0.04), ("Stuck", {"x": 0.04}, "x", 0.04)):
        found = lagrange_fmu.equilibrium(fmu.archive(system), guess)
        assert found.point[name] == pytest.approx(value, rel=1e-9) and found.linearization is None and found.stability == "undecided" and not len(found.eigenvalues)
        assert "undecided: the system switches there" in repr(found)
    with pytest.raises(lagrange_fmu.Problem, match="Stuck has no linearization at this point"):
        lagrange_fmu.linearize(fmu.archive("Stuck"), {"x": 0.04})


def test_without_states(lagrange_fmu):  # noqa: F811
    assert lagrange_fmu.equilibrium(fmu.archive("Gain")).outputs == {"y": 6}
    assert lagrange_fmu.equilibrium(fmu.archive("Gain"), hold={"y": 12}, vary="u").point == {"u": 4}


def test_from_a_horizontal_pendulum(lagrange_fmu):  # noqa: F811
    """Newton's method has no direction at the horizontal: the search moves downhill first, to the hanging position."""
    free = {"theta": "90deg", "k": 0}
    assert lagrange_fmu.equilibrium(fmu.archive("Leaning"), free).point["theta"] == pytest.approx(math.pi, rel=1e-13)


def test_the_command(lagrange_fmu, tmp_path):  # noqa: F811
    """The command prints the point and the stability."""
    words = ["equilibrium", fmu.archive("Leaning"), "theta=60deg", "--hold", "height=400mm", "--vary", "k"]
    result = package.run(package.assemble(tmp_path / "package"), *words, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert f"theta = {math.acos(0.8):.9g}\n" in result.stdout and "\nheight = 0.4\n" in result.stdout and "\nstable; eigenvalues: " in result.stdout


@pytest.mark.parametrize("name, words, message", [
    ("Leaning", {"guess": {}, "hold": {"theta": 1}}, r"Leaning has no equilibrium near the guess: der\(omega\) = 4.50966 rad/s2 where the search ends, at theta = 1, .*, or an input that balances it, as vary=\['tau'\]"),
    ("Falling", {"guess": {"h": 1}}, r"der\(v\) = -9.81 m/s2 where"),
    ("Repelled", {}, "Repelled has no equilibrium near the guess: the rates vanish only at infinity"),
    ("Leaning", {"guess": {"thata": 1}}, "'thata' is not a variable of Leaning; did you mean 'theta'"),
    ("Leaning", {"guess": {}, "hold": {"hight": 1}}, "'hight' is not a state, output, input or parameter of Leaning; did you mean 'height'"),
    ("Leaning", {"guess": {}, "vary": ["theta"]}, "'theta' is no input or parameter of Leaning"),
    ("Leaning", {"guess": {}, "vary": ["tau"], "hold": {"tau": 1}}, "'tau' is held and varies"),
    ("Leaning", {"guess": {"theta": "1m"}}, "theta: '1m' is in m; expected a value in rad"),
    ("Leaning", {"guess": {}, "hold": {"height": math.nan}}, "hold has nan for 'height'"),
    ("Leaning", {"guess": 3}, "guess is a int; expected a dict"),
    ("Leaning", {"guess": {}, "hold": {"height": 7}, "vary": "tau"}, "height is off by -"),
])  # fmt: skip
def test_what_does_not_rest(name, words, message, lagrange_fmu):  # noqa: F811
    with pytest.raises(lagrange_fmu.Problem, match=message):
        lagrange_fmu.equilibrium(fmu.archive(name), **words)
