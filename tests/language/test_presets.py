"""<preset>: the annotations of both descriptions, messages, and no other change of the FMU."""

from xml.etree import ElementTree

import pytest

from fmu import lagc

SYSTEM = """<system name="Toy">
  <constant name="half" value="pi/2"/>
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="n" type="Integer" start="2"/>
  <parameter name="same" value="m" unit="kg"/>
  <parameter name="on" type="Boolean" start="true"/>
  <input name="u" unit="N"/>
  <coordinate name="x" velocity="speed" unit="m"/>
  <state name="z" unit="m" rate="speed"/>
  <mode name="k" start="0"/>
  <particle mass="m" x="x"/>
  <force coordinate="x">u*on</force>
  <output name="rows" unit="m">n*x + k*x</output>
  <experiment stopTime="1"/>
@</system>
"""
PRESETS = """  <preset name="far" description="Far away &amp; fast">
    <at name="x" value="half"/>
    <at name="speed" value="-3"/>
    <at name="z" value="0.5"/>
    <at name="m" value="2"/>
    <at name="u" value="1e3"/>
    <at name="on" value="0"/>
  </preset>
  <preset name="near"><at name="x" value="0.1"/></preset>
"""


def derived(folder, presets):
    (folder / "system.xml").write_text(SYSTEM.replace("@", presets))
    return lagc("system.xml", "-o", "out", cwd=folder)


@pytest.mark.parametrize("version, place", [(2, "VendorAnnotations/Tool[@name='lagrange-fmu.presets']"), (3, "Annotations/Annotation[@type='lagrange-fmu.presets']")])
def test_presets_are_annotations(version, place, tmp_path):
    result = derived(tmp_path, PRESETS)
    assert (result.returncode, result.stderr) == (0, "")
    folder = tmp_path / "out" / "fmi3" if version == 3 else tmp_path / "out"
    presets = ElementTree.parse(folder / "modelDescription.xml").findall(f"{place}/presets/preset")
    assert [(preset.get("name"), preset.get("description")) for preset in presets] == [("far", "Far away & fast"), ("near", None)]
    values = {at.get("name"): float(at.get("value")) for at in presets[0]}
    assert values == {"x": pytest.approx(1.5707963267948966, rel=1e-16), "speed": -3.0, "z": 0.5, "m": 2.0, "u": 1000.0, "on": 0.0}


def test_equations_do_not_depend_on_presets(tmp_path):
    texts = []
    for i, presets in enumerate(("", PRESETS)):
        (tmp_path / str(i)).mkdir()
        assert derived(tmp_path / str(i), presets).returncode == 0
        texts.append([line for line in (tmp_path / str(i) / "out" / "system.c").read_text().splitlines() if "{" not in line or "guid" not in line.lower()])
    different = [pair for pair in zip(*texts, strict=True) if pair[0] != pair[1]]
    assert len(different) <= 1, "the GUID alone"


@pytest.mark.parametrize("inside, message", [
    ('<at name="y" value="1"/>', "the preset names 'y'; expected a parameter with a start, an input, a coordinate, a velocity or a state"),
    ('<at name="sped" value="1"/>', "the preset names 'sped'; did you mean 'speed'?"),
    ('<at name="same" value="1"/>', "the preset names 'same'; expected a parameter with a start"),
    ('<at name="k" value="1"/>', "the preset names 'k'; expected a parameter with a start"),
    ('<at name="half" value="1"/>', "the preset names 'half'; expected a parameter with a start"),
    ('<at name="m" value="-1"/>', "'m': -1 is outside min and max; expected a value between them"),
    ('<at name="n" value="1.5"/>', "'n': 1.5 is not an Integer; expected a whole number"),
    ('<at name="on" value="2"/>', "'on': 2 is not a Boolean; expected 1 for true or 0 for false"),
    ('<at name="x" value="1"/><at name="x" value="2"/>', "the preset names 'x' twice; expected one value"),
    ('<at name="x" value="m"/>', "cannot depend on parameters, but 'm' does"),
    ('<at name="x"/>', "<at> needs the attribute 'value'"),
    ("", "the preset 'p' sets nothing; expected <at"),
])  # fmt: skip
def test_messages(inside, message, tmp_path):
    result = derived(tmp_path, f'  <preset name="p">{inside}</preset>\n')
    assert result.returncode == 1 and "system.xml:15: " in result.stderr and message in result.stderr, result.stderr


def test_two_of_one_name(tmp_path):
    result = derived(tmp_path, 2 * '  <preset name="p"><at name="x" value="1"/></preset>\n')
    assert result.returncode == 1 and "system.xml:16: the preset 'p' is defined already; expected another name" in result.stderr
