"""
Inputs of simulations from tables and functions, in both versions of FMI and in model exchange, against closed forms; and the number of
rows.
"""

import math
import sys

import numpy as np
import pytest

import fmi3
import fmu
import package
from building import build_systems
from fmu import ROOT

sys.path.insert(0, str(ROOT))
from scripts.library.co_simulation import Supplier  # noqa: E402
from scripts.library.problem import Problem  # noqa: E402
from scripts.library.signals import spline_slopes  # noqa: E402
from scripts.library.simulation import simulate  # noqa: E402

MASS = """<system name="Pushed"><input name="F" unit="N"/><coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/>
  <force coordinate="x">F</force><output name="push" unit="N">2*F</output><experiment stopTime="1" stepSize="0.25"/></system>"""
SPRING = """<system name="Sprung"><input name="F" unit="N"/><input name="G" unit="N"/><coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/>
  <potential>50*x^2</potential><force coordinate="x">F + G</force><experiment stopTime="2" stepSize="0.05"/></system>"""
FLOOR = """<system name="Carried"><input name="zb" unit="m" derivatives="2"/><coordinate name="z" velocity="v" unit="m"/>
  <particle mass="1" y="z + zb"/><potential>8*z^2</potential><experiment stopTime="2" stepSize="0.05"/></system>"""
HAND = """<system name="Handed"><input name="u" unit="m" derivatives="2"/><coordinate name="x" velocity="v" unit="m"/>
  <particle mass="3" x="x"/><constraint name="hand" unit="m">u - x</constraint><experiment stopTime="2" stepSize="0.05"/></system>"""
EVEN = dict(fmi_type="CoSimulation", relative_tolerance=1e-11)


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("inputs", {"Pushed": MASS, "Sprung": SPRING, "Carried": FLOOR, "Handed": HAND}, versions=(2, 3))


def archives(name):
    return fmu.archive(name), fmi3.archive(name)


def moved(times, forces):
    """Velocity and position of a mass of 1 kg under a force that is linear between the given times: a cubic in each interval."""
    v, x = [0.0], [0.0]
    for h, low, high in zip(np.diff(times), forces, forces[1:]):
        x.append(x[-1] + h * v[-1] + h**2 * (2 * low + high) / 6)
        v.append(v[-1] + h * (low + high) / 2)
    return v, x


@pytest.mark.parametrize("version", [0, 1])
def test_linear_between_the_rows_of_a_table(version):
    """The rows of the table are not communication points; a force held constant over each step would be 2 % off."""
    times, forces = [0.0, 0.3, 0.4, 1.0], [0.0, 1.0, -1.0, 2.0]
    result = simulate(archives("Pushed")[version], {}, input={"time": times, "F": forces}, **EVEN).outputs
    assert result["time"].tolist() == [0, 0.25, 0.5, 0.75, 1]
    v, x = moved(times, forces)
    assert (result["v"][-1], result["x"][-1]) == pytest.approx((v[-1], x[-1]), abs=1e-12)
    np.testing.assert_allclose(result["push"], 2 * np.interp(result["time"], times, forces), rtol=1e-12)


@pytest.mark.parametrize("version", [0, 1])
def test_a_jump_is_two_rows(version):
    """The force is 2 N from 0.3 s on: v = t, then 0.3 + 2 (t - 0.3)."""
    rows = {"time": [0, 0.3, 0.3, 1], "F": [1, 1, 2, 2]}
    result = simulate(archives("Pushed")[version], {}, input=rows, **EVEN).outputs
    assert result["time"].tolist() == [0, 0.25, 0.3, 0.3, 0.5, 0.75, 1] and result["push"].tolist() == [2, 2, 2, 4, 4, 4, 4]
    np.testing.assert_allclose(result["v"], [0, 0.25, 0.3, 0.3, 0.7, 1.2, 1.7], rtol=1e-13)
    assert simulate(archives("Pushed")[version], {}, input=rows, record_events=False, **EVEN).outputs["time"].tolist() == [0, 0.25, 0.5, 0.75, 1]


