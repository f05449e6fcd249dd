"""modelDescription.xml: FMPy's checks, and rules of FMI 2.0 that no validator covers."""

import functools
import re
import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.validation import validate_fmu
from lxml import etree

import fmu

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
ALL_NAMES = [*fmu.all_names(), *fmu.further_names()]


@functools.cache
def document(name):
    return etree.parse(fmu.unpacked(name) / "modelDescription.xml").getroot()


def variables(name):
    return document(name).findall("ModelVariables/ScalarVariable")


def value_of(variable):
    return variable[0]


def unknowns(name, section):
    """(index, dependencies, dependenciesKind) of each Unknown; None for a missing attribute."""
    result = []
    for unknown in document(name).findall(f"ModelStructure/{section}/Unknown"):
        dependencies, kinds = unknown.get("dependencies"), unknown.get("dependenciesKind")
        result.append(
            (
                int(unknown.get("index")),
                None if dependencies is None else [int(i) for i in dependencies.split()],
                None if kinds is None else kinds.split(),
            )
        )
    return result


@pytest.mark.parametrize("name", ALL_NAMES)
def test_fmpy_finds_no_problem(name):
    assert validate_fmu(str(fmu.archive(name))) == []


@pytest.mark.parametrize("name", ALL_NAMES)
def test_model_structure(name):
    """Outputs, Derivatives and InitialUnknowns list the variables that the standard requires, in its order."""
    listed = variables(name)
    outputs = [i for i, v in enumerate(listed, 1) if v.get("causality") == "output"]
    assert [index for index, _, _ in unknowns(name, "Outputs")] == outputs
    derivatives = [i for i, v in enumerate(listed, 1) if value_of(v).get("derivative")]
    assert [index for index, _, _ in unknowns(name, "Derivatives")] == derivatives
    states = {int(value_of(listed[i - 1]).get("derivative")) for i in derivatives}
    initial = [
        i
        for i, v in enumerate(listed, 1)
        if v.get("initial") in ("calculated", "approx")
        and (i in outputs or i in derivatives or i in states or v.get("causality") == "calculatedParameter")
    ]
    assert [index for index, _, _ in unknowns(name, "InitialUnknowns")] == initial
    for section in ("Outputs", "Derivatives", "InitialUnknowns"):
        for index, dependencies, kinds in unknowns(name, section):
            if dependencies is None:  # depends on all knowns
                assert section == "InitialUnknowns" and fmu.is_constrained(name)
                continue
            assert dependencies == sorted(set(dependencies))
            assert all(1 <= i <= len(listed) for i in dependencies)
            if kinds is not None:
                allowed = {"dependent", "constant"} if section == "InitialUnknowns" else {
                    "dependent", "constant", "fixed", "tunable", "discrete"}
                assert len(kinds) == len(dependencies) and set(kinds) <= allowed


