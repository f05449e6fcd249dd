"""
Stabilize the pendulum on its cart by state feedback, in several co-simulation masters.

The gains are those of the linear-quadratic regulator for lagc's linearization. The coupled system runs in a short FMPy script, in FMPy's SSP player
and in libcosim, from a tilted start and after an impulse. Writes a CSV, a plot and an animation.
"""

import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import Parameter, ParameterSet
from matplotlib.animation import FuncAnimation, PillowWriter
from scipy.linalg import solve_continuous_are

from coupling.slaves import FMUS, ROOT, Slave
from scripts.pages.html_page import write_csv

from scripts.library.problem import Problem
from scripts.library.simulation import picture_of
from scripts.library.whole_files import write_whole

SSP = ROOT / "build" / "ssp" / "BalancedCart.ssp"
STATES = ["x", "theta", "v", "omega"]
GAINS = ["kx", "ktheta", "kv", "komega"]
END = 10.0
STARTS = {"leaning": dict(theta=0.2, omega=0.0), "struck": dict(theta=0.0, omega=1.5)}


def linearization():
    """Return A and B of the upright cart, from `lagc --linearize`."""
    words = [ROOT / "build/bin/lagc", "--linearize", ROOT / "fmu/InvertedPendulumCart/system.xml", "--at", "theta=0"]
    text = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    numbers = text[text.index("\nat ") :]
    matrices = re.findall(r"^[AB] =\n((?:  \[.*\]\n?)+)", numbers, re.M)
    return [np.array([[float(x) for x in row.split(",")] for row in re.findall(r"\[(.*)\]", matrix)]) for matrix in matrices]


def lqr_gains():
    """
    Return the gains that minimize the integral of 10 x^2 + 100 theta^2 + v^2 + omega^2 + F^2.

    The continuous algebraic Riccati equation A'P + PA - P B R^-1 B' P + Q = 0 gives the gain R^-1 B' P.
    """
    A, B = linearization()
    Q, R = np.diag([10.0, 100.0, 1.0, 1.0]), np.array([[1.0]])
    gains = np.linalg.solve(R, B.T @ solve_continuous_are(A, B, Q, R))[0]
    assert np.all(np.linalg.eigvals(A - B @ gains[None, :]).real < 0)
    return dict(zip(GAINS, map(float, gains)))


def gains_of_ssp():
    with zipfile.ZipFile(SSP) as archive:
        root = ElementTree.fromstring(archive.read("SystemStructure.ssd"))
    space = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
    values = {p.get("name"): float(p.find(f"{space}Real").get("value")) for p in root.iter(f"{space}Parameter")}
    return {name: values[name] for name in GAINS}


def by_fmpy_script(start, gains, step, controller=None, push=None):
    """Return rows of time and states. The feedback gets the states at the start of the step; push(t) is added to its force."""
    cart, feedback = Slave(FMUS / "InvertedPendulumCart.fmu", **start), Slave(controller or FMUS / "StateFeedback.fmu", **gains)
    rows = [[0.0, *cart.get(*STATES)]]
    for k in range(1, round(END / step) + 1):
        feedback.set(**dict(zip(STATES, rows[-1][1:])))
        feedback.step_to(k * step)  # FMUs of other tools may compute their outputs in doStep only
        cart.set(F=feedback.get("F") + (push(cart.time) if push else 0.0))
        cart.step_to(k * step)
        rows.append([cart.time, *cart.get(*STATES)])
    return np.array(rows)


def by_fmpy_ssp(start, gains, step):
    """Return rows of time and states by FMPy's player, which ignores the parameters in the SSP and starts with inputs of 0."""
    values = [("cart", start), ("feedback", gains)]
    parameters = [Parameter(name=f"{component}.{name}", type="Real", value=str(value))
                  for component, group in values for name, value in group.items()]  # fmt: skip
    parameter_set = ParameterSet(name="start", parameters=parameters)
    result = simulate_ssp(SSP, stop_time=END - step / 2, step_size=step, parameter_set=parameter_set)
    columns = [result["time"] + step, *(result[f"cart.{state}"] for state in STATES)]  # its rows have the time of the step's start
    return np.array(columns).T


