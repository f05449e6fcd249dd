"""
Stiff and extreme cases, each with its correct result and the source of that result. They run as tests, and the report shows them as a
table. Each case bounds the evaluations of the equations of motion, so that no case passes by sheer work.
"""

import re
from dataclasses import dataclass, field
from typing import Callable

import numpy as np
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from scipy.linalg import eigh

import fmu
from closed_forms import (
    kepler,
    kepler_period,
    pendulum_angle,
    pendulum_half_period,
    pericentre_velocity,
    turning_pendulum_angle,
)
from numerics.stiff.collocation import Collocation, extended_right_side
from references import ExactMotion
from systems_in_sympy import system

PI = np.pi
SLOW = 1.0  # amplitude of the slow oscillation superposed on a fast pivot


@dataclass
class Case:
    name: str
    system: str
    values: dict
    end: float
    step: float
    right: str
    measure: Callable = None  # error of a Run
    bound: float = 0.0
    evaluations: int = 0
    tolerance: float = 1e-10
    start_time: float = 0.0
    rejected: str = None  # pattern of the message, if failing is correct
    exchange: float = None  # bound on the error with FMPy's CVode in model exchange; 0 if that fails too
    actions: Callable = None  # steps the instance and returns its rows
    pieces: list = None  # consecutive (duration, values of inputs and parameters)
    handovers: int = None  # bound on the changes of method by `auto`


@dataclass
class Run:
    """Recorded simulation; run["theta"] are the values at run.time."""

    case: Case
    time: np.ndarray
    columns: dict = field(default_factory=dict)

    def __getitem__(self, name):
        return self.columns[name]

    def drift(self, name):
        """Largest change of a variable, relative to its largest value."""
        values = self[name]
        return np.max(np.abs(values - values[0])) / np.max(np.abs(values))


@dataclass
class Outcome:
    verdict: str  # right, rejected or wrong
    error: float = np.nan
    evaluations: int = 0
    message: str = ""
    steps: int = 0


def recorded_names(name):
    return [v.name for v in fmu.description(name).modelVariables
            if v.causality in ("output", "local") and v.type == "Real"]  # fmt: skip


def count(instance, name):
    """One of the FMU's statistics; 0 if its solver has none."""
    return instance.fmu.getInteger(instance.vr(name))[0] if name in instance.references else 0


def judge(case, run, evaluations, bound):
    columns = np.array([run.time, *run.columns.values()])
    if not np.all(np.isfinite(columns)):
        return Outcome("wrong", np.nan, evaluations, "not finite")
    error = float(case.measure(run))
    if not error <= bound:
        return Outcome("wrong", error, evaluations, f"the error {error:g} is larger than {bound:g}")
    if evaluations > case.evaluations:
        return Outcome("wrong", error, evaluations, f"{evaluations} evaluations are more than {case.evaluations}")
    return Outcome("right", error, evaluations)


def judge_rejection(case, messages):
    text = " / ".join(messages)
    fits = case.rejected is not None and re.search(case.rejected, text)
    return Outcome("rejected" if fits else "wrong", message=text)


def co_simulate(case):
    """Step the FMU in co-simulation; its statistics, messages and error give the verdict."""
    instance = fmu.Instance(case.system)
    try:
        names = recorded_names(case.system)
        instance.initialize(case.values, case.tolerance, start_time=case.start_time)
        if case.pieces is not None:
            rows = go_through(case, instance, names)
        elif case.actions is not None:
            rows = case.actions(instance, names)
        else:
            rows = instance.run(case.start_time + case.end, case.step, *names)
        evaluations, steps = count(instance, "derivativeEvaluations"), count(instance, "solverSteps")
        handovers = count(instance, "solverHandovers")
    except FMICallException:
        return judge_rejection(case, [text for status, _, text in instance.messages if status > 1])
    finally:
        instance.free()
    if case.rejected is not None:
        return Outcome("wrong", evaluations=evaluations, message="not rejected")
    table = np.array(rows).T
    outcome = judge(case, Run(case, table[0], dict(zip(names, table[1:]))), evaluations, case.bound)
    outcome.steps = steps
    if outcome.verdict == "right" and case.handovers is not None and handovers > case.handovers:
        return Outcome("wrong", outcome.error, evaluations, f"{handovers} changes of method are more than {case.handovers}", steps)
    return outcome


