"""fmu/README.md: its examples build and move by the closed forms, and its messages are those of lagc."""

import re

import numpy as np
import pytest
from scipy.linalg import eigh, expm

import fmu
from closed_forms import pendulum_angle
from examples import check_motion, examples_of
from fmu import ROOT, Instance, build_systems, lagc

pytestmark = pytest.mark.release

REFERENCE = (ROOT / "fmu" / "README.md").read_text()
EXAMPLES = examples_of(REFERENCE)


def band_brake(t):
    forth, back = 2 * np.expm1(0.9), -2 * np.expm1(-0.9)
    stop = min(t, 0.1 * 10 / forth)
    return {"phi": 10 * stop - forth / 0.1 * stop**2 / 2 - (2 - back) / 0.1 * max(0, t - 0.5) ** 2 / 2}


def wall(t):
    """Free flight to x = 0 at 0.5 s, half a period on the spring, and back."""
    rate, contact = 10.0, np.pi / 10
    if t < 0.5:
        return 1 - 2 * t
    if t < 0.5 + contact:
        return -2 / rate * np.sin(rate * (t - 0.5))
    return 2 * (t - 0.5 - contact)


def damped(t):
    d, w = 1.0, np.sqrt(24.0)
    swing, slope = np.cos(w * t) + d / w * np.sin(w * t), -(w + d * d / w) * np.sin(w * t)
    x, v = 0.3 * np.exp(-d * t) * swing, 0.3 * np.exp(-d * t) * slope
    return {"x": x, "v": v, "nonConservativeWork": (v * v + 25 * x * x) / 2 - 25 * 0.3**2 / 2}


def stiff(t):
    root = np.sqrt(1e8 - 4e4)
    slow, fast = -2e4 / (1e4 + root), -(1e4 + root) / 2  # first root without cancellation
    return {"x": (slow * np.exp(fast * t) - fast * np.exp(slow * t)) / (slow - fast)}


def chain(t):
    w = 2 * np.sqrt(10) * np.sin(np.pi / 6)
    return {f"x[{i}]": 0.1 * np.sin(np.pi * i / 3) * np.cos(w * t) for i in range(1, 6)}


def coupled(t):
    mean, half = 0.1 * np.cos(np.sqrt(25 / 2) * t), 0.2 * np.cos(np.sqrt(49 / 2) * t)
    return {"left.x": mean + half, "right.x": mean - half, "distance": -2 * half, "left.m": 2.0}


def rocket(t):
    m, u, gain = 100 - 4 * t, 500, np.log(100 / (100 - 4 * t))
    return {"v": u * gain - 9.81 * t, "z": u * t - u * m / 4 * gain - 9.81 * t**2 / 2}


def rod_forces(t):
    angle = pendulum_angle(1, np.sqrt(9.81 / 0.5), t)
    tension = 2 * 9.81 * (3 * np.cos(angle) - 2 * np.cos(1))
    return {"tension": tension, "bearing": abs(tension), "px.force": tension * np.sin(angle),
            "py.force": -tension * np.cos(angle), "stretch.force": tension}  # fmt: skip


def motor_and_bead(t):
    r, vr = 0.2 * np.cosh(2 * t), 0.4 * np.sinh(2 * t)
    work = 0.1 * (vr**2 + (2 * r) ** 2 - 0.4**2) / 2
    return {"phi": 2 * t, "W": 2, "r": r, "torque": 2 * 0.1 * r * vr * 2, "nonConservativeWork": work}


def trolley(t):
    tilt, rate = np.arctan(2 / 9.81), np.sqrt(np.hypot(2, 9.81) / 4)
    angle = pendulum_angle(tilt, rate, t)
    theta, squared = angle - tilt, 2 * rate**2 * (np.cos(angle) - np.cos(tilt))
    force = 150 * 2 + 50 * 4 * (-(rate**2) * np.sin(angle) * np.cos(theta) - squared * np.sin(theta))
    return {"x": t**2, "v": 2 * t, "theta": theta, "x.force": force}


def floor_and_seat(t):
    d, w = 1.0, np.sqrt(99.0)
    decay = np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))
    return {"z": 0.1 * (1 - decay), "stretch": -0.1 * decay, "floor.z": 0.1}


