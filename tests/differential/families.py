"""
Difficult terms, one function per family: each adds terms to a system whose coordinates have inertia. Widths are those of the smoothed
switches that textbooks recommend, down to 1e-5 of the path.
"""

from .draw import (
    absolute, acos, acosh, asin, asinh, atan, atan2, atanh, cos, cosh, exp, log, maximum, minimum, power, sign, sin,
    sinh, smooth, sqrt, tan, tanh,
)  # fmt: skip
from .expressions import name, node

time = name("time")


def any_coordinate(draw):
    c = draw.choice(draw.system.coordinates)
    return c, name(c.name), name(c.velocity)


def all_coordinates(draw):
    return [name(c.name) for c in draw.system.coordinates]


def all_velocities(draw):
    return [name(c.velocity) for c in draw.system.coordinates]


def moment(draw):
    """A random time within the run."""
    plan = draw.system.plan
    return node(draw.value(plan.start_time + 0.1 * plan.length, plan.start_time + 0.9 * plan.length))


def put(draw, potential=None, force=None, coordinate=None):
    if potential is not None and (force is None or draw.chance(0.6)):
        draw.system.potentials.append(potential)
    else:
        draw.system.forces.append((coordinate.name, force))


def smooth_potential(draw):
    draw.system.potentials.append(draw.quantity(0.1, 1.5) * smooth(draw, all_coordinates(draw), draw.whole(1, 3)))


def smooth_force(draw):
    c, _, _ = any_coordinate(draw)
    atoms = [*all_coordinates(draw), *all_velocities(draw), time]
    draw.system.forces.append((c.name, draw.quantity(-0.8, 0.8) * sin(smooth(draw, atoms, draw.whole(1, 3)))))


def smooth_dissipation(draw):
    _, q, v = any_coordinate(draw)
    form = draw.choice([v**2 / 2, (1 + sin(q) ** 2) * v**2 / 2, v**4 / 4, cosh(v / 2), log(1 + v**2), sqrt(0.1 + v**2)])
    draw.system.dissipations.append(draw.quantity(0.05, 0.6) * form)


def cartesian_force(draw):
    body = draw.choice(draw.system.bodies) if draw.system.bodies else None
    if body is None:
        return smooth_force(draw)
    atoms = [*all_coordinates(draw), time]
    axes = [axis for axis in body.position if draw.chance(0.8)] or [next(iter(body.position))]
    force = {axis: draw.quantity(-1, 1) * cos(smooth(draw, atoms, 1)) for axis in axes}
    draw.system.cartesian_forces.append((body.name, force))


def definition(draw):
    label = f"d{len(draw.system.definitions) + 1}"
    draw.system.definitions[label] = smooth(draw, all_coordinates(draw), 2)
    draw.system.potentials.append(draw.quantity(0.1, 1) * sin(name(label)))


UNARY_CONSTANTS = {
    sin: [0, 1], cos: [0, 1], tan: [0, 1], asin: [0, 1, 0.5], acos: [0, 1, 0.5], atan: [0, 1], sinh: [0, 1], cosh: [0, 1],
    tanh: [0, 1], asinh: [0, 1], acosh: [1, 2], atanh: [0, 0.5], exp: [0, 1], log: [1, 2], sqrt: [0, 1, 2], absolute: [0, 1],
    sign: [0, 1],
}  # fmt: skip


def constant_arguments(draw):
    """Constants, parameters, 0 and 1 in every argument of every function."""
    c, q, v = any_coordinate(draw)
    constant = lambda: draw.choice([0, 1, 2, 0.5, draw.parameter(draw.value(0.3, 2))])
    moving = lambda: draw.choice([q, v, -q, sin(q), time])
    positive = lambda: draw.choice([1, 2, 0.5, draw.parameter(draw.value(0.3, 2)), cosh(q), 2 + sin(v)])
    form = draw.whole(0, 7)
    if form == 0:
        f = draw.choice(UNARY_CONSTANTS)
        term = f(draw.choice(UNARY_CONSTANTS[f])) * draw.choice([q, node(1)])
    elif form == 1:
        term = atan2(constant(), moving())
    elif form == 2:
        term = atan2(moving(), constant())
    elif form == 3:
        term = draw.choice([power, lambda a, b: node(a) ** b])(positive(), draw.choice([constant(), sin(q), -cos(q)]))
    elif form == 4:
        term = draw.choice([power, lambda a, b: node(a) ** b])(moving(), draw.choice([0, 1, 2, 3]))
    elif form == 5:
        term = draw.choice([node(1) ** q, node(2) ** -q, 2 * tanh(node(0) * q), q * 0 + 1, q * 1, q / 1, 0 / (2 + q**2), q - q,
                            node(0) - q, sin(q - q), 1 ** -v, exp(0 * v)])  # fmt: skip
    elif form == 6:
        term = draw.choice([minimum, maximum])(constant(), constant())
    else:
        term = draw.choice([asin, atan, tanh, asinh, sinh, tan])(draw.parameter(draw.value(0.1, 0.9))) * q
    draw.system.forces.append((c.name, draw.quantity(-0.7, 0.7) * term))


