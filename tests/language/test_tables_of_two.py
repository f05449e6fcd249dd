"""Tables of two arguments against SciPy's surfaces of the same values; motions in them against energy conservation."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator, RectBivariateSpline, RegularGridInterpolator

import fmu
from fmu import lagc

X = np.array([-1.0, -0.4, 0.0, 0.7, 1.5])
Y = np.array([0.0, 0.5, 1.5, 2.0, 2.2, 3.0])
VALUES = np.array([[np.sin(2 * x + y) + 0.3 * x * y + (x > 0.5) for x in X] for y in Y])
CORNERS = {"": "", "word": "b/a; ", "number": "17 "}


def lines(corner=""):
    return "\n".join([corner + " ".join(map(repr, map(float, X)))] + [", ".join(repr(float(v)) for v in (y, *row)) for y, row in zip(Y, VALUES)])


SURFACES = """<system name="{name}">
  <input name="u" unit="m"/><input name="w" unit="s"/>
  <table name="m" arguments="2" unit="N" argumentUnit="m" secondArgumentUnit="s">
{plain}
</table>
  <table name="s" arguments="2" unit="N" argumentUnit="m" secondArgumentUnit="s" interpolation="spline"># knots
{word}
</table>
  <table name="l" arguments="2" unit="N" argumentUnit="m" secondArgumentUnit="s" interpolation="linear" file="grid.csv"/>
  <table name="held" arguments="2" unit="N" argumentUnit="m" secondArgumentUnit="s" interpolation="spline" extrapolation="constant" file="grid.csv"/>
  <table name="twoByTwo" arguments="2" interpolation="spline" argumentUnit="m" secondArgumentUnit="s">0 2
0 1 3
1 2 8</table>
  <output name="monotone" unit="N">m(u, w)</output>
  <output name="spline" unit="N">s(u, w)</output>
  <output name="straight" unit="N">l(u, w)</output>
  <output name="heldAt" unit="N">held(u, w)</output>
  <output name="twisted">twoByTwo(u, w)</output>
</system>
"""
# A particle in the potential of the table of x and y, in the interior and beyond the border, where the table has kinks.
HOLLOW = """<system name="{name}">
  <parameter name="m" start="2"/>
  <table name="U" arguments="2" interpolation="{kind}">
{plain}
</table>
  <coordinate name="x" velocity="vx" start="0.1"/><coordinate name="y" velocity="vy" start="1.2"/>
  <particle mass="m" x="x" y="y"/>
  <potential>U(x, y) + x^2 + (y - 1.4)^2</potential>
  <output name="rate">der(U(x, y))</output>
  <solver method="{method}" tolerance="1e-9"/>
