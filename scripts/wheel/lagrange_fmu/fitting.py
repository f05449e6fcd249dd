"""Parameters and start values from measurements, by least squares with the derivatives of the motion."""

import base64
import html
import io
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from .building import system_file
from .experiment import Experiment
from .model_exchange import opened
from .problem import Problem
from .running import is_fmu
from .sensitivity import Motion, check_names  # first, since it tells where SciPy is missing

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

    def __str__(self):
        width = max(map(len, self.values))
        lines = [f"{name.ljust(width)}  {value:.9g} +- {self.deviations[name]:.3g}" for name, value in self.values.items()]
        lines += [f"residual of {name}: {rms:.3g} (root of mean square)" for name, rms in self.rms.items()]
        lines += [f"not told by the data: {' and '.join(shares)} together" for shares in self.untold]
        return "\n".join(lines)

    def write_system(self, path):
        """The system with the fitted values as its start values."""
        if self.system is None:
            raise Problem("an FMU does not hold its system; fit the system itself to have it written")
        tree = ElementTree.parse(self.system, ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True)))
        for name, value in self.values.items():
            element, attribute = _start_of(tree, name)
            if element is None:
                raise Problem(f"{self.system} does not name '{name}' outside of <for> and <include>; expected a <parameter>, <input> or <coordinate>")
            element.set(attribute, repr(float(value)))
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
    """With the motion that is to meet it."""

    def __init__(self, data, point, vary, noise):
        super().__init__(data, point, noise)
        check_names(point, self.measured, vary)
        self.motion = Motion(point, self.measured, vary, TOLERANCE)

    def run(self, values):
        """Residuals in units of the noise, and their derivatives."""
        found, slopes = self.motion.over(self.data["time"], values, self.signals, self.kinks())
        self.found = found
        return ((found - self.values) / self.noise).ravel(), (slopes / self.noise[:, None]).reshape(found.size, -1)


class _Runs:
    """All experiments at values, which the search asks for residuals and for derivatives one after the other."""

    def __init__(self, experiments, vary):
        self.experiments, self.vary, self.at = experiments, vary, None

    def run(self, values):
        if self.at is None or (self.at != values).any():
            parts = [experiment.run(dict(zip(self.vary, values))) for experiment in self.experiments]
            self.at, self.residuals, self.slopes = values.copy(), np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])

    def residuals_at(self, values):
        self.run(values)
        return self.residuals

    def slopes_at(self, values):
        self.run(values)
        return self.slopes


def _bounds(point, vary, given):
    limits = {name: (given[name] if name in given else point.limits.get(name, (-np.inf, np.inf))) for name in vary}
    return np.array([limits[name] for name in vary], dtype=float).T


def fit(system, data, vary, start_values, bounds, noise):
    sets = list(data) if isinstance(data, (list, tuple)) else [data]
    vary = list(vary)
    if not vary:
        raise Problem("nothing varies; expected the names of parameters or start values")
    with opened(system, dict(start_values), what="be followed") as point:
        experiments = [_Fitted(one, point, vary, noise) for one in sets]
        point.start()
        begin = point.read(vary)
        runs = _Runs(experiments, vary)
        found = least_squares(runs.residuals_at, begin, runs.slopes_at, bounds=_bounds(point, vary, bounds), x_scale="jac", xtol=1e-12, ftol=1e-12, gtol=1e-12)
        runs.run(found.x)
        return _result(found.x, runs, system, point.name, bool(noise))


def _result(values, runs, system, name, noise_is_known):
    slopes, residuals, vary = runs.slopes, runs.residuals, runs.vary
    freedom = max(1, len(residuals) - len(values))
    variance = 1.0 if noise_is_known else residuals @ residuals / freedom
    scale = np.where(values != 0, abs(values), 1.0)
    _, singular, directions = np.linalg.svd(slopes * scale, full_matrices=False)
    is_told = singular > UNTOLD * singular.max() if singular.max() > 0 else np.zeros(len(singular), bool)
    untold = [{vary[k]: share for k, share in enumerate(direction) if abs(share) > 0.1} for direction in directions[~is_told]]
    inner = directions[is_told] / singular[is_told, None]
    covariance = variance * (inner.T @ inner) * np.outer(scale, scale)
    deviations = np.sqrt(np.diag(covariance))
    for shares in untold:
        deviations[[vary.index(name) for name in shares]] = np.inf
    length = np.where(np.isfinite(deviations) & (deviations > 0), deviations, 1.0)
    width = student.ppf(0.975, freedom) * deviations
    rms = {}
    for experiment in runs.experiments:
        for i, measured in enumerate(experiment.measured):
            rms.setdefault(measured, []).append(experiment.found[:, i] - experiment.values[:, i])
    return Fit(
        dict(zip(vary, values.tolist())),
        dict(zip(vary, deviations.tolist())),
        dict(zip(vary, zip((values - width).tolist(), (values + width).tolist()))),
        covariance / np.outer(length, length),
        untold,
        [experiment.data for experiment in runs.experiments],
        [(experiment.measured, experiment.found) for experiment in runs.experiments],
        {measured: float(np.sqrt(np.mean(np.concatenate(parts) ** 2))) for measured, parts in rms.items()},
        name,
        None if is_fmu(system) else system_file(system),
    )
