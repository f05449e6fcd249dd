"""Systems included in others, against the normal modes of oscillators and formulas by hand."""

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

import fmu
from building import build_by_cmake
from fmu import lagc

# An oscillator of N equal parallel springs; its definition, body and output use names that occur in other files too.
PART = """<system name="IncludePart">
  <constant name="N" value="1"/>
  <parameter name="m" start="{mass}" unit="kg" min="0"/>
  <parameter name="k" start="8" unit="N/m"/>
  <parameter name="rate" value="sqrt(K/m)" unit="rad/s"/>
  <input name="F" unit="N"/>
  <coordinate name="x" velocity="v" unit="m" start="0.5"/>
  <define name="K" unit="N/m">sum(i, 1, N, k)</define>
  <particle mass="m" x="x"/>
  <for index="i" from="1" to="N"><potential>k*body1.x^2/2</potential></for>
  <force on="body1" x="F"/>
  <output name="elongation" unit="m">body1.x</output>
  <work/>
  <solver method="bdf" tolerance="1e-3"/>
  <experiment stopTime="77"/>
</system>
"""
# Three of them in a row, coupled by springs; the name i is also used in the outer system.
ROW = """<system name="IncludeRow">
  <parameter name="i" start="4" unit="N/m"/>
  <for index="j" from="1" to="3">
    <include file="../IncludePart/system.xml" as="mass[j]">
      <parameter name="m" value="heavy"/>
      <coordinate name="x" start="amplitude*sin(j*pi/4)"/>
    </include>
  </for>
  <parameter name="heavy" start="3" unit="kg"/>
  <parameter name="amplitude" start="0.1" unit="m"/>
  <for index="j" from="1" to="2"><potential>i*(mass[j].x - mass[j+1].x)^2/2</potential></for>
  <potential>i*(mass[1].body1.x^2 + mass[3].elongation^2)/2</potential>
</system>
"""
# Nested parts, with a damping from the outer system, three springs, and a stiffness set by the outermost file.
NEST = """<system name="IncludeNest">
  <parameter name="b" start="1.5" unit="N.s/m"/>
  <include file="../IncludeMiddle/system.xml" as="middle">
    <input name="part.F" value="-b*middle.part.v"/>
    <parameter name="part.k" start="5" max="6"/>
  </include>
</system>
"""
MIDDLE = """<system name="IncludeMiddle">
  <include file="../IncludePart/system.xml" as="part">
    <constant name="N" value="3"/>
    <parameter name="k" start="100"/>
  </include>
  <output name="speed" unit="m/s">der(part.body1.x)</output>
</system>
"""
LINEAR = """<linearization of="../IncludeRow/system.xml" name="IncludeLinear"><at name="mass[2].x" value="0"/></linearization>
"""
TEXTS = {"IncludePart": PART.format(mass=2), "IncludeRow": ROW, "IncludeNest": NEST, "IncludeMiddle": MIDDLE, "IncludeLinear": LINEAR}


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("includes", TEXTS)


@pytest.mark.parametrize("name", ["IncludeRow", "IncludeLinear"])
def test_row_swings_in_its_mode(name, open_fmu):
    instance = open_fmu(name).initialize({"heavy": 5.0, "amplitude": 0.2})
    rate = np.sqrt((8 + 4 * 4 * np.sin(np.pi / 8) ** 2) / 5)
    for time in (0.0, 0.7, 2.0):
        instance.step(time - instance.time) if time > 0 else None
        for j in (1, 2, 3):
            x = 0.2 * np.sin(j * np.pi / 4) * np.cos(rate * time)
            assert instance.get(f"mass[{j}].x") == pytest.approx(x, abs=1e-8)
            assert instance.get(f"mass[{j}].elongation") == pytest.approx(x, abs=1e-8)
    assert instance.get("mass[2].m") == 5.0 and instance.get("mass[2].rate") == pytest.approx(np.sqrt(8 / 5))


