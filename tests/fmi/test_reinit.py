"""
The attribute reinit (FMI 2.0.4, section 2.2.7; FMI 3.0.2, section 2.4.7): states that jump have it; the others can be set in event mode.
"""

from ctypes import POINTER, c_double

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model, FMU3Slave
from lxml import etree

import fmi3
import fmu

# x switches the force on v at 1; an event sets y's velocity, and w bounces; nothing changes the state of z discontinuously.
PUSHED = """<system name="Pushed">
  <coordinate name="x" velocity="v"/><coordinate name="y" velocity="u"/><coordinate name="z" velocity="r"/>
  <coordinate name="h" velocity="w" start="1"/>
  <particle mass="1" x="x" y="y" z="z"/><particle mass="1" x="h"/>
  <force coordinate="x">if(x > 1, -3, 2)</force><force coordinate="h">-9.81</force>
  <event when="time > 5"><set velocity="u">1</set></event>
  <contact name="ground" gap="h" restitution="0.5"/>
</system>"""


# An event sets p, a sample sets q; r follows them.
RESET = """<system name="{name}">{coordinate}
  <state name="r" rate="p + q - r"/><state name="p" rate="2 - p"/><state name="q" rate="-q"/>
  <event when="time > 0.3"><set state="p">0</set></event>
  <sample every="0.25"><set state="q">q + 1</set></sample>
</system>"""
RESETS = {"ResetStates": "", "ResetBeside": '<coordinate name="x" velocity="v"/><particle mass="1" x="x"/>'}


@pytest.fixture(scope="module")
def pushed():
    resets = {name: RESET.format(name=name, coordinate=coordinate) for name, coordinate in RESETS.items()}
    fmu.build_systems("reinit", {"Pushed": PUSHED, **resets}, versions=(2, 3))
    return "Pushed"


def reinitialized(module, name):
    root = etree.parse(module.unpacked(name) / "modelDescription.xml").getroot()
    marked = [element for element in root.find("ModelVariables").iter() if element.get("reinit") == "true"]
    return {element.get("name") or element.getparent().get("name") for element in marked}


def jumps_of(name, monkeypatch):
    """States that change in event mode, as seen by FMPy."""
    states, jumped, before = np.array(fmu.states_of(name)), set(), []

    def state_of(model):
        state = np.zeros(len(states))
        model.getContinuousStates(state.ctypes.data_as(POINTER(c_double)), len(states))
        return state

    enter, leave = FMU2Model.enterEventMode, FMU2Model.enterContinuousTimeMode

    def enter_event_mode(model):
        before[:] = [state_of(model)]
        return enter(model)

    def leave_event_mode(model):
        for old in before:
            jumped.update(states[state_of(model) != old])
        return leave(model)

    monkeypatch.setattr(FMU2Model, "enterEventMode", enter_event_mode)
    monkeypatch.setattr(FMU2Model, "enterContinuousTimeMode", leave_event_mode)
    stop = min(2.0, float(fmu.description(name).defaultExperiment.stopTime))
    fmpy.simulate_fmu(str(fmu.unpacked(name)), fmi_type="ModelExchange", stop_time=stop, relative_tolerance=1e-6)
    return jumped


PIECES = ["BristleFriction", "DigitalServo", "HalfCar", "PidController", "SpinningBeam"]  # their switches change no state


@pytest.mark.parametrize("name", [name for name in fmu.moving_names() if name != "Rope"])
def test_states_that_jump_have_reinit(name, monkeypatch):
    marked = reinitialized(fmu, name)
    assert jumps_of(name, monkeypatch) <= marked <= set(fmu.states_of(name))
    assert reinitialized(fmi3, name) == marked
    switches = fmu.description(name).numberOfEventIndicators > 0 and name not in PIECES
    assert (len(marked) > 0) == (fmu.is_constrained(name) or switches)


def test_states_that_never_jump_have_none(pushed):
    assert reinitialized(fmu, pushed) == reinitialized(fmi3, pushed) == {"u", "h", "w"}


@pytest.mark.parametrize("name", RESETS)
def test_states_that_events_and_samples_set(name, pushed):
    assert reinitialized(fmu, name) == reinitialized(fmi3, name) == {"p", "q"}


def test_a_state_that_is_set_in_event_mode(pushed, opened):
    """Modes follow from the value set; nothing depends on the value before."""
    instance = opened(pushed, kind=FMU3Model).initialize()
    assert instance.get("der(v)")[0] == 2
    instance.set(x=2.0, r=0.5)
    instance.fmu.updateDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    state = (c_double * 8)()
    instance.fmu.getContinuousStates(state, 8)
    assert list(state) == [2, 0, 0, 1, 0, 0, 0.5, 0]
    assert list(instance.get("der(v)", "x", "r", "der(z)")) == [-3, 2, 0.5, 0.5]


@pytest.mark.parametrize("kind, state", [(FMU3Model, "u"), (FMU3Model, "h"), (FMU3Slave, "x")])
def test_states_that_cannot_be_set_in_event_mode(kind, state, pushed, opened):
    """States that the FMU itself sets cannot be set, nor any state in co-simulation."""
    instance = opened(pushed, kind=kind, **({"eventModeUsed": True} if kind is FMU3Slave else {})).initialize()
    with pytest.raises(FMICallException):
        instance.set({state: 0.5})
    assert f"'{state}' cannot be set in the state" in instance.messages[-1][2]
