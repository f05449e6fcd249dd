"""
Actuators of MJCF with states, friction of free joints, and couplings of joints, against closed forms; test_robots_in_mujoco.py compares
others with MuJoCo.
"""

import math

import pytest

from fmu import build_systems

BOX = '<inertial pos="0 0 0" mass="2" diaginertia="2 2 2"/>'
SLIDERS = "".join(f'<body name="{name}"><joint name="{name}" type="slide" axis="1 0 0"/>{BOX}</body>' for name in ("p", "q", "r", "s", "u"))
FILE = f"""<mujoco model="m"><option gravity="0 0 0"/><default><joint frictionloss="4"/><default class="smooth"><joint frictionloss="0"/></default></default>
<worldbody><frame childclass="smooth">{SLIDERS}</frame><body name="free"><joint name="free" type="free"/>{BOX}</body></worldbody>
<actuator>
  <general name="lag" joint="p" dyntype="filterexact" dynprm="0.5"/>
  <general name="sum" joint="q" dyntype="integrator" actrange="-1 1"/>
  <motor name="push" joint="u"/>
</actuator>
<equality><joint joint1="r" joint2="s" polycoef="0.1 0 0.3"/><joint name="stays" joint1="u" polycoef="0.2"/></equality>
<keyframe><key name="full" act="0.5 -0.5" ctrl="3 4 1"/></keyframe></mujoco>"""
# A body of 2 kg is welded to one that inputs move.
LED = f"""<mujoco model="m"><worldbody><body name="goal" mocap="true" pos="0.3 0 0" euler="0 0 90"><geom size="1"/></body><body name="b">{BOX}</body></worldbody>
<equality><weld name="tie" body1="goal" body2="b"/></equality></mujoco>"""
# A slide of 2 kg carries another of 2 kg, and a mass of 2 kg hangs on a spatial tendon.
CARRIED = f"""<mujoco model="m"><option gravity="0 0 0"/><default><default class="firm"><position kv="3"/><default class="z"><position dampratio="0.5"/></default></default></default>
<worldbody><site name="post" pos="0 3 4"/>
<body name="base"><joint name="base" type="slide" axis="1 0 0" armature="0.5"/>{BOX}<body name="top"><joint name="top" type="slide" axis="1 0 0"/>{BOX}</body></body>
<body name="hung"><joint name="hung" type="slide" axis="0 0 1"/>{BOX}<site name="ring"/></body></worldbody>
<tendon><fixed name="both"><joint joint="base" coef="3"/><joint joint="top" coef="1"/></fixed><spatial name="rope"><site site="post"/><site site="ring"/></spatial></tendon>
<actuator>
  <position name="one" joint="top" kp="8" dampratio="0.7" gear="-2"/>
  <position name="inner" class="z" joint="top" kp="8"/>
  <position name="own" class="z" joint="top" kp="8" kv="0.1"/>
  <intvelocity name="sum" tendon="both" kp="8" dampratio="1" actrange="-1 1"/>
  <general name="pull" tendon="rope" gainprm="8" biastype="affine" biasprm="0 -8 1.5" gear="0.5"/>
</actuator></mujoco>"""
# Servos on slides of 2 kg, with ranges of the control from the element, or from the range of the joint.
RANGED = f"""<mujoco model="m"><option gravity="0 0 0"/><default><joint type="slide" axis="1 0 0" range="-0.5 0.7"/><general ctrlrange="-1 1"/>
<default class="inherits"><position inheritrange="1"/><default class="own"><position ctrlrange="-2 2"/></default></default></default>
<worldbody>{"".join(f'<body name="{name}"><joint name="{name}"/>{BOX}</body>' for name in "abcde")}</worldbody><actuator>
  <position joint="a" inheritrange="0.5"/><position joint="b" class="inherits"/><position joint="c" class="own"/><position joint="d" inheritrange="0" ctrlrange="-1 1"/>
  <position joint="e" kp="3"/><motor joint="e" gear="2"/><motor name="e_4" joint="e" gear="5"/><velocity joint="e" kv="0.5"/>
</actuator></mujoco>"""
# A ball joint that may turn by 60 degrees, between a post and a body with equal moments of inertia; and one with its weight.
CONE = """<mujoco model="m"><option gravity="{gravity}"/><worldbody><body name="b"><joint name="j" type="ball" range="0 60" damping="{damping}"/>
<inertial pos="0 0 {arm}" mass="2" diaginertia="0.5 0.5 0.5"/></body></worldbody><keyframe><key name="k" qvel="0.6 -0.8 2"/><key name="far" qpos="-0.6 0 -0.8 0" qvel="0 0 1"/></keyframe></mujoco>"""
# A slide of 2 kg with forces of each kind, and one that follows it. Each feature that <flag> may disable, and the acceleration of the first without it.
FLAGGED = f"""<mujoco model="m"><option gravity="3 0 0"><flag {{flag}}="disable"/></option><worldbody>
<body name="a" gravcomp="0.5"><joint name="a" type="slide" axis="1 0 0" stiffness="4" springref="0.25" damping="2" frictionloss="0.6" range="-1 0.4"/>{BOX}</body>
<body name="b" gravcomp="1"><joint name="b" type="slide" axis="1 0 0"/>{BOX}</body></worldbody>
<actuator><motor name="u" joint="a" ctrlrange="-5 5"/></actuator><equality><joint joint1="b" joint2="a" polycoef="0 1 0 0 0" active="true"/></equality>
<keyframe><key name="k" qvel="0.5 0.5" ctrl="9"/></keyframe></mujoco>"""
# A slide of 2 kg with adhesions, which press it to nothing.
STUCK = f"""<mujoco model="m"><option gravity="0 0 0"/><worldbody><body name="a"><joint name="a" type="slide" axis="1 0 0"/>{BOX}</body></worldbody>
<actuator><adhesion name="hold" body="a" ctrlrange="0 1" gain="5"/><motor name="push" joint="a"/><general body="a" ctrlrange="0 2" gainprm="3"/></actuator>
<keyframe><key name="k" ctrl="0.5 6 2"/></keyframe></mujoco>"""
FORCES = {"gravity": 3.0, "spring": 1.0, "damper": -1.0, "frictionloss": -0.6, "actuation": 5.0}
TOTAL = sum(FORCES.values())
FLAGS = {name: (TOTAL - force) / 4 for name, force in FORCES.items()} | {
    "passive": (6 - 0.6 + 5 + 6) / 4,
    "clampctrl": (TOTAL + 4) / 4,
    "equality": TOTAL / 2,
    "constraint": (TOTAL + 0.6) / 2,
    "limit": TOTAL / 4,
    "energy": TOTAL / 4,
}
# Hinges with one torque: of a body lighter than the least mass, of one with a small moment, and of one with impossible moments.
LEAST = """<mujoco model="m"><compiler boundmass="3" boundinertia="0.5" balanceinertia="true"/><option gravity="0 0 0"/><default><joint axis="0 0 1"/></default><worldbody>
<body name="light"><joint name="light"/><inertial pos="2 0 0" mass="1" diaginertia="2 2 2"/></body>
<body name="thin"><joint name="thin"/><inertial pos="0 0 0" mass="4" diaginertia="0.6 0.6 0.1"/></body>
<body name="odd"><joint name="odd"/><inertial pos="0 0 0" mass="4" diaginertia="1 1 7"/></body></worldbody>
<actuator><motor joint="light"/><motor joint="thin"/><motor joint="odd"/></actuator></mujoco>"""
SYSTEMS = {"Driven": "", "Rests": 'friction="sticks"', "Key": 'keyframe="full"'}


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: f'<system name="{name}"><include file="m.xml" as="m" {word}/></system>' for name, word in SYSTEMS.items()}
    texts["Carried"] = '<system name="Carried"><include file="m.xml" as="m"/></system>'
    texts["Ranged"] = '<system name="Ranged"><include file="m.xml" as="m" limits="outputs"/></system>'
    cones = {"Turned": 'limits="stops" keyframe="k"', "Tilted": 'limits="stops"', "Beyond": 'limits="outputs" keyframe="far"', "Limited": 'limits="stops" keyframe="far"'}
    texts |= {name: f'<system name="{name}"><include file="m.xml" as="m" {words}/></system>' for name, words in cones.items()}
    texts |= {f"Without{flag.title()}": f'<system name="Without{flag.title()}"><include file="m.xml" as="m" friction="sticks" limits="stops" keyframe="k"/></system>' for flag in FLAGS}
    texts["Least"] = '<system name="Least"><include file="m.xml" as="m"/></system>'
    texts["Stuck"] = '<system name="Stuck"><include file="m.xml" as="m" keyframe="k"/></system>'
    texts["Led"] = '<system name="Led"><include file="led.xml" as="m" mocap="inputs" base="floating"/></system>'
    build_systems("actuators", texts, files={f"{name}/m.xml": FILE for name in SYSTEMS} | {"Led/led.xml": LED, "Carried/m.xml": CARRIED, "Least/m.xml": LEAST, "Stuck/m.xml": STUCK} | {f"Without{flag.title()}/m.xml": FLAGGED.format(flag=flag) for flag in FLAGS} | { "Ranged/m.xml": RANGED, "Turned/m.xml": CONE.format(gravity="0 0 0", damping=0, arm=0), "Tilted/m.xml": CONE.format(gravity="9.81 0 0", damping=3, arm=-0.5), "Beyond/m.xml": CONE.format(gravity="0 0 0", damping=0, arm=0), "Limited/m.xml": CONE.format(gravity="0 0 0", damping=0, arm=0)})


