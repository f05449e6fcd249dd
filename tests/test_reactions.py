"""Forces of reaction along virtual displacements, against Lagrange multipliers of an independent derivation."""

import re

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from scipy.integrate import solve_ivp

import fmu
import reactions_in_sympy
import test_documentation
from fmu import lagc
from mechanics import time

BEARING = """<system name="DisplacedBearing" description="Rod on a hinge, with all that its bearing holds">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="b" start="0.3" unit="N.s/m"/>
  <parameter name="J" start="0.1" unit="kg.m2" min="0"/>
  <input name="F" unit="N"/>
  <input name="tau" unit="N.m"/>
  <coordinate name="theta" velocity="omega" unit="rad" start="1"/>
  <displacement name="stretch" unit="m" description="of the rod"/>
  <displacement name="px" unit="m"/>
  <displacement name="py" unit="m"/>
  <displacement name="turn" unit="rad" description="of the rod against its hinge"/>
  <define name="phi" unit="rad">theta + turn</define>
  <body name="bob" mass="m" x="px + (l + stretch)*sin(phi)" y="py - (l + stretch)*cos(phi)" inertia="J" angle="phi"/>
  <potential>m*g*bob.y</potential>
  <dissipation>b*(der(bob.x)^2 + der(bob.y)^2)/2</dissipation>
  <force on="bob" x="F" y="-2*F"/>
  <force coordinate="theta">tau</force>
  <output name="tension" unit="N">stretch.force</output>
  <output name="pull" unit="N">sqrt(px.force^2 + py.force^2)</output>
</system>
"""
CHAIN = """<system name="DisplacedChain" description="Rods on a pivot that moves with time">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="F" unit="N"/>
  <constant name="N" value="3"/>
  <for index="i" from="1" to="N">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" start="0.3*i"/>
    <displacement name="stretch[i]" unit="m"/>
    <particle name="bob[i]" mass="m" x="0.1*sin(2*time) + sum(j, 1, i, (l + stretch[j])*sin(theta[j]))"
              y="-sum(j, 1, i, (l + stretch[j])*cos(theta[j]))"/>
    <potential>m*g*bob[i].y</potential>
    <output name="T[i]" unit="N">stretch[i].force</output>
  </for>
  <force on="bob[N]" x="F"/>
</system>
"""
WIRE = """<system name="DisplacedWire" description="Charged bead on a wire in a magnetic field">
  <parameter name="m" start="1"/>
  <parameter name="l" start="1"/>
  <parameter name="b" start="1"/>
  <parameter name="k" start="1"/>
  <parameter name="J" start="1"/>
  <parameter name="u" start="1"/>
  <coordinate name="s" velocity="v" start="1"/>
  <displacement name="d"/>
  <particle name="bead" mass="m" x="s*cos(u) - d*sin(u)" y="s*sin(u) + d*cos(u)"/>
  <kinetic>J*(der(bead.x) + 2*der(bead.y))^2/2</kinetic>
  <potential>-b*(bead.x*der(bead.y) - bead.y*der(bead.x))/2 + k*(s - l + d/3)^2/2</potential>
  <output name="D">2*d.force + d</output>
</system>
"""
CRANE = """<system name="DrivenCrane" description="Load on a crane whose trolley is driven">
  <parameter name="M" start="10" unit="kg" min="0"/>
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="2" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="b" start="0.3"/>
  <parameter name="k" start="5" unit="N/m"/>
  <input name="F" unit="N"/>
  <input name="u" unit="m/s2"/>
  <coordinate name="x" velocity="v" unit="m" acceleration="pull"/>
  <define name="pull" unit="m/s2">u</define>
  <coordinate name="theta" velocity="omega" unit="rad" start="0.2"/>
  <displacement name="stretch" unit="m"/>
  <particle name="trolley" mass="M" x="x"/>
  <particle name="load" mass="m" x="x + (l + stretch)*sin(theta)" y="-(l + stretch)*cos(theta)"/>
  <potential>m*g*load.y + k*x^2/2</potential>
  <dissipation>b*v^2/2 + b*omega^2/2</dissipation>
  <force on="trolley" x="F"/>
  <output name="drive" unit="N">x.force</output>
  <output name="rate" unit="m/s2">der(v)</output>
  {further}
</system>
"""
ROBOT = """<system name="DrivenRobot" description="Rods, of which some are driven">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="a" start="3" unit="rad/s2"/>
  <input name="u" unit="rad/s2"/>
  <coordinate name="theta[1]" velocity="omega[1]" unit="rad" start="1"/>
  <coordinate name="theta[2]" velocity="omega[2]" unit="rad" acceleration="a*cos(3*time)"/>
  <for index="i" from="3" to="3"><coordinate name="theta[i]" velocity="omega[i]" unit="rad"/></for>
  <for index="i" from="4" to="4">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" acceleration="(i - 2)*u"/>
  </for>
  <for index="i" from="1" to="4">
    <particle name="bob[i]" mass="m" x="sum(j, 1, i, l*sin(theta[j]))" y="-sum(j, 1, i, l*cos(theta[j]))"/>
    <potential>m*g*bob[i].y</potential>
  </for>
  <output name="torque" unit="N.m">theta[2].force</output>
  {further}
</system>
"""
ARM = """<system name="DrivenArm" description="Arm of two driven joints">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="u" unit="rad/s2"/>
  <coordinate name="alpha" velocity="va" unit="rad" acceleration="u"/>
  <coordinate name="beta" velocity="vb" unit="rad" velocityStart="2" acceleration="0"/>
  <particle name="elbow" mass="m" x="l*cos(alpha)" y="l*sin(alpha)"/>
  <particle name="hand" mass="3*m" x="elbow.x + 2*l*cos(alpha + beta)" y="elbow.y + 2*l*sin(alpha + beta)"/>
  <potential>m*g*(elbow.y + 3*hand.y)</potential>
  <output name="torque" unit="N.m">alpha.force</output>
  {further}
</system>
"""
SEAT = """<system name="MovedSeat" description="Seat and driver on a floor that moves">
  <parameter name="M" start="20" unit="kg" min="0"/>
  <parameter name="m" start="60" unit="kg" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <parameter name="b" start="200" unit="N.s/m"/>
  <parameter name="a" start="400" unit="N.s/m"/>
  <parameter name="k" start="8000" unit="N/m"/>
  <parameter name="h" start="1" unit="m"/>
  <input name="F" unit="N"/>
  <input name="zb" unit="m" derivatives="2"/>
  <coordinate name="x" velocity="v" unit="m"/>
  <coordinate name="y" velocity="w" unit="m"/>
  <displacement name="s" unit="m"/>
  <particle name="seat" mass="M" x="x"/>
  <particle name="driver" mass="m" x="y"/>
  <particle name="knob" mass="0" x="x + zb^2/h/2"/>
  <potential>M*g*x + m*g*y + k*(x + s - zb)^2/2 + 2*k*(y - x)^2/2</potential>
  <dissipation>b*(v - der(zb))^2/2 + a*(w - v)^2/2</dissipation>
  <force on="knob" x="F"/>
  <output name="rise" unit="m/s2">der(der(zb))</output>
  {further}
</system>
"""
HOIST = """<system name="MovedHoist" description="Rods on a pivot that moves, the first drawn in">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="0.5" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="xp" unit="m" derivatives="2"/>
  <input name="L" start="0.8" unit="m" min="-9" derivatives="2"/>
  <for index="i" from="1" to="3">
    <coordinate name="theta[i]" velocity="omega[i]" unit="rad" start="0.2*i"/>
    <particle name="bob[i]" mass="m" x="xp + L*sin(theta[1]) + sum(j, 2, i, l*sin(theta[j]))"
              y="-L*cos(theta[1]) - sum(j, 2, i, l*cos(theta[j]))"/>
    <potential>m*g*bob[i].y</potential>
  </for>
  <output name="speed" unit="m/s">der(bob[2].x)</output>
  {further}
</system>
"""
TABLE = """<system name="MovedTable" description="Bead on a table that is turned from outside">
  <parameter name="m" start="1"/>
  <parameter name="l" start="1"/>
  <parameter name="b" start="1"/>
  <parameter name="k" start="1"/>
  <parameter name="J" start="1"/>
  <input name="phi" derivatives="2"/>
  <coordinate name="r" velocity="vr" start="1"/>
  <particle name="bead" mass="m" x="r*cos(phi)" y="r*sin(phi)"/>
  <kinetic>J*(vr/l + der(phi))^2/2</kinetic>
  <potential>-b*(bead.x*der(bead.y) - bead.y*der(bead.x))/2 + k*r^2/2</potential>
  <output name="across">der(bead.y)</output>
  {further}
</system>
"""
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
    fmu.build_systems("reactions-tables", {name + "T": rename(text, name + "T") for name, text in TEXTS.items()}, "-DFORM=tables")