def exchange_model(case):
    """Integrate the case by FMPy's CVode, where the FMU computes only derivatives."""
    names, messages = recorded_names(case.system), []
    log = lambda environment, name, status, category, text: status > 1 and messages.append(text.decode())
    try:
        result = simulate_fmu(
            fmu.archive(case.system), fmi_type="ModelExchange", start_time=case.start_time,
            stop_time=case.start_time + case.end, start_values=case.values, output=names, output_interval=case.step,
            relative_tolerance=case.tolerance, logger=log, debug_logging=True,
        )  # fmt: skip
    except FMICallException:
        return judge_rejection(case, messages)
    if not case.exchange:
        return Outcome("wrong", message="not rejected")
    return judge(case, Run(case, result["time"], {name: result[name] for name in names}), 0, case.exchange)


def worst(values):
    return np.max(np.abs(values))


def pendulum_error(run):
    """Error against the elliptic function, in units of the amplitude or of 1 rad."""
    theta0 = run["theta"][0]
    rate = np.sqrt(run.case.values["g"] / run.case.values["l"])
    exact = [pendulum_angle(theta0, rate, t) for t in run.time - run.time[0]]
    return worst(run["theta"] - exact) / min(1.0, theta0)


def turning_error(run):
    omega0, rate = run.case.values["omega"], np.sqrt(run.case.values["g"] / run.case.values["l"])
    return worst(run["theta"] - [turning_pendulum_angle(omega0, rate, t) for t in run.time])


def kepler_error(run):
    v = run.case.values
    exact = np.array([kepler(v["mu"], v["r"], v["omega"], t) for t in run.time])
    return worst(np.array([run["particle.x"], run["particle.y"]]).T - exact)


def throw_error(run):
    """Error of x, y, z of the particle against the parabola from its initial values."""
    v, t = run.case.values, run.time
    r, theta, phi = v["r"], v["theta"], v["phi"]
    sines = np.array([np.cos(theta) * np.sin(phi), np.sin(theta) * np.sin(phi), np.cos(phi)])
    along_phi = np.array([np.cos(theta) * np.cos(phi), np.sin(theta) * np.cos(phi), -np.sin(phi)])
    along_theta = np.array([-np.sin(theta) * np.sin(phi), np.cos(theta) * np.sin(phi), 0.0])
    velocity = v["vr"] * sines + r * v["omegaPhi"] * along_phi + r * v["omegaTheta"] * along_theta
    exact = r * sines + np.outer(t, velocity) - np.outer(v["g"] * t * t / 2, [0, 0, 1])
    return worst(np.array([run[f"particle.{axis}"] for axis in "xyz"]).T - exact)


def reference_error(run):
    """Error against SymPy's equations at 20 digits, in units of the larger of 1 and the state."""
    definition = system(run.case.system)
    values = {s.name: 0.0 for s in definition.arguments} | start_values(run.case)
    states = [s.name for s in [*definition.q, *definition.v]]
    exact = ExactMotion(definition, values, 30).trajectory([run.time[-1]])[0]
    ours = np.array([run[name][-1] for name in states])
    return worst((ours - exact) / np.maximum(1, np.abs(exact)))


def go_through(case, instance, names):
    """Step through the pieces; return a row at the end of each."""
    rows = [[0.0, *instance.fmu.getReal(instance.vr(*names))]]
    for duration, values in case.pieces:
        instance.set(values)
        rows.append(instance.run(instance.time + duration, case.step, *names)[-1])
    return rows


