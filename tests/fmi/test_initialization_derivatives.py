"""Derivatives in initialization mode include the projection of the start onto the constraints: against differences of Set and Get."""

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

import fmi3
import fmu

STEP = 1e-4


@pytest.fixture(params=[(fmu, FMU2Slave), (fmu, FMU2Model), (fmi3, FMU3Slave), (fmi3, FMU3Model)], ids=["CS2", "ME2", "CS3", "ME3"])
def open_in_initialization(request):
    opened = []

    def opener(name):
        module, kind = request.param
        instance = module.Instance(name, kind=kind)
        opened.append(instance)
        if module is fmu:
            instance.fmu.setupExperiment()
        instance.fmu.enterInitializationMode()
        return instance

    yield opener
    for instance in opened:
        instance.free()


def directional(instance, unknowns, known):
    if isinstance(instance, fmi3.Instance):
        return instance.partial("Directional", unknowns, [known], [1.0])
    return np.array(instance.fmu.getDirectionalDerivative(instance.vr(*unknowns), instance.vr(known), [1.0]))


def values(instance, names):
    return np.array([np.ravel(instance.get(name))[0] for name in names])


def difference(instance, unknowns, known):
    """Central difference of fourth order, by Set and Get in initialization mode."""
    start, result = values(instance, [known])[0], 0.0
    original = instance.start_of[known]
    for at, weight in ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12)):
        instance.set({known: original + at * STEP})
        result = result + weight * values(instance, unknowns) / STEP
    instance.set({known: original})
    assert values(instance, [known])[0] == pytest.approx(start, abs=1e-12)
    return result


@pytest.mark.parametrize(
    "name, knowns",
    [("PendulumCartesian", {"x": -0.9, "y": 0.2, "vx": 0.3, "vy": 0.1, "l": 1.0}), ("FourBar", {"theta": 1.2, "phi": 0.6, "omega": 0.4})],
)
def test_derivatives_of_the_start(name, knowns, open_in_initialization):
    """A projected start depends on every state and parameter: d x / d x is not 1, and d y / d x is not 0."""
    instance = open_in_initialization(name)
    knowns = {known: value for known, value in knowns.items() if known in {v.name for v in instance.description.modelVariables}}
    instance.start_of = knowns
    instance.set(knowns)
    derivatives = [unknown.variable for unknown in instance.description.derivatives]
    unknowns = [v.derivative.name for v in derivatives] + [v.name for v in derivatives]
    for known in knowns:
        ours = directional(instance, unknowns, known)
        np.testing.assert_allclose(ours, difference(instance, unknowns, known), rtol=1e-7, atol=1e-7)


def test_a_radial_displacement_of_the_start(open_in_initialization):
    """The start is the nearest point of the circle: at (-a, b) the derivatives by a are -b^2/r^3 for x and -a b/r^3 for y, for l = 1."""
    instance = open_in_initialization("PendulumCartesian")
    x, y = -0.9, 0.2
    instance.set({"x": x, "y": y, "vx": 0.0, "vy": 0.0})
    r = np.hypot(x, y)
    np.testing.assert_allclose(directional(instance, ["x", "y"], "x"), [y * y / r**3, -x * y / r**3], atol=1e-9)
    if isinstance(instance, fmi3.Instance):
        np.testing.assert_allclose(instance.partial("Adjoint", ["x", "y"], ["x", "y"], [2.0, 3.0]),
                                   np.array([[y * y, -x * y], [-x * y, x * x]]) @ [2.0, 3.0] / r**3, atol=1e-9)  # fmt: skip
