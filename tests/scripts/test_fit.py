"""
Sensitivities of motions, and fits to measurements, by the package: against closed forms, and synthetic data with known values and noise.
"""

import math
import pickle
import re
import subprocess
import warnings
from xml.etree import ElementTree

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.stats import truncnorm

import fmu
import package
from building import build_systems
from motions import BALL, BELT, OSCILLATOR, STIFF, WORKED, allow_calls, belt, bounce, creep, lagrange_fmu, measured, oscillation, slopes, work  # noqa: F401

TOLERATED = dict(rel=1e-8, abs=1e-9)
TWO = """<system name="Two"><for index="i" from="1" to="2"><coordinate name="h[i]" velocity="v[i]" unit="m" start="1"/>
  <particle name="p[i]" mass="1" y="h[i]"/><contact name="floor[i]" gap="h[i]" unit="m" restitution="0.5"/></for><gravity y="-9.81"/></system>"""

LATE = """<system name="Late"><parameter name="F" start="3" unit="N"/><parameter name="begin" start="0.5" unit="s"/><coordinate name="x" velocity="v" unit="m"/>
  <particle mass="1" x="x"/><force coordinate="x">if(time > begin, F, 0)</force></system>"""
WALLED = """<system name="Walled"><parameter name="l" start="1" unit="m"/><parameter name="e" start="0.5" unit="1"/>
  <coordinate name="x" velocity="vx" unit="m" start="1"/><coordinate name="y" velocity="vy" unit="m"/><particle mass="1" x="x" y="y"/><gravity y="-9.81"/>
  <constraint name="rod" unit="m">sqrt(x^2 + y^2) - l</constraint><contact name="wall" gap="x + 0.2*l" unit="m" restitution="e"/></system>"""
OFF = (fmu.ROOT / "fmu" / "PendulumCartesian" / "system.xml").read_text().replace('"PendulumCartesian"', '"Off"').replace('start="-1"', 'start="0.72"').replace('name="y"', 'name="y" start="-0.96"')
NOTED = """<system name="Noted"><parameter name="w" start="1"/><coordinate name="x" velocity="v" start="1"/><mode name="fastest" start="0"/><particle mass="1" x="x"/>
  <potential>w^2*x^2/2</potential><event when="x" direction="falling"><set mode="fastest">v</set></event></system>"""
SUM = """<system name="Sum"><parameter name="p" start="1" unit="N"/><parameter name="r" start="0" unit="N"/><parameter name="tiny" start="0" unit="1"/>
  <coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/><force coordinate="x">p + r + tiny*1e9</force></system>"""
LEAST = """<system name="Least"><parameter name="p" start="1" unit="N" min="0"/><coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/><force coordinate="x">p</force></system>"""
DISK = """<system name="Disk"><parameter name="T" start="2" unit="N.m"/><coordinate name="phi" velocity="w" unit="rad"/><kinetic>w^2/2</kinetic><force coordinate="phi">T</force></system>"""
RUBBED = """<system name="Rubbed"><parameter name="F" start="1" unit="N" min="0"/><parameter name="d" start="0.2" unit="N.s2/m2" min="0"/><input name="u" unit="N"/>
  <coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/><friction name="rub" coordinate="x" force="F"/><force coordinate="x">u - d*v*abs(v)</force></system>"""
ROOT = """<system name="Root"><parameter name="k" start="6"/><parameter name="r" start="4"/><coordinate name="x" velocity="v" velocityStart="1"/>
  <particle mass="1" x="x"/><force coordinate="x">k*sqrt(r - x) - 4*x</force></system>"""
RELEASED = WALLED.replace('"Walled"', '"Released"').replace('unit="m"/><particle', 'unit="m" start="-0.7*l"/><particle')


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("fitted", {"Sum": SUM, "Least": LEAST, "Disk": DISK, "Rubbed": RUBBED, "Noted": NOTED, "Released": RELEASED, "Off": OFF, "Two": TWO, "Oscillator": OSCILLATOR, "Ball": BALL, "Belt": BELT, "Late": LATE, "Walled": WALLED, "Worked": WORKED, "Stiff": STIFF, "Root": ROOT})


