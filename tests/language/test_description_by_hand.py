"""modelDescription.xml of small systems from lagc alone, against values known by hand."""

import re

import pytest
from lxml import etree

from fmu import lagc

SYSTEM = """\
<system name="ByHand">
  <parameter name="m" start="2" unit="kg" min="0.5" max="8" description="mass"/>
  <parameter name="k" start="3" unit="N/m"/>
  <input name="F" unit="N" start="0.5"/>
  <coordinate name="x" velocity="v" unit="m" start="0.25" nominal="20" velocityStart="-1" velocityNominal="400"/>
  <coordinate name="y" velocity="w" unit="m"/>
  <particle name="one" mass="m" x="x"/>
  <particle mass="2" x="y"/>
  <potential>k*x^2/2</potential>
  <force coordinate="x">F</force>
  {}
</system>
"""
MORE = """
  <potential>cos(y) - y</potential>
  <output name="constant" unit="1">2*x - w + 3*F</output>
  <output name="tunable">k*x/m + 2*F</output>
  <output name="dependent">x*v + k*y + min(F, 3)</output>
  <output name="acceleration" unit="m/s2">der(v)</output>
  <output name="none">k/m</output>
"""


def description(text, folder):
    (folder / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=folder)
    assert result.returncode == 0, result.stderr
    return etree.parse(folder / "out" / "modelDescription.xml").getroot()


def structure(root, section):
    """For each unknown by name, the kind of dependency on each known by name."""
    names = [variable.get("name") for variable in root.find("ModelVariables")]
    return {
        names[int(unknown.get("index")) - 1]: dict(
            zip(
                (names[int(i) - 1] for i in unknown.get("dependencies").split()),
                unknown.get("dependenciesKind").split(),
                strict=True,
            )
        )
        for unknown in root.find(f"ModelStructure/{section}")
    }


def test_kinds_of_dependencies(tmp_path):
    """m v' = F - k x, 2 w' = 1 + sin(y). A numeric factor is constant, a factor of parameters tunable, everything else dependent."""
    root = description(re.sub(' unit="[^"]*"', "", SYSTEM.format(MORE)), tmp_path)
    assert structure(root, "Derivatives") == {
        "der(x)": {"v": "constant"},
        "der(y)": {"w": "constant"},
        "der(v)": {"x": "tunable", "F": "tunable"},
        "der(w)": {"y": "dependent"},
    }
    states = {name: {name: "constant"} for name in "xyvw"}
    assert structure(root, "Outputs") == states | {
        "constant": {"x": "constant", "w": "constant", "F": "constant"},
        "tunable": {"x": "tunable", "F": "constant"},
        "dependent": {"x": "dependent", "v": "dependent", "y": "tunable", "F": "dependent"},
        "acceleration": {"x": "tunable", "F": "tunable"},
        "none": {},
    }
    # Parameters are knowns of the initial unknowns, where "tunable" does not apply (FMI 2.0, section 2.2.8).
    assert structure(root, "InitialUnknowns") == {
        "der(x)": {"v": "constant"},
        "der(y)": {"w": "constant"},
        "der(v)": {"x": "dependent", "F": "dependent", "k": "dependent", "m": "dependent"},
        "der(w)": {"y": "dependent"},
        "constant": {"x": "constant", "w": "constant", "F": "constant"},
        "tunable": {"x": "dependent", "F": "constant", "k": "dependent", "m": "dependent"},
        "dependent": {"x": "dependent", "v": "dependent", "y": "dependent", "F": "dependent", "k": "dependent"},
        "acceleration": {"x": "dependent", "F": "dependent", "k": "dependent", "m": "dependent"},
        "none": {"k": "dependent", "m": "dependent"},
    }


def test_kinds_behind_a_coupled_block(tmp_path):
    """The coupled accelerations of three masses with inerters are solved at run time; they depend on all that moves any of the masses."""
    root = description(
        """<system name="Row"><parameter name="k" start="1"/><input name="F"/>
  <for index="i" from="1" to="3"><coordinate name="x[i]" velocity="v[i]"/><particle mass="1" x="x[i]"/></for>
  <for index="i" from="2" to="3"><kinetic>(v[i] - v[i-1])^2/2</kinetic></for>
  <coordinate name="alone" velocity="u"/><particle mass="1" x="alone"/><potential>k*x[1]^2 + alone^2</potential>
  <force coordinate="x[3]">F</force>
</system>""",
        tmp_path,
    )
    derivatives = structure(root, "Derivatives")
    for i in (1, 2, 3):
        assert derivatives[f"der(v[{i}])"] == {"x[1]": "dependent", "F": "dependent"}
    assert derivatives["der(u)"] == {"alone": "constant"}


def attributes(root, path):
    return dict(root.find(path).attrib)


