"""Draw the plots of the report."""

import math

import matplotlib.pyplot as plt
import numpy as np

from scripts.pages.html_page import INK, svg, with_tips
from numerics.work_precision.scenarios import SCENARIOS

COLOURS = {"shipped": "#c1121f", "taylor": "#f4a261", "erk": "#2a6f97", "bdf": "#588157"}
STIFF_COLOURS = {"auto": "#c1121f", "radau": "#5a6acf", "taylor": "#f4a261", "bdf": "#588157"}
STYLES = ["-", "--", ":"]  # line styles of the ways of communication
PEER_STYLES = {"SciPy DOP853": ("#e09f3e", "s"), "SciPy LSODA": ("#9c6644", "v"), "SciPy Radau": ("#6b705c", "^"), "FMPy CVode (model exchange)": ("#8338ec", "D"),
               "heyoka": ("#d62976", "*"), "Boost.Odeint Fehlberg 7(8), in C++": ("#7a5c99", "p"), "MuJoCo RK4": ("#0a9396", "P"), "MuJoCo Euler": ("#4cc9f0", "X"), "MuJoCo implicitfast": ("#4cc9f0", "X"),
               "exudyn generalized-alpha": ("#2d6a4f", "s"), "exudyn trapezoidal, index 2": ("#52b788", "v")}  # fmt: skip
MARKERS = ["SciPy DOP853", "SciPy LSODA", "SciPy Radau", "FMPy CVode (model exchange)", "Boost.Odeint Fehlberg 7(8), in C++", "heyoka", "MuJoCo RK4", "MuJoCo Euler"]
MECHANISM_STYLES = {"taylor": ("#c1121f", "o"), "radau": ("#5a6acf", "o")} | {
    peer: PEER_STYLES[peer] for peer in ("exudyn generalized-alpha", "exudyn trapezoidal, index 2", "MuJoCo RK4", "MuJoCo implicitfast")}  # fmt: skip
SWITCHING_STYLES = {"FMU": ("#c1121f", "o"), "FMU, one step": ("#f4a261", "o"), "CVODE in C (model exchange)": ("#b07d4f", "D"),
                    "FMPy CVode (model exchange)": PEER_STYLES["FMPy CVode (model exchange)"], "SciPy DOP853 with events": PEER_STYLES["SciPy DOP853"],
                    "heyoka with events": PEER_STYLES["heyoka"], "MuJoCo RK4": PEER_STYLES["MuJoCo RK4"],
                    "MuJoCo implicitfast": PEER_STYLES["MuJoCo implicitfast"]}  # fmt: skip
LABELS = {"shipped": "this FMU as shipped", "taylor": "built with taylor", "erk": "built with erk", "bdf": "built with bdf"}


def draw(axes, points, method, style="-", **looks):
    """Draw points (seconds, error), which show their values under the pointer."""
    [line] = axes.loglog(points[:, 1], points[:, 0], style, **looks)
    with_tips(line, [f"{method}: {seconds:.3g} s, error {error:.2g}" for seconds, error in points])


def front(points):
    """Return the Pareto front of points (seconds, error), by ascending time."""
    kept, best = [], np.inf
    for seconds, error in sorted(points):
        if error < best:
            kept.append((seconds, error))
            best = error
    return np.array(kept)


def curve(samples, name, method, step):
    points = [(s.seconds, max(s.error, 1e-17)) for s in samples if s.system == name and s.method == method and s.step == step]
    return front(points) if points else None


def work_precision_plot(samples, name):
    figure, axes = plt.subplots(figsize=(6.2, 4.6))
    end = SCENARIOS[name][1]
    for method in MARKERS:
        points = curve(samples, name, method, 0.0)
        if points is not None:
            colour, marker = PEER_STYLES[method]
            draw(axes, points, method, color=colour, marker=marker, markersize=5, linewidth=1)
    for method, colour in COLOURS.items():
        for step, style in ((end, "-"), (0.01, "--")):
            points = curve(samples, name, method, step)
            if points is not None:
                draw(axes, points, LABELS[method], style, color=colour, marker="o", markersize=3, linewidth=2 if method == "shipped" else 1)
    axes.set_xlabel("largest error at the communication points")
    axes.set_ylabel("run time [s]")
    axes.set_xlim(left=1e-16, right=1e1)
    axes.invert_xaxis()
    axes.grid(alpha=0.3)
    axes.set_title(f"{name}, {end:g} s")
    figure.tight_layout()
    return svg(figure)


