"""
Features of the right side that a series about the start of a step cannot show. They are walls, hills, steps, pulses, powers that vanish at the start,
and kinks of all kinds. Expected values come from the energy integral or a closed form.
"""

import mpmath as mp
import numpy as np
import pytest

import fmu
from fmu import DISCARD

mp.mp.dps = 40
TOLERANCES = (1e-3, 1e-4, 1e-7, 1e-8, 1e-10, 1e-13)
COMMUNICATION_STEPS = (1, 37)


def travel_time(potential, energy, marks):
    """Time of a unit mass between the marks, the last of which may be a turning point."""
    return mp.quad(lambda x: 1 / mp.sqrt(2 * abs(energy - potential(x))), marks)


# A unit mass of velocity 1 meets them: the potential in the language and in mpmath, the start, a position where the potential exceeds the
# energy 1/2, and the width of the feature.
WALLS = {
    "Hill": ("0.6*exp(-(x/0.1)^2)", lambda x: 0.6 * mp.exp(-((x / mp.mpf("0.1")) ** 2)), -1, 0, 0.1),
    "NarrowHill": ("0.6*exp(-(x/1e-3)^2)", lambda x: 0.6 * mp.exp(-((x * 1000) ** 2)), -1, 0, 1e-3),
    "Spike": ("0.6*exp(-(x/1e-6)^2)", lambda x: 0.6 * mp.exp(-((x * 10**6) ** 2)), -1, 0, 1e-6),
    "Step": ("1 + tanh(20*(x - 3))", lambda x: 1 + mp.tanh(20 * (x - 3)), 0, 4, 0.05),
    "SoftWall": ("exp(50*(x - 3))", lambda x: mp.exp(50 * (x - 3)), 0, 4, 0.02),
    "Secant": ("0.6/cosh((x - 3)/0.02)", lambda x: 0.6 / mp.cosh((x - 3) * 50), 0, 3, 0.02),
    "Resonance": ("0.6/(1 + ((x - 3)/1e-5)^2)", lambda x: 0.6 / (1 + ((x - 3) * 10**5) ** 2), 0, 3, 1e-5),
    "HighPower": ("0.5*(x/3)^40", lambda x: (x / mp.mpf(3)) ** 40 / 2, 0, 4, 0.1),
}


def turning_point(potential, low, high):
    """Position with U = 1/2, by bisection."""
    low, high = mp.mpf(low), mp.mpf(high)
    for _ in range(150):
        middle = (low + high) / 2
        low, high = (middle, high) if potential(middle) < 0.5 else (low, middle)
    return low


def texts():
    particle = '<coordinate name="x" velocity="v" start="{}" velocityStart="{}"/><particle mass="1" x="x"/>{}'
    wall = lambda u, start: particle.format(start, 1, f"<potential>{u}</potential>")
    force = lambda f, x=0, v=0: particle.format(x, v, f'<force coordinate="x">{f}</force>')
    systems = {name: wall(u, start) for name, (u, _, start, _, _) in WALLS.items()}
    systems |= {f"Power{n}": wall(f"x^{n}/{n}", 0) for n in (4, 8, 20)}
    systems |= {f"TimePower{n}": force(f"time^{n}") for n in (6, 10)}
    systems |= {name: force(f, *start) for name, (f, start, _) in CLOSED_FORMS.items()}
    systems["Ball"] = particle.format(1, 0, "<potential>9.81*x + 1e4*0.01*log(1 + exp(-x/0.01))</potential>")
    systems["RootPotential"] = particle.format(1, 0, "<potential>sqrt(x^2)</potential>")
    systems["Clamp"] = particle.format(-1, 1, "<potential>max(0, min(1, (x - 0.3)/1e-6))*0.3</potential>")
    systems["Hertz"] = particle.format(1, 0, '<potential>9.81*x</potential><force coordinate="x">1e6*max(0, -x)^1.5</force>')
    systems["Throw"] = particle.format(1, 2, "<potential>9.81*x</potential>")
    systems["WeakPole"] = force("1e-6/x", 1, -1)
    systems["Stick"] = force("-sign(v)", 0, 1) + '<solver method="taylor"/>'
    systems["LogOfInput"] = '<input name="u"/>' + force("log(1 - u)")
    systems["ParameterPower"] = '<parameter name="p" start="3"/>' + force("-x^p", 0, 1)
    return {name: f'<system name="{name}">{content}</system>' for name, content in systems.items()}


