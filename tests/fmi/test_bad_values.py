"""Invalid values through FMI give a clear error and no NaN, and the instance works again after a reset."""

import math
import re

import pytest
from fmpy.fmi1 import FMICallException

import fmu
from fmu import DISCARD, ERROR


def works_again(instance, name):
    """Check that after a reset the instance simulates like a new one, bit by bit."""
    states = fmu.states_of(name)
    instance.reset().initialize()
    with_history = instance.run(0.1, 0.05, *states)
    fresh = fmu.Instance(name)
    try:
        assert fresh.initialize().run(0.1, 0.05, *states) == with_history
    finally:
        fresh.free()


MASSES = [
    (name, parameter)
    for name, parameters in {
        "ParticleCartesian": ["m"],
        "ParticlePolar": ["m"],
        "ParticleCylindrical": ["m"],
        "ParticleSpherical": ["m"],
        "SimplePendulum": ["m", "l"],
        "DampedPendulum": ["m", "l"],
        "InvertedPendulumCart": ["M", "m", "l"],
        "InvertedPendulumCartTorque": ["m"],
        "SimplePendulumLinear": ["l"],
        "InvertedPendulumCartLinear": ["M", "l"],
        "RotatingPivotPendulum": ["l"],
        "ElasticPendulum": ["m"],
        "DoublePendulum": ["m1", "m2", "l1", "l2"],
        "ChainPendulum": ["m", "l"],
        "Rope": ["M"],
    }.items()
    for parameter in parameters
]


@pytest.mark.parametrize("name, parameter", MASSES)
def test_no_inertia(name, parameter, open_fmu):
    """A mass or a length of zero leaves a coordinate without inertia, which is an error."""
    instance = open_fmu(name)
    instance.fmu.setupExperiment()
    states = fmu.states_of(name)
    values = {parameter: 0.0}
    if (name, parameter) == ("InvertedPendulumCart", "M"):
        values["theta"] = 0.0  # elsewhere M + m sin^2(theta) is not zero
    instance.set(values)
    instance.fmu.enterInitializationMode()
    with instance.fails(ERROR, "mass matrix is singular"):
        instance.fmu.exitInitializationMode()
    assert re.search(rf"it depends on [^:]*\b{parameter}\b", instance.messages[-2][2])
    works_again(instance, name)
    assert all(math.isfinite(value) for value in instance.fmu.getReal(instance.vr(*states)))


