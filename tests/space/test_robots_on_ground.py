"""Robots on the ground: the shapes of a URDF's <collision>, and the ground of an <include>."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fmu
from building import build_systems
from fmu import lagc

pytestmark = pytest.mark.long

LEGS = {"lf": (0.2, 0.1), "rf": (0.2, -0.1), "lh": (-0.2, 0.1), "rh": (-0.2, -0.1)}
INERTIA = '<inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/>'


def leg(name, x, y):
    part = '<link name="{0}"><inertial><origin xyz="0 0 -0.1"/><mass value="{1}"/>{2}</inertial>{3}</link>'
    joint = '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3}"/><axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>'
    foot = '<collision><origin xyz="0 0 -0.2"/><geometry><sphere radius="0.025"/></geometry></collision>'
    thigh, shank = part.format(f"{name}_thigh", 1, INERTIA.format(0.004), ""), part.format(f"{name}_shank", 0.5, INERTIA.format(0.002), foot)
    hip = joint.format(f"{name}_hip", "trunk", f"{name}_thigh", f"{x} {y} 0")
    return hip + thigh + joint.format(f"{name}_knee", f"{name}_thigh", f"{name}_shank", "0 0 -0.2") + shank


DOG = f"""<robot name="dog"><link name="trunk"><inertial><mass value="8"/>{INERTIA.format(0.15)}</inertial>
<collision><geometry><box size="0.5 0.18 0.1"/></geometry></collision></link>{"".join(leg(name, *place) for name, place in LEGS.items())}</robot>"""
WISHES = {"hip": 0.5, "knee": -1.0}
MOTORS = "".join(
    f'<input name="{leg}_{joint}_torque" value="200*({request} - dog.{leg}_{joint}) - 5*dog.{leg}_{joint}_velocity"/>' for leg in LEGS for joint, request in WISHES.items()
)
STARTS = "".join(f'<coordinate name="{leg}_{joint}" start="{request}"/>' for leg in LEGS for joint, request in WISHES.items())
STANDING = f"""<system name="Standing"><include file="dog.urdf" as="dog" base="floating" ground="true">{MOTORS}{STARTS}
<coordinate name="base_z" start="0.385"/></include><experiment stopTime="5" stepSize="0.01"/></system>"""
ROUND = """<robot name="roller"><link name="roller"><inertial><mass value="3"/>{0}</inertial>
<collision><origin xyz="0.1 0 0.05" rpy="1.5707963267948966 0 0.3"/><geometry><cylinder radius="0.2" length="0.6"/></geometry></collision></link></robot>"""
ROLLER = '<system name="Roller"><include file="roller.urdf" as="r" base="floating" ground="true"/></system>'

LIMB = """<link name="thigh{0}"><inertial><origin xyz="0 0 -0.1"/><mass value="0.8"/>{1}</inertial></link><link name="calf{0}"><inertial><origin xyz="0 0 -0.1"/><mass value="0.15"/>{2}</inertial>
<collision><origin xyz="0 0 -0.2"/><geometry><sphere radius="0.02"/></geometry></collision></link><joint name="hip{0}" type="revolute"><parent link="trunk"/><child link="thigh{0}"/>
<origin xyz="{3}"/><axis xyz="{4}"/><limit lower="-0.6" upper="0.6"/><dynamics damping="0.01" friction="0.2"/></joint><joint name="knee{0}" type="revolute"><parent link="thigh{0}"/>
<child link="calf{0}"/><origin xyz="0 0 -0.2"/><axis xyz="0 1 0"/><limit lower="-2.5" upper="-0.5"/><dynamics damping="0.01" friction="0.2"/></joint>"""
LIMBS = "".join(LIMB.format(k, INERTIA.format(0.002), INERTIA.format(0.0006), *place) for k, place in enumerate([("-0.15 -0.024 0", "1 0 0"), ("0.15 -0.014 0", "0 1 0")]))
LIMP = f"""<robot name="limp"><link name="trunk"><inertial><mass value="3"/>{INERTIA.format(0.05)}</inertial></link>{LIMBS}</robot>"""
FALLING = '<system name="Falling"><include file="limp.urdf" as="r" base="floating" ground="true" limits="stops" friction="sticks"/></system>'
# A puck on a table, whose joint fixes its height 0.5 mm deep in the ground.
PUCK = f"""<robot name="puck"><link name="table"/><link name="puck"><inertial><mass value="2"/>{INERTIA.format(0.1)}</inertial>
<collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision></link>
<joint name="slide" type="planar"><parent link="table"/><child link="puck"/><origin xyz="0 0 0.0995"/><axis xyz="0 0 1"/></joint></robot>"""
SLIDING = '<system name="Sliding"><include file="puck.urdf" as="r" ground="true"/><experiment stopTime="1"/></system>'


@pytest.fixture(scope="module", autouse=True)
def built():
    files = {"Standing/dog.urdf": DOG, "Roller/roller.urdf": ROUND.format(INERTIA.format(0.1)), "Falling/limp.urdf": LIMP, "Sliding/puck.urdf": PUCK}
    build_systems("grounded", {"Standing": STANDING, "Roller": ROLLER, "Falling": FALLING, "Sliding": SLIDING}, files=files)


def test_a_quadruped_stands():
    """The feet carry the weight, the moments of their forces about the centre of mass are 0, and the robot does not drift."""
    instance = fmu.Instance("Standing", logging=False)
    try:
        instance.initialize()
        instance.run(6.0, 0.01)
        forces = np.array([instance.get(f"dog.{leg}_shank_ground1.force") for leg in LEGS])
        feet = np.array([[instance.get(f"dog.{leg}_shank.{a}") - 0.2 * instance.get(f"dog.{leg}_shank.R{i}3") for i, a in ((1, "x"), (2, "y"))] for leg in LEGS])
        bodies = {"trunk": 8.0} | {f"{leg}_{part}": mass for leg in LEGS for part, mass in (("thigh", 1.0), ("shank", 0.5))}
        centre = sum(mass * np.array([instance.get(f"dog.{link}_body.{axis}") for axis in "xy"]) for link, mass in bodies.items()) / 14
        assert sum(forces) == pytest.approx(14 * 9.81, rel=1e-6)
        assert forces @ (feet - centre) / sum(forces) == pytest.approx([0, 0], abs=1e-6)
        assert all(forces > 10) and instance.get("dog.trunk_ground1.force") == 0
        assert abs(instance.get("dog.base_x_velocity")) < 1e-5
    finally:
        instance.free()


@pytest.mark.parametrize("start", [0, 1, 2, 3, 4, 5, 11])
def test_limbs_fall_against_their_stops(start, open_fmu):
    """
    Joints at their stops have dry friction too, and stiff feet make the solver switch to Radau. Over some 200 events neither rounding nor
    integration errors reverse an impending slip.
    """
    random = np.random.default_rng(start)
    instance = open_fmu("Falling").initialize({"r.base_z": random.uniform(0.5, 0.6), "r.base_qy": random.uniform(-0.3, 0.3)})
    joints = [f"r.{name}{k}" for name in ("hip", "knee") for k in range(2)]
    energies, in_air = [instance.get("totalEnergy")], True
    for step in range(120):
        instance.run(0.01 * (step + 1), 0.01)
        angles, forces = np.array(instance.get(*joints)), np.array(instance.get(*(f"{joint}_bearing.force" for joint in joints)))
        assert np.all(angles > np.array([-0.6, -0.6, -2.5, -2.5]) - 1e-9) and np.all(angles < np.array([0.6, 0.6, -0.5, -0.5]) + 1e-9)
        assert np.all(np.abs(forces) < 0.2 + 1e-9)
        # The energy excludes that stored in the ground at a foot.
        energies.append(instance.get("totalEnergy"))
        was_in_air, in_air = in_air, instance.get("r.calf0_ground1.force", "r.calf1_ground1.force") == [0, 0]
        assert energies[-1] < energies[-2] + 1e-9 or not (was_in_air and in_air)
    assert energies[-1] < energies[0] - 5


def test_where_shapes_are():
    """A cylinder with origin and rpy: its force gives the depths of the lowest points of its rims in the ground."""
    instance = fmu.Instance("Roller", logging=False)
    try:
        # By the URDF reference, rotations are about the fixed axes x, y, z.
        own, base = Rotation.from_euler("xyz", [math.pi / 2, 0, 0.3]), Rotation.from_euler("x", 0.4)
        circle = np.linspace(0, 2 * math.pi, 10001)
        rims = [np.transpose([0.2 * np.cos(circle), 0.2 * np.sin(circle), np.full(10001, end)]) for end in (-0.3, 0.3)]
        heights = [min(base.apply(np.array([0.1, 0, 0.05]) + own.apply(rim))[:, 2]) for rim in rims]
        height = -min(heights) - 0.005
        instance.initialize({"r.base_z": height, "r.base_qw": math.cos(0.2), "r.base_qx": math.sin(0.2)})
        expected = instance.get("r.ground_stiffness") * sum(max(-(height + below), 0) for below in heights)
        assert expected > 0
        assert instance.get("r.roller_ground1.force") == pytest.approx(expected, rel=1e-6)
    finally:
        instance.free()


def test_links_that_stand_are_named(tmp_path):
    """Only the named links have contacts; an unknown name, or a link without a shape, gives a message."""
    (tmp_path / "dog.urdf").write_text(DOG)

    def read(names):
        (tmp_path / "system.xml").write_text(STANDING.replace('ground="true"', f'ground="{names}"'))
        return lagc("system.xml", "-o", "out", cwd=tmp_path)

    assert read(" lf_shank rh_shank ").returncode == 0
    variables = (tmp_path / "out" / "modelDescription.xml").read_text()
    assert [f"dog.{leg}_shank_ground1.force" in variables for leg in LEGS] == [True, False, False, True]
    assert "dog.trunk_ground1.force" not in variables
    assert "there is no link 'lf_shnk' for the ground; did you mean 'lf_shank'?" in read("rf_shank lf_shnk").stderr
    assert "dog.urdf:2: the link 'lf_thigh' has no shape that could stand on the ground" in read("lf_thigh").stderr


ANYMAL = "anymal_b_simple_description/robots/anymal.urdf"
FEET = ["LF", "RF", "LH", "RH"]
POSE = {f"{foot}_{joint}": angle * (1 if foot[1] == "F" else -1) for foot in FEET for joint, angle in (("HAA", 0.0), ("HFE", 0.7), ("KFE", -1.0))}


@pytest.fixture(scope="module")
def anymal():
    """Path of ANYmal's URDF; builds an FMU that stands on its feet."""
    pin = pytest.importorskip("pinocchio")
    path = Path(pin.__file__).parents[4] / "share" / "example-robot-data" / "robots" / ANYMAL
    servo = '<coordinate name="{0}" start="{1}"/><input name="{0}_torque" value="kp*({1} - dog.{0}) - kd*dog.{0}_velocity"/>'
    servos = "".join(servo.format(joint, angle) for joint, angle in POSE.items())
    torques = "".join(f'<output name="{joint}_torque" unit="N.m">kp*({angle} - dog.{joint}) - kd*dog.{joint}_velocity</output>' for joint, angle in POSE.items())
    text = f"""<system name="Anymal"><parameter name="kp" start="300" unit="N.m/rad"/><parameter name="kd" start="15" unit="N.m.s/rad"/>
<include file="{path}" as="dog" base="floating" ground="{" ".join(f"{foot}_FOOT" for foot in FEET)}"><coordinate name="base_z" start="0.53"/>{servos}</include>{torques}</system>"""
    build_systems("anymal", {"Anymal": text})
    return path


