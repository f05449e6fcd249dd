"""Variational equations in the FMU's own solver (lagc --along): against closed forms, and in fits."""

import subprocess

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fmu
from building import BUILD, archive_of, build_systems
from motions import BALL, BELT, DOUBLE, DOUBLE_AT, OSCILLATOR, WORKED, belt, bounce, energy_of_double, lagrange_fmu, oscillation, slopes, small_bounces, work  # noqa: F401

pytestmark = pytest.mark.long

AT = {"m": 2.0, "k": 50.0, "d": 1.0, "x": 0.3, "F": 4.0}
FITTED = ["m", "k", "d", "x"]
# A damper that is stiff for some time, during which x creeps.
TURNING = """<system name="Turning"><parameter name="k" start="40" unit="N/m"/><parameter name="c" start="1e5" unit="N.s/m"/><constant name="second" value="1" unit="s"/>
  <coordinate name="x" velocity="v" unit="m" start="1"/><particle mass="1" x="x"/><potential>k*x^2/2</potential>
  <dissipation>c*exp(-((time/second - 1.5)/0.3)^8)*v^2/2</dissipation></system>"""
CONSTRAINED = """<system name="Held"><parameter name="l" start="1" unit="m"/><parameter name="g" start="9.81" unit="m/s2"/>
  <coordinate name="x" velocity="vx" unit="m" start="0.6"/><coordinate name="y" velocity="vy" unit="m" start="-0.8"/><particle mass="2" x="x" y="y"/><gravity y="-g"/>
  <constraint name="rod" unit="m">sqrt(x^2 + y^2) - l</constraint><output name="pull" unit="N">rod.force</output></system>"""
CONSTRAINED_TWICE = CONSTRAINED.replace('"Held"', '"Twice"').replace("</system>", '<constraint name="again" unit="m2">x^2 + y^2 - l^2</constraint></system>')
CONSTRAINED_BY = ["l", "g", "x", "vx"]
# Four-bar linkages of equal rods, which pass a flat position.
FLAT = (fmu.ROOT / "fmu" / "NFourBar" / "system.xml").read_text().replace('"NFourBar"', '"Flat"').replace('name="N" value="40"', 'name="N" value="3"')
# A block thrown onto a slope slides up and down, with friction proportional to a contact force.
SLOPE = """<system name="Slope"><parameter name="mu" start="0.2"/><parameter name="g" start="9.81" unit="m/s2"/><parameter name="e" start="0.4"/>
  <coordinate name="s" velocity="u" unit="m" velocityStart="3"/><coordinate name="n" velocity="w" unit="m"/><particle mass="1" x="s" y="n"/><gravity x="-0.6*g" y="-0.8*g"/>
  <contact name="floor" gap="n" unit="m"/><contact name="wall" gap="0.4 - s" unit="m" restitution="e"/>
  <friction name="rub" velocity="u" force="mu*floor.force"/></system>"""
# The same with a constraint in place of the contact; a change of l violates it, which causes a projection.
RAMP = """<system name="Ramp"><parameter name="mu" start="0.2"/><parameter name="g" start="9.81" unit="m/s2"/><parameter name="e" start="0.4"/><parameter name="l" start="0.1" unit="m"/>
  <coordinate name="x" velocity="vx" unit="m" velocityStart="2.4"/><coordinate name="y" velocity="vy" unit="m" velocityStart="1.8"/><particle mass="1" x="x" y="y"/><gravity y="-g"/>
  <constraint name="ramp" unit="m">0.8*y - 0.6*x - 0.8*l</constraint><contact name="wall" gap="0.4 - x" unit="m" restitution="e"/>
  <friction name="rub" velocity="0.8*vx + 0.6*vy" force="mu*abs(ramp.force)"/></system>"""
# Water that rises to a weir and over it, where the root of the flow begins.
WEIR = """<system name="Weir"><parameter name="q" start="0.1"/><parameter name="k" start="0.5"/><state name="h" start="0.5" rate="q - k*sqrt(max(0, h - 1))"/></system>"""
# A sampled controller that stores its output.
HOLD = """<system name="{name}"><parameter name="K" start="2"/><coordinate name="x" velocity="v" start="1"/>{store}<particle mass="1" x="x"/><force coordinate="x">u</force>
  <sample every="0.1"><set {kind}="u">-K*x - 2*v</set></sample></system>"""
