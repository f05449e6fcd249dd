"""Verdict on a system: its FMU against the reference, with bounds from the system's own error growth."""

import math
import random
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .build import RejectedSystem, Wrong, compile_system
from .derivation import Derivation
from .exact import Exact, NoValue
from .event_reference import EventReference
from .reference import Reference, Undecided
from .simulation import simulate_apart

# Allowed errors of all steps of a solver, in units of the effect of errors of the size of the tolerance.
FACTORS = {None: 30, "taylor": 30, "erk": 30, "bdf": 1000, "radau": 100, "auto": 100, "exact": 30}
KICKS = 3  # number of perturbed references
HOPELESS = 0.3  # share of the path at which a bound is too large to decide anything
ROUNDING = 2.0**-52


@dataclass
class Outcome:
    verdict: str = "agrees"  # or rejected, undecided, wrong
    message: str = ""
    regular: bool = False  # True if the motion exists to the end and is known
    error: float = 0.0  # largest error, in units of its bound
    unavailable: list = field(default_factory=list)  # messages of failed derivatives
    families: set = field(default_factory=set)


def judge_system(system, folder, time_limit=60):
    """Outcome for one system; its files remain in the folder."""
    outcome = Outcome(families=system.families)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    try:
        record = simulate_apart(system, compile_system(system, folder), time_limit)
        outcome.unavailable = record.unavailable
        if record.rejection:
            outcome.verdict, outcome.message = "rejected", record.rejection
        compare(system, record, folder, outcome)
        outcome.regular = True
    except RejectedSystem as error:
        outcome.verdict, outcome.message = "rejected", str(error)
    except Wrong as error:
        outcome.verdict, outcome.message = "wrong", str(error)
    except Undecided as error:
        if not record.rejection:
            outcome.verdict, outcome.message = "undecided", str(error)
    return outcome


def compare(system, record, folder, outcome):
    """Compare the FMU's results up to its end, or until it failed. Raises Wrong or Undecided."""
    if record.wrong:
        raise Wrong(record.wrong)
    derivation = Derivation(system)
    exact = None if system.switches else Exact(derivation)
    for point in record.points:
        with suppress(NoValue):
            compare_point(derivation, exact, point, outcome)
    compare_motion(derivation, record, folder, outcome)


def note(outcome, what, ours, exact, bound):
    """Raise Wrong if the error of a value exceeds its bound."""
    if not math.isfinite(exact) or not math.isfinite(bound):
        return
    if not math.isfinite(ours):
        raise Wrong(f"{what} is {ours}; right is {exact!r}")
    error = abs(ours - exact) / bound if bound > 0 else float(ours != exact)
    outcome.error = max(outcome.error, error)
    if error > 1:
        raise Wrong(f"{what} is {ours!r}; right is {exact!r}, up to {bound:.2g}")


# --- The motion ----------------------------------------------------------------------------------------------------


def kicks(seed, tolerance):
    """Return perturbations of the state of the size of the tolerance, with random signs."""
    choose = random.Random(seed)
    return lambda state: [choose.choice([-1, 1]) * tolerance * max(1.0, abs(x)) for x in state]


