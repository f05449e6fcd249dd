"""Friction along velocities that drives and constraints prescribe, with dwells and restarts; a belt that starts to move under a box."""

import math

import fmpy
import numpy as np
import pytest

import fmu
from fmu import build_systems

pytestmark = pytest.mark.long

DRIVE = '<coordinate name="x" velocity="v" acceleration="{0}"/><particle mass="1" x="x"/>'
START = DRIVE.format("if(time &lt; 1, 0, 1)")
FRICTION = '<friction name="rub" {0} force="5"/>'
METHODS = ["taylor", "erk", "radau", "bdf"]
BODIES = {
    "Dwell": START + FRICTION.format('coordinate="x"'),
    "Back": DRIVE.format("if(time &lt; 1, 0, -1)") + '<friction name="rub" coordinate="x" force="5" forceBack="3"/>',
    "Smooth": DRIVE.format("-max(0, time - 1)") + FRICTION.format('coordinate="x"'),
    "Stopped": DRIVE.format("if(time &lt; 1, -1, if(time &lt; 2, 0, 1))").replace('"v"', '"v" velocityStart="1"')
    + FRICTION.format('coordinate="x"'),
    "Between": START + '<coordinate name="y" velocity="w" acceleration="if(time &lt; 2, 0, 1)"/><particle mass="1" x="y"/>'
    + FRICTION.format('velocity="v - w"') + '<output name="other">y.force</output>',
    "Rod": START + '<coordinate name="y" velocity="w"/><particle mass="2" x="y"/><constraint name="rod">x - y</constraint>'
    + FRICTION.format('coordinate="y"'),
    "Moved": '<coordinate name="x" velocity="v"/><particle mass="1" x="x"/><constraint name="c">x - max(0, time - 1)^2/2</constraint>'
    + FRICTION.format('coordinate="x"') + '<output name="drive">-c.force</output>',
    "Belt": START + '<coordinate name="y" velocity="w"/><particle mass="2" x="y"/>' + FRICTION.format('velocity="w - v"'),
    "FastBelt": DRIVE.format("if(time &lt; 1, 0, 10)") + '<coordinate name="y" velocity="w"/><particle mass="2" x="y"/>'
    + FRICTION.format('velocity="w - v"'),
}  # fmt: skip

# A drive that stops and dwells from 0.5 s on, or from 1 s on, and starts again at 2 s; joined to a second body.
STOP = "if(time &lt; 0.25, 2, if(time &lt; 0.5, -2, if(time &lt; 2, 0, {0})))"
SWING = "if(time &lt; 1, 2*pi*cos(2*pi*time), if(time &lt; 2, 0, {0}))"
JOINED = '<coordinate name="y" velocity="w"/><particle mass="1" x="y"/><constraint name="rod">{0}</constraint>'
DWELLS = {
    "Alone": (DRIVE.format(STOP.format(3)) + FRICTION.format('coordinate="x"'), 0, 0.5, 3),
    "Same": (DRIVE.format(STOP.format(3)) + JOINED.format("y - x") + FRICTION.format('coordinate="y"'), 1, 0.5, 3),
    "Lever": (DRIVE.format(STOP.format(-3)) + JOINED.format("y - 4*x") + FRICTION.format('coordinate="y"'), 4, 0.5, -3),
    "Rates": (DRIVE.format(STOP.format(-3)) + JOINED.format("w + 0.3*v") + FRICTION.format('coordinate="y"'), -0.3, 0.5, -3),
    "Turned": (DRIVE.format(STOP.format(3)) + JOINED.format("sin(y) - sin(x)*0.7") + FRICTION.format('coordinate="y"'), None, 0.5, 3),
    "Swing": (DRIVE.format(SWING.format(3)) + FRICTION.format('coordinate="x"'), 0, 1, 3),
    "SwingLever": (DRIVE.format(SWING.format(-3)) + JOINED.format("y - 3*x") + FRICTION.format('coordinate="y"'), 3, 1, -3),
}  # fmt: skip


def after(time, start, value):
    return value if time > start else 0


