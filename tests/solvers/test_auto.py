"""The solver that chooses between Taylor series and Radau IIA: accuracy with either method, and few changes of method."""

import fmpy
import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fmu

TEXTS = {
    # x'' = -b v - k x + u
    "Damper": '<parameter name="b" start="1e6"/><parameter name="k" start="1"/><coordinate name="x" velocity="v" start="1"/>'
    '<particle mass="1" x="x"/><input name="u"/><force coordinate="x">-b*v - k*x + u</force>',
    "VanDerPol": '<parameter name="mu" start="1e3"/><coordinate name="x" velocity="v" start="2"/><particle mass="1" x="x"/>'
    '<force coordinate="x">mu*(1 - x^2)*v - x</force>',
    # nearly dry friction: stiff while it sticks, not while it slides
    "Friction": '<coordinate name="x" velocity="v" start="2.5"/><particle mass="1" x="x"/><potential>x^2/2</potential>'
    '<force coordinate="x">-tanh(v/1e-4)</force>',
    # a square root, which has no series at its branch point, where the motion starts
    "Root": '<parameter name="b" start="1"/><coordinate name="x" velocity="v" start="0"/><particle mass="1" x="x"/>'
    '<force coordinate="x">sqrt(x) + 1 - b*v</force>',
    "Conservative": '<coordinate name="x" velocity="v" start="1"/><particle mass="1" x="x"/><potential>x^4/4</potential>'
    '<force coordinate="x">sin(time)</force>',
    # a charge in an inhomogeneous magnetic field, with strong damping along the field
    "Gyro": '<parameter name="B" start="1e4"/><parameter name="b" start="1e4"/><coordinate name="x" velocity="vx"/>'
    '<coordinate name="y" velocity="vy"/><coordinate name="z" velocity="vz" start="1"/><particle mass="1" x="x" y="y" z="z"/>'
    '<force coordinate="x">B*vy*(1 + 0.1*z)</force><force coordinate="y">1 - B*vx*(1 + 0.1*z)</force>'
    '<force coordinate="z">-b*vz - b*z/10</force>',
    # a ball that bounces on hard ground with little damping
    "Ball": '<coordinate name="x" velocity="v" start="0.1"/><particle mass="1" x="x"/><potential>9.81*x</potential>'
    '<force coordinate="x">1e8*max(-x, 0)^1.5*(1 - 0.5*v)</force>',
    "Driven": '<coordinate name="x" velocity="v" start="1"/><particle mass="1" x="x"/><input name="u"/>'
    '<force coordinate="x">u - x^3</force>',
}  # fmt: skip
DECADES = [10.0**i for i in range(-2, 13)]


@pytest.fixture(scope="module", autouse=True)
def systems():
    fmu.build_systems("auto-systems", {
        f"Auto{name}": f'<system name="Auto{name}">{body}<experiment stopTime="10"/></system>' for name, body in TEXTS.items()
    })  # fmt: skip


def count(instance, name):
    return instance.fmu.getInteger(instance.vr(name))[0]


@mpmath.workdps(50)
def damped(b, k, t, x0=1.0, v0=0.0):
    """x of x'' = -b x' - k x in closed form."""
    root = mpmath.sqrt(mpmath.mpf(b) ** 2 / 4 - mpmath.mpf(k))
    one, other = -mpmath.mpf(b) / 2 + root, -mpmath.mpf(b) / 2 - root
    if b * b > 4 * k:
        one = -mpmath.mpf(k) / (mpmath.mpf(b) / 2 + root)  # without cancellation
    share = (v0 - other * x0) / (one - other)
    return float(mpmath.re(share * mpmath.exp(one * t) + (x0 - share) * mpmath.exp(other * t)))


@pytest.mark.parametrize("b", DECADES)
@pytest.mark.parametrize("step", [10.0, 0.1])
def test_decades_of_damping(b, step, open_fmu):
    """The result agrees with the closed form at every tolerance, with bounded work and few changes of method."""
    instance = open_fmu("AutoDamper")
    for tolerance in (1e-4, 1e-7, 1e-10, 1e-13):
        instance.reset().initialize({"b": b}, tolerance)
        instance.run(10.0, step)
        assert instance.get("x") == pytest.approx(damped(b, 1, 10), abs=max(20 * tolerance, 1e-12))
        assert count(instance, "solverSteps") < 400 and count(instance, "solverHandovers") <= 3


