"""Systems derived and solved without a compiler: by the WebAssembly module itself, and in the page for editing systems."""

import contextlib
import functools
import re
import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest
import wasmtime

import fmu
from building import ROOT
from driven_chromium import PHONE, browser  # noqa: F401
from scripts.commands.live import LABORATORY
from scripts.library.live_page.editor import editor_of, files_of

pytestmark = pytest.mark.long

STEPS = 100
ALL = sorted(path.parent.name for path in (ROOT / "fmu").glob("*/system.xml"))


@functools.cache
def module():
    """lagc and the runtime in WebAssembly."""
    subprocess.run([ROOT / "scripts" / "package" / "build-laboratory"], check=True)
    engine = wasmtime.Engine()
    return engine, wasmtime.Module.from_file(engine, str(LABORATORY))


class Laboratory:
    """An instance of the module, with the files of a folder."""

    def __init__(self, folder, errors):
        engine, compiled = module()
        self.store, linker = wasmtime.Store(engine), wasmtime.Linker(engine)
        linker.define_wasi()
        settings = wasmtime.WasiConfig()
        settings.preopen_dir(str(folder), "/")
        settings.stderr_file = str(errors)
        self.store.set_wasi(settings)
        self.exports = linker.instantiate(self.store, compiled).exports(self.store)
        self.call("_initialize")

    def call(self, name, *arguments):
        return self.exports[name](self.store, *arguments)

    def place(self, content):
        place = self.call("allocate", len(content) + 1)
        self.exports["memory"].write(self.store, content + b"\0", place)
        return place

    def text(self, place):
        memory = self.exports["memory"].read(self.store, place, self.exports["memory"].data_len(self.store))
        return memory[: memory.index(0)].decode()

    def derive(self, path, is_pulled=False, robot=""):
        return self.call("derive", self.place(f"/{path}".encode()), int(is_pulled), self.place(robot.encode())) == 0

    def description(self):
        return ElementTree.fromstring(self.text(self.call("model_description")))

    def states_after(self, steps, step, references):
        instance = self.call("instantiate", self.place(self.description().get("guid").encode()))
        assert instance != 0, self.text(self.call("messages"))
        for name, arguments in (("SetupExperiment", (0, 0.0, 0.0, 0, 0.0)), ("EnterInitializationMode", ()), ("ExitInitializationMode", ())):
            assert self.call(f"fmi2{name}", instance, *arguments) <= 1
        for i in range(steps):
            assert self.call("fmi2DoStep", instance, i * step, step, 0) == 0, self.text(self.call("messages"))
        asked, values = self.place(np.array(references, "<u4").tobytes()), self.call("allocate", 8 * len(references))
        assert self.call("fmi2GetReal", instance, asked, len(references), values) == 0
        return np.frombuffer(self.exports["memory"].read(self.store, values, values + 8 * len(references)), "<f8")


def native_states(name, steps, step):
    instance = fmu.Instance(name, logging=False)
    with contextlib.ExitStack() as stack:
        stack.callback(instance.free)
        instance.initialize({})
        for i in range(steps):
            instance.fmu.doStep(i * step, step)
        return np.array(instance.fmu.getReal(instance.vr(*fmu.states_of(name))))


def method_of(name):
    solver = ElementTree.parse(ROOT / "fmu" / name / "system.xml").find("solver")
    return solver.get("method") if solver is not None else "auto"


@pytest.mark.parametrize("name", ALL)
def test_it_is_the_fmu(name, tmp_path):
    """The laboratory, which interprets instruction tables, gives the result of the compiled FMU."""
    laboratory = Laboratory(ROOT / "fmu", tmp_path / "errors")
    if method_of(name) in ("erk", "bdf"):
        assert not laboratory.derive(f"{name}/system.xml")
        assert f"the method '{method_of(name)}' is not available here; expected <solver method=\"auto\"/>" in (tmp_path / "errors").read_text()
        return
    assert laboratory.derive(f"{name}/system.xml"), (tmp_path / "errors").read_text()
    step, states = float(fmu.description(name).defaultExperiment.stepSize), fmu.states_of(name)
    references = {variable.get("name"): int(variable.get("valueReference")) for variable in laboratory.description().find("ModelVariables")}
    found = laboratory.states_after(STEPS, step, [references[state] for state in states])
    np.testing.assert_allclose(found, native_states(name, STEPS, step), rtol=1e-9, atol=1e-9)


