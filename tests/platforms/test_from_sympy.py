"""from_sympy of the wheel: FMUs of systems of sympy.physics.mechanics have SymPy's mass matrix and forcing."""

import random
import re

import numpy as np
import pytest
import sympy as sm
from fmpy import read_model_description
from fmpy.fmi2 import FMU2Model
from sympy import cos, sin
from sympy.physics.mechanics import (
    Lagrangian,
    LagrangesMethod,
    Particle,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)

import fmu
import wheel

pytestmark = pytest.mark.release

t = dynamicsymbols._t
m, M, l, g, R, k, Omega = sm.symbols("m M l g R k Omega")
VALUES = {m: 0.7, M: 1.9, l: 0.6, g: 9.81, R: 0.3, k: 2.5, Omega: 1.7}


def base():
    frame, origin = ReferenceFrame("N"), Point("O")
    origin.set_vel(frame, 0)
    return frame, origin


def double_pendulum():
    N, O = base()
    first, second = dynamicsymbols(r"\\theta_{1} θ'")
    A, B = N.orientnew("A", "Axis", [first, N.z]), N.orientnew("B", "Axis", [second, N.z])
    P = O.locatenew("P", l * A.x)
    Q = P.locatenew("Q", R * B.x)
    P.v2pt_theory(O, N, A)
    Q.v2pt_theory(P, N, B)
    bobs = [Particle("p", P, M), Particle("q", Q, m)]
    for bob in bobs:
        bob.potential_energy = -bob.mass * g * bob.point.pos_from(O).dot(N.x)
    return LagrangesMethod(Lagrangian(N, *bobs), [first, second]), {"theta_1": "theta_1_dot", "theta_prime": "theta_prime_dot"}


def cart_pole():
    """An input force acts on the cart, and a torque between cart and pole."""
    N, O = base()
    x, angle, F = dynamicsymbols("x theta F")
    A = N.orientnew("A", "Axis", [angle, N.z])
    C = O.locatenew("C", x * N.x)
    C.set_vel(N, x.diff() * N.x)
    P = C.locatenew("P", -l * A.y)
    P.v2pt_theory(C, N, A)
    cart, bob = Particle("c", C, M), Particle("p", P, m)
    bob.potential_energy = m * g * P.pos_from(O).dot(N.y)
    loads = [(C, (F - sm.Rational(1, 3) * x.diff() * sm.Abs(x.diff())) * N.x), (A, (sm.sech(angle) - k * angle.diff()) * N.z)]
    return LagrangesMethod(Lagrangian(N, cart, bob), [x, angle], forcelist=loads, frame=N), {"x": "x_dot", "theta": "theta_dot"}


def rolling_disk():
    """SymPy's own example, with coordinates of the contact point: two nonholonomic constraints."""
    N, O = base()
    x, y, yaw, lean, spin = dynamicsymbols("x y psi theta phi")
    Y = N.orientnew("Y", "Axis", [yaw, N.z])
    L = Y.orientnew("L", "Axis", [lean, Y.x])
    D = L.orientnew("D", "Axis", [spin, L.y])
    C = O.locatenew("C", x * N.x + y * N.y + R * L.z)
    C.set_vel(N, C.pos_from(O).dt(N))
    disk = RigidBody("d", C, D, m, (inertia(L, m * R**2 / 4, m * R**2 / 2, m * R**2 / 4), C))
    disk.potential_energy = m * g * R * cos(lean)
    contact = C.vel(N) + D.ang_vel_in(N).cross(-R * L.z)
    constraints = [sm.simplify(contact.dot(axis)) for axis in (N.x, N.y)]
    q = [x, y, yaw, lean, spin]
    return LagrangesMethod(Lagrangian(N, disk), q, nonhol_coneqs=constraints), {c.func.__name__: f"{c.func.__name__}_dot" for c in q}


def rod_pendulum():
    x, y = dynamicsymbols("x y")
    L = m * (x.diff() ** 2 + y.diff() ** 2) / 2 - m * g * y
    return LagrangesMethod(L, [x, y], hol_coneqs=[x**2 + y**2 - l**2]), {"x": "x_dot", "y": "y_dot"}


