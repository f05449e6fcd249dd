"""Random systems with contacts, stops, friction, modes, events and pieces, and narrow hills in all of them."""

import math

from .draw import Draw, absolute, cos, cosh, exp, maximum, minimum, sign, sin, tanh
from .expressions import function, name, node
from .frames import chain
from .generator import follow, plan
from .skeletons import SKELETONS, body, coordinate
from .switches import Contact, Event, Friction, Stop, Switches
from .system import Action, System, Table

time = name("time")
METHODS = [None, None, "taylor", "taylor", "auto", "auto", "radau", "bdf", "erk"]
TOLERANCES = [1e-4, 1e-5, 1e-6, 1e-8, 1e-8, 1e-10, 1e-12]
greater = lambda a, b: function(">", a, b)
less = lambda a, b: function("<", a, b)
choose = lambda condition, a, b: function("if", condition, a, b)


def generate(seed, number):
    system = System(f"Switching{number}", switches=Switches(are_followed=True))
    draw = Draw(f"{seed}/{number}/switching", system)
    system.plan = plan(draw)
    system.plan.actions = [Action() for _ in range(draw.choice([1, 1, 3, 10, 40, 100, 100, 1000]))]
    system.plan.tolerance = draw.choice(TOLERANCES)
    system.plan.packed = False
    system.plan.start_time = draw.choice([0.0, 0.0, 0.0, 1.0, 100.0])
    system.plan.length = draw.choice([1.0, 2.0, 5.0])
    system.plan.fmi = draw.choice([2, 2, 3])
    system.plan.event_mode = system.plan.fmi == 3 and draw.chance(0.7)
    system.method = draw.choice(METHODS)
    skeleton = draw.choice([line, line, line, ball, smooth_skeleton, smooth_skeleton, framed])
    skeleton(draw)
    system.families.add(f"skeleton {skeleton.__name__}")
    if skeleton is not framed and draw.chance(0.15):
        follow(draw)
    weights = dict(FAMILIES)
    for _ in range(draw.choice([1, 1, 2, 2, 3])):
        family = draw.weighted(weights)
        del weights[family]
        family(draw)
        system.families.add(family.__name__)
    if draw.chance(0.3):
        draw.choice(system.plan.actions).rewind = not system.plan.event_mode
    # Coarse gaps raise the smallest resolvable bounce, which would decide at tighter tolerances.
    if draw.chance(0.2) and system.plan.tolerance >= 1e-8:
        look_from_afar(draw)
    return system


def look_from_afar(draw):
    """Replace gaps by distances from a far point, so that their rounding errors exceed those of the state."""
    for contact in draw.system.switches.contacts:
        far = node(draw.choice([30.0, 500.0]))
        contact.gap = ((contact.gap + far) ** 2 + 1) ** 0.5 - far
        draw.system.families.add("far gap")


# --- Hills ---


def hill(draw, z, centre, length, narrowest=1e-5):
    """A function that is 0 far away and 1 at the centre; and its width."""
    system, exact = draw.system, node(centre)
    w = draw.logarithmic(narrowest, 0.3) * min(1.0, length)
    width = node(w)
    u = (z - exact) / width
    form = draw.choice(["gauss", "gauss", "lorentz", "steps", "sech", "cosine", "table", "powers"])
    if form == "gauss":
        value = exp(-(u**2))
    elif form == "lorentz":
        value = 1 / (1 + u**2)
    elif form == "steps":
        value = (tanh(u + 2) - tanh(u - 2)) / 2
    elif form == "sech" and w > 0.02:
        value = 1 / cosh(u) ** 2
    elif form == "cosine":
        count = 2 * draw.whole(20, 400)
        value = cos((z - exact) * draw.value(0.3, 1.5)) ** count
        w = math.sqrt(1.4 / count)
    elif form == "table":
        label = f"hill{len(system.tables) + 1}"
        x = [centre - 3 * w, centre - w, centre, centre + w, centre + 3 * w]
        system.tables.append(Table(label, x, [0.0, 0.2, 1.0, 0.2, 0.0], draw.choice(["linear", "monotone"])))
        value = function(label, z)
    else:
        value = maximum(0, 1 - u**2) ** draw.choice([1, 2, 3])
    system.switches.finest = min(system.switches.finest, w / 20)
    system.families.add(f"hill by {form}")
    return value, w


