"""
Sizes of the last release, in bytes, in tests/sizes.csv: a size may grow by 10 % until the next release.

At a release, and for a new system, the measured sizes replace those of the table: `python -m pytest tests -k size --renew-sizes`.
"""

import csv

from fmu import ROOT

TABLE = ROOT / "tests" / "sizes.csv"
GROWTH = 1.1


def table():
    """Return the sizes by name of the system and of what is measured."""
    with open(TABLE, newline="") as file:
        return {(row["system"], row["measure"]): int(row["bytes"]) for row in csv.DictReader(file)}


def check(system, measure, size):
    known = table().get((system, measure), 0)
    assert size <= GROWTH * known, f"{measure} of {system}: {size} bytes; expected at most 10 % more than the {known} in tests/sizes.csv"


def renew(system, measure, size):
    rows = table() | {(system, measure): size}
    with open(TABLE, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["system", "measure", "bytes"])
        writer.writerows((*key, rows[key]) for key in sorted(rows))
