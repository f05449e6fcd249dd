"""Deep kinematic trees with the articulated-body algorithm: against energies by mpmath, a closed form, and the energy balance."""

import re

import mpmath as mp
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from robots_by_energies import Robot

import fmu
from fmu import build_systems
from numerics.space.accelerations import chain

pytestmark = pytest.mark.long

LINKS = 10  # of the pendulum


def joint(number, parent, kind, random):
    """A joint and its child link."""
    numbers = lambda low, high, count=3: " ".join(f"{x:.6f}" for x in random.uniform(low, high, count))
    a, b, c = random.uniform(0.02, 0.05, 3)
    return f"""
      <joint name="joint{number}" type="{kind}"><parent link="link{parent}"/><child link="link{number}"/>
        <origin xyz="{numbers(-0.3, 0.3)}" rpy="{numbers(-2, 2)}"/><axis xyz="{numbers(-1, 1)}"/></joint>
      <link name="link{number}"><inertial><origin xyz="{numbers(-0.1, 0.1)}" rpy="{numbers(-1, 1)}"/><mass value="{random.uniform(0.5, 2):.6f}"/>
        <inertia ixx="{b + c:.6f}" iyy="{a + c:.6f}" izz="{a + b:.6f}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def robot_of_many_joints():
    random = np.random.default_rng(5)
    parents = [0, 1, 2, 3, 4, 5, 6, 7, 5, 9, 10]  # a chain of eight, and a branch of three
    kinds = ["continuous", "prismatic", "continuous", "fixed", "continuous", "continuous", "continuous", "prismatic", "continuous", "continuous", "continuous"]
    parts = [joint(i + 1, parent, kind, random) for i, (parent, kind) in enumerate(zip(parents, kinds))]
    return f'<robot name="DeepRobot"><link name="link0"/>{"".join(parts)}</robot>', [i + 1 for i, kind in enumerate(kinds) if kind != "fixed"]


def pendulum():
    """Particles on a chain of frames that rotate relative to each other."""
    lines = ['<parameter name="l" start="0.7" unit="m"/>', '<parameter name="m" start="0.4" unit="kg" min="0"/>']
    for i in range(1, LINKS + 1):
        inside, shift = ("", "") if i == 1 else (f' in="rod{i - 1}"', '<translate y="-l"/>')
        lines.append(f'<coordinate name="q{i}" velocity="w{i}" unit="rad"/>')
        lines.append(f'<frame name="rod{i}"{inside}>{shift}<rotate axis="z" angle="q{i}"/></frame><particle name="bob{i}" in="rod{i}" y="-l" mass="m"/>')
    return f'<system name="FoldingPendulum">{"".join(lines)}<gravity y="-9.81"/><experiment stopTime="1"/></system>'


ROBOT, NUMBERS = robot_of_many_joints()
# A hinge in the middle of the chain has a prescribed acceleration.
PRESCRIBED = pendulum().replace('name="q5" velocity="w5" unit="rad"', 'name="q5" velocity="w5" unit="rad" acceleration="push"')
PRESCRIBED = PRESCRIBED.replace("FoldingPendulum", "DrivenPendulum").replace("<coordinate", '<constant name="push" value="2" unit="rad/s2"/><coordinate', 1)


@pytest.fixture(scope="module", autouse=True)
def systems():
    build_systems("trees", {"DeepRobot": ROBOT, "FoldingPendulum": pendulum(), "DrivenPendulum": PRESCRIBED})


@pytest.mark.parametrize("name", ["DeepRobot", "FoldingPendulum", "DrivenPendulum"])
def test_mass_matrix_is_not_formed(name):
    source = (fmu.archive(name).parent.parent / "systems" / name / "system.c").read_text()
    assert "ldlt_factor" not in source


def test_long_function_is_written_in_parts():
    """The function derivatives is split into several C functions; the tests of the robot below check its values."""
    assert "derivatives_2(" in (fmu.archive("DeepRobot").parent.parent / "systems" / "DeepRobot" / "system.c").read_text()


def test_robot(open_fmu):
    robot, instance, random = Robot(ROBOT), open_fmu("DeepRobot"), np.random.default_rng(1)
    names = [f"joint{i}" for i in NUMBERS]
    position, velocity, forces = random.uniform(-2, 2, (3, len(names)))
    inputs = fmu.names_of("DeepRobot", "input")
    instance.initialize(dict(zip([*names, *[f"{name}_velocity" for name in names], *inputs], [*position, *velocity, *forces])))
    with mp.workdps(45):
        expected = robot.accelerations(position, velocity, forces)
    np.testing.assert_allclose(instance.get(*[f"der({name}_velocity)" for name in names]), expected, rtol=1e-9)


def test_cost_grows_as_the_chain(tmp_path):
    """
    The C source grows linearly with the length of a chain of joints, frames and bodies. An evaluation takes about as many operations per joint as the
    articulated-body algorithm. That has 224 multiplications and 205 additions if one component of each offset is 0 (Featherstone 2008, table 10.1),
    which is not the case here.
    """
    sizes, operations = [], []
    for count in (100, 200):
        assert fmu.lagc(chain(count), "-o", tmp_path).returncode == 0
        source = (tmp_path / "system.c").read_text()
        sizes.append(len(source))
        operations.append(int(re.search(r"(\d+) operations[^\n]*\nstatic int derivatives\(", source)[1]))
    assert sizes[1] < 2.5 * sizes[0]
    assert operations[1] - operations[0] < 1.05 * 100 * (224 + 205)


def absolute_accelerations(angles, rates, prescribed=None):
    """Accelerations of the angles from the vertical; prescribed: the joint whose motion is prescribed, and its acceleration."""
    n = LINKS
    share = n - np.maximum.outer(np.arange(n), np.arange(n))  # number of bobs that both rods carry
    apart = np.subtract.outer(angles, angles)
    mass, right = share * np.cos(apart), -(share * np.sin(apart)) @ rates**2 - 9.81 / 0.7 * np.diag(share) * np.sin(angles)
    if prescribed is None:
        return np.linalg.solve(mass, right)
    joint, acceleration = prescribed
    row = np.zeros(n)
    row[joint], row[joint - 1] = 1, -1
    saddle = np.block([[mass, row[:, None]], [row[None], np.zeros((1, 1))]])
    return np.linalg.solve(saddle, [*right, acceleration])[:n]


@pytest.mark.parametrize("name", ["FoldingPendulum", "DrivenPendulum"])
def test_pendulum(name, open_fmu):
    instance, random = open_fmu(name), np.random.default_rng(2)
    q, w = random.uniform(-2, 2, (2, LINKS))
    instance.initialize({f"q{i + 1}": q[i] for i in range(LINKS)} | {f"w{i + 1}": w[i] for i in range(LINKS)})
    expected = absolute_accelerations(np.cumsum(q), np.cumsum(w), None if name == "FoldingPendulum" else (4, 2.0))
    ours = instance.get(*[f"der(w{i + 1})" for i in range(LINKS)])
    np.testing.assert_allclose(np.cumsum(ours), expected, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("solver", ["taylor", "radau"])
def test_arm(solver, open_fmu):
    """
    Energy balance of a gantry that moves along three axes, with motors, a slider in its frame, and damping. radau computes the Jacobian by
    directional derivatives.
    """
    name = f"BranchedArm_{solver}"
    text = (fmu.ROOT / "tests" / "support" / "branched_arm.xml").read_text()
    build_systems(f"trees-{solver}", {name: text.replace("BranchedArm", name).replace("<work/>", f'<work/><solver method="{solver}"/>')})
    instance = open_fmu(name).initialize(tolerance=1e-11)
    start = instance.get("totalEnergy")
    instance.step(1.5)
    assert instance.get("nonConservativeWork") < -0.1
    assert instance.get("totalEnergy") - instance.get("nonConservativeWork") == pytest.approx(start, abs=1e-8)
    check_direction(open_fmu(name, kind=FMU2Model))


def check_direction(instance):
    """Compare the directional derivative of the accelerations with difference quotients of fourth order."""
    random, states = np.random.default_rng(3), [name for name in fmu.states_of(instance.description.modelName) if name != "nonConservativeWork"]
    place, direction = random.uniform(-1, 1, (2, len(states)))
    accelerations = [f"der({name})" for name in states if name[0] in "vw"]
    ahead, after, further_ahead, further_after = [
        np.array(instance.put(dict(zip(states, place + 1e-3 * steps * direction))).get(*accelerations)) for steps in (1, -1, 2, -2)
    ]
    expected = (8 * (ahead - after) - (further_ahead - further_after)) / 12e-3
    instance.put(dict(zip(states, place)))
    ours = instance.fmu.getDirectionalDerivative(instance.vr(*accelerations), instance.vr(*states), list(direction))
    np.testing.assert_allclose(ours, expected, rtol=1e-7, atol=1e-7 * np.max(np.abs(expected)))


def wrist(axes):
    """A body on a carriage and hinges, and another on hinges about three axes of the first."""
    declared = "".join(f'<coordinate name="q{i}" velocity="w{i}"/>' for i in range(1, 10))
    hinges = "".join(f'<rotate axis="{axis}" angle="q{i}"/>' for i, axis in enumerate(axes, 7))
    return f"""<system name="Wrist">{declared}
      <frame name="arm"><translate x="q1" y="q2" z="q3"/><rotate axis="z" angle="q4"/><rotate axis="x" angle="q5"/><rotate axis="y" angle="q6"/></frame>
      <body name="a" in="arm" mass="2" x="0.4" Ixx="0.3" Iyy="0.4" Izz="0.5"/>
      <frame name="hand" in="arm"><translate x="0.3" y="0.1"/>{hinges}</frame>
      <body name="b" in="hand" mass="2" x="0.1" Ixx="0.3" Iyy="0.4" Izz="0.5" Ixy="0.03" Ixz="-0.04" Iyz="0.02"/>
      <gravity z="-9.81"/><experiment stopTime="1"/></system>"""


def test_pole_about_tilted_axes(open_fmu):
    """The first and the third axis of the hand are parallel at 0, where the inertia is 0 up to rounding."""
    build_systems("trees-pole", {"Wrist": wrist(["1 2 -0.5", "-2 1 0.3", "1 2 -0.5"])})
    instance = open_fmu("Wrist")
    with instance.fails(fmu.ERROR, "singular .* in coordinate 'q7'"):
        instance.initialize({"w4": 1.0})


def test_two_hinges_about_one_axis(tmp_path):
    path = tmp_path / "system.xml"
    path.write_text(wrist(["x", "0 0.6 0.8", "0 0.6 0.8"]).replace('angle="q8"/>', 'angle="q8"/></frame><frame name="palm" in="hand">').replace('in="hand" mass', 'in="palm" mass'))
    result = fmu.lagc(path, "-o", tmp_path)
    assert result.returncode == 1 and "the mass matrix is singular: the velocity of 'w9' is not independent" in result.stderr


def test_constraints_that_follow_from_each_other(open_fmu):
    """Two dependent constraints on two coordinates of the gantry give the motion of one of them."""
    constraints = ['<constraint name="k">q1 - q2/2</constraint>', '<constraint name="l">2*q1 - q2</constraint>']
    text = wrist(["x", "y", "z"]).replace("<gravity", "{}<gravity")
    texts = {name: text.replace("Wrist", name).format("".join(parts)) for name, parts in {"HeldOnce": constraints[:1], "HeldTwice": constraints}.items()}
    build_systems("trees-prescribed", texts)
    start = {"q1": 0.2, "q2": 0.4, "q8": 0.5, "w1": 0.3, "w2": 0.6, "w5": 1.0, "w9": 2.0}
    rates = [open_fmu(name).initialize(start).get(*[f"der(w{i})" for i in range(1, 10)]) for name in texts]
    np.testing.assert_allclose(*rates, rtol=1e-9, atol=1e-9)
