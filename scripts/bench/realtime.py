"""Measure the times of single communication steps of 1 ms, and print them; for scripts/bench/realtime."""

import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from fmpy import extract, platform, read_model_description, sharedLibraryExtension, simulate_fmu
from fmpy.fmi2 import FMU2Slave

from fmu import ROOT, archive, unpacked
from scripts.pages.html_page import write_csv

from scripts.library.problem import Problem

PROGRAM = ROOT / "build" / "bin" / "realtime"
STEP, RUNS = 1e-3, 3  # communication step in s; runs, of which the fastest counts for each step
LONGEST = 60.0  # limit of a run's wall-clock time, in s
TRACED = 2000  # steps that run under strace at most, since strace is slow
COLUMNS = ("system", "steps", "median", "99.9 %", "longest", "longest as seen", "allocations", "system calls")
PYTHON_PENDULUM = '''
from math import sin

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class PythonPendulum(Fmi2Slave):
    def __init__(self, **options):
        super().__init__(**options)
        self.theta, self.omega = 1.0, 0.0
        self.register_variable(Real("theta", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        def slope(theta, omega):
            return omega, -9.81 * sin(theta)

        q, v = self.theta, self.omega
        k1 = slope(q, v)
        k2 = slope(q + step / 2 * k1[0], v + step / 2 * k1[1])
        k3 = slope(q + step / 2 * k2[0], v + step / 2 * k2[1])
        k4 = slope(q + step * k3[0], v + step * k3[1])
        self.theta += step / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        self.omega += step / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        return True
'''


def words_for(folder, description, count, runs):
    library = folder / "binaries" / platform / f"{description.coSimulation.modelIdentifier}{sharedLibraryExtension}"
    return [str(word) for word in (PROGRAM, library, description.guid, (folder / "resources").as_uri(), STEP, count, runs, LONGEST)]


def system_calls(words):
    """Count the system calls between the program's two calls of getppid; return None if strace is missing or not permitted."""
    if not shutil.which("strace"):
        return None
    with tempfile.NamedTemporaryFile("r") as log:
        if subprocess.run(["strace", "-f", "-o", log.name, *words], capture_output=True).returncode != 0:
            return None
        found = re.search(r"getppid\(\).*?\n(.*?)[^\n]*getppid\(\)", log.read(), re.S)
        return len(found[1].splitlines()) if found else None


def measure(name, folder, description, count):
    result = subprocess.run(words_for(folder, description, count, RUNS), capture_output=True, text=True)
    if result.returncode != 0:
        return {"system": name}
    steps, *times, allocations = result.stdout.strip().split(",")
    calls = system_calls(words_for(folder, description, min(TRACED, int(steps)), 1))
    times = [f"{float(time) / 1e3:.3g}" for time in times]
    return dict(zip(COLUMNS, (name, steps, *times, allocations, "" if calls is None else calls)))


def python_pendulum(folder, count):
    """Measure a pendulum by PythonFMU, with the classical Runge-Kutta method in Python; FMPy calls it, since it runs in this interpreter."""
    source = Path(folder) / "python_pendulum.py"
    source.write_text(PYTHON_PENDULUM)
    subprocess.run([sys.executable, "-m", "pythonfmu", "build", "-f", source, "-d", folder], check=True, capture_output=True)
    file = Path(folder) / "PythonPendulum.fmu"
    description = read_model_description(file)
    instance = FMU2Slave(guid=description.guid, unzipDirectory=extract(file, Path(folder) / "unpacked"), modelIdentifier=description.coSimulation.modelIdentifier)
    taken = np.empty((RUNS, count))
    for run in taken:
        instance.instantiate()
        instance.setupExperiment(startTime=0.0)
        instance.enterInitializationMode()
        instance.exitInitializationMode()
        for i in range(count):
            before = time.perf_counter()
            instance.doStep(i * STEP, STEP)
            run[i] = time.perf_counter() - before
        instance.fmi2FreeInstance(instance.component)  # freeInstance() of FMPy unloads the library as well
    instance.freeLibrary()
    return row_of("pendulum by PythonFMU", taken)


def imported_pendulum(solver, count):
    """Measure the FMU of SimplePendulum in model exchange, by a solver of FMPy; the times include FMPy's loop in Python."""
    taken = []
    for _ in range(RUNS):
        clock = []
        simulate_fmu(
            archive("SimplePendulum"), fmi_type="ModelExchange", solver=solver, step_size=STEP, output_interval=STEP, stop_time=(count + 1) * STEP,
            step_finished=lambda *_, clock=clock: clock.append(time.perf_counter()) or True,
        )  # fmt: skip
        taken.append(np.diff(clock)[:count])
    return row_of(f"pendulum by FMPy's {solver}", np.array(taken))


def row_of(name, taken):
    """Return the row of COLUMNS; `taken` has the time of each step in s, runs x steps."""
    least, count = np.sort(taken.min(axis=0)), taken.shape[1]
    times = [np.median(least), least[count - 1 - count // 1000], least[-1], taken.max()]
    return dict(zip(COLUMNS, (name, count, *(f"{1e6 * one:.3g}" for one in times), "", "")))


def show(row):
    print(f"{row['system']:34}" + "".join(f"{row.get(column, '-'):>16}" for column in COLUMNS[1:]), flush=True)


def rows_of(names, seconds):
    """Yield a row for each system, for a pendulum by FMPy's solvers, and, if PythonFMU is installed, for one in Python."""
    count = round(seconds / STEP)
    for name in names:
        yield measure(name, unpacked(name), read_model_description(archive(name)), count)
    yield from (imported_pendulum(solver, count) for solver in ("Euler", "CVode"))
    if importlib.util.find_spec("pythonfmu") is not None:
        with tempfile.TemporaryDirectory() as folder:
            yield python_pendulum(folder, count)


def all_names():
    return sorted(path.stem for path in (ROOT / "build" / "fmu").glob("*.fmu"))


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 600.0
    names = sys.argv[2:] or all_names()
    print("times in us; of each step the fastest of", RUNS, "runs counts, so that other load of the machine is left out")
    show(dict(zip(COLUMNS, COLUMNS)))
    rows = []
    for row in rows_of(names, seconds):
        rows.append(row)
        show(row)
    path = ROOT / "build" / "results" / "realtime.csv"
    write_csv(path, COLUMNS, ([row[column] for column in COLUMNS] for row in rows))
    print(f"CSV        {path}")


if __name__ == "__main__":
    try:
        main()
    except Problem as problem:
        sys.exit(f"scripts/bench/realtime: {problem}")
