"""Write the report on error against run time, stability and footprint of all FMUs: python -m numerics [--quick]"""

import argparse
import importlib.metadata
import os
import platform
import sys
from typing import NamedTuple

from scripts.bench import realtime
from extreme_cases import CASES, co_simulate, exchange_model
from fmu import ROOT
from scripts.pages.html_page import bullets, folded, page, paragraphs, table, write_csv
from numerics import footprint, validation
from numerics.failures import failure
from numerics.mechanisms import comparison as mechanisms
from numerics.overview import MethodRun, overview
from numerics.plots import SWITCHING_STYLES, energy_plot, events_plot, legend, mechanism_legend, mechanism_plot
from numerics.plots import stiff_legend, stiff_plot, work_precision_plot
from numerics.space import accelerations
from numerics.stiff import comparison as stiff
from numerics.switching import comparison as switching
from numerics.touching import comparison as touching
from numerics.work_precision import comparison as work_precision
from numerics.work_precision import energy
from numerics.work_precision.peers import PEERS
from numerics.work_precision.scenarios import check_of_reference
from scripts.library.progress import Progress

from scripts.library.problem import Problem
from scripts.library.whole_files import write_whole

FOLDER = ROOT / "build" / "report"


class ReportSection(NamedTuple):
    """A section of the report."""

    summary: list  # for the head of the page: sentences, and pairs (sentence, list of items)
    content: str  # HTML
    wrong: int = 0  # number of wrong results of FMUs
    runs: list = []  # overview.MethodRun, for the comparison in the head of the page


