"""Attributes of robot files beyond geometry and inertia: each one that changes the motion is read, or gives a warning with a remedy."""

import math
import re

import pytest

from building import build_systems
from fmu import lagc

ROTOR = """<robot name="rotor">
<link name="stand">{0}</link>
<link name="rotor">{0}</link>
<joint name="hinge" type="revolute"><parent link="stand"/><child link="rotor"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9" effort="0" velocity="0"/>
<dynamics damping="0" spring_stiffness="2" spring_reference="0.3"/></joint>
</robot>""".format('<inertial><mass value="1"/><inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial>')
WHEEL = """<mujoco model="wheel">
<compiler inertiagrouprange="1 1"/><option gravity="0 0 0" actuatorgroupdisable="2 7"/><default><motor group="7"/></default>
<worldbody><body name="wheel"><joint name="hinge" axis="0 1 0"/>
<geom type="box" size="0.1 0.2 0.3" mass="3" group="1"/><geom size="0.5" pos="0.5 0 0" mass="9" group="2"/><geom size="0.3" pos="0 0 0.5" mass="7"/></body></worldbody>
<actuator><motor name="one" joint="hinge" group="1"/><motor name="two" joint="hinge" group="2"/><position name="three" joint="hinge" group="2" kp="5"/><motor name="four" joint="hinge"/></actuator>
</mujoco>"""
LATER = """<mujoco model="later"><option gravity="0 0 0"/>
<default><position kp="4"/><default class="early"><position kv="1"/></default></default>
<default><position kp="9"/><default class="late"><position kv="1"/></default></default>
<worldbody><body name="a"><joint name="a" axis="0 1 0"/><geom type="box" size="0.1 0.2 0.3" mass="3"/></body>
<body name="b"><joint name="b" axis="0 1 0"/><geom type="box" size="0.1 0.2 0.3" mass="3"/></body></worldbody>
<actuator><position name="a" class="early" joint="a"/><position name="b" class="late" joint="b"/></actuator>
</mujoco>"""
SYSTEMS = {
    "Later": '<system name="Later"><include file="later.xml" as="r"/></system>',
    "Sprung": '<system name="Sprung"><include file="rotor.urdf" as="r" limits="outputs" effort="limited"/></system>',
    "Wheel": '<system name="Wheel"><include file="wheel.xml" as="r"/></system>',
}


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("unread_in_robots", SYSTEMS, files={"Sprung/rotor.urdf": ROTOR, "Wheel/wheel.xml": WHEEL, "Later/later.xml": LATER})


@pytest.mark.parametrize("torque", [0.0, 3.0])
def test_a_spring_and_an_effort_that_is_not_known(torque, open_fmu):
    """The spring of <dynamics> acts about its reference; an effort limit of 0 means no limit."""
    instance = open_fmu("Sprung").initialize({"r.hinge_torque": torque}, tolerance=1e-10)
    instance.run(1.0, 0.1)
    middle = 0.3 + torque / 2
    assert instance.get("r.hinge") == pytest.approx(middle * (1 - math.cos(2)), rel=1e-8)


def test_groups_of_actuators_and_geoms(open_fmu):
    """Actuators of disabled groups have no effect; geoms of other groups have no mass, nor have those without a group, which is 0. The box has m (a^2 + c^2)/3 = 0.1 kg.m2."""
    controls = {f"r.{name}_control": value for name, value in (("one", 0.1), ("two", 5.0), ("three", 4.0), ("four", 3.0))}
    instance = open_fmu("Wheel").initialize(controls, tolerance=1e-10)
    instance.run(1.0, 0.1)
    assert instance.get("r.hinge") == pytest.approx(0.1 / 0.1 / 2, rel=1e-9)


def test_later_defaults_do_not_change_earlier_classes(open_fmu):
    """In MuJoCo a class copies the defaults around it where it is defined. 0.1 kg.m2 w' = kp u at rest."""
    instance = open_fmu("Later").initialize({"r.a_control": 0.1, "r.b_control": 0.1}, tolerance=1e-10)
    instance.run(1e-3, 1e-3)
    assert instance.get("r.a", "r.b") == pytest.approx([4 * 0.5e-6, 9 * 0.5e-6], rel=1e-2)


