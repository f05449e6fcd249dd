"""Tables against SciPy's curves of the same points; motions against energy conservation and closed forms."""

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, PchipInterpolator

import fmu
from building import build_by_cmake
from fmu import lagc

# Steep, flat and turning intervals of different widths; one point at 0.
X = np.array([-2.0, -1.2, -1.0, 0.0, 0.3, 1.5, 4.0])
Y = np.array([3.0, 1.0, 1.0, 2.0, 4.0, -1.0, -1.5])
POINTS = "".join(f'<point x="{x}" y="{y}"/>' for x, y in zip(X, Y))
LINES = "".join(f"{x}, {y}  # a point\n" for x, y in zip(X, Y))
CURVES = """<system name="{name}">
  <input name="u" unit="m"/>
  <table name="monotone" unit="N" argumentUnit="m">{points}</table>
  <table name="spline" unit="N" argumentUnit="m" interpolation="spline">
{lines}</table>
  <table name="held" unit="N" argumentUnit="m" extrapolation="constant" interpolation="spline" file="curve.csv"/>
  <table name="straight" unit="N" interpolation="linear" argumentUnit="m" file="curve.csv" extrapolation="constant"/>
  <table name="slanted" unit="N" interpolation="linear" argumentUnit="m" file="curve.csv"/>
  <table name="pair" argumentUnit="m">0 2
1 5</table>
  <table name="parabola" interpolation="spline" argumentUnit="m">0 0<!-- and -->
1 1
3;9
</table>
  <table name="line" interpolation="spline" argumentUnit="m">0 2
1 5</table>
  <table name="bent" argumentUnit="m">0 0
1 2
4 3</table>
  <table name="bounded" argumentUnit="m">0 0
1 2
2 -8</table>
  <output name="bentAtU">bent(u)</output>
  <output name="boundedAtU">bounded(u)</output>
  <output name="monotoneAtU" unit="N">monotone(u)</output>
  <output name="splineAtU" unit="N">spline(u)</output>
  <output name="heldAtU" unit="N">held(u)</output>
  <output name="straightAtU" unit="N">straight(u)</output>
  <output name="parabolaAtU">parabola(u)</output>
  <output name="lineAtU">line(u)</output>
  <output name="slantedAtU" unit="N">slanted(u)</output>
  <output name="pairAtU">pair(u)</output>
</system>
"""
# A mass in the potential of a curve, started at a knot towards either side; the table may stand in an included part.
HILL = """<system name="{name}">
  <parameter name="m" start="2" unit="kg"/><parameter name="g" start="10" unit="m/s2"/>
  <table name="height" unit="m" argumentUnit="m" interpolation="{interpolation}">{points}</table>
  <coordinate name="x" velocity="v" unit="m"/>
  <particle mass="m" x="x"/>
  <potential>m*g*height(x)</potential>
  <output name="slope">der(height(x))</output>
  <solver method="{method}" tolerance="1e-9"/>
</system>
"""
PART = """<system name="TableAround"><include file="../HillSpline/system.xml" as="hill"/>
<output name="here" unit="m">hill.height(hill.x)</output></system>"""
HILLS = [("HillMonotone", "monotone", "taylor"), ("HillSpline", "spline", "auto"), ("HillRadau", "spline", "radau"), ("HillErk", "monotone", "erk")]


def outside(curve, u):
    """Extrapolate linearly with the slopes at the ends."""
    inside = np.clip(u, X[0], X[-1])
    return curve(inside) + curve(inside, 1) * (u - inside)


def straight_on(u):
    """Piecewise linear, extrapolated beyond the ends."""
    slopes = np.diff(Y) / np.diff(X)
    return np.interp(u, X, Y) + slopes[0] * min(u - X[0], 0) + slopes[-1] * max(u - X[-1], 0)


def slope_outside(curve, u):
    return curve(np.clip(u, X[0], X[-1]), 1)


FILE = "argument,force\n" + LINES
MONOTONE, SPLINE = PchipInterpolator(X, Y), CubicSpline(X, Y)
# The slopes at the left end are that of a parabola, and three times the secant, the bound for monotonicity.
BENT, BOUNDED = PchipInterpolator([0, 1, 4], [0, 2, 3]), PchipInterpolator([0, 1, 2], [0, 2, -8])
ARGUMENTS = sorted([*X, *np.linspace(-3, 5, 57)])


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: HILL.format(name=name, interpolation=kind, method=method, points=POINTS) for name, kind, method in HILLS}
    curves = lambda name: CURVES.format(name=name, points=POINTS, lines=LINES)
    fmu.build_systems("curves", {**texts, "TableCurves": curves("TableCurves"), "TableAround": PART}, files={"TableCurves/curve.csv": FILE})
    fmu.build_systems("curves-tables", {"TableTables": curves("TableTables")}, "--form", "tables", files={"TableTables/curve.csv": FILE})


