"""
Standard examples of others, written as a new user would. They include Modelica's ElastoGap, ControlledTemperature, three tanks and a cascaded servo,
and a FIR filter. PyDy's chaos pendulum and pendula on a cart, and exudyn's bungee jump are others. Closed forms and SciPy have the motions.
"""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import expm
from scipy.special import ndtri

from fmu import Instance, build_systems

pytestmark = pytest.mark.long

SYSTEMS = {
    "ElastoGap": """<system name="{name}">
  <parameter name="m" start="1" unit="kg" min="0"/><parameter name="c" start="10" unit="N/m"/><parameter name="d" start="1.5" unit="N.s/m"/><parameter name="gap" start="1" unit="m"/>
  <coordinate name="s" velocity="v" unit="m" start="2" velocityStart="-2"/>
  <particle mass="m" x="s"/>
  <define name="way" unit="m">gap - s</define>
  <output name="F" unit="N">if(way > 0, max(0, c*way - d*v), 0)</output>
  <force coordinate="s">F</force>
  <state name="impulse" unit="N.s" rate="F"/>
  <solver method="{method}"/><experiment stopTime="4" stepSize="0.05"/></system>""",
    "ControlledTemperature": """<system name="{name}">
  <parameter name="C" start="1" unit="J/K" min="0"/><parameter name="G" start="0.1" unit="W/K"/><parameter name="TAmb" start="298.15" unit="K"/><parameter name="P" start="12.1" unit="W"/>
  <parameter name="TRef" start="320" unit="K"/><parameter name="band" start="4" unit="K"/>
  <state name="T" unit="K" displayUnit="degC" start="TAmb" nominal="300" rate="(if(on, P, 0) - G*(T - TAmb))/C"/>
  <mode name="on" start="1"/><mode name="switchings"/>
  <event when="T - TRef - band/2" direction="rising"><set mode="on">0</set><set mode="switchings">switchings + 1</set></event>
  <event when="T - TRef + band/2"><set mode="on">1</set><set mode="switchings">switchings + 1</set></event>
  <state name="energy" unit="J" nominal="100" rate="if(on, P, 0)"/>
  <solver method="{method}"/><experiment stopTime="30" stepSize="0.1"/></system>""",
    "ThreeTanks": """<system name="{name}">
  <parameter name="A" start="1" unit="m2"/><parameter name="k" start="0.05" unit="m2.5/s"/>
  <function name="flow" arguments="dh" unit="m3/s">if(dh > 0, k*sqrt(dh), -k*sqrt(-dh))</function>
  <constant name="start" values="8 3 3" unit="m"/>
  <define name="q12" unit="m3/s">flow(h[1] - h[2])</define><define name="q23" unit="m3/s">flow(h[2] - h[3])</define>
  <state name="h[1]" unit="m" start="start[1]" rate="-q12/A"/>
  <state name="h[2]" unit="m" start="start[2]" rate="(q12 - q23)/A"/>
  <state name="h[3]" unit="m" start="start[3]" rate="q23/A"/>
  <output name="volume" unit="m3">A*sum(i, 1, 3, h[i])</output>
  <solver method="{method}"/><experiment stopTime="40" stepSize="1"/></system>""",
    "ServoCascade": """<system name="{name}">
  <parameter name="R" start="0.5" unit="Ohm"/><parameter name="L" start="0.01" unit="H"/><parameter name="km" start="0.1" unit="N.m/A"/><parameter name="J" start="0.002" unit="kg.m2" min="0"/>
  <parameter name="limit" start="24" unit="V"/><parameter name="kpI" start="5" unit="V/A"/><parameter name="TnI" start="0.02" unit="s"/><parameter name="kpW" start="1" unit="A.s/rad"/><parameter name="TnW" start="0.2" unit="s"/>
  <input name="wRef" unit="rad/s" start="100"/><input name="load" unit="N.m"/>
  <coordinate name="phi" velocity="w" unit="rad"/>
  <kinetic>J*w^2/2</kinetic><force coordinate="phi">km*i - load</force>
  <output name="iRef" unit="A">min(30, max(-30, kpW*(wRef - w + xW/TnW)))</output>
  <define name="uWanted" unit="V">kpI*(iRef - i + xI/TnI) + km*w</define>
  <output name="u" unit="V">min(limit, max(-limit, uWanted))</output>
  <state name="i" unit="A" rate="(u - R*i - km*w)/L"/>
  <state name="xI" unit="A.s" rate="if(abs(uWanted) > limit, 0, iRef - i)"/>
  <state name="xW" unit="rad" rate="if(abs(iRef) > 29.99 , 0, wRef - w)"/>
  <preset name="reversal" description="Start backwards"><at name="w" value="-100"/></preset>
  <solver method="{method}"/><experiment stopTime="1" stepSize="0.01"/></system>""",
    "Fir": """<system name="{name}">
  <parameter name="Ts" start="0.05" unit="s" min="0"/>
  <constant name="b" values="0.1 0.2 0.4 0.2 0.1"/>
  <input name="u" start="0"/>
  <for index="i" from="1" to="5"><mode name="d[i]"/></for>
  <mode name="y"/>
  <state name="filtered" rate="(signal - filtered)/0.1"/>
  <define name="signal">sin(3*time) + u</define>
  <sample every="Ts">
    <set mode="d[1]">signal</set>
    <set mode="d[2]">d[1]</set><set mode="d[3]">d[2]</set><set mode="d[4]">d[3]</set><set mode="d[5]">d[4]</set>
    <set mode="y">b[1]*signal + sum(i, 2, 5, b[i]*d[i-1])</set>
  </sample>
  <output name="error">y - filtered</output>
  <solver method="{method}"/><experiment stopTime="2" stepSize="0.05"/></system>""",
    "ChaosPendulum": """<system name="{name}">
  <parameter name="mA" start="0.01" unit="kg" min="0"/><parameter name="mB" start="0.1" unit="kg" min="0"/><parameter name="lA" start="0.0375" unit="m"/><parameter name="lB" start="0.1374" unit="m"/>
  <parameter name="h" start="0.1" unit="m"/><parameter name="w" start="0.2" unit="m"/><parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="IAxx" value="mA*(2*lA)^2/12" unit="kg.m2"/>
  <parameter name="IBxx" value="mB*h^2/12" unit="kg.m2"/><parameter name="IByy" value="mB*(w^2 + h^2)/12" unit="kg.m2"/><parameter name="IBzz" value="mB*w^2/12" unit="kg.m2"/>
  <coordinate name="theta" velocity="omega" unit="rad" start="1.5707963267948966"/><coordinate name="phi" velocity="alpha" unit="rad" start="0.00872664625997165"/>
  <gravity z="-g"/>
  <frame name="rodFrame"><rotate axis="x" angle="theta"/></frame>
  <frame name="plateFrame" in="rodFrame"><translate z="-lB"/><rotate axis="z" angle="phi"/></frame>
  <body name="rod" in="rodFrame" mass="mA" z="-lA" Ixx="IAxx" Iyy="IAxx"/>
  <body name="plate" in="plateFrame" mass="mB" Ixx="IBxx" Iyy="IByy" Izz="IBzz"/>
  <solver method="{method}" tolerance="1e-11"/><experiment stopTime="2" stepSize="0.02"/></system>""",
    "Bungee": """<system name="{name}">
  <parameter name="m" start="80" unit="kg" min="0"/><parameter name="L" start="20" unit="m"/><parameter name="k" start="120" unit="N/m"/><parameter name="d" start="15" unit="N.s/m"/><parameter name="cw" start="0.4" unit="kg/m"/><parameter name="g" start="9.81" unit="m/s2"/>
  <coordinate name="z" velocity="v" unit="m" description="way down"/>
  <particle mass="m" y="-z"/><gravity y="-g"/>
  <define name="stretch" unit="m">max(0, z - L)</define>
  <potential>k*stretch^2/2</potential>
  <force coordinate="z">-cw*v*abs(v) - if(z > L, d*v, 0)</force>
  <work/>
  <mode name="deepest" unit="m"/>
  <event when="v"><set mode="deepest">max(deepest, z)</set></event>
  <solver method="{method}"/><experiment stopTime="20" stepSize="0.1"/></system>""",
    "Radiation": """<system name="{name}">
  <parameter name="C" start="500" unit="J/K" min="0"/><parameter name="sigmaA" start="5.67e-8" unit="W/K4"/><parameter name="T0" start="1000" unit="K"/>
  <state name="T" unit="K" start="T0" nominal="300" rate="-sigmaA*T^4/C"/>
  <state name="Q" unit="J" nominal="1e5" rate="sigmaA*T^4"/>
  <solver method="{method}"/><experiment stopTime="60" stepSize="1"/></system>""",
    "QuarterCar": """<system name="{name}">
  <parameter name="ms" start="300" unit="kg" min="0"/><parameter name="mu" start="40" unit="kg" min="0"/><parameter name="ks" start="2e4" unit="N/m"/><parameter name="kt" start="1.8e5" unit="N/m"/><parameter name="cs" start="1200" unit="N.s/m"/><parameter name="V" start="10" unit="m/s"/>
  <table name="road" unit="m" argumentUnit="m" extrapolation="constant" interpolation="spline">
    0 0
    5 0
    6 0.05
    7 0.08
    8 0.05
    9 0
    14 0
  </table>
  <coordinate name="zs" velocity="vs" unit="m"/><coordinate name="zu" velocity="vu" unit="m"/>
  <particle mass="ms" y="zs"/><particle mass="mu" y="zu"/>
  <potential>ks*(zs - zu)^2/2 + kt*(zu - road(V*time))^2/2</potential>
  <dissipation>cs*(vs - vu)^2/2</dissipation>
  <output name="a" unit="m/s2">der(vs)</output>
  <state name="discomfort" unit="m2/s3" rate="a^2"/>
  <output name="rms" unit="m/s2">sqrt(discomfort/max(time, 1e-9))</output>
  <task name="smooth" description="keep it smooth"><goal max="100">discomfort</goal></task>
  <solver method="{method}"/><experiment stopTime="2" stepSize="0.02"/></system>""",
    "PendulaOnCart": """<system name="{name}">
  <constant name="n" value="3"/>
  <parameter name="l" values="0.3 0.4 0.5" unit="m" min="0"/><parameter name="m" values="0.2 0.3 0.1" unit="kg" min="0"/><parameter name="M" start="1" unit="kg" min="0"/><parameter name="g" start="9.81" unit="m/s2"/>
  <input name="F" unit="N" start="1"/>
  <coordinate name="x" velocity="v" unit="m"/>
  <for index="i" from="1" to="n">
    <coordinate name="q[i]" velocity="w[i]" unit="rad" start="0.3*i"/>
    <particle name="bob[i]" mass="m[i]" x="x + sum(j, 1, i, l[j]*sin(q[j]))" y="-sum(j, 1, i, l[j]*cos(q[j]))"/>
    <potential>m[i]*g*bob[i].y</potential>
  </for>
  <particle mass="M" x="x"/>
  <force coordinate="x">F</force>
  <solver method="{method}" tolerance="1e-11"/><experiment stopTime="2" stepSize="0.02"/></system>""",
    "NoisyMass": """<system name="{name}">
  <parameter name="m" start="1" unit="kg" min="0"/><parameter name="k" start="4" unit="N/m"/><parameter name="strength" start="2" unit="N"/><parameter name="seed" type="Integer" start="42"/>
  <coordinate name="x" velocity="v" unit="m"/><particle mass="m" x="x"/><potential>k*x^2/2</potential>
  <mode name="noise"/>
  <sample every="0.1"><set mode="noise">gauss(seed, round(time/0.1))</set></sample>
  <force coordinate="x">strength*noise</force>
  <solver method="{method}"/><experiment stopTime="2" stepSize="0.1"/></system>""",
    "LoadedBeam": """<system name="{name}">
  <parameter name="L" start="10" unit="m" min="0"/><parameter name="EI" start="2e5" unit="N.m2"/><parameter name="rho" start="20" unit="kg/m"/><parameter name="P" start="500" unit="N"/><parameter name="V" start="4" unit="m/s"/>
  <for index="k" from="1" to="3"><coordinate name="a[k]" velocity="b[k]" unit="m"/></for>
  <function name="w" arguments="s" unit="m">sum(k, 1, 3, a[k]*sin(k*pi*s/L))</function>
  <function name="curvature" arguments="s" unit="1/m">diff(diff(w(s), s), s)</function>
  <kinetic>integral(s, 0, L, rho*der(w(s))^2/2)</kinetic>
  <potential>integral(s, 0, L, EI*curvature(s)^2/2) - P*w(V*time)</potential>
  <output name="middle" unit="m">w(L/2)</output>
  <solver method="{method}"/><experiment stopTime="2.5" stepSize="0.05"/></system>""",
}
METHODS = ["taylor", "radau", "bdf"]


