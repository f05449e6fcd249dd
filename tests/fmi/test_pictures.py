"""The pictures of a system in its FMU: the icon as model.png and icon.svg, and the drawing that the documentation page's script makes."""

import html
import math
import re

import fmi3
import fmu
import numpy as np
import pytest
from chromium import look_at
from lxml import etree
from matplotlib.image import imread

COLORS = {"body": "#1a5fb4", "link": "#687085", "base": "#1d2433", "ground": "#78786e"}
BLOCKS = {"PidController": {"r", "y", "u"}, "SpringDamper": {"x1", "v1", "x2", "v2", "F1", "F2"}, "StateFeedback": {"x", "θ", "v", "ω", "F"}}
# JavaScript: the polylines and circles of a page's drawing by their classes, in its units, and its labels with their places in these units.
DRAWN = """view => {
  const picture = view.document.querySelector(".sketch"), svg = picture.querySelector("svg"), frame = svg.getBoundingClientRect(), scale = frame.width / svg.viewBox.baseVal.width;
  const lines = [...svg.querySelectorAll("polyline")].map(line => [line.getAttribute("class"), line.getAttribute("points").split(" ").map(point => point.split(",").map(Number))]);
  const circles = [...svg.querySelectorAll("circle")].map(one => [one.getAttribute("class"), ["cx", "cy", "r"].map(name => Number(one.getAttribute(name)))]);
  const labels = [...picture.querySelectorAll("span")].map(label => {
    const box = label.getBoundingClientRect();
    return [label.textContent, [((box.left + box.right) / 2 - frame.left) / scale, ((box.top + box.bottom) / 2 - frame.top) / scale]];
  });
  return { lines, circles, labels };
}"""