def test_code_of_many_points_and_stops(tmp_path):
    """ANYmal on all its shapes with its stops: 6 MB of C without formulas for its Jacobian, and 18 MB with them and code for each point."""
    pin = pytest.importorskip("pinocchio")
    path = Path(pin.__file__).parents[4] / "share" / "example-robot-data" / "robots" / ANYMAL
    (tmp_path / "system.xml").write_text(f'<system name="Falling"><include file="{path}" as="r" base="floating" ground="true" limits="stops"/></system>')
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    code = (tmp_path / "out" / "system.c").read_text()
    assert " jacobian(const struct Point" not in code and len(code) < 8_000_000


@pytest.mark.release
def test_anymal_stands(anymal, open_fmu):
    """
    At rest the weights of all links, the forces on the feet and the torques of the motors balance along each of the 18 velocities. Pinocchio gives
    the weights' share. With little friction the feet slide apart until no horizontal forces remain.
    """
    import pinocchio as pin

    instance = open_fmu("Anymal")
    instance.initialize({"dog.ground_friction": 0.02}, tolerance=1e-10)
    instance.run(40.0, 0.5)
    model = pin.buildModelFromUrdf(str(anymal), pin.JointModelFreeFlyer())
    data, joints = model.createData(), [*model.names[2:]]
    q = np.array([instance.get(f"dog.base_{name}") for name in ("x", "y", "z", "qx", "qy", "qz", "qw")] + [instance.get(f"dog.{joint}") for joint in joints])
    balance = pin.computeGeneralizedGravity(model, data, q)
    balance[6:] -= [instance.get(f"{joint}_torque") for joint in joints]
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    forces = [instance.get(f"dog.{foot}_FOOT_ground1.force") for foot in FEET]
    for foot, force in zip(FEET, forces):
        # Moment arm of the centre of the foot's sphere, along the world axes.
        frame = model.getFrameId(f"{foot}_FOOT", pin.FrameType.BODY)
        jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
        lever = data.oMf[frame].rotation @ [0, 0, 0.02325]
        balance -= jacobian[:3].T @ [0, 0, force] + jacobian[3:].T @ np.cross(lever, [0, 0, force])
    weight = 9.81 * sum(inertia.mass for inertia in model.inertias)
    assert sum(forces) == pytest.approx(weight, rel=2e-9) and min(forces) > 0.2 * weight
    assert np.max(np.abs(balance)) < 1e-6 * weight


