"""floor, ceil, round and mod: events in motions, and values in <set>; against closed forms."""

import math

import numpy as np
import pytest

import fmu
from fmu import build_systems, lagc

METHODS = ["taylor", "auto", "radau", "bdf", "erk"]
# A force with steps in time: v' = floor(2 t) + round(t) + ceil(t) + mod(t, 0.3), integrated in closed form.
STAIRS = """<system name="Stairs_{method}"><coordinate name="x" velocity="v"/><particle mass="1" x="x"/>
<force coordinate="x">floor(2*time) + round(time) + ceil(time) + mod(time, 0.3)</force><solver method="{method}" tolerance="1e-11"/></system>"""
# An encoder's position controls the mass: between two steps the acceleration is constant.
ENCODER = """<system name="Encoder"><parameter name="d" start="0.1"/><coordinate name="x" velocity="v" start="0.05" velocityStart="1.3"/>
<particle mass="1" x="x"/><force coordinate="x">-20*d*round(x/d)</force><input name="u"/><state name="z" rate="floor(u)"/>
<mode name="seen"/><mode name="down"/><event when="time - 0.4" direction="rising"><set mode="seen">d*floor(x/d) + mod(-x, d)</set><set mode="down">ceil(-2.5) + round(2.5) + 10*round(-2.5)</set></event>
<output name="o">floor(x/d)</output><output name="p">mod(-7.5, 2) + 10*mod(7.5, -2)</output><solver tolerance="1e-12"/></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("roundings", {f"Stairs_{m}": STAIRS.format(method=m) for m in METHODS} | {"Encoder": ENCODER}, versions=(2, 3))


def stairs_velocity(t):
    """Sum of the integrals of the four terms from 0."""
    whole = lambda s: sum(max(0.0, s - k) for k in range(1, int(s) + 1))  # of floor
    saws = int(t / 0.3 + 1e-12)
    return whole(2 * t) / 2 + (whole(t + 0.5)) + whole(t) + t + saws * 0.045 + (t - 0.3 * saws) ** 2 / 2


@pytest.mark.parametrize("method", METHODS)
def test_stairs(open_fmu, method):
    instance = open_fmu(f"Stairs_{method}").initialize()
    for t in [0.07, 0.29, 0.31, 0.74, 1.0, 1.6, 3.17, 5.0]:
        instance.step(t - instance.time)
        assert instance.get("v") == pytest.approx(stairs_velocity(t), rel=1e-8, abs=1e-9), t


def encoder(t, d=0.1, x=0.05, v=1.3):
    """Parabolas between the positions where round(x/d) changes. It starts at one of these, moving up."""
    k, time = math.floor(x / d + 0.5), 0.0
    while True:
        a, found = -20 * d * k, math.inf
        for edge, step in [((k + 0.5) * d, 1), ((k - 0.5) * d, -1)]:
            roots = np.roots([a / 2, v, x - edge] if a else [v, x - edge])
            for s in roots[np.isreal(roots)].real:
                if s > 1e-9 and s < found and (v + a * s) * step > 0:
                    found, to = s, k + step
        if time + found > t:
            s = t - time
            return x + v * s + a * s * s / 2, v + a * s
        x, v, k, time = x + v * found + a * found**2 / 2, v + a * found, to, time + found


def test_an_encoder(open_fmu):
    instance = open_fmu("Encoder").initialize()
    for t in np.linspace(0.1, 3, 30):
        instance.step(t - instance.time)
        x, v = encoder(t)
        assert instance.get("x") == pytest.approx(x, abs=1e-8) and instance.get("v") == pytest.approx(v, abs=1e-8), t
        assert instance.get("o") == math.floor(instance.get("x") / 0.1)
    x = encoder(0.4)[0]
    assert instance.get("seen") == pytest.approx(0.1 * math.floor(x / 0.1) + (-x) % 0.1, abs=1e-8)
    assert instance.get("down") == -2 + 3 + 10 * -2
    assert instance.get("p") == 0.5 + 10 * -0.5


def test_inputs_that_jump_and_rest(open_fmu):
    """A rounded input has its value as soon as the input is set, also at integers and for large values."""
    instance = open_fmu("Encoder").initialize()
    for value in [0.3, 2.0, 2.7, -1.0, -0.2, 1e6 + 0.5, 3.0, -4.5]:
        instance.set(u=value)
        assert instance.get("der(z)") == math.floor(value), value
        instance.step(0.01)
        assert instance.get("der(z)") == math.floor(value), value


@pytest.mark.parametrize("expression, message", [
    ("mod(x)", "expected ',' between the two arguments of mod"), ("mod(x, 0)", "mod(..., 0) has no value"),
    ("fmod(x, 2)", "write mod(a, b)"), ("trunc(x)", "write sign(x)*floor(abs(x))"), ("7 % 2", "write mod(a, b) for a remainder"),
])  # fmt: skip
def test_messages(tmp_path, expression, message):
    (tmp_path / "system.xml").write_text(f'<system name="X"><input name="x"/><output name="o">{expression}</output></system>')
    assert message in lagc("system.xml", "-o", "out", cwd=tmp_path).stderr


def test_units(tmp_path):
    text = '<system name="X"><input name="x" unit="m"/><input name="s" unit="s"/><output name="o" unit="{}">{}</output></system>'
    for unit, expression, problem in [("m", "floor(x)", "the argument of floor has the unit m"), ("m", "mod(x, s)", "m and s in one mod"),
                                      ("s", "mod(x, 2)", "has the unit m, expected s"), ("m", "mod(x, 2) + x", "")]:  # fmt: skip
        (tmp_path / "system.xml").write_text(text.format(unit, expression))
        assert problem in (messages := lagc("system.xml", "-o", "out", cwd=tmp_path).stderr) and (problem != "" or "mismatch" not in messages)
