"""
Two disks on the ground that touch: one rolls, the other slides and pushes against it. Once they no longer slip on each other, the first one climbs.

With much friction, the modes in which it stays down have forces below 0, or none. Contacts open and frictions stick at the same time.
"""

import pytest

import fmu
from fmu import build_systems

GRAVITY, RADIUS = 9.81, 0.1
START = {"x0": 0.0, "x1": 2 * RADIUS, "vx0": 0.1, "vx1": 0.1, "w0": -1.0, "w1": 1.05}


def disk(i):
    return (
        f'<coordinate name="x{i}" velocity="vx{i}"/><coordinate name="y{i}" velocity="vy{i}" start="{RADIUS}"/><coordinate name="a{i}" velocity="w{i}"/>'
        f'<particle mass="1" x="x{i}" y="y{i}"/><kinetic>{RADIUS**2 / 4}*w{i}^2</kinetic><potential>{GRAVITY}*y{i}</potential>'
        f'<contact name="G{i}" gap="y{i} - {RADIUS}"/><friction name="fG{i}" velocity="vx{i} + {RADIUS}*w{i}" force="mu*G{i}.force"/>'
    )


@pytest.fixture(scope="module", autouse=True)
def built():
    slip = f"((vx1 - vx0)*(y1 - y0) - (vy1 - vy0)*(x1 - x0))/d + {RADIUS}*(w0 + w1)"
    between = f'<contact name="C" gap="d - {2 * RADIUS}"/><friction name="fC" velocity="{slip}" force="mu*C.force"/>'
    text = f'<parameter name="mu" start="1"/>{disk(0)}{disk(1)}<define name="d">sqrt((x0 - x1)^2 + (y0 - y1)^2)</define>{between}'
    build_systems("disks-that-climb", {"Climbing": f'<system name="Climbing">{text}</system>'})


@pytest.mark.parametrize("mu", [1.3, 1.4, 1.5, 1.7, 2.0])
def test_a_disk_climbs(mu):
    """
    With T as the friction that lifts the first disk: its slip stays 0 if T + 4 T - 2 mu (g + T) = g. The ground bears G = g + T, and the disks press each other
    by mu G/2.
    """
    instance = fmu.Instance("Climbing").initialize(START | {"mu": mu})
    for _ in range(23):
        instance.step(1e-5)
    friction = GRAVITY * (1 + 2 * mu) / (5 - 2 * mu)
    ground = GRAVITY + friction
    assert instance.get("G0.force") == 0 and instance.get("y0") > RADIUS
    assert instance.get("G1.force", "C.force", "fC.force") == pytest.approx([ground, mu * ground / 2, -friction], rel=1e-2)
    instance.free()
