"""
Adjoint derivatives by a reverse sweep (lagc --adjoint), against directional derivatives, which are derived separately; and their cost.
"""

import time

import fmpy.fmi3
import numpy as np
import pytest

import fmi3
from building import build_systems
from fmu import ROOT
from linked import linked_members

# Covers inactive pieces whose base has no logarithm, powers, work, dissipation, a force on a point, and outputs with accelerations.
MIXED = """<system name="Mixed"><parameter name="m" start="0.3" unit="kg"/><parameter name="l" start="0.7" unit="m"/>
  <parameter name="b" start="0.2" unit="N.m.s/rad"/><parameter name="k" start="12" unit="N/m"/><parameter name="n" start="1.5" unit="1"/>
  <parameter name="c" start="3" unit="N.s/m"/><parameter name="s" start="2" unit="m/s"/><parameter name="w" start="0.9" unit="1/s"/>
  <input name="F" unit="N" start="0.4"/>
  <coordinate name="x" velocity="v" unit="m" start="-0.1" velocityStart="0.3"/><coordinate name="theta" velocity="omega" unit="rad" start="0.8" velocityStart="-1"/>
  <particle name="cart" mass="2*m" x="x"/><particle name="bob" mass="m" x="x + l*sin(theta)" y="-l*cos(theta)"/><gravity y="-9.81"/>
  <potential>k*x^2/2 + k*x^4/l^2 + if(x &gt; 0, k*(1 + x/l)^n*l^2, 0)</potential><dissipation>b*omega^2/2 + abs(v)^3*c/s</dissipation>
  <force coordinate="x">F*exp(-w*time)</force><work/>
  <output name="push" unit="N">m*der(v) + k*x*tanh(F/(k*l))</output><output name="lean" unit="1">tanh(theta)*l/s*w</output></system>"""
# Systems of fmu/ under other names, since other tests build the originals without --adjoint.
CONSTRAINED = {f"Adjoint{name}": (ROOT / "fmu" / name / "system.xml").read_text().replace(f'name="{name}"', f'name="Adjoint{name}"') for name in ("FourBar", "ChainPendulum")}
CONSTRAINED["AdjointBranchedArm"] = (ROOT / "tests" / "support" / "branched_arm.xml").read_text().replace('name="BranchedArm"', 'name="AdjointBranchedArm"')


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("adjoint", {"Mixed": MIXED} | CONSTRAINED, "--adjoint", versions=(3,))


def model(name):
    """An instance in continuous-time mode, with the names of its unknowns and knowns."""
    instance = fmi3.Instance(name, kind=fmpy.fmi3.FMU3Model)
    variables = instance.description.modelVariables
    unknowns = [u.variable.name for u in instance.description.derivatives] + [v.name for v in variables if v.causality == "output"]
    states = [u.variable.derivative.name for u in instance.description.derivatives]
    knowns = states + [v.name for v in variables if v.causality == "input"] + [v.name for v in variables if v.causality == "parameter" and v.type == "Float64"]
    instance.initialize()
    instance.fmu.updateDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    return instance, unknowns, knowns


@pytest.mark.parametrize("name", ["Mixed", *CONSTRAINED])
def test_adjoint_derivatives_are_transposed_directional_ones(name):
    """
    Adjoint derivatives of a sum of all unknowns agree with directional ones for each known. Systems have small blocks of M, a block factored at run
    time, a closed loop, and a tree of joints.
    """
    instance, unknowns, knowns = model(name)
    across = np.random.default_rng(1).standard_normal(len(unknowns))
    adjoint = instance.partial("Adjoint", unknowns, knowns, across)
    for known, derivative in zip(knowns, adjoint):
        assert derivative == pytest.approx(across @ instance.partial("Directional", unknowns, [known], [1.0]), rel=1e-11, abs=1e-12), known
    instance.free()


def test_errors_are_those_of_directional_derivatives():
    instance, unknowns, knowns = model("Mixed")
    for unknown, known, why in (("m", "x", "'m' is not an unknown"), ("push", "push", "'push' is not a known")):
        with pytest.raises(fmpy.fmi1.FMICallException):
            instance.partial("Adjoint", [unknown], [known], [1.0])
        assert why in instance.messages[-1][2]
        instance.fmu.reset()
        instance.initialize()
        instance.fmu.updateDiscreteStates()
        instance.fmu.enterContinuousTimeMode()
    instance.free()


def test_the_sweep_costs_the_same_for_all_knowns():
    """The sweep of a chain of ten links costs the same for one parameter as for all states and parameters."""
    instance, unknowns, knowns = model("AdjointChainPendulum")
    across = np.ones(len(unknowns))

    def duration(by):
        begin = time.process_time()
        for _ in range(200):
            instance.partial("Adjoint", unknowns, by, across)
        return time.process_time() - begin

    ratio = min(duration(knowns) / duration(knowns[:1]) for _ in range(5))
    assert ratio < 3, "a column for each of 23 knowns would take 23 times as long"
    instance.free()


def test_only_fmus_with_adjoint_contain_it():
    assert not any("reverse_sweep" in member for member in linked_members("DampedPendulum", "link3.map"))
    assert any("reverse_sweep" in member for member in linked_members("Mixed"))
