"""<state>: first-order states, with coordinates and alone, with all methods, against closed forms and SciPy."""

import re

import fmpy
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import fmi3
import fmu
from ensemble_runs import alone, ensemble, starts, states
from fmu import build_systems, lagc

METHODS = ["taylor", "auto", "radau", "bdf", "erk"]
LAG = """<system name="{name}">
  <parameter name="m" start="2" unit="kg"/><parameter name="k" start="8" unit="N/m"/><parameter name="T" start="0.5" unit="s"/>
  <parameter name="kp" start="3" unit="N/m"/><parameter name="F0" start="0.1" unit="N"/>
  <input name="ref" unit="m" start="1"/>
  <coordinate name="x" velocity="v" unit="m" start="0.3"/>
  <state name="F" unit="N" start="F0" rate="(kp*(ref - x) - F)/T" description="force of the actuator"/>
  <state name="xi" unit="m.s" rate="ref - x"/>
  <particle mass="m" x="x"/>
  <potential>k*x^2/2</potential>
  <force coordinate="x">F</force>
  <output name="Fdot" unit="N/s">der(F)</output>
  <solver method="{method}" tolerance="1e-11"/>
</system>
"""
PENDULUM = """<system name="{name}">
  <parameter name="T" start="{T}" unit="s"/><parameter name="b" start="0.4" unit="N.m.s/rad"/>
  <parameter name="J" start="1" unit="kg.m2"/><parameter name="U" start="9.81" unit="J"/>
  <coordinate name="theta" velocity="omega" unit="rad" start="2"/>
  <state name="filtered" unit="rad/s2" rate="(der(omega) - filtered)/T"/>
  <state name="dose" unit="rad2.s" rate="theta^2"/>
  <state name="tau" unit="N.m" rate="(-b*omega - tau)/T"/>
  <kinetic>J*omega^2/2</kinetic><potential>U*(1 - cos(theta))</potential>
  <force coordinate="theta">tau</force>
  <solver method="{method}" tolerance="1e-11"/>
</system>
"""


PID = """<system name="Pid"><parameter name="kp" start="2"/><parameter name="Ti" start="0.5" unit="s"/>
<parameter name="Td" start="0.1" unit="s"/><parameter name="N" start="10"/><parameter name="limit" start="5"/>
<input name="e"/><state name="I" unit="s" rate="e"/><state name="D" rate="N/Td*(e - D)"/>
<output name="u">min(limit, max(-limit, kp*(e + I/Ti + N*(e - D))))</output></system>"""
NETWORK = """<system name="Heat"><constant name="N" value="8"/><parameter name="c" start="2"/><input name="P" start="1"/>
<for index="i" from="1" to="N"><state name="T[i]" start="i"
  rate="c*(sum(j, max(1, i - 1), min(N, i + 1), T[j] - T[i])) + if(i > 1, 0, P)"/></for></system>"""
ROD = """<system name="Rod"><coordinate name="x" velocity="vx" start="1"/><coordinate name="y" velocity="vy"/><parameter name="m" start="1"/>
<particle name="bob" mass="m" x="x" y="y"/><potential>m*9.81*y</potential><constraint name="rod">(x^2 + y^2 - 1)/2</constraint>
<state name="pull" rate="rod.force"/><state name="lag" rate="(der(vx) - lag)/0.1"/><force coordinate="x">-0.3*lag</force>
<output name="felt">pull + der(lag)</output>{solver}</system>"""
# The mass matrix is factored at run time.
COUPLED = """<system name="Coupled">{coordinates}
<kinetic>(va^2 + vb^2 + vc^2 + vd^2 + ve^2 + (va + vb + vc + vd + ve)^2*(1 + sin(a)^2))/2</kinetic>
<potential>a^2 + b^2 + c^2 + d^2 + e^2 + a*b*c</potential>
<state name="s" rate="der(va) + der(vc)*b - s"/><force coordinate="b">s</force></system>""".format(
    coordinates="".join(f'<coordinate name="{q}" velocity="v{q}" start="{int(q == "a")}"/>' for q in "abcde")
)
BALL = """<system name="Ball"><coordinate name="h" velocity="v" start="1"/><particle mass="2" y="h"/><potential>2*9.81*h</potential>
<contact name="ground" gap="h" restitution="0.5"/>
<state name="push" rate="ground.force"/><state name="count" rate="0"/><state name="z" start="1" rate="-z"/>
<event when="v" direction="rising"><set state="count">count + 1</set></event>
<event when="time - 1" direction="rising"><set state="z">3*z + 1</set></event></system>"""
BLOCK = """<system name="Block"><coordinate name="x" velocity="v" velocityStart="2"/><particle mass="2" x="x"/>
<friction name="rub" coordinate="x" force="3"/><force coordinate="x">if(time &lt; 2, 0, 2*(time - 2))</force>
<state name="heat" rate="rub.force*v"/><state name="worn" rate="abs(rub.force*v) - worn"/></system>"""
FADING = """<system name="Fading"><parameter name="mu" start="0.5"/><coordinate name="x" velocity="v" velocityStart="20"/><particle mass="2" x="x"/>
<coordinate name="y" velocity="vy"/><particle mass="2" y="y"/><potential>2*9.81*y</potential><contact name="ground" gap="y"/>
<state name="hot" rate="brake.force*v/500"/><friction name="brake" coordinate="x" force="mu*ground.force/(1 + hot)"/><work/></system>"""