def shapes(name, element, look):
    """Points of all circles, lines or polygons of a colour in an icon, as rows of x and y. `name` is that of a system, or the path of its icon."""
    path = fmi3.unpacked(name) / "terminalsAndIcons" / "icon.svg" if isinstance(name, str) else name
    svg = etree.parse(path).getroot()
    found = [shape for shape in svg if etree.QName(shape).localname == element and COLORS[look] in (shape.get("fill"), shape.get("stroke"))]
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


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Return the drawings of the pages of all systems, by name."""
    names = fmu.all_names()
    found = look_at([fmu.unpacked(name) / "documentation" / "index.html" for name in names], tmp_path_factory.mktemp("pages"), [1200], DRAWN)
    return {name: found[1200, i] for i, name in enumerate(names)}


def lines_of(drawing, look):
    """Return the polylines that have these classes, as arrays of points."""
    return [np.array(points) for classes, points in drawing["lines"] if set(look.split()) <= set(classes.split())]


def dots(drawing, look):
    """Return the centres of circles of a class."""
    return [np.array(circle[:2]) for classes, circle in drawing["circles"] if classes == look]


def places(drawing):
    """Return the places of labels, lists of points by text."""
    found = {}
    for text, place in drawing["labels"]:
        found.setdefault(text, []).append(np.array(place))
    return found


def scale_of(drawing):
    """Return the units of a drawing for 1 m, by its scale."""
    [(text, _)] = [label for label in drawing["labels"] if label[0].endswith(" m")]
    return np.ptp(lines_of(drawing, "axis")[-1][:, 0]) / float(text.split()[0])


def test_all_of_the_icon_is_seen(name):
    image = imread(fmu.unpacked(name) / "model.png")[..., :3]
    assert image.shape == (128, 128, 3)
    assert 60 < np.count_nonzero(image.min(axis=2) < 0.9) < 128**2 / 1.5
    frame = np.ones((128, 128), bool)
    frame[2:-2, 2:-2] = False
    assert np.all(image[frame] == 1)  # nothing is cut off


def test_every_page_has_a_drawing(drawn):
    """Each has lines, and labels of its axes and its scale; a block has the names of its inputs and outputs. The scene is left as text."""
    for name, drawing in drawn.items():
        texts = places(drawing)
        assert len(drawing["lines"]) + len(drawing["circles"]) >= 3, name
        assert set(texts) == BLOCKS[name] if name in BLOCKS else {"x"} < set(texts) and any(text.endswith(" m") for text in texts), name
        assert '<pre class="scene">' in (fmu.unpacked(name) / "documentation" / "index.html").read_text()


def test_labels_of_a_double_pendulum(drawn):
    """Masses and lengths of 1 m have their names beside them; theta1 = theta2 = 2 are arcs from the vertical to the rods."""
    drawing = drawn["DoublePendulum"]
    texts, metre = places(drawing), scale_of(drawing)
    assert set(texts) == {"m1", "m2", "l1", "l2", "θ1", "θ2", "x", "y", "0.5 m"}
    [base] = dots(drawing, "base")
    upper, lower = sorted(dots(drawing, "particle"), key=lambda ball: np.linalg.norm(ball - base))
    assert upper - base == pytest.approx(metre * np.array([math.sin(2), math.cos(2)]), abs=0.2)
    assert lower - upper == pytest.approx(upper - base, abs=0.2)
    for label, ball in (("m1", upper), ("m2", lower)):
        assert np.linalg.norm(texts[label][0] - ball) < 35
    for label, middle in (("l1", (base + upper) / 2), ("l2", (upper + lower) / 2)):
        assert np.linalg.norm(texts[label][0] - middle) < 30
    arcs = [arc for arc in lines_of(drawing, "mark") if len(arc) > 5]
    for arc, centre in zip(arcs, (base, upper)):
        angles = np.unwrap(np.arctan2(arc[:, 0] - centre[0], arc[:, 1] - centre[1]))
        assert (angles[0], angles[-1]) == pytest.approx((0, 2), abs=0.01) and np.ptp(np.linalg.norm(arc - centre, axis=1)) < 0.2


def test_coordinates_of_a_particle(drawn):
    """x is an arrow from the origin to the pendulum's ball, (1, 0) at the start; y, which is 0, points upwards."""
    drawing = drawn["PendulumCartesian"]
    x, y = [mark for mark in lines_of(drawing, "mark") if np.ptp(mark, axis=0).max() > 10]
    start = fmu.start_values("PendulumCartesian")
    assert x[-1] - x[0] == pytest.approx([scale_of(drawing) * start["x"], 0], abs=0.3) and y[0] == pytest.approx(x[-1])
    assert y[-1] - y[0] == pytest.approx([0, -30], abs=0.2)


def test_the_azimuth_turns_about_the_vertical(own_scene):
    """phi of a spherical pendulum, whose rod is inclined, turns about z; the centre is at the height of the ball. A rope of 2 m has not the length l."""
    scene = own_scene("""<parameter name="l" start="2"/><coordinate name="phi" velocity="w" start="0.5"/><coordinate name="theta" velocity="v" start="0.3"/>
  <particle name="bob" mass="l" x="l*sin(theta)*cos(phi)" y="l*sin(theta)*sin(phi)" z="-l*cos(theta)"/><potential>bob.z</potential>
  <line kind="rod" from="base" to="bob"/><line kind="rope" from="base" to="0, 0, 2"/>""")
    phi, theta = scene.findall("coordinate")
    numbers = lambda mark, name: [float(number) for number in mark.get(name).split()]
    assert numbers(phi, "axis") == pytest.approx([0, 0, 1]) and numbers(phi, "from") == pytest.approx([0, 0, -2 * math.cos(0.3)], abs=1e-3)
    assert numbers(theta, "axis") == pytest.approx([math.sin(0.5), -math.cos(0.5), 0], abs=1e-3) and numbers(theta, "from") == [0, 0, 0]
    assert [line.get("label") for line in scene.findall("line")] == ["l", None]
    assert scene.find("particle").get("label") == "l"


