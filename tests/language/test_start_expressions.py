"""Start values given as expressions of parameters, against parabolas and derivatives by hand."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi2 import FMU2Model
from fmpy.validation import validate_fmu

import fmu
from fmu import DISCARD, ERROR, lagc

# A throw at the angle alpha and the speed v, from the height 2 r; h is a calculated parameter, w a definition.
THROW = """<system name="{name}">
  <coordinate name="x" velocity="vx" unit="m" velocityStart="v*cos(alpha)"/>
  <coordinate name="y" velocity="vy" unit="m" start="h" velocityStart="w"/>
  <parameter name="h" value="2*r" unit="m"/>
  <parameter name="v" start="10" unit="m/s"/>
  <parameter name="alpha" start="pi/6" unit="rad"/>
  <parameter name="r" start="1" unit="m"/>
  <parameter name="m" start="2" unit="kg" min="0"/>
  <define name="w" unit="m/s">v*sin(alpha)</define>
  <particle name="ball" mass="m" x="x" y="y"/>
  <potential>9.81*m*y</potential>
  <output name="top" unit="m">y + r</output>
</system>
"""
# A pendulum released at a height; without a length its angle is undefined.
PENDULUM = """<system name="StartPendulum">
  <parameter name="l" start="0.5" unit="m"/>
  <parameter name="s" start="0.1" unit="m" description="way along the arc"/>
  <constant name="N" value="3"/>
  <for index="i" from="1" to="N">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" start="i*s/l"/>
    <particle mass="1" x="l*sin(theta[i])" y="-l*cos(theta[i])"/>
    <potential>-9.81*l*cos(theta[i])</potential>
  </for>
