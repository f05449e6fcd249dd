"""Random systems (differential/) against SymPy's equations integrated in long doubles; scripts/checks/differential runs thousands."""

import copy
import faulthandler
import math
import os
import signal

import numpy as np
import pytest

from differential import simulation, switching_generator
from differential.build import Wrong
from differential.comparison import judge_system
from differential.derivation import Derivation
from differential.draw import Draw, absolute, exp
from differential.event_reference import EventReference
from differential.expressions import function, name, node
from differential.generator import generate
from differential.reference import Reference
from differential.skeletons import coordinate, body
from differential.switches import Contact, Event, Friction, Switches
from differential.system import Action, Plan, System, Table
from references import ExactMotion

SEED = 644
COUNT = int(os.environ.get("RANDOM_SYSTEMS", "23"))  # the smallest count that has all families of equations, with this seed
# Seeds with contacts, stops, friction, events, frames, hills and event mode; scripts/checks/differential --kind switching runs many.
SWITCHING = [34, 47, 52]
SMOOTH = {
    "smooth_potential",
    "smooth_force",
    "smooth_dissipation",
    "cartesian_force",
    "definition",
    "time_function",
    "magnetic",
}
TIME_LIMIT = 300  # s; each runs for a few seconds


@pytest.mark.long
@pytest.mark.parametrize("number", range(COUNT))
def test_random_system(number, tmp_path):
    """Wrong values, crashes, hangs, and C that does not compile are failures. An error is accepted if it has a message."""
    system = generate(SEED, number)
    system.plan.unrolled = False  # unrolled code compiles slowly; the systems of fmu/ cover it
    outcome = judge_system(system, tmp_path, TIME_LIMIT)
    assert outcome.verdict != "wrong", f"{outcome.message}\n{system.xml()}\n{system.plan}"


@pytest.mark.long
@pytest.mark.parametrize("number", SWITCHING)
def test_random_system_that_switches(number, tmp_path):
    """The same for random systems with events, through event mode of FMI 3.0 if the plan says so."""
    system = switching_generator.generate(1, number)
    outcome = judge_system(system, tmp_path, TIME_LIMIT)
    assert outcome.verdict == "agrees", f"{outcome.message}\n{system.xml()}\n{system.plan}"


def test_the_systems_have_everything():
    """The systems of one run have every family of equations that a hundred systems have."""
    families = lambda count: {family for number in range(count) for family in generate(SEED, number).families}
    assert families(COUNT) >= families(100)


def test_a_system_is_the_same_everywhere():
    """The generator depends on no hash and on no order of a set."""
    assert generate(7, 11).xml() == generate(7, 11).xml()
    assert generate(7, 11).xml() != generate(7, 12).xml()


def oscillator(*forces, start=(1.0, 0.0), length=2.0, steps=1):
    """System q'' = force, of mass 1."""
    system = System("Oscillator", plan=Plan(0.0, length, [Action() for _ in range(steps)], 1e-10))
    draw = Draw(0, system)
    q, _ = coordinate(draw, *start)
    body(draw, node(1), x=q)
    system.forces = [("q1", force) for force in forces]
    return system


def follow(system, folder):
    """State at the end by both references, and their difference."""
    reference = Reference(Derivation(system), folder)
    exact, other = reference.trajectory(7, 1e-16, 0.5), reference.trajectory(5, 1e-15, 0.3)
    return exact[-1], np.max(np.abs(exact - other))


def test_wrong_results_are_found(tmp_path):
    """An FMU of another system, whose spring is 1e-6 stiffer, is judged wrong."""
    right = oscillator(-4 * name("q1"))
    assert judge_system(right, tmp_path / "right").verdict == "agrees"
    stiffer = copy.deepcopy(right)
    stiffer.forces = [("q1", -node("4.000004") * name("q1"))]
    right.xml = stiffer.xml
    outcome = judge_system(right, tmp_path / "wrong")
    assert outcome.verdict == "wrong" and "der(v1) at 0.0" in outcome.message


def abort():
    """Crash as C code does, without Python's report in the log of the tests."""
    faulthandler.disable()
    os.abort()


