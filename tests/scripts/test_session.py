"""Simulations by start and step of the package agree with closed forms, and restore saved states bit for bit."""

import copy
import gc
import pickle
import re

import numpy as np
import pytest

import fmi3
import fmu
from building import build_systems
from fmu import ROOT
from motions import lagrange_fmu  # noqa: F401

PUSHED = """<system name="PushedInSession"><parameter name="m" start="1" unit="kg" min="0"/><input name="F" unit="N"/>
  <coordinate name="x" velocity="v" unit="m"/><particle mass="m" x="x"/><force coordinate="x">F</force><output name="twice" unit="N">2*F</output>
  <experiment stopTime="1" stepSize="0.25"/></system>"""
# The force n u if `on`, and noise drawn every 10 ms; the particle bounces off the wall.
NOISY = """<system name="NoisyInSession"><parameter name="n" type="Integer" start="2"/><parameter name="on" type="Boolean" start="true"/>
  <parameter name="seed" type="Integer" start="3"/><parameter name="strength" start="1" unit="N"/><input name="u" unit="N"/>
  <coordinate name="x" velocity="v" unit="m" start="0.1"/><particle mass="1" x="x"/>
  <mode name="k"/><mode name="noise"/><sample every="0.01"><set mode="k">k + 1</set><set mode="noise">gauss(seed, k)</set></sample>
  <force coordinate="x">on*n*u + noise*strength</force><contact name="wall" gap="x" unit="m" restitution="0.5"/>
  <experiment stopTime="1" stepSize="0.01"/></system>"""
# The force has a square root of a negative number beyond x = 1 m.
ENDS = """<system name="EndsInSession"><parameter name="c" start="0" unit="N"/><parameter name="L" start="1" unit="m"/><coordinate name="x" velocity="v" unit="m" velocityStart="1"/>
  <particle mass="1" x="x"/><force coordinate="x">c*sqrt(1 - x/L)</force><experiment stopTime="2" stepSize="0.25"/></system>"""

PACKAGE = ROOT / "scripts" / "wheel"
CART = (PACKAGE / "lagrange_fmu" / "templates" / "cart.xml").read_text().replace("@NAME@", "Cart")
EXAMPLES = re.findall(r"```python\n(.*?)```", (PACKAGE / "README.md").read_text(), re.S)


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("session", {"PushedInSession": PUSHED, "NoisyInSession": NOISY, "EndsInSession": ENDS, "Cart": CART}, versions=(2, 3))


BOTH = pytest.mark.parametrize("archive", [fmu.archive, fmi3.archive])


@BOTH
def test_inputs_are_held_in_steps(archive, lagrange_fmu):  # noqa: F811
    """A mass of 2 kg under a constant force within each step of 0.1 s has the closed form v + h F/m, x + h v + h^2/2 F/m."""
    x = v = 0.0
    with lagrange_fmu.start(archive("PushedInSession"), m="2000g") as sim:
        assert sim.inputs == ["F"] and "x" in sim and "y" not in sim and set(sim.outputs) <= set(sim)
        for k in range(10):
            sim["F"] = k**2
            assert sim["twice"] == 2 * k**2  # before the step
            sim.step(0.1)
            x, v = x + 0.1 * v + k**2 / 2 * 0.005, v + 0.1 * k**2 / 2
            np.testing.assert_allclose(sim["x", "v"], (x, v), rtol=1e-13)
        assert sim.time == pytest.approx(1) and sim["time"] == sim.time
        sim["m"] = 1  # a tunable parameter
        sim.step("100ms")
        assert sim["v"] == pytest.approx(v + 8.1, rel=1e-13)
        sim.reset(m=4, x="10cm", v=1)
        assert sim.time == 0 and sim["m", "x", "v"].tolist() == [4, 0.1, 1]
        sim.reset()
        assert sim["m", "x", "v"].tolist() == [2, 0, 0]


def run(sim, steps=30):
    """States after each of `steps` steps that end between samples, with an input that jumps."""
    found = []
    for k in range(steps):
        sim["u"] = -5.0 if k % 3 else 1.0
        sim.step(0.0137)
        found.append(tuple(sim["x", "v", "noise", "k"]))
    return found


