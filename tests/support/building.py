"""
Build FMUs of systems that tests write themselves, without CMake. The steps are lagc, one call of a compiler with the flags of scripts/package/fmu.cmake, and
scripts/package/pack.py, with the tools of an existing build. CMake alone would take as long per FMU as the C compiler.
"""

import ctypes
import fcntl
import functools
import hashlib
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.append(str(ROOT))  # for programs that run elsewhere
from scripts.package.pack import fmu_of, write  # noqa: E402

BUILD = Path(os.environ.get("FMU_BUILD", ROOT / "build"))
LAGC = ROOT / "build" / "bin" / "lagc"
PLATFORMS = {2: "linux64", 3: "x86_64-linux"}
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -Wno-unused-parameter".split()
COMPILED = "-std=gnu11 -ffp-contract=off -fPIC -fvisibility=hidden -ffunction-sections -fdata-sections -fno-asynchronous-unwind-tables".split()
LINKED = "-shared -s -Wl,--gc-sections -Wl,--exclude-libs,ALL -Wl,--as-needed -Wl,--no-undefined".split()
LINKED += [f"-Wl,--wrap={function}" for function in ("malloc", "calloc", "realloc", "free")]
SPEED = ["-O0"]  # about half the compile time of -O1 for large systems; the systems of fmu/ are built with the release flags

built_by_tests = {}  # archive by name of the system


@contextmanager
def alone(lock):
    """Hold an exclusive lock on a file; other processes wait."""
    with open(lock, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


@functools.cache
def bring_up_to_date(build):
    """Update the tools and libraries that systems take from another build, under the lock of scripts/build."""
    with alone(build / "build.lock"):
        tools = ["lagc", "core", "fmi2", "fmi3", "solvers", "list_global_names"]
        subprocess.run(["cmake", "--build", build, "--target", *tools], check=True, capture_output=True)


@functools.cache
def runtime(version):
    """Return the object files and libraries that every FMU is linked with."""
    cache = (BUILD / "CMakeCache.txt").read_text()
    sundials = re.search(r"^sundials_in_use:INTERNAL=(.+)$", cache, re.MULTILINE)
    folders = [BUILD / "CMakeFiles" / f"{layer}.dir" for layer in ("core", f"fmi{version}")]
    # A build folder keeps objects of deleted sources.
    objects = sorted(
        path for folder in folders for path in folder.rglob("*.o")
        if (ROOT / path.relative_to(folder)).with_suffix("").exists()
    )  # fmt: skip
    assert objects and sundials, f"{BUILD} is not built"
    return [*objects, BUILD / "libsolvers.a", "-Wl,--start-group", *sundials[1].split(";"), "-Wl,--end-group", "-lm"]


@functools.cache
def runtime_digest():
    """Return a hash that changes with the runtime."""
    files = [BUILD / "libsolvers.a", *(path for layer in ("core", "fmi2", "fmi3") for path in (BUILD / "CMakeFiles" / f"{layer}.dir").rglob("*.o"))]
    files += [*(ROOT / "include").glob("*.h"), *(ROOT / "src" / "runtime").rglob("*.[ch]"), *(ROOT / "scripts" / "package").glob("*.py"), Path(__file__)]
    return hashlib.sha256("".join(f"{path} {path.stat().st_mtime_ns}\n" for path in sorted(files)).encode()).hexdigest()


def functions_of(library, *sources):
    """Compile files of C, named from the root of the project, to a shared library, and return it for calls of its functions alone."""
    folders = [f"-I{ROOT / folder}" for folder in ("include", "src/runtime")]
    files = [ROOT / source for source in sources]
    subprocess.run(["gcc", "-std=c11", "-O2", "-shared", "-fPIC", *folders, *files, "-lm", "-o", library], check=True)
    return ctypes.CDLL(str(library))


def library_in(folder, name, version):
    return folder / "binaries" / PLATFORMS[version] / f"{name}.so"


def library_words(source, library, version, compiler="gcc", speed=SPEED):
    """Return the command that compiles a system.c and links the library of its FMU."""
    return [compiler, *speed, *WARNINGS, *COMPILED, f"-I{ROOT}/include", f"-I{ROOT}/src/runtime", source, *runtime(version), *LINKED,
            f"-Wl,-Map={source.parent}/link.map", f"-Wl,--version-script={ROOT}/src/runtime/fmi{version}/exports.map", "-o", library]  # fmt: skip


def pack(folder, library, archive, version):
    write(archive, fmu_of(folder, version, [library], BUILD / "global_names", BUILD / "licenses"))


def run(words):
    result = subprocess.run(list(map(str, words)), capture_output=True, text=True)
    assert result.returncode == 0, f"{words[0]} fails\n{result.stdout}{result.stderr}"


def archive_of(build, name, version=2):
    return build / ("fmu" if version == 2 else "fmi3") / f"{name}.fmu"


def build_system(build, name, versions, words):
    """Derive the system; compile and pack only if the derived files or the runtime differ from those of the existing FMU."""
    folder = build / "systems" / name
    run([LAGC, folder / "system.xml", "-o", folder, *words])
    written = [folder / "system.c", folder / "modelDescription.xml", folder / "documentation" / "index.html", *sorted((folder / "fmi3").glob("*"))]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in written) + f"{versions} {runtime_digest()}".encode()).hexdigest()
    stamp = folder / "built"
    if stamp.exists() and stamp.read_text() == digest:
        return
    stamp.unlink(missing_ok=True)
    for version in versions:
        library = library_in(folder, name, version)
        library.parent.mkdir(parents=True, exist_ok=True)
        run(library_words(folder / "system.c", library, version))
        pack(folder, library, archive_of(build, name, version), version)
    stamp.write_text(digest)


def write_systems(folder, texts, files={}):
    """Write system.xml and the files that it names, text or bytes, leave unchanged files untouched, and remove other systems from the folder."""
    for path, content in ({f"{name}/system.xml": text for name, text in texts.items()} | files).items():
        content = content if isinstance(content, bytes) else content.encode()
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        if not (folder / path).exists() or (folder / path).read_bytes() != content:
            (folder / path).write_bytes(content)
    for path in folder.iterdir():
        if path.name not in texts:
            shutil.rmtree(path)


def build_systems(folder, texts, *words, versions=(2,), files={}):
    """
    Build FMUs of systems given as text by name, in a folder of the build, for the given versions of FMI. Other processes wait. `words` are
    further arguments of lagc; `files` are those that systems name, as NAME/FILE.
    """
    build = BUILD / folder
    bring_up_to_date(BUILD)
    build.mkdir(parents=True, exist_ok=True)
    with alone(build / "lock"), ThreadPoolExecutor(os.cpu_count()) as pool:
        write_systems(build / "systems", texts, files)
        list(pool.map(lambda name: build_system(build, name, versions, words), texts))
    for name in texts:
        built_by_tests[name] = archive_of(build, name)


def build_by_cmake(folder, texts, *words, tools=ROOT / "build"):
    """Build FMUs by CMake as users do, in any folder; no other test finds them by name. Return the folder of the archives."""
    bring_up_to_date(tools)
    write_systems(folder / "systems", texts)
    subprocess.run([ROOT / "scripts" / "build", folder, f"-DSYSTEMS={folder / 'systems'}", f"-DTOOLS={tools}", *words], check=True)
    return folder / "fmu"