@pytest.mark.parametrize("name", ["SimplePendulum", "ParticleCartesian", "SpringDamper", "ElasticPendulum"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_values_that_are_no_numbers(name, value, open_fmu):
    """fmi2SetReal may discard in both kinds (FMI 2.0.4, section 2.1.3): the value is as before, and the importer may try another."""
    instance = open_fmu(name)
    for variable in instance.description.modelVariables:
        if variable.causality in ("parameter", "input"):
            with instance.fails(DISCARD, f"'{variable.name}'.*finite"):
                instance.set({variable.name: value})
            instance.initialize()
            assert instance.get(variable.name) == float(variable.start)
            with instance.fails(DISCARD, f"'{variable.name}'.*finite"):
                instance.set({variable.name: value})
            instance.step(0.01)
            assert instance.get(variable.name) == float(variable.start)
            instance.reset()


def test_values_outside_their_range(open_fmu):
    instance = open_fmu("SimplePendulum")
    with instance.fails(DISCARD, "-1 for 'm' is below its minimum, 0"):
        instance.set(m=-1)
    works_again(instance, "SimplePendulum")


@pytest.mark.parametrize("value, limit", [(0.05, "below its minimum, 0.1"), (0.95, "above its maximum, 0.9")])
def test_value_outside_of_a_range(value, limit, open_fmu):
    instance = open_fmu("Functions").initialize()
    with instance.fails(DISCARD, f"{value} for 'p' is {limit}"):
        instance.set(p=value)


def test_no_value_is_set_where_one_is_wrong(open_fmu):
    instance = open_fmu("SimplePendulum")
    with instance.fails(DISCARD, "'l'"):
        instance.set(m=7, l=-1)
    instance.initialize()  # the call changed nothing, and the instance continues
    assert instance.get("m") == 1


@pytest.mark.parametrize("step", [-0.1, 0.0, math.inf, math.nan])
@pytest.mark.parametrize("name", ["SimplePendulum", "ParticleCartesian", "StateFeedback", "ElasticPendulum"])
def test_bad_steps(name, step, open_fmu):
    instance = open_fmu(name).initialize()
    with instance.fails(ERROR, "finite one larger than 0"):
        instance.step(step)
    works_again(instance, name)


@pytest.mark.parametrize("time", [math.nan, math.inf])
@pytest.mark.parametrize("name", ["SimplePendulum", "StateFeedback"])
def test_a_time_that_is_no_number(name, time, open_fmu):
    """The message names the time, not the step."""
    instance = open_fmu(name).initialize()
    with instance.fails(ERROR, f"currentCommunicationPoint is {time}; expected a finite time"):
        instance.fmu.doStep(time, 0.1)
    works_again(instance, name)


@pytest.mark.parametrize("name", ["SimplePendulum", "StateFeedback"])
def test_a_step_beyond_all_times(name, open_fmu):
    instance = open_fmu(name).initialize(start_time=1e308)
    with instance.fails(ERROR, "ends beyond the largest number"):
        instance.step(1e308)


@pytest.mark.parametrize("name", ["SimplePendulum", "StateFeedback"])
def test_unknown_value_references(name, open_fmu):
    instance = open_fmu(name).initialize()
    for call in (
        lambda: instance.fmu.getReal([9999]),
        lambda: instance.fmu.setReal([9999], [1.0]),
        lambda: instance.fmu.getInteger([2**32 - 1]),
        lambda: instance.fmu.getDirectionalDerivative([9999], [0], [1.0]),
    ):
        with instance.fails(ERROR, "unknown"):
            call()
        instance.reset().initialize()
    works_again(instance, name)


POLES = [
    ("ParticleSpherical", dict(phi=0.0), "theta", "phi"),
    ("ParticleSpherical", dict(r=0.0), "theta", "r"),
    ("ParticlePolar", dict(r=0.0), "theta", "r"),
    ("ParticleCylindrical", dict(rho=0.0), "theta", "rho"),
    ("ElasticPendulum", dict(r=0.0), "theta", "r"),
    ("SphericalPendulum", dict(theta=0.0), "phi", "theta"),
]


@pytest.mark.parametrize("name, values, lost, cause", POLES)
def test_singular_coordinates(name, values, lost, cause, open_fmu):
    """At a pole the azimuth has no inertia: initialization fails there, and no call returns NaN."""
    instance = open_fmu(name)
    states = fmu.states_of(name)

    def start():
        instance.reset()
        instance.fmu.setupExperiment()
        instance.fmu.enterInitializationMode()
        instance.set(values)

    for state in states[len(states) // 2 :]:
        start()
        with instance.fails(ERROR, f"'{lost}'.*{cause}"):  # FMI 2.0.4, section 2.1.3 lists no Discard for this call
            instance.get(f"der({state})")
    start()
    with instance.fails(ERROR, f"'{lost}'.*{cause}"):
        instance.fmu.exitInitializationMode()
    assert all(math.isfinite(value) for value in instance.get(*states))
    works_again(instance, name)


def test_throw_through_the_axis(open_fmu):
    """Straight through the axis the azimuth stays constant, phi changes its sign, and the motion stays uniform."""
    instance = open_fmu("ParticleSpherical").initialize(dict(r=1, phi=0.5, theta=0, omegaPhi=-1, omegaTheta=0, g=0))
    x, z, vx, vz = math.sin(0.5), math.cos(0.5), -math.cos(0.5), math.sin(0.5)
    for t, *position in instance.run(3, 0.1, "particle.x", "particle.y", "particle.z"):
        assert position == pytest.approx([x + vx * t, 0, z + vz * t], abs=1e-8)
    assert instance.get("phi") < 0


def test_fall_into_the_centre(open_fmu):
    instance = open_fmu("ParticlePolar").initialize(dict(r=1, omega=0))
    with instance.fails(DISCARD, "retrying will not help"):
        for _ in range(1000):
            instance.step(0.01)
    # Free fall from r = 1 with mu = 1 takes pi / (2 sqrt(2)).
    assert instance.fmu.getRealStatus(2) == pytest.approx(math.pi / 2**1.5, abs=1e-6)
    assert all(math.isfinite(value) for value in instance.get(*fmu.states_of("ParticlePolar")))
    works_again(instance, "ParticlePolar")
