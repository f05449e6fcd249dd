"""The report's first screen: ratios of run times to an error, and tooltips."""

import math
import re

import matplotlib.pyplot as plt

from scripts.pages.html_page import INK, page, svg, with_tips
from numerics.overview import NEVER, MethodRun, cells_of, overview, shade

RUNS = [
    MethodRun("Smooth", "A", "shipped", 1e-3, 1e-5),  # not accurate enough
    MethodRun("Smooth", "A", "shipped", 2e-3, 1e-7),
    MethodRun("Smooth", "A", "shipped", 1e-2, 1e-12),
    MethodRun("Smooth", "A", "SciPy DOP853", 5e-2, 1e-8),
    MethodRun("Smooth", "A", "SciPy LSODA", 4e-2, 1e-6),
    MethodRun("Smooth", "A", "SciPy Radau", 1e-9, math.nan),
    MethodRun("Smooth", "A", "heyoka", 1e-3, 1e-9),
    MethodRun("Smooth", "A", "MuJoCo RK4", 1e-3, 1e-3),
    MethodRun("Smooth", "A", "taylor", 1e-6, 1e-15),  # the FMU with another method is no peer
    MethodRun("Stiff", "B", "auto", 1.0, 1e-2),
    MethodRun("Stiff", "B", "exudyn generalized-alpha", 1.0, 1e-8),
    MethodRun("Stiff", "C", "SciPy Radau", 1.0, 1e-8),  # no other run to compare with
]


def test_ratios():
    cells = cells_of(RUNS)
    assert list(cells) == [("Smooth", "A"), ("Stiff", "B")]
    ours, row = cells["Smooth", "A"]
    assert ours.seconds == 2e-3 and {program: cell.ratio for program, cell in row.items()} == {"SciPy": 20, "heyoka": 0.5, "MuJoCo": NEVER}
    assert math.isnan(cells["Stiff", "B"][1]["exudyn"].ratio)
    assert [shade(ratio) for ratio in (0.5, 1, 5, 20, 500, 1e9, NEVER, math.nan)] == ["slower", "equal", "faster1", "faster2", "faster3", "faster4", "never", "unknown"]
    text = row["SciPy"].text.splitlines()
    assert text[0] == "to 1e-06: SciPy LSODA takes 40 ms, with an error of 1e-06; the FMU takes 2 ms, with an error of 1e-07"
    assert text[1] == "to 1e-10: it does not get there; the FMU takes 10 ms, with an error of 1e-12"


def test_the_picture_and_the_table():
    """The picture has a dot, and the table a cell, for each ratio, on a logarithmic scale."""
    text = overview(RUNS)
    dots = dict(re.findall(r'<circle cx="([\d.]+)"[^>]*data-tip="A: ([^\n]*)', text))
    place = {ratio: float(x) for x, ratio in dots.items()}
    lines = [float(x) for x in re.findall(r'<line class="grid" x1="([\d.]+)"', text)]
    [one] = re.findall(r'<line class="one" x1="([\d.]+)"', text)
    decade = (max(lines) - min(lines)) / len(lines)
    assert set(place) == {"20", "0.5", "never"} and place["never"] > max(lines)
    assert abs(place["20"] - float(one) - decade * math.log10(20)) < 0.2 and abs(place["0.5"] - float(one) + decade * math.log10(2)) < 0.2
    assert re.findall(r'<td class="ratio (\w+)"[^>]*>([^<]*)<', text) == [
        ("faster2", "20"), ("slower", "0.5"), ("never", "never"), ("unknown", "–")]  # fmt: skip
    assert overview([]) == ""


def test_plots_label_their_points():
    figure, axes = plt.subplots()
    [line] = axes.plot([1, 2], [3, 4], marker="o")
    with_tips(line, ["first: \"1\" < 2", "second"])
    text = svg(figure)
    assert re.findall(r'<use data-tip="([^"]*)"', text) == ["first: &quot;1&quot; &lt; 2", "second"]
    assert INK not in text and "currentColor" in text  # the colour of the surrounding text, light or dark
    assert 'href="#section0"' in page([("Title", ""), ("Plots", text)])