def test_the_angle_of_a_body_and_a_ratio(own_scene):
    """A body turns by its own angle; a carriage at 2*s has no mark, as it moves by twice the coordinate."""
    scene = own_scene("""<coordinate name="phi" velocity="w" start="0.5"/><coordinate name="s" velocity="v"/>
  <body name="bar" mass="1" inertia="1" x="3" y="1" angle="phi"/><particle name="carriage" mass="1" x="2*s"/>""")
    [phi] = scene.findall("coordinate")
    assert (phi.get("name"), phi.get("from"), phi.get("axis")) == ("phi", "3 1 0", "0 0 1")
    assert [float(number) for number in phi.get("to").split()] == pytest.approx([3 + 0.1 * math.cos(0.5), 1 + 0.1 * math.sin(0.5), 0], abs=1e-3)


@pytest.fixture
def own_scene(tmp_path):
    """Return a function that returns the scene of a system's page."""

    def scene(content):
        (tmp_path / "system.xml").write_text(f'<system name="Own">{content}</system>', encoding="utf-8")
        assert fmu.lagc(tmp_path / "system.xml", "-o", tmp_path / "out").returncode == 0
        page = (tmp_path / "out" / "documentation" / "index.html").read_text(encoding="utf-8")
        return etree.fromstring(html.unescape(re.search(r'<pre class="scene">(.*?)</pre>', page, re.S)[1]))

    return scene


@pytest.mark.parametrize("name", ["DoublePendulum", "ChainPendulum", "ElasticPendulum"])
def test_the_png_is_the_svg(name):
    """Each particle has the position and the area of that in the SVG."""
    image = imread(fmu.unpacked(name) / "model.png")[..., :3]
    particles = shapes(name, "circle", "body")
    blue = np.array([26, 95, 180]) / 255
    for [[right, down]] in particles:
        assert image[int(down * 0.8), int(right * 0.8)] == pytest.approx(blue, abs=0.01)
    whole = np.count_nonzero(np.all(abs(image - blue) < 0.01, axis=2))
    assert whole == pytest.approx(len(particles) * math.pi * (4.5 * 0.8 - 0.5) ** 2, rel=0.35)


def middle_line(corners):
    """Return the ends of the middle line of a rectangle, from the left to the right."""
    sides = [np.array([corners[i], corners[(i + 1) % 4]]) for i in range(4)]
    first, second = sorted(sides, key=lambda side: np.linalg.norm(side[1] - side[0]))[:2]
    return np.array(sorted([tuple(first.mean(axis=0)), tuple(second.mean(axis=0))]))


@pytest.mark.parametrize("is_guessed", [True, False])
def test_the_loop_is_closed_at_the_start(guessed, is_guessed):
    """The bars' ends meet, with pivots 0.9 m apart; the start values alone would leave them apart. A drawn rod is a rectangle."""
    if is_guessed:
        rocker, coupler, crank = shapes(guessed("FourBar"), "polyline", "body")
    else:
        crank, coupler, rocker = (middle_line(corners[:4]) for corners in shapes("FourBar", "polyline", "body"))
        rocker = rocker[np.argsort(-rocker[:, 1])]  # from its lower end
    metre = np.linalg.norm(coupler[1] - coupler[0]) / 0.8
    assert crank[1] == pytest.approx(coupler[0], abs=0.15)
    assert coupler[1] == pytest.approx(rocker[1], abs=0.15)
    assert np.linalg.norm(rocker[0] - crank[0]) == pytest.approx(0.9 * metre, abs=0.3)


@pytest.mark.parametrize("is_guessed", [True, False])
def test_the_pendulum_hangs_at_the_angle_of_its_start(guessed, is_guessed):
    system = guessed("SimplePendulum") if is_guessed else "SimplePendulum"
    [rod] = [line for line in shapes(system, "polyline", "link") if len(line) == 2]
    [[pivot]] = shapes(system, "circle", "base")
    right, down = rod[1] - rod[0]
    assert rod[0] == pytest.approx(pivot) and math.atan2(right, down) == pytest.approx(fmu.start_values("SimplePendulum")["theta"], abs=2e-3)


def test_points_that_move_apart_are_not_linked(guessed):
    """A ball and the ground, or a cart and its rail, are not linked; the cart and its pendulum are."""
    assert not shapes(guessed("BouncingBall"), "polyline", "link")
    assert len(shapes(guessed("InvertedPendulumCart"), "polyline", "link")) == 1


