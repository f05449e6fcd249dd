"""
The animation that scripts/run leaves: what stands in the page against closed forms, and its script, run by QuickJS with a page and
a canvas in place of a browser's.
"""

import json
import math
import re
import subprocess
import sys
from types import SimpleNamespace

import matplotlib.image
import numpy as np
import pytest
import quickjs
from scipy.spatial.transform import Rotation

import fmu
from animation.links import joints, links_of
from animation.page import box_of, page, quaternions, scene_data
from animation.scene import Element, read_scene, value_of
from closed_forms import pendulum_angle
from fmu import ROOT

CANVAS = (ROOT / "tests" / "animation" / "canvas.js").read_text()


def run(folder, name, *words):
    """The page of a run of scripts/simulate.py, and what it printed."""
    result = subprocess.run([sys.executable, ROOT / "scripts" / "simulate.py", fmu.archive(name), *words], capture_output=True, text=True, cwd=folder)
    assert result.returncode == 0, result.stderr
    path = folder / "build" / "results" / f"{name}.html"
    return path.read_text() if path.exists() else None, result.stdout


def scene_in(text):
    return json.loads(re.search(r'<script id="scene" type="application/json">(.*?)</script>', text, re.S)[1])


class Browser:
    """The page's script, and what it draws."""

    def __init__(self, text):
        self.engine = quickjs.Context()
        scene = json.dumps(re.search(r'<script id="scene"[^>]*>(.*?)</script>', text, re.S)[1])
        script = re.search(r"<script>\n(.*)</script>", text, re.S)[1]
        self.engine.eval(CANVAS.replace('"use strict";', "") + f'document.getElementById("scene").textContent = {scene};')
        self.engine.eval(script)
        self.now = 0.0
        self.frame(0.0)

    def eval(self, text):
        return json.loads(self.engine.eval(f"JSON.stringify({text})"))

    def do(self, text):
        self.engine.eval(text + "; 0")

    def frame(self, seconds):
        """Draws a frame this much later."""
        self.now += 1000.0 * seconds
        self.do(f"frame({self.now})")
        return self.eval("drawn")

    def to(self, time):
        """Moves the slider."""
        self.do(f'$("slider").value = ({time} - first) / (last - first); $("slider").listeners.input()')
        return self.frame(0.1)


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory):
    return run(tmp_path_factory.mktemp("pendulum"), "SimplePendulum", "theta=2", "l=0.5")


@pytest.fixture(scope="module")
def four_bar(tmp_path_factory):
    return run(tmp_path_factory.mktemp("four_bar"), "FourBar", "a=0.25")[0]


def test_where_it_is(pendulum):
    page, printed = pendulum
    assert re.search(r"^animation +/.*/build/results/SimplePendulum\.html$", printed, re.M)
    # One file: no address, and nothing that a browser would fetch.
    assert not re.search(r"https?:|src=|href|url\(|import\b|fetch|XMLHttp|<link", page)


def test_a_pendulum(pendulum):
    scene = scene_in(pendulum[0])
    (bob,) = scene["elements"]
    x, y, z = bob["position"]
    rate = math.sqrt(9.81 / 0.5)
    for k in range(0, len(scene["times"]), 100):
        theta = pendulum_angle(2.0, rate, scene["times"][k])
        assert (x[k], y[k], z) == pytest.approx((0.5 * math.sin(theta), -0.5 * math.cos(theta), 0.0), abs=2e-5)
    assert scene["times"][0] == 0.0 and scene["times"][-1] == 10.0 and scene["speed"] == 1.0
    assert scene["view"]["plane"] == ["x", "y"] and bob["trail"]
    assert scene["links"] == [{"from": [-1, [0, 0, 0]], "to": [0, [0, 0, 0]], "kind": "rod"}]


def circles(drawn):
    return [shape["circle"] for shape in drawn if shape.get("circle") and shape["kind"] == "fill"]


