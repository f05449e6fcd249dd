"""A floating base starts where the lowest shape of its robot stands on the ground, unless the user gives a height."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fmu
from building import build_systems
from fmu import lagc
from meshes import CUBE, stl_text, triangles_of

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
SHAPES = {
    "Sphere": '<sphere radius="0.3"/>',
    "Box": '<box size="0.4 0.6 0.2"/>',
    "Cylinder": '<cylinder radius="0.2" length="0.7"/>',
    "Capsule": '<capsule radius="0.2" length="0.7"/>',
    "Mesh": '<mesh filename="cube.stl" scale="0.4 0.6 -0.2"/>',
}
# A leg of two joints, one of which follows the other, below the base; its shape is turned.
LEGGED = """<robot name="legged"><link name="trunk">{INERTIAL}</link><link name="upper">{INERTIAL}</link><link name="lower">{INERTIAL}
  <collision><origin xyz="0.1 0.2 -0.4" rpy="0.5 -0.7 0.3"/><geometry>{}</geometry></collision></link>
  <joint name="hip" type="continuous"><origin xyz="0 0 -0.1" rpy="0.2 0 0"/><parent link="trunk"/><child link="upper"/><axis xyz="0 1 0"/></joint>
  <joint name="knee" type="revolute"><origin xyz="0 0 -0.5"/><parent link="upper"/><child link="lower"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1"/><mimic joint="hip" multiplier="2" offset="0.1"/></joint></robot>""".replace("{INERTIAL}", INERTIAL)
SYSTEM = '<system name="{}"><include file="legged.urdf" as="r" base="floating" ground="true">{}</include></system>'
BENT = '<coordinate name="hip" start="0.6/2"/>'
# A quarter turn about x and a third of one about z.
ROTATED = BENT + '<coordinate name="base_qw" start="0.5"/><coordinate name="base_qx" start="sqrt(0.5)"/><coordinate name="base_qy" start="-0.3"/><coordinate name="base_qz" start="0.4"/>'
FORCE = "r.lower_ground1.force"


@pytest.fixture(scope="module", autouse=True)
def built():
    texts, files = {}, {}
    for shape, text in SHAPES.items():
        for name, start in ((f"Legged{shape}", ""), (f"Bent{shape}", BENT), (f"Rotated{shape}", ROTATED)):
            texts[name] = SYSTEM.format(name, start)
            files |= {f"{name}/legged.urdf": LEGGED.format(text), f"{name}/cube.stl": stl_text(CUBE, triangles_of(CUBE))}
    build_systems("heights-of-robots", texts, files=files)


def force_at(name, height=None):
    instance = fmu.Instance(name, logging=False)
    try:
        instance.initialize({} if height is None else {"r.base_z": height})
        return instance.get(FORCE), instance.get("r.base_z")
    finally:
        instance.free()


@pytest.mark.parametrize("kind", ["Legged", "Bent", "Rotated"])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_lowest_shape_stands_on_the_ground(kind, shape):
    """It does not press, and does 0.2 mm lower: the height is rounded up to 0.1 mm."""
    force, height = force_at(kind + shape)
    assert force == 0 and height != 0
    assert force_at(kind + shape, height - 2e-4)[0] > 0


def message(tmp_path, text, start="", ground='ground="true"'):
    (tmp_path / "legged.urdf").write_text(LEGGED.format(text))
    (tmp_path / "system.xml").write_text(SYSTEM.format("Told", start).replace('ground="true"', ground))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    return result.stderr


def test_a_note_has_the_height(tmp_path):
    """The ball lies straight below the base: 0.1 + 0.5 + 0.4 + 0.3 m, less what the hip's roll by 0.2 rad lifts it."""
    ball = LEGGED.replace('xyz="0.1 0.2 -0.4"', 'xyz="0 0 -0.4"').replace('offset="0.1"', 'offset="0"')
    (tmp_path / "legged.urdf").write_text(ball.format(SHAPES["Sphere"]))
    (tmp_path / "system.xml").write_text(SYSTEM.format("Told", ""))
    height = np.ceil((0.1 + 0.9 * np.cos(0.2) + 0.3) * 1e4) / 1e4
    expected = f"legged.urdf:1: note: the base starts at base_z = {height:g}, where the link 'lower' stands on the ground"
    assert expected in lagc("system.xml", "-o", "out", cwd=tmp_path).stderr


@pytest.mark.parametrize("start, ground", [('<coordinate name="base_z" start="2"/>', 'ground="true"'), ("", "")])
def test_no_note_without_need(start, ground, tmp_path):
    assert "note:" not in message(tmp_path, SHAPES["Box"], start, ground)


