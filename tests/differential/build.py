"""From system.xml to a loaded FMU: lagc, and one call of a C compiler with the flags of CMakeLists.txt."""

import functools
import re
import shutil
import subprocess
from pathlib import Path

import fmpy

import fmu
from fmu import BUILD, ROOT

WRAPPED = [f"-Wl,--wrap={function}" for function in ("malloc", "calloc", "realloc", "free")]  # as CMakeLists.txt
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -Wno-unused-parameter".split()
TIME_LIMIT = 300  # s, for one program


class Refused(Exception):
    """By lagc, with a line; or by the FMU, with a message."""


class Wrong(Exception):
    """What must not happen."""


@functools.cache
def runtime(version):
    """Object files and libraries that every FMU is linked with."""
    cache = (BUILD / "CMakeCache.txt").read_text()
    sundials = re.search(r"^sundials_in_use:INTERNAL=(.+)$", cache, re.MULTILINE)
    folders = [BUILD / "CMakeFiles" / f"{layer}.dir" for layer in ("core", f"fmi{version}")]
    # Objects of sources that are gone stay in a build folder.
    objects = sorted(
        path for folder in folders for path in folder.rglob("*.o")
        if (ROOT / path.relative_to(folder)).with_suffix("").exists()
    )  # fmt: skip
    assert objects and sundials, f"{BUILD} is not built"
    return [*objects, BUILD / "libsolvers.a", "-Wl,--start-group", *sundials[1].split(";"), "-Wl,--end-group", "-lm"]


def run(words, what):
    try:
        return subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired as error:
        raise Wrong(f"{what} takes more than {TIME_LIMIT} s") from error


def compile_system(system, folder):
    """The folder of the unpacked FMU."""
    source = folder / "system.xml"
    system.write(folder)
    target = folder / "fmu"
    result = run([fmu.LAGC, source, "-o", target, "--form", system.plan.form], "lagc")
    if result.returncode == 1 and re.search(r"system\.xml(:\d+)?: \S", result.stderr):
        raise Refused("lagc: " + re.sub(r"^.*?system\.xml(:\d+)?: ", "", result.stderr.splitlines()[0]))
    if result.returncode != 0:
        raise Wrong(f"lagc ends with {result.returncode}: {result.stderr[:500]}")
    plan = system.plan
    unpacked = target if plan.fmi == 2 else target / "fmi3"
    library = unpacked / "binaries" / ("linux64" if plan.fmi == 2 else "x86_64-linux") / f"{system.name}.so"
    library.parent.mkdir(parents=True)
    speed = ["-O2"] if plan.unrolled else ["-O1", "-DSERIES_ROLLED"]
    words = [plan.compiler, *speed, *WARNINGS, "-std=gnu11", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-shared",
             f"-I{ROOT}/include", f"-I{ROOT}/src/runtime", target / "system.c", *runtime(plan.fmi), *WRAPPED, "-Wl,--exclude-libs,ALL",
             f"-Wl,--version-script={ROOT}/src/runtime/fmi{plan.fmi}/exports.map", "-Wl,--no-undefined", "-o", library]  # fmt: skip
    result = run(words, plan.compiler)
    if result.returncode != 0:
        raise Wrong(f"C that {plan.compiler} refuses: {result.stderr[:1000]}")
    return pack(system, folder, library) if plan.packed else unpacked


def pack(system, folder, library):
    """As users get it: packed, and unpacked by FMPy."""
    archive, content = folder / f"{system.name}.fmu", folder / "fmu"
    icon = [BUILD / "bin" / "icon", library, content / "modelDescription.xml", content / "model.png"]
    settings = {"FOLDER": content, "LIBRARIES": library, "FMU": archive, "VERSION": 2, "SYSTEM": folder / "system.xml", "SOURCE": ROOT,
                "NAMES": BUILD / "global_names", "ZIP": shutil.which("zip")}  # fmt: skip
    words = ["cmake", *(word for key, value in settings.items() for word in ("-D", f"{key}={value}")), "-P", ROOT / "scripts" / "pack.cmake"]
    for command, what in ((icon, "icon"), (words, "pack.cmake")):
        result = run(command, what)
        if result.returncode != 0:
            raise Wrong(f"{what}: {result.stderr[:1000]}")
    unpacked = fmpy.extract(str(archive), str(folder / "unpacked"))
    source = Path(unpacked) / "sources" / f"{system.name}.c"
    if source.exists() and (complaints := fmu.complaints_about(source, system.plan.compiler)):
        raise Wrong(f"one file that {system.plan.compiler} refuses: {complaints[:1000]}")
    return unpacked