def by_libcosim(start, gains, step):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.FATAL)
    nanoseconds = 10**9
    execution = CosimExecution.from_ssp_file(str(SSP), step_size=round(step * nanoseconds))
    cart, feedback = (execution.slave_index_from_instance_name(name) for name in ("cart", "feedback"))
    names = {v.name.decode(): v.reference for v in execution.slave_variables(cart)}
    for slave, values in ((cart, start), (feedback, gains)):
        references = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
        for name, value in values.items():
            execution.real_initial_value(slave, references[name], value)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    rows = []
    for k in range(1, round(END / step) + 1):
        assert execution.simulate_until(round(k * step * nanoseconds))
        rows.append([k * step, *observer.last_real_values(cart, [names[state] for state in STATES])])
    return np.array(rows)


def draw(runs, path):
    figure, axes = plt.subplots(2, sharex=True, figsize=(8, 5))
    # Two runs coincide until the push: a wide pale line stays visible below a narrow dark one.
    styles = [dict(linewidth=5, color="#9ecae1"), dict(linewidth=1.8, color="#f4a261"), dict(linewidth=1.5, color="#1b4332", linestyle="--")]
    for (name, rows), style in zip(runs.items(), styles):
        for axis, column in zip(axes, (1, 2)):
            axis.plot(rows[:, 0], rows[:, column], label=name, **style)
    axes[0].set_ylabel("x [m]")
    axes[1].set_ylabel("theta [rad]")
    axes[1].set_xlabel("time [s]")
    for axis in axes:
        axis.grid(alpha=0.3)
    axes[0].legend()
    figure.tight_layout()
    write_whole(path, picture_of(figure))
    plt.close(figure)


def animate(rows, path, length=0.5):
    """Write an animation of the cart and its rod, at 20 frames per second."""
    frames = rows[:: max(1, round(0.05 / (rows[1, 0] - rows[0, 0])))][:121]
    figure, axis = plt.subplots(figsize=(6, 2.6))
    axis.set_aspect("equal")
    axis.set_xlim(rows[:, 1].min() - 0.6, rows[:, 1].max() + 0.6)
    axis.set_ylim(-0.2, 0.7)
    axis.axhline(-0.08, color="#999", linewidth=1)
    cart = plt.Rectangle((0, -0.08), 0.3, 0.12, color="#2a6f97")
    axis.add_patch(cart)
    (rod,) = axis.plot([], [], "o-", color="#c1121f", linewidth=3, markersize=9, markevery=[1])
    clock = axis.set_title("")

    def show(row):
        time, x, theta = row[:3]
        cart.set_x(x - 0.15)
        rod.set_data([x, x + length * np.sin(theta)], [0.0, length * np.cos(theta)])
        clock.set_text(f"{time:.2f} s")
        return cart, rod, clock

    with tempfile.TemporaryDirectory() as folder:
        moving = Path(folder) / path.name
        FuncAnimation(figure, show, frames, interval=50).save(moving, PillowWriter(fps=20))
        write_whole(path, moving.read_bytes())
    plt.close(figure)


def main():
    gains = lqr_gains()
    print("LQR gains:", ", ".join(f"{name} = {value:.6g}" for name, value in gains.items()))
    masters = {"FMPy's SSP player": by_fmpy_ssp, "libcosim": by_libcosim}
    print("Largest difference of theta to the FMPy script; it shrinks with the step, since masters delay the force differently:")
    runs = {}
    for name, start in STARTS.items():
        for step in (0.01, 0.005, 0.0025):
            rows = by_fmpy_script(start, gains, step)
            others = {master: function(start, gains, step) for master, function in masters.items()}
            text = ", ".join(f"{master} {np.max(np.abs(other[:, 2] - rows[1:, 2])):.2e}" for master, other in others.items())
            print(f"  {name}, step {step:g} s: {text}; theta at {END:g} s: {rows[-1, 2]:.1e}")
        runs[name] = rows
    runs["leaning, pushed by 5 N from 5 s to 5.2 s"] = by_fmpy_script(STARTS["leaning"], gains, 0.0025, push=lambda t: 5.0 * (5.0 <= t < 5.2))
    folder = ROOT / "build" / "results"
    folder.mkdir(parents=True, exist_ok=True)
    paths = {kind: folder / f"BalancedCart.{kind}" for kind in ("csv", "png", "gif")}
    pushed = runs["leaning, pushed by 5 N from 5 s to 5.2 s"]
    write_csv(paths["csv"], ["time", *STATES], ([f"{value:.17g}" for value in row] for row in pushed))
    draw(runs, paths["png"])
    animate(pushed, paths["gif"])
    print(f"SSP        {SSP}\nCSV        {paths['csv']}\nplot       {paths['png']}\nanimation  {paths['gif']}")


if __name__ == "__main__":
    try:
        main()
    except Problem as problem:
        sys.exit(f"scripts/balance: {problem}")
