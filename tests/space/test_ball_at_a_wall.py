"""
A ball on the floor that also touches a wall: two contacts whose frictions may work against each other, so that their forces are not unique.
Loads that grow with time, from zero, press it on the wall and push it along.

While the ball rolls on both, v' = K t/(m + 2 I/r^2) with the push K t, and the wall needs the friction I/r^2 v' along itself. If that is less
than mu F t, with the press F t, it rolls. The floor may draw the ball to the wall with any force s, which the wall's friction balances across.
Forces that let it roll exist while (I v'/r^2)^2 + s^2 <= mu^2 (F t + s)^2 for some s, which is I v'/r^2 <= mu F t/sqrt(1 - mu^2). Beyond, it
slides along the wall, whose friction is mu F t. In between both motions fulfil Coulomb's law.
"""

import math

import numpy as np
import pytest

import fmu
from building import build_systems

MASS, RADIUS, PRESS = 2.0, 0.1, 1.0
INERTIA = 0.4 * MASS * RADIUS**2
QUATERNION = "".join(f'<coordinate name="q{i}" velocity="r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
SYSTEM = f"""<system name="{{name}}">
  <parameter name="mu" start="0.5" unit="1"/><parameter name="push" start="1" unit="N/s"/><parameter name="F" start="{PRESS}" unit="N/s"/>
  <gravity z="-9.81"/>
  <coordinate name="x" velocity="vx" unit="m" start="{RADIUS}"/><coordinate name="y" velocity="vy" unit="m"/>
  <coordinate name="z" velocity="vz" unit="m" start="{RADIUS}"/>{QUATERNION}
  <frame name="ball"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>
  <body name="body" in="ball" mass="{MASS}" Ixx="{INERTIA}" Iyy="{INERTIA}" Izz="{INERTIA}"/>
  <shape name="sphere" in="ball" type="sphere" radius="{RADIUS}"/>
  <frame name="side"><rotate axis="y" angle="pi/2"/></frame>
  <shape name="floor" type="plane"/><shape name="wall" in="side" type="plane"/>
  <contact name="below" between="sphere" and="floor" friction="mu"/>
  <contact name="beside" between="sphere" and="wall" friction="mu"/>
  <point name="centre" in="ball"/>
  <force on="centre" x="-F*time" y="push*time"/>
  <solver method="{{method}}" tolerance="1e-8"/>
</system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("ball-at-a-wall", {name: SYSTEM.format(name=name, method=method) for name, method in (("BallAtWall", "taylor"), ("BallAtWallRadau", "radau"))})


def spin(instance):
    """Return the angular velocity about the vertical, the z component of 2 q' conj(q)."""
    q0, q1, q2, q3, r0, r1, r2, r3 = instance.get(*(f"{a}{i}" for a in "qr" for i in range(4)))
    return 2 * (q0 * r3 - q3 * r0 - r1 * q2 + r2 * q1)


@pytest.mark.parametrize("share", [0.3, 0.99, 1.01, 3.0])
@pytest.mark.parametrize("mu", [0.1, 0.3, 0.6, 0.9])
@pytest.mark.parametrize("system", ["BallAtWall", "BallAtWallRadau"])
def test_rolling_and_sliding(open_fmu, system, mu, share):
    limit = mu * PRESS * (MASS * RADIUS**2 / INERTIA + 2)  # of the push
    push, instance = share * limit / (1 if share < 1 else math.sqrt(1 - mu**2)), open_fmu(system)
    instance.initialize({"mu": mu, "push": push})
    instance.run(1.0, 0.05)
    if share < 1:
        v = push / 2 / (MASS + 2 * INERTIA / RADIUS**2)
        turns = v / RADIUS
    else:
        v = (push - mu * PRESS) / 2 / (MASS + INERTIA / RADIUS**2)
        turns = mu * PRESS * RADIUS / 2 / INERTIA
    assert [instance.get("vy"), spin(instance)] == pytest.approx([v, turns], rel=1e-5)
    assert np.abs(instance.get("vx", "vz")).max() < 1e-9