def warnings_of(name, text, attributes, folder):
    (folder / name).write_text(text)
    (folder / "system.xml").write_text(f'<system name="S"><include file="{name}" as="r" {attributes}/></system>')
    result = lagc("system.xml", "-o", "out", cwd=folder)
    assert result.returncode == 0, result.stderr
    return re.findall(rf"^{name}:(\d+): warning: (.*?)(?: \(included|$)", result.stderr, re.MULTILINE)


UNREAD = "is not read, and may change the motion; expected"
QUIET = 'base="floating" ground="false" limits="outputs" effort="unlimited"'
IN_SYSTEM = "a <force> in a <system> that includes the robot"
URDF_CASES = {
    "unknown effort": ("", "", 'limits="stops" effort="limited"', 5, f'effort="0" of <limit>, which stands for no limit, {UNREAD} the largest force or torque of the motor'),
    "limits": ("", "", "", 4, "motion is not stopped at the limits of the joint 'hinge'; expected limits=\"stops\", or \"outputs\" if this is meant, in an <include>"),
    "effort": ('effort="0"', 'effort="3"', 'limits="stops"', 4, "motors may exceed the effort of the joint 'hinge'; expected effort=\"limited\""),
    "limits of a plane": ('"revolute"', '"planar"', QUIET, 5, f"<limit lower upper> of a floating, planar or spherical joint {UNREAD} a <stop> at each of its coordinates"),
    "spring in a plane": ('"revolute"', '"planar"', QUIET, 6, f"<dynamics> of a floating, planar or spherical joint {UNREAD} {IN_SYSTEM}"),
    "effort in a plane": ('"revolute"><parent', '"planar"><limit effort="4"/><parent', 'effort="limited"', 4, f"effort of a floating, planar or spherical joint {UNREAD}"),
    "another attribute": ("damping=", 'armature="1" damping=', QUIET, 6, f"armature of <dynamics> {UNREAD}"),
    "spring of Gazebo": ("</robot>", '<gazebo reference="hinge"><springStiffness>3</springStiffness></gazebo></robot>', QUIET, 7, f"<springStiffness> {UNREAD} spring_stiffness of <dynamics>"),
    "gravity off": ("</robot>", '<gazebo reference="rotor"><turnGravityOff>true</turnGravityOff></gazebo></robot>', QUIET, 7, f"<turnGravityOff> {UNREAD} {IN_SYSTEM}"),
    "friction of Gazebo": ("</robot>", '<gazebo reference="rotor"><mu1>0.3</mu1></gazebo></robot>', 'ground="true" limits="stops"', 7, f"<mu1> {UNREAD} ground_friction of the robot"),
    "undeclared prefix": ('effort="0"', 'drake:acceleration="3" effort="0"/><drake:gear drake:x="1"', QUIET, 5, "<drake:gear> is read without its prefix, which the file does not define; expected xmlns:drake=\"...\" in its first element"),
}  # fmt: skip


@pytest.mark.parametrize("replaced, new, attributes, line, message", URDF_CASES.values(), ids=URDF_CASES)
def test_warnings_of_urdf(replaced, new, attributes, line, message, tmp_path):
    text = ROTOR.replace(replaced, new) if replaced else ROTOR
    if "<limit" in new:
        text = text.replace('<limit lower="-9" upper="9" effort="0" velocity="0"/>', "")
    reported = warnings_of("rotor.urdf", text, attributes, tmp_path)
    assert [(number, words) for number, words in reported if words.startswith(message)] == [(str(line), words) for _, words in reported if words.startswith(message)] != []


