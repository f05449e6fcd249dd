"""Define systems with events, with their motions in closed form, and as phases from which other programs are built."""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import mpmath
import numpy as np

from closed_forms import pendulum_angle, pendulum_half_period
from fmu import start_values
from numerics.driver import POINTS

DIGITS = 30  # digits of the closed forms


@dataclass
class Phase:
    """The motion of one coordinate between events."""

    acceleration: Callable  # function of coordinate, velocity, and a module with sin
    guard: Callable | None = None  # function of coordinate and velocity; the phase ends when it decreases through 0
    leave: Callable | None = None  # maps (coordinate, velocity, tolerance) before the event to (coordinate, velocity, name of the next phase)


@dataclass
class SwitchingSystem:
    """A system with events, and its motion in closed form."""

    system: str  # name of the FMU
    title: str
    values: dict  # start values and parameters other than the FMU's
    end: float  # s
    compared: list  # names of positions, which do not jump
    positions: Callable  # function of (values, times) that returns rows of the compared positions
    end_of: Callable | None  # function of (values, n) that returns a time after n events
    phases: Callable | None = None  # function of values that returns the phases by name, the first one first; None if there are too many
    stiff: Callable | None = None  # function of (values, contact) that returns the body of a MuJoCo model with a spring and damper as contact
    methods: tuple = ()  # programs that can express it, beside importers of the FMU
    label: str = ""  # distinguishes problems with the same system

    @property
    def name(self):
        return f"{self.system}{', ' if self.label else ''}{self.label}"

    @functools.cached_property
    def all_values(self):
        return start_values(self.system) | self.values

    @property
    def times(self):
        return self.end * np.arange(1, POINTS + 1) / POINTS

    @functools.cached_property
    def exact(self):
        with mpmath.workdps(DIGITS):
            return np.array(self.positions(self.all_values, self.times), dtype=float)

    @property
    def start(self):
        """Start values of the coordinate and its velocity, for systems with one coordinate."""
        name = self.compared[0]
        velocity = {"h": "v", "theta": "omega", "x": "v"}[name]
        return np.array([self.all_values[name], self.all_values[velocity]], dtype=float)

    def error(self, rows):
        """Return the largest error of any position; `rows` belong to the last communication points."""
        return float(np.max(np.abs(rows - self.exact[-len(rows) :])))

    def with_events(self, count):
        """Return the problem with an end after `count` events."""
        return replace(self, end=float(self.end_of(self.all_values, count)))


def exactly(values, *names):
    return [mpmath.mpf(values[name]) for name in names]


# A run ends slightly before the middle between two events, so that its communication points sample all phases of the motion.
BEFORE = 0.6


# --- A ball that bounces ---


def ball_heights(values, times):
    """Return the heights: parabolas, each e^2 as high as the previous one; rest from t = sqrt(2 h/g) (1 + e)/(1 - e) on."""
    height, g, e = exactly(values, "h", "g", "e")
    fall = mpmath.sqrt(2 * height / g)
    start, speed = -fall, g * fall  # time and speed at the begin of the first parabola, extended back to the ground
    rest = fall * (1 + e) / (1 - e) if e < 1 else mpmath.inf
    rows = []
    for time in map(mpmath.mpf, times):
        while time < rest and time > start + 2 * speed / g:
            start, speed = start + 2 * speed / g, e * speed
        rows.append([speed * (time - start) - g * (time - start) ** 2 / 2 if time < rest else mpmath.mpf(0)])
    return rows


def ball_phases(values):
    g, e = values["g"], values["e"]

    def bounce(h, v, tolerance):
        return (0.0, 0.0, "rest") if e * abs(v) < tolerance else (0.0, -e * v, "flight")

    return {"flight": Phase(lambda h, v, of: -g + 0.0 * h, lambda h, v: h, bounce), "rest": Phase(lambda h, v, of: 0.0 * h)}


def ball_body(values, contact):
    return (f'<geom type="plane" size="10 10 1" {contact}/><body pos="0 0 0.1"><joint type="slide" axis="0 0 1"/>'
            f'<geom type="sphere" size="0.1" mass="{values["m"]!r}" {contact}/></body>')  # fmt: skip


# --- A pendulum that hits a stop ---


def quarter(values, k):
    """Return the time in s from a turning point, at the angle 2 asin(k), to the stop on the other side, by elliptic integrals."""
    g, length, stop = exactly(values, "g", "l", "thetaStop")
    return (mpmath.ellipk(k * k) + mpmath.ellipf(mpmath.asin(-mpmath.sin(stop / 2) / k), k * k)) / mpmath.sqrt(g / length)


def pendulum_angles(values, times):
    """Return the angles: between impacts theta = 2 asin(k cd(rate t, k)) from a turning point; an impact reduces the energy and k."""
    g, length, e, stop, theta = exactly(values, "g", "l", "e", "thetaStop", "theta")
    rate, low, k = mpmath.sqrt(g / length), mpmath.sin(stop / 2), mpmath.sin(theta / 2)
    turning, rows, half = mpmath.mpf(0), [], quarter(values, k)
    for time in map(mpmath.mpf, times):
        while time > turning + half:
            turning += half
            k = mpmath.sqrt(low**2 + e**2 * (k**2 - low**2))
            half = quarter(values, k)
            turning += half
        rows.append([2 * mpmath.asin(k * mpmath.ellipfun("cd", rate * (time - turning), m=k * k))])
    return rows


def pendulum_phases(values):
    rate, e, stop = values["g"] / values["l"], values["e"], values["thetaStop"]
    return {"swing": Phase(lambda theta, omega, of: -rate * of.sin(theta), lambda theta, omega: theta - stop,
                           lambda theta, omega, tolerance: (stop, -e * omega, "swing"))}  # fmt: skip


