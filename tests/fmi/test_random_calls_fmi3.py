"""
Random calls of FMI 3.0 (random_calls_fmi3.py): calls that the tables of the standard allow succeed; forbidden ones fail with a message.
"""

import os
import subprocess
import sys

import pytest

import fmu
from fmu import ROOT

CALLS, SEED = os.environ.get("RANDOM_CALLS", "1000"), os.environ.get("RANDOM_SEED", "1")


@pytest.mark.parametrize("name", fmu.small_names())
def test_random_calls(name):
    words = [sys.executable, ROOT / "tests" / "fmi" / "random_calls_fmi3.py", CALLS, SEED, name]
    environment = os.environ | {"PYTHONPATH": str(ROOT / "tests" / "support")}
    result = subprocess.run(words, capture_output=True, text=True, env=environment)
    assert result.returncode == 0 and "calls of" in result.stdout, result.stderr[-3000:]
