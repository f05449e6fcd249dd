"""A random system, its text as system.xml, and its plan."""

from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr, escape

from .switches import Switches


@dataclass
class Coordinate:
    name: str
    velocity: str
    start: float
    velocity_start: float
    acceleration: object = None  # of a driven coordinate
    # Of a state: `velocity` is the state, and `name` a state that is its integral. The reference is a coordinate with T = velocity^2/2 and Q = rate.
    rate: object = None

    @property
    def part(self):
        """Name of the part that contains it, "" for the system itself."""
        return self.name.rpartition(".")[0]


@dataclass
class Body:
    """A <particle>, or a <body> if it has an angle."""

    name: str
    mass: object
    position: dict  # by axis
    inertia: object = None
    angle: object = None


@dataclass
class Table:
    """A curve through points, by name a function in expressions."""

    name: str
    x: list
    y: list
    interpolation: str


@dataclass
class Function:
    """A <function>; the arguments are names in its expression."""

    arguments: list
    expression: object


@dataclass
class Sample:
    """A <sample>: new values of modes at offset, offset + every, ..., from the old ones."""

    every: float
    offset: float
    values: dict  # expressions by mode

    def times(self, end):
        """Return the times up to an end, by the count of samples, as the language defines them."""
        return [self.offset + k * self.every for k in range(int((end - self.offset) / self.every) + 2)]


@dataclass
class Action:
    """Settings before a communication step: parameters, inputs, input derivatives by order, and a rewind."""

    parameters: dict = field(default_factory=dict)
    inputs: dict = field(default_factory=dict)
    input_derivatives: dict = field(default_factory=dict)  # name: [first, second, ...]
    rewind: bool = False


@dataclass
class Plan:
    start_time: float
    length: float
    actions: list  # one per communication step
    tolerance: float
    packed: bool = False  # simulate the packed FMU
    compiler: str = "gcc"
    unrolled: bool = False  # as users build it, which takes long to compile
    form: str = "statements"  # of the generated code
    fmi: int = 2
    event_mode: bool = False  # by an importer of FMI 3.0 that handles events

    @property
    def times(self):
        count = len(self.actions)
        return [self.start_time + self.length * i / count for i in range(count + 1)]