def test_a_filter(open_fmu):
    instance = open_fmu("Driven").initialize({"m.lag_control": 3.0}, tolerance=1e-10)
    instance.run(1.0, 0.1)
    assert instance.get("m.lag_control_activation") == pytest.approx(3 * (1 - math.exp(-2)), rel=1e-8)
    assert instance.get("m.p_velocity") == pytest.approx(3 / 2 * (1 - 0.5 * (1 - math.exp(-2))), rel=1e-8)


def test_an_integrator_stays_at_its_limit_and_leaves_it(open_fmu):
    """The activation reaches 1 after 0.25 s; the control changes its sign after 1 s."""
    instance = open_fmu("Driven").initialize({"m.sum_control": 4.0}, tolerance=1e-10)
    instance.run(1.0, 0.1)
    assert instance.get("m.sum_control_activation", "m.q_velocity") == pytest.approx([1, (0.125 + 0.75) / 2], rel=1e-8)
    instance.set({"m.sum_control": -4.0})
    instance.run(1.2, 0.1)
    assert instance.get("m.sum_control_activation", "m.q_velocity") == pytest.approx([0.2, (0.125 + 0.75 + 0.12) / 2], rel=1e-8)


def test_activations_of_a_key(open_fmu):
    instance = open_fmu("Key").initialize({})
    names = ("lag_control_activation", "sum_control_activation", "lag_control", "sum_control")
    assert instance.get(*(f"m.{name}" for name in names)) == [0.5, -0.5, 3, 4]


