"""Driven coordinates with every solver and in linear systems, and the work of the driving forces."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fmu
import reactions_in_sympy
from fmu import lagc
from constrained_systems import CRANE, METHODS, ROBOT, rename


@pytest.fixture(scope="module")
def cranes():
    """Build the crane with each solver, and the chain with <work>, whose mass matrix is factored symbolically."""
    texts = {f"Crane{m}": rename(CRANE.format(further=f'<work/><solver method="{m}"/>'), f"Crane{m}") for m in METHODS}
    texts["WorkingRobot"] = rename(ROBOT.format(further="<work/>"), "WorkingRobot")
    fmu.build_systems("cranes", texts)


@pytest.mark.parametrize("method", METHODS)
def test_every_solver_drives(method, cranes, open_fmu):
    """The motion agrees with DOP853 on the independent derivation; the energy changes by the work of force and drive."""
    case = reactions_in_sympy.CASES["DrivenCrane"]()
    start = fmu.start_values(f"Crane{method}") | {"F": 3.0, "u": 1.5, "v": 0.5}
    others = [start[s.name] for s in [*case.system.inputs, *case.system.parameters]]

    def derivative(t, state):
        x, theta, v, omega = state
        accelerations, _ = case.solve(t, x, theta, 0.0, v, omega, 0.0, *others)
        return [v, omega, *accelerations[:2]]

    exact = solve_ivp(derivative, (0, 2), [start[n] for n in ("x", "theta", "v", "omega")], method="DOP853",
                      rtol=1e-12, atol=1e-12).y[:, -1]  # fmt: skip
    instance = open_fmu(f"Crane{method}").initialize({key: start[key] for key in ("F", "u", "v")}, 1e-9)
    before = instance.get("totalEnergy")
    instance.run(2, 0.5, "x")
    np.testing.assert_allclose(instance.get("x", "theta", "v", "omega"), exact, rtol=1e-6, atol=1e-7)
    work = instance.get("nonConservativeWork")
    assert work > 10 and instance.get("totalEnergy") - before == pytest.approx(work, rel=1e-7)


def test_work_of_drives_in_a_chain(cranes, open_fmu):
    instance = open_fmu("WorkingRobot").initialize({"u": 0.7, "omega[2]": 1.0}, 1e-11)
    before, works = instance.get("totalEnergy"), []
    for _ in range(8):
        instance.step(0.25)
        works.append(instance.get("nonConservativeWork"))
        assert instance.get("totalEnergy") - before == pytest.approx(works[-1], rel=1e-8, abs=1e-8)
    assert max(np.abs(works)) > 1


PRESCRIBED_SPRING = """<system name="DrivenSpring">
  <parameter name="m" start="2" unit="kg"/>
  <parameter name="k" start="18" unit="N/m"/>
  <input name="u" unit="m/s2"/>
  <coordinate name="x" velocity="v" unit="m" acceleration="{}"/>
  <coordinate name="y" velocity="w" unit="m"/>
  <particle mass="m" x="x + y"/>
  <potential>k*y^2/2</potential>
  <solver method="exact"/>
</system>
"""


def test_linear_systems_with_drives(open_fmu):
    """y'' = -u - 9 y: y = -u/9 (1 - cos 3 t), by the exact method for linear systems."""
    fmu.build_systems("drivenspring", {"DrivenSpring": PRESCRIBED_SPRING.format("u")})
    instance = open_fmu("DrivenSpring").initialize({"u": 4.5})
    instance.step(2.0)
    assert instance.get("x") == pytest.approx(9.0, rel=1e-12)
    assert instance.get("y") == pytest.approx(-0.5 * (1 - np.cos(6)), rel=1e-12)
    assert instance.get("x.force") == pytest.approx(-18 * instance.get("y"), rel=1e-12)  # from the force of the spring


def test_linear_systems_are_not_driven_by_time(tmp_path):
    (tmp_path / "system.xml").write_text(PRESCRIBED_SPRING.format("9.81*sin(time)"))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(r"der\(v\) depends on time; expected a method other than 'exact'", result.stderr)


def test_linearized_crane(tmp_path):
    """x'' = u at any state; theta'' = -(g theta + u)/l - b omega/(m l^2)."""
    (tmp_path / "system.xml").write_text(CRANE.format(further=""))
    result = lagc("--linearize", "system.xml", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "[0, 0, 0, 0]\n  [0, -g/l, 0, -b/(m*l^2)]" in result.stdout and "[0, 1]\n  [0, -1/l]" in result.stdout