@pytest.mark.parametrize("fate, message", [(abort, "ended with -6"), (signal.pause, "runs for more than 1 s")])
def test_crashes_and_hangs_are_found(fate, message, tmp_path, monkeypatch):
    monkeypatch.setattr(simulation, "simulate", lambda *arguments: fate())
    with pytest.raises(Wrong, match=message):
        simulation.simulate_apart(oscillator(), tmp_path, 1)


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-5])
def test_reference_sees_a_pulse(width, tmp_path):
    """q'' = exp(-((t - 1)/w)^2) from rest: the velocity becomes w sqrt(pi), and the path within the last 1 s has the same value."""
    pulse = exp(-(((name("time") - 1) / node(width)) ** 2))
    (q, v), doubt = follow(oscillator(pulse, start=(0.0, 0.0)), tmp_path)
    impulse = width * math.sqrt(math.pi)
    assert doubt < 1e-14 and v == pytest.approx(impulse, abs=1e-14) and q == pytest.approx(impulse, abs=1e-14)


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-5])
def test_reference_sees_a_hill(width, tmp_path):
    """q'' = -dU/dq, U = 1/4 exp(-(q/w)^2), passed at 1 m/s: the delay is the integral of (1/v - 1) dq."""
    shape = name("q1") / node(width)
    (q, v), doubt = follow(oscillator(shape / (2 * node(width)) * exp(-(shape**2)), start=(-1.0, 1.0)), tmp_path)
    s = np.linspace(-10, 10, 4001)  # the trapezoidal rule converges exponentially
    loss = width * np.trapezoid(1 / np.sqrt(1 - 0.5 * np.exp(-(s**2))) - 1, s)
    assert doubt < 1e-13 and v == pytest.approx(1, abs=1e-14) and q == pytest.approx(1 - loss, abs=1e-13)


def test_reference_sees_a_kink(tmp_path):
    """q'' = -|q| from q = 0 at 1 m/s: a sine until pi, then a hyperbolic sine."""
    (q, v), doubt = follow(oscillator(-absolute(name("q1")), start=(0.0, 1.0), length=5.0), tmp_path)
    assert doubt < 1e-13
    assert q == pytest.approx(-math.sinh(5 - math.pi), rel=1e-14) and v == pytest.approx(
        -math.cosh(5 - math.pi), rel=1e-14
    )


def test_reference_switches(tmp_path):
    """
    Closed forms of three motions. A ball under g = 2 falls from 1 m, bounces with restitution 0.5 and rests from t = 3. A mass at 1 m/s,
    braked by a friction of 0.5, stops at x = 1 at t = 2. A force of 1/w acts while a narrow hill of time exceeds 0.5, and an event counts
    both crossings.
    """
    w = 1e-4
    system = System("Known", plan=Plan(0.0, 4.0, [Action() for _ in range(8)], 1e-10), switches=Switches(are_followed=True, finest=w / 20))
    draw = Draw(0, system)
    for start, rate in ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0)):
        body(draw, node(1), x=coordinate(draw, start, rate)[0])
    hill = exp(-(((name("time") - 0.7) / node(w)) ** 2))
    system.forces = [("q1", node(-2)), ("q3", function("if", function(">", hill, 0.5), node(1 / w), 0))]
    system.switches.contacts.append(Contact("ground", name("q1"), 0.5))
    system.switches.frictions.append(Friction("rub", name("v2"), node(0.5), node(0.5)))
    system.switches.modes["n"] = 0.0
    system.switches.events.append(Event(hill - 0.5, "both", [("mode", "n", name("n") + 1)]))
    rows = EventReference(Derivation(system), tmp_path).trajectory(7, 1e-16, 0.5)
    push = 2 * math.sqrt(math.log(2))
    column = lambda label: rows[[0, 1, 3, 7, 8], system.columns.index(label)]  # at 0, 0.5, 1.5, 3.5 and 4
    assert column("q1") == pytest.approx([1, 0.75, 0.25, 0, 0], abs=1e-12)
    assert list(column("ground.closed")) == [0, 0, 0, 1, 1] and column("ground.force") == pytest.approx([0, 0, 0, 2, 2])
    assert column("q2") == pytest.approx([0, 0.4375, 0.9375, 1, 1], abs=1e-14)
    assert list(column("rub.sliding")) == [1, 1, 1, 0, 0] and list(column("n")) == [0, 0, 2, 2, 2]
    assert column("v3") == pytest.approx([0, 0, push, push, push], rel=1e-13)
    assert column("q3")[2:] == pytest.approx(push * np.array([0.8, 2.8, 3.3]), rel=1e-13)


