"""Random sequences of calls (random_calls.py) on FMUs built with AddressSanitizer and UndefinedBehaviorSanitizer."""

import os
import re
import subprocess
import sys

from fmu import BUILD, ROOT

CALLS = 20_000


def test_random_calls_under_sanitizers():
    library = subprocess.run(["gcc", "-print-file-name=libasan.so"], capture_output=True, text=True).stdout.strip()
    environment = os.environ | {
        "FMU_BUILD": str(BUILD / "sanitized"),
        "LD_PRELOAD": library,
        # Python itself leaves memory at its end; a leak counts where an FMU is on the stack of its allocation.
        "ASAN_OPTIONS": "detect_leaks=1:malloc_context_size=12:fast_unwind_on_malloc=1",
        "LSAN_OPTIONS": "exitcode=0:max_leaks=0",
        "UBSAN_OPTIONS": "print_stacktrace=1",
    }
    words = [sys.executable, ROOT / "tests" / "random_calls.py", str(CALLS)]
    result = subprocess.run(words, capture_output=True, text=True, env=environment, timeout=1200)
    text = result.stdout + result.stderr
    made = re.search(r"(\d+) calls", result.stdout)
    assert made and int(made.group(1)) >= CALLS, text[-5000:]
    assert "runtime error" not in text and "ERROR: AddressSanitizer" not in text, text[-5000:]
    leaks = [leak for leak in text.split("\n\n") if " leak of " in leak and "/binaries/linux64/" in leak]
    assert not leaks, leaks[0]
