"""Robots from URDF files, against accelerations from energies in high precision, closed forms, and formulas by hand."""

import subprocess

import mpmath as mp
import numpy as np
import pytest

import fmu
from building import bring_up_to_date
from fmu import ROOT, build_systems
from robots_by_energies import Robot

TENSOR = '<inertia ixx="0.021" ixy="0.002" ixz="-0.003" iyy="0.026" iyz="0.004" izz="0.013"/>'
BALL = '<inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.004"/>'

# Each joint type except floating, rotated origins, oblique axes, a link fixed to a moving one, and mimicking joints: a revolute one by a
# prismatic one, and one through another.
ARM = f"""<robot name="RobotHand">
  <link name="world"/>
  <link name="stand"><inertial><mass value="7"/>{TENSOR}</inertial></link>
  <joint name="on floor" type="fixed"><origin xyz="0.1 0.2 0.3" rpy="0.1 0 1.57079632679"/><parent link="world"/><child link="stand"/></joint>
  <link name="upper"><inertial><origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/><mass value="1.5"/>{TENSOR}</inertial></link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0.1 0.2" rpy="0.3 0.2 -0.7"/><parent link="stand"/><child link="upper"/><axis xyz="1 2 -2"/>
    <limit lower="-1.2" upper="0.8" effort="10" velocity="1"/>
  </joint>
  <link name="camera"><inertial><origin xyz="0 0 0.05"/><mass value="0.4"/>{BALL}</inertial></link>
  <joint name="mount" type="fixed"><origin xyz="0.2 0 0" rpy="0 1.5707963 0.2"/><parent link="upper"/><child link="camera"/></joint>
  <link name="rail"><inertial><origin rpy="1 0 0"/><mass value="0.8"/>{TENSOR}</inertial></link>
  <joint name="slide-1" type="prismatic">
    <origin xyz="0.3 0.1 0" rpy="-1.57079632679 0 0.1"/><parent link="camera"/><child link="rail"/><axis xyz="0 0.6 0.8"/>
    <limit effort="10" velocity="1"/>
  </joint>
  <link name="wheel"><inertial><origin xyz="0.02 0 0.01"/><mass value="0.6"/>{TENSOR}</inertial></link>
  <joint name="wheel" type="continuous"><parent link="rail"/><child link="wheel"/><axis xyz="0 0 -1"/></joint>
  <link name="finger"><inertial><origin xyz="0 0.1 0"/><mass value="0.3"/>{BALL}</inertial></link>
  <joint name="grip" type="prismatic"><origin xyz="0 0 0.1"/><parent link="rail"/><child link="finger"/><mimic joint="wheel" multiplier="0.5" offset="-0.1"/></joint>
  <link name="thumb"><inertial><origin xyz="0.1 0 0"/><mass value="0.2"/>{BALL}</inertial></link>
  <joint name="close" type="revolute"><parent link="finger"/><child link="thumb"/><axis xyz="0 1 0"/><mimic joint="grip" multiplier="3"/></joint>
</robot>
"""
# Lying on its side, so that its plane is not that of x and y.
CART = f"""<robot name="RobotCart">
  <link name="base"/>
  <link name="cart"><inertial><origin xyz="0.1 0 0.2"/><mass value="4"/>{TENSOR}</inertial></link>
  <joint name="roll" type="planar"><origin xyz="0 0 1" rpy="0.2 0 0"/><parent link="base"/><child link="cart"/><axis xyz="0 -0.8 0.6"/></joint>
  <link name="pole"><inertial><origin xyz="0 0 0.5"/><mass value="1"/>{BALL}</inertial></link>
  <joint name="hinge" type="revolute"><origin xyz="0 0 0.2"/><parent link="cart"/><child link="pole"/><axis xyz="1 0 0"/><limit lower="-1"/></joint>
</robot>
"""
# A block on a slope with sine 0.6 and cosine 0.8, and a disk, both with damping and friction. The mimicking joint adds to those of the disk.
LOSSES = f"""<robot name="RobotLosses">
  <link name="floor"/>
  <link name="block"><inertial><mass value="2"/>{BALL}</inertial></link>
  <joint name="x" type="prismatic"><parent link="floor"/><child link="block"/><axis xyz="0.8 0 0.6"/><dynamics damping="3" friction="0.5"/></joint>
  <link name="disk"><inertial><mass value="1"/>{BALL}</inertial></link>
  <joint name="phi" type="continuous"><parent link="floor"/><child link="disk"/><axis xyz="0 0 1"/><dynamics damping="0.01"/></joint>
  <link name="follower"><inertial><mass value="1"/>{BALL}</inertial></link>
  <joint name="psi" type="continuous">
    <parent link="floor"/><child link="follower"/><axis xyz="0 0 1"/><mimic joint="phi" multiplier="-2"/><dynamics damping="0.02" friction="0.03"/>
  </joint>
</robot>
"""
# A box with a balanced wheel in its centre of mass, on a fixed base; and the same with a floating base.
ROTOR = f"""<robot name="RobotRotor">
  <link name="box">
    <inertial><origin xyz="0 0 0.5"/><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.15"/></inertial>
  </link>
  <link name="wheel"><inertial><mass value="1"/>{BALL}</inertial></link>
  <joint name="spin" type="continuous"><origin xyz="0 0 0.5"/><parent link="box"/><child link="wheel"/><axis xyz="0 1 0"/></joint>
</robot>
"""
FLYING = ROTOR.replace("RobotRotor", "RobotFlying").replace("</robot>", """  <link name="sky"/>
  <joint name="flight" type="floating"><parent link="sky"/><child link="box"/></joint>
</robot>""")
FREE = '<system name="RobotFree"><include file="../RobotRotor/system.xml" as="rotor" base="floating" tool="box"/></system>'
# A rod of mass m and length l at a hinge, free in the air at the end of another.
ROD = """<robot name="RobotRod">
  <link name="wall"><inertial><mass value="50"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="rod">
    <inertial><origin xyz="0 0 -0.5"/><mass value="3"/><inertia ixx="0.25" ixy="0" ixz="0" iyy="0.25" iyz="0" izz="0"/></inertial>
  </link>
  <link name="end"/>
  <joint name="tip" type="fixed"><origin xyz="0 0 -1"/><parent link="rod"/><child link="end"/></joint>
  <joint name="hinge" type="continuous"><parent link="wall"/><child link="rod"/><axis xyz="0 -1 0"/></joint>
</robot>
"""
PAIR = """<system name="RobotPair" description="two of them, which a spring between their ends couples">
  <parameter name="k" start="40" unit="N/m"/>
  <include file="../RobotRod/system.xml" as="left" tool="end"/>
  <include file="../RobotRod/system.xml" as="right" base="fixed"><coordinate name="hinge" start="0.3"/></include>
  <define name="stretch" unit="m">right.tool.x - left.tool.x</define>
  <force on="left.end" x="k*stretch"/>
  <force on="right.tool" x="-k*stretch"/>
</system>
"""
# Two disks about vertical axes, one of which mimics the other at half its angle, and a block on a rail that starts at 0.2.
REAL = f"""<robot name="RobotReal">
  <link name="floor"/>
  <link name="disk"><inertial><mass value="1"/>{BALL}</inertial></link>
  <joint name="phi" type="revolute">
    <parent link="floor"/><child link="disk"/><axis xyz="0 0 1"/><limit lower="-1" upper="1.5" effort="0.02" velocity="9"/><dynamics friction="0.008"/>
  </joint>
  <link name="wheel"><inertial><mass value="1"/>{BALL}</inertial></link>
  <joint name="psi" type="continuous"><parent link="floor"/><child link="wheel"/><axis xyz="0 0 1"/></joint>
  <link name="half"><inertial><mass value="1"/>{BALL}</inertial></link>
  <joint name="chi" type="revolute">
    <parent link="floor"/><child link="half"/><axis xyz="0 0 1"/><mimic joint="psi" multiplier="0.5" offset="0.1"/><limit lower="-0.4" upper="0.2"/>
    <dynamics friction="0.003"/>
  </joint>
  <link name="block"><inertial><mass value="2"/>{BALL}</inertial></link>
  <joint name="x" type="prismatic"><parent link="floor"/><child link="block"/><axis xyz="1 0 0"/><limit lower="0.2" upper="2" effort="5" velocity="1"/></joint>
</robot>
"""
REAL_ROBOT = '<system name="RobotStops"><include file="../RobotReal/system.xml" as="r" limits="stops" friction="sticks" effort="limited"/></system>'
SYSTEMS = {"RobotReal": REAL, "RobotStops": REAL_ROBOT, "RobotHand": ARM, "RobotCart": CART, "RobotLosses": LOSSES, "RobotRotor": ROTOR, "RobotFlying": FLYING,
           "RobotFree": FREE, "RobotRod": ROD, "RobotPair": PAIR}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def robots():
    build_systems("robots", SYSTEMS)


