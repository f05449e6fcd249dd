"""<task>: the annotations of both descriptions, messages, and that equations do not depend on tasks."""

from xml.etree import ElementTree

import pytest

from fmu import lagc

SYSTEM = """<system name="Toy">
  <constant name="reach" value="0.5" unit="m"/>
  <parameter name="m" start="1" unit="kg"/>
  <input name="u" unit="N"/>
  <coordinate name="x" velocity="v" unit="m"/>
  <particle name="body" mass="m" x="x"/>
  <force coordinate="x">u</force>
  <preset name="far"><at name="x" value="1"/></preset>
@</system>
"""
TASKS = """  <task name="return" description="Return &amp; rest" preset="far" hold="2" limit="10">
    <goal min="-0.1" max="reach">body.x^2</goal>
    <goal max="0.1">abs(der(body.x))*if(x > 0, 2, 1)</goal>
  </task>
  <task name="go"><goal min="1">x</goal></task>
"""


def derived(folder, tasks):
    (folder / "system.xml").write_text(SYSTEM.replace("@", tasks))
    return lagc("system.xml", "-o", "out", cwd=folder)


@pytest.mark.parametrize("version, place", [(2, "VendorAnnotations/Tool[@name='lagrange-fmu.tasks']"), (3, "Annotations/Annotation[@type='lagrange-fmu.tasks']")])
def test_tasks_are_annotations(version, place, tmp_path):
    result = derived(tmp_path, TASKS)
    assert (result.returncode, result.stderr) == (0, "")
    folder = tmp_path / "out" / "fmi3" if version == 3 else tmp_path / "out"
    tasks = [(dict(task.attrib), [dict(goal.attrib) for goal in task]) for task in ElementTree.parse(folder / "modelDescription.xml").findall(f"{place}/tasks/task")]
    goals = [{"min": "-0.1", "max": "0.5", "formula": "x^2"}, {"max": "0.1", "formula": "abs(v)*if(x > 0, 2, 1)"}]
    assert tasks == [({"name": "return", "description": "Return & rest", "preset": "far", "hold": "2", "limit": "10"}, goals), ({"name": "go", "hold": "0"}, [{"min": "1", "formula": "x"}])]


def test_equations_do_not_depend_on_tasks(tmp_path):
    """The goals have abs() and a condition, but the system has no events."""
    texts = []
    for i, tasks in enumerate(("", TASKS)):
        (tmp_path / str(i)).mkdir()
        assert derived(tmp_path / str(i), tasks).returncode == 0
        texts.append((tmp_path / str(i) / "out" / "system.c").read_text().splitlines())
    different = [pair for pair in zip(*texts, strict=True) if pair[0] != pair[1]]
    assert len(different) <= 1, "the GUID alone"


@pytest.mark.parametrize("task, message", [
    ('<task name="t"/>', "the task 't' has no goal; expected <goal min"),
    ('<task name="t"><goal>x</goal></task>', "the goal has no limits; expected min, max or both"),
    ('<task name="t"><goal min="1" max="0">x</goal></task>', "the goal's min is 1, above its max, 0; expected a min below it"),
    ('<task name="t"><goal min="1">y</goal></task>', "'y'"),
    ('<task name="t"><goal min="m">x</goal></task>', "cannot depend on parameters, but 'm' does"),
    ('<task name="t" hold="-1"><goal min="1">x</goal></task>', "hold is -1 s; expected a time of at least 0"),
    ('<task name="t" hold="2" limit="1"><goal min="1">x</goal></task>', "limit is 1 s; expected a time above hold, 2 s"),
    ('<task name="t" preset="near"><goal min="1">x</goal></task>', "starts from the preset 'near', which does not exist; expected the name of a <preset>"),
    ('<task><goal min="1">x</goal></task>', "<task> needs the attribute 'name'"),
])  # fmt: skip
def test_messages(task, message, tmp_path):
    result = derived(tmp_path, f"  {task}\n")
    assert result.returncode == 1 and "system.xml:9: " in result.stderr and message in result.stderr, result.stderr


def test_two_of_one_name(tmp_path):
    result = derived(tmp_path, 2 * '  <task name="t"><goal min="1">x</goal></task>\n')
    assert result.returncode == 1 and "system.xml:10: the task 't' is defined already; expected another name" in result.stderr