def circle(draw):
    """Operands whose squares add up to a constant."""
    c, q, v = any_coordinate(draw)
    pairs = [(sin(q), cos(q)), (0.5 * sin(q), 0.5 * cos(q))]
    for body in draw.system.bodies:
        if {"x", "y"} <= set(body.position):
            x, y = name(f"{body.name}.x"), name(f"{body.name}.y")
            pairs += [(x, -y)] * 2
    y, x = draw.choice(pairs)
    angle = draw.choice([atan2(y, x), atan2(-y, x), atan2(y, sqrt(x**2 + y**2) + x + 0.1)])
    forms = [angle**2 / 2, cos(angle), sqrt(y**2 + x**2) * q, (cosh(q) ** 2 - sinh(q) ** 2) * q**2, log(exp(q)) ** 2, acosh(cosh(q / 2)) ** 2,
             (sin(q) ** 2 + cos(q) ** 2) * sin(q), log(x**2 + y**2 + 1)]  # fmt: skip
    draw.system.potentials.append(draw.quantity(0.2, 1.5) * draw.choice(forms))


def wall(draw):
    c, q, _ = any_coordinate(draw)
    w, width = draw.width()
    distance = draw.value(c.start + 0.3, c.start + 1.5)
    side = 1
    if draw.chance(0.5):
        distance, side = draw.value(c.start - 1.5, c.start - 0.3), -1
    steep = exp((q - node(distance)) / width) if side == 1 else exp(-((q - node(distance)) / width))
    strength = draw.quantity(0.5, 5)
    put(draw, strength * width * steep, -side * strength * steep, c)


def soft_contact(draw):
    """The smooth maximum of 0 and the depth."""
    c, q, _ = any_coordinate(draw)
    w, width = draw.width()
    height = q - node(draw.value(c.start - 1.2, c.start - 0.2))
    depth = width * log(1 + exp(-height / width))
    strength = draw.quantity(2, 50)
    put(draw, strength * depth**2 / 2, strength * depth, c)


def hill(draw):
    c, q, _ = any_coordinate(draw)
    w, width = draw.width()
    place = node(draw.choice([0, 0, draw.value(c.start - 1, c.start + 1)]))
    shape = (q - place) / width if place.text != "0" else q / width
    put(draw, draw.quantity(-0.6, 0.6) * exp(-(shape**2)), draw.quantity(-2, 2) * exp(-(shape**2)), c)


def switch(draw):
    """Sigmoids in space, by which textbooks replace a jump."""
    c, q, _ = any_coordinate(draw)
    w, width = draw.width()
    argument = (q - node(draw.value(c.start - 1, c.start + 1))) / width
    form = draw.choice([1 + tanh(argument), atan(argument), 1 / (1 + exp(-argument)), argument / sqrt(1 + argument**2)])
    put(draw, draw.quantity(-0.5, 0.5) * form, draw.quantity(-1, 1) * form, c)


def friction(draw):
    c, _, v = any_coordinate(draw)
    w, width = draw.width(1e-4)
    form = draw.choice(
        [
            tanh(v / width),
            v / sqrt(v**2 + width**2),
            atan(v / width),
            tanh(v / width) * (1 + 0.3 * exp(-((v / (10 * width)) ** 2))),
        ]
    )
    draw.system.forces.append((c.name, -(draw.quantity(0.1, 1) * form)))


def pulse(draw):
    c, q, _ = any_coordinate(draw)
    w, width = draw.width()
    argument = (time - moment(draw)) / width
    form = draw.choice(
        [
            exp(-(argument**2)),
            1 + tanh(argument),
            1 / cosh(argument) ** 2 if w > 0.01 else exp(-(argument**2)),
            exp(-(argument**4)),
        ]
    )
    draw.system.forces.append((c.name, draw.quantity(-3, 3) * form))


def time_function(draw):
    c, q, _ = any_coordinate(draw)
    form = draw.choice([sin(draw.quantity(0.5, 20) * time), cos(time) * q, exp(-time / 3), tanh(time - 1), log(1 + time**2), sqrt(1 + time**2),
                        time, 1 / (1 + time**2), atan2(sin(time), 2 + cos(time)), 2 ** -(time**2)])  # fmt: skip
    draw.system.forces.append((c.name, draw.quantity(-1, 1) * form))


