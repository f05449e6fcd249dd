"""Causes of events: contacts, stops, dry friction, modes and events; and their variables between steps."""

from dataclasses import dataclass, field
from xml.sax.saxutils import escape, quoteattr

from .expressions import Node, name, node


@dataclass
class Contact:
    name: str
    gap: Node
    restitution: float


@dataclass
class Stop:
    """One or two contacts of a coordinate."""

    coordinate: str
    low: float = None
    high: float = None
    restitution: float = 0.0

    def contacts(self):
        q = name(self.coordinate)
        low = [] if self.low is None else [Contact(f"{self.coordinate}.min", q - node(self.low), self.restitution)]
        high = [] if self.high is None else [Contact(f"{self.coordinate}.max", node(self.high) - q, self.restitution)]
        return low + high


@dataclass
class Friction:
    """Friction; on a contact, force and stiction are coefficients."""

    name: str
    velocity: Node
    force: Node
    stiction: Node
    contact: str = None


@dataclass
class Event:
    """Event. when: an expression with a direction, or a condition without one; sets: (velocity or mode, its name, value)."""

    when: Node
    direction: str
    sets: list


@dataclass
class Switches:
    contacts: list = field(default_factory=list)
    stops: list = field(default_factory=list)
    frictions: list = field(default_factory=list)
    modes: dict = field(default_factory=dict)
    events: list = field(default_factory=list)
    finest: float = 1e-3  # smallest width in the system, for the reference
    are_followed: bool = False  # integrate from event to event

    def __bool__(self):
        return self.are_followed

    @property
    def all_contacts(self):
        return [*self.contacts, *(contact for stop in self.stops for contact in stop.contacts())]

    def expressions(self):
        for contact in self.all_contacts:
            yield contact.gap
        for friction in self.frictions:
            yield from (friction.velocity, friction.force, friction.stiction)
        for event in self.events:
            yield event.when
            yield from (value for *_, value in event.sets)

    @property
    def reals(self):
        """The FMU's variables in addition to the states."""
        return [*self.modes, *(f"{force.name}.force" for force in [*self.all_contacts, *self.frictions])]

    @property
    def integers(self):
        return [*(f"{c.name}.closed" for c in self.all_contacts), *(f"{f.name}.sliding" for f in self.frictions)]

    def xml(self):
        yield from (f'<mode name="{label}" start="{start!r}"/>' for label, start in self.modes.items())
        for c in self.contacts:
            yield f'<contact name="{c.name}" gap={quoteattr(str(c.gap))} restitution="{c.restitution!r}"/>'
        for stop in self.stops:
            ends = "".join(f' {end}="{x!r}"' for end, x in (("min", stop.low), ("max", stop.high)) if x is not None)
            yield f'<stop coordinate="{stop.coordinate}"{ends} restitution="{stop.restitution!r}"/>'
        for f in self.frictions:
            times = lambda factor: str(factor if f.contact is None else factor * name(f"{f.contact}.force"))
            stiction = "" if f.stiction is f.force else f" stiction={quoteattr(times(f.stiction))}"
            yield f'<friction name="{f.name}" velocity={quoteattr(str(f.velocity))} force={quoteattr(times(f.force))}{stiction}/>'
        for event in self.events:
            direction = "" if event.direction is None else f' direction="{event.direction}"'
            sets = "".join(f'<set {kind}="{label}">{escape(str(value))}</set>' for kind, label, value in event.sets)
            yield f"<event when={quoteattr(str(event.when))}{direction}>{sets}</event>"
