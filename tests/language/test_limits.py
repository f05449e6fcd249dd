"""lagc bounds its work for any file: beyond a limit it stops with a message that names the limit."""

import re
import resource

import pytest

from fmu import lagc

SYSTEM = """<system name="Busy">
  <parameter name="m" start="1"/><parameter name="a" start="1"/><parameter name="b" start="1"/>
  <coordinate name="x" velocity="v" start="1"/><kinetic>m*v^2/2</kinetic>
  {}
</system>
"""


def compile_with(text, folder, before=""):
    (folder / "system.xml").write_text(before + SYSTEM.format(text))
    return lagc("system.xml", "-o", "out", cwd=folder)


def loops(*bounds, content="<potential>x</potential>"):
    for index, (first, last) in zip("ijk", reversed(bounds)):
        content = f'<for index="{index}" from="{first}" to="{last}">{content}</for>'
    return content


STEPS = "the system is too large: more than 200000000 steps to read and derive it"
REJECTED = {
    "an index beyond whole numbers": (loops(("1e17", "1e17")), "system.xml:4: <for> runs from .* expected whole numbers below 1e9"),
    "an index that cannot be counted on": (loops(("1e16", "1e16+1")), "system.xml:4: <for> runs from .* expected whole numbers below 1e9"),
    "an index far below 0": (loops(("-1e9", "-1e9")), "system.xml:4: <for> runs from .* expected whole numbers below 1e9"),
    "nested loops": (loops(("1", "10000"), ("1", "10000"), ("1", "10000")), STEPS),
    "nested loops of nothing": (loops(("1", "10000"), ("1", "10000"), ("1", "10000"), content=""), STEPS),
    "long sums in a loop": (loops(("1", "10000"), content="<potential>sum(j, 1, 100000, x)</potential>"), STEPS),
    "accelerations of which each depends on all": (
        loops(("1", "5000"), content='<coordinate name="q[i]" velocity="w[i]"/><kinetic>w[i]^2/2</kinetic>')
        + "<potential>sum(i, 1, 5000, (q[i] - x)^2)^2</potential>",
        "the description of the FMU needs more than 200000000 steps"),
}  # fmt: skip


REJECTED |= {
    "outputs in a chain": (
        '<output name="o[0]">x</output>' + loops(("1", "9999"), content='<output name="o[i]">sin(o[i-1])</output>'),
        "than 640 MB|the generated code needs more than 200000000 steps"),
    "constraints of which each meets all": (
        loops(("1", "9999"), content='<constraint name="c[i]">x - i*sin(time)</constraint>'), "than 640 MB|200000000 steps"),
    "branches in a loop": (
        '<table name="t">' + "".join(f"{k} {k * k % 17}\n" for k in range(500)) + "</table>"
        + loops(("1", "9999"), content='<force coordinate="x">t(i*x)</force>'), STEPS),
    "frames in frames": (
        '<frame name="f0"/>' + "".join(f'<frame name="f{k + 1}" in="f{k}"/>' for k in range(100000)), "more than 40000 elements"),
    "attributes": ("<potential " + " ".join(f'a{k}="1"' for k in range(100000)) + ">x</potential>", "more than 200 attributes"),
    "numbers in a table": ('<table name="t" arguments="2">' + "1 " * 2000000 + "</table>", "2000000 x 0 values"),
    "a long file": ("<potential>" + " " * 10000000 + "x</potential>", "longer than 10000000 bytes"),
}  # fmt: skip


MOST_SECONDS = 8  # s; several times the usual time, for busy machines


def seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


@pytest.mark.long
@pytest.mark.parametrize("text, message", REJECTED.values(), ids=REJECTED)
def test_limits(text, message, tmp_path):
    before = seconds_of_children()
    result = compile_with(text, tmp_path)
    assert result.returncode == 1 and len(result.stderr.splitlines()) == 1
    assert re.search(message, result.stderr), result.stderr
    assert seconds_of_children() - before < MOST_SECONDS
    assert not (tmp_path / "out" / "system.c").exists()


def test_the_longest_file(tmp_path):
    """A file of the 10,000,000 bytes that the message names is read."""
    blanks = 10_000_000 - len(SYSTEM.format("<potential>x</potential>"))
    result = compile_with("<potential>" + " " * blanks + "x</potential>", tmp_path)
    assert (tmp_path / "system.xml").stat().st_size == 10_000_000
    assert (result.returncode, result.stderr) == (0, "")


def test_derivatives_of_a_long_sum_in_a_loop(tmp_path):
    """lagc computes the derivatives of a shared sum once."""
    text = '<define name="long">sum(j, 1, 30000, sin(j*x))</define>' + loops(("1", "10000"), content="<dissipation>i*der(long)</dissipation>")
    before = seconds_of_children()
    assert compile_with(text, tmp_path).returncode == 0
    assert seconds_of_children() - before < MOST_SECONDS