def test_only_systems_that_may_be_stiff():
    """Systems without dissipation, and without forces that depend on velocities or inputs, use only the series."""
    methods = {}
    for name in TEXTS:
        variables = {v.name for v in fmpy.read_model_description(str(fmu.archive(f"Auto{name}"))).modelVariables}
        methods[name] = "solverHandovers" in variables
        assert methods[name] == ("jacobianEvaluations" in variables)
    assert methods == {name: name != "Conservative" for name in TEXTS}


def test_friction_that_is_nearly_dry(open_fmu):
    """
    From rest at 2.5, on a spring of 1 N/m under a friction of 1 N, the mass swings half a period about 1 to -0.5, where it sticks and
    creeps.
    """
    instance = open_fmu("AutoFriction").initialize(tolerance=1e-8)
    instance.run(20.0, 20.0)
    creeping = -0.5 + 1e-4 * np.arctanh(0.5) * (20 - np.pi)
    assert instance.get("x") == pytest.approx(creeping, abs=2e-4)
    assert count(instance, "solverSteps") < 3000


@pytest.mark.long
@pytest.mark.parametrize("tolerance", 10.0 ** -np.linspace(5.5, 12.5, 15))
def test_flights_belong_to_the_series(open_fmu, tolerance):
    """
    During flights no force depends on the state, and the series take the longest steps. Three bounces agree with SciPy. The power x^1.5 is
    undefined across the ground, where rounding may place the end of a step.
    """
    instance = open_fmu("AutoBall").initialize(tolerance=tolerance)
    instance.step(0.7)
    force = lambda t, y: [y[1], -9.81 + 1e8 * max(-y[0], 0) ** 1.5 * (1 - 0.5 * y[1])]
    expected = solve_ivp(force, (0, 0.7), [0.1, 0], method="DOP853", rtol=1e-11, atol=1e-13, max_step=1e-4).y[:, -1]
    assert instance.get("x", "v") == pytest.approx(expected, abs=max(1e-6, 10 * tolerance))
    assert count(instance, "solverHandovers") == 0 or count(instance, "solverHandovers") >= 5


def test_a_start_without_a_series(open_fmu):
    """x'' = sqrt(x) + 1 - b v from rest at 0, against mpmath's quadrature of the energy integral."""
    instance = open_fmu("AutoRoot").initialize({"b": 0.0}, tolerance=1e-9)
    instance.step(1.0)
    # Without damping, conservation of energy gives t as an integral: v^2/2 = 2/3 x^(3/2) + x.
    x = mpmath.findroot(lambda x: mpmath.quad(lambda s: 2 / mpmath.sqrt(2 + mpmath.mpf(4) / 3 * s), [0, mpmath.sqrt(x)]) - 1, 0.6)
    assert instance.get("x") == pytest.approx(float(x), abs=1e-7)


@pytest.mark.parametrize("mu", [10.0, 1e2, 1e3])
def test_few_changes_of_method(mu, open_fmu):
    """The method changes two or three times per jump of van der Pol's oscillator, not at each step."""
    instance = open_fmu("AutoVanDerPol").initialize({"mu": mu}, tolerance=1e-6)
    periods = 3
    instance.step(periods * 1.7 * mu)
    assert count(instance, "solverHandovers") <= 8 * periods
    assert count(instance, "solverSteps") < 500 * periods


def test_inputs_that_change_at_every_step(open_fmu):
    """For piecewise constant inputs, each piece has its own closed form."""
    instance, b, k = open_fmu("AutoDamper"), 1e5, 1e4
    instance.initialize({"b": b, "k": k}, tolerance=1e-8)
    x, v, rng = 1.0, 0.0, np.random.default_rng(1)
    for _ in range(100):
        u = float(rng.uniform(-1e4, 1e4))
        instance.set({"u": u})
        instance.step(0.01)
        start, speed = x - u / k, v
        x = u / k + damped(b, k, 0.01, start, speed)
        v = damped(b, k, 0.01, speed, -b * speed - k * start)
        assert instance.get("x") == pytest.approx(x, abs=1e-6)
    assert count(instance, "solverSteps") < 1600 and count(instance, "solverHandovers") <= 20