# The centre of the ball is at Rx(0.2) ((0, 0, -0.5) + Rx(0.1) (0.1, 0.2, -0.4)) - (0, 0, 0.1), whose z is -0.91306.
@pytest.mark.parametrize(
    "options, message",
    [
        ('base="floating" ground="true"', 'below the ground at the start; expected start="1.2131" of base_z, or above'),
        ('ground="true"', 'is 1.2 m below the ground at the start; expected other start values, or links without it in ground="..."'),
    ],
)
def test_warnings_of_links_below_the_ground(options, message, tmp_path):
    (tmp_path / "legged.urdf").write_text(LEGGED.format(SHAPES["Sphere"]))
    start = '<coordinate name="base_z" start="0.5"/>' if "floating" in options else ""
    (tmp_path / "system.xml").write_text(f'<system name="Told"><include file="legged.urdf" as="r" {options}>{start}</include></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0 and message in result.stderr and "note:" not in result.stderr


def check_robot(tmp_path, robot, name, options, content=""):
    """Return the messages of lagc about a file of a robot in a system."""
    (tmp_path / name).write_text(robot)
    (tmp_path / "system.xml").write_text(f'<system name="Told"><include file="{name}" as="r" {options}>{content}</include></system>')
    return lagc("system.xml", "-o", "out", cwd=tmp_path).stderr


FLAT = f'''<robot name=""><link name="plate">{INERTIAL}<collision><origin xyz="0 0 {{}}"/><geometry><box size="1 1 0.1"/></geometry></collision></link></robot>'''


def test_a_robot_above_the_ground_is_lowered(tmp_path):
    assert "base_z = -0.75, where the link 'plate' stands" in check_robot(tmp_path, FLAT.format(0.8), "flat.urdf", 'base="floating" ground="true"')


def test_copies_have_their_own_heights(tmp_path):
    """The second plate is turned by 2 acos(0.6) about x, whose cosine is -0.28 and sine 0.96: 0.28 0.05 + 0.96/2 = 0.494."""
    second = '</include><include file="flat.urdf" as="s" base="floating" ground="true"><coordinate name="base_qw" start="0.6"/><coordinate name="base_qx" start="0.8"/>'
    report = check_robot(tmp_path, FLAT.format(0), "flat.urdf", 'base="floating" ground="true"', second)
    assert "base_z = 0.05," in report and "base_z = 0.494," in report


def test_starts_of_an_outer_include_count(tmp_path):
    """The leg bends as if the start stood in the <include> of the robot: the ball is at Rx(0.2) Ry(0.3) ((0, 0, -0.5) + Rx(0.7) (0.1, 0.2, -0.4))."""
    (tmp_path / "legged.urdf").write_text(LEGGED.format(SHAPES["Sphere"]))
    (tmp_path / "inner.xml").write_text(SYSTEM.format("Inner", ""))
    outer = '<system name="Outer"><include file="inner.xml" as="x"><coordinate name="r.hip" start="0.3"/></include></system>'
    (tmp_path / "outer.xml").write_text(outer)
    about_x, about_y = Rotation.from_euler("x", [[0.2], [0.7]]), Rotation.from_euler("y", 0.3)
    ball = [0, 0, -0.1] + about_x[0].apply(about_y.apply([0, 0, -0.5] + about_x[1].apply([0.1, 0.2, -0.4])))
    height = np.ceil((0.3 - ball[2]) * 1e4) / 1e4
    assert f"base_z = {height:g}, where" in lagc("outer.xml", "-o", "out", cwd=tmp_path).stderr


def test_starts_that_do_not_count(tmp_path):
    report = check_robot(tmp_path, LEGGED.format(SHAPES["Box"]), "legged.urdf", 'base="floating" ground="true"', '<parameter name="g" start="9"/><coordinate name="hip" start="g/30"/>')
    assert "(the start of 'hip' is no number, and not counted)" in report


@pytest.mark.parametrize(
    "robot, name, options, content, message",
    [
        (f'<robot><link name="plate">{INERTIAL}</link></robot>', "robot.urdf", 'base="floating" ground="true"', "", "robot.urdf:1: warning: nothing of the robot touches the ground"),
        (LEGGED.format(SHAPES["Box"]), "robot.urdf", 'base="floating" limits="stops"', '<coordinate name="hip" start="0.5"/>', ""),
        (LEGGED.format(SHAPES["Box"]).replace('type="continuous"', 'type="revolute"').replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit lower="-1" upper="0.25"/>'),
         "robot.urdf", 'limits="stops"', '<coordinate name="hip" start="0.5"/>', "the start of the joint 'hip' is 0.5, beyond its stops, where the simulation cannot begin; expected one from -1 to 0.25"),
        ('<robot name="r"><link name="world"/><link name="b">' + INERTIAL + '</link><joint name="j" type="continuous"><parent link="world"/><child link="b"/></joint></robot>',
         "robot.urdf", 'base="floating"', "", "the root link 'world' moves freely, and has no mass; expected an <inertial> in it, or no base=\"floating\""),
        (f'<robot name="r"><link name="b">{INERTIAL.replace("1", "0", 1)}</link></robot>'.replace('value="0"', 'value="0"'), "robot.urdf", 'base="floating"', "", "the link 'b' moves freely, and has no mass; expected a <mass> above 0"),
        ('<mujoco><worldbody><geom type="plane" size="1 1 1" pos="0 0 0.3"/><body name="b" pos="0 0 0.5"><freejoint/><geom type="box" size="0.1 0.1 0.4"/></body></worldbody></mujoco>',
         "robot.xml", 'ground="true"', "", "the link 'b' is 0.2 m below the ground at the start"),
        ('<mujoco><worldbody><geom type="plane" size="1 1 1"/><body name="b" pos="0 0 0.3"><freejoint/><geom type="ellipsoid" euler="0 45 0" size="0.3 0.1 0.5"/></body></worldbody></mujoco>',
         "robot.xml", 'ground="true"', "", "the link 'b' is 0.11 m below the ground at the start"),  # sqrt((0.3^2 + 0.5^2)/2) - 0.3 = 0.1123
    ],
)  # fmt: skip
def test_messages(robot, name, options, content, message, tmp_path):
    report = check_robot(tmp_path, robot, name, options, content)
    assert message in report if message else "beyond its stops" not in report