@pytest.mark.parametrize("name", ["TableCurves", "TableTables"])
def test_values_and_derivatives(name, open_fmu):
    instance = open_fmu(name).initialize()
    names = ["monotoneAtU", "splineAtU", "heldAtU", "straightAtU", "parabolaAtU", "lineAtU", "slantedAtU", "pairAtU"]
    for u in ARGUMENTS:
        instance.set(u=u)
        held = SPLINE(np.clip(u, X[0], X[-1]))
        values = [outside(MONOTONE, u), outside(SPLINE, u), held, np.interp(u, X, Y), np.nan, 2 + 3 * u, straight_on(u), 2 + 3 * u]
        values[4] = u * u if 0 <= u <= 3 else 0.0 if u < 0 else 9 + 6 * (u - 3)
        np.testing.assert_allclose(instance.get(*names), values, rtol=1e-13, atol=1e-13)
        ends = [curve(np.clip(u, *x)) + curve(np.clip(u, *x), 1) * (u - np.clip(u, *x)) for curve, x in ((BENT, (0, 4)), (BOUNDED, (0, 2)))]
        np.testing.assert_allclose(instance.get("bentAtU", "boundedAtU"), ends, rtol=1e-13, atol=1e-13)
        along = instance.fmu.getDirectionalDerivative(instance.vr(*names[:2]), instance.vr("u"), [1.0])
        np.testing.assert_allclose(along, [slope_outside(MONOTONE, u), slope_outside(SPLINE, u)], rtol=1e-12, atol=1e-12)
        if X[0] < u < X[-1]:
            along = instance.fmu.getDirectionalDerivative(instance.vr("heldAtU"), instance.vr("u"), [1.0])
            np.testing.assert_allclose(along, [SPLINE(u, 1)], rtol=1e-12, atol=1e-12)


CURVES_OF = {"monotone": MONOTONE, "spline": SPLINE}


@functools.cache
def reference(kind, start, velocity):
    rate = lambda t, s: [s[1], -10 * slope_outside(CURVES_OF[kind], s[0])]
    options = dict(method="DOP853", rtol=1e-12, atol=1e-12, max_step=2e-3)
    return solve_ivp(rate, [0, 2], [start, velocity], t_eval=[0.5, 1.0, 2.0], **options).y


@pytest.mark.parametrize("start, velocity", [(0.0, 9.0), (0.0, -9.0), (1.5, -4.0), (0.3, 1e-3), (-0.1, 12.0), (4.0, 0.0)])
@pytest.mark.parametrize("name, kind, method", HILLS)
def test_motion(name, kind, method, start, velocity, open_fmu):
    curve, exact = CURVES_OF[kind], reference(kind, start, velocity)
    instance = open_fmu(name).initialize({"x": start, "v": velocity})
    for time, (x, v) in zip([0.5, 1.0, 2.0], exact.T):
        instance.step(time - instance.time)
        assert instance.get("x", "v") == [pytest.approx(x, abs=3e-6), pytest.approx(v, abs=3e-5)], time
        assert instance.get("slope") == pytest.approx(v * slope_outside(curve, x), abs=1e-3)
    assert instance.get("totalEnergy") == pytest.approx(velocity**2 + 20 * outside(curve, start), abs=1e-4)


def test_in_a_part(open_fmu):
    instance = open_fmu("TableAround").initialize({"hill.x": 0.7})
    assert instance.get("here") == pytest.approx(SPLINE(0.7), rel=1e-14)


def test_a_changed_file_is_rebuilt(tmp_path):
    texts = {"TableCurves": CURVES.format(name="TableCurves", points=POINTS, lines=LINES)}
    path = tmp_path / "systems" / "TableCurves" / "curve.csv"
    path.parent.mkdir(parents=True)
    path.write_text(FILE)
    before = (build_by_cmake(tmp_path, texts) / "TableCurves.fmu").read_bytes()
    path.write_text(FILE.replace("4.0, -1.5", "4.0, -1.25"))
    assert (build_by_cmake(tmp_path, texts) / "TableCurves.fmu").read_bytes() != before


@pytest.mark.parametrize("table, message", [
    ("<table name='f' file='no.csv'/>", "the file 'no.csv' cannot be read: No such file or directory; expected columns of numbers"),
    ("<table name='f' file='bad.csv'/>", "bad.csv:3: 'three 4' is not a point; expected two numbers, the argument and the value"),
    ("<table name='f' file='back.csv'/>", "back.csv:2: the point at 1 follows that at 1; expected points from left to right"),
    ("<table name='f'>\n0 1\n1\n</table>", "system.xml:4: '1' is not a point"),
    ("<table name='f'><point x='0'/></table>", "<point> needs the attribute 'y'"),
    ("<table name='f'><point x='0' y='x'/><point x='1' y='2'/></table>", "y cannot depend on coordinates"),
    ("<table name='f' file='ok.csv' interpolation='cubic'/>", "interpolation=\"cubic\" of <table> is not known; expected monotone, spline or linear"),
    ("<table name='f' file='ok.csv'/><table name='f' file='ok.csv'/>", "the name 'f' is already defined"),
    ("<table name='sin' file='ok.csv'/>", "the name 'sin' belongs to the language itself"),
    ("<table name='f' file='ok.csv'/><potential>f*x</potential>", "'f' is not a variable but a table; expected its argument in parentheses, as in f(...)"),
    ("<table name='f' file='ok.csv'/><potential>f(x, 2)</potential>", "expected ')' after the argument of a table, found ','"),
    ("<table name='f' file='ok.csv'/><potential>f()</potential>", "expected a number, a name or '(', found ')'"),
    ("<table name='force' file='ok.csv'/><potential>forse(x)</potential>", "unknown function 'forse'; did you mean 'force'?"),
    ("<table name='f' file='ok.csv' unit='cm'/>", "the unit 'cm' is not known"),
    ("<table name='f' file='long.csv'/>", "long.csv:501: the table has more than 500 points"),
    ("<table name='f' file='huge.csv'/>", "huge.csv:2: the point (1, inf) is not finite"),
])  # fmt: skip
def test_errors(table, message, tmp_path):
    files = {"ok.csv": "0 1\n1 2\n", "bad.csv": "x,y\n0 1\nthree 4\n", "back.csv": "1 1\n1 2\n",
             "long.csv": "".join(f"{i} 0\n" for i in range(600)), "huge.csv": "0 1\n1 1e999\n"}  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    text = f'<system name="Refused">\n<coordinate name="x" velocity="v"/><particle mass="2" x="x"/>{table}</system>'
    (tmp_path / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr
