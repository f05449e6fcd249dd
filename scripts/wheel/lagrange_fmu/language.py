"""The words of the language of systems, as lagc tells them."""

import functools
import os
import subprocess
from pathlib import Path

LAGC = Path(__file__).resolve().parent / "bin" / ("lagc.exe" if os.name == "nt" else "lagc")


@functools.cache
def words():
    """The names of each kind: the functions and other names, which nothing else can have, and the elements."""
    found = {"function": [], "name": [], "element": []}
    for line in subprocess.run([LAGC, "--words"], capture_output=True, text=True, check=True).stdout.splitlines():
        kind, name = line.split()
        found[kind].append(name)
    return found
