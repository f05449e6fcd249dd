"""FMUs of FMI 3.0: descriptions, simulation in comparison with FMI 2.0, arrays, derivatives, states, and the results of steps."""

import ctypes
import re
import shutil
import subprocess
from ctypes import c_double, c_uint32
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.validation import validate_fmu
from lxml import etree

import fmi3
import fmu
from fmi3 import Importer, observed
from fmu import DISCARD, ERROR, ROOT

SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
OFFICIAL = Path(fmpy.__file__).parent / "c-code"
HEADER = (ROOT / "include" / "fmi3.h").read_text()
FUNCTIONS = set(re.findall(r"FMI3_EXPORT [^(;]*\b(fmi3\w+)\(", HEADER))

TYPES = """
<system name="TypesOfAll">
  <constant name="N" value="3"/>
  <parameter name="count" type="Integer" start="2" min="0" max="9"/>
  <parameter name="on" type="Boolean" start="true"/>
  <for index="i" from="1" to="N">
    <parameter name="k[i]" start="i" min="0"/>
    <input name="F[i]"/>
    <coordinate name="a[i]" velocity="va[i]" start="0.1*i"/>
  </for>
  <for index="i" from="1" to="N"><force coordinate="a[i]">F[i] + on*count - k[i]*a[i]</force></for>
  <for index="i" from="1" to="N">
    <coordinate name="b[i]" velocity="vb[i]"/>
    <coordinate name="c[i]" velocity="vc[i]"/>
    <kinetic>0.5*(va[i]^2 + vb[i]^2 + vc[i]^2)</kinetic>
    <force coordinate="b[i]">-b[i]^3 + a[i]</force>
  </for>
  <output name="total">sum(i, 1, N, a[i])</output>
</system>
"""

HAND = """
<system name="MovedHand">
  <input name="u" start="0.1" derivatives="2"/>
  <coordinate name="x" velocity="v" start="0.1"/>
  <coordinate name="theta" velocity="omega" start="0.4"/>
  <particle name="slide" mass="3" x="x"/>
  <particle name="bob" mass="2" x="x + 0.5*sin(theta)" y="-0.5*cos(theta)"/>
  <potential>2*9.81*bob.y</potential>
  <constraint name="hand">u - x</constraint>
  <output name="where">u</output>
</system>
"""
LEVERS = """
<system name="Levers">
  <input name="twice" unit="N"/><input name="both" unit="N"/><input name="alone" unit="N"/>
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/>
  <coordinate name="z" velocity="vz" unit="m"/>
  <particle name="p" mass="1" x="x" y="y" z="z"/>
  <force coordinate="x">2*twice</force>
  <force coordinate="y">alone + both</force>
  <force coordinate="z">both</force>
</system>
"""


@pytest.fixture(scope="module")
def own_systems():
    fmu.build_systems("fmi3-systems", {"MovedHand": HAND, "Levers": LEVERS}, versions=[2, 3])
    texts = {f"Array{name}": (ROOT / "fmu" / name / "system.xml").read_text().replace(f'"{name}"', f'"Array{name}"', 1) for name in ("ChainPendulum", "RobotArm")}
    fmu.build_systems("fmi3-arrays", texts | {"TypesOfAll": TYPES}, "--arrays", versions=[2, 3])


@pytest.fixture
def types(own_systems):
    return "TypesOfAll"


def rejected(status, call, *words):
    with pytest.raises(FMICallException) as raised:
        call(*words)
    assert raised.value.status == status


def test_descriptions_are_valid(name):
    assert validate_fmu(str(fmi3.archive(name))) == []
    for file, schema in (
        ("modelDescription.xml", "ModelDescription"),
        ("terminalsAndIcons/terminalsAndIcons.xml", "TerminalsAndIcons"),
        ("sources/buildDescription.xml", "BuildDescription"),
    ):
        etree.XMLSchema(etree.parse(SCHEMAS / f"fmi3{schema}.xsd")).assertValid(etree.parse(fmi3.unpacked(name) / file))
    folder = fmi3.unpacked(name)
    assert (folder / "terminalsAndIcons" / "icon.png").read_bytes() == (fmu.unpacked(name) / "model.png").read_bytes()