@pytest.fixture(scope="module")
def systems():
    texts = {f"Lag_{method}": LAG.format(name=f"Lag_{method}", method=method) for method in [*METHODS, "exact"]}
    for method in METHODS:
        texts[f"Filter_{method}"] = PENDULUM.format(name=f"Filter_{method}", method=method, T=0.05)
    texts["Filter_stiff"] = PENDULUM.format(name="Filter_stiff", method="auto", T=1e-5)
    texts |= {"Pid": PID, "Heat": NETWORK, "Rod": ROD.format(solver=""), "Coupled": COUPLED, "Ball": BALL, "Block": BLOCK, "Fading": FADING}
    build_systems("states", texts, versions=(2, 3))


@pytest.mark.parametrize("method", [*METHODS, "exact"])
def test_linear_states(systems, open_fmu, method):
    """An actuator with lag and an integral of the error follows the matrix exponential of the equations by hand."""
    m, k, T, kp, ref = 2, 8, 0.5, 3, 1
    a = np.array([[0, 1, 0, 0, 0], [-k / m, 0, 1 / m, 0, 0], [-kp / T, 0, -1 / T, 0, kp / T * ref], [-1, 0, 0, 0, ref], [0, 0, 0, 0, 0]])
    instance = open_fmu(f"Lag_{method}").initialize()
    expected = np.array([0.3, 0, 0.1, 0, 1])
    for i in range(20):
        instance.run(0.25 * (i + 1), 0.25)
        expected = expm(0.25 * a) @ expected
        found = [instance.get(name) for name in ("x", "v", "F", "xi")]
        np.testing.assert_allclose(found, expected[:4], rtol=1e-8, atol=1e-8)
        assert abs(instance.get("Fdot") - (a @ expected)[2]) < 1e-7


def pendulum_rates(T, b=0.4):
    def rates(t, y):
        theta, omega, filtered, _, tau = y
        alpha = -9.81 * np.sin(theta) + tau
        return [omega, alpha, (alpha - filtered) / T, theta**2, (-b * omega - tau) / T]

    return rates


@pytest.mark.parametrize("name, T", [*((f"Filter_{method}", 0.05) for method in METHODS), ("Filter_stiff", 1e-5)])
def test_rates_of_accelerations(systems, open_fmu, name, T):
    instance = open_fmu(name).initialize()
    solution = solve_ivp(pendulum_rates(T), [0, 3], [2, 0, 0, 0, 0], method="Radau", rtol=1e-11, atol=1e-12, t_eval=[1, 2, 3])
    for i in range(3):
        instance.run(i + 1, 0.5)
        found = [instance.get(n) for n in ("theta", "omega", "filtered", "dose", "tau")]
        np.testing.assert_allclose(found, solution.y[:, i], rtol=2e-7, atol=2e-7)


def test_a_controller_without_coordinates(systems, open_fmu):
    instance = open_fmu("Pid").initialize({"e": 1})
    t, integral, filtered, u = np.transpose(instance.run(2, 0.05, "I", "D", "u"))
    np.testing.assert_allclose(integral, t, atol=1e-12)
    np.testing.assert_allclose(filtered, 1 - np.exp(-100 * t), atol=1e-9)
    np.testing.assert_allclose(u, np.clip(2 * (1 + t / 0.5 + 10 * np.exp(-100 * t)), -5, 5), atol=1e-8)


def test_a_network(systems, open_fmu):
    n, start = 8, np.arange(1.0, 9)
    a = np.zeros((n + 1, n + 1))
    for i in range(n):
        for j in (i - 1, i + 1):
            if 0 <= j < n:
                a[i, j] += 2
                a[i, i] -= 2
    a[0, n] = 1
    instance = open_fmu("Heat").initialize({"P": 1})
    instance.run(3, 0.5)
    expected = expm(3 * a) @ [*start, 1]
    np.testing.assert_allclose([instance.get(f"T[{i + 1}]") for i in range(n)], expected[:n], rtol=1e-9)