def bead_on_rotating_wire():
    """A parabolic wire that rotates ever faster: explicit time, and a rational power."""
    r = dynamicsymbols("r")
    height, turn = k * r**2, Omega * t + t**2 / 5
    x, y = r * cos(turn), r * sin(turn)
    L = m * sum(e.diff(t) ** 2 for e in (x, y, height)) / 2 - m * g * height - (1 + r**2) ** sm.Rational(3, 2)
    return LagrangesMethod(L, [r]), {"r": "r_dot"}


def consistent(method, values, rng):
    """Random state that satisfies the constraints: coordinates by Newton's method, velocities by projection."""
    q, v = list(method.q), list(method.q.diff(t))
    state = {c: rng.uniform(-1, 1) for c in q}
    if method._hol_coneqs:
        f = sm.lambdify([q], method._hol_coneqs.subs(values))
        jacobian = sm.lambdify([q], method._hol_coneqs.subs(values).jacobian(q))
        place = np.array(list(state.values()))
        for _ in range(50):
            place -= np.linalg.pinv(jacobian(place)) @ f(place).ravel()
        state = dict(zip(q, place))
    speeds = np.array([rng.uniform(-2, 2) for _ in v])
    if method.coneqs:
        rows = np.array(method.coneqs.jacobian(v).subs(values).subs(state), dtype=float)
        speeds -= np.linalg.pinv(rows) @ rows @ speeds
    return state, dict(zip(v, speeds))


@pytest.mark.parametrize("make", [double_pendulum, cart_pole, rolling_disk, rod_pendulum, bead_on_rotating_wire])
def test_accelerations_are_those_of_sympy(make, tmp_path, open_fmu):
    method, names = make()
    method.form_lagranges_equations()
    used = set().union(*(part.free_symbols for part in (method._L, method._hol_coneqs, method.coneqs, method.forcing))) - {t}
    name = f"FromSympy{make.__name__}"
    path = wheel.package().from_sympy(method, tmp_path / f"{name}.xml", {symbol: VALUES[symbol] for symbol in used})
    fmu.built_by_tests[name] = wheel.package().build(path, output=tmp_path)
    values, rng = {symbol: VALUES[symbol] for symbol in used}, random.Random(name)
    q, v = list(method.q), list(method.q.diff(t))
    inputs = [f for f in method.forcing_full.atoms(sm.core.function.AppliedUndef) if f not in q]
    matrices = sm.lambdify([t, [*q, *v, *inputs]], [method.mass_matrix_full.subs(values), method.forcing_full.subs(values)])
    for _ in range(5):
        moment = rng.uniform(0, 3)
        place, speed = consistent(method, values, rng)
        forces = {f: rng.uniform(-3, 3) for f in inputs}
        mass, forcing = matrices(moment, [*place.values(), *speed.values(), *forces.values()])
        expected = np.linalg.solve(np.array(mass, dtype=float), np.array(forcing, dtype=float)).ravel()
        start = dict(zip([*names, *names.values()], [*place.values(), *speed.values()])) | {f.func.__name__: value for f, value in forces.items()}
        instance = open_fmu(name, kind=FMU2Model).initialize(start, start_time=moment)
        found = instance.get(*(f"der({variable})" for variable in [*names, *names.values()]))
        np.testing.assert_allclose(found, expected[: 2 * len(q)], rtol=1e-9, atol=1e-9)