def test_the_same_variables_as_in_fmi2(name):
    """
    Each scalar of FMI 2.0 is a scalar or an array element of FMI 3.0, with the same start value and a value reference one higher. FMI 3.0
    adds time and event indicators.
    """
    ours = {}
    for variable in fmi3.description(name).modelVariables:
        count = int(np.prod(variable.shape)) if variable.shape else 0
        starts = str(variable.start).split() if variable.start is not None else [None] * max(count, 1)
        for i in range(max(count, 1)):
            element = re.sub(r"(\)?)$", rf"[{i + 1}]\1", variable.name, count=1) if count else variable.name
            ours[element] = (variable.valueReference - 1 + i, starts[i], variable.causality, variable.initial, variable.unit)
    theirs = {
        v.name: (v.valueReference, v.start, v.causality, v.initial, v.unit) for v in fmu.description(name).modelVariables
    }
    extra = {key: ours[key] for key in set(ours) - set(theirs)}
    assert {key: ours[key] for key in theirs} == theirs
    indicators = {f"eventIndicator[{i + 1}]" for i in range(fmu.description(name).numberOfEventIndicators)}
    assert set(extra) - {"time"} == indicators
    assert extra.get("time", ours["time"])[2] == "independent"


def columns(result, names):
    """Columns of scalars and arrays, by the names of FMI 2.0."""
    found = {}
    for column in result.dtype.names:
        values = result[column]
        if values.ndim == 1:
            found[column] = values
        else:
            found.update({f"{column}[{i + 1}]": values[:, i] for i in range(values.shape[1])})
    return np.array([found[name] for name in names])


@pytest.mark.parametrize("name", fmu.small_names())
def test_co_simulation_has_the_bits_of_fmi2(name):
    words = dict(stop_time=0.5, output_interval=0.02, fmi_type="CoSimulation")
    names = fmu.names_of(name, "output")
    second = fmpy.simulate_fmu(str(fmu.unpacked(name)), **words)
    third = fmpy.simulate_fmu(str(fmi3.unpacked(name)), **words)
    assert columns(third, names).tobytes() == columns(second, names).tobytes()