def test_adhesion_where_nothing_touches(open_fmu):
    """Its inputs remain, as the keyframe lists them, and only the motor's 6 N act."""
    instance = open_fmu("Stuck").initialize({})
    assert instance.get("m.hold_control", "m.push_control", "m.a_control", "der(m.a_velocity)") == [0.5, 6, 2, 3]


def test_friction_of_a_free_joint(open_fmu):
    """It acts along each fixed axis and about each axis of the body: 4 N on 2 kg, and 4 N.m on 2 kg.m2."""
    instance = open_fmu("Driven").initialize({"m.free_x_velocity": 0.001, "m.free_qz_velocity": 0.005})
    drag = 4 * math.tanh(1)
    assert instance.get("der(m.free_x_velocity)", "m.free_body.alphaZ") == pytest.approx([-drag / 2, -drag / 2], rel=1e-10)
    instance = open_fmu("Rests").initialize({"m.free_y_velocity": 1.0, "m.free_qx_velocity": 0.25}, tolerance=1e-9)
    instance.run(1.0, 0.1)
    assert instance.get("m.free_y") == pytest.approx(0.25, rel=1e-7)
    assert 2 * math.atan2(instance.get("m.free_qx"), instance.get("m.free_qw")) == pytest.approx(0.0625, rel=1e-6)


