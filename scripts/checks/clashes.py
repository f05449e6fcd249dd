"""
Find names of the runtime that clash when an FMU's source is one file.

For each version of FMI all sources that one file may contain are compiled as one unit, with the names that lagc generates. Prints the compiler's
messages; no output means no clash.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RUNTIME = ROOT / "src" / "runtime"


def sources(version):
    """Return the runtime sources that one file may contain; sources that need SUNDIALS are never in it."""
    left_out = {"sundials", "fmi2", "fmi3"} - {f"fmi{version}"}
    return sorted(path for path in RUNTIME.rglob("*.c") if path.parent.name not in left_out)


def generated_names():
    """Return the names at file scope in system.c: static objects and arrays that lagc writes, and functions."""
    folder = ROOT / "src" / "compiler" / "write"
    texts = "".join(path.read_text() for path in folder.glob("*.c"))
    found = re.findall(r'"static [^"=(%]*?\b(\w+)(?:\[|\(| = )', texts) + re.findall(r'(?:write_array\(file, |ARRAY_FIELD\([^"]*)"(\w+)"', texts)
    found += re.findall(r'"([a-z]+(?:_[a-z]+)*)"', (ROOT / "src" / "compiler" / "program" / "generated_functions.c").read_text())
    return sorted(set(found) - {"double", "int", "void"})


def unit(version):
    lines = [f'#include "{path}"' for path in sources(version)]
    return "\n".join([*lines, *(f"static const int {name} = 0;" for name in generated_names()), ""])


def complaints(text):
    """Return the messages of gcc for a C source."""
    words = ["gcc", "-std=c11", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-Wno-unused", "-x", "c", "-"]
    headers = [f"-I{folder}" for folder in (ROOT / "include", RUNTIME)]
    return subprocess.run([*words, *headers], input=text, capture_output=True, text=True).stderr


if __name__ == "__main__":
    found = "".join(complaints(unit(version)) for version in (2, 3))
    sys.exit(found or None)