def disguised_kink(draw):
    """Kinks written without abs."""
    c, q, v = any_coordinate(draw)
    rate = draw.quantity(0.7, 2)
    forms = [sqrt(q**2), (q**2) ** 1.5, v * sqrt(v**2), sqrt((time - moment(draw)) ** 2), asin(sin(rate * q)), acos(cos(rate * time)), atan(tan(rate * q)),
             q * sqrt(q**2), (v**2) ** 0.5, acos(cos(q)), sqrt(sin(q) ** 2), asin(sin(time)), power(q**4, 0.25), sqrt(q**2 * v**2)]  # fmt: skip
    form = draw.choice(forms)
    draw.system.forces.append((c.name, -(draw.quantity(0.2, 1) * form)))


def kink(draw):
    c, q, v = any_coordinate(draw)
    place = node(draw.value(c.start - 0.8, c.start + 0.8))
    forms = [absolute(q), minimum(q, place), maximum(0, q - place), v * absolute(v), absolute(sin(q)), maximum(q, -q), minimum(1, q**2),
             absolute(time - moment(draw)), sign(q - place), sign(time - moment(draw)), maximum(0, sin(3 * time)), minimum(v, 0.5)]  # fmt: skip
    if draw.chance(0.3):
        draw.system.potentials.append(
            draw.quantity(0.2, 2)
            * draw.choice([absolute(q - place), maximum(0, place - q) ** 2, q * absolute(q), absolute(q) ** 3])
        )
    else:
        draw.system.forces.append((c.name, -(draw.quantity(0.2, 1) * draw.choice(forms))))


def powers(draw):
    c, q, v = any_coordinate(draw)
    n = draw.choice([*range(2, 41), 2, 3, 4, 5, 6, 7, 8])
    exponent = draw.parameter(float(n), fixed=True) if draw.chance(0.4) else node(n)
    reach = node(draw.value(0.8, 1.6))
    form = draw.whole(0, 6)
    even = n + n % 2
    if form == 0:
        draw.system.potentials.append(draw.quantity(0.1, 1) * (q / reach) ** even)
    elif form == 1:
        draw.system.forces.append((c.name, -(draw.quantity(0.1, 1) * (q / reach) ** (even - 1))))
    elif form == 2:
        draw.system.forces.append((c.name, draw.quantity(-0.5, 0.5) * sin(q) ** exponent))
    elif form == 3:
        draw.system.potentials.append(
            draw.quantity(0.1, 1)
            * draw.choice([power, lambda a, b: a**b])(
                cosh(q / 3), draw.choice([-exponent, node(0.3), node(-0.7), node(1.7), exponent / 3])
            )
        )
    elif form == 4:
        draw.system.potentials.append(draw.quantity(0.05, 0.5) * (2 + sin(q)) ** -node(draw.whole(1, 6)))
    elif form == 5:
        draw.system.forces.append((c.name, -(draw.quantity(0.1, 1) * (v / 3) ** node(2 * draw.whole(1, 8) + 1))))
    else:
        base = draw.quantity(0.5, 3)
        draw.system.potentials.append(draw.quantity(0.05, 0.5) * base**q)


def magnetic(draw):
    """Potentials linear in the velocities."""
    q, v = all_coordinates(draw), all_velocities(draw)
    strength = draw.quantity(0.3, 2)
    if len(q) == 1:
        draw.system.potentials.append(strength * sin(q[0]) * v[0] * draw.choice([node(1), time, cos(time)]))
        return
    forms = [
        q[0] * v[1] - q[1] * v[0],
        sin(q[0]) * v[1],
        q[1] ** 2 * v[0] / 2,
        time * q[0] * v[1],
        tanh(q[0] * q[1]) * v[1],
    ]
    draw.system.potentials.append(strength * draw.choice(forms))


def inputs(draw):
    system, plan = draw.system, draw.system.plan
    c, q, v = any_coordinate(draw)
    label = f"u{len(system.inputs) + 1}"
    system.inputs[label] = draw.value(-1, 1)
    u = name(label)
    form = draw.choice([u, u * cos(q), sin(u) * q, u**2, tanh(u * v), u * time / 5, atan2(u, 2)])
    if draw.chance(0.2):
        system.dissipations.append((1 + u**2) * v**2 / 8)
    else:
        system.forces.append((c.name, form))
    if draw.chance(0.3):
        return  # constant
    derivatives = draw.choice([0, 1, 2, 3])
    step = plan.length / len(plan.actions)
    for action in plan.actions:
        action.inputs[label] = draw.value(-1, 1)
        # Each order changes the input by about 1 over the step.
        action.input_derivatives[label] = [draw.value(-0.5, 0.5) / step**k for k in range(1, derivatives + 1)]


FAMILIES = {
    smooth_potential: 3, smooth_force: 3, smooth_dissipation: 2, cartesian_force: 2, definition: 1, constant_arguments: 3,
    circle: 2, wall: 2, soft_contact: 2, hill: 2, switch: 2, friction: 2, pulse: 2, time_function: 2, disguised_kink: 2,
    kink: 2, powers: 3, magnetic: 2, inputs: 2,
}  # fmt: skip
