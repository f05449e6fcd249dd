"""
Well-known examples of Modelica's standard library, PyDy and exudyn, written by the reference, agree with independent truths.

The truths are closed forms, or motions of minimal coordinates by DOP853, piece by piece between the switches.
"""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import fmu
from building import build_systems
from motions import lagrange_fmu  # noqa: F401

pytestmark = pytest.mark.long

G = 9.81
# Modelica.Mechanics.Rotational.Examples.CoupledClutches: a sine torque, and three clutches that are pressed one after another.
CLUTCHES = """<system name="CoupledClutches{}"><parameter name="fn" start="20" unit="N.m"/><parameter name="mu" start="0.5" unit="1"/><parameter name="peak" start="1.1" unit="1"/>
  <parameter name="T2" start="0.4" unit="s"/><parameter name="T3" start="0.9" unit="s"/><parameter name="J" start="1" unit="kg.m2"/><parameter name="A" start="10" unit="N.m"/>
  <coordinate name="phi1" velocity="w1" unit="rad" velocityStart="10"/>
  <for index="i" from="2" to="4"><coordinate name="phi[i]" velocity="w[i]" unit="rad"/><kinetic>J*w[i]^2/2</kinetic></for>
  <kinetic>J*w1^2/2</kinetic><force coordinate="phi1">A*sin(0.4*pi*time)</force><define name="s" unit="1">max(0, sin(2*pi*time))</define>
  <friction name="clutch1" velocity="w1 - w[2]" force="mu*fn*s" stiction="peak*mu*fn*s"/>
  <friction name="clutch2" velocity="w[2] - w[3]" force="if(time &lt; T2, 0, mu*fn)" stiction="if(time &lt; T2, 0, peak*mu*fn)"/>
  <friction name="clutch3" velocity="w[3] - w[4]" force="if(time &lt; T3, 0, mu*fn)" stiction="if(time &lt; T3, 0, peak*mu*fn)"/>
  <solver method="{}" tolerance="1e-10"/><experiment stopTime="1.5"/></system>"""
# Modelica's LossyGear: the efficiency is 0.8 where the motor drives, and 0.6 where the load does.
GEAR = """<system name="TwoEfficiencies{}"><parameter name="J1" start="1" unit="kg.m2"/><parameter name="J2" start="1.5" unit="kg.m2"/><parameter name="n" start="2" unit="1"/>
  <parameter name="eta1" start="0.8" unit="1"/><parameter name="eta2" start="0.6" unit="1"/><parameter name="A" start="10" unit="N.m"/>
  <coordinate name="a" velocity="wa" unit="rad"/><coordinate name="b" velocity="wb" unit="rad"/><kinetic>J1*wa^2/2 + J2*wb^2/2</kinetic>
  <force coordinate="a">A*sin(10*pi*time)</force><force coordinate="b">-10*A*min(1, time/2)</force><constraint name="teeth" unit="rad">a - n*b</constraint>
  <friction name="loss" coordinate="a" force="max((1/eta1 - 1)*teeth.force, -(1 - eta2)*teeth.force)" forceBack="max((1 - eta2)*teeth.force, -(1/eta1 - 1)*teeth.force)"/>
  <solver method="{}" tolerance="1e-10"/><experiment stopTime="0.5"/></system>"""
# Modelica's MassWithStopAndFriction, at inelastic stops.
STOPS = """<system name="StopsAndFriction{}"><parameter name="Fp" start="1" unit="N.s/m"/><parameter name="Fc" start="5" unit="N"/><parameter name="Fs" start="10" unit="N"/>
  <parameter name="fexp" start="2" unit="s/m"/><parameter name="A" start="25" unit="N"/><coordinate name="s" velocity="v" unit="m"/><particle mass="1" x="s"/>
  <force coordinate="s">A*sin(2*pi*time)</force><friction name="rub" coordinate="s" force="Fp*abs(v) + Fc + Fs*exp(-fexp*abs(v))" stiction="Fc + Fs"/>
  <stop coordinate="s" min="-0.25" max="0.25"/><solver method="{}" tolerance="1e-10"/><experiment stopTime="3"/></system>"""
