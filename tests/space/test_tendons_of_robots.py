"""
Tendons of MJCF between sites, couplings of two of them, and their friction, against closed forms; test_robots_in_mujoco.py compares others
with MuJoCo.
"""

import math

import pytest
from fmpy.fmi2 import FMU2Model

from fmu import build_systems

G, L0, H = 9.81, 0.4, 0.3
# Three robots. A slider on a rail has a spring to a post beside the rail. Two weights hang on one rope over a pulley. A tendon connects two sliders
# with friction.
FILE = f"""<mujoco model="m"><option gravity="0 0 {-G}"/><worldbody>
  <site name="post" pos="0 {H} 0"/><site name="pulley" pos="2 0 1"/>
  <body name="slider"><joint name="s" type="slide" axis="1 0 0" ref="0.4"/><geom size="0.1" mass="2"/><site name="eye"/><site name="p" pos="0 0 0.5"/></body>
  <body name="left" pos="2 0 0"><joint name="u" type="slide" axis="0 0 1"/><geom size="0.1" mass="3"/><site name="a"/></body>
  <body name="right" pos="2 0 0"><joint name="v" type="slide" axis="0 0 1"/><geom size="0.1" mass="1"/><site name="b"/></body>
  <body name="p"><joint name="p" type="slide" axis="0 1 0"/><geom size="0.1" mass="1"/></body>
  <body name="q"><joint name="q" type="slide" axis="0 1 0"/><geom size="0.1" mass="1"/></body>
</worldbody>
<tendon>
  <spatial name="spring" stiffness="30" damping="0.5" springlength="{L0}"><site site="post"/><site site="eye"/></spatial>
  <spatial name="rope"><site site="a"/><site site="pulley"/><site site="b"/></spatial>
  <spatial name="far"><site site="p"/><site site="eye"/></spatial>
  <fixed name="belt" frictionloss="4"><joint joint="p" coef="1"/><joint joint="q" coef="2"/></fixed>
</tendon>
<equality><tendon name="long" tendon1="rope"/></equality>
<actuator><motor name="pull" tendon="spring" gear="3"/><motor joint="p"/></actuator></mujoco>"""
SYSTEMS = {"Creeps": "", "Sticks": 'friction="sticks"'}


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: f'<system name="{name}"><include file="m.xml" as="m" {word}/></system>' for name, word in SYSTEMS.items()}
    build_systems("tendons", texts, files={f"{name}/m.xml": FILE for name in SYSTEMS})


def test_a_spring_from_site_to_site(open_fmu):
    x, v, u = 0.7, -0.4, 1.5
    instance = open_fmu("Creeps").initialize({"m.s": x, "m.s_velocity": v, "m.pull_control": u})
    length = math.hypot(x - 0.4, H)
    rate = (x - 0.4) * v / length
    assert instance.get("m.spring_tendon") == pytest.approx(length, rel=1e-14)
    push = 3 * u - 30 * (length - L0) - 0.5 * rate
    assert instance.get("der(m.s_velocity)") == pytest.approx(push * (x - 0.4) / length / 2, rel=1e-12)


def test_a_site_with_the_name_of_a_body_and_a_joint(open_fmu):
    """The tendon runs to the site; its frame is NAME_site."""
    instance = open_fmu("Creeps").initialize({"m.s": 0.7, "m.p": 3.0})
    assert instance.get("m.far_tendon", "m.p_site.x", "m.p_site.z", "m.p.y") == pytest.approx([0.5, 0.7 - 0.4, 0.5, 3.0], abs=1e-14)


def test_weights_on_a_rope(open_fmu):
    """The acceleration and force are those of Atwood's machine."""
    instance = open_fmu("Creeps").initialize({"m.u": 0.2, "m.v": -0.2})
    assert instance.get("der(m.u_velocity)", "der(m.v_velocity)") == pytest.approx([-G / 2, G / 2], rel=1e-12)
    assert instance.get("m.long.force") == pytest.approx(2 * 3 * 1 * G / 4, rel=1e-12)


def test_friction(open_fmu):
    """Two equal masses, coupled by a tendon as 1 to 2: sliding, creeping, and sticking up to the limit."""
    instance = open_fmu("Creeps").initialize({"m.p_velocity": 1e-4})
    drag = 4 * math.tanh(0.1)
    assert instance.get("der(m.p_velocity)", "der(m.q_velocity)") == pytest.approx([-drag, -2 * drag], rel=1e-12)
    for pull, expected in ((3, (3 * 4 / 5, -3 * 2 / 5)), (21, (21 - 4, -2 * 4))):
        instance = open_fmu("Sticks", kind=FMU2Model).initialize({"m.p_control": pull})
        instance.fmu.newDiscreteStates()
        assert instance.get("der(m.p_velocity)", "der(m.q_velocity)") == pytest.approx(expected, rel=1e-12)