def test_start_values_from_parameters(tmp_path):
    """Start values of a state and of a mode that depend on parameters: x = l + (g/m) t^2/2."""
    (tmp_path / "system.xml").write_text("""<system name="Pushed"><parameter name="l" start="3" unit="m"/><parameter name="g" start="5" unit="N"/><parameter name="m" start="2" unit="kg"/>
      <coordinate name="x" velocity="v" unit="m" start="l"/><mode name="a" unit="m/s2" start="g/m"/><particle mass="m" x="x"/><force coordinate="x">m*a</force>
      <event when="x - 100*l" direction="rising"><set mode="a">0</set></event></system>""")
    laboratory = Laboratory(tmp_path, tmp_path / "errors")
    assert laboratory.derive("system.xml"), (tmp_path / "errors").read_text()
    references = {variable.get("name"): int(variable.get("valueReference")) for variable in laboratory.description().find("ModelVariables")}
    np.testing.assert_allclose(laboratory.states_after(4, 0.5, [references[name] for name in ("x", "v", "a")]), [8, 5, 2.5], rtol=1e-12)


def test_mistakes(tmp_path):
    (tmp_path / "system.xml").write_text('<system name="Wrong">\n  <coordinate name="x"/>\n  <kinetic>m*v^2</kinetic>\n</system>\n')
    assert not Laboratory(tmp_path, tmp_path / "errors").derive("system.xml")
    assert (tmp_path / "errors").read_text().startswith("/system.xml:2: ")
    assert not Laboratory(tmp_path, tmp_path / "none").derive("nothing.xml")
    assert "nothing.xml" in (tmp_path / "none").read_text()


def test_pulled(tmp_path):
    """The system has the inputs of lagc --pull only if they are requested."""
    for is_pulled in (False, True):
        laboratory = Laboratory(ROOT / "fmu", tmp_path / "errors")
        assert laboratory.derive("DoublePendulum/system.xml", is_pulled)
        names = {variable.get("name") for variable in laboratory.description().find("ModelVariables")}
        assert ("pull.of.upper" in names) == is_pulled


BALL = """<robot name="ball"><link name="ball"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>"""


def test_options_for_the_file_of_a_robot(tmp_path):
    """A free ball falls by g t^2/2; wrong options give lagc's messages."""
    (tmp_path / "ball.urdf").write_text(BALL)
    laboratory = Laboratory(tmp_path, tmp_path / "errors")
    assert laboratory.derive("ball.urdf", robot="base=floating\nground=false\nlimits=outputs"), (tmp_path / "errors").read_text()
    references = {variable.get("name"): int(variable.get("valueReference")) for variable in laboratory.description().find("ModelVariables")}
    np.testing.assert_allclose(laboratory.states_after(5, 0.1, [references["base_z"], references["base_z_velocity"]]), [-9.81 / 8, -9.81 / 2], rtol=1e-12)
    for robot, message in (("", "no joint of the robot moves"), ("base=flying", "'base=flying' is not an option for robots; expected base=fixed or base=floating")):
        assert not Laboratory(tmp_path, tmp_path / "wrong").derive("ball.urdf", robot=robot)
        assert message in (tmp_path / "wrong").read_text()


def test_a_robot_is_changed_in_the_page(browser, tmp_path):
    """The ball falls by g t^2/2; a saved page keeps the options, without which nothing moves."""
    module()
    (tmp_path / "ball.urdf").write_text(BALL)
    (tmp_path / "page.html").write_text(editor_of(tmp_path / "ball.urdf", LABORATORY, robot=["base=floating"]), encoding="utf-8")
    with editor(browser, tmp_path / "page.html") as page:
        assert run_in(page, 0.5)["base_z"] == pytest.approx(-9.81 / 8, rel=1e-8)
        run_anew(page, BALL.replace('name="ball"', 'name="egg"'))
        with page.expect_download() as download:
            page.locator("#savePage").click()
        download.value.save_as(tmp_path / "kept.html")
    with editor(browser, tmp_path / "kept.html") as page:
        assert page.locator("#source").input_value().count('"egg"') == 2
        assert run_in(page, 0.5)["base_z"] == pytest.approx(-9.81 / 8, rel=1e-8)


