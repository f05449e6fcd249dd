"""Compare the error against run time of systems with constraints with exudyn and MuJoCo, in the same run."""

import contextlib
import io
import math
import time
from dataclasses import dataclass, field
from statistics import median

import numpy as np

from numerics.driver import POINTS, step
from numerics.failures import failure
from numerics.mechanisms import peers as mechanism_peers
from numerics.mechanisms.peers import PEERS
from numerics.mechanisms.problems import PROBLEMS as PLANAR
from numerics.mechanisms.problems import Planar
from numerics.programs import silence
from numerics.space import peers as spatial_peers
from numerics.space.problems import PROBLEMS as SPATIAL
from numerics.times import ratio, take_turns, time_to

NOTES = [
    "All programs take turns in one run, and the fastest of five rounds (of two with --quick, or above half a second) counts; the medians and all samples are in "
    "the CSV files. An error is the largest at 100 communication points (Andrews' mechanism: at the end), relative where values are above 1.",
    "The FMU does 100 communication steps in a C program. exudyn and MuJoCo get one call from Python, and are recorded in another run. "
    "The processor time counts. Models are built, and the FMU is initialized, before that.",
    "exudyn has bodies with joints as constraints (a distance for the pendulum; in space, Euler parameters), modified Newton, one thread, and sparse "
    "matrices for the large system; its explicit methods do not support constraints, and its joints have no inertia of a drive, which the robot arm needs. "
    "Of Bricard's mechanism it gets the constraints without the redundant one. MuJoCo has a tree of joints, so that the pendulum has one angle and no constraint, and "
    "closes loops with soft constraints, as stiff as it allows: a time constant of two steps, an impedance of 0.9999. That softness is in its errors.",
    "The drifts that IFToMM's library of benchmark problems asks for are quoted without its problem sheets at hand. The authors' earlier "
    "specification of A01 (lim.ii.udc.es/mbsbenchmark, 2005) asks for positions to 0.1 and 0.001 over 2000 s. A03 has no such figure, and that of A05 is not known here.",
    "The reference of the governor is checked as those of stiff systems are. That of the robot arm is Pinocchio's algorithm with SciPy's method of order 8, "
    "of the links that MuJoCo gets. The FMU has the top by Euler angles, of which its spin is one; exudyn and MuJoCo turn it by a quaternion, for which the spin is fast.",
    "The published state of Andrews' mechanism is good to about 1e-10, where all our tolerances and both methods end up.",
    "inf: never gets there with the steps that end in ten seconds. –: not installed, or the program cannot express it.",
]
PROBLEMS = [*PLANAR, *SPATIAL]
SOLVERS = ["taylor", "radau"]  # each has a build folder of all systems
METHODS = [*SOLVERS, *PEERS]
TOLERANCES = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12]
PATIENCE = 10.0  # s; longer runs are not tried


@dataclass
class Sample:
    """The error and the times of a method with one setting."""

    system: str
    method: str
    setting: float  # tolerance, or the number of fixed steps
    drift: float  # largest drift of the energy at the communication points, in J
    error: float  # against the reference
    times: list = field(default_factory=list)  # seconds of each round

    def measured(self, measure):
        return getattr(self, measure)


class Fmu:
    """The FMU with POINTS communication steps."""

    def __init__(self, problem, tolerance, solver, patience):
        self.problem, self.words = problem, (solver, problem.system, {}, problem.end, tolerance, POINTS)
        self.patience, self.repeats = patience, 1

    def run(self):
        """Return the seconds of the fastest of several repeats of the doStep loop."""
        stepped = step(*self.words, self.repeats, 0, timeout=10 * PATIENCE)
        self.repeats = int(min(max(0.02 / stepped.seconds, 1), 500))
        return stepped.seconds

    def record(self):
        stepped = step(*self.words, 0, timeout=self.patience)
        if stepped is None:
            raise TimeoutError
        return stepped.columns(["totalEnergy"])[:, 0], stepped.columns(self.problem.compared)


class Peer:
    """Another program, measured by the processor time of one call, which other load on the machine disturbs less than wall-clock time."""

    def __init__(self, problem, steps, peer):
        program, method = PEERS[peer]
        peers = mechanism_peers if isinstance(problem.model, Planar) else spatial_peers
        build = {"exudyn": peers.Exudyn, "MuJoCo": peers.MuJoCo}[program]
        self.model = build(problem, int(steps), method)
        self.record = self.model.record

    def run(self):
        begin = time.process_time()
        self.model.run()
        return time.process_time() - begin


def drift(problem, energies):
    """Return the largest drift of the energy in J; NaN for mechanisms with motors and springs, whose bodies' energy is not constant."""
    if not any(measure == "drift" for measure, _, _ in problem.levels):
        return math.nan
    return float(np.max(np.abs(energies - problem.model.start_energy())))


def first_run(problem, method, setting, patience=PATIENCE):
    """Return a runner and its Sample without times; None if the method fails."""
    try:
        runner = Fmu(problem, setting, method, patience) if method in SOLVERS else Peer(problem, setting, method)
        with np.errstate(all="ignore"):
            energies, rows = runner.record()
            sample = Sample(problem.system, method, setting, drift(problem, energies), problem.error(rows))
    except (TimeoutError, RuntimeError, ValueError):
        return None
    known = [value for value in (sample.drift, sample.error) if not math.isnan(value)]
    return (runner, sample) if known and all(map(math.isfinite, known)) else None