# Functions of time: the force of the drive, and that of the friction.
FORCES = {
    "Dwell": lambda t: (after(t, 1, 6), after(t, 1, 5)),
    "Back": lambda t: (after(t, 1, -4), after(t, 1, -3)),
    "Smooth": lambda t: (after(t, 1, 1 - t - 5), after(t, 1, -5)),
    "Stopped": lambda t: (4, 5) if t < 1 else (after(t, 2, 6), after(t, 2, 5)),
    "Between": lambda t: (after(t, 1, 6), after(t, 1, 5)),
    "Rod": lambda t: (after(t, 1, 8), after(t, 1, 5)),
    "Moved": lambda t: (after(t, 1, 6), after(t, 1, 5)),
    "Belt": lambda t: (after(t, 1, 3), after(t, 1, -2)),
    "FastBelt": lambda t: (after(t, 1, 15), after(t, 1, -5)),
}


def name_of(body, method):
    return f"Given{body}{method.title()}"

# Motions that an input prescribes, through a constraint or an acceleration: the elements, and the ratio of the velocity of y to that of x.
HAND = '<input name="u" derivatives="2"/><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><constraint name="hand">u - x</constraint>'
RATE = '<input name="s" derivatives="1"/><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><constraint name="hand">s - v</constraint>'
ACCELERATION = '<input name="a"/>' + DRIVE.format("a")
BY_INPUTS = {
    "Hand": (HAND + FRICTION.format('coordinate="x"'), 0),
    "HandLever": (HAND + JOINED.format("y + 0.3*x") + FRICTION.format('coordinate="y"'), -0.3),
    "Rate": (RATE + FRICTION.format('coordinate="x"'), 0),
    "RateLever": (RATE + JOINED.format("w - 4*v") + FRICTION.format('coordinate="y"'), 4),
    "Acceleration": (ACCELERATION + FRICTION.format('coordinate="x"'), 0),
    "AccelerationLever": (ACCELERATION + JOINED.format("y - 3*x") + FRICTION.format('coordinate="y"'), 3),
}


def stop_and_go(time):
    """Position, velocity and acceleration: a stop at 0.5 s, and a start at 2 s."""
    if time < 0.25:
        return time**2, 2 * time, 2
    if time < 0.5:
        return 0.125 - (time - 0.5) ** 2, 1 - 2 * time, -2
    return 0.125 - 1.5 * max(0, time - 2) ** 2, -3 * max(0, time - 2), -3 if time >= 2 else 0


def swing_and_go(time):
    """A swing of 1 s, and a start at 2 s. Acceleration by steps: constant in each communication step."""
    if time < 1:
        return (1 - math.cos(2 * math.pi * time)) / (2 * math.pi), math.sin(2 * math.pi * time), 2 * math.pi * math.cos(2 * math.pi * time)
    return -1.5 * max(0, time - 2) ** 2, -3 * max(0, time - 2), -3 if time >= 2 else 0


# In a plane: the friction of 5 N opposes the velocity (v, w), and is 0 at rest. The mass is 1 kg.
PLANE = ('<coordinate name="x" velocity="v" acceleration="{}"/><coordinate name="y" velocity="w" acceleration="{}"/><particle mass="1" x="x" y="y"/>'
         '<friction name="rub" velocity="v" across="w" force="5"/><output name="across">y.force</output>')  # fmt: skip
