"""Parameters and start values from measurements, by least squares with the derivatives of the motion."""

import base64
import html
import io
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from .building import system_file
from .experiment import Experiment, check_noise
from .problem import Problem
from .running import is_fmu
from .sensitivity import check_names, check_once  # first, since it tells where SciPy is missing
from .variational import followed, motion

from scipy.optimize import least_squares  # isort: skip
from scipy.stats import t as student  # isort: skip

UNTOLD = 1e-7  # of the largest singular value: a direction of values which the data do not tell
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Fit:
    """Values by name in SI units, and how well the data tell them."""

    values: dict
    deviations: dict  # standard deviations; infinite for what the data do not tell
    intervals: dict  # of 95 %, (low, high)
    correlation: np.ndarray  # in the order of the values
    untold: list  # directions, as shares by name: values may change so together, and the motion stays
    data: list  # of each experiment the structured array
    motions: list  # likewise: measured names and the fitted motion at these times
    rms: dict  # of the residuals, by measured name
    name: str
    system: object  # its file; None of an FMU
    shared: list  # the names of the values that all experiments have

    def __str__(self):
        width = max(map(len, self.values))
        lines = [f"{name.ljust(width)}  {value:.9g} +- {self.deviations[name]:.3g}" for name, value in self.values.items()]
        lines += [f"residual of {name}: {rms:.3g} (root of mean square)" for name, rms in self.rms.items()]
        lines += [f"not told by the data: {' and '.join(shares)}{' together' if len(shares) > 1 else ''}" for shares in self.untold]
        return "\n".join(lines)

    def write_system(self, path):
        """The system with the fitted values as its start values, but for those that each experiment has of its own."""
        if self.system is None:
            raise Problem("an FMU does not hold its system; fit the system itself to have it written")
        tree = ElementTree.parse(self.system, ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True)))
        for name in self.shared:
            element, attribute = _start_of(tree, name)
            if element is None:
                raise Problem(f"{self.system} does not name '{name}' outside of <for> and <include>; expected a <parameter>, <input> or <coordinate>")
            element.set(attribute, repr(float(self.values[name])))
        tree.write(path, encoding="unicode")
        return Path(path)

    def write_page(self, path):
        """Data, fit and residuals, and the table of values."""
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{value:.9g}</td><td>{self.deviations[name]:.3g}</td><td>{low:.6g} ... {high:.6g}</td></tr>"
            for (name, value), (low, high) in zip(self.values.items(), self.intervals.values())
        )
        untold = "".join(f"<p>The data do not tell {html.escape(' and '.join(shares))} apart.</p>" for shares in self.untold)
        text = f"""<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Fit of {html.escape(self.name)}</title>
<style>:root{{color-scheme:light dark}}body{{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}}td,th{{padding:.2rem 1rem .2rem 0;text-align:left}}img{{max-width:100%;background:#fff}}</style>
</head><body><h1>Fit of {html.escape(self.name)}</h1><table><tr><th>name</th><th>value</th><th>standard deviation</th><th>95 % interval</th></tr>{rows}</table>{untold}
<img alt="data, fit and residuals" src="data:image/png;base64,{_picture(self)}"></body></html>"""
        Path(path).write_text(text, encoding="utf-8")
        return Path(path)


def _start_of(tree, name):
    """The element that gives a start value, and its attribute."""
    for element in tree.getroot():
        if element.tag in ("parameter", "input", "coordinate") and element.get("name") == name:
            return element, "start"
        if element.tag == "coordinate" and element.get("velocity") == name:
            return element, "velocityStart"
    return None, None


def _picture(fit):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    names = list(fit.rms)
    figure, axes = pyplot.subplots(2, len(names), figsize=(5 * len(names), 6), squeeze=False, sharex="col", layout="constrained", height_ratios=(2, 1))
    for data, (measured, motion) in zip(fit.data, fit.motions):
        for i, name in enumerate(measured):
            above, below = axes[:, names.index(name)]
            above.plot(data["time"], data[name], ".", markersize=3, color="tab:gray", label="data")
            above.plot(data["time"], motion[:, i], color="tab:blue", label="fit")
            below.plot(data["time"], data[name] - motion[:, i], ".", markersize=3, color="tab:red")
            above.set_title(name)
            below.set(xlabel="time in s", ylabel="data - fit")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles[:2], labels[:2], loc="outside upper right", ncols=2)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    pyplot.close(figure)
    return base64.b64encode(buffer.getvalue()).decode()


class _Fitted(Experiment):
    """With the motion that is to meet it, and the places of what this is differentiated by among all values that are sought."""

    def __init__(self, data, point, by, places, noise):
        super().__init__(data, point, noise)
        check_names(point, self.measured, by)
        self.motion, self.by, self.places = motion(point, self.measured, by, TOLERANCE), by, places

    def run(self, values):
        """Residuals in units of the noise, and their derivatives by all values."""
        found, slopes = self.motion.over(self.data["time"], dict(zip(self.by, values[self.places])), self.signals, self.kinks())
        self.found = found
        everywhere = np.zeros((np.count_nonzero(self.is_measured), len(values)))
        everywhere[:, self.places] = (slopes / self.noise[:, None])[self.is_measured]
        return self.off(found)[self.is_measured], everywhere

    def first(self, name):
        """What was measured first; None of what was not measured."""
        return next(value for value in self.data[name] if np.isfinite(value)) if name in self.measured else None


