"""Compare the error against run time of bodies in contact with the ground, with MuJoCo and Drake."""

import math
from dataclasses import dataclass, field
from functools import partial

from numerics.failures import failure
from numerics.programs import silence
from numerics.times import take_turns, time_to
from numerics.touching.peers import Drake, DrakeQuadruped, Fmu, FmuQuadruped, MuJoCo, MuJoCoQuadruped
from numerics.touching.problems import PROBLEMS

STEPS = [1e-2, 2e-3, 1e-3, 2e-4, 1e-4]  # s, of MuJoCo and Drake
TOLERANCES = [1e-6, 1e-8, 1e-10]  # tolerances of the FMU with rigid contacts
# Settings of compliant contacts: the approximate penetration in m, and a thousandth of the creep velocity in m/s.
SOFTNESS = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8]
# Settings of Drake's continuous plant: the penetration in m and the creep in m/s, and up to 1e-3 the accuracy of its integrator.
ALLOWANCES = [1e-2, 1e-3, 1e-4, 1e-5]
METHODS = ["FMU, rigid", "FMU, compliant", "MuJoCo", "Drake, discrete", "Drake, continuous"]
HEADER = ["problem", "error", "to", *(f"{method} [ms]" for method in METHODS)]
LEVELS, WEIGHT_LEVELS = [1e-2, 1e-3, 1e-4, 1e-6], [1e-6, 1e-8]

NOTES = [
    "Errors are of the place in the end, in m, against closed forms; of the quadruped of the weight that its feet bear after ten seconds, as a share of its own. All take turns, and the fastest round "
    "counts, by the processor's time. The FMU does one communication step in a C program; MuJoCo and Drake advance in one call.",
    "Rigid: <contact> and <friction>, of which each event is located. Compliant: shapes with a stiffness and a creep, stiffer with less creep where the error is to be smaller. The quadruped stands on compliant contacts in all, "
    "read from one URDF.",
    "MuJoCo 4 has elliptic cones, contacts as stiff as its step allows, and a restitution by a spring with a damper. Drake's discrete plant has spheres that touch at points, and a box by hydroelastic contact. "
    "Its continuous plant has contact at points, at the corners of the box, by the integrator radau3 with error control. Neither has restitution.",
    "Never: with no setting of these methods. Steps are 1e-2 to 1e-4 s; allowances of the continuous plant, a penetration in m and a creep in m/s, 1e-2 to 1e-5. Compliant contacts keep an error of their own, which falls with the setting alone.",
]  # fmt: skip


@dataclass
class Sample:
    """The error and the times of a method with one setting."""

    problem: str
    method: str
    setting: float  # tolerance, step in s, or softness
    error: float
    times: list = field(default_factory=list)  # seconds of each round


class Runner:
    """A run for take_turns(): run() returns its seconds."""

    def __init__(self, run):
        self.result = run

    def run(self):
        return self.result()[0]


def ways():
    """Yield (name of the problem, method, setting, function that builds the run)."""
    for problem in PROBLEMS:
        yield from ((problem.name, METHODS[0], tolerance, partial(Fmu, problem, tolerance, False)) for tolerance in TOLERANCES)
        if problem.soft:
            yield from ((problem.name, METHODS[1], softness, partial(Fmu, problem, softness, True)) for softness in SOFTNESS)
        yield from ((problem.name, METHODS[2], step, partial(MuJoCo, problem, step)) for step in STEPS)
        if not problem.restitution:
            yield from ((problem.name, METHODS[3], step, partial(Drake, problem, step, False)) for step in STEPS)
            yield from ((problem.name, METHODS[4], allowance, partial(Drake, problem, allowance, True)) for allowance in ALLOWANCES)
    yield from (("quadruped", METHODS[1], tolerance, partial(FmuQuadruped, tolerance)) for tolerance in TOLERANCES)
    yield from (("quadruped", METHODS[2], step, partial(MuJoCoQuadruped, step)) for step in STEPS[:4])
    yield from (("quadruped", METHODS[3], step, partial(DrakeQuadruped, step, False)) for step in STEPS[:3])
    yield from (("quadruped", METHODS[4], allowance, partial(DrakeQuadruped, allowance, True)) for allowance in ALLOWANCES[:2])


def collect(quick, progress):
    """Return the samples, the methods that are not installed, and sentences about failures."""
    runners, missing, failures = [], set(), []
    with silence():
        for name, method, setting, build in ways():
            if method in missing or (quick and setting < 1e-3 and method in METHODS[2:]):
                continue
            try:
                run = build().run
                error = run()[1]
            except ImportError:
                missing.add(method)
            except Exception as problem:  # other programs may raise any exception
                failures.append(failure(f"{name} by {method}", problem))
            else:
                if math.isfinite(error):
                    runners.append((Runner(run), Sample(name, method, setting, error)))
        take_turns(runners, quick)
    progress("bodies that touch")
    return [sample for _, sample in runners], missing, failures


def points_of(samples, problem, method):
    return [(min(s.times), s.error) for s in samples if (s.problem, s.method) == (problem, method)]


def cell(points, level):
    """Return the time in ms; "never" if no setting reaches the error, and "" if the program cannot express the problem."""
    seconds = time_to(points, level) if points else None
    return "" if seconds is None else "never" if math.isinf(seconds) else seconds * 1e3


def rows(samples):
    titles = {problem.name: problem.title for problem in PROBLEMS} | {"quadruped": "quadruped that stands for 10 s"}
    return [[title, "of the weight" if name == "quadruped" else "of the place [m]", level, *(cell(points_of(samples, name, method), level) for method in METHODS)]
            for name, title in titles.items() for level in (WEIGHT_LEVELS if name == "quadruped" else LEVELS)]  # fmt: skip