# Without GantryCrane, whose random states would lie beyond its random stops.
@pytest.mark.parametrize("name", [name for name in [*fmu.small_names(), *fmu.further_names()] if name != "GantryCrane"])
def test_dependencies_are_true(name, open_fmu):
    """
    A listed dependency changes the unknown at some random point; one that is not listed never does. Knowns are states and inputs; for
    InitialUnknowns the variables with initial="exact", not the guesses of initial="approx" (FMI 2.0.4, section 2.2.8; FMI 3.0.2, section 2.4.8).
    """
    listed = variables(name)
    reals = [v.get("name") for v in listed]
    states = {int(value_of(v).get("derivative")) for v in listed if value_of(v).get("derivative")}
    inputs = {i for i, v in enumerate(listed, 1) if v.get("causality") == "input"}
    time = {i for i, v in enumerate(listed, 1) if v.get("causality") == "independent"}
    parameters = {i for i, v in enumerate(listed, 1) if v.get("causality") == "parameter"}
    modes = {i for i, v in enumerate(listed, 1) if v.get("variability") == "discrete" and v.get("initial") == "exact"}
    following = {i for i, v in enumerate(listed, 1) if v.get("initial") == "approx"}
    instance = open_fmu(name)
    exchange = open_fmu(name, kind=FMU2Model) if fmu.is_constrained(name) else None
    random = np.random.default_rng(5)

    def values_at(section, point, start_time, indices):
        if exchange is not None and section != "InitialUnknowns":
            exchange.put({reals[i - 1]: value for i, value in point.items()}, start_time)
            return exchange.fmu.getReal(exchange.vr(*[reals[i - 1] for i in indices]))
        instance.reset()
        instance.fmu.setupExperiment(startTime=start_time)
        instance.set({reals[i - 1]: point[i] for i in point if i not in inputs})
        instance.fmu.enterInitializationMode()
        instance.set({reals[i - 1]: point[i] for i in point if i in inputs})
        return instance.fmu.getReal(instance.vr(*[reals[i - 1] for i in indices]))

    for section, candidates in (("Derivatives", states | inputs | time), ("Outputs", states | inputs | time),
                                ("InitialUnknowns", states - following | inputs | parameters | modes | time)):
        rows = [row for row in unknowns(name, section)]
        if not rows:
            continue
        indices = [index for index, _, _ in rows]
        changed = {index: set() for index in indices}
        for amplitude in (0.2, 0.2, 2, 2):
            set_states = states - following if section == "InitialUnknowns" else states
            point = {i: random.uniform(0.3, 0.8) for i in set_states | parameters | (modes if section == "InitialUnknowns" else set())}
            point |= {i: random.uniform(-amplitude, amplitude) for i in inputs}
            base = values_at(section, point, 0.5, indices)
            for candidate in candidates:
                if candidate in time:
                    shifted = values_at(section, point, 0.6, indices)
                else:
                    shifted = values_at(section, {**point, candidate: point[candidate] + 0.05}, 0.5, indices)
                for index, before, after in zip(indices, base, shifted):
                    if before != after:
                        changed[index].add(candidate)
        for index, dependencies, _ in rows:
            if dependencies is None:
                continue
            if fmu.is_constrained(name) or name in ("RobotArm", "PidController", "HalfCar"):  # run-time solutions, symmetry and saturation may cancel a dependency
                assert set(dependencies) >= changed[index], reals[index - 1]
            else:
                assert set(dependencies) == changed[index], reals[index - 1]


def test_calculated_parameters_depend_on_parameters_alone():
    """Constraints move start values of states, which Ja = m w^2/6 and Jt = m (l^2 + w^2)/12 do not contain."""
    names = [v.get("name") for v in variables("Bricard")]
    found = {names[index - 1]: {names[i - 1] for i in dependencies} for index, dependencies, _ in unknowns("Bricard", "InitialUnknowns")}
    assert found["Ja"] == {"m", "w"} and found["Jt"] == {"m", "l", "w"}



@pytest.mark.parametrize("name", ALL_NAMES)
def test_derivatives_have_the_unit_of_their_state_per_second(name):
    units = {u.get("name"): u.find("BaseUnit") for u in document(name).findall("UnitDefinitions/Unit")}

    def exponents(variable):
        unit = value_of(variable).get("unit")
        return None if unit is None else {base: int(units[unit].get(base, 0)) for base in BASE_UNITS}

    for variable in variables(name):
        unit = value_of(variable).get("unit")
        assert unit is None or unit in units
        if value_of(variable).get("derivative"):
            state = variables(name)[int(value_of(variable).get("derivative")) - 1]
            if exponents(state) is not None:
                expected = exponents(state)
                expected["s"] -= 1
                assert exponents(variable) == expected


@pytest.mark.parametrize("name", fmu.all_names())
def test_every_quantity_has_a_unit(name):
    for variable in variables(name):
        if variable[0].tag == "Real":
            assert value_of(variable).get("unit"), variable.get("name")