def test_files_that_others_refer_to(tmp_path):
    """The files that a system refers to are included, by paths relative to each other."""
    found = files_of(ROOT / "fmu" / "MotorPendulum" / "system.xml")
    assert sorted(found["files"]) == ["Motor/system.xml", "MotorPendulum/system.xml"] and found["file"] == "MotorPendulum/system.xml"
    robot = tmp_path / "robots" / "arm.urdf"
    robot.parent.mkdir()
    robot.write_text('<robot name="arm"><link name="base"/></robot>')
    assert files_of(robot) == {"files": {"robots/arm.urdf": robot.read_text()}, "file": "robots/arm.urdf"}


@contextlib.contextmanager
def editor(browser, file, **options):
    """Yield the page once its inner page runs, with options of Chromium's context; check at the end that it logged no error."""
    page, complaints = browser.new_page(**{"viewport": {"width": 1500, "height": 800}} | options), []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    page.goto(file.as_uri())
    page.wait_for_function("window.bench && bench.runs > 0")
    page.frame_locator("#page").locator("body[data-ready]").wait_for(timeout=60000)
    yield page
    page.close()
    assert complaints == []


def run_in(page, until):
    """States of the system in the page, after steps of the experiment's length."""
    frame = page.query_selector("#page").content_frame()
    frame.evaluate("document.getElementById('play').textContent === 'Pause' && document.getElementById('play').click()")
    frame.evaluate("document.getElementById('reset').click()")
    values = frame.evaluate("until => live.run(until).then((ran) => Array.from(ran.values))", until)
    return dict(zip(frame.evaluate("live.names"), values))


def run_anew(page, text):
    """Run with this text in place of the existing one."""
    runs = page.evaluate("bench.runs")
    page.locator("#source").fill(text)
    page.locator("#source").press("Control+Enter")
    page.wait_for_function(f"bench.runs === {runs + 1}")
    page.frame_locator("#page").locator("body[data-ready]").wait_for(timeout=60000)


def write_page(tmp_path, name):
    module()
    file = tmp_path / f"{name}.html"
    file.write_text(editor_of(ROOT / "fmu" / name / "system.xml", LABORATORY), encoding="utf-8")
    return file


def test_size(tmp_path, check_size):
    check_size("DoublePendulum", "page for editing", write_page(tmp_path, "DoublePendulum").stat().st_size)


# JavaScript: the selected text, and the number of its line.
SELECTED = """() => {
  const { value, selectionStart, selectionEnd } = document.getElementById("source");
  return [value.slice(selectionStart, selectionEnd), value.slice(0, selectionStart).split("\\n").length];
}"""


def test_a_system_is_changed_in_the_page(browser, tmp_path):
    """
    A mistake is reported at its line; a valid system runs, and can be saved as a page of its own. A mass on a spring follows its closed
    form.
    """
    spring = """<system name="Spring" description="A mass on a spring">
  <parameter name="m" start="2" unit="kg"/>
  <parameter name="k" start="8" unit="N/m"/>
  <coordinate name="x" velocity="v" unit="m" start="0.3"/>
  <kinetic>m*v^2/2</kinetic>
  <potential>k*x^2/2</potential>
  <experiment stopTime="3" stepSize="0.01"/>
</system>
"""
    with editor(browser, write_page(tmp_path, "DoublePendulum")) as page:
        assert page.frame_locator("#page").locator("h1").inner_text() == "Two point masses on two massless rods"
        page.set_viewport_size({"width": 1280, "height": 800})  # the plots are beside the scene, and the buttons in one row
        scene, plots = (page.frame_locator("#page").locator(part).bounding_box() for part in ("#view", "#plots"))
        assert plots["y"] == scene["y"] and plots["x"] >= scene["x"] + scene["width"] and scene["width"] > 350
        assert page.locator("#editor > nav").bounding_box()["height"] < 60
        page.locator("#source").fill(spring.replace("k*x^2/2", "k*y^2/2"))
        page.wait_for_function("document.getElementById('state').textContent === '1 error'")
        assert page.locator("#messages").inner_text().startswith("line 6: the potential: unknown name 'y'")
        assert page.locator("#lines .wrong").inner_text() == "6" and page.evaluate("bench.runs") == 1
        page.locator("#messages button").click()
        assert page.evaluate(SELECTED) == ["y", 6] and page.locator("#colors .wrong").all_inner_texts() == ["y"]
        page.locator("#source").fill(spring.replace("k*x^2/2", "0*x + " * 40 + "k*y^2/2"))
        page.wait_for_function("document.getElementById('state').textContent === '1 error'")
        page.locator("#messages button").click()
        assert page.evaluate(SELECTED) == ["y", 6]
        source, mistake = page.locator("#source").bounding_box(), page.locator("#colors .wrong").bounding_box()
        assert source["x"] + source["width"] / 2 < mistake["x"] < source["x"] + source["width"] - 10
        with page.expect_download() as download:
            page.locator("#saveFile").click()
        assert download.value.suggested_filename == "Spring.xml"
        run_anew(page, spring)
        assert page.locator("#messages").inner_text() == "" and page.locator("#lines .wrong").count() == 0
        assert run_in(page, 3.0)["x"] == pytest.approx(0.3 * np.cos(6.0), abs=1e-8)
        with page.expect_download() as download:
            page.locator("#savePage").click()
        assert download.value.suggested_filename == "Spring-edit.html"
        download.value.save_as(tmp_path / "kept.html")
    with editor(browser, tmp_path / "kept.html") as page:
        assert page.locator("#source").input_value() == spring
        assert run_in(page, 3.0)["x"] == pytest.approx(0.3 * np.cos(6.0), abs=1e-8)


