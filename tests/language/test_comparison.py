"""The figures in fmu/COMPARISON.md are the measured ones."""

import re

from fmu import ROOT

NUMBER = r"(?<![\w.])\d+(?:[.,]\d+)*(?:e-?\d+)?"


def test_every_figure_is_one_that_was_measured():
    measured = set(re.findall(NUMBER, (ROOT / "README.md").read_text() + (ROOT / "scripts" / "README.md").read_text()))
    page = (ROOT / "fmu" / "COMPARISON.md").read_text()
    figures = re.findall(NUMBER, page[page.index("## Measured") :])
    assert len(figures) > 40 and set(figures) <= measured, set(figures) - measured
