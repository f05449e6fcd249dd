"""Simulate an FMU with FMPy, and write a CSV, a plot and an animation of its motion. Also a module of the wheel."""

import inspect
import io
import math
import re
import sys
import textwrap
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from zipfile import BadZipFile

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.model_description import ModelDescription
from numpy.lib.recfunctions import repack_fields

from .co_simulation import EVENTS, OPTIONS, Interrupted, co_simulate
from .exchange import Failed, exchange
from .feedback import is_feedback
from .live_page.description import read_tree, scene_of, variables_of_scene
from .live_page.page import page_of_motion
from .problem import Problem, Unfinished
from .signals import signals_of
from .variables import checked_start, elements, suggestion, known, names_of, near_file, numbers_by_name, start_values, startable, units_of
from .whole_files import write_whole


WORDS = ("start_values", "output", "input", "hold", "fmi_type", "fmi", "solver", "step", "tolerance")  # arguments of lagrange_fmu.simulate, for messages
TYPES = ("CoSimulation", "ModelExchange")
TAKEN = ("filename", "fmi_type", "fmu_instance", "start_values", "input", "output", "set_input_derivatives")  # arguments of simulate_fmu that have other names here
FMPY = tuple(name for name in inspect.signature(simulate_fmu).parameters if name not in TAKEN)  # options of simulate_fmu that are passed on
ROWS = 500  # rows of a simulation, if neither the FMU nor the user gives a step
ENERGIES = ("kineticEnergy", "potentialEnergy", "totalEnergy")
FLAT = 15.0  # largest ratio of the magnitudes in a panel, so that no curve is flat
LEVEL = 1e-6  # changes below this share of the magnitude are drawn as constant
MOST_NAMES, MOST_EVENTS = 8, 100  # names and events that a panel shows
WIDEST_TITLE = 75  # letters
STOPPED = "-stopped.csv"  # suffix of the CSV of a simulation that stopped before its end


@dataclass
class Motion:
    """A simulated motion of an FMU."""

    fmu: Path
    description: ModelDescription
    tree: ElementTree.Element  # root of modelDescription.xml
    start: dict  # start values by name
    outputs: np.ndarray  # structured array of the time and the outputs
    values: np.ndarray  # the same, with the positions of drawn elements, energies and the number of events, if the FMU has them


NOTES = ("moved to fulfil the constraints", "is redundant")  # in the FMU's messages on start values and on forces that the motion does not determine


def print_problem(*words):
    """Print a log message of FMI 2.0 or 3.0, if it is a warning, an error, or one of NOTES about the start."""
    *_, status, _, message = words
    text = message.decode().replace("%%", "%")
    if status > 0 or any(note in text for note in NOTES):
        print(text, file=sys.stderr)


def described(fmu):
    """Return the model description of an FMU; raise Problem if the file is missing or not an FMU."""
    if not Path(fmu).exists():
        raise Problem(f"there is no file {fmu}{near_file(fmu) or '; expected an FMU'}")
    try:
        return read_model_description(fmu)
    except (BadZipFile, KeyError):
        raise Problem(f"{fmu} is not an FMU, which is a zip archive with a modelDescription.xml; expected one that a tool has exported, or a system to build") from None


def experiment_of(description, start_time=None, stop_time=None, output_interval=None):
    """Return start time, stop time and step of a simulation in s; values that are None come from the FMU's experiment."""
    experiment = description.defaultExperiment
    start, stop, step = (
        float(next((value for value in (given, getattr(experiment, name, None), default) if value is not None), math.nan))
        for given, name, default in ((start_time, "startTime", 0.0), (stop_time, "stopTime", None), (output_interval, "stepSize", None))
    )
    stop = start + 1.0 if math.isnan(stop) else stop
    step = (stop - start) / ROWS if math.isnan(step) else step
    if not (math.isfinite(start) and start < stop < math.inf and 0 < step < math.inf):
        raise Problem(f"the simulation is from {start:g} s to {stop:g} s by {step:g} s; expected a later end, and a step above 0")
    return start, stop, step


def tolerance_of(description, tolerance=None):
    """Return the relative tolerance, by default that of the FMU's experiment; None if there is neither."""
    tolerance = tolerance or getattr(description.defaultExperiment, "tolerance", None)
    try:
        return tolerance and float(tolerance)
    except (TypeError, ValueError):
        raise Problem(f"the tolerance is {tolerance!r}; expected a number between 0 and 1") from None


def log_into(problems):
    """Return a logger that appends errors to the list `problems`, and prints warnings."""

    def log(*words):
        *_, status, _, message = words
        if status > 1:
            problems.append(message.decode().replace("%%", "%"))
        else:
            print_problem(*words)

    return log


def _failure_message(fmu, problems, exception):
    """Return the message of a failed simulation: the FMU's error messages, or, without any, the failed call."""
    return f"{fmu}: {'; '.join(dict.fromkeys(problems)) or exception}"


