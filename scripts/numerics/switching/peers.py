"""Simulate systems with events by other programs; models are built before the clock starts, and recorded in a run that is not timed."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from numerics.driver import POINTS, step
from numerics.programs import FmpyCvode, with_time_limit, timed

ROUND = 0.02  # s of one program in one round


def repeats_for(seconds):
    """Return the number of runs of a round, for runs of this time in s."""
    return int(min(max(ROUND / seconds, 1), 500))


class Timed:
    """A runner whose simulate() is timed from Python."""

    repeats = 1

    def run(self):
        """Return the seconds of the fastest of several repeats."""
        seconds = min(timed(self.simulate)[0] for _ in range(self.repeats))
        self.repeats = repeats_for(seconds)
        return seconds

    def record(self):
        return self.simulate()


class Fmu:
    """The FMU in a C program with `steps` communication steps; if `importer`, by CVODE in model exchange with as many output points."""

    def __init__(self, problem, tolerance, patience, steps=POINTS, importer=False):
        self.words = ("shipped", problem.system, problem.values, problem.end, tolerance, steps)
        self.names, self.importer, self.patience, self.repeats, self.events = problem.compared, importer, patience, 1, 0

    def run(self):
        """Return the seconds of the fastest of several repeats of the simulation loop."""
        stepped = step(*self.words, self.repeats, 0, importer=self.importer)
        self.repeats = repeats_for(stepped.seconds)
        return stepped.seconds

    def record(self):
        stepped = step(*self.words, 0, timeout=self.patience, importer=self.importer)
        if stepped is None:
            raise RuntimeError("it gave up, or took too long")
        self.events = stepped.events
        return stepped.columns(self.names)


class Fmpy(Timed):
    """The same FMU in model exchange, by FMPy's loop in Python around CVode."""

    def __init__(self, problem, tolerance, patience):
        self.simulate = FmpyCvode(problem.system, problem.values, problem.end, problem.compared, tolerance).simulate


class Scipy(Timed):
    """SciPy, with a call of solve_ivp for each phase, which its event ends."""

    def __init__(self, problem, tolerance, patience):
        self.problem, self.tolerance, self.patience = problem, tolerance, patience
        self.phases = problem.phases(problem.all_values)

    def simulate(self):
        problem, times, begin, state = self.problem, self.problem.times, 0.0, self.problem.start
        name, rows, check = next(iter(self.phases)), [], with_time_limit(lambda: None, self.patience)
        while begin < problem.end:
            check()
            phase = self.phases[name]
            right = lambda t, y: (y[1], phase.acceleration(*y, np))
            solution = solve_ivp(right, (begin, problem.end), state, "DOP853", times[(times > begin)], rtol=self.tolerance,
                                 atol=self.tolerance, events=self.event_of(phase))  # fmt: skip
            rows += list(solution.y[0]) if len(solution.t) else []
            if solution.status != 1:
                break
            begin, (*state, name) = solution.t_events[0][0], phase.leave(*solution.y_events[0][0], self.tolerance)
        return np.array(rows)[:, None]

    @staticmethod
    def event_of(phase):
        if phase.guard is None:
            return None
        event = lambda t, y: phase.guard(*y)
        event.terminal, event.direction = True, -1
        return event


# s, in which heyoka does not detect an event again. Its default misses bounces that are close together; 0 detects an event twice.
COOLDOWN = 1e-12


