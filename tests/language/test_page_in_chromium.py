"""Layout of an FMU's page in a browser: everything is visible at desktop and phone widths."""

import re
import subprocess

import pytest

import fmu
from chromium import look_at


@pytest.fixture(scope="module")
def pages():
    return {name: fmu.unpacked(name) / "documentation" / "index.html" for name in fmu.small_names()}


def test_all_is_seen(pages, tmp_path):
    found = look_at(list(pages.values()), tmp_path)
    complaints = {(width, list(pages)[i]): lines[:5] for (width, i), lines in found.items() if lines}
    assert not complaints


def test_nothing_is_loaded(pages):
    """Each page is self-contained: it refers to nothing outside itself."""
    for name, page in pages.items():
        references = re.findall(r'\b(?:src|href)="([^"]*)"|url\(([^)]*)\)', page.read_text())
        assert all(reference.startswith("#") for pair in references for reference in pair if reference), name


def test_the_search(pages, tmp_path):
    """In DoublePendulum two states are angles; the upper rod is named in one of them and in its length."""
    rows = """view => ["", "angle state", "UPPER ROD", "nothing like that"].map(words => {
      const search = view.document.getElementById("search");
      search.value = words;
      search.dispatchEvent(new view.Event("input"));
      const rows = [...view.document.querySelectorAll("#variables tr")].slice(1);
      return rows.filter(row => row.offsetHeight > 0).map(row => row.cells[1].textContent);
    })"""
    ((every, states, upper, none),) = look_at([pages["DoublePendulum"]], tmp_path, [1200], rows).values()
    assert len(every) == len(fmu.description("DoublePendulum").modelVariables)
    assert states == ["theta1", "theta2"] and upper == ["theta1", "l1"] and none == []


def test_the_contents(pages, tmp_path):
    """The table of contents has every heading, and each entry leads to its heading."""
    script = """view => [[...view.document.querySelectorAll("nav a")].map(link => view.document.querySelector(link.hash).textContent),
      [...view.document.querySelectorAll("h2")].map(heading => heading.textContent)]"""
    for contents, headings in look_at(list(pages.values()), tmp_path, [1200], script).values():
        assert contents == headings and len(headings) > 2


LONG = """<system name="Wide">
  <parameter name="aParameterWithANameThatNobodyWouldLikeToTypeMoreThanOnceOrTwiceInALifeTimeOfSystems" start="1"/>
  <parameter name="k" start="1"/><input name="alpha_start"/>
  <coordinate name="thetaCrank" velocity="omegaCrank"/>
  <kinetic>omegaCrank^2/2</kinetic>
  <output name="power">(SUM)^(2*k + sin(k)*cos(k)*exp(k)*alpha_start*thetaCrank*omegaCrank)</output>
  <output name="ratio">(SUM)/(k + (SUM)^2)</output>
  <output name="root">sqrt(SUM)*abs(SUM)*atan2(SUM, k + SUM)</output>
  <output name="chosen">if(SUM > 0, SUM, k)</output>
  <output name="name">aParameterWithANameThatNobodyWouldLikeToTypeMoreThanOnceOrTwiceInALifeTimeOfSystems*k</output>
</system>"""


def test_wide_formulas_of_every_form(tmp_path):
    """Powers, quotients, roots and arguments wider than a phone are broken into lines."""
    terms = " + ".join(f"sin(thetaCrank + {i}*k)" for i in range(1, 8))
    (tmp_path / "system.xml").write_text(LONG.replace("SUM > 0", "SUM &gt; 0").replace("SUM", terms))
    result = subprocess.run([fmu.LAGC, "system.xml", "-o", "out"], cwd=tmp_path, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, "")
    found = look_at([tmp_path / "out" / "documentation" / "index.html"], tmp_path)
    assert not any(found.values()), found
