"""List the words of the XML language, as `lagc --words` prints them."""

import functools
import os
import subprocess
from pathlib import Path

LAGC = Path(__file__).resolve().parent / "bin" / ("lagc.exe" if os.name == "nt" else "lagc")


@functools.cache
def words():
    """Return the reserved words by kind: "function" and "name", which no variable may have, and "element"."""
    found = {"function": [], "name": [], "element": []}
    for line in subprocess.run([LAGC, "--words"], capture_output=True, text=True, check=True).stdout.splitlines():
        kind, name = line.split()
        found[kind].append(name)
    return found
