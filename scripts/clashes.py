"""
Names of the runtime that clash where an FMU's source is one file: all that can stand in one is compiled as one, for each version of
FMI, behind the names that lagc gives. Prints what the compiler says; no output where all is well.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUNTIME = ROOT / "src" / "runtime"


def sources(version):
    """What SUNDIALS is needed for is never in one file."""
    left_out = {"sundials", "fmi2", "fmi3"} - {f"fmi{version}"}
    return sorted(path for path in RUNTIME.rglob("*.c") if path.parent.name not in left_out)


def generated_names():
    """Of what may stand outside of functions in system.c: what lagc writes as static, alone or as a list of numbers, and functions."""
    folder = ROOT / "src" / "compiler" / "write"
    texts = "".join(path.read_text() for path in folder.glob("*.c"))
    found = re.findall(r'"static [^"=(%]*?\b(\w+)(?:\[|\(| = )', texts) + re.findall(r'write_(?:sizes\(file, "\w+"|whole_numbers\(file|truths\(file), "(\w+)"', texts)
    found += re.findall(r'"([a-z]+(?:_[a-z]+)*)"', (ROOT / "src" / "compiler" / "program" / "generated_functions.c").read_text())
    return sorted(set(found) - {"double", "int", "void"})


def unit(version):
    lines = [f'#include "{path}"' for path in sources(version)]
    return "\n".join([*lines, *(f"static const int {name} = 0;" for name in generated_names()), ""])


def complaints(text):
    words = ["gcc", "-std=c11", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-Wno-unused", "-x", "c", "-"]
    headers = [f"-I{folder}" for folder in (ROOT / "include", RUNTIME)]
    return subprocess.run([*words, *headers], input=text, capture_output=True, text=True).stderr


if __name__ == "__main__":
    found = "".join(complaints(unit(version)) for version in (2, 3))
    sys.exit(found or None)
