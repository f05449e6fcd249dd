"""An FMU contains only what its system needs, by the linker's map and the library's symbols."""

import re
import subprocess

import pytest

import fmu
from fmu import BUILD
from linked import linked_members

EXACT = ["Motor", "ParticleCartesian", "SimplePendulumLinear", "InvertedPendulumCartLinear", "InvertedPendulumCartTorqueLinear"]
NONE = ["StateFeedback", "SpringDamper"]
AUTO = ["BristleFriction", "DampedPendulum", "DigitalServo", "ElasticPendulum", "FlyballGovernor", "FourBar", "GantryCrane", "Gyrocompass", "HalfCar", "HangingCable",
        "HydraulicCylinder", "MotorPendulum", "RobotArm", "Rope", "SeatSuspension", "SpinningBeam", "WormGear"]  # fmt: skip
LARGE = ["Rope"]  # equations as tables, and a sparse Jacobian
CHAINS = ["Bricard", "RobotArm"]  # bodies in space, with five or six joints
BEAMS = ["HangingCable", "SpinningBeam"]  # energies that are integrals
TABLES = LARGE + CHAINS + BEAMS  # their series are tables, which always receive time
TIMED = ["BristleFriction", "DigitalServo", "Gyrocompass", "HalfCar", "RotatingPivotPendulum", "SpinningBeam", "VibratingTable"]
FACTORED = ["ChainPendulum", "HangingCable", "RobotArm", "SpinningBeam"]  # by a loop, since their mass matrices are full and large
LONG = ["HangingCable", "NFourBar", "Rope"]  # many coordinates
ERK = ["BeadOnHoop"]  # of tests/systems
BDF = ["FurutaPendulum"]


