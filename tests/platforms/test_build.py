"""Builds: reproducible bytes, a GUID from the content, and the C interface of the standard."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest

import fmu
from fmu import BUILD, ROOT, lagc

pytestmark = pytest.mark.release

NAMES_OF_TARGETS = ("all", "lagc", "solvers", "test", "SimplePendulum_fmu")
OFFICIAL = Path(fmpy.__file__).parent / "c-code"


def test_the_same_input_gives_the_same_bytes(tmp_path):
    """Another folder and another build give the same archives. Folder and systems may have any name."""
    source = tmp_path / "else where, over there"
    for folder in ("fmu", "include", "modelDescription", "scripts", "src", "tests"):
        shutil.copytree(ROOT / folder, source / folder)
    for file in ("CMakeLists.txt", "LICENSE"):
        shutil.copy(ROOT / file, source)
    if (ROOT / "build" / "sundials").exists():
        shutil.copytree(ROOT / "build" / "sundials", source / "build" / "sundials")
    systems = tmp_path / "systems"
    for name in ("SimplePendulum", "ElasticPendulum", "SimplePendulumLinear"):
        shutil.copytree(ROOT / "fmu" / name, systems / name)
    for name in NAMES_OF_TARGETS:
        (systems / name).mkdir()
        (systems / name / "system.xml").write_text(f'<system\n  name="{name}"><input name="u"/><output name="y">u</output></system>')
    subprocess.run([source / "scripts" / "build", "build", f"-DSYSTEMS={systems}", "-DFMI_VERSIONS=2;3"], check=True)
    for name in ("SimplePendulum", "ElasticPendulum", "SimplePendulumLinear"):
        for version in ("fmu", "fmi3"):
            again, first = (folder / version / f"{name}.fmu" for folder in (source / "build", BUILD))
            assert again.read_bytes() == first.read_bytes(), first
    for name in NAMES_OF_TARGETS:
        assert fmpy.read_model_description(source / "build" / "fmu" / f"{name}.fmu").modelName == name
    assert "-Werror" not in (source / "build" / "compile_commands.json").read_text()


def guid(system, folder):
    (folder / "system.xml").write_text(system)
    assert lagc("system.xml", "-o", "out", cwd=folder).returncode == 0
    description = (folder / "out" / "modelDescription.xml").read_text()
    code = (folder / "out" / "system.c").read_text()
    found = re.search(r'guid="(\{[0-9a-f-]{36}\})"', description).group(1)
    assert f'#define GUID "{found}"' in code
    return found


def test_guid_follows_the_content(tmp_path):
    text = (ROOT / "fmu" / "SimplePendulum" / "system.xml").read_text()
    original = guid(text, tmp_path)
    assert guid(text, tmp_path) == original
    assert guid(text.replace("\n", "\n\n"), tmp_path) == original, "blank lines are no content"
    changes = [("m*g*l*(1", "m*g*l*(2"), ('start="9.81"', 'start="9.82"'), ('"mass of the bob"', '"mass"'), ("1e-10", "1e-9")]
    assert len({guid(text.replace(*change), tmp_path) for change in changes} | {original}) == 5


def test_guids_differ():
    assert len({fmu.description(name).guid for name in fmu.all_names()}) == len(fmu.all_names())


@pytest.mark.parametrize("start", ["<system name=", "<system\n  name=", "<system name = ", "<!-- <system name='Other'> --><system name="])
def test_folder_name_must_match(start, tmp_path):
    """The name must match however it is written; lagc of the existing build is used."""
    folder = tmp_path / "Other"
    assert lagc("-o", folder, system_file(tmp_path, f'{start}"Mine"><input name="u"/><output name="y">u</output></system>')).returncode == 0
    words = [sys.executable, "-m", "scripts.package.pack", "fmu", folder, "2", tmp_path / "Other.fmu", "--libraries", folder / "Other.so"]
    words += ["--names", "none", "--licenses", "none", "--system", "Other/system.xml"]
    result = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert result.returncode != 0
    assert "Other/system.xml: the system is named 'Mine'; expected 'Other', as its folder or lagrange_add_fmu() names it" in " ".join(result.stderr.split())


def system_file(folder, text):
    (folder / "system.xml").write_text(text)
    return folder / "system.xml"


def test_folder_that_is_no_name(tmp_path):
    shutil.copytree(ROOT / "fmu" / "SimplePendulum", tmp_path / "systems" / "My pendulum")
    words = ["cmake", "-S", ROOT, "-B", tmp_path / "build", f"-DSYSTEMS={tmp_path / 'systems'}"]
    result = subprocess.run(words, capture_output=True, text=True)
    message = "the folder is named 'My pendulum'; expected the system's name, of letters, digits and _"
    assert result.returncode != 0 and message in " ".join(result.stderr.split())


@pytest.mark.parametrize("header", ["fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"])
def test_official_headers_are_there(header):
    assert (OFFICIAL / header).exists()


def test_interface_matches_the_official_headers(tmp_path):
    """This project's declarations and the official ones in one file: a difference is a compiler error."""
    ours = (ROOT / "include" / "fmi2.h").read_text()
    functions = re.findall(r"FMI2_EXPORT .*?\b(fmi2\w+)\(", ours)
    official = (OFFICIAL / "fmi2Functions.h").read_text()
    assert set(functions) == set(re.findall(r"FMI2_Export fmi2\w+TYPE\s+(fmi2\w+);", official))
    # The official types keep their names; this project's are renamed, and must be the same types.
    enumerations = re.findall(r"typedef enum \{(.*?)\} (\w+);", ours, re.S)
    renamed = re.sub(r"\bfmi2(\w+)", r"own2\1", ours).replace("FMI2_H", "OWN2_H").replace("FMI2_EXPORT", "OWN2_EXPORT")
    lines = ["#include <stddef.h>", '#include "fmi2Functions.h"', '#include "own2.h"']
    for values, name in enumerations:
        for value in re.findall(r"fmi2\w+", values):
            lines.append(f'_Static_assert((int){value} == (int)own2{value[4:]}, "{value}");')
    for name in ("Component", "ComponentEnvironment", "FMUstate", "ValueReference", "Real", "Integer", "Boolean", "Char",
                 "String", "Byte"):
        lines.append(f"extern fmi2{name} v{name}; extern own2{name} v{name};")
    for structure, fields in (
        ("CallbackFunctions", ["logger", "allocateMemory", "freeMemory", "stepFinished", "componentEnvironment"]),
        ("EventInfo", ["newDiscreteStatesNeeded", "terminateSimulation", "nominalsOfContinuousStatesChanged",
                       "valuesOfContinuousStatesChanged", "nextEventTimeDefined", "nextEventTime"]),
    ):
        lines.append(f'_Static_assert(sizeof(fmi2{structure}) == sizeof(own2{structure}), "{structure}");')
        for field in fields:
            lines.append(
                f"_Static_assert(offsetof(fmi2{structure}, {field}) == offsetof(own2{structure}, {field}), "
                f'"{field}");'
            )
    (tmp_path / "own2.h").write_text(renamed)
    (tmp_path / "check.c").write_text("\n".join(lines) + "\n")
    words = ["gcc", "-std=c11", "-Wall", "-Werror", "-fsyntax-only", f"-I{OFFICIAL}", f"-I{tmp_path}"]
    result = subprocess.run([*words, tmp_path / "check.c"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr


RUNTIME = ROOT / "src" / "runtime"


def test_the_core_of_the_runtime_is_independent_of_fmi():
    """The versions of FMI are layers above the runtime's core, each in its own folder."""
    sources = [path for path in RUNTIME.rglob("*.[ch]") if not re.fullmatch("fmi[23]", path.parent.name)]
    assert len(sources) > 20
    assert [path.name for path in sources if re.search("fmi[23]", path.read_text())] == []


@pytest.mark.parametrize("source", sorted(RUNTIME.glob("fmi[23]/*.c")), ids=lambda path: path.name)
def test_runtime_compiles_against_the_official_headers(source, tmp_path):
    """A definition that differs from the official declaration is a compiler error."""
    version = source.parent.name
    (tmp_path / f"{version}.h").write_text(f'#include "{version}Functions.h"\n')
    folders = [tmp_path, OFFICIAL, RUNTIME, ROOT / "include"]  # the official headers come before those of this project
    words = ["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", *(f"-I{folder}" for folder in folders)]
    result = subprocess.run([*words, source], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr


def test_source_tree_stays_clean():
    """All build products are in build/."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a clone")
    status = subprocess.run(["git", "status", "--porcelain", "--ignored"], cwd=ROOT, capture_output=True, text=True)
    ignored = {line[3:] for line in status.stdout.splitlines() if line.startswith("!!")}
    allowed = re.compile(r"^(build/|\.pytest_cache/|\.hypothesis/|(tests|scripts)(/\w+)*/__pycache__/)$")
    assert all(allowed.match(path) for path in ignored), ignored


