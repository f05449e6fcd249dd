"""Calculated parameters, against a rod's closed form and derivatives by hand."""

import re
import subprocess
import sys

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.validation import validate_fmu

import fmu
from closed_forms import pendulum_angle
from fmu import ERROR, OK, ROOT, lagc

# J, k and w stand before and after the parameters that they depend on, and in a loop.
ROD = """<system name="{name}" description="Rod that is hinged at its end">
  <parameter name="w" value="sqrt(k/J)" unit="rad/s" description="of small swings"/>
  <parameter name="J" value="m*l^2/3" unit="kg.m2" description="inertia about the hinge"/>
  <define name="half">l/2</define>
  <parameter name="m" start="2" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="k" value="m*g*half" unit="N.m"/>
  <for index="i" from="0" to="2"><parameter name="mark[i]" value="i*half" unit="m"/></for>
  <coordinate name="theta" velocity="omega" unit="rad" start="1"/>
  <kinetic>J*omega^2/2</kinetic>
  <potential>-k*cos(theta)</potential>
  <output name="phase" unit="rad/s">w*theta</output>
</system>
"""
LINEAR = """<linearization of="../CalculatedRod/system.xml" name="CalculatedLinear">
  <at name="theta" value="pi*J/J"/>
</linearization>
"""
GRAVITY = 9.81


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("calculated", {"CalculatedRod": ROD.format(name="CalculatedRod"), "CalculatedLinear": LINEAR})
    fmu.build_systems("calculated-tables", {"CalculatedTables": ROD.format(name="CalculatedTables")}, "--form", "tables")


def expected(m, l):
    k, J = m * GRAVITY * l / 2, m * l**2 / 3
    return {"J": J, "k": k, "w": np.sqrt(1.5 * GRAVITY / l), "mark[0]": 0.0, "mark[1]": l / 2, "mark[2]": l}


def check(instance, m, l):
    for name, value in expected(m, l).items():
        assert instance.get(name) == pytest.approx(value, rel=1e-14), name


BOTH_FORMS = pytest.mark.parametrize("name", ["CalculatedRod", "CalculatedTables"])


@BOTH_FORMS
def test_values_follow_at_once(name, open_fmu):
    instance = open_fmu(name)
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    check(instance, 2.0, 0.5)
    instance.set(m=3.0, l=0.8)
    check(instance, 3.0, 0.8)
    assert all(status == OK for status, _, _ in instance.messages)  # they are InitialUnknowns, which may be read in this state
    instance.fmu.exitInitializationMode()
    instance.step(0.1)
    instance.set(l=1.5)
    check(instance, 3.0, 1.5)
    instance.reset()
    instance.initialize()
    check(instance, 2.0, 0.5)


@BOTH_FORMS
def test_motion(name, open_fmu):
    instance = open_fmu(name).initialize({"l": 0.7})
    for time in (0.5, 1.0, 2.0):
        instance.step(time - instance.time)
        assert abs(instance.get("theta") - pendulum_angle(1, np.sqrt(1.5 * GRAVITY / 0.7), time)) < 1e-7


def test_motion_after_tuning(open_fmu):
    """The state continues as in an instance that starts there with the new length."""
    tuned, fresh = open_fmu("CalculatedRod").initialize(), open_fmu("CalculatedRod")
    tuned.step(0.3)
    tuned.set(l=1.1)
    fresh.initialize({"l": 1.1, "theta": tuned.get("theta"), "omega": tuned.get("omega")})
    assert tuned.get("der(omega)") == pytest.approx(-1.5 * GRAVITY / 1.1 * np.sin(tuned.get("theta")), rel=1e-13)
    for instance in (tuned, fresh):
        instance.step(0.5)
    assert abs(tuned.get("theta") - fresh.get("theta")) < 1e-8


@pytest.mark.parametrize("name, sources", [("J", "m, l"), ("w", "l, g"), ("mark[1]", "l")])
def test_setting_is_an_error(name, sources, open_fmu):
    instance = open_fmu("CalculatedRod")
    with instance.fails(ERROR, rf"'{re.escape(name)}' is calculated from other parameters \({sources}\)"):
        instance.set({name: 1.0})


def test_setting_one_without_others_is_an_error(open_fmu):
    instance = open_fmu("CalculatedRod")
    with instance.fails(ERROR, r"'mark\[0\]' is calculated and cannot be set"):
        instance.set({"mark[0]": 1.0})


def test_description():
    description = fmu.description("CalculatedRod")
    variables = {v.name: v for v in description.modelVariables}
    assert fmu.names_of("CalculatedRod", "calculatedParameter") == [
        v.name for v in description.modelVariables if v.name in expected(1, 1)]  # fmt: skip
    for name in expected(1, 1):
        variable = variables[name]
        assert (variable.variability, variable.initial, variable.start) == ("tunable", "calculated", None)
    assert [variables[name].unit for name in ("J", "k", "w")] == ["kg.m2", "N.m", "rad/s"]
    assert variables["J"].description == "inertia about the hinge"
    unknowns = {u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns}
    assert unknowns["J"] == {"m", "l"} and unknowns["k"] == {"m", "l", "g"} and unknowns["mark[1]"] == {"l"}
    assert unknowns["mark[0]"] == set()
    for name in ("CalculatedRod", "CalculatedLinear"):
        assert validate_fmu(str(fmu.archive(name))) == []


