"""
Run time of the Taylor solver at equal error, beside the best of SUNDIALS through the same FMU interface, a Taylor loop
written by hand, and heyoka. The error is the largest of the states at the end, relative to max(1, |state|), against
SciPy's DOP853 at its tightest tolerance on SymPy's equations (itself good to about 1e-12). Times are the minimum of
several repeats of the doStep loop alone.
"""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import sympy
from scipy.integrate import solve_ivp

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

import fmu
from systems_in_sympy import system

ERROR = 1e-10
# Start values, and the time to simulate: the chaotic double pendulum multiplies errors beyond reach soon after 5 s.
PROBLEMS = {
    "SimplePendulum": ({}, 10.0),
    "InvertedPendulumCart": ({}, 10.0),
    "ParticlePolar": (dict(r=0.1, omega=np.sqrt(0.19) / 0.01), 10.0),
    "DoublePendulum": ({}, 5.0),
}
TOLERANCES = [10.0**-k for k in range(5, 16)]


def stepping(build, name, starts, end, tolerance, steps, repeats):
    """(seconds, states at the end)"""
    guid = fmu.description(name).guid if build == ROOT / "build" else guid_in(build, name)
    references = fmu.references(name)
    count = len(fmu.states_of(name))
    words = [ROOT / "build/bin/stepping", build / f"systems/{name}/binaries/linux64/{name}.so", guid, tolerance, end, steps,
             repeats, count, *(f"{references[variable]}={value}" for variable, value in starts.items())]
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if result.returncode != 0:
        return None
    seconds, *states = map(float, result.stdout.split())
    return seconds, np.array(states)


def guid_in(build, name):
    text = (build / f"systems/{name}/modelDescription.xml").read_text()
    return text.split('guid="')[1].split('"')[0]


def reference(name, starts, end):
    definition = system(name)
    given = {v.name: float(v.start) for v in fmu.description(name).modelVariables if v.start is not None} | starts
    right = definition.right_side(lambda t: [given[u.name] for u in definition.inputs],
                                  [given[p.name] for p in definition.parameters])
    start = [given[s.name] for s in [*definition.q, *definition.v]]
    return solve_ivp(right, (0, end), start, method="DOP853", rtol=2.3e-14, atol=1e-15).y[:, -1]


def best_time(builds, name, starts, end, exact, steps, repeats):
    """The shortest time of all runs whose error is at most ERROR, over builds and tolerances."""
    times = []
    for build in builds:
        for tolerance in TOLERANCES:
            run = stepping(build, name, starts, end, tolerance, steps, repeats)
            if run and np.max(np.abs(run[1] - exact) / np.maximum(1, np.abs(exact))) <= ERROR:
                times.append(run[0])
    return min(times, default=np.nan)


def heyoka_time(name, starts, end):
    """heyoka's compiled integrator at its default tolerance; compilation not counted."""
    try:
        import heyoka
    except ImportError:
        return np.nan
    definition = system(name)
    given = {v.name: float(v.start) for v in fmu.description(name).modelVariables if v.start is not None} | starts
    fixed = {s: given[s.name] for s in [*definition.inputs, *definition.parameters]}
    solved = definition.mass.LUsolve(sympy.Matrix([sum(terms) for terms in definition.terms]))
    solved = [sympy.simplify(a).subs(fixed) for a in solved]
    symbols = [*definition.q, *definition.v]
    variables = dict(zip(symbols, heyoka.make_vars(*[s.name for s in symbols])))
    right = [variables[v] for v in definition.v] + [heyoka.from_sympy(a) for a in solved]
    start = [given[s.name] for s in symbols]
    integrator = heyoka.taylor_adaptive(list(zip(variables.values(), right)), start)
    times = []
    for _ in range(50):
        integrator.time = 0.0
        integrator.state[:] = start
        begin = time.perf_counter()
        integrator.propagate_until(end)
        times.append(time.perf_counter() - begin)
    return min(times)


def main():
    taylor, sundials = [ROOT / "build"], [ROOT / "build/erk", ROOT / "build/bdf"]
    print(f"Microseconds; error at most {ERROR:g} where no tolerance is given\n")
    print("| | s | Taylor, one step | SUNDIALS | ratio | Taylor, steps of 0.01 s | SUNDIALS | ratio | heyoka | Taylor at 1e-15 |")
    print("| --- |" + " ---: |" * 9)
    for name, (starts, end) in PROBLEMS.items():
        exact = reference(name, starts, end)
        cells = []
        for steps, repeats in ((1, 30), (round(100 * end), 10)):
            ours = best_time(taylor, name, starts, end, exact, steps, repeats)
            theirs = best_time(sundials, name, starts, end, exact, steps, 3)
            cells += [f"{ours * 1e6:.1f}", f"{theirs * 1e6:.0f}", f"{theirs / ours:.0f}"]
        tight = stepping(ROOT / "build", name, starts, end, 1e-15, 1, 100)[0]
        print(f"| {name} | {end:g} | {' | '.join(cells)} | {heyoka_time(name, starts, end) * 1e6:.1f} | {tight * 1e6:.1f} |", flush=True)
    hand = subprocess.run([ROOT / "build/bin/pendulum_by_hand", "10", "14", "100"], capture_output=True, text=True)
    generated = stepping(ROOT / "build", "SimplePendulum", {}, 10.0, 1e-11, 1, 100)[0]
    seconds = float(hand.stdout.split()[0])
    print(f"\nPendulum by hand, order 14: {seconds * 1e6:.1f}; generated at the same order: {generated * 1e6:.1f}; "
          f"ratio {generated / seconds:.2f}")


if __name__ == "__main__":
    main()
