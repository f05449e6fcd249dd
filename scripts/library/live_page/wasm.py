"""Compile an FMU's source to WebAssembly with zig, together with driver.c, the functions that a page needs beside those of FMI."""

import hashlib
import importlib.metadata
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from ..problem import Problem
from ..whole_files import write_whole

DRIVER = Path(__file__).resolve().parent / "driver.c"
EXPORTS = ["Reset", "SetupExperiment", "EnterInitializationMode", "ExitInitializationMode", "DoStep", "GetFMUstate", "SetFMUstate",
           "GetReal", "GetInteger", "GetDirectionalDerivative", "SetReal", "SetInteger", "SetBoolean"]  # fmt: skip
# As in scripts/package/cross.py: no fused multiply-add, no unused functions.
FLAGS = ["-target", "wasm32-wasi", "-mexec-model=reactor", "-O2", "-s", "-std=c11", "-fvisibility=hidden", "-ffp-contract=off",
         "-ffunction-sections", "-fdata-sections", "-fno-sanitize=all", "-Wl,--gc-sections"]  # fmt: skip
MOST_KEPT = 200  # modules in a cache, of 60 to 300 kB each


def compile_to_wasm(source):
    """Return the bytes of a module without imports, compiled from an FMU's C source of FMI 2.0; raise Problem if that fails."""
    source = Path(source).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        output = Path(scratch) / "fmu.wasm"
        words = [sys.executable, "-m", "ziglang", "cc", *FLAGS, f'-DFMU_SOURCE="{source}"', str(DRIVER), "-o", str(output)]
        words += [f"-Wl,--export=fmi2{name}" for name in EXPORTS]
        result = subprocess.run(words, env={"ZIG_LOCAL_CACHE_DIR": scratch, **os.environ}, capture_output=True, text=True)
        if result.returncode != 0:
            raise Problem(f"{source.name} cannot be compiled to WebAssembly: {result.stderr.strip()}")
        return output.read_bytes()


def cached_wasm(source, cache):
    """Do the same as compile_to_wasm(), and keep modules in the folder `cache`, by a hash of all that they are compiled from; None keeps none."""
    if cache is None:
        return compile_to_wasm(source)
    words = [*FLAGS, *EXPORTS, importlib.metadata.version("ziglang")]
    key = hashlib.sha256(b"\0".join([Path(source).read_bytes(), DRIVER.read_bytes(), *(word.encode() for word in words)]))
    kept = Path(cache) / f"{key.hexdigest()}.wasm"
    if not kept.exists():
        write_whole(kept, compile_to_wasm(source))
        for old in sorted(kept.parent.glob("*.wasm"), key=lambda file: file.stat().st_mtime)[:-MOST_KEPT]:
            old.unlink(missing_ok=True)
    return kept.read_bytes()
