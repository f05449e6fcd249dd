"""Contacts in MJCF: friction, masks, priorities, pairs; and contacts that exist only in MuJoCo."""

import math
import re

import pytest

from building import build_systems
from fmu import lagc

pytestmark = pytest.mark.long

ANGLE, DURATION, G = 0.3, 2.0, 9.81
BOX = '<body name="{0}" pos="0 {1} 0.1"><freejoint/><geom name="g{0}" type="box" size="0.2 0.2 0.1" {2}/></body>'
# Attributes of a box, elements beside it, and its coefficient of sliding friction; None if it falls.
BOXES = {
    "rough": ('friction="0.2"', 0.2),
    "smooth": ('friction="0.02"', 0.05),
    "prior": ('friction="0.02" priority="1"', 0.02),
    "frictionless": ('friction="0.3" condim="1" priority="2"', 0.0),
    "spinning": ('friction="0.15 0.1 0.1" condim="6"', 0.15),
    "apart": ('contype="2" conaffinity="4"', None),
    "near": ('friction="0.1" contype="2" conaffinity="1"', 0.1),
    "paired": ('contype="0" conaffinity="0"', 0.12),
    "excluded": ('friction="0.1"', None),
}
SLOPE = f"""<mujoco model="slope"><option gravity="{G * math.sin(ANGLE)} 0 {-G * math.cos(ANGLE)}"/><worldbody>
{"".join(BOX.format(name, 3 * i, what) for i, (name, (what, _)) in enumerate(BOXES.items()))}
<geom name="floor" type="plane" size="1 1 1" friction="0.05"/></worldbody>
<contact><pair geom1="gpaired" geom2="floor" friction="0.12 0.12"/><exclude body1="excluded" body2="world"/></contact></mujoco>"""
ROUGH = SLOPE.replace('friction="0.05"', "").replace('<contact>', '<contact><exclude body1="rough" body2="smooth"/>')
SYSTEM = '<system name="{}"><include file="slope.xml" as="r" ground="true"{}</system>'
SET = '><parameter name="ground_friction" start="0.25"/></include>'
SYSTEMS = {"Slope": SYSTEM.format("Slope", "/>"), "Rough": SYSTEM.format("Rough", "/>"), "Same": SYSTEM.format("Same", SET)}
SYSTEMS["Touch"] = '<system name="Touch"><include file="touch.xml" as="r" self="true"/></system>'

# Boxes that stand without a gap on a plane in a body that does not move.
STANDING = """<mujoco model="standing"><worldbody><body pos="0 0 0.4" euler="180 0 0"><body name="floor" euler="180 0 0" pos="0 0 0.4"><geom type="plane" size="1 1 1"/></body></body>
{}</worldbody></mujoco>""".format("".join(f'<body name="b{i}" pos="{i} 0 0.1"><freejoint/><geom type="box" size="0.2 0.2 0.1" mass="1"/></body>' for i in range(10)))
SYSTEMS["Standing"] = '<system name="Standing"><include file="standing.xml" as="r" ground="true"/></system>'
SYSTEMS["Walled"] = '<system name="Walled"><include file="walled.xml" as="r" ground="true" self="true"/></system>'
SYSTEMS["Pile"] = """<system name="Pile"><include file="pile.xml" as="r" ground="true"/>
  <contact name="pile" between="r.high_collision1" and="r.low_collision1" stiffness="1e4" damping="1" friction="0.5"/></system>"""
