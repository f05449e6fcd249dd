"""Inputs in constraints, which prescribe motions from outside."""

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from scipy.integrate import solve_ivp

import fmu
from fmu import DISCARD, WARNING
from constrained_systems import METHODS, move, rename

HAND = """
<system name="Hand">
  <input name="u" start="0.1" derivatives="2"/>
  <coordinate name="x" velocity="v" start="0.1"/>
  <coordinate name="theta" velocity="omega" start="0.4"/>
  <particle name="slide" mass="3" x="x"/>
  <particle name="bob" mass="2" x="x + 0.5*sin(theta)" y="-0.5*cos(theta)"/>
  <potential>2*9.81*bob.y</potential>
  <constraint name="hand">u - x</constraint>
  <output name="pull">hand.force</output>
  {solver}
  <experiment stopTime="3"/>
</system>
"""
# A skate with a prescribed sideways velocity, and a rod between two points, one of which is moved along both axes.
SKATE = """
<system name="PushedSkate">
  <input name="s" derivatives="1"/>
  <coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/>
  <coordinate name="phi" velocity="w" velocityStart="1.5"/>
  <body mass="2" inertia="0.4" x="x" y="y" angle="phi"/>
  <constraint name="blade">vx*sin(phi) - vy*cos(phi) - s</constraint>
</system>
"""
ROD = """
<system name="MovedRod">
  <input name="X" derivatives="2"/><input name="Y" derivatives="2"/>
  <coordinate name="x" velocity="vx" start="0.3"/><coordinate name="y" velocity="vy" start="-0.4"/>
  <particle mass="1.5" x="x" y="y"/>
  <potential>1.5*9.81*y</potential>
  <constraint name="rod">sqrt((x - X)^2 + (y - Y)^2) - 0.5</constraint>
</system>
"""
TEXTS = {"Hand": HAND.format(solver=""), "PushedSkate": SKATE, "MovedRod": ROD}
TEXTS |= {f"Hand{m}": rename(HAND, f"Hand{m}").format(solver=f'<solver method="{m}" tolerance="1e-10"/>') for m in METHODS}
HANDS = ["Hand", *(f"Hand{m}" for m in METHODS)]


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("moved-constraints", TEXTS)


def swing(acceleration, stop, theta=0.4):
    """theta and omega at the times `stop` of a pendulum whose pivot has this acceleration."""

    def derivative(t, state):
        return [state[1], -2 * (9.81 * np.sin(state[0]) + acceleration(t) * np.cos(state[0]))]

    return solve_ivp(derivative, (0, stop[-1]), [theta, 0.0], method="DOP853", rtol=1e-12, atol=1e-12, t_eval=stop).y


@pytest.mark.parametrize("name", HANDS)
def test_a_hand_with_constant_acceleration(name, open_fmu):
    """The second derivative suffices: each step ends at the prescribed position, and nothing jumps."""
    instance = open_fmu(name).initialize({"v": -0.3, "der(u)": -0.3, "der(der(u))": 0.8}, tolerance=1e-10)
    assert instance.get("v") == pytest.approx(-0.3, abs=1e-14)
    times = np.linspace(0.1, 2, 20)
    angles = swing(lambda t: 0.8, times)
    for t, theta, omega in zip(times, *angles):
        instance.step(0.1)
        place = {"u": 0.1 - 0.3 * t + 0.4 * t**2, "der(u)": -0.3 + 0.8 * t}
        assert instance.get("u", "der(u)") == pytest.approx(list(place.values()), abs=1e-12)
        instance.set(place)
        assert instance.get("x", "v") == pytest.approx(list(place.values()), abs=1e-9)
        allowed = 2e-6 if name == "Handbdf" else 1e-7
        assert instance.get("theta", "omega") == pytest.approx([theta, omega], abs=10 * allowed)
        turn = -2 * (9.81 * np.sin(theta) + 0.8 * np.cos(theta))
        force = 5 * 0.8 + 2 * 0.5 * (turn * np.cos(theta) - omega**2 * np.sin(theta))
        assert instance.get("pull") == pytest.approx(force, abs=100 * allowed)
    assert not [text for status, _, text in instance.messages if "moved to fulfil" in text or status > WARNING]


def shaken(instance, step, stop):
    """Set u = 0.2 sin(3 t) and its derivatives at each communication point, without polynomials; return theta at the end."""
    for k in range(round(stop / step) + 1):
        t = k * step
        values = [0.2 * np.sin(3 * t), 0.6 * np.cos(3 * t), -1.8 * np.sin(3 * t)]
        instance.set(dict(zip(("u", "der(u)", "der(der(u))"), values)))
        if k * step < stop - step / 2:
            instance.step(step)
    return instance.get("theta")


def test_values_at_communication_points_are_enough(open_fmu):
    """The error decreases at least with the second power of the step, and the log has no message about moved coordinates."""
    expected = swing(lambda t: -1.8 * np.sin(3 * t), [2.0])[0, -1]
    errors = []
    for step in (0.02, 0.01, 0.005):
        instance = open_fmu("Hand").initialize({"u": 0.0, "x": 0.0, "v": 0.6, "der(u)": 0.6})
        errors.append(abs(shaken(instance, step, 2.0) - expected))
        assert instance.get("x") == pytest.approx(0.2 * np.sin(6.0), abs=step**3)
        assert len([text for _, _, text in instance.messages if "moved to fulfil" in text]) == 0
        instance.free()
    assert errors[0] < 1e-2 and errors[1] < errors[0] / 3.5 and errors[2] < errors[1] / 3.5


