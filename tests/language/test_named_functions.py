"""<function>: expressions with arguments, against the same expressions written out; and messages."""

import pytest

import fmu
from fmu import build_systems, lagc

HEAD = '<parameter name="L" start="2" unit="m"/><parameter name="m" start="1.5" unit="kg"/><parameter name="k" start="3" unit="N/m"/>'
BEADS = """<system name="{name}">{head}
  {functions}
  <define name="share">0.25</define>
  <for index="i" from="1" to="2">
    <coordinate name="q[i]" velocity="v[i]" unit="m" start="0.3*i"/>{inner}
    <particle name="bead[i]" mass="m" x="{x}" y="{y}"/>
  </for>
  <potential>{energy}</potential>
  <output name="total" unit="m">{total}</output>
  <solver tolerance="1e-10"/>
</system>"""
# Nested functions, before and after the functions that they use; an argument that shadows a variable; and a function that uses the index of
# a <for>.
BY_FUNCTIONS = BEADS.format(
    name="FunctionBeads", head=HEAD, functions="""<function name="hang" arguments="a b">bend(a, 0)*(1 + bend(b, a)/L)</function>
  <function name="bend" arguments="q t2" unit="m">share*(q - t2)*cos(q/L)</function>
  <function name="spring" arguments="k, q">k*abs(q)*q/2 + sum(i, 1, 2, k*bead[i].y^2)</function>""",
    inner='<function name="lift[i]" arguments="a">i*a^2/L</function>', x="hang(q[i], L)", y="lift[i](q[i])",
    energy="spring(k, q[1]) + sum(i, 1, 2, spring(2*k, q[2]*i))", total="sum(j, 1, 2, lift[j](q[j] - L))",
)  # fmt: skip
BEND = "0.25*{q}*cos({q}/L)"
SPRING = "{k}*abs({q})*({q})/2 + {k}*bead[1].y^2 + {k}*bead[2].y^2"
WRITTEN_OUT = BEADS.format(
    name="WrittenBeads", head=HEAD, functions="", inner="",
    x=f"{BEND.format(q='q[i]')}*(1 + 0.25*(L - q[i])*cos(L/L)/L)", y="i*q[i]^2/L",
    energy=" + ".join(SPRING.format(k=k, q=q) for k, q in [("k", "q[1]"), ("2*k", "q[2]"), ("2*k", "q[2]*2")]),
    total="(q[1] - L)^2/L + 2*(q[2] - L)^2/L",
)  # fmt: skip
LIBRARY = """<system name="FunctionLibrary"><parameter name="g" start="9.81" unit="m/s2"/>
  <function name="fall" arguments="t">-g*t^2/2</function><output name="second" unit="m">fall(1)</output></system>"""
USER = """<system name="FunctionUser"><include file="../FunctionLibrary/system.xml" as="lib"><parameter name="g" start="4"/></include>
  <parameter name="t" start="3" unit="s"/><output name="fallen" unit="m">lib.fall(t) + lib.fall(2*t)</output></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("functions", {"FunctionBeads": BY_FUNCTIONS, "WrittenBeads": WRITTEN_OUT, "FunctionLibrary": LIBRARY, "FunctionUser": USER})


def test_functions_are_their_expressions(open_fmu):
    runs = []
    for name in ("FunctionBeads", "WrittenBeads"):
        instance = open_fmu(name).initialize()
        runs.append(instance.run(2, 0.1, "q[1]", "q[2]", "v[1]", "bead[2].x", "total", "totalEnergy"))
    for first, second in zip(*runs):
        assert first == pytest.approx(second, rel=1e-8, abs=1e-8)


def test_functions_of_an_included_file(open_fmu):
    instance = open_fmu("FunctionUser").initialize()
    assert instance.get("fallen") == -4 * 9 / 2 - 4 * 36 / 2
    assert instance.get("lib.second") == -2


def complaints(tmp_path, content):
    (tmp_path / "system.xml").write_text(f'<system name="X">\n{content}\n<parameter name="l" start="1" unit="1"/><output name="o">f(l)</output>\n</system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    return result.stderr


@pytest.mark.parametrize("content, message", [
    ('<function name="f" arguments="s">g(s)</function>\n<function name="g" arguments="s">f(s)</function>',
     "system.xml:3: the output 'o' of line 4, in the function 'g': functions call each other in a circle: f -> g -> f"),
    ('<function name="f" arguments="s">\n1 +\ns + u</function>', "system.xml:4: the output 'o' of line 5, in the function 'f': unknown name 'u'"),
    ('<function name="f" arguments="s">s + i</function><for index="i" from="1" to="1"><output name="p[i]">f(i)</output></for>', "unknown name 'i'"),
    ('<function name="f" arguments="s s">s</function>', "system.xml:2: the function 'f' has two arguments 's'"),
    ('<function name="f" arguments=" ">1</function>', "the function 'f' has no arguments; expected arguments=\"s t\""),
    ('<function name="f" arguments="1s">1</function>', "the argument '1s' of the function 'f' is not a name"),
    ('<function name="f" arguments="s">f + s</function>', "'f' is not a variable but a function; expected its argument in parentheses"),
    ('<function name="f" arguments="s">s)</function>', "')' without '('"),
    ('<function name="sin" arguments="s">s</function>', "the name 'sin' belongs to the language itself"),
    ('<function name="ff" arguments="s">s</function><output name="u">ff()</output>', "expected a number, a name or '('"),
    ('<function name="f" arguments="s" unit="kg">s*r</function><parameter name="r" start="1" unit="m"/><output name="p" unit="kg">f(2)</output>', "the value of 'f' has the unit m, expected kg"),
    ('<function name="F0" arguments="s">s</function>', "unknown function 'f'"),
])  # fmt: skip
def test_messages(tmp_path, content, message):
    assert message in complaints(tmp_path, content)


def test_functions_that_grow_come_to_a_limit(tmp_path):
    """Each function doubles the size of the previous one, so that lagc reports a system that is too large."""
    text = "".join(f'<function name="f{i}" arguments="s">f{i + 1}(s + 1) + f{i + 1}(2*s)</function>' for i in range(60))
    assert "the system is too large" in complaints(tmp_path, text + '<function name="f60" arguments="s">s</function><output name="p">f0(l)</output>')


def test_a_start_value_calls_functions_further_up(tmp_path):
    (tmp_path / "system.xml").write_text("""<system name="X"><constant name="N" value="3"/><function name="f" arguments="s">N*s^2</function>
<constant name="M" value="f(2)"/><parameter name="p" start="f(M)"/><output name="o">p</output></system>""")
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    assert f'start="{3 * 12**2}"' in (tmp_path / "out" / "modelDescription.xml").read_text()
