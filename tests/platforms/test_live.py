"""The page in which an FMU runs, in headless Chromium: it behaves as the FMU, and its controls change the FMU's variables."""

import contextlib
import json
import math
import re
import subprocess
from types import SimpleNamespace
from xml.etree import ElementTree

import mpmath
import numpy as np
import pytest

import fmu
from building import BUILD, LAGC, ROOT
from driven_chromium import COLORS_SEEN, browser, opened  # noqa: F401
from scripts.commands.live import origin_in
from scripts.library.live_page import wasm
from scripts.library.live_page.page import page_of
from scripts.library.simulation import settings_of

pytestmark = pytest.mark.long

PULLED = ["SimplePendulum", "DoublePendulum", "FourBar"]  # for others compiling the second module takes minutes


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    """Return a function that writes the page of a system once, and returns its file."""
    folder, written = tmp_path_factory.mktemp("live"), {}

    def write(name):
        if name not in written:
            written[name] = folder / f"{name}.html"
            origin = origin_in(BUILD, ROOT / "fmu" / name / "system.xml") if name in PULLED else None
            written[name].write_text(page_of(fmu.archive(name), origin, cache=BUILD / "wasm"), encoding="utf-8")
        return written[name]

    return write


def run_natively(name, until, factor=1.0):
    """States at that time, after steps of the experiment's length, from the start values times a factor."""
    step, states = float(fmu.description(name).defaultExperiment.stepSize), fmu.states_of(name)
    instance = fmu.Instance(name, logging=False)
    with contextlib.closing(SimpleNamespace(close=instance.free)):
        start = fmu.start_values(name)
        instance.initialize({state: start[state] * factor for state in states if start.get(state)})
        for i in range(round(until / step)):
            instance.fmu.doStep(i * step, step)
        return dict(zip(states, instance.fmu.getReal(instance.vr(*states))))


def run_in_page(page, until):
    return dict(zip(page.evaluate("live.names"), page.evaluate("async until => (await live.run(until)).values", until)))


def test_modules_are_kept(monkeypatch, tmp_path):
    """A module is compiled again if its source has changed, and the newest are kept."""
    compiled = []
    monkeypatch.setattr(wasm, "compile_to_wasm", lambda source: compiled.append(source.read_text()) or source.read_bytes())
    monkeypatch.setattr(wasm, "MOST_KEPT", 2)
    source, cache = tmp_path / "fmu.c", tmp_path / "cache"
    for text in ("one", "one", "two", "one", "three"):
        source.write_text(text)
        assert wasm.cached_wasm(source, cache) == text.encode()
    assert compiled == ["one", "two", "three"] and len(list(cache.iterdir())) == 2
    wasm.cached_wasm(source, None)
    assert compiled[3:] == ["three"] and len(list(cache.iterdir())) == 2


@pytest.mark.parametrize("name", fmu.moving_names())
def test_the_page_is_the_fmu(browser, page_file, name):
    """
    The states after 10 s, or before the bars lie flat, where they could fold, are those of the native FMU. C libraries may differ in the last place
    of a sine. In a chaotic system each step amplifies that at most as it amplifies rounding of the start values. A method whose steps depend on it
    differs by a fraction of the tolerance. The scene is not empty.
    """
    end = 0.7 if name == "NFourBar" else 10.0
    expected, *nudged = (run_natively(name, end, factor) for factor in (1.0, 1.0 - 2.0**-52, 1.0 + 2.0**-52))
    experiment = fmu.description(name).defaultExperiment
    steps, allowed = end / float(experiment.stepSize), 1e-2 * float(experiment.tolerance)
    with opened(browser, page_file(name)) as page:
        found = run_in_page(page, end)
        if page.evaluate("Boolean(live.scene)"):
            page.wait_for_function(f"({COLORS_SEEN})() > 3", timeout=20000)
    size = max(1.0, *map(abs, expected.values()))
    chaos = steps * max(abs(states[state] - expected[state]) for states in nudged for state in expected) / size
    for state, value in expected.items():
        assert found[state] == pytest.approx(value, rel=1e-12, abs=(1e-12 + chaos + allowed) * size), state