def test_what_is_drawn_of_a_pendulum(pendulum):
    """The bob where it is, in pixels of the camera, its rod as long as it is, at any time of the slider."""
    browser, rate = Browser(pendulum[0]), math.sqrt(9.81 / 0.5)
    for time in (0.0, 0.3333, 4.25, 10.0):
        drawn = browser.to(time)
        camera = browser.eval("camera")
        theta = pendulum_angle(2.0, rate, time)
        bob = np.array([0.5 * math.sin(theta), -0.5 * math.cos(theta)])
        expected = np.array([400, 300]) + (bob - camera["centre"][:2]) * camera["zoom"] * [1, -1]
        assert any(np.allclose(circle[:2], expected, atol=0.3) for circle in circles(drawn))
        rods = [np.array(shape["path"]) for shape in drawn if shape["kind"] == "stroke" and shape["width"] == 3]
        assert len(rods) == 1 and np.linalg.norm(rods[0][1] - rods[0][0]) == pytest.approx(0.5 * camera["zoom"], rel=1e-3)
        assert all(np.isfinite(shape["path"] or [[0.0]]).all() for shape in drawn)
        assert browser.eval('$("clock").textContent') == f"{time:.4g} s of 10 s"
        # All of it is in the picture.
        assert all(0 <= x <= 800 and 0 <= y <= 600 for x, y, _ in circles(drawn))


def test_play_and_pause(pendulum):
    browser = Browser(pendulum[0])
    time = lambda: browser.eval("state.time")
    browser.frame(0.25)
    assert time() == pytest.approx(0.25)
    browser.do('$("speed").value = 0.5')
    browser.frame(0.5)
    assert time() == pytest.approx(0.5)
    browser.do('$("play").listeners.click()')
    browser.frame(1.0)
    assert time() == pytest.approx(0.5) and browser.eval('$("play").textContent') == "Play"
    browser.do('document.listeners.keydown({ key: " ", target: {}, preventDefault() {} })')
    browser.frame(1.0)
    assert time() == pytest.approx(1.0)
    browser.frame(20.0)
    assert time() == 0.0  # from the beginning


def test_a_linkage(four_bar):
    """Boxes as long as the rods are, rigid, with their ends where the pins are: a = 0.25 m, b = 0.8 m, c = 0.6 m, d = 0.9 m."""
    scene, browser = scene_in(four_bar), Browser(four_bar)
    assert [element["name"] for element in scene["elements"]] == ["crank", "coupler", "rocker"]
    for i, length in enumerate((0.25, 0.8, 0.6)):
        assert scene["elements"][i]["sides"][0] == pytest.approx(length, abs=1e-4)
        for place in (0.0, 33.3, 420.9, 1000.0):
            faces = np.array(browser.eval(f"boxOf(scene, scene.elements[{i}], {place}).map((face) => face.corners)"))
            corners = np.unique(faces.reshape(-1, 3).round(9), axis=0)
            assert len(corners) == 8
            centre = np.array(browser.eval(f"positionOf(scene.elements[{i}], {place})"))
            sides = np.array(scene["elements"][i]["sides"])
            assert np.linalg.norm(corners - centre, axis=1) == pytest.approx(np.linalg.norm(sides) / 2, rel=1e-6)
    for k in (0, 10, 777):
        theta, phi, psi = (element["angle"][k] for element in scene["elements"])
        pins = [(0, 0), (0.25 * math.cos(theta), 0.25 * math.sin(theta)), (0.9 + 0.6 * math.cos(psi), 0.6 * math.sin(psi)), (0.9, 0)]
        for link in scene["links"]:
            x, y, _ = browser.eval(f"pointOf(scene, {json.dumps(link['to'])}, {k})")
            assert min(math.hypot(x - u, y - v) for u, v in pins) < 1e-4
    assert len(scene["links"]) == 6 and len(scene["marks"]) == 4