SWITCHED = {"Ramp": (RAMP, ["mu", "g", "e", "l"]), "Slope": (SLOPE, ["mu", "g", "e", "u"]), "Ball": (BALL, ["h", "g", "e"]), "Belt": (BELT, ["k", "F", "u"]), "Weir": (WEIR, ["q", "k"]),
            "Held1": (HOLD.format(name="Held1", store='<state name="u" rate="0"/>', kind="state"), ["K"]), "Held2": (HOLD.format(name="Held2", store='<mode name="u"/>', kind="mode"), ["K"])}
SYSTEMS = {"Oscillator": (OSCILLATOR, AT), "Fitted": (OSCILLATOR, FITTED), "Double": (DOUBLE, DOUBLE_AT), "Turning": (TURNING, ["k", "c", "x"]),
           "Worked": (WORKED, list(AT)), "Held": (CONSTRAINED, CONSTRAINED_BY), "Twice": (CONSTRAINED_TWICE, CONSTRAINED_BY), "Flat": (FLAT, ["g"])}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def built():
    for name, (text, by) in SYSTEMS.items():
        build_systems(f"variational_{name}", {name: text.replace('name="Oscillator"', f'name="{name}"')}, *(word for value in by for word in ("--along", value)))


    build_systems("variational_switched", {name: text for name, (text, _) in SWITCHED.items()} | {"Flat": FLAT})
    for name, (text, by) in SWITCHED.items():
        build_systems(f"variational_{name}", {name: text}, *(word for value in by for word in ("--along", value)), versions=(3,))


def archive(name):
    return archive_of(BUILD / f"variational_{name}", name)


def motion(name, of, by, times, start=None):
    """Values and derivatives at the times."""
    from lagrange_fmu.model_exchange import opened
    from lagrange_fmu.variational import SeriesMotion

    with opened(archive(name), start or {}, by=by) as point:
        return SeriesMotion(point, of, by, 1e-11).over(np.array(times))


def test_an_oscillation(lagrange_fmu):  # noqa: F811
    """Derivatives of a state and of its second derivative, by parameters, a start value and a constant input."""
    times = [0.0, 0.7, 4.0]
    values, derivatives = motion("Oscillator", ["x", "der(v)"], list(AT), times, {"F": 4.0})
    for i, t in enumerate(times):
        assert values[i, 0] == pytest.approx(float(oscillation(t, *AT.values())), rel=1e-10)
        assert dict(zip(AT, derivatives[i, 0])) == pytest.approx(slopes(lambda *at: oscillation(mpmath.mpf(t), *at), AT), rel=1e-9, abs=1e-12)
    assert derivatives[0, 1, 1] == pytest.approx(-0.3 / 2, rel=1e-12)  # m a = F - k x - d v at the start


def motion_through_events(name, of, times, start, monkeypatch, ways):
    """Values and derivatives at the times. `ways` receives the times from which SciPy continues where the series cannot."""
    from lagrange_fmu.event_motion import EventMotion
    from lagrange_fmu.model_exchange import opened
    from lagrange_fmu.sensitivity import DifferentiableMotion

    by, continue_to = SWITCHED[name][1], DifferentiableMotion.continue_to
    monkeypatch.setattr(EventMotion, "continue_to", lambda self, begin, *words: ways.append(begin) or continue_to(self, begin, *words))
    with opened(archive_of(BUILD / "variational_switched", name), start) as point, opened(archive_of(BUILD / f"variational_{name}", name, 3), start, by=by, stops_at_events=True) as point.in_series:
        return EventMotion(point, of, by, 1e-11).over(np.array(times))


def test_through_impacts(lagrange_fmu, monkeypatch):  # noqa: F811
    """The series suffice until the ball rests; then SciPy continues."""
    at, ways = {"h": 1.3, "g": 9.81, "e": 0.7}, []
    fall = np.sqrt(2 * at["h"] / at["g"])
    times = [0.0, 0.3, 1.9 * fall, fall + 1.7 * 0.7 * fall, 4.0]
    _, derivatives = motion_through_events("Ball", ["h"], times[:-1], at, monkeypatch, ways)
    assert ways == []
    for t, bounces, row in zip(times, (0, 0, 1, 1), derivatives):
        assert dict(zip(at, row[0])) == pytest.approx(slopes(lambda *at: bounce(mpmath.mpf(t), *at, bounces), at), rel=1e-8, abs=1e-10)
    _, derivatives = motion_through_events("Ball", ["h", "v"], times, at, monkeypatch, ways)
    assert len(ways) == 1 and 0.999 < ways[0] / (fall * (1 + 2 * 0.7 / 0.3)) < 1
    assert derivatives[-1] == pytest.approx(np.zeros((2, 3)), abs=1e-4)