def _check_options(options, allowed):
    for name in options:
        if name not in allowed:
            raise Problem(f"'{name}' is not an option of this simulation; {suggestion(name, [*WORDS, *allowed], 'expected one of these')}")


def settings_of(fmu, settings):
    """Return start values and parameters of an FMU, texts with units too, as numbers by name; raise Problem if one cannot be set."""
    settings = numbers_by_name(settings)
    if not settings:
        return {}
    description = described(fmu)
    return checked_start(settings, description, startable(description))


def simulate(fmu, start, /, output=None, input=None, hold=False, fmi_type="CoSimulation", **options):
    """
    Return the Motion of an FMU from start values by name, over its experiment.

    `output` has the names of the variables to record, in place of all outputs. `input` is a table or function for signals_of(), whose values are
    held between rows or over each step if `hold`; or a function for Feedback. The options are those of co_simulate(), or in model exchange of simulate_fmu() of FMPy.
    Raise Problem, or Unfinished if the simulation stops.
    """
    if fmi_type not in TYPES:
        raise Problem(f"the type '{fmi_type}' is not known; {suggestion(fmi_type, TYPES, 'expected one of these')}")
    description = described(fmu)
    if description.fmiVersion[0] not in "23":
        raise Problem(f"{fmu} is of FMI {description.fmiVersion}; expected an FMU of FMI 2.0 or 3.0")
    is_own = fmi_type == "CoSimulation"
    _check_options(options, OPTIONS if is_own else FMPY)
    start = checked_start(start, description, startable(description))
    names = [variable.name for variable in description.modelVariables]
    outputs = [variable.name for variable in description.modelVariables if variable.causality == "output"]
    outputs = outputs if output is None else [name for name in known(names_of(output, "output"), ["time", *names], description) if name != "time"]
    begin, stop, step = experiment_of(description, *(options.pop(name, None) for name in ("start_time", "stop_time", "output_interval")))
    feedback = input if is_feedback(input) else None
    if feedback and not is_own:
        raise Problem("the input is a function of the time and the simulation; expected co-simulation, whose steps begin with its values")
    signals = None if input is None or feedback else signals_of(input, description, begin, hold)
    tree = read_tree(fmu)
    recorded = list(dict.fromkeys([*outputs, *(name for name in (*variables_of_scene(scene_of(tree)), *ENERGIES, EVENTS) if name in names)]))
    starts = start_values(description) | {name: value for name, value in start.items() if np.ndim(value) == 0}

    def motion_with(values):
        return Motion(fmu, description, tree, starts, scalars(repack_fields(values[["time", *outputs]])), scalars(values))

    problems = []
    options = {"logger": log_into(problems), "debug_logging": True} | options
    try:
        if is_own:
            tolerance = tolerance_of(description, options.pop("relative_tolerance", None))
            values = co_simulate(fmu, description, start, signals, recorded, step, begin, stop, tolerance, feedback=feedback, **options)
        else:
            values = exchange(fmu, description, start, signals, recorded, step, begin, stop, **options)
    except (FMICallException, Failed) as problem:
        raise Problem(_failure_message(fmu, problems, problem)) from None
    except Interrupted as interrupted:
        raise Unfinished(_failure_message(fmu, problems, interrupted), motion_with(interrupted.reached)) from None
    for problem in problems:
        print(problem, file=sys.stderr)
    return motion_with(values)


def families_of(names):
    """Return by name "x[]" for x[1], x[2], ..., if these are too many for a legend, and "" for all other names."""
    of = {name: re.sub(r"\[[^]]*\]", "[]", name) for name in names}
    members = Counter(of.values())
    return {name: family if members[family] > MOST_NAMES + 1 else "" for name, family in of.items()}


def scalars(values):
    """Return a structured array in which each element of an array is a field."""
    shapes = {name: values.dtype[name].shape for name in values.dtype.names}
    if not any(shapes.values()):
        return values
    columns = {element: column for name in shapes for element, column in zip(elements(name, shapes[name]), values[name].reshape(len(values), -1).T)}
    return np.rec.fromarrays(list(columns.values()), names=list(columns)).view(np.ndarray)


def sizes_of(unit_of, result):
    """Return the magnitude of each variable; 0 if it is at the level of rounding errors of the largest variable of its unit."""
    size = {name: np.nanmax(abs(result[name])) for name in result.dtype.names[1:]}
    most = {unit: max(size[name] for name in size if unit_of[name] == unit) for unit in map(unit_of.get, size)}
    return {name: value if value > 1e-9 * most[unit_of[name]] else 0.0 for name, value in size.items()}


def panels_of(description, result):
    """
    Return the panels of a plot as (unit, names).

    A panel has variables of one unit whose magnitudes differ by at most a factor of FLAT; a zero variable fits any panel. Arrays of many elements
    have their own panel.
    """
    unit_of = units_of(description)
    size = sizes_of(unit_of, result)
    family = families_of(size)
    panels = []
    for name in size:
        for unit, names in panels:
            sizes = [size[other] for other in (*names, name) if size[other] > 0]
            fits = family[name] or not sizes or max(sizes) <= FLAT * min(sizes)
            if unit == unit_of[name] and family[names[0]] == family[name] and fits:
                names.append(name)
                break
        else:
            panels.append((unit_of[name], [name]))
    return sorted(panels, key=lambda panel: list(unit_of.values()).index(panel[0]))


