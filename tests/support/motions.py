"""Systems whose motions have closed forms, for tests of sensitivities; and the package lagrange_fmu."""

import contextlib
import importlib
import itertools
import sys

import mpmath
import numpy as np
import pytest

import package

OSCILLATOR = """<system name="Oscillator"><!-- kept -->
  <parameter name="m" start="2" unit="kg" min="0"/><parameter name="k" start="50" unit="N/m" min="0"/><parameter name="d" start="1" unit="N.s/m" min="0"/>
  <input name="F" unit="N"/><coordinate name="x" velocity="v" unit="m" start="0.3"/>
  <particle mass="m" x="x"/><potential>k*x^2/2</potential><dissipation>d*v^2/2</dissipation><force coordinate="x">F</force>
  <experiment stopTime="4"/></system>"""
WORKED = OSCILLATOR.replace('name="Oscillator"', 'name="Worked"').replace("<experiment", "<work/><experiment")
# So stiff that explicit steps would be limited to about 5 us.
STIFF = OSCILLATOR.replace('name="Oscillator"', 'name="Stiff"').replace('name="d" start="1"', 'name="d" start="1e6"')
BALL = """<system name="Ball"><parameter name="g" start="9.81" unit="m/s2"/><coordinate name="h" velocity="v" unit="m" start="1"/>
  <parameter name="e" start="0.5" unit="1" min="0" max="1"/>
  <particle mass="1" y="h"/><gravity y="-g"/><contact name="floor" gap="h" unit="m" restitution="e"/></system>"""
# A block on a belt, with stick-slip.
BELT = """<system name="Belt"><parameter name="k" start="20" unit="N/m"/><parameter name="F" start="3" unit="N"/><parameter name="u" start="0.4" unit="m/s"/>
  <coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/><potential>k*x^2/2</potential>
  <friction name="rub" velocity="v - u" force="F" stiction="1.5*F"/></system>"""
# Chaotic; the energy is conserved.
DOUBLE = """<system name="Double"><parameter name="m1" start="1" unit="kg"/><parameter name="m2" start="0.7" unit="kg"/>
  <parameter name="l1" start="1" unit="m"/><parameter name="l2" start="0.6" unit="m"/><parameter name="g" start="9.81" unit="m/s2"/>
  <coordinate name="a" velocity="va" unit="rad" start="3"/><coordinate name="b" velocity="vb" unit="rad" start="2.5" velocityStart="0.4"/>
  <particle name="p" mass="m1" x="l1*sin(a)" y="-l1*cos(a)"/><particle name="q" mass="m2" x="l1*sin(a) + l2*sin(b)" y="-l1*cos(a) - l2*cos(b)"/>
  <potential>m1*g*p.y + m2*g*q.y</potential>
  <output name="energy" unit="J">m1*l1^2*va^2/2 + m2*(l1^2*va^2 + l2^2*vb^2 + 2*l1*l2*va*vb*cos(a - b))/2 - (m1 + m2)*g*l1*cos(a) - m2*g*l2*cos(b)</output></system>"""
DOUBLE_AT = {"m1": 1.0, "m2": 0.7, "l1": 1.0, "l2": 0.6, "g": 9.81, "a": 3.0, "va": 0.0, "b": 2.5, "vb": 0.4}


@contextlib.contextmanager
def only_package(folder):
    """Import lagrange_fmu from this folder only; afterwards restore the modules of that name that other tests have imported."""

    def forget():
        return {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] == "lagrange_fmu"}

    before = forget()
    sys.path.insert(0, str(folder))
    try:
        yield importlib.import_module("lagrange_fmu")
    finally:
        sys.path.remove(str(folder))
        forget()
        sys.modules.update(before)


@pytest.fixture(scope="module")
def lagrange_fmu(tmp_path_factory):
    with only_package(package.assemble(tmp_path_factory.mktemp("package"))) as imported:
        yield imported


def oscillation(t, m, k, d, x0, F=0.0):
    """Weakly damped oscillation from rest at x0, with a constant force."""
    a, shift = d / (2 * m), F / k
    w = mpmath.sqrt(k / m - a * a)
    return shift + (x0 - shift) * mpmath.exp(-a * t) * (mpmath.cos(w * t) + a / w * mpmath.sin(w * t))


