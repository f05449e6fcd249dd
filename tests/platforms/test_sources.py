"""FMUs without SUNDIALS contain their sources, from which FMPy builds them."""

import re
import shutil
import subprocess

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from lxml import etree

from scripts.checks import clashes
import fmi3
import fmu
from building import runtime
from fmu import BUILD, ROOT, complaints_about

pytestmark = pytest.mark.long

WITH_SOURCES = fmu.all_names()


def test_who_has_sources(name):
    folder = fmu.unpacked(name) / "sources"
    assert folder.exists() == (name in WITH_SOURCES)
    if name not in WITH_SOURCES:
        return
    root = etree.parse(fmu.unpacked(name) / "modelDescription.xml").getroot()
    for section in ("ModelExchange", "CoSimulation"):
        listed = [file.get("name") for file in root.findall(f"{section}/SourceFiles/File")]
        assert listed == [path.name for path in folder.iterdir()] == [f"{name}.c"]


@pytest.mark.parametrize("name", ["InvertedPendulumCartLinear", "ChainPendulum", "StateFeedback"])
def test_fmpy_builds_the_sources(name, tmp_path):
    folder = tmp_path / name
    shutil.copytree(fmu.unpacked(name), folder)
    shutil.rmtree(folder / "binaries")
    build_platform_binary(folder)
    assert (folder / "binaries" / "linux64" / f"{name}.so").exists()
    built, packed = (
        fmpy.simulate_fmu(str(path), stop_time=2, output_interval=0.1, fmi_type="CoSimulation")
        for path in (folder, fmu.unpacked(name))
    )
    for output in packed.dtype.names:
        # Another compiler option may contract a * b + c, which changes rounding only.
        np.testing.assert_allclose(built[output], packed[output], rtol=1e-9, atol=1e-12)


def source_of(name):
    return fmu.unpacked(name) / "sources" / f"{name}.c"


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_sources_are_plain_c11(compiler):
    """The sources compile without extensions of the compiler, with all warnings."""
    for name in WITH_SOURCES:
        if compiler == "gcc" or name in fmu.OF_EACH_KIND:
            assert complaints_about(source_of(name), compiler) == ""
        assert str(ROOT) not in source_of(name).read_text()


@pytest.mark.parametrize("version", [2, 3])
def test_no_names_of_the_runtime_clash(version):
    """Names do not clash, whichever part of the runtime a system uses; the names that lagc generates are checked too."""
    unit = clashes.unit(version)
    assert clashes.complaints(unit) == ""
    assert "'rests_on' redeclared" in clashes.complaints(unit + "static const int rests_on[] = {0};\n").replace("‘", "'").replace("’", "'")
    assert {"rests", "variables", "derivatives", "lu_slot", "switching_values"} <= set(clashes.generated_names())


# Systems and lagc's arguments that select different files of the runtime; FMI 2.0 and 3.0 alternately.
KINDS = [
    *(("StickSlip", "--solver", method) for method in ("taylor", "erk", "bdf", "radau", "auto")),
    ("BouncingBall",),
    ("FourBar", "--form", "tables"),
    ("FlyballGovernor", "--form", "statements"),
    ("SimplePendulumLinear",),
    ("StateFeedback",),
    ("WormGear",),
    ("HydraulicCylinder",),
]


@pytest.mark.release
@pytest.mark.parametrize("name", fmu.all_names())
def test_sources_in_the_fmu_need_only_libm(name, tmp_path):
    if fmu.description(name).coSimulation is None or not source_of(name).exists():
        pytest.skip("the solver is a library")
    words = ["gcc", "-std=c11", "-O0", "-fPIC", "-shared", "-Wl,--no-undefined", source_of(name), "-lm", "-o", tmp_path / "fmu.so"]
    assert subprocess.run(words, capture_output=True, text=True).stderr == ""