def test_a_puck_slides(open_fmu):
    """Each of the four corners presses with k times 0.5 mm, where k = m g/mm, though no coordinate moves the puck along the normal."""
    slower = 0.8 * (4 * 2 * 9.81 / 2) / 2
    instance = open_fmu("Sliding").initialize({"r.slide_x_velocity": 10.0})
    for time, speed, force in instance.run(0.5, 0.125, "r.slide_x_velocity", "r.puck_ground1.force"):
        assert force == pytest.approx(4 * 2 * 9.81 / 2, rel=1e-9) and speed == pytest.approx(10 - slower * time, abs=1e-4)


def test_a_mesh_that_is_missing(tmp_path):
    """With a ground a warning says that the mesh has no contact; without one, a single line lists all ignored elements."""
    mesh = re.sub("<geometry>.*</geometry>", '<geometry><mesh filename="roller.stl"/></geometry>', ROUND.format(INERTIA.format(0.1)))
    (tmp_path / "roller.urdf").write_text(mesh)
    (tmp_path / "system.xml").write_text(ROLLER)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0 and "a <collision> of the link 'roller' touches nothing: the mesh 'roller.stl' does not exist; expected a path" in result.stderr
    (tmp_path / "system.xml").write_text(ROLLER.replace(' ground="true"', ""))
    reported = lagc("system.xml", "-o", "out", cwd=tmp_path).stderr
    assert "left out, since the motion does not depend on them: collision" in reported and "1 mesh is not drawn; the first: the mesh 'roller.stl'" in reported


def test_a_shape_without_size(tmp_path):
    """It cannot have contacts, which is an error with a ground; without one it is ignored."""
    (tmp_path / "roller.urdf").write_text(re.sub("<geometry>.*</geometry>", '<geometry><sphere radius="0"/></geometry>', ROUND.format(INERTIA.format(0.1))))
    (tmp_path / "system.xml").write_text(ROLLER)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and 'radius="0" of <sphere> is not valid; expected a number above 0' in result.stderr
    (tmp_path / "system.xml").write_text(ROLLER.replace(' ground="true"', ""))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0 and "left out, since the motion does not depend on them: collision" in result.stderr