@BOTH
def test_back_to_a_state_bit_for_bit(archive, lagrange_fmu):  # noqa: F811
    """The motion through samples, noise and impacts repeats from a saved state, in the same simulation and, by pickle, in another one."""
    path = archive("NoisyInSession")
    with lagrange_fmu.start(path, seed=7) as sim, lagrange_fmu.start(path, seed=7, u=-5) as other:
        run(sim, 7)
        state = sim.save()
        first = run(sim)
        assert len({noise for _, _, noise, _ in first}) > 20 and min(x for x, *_ in first) < 0.05
        sim.restore(state)
        assert sim.time == state.time and run(sim) == first
        run(other, 3)
        other.restore(pickle.loads(pickle.dumps(state)))
        assert run(other) == first
        sim.reset(seed=8)
        assert run(sim, 7) != run(other, 7)


@BOTH
def test_types(archive, lagrange_fmu):  # noqa: F811
    """Booleans and integers keep their types. The velocities of two runs with the same noise differ by n u t."""
    path = archive("NoisyInSession")
    speeds = []
    for start in ({"n": 5}, {"on": False}):
        with lagrange_fmu.start(path, start, u=2, x=9) as sim:
            assert type(sim["on"]) is bool and type(sim["n"]) is int
            sim.step(0.25)
            speeds.append(sim["v"])
            sim["on"], sim["n"] = True, 3
            assert sim["on"] is True and sim["n"] == 3
    assert speeds[0] - speeds[1] == pytest.approx(5 * 2 * 0.25, rel=1e-12)


@BOTH
def test_a_step_that_fails(archive, lagrange_fmu):  # noqa: F811
    """x = t until the root fails at 1 m; the time stays that before the failed step, and the simulation continues from a saved state."""
    with lagrange_fmu.start(archive("EndsInSession")) as sim:
        sim.step(0.9)
        state = sim.save()
        with pytest.raises(lagrange_fmu.Problem, match=r"^EndsInSession cannot step from 0.9 s to 1.4 s: .*by a root"):
            sim.step(0.5)
        assert sim.time == 0.9
        sim.restore(state)
        sim.step(0.05)
        assert sim["x"] == pytest.approx(0.95, rel=1e-12)
        sim.reset()
        assert sim["x"] == 0


@BOTH
def test_messages_reach_the_simulation_that_caused_them(archive, lagrange_fmu):  # noqa: F811
    """Also after a simulation that was started later is closed."""
    with lagrange_fmu.start(archive("EndsInSession")) as sim:
        for _ in range(3):
            with lagrange_fmu.start(archive("PushedInSession")) as other:
                other.step(0.1)
            gc.collect()
            with pytest.raises(lagrange_fmu.Problem, match=r"^EndsInSession cannot step from 0 s to 1.4 s: .*by a root"):
                sim.step(1.4)
            sim.reset()
        assert not sim._problems and not other._problems


@BOTH
def test_what_is_no_step_changes_nothing(archive, lagrange_fmu):  # noqa: F811
    with lagrange_fmu.start(archive("EndsInSession")) as sim:
        sim.step(0.5)
        with pytest.raises(lagrange_fmu.Problem, match="the step of 1e-300 s is below the resolution of time at 0.5 s; expected a longer one"):
            sim.step(1e-300)
        sim.step(0.25)
        assert sim["x"] == pytest.approx(0.75, rel=1e-12)


@BOTH
def test_variables_are_no_attributes(archive, lagrange_fmu):  # noqa: F811
    with lagrange_fmu.start(archive("PushedInSession")) as sim:
        with pytest.raises(lagrange_fmu.Problem, match=r"^'F' is a variable, not an attribute; expected sim\['F'\] = ...$"):
            sim.F = 3
        with pytest.raises(AttributeError, match=r"^a simulation has no attribute 'v'; expected sim\['v'\]$"):
            sim.v  # noqa: B018
        assert sim["F"] == 0 and not hasattr(sim, "nothing")


@BOTH
def test_switches_by_their_names(archive, lagrange_fmu):  # noqa: F811
    with lagrange_fmu.start(archive("NoisyInSession"), on="false", strength=0) as sim:
        assert sim["on"] is False
        sim["on"] = "true"
        assert sim["on"] is True
        sim.reset()
        assert sim["on"] is False