CONTEXTS = [  # the text, with "|" at the caret; the completions offered, in order; the line after accepting the first
    ('<system name="A">\n  <poten|\n</system>', ["potential"], "  <potential>|</potential>"),
    ('<system name="A">\n  <coordinate na|\n</system>', ["name"], '  <coordinate name="|"'),
    ('<system name="A">\n  <coordinate v| name="x"/>\n</system>', ["velocity", "velocityStart", "velocityNominal", "velocityDescription", "velocityDisplayUnit"], '  <coordinate velocity="|" name="x"/>'),
    ('<system name="A">\n  <coordinate velocity="v" v|\n</system>', ["velocityStart", "velocityNominal", "velocityDescription", "velocityDisplayUnit"], None),
    ('<system name="A">\n  <coordinate n| name="x"/>\n</system>', ["nominal"], None),
    ('<system name="A">\n  <solver method="r|"/>\n</system>', ["radau"], '  <solver method="radau|"/>'),
    ('<system name="A">\n  <coordinate name="theta" velocity="thetaDot"/>\n  <potential>cos(th|)</potential>\n</system>', ["theta", "thetaDot"], "  <potential>cos(theta|)</potential>"),
    ('<system name="A">\n  <output name="h">sq|</output>\n</system>', ["sqrt("], '  <output name="h">sqrt(|</output>'),
    ('<system name="A">\n  <event when="x > 1"><s|\n</system>', ["set"], '  <event when="x > 1"><set>|</set>'),
    ('<system name="A">\n  <table name="f"><p|\n</system>', ["point"], '  <table name="f"><point x="|" y=""/>'),
    ('<system name="A">\n  <point n|/>\n</system>', ["name"], None),
    ('<system name="A">\n  <coordinate name="th|"/>\n</system>', [], None),
    ('<system name="A">\n  <!-- <poten| -->\n</system>', [], None),
    ('<system name="A">\n  <kinetic>1</ki|\n</system>', ["kinetic"], "  <kinetic>1</kinetic>|"),
    ("<sys|", ["system"], '<system name="|"></system>'),
]  # fmt: skip


def test_words_that_may_stand_at_the_caret(browser, tmp_path):
    with editor(browser, write_page(tmp_path, "SimplePendulum")) as page:
        functions = {name for kind, name in map(str.split, fmu.lagc("--words").stdout.splitlines()) if kind == "function"}
        assert set(page.evaluate("[...FUNCTIONS, ...OPERATORS]")) == functions | {"distance", "dot", "norm"}
        for text, expected, becomes in CONTEXTS:
            at = text.index("|")
            offered = page.evaluate("([text, at]) => completionsAt(text, at, language)", [text[:at] + text[at + 1 :], at])
            assert [word["label"] for word in offered["completions"]] == expected, text
            if becomes is not None:
                source = page.locator("#source")
                source.fill(text[:at].removesuffix(offered["word"]) + text[at + 1 :])
                source.evaluate("(source, at) => { source.focus(); source.setSelectionRange(at, at); }", at - len(offered["word"]))
                page.keyboard.type(offered["word"])
                page.keyboard.press("Enter")
                found, caret = source.input_value(), source.evaluate("source => source.selectionStart")
                assert becomes in (found[:caret] + "|" + found[caret:]).split("\n"), text


