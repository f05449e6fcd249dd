"""Compare the error against run time, and against the number of events, of systems with events, with importers of the FMUs and other programs."""

import math
import time
from dataclasses import dataclass, field
from statistics import median

import numpy as np

from numerics.failures import failure
from numerics.programs import silence
from numerics.switching.peers import METHODS
from numerics.switching.problems import GROWING, PROBLEMS
from numerics.times import ratio, take_turns, time_to

TOLERANCES = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12]
STEPS = [1000, 3000, 10000, 30000, 100000]  # numbers of steps of MuJoCo, multiples of POINTS
COUNTS = [10, 30, 100, 300, 1000]  # numbers of events
TOLERANCE, LENGTH = 1e-8, 1e-3  # tolerance, and step of MuJoCo in s, of the comparison against the number of events
LEVELS = [1e-4, 1e-6, 1e-8]  # errors at which times are compared
PATIENCE = 10.0  # s; after a longer run finer settings are not tried

NOTES = [
    "An error is the largest of any position at 100 communication points, against closed forms evaluated with 30 digits: parabolas, Jacobi's elliptic "
    "functions, harmonic motions. Velocities, which jump, are not compared. All take turns in one run, and the fastest round counts, by the processor's time, or by the clock "
    "where that is below a millisecond; medians are in the CSV files.",
    "The FMU does 100 communication steps in a C program; \"one step\" does one, whose error is that at the end. CVODE in C is the same FMU in model exchange, "
    "in a loop as FMPy has it (BDF, roots of the event indicators, the same tolerances and largest steps, asked 100 times), in C without Python, with the "
    "SUNDIALS that the FMUs are built with. FMPy's times include its loop in Python, as its users see them.",
    "SciPy's and heyoka's equations, guards and jumps are written for each phase; each gets one call a phase, and a ball rests where its bounce is slower than the "
    "tolerance. heyoka is compiled before the clock runs, has the numbers of parameters in its code, and a cooldown of 1e-12 s: with its own it passes over the "
    "last bounces of the ball, which then falls through the ground.",
    "MuJoCo's contacts are soft; here each is a spring with the damper of the restitution, stiffer in shorter steps, of which it gets more as well. It has no "
    "friction that sticks more strongly than it slides. Newton's cradle, with four contacts at one time, is left to the FMU and its importers.",
]  # fmt: skip


@dataclass
class Sample:
    """The error and the times of a method with one setting."""

    problem: str
    method: str
    end: float  # s
    setting: float  # tolerance, or the number of fixed steps
    error: float
    events: int  # counted by the FMU; 0 for other programs
    times: list = field(default_factory=list)  # seconds of each round


def methods_of(problem):
    """Return the methods that can express the problem."""
    return [method for method, (program, _) in METHODS.items() if program in ("FMU", "importer", *problem.methods)]


def first_run(problem, method, setting, patience):
    """Return a runner and its Sample without times; None if the method fails, by whatever exception."""
    try:
        runner = METHODS[method][1](problem, setting, patience)
        with np.errstate(all="ignore"):
            error = problem.error(runner.record())
    except ImportError:
        raise
    except Exception:
        return None
    return (runner, Sample(problem.name, method, problem.end, setting, error, getattr(runner, "events", 0))) if math.isfinite(error) else None


def runners_of(problem, settings_of, patience=PATIENCE):
    """Return pairs of runner and Sample, and the methods that are not installed; settings go from coarse to fine until one is too slow."""
    problem.exact  # computed before the clock starts
    runners, missing = [], set()
    for method in methods_of(problem):
        for setting in settings_of(method):
            begin = time.perf_counter()
            try:
                first = first_run(problem, method, setting, patience)
            except ImportError:
                missing.add(method)
                break
            runners += [] if first is None else [first]
            if time.perf_counter() - begin > patience:
                break
    return runners, missing


def sample_problem(problem, settings_of, quick):
    with silence():
        runners, missing = runners_of(problem, settings_of, PATIENCE / 4 if quick else PATIENCE)
        take_turns(runners, quick)
    return [sample for _, sample in runners], missing


def settings(quick):
    """Return a function of a method that returns its settings."""
    return lambda method: (STEPS if method.startswith("MuJoCo") else TOLERANCES)[:: 2 if quick else 1]


