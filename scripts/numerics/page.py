"""build/report/index.html: one file with its plots inside, which needs no network."""

import html
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from numerics.scenarios import SCENARIOS

COLOURS = {"shipped": "#c1121f", "taylor": "#f4a261", "erk": "#2a6f97", "bdf": "#588157"}
MARKERS = {"SciPy DOP853": "s", "SciPy LSODA": "v", "SciPy Radau": "^", "FMPy CVode (model exchange)": "D",
           "heyoka": "*", "MuJoCo RK4": "P", "MuJoCo Euler": "X"}  # fmt: skip
LABELS = {"shipped": "this FMU as shipped", "taylor": "built with taylor", "erk": "built with erk", "bdf": "built with bdf"}

STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
h1 { font-size: 1.7rem; } h2 { margin-top: 2.5rem; border-bottom: 1px solid #ddd; }
table { border-collapse: collapse; font-size: .85rem; } td, th { padding: .2rem .6rem; border-bottom: 1px solid #eee; text-align: left; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; } .plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(25rem, 1fr)); gap: 1rem; }
.plots svg { width: 100%; height: auto; } .first { background: #f6f6f4; padding: .8rem 1.2rem; border-radius: .5rem; }
.right { color: #2d6a4f; } .refused { color: #8a6d00; } .wrong { color: #c1121f; font-weight: bold; }
"""


def svg(figure):
    buffer = io.StringIO()
    with plt.rc_context({"svg.hashsalt": "report"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    plt.close(figure)
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def front(points):
    """Those that no other point beats in both error and time, by ascending time."""
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
    for method, marker in MARKERS.items():
        points = curve(samples, name, method, 0.0)
        if points is not None:
            axes.loglog(points[:, 1], points[:, 0], color="#999", marker=marker, markersize=5, linewidth=1)
    for method, colour in COLOURS.items():
        for step, style in ((end, "-"), (0.01, "--")):
            points = curve(samples, name, method, step)
            if points is not None:
                axes.loglog(points[:, 1], points[:, 0], style, color=colour, marker="o", markersize=3,
                            linewidth=2 if method == "shipped" else 1)  # fmt: skip
    axes.set_xlabel("largest error at the communication points")
    axes.set_ylabel("run time [s]")
    axes.set_xlim(left=1e-16, right=1e1)
    axes.invert_xaxis()
    axes.grid(alpha=0.3)
    axes.set_title(f"{name}, {end:g} s")
    figure.tight_layout()
    return svg(figure)


def legend():
    """One for all work-precision plots."""
    figure, axes = plt.subplots(figsize=(11, 1.1))
    for method, colour in COLOURS.items():
        for style, what in (("-", "one step"), ("--", "steps of 0.01 s")):
            axes.plot([], [], style, color=colour, marker="o", markersize=3, label=f"{LABELS[method]}, {what}")
    for method, marker in MARKERS.items():
        axes.plot([], [], color="#999", marker=marker, label=method)
    axes.axis("off")
    axes.legend(ncols=4, fontsize=8, loc="center", frameon=False)
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


def cell(value):
    if isinstance(value, tuple):  # (text, class)
        return f'<td class="{value[1]}">{html.escape(value[0])}</td>'
    if isinstance(value, (int, float, np.floating, np.integer)):
        text = "–" if value != value else f"{value:,}" if isinstance(value, (int, np.integer)) else f"{value:.3g}"
        return f'<td class="number">{text}</td>'
    return f"<td>{html.escape(str(value))}</td>"


def table(header, rows):
    head = "".join(f"<th>{html.escape(h)}</th>" for h in header)
    body = "\n".join("<tr>" + "".join(cell(value) for value in row) + "</tr>" for row in rows)
    return f'<div class="wide"><table><tr>{head}</tr>\n{body}</table></div>'


def paragraphs(sentences):
    return "".join(f"<p>{html.escape(sentence)}</p>" for sentence in sentences)


def bullets(items):
    return "<ul>" + "".join(f"<li>{html.escape(item)}</li>" for item in items) + "</ul>"


def page(sections):
    """sections: (title, html); the first is the first screen."""
    (title, first), *others = sections
    body = f'<h1>{html.escape(title)}</h1><div class="first">{first}</div>'
    body += "".join(f"<h2>{html.escape(heading)}</h2>{content}" for heading, content in others)
    return f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title><style>{STYLE}</style></head><body>{body}</body></html>'
