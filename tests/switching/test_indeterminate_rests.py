"""
Bodies at rest on contacts with friction, whose forces are not given by balance.

They rest as long as any forces within all limits balance the load (a linear program), and then slip.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import linprog

from fmu import Instance, build_systems
from test_switching import to, value

MASS, INERTIA, GRAVITY, RAMP = 10.0, 10.0 / 3.0, 9.81, 2.0  # kg, kg m^2, m/s^2, N/s; it is 2 m long
LADDER = f"""<system name="LoadedLadder"><parameter name="mu1" start="0.4"/><parameter name="mu2" start="0.6"/><parameter name="q0" start="1.2"/>
  <coordinate name="x" velocity="vx" start="cos(q0)"/><coordinate name="y" velocity="vy" start="sin(q0)"/><coordinate name="q" velocity="w" start="q0"/>
  <body name="ladder" mass="{MASS}" x="x" y="y" inertia="{INERTIA}" angle="q"/><gravity y="-{GRAVITY}"/>
  <contact name="floor" gap="y - sin(q)"/><contact name="wall" gap="x - cos(q)"/>
  <friction name="foot" velocity="vx - sin(q)*w" force="mu1*floor.force"/><friction name="head" velocity="vy + cos(q)*w" force="mu2*wall.force"/>
  <force coordinate="x">{RAMP}*time</force><force coordinate="q">-{RAMP}*time*sin(q)</force></system>"""


PLACES, HEIGHT, WEIGHT = (-0.6, 0.1, 0.6), 0.5, 49.05  # of the feet of a block, of its centre, in m; in N
FEET = f"""<system name="ThreeFeet"><coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy" start="{HEIGHT}"/><coordinate name="q" velocity="w"/>
  <body name="block" mass="5" x="x" y="y" inertia="0.5" angle="q"/><force coordinate="y">-{WEIGHT}</force><force coordinate="x">{RAMP}*time</force>
""" + "\n".join(f"""<parameter name="mu{i}" start="0.5"/><point name="foot{i}" in="block" x="{place}" y="-{HEIGHT}"/><contact name="c{i}" gap="foot{i}.y"/>
  <friction name="f{i}" velocity="foot{i}.vx" force="mu{i}*c{i}.force"/>""" for i, place in enumerate(PLACES)) + "</system>"  # fmt: skip
GUIDE = """<system name="GuidedBlock"><coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/><particle mass="2" x="x" y="y"/>
  <force coordinate="y">-20</force><force coordinate="x">time</force><contact name="floor" gap="y"/>
  <friction name="f" velocity="vx" force="0.3*floor.force"/><friction name="guide" velocity="vx" force="4" stiction="5"/></system>"""
PAIR = """<system name="LiftedPair"><coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/><coordinate name="z" velocity="vz" start="1"/>
  <particle mass="2" x="x" y="y"/><particle mass="3" x="z" y="0"/><constraint name="rod">z - x - 1</constraint><contact name="floor" gap="y"/>
  <parameter name="stiction" start="0.4"/><force coordinate="y">4*time - 20</force><force coordinate="x">time/4</force>
  <friction name="lifted" velocity="vx" force="0.6*floor.force"/><friction name="left" velocity="vz" force="0.4*30" stiction="stiction*30"/></system>"""
# The same along the line (0.6, 0.8) of a plane.
PLANE_PAIR = """<system name="LiftedPairOnPlane"><coordinate name="x" velocity="vx"/><coordinate name="u" velocity="vu"/><coordinate name="y" velocity="vy"/>
  <coordinate name="z" velocity="vz" start="1"/><coordinate name="w" velocity="vw"/><particle mass="2" x="x" y="y" z="u"/><particle mass="3" x="z" y="0" z="w"/>
  <constraint name="rod">z - x - 1</constraint><constraint name="guide">w - u</constraint><contact name="floor" gap="y"/>
  <parameter name="stiction" start="0.4"/><force coordinate="y">4*time - 20</force><force coordinate="x">0.6*time/4</force><force coordinate="u">0.8*time/4</force>
  <friction name="lifted" velocity="vx" across="vu" force="0.6*floor.force"/><friction name="left" velocity="vz" across="vw" force="0.4*30" stiction="stiction*30"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("indeterminate", {"LoadedLadder": LADDER, "ThreeFeet": FEET, "GuidedBlock": GUIDE, "LiftedPair": PAIR, "LiftedPairOnPlane": PLANE_PAIR})