def test_a_quadratic_coupling_of_joints(open_fmu):
    """The energy 2/2 (1 + (0.6 s)^2) s'^2 stays."""
    instance = open_fmu("Driven").initialize({"m.s": 0.5, "m.s_velocity": 2.0, "m.r": 0.1 + 0.3 * 0.25, "m.r_velocity": 0.6}, tolerance=1e-11)
    instance.run(1.0, 0.1)
    r, s, rate = instance.get("m.r", "m.s", "m.s_velocity")
    assert r == pytest.approx(0.1 + 0.3 * s * s, abs=1e-12)
    assert (1 + (0.6 * s) ** 2) * rate**2 == pytest.approx((1 + 0.3**2) * 4, rel=1e-9)


def test_a_joint_that_stays(open_fmu):
    """The force is positive where it keeps the position from growing."""
    instance = open_fmu("Driven").initialize({"m.push_control": 7.0})
    instance.run(0.2, 0.1)
    assert instance.get("m.u", "m.stays.force") == pytest.approx([0.2, 7.0], abs=1e-10)


def test_inputs_move_a_mocap_body(open_fmu):
    """The welded body follows the inputs: 0.3 m behind the goal, around which it rotates. The force on the goal is -m (a + g)."""
    instance = open_fmu("Led").initialize({"m.goal_x": 0.3, "m.goal_yaw": math.pi / 2, "der(m.goal_x)": 0.5, "der(der(m.goal_x))": 2.0, "der(m.goal_yaw)": 0.4, "der(der(m.goal_yaw))": 3.0})
    assert instance.get("m.b_x", "m.b_y", "m.b_z") == pytest.approx([0, 0, 0], abs=1e-12)
    assert instance.get("m.b_x_velocity", "m.b_y_velocity", "m.b_qz_velocity") == pytest.approx([0.5, -0.3 * 0.4, 0.2], abs=1e-10)
    acceleration = [2.0 + 0.3 * 0.4**2, -0.3 * 3.0]
    assert instance.get("der(m.b_x_velocity)", "der(m.b_y_velocity)") == pytest.approx(acceleration, abs=1e-9)
    force = instance.get("m.tie_loop.forceX", "m.tie_loop.forceY", "m.tie_loop.forceZ")
    assert math.hypot(*force) == pytest.approx(2 * math.hypot(*acceleration, 9.81), rel=1e-9)


def test_damping_ratios(open_fmu):
    """
    The damping is 2 z sqrt(k J) with 1/J = m^T M^-1 m. M = [[4.5, 2], [2, 2]] of base and top has the inverse [[2, -2], [-2, 4.5]]/5. So 1/J is
    4.5/5 for top times the gear squared, and (18 - 12 + 4.5)/5 for 3 base + top. The rope's length changes by 4/5 of the slide of 2 kg.
    """
    instance = open_fmu("Carried").initialize({})
    inverses = {"one": (0.7, 4 * 0.9), "inner": (0.5, 0.9), "sum": (1, 2.1), "pull": (1.5, 0.5**2 * 0.8**2 / 2)}
    expected = {name: 2 * ratio * math.sqrt(8 / inverse) for name, (ratio, inverse) in inverses.items()} | {"own": 0.1}
    assert instance.get(*(f"m.{name}_control_damping" for name in expected)) == pytest.approx(list(expected.values()), rel=1e-14)


def test_ranges_of_controls(open_fmu):
    """The innermost of inheritrange and ctrlrange holds, as in MuJoCo 4, which was asked for these ranges; m w' = kp u at rest."""
    controls = {f"m.{name}_control": 9.0 for name in "abcd"}
    instance = open_fmu("Ranged").initialize(controls, tolerance=1e-10)
    instance.run(1e-3, 1e-3)
    upper = {"a": 0.1 + 0.3, "b": 0.7, "c": 2.0, "d": 1.0}
    assert [instance.get(f"m.{name}") for name in upper] == pytest.approx([limit / 2 * 0.5e-6 for limit in upper.values()], rel=1e-5)