def any_hill(draw, narrowest=1e-5):
    """A hill in time or along a coordinate: (value, width, True if in time)."""
    system, plan = draw.system, draw.system.plan
    if draw.chance(0.5):
        centre = draw.value(plan.start_time + 0.05 * plan.length, plan.start_time + 0.95 * plan.length)
        return *hill(draw, time, centre, plan.length, narrowest), True
    c = free_coordinate(draw)
    way = 0.6 * (c.velocity_start or 0.5)
    return *hill(draw, name(c.name), draw.value(min(c.start, c.start + way) - 0.1, max(c.start, c.start + way) + 0.1), 1.0, narrowest), False


def pulse(draw):
    value, w, in_time = any_hill(draw)
    place = draw.choice([pulse_condition, pulse_condition, pulse_event, pulse_event, pulse_gap, pulse_operand, pulse_friction, pulse_table])
    place(draw, value, w, in_time)
    draw.system.families.add(place.__name__)


def strength(draw, w):
    return node(float(f"{draw.value(0.2, 1) * draw.choice([-1, 1]) / w:.4g}"))


def pulse_condition(draw, value, w, in_time):
    c = free_coordinate(draw)
    condition = greater(value, draw.choice([0.5, 0.3, 0.9]))
    other = draw.choice([None, greater(time, node(draw.system.plan.start_time)), less(name(c.velocity), 50)])
    condition = condition if other is None else function("and", condition, other)
    draw.system.forces.append((c.name, choose(condition, strength(draw, w), 0)))


def pulse_event(draw, value, w, in_time):
    system, level = draw.system, draw.choice([0.5, 0.3, 0.9])
    label = mode(draw)
    sets = [("mode", label, name(label) + 1)]
    if draw.chance(0.4) and not system.constraints:
        c = free_coordinate(draw)
        sets.append(("velocity", c.velocity, draw.value(-0.9, 0.9) * name(c.velocity) + draw.value(-0.5, 0.5)))
    if draw.chance(0.5):
        system.switches.events.append(Event(greater(value, level), None, sets))
    else:
        system.switches.events.append(Event(value - level, draw.choice(["rising", "falling", "both"]), sets))
    if draw.chance(0.4):
        c = free_coordinate(draw)
        system.forces.append((c.name, 0.7 * name(label)))


def pulse_gap(draw, value, w, in_time):
    """A gap that moves against a coordinate for a short time, or blocks its way."""
    system, c = draw.system, free_coordinate(draw)
    if not in_time:
        value, w = hill(draw, time, draw.value(system.plan.start_time + 0.1, system.plan.start_time + 0.9 * system.plan.length), system.plan.length)
    reach = draw.choice([w, w, 0.3])
    base = c.start - draw.choice([0.0, 0.05, 0.3])
    gap = name(c.name) - node(base) - node(float(f"{reach * draw.value(0.5, 2):.4g}")) * value + node(1e-3)
    add_contact(draw, c, gap)


def pulse_operand(draw, value, w, in_time):
    c, level = free_coordinate(draw), draw.choice([0.5, 0.2])
    form = draw.choice([maximum(value - level, 0), absolute(value - level) - level, sign(value - level) + 1, minimum(level, value) * maximum(0, value - 0.8)])
    draw.system.forces.append((c.name, strength(draw, w) * form))


