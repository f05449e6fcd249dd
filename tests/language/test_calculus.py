"""diff and integral: closed forms, the number of nodes that lagc chooses, and messages."""

import re

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from scipy.integrate import quad
from scipy.special import roots_legendre

from fmu import ERROR, build_systems, lagc

HEAD = '<coordinate name="x" velocity="v" start="0.7"/><coordinate name="y" velocity="vy" start="-0.3" velocityStart="0.5"/><particle mass="1" x="x" y="y"/><parameter name="p" start="1.5"/><input name="u" start="2"/>'
FUNCTIONS = """<function name="wave" arguments="s k">sin(k*s)*exp(-s) + abs(s - x)*s</function>
<function name="slope" arguments="s">diff(wave(s, p), s)</function>
<function name="ramp" arguments="s">abs(s)*s</function>
<function name="held" arguments="a b">diff(a^3*p + b*x, p)</function>"""
# Expressions and their values at x = 0.7, y = -0.3, v = 0, vy = 0.5, p = 1.5, u = 2, time = 0.
X, Y, VY, P, U = 0.7, -0.3, 0.5, 1.5, 2.0
VALUES = {
    "diff(x^2*y + p*v, x)": 2 * X * Y,
    "diff(sin(x*vy)*u, vy)": U * X * np.cos(X * VY),
    "diff(x*p^3, p)": 3 * X * P**2,
    "diff(exp(time)*x*u + der(x), time)": X * U,
    "diff(u^3*x, u)": 3 * U**2 * X,
    "diff(diff(x^3*y^2, x), y)": 6 * X**2 * Y,
    "slope(1)": P * np.cos(P) * np.exp(-1) - np.sin(P) * np.exp(-1) + 1 + (1 - X),
    "slope(y)": P * np.cos(P * Y) * np.exp(-Y) - np.sin(P * Y) * np.exp(-Y) - Y + (X - Y),
    "sum(i, 1, 3, diff(ramp(i*y), y))": sum(2 * i * i * abs(Y) for i in (1, 2, 3)),
    "held(p, 2) + held(x*p, p)": P**3 + (X * P) ** 3,
    "integral(s, 0, x, s^2)": X**3 / 3,
    "integral(s, y, x*p, sin(s*p))": (np.cos(Y * P) - np.cos(X * P * P)) / P,
    "integral(s, 1, 0, s)": -0.5,
    "integral(s, 0, 1, integral(r, 0, s, (s - r)^3*x))": X / 20,
    "integral(s, 0, 1, diff(s^3*integral(r, 0, s, r), s))": 0.5,
    "integral(s, 0, 1, sqrt(1 + (x + y*s)^2))": quad(lambda s: np.sqrt(1 + (X + Y * s) ** 2), 0, 1, epsabs=1e-14)[0],
    "integral(s, 0, 1, exp(s), 2)": sum(w / 2 * np.exp((1 + s) / 2) for s, w in zip(*roots_legendre(2))),
    "integral(s, 0, x, x - s) + integral(s, x, 1, s - x)": X**2 / 2 + (1 - X) ** 2 / 2,
    "integral(s, 0, 1, der(s*x*y))": X * VY / 2,
    "integral(s, 0, 1, sum(i, 1, 3, s^i))": 1 / 2 + 1 / 3 + 1 / 4,
}  # fmt: skip
# A string that hangs between its ends: two Ritz functions for the sag, whose energy is not a polynomial.
STRING = """<system name="CalculusString"><parameter name="L" start="2" unit="m"/><parameter name="EA" start="50" unit="N"/>
<parameter name="rho" start="0.4" unit="kg/m"/><parameter name="g" start="9.81" unit="m/s2"/>
<coordinate name="a" velocity="va" unit="m" start="0.1"/><coordinate name="b" velocity="vb" unit="m"/>
<function name="w" arguments="s">a*sin(pi*s/L) + b*sin(2*pi*s/L)</function>
<kinetic>integral(s, 0, L, rho*der(w(s))^2/2)</kinetic>
<potential>integral(s, 0, L, EA*(sqrt(1 + diff(w(s), s)^2) - 0.9)^2/2 + rho*g*w(s))</potential><solver tolerance="1e-10"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    outputs = "".join(f'<output name="o[{i}]">{text}</output>' for i, text in enumerate(VALUES))
    build_systems("calculus", {"CalculusValues": f'<system name="CalculusValues">{HEAD}{FUNCTIONS}{outputs}</system>', "CalculusString": STRING})


def test_values(open_fmu):
    instance = open_fmu("CalculusValues").initialize()
    for i, (text, expected) in enumerate(VALUES.items()):
        assert instance.get(f"o[{i}]") == pytest.approx(expected, rel=2e-13, abs=1e-15), text


def test_forces_of_an_integral(open_fmu):
    """Accelerations agree with those from derivatives of the energies by adaptive quadrature."""
    instance = open_fmu("CalculusString").initialize({"a": 0.15, "b": -0.08})
    a, b, L, EA, rho, g = 0.15, -0.08, 2, 50, 0.4, 9.81

    def force(k):
        def integrand(s):
            slope = a * np.pi / L * np.cos(np.pi * s / L) + b * 2 * np.pi / L * np.cos(2 * np.pi * s / L)
            stretch = np.sqrt(1 + slope**2)
            return EA * (stretch - 0.9) * slope / stretch * k * np.pi / L * np.cos(k * np.pi * s / L) + rho * g * np.sin(k * np.pi * s / L)

        return -quad(integrand, 0, L, epsabs=1e-13, epsrel=1e-13)[0]

    for k, name in [(1, "der(va)"), (2, "der(vb)")]:
        assert instance.get(name) == pytest.approx(force(k) / (rho * L / 2), rel=1e-11, abs=1e-11)
    start = instance.get("totalEnergy")
    instance.run(2, 0.1)
    assert instance.get("totalEnergy") == pytest.approx(start, rel=1e-7)


# Each integrand with its value as a function of x, a bound or a frequency, and the x at which it leaves the range that lagc reports.
MOVING = {
    "integral(s, 0, x, sin(s))": lambda x: 1 - np.cos(x),
    "integral(s, 0, 1, cos(x*s))": lambda x: np.sin(x) / x if x else 1.0,
    "integral(s, 0, time, exp(s - time)*cos(3*s))": lambda x: (np.cos(3 * x) + 3 * np.sin(3 * x) - np.exp(-x)) / 10,
    "integral(s, x, x + 1, s^9)": lambda x: ((x + 1) ** 10 - x**10) / 10,
}  # fmt: skip
METHODS = ["taylor", "auto", "radau", "bdf", "erk"]


@pytest.mark.parametrize("method", METHODS)
def test_integrals_are_right_or_stop(method, open_fmu):
    """x = time. A rate stands for all forces; where it has no value, the solver stops before 40 s, at the end of the range."""
    for i, (text, exact) in enumerate(MOVING.items()):
        name = f"Moving{i}{method}"
        system = f'<system name="{name}"><state name="x" rate="1"/><state name="z" rate="{text}"/><output name="o">der(z)</output><solver method="{method}" maxSteps="3000"/><experiment stopTime="3"/></system>'
        build_systems(f"calculus-moving-{method}", {name: system})
        instance, has_stopped = open_fmu(name).initialize(), False
        for _ in range(40):
            try:
                instance.step(1.0)
            except FMICallException:
                has_stopped = True
                break
            x = instance.get("x")
            assert instance.get("o") == pytest.approx(exact(x), rel=1e-10, abs=1e-11), (text, x)
        assert has_stopped == ("s^9" not in text) and instance.time >= 3, text


def test_a_parameter_beyond_the_range_is_rejected(open_fmu):
    build_systems("calculus-range", {"Ranged": '<system name="Ranged"><parameter name="L" start="1"/><state name="z" rate="integral(s, 0, L, sin(s))"/></system>'})
    assert open_fmu("Ranged").initialize({"L": 4}).get("der(z)") == pytest.approx(1 - np.cos(4), rel=1e-11)
    with (instance := open_fmu("Ranged")).fails(ERROR, "the rate of 'z' is not finite, .* or an integral leaves the range that lagc has named"):
        instance.initialize({"L": 100})


@pytest.mark.parametrize("expression, stop, message", [
    ("integral(s, 0, time, sin(s))", 10, r"note: .* is exact to 1e-13 by \d+ nodes for time up to [\d.]+, beyond which the FMU stops"),
    ("integral(s, 0, time, sin(s))", 5000, r"warning: .* needs more than 128 nodes; it is right for time up to [\d.]+ alone, beyond which the FMU stops; expected a <state> with the integrand as its rate"),
    ("integral(s, 0, 1, sin(x*s))", 10, r"note: .* is exact to 1e-13 by \d+ nodes for x from -[\d.]+ to [\d.]+, beyond which the FMU stops"),
    ("integral(s, 0, x, s^3*x)", 10, r"note: .* is exact to 1e-13 by 2 nodes near the start values"),
    ("integral(s, 0, 1, cos(s + x))", 10, r"note: .* is exact to 1e-13 by \d+ nodes near the start values"),
])  # fmt: skip
def test_ranges_are_named(tmp_path, expression, stop, message):
    messages = messages_of(tmp_path, f'<output name="o">{expression}</output><experiment stopTime="{stop}"/>').stderr
    assert re.search(message, messages), messages


def test_a_function_of_an_integral_with_a_range(tmp_path):
    """A range that is open at one end leaves the sine of the integral as it is."""
    (tmp_path / "system.xml").write_text('<system name="S"><parameter name="p" start="1.2"/><coordinate name="x" velocity="v" start="0.3"/><particle mass="1" x="x"/>'
                                         "<potential>sin(integral(s, 0, p, exp(-x^2)*s + cos(x)*cos(2.8*s)))</potential></system>")  # fmt: skip
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0 and "beyond which the FMU stops" in result.stderr, result.stderr


def test_shapes_of_many_sines_stay_small(tmp_path):
    """The shortening of a beam with eight shapes; its rate is a quadratic form of coordinates and velocities."""
    shapes = "".join(f'<coordinate name="q{k}" velocity="v{k}" start="0.0{k}"/>' for k in range(1, 9))
    w = "+".join(f"q{k}*sin({k}*pi*s)" for k in range(1, 9))
    functions = f'<function name="w" arguments="s">{w}</function><function name="short" arguments="s">integral(r, 0, s, diff(w(r), r)^2/2)</function>'
    (tmp_path / "system.xml").write_text(f'<system name="X">{shapes}{functions}<kinetic>integral(s, 0, 1, der(w(s))^2 + der(short(s))^2)</kinetic><potential>integral(s, 0, 1, diff(diff(w(s), s), s)^2)</potential></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr


def messages_of(tmp_path, content):
    (tmp_path / "system.xml").write_text(f'<system name="X">\n{HEAD}{content}</system>')
    return lagc("system.xml", "-o", "out", cwd=tmp_path)


@pytest.mark.parametrize("expression, nodes", [("s^5*x", 3), ("s^6*x", 4), ("s^2*sqrt(p)*v", 2), ("x*y", 1), ("s^15 + y", 8)])
def test_as_many_nodes_as_the_degree_needs(tmp_path, expression, nodes):
    result = messages_of(tmp_path, f'<output name="o">integral(s, 0, 2, {expression})</output>')
    assert re.findall(r"system.xml:2: note: integral\(s, 0, 2, (.*)\) is exact to 1e-13 by (\d+) node", result.stderr) == [(expression, str(nodes))]


def test_parameters_that_are_0_hide_nothing(tmp_path):
    """q = 0 at the start may be tuned, so that s^10 needs 6 nodes. The search respects min = 0 and tries no root of a negative number."""
    content = '<parameter name="q" start="0" min="0"/><output name="o">integral(s, 0, 1, q*s^10 + sqrt(q))</output>'
    assert "is exact to 1e-13 by 6 nodes" in messages_of(tmp_path, content).stderr


@pytest.mark.parametrize("integrand, low, high", [
    ("if(s > 0.9, 50, 0)", 0, 1), ("mod(4*s, 1)", 0, 1), ("mod(2*s, 1)", 0, 1), ("if(abs(s) < 0.7, 0, 1)", -1, 1), ("max(0, s - 0.999)", 0, 1),
    ("exp(-((s - 0.37)/0.001)^2)", 0, 1), ("1/(s - 0.5)", 0, 1),
])  # fmt: skip
def test_features_between_few_nodes_are_not_called_exact(tmp_path, integrand, low, high):
    """One central node gives 0 or a symmetric value of these integrands, which is wrong. lagc then does not call the integral exact."""
    text = integrand.replace("<", "&lt;")
    messages = messages_of(tmp_path, f'<output name="o">integral(s, {low}, {high}, {text})</output>').stderr
    assert "note:" not in messages and "has a relative error of" in messages, messages


def test_a_kink_is_named_with_its_error(tmp_path):
    result = messages_of(tmp_path, '<output name="o">integral(s, 0, 1, abs(s - 0.3*x))</output>')
    share = re.search(r"warning: integral\(s, 0, 1, abs\(s - 0.3\*x\)\) has a relative error of (\S+) by 32 nodes", result.stderr)
    assert result.returncode == 0 and 1e-6 < float(share.group(1)) < 0.1
    assert "warning: integral" not in messages_of(tmp_path, '<output name="o">integral(s, 0, 1, abs(s - 0.3*x), 5)</output>').stderr


@pytest.mark.parametrize("expression, message", [
    ("diff(x^2, d)", "diff(..., d) is by an expression; expected a coordinate"),
    ("diff(x^2*m, m)", "diff(..., m) is by a mode; expected a coordinate"),
    ("diff(x^2*c, c)", "diff(..., c) is by a constant; expected a coordinate"),
    ("integral(d, 0, 1, d)", "the variable 'd' of integral(...) is already defined"),
    ("sum(later, 1, 2, later)", "the index 'later' of sum(...) is already defined"),
    ("diff(x^2)", "expected ',' before the name of diff(expression, name)"),
    ("diff(x^2, 3)", "expected a name at the end of diff(expression, name)"),
    ("diff(x^2, zz)", "unknown name 'zz'"),
    ("diff(x 2, x)", "expected ',' after the expression of diff(expression, name)"),
    ("integral(x, 0, 1, x)", "the variable 'x' of integral(...) is already defined"),
    ("integral(s, 0, 1)", "expected ',' after the end of integral(name, from, to, expression)"),
    ("integral(s, 0, 1, s, 0)", "integral(...) has 0 nodes; expected 1 to 200"),
    ("integral(s, 0, 1, s, p)", "cannot depend on parameters"),
    ("integral(s, 0, 1, s) + s", "unknown name 's'"),
    ("integral(s, 0, 1, log(-1 - s^2))", "integral(s, 0, 1, log(-1 - s^2)) is not finite at or near the start values"),
    ("integral(s, 0, x, vv[s])", "is not a whole number"),
    ("integral(3, 0, x, 1)", "expected a name as the variable of integral(name, from, to, expression)"),
])  # fmt: skip
def test_messages(tmp_path, expression, message):
    result = messages_of(tmp_path, f'<mode name="m"/><constant name="c" value="2"/><define name="o">{expression}</define><define name="d">2*x</define><define name="later">x</define>')
    assert result.returncode == 1 and message in result.stderr


def test_names_of_functions_that_are_free(tmp_path):
    result = messages_of(tmp_path, '<state name="integral" rate="x"/><define name="diff">integral(s, 0, 1, s)*integral</define><output name="o">diff(diff, x) + diff</output>')
    assert "is by an expression" not in result.stderr and result.returncode == 0, result.stderr


def test_units(tmp_path):
    text = '<parameter name="l" start="2" unit="m"/><parameter name="k" start="3" unit="N/m"/><coordinate name="z" velocity="vz" unit="m"/><particle mass="1" z="z"/>'
    assert messages_of(tmp_path, text + '<potential>integral(s, 0, l, k*s)</potential><force coordinate="z">-diff(k*z^2/2, z)</force>').returncode == 0
    assert "has the unit" in messages_of(tmp_path, text + "<potential>integral(s, 0, l, k*s^2)</potential>").stderr