def test_definitions_of_xacro_do_nothing(tmp_path):
    """With xmlns and without; calls of macros are errors."""
    for given in ("", ' xmlns:xacro="http://www.ros.org/wiki/xacro"'):
        text = ROTOR.replace("</robot>", '<xacro:property name="r" value="${2*pi}"/><xacro:macro name="m"><xacro:wheel/></xacro:macro></robot>')
        reported = warnings_of("rotor.urdf", text.replace("<robot", f"<robot{given}"), QUIET, tmp_path)
        assert reported == []


@pytest.mark.parametrize("text", ["<mu1>0.3</mu1>", "<selfCollide>true</selfCollide>", "<springStiffness>0</springStiffness>", "<turnGravityOff>false</turnGravityOff>", "<material>Grey</material>"])
def test_elements_of_simulators_that_do_nothing(text, tmp_path):
    assert warnings_of("rotor.urdf", ROTOR.replace("</robot>", f"<gazebo>{text}</gazebo></robot>"), QUIET, tmp_path) == []


def test_gains_without_units_are_reported_once(tmp_path):
    """Of the values of all inputs of a file the first one is reported."""
    (tmp_path / "rotor.urdf").write_text(ROTOR)
    robots = "\n".join(f'<include file="rotor.urdf" as="{name}" {QUIET.replace("floating", "fixed")}><input name="hinge_torque" value="-30*{name}.hinge - 2*{name}.hinge_velocity"/></include>' for name in "ab")
    (tmp_path / "system.xml").write_text(f'<system name="S">\n{robots}</system>')
    reported = re.findall("^system.xml:(.*) warning: (.*)", lagc("system.xml", "-o", "out", cwd=tmp_path).stderr, re.MULTILINE)
    assert [line for line, _ in reported] == ["2:"] and reported[0][1].endswith("; further values of inputs give no such warning")