def name_of(system, method):
    return f"{system}By{method.title()}"


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name_of(system, method): text.replace("{name}", name_of(system, method)).replace("{method}", method) for system, text in SYSTEMS.items() for method in METHODS}
    build_systems("standard-examples", texts)


def integrated(slope, start, times, method="DOP853", atol=1e-13, **words):
    return solve_ivp(slope, (0, times[-1]), start, method, times, rtol=1e-12, atol=atol, **words).y


def elasto_gap(t):
    def force(s, v):
        return max(0, 10 * (1 - s) - 1.5 * v) if s < 1 else 0.0

    s, _, impulse = integrated(lambda t, y: [y[1], force(*y[:2]), force(*y[:2])], [2, -2, 0], t, max_step=1e-3)
    return {"s": s, "impulse": impulse}


def controlled_temperature(t):
    """Closed form: exponentials from switching to switching."""
    steady, first, begin, on, heated = np.array([298.15, 419.15]), 298.15, 0.0, 1, 0.0
    values, energy = np.empty_like(t), np.empty_like(t)
    while begin < t[-1]:
        goal = 322 if on else 318
        end = begin - 10 * np.log((goal - steady[on]) / (first - steady[on]))
        inside = (t >= begin) & (t <= end)
        values[inside] = steady[on] + (first - steady[on]) * np.exp(-0.1 * (t[inside] - begin))
        energy[inside] = heated + on * 12.1 * (t[inside] - begin)
        heated, begin, first, on = heated + on * 12.1 * (end - begin), end, goal, 1 - on
    return {"T": values, "energy": energy}


