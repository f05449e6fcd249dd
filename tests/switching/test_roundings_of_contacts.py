"""
Contacts and frictions at the limit of rounding. Cases are late times, long steps after tiny bounces, gaps that are differences of large terms,
lift-off without speed, and dead centres.
"""

import math

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model

from fmu import DISCARD, Instance, build_systems

pytestmark = pytest.mark.long

SPRING = """<system name="{name}"><coordinate name="h" velocity="v" start="0.5"/><particle mass="1" x="h"/><potential>9*h^2/2</potential>
  <stop coordinate="h" min="0" max="2"/><solver method="{method}"/></system>"""
TINY = """<system name="{name}"><coordinate name="h" velocity="v" start="1e-9" velocityStart="0.001"/><particle mass="1" y="h"/><gravity y="-9.81"/>
  <contact name="ground" gap="h" restitution="0.95"/><solver method="{method}"/></system>"""
EARTH = """<system name="{name}"><coordinate name="x" velocity="vx" velocityStart="1"/><coordinate name="y" velocity="vy" start="0.01"/>
  <particle mass="1" x="x" y="y"/><gravity y="-9.81"/><contact name="ground" gap="sqrt(x^2 + (y + 6.4e6)^2) - 6.4e6"/><solver method="{method}"/></system>"""
DOME = """<system name="{name}"><coordinate name="x" velocity="vx" velocityStart="1"/><coordinate name="y" velocity="vy" start="1"/>
  <particle mass="1" x="x" y="y"/><gravity y="-9.81"/><contact name="dome" gap="sqrt(x^2 + y^2) - 1"/><solver method="{method}"/></system>"""
PRESSED = """<system name="{name}"><coordinate name="x" velocity="v" start="1"/><particle mass="1" x="x"/><potential>100*(x + 0.1)^2/2</potential>
  <stop coordinate="x" min="0" max="5" restitution="0.5"/><solver method="{method}"/></system>"""
GRAZED = """<system name="{name}"><coordinate name="x" velocity="v" velocityStart="5"/><coordinate name="y" velocity="w" velocityStart="2"/>
  <particle mass="2" x="x" y="y"/><gravity y="-10"/><contact name="ground" gap="y" restitution="0.7"/>
  <friction name="grip" coordinate="x" force="0.3*ground.force"/><solver method="{method}"/></system>"""
CRANK = """<system name="{name}"><coordinate name="phi" velocity="w" velocityStart="3"/><kinetic>0.2*w^2/2</kinetic>
  <friction name="rub" velocity="-0.3*sin(phi)*w" force="1"/><solver method="{method}"/></system>"""
SLIDER = """<system name="{name}"><coordinate name="phi" velocity="w" velocityStart="3"/><coordinate name="x" velocity="v"/><kinetic>0.2*w^2/2</kinetic>
  <constraint name="rod">x - 0.3*cos(phi)</constraint><friction name="rub" velocity="v" force="1"/><solver method="{method}"/></system>"""
BALANCED = """<system name="{name}"><parameter name="m" start="0.1"/><parameter name="M" start="0.7"/><coordinate name="x" velocity="v" velocityStart="1"/>
  <coordinate name="y" velocity="w"/><particle mass="m + M" x="x" y="y"/><gravity y="-9.81"/><contact name="ground" gap="y"/>
  <friction name="grip" coordinate="x" force="0.5*(ground.force - m*9.81 - M*9.81)"/><solver method="{method}"/></system>"""
FEET = """<system name="{name}"><parameter name="a" start="0.2"/><parameter name="h" start="0.2"/><parameter name="mu" start="1"/><parameter name="slope" start="0.1"/>
  <coordinate name="x" velocity="vx" velocityStart="0.5"/><coordinate name="z" velocity="vz" start="h/2"/><coordinate name="phi" velocity="w"/>
  <kinetic>vx^2/2 + vz^2/2 + (a^2 + h^2)*w^2/24</kinetic><potential>9.81*(z*cos(slope) - x*sin(slope))</potential>
  <for index="i" from="1" to="3"><define name="d[i]">(i/2 - 1)*a</define><contact name="c[i]" gap="z - d[i]*sin(phi) - h/2*cos(phi)"/>
  <friction name="f[i]" velocity="vx - (d[i]*sin(phi) + h/2*cos(phi))*w" force="mu*c[i].force"/></for><solver method="{method}"/></system>"""
RAMP = """<system name="{name}"><parameter name="m" start="2"/><parameter name="r" start="1"/><coordinate name="x" velocity="v"/>
  <particle mass="m" x="x"/><contact name="stop" gap="x"/><friction name="rub" coordinate="x" force="1"/><force coordinate="x">r*time - 3</force>
  <solver method="{method}"/></system>"""
