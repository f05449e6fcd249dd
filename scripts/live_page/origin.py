"""The system that an FMU was made of, and the same once more with inputs by which bodies can be pulled."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree


PULL_OF = "pull.of."  # with which the names of inputs begin that lagc --pull adds for bodies


class Origin(NamedTuple):
    system: Path  # its file: a system, or the URDF of a robot
    lagc: Path
    one_file: Callable[[Path, str], str]  # of a system.c and the FMU's name: its one file of C


def pulled_system(origin, source, folder):
    """
    modelDescription.xml in bytes, and the one file of C, of the system whose bodies can be pulled, solved by the method of this
    source of its FMU. None where lagc refuses: a method for linear systems alone takes no such force.
    """
    method = re.search(r"\.solver = &solver_([a-z]+)", Path(source).read_text(encoding="utf-8"))
    words = ["--solver", method[1]] if method else []
    lagc = subprocess.run([origin.lagc, origin.system, "-o", folder, "--pull", *words], capture_output=True, text=True)
    if lagc.returncode != 0:
        return None
    folder = Path(folder)
    description = (folder / "modelDescription.xml").read_bytes()
    pulled = folder / "pulled.c"
    pulled.write_text(origin.one_file(folder / "system.c", ElementTree.fromstring(description).get("modelName")), encoding="utf-8")
    return description, pulled


def can_be_pulled(description):
    """Whether that modelDescription.xml has inputs that pull bodies."""
    return any(variable.get("name").startswith(PULL_OF) for variable in ElementTree.fromstring(description).find("ModelVariables"))
