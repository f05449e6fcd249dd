"""<state>: first-order states, beside coordinates and alone, with all methods, against closed forms and SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import fmu
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


@pytest.fixture(scope="module")
def systems():
    texts = {f"Lag_{method}": LAG.format(name=f"Lag_{method}", method=method) for method in [*METHODS, "exact"]}
    for method in METHODS:
        texts[f"Filter_{method}"] = PENDULUM.format(name=f"Filter_{method}", method=method, T=0.05)
    texts["Filter_stiff"] = PENDULUM.format(name="Filter_stiff", method="auto", T=1e-5)
    build_systems("states", texts, versions=(2, 3))


@pytest.mark.parametrize("method", [*METHODS, "exact"])
def test_linear_states(systems, open_fmu, method):
    """An actuator with lag and an integral of the error: the matrix exponential of the equations by hand."""
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