@pytest.mark.parametrize("version", [0, 1])
def test_constant_between_rows(version):
    result = simulate(archives("Pushed")[version], {}, input={"time": [0, 0.3, 0.5], "F": [1, 2, 5]}, hold=True, **EVEN).outputs
    np.testing.assert_allclose(result["v"][-1], 0.3 + 0.2 * 2 + 0.5 * 5, rtol=1e-13)
    held = simulate(archives("Pushed")[version], {}, input=lambda t: t, hold=True, record_events=False, **EVEN).outputs
    np.testing.assert_allclose(held["v"], [0, 0, 0.0625, 0.1875, 0.375], atol=1e-14)  # the function is held over each step


def swings(t, force_rate):
    """x'' + 100 x = c t from rest: x = c/100 (t - sin(10 t)/10)."""
    return force_rate / 100 * (t - np.sin(10 * t) / 10)


@pytest.mark.parametrize("version, asks, error", [(0, True, 1e-11), (1, True, 1e-11), (1, False, 2e-6)])
def test_several_inputs_and_kinds(version, asks, error, monkeypatch):
    """
    Inputs as arrays, numbers, functions and records. If the FMU asks for no inputs within steps (FMI 3.0), they change twice in each step of
    0.5 rad; the error is of fourth order.
    """
    if not asks:
        monkeypatch.setattr(Supplier, "__call__", lambda *words: None)
    archive = archives("Sprung")[version]
    table = np.rec.fromarrays([[0.0, 2.0], [0.0, 6.0], [1.0, 1.0]], names="time,F,G")
    given = [table, {"time": [0, 2], "F": [0, 6], "G": [1, 1]}, {"F": lambda t: 3 * t, "G": 1}, lambda t: {"F": 3 * t, "G": 1.0}, lambda t: (3 * t, 1)]
    for one in given:
        result = simulate(archive, {}, input=one, **EVEN).outputs
        t = result["time"]
        np.testing.assert_allclose(result["x"], swings(t, 3) + (1 - np.cos(10 * t)) / 100, atol=error)
    fine = simulate(archive, {}, input=given[0], output_interval=0.025, **EVEN).outputs
    np.testing.assert_allclose(fine["x"], swings(fine["time"], 3) + (1 - np.cos(10 * fine["time"])) / 100, atol=error / 12)


class Frame:
    """The interface of a DataFrame that simulations use."""

    def __init__(self, index, **columns):
        self.index, self.data, self.columns = index, columns, list(columns)

    def reset_index(self):
        return Frame("", time=self.index, **self.data)

    def __getitem__(self, name):
        return self.data[name]


def test_a_data_frame():
    """Time is a column, or the index as from to_pandas()."""
    for frame in (Frame(None, time=[0, 1], F=[0, 1]), Frame([0, 1], F=[0, 1])):
        assert simulate(fmu.archive("Pushed"), {}, input=frame, **EVEN).outputs["v"][-1] == pytest.approx(0.5, rel=1e-13)


@pytest.mark.parametrize("version", [0, 1])
def test_a_function_is_a_cubic_over_each_step(version):
    """
    sin(3 t) in steps of 0.25 s: v = (1 - cos(3 t))/3, x = t/3 - sin(3 t)/9. Polynomials interpolate it at Lobatto points, so that the
    velocity has a higher order.
    """
    result = simulate(archives("Pushed")[version], {}, input=lambda t: math.sin(3 * t), **EVEN).outputs
    t = result["time"]
    np.testing.assert_allclose(result["v"], (1 - np.cos(3 * t)) / 3, atol=1e-6)
    np.testing.assert_allclose(result["x"], t / 3 - np.sin(3 * t) / 9, atol=1e-6)
    np.testing.assert_allclose(result["push"], 2 * np.sin(3 * t), atol=1e-12)


def test_in_model_exchange():
    """The same tables and functions in model exchange, to the tolerance of FMPy's CVode, with the communication step of the experiment."""
    for version in (0, 1):
        for one, v in (({"time": [0, 0.3, 0.3, 1], "F": [0, 3, 1, 1]}, 0.45 + 0.7), (lambda t: math.sin(3 * t), (1 - math.cos(3)) / 3)):
            result = simulate(archives("Pushed")[version], {}, input=one, fmi_type="ModelExchange", relative_tolerance=1e-9).outputs
            assert result["v"][-1] == pytest.approx(v, rel=1e-4) and {0, 0.25, 0.5, 0.75, 1} <= {*result["time"].round(12)}


