"""Constraints against an independent derivation with multipliers, closed forms and published values; and constraints without a solution."""

import subprocess

import fmpy
import numpy as np
import pytest
import sympy as sp
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model

import fmu
from closed_forms import pendulum_angle
from building import runtime
from fmu import DISCARD, ERROR, WARNING, build_systems
from mechanics import Constrained, time, velocity

TWO_RODS = """
<system name="{name}">
  <parameter name="l" start="1" unit="m" min="0"/>
  <parameter name="m" start="1.5" unit="kg" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <coordinate name="x" velocity="vx" unit="m" start="0.8"/>
  <coordinate name="y" velocity="vy" unit="m" start="-0.6"/>
  <particle name="bob" mass="m" x="x" y="y"/>
  <potential>m*g*y</potential>
  <constraint name="rod" unit="m">sqrt(x^2 + y^2) - l</constraint>
  <constraint name="other" unit="m2">x^2 + y^2 - {square}</constraint>
  <experiment stopTime="2" stepSize="0.01"/>
</system>
"""
ARM = """
<system name="PulledArm">
  <coordinate name="p" velocity="vp" start="0.3"/>
  <coordinate name="q" velocity="vq" start="1.5"/>
  <particle name="tip" mass="1" x="cos(p) + cos(p + q)" y="sin(p) + sin(p + q)"/>
  <body name="upper" mass="1" inertia="0.1" x="cos(p)/2" y="sin(p)/2" angle="p"/>
  <constraint name="pull">tip.x - 1 - 0.2*time</constraint>
  <constraint name="line">tip.y - 0.3</constraint>
  <experiment stopTime="10" stepSize="0.01"/>
</system>
"""
TABLE = """
<system name="Table" description="table on three equal cranks, of which one is too many">
  <parameter name="g" start="9.81"/>
  <coordinate name="p" velocity="vp" start="-1" velocityStart="2" fixed="true"/>
  <coordinate name="x" velocity="vx" start="1"/>
  <coordinate name="y" velocity="vy" start="-0.8"/>
  <coordinate name="f" velocity="vf"/>
  <body name="crank" mass="1" inertia="0.1" x="cos(p)/2" y="sin(p)/2" angle="p"/>
  <body name="top" mass="2" inertia="0.3" x="x" y="y" angle="f"/>
  <potential>g*(crank.y + 2*top.y)</potential>
  <constraint name="pinX">x - 0.5*cos(f) - cos(p)</constraint>
  <constraint name="pinY">y - 0.5*sin(f) - sin(p)</constraint>
  <constraint name="second">(x + 0.5*cos(f) - 1)^2 + (y + 0.5*sin(f))^2 - 1</constraint>
  <constraint name="third">(x - 0.5)^2 + y^2 - 1</constraint>
  <experiment stopTime="5" stepSize="0.01"/>
</system>
"""
SLIDER = """
<system name="Slider" description="bead on a wire that moves, and a wheel that rolls with it at a rate of its own">
  <parameter name="g" start="9.81"/>
  <parameter name="R" start="0.3"/>
  <coordinate name="x" velocity="vx" start="0.2" velocityStart="0.5"/>
  <coordinate name="y" velocity="vy"/>
  <coordinate name="s" velocity="vs"/>
  <particle name="bead" mass="0.7" x="x" y="y"/>
  <kinetic>0.2*vs^2*(1 + 0.3*sin(s))</kinetic>
  <potential>0.7*g*y + x^4/3</potential>
  <dissipation>0.1*vx^2/2</dissipation>
  <constraint name="wire">y - 0.5*x^2 - 0.1*sin(3*time)</constraint>
  <constraint name="wheel">R*vs*cos(s) - vx + 0.1*time</constraint>
  <output name="pressure">wire.force + der(vx)</output>
  <experiment stopTime="3" stepSize="0.01"/>
</system>
"""
JUMP = """
<system name="Jump"><parameter name="g" start="9.81"/>
  <coordinate name="x" velocity="vx" start="-0.2" velocityStart="1"/>
  <coordinate name="y" velocity="vy" start="-0.1"/>
  <particle mass="2" x="x" y="y"/>
  <potential>2*g*y</potential>
  <constraint name="c0">y - 0.1*sign(x)</constraint>
  <experiment stopTime="1"/>
</system>
"""
RODS = """
<system name="Rods{count}" description="chain of rods without mass, by positions">
  <constant name="N" value="{count}"/>
  <parameter name="g" start="9.81"/>
  <for index="i" from="1" to="N">
    <coordinate name="x[i]" velocity="vx[i]" start="i/N*cos(0.5)"/>
    <coordinate name="y[i]" velocity="vy[i]" start="-i/N*sin(0.5)"/>
    <particle name="bob[i]" mass="1" x="x[i]" y="y[i]"/>
    <potential>g*y[i]</potential>
  </for>
  <constraint name="rod[1]">sqrt(x[1]^2 + y[1]^2) - 1/N</constraint>
  <for index="i" from="2" to="N"><constraint name="rod[i]">sqrt((x[i] - x[i-1])^2 + (y[i] - y[i-1])^2) - 1/N</constraint></for>
  <experiment stopTime="1" stepSize="0.01"/>
</system>
"""
ANGLES = """
<system name="Angles{count}" description="the same chain by angles">
  <constant name="N" value="{count}"/>
  <parameter name="g" start="9.81"/>
  <for index="i" from="1" to="N">
    <coordinate name="t[i]" velocity="w[i]" start="pi/2 - 0.5"/>
    <particle name="bob[i]" mass="1" x="sum(k, 1, i, sin(t[k]))/N" y="-sum(k, 1, i, cos(t[k]))/N"/>
    <potential>g*bob[i].y</potential>
  </for>
  <experiment stopTime="1" stepSize="0.01"/>
</system>
"""
SYSTEMS = {
    "Twice": TWO_RODS.format(name="Twice", square="l^2"),
    "Contrary": TWO_RODS.format(name="Contrary", square="1.1*l^2"),
    "PulledArm": ARM,
    "Table": TABLE,
    "Slider": SLIDER,
    "DrivenFourBar": (fmu.ROOT / "fmu" / "FourBar" / "system.xml").read_text()
    .replace('name="FourBar"', 'name="DrivenFourBar"')
    .replace('fixed="true"', 'fixed="true" acceleration="2.3*sin(time) + tau"')
    .replace('<input name="tau" unit="N.m"', '<input name="tau" unit="rad/s2"')
    .replace('<force coordinate="theta">tau</force>', ""),
    "Jump": JUMP,
    "Rods8": RODS.format(count=8),
    "Angles8": ANGLES.format(count=8),
}