@pytest.mark.parametrize("kind", [{}, {"kind": FMU2Model}])
@BOTH_FORMS
def test_derivatives_by_parameters(name, kind, open_fmu):
    m, l, theta = 2.0, 0.5, 1.0
    instance = open_fmu(name, **kind).initialize()
    along = instance.fmu.getDirectionalDerivative(instance.vr("J", "k", "w", "der(omega)", "phase"), instance.vr("l"), [1.0])
    slope = -np.sqrt(1.5 * GRAVITY) / 2 * l**-1.5
    exact = [2 * m * l / 3, m * GRAVITY / 2, slope, 1.5 * GRAVITY * np.sin(theta) / l**2, slope * theta]
    np.testing.assert_allclose(along, exact, rtol=1e-13)
    assert instance.fmu.getDirectionalDerivative(instance.vr("J"), instance.vr("m"), [3.0]) == pytest.approx([l**2])


def test_linearization(open_fmu):
    """theta - pi = (1 - pi) cosh(rate t) for the pendulum linearized about its upper equilibrium."""
    instance = open_fmu("CalculatedLinear").initialize({"l": 0.9})
    check(instance, 2.0, 0.9)
    instance.step(0.4)
    assert abs(instance.get("theta") - np.pi - (1 - np.pi) * np.cosh(np.sqrt(1.5 * GRAVITY / 0.9) * 0.4)) < 1e-9


def test_matrices(tmp_path):
    path = tmp_path / "system.xml"
    path.write_text(ROD.format(name="CalculatedRod"))
    printed = lagc("--linearize", path, "--at", "theta=0*J/J").stdout
    numbers = printed[printed.index("at m = 2, l = 0.5, g = 9.81:") :]
    assert "J" not in printed
    assert float(re.search(r"A =\n  .*\n  \[(.*), 0\]", numbers).group(1)) == pytest.approx(-1.5 * GRAVITY / 0.5, rel=1e-12)


def test_documentation_has_the_formulas():
    page = (fmu.unpacked("CalculatedRod") / "documentation" / "index.html").read_text()
    part = page[page.index("Calculated parameters</h2>") : page.index("Energies</h2>")]
    assert ">J = m*l^2/3</code>" in part and ">mark[2] = l</code>" in part
    assert "<th>J</th><td>calculated parameter</td><td>kg.m2</td><td></td><td>inertia about the hinge</td>" in page


@pytest.mark.parametrize("script, words, message", [
    ("run.py", ["J=1"], "'J' of CalculatedRod cannot be set, as it follows from other parameters; these can be: theta, omega, m, l, g"),
    ("sweep.py", ["--vary", "J=1,2"], "'J' has no start value in CalculatedRod, as it follows from other parameters; these have one: theta, omega, m, l, g"),
])  # fmt: skip
def test_scripts_cannot_set_it(script, words, message, tmp_path):
    command = [sys.executable, ROOT / "scripts" / "commands" / script, fmu.archive("CalculatedRod"), *words]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == 1 and message in result.stderr, result.stderr


@pytest.mark.parametrize("line, message", [
    ('<parameter name="a" value="2*b"/><parameter name="b" value="a"/>', "in a circle: a -> b -> a; expected"),
    ('<parameter name="a" value="c"/><define name="c">2*a</define>', "in a circle: a -> c -> a; expected"),
    ('<parameter name="a" value="m*l" unit="kg"/>', "the value of the parameter has the unit kg.m, expected kg"),
    ('<parameter name="a" value="m + l"/>', "unit mismatch: kg and m in one sum"),
    ('<parameter name="a" value="2*theta"/>', "value of <parameter> cannot depend on coordinates, but 'theta' does"),
    ('<parameter name="a" value="time"/>', "cannot depend on time, but 'time' does; expected numbers and parameters"),
    ('<parameter name="a" value="omega"/>', "cannot depend on velocities, but 'omega' does; expected numbers and parameters"),
    ('<parameter name="a" value="m" start="1"/>', "a <parameter> has a value and a start; expected"),
    ('<parameter name="a" value="m" min="1"/>', "a <parameter> has a value and a min; expected"),
    ('<parameter name="a" value="m" max="1"/>', "a <parameter> has a value and a max; expected"),
    ('<parameter name="a" value="n"/>', "unknown name 'n'"),
    ('<parameter name="J" value="m"/>', "the name 'J' is already defined on line 3"),
    ('<parameter name="l" value="m"/>', "the name 'l' is already defined on line"),
    ('<parameter name="a" unit="m"/>', '<parameter> needs the attribute \'start\'; expected start="...", value="..." for one that'),
    ('<parameter name="a" value=""/>', 'value="" of <parameter> is empty'),
    ('<parameter name="a" start="J"/>', "unknown name 'J'"),
])  # fmt: skip
def test_errors(line, message, tmp_path):
    path = tmp_path / "system.xml"
    path.write_text(ROD.format(name="CalculatedRod").replace("</system>", f"  {line}\n</system>"))
    result = lagc(path, "-o", tmp_path / "out")
    assert result.returncode == 1 and message in result.stderr, result.stderr
    assert len(result.stderr.splitlines()) == 1, result.stderr
