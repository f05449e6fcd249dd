"""Attributes for users of the FMU: display units, author, and license."""

import math
import xml.etree.ElementTree as ElementTree

import fmpy
import pytest
from fmpy.validation import validate_fmu

import fmu
from fmu import lagc

ORIGIN = {"author": "A. Author & B. Author", "version": "1.2", "copyright": "(c) 2026 the authors", "license": "CC0-1.0"}
SYSTEM = """<system name="Shown" description="Rod" author="A. Author &amp; B. Author" version="1.2" copyright="(c) 2026 the authors" license="CC0-1.0">
  <parameter name="l" start="0.5" unit="m" displayUnit="mm"/>
  <parameter name="m" start="1" unit="kg" displayUnit="g"/>
  <parameter name="w" value="l/5" unit="m" displayUnit="cm"/>
  <parameter name="n" start="10" unit="rad/s" displayUnit="rpm"/>
  <input name="tau" unit="N.m" displayUnit="N.mm"/>
  <for index="i" from="1" to="2">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" displayUnit="deg" velocityDisplayUnit="deg/s" start="i"/>
    <kinetic>m*l^2*omega[i]^2/2</kinetic><force coordinate="theta[i]">tau</force>
  </for>
  <state name="heat" unit="K" displayUnit="degC" start="293.15" rate="0"/>
  <output name="speed" unit="rad/s" displayUnit="rpm">omega[1] + n</output>
</system>"""
# The value of each unit in SI units.
UNITS = {"mm": 1e-3, "g": 1e-3, "cm": 1e-2, "rpm": 2 * math.pi / 60, "N.mm": 1e-3, "deg": math.pi / 180, "deg/s": math.pi / 180, "degC": 1}
SHOWN = dict(l="mm", m="g", w="cm", n="rpm", tau="N.mm", theta="deg", omega="deg/s", speed="rpm", heat="degC")


@pytest.fixture(scope="module")
def archives():
    fmu.build_systems("shown", {"Shown": SYSTEM}, "--arrays", versions=[2, 3])
    second = fmu.archive("Shown")
    return [second, second.parent.parent / "fmi3" / second.name]


def test_importers_get_them(archives):
    for archive in archives:
        assert validate_fmu(str(archive)) == []
        description = fmpy.read_model_description(str(archive))
        factors = {shown.name: (unit.name, shown.factor) for unit in description.unitDefinitions for shown in unit.displayUnits}
        assert {name: 1 / float(factor) for name, (_, factor) in factors.items()} == pytest.approx(UNITS, rel=1e-15)
        offsets = {shown.name: float(shown.offset or 0) for unit in description.unitDefinitions for shown in unit.displayUnits}
        assert offsets == {name: -273.15 if name == "degC" else 0 for name in UNITS}
        shown = {variable.name.split("[")[0]: variable.displayUnit for variable in description.modelVariables if variable.displayUnit}
        assert {name: unit.name if hasattr(unit, "name") else unit for name, unit in shown.items()} == SHOWN
        for variable in description.modelVariables:
            if variable.displayUnit:
                assert factors[SHOWN[variable.name.split("[")[0]]][0] == variable.unit
        assert {name: getattr(description, name) for name in ORIGIN} == ORIGIN
        assert description.generationTool == f"lagrange-fmu {lagc('--version').stdout.split()[-1]}"


def test_values_stay_in_si(archives):
    for archive in archives:
        result = fmpy.simulate_fmu(str(archive), start_values={"l": 0.25}, stop_time=0.1, output=["speed"])
        assert result["speed"][0] == 10


def test_elements_that_are_shown_alike_are_an_array(archives):
    root = ElementTree.fromstring((fmu.unpacked_archive(archives[1]) / "modelDescription.xml").read_text())
    (theta,) = [variable for variable in root.iter("Float64") if variable.get("name").startswith("theta")]
    assert theta.get("name") == "theta" and theta.find("Dimension").get("start") == "2"


@pytest.mark.parametrize("unit, message", [
    ('unit="m" displayUnit="furlong"', "displayUnit 'furlong' is not known; expected a unit that is not SI, such as deg, rpm, deg/s, mm, kN or degC"),
    ('unit="m" displayUnit="m"', "displayUnit 'm' is not known"),
    ('unit="m" displayUnit="deg"', "displayUnit 'deg' is for values in rad; expected this as the unit"),
    ('unit="Hz" displayUnit="rpm"', "displayUnit 'rpm' is for values in rad/s; expected this as the unit"),
    ('displayUnit="mm"', "displayUnit 'mm' is for values in m; expected this as the unit"),
])  # fmt: skip
def test_attributes_that_cannot_be_shown(unit, message, tmp_path):
    (tmp_path / "system.xml").write_text(f'<system name="Wrong"><input name="u" {unit}/><output name="y">u</output></system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and f"system.xml:1: {message}" in result.stderr
