"""Compute time-optimal motions, and controllers in closed loop, each with a CSV and a plot; for scripts/optimize."""

import argparse
import sys
import tempfile
import time
from pathlib import Path

import fmpy
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from scripts.pages.html_page import write_csv
from optimization.closed_loop import BALANCED, CONTROLLERS, DELAY, NOISE, PERIOD, TRACK, plant_of, run
from optimization.collocation import least_time, play_back
from optimization.tasks import CART, TASKS, with_values

from scripts.library.problem import Problem
from scripts.library.quantities import assignment
from scripts.library.simulation import picture_of
from scripts.library.whole_files import write_whole

BUILD = Path(__file__).resolve().parent.parent.parent / "build"
FOLDER = BUILD / "results"
CONTROL = "control"  # the task of the controllers; all others are time-optimal motions
COLORS = plt.rcParams["axes.prop_cycle"].by_key()["color"]


def archive(task):
    places = (BUILD / part / "fmu" / f"{task.fmu}.fmu" for part in (".", "optimization"))
    return next(path for path in places if path.exists())


def write_motion(path, task, motion, played):
    """Write a row for each boundary of an interval, with the inputs of the interval that follows."""
    header, inputs = ["time", *task.inputs, *task.states, *(f"{name} played back" for name in task.states)], [*motion.inputs, motion.inputs[-1]]
    write_csv(path, header, ([now, *values, *states, *again] for now, values, states, again in zip(motion.times, inputs, motion.states, played)))


def plot(path, task, motion, played):
    """Plot the optimal coordinates, those of the FMU with the optimal inputs, and the inputs relative to their bounds."""
    figure, (places, inputs) = plt.subplots(2, sharex=True, figsize=(8, 6.5), layout="constrained", height_ratios=(3, 2))
    for k, name in enumerate(task.states[: len(task.states) // 2]):
        places.plot(motion.times, motion.states[:, k], color=COLORS[k], label=name)
        places.plot(motion.times, played[:, k], "o", color=COLORS[k], markersize=3.5, fillstyle="none")
    for k, name in enumerate(task.inputs):
        inputs.stairs(motion.inputs[:, k] / task.strength[k], motion.times, baseline=None, color=COLORS[k], label=f"{name} / {task.strength[k]:g}")
    places.set_title(f"{task.fmu}: {motion.times[-1]:.4g} s; circles: the FMU plays it back")
    inputs.set_xlabel("time [s]")
    inputs.set_ylabel("share of the bound")
    for axes in (places, inputs):
        axes.grid(alpha=0.3)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    write_whole(path, picture_of(figure))
    plt.close(figure)


def find_fastest(name, unpacked, task):
    begin = time.perf_counter()
    motion = least_time(unpacked, task)
    seconds, played = time.perf_counter() - begin, play_back(unpacked, task, motion)
    csv_path, plot_path = (FOLDER / f"fastest-{name}.{kind}" for kind in ("csv", "png"))
    write_motion(csv_path, task, motion, played)
    plot(plot_path, task, motion, played)
    print(f"{task.fmu}: {motion.times[-1]:.6g} s; {motion.iterations} iterations of IPOPT in {seconds:.3g} s")
    print(f"  the co-simulation FMU plays it back to {abs(played - motion.states).max():.1g}\n  CSV   {csv_path}\n  plot  {plot_path}")


def plot_runs(path, runs):
    figure, panels = plt.subplots(3, sharex=True, figsize=(8, 7), layout="constrained")
    for color, (name, found) in zip(COLORS, runs.items()):
        for axes, values in zip(panels, (found.states[:, 0], found.states[:, 1], found.forces)):
            axes.plot(found.times, values, color=color, label=name, linewidth=1)
    for bound in (-TRACK, TRACK):
        panels[0].axhline(bound, color="#888", linestyle="--", linewidth=1)
    for axes, label in zip(panels, ("x [m]", "theta [rad]", "F [N]")):
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    panels[0].set_title(f"The cart at {1 / PERIOD:g} Hz; measured to {NOISE[0] * 1e3:g} mm and {NOISE[1] * 1e3:g} mrad, {DELAY} periods late")
    panels[0].legend(frameon=False)
    panels[-1].set_xlabel("time [s]")
    write_whole(path, picture_of(figure))
    plt.close(figure)


def control(unpacked, task):
    """Run all controllers with the same noise."""
    plant = plant_of(unpacked, task)
    runs = {name: run(unpacked, plant, controller(plant), task) for name, controller in CONTROLLERS.items()}
    csv_path, plot_path = (FOLDER / f"closed-loop.{kind}" for kind in ("csv", "png"))
    columns = [f"{name} {variable}" for name in runs for variable in (*CART.states, "F")]
    rows = np.column_stack([next(iter(runs.values())).times, *(np.column_stack([found.states, found.forces]) for found in runs.values())])
    write_csv(csv_path, ["time", *columns], ([f"{value:.9g}" for value in row] for row in rows))
    plot_runs(plot_path, runs)
    for name, found in runs.items():
        middle, late = 1e6 * np.quantile(found.seconds, (0.5, 0.999))
        print(f"{name}: x reaches {abs(found.states[:, 0]).max():.3g} m of {TRACK:g} m; in the last second theta stays within {abs(found.states[-round(1 / PERIOD):, 1]).max():.2g} rad")
        print(f"  observer and controller take {middle:.3g} us of a period's {1e6 * PERIOD:g}, in 99.9 % at most {late:.3g} us")
    print(f"  CSV   {csv_path}\n  plot  {plot_path}")


def words(arguments):
    """Return the names of the tasks, and the values by name, of a command line; raise Problem for other words."""
    names, values = [word for word in arguments if "=" not in word], [word for word in arguments if "=" in word]
    for name in names:
        if name not in (*TASKS, CONTROL):
            raise Problem(f"there is no task '{name}'; expected {', '.join(TASKS)} or {CONTROL}, and values such as l=40cm")
    try:
        return names or [*TASKS, CONTROL], dict(map(assignment, values))
    except argparse.ArgumentTypeError as problem:
        raise Problem(str(problem)) from None


def main():
    names, values = words(sys.argv[1:])
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in names:
        with tempfile.TemporaryDirectory() as unpacked:
            task = TASKS.get(name, BALANCED)
            fmpy.extract(str(archive(task)), unpacked)
            task = with_values(task, values, fmpy.read_model_description(unpacked))
            if name == CONTROL:
                control(unpacked, task)
            else:
                find_fastest(name, unpacked, task)
        sys.stdout.flush()


if __name__ == "__main__":
    try:
        main()
    except Problem as problem:
        sys.exit(f"scripts/optimize: {problem}")
