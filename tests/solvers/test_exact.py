"""
The matrix exponential: every variable is accurate relative to its own size, against 60 digits, for variables of very different scales.
"""

import math

import mpmath
import pytest

import fmu
from fmu import DISCARD

mpmath.mp.dps = 60

NAMES = ("x1", "x2", "v1", "v2")


def generator(p):
    """Matrix of the linear system of (x1, x2, v1, v2, 1), from Newton's law."""
    p = {name: mpmath.mpf(value) for name, value in p.items()}
    return mpmath.matrix([
        [0, 0, 1, 0, 0],
        [0, 0, 0, 1, 0],
        [-(p["k1"] + p["k"]) / p["m1"], p["k"] / p["m1"], -p["b1"] / p["m1"], 0, (p["f1"] + p["F"]) / p["m1"]],
        [p["k"] / p["m2"], -(p["k2"] + p["k"]) / p["m2"], 0, -p["b2"] / p["m2"], p["f2"] / p["m2"]],
        [0, 0, 0, 0, 0],
    ])  # fmt: skip


def errors(open_fmu, values, step, count):
    """Error of each variable at the end, relative to the largest sum of magnitudes of its terms over a step."""
    instance = open_fmu("CoupledOscillators")
    parameters = {**fmu.start_values("CoupledOscillators"), "F": 0.0, **values}
    instance.initialize(values)
    with mpmath.workdps(60):
        power = mpmath.expm(generator(parameters) * mpmath.mpf(step), method="taylor")
        state = mpmath.matrix([*(mpmath.mpf(parameters[name]) for name in NAMES), 1])
        sizes = [mpmath.mpf(0)] * 4
        for i in range(count):
            instance.fmu.doStep(i * step, step)
            terms = [[power[j, k] * state[k] for k in range(5)] for j in range(4)]
            sizes = [max(size, sum(map(abs, row))) for size, row in zip(sizes, terms)]
            state = power * state
        return [float(abs(value - state[j]) / (sizes[j] or 1)) for j, value in enumerate(instance.get(*NAMES))]


UNCOUPLED = {"k": 0}


@pytest.mark.parametrize(
    "values",
    [
        UNCOUPLED | {"k2": 1e12},
        UNCOUPLED | {"k1": 1e9},
        UNCOUPLED | {"f2": 1e12},
        UNCOUPLED | {"m1": 1e-9, "k1": 1e-9},
        UNCOUPLED | {"b2": 1e9},
        UNCOUPLED | {"b2": 1e4, "k2": 1e-12, "k1": 1e12},
        {"k": 1e12},
        {"k": 1e-12, "k1": 1e9, "k2": 1e-9},
        {"m1": 1e-9, "m2": 1e9, "f1": 1e12},
        {"b1": 1e6, "b2": 1e-6, "F": 1e9},
    ],
    ids=str,
)
def test_scales_do_not_disturb_each_other(values, open_fmu):
    """The rounding error of the phase is that of the square root of k/m h count, some 1e-16 times the angle."""
    angle = math.sqrt(sum(values.get(name, 1) for name in ("k", "k1", "k2")) / values.get("m1", 1)) * 0.01 * 100
    assert max(errors(open_fmu, values, 0.01, 100)) < 2e-15 + 1e-17 * angle


def test_a_force_without_effect_costs_no_digits(open_fmu):
    """A large gain of an input that is 0 costs no accuracy."""
    instance = open_fmu("ParticleCartesian")
    instance.initialize({"m": 2.0**-30, "kx": 4 * 2.0**-30, "ky": 9 * 2.0**-30, "kz": 16 * 2.0**-30})
    for i in range(1000):
        instance.fmu.doStep(i / 128, 1 / 128)
    assert abs(instance.get("x") - math.cos(2 * 1000 / 128)) < 1e-14
    assert abs(instance.get("y") - math.sin(3 * 1000 / 128) / 3) < 1e-14


@pytest.mark.parametrize("step", [0.01, 1e-4])
def test_many_steps_of_an_undamped_spring(step, open_fmu):
    """After n steps the angle is 1000 n step; rounding it to a double gives an error 1e-16 times as large."""
    instance, count = open_fmu("ParticleCartesian"), 100_000
    instance.initialize({"kx": 1e6})
    for i in range(count):
        instance.fmu.doStep(i * step, step)
    angle = 1000 * mpmath.mpf(step) * count
    bound = 1e-16 * float(angle)
    assert abs(instance.get("x") - mpmath.cos(angle)) < bound
    assert abs(instance.get("vx") / 1000 + mpmath.sin(angle)) < bound


def test_a_decay_keeps_its_digits(open_fmu):
    """The small rest of a fast decay is accurate to its last digits."""
    instance = open_fmu("CoupledOscillators")
    instance.initialize(UNCOUPLED | {"k2": 0, "b2": 1, "k1": 1e9})
    for i in range(10):
        instance.fmu.doStep(i * 40.0, 40.0)
    assert instance.get("v2") == pytest.approx(math.exp(-400), rel=1e-14, abs=0)


def test_growth_beyond_all_numbers(open_fmu):
    """cosh(t) exceeds the largest double at t = 710.4758600739...; the FMU continues up to there, and logs the overflow."""
    instance = open_fmu("ParticleCartesian")
    instance.initialize({"kx": -1.0})
    with instance.fails(DISCARD, "at time 710.47.*try a shorter step"):
        instance.fmu.doStep(0.0, 1000.0)
    with mpmath.workdps(30):
        last = float(mpmath.acosh(mpmath.mpf(1.7976931348623157e308)))
    reached = instance.fmu.getRealStatus(2)
    assert last - 0.002 < reached <= last
    assert instance.get("x") == pytest.approx(math.cosh(reached), rel=1e-12)