def legend():
    """Return the common legend of all work-precision plots."""
    figure, axes = plt.subplots(figsize=(11, 1.1))
    for method, colour in COLOURS.items():
        for style, what in (("-", "one step"), ("--", "steps of 0.01 s")):
            axes.plot([], [], style, color=colour, marker="o", markersize=3, label=f"{LABELS[method]}, {what}")
    for method in MARKERS:
        colour, marker = PEER_STYLES[method]
        axes.plot([], [], color=colour, marker=marker, label=method)
    axes.axis("off")
    axes.legend(ncols=4, fontsize=8, loc="center", frameon=False)
    return svg(figure)


def stiff_plot(samples, problem):
    """Return the plot of all methods and ways of communication for a problem of numerics.stiff.problems."""
    figure, axes = plt.subplots(figsize=(6.2, 4.6))
    methods = PEER_STYLES | {method: (colour, "o") for method, colour in STIFF_COLOURS.items()}
    for way, style in zip(problem.ways, STYLES):
        for method, (colour, marker) in methods.items():
            points = front([(s.seconds, max(s.error, 1e-17)) for s in samples if (s.problem, s.way, s.method) == (problem.name, way, method)])
            if len(points):
                draw(axes, points, f"{method}, {way}", style, color=colour, marker=marker, markersize=4, linewidth=2 if method == "auto" else 1)
    axes.set_xlabel("largest error at the communication points")
    axes.set_ylabel("run time [s]")
    axes.invert_xaxis()
    axes.grid(alpha=0.3)
    axes.set_title(f"{problem.name}, {problem.end:g} s", fontsize=10)
    figure.tight_layout()
    return svg(figure)


def stiff_legend(peers):
    """Return the common legend of all plots of stiff problems."""
    figure, axes = plt.subplots(figsize=(11, 0.7))
    for method, colour in STIFF_COLOURS.items():
        axes.plot([], [], color=colour, marker="o", markersize=3, label=method)
    for method in peers:
        colour, marker = PEER_STYLES[method]
        axes.plot([], [], color=colour, marker=marker, label=method)
    for style, way in zip(STYLES, ("one step", "many steps", "an input that changes at every step")):
        axes.plot([], [], style, color=INK, label=way)
    axes.axis("off")
    axes.legend(ncols=5, fontsize=8, loc="center", frameon=False)
    return svg(figure)


def mechanism_plot(title, measure, points, styles=MECHANISM_STYLES):
    """Return the plot of (seconds, error) of each method; the first style is that of the FMU."""
    figure, axes = plt.subplots(figsize=(6.2, 4.6))
    for method, pairs in points.items():
        if pairs:
            best = front([(seconds, max(error, 1e-17)) for seconds, error in pairs])
            colour, marker = styles[method]
            draw(axes, best, method, color=colour, marker=marker, markersize=4, linewidth=2 if method == next(iter(styles)) else 1)
    axes.set_xlabel(measure)
    axes.set_ylabel("run time [s]")
    axes.invert_xaxis()
    axes.grid(alpha=0.3)
    axes.set_title(title, fontsize=10)
    figure.tight_layout()
    return svg(figure)


def events_plot(title, points, styles):
    """Return the plot of (number of events, error) of each method."""
    figure, axes = plt.subplots(figsize=(6.2, 4.6))
    for method, pairs in points.items():
        if pairs:
            counts, errors = zip(*pairs)
            colour, marker = styles[method]
            [line] = axes.loglog(counts, np.maximum(errors, 1e-17), color=colour, marker=marker, markersize=4)
            with_tips(line, [f"{method}: {count} events, error {error:.2g}" for count, error in pairs])
    axes.set_xlabel("events")
    axes.set_ylabel("largest error of a position")
    axes.grid(alpha=0.3)
    axes.set_title(title, fontsize=10)
    figure.tight_layout()
    return svg(figure)


def mechanism_legend(styles=MECHANISM_STYLES):
    """Return the common legend of all plots with these styles."""
    figure, axes = plt.subplots(figsize=(11, 0.25 * math.ceil(len(styles) / 6) + 0.25))
    for method, (colour, marker) in styles.items():
        axes.plot([], [], color=colour, marker=marker, label=method)
    axes.axis("off")
    axes.legend(ncols=6, fontsize=8, loc="center", frameon=False)
    return svg(figure)


def energy_plot(name, curves, end):
    figure, axes = plt.subplots(figsize=(6.2, 4.2))
    for (method, tolerance), (times, drift) in curves.items():
        axes.loglog(times, np.maximum(drift, 1e-17), color=COLOURS[method], linewidth=1, alpha=1.0 if tolerance > 1e-12 else 0.6,
                    label=f"{method}, tolerance {tolerance:g}")  # fmt: skip
    axes.set_xlabel("time [s]")
    axes.set_ylabel("|change of the energy| / largest kinetic energy")
    axes.set_title(f"{name}, {end:g} s")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)
    figure.tight_layout()
    return svg(figure)