def test_polynomials_of_the_inputs(open_fmu):
    """The FMU follows a cubic exactly in steps of any length, and its force to the accuracy of the tolerance."""
    path = {"u": np.polynomial.Polynomial([0.1, 0.2, -0.3, 0.15])}
    expected = swing(lambda t: -0.6 + 0.9 * t, [2.0])[0, -1]
    for steps in (2, 40):
        instance = open_fmu("Hand").initialize({"v": 0.2, "der(u)": 0.2})
        move(instance, path, 0.0)
        for t in np.linspace(0, 2, steps + 1)[1:]:
            instance.step(t - instance.time)
            move(instance, path, t)
            assert instance.get("x", "v") == pytest.approx([path["u"](t), path["u"].deriv()(t)], abs=1e-9)
        assert instance.get("theta") == pytest.approx(expected, abs=1e-6)
        instance.free()


def test_start_follows_the_input(open_fmu):
    instance = open_fmu("Hand").initialize({"u": 0.25, "der(u)": 2.0})
    assert instance.get("x", "v") == pytest.approx([0.25, 2.0], abs=1e-13)
    assert any("x from 0.1 to 0.25" in text for _, _, text in instance.messages)


def test_jumps_are_errors(open_fmu):
    instance = open_fmu("Hand").initialize()
    instance.step(0.1)
    instance.set({"u": 0.15})
    instance.step(0.1)
    assert instance.get("x") == pytest.approx(0.15, abs=1e-13)
    instance.set({"u": 0.6})
    with instance.fails(DISCARD, "residual of the constraint 'hand' is 0.45 after a jump of an input: it depends on u;"):
        instance.step(0.1)


def test_an_input_that_prescribes_a_velocity(open_fmu):
    """vx sin(phi) - vy cos(phi) = s = 0.3 t, with phi = 1.5 t: forces and motion agree with SciPy on Newton's law."""
    instance = open_fmu("PushedSkate").initialize({"der(s)": 0.3})

    def derivative(t, state):
        vx, vy, phi = state[2:]
        side = np.array([np.sin(phi), -np.cos(phi)])
        along = 0.3 - 1.5 * (vx * np.cos(phi) + vy * np.sin(phi))
        return [vx, vy, *(side * along), 1.5]

    expected = solve_ivp(derivative, (0, 2), np.zeros(5), rtol=1e-12, atol=1e-12, t_eval=np.linspace(0.2, 2, 10)).y
    for k in range(10):
        instance.step(0.2)
        x, y, vx, vy, phi, force = instance.get("x", "y", "vx", "vy", "phi", "blade.force")
        assert [x, y, vx, vy, phi] == pytest.approx(list(expected[:, k]), abs=1e-7)
        assert force == pytest.approx(-2 * (0.3 - 1.5 * (vx * np.cos(phi) + vy * np.sin(phi))), abs=1e-9)
        instance.set({"s": 0.3 * instance.time})


def test_model_exchange(open_fmu):
    """Accelerations at a point follow from the input and its two derivatives; an event projects a state that no longer fits the input."""
    instance = open_fmu("MovedRod", kind=FMU2Model)
    instance.initialize({"der(X)": 0.5, "der(der(X))": -0.7, "der(der(Y))": 1.1})
    model = instance.fmu
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    x, y, vx, vy = instance.get("x", "y", "vx", "vy")
    direction, relative = np.array([x, y]) / 0.5, np.array([vx - 0.5, vy])
    assert direction @ relative == pytest.approx(0, abs=1e-13)
    free = np.array([0, -9.81]) - np.array([-0.7, 1.1])
    expected = np.array([0, -9.81]) - direction * (direction @ free + relative @ relative / 0.5)
    assert instance.get("der(vx)", "der(vy)") == pytest.approx(list(expected), abs=1e-11)
    assert instance.get("rod.force") == pytest.approx(1.5 * (direction @ free + relative @ relative / 0.5), abs=1e-11)
    instance.set({"X": 0.01})
    assert model.completedIntegratorStep()[0]
    model.enterEventMode()
    assert model.newDiscreteStates()[3]
    x, y = instance.get("x", "y")
    assert np.hypot(x - 0.01, y) == pytest.approx(0.5, abs=1e-14)


def test_directional_derivatives(open_fmu):
    """
    Derivatives of accelerations and the force along the inputs' derivatives equal exact differences, since these values are linear in them.
    """
    instance = open_fmu("Hand")
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    unknown = ["der(v)", "der(omega)", "pull"]
    ours = instance.fmu.getDirectionalDerivative(instance.vr(*unknown), instance.vr("der(der(u))"), [1.0])
    before = np.array(instance.get(*unknown))
    instance.set({"der(der(u))": 1.0})
    np.testing.assert_allclose(ours, np.array(instance.get(*unknown)) - before, atol=1e-12)
    assert ours[0] == pytest.approx(1.0, abs=1e-14)
