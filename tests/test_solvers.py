"""Where the methods with error estimates, erk and bdf, are in danger of going astray."""

import math
import subprocess

import mpmath
import pytest

import fmu
from fmu import BUILD, DISCARD, ROOT

METHODS = ("erk", "bdf")

# A unit mass at x with velocity v: its force, and where it starts.
FORCES = {
    "Pulse": ("exp(-((time - 5)/0.01)^2)", 0, 0, 'maxStep="0.01"'),
}


def text(name, force, x, v, solver):
    return f"""<system name="{name}">
  <parameter name="a" start="1"/>
  <coordinate name="x" velocity="v" start="{x}" velocityStart="{v}"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">{force}</force>
  <solver {solver}/>
  <experiment stopTime="0.1"/>
</system>
"""


@pytest.fixture(scope="module", autouse=True)
def systems():
    """Every force with both methods: PulseErk, PulseBdf, ..."""
    folder = BUILD / "solver-systems" / "systems"
    for name, (force, x, v, solver) in FORCES.items():
        for method in METHODS:
            system = folder / f"{name}{method.capitalize()}" / "system.xml"
            content = text(system.parent.name, force, x, v, f'method="{method}" {solver}')
            system.parent.mkdir(parents=True, exist_ok=True)
            if not system.exists() or system.read_text() != content:
                system.write_text(content)
    subprocess.run([ROOT / "scripts" / "build", BUILD / "solver-systems", f"-DSYSTEMS={folder}"], check=True)


@pytest.mark.parametrize("method", ["Erk", "Bdf"])
def test_the_longest_step_finds_a_pulse(method, open_fmu):
    """A pulse of 0.01 s in one communication step of 10 s; its integral is 0.01 sqrt(pi)."""
    instance = open_fmu(f"Pulse{method}").initialize(tolerance=1e-8)
    instance.step(10.0)
    assert instance.get("v") == pytest.approx(0.01 * math.sqrt(math.pi), rel=1e-6)
