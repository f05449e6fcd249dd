"""The package lagrange_fmu assembled from the source tree, without a wheel, for tests that need no compiler."""

import os
import shutil
import subprocess
import sys

from fmu import LAGC, ROOT

SCRIPTS = ROOT / "scripts"


def assemble(folder):
    """Fill the folder with the contents of the wheel, as copies, since modules look for others beside themselves."""
    package = folder / "lagrange_fmu"
    shutil.copytree(SCRIPTS / "wheel" / "lagrange_fmu", package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(SCRIPTS / "library", package, ignore=shutil.ignore_patterns("__pycache__"), dirs_exist_ok=True)
    for part in ("bin", "runtime/scripts/package", "runtime/scripts/requirements"):
        (package / part).mkdir(parents=True)
    files = {"reference.md": ROOT / "fmu" / "README.md", "bin/lagc": LAGC}
    for name in ("package/cross.py", "package/one_file.py", "package/pack.py", "requirements/platforms.txt"):
        files[f"runtime/scripts/{name}"] = SCRIPTS / name
    for part in ("include", "src/runtime", "src/ensemble"):
        shutil.copytree(ROOT / part, package / "runtime" / part)
    for name, source in files.items():
        shutil.copy(source, package / name)
    information = folder / "lagrange_fmu-1.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: lagrange-fmu\nVersion: 1\n")
    return folder


def environment(folder):
    return os.environ | {"PYTHONPATH": str(folder)}


def python(folder, *words, cwd):
    return subprocess.run([sys.executable, *map(str, words)], env=environment(folder), cwd=cwd, capture_output=True, text=True)


def run(folder, *words, cwd):
    """Run the command of an assembled package."""
    return python(folder, "-m", "lagrange_fmu", *words, cwd=cwd)
