"""Forces of reaction along virtual displacements, against Lagrange multipliers of an independent derivation."""

import re

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import fmu
import reactions_in_sympy
from fmu import lagc
from mechanics import time

BEARING = """<system name="DisplacedBearing" description="Rod on a hinge, with all that its bearing holds">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="b" start="0.3" unit="N.s/m"/>
  <parameter name="J" start="0.1" unit="kg.m2" min="0"/>
  <input name="F" unit="N"/>
  <input name="tau" unit="N.m"/>
  <coordinate name="theta" velocity="omega" unit="rad" start="1"/>
  <displacement name="stretch" unit="m" description="of the rod"/>
  <displacement name="px" unit="m"/>
  <displacement name="py" unit="m"/>
  <displacement name="turn" unit="rad" description="of the rod against its hinge"/>
  <define name="phi" unit="rad">theta + turn</define>
  <body name="bob" mass="m" x="px + (l + stretch)*sin(phi)" y="py - (l + stretch)*cos(phi)" inertia="J" angle="phi"/>
  <potential>m*g*bob.y</potential>
  <dissipation>b*(der(bob.x)^2 + der(bob.y)^2)/2</dissipation>
  <force on="bob" x="F" y="-2*F"/>
  <force coordinate="theta">tau</force>
  <output name="tension" unit="N">stretch.force</output>
  <output name="pull" unit="N">sqrt(px.force^2 + py.force^2)</output>
</system>
"""
CHAIN = """<system name="DisplacedChain" description="Rods on a pivot that moves with time">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="F" unit="N"/>
  <constant name="N" value="3"/>
  <for index="i" from="1" to="N">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" start="0.3*i"/>
    <displacement name="stretch[i]" unit="m"/>
    <particle name="bob[i]" mass="m" x="0.1*sin(2*time) + sum(j, 1, i, (l + stretch[j])*sin(theta[j]))"
              y="-sum(j, 1, i, (l + stretch[j])*cos(theta[j]))"/>
    <potential>m*g*bob[i].y</potential>
    <output name="T[i]" unit="N">stretch[i].force</output>
  </for>
  <force on="bob[N]" x="F"/>
</system>
"""
WIRE = """<system name="DisplacedWire" description="Charged bead on a wire in a magnetic field">
  <parameter name="m" start="1"/>
  <parameter name="l" start="1"/>
  <parameter name="b" start="1"/>
  <parameter name="k" start="1"/>
  <parameter name="J" start="1"/>
  <parameter name="u" start="1"/>
  <coordinate name="s" velocity="v" start="1"/>
  <displacement name="d"/>
  <particle name="bead" mass="m" x="s*cos(u) - d*sin(u)" y="s*sin(u) + d*cos(u)"/>
  <kinetic>J*(der(bead.x) + 2*der(bead.y))^2/2</kinetic>
  <potential>-b*(bead.x*der(bead.y) - bead.y*der(bead.x))/2 + k*(s - l + d/3)^2/2</potential>
  <output name="D">2*d.force + d</output>
</system>
"""
TEXTS = {"DisplacedBearing": BEARING, "DisplacedChain": CHAIN, "DisplacedWire": WIRE}


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("reactions", TEXTS)
    fmu.build_systems("reactions-tables", {name + "T": rename(text, name + "T") for name, text in TEXTS.items()}, "-DFORM=tables")


def rename(text, name):
    return re.sub(r'<system name="\w+"', f'<system name="{name}"', text)


def random_values(case, random):
    """One for each argument of the independent derivation; what is held as a displacement is 0, and so is its rate."""
    system = case.system
    values = {symbol: random.uniform(0.3, 2) for symbol in system.arguments}
    for i, (q, v) in enumerate(zip(system.q, system.v)):
        displaced = i in case.held and case.held[i] == 0
        values[q], values[v] = (0.0, 0.0) if displaced else random.uniform(-2, 2, 2)
    return values


def at(name, values, case, open_fmu):
    """The FMU in initialization mode at these values."""
    instance = open_fmu(name)
    instance.fmu.setupExperiment(startTime=values[time])
    known = {symbol.name: value for symbol, value in values.items() if symbol.name in instance.references}
    inputs = {symbol.name for symbol in case.system.inputs}
    instance.set({key: value for key, value in known.items() if key not in inputs and key != "time"})
    instance.fmu.enterInitializationMode()
    instance.set({key: value for key, value in known.items() if key in inputs})
    return instance


@pytest.mark.parametrize("form", ["", "T"])
@pytest.mark.parametrize("name", reactions_in_sympy.CASES)
def test_forces_are_multipliers(name, form, open_fmu):
    case = reactions_in_sympy.CASES[name]()
    random = np.random.default_rng(len(name))
    for _ in range(20):
        values = random_values(case, random)
        instance = at(name + form, values, case, open_fmu)
        _, forces = case.solve(*[values[symbol] for symbol in case.system.arguments])
        for force, expected in forces.items():
            assert instance.get(force) == pytest.approx(expected, rel=1e-10, abs=1e-10), force
        instance.free()
