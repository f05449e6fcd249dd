"""Friction proportional to the force of a constraint that passes through 0."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu import DISCARD, build_systems

MASS, RADIUS, MU, G = 0.4, 0.6, 0.15, 9.81
TOLERANCES = {"taylor": 1e-10, "erk": 1e-10, "bdf": 1e-8, "radau": 1e-10}
HOOP = """<system name="Hoop{method}">
  <coordinate name="x" velocity="vx" start="0.6*sin(2.6)" velocityStart="3*cos(2.6)"/>
  <coordinate name="y" velocity="vy" start="-0.6*cos(2.6)" velocityStart="3*sin(2.6)"/>
  <particle mass="0.4" x="x" y="y"/>
  <potential>0.4*9.81*y</potential>
  <constraint name="c">(x^2 + y^2 - 0.36)/1.2</constraint>
  <friction name="rub" velocity="(x*vy - y*vx)/0.6" force="0.15*{law}"/>
  <solver method="{method}" tolerance="{tolerance}"/>
</system>
"""


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {f"Hoop{method}": HOOP.format(method=method, tolerance=t, law="abs(c.force)") for method, t in TOLERANCES.items()}
    texts["HoopSigned"] = HOOP.format(method="taylor", tolerance=1e-10, law="c.force").replace("Hooptaylor", "HoopSigned")
    build_systems("frictions-of-forces", texts)


def angle_of_bead(phi, speed, end):
    """Angle by r'' = -g sin(phi) - mu |N| sign(v) with N = v^2/r + g cos(phi), integrated between sign changes of N and v."""
    time, state, side, way = 0.0, [phi, speed / RADIUS], np.sign(speed**2 / RADIUS + G * np.cos(phi)), np.sign(speed)

    def normal(_, z):
        return RADIUS * z[1] ** 2 + G * np.cos(z[0])

    def stop(_, z):
        return z[1]

    def slope(t, z):
        return [z[1], (-G * np.sin(z[0]) - MU * side * way * normal(t, z)) / RADIUS]

    normal.terminal = stop.terminal = True
    while time < end:
        found = solve_ivp(slope, (time, end), state, "DOP853", events=(normal, stop), rtol=1e-12, atol=1e-13)
        time, state = found.t[-1], found.y[:, -1]
        if len(found.t_events[0]) > 0:
            side = -side
        if len(found.t_events[1]) > 0:
            if abs(np.sin(state[0])) <= MU * abs(np.cos(state[0])):
                break
            way, state[1] = -np.sign(np.sin(state[0])), 0.0
        if found.status == 1:  # away from the event, with which the next interval starts
            slopes = slope(time, state)
            step = 1e-9
            time, state = time + step, [state[0] + step * slopes[0], state[1] + step * slopes[1]]
    return state[0]


@pytest.mark.parametrize("method", TOLERANCES)
@pytest.mark.parametrize("phi, speed", [(2.6, 3.0), (0.9, 3.0), (1.0, 3.0), (1.1, 3.0), (2.0, 1.0), (1.7, 2.5)])
def test_a_bead_on_a_hoop(open_fmu, method, phi, speed):
    """The force of the hoop changes its sign. The friction, mu times its magnitude, has a kink there and stays positive."""
    start = {"x": RADIUS * np.sin(phi), "y": -RADIUS * np.cos(phi), "vx": speed * np.cos(phi), "vy": speed * np.sin(phi)}
    instance = open_fmu(f"Hoop{method}").initialize(start)
    rows = instance.run(1, 0.01, "x", "y", "rub.force")
    assert np.all(np.isfinite(rows))
    expected = angle_of_bead(phi, speed, 1)
    assert rows[-1][1:3] == pytest.approx([RADIUS * np.sin(expected), -RADIUS * np.cos(expected)], abs=2e-6)


def test_a_force_with_the_wrong_sign_is_an_error(open_fmu):
    instance, phi = open_fmu("HoopSigned"), 1.1
    start = {"x": RADIUS * np.sin(phi), "y": -RADIUS * np.cos(phi), "vx": 3 * np.cos(phi), "vy": 3 * np.sin(phi)}
    with instance.fails(DISCARD, r"the force of the friction 'rub' is -.*; expected 0 or more, such as abs\(...\)"):
        instance.initialize(start).run(1, 0.01, "x")
