"""Systems of variable mass as fmu/README.md describes them, against closed forms; and the error messages."""

import numpy as np
import pytest

import fmu
from fmu import lagc

HEAD = '<system name="{}"><parameter name="g" start="9.81" unit="m/s2"/>'
# Each starts with m = 2 kg, and at 3 m/s unless it starts to fall from rest.
SYSTEMS = {
    "SandInCart": """<coordinate name="x" velocity="v" unit="m" velocityStart="3"/>
  <parameter name="rate" start="0.5" unit="kg/s"/><parameter name="m0" start="2" unit="kg"/>
  <define name="m" unit="kg">m0 + rate*time</define><kinetic>m*v^2/2</kinetic></system>""",
    "LeakingCart": """<coordinate name="x" velocity="v" unit="m" velocityStart="3"/><parameter name="F" start="4" unit="N"/>
  <parameter name="rate" start="0.5" unit="kg/s"/><parameter name="m0" start="2" unit="kg"/>
  <define name="m" unit="kg">m0 - rate*time</define><kinetic>m*v^2/2</kinetic>
  <force coordinate="x">F + der(m)*v</force></system>""",
    "FoldedChain": """<coordinate name="x" velocity="v" unit="m" start="9.81*0.5^2/4" velocityStart="9.81*0.5/2"/>
  <parameter name="density" start="2" unit="kg/m"/>
  <kinetic>density*x*v^2/2</kinetic><potential>-density*g*x^2/2</potential></system>""",
}


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("changing-masses", {name: HEAD.format(name) + text for name, text in SYSTEMS.items()})


# From the conservation of m v, from m dv/dt = F, and from the energy, v^2 = g x.
MOTIONS = {
    "SandInCart": lambda t: (2 * 3 / 0.5 * np.log((2 + 0.5 * t) / 2), 2 * 3 / (2 + 0.5 * t)),
    "LeakingCart": lambda t: (3 * t + 8 * t + 8 * (4 - t) * np.log(1 - t / 4), 3 - 8 * np.log(1 - t / 4)),
    "FoldedChain": lambda t: (9.81 * (t + 0.5) ** 2 / 4, 9.81 * (t + 0.5) / 2),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_motion(name, open_fmu):
    instance = open_fmu(name).initialize()
    for time in (0.4, 1.0, 1.7):
        instance.step(time - instance.time)
        assert instance.get("x", "v") == pytest.approx(MOTIONS[name](time), abs=1e-7)


@pytest.mark.parametrize("inertia, message", [
    ("2 + time", "the inertia cannot depend on time; expected inertia=\"0\" and <kinetic>J*omega^2/2</kinetic>, which is d(J*omega)/dt = F"),
    ("2 + time*phi", "the inertia cannot depend on coordinates; expected inertia=\"0\" and <kinetic>J*omega^2/2</kinetic>"),
])  # fmt: skip
def test_changing_inertia_is_an_error(inertia, message, tmp_path):
    path = tmp_path / "system.xml"
    body = f'<coordinate name="phi" velocity="w"/><body mass="0" x="0" inertia="{inertia}" angle="phi"/>'
    path.write_text(f'<system name="Changing">{body}</system>')
    result = lagc(path, "-o", tmp_path / "out")
    assert result.returncode == 1 and message in result.stderr, result.stderr
    assert len(result.stderr.splitlines()) == 1, result.stderr
