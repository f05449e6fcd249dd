"""The documentation page is well-formed, and the formulas that its script typesets agree with their text."""

import html
import math
import re
import xml.etree.ElementTree as ElementTree

import pytest

import fmu
from fmu import lagc
from typeset import check, shown


def page_of(folder):
    return folder / "documentation" / "index.html"


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The pages of all systems, as a browser shows them."""
    names = fmu.all_names()
    return dict(zip(names, shown([page_of(fmu.unpacked(name)) for name in names], tmp_path_factory.mktemp("shown")), strict=True))


@pytest.mark.parametrize("name", fmu.all_names())
def test_formulas_of_every_system(name, pages):
    """Very long formulas, and those with conditions of pieces, appear as text only."""
    texts = re.findall('<code(?: data-latex="[^"]*")?>(.*?)</code>', page_of(fmu.unpacked(name)).read_text(), re.S)
    short = [text for text in texts if len(html.unescape(text)) <= 3000 and " in line " not in text]
    assert check(pages[name]) == len(short) > 0
    assert 'class="step"' not in pages[name]  # each equation of the derivation is typeset


@pytest.mark.parametrize("name", fmu.all_names())
def test_the_page_without_scripts(name):
    """The page is well-formed XML, in which the equations are texts."""
    root = ElementTree.fromstring(page_of(fmu.unpacked(name)).read_text())
    assert all(" = " in equation.find("code").text for equation in root.iter("div")) and not list(root.iter("details"))[1:]


def test_typeset_forms(tmp_path):
    """Covers every form of an expression, and the parts that appear untypeset."""
    (tmp_path / "system.xml").write_text(
        """<system name="Forms"><input name="a"/><input name="b2"/><input name="theta[3]"/>
  <output name="u">-(a + 1)^2/(b2*(a - b2)) - 3/theta[3]</output><output name="v">a^-b2 - (a - (b2 - 1))*2</output>
  <output name="w">abs(a)*atan2(a, b2)/sqrt(1 + a^2)</output><output name="x">a^(b2^2)*max(a, -b2)*1e-7*(2.5e12 + a)</output>
</system>"""
    )
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    (page,) = shown([page_of(tmp_path / "out")], tmp_path)
    assert check(page) == 4 and "<msub><mi>θ</mi><mrow><mn>3</mn></mrow></msub>" in page and page.count("<details>") == 5  # one is of the scene


def test_forms_of_exponentials(tmp_path):
    """Expressions that are computed without overflow are shown as written."""
    formulas = ["2/(1 + exp(a - b))", "b*exp(a)/(1 + exp(a))", "3/cosh(a + b)^2", "log(1 + exp(-a))*b", "log(cosh(2*a))", "b/(1 + exp(-a)/4)"]
    values = {"a": 0.3, "b": 0.7}
    outputs = "".join(f'<output name="y{i}">{formula}</output>' for i, formula in enumerate(formulas))
    (tmp_path / "system.xml").write_text(f'<system name="Forms"><input name="a"/><input name="b"/>{outputs}</system>')
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    (page,) = shown([page_of(tmp_path / "out")], tmp_path)
    assert check(page) == len(formulas)
    texts = dict(html.unescape(text).split(" = ") for text in re.findall('<code data-latex="[^"]*">(y.*?)</code>', page))
    for i, formula in enumerate(formulas):
        evaluated = (eval(text.replace("^", "**"), {"exp": math.exp, "cosh": math.cosh, "log": math.log, **values}) for text in (formula, texts[f"y{i}"]))
        assert math.isclose(*evaluated, rel_tol=1e-14), (formula, texts[f"y{i}"])


def test_a_formula_that_is_cut_off_is_shown_as_text(tmp_path):
    terms = " + ".join(f"sin({i}*a)*cos({i}*a)" for i in range(1500))
    (tmp_path / "system.xml").write_text(f'<system name="Long"><input name="a"/><output name="y">{terms}</output></system>')
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    page = page_of(tmp_path / "out").read_text()
    ElementTree.fromstring(page)
    assert "...</code>" in page


def test_a_law_of_energy_ends_at_impacts():
    reports = {name: "This holds between events" in page_of(fmu.unpacked(name)).read_text() for name in ("BouncingBall", "SimplePendulum")}
    assert reports == {"BouncingBall": True, "SimplePendulum": False}
