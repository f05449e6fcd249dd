"""Build an FMU from a system in XML: lagc derives the equations, zig compiles them, and the files are packed into an archive."""

import functools
import os
import platform
import re
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from xml.etree import ElementTree

from . import caching
from .language import LAGC
from .live_page.origin import Origin
from .problem import Problem
from .runtime.scripts.package.cross import PLATFORM_NAMES, Failure, compile_fmu
from .runtime.scripts.package.one_file import one_file
from .runtime.scripts.package.pack import fmu_of
from .variables import suggestion, near_file
from .whole_files import write_whole

HERE = Path(__file__).resolve().parent
TEMPLATES = ("pendulum", "cart", "robot", "bounce", "linkage")
NATIVE = {"Windows": "win64", "Darwin": "darwin64"}.get(platform.system(), "linux64" if platform.machine() == "x86_64" else f"{platform.machine()}-linux")


def system_file(system):
    """Return the path of a system's file; `system` may be the folder that contains system.xml. Raise Problem if there is none."""
    path = Path(system)
    if path.is_dir():
        path = path / "system.xml"
    if not path.is_file():
        raise Problem(f"there is no file {path}{near_file(path) or '; expected a system in XML, a robot in URDF, or a folder with a system.xml in it'}")
    if path.suffix == ".fmu":
        raise Problem(f"{path} is an FMU; expected the file from which it was made")
    return path


def origin_of(system, words=()):
    """Return the Origin of a system, from which live pages derive the variant whose bodies can be pulled. words: of lagc."""
    runtime = HERE / "runtime"
    return Origin(system_file(system), LAGC, lambda code, name: one_file(runtime, runtime / "global_names", 2, code, name), tuple(words))


def robot_texts(robot):
    """Return options of a robot, such as {"base": "floating", "ground": True}, as texts such as "base=floating"."""
    texts = {word: str(value).lower() if isinstance(value, bool) else value for word, value in (robot or {}).items()}
    return [f"{word}={value if isinstance(value, str) else ' '.join(value)}" for word, value in texts.items()]


def robot_words(robot):
    """Return the arguments of lagc for options of a robot."""
    return [word for text in robot_texts(robot) for word in ("--robot", text)]


def derive(system, folder, solver, words=()):
    """
    Run lagc, with `words` as further arguments, so that it writes C, modelDescription.xml and the documentation into the folder.

    Return the root of modelDescription.xml. Raise Problem with the message of lagc; its warnings become Python warnings.
    """
    words = [LAGC, system_file(system), "-o", folder, *words]
    if solver is not None:
        words += ["--solver", solver]
    lagc = subprocess.run(words, capture_output=True, text=True)
    if lagc.returncode != 0:
        raise Problem(lagc.stderr.strip())
    if lagc.stderr:
        warnings.warn(lagc.stderr.strip(), stacklevel=4)
    return ElementTree.parse(folder / "modelDescription.xml").getroot()


def method_of(folder):
    """Return the name of the method in the folder's system.c; "none" for a system without states."""
    found = re.search(r"\.solver = &solver_([a-z]+)", (folder / "system.c").read_text(encoding="utf-8"))
    return found[1] if found else "none"


def check(system: str | os.PathLike[str], solver: str | None = None, robot: Mapping[str, str | bool] | None = None) -> str:
    """
    Derive the equations of a system without building an FMU.

    Parameters
    ----------
    system : path
        A system in XML, a robot in URDF, or a folder that contains a system.xml.
    solver : str, optional
        Method in place of the system's own.
    robot : dict, optional
        Options for a robot, as for build().

    Returns
    -------
    str
        One line with the numbers of states, inputs, outputs and parameters, and the method.

    Raises
    ------
    Problem
        If the system has mistakes; the text has file and line.

    Examples
    --------
    >>> print(lagrange_fmu.check("pendulum.xml"))
    """
    with tempfile.TemporaryDirectory() as scratch:
        description = derive(system, Path(scratch), solver, robot_words(robot))
        method = method_of(Path(scratch))
    counts = {"state": len(description.findall("ModelStructure/Derivatives/Unknown"))}
    for causality in ("input", "output", "parameter"):
        counts[causality] = len(description.findall(f"ModelVariables/ScalarVariable[@causality='{causality}']"))
    content = ", ".join(f"{count} {kind}{'' if count == 1 else 's'}" for kind, count in counts.items())
    return f"{description.get('modelName')}: {content}; solver {method}"


@functools.cache
def runtime_key():
    """Return the hash of all sources that every library is built from, beside its system.c."""
    files = [file for part in ("runtime", "sundials/include") for file in sorted((HERE / part).rglob("*.[ch]"))]
    files += sorted((HERE / "runtime" / "src" / "ensemble").glob("*.flags"))
    files += sorted((HERE / "runtime" / "scripts").rglob("*.py"))
    return caching.key_of(version("ziglang"), *(file.read_bytes() for file in files))