def rename(text, name):
    return re.sub(r'<system name="\w+"', f'<system name="{name}"', text)


def random_values(case, random, names):
    """One for each argument of the independent derivation; displacements are 0, and so are their rates."""
    system = case.system
    values = {symbol: random.uniform(0.3, 2) for symbol in system.arguments}
    for i, (q, v) in enumerate(zip(system.q, system.v)):
        values[q], values[v] = random.uniform(-2, 2, 2)
        if i in case.held and q.name not in names:
            values[q] = values[v] = 0.0
    return values


def at(name, values, case, open_fmu):
    """The FMU in initialization mode at these values."""
    instance = open_fmu(name)
    instance.fmu.setupExperiment(startTime=values[time])
    known = {symbol.name: value for symbol, value in values.items() if symbol.name in instance.references}
    inputs = set(fmu.names_of(name, "input"))
    instance.set({key: value for key, value in known.items() if key not in inputs and key != "time"})
    instance.fmu.enterInitializationMode()
    instance.set({key: value for key, value in known.items() if key in inputs})
    return instance


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
    """The same system for an author who does not ask for forces."""
    text = re.sub(r"<displacement .*?/>|<output .*?</output>", "", text)
    for written, plain in [(r"px \+ \(l \+ stretch\)", "l"), (r"py - \(l \+ stretch\)", "-l"), (r"theta \+ turn", "theta"),
                           (r"\(l \+ stretch\[j\]\)", "l"), (r"- d\*sin\(u\)|\+ d\*cos\(u\)|\+ d/3", "")]:  # fmt: skip
        text = re.sub(written, plain, text)
    return text


