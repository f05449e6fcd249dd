"""
Plant each fault of faults.py in a copy of the project: scripts/checks/faults [INDEX IN THE LIST ...]. Build the targets of its test, and run that test.
Fails if a fault is not detected, or if these tests fail without a fault.
"""

import os
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

from faults import FAULTS
from locations import find

ROOT = Path(__file__).resolve().parent.parent.parent
TREE = ROOT / "build" / "faults"
PASSES, FAILS, ABSENT = range(3)


def copy_project():
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    for file in subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n"):
        if not (ROOT / file).is_file():
            continue
        target = TREE / file
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_bytes() != (ROOT / file).read_bytes():
            shutil.copyfile(ROOT / file, target)
            shutil.copymode(ROOT / file, target)
    (TREE / "build").mkdir(exist_ok=True)
    if not (TREE / "build" / "venv").exists():
        (TREE / "build" / "venv").symlink_to((ROOT / "build" / "venv").resolve())


def succeeds(*words):
    return subprocess.run(words, cwd=TREE, capture_output=True).returncode == 0


def build_all():
    return succeeds("scripts/build", "build", "-DBUILD_TESTS=ON", "-DFMI_VERSIONS=2;3")


def build_for(kind, test, keyword="", *systems):
    """Build the targets of a test: itself, or the compiler and FMUs. Other FMUs stay as they were without the fault."""
    targets = [test] if kind == "ctest" else ["lagc", "sweep_runs", *(f"fmu_{version}{name}" for name in systems for version in ("", "3_"))]
    return succeeds("cmake", "--build", "build", "--parallel", str(os.cpu_count()), "--target", *targets)


def run(kind, test, keyword="", *_):
    """Return PASSES, FAILS, or ABSENT if there is no such test."""
    if kind == "ctest":
        command = ["ctest", "--test-dir", "build", "--no-tests=error", "-R", f"^({test})$"]
    else:
        [path] = (TREE / "tests").glob(f"*/{test}.py")
        command = ["build/venv/bin/python", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", path, "-k", keyword]
    environment = {name: value for name, value in os.environ.items() if name != "FMU_BUILD"}
    code = subprocess.run(command, cwd=TREE, capture_output=True, env=environment).returncode
    return {0: PASSES, 1: FAILS, 8: FAILS}.get(code, ABSENT)


@contextmanager
def planted(fault):
    """Plant the fault in the copy within the context."""
    location = find(fault)
    path = TREE / location.file
    text = path.read_text()
    path.write_text(text[: location.start] + fault.wrong + text[location.end :])
    try:
        yield
    finally:
        path.write_text(text)


def outcome(fault):
    test = fault.test
    with planted(fault):
        is_built = build_for(*test)
        result = run(*test) if is_built else None
    if not is_built:
        build_for(*test)  # otherwise targets that could not be built would be missing from now on
        return "DOES NOT COMPILE"
    return {PASSES: "NOT SEEN", FAILS: "seen", ABSENT: "HAS NO TEST"}[result]


def check_without_faults(tests):
    """Build everything once, and run the tests of one kind or module together."""
    if not build_all():
        sys.exit("the project does not build")
    together = [("ctest", "|".join({test for kind, test, *_ in tests if kind == "ctest"}))]
    for module in sorted({test for kind, test, *_ in tests if kind == "pytest"}):
        keywords = {test[2] for test in tests if test[1] == module}
        together.append(("pytest", module, "" if "" in keywords else " or ".join(f"({keyword})" for keyword in sorted(keywords))))
    for test in together:
        if test[1] and run(*test) != PASSES:
            sys.exit(f"fails without a fault: {' '.join(test)}")


def main():
    started = time.monotonic()
    chosen = [FAULTS[int(index)] for index in sys.argv[1:]] or FAULTS
    copy_project()
    check_without_faults([fault.test for fault in chosen])
    unseen = 0
    for fault in chosen:
        result = outcome(fault)
        unseen += result != "seen"
        print(f"{FAULTS.index(fault):3} {result}: {find(fault).file}: {fault.right.strip()}  ->  {fault.wrong.strip()}", flush=True)
    print(f"{len(chosen)} faults in {time.monotonic() - started:.0f} s")
    sys.exit(f"{unseen} of {len(chosen)} faults were not seen" if unseen else 0)


if __name__ == "__main__":
    main()
