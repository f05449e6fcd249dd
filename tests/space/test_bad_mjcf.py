"""Invalid MJCF files: each gives the expected line and message, and no output."""

import re

import pytest

from fmu import lagc

# A valid robot; the cases below replace one line of it (counted from 1).
RIGHT = """\
<mujoco model="arm">
  <compiler angle="radian"/>
  <default><joint damping="0.1"/><default class="a"><geom density="500"/></default></default>
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" range="-1 1"/>
      <geom type="capsule" size="0.05" fromto="0 0 0 0 0 -1"/>
      <body name="lower" pos="0 0 -1" childclass="a">
        <joint name="elbow" axis="0 1 0"/>
        <geom type="box" size="0.1 0.1 0.5"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="elbow" gear="2"/></actuator>
</mujoco>
"""
UNKNOWN = "is not read, and would change the motion;"

# Kind of mistake, the replaced line, its new text, the expected line and message.
CASES = [
    ("unit of angles", 2, '<compiler angle="grad"/>', 2, 'angle="grad" of <compiler> is not known; expected one of degree, radian'),
    ("global coordinates", 2, '<compiler coordinate="global"/>', 2, 'coordinate="global" of <compiler> is not read; expected local'),
    ("sequence of angles", 2, '<compiler eulerseq="xyw"/>', 2, 'eulerseq="xyw" of <compiler> is not valid; expected three of the letters'),
    ("smallest mass", 2, '<compiler boundmass="3"/>', 2, f'boundmass="3" of <compiler> {UNKNOWN} remove it'),
    ("class twice", 3, '<default><default class="a"/><default class="a"/></default>', 3, "the class 'a' is already defined on line 3"),
    ("class without name", 3, '<default><default/><default class="a"/></default>', 3, "a <default> in a <default> has no class"),
    ("class inside itself", 3, '<default><default class="a"><default class="a"/></default></default>', 3, "the class 'a' is already defined on line 3"),
    ("gravity", 4, '<option gravity="0 0 nan"/>', 4, 'gravity="0 0 nan" of <option> is not valid; expected 3 numbers'),
    ("air", 4, '<option density="1.2"/>', 4, f'density="1.2" of <option> {UNKNOWN} remove it'),
    ("no damping", 4, '<option><flag passive="disable"/></option>', 4, 'passive="disable" of <flag> is not read'),
    ("unknown class", 9, '<body name="lower" childclass="b">', 9, "there is no class 'b' for childclass of <body>"),
    ("quaternion 0", 9, '<body name="lower" quat="0 0 0 0">', 9, 'quat="0 0 0 0" of <body> gives no direction'),
    ("parallel axes", 9, '<body name="lower" xyaxes="1 0 0 2 0 0">', 9, 'xyaxes="1 0 0 2 0 0" of <body> gives no direction'),
    ("two angles", 9, '<body name="lower" quat="1 0 0 0" euler="1 0 0">', 9, "<body> has quat and euler; expected one of them"),
    ("position", 9, '<body name="lower" pos="0 1">', 9, 'pos="0 1" of <body> is not valid; expected 3 numbers'),
    ("two bodies of one name", 9, '<body name="upper">', 9, "the link 'upper' is already defined on line 6"),
    ("type of joint", 10, '<joint name="elbow" type="revolute"/>', 10, 'type="revolute" of <joint> is not known; expected one of hinge, slide, ball, free'),
    ("axis", 10, '<joint name="elbow" axis="0 0 0"/>', 10, "the axis of the joint 'elbow' has the length 0"),
    ("free joint in a body", 10, '<freejoint name="elbow"/>', 10, "the free joint 'elbow' is in the body 'lower'; expected it in a <body> of the <worldbody>"),
    ("range", 10, '<joint name="elbow" range="1 -1"/>', 10, "range of <joint> is from 1 to -1; expected the lower one first"),
    ("springy ball", 10, '<joint name="elbow" type="ball" stiffness="3"/>', 10, f'stiffness="3" of <joint> {UNKNOWN}'),
    ("rubbing ball", 6, '<body name="upper"><joint type="ball" frictionloss="1"/></body><body name="other">', 6, f'frictionloss="1" of <joint> {UNKNOWN}'),
    ("spring by one number", 10, '<joint name="elbow" springdamper="1"/>', 10, 'springdamper="1" of <joint> is not valid; expected 2 numbers'),
    ("spring without a ratio", 10, '<joint name="elbow" springdamper="1 0"/>', 10, 'springdamper="1 0" of <joint> is not valid; expected a time constant and a damping ratio above 0'),
    ("spring beside a heavy tendon", 15, '<worldbody><body><joint name="k" springdamper="1 1"/><geom size="1"/></body></worldbody><tendon><fixed name="t" armature="1"><joint joint="k" coef="1"/></fixed></tendon>', 15, "springdamper of the joint 'k' is beside the armature of the tendon 't'"),
    ("damping", 10, '<joint name="elbow" damping="-1"/>', 10, 'damping="-1" of <joint> is negative'),
    ("no mass", 11, '<geom size="0.1" mass="0"/>', 10, "the joint 'elbow' moves no inertia"),
    ("no size", 11, "<geom/>", 11, "a <geom> of type sphere has a size of 0"),
    ("mesh", 11, '<geom type="mesh" mesh="m"/>', 11, "there is no <mesh> 'm' in an <asset>; expected an existing name"),
    ("height field", 11, '<geom type="hfield"/>', 11, "the inertia of a <geom> of type hfield is not known; expected an <inertial>"),
    ("plane between", 11, '<geom type="plane" fromto="0 0 0 1 1 1"/>', 11, "fromto of a <geom> is not valid"),
    ("two inertias", 11, '<inertial mass="1" diaginertia="1 1 1" fullinertia="1 1 1 0 0 0"/>', 11, "<inertial> has diaginertia and fullinertia"),
    ("kinds of actuators", 15, '<default><position kp="4"/></default><actuator><velocity joint="elbow"/></actuator>', 15, "<velocity> inherits the <position> of a <default>"),
    ("motor after its kind", 15, '<default><position kp="4"/><motor/></default><actuator><position joint="elbow"/></actuator>', 15, "<position> inherits the <motor> of a <default>"),
    ("law of all kinds", 15, '<default><general biastype="affine"/></default><actuator><position joint="elbow"/></actuator>', 15, "<position> inherits the <general> of a <default>"),
    ("range of no range", 15, '<actuator><position joint="elbow" inheritrange="1"/></actuator>', 15, "inheritrange of <position> is a share of the range of its joint or tendon, which has none; expected ctrlrange"),
    ("range of nothing", 15, '<actuator><position inheritrange="1"/></actuator>', 15, "<position> needs the attribute 'joint'"),
    ("range of no joint", 15, '<actuator><position joint="wrist" inheritrange="1"/></actuator>', 15, "there is no joint 'wrist' for an actuator"),
    ("two ranges", 15, '<actuator><position joint="shoulder" inheritrange="1" ctrlrange="0 1"/></actuator>', 15, "inheritrange of <position> is beside a ctrlrange; expected one of them"),
    ("limits of actuators", 10, '<joint name="elbow" actuatorfrcrange="2 -2"/>', 10, "actuatorfrcrange of <joint> is from 2 to -2"),
    ("limited ball", 10, '<joint name="elbow" type="ball" actuatorfrcrange="-2 2"/>', 10, f'actuatorfrcrange="-2 2" of <joint> {UNKNOWN}'),
    ("line at a limited joint", 15, '<default><joint actuatorfrcrange="-2 2"/></default><tendon><spatial name="t"><site site="upper"/><site site="lower"/></spatial></tendon><actuator><motor name="m" tendon="t"/></actuator>', 15, "the actuator 'm' acts at a site or along a <spatial> tendon, and the joint 'shoulder' has an actuatorfrcrange"),
    ("no joint", 15, '<actuator><motor joint="wrist"/></actuator>', 15, "there is no joint 'wrist' for an actuator"),
    ("muscle", 15, '<actuator><muscle joint="elbow"/></actuator>', 15, f"<muscle> {UNKNOWN} expected <motor>, <position>, <velocity> or <general>"),
    ("dynamics", 15, '<actuator><general dyntype="user" joint="elbow"/></actuator>', 15, 'dyntype="user" of <general> is not known'),
    ("filter without time", 15, '<actuator><general dyntype="filter" dynprm="0" joint="elbow"/></actuator>', 15, "the time constant 0 of dynprm of <general> is not above 0"),
    ("tendon through space", 15, '<tendon><spatial name="t"><site site="eye"/></spatial></tendon>', 15, "the tendon 't' has fewer than two sites"),
    ("tendon at no site", 15, '<tendon><spatial><site site="eye"/><site site="lower"/></spatial></tendon>', 15, "there is no site 'eye' for a tendon"),
    ("tendon from a site to itself", 15, '<tendon><spatial name="t"><site site="upper"/><site site="upper"/></spatial></tendon>', 15, "the tendon 't' goes from the site 'upper' to itself"),
    ("wrapped tendon", 15, '<tendon><spatial><geom geom="g"/></spatial></tendon>', 15, f"<geom> {UNKNOWN} expected straight lines from <site> to <site>"),
    ("pulley", 15, '<tendon><spatial><pulley divisor="2"/></spatial></tendon>', 15, f"<pulley> {UNKNOWN} expected straight lines"),
    ("relaxed tendon", 15, '<default><joint ref="0.3"/></default><tendon><spatial name="t" stiffness="1"><site site="upper"/><site site="lower"/></spatial></tendon>', 15, "which of 'shoulder' is not its ref; expected springlength"),
    ("tendon at nothing", 15, '<tendon><fixed name="t"/></tendon>', 15, "the tendon 't' has no joint"),
    ("tendon at a wrong joint", 15, '<tendon><fixed><joint joint="wrist" coef="1"/></fixed></tendon>', 15, "there is no joint 'wrist' for a tendon"),
    ("tendon without coefficient", 15, '<tendon><fixed><joint joint="elbow"/></fixed></tendon>', 15, "<joint> needs the attribute 'coef'"),
    ("slack tendon", 15, '<tendon><fixed springlength="2 1"><joint joint="elbow" coef="1"/></fixed></tendon>', 15, "springlength of <fixed> is from 2 to 1"),
    ("friction of a tendon", 15, '<tendon><fixed frictionloss="-1"><joint joint="elbow" coef="1"/></fixed></tendon>', 15, 'frictionloss="-1" of <fixed> is negative'),
    ("motor of no tendon", 15, '<actuator><motor tendon="t"/></actuator>', 15, "there is no tendon 't' for a <motor>; expected an existing name"),
    ("ratio of damping", 15, '<actuator><position joint="elbow" dampratio="1"/></actuator>', 15, 'dampratio="1" of <position> is not read; expected kv'),
    ("ratio of damping in general", 15, '<actuator><general joint="elbow" gainprm="3" biastype="affine" biasprm="0 -3 1"/></actuator>', 15, "the third number of biasprm of <general> is above 0"),
    ("servo at a site", 15, '<actuator><position site="upper"/></actuator>', 15, "<position> at a site, free joint or ball joint is not read, as its force depends on the motion; expected a <motor> there"),
    ("motor at no site", 15, '<actuator><motor site="eye"/></actuator>', 15, "there is no site 'eye' for a <motor>; expected an existing name"),
    ("motor between sites", 15, '<actuator><motor site="upper" refsite="lower"/></actuator>', 15, f'refsite="lower" of <motor> {UNKNOWN}'),
    ("copies without number", 11, '<geom size="0.1"/><replicate/>', 11, 'count="" of <replicate> is not valid; expected 1 to 1000'),
    ("part of a copy", 11, '<geom size="0.1"/><replicate count="1.5"/>', 11, 'count="1.5" of <replicate> is not valid'),
    ("copies without end", 11, '<geom size="0.1"/><replicate count="1000"><replicate count="1000"><replicate count="1000"><geom size="0.1"/></replicate></replicate></replicate>', 11, "more than 20000 elements are copied by <replicate>; expected fewer"),
    ("offset of copies", 11, '<geom size="0.1"/><replicate count="2" offset="1"/>', 11, 'offset="1" of <replicate> is not valid; expected 3 numbers'),
    ("equality of a copy and another", 15, '<worldbody><replicate count="2"><body name="x"><joint name="j"/><geom size="1"/></body></replicate></worldbody><equality><joint joint1="j" joint2="elbow"/></equality>', 15, "a <joint> of <equality> is between an element of a <replicate> and another one; expected both in the <replicate>"),
    ("copies of one name", 15, '<worldbody><replicate count="2"><body name="x"><joint name="j"/><geom size="1"/></body></replicate><body name="x1"/></worldbody>', 15, "the link 'x1' is already defined on line 15"),
    ("include of nothing", 15, "<include/>", 15, "an <include> names no file"),
    ("missing include", 15, '<include file="x.xml"/>', 15, "the file 'x.xml' of an <include> cannot be read: No such file or directory"),
    ("include of itself", 15, '<include file="arm.xml"/>', 15, "the file 'arm.xml' is included twice, or includes itself"),
    ("weld", 15, '<equality><weld body1="uper"/></equality>', 15, "there is no body 'uper' for a <weld>; expected an existing name"),
    ("weld to its own", 15, '<equality><weld body1="upper" body2="upper"/></equality>', 15, "nothing moves along or about the axes that the joint 'loop1' constrains"),
    ("weld without rotation", 15, '<equality><weld body1="lower" torquescale="0"/></equality>', 15, 'torquescale="0" of <weld> constrains no rotation; expected a <connect>'),
    ("no anchor", 15, '<equality><connect body1="lower"/></equality>', 15, "<connect> needs the attribute 'anchor'"),
    ("one site", 15, '<equality><connect site1="lower"/></equality>', 15, "<connect> needs the attribute 'site2'"),
    ("pose", 15, '<equality><weld body1="lower" relpose="1 2 3"/></equality>', 15, 'relpose="1 2 3" of <weld> is not valid; expected 7 numbers'),
    ("flex", 15, '<equality><flex name="a"/></equality>', 15, f"<flex> {UNKNOWN} expected rigid bodies"),
    ("distance", 15, '<equality><distance geom1="a"/></equality>', 15, f"<distance> {UNKNOWN} expected a <joint>, <tendon>, <connect> or <weld>"),
    ("tendon as long as itself", 15, '<tendon><fixed name="t"><joint joint="elbow" coef="1"/></fixed></tendon><equality><tendon tendon1="t" tendon2="t"/></equality>', 15, "the tendon 't' is its own tendon2"),
    ("link of no tendon", 15, '<equality><tendon tendon1="t"/></equality>', 15, "there is no tendon 't' for a <tendon>; expected an existing name"),
]  # fmt: skip