def friction(t):
    """v' = -tanh(v / eps)/2, where sinh(v / eps) decreases exponentially."""
    eps = mp.mpf("0.01")
    velocity = lambda s: eps * mp.asinh(mp.sinh(1 / eps) * mp.exp(-s / (2 * eps)))
    return mp.quad(velocity, [0, 1.9, 2, 2.1, 3]), velocity(t)


def on_springs(t):
    """x'' = -sign(x) from rest at x = 1: parabolas, four quarter periods of sqrt(2)."""
    quarter = mp.sqrt(2)
    quarters = mp.floor(t / quarter)
    s = t - quarters * quarter
    x = {0: 1 - s**2 / 2, 1: -s * quarter + s**2 / 2, 2: s**2 / 2 - 1, 3: s * quarter - s**2 / 2}[int(quarters) % 4]
    v = {0: -s, 1: s - quarter, 2: s, 3: quarter - s}[int(quarters) % 4]
    return x, v


def with_either_sign(t):
    """x'' = -|x| from x = 1 at rest: a cosine, then a hyperbolic sine."""
    s = t - mp.pi / 2
    return -mp.sinh(s), -mp.cosh(s)


def distance_from_one(t):
    """x'' = |t - 1|."""
    s = mp.mpf(t) - 1
    return mp.mpf(1) / 6 * abs(s) ** 3 - mp.mpf(1) / 6 + mp.mpf(t) / 2, s * abs(s) / 2 + mp.mpf("0.5")


def lobes(t):
    """x'' = -max(0, sin(3 t)): an integral over each lobe; the first lobe begins at the start."""
    x = v = mp.mpf(0)
    for a, b in ((0, mp.pi / 3), (2 * mp.pi / 3, t)):
        v -= mp.quad(lambda s: mp.sin(3 * s), [a, b])
        x -= mp.quad(lambda s: (t - s) * mp.sin(3 * s), [a, b])
    return x, v


def through_a_zone(t):
    """A force of 200 N over 1 cm from x = 0.3 on, reached after 1.3 s at 1 m/s."""
    fast = mp.sqrt(1 + 2 * 200 * mp.mpf("0.01"))
    return mp.mpf("0.31") + fast * (t - mp.mpf("1.3") - (fast - 1) / 200), fast


def up_a_ramp(t):
    """A potential that rises by 0.3 J over 1e-6 m from x = 0.3 on, reached after 1.3 s at 1 m/s."""
    slow, width = mp.sqrt(mp.mpf("0.4")), mp.mpf("1e-6")
    return mp.mpf("0.3") + width + slow * (t - mp.mpf("1.3") - 2 * width / (1 + slow)), slow


