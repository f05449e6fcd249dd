"""The page that animates the simulation of scripts/run, in headless Chromium: positions agree with closed forms."""

import math
import re
import subprocess
import sys

import numpy as np
import pytest

import fmu
from closed_forms import pendulum_angle
from fmu import ROOT
from driven_chromium import COLORS_SEEN, chromium, opened
from scripts.library.live_page.page import page_of_motion
from scripts.library.simulation import simulate, write_results

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

# JavaScript: the pose of an object in the scene, a matrix by columns.
MATRIX = "name => live.scene.objects[live.scene.byName.get(name)].matrix.elements"


@pytest.fixture(scope="module")
def browser():
    with chromium() as browser:
        yield browser


@pytest.fixture(scope="module")
def arm():
    fmu.build_systems("animation", {"SceneArm": ARM}, versions=(2, 3))


def at(page, sample):
    """Move the slider to a sample, wait for its picture, and return its time."""
    page.evaluate("place => { const bar = document.getElementById('timeline'); bar.value = place; bar.dispatchEvent(new Event('input')); }", sample)
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return page.evaluate("place => live.history.time(place)", sample)


def position_of(page, name):
    return np.array(page.evaluate(MATRIX, name))[12:15]


def axes_of(page, name):
    return np.array(page.evaluate(MATRIX, name)).reshape(4, 4)[:3, :3]  # one row per axis


def paused(page):
    page.click("#play")
    assert page.inner_text("#play") == "Play"


def test_a_pendulum(browser, tmp_path):
    """
    scripts/commands/run.py writes a page that shows the bob and its rod at any time, whatever was recorded. It plays from the start, and loads
    nothing from elsewhere.
    """
    words = [sys.executable, ROOT / "scripts" / "commands" / "run.py", fmu.archive("SimplePendulum"), "theta=2", "l=0.5"]
    printed = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path, check=True).stdout
    assert re.search(r"^animation +/.*/build/results/SimplePendulum-motion\.html$", printed, re.M)
    file = tmp_path / "build" / "results" / "SimplePendulum-motion.html"
    fetched = []
    browser.on("page", lambda page: page.on("request", lambda request: fetched.append(request.url)))
    with opened(browser, file) as page:
        page.wait_for_function("Number(document.getElementById('clock').textContent.slice(0, -2)) > 0.3")
        assert page.evaluate("live.history.length") == 1001 and page.evaluate("live.scene.plane") == [0, 1]
        paused(page)
        for sample in (0, 33, 425, 1000):
            time = at(page, sample)
            theta = pendulum_angle(2.0, math.sqrt(9.81 / 0.5), time)
            bob = position_of(page, "bob")
            assert bob == pytest.approx([0.5 * math.sin(theta), -0.5 * math.cos(theta), 0.0], abs=1e-6), time
            rod = np.array(page.evaluate("live.scene.lines[1].group.matrix.elements")).reshape(4, 4)
            assert rod[3, :3] == pytest.approx(np.zeros(3)) and rod[1, :3] == pytest.approx(bob / 0.5, abs=1e-6)
            assert page.evaluate("live.scene.lines[1].stretched[0].scale.y") == pytest.approx(0.5, rel=1e-6)
        page.click("#back")
        assert page.input_value("#timeline") == "999"
        page.click("#reset")
        assert page.input_value("#timeline") == "0"
        assert page.evaluate(COLORS_SEEN) > 3
    assert all(url.startswith(("file:", "blob:")) for url in fetched)


@pytest.mark.parametrize("version", [2, 3])
def test_frames(browser, arm, tmp_path, version):
    """
    An arm that rotates about the upward y axis, a block that slides along it, and a load above it, in a frame whose z points down. Both versions of
    FMI are tested.
    """
    path = fmu.BUILD / "animation" / ("fmu" if version == 2 else "fmi3") / "SceneArm.fmu"
    written = write_results(simulate(path, {"l": 0.7}), tmp_path)
    with opened(browser, written["animation"]) as page:
        paused(page)
        assert page.evaluate("live.scene.plane") is None and page.evaluate("live.scene.up") == [0, 1, 0]
        for sample in (0, 100, 250):
            at(page, sample)
            tip, slide, load, block = (position_of(page, name) for name in ("tip", "slide", "load", "block"))
            assert np.linalg.norm(tip) == pytest.approx(0.7, abs=1e-6) and np.cross(tip, slide) == pytest.approx(np.zeros(3), abs=1e-6)
            assert load - slide == pytest.approx([0, -0.1, 0], abs=1e-6) and block == pytest.approx(slide, abs=1e-6)
            along, _, down = axes_of(page, "slide")
            assert along == pytest.approx(tip / 0.7, abs=1e-6) and down == pytest.approx([0, -1, 0], abs=1e-6)
            assert axes_of(page, "arm")[0] == pytest.approx(tip / 0.7, abs=1e-6)
        # A slender rod of the new length has m l^2/12; a ball has 2/5 m r^2, the block m a^2/6.
        arm, block = page.evaluate("live.scene.solids.filter(Boolean)")
        assert (arm["kind"], block["kind"]) == ("cylinder", "ball") and arm["length"] == pytest.approx(0.7, rel=1e-6)
        assert 0.4 * block["radius"] ** 2 == pytest.approx(0.3**2 / 6, rel=1e-6)