def largest_pull(mu1, mu2, q):
    """Return the largest pull that forces N1, T1, N2, T2 within the limits balance; the pull is the fifth unknown."""
    s, c = np.sin(q), np.cos(q)
    balance = [[0, 1, 1, 0, 1], [1, 0, 0, 1, 0], [-c, -s, s, c, -s]]
    limits = [[-mu1, 1, 0, 0, 0], [-mu1, -1, 0, 0, 0], [0, 0, -mu2, 1, 0], [0, 0, -mu2, -1, 0]]
    bounds = [(0, None), (None, None), (0, None), (None, None), (0, None)]
    found = linprog([0, 0, 0, 0, -1], limits, np.zeros(4), balance, [0, MASS * GRAVITY, 0], bounds)
    return found.x[4] if found.status == 0 else 0.0


def falling(time, state, mu1, mu2):
    """The ladder slides down along wall and floor, with both frictions at their limits."""
    q, w = state
    s, c, pull = np.sin(q), np.cos(q), RAMP * time
    # rows: x, y, q; unknowns: the angular acceleration, N1, N2
    matrix = [[-MASS * s, mu1, -1], [MASS * c, -1, -mu2], [INERTIA, c - mu1 * s, -s - mu2 * c]]
    return [w, np.linalg.solve(matrix, [pull + MASS * c * w * w, MASS * (s * w * w - GRAVITY), -s * pull])[0]]


def draws():
    random = np.random.default_rng(5)
    cases = [(0.4, 0.6, 1.2), (0.5, 0.3, 1.1), (1.2, 1.3, 0.5)]
    while len(cases) < 10:
        case = tuple(round(float(x), 3) for x in (random.uniform(0.2, 1.2), random.uniform(0.2, 1.2), random.uniform(0.6, 1.3)))
        if 1.0 < largest_pull(*case) < 100.0:
            cases.append(case)
    return cases


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
@pytest.mark.parametrize("mu1, mu2, q0", draws())
def test_a_ladder_rests_while_any_forces_balance_the_pull(mu1, mu2, q0, tolerance):
    instance = Instance("LoadedLadder").initialize({"mu1": mu1, "mu2": mu2, "q0": q0}, tolerance=tolerance)
    start = largest_pull(mu1, mu2, q0) / RAMP
    before, behind = start * (1 - 1e-6), start + 0.1
    for part in np.diff(np.linspace(0.0, before, 20)):
        instance.step(part)
        floor, foot, wall, head = instance.get("floor.force", "foot.force", "wall.force", "head.force")  # those of frictions are against positive velocities
        assert min(floor, wall) > 0 and abs(foot) <= mu1 * floor * (1 + 1e-9) and abs(head) <= mu2 * wall * (1 + 1e-9)
        assert floor - head == pytest.approx(MASS * GRAVITY, rel=1e-9)
    assert instance.get("vx", "w") == pytest.approx([0.0, 0.0], abs=1e-12)
    instance.step(behind - before)
    angle = solve_ivp(falling, (start, behind), [q0, 0.0], args=(mu1, mu2), method="DOP853", rtol=1e-12, atol=1e-14).y[0, -1]
    assert instance.get("q") == pytest.approx(angle, abs=10 * tolerance)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_a_ladder_that_has_left_the_wall_slides_and_sticks_by_turns(tolerance):
    """A foot that begins to slip against its creep within the tolerance would stop at once, again and again."""
    instance = Instance("LoadedLadder").initialize({"mu1": 0.5, "mu2": 0.3, "q0": 1.1}, tolerance=tolerance)
    for _ in range(13000):
        instance.step(0.002)
    assert instance.get("floor.force") > 0


def test_a_ladder_has_a_reserve_at_a_constant_load():
    """At the start its head acts with its limit, as the forces of least norm would pull at the wall."""
    instance = Instance("LoadedLadder").initialize({"mu1": 0.509, "mu2": 0.88, "q0": 1.3}, tolerance=1e-6)
    instance.step(0.1)
    wall, head = instance.get("wall.force", "head.force")
    assert abs(head) < 0.9 * 0.88 * wall


