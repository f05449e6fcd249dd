"""Integer and Boolean parameters and lists of values, against the closed form of a fall."""

import pytest
from fmpy import simulate_fmu
from fmpy.fmi2 import FMU2Model
from fmpy.validation import validate_fmu

import fmu
from fmu import DISCARD, ERROR, OK, lagc

# x'' = (f - g m[3] n)/(n m[1] + m[2]), with f only if `on` is true; x starts at n/10.
FALL = """<system name="{name}">
  <parameter name="n" type="Integer" start="3" min="1" max="9" description="how many of the first"/>
  <parameter name="on" type="Boolean" start="true"/>
  <parameter name="off" type="Boolean" start="0"/>
  <parameter name="m" values="1 2, 7/2" unit="kg" min="0" description="masses"/>
  <parameter name="counts" values="4 -5" type="Integer"/>
  <parameter name="g" start="10" unit="m/s2"/>
  <parameter name="F" start="6" unit="N"/>
  <parameter name="heap" value="n*m[1]" unit="kg"/>
  <parameter name="unit" start="0.1" unit="m"/>
  <coordinate name="x" velocity="v" unit="m" start="n*unit"/>
  <particle mass="heap + m[2]" x="x"/>
  <potential>g*m[3]*n*x</potential>
  <force coordinate="x">F*on + 100*F*off</force>
  <output name="count" unit="1">n + counts[1] + 0*counts[2]</output>
</system>
"""


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("types", {"TypesFall": FALL.format(name="TypesFall")})
    fmu.build_systems("types-tables", {"TypesTables": FALL.format(name="TypesTables")}, "--form", "tables")


BOTH_FORMS = pytest.mark.parametrize("name", ["TypesFall", "TypesTables"])
BOTH_KINDS = pytest.mark.parametrize("kind", [{}, {"kind": FMU2Model}])


def acceleration(n=3, on=True, off=False):
    return (6 * on + 600 * off - 10 * 3.5 * n) / (n * 1 + 2)


def whole(instance, name):
    return instance.fmu.getInteger(instance.vr(name))[0]


def truth(instance, name):
    return instance.fmu.getBoolean(instance.vr(name))[0]


@BOTH_FORMS
def test_motion(name, open_fmu):
    instance = open_fmu(name)
    instance.fmu.setInteger(instance.vr("n"), [5])
    instance.fmu.setBoolean(instance.vr("on"), [False])
    instance.initialize()
    instance.step(0.7)
    assert instance.get("x") == pytest.approx(0.5 + acceleration(5, False) * 0.49 / 2, rel=1e-12)
    instance.fmu.setBoolean(instance.vr("on", "off"), [True, True])
    assert instance.get("der(v)") == pytest.approx(acceleration(5, True, True), rel=1e-14)


@BOTH_KINDS
def test_values(kind, open_fmu):
    instance = open_fmu("TypesFall", **kind)
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    assert (whole(instance, "n"), truth(instance, "on"), truth(instance, "off")) == (3, True, False)
    assert (whole(instance, "counts[1]"), whole(instance, "counts[2]")) == (4, -5)
    assert instance.get("m[1]", "m[2]", "m[3]") == [1.0, 2.0, 3.5]
    instance.fmu.setInteger(instance.vr("n"), [4])
    assert instance.get("heap", "count", "x") == [4.0, 8.0, pytest.approx(0.4)]
    saved = instance.fmu.getFMUState()
    instance.fmu.setInteger(instance.vr("n"), [2])
    instance.fmu.setFMUState(saved)
    instance.free_state(saved)
    assert whole(instance, "n") == 4
    assert instance.get("der(v)") == pytest.approx(acceleration(4), rel=1e-14)
    instance.fmu.exitInitializationMode()
    instance.reset()
    instance.initialize()
    assert whole(instance, "n") == 3


def test_wrong_values_are_errors(open_fmu):
    cases = [
        ("setInteger", "n", 10, "10 for 'n' is above its maximum, 9"),
        ("setInteger", "on", 1, "'on' is a Boolean variable"),
        ("setInteger", "g", 1, "'g' is a Real variable"),
        ("setReal", "n", 2.5, "'n' is an Integer variable"),
        ("setReal", "on", 1.0, "'on' is a Boolean variable"),
        ("setBoolean", "n", 1, "'n' is an Integer variable"),
        ("setInteger", "solverSteps", 1, "'solverSteps' cannot be set"),
    ]
    for function, name, value, message in cases:
        instance = open_fmu("TypesFall")
        with instance.fails(DISCARD if "maximum" in message else ERROR, message):
            getattr(instance.fmu, function)(instance.vr(name), [value])
    for name in ("n", "on"):
        instance = open_fmu("TypesFall").initialize()
        with instance.fails(ERROR, f"'{name}' is an? (Integer|Boolean) variable"):
            instance.get(name)


