"""Bodies in frames that are translated and rotated step by step."""

from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr

import sympy as sp

from mechanics import angular_velocity, rotation, velocity

from .expressions import name, node

AXES = "xyz"


@dataclass
class FrameBody:
    """Body in a frame. moments: of inertia about the centre of mass, by Ixx, Iyy, Izz, Ixy, Ixz, Iyz."""

    name: str
    mass: float
    place: list
    moments: dict


@dataclass
class Frame:
    """Frame with steps ("translate", three expressions) or ("rotate", axis, angle)."""

    name: str
    parent: object
    steps: list
    bodies: list = field(default_factory=list)

    def expressions(self):
        for kind, *words in self.steps:
            yield from (words[0] if kind == "translate" else words[1:])

    def xml(self):
        parent = "" if self.parent is None else f' in="{self.parent.name}"'
        yield f'<frame name="{self.name}"{parent}>'
        for kind, *words in self.steps:
            if kind == "translate":
                yield "  <translate" + "".join(f" {axis}={quoteattr(str(e))}" for axis, e in zip(AXES, words[0])) + "/>"
            else:
                yield f'  <rotate axis="{words[0]}" angle={quoteattr(str(words[1]))}/>'
        yield "</frame>"
        for body in self.bodies:
            place = "".join(f' {axis}="{x!r}"' for axis, x in zip(AXES, body.place))
            moments = "".join(f' {label}="{x!r}"' for label, x in body.moments.items())
            yield f'<body name="{body.name}" in="{self.name}" mass="{body.mass!r}"{place}{moments}/>'

    def pose(self, convert):
        """Origin and rotation matrix."""
        origin, turn = (sp.zeros(3, 1), sp.eye(3)) if self.parent is None else self.parent.pose(convert)
        for kind, *words in self.steps:
            if kind == "translate":
                origin = origin + turn * sp.Matrix([convert(e) for e in words[0]])
            else:
                turn = turn * rotation(words[0], convert(words[1]))
        return origin, turn

    def places(self, convert):
        """Centre of mass of each body by name."""
        origin, turn = self.pose(convert)
        return {body.name: origin + turn * sp.Matrix([sp.Rational(repr(x)) for x in body.place]) for body in self.bodies}

    def kinetic(self, convert, q, v):
        _, turn = self.pose(convert)
        rates = angular_velocity(turn, q, v)
        number = lambda value: sp.Rational(repr(float(value)))
        energy = sp.Integer(0)
        for body, place in zip(self.bodies, self.places(convert).values()):
            energy += number(body.mass) / 2 * sum(velocity(x, q, v) ** 2 for x in place)
            for i, a in enumerate(AXES):
                for j, b in enumerate(AXES):
                    moment = body.moments.get(f"I{min(a, b)}{max(a, b)}", 0.0)
                    energy += number(moment) * rates[i] * rates[j] / 2
        return energy


def chain(draw, coordinate):
    """One to three nested frames, each rotated or translated by a coordinate, with bodies of full inertia tensors and weight."""
    system, parent = draw.system, None
    for i in range(draw.whole(1, 3)):
        q, _ = coordinate(draw)
        steps = [("translate", [draw.value(-0.6, 0.6) for _ in AXES])] if draw.chance(0.7) else []
        moving = draw.choice(["rotate", "rotate", "rotate", "translate"]) if i > 0 else "rotate"
        if moving == "rotate":
            steps.append(("rotate", draw.choice(AXES), draw.choice([q, q, q + 0.2 * name("time"), 0.5 * q])))
        else:
            steps.append(("translate", [draw.choice([0.0, 0.2]), q, 0.3 * q]))
        if draw.chance(0.4):
            steps.append(("rotate", draw.choice(AXES), draw.value(-1.5, 1.5)))
        steps = [(kind, [node(e) for e in words[0]]) if kind == "translate" else (kind, words[0], node(words[1]))
                 for kind, *words in steps]  # fmt: skip
        frame = Frame(f"frame{i + 1}", parent, steps)
        a, b, c = (draw.value(0.1, 0.4) for _ in range(3))
        moments = {"Ixx": round(b + c, 4), "Iyy": round(a + c, 4), "Izz": round(a + b, 4)}
        if draw.chance(0.5):
            moments |= {label: draw.value(-0.05, 0.05) for label in ("Ixy", "Ixz", "Iyz")}
        body = FrameBody(f"rotor{i + 1}", draw.value(0.5, 2), [draw.value(-0.5, 0.5) for _ in AXES], moments)
        frame.bodies.append(body)
        system.frames.append(frame)
        weight = draw.quantity(1, 10)
        system.potentials.append(weight * name(f"{body.name}.{draw.choice('yz')}"))
        system.potentials.append(draw.quantity(0.5, 8) * q**2 / 2)
        parent = frame