def test_parts_in_parts(open_fmu):
    instance = open_fmu("IncludeNest").initialize()
    d, w = 1.5 / 4, np.sqrt(15 / 2 - (1.5 / 4) ** 2)
    for time in (0.4, 1.0, 3.0):
        instance.step(time - instance.time)
        x = 0.5 * np.exp(-d * time) * (np.cos(w * time) + d / w * np.sin(w * time))
        v = -0.5 * np.exp(-d * time) * (w + d * d / w) * np.sin(w * time)
        assert instance.get("middle.part.x") == pytest.approx(x, abs=1e-7)
        assert instance.get("middle.speed") == pytest.approx(v, abs=1e-7)
    assert instance.get("middle.part.rate") == pytest.approx(np.sqrt(15 / 2))


def test_variables():
    names = {v.name: v for v in fmu.description("IncludeNest").modelVariables}
    for name in ("middle.part.x", "der(middle.part.v)", "middle.part.m", "middle.part.body1.x", "middle.speed", "b"):
        assert name in names
    assert "middle.part.F" not in names and "nonConservativeWork" not in names
    assert (float(names["middle.part.k"].start), float(names["middle.part.k"].max)) == (5, 6)
    row = {v.name: v for v in fmu.description("IncludeRow").modelVariables}
    assert row["mass[1].F"].causality == "input" and row["mass[1].m"].causality == "calculatedParameter"
    assert fmu.description("IncludeRow").defaultExperiment.stopTime == "10"
    for name in TEXTS:
        assert validate_fmu(str(fmu.archive(name))) == []


# Each file overrides some attributes set by the next inner one; in c[1] and d[1] the outermost file overrides none.
LAYERS = {
    "cell.xml": """<system name="Cell">
  <constant name="N" value="1"/>
  <parameter name="m" start="2" unit="kg" min="0" max="5"/>
  <parameter name="k" value="8*N" unit="N/m"/>
  <parameter name="s" start="1" unit="1" min="0.5"/>
  <input name="F" unit="N" start="0.1" min="-1" max="1"/>
  <coordinate name="x" velocity="v" unit="m" start="0.5" velocityStart="0.9"/>
  <particle mass="m" x="x"/>
  <force coordinate="x">s*F - k*x</force>
</system>""",
    "mid.xml": """<system name="Mid">
  <parameter name="p" start="3" unit="1"/>
  <for index="i" from="1" to="2">
    <include file="cell.xml" as="c[i]">
      <constant name="N" value="7"/>
      <parameter name="m" start="1.5" min="1" max="4"/>
      <parameter name="s" value="p"/>
      <input name="F" max="2" start="0.2"/>
      <coordinate name="x" start="0.7" velocityStart="-0.4*i"/>
    </include>
  </for>
</system>""",
    "two.xml": """<system name="Two">
  <for index="i" from="1" to="2">
    <include file="mid.xml" as="d[i]">
      <parameter name="c[2].m" start="3"/>
      <parameter name="c[2].s" start="i"/>
      <parameter name="c[2].k" start="9"/>
      <input name="c[2].F" min="-3"/>
      <coordinate name="c[2].x" start="0.8*i"/>
    </include>
  </for>
</system>""",
    "system.xml": """<system name="Three">
  <include file="two.xml" as="e">
    <constant name="d[1].c[1].N" value="4"/>
    <parameter name="d[2].c[2].m" max="3.5"/>
    <input name="d[2].c[2].F" start="0.4"/>
    <coordinate name="d[2].c[2].x" velocityStart="-2"/>
  </include>
</system>""",
}  # fmt: skip


