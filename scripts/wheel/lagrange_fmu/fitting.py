"""
Fit parameters and start values to measurements.

The problem is min_x sum rho(r_i(x)^2) within bounds, where r are the residuals in units of the noise and rho is the loss. SciPy's trust-region
reflective method solves it (M. Branch, T. Coleman, Y. Li: A subspace, interior, and conjugate gradient method for large-scale
bound-constrained minimization problems, 1999). dr/dx comes from the variational equations, or from finite differences where a motion has no
exact derivatives. The search ends at a relative change of 1e-12 in cost, values or gradient. Each iteration costs a motion with its
derivatives for each experiment.
"""

import warnings
from contextlib import ExitStack

import numpy as np
from fmpy.fmi1 import FMICallException

from . import with_scipy  # noqa: F401, first, since it raises Problem if SciPy is missing
from .building import system_file
from .experiment import Experiment, check_noise
from .fit_result import Fit
from .problem import Problem
from .quantities import number_of, numbers_of
from .running import is_fmu
from .sensitivity import check_names, check_once
from .variational import DifferencedMotion, followed, motion, stepped

from scipy.optimize import least_squares  # isort: skip

from .estimates import CORRELATED, correlation_of_rows, estimate, is_misfit, loss_of, without_undetermined  # isort: skip

TOLERANCE = 1e-9  # relative, of the motions
EXACT, DIFFERENCED = 1e-6, 1e-4  # relative errors of slopes: by the variational equations, and by finite differences
FAILURES = (Problem, FMICallException, np.linalg.LinAlgError)


class _Fitted(Experiment):
    """An experiment with its simulated motion. `places[k]` is the index of the parameter `by[k]` among all fitted values."""

    def __init__(self, data, point, by, places, noise, stepper):
        """Prepare the motion of the Point; stepper() returns a Point in co-simulation, for motions without derivatives."""
        super().__init__(data, point, noise)
        check_names(point, self.measured, by)
        self.point, self.by, self.places, self.stepper = point, by, places, stepper
        self.motion, self.why = motion(point, self.measured, by, TOLERANCE), None  # why: the reason for finite differences

    def run(self, values):
        """Simulate the motion and its derivatives. If these fail, simulate without derivatives in this call and all later ones."""
        arguments = self.data["time"], dict(zip(self.by, values[self.places])), self.signals, self.kinks()
        if self.why is None:
            try:
                self.found, self.slopes = _finite(*self.motion.over(*arguments))
                return
            except FAILURES as problem:
                self.point.messages.clear()
                why, plain = str(problem), DifferencedMotion(self.stepper(), self.measured, self.by, TOLERANCE)
        else:
            why, plain = self.why, self.motion
        (self.found,), self.slopes = _finite(plain.values(*arguments)), None
        self.motion, self.why = plain, why

    def residuals(self):
        """Return the residuals of the last run, in units of the noise, without missing measurements."""
        return self.off(self.found)[self.is_measured]

    def slopes_of(self, values):
        """Return the derivatives of the residuals by all fitted values; `values` are those of the last run."""
        if self.slopes is None:
            self.slopes = self.motion.slopes(self.data["time"], dict(zip(self.by, values[self.places])), self.signals, self.kinks(), self.found)
        everywhere = np.zeros((np.count_nonzero(self.is_measured), len(values)))
        everywhere[:, self.places] = (self.slopes / self.noise[:, None])[self.is_measured]
        return everywhere

    def first(self, name):
        """Return the first measurement of a variable; None if it was not measured."""
        return next(value for value in self.data[name] if np.isfinite(value)) if name in self.measured else None


def _finite(*arrays):
    if not all(np.isfinite(array).all() for array in arrays):
        raise Problem("the motion has values that are not finite")
    return arrays


