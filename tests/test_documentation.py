"""The documentation page is well-formed, and its typeset formulas say what their text says."""

import html
import random
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import fmu
from fmu import lagc

MATHML = "{http://www.w3.org/1998/Math/MathML}"
GREEK = dict(zip("αβγδεζηθκλμνξπρστφχψωΔΘΦΨΩ",
                 "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega "
                 "Delta Theta Phi Psi Omega".split()))  # fmt: skip
FUNCTIONS = {name: getattr(np, name) for name in "sin cos tan sinh cosh tanh exp log sqrt abs sign".split()}
FUNCTIONS |= dict(asin=np.arcsin, acos=np.arccos, atan=np.arctan, asinh=np.arcsinh, acosh=np.arccosh, atanh=np.arctanh,
                  atan2=np.arctan2, min=min, max=max, erf=lambda x: x, gate=lambda opener, value, other: value if opener > 0 else other)  # fmt: skip


def infix(element):
    """What the element means, as an expression in Python."""
    tag, parts = element.tag.removeprefix(MATHML), [infix(child) for child in element]
    if tag == "mfrac":
        return f"(({parts[0]})/({parts[1]}))"
    if tag == "msup":
        return f"(({parts[0]})**({parts[1]}))"
    if tag == "msub":
        return f"{parts[0]}_{parts[1]}"
    if tag == "msqrt":
        return f"sqrt({''.join(parts)})"
    if tag == "mover":
        return f"der_{parts[0]}"
    if tag == "mrow" and parts and parts[0] == parts[-1] == "|":
        return f"abs({''.join(parts[1:-1])})"
    return {"⋅": "*", "−": "-", "\u2061": ""}.get(element.text, GREEK.get(element.text, element.text or "")) + "".join(parts)


def plain(text):
    """The text in the names that infix() gives."""
    text = re.sub(r"\b([A-Za-z_]+?)\[?(\d+)\]?(?![\w.(\[]|\.\d)", lambda m: m[0] if re.fullmatch("e|E", m[1]) else f"{m[1]}_{m[2]}", text)
    for _ in range(2):  # der(der(zb))
        text = re.sub(r"der\(([\w.]+)\)", r"der_\1", text)
    return text.replace("^", "**")


def check(page):
    root, count = ElementTree.fromstring(page), 0
    generator = random.Random(1)
    for parent in root.iter():
        for paragraph, details in zip(list(parent), list(parent)[1:]):
            if paragraph.get("class") != "formula":
                continue
            indexed = lambda side: re.sub(r"\[(\d+)\]\.", r"_\1.", side)  # loop[1].force, which stays a word
            typeset = indexed("".join(infix(math) for math in paragraph)).split("=")
            text = plain(indexed(details.find("code").text)).split(" = ")
            names = {name: generator.uniform(0.1, 0.9) for name in set(re.findall(r"[A-Za-z_][\w.]*", " ".join(text)))}
            text = [re.sub(r"\bif\((.*?) > 0, ", r"gate(\1, ", side) for side in text]
            typeset = [re.sub(r"\bif\((.*?)>0,", r"gate(\1,", side) for side in typeset]
            dots = lambda side: re.sub(r"(?<=[A-Za-z_])(\w*)\.(?=[A-Za-z])", r"\1__", side)
            values = {dots(name): value for name, value in names.items()}
            for ours, theirs in zip(typeset, text, strict=True):
                with np.errstate(all="ignore"):
                    both = [eval(dots(side), {}, {**values, **FUNCTIONS}) for side in (ours, theirs)]
                assert np.isclose(*both, rtol=1e-9, equal_nan=True), (ours, theirs)
            count += 1
    return count


@pytest.mark.parametrize("name", fmu.all_names())
def test_formulas_of_every_system(name):
    page = (fmu.unpacked(name) / "documentation" / "index.html").read_text()
    # Very long ones are there as text alone.
    short = [text for text in re.findall("<code>(.*?)</code>", page, re.S) if len(html.unescape(text)) <= 3000]
    assert check(page) == len(short) > 0


def test_typeset_forms(tmp_path):
    """Every form of an expression, and what is not typeset but shown as it is."""
    (tmp_path / "system.xml").write_text(
        """<system name="Forms"><input name="a"/><input name="b2"/><input name="theta[3]"/>
  <output name="u">-(a + 1)^2/(b2*(a - b2)) - 3/theta[3]</output><output name="v">a^-b2 - (a - (b2 - 1))*2</output>
  <output name="w">abs(a)*atan2(a, b2)/sqrt(1 + a^2)</output><output name="x">a^(b2^2)*max(a, -b2)*1e-7*(2.5e12 + a)</output>
</system>"""
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    page = (tmp_path / "out" / "documentation" / "index.html").read_text()
    assert check(page) == 4 and "<msub><mi>θ</mi><mn>3</mn></msub>" in page and page.count("<details>") == 4


def test_a_formula_that_is_cut_off_is_shown_as_text(tmp_path):
    terms = " + ".join(f"sin({i}*a)*cos({i}*a)" for i in range(1500))
    (tmp_path / "system.xml").write_text(f'<system name="Long"><input name="a"/><output name="y">{terms}</output></system>')
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    page = (tmp_path / "out" / "documentation" / "index.html").read_text()
    ElementTree.fromstring(page)
    assert "...</code>" in page