def random_state(random, coordinates, inputs):
    names = [*coordinates, *[f"{c}_velocity" for c in coordinates], *inputs]
    return dict(zip(names, random.uniform(-1.5, 1.5, len(names))))


MOTORS = {
    "RobotHand": (["shoulder", "slide_1", "wheel"], ["shoulder_torque", "slide_1_force", "wheel_torque"]),
    "RobotCart": (["roll_x", "roll_y", "roll_angle", "hinge"],
                  ["roll_x_force", "roll_y_force", "roll_angle_torque", "hinge_torque"]),
}  # fmt: skip


@pytest.mark.parametrize("name", MOTORS)
def test_accelerations(name, open_fmu):
    coordinates, inputs = MOTORS[name]
    robot, instance, random = Robot(SYSTEMS[name]), open_fmu(name), np.random.default_rng(1)
    assert fmu.names_of(name, "input") == inputs
    assert fmu.states_of(name) == [*coordinates, *[f"{c}_velocity" for c in coordinates]]
    for _ in range(3):
        values = random_state(random, coordinates, inputs)
        instance.reset().initialize(values)
        with mp.workdps(45):
            state = list(values.values())
            n = len(coordinates)
            expected = robot.accelerations(state[:n], state[n : 2 * n], state[2 * n :])
        ours = instance.get(*[f"der({c}_velocity)" for c in coordinates])
        # Angles of 1.57079632679 are read as pi/2, which differs by 5e-12.
        np.testing.assert_allclose(ours, expected, rtol=1e-9)


