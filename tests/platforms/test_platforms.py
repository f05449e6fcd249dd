"""
FMUs for several platforms in one archive. Libraries for Windows run under wine, those for ARM under qemu-user. Those for macOS, which cannot run
here, are inspected. FMU_PLATFORM_SYSTEMS=all takes all systems instead of one per solver.
"""

import functools
import os
import re
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest

import fmu
from building import alone, bring_up_to_date
from scripts.package.cross import PLATFORMS, Failure, compile_fmu, libraries_of
from fmu import BUILD, ROOT

pytestmark = pytest.mark.release

FOLDER = BUILD / "platforms"
ENVIRONMENT = {**os.environ, "WINEPREFIX": str(FOLDER / "wine"), "WINEDEBUG": "-all"}
# taylor, auto, exact, no solver, erk, bdf, and bdf with KLU; and one with events.
SYSTEMS = ["SimplePendulum", "ElasticPendulum", "ParticleCartesian", "StateFeedback", "BeadOnHoop", "FurutaPendulum", "Lattice", "BouncingBall"]
if os.environ.get("FMU_PLATFORM_SYSTEMS") == "all":
    SYSTEMS = [*fmu.all_names(), *fmu.further_names()]
# Programs that run the libraries of each platform.
RUNNERS = {"linux64": [], "win64": ["wine"], "aarch64-linux": ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]}
MESSAGES_DIFFER = re.compile(r"-?[0-9][0-9.e+-]*")  # messages are compared without numbers, whose rounding may differ


def source_of(name):
    """The folder of a system; the lattice's solver is bdf, and it is large enough for KLU."""
    folder = ROOT / "fmu" / name
    folder = folder if folder.exists() else ROOT / "tests" / "systems" / name
    if name != "Lattice":
        return folder
    text = (folder / "system.xml").read_text()
    copy = FOLDER / "systems-of-tests" / name / "system.xml"
    copy.parent.mkdir(parents=True, exist_ok=True)
    text = re.sub(r"<solver[^>]*>", "", text).replace("</system>", '  <solver method="bdf" tolerance="1e-8"/>\n</system>')
    if not copy.exists() or copy.read_text() != text:
        copy.write_text(text)
    return copy.parent


@functools.cache
def platforms():
    """Build the archives and the programs that drive them, once for all test processes; return the folder."""
    bring_up_to_date(ROOT / "build")
    FOLDER.mkdir(parents=True, exist_ok=True)
    with alone(FOLDER / "lock"):
        subprocess.run([ROOT / "scripts" / "package" / "sundials-all"], check=True)
        systems = ";".join(str(source_of(name)) for name in SYSTEMS)
        words = [f"-DSYSTEMS={systems}", f"-DPLATFORMS={';'.join(PLATFORMS)}", f"-DTOOLS={ROOT / 'build'}", f"-DLAGRANGE_PYTHON={sys.executable}"]
        subprocess.run([ROOT / "scripts" / "build", FOLDER, "-DFMI_VERSIONS=2;3", *words], check=True)
        for platform in RUNNERS:
            for program in ("drive", "stepping", "out_of_memory"):
                compile_program(platform, program)
        if not (FOLDER / "wine").exists():
            subprocess.run(["wine", "wineboot", "-i"], env=ENVIRONMENT, check=True, capture_output=True)
    return FOLDER


def path_of(platform, program):
    return FOLDER / "programs" / platform / (f"{program}.exe" if platform == "win64" else program)


def compile_program(platform, program):
    parts = (program, "fmu_library", *(["measuring"] if program == "stepping" else []))
    path, sources = path_of(platform, program), [ROOT / "tests" / "c" / f"{part}.c" for part in parts]
    if path.exists() and path.stat().st_mtime > max(source.stat().st_mtime for source in sources):
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    words = [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[platform][1][0], "-std=c11", "-D_GNU_SOURCE", "-O1", "-Wall", "-Werror"]
    environment = {"ZIG_LOCAL_CACHE_DIR": str(FOLDER / "cache"), **os.environ}
    subprocess.run([*words, f"-I{ROOT / 'include'}", *sources, "-o", path], check=True, env=environment)


@functools.cache
def unpacked(name, fmi=2):
    folder = platforms() / "unpacked" / f"{name}-{fmi}-{os.getpid()}"
    shutil.rmtree(folder, ignore_errors=True)
    return Path(fmpy.extract(platforms() / ("fmu" if fmi == 2 else "fmi3") / f"{name}.fmu", folder))