def test_a_fit_whose_first_motion_fails(lagrange_fmu):
    """x reaches r, beyond which the root does not exist: the message has the time, and nothing was found so far."""
    data = np.array([(t, 0.3 * np.sin(2 * t)) for t in np.linspace(0, 3, 31)], dtype=[("time", float), ("x", float)])
    with pytest.raises(lagrange_fmu.Problem, match="the motion with the initial values cannot be computed"):
        lagrange_fmu.fit(fmu.archive("Root"), data, ["k", "r"], {"r": 0.1, "k": 6})


def test_derivatives_of_an_oscillation(lagrange_fmu):
    """Derivatives by parameters, a start value and a constant input agree with the closed form."""
    at = {"m": 2.0, "k": 50.0, "d": 1.0, "x": 0.3, "F": 4.0}
    found = lagrange_fmu.sensitivities(fmu.archive("Oscillator"), ["x", "der(v)"], list(at), [0, 0.7, 2, 4], {"F": 4.0})
    with mpmath.workdps(40):
        for i, t in enumerate(found.time):
            for place, name in enumerate(at):
                along = lambda value: oscillation(t, *[value if k == place else mpmath.mpf(v) for k, v in enumerate(at.values())])
                assert found.derivatives["x", name][i] == pytest.approx(float(mpmath.diff(along, at[name])), **TOLERATED)
    # m a = F - k x - d v at the start.
    assert found.derivatives["der(v)", "k"][0] == pytest.approx(-0.3 / 2, rel=1e-12)


def test_derivatives_of_a_state_that_is_no_output(lagrange_fmu):
    """The state is the work, alone and beside an output."""
    at = {"m": 2.0, "k": 50.0, "d": 1.0, "x": 0.3, "F": 4.0}
    expected = slopes(lambda *values: work(2, *values), at)
    for of in (["nonConservativeWork"], ["x", "nonConservativeWork"]):
        found = lagrange_fmu.sensitivities(fmu.archive("Worked"), of, list(at), [2], {"F": 4.0})
        assert {name: found.derivatives["nonConservativeWork", name][0] for name in at} == pytest.approx(expected, **TOLERATED)


def test_derivatives_of_a_stiff_motion(lagrange_fmu, monkeypatch):
    """The motion is integrated by Radau's method; an explicit one would take 400,000 steps."""
    from lagrange_fmu.sensitivity import DifferentiableMotion

    allow_calls(monkeypatch, DifferentiableMotion, "rates", 20000)
    at = {"m": 2.0, "k": 50.0, "d": 1e6, "x": 0.3}
    found = lagrange_fmu.sensitivities(fmu.archive("Stiff"), ["x"], list(at), [0.5, 2.0])
    for i, t in enumerate(found.time):
        expected = slopes(lambda *values: creep(mpmath.mpf(t), *values), at)
        assert {name: found.derivatives["x", name][i] for name in at} == pytest.approx(expected, rel=1e-7, abs=1e-11)


@pytest.mark.parametrize("name", ["SimplePendulum", "PendulumCartesian"])
def test_derivative_of_a_pendulum(lagrange_fmu, name):
    """The derivative by its length, also through a constraint, which changes the start."""
    g = fmu.start_values(name)["g"]
    with mpmath.workdps(40):
        if name == "SimplePendulum":
            start, of, place = {"theta": 1.0}, "theta", lambda angle, l: angle
        else:
            start, of, place = {"x": 0.6, "y": -0.8}, "x", lambda angle, l: l * mpmath.sin(angle)
        angle = mpmath.mpf(1) if name == "SimplePendulum" else mpmath.atan2(mpmath.mpf(3), 4)

        def along(l):
            k = mpmath.sin(angle / 2)
            return place(2 * mpmath.asin(k * mpmath.ellipfun("cd", mpmath.sqrt(mpmath.mpf(g) / l) * 3, m=k * k)), l)

        expected = float(mpmath.diff(along, 1))
    found = lagrange_fmu.sensitivities(fmu.archive(name), [of], ["l"], [0, 3], start | {"l": 1.0})
    assert found.derivatives[of, "l"][1] == pytest.approx(expected, rel=1e-7)