def three_tanks(t):
    def flow(d):
        return 0.05 * np.sign(d) * np.sqrt(abs(d))

    h = integrated(lambda t, h: [-flow(h[0] - h[1]), flow(h[0] - h[1]) - flow(h[1] - h[2]), flow(h[1] - h[2])], [8, 3, 3], t, max_step=0.02)
    return {f"h[{i + 1}]": h[i] for i in range(3)} | {"volume": 14.0 + 0 * t}


def servo_cascade(t):
    def slope(t, y):
        _, w, i, integral, speed = y
        wanted = min(30, max(-30, 100 - w + speed / 0.2))
        u = 5 * (wanted - i + integral / 0.02) + 0.1 * w
        return [w, 0.1 * i / 0.002, (min(24, max(-24, u)) - 0.5 * i - 0.1 * w) / 0.01, 0 if abs(u) > 24 else wanted - i, 0 if abs(wanted) > 29.99 else 100 - w]

    y = integrated(slope, [0] * 5, t, "RK45", 1e-9, max_step=1e-4)
    return {"w": y[1], "i": y[2]}


def fir(t):
    y = np.convolve(np.sin(3 * 0.05 * np.arange(len(t))), [0.1, 0.2, 0.4, 0.2, 0.1])[: len(t)]
    return {"y": y, "error": y - integrated(lambda t, x: [(np.sin(3 * t) - x[0]) / 0.1], [0], t)[0]}


