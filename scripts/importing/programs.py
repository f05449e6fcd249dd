"""
Simulate FMUs in importers that are programs on the PATH, with functions as in packages.py.

Each program writes a CSV file, whose last row has the results. The options are those of the programs' manuals.
"""

import csv
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from importing.packages import BOTH, STEP, TOLERANCE


def last_row(path, delimiter=","):
    """Return the values of the last row by the names of columns, without units."""
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file, delimiter=delimiter) if row]
    names = [re.sub(r"\s*\[[^\]]*\]$", "", name.strip()) for name in rows[0]]
    return dict(zip(names, map(float, rows[-1])))


def call(*words, cwd):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, cwd=cwd)
    if result.returncode != 0:
        said = (result.stderr or result.stdout).strip().splitlines()
        raise RuntimeError(said[-1] if said else f"exit code {result.returncode}")


def values_of(row, outputs):
    """Return the outputs from a row, whose names may have the path of the FMU as a prefix, such as model.root.fmu.x."""
    found = []
    for output in outputs:
        names = [name for name in row if name == output or name.endswith("." + output)]
        found.append(row[min(names, key=len)])
    return found


def by_program(words_of, file="out.csv", delimiter=","):
    """
    Return a function that runs an importer, with the arguments of those in packages.py.

    words_of(archive, kind, end, step, folder) returns the words of the command. The command runs in the folder, and writes `file` there.
    """

    def run(archive, kind, end, outputs):
        with tempfile.TemporaryDirectory() as folder:
            call(*words_of(archive, kind.lower(), end, min(STEP, end), Path(folder)), cwd=folder)
            return values_of(last_row(Path(folder) / file, delimiter), outputs)

    return run


@by_program
def fmusim(archive, kind, end, step, folder):
    solver = ("--solver", "cvode") if kind == "me" else ()
    return "fmusim", "--interface-type", kind, *solver, "--stop-time", end, "--output-interval", step, "--output-file", "out.csv", archive


@by_program
def omsimulator(archive, kind, end, step, folder):
    options = (f"--mode={kind}", f"--stopTime={end}", f"--interval={step}", "--solver=cvode", f"--tolerance={TOLERANCE}")
    return "OMSimulator", *options, f"--tempDir={folder}", "--resultFile=out.csv", archive


@by_program
def fmi4c(archive, kind, end, step, folder):
    """Return the command of fmi4ctest, which uses the explicit Euler method in model exchange."""
    return "fmi4ctest", "-m", kind, "-s", end, "-h", step, "-o", "out.csv", archive


PROJECT = """tStart 0 s
tEnd {end} s
hStart {step} s
hMax {step} s
hMin 1e-9 s
hOutputMin {step} s
adjustStepSize no
MasterMode GAUSS_JACOBI
ErrorControlMode NONE
maxIterations 1
simulator 0 0 fmu #ff808080 "{archive}"
"""


def project_of_mastersim(archive, kind, end, step, folder):
    project = folder / "project.msim"
    project.write_text(PROJECT.format(end=end, step=step, archive=archive))
    return "MasterSimulator", project


mastersim = by_program(project_of_mastersim, "project/results/values.csv", "\t")


def on_path(program):
    """Return a function that returns the version of a program; it raises ModuleNotFoundError if the program is not on the PATH."""

    def version():
        if shutil.which(program) is None:
            raise ModuleNotFoundError(program)
        text = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
        number = re.search(r"\d+(\.\d+)+", text)
        return number[0] if number else "?"

    return version


IMPORTERS = {
    "fmusim": (on_path("fmusim"), BOTH, fmusim),
    "OMSimulator": (on_path("OMSimulator"), BOTH, omsimulator),
    "MasterSim": (on_path("MasterSimulator"), [(2, "CS")], mastersim),
    "fmi4c": (on_path("fmi4ctest"), BOTH, fmi4c),
}