def test_formulas(browser, arm, tmp_path):
    """
    Masses and moments in the scene are formulas of parameters. The page evaluates all functions of the language, and no unknown names.
    """
    functions = [line.split()[1] for line in fmu.lagc("--words").stdout.splitlines() if line.startswith("function")]
    file = tmp_path / "page.html"
    motion = simulate(fmu.archive("SceneArm"), {}, stop_time=0.1)
    file.write_text(page_of_motion(motion.tree, motion.values, motion.start))
    with opened(browser, file) as page:
        value = lambda formula: page.evaluate("formula => live.valueOf(formula)", formula)  # noqa: E731
        known = {name: value(f"{name}({'1, 2' if name in ('pow', 'atan2', 'min', 'max') else '1'})") for name in functions}
        forms = {"der", "sum", "if", "and", "or", "not", "diff", "integral"}  # and have other forms in scenes
        assert {name for name, number in known.items() if number is None or math.isnan(number)} == forms | {"round", "mod", "gauss", "uniform"}
        assert known["atanh"] == math.inf and known["atan2"] == pytest.approx(math.atan2(1, 2))
        assert value("m*l^2/12 + 1e-3") == pytest.approx(2 * 0.25 / 12 + 1e-3) and value("-a^2") == pytest.approx(-0.09)
        assert value("l*-a^2 + a^-2 - (-l)^2") == pytest.approx(0.5 * -0.09 + 0.3**-2 - 0.25)
        assert value("q + 1") is None or math.isnan(value("nothing + 1"))


def test_drawn_lines(browser, tmp_path):
    """
    Ends of lines follow coordinates, parameters, inputs and time, as recorded. The lines are the pivot on its circle, the hinge of the rocker, the
    cart's wheel, and the arrow of the force on the cart.
    """
    ends = "k => live.scene.lines.map((line) => line.at(live.history.samples[k][0], live.history.time(k)).map((end) => end.toArray()))"
    for name, start in (("RotatingPivotPendulum", {"r": 0.3, "w": 5.0}), ("FourBar", {"c": 0.7}), ("InvertedPendulumCart", {"F": 2.0})):
        motion = simulate(fmu.archive(name), start, stop_time=0.4)
        file = tmp_path / f"{name}.html"
        file.write_text(page_of_motion(motion.tree, motion.values, motion.start))
        with opened(browser, file) as page:
            for k in (0, 17, 40):
                lines, row = np.array(page.evaluate(ends, k)), motion.values[k]
                if name == "RotatingPivotPendulum":
                    pivot = 0.3 * np.array([math.cos(5 * row["time"]), -math.sin(5 * row["time"]), 0])
                    bob = pivot + [math.cos(row["theta"]), math.sin(row["theta"]), 0]
                    assert lines[1] == pytest.approx(np.array([np.zeros(3), pivot])) and lines[2] == pytest.approx(np.array([pivot, bob]))
                elif name == "FourBar":
                    joint = np.array([0.9 + 0.7 * math.cos(row["psi"]), 0.7 * math.sin(row["psi"]), 0])
                    assert lines[1][1] == pytest.approx(joint) and np.hypot(*(lines[1][1] - lines[1][0])[:2]) == pytest.approx(0.8)
                else:
                    hub, rim = lines[1]
                    assert hub == pytest.approx([row["x"] + 0.1, -0.06, 0])
                    assert rim - hub == pytest.approx([0.03 * math.cos(row["x"] / 0.03), -0.03 * math.sin(row["x"] / 0.03), 0])
                    assert lines[4] == pytest.approx(np.array([[row["x"], 0, 0], [row["x"] + 0.1, 0, 0]]))


