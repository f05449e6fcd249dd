"""
Compare programs that simulate many runs of several systems, on one core.

The programs are the lanes of src/ensemble, the FMU, run by run, heyoka's batch mode in as many lanes, MuJoCo's rollout, and SciPy. The table has the
processor time of a run in microseconds, without compilation: the shortest of several repeats in turns. It also has the largest difference of the
velocities at the end from those of the FMU.
"""

import itertools
import time
from typing import NamedTuple

import fmpy
import numpy as np
from scipy.integrate import solve_ivp

from fmu import ROOT, archive
from scripts.library.ensembles import Ensemble, lanes_here, source_of
from scripts.commands.sweep import compile_ensemble
from scripts.library.sweeping.worker import Instance, run_by_fmi, states_of

TOLERANCE, REPEATS, STEP = 1e-10, 5, 1e-3  # STEP: step of MuJoCo in s
RUNNER = ROOT / "build" / "libsweep_runs.so"
LANES = lanes_here(RUNNER)
G = 9.81


class System(NamedTuple):
    varied: dict  # ranges of start values and parameters by name
    end: float  # s
    runs: int
    mathematics: object  # function of (sin, cos, q, v) that returns the accelerations; None if they are too long to write by hand
    bodies: str = ""  # in MJCF; the joints are the coordinates
    bounces: bool = False  # True for impacts at q = 0 with restitution e, which is varied last


def pendulum(sin, cos, q, v):
    return [-G * sin(q[0])]


def orbit(sin, cos, q, v):
    return [q[0] * v[1] ** 2 - 1 / q[0] ** 2, -2.0 * v[0] * v[1] / q[0]]


def cart(sin, cos, q, v, big=1.0, small=0.1, length=0.5):
    """Solve (M + m) x'' + m l cos(theta) theta'' = m l sin(theta) theta'^2 and l theta'' + cos(theta) x'' = g sin(theta)."""
    s, c = sin(q[1]), cos(q[1])
    x = (small * length * s * v[1] ** 2 - small * G * s * c) / (big + small * s * s)
    return [x, (G * s - c * x) / length]


def ball(sin, cos, q, v):
    return [-G + 0.0 * q[0]]


def body(joints, mass, arm, inner=""):
    return f'<body>{joints}<inertial pos="0 0 {arm}" mass="{mass}" diaginertia="1e-12 1e-12 1e-12"/>{inner}</body>'


HINGE, SLIDE = '<joint type="hinge" axis="0 {} 0"/>', '<joint type="slide" axis="1 0 0"/>'
SYSTEMS = {
    "SimplePendulum": System({"theta": (-3, 3)}, 10.0, 4000, pendulum, body(HINGE.format(-1), 1, -1)),
    "ParticlePolar": System({"omega": (0.8, 1.2)}, 10.0, 4000, orbit),
    "InvertedPendulumCart": System({"theta": (-3, 3)}, 3.0, 4000, cart, body(SLIDE, 1, 0, body(HINGE.format(1), 0.1, 0.5))),
    "RobotArm": System({"w[1]": (-1, 1), "w[3]": (-1, 1)}, 1.0, 400, None),
    "BouncingBall": System({"h": (1, 2), "e": (0.75, 0.9)}, 2.0, 4000, ball, bounces=True),
}


def timed(function):
    begin = time.process_time()
    result = function()
    return time.process_time() - begin, result


class Lanes:
    def __init__(self, name, system):
        description = fmpy.read_model_description(archive(name))
        reference = {v.name: v.valueReference for v in description.modelVariables}
        varied, recorded = ([reference[name] for name in names] for names in (system.varied, states_of(description)))
        self.ensemble = Ensemble(compile_ensemble(source_of(archive(name)), LANES), varied, recorded, [system.end], TOLERANCE)

    def run(self, rows):
        return timed(lambda: self.ensemble.run(rows)[0][:, 0])


class Fmu:
    def __init__(self, name, system):
        self.instance, self.names = Instance(archive(name).read_bytes(), RUNNER.read_bytes()), list(system.varied)
        self.settings = {"tolerance": TOLERANCE, "stop": system.end, "times": [system.end], "records": []}

    def run(self, rows):
        return timed(lambda: run_by_fmi(self.instance, rows, self.names, self.settings).ends)


class Starts:
    """Start states of runs, in the order of the FMU's states."""

    def __init__(self, name, system):
        description = fmpy.read_model_description(archive(name))
        self.names, self.system = states_of(description), system
        start = {v.name: v.start for v in description.modelVariables}
        self.default = np.array([float(start[state] or 0) for state in self.names])

    def states(self, rows):
        states = np.tile(self.default, (len(rows), 1))
        for column, name in zip(rows.T, self.system.varied):
            if name in self.names:
                states[:, self.names.index(name)] = column
        return states


restitution = np.empty(LANES)  # restitution of each run in heyoka's lanes; global, since heyoka copies callbacks with their closures


def bounce(batch, sign, lane):
    batch.state[1, lane] *= -restitution[lane]
    return True


