"""From a system in XML to an FMU: lagc derives, zig compiles, and all is packed."""

import functools
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from xml.etree import ElementTree

from . import caching
from .language import LAGC
from .live_page.origin import Origin
from .packing import pack
from .problem import Problem
from .runtime.scripts.cross import PLATFORM_NAMES, WEBASSEMBLY, Failure, compile_fmu
from .runtime.scripts.one_file import one_file
from .variables import instead, near_file
from .whole_files import write_whole

HERE = Path(__file__).resolve().parent
TEMPLATES = ("pendulum", "cart", "robot", "bounce", "linkage")
NATIVE = {"Windows": "win64", "Darwin": "darwin64"}.get(platform.system(), "linux64" if platform.machine() == "x86_64" else f"{platform.machine()}-linux")


def system_file(system):
    """The file of a system, which may be given by its folder."""
    path = Path(system)
    if path.is_dir():
        path = path / "system.xml"
    if not path.is_file():
        raise Problem(f"there is no file {path}{near_file(path) or '; expected a system in XML, a robot in URDF, or a folder with a system.xml in it'}")
    return path


def origin_of(system):
    """For pages with more than the FMU."""
    runtime = HERE / "runtime"
    return Origin(system_file(system), LAGC, lambda code, name: one_file(runtime, runtime / "global_names", 2, code, name))


def derive(system, folder, solver, words=()):
    """Lets lagc, with these words, write into the folder; returns modelDescription.xml as a tree."""
    words = [LAGC, system_file(system), "-o", folder, *words]
    if solver is not None:
        words += ["--solver", solver]
    lagc = subprocess.run(words, capture_output=True, text=True)
    if lagc.returncode != 0:
        raise Problem(lagc.stderr.strip())
    if lagc.stderr:
        warnings.warn(lagc.stderr.strip(), stacklevel=3)
    return ElementTree.parse(folder / "modelDescription.xml").getroot()


def method_of(folder):
    """The method of the system whose equations are there; "none" for one without states."""
    found = re.search(r"\.solver = &solver_([a-z]+)", (folder / "system.c").read_text(encoding="utf-8"))
    return found[1] if found else "none"


def check(system: str | os.PathLike[str], solver: str | None = None) -> str:
    """Derives the equations and builds nothing; mistakes are a Problem. Returns in a line what came out."""
    with tempfile.TemporaryDirectory() as scratch:
        description = derive(system, Path(scratch), solver)
        method = method_of(Path(scratch))
    counts = {"state": len(description.findall("ModelStructure/Derivatives/Unknown"))}
    for causality in ("input", "output", "parameter"):
        counts[causality] = len(description.findall(f"ModelVariables/ScalarVariable[@causality='{causality}']"))
    content = ", ".join(f"{count} {kind}{'' if count == 1 else 's'}" for kind, count in counts.items())
    return f"{description.get('modelName')}: {content}; solver {method}"


@functools.cache
def runtime_key():
    """Of what every library is built from beside its system.c."""
    files = [file for part in ("runtime", "sundials/include") for file in sorted((HERE / part).rglob("*.[ch]"))]
    files += sorted((HERE / "runtime" / "src" / "ensemble").glob("*.flags"))
    files += sorted((HERE / "runtime" / "scripts").rglob("*.py"))
    return caching.key_of(version("ziglang"), *(file.read_bytes() for file in files))


def tell(text):
    """Progress, beside what commands print."""
    print(f"lagrange-fmu: {text}", file=sys.stderr, flush=True)


def take_or_compile(key, folder, what, compile_library):
    """What was compiled before is taken from the cache, else compiled into the folder and kept; what: how its message begins."""
    if caching.take(key, folder):
        return
    caching.keep_what_zig_compiles()
    try:
        compile_library()
    except Failure as failure:
        raise Problem(f"{what}: {failure}") from None
    caching.keep(key, folder)


def compile_libraries(folder, name, platforms, fmi, content):
    """Into the folder content/binaries."""
    system = folder / "system.c"
    for platform_name in platforms:
        libraries = folder / "libraries" / platform_name
        key = caching.key_of(runtime_key(), system.read_bytes(), name, platform_name, fmi)

        def compile_library():
            with caching.first_build(platform_name, tell):
                compile_fmu(platform_name, system, libraries, name, fmi, sundials=HERE / "sundials")

        take_or_compile(key, libraries, f"{name} cannot be compiled for {platform_name}", compile_library)
        shutil.copytree(libraries, content / "binaries", dirs_exist_ok=True)
        if platform_name == WEBASSEMBLY:
            extra = content / "extra" / "org.modelica.fmi-ls-wasm"
            extra.mkdir(parents=True)
            for manifest in ("manifest.xml", "fmi-ls-manifest.xml"):  # as scripts/pack.cmake
                shutil.copy(HERE / "runtime" / "scripts" / "wasm_component" / "manifest.xml", extra / manifest)