# A bridge of four ideal diodes is a friction whose force is the voltage behind it.
BRIDGE = """<system name="DiodeBridge{}"><parameter name="U" start="10" unit="V"/><parameter name="L" start="1e-3" unit="H"/><parameter name="Ri" start="0.1" unit="Ohm"/>
  <parameter name="C" start="1e-3" unit="F"/><parameter name="R" start="20" unit="Ohm"/><coordinate name="q" velocity="i" unit="C"/><kinetic>L*i^2/2</kinetic>
  <dissipation>Ri*i^2/2</dissipation><state name="v" unit="V" start="1" nominal="10" rate="(abs(i) - v/R)/C"/><force coordinate="q">U*sin(100*pi*time)</force>
  <friction name="bridge" coordinate="q" force="v"/><solver method="{}" tolerance="1e-10"/><experiment stopTime="0.06"/></system>"""
# A motor on a chopper lifts the torque of its brake after some pulses.
CHOPPER = """<system name="Chopper{}"><parameter name="U" start="100" unit="V"/><parameter name="R" start="0.5" unit="Ohm"/><parameter name="L" start="1e-2" unit="H"/>
  <parameter name="k" start="0.5" unit="N.m/A"/><parameter name="J" start="0.02" unit="kg.m2"/><parameter name="load" start="3" unit="N.m"/><parameter name="T" start="1e-3" unit="s"/>
  <input name="duty" start="0.4" unit="1"/><define name="on" unit="1">if(mod(time, T) &lt; duty*T, 1, 0)</define><coordinate name="phi" velocity="w" unit="rad"/>
  <state name="i" unit="A" rate="(on*U - R*i - k*w)/L"/><kinetic>J*w^2/2</kinetic><force coordinate="phi">k*i</force><friction name="brake" coordinate="phi" force="load"/>
  <solver method="{}" tolerance="1e-10"/><experiment stopTime="0.02"/></system>"""
# A crank at constant speed, a coupler with two spherical joints, and a rocker about an axis at right angles.
FOUR_BAR = """<system name="SpatialFourBar{}"><coordinate name="theta" velocity="omega" unit="rad" velocityStart="4" acceleration="0"/><coordinate name="psi" velocity="wpsi" unit="rad" start="-0.4"/>
  <frame name="crank"><rotate axis="z" angle="theta"/></frame><point name="A" in="crank" x="0.1"/><frame name="pivot"><translate x="0.4" z="0.2"/></frame>
  <frame name="rocker" in="pivot"><rotate axis="y" angle="psi"/></frame><body name="bar" in="rocker" mass="1" z="0.15" Ixx="0.01" Iyy="0.02" Izz="0.01"/>
  <point name="B" in="rocker" z="0.3"/><gravity z="-9.81"/><constraint name="coupler" unit="m">distance(A, B) - 0.5</constraint>
  <output name="pull" unit="N">coupler.force</output><output name="torque" unit="N.m">theta.force</output><solver method="{}" tolerance="1e-10"/><experiment stopTime="2"/></system>"""
# A lever whose bearing has friction by the norm of its force, which a state follows within 0.1 ms.
LEVER = """<system name="LeverInBearing{}"><parameter name="m" start="2" unit="kg"/><parameter name="L" start="1" unit="m"/><parameter name="mu" start="0.3" unit="1"/><parameter name="r" start="0.05" unit="m"/>
  <parameter name="T" start="1e-4" unit="s"/><coordinate name="x" velocity="vx" unit="m" start="L/2"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="phi" velocity="w" unit="rad"/>
  <body name="lever" mass="m" x="x" y="y" inertia="m*L^2/12" angle="phi"/><point name="eye" in="lever" x="-L/2"/><joint name="b" type="pin" from="base" to="eye"/><gravity y="-9.81"/>
  <state name="N" unit="N" start="19.62" nominal="10" rate="(sqrt(b.forceX^2 + b.forceY^2) - N)/T"/><friction name="rub" coordinate="phi" force="mu*r*N"/>
  <solver method="{}" tolerance="1e-10"/><experiment stopTime="3"/></system>"""
