"""
Compare co-simulation schemes for the two-mass oscillator: two bodies with a spring and damper between them, in three FMUs.

Measures the error against communication step and run time, and the stability limit against stiffness and mass ratio. Writes
build/report/coupling.html, and tables as CSV beside it.
"""

import sys
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from scipy.linalg import expm

from coupling import hinge
from coupling.master import DEGREES, SCHEMES, Diverged, Master
from coupling.slaves import ROOT
from scripts.pages.html_page import page, paragraphs, svg, table, write_csv

from scripts.library.problem import Problem
from scripts.library.whole_files import write_whole

COLOURS = {"jacobi": "#2a6f97", "gauss_seidel": "#588157", "fixed_point": "#f4a261", "newton": "#c1121f"}
FOLDER = ROOT / "build" / "report"

M1, M2, K, C, OWN = 1.0, 2.0, 40.0, 0.4, 10.0
START, END = [1.0, 0.0, -0.5, 0.3], 2.0
STEPS = [20, 40, 80, 160, 320, 640]


def exact(m1, m2, k, c, own, state, times):
    """Return the states at these times, by the matrix exponential of the linear system."""
    A = np.array([[0, 1, 0, 0], [-(k + own) / m1, -c / m1, k / m1, c / m1], [0, 0, 0, 1], [k / m2, c / m2, -(k + own) / m2, -c / m2]])
    return np.array([expm(A * t) @ state for t in times])


def convergence():
    """Return a row (scheme, degree, step, error, seconds, order relative to the step before) for each run."""
    rows = []
    master = Master(M1, M2, K, C, OWN)
    for scheme in SCHEMES:
        for degree in DEGREES:
            before = None
            for steps in STEPS:
                seconds = np.inf
                try:
                    for _ in range(3):
                        begin = time.perf_counter()
                        states = master.run(scheme, degree, START, END, steps)
                        seconds = min(seconds, time.perf_counter() - begin)
                except Diverged:
                    continue
                reference = exact(M1, M2, K, C, OWN, START, np.linspace(0, END, steps + 1))
                error = float(np.max(np.abs(states - reference)[:, [0, 2]]))
                rows.append([scheme, degree, END / steps, error, seconds, np.log2(before / error) if before else np.nan])
                before = error
    return rows


def growth(master, scheme, degree, step):
    """Return the spectral radius of a communication step, a linear map of the states and the recorded past."""
    size = 4 + 3 * degree
    columns = []
    for unit in np.eye(size):
        master.begin(unit[:4], unit[4:].reshape(-1, 3))
        try:
            master.step(scheme, degree, step)
        except Diverged:
            return np.inf
        columns.append([*master.state(), *np.ravel(master.past[:degree])])
    return np.max(np.abs(np.linalg.eigvals(np.array(columns).T)))


def largest_stable_step(master, scheme, degree, omega):
    """Return the largest step up to which no motion grows, in units of 1/omega; at most 100."""
    stable = lambda h: growth(master, scheme, degree, h / omega) <= 1.0 + 1e-9
    steps = np.geomspace(1e-3, 100.0, 61)
    last = 0.0
    for step in steps:
        if not stable(step):
            break
        last = step
    if last in (0.0, steps[-1]):
        return last
    low, high = last, step
    for _ in range(12):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def limits():
    """Return rows (scheme, degree, varied quantity, its value, largest stable step in s, and in units of 1/omega)."""
    rows = []
    cases = [("stiffness", k, 1.0, k) for k in (1e2, 1e4, 1e6)] + [("mass ratio", ratio, ratio, 1e4) for ratio in (1.0, 10.0, 100.0, 1000.0)]
    for what, value, ratio, k in cases:
        reduced = ratio / (1.0 + ratio)
        omega = np.sqrt(k / reduced)
        # A damping ratio of 0.2: without damping all explicit schemes are unstable, if only weakly.
        master = Master(1.0, ratio, k, 0.4 * np.sqrt(k * reduced), 1.0)
        for scheme in SCHEMES:
            for degree in DEGREES:
                product = largest_stable_step(master, scheme, degree, omega)
                rows.append([scheme, degree, what, value, product / omega, product])
    return rows


def orders(rows):
    """Return the order at the smallest steps, by (scheme, degree)."""
    return {(row[0], row[1]): row[5] for row in rows}


def label(scheme, degree):
    return f"{SCHEMES[scheme]}, {DEGREES[degree]}"