class Heyoka(Starts):
    """heyoka's batch mode; a bounce is a terminal event with a callback in Python, after which the lane continues."""

    def __init__(self, name, system):
        import heyoka

        super().__init__(name, system)
        self.n = len(self.default) // 2
        variables = heyoka.make_vars(*[f"x{i}" for i in range(2 * self.n)])
        q, v = variables[: self.n], variables[self.n :]
        rates = list(zip(variables, [*v, *system.mathematics(heyoka.sin, heyoka.cos, q, v)]))
        events = {}
        if system.bounces:
            events["t_events"] = [heyoka.t_event_batch(q[0], direction=heyoka.event_direction.negative, callback=bounce)]
        self.batch = heyoka.taylor_adaptive_batch(rates, np.ones((2 * self.n, LANES)), tol=TOLERANCE, **events)

    def run(self, rows):
        return timed(lambda: self.ends(rows, self.states(rows)))

    def ends(self, rows, states):
        ends = np.empty_like(states)
        for first in range(0, len(rows), LANES):
            some = slice(first, first + LANES)
            restitution[:] = rows[some, -1]
            self.batch.set_time(0.0)
            if self.system.bounces:
                self.batch.reset_cooldowns()
            self.batch.state[:] = states[some].T
            self.batch.propagate_until(self.system.end)
            ends[some] = self.batch.state.T
        return ends


class MuJoCo(Starts):
    """MuJoCo's rollout, for fewer runs, since they are slow."""

    runs = 40

    def __init__(self, name, system):
        import mujoco
        from mujoco.rollout import rollout

        super().__init__(name, system)
        option = f'<option timestep="{STEP}" integrator="RK4" gravity="0 0 -{G}"><flag contact="disable"/></option>'
        text = f"<mujoco>{option}<worldbody>{system.bodies}</worldbody></mujoco>"
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data, self.rollout = mujoco.MjData(self.model), rollout
        self.full = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self.size = mujoco.mj_stateSize(self.model, self.full)

    def run(self, rows):
        states = self.states(rows)
        full = np.zeros((len(rows), self.size))
        full[:, 1 : 1 + states.shape[1]] = states
        steps = round(self.system.end / STEP)
        seconds, (found, _) = timed(lambda: self.rollout(self.model, self.data, full, nstep=steps))
        return seconds, found[:, -1, 1 : 1 + states.shape[1]]


class Scipy(Starts):
    """SciPy's DOP853, for fewer runs, since they are slow."""

    runs = 8

    def run(self, rows):
        states = self.states(rows)
        return timed(lambda: np.array([self.end(*run) for run in zip(states, rows)]))

    def end(self, state, row):
        n, time_now = len(state) // 2, 0.0
        right_side = lambda t, x: [*x[n:], *self.system.mathematics(np.sin, np.cos, x[:n], x[n:])]
        hit = lambda t, x: x[0]
        hit.terminal, hit.direction = True, -1
        while True:
            solution = solve_ivp(right_side, (time_now, self.system.end), state, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE, events=hit if self.system.bounces else None)
            time_now, state = solution.t[-1], solution.y[:, -1]
            if solution.status == 0:
                return state
            state = np.array([1e-12, -row[-1] * state[1]])  # slightly above 0, so that the same event is not found again


def programs_for(name, system):
    programs = {f"{LANES} lanes": Lanes, "the FMU": Fmu}
    if system.mathematics is not None:
        programs |= {f"heyoka, {LANES} lanes": Heyoka, "SciPy DOP853": Scipy}
    if system.bodies:
        programs["MuJoCo rollout, RK4, 1 ms"] = MuJoCo
    return {label: program(name, system) for label, program in programs.items()}


def measure(name, system):
    """Return by program the microseconds of a run and the largest difference from the FMU."""
    generator = np.random.default_rng(0)
    rows = np.array([generator.uniform(*span, system.runs) for span in system.varied.values()]).T
    programs = programs_for(name, system)
    best, ends = dict.fromkeys(programs, np.inf), {}
    for _, (label, program) in itertools.product(range(REPEATS), programs.items()):
        some = rows[: getattr(program, "runs", len(rows))]
        seconds, ends[label] = program.run(some)
        best[label] = min(best[label], seconds / len(some) * 1e6)
    n = ends["the FMU"].shape[1] // 2
    return {label: (best[label], np.max(np.abs(ends[label][:, n:] - ends["the FMU"][: len(ends[label]), n:]))) for label in programs}


def main():
    results = {name: measure(name, system) for name, system in SYSTEMS.items()}
    labels = [*dict.fromkeys(label for result in results.values() for label in result)]
    print(f"\n| us a run, difference | {' | '.join(labels)} |")
    print("| --- |" + " ---: |" * len(labels))
    for name, result in results.items():
        cells = [f"{result[label][0]:.3g}" + ("" if label == "the FMU" else f", {result[label][1]:.0e}") if label in result else "" for label in labels]
        print(f"| {name}, {SYSTEMS[name].end:g} s | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