def test_directions_of_rods():
    """A pillar whose angle is that of its cross-section, and a plate without joints."""
    t = np.linspace(0, 3, 200)
    upright = np.stack([0.5 * np.sin(t), 0.5 * np.cos(t), 0 * t], axis=1)
    pillar = Element("body", "pillar", upright, mass=2.0, angle=-t, inertia=np.diag([0, 0, 2.0 / 12]))
    plate = Element("body", "plate", np.stack([t, t**2, 0 * t], axis=1), mass=2.0, angle=t**3, inertia=np.diag([0, 0, 0.3]))
    found = joints([pillar, plate])
    assert len(found) == 1 and found[0][0].element is None and found[0][0].place == pytest.approx([0, 0, 0], abs=1e-9)
    assert found[0][1].element == 0 and found[0][1].place == pytest.approx([0, -0.5, 0], abs=1e-9)
    # What turns with the pillar is joined to it nowhere; both turn about the base.
    upper = Element("body", "upper", 2.0 * upright, mass=1.0, angle=-t, inertia=np.diag([0, 0, 0.1]))
    assert [(ends[0].element, ends[1].element) for ends in joints([pillar, upper])] == [(None, 0), (None, 1)]
    sides, axes = box_of(pillar, (0.0, -1.0))
    assert sides == pytest.approx([1.0, 0, 0]) and abs(axes[:, 0]) == pytest.approx([0, 1, 0])
    assert box_of(plate, None)[0] == pytest.approx([math.sqrt(0.9)] * 2 + [0])


def test_rods_between_particles():
    """A chain, which hangs from the base; what moves freely has none, nor has a particle in the middle of its rod."""
    t = np.linspace(0, 5, 300)
    first = np.stack([np.sin(t), -np.cos(t), 0 * t], axis=1)
    second = first + np.stack([2 * np.sin(t**2), -2 * np.cos(t**2), 0 * t], axis=1)
    free = np.stack([t, t, t], axis=1)
    particles = [Element("particle", name, place, mass=1.0) for name, place in (("second", second), ("free", free), ("first", first))]
    links = {(link.start.element, link.end.element, link.kind) for link in links_of(particles, [])}
    assert links == {(None, 2, "rod"), (0, 2, "rod")}
    springs = [Element("particle", f"mass[{i}]", free * i, mass=1.0) for i in (1, 2, 3)]
    assert [(link.start.element, link.end.element, link.kind) for link in links_of(springs, [])] == [(0, 1, "line"), (1, 2, "line")]


def test_boxes_of_bodies_in_space():
    """Uniform boxes have the moments m (b^2 + c^2)/12, along any axes."""
    sides = np.array([0.3, 0.7, 1.1])
    moments = 4.0 / 12 * (np.sum(sides**2) - sides**2)
    turn = Rotation.from_euler("xyz", [0.3, -1.2, 2.0]).as_matrix()
    found, axes = box_of(Element("body", "brick", np.zeros((2, 3)), mass=4.0, inertia=turn @ np.diag(moments) @ turn.T), None)
    assert np.linalg.det(axes) == pytest.approx(1.0) and sorted(found) == pytest.approx(sides)
    for side, axis in zip(found, axes.T):
        expected = turn[:, list(sides).index(pytest.approx(side))]
        assert abs(axis @ expected) == pytest.approx(1.0)


def test_quaternions():
    """Of turns through a half, too, without a leap from one to the next."""
    turns = Rotation.from_rotvec(np.linspace(-7, 7, 400)[:, None] * np.array([0.36, 0.48, 0.8]))
    found = quaternions(turns.as_matrix())
    assert abs(np.sum(found * turns.as_quat(scalar_first=True), axis=1)) == pytest.approx(1.0)
    assert np.min(np.sum(found[1:] * found[:-1], axis=1)) > 0.99


@pytest.mark.parametrize("formula, expected", [
    ("rho*a^3/12", 2.5 * -0.5**3 / 12),
    ("-a^2", -0.25),
    ("2*motor.J[1] + sqrt(rho)", 0.02 + math.sqrt(2.5)),
    ("1e-5*max(rho, 3)", 3e-5),
    ("sign(a)*abs(a)", -0.5),
    ("unknown(rho)", math.nan),
    ("rho/(a + 0.5)", math.nan),
    ("rho*b", math.nan),
    ("rho + rho + ...", math.nan),
])  # fmt: skip
def test_formulas(formula, expected):
    assert value_of(formula, {"rho": 2.5, "a": -0.5, "motor.J[1]": 0.01}) == pytest.approx(expected, nan_ok=True)


