"""
Find equilibria of a system: f(x, p) = 0 for the time derivatives f of all states x, and h(x) = h0 for held values, with varying inputs or parameters p.

The search is a damped Newton method on the manifold of the constraints. With an orthonormal basis T of its tangent space, each step solves J (T z,
dp) = -(f, h - h0) by least squares of least norm. So coordinates on which nothing depends stay at the guess. A step is limited to a share of each
value, and halved until the residual decreases; the FMU's initialization projects its end onto the constraints. Residuals and values are relative to
nominal values. A full step may exceed the limit, or no part of it decreases the residual, as at a horizontal pendulum. Then coordinates first move
along their accelerations, which leads towards a stable equilibrium. These moves grow, keep contacts closed, and are halved at obstacles. The search
ends when a step is negligible or after STEPS steps. Each step costs a Jacobian and, with constraints, a basis of the tangent space, see
linearization.py.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from fmpy.fmi1 import FMICallException

from .linearization import Linearization, SwitchesEverywhere, linearization_at, tangents, values_as_text
from .model_exchange import opened
from .problem import Problem
from .quantities import numbers_of
from .variables import known

STEPS, HALVINGS = 200, 25
LARGEST = 0.5  # largest step, relative to a value or its nominal value
SINGULAR = 1e-10  # singular values below this share of the largest one belong to directions without effect
PRECEDENCE = 1e3  # weight of held values relative to rates, in the error that steps decrease
FREE, TINY = 1e-6, 1e-300  # share of an undetermined direction from which on it moves a value; avoids divisions by 0
BALANCED = 1e-9  # a rate below this share of the terms of its linearization counts as 0
CONVERGED = 1e-13  # relative step that is negligible
FURTHEST = 1e9  # values beyond this multiple of nominal values and the guess mean that forces only vanish at infinity
DOWNHILL, NUDGE = 40, 0.1  # number of moves along accelerations at most, and the length of the first, relative to nominal values
GROWTH, STRAIGHT, LONGEST = 2.0, 0.9, 10.0  # growth of moves up to LONGEST, where the cosine of the angle between two of them is above STRAIGHT
CLOSING_MOVE = 3e-9  # relative move into a contact; initialization removes the penetration so exactly that the contact closes
PERTURBED, DOUBLE = 1e-9, 1e-5  # errors relative to the norm of the matrix: of an eigenvalue of condition number 1, and of any eigenvalue at most
WORK = "nonConservativeWork"  # state on which nothing depends
SHOWN, NOTABLE = 3, 1e-3  # rates in a message: their number at most, and the smallest relative to the largest


@dataclass(frozen=True, eq=False, repr=False)
class Equilibrium:
    """
    An equilibrium of a system, in SI units.

    `constraints` lists the closed contacts and the sticking friction, which count as constraints.
    """

    point: dict  # states, inputs and varied values by name
    outputs: dict  # outputs by name
    linearization: Linearization | None  # at the point; None where the system switches there, as for friction at its limit
    eigenvalues: np.ndarray  # eigenvalues of its A; empty without a linearization
    stability: str  # "stable" if all real parts are negative, "unstable" if one is positive, else "undecided", as without damping
    constraints: list[str]

    def __repr__(self):
        lines = values_as_text(self.point | self.outputs)
        lines += [f"contacts that stay closed and frictions that stay stuck: {', '.join(self.constraints)}"] if self.constraints else []
        if self.linearization is None:
            return "\n".join([*lines, f"{self.stability}: the system switches there, such as a contact that touches without force or friction at its limit"])
        return "\n".join([*lines, f"{self.stability}; eigenvalues: {', '.join(f'{value:.6g}' for value in self.eigenvalues) or 'none'}"])


def stability_of(matrix):
    """Return the eigenvalues of a matrix, and the stability by their real parts, which count as 0 within the errors of their condition numbers."""
    eigenvalues, vectors = np.linalg.eig(matrix)
    with np.errstate(over="ignore"):  # infinite where eigenvectors are parallel
        conditions = np.linalg.norm(np.linalg.pinv(vectors, rcond=0.0), axis=1)  # condition numbers, for right eigenvectors of length 1
    error = np.linalg.norm(matrix) * np.minimum(PERTURBED * conditions, DOUBLE)
    is_stable = (eigenvalues.real < -error).all()
    return eigenvalues, "unstable" if (eigenvalues.real > error).any() else "stable" if is_stable else "undecided"


def _scaled(linear, nominals):
    """Return A for states relative to their nominal values, without the state of <work/>."""
    kept = [i for i, name in enumerate(linear.states) if name != WORK]
    size = np.array([nominals[linear.states[i]] for i in kept])
    return linear.A[np.ix_(kept, kept)] * size / size[:, None]


class _Search:
    """The search from a Point. Its unknowns, `values`, are the states followed by the varied inputs and parameters."""

    def __init__(self, point, hold, vary):
        self.point, self.vary, self.hold = point, vary, hold
        self.fixed_indices = [point.states.index(name) for name in hold if name in point.states]
        self.outputs = [name for name in hold if name not in point.states]
        self.targets = np.array([hold[name] for name in [*(point.states[i] for i in self.fixed_indices), *self.outputs]])
        self.size = np.array([point.nominals[name] for name in [*point.states, *vary]])
        fixed = [point.nominals[point.states[i]] for i in self.fixed_indices] + [max(point.nominals[name], abs(hold[name])) for name in self.outputs]
        self.weight = np.array([*(1 / self.size[: len(point.states)]), *(PRECEDENCE / np.array(fixed))])
        self.jacobian, self.move_length, self.direction = None, NUDGE, np.zeros(len(self.size))

    def go_to(self, values):
        """Initialize the FMU; return the values after projection onto the constraints, and the residuals there."""
        count = len(self.point.states)
        self.point.values |= dict(zip(self.vary, values[count:]))
        at = self.point.start(values[:count])
        found = [*self.point.read(self.point.derivatives), *(np.array([*at[self.fixed_indices], *self.point.read(self.outputs)]) - self.targets)]
        return np.concatenate([at, values[count:]]), np.array(found)

    def move_by(self, values, move):
        """Return the values and the residuals after a move that keeps contacts closed and frictions sticking, where they can."""
        count, target = len(self.point.states), values + move
        if self.point.indicator_count:
            projected = self.point.projected(values[:count], target[:count])
            target[:count] = target[:count] if projected is None else projected
        return self.go_to(target)

    def linearize(self, values):
        """Store the Jacobian of the residuals by all values; return the Jacobian by the admissible directions, and these as columns."""
        point, count = self.point, len(self.point.states)
        try:
            basis = tangents(point, values[:count]) if count else np.empty((0, 0))
        except SwitchesEverywhere:
            basis = np.eye(count)
        self.go_to(values)
        names = [*point.states, *self.vary]
        fixed = np.eye(len(names))[self.fixed_indices]
        self.jacobian = np.vstack([point.jacobian(point.derivatives, names), fixed, point.jacobian(self.outputs, names)])
        directions = np.zeros((len(names), basis.shape[1] + len(self.vary)))
        directions[:count, : basis.shape[1]] = basis
        directions[count:, basis.shape[1] :] = np.eye(len(self.vary))
        return self.jacobian @ directions, directions

    def step(self, values, residual):
        """Return the Newton step, of bounded length. Held values, and residuals that are a single state, such as der(x) = v, are satisfied first."""
        slopes, directions = self.linearize(values)
        lengths = np.linalg.norm(directions / self.size[:, None], axis=0)
        slopes, missing = self.weight[:, None] * slopes / lengths, -self.weight * residual
        first = self.is_state() | (np.arange(len(residual)) >= len(self.point.derivatives))
        _, singular, right = np.linalg.svd(slopes[first])
        rank = np.count_nonzero(singular > SINGULAR * singular.max(initial=0.0))
        part = np.linalg.lstsq(slopes[first], missing[first], rcond=SINGULAR)[0]
        free = right[rank:].T
        part += free @ np.linalg.lstsq(slopes[~first] @ free, missing[~first] - slopes[~first] @ part, rcond=SINGULAR)[0]
        step = directions / lengths @ part
        largest = np.max(np.abs(step) / np.maximum(self.size, np.abs(values)), initial=0.0)
        return step * min(1.0, LARGEST / largest) if largest else step

    def undetermined(self, values):
        """Return the names of varied values along which the residuals do not change, to first order."""
        _, directions = self.linearize(values)
        directions = directions / np.linalg.norm(directions / self.size[:, None], axis=0)
        _, singular, right = np.linalg.svd(self.weight[:, None] * self.jacobian @ directions)
        rank = np.count_nonzero(singular > SINGULAR * singular.max(initial=0.0))
        scale = np.where(values == 0, self.size, np.abs(values))
        moves = np.abs(directions @ right[rank:].T) / scale[:, None]
        free = (moves / moves.max(axis=0, initial=TINY)).max(axis=1, initial=0.0)
        return [name for name, share in zip(self.vary, free[len(self.point.states) :]) if share > FREE]

    def is_state(self):
        """Return a mask of the residuals that are a state themselves, such as der(x) = v."""
        return (np.count_nonzero(self.jacobian, axis=1) == 1) & (self.jacobian.max(axis=1, initial=0.0) == 1)

    def moving(self):
        """Return the indices of coordinates among the states, and of their velocities."""
        count = len(self.point.states)
        coordinates = np.flatnonzero(self.is_state()[:count])
        velocities = np.argmax(self.jacobian[coordinates], axis=1) if len(coordinates) else coordinates
        return coordinates[velocities < count], velocities[velocities < count]

    def downhill(self, residual):
        """
        Return the direction of coordinates along their accelerations, and of other states along their rates. Its length is 1 relative to nominal
        values; it is None if all are 0.
        """
        count = len(self.point.states)
        coordinates, velocities = self.moving()
        move = np.zeros(len(self.size))
        move[:count] = residual[:count]
        move[coordinates], move[velocities] = residual[velocities], 0.0
        move[self.fixed_indices] = 0.0
        largest = np.max(np.abs(move) / self.size, initial=0.0)
        return move / largest if largest else None

    def error(self, residual):
        return np.linalg.norm(self.weight * residual)

    def shortened(self, values, residual, step):
        """Return the values after the longest part of the step that decreases the error, and the residual there; None if no part does."""
        for halving in range(HALVINGS):
            try:
                reached, found = self.move_by(values, step / 2**halving)
            except FMICallException:  # there is no such position
                self.point.messages.clear()
                continue
            if np.isfinite(found).all() and self.error(found) < self.error(residual):
                return reached, found
        return None

    def unbalanced(self, values, residual):
        """Return the residuals that are not 0 up to rounding, by name."""
        terms = np.abs(self.jacobian) @ np.maximum(self.size, np.abs(values))
        names = [*self.point.derivatives, *(self.point.states[i] for i in self.fixed_indices), *self.outputs]
        return {name: value for name, value, size in zip(names, residual, terms) if abs(value) > BALANCED * max(size, 1e-3)}

    def run(self):
        values = np.array([*self.point.start(), *self.point.read(self.vary)])
        self.linearize(values)
        values[self.moving()[1]] = 0.0
        values, residual = self.go_to(values)
        limits, moves = FURTHEST * np.maximum(self.size, np.abs(values)), 0
        for _ in range(STEPS):
            step = self.step(values, residual)
            if not residual.any() or (np.abs(values) > limits).any():
                break
            length = np.max(np.abs(step) / np.maximum(self.size, np.abs(values)), initial=0.0)
            is_newton = length > CONVERGED and (length < LARGEST * (1 - CONVERGED) or moves == DOWNHILL)
            found = self.shortened(values, residual, step) if is_newton else None
            if found is None and (moves == DOWNHILL or not self.unbalanced(values, residual)):
                break
            moves += found is None
            values, residual = found or self.move_downhill(values, residual)
        values, residual = self.go_to(values)
        off = self.unbalanced(values, residual)
        if off or (np.abs(values) > limits).any():
            raise Problem(self.failure_message(values, off))
        return values

    def move_downhill(self, values, residual):
        """
        Return the values and the residual after a move downhill. The move is longer than the last one if it continues straight on, and is halved
        until such a position exists.
        """
        direction = self.downhill(residual)
        if direction is None:
            return self.go_to(values)
        last, own = self.direction / self.size, direction / self.size
        is_straight = last @ own > STRAIGHT * np.linalg.norm(last) * np.linalg.norm(own)
        length = min(self.move_length * GROWTH, LONGEST) if is_straight else NUDGE
        for halving in range(HALVINGS):
            self.move_length, self.direction = length / 2**halving, direction if halving == 0 else np.zeros(len(direction))
            try:
                return self.move_and_close(values, self.move_length * direction)
            except FMICallException:
                self.point.messages.clear()
        return self.go_to(values)

    def move_and_close(self, values, move):
        """Return the values and the residual after a move. If initialization has removed a penetration, a tiny second move closes the contact."""
        found = self.move_by(values, move)
        corrected = np.max(np.abs(found[0] - values - move) / self.size)
        return self.move_by(found[0], CLOSING_MOVE / self.move_length * move) if corrected > self.move_length / 2 else found

    def failure_message(self, values, off):
        """Return the message about accelerations and rates that are not 0."""
        largest = max(map(abs, off.values()), default=0.0)
        units, shown = self.point.units, [name for name in sorted(off, key=lambda name: -abs(off[name])) if abs(off[name]) > NOTABLE * largest][:SHOWN]
        rates = [f"{name} = {off[name]:.6g} {units[name]}" for name in shown if name not in self.hold]
        missed = [f"{name} is off by {off[name]:.6g} {units[name]}" for name in shown if name in self.hold]
        place = ", ".join(f"{name} = {value:.6g}" for name, value in list(zip([*self.point.states, *self.vary], values))[:6])
        free = [name for name in self.point.inputs if name not in self.vary]
        remedy = f"or an input that balances it, as vary={free[:1]}" if free else "or fewer values that are held" if self.hold else "or other parameters"
        return f"{self.point.name} has no equilibrium near the guess: {', '.join(rates + missed) or 'the rates vanish only at infinity'} where the search ends, at {place}; expected another guess, {remedy}"


def equilibrium(system, guess, hold, vary):
    with opened(system, dict(guess), what="rest there") as point:
        names = [*dict.fromkeys([*point.settable, *point.outputs])]
        known(hold, names, point.description, "is not a state, output, input or parameter")
        hold = numbers_of(hold, point.units)
        known(vary, [name for name in point.settable if name not in point.states], point.description, "is no input or parameter")
        for name in vary:
            if name in hold:
                raise Problem(f"'{name}' is held and varies; expected one of these")
        sought = {name: value for name, value in hold.items() if name in (*point.states, *point.outputs)}
        point.values |= {name: value for name, value in hold.items() if name not in point.outputs}
        search = _Search(point, sought, list(vary))
        values = search.run()
        count, free = len(point.states), search.undetermined(values) if vary else []
        if free:
            warnings.warn(f"equilibria near the guess exist for any {' and '.join(free)} within limits: these are the nearest; expected fewer values in vary, or more in hold", stacklevel=2)
        point.values |= dict(zip(point.states, values[:count])) | dict(zip(vary, values[count:]))
        linear, eigenvalues, stability = None, np.empty(0), "undecided"
        try:
            linear = linearization_at(point)
            eigenvalues, stability = stability_of(_scaled(linear, point.nominals))
        except SwitchesEverywhere:
            search.go_to(values)
        own = dict(zip(point.states, values[:count])) | dict(zip(point.inputs, point.read(point.inputs))) | dict(zip(vary, values[count:]))
        found = own | {name: value for name, value in point.values.items() if name not in point.states}
        outputs = dict(zip(point.outputs, point.read(point.outputs)))
        plain = [{name: float(value) + 0.0 for name, value in one.items()} for one in (found, outputs)]  # 0 has no sign
        return Equilibrium(*plain, linear, eigenvalues, stability, point.constraining())