def test_places(open_fmu):
    """Origins and axes of all frames agree, including those of fixed links and mimicking joints."""
    robot, instance = Robot(ARM), open_fmu("RobotHand")
    coordinates, inputs = MOTORS["RobotHand"]
    values = random_state(np.random.default_rng(2), coordinates, inputs)
    instance.initialize(values)
    for link, (position, rotation) in robot.poses([mp.mpf(values[c]) for c in coordinates]).items():
        names = [f"{link}.{axis}" for axis in "xyz"] + [f"{link}.R{i}{j}" for i in "123" for j in "123"]
        np.testing.assert_allclose(instance.get(*names), [float(x) for x in [*position, *rotation]], atol=1e-10)
    assert instance.get("grip") == pytest.approx(0.5 * values["wheel"] - 0.1, rel=1e-15)
    assert instance.get("close") == pytest.approx(3 * instance.get("grip"), rel=1e-15)


def test_limits(open_fmu):
    instance = open_fmu("RobotHand")
    for angle, beyond in [(-1.5, -0.3), (-1.2, 0), (0.3, 0), (0.8, 0), (1, 0.2)]:
        instance.reset().initialize({"shoulder": angle})
        assert instance.get("shoulder_beyond") == pytest.approx(beyond, abs=1e-15)
    outputs = fmu.names_of("RobotHand", "output")
    assert [name for name in outputs if name.endswith("_beyond")] == ["shoulder_beyond"]
    # A missing limit is 0.
    other = open_fmu("RobotCart").initialize({"hinge": 0.25})
    assert other.get("hinge_beyond") == 0.25


