"""
Random calls, valid ones (random_calls.py) and attacks (c/attack.c), on FMUs built with AddressSanitizer and UBSan. The environment
variables RANDOM_CALLS and RANDOM_SEED set their number and seed.
"""

import os
import re
import subprocess
import sys

import pytest

import fmu
from fmu import BUILD, ROOT

pytestmark = pytest.mark.release

CALLS = int(os.environ.get("RANDOM_CALLS", "20000"))
SEED = os.environ.get("RANDOM_SEED", "1")


def test_random_calls_under_sanitizers():
    library = subprocess.run(["gcc", "-print-file-name=libasan.so"], capture_output=True, text=True).stdout.strip()
    environment = os.environ | {
        "PYTHONPATH": str(ROOT / "tests" / "support"),
        "FMU_BUILD": str(BUILD / "sanitized"),
        "LD_PRELOAD": library,
        # Python itself leaks memory at its end; a leak counts if an FMU is on the stack of its allocation.
        "ASAN_OPTIONS": "detect_leaks=1:malloc_context_size=12:fast_unwind_on_malloc=1",
        "LSAN_OPTIONS": "exitcode=0:max_leaks=0",
        "UBSAN_OPTIONS": "print_stacktrace=1",
    }
    calls = CALLS // 2  # each takes a hundred times as long as an attack
    words = [sys.executable, ROOT / "tests" / "fmi" / "random_calls.py", str(calls), SEED]
    result = subprocess.run(words, capture_output=True, text=True, env=environment, timeout=1200 + CALLS // 20)
    text = result.stdout + result.stderr
    made = re.search(r"(\d+) calls", result.stdout)
    assert made and int(made.group(1)) >= calls, text[-5000:]
    assert "runtime error" not in text and "ERROR: AddressSanitizer" not in text, text[-5000:]
    leaks = [leak for leak in text.split("\n\n") if " leak of " in leak and "/binaries/linux64/" in leak]
    assert not leaks, leaks[0]


@pytest.mark.parametrize("name", fmu.small_names())
def test_attack_under_sanitizers(name):
    """NULL, unknown references, extreme numbers, wrong states, failing allocations, damaged and forged saved states cause no fault."""
    build, description = BUILD / "sanitized", fmu.description(name)
    library = build / "systems" / name / "binaries" / "linux64" / f"{name}.so"
    counts = [len(description.modelVariables), len(fmu.states_of(name)), CALLS, SEED]
    words = [build / "bin" / "attack", library, description.guid, *map(str, counts)]
    environment = os.environ | {"UBSAN_OPTIONS": "print_stacktrace=1"}
    result = subprocess.run(words, capture_output=True, text=True, env=environment, timeout=300 + CALLS // 100)
    assert result.returncode == 0, result.stderr
    steps, restored = map(int, re.findall(r"\d+", result.stdout))
    assert steps > CALLS / 10 and restored > CALLS / 50