def page_of_run(folder, name, start=None, **options):
    motion = simulate(fmu.archive(name), start or {}, **options)
    file = folder / f"{name}.html"
    file.write_text(page_of_motion(motion.tree, motion.values, motion.start))
    return motion.values, file


def test_the_view_follows(browser, tmp_path):
    """
    The plate slides across the plane by many times its own length, and stays at the middle of the view below the controls. With "Follow" off it leaves the
    view. The four-bar linkage stays where it is, and so does its view.
    """
    where = "() => { const { scene } = live, tools = document.querySelector('.tools').getBoundingClientRect(), box = scene.container.getBoundingClientRect(), [x, y] = scene.pixels(scene.objects[0].position.setFromMatrixPosition(scene.objects[0].matrix)); return [x / box.width, (box.top + y - tools.bottom) / (box.bottom - tools.bottom)]; }"  # fmt: skip
    _, file = page_of_run(tmp_path, "KnifeEdge")
    with opened(browser, file) as page:
        paused(page)
        assert page.evaluate("live.scene.followedAxes") == [1]
        for sample in (0, 300, 1000):
            at(page, sample)
            assert page.evaluate(where)[1] == pytest.approx(0.5, abs=0.01)
        page.click("#follow")
        at(page, 0)
        assert abs(page.evaluate(where)[1] - 0.5) > 0.4
    _, file = page_of_run(tmp_path, "FourBar", stop_time=1.0)
    with opened(browser, file) as page:
        assert page.evaluate("live.scene.followedAxes") == [] and page.locator("#followChoice").is_hidden()


def test_values_of_arrows_and_legends(browser, tmp_path):
    """A pendulum in x and y: velocity l*omega and tension at the bob have their values. The energy, which is 0 within rounding, is shown as 0."""
    values, file = page_of_run(tmp_path, "PendulumCartesian", stop_time=2.0)
    with opened(browser, file) as page:
        paused(page)
        page.click("#velocities")
        at(page, 100)
        tension, speed = (float(text.split()[0]) for text, _ in page.evaluate("live.scene.arrows.values"))
        row = values[100]
        assert tension == pytest.approx(abs(row["rod.force"]), rel=0.01)
        # Without losses the speed follows from the height, which was 0; the arrow has the mean of the last 0.01 s.
        assert speed == pytest.approx(math.sqrt(-2 * 9.81 * (values[99]["y"] + row["y"]) / 2), rel=0.01)
        legend = page.locator(".plot", has_text="totalEnergy").locator(".legend span", has_text="totalEnergy").inner_text()
        assert legend.split()[-1] == "0" and 0 < abs(row["totalEnergy"]) < 1e-9


def test_curves_break_at_jumps(browser, tmp_path):
    """The velocity of the ball jumps where it bounces: after t1 = sqrt(2 h/g), and 2 e t1, 2 e^2 t1 later. Its height has no jumps."""
    _, file = page_of_run(tmp_path, "BouncingBall", stop_time=2.2)
    first = math.sqrt(2 / 9.81)
    bounces = [first, first * (1 + 2 * 0.8), first * (1 + 2 * 0.8 + 2 * 0.8**2)]
    jumps = """name => {
      const { history, plots, names } = live, column = names.indexOf(name), y = (k) => 30 * history.value(k, column, 0);
      return [...Array(history.length).keys()].slice(1).filter((k) => plots[0].isJump(k - 1, k, 0, history.length, 1, y)).map((k) => history.time(k));
    }"""
    with opened(browser, file) as page:
        assert page.evaluate(jumps, "v") == pytest.approx(bounces, abs=0.0101) and page.evaluate(jumps, "h") == []


def test_size(check_size):
    """Long simulations of many variables are thinned out; animations of any simulation take the same time."""
    times = np.linspace(0, 300, 60_001)
    motion = simulate(fmu.archive("DoublePendulum"), {}, stop_time=0.1)
    values = np.zeros(len(times), dtype=motion.values.dtype)
    for name in values.dtype.names:
        values[name] = np.sin(times + len(name)) if name != "time" else times
    text = page_of_motion(motion.tree, values, motion.start)
    check_size("DoublePendulum", "page that plays a long motion", len(text))
    assert '"speed":30.0' in text


@pytest.mark.long
def test_nothing_to_draw(tmp_path):
    words = [sys.executable, ROOT / "scripts" / "commands" / "run.py", fmu.archive("PidController")]
    printed = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path, check=True).stdout
    assert not list(tmp_path.rglob("*.html")) and "animation  none, since the system has no particles" in printed