def libraries(name, platform, fmi=2):
    return [unpacked(name, fmi) / "binaries" / path for path in libraries_of(platform, name, fmi)]


def library(name, platform, fmi=2):
    """The library in the folder of the processor, if there is one."""
    return libraries(name, platform, fmi)[0]


def run(platform, program, name, *words):
    """Output of the program for the FMU's library of the platform."""
    guid = fmpy.read_model_description(unpacked(name)).guid
    command = [*RUNNERS[platform], path_of(platform, program), library(name, platform), guid, *map(str, words)]
    result = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT, timeout=600)
    assert result.returncode == 0, result.stderr
    return result.stdout.replace("\r\n", "\n")


def output_of(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def reals_of(name):
    """Number of Real variables before the first of another type."""
    types = [variable.type for variable in fmpy.read_model_description(unpacked(name)).modelVariables]
    return next((i for i, kind in enumerate(types) if kind != "Real"), len(types))


@functools.cache
def life(platform, name):
    """Log of a whole life cycle: two instances, saved and restored states, unloaded and loaded again."""
    states = fmpy.read_model_description(unpacked(name)).numberOfContinuousStates
    return run(platform, "drive", name, reals_of(name), states)


def first_reals(name):
    return ",".join(map(str, range(reals_of(name))))


@functools.cache
def motion(platform, name):
    """All variables at ten points."""
    lines = run(platform, "stepping", name, 1e-8, 0.5, 50, 0, first_reals(name), 10, ",").splitlines()
    return np.array([[float(word) for word in line.split()] for line in lines[:10]])


@pytest.mark.parametrize("name", SYSTEMS)
def test_archive(name):
    folders = {path.parent.name: path.name for path in unpacked(name).glob("binaries/*/*")}
    assert folders == {platform: f"{name}{suffix}" for platform, (suffix, _) in PLATFORMS.items()} | {"aarch64-darwin": f"{name}.dylib"}
    folders = {path.parent.name: path.suffix for path in unpacked(name, 3).glob("binaries/*/*")}
    assert folders == {"x86_64-linux": ".so", "x86_64-windows": ".dll", "x86_64-darwin": ".dylib", "aarch64-darwin": ".dylib", "aarch64-linux": ".so"}


@pytest.mark.parametrize("name", SYSTEMS)
def test_same_motion_of_fmi3(name):
    """Results of the library for this platform agree to the last bit."""
    second, third = (fmpy.simulate_fmu(str(unpacked(name, fmi)), fmi_type="CoSimulation", stop_time=0.5, output_interval=0.1) for fmi in (2, 3))
    columns = [column for column in second.dtype.names if column in third.dtype.names]
    assert len(columns) > 1
    for column in columns:
        np.testing.assert_array_equal(second[column], third[column])


@pytest.mark.parametrize("platform", ["win64", "aarch64-linux"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_whole_life(name, platform):
    """Nothing fails, and the messages are those of linux64."""
    here, there = (MESSAGES_DIFFER.sub("#", life(which, name)) for which in ("linux64", platform))
    assert here == there
    assert "expected" in here


@pytest.mark.parametrize("platform", ["win64", "aarch64-linux"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_same_motion(name, platform):
    here = motion("linux64", name)
    np.testing.assert_allclose(motion(platform, name), here, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(here).max()))


@pytest.mark.parametrize("name", [name for name in ("SimplePendulum", "ElasticPendulum", "ParticleCartesian", "BeadOnHoop") if name in SYSTEMS])
def test_this_machine_has_the_same_motion(name):
    """The archive of scripts/run, from this machine's compiler, has the same motion."""
    guid = fmu.description(name).guid
    words = [BUILD / "bin" / "stepping", fmu.library(name), guid, *map(str, (1e-8, 0.5, 50, 0, first_reals(name), 10, ","))]
    lines = output_of(*words).splitlines()[:10]
    ours = np.array([[float(word) for word in line.split()] for line in lines])
    np.testing.assert_allclose(ours, motion("linux64", name), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("platform", ["win64", "aarch64-linux"])
@pytest.mark.parametrize("name", [name for name in ("SimplePendulum", "BeadOnHoop", "FurutaPendulum") if name in SYSTEMS])
def test_without_memory(name, platform):
    """Each allocation fails in turn; if SUNDIALS uses the caller's memory, longjmp leaves it."""
    output = next(v.valueReference for v in fmpy.read_model_description(unpacked(name)).modelVariables if v.causality == "output")
    assert re.fullmatch(r"[1-9]\d* allocations\n", run(platform, "out_of_memory", name, output))


def functions(fmi):
    """All functions of this version of FMI."""
    return sorted(set(re.findall(rf"FMI{fmi}_EXPORT [^(;]*\b(fmi{fmi}\w+)\(", (ROOT / "include" / f"fmi{fmi}.h").read_text())))


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("platform", ["linux64", "aarch64-linux"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_linux_libraries(name, platform, fmi):
    """They export FMI's functions only, and require glibc 2.17 at most."""
    path = library(name, platform, fmi)
    table = output_of("llvm-objdump", "-T", path).splitlines()
    exported = sorted(line.split()[-1] for line in table if " g " in line and "*UND*" not in line)
    assert exported == functions(fmi)
    versions = {tuple(map(int, found.split("."))) for line in table for found in re.findall(r"GLIBC_([0-9.]+)", line)}
    assert versions and max(versions) <= (2, 17)
    needed = re.findall(r"NEEDED\s+(\S+)", output_of("llvm-objdump", "-p", path))
    assert set(needed) <= {"libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", SYSTEMS)
def test_windows_libraries(name, fmi):
    """They export FMI's functions only, and require libraries of Windows 10 and later."""
    text = output_of("llvm-readobj", "--coff-exports", "--coff-imports", library(name, "win64", fmi))
    exports, imports = re.findall(r"Export \{.*?Name: (\S+)", text, re.S), re.findall(r"Import \{\s+Name: (\S+)", text)
    assert sorted(exports) == functions(fmi)
    assert imports and all(re.fullmatch(r"KERNEL32\.dll|api-ms-win-crt-\w+-l1-1-0\.dll", name) for name in imports), imports


@pytest.mark.parametrize("name", SYSTEMS)
def test_mac_libraries(name):
    """One file for both processors, loadable from the FMU's folder, from macOS 11 on; the ARM library is signed, as it must be."""
    both, apple = libraries(name, "darwin64")
    intel, arm = libraries(name, "darwin64", 3)
    for path, processor, fmi in ((both, "x86_64", 2), (both, "arm64", 2), (apple, "arm64", 2), (intel, "x86_64", 3), (arm, "arm64", 3)):
        dump = functools.partial(output_of, "llvm-objdump", "--macho", f"--arch={processor}")
        exported = re.findall(r"^0x[0-9A-F]+\s+(\S+)$", dump("--exports-trie", path), re.M)
        # zig's linker adds two symbols by which every macOS library finds its own header.
        assert sorted(set(exported) - {"__mh_dylib_header", "___dso_handle"}) == [f"_{function}" for function in functions(fmi)]
        headers = dump("--private-headers", path)
        assert re.search(r"\bDYLIB\b", headers)
        assert re.findall(r"cmd LC_LOAD_DYLIB\s+cmdsize \d+\s+name (\S+)", headers) == ["/usr/lib/libSystem.B.dylib"]
        assert re.search(r"cmd LC_ID_DYLIB\s+cmdsize \d+\s+name @rpath/" + path.name, headers)
        assert re.search(r"cmd LC_BUILD_VERSION\s+cmdsize \d+\s+platform macos\s+sdk \S+\s+minos 11\.0", headers)
        assert ("LC_CODE_SIGNATURE" in headers) == (processor == "arm64")


@pytest.mark.parametrize("name", SYSTEMS)
def test_no_path_of_this_machine(name):
    for platform in PLATFORMS:
        for path in libraries(name, platform) + libraries(name, platform, 3):
            content = path.read_bytes()
            assert str(ROOT).encode() not in content and str(Path.home()).encode() + b"/" not in content, path


@pytest.mark.parametrize("name", ["StateFeedback", "BeadOnHoop"])
def test_same_bytes_from_another_folder(name, tmp_path):
    """Other folders of sources, system, and zig's cache give the same bytes."""
    for folder in ("include", "src"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    (tmp_path / "work").mkdir()
    shutil.copy(platforms() / "systems" / name / "system.c", tmp_path / "work")
    for platform in PLATFORMS:
        compile_fmu(platform, tmp_path / "work" / "system.c", tmp_path, name, source=tmp_path, sundials=ROOT / "build" / "sundials-all")
        path = library(name, platform)
        assert (tmp_path / platform / path.name).read_bytes() == path.read_bytes(), platform
        assert [entry.name for entry in (tmp_path / platform).iterdir()] == [path.name]


def test_large_systems_take_seconds(tmp_path):
    """Three seconds on an idle machine, and some 20 more with an empty zig cache; unrolled series would take minutes."""
    system = ROOT / "scripts" / "numerics" / "systems" / "StewartPlatform" / "system.xml"
    assert fmu.lagc(system, "-o", tmp_path).returncode == 0
    words = [sys.executable, ROOT / "scripts" / "package" / "cross.py", "fmu", "linux64", tmp_path / "system.c", tmp_path, "StewartPlatform"]
    subprocess.run(words, check=True, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (50, 50)))


def test_platforms_that_cannot_be_compiled(tmp_path):
    system = tmp_path / "system.c"
    system.write_text("int f(void) { return unknown; }\n")
    with pytest.raises(Failure, match="use of undeclared identifier 'unknown'"):
        compile_fmu("win64", system, tmp_path, "f")
    with pytest.raises(Failure, match="'vax' is not known; expected linux64, win64, darwin64, aarch64-linux"):
        libraries_of("vax", "f")
    with pytest.raises(Failure, match="needs SUNDIALS for win64; expected the libraries of scripts/package/sundials-all, or another <solver> than erk and bdf"):
        compile_fmu("win64", platforms() / "systems" / "BeadOnHoop" / "system.c", tmp_path, "BeadOnHoop")


# --- lagc ---------------------------------------------------------------------------------------------------------------


def test_lagc_for_windows(tmp_path):
    """lagc under wine writes the same bytes as here for every system."""
    platforms()  # initializes wine's folder
    folder = FOLDER / "lagc-win64"
    compiler = f"{sys.executable};-m;ziglang;cc;-target;x86_64-windows-gnu"
    with alone(FOLDER / "lagc.lock"):
        words = [] if (folder / "CMakeCache.txt").exists() else ["-DCMAKE_SYSTEM_NAME=Windows", f"-DCMAKE_C_COMPILER={compiler}"]
        subprocess.run(["cmake", "-S", ROOT / "scripts" / "package" / "lagc", "-B", folder, *words], check=True, capture_output=True)
        subprocess.run(["cmake", "--build", folder, "--target", "lagc", "--parallel", "2"], check=True, capture_output=True)
    systems = {name: ROOT / "fmu" / name / "system.xml" for name in fmu.all_names()}
    systems |= {name: ROOT / "tests" / "systems" / name / "system.xml" for name in fmu.further_names()}
    lines = [f'"{folder / "lagc.exe"}" "{system}" -o "{tmp_path / "there" / name}"\nif errorlevel 1 exit 1' for name, system in systems.items()]
    (tmp_path / "all.bat").write_text("@echo off\n" + "\n".join(lines).replace("/", "\\"), newline="\r\n")  # starting wine takes seconds
    for _ in range(3):  # on a busy machine wine may fail to start one of them
        result = subprocess.run(["wine", "cmd", "/c", "all.bat"], capture_output=True, text=True, env=ENVIRONMENT, cwd=tmp_path)
        if "Can't recognize" not in result.stderr:
            break
    assert result.returncode == 0, result.stdout + result.stderr
    for name, system in systems.items():
        assert fmu.lagc(system, "-o", tmp_path / "here" / name).returncode == 0
        for file in ("system.c", "modelDescription.xml", "documentation/index.html"):
            assert (tmp_path / "there" / name / file).read_bytes() == (tmp_path / "here" / name / file).read_bytes(), (name, file)
    words = ["--linearize", ROOT / "fmu" / "InvertedPendulumCart" / "system.xml", "--at", "theta=0"]
    printed = subprocess.run(["wine", folder / "lagc.exe", *words], capture_output=True, env=ENVIRONMENT).stdout
    assert printed.decode() == fmu.lagc(*words).stdout
    result = subprocess.run(["wine", folder / "lagc.exe", "missing.xml", "-o", "out"], capture_output=True, text=True, env=ENVIRONMENT, cwd=tmp_path)
    assert result.returncode == 1 and "missing.xml" in result.stderr
