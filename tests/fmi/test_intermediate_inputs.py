"""Inputs that the importer sets in intermediate update mode of FMI 3.0 (3.0.2, sections 2.3.1 and 4.2.2)."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import fmi3
import fmu
from fmi3 import Importer, Supplier, observed, supplied
from fmu import DISCARD, ERROR

SPRING = dict(x=1.0, vx=0.0, m=1.0, kx=4.0)

HAND = """
<system name="GuidedHand">
  <input name="u" start="0.1" derivatives="2"/>
  <coordinate name="x" velocity="v" start="0.1"/>
  <particle name="slide" mass="3" x="x"/>
  <constraint name="hand">u - x</constraint>
</system>
"""
STOP = """
<system name="PushedBlock">
  <input name="F" unit="N"/>
  <coordinate name="x" velocity="v" unit="m"/>
  <particle name="block" mass="1" x="x"/>
  <force coordinate="x">F</force>
  <stop coordinate="x" max="0.1" restitution="0.5"/>
</system>
"""


@pytest.fixture(scope="module")
def own_systems():
    fmu.build_systems("intermediate-inputs", {"GuidedHand": HAND, "PushedBlock": STOP}, versions=[3])


def wave(t):
    return np.sin(5 * t)


def forced(t):
    """Solution of x'' + 4 x = sin(5 t) from x = 1 at rest; its particular part is -sin(5 t)/21."""
    return np.cos(2 * t) + 5 / 42 * np.sin(2 * t) - np.sin(5 * t) / 21


def run(instance, h, end):
    for _ in range(round(end / h)):
        instance.step(h)


def error_of(opened, h):
    supplier = Supplier({"Fx": wave})
    spring = supplied(opened, "ParticleCartesian", supplier, ["Fx"]).initialize(SPRING, tolerance=1e-13)
    run(spring, h, 2.0)
    return abs(spring.get("x")[0] - forced(2.0))


def test_motion_is_of_sixth_order(opened):
    """At h = 0.05 a constant force gives an error of 8e-4; a cubic through Lobatto nodes gives less than 1e-10."""
    errors = [error_of(opened, h) for h in (0.2, 0.1, 0.05)]
    assert errors[2] < 1e-10
    assert np.allclose(np.log2(np.divide(errors[:-1], errors[1:])), 6.0, atol=0.3)


def test_outputs_that_depend_on_inputs_directly(opened):
    """At the end of a step the input has the value set for that time, without lag: F = -kx x for the present x."""
    controller = supplied(opened, "StateFeedback", Supplier({"x": wave}), ["x"]).initialize({"kx": 2.0, "umax": 100.0})
    before = controller.get("F")[0]
    controller.step(0.1)
    assert controller.get("F")[0] - before == pytest.approx(-2.0 * wave(0.1), rel=1e-12)


def test_nodes(opened):
    supplier = Supplier({"Fx": wave})
    spring = supplied(opened, "ParticleCartesian", supplier, ["Fx"]).initialize()
    spring.step(0.5)
    assert supplier.times == pytest.approx([0.0, (1 - 5**-0.5) / 4, (1 + 5**-0.5) / 4, 0.5], abs=1e-15)
    assert supplier.times[-1] == 0.5


@pytest.mark.parametrize("name, given", [("ParticleCartesian", "Fx"), ("ElasticPendulum", None), ("InvertedPendulumCart", "F")])
def test_without_values_nothing_changes(name, given, opened):
    """An importer that sets no input in the callback, or sets the same value, obtains the bits of one without a callback."""
    inputs = [v.name for v in fmi3.description(name).modelVariables if v.causality == "input"]
    supplier = Supplier({given: lambda t: 0.3} if given else {})
    asked, alone = supplied(opened, name, supplier, inputs), opened(name)
    for instance in (asked, alone):
        instance.initialize({given: 0.3} if given else {})
    names = [v.name for v in asked.description.modelVariables if v.causality == "output"]
    for h in (0.1, 0.37, 0.01):
        asked.step(h), alone.step(h)
        assert asked.get(*names).tobytes() == alone.get(*names).tobytes()
    assert len(supplier.times) == (12 if inputs else 0)


def test_no_request_without_inputs_among_the_variables(opened):
    supplier = Supplier({})
    supplied(opened, "ParticleCartesian", supplier, ["x"]).initialize().step(0.1)
    assert supplier.times == []


def test_inputs_that_are_not_set_keep_their_value(opened):
    """An input set only at the first node stays constant, while another one varies."""
    supplier = Supplier({}, lambda spring: spring.set(Fx=7.0) if len(supplier.times) == 1 else spring.set(Fy=wave(supplier.times[-1])))
    spring = supplied(opened, "ParticleCartesian", supplier, ["Fx", "Fy"]).initialize(SPRING, tolerance=1e-12)
    spring.step(0.3)
    assert spring.get("x")[0] == pytest.approx(7 / 4 + (1 - 7 / 4) * np.cos(0.6), abs=1e-10)
    assert spring.get("Fx", "Fy") == pytest.approx([7.0, wave(0.3)], abs=1e-14)


@pytest.mark.parametrize(
    "action, message",
    [
        (lambda i: i.get("x"), "fmi3GetFloat64 is not allowed in the state 'intermediate update mode for inputs'"),
        (lambda i: i.set(kx=3.0), "'kx' cannot be set in the state 'intermediate update mode for inputs'"),
        (lambda i: i.set(x=3.0), "'x' cannot be set"),
        (lambda i: i.set(Fx=np.nan), "expected a finite number"),
        (lambda i: i.fmu.reset(), "fmi3Reset is not allowed"),
        (lambda i: i.fmu.doStep(0.0, 0.1), "fmi3DoStep is not allowed"),
        (lambda i: i.fmu.getFMUState(), "fmi3GetFMUState is not allowed"),
    ],
)
def test_errors_in_a_request_end_the_step(action, message, opened):
    supplier = Supplier({}, action)
    spring = supplied(opened, "ParticleCartesian", supplier, ["Fx"]).initialize()
    with pytest.raises(FMICallException) as raised:
        spring.step(0.1)
    assert raised.value.status == ERROR and supplier.problem.status == ERROR and len(supplier.times) == 1
    assert any(message in text for _, _, text in spring.messages)
    spring.fmu.reset()


def test_inputs_that_change_beyond_all_numbers(opened):
    spring = supplied(opened, "ParticleCartesian", Supplier({"Fx": lambda t: 1e308 * np.sign(t - 0.01)}), ["Fx"]).initialize()
    with pytest.raises(FMICallException) as raised:
        spring.step(0.1)
    assert raised.value.status == ERROR
    assert "an input changes too fast within the step from time 0" in spring.messages[-1][2]


def test_inputs_are_set_in_requests_alone(opened):
    """Inputs cannot be set while values are read, where intermediateVariableSetRequested is false."""
    importer = Importer()
    spring = observed(opened, "DampedPendulum", importer, ["theta"]).initialize()
    importer.instance = type("", (), {"get": lambda *names: spring.set(tau=1.0)})
    with pytest.raises(FMICallException) as raised:
        spring.step(1.0)
    assert raised.value.status == ERROR and importer.problem.status == ERROR


def test_a_discarded_step_gives_inputs_back(opened):
    """A discarded step restores the state before the call, including the inputs."""
    falling = supplied(opened, "ParticlePolar", Supplier({"Ftheta": lambda t: 1e-9 * t}), ["Ftheta"]).initialize(dict(omega=0.0))
    with pytest.raises(FMICallException) as raised:
        falling.step(2.0)
    assert raised.value.status == DISCARD
    assert list(falling.get("Ftheta", "r")) == [0.0, 1.0]


def test_saved_states(opened):
    """A repeated step requests inputs again and gives the same bits."""
    spring = supplied(opened, "ParticleCartesian", Supplier({"Fx": wave}), ["Fx"]).initialize(SPRING)
    run(spring, 0.1, 0.5)
    state = spring.fmu.getFMUState()
    spring.step(0.2)
    first = spring.get("x", "vx", "Fx").tobytes()
    spring.fmu.setFMUState(state)
    spring.time = 0.5
    spring.step(0.2)
    assert spring.get("x", "vx", "Fx").tobytes() == first
    spring.fmu.freeFMUState(state)


def test_constraints_follow(own_systems, opened):
    """A coordinate that an input prescribes is at the importer's value; its velocity converges with third order."""
    errors = []
    for h in (0.1, 0.05):
        hand = supplied(opened, "GuidedHand", Supplier({"u": lambda t: 0.1 + wave(t)}), ["u"])
        hand.initialize({"u": 0.1, "der(u)": 5.0})
        run(hand, h, 1.0)
        x, v = hand.get("x", "v")
        assert x == pytest.approx(0.1 + wave(1.0), abs=1e-12)
        errors.append(abs(v - 5 * np.cos(5.0)))
    assert errors[0] < 0.02 and errors[1] < errors[0] / 6


@pytest.mark.parametrize("early", [True, False])
def test_through_events(early, own_systems, opened):
    """A block pushed from rest by F = 6 t follows t^3 until it meets the stop at 0.1, and leaves it with half of its speed."""
    block = supplied(opened, "PushedBlock", Supplier({"F": lambda t: 6 * t}), ["F"], eventModeUsed=early, earlyReturnAllowed=early)
    block.initialize()
    if early:
        block.fmu.updateDiscreteStates()
        block.fmu.enterStepMode()
    t, end = 0.1 ** (1 / 3), 0.6
    while block.time < end:
        needed, *_ = block.step(min(0.3, end - block.time))
        if needed:
            assert block.time == pytest.approx(t, abs=1e-9)
            block.fmu.enterEventMode()
            block.fmu.updateDiscreteStates()
            block.fmu.enterStepMode()
    v = -0.5 * 3 * t**2
    x = 0.1 + v * (end - t) + end**3 - t**3 - 3 * t**2 * (end - t)
    assert block.get("x")[0] == pytest.approx(x, abs=1e-8)
    assert block.get("F")[0] == pytest.approx(6 * end, abs=1e-12)
