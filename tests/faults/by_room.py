"""
List the rooms of tests that detect a fault, beside the test named in faults.py: scripts/checks/faults --rooms ROOM,... [INDEX IN THE LIST ...]. A
room is a folder of tests/, or compiler, the tests in C. Writes build/faults-by-room.csv, which later runs extend. A fault that only one
room detects depends on that room; a fault that none detects depends on the named test.
"""

import csv
import sys

from faults import FAULTS
from locations import find
from plant import ROOT, TREE, build_all, copy_project, planted, succeeds

TABLE = ROOT / "build" / "faults-by-room.csv"
FAULT = ["file", "right", "wrong"]


def build():
    """Build everything, including the systems of tests/systems in the folder where tests look for them."""
    systems = [f"-DSYSTEMS={TREE / 'tests' / 'systems'}", f"-DTOOLS={TREE / 'build'}"]
    return build_all() and succeeds("scripts/build", "build/test-systems", *systems)


def passes(room):
    """True if the room's tests pass, without those for a release; ends at the first failure."""
    if room == "compiler":
        return succeeds("ctest", "--test-dir", "build", "--no-tests=error", "--stop-on-failure")
    return succeeds("build/venv/bin/python", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-m", "not release", f"tests/{room}")


def outcomes(fault, rooms):
    """Outcomes of a fault by room; if FMUs cannot be built, the build detects it."""
    with planted(fault):
        if not build():
            return {"build": "seen"}
        return {"build": "unseen"} | {room: "unseen" if passes(room) else "seen" for room in rooms}


def known():
    """Rows of the table by fault."""
    if not TABLE.exists():
        return {}
    with open(TABLE, newline="") as file:
        return {tuple(row[column] for column in FAULT): row for row in csv.DictReader(file)}


def write(rows):
    rooms = sorted({column for row in rows.values() for column in row} - {*FAULT})
    with open(TABLE, "w", newline="") as file:
        writer = csv.DictWriter(file, [*FAULT, *rooms])
        writer.writeheader()
        writer.writerows(rows.values())


def main(rooms, faults):
    copy_project()
    if not build():
        sys.exit("the project does not build")
    for room in rooms:
        if not passes(room):
            sys.exit(f"fails without a fault: {room}")
    rows = known()
    for fault in faults:
        key = (str(find(fault).file), fault.right.strip(), fault.wrong.strip())
        rows[key] = rows.get(key, dict(zip(FAULT, key))) | outcomes(fault, rooms)
        write(rows)
        seen = [room for room in ["build", *rooms] if rows[key].get(room) == "seen"]
        print(f"{FAULTS.index(fault):3} seen by {', '.join(seen) or 'none'}: {key[0]}: {key[1]}  ->  {key[2]}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1].split(","), [FAULTS[int(index)] for index in sys.argv[2:]] or FAULTS)
