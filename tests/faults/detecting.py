"""
Tests the tests by mutation: scripts/checks/faults [--sample N] [--seed S] [--changed [BASE]] [--file PATH] [--limit SECONDS].

What is cheapest comes first for each mutant:
1. the tests in C;
2. for lagc, the build of the systems whose generated files differ from those of lagc without the mutant;
3. the modules of tests that call the mutant's function, the fastest first, until one fails.
A mutant that is not detected is printed with its change.
"""

import argparse
import csv
import difflib
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

from mutations import changed_since, line_of, mutants_of, mutated
from planting import ROOT, TREE, build, compile_commands, configure, copy_project, function_of, kind_of, plant, text_of

TABLE = ROOT / "build" / "faults.csv"
KEPT = ROOT / "build" / "faults-baseline.json"
SOURCES = ["src/compiler", "src/import", "src/runtime", "src/ensemble", "modelDescription"]
# Without platforms, whose tests need browsers, other compilers and emulators.
ROOMS = ["compiler", "language", "mechanics", "space", "switching", "solvers", "fmi", "scripts"]
REBUILT = 6  # systems that are built anew at first, of those that a mutant of lagc changes; the shortest ones
CORES = os.cpu_count()
NO_TESTS = 5  # exit code of pytest
KILLED = -9


def sources(names):
    paths = [path for name in names for path in ([ROOT / name] if (ROOT / name).is_file() else (ROOT / name).rglob("*.c"))]
    return sorted(str(path.relative_to(ROOT)) for path in paths)


def candidates(options):
    """Yield the mutants of the chosen files and lines, as (file, mutant)."""
    lines = changed_since(options.changed, ROOT) if options.changed else None
    for file in sources(options.file or SOURCES):
        if lines is None or file in lines:
            for mutant in mutants_of(text_of(file)):
                if lines is None or line_of(text_of(file), mutant) in lines[file]:
                    yield file, mutant


def choose(options):
    """Return a random sample of the mutants that compile, and the number of equivalent ones among those drawn."""
    drawn = list(candidates(options))
    random.Random(options.seed).shuffle(drawn)
    commands, chosen, equivalent = compile_commands(), [], 0
    for file, mutant in drawn:
        if options.sample and len(chosen) == options.sample:
            break
        kind = kind_of(file, mutant, commands)
        equivalent += kind == "equivalent"
        if kind == "mutant":
            chosen.append((file, mutant))
    return chosen, equivalent


def run(words, environment, seconds):
    """Run a command in the copy. Return its output and its exit code, which is KILLED after a timeout."""
    process = subprocess.Popen(words, cwd=TREE, env=os.environ | environment, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True)  # fmt: skip
    try:
        output, _ = process.communicate(timeout=seconds)
        return output, process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        return process.communicate()[0], KILLED


def ctest(environment, seconds):
    """True if the tests in C pass."""
    words = ["ctest", "--test-dir", "build", "--no-tests=error", "--stop-on-failure", "-Q", f"-j{CORES}"]
    return run(words, environment, seconds)[1] == 0


def pytest(module, environment, seconds, *words):
    start = [f"{TREE}/build/venv/bin/python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not release", "--tb=no"]
    return run([*start, *words, module], environment, seconds)