@pytest.mark.parametrize("version", [0, 1])
@pytest.mark.parametrize("name, place, of", [("Carried", "z", lambda t: (np.cos(4 * t) - np.cos(2 * t)) * 4 / 12), ("Handed", "x", lambda t: 1 - np.cos(2 * t))])
def test_prescribed_motions(name, place, of, version):
    """
    For u = 1 - cos(2 t), u'' = 4 cos(2 t). The derivatives, which are inputs too, come from a spline through the rows, or from the
    function. z'' + 16 z = -4 cos(2 t) from rest: z = (cos(4 t) - cos(2 t))/3.
    """
    archive, moved_by = archives(name)[version], {"Carried": "zb", "Handed": "u"}[name]
    start = {}
    t = np.linspace(0, 2, 81)
    columns = {"time": t, moved_by: 1 - np.cos(2 * t)}
    slopes = {f"der({moved_by})": 2 * np.sin(2 * t)}
    for one, error in ((columns, 2e-5), (columns | slopes, 2e-5), (lambda t: 1 - math.cos(2 * t), 2e-4)):
        result = simulate(archive, start, input=one, **EVEN).outputs
        np.testing.assert_allclose(result[place], of(result["time"]), atol=error)


def test_prescribed_motions_that_are_held_are_reported(monkeypatch):
    monkeypatch.setattr(Supplier, "__call__", lambda *words: None)
    with pytest.warns(UserWarning, match="the FMU keeps 'zb' constant over each step"):
        simulate(fmi3.archive("Carried"), {}, input=lambda t: 0.0, stop_time=0.1)


def test_splines():
    """
    The spline of a cubic polynomial is exact; for sines the error is within Hall and Meyer's bound for slopes of clamped splines, h^3/24
    max f''''.
    """
    t = np.array([0.0, 0.1, 0.5, 0.6, 1.0, 1.7])
    np.testing.assert_allclose(spline_slopes(t, t**3 - 2 * t), 3 * t**2 - 2, rtol=1e-12)
    t = np.linspace(0, 3, 61)
    assert np.max(abs(spline_slopes(t, np.sin(t)) - np.cos(t))) < 0.05**3 / 4


@pytest.mark.parametrize("stop, step, rows", [(2.0, 0.001, 2001), (3600.0, 0.5, 7201), (1.0, 0.3, 5), (0.1, 1.0, 2)])
def test_the_step_is_kept(stop, step, rows):
    """The step is kept for any number of rows; the last row is at the end."""
    for archive in archives("Pushed"):
        time = simulate(archive, {}, stop_time=stop, output_interval=step).outputs["time"]
        assert len(time) == rows and time[-1] == stop
        np.testing.assert_allclose(time[:-1], step * np.arange(rows - 1), rtol=1e-15)