@pytest.mark.parametrize("mu", [(0.2, 0.6, 0.2), (0.8, 0.2, 0.2), (0.2, 0.8, 0.8), (0.5, 0.5, 0.5)])
def test_a_block_on_three_feet_slips_at_the_largest_pull(mu):
    """The feet share the weight as the frictions need it. N and T of the feet, and the pull at the block's centre."""
    balance = [[*[1] * 3, *[0] * 3, 0], [*[0] * 3, *[1] * 3, -1], [*PLACES, *[-HEIGHT] * 3, 0]]
    limits = [[*(-mu[i] * (i == k) for k in range(3)), *(sign * (i == k) for k in range(3)), 0] for i in range(3) for sign in (1, -1)]
    bounds = [(0, None)] * 3 + [(None, None)] * 3 + [(0, None)]
    start = linprog([0] * 6 + [-1], limits, np.zeros(6), balance, [WEIGHT, 0, 0], bounds).x[6] / RAMP
    instance = Instance("ThreeFeet").initialize({f"mu{i}": value for i, value in enumerate(mu)}, tolerance=1e-6)
    instance.step(start * (1 - 1e-5))
    assert instance.get("vx") == pytest.approx(0.0, abs=1e-12)
    instance.step(0.1)
    assert instance.get("vx") > 1e-4


def test_a_guide_with_stiction_holds_beside_a_floor():
    """Together they hold 0.3*20 N + 5 N. Then the guide has its kinetic friction."""
    instance = Instance("GuidedBlock").initialize(tolerance=1e-6)
    for time in np.arange(1.0, 11.0):
        instance.step(1.0)
        assert abs(instance.get("guide.force")) <= 5 * (1 + 1e-9) and instance.get("vx") == pytest.approx(0.0, abs=1e-12), time
    instance.step(1.0 - 1e-4)
    assert instance.get("vx") == pytest.approx(0.0, abs=1e-12)
    instance.step(2.0 + 1e-4)
    assert instance.get("vx") == pytest.approx((13**2 - 11**2) / 4 - 10 * 2 / 2, abs=1e-4)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
@pytest.mark.parametrize("stiction", [0.4, 0.5])
def test_a_block_that_is_lifted_leaves_its_load_to_the_other(stiction, tolerance):
    """A rod joins them. The lifted one keeps a share of its falling limit, without an event for each part that it loses."""
    instance = Instance("LiftedPair").initialize({"stiction": stiction}, tolerance=tolerance)
    rest_while_lifted(instance, stiction, lambda: instance.get("lifted.force", "left.force"))
    start = 120 * stiction
    to(instance, start - 1e-3)
    assert instance.get("vx", "vz") == pytest.approx([0.0, 0.0], abs=1e-12)
    assert instance.get("y") == pytest.approx((start - 1e-3 - 5) ** 3 / 3, rel=1e-6)
    to(instance, start + 2)
    assert instance.get("vz") == pytest.approx(((start + 2) ** 2 - start**2) / 40 - 12 * 2 / 5, rel=1e-5)
    assert value(instance, "events") < 20


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
def test_a_block_that_is_lifted_leaves_its_load_in_a_plane(tolerance):
    instance = Instance("LiftedPairOnPlane").initialize(tolerance=tolerance)
    rest_while_lifted(instance, 0.4, lambda: [0.6 * instance.get(f"{name}.force") + 0.8 * instance.get(f"{name}.across.force") for name in ("lifted", "left")])
    to(instance, 50)
    assert instance.get("vz", "vw") == pytest.approx([0.06, 0.08], rel=1e-5)
    assert value(instance, "events") < 20


def rest_while_lifted(instance, stiction, forces):
    for time in (2.0, 4.0, 4.9, 4.97, 4.99, 4.9999, 5 - 1e-7):
        to(instance, time)
        floor, (lifted, left) = instance.get("floor.force"), forces()
        assert floor == pytest.approx(20 - 4 * time, abs=1e-9) and lifted + left == pytest.approx(time / 4, rel=1e-12)
        assert abs(lifted) <= 0.6 * floor * (1 + 1e-9) and abs(left) <= stiction * 30
        assert [value(instance, f"{name}.sliding") for name in ("lifted", "left")] == [0, 0]
