"""
Bodies that rest or slide on contacts. The errors of a solver are no impacts, and a friction without force needs no mode. Frictions stick whose contacts have
come to rest. Each motion is compared with a closed form, or with equations that are written here.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu import Instance, build_systems

LADDER = """<system name="{name}"><parameter name="th0" start="0.5"/><parameter name="mu" start="0.5"/>
  <coordinate name="x" velocity="vx" start="sin(th0)"/><coordinate name="y" velocity="vy" start="cos(th0)"/><coordinate name="p" velocity="w" start="th0"/>
  <body name="b" mass="5" x="x" y="y" inertia="5/3" angle="p"/><potential>5*9.81*y</potential>
  <point name="foot" in="base" x="x + sin(p)" y="y - cos(p)"/><point name="head" in="base" x="x - sin(p)" y="y + cos(p)"/>
  <contact name="floor" gap="y - cos(p)"/><contact name="wall" gap="x - sin(p)"/>{further}
  <friction name="fw" velocity="head.vy" force="mu*wall.force"/></system>"""
# The head has a contact with the floor, far away, and a friction on it.
HEAD = """<contact name="headfloor" gap="y + cos(p)"/><friction name="fh" velocity="head.vx" force="mu*headfloor.force"/>
  <friction name="ff" velocity="foot.vx" force="mu*floor.force"/>"""
TABLE = """<system name="{name}"><parameter name="h" start="0.5"/><parameter name="mu" start="0"/><coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy" start="0.5"/>
  <coordinate name="p" velocity="w"/><body name="b" mass="2" x="x" y="y" inertia="0.3" angle="p"/><potential>2*9.81*y</potential>
  <point name="q" in="b" y="h"/><force on="q" x="5*time"/>
  <for index="i" from="1" to="{legs}"><point name="l[i]" in="b" x="((i-1)/({legs}-1)-0.5)*0.8" y="-0.5"/><contact name="c[i]" gap="l[i].y"/>
  <friction name="f[i]" velocity="l[i].vx" force="mu*c[i].force"/></for></system>"""
CORNER = """<system name="{name}"><parameter name="e" start="0"/><coordinate name="x" velocity="vx" start="0.9"/><coordinate name="y" velocity="vy" start="0.15" velocityStart="-1"/>
  <coordinate name="p" velocity="w" velocityStart="0.1"/><body name="b" mass="1" x="x" y="y" inertia="0.004" angle="p"/><force x="3" y="-9.81" on="b"/>
  <contact name="floor" gap="y - 0.1" restitution="e"/><contact name="wall" gap="0.9 - x" restitution="e"/>
  <friction name="ff" velocity="vx + 0.1*w" force="floor.force"/><friction name="fw" velocity="vy + 0.1*w" force="wall.force"/></system>"""
CARDS = """<system name="{name}">
  <coordinate name="x1" velocity="vx1" start="-sin(1)/2"/><coordinate name="y1" velocity="vy1" start="cos(1)/2"/><coordinate name="p1" velocity="w1" start="-1"/>
  <coordinate name="x2" velocity="vx2" start="sin(1)/2"/><coordinate name="y2" velocity="vy2" start="cos(1)/2"/><coordinate name="p2" velocity="w2" start="1"/>
  <body name="b1" mass="1" x="x1" y="y1" inertia="1/12" angle="p1"/><body name="b2" mass="1" x="x2" y="y2" inertia="1/12" angle="p2"/><potential>9.81*(y1 + y2)</potential>
  <point name="f1" in="b1" y="-0.5"/><point name="h1" in="b1" y="0.5"/><point name="f2" in="b2" y="-0.5"/><point name="h2" in="b2" y="0.5"/>
  <contact name="c1" gap="f1.y"/><contact name="c2" gap="f2.y"/><contact name="top" gap="h2.x - h1.x"/><contact name="d1" gap="h1.y"/><contact name="d2" gap="h2.y"/>
  <friction name="r1" velocity="f1.vx" force="3*c1.force"/><friction name="r2" velocity="f2.vx" force="3*c2.force"/><friction name="rt" velocity="h2.vy - h1.vy" force="0.5*top.force"/>
  <friction name="s1" velocity="h1.vx" force="3*d1.force"/><friction name="s2" velocity="h2.vx" force="3*d2.force"/></system>"""
ROW = """<system name="{name}"><parameter name="M" start="1"/><coordinate name="x1" velocity="v1" start="1" velocityStart="1"/><coordinate name="x2" velocity="v2" start="2" velocityStart="-1"/>
  <coordinate name="x3" velocity="v3" start="3" velocityStart="-1"/><particle mass="M" x="x1"/><particle mass="1" x="x2"/><particle mass="M" x="x3"/>
  <contact name="c1" gap="x2 - x1 - 1" restitution="1"/><contact name="c2" gap="x3 - x2 - 1" restitution="1"/></system>"""


def stack(count):
    """Return boxes of 0.2 m x 0.2 m that lie on each other with two corners each."""
    text = '<system name="{name}"><parameter name="mu" start="0"/><parameter name="e" start="0"/><parameter name="d" start="0.02"/>'
    for i in range(1, count + 1):
        text += f"""<coordinate name="x{i}" velocity="vx{i}"/><coordinate name="y{i}" velocity="vy{i}" start="{2 * i - 1}*0.1 + {i}*d"/>
          <coordinate name="p{i}" velocity="w{i}"/><body name="b{i}" mass="1" x="x{i}" y="y{i}" inertia="0.02/3" angle="p{i}"/><potential>9.81*y{i}</potential>"""
        for side, x in (("l", -0.1), ("r", 0.1)):
            corner, below = f"{side}{i}", i - 1
            gap, velocity = f"{corner}.y", f"{corner}.vx"
            if below > 0:
                gap = f"cos(p{below})*({corner}.y - y{below}) - sin(p{below})*({corner}.x - x{below}) - 0.1"
                velocity = f"cos(p{below})*({corner}.vx - vx{below}) + sin(p{below})*({corner}.vy - vy{below}) + 0.1*w{below}"
            text += f"""<point name="{corner}" in="b{i}" x="{x}" y="-0.1"/><contact name="c{corner}" gap="{gap}" restitution="e"/>
              <friction name="f{corner}" velocity="{velocity}" force="mu*c{corner}.force"/>"""
    return text + "</system>"


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"SmoothLadder": LADDER.format(name="{name}", further=""), "LadderWithHead": LADDER.format(name="{name}", further=HEAD)}
    texts |= {f"Table{legs}": TABLE.format(name="{name}", legs=legs) for legs in (3, 4, 5, 8)}
    texts |= {"StackOfFour": stack(4), "CornerBall": CORNER, "Cards": CARDS, "RowOfThree": ROW}
    build_systems("holding", {name: text.format(name=name) for name, text in texts.items()})


def run(name, end, step, *names, tolerance=1e-8, **values):
    instance = Instance(name)
    instance.initialize(values, tolerance=tolerance)
    for _ in range(round(end / step)):
        instance.step(step)
    return instance.get(*names)


def ladder(th0, mu, end):
    """Return the angle of a ladder whose head slides down a rough wall, and whose foot slides on a smooth floor, at a time."""

    def rates(_, state):
        p, w = state
        s, c = np.sin(p), np.cos(p)
        # rows: m x'' = N, m y'' = R - m g + mu N, I p'' = s R - (c + mu s) N; with x = s, y = c
        matrix = [[5 * c, -1, 0], [-5 * s, -mu, -1], [5 / 3, c + mu * s, -s]]
        return [w, np.linalg.solve(matrix, [5 * s * w * w, 5 * c * w * w - 5 * 9.81, 0])[0]]

    return solve_ivp(rates, (0, end), [th0, 0], method="DOP853", rtol=1e-12, atol=1e-14).y[0, -1]


@pytest.mark.parametrize("mu", [0.1, 0.5])
def test_a_ladder_on_a_smooth_floor_starts_at_any_angle(mu):
    """While the head sticks, the wall has no force: its share of the weight, within rounding of 0 or not, has the direction of slip."""
    for th0 in [0.20897435897435898, *np.linspace(0.15, 1.3, 40)]:
        assert run("SmoothLadder", 0.1, 0.1, "p", th0=th0, mu=mu) == pytest.approx(ladder(th0, mu, 0.1), abs=1e-7)


@pytest.mark.parametrize("step", [0.1, 3])
@pytest.mark.parametrize("tolerance", [1e-3, 3e-4, 1e-8])
def test_a_smooth_ladder_leaves_the_wall(tolerance, step):
    """It leaves where cos p = 2/3 cos p0; vx then stays, 2/3 cos(p0) sqrt(g cos p0 / 2). The friction at the head has no force on the way."""
    vx, c0 = run("LadderWithHead", 3, step, "vx", mu=0, tolerance=tolerance), np.cos(0.5)
    assert vx == pytest.approx(2 / 3 * c0 * np.sqrt(9.81 * c0 / 2), rel=max(1e-6, tolerance))


@pytest.mark.parametrize("h", [0.3, 0.5])
@pytest.mark.parametrize("legs", [3, 4, 5, 8])
def test_a_sliding_table_continues_where_a_leg_is_unloaded(legs, h):
    """m x'' = 5 t; the moment 5 t h tips it at 2 g 0.4 / (5 h). The outer leg of three has no force from two thirds of this time on."""
    end = 0.95 * 2 * 9.81 * 0.4 / (5 * h)
    x, y, p = run(f"Table{legs}", end, end, "x", "y", "p", h=h)
    assert x == pytest.approx(5 * end**3 / 12, rel=1e-9) and abs(y - 0.5) < 1e-9 and abs(p) < 1e-9


@pytest.mark.parametrize("e", [0, 0.5, 0.9])
def test_a_ball_comes_to_rest_in_a_corner(e):
    """With mu = 1 one sliding and one sticking friction have no forces: both stick, and the corner carries the ball."""
    x, y, w = run("CornerBall", 10, 10, "x", "y", "w", e=e)
    assert x == pytest.approx(0.9, abs=1e-7) and y == pytest.approx(0.1, abs=1e-7) and abs(w) < 1e-7


@pytest.mark.parametrize("step", [0.1, 1, 10])
def test_two_leaning_rods_stand(step):
    """They need mu >= tan(1) / 2 = 0.78 of 3. Velocities of 1e-15 m/s at contacts that hold are no impacts."""
    assert np.allclose(run("Cards", 20, step, "x1", "y1", "p1", "x2", "y2", "p2"), [-np.sin(1) / 2, np.cos(1) / 2, -1, np.sin(1) / 2, np.cos(1) / 2, 1], atol=1e-9)


def elastic_row(mass):
    """Return the velocities of three balls after all their elastic impacts, taken one by one."""
    v, m = np.array([1.0, -1.0, -1.0]), [mass, 1.0, mass]
    while v[0] > v[1] or v[1] > v[2]:
        i = 0 if v[0] - v[1] > v[1] - v[2] else 1
        mean = (m[i] * v[i] + m[i + 1] * v[i + 1]) / (m[i] + m[i + 1])
        v[[i, i + 1]] = 2 * mean - v[[i, i + 1]]
    return v


@pytest.mark.parametrize("mass", [1e2, 1e5, 1e6, 1e8])
def test_many_elastic_impacts_at_one_time_keep_the_energy(mass):
    """Of 22,214 impacts at a mass of 1e8 all are taken."""
    v1, v2, v3 = run("RowOfThree", 1, 1, "v1", "v2", "v3", M=mass)
    assert [v1, v3] == pytest.approx(elastic_row(mass)[[0, 2]], abs=1e-6)
    assert mass * v1**2 + v2**2 + mass * v3**2 == pytest.approx(2 * mass + 1, rel=1e-6)


@pytest.mark.parametrize("mu, e, d", [(0, 0.5, 0.02), (0.4, 0.3, 0.02), (1, 0.3, 0.01)])
def test_boxes_that_fall_on_each_other_come_to_rest(mu, e, d):
    """By symmetry they move vertically. Of the many impacts at one time, those with 1e-12 of the energy are taken together."""
    names = [f"{name}{i}" for i in range(1, 5) for name in ("x", "y", "p")]
    rest = [value for i in range(1, 5) for value in (0, 0.2 * i - 0.1, 0)]
    assert np.allclose(run("StackOfFour", 1, 1, *names, mu=mu, e=e, d=d), rest, atol=1e-6)
