"""Every FMU under sanitizers and valgrind: no leak, no undefined behaviour, no data race."""

import os
import re
import subprocess

import pytest

import fmu
from building import alone, build_by_cmake, built_by_tests
from fmu import BUILD, ROOT

SANITIZED = BUILD / "sanitized"
CLEAN = {"ASAN_OPTIONS": "detect_leaks=1", "UBSAN_OPTIONS": "print_stacktrace=1"}


def words_for(name, build):
    description = fmu.description(name)
    types = [variable.type for variable in description.modelVariables]
    reals = next((i for i, kind in enumerate(types) if kind != "Real"), len(types))  # the variables before the first one of another type
    library = build / "systems" / name / "binaries" / "linux64" / f"{name}.so"
    return [build / "bin" / "drive", library, description.guid, str(reals), str(len(fmu.states_of(name)))]


def run(words, **environment):
    result = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **environment}, timeout=300)
    assert result.returncode == 0, result.stdout + result.stderr
    return result


@pytest.mark.parametrize("name", ["SimplePendulum", "ChainPendulum", "ElasticPendulum", "ParticleCartesian", "TwoCarts"])
def test_threads(name):
    """8 threads with 8 instances each run under ThreadSanitizer, for each method and the loops of a large mass matrix."""
    words = words_for(name, BUILD / "threads")
    run([BUILD / "threads" / "bin" / "threads", words[1], words[2]])


@pytest.mark.parametrize("name", fmu.small_names())
def test_life_under_sanitizers(name):
    run(words_for(name, SANITIZED), **CLEAN)


@pytest.mark.parametrize("name", fmu.small_names())
def test_life_under_valgrind(name):
    flags = ["--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all", "--errors-for-leak-kinds=all", "-q"]
    run(["valgrind", *flags, *words_for(name, BUILD)])


def arguments_for_failures(name, build, library):
    output = fmu.references(name)[fmu.names_of(name, "output")[0]]
    return [build / "bin" / "out_of_memory", library, fmu.description(name).guid, str(output)]


@pytest.mark.parametrize("name", fmu.small_names())
def test_every_allocation_fails_once(name):
    """Each allocation fails in turn: the FMU logs a message, leaks nothing, and works after a reset."""
    library = SANITIZED / "systems" / name / "binaries" / "linux64" / f"{name}.so"
    result = run(arguments_for_failures(name, SANITIZED, library), **CLEAN)
    assert int(re.match(r"(\d+) allocations", result.stdout).group(1)) > 5


ROW_OF_SPRINGS = """<system name="{name}">
  <constant name="N" value="{masses}"/>
  <for index="i" from="1" to="N"><coordinate name="q[i]" velocity="v[i]" start="0.1*i"/><particle mass="1" x="q[i]"/></for>
  <for index="i" from="2" to="N"><potential>10*(q[i] - q[i-1])^2 + (q[i] - q[i-1])^4</potential></for>
  <potential>q[1]^2</potential>
  <solver method="{method}"/>
</system>"""
# Number of masses and name of the solver in the code; KLU also allocates during steps.
WITH_SUNDIALS = {"erk": (2, "solver_erk"), "bdf": (2, "solver_bdf"), "bdf_sparse": (40, "solver_bdf_sparse")}


@pytest.fixture(scope="module")
def rows_of_springs():
    texts = {
        f"Row_{solver}": ROW_OF_SPRINGS.format(name=f"Row_{solver}", masses=masses, method=solver.removesuffix("_sparse"))
        for solver, (masses, _) in WITH_SUNDIALS.items()
    }
    with alone(SANITIZED / "rows-of-springs.lock"):
        archives = build_by_cmake(SANITIZED / "rows-of-springs", texts, "-DSANITIZE=address,undefined", tools=SANITIZED)
    built_by_tests.update({name: archives / f"{name}.fmu" for name in texts})


@pytest.mark.parametrize("solver", WITH_SUNDIALS)
def test_every_allocation_of_sundials_fails_once(solver, rows_of_springs):
    name = f"Row_{solver}"
    folder = SANITIZED / "rows-of-springs" / "systems" / name
    assert f"&{WITH_SUNDIALS[solver][1]}," in (folder / "system.c").read_text()
    library = folder / "binaries" / "linux64" / f"{name}.so"
    result = run(arguments_for_failures(name, SANITIZED, library), **CLEAN)
    assert int(re.match(r"(\d+) allocations", result.stdout).group(1)) > 60


@pytest.mark.parametrize("name", fmu.all_names())
def test_lagc_under_sanitizers(name, tmp_path):
    run([SANITIZED / "bin" / "lagc", ROOT / "fmu" / name / "system.xml", "-o", tmp_path], **CLEAN)


BROKEN = [
    "",
    "<system/>",
    "<system name='A'><coordinate name='q' velocity='v'/><potential>q^</potential></system>",
    "<system name='A'><for index='i' from='1' to='3'><coordinate name='q[i]' velocity='v'/></for></system>",
    "<system name='A'><potential>" + "(" * 3000 + "</potential></system>",
    "<linearization of='system.xml' name='B'/>",
]
STRANGE = [
    "<system name='A'><coordinate name='q' velocity='v'/><particle mass='1' x='q^0.5^q'/>"
    "<force coordinate='q'>sum(i, 1, 30, der(q)^i)</force></system>",
    # Symbols of branches arise after the lists of symbols exist.
    "<system name='A'><coordinate name='q' velocity='v'/><particle mass='1' x='q'/><potential>abs(q - 1)</potential>"
    "<output name='y'>der(abs(q)) + der(max(q^3, v))</output></system>",
    "<system name='A'><coordinate name='q' velocity='v'/><displacement name='s'/><particle mass='1' x='q + s'/>"
    "<potential>abs(q + s) + abs(q - 1 + s) + abs(q - 3)*s</potential></system>",
]


@pytest.mark.parametrize("text, code", [(text, 1) for text in BROKEN] + [(text, 0) for text in STRANGE])
def test_lagc_of_odd_files_under_sanitizers(text, code, tmp_path):
    (tmp_path / "system.xml").write_text(text)
    words = [SANITIZED / "bin" / "lagc", tmp_path / "system.xml", "-o", tmp_path / "out"]
    result = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **CLEAN}, timeout=60)
    assert result.returncode == code and "Sanitizer" not in result.stderr, result.stderr