def test_a_boolean_that_is_neither(open_fmu):
    from ctypes import c_int, c_size_t, c_uint

    instance = open_fmu("TypesFall")
    with instance.fails(ERROR, "the value for 'on' is 2; expected true or false"):
        instance.fmu.fmi2SetBoolean(instance.fmu.component, (c_uint * 1)(*instance.vr("on")), c_size_t(1), (c_int * 1)(2))


def test_description():
    variables = {v.name: v for v in fmu.description("TypesFall").modelVariables}
    n, on, m = variables["n"], variables["on"], variables["m[3]"]
    assert (n.type, n.start, n.min, n.max, n.causality, n.variability, n.initial) == ("Integer", "3", "1", "9", "parameter", "tunable", "exact")
    assert (on.type, on.start, variables["off"].start) == ("Boolean", "true", "false")
    assert (m.type, m.start, m.unit, m.min, m.description) == ("Real", "3.5", "kg", "0", "masses")
    assert (variables["counts[2]"].type, variables["counts[2]"].start) == ("Integer", "-5")
    unknowns = {u.variable.name: dict(zip([d.name for d in u.dependencies], u.dependenciesKind)) for u in fmu.description("TypesFall").initialUnknowns}
    assert unknowns["count"] == {"n": "dependent", "counts[1]": "dependent"}
    assert unknowns["x"] == {"n": "dependent", "unit": "dependent"}
    assert {"n", "on", "off", "m[1]"} <= set(unknowns["der(v)"])
    for name in ("TypesFall", "TypesTables"):
        assert validate_fmu(str(fmu.archive(name))) == []


def test_in_an_importer():
    result = simulate_fmu(fmu.archive("TypesFall"), start_values={"n": 2, "on": False, "m[1]": 3.0}, stop_time=1.0)
    assert result["x"][-1] == pytest.approx(0.2 - 70 / 8 / 2, rel=1e-9)


def test_given_in_an_include(tmp_path):
    (tmp_path / "part.xml").write_text(FALL.format(name="Part"))
    (tmp_path / "system.xml").write_text("""<system name="Around"><include file="part.xml" as="part">
  <parameter name="n" start="4"/><parameter name="off" start="true"/><parameter name="m[2]" start="20"/><parameter name="m[1]" value="a"/>
</include><parameter name="a" start="5" unit="kg"/></system>""")
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and "'part.m[1]'" not in result.stdout  # m[1] is an element of a list, see below
    (tmp_path / "system.xml").write_text((tmp_path / "system.xml").read_text().replace('<parameter name="m[1]" value="a"/>', ""))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == OK and result.stderr == "", result.stderr
    text = (tmp_path / "out" / "modelDescription.xml").read_text()
    assert '<Integer min="1" max="9" start="4"/>' in text and text.count('<Boolean start="true"/>') == 2 and 'start="20"' in text


@pytest.mark.parametrize("line, message", [
    ('<parameter name="a" type="Integer" start="2.5"/>', "'a': 2.5 is not an Integer; expected a whole number"),
    ('<parameter name="a" type="Integer" start="3e9"/>', "'a': 3e+09 is not an Integer"),
    ('<parameter name="a" type="Integer" start="2" max="2.5"/>', "'a': 2.5 is not an Integer"),
    ('<parameter name="a" type="Integer" start="2" max="1"/>', "'a': start 2 is outside min and max"),
    ('<parameter name="a" type="Integer" start="true"/>', "start: unknown name 'true'"),
    ('<parameter name="a" type="Integer" start="2" unit="m"/>', "'a' has a unit and type=\"Integer\", which has none"),
    ('<parameter name="a" type="Boolean" start="2"/>', "'a': 2 is not a Boolean; expected true or false"),
    ('<parameter name="a" type="Boolean" start="True"/>', "'True' is not in small letters; expected true"),
    ('<parameter name="a" type="Boolean" start="true" min="0"/>', "'a': a Boolean has neither min nor max"),
    ('<parameter name="a" type="Bool" start="true"/>', "type=\"Bool\" of <parameter> is not known; expected Real, Integer or Boolean"),
    ('<parameter name="a" type="Integer" value="2"/>', "a <parameter> has a value and a type"),
    ('<parameter name="a" values="1 x"/>', "values cannot depend on coordinates, but 'x' does; expected numbers and constants"),
    ('<parameter name="a" values=" "/>', "the parameter 'a' has no values; expected numbers"),
    ('<parameter name="a" values="1 2" start="1"/>', "a <parameter> has values and a start or value"),
    ('<parameter name="a[1]" values="1 2"/>', "the parameter 'a[1]' with values has an index; expected a name alone"),
    ('<parameter name="a" values="1 2"/><potential>a*x</potential>', "unknown name 'a'; expected a[1], ..., a[2]"),
    ('<parameter name="a" values="1 2"/><potential>a[3]*x</potential>', "unknown name 'a[3]'; expected a[1], ..., a[2]"),
])  # fmt: skip
def test_errors(line, message, tmp_path):
    text = f'<system name="Refused"><coordinate name="x" velocity="v"/><particle mass="2" x="x"/>{line}</system>'
    (tmp_path / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr
