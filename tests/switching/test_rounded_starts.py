"""Start values with few digits: a projection opens penetrating contacts, as it satisfies constraints, with a message."""

import math

import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model, FMU3Slave

from fmu import ERROR, build_systems

# A point outside a circle of 1 m, given with six digits, and a body on the floor.
PLACES = """<system name="Places"><coordinate name="x" velocity="vx" unit="m" start="0.5"/><coordinate name="y" velocity="vy" unit="m" start="0.866025"/>
  <coordinate name="h" velocity="v" unit="m" start="-9e-7"/><particle mass="2" y="h"/><gravity y="-9.81"/><contact name="floor" gap="h" unit="m"/>
  <particle mass="1" x="x"/><particle mass="1" y="y"/><contact name="rod" gap="sqrt(x^2 + y^2) - 1" unit="m"/></system>"""
# The body on the floor is coupled to a slide.
TIED = """<system name="Tied"><coordinate name="h" velocity="v" unit="m" start="-9e-7"/><coordinate name="s" velocity="w" unit="m" start="-1.8e-6"/>
  <particle mass="2" y="h"/><particle mass="1" x="s"/><gravity y="-9.81"/><constraint name="tie" unit="m">s - 2*h</constraint>
  <contact name="floor" gap="h" unit="m"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    fixed = TIED.replace("Tied", "Fixed").replace('start="-1.8e-6"', 'start="-1.8e-6" fixed="true"')
    build_systems("rounded-starts", {"Places": PLACES, "Tied": TIED, "Fixed": fixed}, versions=[2, 3])


def started(opened, open_fmu, version, kind):
    if version == 2:
        return open_fmu("Places", **({} if kind == "steps" else {"kind": FMU2Model}))
    return opened("Places", kind=FMU3Slave if kind == "steps" else FMU3Model)


@pytest.mark.parametrize("kind", ["steps", "exchange"])
@pytest.mark.parametrize("version", [2, 3])
def test_rounded_starts_are_moved(opened, open_fmu, version, kind):
    """The start moves by the least amount in the mass metric: radially to the circle. Initialization mode shows the same values."""
    instance = started(opened, open_fmu, version, kind)
    (instance.fmu.setupExperiment if version == 2 else (lambda: None))()
    instance.fmu.enterInitializationMode()
    shown = list(instance.get("x", "y", "h"))
    instance.fmu.exitInitializationMode()
    length = math.hypot(0.5, 0.866025)
    assert list(instance.get("x", "y", "h")) == pytest.approx([0.5 / length, 0.866025 / length, 0], abs=1e-12) and list(instance.get("x", "y", "h")) == shown
    texts = [text for *_, text in instance.messages]
    assert any("the start values are moved to open the contact 'floor', whose gap was -9e-07" in text for text in texts), texts


def test_constraints_are_satisfied_after_a_start_is_moved(open_fmu):
    instance = open_fmu("Tied").initialize()
    assert instance.get("h", "s", "v", "w") == pytest.approx([0, 0, 0, 0], abs=1e-15)
    instance.step(0.5)
    assert instance.get("h", "floor.force") == pytest.approx([0, 2 * 9.81], abs=1e-9)


def test_more_than_rounding_is_an_error(open_fmu):
    instance = open_fmu("Places")
    with instance.fails(ERROR, "the contact 'floor' is penetrated at the start: its gap is -0.001"):
        instance.initialize({"h": -0.001})


def test_fixed_coordinates_stay(open_fmu):
    """The body on the floor cannot move without the slide, whose start value is fixed."""
    instance = open_fmu("Fixed")
    with instance.fails(ERROR, "the contact 'floor' is penetrated at the start: its gap is -9e-07"):
        instance.initialize()
    assert not [text for *_, text in instance.messages if "is moved" in text]
