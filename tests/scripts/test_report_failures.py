"""The report completes on any machine: each failure leaves a sentence, and all other parts appear."""

import csv

import pytest

from numerics import __main__ as report
from numerics.__main__ import ReportSection
from numerics.mechanisms import comparison as mechanisms
from numerics.mechanisms.problems import PROBLEMS as MECHANISMS
from numerics.stiff import comparison as stiff
from numerics.stiff import problems as stiff_problems
from numerics.stiff.comparison import Sample
from numerics.stiff.problems import StiffProblem
from numerics.work_precision import comparison as work_precision

pytestmark = pytest.mark.release


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    monkeypatch.setattr(report, "FOLDER", tmp_path)
    return tmp_path


def fail(*arguments, **names):
    raise ArithmeticError("it did not come to the end")


def test_a_section_that_fails(folder, monkeypatch, capsys):
    """The page has the sections before and after the failing one, and a warning; the exit status is 0."""
    monkeypatch.setattr(report, "SECTIONS", [("First", lambda *words: ReportSection(["fine"], "<p>content one</p>")), ("Second", fail),
                                             ("Third", lambda *words: ReportSection([("levels", ["item"])], "<p>content three</p>"))])  # fmt: skip
    assert report.main(["--quick"]) == 0
    page = (folder / "index.html").read_text()
    assert all(text in page for text in ("content one", "content three", "<li>item</li>", "the section &#x27;Second&#x27;: it did not come to the end"))
    assert "scripts/report: Left out, the section 'Second'" in capsys.readouterr().err


def test_the_page_grows(folder, monkeypatch):
    """The page on disk has each section before the next one starts."""
    pages = []
    monkeypatch.setattr(report, "SECTIONS", [("First", lambda *words: ReportSection([], "<p>content one</p>")),
                                             ("Second", lambda *words: pages.append((folder / "index.html").read_text()) or ReportSection([], ""))])  # fmt: skip
    report.main(["--quick"])
    assert "content one" in pages[0]


def test_wrong_results(folder, monkeypatch, capsys):
    monkeypatch.setattr(report, "SECTIONS", [("Cases", lambda *words: ReportSection([], "", 2))])
    assert report.main([]) == 1
    assert "2 results are wrong" in capsys.readouterr().err


def small(name, end=1.0):
    return StiffProblem(name, name, end, 100)


def test_a_stiff_problem_without_a_reference(folder, monkeypatch, capsys):
    """Its methods are not run; the other problem has its plot, its row and its samples."""
    asked = []

    def right_states(problem, way):
        if problem.name == "Lost":
            fail()
        return None, "closed form", 0.0

    def sample(problem, way, method, tolerance, timeout):
        asked.append(problem.name)
        return Sample(problem.name, way, method, tolerance, 1.0, tolerance)

    monkeypatch.setattr(stiff, "QUICK", [small("Lost"), small("Found")])
    monkeypatch.setattr(stiff, "right_states", right_states)
    monkeypatch.setattr(stiff, "sample", sample)
    monkeypatch.setattr(stiff, "sample_peers", lambda problem, quick: [])
    _, content, wrong, _ = report.stiff_section(True, lambda what: None)
    assert "<p>Left out, Lost: it did not come to the end.</p>" in content and "<td>Found</td>" in content and wrong == 0
    assert content.count("<svg") == 2 and set(asked) == {"Found"}  # with one legend
    with open(folder / "stiff.csv") as file:
        assert {row["problem"] for row in csv.DictReader(file)} == {"Found"}


def test_methods_that_give_up(folder, monkeypatch):
    """If all methods give up, the table is empty."""
    monkeypatch.setattr(stiff, "QUICK", [small("P")])
    monkeypatch.setattr(stiff, "right_states", lambda problem, way: (None, "closed form", 0.0))
    monkeypatch.setattr(stiff, "sample", lambda *words: None)
    monkeypatch.setattr(stiff, "sample_peers", lambda problem, quick: [])
    assert report.stiff_section(True, lambda what: None).wrong == 0
    assert (folder / "stiff.csv").read_text().startswith("problem,way,method")


def test_a_solver_that_does_not_come_to_the_end_of_a_reference(monkeypatch, tmp_path):
    monkeypatch.setattr(stiff_problems, "REFERENCES", tmp_path)
    monkeypatch.setattr(stiff_problems, "step", lambda *words, **names: None)
    monkeypatch.setattr(StiffProblem, "all_values", {})
    with pytest.raises(ArithmeticError, match="radau did not come to the end of its reference, at a tolerance of 1e-11, within 200 s"):
        stiff_problems.right_states(small("Rope"), "one step")


def test_a_mechanism_that_fails(monkeypatch):
    monkeypatch.setattr(mechanisms, "PROBLEMS", MECHANISMS[:1])
    monkeypatch.setattr(mechanisms, "runners_of", fail)
    monkeypatch.setattr(report.accelerations, "rows", fail)
    content = report.mechanisms_section(True, lambda what: None).content
    assert "Left out, pendulum in x and y (A01)" in content and "Left out, one evaluation of the accelerations of a robot: it did not" in content


def test_peers_and_references_that_fail(monkeypatch):
    """A missing or crashing peer counts as giving up; a system without a reference is omitted."""
    tasks = [(work_precision.sample_peer, (name, "Peer", 1e-4)) for name in ("SimplePendulum", "Lost")]
    monkeypatch.setattr(work_precision, "PEERS", {"Peer": (fail, [], None)})
    monkeypatch.setattr(work_precision, "reference", lambda name: fail() if name == "Lost" else None)
    samples, failures, sentences = work_precision.collect(tasks, lambda what: None)
    assert samples == [] and failures == {"Peer": 1} and sentences == ["Left out, Lost, which has no reference: it did not come to the end."]