def test_actuators_without_names_at_one_joint(open_fmu):
    """Further ones have a number behind the name of the joint. 2 kg w' = 3 u1 + 2 u2 + 5 u3 + 0.5 u4 at rest."""
    controls = {"m.e_control": 0.1, "m.e_2_control": 0.2, "m.e_4_control": 0.4, "m.e_3_control": 0.8}
    instance = open_fmu("Ranged").initialize(controls, tolerance=1e-10)
    instance.run(1e-3, 1e-3)
    assert instance.get("m.e") == pytest.approx((0.3 + 0.4 + 2 + 0.4) / 2 * 0.5e-6, rel=1e-3)


def rotation(instance):
    """The angle of the ball joint from its quaternion, in degrees."""
    w, *axis = instance.get("m.j_qw", "m.j_qx", "m.j_qy", "m.j_qz")
    return math.degrees(2 * math.atan2(math.hypot(*axis), abs(w)))


def test_the_range_of_a_ball_joint(open_fmu):
    """About a fixed axis the angle grows by its velocity to the limit, and stays there."""
    instance = open_fmu("Turned").initialize(tolerance=1e-10)
    hit = math.radians(60) / math.sqrt(0.6**2 + 0.8**2 + 2**2)
    instance.run(0.9 * hit, 0.1 * hit)
    assert rotation(instance) == pytest.approx(0.9 * 60, abs=1e-7)
    instance = open_fmu("Turned").initialize(tolerance=1e-10)
    instance.run(2.0, 0.1)
    assert rotation(instance) == pytest.approx(60, abs=1e-7)


def test_a_ball_joint_rests_at_its_range(open_fmu):
    """A weight along x turns the body about y to 60 degrees. The torque m g l cos(60) is the force of the gap times its slope by the angle, sin(60)/2."""
    instance = open_fmu("Tilted").initialize(tolerance=1e-9)
    instance.run(30.0, 1.0)
    assert instance.get("m.j_qw", "m.j_qx", "m.j_qy", "m.j_qz") == pytest.approx([math.cos(math.pi / 6), 0, -0.5, 0], abs=1e-7)
    assert instance.get("m.j_max.force") == pytest.approx(2 * 9.81 * 0.5 * 0.5 / (math.sin(math.pi / 3) / 2), rel=1e-6)


def test_a_ball_joint_that_starts_beyond_its_range(open_fmu):
    """It is rotated back about the same axis, y, with its angular velocity along the axes of the body."""
    instance = open_fmu("Limited").initialize()
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    assert instance.get("m.j_qw", "m.j_qx", "m.j_qy", "m.j_qz") == pytest.approx([-c, 0, -s, 0], abs=1e-12)
    assert instance.get("m.b_body.omegaX", "m.b_body.omegaY", "m.b_body.omegaZ") == pytest.approx([0, 0, 1], abs=1e-12)


def test_excess_of_the_range_of_a_ball_joint(open_fmu):
    instance = open_fmu("Beyond").initialize()
    assert instance.get("m.j_beyond") == pytest.approx(2 * math.acos(0.6) - math.pi / 3, abs=1e-12)


@pytest.mark.parametrize("flag", FLAGS)
def test_features_that_a_flag_disables(flag, open_fmu):
    """Both slides of 2 kg together, or the first alone without the equality, accelerate by the forces that remain. Half of one weight, and all of the other, are balanced."""
    instance = open_fmu(f"Without{flag.title()}").initialize(tolerance=1e-10)
    instance.run(1e-3, 1e-3)
    assert instance.get("m.a_velocity") - 0.5 == pytest.approx(FLAGS[flag] * 1e-3, abs=5e-6)
    instance = open_fmu(f"Without{flag.title()}").initialize(tolerance=1e-10)
    instance.run(2.0, 0.1)
    assert (instance.get("m.a") > 0.4 + 1e-9) == (flag in ("limit", "constraint"))


def test_least_masses_and_moments(open_fmu):
    """The angles after 1 s of a torque of 1: J = 2 + 3 2^2, the least moment, and the mean of 1, 1 and 7."""
    instance = open_fmu("Least").initialize({f"m.{name}_control": 1.0 for name in ("light", "thin", "odd")}, tolerance=1e-10)
    instance.run(1.0, 0.1)
    assert instance.get("m.light", "m.thin", "m.odd") == pytest.approx([1 / 2 / 14, 1 / 2 / 0.5, 1 / 2 / 3], rel=1e-9)