@pytest.mark.parametrize("name", ["SimplePendulum", "ChainPendulum", "ArrayChainPendulum", "FourBar", "ParticleCartesian", "StateFeedback"])
def test_model_exchange_agrees(name, own_systems):
    words = dict(stop_time=0.5, output_interval=0.01, relative_tolerance=1e-8)
    names = fmu.names_of(name, "output")
    ours = fmpy.simulate_fmu(str(fmi3.unpacked(name)), fmi_type="CoSimulation", **words)
    theirs = fmpy.simulate_fmu(str(fmi3.unpacked(name)), fmi_type="ModelExchange", **words)
    np.testing.assert_allclose(columns(theirs, names)[:, -1], columns(ours, names)[:, -1], rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("name", ["BouncingBall", "StickSlip", "NewtonsCradle"])
def test_model_exchange_with_events_has_the_bits_of_fmi2(name):
    """Importers use the variables that modelDescription.xml lists as event indicators."""
    words = dict(stop_time=2.0, output_interval=0.05, fmi_type="ModelExchange")
    names = fmu.names_of(name, "output")
    second, third = (fmpy.simulate_fmu(str(module.unpacked(name)), **words) for module in (fmu, fmi3))
    assert len(third) > 41, "there were events"
    assert columns(third, names).tobytes() == columns(second, names).tobytes()


def test_event_indicators(opened):
    """The indicator of a ball in the air is its gap; that of the ball at rest on the ground is the force, m g."""
    ball = opened("BouncingBall", kind=FMU3Model).initialize({"h": 0.5})
    for height in (0.5, -0.1):
        ball.fmu.updateDiscreteStates()
        ball.fmu.enterContinuousTimeMode()
        ball.fmu.setContinuousStates((c_double * 2)(height, 0.0), 2)
        value = (c_double * 1)()
        ball.fmu.getEventIndicators(value, 1)
        assert value[0] == ball.get("eventIndicator[1]")[0] == pytest.approx(height, abs=1e-10)
        ball.fmu.enterEventMode()
    rejected(ERROR, ball.fmu.getEventIndicators, (c_double * 2)(), 2)
    assert "2 elements; expected 1, the number of event indicators" in ball.messages[-1][2]
    resting = opened("BouncingBall").initialize({"h": 0.0})
    assert resting.fmu.getInt32(resting.vr("ground.closed")) == [1]
    assert resting.get("eventIndicator[1]")[0] == pytest.approx(9.81)
    rejected(ERROR, resting.set, {"eventIndicator[1]": 1.0})


def test_intermediate_update_at_an_event(opened):
    """Intermediate update reports the state after the bounce, at its time."""
    importer = Importer()
    ball = observed(opened, "BouncingBall", importer, ["h", "v"]).initialize()
    ball.step(0.6)
    impact = np.sqrt(2 / 9.81)
    time, _, (height, velocity) = min(importer.calls, key=lambda call: abs(call[0] - impact))
    assert time == pytest.approx(impact, rel=1e-12) and height == pytest.approx(0, abs=1e-12)
    assert velocity == pytest.approx(0.8 * 9.81 * impact, rel=1e-9)
    times = [call[0] for call in importer.calls]
    assert times == sorted(set(times)) and times[-1] == 0.6
    early = observed(opened, "BouncingBall", Importer(end_at=0.0), ["h"], earlyReturnAllowed=True).initialize()
    while early.time < 0.6:
        early.step(0.6 - early.time)
    np.testing.assert_allclose(early.get("h", "v"), ball.get("h", "v"), rtol=1e-12)


@pytest.mark.parametrize("name", ["SimplePendulum", "ElasticPendulum", "ParticleCartesian"])
def test_only_functions_of_fmi3_are_exported(name):
    lines = subprocess.run(["nm", "-D", "--defined-only", fmi3.library(name)], capture_output=True, text=True, check=True).stdout
    assert {line.split()[-1] for line in lines.splitlines()} == FUNCTIONS


def test_interface_matches_the_official_headers(tmp_path):
    official = (OFFICIAL / "fmi3Functions.h").read_text()
    assert FUNCTIONS == set(re.findall(r"FMI3_Export fmi3\w+TYPE\s+(fmi3\w+);", official))
    renamed = re.sub(r"\bfmi3(\w+)", r"own3\1", HEADER).replace("FMI3_", "OWN3_")
    lines = ["#include <stddef.h>", '#include "fmi3Functions.h"', '#include "own3.h"']
    for values, _ in re.findall(r"typedef enum \{(.*?)\} (\w+);", HEADER, re.S):
        for value in re.findall(r"fmi3\w+", values):
            lines.append(f'_Static_assert((int){value} == (int)own3{value[4:]}, "{value}");')
    for type_name in re.findall(r"^typedef [\w\s*]+?\*?(fmi3\w+);", HEADER, re.M):
        lines.append(f"extern {type_name} v{type_name}; extern own3{type_name[4:]} v{type_name};")
    (tmp_path / "own3.h").write_text(renamed)
    (tmp_path / "both.c").write_text("\n".join(lines))
    words = ["gcc", "-std=c11", "-Wall", "-Werror", "-fsyntax-only", f"-I{OFFICIAL}", f"-I{tmp_path}", tmp_path / "both.c"]
    result = subprocess.run(words, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("name", ["SimplePendulum", "ParticleCartesian", "StateFeedback"])
def test_fmpy_builds_the_sources(name, tmp_path):
    folder = tmp_path / name
    shutil.copytree(fmi3.unpacked(name), folder)
    shutil.rmtree(folder / "binaries")
    build_platform_binary(folder)
    words = dict(stop_time=1, output_interval=0.1, fmi_type="CoSimulation")
    built, packed = (fmpy.simulate_fmu(str(path), **words) for path in (folder, fmi3.unpacked(name)))
    for output in packed.dtype.names:
        np.testing.assert_allclose(built[output], packed[output], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_sources_are_plain_c11_with_names_of_the_fmu(compiler, tmp_path):
    for name in ("ChainPendulum", "StateFeedback", "FourBar"):
        words = [compiler, "-std=c11", "-pedantic-errors", "-Wall", "-Wextra", "-Wno-unused-parameter", "-Wno-unused-function"]
        source = fmi3.unpacked(name) / "sources" / f"{name}.c"
        subprocess.run([*words, "-Werror", "-O0", "-c", source, "-o", tmp_path / "fmu.o"], check=True)
        lines = subprocess.run(["nm", "-g", "--defined-only", tmp_path / "fmu.o"], capture_output=True, text=True).stdout
        defined = [line.split()[-1] for line in lines.splitlines()]
        assert f"{name}_fmi3DoStep" in defined and [symbol for symbol in defined if not symbol.startswith(f"{name}_")] == []


def test_arrays(types, opened):
    """Consecutive elements form one array; elements of two interleaved coordinates are scalars."""
    shapes = {v.name: v.shape for v in fmi3.description(types).modelVariables}
    for array in ("k", "F", "a", "va"):
        assert shapes[array] == (3,) and f"{array}[1]" not in shapes
    assert {"b[1]", "c[1]", "b[3]", "vb[2]"} < set(shapes) and "b" not in shapes
    instance = opened(types)
    instance.set(a=[1.0, 2.0, 3.0], k=[4.0, 5.0, 6.0])
    instance.initialize()
    np.testing.assert_array_equal(instance.get("k", "total", "a"), [4, 5, 6, 6, 1, 2, 3])
    instance.set(F=[0.5, 0.25, 0.125])
    np.testing.assert_array_equal(instance.get("F"), [0.5, 0.25, 0.125])
    before = instance.get("F")
    rejected(ERROR, instance.fmu.setFloat64, instance.vr("F"), [1.0])
    assert "1 values; expected 3" in instance.messages[-1][2]
    instance.fmu.reset()
    instance.initialize(dict(F=before))
    rejected(ERROR, instance.fmu.setFloat64, instance.vr("F"), [1.0] * 4)
    assert "4 values; expected 3" in instance.messages[-1][2]
    instance.fmu.reset()
    instance.initialize(dict(F=before))
    rejected(ERROR, instance.fmu.getFloat64, [instance.vr("F")[0] + 1])
    assert "an element of an array" in instance.messages[-1][2]


def test_types(types, opened):
    variables = {v.name: v.type for v in fmi3.description(types).modelVariables}
    assert (variables["count"], variables["on"], variables["solverSteps"]) == ("Int32", "Boolean", "Int64")
    instance = opened(types)
    instance.fmu.setInt32(instance.vr("count"), [4])
    instance.fmu.setBoolean(instance.vr("on"), [False])
    instance.initialize()
    assert instance.fmu.getInt32(instance.vr("count")) == [4] and list(instance.fmu.getBoolean(instance.vr("on"))) == [False]
    instance.fmu.setBoolean(instance.vr("on"), [True])
    instance.step(0.1)
    assert instance.fmu.getInt64(instance.vr("solverSteps"))[0] > 0
    for getter, variable in (("getInt32", "solverSteps"), ("getInt64", "count"), ("getBoolean", "a"), ("getFloat64", "on"),
                             ("getInt8", "count"), ("getString", "on"), ("getFloat32", "a")):  # fmt: skip
        rejected(ERROR, getattr(instance.fmu, getter), instance.vr(variable))
        assert list(instance.fmu.getBoolean(instance.vr("on"))) == [True], "an instance can be read after an error"
        rejected(ERROR, instance.step, 0.1)
        instance.fmu.reset()
        instance.initialize()
        instance.fmu.setBoolean(instance.vr("on"), [True])


@pytest.mark.parametrize("name", ["ArrayChainPendulum", "ChainPendulum", "FourBar", "DampedPendulum"])
@pytest.mark.parametrize("kind", [FMU3Slave, FMU3Model])
def test_partial_derivatives(name, kind, opened, own_systems):
    """Directional derivatives agree with difference quotients; adjoint ones have the same scalar products."""
    instance = opened(name, kind=kind)
    model = fmi3.description(name)
    states = [u.variable.derivative.name for u in model.derivatives]
    inputs = [v.name for v in model.modelVariables if v.causality == "input"]
    unknowns, knowns = [u.variable.name for u in model.derivatives], states + inputs
    random = np.random.default_rng(1)
    instance.fmu.enterInitializationMode()
    instance.set({known: instance.get(known) + 0.1 * random.standard_normal(instance.size(known)) for known in inputs + states}) if name != "FourBar" else None
    along, across = random.standard_normal(instance.size(*knowns)), random.standard_normal(instance.size(*unknowns))
    directional = instance.partial("Directional", unknowns, knowns, along)
    adjoint = instance.partial("Adjoint", unknowns, knowns, across)
    assert across @ directional == pytest.approx(adjoint @ along, rel=1e-12)
    if name == "FourBar":
        return  # moved states would violate the constraints
    base, h, values = {known: instance.get(known) for known in knowns}, 1e-6, []
    for sign in (1, -1):
        place = 0
        for known in knowns:
            count = instance.size(known)
            instance.set({known: base[known] + sign * h * along[place : place + count]})
            place += count
        values.append(instance.get(*unknowns))
    np.testing.assert_allclose(directional, (values[0] - values[1]) / (2 * h), rtol=1e-6, atol=1e-7)


def test_output_derivatives(opened, own_systems):
    """One order applies to a whole array, another order to the next array."""
    instance = opened("ArrayChainPendulum").initialize()
    instance.step(0.3)
    references, values = (c_uint32 * 2)(*instance.vr("theta", "omega")), (c_double * 20)()
    for orders, expected in (((1, 1), ("der(theta)", "der(omega)")), ((2, 1), ("der(omega)", "der(omega)"))):
        instance.fmu.fmi3GetOutputDerivatives(instance.fmu.component, references, 2, (ctypes.c_int32 * 2)(*orders), values, 20)
        np.testing.assert_allclose(values, instance.get(*expected), rtol=1e-12)


@pytest.mark.parametrize("name", ["SimplePendulum", "DampedPendulum", "ParticleCartesian", "FourBar"])
def test_states(name, opened):
    """A restored state, and one restored in another instance, gives the same bits."""
    outputs = [v.name for v in fmi3.description(name).modelVariables if v.causality == "output"]
    first, second = opened(name).initialize(), opened(name)
    first.step(0.3)
    state = first.fmu.getFMUState()
    data = first.fmu.serializeFMUState(state)
    first.step(0.2)
    expected = first.get(*outputs)
    first.fmu.setFMUState(state)
    first.time = 0.3
    first.step(0.2)
    assert first.get(*outputs).tobytes() == expected.tobytes()
    restored = second.fmu.deserializeFMUState(data)
    second.fmu.setFMUState(restored)
    second.time = 0.3
    second.step(0.2)
    assert second.get(*outputs).tobytes() == expected.tobytes()
    for instance, saved in ((first, state), (second, restored)):
        instance.fmu.freeFMUState(saved)
    rejected(ERROR, second.fmu.deserializeFMUState, b"x" * len(data))


@pytest.mark.parametrize(
    "name, variables",
    [("DampedPendulum", ["theta", "der(omega)", "kineticEnergy"]), ("ElasticPendulum", ["r", "der(vr)"]),
     ("FourBar", ["theta", "der(omega)"]), ("ParticleCartesian", ["x", "vx"]), ("StateFeedback", ["F"])],
)  # fmt: skip
def test_intermediate_update(name, variables, opened):
    """Intermediate values lie between those at both ends of the step, and reading them changes nothing."""
    importer = Importer()
    watched, alone = observed(opened, name, importer, variables).initialize(), opened(name).initialize()
    for step in (0.5, 0.01, 1.0):
        count, start = len(importer.calls), watched.time
        assert watched.step(step) == alone.step(step) == (False, False, False, start + step)
        assert watched.get(*variables).tobytes() == alone.get(*variables).tobytes()
        times = [call[0] for call in importer.calls[count:]]
        assert times == sorted(set(times)) and start < times[0] and times[-1] == start + step
        assert importer.calls[-1][2].tobytes() == alone.get(*variables).tobytes()
    if name in ("DampedPendulum", "FourBar"):
        assert len(importer.calls) > 6
        inside = [(time, values) for time, _, values in importer.calls if 0.51 < time < 1.5]
        for time, values in inside:
            reference = opened(name).initialize()
            for end in (0.5, 0.51, time):
                reference.step(end - reference.time)
            np.testing.assert_allclose(values, reference.get(*variables), rtol=1e-5, atol=1e-6)


def test_intermediate_guides(own_systems, opened):
    """An input that prescribes a motion continues by its derivatives during the step, and the state follows."""
    importer = Importer()
    hand = observed(opened, "MovedHand", importer, ["x", "v", "der(v)", "where"])
    hand.initialize({"u": 0.1, "der(u)": 0.3, "der(der(u))": -0.8})
    hand.step(3.0)
    assert len(importer.calls) > 2
    for t, _, values in importer.calls:
        u = 0.1 + 0.3 * t - 0.4 * t**2
        np.testing.assert_allclose(values, [u, 0.3 - 0.8 * t, -0.8, u], rtol=1e-9)


def test_early_return(opened):
    importer = Importer(end_at=0.437)
    instance = observed(opened, "DampedPendulum", importer, ["theta"], earlyReturnAllowed=True).initialize()
    event, terminate, early, last = instance.step(1.0)
    assert (event, terminate, early) == (False, False, True) and last == max(0.437, importer.calls[0][0])
    importer.end_at = 5.0  # beyond the step, which ends as usual
    assert instance.step(1.0 - last) == (False, False, False, 1.0)
    assert [can_return for _, can_return, _ in importer.calls[-2:]] == [True, False] and importer.calls[-1][0] == 1.0
    straight = opened("DampedPendulum").initialize()
    straight.step(1.0)
    np.testing.assert_allclose(instance.get("theta", "omega"), straight.get("theta", "omega"), rtol=1e-6)
    not_allowed = observed(opened, "DampedPendulum", Importer(end_at=0.437), ["theta"]).initialize()
    assert not_allowed.step(1.0) == (False, False, False, 1.0)


def test_errors_in_the_callback_end_the_step(opened):
    importer = Importer()
    instance = observed(opened, "DampedPendulum", importer, ["theta"]).initialize()
    importer.names = []
    importer.instance = type("", (), {"get": lambda *names: instance.fmu.reset()})
    importer.names = ["theta"]
    rejected(ERROR, instance.step, 1.0)
    assert importer.problem.status == ERROR
    assert any("fmi3Reset is not allowed in the state 'intermediate update mode'" in m[2] for m in instance.messages)
    instance.fmu.reset()


def test_a_discarded_step_changes_nothing(opened):
    """
    A discarded step restores the state, even with early return, which would hide that the motion ends (FMI 3.0.2, sections 2.2.3 and
    4.2.1).
    """
    falling = dict(omega=0.0)
    strict, early = opened("ParticlePolar").initialize(falling), opened("ParticlePolar", earlyReturnAllowed=True).initialize(falling)
    before = strict.get("r", "theta", "vr")
    for instance in (strict, early):
        rejected(DISCARD, instance.step, 2.0)
        assert instance.get("time", "r", "theta", "vr")[1:].tobytes() == before.tobytes() and instance.get("time")[0] == 0.0
        instance.step(0.5)


@pytest.mark.parametrize(
    "options, message",
    [(dict(token="{0}"), "the instantiation token is '{0}'"), (dict(eventModeUsed=True), "hasEventMode"),
     (dict(requiredIntermediateVariables=[999]), "intermediateUpdate"), (dict(requiredIntermediateVariables=["solverSteps"]), "intermediateUpdate"),
     (dict(instance_name=" "), "has no name")],
)  # fmt: skip
def test_bad_instances(options, message, opened):
    if options.get("requiredIntermediateVariables") == ["solverSteps"]:
        variables = fmi3.description("DampedPendulum").modelVariables
        options = dict(requiredIntermediateVariables=[v.valueReference for v in variables if v.name == "solverSteps"])
    instance = fmi3.Instance.__new__(fmi3.Instance)
    with pytest.raises(Exception):
        instance.__init__("DampedPendulum", **options)
    assert message in instance.messages[-1][2]
    quiet = fmi3.Instance.__new__(fmi3.Instance)
    with pytest.raises(Exception):
        quiet.__init__("DampedPendulum", logging=False, **options)
    assert quiet.messages == []  # section 2.3.1


def test_log(opened):
    quiet, loud = opened("ParticlePolar", logging=False).initialize(), opened("ParticlePolar").initialize()
    rejected(ERROR, quiet.step, -1.0)
    assert quiet.messages == []
    assert [category for _, category, _ in loud.messages] == ["logEvents", "logEvents"]
    loud.fmu.setDebugLogging(True, ["logStatusError"])
    loud.fmu.reset()
    loud.initialize()
    assert len(loud.messages) == 2
    rejected(ERROR, loud.step, -1.0)
    assert loud.messages[-1][:2] == (ERROR, "logStatusError")
    loud.fmu.reset()
    loud.fmu.setDebugLogging(True, [])  # all categories
    count = len(loud.messages)
    loud.initialize()
    assert [category for _, category, _ in loud.messages[count:]] == ["logEvents"]


def test_terminals_are_drawn():
    """Terminals have icons side by side on the right edge, from existing pictures; without terminals there are none."""
    folder = fmi3.unpacked("ParticleCartesian") / "terminalsAndIcons"
    places = [{name: float(value) for name, value in place.items() if name[0] in "xy"} for place in etree.parse(folder / "terminalsAndIcons.xml").iter("TerminalGraphicalRepresentation")]
    assert len(places) == 3 and all(place["x1"] < 100 < place["x2"] for place in places)
    heights = sorted((place["y1"], place["y2"]) for place in places)
    assert heights[0][0] > -100 and heights[-1][1] < 100 and all(below[1] < above[0] for below, above in zip(heights, heights[1:]))
    assert (folder / "flange.png").read_bytes()[:4] == b"\x89PNG"
    circles = [[float(circle.get(name)) for name in ("cx", "cy", "r")] for circle in etree.parse(folder / "flange.svg").getroot()]
    (x, y, rim), disk = circles  # a disk within a dark rim, in the middle of 160 x 160
    assert (x, y) == (80, 80) and disk[:2] == [80, 80] and 0 < disk[2] < rim < 80
    assert not list((fmi3.unpacked("SimplePendulum") / "terminalsAndIcons").glob("flange.*"))


def test_terminals(own_systems):
    """An input that is the force along a coordinate makes a flange, with the member names of Modelica's connectors."""
    members, kinds = {}, {}
    for name in ("InvertedPendulumCart", "DampedPendulum", "SimplePendulum", "ParticleCartesian", "RobotArm", "ArrayRobotArm", "Levers"):
        root = etree.parse(fmi3.unpacked(name) / "terminalsAndIcons" / "terminalsAndIcons.xml")
        members[name] = {
            terminal.get("name"): [(m.get("variableName"), m.get("memberName"), m.get("variableKind")) for m in terminal.iter("TerminalMemberVariable")]
            for terminal in root.iter("Terminal")
        }
        kinds[name] = {terminal.get("terminalKind") for terminal in root.iter("Terminal")}
    assert kinds["InvertedPendulumCart"] == kinds["ParticleCartesian"] == {"Modelica.Mechanics.Translational.Interfaces.Flange_a"}
    assert kinds["DampedPendulum"] == {"Modelica.Mechanics.Rotational.Interfaces.Flange_a"} and kinds["ArrayRobotArm"] == {None}
    force = [("x", "s", "signal"), ("v", "v", "signal"), ("F", "f", "inflow")]
    assert members["InvertedPendulumCart"] == {"x": force}
    torque = [("theta", "phi", "signal"), ("omega", "w", "signal"), ("tau", "tau", "inflow")]
    assert members["DampedPendulum"] == {"theta": torque}
    torques = [("q", "phi", "signal"), ("w", "w", "signal"), ("tau", "tau", "inflow")]
    assert members["ArrayRobotArm"] == {"q": torques}, "arrays of six flanges"
    assert members["RobotArm"] == {f"q[{i}]": [(f"{name}[{i}]", member, kind) for name, member, kind in torques] for i in range(1, 7)}
    assert {name: terminal[2][0] for name, terminal in members["Levers"].items()} == {"y": "alone"}
    assert members["SimplePendulum"] == {} and set(members["ParticleCartesian"]) == {"x", "y", "z"}


def test_versions_are_checked(tmp_path):
    words = ["cmake", "-S", ROOT, "-B", tmp_path, "-DFMI_VERSIONS=1"]
    result = subprocess.run(words, capture_output=True, text=True)
    assert result.returncode != 0 and "there is no version 1 of FMI here; expected 2, 3 or both" in " ".join(result.stderr.split())
