"""States of first order, functions with names, integrals and samples, in addition to a system that is complete."""

from .draw import cos, sin, smooth, tanh
from .expressions import function, name, node
from .families import all_coordinates, all_velocities, put, time
from .system import Coordinate, Function, Sample


def any_mass(draw):
    """A coordinate of the system itself."""
    return draw.choice([c for c in draw.system.coordinates if c.rate is None and not c.part])


def state(draw):
    """A state of first order, driven by the motion, which pushes a coordinate; it decays, so that it stays bounded."""
    c = any_mass(draw)
    number = 1 + sum(other.rate is not None for other in draw.system.coordinates)
    label, integral_label = f"state{number}", f"sum{number}"
    others = [name(other.velocity) for other in draw.system.coordinates if other.rate is not None]
    draw.system.coordinates.append(Coordinate(integral_label, label, draw.value(-0.5, 0.5), draw.value(-0.8, 0.8)))
    atoms = [*all_coordinates(draw), *all_velocities(draw), *others, name(label), time]
    decay = draw.quantity(0.3, 3) * name(label)
    draw.system.coordinates[-1].rate = smooth(draw, atoms, 2) - (decay if draw.chance(0.7) else decay * name(label) ** 2)
    draw.system.forces.append((c.name, draw.quantity(-0.8, 0.8) * draw.choice([name(label), sin(name(label)), tanh(name(label) + name(c.name))])))


def named_function(draw):
    """A function of one or two arguments, one of them named as a coordinate, which it hides; it calls an earlier one."""
    label = f"f{len(draw.system.functions) + 1}"
    arguments = ["a", draw.choice(["b", any_mass(draw).name])][: draw.whole(1, 2)]
    others = [q for q in all_coordinates(draw) if q.text not in arguments]
    inner = smooth(draw, [*map(name, arguments), *others, time], 2)
    for earlier, one in draw.system.functions.items():
        inner = inner + function(earlier, *(sin(name(arguments[0])) for _ in one.arguments))
    draw.system.functions[label] = Function(arguments, inner)
    c = any_mass(draw)
    q, v = name(c.name), name(c.velocity)
    call = lambda: function(label, *(draw.choice([q, v, q - v / 2, time / 5, node(0.5)]) for _ in arguments))
    put(draw, force=draw.quantity(-0.5, 0.5) * sin(call()), coordinate=c)
    draw.system.outputs[f"of_{label}"] = call()


def energy_density(draw):
    """A potential that is an integral over a length, whose ends may move."""
    label = f"along{len(draw.system.dummies) + 1}"
    draw.system.dummies.append(label)
    s, atoms = name(label), [name(any_mass(draw).name) for _ in range(2)]
    shape = draw.quantity(-1, 1) * smooth(draw, atoms, 1) + sin(draw.choice(atoms)) * s ** draw.whole(1, 3)
    integrand = shape ** draw.whole(1, 2)
    if draw.chance(0.5):
        integrand = integrand + draw.quantity(0.2, 1) * cos(draw.choice(atoms)) * cos(node(draw.value(0.5, 3)) * s)
    high = draw.choice([node(1), draw.parameter(draw.value(0.5, 1.5)), 1 + sin(draw.choice(atoms)) / 2, node(1.5)])
    draw.system.potentials.append(draw.quantity(0.1, 0.6) * sin(function("integral", s, draw.choice([0, -0.5]), high, integrand)))


def sampled(draw):
    """Forces of modes that one or two samples of different periods set, from the motion and from their own old values."""
    system = draw.system
    for number in range(1, draw.whole(1, 2) + 1):
        labels = [f"hold{number}", f"last{number}"][: draw.whole(1, 2)]
        atoms = [*all_coordinates(draw), *all_velocities(draw), *map(name, system.modes), time]
        system.modes |= {label: draw.value(-0.5, 0.5) for label in labels}
        values = {labels[0]: draw.quantity(-0.8, 0.8) * sin(smooth(draw, atoms, 2)) + draw.value(-0.5, 0.5) * name(labels[-1])}
        values |= {label: name(labels[0]) for label in labels[1:]}
        every = draw.value(0.03, 0.7) * system.plan.length / 5
        offset = system.plan.start_time + draw.choice([0.0, every, draw.value(0, 0.5)])
        system.samples.append(Sample(every, offset, values))
        system.forces.append((any_mass(draw).name, draw.quantity(-1.5, 1.5) * draw.choice([name(labels[-1]), name(labels[0])])))


ADDITIONS = (state, state, named_function, named_function, energy_density, sampled)