@dataclass
class System:
    name: str
    coordinates: list = field(default_factory=list)
    parameters: dict = field(default_factory=dict)
    fixed: set = field(default_factory=set)  # parameters that the plan must not change
    inputs: dict = field(default_factory=dict)
    bodies: list = field(default_factory=list)
    kinetic: list = field(default_factory=list)
    potentials: list = field(default_factory=list)
    dissipations: list = field(default_factory=list)
    forces: list = field(default_factory=list)  # (coordinate's name, expression)
    cartesian_forces: list = field(default_factory=list)  # (body's name, {axis: expression})
    constraints: list = field(default_factory=list)
    prescribed_velocities: list = field(default_factory=list)  # each minus the integral of its acceleration: 0 at all times
    displacements: list = field(default_factory=list)
    tables: list = field(default_factory=list)
    functions: dict = field(default_factory=dict)  # Function by name
    dummies: list = field(default_factory=list)  # names of variables of integrals
    modes: dict = field(default_factory=dict)  # start values by name, of modes that samples set
    samples: list = field(default_factory=list)
    definitions: dict = field(default_factory=dict)
    outputs: dict = field(default_factory=dict)
    switches: Switches = field(default_factory=Switches)
    frames: list = field(default_factory=list)
    work: bool = False
    method: str = None
    families: set = field(default_factory=set)
    plan: Plan = None

    @property
    def positions(self):
        return [c.name for c in self.coordinates]

    @property
    def velocities(self):
        return [c.velocity for c in self.coordinates]

    @property
    def states(self):
        return self.positions + self.velocities + (["nonConservativeWork"] if self.work else [])

    @property
    def columns(self):
        """Values compared at the communication points."""
        return [*self.states, *self.switches.reals, *self.switches.integers]

    @property
    def rates(self):
        return [f"der({v})" for v in self.velocities]

    @property
    def start(self):
        states = [c.start for c in self.coordinates] + [c.velocity_start for c in self.coordinates]
        return states + ([0.0] if self.work else [])

    def expressions(self):
        """All expressions of the motion."""
        for body in self.bodies:
            yield from body.position.values()
            if body.angle is not None:
                yield body.angle
        yield from [*self.kinetic, *self.potentials, *self.dissipations]
        yield from (force for _, force in self.forces)
        yield from (c.rate for c in self.coordinates if c.rate is not None)
        for _, force in self.cartesian_forces:
            yield from force.values()
        yield from self.constraints
        yield from self.prescribed_velocities
        yield from self.definitions.values()
        yield from self.switches.expressions()
        for frame in self.frames:
            yield from frame.expressions()

    @property
    def parts(self):
        """Files of included systems by name: one oscillator each, coupled to others."""
        return {
            f"{c.part}.xml": f"""<system name={quoteattr(c.part)}>
  <coordinate name="x" velocity="v" start="{c.start!r}" velocityStart="{c.velocity_start!r}"/>
  <particle name="mass" mass="1" x="x"/>
  <potential>x^2</potential>
  <solver method="erk"/>
</system>
"""
            for c in self.coordinates
            if c.part
        }

    def write(self, folder):
        (folder / "system.xml").write_text(self.xml())
        for name, text in self.parts.items():
            (folder / name).write_text(text)

    def xml(self):
        lines = [f"<system name={quoteattr(self.name)}>"]

        def add(tag, content=None, **attributes):
            words = "".join(f" {key}={quoteattr(str(value))}" for key, value in attributes.items())
            lines.append(f"  <{tag}{words}/>" if content is None else f"  <{tag}{words}>{escape(str(content))}</{tag}>")

        for table in self.tables:
            points = "".join(f"\n{x!r} {y!r}" for x, y in zip(table.x, table.y))
            add("table", points, name=table.name, interpolation=table.interpolation)
        for displacement in self.displacements:
            add("displacement", name=displacement)
        for label, one in self.functions.items():
            add("function", one.expression, name=label, arguments=" ".join(one.arguments))

        for name, value in self.parameters.items():
            add("parameter", name=name, start=repr(value))
        for name, value in self.inputs.items():
            add("input", name=name, start=repr(value))
        for c in self.coordinates:
            if c.part:
                add("include", file=f"{c.part}.xml", **{"as": c.part})
                continue
            if c.rate is not None:
                add("state", name=c.name, start=repr(c.start), rate=c.velocity)
                add("state", name=c.velocity, start=repr(c.velocity_start), rate=c.rate)
                continue
            drive = {"acceleration": c.acceleration} if c.acceleration is not None else {}
            add(
                "coordinate",
                name=c.name,
                velocity=c.velocity,
                start=repr(c.start),
                velocityStart=repr(c.velocity_start),
                **drive,
            )
        for body in self.bodies:
            if "." in body.name:
                continue  # it has a file of its own
            if body.angle is None:
                add("particle", name=body.name, mass=body.mass, **body.position)
            else:
                add("body", name=body.name, mass=body.mass, **body.position, inertia=body.inertia, angle=body.angle)
        for name, expression in self.definitions.items():
            add("define", expression, name=name)
        lines += [f"  {line}" for frame in self.frames for line in frame.xml()]
        energies = {"kinetic": self.kinetic, "potential": self.potentials, "dissipation": self.dissipations}
        for tag, expressions in energies.items():
            for expression in expressions:
                add(tag, expression)
        for coordinate, expression in self.forces:
            add("force", expression, coordinate=coordinate)
        for body, force in self.cartesian_forces:
            add("force", on=body, **force)
        for i, expression in enumerate(self.constraints, 1):
            add("constraint", expression, name=f"c{i}")
        for name, value in self.modes.items():
            add("mode", name=name, start=repr(value))
        for sample in self.samples:
            sets = "".join(f'<set mode="{mode}">{escape(str(value))}</set>' for mode, value in sample.values.items())
            lines.append(f'  <sample every="{sample.every!r}" offset="{sample.offset!r}">{sets}</sample>')
        lines += [f"  {line}" for line in self.switches.xml()]
        for name, expression in self.outputs.items():
            add("output", expression, name=name)
        if self.work:
            add("work")
        if self.method is not None:
            add("solver", method=self.method, tolerance=self.plan.tolerance)
        return "\n".join([*lines, "</system>", ""])


FACTORIALS = [1, 1, 2, 6]


@dataclass
class Step:
    """One communication step; inputs are polynomials by their coefficients at its start."""

    time: float
    end: float
    action: Action
    parameters: dict
    inputs: dict

    def inputs_at_end(self):
        """Coefficients of the polynomials at the end."""
        step = self.end - self.time
        binomial = lambda n, k: FACTORIALS[n] / FACTORIALS[k] / FACTORIALS[n - k]
        return {
            name: [
                sum(binomial(n, k) * c * step ** (n - k) for n, c in enumerate(coefficients) if n >= k)
                for k in range(len(coefficients))
            ]
            for name, coefficients in self.inputs.items()
        }


def course(system):
    """The steps of the plan; an input without new values stays at its value at the end of the last step."""
    parameters, inputs = dict(system.parameters), {name: [value] for name, value in system.inputs.items()}
    times = system.plan.times
    for time, end, action in zip(times, times[1:], system.plan.actions):
        parameters.update(action.parameters)
        for name, value in action.inputs.items():
            derivatives = action.input_derivatives.get(name, [])
            inputs[name] = [value, *(d / FACTORIALS[k] for k, d in enumerate(derivatives, 1))]
        step = Step(time, end, action, dict(parameters), dict(inputs))
        yield step
        inputs = {name: coefficients[:1] for name, coefficients in step.inputs_at_end().items()}
