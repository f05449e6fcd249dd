"""Every element of a system contributes to its equations; each has a distinct coefficient."""

import html
import math
import re

import pytest
import sympy as sp
from lxml import etree

from fmu import lagc

# Names are used before their definition wherever that is allowed.
SYSTEM = """\
<system name="Everything">
  <constant name="N" value="3"/>
  <constant name="two" value="2"/>
  <potential>k1*x + later*k2</potential>
  <for index="i" from="1" to="N">
    <potential>c[i]*i*x</potential>
    <for index="j" from="i" to="two">
      <force coordinate="x">d[j]*(10*i + j)</force>
    </for>
  </for>
  <particle name="mark0" mass="m0" y="3*x"/>
  <for index="i" from="1" to="two">
    <define name="half[i]">x*e[i]/i</define>
    <potential>half[i]*k3</potential>
    <particle name="mark[i]" mass="m[i]" x="i*x" y="mark0.y + i*x"/>
    <force on="mark[i]" x="f[i]" y="g[i]"/>
  </for>
  <define name="later">5*x</define>
  <potential>sum(i, 1, N, c[i]*x^2*sum(j, 1, i, j)) + k4*mark0.y</potential>
  <kinetic>h1*v^2/2</kinetic>
  <kinetic>h2*v^2/2</kinetic>
  <body name="wheel" mass="m3" x="7*x" inertia="m4" angle="11*x"/>
  <dissipation>b1*v^2/2</dissipation>
  <dissipation>b2*v^4/4</dissipation>
  <force coordinate="x">k5*u</force>
  <force coordinate="x">k6*time</force>
  <for index="i" from="1" to="0"><potential>1000*x</potential></for>
  <output name="o1">k7*x</output>
  <force coordinate="x">o1*13</force>
  <input name="u"/>
  <coordinate name="x" velocity="v"/>
  {}
</system>
"""
NAMES = "k1 k2 k3 k4 k5 k6 k7 h1 h2 b1 b2 m0 m3 m4 c[1] c[2] c[3] d[1] d[2] e[1] e[2] m[1] m[2] f[1] f[2] g[1] g[2]"


def test_every_term_arrives(tmp_path):
    parameters = "".join(f'<parameter name="{name}" start="1"/>' for name in NAMES.split())
    (tmp_path / "system.xml").write_text(SYSTEM.format(parameters))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    page = html.unescape((tmp_path / "out" / "documentation" / "index.html").read_text())
    ((left, right),) = re.findall(r'<code data-latex="[^"]*">([^<=]*der\(v\)[^<=]*) = ([^<]*)</code>', page)
    plain = lambda text: re.sub(r"(\w)\[(\d)\]", r"\1_\2", text).replace("der(v)", "acc").replace("^", "**")
    s = {name: sp.Symbol(name) for name in [*plain(NAMES).split(), *"x v u time acc".split()]}
    ours = sp.sympify(plain(left), locals=s) - sp.sympify(plain(right), locals=s)
    # By hand: M a - Q + dU/dx.
    expected = sp.sympify(
        """
        (m0*9 + m_1*(1 + 16) + m_2*(4 + 25) + m3*49 + m4*121 + h1 + h2)*acc
        - (d_1*11 + d_2*12 + d_2*22 + f_1 + 2*f_2 + 4*g_1 + 5*g_2 - b1*v - b2*v**3 + k5*u + k6*time + 13*k7*x)
        + k1 + 5*k2 + c_1 + 2*c_2 + 3*c_3 + k3*(e_1 + e_2/2) + 2*x*(c_1 + 3*c_2 + 6*c_3) + 3*k4
        """.replace("\n", " ").strip(),
        locals=s,
    )
    assert sp.expand(ours - expected) == 0


