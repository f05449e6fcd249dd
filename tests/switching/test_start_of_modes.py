"""Modes whose start values are expressions of parameters, against motions with constant accelerations."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model
from fmpy.validation import validate_fmu
from lxml import etree

import fmi3
import fmu
from ensemble_runs import ensemble
from fmu import ERROR, lagc
from motions import lagrange_fmu  # noqa: F401 (fixture)

# The acceleration F/m acts up to the way X; the counter begins at 2 k + 1.
PUSH = """<system name="{name}">
  <parameter name="m" start="2" unit="kg" min="0"/>
  <parameter name="F" start="6" unit="N"/>
  <parameter name="X" start="1.5" unit="m"/>
  <parameter name="k" type="Integer" start="3"/>
  <parameter name="c" start="4"/>
  <coordinate name="x" velocity="v" unit="m"/>
  <mode name="a" unit="m/s2" start="F/m"/>
  <mode name="n" start="2*k + 1"/>
  <mode name="root" start="sqrt(c)"/>
  <mode name="fixed" start="5"/>
  <particle mass="m" x="x"/>
  <force coordinate="x">m*a</force>
  <event when="x - X" direction="rising"><set mode="a">0</set><set mode="n">n + 1</set></event>
  <output name="y" unit="m/s2">3*a + fixed*a</output>
</system>
"""
TWO_FORCES = """<system name="StartPushes">
  <parameter name="F" start="10" unit="N"/>
  <include file="../StartPush/system.xml" as="one"><mode name="a" start="2*F/(5*kilo)"/></include>
  <include file="../StartPush/system.xml" as="two"><parameter name="F" value="F"/></include>
  <constant name="kilo" value="1" unit="kg"/>
</system>
"""
LINES = """<system name="StartLines">
  <parameter name="g" start="2" unit="m/s2"/>
  <for index="i" from="1" to="3">
    <coordinate name="x[i]" velocity="v[i]" unit="m"/>
    <mode name="a[i]" unit="m/s2" start="i*g"/>
    <particle mass="1" x="x[i]"/>
    <force coordinate="x[i]">a[i]*1</force>
  </for>
  <event when="x[1] - 100" direction="rising"><set mode="a[1]">0</set></event>