def report(text):
    """Print a line about the progress to stderr."""
    print(f"lagrange-fmu: {text}", file=sys.stderr, flush=True)


def take_or_compile(key, folder, what, compile_library):
    """
    Copy a library from the cache into the folder, or compile it with compile_library() and add it to the cache.

    Raise Problem if the compilation fails; its text begins with `what`.
    """
    if caching.take(key, folder):
        return
    caching.share_zig_cache()
    try:
        compile_library()
    except Failure as failure:
        raise Problem(f"{what}: {failure}") from None
    caching.keep(key, folder)


def compile_libraries(folder, name, platforms, fmi):
    """Compile the libraries of all platforms and return them, each in a folder of its platform's name; `folder` contains system.c."""
    system, found = folder / "system.c", []
    for platform_name in platforms:
        libraries = folder / "libraries" / platform_name
        key = caching.key_of(runtime_key(), system.read_bytes(), name, platform_name, fmi)

        def compile_library():
            with caching.first_build(platform_name, report):
                compile_fmu(platform_name, system, libraries, name, fmi, sundials=HERE / "sundials")

        take_or_compile(key, libraries, f"{name} cannot be compiled for {platform_name}", compile_library)
        found += [path for path in sorted(libraries.rglob("*")) if path.is_file()]
    return found


def build(
    system: str | os.PathLike[str],
    platforms: str | Sequence[str] | None = None,
    solver: str | None = None,
    output: str | os.PathLike[str] = ".",
    fmi: int = 2,
    arrays: bool = False,
    robot: Mapping[str, str | bool] | None = None,
) -> Path:
    """
    Build the FMU of a system.

    Parameters
    ----------
    system : path
        A system in XML, a robot in URDF, or a folder that contains a system.xml.
    platforms : str or sequence of str, optional
        Platforms of the libraries, such as "linux64", "win64", "darwin64"; by default this machine's.
    solver : str, optional
        Method in place of the system's own.
    output : path
        Folder of the FMU.
    fmi : {2, 3}
        Version of FMI.
    arrays : bool
        True to declare the variables that <for> repeats as arrays, in FMI 3.0.
    robot : dict, optional
        Options for a robot in URDF or MJCF, by the attributes of an <include>: {"base": "floating", "ground": True, "limits": "stops"}.

    Returns
    -------
    Path
        The path of NAME.fmu.

    Raises
    ------
    Problem
        If the system has mistakes, a platform is unknown, or the compilation fails.

    Examples
    --------
    >>> path = lagrange_fmu.build("pendulum.xml", platforms=["linux64", "win64"])
    """
    return build_with([*(["--arrays"] if arrays else []), *robot_words(robot)], system, platforms, solver, output, fmi)


def build_with(words, system, platforms=None, solver=None, output=".", fmi=2):
    """Build as build() does, with `words` as further arguments of lagc."""
    platforms = [platforms] if isinstance(platforms, str) else list(dict.fromkeys(platforms or [NATIVE]))
    for name in platforms:
        if name not in PLATFORM_NAMES:
            raise Problem(f"the platform '{name}' is not known; {suggestion(name, PLATFORM_NAMES, 'expected one of these')}")
    if fmi not in (2, 3):
        raise Problem(f"the version {fmi} of FMI is not known; expected 2 or 3")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        description = derive(system, folder, solver, words)
        name = description.find("CoSimulation").get("modelIdentifier")
        libraries = compile_libraries(folder, name, platforms, fmi)
        return write_whole(Path(output) / f"{name}.fmu", fmu_of(folder, fmi, libraries, HERE / "runtime" / "global_names", HERE / "licenses"))


def new(name: str, template: str = "pendulum") -> Path:
    """
    Write NAME.xml, a system with comments, as a starting point.

    Parameters
    ----------
    name : str
        Name of the system: letters, digits and _.
    template : {"pendulum", "cart", "robot", "bounce", "linkage"}
        The system to copy.

    Returns
    -------
    Path
        The path of the file.

    Raises
    ------
    Problem
        If the name is invalid, the template is unknown, or the file exists.

    Examples
    --------
    >>> path = lagrange_fmu.new("MySystem", "cart")
    """
    if template not in TEMPLATES:
        raise Problem(f"the template '{template}' is not known; {suggestion(template, TEMPLATES, 'expected one of these')}")
    if not re.fullmatch("[A-Za-z_][A-Za-z0-9_]{0,99}", name):
        raise Problem(f"'{name}' cannot name a system; expected letters, digits and _, at most 100, and no digit at the beginning")
    path = Path(f"{name}.xml")
    if path.exists():
        raise Problem(f"{path} exists already; expected another name")
    return write_whole(path, (HERE / "templates" / f"{template}.xml").read_text(encoding="utf-8").replace("@NAME@", name))
