"""Every FMU under sanitizers and under valgrind: no leak, no undefined behaviour, no race between threads."""

import os
import subprocess

import pytest

import fmu
from fmu import BUILD, ROOT

SANITIZED = BUILD / "sanitized"
CLEAN = {"ASAN_OPTIONS": "detect_leaks=1", "UBSAN_OPTIONS": "print_stacktrace=1"}


def words_for(name, build):
    description = fmu.description(name)
    reals = sum(variable.type == "Real" for variable in description.modelVariables)
    library = build / "systems" / name / "binaries" / "linux64" / f"{name}.so"
    return [build / "bin" / "drive", library, description.guid, str(reals), str(len(fmu.states_of(name)))]


def run(words, **environment):
    result = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **environment}, timeout=300)
    assert result.returncode == 0, result.stdout + result.stderr
    return result


def test_threads(name):
    """8 threads with 8 instances each, under ThreadSanitizer."""
    words = words_for(name, BUILD / "threads")
    run([BUILD / "threads" / "bin" / "threads", words[1], words[2]])


def test_life_under_sanitizers(name):
    run(words_for(name, SANITIZED), **CLEAN)


def test_life_under_valgrind(name):
    flags = ["--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all", "--errors-for-leak-kinds=all", "-q"]
    run(["valgrind", *flags, *words_for(name, BUILD)])


@pytest.mark.parametrize("system", sorted((ROOT / "fmu").glob("*/system.xml")), ids=lambda path: path.parent.name)
def test_lagc_under_sanitizers(system, tmp_path):
    run([SANITIZED / "bin" / "lagc", system, "-o", tmp_path], **CLEAN)


BROKEN = [
    "",
    "<system/>",
    "<system name='A'><coordinate name='q' velocity='v'/><potential>q^</potential></system>",
    "<system name='A'><for index='i' from='1' to='3'><coordinate name='q[i]' velocity='v'/></for></system>",
    "<system name='A'><potential>" + "(" * 3000 + "</potential></system>",
    "<linearization of='system.xml' name='B'/>",
    "<system name='A'><coordinate name='q' velocity='v'/><particle mass='1' x='q^0.5^q'/>"
    "<force coordinate='q'>sum(i, 1, 30, der(q)^i)</force></system>",
]


@pytest.mark.parametrize("text", BROKEN)
def test_lagc_refuses_under_sanitizers(text, tmp_path):
    (tmp_path / "system.xml").write_text(text)
    words = [SANITIZED / "bin" / "lagc", tmp_path / "system.xml", "-o", tmp_path / "out"]
    result = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **CLEAN}, timeout=60)
    assert result.returncode in (0, 1) and "Sanitizer" not in result.stderr, result.stderr
