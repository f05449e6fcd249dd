"""Outputs are names for expressions, as definitions: forces, rates, definitions, positions and events use them, wherever they stand."""

import re

import numpy as np
import pytest

import fmu
from fmu import Instance, build_systems, lagc

# A mass on a spring; everything uses outputs that stand below.
ABOVE = """<system name="{name}">
  <parameter name="k" start="8" unit="N/m"/><parameter name="m" start="2" unit="kg"/>
  <force coordinate="x">-pull - sum(i, 1, 2, share[i])</force>
  <state name="z" unit="N.s" rate="pull + sum(i, 1, 2, i*share[i])/1.5"/>
  <define name="twice" unit="N">2*pull</define>
  <event when="right - 0.5" direction="falling"><set mode="n">n + floor(10*abs(right - 1))</set></event>
  <event when="moving > 0.5"><set mode="moves">1</set></event>
  <mode name="n"/><mode name="moves"/>
  <coordinate name="x" velocity="v" unit="m" start="1"/>
  <for index="i" from="1" to="2"><output name="share[i]" unit="N">k*x/4</output></for>
  <output name="pull" unit="N">half*k*at.x</output>
  <constant name="half" value="0.5"/>
  <point name="at" x="place"/>
  <particle mass="m" x="place"/>
  <output name="place" unit="m">x</output>
  <output name="right">x/scale</output>
  <constant name="scale" value="1" unit="m"/>
  <output name="moving">if(v &lt; -1, 1, 0)</output>
  <output name="double" unit="N">twice</output>
  <include file="part.xml" as="part"/>
  <state name="fromPart" rate="part.level - part.inside"/>
  <solver method="{method}"/>
</system>"""
PART = """<system name="Part"><define name="own">level</define><state name="inside" rate="own"/><output name="level">shown</output><output name="shown">2</output></system>"""
METHODS = ["taylor", "radau", "auto"]


@pytest.fixture(scope="module", autouse=True)
def built():
    names = {f"OutputsBy{method.title()}": method for method in METHODS}
    build_systems("outputs-as-names", {name: ABOVE.format(name=name, method=method) for name, method in names.items()}, files={f"{name}/part.xml": PART for name in names})


@pytest.mark.parametrize("method", METHODS)
def test_everything_uses_outputs(method):
    """w = 2 rad/s: x = cos(2 t); z = k/2 (1 + 1) sin(2 t)/2; at x = 0.5 m the mode becomes floor(5) = 4 or 5; fromPart = 2 t - t^2."""
    instance = Instance(f"OutputsBy{method.title()}").initialize()
    for t in np.arange(0.1, 1.05, 0.1):
        instance.step(0.1)
        np.testing.assert_allclose(instance.get("x", "z", "pull", "share[2]", "double", "fromPart"),
                                   [np.cos(2 * t), 4 * np.sin(2 * t), 4 * np.cos(2 * t), 2 * np.cos(2 * t), 8 * np.cos(2 * t), 2 * t - t * t], rtol=0, atol=1e-7)  # fmt: skip
        assert instance.get("n") in ((0.0,) if t < np.pi / 6 else (4.0, 5.0))
        assert instance.get("moves") == (1.0 if 2 * np.sin(2 * t) > 1 else 0.0)
    instance.free()


@pytest.mark.parametrize("lines, message", [
    ('<output name="a">b</output><output name="b">a + 1</output>', "definitions depend on each other in a circle: a -> b -> a"),
    ('<output name="a">a</output>', "definitions depend on each other in a circle: a -> a"),
    ('<state name="z" rate="a"/><output name="a" unit="kg">x</output>', "unit mismatch: the output 'a' has the unit m, expected kg"),
    ('<state name="z" rate="a"/><output name="a">x</output><output name="a">x</output>', "the name 'a' is already defined"),
    ('<define name="a">x</define><output name="a">x</output>', "the name 'a' is already defined"),
    ('<particle mass="1" x="a"/><output name="a">v</output>', "x of <particle> cannot depend on velocities, but 'a' does"),
    ('<state name="z" rate="a"/><output name="a">y</output>', "the output 'a': unknown name 'y'"),
])  # fmt: skip
def test_messages(lines, message, tmp_path):
    system = tmp_path / "system.xml"
    system.write_text(f'<system name="A"><coordinate name="x" velocity="v" unit="m"/><particle mass="1" x="x"/>{lines}</system>')
    found = lagc(system, "-o", tmp_path).stderr
    assert re.search(f"{system}:1: .*{re.escape(message)}", found) and found.count(message) == 1, found