WAVE = """<system name="{name}"><parameter name="m" start="2"/><parameter name="F" start="1"/><parameter name="e" start="0.3"/>
  <parameter name="A" start="1"/><parameter name="B" start="1"/><parameter name="w" start="3"/><coordinate name="x" velocity="v"/>
  <particle mass="m" x="x"/><contact name="stop" gap="x" restitution="e"/><friction name="rub" coordinate="x" force="F"/>
  <force coordinate="x">A*abs(mod(w*time, 2) - 1) - B</force><solver method="{method}"/></system>"""
SLIPS = """<system name="{name}"><parameter name="m" start="2"/><parameter name="A" start="3"/><parameter name="w" start="3"/><coordinate name="x" velocity="v"/>
  <particle mass="m" x="x"/><contact name="stop" gap="x"/><friction name="rub" coordinate="x" force="1"/><force coordinate="x">A*sin(w*time)</force>
  <solver method="{method}"/></system>"""
TEXTS = {f"{title}_{method}": text.format(name=f"{title}_{method}", method=method) for title, text, methods in [
    ("Spring", SPRING, ["taylor", "radau"]), ("Tiny", TINY, ["erk"]), ("Earth", EARTH, ["taylor", "erk", "bdf"]), ("Dome", DOME, ["taylor", "radau", "bdf", "erk"]),
    ("Crank", CRANK, ["taylor", "radau", "bdf"]), ("Slider", SLIDER, ["taylor"]), ("Pressed", PRESSED, ["radau", "bdf", "erk"]), ("Grazed", GRAZED, ["taylor", "radau", "bdf", "erk"]),
    ("Balanced", BALANCED, ["taylor"]), ("Feet", FEET, ["taylor"]),
    ("Ramp", RAMP, ["taylor", "auto"]), ("Wave", WAVE, ["taylor", "auto", "radau"]), ("Slips", SLIPS, ["taylor", "radau", "bdf", "erk"])
] for method in methods}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("roundings-of-contacts", TEXTS)


@pytest.mark.parametrize("steps", [1, 60])
@pytest.mark.parametrize("method", ["taylor", "radau"])
def test_a_spring_brings_a_body_to_rest_where_it_has_no_force(method, steps):
    """The time of the impact is accurate to 2e-12 s, the position to 3e-12 m: the spring does not move the body from there."""
    instance = Instance(f"Spring_{method}").initialize(start_time=1e4)
    for k in range(steps):
        instance.fmu.doStep(1e4 + 6 * k / steps, 6 / steps)
    assert instance.get("h", "v") == pytest.approx([0, 0], abs=1e-15)


def test_tiny_bounces_in_a_long_step():
    """Without the ground the ball would fall 44 m in the step, beside which bounces of 1e-10 m are lost in rounding."""
    instance = Instance("Tiny_erk").initialize()
    instance.step(3)
    assert instance.get("h", "v", "ground.force") == pytest.approx([0, 0, 9.81], abs=1e-12)


@pytest.mark.parametrize("mass", [0.9, 1.3])
def test_the_rest_of_forces_that_cancel_is_no_negative_friction(mass):
    """The sum of forces that cancel is rounded to either sign; it is not a negative friction force."""
    instance = Instance("Balanced_taylor").initialize({"m": mass})
    instance.step(1)
    assert instance.get("x", "v") == pytest.approx([1, 1], abs=1e-12)


@pytest.mark.parametrize("a, h, mu, slope", [(0.2, 0.21, 0.9, 0.09), (0.64, 0.7, 0.77, 0.35), (0.23, 0.26, 0.74, 0.52)])
def test_a_foot_that_parts_without_acceleration_stays_open(a, h, mu, slope):
    """The last of three feet would have to pull while the load is near the first. It opens, and rounding does not close it again."""
    instance = Instance("Feet_taylor").initialize({"a": a, "h": h, "z": h / 2, "mu": mu, "slope": slope})
    instance.step(0.02)
    acceleration, weight = 9.81 * (math.sin(slope) - mu * math.cos(slope)), 9.81 * math.cos(slope)
    assert instance.get("x", "vx", "phi") == pytest.approx([0.01 + acceleration * 2e-4, 0.5 + acceleration * 0.02, 0], abs=1e-12)
    last, middle, first = instance.get(*[f"c[{i}].force" for i in (1, 2, 3)])
    assert min(last, middle, first) >= 0
    assert [last + middle + first, (first - last) * a / 2] == pytest.approx([weight, mu * weight * h / 2], rel=1e-12)