def pulse_friction(draw, value, w, in_time):
    system, c = draw.system, free_coordinate(draw)
    if any(f.velocity == name(c.velocity) for f in system.switches.frictions):
        return
    force = node(draw.value(0.5, 2))
    label = f"rub{len(system.switches.frictions) + 1}"
    form = draw.choice(["velocity", "force", "stiction"]) if in_time else "force"
    if form == "velocity":
        slip = name(c.velocity) - node(draw.value(0.3, 3)) * value
        system.switches.frictions.append(Friction(label, slip, force, force))
    elif form == "force":
        force = force * (1 + node(float(f"{draw.value(0.3, 1) / w:.4g}")) * value)
        system.switches.frictions.append(Friction(label, name(c.velocity), force, force))
    else:
        stiction = force + 2 - 1.99 * value
        sliding = 0.01 * force
        system.switches.frictions.append(Friction(label, name(c.velocity), sliding, stiction))
    system.families.add(f"pulse in the {form} of friction")


def pulse_table(draw, value, w, in_time):
    system, c = draw.system, free_coordinate(draw)
    label = f"steps{len(system.tables) + 1}"
    system.tables.append(Table(label, [0.3, 0.6, 0.7], [0.0, 0.0, 1.0], "linear"))
    system.forces.append((c.name, strength(draw, w) * function(label, value)))


# --- Events without hills ---


def free_coordinate(draw):
    return draw.choice([c for c in draw.system.coordinates if c.acceleration is None])


def mode(draw, start=0.0):
    label = f"n{len(draw.system.switches.modes) + 1}"
    draw.system.switches.modes[label] = start
    return label


def restitution(draw):
    return draw.choice([0.0, 0.0, 0.3, 0.5, 0.7, 0.9, 1.0])


def add_contact(draw, c, gap):
    draw.system.switches.contacts.append(Contact(f"touch{len(draw.system.switches.contacts) + 1}", gap, restitution(draw)))


def stop(draw):
    system, c = draw.system, free_coordinate(draw)
    if any(s.coordinate == c.name for s in system.switches.stops):
        return
    low = round(c.start - draw.value(0.05, 0.8), 4) if draw.chance(0.7) else None
    high = round(c.start + draw.value(0.05, 0.8), 4) if low is None or draw.chance(0.6) else None
    system.switches.stops.append(Stop(c.name, low, high, restitution(draw)))


def contact(draw):
    """A curved or moving contact."""
    c = free_coordinate(draw)
    q, shift = name(c.name), draw.value(0.05, 0.7)
    moving = draw.value(0.05, 0.3) * sin(draw.value(1, 8) * (time - node(draw.system.plan.start_time)))
    way = q - node(c.start)
    gap = draw.choice([way + shift - moving, way + shift + 0.3 * way**2, sin(way) + node(min(shift, 0.6)), node(shift) - way + 0.5 * moving])
    add_contact(draw, c, gap)


def friction(draw):
    system, c = draw.system, free_coordinate(draw)
    v, force = name(c.velocity), draw.value(0.2, 2)
    if any(f.velocity == v for f in system.switches.frictions):
        return
    label = f"rub{len(system.switches.frictions) + 1}"
    slip = draw.choice([v, v, v - draw.value(-0.5, 0.5), v - 0.4 * sin(draw.value(1, 5) * time)])
    law = draw.choice([node(force), node(force), force * (1 + 0.6 * exp(-((v / 0.3) ** 2))), force * (1 + 0.3 * sin(time)), node(force) + 0.2 * absolute(v)])
    stiction = draw.choice([law, law, 1.3 * law])
    system.switches.frictions.append(Friction(label, slip, law, stiction))


def event(draw):
    system, c = draw.system, free_coordinate(draw)
    q, v, label = name(c.name), name(c.velocity), mode(draw)
    level = node(round(c.start + draw.value(-0.6, 0.6), 4))
    when, direction = draw.choice([
        (q - level, "rising"), (q - level, "falling"), (q - level, "both"), (greater(q, level), None), (v - draw.value(-0.5, 0.5), "both"),
        (function("or", greater(q, level + 0.7), less(v, -0.8)), None), (sin(7 * time + 0.4), "both"),
        (function("and", less(q, level), function("not", greater(time, node(system.plan.start_time + 0.7)))), None)])  # fmt: skip
    sets = [("mode", label, draw.choice([name(label) + 1, 1 - name(label), q]))]
    if draw.chance(0.3) and not system.constraints:
        sets.append(("velocity", c.velocity, draw.choice([-0.7 * v, 0.5 * v, v + 0.3])))
    system.switches.events.append(Event(when, direction, sets))
    other = free_coordinate(draw)
    force = draw.choice([node(0.8) * name(label), choose(greater(name(label), 0.5), 1, -0.5), name(label) * cos(name(other.name))])
    if draw.chance(0.7):
        system.forces.append((other.name, force))


