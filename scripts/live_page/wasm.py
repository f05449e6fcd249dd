"""An FMU's sources as WebAssembly, by zig, with what a page needs beside the functions of FMI."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from ..problem import Problem

DRIVER = Path(__file__).resolve().parent / "driver.c"
EXPORTS = ["Reset", "SetupExperiment", "EnterInitializationMode", "ExitInitializationMode", "DoStep", "GetFMUstate", "SetFMUstate",
           "GetReal", "SetReal", "SetInteger", "SetBoolean"]  # fmt: skip
# As scripts/cross.py for other platforms: no a*b + c in one operation, nothing that is not called.
FLAGS = ["-target", "wasm32-wasi", "-mexec-model=reactor", "-O2", "-s", "-std=c11", "-fvisibility=hidden", "-ffp-contract=off",
         "-ffunction-sections", "-fdata-sections", "-fno-sanitize=all", "-Wl,--gc-sections"]  # fmt: skip


def compile_to_wasm(source):
    """The bytes of a module without imports, of an FMU's one file of C (FMI 2.0)."""
    source = Path(source).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        output = Path(scratch) / "fmu.wasm"
        words = [sys.executable, "-m", "ziglang", "cc", *FLAGS, f'-DFMU_SOURCE="{source}"', str(DRIVER), "-o", str(output)]
        words += [f"-Wl,--export=fmi2{name}" for name in EXPORTS]
        result = subprocess.run(words, env={"ZIG_LOCAL_CACHE_DIR": scratch, **os.environ}, capture_output=True, text=True)
        if result.returncode != 0:
            raise Problem(f"{source.name} cannot be compiled to WebAssembly: {result.stderr.strip()}")
        return output.read_bytes()