# An ellipsoid with a skew inertia tensor rolls on a plane and reverses its spin; its constraints are vectors.
RATTLEBACK = """<system name="Rattleback{}"><parameter name="a" start="0.2" unit="m"/><parameter name="b" start="0.03" unit="m"/><parameter name="c" start="0.02" unit="m"/><parameter name="h" start="0.01" unit="m"/>
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="z" velocity="vz" unit="m" start="0.01"/>
  <coordinate name="yaw" velocity="wyaw" unit="rad" velocityStart="-5" fixed="true"/><coordinate name="pitch" velocity="wpitch" unit="rad" fixed="true"/>
  <coordinate name="roll" velocity="wroll" unit="rad" start="0.0087" fixed="true"/>
  <frame name="stone"><translate x="x" y="y" z="z"/><rotate axis="z" angle="yaw"/><rotate axis="x" angle="roll"/><rotate axis="y" angle="pitch"/></frame>
  <body name="celt" in="stone" mass="1" Ixx="2e-4" Iyy="1.6e-3" Izz="1.7e-3" Ixy="-2e-5"/>
  <define name="n1" unit="1">stone.R31</define><define name="n2" unit="1">stone.R32</define><define name="n3" unit="1">stone.R33</define><define name="s" unit="m">sqrt((a*n1)^2 + (b*n2)^2 + (c*n3)^2)</define>
  <define name="r1" unit="m">-a^2*n1/s</define><define name="r2" unit="m">-b^2*n2/s</define><define name="r3" unit="m">h - c^2*n3/s</define>
  <constraint name="height" unit="m">z + h*n3 - s</constraint>
  <constraint name="rollX" unit="m/s">dot(celt.v + cross(celt.omega, r1*stone.axisX + r2*stone.axisY + r3*stone.axisZ), base.axisX)</constraint>
  <constraint name="rollY" unit="m/s">dot(celt.v + cross(celt.omega, r1*stone.axisX + r2*stone.axisY + r3*stone.axisZ), base.axisY)</constraint>
  <gravity z="-9.81"/><output name="n" unit="1">n1</output><output name="spin" unit="rad/s">celt.omegaZ</output><solver method="{}" tolerance="1e-11"/><experiment stopTime="2"/></system>"""
SYSTEMS = {"CoupledClutches": CLUTCHES, "TwoEfficiencies": GEAR, "StopsAndFriction": STOPS, "DiodeBridge": BRIDGE, "Chopper": CHOPPER, "SpatialFourBar": FOUR_BAR, "LeverInBearing": LEVER, "Rattleback": RATTLEBACK}
METHODS = ["auto", "radau"]


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {f"{name}{method}": text.format(method, method) for name, text in SYSTEMS.items() for method in METHODS}
    build_systems("well-known", texts)


def switched(mode_at, state, stop, names):
    """
    Integrate from mode to mode, and return a function of times with the values of the states by name.

    mode_at(t, x) returns the right-hand side, functions of t and x that fall through 0 where the mode ends, and the state from which it starts.
    """
    pieces, time = [], 0.0
    while time < stop - 1e-12:
        slope, ends, state = mode_at(time, np.array(state))
        for end in ends:
            end.terminal, end.direction = True, -1
        found = solve_ivp(slope, (time, stop), state, "DOP853", events=ends, dense_output=True, rtol=1e-12, atol=1e-13, max_step=stop / 100)
        pieces.append((time, found.sol))
        time, state = found.t[-1], found.y[:, -1]

    def values(times):
        last = [max(i for i, (begin, _) in enumerate(pieces) if begin <= t) for t in times]
        return dict(zip(names, np.array([pieces[i][1](t) for i, t in zip(last, times)]).T))

    return values