def test_functions_of_formulas():
    functions = [line.split()[1] for line in fmu.lagc("--words").stdout.splitlines() if line.startswith("function")]
    values = {name: value_of(f"{name}(1)", {}) for name in functions} | {name: value_of(f"{name}(1, 2)", {}) for name in ("pow", "atan2", "min", "max")}
    assert {name for name, value in values.items() if math.isnan(value)} == {"der", "sum", "if", "and", "or", "atanh"}


def test_the_compiler_tells_what_there_is():
    elements = [element for element in read_scene(fmu.archive("FourBar")) if element.tag == "body"]
    bodies = [(element.tag, element.get("name"), element.get("mass"), element.get("inertia")) for element in elements]
    values = {"rho": 2.0, "a": 0.3, "b": 0.8, "c": 0.6}
    assert [body[:2] for body in bodies] == [("body", "crank"), ("body", "coupler"), ("body", "rocker")]
    assert [value_of(body[2], values) for body in bodies] == pytest.approx([0.6, 1.6, 1.2])
    assert [value_of(body[3], values) for body in bodies] == pytest.approx([2 * length**3 / 12 for length in (0.3, 0.8, 0.6)])


def test_nothing_to_draw(tmp_path):
    text, printed = run(tmp_path, "Motor")
    assert text is None and "animation  none, since the system has no particles" in printed


def spiral(count, times):
    """Particles in space."""
    description = SimpleNamespace(modelName="Spiral", description="Many <particles> & more")
    place = lambda i: np.stack([np.cos(times + i), np.sin(times + i), 0.01 * times * i], axis=1)
    return description, [Element("particle", f"p[{i}]", place(i), mass=1.0 + i) for i in range(count)]


def test_size_of_the_page():
    times = np.linspace(0, 300, 6001)
    description, particles = spiral(300, times)
    data = scene_data(description, particles, times)
    text = page(description, data)
    assert len(text) < 2e6 and scene_in(text) == data
    assert "<h1>Many &lt;particles&gt; &amp; more</h1>" in text
    assert data["speed"] == 30.0 and data["times"][-1] == 300.0


def test_a_view_of_space():
    """The picture of a pinhole: a point is as far from the middle as its tangents say. The camera turns about the middle."""
    times = np.linspace(0, 10, 101)
    description, particles = spiral(2, times)
    data = scene_data(description, particles, times)
    assert data["view"]["plane"] is None
    browser = Browser(page(description, data))
    for time in (0.0, 5.0, 10.0):
        balls = circles(browser.to(time))
        assert len(balls) >= 2 and all(0 <= x <= 800 and 0 <= y <= 600 for x, y, _ in balls)
    browser.do('document.getElementById("picture").listeners.pointerdown({ clientX: 10, clientY: 10 })')
    browser.do('document.getElementById("picture").listeners.pointermove({ clientX: 40, clientY: 90 })')
    browser.do('document.getElementById("picture").listeners.wheel({ deltaY: 300, preventDefault() {} })')
    drawn, camera = browser.to(5.0), browser.eval("camera")
    assert camera["azimuth"] == pytest.approx(-1.4) and camera["elevation"] == pytest.approx(1.15)
    # SciPy's turn: the x axis of the picture to the right, y upwards, z towards the eye.
    turn = Rotation.from_euler("ZX", [camera["azimuth"] + math.pi / 2, math.pi / 2 - camera["elevation"]]).as_matrix()
    for particle in particles:
        right, up, towards = (particle.position[50] - camera["centre"]) @ turn
        scale = camera["zoom"] * camera["distance"] / (camera["distance"] - towards)
        expected = [400 + right * scale, 300 - up * scale]
        assert any(np.allclose(circle[:2], expected, atol=0.05) for circle in circles(drawn))


