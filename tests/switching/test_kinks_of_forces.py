"""
Forces whose pieces meet with or without a jump, beside a friction that sticks.

A marker passes y = 0 at 1 s. A force on a block of 2 kg depends on y, and the block sticks up to 4 N.
"""

import fmpy
import numpy as np
import pytest

import fmu
from fmu import build_systems

LIMIT, MASS, STOP = 4.0, 2.0, 2.0
METHODS = ["taylor", "radau", "bdf"]
# Name: the force in N, its polynomial in y > 0, and how many events there may be. A kink at 1 s is an event of its own; at a jump, the block
# slips at once. Two kinks at one time may be one event.
FORCES = {
    "Jump": ("if(y &lt; 0, 3, 5)", [5.0], {1}),
    "Kink": ("max(3, 3 + 10*y)", [10.0, 3.0], {2}),
    "Kinks": ("max(3, 3 + 10*y) + max(0, y + y^2)", [1.0, 11.0, 3.0], {2, 3}),
}


def name_of(force, method):
    return f"{force}Beside{method.title()}"


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {}
    for force, (expression, _, _) in FORCES.items():
        for method in METHODS:
            name = name_of(force, method)
            texts[name] = (
                f'<system name="{name}"><coordinate name="y" velocity="w" start="-1" velocityStart="1"/><particle mass="1" x="y"/>'
                f'<coordinate name="x" velocity="v"/><particle mass="{MASS}" x="x"/><force coordinate="x">{expression}</force>'
                f'<friction name="rub" velocity="v" force="{LIMIT}"/><solver method="{method}" tolerance="1e-9"/></system>'
            )
    build_systems("kinks-of-forces", texts)


def speed(force, time):
    """The integral of (force - limit) / mass since the force has passed the limit."""
    rate = np.poly1d(FORCES[force][1]) / MASS - LIMIT / MASS
    start = max([0.0, *(root for root in rate.roots if root > 0)])
    path = rate.integ()
    return path(max(start, time - 1)) - path(start)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("force", FORCES)
def test_a_block_slips_when_its_force_passes_the_limit(force, method):
    rows = fmpy.simulate_fmu(str(fmu.archive(name_of(force, method))), stop_time=STOP, output_interval=0.125, output=["v", "events"], relative_tolerance=1e-9)
    for time, found, _ in rows:
        assert found == pytest.approx(speed(force, time), abs=1e-7), time
    assert rows["time"][-1] == pytest.approx(STOP) and np.all(rows["events"][rows["time"] < 0.99] == 0)
    assert rows["events"][-1] in FORCES[force][2]
