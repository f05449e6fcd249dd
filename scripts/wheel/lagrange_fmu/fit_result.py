"""Hold the result of a fit, and write it as text, as a page, and as a system."""

import base64
import html
import io
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from .problem import Problem
from .whole_files import write_whole


@dataclass(frozen=True, repr=False)
class Fit:
    """
    Fitted values with their uncertainties, in SI units; print() shows them.

    Examples
    --------
    >>> fit.values["l"], fit.deviations["l"]
    >>> fit.write_page("fit.html")
    """

    values: dict  # fitted values by name
    deviations: dict  # standard deviations; infinite for a value that the data do not determine
    intervals: dict  # confidence intervals of 95 %, (low, high), within the limits
    correlation: np.ndarray  # in the order of the values
    undetermined: list  # undetermined directions, each a dict of changes by name: changes together that do not change the measured motion
    data: list  # the structured array of each experiment
    motions: list  # for each experiment the measured names, and the fitted motion at the times of the data
    rms: dict  # root mean square of the residuals, by measured name
    name: str  # of the system
    system: object  # path of the system; None for an FMU
    shared: list  # names of the values that all experiments have in common
    at_limit: tuple = ()  # names of values at their limits
    remarks: tuple = ()  # warnings about the result, a sentence each
    is_finished: bool = True  # False if the search ended before convergence

    def __str__(self):
        width = max(map(len, self.values))
        lines = [f"{name.ljust(width)}  {self._value_text(name)}" for name in self.values]
        lines += [f"residual of {name}: {rms:.3g} (root of mean square)" for name, rms in self.rms.items()]
        return "\n".join([*lines, *map(direction_text, self.undetermined), *self.remarks])

    __repr__ = __str__

    def _value_text(self, name):
        value, deviation, (low, high) = self.values[name], self.deviations[name], self.intervals[name]
        if not np.isfinite(deviation):
            return f"{value:.9g} is not determined"
        end = f"at most {high:.3g}" if value == low else f"at least {low:.3g}"
        return f"{value:.9g} at its limit, {end}" if name in self.at_limit else f"{value:.9g} +- {deviation:.3g}"

    def write_system(self, path):
        """
        Write the system with the fitted values that all experiments share as its start values.

        Parameters
        ----------
        path : path
            The file to write.

        Returns
        -------
        Path
            The path of the file.

        Raises
        ------
        Problem
            If an FMU was fitted, or the file does not name a value outside of <for> and <include>.
        """
        if self.system is None:
            raise Problem("an FMU does not contain its system; fit the system itself to write it")
        tree = ElementTree.parse(self.system, ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True)))
        for name in self.shared:
            element, attribute = _start_of(tree, name)
            if element is None:
                raise Problem(f"{self.system} does not name '{name}' outside of <for> and <include>; expected a <parameter>, <input> or <coordinate>")
            element.set(attribute, repr(float(self.values[name])))
        text = io.StringIO()
        tree.write(text, encoding="unicode")
        return write_whole(path, text.getvalue())

    def write_page(self, path):
        """
        Write a page with plots of data, fit and residuals, and the table of values; needs matplotlib.

        Parameters
        ----------
        path : path
            The page to write.

        Returns
        -------
        Path
            The path of the page.
        """
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{self._value_text(name)}</td><td>{low:.6g} ... {high:.6g}</td></tr>" for name, (low, high) in self.intervals.items()
        )
        remarks = "".join(f"<p>{html.escape(remark)}</p>" for remark in [*map(direction_text, self.undetermined), *self.remarks])
        text = f"""<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Fit of {html.escape(self.name)}</title>
<style>:root{{color-scheme:light dark}}body{{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}}td,th{{padding:.2rem 1rem .2rem 0;text-align:left}}img{{max-width:100%;background:#fff}}</style>
</head><body><h1>Fit of {html.escape(self.name)}</h1><table><tr><th>name</th><th>value and standard deviation</th><th>95 % interval</th></tr>{rows}</table>{remarks}
<img alt="data, fit and residuals" src="data:image/png;base64,{_picture(self)}"></body></html>"""
        return write_whole(path, text)


def direction_text(direction):
    """Return a sentence about an undetermined direction."""
    if len(direction) == 1:
        return f"not determined by the data: {next(iter(direction))}, which does not change the measured variables"
    changes = ", ".join(f"{name} by {change:.4g}" for name, change in direction.items())
    return f"not determined by the data: {' and '.join(direction)}, which may change together ({changes}) without a change of the measured variables"


def _start_of(tree, name):
    """Return the element that gives a start value, and the name of its attribute; (None, None) if there is none."""
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
