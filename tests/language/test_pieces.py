"""
abs, if, tables and other piecewise functions wherever expressions may stand: in constraints, displacements, and outputs that forces use.
"""

import itertools
import subprocess

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from scipy.interpolate import CubicSpline
from scipy.integrate import quad, solve_ivp

import fmu
from fmu import DISCARD, ERROR, build_systems, lagc

METHODS = ["taylor", "erk", "radau", "bdf", "auto"]


def by_turns(cases):
    """Pair each case with two of the methods, so that the methods share the cases equally."""
    return [(case, METHODS[(2 * i + k) % len(METHODS)]) for i, case in enumerate(cases) for k in (0, 1)]


G = 9.81

# A bead on a curve y = f(x) that is straight up to x = 0, released at x = -1 with speed 2.
BEAD = """
<system name="{name}">
  <coordinate name="x" velocity="v" start="-1" velocityStart="{speed}"/>
  <coordinate name="y" velocity="w" start="{y}"/>
  {before}
  <particle mass="1" x="x" y="y"/>
  <potential>9.81*y</potential>
  <constraint name="curve">{constraint}</constraint>
  <solver method="{method}" tolerance="1e-10"/>
</system>
"""
CURVES = {"Max": "y - max(x, 0)^3", "If": "y - if(x &gt; 0, x^3, 0)", "Defined": "hidden"}
KNOTS = [(-3, 1.5), (-1.5, 0.3), (-0.6, 0.1), (0.2, 0), (1, 0.7), (3, 2.5)]
CAM = "<table name='cam' interpolation='spline'>" + "\n".join(f"{x} {y}" for x, y in KNOTS) + "</table>"
# Constraint functions that are not smooth.
KINKS = {
    "Fold": ("y - abs(x)", 1, "abs, line"),
    "Step": ("y - if(x &gt; 0, 1, 0)", 0, "a condition, line"),
    "Bend": ("y - if(x &gt; 0, 1e-4*x, 0)", 0, "a condition, line"),
    "Polygon": ("y - rail(x)", 0, "a table, line"),
    "Named": ("y - hidden", 1, "abs, line"),
}
RAIL = "<table name='rail' interpolation='linear'>\n-5 0\n0 0\n5 0.01</table>"

# A force of 1 towards 0 through an output: parabolas in time, with the period 4 sqrt(2 x0).
PUSHED = """
<system name="{name}">
  <coordinate name="x" velocity="v" start="0.7"/>
  <particle mass="1" x="x"/>
  <output name="push">{push}</output>
  <force coordinate="x">push</force>
  <solver method="{method}"/>
</system>
"""
FORCES = {"If": "if(x &lt; 0, 1, -1)", "Sign": "-sign(x)", "Curve": "steps(x)"}

# A mass hangs by a rod from a bead on a rail with a step. The rod is consistent until the bead is moved onto the step.
HUNG = """
<system name="Hung">
  <coordinate name="x" velocity="v" start="-0.5" velocityStart="1"/>
  <coordinate name="y" velocity="w"/>
  <coordinate name="p" velocity="vp" start="-0.3"/>
  <coordinate name="q" velocity="vq" start="-1"/>
  <particle mass="1" x="x" y="y"/>
  <particle mass="1" x="p" y="q"/>
  <gravity y="-9.81"/>
  <constraint name="rail">y - if(x &gt; 0, 1e-3, 0)</constraint>
  <constraint name="rod">(p - x)^2 + (q - y)^2 - 1</constraint>
</system>
"""

# A displacement in piecewise functions with kinks and table knots.
STRETCHED = """
<system name="Stretched">
  <parameter name="k" start="2"/>
  <coordinate name="x" velocity="v" start="2.5"/>
  <displacement name="s"/>
  <particle mass="1" x="x"/>
  <potential>abs(x + s) + 3*abs(x - k + s)^2 + s*abs(x - 3*k) + if(x + 2*s &lt; 1, 5*(1 - x - 2*s)^2, 0)</potential>
  <output name="rate">der(abs(x)) + der(max(x^2, k)) + der(min(x^3, 1))</output>
  <output name="decided">if(s.force &lt; -3, 1, 2)</output>
</system>
"""