@pytest.mark.parametrize("name", ALL_NAMES)
def test_rules_that_validators_miss(name):
    """Names, value references, ranges of start values, the experiment, identifiers and log categories are consistent."""
    root = document(name)
    references = [v.get("valueReference") for v in variables(name)]
    assert len(set(references)) == len(references)
    names = [v.get("name") for v in variables(name)]
    assert len(set(names)) == len(names)
    for variable in variables(name):
        real = value_of(variable)
        low, high = float(real.get("min", "-inf")), float(real.get("max", "inf"))
        assert low <= high
        if real.get("start") is not None and real.tag == "Real":
            assert low <= float(real.get("start")) <= high
    experiment = root.find("DefaultExperiment")
    assert float(experiment.get("startTime")) < float(experiment.get("stopTime"))
    assert 0 < float(experiment.get("stepSize")) <= float(experiment.get("stopTime"))
    for section in ("ModelExchange", "CoSimulation"):
        assert re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", root.find(section).get("modelIdentifier"))
        assert root.find(section).get("modelIdentifier") == name
    categories = [category.get("name") for category in root.findall("LogCategories/Category")]
    assert len(set(categories)) == len(categories)
    assert set(categories) == {
        "logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal", "logAll"
    }


# Allowed `initial` by causality and variability, and whether a start value is required (FMI 2.0.4, page 51).
INITIAL = {
    ("parameter", "tunable"): {"exact": True},
    ("calculatedParameter", "tunable"): {"calculated": False},
    ("input", "continuous"): {None: True},
    ("output", "continuous"): {"exact": True, "approx": True, "calculated": False},
    ("local", "continuous"): {"exact": True, "calculated": False},
    ("local", "discrete"): {"calculated": False, "exact": True},
    ("independent", "continuous"): {None: False},
}


@pytest.mark.parametrize("name", ALL_NAMES)
def test_initial_and_start(name):
    for variable in variables(name):
        allowed = INITIAL[variable.get("causality"), variable.get("variability")]
        assert variable.get("initial") in allowed
        assert (value_of(variable).get("start") is not None) == allowed[variable.get("initial")], variable.get("name")


# Fixed names of variables: coordinates, velocities, inputs, parameters, further outputs.
NAMES = {
    "ParticleCartesian": ("x y z", "vx vy vz", "Fx Fy Fz", "m kx ky kz g", ""),
    "ParticlePolar": ("r theta", "vr omega", "Fr Ftheta", "m mu", ""),
    "ParticleCylindrical": ("rho theta z", "vrho omega vz", "Frho Ftheta Fz", "m k g", ""),
    "ParticleSpherical": ("r theta phi", "vr omegaTheta omegaPhi", "Fr Ftheta Fphi", "m g", ""),
    "SimplePendulum": ("theta", "omega", "", "m l g", ""),
    "SimplePendulumLinear": ("theta", "omega", "", "m l g", ""),
    "DampedPendulum": ("theta", "omega", "tau", "m l g b", ""),
    "InvertedPendulumCart": ("x theta", "v omega", "F", "M m l g", "xBob"),
    "InvertedPendulumCartLinear": ("x theta", "v omega", "F", "M m l g", "xBob"),
    "InvertedPendulumCartTorque": ("x theta", "v omega", "F tau", "M m l g", ""),
    "InvertedPendulumCartTorqueLinear": ("x theta", "v omega", "F tau", "M m l g", ""),
    "RotatingPivotPendulum": ("theta", "omega", "", "m l g r w gamma", ""),
    "ElasticPendulum": ("r theta", "vr omega", "", "m l0 k c g", ""),
    "DoublePendulum": ("theta1 theta2", "omega1 omega2", "", "m1 m2 l1 l2 g", ""),
    "ChainPendulum": (" ".join(f"theta[{i}]" for i in range(1, 11)), " ".join(f"omega[{i}]" for i in range(1, 11)),
                      "", "m l g", ""),
    "Rope": (" ".join(f"x[{i}] y[{i}]" for i in range(1, 201)), " ".join(f"vx[{i}] vy[{i}]" for i in range(1, 201)),
             "", "M EA EI tau b kEnd xEnd yEnd g", "tension"),
    "SeatSuspension": ("zs zd", "vs vd", "zb der(zb) der(der(zb))", "ms md ks cs kd cd", "height shake load"),
    "Motor": ("charge theta", "current omega", "voltage load", "R L k J b", ""),
    "MotorPendulum": ("theta motor.charge motor.theta", "omega motor.current motor.omega", "voltage",
                      "m l g n c d motor.R motor.L motor.k motor.J motor.b", "torque"),
    "StateFeedback": ("", "", "x theta v omega", "kx ktheta kv komega xref umax", "F"),
    "SpringDamper": ("", "", "x1 v1 x2 v2", "k c l0", "F1 F2"),
}


