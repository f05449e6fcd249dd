"""Derivatives in initialization mode include the projection of the start onto the constraints: against differences of Set and Get."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

import fmi3
import fmu

STEP = 1e-4


HANGING = """
<system name="HangingAndStop">
  <parameter name="l" start="1" unit="m" min="0.1"/>
  <coordinate name="x" velocity="vx" unit="m" start="-0.9"/>
  <coordinate name="y" velocity="vy" unit="m" start="0.2"/>
  <coordinate name="s" velocity="u" unit="m"/>
  <particle name="bob" mass="1" x="x" y="y"/>
  <particle name="block" mass="2" x="s"/>
  <potential>9.81*bob.y</potential>
  <constraint name="rod" unit="m2">x^2 + y^2 - l^2</constraint>
  <contact name="ground" gap="y + 2" restitution="0.5"/>
  <friction name="rub" velocity="u" force="1"/>
</system>
"""
HIT = """
<system name="HitAtTheStart">
  <parameter name="e" start="0.5" min="0" max="1"/>
  <coordinate name="h" velocity="v" unit="m" velocityStart="-2"/>
  <particle mass="1" x="h"/>
  <potential>9.81*h</potential>
  <contact name="ground" gap="h" restitution="e"/>
  <output name="twice">2*v</output>
</system>
"""
LIGHT = """
<system name="LightPair">
  <parameter name="m1" start="2e-7" unit="kg" min="0"/>
  <parameter name="m2" start="1e-7" unit="kg" min="0"/>
  <coordinate name="x" velocity="vx" unit="m" start="1"/>
  <coordinate name="y" velocity="vy" unit="m" start="0.5"/>
  <particle mass="m1" x="x"/>
  <particle mass="m2" x="y"/>
  <constraint name="glue" unit="m">x - y</constraint>