def later(end, begin, sign=1.0, margin=1e-9):
    """Return an event function that is 0 at the start. It is shifted there, so that this zero is not found again."""
    return lambda t, x: sign * end(t, x) + (margin if t < begin + 1e-6 else 0.0)


def clutches():
    """At rest each clutch sticks or slides, consistent with its limits and the accelerations of the others; all combinations are tried."""
    relative = np.eye(4)[:3] - np.eye(4)[1:]

    def limits(t):
        return np.array([10 * max(0, np.sin(2 * np.pi * t)), 10 * (t >= 0.4), 10 * (t >= 0.9)])

    def solved(t, mode):
        forces, torque = limits(t) * mode, np.array([10 * np.sin(0.4 * np.pi * t), 0, 0, 0])
        stuck = relative[mode == 0]
        if len(stuck):
            forces[mode == 0] = np.linalg.solve(stuck @ stuck.T, stuck @ (torque - relative.T @ forces))
        return torque - relative.T @ forces, forces

    def fits(t, mode, free):
        rates, forces = solved(t, mode)
        return all(abs(forces[i]) <= 1.1 * limits(t)[i] if mode[i] == 0 else (relative @ rates)[i] * mode[i] > 0 for i in free)

    def mode_at(t, x):
        after, speeds = t + 1e-9, relative @ x[4:]
        active = limits(after) > 0
        free = [i for i in range(3) if abs(speeds[i]) < 1e-9 and active[i]]
        modes = []
        for choice in itertools.product((0, 1, -1), repeat=len(free)):
            mode = np.where(np.abs(speeds) < 1e-9, 1.0, np.sign(speeds))
            mode[free] = choice
            modes += [mode] if fits(after, mode, free) else []
        mode = modes[0]
        ends = [later(lambda t, x, i=i: mode[i] * (relative[i] @ x[4:]), t, margin=1e-13) if mode[i] else lambda t, x, i=i: 1.1 * limits(t)[i] - abs(solved(t, mode)[1][i]) for i in range(3) if active[i]]
        ends += [lambda t, x, at=at: at - t for at in (0.4, 0.5, 0.9, 1.0) if at > after]
        return lambda t, x: [*x[4:], *solved(t, mode)[0]], ends, x

    return switched(mode_at, [0, 0, 0, 0, 10, 0, 0, 0], 1.5, ["phi1", "phi[2]", "phi[3]", "phi[4]", "w1", "w[2]", "w[3]", "w[4]"])


def gear():
    """With the force T of the teeth, J1 n b'' = tau - T - sign(b') k T and J2 b'' = n T - load, where k is the loss that is not negative."""
    torque, load = lambda t: 10 * np.sin(10 * np.pi * t), lambda t: 50 * t
    loss = {1: (0.25, -0.4), -1: (0.4, -0.25)}

    def rate(t, way):
        forces = [(torque(t) + 2 * load(t) / 1.5) / (1 + way * k + 4 / 1.5) for k in loss[way]]
        return next((2 * T - load(t)) / 1.5 for k, T in zip(loss[way], forces) if k * T >= -1e-14)

    def reserve(t, way):
        teeth = load(t) / 2
        return max(k * teeth for k in loss[way]) - way * (torque(t) - teeth)

    def mode_at(t, x):
        ways = [np.sign(x[1])] if abs(x[1]) > 1e-9 else [way for way in (1, -1) if reserve(t + 1e-9, way) < 0]
        if not ways:
            return lambda t, x: [0, 0], [lambda t, x, way=way: reserve(t, way) for way in (1, -1)], np.array([x[0], 0])
        way = int(ways[0])
        return lambda t, x: [x[1], rate(t, way)], [later(lambda t, x: way * x[1], t)], x

    return switched(mode_at, [0, 0], 0.5, ["b", "wb"])