def test_losses(open_fmu):
    instance = open_fmu("RobotLosses")
    for velocity, rate in [(0.0, 0.0), (0.7, -0.4), (-0.0005, 0.003)]:
        instance.reset().initialize({"x_velocity": velocity, "phi_velocity": rate, "x_force": 20, "phi_torque": 0.1})
        friction = 0.5 * np.tanh(velocity / 0.001)
        assert instance.get("der(x_velocity)") == pytest.approx((20 - 2 * 9.81 * 0.6 - 3 * velocity - friction) / 2, rel=1e-13)
        torque = 0.1 - 0.01 * rate - 4 * 0.02 * rate + 2 * 0.03 * np.tanh(-2 * rate / 0.01)
        assert instance.get("der(phi_velocity)") == pytest.approx(torque / (0.004 + 4 * 0.004), rel=1e-13)
    instance.reset().initialize({"x_damping": 0, "x_friction": 0, "g": 0, "x_force": 3, "x_velocity": 1})
    assert instance.get("der(x_velocity)") == 1.5


def test_stops_stiction_and_effort(open_fmu):
    """Motors are limited by their effort, friction sticks below its limit, and stops act, also through mimicking joints by the ratio."""
    instance = open_fmu("RobotStops")
    modes = [f"r.{name}" for name in ("phi_bearing.sliding", "chi_bearing.sliding", "x.min.closed", "phi.max.closed", "chi_max.closed")]
    instance.initialize({"r.phi_torque": 1.0, "r.psi_torque": 0.0014, "r.x_force": -1e9})
    assert instance.get("r.x") == 0.2
    until = 0.5
    instance.step(until)
    # Effort 0.02 minus friction 0.008, on J = 0.004; the mimicking disk's friction of 0.003 acts by half.
    assert instance.get("r.phi", "r.phi_velocity") == pytest.approx([3 * until**2 / 2, 3 * until], rel=1e-12)
    assert instance.get("r.psi", "r.psi_velocity", "r.x", "r.x.min.force", "r.phi_bearing.force") == pytest.approx([0, 0, 0.2, 5, 0.008], abs=1e-14)
    assert instance.fmu.getInteger(instance.vr(*modes)) == [1, 0, 1, 0, 0]
    instance.set({"r.psi_torque": 0.0015 + 0.0005})
    instance.step(1.0)
    # Inertia of the disk and a quarter of that of the mimicking one.
    rate = 0.0005 / 0.005
    assert instance.get("r.psi") == pytest.approx(rate * 1.0 / 2, rel=1e-12)
    instance.step(4.0)
    assert instance.get("r.phi", "r.phi_velocity", "r.psi", "r.psi_velocity", "r.chi") == pytest.approx([1.5, 0, 0.2, 0, 0.2], abs=1e-12)
    assert instance.fmu.getInteger(instance.vr(*modes))[2:] == [1, 1, 1]
    instance.set({"r.phi_torque": -0.01})
    instance.step(1.0)
    assert instance.get("r.phi") == pytest.approx(1.5 - 0.5 / 2, rel=1e-12)
    assert "r.phi_beyond" not in fmu.names_of("RobotStops", "output")