@pytest.mark.parametrize(
    "entities",
    [
        '<!ENTITY a "x">',
        '<!ENTITY a "' + "x+" * 50000 + 'x">',
        '<!ENTITY b "x+x+x"><!ENTITY a "' + "&b;" * 10 + '">',
        "",
    ],
)
def test_entities(entities, tmp_path):
    result = compile_with("<potential>&a;</potential>", tmp_path, f"<!DOCTYPE system [{entities}]>\n")
    assert result.returncode == 1
    assert result.stderr.startswith("system.xml:1: <!DOCTYPE ...> and entities are not read; expected")
    assert len(result.stderr.splitlines()) == 1


def test_files_that_include_each_other_twice(tmp_path):
    """40 short files stand for 2^40 systems."""
    for k in range(40):
        includes = "".join(f'<include file="tree{k + 1}.xml" as="{name}"/>' for name in "ab")
        (tmp_path / f"tree{k}.xml").write_text(f'<system name="Tree">{includes}</system>')
    (tmp_path / "tree40.xml").write_text('<system name="Tree"><parameter name="q" start="1"/></system>')
    before = seconds_of_children()
    result = compile_with('<include file="tree0.xml" as="a"/>', tmp_path)
    assert result.returncode == 1 and "the system is too large: more than " in result.stderr
    assert seconds_of_children() - before < MOST_SECONDS


def test_files_that_include_each_other_in_a_row(tmp_path):
    for k in range(150):
        (tmp_path / f"link{k}.xml").write_text(f'<system name="Link"><include file="link{k + 1}.xml" as="a"/></system>')
    result = compile_with('<include file="link0.xml" as="a"/>', tmp_path)
    assert result.returncode == 1 and len(result.stderr) < 1500
    assert "more than 100 files include each other in a row" in result.stderr


def test_endless_errors(tmp_path):
    """lagc reports a hundred of 38,000 wrong elements, in less than quadratic time, and shortens long texts."""
    before = seconds_of_children()
    result = compile_with('<contact name="c" restitution="1">x</contact>\n' * 38000, tmp_path)
    lines = result.stderr.splitlines()
    assert result.returncode == 1 and len(lines) == 101 and "more errors follow" in lines[-1]
    result = compile_with("<potential>" + ".".join("q" * 5000) + "</potential>", tmp_path)
    assert result.returncode == 1 and "q ... " in result.stderr and len(result.stderr) < 1500
    assert seconds_of_children() - before < MOST_SECONDS


def heap(count, contact):
    """Return `count` spheres on a floor, of which any two may touch."""
    spheres = [
        f'<coordinate name="x{k}" velocity="u{k}"/><coordinate name="y{k}" velocity="v{k}"/><coordinate name="z{k}" velocity="w{k}" start="{k + 1}"/>'
        f'<particle name="p{k}" mass="m" x="x{k}" y="y{k}" z="z{k}"/><shape name="s{k}" in="p{k}" type="sphere" radius="0.1"/>'
        for k in range(count)
    ]
    pairs = [(f"s{k}", other) for k in range(count) for other in ["floor", *(f"s{j}" for j in range(k))]]
    contacts = [f'<contact name="c{i}" between="{one}" and="{other}" {contact}/>' for i, (one, other) in enumerate(pairs)]
    return '<shape name="floor" type="plane"/>' + "".join(spheres + contacts)


FINE = {
    **{f"{count} spheres with friction": heap(count, 'restitution="0" friction="0.5"') for count in (8, 20)},
    "30 spheres": heap(30, 'restitution="0"'),
    "negations in a row": '<force coordinate="x">if(' + "not " * 200000 + "x &gt; 0, 1, 2)</force>",
    "a quotient whose division leaves the numbers": '<particle mass="m" y="1/(x+1e200)" x="x"/>',
    "a division that ends below the numbers": '<particle mass="m" y="(1e-200*x + 1e-180)/(1e200*x + 1e190)" x="x"/>',
    "coefficients that overflow when multiplied": "<potential>(1e200*x + a)*(1e-200*x + b)/((1e160*x + 1)*(x + 1e-160))</potential>",
    "a product of 20,000 factors": "<potential>" + "*".join(f"(x+{i})/{i + 2}" for i in range(20000)) + "</potential>",
    "9,999 outputs": loops(("1", "9999"), content='<output name="y[i]">sin(i*x)</output>'),
}


@pytest.mark.parametrize("text", FINE.values(), ids=FINE)
def test_compiled(text, tmp_path):
    result = compile_with(text, tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