def one_setting(problem):
    steps = 100 * math.ceil(problem.end / LENGTH / 100)
    return lambda method: [steps if method.startswith("MuJoCo") else TOLERANCE]


def grown(problem, quick, progress):
    """Return pairs (number of events, Sample) for growing numbers of events, and the methods that are not installed."""
    samples, missing = [], set()
    for count in COUNTS[:3] if quick else COUNTS:
        longer = problem.with_events(count)
        some, absent = sample_problem(longer, one_setting(longer), quick)
        samples, missing = samples + [(count, sample) for sample in some], missing | absent
    progress(f"{problem.name}, more and more events")
    return samples, missing


def collect(quick, progress):
    """Return the samples, pairs (number of events, Sample), the methods that are not installed, and sentences about failures."""
    samples, counted, missing, failures = [], [], set(), []
    for problem in PROBLEMS:
        try:
            some, absent = sample_problem(problem, settings(quick), quick)
            samples, missing = samples + some, missing | absent
        except Exception as error:
            failures.append(failure(problem.title, error))
        progress(problem.name)
    for problem in GROWING:
        try:
            some, absent = grown(problem, quick, progress)
            counted, missing = counted + some, missing | absent
        except Exception as error:
            failures.append(failure(f"{problem.title}, for more and more events", error))
    return samples, counted, missing, failures


def points_of(samples, problem, method, of=min):
    """Return (seconds, error) for each setting."""
    return [(of(s.times), s.error) for s in samples if (s.problem, s.method) == (problem.name, method) and s.times]


SAMPLES_HEADER = ["problem", "method", "end [s]", "tolerance or steps", "error", "events", "fastest [s]", "median [s]"]


def sample_row(sample):
    return [sample.problem, sample.method, sample.end, sample.setting, sample.error, sample.events, min(sample.times), median(sample.times)]


OTHERS = list(METHODS)[1:]  # all methods but the FMU
HEADER = ["problem", "error", "FMU [µs]", *(f"{method} / FMU" for method in OTHERS)]


def row(samples, missing, problem, level):
    """Return a row of times to an equal error: infinite if a method does not reach it, NaN if it cannot express the problem."""
    tried = [method for method in methods_of(problem) if method not in missing]
    seconds = {method: time_to(points_of(samples, problem, method), level) if method in tried else math.nan for method in METHODS}
    return [problem.title, level, 1e6 * seconds["FMU"], *(ratio(seconds[method], seconds["FMU"]) for method in OTHERS)]


def rows(samples, missing):
    sampled = {s.problem for s in samples}
    return [row(samples, missing, problem, level) for problem in PROBLEMS if problem.name in sampled for level in LEVELS]


COUNTED = ["problem", "events", *(f"{method}, {what}" for what in ("error", "µs an event") for method in METHODS)]


def counted_rows(counted):
    """Return the rows for growing numbers of events; a cell is empty if a method failed, was too slow, or cannot express the problem."""
    table = []
    for problem in GROWING:
        for count in dict.fromkeys(count for count, s in counted if s.problem == problem.name):
            known = {s.method: s for other, s in counted if (other, s.problem) == (count, problem.name)}
            errors = [known[method].error if method in known else "" for method in METHODS]
            each = [1e6 * min(known[method].times) / count if method in known else "" for method in METHODS]
            table.append([problem.title, count, *errors, *each])
    return table


def factor(value):
    return f"{value:.2g}" if value < 10 else f"{value:,.0f}"


def summary(table, samples):
    """Return a sentence for each error level, with the ratios of the other methods' times to that of the FMU."""
    sentences = []
    for level in LEVELS[1:]:
        others = []
        for method, column in zip(OTHERS, range(3, len(HEADER))):
            known = [line[column] for line in table if line[1] == level and not math.isnan(line[column])]
            reached = [value for value in known if math.isfinite(value)]
            if not known:
                continue
            least = min((s.error for s in samples if s.method == method), default=math.nan)
            text = f"{factor(min(reached))} to {factor(max(reached))} times that time" if reached else f"never; its smallest error is {least:.1g}"
            others.append(f"{method}: {text}" + (f", on {len(reached)} of {len(known)} systems" if reached and len(reached) < len(known) else ""))
        sentences.append((f"Systems that switch, to an error of {level:g}, beside the FMU with 100 communication steps:", others))
    return sentences