class _Search:
    """
    The least-squares problem of all experiments.

    `best` is None, or the values, slopes and motions of the last accepted step. `at` is None, or the values of the last run, if it succeeded.
    """

    def __init__(self, point, sets, vary, each, noise, stepper):
        self.names = [*vary, *(f"{name} of experiment {number}" for number in range(1, len(sets) + 1) for name in each)]
        self.kinds = [*vary, *(name for _ in sets for name in each)]  # the variable of the FMU for each of `names`
        self.experiments, self.at, self.best, self.failed, self.count = [], None, None, 0, 0
        for number, data in enumerate(sets):
            own = len(vary) + number * len(each)
            self.experiments.append(_Fitted(data, point, [*vary, *each], [*range(len(vary)), *range(own, own + len(each))], noise, stepper))
        check_noise(noise, self.experiments)
        self.begin = dict(zip(self.names, point.given(self.kinds, point.start())))
        for experiment in self.experiments:
            measured = {self.names[place]: experiment.first(self.kinds[place]) for place in experiment.places[len(vary) :]}
            self.begin |= {name: value for name, value in measured.items() if value is not None}
        self.size = sum(np.count_nonzero(experiment.is_measured) for experiment in self.experiments)

    def bounds(self, point, given):
        """Return the bounds, 2 x n; raise Problem if an initial guess is not within them."""
        limits = [given.get(kind, point.limits[kind]) for kind in self.kinds]
        for (name, value), (low, high) in zip(self.begin.items(), limits):
            if not low <= value <= high or not low < high:
                raise Problem(f"the initial value {value:g} of '{name}' is outside its bounds, {low:g} and {high:g}; expected a value between them")
        return np.array(limits, dtype=float).T

    def residuals_at(self, values):
        """Return the residuals of all experiments; NaN, which makes the search take a shorter step, if a motion cannot be computed."""
        self.count, self.at = self.count + 1, None
        try:
            for experiment in self.experiments:
                experiment.run(values)
        except FAILURES as problem:
            if self.best is None:
                raise Problem(f"the motion with the initial values cannot be computed: {problem}") from None
            self.failed += 1
            return np.full(self.size, np.nan)
        self.at = values.copy()
        return np.concatenate([experiment.residuals() for experiment in self.experiments])

    def slopes_at(self, values):
        """Return the slopes of all experiments, and store them in `best`: the search asks for slopes at accepted steps only."""
        if self.at is None or (self.at != values).any():
            self.residuals_at(values)
        slopes = np.concatenate([experiment.slopes_of(values) for experiment in self.experiments])
        self.best = values.copy(), slopes, [experiment.found for experiment in self.experiments]
        return without_undetermined(slopes, self.accuracy)

    @property
    def accuracy(self):
        """Relative error of the slopes."""
        return DIFFERENCED if any(experiment.why for experiment in self.experiments) else EXACT

    def minimize(self, limits, loss):
        """Minimize the loss. Return None after convergence, else a sentence with the reason of the early end."""
        begin = [*self.begin.values()]
        try:
            found = least_squares(self.residuals_at, begin, self.slopes_at, bounds=limits, x_scale="jac", xtol=1e-12, ftol=1e-12, gtol=1e-12, loss=loss)
        except KeyboardInterrupt:
            if self.best is None:
                raise
            return f"stopped after {self.count} motions; the values are the best so far"
        except Problem as problem:
            if self.best is None:
                raise
            return f"ended after {self.count} motions, and the values are the best so far, since no derivatives are found: {problem}"
        return None if found.status > 0 else f"ended after {self.count} motions without convergence; the values are the best so far"


