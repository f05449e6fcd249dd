"""<line>: drawn lines are where the mechanism is, leave the equations unchanged, and bad ones get a message."""

import math
import re
import xml.etree.ElementTree as ElementTree

import pytest

import fmu
from chromium import look_at
from fmu import ROOT, lagc
from scripts.library.live_page.description import scene_of

SYSTEMS = sorted(path.parent.name for path in (ROOT / "fmu").glob("*/system.xml"))
PENDULUM = """<system name="Swing">
  <parameter name="l" start="2" unit="m" min="0"/> <parameter name="w" start="9.81" unit="kg.m/s2"/>
  <coordinate name="theta" velocity="omega" unit="rad" start="0.3"/>
  <particle name="bob" mass="1" x="l*sin(theta)" y="-l*cos(theta)"/>
  <potential>w*bob.y</potential>
  {}
</system>"""


def written(folder, text):
    """Return modelDescription.xml that lagc writes for a system."""
    (folder / "system.xml").write_text(text)
    result = lagc(folder / "system.xml", "-o", folder)
    assert (result.returncode, result.stderr) == (0, "")
    return ElementTree.parse(folder / "modelDescription.xml").getroot()


def lines_of(tree):
    return [thing for thing in scene_of(tree) if thing["tag"] == "line"]


