"""Thousands of random systems: see scripts/checks/differential."""

import argparse
import collections
import multiprocessing
import re
import shutil
import sys
import tempfile
import time
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from fmu import ROOT

from .comparison import Outcome, judge_system
from . import generator, switching_generator
from .reference import integrator

GENERATORS = {"smooth": generator.generate, "switching": switching_generator.generate}
VERDICTS = ["agrees", "rejected", "undecided", "wrong"]


def examine(task):
    kind, seed, number, keep = task
    folder = Path(tempfile.mkdtemp(prefix=f"random{number}-"))
    try:
        outcome = judge_system(GENERATORS[kind](seed, number), folder)
    except Exception:
        outcome = Outcome("wrong", "the test itself: " + traceback.format_exc()[-1500:])
    if outcome.verdict == "wrong":
        leave(kind, seed, number, keep, outcome)
    shutil.rmtree(folder)
    return number, outcome


def leave(kind, seed, number, keep, outcome):
    """Write a folder for each wrong system."""
    place = keep / f"{kind}-{seed}-{number}"
    place.mkdir(parents=True, exist_ok=True)
    system = GENERATORS[kind](seed, number)
    system.write(place)
    command = f"scripts/checks/differential --kind {kind} --seed {seed} --only {number}"
    (place / "README").write_text(
        f"{outcome.message}\n\nfamilies: {', '.join(sorted(system.families))}\nplan: {system.plan}\n\n{command}\n"
    )


def general(message):
    """The message without its numbers and names, for counting."""
    return re.sub(r"'[^']*'", "'...'", re.sub(r"-?\d+(\.\d+)?(e[-+]?\d+)?", "#", message))[:150]


def report(outcomes, seconds):
    counts = collections.Counter(o.verdict for o in outcomes.values())
    print(f"\n{len(outcomes)} systems in {seconds:.0f} s: " + ", ".join(f"{counts[v]} {v}" for v in VERDICTS))
    for verdict, regular in (("rejected", True), ("rejected", False), ("undecided", False)):
        chosen = {n: general(o.message) for n, o in outcomes.items() if o.verdict == verdict and o.regular == regular}
        for message, count in collections.Counter(chosen.values()).most_common(25):
            example = min(number for number, text in chosen.items() if text == message)
            print(f"  {verdict}{' though regular' if regular else '':15}{count:5}  {message} (--only {example})")
    unavailable = collections.Counter(general(m) for o in outcomes.values() for m in o.unavailable)
    for message, count in unavailable.most_common(10):
        print(f"  no derivative {count:5}  {message}")
    errors = sorted((o.error, number) for number, o in outcomes.items() if o.verdict == "agrees")
    if errors:
        parts = [f"{errors[int(share * (len(errors) - 1))][0]:.2g}" for share in (0.5, 0.9, 0.99)]
        print(f"errors in units of their bounds: {', '.join(parts)} (half, 90 %, 99 % of those that agree)")
        print("next to wrong: " + ", ".join(f"--only {number} ({error:.2g})" for error, number in errors[:-6:-1]))
    print(f"\n{'family':28}" + "".join(f"{v:>11}" for v in VERDICTS))
    for family in sorted({f for o in outcomes.values() for f in o.families}):
        row = collections.Counter(o.verdict for o in outcomes.values() if family in o.families)
        print(f"{family:28}" + "".join(f"{row[v]:11}" for v in VERDICTS))
    for number, o in sorted(outcomes.items()):
        if o.verdict == "wrong":
            print(f"wrong {number}: {o.message[:300]}")


def main():
    parser = argparse.ArgumentParser(
        prog="scripts/checks/differential", description="Random systems against an independent truth"
    )
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0, help="number of the first system")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=GENERATORS, default="smooth")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", type=int, help="one system by its number")
    parser.add_argument(
        "--keep", type=Path, default=ROOT / "build" / "differential", help="where wrong systems are left"
    )
    words = parser.parse_args()
    integrator()
    numbers = [words.only] if words.only is not None else range(words.first, words.first + words.count)
    outcomes, begin = {}, time.perf_counter()
    tasks = [(words.kind, words.seed, number, words.keep) for number in numbers]
    # Workers of a Pool may not have child processes.
    with ProcessPoolExecutor(words.jobs, multiprocessing.get_context("fork")) as pool:
        for future in as_completed([pool.submit(examine, task) for task in tasks]):
            number, outcome = future.result()
            outcomes[number] = outcome
            if outcome.verdict == "wrong" or words.only is not None:
                print(f"{number}: {outcome.verdict}: {outcome.message[:400]} {sorted(outcome.families)}", flush=True)
    report(outcomes, time.perf_counter() - begin)
    return any(o.verdict == "wrong" for o in outcomes.values())


if __name__ == "__main__":
    sys.exit(main())