@pytest.mark.parametrize("name", NAMES)
def test_names_of_the_design(name):
    coordinates, velocities, inputs, parameters, outputs = (words.split() for words in NAMES[name])
    assert fmu.names_of(name, "input") == inputs
    assert fmu.names_of(name, "parameter") == parameters
    assert fmu.names_of(name, "output") == coordinates + velocities + outputs
    states = coordinates + velocities
    extra = ["nonConservativeWork"] if name in ("DampedPendulum", "Rope", "SeatSuspension") else []
    assert fmu.states_of(name) == states + extra
    every = {v.name for v in fmu.description(name).modelVariables}
    assert {f"der({state})" for state in states} <= every
    if states:
        assert {"kineticEnergy", "potentialEnergy", "totalEnergy", "solverSteps"} <= every
        linear = name.endswith("Linear") or name in ("ParticleCartesian", "Motor")
        assert ("derivativeEvaluations" in every) == (not linear)


def test_the_archive(name):
    """Members are deflated or stored, with forward slashes, and none is a link."""
    with zipfile.ZipFile(fmu.archive(name)) as archive:
        members = {info.filename: info for info in archive.infolist() if not info.is_dir()}
    assert {member for member in members if not member.startswith("sources/")} == {
        "modelDescription.xml", "model.png", f"binaries/linux64/{name}.so", "documentation/index.html", "documentation/licenses/license.txt"
    }
    for info in members.values():
        assert info.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
        assert "\\" not in info.filename and not info.filename.startswith("/")
        assert (info.external_attr >> 16) & 0o170000 in (0, 0o100000)


def test_the_documentation_page(name):
    """The page shows energies, equations, and every variable with its unit; for very many variables it states how many it omits."""
    page = (fmu.unpacked(name) / "documentation" / "index.html").read_text()
    etree.HTML(page)
    hidden = sum(f">{variable.get('name')}<" not in page for variable in variables(name))
    assert hidden == 0 or (name == "Rope" and "further variables, which modelDescription.xml has, are not shown." in page)
    if "kineticEnergy" in [variable.get("name") for variable in variables(name)]:
        for heading in ("Lagrangian", "Equations of motion"):
            assert heading in page
    assert "nan" not in re.sub(r"<[^>]*>", " ", page).lower().split()


@pytest.mark.parametrize("version", [2, 3])
def test_types(version):
    """
    Each declared type has the unit of its variables, each unit has one type, and all types are used. Torque and energy have different
    types.
    """
    types = {}
    for name in fmu.all_names():
        description = fmu.description(name) if version == 2 else fmpy.read_model_description(fmu.ROOT / "build" / "fmi3" / f"{name}.fmu")
        declared = [variable for variable in description.modelVariables if variable.declaredType is not None]
        assert {variable.declaredType.name for variable in declared} == {one.name for one in description.typeDefinitions}
        assert all(variable.declaredType.unit == variable.unit for variable in declared)
        assert not {one.name for one in description.typeDefinitions} & {variable.name for variable in description.modelVariables}
        types |= {one.unit: one.quantity for one in description.typeDefinitions}
        untyped = {variable.unit for variable in description.modelVariables if variable.declaredType is None}
        assert not untyped & {"rad", "m", "kg", "N", "J"}, name
    assert (types["N.m"], types["J"], types["m/s"]) == ("Torque", "Energy", "Velocity") and len(set(types.values())) == len(types)
