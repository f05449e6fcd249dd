"""The drawing on an FMU's page, against positions at the start that are known in closed form."""

import math
import xml.etree.ElementTree as ElementTree

import pytest

import fmu
from fmu import lagc


def drawing(name, folder, *words):
    """The lines (x1, y1, x2, y2) and circles (x, y) of each class, y upwards; None where nothing is drawn."""
    result = lagc(fmu.ROOT / "fmu" / name / "system.xml", "-o", folder / name, *words)
    assert (result.returncode, result.stderr) == (0, "")
    svg = ElementTree.fromstring((folder / name / "documentation" / "index.html").read_text()).find("body/main/svg")
    if svg is None:
        return None
    places = {}
    for element in svg:
        keys = ("x1", "y1", "x2", "y2") if element.tag == "line" else ("cx", "cy")
        numbers = [float(element.get(key)) for key in keys]
        assert all(0 <= number <= 260 for number in numbers)
        places.setdefault(element.get("class"), []).append([-number if key[-2:] in ("y1", "y2", "cy") else number for key, number in zip(keys, numbers)])
    return places


def test_pendulum(tmp_path):
    """One rod from the pivot to the bob, at the angle of the start."""
    places = drawing("SimplePendulum", tmp_path)
    ((x1, y1, x2, y2),) = places["link"]
    theta = fmu.start_values("SimplePendulum")["theta"]
    assert math.atan2(x2 - x1, y1 - y2) == pytest.approx(theta, abs=1e-3)
    assert places["base"] == [[x1, y1]] and places["particle"] == [[x2, y2]]


def test_bars_meet_in_joints(tmp_path):
    """Crank, coupler and rocker are as long as they are, and the crank begins in the pivot and ends where the coupler begins."""
    places = drawing("FourBar", tmp_path)
    crank, coupler, rocker = places["body"]
    starts = fmu.start_values("FourBar")
    length = lambda bar: math.hypot(bar[2] - bar[0], bar[3] - bar[1])
    pixels = length(crank) / starts["a"]
    assert [length(coupler), length(rocker)] == pytest.approx([pixels * starts["b"], pixels * starts["c"]], abs=0.3)
    assert crank[:2] == pytest.approx(places["base"][0], abs=0.2) and crank[2:] == pytest.approx(coupler[:2], abs=0.2)
    assert math.atan2(coupler[3] - coupler[1], coupler[2] - coupler[0]) == pytest.approx(starts["phi"], abs=0.01)


def test_points_that_move_apart_are_not_linked(tmp_path):
    """A ball and the ground, a cart and its rail; but the cart and its pendulum are linked."""
    assert "link" not in drawing("BouncingBall", tmp_path)
    assert len(drawing("InvertedPendulumCart", tmp_path)["link"]) == 1


def test_what_has_no_bodies_is_not_drawn(tmp_path):
    assert drawing("StateFeedback", tmp_path) is None and drawing("Motor", tmp_path) is None