def test_derivatives_through_impacts(lagrange_fmu):
    """Derivatives of a bouncing ball by its start, g and e agree with closed forms, between all bounces and after them."""
    at = {"h": 1.3, "g": 9.81, "e": 0.7}
    fall = math.sqrt(2 * 1.3 / 9.81)
    times = [0.0, 0.4, fall + 0.3, fall + 2 * 0.7 * fall + 0.2, fall + 2 * (0.7 + 0.49) * fall + 0.1]
    found = lagrange_fmu.sensitivities(fmu.archive("Ball"), ["h"], list(at), times, at)
    with mpmath.workdps(40):
        for i, t in enumerate(times):
            for place, name in enumerate(at):
                along = lambda value: bounce(mpmath.mpf(t), *[value if k == place else mpmath.mpf(v) for k, v in enumerate(at.values())], [0, 0, 1, 2, 3][i])
                assert found.derivatives["h", name][i] == pytest.approx(float(mpmath.diff(along, at[name])), rel=1e-7, abs=1e-9), (t, name)


def test_events_at_once(lagrange_fmu):
    """Two balls land together; for changed values they land one after the other, in either order, so that there is no derivative."""
    with pytest.raises(lagrange_fmu.Problem, match="several events coincide at 0.45"):
        lagrange_fmu.sensitivities(fmu.archive("Two"), ["h[1]"], ["h[1]"], [0, 1])
    apart = lagrange_fmu.sensitivities(fmu.archive("Two"), ["h[1]", "h[2]"], ["h[1]"], [0, 0.7], {"h[2]": 1.1})
    assert apart.derivatives["h[2]", "h[1]"][1] == pytest.approx(0, abs=1e-9)


def test_derivatives_at_events(lagrange_fmu):
    """
    A ball starts on the ground, below which no start is valid. A time is that of an impact; another is one at which changed values give another kind of motion.
    """
    ball, values = fmu.archive("Ball"), {"h": 0.0, "v": 1.0}
    found = lagrange_fmu.sensitivities(ball, ["h"], ["h", "e"], [0.3], values)

    def height(h, e):  # after the first bounce
        speed = mpmath.sqrt(1 + 2 * 9.81 * h)
        rest = mpmath.mpf(0.3) - (1 + speed) / 9.81
        return e * speed * rest - 9.81 / 2 * rest**2

    expected = slopes(height, {"h": 0.0, "e": 0.5})
    assert {name: found.derivatives["h", name][0] for name in expected} == pytest.approx(expected, rel=1e-7)
    impact = math.sqrt(2 / 9.81)
    before = lagrange_fmu.sensitivities(ball, ["v"], ["h", "g"], [impact])
    assert [before.derivatives["v", name][0] for name in ("h", "g")] == pytest.approx([0, -impact], rel=1e-9, abs=1e-9)
    assert lagrange_fmu.sensitivities(ball, ["h"], ["h"], [0.7], {"e": 0.0}).derivatives["h", "h"][0] == pytest.approx(0, abs=1e-9)
    for by, values, why in (("e", {"e": 0.0}, "leads some neighbouring motions into other modes, of 'floor.closed', .* by e through it"),
                            ("v", {"h": 0.0}, "no derivative by 'v' at 0: from neighbouring values floor.closed starts in another mode"), ("h", {"h": -1.0}, "contact 'floor' is penetrated")):  # fmt: skip
        with pytest.raises(lagrange_fmu.Problem, match=why):
            lagrange_fmu.sensitivities(ball, ["h"], [by], [0.7], values)
    with pytest.raises(lagrange_fmu.Problem, match="contact 'floor' is penetrated"):
        lagrange_fmu.simulate(ball, {"h": -1.0})