@pytest.mark.parametrize("method", ["taylor", "erk", "bdf"])
def test_sliding_over_the_earth(method):
    """On a circle whose gap is resolved to 1e-9 m; about its top x = a t + O(t^3/R), and y = -x^2/2R."""
    instance = Instance(f"Earth_{method}").initialize()
    for _ in range(20):
        instance.step(0.1)
        x, y = instance.get("x", "y")
        if instance.time > 0.1:
            assert (x, y) == (pytest.approx(instance.time, abs=1e-5), pytest.approx(-(x**2) / 12.8e6, abs=3e-9))
    assert instance.get("ground.force") == pytest.approx(9.81, abs=1e-5)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("method", ["radau", "bdf", "erk"])
def test_errors_of_a_method_keep_no_bounces_up(method, tolerance):
    """The bounces lose three quarters of their energy each, and end after 1.2 s; then the spring presses with 10 N."""
    instance = Instance(f"Pressed_{method}").initialize(tolerance=tolerance)
    instance.step(3)
    assert instance.get("x", "v", "x.min.force") == pytest.approx([0, 0, 10], abs=1e-9)


@pytest.mark.parametrize("method", ["taylor", "radau", "bdf", "erk"])
def test_the_friction_of_bounces_that_are_cut_short(method):
    """Over infinitely many bounces until 1.33 s, and at rest, the ground's impulse is m (g t - 2 m/s), and that of friction 0.3 of it."""
    instance = Instance(f"Grazed_{method}").initialize(tolerance=1e-8)
    instance.step(1.4)
    assert instance.get("v", "w") == pytest.approx([5 - 0.3 * (10 * 1.4 - 2), 0], abs=1e-11)


@pytest.mark.parametrize("speed", [0.2, 1.0, 3.0])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("method", ["taylor", "radau", "bdf", "erk"])
def test_lift_off_without_speed(method, tolerance, speed):
    """
    The body leaves the dome at c = cos(theta) = 2/3 + v^2/3g with the speed sqrt(g c): a parabola from there on, whose gap grows as t^3.
    Where a communication step ends just behind, the method's errors are larger than the gap, which must not be taken for impacts.
    """
    instance = Instance(f"Dome_{method}").initialize({"vx": speed}, tolerance=tolerance)
    for _ in range(200):
        instance.step(0.01)
    c = (2 + speed**2 / 9.81) / 3
    s = (1 - c**2) ** 0.5
    x, y, vx = instance.get("x", "y", "vx")
    assert vx == pytest.approx(c * (9.81 * c) ** 0.5, rel=30 * tolerance)
    assert y == pytest.approx(c - s / c * (x - s) - (x - s) ** 2 / (2 * c**3), rel=100 * tolerance)


@pytest.mark.parametrize("name", ["Crank_taylor", "Crank_radau", "Crank_bdf", "Slider_taylor"])
def test_friction_at_a_dead_centre(name):
    """
    Friction has no moment at the dead centre, and cannot stop a crank in motion. The slider's path is the energy, 0.9 J, divided by 1 N.
    """
    for start in (1.0, -0.5):
        instance = Instance(name).initialize({"phi": start} | ({"x": 0.3 * math.cos(start)} if "Slider" in name else {}))
        instance.step(4)
        way = 0.9 - 0.3 * (1 + math.cos(start)) - (0.6 - 0.6 * math.cos(start) if start < 0 else 0.0)
        assert instance.get("phi") == pytest.approx(2 * math.pi - math.acos(way / 0.3 - 1), abs=1e-6)


def test_friction_at_a_dead_centre_in_model_exchange():
    """An importer detects the dead centre a little late."""
    instance = Instance("Slider_taylor", kind=FMU2Model).initialize({"phi": 3.0, "x": 0.3 * math.cos(3), "w": 2.0})
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    assert instance.get("der(w)") == pytest.approx(-0.3 * math.sin(3) / 0.2, rel=1e-9)
    for name, value in {"phi": math.pi + 1e-11, "x": -0.3, "w": 2.0, "v": 0.6e-11}.items():
        instance.set({name: value})
    instance.fmu.enterEventMode()
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    assert instance.get("w") == pytest.approx(2, rel=1e-9)
    for name, value in {"phi": 3.5, "x": 0.3 * math.cos(3.5), "w": 2.0, "v": -0.6 * math.sin(3.5)}.items():
        instance.set({name: value})
    assert instance.get("der(w)") == pytest.approx(0.3 * math.sin(3.5) / 0.2, rel=1e-9)