def fit(system, data, vary, start_values, bounds, noise, each, loss="linear"):
    """See lagrange_fmu.fit."""
    sets = list(data) if isinstance(data, (list, tuple)) else [data]
    if not sets:
        raise Problem("data is empty; expected the measurements of one experiment at least")
    vary, each = list(vary), list(each)
    if not vary and not each:
        raise Problem("nothing varies; expected the names of parameters or start values")
    if {*vary} & {*each}:
        raise Problem(f"'{min({*vary} & {*each})}' varies for all experiments and for each; expected one of these")
    check_once([*vary, *each])
    for name in bounds:
        if name not in (*vary, *each):
            raise Problem(f"'{name}' has bounds and does not vary; expected bounds of {', '.join([*vary, *each])}")
    rho = loss_of(loss)
    if loss != "linear" and not noise:
        raise Problem(f"the loss '{loss}' depends on the noise, which is not given; expected the noise of each measured variable")
    with ExitStack() as stack:
        point = stack.enter_context(followed(system, dict(start_values), [*vary, *each]))
        noise = numbers_of(noise, point.units)
        bounds = {name: tuple(number_of(name, end, point.units.get(name, "1"), is_limit=True) for end in ends) for name, ends in bounds.items()}
        for name, (low, high) in bounds.items():
            if not low < high:
                raise Problem(f"the bounds of '{name}' are {low:g} and {high:g}; expected two numbers, the smaller one first")
        steppers = []

        def stepper():
            if not steppers:
                steppers.append(stack.enter_context(stepped(system, dict(start_values))))
            return steppers[0]

        search = _Search(point, sets, vary, each, noise, stepper)
        limits = search.bounds(point, bounds)
        why = search.minimize(limits, rho)
        return _result(search, limits, vary, system, point.name, bool(noise), rho, why)


def _result(search, limits, shared, system, name, noise_is_known, rho, why):
    values, slopes, motions = search.best
    experiments, names = search.experiments, search.names
    off = [experiment.off(found) for experiment, found in zip(experiments, motions)]
    residuals = np.concatenate([part[experiment.is_measured] for part, experiment in zip(off, experiments)])
    found = estimate(values, limits, slopes, residuals, search.accuracy, noise_is_known, rho)
    columns = {}  # by measured name: the noise, and the residuals of each experiment in units of the noise
    for experiment, part in zip(experiments, off):
        for i, measured in enumerate(experiment.measured):
            columns.setdefault(measured, (experiment.noise[i], []))[1].append(part[experiment.is_measured[:, i], i])
    rms = {measured: float(noise * np.sqrt(np.mean(np.concatenate(parts) ** 2))) for measured, (noise, parts) in columns.items()}
    misfits = _misfits(columns, rms) if noise_is_known else []
    if misfits:
        warnings.warn("; ".join(misfits), stacklevel=5)
    ended = [] if why is None else [why]
    return Fit(
        dict(zip(names, found.values.tolist())),
        dict(zip(names, found.deviations.tolist())),
        dict(zip(names, map(tuple, found.intervals.tolist()))),
        found.correlation,
        [{names[k]: float(change) for k, change in enumerate(direction) if change} for direction in found.undetermined],
        [experiment.unwrapped() for experiment in experiments],
        [(experiment.measured, motion) for experiment, motion in zip(experiments, motions)],
        rms,
        name,
        None if is_fmu(system) else system_file(system),
        shared,
        tuple(names[k] for k in np.flatnonzero(found.at_limit)),
        tuple([*ended, *_remarks(search, found), *misfits, *_correlated(columns)]),
        why is None,
    )


def _misfits(columns, rms):
    found = []
    for name, (noise, parts) in columns.items():
        all_of = np.concatenate(parts)
        if is_misfit(all_of @ all_of, len(all_of)):
            found.append(f"misfit: the residual of {name} is {rms[name] / noise:.3g} times its stated noise; the model is incomplete, or the noise is larger. Deviations follow from the residuals")
    return found


def _correlated(columns):
    found = {name: correlation_of_rows(parts) for name, (_, parts) in columns.items()}
    return [
        f"residuals of {name} correlate with those of the row before ({share:.2f}); deviations assume independence and are too small by a factor of about {np.sqrt((1 + share) / (1 - share)):.2g}"
        for name, share in found.items()
        if share > CORRELATED
    ]


def _remarks(search, found):
    if not found.freedom:
        yield "there are no more measured numbers than determined values, so that the noise and the deviations are unknown"
    if search.failed:
        yield f"{search.failed} of {search.count} motions could not be computed, and the search avoided their values"
    reasons = [experiment.why for experiment in search.experiments if experiment.why]
    if reasons:
        yield f"{len(reasons)} of {len(search.experiments)} motions have no exact derivatives; finite differences replace them: {reasons[0]}"
    for experiment in search.experiments:
        for name, time in experiment.wraps.items():
            yield f"'{name}' jumps by a turn at {time:g} s, which was taken for an angle that wraps"