def compare_motion(derivation, record, folder, outcome):
    system = derivation.system
    reference = (EventReference if system.switches else Reference)(derivation, folder)
    exact = reference.trajectory(7, 1e-16, 0.5)
    other = reference.trajectory(5, 1e-15, 0.3)
    doubt = np.abs(exact - other)
    tolerance = max(system.plan.tolerance, 1e-14)
    spread = np.zeros_like(exact)
    for seed in range(KICKS):
        spread = np.maximum(spread, np.abs(reference.trajectory(6, 1e-15, 0.5, kicks(seed, tolerance)) - exact))
    if system.switches:  # errors of all steps shift the time of a jump
        factor = FACTORS[system.method]
        for seed in range(KICKS):
            spread = np.maximum(spread, np.abs(reference.trajectory(6, 1e-15, 0.5, kicks(seed, factor * tolerance)) - exact) / factor)
    # All three differences may be near 0 at one time, so that neighbours in time are included.
    spread = np.array([spread[max(0, i - 3) : i + 4].max(axis=0) for i in range(len(spread))])
    size = np.maximum(1.0, np.abs(exact))
    bound = FACTORS[system.method] * np.maximum(spread, tolerance * size) + 20 * doubt + 1e-15 * size
    path = np.maximum(1.0, np.ptp(np.nan_to_num(exact), axis=0))
    decided = False
    for i, (row, time_) in enumerate(zip(record.rows, system.plan.times)):
        for j, name in enumerate(system.columns):
            if not math.isfinite(row[j]):
                raise Wrong(f"{name} is {row[j]} at {time_!r}")
            if bound[i, j] < HOPELESS * path[j]:
                decided = decided or i > 0
                note(outcome, f"{name} at {time_!r}", row[j], float(exact[i, j]), float(bound[i, j]))
    if not decided:
        raise Undecided("the system makes errors of the tolerance as large as its path")


# --- Values at points ----------------------------------------------------------------------------------------------


def moved(at, choose):
    """Perturb the values by some rounding errors."""
    return {name: value * (1 + choose.uniform(-8, 8) * ROUNDING) for name, value in at.items()}


def compare_point(derivation, exact, point, outcome):
    system, choose = derivation.system, random.Random(1)
    at = {"time": point.time, **dict(zip(exact.arguments[1:], point.state)), **point.parameters}
    at |= {name: coefficients[0] for name, coefficients in point.inputs.items()}
    labels = [*system.rates, *exact.names]
    when = f" at {point.time!r}"

    def check(what, ours, evaluate, extra, indices):
        """Compare values by index of labels; bounds follow from the value, the terms that cancel, and rounding of the arguments."""
        right = evaluate(at)
        shifted = [evaluate(moved(at, choose)) for _ in range(3)]
        for value, i in zip(ours, indices):
            if any(not math.isfinite(s[i]) for s in shifted):
                continue
            spread = max(abs(s[i] - right[i]) for s in shifted)
            note(outcome, what(i), value, right[i], 1e-10 * (abs(right[i]) + extra(i)) + 100 * spread + 1e-13)

    magnitudes = exact.magnitudes(at)
    extra = lambda i: magnitudes[i] if i < len(magnitudes) else 1.0
    known = [i for i, label in enumerate(labels) if label in point.values]
    check(lambda i: labels[i] + when, [point.values[labels[i]] for i in known], exact.values, extra, known)
    for knowns, seed, unknowns, values in point.directions:
        direction = dict(zip(knowns, seed))
        what = lambda i: f"the derivative of {labels[i]} along {direction}" + when
        check(
            what,
            values,
            lambda place: exact.along(place, direction),
            lambda i: 1.0 + max(magnitudes),
            [labels.index(u) for u in unknowns],
        )
    if point.output_derivatives:
        compare_in_time(system, exact, point, at, outcome, labels, when, choose)


def compare_in_time(system, exact, point, at, outcome, labels, when, choose):
    highest = max(order for _, order in point.output_derivatives)
    states = system.positions + system.velocities
    rows = states + exact.names
    right = exact.in_time(at, point.inputs, highest)
    shifted = [exact.in_time(moved(at, choose), point.inputs, highest) for _ in range(3)]
    for (name, order), value in point.output_derivatives.items():
        i = rows.index(name)
        if any(not math.isfinite(s[i][order]) for s in shifted):
            continue
        spread = max(abs(s[i][order] - right[i][order]) for s in shifted)
        size = max(abs(row[k]) for row in right[: len(states)] for k in range(order + 1) if math.isfinite(row[k]))
        bound = 1e-9 * (abs(right[i][order]) + size + 1) + 100 * spread
        note(outcome, f"derivative {order} of {name}{when}", value, right[i][order], bound)
