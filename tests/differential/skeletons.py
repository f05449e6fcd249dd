"""Coordinates with inertia: kinetic energies with a regular mass matrix, by particles, bodies and <kinetic> terms."""

from .draw import cos, sin, smooth
from .expressions import name, node
from .system import Body, Coordinate

time = name("time")


def coordinate(draw, start=None, rate=None):
    """Add a coordinate; many start at symmetric positions with zeros."""
    system = draw.system
    i = len(system.coordinates) + 1
    symmetric = draw.choice([(0.0, 1.0), (0.0, 0.0), (1.0, 0.0), None, None, None, None, None])
    position, velocity = symmetric or (draw.value(-1.2, 1.2), draw.value(-1.5, 1.5))
    c = Coordinate(f"q{i}", f"v{i}", position if start is None else start, velocity if rate is None else rate)
    system.coordinates.append(c)
    return name(c.name), name(c.velocity)


def body(draw, mass=None, inertia=None, angle=None, **position):
    label = f"b{len(draw.system.bodies) + 1}"
    draw.system.bodies.append(Body(label, mass or draw.quantity(0.5, 2), position, inertia, angle))
    return name(f"{label}.x"), name(f"{label}.y")


def cartesian(draw):
    for _ in range(draw.whole(1, 3)):
        q, _ = coordinate(draw)
        body(draw, **{draw.choice("xyz"): q})


def curvilinear(draw):
    q, _ = coordinate(draw)
    moving = draw.value(0.05, 0.3) * sin(draw.quantity(0.5, 3) * time) if draw.chance(0.5) else node(0)
    x = q + 0.4 * sin(q) + moving
    body(draw, x=x, y=0.5 * smooth(draw, [q], 1)) if draw.chance(0.7) else body(draw, x=x)


def polar(draw):
    r, _ = coordinate(draw, start=draw.value(0.8, 1.5), rate=draw.value(-0.3, 0.3))
    angle, _ = coordinate(draw, rate=draw.value(0.5, 1.5))
    body(draw, x=r * cos(angle), y=r * sin(angle))
    draw.system.potentials.append(draw.quantity(2, 8) * (r - 1) ** 2 / 2)


def pendulum(draw):
    q, _ = coordinate(draw)
    length, gravity = draw.quantity(0.5, 1.5), draw.quantity(1, 10)
    pivot = draw.value(0.05, 0.2) * cos(draw.quantity(1, 6) * time) if draw.chance(0.3) else None
    x = length * sin(q) if pivot is None else pivot + length * sin(q)
    _, y = body(draw, node(1), x=x, y=-(length * cos(q)))
    draw.system.potentials.append(gravity * y)


def cart(draw):
    x, _ = coordinate(draw)
    body(draw, x=x)
    q, _ = coordinate(draw)
    mass = draw.quantity(0.3, 1)
    _, y = body(draw, mass, x=x + 0.8 * sin(q), y=-(0.8 * cos(q)))
    draw.system.potentials.append(mass * 9.81 * y)
    draw.system.potentials.append(draw.quantity(1, 5) * x**2 / 2)


def double_pendulum(draw):
    a, _ = coordinate(draw)
    b, _ = coordinate(draw)
    upper = body(draw, node(1), x=sin(a), y=-cos(a))
    lower = body(draw, node(1), x=upper[0] + 0.7 * sin(b), y=upper[1] - 0.7 * cos(b))
    draw.system.potentials.append(draw.quantity(1, 10) * (upper[1] + lower[1]))


def spherical(draw):
    """Spherical coordinates, away from the pole."""
    polar_angle, _ = coordinate(draw, start=draw.value(1, 2), rate=draw.value(-0.3, 0.3))
    azimuth, _ = coordinate(draw, rate=draw.value(0.5, 1.2))
    r = draw.quantity(0.7, 1.3)
    body(draw, x=r * sin(polar_angle) * cos(azimuth), y=r * sin(polar_angle) * sin(azimuth), z=r * cos(polar_angle))
    draw.system.potentials.append(draw.quantity(3, 9) * (polar_angle - 1.5) ** 2 / 2)


def rigid_body(draw):
    x, _ = coordinate(draw)
    y, _ = coordinate(draw)
    angle, _ = coordinate(draw)
    arm = draw.value(0, 0.5)
    body(draw, inertia=draw.quantity(0.2, 1), angle=angle, x=x + arm * cos(angle), y=y + arm * sin(angle))


def hinged_body(draw):
    q, _ = coordinate(draw)
    turning = draw.choice([q, q + 0.3 * sin(time), 2 * q])
    body(draw, inertia=draw.quantity(0.2, 1), angle=turning, x=0.5 * cos(q), y=0.5 * sin(q))


def kinetic(draw):
    """Kinetic energy that is positive definite by its diagonal."""
    pairs = [coordinate(draw) for _ in range(draw.whole(1, 3))]
    for q, v in pairs:
        draw.system.kinetic.append((draw.quantity(1, 2) + 0.3 * sin(draw.choice(pairs)[0]) ** 2) * v**2 / 2)
        if draw.chance(0.2):
            draw.system.kinetic.append(0.2 * sin(q) * v)
        if draw.chance(0.1):
            draw.system.kinetic.append(0.02 * v**4)
    if len(pairs) > 1:
        (q1, v1), (q2, v2) = pairs[:2]
        draw.system.kinetic.append(draw.quantity(-0.4, 0.4) * cos(q1 - q2) * v1 * v2)


def growing_mass(draw):
    q, v = coordinate(draw)
    draw.system.kinetic.append((1 + 0.3 * sin(time)) * v**2 / 2)


SKELETONS = [
    cartesian,
    cartesian,
    curvilinear,
    polar,
    pendulum,
    cart,
    double_pendulum,
    spherical,
    rigid_body,
    hinged_body,
    kinetic,
    growing_mass,
]