</system>
"""
LINEAR = """<linearization of="../StartPendulum/system.xml" name="StartLinear"/>
"""
GRAVITY = 9.81


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"StartThrow": THROW.format(name="StartThrow"), "StartPendulum": PENDULUM, "StartLinear": LINEAR}
    fmu.build_systems("starts", texts)
    fmu.build_systems("starts-tables", {"StartTables": THROW.format(name="StartTables")}, "--form", "tables")


BOTH_FORMS = pytest.mark.parametrize("name", ["StartThrow", "StartTables"])
BOTH_KINDS = pytest.mark.parametrize("kind", [{}, {"kind": FMU2Model}])


def in_initialization(instance, values=()):
    instance.fmu.setupExperiment()
    instance.set(values)
    instance.fmu.enterInitializationMode()
    return instance


def expected(v=10.0, alpha=np.pi / 6, r=1.0):
    return {"x": 0.0, "y": 2 * r, "vx": v * np.cos(alpha), "vy": v * np.sin(alpha), "der(x)": v * np.cos(alpha), "top": 3 * r, "ball.y": 2 * r}


def check(instance, **values):
    own = {name: values.pop(name) for name in ("vx",) if name in values}
    if "vx" in own:
        own["der(x)"] = own["vx"]
    for name, value in {**expected(**values), **own}.items():
        assert instance.get(name) == pytest.approx(value, rel=1e-15, abs=1e-15), name


@BOTH_KINDS
@BOTH_FORMS
def test_states_follow_parameters_at_once(name, kind, open_fmu):
    instance = in_initialization(open_fmu(name, **kind), {"v": 5.0})
    check(instance, v=5.0)
    instance.set(alpha=1.0)
    check(instance, v=5.0, alpha=1.0)
    instance.set(r=3.0, v=2.0)
    check(instance, v=2.0, alpha=1.0, r=3.0)
    instance.fmu.exitInitializationMode()
    check(instance, v=2.0, alpha=1.0, r=3.0)


@BOTH_FORMS
def test_parabola(name, open_fmu):
    instance = open_fmu(name).initialize({"v": 8.0, "alpha": 0.9, "r": 4.0})
    for time in (0.3, 0.8, 1.7):
        instance.step(time - instance.time)
        assert instance.get("x") == pytest.approx(8 * np.cos(0.9) * time, rel=1e-12)
        assert instance.get("y") == pytest.approx(8 + 8 * np.sin(0.9) * time - GRAVITY * time**2 / 2, rel=1e-12)


def test_parameters_change_no_state_later(open_fmu):
    instance = open_fmu("StartThrow").initialize()
    instance.step(0.5)
    before = instance.get("x", "y", "vx", "vy")
    instance.set(v=1.0, alpha=0.0, r=9.0)
    assert instance.get("x", "y", "vx", "vy") == before


@BOTH_KINDS
@pytest.mark.parametrize("own", [7.0, 10 * np.cos(np.pi / 6)])  # the second value is the one that the parameters give anyway
def test_what_is_set_stays(own, kind, open_fmu):
    instance = open_fmu("StartThrow", **kind)
    in_initialization(instance, {"vx": own})
    instance.set(alpha=1.0)
    check(instance, alpha=1.0, vx=own)
    instance.set(y=-3.0, r=5.0)  # in one call
    assert instance.get("y", "vy") == [-3.0, pytest.approx(10 * np.sin(1.0))]
    instance.reset()
    check(in_initialization(instance, {"alpha": 0.2}), alpha=0.2)


@BOTH_KINDS
def test_saved_states_contain_set_values(kind, open_fmu):
    instance = open_fmu("StartThrow", **kind)
    in_initialization(instance, {"vx": 7.0, "v": 4.0})
    saved = instance.fmu.getFMUState()
    data = instance.fmu.serializeFMUState(saved)
    instance.free_state(saved)
    other = open_fmu("StartThrow", **kind)
    restored = other.fmu.deSerializeFMUstate(data)
    other.fmu.setFMUState(restored)
    other.free_state(restored)
    other.set(alpha=0.4)
    check(other, v=4.0, alpha=0.4, vx=7.0)
    other.fmu.exitInitializationMode()


def test_description():
    description = fmu.description("StartThrow")
    variables = {v.name: v for v in description.modelVariables}
    starts = expected()
    for name, initial in [("x", "exact"), ("y", "approx"), ("vx", "approx"), ("vy", "approx")]:
        assert variables[name].initial == initial and variables[name].causality == "output"
        assert float(variables[name].start) == pytest.approx(starts[name], rel=1e-15)
    unknowns = {u.variable.name: dict(zip([d.name for d in u.dependencies], u.dependenciesKind)) for u in description.initialUnknowns}
    assert "x" not in unknowns
    assert unknowns["y"] == {"r": "constant"}
    assert unknowns["vx"] == {"v": "dependent", "alpha": "dependent"}
    assert unknowns["der(y)"] == {"v": "dependent", "alpha": "dependent"}
    assert unknowns["top"] == {"r": "constant"}
    outputs = {u.variable.name: {d.name for d in u.dependencies} for u in description.outputs}
    assert outputs["top"] == {"y"} and outputs["vx"] == {"vx"}
    for name in ("StartThrow", "StartPendulum", "StartLinear"):
        assert validate_fmu(str(fmu.archive(name))) == []


def test_in_an_importer():
    result = simulate_fmu(fmu.archive("StartThrow"), start_values={"alpha": 0.3, "x": 2.0}, stop_time=1.0)
    assert result["x"][0] == 2.0
    assert result["x"][-1] == pytest.approx(2 + 10 * np.cos(0.3), rel=1e-12)


@BOTH_KINDS
@BOTH_FORMS
def test_derivatives_in_initialization_mode(name, kind, open_fmu):
    instance = in_initialization(open_fmu(name, **kind))

    def along(known):
        return instance.fmu.getDirectionalDerivative(instance.vr("vx", "vy", "y", "top", "der(x)"), instance.vr(known), [1.0])

    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    np.testing.assert_allclose(along("alpha"), [-10 * s, 10 * c, 0, 0, -10 * s], atol=1e-14)
    np.testing.assert_allclose(along("r"), [0, 0, 2, 3, 0], atol=1e-14)
    instance.set(vx=1.0)
    np.testing.assert_allclose(along("alpha"), [0, 10 * c, 0, 0, 0], atol=1e-14)
    instance.fmu.exitInitializationMode()
    np.testing.assert_allclose(along("r"), [0, 0, 0, 1, 0], atol=1e-14)


def test_without_a_finite_value(open_fmu):
    instance = in_initialization(open_fmu("StartPendulum"), {"l": 0.0})
    saved = instance.fmu.getFMUState()
    with instance.fails(ERROR, r"'theta\[2\]' has no finite value"):
        instance.get("theta[2]")
    instance.fmu.setFMUState(saved)
    instance.set(l=0.25)
    assert instance.get("theta[2]") == 0.8
    instance.fmu.setFMUState(saved)
    instance.free_state(saved)
    with instance.fails(ERROR, r"the start value of 'theta\[1\]' is not finite: it follows from l, s; set these otherwise, or 'theta\[1\]' itself"):
        instance.fmu.exitInitializationMode()
    instance.reset().initialize({"l": 0.25})
    assert instance.get("theta[3]") == pytest.approx(1.2)


def test_linearization(open_fmu):
    instance = open_fmu("StartLinear").initialize({"l": 0.4, "s": 0.2})
    for time in (0.0, 0.5, 1.0):
        instance.step(time - instance.time) if time > 0 else None
        for i in (1, 2, 3):
            assert instance.get(f"theta[{i}]") == pytest.approx(i * 0.5 * np.cos(np.sqrt(GRAVITY / 0.4) * time), abs=1e-9)


@pytest.mark.parametrize("start, message", [
    ("F", "cannot depend on inputs, but 'F' does; expected numbers and parameters"),
    ("time", "cannot depend on time, but 'time' does"),
    ("v", "cannot depend on velocities, but 'v' does"),
    ("m", "unit mismatch: the start value has the unit kg, expected m"),
    ("d*log(n)", "the start value of 'x' is -inf at the start values of the parameters; expected a finite number"),
])  # fmt: skip
def test_errors(start, message, tmp_path):
    (tmp_path / "system.xml").write_text(f"""<system name="Refused">
  <parameter name="m" start="2" unit="kg"/><parameter name="d" start="1" unit="m"/><parameter name="n" start="0" unit="1"/><input name="F" unit="N"/>
  <coordinate name="x" velocity="v" unit="m" start="{start}"/><particle mass="2" x="x"/>
</system>""")
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr


def test_page_shows_them():
    page = (fmu.unpacked("StartThrow") / "documentation" / "index.html").read_text()
    assert "Start values" in page and "vx = v*cos(alpha)" in page
