"""Simulating an FMU with FMPy; a CSV, a plot and an animation of its motion. Also a module of the wheel."""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.model_description import ModelDescription
from numpy.lib.recfunctions import repack_fields

from .animation.page import write_animation
from .animation.scene import read_scene, variables_of
from .problem import Problem
from .variables import settable, start_values, why_not


@dataclass
class Motion:
    fmu: Path
    description: ModelDescription
    scene: list  # the elements to be seen
    start: dict  # the start values of all that have one
    outputs: np.ndarray  # structured: time and the outputs
    values: np.ndarray  # likewise, with where the elements are


def start_value(text):
    name, separator, value = text.partition("=")
    if not separator:
        raise argparse.ArgumentTypeError(f"'{text}' is not VARIABLE=VALUE")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{value}' for '{name}' is not a number") from None


def print_problem(environment, instance_name, status, category, message):
    """A logger that leaves out what is no problem."""
    if status > 0:
        print(message.decode().replace("%%", "%"), file=sys.stderr)


def simulate(fmu, start, **options):
    """The Motion of an FMU from start values by name, over its experiment; options are those of simulate_fmu of FMPy."""
    description = read_model_description(fmu)
    known, free = [variable.name for variable in description.modelVariables], settable(description)
    for name in start:
        if name not in free:
            what = f"'{name}' of {description.modelName} cannot be set" if name in known else f"'{name}' is not a variable of {description.modelName}"
            raise Problem(f"{what}{why_not(name, description)}; these can be: {', '.join(free)}")
    scene = read_scene(fmu)
    outputs = [variable.name for variable in description.modelVariables if variable.causality == "output"]
    try:
        values = simulate_fmu(
            fmu,
            start_values=start,
            output=outputs + variables_of(scene, known),
            fmi_type="CoSimulation",
            logger=print_problem,
            debug_logging=True,
            **options,
        )
    except FMICallException as problem:
        raise Problem(f"{fmu}: {problem}") from None
    return Motion(fmu, description, scene, start_values(description) | start, repack_fields(values[["time", *outputs]]), values)


def draw(description, result, path):
    """One axis a unit, one line an output."""
    from matplotlib.figure import Figure

    unit_of = {variable.name: variable.unit or "1" for variable in description.modelVariables}
    units = list(dict.fromkeys(unit_of[name] for name in result.dtype.names[1:]))
    figure = Figure(figsize=(8, 1.2 + 1.8 * len(units)))
    axes = figure.subplots(len(units), sharex=True, squeeze=False)
    for unit, axis in zip(units, axes[:, 0]):
        for name in result.dtype.names[1:]:
            if unit_of[name] == unit:
                axis.plot(result["time"], result[name], label=name)
        axis.set_ylabel(f"[{unit}]")
        axis.grid(alpha=0.3)
        axis.legend(loc="upper right", ncols=2, fontsize="small")
    axes[0, 0].set_title(description.description or description.modelName)
    axes[-1, 0].set_xlabel("time [s]")
    figure.tight_layout()
    figure.savefig(path, dpi=120)


def write_results(motion, folder):
    """Writes them into the folder; the path of each kind, the FMU's too, or why there is none."""
    folder.mkdir(parents=True, exist_ok=True)
    name, result = motion.description.modelName, motion.outputs
    csv, plot, animation = ((folder / f"{name}.{kind}").resolve() for kind in ("csv", "png", "html"))
    np.savetxt(csv, result, delimiter=",", header=",".join(result.dtype.names), comments="", fmt="%.17g")
    written = {"FMU": Path(motion.fmu).resolve(), "CSV": csv, "plot": plot, "animation": animation}
    try:
        draw(motion.description, result, plot)
    except ModuleNotFoundError:
        plot.unlink(missing_ok=True)
        written["plot"] = "none, since matplotlib is not installed: pip install matplotlib"
    if motion.scene:
        write_animation(animation, motion.description, motion.scene, motion.values, motion.start)
    else:
        animation.unlink(missing_ok=True)
        written["animation"] = "none, since the system has no particles, bodies, frames or points"
    return written


def print_results(written):
    for kind, path in written.items():
        print(f"{kind:10} {path}")
