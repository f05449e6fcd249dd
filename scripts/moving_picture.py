"""Draw the animated picture of the README from simulations: moving_picture.py FOLDER_OF_FMUS PICTURE.gif [SECONDS]"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from fmpy import simulate_fmu
from matplotlib.animation import FuncAnimation, PillowWriter

FRAMES_PER_SECOND = 20
BALLS = 5


def simulate(folder, name, seconds, outputs, start=None):
    """Simulate an FMU; return an array for each output, at the times of the frames."""
    archive = str(folder / f"{name}.fmu")
    result = simulate_fmu(archive, stop_time=seconds, output_interval=1 / FRAMES_PER_SECOND, output=outputs, start_values=start or {})
    return [result[output] for output in outputs]


def cradle(folder, seconds):
    """Return lines(frame) that yields the threads of Newton's cradle, from pivots side by side to the balls; limits of x and y; marker size."""
    angles = simulate(folder, "NewtonsCradle", seconds, [f"theta[{i}]" for i in range(1, BALLS + 1)])
    length, width = 0.2, 0.04

    def lines(frame):
        for i, angle in enumerate(angles):
            pivot = width * (i - (BALLS - 1) / 2)
            yield [pivot, pivot + length * np.sin(angle[frame])], [0, -length * np.cos(angle[frame])]

    return lines, (-0.24, 0.24), (-0.26, 0.04), 15


def double_pendulum(folder, seconds):
    first, second = simulate(folder, "DoublePendulum", seconds, ["theta1", "theta2"], {"theta1": 2.0, "theta2": 2.5})

    def lines(frame):
        x, y = np.sin(first[frame]), -np.cos(first[frame])
        yield [0, x, x + np.sin(second[frame])], [0, y, y - np.cos(second[frame])]

    return lines, (-2.2, 2.2), (-2.3, 2.3), 7


def walker(folder, seconds):
    """Return lines(frame) that yields slope and legs of the walker, as cradle() does; each step moves the stance foot down the slope."""
    names = ["thetaStance", "thetaSwing", "steps"]
    stance, swing, steps = simulate(folder, "PassiveWalker", seconds, names)
    slope, foot = np.radians(3), np.zeros((len(stance), 2))
    for i in range(1, len(stance)):
        foot[i] = foot[i - 1]
        if steps[i] > steps[i - 1]:
            # The swing foot has just struck: the legs are symmetric about the slope's normal.
            way = 2 * np.sin(abs(stance[i - 1] - swing[i - 1]) / 2)
            foot[i] += way * np.array([np.cos(slope), -np.sin(slope)])

    def lines(frame):
        x, y = foot[frame] - foot[frame][0] * np.array([1, -np.tan(slope)])
        hip = (x - np.sin(stance[frame]), y + np.cos(stance[frame]))
        yield [-2, 2], [2 * np.tan(slope), -2 * np.tan(slope)]
        yield [x, hip[0], hip[0] + np.sin(swing[frame])], [y, hip[1], hip[1] - np.cos(swing[frame])]

    return lines, (-1.0, 1.0), (-0.25, 1.25), 7


def draw(scenes, path, frames):
    figure, axes = plt.subplots(1, len(scenes), figsize=(7.2, 2.4))
    drawn = []
    for axis, (lines, across, up, size) in zip(axes, scenes):
        axis.set(xlim=across, ylim=up, aspect="equal")
        axis.axis("off")
        styles = [dict(color="#305080", marker="o", markersize=size, lw=1.5) for _ in lines(0)]
        drawn.append((lines, [axis.plot([], [], **style)[0] for style in styles]))
    figure.subplots_adjust(0, 0, 1, 1, 0.02)

    def update(frame):
        for lines, artists in drawn:
            for artist, (x, y) in zip(artists, lines(frame)):
                artist.set_data(x, y)

    animation = FuncAnimation(figure, update, frames=frames)
    animation.save(path, writer=PillowWriter(fps=FRAMES_PER_SECOND), dpi=80)


def main():
    folder, path = Path(sys.argv[1]), Path(sys.argv[2])
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 6.0
    scenes = [scene(folder, seconds) for scene in (cradle, double_pendulum, walker)]
    draw(scenes, path, int(seconds * FRAMES_PER_SECOND))


if __name__ == "__main__":
    main()
