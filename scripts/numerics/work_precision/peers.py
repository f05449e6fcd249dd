"""Solve the problems by other programs; each function returns (seconds, states at times_of(name)), or None after a failure."""

import functools

import numpy as np
import sympy
from scipy.integrate import solve_ivp

from numerics.driver import POINTS
from numerics.programs import FmpyCvode, fastest, with_time_limit
from numerics.work_precision.compiled import odeint
from numerics.work_precision.scenarios import SCENARIOS, states_of, times_of, values_of
from systems_in_sympy import system


def scipy_method(method):
    def run(name, tolerance):
        definition, values = system(name), values_of(name)
        right_side = with_time_limit(definition.right_side(lambda t: [values[u.name] for u in definition.inputs],
                                                     [values[p.name] for p in definition.parameters]))  # fmt: skip
        start = [values[s] for s in states_of(name)]
        times = times_of(name)
        solve = lambda: solve_ivp(right_side, (0, times[-1]), start, method=method, rtol=tolerance, atol=tolerance, t_eval=times)
        seconds, solution = fastest(solve, 0.5, 5)
        return (seconds, solution.y.T) if solution.success else None

    return run


def fmpy_cvode(name, tolerance):
    starts, end = SCENARIOS[name]
    importer = FmpyCvode(name, starts, end, states_of(name), tolerance)
    try:
        seconds, rows = fastest(importer.simulate, 0.5, 5)
    except RuntimeError:
        return None
    return (seconds, rows) if len(rows) == POINTS else None


def heyoka_series(name, tolerance):
    """Solve a problem by heyoka, with accelerations that SymPy solves for and numeric parameters; return the states at the end only, without compilation time."""
    integrator, start = heyoka_integrator(name)
    integrator = type(integrator)(integrator.sys, start, tol=tolerance)
    end = SCENARIOS[name][1]

    def propagate():
        integrator.time = 0.0
        integrator.state[:] = start
        integrator.propagate_until(end)

    seconds, _ = fastest(propagate, 0.5, 200)
    return seconds, np.array([integrator.state])


@functools.cache
def heyoka_integrator(name):
    import heyoka

    definition, values = system(name), values_of(name)
    symbols = [*definition.q, *definition.v]
    fixed = {s: values[s.name] for s in [*definition.inputs, *definition.parameters]}
    solved = definition.mass.LUsolve(sympy.Matrix([sum(terms) for terms in definition.terms]))
    solved = [sympy.simplify(a).subs(fixed) for a in solved]
    variables = dict(zip(symbols, heyoka.make_vars(*[s.name for s in symbols])))
    clock = {sympy.Symbol("time"): heyoka.time}
    right = [variables[v] for v in definition.v] + [heyoka.from_sympy(a, clock) for a in solved]
    start = [values[s.name] for s in symbols]
    return heyoka.taylor_adaptive(list(zip(variables.values(), right)), start), start


CART = """<mujoco><option timestep="{h}" integrator="{integrator}" gravity="0 0 -{g}"><flag contact="disable"/></option>
<worldbody><body><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="{M}" diaginertia="1e-12 1e-12 1e-12"/>
<body><joint type="hinge" axis="0 1 0"/><inertial pos="0 0 {l}" mass="{m}" diaginertia="1e-12 1e-12 1e-12"/></body>
</body></worldbody></mujoco>"""


def chain_model(values, h, integrator, count=10):
    link = '<body pos="0 0 {z}"><joint type="hinge" axis="0 -1 0"/><inertial pos="0 0 -{l}" mass="{m}" diaginertia="1e-12 1e-12 1e-12"/>'
    bodies = "".join(link.format(z=0 if i == 0 else -values["l"], l=values["l"], m=values["m"]) for i in range(count))
    return (f'<mujoco><option timestep="{h}" integrator="{integrator}" gravity="0 0 -{values["g"]}"><flag contact="disable"/></option>'
            f'<worldbody>{bodies}{"</body>" * count}</worldbody></mujoco>')  # fmt: skip


def mujoco_steps(integrator):
    """Return a function that solves a problem by MuJoCo with fixed steps h in s; the joints of the chain are relative angles."""

    def run(name, h):
        import mujoco

        values, times = values_of(name), times_of(name)
        relative = name == "ChainPendulum"
        text = chain_model(values, h, integrator) if relative else CART.format(h=h, integrator=integrator, **values)
        model = mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(model)
        n = model.nq
        start = np.array([values[s] for s in states_of(name)])
        angles = lambda x: np.diff(x, prepend=0.0) if relative else x
        per_point = round(times[0] / h)

        def simulate():
            mujoco.mj_resetData(model, data)
            data.qpos[:], data.qvel[:] = angles(start[:n]), angles(start[n:])
            rows = []
            for _ in times:
                mujoco.mj_step(model, data, per_point)
                rows.append(np.concatenate([np.cumsum(data.qpos), np.cumsum(data.qvel)] if relative else [data.qpos, data.qvel]))
            return np.array(rows)

        return fastest(simulate, 0.5, 5)

    return run


TOLERANCES = [1e-4, 1e-6, 1e-8, 1e-10, 1e-11, 1e-12, 1e-13, 2.3e-14]  # relative and absolute; SciPy accepts no smaller ones
STEP_SIZES = [1e-2, 1e-3, 1e-4]

# Systems whose accelerations SymPy solves for in reasonable time; it does not for ten rods.
SYMBOLIC = [name for name in SCENARIOS if name != "ChainPendulum"]

# Name: (function, tolerances or steps, systems that it can express; None for all).
PEERS = {
    "SciPy DOP853": (scipy_method("DOP853"), TOLERANCES, None),
    "SciPy LSODA": (scipy_method("LSODA"), TOLERANCES, None),
    "SciPy Radau": (scipy_method("Radau"), TOLERANCES[:5], None),
    "FMPy CVode (model exchange)": (fmpy_cvode, TOLERANCES, None),
    "Boost.Odeint Fehlberg 7(8), in C++": (odeint, TOLERANCES, SYMBOLIC),
    "heyoka": (heyoka_series, [1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 2.2e-16], SYMBOLIC),
    "MuJoCo RK4": (mujoco_steps("RK4"), STEP_SIZES, ["InvertedPendulumCart", "ChainPendulum"]),
    "MuJoCo Euler": (mujoco_steps("Euler"), STEP_SIZES, ["InvertedPendulumCart", "ChainPendulum"]),
}
