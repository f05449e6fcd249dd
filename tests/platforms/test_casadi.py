"""CasADi, a tool for optimal control, imports FMUs as functions: their values and Jacobians."""

import casadi
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model

import fmi3
import fmu

NAMES = ["DoublePendulum", "InvertedPendulumCart", "DampedPendulum", "ParticleSpherical", "MotorPendulum", "RobotArm", "FourBar"]
UNPACKED = {2: fmu.unpacked, 3: fmi3.unpacked}


def function_of(name, fmi):
    """dx/dt and outputs as functions of states and inputs, and slightly changed start values."""
    builder = casadi.DaeBuilder(name, str(UNPACKED[fmi](name)), {})
    function = builder.create("f", ["x", "u"], ["ode", "y"])
    starts = fmu.start_values(name)
    generator = np.random.default_rng(1)
    point = []
    for names in (builder.x(), builder.u()):
        values = np.array([float(starts[scalar]) for scalar in names])
        point.append(values + 0.05 * (1 + abs(values)) * generator.uniform(0, 1, len(values)))
    return builder, function, point


@pytest.mark.parametrize("name", fmu.moving_names())
def test_reads_fmi3(name):
    """CasADi finds all states and outputs, as scalars."""
    builder = casadi.DaeBuilder(name, str(fmi3.unpacked(name)), {})
    assert (builder.nx(), builder.ny()) == (len(fmu.states_of(name)), len(fmu.names_of(name, "output")))


@pytest.mark.parametrize("name, fmi", [(name, fmi) for fmi in (2, 3) for name in NAMES])
def test_jacobian(name, fmi, capfd):
    """The Jacobian agrees with differences of CasADi's function, and the FMU logs no error."""
    builder, function, point = function_of(name, fmi)
    inputs, outputs = ("x", "u"), ("ode", "y")
    wanted = [f"jac:{output}:{known}" for output in outputs for known in inputs if known == "x" or function.size1_in(1) > 0]
    jacobians = function.factory("J", list(inputs), wanted)(*point)
    step = 1e-5
    for words, jacobian in zip(wanted, jacobians):
        _, output, known = words.split(":")
        place = inputs.index(known)
        for column in range(len(point[place])):
            moved = []
            for sign in (1, -1):
                changed = [values.copy() for values in point]
                changed[place][column] += sign * step
                moved.append(np.array(function(*changed)[outputs.index(output)]).ravel())
            by_differences = (moved[0] - moved[1]) / (2 * step)
            scale = 1 + abs(by_differences)
            assert (abs(np.array(casadi.DM(jacobian))[:, column] - by_differences) / scale).max() < 1e-6, (words, column)
    messages = capfd.readouterr()
    assert "logStatus" not in messages.out + messages.err


@pytest.mark.parametrize("name", NAMES)
def test_it_is_the_jacobian_that_others_get(name, open_fmu):
    """The Jacobian equals the directional derivatives for each state, with all states set at once."""
    builder, function, point = function_of(name, 2)
    jacobian = np.array(casadi.DM(function.factory("J", ["x", "u"], ["jac:ode:x"])(*point)))
    values = {scalar: value for names, numbers in zip((builder.x(), builder.u()), point) for scalar, value in zip(names, numbers)}
    instance = open_fmu(name, kind=FMU2Model).put(values)
    unknowns = [unknown.variable.valueReference for unknown in instance.description.derivatives]
    columns = [instance.fmu.getDirectionalDerivative(unknowns, instance.vr(state), [1.0]) for state in builder.x()]
    np.testing.assert_allclose(jacobian, np.transpose(columns), rtol=1e-12, atol=1e-12)


def test_states_one_by_one(open_fmu):
    """In continuous-time mode, setting states one by one as variables equals setting all at once."""
    one, other = open_fmu("DoublePendulum", kind=FMU2Model), open_fmu("DoublePendulum", kind=FMU2Model)
    values = dict(theta1=0.3, theta2=-0.7, omega1=1.5, omega2=-2.5)
    one.put(values)
    other.put({}).set(values)
    accelerations = ("der(omega1)", "der(omega2)")
    assert one.get(*accelerations) == other.get(*accelerations) and other.get("theta2") == -0.7