def test_the_outer_include_wins_attribute_by_attribute(tmp_path):
    result = compile_all(tmp_path, LAYERS)
    assert result.returncode == 0 and result.stderr == "", result.stderr
    variables = {v.name: v for v in read_model_description(tmp_path / "out").modelVariables}
    number = lambda text: None if text is None else float(text)
    messages = lambda name: tuple(number(getattr(variables[f"e.d{name}"], what)) for what in ("start", "min", "max"))
    for cell, x, v, m, k, s, F in [
        ("[1].c[1]", 0.7, -0.4, (1.5, 1, 4), None, None, (0.2, -1, 2)),
        ("[1].c[2]", 0.8, -0.8, (3, 1, 4), 9, 1, (0.2, -3, 2)),
        ("[2].c[1]", 0.7, -0.4, (1.5, 1, 4), None, None, (0.2, -1, 2)),
        ("[2].c[2]", 1.6, -2, (3, 1, 3.5), 9, 2, (0.4, -3, 2)),
    ]:
        assert (messages(f"{cell}.x")[0], messages(f"{cell}.v")[0]) == (x, v)
        assert messages(f"{cell}.m") == m and messages(f"{cell}.F") == F
        assert messages(f"{cell}.k") == (k, None, None) and messages(f"{cell}.s") == (s, 0.5 if s else None, None)
        assert (variables[f"e.d{cell}.s"].causality == "parameter") == (s is not None)
    system = (tmp_path / "out" / "system.c").read_text()
    assert "32.0" in system and "56.0" in system  # k = 8 N of the cells with N = 4 and N = 7


def test_a_range_of_a_parameter_calculated_by_an_inner_include(tmp_path):
    middle = '<system name="M"><parameter name="p" start="1"/><include file="part.xml" as="part"><parameter name="a" value="p"/></include></system>'
    texts = {
        "system.xml": '<system name="Around">\n<include file="middle.xml" as="middle">\n<parameter name="part.a" max="2"/></include></system>',
        "middle.xml": middle,
        "part.xml": '<system name="P"><parameter name="a" start="1"/></system>',
    }
    result = compile_all(tmp_path, texts)
    assert result.returncode == 1 and "system.xml:3: a <parameter> has a value and a max; expected value" in result.stderr, result.stderr


def test_a_changed_part_is_rebuilt(tmp_path):
    texts = {name: TEXTS[name] for name in ("IncludePart", "IncludeMiddle", "IncludeNest")}
    built = lambda folder: {name: (folder / f"{name}.fmu").read_bytes() for name in texts}
    before = built(build_by_cmake(tmp_path, texts))
    after = built(build_by_cmake(tmp_path, texts | {"IncludePart": PART.format(mass=4)}))
    assert all(after[name] != before[name] for name in texts)


def compile_all(folder, texts):
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    return lagc("system.xml", "-o", "out", cwd=folder)


AROUND = '<system name="Around">\n<parameter name="secret" start="1"/>\n<include file="parts/part.xml" as="part">{}</include>\n</system>'
INCLUDED = " (included as 'part' on line 3 of system.xml)"


@pytest.mark.parametrize("inside, message", [
    ("<coordinate name='x' velocity='v'/>\n<particle mass='secret' x='x'/>",
     "parts/part.xml:3: mass of <particle>: unknown name 'secret'; expected a parameter, coordinate, velocity, state, mode, input, definition or time" + INCLUDED),
    ("<coordinate name='mass' velocity='v'/>\n<particle mass='1' x='maas'/>", "parts/part.xml:3: x of <particle>: unknown name 'maas'; did you mean 'mass'?" + INCLUDED),
    ("<parameter name='sin' start='1'/>", "parts/part.xml:2: the name 'sin' belongs to the language itself; expected another name" + INCLUDED),
    ("<particle name='a' mass='1' x='1'/>\n<particle name='a' mass='1' x='1'/>", "a particle or body named 'part.a' is already defined on line 2"),
    ("<define name='a'>b</define>\n<define name='b'>a</define>", "parts/part.xml:2: definitions depend on each other in a circle: part.a -> part.b -> part.a"),
    ("<potentail>1</potentail>", "parts/part.xml:2: <potentail> is not an element of <system>; did you mean 'potential'?" + INCLUDED),
    ("<include file='../system.xml' as='again'/>", "files include each other in a circle: system.xml -> parts/part.xml -> parts/../system.xml"),
    ("<include file='nothing.xml' as='again'/>", "parts/part.xml:2: the file 'parts/nothing.xml' cannot be read: No such file or directory"),
    ("<coordinate name='x' velocity='v'/>", "parts/part.xml:2: the coordinate 'part.x' has no inertia"),
])  # fmt: skip
def test_mistakes_in_a_part(inside, message, tmp_path):
    result = compile_all(tmp_path, {"system.xml": AROUND.format(""), "parts/part.xml": f"<system name='P'>\n{inside}\n</system>"})
    assert result.returncode == 1 and message in result.stderr, result.stderr


