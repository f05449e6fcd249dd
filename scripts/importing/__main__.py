"""
Simulate every FMU in every installed importer, and print the table of fmu/IMPORTING.md.

An FMU passes if all outputs at the end are within BOUND = 1e-4 of the reference, FMPy's co-simulation at a tolerance of 1e-10. The error is the
largest |value - reference| / (1 + |reference|).
"""

import argparse
import functools
import multiprocessing
import os
from pathlib import Path

import fmpy
import numpy as np

from scripts.pages.html_page import write_csv
from importing import constrained, packages, programs

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = {2: ROOT / "build" / "fmu", 3: ROOT / "build" / "fmi3"}
IMPORTERS = packages.IMPORTERS | programs.IMPORTERS
END, FAST = 0.5, {"AndrewsSqueezer": 0.02}  # end in s, and ends of FMUs with much faster motion
BOUND, REFERENCE = 1e-4, 1e-10  # largest error of an FMU that passes; tolerance of the reference
PATIENCE = 60  # s for one FMU, after which it is stopped


def installed():
    """Return the version of each installed importer by name."""
    found = {}
    for name, (version, _, _) in IMPORTERS.items():
        try:
            found[name] = version()
        except ModuleNotFoundError:
            pass
    return found


def quietly(sender, run, *arguments):
    """Run in a child process without output, and send the values, or the message of a failure."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(1, 2)
    try:
        sender.send(np.array(run(*arguments), float))
    except BaseException as problem:
        sender.send(f"{type(problem).__name__}: {problem}")


def simulated(run, *arguments):
    """Return the values of run(*arguments) in a child process, or the message of a failure."""
    receiver, sender = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(target=quietly, args=(sender, run, *arguments))
    process.start()
    sender.close()
    try:
        return receiver.recv() if receiver.poll(PATIENCE) else f"no end after {PATIENCE} s"
    except EOFError:
        process.join()
        return f"the process ended with code {process.exitcode}"
    finally:
        process.kill()
        process.join()


def error_of(values, expected):
    """Return the relative error, or a message if it is larger than BOUND or there are no values."""
    if isinstance(values, str):
        return values
    if not len(expected):
        return 0.0
    error = float(np.max(np.abs(values - expected) / (1 + np.abs(expected))))
    return error if error <= BOUND else f"error {error:.1e}"


def compare(names, importer, report):
    """Return the rows (importer, FMI, kind, FMU, error or message) of one importer; report(text) is called for each failure."""
    _, kinds, run = IMPORTERS[importer]
    rows = []
    for version, kind in kinds:
        for name in names:
            archive = FOLDERS[version] / f"{name}.fmu"
            outputs, end, expected = reference(name)
            error = error_of(simulated(run, archive, kind, end, outputs), expected)
            rows.append([importer, version, kind, name, error])
            if isinstance(error, str):
                report(f"  {importer}, FMI {version}, {kind}, {name}: {error.splitlines()[0][:150]}")
    return rows


@functools.cache
def reference(name):
    """Return the names of an FMU's outputs, the end in s, and the reference values of the outputs at the end."""
    archive, end = FOLDERS[2] / f"{name}.fmu", FAST.get(name, END)
    outputs = [v.name for v in fmpy.read_model_description(archive).modelVariables if v.causality == "output"]
    return outputs, end, np.array(packages.fmpy(archive, "CS", end, outputs, REFERENCE), float)


def cell(rows):
    """Return the text of a cell: number of FMUs that pass, number of all, and largest error."""
    if not rows:
        return "–"
    errors = [row[4] for row in rows if not isinstance(row[4], str)]
    return f"{len(errors)} of {len(rows)}" + (f", {max(errors):.0e}" if errors else "")


def table(rows, versions):
    """Return the lines of the table in Markdown."""
    columns = [(2, "CS"), (3, "CS"), (2, "ME"), (3, "ME")]
    lines = ["| importer | version | " + " | ".join(f"FMI {version} {kind}" for version, kind in columns) + " |", "|---" * 6 + "|"]
    for name, version in versions.items():
        cells = [cell([row for row in rows if row[:3] == [name, *column]]) for column in columns]
        lines.append(f"| {name} | {version} | " + " | ".join(cells) + " |")
    return lines


def main():
    parser = argparse.ArgumentParser(prog="scripts/importers", description=__doc__)
    parser.add_argument("fmus", nargs="*", metavar="FMU", help="names of FMUs; default: all")
    parser.add_argument("--by", action="append", metavar="IMPORTER", help="run only this importer; can be repeated")
    parser.add_argument("--constrained", action="store_true", help="evaluations, events and run times of constrained systems in model exchange instead")
    words = parser.parse_args()
    if words.constrained:
        print("\n".join(constrained.table(FOLDERS[2])))
        return
    names = words.fmus or sorted(path.stem for path in FOLDERS[2].glob("*.fmu"))
    unknown = [name for name in names if not (FOLDERS[2] / f"{name}.fmu").exists()]
    if unknown:
        parser.error(f"there is no FMU {unknown[0]}; expected one of build/fmu")
    versions = installed()
    missing = [name for name in words.by or [] if name not in versions]
    if missing:
        parser.error(f"{missing[0]} is not installed; expected {', '.join(versions)}")
    if words.by:
        versions = {name: versions[name] for name in words.by}
    rows = [row for importer in versions for row in compare(names, importer, lambda text: print(text, flush=True))]
    folder = ROOT / "build" / "report"
    folder.mkdir(parents=True, exist_ok=True)
    write_csv(folder / "importers.csv", ["importer", "FMI", "kind", "FMU", "error"], rows)
    print("\n".join(["", *table(rows, versions)]))


if __name__ == "__main__":
    main()
