"""
Compare programs that simulate 100,000 double pendulums with different start angles, to 1 s at a tolerance of 1e-10, on one core and on all.

The programs are the lanes of src/ensemble, heyoka's batch mode in as many lanes, with equations written by hand, and the FMU, run by run. Times
are the shortest of several repeats, without compilation. Those of heyoka include a call from Python for each batch, which is also measured alone.
"""

import multiprocessing
import os
import time
from concurrent.futures import ThreadPoolExecutor

import fmpy
import numpy as np

from fmu import ROOT, archive
from scripts.library.ensembles import Ensemble, lanes_here, source_of
from scripts.commands.sweep import compile_ensemble
from scripts.library.sweeping.worker import Instance, run_by_fmi, states_of

NAME, END, TOLERANCE, RUNS, REPEATS = "DoublePendulum", 1.0, 1e-10, 100_000, 5
VARIED = ["theta1", "theta2"]
RUNNER = ROOT / "build" / "libsweep_runs.so"
STARTS = np.random.default_rng(0).uniform(-3, 3, (RUNS, 2))


def in_threads(function, cores):
    """Call function(rows) for all runs, in pieces over threads; return the seconds and the results."""
    pieces = np.array_split(STARTS, 20)
    with ThreadPoolExecutor(cores) as executor:
        begin = time.perf_counter()
        results = list(executor.map(function, pieces))
        return time.perf_counter() - begin, np.concatenate(results)


def our_lanes(lanes):
    description = fmpy.read_model_description(archive(NAME))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    varied, recorded = ([reference[name] for name in names] for names in (VARIED, states_of(description)))
    ensemble = Ensemble(compile_ensemble(source_of(archive(NAME)), lanes), varied, recorded, [END], TOLERANCE)
    return lambda cores: in_threads(lambda rows: ensemble.run(rows)[0][:, 0], cores)


def fmi():
    settings = {"tolerance": TOLERANCE, "stop": END, "times": [END], "records": []}
    data, runner = archive(NAME).read_bytes(), RUNNER.read_bytes()

    def run(cores):
        idle = [Instance(data, runner) for _ in range(cores)]

        def one(rows):
            instance = idle.pop()
            ends = run_by_fmi(instance, rows, VARIED, settings).ends
            idle.append(instance)
            return ends

        return in_threads(one, cores)

    return run


def by_hand():
    """Return the equations for heyoka, with masses and lengths of 1; they take half the time of those that SymPy solves and simplifies."""
    import heyoka as hy

    a, b, u, v = hy.make_vars("theta1", "theta2", "omega1", "omega2")
    s, c, g = hy.sin(a - b), hy.cos(a - b), 9.81
    first, second = -v * v * s - 2 * g * hy.sin(a), u * u * s - g * hy.sin(b)
    determinant = 2.0 - c * c
    return [(a, u), (b, v), (u, (first - c * second) / determinant), (v, (2.0 * second - c * first) / determinant)]


def heyoka_batches(rows, end, lanes, barrier, results):
    """Simulate batches in a separate process, since Python's threads would wait for one another between batches."""
    import heyoka

    batch = heyoka.taylor_adaptive_batch(by_hand(), np.zeros((4, lanes)), tol=TOLERANCE)
    ends = np.empty((len(rows), 4))
    barrier.wait()
    for first in range(0, len(rows), lanes):
        batch.set_time(0.0)
        batch.state[:2] = rows[first : first + lanes].T
        batch.state[2:] = 0.0
        batch.propagate_until(end)
        ends[first : first + lanes] = batch.state.T
    barrier.wait()
    results.put((rows[0, 0], ends))


def heyoka(lanes, end=END):
    def run(cores):
        fork = multiprocessing.get_context("fork")
        barrier, results = fork.Barrier(cores + 1), fork.Queue()
        pieces = {piece[0, 0]: piece for piece in np.array_split(STARTS, [RUNS // cores // lanes * lanes * i for i in range(1, cores)])}
        processes = [fork.Process(target=heyoka_batches, args=(piece, end, lanes, barrier, results)) for piece in pieces.values()]
        for process in processes:
            process.start()
        barrier.wait()
        begin = time.perf_counter()
        barrier.wait()
        seconds = time.perf_counter() - begin
        ends = dict(results.get() for _ in processes)
        return seconds, np.concatenate([ends[key] for key in pieces])

    return run


def main():
    lanes, cores = lanes_here(RUNNER), os.cpu_count()
    programs = {f"{n} lanes": our_lanes(n) for n in (8, 4, 2) if n <= lanes}
    programs |= {f"heyoka, {lanes} lanes": heyoka(lanes), "of that without motion": heyoka(lanes, 0.0), "the FMU": fmi()}
    counts = sorted({1, cores})
    print(f"| | {' | '.join(f'{count} cores, s' for count in counts)} | microseconds a run and core | largest difference to the FMU |")
    print("| --- |" + " ---: |" * (len(counts) + 2))
    best = {(name, count): np.inf for name in programs for count in counts}
    ends = {}
    for _ in range(REPEATS):  # in turns, so that other load on the machine affects all programs
        for name, program in programs.items():
            for count in counts:
                seconds, ends[name] = program(count)
                best[name, count] = min(best[name, count], seconds)
    for name in programs:
        difference = np.max(np.abs(ends[name] - ends["the FMU"]))
        cells = " | ".join(f"{best[name, count]:.3f}" for count in counts)
        print(f"| {name} | {cells} | {min(best[name, c] * c for c in counts) / RUNS * 1e6:.2f} | {difference:.1e} |")


if __name__ == "__main__":
    main()
