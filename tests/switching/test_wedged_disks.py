"""
Disks with much friction that bounce in a wedge of two planes, until they lie still.

While they are squeezed together, events follow each other ever faster, and some states have no modes. Time steps pass these times.
"""

import itertools
import re

import numpy as np
import pytest

import fmu
from fmu import build_systems

COUNT, RADIUS, GRAVITY, MU = 5, 0.1, 9.81, 3.0
SIDE = np.sqrt(0.5)


def wedge():
    lines = []
    for i in range(COUNT):
        x, y = -0.39 + 0.23 * (i % 4) + 0.2 * (i // 4), 0.75 + 0.3 * (i // 4)
        for name, velocity, start in (("x", "vx", x), ("y", "vy", y), ("a", "w", 0.0)):
            lines.append(f'<coordinate name="{name}{i}" velocity="{velocity}{i}" start="{start}"/>')
        lines.append(f'<particle mass="1" x="x{i}" y="y{i}"/><kinetic>{RADIUS**2 / 4}*w{i}^2</kinetic><potential>{GRAVITY}*y{i}</potential>')
        for side, sign in (("L", 1), ("R", -1)):
            gap, slip = f"{SIDE}*({sign}*x{i} + y{i}) - {RADIUS}", f"{SIDE}*(vx{i} - {sign}*vy{i}) + {RADIUS}*w{i}"
            lines.append(f'<contact name="{side}{i}" gap="{gap}" restitution="0.5"/><friction name="f{side}{i}" velocity="{slip}" force="{MU}*{side}{i}.force"/>')
    for i, j in itertools.combinations(range(COUNT), 2):
        distance, contact = f"sqrt((x{j} - x{i})^2 + (y{j} - y{i})^2)", f"c{i}{j}"
        slip = f"((vx{j} - vx{i})*(y{j} - y{i}) - (vy{j} - vy{i})*(x{j} - x{i}))/{distance} + {RADIUS}*(w{i} + w{j})"
        lines.append(f'<contact name="{contact}" gap="{distance} - {2 * RADIUS}" restitution="0.5"/>')
        lines.append(f'<friction name="f{contact}" velocity="{slip}" force="{MU}*{contact}.force"/>')
    return "\n".join(['<system name="Wedge">', *lines, "</system>"])


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("wedged-disks", {"Wedge": wedge()})


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 27])
def test_wedged_disks_come_to_rest(seed):
    random = np.random.default_rng(seed)
    start = {f"v{axis}{i}": random.uniform(-0.5, 0.5) for axis in "xy" for i in range(COUNT)} | {f"w{i}": random.uniform(-5, 5) for i in range(COUNT)}
    instance = fmu.Instance("Wedge").initialize(start, tolerance=1e-6)
    energy = instance.get("totalEnergy")
    for k in range(100):
        instance.fmu.doStep(k * 0.02, 0.02)  # rounded otherwise than the end of the last step
        before, energy = energy, instance.get("totalEnergy")
        assert energy < before + 1e-5
        x, y = (np.array(instance.get(*(f"{axis}{i}" for i in range(COUNT)))) for axis in "xy")
        distance = np.hypot(x[:, None] - x, y[:, None] - y)[np.triu_indices(COUNT, 1)]
        assert min((distance - 2 * RADIUS).min(), (SIDE * (y - np.abs(x)) - RADIUS).min()) > -1e-8
    assert any(re.search("events of the (contact|friction) '.*' and others .* time steps", text) for _, _, text in instance.messages)
    instance.free()