def test_sliders(browser, page_file):
    """
    A longer pendulum from another angle, by number field and slider, equals the native FMU with these values. An invalid value gives the
    reason in place, and the field shows the valid value. A reset keeps these messages, whether it comes from the page, some time after a
    start value, or from the user.
    """
    with opened(browser, page_file("DoublePendulum")) as page:
        page.get_by_role("spinbutton", name="theta1").fill("1")
        page.get_by_role("spinbutton", name="theta1").press("Enter")
        page.get_by_role("slider", name="l1").fill("1000")
        assert page.get_by_role("spinbutton", name="l1").input_value() == "10"
        page.get_by_role("spinbutton", name="m1").fill("-1")
        page.get_by_role("spinbutton", name="m1").press("Enter")
        page.click("#reset")
        found = run_in_page(page, 2.0)
        assert page.inner_text(".control .message:not(:empty)") == "-1 for 'm1' is below its minimum, 0"
        assert page.get_by_role("spinbutton", name="m1").input_value() == "1"
        page.get_by_role("spinbutton", name="m1").fill("2")
        page.get_by_role("spinbutton", name="m1").press("Enter")
        page.wait_for_selector(".control .message:not(:empty)", state="detached")
    instance = fmu.Instance("DoublePendulum", logging=False)
    with contextlib.closing(SimpleNamespace(close=instance.free)):
        instance.initialize({"theta1": 1.0, "l1": 10.0})
        instance.run(2.0, 0.01)
        for state in fmu.states_of("DoublePendulum"):
            assert found[state] == pytest.approx(instance.get(state), rel=1e-10)


def test_steps_back_and_settings(browser, page_file):
    """A step back restores the previous state; the address contains values; nothing moves before it plays, at the chosen speed."""
    clock = "Number(document.getElementById('clock').textContent.slice(0, -2))"
    with opened(browser, page_file("DoublePendulum"), "#theta1=0.5&g=3") as page:
        start = page.evaluate("[...live.history.samples[0][0]]")
        values = dict(zip(page.evaluate("live.names"), start))
        assert (values["theta1"], values["der(omega2)"]) == (0.5, pytest.approx(run_start("DoublePendulum", {"theta1": 0.5, "g": 3.0}, "der(omega2)")))
        for _ in range(3):
            page.click("#step")
        page.wait_for_function(f"{clock} > 0.02")
        for _ in range(3):
            page.click("#back")
        page.wait_for_function(f"{clock} === 0")
        assert page.evaluate("[...live.history.samples[0][0]]") == start
        page.click("#play")
        page.wait_for_function(f"{clock} > 0.5")
        assert page.inner_text("#play") == "Pause"


def test_a_page_begins_with_values(browser, tmp_path):
    """Values given with the page apply at its start; the address has precedence."""
    file = tmp_path / "page.html"
    file.write_text(page_of(fmu.archive("SimplePendulum"), settings=settings_of(fmu.archive("SimplePendulum"), {"theta": "30deg", "l": "20cm"}), cache=BUILD / "wasm"), encoding="utf-8")
    for address, l in (("", 0.2), ("#l=0.4", 0.4)):
        with opened(browser, file, address) as page:
            values = dict(zip(page.evaluate("live.names"), page.evaluate("[...live.history.samples[0][0]]")))
            assert values["theta"] == pytest.approx(math.pi / 6, rel=1e-15)
            assert values["der(omega)"] == pytest.approx(-9.81 / l / 2, rel=1e-12)


def run_start(name, values, variable):
    instance = fmu.Instance(name, logging=False)
    with contextlib.closing(SimpleNamespace(close=instance.free)):
        return instance.initialize(values).get(variable)


