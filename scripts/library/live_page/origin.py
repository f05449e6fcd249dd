"""Derive the system of an FMU again, with additional inputs that pull its bodies."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree


PULL_OF = "pull.of."  # prefix of the inputs that lagc --pull adds for bodies


class Origin(NamedTuple):
    """The system of which an FMU was made, and the tools that made it."""

    system: Path  # the file of the system, or the URDF of a robot
    lagc: Path
    one_file: Callable[[Path, str], str]  # returns the FMU's source as one file, for a system.c and the FMU's name
    words: tuple[str, ...] = ()  # further arguments of lagc


def pulled_system(origin, source, folder):
    """
    Derive the system with inputs that pull its bodies, and with the method of `source`, the FMU's C source.

    Return the bytes of modelDescription.xml and the path of its C source. Return None if lagc fails, as for a method for linear systems, which
    does not allow such forces.
    """
    method = re.search(r"\.solver = &solver_([a-z]+)", Path(source).read_text(encoding="utf-8"))
    words = [*origin.words, *(["--solver", method[1]] if method else [])]
    lagc = subprocess.run([origin.lagc, origin.system, "-o", folder, "--pull", *words], capture_output=True, text=True)
    if lagc.returncode != 0:
        return None
    folder = Path(folder)
    description = (folder / "modelDescription.xml").read_bytes()
    pulled = folder / "pulled.c"
    pulled.write_text(origin.one_file(folder / "system.c", ElementTree.fromstring(description).get("modelName")), encoding="utf-8")
    return description, pulled


def can_be_pulled(description):
    """Return True if a modelDescription.xml has inputs that pull bodies."""
    return any(variable.get("name").startswith(PULL_OF) for variable in ElementTree.fromstring(description).find("ModelVariables"))