def test_through_samples_that_store_a_state(lagrange_fmu, monkeypatch):  # noqa: F811
    """Between samples u is constant: x(t + h) = x + h v + u h^2/2, v(t + h) = v + h u."""
    at = {"K": 2.0}

    def position(gain, time):
        x, v, rest = mpmath.mpf(1), mpmath.mpf(0), time
        while rest > 0:
            u, h = -gain * x - 2 * v, min(rest, mpmath.mpf("0.1"))
            x, v, rest = x + h * v + u * h**2 / 2, v + h * u, rest - h
        return x

    times = [0.0, 0.05, 1.05]
    values, derivatives = motion_through_events("Held1", ["x"], times, at, monkeypatch, [])
    for time, value, row in zip(times, values, derivatives):
        time = mpmath.mpf(str(time))
        assert value[0] == pytest.approx(float(position(2, time)), rel=1e-9)
        assert row[0, 0] == pytest.approx(float(mpmath.diff(lambda gain: position(gain, time), 2)), rel=1e-8, abs=1e-10)
    with pytest.raises(lagrange_fmu.Problem, match='at the start u is set to a number that varies with \'K\', .*; expected <state name="u" rate="0"/> with <set state> in place of the mode'):
        motion_through_events("Held2", ["x"], times, at, monkeypatch, [])


def test_through_the_onset_of_a_root(lagrange_fmu, monkeypatch):  # noqa: F811
    """w = sqrt(h - 1) is given by t - 0.5/q = -2 w/k - 2 q/k^2 log(1 - k w/q)."""
    at, times = {"q": 0.1, "k": 0.5}, [0.0, 1.0, 10.0]

    def level(q, k):
        time = lambda w: -2 * w / k - 2 * q / k**2 * mpmath.log(1 - k * w / q) - 10 + 0.5 / q
        return 1 + mpmath.findroot(time, (0.01 * q / k, q / k * (1 - mpmath.mpf("1e-9"))), solver="anderson") ** 2

    values, derivatives = motion_through_events("Weir", ["h"], times, at, monkeypatch, [])
    assert derivatives[1, 0] == pytest.approx([1, 0], abs=1e-12)
    assert values[-1, 0] == pytest.approx(float(level(**at)), rel=1e-8)
    for name, slope in zip(at, derivatives[-1, 0]):
        moved = [level(**at | {name: at[name] + sign * mpmath.mpf("1e-8")}) for sign in (1, -1)]
        assert slope == pytest.approx(float((moved[0] - moved[1]) / mpmath.mpf("2e-8")), rel=1e-7)


def test_through_small_bounces(lagrange_fmu, monkeypatch):  # noqa: F811
    """The series suffice for bounces of micrometres and milliseconds."""
    ways = []
    for at, time, expected in small_bounces():
        _, derivatives = motion_through_events("Ball", ["v"], [0.0, time], at, monkeypatch, ways)
        assert dict(zip(at, derivatives[-1, 0])) == pytest.approx(expected, rel=1e-8)
    assert ways == []


def test_through_friction(lagrange_fmu, monkeypatch):  # noqa: F811
    """The friction sticks from 0.09 s on, and slides again from 0.52 s on."""
    at, times, ways = {"k": 20.0, "F": 3.0, "u": 0.4}, [0.0, 0.05, 0.3, 0.9], []
    _, derivatives = motion_through_events("Belt", ["x"], times, at, monkeypatch, ways)
    assert ways == []
    for i, t in enumerate(times):
        assert dict(zip(at, derivatives[i, 0])) == pytest.approx(slopes(lambda *at: belt([mpmath.mpf(t)], *at)[0], at), rel=1e-8, abs=1e-10)


def test_through_friction_that_follows_from_a_contact(lagrange_fmu, monkeypatch):  # noqa: F811
    """Up the slope to the wall, and down."""
    at, times, ways = {"mu": 0.2, "g": 9.81, "e": 0.4, "u": 3.0}, [0.0, 0.1, 0.5], []
    _, derivatives = motion_through_events("Slope", ["s"], times, at, monkeypatch, ways)
    assert ways == []

    def place(t, mu, g, e, u):
        up, down = g * (0.6 + 0.8 * mu), g * (0.6 - 0.8 * mu)
        speed = mpmath.sqrt(u * u - 2 * up * mpmath.mpf("0.4"))
        hit = (u - speed) / up
        return u * t - up * t * t / 2 if t < hit else mpmath.mpf("0.4") - e * speed * (t - hit) - down * (t - hit) ** 2 / 2

    for t, row in zip(times, derivatives):
        assert dict(zip(at, row[0])) == pytest.approx(slopes(lambda *at: place(mpmath.mpf(t), *at), at), rel=1e-8, abs=1e-10)


