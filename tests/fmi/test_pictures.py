"""The drawing of a system in its FMU: model.png, icon.svg, and the same on the documentation page."""

import math
import re

import fmi3
import fmu
import numpy as np
import pytest
from lxml import etree
from matplotlib.image import imread

SIDE = 160  # of the drawing, in SVG units; the PNG has 128 pixels


def shapes(name, element, look):
    """Points of all circles, lines or polygons of a class, as rows of x and y in the drawing. `name` is that of a system, or the path of its icon."""
    path = fmi3.unpacked(name) / "terminalsAndIcons" / "icon.svg" if isinstance(name, str) else name
    svg = etree.parse(path).getroot()
    found = [shape for shape in svg if etree.QName(shape).localname == element and shape.get("class") == look]
    text = lambda shape: f"{shape.get('cx')},{shape.get('cy')}" if element == "circle" else shape.get("points")
    return [np.array([[float(number) for number in point.split(",")] for point in text(shape).split()]) for shape in found]


@pytest.fixture
def guessed(tmp_path):
    """Return a function that writes the icon of a system without its lines and shapes, and returns the path."""

    def write(name):
        text = (fmu.ROOT / "fmu" / name / "system.xml").read_text(encoding="utf-8")
        (tmp_path / "system.xml").write_text(re.sub(r"<(line|shape)\b[^>]*/>", "", text), encoding="utf-8")
        assert fmu.lagc(tmp_path / "system.xml", "-o", tmp_path / name).returncode == 0
        return tmp_path / name / "fmi3" / "icon.svg"

    return write


def test_all_of_it_is_seen_and_the_page_shows_the_same(name):
    image = imread(fmu.unpacked(name) / "model.png")[..., :3]
    assert image.shape == (128, 128, 3)
    assert 60 < np.count_nonzero(image.min(axis=2) < 0.9) < 128**2 / 1.5
    frame = np.ones((128, 128), bool)
    frame[2:-2, 2:-2] = False
    assert np.all(image[frame] == 1)  # nothing is cut off
    svg = (fmi3.unpacked(name) / "terminalsAndIcons" / "icon.svg").read_text()
    page = (fmu.unpacked(name) / "documentation" / "index.html").read_text()
    drawn = lambda text: re.findall(r'(?:points|cx|cy|r)="[^"]*"', text)
    assert drawn(svg) == drawn(page[page.index('<svg class="sketch"') : page.index("</svg>")])


def test_names_axes_and_scale_of_the_page(tmp_path):
    """
    The masses have their names beside them, and the scale is measured by the rods of 1 m. The icon has none of
    these, and neither has a block.
    """
    for name in ("DoublePendulum", "PidController"):
        assert fmu.lagc(fmu.ROOT / "fmu" / name / "system.xml", "-o", tmp_path / name).returncode == 0
    page, block = ((tmp_path / name / "documentation" / "index.html").read_text() for name in ("DoublePendulum", "PidController"))
    texts = {text: np.array([float(x), float(y)]) for x, y, text in re.findall(r'<text x="([^"]*)" y="([^"]*)">([^<]*)</text>', page)}
    assert list(texts) == ["upper", "lower", "x", "y", "0.5 m"]
    [lower], [upper] = shapes(tmp_path / "DoublePendulum" / "fmi3" / "icon.svg", "circle", "particle")
    assert texts["upper"] - upper == pytest.approx([6, -5], abs=0.1) and texts["lower"] - lower == pytest.approx([6, -5], abs=0.1)
    [along] = re.findall(r'<path d="M[\d. ]*l(\d[\d.]*) -?0\.0"/><text [^>]*>0\.5 m', page)
    assert float(along) == pytest.approx(0.5 * np.linalg.norm(upper - lower), abs=0.2)
    assert texts["x"][0] > texts["y"][0] and texts["y"][1] < texts["x"][1]
    assert "<text" not in (tmp_path / "DoublePendulum" / "fmi3" / "icon.svg").read_text() + block


@pytest.mark.parametrize("name", ["DoublePendulum", "ChainPendulum", "ElasticPendulum"])
def test_the_png_is_the_svg(name):
    """Each particle has the position and the area of that in the SVG."""
    image = imread(fmu.unpacked(name) / "model.png")[..., :3]
    particles = shapes(name, "circle", "particle")
    blue = np.array([26, 95, 180]) / 255
    for [[right, down]] in particles:
        assert image[int(down * 0.8), int(right * 0.8)] == pytest.approx(blue, abs=0.01)
    whole = np.count_nonzero(np.all(abs(image - blue) < 0.01, axis=2))
    assert whole == pytest.approx(len(particles) * math.pi * (4.5 * 0.8 - 0.5) ** 2, rel=0.35)