def settings_of(problem, method, quick):
    """Return the tolerances or numbers of steps of a method, from coarse to fine."""
    settings = TOLERANCES if method in SOLVERS else problem.steps
    return settings[1::2] if quick else settings


def methods_of(problem):
    """Return the methods that can express the mechanism."""
    return [*SOLVERS, *(peer for peer, (program, _) in PEERS.items() if program in problem.programs)]


def runners_of(problem, quick):
    """Return pairs of runner and Sample, and the methods that are not installed; settings that would take longer than PATIENCE are skipped."""
    runners, missing, patience = [], set(), PATIENCE / 4 if quick else PATIENCE
    if problem.expected is not None:
        problem.exact  # computed before the clock starts, since a reference may take longer than PATIENCE
    for method in methods_of(problem):
        seconds, before = 0.0, 1.0  # time of the previous setting, and this setting
        for setting in settings_of(problem, method, quick):
            if seconds * (1.0 if method in SOLVERS else setting / before) > patience:
                break
            begin, before = time.perf_counter(), setting
            try:
                first = first_run(problem, method, setting, patience)
            except ImportError:
                missing.add(method)
                break
            if first is not None:
                runners.append(first)
            # An FMU that fails at a loose tolerance may succeed at a tighter one, in less time.
            seconds = 0.0 if first is None and method in SOLVERS else time.perf_counter() - begin
    return runners, missing


def sample_problem(problem, quick):
    """Return the samples and the methods that are not installed; all methods take turns, so that other load affects all of them."""
    with silence(), contextlib.redirect_stdout(io.StringIO()):
        runners, missing = runners_of(problem, quick)
        take_turns(runners, quick)
    return [sample for _, sample in runners], missing


def chosen(quick):
    return [problem for problem in PROBLEMS if problem.quick or not quick]


def collect(quick, progress):
    """Return the samples, the methods that are not installed, and a sentence about each system that failed, by its name."""
    samples, missing, failures = [], set(), {}
    for problem in chosen(quick):
        try:
            some, absent = sample_problem(problem, quick)
            samples, missing = samples + some, missing | absent
        except Exception as error:
            failures[problem.system] = failure(problem.title, error)
        progress(f"mechanisms, {problem.system}")
    return samples, missing, failures


SAMPLES_HEADER = ["system", "method", "tolerance or steps", "fastest [s]", "median [s]", "drift [J]", "error"]


def sample_rows(samples):
    return [[s.system, s.method, s.setting, min(s.times), median(s.times), s.drift, s.error] for s in samples]


def points_of(samples, system, method, measure, typical=min):
    """Return (seconds, error) for each sample; `typical` is min for the fastest round, or median."""
    return [(typical(s.times), s.measured(measure)) for s in samples if (s.system, s.method) == (system, method)]


RATIOS = [f"{method} / taylor" for method in METHODS[1:]]
LEVEL = ["mechanism", "measure", "level", "whose", "the FMU reaches", "times below"]
HEADER = [*LEVEL, *(f"{method} [ms]" for method in METHODS), *RATIOS, *(f"{ratio}, medians" for ratio in RATIOS)]
TIMES, FASTEST = slice(len(LEVEL), len(LEVEL) + len(METHODS)), slice(len(LEVEL) + len(METHODS), len(LEVEL) + 2 * len(METHODS) - 1)


def text_of(problem, measure):
    return "drift of the energy [J]" if measure == "drift" else f"error to {problem.reference}"


def row(samples, missing, problem, measure, level, whose):
    """Return a row of times to an equal error: infinite if a method does not reach it, NaN if it cannot express the mechanism."""
    tried = [m for m in methods_of(problem) if m not in missing]
    fastest, typical = ({m: time_to(points_of(samples, problem.system, m, measure, of), level) if m in tried else math.nan
                         for m in METHODS} for of in (min, median))  # fmt: skip
    ratios = [ratio(seconds[m], seconds["taylor"]) for seconds in (fastest, typical) for m in METHODS[1:]]
    reached = min((error for _, error in points_of(samples, problem.system, "taylor", measure)), default=math.nan)
    return [problem.title, text_of(problem, measure), level, whose, reached, level / reached, *(1e3 * fastest[m] for m in METHODS), *ratios]


def rows(samples, missing):
    """Return the rows of all systems that did not fail."""
    sampled = {s.system for s in samples}
    return [row(samples, missing, problem, *level) for problem in PROBLEMS if problem.system in sampled for level in problem.levels]


def factor(value):
    return "never gets there" if math.isinf(value) else f"takes {value:.3g} times that"


def summary(table):
    """Return a sentence for each accuracy that IFToMM's library asks for, with the faster method of each program."""
    sentences = []
    for line in table:
        if line[3] != "IFToMM":
            continue
        ratios = dict(zip(METHODS[1:], line[FASTEST]))
        others = []
        for program in ("exudyn", "MuJoCo"):
            known = [value for method, value in ratios.items() if method.startswith(program) and not math.isnan(value)]
            others += [f"{program} {factor(min(known))}"] if known else []
        sentences.append(f"Mechanisms, {line[0]}: the FMU takes {line[TIMES][0]:.3g} ms to a {line[1].removesuffix(' [J]')} of {line[2]:g} J; "
                         f"{', '.join(others) or 'no other program is installed'}. Its smallest drift is {line[4]:.1g} J.")  # fmt: skip
    return sentences