@pytest.mark.parametrize("method", ["taylor", "auto"])
@pytest.mark.parametrize("m, r", [(3.17321, 1.91419), (2.99056, 2.47316), (3.15691, 2.88058), (1.59648, 1.3763), (0.51403, 1.73155), (2.11834, 1.86245)])
def test_a_force_lifts_a_body_that_friction_holds(method, m, r):
    """The contact opens at 2/r, where force and friction cancel, up to the rounding of time; the body slips at 4/r."""
    instance = Instance(f"Ramp_{method}").initialize({"m": m, "r": r})
    for _ in range(40):
        instance.step(0.1)
    assert instance.get("x", "v") == pytest.approx([r * (4 - 4 / r) ** 3 / (6 * m), r * (4 - 4 / r) ** 2 / (2 * m)], rel=1e-8)


def leaves_rest(x, F, force, slope):
    """Return the time after which a body at rest starts under force + slope*t, infinity if it stays, and the direction. At the stop it has one way."""
    starts = []
    for direction in (1, -1) if x > 0 else (1,):
        lack, rate = F - direction * force, direction * slope
        starts.append((0.0 if lack < -1e-11 or (lack < 1e-11 and rate > 0) else lack / rate if rate > 0 else math.inf, direction))
    return min(starts)


def next_zero(coefficients, span, falls):
    """Return the first zero of a polynomial (highest power first) within (0, span), at which it falls if asked for; else infinity."""
    slope = np.polyder(np.poly1d(coefficients))
    roots = [root.real for root in np.roots(coefficients) if abs(root.imag) < 1e-9 and 1e-10 < root.real < span]
    return min([root for root in roots if not falls or slope(root) < 0], default=math.inf)


def along_a_wave(end, x, m, F, e, A, B, w):
    """Return position and velocity, event by event: the force is linear over each half period of the wave, so that x is cubic between events."""
    t = v = 0.0
    while t < end - 1e-14:
        half = math.floor(w * t + 1e-11)
        span, rises = min((half + 1) / w, end) - t, half % 2 == 1
        slope = A * w * (1 if rises else -1)
        force = A * (w * t - half if rises else 1 - w * t + half) - B
        wait, direction = (0.0, math.copysign(1, v)) if v != 0 else leaves_rest(x, F, force, slope)
        if wait > 0:
            t += min(wait, span)
            continue
        cubic = np.poly1d([slope / m / 6, (force - direction * F) / m / 2, v, x])
        stops, hits = next_zero(np.polyder(cubic), span, False), next_zero(cubic, span, True)
        step = min(stops, hits, span)
        x, v, t = cubic(step), np.polyder(cubic)(step), t + step
        if step == hits:
            x, v = 0.0, -e * v
        if step == stops or abs(v) < 1e-9:
            v = 0.0
    return [x, v]


@pytest.mark.parametrize("method", ["taylor", "auto", "radau"])
def test_a_body_that_slips_towards_the_open_stop_at_which_it_stands(method):
    """Where friction reaches its limit, the gap has no acceleration, and a jerk closes it. Random masses, waves, frictions and restitutions."""
    rng = np.random.default_rng(7)
    for _ in range(140):
        values = dict(m=rng.uniform(0.5, 4), F=rng.uniform(0.3, 1.5), e=rng.choice([0, 0.3, 0.6]), A=rng.uniform(0.5, 5), B=rng.uniform(-1, 3),
                      w=rng.uniform(1, 6))  # fmt: skip
        step, x = rng.choice([0.05, 0.1, 1.0]), rng.choice([0, 0.5])
        instance = Instance(f"Wave_{method}").initialize({**values, "x": x}, tolerance=1e-9)
        instance.run(6, step)
        assert instance.get("x", "v") == pytest.approx(along_a_wave(6, x, **values), rel=1e-6, abs=1e-6), values
        instance.free()


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
@pytest.mark.parametrize("method", ["taylor", "radau", "bdf", "erk"])
def test_a_body_that_slips_away_from_the_stop(method, tolerance):
    """The stop is open when friction reaches its limit; the gap grows by a jerk, at first less than the errors of the method."""
    for m, A, w in [(2.8, 2.4, 4.5), (0.7, 1.3, 2.1), (1.9, 4.1, 5.8), (3.4, 1.8, 1.2), (0.5, 2.9, 3.3)]:
        instance = Instance(f"Slips_{method}").initialize({"m": m, "A": A, "w": w}, tolerance=tolerance)
        t = math.pi / 2 / w
        instance.run(t, t / 7)
        slip = math.asin(1 / A) / w
        speed = (A / w * (math.cos(w * slip) - math.cos(w * t)) - (t - slip)) / m
        x = (A / w * (math.cos(w * slip) * (t - slip) - (math.sin(w * t) - math.sin(w * slip)) / w) - (t - slip) ** 2 / 2) / m
        assert instance.get("x", "v") == pytest.approx([x, speed], rel=100 * tolerance)
        instance.free()