def machine_section(quick, progress):
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.processor())
    packages = ["fmpy", "scipy", "heyoka", "mujoco", "drake", "exudyn", "pin", "sympy", "python-flint"]
    versions = []
    for package in packages:
        try:
            versions.append(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            versions.append(f"{package}: not installed here")
    rows = [("machine", f"{model}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"),
            ("Python", platform.python_version()), *(("package", v) for v in versions)]  # fmt: skip
    return ReportSection([], table(["", ""], rows))


def error_section(quick, progress):
    samples, failures, sentences = work_precision.collect(work_precision.plan(quick), progress)
    work_precision.write_csv(samples, FOLDER / "work_precision.csv")
    failed = [f"{count} runs of {method} gave up or took more than a minute." for method, count in failures.items()]
    systems = list(dict.fromkeys(s.system for s in samples))
    plots = '<div class="plots">' + "".join(work_precision_plot(samples, name) for name in systems) + "</div>"
    content = paragraphs([*failed, *sentences, "Left is loose, right is accurate; low is fast."]) + legend() + plots
    ends = {name: work_precision.SCENARIOS[name][1] for name in systems}
    runs = [MethodRun("Smooth systems", s.system, s.method, s.seconds, s.error_at_end) for s in samples if s.step in (0.0, ends[s.system])]
    return ReportSection([*work_precision.summary(samples), *missing_peers(samples)], content + ratio_tables(samples), runs=runs)


def stability_rows(progress):
    rows = []
    for case in CASES:
        outcome = co_simulate(case)
        exchange = exchange_model(case).verdict if case.exchange is not None else ""
        rows.append([case.name, case.system, case.right, outcome.verdict, exchange, outcome.error, case.bound or float("nan"),
                     outcome.steps, outcome.evaluations, case.evaluations, outcome.message])  # fmt: skip
        progress(case.name)
    return rows


def stability_section(quick, progress):
    rows = stability_rows(progress)
    header = ["case", "FMU", "what is right", "verdict", "model exchange", "error", "bound", "steps", "evaluations", "bound", "message"]
    write_csv(FOLDER / "stability.csv", header, rows)
    coloured = [[*row[:3], (row[3], row[3]), *row[4:]] for row in rows]
    counts = {verdict: sum(row[3] == verdict for row in rows) for verdict in ("right", "rejected", "wrong")}
    text = (f"{len(rows)} cases: {counts['right']} right, {counts['rejected']} rejected with a message, {counts['wrong']} wrong. Each has a bound "
            "on its error and on the evaluations of the equations of motion; the same table is a test.")  # fmt: skip
    return ReportSection([text], paragraphs([text]) + table(header, coloured), counts["wrong"])


def energy_section(quick, progress):
    end, plots, rows = (1e3 if quick else 1e5), [], []
    for name in energy.RUNS:
        curves = {}
        for method, tolerance in energy.METHODS:
            drift = energy.drifts(name, method, tolerance, end)
            if drift is not None:
                curves[method, tolerance] = drift
                rows += [[name, method, tolerance, *pair] for pair in zip(*drift)]
            progress(f"energy, {name}")
        plots.append(energy_plot(name, curves, end))
    write_csv(FOLDER / "energy.csv", ["system", "method", "tolerance", "time", "drift"], rows)
    return ReportSection([], '<div class="plots">' + "".join(plots) + "</div>")


def left_out_section(quick, progress):
    header = ["FMU", "form", "archive [B]", "library [B]", "equations [B]", "runtime [B]", "SUNDIALS [B]", "instance [B]",
              "instantiate and free [µs]", "exported symbols", "left out, since the system does not need it"]  # fmt: skip
    rows = footprint.rows()
    write_csv(FOLDER / "left_out.csv", header, rows)
    return ReportSection([], table(header, rows))


def stiff_section(quick, progress):
    samples, failures = stiff.collect(quick, progress)
    work_precision.write_csv(samples, FOLDER / "stiff.csv", stiff.Sample)
    rows = stiff.rows(samples, quick)
    write_csv(FOLDER / "stiff_ratios.csv", stiff.HEADER, rows)
    sentences = stiff.summary(rows)
    text = ("Ratios are of times to an equal error, between tolerances by powers; 0 and inf: one of the two never gets there. The methods take "
            "turns, and the fastest of several runs counts. The references are collocation of high order in extended precision, of "
            "the equations that SymPy derives; \"largest difference\" is that to another order. SciPy's run in one step, with SymPy's right side; exudyn's "
            "with fixed steps, as mass points with springs, dampers, or a distance; \"largest difference\" of the rope is that to the other method.")  # fmt: skip
    plots = "".join(paragraphs([failures[problem.name]]) if problem.name in failures else stiff_plot(samples, problem)
                    for problem in stiff.problems(quick))  # fmt: skip
    content = folded("in words", paragraphs([*sentences, *missing_peers(samples, stiff.PEERS), text])) + stiff_legend(stiff.PEERS)
    runs = [MethodRun("Stiff systems", s.problem, s.method, s.seconds, s.error) for s in samples if s.way == "one step" or s.method in stiff.PEERS]
    return ReportSection(sentences, content + f'<div class="plots">{plots}</div>' + table(stiff.HEADER, rows), runs=runs)


def mechanisms_section(quick, progress):
    samples, missing, failures = mechanisms.collect(quick, progress)
    write_csv(FOLDER / "mechanisms.csv", mechanisms.SAMPLES_HEADER, mechanisms.sample_rows(samples))
    rows = mechanisms.rows(samples, missing)
    write_csv(FOLDER / "mechanism_ratios.csv", mechanisms.HEADER, rows)
    sentences = mechanisms.summary(rows)
    absent = [f"Not installed here: {', '.join(sorted(missing))}."] if missing else []
    plots, runs = "", []
    for problem in mechanisms.chosen(quick):
        if problem.system in failures:
            plots += paragraphs([failures[problem.system]])
            continue
        measure = problem.levels[0][0]
        points = {method: mechanisms.points_of(samples, problem.system, method, measure) for method in mechanisms.METHODS}
        plots += mechanism_plot(problem.title, mechanisms.text_of(problem, measure), points)
        names = {"taylor": "FMU"}  # radau has no column, since it is not another program
        runs += [MethodRun("Mechanisms", problem.title, names.get(method, method), *pair) for method, pairs in points.items() for pair in pairs]
    level, times, ratios = slice(0, len(mechanisms.LEVEL)), mechanisms.TIMES, mechanisms.FASTEST
    tables = [table(mechanisms.HEADER[level] + mechanisms.HEADER[times], [row[level] + row[times] for row in rows]),
              table(mechanisms.HEADER[level][:4] + mechanisms.HEADER[ratios], [row[level][:4] + row[ratios] for row in rows])]  # fmt: skip
    content = folded("in words", paragraphs([*sentences, *absent, *mechanisms.NOTES])) + mechanism_legend() + f'<div class="plots">{plots}</div>'
    return ReportSection(sentences, content + "".join(tables) + accelerations_part(quick, progress), runs=runs)


def switching_section(quick, progress):
    samples, counted, missing, failures = switching.collect(quick, progress)
    write_csv(FOLDER / "switching.csv", switching.SAMPLES_HEADER, map(switching.sample_row, samples))
    write_csv(FOLDER / "switching_events.csv", ["events", *switching.SAMPLES_HEADER], [[count, *switching.sample_row(s)] for count, s in counted])
    rows, counted_rows = switching.rows(samples, missing), switching.counted_rows(counted)
    write_csv(FOLDER / "switching_ratios.csv", switching.HEADER, rows)
    sentences = switching.summary(rows, samples)
    absent = [f"Not installed here: {', '.join(sorted(missing))}."] if missing else []
    plots, runs = "", []
    for problem in switching.PROBLEMS:
        points = {method: switching.points_of(samples, problem, method) for method in switching.METHODS}
        plots += mechanism_plot(problem.title, "largest error of a position", points, SWITCHING_STYLES) if any(points.values()) else ""
        runs += [MethodRun("Switching", problem.title, method, *pair) for method, pairs in points.items() for pair in pairs]
    for problem in switching.GROWING:
        points = {method: [(count, s.error) for count, s in counted if (s.problem, s.method) == (problem.name, method)] for method in switching.METHODS}
        title = f"{problem.title}, tolerance {switching.TOLERANCE:g}"
        plots += events_plot(title, points, SWITCHING_STYLES) if any(points.values()) else ""
    first = paragraphs(failures) + folded("in words", paragraphs([*absent, *switching.NOTES])) + mechanism_legend(SWITCHING_STYLES)
    return ReportSection(sentences, first + f'<div class="plots">{plots}</div>' + table(switching.HEADER, rows) + table(switching.COUNTED, counted_rows),
                   runs=runs)  # fmt: skip


def touching_section(quick, progress):
    samples, missing, failures = touching.collect(quick, progress)
    write_csv(FOLDER / "touching.csv", ["problem", "method", "setting", "error", "seconds"], [[s.problem, s.method, s.setting, s.error, min(s.times)] for s in samples])
    rows = touching.rows(samples)
    write_csv(FOLDER / "touching_times.csv", touching.HEADER, rows)
    absent = [f"Not installed here: {', '.join(sorted(missing))}."] if missing else []
    return ReportSection([], paragraphs([*absent, *failures]) + folded("in words", paragraphs(touching.NOTES)) + table(touching.HEADER, rows))


def stepped(quick):
    return work_precision.chosen(quick) if quick else realtime.all_names()


def steps_section(quick, progress):
    rows = []
    for row in realtime.rows_of(stepped(quick), 1.0 if quick else 10.0):
        rows.append([row.get(column, "") for column in realtime.COLUMNS])
        progress(f"single steps, {row['system']}")
    header = [realtime.COLUMNS[0], realtime.COLUMNS[1], *(f"{column} [µs]" for column in realtime.COLUMNS[2:6]), *realtime.COLUMNS[6:]]
    write_csv(FOLDER / "single_steps.csv", header, rows)
    text = (f"Single communication steps of 1 ms. Of each step the fastest of {realtime.RUNS} runs counts, which leaves out what else the machine did, but for \"as seen\". "
            "Allocations are those of all steps; calls of the operating system are counted where strace is installed. scripts/bench/realtime measures longer. "
            "FMPy's Euler and CVode, which are the methods of Reference-FMUs' fmusim too, take SimplePendulum in model exchange, with FMPy's loop in Python in their times.")  # fmt: skip
    return ReportSection([], paragraphs([text]) + table(header, rows))


def accelerations_part(quick, progress):
    title = "One evaluation of the accelerations of a robot"
    try:
        rows, missing = accelerations.rows(quick)
    except Exception as error:
        rows, missing = [], [failure(title.lower(), error)]
    progress("accelerations of robots")
    write_csv(FOLDER / "accelerations.csv", accelerations.HEADER, rows)
    return f"<h3>{title}</h3>" + paragraphs([*missing, *([accelerations.NOTE] if rows else [])]) + (table(accelerations.HEADER, rows) if rows else "")


def references_section(quick, progress):
    header = ["system", "seconds", "reference checked with", "largest difference"]
    rows = [[name, work_precision.SCENARIOS[name][1], *check_of_reference(name)] for name in work_precision.chosen(quick)]
    write_csv(FOLDER / "references.csv", header, rows)
    text = ("The reference of every system is a Taylor series of SymPy's equations with 30 digits in FLINT's arithmetic, which shares no "
            "code with the FMUs; its local error is 1e-20.")  # fmt: skip
    return ReportSection([], paragraphs([text]) + table(header, rows))


def validation_section(quick, progress):
    rows, failures = [], []
    for case in validation.cases(quick):
        try:
            rows.append(validation.row_of(case))
        except Exception as error:
            failures.append(failure(case.system, error))
        progress(f"validation, {case.system}")
    write_csv(FOLDER / "validation.csv", validation.HEADER, rows)
    wrong = [row[0] for row in rows if validation.is_wrong(row)]
    but = f", but not {', '.join(wrong)}" if wrong else ""
    sentence = f"{len(rows)} motions with a known solution: {len(rows) - len(wrong)} within {validation.LARGEST:g} times the tolerance{but}."
    text = (f"Each FMU as shipped, at its own tolerance, in {validation.POINTS} communication steps. The error is the largest of all compared variables at all "
            "communication points, relative for values above 1. The time is that of the whole run.")  # fmt: skip
    return ReportSection([sentence], paragraphs([sentence, *failures, text]) + table(validation.HEADER, rows), len(wrong))


def settings_of_peers(samples):
    """Return a table of the settings between which the times are interpolated, and what "never" means."""
    fmu = sorted({s.tolerance for s in samples if s.method == "shipped"}, reverse=True)
    rows = [["FMU, with each method", "tolerance", ", ".join(f"{value:g}" for value in fmu)]]
    for peer, (_, settings, _) in PEERS.items():
        used = {s.tolerance for s in samples if s.method == peer}
        kind = "step in s" if peer.startswith("MuJoCo") else "relative and absolute tolerance"
        rows += [[peer, kind, ", ".join(f"{value:g}" for value in settings if value in used)]] if used else []
    text = "Times to an error are interpolated between the settings. \"never\": no run with the settings of this table reaches it."
    return paragraphs([text]) + table(["program", "setting", "values"], rows)


def ratio_tables(samples):
    content = settings_of_peers(samples)
    for level in work_precision.LEVELS:
        rows = work_precision.ratios(samples, level)
        systems = list(dict.fromkeys(s.system for s in samples))
        body = []
        for name in systems:
            ours = work_precision.best_seconds(samples, name, ["shipped"], level, work_precision.SCENARIOS[name][1])
            line = [name, ours * 1e6]
            for _, ratio, never in rows:
                line.append(ratio[name] if name in ratio else "never" if name in never else "")
            body.append(line)
        header = ["system", "FMU as shipped [µs]", *(f"{rival}, ratio" for rival, _, _ in rows)]
        write_csv(FOLDER / f"ratios_{level:g}.csv", header, body)
        content += f"<h3>Time to an error of {level:g} at the end, as a ratio to the FMU as shipped with one communication step</h3>"
        content += table(header, body)
    return content


def missing_peers(samples, peers=PEERS):
    absent = [peer for peer in peers if not any(s.method == peer for s in samples)]
    return [f"Not installed here, or without a result: {', '.join(absent)}."] if absent else []


SECTIONS = [("Validation", validation_section), ("Error against run time", error_section), ("Stiff systems", stiff_section), ("Mechanisms", mechanisms_section),
            ("Switching", switching_section), ("Bodies that touch", touching_section),
            ("Stiff and extreme cases", stability_section), ("Energy over long runs", energy_section),
            ("Single steps", steps_section), ("Left out", left_out_section),
            ("References", references_section), ("Machine and versions", machine_section)]  # fmt: skip


def attempt(title, section, quick, progress):
    """Return the section; after a failure one with a sentence about it, so that the report continues."""
    try:
        return section(quick, progress)
    except Exception as error:
        sentence = failure(f"the section '{title}'", error)
        return ReportSection([sentence], paragraphs([sentence]))


def write_page(sections):
    """Write the page of the sections so far, by title."""
    times = ("Times are the processor's for the doStep loop alone, in a C program, the fastest of several runs; those of Python's packages "
             "include Python, as their users see them, but no loading and no compilation.")  # fmt: skip
    summary = [line for section in sections.values() for line in section.summary]
    first = "".join(paragraphs([line]) if isinstance(line, str) else paragraphs([line[0]]) + bullets(line[1]) for line in [*summary, times])
    comparison = overview([run for section in sections.values() for run in section.runs])
    others = [(title, section.content) for title, section in sections.items()]
    write_whole(FOLDER / "index.html", page([("lagrange-fmu: error against run time", comparison + folded("in words", first)), *others]))


def main(words=None):
    """Write the report; return 1 if an FMU gives a wrong result. Missing programs and references are named in the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="compare five systems at few tolerances, in two minutes")
    parser.add_argument("--only", nargs="+", metavar="SECTION", choices=[title for title, _ in SECTIONS], help="write these sections: " + ", ".join(title for title, _ in SECTIONS))
    arguments = parser.parse_args(words)
    quick = arguments.quick
    FOLDER.mkdir(parents=True, exist_ok=True)
    count = len(work_precision.plan(quick)) + len(stiff.plan(quick)) + len(mechanisms.chosen(quick)) + 2 + len(switching.PROBLEMS) + len(switching.GROWING)
    progress, sections = Progress(count + len(validation.cases(quick)) + len(stepped(quick)) + 3 + len(CASES) + len(energy.RUNS) * len(energy.METHODS)), {}
    for title, section in SECTIONS:
        if arguments.only and title not in arguments.only:
            continue
        sections[title] = attempt(title, section, quick, progress)
        write_page(sections)
        for line in sections[title].summary:
            print(*([line] if isinstance(line, str) else [line[0], *line[1]]), sep="\n  ")
    print(f"report  {FOLDER / 'index.html'}")
    wrong = sum(section.wrong for section in sections.values())
    if wrong:
        print(f"scripts/report: {wrong} results are wrong, see 'Validation' and 'Stiff and extreme cases'", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Problem as problem:
        sys.exit(f"scripts/report: {problem}")
