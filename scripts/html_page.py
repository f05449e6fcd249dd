"""A report as one HTML file with its plots inside, which needs no network."""

import csv
import html
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

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


def write_csv(path, header, rows):
    """A table beside the page."""
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([header, *rows])


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