def event_times(values):
    """Return the times of the rows at which the number of events has increased."""
    if EVENTS not in values.dtype.names:
        return []
    return values["time"][1:][np.diff(values[EVENTS]) > 0]


def draw(axis, result, names, size):
    """
    Draw curves whose magnitude is `size`, with a legend.

    Of an array with many elements the legend has the first and the last, and colours run from dark to bright. Otherwise it has MOST_NAMES names.
    """
    from matplotlib import colormaps

    family, all_named = any(families_of(names).values()), len(names) <= MOST_NAMES + 1
    for i, name in enumerate(names):
        named = all_named or (i in (0, len(names) - 1) if family else i < MOST_NAMES)
        color = colormaps["viridis"](0.9 * i / (len(names) - 1)) if family else f"C{i}" if named else "#bbb"
        axis.plot(result["time"], result[name], linewidth=1.2, color=color, label=name if named else "_", zorder=2 if named else 1.5)
        if family and i == 0:
            axis.plot([], [], " ", label=f"and {len(names) - 2} between")
    if not family and not all_named:
        axis.plot([], [], " ", label=f"and {len(names) - MOST_NAMES} others")
    low, high = (limit([limit(result[name]) for name in names]) for limit in (np.nanmin, np.nanmax))
    if size == 0 or high - low < LEVEL * size:
        axis.set_ylim(low - (size or 1) / 2, high + (size or 1) / 2)


def figure_of(description, result, events=()):
    """Return a figure with the panels of panels_of(), legends beside them, and dotted lines at events."""
    from .picture import Picture

    panels, sizes = panels_of(description, result), sizes_of(units_of(description), result)
    figure = Picture(figsize=(9, 1.2 + 1.9 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    for (unit, names), axis in zip(panels, axes):
        for time in events if len(events) <= MOST_EVENTS else []:
            axis.axvline(time, color="#999", linestyle=":", linewidth=0.8, zorder=0)
        draw(axis, result, names, max(map(sizes.get, names)))
        axis.set_ylabel(f"[{unit}]")
        axis.ticklabel_format(useOffset=False)
        axis.grid(alpha=0.3)
        axis.legend(loc="upper left", bbox_to_anchor=(1, 1.03), fontsize="small", frameon=False)
    words = "events are dotted" if len(events) <= MOST_EVENTS else "events are too many to be marked"
    title = textwrap.fill(description.description or description.modelName, WIDEST_TITLE)
    axes[0].set_title(title + (f"\n{words}" if len(events) else ""))
    axes[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    return figure


def csv_of(values):
    text = io.StringIO()
    np.savetxt(text, values, delimiter=",", header=",".join(values.dtype.names), comments="", fmt="%.17g")
    return text.getvalue()


def picture_of(figure):
    """Return the figure as bytes of a PNG."""
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=120)
    return picture.getvalue()


def write_results(motion, folder):
    """Write CSV, plot and animation of a Motion into the folder; return by kind, with "FMU", the path or the reason why there is none."""
    name, result = motion.description.modelName, motion.outputs
    csv, plot, animation, stopped = ((folder / f"{name}{end}").resolve() for end in (".csv", ".png", "-motion.html", STOPPED))
    write_whole(csv, csv_of(result))
    stopped.unlink(missing_ok=True)
    written = {"FMU": Path(motion.fmu).resolve(), "CSV": csv, "plot": plot, "animation": animation}
    try:
        write_whole(plot, picture_of(figure_of(motion.description, result, event_times(motion.values))))
    except ModuleNotFoundError:
        plot.unlink(missing_ok=True)
        written["plot"] = "none, since matplotlib is not installed: pip install matplotlib"
    if scene_of(motion.tree):
        write_whole(animation, page_of_motion(motion.tree, motion.values, motion.start))
    else:
        animation.unlink(missing_ok=True)
        written["animation"] = "none, since the system has no particles, bodies, frames or points"
    return written


def write_motion(simulated, folder):
    """
    Write the results of the Motion that simulated() returns, as write_results() does.

    If the simulation stops, write its rows to NAME-stopped.csv, delete older results, and raise Unfinished.
    """
    try:
        motion = simulated()
    except Unfinished as unfinished:
        motion = unfinished.motion
        name, until = motion.description.modelName, motion.outputs["time"][-1]
        path = write_whole(folder / f"{name}{STOPPED}", csv_of(motion.outputs))
        for end in (".csv", ".png", "-motion.html"):
            (folder / f"{name}{end}").unlink(missing_ok=True)
        raise Unfinished(f"{unfinished}; the motion until {until:.9g} s is in {path}", motion) from None
    return write_results(motion, folder)


def print_results(written):
    for kind, path in written.items():
        print(f"{kind:10} {path}")
