"""Values beyond min and max by rounding count as the limits; others give Discard."""

import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from building import build_systems
from fmi3 import Supplier, supplied
from fmu import DISCARD

VALVE = """<system name="Valve"><input name="opening" unit="1" min="0"/><parameter name="share" unit="1" start="0.3" min="0.1" max="1"/>
<state name="level" rate="opening/T*share" unit="1"/><parameter name="T" start="1" unit="s"/></system>"""


@pytest.fixture(scope="module")
def valves():
    build_systems("valves", {"Valve": VALVE})


@pytest.mark.parametrize("peak, value, is_limit", [
    (0, -2e-13, True), (0, -2e-12, False), (1e3, -2e-13, True), (1e3, 0.1 * 3e3 - 300.00000000000006, True), (1e3, -2e-9, False), (1e-3, -2e-13, False), (1e6, -1e-7, True),
])  # fmt: skip
def test_values_beyond_a_limit_by_rounding(valves, open_fmu, peak, value, is_limit):
    """A ramp from a peak to 0 ends at 0 but for rounding, which is relative to the peak."""
    instance = open_fmu("Valve").initialize()
    instance.set(opening=peak)
    if is_limit:
        instance.set(opening=value)
        assert instance.get("opening") == 0
    else:
        with instance.fails(DISCARD, "for 'opening' is below its minimum, 0"):
            instance.set(opening=value)
        assert instance.get("opening") == peak
    instance.reset()
    with instance.fails(DISCARD, "for 'opening' is below"):
        instance.set(opening=-2e-12)  # the peak belongs to the last run


def test_parameters_beyond_a_limit_by_rounding(valves, open_fmu):
    instance = open_fmu("Valve").initialize()
    instance.set(share=1 + 4e-16)
    assert instance.get("share") == 1
    instance.set(share=0.1 - 1e-16)
    assert instance.get("share") == 0.1
    with instance.fails(DISCARD, "above its maximum, 1"):
        instance.set(share=1 + 1e-9)


PISTON = """<system name="Piston"><input name="u" start="0.5" min="0" max="2" derivatives="2"/><coordinate name="x" velocity="v" start="0.5"/>
<kinetic>v^2/2</kinetic><constraint name="hand">u - x</constraint></system>"""


@pytest.fixture(scope="module")
def filled():
    build_systems("filled", {"Filled": VALVE.replace("Valve", "Filled").replace('min="0"/>', 'min="0" max="2"/>'), "Piston": PISTON}, versions=(2, 3))


@pytest.mark.parametrize("derivatives", [
    [-20, 0, 0], [5, 0, 0], [20, -600, 6000], [60, -1200, 0], [-60, 1800, -12000], [0, 2e3, -6e4], [0, 0, 1e4], [0, 0, -1e3], [30, 0, 0],
])  # fmt: skip
def test_polynomials_beyond_a_limit(filled, open_fmu, derivatives):
    """Within a step of 0.1 s from 1. One that leaves 0 to 2 becomes a line. The level is the integral of 0.3 times the opening."""
    polynomial = np.polynomial.Polynomial([1, *(d / math.factorial(k + 1) for k, d in enumerate(derivatives))])
    values, end, mean = polynomial(np.linspace(0, 0.1, 100001)), polynomial(0.1), polynomial.integ()(0.1) / 0.1
    leaves = values.min() < -1e-9 or values.max() > 2 + 1e-9
    if leaves:
        end = min(max(end, 0), 2)
        mean = (1 + end) / 2
    instance = open_fmu("Filled").initialize({"opening": 1})
    instance.fmu.setRealInputDerivatives(instance.vr("opening") * 3, [1, 2, 3], derivatives)
    instance.step(0.1)
    assert instance.get("opening", "level") == pytest.approx([end, 0.03 * mean], rel=1e-9, abs=1e-12)
    warnings = [text for status, _, text in instance.messages if status == 1]
    assert len(warnings) == leaves and all("the polynomial of the input 'opening' reaches" in text for text in warnings)


def test_samples_whose_cubic_leaves_a_limit(filled, opened):
    """The valve closes at half of the first step. The cubic through the four samples is negative there; the line is not."""
    tank = supplied(opened, "Filled", Supplier({"opening": lambda t: max(0, 1 - 20 * t)}), ["opening"]).initialize({"opening": 1})
    for _ in range(5):
        tank.step(0.1)
        assert tank.get("opening")[0] == pytest.approx(0, abs=1e-15) and tank.get("level")[0] == pytest.approx(0.3 * 0.05, abs=1e-12)


def test_prescribed_motions_beyond_a_limit(filled, open_fmu, opened):
    """A hand at 0.5 that moves by -2 per second reaches 0 at 0.25 s."""
    for instance in (open_fmu("Piston"), opened("Piston")):
        instance.initialize({"u": 0.5, "der(u)": -2})
        instance.step(0.25)
        assert instance.get("x") == pytest.approx(0, abs=1e-12)
        with pytest.raises(FMICallException) as raised:
            instance.step(0.1)
        message = "time 0.25: the polynomial of the input 'u' reaches -0.2 within the step, beyond its min; expected derivatives"
        assert raised.value.status == DISCARD and any(message in text for _, _, text in instance.messages)
