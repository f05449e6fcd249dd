"""
Compare the run time of the Taylor solver at equal error.

The others are the best method of SUNDIALS behind the same FMI functions, a Taylor loop written by hand, and heyoka at its default tolerance. Chains
of 1 to 32 rods follow. Times are the minimum of several repeats of the doStep loop, in microseconds. Errors are those at the end, against a reference
of 20 digits.
"""

import math
import re
import subprocess

import fmpy

from fmu import ROOT
from numerics.driver import step, step_repeatedly
from numerics.work_precision.peers import heyoka_series
from numerics.work_precision.scenarios import SCENARIOS, error_at_end, states_of

ERROR = 1e-10  # error at the end that runs of the comparison may have at most
NAMES = ["SimplePendulum", "InvertedPendulumCart", "ParticlePolar", "DoublePendulum"]
TOLERANCES = [10.0**-k for k in range(5, 17)]
RODS = [1, 2, 4, 8, 16, 32]


def best_time(solvers, name, steps, error):
    """Return the shortest time in microseconds of all runs with at most this error, over solvers and tolerances; NaN without any."""
    starts, end = SCENARIOS[name]
    times = []
    for solver in solvers:
        for tolerance in TOLERANCES:
            run = step_repeatedly(solver, name, starts, end, tolerance, steps)
            if run is not None and error_at_end(name, run.columns(states_of(name))[-1]) <= error:
                times.append(run.seconds * 1e6)
    return min(times, default=math.nan)


def compare():
    print(f"Microseconds to an error of {ERROR:g}; heyoka at its default tolerance, and Taylor to at most twice the error that it reached\n")
    print("| | s | Taylor, one step | SUNDIALS | ratio | Taylor, steps of 0.01 s | SUNDIALS | ratio | heyoka | Taylor | ratio |")
    print("| --- |" + " ---: |" * 10)
    for name in NAMES:
        end, cells = SCENARIOS[name][1], []
        for steps in (1, round(100 * end)):
            ours, theirs = best_time(["taylor"], name, steps, ERROR), best_time(["erk", "bdf"], name, steps, ERROR)
            cells += [f"{ours:.1f}", f"{theirs:.0f}", f"{theirs / ours:.0f}"]
        seconds, states = heyoka_series(name, 2.2e-16)
        ours = best_time(["taylor"], name, 1, 2 * error_at_end(name, states[-1]) + 1e-15)
        cells += [f"{seconds * 1e6:.1f}", f"{ours:.1f}", f"{seconds * 1e6 / ours:.2f}"]
        print(f"| {name} | {end:g} | {' | '.join(cells)} |", flush=True)


def compare_with_loop():
    hand = subprocess.run([ROOT / "build/bin/pendulum_by_hand", "10", "14", "100"], capture_output=True, text=True, check=True)
    seconds = float(hand.stdout.split()[0])
    generated = step("taylor", "SimplePendulum", {}, 10.0, 1e-11, 1, 100).seconds
    print(f"\nPendulum by hand, order 14: {seconds * 1e6:.1f}; generated at the same order: {generated * 1e6:.1f}; "
          f"ratio {generated / seconds:.2f}")  # fmt: skip


def build_chains():
    """Build ChainPendulum under the names Chain1 to Chain32, with taylor and with erk."""
    text = (ROOT / "fmu" / "ChainPendulum" / "system.xml").read_text()
    systems = ROOT / "build" / "chains" / "systems"
    for rods in RODS:
        folder = systems / f"Chain{rods}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "system.xml").write_text(re.sub(r'(name="N" value=)"\d+"', rf'\1"{rods}"', text.replace("ChainPendulum", f"Chain{rods}")))
    for solver in ("taylor", "erk"):
        words = [ROOT / "scripts/build", ROOT / "build/chains" / solver, f"-DSYSTEMS={systems}", f"-DSOLVER={solver}"]
        subprocess.run([str(word) for word in words], check=True)


def chain_cost(solver, rods, end=1.0, tolerance=1e-10):
    """Return the microseconds of a simulation, and the number of its solver's steps."""
    build = ROOT / "build" / "chains" / solver
    library = build / "systems" / f"Chain{rods}" / "binaries" / "linux64" / f"Chain{rods}.so"
    description = fmpy.read_model_description(build / "fmu" / f"Chain{rods}.fmu")
    reference = next(v.valueReference for v in description.modelVariables if v.name == "solverSteps")
    words = [ROOT / "build/bin/stepping", library, description.guid, tolerance, end, 1, 20, 0, 0, reference]
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True)
    seconds, steps = result.stdout.split()
    return float(seconds) * 1e6, int(steps) + (solver == "taylor")  # solverSteps does not count the last series, which the simulation does not leave


def compare_chains():
    build_chains()
    print("\nChains of N rods, 1 s at tolerance 1e-10, microseconds\n")
    print("| N | Taylor, steps | a step | in all | erk, steps | a step | in all | ratio |\n| ---: |" + " ---: |" * 7)
    for rods in RODS:
        cells, totals = [], []
        for solver in ("taylor", "erk"):
            microseconds, steps = chain_cost(solver, rods)
            totals.append(microseconds)
            cells += [str(steps), f"{microseconds / steps:.2f}", f"{microseconds:.0f}"]
        print(f"| {rods} | {' | '.join(cells)} | {totals[1] / totals[0]:.1f} |", flush=True)


if __name__ == "__main__":
    compare()
    compare_with_loop()
    compare_chains()