@pytest.mark.parametrize("inside, message", [
    ('<parameter name="Q" start="1"/>', "system.xml:3: 'parts/part.xml' has no <parameter> 'Q'; expected one of its names"),
    ('<parameter name="masss" start="1"/>', "system.xml:3: 'parts/part.xml' has no <parameter> 'masss'; did you mean 'mass'?"),
    ('<parameter name="F" start="1"/>', "system.xml:3: 'F' is not a <parameter> of 'parts/part.xml'; expected <input name=...>"),
    ('<parameter name="mass" value="1" start="2"/>', "a <parameter> has a value and a start"),
    ('<parameter name="mass" value="lost"/>', "system.xml:3: value of <parameter>: unknown name 'lost'"),
    ('<parameter name="mass" value="part.x"/>', "system.xml:3: value of <parameter> cannot depend on coordinates, but 'part.x' does"),
    ('<parameter name="mass" start="2"/><parameter name="mass" start="2"/>', "the <include> overrides 'mass' twice; expected once"),
    ('<parameter name="mass" start="-2"/>', "'part.mass': start -2 is outside min and max"),
    ('<parameter name="mass" unit="kg"/>', "<parameter> has no attribute 'unit'; expected name, start, value, min or max"),
    ('<input name="F" value="part.mass"/>', "system.xml:3: unit mismatch: the value of the input has the unit kg, expected kg.m/s2"),
    ('<coordinate name="x" start="part.mass"/>', "system.xml:3: unit mismatch: the start value has the unit kg, expected m"),
])  # fmt: skip
def test_mistakes_in_given_values(inside, message, tmp_path):
    part = """<system name="P"><parameter name="mass" start="1" unit="kg" min="0"/><input name="F" unit="N"/>
<coordinate name="x" velocity="v" unit="m"/><particle mass="mass" x="x"/><force coordinate="x">F</force></system>"""
    result = compile_all(tmp_path, {"system.xml": AROUND.format(inside), "parts/part.xml": part})
    assert result.returncode == 1 and message in result.stderr, result.stderr


@pytest.mark.parametrize("second, message", [
    ('<include file="part.xml" as="part"/>', 'as="part" is the name of the <include> on line 1 already; expected another name'),
    ('<for index="i" from="1" to="2"><include file="part.xml" as="other"/></for>', "with an index such as [i] where a <for> repeats it"),
    ('<include file="line.xml" as="other"/>', "line.xml:1: a <linearization> cannot be included; expected the file of a <system>"),
])  # fmt: skip
def test_mistakes_in_the_name(second, message, tmp_path):
    part = '<system name="P"><coordinate name="x" velocity="v"/><particle mass="1" x="x"/></system>'
    line = '<linearization of="part.xml" name="L"/>'
    around = f'<system name="Around"><include file="part.xml" as="part"/>{second}</system>'
    result = compile_all(tmp_path, {"system.xml": around, "part.xml": part, "line.xml": line})
    assert result.returncode == 1 and message in result.stderr, result.stderr


def test_parts_that_multiply_end(tmp_path):
    """Files that each include the next one a hundred times are an error."""
    texts = {f"p{i}.xml": f'<system name="P"><for index="i" from="1" to="100"><include file="p{i + 1}.xml" as="a[i]"/></for></system>' for i in range(9)}
    result = compile_all(tmp_path, {**texts, "p9.xml": '<system name="P"/>', "system.xml": texts["p0.xml"]})
    assert result.returncode == 1 and "the system is too large" in result.stderr, result.stderr