def test_colors_and_the_button_that_inserts(browser, tmp_path):
    """The colored copy has the same text, with a kind for each token. The button begins an element, and keys choose one."""
    with editor(browser, write_page(tmp_path, "SimplePendulum")) as page:
        text = '<system name="A"><!-- a < b -->\n  <kinetic>1 & 2</kinetic>\n  <broken at="1\n'
        page.locator("#source").fill(text)
        assert page.locator("#colors").evaluate("node => node.textContent") == text + "\n"
        kinds = page.evaluate("text => tokensOf(text).map(([kind, begin, end]) => [kind, text.slice(begin, end)])", text)
        assert "".join(word for _, word in kinds) == text
        assert ["comment", "<!-- a < b -->"] in kinds and ["attribute", "at"] in kinds and ["value", '"1\n'] in kinds and ["text", "1 & 2"] in kinds
        page.locator("#source").fill('<system name="A">\n  <kinetic>1</kinetic>\n</system>\n')
        page.locator("#insert").click()
        assert page.locator("#completions li").count() > 30
        page.keyboard.type("exp")
        page.keyboard.press("Tab")
        page.keyboard.press("Control+Space")
        assert page.locator("#completions").is_hidden(), "nothing is offered before the tag's end is near"
        assert page.locator("#source").input_value() == '<system name="A">\n  <kinetic>1</kinetic>\n  <experiment/>\n</system>\n'
        page.keyboard.type(" st")
        page.keyboard.press("ArrowDown")
        page.keyboard.press("Enter")
        page.keyboard.type("3")
        assert '  <experiment stopTime="3"/>' in page.locator("#source").input_value()


def test_an_element_is_inserted_on_a_phone(browser, tmp_path):
    """The list is in sight, beside the new line at the end of a long system. Nothing is reported before the first value is filled."""
    with editor(browser, write_page(tmp_path, "SimplePendulum"), **PHONE) as page:
        page.tap("#insert")
        page.wait_for_timeout(1000)
        text, words = page.locator("#text").bounding_box(), page.locator("#completions").bounding_box()
        line = text["y"] + page.evaluate("9.6 + 19 * (source.value.slice(0, source.selectionStart).split('\\n').length - 1) - source.scrollTop")
        assert words["height"] > 100 and text["y"] - 1 < words["y"] and words["y"] + words["height"] < text["y"] + text["height"] + 1
        assert text["y"] < line < text["y"] + text["height"] - 19 and min(abs(words["y"] + words["height"] - line), abs(words["y"] - line - 19)) < 2
        page.locator("#completions li", has_text="particle").first.tap()
        assert '<particle name="" mass="" x="" y=""/>' in page.locator("#source").input_value()
        page.wait_for_timeout(1000)
        assert page.locator("#messages").inner_text() == "" and page.locator("#state").inner_text().startswith("derived")
        page.keyboard.type("second")
        page.wait_for_function("document.getElementById('state').textContent === '3 errors'")


def test_ghosts_of_the_first_example(browser, tmp_path):
    """
    The bead of README.md leaves its lowest point. Linearized, theta'' + b/(m R^2) theta' = (W^2 - g/R) theta. Its curves end where theta or
    omega is further above its range than the range is wide. The axes contain a bead with kept values, and its rod is drawn.
    """
    text = re.search(r'<system name="BeadOnHoop".*?</system>', (ROOT / "README.md").read_text(), re.S)[0]
    with editor(browser, write_page(tmp_path, "SimplePendulum")) as page:
        run_anew(page, text)
        frame = page.query_selector("#page").content_frame()
        frame.select_option("#ghost", "linear")
        frame.wait_for_function("live.history.runs === 2 && live.history.times.at(-1) > 3")
        frame.click("#play")
        frame.wait_for_timeout(300)
        times, samples, end = frame.evaluate("[live.history.times, live.history.samples.map(([run]) => ['theta', 'omega'].map((name) => run[live.names.indexOf(name)])), live.ghostEnd(0, live.history.length)]")
        slow, fast = np.roots([1, 0.01 / (0.1 * 0.25), -(36 - 9.81 / 0.5)])
        closed = lambda t: 0.1 / (fast - slow) * np.array([fast * np.exp(slow * t) - slow * np.exp(fast * t), fast * slow * (np.exp(slow * t) - np.exp(fast * t))])
        low, high = np.min(samples, axis=0), np.max(samples, axis=0)
        limit = high + (0.06 + 1.12) * (high - low)  # a range has margins of 6%
        assert (closed(times[end - 1]) <= limit).all() and (closed(times[end]) > limit).any() and 0.5 < times[end] < 1.5
        assert [plot[1] < 3 for plot in frame.evaluate("[live.plots[0].range, live.plots[2].range]")] == [True, True]
        frame.select_option("#ghost", "kept")
        for name, value in (("W", "5"), ("theta", "0.2")):
            frame.get_by_role("spinbutton", name=name, exact=True).fill(value)
            frame.get_by_role("spinbutton", name=name, exact=True).press("Enter")
        frame.click("#reset")
        frame.click("#play")
        frame.wait_for_function("live.history.times.at(-1) > 2")
        largest = frame.evaluate("Math.max(...live.history.samples.map((runs) => runs[1][live.names.indexOf('theta')]))")
        assert frame.evaluate("live.plots[0].range[1]") > largest > 1.3
        assert frame.inner_text("#pale") == "pale: kept, with W = 6 rad/s, theta = 0.1 rad"
        assert frame.evaluate("live.scene.ghostRods.map(({ mesh, group }) => group.visible && mesh.visible && mesh.scale.y)") == [pytest.approx(0.5, rel=1e-9)]