# A slider in a slot, pressed to alternate sides.
PRESSED = """
<system name="Pressed{method}">
  <coordinate name="x" velocity="v"/>
  <coordinate name="y" velocity="w" start="0.5"/>
  <particle mass="1" x="x" y="y"/>
  <force coordinate="x">4</force>
  <force coordinate="y">9.81*cos(2*time)</force>
  <constraint name="slot">y - 0.5</constraint>
  <friction name="sides" coordinate="x" force="0.3*abs(slot.force)"/>
  <solver method="{method}"/>
</system>
"""

# A force that starts at t = 0.5.
LATE = """
<system name="Late{method}">
  <coordinate name="x" velocity="v" start="-1" velocityStart="2"/>
  <particle mass="1" x="x"/>
  <potential>max(x, 0)^3</potential>
  <solver method="{method}" tolerance="{tolerance}"/>
</system>
"""


def bead(name, constraint, method="taylor", y=0, speed=2, before=""):
    if "hidden" in constraint:
        before += '<define name="hidden">%s</define>' % ("y - if(x &gt; 0, x^3, 0)" if constraint == "hidden" else "abs(x)")
    return BEAD.format(name=name, constraint=constraint, method=method, y=y, speed=speed, before=before)


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"Stretched": STRETCHED, "Cam": bead("Cam", "y - cam(x)", y=0, before=CAM)}
    for curve, method in by_turns(CURVES):
        name = f"Bead{curve}{method.title()}"
        texts[name] = bead(name, CURVES[curve], method)
    for kink, method in by_turns(KINKS):
        name, (text, y, _) = f"{kink}{method.title()}", KINKS[kink]
        texts[name] = bead(name, text, method, y, before=RAIL)
    for push, method in by_turns(FORCES):
        name = f"Pushed{push}{method.title()}"
        table = "<table name='steps'>\n-9 1\n-1e-9 1\n1e-9 -1\n9 -1</table>" if push == "Curve" else ""
        texts[name] = PUSHED.format(name=name, push=FORCES[push], method=method).replace("<particle", table + "<particle")
    for method in METHODS:
        texts[f"Pressed{method}"] = PRESSED.format(method=method)
        texts[f"Late{method}"] = LATE.format(method=method, tolerance=1e-10)
    build_systems("pieces", texts | {"Hung": HUNG})


def along_curve(height, slope, curvature, x, speed, end):
    """x and its rate of the bead at `end`, by the equation in only x, from the height of the curve and its derivatives."""

    def rate(_, state):
        f, d = slope(state[0]), curvature(state[0])
        return [state[1], -f * (d * state[1] ** 2 + G) / (1 + f * f)]

    x_rate = speed / (1 + slope(x) ** 2)  # projection of the velocity (speed, 0) onto the curve
    return solve_ivp(rate, [0, end], [x, x_rate], rtol=1e-12, atol=1e-13, max_step=1e-3).y[:, -1]


@pytest.fixture(scope="module")
def bead_at_the_end():
    cubic = [lambda x: max(x, 0) ** 3, lambda x: 3 * max(x, 0) ** 2, lambda x: 6 * max(x, 0)]
    return along_curve(*cubic, -1, 2, 1.5)


@pytest.mark.long
@pytest.mark.parametrize("curve, method", by_turns(CURVES))
def test_a_constraint_has_pieces(open_fmu, bead_at_the_end, curve, method):
    instance = open_fmu(f"Bead{curve}{method.title()}").initialize()
    while instance.time < 1.5:
        instance.step(0.125)
        x, y = instance.get("x", "y")
        assert y == pytest.approx(max(x, 0) ** 3, abs=1e-12)
    assert instance.get("x", "v") == pytest.approx(bead_at_the_end, abs=1e-7)
    assert instance.get("totalEnergy") == pytest.approx(2, abs=1e-7)