def stops():
    force = lambda t: 25 * np.sin(2 * np.pi * t)  # noqa: E731

    def mode_at(t, x):
        at_rest = abs(x[1]) < 1e-10 or abs(x[0]) > 0.25 - 1e-12 and x[0] * x[1] > 0
        way = np.sign(force(t + 1e-9)) if at_rest else np.sign(x[1])
        x = np.array([np.clip(x[0], -0.25, 0.25), 0.0 if at_rest else x[1]])
        if at_rest and abs(force(t + 1e-9)) <= 15:
            return lambda t, x: [0, 0], [lambda t, x: 15 - abs(force(t))], x
        if at_rest and way * x[0] > 0.25 - 1e-12:  # pressed against the stop
            return lambda t, x: [0, 0], [lambda t, x: abs(force(t)) - 15], x
        slope = lambda t, x: [x[1], force(t) - way * (way * x[1] + 5 + 10 * np.exp(-2 * way * x[1]))]  # noqa: E731
        return slope, [later(lambda t, x: way * x[1], t), lambda t, x: 0.25 - way * x[0]], x

    return switched(mode_at, [0, 0], 3, ["s", "v"])


def bridge():
    voltage = lambda t: 10 * np.sin(100 * np.pi * t)  # noqa: E731

    def mode_at(t, x):
        way = np.sign(x[1]) if abs(x[1]) > 1e-9 else np.sign(voltage(t + 1e-9)) * (abs(voltage(t + 1e-9)) > x[2])
        if way == 0:
            return lambda t, x: [0, 0, -50 * x[2]], [lambda t, x: x[2] - abs(voltage(t))], np.array([x[0], 0, x[2]])
        slope = lambda t, x: [x[1], 1e3 * (voltage(t) - way * x[2] - 0.1 * x[1]), 1e3 * (way * x[1] - x[2] / 20)]  # noqa: E731
        return slope, [later(lambda t, x: way * x[1], t, margin=1e-7)], x

    return switched(mode_at, [0, 0, 1], 0.06, ["q", "i", "v"])


def chopper(times):
    """Exponentials of the matrices of (phi, w, i, on, 1) in each half of a pulse; it starts where k i is the torque of the brake."""
    moving = np.array([[0, 1, 0, 0, 0], [0, 0, 25, 0, -150], [0, -50, -50, 1e4, 0], [0] * 5, [0] * 5], dtype=float)
    held = np.where(np.arange(5)[:, None] == 2, moving, 0)
    x, pieces, rates = np.array([0, 0, 0, 1.0, 1.0]), [], held
    for i in range(40):
        begin, end = i // 2 * 1e-3 + i % 2 * 4e-4, i // 2 * 1e-3 + (1e-3 if i % 2 else 4e-4)
        x[3] = 1 - i % 2
        if rates is held and (expm(held * (end - begin)) @ x)[2] > 6:
            started = brentq(lambda s: (expm(held * s) @ x)[2] - 6, 0, end - begin, xtol=1e-16)
            pieces.append((begin, held, x))
            begin, x, rates = begin + started, expm(held * started) @ x, moving
        pieces.append((begin, rates, x.copy()))
        x = expm(rates * (end - begin)) @ x
        assert x[1] >= 0  # it does not stop again
    last = [max(i for i, piece in enumerate(pieces) if piece[0] <= t + 1e-15) for t in times]
    found = np.array([expm(pieces[i][1] * (t - pieces[i][0])) @ pieces[i][2] for i, t in zip(last, times)])
    return {"phi": found[:, 0], "w": found[:, 1], "i": found[:, 2]}