class Baseline:
    """
    The tests without a mutant: each module's time, the tests of it that fail, and the functions that it calls. They are kept for other
    samples of mutants, until a file of the project changes.
    """

    def __init__(self, digest):
        self.reached = TREE / "build" / "reached"
        shutil.rmtree(self.reached, ignore_errors=True)
        kept = json.loads(KEPT.read_text()) if KEPT.exists() else {}
        self.digest, self.rows = digest, kept["modules"] if kept.get("digest") == digest else {}
        self.modules = [str(path.relative_to(TREE)) for room in ROOMS for path in sorted((TREE / "tests" / room).glob("test_*.py"))]
        with ThreadPoolExecutor(CORES) as pool:
            list(pool.map(self.measure, [module for module in self.modules if module not in self.rows]))
        self.seconds, self.failing, self.calls = (
            {module: self.rows[module][column] for module in self.modules} for column in ("seconds", "failing", "calls")
        )

    def measure(self, module):
        started = time.monotonic()
        folder = self.reached / module
        folder.mkdir(parents=True)
        output, _ = pytest(module, {"PLANTED_REACHED": str(folder)}, 900)
        failing = re.findall(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", output, re.MULTILINE)
        calls = sorted(path.name for path in folder.iterdir())
        self.rows[module] = {"seconds": round(time.monotonic() - started, 1), "failing": failing, "calls": calls}
        KEPT.write_text(json.dumps({"digest": self.digest, "modules": dict(self.rows)}))

    def modules_of(self, function, successes):
        """Modules that call a function: first those that detected mutants of its file, then the fastest."""
        called = [module for module in self.modules if function in self.calls[module]]
        return sorted(called, key=lambda module: (-successes.get(module, 0), self.seconds[module]))

    def failure(self, module, number):
        """Return the first test of a module that fails with a mutant, or the module if no test is named; "" if all pass."""
        words = [word for test in self.failing[module] for word in ("--deselect", test)]
        output, code = pytest(module, {"PLANTED_FAULT": str(number)}, 30 + 4 * self.seconds[module], "-x", *words)
        named = re.search(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", output, re.MULTILINE)
        return "" if code in (0, NO_TESTS) else named[1] if named else module


class Systems:
    """The files that lagc writes of all systems, by their digests."""

    def __init__(self):
        self.systems = {}  # by name: the folder of the build, and system.xml
        for folder, top in (("build", "fmu"), ("build/test-systems", "tests/systems")):
            for path in sorted((TREE / top).glob("*/system.xml")):
                if (TREE / folder / "systems" / path.parent.name / "system.c").exists():
                    self.systems[path.parent.name] = folder, path
        self.expected = self.digests("0")

    def derived(self, name):
        return TREE / "build" / "derived" / name

    def digest(self, name, fault):
        folder = self.derived(name)
        shutil.rmtree(folder, ignore_errors=True)
        lagc, (_, system) = TREE / "build" / "bin" / "lagc", self.systems[name]
        _, code = run([lagc, system, "-o", folder], {"PLANTED_FAULT": fault}, 60)
        if code != 0:
            return None
        return hashlib.sha256(b"".join(path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file())).digest()

    def digests(self, fault):
        """Digests by name; None where lagc fails."""
        with ThreadPoolExecutor(CORES) as pool:
            return dict(zip(self.systems, pool.map(lambda name: self.digest(name, fault), self.systems)))

    def rebuild(self, names, fault):
        """Derive and build FMUs by the lagc with a mutant; true if all could be built."""
        codes = []
        for folder in {self.systems[name][0] for name in names}:
            own = [name for name in names if self.systems[name][0] == folder]
            for name in own:
                (TREE / folder / "systems" / name / "system.c").unlink(missing_ok=True)
            targets = [f"fmu_{version}{name}" for name in own for version in (("", "3_") if folder == "build" else ("",))]
            words = ["cmake", "--build", folder, "--parallel", str(CORES), "--target", *targets]
            codes.append(run(words, {"PLANTED_FAULT": fault}, 600)[1])
        return not any(codes)


def detected_in_modules(number, function, baseline, systems, old, successes, limit):
    """
    Return the test that detects a mutant, "time limit" if not all could run within the seconds, or "none". `old` lists systems whose FMUs
    the mutant would change. They are built when a test of one fails, which may have compared its FMU with the output of lagc.
    """
    started, modules = time.monotonic(), baseline.modules_of(function, successes)
    with ThreadPoolExecutor(CORES) as pool:
        for first in range(0, len(modules), CORES):
            if time.monotonic() - started > limit:
                return "time limit"
            group = modules[first : first + CORES]
            for module, test in zip(group, pool.map(lambda module: baseline.failure(module, number), group)):
                if any(name in test.partition("[")[2] for name in old):
                    systems.rebuild(old, str(number))
                    old.clear()
                    test = baseline.failure(module, number)
                if test:
                    successes[module] = successes.get(module, 0) + 1
                    return test
    return "none"


def detected_by(number, file, function, baseline, systems, successes, limit):
    """Return what detects a mutant, "time limit" or "none"."""
    if not ctest({"PLANTED_FAULT": str(number)}, 120):
        return "ctest"
    differ = []
    if not file.startswith(("src/runtime", "src/ensemble")):
        now = systems.digests(str(number))
        failing = [name for name in now if now[name] is None]
        if failing:
            return f"lagc of {failing[0]}"
        differ = [name for name in now if now[name] != systems.expected[name]]
        differ.sort(key=lambda name: (systems.derived(name) / "system.c").stat().st_size)
    old = differ[REBUILT:]
    try:
        if differ and not systems.rebuild(differ[:REBUILT], str(number)):
            return "build"
        return detected_in_modules(number, function, baseline, systems, old, successes, limit)
    finally:
        if differ:
            systems.rebuild([name for name in differ if name not in old], "0")


def difference(file, mutant):
    before, after = (text.decode().splitlines(True) for text in (text_of(file), mutated(text_of(file), mutant)))
    return "".join(difflib.unified_diff(before, after, file, file, n=2))


def options_of(words):
    parser = argparse.ArgumentParser(prog="scripts/checks/faults", description="Test the tests by mutation of the C sources.")
    parser.add_argument("--sample", type=int, help="number of mutants, chosen at random; all by default")
    parser.add_argument("--seed", type=int, default=1, help="seed of the choice")
    parser.add_argument("--changed", nargs="?", const="main", metavar="BASE", help="only lines that differ from a commit, by default main")
    parser.add_argument("--file", action="append", metavar="PATH", help="only this file or folder")
    parser.add_argument("--limit", type=float, default=300, help="seconds of tests for each mutant")
    return parser.parse_args(words)


def main(words):
    options = options_of(words)
    digest = copy_project()
    configure()
    chosen, equivalent = choose(options)
    if not chosen:
        sys.exit("there are no mutants to test")
    print(f"{len(chosen)} mutants; left out: {equivalent} with the same object code", flush=True)
    plant(sources(SOURCES), chosen)
    build()
    if not ctest({}, 600):
        sys.exit("the tests in C fail without a mutant")
    baseline, systems, successes, survivors = Baseline(digest), Systems(), {}, 0
    failing = sum(map(len, baseline.failing.values()))
    print(f"without a mutant: {sum(baseline.seconds.values()):.0f} s of {len(baseline.modules)} modules; {failing} tests fail", flush=True)
    with open(TABLE, "w", newline="") as table:
        writer = csv.writer(table)
        writer.writerow(["file", "line", "kind", "right", "wrong", "detected by", "seconds"])
        for number, (file, mutant) in enumerate(chosen, 1):
            started = time.monotonic()
            by = detected_by(number, file, function_of(file, mutant), baseline, systems, successes.setdefault(file, {}), options.limit)
            seconds = round(time.monotonic() - started)
            line, right = line_of(text_of(file), mutant), text_of(file)[mutant.start : mutant.end].decode()
            writer.writerow([file, line, mutant.kind, right, mutant.wrong.decode(), by, seconds])
            table.flush()
            print(f"{number:4} {by} ({seconds} s): {file}:{line}: {right}  ->  {mutant.wrong.decode()}", flush=True)
            if by in ("none", "time limit"):
                survivors += 1
                print(difference(file, mutant), flush=True)
    score = 100 * (1 - survivors / len(chosen))
    print(f"{len(chosen) - survivors} of {len(chosen)} mutants detected, {score:.0f} %; the table is {TABLE.relative_to(ROOT)}")


if __name__ == "__main__":
    main(sys.argv[1:])
