"""Compare the error against run time of all systems, solvers, tolerances and communication steps, and of other programs."""

import math
import re
from dataclasses import asdict, dataclass, fields

import numpy as np

from scripts.pages.html_page import write_csv as write_csv_table
from numerics.driver import SOLVERS, folder_of, step_repeatedly
from numerics.failures import failure
from numerics.times import time_to
from numerics.work_precision.peers import PEERS
from numerics.work_precision.scenarios import QUICK, SCENARIOS, error_at_end, errors, reference, states_of

LEVELS = [1e-6, 1e-10]  # errors at which the summary compares times


@dataclass
class Sample:
    """Time and error of a run."""

    system: str
    method: str  # shipped, taylor, erk, bdf or a peer
    tolerance: float  # or the step in s, of methods with fixed steps
    step: float  # communication step in s; 0 for peers
    seconds: float
    error: float  # largest at the recorded communication points
    error_at_end: float
    steps: int = 0
    evaluations: int = 0


def sample_fmu(name, solver, tolerance, communication_step):
    starts, end = SCENARIOS[name]
    steps = 1 if communication_step == end else round(end / communication_step)
    stepped = step_repeatedly(solver, name, starts, end, tolerance, steps)
    if stepped is None:
        return None
    states = stepped.columns(states_of(name))
    return Sample(name, solver, tolerance, communication_step, stepped.seconds, errors(name, states).max(),
                  error_at_end(name, states[-1]), stepped.steps, stepped.evaluations)  # fmt: skip


def sample_peer(name, peer, tolerance):
    """Return the Sample of another program; None if it is not installed or fails, by whatever exception."""
    function, _, _ = PEERS[peer]
    try:
        result = function(name, tolerance)
    except Exception:
        return None
    if result is None or not np.all(np.isfinite(result[1])):
        return None
    seconds, states = result
    return Sample(name, peer, tolerance, 0.0, seconds, errors(name, states).max(), error_at_end(name, states[-1]))


def own_solver(name):
    """Return the method of the FMU as shipped."""
    code = (folder_of("shipped") / "systems" / name / "system.c").read_text()
    return re.search(r"\.solver = &solver_([a-z]+)", code).group(1)


def chosen(quick):
    return QUICK if quick else list(SCENARIOS)


def plan(quick):
    """Return all tasks as (function, arguments)."""
    tolerances = [10.0**-k for k in (range(4, 13, 2) if quick else range(3, 15))]
    tasks = []
    for name in chosen(quick):
        end = SCENARIOS[name][1]
        for solver in ["shipped", *(s for s in SOLVERS if s != own_solver(name))]:
            for communication_step in [end, 0.01] if quick else [end, 0.1, 0.01, 0.001]:
                tasks += [(sample_fmu, (name, solver, tolerance, communication_step)) for tolerance in tolerances]
        for peer, (_, settings, systems) in PEERS.items():
            if systems is None or name in systems:
                tasks += [(sample_peer, (name, peer, setting)) for setting in (settings[1::2] if quick else settings)]
    return tasks


def collect(tasks, progress):
    """Return the samples, the number of failures of each method, and sentences about systems without a reference."""
    samples, failures, without = [], {}, {}
    for name in dict.fromkeys(arguments[0] for _, arguments in tasks):
        try:
            reference(name)
        except Exception as error:
            without[name] = failure(f"{name}, which has no reference", error)
    for function, arguments in tasks:
        name, method = arguments[:2]
        sample = None if name in without else function(*arguments)
        if sample is not None:
            samples.append(sample)
        elif name not in without:
            failures[method] = failures.get(method, 0) + 1
        progress(f"{name}, {method}")
    return samples, failures, list(without.values())


def write_csv(samples, path, type_of_samples=Sample):
    write_csv_table(path, [field.name for field in fields(type_of_samples)], (asdict(sample).values() for sample in samples))


def best_seconds(samples, name, methods, level, steps=None):
    """Return the shortest time to an error at the end, interpolated between tolerances; infinite if no method reaches it."""
    points = lambda method: [(s.seconds, s.error_at_end) for s in samples if s.system == name and s.method == method and (steps is None or s.step in (0.0, steps))]
    return min(time_to(points(method), level) for method in methods)


def rivals(samples):
    """Return the groups of methods that are compared with the FMU as shipped, by name."""
    groups = {"SUNDIALS in the same FMU (the better of erk and bdf)": ["erk", "bdf"], "the same FMU with taylor": ["taylor"]}
    groups |= {peer: [peer] for peer in PEERS if any(s.method == peer for s in samples)}
    return groups


def ratios(samples, level):
    """Return for each group (name, ratios of its time to the FMU's by system, systems on which it does not reach the error)."""
    systems = list(dict.fromkeys(s.system for s in samples))
    rows = []
    for rival, methods in rivals(samples).items():
        ratio, never = {}, []
        for name in systems:
            end = SCENARIOS[name][1]
            ours = best_seconds(samples, name, ["shipped"], level, end)
            theirs = best_seconds(samples, name, methods, level, end)
            tried = any(s.system == name and s.method in methods for s in samples)
            if not tried or not math.isfinite(ours):
                continue
            if math.isfinite(theirs):
                ratio[name] = theirs / ours
            else:
                never.append(name)
        rows.append((rival, ratio, never))
    return rows


def factor(value):
    return f"{value:.2g}" if value < 10 else f"{value:,.0f}"


def summary(samples):
    """Return for each level a sentence and a list with a sentence for each group, for the head of the page."""
    systems = list(dict.fromkeys(s.system for s in samples))
    levels = []
    for level in LEVELS:
        rows = ratios(samples, level)
        fastest = [name for name in systems if math.isfinite(best_seconds(samples, name, ["shipped"], level, SCENARIOS[name][1]))
                   and all(ratio.get(name, math.inf) >= 1 for _, ratio, _ in rows)]  # fmt: skip
        text = f"To an error of {level:g} at the end, the FMU as shipped is the fastest on {len(fastest)} of {len(systems)} systems."
        levels.append((text, [verdict(*row) for row in rows if row[1] or row[2]]))
    return levels


def verdict(rival, ratio, never):
    if not ratio:
        return f"{rival}: never gets there"
    values = sorted(ratio.values())
    many = "systems" if len(values) > 1 else "system"
    text = f"{rival}: {factor(float(np.median(values)))} times that time (median of {len(values)} {many}; {factor(values[0])} to {factor(values[-1])})"
    return text + (f"; never on {', '.join(never)}" if never else "")