def test_lengths_change(browser, page_file):
    """Rods of a linkage that change their length still meet at the joints; those on the base stay in place."""
    joints = """() => {
      const sample = live.history.samples[live.history.length - 1][0], { scene } = live, place = (joint) => scene.jointPosition(sample, joint, new THREE.Vector3()).toArray();
      return scene.connections.filter((joint) => joint.withX !== undefined).map((joint) => {
        const other = [joint.withX, joint.withY].map((formula) => live.valueOf(formula));
        return [place(joint), joint.with ? place({ of: joint.with, position: other }) : [...other, 0]];
      });
    }"""
    with opened(browser, page_file("FourBar")) as page:
        for name, value in (("a", "0.25"), ("c", "0.7"), ("b", "0.8")):
            page.get_by_role("spinbutton", name=name, exact=True).fill(value)
            page.get_by_role("spinbutton", name=name, exact=True).press("Enter")
        page.click("#reset")
        page.wait_for_function("live.scene.connections.some((joint) => joint.position && Math.abs(joint.position[0]) === 0.35)")
        page.click("#step")
        found = page.evaluate(joints)
        assert len(found) == 4
        for here, there in found:
            assert here == pytest.approx(there, abs=1e-6)
        assert sum(abs(here[0] - 0.9) < 1e-6 and abs(here[1]) < 1e-6 for here, _ in found) == 1


SEEN_AT = """name => {
  const { scene, history } = live, box = scene.renderer.domElement.getBoundingClientRect();
  const seen = scene.position(history.samples[history.length - 1][0], scene.byName.get(name)).project(scene.camera);
  return [box.left + ((seen.x + 1) * box.width) / 2, box.top + ((1 - seen.y) * box.height) / 2];
}"""
# For two seconds, since an oscillating motion has no speed at its turning points.
AT_REST = """() => {
  const { history } = live, energy = live.names.indexOf("kineticEnergy"), last = history.length - 1;
  for (let k = last; k > 0; k--) {
    if (history.samples[k][0][energy] >= 1e-11) return false;
    if (history.time(last) - history.time(k) > 2) return true;
  }
  return false;
}"""
LAST = "[...live.history.samples[live.history.length - 1][0]]"


def pull(page, name, off, by):
    """Grasp a body at an offset in pixels from its position, pull it, and wait for rest; return the variables and the pull."""
    x, y = page.evaluate(SEEN_AT, name)
    page.mouse.move(x + off[0], y + off[1])
    page.mouse.down()
    page.mouse.move(x + off[0] + by[0], y + off[1] + by[1], steps=4)
    page.fill("#speed", "0.6")
    page.wait_for_function(AT_REST, timeout=60000)
    return SimpleNamespace(**dict(zip(page.evaluate("live.names"), page.evaluate(LAST)))), page.evaluate("live.pulled")


def test_pulling_a_particle(browser, page_file):
    """
    Pulled by the spring to the pointer, the bob rests where the moments of spring and weight about the pivot balance. Released and started
    again, the system equals the original FMU, to the last bit if it does so without any pull.
    """
    with opened(browser, page_file("SimplePendulum")) as page:
        before = run_in_page(page, 2.0)
        page.click("#reset")
        page.wait_for_function("live.history.length === 1 && live.history.time(0) === 0")  # otherwise the bob is not yet where it is grasped
        at, pulled = pull(page, "bob", (0, 0), (90, -50))
        (x, y, _, *offset), stiffness = pulled["pointer"][:6], pulled["stiffness"]
        along = (math.cos(at.theta), math.sin(at.theta))
        moment = stiffness * ((x - math.sin(at.theta)) * along[0] + (y + math.cos(at.theta)) * along[1])
        assert offset == [0, 0, 0] and abs(moment) > 1
        assert moment == pytest.approx(9.81 * math.sin(at.theta), rel=1e-4)
        page.mouse.up()
        page.wait_for_function("live.pulled === null")
        page.click("#play")
        page.click("#reset")
        assert run_in_page(page, 2.0) == before