class _Search:
    """All experiments at values, which the search asks for residuals and for derivatives one after the other."""

    def __init__(self, point, sets, vary, each, noise):
        self.names = [*vary, *(f"{name} of experiment {number}" for number in range(1, len(sets) + 1) for name in each)]
        self.kinds = [*vary, *(name for _ in sets for name in each)]  # as the FMU names them
        self.experiments, self.at = [], None
        for number, data in enumerate(sets):
            own = len(vary) + number * len(each)
            self.experiments.append(_Fitted(data, point, [*vary, *each], [*range(len(vary)), *range(own, own + len(each))], noise))
        check_noise(noise, self.experiments)
        self.begin = dict(zip(self.names, point.given(self.kinds, point.start())))
        for experiment in self.experiments:
            measured = {self.names[place]: experiment.first(self.kinds[place]) for place in experiment.places[len(vary) :]}
            self.begin |= {name: value for name, value in measured.items() if value is not None}

    def bounds(self, point, given):
        """Low ones and high ones; where it begins is within them."""
        limits = [given.get(kind, point.limits[kind]) for kind in self.kinds]
        for (name, value), (low, high) in zip(self.begin.items(), limits):
            if not low <= value <= high or not low < high:
                raise Problem(f"'{name}' begins at {value:g}, and its bounds are {low:g} and {high:g}; expected a start value between them")
        return np.array(limits, dtype=float).T

    def run(self, values):
        if self.at is None or (self.at != values).any():
            parts = [experiment.run(values) for experiment in self.experiments]
            self.at, self.residuals, self.slopes = values.copy(), np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])

    def residuals_at(self, values):
        self.run(values)
        return self.residuals

    def slopes_at(self, values):
        self.run(values)
        return self.slopes


def fit(system, data, vary, start_values, bounds, noise, each):
    sets = list(data) if isinstance(data, (list, tuple)) else [data]
    vary, each = list(vary), list(each)
    if not vary and not each:
        raise Problem("nothing varies; expected the names of parameters or start values")
    if {*vary} & {*each}:
        raise Problem(f"'{min({*vary} & {*each})}' varies for all experiments and for each; expected one of these")
    check_once([*vary, *each])
    for name in bounds:
        if name not in (*vary, *each):
            raise Problem(f"'{name}' has bounds and does not vary; expected bounds of {', '.join([*vary, *each])}")
    with followed(system, dict(start_values), [*vary, *each]) as point:
        search = _Search(point, sets, vary, each, noise)
        limits = search.bounds(point, bounds)
        found = least_squares(search.residuals_at, [*search.begin.values()], search.slopes_at, bounds=limits, x_scale="jac", xtol=1e-12, ftol=1e-12, gtol=1e-12)
        search.run(found.x)
        return _result(found.x, search, vary, system, point.name, bool(noise))


def _result(values, search, shared, system, name, noise_is_known):
    slopes, residuals, names = search.slopes, search.residuals, search.names
    freedom = max(1, len(residuals) - len(values))
    variance = 1.0 if noise_is_known else residuals @ residuals / freedom
    scale = np.where(values != 0, abs(values), 1.0)
    _, singular, directions = np.linalg.svd(slopes * scale, full_matrices=False)
    is_told = singular > UNTOLD * singular.max() if singular.max() > 0 else np.zeros(len(singular), bool)
    untold = [{names[k]: share for k, share in enumerate(direction) if abs(share) > 0.1} for direction in directions[~is_told]]
    inner = directions[is_told] / singular[is_told, None]
    covariance = variance * (inner.T @ inner) * np.outer(scale, scale)
    deviations = np.sqrt(np.diag(covariance))
    for shares in untold:
        deviations[[names.index(name) for name in shares]] = np.inf
    length = np.where(np.isfinite(deviations) & (deviations > 0), deviations, 1.0)
    width = student.ppf(0.975, freedom) * deviations
    rms = {}
    for experiment in search.experiments:
        for i, measured in enumerate(experiment.measured):
            rms.setdefault(measured, []).append((experiment.found - experiment.values)[experiment.is_measured[:, i], i])
    return Fit(
        dict(zip(names, values.tolist())),
        dict(zip(names, deviations.tolist())),
        dict(zip(names, zip((values - width).tolist(), (values + width).tolist()))),
        covariance / np.outer(length, length),
        untold,
        [experiment.data for experiment in search.experiments],
        [(experiment.measured, experiment.found) for experiment in search.experiments],
        {measured: float(np.sqrt(np.mean(np.concatenate(parts) ** 2))) for measured, parts in rms.items()},
        name,
        None if is_fmu(system) else system_file(system),
        shared,
    )
