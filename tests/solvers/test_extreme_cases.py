"""Stiff and extreme cases: accurate within a bound on the error and the work, or a clear error message."""

import pytest

from extreme_cases import CASES, co_simulate, exchange_model


@pytest.mark.long
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_co_simulation(case):
    outcome = co_simulate(case)
    assert outcome.verdict == ("right" if case.rejected is None else "rejected"), outcome


@pytest.mark.parametrize("case", [case for case in CASES if case.exchange is not None], ids=lambda case: case.name)
def test_model_exchange(case):
    outcome = exchange_model(case)
    assert outcome.verdict == ("right" if case.exchange else "rejected"), outcome
