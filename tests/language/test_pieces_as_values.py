"""Definitions with pieces in <set>, on the FMU's page and in linearizations; messages of states, conditions, lists and random numbers."""

import html
import re

import pytest

import fmu
from fmu import DISCARD, ERROR, lagc

# x = time. The definition is used only by a sample, and only by an event.
ROUNDED = """<system name="Rounded{name}"><state name="x" rate="1"/><mode name="n"/>
<define name="r">round(3*x) + {more}</define><define name="twice">2*r</define><output name="o">x</output>
{set}<set mode="n">twice</set>{end}</system>"""
PERIODIC = ('<sample every="0.25">', "</sample>")
ONCE = ('<event when="x - 0.6" direction="rising">', "</event>")


def compiled(tmp_path, content, name="X"):
    (tmp_path / name).mkdir(exist_ok=True)
    (tmp_path / name / "system.xml").write_text(content)
    return lagc(f"{name}/system.xml", "-o", f"{name}/out", cwd=tmp_path)


def test_values_of_definitions_in_set_make_no_events(open_fmu):
    systems = {
        "Rounded0": ROUNDED.format(name=0, more="0", set=PERIODIC[0], end=PERIODIC[1]),
        "Rounded1": ROUNDED.format(name=1, more="max(0, x - 0.3)", set=PERIODIC[0], end=PERIODIC[1]),
        "Rounded2": ROUNDED.format(name=2, more="0", set=ONCE[0], end=ONCE[1]),
    }
    fmu.build_systems("pieces-as-values", systems)
    for name, events, value in [("Rounded0", 4, 6), ("Rounded1", 4, 6 + 2 * 0.7), ("Rounded2", 1, 4)]:
        instance = open_fmu(name).initialize()
        instance.run(1.0, 0.1, "n")
        counted = instance.fmu.getInteger(instance.vr("events"))
        assert (instance.get("n"), counted) == (pytest.approx(value, abs=1e-12), [events]), name


def test_definitions_on_the_page(tmp_path):
    content = '<state name="x" rate="d"/><mode name="open" start="1"/><parameter name="c" start="1"/><define name="d">min(x, c) + floor(x) - if(x &gt; c and open, abs(x), 2)</define><define name="e">if(open, 1, 3)</define><output name="o">e</output>'
    assert compiled(tmp_path, f'<system name="X">{content}</system>').returncode == 0
    page = html.unescape(re.sub("<[^>]*>", "", (tmp_path / "X" / "out" / "documentation" / "index.html").read_text()))
    assert "in line" not in page
    assert re.search(r"d = .*floor\(x\)", page) and "min(x, c)" in page and "e = if(open > 0, 1, 3)" in page, page


