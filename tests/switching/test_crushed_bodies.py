"""
A body caught between prescribed motions is an error that names it when it is caught. This holds in co-simulation, and in model exchange of FMI 2.0
and 3.0, where an importer would pass through a wall.
"""

import re

import fmpy
import pytest
from fmpy.fmi1 import FMICallException

import fmi3
import fmu
from fmu import build_systems

PUSHED = """<system name="{name}"><coordinate name="y" velocity="u" unit="m" start="{place}" velocityStart="{speed}" acceleration="{acceleration}"/>
  <coordinate name="x" velocity="v" unit="m" start="{place} + 0.1"/><particle mass="2" x="x"/>{further}
  <contact name="push" gap="x - y - 0.1" unit="m" restitution="{e}"/><stop coordinate="x" max="1" restitution="{e}"/></system>"""
LATER = "if(time &lt; 1, 0, 0.1)"
BOTH = r"the contacts '(push|x\.max)' and '(push|x\.max)' crush a body between them: prescribed motions, or far larger masses, close one of them"
ALONE = r"the contact 'x\.max' closes by prescribed motions alone; expected"


def pushed(place, speed, acceleration, e=0, further=""):
    return PUSHED.format(name="{name}", place=place, speed=speed, acceleration=acceleration, e=e, further=further)


# The system, the time at which the body, 0.1 m ahead of its drive, reaches the stop, and the log.
CRUSHED = {
    "Steady": (pushed(0, 1, 0), 0.9, BOTH),
    "Accelerated": (pushed(0, 1, "0.1"), (1.18**0.5 - 1) / 0.1, BOTH),  # y = t + 0.05 t^2
    "Rattling": (pushed(0, 1, "0.1", e=0.5), (1.18**0.5 - 1) / 0.1, BOTH),
    "FromRest": (pushed(0.9, 0, LATER), 1.0, BOTH),
    "AgainstAForce": (pushed(0.9, 0, LATER, further='<force coordinate="x">-3</force>'), 1.0, BOTH),
    "ByTime": ("""<system name="{name}"><coordinate name="x" velocity="v" unit="m" start="0.5"/><particle mass="1" x="x"/>
      <contact name="push" gap="x - 0.5*time" unit="m"/><stop coordinate="x" max="1"/></system>""", 2.0, BOTH),
    "ByAConstraint": ("""<system name="{name}"><coordinate name="y" velocity="u" unit="m"/><coordinate name="x" velocity="v" unit="m" start="0.5"/>
      <particle mass="1" x="x"/><particle mass="1" x="y"/><constraint name="rod" unit="m">y - 0.5*time</constraint>
      <contact name="push" gap="x - y - 0.1" unit="m"/><stop coordinate="x" max="1"/></system>""", 1.8, BOTH),
    # Two bodies; the message may name any pair.
    "InARow": ("""<system name="{name}"><coordinate name="y" velocity="u" unit="m" velocityStart="1" acceleration="0"/><coordinate name="x" velocity="v" unit="m" start="0.5"/>
      <coordinate name="z" velocity="w" unit="m" start="0.7"/><particle mass="1" x="x"/><particle mass="100" x="z"/>
      <contact name="push" gap="x - y - 0.1" unit="m"/><contact name="next" gap="z - x - 0.1" unit="m"/><stop coordinate="z" max="1"/></system>""", 0.8, r"the contacts '\S+' and '\S+' crush a body between them:"),
    "Alone": ("""<system name="{name}"><coordinate name="x" velocity="v" unit="m" velocityStart="1" acceleration="0"/><coordinate name="z" velocity="w" unit="m"/>
      <particle mass="1" x="x" y="z"/><stop coordinate="x" max="1"/></system>""", 1.0, ALONE),
    "AloneFromRest": ("""<system name="{name}"><coordinate name="x" velocity="v" unit="m" start="1" acceleration="if(time &lt; 1, 0, 0.1)"/>
      <coordinate name="z" velocity="w" unit="m"/><particle mass="1" x="x" y="z"/><stop coordinate="x" max="1"/></system>""", 1.0, ALONE),
}  # fmt: skip
# The drive stops in time, at 0.9 m, so that nothing is crushed.
FINE = pushed("0.5", 0, "if(time &lt; 1, 0.8, if(time &lt; 2, -0.8, 0))").replace('max="1"', 'max="1.4000001"')


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: text for name, (text, _, _) in CRUSHED.items()} | {"InTime": FINE}
    build_systems("crushed", {name: text.format(name=name) for name, text in texts.items()}, versions=[2, 3])


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", CRUSHED)
def test_crushed_bodies_are_errors(name, kind, version):
    _, time, message = CRUSHED[name]
    messages, reached = [], []
    logger = lambda *words: messages.append(words[-1].decode() if isinstance(words[-1], bytes) else words[-1])
    archive = (fmu if version == 2 else fmi3).archive(name)
    note = lambda now, recorder: reached.append(now) or True
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(str(archive), stop_time=3, output_interval=0.05, fmi_type=kind, relative_tolerance=1e-8, logger=logger, debug_logging=True, step_finished=note)
    [at] = [float(re.match("time ([^:]+):", text)[1]) for text in messages if re.search(message, text)]
    assert at == pytest.approx(time, abs=1e-4) and max(reached) <= time + 1e-4


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_drive_that_leaves_room_crushes_nothing(kind):
    """From 0.5 m at 0.8 m/s2 for 1 s, then back to rest: the body is at 0.6 + 0.8 m."""
    result = fmpy.simulate_fmu(str(fmu.archive("InTime")), stop_time=3, output_interval=0.1, fmi_type=kind, relative_tolerance=1e-8, output=["x", "y"])
    assert result["y"][-1] == pytest.approx(1.3, abs=1e-7 if kind == "CoSimulation" else 1e-5) and result["x"][-1] >= 1.4 - 1e-7