def rod_pendulum(t):
    angle = pendulum_angle(1, np.sqrt(9.81 / 0.5), t)
    square = 2 * 9.81 * 0.5 * (np.cos(angle) - np.cos(1))  # v^2
    return {"x": 0.5 * np.sin(angle), "y": -0.5 * np.cos(angle), "tension": 2 * (square / 0.5 + 9.81 * np.cos(angle))}


def skate(t):
    scale = 9.81 * np.sin(0.1) / 8
    return {"x": scale * np.sin(2 * t) ** 2, "y": scale * (2 * t - np.sin(4 * t) / 2)}


def block(t):
    stop = 2 / (0.3 * 9.81)
    moving = min(t, stop)
    return {"x": 2 * moving - 0.3 * 9.81 * moving**2 / 2, "v": 2 - 0.3 * 9.81 * moving}


def cue_ball(t):
    spin, velocity = 0.0286 * np.array([-10, -20]), np.array([1, 0])  # peripheral velocity of rolling with this spin
    slip = velocity - spin
    size = np.linalg.norm(slip)
    slides = min(t, 2 * size / (7 * 0.2 * 9.81))
    end = velocity - 0.2 * 9.81 * slides * slip / size
    place = (velocity + end) / 2 * slides + end * (t - slides)
    return {"x": place[0], "y": place[1], "vx": end[0], "vy": end[1], "h": 0}


def dropped_ball(t):
    """Parabolas between bounces; each bounce halves the velocity."""
    flight, velocity = 2 * np.sqrt(2 / 9.81), np.sqrt(2 * 9.81)
    t += flight / 2
    while t >= flight and flight > 1e-14:
        t, flight, velocity = t - flight, flight / 2, velocity / 2
    h = velocity * t - 9.81 * t**2 / 2 if t < flight else 0.0
    return {"h": h, "ground.force": 9.81 if t >= flight else 0.0}


def thermostat(t):
    """rate = u/10 + (rate0 - u/10) exp(-10 s) between switches; bisection finds the switching times."""
    T, rate, u, turns = 20.0, 0.0, 1.0, 0
    motion = lambda s: T + u / 10 * s + (rate - u / 10) * (1 - np.exp(-10 * s)) / 10
    while True:
        crossing = lambda s: (motion(s) - (20 + 0.2 * u)) * u
        first, last = 1e-3, t + 1e-3
        if crossing(last) <= 0:
            break
        while last - first > 1e-15 * t:
            middle = (first + last) / 2
            first, last = (middle, last) if crossing(middle) < 0 else (first, middle)
            if middle in (first, last) and last - first < 1e-13:
                break
        if first > t:
            break
        T, rate, u, turns, t = motion(first), u / 10 + (rate - u / 10) * np.exp(-10 * first), -u, turns + (u > 0), t - first
    return {"T": motion(t), "heats": float(u > 0), "turns": turns}


def hand_and_bob(t):
    angle = pendulum_angle(1, np.sqrt(9.81 / 0.5), t)
    return {"x": 0.1, "theta": angle, "hand.force": -2 * 9.81 * (3 * np.cos(angle) - 2 * np.cos(1)) * np.sin(angle)}


def rack_and_wheels(t):
    x = 0.2 * np.cos(np.sqrt(1.5) / 0.2 * t)
    return {"x": x, "a": 10 * x, "b": 5 * x, "teeth.force": 2 * 1.5 / 0.04 * x}


def beam_on_three(t):
    share, lever = 25 * 9.81 / 3, 5 * 9.81 * (0.5 * t - 1) / 3
    return {"s": 0.5 * t - 1, "left.force": share - lever, "middle.force": share, "right.force": share + lever, "z": 0.0}


def ball_on_slope(t):
    """Rolling without slip; the regularized friction creeps by 0.2 mm/s."""
    return {"x": 5 / 14 * 9.81 * np.sin(0.3) * t**2, "touch.force": 2 * 9.81 * np.cos(0.3)}


def swing(t):
    """The arm hangs at rest within its limits."""
    return {"hinge": 0, "tool_z": 1, "tool_x": 0, "hinge_beyond": 0}


def torsion(t):
    return {"twist": 0.3 * (1 - np.cos(np.sqrt(0.5 / 0.12) * t))}


def swing_in_orbit(t):
    theta = 0.5 * np.cos(2 * t)
    return {"robot.hinge": theta, "reach": np.sin(theta), "robot.tool_z": 2}


