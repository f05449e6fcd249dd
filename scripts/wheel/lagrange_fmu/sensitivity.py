"""Motions with their derivatives by start values, parameters and inputs, by the variational equations, for which the FMU gives directional derivatives."""

import numpy as np

from .problem import Problem

try:
    from .stepping import Steps
except ImportError:
    raise Problem("derivatives of motions and fits need SciPy; install it with: pip install 'lagrange-fmu[fit]'") from None

from fmpy.fmi1 import FMICallException

from .differences import relevant, rules_within
from .saltation import Saltation, crossing_of

LOOKS = 8  # at what events look at, in a step
STEP = 1e-3  # relative, of differences through initialization
AWAY = 1e-3  # of the states, by which constraints are left


class Start:
    """Initialization at values by name, and at those around them."""

    def __init__(self, point, by, values):
        self.point, self.values = point, values
        self.states, self.modes, self.sides = self.found(values)
        self.at = dict(zip(by, point.given(by, self.states, values)))
        self.step = {name: STEP * (abs(value) or 1.0) for name, value in self.at.items()}
        self.rules = {name: rules_within(value, self.step[name], point.limits[name]) for name, value in self.at.items()}

    def found(self, values):
        """The states; the modes; and on which side of each event it begins."""
        states = self.point.start(values=values)
        return states, self.point.modes(), np.sign(self.point.indicators())

    def changed(self, steps):
        """What is found with so many steps by name; None where it cannot start so."""
        try:
            return self.found(self.values | {name: self.at[name] + count * self.step[name] for name, count in steps.items()})
        except FMICallException:
            self.point.messages.clear()
            return None

    def changes(self, names):
        """Whether anything does, with all of these."""
        found = self.changed({name: self.rules[name][0][-1][0] for name in names})
        return found is None or (found[0] != self.states).any() or found[1] != self.modes or (found[2] != self.sides).any()

    def slope_by(self, name):
        """On both sides, or on one where it cannot start on the other."""
        why = "from no value beside it the motion starts"
        for rule in self.rules[name]:
            found = [self.changed({name: count}) for count, _ in rule]
            if None in found:
                continue
            states, modes, sides = zip(*found)
            others = [mode for mode in modes if mode != self.modes]
            if others:
                why = f"from values beside it {', '.join(self.point.differing(self.modes, others[0]))} starts in another mode"
                break
            if (np.max(sides, axis=0) * np.min(sides, axis=0) < 0).any():
                why = "from values beside it the motion starts on both sides of an event"
                break
            return sum(weight * state for state, (_, weight) in zip(states, rule)) / self.step[name]
        raise Problem(f"the motion has no derivative by '{name}' at {self.at[name]:g}: {why}; expected another value of '{name}'")


def start_slopes(point, by, values):
    """The states that initialization makes of values by name, and their derivatives by each of these names, a row each."""
    start = Start(point, by, values)
    moving = {*relevant(start.changes, [name for name in by if name not in point.states])}
    slopes = [start.slope_by(name) if name in moving or name in point.states else np.zeros_like(start.states) for name in by]
    return point.start(values=values), np.array(slopes).reshape(len(by), len(start.states))


def acting_of(point, by):
    """Of each of these names what acts along the motion: a start value acts through the start alone."""
    return [[] if name in point.states else [point.references[name]] for name in by]