def test_pulling_a_point_of_a_body(browser, page_file):
    """
    A linkage pulled beside the middle of its coupler rests where no admissible motion changes the energy of weights and spring. The motion follows
    from the loop's equations by hand.
    """
    with opened(browser, page_file("FourBar")) as page:
        phi = page.evaluate(f"{LAST}[live.names.indexOf('phi')]")
        at, pulled = pull(page, "coupler", (60 * math.cos(phi), -60 * math.sin(phi)), (-60, -50))
    (x, y, _, u, v, _, _), stiffness = pulled["pointer"], pulled["stiffness"]
    assert math.hypot(u, v) > 0.05
    a, b, c, rho, g = 0.3, 0.8, 0.6, 2.0, 9.81
    # d/dt of a cos theta + b cos phi - c cos psi = d and of the sines, for theta_dot = 1, by Cramer's rule.
    turning = a / math.sin(at.psi - at.phi)
    phi_dot, psi_dot = turning * math.sin(at.theta - at.psi) / b, turning * math.sin(at.theta - at.phi) / c
    middle = (a * math.cos(at.theta) + b / 2 * math.cos(at.phi), a * math.sin(at.theta) + b / 2 * math.sin(at.phi))
    lever = (u * math.cos(at.phi) - v * math.sin(at.phi), u * math.sin(at.phi) + v * math.cos(at.phi))
    moves = (-a * math.sin(at.theta) - b / 2 * math.sin(at.phi) * phi_dot, a * math.cos(at.theta) + b / 2 * math.cos(at.phi) * phi_dot)
    point_moves = (moves[0] - lever[1] * phi_dot, moves[1] + lever[0] * phi_dot)
    weights = -rho * g * (a * a / 2 * math.cos(at.theta) + b * moves[1] + c * c / 2 * math.cos(at.psi) * psi_dot)
    spring = stiffness * sum((pointer - place - off) * speed for pointer, place, off, speed in zip((x, y), middle, lever, point_moves))
    assert abs(weights) > 1
    assert spring == pytest.approx(-weights, rel=1e-4)


def test_equations_and_system(browser, page_file, tmp_path):
    """The equations are those of the FMU's documentation; the saved system contains the set values, and lagc reads it."""
    with opened(browser, page_file("DoublePendulum")) as page:
        page.click("#equations")
        assert page.frame_locator("#equationsShown iframe").locator("math").first.text_content(timeout=10000)
        page.click("#equationsShown button")
        for name, value in (("l1", "1.25"), ("theta2", "-0.5"), ("omega1", "3")):
            page.get_by_role("spinbutton", name=name, exact=True).fill(value)
            page.get_by_role("spinbutton", name=name, exact=True).press("Enter")
        with page.expect_download() as download:
            page.click("#system")
        assert download.value.suggested_filename == "DoublePendulum.xml"
        download.value.save_as(tmp_path / "system.xml")
    subprocess.run([LAGC, tmp_path / "system.xml", "-o", tmp_path / "derived"], check=True)

    def starts(file):
        variables = ElementTree.parse(file).iterfind("ModelVariables/ScalarVariable")
        return {variable.get("name"): variable[0].get("start") for variable in variables if variable[0].get("start")}

    expected = starts(BUILD / "systems" / "DoublePendulum" / "modelDescription.xml") | {"l1": "1.25", "theta2": "-0.5", "omega1": "3"}
    assert starts(tmp_path / "derived" / "modelDescription.xml") == expected