@pytest.mark.parametrize(
    "element, expected",
    [
        ("", (0, 10, 1e-8, 0.01)),
        ('<experiment startTime="2"/>', (2, 12, 1e-8, 0.01)),
        ('<experiment stopTime="4"/>', (0, 4, 1e-8, 0.004)),
        ('<experiment startTime="-1" stopTime="4" stepSize="0.5"/><solver method="taylor" tolerance="1e-5"/>', (-1, 4, 1e-5, 0.5)),
    ],
)
def test_default_experiment(element, expected, tmp_path):
    experiment = attributes(description(SYSTEM.format(element), tmp_path), "DefaultExperiment")
    names = ("startTime", "stopTime", "tolerance", "stepSize")
    assert set(experiment) == set(names)
    assert tuple(float(experiment[name]) for name in names) == pytest.approx(expected, rel=1e-15)


def test_capabilities(tmp_path):
    both = dict(canGetAndSetFMUstate="true", canSerializeFMUstate="true", providesDirectionalDerivative="true", modelIdentifier="ByHand")
    with_inputs = description(SYSTEM.format(""), tmp_path)
    steps = both | dict(canHandleVariableCommunicationStepSize="true", canInterpolateInputs="true", maxOutputDerivativeOrder="20")
    exchange = both | dict(completedIntegratorStepNotNeeded="true")
    assert attributes(with_inputs, "ModelExchange") == exchange and attributes(with_inputs, "CoSimulation") == steps
    assert with_inputs.get("numberOfEventIndicators") == "0" and with_inputs.get("fmiVersion") == "2.0"
    # The source list is complete for solvers without SUNDIALS. erk and bdf have no series, nor has a system with a kink.
    for section in ("ModelExchange", "CoSimulation"):
        assert [file.get("name") for file in with_inputs.find(f"{section}/SourceFiles")] == ["ByHand.c"]
    kink = description(SYSTEM.format('<output name="o">abs(x)</output>'), tmp_path)
    assert attributes(kink, "CoSimulation") == steps | dict(maxOutputDerivativeOrder="1")
    stiff = description(SYSTEM.format('<solver method="bdf"/>'), tmp_path)
    assert attributes(stiff, "CoSimulation") == steps | dict(maxOutputDerivativeOrder="1")
    assert stiff.find("CoSimulation/SourceFiles") is None and stiff.find("ModelExchange/SourceFiles") is None
    alone = description(SYSTEM.replace('<input name="F" unit="N" start="0.5"/>', "").replace(">F<", ">-k*x<").format(""), tmp_path)
    assert "canInterpolateInputs" not in attributes(alone, "CoSimulation")


def test_values_of_variables(tmp_path):
    root = description(SYSTEM.format(""), tmp_path)
    variables = {variable.get("name"): variable for variable in root.find("ModelVariables")}
    assert dict(variables["x"][0].attrib) == dict(declaredType="SI.Length", unit="m", nominal="20", start="0.25")
    assert dict(variables["v"][0].attrib) == dict(declaredType="SI.Velocity", unit="m/s", nominal="400", start="-1")
    assert dict(variables["y"][0].attrib) == dict(declaredType="SI.Length", unit="m", start="0")
    assert dict(variables["F"][0].attrib) == dict(declaredType="SI.Force", unit="N", start="0.5")
    assert dict(variables["m"][0].attrib) == dict(declaredType="SI.Mass", unit="kg", min="0.5", max="8", start="2")
    assert dict(variables["der(v)"][0].attrib) == dict(declaredType="SI.Acceleration", unit="m/s2", derivative="3")
    assert dict(variables["one.x"][0].attrib) == dict(declaredType="SI.Length", unit="m")
    assert variables["m"].get("description") == "mass" and "time" not in variables
    kinds = {name: tuple(variables[name].get(key) for key in ("causality", "variability", "initial")) for name in variables}
    assert kinds["x"] == ("output", "continuous", "exact") and kinds["F"] == ("input", "continuous", None)
    assert kinds["m"] == ("parameter", "tunable", "exact") and kinds["der(v)"] == ("local", "continuous", "calculated")
    assert kinds["one.x"] == kinds["totalEnergy"] == ("local", "continuous", "calculated")
    assert kinds["solverSteps"] == ("local", "discrete", "calculated") and variables["solverSteps"][0].tag == "Integer"
    assert [int(variable.get("valueReference")) for variable in root.find("ModelVariables")] == list(range(len(variables)))


def test_each_unit_once(tmp_path):
    """Each unit is defined once, with the base units known by hand."""
    units = description(SYSTEM.format('<output name="p" unit="Pa">k/x</output>'), tmp_path).findall("UnitDefinitions/Unit")
    exponents = {
        "m": dict(m="1"), "m/s": dict(m="1", s="-1"), "m/s2": dict(m="1", s="-2"), "N": dict(kg="1", m="1", s="-2"),
        "kg": dict(kg="1"), "N/m": dict(kg="1", s="-2"), "Pa": dict(kg="1", m="-1", s="-2"), "J": dict(kg="1", m="2", s="-2"),
    }  # fmt: skip
    assert sorted(unit.get("name") for unit in units) == sorted(exponents)
    assert {unit.get("name"): dict(unit.find("BaseUnit").attrib) for unit in units} == exponents