def pendulum_body(values, contact):
    return (f'<body><joint type="hinge" axis="0 -1 0" limited="true" range="{values["thetaStop"]!r} 3" '
            f'{contact.replace("solref", "solreflimit").replace("solimp", "solimplimit")}/>'
            f'<inertial pos="0 0 {-values["l"]!r}" mass="{values["m"]!r}" diaginertia="1e-12 1e-12 1e-12"/></body>')  # fmt: skip


# --- A block on a belt ---


@dataclass
class Slips:
    """The motion of the block: at rest at first, it slips until it has the belt's velocity, and then sticks and slips alternately."""

    rate: float  # angular frequency of the slips, in rad/s
    centre: float  # centre of the oscillation in a slip, in m
    limit: float  # position at which the block begins to slip, in m
    belt: float  # velocity of the belt, in m/s

    @classmethod
    def of(cls, values):
        m, k, belt, normal, static, sliding = exactly(values, "m", "k", "vBelt", "normalForce", "muStatic", "muSliding")
        return cls(mpmath.sqrt(k / m), sliding * normal / k, static * normal / k, belt)

    @property
    def first_stick(self):
        return mpmath.asin(self.belt / (self.centre * self.rate)) / self.rate

    @property
    def first_slip(self):
        stuck = self.centre * (1 - mpmath.cos(self.rate * self.first_stick))
        return self.first_stick + (self.limit - stuck) / self.belt

    @property
    def slip(self):
        """Duration of a slip in s: half a period, and twice the phase at the start."""
        return (mpmath.pi + 2 * mpmath.atan(self.belt / self.rate / (self.limit - self.centre))) / self.rate

    @property
    def period(self):
        return self.slip + 2 * (self.limit - self.centre) / self.belt

    def position(self, time):
        if time < self.first_stick:
            return self.centre * (1 - mpmath.cos(self.rate * time))
        if time < self.first_slip:
            return self.limit - self.belt * (self.first_slip - time)
        since = mpmath.fmod(time - self.first_slip, self.period)
        if since > self.slip:
            return self.limit - self.belt * (self.period - since)
        angle = self.rate * since
        return self.centre + (self.limit - self.centre) * mpmath.cos(angle) + self.belt / self.rate * mpmath.sin(angle)


def block_positions(values, times):
    slips = Slips.of(values)
    return [[slips.position(mpmath.mpf(time))] for time in times]


def block_end(values, count):
    slips = Slips.of(values)
    return slips.first_slip + slips.period * (count / 2 - BEFORE)


def block_phases(values):
    m, k, belt, normal = (values[name] for name in ("m", "k", "vBelt", "normalForce"))
    sliding, stiction = values["muSliding"] * normal, values["muStatic"] * normal
    return {"slip": Phase(lambda x, v, of: (sliding - k * x) / m, lambda x, v: belt - v, lambda x, v, tolerance: (x, belt, "stick")),
            "stick": Phase(lambda x, v, of: 0.0 * x, lambda x, v: stiction - k * x, lambda x, v, tolerance: (x, v, "slip"))}  # fmt: skip


# --- Newton's cradle ---


def cradle_angles(values, times):
    """Return the angles: one of the two outer balls swings at a time, and the others hang."""
    rate = math.sqrt(values["g"] / values["l"])
    angles = [pendulum_angle(values["theta[1]"], rate, time) for time in times]
    return [[min(angle, 0.0), 0.0, 0.0, 0.0, max(angle, 0.0)] for angle in angles]


def cradle_end(values, count):
    return (count - BEFORE / 2) * pendulum_half_period(values["theta[1]"], math.sqrt(values["g"] / values["l"]))


def ball_end(values, count):
    return (2 * count - BEFORE) * mpmath.sqrt(2 * values["h"] / mpmath.mpf(values["g"]))


def pendulum_end(values, count):
    return (2 * count - BEFORE) * quarter(values, mpmath.sin(mpmath.mpf(values["theta"]) / 2))


BALL = SwitchingSystem("BouncingBall", "ball that bounces without loss", dict(e=1.0), 10.0, ["h"], ball_heights, ball_end, ball_phases, ball_body,
                 ("SciPy", "heyoka", "MuJoCo"), "e = 1")  # fmt: skip
RESTING_BALL = replace(BALL, title="ball that bounces until it rests", values=dict(e=0.8), end=5.0, end_of=None, label="e = 0.8")
PENDULUM = SwitchingSystem("HardStopPendulum", "pendulum that hits a stop", {}, 10.0, ["theta"], pendulum_angles, None, pendulum_phases,
                     pendulum_body, ("SciPy", "heyoka", "MuJoCo"))  # fmt: skip
LOSSLESS_PENDULUM = replace(PENDULUM, title="pendulum that hits a stop without loss", values=dict(e=1.0), end_of=pendulum_end, label="e = 1")
BLOCK = SwitchingSystem("StickSlip", "block that sticks and slips on a belt", {}, 60.0, ["x"], block_positions, block_end, block_phases,
                  methods=("SciPy", "heyoka"))  # fmt: skip
CRADLE = SwitchingSystem("NewtonsCradle", "Newton's cradle of five balls", {}, 10.0, [f"theta[{i}]" for i in range(1, 6)], cradle_angles, cradle_end)

PROBLEMS = [BALL, RESTING_BALL, PENDULUM, BLOCK, CRADLE]
GROWING = [BALL, LOSSLESS_PENDULUM, BLOCK, CRADLE]  # followed for more and more events