def rod_rates(t, state):
    x, y, vx, vy, _, lag = state
    force, q, v = np.array([-0.3 * lag, -9.81]), np.array([x, y]), np.array([vx, vy])
    pull = (q @ force + v @ v) / (q @ q)
    a = force - pull * q
    return [vx, vy, *a, pull, (a[0] - lag) / 0.1]


def test_rates_of_forces_of_constraints(systems, open_fmu):
    solution = solve_ivp(rod_rates, [0, 2], [1, 0, 0, 0, 0, 0], rtol=1e-12, atol=1e-13)
    instance = open_fmu("Rod").initialize()
    instance.run(2, 0.1)
    found = [instance.get(name) for name in ("x", "y", "vx", "vy", "pull", "lag")]
    np.testing.assert_allclose(found, solution.y[:, -1], atol=1e-9)
    assert abs(instance.get("felt") - found[4] - rod_rates(0, found)[5]) < 1e-9


def coupled_rates(t, state):
    q, v, s = state[:5], state[5:10], state[10]
    total, factor, slope = v.sum(), 1 + np.sin(q[0]) ** 2, np.sin(2 * q[0])
    force = -2 * q - np.array([q[1] * q[2], q[0] * q[2], q[0] * q[1], 0, 0]) - slope * v[0] * total
    force[0] += total**2 * slope / 2
    force[1] += s
    a = np.linalg.solve(np.eye(5) + factor, force)
    return [*v, *a, a[0] + a[2] * q[1] - s]


def test_rates_of_accelerations_of_a_large_block(systems, open_fmu):
    solution = solve_ivp(coupled_rates, [0, 5], [1] + [0] * 10, rtol=1e-12, atol=1e-13)
    instance = open_fmu("Coupled").initialize()
    instance.run(5, 0.5)
    np.testing.assert_allclose([instance.get(name) for name in "abcdes"], solution.y[[0, 1, 2, 3, 4, 10], -1], atol=1e-9)


def test_events_set_states(systems, open_fmu):
    """The ball rests from 3 t0 on, t0 = sqrt(2/g), and its weight acts from then on; an event resets z at 1 s."""
    instance = open_fmu("Ball").initialize()
    instance.run(2, 0.01)
    rest = 3 * np.sqrt(2 / 9.81)
    assert abs(instance.get("push") - 2 * 9.81 * (2 - rest)) < 1e-6
    assert abs(instance.get("z") - (3 * np.exp(-1) + 1) * np.exp(-1)) < 1e-9
    assert instance.get("count") == int(instance.get("count")) > 10


def test_heat_of_friction(systems, open_fmu):
    """The block's kinetic energy of 4 J becomes heat while it slides to rest in 4/3 s; from 3.5 s on the force moves it."""
    instance = open_fmu("Block").initialize()
    instance.run(1.5, 0.1)
    assert abs(instance.get("heat") - 4) < 1e-9
    instance.run(6, 0.1)
    assert abs(instance.get("heat") - (4 + 3 * 2.5**3 / 6)) < 1e-8


def test_a_brake_that_fades(systems, open_fmu):
    """The heat of the brake equals the work that <work/> counts, with the normal force of a contact."""
    def rates(t, y):
        force = 0.5 * 2 * 9.81 / (1 + y[1])
        return [-force / 2, force * y[0] / 500]

    solution = solve_ivp(rates, [0, 3], [20, 0], rtol=1e-11, atol=1e-12)
    instance = open_fmu("Fading").initialize()
    instance.run(3, 0.1)
    np.testing.assert_allclose([instance.get("v"), instance.get("hot")], solution.y[:, -1], rtol=1e-8)
    assert abs(instance.get("nonConservativeWork") + 500 * solution.y[1, -1]) < 1e-6
    assert abs(instance.get("v") ** 2 - 400 - instance.get("nonConservativeWork")) < 1e-6


