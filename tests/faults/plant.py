"""
Plants each fault of faults.py in a copy of the project, builds what the tests need, and runs the tests that should see it:
scripts/faults [PLACE IN THE LIST ...]. Fails where one is not seen, or where these tests fail without a fault.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from faults import FAULTS

ROOT = Path(__file__).resolve().parent.parent.parent
TREE = ROOT / "build" / "faults"
SYSTEMS = {"SimplePendulum", "SimplePendulumLinear", "DampedPendulum", "ElasticPendulum", "ParticlePolar"}  # few, to build them often


def copy_project():
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    for file in subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n"):
        parts = Path(file).parts
        if not file or not (ROOT / file).is_file() or (len(parts) == 3 and parts[0] == "fmu" and parts[1] not in SYSTEMS):
            continue
        target = TREE / file
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_bytes() != (ROOT / file).read_bytes():
            shutil.copyfile(ROOT / file, target)
            shutil.copymode(ROOT / file, target)
    (TREE / "build").mkdir(exist_ok=True)
    if not (TREE / "build" / "venv").exists():
        (TREE / "build" / "venv").symlink_to((ROOT / "build" / "venv").resolve())


def build():
    return subprocess.run(["scripts/build", "build", "-DBUILD_TESTS=ON"], cwd=TREE, capture_output=True, text=True).returncode == 0


def passes(words):
    """True or False; None where there is no such test."""
    kind, *rest = words
    if kind == "ctest":
        command = ["ctest", "--test-dir", "build", "--no-tests=error", "-R", f"^{rest[0]}$"]
    else:
        command = ["build/venv/bin/python", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *rest]
    environment = {name: value for name, value in os.environ.items() if name != "FMU_BUILD"}
    result = subprocess.run(command, cwd=TREE, capture_output=True, text=True, env=environment)
    return {0: True, 1: False, 8: False}.get(result.returncode)


def outcome(file, right, wrong, words):
    path = TREE / file
    text = path.read_text()
    path.write_text(text.replace(right, wrong))
    try:
        if not build():
            return "does not compile"
        return {True: "NOT SEEN", False: "seen", None: "has no test"}[passes(words)]
    finally:
        path.write_text(text)


def main():
    chosen = [FAULTS[int(place)] for place in sys.argv[1:]] or FAULTS
    copy_project()
    if not build():
        sys.exit("the project does not build")
    for words in {tuple(fault[3]) for fault in chosen}:
        if not passes(words):
            sys.exit(f"fails without a fault: {' '.join(words)}")
    unseen = 0
    for fault in chosen:
        result = outcome(*fault)
        unseen += result != "seen"
        print(f"{FAULTS.index(fault):3} {result}: {fault[0]}: {fault[1].strip()}  ->  {fault[2].strip()}", flush=True)
    sys.exit(f"{unseen} of {len(chosen)} faults were not seen" if unseen else 0)


if __name__ == "__main__":
    main()