def position(line, end, values):
    """Position of an end (1 or 2) that formulas give; values: by name."""
    names = {name.replace("[", "_").replace("]", ""): value for name, value in values.items()}
    functions = {name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt")}
    python = lambda formula: re.sub(r"\[(\d+)\]", r"_\1", formula).replace("^", "**")  # noqa: E731
    return [eval(python(line.get(f"{axis}{end}", "0")), functions | names) for axis in "xyz"]


def kinds(name, folder):
    result = lagc(ROOT / "fmu" / name / "system.xml", "-o", folder)
    assert result.returncode == 0, result.stderr
    lines = lines_of(ElementTree.parse(folder / "modelDescription.xml").getroot())
    return {kind: [line for line in lines if line["kind"] == kind] for kind in {line["kind"] for line in lines}}


def test_rods_of_a_linkage(tmp_path):
    """Crank, coupler and rocker from pivot to pivot, by the triangles of a posture that closes the loop."""
    a, b, c, d, theta = 0.3, 0.8, 0.6, 0.9, 0.7
    crank = (a * math.cos(theta), a * math.sin(theta))
    away = math.hypot(d - crank[0], crank[1])
    # The angle at the crank's end between the line to the rocker's pivot and the coupler, by the law of cosines.
    phi = math.atan2(-crank[1], d - crank[0]) + math.acos((b * b + away * away - c * c) / (2 * b * away))
    joint = (crank[0] + b * math.cos(phi), crank[1] + b * math.sin(phi))
    psi = math.atan2(joint[1], joint[0] - d)
    drawn = kinds("FourBar", tmp_path)
    values = {"a": a, "b": b, "c": c, "d": d, "theta": theta, "phi": phi, "psi": psi}
    ends = [[position(rod, end, values)[:2] for end in (1, 2)] for rod in drawn["rod"]]
    assert drawn["rod"][0]["from"] == "" and ends[0][1] == pytest.approx(crank)
    assert ends[1] == [pytest.approx(crank), pytest.approx(joint)] and ends[2] == [pytest.approx([d, 0]), pytest.approx(joint)]
    assert [one.get("from", one.get("x1")) for one in drawn["pivot"]] == ["", "d"]


def test_feet_and_slope_of_the_walker(tmp_path):
    """At the strike of the symmetric posture both feet are on the slope, a step 2 l sin(angle/2) apart."""
    slope, half, l = 0.05, 0.3, 1.0
    stance, swing = half - slope, -half - slope
    values = {"a": 0.5, "b": 0.5, "slope": slope, "thetaStance": stance, "thetaSwing": swing, "hip": None, "foot": 0.7}
    standing = (0.7, -0.7 * math.tan(slope))
    drawn = kinds("PassiveWalker", tmp_path)
    hip = (standing[0] - l * math.sin(stance), standing[1] + l * math.cos(stance))
    class Point:
        x, y = hip
    foot = position(drawn["rod"][1], 2, values | {"hip": Point})[:2]
    assert (drawn["rod"][0]["to"], drawn["rod"][1]["from"]) == ("hip", "hip")
    assert position(drawn["rod"][0], 1, values)[:2] == pytest.approx(standing)
    # The swing leg is at -half - slope: it trails by 2*half.
    assert foot == pytest.approx([standing[0] - 2 * l * math.sin(half) * math.cos(slope), standing[1] + 2 * l * math.sin(half) * math.sin(slope)])
    left, right = (position(drawn["ground"][0], end, values) for end in (1, 2))
    assert math.atan2(left[1] - right[1], right[0] - left[0]) == pytest.approx(slope)
    assert left[1] == pytest.approx(-left[0] * math.tan(slope))


def test_threads_of_the_cradle(tmp_path):
    """Five threads hang from points a ball's diameter apart."""
    threads = kinds("NewtonsCradle", tmp_path)["rope"]
    assert [position(thread, 1, {"d": 0.04}) for thread in threads] == [pytest.approx([0.04 * i, 0, 0]) for i in (-2, -1, 0, 1, 2)]
    assert [thread["to"] for thread in threads] == [f"ball[{i}]" for i in range(1, 6)]


def test_the_wheels_of_the_cart_roll(tmp_path):
    """The spoke of a wheel of radius 0.03 m turns by x/r clockwise."""
    wheel = kinds("InvertedPendulumCart", tmp_path)["wheel"][1]
    for x in (0.0, 0.02, -0.3):
        hub, rim = (position(wheel, end, {"x": x}) for end in (1, 2))
        assert hub == pytest.approx([x + 0.1, -0.06, 0])
        assert math.atan2(rim[1] - hub[1], rim[0] - hub[0]) == pytest.approx(math.remainder(-x / 0.03, 2 * math.pi), abs=1e-9)


def test_names_vectors_and_loops(tmp_path):
    """Ends are names, vectors and numbers; lines of included files have the names of the part."""
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "system.xml").write_text(PENDULUM.format('<line kind="rope" from="base" to="bob"/>'))
    tree = written(tmp_path, """<system name="Both">
  <parameter name="h" start="0.5" unit="m" min="0"/>
  <include file="part/system.xml" as="one"/>
  <coordinate name="q" velocity="w" unit="rad"/>
  <frame name="arm"><translate x="h"/><rotate axis="z" angle="q"/></frame>
  <body name="bar" in="arm" mass="1" x="0.1" Izz="1"/>
  <for index="i" from="1" to="2"><line kind="rod" from="i*h, max(h, 0.1), 0.2" to="one.bob + i*h*arm.axisX" radius="h/10"/></for>
  <line kind="hoop" axis="x" from="bar" to="0, h" color="#ff8000" trail="true"/>
</system>""")  # fmt: skip
    rope, first, second, hoop = lines_of(tree)
    assert (rope["from"], rope["to"], hoop["from"], hoop["axis"], hoop["color"], hoop["trail"]) == ("", "one.bob", "bar", "x", "#ff8000", "true")
    assert (first["x1"], second["x1"], first["z1"], first["radius"]) == ("h", "2*h", "0.2", "h/10")
    names = {variable.get("name") for variable in tree.find("ModelVariables")}
    used = {name for line in (first, second, hoop) for end in ("x1", "y1", "x2", "y2") for name in re.findall(r"[a-z][\w.]*", line.get(end, ""), re.I)}
    assert used - {"sin", "cos", "max"} <= names and {"h", "q"} <= used | {"q"}


SPRINGS = """<system name="Springs">
  <parameter name="k" start="9" unit="N/m" min="0"/> <parameter name="J" start="0.4" unit="kg.m2" min="0"/>
  <coordinate name="x" velocity="v" unit="m" start="1"/> <coordinate name="q" velocity="w" unit="rad"/>
  <frame name="slide"><translate x="x"/><rotate axis="z" angle="q"/></frame>
  <body name="ball" in="slide" mass="1" Ixx="J" Iyy="J" Izz="J"/>
  <spring from="base" to="ball" stiffness="k" length="0.5"/>
  {}
</system>"""


def test_springs_are_coils_without_lines(tmp_path):
    """A <spring> is drawn beside guessed lines; where the author draws lines, it is not drawn twice. A body with equal moments is a ball."""
    (spring,) = lines_of(written(tmp_path, SPRINGS.format("")))
    assert (spring["kind"], spring["from"], spring["to"], spring["guessed"]) == ("spring", "", "ball", "true")
    points = "view => view.document.querySelector('.sketch .solid').getAttribute('points').split(' ').map(point => point.split(',').map(Number))"
    [corners] = look_at([tmp_path / "documentation" / "index.html"], tmp_path, [1200], points).values()
    middle = [(min(corner[i] for corner in corners) + max(corner[i] for corner in corners)) / 2 for i in (0, 1)]
    radii = [math.dist(corner, middle) for corner in corners]
    assert max(radii) == pytest.approx(min(radii), rel=0.01) and max(radii) > 5
    described = lines_of(written(tmp_path, SPRINGS.format('<line kind="rope" from="base" to="ball"/>')))
    assert [line["kind"] for line in described] == ["rope"]