@pytest.mark.parametrize("name, base, spin", [("RobotFlying", "flight", "spin"), ("RobotFree", "rotor.base", "rotor.spin")])
def test_free_motion(name, base, spin, open_fmu):
    """The body rotates about the axis of largest moment of inertia, while its centre of mass, 0.5 above the link's origin, falls."""
    instance, rate, t = open_fmu(name), 0.8, 1.5
    moving = {f"{base}_qy_velocity": rate / 2, f"{base}_x_velocity": -0.5 * rate, f"{base}_z_velocity": 2.0}
    instance.initialize(moving)
    instance.step(t)
    angle = rate * t
    expected = {
        "x": -0.5 * np.sin(angle), "y": 0, "z": 0.5 + 2.0 * t - 9.81 * t * t / 2 - 0.5 * np.cos(angle),
        "qw": np.cos(angle / 2), "qx": 0, "qy": np.sin(angle / 2), "qz": 0,
    }  # fmt: skip
    for component, value in expected.items():
        assert instance.get(f"{base}_{component}") == pytest.approx(value, abs=1e-7), component
    assert abs(instance.get(f"{spin}_velocity")) < 1e-7


def test_pair(open_fmu):
    """Each falls with one gravity; the spring acts on the ends."""
    instance = open_fmu("RobotPair")
    left, right = -0.4, 0.7
    instance.initialize({"left.hinge": left, "right.hinge": right})
    stretch = np.sin(right) - np.sin(left)
    for side, angle, sign in [("left", left, 1), ("right", right, -1)]:
        torque = -3 * 9.81 * 0.5 * np.sin(angle) + sign * 40 * stretch * np.cos(angle)
        assert instance.get(f"der({side}.hinge_velocity)") == pytest.approx(torque / 1.0, rel=1e-12)
    assert instance.get("left.tool_x", "left.tool_z") == pytest.approx([np.sin(left), -np.cos(left)])
    assert "right.tool_vz" in fmu.names_of("RobotPair", "output")


def test_energy_is_kept(open_fmu):
    instance = open_fmu("RobotHand").initialize({"shoulder": 0.5, "wheel_velocity": 2})
    before = instance.get("totalEnergy")
    instance.step(3)
    assert instance.get("totalEnergy") == pytest.approx(before, rel=1e-7)


def test_names_of_joints_and_links_are_apart():
    """A joint may have the name of a link, and either may have the name of a variable that each robot has."""
    names = {v.name for v in fmu.description("RobotCart").modelVariables}
    assert {"base_.x", "cart.x"} <= names
    assert {"wheel", "wheel.x"} <= {v.name for v in fmu.description("RobotHand").modelVariables}


def test_joint_that_is_called_like_a_word_of_the_language(tmp_path):
    for word in ("sin", "time"):
        (tmp_path / "rod.urdf").write_text(ROD.replace('"hinge"', f'"{word}"'))
        result = fmu.lagc("rod.urdf", "-o", word, cwd=tmp_path)
        assert result.returncode == 0, result.stderr
        assert f'name="{word}_"' in (tmp_path / word / "modelDescription.xml").read_text()


def test_a_file_of_any_name_makes_an_fmu(tmp_path):
    """The FMU is named after the robot, converted to a C identifier."""
    bring_up_to_date(ROOT / "build")
    (tmp_path / "arm.urdf").write_text('<?xml version="1.0"?>\n' + ROD.replace("RobotRod", "2nd arm-6.x"))
    (tmp_path / "scene.xml").write_text('<!-- By include. -->\n<mujoco>\n<include file="arm.xml"/></mujoco>')
    (tmp_path / "arm.xml").write_text('<mujoco model="arm"><worldbody><body name="upper"><joint/><geom size="0.1" pos="0 0 -1"/></body></worldbody></mujoco>')
    words = [f"-DSYSTEMS={tmp_path / 'arm.urdf'};{tmp_path / 'arm.xml'};{tmp_path / 'scene.xml'}", f"-DTOOLS={ROOT / 'build'}"]
    subprocess.run([ROOT / "scripts" / "build", tmp_path / "build", *words], check=True)
    assert sorted(path.name for path in (tmp_path / "build" / "fmu").iterdir()) == ["_2nd_arm_6_x.fmu", "arm.fmu", "robot.fmu"]
