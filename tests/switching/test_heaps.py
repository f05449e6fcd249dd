"""
Rigid disks without friction that fall into a box, and come to lie in a heap.

Where the width is a multiple of their diameter, rows fill it exactly. Such a row is singular, and one that is nearly filled is a wedge.
"""

import itertools

import numpy as np
import pytest

from fmu import build_systems

RADIUS, GRAVITY, STOP = 0.1, 9.81, 2.0
# Name: number of disks, width, restitution
HEAPS = {"TightHeap": (12, 1.0, 0.0), "TightBounces": (8, 0.8, 0.3), "WideHeap": (9, 0.93, 0.0), "SixInARow": (12, 1.2, 0.0)}


def gaps_of_disks(count, width):
    """The gaps of disks in a box, by name: f of the floor, l and r of the walls, c of two disks."""
    gaps = {f"{side}{i}": gap for i in range(count) for side, gap in zip("flr", (f"y{i} - {RADIUS}", f"x{i} - {RADIUS}", f"{width} - x{i} - {RADIUS}"))}
    return gaps | {f"c{i}_{j}": f"sqrt((x{i} - x{j})^2 + (y{i} - y{j})^2) - {2 * RADIUS}" for i, j in itertools.combinations(range(count), 2)}


def heap(name, count, width, restitution):
    random = np.random.default_rng(count)
    columns = int(width / 0.26)
    lines = [f'<system name="{name}"><parameter name="e" start="{restitution}" unit="1"/>']
    for i in range(count):
        start = (width / columns * (i % columns + 0.5), 0.26 * (i // columns) + 0.4) + random.uniform(-0.005, 0.005, 2)
        for axis, value in zip("xy", start):
            lines.append(f'<coordinate name="{axis}{i}" velocity="v{axis}{i}" start="{value:.17g}" velocityStart="{random.uniform(-1, 1):.17g}"/>')
        lines.append(f'<particle mass="1" x="x{i}" y="y{i}"/>')
    lines.append(f'<potential>{GRAVITY}*({"+".join(f"y{i}" for i in range(count))})</potential>')
    lines += [f'<contact name="{contact}" gap="{gap}" restitution="e"/>' for contact, gap in gaps_of_disks(count, width).items()]
    return "\n".join([*lines, "</system>"])


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("heaps", {name: heap(name, *values) for name, values in HEAPS.items()})


def fall(heap, count, width, allowed=0.0):
    """The energy never grows, and no disks overlap, by more than is allowed. Returns the last state."""
    names = [f"{letter}{i}" for letter in ("x", "y", "vx", "vy") for i in range(count)]
    energy = np.inf
    for _ in range(100):
        heap.step(STOP / 100)
        x, y, vx, vy = np.reshape(heap.get(*names), (4, count))
        distance = np.hypot(x[:, None] - x, y[:, None] - y)[np.triu_indices(count, 1)]
        assert min((distance - 2 * RADIUS).min(), (x - RADIUS).min(), (width - RADIUS - x).min(), (y - RADIUS).min()) > -1e-9 - allowed
        before, energy = energy, 0.5 * (vx @ vx + vy @ vy) + GRAVITY * y.sum()
        assert energy < before + 1e-8 + allowed
    assert 0.5 * (vx @ vx + vy @ vy) < 1e-2 * energy


@pytest.mark.parametrize("name", HEAPS)
def test_heaps_lose_energy_and_do_not_overlap(open_fmu, name):
    count, width, _ = HEAPS[name]
    fall(open_fmu(name).initialize(), count, width)


@pytest.mark.parametrize("name, seed", [*(("TightHeap", seed) for seed in (12, 20, 32)), *(("SixInARow", seed) for seed in (7, 17, 23, 44))])
def test_filled_rows(open_fmu, name, seed):
    """A row that fills the width carries forces that are not unique, and bounces in it may be without number."""
    count, width, _ = HEAPS[name]
    random = np.random.default_rng(seed)
    tolerance = 10.0 ** -random.integers(4, 9)
    speeds = {f"v{axis}{i}": random.uniform(-1, 1) for axis in "xy" for i in range(count)}
    heap = open_fmu(name).initialize({"e": (0.0, 0.3, 0.6)[seed % 3], **speeds}, tolerance=tolerance)
    fall(heap, count, width, tolerance)