def test_stiff_for_a_while(open_fmu):
    """The damping grows and vanishes during the run; the closed form of each part starts at the end of the previous one."""
    instance = open_fmu("AutoDamper").initialize({"b": 0.1}, tolerance=1e-9)
    x, v = 1.0, 0.0
    for b in (0.1, 1e6, 0.2, 1e7, 0.1):
        instance.set({"b": b})
        before = count(instance, "solverSteps")
        instance.run(instance.time + 50.0, 5.0)
        x, v = damped(b, 1, 50, x, v), damped(b, 1, 50, v, -b * v - x)
        assert instance.get("x") == pytest.approx(x, abs=1e-6)
        assert count(instance, "solverSteps") - before < 400
    assert 2 <= count(instance, "solverHandovers") <= 10


def test_handovers_are_logged_once(open_fmu):
    instance = open_fmu("AutoDamper").initialize({"b": 1.0}, tolerance=1e-6)
    for b in (1e6, 0.1, 1e6, 0.1):
        instance.set({"b": b})
        instance.run(instance.time + 100.0, 10.0)
    assert count(instance, "solverHandovers") >= 3
    assert len([text for _, _, text in instance.messages if "Radau" in text]) == 1


@pytest.mark.parametrize("name, values, step, changed", [
    ("AutoDamper", {"b": 1e5}, 0.05, {"b": 1.0}), ("AutoVanDerPol", {"mu": 100.0}, 2.0, {"mu": 90.0}), ("AutoGyro", {"B": 100.0, "b": 1e5}, 0.05, {"b": 1.0}),
    ("AutoRoot", {"b": 1e4}, 0.25, {"b": 10.0}),
])  # fmt: skip
def test_every_step_from_a_saved_state(name, values, step, changed, open_fmu):
    """A step from a saved state has the same result in a new instance, and in the same one after an undone step with other values."""
    counters = ["solverSteps", "solverHandovers", "derivativeEvaluations", "jacobianEvaluations"]

    def results(instance):
        instance.step(step)
        instance.time -= step
        return [*instance.get(*fmu.states_of(name)), *(count(instance, counter) for counter in counters)]

    instance, state = open_fmu(name).initialize(values, tolerance=1e-8), None
    for k in range(60):
        state = instance.fmu.getFMUstate()
        data = instance.fmu.serializeFMUstate(state)
        instance.set(changed)
        results(instance)
        instance.fmu.setFMUstate(state)
        again = results(instance)
        fresh = open_fmu(name).initialize()
        fresh.fmu.setFMUstate(fresh.fmu.deSerializeFMUstate(data))
        fresh.time = instance.time
        assert results(fresh) == again, k
        instance.time += step
    assert count(instance, "solverHandovers") > 0


@pytest.mark.parametrize("name, values, times", [
    ("AutoDamper", {"b": 1e6}, [0.003, 3.5, 8.0]), ("AutoVanDerPol", {"mu": 100.0}, [0.5, 40.0, 81.0, 120.0]),
])  # fmt: skip
def test_saved_states_know_the_method(name, values, times, open_fmu):
    """A serialized state gives the same bits, whichever method the other instance used before."""
    first, second, third = (open_fmu(name).initialize(values) for _ in range(3))
    third.run(times[-1], 1.0)
    for time in times:
        first.run(time, 0.07)
        state = first.fmu.serializeFMUstate(first.fmu.getFMUstate())
        for other in (second, third):
            other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(state))
            other.time = first.time
        results = []
        for instance in (first, second, third):
            instance.run(time + 3.0, 0.07)
            results.append([*instance.get("x", "v"), count(instance, "solverSteps"), count(instance, "solverHandovers")])
        assert results[0] == results[1] == results[2]