def lagged_actuator(t):
    m, k, T, kp, ki, b, ref = 2, 8, 0.05, 20, 8, 6, 0.1
    rates = [[0, 1, 0, 0, 0], [-k / m, -b / m, 0, 1 / m, 0], [-1, 0, 0, 0, ref], [-kp / T, 0, ki / T, -1 / T, kp * ref / T], [0] * 5]
    return dict(zip(["x", "v", "xi", "F"], expm(t * np.array(rates)) @ [0, 0, 0, 0, 1]))


def limited_controller(t):
    """Saturated until `first`, and again once the integral is (5/2 - 1)/2."""
    first, decay = -np.log(0.15) / 100, np.exp(-100 * t)
    integral = min(max(0, t - first), 0.75)
    return {"D": 1 - decay, "I": integral, "u": min(5, 2 * (1 + 2 * integral + 10 * decay))}


def wavy_road(t):
    W, w, p = np.pi, 5.0, 2 * np.pi / 3
    mass = lambda p: 0.02 / (1 - (W / w) ** 2) * (np.sin(W * t - p) + np.sin(p) * np.cos(w * t) - W / w * np.cos(p) * np.sin(w * t))
    return {"front": mass(0), "rear": mass(p)}


def cantilever(t):
    M, K = 3 * np.array([[1 / 5, 1 / 6], [1 / 6, 1 / 7]]), 5 * np.array([[4, 6], [6, 12]])
    squares, modes = eigh(K, M)
    q = modes @ (np.cos(np.sqrt(squares) * t) * (modes.T @ M @ [0.1, 0]))
    return {"q1": q[0], "q2": q[1], "tip": q[0] + q[1], "turned": (2 * q[0] + 3 * q[1]) / 2}


def sampled_shaft(t):
    """Deadbeat control: one period of delay, one of acceleration, one of deceleration."""
    s = t / 0.01 - 1
    phi = 0.0 if s < 0 else s**2 / 2 if s < 1 else 1 - (2 - s) ** 2 / 2 if s < 2 else 1.0
    return {"phi": 0.5 * phi}