class Heyoka(Timed):
    """heyoka, with an integrator for each phase, which is compiled before the clock starts; a terminal event ends the phase."""

    def __init__(self, problem, tolerance, patience):
        import heyoka

        heyoka.set_logger_level_error()
        self.problem, self.tolerance, self.patience = problem, tolerance, patience
        self.limit = heyoka.taylor_outcome.time_limit
        self.phases = problem.phases(problem.all_values)
        self.integrators = {name: self.integrator(heyoka, phase) for name, phase in self.phases.items()}

    def integrator(self, heyoka, phase):
        q, v = heyoka.make_vars("q", "v")
        falling = dict(direction=heyoka.event_direction.negative, cooldown=COOLDOWN)
        events = [] if phase.guard is None else [heyoka.t_event(phase.guard(q, v), **falling)]
        right = phase.acceleration(q, v, heyoka)
        return heyoka.taylor_adaptive([(q, v), (v, right + heyoka.expression(0.0))], list(self.problem.start), tol=self.tolerance, t_events=events)

    def begin(self):
        self.name = next(iter(self.phases))
        self.enter(0.0, self.problem.start)

    def enter(self, now, state):
        self.now = self.integrators[self.name]
        self.now.time, self.now.state[:] = now, state

    def go_to(self, end, check):
        while self.now.propagate_until(end)[0] != self.limit:
            check()
            *state, self.name = self.phases[self.name].leave(*self.now.state, self.tolerance)
            self.enter(self.now.time, state)

    def simulate(self):
        self.begin()
        self.go_to(self.problem.end, with_time_limit(lambda: None, self.patience))

    def record(self):
        self.begin()
        check, rows = with_time_limit(lambda: None, self.patience), []
        for time in self.problem.times:
            self.go_to(time, check)
            rows.append([self.now.state[0]])
        return np.array(rows)


def contact_rate(length):
    """
    Return the angular frequency of a contact's spring in rad/s, for a step in s.

    With shorter steps the spring is stiffer, but also resolved by more steps: softness and step size both contribute to the error.
    """
    return 0.3 * (length / 0.01) ** 0.25 / length


def damping_ratio(restitution):
    """
    Return the damping ratio of a spring and damper that gives a restitution; they push only, and a body leaves when their force is 0.

    Source: T. Schwager, T. Pöschel: Coefficient of restitution and linear-dashpot model revisited, 2007.
    """
    def excess(damping):
        rate = np.sqrt(1 - damping**2)
        return -damping / rate * (np.pi - np.arctan2(2 * damping * rate, rate**2 - damping**2)) - np.log(restitution)

    return brentq(excess, 0.0, 0.99)


class MuJoCo(Timed):
    """MuJoCo with soft contacts, as stiff as the steps allow, and with the damping of the restitution."""

    def __init__(self, problem, steps, integrator, patience):
        import mujoco

        self.library, self.problem, self.steps = mujoco, problem, int(steps)
        self.model = mujoco.MjModel.from_xml_string(self.text(problem.end / steps, integrator))
        self.data = mujoco.MjData(self.model)

    def text(self, length, integrator):
        values = self.problem.all_values
        rate = contact_rate(length)
        contact = f'solref="{-(rate**2)!r} {-2 * rate * damping_ratio(values["e"])!r}" solimp="0.9999 0.9999 0.001"'
        return (f'<mujoco><compiler angle="radian"/><option timestep="{length!r}" integrator="{integrator}" gravity="0 0 -{values["g"]!r}"/>'
                f"<worldbody>{self.problem.stiff(values, contact)}</worldbody></mujoco>")  # fmt: skip

    def start(self):
        self.library.mj_resetData(self.model, self.data)
        self.data.qpos[0], self.data.qvel[0] = self.problem.start

    def simulate(self):
        self.start()
        self.library.mj_step(self.model, self.data, self.steps)

    def record(self):
        self.start()
        rows = []
        for _ in range(POINTS):
            self.library.mj_step(self.model, self.data, self.steps // POINTS)
            rows.append([self.data.qpos[0]])
        return np.array(rows)


# Method: (program, function of (problem, tolerance or number of steps, patience) that builds the runner).
METHODS = {
    "FMU": ("FMU", Fmu),
    "FMU, one step": ("FMU", lambda problem, tolerance, patience: Fmu(problem, tolerance, patience, 1)),
    "CVODE in C (model exchange)": ("importer", lambda problem, tolerance, patience: Fmu(problem, tolerance, patience, importer=True)),
    "FMPy CVode (model exchange)": ("importer", Fmpy),
    "SciPy DOP853 with events": ("SciPy", Scipy),
    "heyoka with events": ("heyoka", Heyoka),
    "MuJoCo RK4": ("MuJoCo", lambda problem, steps, patience: MuJoCo(problem, steps, "RK4", patience)),
    "MuJoCo implicitfast": ("MuJoCo", lambda problem, steps, patience: MuJoCo(problem, steps, "implicitfast", patience)),
}