def copy_licenses(file, target):
    """Of libraries that are linked into the FMU: lagc's license.txt names the files."""
    target.mkdir(parents=True)
    for names in re.findall(" is linked into it: (.*)", file.read_text(encoding="utf-8")):
        for name in names.split(", "):
            shutil.copy(HERE / "licenses" / name, target)


def write_descriptions(folder, name, fmi, content):
    """What stands beside the libraries; folder holds what lagc wrote."""
    files = {"modelDescription.xml": "modelDescription.xml", "documentation/index.html": "documentation/index.html"}
    if fmi == 3:
        files |= {"modelDescription.xml": "fmi3/modelDescription.xml", "terminalsAndIcons/terminalsAndIcons.xml": "fmi3/terminalsAndIcons.xml"}
        files |= {"terminalsAndIcons/icon.svg": "fmi3/icon.svg", "terminalsAndIcons/icon.png": "model.png"}
        files |= {f"terminalsAndIcons/{picture.name}": f"fmi3/{picture.name}" for picture in (folder / "fmi3").glob("flange.*")}
    else:
        files["model.png"] = "model.png"
    licenses = Path("documentation/licenses")
    files[licenses / "license.txt"] = licenses / "license.txt"
    copy_licenses(folder / licenses / "license.txt", content / licenses)
    build_description = folder / "fmi3" / "buildDescription.xml"
    if build_description.exists():  # then it is complete in C
        runtime, sources = HERE / "runtime", content / "sources"
        sources.mkdir(parents=True)
        (sources / f"{name}.c").write_bytes(one_file(runtime, runtime / "global_names", fmi, folder / "system.c", name).encode())
        if fmi == 3:
            files["sources/buildDescription.xml"] = "fmi3/buildDescription.xml"
    for member, file in files.items():
        (content / member).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).rename(content / member)


def build(
    system: str | os.PathLike[str],
    platforms: str | Sequence[str] | None = None,
    solver: str | None = None,
    output: str | os.PathLike[str] = ".",
    fmi: int = 2,
    arrays: bool = False,
) -> Path:
    """
    Builds the FMU of a system's file, or of a folder with a system.xml in it, and returns its path: NAME.fmu in the folder
    `output`. Platforms are one or several of PLATFORM_NAMES, this machine's where none are given; `solver` is a method in place of the system's own;
    `fmi` is the version of FMI, 2 or 3. With `arrays`, what <for> makes are arrays in FMI 3.0, not scalars.
    """
    return build_with(("--arrays",) if arrays else (), system, platforms, solver, output, fmi)


def build_with(words, system, platforms=None, solver=None, output=".", fmi=2):
    """The same, with further words for lagc."""
    platforms = [platforms] if isinstance(platforms, str) else list(dict.fromkeys(platforms or [NATIVE]))
    for name in platforms:
        if name not in PLATFORM_NAMES:
            raise Problem(f"the platform '{name}' is not known; {instead(name, PLATFORM_NAMES, 'expected one of these')}")
    if fmi not in (2, 3):
        raise Problem(f"the version {fmi} of FMI is not known; expected 2 or 3")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        description = derive(system, folder, solver, words)
        name = description.find("CoSimulation").get("modelIdentifier")
        content = folder / "content"
        compile_libraries(folder, name, platforms, fmi, content)
        write_descriptions(folder, name, fmi, content)
        archive = Path(output) / f"{name}.fmu"
        pack(content, archive)
    return archive


def new(name: str, template: str = "pendulum") -> Path:
    """Writes NAME.xml, a system to begin with, which is one of TEMPLATES, and returns its path."""
    if template not in TEMPLATES:
        raise Problem(f"the template '{template}' is not known; {instead(template, TEMPLATES, 'expected one of these')}")
    if not re.fullmatch("[A-Za-z_][A-Za-z0-9_]{0,99}", name):
        raise Problem(f"'{name}' cannot name a system; expected letters, digits and _, at most 100, and no digit at the beginning")
    path = Path(f"{name}.xml")
    if path.exists():
        raise Problem(f"{path} is already there; expected another name")
    return write_whole(path, (HERE / "templates" / f"{template}.xml").read_text(encoding="utf-8").replace("@NAME@", name))
