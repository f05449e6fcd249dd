"""
Bodies that come to rest, after bounces, on more contacts without friction than they need.

The forces depend on where they rest, not on how they came there: of all pressing forces that balance the load, those of least norm.
"""

import itertools

import numpy as np
import pytest
from scipy.optimize import nnls

from fmu import build_systems
from test_heaps import GRAVITY, RADIUS, gaps_of_disks

ROWS, FEET = 3, 5
BOARD = f"""<system name="BoardOnFeet"><parameter name="J" start="0.1" min="0"/><parameter name="e" start="0"/>
  <coordinate name="z" velocity="vz"/><coordinate name="th" velocity="w" unit="rad"/><kinetic>vz^2/2 + J*w^2/2</kinetic>
  <potential>{GRAVITY}*z</potential>
  <for index="i" from="1" to="{FEET}"><parameter name="a[i]" start="i"/><contact name="foot[i]" gap="z + a[i]*sin(th)" restitution="e"/></for></system>"""
PLACES = [(2 * column + row + 1, 1 + row * np.sqrt(3)) for row in range(ROWS) for column in range(ROWS - row)]  # of disks, in radii
WALLS = {"f": (0, 1), "l": (1, 0), "r": (-1, 0)}  # normals of floor and walls, by the names of gaps_of_disks()


def pyramid():
    """Disks of 1 kg in rows; the lowest one fills the width."""
    lines = ['<system name="Pyramid"><parameter name="e" start="0"/><parameter name="h" start="0"/>']
    for i, (x, y) in enumerate(PLACES):
        lines.append(f'<coordinate name="x{i}" velocity="vx{i}" start="{x * RADIUS:.17g}"/><coordinate name="y{i}" velocity="vy{i}" start="{y * RADIUS:.17g} + h"/>')
        lines.append(f'<particle mass="1" x="x{i}" y="y{i}"/>')
    lines += [f'<contact name="{contact}" gap="{gap}" restitution="e"/>' for contact, gap in gaps_of_disks(len(PLACES), 2 * ROWS * RADIUS).items()]
    return "\n".join([*lines, f'<gravity y="-{GRAVITY}"/></system>'])


def touching_in_pyramid():
    """The names of the contacts that touch, and the forces that unit forces of them exert on the coordinates x0, y0, x1, ..."""
    columns = {}
    for i, (x, y) in enumerate(PLACES):
        for (wall, normal), gap in zip(WALLS.items(), (y - 1, x - 1, 2 * ROWS - x - 1)):
            if gap < 1e-9:
                columns[f"{wall}{i}"] = {i: np.array(normal)}
    for i, j in itertools.combinations(range(len(PLACES)), 2):
        direction = np.subtract(PLACES[i], PLACES[j]) / 2
        if np.linalg.norm(direction) < 1 + 1e-9:
            columns[f"c{i}_{j}"] = {i: direction, j: -direction}
    rows = [np.concatenate([column.get(i, np.zeros(2)) for i in range(len(PLACES))]) for column in columns.values()]
    return list(columns), np.transpose(rows)


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("shared_loads", {"BoardOnFeet": BOARD, "Pyramid": pyramid()})


def least_forces(balance, load):
    """The forces f >= 0 of least norm with balance @ f = load: a small share of the norm beside the balance."""
    share = 1e-7
    count = balance.shape[1]
    matrix = np.vstack([balance / share, np.eye(count)])
    return nnls(matrix, np.concatenate([load / share, np.zeros(count)]), maxiter=10000)[0]


def boards():
    """The first ones came to rest with a foot that touched without a force: J, e, z, th, then the feet."""
    cases = [(0.016411, 0.843676, 0.191448, 0.0, -0.705622, 0.191214, 0.91515, 0.446751, -0.827523, 1e-5),
             (0.010421, 0.893073, 0.075445, 0.0, -0.95126, 0.070444, -0.439324, 0.339492, 0.349794, 1e-6),
             (0.014472, 0.574967, 0.372037, -0.182776, -0.113792, 0.400069, 0.770477, 0.988519, -0.800635, 1e-7)]  # fmt: skip
    random = np.random.default_rng(5)
    while len(cases) < 15:
        feet = random.uniform(-1, 1, FEET)
        if feet.min() < -0.05 and feet.max() > 0.05:
            angle = random.uniform(-0.2, 0.2)
            height = max(-feet * np.sin(angle)) + random.uniform(0.01, 0.2)
            cases.append((10 ** random.uniform(-2, 1), random.uniform(0, 0.6), height, angle, *feet, 10.0 ** -random.integers(4, 9)))
    return cases


@pytest.mark.parametrize("case", boards())
def test_a_board_falls_on_its_feet(open_fmu, case):
    *values, tolerance = case
    names = ["J", "e", "z", "th", *(f"a[{i + 1}]" for i in range(FEET))]
    board = open_fmu("BoardOnFeet").initialize(dict(zip(names, values)), tolerance=tolerance)
    for _ in range(40):
        board.step(0.25)
    feet = np.array(values[4:])
    assert board.get("vz", "w", "th", "z") == pytest.approx(np.zeros(4), abs=1e-9)
    forces = least_forces(np.vstack([np.ones(FEET), feet]), np.array([GRAVITY, 0]))
    assert board.get(*(f"foot[{i + 1}].force" for i in range(FEET))) == pytest.approx(forces, abs=1e-5)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
@pytest.mark.parametrize("e, h", [(0.0, 0.0), (0.3, 0.01), (0.6, 0.01), (0.7, 0.01)])
def test_a_pyramid_falls_on_the_ground(open_fmu, e, h, tolerance):
    heap = open_fmu("Pyramid").initialize({"e": e, "h": h}, tolerance=tolerance)
    for _ in range(30):
        heap.step(0.1)
    names, balance = touching_in_pyramid()
    places = heap.get(*(f"{axis}{i}" for i in range(len(PLACES)) for axis in "xy"))
    assert places == pytest.approx(RADIUS * np.ravel(PLACES), abs=1e-6)
    forces = least_forces(balance, np.tile([0, GRAVITY], len(PLACES)))
    assert heap.get(*(f"{name}.force" for name in names)) == pytest.approx(forces, abs=1e-4)
