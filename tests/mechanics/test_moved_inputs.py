"""Inputs with derivatives: their work with every solver, and the variables of their FMUs."""

import numpy as np
import pytest

import fmu
from constrained_systems import HOIST, METHODS, SEAT, TABLE, check_balance, rename


@pytest.fixture(scope="module")
def moved():
    """Build the seat with each solver, the other systems with moved inputs, and the chain with <work>."""
    texts = {f"Seat{m}": rename(SEAT.format(further=f'<work/><solver method="{m}"/>'), f"Seat{m}") for m in METHODS}
    texts["WorkingHoist"] = rename(HOIST.format(further="<work/>"), "WorkingHoist")
    texts["TurnedTable"] = rename(TABLE.format(further="<work/>"), "TurnedTable")
    texts["ExactSeat"] = rename(SEAT.format(further='<solver method="exact"/>').replace("zb^2/h/2", "zb"), "ExactSeat")
    fmu.build_systems("moved", texts)


@pytest.mark.parametrize("method", METHODS)
def test_work_of_the_moved_floor(method, moved, open_fmu):
    instance = open_fmu(f"Seat{method}").initialize({"F": 5.0, "der(zb)": 0.2, "der(der(zb))": -1.0}, 1e-10)
    check_balance(instance, {"zb": np.polynomial.Polynomial([0, 0.2, -0.5, 0.3])}, 1.0, 3, 1.0)


def test_work_of_a_changed_length(moved, open_fmu):
    motions = {"xp": np.polynomial.Polynomial([0, 1.0, -0.4, 0.1]), "L": np.polynomial.Polynomial([0.8, -0.3, 0, 0.1])}
    instance = open_fmu("WorkingHoist").initialize({"der(xp)": 1.0, "der(L)": -0.3}, 1e-11)
    check_balance(instance, motions, 1.0, 4, 1.0)


def test_work_of_the_rotated_table(moved, open_fmu):
    """The work includes a gyroscopic potential and a <kinetic> of the table's rate."""
    motions = {"phi": np.polynomial.Polynomial([0.1, 2.0, 0.5, -0.2])}
    instance = open_fmu("TurnedTable").initialize({"phi": 0.1, "der(phi)": 2.0, "der(der(phi))": 1.0}, 1e-12)
    check_balance(instance, motions, 1.0, 4, 1.0)


def test_exact_method_with_a_moved_floor(moved, open_fmu):
    """A step of any length agrees with the Taylor series, for constant inputs."""
    values = {"zb": 0.1, "der(zb)": 0.3, "der(der(zb))": 2.0}
    results = []
    for name in ("ExactSeat", "Seattaylor"):
        instance = open_fmu(name).initialize(values, 1e-12)
        instance.step(0.7)
        results.append(instance.get("x", "y", "v", "w"))
    np.testing.assert_allclose(*results, rtol=1e-9)


def test_inputs_with_derivatives_are_variables(moved):
    by_name = {v.name: v for v in fmu.description("WorkingHoist").modelVariables}
    for name, unit, start in [("xp", "m", 0.0), ("der(xp)", "m/s", 0.0), ("der(der(xp))", "m/s2", 0.0), ("L", "m", 0.8)]:
        variable = by_name[name]
        assert (variable.causality, variable.unit, float(variable.start)) == ("input", unit, start)
    assert float(by_name["L"].min) == -9 and by_name["der(L)"].min is None
    # der(der(x)) is not a structured name of the standard, which writes der(x,2).
    assert fmu.description("WorkingHoist").variableNamingConvention == "flat"
    assert fmu.description("SimplePendulum").variableNamingConvention == "structured"
