"""States of first order in positions, kinetic energies and constraints, against the principle of d'Alembert, by hand and by SymPy."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from fmu import build_systems, lagc

pytestmark = pytest.mark.long

METHODS = ["taylor", "auto", "radau", "bdf", "erk"]
SYSTEMS = {
    "Carried": '<coordinate name="q" velocity="v" start="0.3"/><state name="z" start="0.5" rate="-z + sin(time)"/>'
    '<particle name="b" mass="2" x="q + z"/><potential>3*q^2/2</potential>',
    # The rate depends on the coordinate; derivatives of the energy by the coordinate must not include this dependence.
    "Pivot": '<coordinate name="th" velocity="w" start="0.7"/><state name="z" start="0.5" rate="-th*z + 0.3"/>'
    '<particle name="b" mass="2" x="1.5*sin(th) + z" y="-1.5*cos(th)"/><potential>2*9.81*b.y</potential><output name="o">der(b.x)</output>',
    "Drawn": '<coordinate name="x" velocity="vx" start="0.6"/><coordinate name="y" velocity="vy" start="-0.8"/><state name="z" start="1" rate="0.3*(1.5 - z)*cos(time)"/>'
    '<particle name="b" mass="2" x="x" y="y"/><potential>2*9.81*y</potential><constraint name="rod">x^2 + y^2 - z^2</constraint>',
    "Burning": '<coordinate name="x" velocity="v"/><state name="m" start="3" rate="-0.5 - 0.1*m"/><kinetic>m*v^2/2</kinetic><force coordinate="x">2</force>',
    "Geared": '<coordinate name="x" velocity="v" velocityStart="0.4"/><coordinate name="y" velocity="w"/><particle mass="1" x="x"/><particle mass="1" x="y"/>'
    '<state name="z" start="0.4" rate="-v + cos(time) - 0.2*w"/><potential>(x-y)^2*4</potential><constraint name="c">v - z</constraint>',
    # A body in a frame rotated by a state, whose rate depends on another state, which follows a velocity.
    "Turned": '<coordinate name="th" velocity="w" start="0.7"/><state name="z" start="0.5" rate="0.4*sin(th) + 0.2*y"/><state name="y" start="0.1" rate="w - y"/>'
    '<frame name="arm"><rotate axis="z" angle="z"/></frame><frame name="f" in="arm"><translate x="2"/><rotate axis="z" angle="th"/></frame>'
    '<body name="b" in="f" mass="2" x="0.5" Ixx="0.1" Iyy="0.2" Izz="0.3"/>',
}  # fmt: skip


def carried(t, state):
    q, v, z = state
    rate = -z + np.sin(t)
    return [v, -1.5 * q - (-rate + np.cos(t)), rate]


def pivot(t, state):
    th, w, z = state
    rate = -th * z + 0.3
    return [w, (-9.81 * np.sin(th) - np.cos(th) * (-w * z - th * rate)) / 1.5, rate]


def drawn(t, state):
    x, y, vx, vy, z = state
    reach = 0.3 * (1.5 - z)
    rate, second = reach * np.cos(t), -0.3 * reach * np.cos(t) ** 2 - reach * np.sin(t)
    pull = -(rate**2 + z * second - vx**2 - vy**2 + 9.81 * y) / (x**2 + y**2)
    return [vx, vy, -pull * x, -9.81 - pull * y, rate]


def burning(t, state):
    x, v, m = state
    rate = -0.5 - 0.1 * m
    return [v, (2 - rate * v) / m, rate]


def geared(t, state):
    x, y, v, w, z = state
    rate = -v + np.cos(t) - 0.2 * w
    return [v, w, rate, 8 * (x - y), rate]


def hauled(t, state):
    """A pendulum whose length is 1 + 0.2 sin t."""
    x, y, vx, vy = state
    length, rate, second = 1 + 0.2 * np.sin(t), 0.2 * np.cos(t), -0.2 * np.sin(t)
    pull = -(rate**2 + length * second - vx**2 - vy**2 + 9.81 * y) / (x**2 + y**2)
    return [vx, vy, -pull * x, -9.81 - pull * y]


def held(t, state):
    q, v, z = state
    return [v, (5 * (z - q) - 0.3 * v) / 2, np.cos(t) - z]


def derive_rotated():
    t, a, *symbols = sympy.symbols("t a TH W Z Y")
    th, z, y = (sympy.Function(name)(t) for name in ("th", "z", "y"))
    rates = {z.diff(t): 0.4 * sympy.sin(th) + 0.2 * y, y.diff(t): th.diff(t) - y}

    def twice(e):
        return e.diff(t).subs(rates).diff(t).subs(rates)

    x, up, angle = 2 * sympy.cos(z) + sympy.cos(z + th) / 2, 2 * sympy.sin(z) + sympy.sin(z + th) / 2, z + th
    work = 2 * (twice(x) * x.diff(th) + twice(up) * up.diff(th)) + 0.3 * twice(angle)
    work = work.subs(th.diff(t, 2), a).subs(th.diff(t), symbols[1]).subs({th: symbols[0], z: symbols[2], y: symbols[3]})
    acceleration = sympy.lambdify(symbols, -work.subs(a, 0) / work.diff(a))
    return lambda t, s: [s[1], acceleration(*s), 0.4 * np.sin(s[0]) + 0.2 * s[3], s[1] - s[3]]


REFERENCES = {"Carried": (carried, "q v z"), "Pivot": (pivot, "th w z"), "Drawn": (drawn, "x y vx vy z"), "Burning": (burning, "x v m"), "Geared": (geared, "x y v w z"), "Turned": (None, "th w z y")}  # fmt: skip


def system(name, method):
    return f'<system name="{name}_{method}">{SYSTEMS[name]}<solver method="{method}" tolerance="1e-11"/></system>'


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {f"{name}_{method}": system(name, method) for name in SYSTEMS for method in METHODS}
    for name in WORKED:
        for method in ("taylor", "radau"):
            worked = f"{name}_{method}_worked"
            texts[worked] = f'<system name="{worked}">{SYSTEMS_WITH_WORK[name]}<work/><solver method="{method}" tolerance="1e-11"/></system>'
    build_systems("moving-states", texts)


@pytest.mark.parametrize("name", SYSTEMS)
def test_motion(name, open_fmu):
    rates, names = REFERENCES[name]
    rates, names, end = rates or derive_rotated(), names.split(), None
    for method in METHODS:
        for steps in (1, 100):
            instance = open_fmu(f"{name}_{method}").initialize()
            if end is None:
                end = solve_ivp(rates, (0, 2), instance.get(*names), rtol=1e-12, atol=1e-13, method="DOP853").y[:, -1]
            instance.run(2.0, 2.0 / steps, names[0])
            np.testing.assert_allclose(instance.get(*names), end, rtol=1e-9, atol=3e-10)
    if name == "Pivot":
        th, w, z = end
        assert instance.get("o") == pytest.approx(1.5 * np.cos(th) * w - th * z + 0.3, rel=1e-8)


# Systems with <work/>, and their total power by hand. Motors carry a spring's end or a pivot, or draw in a rope; or mass leaves.
WORKED = {
    "Carried": (carried, "q v z", lambda t, s: -3 * s[0] * (-s[2] + np.sin(t))),
    "Pivot": (pivot, "th w z", lambda t, s: 2 * (1.5 * (np.cos(s[0]) * pivot(t, s)[1] - np.sin(s[0]) * s[1] ** 2) - s[1] * s[2] - s[0] * pivot(t, s)[2]) * pivot(t, s)[2]),
    "Drawn": (drawn, "x y vx vy z", lambda t, s: 2 * drawn(t, s)[2] / s[0] * s[4] * drawn(t, s)[4]),
    "Burning": (burning, "x v m", lambda t, s: 2 * s[1] - burning(t, s)[2] * s[1] ** 2 / 2),
    "Geared": (geared, "x y v w z", lambda t, s: (geared(t, s)[2] + 8 * (s[0] - s[1])) * s[2]),
    "Hauled": (hauled, "x y vx vy", lambda t, s: 2 * hauled(t, s)[2] / s[0] * (1 + 0.2 * np.sin(t)) * 0.2 * np.cos(t)),
    "Held": (held, "q v z", lambda t, s: 5 * (s[2] - s[0]) * (np.cos(t) - s[2]) - 0.3 * s[1] ** 2),
}  # fmt: skip
SYSTEMS_WITH_WORK = {
    **SYSTEMS,
    # A rope of given length, and a spring whose end a state moves.
    "Hauled": '<coordinate name="x" velocity="vx" start="0.6"/><coordinate name="y" velocity="vy" start="-0.8"/><particle name="b" mass="2" x="x" y="y"/><potential>2*9.81*y</potential>'
    '<constraint name="rod">x^2 + y^2 - (1 + 0.2*sin(time))^2</constraint>',
    "Held": '<coordinate name="q" velocity="v" start="0.3"/><state name="z" start="0.5" rate="cos(time) - z"/><particle mass="2" x="q"/><potential>5*(q - z)^2/2</potential>'
    "<dissipation>0.3*v^2/2</dissipation>",
}  # fmt: skip


@pytest.mark.parametrize("name", WORKED)
def test_work_of_everything(name, open_fmu):
    """The integral of the power by SciPy, and the change of the energy."""
    rates, names, power = WORKED[name]
    names = names.split()
    for method in ("taylor", "radau"):
        for steps in (1, 100):
            instance = open_fmu(f"{name}_{method}_worked").initialize()
            start, energy = instance.get(*names), instance.get("totalEnergy")
            end = solve_ivp(lambda t, s: [*rates(t, s[:-1]), power(t, s[:-1])], (0, 2), [*start, 0], rtol=1e-12, atol=1e-13, method="DOP853").y[:, -1]
            instance.run(2.0, 2.0 / steps, names[0])
            np.testing.assert_allclose(instance.get(*names, "nonConservativeWork"), end, rtol=2e-9, atol=1e-9)
            assert abs(end[-1]) > 0.1
            assert instance.get("totalEnergy") - energy == pytest.approx(end[-1], abs=2e-9)


@pytest.mark.parametrize("content, message", [
    ('<state name="z" rate="v"/><particle name="b" mass="1" x="q + z"/>',
     "the position of 'b' needs the second derivative of the state 'z', whose rate depends on 'v'; expected a rate of coordinates, states and time"),
    ('<state name="z" rate="der(v)"/><particle name="b" mass="1" x="q + z"/>', "the position of 'b' needs the second derivative of the state 'z', whose rate depends on 'der(v)'"),
    ('<input name="u"/><state name="z" rate="u - z"/><particle name="b" mass="1" x="q + z"/>',
     "the position of 'b' needs the second derivative of the state 'z', whose rate depends on 'u'; expected derivatives=\"1\" of this <input>"),
    ('<state name="z" rate="y"/><state name="y" rate="der(v)"/><particle name="b" mass="1" x="q + z"/>',
     "the position of 'b' needs the second derivative of the state 'z', which depends on the rate of 'y', and so on 'der(v)'"),
    ('<state name="z" rate="v"/><constraint name="c">q - z</constraint>', "the constraint 'c' needs the second derivative of the state 'z', whose rate depends on 'v'"),
    ('<state name="z" rate="der(v)"/><constraint name="c">v - z</constraint>', "the constraint 'c' needs the time derivative of the state 'z', whose rate depends on 'der(v)'"),
    ('<state name="z" rate="q"/><kinetic>z*v^2/2</kinetic>', "the kinetic energy needs the time derivative of the state 'z', whose rate depends on 'q'; expected a <particle> or <body>"),
    ('<state name="z" rate="1"/><particle name="b" mass="1" x="q + z"/><work/>', None),
    ('<input name="u" derivatives="1"/><state name="z" rate="u - z"/><particle name="b" mass="1" x="q + z"/>', None),
    ('<state name="z" rate="v"/><particle name="b" mass="0" x="q + z"/><force on="b" x="1"/>', None),
    ('<state name="z" rate="y"/><state name="y" rate="v - y"/><particle name="b" mass="1" x="q + z"/>', None),
    ('<state name="z" rate="v"/><constraint name="c">v - 2*z</constraint>', None),
])  # fmt: skip
def test_missing_derivatives(tmp_path, content, message):
    (tmp_path / "system.xml").write_text(f'<system name="X"><coordinate name="q" velocity="v"/><particle mass="1" x="q"/>{content}</system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "") if message is None else (result.returncode == 1 and message in result.stderr), result.stderr