PLANES = {
    "Both": PLANE.format("if(time &lt; 1, 0, 3)", "if(time &lt; 1, 0, 4)"),
    "One": PLANE.format("if(time &lt; 1, 0, -3)", "0"),
    "Later": PLANE.format("if(time &lt; 1, 0, 3)", "if(time &lt; 2, 0, 4)"),
    "Ramp": PLANE.format("-3*max(0, time - 1)", "4*max(0, time - 1)"),
    "Twice": PLANE.format("if(time &lt; 0.3, -3, if(time &lt; 1.1, 0, 6))", "if(time &lt; 0.3, -4, if(time &lt; 1.1, 0, -8))")
    .replace('"v" acc', '"v" velocityStart="0.9" acc').replace('"w" acc', '"w" velocityStart="1.2" acc'),
    "Quarter": PLANE.format("6*time*cos(2*time)", "6*time*sin(2*time)"),
    "Reversing": PLANE.format("3", "4").replace('"v" acc', '"v" velocityStart="-3" acc').replace('"w" acc', '"w" velocityStart="-4" acc'),
    "Cusp": PLANE.format("3", "8*(time - 1)").replace('"v" acc', '"v" velocityStart="-3" acc').replace('"w" acc', '"w" velocityStart="4" acc'),
}  # fmt: skip
QUARTER = lambda t: (3 * t * np.sin(2 * t) - 1.5 * (1 - np.cos(2 * t)), 1.5 * np.sin(2 * t) - 3 * t * np.cos(2 * t))
# Functions of time: the velocity and the acceleration.
PRESCRIBED = {
    "Both": lambda t: ((3 * max(0, t - 1), 4 * max(0, t - 1)), (after(t, 1, 3), after(t, 1, 4))),
    "One": lambda t: ((-3 * max(0, t - 1), 0), (after(t, 1, -3), 0)),
    "Later": lambda t: ((3 * max(0, t - 1), 4 * max(0, t - 2)), (after(t, 1, 3), after(t, 2, 4))),
    "Ramp": lambda t: ((-1.5 * max(0, t - 1) ** 2, 2 * max(0, t - 1) ** 2), (-3 * max(0, t - 1), 4 * max(0, t - 1))),
    "Twice": lambda t: ((0.9 - 3 * t, 1.2 - 4 * t), (-3, -4)) if t < 0.3 else ((6 * max(0, t - 1.1), -8 * max(0, t - 1.1)), (after(t, 1.1, 6), after(t, 1.1, -8))),
    "Quarter": lambda t: (QUARTER(t), (6 * t * np.cos(2 * t), 6 * t * np.sin(2 * t))),
    "Reversing": lambda t: ((3 * t - 3, 4 * t - 4), (3, 4)),
    "Cusp": lambda t: ((3 * t - 3, 4 * (t - 1) ** 2), (3, 8 * t - 8)),
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {}
    for body, elements in (BODIES | PLANES).items():
        output = "" if "drive" in elements else '<output name="drive">x.force</output>'
        for method in METHODS:
            name = name_of(body, method)
            texts[name] = f'<system name="{name}">{elements}{output}<solver method="{method}" tolerance="1e-9"/></system>'
    for body, (elements, *_) in DWELLS.items():
        for method in METHODS:
            name = f"Dwells{body}{method.title()}"
            texts[name] = (f'<system name="{name}">{elements}<output name="drive">x.force</output><output name="turns">sign(v)</output>'
                           f'<solver method="{method}" tolerance="1e-9"/></system>')  # fmt: skip
    for body, (elements, _) in BY_INPUTS.items():
        drive = "x.force" if "acceleration=" in elements else "hand.force"
        for method in METHODS:
            name = f"ByInput{body}{method.title()}"
            texts[name] = (f'<system name="{name}">{elements}<output name="drive">{drive}</output><output name="turns">sign(v)</output>'
                           f'<solver method="{method}" tolerance="1e-9"/></system>')  # fmt: skip
    build_systems("given-frictions", texts)


def check(body, time, forces, is_exact):
    """
    Compare both forces. Where a drive stops, the error of a method leaves a small velocity of either sign; the drive then balances the
    friction.
    """
    if min(abs(time - 1), abs(time - 2)) < 1e-3:
        return
    if body == "Stopped" and 1 < time < 2 and not is_exact:
        assert forces[0] == pytest.approx(forces[1], abs=1e-6) and abs(forces[1]) <= 5
    else:
        assert forces == pytest.approx(FORCES[body](time), abs=1e-6), time


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("body", BODIES)
def test_forces(open_fmu, body, method):
    instance = open_fmu(name_of(body, method)).initialize()
    for time, *forces in instance.run(3, 0.125, "drive", "rub.force"):
        check(body, time, forces, method == "taylor")


@pytest.mark.parametrize("body", BODIES)
def test_in_model_exchange(body):
    rows = fmpy.simulate_fmu(str(fmu.archive(name_of(body, "taylor"))), fmi_type="ModelExchange", stop_time=3, output_interval=0.125,
                             output=["drive", "rub.force"], relative_tolerance=1e-8)  # fmt: skip
    for time, *forces in rows:
        check(body, time, forces, False)


def test_a_driven_body_carries_the_friction_of_another(open_fmu):
    """From 1 s on the drive of the second body carries the friction of the first, 5 N. From 2 s on it also carries its own inertia force of 1 N."""
    instance = open_fmu(name_of("Between", "taylor")).initialize()
    others = {time: other for time, other in instance.run(3, 0.125, "other")}
    assert [others[time] for time in (0.5, 1.5, 2.5)] == pytest.approx([0, -5, -4], abs=1e-12)
    assert np.isclose(instance.get("v"), 2) and np.isclose(instance.get("w"), 1)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("body", PLANES)
def test_forces_in_a_plane(open_fmu, body, method):
    instance = open_fmu(name_of(body, method)).initialize()
    for time, *forces in instance.run(3, 0.125, "rub.force", "rub.across.force", "drive", "across"):
        velocity, acceleration = PRESCRIBED[body](time)
        speed = np.hypot(*velocity)
        if 0 < time and min(abs(time - 1), abs(time - 2)) > 1e-3:
            friction = [5 * part / speed if speed > 0 else 0 for part in velocity]
            assert forces == pytest.approx([*friction, *np.add(friction, acceleration)], abs=1e-6), time


@pytest.mark.parametrize("steps", [1, 4, 7])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("body", ["Reversing", "Cusp"])
def test_no_force_where_a_given_velocity_passes_through_0(open_fmu, body, method, steps):
    """Where the velocity is 0, friction has no direction and no force. The drives then supply only the force of the acceleration."""
    instance = open_fmu(name_of(body, method)).initialize()
    instance.run(1, 1 / steps)
    assert instance.get("rub.force", "rub.across.force", "drive", "across") == pytest.approx([0, 0, *PRESCRIBED[body](1)[1]], abs=0.01)


def check_dwell(body, time, drive, force, turns):
    """At rest there is no force. After 2 s the second body moves k times as fast, and friction opposes it."""
    _, k, stop, rate = DWELLS[body]
    if stop + 0.01 < time < 1.99:
        assert (drive, force, turns) == (pytest.approx(0, abs=1e-12), 0, 0), time
    elif time > 2.01 and k is not None:
        direction, ratio = np.sign(rate * (k or 1)), k or 1
        assert (force, turns) == (5 * direction, np.sign(rate)), time
        assert drive == pytest.approx(rate * (1 + k**2) + ratio * 5 * direction, abs=1e-6), time


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("body", DWELLS)
def test_dwelling_drives(open_fmu, body, method):
    instance = open_fmu(f"Dwells{body}{method.title()}").initialize()
    for time, *values in instance.run(3, 0.0625, "drive", "rub.force", "turns"):
        check_dwell(body, time, *values)


@pytest.mark.parametrize("body", DWELLS)
def test_dwelling_drives_in_model_exchange(body):
    rows = fmpy.simulate_fmu(str(fmu.archive(f"Dwells{body}Taylor")), fmi_type="ModelExchange", stop_time=3, output_interval=0.0625,
                             output=["drive", "rub.force", "turns"], relative_tolerance=1e-9)  # fmt: skip
    for row in rows:
        check_dwell(body, row["time"], row["drive"], row["rub.force"], row["turns"])


@pytest.mark.parametrize("step", [0.0625, 0.05])
@pytest.mark.parametrize("path", [stop_and_go, swing_and_go])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("body", BY_INPUTS)
def test_inputs_that_dwell(open_fmu, body, method, path, step):
    """At rest no force acts. After 2 s the friction of 5 N opposes the velocity, and the drive also accelerates both bodies by 3 m/s2."""
    _, k = BY_INPUTS[body]
    instance = open_fmu(f"ByInput{body}{method.title()}")
    names = {"H": ["u", "der(u)", "der(der(u))"], "R": [None, "s", "der(s)"], "A": [None, None, "a"]}[body[0]]
    instance.initialize({name: value for name, value in zip(names, path(0)) if name})
    for i in range(round(3 / step)):
        time = i * step
        instance.set({name: value for name, value in zip(names, path(time + 1e-12)) if name})
        instance.step(step)
        drive, force, turns = instance.get("drive", "rub.force", "turns")
        if 1.01 < time + step < 1.99 or (path is stop_and_go and 0.51 < time + step < 1.99):
            assert (drive, force, turns) == (pytest.approx(0, abs=1e-12), 0, 0), time
        elif time + step > 2.01:
            direction = -np.sign(k or 1)
            assert (force, turns) == (5 * direction, -1), time
            assert drive == pytest.approx(-3 * (1 + k**2) + (k or 1) * 5 * direction, abs=1e-6), time
