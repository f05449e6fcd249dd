"""
Swings the pendulum of InvertedPendulumCart up in least time, from hanging at rest to standing at rest in the same place, with bounds on the
force and on the track. CasADi reads the FMU, IPOPT solves the collocated problem with the FMU's derivatives, and the co-simulation FMU plays the
forces back. Leaves a CSV and a plot.
"""

import csv
import math
import tempfile
from pathlib import Path
from typing import NamedTuple

import casadi
import fmpy
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from fmpy.fmi2 import FMU2Slave

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "build" / "results"
FMU = ROOT / "build" / "fmu" / "InvertedPendulumCart.fmu"
STATES = ["x", "theta", "v", "omega"]
HANGING, STANDING = np.array([0.0, math.pi, 0.0, 0.0]), np.zeros(4)
FORCE, TRACK = 15.0, 0.4  # bounds, in N and m
INTERVALS, POINTS = 40, 6  # of constant force; Radau points in each, so that the error at its end is of order 2 * 6 - 1


class Motion(NamedTuple):
    times: np.ndarray  # s, of the intervals' ends
    states: np.ndarray  # rows of x, theta, v, omega there
    forces: np.ndarray  # N, one an interval
    iterations: int  # of IPOPT


def acceleration_function(unpacked):
    """dx/dt of states and force, evaluated by the FMU, with derivatives."""
    builder = casadi.DaeBuilder("cart", str(unpacked), {})
    order = [builder.x().index(name) for name in STATES]
    assert builder.u() == ["F"]
    states, force = casadi.MX.sym("x", 4), casadi.MX.sym("F")
    inner = casadi.vertcat(*(states[STATES.index(name)] for name in builder.x()))
    slopes = builder.create("f", ["x", "u"], ["ode"])(inner, force)
    return casadi.Function("slopes", [states, force], [slopes[order]])


def guess(share):
    """Straight from hanging to standing."""
    return HANGING + share * (STANDING - HANGING)


def swing_up(unpacked, intervals=INTERVALS, points=POINTS):
    """The fastest way that IPOPT finds, by collocation at Radau points."""
    taus = casadi.collocation_points(points, "radau")
    slope_matrix, end_row, _ = casadi.collocation_coeff(taus)
    slopes = acceleration_function(unpacked).map(intervals * points)
    problem = casadi.Opti()
    duration = problem.variable()
    starts, inner, forces = problem.variable(4, intervals + 1), problem.variable(4, intervals * points), problem.variable(1, intervals)
    length = duration / intervals
    rates = length * slopes(inner, casadi.kron(forces, casadi.DM.ones(1, points)))
    for k in range(intervals):
        part = slice(k * points, (k + 1) * points)
        values = casadi.horzcat(starts[:, k], inner[:, part])
        problem.subject_to(casadi.mtimes(values, slope_matrix) == rates[:, part])
        problem.subject_to(starts[:, k + 1] == casadi.mtimes(values, end_row))
    problem.subject_to(starts[:, 0] == HANGING)
    problem.subject_to(starts[:, intervals] == STANDING)
    problem.subject_to(problem.bounded(-FORCE, casadi.vec(forces), FORCE))
    problem.subject_to(problem.bounded(-TRACK, casadi.vec(starts[0, 1:intervals]), TRACK))
    problem.subject_to(problem.bounded(0.5, duration, 10))
    problem.minimize(duration)
    problem.set_initial(duration, 2.0)
    problem.set_initial(starts, np.transpose([guess(k / intervals) for k in range(intervals + 1)]))
    problem.set_initial(inner, np.transpose([guess((k + tau) / intervals) for k in range(intervals) for tau in taus]))
    problem.set_initial(forces, FORCE * np.sin(2 * np.pi * np.arange(intervals) / intervals)[None, :] / 2)
    problem.solver("ipopt", {"print_time": False}, {"tol": 1e-10, "max_iter": 2000, "print_level": 0, "sb": "yes"})
    solution = problem.solve()
    times = np.linspace(0.0, solution.value(duration), intervals + 1)
    return Motion(times, np.transpose(solution.value(starts)), solution.value(forces).ravel(), solution.stats()["iter_count"])


def play_back(unpacked, motion):
    """The states at the intervals' ends by the co-simulation FMU, whose input is the force of each interval."""
    description = fmpy.read_model_description(str(unpacked))
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    cart = FMU2Slave(guid=description.guid, unzipDirectory=str(unpacked), modelIdentifier=description.coSimulation.modelIdentifier, instanceName="cart")
    cart.instantiate()
    cart.setupExperiment(tolerance=1e-12, startTime=0.0)
    places = [references[name] for name in STATES]
    cart.setReal(places, motion.states[0])
    cart.enterInitializationMode()
    cart.exitInitializationMode()
    rows = [cart.getReal(places)]
    for start, end, force in zip(motion.times, motion.times[1:], motion.forces):
        cart.setReal([references["F"]], [force])
        cart.doStep(start, end - start)
        rows.append(cart.getReal(places))
    cart.terminate()
    cart.freeInstance()
    return np.array(rows)


def write_csv(motion, played):
    """A row for each end of an interval, with the force from there on."""
    path = FOLDER / "swing_up.csv"
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "F", *STATES, *(f"{name} played back" for name in STATES)])
        forces = [*motion.forces, motion.forces[-1]]
        writer.writerows([time, force, *states, *again] for time, force, states, again in zip(motion.times, forces, motion.states, played))
    return path


def plot(motion, played):
    figure, (places, angle, force) = plt.subplots(3, sharex=True, figsize=(8, 7), layout="constrained")
    for axes, column, label in ((places, 0, "x [m]"), (angle, 1, "theta [rad]")):
        axes.plot(motion.times, motion.states[:, column], color="#2a6f97", label="collocation")
        axes.plot(motion.times, played[:, column], "o", color="#c1121f", markersize=4, fillstyle="none", label="the FMU plays it back")
        axes.set_ylabel(label)
    for bound in (-TRACK, TRACK):
        places.axhline(bound, color="#888", linestyle="--", linewidth=1)
    force.stairs(motion.forces, motion.times, baseline=None, color="#2a6f97")
    for bound in (-FORCE, FORCE):
        force.axhline(bound, color="#888", linestyle="--", linewidth=1)
    force.set_ylabel("F [N]")
    force.set_xlabel("time [s]")
    places.set_title(f"The pendulum swings up in {motion.times[-1]:.4g} s; bounds are dashed")
    figure.legend(*angle.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    for axes in (places, angle, force):
        axes.grid(alpha=0.3)
    path = FOLDER / "swing_up.png"
    figure.savefig(path, dpi=120)
    plt.close(figure)
    return path


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as unpacked:
        fmpy.extract(str(FMU), unpacked)
        motion = swing_up(unpacked)
        played = play_back(unpacked, motion)
    print(f"swings up in {motion.times[-1]:.6g} s with at most {FORCE:g} N on a track of {2 * TRACK:g} m; {motion.iterations} iterations of IPOPT")
    print(f"the co-simulation FMU plays it back to {abs(played - motion.states).max():.1g}")
    print(f"CSV   {write_csv(motion, played)}\nplot  {plot(motion, played)}")


if __name__ == "__main__":
    main()