# Closed form of each example at any time, by variable name, and the largest error.
MOTIONS = {
    "Pendulum": (lambda t: {"theta": (angle := pendulum_angle(1, np.sqrt(9.81 / 0.5), t)), "height": 0.5 - 0.5 * np.cos(angle)}, 1e-6),
    "Rod": (lambda t: {"theta": pendulum_angle(1, np.sqrt(1.5 * 9.81 / 0.5), t), "J": 0.25 / 3, "w": np.sqrt(1.5 * 9.81 / 0.5)}, 1e-6),
    "ReleasedPendulum": (lambda t: {"theta": pendulum_angle(np.arccos(0.6), np.sqrt(9.81 / 0.5), t)}, 1e-6),
    "Scale": (lambda t: {"theta": 5 * 0.02 * t**2 / (2 * (0.09 + 0.08 + 0.04)), "a[2]": 0.2}, 1e-12),
    "Catapult": (lambda t: {"x": 1 - np.cos(2 * t) if t < np.pi / 4 else 1 + 2 * (t - np.pi / 4)}, 1e-7),
    "MotorMap": (lambda t: {"w": 1.5 * (1 - np.exp(-4 * t)), "phi": 1.5 * t - 0.375 * (1 - np.exp(-4 * t))}, 1e-7),
    "Elevator": (lambda t: {"z": 0.5 * t**3 / 6, "speed": 0.25 * t**2, "weight": 60 * (9.81 + 0.5 * t)}, 1e-9),
    "DiskOnSlope": (lambda t: {"s": 9.81 * 0.5 * t**2 / 3, "disk.angle": -9.81 * 0.5 * t**2 / 0.3}, 1e-9),
    "BeadOnRod": (lambda t: {"r": 0.2 * np.cosh(2 * t), "bead.x": 0.2 * np.cosh(2 * t) * np.cos(2 * t)}, 1e-7),
    "Hoist": (lambda t: {"x": 5 * 9.81 * t**2 / (2 * (5 + 0.04 * 9 / 0.04))}, 1e-9),
    "Rocket": (rocket, 1e-6),
    "HeapedChain": (lambda t: {"x": 9.81 * (0.5 + t)**2 / 6, "v": 9.81 * (0.5 + t) / 3}, 1e-8),
    "RodPendulum": (rod_pendulum, 1e-6),
    "Skate": (skate, 1e-7),
    "RackAndWheels": (rack_and_wheels, 1e-5),
    "BeamOnThree": (beam_on_three, 1e-10),
    "LeaningGate": (lambda t: {"load": -20 * 9.81 * np.cos(0.3), "gate.z": -0.6 * np.sin(0.3) * np.cos(float(pendulum_angle(np.pi / 2, np.sqrt(9.81 * np.sin(0.3) / 0.8), t)))}, 1e-6),
    "BallOnTurntable": (lambda t: {"x": 0.1 + 0.15 * np.sin(2 * t), "y": 0.15 * (1 - np.cos(2 * t)), "z": 0.03, "contact.forceZ": -0.2 * 9.81}, 1e-6),
    "TiltedOrbit": (lambda t: {"x": 0.5 * np.cos(3 * t), "z": 0.5 * np.sin(3 * t) * np.sin(0.6), "swept": 0.375, "leaning": 0.6}, 1e-6),
    "Mount": (lambda t: {"x": 0.1 * np.cos(5 * t), "phi": float(pendulum_angle(1.0, 4.0, t))}, 1e-6),
    "Sling": (lambda t: {"x": np.cos(10**0.5 * t), "y": np.sin(10**0.5 * t), "sling.force": 20, "sling.length": 1}, 1e-7),
    "BlockOnRoller": (lambda t: {"x": 0.1 * (1 - np.cos(3 * t))}, 1e-7),
    "BallOnSlope": (ball_on_slope, 1e-3),
    "Turntable": (lambda t: {"theta": t**2, "omega": 2 * t, "inwards": 0.5 * (2 * t) ** 2, "disk.alphaZ": 2}, 1e-8),
    "FreeTop": (lambda t: {"theta": 0.5, "phi": 2 * t, "psi": 4 * np.cos(0.5) * t}, 1e-7),
    "Thrown": (lambda t: {"bob.z": -9.81 * t**2 / 2, "a": np.cos(1.5 * t), "d": np.sin(1.5 * t), "bob.omegaZ": 3}, 1e-7),
    "Cyclotron": (lambda t: {"x": (1 - np.cos(1.5 * t)) / 1.5, "y": np.sin(1.5 * t) / 1.5}, 1e-6),
    "Wall": (lambda t: {"x": wall(t)}, 1e-6),
    "DampedOscillator": (damped, 1e-6),
    "MotorAndBead": (motor_and_bead, 1e-6),
    "DrivenTrolley": (trolley, 1e-5),
    "FloorAndSeat": (floor_and_seat, 1e-7),
    "HandAndBob": (hand_and_bob, 1e-5),
    "RodForces": (rod_forces, 1e-5),
    "ThrustedArm": (lambda t: {"theta": 1.5 * 2 * t**2 / (2 * 3)}, 1e-9),
    "LaggedActuator": (lagged_actuator, 1e-6),
    "LimitedController": (limited_controller, 1e-9),
    "WavyRoad": (wavy_road, 1e-7),
    "Cantilever": (cantilever, 1e-6),
    "SlidingBlock": (block, 1e-12),
    "BandBrake": (band_brake, 1e-12),
    "CueBall": (cue_ball, 1e-9),
    "DroppedBall": (dropped_ball, 1e-12),
    "Shuttle": (lambda t: {"x": t if t < 0.3 else 0.3 - (t - 0.3) / 2 if t < 1.3 else -0.2 + (t - 1.3) / 4}, 1e-12),
    "Thermostat": (thermostat, 1e-9),
    "SampledShaft": (sampled_shaft, 1e-12),
    "Latch": (lambda t: {"x": (10 * t**3 - 1.25) / 6 - 1.25 * (t - 0.5) if t > 0.5 else 0}, 1e-12),
    "MassChain": (chain, 1e-6),
    "CoupledMasses": (coupled, 1e-6),
    "Swing": (swing, 0.0),
    "Torsion": (torsion, 1e-9),
    "SwingInOrbit": (swing_in_orbit, 1e-6),
    "LimitedGain": (lambda t: {"F": -4.0}, 0.0),
    "StiffDamper": (stiff, 1e-5),
    "LinearPendulum": (lambda t: {"theta": np.pi + (1 - np.pi) * np.cosh(np.sqrt(9.81 / 0.5) * t)}, 1e-8),
}