@pytest.mark.parametrize("force, slope", [("-k*x*n", -6), ("-n*n*x", -9), ("-sin(n*x)", -3), ("if(n, -x, 0)", -1), ("-x*(n - 1)", -2)])
def test_linearizations_keep_modes_in_products(tmp_path, force, slope):
    (tmp_path / "system.xml").write_text(f'<system name="X"><parameter name="k" start="2"/><coordinate name="x" velocity="v"/><mode name="n" start="3"/><particle mass="1" x="x"/><force coordinate="x">{force}</force><event when="x - 1" direction="rising"><set mode="n">2</set></event></system>')
    result = lagc("--linearize", "system.xml", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    last = result.stdout.rsplit("A =", 1)[1].split("\n")[2]
    assert last.strip() == f"[{slope}, 0]"


@pytest.mark.parametrize("content, message", [
    ('<mode name="n"/><event when="time == 2"><set mode="n">1</set></event>', "when: found '=='; write >= for what comes to a value, as in time >= 2"),
    ('<mode name="n"/><event when="x = 2"><set mode="n">1</set></event>', "when: found '='; write >= for what comes to a value"),
    ('<output name="o">if(x != 2, 1, 0)</output>', "found '!='; write >= for what comes to a value, as in time >= 2, and n > 1.5 and n < 2.5 for a whole number n that is 2"),
    ('<constant name="c" values="1 2"/><output name="o">c[3]</output>', "unknown name 'c[3]'; expected c[1], ..., c[2]"),
    ('<for index="i" from="0" to="2"><define name="d[i]">x</define></for><output name="o">d[3]</output>', "unknown name 'd[3]'; expected d[0], ..., d[2]"),
    ('<output name="o">foo(x)</output>', "min, max, sqrt, floor, ceil, round, mod, if, der, diff, sum, integral, uniform, gauss, distance, dot or norm"),
    ('<output name="o">int(x)</output>', "unknown function 'int'; write sign(x)*floor(abs(x)) for the whole part, integral(s, a, b, expression) for an integral over s"),
    ('<output name="o">gauss(1.5, 2)</output>', "the seed of gauss is 1.5; expected a whole number, such as a parameter of type="),
    ('<parameter name="s" start="0.5"/><output name="o">uniform(s, 2)</output>', "the seed of uniform is 0.5; expected a whole number"),
    ('<output name="o">gauss(1, 2.5)</output>', "the number k of gauss is 2.5; expected a whole number"),
    ('<event when="q"><set coordinate="w">0</set></event>', '<set coordinate="w">: \'w\' is a velocity; expected <set velocity="w">'),
    ('<event when="q"><set mode="x">0</set></event>', '<set mode="x">: \'x\' is a state; expected <set state="x">'),
    ('<event when="q"><set state="zz">0</set></event>', '<set state="zz">: there is no state of this name'),
    ('<mode name="n"/><event when="0"><set mode="n">1</set></event>', 'when="0" never changes'),
    ('<mode name="n"/><event when="2 &gt; 1"><set mode="n">1</set></event>', 'when="2 > 1" never changes'),
])  # fmt: skip
def test_messages(tmp_path, content, message):
    system = f'<system name="X"><state name="x" rate="1"/><coordinate name="q" velocity="w"/><particle mass="1" x="q"/>\n{content}</system>'
    result = compiled(tmp_path, system)
    assert result.returncode == 1 and "system.xml:2: " in result.stderr and message in result.stderr, result.stderr


def test_a_rate_without_a_value_is_named(open_fmu):
    systems = {
        "RateAlone": '<system name="RateAlone"><parameter name="p" start="1"/><state name="y" rate="1"/><state name="z" rate="log(p) - z"/></system>',
        "RateBeside": '<system name="RateBeside"><parameter name="p" start="1"/><coordinate name="x" velocity="v" start="1"/><particle mass="1" x="x"/><state name="y" rate="x"/><state name="z" rate="1/(z + p)"/></system>',
    }
    fmu.build_systems("rates-without-values", systems)
    for name in systems:
        with (instance := open_fmu(name)).fails(ERROR, "time 0: the rate of 'z' is not finite, as when something is divided by 0"):
            instance.initialize({"p": 0})
        assert any("the rate of 'z' cannot be computed at the start values" in text for _, _, text in instance.messages)


def test_a_relay_is_not_friction(open_fmu):
    systems = {
        "Relay": '<system name="Relay"><state name="x" start="1" rate="-sign(x) + 0.3"/></system>',
        "RelayBeside": '<system name="RelayBeside"><coordinate name="q" velocity="w"/><particle mass="1" x="q"/><state name="x" start="1" rate="-sign(x) + 0.3"/></system>',
    }
    fmu.build_systems("relays", systems)
    for name, cause in [("Relay", "as with a relay without hysteresis; expected a <mode>"), ("RelayBeside", "expected <friction> in place of sign, or of a <state> a <mode>")]:
        instance = open_fmu(name).initialize()
        with instance.fails(DISCARD, f"chatters: .* {cause} that two events set at different values"):
            instance.step(2.0)