def pieces_error(run):
    """Error against high-order collocation in extended precision, in units of the larger of 1 and the state."""
    definition, values = system(run.case.system), start_values(run.case)
    states = [s.name for s in [*definition.q, *definition.v]]
    motion = Collocation(extended_right_side(definition, values), [values[state] for state in states], 12)
    error, time = 0.0, 0.0
    for i, (duration, changes) in enumerate(run.case.pieces, 1):
        motion.advance(time, time + duration, changes)
        time += duration
        exact = motion.x.astype(float)
        error = max(error, worst((np.array([run[state][i] for state in states]) - exact) / np.maximum(1, np.abs(exact))))
    return error


def start_values(case):
    return fmu.start_values(case.system) | case.values


def cart_invariants(run):
    """Error of the energy, and of the momentum along x against the impulse of the force."""
    v = start_values(run.case)
    momentum = (v["M"] + v["m"]) * run["v"] + v["m"] * v["l"] * run["omega"] * np.cos(run["theta"])
    given = momentum - momentum[0] - v["F"] * run.time
    scale = np.max(np.abs((v["M"] + v["m"]) * run["v"])) + np.max(np.abs(v["m"] * v["l"] * run["omega"]))
    return max(worst(given) / scale, run.drift("totalEnergy") if v["F"] == 0 else 0.0)


def rigid_error(run):
    """Error against a rigid rod, which a very stiff spring approaches up to a stretch of order m g / k."""
    v = start_values(run.case)
    return worst(run["theta"] - [pendulum_angle(v["theta"], np.sqrt(v["g"] / v["l0"]), t) for t in run.time])


def bounce_error(run):
    """Energy error of the undamped bounce, in units of the energy of the bounce, (m g)^2 / 2k."""
    v = start_values(run.case)
    return worst(run["totalEnergy"] - run["totalEnergy"][0]) / ((v["m"] * v["g"]) ** 2 / (2 * v["k"]))


def fast_part(ratio, phase):
    """Fast part of theta'' = -(r/l) w^2 sin(theta + w t) for a slow theta, to second order in r/l."""
    return ratio * np.sin(phase) + ratio**2 * np.sin(2 * phase) / 8


def averaged_error(run):
    """Error for a fast pivot by averaging: theta = Theta + fast_part(Theta + w t), where Theta swings as if the pivot were fixed."""
    v = run.case.values
    slow = np.array([pendulum_angle(SLOW, np.sqrt(v["g"] / v["l"]), t) for t in run.time])
    return worst(run["theta"] - slow - fast_part(v["r"] / v["l"], slow + v["w"] * run.time))


def modes_error(run):
    """Error against the modes of small angles: M q'' = -K q with M_ij = m l^2 (n - max(i, j)), K_ii = m g l (n - i), i from 0."""
    v, n = start_values(run.case), 32
    M = np.array([[v["m"] * v["l"] ** 2 * (n - max(i, j)) for j in range(n)] for i in range(n)])
    K = np.diag([v["m"] * v["g"] * v["l"] * (n - i) for i in range(n)])
    squares, shapes = eigh(K, M)
    angles = np.array([run[f"theta[{i}]"] for i in range(1, n + 1)]).T
    start = shapes.T @ M @ angles[0]
    exact = np.array([shapes @ (start * np.cos(np.sqrt(squares) * t)) for t in run.time])
    return worst(angles - exact) / worst(angles[0])


def viscous_error(run):
    """Error against overdamped creep: b theta' = -m g l sin(theta), so that tan(theta/2) = tan(theta0/2) exp(-m g l t / b)."""
    v = start_values(run.case)
    exact = 2 * np.arctan(np.tan(v["theta"] / 2) * np.exp(-v["m"] * v["g"] * v["l"] / v["b"] * run.time))
    return worst(run["theta"] - exact)


def spin_up_error(run):
    """Error against omega = tau / b (1 - exp(-b t / J)); gravity is negligible beside the torque."""
    v = start_values(run.case)
    inertia = v["m"] * v["l"] ** 2
    exact = v["tau"] / v["b"] * -np.expm1(-v["b"] * run.time / inertia)
    return worst(run["omega"] - exact) / worst(exact)


def energy_error(run):
    return worst(run["totalEnergy"] - run["totalEnergy"][0]) / worst(run["kineticEnergy"])


