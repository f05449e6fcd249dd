"""
Compute frequency responses and step responses of a linearized system.

The transfer function is G(s) = C (s - A)^-1 B + D. The step response is exact at its times. The exponential of [[A, B], [0, 0]] h maps (x, u) from a
time to the next one, by scaling and squaring of its Taylor series.
"""

from dataclasses import dataclass

import numpy as np

from .problem import Problem
from .variables import suggestion, names_of

POINTS = 400  # number of points of a default grid
BEYOND = 10.0  # factor by which default frequencies extend beyond those of the poles on both sides
DECAYS, PERIODS = 7.0, 6.0  # time constants, or periods, of the slowest pole in the default time
LARGEST_RATIO = 1e4  # poles smaller than the largest one by more than this factor do not count for the default time
TERMS = 18  # terms of the Taylor series, for a norm of at most 1/2: the rest is below 1e-22
SMALL = 1e-7  # poles below this share of the largest one count as integrators


@dataclass(frozen=True, eq=False)
class Responses:
    """Responses of each output to each input; response["theta", "F"] is an array over frequencies or times, response["theta"] that to the only input."""

    values: np.ndarray  # x outputs x inputs
    outputs: list[str]
    inputs: list[str]
    title: str

    def __getitem__(self, names):
        output, *rest = names if isinstance(names, tuple) else (names,)
        if len(rest) > 1:
            raise Problem(f"[{', '.join(map(repr, names))}] has {len(names)} names; expected an output and an input")
        if not rest and len(self.inputs) > 1:
            raise Problem(f"there are several inputs; expected [{output!r}, {self.inputs[0]!r}] or another of {', '.join(self.inputs)}")
        return self.values[:, _index(output, self.outputs, "an output"), _index(rest[0] if rest else self.inputs[0], self.inputs, "an input")]

    def _repr_png_(self):
        return self.plot()._repr_png_()

    def _pairs(self):
        for i, output in enumerate(self.outputs):
            for j, of in enumerate(self.inputs):
                yield f"{output} by {of}", self.values[:, i, j]


@dataclass(frozen=True, eq=False)
class Bode(Responses):
    """A frequency response: `values` are complex, at the `frequency` in rad/s."""

    frequency: np.ndarray

    @property
    def magnitude(self):
        return np.abs(self.values)

    @property
    def phase(self):
        """Phase in degrees, a continuous function of the frequency."""
        return np.degrees(np.unwrap(np.angle(self.values), axis=0))

    def plot(self):
        """Return a figure of magnitude, in dB, and phase."""
        figure = _figure(self.title, 2)
        for (name, _), magnitude, phase in zip(self._pairs(), *(part.reshape(len(self.frequency), -1).T for part in (self.magnitude, self.phase))):
            with np.errstate(divide="ignore"):
                figure.axes[0].semilogx(self.frequency, 20 * np.log10(magnitude), label=name)
            figure.axes[1].semilogx(self.frequency, phase)
        return _labelled(figure, ["magnitude [dB]", "phase [deg]"], "frequency [rad/s]")


@dataclass(frozen=True, eq=False)
class StepResponses(Responses):
    """The response to a unit step of an input at the time 0, as the change of the outputs at the `time` in s."""

    time: np.ndarray

    def plot(self):
        """Return a figure with a panel for each output."""
        figure = _figure(self.title, len(self.outputs))
        for axis, output in zip(figure.axes, self.outputs):
            for of in self.inputs:
                axis.plot(self.time, self[output, of], label=f"{output} by {of}")
            axis.legend(fontsize="small", frameon=False)
        return _labelled(figure, self.outputs, "time [s]")


def _index(name, names, what):
    if name not in names:
        raise Problem(f"'{name}' is not {what} of the linearization; {suggestion(name, names)}")
    return names.index(name)


def _figure(title, rows):
    try:
        from .picture import Picture
    except ModuleNotFoundError:
        raise Problem("matplotlib is not installed; it comes with pip install matplotlib") from None
    figure = Picture(figsize=(9, 1.2 + 2.2 * rows), layout="constrained")
    figure.subplots(rows, sharex=True, squeeze=False)
    figure.axes[0].set_title(title)
    return figure


def _labelled(figure, labels, below):
    for axis, label in zip(figure.axes, labels):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    figure.axes[-1].set_xlabel(below)
    if not figure.axes[0].get_legend():
        figure.axes[0].legend(fontsize="small", frameon=False)
    return figure