def operations(text, folder):
    """Of each function that the FMU calls for the motion, by its description."""
    (folder / "system.xml").write_text(text)
    assert lagc("system.xml", "-o", "out", cwd=folder).stderr == ""
    found = re.findall(r"^/\* (.*?); (\d+) operations", (folder / "out" / "system.c").read_text(), re.M)
    return {what: count for what, count in found if "parameters alone" not in what and "computed variable" not in what
            and "output" not in what}  # fmt: skip


METHODS = ["taylor", "radau", "auto", "bdf", "erk"]


@pytest.fixture(scope="module")
def cranes():
    """The crane with each solver, and the chain with work, for which its mass matrix is factored symbolically."""
    texts = {f"Crane{m}": rename(CRANE.format(further=f'<work/><solver method="{m}"/>'), f"Crane{m}") for m in METHODS}
    texts["WorkingRobot"] = rename(ROBOT.format(further="<work/>"), "WorkingRobot")
    fmu.build_systems("cranes", texts)


@pytest.mark.parametrize("method", METHODS)
def test_every_solver_drives(method, cranes, open_fmu):
    """The motion against DOP853 on the independent derivation; the energy changes by the work of force and drive alone."""
    case = reactions_in_sympy.CASES["DrivenCrane"]()
    start = fmu.start_values("DrivenCrane") | {"F": 3.0, "u": 1.5, "v": 0.5}
    others = [start[s.name] for s in [*case.system.inputs, *case.system.parameters]]

    def derivative(t, state):
        x, theta, v, omega = state
        accelerations, _ = case.solve(t, x, theta, 0.0, v, omega, 0.0, *others)
        return [v, omega, *accelerations[:2]]

    exact = solve_ivp(derivative, (0, 2), [start[n] for n in ("x", "theta", "v", "omega")], method="DOP853",
                      rtol=1e-12, atol=1e-12).y[:, -1]  # fmt: skip
    instance = open_fmu(f"Crane{method}").initialize({key: start[key] for key in ("F", "u", "v")}, 1e-9)
    before = instance.get("totalEnergy")
    instance.run(2, 0.5, "x")
    np.testing.assert_allclose(instance.get("x", "theta", "v", "omega"), exact, rtol=1e-6, atol=1e-7)
    work = instance.get("nonConservativeWork")
    assert work > 10 and instance.get("totalEnergy") - before == pytest.approx(work, rel=1e-7)


def test_work_of_drives_in_a_chain(cranes, open_fmu):
    instance = open_fmu("WorkingRobot").initialize({"u": 0.7, "omega[2]": 1.0}, 1e-11)
    before, works = instance.get("totalEnergy"), []
    for _ in range(8):
        instance.step(0.25)
        works.append(instance.get("nonConservativeWork"))
        assert instance.get("totalEnergy") - before == pytest.approx(works[-1], rel=1e-8, abs=1e-8)
    assert max(np.abs(works)) > 1