# Constraints that agree at the start and contradict each other later, and constraints given as a whole text.
POINT = """<system name="{name}"><parameter name="g" start="9.81"/>
<coordinate name="x" velocity="vx" start="0.3"/><coordinate name="y" velocity="vy"/>
<particle mass="2" x="x" y="y"/><potential>2*g*y</potential>{constraints}<experiment stopTime="1"/></system>"""
TEXTS = {
    "Parting": [("x - 0.3", "x - 0.3 + time^2"), ("x - 0.3", "x - 0.3 + max(0, time - 0.5)^3"),
                ("vy - 0.1*vx", "vy - 0.1*vx - time^2"), ("y - 0.1*sin(time)", "y - 0.1*time")],
    "Whole": [("(x^2 + y^2 - 0.09)^2",), ("abs(x^2 + y^2 - 0.25)^3",), ("sqrt(x^2 + y^2) - 0.5",), ("log(x) - log(0.3)",)],
}  # fmt: skip
WHOLE = {
    f"{kind}{i}": POINT.format(
        name=f"{kind}{i}",
        constraints="".join(f'<constraint name="c{k}">{text}</constraint>' for k, text in enumerate(texts)),
    )
    for kind, rows in TEXTS.items()
    for i, texts in enumerate(rows)
}
METHODS = ["taylor", "radau", "auto", "bdf", "erk"]


