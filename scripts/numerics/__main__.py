"""Error against run time, stability and footprint of all FMUs: python -m numerics [--quick]"""

import argparse
import importlib.metadata
import os
import platform

from extreme_cases import CASES, co_simulate, exchange_model
from fmu import ROOT
from html_page import bullets, page, paragraphs, table, write_csv
from numerics import energy, footprint, mechanisms, stiff, work_precision
from numerics.plots import energy_plot, legend, mechanism_legend, mechanism_plot, stiff_legend, stiff_plot, work_precision_plot
from numerics.peers import PEERS
from numerics.scenarios import check_of_reference
from progress import Progress

FOLDER = ROOT / "build" / "report"


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.processor())
    packages = ["fmpy", "scipy", "heyoka", "mujoco", "exudyn", "sympy", "python-flint"]
    versions = []
    for package in packages:
        try:
            versions.append(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            versions.append(f"{package}: not installed here")
    return [("machine", f"{model}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"),
            ("Python", platform.python_version()), *(("package", v) for v in versions)]  # fmt: skip


def stability_rows(progress):
    rows = []
    for case in CASES:
        outcome = co_simulate(case)
        exchange = exchange_model(case).verdict if case.exchange is not None else ""
        rows.append([case.name, case.system, case.right, outcome.verdict, exchange, outcome.error, case.bound or float("nan"),
                     outcome.steps, outcome.evaluations, case.evaluations, outcome.message])  # fmt: skip
        progress(case.name)
    return rows


def stability_section(rows):
    header = ["case", "FMU", "what is right", "verdict", "model exchange", "error", "bound", "steps", "evaluations", "bound", "message"]
    write_csv(FOLDER / "stability.csv", header, rows)
    coloured = [[*row[:3], (row[3], row[3]), *row[4:]] for row in rows]
    counts = {verdict: sum(row[3] == verdict for row in rows) for verdict in ("right", "refused", "wrong")}
    text = (f"{len(rows)} cases: {counts['right']} right, {counts['refused']} refused with a message, {counts['wrong']} wrong. Each has a bound "
            "on its error and on the evaluations of the equations of motion; the same table is a test.")  # fmt: skip
    return text, paragraphs([text]) + table(header, coloured)


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
    return '<div class="plots">' + "".join(plots) + "</div>"


def stiff_section(quick, progress):
    """(sentences for the first screen, the section)."""
    samples = stiff.collect(quick, progress)
    work_precision.write_csv(samples, FOLDER / "stiff.csv")
    rows = stiff.rows(samples, quick)
    write_csv(FOLDER / "stiff_ratios.csv", stiff.HEADER, rows)
    sentences = stiff.summary(rows)
    text = ("Ratios are of times to an equal error, between tolerances by powers; 0 and inf: one of the two never gets there. The methods take "
            "turns, and the fastest of several runs counts. The references are collocation of high order in extended precision, of "
            "the equations that SymPy derives; \"largest difference\" is that to another order. SciPy's run in one step, with SymPy's right side.")  # fmt: skip
    problems = list({problem.name: problem for problem, _ in stiff.plan(quick)}.values())
    plots = '<div class="plots">' + "".join(stiff_plot(samples, problem) for problem in problems) + "</div>"
    return sentences, paragraphs([*sentences, text]) + stiff_legend(stiff.PEERS) + plots + table(stiff.HEADER, rows)


def mechanisms_section(quick, progress):
    """(sentences for the first screen, the section)."""
    samples, missing = mechanisms.collect(quick, progress)
    write_csv(FOLDER / "mechanisms.csv", mechanisms.SAMPLES_HEADER, mechanisms.sample_rows(samples))
    rows = mechanisms.rows(samples, missing)
    write_csv(FOLDER / "mechanism_ratios.csv", mechanisms.HEADER, rows)
    sentences = mechanisms.summary(rows)
    absent = [f"Not installed here: {', '.join(sorted(missing))}."] if missing else []
    plots = ""
    for problem in mechanisms.PROBLEMS:
        measure = problem.levels[0][0]
        points = {method: mechanisms.points_of(samples, problem.system, method, measure) for method in mechanisms.METHODS}
        plots += mechanism_plot(problem.title, mechanisms.text_of(problem, measure), points)
    level, times, ratios = slice(0, len(mechanisms.LEVEL)), mechanisms.TIMES, mechanisms.FASTEST
    tables = [table(mechanisms.HEADER[level] + mechanisms.HEADER[times], [row[level] + row[times] for row in rows]),
              table(mechanisms.HEADER[level][:4] + mechanisms.HEADER[ratios], [row[level][:4] + row[ratios] for row in rows])]  # fmt: skip
    content = paragraphs([*sentences, *absent, *mechanisms.NOTES]) + mechanism_legend() + f'<div class="plots">{plots}</div>'
    return sentences, content + "".join(tables)


def references_section(systems):
    header = ["system", "seconds", "reference checked with", "largest difference"]
    rows = [[name, work_precision.SCENARIOS[name][1], *check_of_reference(name)] for name in systems]
    write_csv(FOLDER / "references.csv", header, rows)
    text = ("The reference of every system is a Taylor series of SymPy's equations with 30 digits in FLINT's arithmetic, which shares no "
            "code with the FMUs; its local error is 1e-20.")  # fmt: skip
    return paragraphs([text]) + table(header, rows)


def ratio_tables(samples):
    content = ""
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


def missing_peers(samples):
    absent = [peer for peer in PEERS if not any(s.method == peer for s in samples)]
    return [f"Not installed here, or without a result: {', '.join(absent)}."] if absent else []


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="five systems, few tolerances: under two minutes")
    quick = parser.parse_args().quick
    FOLDER.mkdir(parents=True, exist_ok=True)
    tasks = work_precision.plan(quick)
    progress = Progress(len(tasks) + len(CASES) + len(energy.RUNS) * len(energy.METHODS) + len(stiff.plan(quick)) + len(mechanisms.PROBLEMS))
    samples, failures = work_precision.collect(tasks, progress)
    work_precision.write_csv(samples, FOLDER / "work_precision.csv")
    systems = list(dict.fromkeys(s.system for s in samples))
    verdicts, stability = stability_section(stability_rows(progress))
    stiff_sentences, stiff_content = stiff_section(quick, progress)
    mechanism_sentences, mechanism_content = mechanisms_section(quick, progress)
    energies = energy_section(quick, progress)
    left_out_header = ["FMU", "form", "archive [B]", "library [B]", "equations [B]", "runtime [B]", "SUNDIALS [B]", "instance [B]",
                       "instantiate and free [µs]", "exported symbols", "left out, since the system does not need it"]  # fmt: skip
    left_out = footprint.rows()
    write_csv(FOLDER / "left_out.csv", left_out_header, left_out)
    failed = [f"{count} runs of {method} gave up or took more than a minute." for method, count in failures.items()]
    summary = work_precision.summary(samples)
    first = [verdicts, *stiff_sentences, *mechanism_sentences, *missing_peers(samples),
             "Times are those of the doStep loop alone, measured in a C program, the fastest of several runs; those of Python's "
             "packages include Python, as their users see them, but no loading and no compilation."]  # fmt: skip
    plots = '<div class="plots">' + "".join(work_precision_plot(samples, name) for name in systems) + "</div>"
    sections = [
        ("lagrange-fmu: error against run time, stability, footprint",
         "".join(paragraphs([text]) + bullets(items) for text, items in summary) + paragraphs(first)),
        ("Error against run time", paragraphs([*failed, "Left is loose, right is accurate; low is fast."]) + legend() + plots + ratio_tables(samples)),
        ("Stiff systems", stiff_content),
        ("Mechanisms", mechanism_content),
        ("Stiff and extreme cases", stability),
        ("Energy over long runs", energies),
        ("Left out", table(left_out_header, left_out)),
        ("References", references_section(systems)),
        ("Machine and versions", table(["", ""], machine())),
    ]
    (FOLDER / "index.html").write_text(page(sections))
    for text, items in summary:
        print(text, *items, sep="\n  ")
    print(verdicts, *stiff_sentences, *mechanism_sentences, sep="\n")
    print(f"report  {FOLDER / 'index.html'}")


if __name__ == "__main__":
    main()