def lines_plot(rows, x, y, texts, title):
    """Return an SVG with a panel for each degree of the force's polynomial and a line for each scheme."""
    figure, panels = plt.subplots(1, len(DEGREES), sharex=True, sharey=True, figsize=(10, 4.2), layout="constrained")
    for (degree, text), axes in zip(DEGREES.items(), panels):
        for scheme in SCHEMES:
            points = np.array([(row[x], row[y]) for row in rows if row[0] == scheme and row[1] == degree and row[y] > 0])
            if len(points):
                axes.loglog(points[:, 0], points[:, 1], color=COLOURS[scheme], marker="o", markersize=4)
        axes.set_xlabel(texts[0])
        axes.set_title(f"force {text}")
        axes.grid(alpha=0.3)
    panels[0].set_ylabel(texts[1])
    methods = [Line2D([], [], color=COLOURS[scheme], marker="o", label=text) for scheme, text in SCHEMES.items()]
    figure.legend(handles=methods, loc="outside lower center", ncols=len(methods))
    figure.suptitle(title)
    return svg(figure)


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    errors = convergence()
    print("order of the error of the positions against the communication step:")
    summary = []
    for (scheme, degree), order in orders(errors).items():
        last = [row for row in errors if row[0] == scheme and row[1] == degree][-1]
        summary.append([label(scheme, degree), degree + 1, float(order), float(last[2]), last[3], last[4]])
        print(f"  {label(scheme, degree):24} {order:5.2f}, theory {degree + 1}; error {last[3]:.1e} at {last[2]:.4g} s")
    stability = limits()
    print("largest stable communication step times omega = sqrt(k (1/m1 + 1/m2)), damping ratio 0.2, by mass ratio:")
    ratios = [1.0, 10.0, 100.0, 1000.0]
    found = {(row[0], row[1], row[3]): row[5] for row in stability if row[2] == "mass ratio"}
    text = lambda value: "none" if value == 0.0 else "over 100" if value >= 100.0 else f"{value:.3g}"
    table_rows = [[label(s, d), *(text(found[s, d, r]) for r in ratios)] for s in SCHEMES for d in DEGREES]
    print(f"  {'':24}" + "".join(f"{ratio:>10g}" for ratio in ratios))
    for row in table_rows:
        print(f"  {row[0]:24}" + "".join(f"{value:>10}" for value in row[1:]))
    write_csv(FOLDER / "coupling_errors.csv", ["scheme", "degree", "step", "error", "seconds", "order"], errors)
    write_csv(FOLDER / "coupling_limits.csv", ["scheme", "degree", "grows", "value", "largest stable step", "times omega"], stability)
    plots = [
        lines_plot(errors, 2, 3, ("communication step [s]", "largest error of the positions [m]"), "Error against step"),
        lines_plot(errors, 4, 3, ("run time of the master [s]", "largest error of the positions [m]"), "Error against run time"),
        lines_plot([r for r in stability if r[2] == "stiffness"], 3, 4, ("stiffness [N/m]", "largest stable step [s]"), "Stability limit against stiffness"),
        lines_plot([r for r in stability if r[2] == "mass ratio"], 3, 5, ("mass ratio", "largest stable step, times omega"), "Stability limit against mass ratio"),
    ]
    first = [f"Two bodies of {M1:g} and {M2:g} kg on springs of {OWN:g} N/m, coupled by {K:g} N/m and {C:g} N s/m: three FMUs and a short "
             "master. Each scheme shows the order that theory gives: the degree of the force's polynomial plus one.",
             "Iterating with rollback (states saved and restored) moves the stability limit; with Newton's method and the FMUs' directional "
             "derivatives it also converges where the fixed point does not.",
             "Gauss-Seidel gives the two bodies forces that are not quite opposite, so that momentum is not kept: the common motion, "
             "which nothing damps here, may grow however short the step is."]  # fmt: skip
    sections = [
        ("Coupled FMUs: the two-mass oscillator", paragraphs(first)),
        ("Error and stability", '<div class="plots" style="grid-template-columns: 1fr">' + "".join(plots) + "</div>"),
        ("Orders", table(["scheme", "theory", "order found", "at a step of [s]", "error [m]", "run time [s]"], summary)),
        ("Largest stable step times omega, by mass ratio", table(["scheme", *(f"{ratio:g}" for ratio in ratios)], table_rows)),
    ]
    head, hinge_rows, hinge_sections = hinge.sections()
    print("cart and pendulum, split at the hinge: largest m/M, theory and found")
    for name, theory, found, *_ in hinge_rows:
        print(f"  {name:24}{theory:>10}{found:>10}")
    write_csv(FOLDER / "coupling_hinge.csv", head, hinge_rows)
    write_whole(FOLDER / "coupling.html", page(sections + hinge_sections))
    print(f"report  {FOLDER / 'coupling.html'}")


if __name__ == "__main__":
    try:
        main()
    except Problem as problem:
        sys.exit(f"scripts/couple: {problem}")
