"""
Variables with initial="exact" have their start values in initialization mode, and are its knowns, beside inputs and time (FMI 2.0.4, sections
2.2.7, 2.2.8 and 4.2.4; FMI 3.0.2, sections 2.3.3, 2.4.7 and 2.4.8). Samples at the start time happen in the first event iteration.
"""

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model
from lxml import etree

import fmi3
import fmu

SAMPLED = ["DigitalServo", "HalfCar"]


def in_initialization_mode(module, name, **options):
    instance = module.Instance(name, **options)
    if module is fmu:
        instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    return instance


@pytest.mark.parametrize("module", [fmu, fmi3], ids=["2", "3"])
@pytest.mark.parametrize("name", fmu.all_names())
def test_exact_start_values(name, module):
    instance = in_initialization_mode(module, name)
    exact = [v for v in instance.description.modelVariables if v.initial == "exact" and v.type in ("Real", "Float64")]
    for variable in exact:
        assert np.ravel(instance.get(variable.name)) == pytest.approx([float(word) for word in variable.start.split()], rel=0, abs=0), variable.name
    instance.free()


@pytest.mark.parametrize("name", fmu.all_names())
def test_knowns_of_initialization_mode(name):
    """Guesses, with initial="approx", are not among the dependencies of initial unknowns."""
    root = etree.parse(fmu.unpacked(name) / "modelDescription.xml").getroot()
    causes = [(v.get("causality"), v.get("initial")) for v in root.find("ModelVariables")]
    for unknown in root.iterfind("ModelStructure/InitialUnknowns/Unknown"):
        for index in unknown.get("dependencies", "").split():
            causality, initial = causes[int(index) - 1]
            assert causality in ("input", "independent") or initial == "exact"
    root = etree.parse(fmi3.unpacked(name) / "modelDescription.xml").getroot()
    causes = {v.get("valueReference"): (v.get("causality"), v.get("initial")) for v in root.find("ModelVariables")}
    for unknown in root.iterfind("ModelStructure/InitialUnknown"):
        for reference in unknown.get("dependencies", "").split():
            causality, initial = causes[reference]
            assert causality in ("input", "independent") or initial == "exact"


MODES = {"DigitalServo": (["u", "next", "count"], ["der(i)", "voltage"]), "HalfCar": (["noiseFront", "noiseRear", "count"], ["der(roadFront)", "der(roadRear)"])}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", SAMPLED)
def test_derivatives_by_start_values_of_modes(name, version):
    """Against differences of Set and Get; each variable with a derivative is a dependency."""
    module = fmu if version == 2 else fmi3
    instance = in_initialization_mode(module, name)
    modes, unknowns = MODES[name]
    root = etree.parse(module.unpacked(name) / "modelDescription.xml").getroot()
    variables = list(root.find("ModelVariables"))
    key = {v.get("name"): v.get("valueReference") if version == 3 else str(i) for i, v in enumerate(variables, 1)}
    path, attribute = ("InitialUnknown", "valueReference") if version == 3 else ("InitialUnknowns/Unknown", "index")
    listed = {u.get(attribute): u.get("dependencies").split() for u in root.iterfind(f"ModelStructure/{path}")}
    for mode in modes:
        for unknown in unknowns:
            ends = []
            for value in (0.25, 1.25):
                instance.set({mode: value})
                ends.append(np.ravel(instance.get(unknown))[0])
            if version == 2:
                (derivative,) = instance.fmu.getDirectionalDerivative(instance.vr(unknown), instance.vr(mode), [1.0])
            else:
                (derivative,) = instance.partial("Directional", [unknown], [mode], [1.0])
                assert instance.partial("Adjoint", [unknown], [mode], [1.0]) == pytest.approx([derivative])
            assert derivative == pytest.approx(ends[1] - ends[0], rel=1e-9, abs=1e-9)
            assert derivative == 0 or key[mode] in listed[key[unknown]]
    instance.free()


@pytest.mark.parametrize("module, options", [(fmu, {"kind": FMU2Model}), (fmi3, {"kind": FMU3Model}), (fmi3, {"eventModeUsed": True})])
def test_the_first_sample_is_in_the_first_event_iteration(module, options):
    """The controller computes kp ref = 6 V from the start on, and the encoder has not counted yet."""
    servo = in_initialization_mode(module, "DigitalServo", **options)
    values = lambda: list(np.ravel(servo.get("u", "next", "count")))
    servo.set({"next": 2.0})
    assert values() == [0, 2, 0]
    servo.fmu.exitInitializationMode()
    assert values() == [0, 2, 0]
    update = servo.fmu.newDiscreteStates if module is fmu else servo.fmu.updateDiscreteStates
    *_, defined, time = update()
    assert defined and time == pytest.approx(1e-3) and values() == [2, 6, 0]
    servo.free()


@pytest.mark.parametrize("module", [fmu, fmi3], ids=["2", "3"])
def test_the_first_sample_without_event_mode(module):
    """Co-simulation without event mode samples as initialization ends."""
    servo = in_initialization_mode(module, "DigitalServo")
    servo.set({"next": 2.0})
    assert list(np.ravel(servo.get("u", "next"))) == [0, 2]
    servo.fmu.exitInitializationMode()
    assert list(np.ravel(servo.get("u", "next"))) == [2, 6]
    servo.free()