def creep(t, m, k, d, x0):
    """Overdamped motion of the same oscillator."""
    a = d / (2 * m)
    w = mpmath.sqrt(a * a - k / m)
    slow, fast = -k / m / (a + w), -a - w
    return x0 * (fast * mpmath.exp(slow * t) - slow * mpmath.exp(fast * t)) / (fast - slow)


def allow_calls(monkeypatch, owner, name, most):
    """Fail a test that calls this function more often than `most`."""
    function, calls = getattr(owner, name), itertools.count(1)

    def call(*arguments):
        assert next(calls) <= most
        return function(*arguments)

    monkeypatch.setattr(owner, name, call)


def work(t, *at):
    """Return the work of damper and force on the oscillator, which is the change of its energy."""
    m, k = at[:2]
    energies = [(m * mpmath.diff(lambda s: oscillation(s, *at), when) ** 2 + k * oscillation(when, *at) ** 2) / 2 for when in (mpmath.mpf(t), mpmath.mpf(0))]
    return energies[0] - energies[1]


def bounce(t, h0, g, e, bounces):
    """Height at time t of a ball that fell from h0, after this number of bounces."""
    fall = mpmath.sqrt(2 * h0 / g)
    time, speed = fall, e * g * fall
    for _ in range(bounces - 1):
        time, speed = time + 2 * speed / g, e * speed
    return speed * (t - time) - g / 2 * (t - time) ** 2 if bounces else h0 - g / 2 * t**2


def small_bounces():
    """
    Yield start values h, g and e of a ball, a time in the flight after a number of bounces, and the derivatives of the height there.
    Covers small motions and the last bounces of a large one.
    """
    for h, e, bounces in ((1e-3, 0.8, 7), (1e-4, 0.8, 1), (3e-5, 0.8, 1), (1e-5, 0.8, 1), (1.0, 0.5, 8), (1.0, 0.5, 12)):
        at = {"h": h, "g": 9.81, "e": e}
        fall = np.sqrt(2 * h / 9.81)
        time = fall * (1 + 2 * sum(e**k for k in range(1, bounces)) + 1.2 * e**bounces)
        yield at, time, slopes(lambda *at: mpmath.diff(lambda t: bounce(t, *at, bounces), mpmath.mpf(time)), at)


def belt(times, k, F, u):
    """Positions of the block in closed form: a linear oscillation while it slides, uniform motion with the belt while it sticks."""
    w = mpmath.sqrt(k)
    slide_at = 1.5 * F / k
    # Starts from rest at 0: x'' = F - k x until v = u, where the block sticks.
    catch = mpmath.asin(u * w / F) / w
    x_catch = F / k * (1 - mpmath.cos(w * catch))
    leave = catch + (slide_at - x_catch) / u
    def sliding(t):  # x'' = F - k x from x = slide_at and v = u
        return F / k + (slide_at - F / k) * mpmath.cos(w * t) + u / w * mpmath.sin(w * t)
    def place(t):
        return F / k * (1 - mpmath.cos(w * t)) if t <= catch else x_catch + u * (t - catch) if t <= leave else sliding(t - leave)
    return [place(t) for t in times]


def measured(generator, truth, F=0.0, noise=1e-3):
    times = np.linspace(0, 4, 101)
    values = np.array([float(oscillation(t, *(truth[name] for name in ("m", "k", "d", "x")), F)) for t in times])
    return np.rec.fromarrays([times, values + noise * generator.standard_normal(len(times)), np.full(len(times), F)], names="time,x,F").view(np.ndarray)


def energy_of_double(m1, m2, l1, l2, g, a, va, b, vb):
    kinetic = m1 * l1**2 * va**2 / 2 + m2 * (l1**2 * va**2 + l2**2 * vb**2 + 2 * l1 * l2 * va * vb * mpmath.cos(a - b)) / 2
    return kinetic - (m1 + m2) * g * l1 * mpmath.cos(a) - m2 * g * l2 * mpmath.cos(b)


def slopes(function, at):
    """Derivatives by each argument, from differences at 40 digits."""
    with mpmath.workdps(40):
        exact = [mpmath.mpf(value) for value in at.values()]
        return {name: float(mpmath.diff(lambda value: function(*exact[:i], value, *exact[i + 1 :]), value)) for i, (name, value) in enumerate(zip(at, exact))}
