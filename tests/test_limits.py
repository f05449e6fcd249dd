"""No file keeps lagc busy for long: what would is refused, with a message that says which limit it meets."""

import re

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


STEPS = "the system is too large: more than 100000000 steps to read and derive it"
REFUSED = {
    "an index beyond whole numbers": (loops(("1e17", "1e17")), "system.xml:4: <for> from .* expected whole numbers below 1e9"),
    "an index that cannot be counted on": (loops(("1e16", "1e16+1")), "system.xml:4: <for> from .* expected whole numbers below 1e9"),
    "an index far below 0": (loops(("-1e9", "-1e9")), "system.xml:4: <for> from .* expected whole numbers below 1e9"),
    "nested loops": (loops(("1", "10000"), ("1", "10000"), ("1", "10000")), STEPS),
    "nested loops of nothing": (loops(("1", "10000"), ("1", "10000"), ("1", "10000"), content=""), STEPS),
    "long sums in a loop": (loops(("1", "10000"), content="<potential>sum(j, 1, 100000, x)</potential>"), STEPS),
    "derivatives of a long sum in a loop": (
        '<define name="long">sum(j, 1, 30000, sin(j*x))</define>'
        + loops(("1", "10000"), content="<dissipation>i*der(long)</dissipation>"), STEPS),
    "accelerations of which each depends on all": (
        loops(("1", "5000"), content='<coordinate name="q[i]" velocity="w[i]"/><kinetic>w[i]^2/2</kinetic>')
        + "<potential>sum(i, 1, 5000, (q[i] - x)^2)^2</potential>",
        "the description of the FMU needs more than 100000000 steps"),
}  # fmt: skip


@pytest.mark.parametrize("text, message", REFUSED.values(), ids=REFUSED)
def test_refused(text, message, tmp_path):
    result = compile_with(text, tmp_path)
    assert result.returncode == 1 and len(result.stderr.splitlines()) == 1
    assert re.search(message, result.stderr), result.stderr
    assert not (tmp_path / "out" / "system.c").exists()


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


FINE = {
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
