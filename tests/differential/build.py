"""Build a random system's FMU, unpacked, by one of two compilers, and classify errors."""

import re
import subprocess
from pathlib import Path

import fmpy

import fmu
from building import SPEED, library_in, library_words
from building import pack as pack_archive

TIME_LIMIT = 300  # s, for one program


class RejectedSystem(Exception):
    """An error message of lagc, with a line, or of the FMU."""


class Wrong(Exception):
    """A failure of lagc, the compiler or the FMU."""


def run(words, what):
    try:
        return subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired as error:
        raise Wrong(f"{what} takes more than {TIME_LIMIT} s") from error


def compile_system(system, folder):
    """Return the folder of the unpacked FMU."""
    source = folder / "system.xml"
    system.write(folder)
    target = folder / "fmu"
    result = run([fmu.LAGC, source, "-o", target, "--form", system.plan.form], "lagc")
    if result.returncode == 1 and re.search(r"system\.xml(:\d+)?: \S", result.stderr):
        raise RejectedSystem("lagc: " + re.sub(r"^.*?system\.xml(:\d+)?: ", "", result.stderr.splitlines()[0]))
    if result.returncode != 0:
        raise Wrong(f"lagc ends with {result.returncode}: {result.stderr[:500]}")
    plan = system.plan
    unpacked = target if plan.fmi == 2 else target / "fmi3"
    library = library_in(unpacked, system.name, plan.fmi)
    library.parent.mkdir(parents=True)
    words = library_words(target / "system.c", library, plan.fmi, plan.compiler, ["-O2"] if plan.unrolled else SPEED)
    result = run(words, plan.compiler)
    if result.returncode != 0:
        raise Wrong(f"C that {plan.compiler} rejects: {result.stderr[:1000]}")
    return pack(system, folder, library) if plan.packed else unpacked


def pack(system, folder, library):
    """Pack the FMU as users get it, and unpack it by FMPy."""
    archive, content = folder / f"{system.name}.fmu", folder / "fmu"
    pack_archive(content, library, archive, 2)
    unpacked = fmpy.extract(str(archive), str(folder / "unpacked"))
    source = Path(unpacked) / "sources" / f"{system.name}.c"
    if source.exists() and (complaints := fmu.complaints_about(source, system.plan.compiler)):
        raise Wrong(f"one file that {system.plan.compiler} rejects: {complaints[:1000]}")
    return unpacked