PILE = """<mujoco model="pile"><worldbody><geom type="plane" size="1 1 1"/>
<body name="low" pos="0 0 0.1"><freejoint/><geom type="box" size="0.2 0.2 0.1" mass="2"/></body>
<body name="high" pos="0 0 0.31"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="1"/></body></worldbody></mujoco>"""
# A ball in a corner of three planes, two of which are walls.
WALLED = """<mujoco model="walled"><option gravity="4 3 -9.81"/><default><geom type="plane" size="1 1 1" friction="0"/></default><worldbody>
<body name="corner" pos="0.5 0 0" euler="0 -90 0"><geom name="wall"/></body><geom/><frame pos="0 0.4 0"><geom zaxis="0 -1 0"/></frame>
<body name="b" pos="0 0 0.1"><freejoint/><geom type="sphere" size="0.1" mass="2" friction="0"/></body></worldbody></mujoco>"""
# Two spheres on each other on a table, a capsule across another one, and two spheres that touch nothing. One slides with a part on it.
TOUCH = """<mujoco model="touch"><default><joint type="slide" axis="0 0 1"/></default><worldbody>
<geom type="box" size="1 1 0.5" pos="0 0 -0.5"/><geom type="capsule" fromto="3 -1 0 3 1 0" size="0.1"/>
<body name="one" pos="0 0 0.1"><joint name="one"/><geom size="0.1" mass="2"/></body>
<body name="two" pos="0 0 0.3"><joint name="two"/><geom size="0.1" mass="3"/></body>
<body name="rod" pos="3 0 0.2"><joint name="rod"/><geom type="capsule" fromto="-0.5 0 0 0.5 0 0" size="0.1" mass="1"/></body>
<body name="excluded" pos="0.5 0 0.1"><joint name="excluded"/><geom size="0.1" mass="1"/></body>
<body name="masked" pos="-0.5 0 0.1"><joint name="masked"/><geom size="0.1" mass="1" contype="2" conaffinity="2"/></body>
<body name="skid" pos="0 0.6 0.1"><joint name="along" axis="1 0 0"/><joint name="skid"/><geom size="0.1" mass="1" friction="0.3" priority="1"/>
<body name="fin" pos="0 0 0.1"><joint name="fin" type="hinge"/><geom size="0.08" mass="0.5" contype="4" conaffinity="1"/></body></body>
</worldbody><contact><exclude body1="excluded" body2="world"/></contact></mujoco>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    files = {"Slope/slope.xml": SLOPE, "Rough/slope.xml": ROUGH, "Same/slope.xml": SLOPE, "Touch/touch.xml": TOUCH, "Pile/pile.xml": PILE, "Walled/walled.xml": WALLED, "Standing/standing.xml": STANDING}
    build_systems("contacts_of_mjcf", SYSTEMS, files=files)


@pytest.mark.parametrize("gravity, acceleration", [("0 0 -1.62", 1.62), ("3 0 -4", 5), ("0 0 0", 9.81)])
def test_stiffness_follows_gravity(gravity, acceleration, tmp_path):
    """The stiffness bears the weight at 1 mm in the gravity of the file, or in that of the Earth if the file has none."""
    ball = '<body name="b"><freejoint/><geom name="ball" type="sphere" size="0.1" mass="2"/></body>'
    (tmp_path / "world.xml").write_text(f'<mujoco model="w"><option gravity="{gravity}"/><worldbody>{ball}<geom type="plane" size="1 1 1"/></worldbody></mujoco>')
    (tmp_path / "system.xml").write_text('<system name="S"><include file="world.xml" as="r" ground="true"/></system>')
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    [stiffness] = re.findall('name="r.ground_stiffness"[^>]*>\\s*<Real[^>]* start="([^"]*)"', (tmp_path / "out" / "modelDescription.xml").read_text())
    assert float(stiffness) == pytest.approx(2 * acceleration / 1e-3, abs=1)


def slides(instance, coefficients):
    """Check that from rest each box slides by Coulomb's law, or falls freely; the ground yields by less than 1 mm."""
    for name, friction in coefficients.items():
        x, z = instance.get(f"r.{name}_x"), instance.get(f"r.{name}_z")
        expected = DURATION**2 / 2 * G * max(0, math.sin(ANGLE) - (friction or 0) * math.cos(ANGLE))
        assert x == pytest.approx(expected, abs=0.01), name
        assert z == pytest.approx(0.1 if friction is not None else 0.1 - DURATION**2 / 2 * G * math.cos(ANGLE), abs=1e-3), name


@pytest.mark.parametrize(
    "system, coefficients",
    [
        ("Slope", {name: friction for name, (_, friction) in BOXES.items()}),
        # A plane without attributes has MuJoCo's coefficient of 1, so that boxes slide only by priority or a pair.
        ("Rough", {name: friction if name in ("prior", "frictionless", "paired") or friction is None else 1 for name, (_, friction) in BOXES.items()}),
        ("Same", {name: friction if friction is None else 0.25 for name, (_, friction) in BOXES.items()}),
    ],
)
def test_friction_and_masks(system, coefficients, open_fmu):
    instance = open_fmu(system).initialize(tolerance=1e-8)
    instance.run(DURATION, 0.1)
    slides(instance, coefficients)


