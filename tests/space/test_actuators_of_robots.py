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
SYSTEMS = {"Driven": "", "Rests": 'friction="sticks"', "Key": 'keyframe="full"'}


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: f'<system name="{name}"><include file="m.xml" as="m" {word}/></system>' for name, word in SYSTEMS.items()}
    texts["Carried"] = '<system name="Carried"><include file="m.xml" as="m"/></system>'
    texts["Led"] = '<system name="Led"><include file="led.xml" as="m" mocap="inputs" base="floating"/></system>'
    build_systems("actuators", texts, files={f"{name}/m.xml": FILE for name in SYSTEMS} | {"Led/led.xml": LED, "Carried/m.xml": CARRIED})


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
