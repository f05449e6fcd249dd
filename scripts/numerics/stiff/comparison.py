"""Compare the error against run time of stiff problems: auto, the methods that it chooses from, and those of SUNDIALS, SciPy and exudyn."""

import math
from dataclasses import dataclass

import numpy as np

from numerics.driver import POINTS, step
from numerics.failures import failure
from numerics.stiff.peers import PATIENCE as PEERS_PATIENCE
from numerics.stiff.peers import PEERS, can_express
from numerics.stiff.problems import PROBLEMS, QUICK, relative, right_states
from numerics.times import ratio, time_to

METHODS = ["auto", "radau", "taylor", "bdf"]  # each has a build folder of all systems
TOLERANCES = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12]
LEVELS = [1e-6, 1e-10]  # errors at which times are compared
GOAL = 1.3  # desired limit of the time of auto, in units of the time of the better of its two methods
PATIENCE = 10.0  # s, after which a run is stopped
SLOW = 20.0  # multiple of the time of auto after which another method is stopped
LONG = 0.3  # s, from which on one run is enough, since disturbances are a small part


@dataclass
class Sample:
    """Time and error of a run."""

    problem: str
    way: str  # way of communication
    method: str
    tolerance: float  # or the number of fixed steps
    seconds: float
    error: float  # largest at the recorded communication points
    steps: int = 0
    evaluations: int = 0


def sample(problem, way, method, tolerance, timeout):
    """Return the Sample of a first run, whose time includes recording; None if it fails."""
    steps, changing = problem.communication(way)
    stepped = step(method, problem.system, problem.values, problem.end, tolerance, steps, 0, timeout=timeout, changing=changing)
    if stepped is None:
        return None
    states = stepped.columns(problem.states)
    stride = POINTS // len(states)
    error = float(np.max(relative(states, right_states(problem, way)[0][stride - 1 :: stride])))
    return Sample(problem.name, way, method, tolerance, stepped.seconds, error, stepped.steps, stepped.evaluations)


def repeat(problem, way, sample):
    """Repeat a run without recording, as often as fits into 0.02 s; update the time by the fastest run."""
    steps, changing = problem.communication(way)
    repeats = int(min(max(0.02 / sample.seconds, 1), 500))
    stepped = step(sample.method, problem.system, problem.values, problem.end, sample.tolerance, steps, repeats, 0, changing=changing)
    if stepped is not None:
        sample.seconds = min(sample.seconds, stepped.seconds)


def first_samples(problem, way, tolerances):
    """Return the Samples of first runs; a method that fails or is much slower than auto is not tried at tighter tolerances."""
    samples, given_up = [], set()
    for tolerance in sorted(tolerances, reverse=True):
        patience = PATIENCE
        for method in METHODS:
            if method in given_up:
                continue
            first = sample(problem, way, method, tolerance, patience)
            if first is None:
                given_up.add(method)
                continue
            samples.append(first)
            if method == "auto":
                patience = min(PATIENCE, 1 + SLOW * first.seconds)
    return samples


def sample_fmus(problem, way, tolerances, rounds):
    """Return the Samples of FMUs; the methods take turns, so that other load affects all of them, and the fastest run counts."""
    right_states(problem, way)  # fails early if there is no reference
    samples = first_samples(problem, way, [t for t in tolerances if t >= problem.tightest])
    for _ in range(rounds - 1):
        for known in samples:
            if known.seconds < LONG:
                repeat(problem, way, known)
    return samples


def sample_peers(problem, quick):
    """Return the Samples of other programs, one run for each setting, from coarse to fine until one takes too long; failures are skipped."""
    samples, exact = [], right_states(problem, "one step")[0][-1]
    for peer, (function, settings, _) in PEERS.items():
        for setting in settings[1::2] if quick else settings:
            try:
                result = function(problem, setting) if can_express(peer, problem) else None
            except TimeoutError:
                break
            except Exception:
                continue
            if result is None or not np.all(np.isfinite(result[1])):
                continue
            error = float(np.max(relative(result[1], exact)))
            samples.append(Sample(problem.name, "one step", peer, setting, result[0], error))
            if result[0] > PEERS_PATIENCE:
                break
    return samples


def problems(quick):
    return QUICK if quick else PROBLEMS


def plan(quick):
    """Return all pairs (problem, way)."""
    return [(problem, way) for problem in problems(quick) for way in problem.ways]