S1, S2, GRAVITY = 0.25, 0.75, 2.0  # slopes on either side of a knot at x = 1, y = 0.25


def ramp(gap, rates, restitution):
    """A point under gravity that starts at the knot with these rates."""
    system = System("Ramp", plan=Plan(0.0, 0.5, [Action() for _ in range(2)], 1e-10), switches=Switches(are_followed=True))
    system.tables.append(Table("profile", [0.0, 1.0, 2.0], [0.0, S1, S1 + S2], "linear"))
    draw = Draw(0, system)
    places = [coordinate(draw, start, rate)[0] for start, rate in zip((1.0, S1), rates)]
    body(draw, node(1), x=places[0], y=places[1])
    system.forces = [("q2", node(-GRAVITY))]
    system.switches.contacts.append(Contact("ground", gap, restitution))
    return system


@pytest.mark.parametrize("gap", [name("q2") - function("profile", name("q1")),
                                 name("q2") - 0.25 * name("q1") - 0.25 * (name("q1") - 1 + absolute(name("q1") - 1))])  # fmt: skip
@pytest.mark.parametrize("restitution, direction", [(0.5, 1), (0.0, 1), (0.5, -1)])
def test_reference_starts_at_a_knot(gap, restitution, direction, tmp_path):
    """
    Up along S1 onto the slope S2, Newton's law of restitution gives the impulse per mass (1 + e) (S2 - S1)/(1 + S2^2) along the normal
    (-S2, 1). Down from the knot the point stays on S1.
    """
    system = ramp(gap, (direction, direction * S1), restitution)
    rows = EventReference(Derivation(system), tmp_path).trajectory(7, 1e-16, 0.5)
    push = (1 + restitution) * (S2 - S1) / (1 + S2**2) if direction > 0 else 0.0
    vx, vy, t = direction - S2 * push, direction * S1 + push, 0.25
    pull = -GRAVITY * (S1 if direction < 0 else S2) / (1 + (S1 if direction < 0 else S2) ** 2)
    flies = restitution > 0 and direction > 0
    x = 1 + vx * t + (0 if flies else pull * t**2 / 2)
    y = S1 + vy * t - GRAVITY * t**2 / 2 if flies else S1 + (x - 1) * (S1 if x < 1 else S2)
    assert rows[1][:2] == pytest.approx([x, y], abs=1e-12)
    outcome = judge_system(system, tmp_path / "fmu")
    assert outcome.verdict == "agrees", outcome.message


def test_reference_agrees_with_taylor_series(tmp_path):
    """The reference agrees with FLINT's series at 30 digits on smooth systems without narrow forces."""
    compared = 0
    for number in range(400):
        system = generate(SEED, number)
        # ExactMotion supports neither kinks nor changed parameters, and its atan2 has one branch.
        if not system.families <= SMOOTH | {f for f in system.families if f.startswith("skeleton")}:
            continue
        if system.work or "atan2" in system.xml() or any(action.parameters for action in system.plan.actions):
            continue
        folder = tmp_path / str(number)
        folder.mkdir()
        system.plan = Plan(0.0, 0.5, [Action()], 1e-10)
        derivation = Derivation(system)
        values = dict(zip(system.positions + system.velocities, system.start)) | system.parameters
        exact = ExactMotion(derivation.mechanics, values, 30).trajectory([0.5])[0]
        ours = Reference(derivation, folder).trajectory(7, 1e-16, 0.5)[-1]
        np.testing.assert_allclose(ours, exact, rtol=1e-14, atol=1e-14)
        compared += 1
        if compared == 6:
            return
    assert compared == 6