@pytest.mark.parametrize("curve, method", by_turns(CURVES)[::2])
def test_a_constraint_has_pieces_in_model_exchange(bead_at_the_end, curve, method):
    archive = str(fmu.archive(f"Bead{curve}{method.title()}"))
    result = fmpy.simulate_fmu(archive, fmi_type="ModelExchange", stop_time=1.5, relative_tolerance=1e-10, output=["x", "v"])
    assert list(result[-1])[1:] == pytest.approx(bead_at_the_end, abs=1e-5)


def test_a_follower_runs_over_a_cam(open_fmu):
    """The bead follows SciPy's spline."""
    spline = CubicSpline(*zip(*KNOTS))
    instance = open_fmu("Cam").initialize({"x": -1, "y": float(spline(-1)), "v": 3, "w": 3 * float(spline(-1, 1))})
    assert instance.get("v") == pytest.approx(3, abs=1e-12)
    speed = 3 * (1 + spline(-1, 1) ** 2)
    expected = along_curve(spline, lambda x: spline(x, 1), lambda x: spline(x, 2), -1, speed, 0.9)
    assert np.ptp([-1, expected[0]]) > 1.3  # over several knots
    instance.run(0.9, 0.1, "x")
    assert instance.get("x", "v") == pytest.approx(expected, abs=1e-8)
    assert instance.get("y") == pytest.approx(spline(instance.get("x")), abs=1e-12)


@pytest.mark.parametrize("kink, method", by_turns(KINKS))
def test_a_kink_in_a_constraint_is_an_error(open_fmu, kink, method):
    """A kink in a constraint would make velocities jump, by no law that the system states."""
    instance = open_fmu(f"{kink}{method.title()}").initialize()
    with instance.fails(DISCARD, KINKS[kink][2] + r" \d+ of system.xml, has a kink or jump in the constraint 'curve'"):
        for _ in range(12):
            instance.step(0.125)
    assert instance.get("x") == pytest.approx(0, abs=1e-9)


def test_a_step_is_blamed_on_its_own_constraint(open_fmu):
    """The rod fulfils its constraint until the projection moves the bead."""
    instance = open_fmu("Hung").initialize()
    with instance.fails(DISCARD, r"a condition, line \d+ of system.xml, has a kink or jump in the constraint 'rail'"):
        instance.step(3.0)


@pytest.mark.parametrize("kink, method", by_turns(KINKS)[::2])
def test_a_kink_in_a_constraint_is_an_error_in_model_exchange(kink, method):
    messages = []
    logger = lambda *words: messages.append(words[-1].decode() if isinstance(words[-1], bytes) else words[-1])
    with pytest.raises(FMICallException) as raised:
        fmpy.simulate_fmu(str(fmu.archive(f"{kink}{method.title()}")), fmi_type="ModelExchange", stop_time=1.5, logger=logger)
    assert raised.value.status == ERROR
    assert any("has a kink or jump in the constraint 'curve'" in message for message in messages)


@pytest.mark.parametrize("push, method", by_turns(FORCES))
def test_a_force_by_way_of_an_output(open_fmu, push, method):
    instance = open_fmu(f"Pushed{push}{method.title()}").initialize(tolerance=1e-9)
    quarter = np.sqrt(2 * 0.7)
    for time in np.linspace(0.05, 9.7, 40):
        instance.step(time - instance.time)
        phase, s = divmod(time / quarter + 1, 2)  # half periods begin where x passes 0
        t = (s - 1) * quarter
        expected = (-1) ** phase * (0.7 - t**2 / 2)
        assert instance.get("x") == pytest.approx(expected, abs=1e-6)
        assert instance.get("push") == pytest.approx(-np.sign(expected), abs=1e-12)


