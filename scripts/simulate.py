"""Simulates an FMU with FMPy and leaves a CSV, a plot and an animation: simulate.py FMU [VARIABLE=VALUE ...]"""

import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from numpy.lib.recfunctions import repack_fields

from animation.page import write_animation
from animation.scene import read_scene, variables_of
from variables import settable, start_values, why_not


def start_value(text):
    name, separator, value = text.partition("=")
    if not separator:
        raise argparse.ArgumentTypeError(f"'{text}' is not VARIABLE=VALUE")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{value}' for '{name}' is no number") from None


def print_problem(environment, instance_name, status, category, message):
    """A logger that leaves out what is no problem."""
    if status > 0:
        print(message.decode().replace("%%", "%"), file=sys.stderr)


def draw(description, result, path):
    """One axis a unit, one line an output."""
    unit_of = {variable.name: variable.unit or "1" for variable in description.modelVariables}
    units = list(dict.fromkeys(unit_of[name] for name in result.dtype.names[1:]))
    figure, axes = plt.subplots(len(units), sharex=True, squeeze=False, figsize=(8, 1.2 + 1.8 * len(units)))
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


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path)
    parser.add_argument("start", nargs="*", type=start_value, metavar="VARIABLE=VALUE")
    arguments = parser.parse_args()

    description = read_model_description(arguments.fmu)
    known, free = [variable.name for variable in description.modelVariables], settable(description)
    for name, _ in arguments.start:
        if name not in free:
            what = f"'{name}' of {description.modelName} cannot be set" if name in known else f"'{name}' is no variable of {description.modelName}"
            sys.exit(f"scripts/run: {what}{why_not(name, description)}; these can be: {', '.join(free)}")
    scene = read_scene(arguments.fmu)
    outputs = [variable.name for variable in description.modelVariables if variable.causality == "output"]
    try:
        motion = simulate_fmu(
            arguments.fmu,
            start_values=dict(arguments.start),
            output=outputs + variables_of(scene, known),
            fmi_type="CoSimulation",
            logger=print_problem,
            debug_logging=True,
        )
    except FMICallException as problem:
        sys.exit(f"{arguments.fmu}: {problem}")

    folder = Path("build/results")
    folder.mkdir(parents=True, exist_ok=True)
    csv, plot, animation = (folder / f"{description.modelName}.{kind}" for kind in ("csv", "png", "html"))
    result = repack_fields(motion[["time", *outputs]])
    np.savetxt(csv, result, delimiter=",", header=",".join(result.dtype.names), comments="", fmt="%.17g")
    draw(description, result, plot)
    print(f"FMU        {arguments.fmu.resolve()}\nCSV        {csv.resolve()}\nplot       {plot.resolve()}")
    if scene:
        write_animation(animation, description, scene, motion, start_values(description) | dict(arguments.start))
        print(f"animation  {animation.resolve()}")
    else:
        animation.unlink(missing_ok=True)
        print("animation  none, since the system has no particles, bodies, frames or points")


if __name__ == "__main__":
    main()
