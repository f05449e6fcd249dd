"""Messages give the file and the line of the source: in attributes, texts, included files, and beyond line 65,535."""

import re

import fmpy
import pytest
from fmpy.fmi1 import FMICallException

import fmu
from fmu import build_systems, lagc

OSCILLATOR = '<system name="S">\n<coordinate name="x" velocity="v"/>\n<particle mass="1" x="x"/>\n{}\n</system>\n'
# HERE marks the start of the unknown name.
PLACES = {
    "attribute": '<parameter name="p"\n  description="a"\n  value="HERE"\n\n/>',
    "within an attribute": '<parameter name="p" value="1 +\n  2*\n  HERE\n"/>',
    "behind letters": '<parameter name="p" description="\u00e9 &lt; \u00e9\n" value="if(1 &gt; 0, \n 2*HERE, 0)"/>',
    "text": '<force\n  coordinate="x"\n>\n  1 +\n  HERE</force>',
    "behind a comment": '<force coordinate="x"><!-- a\n  b\n--> 1 +\n <!-- > --> HERE</force>',
    "behind CDATA": '<force coordinate="x"><![CDATA[1\n + ]]> 2\n + <![CDATA[\n HERE]]></force>',
    "behind an empty CDATA": '<force coordinate="x">1<![CDATA[]]></force>\n<force coordinate="x">\nHERE</force>',
    "behind a tag in quotes": "<output name='o' description='/> &gt; \"\na>'\n>HERE</output>",
    "condition": '<event\n when="x -\n HERE"><set\n velocity="v">1</set></event>',
    "of <set>": '<event\n when="x"><set\n velocity="v">\n HERE</set></event>',
    "mass": '<particle\n x="x"\n\n mass="HERE"/>',
    "rotation": '<frame name="f"><rotate\n axis="z"\n\n angle="HERE"/></frame>',
}


def line_of(text, word="HERE"):
    return text[: text.index(word)].count("\n") + 1


def errors_of(folder, text, name="Cart.xml", files={}, words=()):
    for path, content in {name: text, **files}.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(content.encode())
    return lagc(name, "-o", "out", *words, cwd=folder).stderr


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("before", ["", "<?xml version='1.0'?>\n<!-- <a>\n -->\n", "<!--" + 70000 * "\n" + "-->"])
@pytest.mark.parametrize("where", PLACES)
def test_unknown_names(where, before, ending, tmp_path):
    text = before + OSCILLATOR.format(PLACES[where])
    errors = errors_of(tmp_path, text.replace("\n", ending))
    assert errors.startswith(f"Cart.xml:{line_of(text)}: ") and "'HERE'" in errors, errors


@pytest.mark.parametrize("element, message", [
    ('<parameter name="p"\n\n HERE="1"/>', "<parameter> has no attribute 'HERE'"),
    ('<parameter name="p"\n type="HERE"\n unit="m"/>', "type=\"HERE\" of <parameter> is not known"),
    ('<HERE\n x="1"\n y="2"/>', "<HERE> is not an element of <system>"),
    ('<parameter name="p" start="1"/>\n\n HERE is a text\n', "the text 'HERE' stands in <system>"),
    ('<table name="t">\n 0 1\n <!-- \n -->\n 1 HERE\n</table>', "'1 HERE' is not a point"),
    ('<table name="t">\n 0 1 # &lt;\n\u00e9 HERE\n</table>', "'\u00e9 HERE' is not a point"),
])  # fmt: skip
def test_other_mistakes(element, message, tmp_path):
    text = OSCILLATOR.format(element)
    errors = errors_of(tmp_path, text)
    assert errors.startswith(f"Cart.xml:{line_of(text)}: ") and message in errors, errors


def test_units(tmp_path):
    text = '<system name="S"><coordinate name="x" velocity="v" unit="m"/>\n<parameter name="t" unit="s" start="1"/>\n<particle\n mass="1"\n x="t"\n/></system>'
    assert errors_of(tmp_path, text).startswith("Cart.xml:5: unit mismatch: x has the unit s, expected m")


AROUND = '<system name="{}">\n\n<include file="parts/cart.xml"\n as="cart"/></system>'
ORIGIN = " (included as 'cart' on line 3 of {}.xml)\n"


@pytest.mark.parametrize("inside, line, message", [
    ("<coordinate\n name='x'\n velocity='v'/>", 2, "the coordinate 'cart.x' has no inertia"),
    ("<coordinate name='x' velocity='v'/>\n<particle x='x' mass='1'/>\n\n<constraint name='c'>x*0 + 1</constraint>", 5, "cart.c"),
    ("<parameter name='m' start='-1'/><coordinate name='x' velocity='v'/>\n<particle\n x='x' mass='m'/>", 3, "the mass of"),
    ("<coordinate name='x' velocity='v'/><particle x='x' mass='1'/>\n<force coordinate='x'>\n\nlog(x)</force>", 5, "log(0)"),
])  # fmt: skip
def test_messages_after_reading(inside, line, message, tmp_path):
    """Messages about the equations, which appear after all files are read."""
    errors = errors_of(tmp_path, AROUND.format("Train"), "Train.xml", {"parts/cart.xml": f"<system name='P'>\n{inside}</system>"})
    lines = [said for said in errors.splitlines(True) if message in said]
    assert lines and all(said.startswith(f"parts/cart.xml:{line}: ") and said.endswith(ORIGIN.format("Train")) for said in lines), errors


DRY = """<system name="Dry">
<coordinate name="x" velocity="v"/>
<particle mass="1" x="x"/>
<force
  coordinate="x"
> 1 <!--
  --> - 3*
  sign(v - 0.2)</force>
</system>"""


def test_branches_name_the_own_file(tmp_path):
    errors_of(tmp_path, DRY, "Dry.xml")
    assert '"sign", "Dry.xml", 8, ' in (tmp_path / "out" / "system.c").read_text()
    (tmp_path / "deep").mkdir()
    errors_of(tmp_path, DRY, "deep/Dry.xml")
    assert '"sign", "Dry.xml", 8, ' in (tmp_path / "out" / "system.c").read_text()  # without the folder


def test_motions_name_the_included_file():
    build_systems("lines", {"DryTrain": AROUND.format("DryTrain")}, files={"DryTrain/parts/cart.xml": DRY})
    messages = []
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(fmu.archive("DryTrain"), stop_time=4, logger=lambda *words: messages.append(words[-1].decode()), fmi_call_logger=None)
    assert re.search(r"sign, line 8 of cart\.xml, chatters: on both sides of its jump", "".join(messages)), messages