</system>
"""
HOLLOWS = {"HollowSpline": ("spline", "taylor"), "HollowMonotone": ("monotone", "radau"), "HollowTaylor": ("monotone", "taylor")}


@pytest.fixture(scope="module", autouse=True)
def built():
    grid = "# torque\n" + lines("17 ")
    text = lambda name: SURFACES.format(name=name, plain=lines(), word=lines("b/a; "))
    hollows = {name: HOLLOW.format(name=name, kind=kind, method=method, plain=lines()) for name, (kind, method) in HOLLOWS.items()}
    fmu.build_systems("surfaces", {"Surfaces": text("Surfaces"), **hollows}, files={"Surfaces/grid.csv": grid})
    fmu.build_systems("surfaces-tables", {"SurfaceTables": text("SurfaceTables")}, "--form", "tables", files={"SurfaceTables/grid.csv": grid})


def slopes(knots, rows):
    return np.array([PchipInterpolator(knots, row).derivative()(knots) for row in rows])


ALONG_X, ALONG_Y = slopes(X, VALUES), slopes(Y, VALUES.T).T
BOTH = (slopes(Y, ALONG_X.T).T + slopes(X, ALONG_Y)) / 2


def monotone(x, y, dx=0, dy=0):
    """Bicubic Hermite interpolation of values and PCHIP slopes along the grid lines."""
    i, j = (int(np.clip(np.searchsorted(k, v, "right") - 1, 0, len(k) - 2)) for k, v in ((X, x), (Y, y)))
    h, k = X[i + 1] - X[i], Y[j + 1] - Y[j]
    hermite = np.array([[1, 0, -3, 2], [0, 0, 3, -2], [0, 1, -2, 1], [0, 0, -1, 1]], float)

    def basis(t, order):
        return hermite @ [t**3 * 0 + 1, t, t**2, t**3] if order == 0 else hermite @ [0, 1, 2 * t, 3 * t**2]

    a = basis((x - X[i]) / h, dx) / h**dx * [1, 1, h, h]
    b = basis((y - Y[j]) / k, dy) / k**dy * [1, 1, k, k]
    cell = np.s_[j : j + 2, i : i + 2]
    return b @ np.block([[VALUES[cell], ALONG_X[cell]], [ALONG_Y[cell], BOTH[cell]]]) @ a


SPLINE = RectBivariateSpline(X, Y, VALUES.T)


def spline(x, y, dx=0, dy=0):
    return float(SPLINE(x, y, dx=dx, dy=dy)[0, 0])


def beyond(surface, x, y):
    """Extrapolate with the slopes at the border, in each argument separately."""
    a, b = np.clip(x, X[0], X[-1]), np.clip(y, Y[0], Y[-1])
    s, t = x - a, y - b
    return surface(a, b) + s * surface(a, b, 1, 0) + t * surface(a, b, 0, 1) + (s * t * surface(a, b, 1, 1) if s * t else 0)


POINTS = [(x, y) for x in X for y in Y] + [(x, y) for x in np.linspace(-1.6, 2.1, 12) for y in np.linspace(-0.7, 3.6, 11)]


@pytest.mark.parametrize("name", ["Surfaces", "SurfaceTables"])
def test_values_and_derivatives(name, open_fmu):
    instance = open_fmu(name).initialize()
    straight = RegularGridInterpolator((X, Y), VALUES.T, method="linear", bounds_error=False, fill_value=None)
    for x, y in POINTS:
        instance.set(u=x, w=y)
        values = instance.get("monotone", "spline", "straight", "heldAt", "twisted")
        held = spline(np.clip(x, X[0], X[-1]), np.clip(y, Y[0], Y[-1]))
        expected = [beyond(monotone, x, y), beyond(spline, x, y), straight([x, y])[0], held, 1 + x + y + 2 * x * y]
        np.testing.assert_allclose(values, expected, rtol=1e-12, atol=1e-12)
        if X[0] < x < X[-1] and Y[0] < y < Y[-1]:
            for known, order in (("u", (1, 0)), ("w", (0, 1))):
                along = instance.fmu.getDirectionalDerivative(instance.vr("monotone", "spline"), instance.vr(known), [1.0])
                np.testing.assert_allclose(along, [monotone(x, y, *order), spline(x, y, *order)], rtol=1e-11, atol=1e-11)


def test_it_is_monotone_on_its_lines(open_fmu):
    """Between two knots of a grid line the value stays between theirs."""
    instance = open_fmu("Surfaces").initialize()
    for j, y in enumerate(Y):
        for i in range(len(X) - 1):
            ends = sorted(VALUES[j, i : i + 2])
            for x in np.linspace(X[i], X[i + 1], 7):
                instance.set(u=x, w=y)
                assert ends[0] - 1e-12 <= instance.get("monotone") <= ends[1] + 1e-12


@pytest.mark.parametrize("name", HOLLOWS)
def test_energy_in_a_potential(name, open_fmu):
    instance = open_fmu(name).initialize({"vx": 1.3, "vy": -0.8})
    surface = spline if HOLLOWS[name][0] == "spline" else monotone
    energy = instance.get("totalEnergy")
    for _ in range(40):
        instance.step(0.1)
        x, y, vx, vy = instance.get("x", "y", "vx", "vy")
        assert instance.get("totalEnergy") == pytest.approx(energy, abs=1e-6)
        potential = beyond(surface, x, y) + x**2 + (y - 1.4) ** 2
        assert vx**2 + vy**2 + potential == pytest.approx(energy, abs=1e-6)
        if X[0] < x < X[-1] and Y[0] < y < Y[-1]:
            force = np.array([surface(x, y, 1, 0) + 2 * x, surface(x, y, 0, 1) + 2 * (y - 1.4)])
            np.testing.assert_allclose(instance.get("der(vx)", "der(vy)"), -force / 2, atol=1e-10)
            assert instance.get("rate") == pytest.approx(surface(x, y, 1, 0) * vx + surface(x, y, 0, 1) * vy, abs=1e-10)


@pytest.mark.parametrize("table, message", [
    ("<table name='f' arguments='2' file='no.csv'/>", "the file 'no.csv' cannot be read: No such file or directory"),
    ("<table name='f' arguments='2' file='short.csv'/>", "short.csv:3: '1 2' has 2 numbers; expected 3, a knot of the second argument and the values"),
    ("<table name='f' arguments='2' file='word.csv'/>", "word.csv:2: '0 1 two' has 2 numbers; expected 3"),
    ("<table name='f' arguments='2' file='back.csv'/>", "back.csv:3: the knot 0 does not follow 1; expected finite numbers, each larger"),
    ("<table name='f' arguments='2' file='head.csv'/>", "head.csv:2: the knot 1 does not follow 1; expected finite numbers, each larger"),
    ("<table name='f' arguments='2' file='huge.csv'/>", "huge.csv:2: the value inf is not finite"),
    ("<table name='f' arguments='2' file='large.csv'/>", "large.csv:32: the table has more than 1000 values"),
    ("<table name='f' arguments='2'>0 1 2 3 4 x</table>", "'x' is not a number; expected the knots of the first argument in the first line"),
    ("<table name='f' arguments='2'><point x='0' y='1'/></table>", "the table 'f' of two arguments has a &lt;point&gt;; expected lines, or a file"),
    ("<table name='f' arguments='3' file='ok.csv'/>", "arguments=\"3\" of <table> is not known; expected 1 or 2"),
    ("<table name='f' arguments='2' file='ok.csv'/><potential>f(x)</potential>", "expected ',' between the two arguments of a table, found ')'"),
    ("<table name='f' arguments='2' file='ok.csv'/><potential>f(x, 1, 2)</potential>", "expected ')' after the two arguments of a table, found ','"),
    ("<table name='f' arguments='2' file='ok.csv' argumentUnit='m' secondArgumentUnit='s' unit='J'/><potential>f(x, x)</potential>",
     "unit mismatch: the second argument of 'f' has the unit m, expected s"),
    ("<table name='f' arguments='2' file='ok.csv' argumentUnit='s' unit='J'/><potential>f(x, 1)</potential>", "unit mismatch: the first argument of 'f' has the unit m, expected s"),
])  # fmt: skip
def test_errors(table, message, tmp_path):
    files = {"ok.csv": "0 1\n0 1 2\n1 3 4\n", "short.csv": "0 1\n0 1 2\n1 2\n", "word.csv": "0 1\n0 1 two\n",
             "back.csv": "0 1\n1 1 2\n0 3 4\n", "head.csv": "1 1\n0 1 2\n", "huge.csv": "0 1\n0 1 1e999\n",
             "large.csv": " ".join(map(str, range(33))) + "\n" + "".join(f"{i}" + " 0" * 33 + "\n" for i in range(33))}  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    text = f'<system name="Refused">\n<coordinate name="x" velocity="v" unit="m"/><particle mass="2" x="x"/>{table}</system>'
    (tmp_path / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message.replace("&lt;", "<").replace("&gt;", ">") in result.stderr, result.stderr
