"""Invalid URDF files: each gives the expected line and message, and no output."""

import re

import pytest

from bad_inputs import check_error, inputs
from fmu import lagc

# A valid robot, of which some tests change a line.
RIGHT = """\
<robot name="arm">
  <link name="stand"/>
  <link name="upper">
    <inertial><origin xyz="0 0 -0.5"/><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial>
  </link>
  <link name="lower">
    <inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="stand"/><child link="upper"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/>
  </joint>
  <joint name="elbow" type="continuous">
    <parent link="upper"/><child link="lower"/><origin xyz="0 0 -1" rpy="0 0 0"/><axis xyz="0 1 0"/>
  </joint>
</robot>
"""
INERTIA = '<inertia ixx="{}" ixy="{}" ixz="0" iyy="{}" iyz="0" izz="{}"/>'


def inertial(mass="2", tensor=("0.1", "0", "0.1", "0.01")):
    return f'<inertial><mass value="{mass}"/>{INERTIA.format(*tensor)}</inertial>'


def compile_robot(text, folder):
    (folder / "robot.urdf").write_text(text)
    return lagc("robot.urdf", "-o", "out", cwd=folder)


@inputs("space/bad_urdf")
def test_message(file, tmp_path):
    assert len(check_error(file, "robot.urdf", tmp_path)) == 1


def test_mimics_whose_products_overflow(tmp_path):
    """The message names the joint whose product of multipliers overflows."""
    joints = "".join(
        f'<link name="part{i}"/><joint name="gear{i}" type="continuous"><parent link="stand"/><child link="part{i}"/>'
        f'<mimic joint="{f"gear{i - 1}" if i else "elbow"}" multiplier="1e120" offset="1"/></joint>\n'
        for i in range(3)
    )
    result = compile_robot(RIGHT.replace("</robot>", joints + "</robot>"), tmp_path)
    assert result.returncode == 1 and len(result.stderr.splitlines()) == 1
    assert "robot.urdf:17: the joint 'gear2' follows 'elbow' by inf of its position" in result.stderr


@pytest.mark.parametrize(
    "link", ['<inertial><origin xyz="1e200 0 0"/><mass value="1"/>', '<inertial><mass value="1.7e308"/>'], ids=["far", "heavy"])  # fmt: skip
def test_fixed_links_whose_sums_overflow(link, tmp_path):
    parts = "".join(
        f'<link name="{name}">{link}{INERTIA.format(1, 0, 1, 1)}</inertial></link>'
        f'<joint name="to{name}" type="fixed"><parent link="lower"/><child link="{name}"/></joint>\n'
        for name in ("weight", "other")
    )
    result = compile_robot(RIGHT.replace("</robot>", parts + "</robot>"), tmp_path)
    assert result.returncode == 1 and len(result.stderr.splitlines()) == 1
    assert re.search("robot.urdf:1[56]: the position or inertia of the link '(weight|other)' as a part of", result.stderr), result.stderr


def test_circle_of_mimics(tmp_path):
    lines = RIGHT.splitlines()
    lines[9] += '<mimic joint="elbow"/>'
    lines[12] += '<mimic joint="shoulder"/>'
    result = compile_robot("\n".join(lines), tmp_path)
    assert "robot.urdf:9: the joint 'shoulder' mimics itself, or joints that mimic each other" in result.stderr


def test_nothing_moves(tmp_path):
    result = compile_robot(RIGHT.replace("continuous", "fixed").replace("revolute", "fixed"), tmp_path)
    assert result.stderr.startswith("robot.urdf:1: no joint of the robot moves"), result.stderr


def test_right_one(tmp_path):
    result = compile_robot(RIGHT, tmp_path)
    assert (result.returncode, result.stderr) == (0, NO_STOPS)


NO_STOPS = "robot.urdf:9: warning: motion is not stopped at the limits of the joint 'shoulder'; expected limits=\"stops\", or \"outputs\" if this is meant, in an <include>, or --limits stops on the command line\n"
NO_BODY = "at the start values: a principal moment is negative, or larger than the other two together; expected others"