def _title(what, linear):
    return what + (f"\nwith {', '.join(linear.constraints)} closed or sticking" if linear.constraints else "")


def _selected(linear, of, by):
    """Return the names of outputs and inputs, by default all, and their indices."""
    chosen = []
    for names, given, what in ((linear.outputs, of, "output"), (linear.inputs, by, "input")):
        own = list(names) if given is None else names_of(given, what)
        places = [_index(name, names, f"an {what}") for name in own]
        if not own:
            raise Problem(f"the linearization has no {what}; expected a system with an <{what}>")
        chosen += [own, places]
    return chosen


def poles(linear):
    """Return the eigenvalues of A, the slowest ones first."""
    found = np.linalg.eigvals(linear.A)
    return found[np.lexsort((found.imag, found.real, np.abs(found)))]


def _rates(linear):
    """Return the poles that are not 0."""
    found = poles(linear)
    return found[np.abs(found) > SMALL * np.abs(found).max(initial=0.0)] if len(found) else found


def _frequencies(linear):
    """Return a grid of frequencies around the poles, with their own."""
    own = np.abs(_rates(linear))
    low, high = (own.min() / BEYOND, own.max() * BEYOND) if len(own) else (1 / BEYOND, BEYOND)
    return np.unique([*np.geomspace(low, high, POINTS), *own])


def _transfer(linear, columns, s):
    try:
        return linear.C @ np.linalg.solve(s * np.eye(len(linear.A)) - linear.A, linear.B[:, columns]) + linear.D[:, columns]
    except np.linalg.LinAlgError:  # at a pole without damping
        return np.full((len(linear.C), len(columns)), complex(np.inf, 0.0))


def _increasing(values, what, least):
    try:
        values = np.asarray(values, dtype=float).ravel()
    except (TypeError, ValueError):
        raise Problem(f"the {what} are {values!r}; expected numbers, such as numpy.geomspace(0.1, 100, 200)") from None
    if not len(values) or not np.isfinite(values).all() or values[0] < least or (np.diff(values) <= 0).any():
        raise Problem(f"the {what} are not finite, increasing and at least {least:g}; expected numbers such as numpy.geomspace(0.1, 100, 200)")
    return values


def bode(linear, of, by, frequencies):
    outputs, rows, inputs, columns = _selected(linear, of, by)
    grid = _frequencies(linear) if frequencies is None else _increasing(frequencies, "frequencies", 0.0)
    values = np.array([_transfer(linear, columns, 1j * frequency)[rows] for frequency in grid])
    return Bode(values, outputs, inputs, _title("frequency response", linear), grid)


def exponential(matrix):
    """Return e^matrix."""
    norm = np.linalg.norm(matrix, 1)
    squarings = max(0, int(np.ceil(np.log2(2 * norm)))) if norm > 0 else 0
    term = total = np.eye(len(matrix))
    for k in range(1, TERMS + 1):
        term = term @ matrix / (k * 2.0**squarings)
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


def _duration(linear):
    """Return the default time in s: DECAYS time constants, or PERIODS periods, of the slowest pole that counts."""
    own = _rates(linear)
    own = own[np.abs(own) > np.abs(own).max(initial=0.0) / LARGEST_RATIO]
    if not len(own):
        return 1.0
    decay, swing = np.abs(own.real), np.abs(own.imag)
    is_damped = decay > SMALL * np.abs(own)
    return max(DECAYS / decay[is_damped].min() if is_damped.any() else 0.0, PERIODS * 2 * np.pi / swing[~is_damped].min() if not is_damped.all() else 0.0)


def step(linear, of, by, times):
    outputs, rows, inputs, columns = _selected(linear, of, by)
    grid = np.linspace(0, _duration(linear), POINTS + 1) if times is None else _increasing(times, "times", 0.0)
    n, m = linear.B.shape[0], len(columns)
    whole = np.zeros((n + m, n + m))
    whole[:n] = np.hstack([linear.A, linear.B[:, columns]])
    state, values, known = np.vstack([np.zeros((n, m)), np.eye(m)]), [], {}
    for length in np.diff(grid, prepend=0.0):
        if length not in known:
            known[length] = exponential(whole * length)
        state = known[length] @ state
        values.append(linear.C[rows] @ state[:n] + linear.D[np.ix_(rows, columns)])
    return StepResponses(np.array(values), outputs, inputs, _title("response to a unit step", linear), grid)