def test_a_rod_given_as_a_constraint(guessed):
    icon = guessed("PendulumCartesian")
    [[pivot]], [[bob]], [rod] = shapes(icon, "circle", "base"), shapes(icon, "circle", "body"), shapes(icon, "polyline", "link")
    assert sorted(map(tuple, rod)) == sorted([tuple(pivot), tuple(bob)])


def test_floor_and_stop(guessed, tmp_path):
    """
    On the page the floor is a horizontal line under the ball through the origin. The stop is at the pendulum's radius, perpendicular to it.
    """
    pages = [guessed(name).parents[1] / "documentation" / "index.html" for name in ("BouncingBall", "HardStopPendulum")]
    ball, pendulum = look_at(pages, tmp_path, [1200], DRAWN).values()
    [origin], floor = dots(ball, "base"), lines_of(ball, "ground")[0]
    assert floor[:, 1] == pytest.approx([origin[1]] * 2, abs=0.2) and min(floor[:, 0]) < origin[0] < max(floor[:, 0])
    [pivot], [bob], stop = dots(pendulum, "base"), dots(pendulum, "particle"), lines_of(pendulum, "ground")[0]
    middle = stop.mean(axis=0)
    assert np.linalg.norm(middle - pivot) == pytest.approx(np.linalg.norm(bob - pivot), abs=0.3)
    along, out = stop[1] - stop[0], middle - pivot
    assert abs(along[0] * out[1] - along[1] * out[0]) < 0.02 * np.linalg.norm(along) * np.linalg.norm(out)


def test_a_disk_is_an_ellipse():
    """A disk with normal n seen along e is an ellipse with half-axes R and R |n.e|, and area pi R^2 |n.e|."""
    disk = max(shapes("RollingDisk", "polygon", "body"), key=len)
    x, y = disk.T
    area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    radius = np.linalg.norm(disk - disk.mean(axis=0), axis=1).max()
    least = np.linalg.norm(disk - disk.mean(axis=0), axis=1).min()
    assert area == pytest.approx(math.pi * radius * least, rel=0.03)


def test_wheels_of_an_icon():
    """The axles of the car are 2.7 m apart, its wheels have a radius of 0.3 m."""
    wheels = [line for line in shapes("HalfCar", "polyline", "link") if len(line) > 2]
    low, high = (np.array([bound(line, axis=0) for line in wheels]) for bound in (np.min, np.max))
    assert high - low == pytest.approx(np.full((2, 2), 0.6 / 2.7 * abs(low[0, 0] - low[1, 0])), abs=0.2)


def test_drawn_lines(drawn):
    """
    The spring of the block runs from the wall to the block; the belt is below it, 2.1 m between the axes of pulleys of radius 0.1 m. The
    threads of the cradle are parallel where balls hang, a diameter apart.
    """
    lines, metre = lines_of(drawn["StickSlip"], "link"), scale_of(drawn["StickSlip"])
    belt, spring = max(lines, key=np.ptp), next(line for line in lines if len(line) == 18)
    assert np.ptp(belt[:, 0]) == pytest.approx(2.3 * metre, abs=0.3) and np.ptp(belt[:, 1]) == pytest.approx(0.2 * metre, abs=0.3)
    assert spring[0, 1] == pytest.approx(spring[-1, 1]) == pytest.approx(belt[:, 1].min() - 0.1 * metre, abs=0.3)
    assert spring[-1, 0] - spring[0, 0] == pytest.approx(0.875 * metre, abs=0.3)
    threads = lines_of(drawn["NewtonsCradle"], "link")
    tops, ends = (np.array([thread[k] for thread in threads]) for k in (0, 1))
    length = np.hypot(*(ends[1] - tops[1]))
    assert np.diff(tops[:, 0]) == pytest.approx([0.2 * length] * 4, abs=0.3) and ends[1:, 0] == pytest.approx(tops[1:, 0], abs=0.1)
    assert ends[0] - tops[0] == pytest.approx([length * math.sin(-0.5), length * math.cos(0.5)], abs=0.3)