@pytest.mark.parametrize(
    "tensor", [("0.1", "0", "0.1", "0.3"), ("-0.1", "0", "0.1", "0.1"), ("0.1", "0.2", "0.1", "0.1"), ("0.1", "0.06", "0.1", "0.03")]
)
def test_tensor_of_no_body(tensor, tmp_path):
    """Many published robots have such a tensor, and their equations are still valid, so that lagc only warns."""
    lines = RIGHT.splitlines()
    lines[3] = inertial(tensor=tensor)
    result = compile_robot("\n".join(lines), tmp_path)
    assert (result.returncode, result.stderr) == (0, f"{NO_STOPS}robot.urdf:3: warning: no body can have the moments of inertia of 'upper_body' {NO_BODY}\n")


@pytest.mark.parametrize("tensor", [("0.1", "0", "0.2", "0.302"), ("0", "0", "0", "0"), ("0.1", "0.05", "0.1", "0.1")])
def test_tensor_of_a_body(tensor, tmp_path):
    lines = RIGHT.splitlines()
    lines[3] = inertial(tensor=tensor)
    assert compile_robot("\n".join(lines), tmp_path).stderr == NO_STOPS


def test_left_out(tmp_path):
    text = RIGHT.replace('upper="1"', 'upper="1" effort="5" velocity="2"')
    text = text.replace('<link name="stand"/>', '<link name="stand"><visual/><collision/></link><gazebo/><material name="red"/>')
    result = compile_robot(text, tmp_path)
    assert result.returncode == 0
    assert result.stderr == (
        "robot.urdf: warning: left out, since the motion does not depend on them: collision, visual, velocity of limit, gazebo\n"
        f"{NO_STOPS}"
        "robot.urdf:9: warning: motors may exceed the effort of the joint 'shoulder'; expected effort=\"limited\", or \"unlimited\" if this is meant, in an <include>, or --effort limited on the command line\n"
    )


INCLUDE = '<system name="Cell">\n  <include file="robot.urdf" as="left" {}/>\n</system>'


@pytest.mark.parametrize(
    "attributes, message",
    [
        ('base="loose"', "cell.xml:2: base=\"loose\" of <include> is not known; expected fixed or floating"),
        ('limits="hard"', "cell.xml:2: limits=\"hard\" of <include> is not known; expected outputs or stops"),
        ('tool="loewr"', "robot.urdf: there is no link 'loewr' for the tool; did you mean 'lower'? (included as 'left' on line 2 of cell.xml)"),
    ],
)  # fmt: skip
def test_bad_include(attributes, message, tmp_path):
    (tmp_path / "robot.urdf").write_text(RIGHT)
    (tmp_path / "cell.xml").write_text(INCLUDE.format(attributes))
    result = lagc("cell.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and result.stderr == message + "\n", result.stderr


def test_base_of_an_included_system(tmp_path):
    (tmp_path / "robot.urdf").write_text('<system name="Ball"/>')
    (tmp_path / "cell.xml").write_text(INCLUDE.format('base="floating" effort="limited"'))
    result = lagc("cell.xml", "-o", "out", cwd=tmp_path)
    for word in ("base", "effort"):
        assert f'robot.urdf:1: {word}="..." of <include> is for robots; expected a file that begins with <robot>' in result.stderr


def test_stops_at_one_place(tmp_path):
    (tmp_path / "robot.urdf").write_text(RIGHT.replace('lower="-1" upper="1"', 'lower="0" upper="0"'))
    (tmp_path / "cell.xml").write_text(INCLUDE.format('limits="stops"'))
    result = lagc("cell.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and "robot.urdf:10: the limits of the joint 'shoulder' are both 0; expected lower below upper" in result.stderr


def test_robot_without_mass_on_floating_base(tmp_path):
    (tmp_path / "robot.urdf").write_text('<robot name="ghost"><link name="body"/></robot>')
    (tmp_path / "cell.xml").write_text(INCLUDE.format('base="floating"'))
    result = lagc("cell.xml", "-o", "out", cwd=tmp_path)
    assert "robot.urdf:1: no link of the robot has a mass" in result.stderr
