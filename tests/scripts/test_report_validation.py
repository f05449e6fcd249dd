"""The report's validation: each system has a source, references that are wrong are found, and its table is in the page."""

import numpy as np
import pytest

import fmu
from numerics import validation
from numerics.validation import HEADER, SERIES, cases, is_wrong, row_of

QUICK = {case.system: case for case in cases(True)}


def test_each_case_has_a_source_and_variables_of_its_fmu():
    found = cases(False)
    assert len({case.system for case in found}) >= 20
    for case in found:
        names = {variable.name for variable in fmu.description(case.system).modelVariables}
        assert case.source and {*case.compared, *case.starts} <= names, case.system
    assert all(case.source != SERIES for case in cases(True)), "the quick cases have closed forms or published values"


@pytest.mark.parametrize("name", ["SimplePendulum", "AndrewsSqueezer", "BouncingBall"])
def test_errors(name):
    """The error is within the tolerance, and a solution of another system is found to be wrong."""
    row = row_of(QUICK[name])
    assert row[0] == name and 0 < row[HEADER.index("largest error")] < row[HEADER.index("tolerance")]
    assert row[HEADER.index("time [µs]")] > 1 and not is_wrong(row)
    exact = QUICK[name].exact()
    assert is_wrong(row_of(QUICK[name]._replace(exact=lambda: np.asarray(exact) + 1e-3)))


def test_a_run_that_fails_is_wrong(monkeypatch):
    monkeypatch.setattr(validation, "step", lambda *words: None)
    assert is_wrong(row_of(QUICK["SimplePendulum"]))
