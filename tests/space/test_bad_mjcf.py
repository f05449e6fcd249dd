"""Invalid MJCF files: each gives the expected line and message, and no output."""

import re

import pytest

from bad_inputs import check_error, inputs
from fmu import lagc

# A valid robot, of which some tests change a line.
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


@inputs("space/bad_mjcf")
def test_bad_line(file, tmp_path):
    check_error(file, "arm.xml", tmp_path)


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


# A hand in another file, whose tendon refers to two bodies.
HAND = """<mujoco>
<worldbody>
<body name="palm"><joint name="turn" axis="0 1 0" range="1 0"/><geom size="0.1"/><body name="finger"><joint name="bend"/><geom size="0.1"/></body></body>
</worldbody>
<tendon><fixed name="both"><joint joint="turn" coef="1"/><joint joint="bend" coef="1"/></fixed></tendon>
</mujoco>"""
ATTACHING = """<mujoco model="arm"><compiler conflict="{conflict}"/>
<asset><model name="hand" file="{file}"/></asset>
<worldbody><body name="arm"><joint name="{joint}"/><geom size="0.1"/>
<attach model="hand" body="{body}" prefix="h_"/>
</body></worldbody></mujoco>"""
BAD_ATTACHMENTS = [
    ({"body": "fingr"}, "arm.xml:4", "there is no body 'fingr' in the <model> 'hand'; did you mean 'finger'?"),
    ({}, "hand.xml:3", "range of <joint> is from 1 to 0; expected the lower one first (attached on line 4 of arm.xml)"),
    ({"file": "arm.xml", "body": ""}, "arm.xml:2", "more than 8 files attach each other in a row, or more than 1000 in all; expected fewer (attached on line 4 of arm.xml)"),
    ({"file": "system.xml"}, "system.xml:1", "<system> is the first element of a <model>; expected <mujoco> (attached on line 4 of arm.xml)"),
    (
        {"joint": "turn", "body": "finger"},
        "arm.xml:4",
        "a <fixed> of the <model> 'hand' refers to the body 'finger' and to the joint 'turn' outside of it, a name in this file too; expected another name",
    ),
    ({"conflict": "merge"}, "arm.xml:1", 'conflict="merge" of <compiler> is not read; expected the <option>s in the robot\'s file'),
]


@pytest.mark.parametrize("change, place, message", BAD_ATTACHMENTS)
def test_bad_attachments(change, place, message, tmp_path):
    (tmp_path / "hand.xml").write_text(HAND)
    (tmp_path / "arm.xml").write_text(ATTACHING.format(**({"file": "hand.xml", "body": "palm", "joint": "elbow", "conflict": "warning"} | change)))
    (tmp_path / "system.xml").write_text('<system name="S"><include file="arm.xml" as="arm"/></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(rf"^{place}: {re.escape(message)}", result.stderr, re.MULTILINE), result.stderr


def test_lines_of_included_files(tmp_path):
    """Messages that name a second line name it in the file where it is."""
    (tmp_path / "part.xml").write_text('<mujocoinclude>\n\n\n<body name="a"><joint/><geom size="0.1"/></body>\n</mujocoinclude>')
    text = '<mujoco><worldbody>\n<include file="part.xml"/>\n<body name="a"><joint/><geom size="0.1"/></body>\n</worldbody></mujoco>'
    check(tmp_path, text, 3, "the link 'a' is already defined on line 4; expected another name")


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


def test_adhesion_on_the_ground(tmp_path):
    (tmp_path / "arm.xml").write_text(RIGHT.replace('<motor name="push" joint="elbow" gear="2"/>', '<adhesion body="lower" ctrlrange="0 1"/>'))
    (tmp_path / "system.xml").write_text('<system name="S"><include file="arm.xml" as="arm" ground="true"/></system>')
    message = "<adhesion> is not read, and would change the motion; expected a <force> on the body in a <system>"
    assert re.search(rf"^arm\.xml:15: {re.escape(message)}", lagc("system.xml", "-o", "out", cwd=tmp_path).stderr, re.MULTILINE)


def test_no_world(tmp_path):
    check(tmp_path, "<mujoco>\n</mujoco>", 1, "<mujoco> has no <worldbody>; expected one in it")
    check(tmp_path, "<mujoco>\n<worldbody/></mujoco>", 1, "no joint of the robot moves")


def test_entities_that_multiply_are_errors(tmp_path):
    entities = "".join(f'<!ENTITY a{i} "{"".join(f"&a{i - 1};" for _ in range(10))}">' for i in range(1, 12))
    text = f'<!DOCTYPE mujoco [<!ENTITY a0 "lol">{entities}]>\n<mujoco model="&a11;"><worldbody/></mujoco>'
    (tmp_path / "arm.xml").write_text(text)
    result = lagc("arm.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(r"^arm\.xml:\d+: ", result.stderr, re.MULTILINE), result.stderr
