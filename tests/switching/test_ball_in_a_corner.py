"""
A ball on the floor turns against a wall. The torque M grows until both frictions are at their limits, in one instant: no one can slip without the other.

With T on the floor, which presses the ball to the wall, and t <= mu T on the wall, M = R (T + t). The floor bears m g - t, so that T <= mu (m g - t). Both are at
their limits at M = mu (1 + mu)/(1 + mu^2) m g R. Beyond it the ball turns with I w' = M - R (T + t). Which friction has which part of a smaller M is not determined.

With mu > 1 any M is held: t < 0 presses the ball to the floor, which bears more friction than t takes. The ball could also slip; it stays at rest.
"""

import pytest

import fmu
from fmu import build_systems

MASS, RADIUS, INERTIA, GRAVITY, RATE = 2.0, 0.1, 0.008, 9.81, 2.0

SYSTEM = f"""<system name="BallInCorner">
  <parameter name="mu" start="0.4" unit="1"/>
  <gravity z="{-GRAVITY}"/>
  <shape name="floor" type="plane"/>
  <frame name="atWall"><translate x="{RADIUS}"/><rotate axis="y" angle="-1*pi/2"/></frame>
  <shape name="wall" in="atWall" type="plane"/>
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="z" velocity="vz" unit="m" start="{RADIUS}"/>
  <coordinate name="phi" velocity="w" unit="rad"/>
  <frame name="ball"><translate x="x" y="y" z="z"/><rotate axis="y" angle="phi"/></frame>
  <body name="mass" in="ball" mass="{MASS}" Ixx="{INERTIA}" Iyy="{INERTIA}" Izz="{INERTIA}"/>
  <shape name="surface" in="ball" type="sphere" radius="{RADIUS}"/>
  <contact name="onFloor" between="surface" and="floor" friction="mu"/>
  <contact name="onWall" between="surface" and="wall" friction="mu"/>
  <torque on="ball" y="{RATE}*time"/>
</system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("ball-in-corner", {"BallInCorner": SYSTEM})


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("mu", [0.2, 0.4, 0.9])
def test_frictions_slip_together(mu, tolerance):
    weight = MASS * GRAVITY
    slips = mu * (1 + mu) / (1 + mu**2) * weight * RADIUS / RATE
    instance = fmu.Instance("BallInCorner").initialize({"mu": mu}, tolerance=tolerance)
    instance.step(0.999 * slips)
    assert abs(instance.get("w")) < 1e-15 and instance.get("onWall.force") <= weight
    instance.step(0.201 * slips)
    later = 0.2 * slips
    assert instance.get("w") == pytest.approx(RATE * later**2 / 2 / INERTIA, rel=1e-5)
    assert instance.get("onWall.force") == pytest.approx(mu / (1 + mu**2) * weight, rel=1e-9)
    assert sum("friction' switches" in text for _, _, text in instance.messages) <= 4  # no chatter at the onset
    instance.free()


@pytest.mark.parametrize("mu", [1.1, 1.5, 2.0])
def test_frictions_that_jam_hold_any_torque(mu):
    instance = fmu.Instance("BallInCorner").initialize({"mu": mu})
    for _ in range(20):
        instance.step(0.2)
        assert abs(instance.get("w")) < 1e-9
    instance.free()