def test_through_friction_that_follows_from_a_constraint(lagrange_fmu, monkeypatch):  # noqa: F811
    """Up the ramp to the wall, and down."""
    at, times, ways = {"mu": 0.2, "g": 9.81, "e": 0.4, "l": 0.1}, [0.0, 0.1, 0.5], []
    _, derivatives = motion_through_events("Ramp", ["x"], times, at, monkeypatch, ways)
    assert ways == []

    def place(t, mu, g, e, l):
        up, down, start = g * (0.6 + 0.8 * mu), g * (0.6 - 0.8 * mu), -0.48 * l
        speed = mpmath.sqrt(9 - 2 * up * (0.4 - start) / 0.8)
        hit = (3 - speed) / up
        return start + 0.8 * (3 * t - up * t * t / 2) if t < hit else 0.4 - 0.8 * (e * speed * (t - hit) + down * (t - hit) ** 2 / 2)

    for t, row in zip(times, derivatives):
        assert dict(zip(at, row[0])) == pytest.approx(slopes(lambda *at: place(mpmath.mpf(t), *at), at), rel=1e-8, abs=1e-9)


def test_work(lagrange_fmu):  # noqa: F811
    """The work of the damper and the force is a state on which the others do not depend."""
    times = [0.0, 0.7, 4.0]
    values, derivatives = motion("Worked", ["nonConservativeWork"], list(AT), times, {"F": 4.0})
    for i, t in enumerate(times):
        assert values[i, 0] == pytest.approx(float(work(t, *AT.values())), rel=1e-9, abs=1e-12)
        assert dict(zip(AT, derivatives[i, 0])) == pytest.approx(slopes(lambda *at: work(t, *at), AT), rel=1e-8, abs=1e-11)


def test_a_constant_output(lagrange_fmu):  # noqa: F811
    """The energy of a double pendulum is constant, though its states depend on the start hundreds of times more strongly."""
    _, derivatives = motion("Double", ["energy", "a"], list(DOUBLE_AT), [0.0, 1.5, 3.0])
    expected = slopes(energy_of_double, DOUBLE_AT)
    for row in derivatives:
        assert dict(zip(DOUBLE_AT, row[0])) == pytest.approx(expected, rel=1e-7, abs=1e-7)
    assert abs(derivatives[-1, 1]).max() > 100


def test_through_handovers(lagrange_fmu):  # noqa: F811
    """
    The motion becomes stiff and nonstiff again, so that auto changes from Taylor series to Radau's method and back. SciPy gives the reference from
    equations written by hand.
    """
    from lagrange_fmu.model_exchange import opened
    from lagrange_fmu.variational import SeriesMotion

    times, by, k, c = [0.0, 0.7, 1.5, 2.5, 4.0], ["k", "c", "x"], 40.0, 1e5
    with opened(archive("Turning"), {}, by=by) as point:
        _, found = SeriesMotion(point, ["x"], by, 1e-10).over(np.array(times))
        handovers = point.model.getInteger([point.references["solverHandovers"]])[0]
    assert handovers >= 2

    def rates(t, y):
        share = np.exp(-(((t - 1.5) / 0.3) ** 8))
        force = lambda x, v: -k * x - c * share * v
        return [y[1], force(y[0], y[1]), y[3], force(y[2], y[3]) - y[0], y[5], force(y[4], y[5]) - share * y[1], y[7], force(y[6], y[7])]

    truth = solve_ivp(rates, (0, 4), [1, 0, 0, 0, 0, 0, 1, 0], method="Radau", rtol=1e-8, atol=[1e-11] * 4 + [1e-16] * 2 + [1e-11] * 2, t_eval=times)
    for i in range(len(times)):
        assert found[i, 0] == pytest.approx(truth.y[[2, 4, 6], i], rel=1e-6, abs=1e-12)