def test_the_example_of_the_readme(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    [example] = re.findall(r"```python\n(from sympy.*?)```", (fmu.ROOT / "scripts" / "wheel" / "README.md").read_text(), re.S)
    names = {"lagrange_fmu": wheel.package()}
    exec(example, names)
    motion = names["motion"]
    energy = 0.5 * 0.5**2 * motion["theta_dot"] ** 2 - 9.81 * 0.5 * np.cos(motion["theta"])
    assert motion["theta"][0] == 1 and np.ptp(energy) < 1e-6 and np.ptp(motion["theta"]) > 1.9


def test_names_become_valid(tmp_path):
    """LaTeX, primes, Greek letters, words of the language, and two names that become equal."""
    q, p = dynamicsymbols(r"\dot{α}' sin")
    a, b, c = sm.Symbol("M^{*}"), sm.Symbol("M_*"), sm.Symbol("2nd spring")
    L = a * q.diff() ** 2 + b * p.diff() ** 2 - c * q**2 * p**2
    path = wheel.package().from_sympy(LagrangesMethod(L, [q, p]), tmp_path / "Names.xml", {a: 1, b: 2, c: 3})
    text = path.read_text()
    for name in ("M_", "M__", "_2nd_spring", "dotalpha_prime", "sin_", "sin__dot"):
        assert f'="{name}"' in text, text
    assert wheel.package().check(path).startswith("Names: 4 states, 0 inputs, 4 outputs, 3 parameters")


def test_no_name_is_a_word_of_the_language(tmp_path):
    words = [line.split()[1] for line in fmu.lagc("--words").stdout.splitlines() if not line.startswith("element")]
    x = dynamicsymbols("x")
    springs = [sm.Symbol(word) for word in words]
    method = LagrangesMethod(x.diff() ** 2 - sum(springs) * x**2, [x])
    path = wheel.package().from_sympy(method, tmp_path / "Words.xml", dict.fromkeys(springs, 1))
    assert wheel.package().check(path).startswith(f"Words: 2 states, 0 inputs, 2 outputs, {len(words)} parameters")


def test_speeds_have_names_of_their_own(tmp_path):
    x, F, zb = dynamicsymbols("x F zb")
    u = dynamicsymbols("u")
    N, O = base()
    O.set_vel(N, x.diff() * N.x)
    method = LagrangesMethod(m * x.diff() ** 2 / 2 - k * (x - zb) ** 2 / 2, [x], forcelist=[(O, (F.diff() - m * u) * N.x)], frame=N)
    path = wheel.package().from_sympy(method, tmp_path / "Speeds.xml", {"m": 1, "k": "2"}, start={x: 1, u: -3, F: 0.5}, speeds=[u], stop_time=2)
    text = path.read_text()
    assert '<coordinate name="x" velocity="u" start="1.0" velocityStart="-3.0" />' in text
    assert '<input name="F" start="0.5" derivatives="1" />' in text and '<input name="zb" start="0" derivatives="2" />' in text
    assert '<force coordinate="x">der(F) - m*u</force>' in text and '<experiment stopTime="2.0" />' in text
    assert wheel.package().check(path).startswith("Speeds: 2 states")


def rod():
    """A bob on a rod under a force, with units, outputs and names beside the equations."""
    N, O = base()
    x, y, F = dynamicsymbols("x y F")
    P = O.locatenew("P", x * N.x + y * N.y)
    P.set_vel(N, P.pos_from(O).dt(N))
    L = m * (x.diff() ** 2 + y.diff() ** 2) / 2 - m * g * y
    method = LagrangesMethod(L, [x, y], hol_coneqs=[x**2 + y**2 - l**2], forcelist=[(P, F * N.x)], frame=N)
    further = {"units": {m: "kg", "l": "m", g: "m/s2", F: "N", x: "m", y: "m", "power": "W"}, "constraints": ["rod"]}
    further |= {"points": {"bob": P.pos_from(O), "hinge": (0, l - l)}, "outputs": {"height": y + l, "power": F * x.diff(), "sin": 2 * x}}
    return method, {m: 1, l: 0.5, g: 9.81}, further | {"start": {x: 0.5, F: 2}}


def test_units_names_and_outputs(tmp_path):
    """Units, names of constraints, points for the animation, and outputs as expressions; names of the language are avoided."""
    method, parameters, further = rod()
    lagrange_fmu = wheel.package()
    path = lagrange_fmu.build(lagrange_fmu.from_sympy(method, tmp_path / "Rod.xml", parameters, **further), output=tmp_path)
    variables = {variable.name: variable for variable in read_model_description(path).modelVariables}
    assert {name: variables[name].unit for name in ("m", "l", "g", "F", "x", "power")} == {
        "m": "kg", "l": "m", "g": "m/s2", "F": "N", "x": "m", "power": "W"
    }
    assert "rod.force" in variables
    motion = lagrange_fmu.simulate(path, stop_time=1)
    np.testing.assert_allclose(motion["height"], motion["y"] + 0.5, rtol=0, atol=1e-12)
    np.testing.assert_allclose(motion["power"], 2 * motion["x_dot"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(motion["sin_"], 2 * motion["x"], rtol=0, atol=1e-12)
    page = lagrange_fmu.run(path, folder=tmp_path)["animation"].read_text()
    assert "bob" in page and "hinge" in page


@pytest.mark.parametrize("words, message", [
    ({"units": {"q": "m"}}, "q is not a parameter, input, coordinate, state or output of this LagrangesMethod; expected"),
    ({"constraints": ["rod", "wire"]}, "there are 2 names and 1 constraints; expected one for each, holonomic ones first"),
    ({"points": {"bob": (1,)}}, "the point bob has 1 coordinates; expected two or three"),
    ({"points": {"height": (1, 2)}}, "height is a point and an output; expected two names"),
])  # fmt: skip
def test_mistakes_beside_the_equations(words, message, tmp_path):
    method, parameters, further = rod()
    with pytest.raises(wheel.package().Problem, match=message):
        wheel.package().from_sympy(method, tmp_path / "Rod.xml", parameters, **further | words)
    assert list(tmp_path.iterdir()) == []


def test_expressions(tmp_path):
    """Functions that the language writes differently, through an FMU: after a short time the velocity is -U' of SymPy times that time."""
    x = dynamicsymbols("x")
    extremes = sm.Max(x, x**2, 3, 4 * k * x) + sm.Min(sm.E * x, sm.cot(x + 2), 7 + x**3, 3 - 2 * x)
    U = 1e6 * extremes + sm.atan2(x, 2) + sm.GoldenRatio * x ** sm.Rational(-5, 3) + 2 ** (-(x**2)) + sm.sqrt(x) / 3e-7
    lagrange_fmu = wheel.package()
    system = lagrange_fmu.from_sympy(LagrangesMethod(x.diff() ** 2 / 2 - U, [x]), tmp_path / "Terms.xml", {k: 1})
    path = lagrange_fmu.build(system, output=tmp_path)
    for place, stiffness in [(0.5, 1), (0.5, 5), (0.9, 0.1), (1.3, 0.01), (2.5, 0.2), (4, 9)]:
        motion = lagrange_fmu.simulate(path, {"x": place, "k": stiffness}, stop_time=1e-9, output_interval=1e-9)
        assert motion["x_dot"][-1] == pytest.approx(-float(U.diff(x).subs({k: stiffness, x: place})) * 1e-9, rel=1e-7)


X = dynamicsymbols("x")
UNEXPRESSED = {
    "the function f(x) is not known": (LagrangesMethod(X.diff() ** 2 - sm.Function("f")(X), [X]), {}),
    "Piecewise((x, x > 0)) has no value where none of its conditions holds": (LagrangesMethod(X.diff() ** 2 - sm.Piecewise((X, X > 0)), [X]), {}),
    "gamma(x) cannot be expressed; expected real numbers": (LagrangesMethod(X.diff() ** 2 - sm.gamma(X), [X]), {}),
    "the potential energy: I cannot be expressed": (LagrangesMethod(X.diff() ** 2 - sm.I * X, [X]), {}),
    "is an acceleration; expected energies": (LagrangesMethod(X.diff() ** 2 + X.diff(t, 2), [X]), {}),
    "no value is given for m; expected parameters={m: 1.0, ...}": (LagrangesMethod(m * X.diff() ** 2, [X]), {}),
    "q is not a parameter of this LagrangesMethod; expected m": (LagrangesMethod(m * X.diff() ** 2, [X]), {m: 1, "q": 2}),
    "m: one is not a number": (LagrangesMethod(m * X.diff() ** 2, [X]), {m: "one"}),
}


@pytest.mark.parametrize("message", UNEXPRESSED)
def test_expressions_without_an_equivalent(message, tmp_path):
    method, parameters = UNEXPRESSED[message]
    with pytest.raises(wheel.package().Problem) as raised:
        wheel.package().from_sympy(method, tmp_path / "Bad.xml", parameters)
    assert message in str(raised.value).replace("(t)", "")
    assert list(tmp_path.iterdir()) == []


def test_other_mistakes(tmp_path):
    from_sympy, Problem = wheel.package().from_sympy, wheel.package().Problem
    method = LagrangesMethod(X.diff() ** 2, [X])
    for words, message in (
        ({"path": "2.xml"}, "'2' cannot name a system; expected a file of letters"),
        ({"speeds": dynamicsymbols("u v")}, "there are 2 speeds and 1 coordinates; expected one for each"),
        ({"start": {dynamicsymbols("y"): 1}}, r"y\(t\) is not a coordinate, velocity, state or input of this LagrangesMethod; expected x\(t\), Derivative"),
    ):
        with pytest.raises(Problem, match=message):
            from_sympy(method, **{"path": tmp_path / "Good.xml", "parameters": {}} | words)
