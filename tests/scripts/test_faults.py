"""Each entry in the list of scripts/checks/faults fits the code."""

import sys

import pytest

from fmu import ROOT

sys.path.append(str(ROOT / "tests" / "faults"))
from faults import FAULTS
from locations import Fault, find


def test_faults_can_be_planted():
    problems = []
    for fault in FAULTS:
        kind, test, *_ = fault.test
        if not list((ROOT / "tests").glob(f"compiler/{test}.c" if kind == "ctest" else f"*/{test}.py")):
            problems.append(f"there is no test {test}")
        try:
            place = find(fault)
            text = (ROOT / place.file).read_text()
            if "".join(text[place.start : place.end].split()) == "".join(fault.wrong.split()):
                problems.append(f"{fault.right!r} is no fault")
        except LookupError as error:
            problems.append(str(error))
    assert not problems, "\n".join(problems)


@pytest.mark.parametrize("text, function, message", [("no such words", None, "stands 0 times, in no file"),
                                                     ("return true;", None, "stands [0-9]+ times, in modelDescription"),
                                                     ("evaluate_prepare(instance);", "log_error", "stands 0 times")])  # fmt: skip
def test_ambiguous_locations_are_errors(text, function, message):
    with pytest.raises(LookupError, match=message):
        find(Fault(text, "", ("ctest", "test_graph"), function))
