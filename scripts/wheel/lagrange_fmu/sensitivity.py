"""
Integrate a motion and its derivatives by start values, parameters and inputs, with SciPy.

For x' = f(t, x, p) the sensitivities s = dx/dp satisfy the variational equations s' = (df/dx) s + df/dp. The FMU evaluates the right-hand side as
an exact directional derivative. Finite differences through initialization give s at the start. At an event s jumps by the saltation matrix, see
saltation.py. Each evaluation costs one directional derivative for each parameter (E. Hairer, S. Norsett, G. Wanner: Solving ordinary
differential equations I, section I.14).
"""

import numpy as np
from fmpy.fmi1 import FMICallException

from .differences import relevant, rules_within
from .problem import Problem
from .saltation import Saltation, crossing_of, stored_in_a_state
from .stepping import Steps
from .variables import whole_kind

INTERVALS = 8  # intervals of a step in which the event indicators are compared; a double crossing within one is missed
STEP = 1e-3  # relative, of differences through initialization
PERTURBATION = 1e-3  # relative and absolute perturbation of the states that violates constraints


class Start:
    """Initialization at values by name and at neighbouring values, for the derivatives of the start by the names `by`."""

    def __init__(self, point, by, values):
        self.point, self.values = point, values
        self.states, self.modes, self.sides = self.initialize(values)
        self.at = dict(zip(by, point.given(by, self.states, values)))
        self.step = {name: STEP * (abs(value) or 1.0) for name, value in self.at.items()}
        self.rules = {name: rules_within(value, self.step[name], point.limits[name]) for name, value in self.at.items()}

    def initialize(self, values):
        """Return the states, the modes, and the signs of the event indicators after initialization at these values."""
        states = self.point.start(values=values)
        return states, self.point.modes(), np.sign(self.point.indicators())

    def initialize_neighbour(self, steps):
        """Return the result of initialize() with the values changed by steps[name] steps; None if the FMU cannot start there."""
        try:
            return self.initialize(self.values | {name: self.at[name] + count * self.step[name] for name, count in steps.items()})
        except FMICallException:
            self.point.messages.clear()
            return None

    def changes(self, names):
        """Return True if changing all these values together changes the start."""
        found = self.initialize_neighbour({name: self.rules[name][0][-1][0] for name in names})
        return found is None or (found[0] != self.states).any() or found[1] != self.modes or (found[2] != self.sides).any()

    def slope_by(self, name):
        """Return the derivative of the states by a value, by a central difference, or a one-sided one where only one side can start."""
        why = "the motion starts from no neighbouring value"
        for rule in self.rules[name]:
            found = [self.initialize_neighbour({name: count}) for count, _ in rule]
            if None in found:
                continue
            states, modes, sides = zip(*found)
            others = [mode for mode in modes if mode != self.modes]
            differing = self.point.differing(self.modes, others[0]) if others else []
            if differing and {*differing} <= {*self.point.numbers}:
                raise Problem(f"at the start {', '.join(differing)} is set to a number that varies with '{name}', and derivatives by modes are not available; {stored_in_a_state(differing)}")
            if others:
                why = f"from neighbouring values {', '.join(differing)} starts in another mode"
                break
            if (np.max(sides, axis=0) * np.min(sides, axis=0) < 0).any():
                why = "from neighbouring values the motion starts on both sides of an event"
                break
            return sum(weight * state for state, (_, weight) in zip(states, rule)) / self.step[name]
        raise Problem(f"the motion has no derivative by '{name}' at {self.at[name]:g}: {why}; expected another value of '{name}'")


def start_slopes(point, by, values):
    """Initialize at `values`; return the n states and their derivatives, with a row for each name of `by`: (len(by), n)."""
    start = Start(point, by, values)
    moving = {*relevant(start.changes, [name for name in by if name not in point.states])}
    slopes = [start.slope_by(name) if name in moving or name in point.states else np.zeros_like(start.states) for name in by]
    return point.start(values=values), np.array(slopes).reshape(len(by), len(start.states))


