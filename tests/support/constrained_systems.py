"""Systems with displacements, driven coordinates and inputs with derivatives, and functions that test them."""

import re

import numpy as np
import pytest

import fmu
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
  <constant name="sway" value="0.1" unit="m"/>
  <for index="i" from="1" to="N">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" start="0.3*i"/>
    <displacement name="stretch[i]" unit="m"/>
    <particle name="bob[i]" mass="m" x="sway*sin(2*time) + sum(j, 1, i, (l + stretch[j])*sin(theta[j]))"
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
CRANE = """<system name="DrivenCrane" description="Load on a crane whose trolley is driven">
  <parameter name="M" start="10" unit="kg" min="0"/>
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="2" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="b" start="0.3"/>
  <parameter name="k" start="5" unit="N/m"/>
  <input name="F" unit="N"/>
  <input name="u" unit="m/s2"/>
  <coordinate name="x" velocity="v" unit="m" acceleration="pull"/>
  <define name="pull" unit="m/s2">u</define>
  <coordinate name="theta" velocity="omega" unit="rad" start="0.2"/>
  <displacement name="stretch" unit="m"/>
  <particle name="trolley" mass="M" x="x"/>
  <particle name="load" mass="m" x="x + (l + stretch)*sin(theta)" y="-(l + stretch)*cos(theta)"/>
  <potential>m*g*load.y + k*x^2/2</potential>
  <dissipation>b*v^2/2 + b*omega^2/2</dissipation>
  <force on="trolley" x="F"/>
  <output name="drive" unit="N">x.force</output>
  <output name="rate" unit="m/s2">der(v)</output>
  {further}
</system>
"""
ROBOT = """<system name="DrivenRobot" description="Rods, of which some are driven">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="a" start="3" unit="rad/s2"/>
  <input name="u" unit="rad/s2"/>
  <coordinate name="theta[1]" velocity="omega[1]" unit="rad" start="1"/>
  <coordinate name="theta[2]" velocity="omega[2]" unit="rad" acceleration="a*cos(3*time)"/>
  <for index="i" from="3" to="3"><coordinate name="theta[i]" velocity="omega[i]" unit="rad"/></for>
  <for index="i" from="4" to="4">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" acceleration="(i - 2)*u"/>
  </for>
  <for index="i" from="1" to="4">
    <particle name="bob[i]" mass="m" x="sum(j, 1, i, l*sin(theta[j]))" y="-sum(j, 1, i, l*cos(theta[j]))"/>
    <potential>m*g*bob[i].y</potential>
  </for>
  <output name="torque" unit="N.m">theta[2].force</output>
  {further}
</system>
"""
ARM = """<system name="DrivenArm" description="Arm of two driven joints">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="u" unit="rad/s2"/>
  <coordinate name="alpha" velocity="va" unit="rad" acceleration="u"/>
  <coordinate name="beta" velocity="vb" unit="rad" velocityStart="2" acceleration="0"/>
  <particle name="elbow" mass="m" x="l*cos(alpha)" y="l*sin(alpha)"/>
  <particle name="hand" mass="3*m" x="elbow.x + 2*l*cos(alpha + beta)" y="elbow.y + 2*l*sin(alpha + beta)"/>
  <potential>m*g*(elbow.y + 3*hand.y)</potential>
  <output name="torque" unit="N.m">alpha.force</output>
  {further}
</system>
"""
SEAT = """<system name="MovedSeat" description="Seat and driver on a floor that moves">
  <parameter name="M" start="20" unit="kg" min="0"/>
  <parameter name="m" start="60" unit="kg" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="b" start="200" unit="N.s/m"/>
  <parameter name="a" start="400" unit="N.s/m"/>
  <parameter name="k" start="8000" unit="N/m"/>
  <parameter name="h" start="1" unit="m"/>
  <input name="F" unit="N"/>
  <input name="zb" unit="m" derivatives="2"/>
  <coordinate name="x" velocity="v" unit="m"/>
  <coordinate name="y" velocity="w" unit="m"/>
  <displacement name="s" unit="m"/>
  <particle name="seat" mass="M" x="x"/>
  <particle name="driver" mass="m" x="y"/>
  <particle name="knob" mass="0" x="x + zb^2/h/2"/>
  <potential>M*g*x + m*g*y + k*(x + s - zb)^2/2 + 2*k*(y - x)^2/2</potential>
  <dissipation>b*(v - der(zb))^2/2 + a*(w - v)^2/2</dissipation>
  <force on="knob" x="F"/>
  <output name="rise" unit="m/s2">der(der(zb))</output>
  {further}
</system>
"""
HOIST = """<system name="MovedHoist" description="Rods on a pivot that moves, the first drawn in">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="xp" unit="m" derivatives="2"/>
  <input name="L" start="0.8" unit="m" min="-9" derivatives="2"/>
  <for index="i" from="1" to="3">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" start="0.2*i"/>
    <particle name="bob[i]" mass="m" x="xp + L*sin(theta[1]) + sum(j, 2, i, l*sin(theta[j]))"
              y="-L*cos(theta[1]) - sum(j, 2, i, l*cos(theta[j]))"/>
    <potential>m*g*bob[i].y</potential>
  </for>
  <output name="speed" unit="m/s">der(bob[2].x)</output>
  {further}
</system>
"""
TABLE = """<system name="MovedTable" description="Bead on a table that is turned from outside">
  <parameter name="m" start="1"/>
  <parameter name="l" start="1"/>
  <parameter name="b" start="1"/>
  <parameter name="k" start="1"/>
  <parameter name="J" start="1"/>
  <input name="phi" derivatives="2"/>
  <coordinate name="r" velocity="vr" start="1"/>
  <particle name="bead" mass="m" x="r*cos(phi)" y="r*sin(phi)"/>
  <kinetic>J*(vr/l + der(phi))^2/2</kinetic>
  <potential>-b*(bead.x*der(bead.y) - bead.y*der(bead.x))/2 + k*r^2/2</potential>
  <output name="across">der(bead.y)</output>
  {further}
</system>
"""