def random_walk(run):
    """Energy drift in units of the random walk of rounding errors over n steps, 2^-52 sqrt(n)."""
    return run.drift("totalEnergy") / (2.0**-52 * np.sqrt(1e6 * 10))


def balanced(instance, names):
    """Balance the cart by a linear controller in another FMU, with values exchanged every millisecond."""
    controller = fmu.Instance("StateFeedback")
    gains = dict(kx=-1, ktheta=-25, kv=-2, komega=-5, umax=50)
    controller.initialize(gains)
    rows = [[0.0, *instance.fmu.getReal(instance.vr(*names))]]
    for i in range(20000):
        controller.set(dict(zip(["x", "theta", "v", "omega"], instance.get("x", "theta", "v", "omega"))))
        instance.set(F=controller.get("F"))
        instance.step(1e-3)
        controller.step(1e-3)
        if i % 100 == 99:
            rows.append([instance.time, *instance.fmu.getReal(instance.vr(*names))])
    controller.free()
    return rows


def jump(instance, names):
    """Apply a force of 1e12 N during the second of three steps."""
    rows = [[0.0, *instance.fmu.getReal(instance.vr(*names))]]
    for force in (0.0, 1e12, 0.0):
        instance.set(F=force)
        instance.step(1e-3)
        rows.append([instance.time, *instance.fmu.getReal(instance.vr(*names))])
    return rows


def jump_error(run):
    """Error of the momentum along x against the impulse."""
    v = start_values(run.case)
    momentum = (v["M"] + v["m"]) * run["v"] + v["m"] * v["l"] * run["omega"] * np.cos(run["theta"])
    return worst(momentum - [0, 0, 1e9, 1e9]) / 1e9


def pole(distance):
    """Initial values of a throw that passes the polar axis at this distance, at the height of its start."""
    y, speed = distance, 2.0
    x, z = -1.0, 1.0
    r, rho = np.sqrt(x * x + y * y + z * z), np.hypot(x, y)
    vr = x * speed / r
    return dict(m=1.0, g=1.0, r=r, theta=np.arctan2(y, x), phi=np.arctan2(rho, z), vr=vr,
                omegaTheta=-y * speed / rho**2, omegaPhi=(z / r * vr) / rho)  # fmt: skip


def kepler_values(e):
    return dict(m=1.0, mu=1.0, r=1 - e, vr=0.0, theta=0.0, omega=pericentre_velocity(1, 1, e))


def revolutions(e, count):
    values = kepler_values(e)
    return count * kepler_period(1, values["r"], values["omega"])


def spinning(w):
    """Initial values of a slow oscillation of 1 rad superposed on a fast pivot."""
    r, l = 1e-3, 1.0
    theta = SLOW + fast_part(r / l, SLOW)
    # The initial rate is also of second order: an error of it would act as a slow velocity.
    omega = r * w / l * (np.cos(SLOW) + r / l * np.cos(2 * SLOW) / 4)
    return dict(m=1.0, l=l, g=9.81, r=r, w=w, gamma=0.0, theta=theta, omega=omega)


def switching(name, system_name, values, pieces, right, bound, evaluations, handovers, step=None):
    """Case for `auto`: inputs and parameters change between the pieces."""
    end = sum(duration for duration, _ in pieces)
    return Case(name, system_name, values, end, step or end, "collocation in extended precision; " + right, pieces_error, bound,
                evaluations, 1e-9, pieces=pieces, handovers=handovers)  # fmt: skip


UNIT = dict(l=1.0, g=1.0)
ELLIPTIC = "Jacobi's elliptic function"

