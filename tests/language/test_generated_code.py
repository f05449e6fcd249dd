"""C from every accepted system compiles without warnings by gcc and clang."""

import re
import subprocess

import pytest

from fmu import ROOT, lagc

FLAGS = [
    *"-std=c11 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -Wno-unused-parameter -fsyntax-only".split(),
    *("-I", ROOT / "include", "-I", ROOT / "src" / "runtime"),
]

SYSTEM = """\
<system name="Generated">
  <parameter name="a" start="1.5"/>
  <input name="u"/>
  <coordinate name="x" velocity="v" start="0.7"/>
  <particle name="p" mass="a" x="x"/>
  {}
  <solver method="{}"/>
</system>
"""
PLACES = {
    "potential": "<potential>{}</potential>",
    "force": '<force coordinate="x">{}</force><work/>',
    "output": '<output name="y">{}</output>',
    "kinetic": "<kinetic>({})*v^2</kinetic>",
}
EXPRESSIONS = [
    "2^x", "2^-x", "x^-x", "x^x", "a^(2*x)", "(a + x)^-(x + 1)", "1^x", "(x^0)^x", "(1 + x^2)^(a*x) + a*x", "x^a", "x^-a",
    "2^-x*3^-x", "2^-x + x*2", "sqrt(2^-x)", "2^-(2^-x)", "3", "x - x", "x^-3 - x^-1.5",
]  # fmt: skip


def compile_all(*folders):
    for compiler in ("gcc", "clang"):
        result = subprocess.run([compiler, *FLAGS, *(folder / "system.c" for folder in folders)], capture_output=True, text=True)
        assert result.returncode == 0, result.stderr


def check_all_methods(elements, folder):
    """Compile with a series, without one, with a Jacobian (bdf has the same as radau), and with both."""
    methods = ("taylor", "erk", "radau", "auto")
    for method in methods:
        (folder / "system.xml").write_text(SYSTEM.format(elements, method))
        result = lagc("system.xml", "-o", method, "--form", "statements", cwd=folder)
        assert (result.returncode, result.stderr) == (0, "")
    compile_all(*(folder / method for method in methods))


@pytest.mark.parametrize("place", PLACES)
def test_powers(place, tmp_path):
    """Each expression uses a coordinate of its own."""
    elements = []
    for i, expression in enumerate(EXPRESSIONS):
        elements.append(f'<coordinate name="x{i}" velocity="v{i}" start="0.7"/><particle name="p{i}" mass="a" x="x{i}"/>')
        elements.append(re.sub(r'\b([xvy])\b(?!=)', rf"\g<1>{i}", PLACES[place].format(expression)).replace("<work/>", ""))
    check_all_methods("".join(elements), tmp_path)


@pytest.mark.parametrize("expression", ["3", "x - x"])
@pytest.mark.parametrize("place", PLACES)
def test_constants(place, expression, tmp_path):
    """In a system with a single expression, many generated declarations are unused."""
    check_all_methods(PLACES[place].format(expression), tmp_path)


def test_inertia_of_many_long_names(tmp_path):
    """C guarantees strings of 4095 characters; the message about vanished inertia is cut to that."""
    name = "theCoordinateWithTheLongestNameThatAnyoneHasGivenToOne"
    elements = (
        f'<for index="i" from="1" to="100"><coordinate name="{name}[i]" velocity="v[i]"/></for><particle mass="a" '
        f'x="sum(i, 1, 100, {name}[i]^2)"/><for index="i" from="1" to="100"><particle mass="a" x="{name}[i]"/></for>'
    )
    (tmp_path / "system.xml").write_text(SYSTEM.format(elements, "erk"))
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    compile_all(tmp_path / "out")
    text = (tmp_path / "out" / "system.c").read_text()
    table = text[text.index("inertia_depends_on[] = {") :].split("};")[0]
    assert f'"a, x, {name}[1], ' not in table and f"{name}[1], {name}[2]" in table and ', ..."' in table


@pytest.mark.parametrize("form", ["statements", "tables"])
@pytest.mark.parametrize("method", ["taylor", "erk", "bdf", "radau", "auto"])
def test_coupled_masses(method, form, tmp_path):
    """M is constant and couples three coordinates, whose accelerations appear in no derivative of the equations."""
    elements = '<for index="i" from="1" to="3"><coordinate name="q[i]" velocity="w[i]"/><particle mass="a" x="q[i]"/></for>'
    (tmp_path / "system.xml").write_text(SYSTEM.format(elements + "<kinetic>(w[1] + w[2] + w[3])^2</kinetic>", method))
    assert lagc("system.xml", "-o", "out", "--form", form, cwd=tmp_path).returncode == 0
    compile_all(tmp_path / "out")