WRONG = [
    ("sim['y']", "'y' is not a variable of NoisyInSession; these are: "),
    ("sim['noize'] = 1", "'noize' is not a variable of NoisyInSession; did you mean 'noise'?"),
    ("sim[0]", "0 is not the name of a variable"),
    ("sim['x'] = 1", "'x' can be set at the start only; expected start(..., {'x': ...})"),
    ("sim['wall.closed'] = 1", "'wall.closed' of NoisyInSession cannot be set; these are inputs: u"),
    ("sim['u'] = [1, 2]", "'u' is set to [1, 2]; expected a finite number"),
    ("sim['u'] = np.nan", "'u' is set to nan; expected a finite number"),
    ("sim['u'] = None", "'u' is set to None; expected a finite number"),
    ("sim['u'] = 'high'", "u: the value: unknown name 'high'"),
    ("sim['u'] = '3kg'", "u: '3kg' is in kg; expected a value in N"),
    ("sim['n'] = 2.5", "'n' is set to 2.5; expected a whole number"),
    ("sim['on'] = 2", "'on' is set to 2; expected True or False"),
    ("sim.step(0)", "the step is 0; expected a positive number of seconds"),
    ("sim.step(-0.1)", "the step is -0.1; expected"),
    ("sim.step(np.inf)", "the step is inf; expected"),
    ("sim.step('1m')", "the step: '1m' is in m; expected a value in s"),
    ("sim.restore(3)", "3 is not a saved state; expected the result of save()"),
    ("sim.reset(y=1)", "'y' is not a variable of NoisyInSession"),
    ("sim.restore(other.save())", "the state is of another FMU than NoisyInSession"),
]


@BOTH
def test_mistakes(archive, lagrange_fmu):  # noqa: F811
    """Each mistake raises a Problem, after which the simulation continues."""
    with lagrange_fmu.start(archive("NoisyInSession")) as sim, lagrange_fmu.start(archive("PushedInSession")) as other:
        for code, message in WRONG:
            with pytest.raises(lagrange_fmu.Problem) as problem:
                exec(code, {"sim": sim, "other": other, "np": np})
            assert str(problem.value).startswith(message), problem.value
        for function in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(lagrange_fmu.Problem, match="can be neither copied nor pickled; expected its save"):
                function(sim)
        assert dict(sim)["n"] == 2
        sim.step(0.1)
        with pytest.raises(lagrange_fmu.Problem, match="^PushedInSession does not take -1 for 'm': .*min"):
            other["m"] = -1
    for code in ("sim['u']", "sim['u'] = 1", "sim.step(1)", "sim.save()", "sim.restore(None)", "sim.reset()", "sim.__enter__()"):
        with pytest.raises(lagrange_fmu.Problem, match=r"the simulation of NoisyInSession is closed; expected lagrange_fmu.start\(...\) again"):
            exec(code, {"sim": sim})
    sim.close()  # closing twice has no effect
    assert repr(sim) == "<closed simulation of NoisyInSession at 0.1 s>"


@BOTH
def test_mistakes_at_the_start(archive, lagrange_fmu, tmp_path):  # noqa: F811
    for words, message in (
        ({"start_values": 3}, "start_values is a int; expected a dict of numbers by name"),
        ({"start_values": {"mm": 1}}, "'mm' is not a variable of PushedInSession"),
        ({"start_value": {"m": 1}}, "'start_value' is not an argument of start; did you mean 'start_values'?"),
        ({"tolerence": 1e-6}, "'tolerence' is not a variable of PushedInSession; did you mean 'tolerance'?"),
        ({"q": 1}, "'q' is not a variable of PushedInSession"),
        ({"m": "2m"}, "m: '2m' is in m; expected a value in kg"),
        ({"m": -1}, "PushedInSession cannot start: .*'m'"),
        ({"m": [1, 2]}, "'m' is set to .1, 2.; expected a finite number"),
        ({"tolerance": "fine"}, "tolerance is 'fine'; expected a number"),
        ({"fmi": 3}, "is an FMU, whose solver"),
    ):
        with pytest.raises(lagrange_fmu.Problem, match=message):
            lagrange_fmu.start(archive("PushedInSession"), **words)
    with lagrange_fmu.start(archive("PushedInSession"), start_values={"m": 3.0}) as sim:
        assert sim["m"] == 3.0
    with pytest.raises(lagrange_fmu.Problem, match="there is no file"):
        lagrange_fmu.start(tmp_path / "nothing.fmu")