def check(folder, text, line, message):
    (folder / "arm.xml").write_text(text)
    result = lagc("arm.xml", "-o", "out", cwd=folder)
    assert result.returncode == 1, result.stderr
    assert re.search(rf"^arm\.xml:{line}: .*{re.escape(message)}", result.stderr, re.MULTILINE), result.stderr
    assert not (folder / "out").exists()


def test_the_valid_robot_compiles(tmp_path):
    (tmp_path / "arm.xml").write_text(RIGHT)
    result = lagc("arm.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0 and result.stderr == (
        "arm.xml:7: warning: motion is not stopped at the limits of the joint 'shoulder'; expected limits=\"stops\", or \"outputs\" if this is meant, in an <include>, or --limits stops on the command line\n"
    )


@pytest.mark.parametrize("name, replaced, new, line, message", CASES, ids=[case[0] for case in CASES])
def test_bad_line(name, replaced, new, line, message, tmp_path):
    lines = RIGHT.splitlines()
    lines[replaced - 1] = new
    check(tmp_path, "\n".join(lines), line, message)


def test_mistakes_in_included_files(tmp_path):
    lines = RIGHT.splitlines()
    for i in range(10):
        (tmp_path / f"part{i}.xml").write_text(f'<mujoco><include file="part{i + 1}.xml"/></mujoco>')
    (tmp_path / "broken.xml").write_text("<mujoco>\n<worldbody></mujoco>")
    (tmp_path / "motors.xml").write_text('<parts>\n\n<motor joint="wrist"/></parts>')
    lines[14] = '<include file="part0.xml"/>'
    check(tmp_path, "\n".join(lines), 15, "more than 8 files include each other in a row")
    lines[14] = '<actuator><include file="motors.xml"/></actuator>'
    (tmp_path / "arm.xml").write_text("\n".join(lines))
    (tmp_path / "system.xml").write_text('<system name="S"><include file="arm.xml" as="arm"/></system>')
    for file in ("arm.xml", "system.xml"):
        result = lagc(file, "-o", "out", cwd=tmp_path)
        assert result.returncode == 1 and re.search(r"^motors\.xml:3: there is no joint 'wrist' for an actuator.*\(included on line 15 of arm\.xml\)", result.stderr, re.MULTILINE), (
            result.stderr
        )
    lines[14] = '<include file="broken.xml"/>'
    (tmp_path / "arm.xml").write_text("\n".join(lines))
    result = lagc("arm.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(r"^broken\.xml:2: .*\(included on line 15 of arm\.xml\)", result.stderr, re.MULTILINE), result.stderr


KEYS = '<keyframe><key name="home" qpos="0.1 0.2"/><key name="short" qpos="1"/><key name="odd" qvel="0 x"/><key name="free" ctrl="1 2"/></keyframe>'
BAD_KEYS = [
    ("hom", 1, "there is no <key> 'hom'; did you mean 'home'?"),
    ("short", 16, 'qpos="1" of <key> is not valid; expected 2 numbers'),
    ("odd", 16, 'qvel="0 x" of <key> is not valid; expected 2 numbers'),
    ("free", 16, 'ctrl="1 2" of <key> is not valid; expected 1 number'),
]


@pytest.mark.parametrize("key, line, message", BAD_KEYS)
def test_bad_keyframe(key, line, message, tmp_path):
    (tmp_path / "arm.xml").write_text(RIGHT.replace("</mujoco>", f"{KEYS}\n</mujoco>"))
    (tmp_path / "system.xml").write_text(f'<system name="S"><include file="arm.xml" as="arm" keyframe="{key}"/></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(rf"^arm\.xml:{line}: {re.escape(message)}", result.stderr, re.MULTILINE), result.stderr


def test_no_world(tmp_path):
    check(tmp_path, "<mujoco>\n</mujoco>", 1, "<mujoco> has no <worldbody>; expected one in it")
    check(tmp_path, "<mujoco>\n<worldbody/></mujoco>", 1, "no joint of the robot moves")


def test_entities_that_multiply_are_errors(tmp_path):
    entities = "".join(f'<!ENTITY a{i} "{"".join(f"&a{i - 1};" for _ in range(10))}">' for i in range(1, 12))
    text = f'<!DOCTYPE mujoco [<!ENTITY a0 "lol">{entities}]>\n<mujoco model="&a11;"><worldbody/></mujoco>'
    (tmp_path / "arm.xml").write_text(text)
    result = lagc("arm.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(r"^arm\.xml:\d+: ", result.stderr, re.MULTILINE), result.stderr