def test_the_page_keeps_the_names_of_definitions(tmp_path):
    """
    Formulas use a definition's name wherever its whole expression occurs; definitions that are mere variables or numbers are expanded.
    """
    (tmp_path / "system.xml").write_text(
        """<system name="Names"><parameter name="k" start="1"/><parameter name="l" start="1"/>
  <coordinate name="x" velocity="v"/>
  <define name="half">1/2</define><define name="place">x</define>
  <define name="way">sqrt(l^2 + x^2)</define><define name="stretch">way - l</define><define name="angle">x/l + 1</define>
  <kinetic>half*v^2</kinetic><potential>k*stretch^2/2 + cos(angle) + place</potential>
  <output name="pull">3*k*stretch</output><output name="far">stretch + 2*sin(angle)</output>
</system>"""
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    lines = re.findall(r'<code data-latex="[^"]*">([^<]*)</code>', html.unescape((tmp_path / "out" / "documentation" / "index.html").read_text()))
    for line in ("way = sqrt(x^2 + l^2)", "stretch = way - l", "angle = x/l + 1", "K = v^2/2", "pull = 3*k*stretch"):
        assert line in lines
    assert not any(line.startswith(("half =", "place =")) for line in lines)
    (potential,), (far,), (motion,) = ([line for line in lines if line.startswith(left)] for left in ("U =", "far =", "der(v) ="))
    assert "k*stretch^2/2" in potential and "cos(angle)" in potential
    assert "2*sin(angle)" in far and "sin(angle)/l" in motion and "stretch/way" in motion


def test_the_page_of_a_large_system(tmp_path):
    """The page shows a hundred equations and outputs, and states the number of the others."""
    (tmp_path / "system.xml").write_text(
        """<system name="Many"><constant name="N" value="300"/>
  <for index="i" from="1" to="N">
    <coordinate name="x[i]" velocity="v[i]"/><kinetic>v[i]^2/2</kinetic><potential>cos(x[i])</potential>
    <output name="y[i]">2*x[i]</output>
  </for>
</system>"""
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    page = (tmp_path / "out" / "documentation" / "index.html").read_text()
    assert ">der(v[100]) = sin(x[100])</code>" in page and ">y[100] = 2*x[100]</code>" in page
    assert "der(v[101]) =" not in page and "y[101] =" not in page
    assert "200 further equations are not shown" in page and "200 further outputs are not shown" in page
    # 300 coordinates and velocities, their derivatives, 300 outputs, 3 energies and 2 statistics make 1505 rows.
    assert page.count("<tr>") == 1001 and "505 further variables, which modelDescription.xml has, are not shown" in page


def test_dependencies_of_a_large_coupled_system(tmp_path):
    """
    Inerters in a row couple all accelerations, so that dependency lists would grow as the square of their number. They are then omitted,
    and FMI assumes all knowns. An output always has its list.
    """
    (tmp_path / "system.xml").write_text(
        """<system name="Row"><constant name="N" value="501"/><input name="F"/>
  <for index="i" from="1" to="N"><coordinate name="x[i]" velocity="v[i]"/><kinetic>v[i]^2/2</kinetic></for>
  <for index="i" from="2" to="N">
    <kinetic>(v[i] - v[i-1])^2/2</kinetic><potential>cos(x[i] - x[i-1])</potential><dissipation>v[i]^4</dissipation>
  </for>
  <force coordinate="x[1]">F</force>
  <output name="mean">sum(i, 1, N, x[i] + v[i])/N</output>
</system>"""
    )

    def structure(*words):
        result = lagc("system.xml", "-o", "out", *words, cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        root = etree.parse(tmp_path / "out" / "modelDescription.xml")
        names = [variable.get("name") for variable in root.iter("ScalarVariable")]
        return {
            names[int(unknown.get("index")) - 1]: unknown.get("dependencies")
            for unknown in root.find("ModelStructure/Derivatives")
        }, [unknown.get("dependencies") for unknown in root.find("ModelStructure/Outputs")]

    # 501 positions, 500 velocities and the input are 1002 knowns; with one mass less they are 1000.
    derivatives, outputs = structure()
    assert derivatives["der(v[7])"] is None and len(derivatives["der(x[7])"].split()) == 1
    assert len(outputs[-1].split()) == 1002
    derivatives, _ = structure("-D", "N=500")
    assert len(derivatives["der(v[7])"].split()) == 1000


def equations(lines, folder):
    (folder / "system.xml").write_text('<system name="Order">' + "\n".join(lines) + "</system>")
    result = lagc("system.xml", "-o", "out", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    page = html.unescape((folder / "out" / "documentation" / "index.html").read_text())
    ((left, right),) = re.findall(r'<code data-latex="[^"]*">([^<=]*der\(v\)[^<=]*) = ([^<]*)</code>', page)
    return sp.sympify(f"{left} - ({right})".replace("der(v)", "acc").replace("^", "**"))


def test_the_order_of_definitions_is_free(tmp_path):
    """Each definition uses the next one through a position, in forward and in reverse order."""
    lines = [
        '<coordinate name="x" velocity="v"/>', '<parameter name="k" start="1"/>', '<parameter name="m" start="1"/>',
        '<for index="i" from="1" to="3"><define name="a[i]">i*a[i+1] + sum(j, 1, i, b[j])</define></for>',
        '<for index="j" from="1" to="3"><define name="b[j]">j*x</define></for>',
        '<define name="a[4]">end.x</define>', '<particle name="end" mass="m" x="2*x" y="end.x + middle.x"/>',
        '<particle name="middle" mass="0" x="third*x"/>', '<define name="third">3</define>', "<potential>k*a[1]</potential>",
    ]  # fmt: skip
    x, k, m, acc = sp.symbols("x k m acc")
    # a[4] = 2 x, a[3] = 3*2x + 6x, a[2] = 2 a[3] + 3 x, a[1] = a[2] + x; y = 5 x
    expected = m * (4 + 25) * acc + k * (2 * (6 + 6) + 3 + 1)
    for order in (lines, lines[::-1]):
        assert sp.expand(equations(order, tmp_path) - expected) == 0


def test_a_long_chain_of_definitions_backwards(tmp_path):
    """A chain of 20,000 definitions is deeper than the stack allows for recursion."""
    chain = [f'<define name="d{i}">d{i + 1} + x</define>' for i in range(20000)] + ['<define name="d20000">x</define>']
    text = "".join(['<system name="Chain"><coordinate name="x" velocity="v"/><kinetic>v^2/2</kinetic>', *chain, "<potential>d0</potential></system>"])
    (tmp_path / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


def test_values_with_units_on_the_command_line(tmp_path):
    """-g/l cos(theta) of a pendulum, of which -D gives the length and --at the angle."""
    (tmp_path / "system.xml").write_text(
        '<system name="Unit"><constant name="l" value="0.5" unit="m"/><constant name="g" value="9.81" unit="m/s2"/><parameter name="m" start="1" unit="kg"/>'
        '<coordinate name="theta" velocity="omega" unit="rad"/><particle name="bob" mass="m" x="l*sin(theta)" y="-l*cos(theta)"/><potential>m*g*bob.y</potential></system>'
    )
    for words, length, angle in ((("-D", "l=20cm"), 0.2, 0), (("-D", "l=2*0.1"), 0.2, 0), (("--at", "theta=30deg"), 0.5, math.pi / 6), (("-D", "l=8inch", "--at", "theta=60 deg,omega=0rpm"), 0.2032, math.pi / 3)):
        row = re.search(r"\[(\S+), 0\]", lagc("--linearize", "system.xml", *words, cwd=tmp_path).stdout)
        assert float(row[1]) == pytest.approx(-9.81 / length * math.cos(angle), rel=1e-12)
    for word, message in (("l=3kg", "-D l: '3kg' is in kg; expected a value in m\n"), ("l=3ells", "-D l: the unit 'ells' of '3ells' is not known; expected a value in m\n")):
        result = lagc("--linearize", "system.xml", "-D", word, cwd=tmp_path)
        assert (result.returncode, result.stderr) == (1, message)


def test_an_empty_sum_names_nothing(tmp_path):
    """With one mass sum(i, 2, 1, ...) is 0, even where its term contains x[2]."""
    (tmp_path / "system.xml").write_text(
        '<system name="One"><constant name="N" value="1"/><for index="i" from="1" to="N"><coordinate name="x[i]" velocity="v[i]"/>'
        '<particle mass="1" x="x[i]"/></for><potential>x[1]^2 + sum(i, 2, N, (x[i] - x[i-1])^2)</potential></system>'
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    result = lagc("system.xml", "-o", "out", "-D", "N=2", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