</system>
"""
LINEAR = '<linearization of="../StartPush/system.xml" name="StartLinearPush"/>\n'
BOTH = pytest.mark.parametrize("module", [fmu, fmi3], ids=["2", "3"])
KINDS = pytest.mark.parametrize("kind", [{}, {"kind": FMU2Model}], ids=["cs", "me"])


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"StartPush": PUSH.format(name="StartPush"), "StartPushes": TWO_FORCES, "StartLines": LINES, "StartLinearPush": LINEAR}
    fmu.build_systems("modes-start", texts, versions=(2, 3))
    fmu.build_systems("modes-start-tables", {"StartPushTables": PUSH.format(name="StartPushTables")}, "--form", "tables", versions=(2, 3))


def way(time, a, limit):
    """The way from rest, with the acceleration up to the limit."""
    end = np.sqrt(2 * limit / a)
    return a * time**2 / 2 if time < end else limit + a * end * (time - end)


def opened(module, name, values=(), **options):
    instance = module.Instance(name, **options)
    if module is fmu:
        instance.fmu.setupExperiment()
    instance.set(values)
    instance.fmu.enterInitializationMode()
    return instance


@BOTH
@pytest.mark.parametrize("name", ["StartPush", "StartPushTables"])
def test_motion(module, name):
    for values in ({}, {"F": 10.0, "m": 4.0}, {"X": 0.4, "F": 1.0}):
        instance = module.Instance(name).initialize(values)
        a = values.get("F", 6.0) / values.get("m", 2.0)
        for time in (0.3, 0.9, 2.0):
            instance.step(time - instance.time)
            assert np.ravel(instance.get("x"))[0] == pytest.approx(way(time, a, values.get("X", 1.5)), rel=1e-11)
        assert np.ravel(instance.get("a", "n", "fixed")) == pytest.approx([0.0, 8.0, 5.0])
        instance.free()


@pytest.mark.parametrize("interface", ["ModelExchange", "CoSimulation"])
@BOTH
def test_in_an_importer(module, interface):
    result = simulate_fmu(module.archive("StartPush"), start_values={"F": 3.0}, stop_time=2.0, output=["x", "n"], fmi_type=interface, relative_tolerance=1e-9)
    assert result["x"][-1] == pytest.approx(way(2.0, 1.5, 1.5), rel=1e-6)
    assert result["n"][0] == 7


@KINDS
def test_modes_follow_parameters_until_they_are_set(kind, open_fmu):
    instance = opened(fmu, "StartPush", {"F": 8.0}, **kind)
    assert instance.get("a", "n", "y") == [4.0, 7.0, 32.0]
    instance.set(m=1.0)
    assert instance.get("a", "y") == [8.0, 64.0]
    instance.set(a=2.5)
    instance.set(F=1.0)
    assert instance.get("a", "y", "der(v)") == [2.5, 20.0, 2.5]
    instance.fmu.exitInitializationMode()
    assert instance.get("a") == [2.5] or instance.get("a") == 2.5
    instance.reset()
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    assert instance.get("a") == 3.0
    instance.fmu.setInteger(instance.vr("k"), [10])
    assert instance.get("n") == 21.0
    instance.free()


def test_parameters_change_no_mode_later(open_fmu):
    instance = open_fmu("StartPush").initialize()
    instance.step(0.5)
    instance.set(F=100.0)
    assert instance.get("a") == 3.0
    instance.step(0.25)
    assert instance.get("x") == pytest.approx(1.5 * 0.75**2, rel=1e-12)


def test_saved_states(open_fmu):
    instance, other = (opened(fmu, "StartPush") for _ in range(2))
    instance.set(a=7.0, c=9.0)
    state = instance.fmu.getFMUState()
    data = instance.fmu.serializeFMUState(state)
    instance.free_state(state)
    restored = other.fmu.deSerializeFMUstate(data)
    other.fmu.setFMUState(restored)
    other.free_state(restored)
    other.set(F=2.0, c=16.0)
    assert other.get("a", "root") == [7.0, 4.0]
    for each in (instance, other):
        each.free()


def test_without_a_finite_value(open_fmu):
    instance = opened(fmu, "StartPush", {"c": -1.0})
    state = instance.fmu.getFMUState()
    instance.fmu.setFMUState(state)
    instance.free_state(state)
    with instance.fails(ERROR, "the start value of 'root' is not finite: it follows from c; set these otherwise, or 'root' itself"):
        instance.fmu.exitInitializationMode()
    instance.reset().initialize({"c": 25.0})
    assert instance.get("root") == 5.0
    instance.free()


@pytest.mark.parametrize("kind", [{}, {"kind": FMU3Model}], ids=["cs", "me"])
def test_derivatives_in_initialization_mode_in_fmi3(kind):
    instance = opened(fmi3, "StartPush", **kind)
    check = {"F": [4.0, 0.5], "m": [-12.0, -1.5], "a": [8.0, 1.0], "fixed": [3.0, 0.0]}
    for known, expected in check.items():
        assert instance.partial("Directional", ["y", "der(v)"], [known], [1.0]) == pytest.approx(expected, abs=1e-14)
    assert instance.partial("Adjoint", ["y", "der(v)"], list(check), [1.0, 10.0]) == pytest.approx([value[0] + 10 * value[1] for value in check.values()])
    instance.set(a=1.0)
    assert instance.partial("Directional", ["y"], ["F"], [1.0]) == [0.0]
    instance.free()


@KINDS
def test_derivatives_in_initialization_mode(kind):
    instance = opened(fmu, "StartPush", **kind)

    def along(known):
        return instance.fmu.getDirectionalDerivative(instance.vr("y", "der(v)"), instance.vr(known), [1.0])

    assert list(along("F")) == pytest.approx([4.0, 0.5], abs=1e-14)
    assert list(along("m")) == pytest.approx([-12.0, -1.5], abs=1e-14)
    instance.fmu.exitInitializationMode()
    assert list(along("F")) == [0.0, 0.0]
    instance.free()


@BOTH
def test_description(module):
    root = etree.parse(module.unpacked("StartPush") / "modelDescription.xml").getroot()
    variables = list(root.find("ModelVariables"))
    named = {v.get("name"): v for v in variables}
    assert {name: named[name].get("initial") for name in ("a", "n", "fixed")} == {"a": "approx", "n": "approx", "fixed": "exact"}
    starts = {name: float((named[name].find("Real") if module is fmu else named[name]).get("start")) for name in ("a", "n")}
    assert starts == {"a": 3.0, "n": 7.0}
    keys = {(v.get("valueReference") if module is fmi3 else str(i)): v.get("name") for i, v in enumerate(variables, 1)}
    path, key = ("InitialUnknown", "valueReference") if module is fmi3 else ("InitialUnknowns/Unknown", "index")
    unknowns = {keys[u.get(key)]: {keys[d] for d in u.get("dependencies").split()} for u in root.iterfind(f"ModelStructure/{path}")}
    assert unknowns["y"] == {"F", "m", "fixed"} and unknowns["der(v)"] == {"F", "m"} and "a" not in unknowns
    assert validate_fmu(str(module.archive("StartPush"))) == []


def test_parts_and_arrays():
    instance = fmu.Instance("StartPushes").initialize({"F": 20.0})
    assert instance.get("one.a", "two.a") == [8.0, 10.0]
    instance.free()
    instance = fmi3.Instance("StartLines").initialize({"g": 3.0})
    instance.step(2.0)
    assert np.ravel(instance.get("x[1]", "x[2]", "x[3]") if "x[1]" in instance.variables else instance.get("x")) == pytest.approx([6.0, 12.0, 18.0])
    instance.free()


def test_linearization():
    instance = fmu.Instance("StartLinearPush").initialize({"F": 5.0})
    instance.step(3.0)
    assert instance.get("x") == pytest.approx(2.5 * 9 / 2, rel=1e-12)
    instance.free()


def test_many_runs_at_once():
    rows = np.array([[F, X] for F in np.linspace(1, 9, 7) for X in (0.5, 2.0)])
    times = [0.3, 1.0, 3.0]
    values, left = ensemble("StartPush", ["F", "X"], ["x"], times).run(rows)
    assert values[:, :, 0] == pytest.approx(np.array([[way(t, F / 2, X) for t in times] for F, X in rows]), rel=1e-9)


def test_session(lagrange_fmu):  # noqa: F811
    with lagrange_fmu.start(str(fmu.archive("StartPush")), F=4.0) as simulation:
        simulation.step(0.5)
        assert simulation["x"] == pytest.approx(0.25, rel=1e-9)


@pytest.mark.parametrize("start, message", [
    ("x", "start of <mode> cannot depend on coordinates, but 'x' does; expected numbers and parameters"),
    ("v", "start of <mode> cannot depend on velocities, but 'v' does"),
    ("time", "start of <mode> cannot depend on time, but 'time' does"),
    ("F", "start of <mode> cannot depend on inputs, but 'F' does"),
    ("other", "start of <mode> cannot depend on modes, but 'other' does"),
    ("m", "unit mismatch: the start value has the unit kg, expected m"),
    ("d*log(n)", "the start value of 'l' is -inf at the start values of the parameters; expected a finite number"),
])  # fmt: skip
def test_errors(start, message, tmp_path):
    (tmp_path / "system.xml").write_text(f"""<system name="Refused">
  <parameter name="m" start="2" unit="kg"/><parameter name="d" start="1" unit="m"/><parameter name="n" start="0" unit="1"/><input name="F" unit="N"/>
  <mode name="other"/>
  <mode name="l" unit="m" start="{start}"/>
  <coordinate name="x" velocity="v" unit="m"/><particle mass="2" x="x"/><event when="x - l"><set mode="l">0</set></event>
</system>""")
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and f"system.xml:4: {message}" in result.stderr, result.stderr
