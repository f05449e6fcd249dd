"""The archive of an FMU: the same content gives the same bytes."""

import subprocess
import zipfile
from pathlib import Path

import cmake

RUNTIME = Path(__file__).resolve().parent / "runtime"
TIME = (2000, 1, 1, 0, 0, 0)  # of all files


def write_sources(system, name, file, fmi):
    """The sources of an FMU as one file, from its system.c and the runtime; by the script that does so wherever FMUs are built."""
    words = [Path(cmake.CMAKE_BIN_DIR) / "cmake", "-D", f"SOURCE={RUNTIME}", "-D", f"NAMES={RUNTIME / 'global_names'}"]
    words += ["-D", f"SYSTEM={system}", "-D", f"NAME={name}", "-D", f"FILE={file}", "-D", f"VERSION={fmi}", "-P", RUNTIME / "scripts" / "write_sources.cmake"]
    subprocess.run(words, check=True)


def pack(content, archive):
    """All of a folder, modelDescription.xml first."""
    members = sorted(path.relative_to(content).as_posix() for path in content.rglob("*") if path.is_file())
    members.sort(key=lambda member: member != "modelDescription.xml")
    with zipfile.ZipFile(archive, "w") as file:
        for member in members:
            entry = zipfile.ZipInfo(member, TIME)
            entry.create_system = 3  # Unix, whose permissions these are
            entry.external_attr = 0o100644 << 16
            file.writestr(entry, (content / member).read_bytes(), zipfile.ZIP_DEFLATED, 9)
