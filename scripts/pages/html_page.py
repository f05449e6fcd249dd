"""Write a report as one HTML file that contains its plots and needs no network."""

import csv
import html
import io
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from scripts.library.whole_files import write_whole

STYLE = """
:root { color-scheme: light dark; --text: #1d2433; --faint: #687085; --line: #d8dce6; --paper: #fff; --raised: #f4f6fa; --link: #1a5fb4; }
@media (prefers-color-scheme: dark) { :root { --text: #dfe3ec; --faint: #939bb0; --line: #363d4d; --paper: #14181f; --raised: #1e242f; --link: #82b4f5; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem; max-width: 90rem; font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--paper); }
h1 { margin: 0 0 1rem; font-size: 1.7rem; line-height: 1.2; } h2 { margin-top: 2.5rem; border-bottom: 1px solid var(--line); font-size: 1.3rem; }
a { color: var(--link); text-decoration: none; } nav a { display: inline-block; margin-right: 1.2em; font-size: .9rem; } nav { margin-bottom: 1.5em; }
main { min-width: 0; } p, li { max-width: 50rem; overflow-wrap: anywhere; } summary { cursor: pointer; color: var(--faint); }
table { border-collapse: collapse; font-size: .85rem; } td, th { padding: .2rem .6rem; border-bottom: 1px solid var(--line); text-align: left; font-weight: normal; }
tr:first-child th { color: var(--faint); vertical-align: bottom; }
td.number, th.number, td.ratio { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.wide { overflow-x: auto; } .plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(25rem, 100%), 1fr)); gap: 1rem; }
svg { display: block; width: 100%; height: auto; } svg text { fill: currentColor; }
.right { color: #2d8a5f; } .rejected { color: #b08a00; } .wrong { color: #e5383b; font-weight: bold; }
svg.overview { min-width: 40rem; max-width: 64rem; font-size: 14px; } svg.overview line { stroke: var(--line); } svg.overview .one { stroke: var(--text); stroke-width: 2; }
svg.overview circle { fill-opacity: .75; stroke: var(--paper); }
table.overview .group th { padding-top: 1rem; color: var(--faint); } [data-tip] { cursor: help; }
table.overview .ratio { color: #10151f; border-left: 2px solid var(--paper); }
.faster1 { background: #d8f0dc; } .faster2 { background: #aee0ba; } .faster3 { background: #79c98f; } .faster4 { background: #46ab66; }
.equal { background: #f3f0d0; } .slower { background: #f5b7a8; } .never { background: #b9c0d0; } table.overview .unknown { color: var(--faint); }
#tip { position: fixed; z-index: 1; padding: .4rem .7rem; max-width: 24rem; border: 1px solid var(--line); border-radius: .3rem; font-size: .8rem; white-space: pre-line;
  color: var(--text); background: var(--raised); pointer-events: none; }
@media (min-width: 70rem) {
  .contents { display: grid; grid-template-columns: 12rem minmax(0, 1fr); gap: 2.5rem; }
  .contents > nav { position: sticky; top: 1.5rem; align-self: start; padding-right: 1rem; border-right: 1px solid var(--line); }
  nav a { display: block; margin: .4em 0; }
}
"""

# Shows the text of the mark under the pointer, or of the nearest mark in its plot.
SCRIPT = """
const tip = Object.assign(document.createElement('div'), {id: 'tip', hidden: true});
document.body.append(tip);
const distance = (mark, event) => {
  const box = mark.getBoundingClientRect();
  return Math.hypot(box.left + box.width / 2 - event.clientX, box.top + box.height / 2 - event.clientY);
};
const under = event => {
  const plot = event.target.closest?.('svg');
  if (!plot) return event.target.closest?.('[data-tip]');
  let best = null, least = 18;
  for (const mark of plot.querySelectorAll('[data-tip]')) {
    const away = distance(mark, event);
    if (away < least) [best, least] = [mark, away];
  }
  return best;
};
document.addEventListener('pointermove', event => {
  const mark = under(event);
  tip.hidden = !mark;
  if (!mark) return;
  tip.textContent = mark.dataset.tip;
  tip.style.left = Math.max(4, Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 4)) + 'px';
  tip.style.top = (event.clientY + 18 + tip.offsetHeight > innerHeight ? event.clientY - tip.offsetHeight - 12 : event.clientY + 18) + 'px';
});
"""

# Colour of lines and text in plots; svg() replaces it by the colour of the text around them.
INK = "#1d2434"
plt.rcParams.update({key: INK for key in ("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color")} | {
    "figure.facecolor": "none", "axes.facecolor": "none", "legend.facecolor": "none", "savefig.facecolor": "none"})  # fmt: skip


def with_tips(line, texts):
    """Give the points of a line in a plot texts, which appear under the pointer."""
    line.set_gid("tips " + "|".join(texts))


def add_tips(text):
    """Return the SVG in which each mark of a line of with_tips() has its text."""

    def marked(match):
        tips = iter(html.unescape(match[2]).split("|"))
        return "<g>" + re.sub("<use ", lambda use: f'<use data-tip="{html.escape(next(tips, ""))}" ', match[3])

    return re.sub(r"""<g id=(["'])tips (.*?)\1>(.*?</g>)""", marked, text, flags=re.S)


def svg(figure):
    buffer = io.StringIO()
    with plt.rc_context({"svg.hashsalt": "report"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    plt.close(figure)
    text = buffer.getvalue()
    return add_tips(text[text.index("<svg") :].replace(INK, "currentColor"))


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
    """Write a table as CSV, atomically."""
    text = io.StringIO(newline="")
    csv.writer(text).writerows([header, *rows])
    write_whole(path, text.getvalue())


def paragraphs(sentences):
    return "".join(f"<p>{html.escape(sentence)}</p>" for sentence in sentences)


def bullets(items):
    return "<ul>" + "".join(f"<li>{html.escape(item)}</li>" for item in items) + "</ul>"


def folded(summary, content):
    return f"<details><summary>{html.escape(summary)}</summary>{content}</details>" if content else ""


def page(sections):
    """Return the HTML of a page with sections (title, html); the first is the head of the page, and a menu links to the others."""
    (title, first), *others = sections
    links = "".join(f'<a href="#section{i}">{html.escape(heading)}</a>' for i, (heading, _) in enumerate(others))
    body = f"<h1>{html.escape(title)}</h1>{first}"
    body += "".join(f'<h2 id="section{i}">{html.escape(heading)}</h2>{content}' for i, (heading, content) in enumerate(others))
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>{html.escape(title)}</title><style>{STYLE}</style>'
    return (f'<!doctype html><html lang="en"><head>{head}</head><body><div class="contents"><nav>{links}</nav><main>{body}</main></div>'
            f"<script>{SCRIPT}</script></body></html>")  # fmt: skip
