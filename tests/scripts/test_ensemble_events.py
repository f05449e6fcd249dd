"""Events and constraints of many runs at once (src/ensemble/lane_events.c), against single runs of the FMU."""

import numpy as np
import pytest

from building import build_systems
from ensemble_runs import HERE, alone, assert_as_alone, assert_same_bits, ensemble, starts, states

# Ranges of the varied values, and the end. Covers contacts, stops, frictions, events that set modes, loops, wheels.
SYSTEMS = {
    "BouncingBall": ({"h": (0.2, 2), "v": (-2, 2), "e": (0, 0.9)}, 3),
    "HardStopPendulum": ({"theta": (-0.1, 1), "omega": (-2, 2), "e": (0, 1)}, 3),
    "StickSlip": ({"k": (0.5, 2), "vBelt": (0.05, 0.2), "x": (-0.5, 0.5)}, 20),
    "NewtonsCradle": ({"l": (0.2, 0.4)}, 1),
    "PassiveWalker": ({"mHip": (9.9, 10.1)}, 2),
    "VibratingTable": ({"m": (0.5, 2), "g": (9, 10)}, 0.5),
    "FourBar": ({"a": (0.28, 0.32)}, 1),
    "PendulumCartesian": ({"l": (0.5, 1), "g": (5, 10)}, 3),
    "KnifeEdge": ({"m": (0.5, 2), "J": (0.1, 0.3)}, 3),
    "RollingDisk": ({"m": (0.5, 2)}, 1),
    "FreeBody": ({"m": (0.5, 2)}, 1),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_each_run_is_that_of_the_fmu_alone(name):
    """Each run agrees after events too; there are more runs than lanes."""
    assert_as_alone(name, *SYSTEMS[name], 2 * HERE + 1, 2e-8)


@pytest.mark.parametrize("name", ["BouncingBall", "HardStopPendulum", "PendulumCartesian"])
def test_a_run_has_the_same_bits_among_any_others(name):
    assert_same_bits(name, *SYSTEMS[name])


def test_long_runs_keep_to_their_constraints():
    """At a loose tolerance, whose errors would let the motion drift off its circle."""
    rows, recorded = starts({"l": (0.5, 1), "g": (5, 10)}, 20), ["x", "y", "vx", "vy"]
    values, _ = ensemble("PendulumCartesian", ["l", "g"], recorded, [30.0], tolerance=1e-6).run(rows)
    expected = [alone("PendulumCartesian", dict(zip(("l", "g"), row)), recorded, 30.0, tolerance=1e-6)[-1] for row in rows]
    np.testing.assert_allclose(values[:, 0], expected, atol=1e-7)


def ball(height, e, time, g=9.81):
    """Height and velocity of a dropped ball: flights, each shorter by the factor e, and then rest."""
    t, speed = np.sqrt(2 * height / g), np.sqrt(2 * g * height)
    if time < t:
        return height - g * time**2 / 2, -g * time
    while speed > 1e-12:
        speed *= e
        s = time - t
        if s < 2 * speed / g:
            return speed * s - g * s**2 / 2, speed - g * s
        t += 2 * speed / g
    return 0.0, 0.0


def test_balls_in_closed_form():
    """At the end some balls still fly; others rest after infinitely many bounces."""
    rows, times = starts({"h": (0.2, 2), "e": (0.1, 0.95)}, 60), [0.1, 0.9, 2.2, 3.0]
    values, needs_fmu = ensemble("BouncingBall", ["h", "e"], ["h", "v"], times).run(rows)
    exact = np.array([[ball(*row, time) for time in times] for row in rows])
    assert not needs_fmu.any() and 20 < np.sum(exact[:, -1, 1] == 0.0) < 55
    np.testing.assert_allclose(values[:, :, 0], exact[:, :, 0], atol=1e-9)
    np.testing.assert_allclose(values[:, :, 1], exact[:, :, 1], atol=1e-8)


def test_an_impact_at_the_start():
    """Values at the start are those after the impact."""
    values, _ = ensemble("BouncingBall", ["h", "v", "e"], ["h", "v"], [0.0, 0.1]).run([[0.0, -2.0, 0.5]])
    np.testing.assert_allclose(values[0], [[0, 1], [0.1 - 9.81 * 0.005, 1 - 0.981]], atol=1e-12)


SYSTEM = '<system name="{name}"><coordinate name="x" velocity="v"/><particle name="p" mass="1" x="x"/>{more}<solver method="taylor"/></system>'
WALL = '<parameter name="w" start="1e-3"/><contact name="wall" gap="1 - exp(-((x - 1)/w)^2) - 0.5*exp(-((x - 1)/w)^2)" restitution="1"/>'
DOOR = (
    '<parameter name="force" start="0"/><mode name="pushes" start="1"/><potential>-pushes*force*x</potential>'
    '<event when="x - 1" direction="rising"><set mode="pushes">0</set><set velocity="v">v/2</set></event>'
)
CHATTER = '<event when="x" direction="falling"><set velocity="v">-0.5*v</set></event><potential>x</potential>'


@pytest.fixture(scope="module")
def of_tests():
    kinds = {"NarrowWall": WALL, "Door": DOOR, "Chatter": CHATTER}
    build_systems("ensemble-events", {name: SYSTEM.format(name=name, more=more) for name, more in kinds.items()})


def test_a_narrow_wall_is_not_passed_over(of_tests):
    """A narrow hill closes a gap that is flat where the particle starts: it is reflected at 1 - w sqrt(ln 1.5)."""
    rows = np.array([[speed, w] for speed in (0.7, 1.0, 3.0) for w in (1e-2, 1e-4)])
    values, needs_fmu = ensemble("NarrowWall", ["v", "w"], ["x", "v"], [4.0]).run(rows)
    wall = 1 - rows[:, 1] * np.sqrt(np.log(1.5))
    assert not needs_fmu.any()
    np.testing.assert_allclose(values[:, 0], np.array([2 * wall - 4 * rows[:, 0], -rows[:, 0]]).T, atol=1e-9)


def test_events_that_set_modes(of_tests):
    """A force acts up to x = 1, where an event halves the velocity."""
    rows = np.array([[0.5, 1.0], [1.0, 0.0], [2.0, 0.3], [8.0, 0.0]])
    values, needs_fmu = ensemble("Door", ["force", "v"], ["x", "v"], [3.0]).run(rows)
    force, start = rows.T
    speed = np.sqrt(start**2 + 2 * force)
    time = (speed - start) / force
    assert not needs_fmu.any()
    np.testing.assert_allclose(values[:, 0], np.array([1 + speed / 2 * (3 - time), speed / 2]).T, rtol=1e-9)


def test_runs_that_fail_are_left_to_the_fmu(of_tests):
    """A ball below the ground, and an <event> with Zeno behaviour, are left to the FMU; other runs are unaffected."""
    assert list(ensemble("BouncingBall", ["h"], ["h"], [1.0]).run([[-1.0], [1.0]])[1]) == [True, False]
    values, needs_fmu = ensemble("Chatter", ["x", "v"], ["x"], [5.0]).run([[1.0, 0.0], [20.0, 1.0], [0.0, 0.5]])
    assert list(needs_fmu) == [True, False, True] and values[1, 0, 0] == pytest.approx(20 + 5 - 12.5, abs=1e-9)