def test_shapes_of_one_file_touch_each_other(open_fmu):
    """At rest each contact bears the weight above it. The sliding sphere stops after v^2/(2 mu g); those without contacts fall."""
    instance = open_fmu("Touch").initialize({"r.along_velocity": 1.0}, tolerance=1e-9)
    instance.run(3.0, 0.1)
    expected = {"world_collision1_on_one_collision1": 5, "one_collision1_on_two_collision1": 3, "world_collision2_on_rod_collision1": 1, "world_collision1_on_skid_collision1": 1.5}
    for name, mass in expected.items():
        assert instance.get(f"r.{name}.force") == pytest.approx(mass * G, rel=1e-6), name
    assert instance.get("r.along") == pytest.approx(1 / (2 * 0.3 * G), abs=2e-3)
    assert instance.get("r.excluded", "r.masked") == pytest.approx([-G * 4.5, -G * 4.5], rel=1e-8)


def test_boxes_touch_by_a_contact_of_the_system(open_fmu):
    """The upper box falls by 1 cm, and comes to rest with its weight on four corners, mg/(4 k) deep."""
    instance = open_fmu("Pile").initialize(tolerance=1e-8)
    instance.run(2.0, 0.5)
    assert instance.get("pile.force") == pytest.approx(G, rel=1e-3)
    assert instance.get("r.high_z") - instance.get("r.low_z") == pytest.approx(0.2 - G / 4e4, abs=1e-6)


def test_many_shapes_stand_without_a_gap(open_fmu):
    """40 gaps pass 0 at the start. At rest four corners of each box bear its weight."""
    instance = open_fmu("Standing").initialize(tolerance=1e-6)
    instance.run(1.0, 0.1)
    depth = G / 4 / instance.get("r.ground_stiffness")
    for i in range(10):
        assert instance.get(f"r.b{i}_ground1.force") == pytest.approx(G, rel=1e-4)
        assert instance.get(f"r.b{i}_z") == pytest.approx(0.1 - depth, abs=1e-7)


def test_further_planes_of_the_world_are_walls(open_fmu):
    """The first plane is the ground. At rest each plane bears the weight along its normal, m g/k deep."""
    instance = open_fmu("Walled").initialize(tolerance=1e-8)
    instance.run(12.0, 0.5)
    forces = instance.get("r.corner_collision1_on_b_collision1.force", "r.world_collision1_on_b_collision1.force", "r.b_ground1.force")
    assert forces == pytest.approx([2 * 4, 2 * 3, 2 * G], rel=1e-4)
    assert instance.get("r.b_x", "r.b_y", "r.b_z") == pytest.approx([0.4 + 8 / instance.get("r.self_stiffness"), 0.3 + 6 / instance.get("r.self_stiffness"), 0.1 - 2 * G / instance.get("r.ground_stiffness")], abs=1e-6)


