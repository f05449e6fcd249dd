"""The random system of a seed and a number."""

import math

from .additions import ADDITIONS
from .draw import Draw, cos, sin, smooth
from .expressions import function, name, node
from .families import FAMILIES, inputs
from .skeletons import SKELETONS, coordinate, body
from .system import Action, Body, Coordinate, Plan, System, Table

LIMIT = 4  # largest number of coordinates
TOLERANCES = [1e-3, 1e-4, 1e-5, 1e-6, 1e-6, 1e-8, 1e-8, 1e-10, 1e-10, 1e-12, 1e-13]


def generate(seed, number):
    system = System(f"Random{number}")
    draw = Draw(f"{seed}/{number}", system)
    system.plan = plan(draw)
    if draw.chance(0.07):
        linear(draw)
    else:
        nonlinear(draw)
    outputs(draw)
    actions(draw)
    forces = system.forces or system.cartesian_forces or system.dissipations
    system.work = bool(forces) and system.method != "exact" and draw.chance(0.15)  # the work is not linear in the state
    follow(Draw(f"{seed}/{number}/constraints", system))
    extend(Draw(f"{seed}/{number}/parts", system))
    add(Draw(f"{seed}/{number}/additions", system))
    lengthen(Draw(f"{seed}/{number}/steps", system))
    return system