@pytest.mark.parametrize("kind", KINDS, ids=" ".join)
def test_one_file_is_complete(kind, tmp_path):
    """The runtime files that lagc includes, as for other platforms and packages, are complete, and no names clash."""
    system, *words = kind
    assert fmu.lagc(ROOT / "fmu" / system / "system.xml", "-o", tmp_path, *words).returncode == 0
    version = 2 + KINDS.index(kind) % 2
    layer = [word for file in (ROOT / "src" / "runtime" / f"fmi{version}").glob("*.c") for word in ("-include", file)]
    libraries = [word for word in runtime(version) if not str(word).endswith(".o") and word != BUILD / "libsolvers.a"]
    headers = [f"-I{folder}" for folder in (ROOT / "include", ROOT / "src" / "runtime")]
    headers += [f"-isystem{folder}" for folder in (ROOT / "build" / "sundials" / "include", "/usr/include/suitesparse")]
    compiled = ["gcc", "-std=c11", "-O0", "-fPIC", "-shared", "-DFMU_IN_ONE_FILE", *headers, *layer, tmp_path / "system.c"]
    result = subprocess.run([*compiled, *libraries, "-Wl,--no-undefined", "-o", tmp_path / "fmu.so"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr[:2000]


def global_names(source, folder, *words):
    subprocess.run(["gcc", "-std=c11", "-O0", *words, "-c", source, "-o", folder / "fmu.o"], check=True)
    symbols = subprocess.run(["nm", "-g", "--defined-only", folder / "fmu.o"], capture_output=True, text=True).stdout
    return [line.split()[-1] for line in symbols.splitlines()]


def test_global_names_are_those_of_the_fmu(tmp_path):
    """FMI 2.0.4, section 2.1.1: sources of several FMUs may be linked into one program."""
    for name in ("SimplePendulum", "SimplePendulumLinear", "StateFeedback", "ChainPendulum"):
        defined = global_names(source_of(name), tmp_path)
        assert f"{name}_fmi2DoStep" in defined and f"{name}_fmi2_instance_create" in defined
        assert [symbol for symbol in defined if not symbol.startswith(f"{name}_")] == []


@pytest.mark.parametrize("version", [2, 3])
def test_functions_of_a_shared_library_have_no_prefix(version, tmp_path):
    """As in the official headers, and if CMake declares a shared library of the FMU's name; an explicit prefix takes precedence."""
    name = "SimplePendulum"
    source, function = {2: fmu, 3: fmi3}[version].unpacked(name) / "sources" / f"{name}.c", f"fmi{version}DoStep"
    for prefix, *words in [(f"{name}_",), ("", f"-DFMI{version}_OVERRIDE_FUNCTION_PREFIX"), ("", f"-D{name}_EXPORTS"), ("My_", f"-DFMI{version}_FUNCTION_PREFIX=My_")]:
        assert [symbol for symbol in global_names(source, tmp_path, *words) if symbol.endswith(function)] == [prefix + function]


@pytest.mark.parametrize("names", [("SimplePendulum", "DoublePendulum"), ("SimplePendulumLinear", "SimplePendulum")])
def test_two_fmus_in_one_program(names, tmp_path, open_fmu):
    """Stepped alternately, each gives the results of its shared library."""
    program = tmp_path / "program"
    objects = [tmp_path / f"{name}.o" for name in names]
    for name, compiled in zip(names, objects):
        subprocess.run(["gcc", "-std=c11", "-O0", "-c", source_of(name), "-o", compiled], check=True)
    main = [ROOT / "tests" / "c" / "two_in_one.c", f"-DFIRST={names[0]}", f"-DSECOND={names[1]}", f"-I{ROOT}/include"]
    subprocess.run(["gcc", *main, *objects, "-o", program, "-lm"], check=True)
    steps, size = 20, 0.05
    guids = [fmu.description(name).guid for name in names]
    lines = subprocess.run([program, *guids, str(steps), str(size)], capture_output=True, text=True, check=True).stdout
    for name, line in zip(names, lines.splitlines()):
        instance = open_fmu(name).initialize()
        for i in range(steps):
            instance.fmu.doStep(i * size, size)
        np.testing.assert_allclose([float(word) for word in line.split()], instance.fmu.getReal([0, 1]), rtol=1e-9)


@pytest.mark.parametrize("name", ["FourBar", "StickSlip"])
def test_both_versions_in_one_program(name, tmp_path):
    """The sources for FMI 2.0 and for FMI 3.0 share no global name."""
    main = f"""
        #include <stdio.h>
        const char *{name}_fmi2GetVersion(void), *{name}_fmi3GetVersion(void);
        int main(void) {{ return printf("%s %s", {name}_fmi2GetVersion(), {name}_fmi3GetVersion()) < 0; }}"""
    (tmp_path / "main.c").write_text(main)
    sources = [module.unpacked(name) / "sources" / f"{name}.c" for module in (fmu, fmi3)]
    objects = [tmp_path / "2.o", tmp_path / "3.o"]
    for source, compiled in zip(sources, objects):
        subprocess.run(["gcc", "-std=c11", "-O0", "-c", source, "-o", compiled], check=True)
    subprocess.run(["gcc", tmp_path / "main.c", *objects, "-o", tmp_path / "program", "-lm"], check=True)
    assert subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True).stdout == "2.0 3.0"


def rejects_fast_math(source, compiler, option):
    headers = [f"-I{ROOT / folder}" for folder in ("include", "src/runtime")]
    words = [compiler, "-std=c11", "-O2", "-E", "-o", "/dev/null", *headers, source, option]
    result = subprocess.run(words, capture_output=True, text=True)
    return result.returncode != 0 and "these sources need IEEE 754 arithmetic" in result.stderr


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("option", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_fast_math_is_an_error(compiler, option):
    """Fast-math removes checks for nonfinite values and compensated summation."""
    assert rejects_fast_math(source_of("SimplePendulum"), compiler, option)


def test_fast_math_is_an_error_in_every_source():
    sources = [path for path in (ROOT / "src" / "runtime").rglob("*.c") if not re.search("sundials|erk|bdf", path.name)]
    assert len(sources) > 20
    assert [source.name for source in sources if not rejects_fast_math(source, "gcc", "-ffast-math")] == []


def test_only_functions_of_every_c_library():
    """Windows' C library lacks some functions of C11 and of POSIX, so FMUs, ensembles and sweeps use none of them."""
    missing = r"\b(aligned_alloc|posix_memalign|memalign|strndup|strdup|asprintf|clock_gettime|gmtime_r|random)\("
    files = [path for room in ("src/runtime", "src/ensemble", "include") for path in (ROOT / room).rglob("*.[ch]")]
    used = {str(path): found for path in [*files, ROOT / "scripts" / "library" / "sweeping" / "single_runs.c"] if (found := re.findall(missing, path.read_text()))}
    assert len(files) > 100 and used == {}