def test_many_simulations_leave_nothing(lagrange_fmu, tmp_path, monkeypatch):  # noqa: F811
    """Simulations that are closed, garbage-collected, or fail to start leave no files."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    path = fmu.archive("PushedInSession")
    for k in range(20):
        sim = lagrange_fmu.start(path, m=1 + k)
        sim.step(0.1)
        if k % 2:
            sim.close()
    with pytest.raises(lagrange_fmu.Problem):
        lagrange_fmu.start(path, m=-1)
    del sim
    gc.collect()
    assert list(tmp_path.iterdir()) == []


def example(beginning):
    """Code of the README of the package, with the built FMU in place of the system."""
    [code] = [code for code in EXAMPLES if beginning in code]
    return code.replace('"Cart.xml"', repr(str(fmu.archive("Cart"))))


def test_the_example_balances(lagrange_fmu, capsys):  # noqa: F811
    """Linearized and without friction, M l theta'' = ((M + m) g - 20) theta - 4 omega, which is stable, since (M + m) g = 10.8 N."""
    variables = {"lagrange_fmu": lagrange_fmu}
    exec(example("while sim.time < 2"), variables)
    assert capsys.readouterr().out == "[0.1 0. ]\n" and variables["state"].time == pytest.approx(2)
    with lagrange_fmu.start(fmu.archive("Cart")) as sim:
        sim.restore(variables["state"])
        assert abs(sim["theta"]) < 0.01


def test_the_environment_for_learning(lagrange_fmu):  # noqa: F811
    """The environment passes the checks of Gymnasium, such as equal observations for equal seeds and actions."""
    pytest.importorskip("gymnasium")
    from gymnasium.utils.env_checker import check_env

    variables = {}
    exec(example("gymnasium.Env"), variables)
    environment = variables["CartPole"]()
    check_env(environment, skip_render_check=True)
    observed, _ = environment.reset(seed=3)
    assert abs(observed[2]) < 0.1
    steps = 0
    while not environment.step(np.array([0.0]))[2]:
        steps += 1
    assert 10 < steps < 200  # it falls
    environment.close()


def test_the_examples_of_rest_and_responses(lagrange_fmu, monkeypatch, tmp_path):  # noqa: F811
    """The pendulum hangs at rest with its bob at 0.3 m, and so the cart, on which no force acts, is at x = 0.3 m."""
    monkeypatch.chdir(tmp_path)
    variables = {"lagrange_fmu": lagrange_fmu}
    exec(example("rest = "), variables)
    rest, motion = variables["rest"], variables["motion"]
    assert rest.point["theta"] == pytest.approx(np.pi, rel=1e-12) and rest.point["x"] == pytest.approx(0.3, rel=1e-12)
    np.testing.assert_allclose(motion["xBob"], 0.3, rtol=1e-9)
    exec(example("linear.poles()"), variables)
    assert (tmp_path / "step.png").exists() and abs(variables["bode"]["theta", "F"]).max() > 0


def test_the_example_of_states_in_sympy(lagrange_fmu, tmp_path, monkeypatch):  # noqa: F811
    """A cart of mass m on an actuator with lag: the system that lagc reads has four states."""
    import sympy
    from sympy.physics import mechanics

    monkeypatch.chdir(tmp_path)
    N, cart, x, F = mechanics.ReferenceFrame("N"), mechanics.Point("cart"), *mechanics.dynamicsymbols("x F")
    cart.set_vel(N, x.diff() * N.x)
    m, k, ki, T, x0 = sympy.symbols("m k ki T x0")
    method = mechanics.LagrangesMethod(m * x.diff() ** 2 / 2, [x], forcelist=[(cart, F * N.x)], frame=N)
    names = {"lagrange_fmu": lagrange_fmu, "dynamicsymbols": mechanics.dynamicsymbols, "method": method, "x": x, "m": m, "k": k, "ki": ki, "T": T, "x0": x0}
    exec(example('"Servo.xml"'), names)
    assert lagrange_fmu.check(tmp_path / "Servo.xml").startswith("Servo: 4 states, 0 inputs")