def lengthen(draw):
    """Some systems get a thousand communication steps; the settings stay at their times."""
    plan = draw.system.plan
    if not draw.chance(0.05):
        return
    steps = [Action() for _ in range(1000)]
    for i, action in enumerate(plan.actions):
        steps[i * len(steps) // len(plan.actions)] = action
    plan.actions = steps
    draw.system.families.add("a thousand steps")


def plan(draw):
    steps = draw.choice([1, 1, 3, 10, 10, 40, 100])
    start = draw.choice([0.0, 0.0, 0.0, 1.0, -2.0, 100.0])
    length = draw.choice([0.5, 1.0, 2.0, 5.0, 5.0, 10.0])
    return Plan(start, length, [Action() for _ in range(steps)], draw.choice(TOLERANCES), packed=draw.chance(0.05),
                compiler=draw.choice(["gcc", "gcc", "gcc", "clang"]), unrolled=draw.chance(0.03),
                form=draw.choice(["statements", "statements", "tables"]))  # fmt: skip


def nonlinear(draw):
    system = draw.system
    skeleton = draw.choice(SKELETONS)
    skeleton(draw)
    system.families.add(f"skeleton {skeleton.__name__}")
    while len(system.coordinates) < LIMIT and draw.chance(0.1):
        extra(draw)
    for c in system.coordinates:
        if draw.chance(0.8):
            system.potentials.append(draw.quantity(0.5, 8) * name(c.name) ** 2 / 2)
    weights = dict(FAMILIES)
    for _ in range(draw.choice([0, 1, 1, 1, 2, 2, 3])):
        family = draw.weighted(weights)
        del weights[family]
        family(draw)
        system.families.add(family.__name__)
    kinks = {"kink", "disguised_kink"} & system.families
    system.method = draw.choice([None] * 5 + (["erk", "bdf", "radau"] if kinks else ["taylor", "taylor", "erk", "bdf", "radau", "auto"]))


def extra(draw):
    """A mass coupled by a spring to another coordinate."""
    other = name(draw.choice(draw.system.coordinates).name)
    q, _ = coordinate(draw)
    body(draw, x=q)
    draw.system.potentials.append(draw.quantity(0.5, 4) * (q - other) ** 2 / 2)


def follow(draw):
    """Some systems get one or two masses that a constraint ties to another coordinate, by position or by velocity."""
    system = draw.system
    for _ in range(draw.choice([0, 0, 0, 0, 1, 2])):
        if system.method == "exact" or system.work:
            return
        leader = draw.choice(system.coordinates)
        q, rate, (a, b, w) = leader.start, leader.velocity_start, (draw.value(-1.5, 1.5) for _ in range(3))
        slope, t = a * math.cos(q) + 2 * b * q, system.plan.start_time
        if draw.chance(0.5):
            moving = draw.choice([0.0, 0.1])
            start = (a * math.sin(q) + b * q * q + moving * math.sin(w * t), slope * rate + moving * w * math.cos(w * t))
            z, _ = coordinate(draw, *start)
            leads = a * sin(name(leader.name)) + b * name(leader.name) ** 2
            system.constraints.append(z - leads if moving == 0 else z - leads - moving * sin(w * name("time")))
        else:
            z, rate_of_z = coordinate(draw, rate=slope * rate)
            leads = (a * cos(name(leader.name)) + 2 * b * name(leader.name)) * name(leader.velocity)
            system.constraints.append(rate_of_z - leads)
        body(draw, **{draw.choice("xyz"): z})
        system.families.add("constraints")


def extend(draw):
    """Further features of the language: a driven coordinate, a displacement, a table, an included part."""
    for extension in (drive, displacement, table, part):
        if draw.chance(0.2) and draw.system.method != "exact" and draw.system.coordinates:
            extension(draw)
            draw.system.families.add(extension.__name__)


def add(draw):
    """States of first order, functions, integrals and samples."""
    for addition in ADDITIONS:
        if draw.chance(0.15) and draw.system.method != "exact":
            addition(draw)
            draw.system.families.add(addition.__name__)


def drive(draw):
    """A driven coordinate, coupled by a spring to another one."""
    system, (amplitude, rate) = draw.system, (draw.value(0.2, 1.5), draw.value(0.5, 4))
    other = name(draw.choice(system.coordinates).name)
    q, v = coordinate(draw)
    prescribed = system.coordinates[-1]
    prescribed.acceleration = amplitude * cos(rate * name("time"))
    moved = amplitude / node(rate) * (sin(rate * name("time")) - sin(node(rate) * system.plan.start_time))
    system.prescribed_velocities.append(v - prescribed.velocity_start - moved)
    system.potentials.append(draw.quantity(0.5, 4) * (q - other) ** 2 / 2)
    body(draw, **{draw.choice("xyz"): q})
    system.work = False  # the work would include that of the drive, which the reference omits


def displacement(draw):
    system = draw.system
    if not system.bodies:
        return
    system.displacements.append("s1")
    moved = draw.choice(system.bodies)
    axis = draw.choice(moved.position)
    moved.position[axis] = moved.position[axis] + draw.choice([name("s1"), sin(2 * name("s1")), name("s1") * name("s1")])


def table(draw):
    system, c = draw.system, draw.choice(draw.system.coordinates)
    count = draw.whole(2, 6)
    x = [round(-1.5 + 3 * (i + 0.8 * draw.random.random()) / count, 3) for i in range(count)]
    system.tables.append(Table("curve", x, [draw.value(-1, 1) for _ in x], draw.choice(["monotone", "spline", "spline"])))
    value = function("curve", draw.choice([name(c.name), sin(name(c.name)), name(c.name) / 2]))
    if draw.chance(0.6):
        system.potentials.append(draw.quantity(0.2, 1) * value)
    else:
        system.forces.append((c.name, draw.quantity(-0.6, 0.6) * value))


def part(draw):
    """An oscillator in a file of its own, whose mass is coupled to another coordinate."""
    system = draw.system
    other = name(draw.choice([c for c in system.coordinates if c.acceleration is None]).name)
    system.coordinates.append(Coordinate("part.x", "part.v", draw.value(-0.8, 0.8), draw.value(-0.8, 0.8)))
    system.bodies.append(Body("part.mass", node(1), {"x": name("part.x")}))
    system.potentials.append(draw.quantity(0.3, 2) * (name("part.x") - other) ** 2 / 2)


def linear(draw):
    """For the method exact: springs, viscous friction, constant forces, inputs."""
    system = draw.system
    system.families.add("linear")
    for _ in range(draw.whole(1, LIMIT)):
        q, v = coordinate(draw)
        body(draw, x=q)
        system.potentials.append(draw.quantity(0.5, 30) * q**2 / 2)
        if draw.chance(0.5):
            system.dissipations.append(draw.quantity(0.05, 3) * v**2 / 2)
    q = [name(c.name) for c in system.coordinates]
    for a, b in zip(q, q[1:]):
        system.potentials.append(draw.quantity(0.5, 8) * (a - b) ** 2 / 2)
    if draw.chance(0.5):
        system.forces.append((system.coordinates[0].name, draw.quantity(-2, 2)))
    if draw.chance(0.5):
        inputs(draw)
        system.dissipations = [d for d in system.dissipations if "u1" not in str(d)]
        system.forces = [(c, f) for c, f in system.forces if "u1" not in str(f)]
        system.forces.append((system.coordinates[-1].name, draw.quantity(0.5, 2) * name("u1")))
    system.method = "exact"


def outputs(draw):
    system = draw.system
    positions = [name(c.name) for c in system.coordinates]
    velocities = [name(c.velocity) for c in system.coordinates]
    knowns = [*positions, *velocities, name("time"), *map(name, system.inputs)]
    for i in range(draw.whole(0, 2)):
        system.outputs[f"y{i + 1}"] = smooth(draw, knowns, draw.whole(1, 3))
    if draw.chance(0.3):
        system.outputs["rate"] = function(
            "der", draw.choice([sin, cos])(draw.choice(positions)) * draw.choice(positions)
        )


def actions(draw):
    """Parameters that change during the run, and repeated steps."""
    system = draw.system
    tunable = [p for p in system.parameters if p not in system.fixed]
    steps = system.plan.actions
    if tunable and len(steps) > 1 and draw.chance(0.3):
        for _ in range(draw.whole(1, 3)):
            changed = draw.choice(tunable)
            draw.choice(steps[1:]).parameters[changed] = float(
                f"{system.parameters[changed] * draw.value(0.7, 1.4):.4g}"
            )
    if draw.chance(0.4):
        draw.choice(steps).rewind = True