# Force, initial position and velocity, and the motion at t = 3.
CLOSED_FORMS = {
    "Pulse": ("exp(-(time - 1)^2/1e-4)", (0, 0), lambda t: (mp.sqrt(mp.pi) / 100 * 2, mp.sqrt(mp.pi) / 100)),
    "Friction": ("-0.5*tanh(v/0.01)", (0, 1), friction),
    "Drag": ("-v*abs(v)", (0, 1), lambda t: (mp.log(1 + t), mp.mpf(1) / (1 + t))),
    "DragByRoot": ("-v*sqrt(v^2)", (0, 1), lambda t: (mp.log(1 + t), mp.mpf(1) / (1 + t))),
    "RootsOfSquares": ("-(x^2)^0.25*(x^2)^0.25", (1, 0), with_either_sign),
    "TimeRoot": ("sqrt((time - 1)^2)", (0, 0), distance_from_one),
    "Larger": ("max(time - 1, 1 - time)", (0, 0), distance_from_one),
    "Zone": ("(sign(x - 0.3) - sign(x - 0.31))*100", (-1, 1), through_a_zone),
    "RootOfTime": ("sqrt(time)", (0, 0), lambda t: (mp.mpf(t) ** 2.5 * 4 / 15, mp.mpf(t) ** 1.5 * 2 / 3)),
    "Lobes": ("-max(0, sin(3*time))", (0, 0), lobes),
    "LobesByMin": ("min(-sin(3*time), 0)", (0, 0), lobes),
    "Triangle": ("acos(cos(time - 1))", (0, 0), distance_from_one),
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def systems():
    fmu.build_systems("hidden-systems", texts())


def outcomes(instance, end, values=()):
    for tolerance in TOLERANCES:
        for steps in COMMUNICATION_STEPS:
            runs = []
            for _ in range(2):
                instance.reset().initialize(values, tolerance)
                instance.run(end, end / steps)
                runs.append((tolerance, instance.get("x"), instance.get("v")))
            assert runs[0] == runs[1], "a run depends on what was run before"
            yield runs[0]


@pytest.mark.long
@pytest.mark.parametrize("name", WALLS)
def test_no_wall_is_passed(name, open_fmu):
    """The particle turns at the wall, and returns to the start after twice the travel time, with the velocity -1."""
    _, potential, start, top, width = WALLS[name]
    turn = turning_point(potential, start, top)
    marks = [start, *(turn - width * mp.mpf(2) ** k for k in range(12, -12, -2) if turn - width * 2**k > start), turn]
    back = 2 * travel_time(potential, mp.mpf("0.5"), marks)
    for tolerance, x, v in outcomes(open_fmu(name), float(back) + 1):
        rounding = 1e-15 / width  # rounding error of x in units of the width
        assert x == pytest.approx(start - 1, abs=100 * tolerance + rounding)
        assert v == pytest.approx(-1, abs=100 * tolerance + rounding)


@pytest.mark.parametrize("n", [4, 8, 20])
def test_powers_that_vanish_at_the_start(n, open_fmu):
    """From x = 0 with v = 1 under U = x^n/n, the motion is at its amplitude after five quarter periods."""
    amplitude = (mp.mpf(n) / 2) ** (mp.mpf(1) / n)
    quarter = travel_time(lambda x: x**n / n, mp.mpf("0.5"), [0, amplitude / 2, amplitude])
    for tolerance, x, v in outcomes(open_fmu(f"Power{n}"), float(5 * quarter)):
        assert x == pytest.approx(float(amplitude), abs=100 * tolerance)
        assert v == pytest.approx(0, abs=100 * n * tolerance)


@pytest.mark.parametrize("n", [6, 10])
def test_powers_of_time_above_the_order(n, open_fmu):
    for tolerance, x, v in outcomes(open_fmu(f"TimePower{n}"), 2.0):
        assert x == pytest.approx(2 ** (n + 2) / (n + 1) / (n + 2), rel=100 * tolerance)
        assert v == pytest.approx(2 ** (n + 1) / (n + 1), rel=100 * tolerance)


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_closed_forms(name, open_fmu):
    exact = [float(value) for value in CLOSED_FORMS[name][2](3)]
    for tolerance, x, v in outcomes(open_fmu(name), 3.0):
        assert [x, v] == pytest.approx(exact, abs=100 * tolerance)


def test_the_slope_of_a_potential_may_jump(open_fmu):
    exact = [float(value) for value in on_springs(3)]
    for tolerance, x, v in outcomes(open_fmu("RootPotential"), 3.0):
        assert [x, v] == pytest.approx(exact, abs=100 * tolerance)


def test_a_potential_may_be_cut_off(open_fmu):
    exact = [float(value) for value in up_a_ramp(3)]
    for tolerance, x, v in outcomes(open_fmu("Clamp"), 3.0):
        assert [x, v] == pytest.approx(exact, abs=100 * tolerance + 5e-9), "300 kN act for the rounding of time"


def test_a_contact_by_hertz(open_fmu):
    """The ball falls from 1 m onto a Hertzian contact, and returns after twice the time down."""
    potential = lambda x: mp.mpf("9.81") * x + (mp.mpf(10) ** 6 * (-x) ** mp.mpf("2.5") / 2.5 if x < 0 else 0)
    lowest = turning_point(lambda depth: potential(-depth) - potential(1) + mp.mpf("0.5"), 0, 1)
    time = lambda depth: 1 / mp.sqrt(2 * abs(potential(1) - potential(-depth)))
    back = 2 * (mp.sqrt(2 / mp.mpf("9.81")) + mp.quad(time, [0, lowest / 2, lowest]))
    for tolerance, x, v in outcomes(open_fmu("Hertz"), float(back)):
        assert x == pytest.approx(1, abs=100 * tolerance)
        assert v == pytest.approx(0, abs=440 * tolerance), "it has fallen with 4.4 m/s"


def test_a_ball_rests_on_its_floor(open_fmu):
    """The ball falls from 1 m onto a contact of width 1 cm, and returns after twice the time down."""
    potential = lambda x: mp.mpf("9.81") * x + 100 * mp.log1p(mp.exp(-100 * x))
    height = lambda depth: potential(-depth)
    lowest = turning_point(lambda depth: height(depth) - height(-1) + mp.mpf("0.5"), -0.9, 1)
    marks = [-1, -0.9, -0.5, -0.2, -0.1, -0.05, lowest - 0.01, lowest - 0.001, lowest]
    back = 2 * mp.quad(lambda x: 1 / mp.sqrt(2 * abs(height(-1) - height(x))), marks)
    for tolerance, x, v in outcomes(open_fmu("Ball"), float(back)):
        assert x == pytest.approx(1, abs=100 * tolerance)
        assert v == pytest.approx(0, abs=440 * tolerance), "it has fallen with 4.4 m/s"


def test_a_polynomial_motion_takes_one_step(open_fmu):
    instance = open_fmu("Throw").initialize(tolerance=1e-10)
    rows = instance.run(10.0, 0.01, "x")
    assert rows[-1][1] == pytest.approx(1 + 2 * 10 - 9.81 * 50, rel=1e-14)
    assert instance.fmu.getInteger(instance.vr("solverSteps")) == [1], "one series covers the whole motion"


def test_a_whole_exponent_may_be_a_parameter(open_fmu):
    """x^p is smooth at x = 0 for an integer parameter p; the motion is that of U = x^4/4."""
    quarter = travel_time(lambda x: x**4 / 4, mp.mpf("0.5"), [0, mp.mpf(2) ** mp.mpf("0.25")])
    for tolerance, x, _ in outcomes(open_fmu("ParameterPower"), float(5 * quarter)):
        assert x == pytest.approx(2**0.25, abs=100 * tolerance)


def test_a_weak_pole_is_not_crossed(open_fmu):
    """By energy, 1e-6 log(x) reaches -1/2 only below exp(-500000), so that the pole is practically reached."""
    instance = open_fmu("WeakPole")
    for tolerance in TOLERANCES:
        for step in (3.0, 0.01):
            instance.reset().initialize(tolerance=tolerance)
            with instance.fails(DISCARD, "singularity"):
                instance.run(3.0, step)
            assert instance.fmu.getRealStatus(2) == pytest.approx(1, abs=1e-5)
            assert abs(instance.get("x")) < 1e-5


def test_sticking_regularized_friction_is_an_error(open_fmu):
    instance = open_fmu("Stick")
    for tolerance in (1e-5, 1e-8, 1e-12):
        instance.reset().initialize(tolerance=tolerance)
        with instance.fails(DISCARD, "chatters.*sign"):
            instance.run(3.0, 3.0)
        assert instance.get("x") == pytest.approx(0.5, abs=100 * tolerance)


def test_the_state_before_a_singularity_can_be_read_and_restored(open_fmu):
    """log(1 - u) with u = t: the last valid time lies before 1, and the saved state there is finite."""
    instance = open_fmu("LogOfInput").initialize(tolerance=1e-8)
    instance.fmu.setRealInputDerivatives(instance.vr("u"), [1], [1.0])
    with instance.fails(DISCARD, "singularity"):
        instance.step(2.0)
    last = instance.fmu.getRealStatus(2)
    assert 1 - 1e-6 < last <= 1
    assert instance.get("v") == pytest.approx(-1, abs=1e-5)
    state = instance.fmu.getFMUstate()
    data = instance.fmu.serializeFMUstate(state)
    instance.free_state(state)
    assert np.all(np.isfinite(np.frombuffer(data[len(data) % 8 :])[20:]))