def test_a_mode_with_a_number(lagrange_fmu):
    with pytest.raises(lagrange_fmu.Problem, match="sets 'fastest' to numbers that vary between neighbouring motions"):
        lagrange_fmu.sensitivities(fmu.archive("Noted"), ["x"], ["w"], [3.0])


def test_where_it_switches(lagrange_fmu):
    """The derivative by the time at which a force begins exists, except where that is the start."""
    found = lagrange_fmu.sensitivities(fmu.archive("Late"), ["x"], ["begin"], [0.4, 1.0])
    assert found.derivatives["x", "begin"] == pytest.approx([0, -3 * 0.5], rel=1e-9)
    with pytest.raises(lagrange_fmu.Problem, match="no derivative by 'begin' at 0"):
        lagrange_fmu.sensitivities(fmu.archive("Late"), ["x"], ["begin"], [1.0], {"begin": 0.0})


@pytest.mark.parametrize("name, off, start", [("PendulumCartesian", 1.0, {"x": 0.6, "y": -0.8}), ("PendulumCartesian", 1.2, {"x": 0.72, "y": -0.96}), ("Off", 1.2, {})])
def test_starts_of_dependent_coordinates(lagrange_fmu, name, off, start):
    """The start of a pendulum in x and y is projected onto the circle; only the tangential part of its derivatives counts."""
    found = lagrange_fmu.sensitivities(fmu.archive(name), ["x"], ["x", "y", "vx"], [0.0, 1.0], start | {"l": 1.0})
    g = fmu.start_values("PendulumCartesian")["g"]
    rates = lambda t, state: [state[1], -g * np.sin(state[0]), state[3], -g * np.cos(state[0]) * state[2], state[5], -g * np.cos(state[0]) * state[4]]
    angle = np.arctan2(0.6, 0.8)
    end = solve_ivp(rates, (0, 1), [angle, 0, 1, 0, 0, 1], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    by_angle, by_rate = np.cos(end[0]) * end[2], np.cos(end[0]) * end[4]
    for by, turn in (("x", 0.8 * by_angle / off), ("y", 0.6 * by_angle / off), ("vx", 0.8 * by_rate)):
        assert found.derivatives["x", by][1] == pytest.approx(turn, rel=1e-7), by


def test_a_start_that_follows_parameters_and_is_moved(lagrange_fmu):
    """The FMU does not show the start value before the projection, so that an expected value is required."""
    with pytest.raises(lagrange_fmu.Problem, match="start value of 'y' follows from parameters, and constraints move it; expected a value"):
        lagrange_fmu.sensitivities(fmu.archive("Released"), ["x"], ["y"], [0.2], {"l": 1.1})
    lagrange_fmu.sensitivities(fmu.archive("Released"), ["x"], ["y"], [0.2], {"l": 1.1, "y": -0.77})


def test_through_a_constraint_and_an_impact(lagrange_fmu):
    """A pendulum in x and y that bounces off a wall agrees with differences of SciPy's motion by its angle."""
    at, times = {"l": 1.0, "e": 0.5, "vy": 0.0}, [0.7, 0.9]

    def place(l, e, vy):
        strikes = lambda t, state: np.sin(state[0]) + 0.2
        strikes.terminal, strikes.direction = True, -1
        rates, found = lambda t, state: [state[1], -9.81 / l * np.sin(state[0])], []
        for end in times:
            time, state = 0.0, [np.pi / 2, vy / l]
            while time < end:
                part = solve_ivp(rates, (time, end), state, method="DOP853", rtol=1e-12, atol=1e-13, events=strikes)
                time, state = part.t[-1], part.y[:, -1] * ([1, -e] if len(part.t_events[0]) else [1, 1])
            found.append(l * np.sin(state[0]))
        return np.array(found)

    found = lagrange_fmu.sensitivities(fmu.archive("Walled"), ["x"], list(at), times, at)
    for name, value in at.items():
        change = (place(**at | {name: value + 1e-4}) - place(**at | {name: value - 1e-4})) / 2e-4
        assert found.derivatives["x", name] == pytest.approx(change, rel=1e-6, abs=1e-7), name


@pytest.mark.parametrize("times", [[1, 0], [0, 1, 1], [-1, 0], [0, math.nan], [math.inf]])
def test_times(lagrange_fmu, times):
    with pytest.raises(lagrange_fmu.Problem, match="expected one at least, from 0 s on"):
        lagrange_fmu.sensitivities(fmu.archive("Oscillator"), ["x"], ["k"], times)
    with pytest.raises(lagrange_fmu.Problem, match="expected numbers, in s"):
        lagrange_fmu.sensitivities(fmu.archive("Oscillator"), ["x"], ["k"], ["a"])


def test_derivatives_through_friction(lagrange_fmu):
    """A block is carried along by a belt, sticks, and slides again."""
    at, times = {"k": 20.0, "F": 3.0, "u": 0.4}, [0.0, 0.1, 0.3, 0.6, 0.9]
    found = lagrange_fmu.sensitivities(fmu.archive("Belt"), ["x"], list(at), times, at)
    with mpmath.workdps(40):
        for i, t in enumerate(times):
            assert found.values["x"][i] == pytest.approx(float(belt([mpmath.mpf(t)], *map(mpmath.mpf, at.values()))[0]), abs=1e-8)
            for place, name in enumerate(at):
                along = lambda value: belt([mpmath.mpf(t)], *[value if k == place else mpmath.mpf(v) for k, v in enumerate(at.values())])[0]
                assert found.derivatives["x", name][i] == pytest.approx(float(mpmath.diff(along, at[name])), rel=1e-6, abs=1e-8), (t, name)


@pytest.mark.long
def test_fit(lagrange_fmu):
    """For 12 fits to data of known noise, the errors of the values are distributed as their standard deviations state."""
    truth = {"m": 1.7, "k": 61.0, "d": 0.8, "x": 0.25}
    off = []
    for seed in range(12):
        generator = np.random.default_rng(seed)
        found = lagrange_fmu.fit(fmu.archive("Oscillator"), [measured(generator, truth, F) for F in (0.0, 5.0)], list(truth))
        off.append([(found.values[name] - truth[name]) / found.deviations[name] for name in truth])
        assert found.rms["x"] == pytest.approx(1e-3, rel=0.2) and found.undetermined == []
    off = np.array(off)
    assert (abs(off) < 4).all() and 0.7 < off.std() < 1.3


def test_experiments_with_starts_of_their_own(lagrange_fmu):
    """The fit finds the start of each experiment and the shared values; the search begins at the first measured value of each."""
    starts = (0.25, -0.4, 0.1)
    data = [measured(np.random.default_rng(4), {"m": 2.0, "k": 61.0, "d": 0.8, "x": x}, noise=1e-4) for x in starts]
    found = lagrange_fmu.fit(fmu.archive("Oscillator"), data, ["k", "d"], each=["x"])
    expected = {"k": 61.0, "d": 0.8} | {f"x of experiment {i}": x for i, x in enumerate(starts, 1)}
    assert found.values.keys() == expected.keys() and found.shared == ["k", "d"]
    for name, value in expected.items():
        assert abs(found.values[name] - value) < 4 * found.deviations[name] < 1e-3 * 4 * max(1, abs(value))
    with pytest.raises(lagrange_fmu.Problem, match="'k' varies for all experiments and for each"):
        lagrange_fmu.fit(fmu.archive("Oscillator"), data, ["k"], each=["k"])


def test_bounds(lagrange_fmu):
    """A value whose optimum lies beyond its bound stays at the bound."""
    data = measured(np.random.default_rng(5), {"m": 2.0, "k": 61.0, "d": 0.8, "x": 0.3})
    found = lagrange_fmu.fit(fmu.archive("Oscillator"), data, ["k", "d"], bounds={"k": (40, 60)})
    assert found.values["k"] == pytest.approx(60, abs=1e-6)
    with pytest.raises(lagrange_fmu.Problem, match="the initial value 50 of 'k' is outside its bounds, 55 and 60"):
        lagrange_fmu.fit(fmu.archive("Oscillator"), data, ["k", "d"], bounds={"k": (55, 60)})


def test_a_value_at_its_limit(lagrange_fmu):
    """A damping of 0, its minimum, has a derivative."""
    found = lagrange_fmu.sensitivities(fmu.archive("Oscillator"), ["x"], ["d"], [0, 2], {"d": 0.0})
    with mpmath.workdps(40):
        expected = float(mpmath.diff(lambda d: oscillation(2, 2, 50, d, mpmath.mpf(0.3)), 0))
    assert found.derivatives["x", "d"][1] == pytest.approx(expected, **TOLERATED)


def test_inputs_with_kinks(lagrange_fmu):
    """The force has kinks between the rows; another solver provides the motion."""
    rows = 41
    times = np.linspace(0, 4, rows)
    force = np.interp(times, [0, 1, 1.5, 2.5, 4], [0, 6, -3, -3, 5])
    rates = lambda t, state: [state[1], (np.interp(t, times, force) - 61 * state[0] - 0.8 * state[1]) / 2]
    motion = solve_ivp(rates, (0, 4), [0.3, 0.0], t_eval=times, rtol=1e-9, atol=1e-10, max_step=0.02)
    data = np.rec.fromarrays([times, motion.y[0], force], names="time,x,F").view(np.ndarray)
    found = lagrange_fmu.fit(fmu.archive("Oscillator"), data, ["k", "d", "m"])
    assert [found.values[name] for name in ("k", "d", "m")] == pytest.approx([61, 0.8, 2], rel=1e-4)


def test_undetermined_values(lagrange_fmu):
    """Without a force, mass, stiffness and damping are determined up to a common factor only."""
    truth = {"m": 1.7, "k": 61.0, "d": 0.8, "x": 0.25}
    found = lagrange_fmu.fit(fmu.archive("Oscillator"), measured(np.random.default_rng(1), truth), ["m", "k", "d", "x"])
    assert [set(shares) for shares in found.undetermined] == [{"m", "k", "d"}]
    assert np.isinf(found.deviations["m"]) and found.deviations["x"] < 1e-3
    assert found.values["k"] / found.values["m"] == pytest.approx(61 / 1.7, rel=1e-3)


def line(rows=41, slope=5.0, noise=1e-3, seed=0):
    """Measurements of a body of 1 kg moved by a force of 5 N: x = F t^2/2."""
    times = np.linspace(0, 2, rows)
    x = slope * times**2 / 2 + noise * np.random.default_rng(seed).standard_normal(rows)
    return np.rec.fromarrays([times, x], names="time,x").view(np.ndarray)


def test_only_a_sum_is_known(lagrange_fmu):
    """Only the sum of two forces is determined. Alone, one has the standard deviation sigma/|t^2/2| of linear regression, in any unit."""
    data = line()
    both = lagrange_fmu.fit(fmu.archive("Sum"), data, ["p", "r", "tiny"], noise={"x": 1e-3})
    assert {frozenset(shares) for shares in both.undetermined} <= {frozenset(pair) for pair in (("p", "r"), ("p", "tiny"), ("r", "tiny"))} and len(both.undetermined) == 2
    assert all(np.isinf(deviation) for deviation in both.deviations.values())
    alone = lagrange_fmu.fit(fmu.archive("Sum"), data, ["p"], noise={"x": 1e-3})
    expected = 1e-3 / np.linalg.norm(data["time"] ** 2 / 2)
    assert alone.deviations["p"] == pytest.approx(expected, rel=1e-6)
    tiny = lagrange_fmu.fit(fmu.archive("Sum"), data, ["tiny"], noise={"x": 1e-3})
    assert tiny.deviations["tiny"] == pytest.approx(1e-9 * expected, rel=1e-6)


def test_fewer_numbers_than_values(lagrange_fmu):
    found = lagrange_fmu.fit(fmu.archive("Oscillator"), measured(np.random.default_rng(0), {"m": 2.0, "k": 61.0, "d": 0.8, "x": 0.3})[[0, 20]], ["m", "k", "d", "x"])
    assert all(np.isinf(deviation) for deviation in found.deviations.values()) and "the deviations are unknown" in str(found)


def test_far_above_the_noise(lagrange_fmu):
    """A residual far above the stated noise gives a warning, and deviations are computed from the residual."""
    with pytest.warns(UserWarning, match="the residual of x is [0-9.]+ times its stated noise"):
        found = lagrange_fmu.fit(fmu.archive("Sum"), line(), ["p"], noise={"x": 1e-5})
    assert "misfit: the residual of x" in str(found)
    assert found.deviations["p"] == pytest.approx(1e-3 / np.linalg.norm(line()["time"] ** 2 / 2), rel=0.4)


def test_at_a_limit(lagrange_fmu):
    """A value whose optimum lies below its minimum has a one-sided interval: that of the normal distribution truncated at the minimum."""
    data = line(slope=-1e-4)
    found = lagrange_fmu.fit(fmu.archive("Least"), data, ["p"], noise={"x": 1e-3})
    squares = data["time"] ** 2 / 2
    mean, deviation = data["x"] @ squares / (squares @ squares), 1e-3 / np.linalg.norm(squares)
    end = truncnorm(-mean / deviation, np.inf, loc=mean, scale=deviation).ppf(0.95)
    assert mean < 0 and found.at_limit == ("p",) and found.values["p"] == 0
    assert found.intervals["p"] == pytest.approx((0, end), rel=1e-2) and found.deviations["p"] == pytest.approx(deviation, rel=1e-6)


def test_outliers(lagrange_fmu):
    data = line()
    data["x"][::8] += 0.5
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        off = {loss: abs(lagrange_fmu.fit(fmu.archive("Sum"), data, ["p"], start_values={"r": 2.0}, noise={"x": 1e-3}, loss=loss).values["p"] - 3) for loss in ("linear", "cauchy")}
    assert off["cauchy"] < 3e-3 < 3e-2 < off["linear"]
    for loss, noise, why in (("cubic", {"x": 1.0}, "expected one of linear, soft_l1, huber, cauchy"), ("huber", {}, "expected the noise")):
        with pytest.raises(lagrange_fmu.Problem, match=why):
            lagrange_fmu.fit(fmu.archive("Sum"), data, ["p"], noise=noise, loss=loss)


def test_angles_that_wrap(lagrange_fmu):
    """A disk makes three revolutions; the data are within -pi and pi."""
    times = np.linspace(0, 4, 81)
    angle = 0.5 * 2.4 * times**2
    data = np.rec.fromarrays([times, np.angle(np.exp(1j * angle))], names="time,phi").view(np.ndarray)
    found = lagrange_fmu.fit(fmu.archive("Disk"), data, ["T"])
    assert found.values["T"] == pytest.approx(2.4, rel=1e-7) and "'phi' jumps by a turn" in str(found)


@pytest.mark.parametrize("start", [0.0, 2.0])
def test_friction_without_derivatives(lagrange_fmu, start):
    """A block with friction and quadratic drag under a measured force, from rest or moving: the search ends at the values of the data."""
    times = np.linspace(0, 3, 61)
    force = 4 * np.sin(3 * times)
    speed, speeds, span, steps = start, [start], 1e-5, 5000
    for u in np.interp(np.arange(60 * steps) * span, times, force).reshape(60, steps):
        for push in u:  # friction of 1.2 N reduces the speed, at most to 0
            speed += span * (push - 0.3 * speed * abs(speed))
            speed = np.sign(speed) * max(abs(speed) - span * 1.2, 0.0)
        speeds.append(speed)
    data = np.rec.fromarrays([times, speeds, force], names="time,v,u").view(np.ndarray)
    found = lagrange_fmu.fit(fmu.archive("Rubbed"), data, ["F", "d", "v"], start_values={"v": start, "F": 0.8, "d": 0.1})
    assert found.is_finished and [found.values[name] for name in ("F", "d")] == pytest.approx([1.2, 0.3], rel=2e-3)


def test_best_values_are_kept(lagrange_fmu, monkeypatch):
    """A failing trial is a rejected step; Ctrl-C ends the search with the best values so far."""
    from lagrange_fmu.sensitivity import DifferentiableMotion
    from lagrange_fmu.variational import SteppedMotion

    follow, count = DifferentiableMotion.over, []

    def over(self, *arguments):
        count.append(1)
        if len(count) == 2:
            raise lagrange_fmu.Problem("cannot continue")
        return follow(self, *arguments)

    def fail(self, *arguments):
        raise lagrange_fmu.Problem("cannot continue")

    data = measured(np.random.default_rng(5), {"m": 2.0, "k": 61.0, "d": 0.8, "x": 0.3})
    with monkeypatch.context() as patch:
        patch.setattr(DifferentiableMotion, "over", over)
        patch.setattr(SteppedMotion, "over", fail)
        found = lagrange_fmu.fit(fmu.archive("Oscillator"), data, ["k", "d"])
    assert found.is_finished and found.values["k"] == pytest.approx(61, abs=0.3) and "1 of " in str(found)

    def stop(self, *arguments):
        count.append(1)
        if len(count) == 3:
            raise KeyboardInterrupt
        return follow(self, *arguments)

    count.clear()
    monkeypatch.setattr(DifferentiableMotion, "over", stop)
    found = lagrange_fmu.fit(fmu.archive("Oscillator"), data, ["k", "d"])
    assert not found.is_finished and "stopped after 3 motions" in repr(found) and 50 < found.values["k"] < 70


def test_command(tmp_path):
    """The command writes a page with a picture, and a system with the fitted values that lagc reads; comments are kept."""
    folder = package.assemble(tmp_path / "package")
    truth = {"m": 2.0, "k": 61.0, "d": 0.8, "x": 0.3}
    data = measured(np.random.default_rng(2), truth)
    np.savetxt(tmp_path / "data.csv", np.stack([data["time"], data["x"]], axis=1), delimiter=",", header="time,x", comments="")
    result = package.run(folder, "fit", fmu.archive("Oscillator"), "data.csv", "--vary", "k", "d", "--bounds", "k=20:100", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert re.search(r"^k  (61\.0|60\.9)\d+ \+- 0\.0\d+$", result.stdout, re.M)
    page = (tmp_path / "out" / "Oscillator-fit.html").read_text()
    assert "data:image/png" in page and "95 % interval" in page
    rejected = package.run(folder, "fit", fmu.archive("Oscillator"), "data.csv", "--vary", "kk", cwd=tmp_path)
    assert rejected.returncode == 1 and "'kk' is not a parameter, a start value or an input" in rejected.stderr


def test_the_fitted_system(lagrange_fmu, tmp_path):
    from lagrange_fmu.fit_result import Fit

    (tmp_path / "system.xml").write_text(OSCILLATOR)
    fit = Fit({"k": 61.5, "v": -2.0, "x": 0.25}, {}, {}, None, [], [], [], {}, "Oscillator", tmp_path / "system.xml", ["k", "v", "x"])
    fit.write_system(tmp_path / "fitted.xml")
    text = (tmp_path / "fitted.xml").read_text()
    assert "<!-- kept -->" in text
    subprocess.run([fmu.LAGC, tmp_path / "fitted.xml", "-o", tmp_path / "out"], check=True)
    starts = {v.get("name"): v[0].get("start") for v in ElementTree.parse(tmp_path / "out" / "modelDescription.xml").iterfind("ModelVariables/ScalarVariable")}
    assert [starts[name] for name in ("k", "v", "x", "m")] == ["61.5", "-2", "0.25", "2"]


def test_pickled_motions(lagrange_fmu):
    """Pickled motions, and slices of them, keep their description and start values."""
    motion = lagrange_fmu.simulate(fmu.archive("Oscillator"), {"x": 0.2}, stop_time=0.5)
    for part in (motion, motion[3:]):
        back = pickle.loads(pickle.dumps(part))
        assert (back == part).all() and back.description.modelName == "Oscillator" and back.motion.start["x"] == 0.2
