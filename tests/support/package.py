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
    shutil.copytree(SCRIPTS / "live_page", package / "live_page", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(SCRIPTS / "show_equations", package / "show_equations", ignore=shutil.ignore_patterns("__pycache__"))
    (package / "bin").mkdir()
    (package / "runtime" / "scripts").mkdir(parents=True)
    files = {f"{module}.py": SCRIPTS / f"{module}.py" for module in ("co_simulation", "ensembles", "exchange", "feedback", "named_values", "picture", "problem", "progress", "quantities", "signals", "simulation", "sweep_records", "sweep_arguments", "sweep_worker", "sweeping", "variables", "whole_files")}
    files |= {"reference.md": ROOT / "fmu" / "README.md", "bin/lagc": LAGC, "runtime/scripts/cross.py": SCRIPTS / "cross.py"}
    files |= {"runtime/scripts/one_file.py": SCRIPTS / "one_file.py"}
    files |= {"runtime/scripts/sweep_runs.c": SCRIPTS / "sweep_runs.c"}
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