# The solvers that accept every system.
METHODS = ["taylor", "radau", "auto", "bdf", "erk"]


def rename(text, name):
    return re.sub(r'<system name="\w+"', f'<system name="{name}"', text)


def random_values(case, random, names):
    """Random values for each argument of the independent derivation; displacements and their rates are 0."""
    system = case.system
    values = {symbol: random.uniform(0.3, 2) for symbol in system.arguments}
    for i, (q, v) in enumerate(zip(system.q, system.v)):
        values[q], values[v] = random.uniform(-2, 2, 2)
        if i in case.prescribed and q.name not in names:
            values[q] = values[v] = 0.0
    return values


def at(name, values, case, open_fmu):
    """Return the FMU in initialization mode at these values."""
    instance = open_fmu(name)
    instance.fmu.setupExperiment(startTime=values[time])
    known = {symbol.name: value for symbol, value in values.items() if symbol.name in instance.references}
    inputs = set(fmu.names_of(name, "input"))
    instance.set({key: value for key, value in known.items() if key not in inputs and key != "time"})
    instance.fmu.enterInitializationMode()
    instance.set({key: value for key, value in known.items() if key in inputs})
    return instance


def move(instance, motions, time):
    """Set inputs and their derivatives to polynomials (of numpy) from this time on."""
    for name, polynomial in motions.items():
        rates = [polynomial.deriv(k) if k > 0 else polynomial for k in range(3)]
        for rate, variable in zip(rates, (name, f"der({name})", f"der(der({name}))")):
            instance.set({variable: rate(time)})
    references, orders, values = [], [], []
    for name, polynomial in motions.items():
        for k, variable in enumerate((name, f"der({name})", f"der(der({name}))")):
            for order in (1, 2, 3):
                references += instance.vr(variable)
                orders.append(order)
                values.append(polynomial.deriv(k + order)(time))
    instance.fmu.setRealInputDerivatives(references, orders, values)


def check_balance(instance, motions, stop, steps, least):
    """Check that totalEnergy changes by nonConservativeWork at all communication points, for inputs with consistent derivatives."""
    move(instance, motions, 0.0)
    before, works = instance.get("totalEnergy"), []
    for time in np.linspace(0, stop, steps + 1)[1:]:
        instance.step(time - instance.time)
        move(instance, motions, time)
        works.append(instance.get("nonConservativeWork"))
        assert instance.get("totalEnergy") - before == pytest.approx(works[-1], rel=1e-7, abs=1e-7)
    assert max(np.abs(works)) > least