def test_pieces_of_displaced_positions(open_fmu):
    instance = open_fmu("Stretched")
    for x, v in [(2.5, 0.3), (0.4, -1.1), (-0.7, 2.0), (7.5, 1.0), (1.2, 0.2)]:
        instance.reset().initialize({"x": x, "v": v})
        force = -(np.sign(x) + 6 * (x - 2) + abs(x - 6) + (-20 * (1 - x) if x < 1 else 0))
        rate = np.sign(x) * v + (2 * x * v if x * x > 2 else 0) + (3 * x * x * v if x**3 < 1 else 0)
        acceleration = -(np.sign(x) + 6 * (x - 2) + (-10 * (1 - x) if x < 1 else 0))
        assert instance.get("s.force", "rate", "der(v)") == pytest.approx([force, rate, acceleration], abs=1e-12)
        assert instance.get("decided") == (1 if force < -3 else 2)


def speed_in_slot(end):
    return quad(lambda t: 4 - 0.3 * G * abs(np.cos(2 * t)), 0, end, points=np.arange(1, 4) * np.pi / 4, limit=200)[0]


@pytest.mark.parametrize("method", METHODS)
def test_friction_by_the_size_of_a_force(open_fmu, method):
    """The argument of abs is a reaction force, an unknown of the equations that is not a function of only the state."""
    instance = open_fmu(f"Pressed{method}").initialize(tolerance=1e-9)
    while instance.time < 2.9:
        instance.step(0.17)
        assert instance.get("v") == pytest.approx(speed_in_slot(instance.time), abs=1e-6)
        assert instance.get("slot.force") == pytest.approx(G * np.cos(2 * instance.time), abs=1e-9)


