"""Several dry frictions with stiction that hold one velocity: they stick as long as forces within all limits carry the load."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from scipy.optimize import brentq

import fmu
from fmu import build_systems

METHODS = ("taylor", "radau", "auto", "bdf")

# Three frictions on one shaft, under a torque that grows. They begin to slide at the sum of their stictions.
SHAFT = """<system name="{name}">
  {parameters}<parameter name="rate" start="1" unit="N.m/s"/>
  <coordinate name="phi" velocity="w" unit="rad"/>
  <kinetic>J*w^2/2</kinetic>
  <friction name="a" coordinate="phi" force="f1" stiction="s1"/>
  <friction name="b" coordinate="phi" force="f2" stiction="s2"/>
  <friction name="c" coordinate="phi" force="f3" stiction="s3"/>
  <force coordinate="phi">rate*time</force>
  <solver method="{method}" tolerance="1e-9"/>
</system>"""

# Two shafts with frictions, joined by a gear: one degree of freedom, in which the limits add up.
GEAR = """<system name="{name}">
  {parameters}<parameter name="A" start="5" unit="N.m"/><parameter name="B" start="1" unit="N.m"/><parameter name="W" start="2" unit="rad/s"/>
  <parameter name="r" start="2" unit="1"/>
  <coordinate name="alpha" velocity="v" unit="rad"/><coordinate name="beta" velocity="w" unit="rad"/>
  <kinetic>J*v^2/2 + J*w^2</kinetic>
  <constraint name="gear" unit="rad">alpha - r*beta</constraint>
  <friction name="a" coordinate="alpha" force="f1" stiction="s1"/>
  <friction name="b" coordinate="beta" force="f2" stiction="s2"/>
  <force coordinate="alpha">A*sin(W*time)</force><force coordinate="beta">B*cos(2*W*time)</force>
  <solver method="{method}" tolerance="1e-9"/>
</system>"""


def parameters(count):
    names = [f"{kind}{i}" for i in range(1, count + 1) for kind in "fs"]
    return '<parameter name="J" start="1" unit="kg.m2"/>' + "".join(f'<parameter name="{name}" start="1" unit="N.m"/>' for name in names)


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {}
    for method in METHODS:
        for name, text, count in (("Shaft", SHAFT, 3), ("Gear", GEAR, 2)):
            own = name + method.title()
            texts[own] = text.format(name=own, method=method, parameters=parameters(count))
    build_systems("static-limits", texts)


def limits(random, count):
    kinetic = random.uniform(0.2, 1.5, count)
    static = kinetic * random.uniform(1.0, 2.5, count)
    return kinetic, static, {f"f{i + 1}": kinetic[i] for i in range(count)} | {f"s{i + 1}": static[i] for i in range(count)}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("seed", range(5))
def test_a_shaft_starts_at_the_sum_of_stictions(open_fmu, method, seed):
    random = np.random.default_rng(seed)
    kinetic, static, values = limits(random, 3)
    rate = random.uniform(0.5, 3.0)
    start, later = static.sum() / rate, 0.2 * static.sum() / rate
    instance = open_fmu(f"Shaft{method.title()}")
    instance.initialize(values | {"rate": rate})
    instance.run(start * 0.999, start / 10)
    assert instance.get("w") == 0.0
    total = sum(instance.get(f"{name}.force") for name in "abc")
    assert total == pytest.approx(rate * start * 0.999, rel=1e-9)
    assert all(abs(instance.get(f"{name}.force")) <= static[i] * (1 + 1e-9) for i, name in enumerate("abc"))
    instance.run(start + later, start / 10)
    assert instance.get("w") == pytest.approx((static.sum() - kinetic.sum()) * later + rate * later**2 / 2, rel=1e-6)


def test_a_shaft_in_an_importer():
    values = {"f1": 0.5, "s1": 1.0, "f2": 4.0, "s2": 5.0, "f3": 0.25, "s3": 0.5, "rate": 1.0}
    result = simulate_fmu(fmu.archive("ShaftTaylor"), fmi_type="ModelExchange", start_values=values, stop_time=7.5, output=["w"], relative_tolerance=1e-8)
    assert result["w"][-1] == pytest.approx(1.75 + 0.5, rel=1e-5)


class ReducedGear:
    """The motion of beta alone, whose frictions are one friction of the sums of the limits; velocities in closed form between events."""

    def __init__(self, kinetic, static, A, B, W, r):
        self.mass, self.kinetic, self.static = r * r + 2.0, abs(r) * kinetic[0] + kinetic[1], abs(r) * static[0] + static[1]
        self.force = lambda t: r * A * np.sin(W * t) + B * np.cos(2 * W * t)
        self.impulse = lambda t: -r * A * np.cos(W * t) / W + B * np.sin(2 * W * t) / (2 * W)
        self.second = lambda t: -r * A * np.sin(W * t) / W**2 - B * np.cos(2 * W * t) / (4 * W**2)

    def first_zero(self, function, start, end):
        """Return the first time at which a function becomes positive, or the end."""
        times = np.linspace(start, end, 2 + int(2000 * (end - start)))[1:]
        positive = np.flatnonzero(function(times) > 0.0)
        if len(positive) == 0:
            return end
        i = positive[0]
        return start if i == 0 else brentq(function, times[i - 1], times[i], xtol=1e-15)

    def at(self, end):
        t, position = 0.0, 0.0
        while t < end:
            t = self.first_zero(lambda u: np.abs(self.force(u)) - self.static, t, end)
            while t < end and abs(self.force(t)) >= self.static * (1 - 1e-12):
                direction, begin = np.sign(self.force(t)), t
                velocity = lambda u: (self.impulse(u) - self.impulse(begin) - direction * self.kinetic * (u - begin)) / self.mass  # noqa: B023
                t = self.first_zero(lambda u: -direction * velocity(u), begin + 1e-6, end)  # noqa: B023
                position += (self.second(t) - self.second(begin) - self.impulse(begin) * (t - begin)
                             - direction * self.kinetic * (t - begin) ** 2 / 2) / self.mass  # fmt: skip
        return position


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("seed", range(10))
def test_a_gear_between_frictions_is_one_friction(open_fmu, method, seed):
    random = np.random.default_rng(100 + seed)
    kinetic, static, values = limits(random, 2)
    load = {"A": random.uniform(3, 9), "B": random.uniform(-4, 4), "W": random.uniform(1, 4), "r": random.choice([1.0, 2.0, -0.7, 1.5])}
    instance = open_fmu(f"Gear{method.title()}")
    instance.initialize(values | load)
    instance.run(5.0, 0.1)
    assert instance.get("beta") == pytest.approx(ReducedGear(kinetic, static, **load).at(5.0), abs=1e-6)
