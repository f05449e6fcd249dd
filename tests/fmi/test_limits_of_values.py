"""Values beyond min and max by rounding count as the limits; others give Discard."""

import pytest

from building import build_systems
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
