"""Lists of constants, units with roots, and conversion factors of units that are not SI."""

import re

import pytest

from fmu import lagc

# Gauss's rule of three nodes integrates x^5 + x^4 over -1 to 1 exactly: 2/5.
RULE = """<system name="X"><constant name="x" values="-sqrt(3/5), 0, sqrt(3/5)"/><constant name="w" values="5/9 8/9 5/9"/>
<function name="y" arguments="x">x^5 + x^4</function><parameter name="p" start="sum(i, 1, 3, w[i]*y(x[i]))"/><output name="o">p</output></system>"""
ORIFICE = """<system name="X"><parameter name="k" start="2" unit="m3/(s.Pa0.5)" displayUnit="l/(s.bar0.5)"/><input name="p" unit="{p}" start="4"/>
<state name="V" unit="m3" rate="k*sqrt(p)"/></system>"""


def compiled(tmp_path, text, *words):
    (tmp_path / "system.xml").write_text(text)
    return lagc("system.xml", "-o", "out", *words, cwd=tmp_path)


def start_of_p(tmp_path):
    return float(re.search(r'name="p".*?start="(.*?)"', (tmp_path / "out" / "modelDescription.xml").read_text(), re.S).group(1))


def test_lists_of_constants(tmp_path):
    assert compiled(tmp_path, RULE).returncode == 0
    assert start_of_p(tmp_path) == pytest.approx(2 / 5, rel=1e-15)
    assert compiled(tmp_path, RULE, "-D", "w[2]=0").returncode == 0
    assert start_of_p(tmp_path) == pytest.approx(2 / 5, rel=1e-15)
    assert compiled(tmp_path, RULE, "-D", "x[2]=1").returncode == 0
    assert start_of_p(tmp_path) == pytest.approx(2 / 5 + 2 * 8 / 9, rel=1e-15)


def test_a_part_gets_one_of_a_list(tmp_path):
    (tmp_path / "part.xml").write_text('<system name="Part"><constant name="a" values="1 2"/><output name="o">10*a[1] + a[2]</output></system>')
    text = '<system name="X"><include file="part.xml" as="part"><constant name="a[2]" value="5"/></include><parameter name="p" start="part.a[1]*10 + part.a[2]"/><output name="o">p</output></system>'
    assert compiled(tmp_path, text).returncode == 0
    assert start_of_p(tmp_path) == 15


def test_units_with_roots(tmp_path):
    result = compiled(tmp_path, ORIFICE.format(p="Pa"))
    assert (result.returncode, result.stderr) == (0, "")
    text = (tmp_path / "out" / "modelDescription.xml").read_text()
    unit = re.search(r'<Unit name="m3/\(s.Pa0.5\)">(.*?)</Unit>', text, re.S).group(1)
    assert "BaseUnit" not in unit and float(re.search(r'factor="(.*?)"', unit).group(1)) == pytest.approx(1e3 * 1e5**0.5)
    assert "unit mismatch: the rate has the unit m3.N0.5" not in result.stderr
    assert "the rate has the unit" in compiled(tmp_path, ORIFICE.format(p="N")).stderr


@pytest.mark.parametrize("unit, remedy", [
    ("bar", "Pa, and the value times 1e5"), ("degC", "K, and the value plus 273.15"), ("l/min", "m3/s, and the value times 1/60000"),
    ("psi", "Pa, and the value times 6894.757293168361"), ("inch", "m, and the value times 0.0254"), ("deg", "rad, and the value times pi/180"),
    ("N/mm0.5", "N/m0.5, and the value times 31.622776601683"), ("kPa.s", "Pa.s, and the value times 1e3"),
])  # fmt: skip
def test_units_that_are_not_si(tmp_path, unit, remedy):
    result = compiled(tmp_path, f'<system name="X"><parameter name="p" start="1" unit="{unit}"/><output name="o">p</output></system>')
    assert f"system.xml:1: the unit '{unit}' is not known; expected {remedy}" in result.stderr


@pytest.mark.parametrize("constant, message", [
    ('<constant name="a" values=" ,"/>', "the constant 'a' has no values; expected numbers"),
    ('<constant name="a"/>', "<constant> needs the attribute 'value'"),
    ('<constant name="a" value="1" values="1 2"/>', "a <constant> has both value and values"),
    ('<constant name="a" values="1 b"/>', "unknown name 'b'"),
])  # fmt: skip
def test_messages(tmp_path, constant, message):
    assert message in compiled(tmp_path, f'<system name="X">{constant}<output name="o">1</output></system>').stderr


@pytest.mark.parametrize("content, message", [
    ('<mode name="peak"/><event when="v"><set mode="peak">x</set></event>', 'the value of <set> has the unit m, but \'peak\' has none; expected unit="m" of its <mode>'),
    ('<mode name="peak" unit="s"/><event when="v"><set mode="peak">x</set></event>', "the value of <set> has the unit m, expected s"),
    ('<mode name="peak"/><force coordinate="x">peak</force>', "the force has the unit 1, expected kg.m/s2"),
    ('<mode name="peak" unit="m"/><event when="v"><set mode="peak">x</set></event><force coordinate="x">k*peak</force>', None),
    ('<mode name="n"/><event when="v"><set mode="n">n + 1</set></event>', None),
    ('<function name="f" arguments="s" unit="N">sin(s)</function><force coordinate="x">f(2)</force>', "the value of 'f' has the unit 1, expected kg.m/s2"),
    ('<function name="f" arguments="s" unit="N">floor(s)*k</function><force coordinate="x">f(2)</force>', "the value of 'f' has the unit kg/s2, expected kg.m/s2"),
    ('<function name="f" arguments="s" unit="N">k*s</function><force coordinate="x">f(x)</force>', None),
    ('<function name="f" arguments="s" unit="N">s + k*x</function><force coordinate="x">f(2)</force>', None),
])  # fmt: skip
def test_units_of_modes_and_functions(tmp_path, content, message):
    """
    A mode without a unit is a pure number. A number as an argument takes the unit of the quantity it is added to or compared with; a function of it does not.
    """
    text = f'<system name="X"><parameter name="k" start="2" unit="N/m"/><parameter name="m" start="1" unit="kg"/><coordinate name="x" velocity="v" unit="m"/><particle mass="m" x="x"/>{content}</system>'
    result = compiled(tmp_path, text)
    assert (result.returncode, result.stderr) == (0, "") if message is None else (result.returncode == 1 and message in result.stderr), result.stderr


def test_a_forgotten_unit_in_a_for_is_warned_of_once(tmp_path):
    """The warning appears once for each line of a <for>, and once for each variable outside of it."""
    (tmp_path / "system.xml").write_text("""<system name="F"><input name="u" unit="1"/><parameter name="T" start="1" unit="s"/><state name="x[0]" rate="(u - x[0])/T"/>
<for index="i" from="1" to="4"><state name="x[i]" rate="(x[i-1] - x[i])/T"/>
<state name="y[i]" rate="(x[i-1] - y[i])/T"/></for></system>""")
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    warned = [line.split("'")[1] for line in result.stderr.splitlines() if "has no unit" in line]
    assert result.returncode == 0 and warned == ["x[0]", "x[1]", "y[1]"]