def acting_of(point, by):
    """Return, for each name, the list of references that act along the motion: empty for a state, which acts only through the start."""
    return [[] if name in point.states else [point.references[name]] for name in by]


class DifferentiableMotion:
    """
    A motion of the variables `of` of an FMU, with its derivatives by the names `by`.

    The integrated vector `both` holds the n states, followed by their derivatives by each name of `by`: n (1 + len(by)) numbers.
    """

    def __init__(self, point, of, by, tolerance):
        self.point, self.model, self.of, self.by, self.tolerance = point, point.model, list(of), list(by), tolerance
        reference = point.references
        self.state_references = [reference[name] for name in point.states]
        self.rate_references = [reference[name] for name in point.derivatives]
        self.read_references = [reference[name] for name in self.of]
        self.acting = acting_of(point, self.by)
        self.hidden = {reference[name]: index for index, name in enumerate(point.states) if name not in point.outputs}  # index of states that FMI does not count as unknowns

    def set_point(self, time, state, inputs):
        """Set time, states and inputs of the FMU."""
        self.model.setTime(time)
        self.point.set_states(state)
        if inputs is not None:
            names, values = inputs(time)
            self.model.setReal([self.point.references[name] for name in names], values)

    def along(self, unknowns, slopes):
        """Return the derivatives of the unknowns, a row for each name of `by`; `slopes` has those of the states, likewise."""
        columns = [self.model.getDirectionalDerivative(unknowns, [*self.state_references, *acting], [*slope, *[1.0] * len(acting)]) for acting, slope in zip(self.acting, slopes)]
        return np.array(columns)

    def rates(self, time, both, inputs):
        """Return the right-hand side of the motion and of its variational equations."""
        count = len(self.state_references)
        self.set_point(time, both[:count], inputs)
        slopes = both[count:].reshape(len(self.by), count)
        values = self.model.getReal(self.rate_references)
        return np.concatenate([values, self.along(self.rate_references, slopes).ravel()]) if self.by else np.array(values)

    def jacobian(self, time, both, inputs):
        """
        Return the block-diagonal approximation of the derivative of rates(), with df/dx in each block.

        It leaves out the derivatives of the sensitivities' rates by the states. Newton's iteration takes a few more iterations for it.
        """
        count = len(self.state_references)
        self.set_point(time, both[:count], inputs)
        return np.kron(np.eye(len(both) // count), self.point.jacobian(self.point.derivatives, self.point.states))

    def start(self, values):
        """Return the vector `both` after initialization at these values."""
        return np.concatenate([part.ravel() for part in start_slopes(self.point, self.by, values)])

    def read(self, time, both, inputs):
        """Return the values of the variables `of`, and their derivatives, (len(of), len(by))."""
        count = len(self.state_references)
        self.set_point(time, both[:count], inputs)
        slopes = both[count:].reshape(len(self.by), count)
        values = np.array(self.model.getReal(self.read_references))
        unknowns = [reference for reference in self.read_references if reference not in self.hidden]
        derivatives = {reference: slopes[:, index] for reference, index in self.hidden.items()}
        if self.by and unknowns:
            derivatives |= zip(unknowns, self.along(unknowns, slopes).T)
        return values, np.array([derivatives[reference] for reference in self.read_references if self.by]).reshape(len(values), len(self.by))

    def over(self, times, values=None, inputs=None, kinks=()):
        """
        Return the values at n times, n x of, and the derivatives, n x of x by. The motion starts at the first time.

        inputs(time) returns names and values, which are smooth between the times `kinks`.
        """
        both = self.start(values or {})
        return as_arrays([self.read(times[0], both, inputs), *self.continue_to(times[0], both, times[1:], inputs, kinks)])

    def continue_to(self, begin, both, times, inputs=None, kinks=()):
        """Continue from the state `both` at the time `begin`; return a row of values and derivatives for each of the times."""
        due, rows = [*times], []
        for end in [*kinks, *times[-1:]]:
            while begin < end:
                begin, both = self.follow(begin, both, end, inputs, due, rows)
        return rows

    def follow(self, begin, both, end, inputs, due, rows):
        """
        Integrate to the end, or through the next event; return the time and the state after it.

        Append rows for the reached times of `due`, and remove these from it.
        """
        steps = Steps(lambda time, both: self.rates(time, both, inputs), lambda time, both: self.jacobian(time, both, inputs), (begin, end), both, self.tolerance, "the motion cannot be followed", obstacle=lambda time, both: self.obstacle(time, both, inputs))
        self.begin_phase(begin)
        while steps.take():
            solver = steps.solver
            dense = solver.dense_output()
            event = self.event_in(dense, solver, inputs)
            reached = event[0] if event else solver.t
            self.add_step(reached, dense)
            while due and due[0] <= reached:
                rows.append(self.read(due[0], dense(due.pop(0)), inputs))
            if event:
                return event[0], self.handle_event(event, dense, solver.t_old, inputs)
        return end, steps.solver.y

    def obstacle(self, time, both, inputs):
        """
        Return the cause of stagnation as a text: a singular configuration of the constraints, after which states would be wrong.

        Return None for a system without constraints, or with event indicators.
        """
        state = both[: len(self.state_references)]
        self.set_point(time, state * (1 + PERTURBATION) + PERTURBATION, inputs)
        is_constrained, _ = self.model.completedIntegratorStep()
        if not is_constrained or self.point.indicator_count > 0:
            return None
        self.set_point(time, state, inputs)
        steepest = np.argmax(np.max(np.abs(self.point.jacobian(self.point.derivatives, self.point.states)), axis=1))
        return (
            f"the constraints become singular, and {self.point.derivatives[steepest]} changes ever faster with the states, as at a flat position or at the limit of a mechanism, through which "
            "there are no derivatives"
        )

    def begin_phase(self, time):
        """Note the begin of a phase of smooth motion, whose steps follow by add_step(); for subclasses that follow the motion back."""

    def add_step(self, end, dense):
        """Note a step that ends at `end`; dense(time) interpolates the states in it."""

    def event_in(self, dense, solver, inputs):
        """Return the time of the first event in the solver's last step and the index of its indicator; None if there is no event."""
        if self.point.indicator_count == 0:
            return None
        count = len(self.state_references)

        def indicators(time):
            self.set_point(time, dense(time)[:count], inputs)
            return self.point.indicators()

        instants = np.linspace(solver.t_old, solver.t, INTERVALS + 1)
        return next((event for event in (crossing_of(indicators, *part) for part in zip(instants, instants[1:])) if event), None)

    def saltation(self, event, dense, before, inputs):
        """Return the Saltation of an event, (time, index), in a step that begins at the time `before`."""
        count = len(self.state_references)
        time, indicator = event
        early = (before + time) / 2
        return Saltation(self, time, dense(time)[:count], (early, dense(early)[:count]), indicator, inputs)

    def handle_event(self, event, dense, before, inputs):
        """Handle an event; return the vector `both` after it."""
        count = len(self.state_references)
        slopes = dense(event[0])[count:].reshape(len(self.by), count)
        state, slopes = self.saltation(event, dense, before, inputs).handle_event(slopes, self.acting)
        return np.concatenate([state, slopes.ravel()])


def as_arrays(rows):
    """Return arrays, n x of and n x of x by, of n pairs of values and derivatives."""
    values, derivatives = zip(*rows)
    return np.array(values), np.array(derivatives)


def check_once(names):
    for name in names:
        if names.count(name) > 1:
            raise Problem(f"'{name}' is given twice; expected each name once")


def check_names(point, of, by):
    check_once(by)
    for names, among, what in ((of, {*point.outputs, *point.derivatives, *point.states}, "an output, a state or its derivative"), (by, {*point.settable}, "a parameter, a start value or an input")):
        for name in names:
            kind = whole_kind(name, point.description)
            if kind:
                raise Problem(f"'{name}' is {kind}, which has no derivatives; expected some of {', '.join(sorted(among))}")
            if name not in among:
                raise Problem(f"'{name}' is not {what}; these are: {', '.join(sorted(among))}")