def without_lines(text):
    return re.sub(r"<line\b[^>]*/>", "", text)


@pytest.mark.long
def test_equations_are_those_without_lines(tmp_path):
    """The C of every system is the same with and without lines, except for the identifier of its description. Expressions of lines cost nothing."""
    for name in SYSTEMS:
        source = (ROOT / "fmu" / name / "system.xml").read_text(encoding="utf-8")
        (tmp_path / name).mkdir()
        (tmp_path / name / "system.xml").write_text(without_lines(source), encoding="utf-8")
    for name in SYSTEMS:
        code = []
        for path in (ROOT / "fmu" / name / "system.xml", tmp_path / name / "system.xml"):
            assert lagc(path, "-o", tmp_path / "out").returncode == 0
            code.append(re.sub(r"(?m)^#define GUID .*$", "", (tmp_path / "out" / "system.c").read_text()))
        assert code[0] == code[1], name


@pytest.mark.parametrize("line, message", [
    ('kind="rod" from="bob"', 'the rod has no second end; expected to="..."'),
    ('kind="pivot" from="bob" to="base"', "a pivot has one end; expected no 'to'"),
    ('kind="belt" from="base" to="bob"', 'the belt has no radius; expected radius="..." in m, that of its pulleys'),
    ('kind="hoop" from="base" to="bob" radius="l"', "a hoop has no radius of its own; expected none, as it is the distance of its ends"),
    ('kind="rope" from="base" to="bob" radius="l"', "a rope has no radius of its own; expected none"),
    ('kind="rod" from="base" to="bob" axis="x"', "a rod takes no axis; remove the attribute"),
    ('kind="rod" from="base" to="bob" radius="-1"', "the radius of <line> is -1 m; expected a positive number"),
    ('kind="rod" from="base" to="bob" radius="theta"', "radius of <line> cannot depend on coordinates, but 'theta' does; expected numbers and parameters"),
    ('kind="string" from="base" to="bob"', "kind=\"string\" of <line> is not known; did you mean 'spring'?"),
    ('kind="rod" from="bobb" to="base"', "from of <line>: there is no point 'bobb'; expected the name of a <particle>, <body>, <point> or <frame>, or base"),
    ('kind="rod" from="2" to="base"', "from of <line> is a single number; expected two or three, such as x, y, or the name of a point"),
    ('kind="rod" from="0, 1, 2, 3" to="base"', "from of <line> has 4 numbers; expected two or three, such as x, y"),
    ('kind="rod" from="theta, l" to="base"', "unit mismatch: from of <line> has the unit rad, expected m"),
    ('kind="rod" to="base"', "<line> needs the attribute 'from'; expected from=\"...\""),
    ('kind="rod" from="base" to="bob" color="red"', 'color="red" of <line> is not a color; expected one such as #ff8000, or #ff800080'),
])  # fmt: skip
def test_messages(tmp_path, line, message):
    (tmp_path / "system.xml").write_text(PENDULUM.format(f"<line {line}/>"))
    result = lagc(tmp_path / "system.xml", "-o", tmp_path / "out")
    assert result.returncode == 1 and result.stderr.strip() == f"{tmp_path / 'system.xml'}:6: {message}"


def test_a_formula_may_not_be_endless(tmp_path):
    """For an end whose expression grows with each link, the message asks for a name."""
    chain = '<define name="p" unit="m">l*sin(theta)</define>' + "".join(
        f'<define name="p{i}" unit="m">{"p" if i == 0 else f"p{i - 1}"}*cos({"p" if i == 0 else f"p{i - 1}"}/l)</define>' for i in range(14)
    )
    (tmp_path / "system.xml").write_text(PENDULUM.format(f'{chain}<line kind="rod" from="base" to="p13, l"/>'))
    result = lagc(tmp_path / "system.xml", "-o", tmp_path / "out")
    assert result.returncode == 1
    assert result.stderr.strip().endswith("to of <line> is a formula of more than 4000 characters; expected the name of a <point> there")