def test_equilibrium_and_linearization(browser, tmp_path):
    """
    A mass on a spring and a damper: at rest at x = (F - m g)/k, where A = [[0, 1], [-k/m, -d/m]], B = [[0], [1/m]] and C = [[1, 0], [0, 1], [k, 0]].
    Without the spring there is no equilibrium, and the page says so.
    """
    text = """<system name="Hanging">
  <parameter name="m" start="2" unit="kg"/><parameter name="k" start="50" unit="N/m"/><parameter name="d" start="4" unit="N.s/m"/>
  <input name="F" start="9.62" unit="N"/><coordinate name="x" velocity="v" unit="m" start="0.3"/>
  <particle name="mass" mass="m" x="0" y="x"/><potential>m*9.81*x + k*x^2/2</potential><dissipation>d*v^2/2</dissipation>
  <force coordinate="x">F</force><output name="pull" unit="N">k*x</output>
</system>
"""
    with editor(browser, write_page(tmp_path, "SimplePendulum")) as page:
        found = []
        for source in (text, text.replace(" + k*x^2/2", "").replace('start="9.62"', 'start="0"')):
            run_anew(page, source)
            frame = page.query_selector("#page").content_frame()
            frame.click("text=Equilibrium and linearization")
            frame.wait_for_function("live.linearization")
            found.append(frame.evaluate("live.linearization"))
            if source == text:
                assert frame.locator("#linearization table").count() == 4 and "x = -0.2 m" in frame.inner_text("#linearization")
                frame.click("text=Start there")
                frame.wait_for_function("live.history.length > 0 && Math.abs(live.history.samples[0][0][live.names.indexOf('x')] + 0.2) < 1e-9")
    rest, none = found
    expected = {"A": [[0, 1], [-25, -2]], "B": [[0], [0.5]], "C": [[1, 0], [0, 1], [50, 0]], "D": [[0], [0], [0]]}
    assert {name: np.array(rest["model"][name]) == pytest.approx(np.array(value), abs=1e-7) for name, value in expected.items()} == dict.fromkeys(expected, True)
    assert np.array(sorted(rest["eigenvalues"])) == pytest.approx(np.array([[-1, -np.sqrt(24)], [-1, np.sqrt(24)]]), abs=1e-6)
    assert rest["stability"] == "stable" and "no equilibrium" in none["problem"]


def test_several_files(browser, tmp_path):
    with editor(browser, write_page(tmp_path, "MotorPendulum")) as page:
        assert page.locator("#files option").all_inner_texts() == ["MotorPendulum/system.xml", "Motor/system.xml"]
        step, states = float(fmu.description("MotorPendulum").defaultExperiment.stepSize), fmu.states_of("MotorPendulum")
        found, expected = run_in(page, STEPS * step), native_states("MotorPendulum", STEPS, step)
        np.testing.assert_allclose([found[state] for state in states], expected, rtol=1e-9, atol=1e-12)
        page.locator("#files").select_option("Motor/system.xml")
        page.locator("#source").fill("<system")
        page.wait_for_function("document.getElementById('state').textContent === '2 errors'")
        assert page.locator("#messages").inner_text().startswith("Motor/system.xml, line 1: <system> is not closed")
        assert page.locator("#lines .wrong").inner_text() == "1"
