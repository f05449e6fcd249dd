"""Define bodies in contact with the ground, with their final positions in closed form."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fmu import ROOT

SYSTEMS = ROOT / "scripts" / "numerics" / "systems" / "touching"
GRAVITY = 9.81
BALL, BOX = {"mass": 0.17, "radius": 0.0286}, {"mass": 2.0, "sizes": (0.2, 0.2, 0.1)}


@dataclass
class Touching:
    """A body that starts on or above the ground."""

    name: str
    title: str
    body: dict  # a ball with "mass" in kg and "radius" in m, or a box with "mass" and "sizes"
    friction: float  # coefficient of friction
    velocity: tuple  # m/s
    spin: tuple  # angular velocity, in rad/s
    end: float  # s
    place: Callable  # function of time that returns x, y and the height above contact, in m
    rigid: str  # name of the FMU with rigid contacts
    soft: str | None  # name of the FMU with compliant contacts; None if their law has no restitution
    slope: float = 0.0  # slope of the ground along x, in rad
    restitution: float = 0.0
    height: float = 0.0  # start height above contact, in m

    @property
    def gravity(self):
        return GRAVITY * np.sin(self.slope), 0.0, -GRAVITY * np.cos(self.slope)

    @property
    def half_height(self):
        return self.body["radius"] if "radius" in self.body else self.body["sizes"][2] / 2

    def error(self, place):
        """Return the largest error of a final position (x, y, height), in m."""
        return float(np.max(np.abs(np.array(place) - self.place(self.end))))


def rolling_down(slope):
    return lambda t: np.array([5 / 14 * GRAVITY * np.sin(slope) * t**2, 0.0, 0.0])


def sliding_to_rest(speed, friction):
    def place(t):
        t = min(t, speed / (friction * GRAVITY))
        return np.array([speed * t - friction * GRAVITY * t**2 / 2, 0.0, 0.0])

    return place


def cue_ball(velocity, spin, radius, friction):
    """Return the position as a function of time: a parabola while the ball slips, since the direction of slip is constant, and then a line."""

    def place(t):
        slip = np.array([velocity[0] - radius * spin[1], velocity[1] + radius * spin[0]])
        size, plane = np.linalg.norm(slip), np.array(velocity[:2])
        sliding = min(t, 2 * size / (7 * friction * GRAVITY))
        push = -friction * GRAVITY * slip / size
        rolled = (plane + push * sliding) * (t - sliding)
        return np.array([*(plane * sliding + push * sliding**2 / 2 + rolled), 0.0])

    return place


def bouncing(height, restitution):
    def place(t):
        speed, t = np.sqrt(2 * GRAVITY * height), t - np.sqrt(2 * height / GRAVITY)
        if t < 0:
            return np.array([0.0, 0.0, height - GRAVITY * (t + np.sqrt(2 * height / GRAVITY)) ** 2 / 2])
        while True:
            speed *= restitution
            if t < 2 * speed / GRAVITY:
                return np.array([0.0, 0.0, speed * t - GRAVITY * t**2 / 2])
            t -= 2 * speed / GRAVITY

    return place


CUE = ((1.0, 0.0, 0.0), (20.0, -10.0, 0.0))
PROBLEMS = [
    Touching("incline", "sphere that rolls down an incline", BALL, 0.4, (0, 0, 0), (0, 0, 0), 2.0, rolling_down(0.3), "RigidBall", "SoftBall", slope=0.3),
    Touching("box", "box that slides to rest", BOX, 0.3, (2.0, 0, 0), (0, 0, 0), 1.0, sliding_to_rest(2.0, 0.3), "RigidBox", "SoftBox"),
    Touching("billiard", "billiard ball with spin", BALL, 0.2, *CUE, 2.0, cue_ball(*CUE, 0.0286, 0.2), "RigidBall", "SoftBall"),
    Touching("drop", "ball that is dropped, restitution 0.8", BALL, 0.2, (0, 0, 0), (0, 0, 0), 2.0, bouncing(1.0, 0.8), "RigidBall", None, restitution=0.8, height=1.0),
]  # fmt: skip

# The quadruped stands for STANDS s; the force on its feet at the end should be its WEIGHT in N. HEIGHT is the start height in m.
QUADRUPED = SYSTEMS / "Quadruped" / "dog.urdf"
STANDS, WEIGHT, HEIGHT = 10.0, 14 * GRAVITY, 0.385
SERVOS = {f"{leg}_{joint}": angle for leg in ("lf", "rf", "lh", "rh") for joint, angle in (("hip", 0.5), ("knee", -1.0))}
STIFFNESS, DAMPING, GROUND_FRICTION = 200.0, 5.0, 0.8