def chaos_pendulum(t):
    Ix, Iy, Iz = 0.1 * 0.01 / 12, 0.1 * (0.04 + 0.01) / 12, 0.1 * 0.04 / 12
    fixed, moment = 0.01 * 0.075**2 / 12 + 0.01 * 0.0375**2 + 0.1 * 0.1374**2, (0.01 * 0.0375 + 0.1 * 0.1374) * 9.81

    def slope(t, y):
        theta, phi, omega, alpha = y
        turn = 2 * (Iy - Ix) * np.sin(phi) * np.cos(phi)
        return [omega, alpha, (-moment * np.sin(theta) - turn * omega * alpha) / (fixed + Ix * np.cos(phi) ** 2 + Iy * np.sin(phi) ** 2), turn * omega**2 / 2 / Iz]

    y = integrated(slope, [1.5707963267948966, 0.00872664625997165, 0, 0], t)
    return {"theta": y[0], "phi": y[1]}


def bungee(t):
    z, v = integrated(lambda t, y: [y[1], 9.81 - (0.4 * y[1] * abs(y[1]) + (120 * (y[0] - 20) + 15 * y[1] if y[0] > 20 else 0)) / 80], [0, 0], t, max_step=2e-3)
    return {"z": z, "v": v}


def radiation(t):
    """Closed form: T^-3 grows in proportion to time."""
    T = (1000.0**-3 + 3 * 5.67e-8 / 500 * t) ** (-1 / 3)
    return {"T": T, "Q": 500 * (1000 - T)}