def piece(draw):
    c = free_coordinate(draw)
    q, v = name(c.name), name(c.velocity)
    level = node(round(c.start + draw.value(-0.5, 0.5), 4))
    form = draw.choice([maximum(q - level, 0) * -3, absolute(v) * -v, minimum(q, level), choose(greater(q, level), -1, 0.5 + q - level), sign(sin(5 * time + 0.4)),
                        choose(function("or", greater(q, level), greater(time, 2)), cos(q), -0.3), absolute(q - level)])  # fmt: skip
    draw.system.forces.append((c.name, draw.quantity(0.3, 1.5) * form))


FAMILIES = {pulse: 6, stop: 3, contact: 3, friction: 3, event: 3, piece: 2}


# --- Skeletons ---


def line(draw):
    """Masses on a line, held by springs and moved by a force."""
    system = draw.system
    for _ in range(draw.whole(1, 3)):
        q, _ = coordinate(draw)
        body(draw, x=q)
        if draw.chance(0.7):
            system.potentials.append(draw.quantity(0.5, 20) * (q - draw.value(-0.5, 0.5)) ** 2 / 2)
    for c in system.coordinates:
        q, v = name(c.name), name(c.velocity)
        if draw.chance(0.3):
            system.dissipations.append(draw.quantity(0.05, 1) * v**2 / 2)
        if draw.chance(0.5):
            system.forces.append((c.name, draw.quantity(0.5, 4) * cos(draw.quantity(1, 7) * time) + draw.value(-2, 2)))
        elif draw.chance(0.6):
            system.potentials.append(9.81 * q)
    q = [name(c.name) for c in system.coordinates]
    for a, b, (ca, cb) in zip(q, q[1:], zip(system.coordinates, system.coordinates[1:])):
        if draw.chance(0.4):
            system.potentials.append(draw.quantity(0.5, 10) * (b - a) ** 2 / 2)
        if draw.chance(0.4):
            add_contact(draw, cb, b - a + node(round(ca.start - cb.start + draw.value(0.1, 0.8), 4)))
            system.families.add("masses that meet")


def ball(draw):
    """A disk that spins and bounces, with friction on the ground."""
    system = draw.system
    x, _ = coordinate(draw)
    y, _ = coordinate(draw, start=draw.choice([0.0, 0.3, 1.0]), rate=draw.choice([0.0, 0.0, 0.5]))
    spin, _ = coordinate(draw, rate=draw.value(-20, 20))
    mass = draw.quantity(0.5, 2)
    body(draw, mass, inertia=0.4 * mass * 0.01, angle=spin, x=x, y=y)
    system.potentials.append(mass * 9.81 * y)
    system.switches.contacts.append(Contact("ground", y, restitution(draw)))
    slip = name("v1") + 0.1 * name("v3")
    mu = node(draw.value(0.05, 0.7))
    system.switches.frictions.append(Friction("grip", slip, mu, mu, contact="ground"))
    if draw.chance(0.5):
        system.forces.append(("q1", draw.quantity(0.5, 4) * sin(draw.quantity(1, 7) * time)))


def smooth_skeleton(draw):
    draw.choice(SKELETONS)(draw)
    for c in draw.system.coordinates:
        if draw.chance(0.7):
            draw.system.potentials.append(draw.quantity(0.5, 8) * name(c.name) ** 2 / 2)


def framed(draw):
    chain(draw, coordinate)