@pytest.fixture(scope="module", autouse=True)
def systems():
    others = {f"Slider{method}": SLIDER.replace("Slider", f"Slider{method}").replace("<experiment", f'<solver method="{method}" tolerance="1e-10"/><experiment') for method in METHODS}  # fmt: skip
    build_systems("constrained", SYSTEMS | WHOLE | others)


def slider():
    x, y, s, vx, vy, vs, g, R = sp.symbols("x y s vx vy vs g R")
    T = sp.Rational(7, 20) * (vx**2 + vy**2) + vs**2 * (1 + sp.Rational(3, 10) * sp.sin(s)) / 5
    U = sp.Rational(7, 10) * g * y + x**4 / 3
    constraints = [y - x**2 / 2 - sp.sin(3 * time) / 10, R * vs * sp.cos(s) - vx + time / 10]
    return Constrained([x, y, s], [vx, vy, vs], T, U, [-vx / 10, 0, 0], constraints, [g, R]), ["wire", "wheel"]


def four_bar():
    theta, phi, psi, w, wc, wr, a, b, c, d, rho, g = sp.symbols("theta phi psi omega omegaCoupler omegaRocker a b c d rho g")
    q, v = [theta, phi, psi], [w, wc, wr]
    def e(angle): return sp.Matrix([sp.cos(angle), sp.sin(angle)])  # noqa: E704
    centres = [e(theta) * a / 2, e(theta) * a + e(phi) * b / 2, sp.Matrix([d, 0]) + e(psi) * c / 2]
    T = sum(rho * l / 2 * (velocity(r[0], q, v) ** 2 + velocity(r[1], q, v) ** 2 + l**2 / 12 * rate**2)
            for l, r, rate in zip([a, b, c], centres, v))  # fmt: skip
    U = sum(rho * l * g * r[1] for l, r in zip([a, b, c], centres))
    loop = e(theta) * a + e(phi) * b - sp.Matrix([d, 0]) - e(psi) * c
    return Constrained(q, v, T, U, [0, 0, 0], list(loop), [a, b, c, d, rho, g]), ["loopX", "loopY"]


def knife_edge():
    x, y, phi, vx, vy, w, m, J, alpha, g = sp.symbols("x y phi vx vy omega m J alpha g")
    T, U = (m * (vx**2 + vy**2) + J * w**2) / 2, -m * g * x * sp.sin(alpha)
    edge = vx * sp.sin(phi) - vy * sp.cos(phi)
    return Constrained([x, y, phi], [vx, vy, w], T, U, [0, 0, 0], [edge], [m, J, alpha, g]), ["edge"]