def sample_problem(problem, quick, progress):
    tolerances, rounds, samples = TOLERANCES[1::2] if quick else TOLERANCES, 2 if quick else 4, []
    for way in problem.ways:
        samples += sample_fmus(problem, way, tolerances, rounds)
        if way == "one step":
            samples += sample_peers(problem, quick)
        progress(f"{problem.name}, {way}")
    return samples


def collect(quick, progress):
    """Return the samples, and a sentence about each problem that failed, by its name."""
    samples, failures = [], {}
    for problem in problems(quick):
        try:
            samples += sample_problem(problem, quick, progress)
        except Exception as error:
            failures[problem.name] = failure(problem.name, error)
    return samples, failures


def seconds_to(samples, problem, way, method, level):
    return time_to([(s.seconds, s.error) for s in samples if (s.problem, s.way, s.method) == (problem, way, method)], level)


def ratios(samples, problem, way, level):
    """Return the ratios of times to the error level: of auto to the better of its methods, and of bdf to radau."""
    seconds = {method: seconds_to(samples, problem, way, method, level) for method in METHODS}
    return ratio(seconds["auto"], min(seconds["taylor"], seconds["radau"])), ratio(seconds["bdf"], seconds["radau"])


def exudyn_ratio(samples, problem, way, level):
    """
    Return the time of exudyn's faster method as a multiple of auto's. It is infinite if the method does not reach the error, NaN if it cannot
    express the problem.
    """
    times = [seconds_to(samples, problem.name, way, peer, level) for peer in PEERS if peer.startswith("exudyn")]
    tried = not math.isnan(smallest_error(samples, problem.name, way, "exudyn"))
    return ratio(min(times), seconds_to(samples, problem.name, way, "auto", level)) if tried else math.nan


def smallest_error(samples, problem, way, program):
    return min((s.error for s in samples if (s.problem, s.way) == (problem, way) and s.method.startswith(program)), default=math.nan)


HEADER = ["problem", "communication", "seconds", *(f"{pair}, error {level:g}" for level in LEVELS for pair in ("auto / better of taylor, radau", "bdf / radau")),
          *(f"exudyn / auto, error {level:g}" for level in LEVELS), "smallest error of SciPy", "smallest error of exudyn",
          "reference checked with", "largest difference"]  # fmt: skip
EXUDYN = 3 + 2 * len(LEVELS)  # index of exudyn's first column


def rows(samples, quick):
    """Return the rows of all problems that did not fail."""
    table, sampled = [], {s.problem for s in samples}
    for problem, way in plan(quick):
        if problem.name not in sampled:
            continue
        compared = [value for level in LEVELS for value in ratios(samples, problem.name, way, level)]
        beside = [exudyn_ratio(samples, problem, way, level) for level in LEVELS]
        others = [smallest_error(samples, problem.name, way, program) for program in ("SciPy", "exudyn")]
        table.append([problem.name, way, problem.end, *compared, *beside, *others, *right_states(problem, way)[1:]])
    return table


def worst(table, column):
    """Return the largest ratio of a column and its problem; the ratio is infinite if only one method reaches the error."""
    known = [(row[column], f"{row[0]}, {row[1]}") for row in table if not math.isnan(row[column])]
    return max(known, default=(math.nan, "none"))


def factor(value):
    return "infinitely many" if math.isinf(value) else f"{value:.2f}"


def summary(table):
    """Return sentences for each error level, with the worst of each ratio."""
    sentences = []
    for i, level in enumerate(LEVELS):
        known = [row[3 + 2 * i] for row in table if not math.isnan(row[3 + 2 * i])]
        value, where = worst(table, 3 + 2 * i)
        sentences.append(f"To an error of {level:g}, auto takes at most {GOAL} times the time of the better of taylor and radau in "
                         f"{sum(x <= GOAL for x in known)} of {len(known)} cases; at worst {factor(value)} times ({where}).")  # fmt: skip
        others = [row[4 + 2 * i] for row in table if not math.isnan(row[4 + 2 * i])]
        slower, faster = max(others, default=math.nan), min(others, default=math.nan)
        sentences.append(f"bdf takes {factor(faster)} to {factor(slower)} times the time of radau (infinitely many: it never gets there).")
        beside = [row[EXUDYN + i] for row in table if not math.isnan(row[EXUDYN + i])]
        reached = [value for value in beside if math.isfinite(value)]
        if beside:
            times = f", in {factor(min(reached))} to {factor(max(reached))} times the time of auto" if reached else ""
            sentences.append(f"exudyn's implicit methods get to that error on {len(reached)} of {len(beside)} problems{times}.")
    return sentences