def output_of(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def test_exported_symbols(name):
    """The library exports every fmi2 function, and nothing else."""
    symbols = output_of("nm", "-D", "--defined-only", fmu.library(name)).split("\n")
    exported = {line.split()[-1] for line in symbols if line}
    header = (fmu.ROOT / "include" / "fmi2.h").read_text()
    assert exported == set(re.findall(r"FMI2_EXPORT .*?\b(fmi2\w+)\(", header)) and len(exported) == 44


def test_needed_libraries(name):
    needed = set(re.findall(r"NEEDED.*\[(.*)\]", output_of("readelf", "-d", fmu.library(name))))
    assert needed <= {"libm.so.6", "libc.so.6"}


@pytest.mark.parametrize("name", fmu.all_names() + ERK + BDF)
def test_no_memory_of_its_own(name):
    """All memory comes from the caller's functions, including that of SUNDIALS."""
    assert not re.findall(r"\b(?:malloc|calloc|realloc|free)\b", output_of("nm", "-D", fmu.library(name)))


def test_is_stripped(name):
    assert ".symtab" not in output_of("readelf", "-SW", fmu.library(name))


def test_no_path_of_this_machine_is_in_it(name):
    assert str(fmu.ROOT).encode() not in fmu.library(name).read_bytes()


@pytest.mark.parametrize("name", fmu.all_names() + ERK + BDF)
def test_only_the_solver_that_is_needed(name):
    members = " ".join(linked_members(name))
    text = fmu.library(name).read_bytes()
    assert "xml" not in members and b"libxml" not in text
    if name not in BDF + ERK:
        assert "sundials" not in members and "SUN" not in members and b"SUNDIALS" not in text
    elif name in BDF:
        assert "libsundials_cvode" in members and "libsundials_arkode" not in members
        assert [word in members for word in ("sunlinsolklu", "sunmatrixsparse")] == [False, False]
        assert [word in members for word in ("sunlinsoldense", "sunmatrixdense")] == [True, True]
    else:
        assert "libsundials_arkode" in members
        for needless in ("libsundials_cvode", "sunlinsoldense", "sunmatrixdense", "arkode_arkstep", "arkode_mristep"):
            assert needless not in members
    solvers = set(re.findall(r"libsolvers\.a\((taylor|erk|bdf|bdf_sparse|exact|auto|radau|stiffness|lu_\w+)\.c\.o", members))
    expected = {method for method, names in (("exact", EXACT), ("bdf", BDF), ("erk", ERK)) if name in names} or {"taylor"}
    if name in AUTO:
        expected = {"auto", "taylor", "radau", "stiffness", "lu_sparse" if name in LARGE else "lu_dense"}
    assert solvers == (set() if name in NONE else expected)
    assert ("ldlt.c.o" in members) == (name in FACTORED + LARGE or fmu.is_constrained(name))
    assert ("saddle.c.o" in members) == ("projection.c.o" in members) == fmu.is_constrained(name)


def test_the_optimised_sundials():
    """FMUs link the SUNDIALS of scripts/package/sundials if it exists."""
    is_there = (fmu.ROOT / "build" / "sundials" / "version").exists()
    text = (BUILD / "test-systems" / "systems" / "FurutaPendulum" / "link.map").read_text()
    assert ("sundials/lib/libsundials_cvode.a" in text) == is_there


def test_generated_code_has_only_the_functions_needed(name):
    """The code has no input code without inputs, no time unless it is used, and no Jacobian unless the solver needs one."""
    code = (BUILD / "systems" / name / "system.c").read_text()
    assert ("point->input" in code) == bool(fmu.names_of(name, "input"))
    assert ("point->time" in code) == (name in TIMED + TABLES)
    assert ("int jacobian(" in code) == (name in AUTO)
    assert ("void linear(" in code) == (name in EXACT)
    assert ("void series(" in code) == (name not in EXACT + NONE)
    assert ("int derivatives(" in code) == (name not in NONE)
    assert ("ldlt_factor(" in code) == (name in FACTORED)


def test_one_degree_of_freedom_is_a_division():
    code = (BUILD / "systems" / "SimplePendulum" / "system.c").read_text()
    operations = int(re.search(r"d state / dt; (\d+) operations", code).group(1))
    assert operations <= 5


def test_constant_mass_matrix_is_factored_once():
    """prepare() computes the reciprocals of the particle's masses, so that evaluations do not divide."""
    code = (BUILD / "systems" / "ParticleCartesian" / "system.c").read_text()
    body = re.search(r"static int derivatives\(.*?^}", code, re.S | re.M).group()
    assert "/" not in re.sub(r"/\*.*?\*/", "", body)


def test_blocks_are_solved_separately():
    """Two carts and one driven mass are solved as two 2 x 2 blocks and one division, without a 5 x 5 elimination."""
    code = (BUILD / "test-systems" / "systems" / "TwoCarts" / "system.c").read_text()
    assert "ldlt_factor" not in code
    operations = int(re.search(r"d state / dt; (\d+) operations", code).group(1))
    assert operations < 60


def test_sizes(name, check_size):
    """The tests print the sizes at their end, too."""
    check_size(name, "archive", fmu.archive(name).stat().st_size)
    check_size(name, "library", fmu.library(name).stat().st_size)


@pytest.mark.parametrize(
    "force, solver",
    [
        ("u*sin(q)", "auto"), ("u - abs(w)*w", "auto"), ("-sign(w)", "taylor"), ("sin(asin(q/9))", "taylor"), ("sin(time) - q^3", "taylor"),
        ("asin(sin(q))", "erk"), ("asin(cos(q))", "erk"), ("acos(cos(q))", "erk"), ("atan(tan(q))", "erk"), ("acosh(cosh(q))", "erk"),
    ],  # fmt: skip
)
def test_default_solver(force, solver, tmp_path):
    """The default is Taylor series for equations that have them, and a method that steps across jumps otherwise."""
    (tmp_path / "system.xml").write_text(
        '<system name="Default"><input name="u"/><coordinate name="q" velocity="w"/><particle mass="1" x="q"/>'
        f'<force coordinate="q">{force}</force></system>'
    )
    result = fmu.lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert f".solver = &solver_{solver}," in (tmp_path / "out" / "system.c").read_text()


def test_sizes_of_instances(name, check_size):
    """Memory of an instance after its first step, including the series of all recurrences; no leak between instances."""
    from numerics.footprint import instance_costs

    memory = round(instance_costs(name)[0])
    assert memory > 0
    check_size(name, "instance", memory)


def test_absent_functions():
    from numerics.footprint import absent_features, form

    for name in fmu.all_names():
        absent = absent_features(name, linked_members(name))
        assert form(name) == ("tables" if name in TABLES else "tables, series as statements" if name in LONG else "statements")
        assert ("inputs" in absent) == (not fmu.names_of(name, "input"))
        assert ("Taylor series" in absent) == (name in EXACT + NONE)
        assert "SUNDIALS" in absent and ("any solver" in absent) == (name in NONE)