def test_presentation(browser, page_file):
    """The key F shows the values of the last sample and the equations in large type; F again ends it."""
    with opened(browser, page_file("DoublePendulum")) as page:
        page.evaluate("live.run(2)")
        page.wait_for_function("live.history.length > 1")
        page.click("#fit")  # a button has the focus
        page.keyboard.press("f")
        page.frame_locator("#presentation iframe").locator("math").first.wait_for()
        assert page.locator("#controls, #plots, footer").evaluate_all("nodes => nodes.every(node => getComputedStyle(node).display === 'none')")
        assert page.evaluate("getComputedStyle(document.body).fontSize") == "24px" and page.locator("#speed").is_visible()
        sources = page.frame_locator("#presentation iframe").locator("summary", has_text="LaTeX")
        assert sources.count() > 0 and not any(source.is_visible() for source in sources.all())
        page.wait_for_function("document.querySelector('#presentation td:nth-child(2)').textContent !== ''")
        rows = page.locator("#presentation tr").evaluate_all("rows => rows.map(row => [...row.children].map(cell => cell.textContent))")
        values = dict(zip(page.evaluate("live.names"), page.evaluate("Array.from(live.history.samples.at(-1)[0])")))
        assert [row[0] for row in rows] == ["theta1", "theta2", "omega1", "omega2"] and rows[0][2] == "rad"
        assert [float(row[1].replace("\u2212", "-")) for row in rows] == pytest.approx([values[row[0]] for row in rows], rel=1e-3)
        page.keyboard.press("f")
        page.wait_for_function("!document.body.classList.contains('presented') && getComputedStyle(document.querySelector('footer')).display === 'flex'")


def test_escape_ends_a_presentation_in_a_frame(browser, page_file):
    """A frame may not use the whole screen. There Escape ends the presentation, too."""
    with opened(browser, page_file("DoublePendulum")) as page:
        page.evaluate("() => { document.documentElement.requestFullscreen = () => Promise.reject(new TypeError()); }")
        page.keyboard.press("f")
        page.wait_for_function("document.body.classList.contains('presented')")
        page.keyboard.press("Escape")
        page.wait_for_function("!document.body.classList.contains('presented')")


def test_presets(browser, page_file):
    """A button sets its values and restarts; the next one resets everything else."""
    with opened(browser, page_file("SimplePendulum")) as page:
        values = lambda: dict(zip(page.evaluate("live.names"), page.evaluate("Array.from(live.history.samples.at(-1)[0])")))
        page.evaluate("live.run(0.5)")
        for words, theta, omega in (("Release it near the top", 3.1, 0), ("Over the top, again and again", 0, 10), ("start values of the file", 1, 0)):
            page.click(f"text={words}")
            page.wait_for_function("([theta, omega, i, k]) => live.history.length === 1 && live.history.samples[0][0][i] === theta && live.history.samples[0][0][k] === omega",
                                   arg=[theta, omega, page.evaluate("live.names.indexOf('theta')"), page.evaluate("live.names.indexOf('omega')")])  # fmt: skip
            assert values()["theta"] == theta


def test_energy_bar(browser, page_file):
    """
    Kinetic energy and potential energy above its least value in the experiment, which is close to -3 g, as shares of their largest sum. The sum is
    constant here, also at the start. A parameter changes both.
    """
    start = 3 * 9.81 * -np.cos(2.0)
    numbers = lambda: [float(text.removesuffix(" J")) for text in page.locator("#energies b").all_inner_texts()]
    with opened(browser, page_file("DoublePendulum")) as page:
        low = page.evaluate("live.energyBar.low")
        assert -3 * 9.81 <= low < -27 and numbers() == pytest.approx([0, start - low, start - low], rel=5e-3)
        assert page.locator("#energies .bar i").evaluate_all("parts => parts.map(part => part.style.width)") == ["0%", "100%"]
        page.click("#play")
        page.wait_for_function("live.history.length > 100")
        page.click("#play")
        page.wait_for_timeout(300)
        names, samples = page.evaluate("live.names"), np.array(page.evaluate("live.history.samples.map(([run]) => Array.from(run))"))
        kinetic, potential = (samples[:, names.index(f"{kind}Energy")] for kind in ("kinetic", "potential"))
        widths = page.locator("#energies .bar i").evaluate_all("parts => parts.map(part => parseFloat(part.style.width))")
        above = potential[-1] - min(low, page.evaluate("live.energyBar.low"))
        assert widths[0] / widths[1] == pytest.approx(kinetic[-1] / above, rel=1e-3) and sum(widths) == pytest.approx(100, abs=0.1)
        assert numbers() == pytest.approx([kinetic[-1], above, kinetic[-1] + above], rel=5e-3)
        scene, bar = page.locator("#scene").bounding_box(), page.locator("#energies").bounding_box()
        assert scene["y"] + scene["height"] <= bar["y"] + 1
        assert page.locator("#scene").get_attribute("aria-label") == "Two point masses on two massless rods, as it moves"
        page.get_by_role("spinbutton", name="g", exact=True).fill("0.1")
        page.get_by_role("spinbutton", name="g", exact=True).press("Enter")
        page.wait_for_function("live.energyBar.low > -0.31")