</system>
"""


@pytest.fixture(scope="module", autouse=True)
def own_systems():
    systems = {"HangingAndStop": HANGING, "HitAtTheStart": HIT, "LightPair": LIGHT}
    fmu.build_systems("initialization-derivatives", systems, versions=[2, 3])


@pytest.fixture(params=[(fmu, FMU2Slave), (fmu, FMU2Model), (fmi3, FMU3Slave), (fmi3, FMU3Model)], ids=["CS2", "ME2", "CS3", "ME3"])
def open_in_initialization(request):
    opened = []

    def open_named(name):
        module, kind = request.param
        instance = module.Instance(name, kind=kind)
        opened.append(instance)
        if module is fmu:
            instance.fmu.setupExperiment()
        instance.fmu.enterInitializationMode()
        return instance

    yield open_named
    for instance in opened:
        instance.free()


def directional(instance, unknowns, known):
    if isinstance(instance, fmi3.Instance):
        return instance.partial("Directional", unknowns, [known], [1.0])
    return np.array(instance.fmu.getDirectionalDerivative(instance.vr(*unknowns), instance.vr(known), [1.0]))


def values(instance, names):
    return np.array([np.ravel(instance.get(name))[0] for name in names])


def difference(instance, unknowns, known):
    """Central difference of fourth order, by Set and Get in initialization mode."""
    start, result = values(instance, [known])[0], 0.0
    original = instance.start_of[known]
    for at, weight in ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12)):
        instance.set({known: original + at * STEP})
        result = result + weight * values(instance, unknowns) / STEP
    instance.set({known: original})
    assert values(instance, [known])[0] == pytest.approx(start, abs=1e-12)
    return result


@pytest.mark.parametrize(
    "name, knowns",
    [("PendulumCartesian", {"x": -0.9, "y": 0.2, "vx": 0.3, "vy": 0.1, "l": 1.0}), ("FourBar", {"theta": 1.2, "phi": 0.6, "omega": 0.4})],
)
def test_derivatives_of_the_start(name, knowns, open_in_initialization):
    """A projected start depends on every state and parameter: d x / d x is not 1, and d y / d x is not 0."""
    instance = open_in_initialization(name)
    knowns = {known: value for known, value in knowns.items() if known in {v.name for v in instance.description.modelVariables}}
    instance.start_of = knowns
    instance.set(knowns)
    derivatives = [unknown.variable for unknown in instance.description.derivatives]
    unknowns = [v.derivative.name for v in derivatives] + [v.name for v in derivatives]
    for known in knowns:
        ours = directional(instance, unknowns, known)
        np.testing.assert_allclose(ours, difference(instance, unknowns, known), rtol=1e-7, atol=1e-7)


def test_a_radial_displacement_of_the_start(open_in_initialization):
    """The start is the nearest point of the circle: at (-a, b) the derivatives by a are -b^2/r^3 for x and -a b/r^3 for y, for l = 1."""
    instance = open_in_initialization("PendulumCartesian")
    x, y = -0.9, 0.2
    instance.set({"x": x, "y": y, "vx": 0.0, "vy": 0.0})
    r = np.hypot(x, y)
    np.testing.assert_allclose(directional(instance, ["x", "y"], "x"), [y * y / r**3, -x * y / r**3], atol=1e-9)
    if isinstance(instance, fmi3.Instance):
        np.testing.assert_allclose(instance.partial("Adjoint", ["x", "y"], ["x", "y"], [2.0, 3.0]),
                                   np.array([[y * y, -x * y], [-x * y, x * x]]) @ [2.0, 3.0] / r**3, atol=1e-9)  # fmt: skip


def test_constraints_beside_what_switches(open_in_initialization):
    """The same circle, in a system with a contact that is open and a friction that sticks."""
    instance = open_in_initialization("HangingAndStop")
    x, y = -0.9, 0.2
    r = np.hypot(x, y)
    np.testing.assert_allclose(directional(instance, ["x", "y"], "x"), [y * y / r**3, -x * y / r**3], atol=1e-9)
    np.testing.assert_allclose(directional(instance, ["x", "y"], "l"), [x / r, y / r], atol=1e-9)
    unknowns = ["x", "y", "vx", "der(vx)", "der(vy)"]
    for known, value in {"x": x, "y": y, "vx": 0.0, "l": 1.0}.items():
        instance.start_of = {known: value}
        np.testing.assert_allclose(directional(instance, unknowns, known), difference(instance, unknowns, known), rtol=1e-7, atol=1e-7)
    if isinstance(instance, fmi3.Instance):
        np.testing.assert_allclose(instance.partial("Adjoint", ["x", "y"], ["x", "y"], [2.0, 3.0]),
                                   np.array([[y * y, -x * y], [-x * y, x * x]]) @ [2.0, 3.0] / r**3, atol=1e-9)  # fmt: skip


def test_an_impact_at_the_start(open_in_initialization):
    """A ball that touches the ground at the start begins its motion with the velocity -e v."""
    instance = open_in_initialization("HitAtTheStart")
    assert instance.get("v") == pytest.approx(1.0)
    np.testing.assert_allclose(directional(instance, ["v", "twice"], "v"), [-0.5, -1.0], atol=1e-9)
    np.testing.assert_allclose(directional(instance, ["v", "twice"], "e"), [2.0, 4.0], atol=1e-9)


def test_no_derivative_by_the_height_of_an_impact(open_in_initialization):
    """A ball that starts slightly higher has the velocity v, before the impact. A start below the ground is an error."""
    instance = open_in_initialization("HitAtTheStart")
    with pytest.raises(FMICallException):
        directional(instance, ["v"], "h")
    assert any("there is no derivative at these start values: beside them an impact or event leads to other states" in message[-1] for message in instance.messages)


def test_no_derivative_of_a_contact_at_rest(open_in_initialization):
    """A ball that rests on the ground leaves it with v upwards, and with -e v downwards: at v = 0 is a kink."""
    instance = open_in_initialization("HitAtTheStart")
    instance.set(v=0.0)
    assert instance.get("der(v)") == pytest.approx(0.0)
    with pytest.raises(FMICallException):
        directional(instance, ["der(h)"], "v")
    assert any("there is no derivative at these start values: beside them 'ground' starts in another mode" in message[-1] for message in instance.messages)


def test_parameters_with_small_values(open_in_initialization):
    """The start is x = y = (m1 x0 + m2 y0)/(m1 + m2), also where a displacement of a mass by 1e-6 kg would make it negative."""
    instance = open_in_initialization("LightPair")
    m1, m2, x, y = 2e-7, 1e-7, 1.0, 0.5
    exact = np.array([m2, -m1]) * (x - y) / (m1 + m2) ** 2
    for known, slope in zip(("m1", "m2"), exact):
        np.testing.assert_allclose(directional(instance, ["x", "y"], known), [slope, slope], rtol=1e-8)
