"""Reaction forces and driving forces against Lagrange multipliers of an independent derivation; and displacements."""

import re

import numpy as np
import pytest
from fmpy.validation import validate_fmu

import fmu
import reactions_in_sympy
from fmu import lagc
from constrained_systems import ARM, BEARING, CHAIN, CRANE, HOIST, ROBOT, SEAT, TABLE, WIRE, at, random_values, rename
from mechanics import time
from typeset import check, shown

LINEAR = """<linearization of="../DisplacedBearing/system.xml" name="LinearBearing"/>
"""
TEXTS = {"DisplacedBearing": BEARING, "DisplacedChain": CHAIN, "DisplacedWire": WIRE,
         "DrivenCrane": CRANE.format(further="<work/>"), "DrivenRobot": ROBOT.format(further=""),
         "DrivenArm": ARM.format(further="<work/>"), "MovedSeat": SEAT.format(further="<work/>"),
         "MovedHoist": HOIST.format(further=""), "MovedTable": TABLE.format(further="<work/>")}  # fmt: skip
DISPLACED = [name for name in TEXTS if name.startswith("Displaced")]


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("reactions", TEXTS | {"LinearBearing": LINEAR})
    fmu.build_systems("reactions-tables", {name + "T": rename(text, name + "T") for name, text in TEXTS.items()}, "--form", "tables")


@pytest.mark.parametrize("form", ["", "T"])
@pytest.mark.parametrize("name", reactions_in_sympy.CASES)
def test_forces_are_multipliers(name, form, open_fmu):
    case = reactions_in_sympy.CASES[name]()
    random = np.random.default_rng(len(name))
    for _ in range(20):
        values = random_values(case, random, fmu.references(name))
        instance = at(name + form, values, case, open_fmu)
        accelerations, forces = case.solve(*[values[symbol] for symbol in case.system.arguments])
        for v, expected in zip(case.system.v, accelerations):
            if f"der({v.name})" in fmu.names_of(name, "local"):
                assert instance.get(f"der({v.name})") == pytest.approx(expected, rel=1e-10, abs=1e-10), v
        for force, expected in forces.items():
            assert instance.get(force) == pytest.approx(expected, rel=1e-10, abs=1e-10), force
        instance.free()


def without_displacements(text):
    """Return the system without displacements, as an author writes it who needs no reaction forces."""
    text = re.sub(r"<displacement .*?/>|<output .*?</output>", "", text)
    for written, plain in [(r"px \+ \(l \+ stretch\)", "l"), (r"py - \(l \+ stretch\)", "-l"), (r"theta \+ turn", "theta"),
                           (r"\(l \+ stretch\[j\]\)", "l"), (r"- d\*sin\(u\)|\+ d\*cos\(u\)|\+ d/3", "")]:  # fmt: skip
        text = re.sub(written, plain, text)
    return text


def operations(text, folder):
    """Return the number of operations of each function that the FMU calls for the motion, by its description."""
    (folder / "system.xml").write_text(text)
    assert lagc("system.xml", "-o", "out", cwd=folder).stderr == ""
    found = re.findall(r"^/\* (.*?); (\d+) operations", (folder / "out" / "system.c").read_text(), re.M)
    return {what: count for what, count in found if "parameters alone" not in what and "computed variable" not in what
            and "output" not in what}  # fmt: skip


@pytest.mark.parametrize("name", DISPLACED)
def test_motion_is_independent_of_displacements(name, tmp_path):
    counts = operations(TEXTS[name], tmp_path)
    assert len(counts) >= 3 and counts == operations(without_displacements(TEXTS[name]), tmp_path)


def test_variables():
    by_name = {variable.name: variable for variable in fmu.description("DisplacedBearing").modelVariables}
    for name, unit in [("stretch.force", "N"), ("turn.force", "N.m")]:
        assert (by_name[name].causality, by_name[name].unit) == ("local", unit)
    assert not {"stretch", "px", "der(stretch)"} & set(by_name)
    assert {v.name: v.unit for v in fmu.description("DisplacedWire").modelVariables}["d.force"] is None
    for name in TEXTS:
        assert validate_fmu(str(fmu.archive(name))) == []


def test_dependencies_of_outputs():
    """The tension depends on the angle, its rate and F; the bearing force depends also on the torque, through the acceleration."""
    (tension,) = [u for u in fmu.description("DisplacedBearing").outputs if u.variable.name == "tension"]
    assert {variable.name for variable in tension.dependencies} == {"theta", "omega", "F"}
    (pull,) = [u for u in fmu.description("DisplacedBearing").outputs if u.variable.name == "pull"]
    assert {variable.name for variable in pull.dependencies} == {"theta", "omega", "F", "tau"}


@pytest.mark.parametrize("name, output", [("DisplacedBearing", "pull"), ("DisplacedChain", "T[2]"),
                                          ("DisplacedWire", "D"), ("DrivenCrane", "drive"), ("DrivenRobot", "torque"),
                                          ("DrivenRobot", "der(omega[3])"), ("DrivenArm", "torque"),
                                          ("DrivenCrane", "der(nonConservativeWork)"),
                                          ("DrivenArm", "der(nonConservativeWork)"), ("MovedSeat", "der(w)"),
                                          ("MovedSeat", "der(nonConservativeWork)"), ("MovedHoist", "der(omega[2])"),
                                          ("MovedHoist", "speed"), ("MovedTable", "across"),
                                          ("MovedTable", "der(nonConservativeWork)")])  # fmt: skip