def quarter_car(t):
    road = CubicSpline([0, 5, 6, 7, 8, 9, 14], [0, 0, 0.05, 0.08, 0.05, 0, 0])

    def slope(t, y):
        spring = 2e4 * (y[0] - y[1]) + 1200 * (y[2] - y[3])
        return [y[2], y[3], -spring / 300, (spring - 1.8e5 * (y[1] - (float(road(10 * t)) if t < 1.4 else 0))) / 40, (spring / 300) ** 2]

    y = integrated(slope, [0] * 5, t, max_step=2e-3)
    return {"zs": y[0], "discomfort": y[4]}


def pendula_on_cart(t):
    length, m = np.array([0.3, 0.4, 0.5]), np.array([0.2, 0.3, 0.1])
    carried = np.cumsum(m[::-1])[::-1]
    shared = carried[np.maximum.outer(range(3), range(3))] * np.outer(length, length)

    def slope(t, y):
        q, v, w = y[1:4], y[4], y[5:]
        coupling, turn = carried * length * np.cos(q), np.subtract.outer(q, q)
        M = np.block([[np.array([[1 + m.sum()]]), coupling[None]], [coupling[:, None], shared * np.cos(turn)]])
        Q = [1 + (carried * length * np.sin(q) * w**2).sum(), *(-carried * 9.81 * length * np.sin(q) - (shared * np.sin(turn)) @ w**2)]
        return [v, *w, *np.linalg.solve(M, Q)]

    y = integrated(slope, [0, 0.3, 0.6, 0.9, 0, 0, 0, 0], t)
    return {"x": y[0], "q[3]": y[3]}


def philox(k, seed, domain):
    """Philox4x32-10 by the reference of the language: the first two output words, as a number of 64 bits."""
    c, key = [k & 0xFFFFFFFF, k >> 32, domain, 0], [seed & 0xFFFFFFFF, seed >> 32]
    for _ in range(10):
        low, high = 0xD2511F53 * c[0], 0xCD9E8D57 * c[2]
        c = [high >> 32 ^ c[1] ^ key[0], high & 0xFFFFFFFF, low >> 32 ^ c[3] ^ key[1], low & 0xFFFFFFFF]
        key = [(key[0] + 0x9E3779B9) & 0xFFFFFFFF, (key[1] + 0xBB67AE85) & 0xFFFFFFFF]
    return c[0] << 32 | c[1]


def noisy_mass(t):
    """Closed form between the samples, with the noise of an independent implementation of the generator."""
    state, found, step = np.zeros(2), [np.zeros(2)], expm(np.array([[0, 0.1], [-0.4, 0]]))
    for k in range(len(t) - 1):
        rest = np.array([2 * ndtri(((philox(k, 42, 1) >> 12) + 0.5) * 2.0**-52) / 4, 0])
        state = rest + step @ (state - rest)
        found.append(state)
    return dict(zip(("x", "v"), np.array(found).T))


def loaded_beam(t):
    """Closed form: oscillators under sin(W t)."""
    found = []
    for k in (1, 2, 3):
        own, W = (k * np.pi / 10) ** 2 * np.sqrt(2e5 / 20), k * np.pi * 4 / 10
        found.append(2 * 500 / 200 / (own**2 - W**2) * (np.sin(W * t) - W / own * np.sin(own * t)))
    return {"a[1]": found[0], "a[3]": found[2], "middle": found[0] - found[2]}


MOTIONS = [elasto_gap, controlled_temperature, three_tanks, servo_cascade, fir, chaos_pendulum, bungee, radiation, quarter_car, pendula_on_cart, noisy_mass, loaded_beam]
LARGEST_ERRORS = {"taylor": 3e-7, "radau": 3e-7, "bdf": 2e-5}  # relative; that of SciPy at the limits of the servo, and of BDF for the third sine of the beam


@pytest.mark.parametrize("motion", MOTIONS)
def test_motion(motion):
    system = motion.__name__.title().replace("_", "")
    stop, step = (float(value) for value in re.search(r'stopTime="(\S+)" stepSize="(\S+)"', SYSTEMS[system]).groups())
    times = np.arange(round(stop / step) + 1) * step
    expected = motion(times)
    for method in METHODS:
        instance = Instance(name_of(system, method)).initialize()
        found = np.array(instance.run(stop, step, *expected)).T[1:]
        instance.free()
        for name, values, exact in zip(expected, found, expected.values()):
            assert abs(values - exact).max() <= LARGEST_ERRORS[method] * abs(exact).max(), (method, name)