@pytest.mark.parametrize("name, define", [("Slider", slider), ("FourBar", four_bar), ("KnifeEdge", knife_edge)])
def test_accelerations_and_forces(name, define, open_fmu):
    """Accelerations and forces agree at random states, which need not satisfy the constraints; the forces agree in sign."""
    definition, constraints = define()
    random = np.random.default_rng(3)
    instance = open_fmu(name, kind=FMU2Model)
    symbols = [symbol.name for symbol in definition.arguments]
    states = fmu.states_of(name)
    for _ in range(50):
        values = random.uniform(0.3, 1.5, len(symbols))
        instance.put(zip(symbols[1:], values[1:]), values[0])
        velocities = states[len(states) // 2 :]
        ours = instance.get(*[f"der({v})" for v in velocities], *[f"{c}.force" for c in constraints])
        np.testing.assert_allclose(ours, definition.solve(values), rtol=1e-9, atol=1e-9)


def test_driven_mechanism(open_fmu):
    """The crank follows its prescribed acceleration; its torque is the multiplier of the additional row d2 theta/dt2 = acceleration."""
    definition, _ = four_bar()
    instance = open_fmu("DrivenFourBar").initialize(tolerance=1e-10)
    states = fmu.states_of("DrivenFourBar")
    parameters = instance.get(*[symbol.name for symbol in definition.arguments[7:]])
    for _ in range(20):
        instance.step(0.1)
        t, state = instance.time, instance.get(*states)
        assert state[0] == pytest.approx(1 + 10.3 * t - 2.3 * np.sin(t), abs=1e-8)
        matrix, right = definition.system(t, *state, *parameters)
        saddle = np.zeros((6, 6))
        saddle[:5, :5], saddle[5, 0], saddle[0, 5] = np.array(matrix, float), 1, 1
        solution = np.linalg.solve(saddle, [*np.array(right, float).ravel(), 2.3 * np.sin(t)])
        ours = instance.get("der(omegaCoupler)", "der(omegaRocker)", "loopX.force", "loopY.force", "theta.force")
        np.testing.assert_allclose(ours, [*solution[1:5], -solution[5]], rtol=1e-9, atol=1e-9)
        x = 0.3 * np.cos(state[0]) + 0.8 * np.cos(state[1]) - 0.9 - 0.6 * np.cos(state[2])
        assert abs(x) < 1e-13


def test_pendulum_and_its_tension(open_fmu):
    """The angle follows Jacobi's elliptic function; the force is m (g cos(theta) + l omega^2) along the rod, positive in tension."""
    instance = open_fmu("PendulumCartesian").initialize({"x": np.sin(1.2), "y": -np.cos(1.2)}, tolerance=1e-10)
    for _ in range(50):
        instance.step(0.1)
        x, y, vx, vy, tension = instance.get("x", "y", "vx", "vy", "rod.force")
        assert np.arctan2(x, -y) == pytest.approx(pendulum_angle(1.2, np.sqrt(9.81), instance.time), abs=1e-8)
        assert tension == pytest.approx(-9.81 * y + vx**2 + vy**2, abs=1e-11)
        assert abs(np.hypot(x, y) - 1) < 1e-14 and abs(x * vx + y * vy) < 1e-14


def test_knife_edge(open_fmu):
    """From rest with a spin, the plate moves along a cycloid and does not slide down indefinitely (Neimark and Fufaev)."""
    instance = open_fmu("KnifeEdge").initialize(tolerance=1e-10)
    scale = 9.81 * np.sin(0.2) / 2
    for _ in range(20):
        instance.step(0.5)
        t = instance.time
        assert instance.get("x") == pytest.approx(scale * np.sin(t) ** 2, abs=1e-8)
        assert instance.get("y") == pytest.approx(scale * (t - np.sin(2 * t) / 2), abs=1e-8)


ANDREWS = dict(
    beta=15.81077119629904, theta=-15.75637105984298, gamma=0.04082224013073101, phi=-0.5347301163226948,
    delta=0.5244099658805304, omega=0.5347301163226948, epsilon=1.048080741042263,
)  # fmt: skip


def test_andrews_mechanism(open_fmu):
    """Accelerations and forces at the start, and positions at 0.03 s, are those of the Test Set for IVP Solvers."""
    instance = open_fmu("AndrewsSqueezer").initialize(tolerance=1e-10)
    start = instance.get("der(vbeta)", "der(vtheta)", "der(vgamma)", "loop3X.force", "loop3Y.force")
    np.testing.assert_allclose(
        start, [14222.44391995414, -10666.83293996559, 0, 98.5668703962411, -6.12268834425567], rtol=1e-12, atol=1e-7
    )
    for _ in range(30):
        instance.step(1e-3)
    for name, expected in ANDREWS.items():
        assert instance.get(name) == pytest.approx(expected, rel=1e-9)


def test_flat_positions_are_passed(open_fmu):
    """
    The chain passes positions in which all rods lie flat and the Jacobian loses rank. The energy error stays below the 0.1 J of the IFToMM
    benchmark.
    """
    instance = open_fmu("NFourBar").initialize()
    energy = instance.get("totalEnergy")
    for _ in range(1000):
        instance.step(0.01)
    assert instance.get("theta[0]") > 4 * np.pi  # it has made two revolutions
    assert abs(instance.get("totalEnergy") - energy) < 1e-6
    assert abs(instance.get("theta[0]") - instance.get("theta[40]")) < 1e-9 and abs(instance.get("phi[20]")) < 1e-9


@pytest.mark.parametrize("method", METHODS)
def test_every_method(method, open_fmu):
    """Each solver agrees with SciPy on SymPy's equations. The constraints are at all levels; one moves and one is nonholonomic."""
    from scipy.integrate import solve_ivp

    definition, _ = slider()
    instance = open_fmu(f"Slider{method}").initialize()
    start = instance.get(*fmu.states_of("Slider"))

    def derivative(t, state):
        return [*state[3:], *definition.solve([t, *state, 9.81, 0.3])[:3]]

    expected = solve_ivp(derivative, (0, 3), start, method="DOP853", rtol=1e-12, atol=1e-12, t_eval=np.linspace(0.1, 3, 30))
    for k in range(30):
        instance.step(0.1)
        x, y, s, vx, vy, vs = instance.get(*fmu.states_of("Slider"))
        np.testing.assert_allclose([x, y, s, vx, vy, vs], expected.y[:, k], atol=2e-6 if method == "bdf" else 1e-7)
        t = instance.time
        assert abs(y - 0.5 * x**2 - 0.1 * np.sin(3 * t)) < 1e-13
        assert abs(vy - x * vx - 0.3 * np.cos(3 * t)) < 1e-13
        assert abs(0.3 * vs * np.cos(s) - vx + 0.1 * t) < 1e-13


def test_directional_derivatives(open_fmu):
    """Derivatives of accelerations, forces and an output of both agree with central differences."""
    instance = open_fmu("Slider", kind=FMU2Model)
    known = ["x", "y", "s", "vx", "vy", "vs", "g", "R"]
    unknown = ["der(vx)", "der(vs)", "pressure"]
    for name in known:
        value, values = instance.put({}).get(name), []
        ours = instance.fmu.getDirectionalDerivative(instance.vr(*unknown), instance.vr(name), [1.0])
        for sign in (1, -1):
            values.append(np.array(instance.put({name: value + sign * 1e-6}).get(*unknown)))
        np.testing.assert_allclose(ours, (values[0] - values[1]) / 2e-6, rtol=1e-6, atol=1e-6)


def test_model_exchange_asks_for_projection(open_fmu):
    """An event projects a state that drifted by more than the tolerance; a smaller drift leaves the state unchanged."""
    instance = open_fmu("PendulumCartesian", kind=FMU2Model)
    instance.initialize(tolerance=1e-6)
    model = instance.fmu
    assert model.newDiscreteStates()[3] in (0, False)
    model.enterContinuousTimeMode()
    model.setContinuousStates(np.array([-1.0, 1e-9, 0.0, 0.0]).ctypes.data_as(model_pointer()), 4)
    assert model.completedIntegratorStep()[0] in (0, False)
    model.setContinuousStates(np.array([-1.01, 0.0, 0.5, 1.0]).ctypes.data_as(model_pointer()), 4)
    assert model.completedIntegratorStep()[0]
    model.enterEventMode()
    assert model.newDiscreteStates()[3]
    np.testing.assert_allclose(instance.get("x", "y", "vx", "vy"), [-1, 0, 0, 1], atol=1e-14)


def model_pointer():
    from ctypes import POINTER, c_double

    return POINTER(c_double)


def test_start_values_are_moved_least(open_fmu):
    """
    Start values move to the nearest point of the circle, which lies on the ray; velocities lose their radial part only. The log reports it.
    """
    instance = open_fmu("PendulumCartesian").initialize({"x": -0.9, "y": 0.1, "vx": 0.3, "vy": 0.2})
    length = np.hypot(0.9, 0.1)
    direction = np.array([-0.9, 0.1]) / length
    rest = np.array([0.3, 0.2]) - direction * (direction @ [0.3, 0.2])
    np.testing.assert_allclose(instance.get("x", "y", "vx", "vy"), [*direction, *rest], atol=1e-13)
    reported = [text for _, _, text in instance.messages if "moved to fulfil" in text]
    assert len(reported) == 1 and "x from -0.9 to -0.99388" in reported[0]


def test_fixed_start_values_stay(open_fmu):
    instance = open_fmu("FourBar").initialize()
    assert instance.get("theta", "omega") == [1.0, 8.0]
    assert any("phi from 0.4" in text and "theta" not in text for _, _, text in instance.messages)


def test_fixed_start_values_that_leave_no_solution(open_fmu):
    instance = open_fmu("FourBar")
    with instance.fails(ERROR, "constraint 'loop.*expected start values|its start is fixed"):
        instance.initialize({"theta": np.pi, "d": 1.2})


def test_redundant_constraints_differ_from_contradictory_ones(open_fmu):
    instance = open_fmu("Twice").initialize()
    assert any("'other' is redundant" in text for _, _, text in instance.messages)
    energy = instance.get("totalEnergy")
    for _ in range(200):
        instance.step(0.01)
    x, y, vx, vy, tension, other = instance.get("x", "y", "vx", "vy", "rod.force", "other.force")
    load = 1.5 * (-9.81 * y + vx**2 + vy**2)
    assert (tension, other) == (pytest.approx(load / 5, abs=1e-9), pytest.approx(2 * load / 5, abs=1e-9))
    assert abs(instance.get("totalEnergy") - energy) < 1e-8
    contrary = open_fmu("Contrary")
    with contrary.fails(ERROR, "'other' with the others: its residual is -0.1"):
        contrary.initialize()


@pytest.mark.parametrize("number", range(4))
@pytest.mark.parametrize("size", [0.01, 1.0])
def test_constraints_that_part_later(number, size, open_fmu):
    """A constraint that follows from the other at the start, but not later, stays active."""
    instance = open_fmu(f"Parting{number}").initialize()
    with instance.fails(DISCARD, r"the constraint 'c[01]' cannot be fulfilled with the others; expected constraints that are consistent"):
        while instance.time < 1:
            instance.step(size)
    assert instance.time < 1


def test_constraints_without_derivatives(open_fmu):
    for name, start in (("Whole0", {"x": 0.3, "y": 0.01}), ("Whole1", {"x": 0.5, "y": 0.0})):
        instance = open_fmu(name)
        with instance.fails(ERROR, "the derivatives of the constraint 'c0' vanish where it holds"):
            instance.initialize(start)


def test_start_values_from_afar(open_fmu):
    """Start values far away move to the nearest point of the circle, along the ray. A constraint without a finite value is an error."""
    for x, y in ((100.0, -3.0), (5.0, 5.0), (1e6, 1.0)):
        instance = open_fmu("Whole2").initialize({"x": x, "y": y})
        np.testing.assert_allclose(instance.get("x", "y"), np.array([x, y]) / np.hypot(x, y) / 2, atol=1e-9)
    instance = open_fmu("Whole3")
    with instance.fails(ERROR, "'c0' has no finite value at these start values"):
        instance.initialize({"x": -1.0})


def test_model_exchange_for_long():
    """The rod's length does not drift under FMPy's CVode at a loose tolerance."""
    import fmpy

    result = fmpy.simulate_fmu(
        str(fmu.archive("PendulumCartesian")), fmi_type="ModelExchange", stop_time=100, output_interval=0.5, relative_tolerance=1e-4,
        output=["x", "y"],
    )  # fmt: skip
    assert np.max(np.abs(np.hypot(result["x"], result["y"]) - 1)) < 5e-3


def test_a_step_that_fails_does_not_go_back(open_fmu):
    """
    The coordinate jumps at t = 0.2, within a solver step that covers earlier communication points. The failed step keeps a state no earlier
    than the last communication point.
    """
    instance = open_fmu("Jump").initialize()
    for _ in range(3):
        instance.step(0.05)
    before = instance.get("x")
    with instance.fails(DISCARD, "stopped at time 0.2 before"):
        instance.step(0.2)
    assert instance.get("x") >= before


def test_overconstrained_table(open_fmu):
    """
    A table on three cranks stays level although one crank is redundant. The cranks do not pass the flat position, where the table could
    fold.
    """
    instance = open_fmu("Table").initialize()
    assert any("'third' is redundant" in text for _, _, text in instance.messages)
    energy = instance.get("totalEnergy")
    for _ in range(500):
        instance.step(0.01)
        assert abs(instance.get("f")) < 1e-12 and abs(instance.get("x") - 0.5 - np.cos(instance.get("p"))) < 1e-12
    assert abs(instance.get("totalEnergy") - energy) < 1e-7


def test_limit_of_a_mechanism(open_fmu):
    """The tip reaches the limit of the workspace: sqrt(4 - 0.3^2) = 1 + 0.2 t at t = 4.887."""
    instance = open_fmu("PulledArm").initialize()
    while instance.time < 4.87:
        instance.step(0.01)
    with instance.fails(DISCARD, "stopped at time 4.88"):
        instance.step(0.1)
    reported = " ".join(text for status, _, text in instance.messages if status == 2)
    assert ("'pull'" in reported or "'line'" in reported) and "limit of a mechanism" in reported
    assert all(np.isfinite(instance.get("p", "q", "vp", "vq")))


def test_chain_of_rods(open_fmu):
    """A chain by positions with constraints and one by angles have the same motion, tensions and energies."""
    rods, angles = open_fmu("Rods8").initialize(tolerance=1e-11), open_fmu("Angles8").initialize(tolerance=1e-11)
    for _ in range(10):
        rods.step(0.1)
        angles.step(0.1)
        for i in range(1, 9):
            ours = rods.get(f"x[{i}]", f"y[{i}]", "totalEnergy")
            np.testing.assert_allclose(ours, angles.get(f"bob[{i}].x", f"bob[{i}].y", "totalEnergy"), atol=1e-7)


def test_long_run_keeps_constraints(open_fmu):
    """Constraint residuals do not accumulate over 20,000 s, some 300,000 solver steps. LONG_RUNS=1 runs a million."""
    import os

    instance = open_fmu("PendulumCartesian").initialize()
    for _ in range(60 if "LONG_RUNS" in os.environ else 5):
        instance.step(1000.0)
        x, y, vx, vy = instance.get("x", "y", "vx", "vy")
        assert abs(np.hypot(x, y) - 1) < 1e-12 and abs(x * vx + y * vy) < 1e-12
    assert instance.fmu.getInteger(instance.vr("solverSteps"))[0] > 50000


def test_a_parameter_that_is_tuned(open_fmu):
    """The rod becomes longer between two steps: the bob is moved to the new length, and the log reports it."""
    instance = open_fmu("PendulumCartesian").initialize()
    instance.step(0.5)
    instance.set(l=1.1)
    instance.step(0.5)
    assert np.hypot(*instance.get("x", "y")) == pytest.approx(1.1, abs=1e-14)
    assert any("moved to fulfil" in text for _, _, text in instance.messages)
    assert all(status <= WARNING for status, _, _ in instance.messages)


def test_a_parameter_that_is_tuned_beyond_reach(open_fmu):
    """The step is discarded and the state stays, so that an importer can try another value."""
    instance = open_fmu("FourBar").initialize()
    instance.step(0.1)
    state = instance.fmu.getFMUState()
    before = instance.get(*fmu.states_of("FourBar"))
    instance.set(d=9.0)
    with instance.fails(DISCARD, "time 0.1: after a parameter or an input was set, no coordinates near the present ones fulfil .*'loop"):
        instance.step(0.1)
    assert instance.get(*fmu.states_of("FourBar")) == before
    instance.fmu.setFMUState(state)
    instance.step(0.1)
    assert all(status <= DISCARD for status, _, _ in instance.messages)
    instance.free_state(state)


def test_jacobian(tmp_path):
    """Each column of the Jacobian equals the directional derivative along that state, which a test above compares with differences."""
    source = fmu.archive("Sliderbdf").parent.parent / "systems" / "Sliderbdf" / "system.c"
    words = ["gcc", "-O1", f"-I{fmu.ROOT}/include", f"-I{fmu.ROOT}/src/runtime", fmu.ROOT / "tests" / "c" / "jacobian.c", source, *runtime(2)]
    subprocess.run([*map(str, words), "-o", str(tmp_path / "jacobian")], check=True)
    states, elements, difference = subprocess.run([tmp_path / "jacobian"], capture_output=True, text=True, check=True).stdout.split()
    assert int(states) == 6 and int(elements) > 12 and float(difference) < 1e-12


def test_linearization():
    """Pendulum by x and y at rest below its pivot: der(vx) = -g/l x, and der(vy) = 0 to first order."""
    system = fmu.ROOT / "fmu" / "PendulumCartesian" / "system.xml"
    result = fmu.lagc("--linearize", system, "--at", "y=-1")
    assert result.returncode == 0 and "[-9.81, 0, 0, 0]\n  [0, 0, 0, 0]" in result.stdout
    wrong = fmu.lagc("--linearize", system, "--at", "y=-2")
    assert wrong.returncode == 1 and "the operating point does not fulfil the constraint 'rod': it is 1 at the parameters' start values" in wrong.stderr


MISTAKES = [
    ('<constraint name="c">l - 1</constraint>', "the constraint 'c' contains no coordinate"),
    ('<constraint name="c">vx*vy</constraint>', "the constraint 'c' is not linear in the velocities"),
    ('<constraint name="c" unit="m">x*y</constraint>', "unit mismatch: the constraint"),
    ('<constraint name="rod">x</constraint>', "the name 'rod' is already defined"),
    ('<constraint name="m">x</constraint>', "the name 'm' is already defined"),
    ('<constraint name="vx">x</constraint>', "the name 'vx' is already defined"),
    ('<define name="other">x</define>', "the name 'other' is already defined"),
    ('<constraint name="c">x - rod</constraint>', "'rod' is a constraint, whose value is 0; expected rod.force for its force"),
    ('<constraint name="c">x - c.force</constraint>', "constraint"),
    ('<constraint>x</constraint>', "name"),
]


@pytest.mark.parametrize("line, message", MISTAKES)
def test_mistakes(line, message, tmp_path):
    text = SYSTEMS["Twice"].replace("<experiment", line + "<experiment")
    (tmp_path / "system.xml").write_text(text)
    result = fmu.lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr


def test_nothing_of_it_is_in_other_fmus():
    members = (fmu.BUILD / "systems" / "DoublePendulum" / "link.map").read_text()
    for part in ("saddle", "projection.c"):
        assert f"({part}" not in members
    assert "saddle.c.o" in (fmu.BUILD / "systems" / "FourBar" / "link.map").read_text()


@pytest.mark.parametrize("name", ["Parting0", "Parting1"])
def test_messages_name_the_violated_constraint(name):
    messages = []
    log = lambda *words: messages.append(words[-1].decode())
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(str(fmu.archive(name)), stop_time=1, output_interval=0.1, fmi_type="ModelExchange", logger=log)
    assert any("the constraint 'c1' cannot be fulfilled with the others" in message for message in messages), messages
