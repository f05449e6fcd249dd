"""From a system in XML to an FMU: lagc derives, zig compiles, and all is packed."""

import re
import subprocess
import tempfile
import warnings
import zipfile
from pathlib import Path
from xml.etree import ElementTree

from .cross import PLATFORMS, compile_fmu
from .problem import Problem

HERE = Path(__file__).resolve().parent
RUNTIME = HERE / "runtime"
METHODS = {"bdf": "radau", "erk": "auto"}  # those that need SUNDIALS: what to take instead
TIME = (2000, 1, 1, 0, 0, 0)  # of all files in an archive, so that the same content gives the same bytes


def system_file(system):
    """The file of a system, which may be given by its folder."""
    path = Path(system)
    if path.is_dir():
        path = path / "system.xml"
    if not path.is_file():
        raise Problem(f"there is no file {path}; expected that of a <system>, or its folder with a system.xml in it")
    return path


def derive(system, folder, solver=None, constants=None):
    """Lets lagc write into the folder; returns modelDescription.xml."""
    words = ["--solver", solver] if solver else []
    for name, value in (constants or {}).items():
        words += ["-D", f"{name}={value}"]
    lagc = subprocess.run([HERE / "bin" / "lagc", system_file(system), "-o", folder, *words], capture_output=True, text=True)
    if lagc.returncode != 0:
        raise Problem(lagc.stderr.strip())
    if lagc.stderr:
        warnings.warn(lagc.stderr.strip(), stacklevel=3)
    return ElementTree.parse(folder / "modelDescription.xml").getroot()


def name_of(description):
    return description.find("CoSimulation").get("modelIdentifier")


def check(system, solver=None, constants=None):
    """Derives the equations without building anything; mistakes are a Problem. Returns what came out, in a line."""
    with tempfile.TemporaryDirectory() as scratch:
        description = derive(system, Path(scratch), solver, constants)
        method = method_of(Path(scratch))
    count = lambda causality: len(description.findall(f"ModelVariables/ScalarVariable[@causality='{causality}']"))  # noqa: E731
    states = len(description.findall("ModelStructure/Derivatives/Unknown"))
    return f"{name_of(description)}: {states} states, {count('input')} inputs, {count('output')} outputs, {count('parameter')} parameters; solver {method}"


def method_of(folder):
    """The method of the system whose equations are there; none without states."""
    found = re.search(r"\.solver = &solver_([a-z]+)", (folder / "system.c").read_text())
    return found[1] if found else "none"


def write_sources(folder, name, content):
    """The FMU's sources as one file, by the script that makes them wherever FMUs are built."""
    import cmake

    (content / "sources").mkdir()
    script = folder / "write.cmake"
    script.write_text(f'include("{RUNTIME.as_posix()}/one_file.cmake")\none_file("{(folder / "system.c").as_posix()}" {name} "{content.as_posix()}/sources/{name}.c")\n')
    words = [Path(cmake.CMAKE_BIN_DIR) / "cmake", "-D", f"SOURCE={RUNTIME}", "-D", f"NAMES={RUNTIME / 'global_names'}", "-P", script]
    subprocess.run(words, check=True)


def pack(content, archive):
    """All of a folder, modelDescription.xml first."""
    members = sorted(path.relative_to(content).as_posix() for path in content.rglob("*") if path.is_file())
    members.sort(key=lambda member: member != "modelDescription.xml")
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for member in members:
            entry = zipfile.ZipInfo(member, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, whose permissions these are
            entry.external_attr = 0o100644 << 16
            file.writestr(entry, (content / member).read_bytes())


def build(system, platforms=None, solver=None, output=None, constants=None):
    """
    Builds the FMU of a system's file, or of a folder with a system.xml in it, and returns its path: NAME.fmu in the current
    folder, or in the folder `output`. Platforms are names in PLATFORMS (linux64 where none are given), `solver` a
    method in place of the system's own, `constants` the values of <constant>s by name.
    """
    platforms = list(dict.fromkeys(platforms or ["linux64"]))
    for platform in platforms:
        if platform not in PLATFORMS:
            raise Problem(f"the platform '{platform}' is not known; expected {', '.join(PLATFORMS)}")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        description = derive(system, folder, solver, constants)
        name, method = name_of(description), method_of(folder)
        if method in METHODS:
            raise Problem(
                f"{system_file(system)}: the solver {method} needs SUNDIALS, which this package does not bring; "
                f"expected another one, such as {METHODS[method]} (--solver {METHODS[method]}), or lagrange-fmu from its repository"
            )
        content = folder / "content"
        for platform in platforms:
            suffix, _ = PLATFORMS[platform]
            library = folder / "library" / platform / f"{name}{suffix}"
            library.parent.mkdir(parents=True)
            compile_fmu(platform, folder / "system.c", library, source=RUNTIME)
            placed = content / "binaries" / platform / library.name
            placed.parent.mkdir(parents=True)
            library.rename(placed)
        (content / "documentation").mkdir()
        for file in ("modelDescription.xml", "documentation/index.html"):
            (folder / file).rename(content / file)
        if description.find("CoSimulation/SourceFiles") is not None:
            write_sources(folder, name, content)
        archive = Path(output or ".") / f"{name}.fmu"
        archive.parent.mkdir(parents=True, exist_ok=True)
        pack(content, archive)
    return archive


def new(name, folder="."):
    """Writes NAME.xml, a system to begin with, and returns its path."""
    if not re.fullmatch("[A-Za-z_][A-Za-z0-9_]{0,99}", name):
        raise Problem(f"'{name}' cannot name a system; expected letters, digits and _, at most 100, and no digit at the beginning")
    path = Path(folder) / f"{name}.xml"
    try:
        with open(path, "x", encoding="utf-8") as file:
            file.write((HERE / "template.xml").read_text(encoding="utf-8").replace("@NAME@", name))
    except FileExistsError:
        raise Problem(f"{path} is already there; expected another name") from None
    return path