ARM = """<system name="SceneArm">
  <parameter name="l" start="0.5" unit="m"/><parameter name="m" start="2" unit="kg"/>
  <parameter name="a" start="0.3" unit="m"/><parameter name="g" start="9.81" unit="m/s2"/>
  <coordinate name="q" velocity="v" unit="rad" velocityStart="2"/>
  <coordinate name="s" velocity="vs" unit="m" start="0.3"/>
  <frame name="column"><rotate axis="y" angle="q"/></frame>
  <frame name="slide" in="column"><translate x="s"/><rotate axis="x" angle="pi/2"/></frame>
  <body name="arm" in="column" mass="m" x="l/2" Iyy="m*l^2/12" Izz="m*l^2/12"/>
  <body name="block" in="slide" mass="m" Ixx="m*a^2/6" Iyy="m*a^2/6" Izz="m*a^2/6"/>
  <particle name="load" in="slide" mass="m/3" z="0.1"/>
  <point name="tip" in="column" x="l"/>
  <gravity y="-g"/>
  <experiment stopTime="3" stepSize="0.01"/>
</system>"""


@pytest.fixture(scope="module")
def arm():
    fmu.build_systems("animation", {"SceneArm": ARM})
    return fmu.unpacked("SceneArm")


def test_frames(arm, tmp_path_factory):
    """An arm that turns about the upward y axis, and a block that slides along it with a load above, where z of the slide points down."""
    text, _ = run(tmp_path_factory.mktemp("arm"), "SceneArm", "l=0.7")
    scene, browser = scene_in(text), Browser(text)
    assert scene["view"]["plane"] is None and scene["view"]["up"] == [0, 1, 0]
    of = {element["name"]: i for i, element in enumerate(scene["elements"])}
    assert [(e["kind"], e["name"]) for e in scene["elements"]] == [
        ("frame", "column"), ("frame", "slide"), ("body", "arm"), ("body", "block"), ("particle", "load"), ("point", "tip")]  # fmt: skip
    assert sorted(scene["elements"][of["arm"]]["sides"]) == pytest.approx([0.028, 0.028, 0.7], abs=1e-4)
    # A cube has m a^2/6.
    assert scene["elements"][of["block"]]["sides"] == pytest.approx([0.3] * 3, abs=1e-4)
    links = {(link["from"][0], link["to"][0]): link["kind"] for link in scene["links"]}
    assert links == {(of["column"], of["arm"]): "rod", (of["column"], of["tip"]): "rod", (of["slide"], of["block"]): "rod",
                     (of["slide"], of["load"]): "rod", (of["column"], of["slide"]): "line", (-1, of["column"]): "rod"}  # fmt: skip
    for k in (0, 100, 250):
        tip, slide, load = (np.array(browser.eval(f"positionOf(scene.elements[{of[name]}], {k})")) for name in ("tip", "slide", "load"))
        assert np.linalg.norm(tip) == pytest.approx(0.7, abs=1e-4) and np.cross(tip, slide) == pytest.approx(np.zeros(3), abs=1e-4)
        assert load - slide == pytest.approx([0, -0.1, 0], abs=1e-4)
        along, down = (np.array(browser.eval(f"turned(turnOf(scene, scene.elements[{of['slide']}], {k}), {axis})")) for axis in ([1, 0, 0], [0, 0, 1]))
        assert along == pytest.approx(tip / 0.7, abs=2e-4) and down == pytest.approx([0, -1, 0], abs=1e-4)
        corners = np.array(browser.eval(f"boxOf(scene, scene.elements[{of['arm']}], {k}).flatMap((face) => face.corners)"))
        assert np.max(corners @ tip) / 0.7 == pytest.approx(0.7, abs=2e-3) and np.min(corners @ tip) / 0.7 == pytest.approx(0, abs=2e-3)
    # Upwards is up in the picture, whatever the view.
    browser.do('document.getElementById("picture").listeners.pointerdown({ clientX: 0, clientY: 0 })')
    browser.do('document.getElementById("picture").listeners.pointermove({ clientX: 100, clientY: -20 })')
    browser.frame(0.1)
    low, high = browser.eval("[project(camera, [0, 0, 0]), project(camera, [0, 0.1, 0])]")
    assert high[0] == pytest.approx(low[0], abs=2.0) and high[1] < low[1] - 10