@pytest.mark.parametrize("is_guessed", [True, False])
def test_the_loop_is_closed_at_the_start(guessed, is_guessed):
    """The bars' ends meet, with pivots 0.9 m apart; the start values alone would leave them apart. A drawn rod is a rectangle."""
    if is_guessed:
        crank, coupler, rocker = shapes(guessed("FourBar"), "polyline", "body")
    else:
        rods = [(rod[:2] + rod[3:1:-1]) / 2 for rod in shapes("FourBar", "polyline", "solid")]
        crank, coupler, rocker = rods
    metre = np.linalg.norm(coupler[1] - coupler[0]) / 0.8
    assert crank[1] == pytest.approx(coupler[0], abs=0.15)
    assert coupler[1] == pytest.approx(rocker[1], abs=0.15)
    assert np.linalg.norm(rocker[0] - crank[0]) == pytest.approx(0.9 * metre, abs=0.3)


@pytest.mark.parametrize("is_guessed", [True, False])
def test_the_pendulum_hangs_at_the_angle_of_its_start(guessed, is_guessed):
    system = guessed("SimplePendulum") if is_guessed else "SimplePendulum"
    [rod] = [line for line in shapes(system, "polyline", "link") if len(line) == 2]  # the support is a triangle
    [[pivot]] = shapes(system, "circle", "base")
    right, down = rod[1] - rod[0]
    assert rod[0] == pytest.approx(pivot) and math.atan2(right, down) == pytest.approx(fmu.start_values("SimplePendulum")["theta"], abs=2e-3)


def test_points_that_move_apart_are_not_linked(guessed):
    """A ball and the ground, or a cart and its rail, are not linked; the cart and its pendulum are."""
    assert not shapes(guessed("BouncingBall"), "polyline", "link")
    assert len(shapes(guessed("InvertedPendulumCart"), "polyline", "link")) == 1


def test_a_rod_given_as_a_constraint(guessed):
    icon = guessed("PendulumCartesian")
    [[pivot]], [[bob]], [rod] = shapes(icon, "circle", "hole"), shapes(icon, "circle", "particle"), shapes(icon, "polyline", "link")
    assert sorted(map(tuple, rod)) == sorted([tuple(pivot), tuple(bob)])


def test_floor_and_stop(guessed):
    """The floor is a horizontal line under the ball through the origin; the stop is at the pendulum's radius, perpendicular to it."""
    ball, pendulum = guessed("BouncingBall"), guessed("HardStopPendulum")
    [[origin]], floor = shapes(ball, "circle", "hole"), shapes(ball, "polyline", "ground")[-1]
    assert floor[:, 1] == pytest.approx([origin[1]] * 2, abs=0.06) and floor[0, 0] < origin[0] < floor[1, 0]
    [[pivot]], stop = shapes(pendulum, "circle", "hole"), shapes(pendulum, "polyline", "ground")[-1]
    [[bob]] = shapes(pendulum, "circle", "particle")
    middle = stop.mean(axis=0)
    assert np.linalg.norm(middle - pivot) == pytest.approx(np.linalg.norm(bob - pivot), abs=0.3)
    along, out = stop[1] - stop[0], middle - pivot
    assert abs(along[0] * out[1] - along[1] * out[0]) < 0.02 * np.linalg.norm(along) * np.linalg.norm(out)


def test_a_disk_is_an_ellipse():
    """A disk with normal n seen along e is an ellipse with half-axes R and R |n.e|, and area pi R^2 |n.e|."""
    [disk] = shapes("RollingDisk", "polygon", "solid")
    x, y = disk.T
    area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    radius = np.linalg.norm(disk - disk.mean(axis=0), axis=1).max()
    least = np.linalg.norm(disk - disk.mean(axis=0), axis=1).min()
    assert area == pytest.approx(math.pi * radius * least, rel=0.03)


def test_drawn_lines():
    """
    The spring of the block runs from the wall to the block; the belt is below it, 2.1 m between the axes of pulleys of radius 0.1 m. The
    threads of the cradle are parallel where balls hang, a diameter apart.
    """
    lines = shapes("StickSlip", "polyline", "link")
    belt, spring = max(lines, key=np.ptp), next(line for line in lines if len(line) == 16)
    metre = np.ptp(belt[:, 0]) / 2.3
    assert np.ptp(belt[:, 1]) == pytest.approx(0.2 * metre, abs=0.3)
    assert spring[0, 1] == pytest.approx(spring[-1, 1]) == pytest.approx(belt[:, 1].min() - 0.1 * metre, abs=0.3)
    assert spring[-1, 0] - spring[0, 0] == pytest.approx(0.875 * metre, abs=0.3)
    threads = shapes("NewtonsCradle", "polyline", "link")
    tops, ends = (np.array([thread[k] for thread in threads]) for k in (0, 1))
    length = np.hypot(*(ends[1] - tops[1]))
    assert np.diff(tops[:, 0]) == pytest.approx([0.2 * length] * 4, abs=0.3) and ends[1:, 0] == pytest.approx(tops[1:, 0], abs=0.1)
    assert ends[0] - tops[0] == pytest.approx([length * math.sin(-0.5), length * math.cos(0.5)], abs=0.3)
