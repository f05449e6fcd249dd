"""The system that an FMU was made of, and the same once more with inputs by which bodies can be pulled."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree


class Origin(NamedTuple):
    system: Path  # its file: a system, or the URDF of a robot
    lagc: Path
    one_file: Callable[[Path, str], str]  # of a system.c and the FMU's name: its one file of C


def pulled_system(origin, source, folder):
    """
    modelDescription.xml as a tree, and the one file of C, of the system whose bodies can be pulled, solved by the method of this
    source of its FMU. None where lagc refuses: a method for linear systems alone takes no such force.
    """
    method = re.search(r"\.solver = &solver_([a-z]+)", Path(source).read_text(encoding="utf-8"))
    words = ["--solver", method[1]] if method else []
    lagc = subprocess.run([origin.lagc, origin.system, "-o", folder, "--pull", *words], capture_output=True, text=True)
    if lagc.returncode != 0:
        return None
    folder = Path(folder)
    tree = ElementTree.parse(folder / "modelDescription.xml").getroot()
    pulled = folder / "pulled.c"
    pulled.write_text(origin.one_file(folder / "system.c", tree.get("modelName")), encoding="utf-8")
    return tree, pulled