MESSAGES = {
    "circle": ('<state name="a" rate="der(b)"/><state name="b" rate="der(a)"/>', r"1: .*circle: der\(a\) -> der\(b\) -> der\(a\)"),
    "itself": ('<state name="a" rate="der(a)"/>', r"circle: der\(a\) -> der\(a\)"),
    "no rate": ('<state name="a"/>', "<state> needs the attribute 'rate'"),
    "unit": ('<state name="a" unit="m" rate="b"/><parameter name="b" unit="m" start="1"/>', "the rate has the unit m, expected m/s"),
    "position": ('<coordinate name="x" velocity="v"/><state name="a" rate="v"/><particle mass="1" x="x + a"/>', "needs the second derivative of the state 'a', whose rate depends on 'v'"),
    "acceleration": ('<coordinate name="x" velocity="v"/><state name="a" rate="der(v)"/><particle mass="1" x="x"/><force coordinate="x">der(a)</force>', r"cannot depend on accelerations, but der\(...\) does"),
    "range": ('<state name="a" rate="1" start="3" max="2"/>', "'a': start 3 is outside min and max"),
    "set": ('<state name="a" rate="1"/><event when="a - 1"><set state="b">0</set></event>', "there is no state of this name"),
}


@pytest.mark.parametrize("case", MESSAGES)
def test_messages(case, tmp_path):
    text, message = MESSAGES[case]
    (tmp_path / "system.xml").write_text(f'<system name="Bad">{text}</system>')
    result = lagc(tmp_path / "system.xml", "-o", tmp_path / "out")
    assert result.returncode == 1 and re.search(message, result.stderr), result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name, ranges", [("Filter_taylor", {"theta": (0.5, 2), "tau": (-1, 1)}), ("Block", {"v": (1, 3)}), ("Ball", {"h": (0.5, 1.5), "z": (0, 2)}),
                                          ("Coupled", {"a": (0.5, 1), "s": (-1, 1)}), ("Rod", {"lag": (-1, 1)})])  # fmt: skip
def test_many_runs_at_once(systems, name, ranges):
    rows = starts(ranges, 9)
    recorded = states(name)
    values, needs_fmu = ensemble(name, ranges, recorded, [0, 1, 2]).run(rows)
    assert not needs_fmu.any()
    for row, value in zip(rows, values):
        expected = alone(name, dict(zip(ranges, row)), recorded, 2, 2)
        np.testing.assert_allclose(value, expected, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize("name", ["Filter_auto", "Filter_radau", "Rod", "Ball", "Block", "Pid"])
def test_a_saved_state_continues_with_the_same_bits(systems, open_fmu, name):
    instance, names = open_fmu(name).initialize(), states(name)
    instance.run(0.7, 0.1)
    saved = instance.fmu.getFMUstate()
    first = instance.run(1.6, 0.1, *names)
    instance.fmu.setFMUstate(saved)
    instance.time = 0.7
    assert instance.run(1.6, 0.1, *names) == first
    instance.free_state(saved)


@pytest.mark.parametrize("name", ["Filter_auto", "Block", "Pid", "Rod"])
def test_model_exchange(systems, name):
    """FMPy's CVode in both versions of FMI, and co-simulation of FMI 3.0, agree with co-simulation of FMI 2.0."""
    recorded = states(name)
    exact = alone(name, {}, recorded, 2)[-1]
    for archive in (fmu.archive(name), fmi3.archive(name)):
        result = fmpy.simulate_fmu(str(archive), fmi_type="ModelExchange", stop_time=2, output=recorded, relative_tolerance=1e-9)
        np.testing.assert_allclose(list(result[-1])[1:], exact, rtol=2e-5, atol=2e-5)
    result = fmpy.simulate_fmu(str(fmi3.archive(name)), stop_time=2, output=recorded, relative_tolerance=1e-10)
    np.testing.assert_allclose(list(result[-1])[1:], exact, rtol=1e-8, atol=1e-8)


def test_derivatives_of_the_motion(open_fmu):
    """--along adds the derivatives of all states by a parameter as states; they agree with differences of runs."""
    build_systems("states-along", {"Filter_along": PENDULUM.format(name="Filter_along", method="taylor", T=0.3)}, "--along", "T", "--along", "tau")
    instance, h = open_fmu("Filter_along").initialize(), 1e-4
    instance.run(2, 0.5)

    def end(T, tau):
        return solve_ivp(pendulum_rates(T), [0, 2], [2, 0, 0, 0, tau], rtol=1e-12, atol=1e-13).y[:, -1]

    for by, ends in (("T", [end(0.3 + s * h, 0) for s in (1, -1)]), ("tau", [end(0.3, s * h) for s in (1, -1)])):
        found = [instance.get(f"{name}.by.{by}") for name in ("theta", "omega", "filtered", "dose", "tau")]
        np.testing.assert_allclose(found, (ends[0] - ends[1]) / (2 * h), rtol=1e-5, atol=1e-5)