def test_the_step_of_the_experiment_is_kept(tmp_path):
    """The command and model exchange keep the step of the experiment, too."""
    folder = package.assemble(tmp_path / "package")
    result = package.run(folder, "run", fmu.archive("Pushed"), "--stop-time", "300", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert len((tmp_path / "Pushed.csv").read_text().splitlines()) == 1 + 1201
    result = simulate(fmu.archive("Pushed"), {}, stop_time=300, fmi_type="ModelExchange").outputs
    assert len(result) == 1201


@pytest.mark.parametrize("given, message", [
    ({"time": [0, 1], "f": [0, 1]}, "'f' is not an input of Pushed; did you mean 'F'?"),
    ({"time": [0, 1], "q": [0, 1]}, "'q' is not an input of Pushed; these are: F"),
    ({"t": [0, 1], "F": [0, 1]}, "the input has no 'time' but 't', 'F'"),
    ({"time": [0, 1], "F": [0, 1, 2]}, "'F' of the input has 3 values and 'time' 2; expected one for each time"),
    ({"time": [1, 0], "F": [0, 1]}, "the time 0 s of the input follows 1 s; expected times that do not decrease"),
    ({"time": [0, 1], "F": [0, math.nan]}, "'F' of the input has values that are missing or infinite"),
    ({"time": [0, 1], "F": ["a", "b"]}, "'F' of the input has values that are no numbers"),
    ({"time": [0, 1], "F": [[0, 1], [2, 3]]}, "'F' of the input has 2 values in a row; expected 1"),
    ([0, 1], "the input is a list; expected the path of a CSV, a structured array, a dict of arrays or a DataFrame"),
    (np.zeros((3, 2)), "the input is a ndarray; expected the path"),
    (lambda t: (t, t), "the input at 0 s has 2 numbers; expected 1, of F"),
    (lambda t: math.nan if t > 0.6 else t, "expected finite numbers"),
    (lambda t: "much", "the input at 0 s is 'much'; expected numbers"),
    ({"G": lambda t: t}, "'G' is not an input of Pushed"),
])  # fmt: skip
def test_mistakes(given, message):
    with pytest.raises(Problem) as problem:
        simulate(fmu.archive("Pushed"), {}, input=given)
    assert message in str(problem.value)


@pytest.mark.parametrize("version", [0, 1])
def test_fine_rows_in_coarse_steps(version):
    """
    F = sin(5 t) every h = 1 ms with steps of 10 ms gives v = (1 - cos(5 t))/5. Linear interpolation between rows has an error up to
    25 h^2/8 = 3e-6.
    """
    times = np.linspace(0, 1, 1001)
    result = simulate(archives("Pushed")[version], {}, input={"time": times, "F": np.sin(5 * times)}, output_interval=0.01, **EVEN).outputs
    assert len(result) == 101
    np.testing.assert_allclose(result["v"], (1 - np.cos(5 * result["time"])) / 5, atol=1e-6)


@pytest.mark.parametrize("version", [0, 1])
def test_feedback_is_held_in_each_step(version):
    """F = -9 x - 2 v on a mass of 1 kg is constant in each step of h = 0.05 s, whose closed form is x + h v + h^2/2 F, v + h F."""
    seen = []

    def control(time, sim):
        seen.append((time, sim.time, sim["time"]))
        return -9 * sim["x"] - 2 * sim["v"]

    words = {"output_interval": 0.05, **EVEN}
    result = simulate(archives("Pushed")[version], {"x": 1}, input=control, **words).outputs
    x, v, h = 1.0, 0.0, 0.05
    for row in result:
        np.testing.assert_allclose((row["x"], row["v"]), (x, v), rtol=1e-12)
        force = -9 * x - 2 * v
        x, v = x + h * v + h**2 / 2 * force, v + h * force
    assert len(result) == 21 and result["push"][0] == -18 and result["push"][1] == -18  # just before the next value
    assert all(time == other == third for time, other, third in seen) and [time for time, *_ in seen] == result["time"].tolist()
    named = simulate(archives("Pushed")[version], {"x": 1}, input=lambda time, sim: {"F": control(time, sim)}, **words).outputs
    assert (named == result).all()


@pytest.mark.parametrize("function, message", [
    (lambda t, sim: [1, 2], "the input at 0 s has 2 numbers; expected 1, of F"),
    (lambda t, sim: math.nan if t else 0, "'F' is set to nan; expected a finite number"),
    (lambda t, sim: {"x": 1}, "'x' is not an input of Pushed"),
    (lambda t, sim: sim["y"], "'y' is not a variable of Pushed"),
    (lambda t, sim: None, "'F' is set to None; expected a number|expected a finite number"),
    (lambda t, sim: sim.__setitem__("F", 1), "'F' cannot be set here; expected a function that returns the inputs"),
])  # fmt: skip
def test_wrong_feedback(function, message):
    with pytest.raises(Problem, match=message):
        simulate(archives("Pushed")[0], {}, input=function, **EVEN)


def test_feedback_needs_co_simulation():
    with pytest.raises(Problem, match="expected co-simulation, whose steps begin with its values"):
        simulate(archives("Pushed")[0], {}, input=lambda t, sim: 0.0, fmi_type="ModelExchange")