def four_bar(times):
    """The angle from |B - A| = 0.5 m, its derivatives from those of this equation, and the forces from the balance of the rocker and of the crank."""
    found = {name: [] for name in ("psi", "wpsi", "pull", "torque")}
    psi = -0.45
    for t in times:
        crank = np.array([np.cos(4 * t), np.sin(4 * t), 0]) * 0.1
        end = lambda p: np.array([0.4 + 0.3 * np.sin(p), 0, 0.2 + 0.3 * np.cos(p)])  # noqa: E731
        psi = brentq(lambda p: np.linalg.norm(end(p) - crank) - 0.5, psi - 0.3, psi + 0.3, xtol=1e-15)
        along, by_psi, by_theta = end(psi) - crank, 0.3 * np.array([np.cos(psi), 0, -np.sin(psi)]), 0.1 * np.array([-np.sin(4 * t), np.cos(4 * t), 0])
        rate = 4 * (along @ by_theta) / (along @ by_psi)
        apart = by_psi * rate - 4 * by_theta
        bend = -0.3 * np.array([np.sin(psi), 0, np.cos(psi)]) * rate**2 + 16 * crank
        acceleration = -(along @ bend + apart @ apart) / (along @ by_psi)
        pull = (G * 0.15 * np.sin(psi) - (0.02 + 0.15**2) * acceleration) / (by_psi @ along / 0.5)
        for name, value in zip(found, (psi, rate, pull, -pull * (along @ by_theta) / 0.5)):
            found[name].append(value)
    return found


def lever():
    """J phi'' = -m g L/2 cos(phi) - sign(w) mu r |F|, where the force F of the bearing holds the centre of mass."""

    def rate(phi, w, way):
        force = lambda a: 2 * np.hypot(-0.5 * (w * w * np.cos(phi) + a * np.sin(phi)), 0.5 * (a * np.cos(phi) - w * w * np.sin(phi)) + G)  # noqa: E731
        return brentq(lambda a: 2 / 3 * a + G * np.cos(phi) + way * 0.015 * force(a), -100, 100, xtol=1e-13)

    def mode_at(t, x):
        way = np.sign(x[1]) if abs(x[1]) > 1e-9 else -np.sign(np.cos(x[0]))
        return lambda t, x: [x[1], rate(*x, way)], [later(lambda t, x: way * x[1], t)], x

    return switched(mode_at, [0, 0], 3, ["phi", "w"])


def rattleback():
    """Newton and Euler along the axes of the stone: the vertical n and the angular velocity w, with the velocity -w x r of the centre of mass."""
    inertia = np.array([[2e-4, -2e-5, 0], [-2e-5, 1.6e-3, 0], [0, 0, 1.7e-3]])
    squares, offset = np.array([0.2, 0.03, 0.02]) ** 2, np.array([0, 0, 0.01])

    def slope(t, x):
        n, w = x[:3], x[3:]
        turning, s = np.cross(n, w), np.sqrt(squares @ n**2)
        r = offset - squares * n / s
        moving = -squares * (turning / s - n * (squares @ (n * turning)) / s**3)
        rest = -np.cross(w, moving) - np.cross(w, np.cross(w, r)) + G * n
        cross = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
        return [*turning, *np.linalg.solve(inertia - cross @ cross, np.cross(r, rest) - np.cross(w, inertia @ w))]

    vertical = np.array([0, np.sin(0.0087), np.cos(0.0087)])
    return switched(lambda t, x: (slope, [], x), [*vertical, *(-5 * vertical)], 2, ["n", "n2", "n3", "w1", "w2", "spin"])


TRUTHS = {"CoupledClutches": (clutches, 1e-8), "TwoEfficiencies": (gear, 1e-8), "StopsAndFriction": (stops, 1e-8), "DiodeBridge": (bridge, 1e-8), "Chopper": (lambda: chopper, 1e-10),
          "SpatialFourBar": (lambda: four_bar, 1e-9), "LeverInBearing": (lever, 3e-4), "Rattleback": (rattleback, 1e-6)}  # fmt: skip


@pytest.mark.parametrize("name", SYSTEMS)
def test_motions(name, lagrange_fmu):  # noqa: F811
    truth, allowed = TRUTHS[name]
    expected = None
    for method in METHODS:
        motion = lagrange_fmu.simulate(fmu.archive(f"{name}{method}"), record_events=False)
        expected = truth()(motion["time"]) if expected is None else expected
        for variable, values in expected.items():
            if variable in motion.dtype.names:
                np.testing.assert_allclose(motion[variable], values, rtol=0, atol=allowed * np.max(np.abs(values)), err_msg=f"{variable} by {method}")