@pytest.mark.parametrize("own, names, warns", [("", {"r.stand_collision1_on_ball_collision1"}, True), ("ball", {"own"}, True), ("rod", {"r.stand_collision1_on_ball_collision1", "own"}, False)])
def test_own_contacts_replace_those_of_the_file(own, names, warns, tmp_path):
    """A <contact> beside the <include> leaves no second one between its shapes, and no warning about them."""
    text = """<mujoco><worldbody><body name="stand"><geom name="table" type="box" size="1 1 0.1"/></body>
<body name="ball" pos="0 0 0.2"><freejoint/><geom size="0.1"/></body>
<body name="rod" pos="0.5 0 0.2"><freejoint/><geom name="stick" type="capsule" size="0.1" fromto="0 0 0 0 0.5 0" contype="2"/></body></worldbody></mujoco>"""
    contact = f'<contact name="own" between="r.{own}_collision1" and="r.stand_collision1" stiffness="1e4"/>' if own else ""
    (tmp_path / "table.xml").write_text(text.replace('contype="2"', 'contype="2" conaffinity="3"').replace('size="1 1 0.1"', 'size="1 1 0.1" contype="3"').replace('<geom size', '<geom contype="4" conaffinity="1" size'))
    (tmp_path / "system.xml").write_text(f'<system name="S"><include file="table.xml" as="r" self="true" ground="false"/>{contact}</system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    message = "the geom 'table' of the body 'stand' does not touch the geom 'stick' of the body 'rod', unlike in MuJoCo; expected <contact between=\"r.stand_collision1\" and=\"r.rod_collision1\" stiffness=\"...\"/> in a <system> that includes the robot"
    assert result.returncode == 0 and (message in result.stderr) == warns, result.stderr
    forces = re.findall(r'name="([\w.]+)\.force"', (tmp_path / "out" / "modelDescription.xml").read_text())
    assert {name for name in forces if not name.endswith("norm")} == names


def test_an_own_contact_is_that_of_one_robot(tmp_path):
    """Another robot of the same file keeps its own."""
    (tmp_path / "ball.xml").write_text('<mujoco><worldbody><geom type="box" size="1 1 0.1"/><body name="b" pos="0 0 0.2"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>')
    robots = "".join(f'<include file="ball.xml" as="{name}" self="true"/>' for name in "ab")
    (tmp_path / "system.xml").write_text(f'<system name="S">{robots}<contact name="own" between="a.b_collision1" and="a.world_collision1" stiffness="1e4"/></system>')
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    forces = re.findall(r'name="([\w.]+)\.force"', (tmp_path / "out" / "modelDescription.xml").read_text())
    assert {name for name in forces if not name.endswith("norm")} == {"own", "b.world_collision1_on_b_collision1"}


def test_an_own_contact_replaces_that_with_the_ground(tmp_path):
    (tmp_path / "pile.xml").write_text(PILE)
    (tmp_path / "system.xml").write_text('<system name="S"><include file="pile.xml" as="r" ground="true" self="false"/><contact name="own" between="r.ground" and="r.low_collision1" stiffness="1e4"/></system>')
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    forces = set(re.findall(r'name="([\w.]+)\.force"', (tmp_path / "out" / "modelDescription.xml").read_text()))
    assert "own" in forces and "r.high_ground1" in forces and "r.low_ground1" not in forces


@pytest.mark.parametrize("kind, remedy", [("ellipsoid", "a plane, or other types than mesh and ellipsoid"), ("cylinder", None)])
def test_spheres_and_ellipsoids(kind, remedy, tmp_path):
    text = f'<mujoco><worldbody><geom type="{kind}" size="0.1 0.2 0.3"/><body name="b" pos="0 0 1"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
    (tmp_path / "two.xml").write_text(text)
    result = lagc("two.xml", "-o", "out", "--robot", "self=true", cwd=tmp_path)
    assert result.returncode == 0 and (f"unlike in MuJoCo; expected {remedy}" in result.stderr if remedy else "unlike" not in result.stderr), result.stderr


def test_shapes_of_a_urdf_touch_each_other(tmp_path):
    """Links that a joint connects do not touch; other pairs of which one is a sphere, or both are capsules, do."""
    link = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>{1}</link>'
    shape = '<collision><origin xyz="{0} 0 0"/><geometry>{1}</geometry></collision>'
    ball, box = '<sphere radius="0.1"/>', '<box size="0.1 0.1 0.1"/>'
    links = [link.format(name, "".join(shape.format(3 * i + j / 2, kind) for j, kind in enumerate(kinds))) for i, (name, kinds) in enumerate({"stand": [box, ball], "a": [ball], "b": [box], "c": [ball]}.items())]
    joints = [f'<joint name="{one}{other}" type="{kind}"><parent link="{one}"/><child link="{other}"/><axis xyz="0 0 1"/></joint>' for one, other, kind in (("stand", "a", "continuous"), ("a", "b", "continuous"), ("b", "c", "fixed"))]
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm">{"".join(links + joints)}</robot>')
    result = lagc("arm.urdf", "-o", "out", "--robot", "self=true", cwd=tmp_path)
    assert result.returncode == 0 and "1 pair of shapes does not touch, such as the box of the link 'stand' and the box of 'b'; expected <contact between=\"stand_collision1\" and=\"b_collision1\" stiffness=\"...\"/> in a <system>" in result.stderr
    names = set(re.findall(r'name="(\w+_on_\w+)\.force"', (tmp_path / "out" / "modelDescription.xml").read_text()))
    assert names == {"stand_collision2_on_b_collision1", "stand_collision1_on_c_collision1", "stand_collision2_on_c_collision1"}


WORLD = """<mujoco><worldbody>
<geom name="floor" type="plane" size="1 1 1"/>
<geom name="wall" type="box" size="1 1 1" pos="3 0 0"/>
<body name="a"><freejoint/><geom name="ga" size="0.1"/>
<body name="b" pos="0 0 1"><joint name="hinge"/><geom size="0.1" condim="4"/>
<body name="c" pos="0 0 1"><joint/><geom size="0.1" contype="0"/></body></body></body></worldbody>
</mujoco>"""
STANDS = "nothing stands on the geom 'floor'; expected ground=\"true\" in an <include> or --ground on the command line, or ground=\"false\" if this is meant"
STATIC = "the geom 'wall' of the world does not touch the geom 'ga' of the body 'a', and 2 other such pairs, unlike in MuJoCo"
BODIES = "the geom 'ga' of the body 'a' does not touch the geom on line 6 of the body 'c', unlike in MuJoCo"
SPINS = "the torsional friction of condim=\"4\" is not read, and may change the motion; expected condim=\"3\""
BELOW = "the link 'a' is 0.1 m below the ground at the start"
DISABLED = "nothing touches the ground, as <flag> disables contacts; remove this"


@pytest.mark.parametrize(
    "ground, replaced, new, lines",
    [
        ("", "", "", {(2, STANDS), (3, STATIC), (4, BODIES)}),
        ('ground="true"', "", "", {(3, STATIC), (4, BODIES), (4, BELOW), (5, SPINS)}),
        ('ground="false"', "", "", set()),
        ('ground="false" self="true"', "", "", {(5, SPINS)}),
        ("", "</worldbody>", '</worldbody><option><flag contact="disable"/></option>', set()),
        ('ground="true"', "</worldbody>", '</worldbody><option><flag contact="disable"/></option>', {(1, DISABLED)}),
        ('ground="true"', "</worldbody>", '</worldbody><option><flag constraint="disable"/></option>', {(1, DISABLED)}),
        ("", "</worldbody>", '</worldbody><contact><exclude body1="c" body2="a"/></contact>', {(2, STANDS), (3, STATIC)}),
        ("", 'contype="0"', 'contype="0" conaffinity="2"', {(2, STANDS), (3, STATIC.replace("2 other such pairs", "1 other such pair"))}),
    ],
)
def test_contacts_that_exist_in_mujoco_alone(ground, replaced, new, lines, tmp_path):
    (tmp_path / "world.xml").write_text(WORLD.replace(replaced, new) if replaced else WORLD)
    (tmp_path / "system.xml").write_text(f'<system name="S"><include file="world.xml" as="r" {ground}/></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    reported = re.findall(r"^world\.xml:(\d+): warning: (.*)", result.stderr, re.MULTILINE)
    assert len(reported) == len(lines) and all(any(line == int(number) and text.startswith(words) for number, text in reported) for line, words in lines), result.stderr


@pytest.mark.parametrize(
    "geom, message",
    [
        ('condim="2"', 'condim="2" of <geom> is not valid; expected 1, 3, 4 or 6'),
        ('friction="-1"', 'friction="-1" of <geom> is negative; expected 0 or more'),
        ('friction="1 2 3 4"', 'friction="1 2 3 4" of <geom> is not valid; expected 1 to 3 numbers'),
    ],
)
def test_bad_contacts(geom, message, tmp_path):
    (tmp_path / "world.xml").write_text(WORLD.replace('condim="4"', geom))
    result = lagc("world.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and f"world.xml:5: {message}" in result.stderr, result.stderr


def test_a_grounded_link_that_cannot_touch_the_plane(tmp_path):
    (tmp_path / "world.xml").write_text(WORLD)
    (tmp_path / "system.xml").write_text('<system name="S"><include file="world.xml" as="r" ground="d"/></system>')
    (tmp_path / "world.xml").write_text(WORLD.replace('name="c"', 'name="d"').replace('contype="0"', 'contype="2" conaffinity="2"'))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1
    assert "the link 'd' has no shape that could stand on the ground; expected a <collision> or <geom> in it, which its contype" in result.stderr
