"""The list of faults that scripts/faults plants fits the code."""

import sys

import pytest

from fmu import ROOT

sys.path.append(str(ROOT / "tests" / "faults"))
from faults import FAULTS


@pytest.mark.parametrize("place", range(len(FAULTS)))
def test_fault_can_be_planted(place):
    file, right, wrong, (kind, test, *_) = FAULTS[place]
    assert (ROOT / file).read_text().count(right) == 1 and right != wrong
    assert (ROOT / "tests" / (f"compiler/{test}.c" if kind == "ctest" else f"{test}.py")).exists()