def test_the_link(browser, page_file):
    """A link contains changed values and the ghost, and the page says that it is copied. The address of a file is of no use to others."""
    with opened(browser, page_file("DoublePendulum"), "#theta1=0.5&ghost=near") as page:
        page.wait_for_function("live.history.runs === 2")
        assert page.input_value("#ghost") == "near"
        page.click("#link")
        page.wait_for_function("document.getElementById('linked').textContent === 'send the file of this page'")
    with contextlib.closing(browser.new_context(permissions=["clipboard-read", "clipboard-write"])) as context:
        page = context.new_page()
        page.route("https://pages.test/**", lambda route: route.fulfill(path=page_file("DoublePendulum"), content_type="text/html"))
        page.goto("https://pages.test/page.html#theta1=0.5&ghost=near")
        page.wait_for_selector("body[data-ready]", timeout=60000)
        page.click("#link")
        page.wait_for_function("document.getElementById('linked').textContent === 'copied'")
        assert page.evaluate("navigator.clipboard.readText()") == "https://pages.test/page.html#theta1=0.5&ghost=near"


def test_a_section(browser, page_file):
    """A point at the end of each period, to the step; for an undamped pendulum's own period all points coincide."""
    with opened(browser, page_file("SimplePendulum"), "#b=0&theta=1") as page:
        # T = 4 K(sin(theta/2)) sqrt(l/g), by the arithmetic-geometric mean: 2 pi sqrt(l/g)/agm(1, cos(theta/2)).
        period = 2 * math.pi * math.sqrt(page.evaluate("live.valueOf('l/g')")) / float(mpmath.agm(1, math.cos(0.5)))
        page.fill("#period", str(period))
        page.press("#period", "Enter")
        page.fill("#speed", "1.3")
        page.click("#play")
        page.wait_for_function("live.sections.length >= 5")
        page.click("#play")
        places = [page.evaluate("live.names").index(name) for name in ("theta", "omega")]
        times, points = page.evaluate("[live.sections.times, live.sections.samples.map(runs => [...runs[0]])]")
        assert times == pytest.approx([period * (k + 1) for k in range(len(times))], rel=1e-12)
        for point in points:
            assert [point[place] for place in places] == pytest.approx([1, 0], abs=1e-7)


def test_a_game_pad(browser, page_file):
    """The stick sets the first input to a fraction of its range, and to its start value when released."""
    with opened(browser, page_file("InvertedPendulumCart")) as page:
        lean = "lean => (navigator.getGamepads = () => [null, { axes: [lean, 0.05] }])"
        force = page.get_by_role("spinbutton", name="F", exact=True)
        largest = page.evaluate("() => live.rangeOf('F')")[1]
        page.evaluate(lean, 0.5)
        page.wait_for_function("live.valueOf('F') > 0")
        assert float(force.input_value()) == pytest.approx(0.5 * largest)
        page.evaluate(lean, -1)
        page.wait_for_function("live.valueOf('F') < 0")
        page.evaluate(lean, 0.01)
        page.wait_for_function("live.valueOf('F') === 0")


def test_a_video(browser, page_file, tmp_path):
    """The motion between two clicks is saved as a WebM file."""
    with opened(browser, page_file("DoublePendulum")) as page:
        page.click("#play")
        page.click("#video")
        page.wait_for_timeout(1500)
        with page.expect_download() as download:
            page.click("#video")
        download.value.save_as(tmp_path / "video.webm")
        content = (tmp_path / "video.webm").read_bytes()
        assert download.value.suggested_filename == "DoublePendulum.webm"
        assert content[:4] == b"\x1a\x45\xdf\xa3" and b"webm" in content[:64] and len(content) > 5000
        assert page.inner_text("#video") == "Video"