class Motion:
    """A motion from values by name, of an opened FMU, with its derivatives by some of these."""

    def __init__(self, point, of, by, tolerance):
        self.point, self.model, self.of, self.by, self.tolerance = point, point.model, list(of), list(by), tolerance
        reference = point.references
        self.state_references = [reference[name] for name in point.states]
        self.rate_references = [reference[name] for name in point.derivatives]
        self.read_references = [reference[name] for name in self.of]
        self.acting = acting_of(point, self.by)
        self.hidden = {reference[name]: place for place, name in enumerate(point.states) if name not in point.outputs}  # states that are no unknowns of FMI

    def place(self, time, state, inputs):
        self.model.setTime(time)
        self.point.set_states(state)
        if inputs is not None:
            names, values = inputs(time)
            self.model.setReal([self.point.references[name] for name in names], values)

    def along(self, unknowns, slopes):
        """The derivatives of unknowns by each of what this motion is differentiated by; slopes: those of the states, one row each."""
        columns = [self.model.getDirectionalDerivative(unknowns, [*self.state_references, *acting], [*slope, *[1.0] * len(acting)]) for acting, slope in zip(self.acting, slopes)]
        return np.array(columns)

    def rates(self, time, both, inputs):
        count = len(self.state_references)
        self.place(time, both[:count], inputs)
        slopes = both[count:].reshape(len(self.by), count)
        values = self.model.getReal(self.rate_references)
        return np.concatenate([values, self.along(self.rate_references, slopes).ravel()]) if self.by else np.array(values)

    def jacobian(self, time, both, inputs):
        """Of the rates; without that of the slopes by the states, which are alone then: corrections converge in a few rounds more."""
        count = len(self.state_references)
        self.place(time, both[:count], inputs)
        return np.kron(np.eye(len(both) // count), self.point.jacobian(self.point.derivatives, self.point.states))

    def start(self, values):
        """The states that initialization makes of these values, and their derivatives."""
        return np.concatenate([part.ravel() for part in start_slopes(self.point, self.by, values)])

    def read(self, time, both, inputs):
        """Values and derivatives of what is asked for."""
        count = len(self.state_references)
        self.place(time, both[:count], inputs)
        slopes = both[count:].reshape(len(self.by), count)
        values = np.array(self.model.getReal(self.read_references))
        unknowns = [reference for reference in self.read_references if reference not in self.hidden]
        derivatives = {reference: slopes[:, place] for reference, place in self.hidden.items()}
        if self.by and unknowns:
            derivatives |= zip(unknowns, self.along(unknowns, slopes).T)
        return values, np.array([derivatives[reference] for reference in self.read_references if self.by]).reshape(len(values), len(self.by))

    def over(self, times, values=None, inputs=None, kinks=()):
        """At these times, the first of which is where it starts: n x of, and n x of x by. inputs(time): names and values, smooth between the kinks."""
        both = self.start(values or {})
        return as_arrays([self.read(times[0], both, inputs), *self.go_on(times[0], both, times[1:], inputs, kinks)])

    def go_on(self, begin, both, times, inputs=None, kinks=()):
        """From there to these times: of each the values and derivatives."""
        due, rows = [*times], []
        for end in [*kinks, *times[-1:]]:
            while begin < end:
                begin, both = self.follow(begin, both, end, inputs, due, rows)
        return rows

    def follow(self, begin, both, end, inputs, due, rows):
        """To the end, or through the next event. Returns the time and the state behind it; adds rows for the times that were due."""
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
                return event[0], self.pass_over(event, dense, solver.t_old, inputs)
        return end, steps.solver.y

    def obstacle(self, time, both, inputs):
        """What makes steps of systems with constraints come to nearly nothing, whose states would be wrong behind it; None of others."""
        state = both[: len(self.state_references)]
        self.place(time, state * (1 + AWAY) + AWAY, inputs)
        is_held, _ = self.model.completedIntegratorStep()
        if not is_held or self.point.indicator_count > 0:
            return None
        self.place(time, state, inputs)
        steepest = np.argmax(np.max(np.abs(self.point.jacobian(self.point.derivatives, self.point.states)), axis=1))
        return (
            f"constraints hold it ever more weakly there, and {self.point.derivatives[steepest]} changes ever more with the states, as where a mechanism lies flat or comes to the limit of its reach, through which "
            "there are no derivatives"
        )

    def begin_phase(self, time):
        """Of smooth motion, of which each step is added next: those may note it who go back."""

    def add_step(self, end, dense):
        """dense: the states within it."""

    def event_in(self, dense, solver, inputs):
        """Its time and the number of its indicator; None for none."""
        if self.point.indicator_count == 0:
            return None
        count = len(self.state_references)

        def indicators(time):
            self.place(time, dense(time)[:count], inputs)
            return self.point.indicators()

        looks = np.linspace(solver.t_old, solver.t, LOOKS + 1)
        return next((event for event in (crossing_of(indicators, *part) for part in zip(looks, looks[1:])) if event), None)

    def saltation(self, event, dense, before, inputs):
        count = len(self.state_references)
        time, indicator = event
        early = (before + time) / 2
        return Saltation(self, time, dense(time)[:count], (early, dense(early)[:count]), indicator, inputs)

    def pass_over(self, event, dense, before, inputs):
        count = len(self.state_references)
        slopes = dense(event[0])[count:].reshape(len(self.by), count)
        state, slopes = self.saltation(event, dense, before, inputs).pass_over(slopes, self.acting)
        return np.concatenate([state, slopes.ravel()])


def as_arrays(rows):
    """Of values and derivatives at each time: n x of, and n x of x by."""
    values, derivatives = zip(*rows)
    return np.array(values), np.array(derivatives)


def check_once(names):
    for name in names:
        if names.count(name) > 1:
            raise Problem(f"'{name}' stands there twice; expected each name once")


def check_tolerance(tolerance):
    if not 0 < tolerance < 1:
        raise Problem(f"the tolerance is {tolerance:g}; expected one between 0 and 1")


def check_names(point, of, by):
    check_once(by)
    for names, among, what in ((of, {*point.outputs, *point.derivatives, *point.states}, "an output, a state or its derivative"), (by, {*point.settable}, "a parameter, a start value or an input")):
        for name in names:
            if name not in among:
                raise Problem(f"'{name}' is not {what}; these are: {', '.join(sorted(among))}")