CASES = [
    # --- The pendulum near its unstable equilibrium.
    Case("at the top, theta = pi", "SimplePendulum", UNIT | dict(theta=PI), 20, 1,
         f"falls, since the double is 1.2e-16 below pi: {ELLIPTIC}", pendulum_error, 1e-6, 50, 1e-15),
    Case("1e-12 below the top", "SimplePendulum", UNIT | dict(theta=PI - 1e-12), pendulum_half_period(PI - 1e-12, 1), 5,
         f"-theta0 after half a period; rounding divided by 1e-12: {ELLIPTIC}", pendulum_error, 1e-3, 200, 1e-15),
    Case("over the top with 1e-12 of energy to spare", "SimplePendulum", UNIT | dict(theta=0.0, omega=2 * (1 + 5e-13)), 40, 1,
         f"passes the top: {ELLIPTIC}", turning_error, 1e-2, 300, 1e-15),
    Case("spin of 1e6 rad/s", "SimplePendulum", UNIT | dict(theta=0.0, omega=1e6), 0.01, 0.001,
         f"theta grows by 1e4 rad: {ELLIPTIC}", turning_error, 1e-9, 10000, 1e-12),
    Case("amplitude 1e-9", "SimplePendulum", UNIT | dict(theta=1e-9), 20, 1,
         f"relative to the amplitude, with an absolute tolerance of 1e-15: {ELLIPTIC}", pendulum_error, 1e-6, 100, 1e-15),
    Case("length 1e-6 m", "SimplePendulum", dict(l=1e-6, g=9.81, theta=2.0), 0.1, 0.01, ELLIPTIC, pendulum_error, 1e-8, 2000),
    Case("length 1e6 m", "SimplePendulum", dict(l=1e6, g=9.81, theta=2.0), 1e4, 1e3, ELLIPTIC, pendulum_error, 1e-8, 200),
    Case("communication step 1e-12 s", "SimplePendulum", UNIT | dict(theta=2.0), 1e-9, 1e-12, ELLIPTIC, pendulum_error, 1e-15, 5),
    Case("communication step 1e6 s", "SimplePendulum", UNIT | dict(theta=1.0), 1e6, 1e6,
         "rounding and tolerance grow with 1.5e5 periods: " + ELLIPTIC, pendulum_error, 1e-3, 4_000_000, 1e-13),
    Case("time near 1e9 s", "SimplePendulum", UNIT | dict(theta=2.0), 20.0, 0.01,
         f"as from time 0; the clock has 1e-7 s there: {ELLIPTIC}", pendulum_error, 1e-9, 100, start_time=1e9),
    Case("1e6 periods", "SimplePendulum", UNIT | dict(theta=1.0), 6.7e6, 6.7e4,
         "energy: a random walk of rounding, 2^-52 sqrt(steps), is 1", random_walk, 3.0, 25_000_000, 1e-15),
    Case("tolerance 1e-16", "SimplePendulum", UNIT | dict(theta=2.0), 20, 1, ELLIPTIC, pendulum_error, 1e-13, 100, 1e-16),
    Case("tolerance 0.5", "SimplePendulum", UNIT | dict(theta=2.0), 20, 1, ELLIPTIC, pendulum_error, 0.5, 200, 0.5),
    *(Case(f"tolerance {value}", "SimplePendulum", UNIT, 1, 1, "rejected", tolerance=value,
           rejected="tolerance is .*expected one between 0 and 1") for value in (0.0, -1.0, 1.0, np.nan, np.inf)),
    # --- Stiff damping and discontinuous forces.
    Case("damping 1e8 N m s", "DampedPendulum", dict(b=1e8, theta=1.0), 1.0, 0.1,
         "creep with the rate of the weight over the damping", viscous_error, 1e-9, 400, exchange=1e-6),
    Case("torque that jumps to 1e12 N m", "DampedPendulum", dict(b=0.5, m=1.0, l=1.0, theta=0.0, tau=1e12), 1e-3, 1e-4,
         "omega = tau/b (1 - exp(-b t/J))", spin_up_error, 1e-7, 60000),
    Case("force that jumps to 1e12 N", "InvertedPendulumCart", dict(theta=0.2), 3e-3, 1e-3,
         "momentum along x = impulse", jump_error, 1e-6, 40000, actions=jump),
    # --- Stiff for part of the time. Values persist until they change, so that each piece names the same ones.
    *(switching(f"damping that comes and goes, {text}", "DampedPendulum", dict(b=0.2), [(5.0, dict(b=b)) for b in (0.2, 1e6, 0.2, 1e8, 0.2)],
                "swings, stands, swings", 1e-7, 2000, 8, step) for text, step in (("one step", None), ("steps of 0.01 s", 0.01))),
    switching("spring that becomes a rod, and a spring again", "ElasticPendulum", dict(k=1e2, c=0.1),
              [(2.0, dict(k=k, c=c)) for k, c in ((1e2, 0.1), (1e8, 2e4), (1e2, 0.1), (1e6, 2e4), (1e2, 0.1))],
              "stretched by 0.1 m, it snaps back within a millisecond", 1e-6, 4000, 8),
    switching("torque that jumps, at rest in oil", "DampedPendulum", dict(b=1e4, theta=0.0),
              [(5.0, dict(tau=tau)) for tau in (0.0, 1e4, 0.0, -1e4, 0.0)], "a jump, and creep at once", 1e-7, 4000, 10),
    switching("torque that changes every millisecond, in oil", "DampedPendulum", dict(b=1e6),
              [(1e-3, dict(tau=1e6 * (-1) ** i)) for i in range(300)], "no chattering", 1e-7, 400_000, 50),
    switching("torque that changes every millisecond, in air", "DampedPendulum", dict(b=0.1),
              [(1e-3, dict(tau=1e2 * (-1) ** i)) for i in range(300)], "the series do not give way", 1e-7, 600, 0),
    switching("damping that alternates between 0.1 and 1e5 N m s", "DampedPendulum", dict(b=0.1, theta=2.0),
              [(0.05, dict(b=(0.1, 1e5)[i % 2])) for i in range(100)], "no chattering", 1e-7, 60_000, 26),
    # --- Carts with extreme mass ratios and unstable equilibria.
    Case("mass ratio 1e-8", "InvertedPendulumCart", dict(M=1e-8, m=1.0, theta=0.5), 1.0, 0.1,
         "energy and momentum, to 100 times the tolerance", cart_invariants, 1e-8, 1000),
    Case("mass ratio 1e8", "InvertedPendulumCart", dict(M=1e8, m=1.0, theta=0.5), 10.0, 0.1,
         "energy and momentum", cart_invariants, 1e-9, 500, exchange=1e-6),
    Case("mass ratio 1e8, motion", "InvertedPendulumCart", dict(M=1e8, m=1.0, theta=0.5), 3.0, 0.1,
         "20 digits of SymPy's equations", reference_error, 1e-8, 200),
    Case("rod through the horizontal at speed", "InvertedPendulumCart", dict(theta=0.2, omega=50.0), 2.0, 0.1,
         "20 digits of SymPy's equations; cos(theta) = 0 is no special place", reference_error, 1e-7, 1000, exchange=1e-3),
    Case("balanced by feedback", "InvertedPendulumCart", dict(theta=0.2), 20.0, 1e-3,
         "the unstable equilibrium is held: |theta| below 1e-6 at the end", lambda run: abs(run["theta"][-1]), 1e-6, 20000, actions=balanced),
    # --- Kepler orbits.
    Case("Kepler e = 0.9, 100 revolutions", "ParticlePolar", kepler_values(0.9), revolutions(0.9, 100), revolutions(0.9, 12.5),
         "Kepler's equation", kepler_error, 1e-10, 10000, 1e-14),
    Case("Kepler e = 0.99, 100 revolutions", "ParticlePolar", kepler_values(0.99), revolutions(0.99, 100), revolutions(0.99, 12.5),
         "Kepler's equation", kepler_error, 1e-8, 15000, 1e-14),
    Case("Kepler e = 0.999999, 100 revolutions", "ParticlePolar", kepler_values(0.999999), revolutions(0.999999, 100.25), revolutions(0.999999, 12.53125),
         "Kepler's equation; the pericentre multiplies rounding by 1e6 a revolution", kepler_error, 1e-3, 40000, 1e-15),
    Case("fall into the centre", "ParticlePolar", dict(m=1.0, mu=1.0, r=1.0, vr=0.0, theta=0.0, omega=0.0), 2.0, 0.1,
         "r = 0 at pi / sqrt(8) = 1.1107 s", rejected="stopped at time 1.1107207345.*singularity"),
    Case("start at the centre", "ParticlePolar", dict(r=0.0), 1.0, 0.1, "no motion from there", rejected="mass matrix is singular.*'theta'", exchange=0.0),
    # --- Spherical coordinates near their pole.
    *(Case(f"throw past the pole at {d:g} m", "ParticleSpherical", pole(d), 1.0, 0.05,
           "parabola; the azimuth turns by pi within d / speed", throw_error, bound, work, 1e-13)
      for d, bound, work in ((1e-3, 1e-9, 1000), (1e-6, 1e-6, 2000), (1e-9, 1e-3, 3000))),
    Case("throw through the pole", "ParticleSpherical", pole(0.0) | dict(theta=0.0, omegaTheta=0.0, omegaPhi=-pole(0.0)["omegaPhi"], vr=-pole(0.0)["vr"]) , 1.0, 0.05,
         "parabola: without azimuthal rate phi continues below 0", throw_error, 1e-9, 1000, 1e-13),
    Case("start at the pole", "ParticleSpherical", dict(phi=0.0, omegaTheta=1.0), 1.0, 0.1,
         "the azimuth does not exist", rejected="mass matrix is singular.*'theta'", exchange=0.0),
    # --- Stiff springs.
    *(Case(f"spring of {k:g} N/m, critical damping", "ElasticPendulum", dict(m=1.0, l0=1.0, k=k, c=2 * np.sqrt(k), r=1.0 + 9.81 * np.cos(0.5) / k, theta=0.5), 5.0, 0.01,
           "rigid pendulum, up to m g / k", rigid_error, max(100 / k, 1e-7), 2000, 1e-8, exchange=max(100 / k, 1e-4)) for k in (1e4, 1e6, 1e8, 1e10)),
    *(Case(f"spring of {k:g} N/m, undamped bounce, by taylor", "BouncingSpring", dict(m=1.0, l0=1.0, k=k, c=0.0, r=1.0, theta=0.0), 1.0, 0.01,
           "the bounce continues and conserves its energy", bounce_error, bound, int(max(300, np.sqrt(k))), 1e-15)
      for k, bound in ((1e4, 1e-9), (1e6, 1e-8), (1e8, 1e-6), (1e10, 1e-4))),
    *(Case(f"spring of {k:g} N/m, undamped bounce, by auto", "ElasticPendulum", dict(m=1.0, l0=1.0, k=k, c=0.0, r=1.0, theta=0.0), 1.0, 0.01,
           "the bounce continues and conserves its energy", bounce_error, bound, work, 1e-10)
      for k, bound, work in ((1e4, 1e-3, 10000), (1e6, 1e-2, 100000), (1e8, 1e-2, 500000))),
    # --- Fast pivots.
    *(Case(f"pivot at {w:g} rad/s", "RotatingPivotPendulum", spinning(w), 2.0, 0.01,
           "averaged motion: the pivot's own circle upon a free swing", averaged_error, 2e-5, 30000, 1e-12) for w in (1e3, 1e4)),
    # --- Long chains, high energy.
    Case("32 rods, small angles", "LongChain", {f"theta[{i}]": 1e-6 * np.sin(i) for i in range(1, 33)}, 2.0, 0.2,
         "modes of the linear system", modes_error, 1e-6, 500, 1e-14),
    Case("32 rods, horizontal", "LongChain", {f"theta[{i}]": PI / 2 for i in range(1, 33)}, 2.0, 0.2,
         "energy, in units of the largest kinetic one", energy_error, 1e-9, 2000),
    Case("double pendulum at 50 rad/s", "DoublePendulum", dict(theta1=1.0, theta2=-1.0, omega1=50.0, omega2=-50.0), 20.0, 0.5,
         "energy, in units of the largest kinetic one", energy_error, 1e-11, 20000, 1e-13),
]