@pytest.fixture(scope="module")
def moved():
    """What inputs move with each solver, and the chain with work."""
    texts = {f"Seat{m}": rename(SEAT.format(further=f'<work/><solver method="{m}"/>'), f"Seat{m}") for m in METHODS}
    texts["WorkingHoist"] = rename(HOIST.format(further="<work/>"), "WorkingHoist")
    texts["ExactSeat"] = rename(SEAT.format(further='<solver method="exact"/>').replace("zb^2/h/2", "zb"), "ExactSeat")
    fmu.build_systems("moved", texts)


def move(instance, motions, time):
    """Sets inputs and their derivatives so that they are polynomials (of numpy) from this time on."""
    for name, polynomial in motions.items():
        rates = [polynomial.deriv(k) if k > 0 else polynomial for k in range(3)]
        for rate, variable in zip(rates, (name, f"der({name})", f"der(der({name}))")):
            instance.set({variable: rate(time)})
    references, orders, values = [], [], []
    for name, polynomial in motions.items():
        for k, variable in enumerate((name, f"der({name})", f"der(der({name}))")):
            for order in (1, 2, 3):
                references += instance.vr(variable)
                orders.append(order)
                values.append(polynomial.deriv(k + order)(time))
    instance.fmu.setRealInputDerivatives(references, orders, values)


def check_balance(instance, motions, stop, steps, least):
    """With inputs that fit together, totalEnergy changes by nonConservativeWork, at whatever points one looks."""
    move(instance, motions, 0.0)
    before, works = instance.get("totalEnergy"), []
    for time in np.linspace(0, stop, steps + 1)[1:]:
        instance.step(time - instance.time)
        move(instance, motions, time)
        works.append(instance.get("nonConservativeWork"))
        assert instance.get("totalEnergy") - before == pytest.approx(works[-1], rel=1e-7, abs=1e-7)
    assert max(np.abs(works)) > least


@pytest.mark.parametrize("method", METHODS)
def test_work_of_what_moves_the_floor(method, moved, open_fmu):
    instance = open_fmu(f"Seat{method}").initialize({"F": 5.0, "der(zb)": 0.2, "der(der(zb))": -1.0}, 1e-10)
    check_balance(instance, {"zb": np.polynomial.Polynomial([0, 0.2, -0.5, 0.3])}, 1.0, 3, 1.0)


def test_work_of_what_draws_a_chain(moved, open_fmu):
    motions = {"xp": np.polynomial.Polynomial([0, 1.0, -0.4, 0.1]), "L": np.polynomial.Polynomial([0.8, -0.3, 0, 0.1])}
    instance = open_fmu("WorkingHoist").initialize({"der(xp)": 1.0, "der(L)": -0.3}, 1e-11)
    check_balance(instance, motions, 1.0, 4, 1.0)


def test_work_of_what_turns_a_table(open_fmu):
    """A gyroscopic potential and a <kinetic> of the table's rate are in the balance too."""
    motions = {"phi": np.polynomial.Polynomial([0.1, 2.0, 0.5, -0.2])}
    instance = open_fmu("MovedTable").initialize({"phi": 0.1, "der(phi)": 2.0, "der(der(phi))": 1.0}, 1e-12)
    check_balance(instance, motions, 1.0, 4, 1.0)


def test_exact_method_with_a_moved_floor(moved, open_fmu):
    """A step of any length as with the Taylor series, inputs held."""
    values = {"zb": 0.1, "der(zb)": 0.3, "der(der(zb))": 2.0}
    results = []
    for name in ("ExactSeat", "Seattaylor"):
        instance = open_fmu(name).initialize(values, 1e-12)
        instance.step(0.7)
        results.append(instance.get("x", "y", "v", "w"))
    np.testing.assert_allclose(*results, rtol=1e-9)


def test_inputs_with_derivatives_are_variables():
    by_name = {v.name: v for v in fmu.description("MovedHoist").modelVariables}
    for name, unit, start in [("xp", "m", 0.0), ("der(xp)", "m/s", 0.0), ("der(der(xp))", "m/s2", 0.0), ("L", "m", 0.8)]:
        variable = by_name[name]
        assert (variable.causality, variable.unit, float(variable.start)) == ("input", unit, start)
    assert float(by_name["L"].min) == -9 and by_name["der(L)"].min is None
    # der(der(x)) is no structured name of the standard, whose second derivative is der(x,2).
    assert fmu.description("MovedHoist").variableNamingConvention == "flat"
    assert fmu.description("DrivenArm").variableNamingConvention == "structured"