def test_friction_by_the_size_of_a_force_in_model_exchange():
    archive = str(fmu.archive("Pressedtaylor"))
    result = fmpy.simulate_fmu(archive, fmi_type="ModelExchange", stop_time=3, relative_tolerance=1e-9, output=["v"])
    assert result["v"][-1] == pytest.approx(speed_in_slot(3), abs=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_an_event_next_to_a_communication_point(open_fmu, method):
    """A step reaches its end however soon it follows an event."""
    instance = open_fmu(f"Late{method}")
    for ulps in [0, 1, 2, 5, 8, 30, 100, 1000, -1, -2, -5, -300]:
        instance.reset().initialize()
        instance.step(0.5 + ulps * 2.0**-53)
        instance.step(0.7)
        instance.step(0.3)
        assert instance.get("totalEnergy") == pytest.approx(2, abs=1e-8)


# --- Every function in every position ---

PLACES = {
    "kinetic": "<kinetic>(1 + {})*v^2/2</kinetic>",
    "potential": "<potential>{}</potential>",
    "force": '<force coordinate="x">{}</force><work/>',
    "dissipation": "<dissipation>(1 + {})*v^2</dissipation>",
    "position": '<particle mass="1" x="{}" y="x"/>',
    "output": '<output name="o">{}</output><force coordinate="y">v</force>',
    "rate": '<define name="e">{}</define><output name="o">der(e)</output><potential>e*x</potential>',
    "constraint": '<constraint name="E">y - {}</constraint>',
    "friction": '<friction name="F" velocity="v" force="{}"/>',
    "stiction": '<friction name="F" velocity="v" force="1" stiction="1 + {}"/>',
    "along": '<friction name="F" velocity="{}*v" force="1"/>',
    "gap": '<contact name="G" gap="{} + 5"/>',
    "restitution": '<contact name="G" gap="x + 10" restitution="{}"/>',
    "when": '<event when="{} - 0.2"><set velocity="v">-v</set></event>',
    "condition": '<event when="{} &gt; 0.5"><set velocity="v">-v</set></event>',
    "set": '<event when="x - 1"><set velocity="v">{}</set></event>',
    "mode": '<event when="x - 1"><set mode="m">{}</set></event>',
    "on": '<force on="P" x="{}" y="0"/>',
    "stop": '<stop coordinate="x" max="{} + 4"/>',
}
FUNCTIONS = ["{}", "abs({} - 0.3)", "if({} &gt; 0.1 and x &lt; 3, x, 2)", "table({})"]
OPERANDS = "k u x v s x+s m der(v) s.force C.force der(x*s) byVelocity byAcceleration byDisplacement byForce byInput reported P.x".split()
PLACED = """
<system name="A">
  <parameter name="k" start="2"/>
  <input name="u" derivatives="2"/>
  <coordinate name="x" velocity="v" start="1"/>
  <coordinate name="y" velocity="w" start="2"/>
  <displacement name="s"/>
  <mode name="m" start="1"/>
  <define name="byVelocity">sign(v)*k</define>
  <define name="byAcceleration">max(der(v), 1)</define>
  <define name="byDisplacement">sign(s - 1)</define>
  <define name="byForce">if(s.force &gt; 1, x, 2)</define>
  <define name="byInput">sign(u)</define>
  <output name="reported">if(x &gt; 0.5, x, 1) + abs(y)</output>
  <table name="table" interpolation="linear">
    0 0
    1 2
    4 7
  </table>
  <particle name="P" mass="1" x="x + s" y="y"/>
  <potential>x^2 + y^2</potential>
  {element}
</system>
"""


THIRDS = [0, pytest.param(1, marks=pytest.mark.release), pytest.param(2, marks=pytest.mark.release)]


@pytest.mark.long
@pytest.mark.parametrize("third", THIRDS)
@pytest.mark.parametrize("place", PLACES)
def test_accepted_systems_compile(tmp_path, place, third):
    """
    lagc reports an error or writes C that compiles, for all combinations. Each run takes a third of them, a different third for each
    position.
    """
    taken = 0
    combinations = list(itertools.product(FUNCTIONS, OPERANDS))
    for i, (function, operand) in list(enumerate(combinations))[(third + list(PLACES).index(place)) % 3 :: 3]:
        element = PLACES[place].format(function.format(operand))
        element += '<constraint name="C">y - 2*x</constraint>' if operand == "C.force" else ""
        (tmp_path / "system.xml").write_text(PLACED.format(element=element))
        result = lagc("system.xml", "-o", str(i), cwd=tmp_path)
        assert result.returncode in (0, 1), (element, result.stderr)
        assert (result.returncode == 0) == (result.stderr == ""), (element, result.stderr)
        taken += result.returncode == 0
    assert taken >= 1
    sources = sorted(tmp_path.glob("*/system.c"))
    assert len(sources) == taken
    words = ["gcc", "-std=c11", "-fsyntax-only", "-Wall", f"-I{fmu.ROOT / 'include'}", f"-I{fmu.ROOT / 'src' / 'runtime'}"]
    compiled = subprocess.run([*words, "-Werror", "-Wno-unused", *sources], capture_output=True, text=True)
    assert compiled.returncode == 0, compiled.stderr[:2000]


@pytest.mark.parametrize("name, place, kind", [
    ("byVelocity", "position", "velocities"), ("byVelocity", "gap", "velocities"), ("byAcceleration", "potential", "accelerations"),
    ("byForce", "force", "forces of reaction"), ("byDisplacement", "friction", "displacements"), ("byInput", "force", None),
])  # fmt: skip
def test_what_decides_on_a_piece_counts(tmp_path, name, place, kind):
    """A position must not depend on a velocity, even through the condition of a piecewise function."""
    (tmp_path / "system.xml").write_text(PLACED.format(element=PLACES[place].format(name)))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    if kind is None:
        assert result.returncode == 0, result.stderr
    else:
        assert result.returncode == 1 and f"cannot depend on {kind}, but '{name}' does" in result.stderr