@pytest.fixture(scope="module", autouse=True)
def examples():
    build_systems("reference", EXAMPLES)


def test_every_example_is_checked():
    assert set(MOTIONS) == set(EXAMPLES)


def test_examples_are_plain_c11():
    """The sources compile as plain C11, alternately by gcc and clang."""
    for i, name in enumerate(EXAMPLES):
        source = fmu.unpacked(name) / "sources" / f"{name}.c"
        assert fmu.complaints_about(source, ["gcc", "clang"][i % 2]) == "", name


@pytest.mark.parametrize("name", MOTIONS)
def test_example_moves_by_its_closed_form(name, open_fmu):
    motion, allowed = MOTIONS[name]
    check_motion(open_fmu(name).initialize(), EXAMPLES[name], motion, allowed)


def test_limited_gain_at_its_limits(open_fmu):
    instance = open_fmu("LimitedGain").initialize()
    for value, expected in [(3.0, -10.0), (-3.0, 10.0), (0.25, -1.0)]:
        instance.set(e=value)
        assert instance.get("F") == expected


def test_robot_swings_from_elsewhere(open_fmu):
    """J theta'' = tau - 1.5 g sin(theta), and the position of the tool."""
    instance = open_fmu("Swing").initialize({"hinge": 1.0, "hinge_torque": 2.0})
    assert instance.get("der(hinge_velocity)") == pytest.approx(2 - 1.5 * 9.81 * np.sin(1), rel=1e-14)
    assert instance.get("tool_x", "tool_z") == pytest.approx([np.sin(1), 2 - np.cos(1)])
    instance.reset().initialize({"hinge": 1.0})
    instance.step(0.7)
    assert instance.get("hinge") == pytest.approx(pendulum_angle(1, np.sqrt(1.5 * 9.81), 0.7), abs=1e-6)


def test_every_word_and_attribute_is_described():
    for kind, name in map(str.split, lagc("--words").stdout.splitlines()):
        assert re.search({"element": rf"<{name}\b", "function": rf"\b{name}\b[ `(]", "name": rf"`{name}`"}[kind], REFERENCE), (kind, name)
    schema = (ROOT / "fmu" / "system.xsd").read_text()
    for attribute in re.findall(r'<xs:attribute name="(\w+)"', schema):
        assert re.search(rf"\b{attribute}\b", REFERENCE), attribute


def test_variables_that_come_out(open_fmu):
    table = REFERENCE[REFERENCE.index("## What comes out") : REFERENCE.index("## Limits")]
    variables = {v.name: v.causality for v in open_fmu("Pendulum").description.modelVariables}
    assert all(f"`{name}`" in table for name in variables if name not in ("l", "g"))
    for name, causality in [("theta", "output"), ("der(omega)", "local"), ("tau", "input"), ("m", "parameter"),
                            ("height", "output"), ("bob.x", "local"), ("totalEnergy", "local")]:  # fmt: skip
        assert variables[name] == causality


def rows(title):
    """Pairs (line, message) of a table of the reference."""
    part = REFERENCE[REFERENCE.index(title) :]
    table = re.search(r"\| line \| message \|\n.*?\n((?:\|.*\n)+)", part).group(1)
    return [(line.replace("\\|", "|"), messages.replace("\\|", "|")) for line, messages in re.findall(r"^\| `(.*?)` \| `(.*?)` \|$", table, re.M)]


def compile_with(line, folder):
    (folder / "system.xml").write_text(EXAMPLES["Pendulum"].replace("</system>", f"  {line}\n</system>"))
    return lagc("system.xml", "-o", "out", cwd=folder)


@pytest.mark.parametrize("line, message", rows("## Error messages"))
def test_errors_are_those_of_the_reference(line, message, tmp_path):
    result = compile_with(line, tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr


@pytest.mark.parametrize("line, message", rows("These are likely mistakes"))
def test_warnings_are_those_of_the_reference(line, message, tmp_path):
    result = compile_with(line, tmp_path)
    assert result.returncode == 0 and "warning" in result.stderr and message in result.stderr, result.stderr