def test_a_ghost(browser, page_file):
    """A second run starts 1e-9 away from the first; parameters are set in both."""
    with opened(browser, page_file("DoublePendulum")) as page:
        page.select_option("#ghost", "near")
        page.wait_for_function("live.history.runs === 2")
        first, second = page.evaluate("live.history.samples[0].map(run => [...run])")
        place = page.evaluate("live.names.indexOf('theta1')")
        assert second[place] - first[place] == pytest.approx(1e-9, rel=1e-6)
        page.get_by_role("spinbutton", name="g", exact=True).fill("2")
        page.get_by_role("spinbutton", name="g", exact=True).press("Enter")
        place = page.evaluate("live.names.indexOf('potentialEnergy')")
        page.wait_for_function(f"live.history.samples[0][1][{place}] < 10 && live.history.samples[0][0][{place}] < 10")
        page.wait_for_function("document.getElementById('pale').textContent === 'pale: theta1 + 1e-9'")
        page.select_option("#ghost", "none")
        page.wait_for_function("live.history.runs === 1")


SEEN_CORNERS = """() => {
  const { frameBox, camera } = live.scene, ends = [frameBox.min, frameBox.max], corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => new THREE.Vector3(ends[k & 1].x, ends[(k >> 1) & 1].y, ends[k >> 2].z));
  camera.updateMatrixWorld();
  return corners.map((corner) => corner.project(camera).toArray());
}"""


def test_the_view_in_space_is_filled(browser, page_file):
    """All of the frame is seen, and one of its corners is at an edge of the view."""
    with opened(browser, page_file("HeavyTop")) as page:
        seen = np.abs(np.array(page.evaluate(SEEN_CORNERS))[:, :2])
        assert 0.99 < seen.max() < 1.001


def test_the_view_of_unbounded_motion(browser, page_file):
    """The view shows at most six times the start's size: the unstable linear cart runs off by 1,000 m, and its ground and rod span 1.6 m x 0.59 m."""
    with opened(browser, page_file("InvertedPendulumCartLinear")) as page:
        assert 1.6 < page.evaluate("live.scene.span") < 6 * np.hypot(1.6, 0.6) + 0.5


def test_the_view_contains_the_whole_experiment(browser, page_file):
    """In 5 s, which are 5000 steps, the ball bounces twice as high as in the first second."""
    instance = fmu.Instance("VibratingTable", logging=False)
    with contextlib.closing(SimpleNamespace(close=instance.free)):
        heights = [h for _, h in instance.initialize().run(5, 0.005, "h")]
    assert max(heights) > 2 * max(heights[:200])
    with opened(browser, page_file("VibratingTable")) as page:
        assert page.evaluate("live.scene.frameBox.max.y") > max(heights)


def test_short_experiments_and_large_numbers(browser, page_file):
    """An experiment of 1 s is shown for 5 s; fields show numbers that do not fit in them as powers of ten."""
    with opened(browser, page_file("WormGear")) as page:
        assert page.inner_text("#speedShown") == "× 0.2"
        page.get_by_role("spinbutton", name="load", exact=True).fill("123000000")
        page.get_by_role("spinbutton", name="load", exact=True).press("Enter")
        assert page.get_by_role("spinbutton", name="load", exact=True).input_value() == "1.23e+8"
        page.click("#reset")


def test_size(page_file, check_size):
    text = page_file("DoublePendulum").read_text(encoding="utf-8")
    renderer = len(json.loads(re.search('<script id="data" type="application/json">(.*?)</script>', text, re.S)[1])["renderer"])
    check_size("DoublePendulum", "live page", len(text))
    check_size("DoublePendulum", "live page without its renderer", len(text) - renderer)
    assert not re.search(r"""(src|href)=["']?(https?:)?//""", text)
