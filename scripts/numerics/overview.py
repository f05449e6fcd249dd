"""Write the head of the report, as a plot and a table: run times of other programs at equal error, as multiples of the FMU's."""

import html
import math
from typing import NamedTuple

LEVELS = [1e-6, 1e-10]  # errors at which times are compared; the first one defines plot and colours
OURS = {"shipped", "auto", "FMU"}
COLOURS = {"SUNDIALS, same FMU": "#2a6f97", "SciPy": "#e09f3e", "FMPy CVode": "#8338ec", "CVODE in C": "#b07d4f", "Boost.Odeint": "#7a5c99", "heyoka": "#d62976", "exudyn": "#2d6a4f",
           "MuJoCo": "#0a9396"}  # fmt: skip
NEVER = math.inf


class MethodRun(NamedTuple):
    """Time and error of a method on a problem."""

    section: str
    problem: str
    method: str
    seconds: float
    error: float


class Cell(NamedTuple):
    """A cell of the table."""

    ratio: float  # ratio of the times to the first error level; NEVER if the program does not reach it, NaN if the FMU does not
    text: str  # shown under the pointer


def program_of(method):
    """Return the program of a method; all methods of a program share a column. Return None for methods without a column."""
    if method in OURS:
        return "FMU"
    if method in ("erk", "bdf"):
        return "SUNDIALS, same FMU"
    return next((program for program in COLOURS if method.startswith(program)), None)


def fastest(runs, level):
    """Return the fastest run that reaches the error; None if there is none."""
    return min((run for run in runs if run.error <= level), key=lambda run: run.seconds, default=None)


def time_text(seconds):
    return f"{seconds * 1e6:.3g} µs" if seconds < 1e-3 else f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def ratio_text(ratio):
    return "never" if ratio == NEVER else "–" if math.isnan(ratio) else f"{ratio:.2g}" if ratio < 10 else f"{ratio:,.0f}"


def words_of(best, name):
    return f"{name} does not get there" if best is None else f"{name} takes {time_text(best.seconds)}, with an error of {best.error:.1g}"


def cell_of(ours, theirs):
    lines = []
    for level in LEVELS:
        best = fastest(theirs, level)
        lines.append(f"to {level:g}: {words_of(best, best.method if best else 'it')}; {words_of(fastest(ours, level), 'the FMU')}")
    mine, other = fastest(ours, LEVELS[0]), fastest(theirs, LEVELS[0])
    ratio = math.nan if mine is None else NEVER if other is None else other.seconds / mine.seconds
    return Cell(ratio, "\n".join(lines))


def cells_of(runs):
    """Return by (section, problem) the fastest run of the FMU, and the Cell of each program."""
    problems = {}
    for run in runs:
        if (program := program_of(run.method)) is not None and math.isfinite(run.error):
            problems.setdefault((run.section, run.problem), {}).setdefault(program, []).append(run)
    return {
        problem: (fastest(programs["FMU"], LEVELS[0]), {program: cell_of(programs["FMU"], theirs) for program, theirs in programs.items() if program != "FMU"})
        for problem, programs in problems.items() if "FMU" in programs
    }  # fmt: skip


def programs_in(cells):
    return [program for program in COLOURS if any(program in row for _, row in cells.values())]


def shade(ratio):
    """Return the CSS class of a cell, by the power of ten of the ratio."""
    if math.isnan(ratio):
        return "unknown"
    if ratio == NEVER:
        return "never"
    return "slower" if ratio < 0.95 else "equal" if ratio < 1.5 else f"faster{min(int(math.log10(ratio)) + 1, 4)}"


def table(cells):
    programs = programs_in(cells)
    head = "".join(f"<th>{html.escape(program)}</th>" for program in programs)
    body, last = "", None
    for (section, problem), (ours, row) in cells.items():
        if section != last:
            body += f'<tr class="group"><th colspan="{len(programs) + 2}">{html.escape(section)}</th></tr>'
            last = section
        body += f"<tr><th>{html.escape(problem)}</th><td class=\"number\">{time_text(ours.seconds) if ours else '–'}</td>"
        for program in programs:
            cell = row.get(program)
            body += f'<td class="ratio {shade(cell.ratio)}" data-tip="{html.escape(cell.text)}">{ratio_text(cell.ratio)}</td>' if cell else "<td></td>"
        body += "</tr>"
    return f'<div class="wide"><table class="overview"><tr><th></th><th>FMU</th>{head}</tr>{body}</table></div>'


def picture(cells):
    """Return an SVG with a row for each program and a dot for each problem, at the ratio of the times."""
    programs = programs_in(cells)
    dots = {program: [(problem, row[program]) for (_, problem), (_, row) in cells.items() if program in row] for program in programs}
    ratios = [cell.ratio for row in dots.values() for _, cell in row if math.isfinite(cell.ratio)]
    if not ratios:
        return ""
    low, high = min(-1, math.floor(math.log10(min(ratios)))), max(1, math.ceil(math.log10(max(ratios))))
    left, right, row_height, end = 190, 770, 34, 900
    place = lambda ratio: left + (right - left) * (math.log10(ratio) - low) / (high - low)
    bottom = 16 + row_height * len(programs)
    shapes = ""
    for power in range(low, high + 1):
        label = "as fast as the FMU" if power == 0 else f"{10**power:,}" if power > 0 else f"1/{10**-power}"
        x = place(10.0**power)
        shapes += f'<line class="{"one" if power == 0 else "grid"}" x1="{x:.1f}" x2="{x:.1f}" y1="8" y2="{bottom}"/><text x="{x:.1f}" y="{bottom + 18}" text-anchor="middle">{label}</text>'
    shapes += f'<text x="{right + 90}" y="{bottom + 18}" text-anchor="middle">never</text>'
    shapes += f'<text x="{(left + right) / 2}" y="{bottom + 40}" text-anchor="middle">times the FMU\'s run time, to an error of {LEVELS[0]:g}; a dot a problem</text>'
    for i, program in enumerate(programs):
        y = 8 + row_height * (i + 0.5)
        shapes += f'<text x="{left - 24}" y="{y + 5}" text-anchor="end">{html.escape(program)}</text>'
        for k, (problem, cell) in enumerate(dots[program]):
            if math.isnan(cell.ratio):
                continue
            x = place(cell.ratio) if cell.ratio != NEVER else right + 60 + (k % 7) * 10
            tip = html.escape(f"{problem}: {ratio_text(cell.ratio)}\n{cell.text}")
            shapes += f'<circle cx="{x:.1f}" cy="{y + (k % 3 - 1) * 6:.1f}" r="5" fill="{COLOURS[program]}" data-tip="{tip}"/>'
    return f'<svg class="overview" viewBox="0 0 {end + 10} {bottom + 48}" role="img" aria-label="run times of other programs">{shapes}</svg>'


def overview(runs):
    """Return the HTML of plot and table; "" if there is nothing to compare."""
    cells = cells_of(runs)
    caption = (f"Ratios of run times to an error of {LEVELS[0]:g}: green where the FMU is faster, red where it is slower, grey where no run of the program "
               "gets there. A program's fastest method counts. Times and errors show themselves under the pointer.")  # fmt: skip
    return f'<div class="wide">{picture(cells)}</div><p>{caption}</p>{table(cells)}' if cells else ""