DRIVEN_SPRING = """<system name="DrivenSpring">
  <parameter name="m" start="2" unit="kg"/>
  <parameter name="k" start="18" unit="N/m"/>
  <input name="u" unit="m/s2"/>
  <coordinate name="x" velocity="v" unit="m" acceleration="{}"/>
  <coordinate name="y" velocity="w" unit="m"/>
  <particle mass="m" x="x + y"/>
  <potential>k*y^2/2</potential>
  <solver method="exact"/>
</system>
"""


def test_linear_systems_with_drives(open_fmu):
    """y'' = -u - 9 y: y = -u/9 (1 - cos 3 t), by the method for linear systems."""
    fmu.build_systems("drivenspring", {"DrivenSpring": DRIVEN_SPRING.format("u")})
    instance = open_fmu("DrivenSpring").initialize({"u": 4.5})
    instance.step(2.0)
    assert instance.get("x") == pytest.approx(9.0, rel=1e-12)
    assert instance.get("y") == pytest.approx(-0.5 * (1 - np.cos(6)), rel=1e-12)
    assert instance.get("x.force") == pytest.approx(-18 * instance.get("y"), rel=1e-12)  # the spring pushes


def test_linear_systems_are_not_driven_by_time(tmp_path):
    (tmp_path / "system.xml").write_text(DRIVEN_SPRING.format("9.81*sin(time)"))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.search(r"der\(v\) depends on time; expected another method", result.stderr)


def test_linearized_crane(tmp_path):
    """x'' = u whatever the state; theta'' = -(g theta + u)/l - b omega/(m l^2)."""
    (tmp_path / "system.xml").write_text(CRANE.format(further=""))
    result = lagc("--linearize", "system.xml", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "[0, 0, 0, 0]\n  [0, -g/l, 0, -b/(m*l^2)]" in result.stdout and "[0, 1]\n  [0, -1/l]" in result.stdout


@pytest.mark.parametrize("name", DISPLACED)
def test_motion_does_not_know_of_displacements(name, tmp_path):
    counts = operations(TEXTS[name], tmp_path)
    assert len(counts) >= 3 and counts == operations(without_displacements(TEXTS[name]), tmp_path)


def test_variables():
    by_name = {variable.name: variable for variable in fmu.description("DisplacedBearing").modelVariables}
    for name, unit in [("stretch.force", "kg.m/s2"), ("turn.force", "kg.m2/(s2.rad)")]:
        assert (by_name[name].causality, by_name[name].unit) == ("local", unit)
    assert not {"stretch", "px", "der(stretch)"} & set(by_name)
    assert {v.name: v.unit for v in fmu.description("DisplacedWire").modelVariables}["d.force"] is None
    for name in TEXTS:
        assert validate_fmu(str(fmu.archive(name))) == []


def test_dependencies_of_outputs():
    """The tension follows from the angle, its rate, the torque by way of the acceleration, and F."""
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
    """Directional derivatives of an output against central differences of it, by states, inputs and parameters."""
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
    """The time derivative of a tension, from the series of the motion, against differences of it."""
    instance = open_fmu("DisplacedChain").initialize(tolerance=1e-12)
    instance.step(0.5)
    rate = instance.fmu.getRealOutputDerivatives(instance.vr("T[1]"), [1])[0]
    before = instance.get("T[1]")
    instance.step(1e-4)
    after = instance.fmu.getRealOutputDerivatives(instance.vr("T[1]"), [1])[0]
    assert instance.get("T[1]") - before == pytest.approx((rate + after) / 2 * 1e-4, rel=1e-6)


def test_linearized_force(tmp_path, open_fmu):
    """Near the lowest point the tension is m g, to first order, and the bearing has m g theta across."""
    instance = open_fmu("LinearBearing").initialize({"theta": 0.1, "m": 3.0, "b": 0.0})
    assert instance.get("stretch.force") == pytest.approx(3 * 9.81, rel=1e-12)
    instance.step(0.2)
    # For J = 0.1: the rod takes part in the acceleration with m l^2/(m l^2 + J).
    share = 3 * 0.25 / (3 * 0.25 + 0.1)
    assert instance.get("px.force") == pytest.approx(3 * 9.81 * instance.get("theta") * share, rel=1e-9)


def test_page_shows_the_force(tmp_path):
    (tmp_path / "system.xml").write_text(BEARING)
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    page = (tmp_path / "out" / "documentation" / "index.html").read_text()
    assert test_documentation.check(page) == page.count("<code>")
    section = page[page.index("Forces of reaction") :]
    assert "<code>stretch.force = " in section and section.index("<math") < section.index("stretch.force = ")
