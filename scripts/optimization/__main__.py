"""What scripts/optimize prints: motions in least time, each with a CSV and a plot."""

import csv
import sys
import tempfile
import time
from pathlib import Path

import fmpy
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from optimization.collocation import least_time, play_back
from optimization.tasks import TASKS

BUILD = Path(__file__).resolve().parent.parent.parent / "build"
FOLDER = BUILD / "results"
COLORS = plt.rcParams["axes.prop_cycle"].by_key()["color"]


def archive(task):
    places = (BUILD / part / "fmu" / f"{task.fmu}.fmu" for part in (".", "optimization"))
    return next(path for path in places if path.exists())


def write_csv(path, task, motion, played):
    """A row for each end of an interval, with the inputs from there on."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time", *task.inputs, *task.states, *(f"{name} played back" for name in task.states)])
        inputs = [*motion.inputs, motion.inputs[-1]]
        writer.writerows([now, *values, *states, *again] for now, values, states, again in zip(motion.times, inputs, motion.states, played))


def plot(path, task, motion, played):
    """The coordinates, as they were found and as the FMU plays them back, and the inputs as shares of their bounds."""
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
    figure.savefig(path, dpi=120)
    plt.close(figure)


def main():
    names = sys.argv[1:] or list(TASKS)
    for name in names:
        if name not in TASKS:
            sys.exit(f"scripts/optimize: there is no task '{name}'; expected {', '.join(TASKS)}")
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in names:
        task, begin = TASKS[name], time.perf_counter()
        with tempfile.TemporaryDirectory() as unpacked:
            fmpy.extract(str(archive(task)), unpacked)
            motion = least_time(unpacked, task)
            played = play_back(unpacked, task, motion)
        csv_path, plot_path = (FOLDER / f"fastest-{name}.{kind}" for kind in ("csv", "png"))
        write_csv(csv_path, task, motion, played)
        plot(plot_path, task, motion, played)
        print(f"{task.fmu}: {motion.times[-1]:.6g} s; {motion.iterations} iterations of IPOPT in {time.perf_counter() - begin:.3g} s")
        print(f"  the co-simulation FMU plays it back to {abs(played - motion.states).max():.1g}\n  CSV   {csv_path}\n  plot  {plot_path}", flush=True)


if __name__ == "__main__":
    main()
