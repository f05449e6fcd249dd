"""
Plants many mutants in one copy of the project, which is built once.

A function with mutants has the body of each beside its own, and the environment variable PLANTED_FAULT chooses one. Mutants that do not
compile are left out before. So are equivalent ones, which give the same object code.
"""

import functools
import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

from mutations import bodies_of, body_of, mutated

ROOT = Path(__file__).resolve().parents[2]
TREE = ROOT / "build" / "faults"
# The first function returns 1 for the chosen mutant. The second one notes that a function is called, as a file in the folder
# PLANTED_REACHED. Their names are unique, since an FMU may be built of one file with all sources.
CHOICE = """\
#include <stdio.h>
#include <stdlib.h>
static int {name}(int mutant) {{
  static int chosen = -1;
  if (chosen < 0) {{
    const char *text = getenv("PLANTED_FAULT");
    chosen = text ? atoi(text) : 0;
  }}
  return mutant == chosen;
}}
static void {name}_calls(int function) {{
  const char *folder;
  static unsigned char noted[{count}];
  char path[4096];
  if (noted[function]) return;
  noted[function] = 1;
  folder = getenv("PLANTED_REACHED");
  if (!folder) return;
  snprintf(path, sizeof path, "%s/{name}.%d", folder, function);
  FILE *file = fopen(path, "w");
  if (file) fclose(file);
}}
"""


def copy_project():
    """Copy the files of the project that differ from those in the copy, and remove others. Return a digest of all files."""
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    files = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    files = sorted(file for file in files if (ROOT / file).is_file())
    for file in files:
        target = TREE / file
        if not target.exists() or target.read_bytes() != (ROOT / file).read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / file, target)
            shutil.copymode(ROOT / file, target)
    for folder in ("src", "modelDescription", "include", "fmu", "tests", "scripts"):
        for path in (TREE / folder).rglob("*"):
            if path.is_file() and not (ROOT / path.relative_to(TREE)).exists():
                path.unlink()
    (TREE / "build").mkdir(exist_ok=True)
    for name in ("venv", "sundials"):
        if not (TREE / "build" / name).exists() and (ROOT / "build" / name).exists():
            (TREE / "build" / name).symlink_to((ROOT / "build" / name).resolve())
    return hashlib.sha256(b"".join(file.encode() + (ROOT / file).read_bytes() for file in files)).hexdigest()


@functools.cache
def text_of(file):
    """Bytes of a source, as they were when the program first read them."""
    return (ROOT / file).read_bytes()


def run(*words):
    result = subprocess.run(words, cwd=TREE, capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"{' '.join(words)} fails in {TREE}:\n{result.stdout}{result.stderr}")


def configure():
    run("cmake", "-S", ".", "-B", "build", "-USYSTEMS", "-DBUILD_TESTS=ON", "-DFMI_VERSIONS=2;3")


def build():
    """Build lagc, the runtime, the FMUs and the tests in C."""
    run("scripts/build", "build")
    run("scripts/build", "build/test-systems", f"-DSYSTEMS={TREE}/tests/systems", f"-DTOOLS={TREE}/build")


def compile_commands():
    """Return the words of the command that compiles each source, by the path of the source."""
    entries = json.loads((TREE / "build" / "compile_commands.json").read_text())
    return {os.path.relpath(entry["file"], TREE): (shlex.split(entry["command"]), entry["directory"]) for entry in entries}


def object_of(file, text, command):
    """Return the object code of a source that has another text, or None if it does not compile."""
    words, folder = command
    with tempfile.NamedTemporaryFile(suffix=".o") as output:
        output_words = [output.name if before == "-o" else word for before, word in zip(["", *words], words)]
        source = next(i for i, word in enumerate(output_words) if word.endswith(file))
        output_words[source : source + 1] = ["-w", "-iquote", str((ROOT / file).parent), "-x", "c", "-"]
        compiled = subprocess.run(output_words, cwd=folder, input=text, capture_output=True).returncode == 0
        return output.read() if compiled else None


def kind_of(file, mutant, commands, originals={}):
    """Return "mutant", "equivalent" or "does not compile"; None for a source that this build does not compile."""
    if file not in commands:
        return None
    if file not in originals:
        originals[file] = object_of(file, text_of(file), commands[file])
    code = object_of(file, mutated(text_of(file), mutant), commands[file])
    return "does not compile" if code is None else "equivalent" if code == originals[file] else "mutant"


def name_in(file):
    return f"planted_{zlib.crc32(file.encode()):x}"


def function_of(file, mutant):
    """Name of the file that notes a call of the mutant's function."""
    return f"{name_in(file)}.{bodies_of(text_of(file)).index(mutant.body)}"


def planted_text(file, source, mutants):
    """Return a source that notes the calls of its functions, with its mutants, given by their numbers from 1."""
    name, functions, bodies = name_in(file), {}, bodies_of(source)
    for number, mutant in mutants.items():
        functions.setdefault(mutant.body, []).append((number, mutant))
    for index, (start, end) in sorted(enumerate(bodies), reverse=True):
        choices = b"".join(
            f"if ({name}({number})) ".encode() + body_of(source, mutant) + b"\nelse " for number, mutant in functions.get((start, end), [])
        )
        source = source[:start] + f"{{{name}_calls({index});".encode() + choices + source[start:end] + b"}" + source[end:]
    return CHOICE.format(name=name, count=len(bodies) + 1).encode() + b"#line 1\n" + source


def plant(files, chosen):
    """Write the sources with the chosen mutants, (file, mutant), into the copy. Their numbers count from 1."""
    for file in files:
        text = planted_text(file, text_of(file), {number: mutant for number, (other, mutant) in enumerate(chosen, 1) if other == file})
        if (TREE / file).read_bytes() != text:
            (TREE / file).write_bytes(text)