def test_through_a_constraint(lagrange_fmu):  # noqa: F811
    """
    A pendulum in x and y, whose start is projected onto the circle, and the force of its rod. Derivatives satisfy the linearized
    constraint.
    """
    times = [0.0, 1.0, 3.0, 50.0]
    values, derivatives = motion("Held", ["x", "pull", "y"], CONSTRAINED_BY, times)

    def place(t, l, g, x):
        start = mpmath.atan2(x, mpmath.mpf("0.8"))
        k = mpmath.sin(start / 2)
        angle = 2 * mpmath.asin(k * mpmath.ellipfun("cd", mpmath.sqrt(g / l) * t, m=k * k))
        return l * mpmath.sin(angle), 2 * g * (3 * mpmath.cos(angle) - 2 * mpmath.cos(start))

    for i, t in enumerate(times):
        for k in (0, 1):
            expected = slopes(lambda *at: place(mpmath.mpf(t), *at)[k], {"l": 1.0, "g": 9.81, "x": 0.6})
            assert dict(zip(expected, derivatives[i, k])) == pytest.approx(expected, rel=1e-8, abs=1e-9)
        along_rod = [values[i, 0] * by_x + values[i, 2] * by_y for by_x, by_y in zip(derivatives[i, 0], derivatives[i, 2])]
        assert along_rod == pytest.approx([1, 0, 0, 0], abs=1e-9)


def test_constraints_that_follow_from_others(lagrange_fmu):  # noqa: F811
    """
    The series have no forces for dependent constraints, which would be wrong. The package detects this, and SciPy integrates the motion.
    """
    from lagrange_fmu import variational
    from lagrange_fmu.model_exchange import opened

    for name, is_right in (("Held", True), ("Twice", False)):
        with opened(archive(name), {}, by=CONSTRAINED_BY) as point:
            assert variational.SeriesMotion(point, [], CONSTRAINED_BY, 1e-8).starts_consistently() == is_right


def test_flat_positions(lagrange_fmu):  # noqa: F811
    """The motion through a flat position is an error: SciPy's steps became tiny there, and its states wrong afterwards."""
    from lagrange_fmu.model_exchange import opened
    from lagrange_fmu.problem import Problem
    from lagrange_fmu.sensitivity import DifferentiableMotion

    with pytest.raises(Problem, match="the constraints become singular, and der.nu"), opened(archive_of(BUILD / "variational_switched", "Flat"), {}) as point:
        DifferentiableMotion(point, ["theta[1]"], ["g"], 1e-10).over(np.array([0.0, 1.0]))
    with pytest.raises(Problem, match=r"'loopX\[\d\]' is closest to singular, .*; expected an earlier end"):
        motion("Flat", ["theta[1]"], ["g"], [0.0, 1.0])


def test_a_fit_by_them(lagrange_fmu, monkeypatch):  # noqa: F811
    """The force has kinks between the rows; another solver provides the motion."""
    from lagrange_fmu import variational

    monkeypatch.setattr(variational, "is_fmu", lambda system: False)
    monkeypatch.setattr(variational, "_indicators_of", lambda system, by: 0)
    times = np.linspace(0.5, 4, 36)
    force = np.interp(times, [0.5, 1, 1.5, 2.5, 4], [0, 6, -3, -3, 5])
    rates = lambda t, state: [state[1], (np.interp(t, times, force) - 61 * state[0] - 0.8 * state[1]) / 2]
    answer = solve_ivp(rates, (0.5, 4), [0.3, 0.0], t_eval=times, rtol=1e-10, atol=1e-11, max_step=0.02)
    data = np.rec.fromarrays([times, answer.y[0], force], names="time,x,F").view(np.ndarray)
    found = lagrange_fmu.fit(archive("Fitted"), data, FITTED)
    assert [found.values[name] for name in FITTED] == pytest.approx([2, 61, 0.8, 0.3], rel=1e-4)
    assert found.rms["x"] < 1e-6


def test_systems_without_variational_equations(lagrange_fmu, tmp_path):  # noqa: F811
    """lagc reports an error, so that the package uses another method."""
    from lagrange_fmu.variational import _indicators_of

    massless = CONSTRAINED.replace("</system>", '<coordinate name="z" velocity="vz" unit="m"/><constraint name="same" unit="m">z - x</constraint></system>')
    for text, by, why in ((massless, "l", "does not support coordinates without mass"), (BALL, "g", None), (OSCILLATOR, "kk", "--along kk is not the name of a variable; expected a parameter"), (OSCILLATOR, "k", None)):  # fmt: skip
        (tmp_path / "system.xml").write_text(text)
        result = subprocess.run([fmu.LAGC, tmp_path / "system.xml", "-o", tmp_path, "--along", by], capture_output=True, text=True)
        assert (result.returncode == 0) == (why is None) == (_indicators_of(tmp_path / "system.xml", [by]) is not None)
        assert why is None or why in result.stderr