@pytest.mark.parametrize("form", ["", "T"])
def test_derivatives_of_forces(name, output, form, open_fmu):
    """Directional derivatives of an output by states, inputs and parameters agree with central differences."""
    case = reactions_in_sympy.CASES[name]()
    values = random_values(case, np.random.default_rng(3), fmu.references(name))
    knowns = [s.name for s in case.system.arguments if s.name in fmu.references(name) and s is not time]
    instance = at(name + form, values, case, open_fmu)
    for known in knowns:
        (slope,) = instance.fmu.getDirectionalDerivative(instance.vr(output), instance.vr(known), [1.0])
        value, step, sides = instance.get(known), 1e-5, []
        for side in (value - step, value + step):
            instance.set({known: side})
            sides.append(instance.get(output))
        instance.set({known: value})
        assert slope == pytest.approx((sides[1] - sides[0]) / (2 * step), rel=1e-6, abs=1e-7), known


def test_rate_of_a_force(open_fmu):
    """The time derivative of a tension from the series of the motion agrees with differences."""
    instance = open_fmu("DisplacedChain").initialize(tolerance=1e-12)
    instance.step(0.5)
    rate = instance.fmu.getRealOutputDerivatives(instance.vr("T[1]"), [1])[0]
    before = instance.get("T[1]")
    instance.step(1e-4)
    after = instance.fmu.getRealOutputDerivatives(instance.vr("T[1]"), [1])[0]
    assert instance.get("T[1]") - before == pytest.approx((rate + after) / 2 * 1e-4, rel=1e-6)


def test_linearized_force(tmp_path, open_fmu):
    """At the lowest point the tension is m g to first order, and the force across is proportional to m g theta."""
    instance = open_fmu("LinearBearing").initialize({"theta": 0.1, "m": 3.0, "b": 0.0})
    assert instance.get("stretch.force") == pytest.approx(3 * 9.81, rel=1e-12)
    instance.step(0.2)
    # For J = 0.1: the rod's share in the acceleration is m l^2/(m l^2 + J).
    share = 3 * 0.25 / (3 * 0.25 + 0.1)
    assert instance.get("px.force") == pytest.approx(3 * 9.81 * instance.get("theta") * share, rel=1e-9)


def test_page_shows_the_force(tmp_path):
    (tmp_path / "system.xml").write_text(BEARING)
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    (page,) = shown([tmp_path / "out" / "documentation" / "index.html"], tmp_path)
    assert check(page) == page.count("<code data-latex")
    section = page[page.index("Forces of reaction") :]
    assert ">stretch.force = " in section and section.index("<math") < section.index("stretch.force = ")


# The unit of a force times that of its velocity is a unit of power: N, N.m and V are units of forces.
FORCES = {
    "dx.force": "N", "dp.force": "N.m", "a.force": "N", "b.force": "N.m", "node.force": "kg.m2/(s3.A)", "blade.force": "N", "line.force": "N",
    "rub.force": "N.m", "grip.force": "N", "y.max.force": "N", "wall.force": "N", "phi.max.force": "N.m", "loose.force": "N",
}  # fmt: skip
UNITS = """<system name="Units">
  {output}
  <parameter name="m" start="5" unit="kg"/><parameter name="l" start="1" unit="m"/><parameter name="L" start="2" unit="V.s/A"/>
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="z" velocity="vz" unit="m"/>
  <coordinate name="phi" velocity="om" unit="rad"/><coordinate name="a" velocity="va" unit="m" acceleration="0"/>
  <coordinate name="b" velocity="vb" unit="rad" acceleration="0"/><coordinate name="q" velocity="i" unit="A.s"/><coordinate name="Q" velocity="I" unit="A.s"/>
  <kinetic>L*(i^2 + I^2)/2</kinetic>
  <displacement name="dx" unit="m"/><displacement name="dp" unit="rad"/>
  <body name="skater" mass="m" x="x + dx" y="y" inertia="2*m*l^2" angle="phi + dp"/>
  <particle mass="m" x="a" z="z"/><particle mass="m" x="sin(b)*l" y="cos(b)*l"/><particle name="ring" mass="m" x="4*l + z"/>
  <constraint name="node" unit="A">i - I</constraint>
  <constraint name="blade" unit="m/s">vx*sin(phi) - vy*cos(phi)</constraint>
  <constraint name="line" unit="m">z - l/2</constraint>
  <friction name="rub" coordinate="phi" force="0.2"/><friction name="grip" velocity="vx + vy" force="3"/>
  <stop coordinate="y" max="5"/><stop coordinate="phi" max="50"/><contact name="wall" gap="6*l - x" unit="m"/>
  <spring name="loose" from="base" to="ring" stiffness="3"/>
  {output}
</system>"""


def test_units_of_forces(tmp_path):
    (tmp_path / "system.xml").write_text(UNITS.format(output=""))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    text = (tmp_path / "out" / "modelDescription.xml").read_text()
    units = {name: re.search(rf'name="{re.escape(name)}"[^>]*>\s*<Real [^>]*unit="([^"]*)"', text)[1] for name in FORCES}
    assert units == FORCES


@pytest.mark.parametrize("name", FORCES)
def test_units_of_forces_in_expressions(tmp_path, name):
    """The unit holds before and after the element. A wrong unit is an error after the element."""
    unit = FORCES[name]
    for before, after in ((f'<output name="o" unit="{unit}">{name}</output>', ""), ("", f'<output name="o" unit="{unit}">{name}</output>')):
        (tmp_path / "system.xml").write_text(UNITS.replace("{output}", before, 1).format(output=after))
        result = lagc("system.xml", "-o", "out", cwd=tmp_path)
        assert result.returncode == 0, result.stderr
    (tmp_path / "system.xml").write_text(UNITS.replace("{output}", "", 1).format(output=f'<output name="o" unit="kg.m/s">{name}</output>'))
    assert "unit mismatch: the output 'o'" in lagc("system.xml", "-o", "out", cwd=tmp_path).stderr
