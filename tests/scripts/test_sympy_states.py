"""Systems of SymPy with states of first order, against SciPy's integration of SymPy's own equations."""

import numpy as np
import pytest
import sympy as sm
from scipy.integrate import solve_ivp
from sympy.physics.mechanics import Lagrangian, LagrangesMethod, Particle, Point, ReferenceFrame, dynamicsymbols

import fmu
from building import build_systems
from motions import lagrange_fmu  # noqa: F401

t = dynamicsymbols._t
m, M, l, g, T, kp, ki = sm.symbols("m M l g T kp ki")
VALUES = {m: 0.3, M: 1.2, l: 0.7, g: 9.81, T: 0.2, kp: 25, ki: 6}
x, theta, force, total = dynamicsymbols("x theta force total")
r = dynamicsymbols("r")


def cart():
    """A cart with a pendulum, pushed by an actuator with lag; a controller with an integrator commands it."""
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    C = O.locatenew("C", x * N.x)
    C.set_vel(N, x.diff() * N.x)
    P = C.locatenew("P", l * (sm.sin(theta) * N.x - sm.cos(theta) * N.y))
    P.set_vel(N, P.pos_from(O).dt(N))
    bodies = [Particle("cart", C, M), Particle("bob", P, m)]
    bodies[1].potential_energy = -m * g * l * sm.cos(theta)
    # The rate of the force depends on that of the other state, and on an acceleration.
    states = {force: (kp * (r - x) + ki * total - 4 * x.diff() - force) / T + sm.Rational(1, 10) * total.diff(), total: r - x + sm.Rational(1, 20) * theta.diff(t, 2)}
    return LagrangesMethod(Lagrangian(N, *bodies), [x, theta], forcelist=[(C, force * N.x)], bodies=bodies, frame=N), states


def integrated(method, states, start, times):
    """SymPy's mass matrix and forcing, with the rates beside them; r is 0.5."""
    method.form_lagranges_equations()
    names = {symbol: sm.Symbol(name) for symbol, name in zip((x.diff(), theta.diff(), x, theta, force, total), ("v", "w", "x", "a", "f", "z"))}
    accelerations = method.mass_matrix.LUsolve(method.forcing)
    rates = {state.diff(): rate for state, rate in states.items()}
    second = {q.diff(t, 2): a for q, a in zip((x, theta), accelerations)}
    right = [*accelerations, *(rate.xreplace(rates).xreplace(second) for rate in states.values())]
    evaluate = sm.lambdify([names[q] for q in (x, theta, x.diff(), theta.diff(), force, total)], [one.subs(VALUES).xreplace({r: 0.5, **names}) for one in right])
    return solve_ivp(lambda _, y: [y[2], y[3], *evaluate(*y)], (0, times[-1]), start, t_eval=times, method="DOP853", rtol=1e-12, atol=1e-13).y


def test_the_motion_is_that_of_sympy(lagrange_fmu, tmp_path):  # noqa: F811
    method, states = cart()
    path = lagrange_fmu.from_sympy(method, tmp_path / "LagCart.xml", VALUES, start={theta: 0.4, "force": 1, r: 0.5}, states=states, units={"force": "N"}, outputs={"push": force - 2 * total})
    assert '<state name="force" rate="' in path.read_text() and 'unit="N"' in path.read_text()
    build_systems("sympy_states", {"LagCart": path.read_text()})
    motion = lagrange_fmu.simulate(fmu.archive("LagCart"), stop_time=5, step=0.25, tolerance=1e-11)
    exact = integrated(method, states, [0, 0.4, 0, 0, 1, 0], motion["time"])
    for name, values in zip(("x", "theta", "x_dot", "theta_dot"), exact):
        np.testing.assert_allclose(motion[name], values, atol=2e-9)
    np.testing.assert_allclose(motion["push"], exact[4] - 2 * exact[5], atol=2e-8)


def simple():
    return LagrangesMethod(m * x.diff() ** 2 / 2 - g * x * force, [x])


@pytest.mark.parametrize("states, message", [
    ({force: force.diff()}, "the rate of force.t. needs itself"),
    ({force: total.diff(), total: force.diff()}, "the rate of force.t. needs itself"),
    ({x: 1}, "x.t. is not a state; expected a dynamicsymbol or a name"),
    ({m: 1}, "m is not a state"),
    ({force: sm.gamma(x)}, "the rate of force.t.: gamma"),
    ({force: x.diff(t, 3)}, "Derivative.*is an acceleration"),
])  # fmt: skip
def test_mistakes(states, message, lagrange_fmu, tmp_path):  # noqa: F811
    with pytest.raises(lagrange_fmu.Problem, match=message):
        lagrange_fmu.from_sympy(simple(), tmp_path / "Wrong.xml", {m: 1, g: 1}, states=states)


def test_a_state_of_a_name_in_the_potential(lagrange_fmu, tmp_path):  # noqa: F811
    """m x'' = -g force with force' = 1: a cubic, x = -t^3/6 for m = g = 1."""
    path = lagrange_fmu.from_sympy(simple(), tmp_path / "Cubic.xml", {"m": 1, "g": 1}, states={"force": 1})
    build_systems("sympy_cubic", {"Cubic": path.read_text()})
    motion = lagrange_fmu.simulate(fmu.archive("Cubic"), stop_time=2, step=0.5)
    np.testing.assert_allclose(motion["x"], -(motion["time"] ** 3) / 6, atol=1e-13)
