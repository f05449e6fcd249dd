"""Systems whose events have no consistent result give an error that names the cause, in co-simulation and model exchange."""

import re

import fmpy
import pytest
from fmpy.fmi1 import FMICallException

import fmu
from fmu import build_systems, lagc

BODY = """
<system name="{name}">
  <parameter name="f" start="-0.3"/>
  <coordinate name="x" velocity="v" start="1"/>
  <coordinate name="y" velocity="w" start="0.5"/>
  <particle mass="1" x="x" y="y"/>
  {elements}
</system>
"""
WEIGHT = "<potential>9.81*{}</potential>"
REJECTED = {
    "PushingFriction": ('<friction name="F" coordinate="x" force="f"/>', "the force of the friction 'F' is -0.3"),
    "WeakStiction": ('<friction name="F" coordinate="x" force="1" stiction="0.5"/><force coordinate="x">0.7</force>',
                     "the friction 'F' neither sticks nor slides; expected a stiction of at least the force while it slides, less friction"),
    "WrongSide": ('<constraint name="C">y - 0.5</constraint><friction name="F" coordinate="x" force="0.3*C.force"/><force coordinate="x">4</force>'
                  + WEIGHT.format("y"), "the force of the friction 'F' is -2.943"),
    # exp(2000) overflows at the start, so that exp(2000)*exp(-exp(2000)) has no value in doubles.
    "Overflowing": ('<contact name="g" gap="y - 0.5 - 0.39*exp(-(time - 0.2)/1e-4)*exp(-exp(-(time - 0.2)/1e-4))"/>' + WEIGHT.format("y"),
                    r"the gap of the contact 'g' has no finite value, as where exp\(x\) overflows above x = 709; expected a gap that is finite"),
    "TornApart": ('<constraint name="C">y - 0.5*x</constraint><event when="time &gt; 1"><set coordinate="x">2</set></event>',
                  "an event sets coordinates that violate the constraint 'C'"),
    "Sunk": ('<contact name="g" gap="x"/><event when="time &gt; 1"><set coordinate="x">-1</set></event>', "the contact 'g' is penetrated at an event"),
    "Climbing": ('<potential>if(x &lt; 0.5, 1, 0)</potential><force coordinate="x">-1</force>',
                 r"a condition, line \d+ of system.xml, makes an energy or a position jump"),
    "GatheringMass": ('<kinetic>if(x &lt; 0.5, 2, 1)*v^2/2</kinetic><force coordinate="x">-1</force>', "makes an energy or a position jump"),
    "JumpingPlace": ('<particle name="P" mass="1" x="x" y="y + if(x &lt; 0.5, 0.5, 0)"/>' + WEIGHT.format("P.y") + '<force coordinate="x">-1</force>',
                     "makes an energy or a position jump"),
    # The momentum along y is conserved, but the coordinates contradict that.
    "Corner": ('<particle mass="1" x="x" y="abs(x - 0.5) + y"/><force coordinate="x">-1</force>', "abs, line .* makes an energy or a position jump"),
    "Grabbed": ('<mode name="on"/><constraint name="C">if(on, v - w, 0)</constraint><force coordinate="x">-1</force>'
                '<event when="time &gt; 0.4"><set mode="on">1</set></event>', "an event sets modes that violate the constraint 'C'"),
    "ToAndFro": ('<force coordinate="x">-sign(x + v*abs(v)/2)</force><solver maxSteps="5000"/>',
                 r"the step has \d+ events, the last of (abs|sign), line \d+"),
    "DryBySign": ('<force coordinate="x">1 - 3*sign(v - 0.2)</force>', r"sign, line \d+ of system.xml, chatters: on both sides of its jump"),
}  # fmt: skip
FINE = {
    # A force equal to the stiction moves nothing.
    "AtTheLimit": ('<friction name="F" coordinate="x" force="1" stiction="2"/><force coordinate="x">2</force>', (1, 0.5)),
    "MovedTogether": ('<constraint name="C">y - 0.5*x</constraint><event when="time &gt; 1"><set coordinate="x">2</set>'
                      '<set coordinate="y">1</set></event>', (2, 1)),
    # The author states the law of the impact: afterwards the bodies move together, at half the velocity of 0.4 along x.
    "GrabbedByLaw": ('<mode name="on"/><constraint name="C">if(on, v - w, 0)</constraint><force coordinate="x">-1</force>'
                     '<event when="time &gt; 0.4"><set mode="on">1</set><set velocity="v">(v + w)/2</set><set velocity="w">(v + w)/2</set></event>',
                     (0.92 - 0.2 * 2.6 - 0.25 * 2.6**2, 0.5 - 0.2 * 2.6 - 0.25 * 2.6**2)),
    "ClimbingByLaw": ('<potential>if(x &lt; 0.5, -1, 0)</potential><force coordinate="x">-1</force>'
                      '<event when="x - 0.5"><set velocity="v">-sqrt(v^2 + 2)</set></event>', (0.5 - 3**0.5 * 2 - 2, 0.5)),
    # The corner of a wedge changes only the momentum of the body on it. Functions of time may jump.
    "Bead": ('<particle mass="1" x="x - 0.5" y="abs(x - 0.5)"/><force coordinate="x">-1</force>', (1 - 9 / 6, 0.5)),
    "Timed": ('<potential>if(time &gt; 1, 5, 0)*x</potential>', (1 - 5 * 2**2 / 2, 0.5)),
    "Mirror": ('<particle mass="1" x="abs(x - 3)"/><force coordinate="x">-4</force>', (1 - 4 * 9 / 4, 0.5)),
    # A ball at rest at 0 from 0.45 s on is set to 1 at 2 s, falls, and rests again from 2.45 s on.
    "PutUp": ('<contact name="g" gap="x"/><event when="time &gt; 2"><set coordinate="x">1</set></event>' + WEIGHT.format("x"), (0, 0.5)),
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: BODY.format(name=name, elements=elements) for name, (elements, _) in (REJECTED | FINE).items()}
    build_systems("rejected", texts)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", REJECTED)
def test_errors(name, kind):
    if (name, kind) == ("ToAndFro", "ModelExchange"):
        pytest.skip("an importer has its own number of steps")
    messages = []
    logger = lambda *words: messages.append(words[-1].decode() if isinstance(words[-1], bytes) else words[-1])
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(str(fmu.archive(name)), stop_time=3, output_interval=0.5, fmi_type=kind, logger=logger)
    assert any(re.search(REJECTED[name][1], message) for message in messages), messages


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", FINE)
def test_values_that_an_event_sets(name, kind):
    result = fmpy.simulate_fmu(str(fmu.archive(name)), stop_time=3, output_interval=0.1, fmi_type=kind, output=["x", "y"])
    assert (result["x"][-1], result["y"][-1]) == pytest.approx(FINE[name][1], abs=1e-9 if kind == "CoSimulation" else 1e-6)
    if name == "PutUp":
        flight = result[(result["time"] > 2.05) & (result["time"] < 2.4)]
        assert flight["x"] == pytest.approx(1 - 9.81 * (flight["time"] - 2) ** 2 / 2, abs=1e-5)


@pytest.mark.parametrize("word", ["and", "or", "not"])
def test_words_of_conditions_are_no_names(tmp_path, word):
    (tmp_path / "system.xml").write_text(BODY.format(name="A", elements=f'<define name="{word}">x</define>'))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and f"the name '{word}' belongs to the language itself" in result.stderr