@pytest.mark.parametrize(
    "ground, contact, message",
    [
        ('ground="wheel"', "", "there is no link 'wheel' for the ground; expected one of the links: stand, rotor"),
        ('ground="rotor"', "", "the link 'rotor' has no shape that could stand on the ground; expected a <collision> or <geom> in it, or one of the links with such shapes: stand"),
        ("", '<contact name="c" between="r.stand_collision1" and="wall" stiffness="1"/>', "there is no shape 'wall' above this <contact>; expected one of the shapes there: r.stand_collision1, floor"),
        ("", '<contact name="c" between="r.stand_collision1" and="flor" stiffness="1"/>', "there is no shape 'flor' above this <contact>; did you mean 'floor'? The shapes are: r.stand_collision1, floor"),
    ],
)
def test_messages_list_links_and_shapes(ground, contact, message, tmp_path):
    (tmp_path / "rotor.urdf").write_text(ROTOR.replace('"stand">', '"stand"><collision><geometry><sphere radius="1"/></geometry></collision>', 1))
    (tmp_path / "system.xml").write_text(f'<system name="S"><include file="rotor.urdf" as="r" base="floating" {ground}/><shape name="floor" type="plane"/>{contact}</system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr


def test_names_in_other_alphabets(tmp_path):
    """Letters become their code points, so that names of equal length differ."""
    text = ROTOR.replace('"rotor"', '"腕"').replace('"stand"', '"脚"').replace('"hinge"', '"é1"')
    assert warnings_of("rotor.urdf", text, QUIET, tmp_path) == []
    names = re.findall(r'ScalarVariable name="r\.([^"]*)"', (tmp_path / "out" / "modelDescription.xml").read_text())
    assert {"u00E91", "u00E91_velocity", "u8155.x", "u811A.x"} <= set(names)


def test_a_mocap_body_stands_still(tmp_path):
    text = WHEEL.replace("<worldbody>", '<worldbody><body name="goal" mocap="true" pos="1 2 3"/><body mocap="true"/>')
    message = f"mocap of <body>, which stands still, {UNREAD} mocap=\"inputs\" in an <include>, or --mocap inputs on the command line"
    assert warnings_of("wheel.xml", text, "", tmp_path) == [("3", message)]


# An attribute of an element, attributes of the <include>, and the remedy.
MJCF_CASES = [
    ("geom", 'margin="0.1"', 'ground="true"', "shapes that are larger"),
    ("geom", 'solref="0.01 1"', 'ground="true"', "ground_stiffness and ground_damping of the robot"),
    ("geom", 'adhesion="1"', 'ground="true"', "a <force> that holds the shape to the ground"),
    ("geom", 'surfacevel="1 0 0 0 0 0"', 'ground="true"', "a <contact> with a shape that moves"),
    ("joint", 'margin="0.1"', 'limits="stops"', "a range that is smaller by it"),
    ("joint", 'solreflimit="0.01 1"', 'limits="stops"', "a rigid limit, friction or constraint without it"),
    ("joint", 'springyield="1"', "", "a <force> in a <system>"),
    ("joint", 'unheard="1"', "", "one of the attributes that the reference names"),
    ("motor", 'velrange="-1 1"', "", "an actuator at a joint, tendon or site, without it"),
]


@pytest.mark.parametrize("element, attribute, asked, remedy", MJCF_CASES, ids=[f"{case[0]}-{case[1].split('=')[0]}" for case in MJCF_CASES])
def test_warnings_of_mjcf(element, attribute, asked, remedy, tmp_path):
    """
    The warning appears once, for the element or its <default>. It is omitted if the attribute has no effect for this <include>, or is 0.
    """
    name = attribute.split("=")[0]
    message = f"{name} of <{element}> {UNREAD} {remedy}"
    for pattern in (rf"<{element} (?!group=\"7)", "<default>"):
        new = f"<{element} {attribute} " if pattern != "<default>" else f"<default><{element} {attribute}/>"
        text = re.sub(pattern, new, WHEEL).replace(f'<motor {attribute}/><motor group="7"/>', f'<motor {attribute} group="7"/>')
        assert len([words for _, words in warnings_of("wheel.xml", text, asked, tmp_path) if words.startswith(message)]) == 1
        if asked:
            assert not any(name in words for _, words in warnings_of("wheel.xml", text, "", tmp_path))
        nothing = text.replace(attribute, f'{name}="0"')
        assert name == "unheard" or not any(name in words for _, words in warnings_of("wheel.xml", nothing, asked, tmp_path))


FREE = """<mujoco model="free">
<compiler alignfree="{compiler}"/>
<worldbody><body name="b"><freejoint name="f" {joint}/><geom size="0.1" pos="0.1 0 0"/></body></worldbody>
<keyframe><key name="k" qpos="1 2 3 {turn}" qvel="0 0 0 0 0 2"/></keyframe>
</mujoco>"""


@pytest.mark.parametrize("turn, expected", [("0 0 0 1e-3", (0, 0, 0, 1)), ("2 0 0 -2", (0.5**0.5, 0, 0, -(0.5**0.5))), ("0 0 0 0", (1, 0, 0, 0))])
def test_quaternions_of_keyframes_have_the_length_1(turn, expected, tmp_path):
    """As in MuJoCo, where a quaternion of length 0 does not rotate."""
    warnings_of("free.xml", FREE.format(compiler="false", joint="", turn=turn), 'keyframe="k"', tmp_path)
    text = next((tmp_path / "out").rglob("modelDescription.xml")).read_text()
    start = {name: float(value) for name, value in re.findall(r'name="r\.f_(\w+)"[^>]*>\s*<Real [^>]*start="([^"]*)"', text)}
    q = [start[f"q{x}"] for x in "wxyz"]
    assert q == pytest.approx(expected, abs=1e-15), start
    assert [start["x"], start["y"], start["z"]] == [1, 2, 3]


@pytest.mark.parametrize("compiler, joint, warns", [("false", "", False), ("false", 'align="true"', True), ("true", "", True), ("true", 'align="auto"', True), ("true", 'align="false"', False)])
def test_alignment_of_free_joints(compiler, joint, warns, tmp_path):
    warnings = warnings_of("free.xml", FREE.format(compiler=compiler, joint=joint, turn="1 0 0 0"), "", tmp_path)
    assert any("hold for the frame of the body 'b', unlike in MuJoCo" in message for _, message in warnings) == warns, warnings


@pytest.mark.parametrize("actuator, unread", [('velocity kv="1" dampratio="1"', "dampratio of <velocity>"), ('motor kp="1"', "kp of <motor>"), ('position kp="1" gainprm="2"', "gainprm of <position>"), ('intvelocity kp="1" actrange="0 1"', None), ('general gainprm="2"', None)])
def test_attributes_of_other_actuators(actuator, unread, tmp_path):
    """MuJoCo's schema refuses them."""
    text = f'<mujoco><worldbody><body name="b"><joint name="j"/><geom size="0.1"/></body></worldbody><actuator><{actuator} joint="j"/></actuator></mujoco>'
    warnings = [message for _, message in warnings_of("arm.xml", text, "", tmp_path)]
    assert [message for message in warnings if UNREAD in message] == ([] if unread is None else [f"{unread} {UNREAD} one of the attributes that the reference names"])


# A hinge whose body is balanced by its motors, with a limit; the motors; and the geoms of the world.
BALANCED = """<mujoco model="balanced"><worldbody>{world}
<body name="b" gravcomp="{share}"><joint name="j" axis="0 1 0" actuatorgravcomp="{by}" {joint}/><geom size="0.1" pos="0.3 0 0"/></body>
</worldbody><actuator>{motors}</actuator></mujoco>"""
WEIGHED = {"world": "", "share": 1, "by": "true", "joint": "", "motors": '<motor joint="j"/>'}
FIELD = '<geom type="hfield"/>'
MORE_CASES = {
    "a motor that balances": ({}, "", None),
    "no motor that balances": ({"motors": ""}, "", f'actuatorgravcomp="true" in a file without actuators {UNREAD} gravcomp="0" of the <body>s, as nothing balances them in MuJoCo'),
    "no motor and no balance": ({"motors": "", "share": 0}, "", None),
    "a balance without motors": ({"motors": "", "by": "false"}, "", None),
    "a limited motor that balances": ({"joint": 'actuatorfrcrange="-1 1"'}, "", f'the limit of actuatorgravcomp by actuatorfrcrange {UNREAD} actuatorgravcomp="false", or no actuatorfrcrange'),
    "a field": ({"world": FIELD}, "", "a <geom> of type hfield of the body 'world' touches nothing: expected a plane or boxes"),
    "a field that is meant to be passed": ({"world": FIELD}, 'ground="false"', None),
    "friction": ({"joint": 'frictionloss="1"'}, "", "creep replaces sticking by the friction of the joint 'j'; expected friction=\"sticks\", or \"creeps\" if this is meant, in an <include>"),
    "friction that is meant": ({"joint": 'frictionloss="1"'}, 'friction="creeps"', None),
    "start beyond a stop": ({"joint": 'range="30 50"'}, 'limits="stops"', "limits replace the start values, which are beyond them, of the joint 'j'; expected <coordinate name=\"...\" start=\"...\"/> in an <include>"),
    "start beyond a limit": ({"joint": 'range="30 50"'}, 'limits="outputs"', None),
    "start of the include": ({"joint": 'range="30 50"'}, 'limits="stops"><coordinate name="j" start="0.6"/></include', None),
}  # fmt: skip


@pytest.mark.parametrize("change, words, message", MORE_CASES.values(), ids=MORE_CASES)
def test_features_that_are_not_requested(change, words, message, tmp_path):
    text = BALANCED.format(**(WEIGHED | change))
    (tmp_path / "arm.xml").write_text(text)
    (tmp_path / "system.xml").write_text(f'<system name="S"><include file="arm.xml" as="r" {words}{"" if "<" in words else "/"}></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    warnings = re.findall(r"^arm\.xml:\d+: warning: (.*)", result.stderr, re.MULTILINE)
    assert [warning[: len(message or "")] for warning in warnings] == ([message] if message else [])
