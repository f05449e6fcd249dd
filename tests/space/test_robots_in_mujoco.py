"""Accelerations of robots in MJCF at random states, against MuJoCo's for the same files, without contacts, limits and friction."""

import re
from ctypes import c_double

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from scipy.spatial.transform import Rotation

import attached_arms
import fmu
from fmu import build_systems
from numerics.space import hand

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.release

STATES = 20
CAMPAIGN = 100
# Covers units of angles, sequences of angles, positions, inherited classes, joints with anchors and refs, shapes and actuators.
EACH = """\
<mujoco model="each">
  <compiler angle="degree" eulerseq="XYz"/>
  <option gravity="0.5 -1 -9"/>
  <default>
    <joint damping="0.1" armature="0.02"/>
    <geom density="500"/>
    <default class="stiff"><joint stiffness="3" springref="20"/><default class="soft"><joint stiffness="1"/></default></default>
    <default class="servo"><motor gear="2" ctrlrange="-2 2"/><position kp="9" forcerange="-8 9"/><default class="open"><motor gear="3"/><general ctrlrange="-1 2"/></default></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <frame pos="0.1 0 0" euler="5 6 7">
      <body name="stand" pos="0 0 1" euler="10 20 30">
        <joint name="turn" axis="0 0 1" ref="15" actuatorfrcrange="-6 4"/>
        <joint name="swing" axis="0 1 0.2" pos="0.1 0 0.2" class="stiff"/>
        <geom type="box" size="0.1 0.2 0.05" pos="0.1 0 0" axisangle="1 1 0 40"/>
        <frame pos="0 0 0.3" quat="1 1 0 0"><geom type="cylinder" size="0.1 0.2" mass="2"/></frame>
        <body name="lower" pos="0.3 0 0" childclass="soft" zaxis="1 0.2 0.3">
          <joint name="slide" type="slide" axis="1 0 0" ref="0.1" range="-0.5 1.5"/>
          <geom type="capsule" fromto="0 0 0 0.1 0.2 0.4" size="0.05"/>
          <geom type="ellipsoid" size="0.1 0.05 0.2" pos="0 0 0.1" quat="1 2 3 4"/>
          <body name="tip" pos="0 0 0.4" xyaxes="1 1 0 0 1 1">
            <joint name="ball" type="ball" damping="0.3" armature="0" stiffness="0" pos="0 0.1 0"/>
            <inertial pos="0.05 0 0.1" mass="1.5" fullinertia="0.02 0.03 0.025 0.001 -0.002 0.003"/>
            <geom type="sphere" size="0.1"/>
          </body>
        </body>
      </body>
    </frame>
    <body name="drone" pos="1 2 3" euler="30 40 50">
      <joint name="drone" type="free" damping="0.4"/><geom type="cylinder" size="0.2 0.1" pos="0.1 0.2 0"/>
      <body name="rotor" pos="0 0 0.2">
        <joint name="rotor" class="main" axis="0 0 -1" springref="30" stiffness="0.2"/><geom type="box" fromto="0 0 0 0.3 0 0" size="0.02"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="m" joint="turn" gear="5" ctrlrange="-1 1"/>
    <position name="n" joint="turn" kp="3"/>
    <position name="p" joint="swing" kp="10" kv="0.5" gear="2" forcerange="-3 4"/>
    <velocity joint="slide" kv="7"/>
    <general joint="rotor" gainprm="2" biastype="affine" biasprm="0.1 -0.3 -0.2"/>
    <motor name="q" joint="swing" class="open"/>
    <position name="s" joint="rotor" class="servo" kv="0.2"/>
    <position name="u" joint="slide" inheritrange="0.8"/>
  </actuator>
</mujoco>
"""


def in_parts():
    """The same model in files that include each other, with paths relative to the first file and to the including one."""
    text, parts = EACH, {}
    for name, begin, end in [("parts/classes.xml", '<default class="stiff">', "</default></default>"), ("parts/settings.xml", "<compiler", "  <worldbody>"), ("bodies.xml", '<body name="drone"', "  </worldbody>")]:
        first = text.index(begin)
        last = text.index(end, first)
        last += len(end) if begin.startswith("<default") else 0
        parts[name] = f"<mujoco>{text[first:last]}</mujoco>"
        text = text[:first] + f'<include file="{name}"/>' + text[last:]
    parts["parts/settings.xml"] = parts["parts/settings.xml"].replace("parts/classes", "classes")
    return {"Parts.xml": text} | parts


COUPLED = """\
<mujoco model="coupled">
  <compiler angle="radian"/>
  <worldbody>
    <body name="a"><joint name="lead" axis="0 1 0" ref="0.3" damping="0.1"/><geom size="0.1" pos="0.3 0 0"/>
      <body name="b" pos="0.4 0 0">
        <joint name="follow" axis="0 1 1" ref="0.2" stiffness="3" springref="0.1" damping="0.2" armature="0.3" actuatorfrcrange="-4 3"/><geom size="0.1" pos="0 0 0.3"/>
        <body name="c" pos="0 0 0.4"><joint name="end" axis="1 0 0"/><geom type="box" size="0.1 0.2 0.3" pos="0 0.2 0"/></body>
      </body>
    </body>
  </worldbody>
  <actuator><position name="pull" joint="follow" gear="2" kp="5" kv="0.3"/><motor name="push" joint="end"/></actuator>
  <equality><joint joint1="follow" joint2="lead" polycoef="0.1 -0.5 0 0 0"/></equality>
</mujoco>
"""

# Loops: a body connected to another and to the world, welded by its placement, by a pose, and sites by both.
LOOPED = """\
<mujoco model="looped">
  <compiler angle="radian"/>
  <option gravity="1 2 -9"/>
  <worldbody>
    <site name="hook" pos="0.2 0.3 0.1" euler="0.1 0.2 0.3"/>
    <body name="a" pos="0.1 0 0" euler="0.3 0 0.2"><joint name="a1" axis="0 1 0" ref="0.3" damping="0.1"/><joint name="a2" axis="1 0 0" pos="0 0 0.1"/><geom size="0.1" pos="0.3 0 0"/>
      <body name="b" pos="0.4 0 0" quat="1 2 0 1">
        <joint name="b1" axis="0 1 1" ref="0.2"/><joint name="b2" type="slide" axis="1 0 0.2" ref="0.1"/><geom type="box" size="0.1 0.2 0.3" pos="0 0 0.3"/>
        <body name="c" pos="0 0 0.4"><joint name="c1" type="ball"/><geom type="box" size="0.1 0.2 0.3" pos="0 0.2 0"/><site name="tip" pos="0.1 0.2 0" zaxis="1 1 0"/></body>
      </body>
    </body>
    <body name="d" pos="0.5 0.6 0.7" euler="0.5 0 0"><freejoint/><geom type="box" size="0.2 0.1 0.3"/><site name="eye" pos="0 0.1 0" euler="0 0.4 0"/>
      <body name="e" pos="0.1 0 0"><joint name="e1" axis="1 0 0"/><geom size="0.2" pos="0 0.3 0"/></body>
    </body>
    <body name="f" pos="1 1 1" zaxis="1 2 3"><freejoint/><geom type="box" size="0.1 0.1 0.3"/></body>
  </worldbody>
  <actuator><motor name="push" joint="b1" gear="3"/><motor joint="e1"/></actuator>
  <equality>{}</equality>
  <keyframe>
    <key name="other" qpos="0 0 0 0 1 0 0 0 0 0 0 1 0 0 0 0 0 0 0 1 0 0 0"/>
    <key name="home" qpos="0.1 0.2 0.3 0.4 0.5 0.5 0.5 0.5 1 2 3 0.6 0 0.8 0 0.7 4 5 6 0 1 0 0"
         qvel="0.1 0.2 0.3 0.4 1 2 3 0.5 0.6 0.7 3 2 1 0.8 0 0 0 1 1 1" ctrl="0.3 0.4"/>
  </keyframe>
</mujoco>
"""
EQUALITIES = {
    "Connected": '<connect name="tie" body1="c" body2="d" anchor="0.1 0.2 0.3"/><connect body1="f" anchor="0 0.1 0"/><weld body1="d" active="false"/>',
    "Welded": '<weld body1="e" body2="f"/><weld name="posed" body1="b" body2="d" relpose="0.1 0.2 0.3 1 0.2 -0.3 0.1"/>',
    "Sited": '<connect site1="tip" site2="eye"/><weld site1="hook" site2="eye"/>',
    "Held": '<weld name="hold" body1="d"/>',
}

# A U-shaped mesh, part of whose surface is hidden from its centre of mass, so that MuJoCo's default computation of inertia is inexact.
OUTLINE = [(0, 0), (0.3, 0), (0.3, 0.2), (0.25, 0.2), (0.25, 0.05), (0.05, 0.05), (0.05, 0.2), (0, 0.2)]
FACES = [(1, 2, 5), (1, 5, 6), (2, 3, 4), (2, 4, 5), (1, 6, 7), (1, 7, 8)]
U = "\n".join(
    [f"v {x} {y} {z}" for z in (0, 0.07) for x, y in OUTLINE]
    + [f"f {a} {c} {b}\nf {a + 8} {b + 8} {c + 8}" for a, b, c in FACES]
    + [f"f {i} {i % 8 + 1} {i % 8 + 9} {i + 8}" for i in range(1, 9)]
)
MESHED = """\
<mujoco model="meshed">
  <compiler angle="radian" meshdir="shapes"/>
  <asset>
    <mesh name="usual" file="u.obj"/><mesh name="exact" file="u.obj" inertia="exact" scale="2 1 -1.5"/><mesh file="u.obj"/>
  </asset>
  <worldbody>
    <body name="a" quat="1 2 0 0"><joint name="a1" axis="0 1 0"/><geom type="mesh" mesh="usual" pos="0.1 0.2 0" euler="0.3 0.4 0"/>
      <body name="b" pos="0.4 0 0"><joint name="b1" type="ball"/><geom type="mesh" mesh="exact" density="400" pos="0 0.1 0"/>
        <body name="c" pos="0 0 0.4"><joint name="c1" axis="1 1 0"/><geom type="mesh" mesh="u" mass="3"/><geom size="0.1"/></body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


# Tendons of each kind, coupled to others or fixed.
LINKED = """\
<mujoco model="linked">
  <compiler angle="radian"/>
  <worldbody>
    <site name="post" pos="0.1 0.5 1"/>
    <body name="a" pos="0 0 0.2"><joint name="a1" axis="0 1 0" ref="0.2"/><geom type="box" size="0.1 0.2 0.3" pos="0.3 0 0"/><site name="sa" pos="0.1 0.2 0.3"/><site name="sb" pos="0.3 0.2 0.3"/>
      <body name="b" pos="0.4 0 0"><joint name="b1" axis="0 1 1"/><joint name="b2" type="slide" axis="1 0 0.2" ref="0.1"/><geom type="box" size="0.1 0.2 0.3" pos="0 0.1 0.3"/><site name="sc" pos="0.1 -0.2 0.4"/>
        <body name="c" pos="0 0 0.4"><joint name="c1" axis="1 0 1"/><geom type="box" size="0.1 0.2 0.3" pos="0 0.2 0"/><site name="sd" pos="0.3 0.1 0.2"/></body>
      </body>
    </body>
    <body name="d" pos="0.3 0.2 0.5"><joint name="d1" type="slide" axis="1 1 0"/><joint name="d2" axis="0 0 1"/><geom type="box" size="0.2 0.1 0.3"/><site name="se" pos="0 0.1 0"/></body>
  </worldbody>
  <tendon>
    <spatial name="t1"><site site="post"/><site site="sa"/><site site="sb"/><site site="sc"/></spatial>
    <spatial name="t2" stiffness="30" damping="0.3" springlength="0.2 0.9"><site site="sd"/><site site="se"/></spatial>
    <fixed name="t3"><joint joint="a1" coef="0.5"/><joint joint="b1" coef="-1.2"/></fixed>
    <fixed name="t4"><joint joint="d1" coef="0.5"/><joint joint="b2" coef="-1.2"/></fixed>
  </tendon>
  <equality><tendon tendon1="t3" tendon2="t1" polycoef="0.1 0.7 0.3"/><tendon name="e" tendon1="t2" tendon2="t4" polycoef="0 0.7 0 0.2 -0.1"/></equality>
</mujoco>
"""


# Bodies in a fluid: of one geom, of several, with principal axes and with a full tensor.
IMMERSED = """\
<mujoco model="immersed">
  <option density="30" viscosity="0.7" wind="0.4 -0.2 0.3" gravity="0 0 -2"/>
  <worldbody>
    <body name="a" pos="0 0 1" euler="10 20 30"><freejoint name="f"/><geom type="box" size="0.1 0.2 0.05" pos="0.1 0 0.02" euler="20 0 40"/><geom size="0.1" pos="0 0.2 0"/>
      <body name="b" pos="0.3 0 0"><joint name="h" axis="1 2 3"/><geom type="capsule" fromto="0 0 0 0.3 0.2 0.1" size="0.05"/>
        <body name="c" pos="0.1 0.2 0.3" euler="50 10 0"><joint name="bl" type="ball"/><inertial pos="0.1 0.05 0.02" quat="1 0.3 0.2 0.5" mass="1.3" diaginertia="0.02 0.03 0.025"/>
          <body name="d" pos="0 0 0.2" euler="0 30 0"><geom type="ellipsoid" size="0.1 0.05 0.07" pos="0.02 0.03 0.1" quat="1 2 3 4"/></body>
        </body>
      </body>
    </body>
    <body name="e" pos="2 0 0"><joint name="s" type="slide" axis="0 1 1"/><inertial pos="0 0.1 0" mass="2" fullinertia="0.05 0.06 0.04 0.01 -0.005 0.003"/></body>
  </worldbody>
</mujoco>
"""


# Bodies that are lighter than the least mass, without inertia, and with impossible moments.
BOUNDED = """\
<mujoco model="bounded">
  <compiler boundmass="0.8" boundinertia="0.004" balanceinertia="true"/>
  <option density="30" viscosity="0.5"/>
  <worldbody>
    <body name="a" pos="0 0 1" euler="10 20 30"><freejoint name="f"/><geom type="box" size="0.1 0.2 0.05" pos="0.1 0 0.02" euler="20 0 40"/><geom size="0.1" pos="0 0.2 0"/>
      <body name="b" pos="0.3 0 0"><joint name="h" axis="1 2 3"/>
        <body name="c" pos="0.1 0.2 0.3" euler="50 10 0"><joint name="bl" type="ball"/><inertial pos="0.1 0.05 0.02" quat="1 0.3 0.2 0.5" mass="1.3" diaginertia="0.01 0.07 0.025"/>
          <body name="d" pos="0 0 0.2" euler="0 30 0"><geom type="ellipsoid" size="0.1 0.05 0.07" pos="0.02 0.03 0.1" quat="1 2 3 4" density="200"/></body>
        </body>
      </body>
    </body>
    <body name="e" pos="2 0 0"><joint name="s" axis="0 1 1"/><inertial pos="0 0.1 0" mass="2" fullinertia="0.05 0.06 0.001 0.01 -0.0005 0.0003"/></body>
  </worldbody>
</mujoco>
"""


# Forces of each kind, of which <flag> disables one.
FLAGGED = """\
<mujoco model="flagged">
  <option density="20"><flag {}="disable"/></option>
  <worldbody>
    <body name="a" gravcomp="1"><joint name="j" axis="0 1 0" stiffness="3" damping="2" springref="20"/><geom size="0.1" pos="0.3 0 0" mass="2"/>
      <body name="b" pos="0.3 0 0"><joint name="k" axis="0 1 1" springdamper="0.3 0.7"/><geom size="0.1" pos="0.3 0 0" mass="1"/></body>
    </body>
  </worldbody>
  <tendon><fixed name="t" stiffness="2" damping="1" springlength="0.3"><joint joint="j" coef="1"/></fixed></tendon>
  <actuator><position name="p" joint="j" kp="4" ctrlrange="-1 1"/><velocity name="q" joint="k" kv="2"/></actuator>
</mujoco>
"""


# Actuators with a state or a gain that varies, balanced weights, and a sum of all masses.
DRIVEN = """\
<mujoco model="driven">
  <compiler angle="radian" settotalmass="7"/>
  <option gravity="1 2 -9"/>
  <default><general gear="0.7"/><default class="m"><muscle ctrlrange="-1.5 2"/></default></default>
  <worldbody>
    <body name="a" gravcomp="0.7"><joint name="a1" axis="0 1 0" ref="0.2" damping="0.1"/><geom type="box" size="0.1 0.2 0.3" pos="0.3 0 0.1"/>
      <body name="aa" pos="0.1 0.2 0.3" euler="1 2 3" gravcomp="-1.5"><geom size="0.1" pos="0.1 0 0"/></body>
      <body name="b" pos="0.4 0 0" gravcomp="1"><joint name="b1" axis="0 1 1"/><joint name="b2" type="slide" axis="1 0 0.2" ref="0.1"/><geom type="box" size="0.1 0.2 0.3" pos="0 0.1 0.3"/>
        <body name="c" pos="0 0 0.4"><joint name="c1" axis="1 0 1"/><geom type="box" size="0.1 0.2 0.3" pos="0 0.2 0"/></body>
      </body>
    </body>
    <body name="d" pos="1 0 0"><joint name="d1" axis="0 1 0"/><geom size="0.1" pos="0 0 0.4"/></body>
  </worldbody>
  <tendon><fixed name="t"><joint joint="a1" coef="0.5"/><joint joint="c1" coef="-1.2"/></fixed></tendon>
  <actuator>
    <general name="filtered" joint="a1" dyntype="filter" dynprm="0.3" gainprm="2" biastype="affine" biasprm="0.5 -0.3 -0.2"/>
    <damper name="damped" joint="b1" kv="3" ctrlrange="0 2"/>
    <intvelocity name="wound" joint="c1" kp="4" kv="0.3" actrange="-1 1"/>
    <general name="varied" joint="b2" gaintype="affine" gainprm="2 0.4 -0.3"/>
    <cylinder name="pressed" tendon="t" timeconst="0.2" diameter="1.3" bias="0.1 -0.2 -0.3"/>
    <position name="late" class="m" joint="d1" kp="5" kv="0.4" timeconst="0.05"/>
    <position name="prompt" joint="d1" kp="2"/>
    <general name="summed" joint="d1" dyntype="integrator"/>
  </actuator>
</mujoco>
"""

# Actuators at sites, and at free and ball joints: forces and torques along the axes of the site, of the body, or of its parent.
PUSHED = """\
<mujoco model="pushed">
  <compiler angle="radian"/>
  <worldbody>
    <site name="post" pos="1 0 0"/>
    <body name="drone" euler="0.3 0.2 0.1"><joint name="drone" type="free"/><geom type="box" size="0.2 0.1 0.3" pos="0.1 0.2 0"/>
      <site name="rotor" pos="0.2 0.1 0.3" euler="0.3 0.4 0.5"/><site name="drone" pos="0 0.1 0"/>
      <body name="head" pos="0 0 0.3"><joint name="neck" type="ball" pos="0.1 0 0"/><geom type="box" size="0.1 0.1 0.2" pos="0.1 0 0.2"/><site name="nose" pos="0.1 0.2 0.3"/></body>
    </body>
    <body name="arm" pos="1 0 0"><joint name="hinge" axis="0 1 0.2"/><geom type="box" size="0.2 0.1 0.3" pos="0.1 0.2 0"/><site name="hand" pos="0.2 0.1 0.3" euler="0.3 0.4 0.5"/>
      <body name="ball" pos="0.2 0 0" euler="0.1 0.2 0"><joint name="wrist" type="ball"/><geom type="box" size="0.1 0.1 0.2" pos="0.1 0 0.2"/></body>
    </body>
  </worldbody>
  <actuator>
    <motor name="thrust" site="rotor" gear="0 0.2 1 0 0.3 -0.02" ctrlrange="-1 2"/>
    <motor name="twist" site="nose" gear="0 0 0 0.1 -0.2 0.3"/>
    <general site="drone" gainprm="3" biastype="affine" biasprm="0.2" gear="2" forcerange="-4 5"/>
    <motor name="tip" site="hand" gear="1 2 3 0.4 0.5 0.6"/>
    <motor name="nothing" site="post" gear="1 2 3"/>
    <motor name="fly" joint="drone" gear="1 2 3 0.4 0.5 0.6"/>
    <motor name="fall" jointinparent="drone" gear="0 0 0.5 0.4 -0.5 0.6"/>
    <motor name="nod" joint="neck" gear="1 -2 0.5"/>
    <motor name="shake" jointinparent="wrist" gear="1 -2 0.5"/>
    <motor jointinparent="hinge" gear="3"/>
  </actuator>
</mujoco>
"""

# Copies, also of copies, with zeros in front of the numbers of eleven; what refers to them comes last in each section.
COPIED = """\
<mujoco model="copied">
  <compiler eulerseq="XYz"/>
  <worldbody>
    <body name="base"><joint name="turn" axis="0 0 1"/><geom size="0.1"/>
      <replicate count="3" sep="_" offset="0.4 0 0.1" euler="10 20 30">
        <body name="arm" pos="0.5 0 0" euler="0 10 0"><joint name="h" axis="0 1 0" damping="0.2"/><geom size="0.1" pos="0.2 0.1 0.3"/><site name="s" pos="0.1 0.1 0.1"/>
          <replicate count="2" offset="0 0 0.3"><body name="finger" pos="0.1 0 0"><joint name="f" axis="1 0 0.1"/><geom type="box" size="0.1 0.05 0.2" pos="0 0 0.2"/><site name="end" pos="0 0 0.3"/></body></replicate>
        </body>
        <geom type="box" size="0.1 0.2 0.1" pos="0 0.3 0"/>
      </replicate>
    </body>
    <replicate count="11" offset="0 0.3 0"><body name="bob" pos="2 0 0"><joint name="swing" axis="0 1 0" stiffness="2"/><geom size="0.1" pos="0 0 -0.4"/></body></replicate>
  </worldbody>
  <tendon>
    <fixed name="both"><joint joint="f" coef="2"/><joint joint="h" coef="-1"/></fixed>
    <spatial name="line" stiffness="3" damping="0.2" springlength="0.2"><site site="s"/><site site="end"/></spatial>
    <fixed name="own"><joint joint="turn" coef="1"/></fixed>
  </tendon>
  <actuator>
    <motor name="m" joint="h"/><motor name="turn" joint="turn"/><motor name="pull" tendon="both"/><motor name="swing" joint="swing" gear="2"/><motor name="push" site="end" gear="0.1 0.2 0.3"/>
  </actuator>
  <contact><exclude body1="arm" body2="base"/></contact>
</mujoco>
"""

# Springs by time constants, whose inertia is that of the joint while all others move freely.
TIMED = """\
<mujoco model="timed">
  <compiler angle="radian" settotalmass="7"/>
  <default><default class="slow"><joint springdamper="0.5 1.2" springref="0.1"/></default></default>
  <worldbody>
    <body name="base" pos="0 0 1" euler="0.3 0.2 0.1"><joint name="j" axis="0 1 0.3" ref="0.2" springdamper="0.2 0.7" armature="0.1" pos="0.1 0 0.2"/><geom size="0.1" mass="1" pos="0.3 0 0"/>
      <frame pos="0.2 0.1 0"><body name="arm" pos="0.5 0 0"><joint name="h" axis="0 1 0" class="slow"/><joint name="s" type="slide" axis="1 0 0.2" ref="0.3" springdamper="0.3 2" damping="3" stiffness="5"/><geom type="box" size="0.1 0.2 0.3" mass="1" pos="0 0 0.3"/></body></frame>
      <body name="head" pos="0 0 0.4"><joint name="ball" type="ball" pos="0 0.1 0" armature="0.02"/><geom type="box" size="0.1 0.2 0.3" pos="0.2 0 0"/></body>
    </body>
    <body name="drone" pos="1 2 3" euler="1 2 3"><freejoint/><geom type="box" size="0.1 0.2 0.1" pos="0.1 0 0"/><body name="tail" pos="0.3 0 0"><joint name="t" axis="1 2 0" springdamper="0.1 0.3"/><geom size="0.1" pos="0.2 0 0.1"/></body></body>
  </worldbody>
</mujoco>
"""

# Damping ratios of servomotors, at joints and along tendons of each kind.
DAMPED = """\
<mujoco model="damped">
  <compiler angle="radian"/>
  <default><default class="y"><position kv="3"/><default class="z"><position dampratio="0.4"/></default></default></default>
  <worldbody>
    <site name="post" pos="1 0 0"/>
    <body name="base" pos="0 0 1" euler="0.3 0.2 0.1"><joint name="j" axis="0 1 0.3" ref="0.2" armature="0.1" pos="0.1 0 0.2"/><geom size="0.1" mass="1" pos="0.3 0 0"/>
      <body name="arm" pos="0.5 0 0"><joint name="h" axis="0 1 0"/><joint name="s" type="slide" axis="1 0 0.2" ref="0.3"/><geom type="box" size="0.1 0.2 0.3" mass="1" pos="0 0 0.3"/><site name="a" pos="0.1 0.2 0.3"/></body>
      <body name="head" pos="0 0 0.4"><joint name="ball" type="ball" pos="0 0.1 0" armature="0.02"/><geom type="box" size="0.1 0.2 0.3" pos="0.2 0 0"/><site name="b" pos="0.2 0.1 0.2"/></body>
    </body>
    <body name="drone" pos="1 2 3" euler="1 2 3"><freejoint/><geom type="box" size="0.1 0.2 0.1" pos="0.1 0 0"/><site name="c" pos="0.2 0.1 0.2"/></body>
  </worldbody>
  <tendon><fixed name="f"><joint joint="j" coef="2"/><joint joint="s" coef="-0.5"/></fixed>
  <spatial name="p"><site site="post"/><site site="a"/><site site="b"/><site site="c"/></spatial></tendon>
  <actuator>
    <position name="one" class="y" joint="j" kp="10" dampratio="0.7" gear="-2"/>
    <position name="two" class="z" joint="s" kp="5"/>
    <position name="three" class="z" joint="s" kp="5" kv="0.1"/>
    <intvelocity name="four" tendon="f" kp="3" dampratio="1" actrange="-1 1"/>
    <general name="five" tendon="p" gainprm="4" biastype="affine" biasprm="0.1 -4 0.6" gear="0.5"/>
      </actuator>
</mujoco>
"""

# Between two lengths the tendon's spring is slack.
SLACK = """\
<mujoco model="slack">
  <compiler angle="radian"/>
  <worldbody>
    <body><joint name="a" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0"/>
      <body pos="0.3 0 0"><joint name="b" axis="1 1 0"/><geom type="box" size="0.1 0.2 0.1" pos="0.3 0 0"/></body>
    </body>
  </worldbody>
  <tendon><fixed name="t" stiffness="30" springlength="-0.3 0.4" armature="0.2"><joint joint="a" coef="2"/><joint joint="b" coef="-0.5"/></fixed></tendon>
</mujoco>
"""


class Generator:
    """Random files: trees of at most five bodies."""

    def __init__(self, seed):
        self.random, self.bodies, self.joints, self.tendons, self.singles, self.sites = np.random.default_rng(seed), 0, 0, 0, [], []

    def numbers(self, count, low=-1.0, high=1.0):
        return " ".join(f"{x:.6g}" for x in self.random.uniform(low, high, count))

    def choice(self, *options):
        return options[self.random.integers(len(options))]

    def turn(self):
        ways = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}
        way = self.choice("", *ways)
        return f'{way}="{self.numbers(ways[way])}"' if way else ""

    def geom(self):
        size, kind = self.numbers(3, 0.05, 0.3), self.choice("sphere", "capsule", "cylinder", "box", "ellipsoid")
        weight = self.choice("", f'mass="{self.numbers(1, 0.5, 3)}"', f'density="{self.numbers(1, 300, 3000)}"')
        place = f'pos="{self.numbers(3, -0.3, 0.3)}" {self.turn()}'
        if kind not in ("sphere",) and self.random.random() < 0.3:
            place = f'fromto="{self.numbers(6, -0.5, 0.5)}"'
        return f'<geom type="{kind}" size="{size}" {place} {weight}/>'

    def inertial(self):
        a, b = self.random.uniform(0.02, 0.1, 2)
        moments = f"{a:.6g} {b:.6g} {self.random.uniform(max(a, b) - min(a, b) + 0.01, a + b - 0.005):.6g}"
        if self.random.random() < 0.5:
            return f'<inertial pos="{self.numbers(3)}" mass="{self.numbers(1, 0.5, 3)}" fullinertia="0.1 0.12 0.11 {self.numbers(3, -0.02, 0.02)}"/>'
        return f'<inertial pos="{self.numbers(3)}" {self.turn()} mass="{self.numbers(1, 0.5, 3)}" diaginertia="{moments}"/>'

    def joint(self):
        self.joints += 1
        name, kind = f"j{self.joints}", self.choice("hinge", "hinge", "slide")
        self.singles.append(name)
        ways = {"ref": (-1, 1), "springref": (-1, 1), "stiffness": (0, 9), "damping": (0, 2), "armature": (0, 0.5)}
        given = " ".join(f'{way}="{self.numbers(1, *limits)}"' for way, limits in ways.items() if self.random.random() < 0.5)
        classes = self.choice("", 'class="c1"', 'class="c2"')
        anchor = self.choice("", f'pos="{self.numbers(3)}"')
        return f'<joint name="{name}" type="{kind}" axis="{self.numbers(3)}" {anchor} {given} {classes}/>'

    def body(self, depth=0):
        self.bodies += 1
        name = f"b{self.bodies}"
        kind = self.choice("fixed" if depth else "single", "single", "single", "several", "ball", "single" if depth else "free")
        joints = {"fixed": 0, "single": 1, "several": 2}
        inside = [self.joint() for _ in range(joints.get(kind, 0))]
        if kind == "free":
            inside.append("<freejoint/>")
        if kind == "ball":
            self.joints += 1
            given = f'stiffness="0" damping="{self.numbers(1, 0, 2)}" armature="{self.choice("0", self.numbers(1, 0, 0.5))}"'
            inside.append(f'<joint name="ball{self.joints}" type="ball" pos="{self.numbers(3)}" {given}/>')
        inside += [self.geom() for _ in range(self.random.integers(1, 3))]
        inside.append(self.site())
        if self.random.random() < 0.4:
            inside.append(self.inertial())
        while self.bodies < 5 and self.random.random() < 0.6:
            inside.append(self.body(depth + 1))
        child_class = self.choice("", 'childclass="c1"', 'childclass="c2"')
        return f'<body name="{name}" pos="{self.numbers(3)}" {self.turn()} {child_class}>{"".join(inside)}</body>'

    def actuator(self, transmission):
        limits = self.choice("", 'ctrlrange="-1 1.5"', 'forcerange="-2 3"')
        gear = self.choice("", f'gear="{self.numbers(1, -3, 3)}"')
        law = self.choice("motor", f'position kp="{self.numbers(1, 1, 9)}" kv="{self.numbers(1, 0, 2)}"', f'velocity kv="{self.numbers(1, 0, 2)}"',
                          f'general gainprm="{self.numbers(1)}" biastype="affine" biasprm="{self.numbers(3)}"')  # fmt: skip
        return f"<{law} {transmission} {gear} {limits}/>"

    def site(self):
        self.sites.append(f"s{len(self.sites) + 1}")
        return f'<site name="{self.sites[-1]}" pos="{self.numbers(3)}"/>'

    def path(self):
        sites = self.random.permutation(self.sites)[: self.random.integers(2, 5)]
        given = "".join(f' {way}="{self.numbers(1, 0, high)}"' for way, high in {"stiffness": 9, "damping": 2}.items() if self.random.random() < 0.6)
        self.tendons += 1
        return f'<spatial name="t{self.tendons}" springlength="{self.numbers(1, 0, 2)}"{given}>' + "".join(f'<site site="{site}"/>' for site in sites) + "</spatial>"

    def tendon(self):
        joints = self.random.permutation(self.singles)[: self.random.integers(1, 4)]
        pulls = "".join(f'<joint joint="{joint}" coef="{self.numbers(1)}"/>' for joint in joints)
        # MuJoCo omits the coupling of different branches by a tendon's inertia.
        ways = {"stiffness": 9, "damping": 2} | ({"armature": 0.5} if len(joints) == 1 else {})
        given = " ".join(f'{way}="{self.numbers(1, 0, high)}"' for way, high in ways.items() if self.random.random() < 0.6)
        relaxed = self.choice("", f'springlength="{self.numbers(1)}"')
        self.tendons += 1
        classes = self.choice("", 'class="c1"')
        return f'<fixed name="t{self.tendons}" {given} {relaxed} {classes}>{pulls}</fixed>'

    def text(self):
        sequence = "".join(self.choice(*"xyzXYZ") for _ in range(3))
        bodies = "".join(self.body() for _ in range(self.random.integers(1, 3)))
        post = self.site()
        tendons = "".join(self.tendon() for _ in range(self.random.integers(0, 4)) if self.singles) + "".join(self.path() for _ in range(self.random.integers(0, 3)))
        transmissions = [f'joint="{joint}"' for joint in self.singles] + [f'tendon="t{i + 1}" name="a{i + 1}"' for i in range(self.tendons)]
        actuators = "".join(self.actuator(transmission) for transmission in transmissions if self.random.random() < 0.7)
        return (
            f'<mujoco model="r"><compiler angle="{self.choice("degree", "radian")}" eulerseq="{sequence}"/>'
            f'<option gravity="{self.choice("0 0 -9.81", self.numbers(3))}"/>'
            f'<default><joint damping="{self.numbers(1, 0, 1)}"/><geom density="700"/>'
            f'<default class="c1"><joint armature="{self.numbers(1, 0, 1)}"/><default class="c2"><joint stiffness="2"/><geom density="90"/></default>'
            f'<tendon damping="{self.numbers(1, 0, 1)}"/></default><tendon stiffness="{self.numbers(1, 0, 2)}"/>'
            f"</default><worldbody>{post}{bodies}</worldbody><tendon>{tendons}</tendon><actuator>{actuators}</actuator></mujoco>"
        )


FILES = {"Each": EACH, "Pushed": PUSHED, "Copied": COPIED, "Timed": TIMED, "Immersed": IMMERSED, "Bounded": BOUNDED} | {f"Without{name.title()}": FLAGGED.format(name) for name in ("spring", "damper", "actuation", "clampctrl", "gravity")} | {f"Random{seed}": Generator(seed).text() for seed in range(CAMPAIGN)}


@pytest.fixture(scope="module", autouse=True)
def robots(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mjcf")
    files = FILES | {"Coupled": COUPLED} | {name: LOOPED.format(text) for name, text in EQUALITIES.items()}
    for name, text in files.items():
        (folder / f"{name}.xml").write_text(text)
    files |= {"Meshed": MESHED, "Slack": SLACK, "Linked": LINKED, "Driven": DRIVEN}
    (folder / "Driven.xml").write_text(DRIVEN)
    (folder / "Linked.xml").write_text(LINKED)
    (folder / "Slack.xml").write_text(SLACK)
    (folder / "Meshed.xml").write_text(MESHED)
    (folder / "Started.xml").write_text(LOOPED.format(""))
    files |= {"Parts": EACH}
    (folder / "parts").mkdir()
    for name, text in in_parts().items():
        (folder / name).write_text(text)
    (folder / "shapes").mkdir()
    (folder / "shapes" / "u.obj").write_text(U)
    start = {"Started": 'keyframe="home"'}
    build_systems("mujoco", {name: f'<system name="{name}"><include file="{folder / name}.xml" as="r" {start.get(name, "")}/></system>' for name in [*files, "Started"]})


def product(a, b):
    """Product of quaternions, the real part first."""
    return np.array([a[0] * b[0] - a[1:] @ b[1:], *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))])


def turning(quaternion, angular_velocity):
    """Rate of a quaternion for an angular velocity along the body axes."""
    return product(quaternion, np.array([0, *angular_velocity])) / 2


class Reference:
    """MuJoCo's model at the states of the FMU."""

    def __init__(self, text, files=None):
        self.model = mujoco.MjModel.from_xml_string(text, {name: part.encode() for name, part in ({"u.obj": U} | (files or {})).items()})
        flags = mujoco.mjtDisableBit
        self.model.opt.disableflags |= flags.mjDSBL_CONTACT | flags.mjDSBL_LIMIT | flags.mjDSBL_FRICTIONLOSS
        self.data = mujoco.MjData(self.model)

    def names(self):
        """Names of the FMU's coordinates, each with its index in qpos."""
        names = []
        for i in range(self.model.njnt):
            joint = self.model.joint(i)
            name = (joint.name or self.model.body(joint.bodyid[0]).name).replace(":", "_")
            ends = {0: ["_x", "_y", "_z", "_qw", "_qx", "_qy", "_qz"], 1: ["_qw", "_qx", "_qy", "_qz"]}.get(joint.type[0], [""])
            names += [f"r.{name}{end}" for end in ends]
        return names

    def draw(self, random):
        """Set a random state and controls of MuJoCo's model."""
        self.data.qpos, self.data.qvel = random.uniform(-1, 1, self.model.nq), random.uniform(-2, 2, self.model.nv)
        mujoco.mj_normalizeQuat(self.model, self.data.qpos)
        self.data.ctrl = random.uniform(-3, 3, self.model.nu)
        mujoco.mj_forward(self.model, self.data)

    def coordinates(self):
        """The FMU's coordinates, their velocities and accelerations."""
        position, velocity, acceleration = [], [], []
        for i in range(self.model.njnt):
            kind, q, v = self.model.jnt_type[i], self.model.jnt_qposadr[i], self.model.jnt_dofadr[i]
            if kind == 0:
                position += [*self.data.qpos[q : q + 3]]
                velocity += [*self.data.qvel[v : v + 3]]
                acceleration += [*self.data.qacc[v : v + 3]]
                q, v = q + 3, v + 3
            if kind in (0, 1):
                rotated, omega, alpha = self.data.qpos[q : q + 4], self.data.qvel[v : v + 3], self.data.qacc[v : v + 3]
                rate = turning(rotated, omega)
                position += [*rotated]
                velocity += [*rate]
                acceleration += [*(turning(rate, omega) + turning(rotated, alpha))]
            else:
                position.append(self.data.qpos[q])
                velocity.append(self.data.qvel[v])
                acceleration.append(self.data.qacc[v])
        return np.array(position), np.array(velocity), np.array(acceleration)


def enter_and_leave_events(instance):
    """Enter and leave event mode, which updates the limits of controls and forces."""
    instance.fmu.enterEventMode()
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()


def check_accelerations(name, text, instance, digits, files=None):
    reference = Reference(text, files)
    instance.initialize({})
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    states, inputs, names = fmu.states_of(name), fmu.names_of(name, "input"), reference.names()
    order = [states.index(joint) for joint in names]
    order += [states.index(f"{joint}_velocity") for joint in names]
    assert len(order) == len(states) and len(inputs) == reference.model.nu
    random = np.random.default_rng(1)
    state, derivatives = (c_double * len(states))(), (c_double * len(states))()
    for _ in range(STATES):
        reference.draw(random)
        position, velocity, expected = reference.coordinates()
        instance.set(dict(zip(inputs, reference.data.ctrl)))
        values = np.zeros(len(states))
        values[order] = [*position, *velocity]
        state[:] = values
        instance.fmu.setContinuousStates(state, len(state))
        enter_and_leave_events(instance)
        instance.fmu.getDerivatives(derivatives, len(derivatives))
        found = np.array(derivatives)[order][len(names) :]
        assert np.max(np.abs(found - expected)) < digits * max(1, np.max(np.abs(expected)))


@pytest.mark.parametrize("name", FILES)
def test_accelerations(name, open_fmu):
    check_accelerations(name, FILES[name], open_fmu(name, kind=FMU2Model), 1e-10)


def touching(seed):
    """A tree of bodies with spheres that all overlap, with random masks, pairs and exclusions, and the bodies' geoms that may touch."""
    random = np.random.default_rng(seed)
    geoms, count = {"world": []}, 0

    def sphere(body):
        nonlocal count
        count += 1
        kind, affinity = random.integers(0, 4, 2)
        geoms[body].append((f"g{count}", kind or affinity))
        return f'<geom name="g{count}" size="1" pos="{" ".join(map(str, random.uniform(-0.1, 0.1, 3)))}" contype="{kind}" conaffinity="{affinity}"/>'

    def body(depth):
        name = f"b{len(geoms)}"
        geoms[name] = []
        inside = ("<joint/>" if random.random() < 0.7 or depth == 0 else "") + sphere(name)
        while len(geoms) < 7 and random.random() < 0.6:
            inside += body(depth + 1)
        return f'<body name="{name}">{inside}{sphere(name) if random.random() < 0.3 else ""}</body>'

    world = sphere("world") + "".join(body(0) for _ in range(3))
    bodies, names = list(geoms), [name for listed in geoms.values() for name, _ in listed]
    excluded = {tuple(random.choice(bodies, 2, replace=False)) for _ in range(2)}
    paired = {tuple(random.choice(names, 2, replace=False)) for _ in range(2)}
    rules = "".join(f'<exclude body1="{a}" body2="{b}"/>' for a, b in excluded) + "".join(f'<pair geom1="{a}" geom2="{b}"/>' for a, b in paired)
    filtered = random.choice(["enable", "disable"])
    in_pairs = {name for pair in paired for name in pair}
    return f'<mujoco><option><flag filterparent="{filtered}"/></option><worldbody>{world}</worldbody><contact>{rules}</contact></mujoco>', {
        body: [name for name, touches in listed if touches or name in in_pairs] for body, listed in geoms.items()
    }


@pytest.mark.parametrize("seed", range(30))
def test_pairs_that_touch(seed, tmp_path):
    """All spheres overlap, so that MuJoCo has a contact for each pair that may touch."""
    text, geoms = touching(seed)
    reference = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(reference)
    mujoco.mj_forward(reference, data)
    static = {i for i in range(reference.ngeom) if reference.body_weldid[reference.geom_bodyid[i]] == 0}
    pairs = {frozenset(int(geom) for geom in contact.geom) for contact in data.contact}
    expected = {frozenset(reference.geom(geom).name for geom in pair) for pair in pairs if not pair <= static}
    (tmp_path / "touching.xml").write_text(text)
    result = fmu.lagc("touching.xml", "-o", "out", "--robot", "self=true", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    found = re.findall(r'name="(\w+)_collision(\d+)_on_(\w+)_collision(\d+)\.force"', (tmp_path / "out" / "modelDescription.xml").read_text())
    assert {frozenset((geoms[a][int(i) - 1], geoms[b][int(j) - 1])) for a, i, b, j in found} == expected


def test_included_files(open_fmu):
    files = in_parts()
    check_accelerations("Parts", files["Parts.xml"], open_fmu("Parts", kind=FMU2Model), 1e-10, files)


def test_hand(open_fmu):
    """The Shadow hand, with 24 joints, 20 servomotors with limits, and tendons."""
    if hand.source() is None:
        pytest.skip("gymnasium-robotics is not installed")
    text = hand.text()
    build_systems("mujoco-hand", {"Shadow": '<system name="Shadow"><include file="hand.xml" as="r"/></system>'}, files={"Shadow/hand.xml": text})
    check_accelerations("Shadow", text, open_fmu("Shadow", kind=FMU2Model), 1e-10)


def test_damping_ratios(tmp_path):
    """Each damping is that of MuJoCo's compiled model."""
    (tmp_path / "damped.xml").write_text(DAMPED)
    assert fmu.lagc("damped.xml", "-o", "out", cwd=tmp_path).returncode == 0
    model, text = mujoco.MjModel.from_xml_string(DAMPED), (tmp_path / "out" / "modelDescription.xml").read_text()
    names = [model.actuator(i).name for i in range(model.nu)]
    found = [float(re.search(rf'name="{name}_control_damping".*?start="(.*?)"', text, re.DOTALL)[1]) for name in names]
    assert found == pytest.approx(-model.actuator_biasprm[:, 2], rel=1e-13)


def test_attached_files(tmp_path):
    """The robot has the masses, the order of inputs and the placements of MuJoCo's model."""
    for name, text in attached_arms.TEXTS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    model, flat = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("top.xml", "flat.xml"))
    for field in ("body_mass", "body_pos", "body_quat", "body_inertia", "qpos0", "jnt_axis", "jnt_pos", "dof_damping", "dof_armature", "dof_frictionloss"):
        assert getattr(flat, field) == pytest.approx(getattr(model, field), abs=1e-12), field
    for kind, count in (("body", model.nbody), ("joint", model.njnt), ("actuator", model.nu), ("tendon", model.ntendon)):
        assert [getattr(flat, kind)(i).name for i in range(count)] == [getattr(model, kind)(i).name for i in range(count)]
    assert flat.actuator_trnid == pytest.approx(model.actuator_trnid) and flat.actuator_gear == pytest.approx(model.actuator_gear)
    assert flat.wrap_prm == pytest.approx(model.wrap_prm) and flat.eq_obj1id == pytest.approx(model.eq_obj1id)


def test_slack_tendon(open_fmu):
    """A state set in one step may cross both ends of the slack interval, so that a new instance is initialized for each state."""
    reference, random, lengths = Reference(SLACK), np.random.default_rng(1), set()
    for _ in range(STATES):
        reference.draw(random)
        position, velocity, expected = reference.coordinates()
        instance = open_fmu("Slack").initialize(dict(zip(["r.a", "r.b", "r.a_velocity", "r.b_velocity"], [*position, *velocity])))
        assert instance.get("der(r.a_velocity)", "der(r.b_velocity)") == pytest.approx(expected, rel=1e-10)
        assert instance.get("r.t_tendon") == pytest.approx(reference.data.ten_length[0], rel=1e-14)
        lengths.add(int(np.searchsorted([-0.3, 0.4], reference.data.ten_length[0])))
    assert lengths == {0, 1, 2}


def test_inertia_of_meshes(open_fmu):
    """MuJoCo stores the vertices of meshes in 32 bits, which limits the agreement."""
    check_accelerations("Meshed", MESHED, open_fmu("Meshed", kind=FMU2Model), 2e-6)


def test_joints_that_follow_others(open_fmu):
    """MuJoCo's constraint is soft; the reference reduces its mass matrix and forces to the velocities that the constraint allows."""
    reference, instance = Reference(COUPLED), open_fmu("Coupled", kind=FMU2Model)
    model, data = reference.model, reference.data
    share = np.array([[1.0, 0.0], [-0.5, 0.0], [0.0, 1.0]])
    random = np.random.default_rng(1)
    instance.initialize({})
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    names = fmu.states_of("Coupled")
    state, derivatives = (c_double * 4)(), (c_double * 4)()
    for _ in range(STATES):
        free, rates = random.uniform(-1, 1, 2), random.uniform(-2, 2, 2)
        data.qpos, data.qvel = [free[0], 0.2 + 0.1 - 0.5 * (free[0] - 0.3), free[1]], share @ rates
        data.ctrl = random.uniform(-3, 3, 2)
        mujoco.mj_forward(model, data)
        mass = np.zeros((3, 3))
        for i in range(3):  # columns of the mass matrix
            mujoco.mj_mulM(model, data, mass[i], np.eye(3)[i])
        forces = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        expected = np.linalg.solve(share.T @ mass @ share, share.T @ forces)
        instance.set({"r.pull_control": data.ctrl[0], "r.push_control": data.ctrl[1]})
        values = {"r.lead": free[0], "r.end": free[1], "r.lead_velocity": rates[0], "r.end_velocity": rates[1]}
        state[:] = [values[name] for name in names]
        instance.fmu.setContinuousStates(state, 4)
        enter_and_leave_events(instance)
        instance.fmu.getDerivatives(derivatives, 4)
        found = [derivatives[names.index(f"r.{name}_velocity")] for name in ("lead", "end")]
        assert np.max(np.abs(found - expected)) < 1e-10 * max(1, np.max(np.abs(expected)))


def test_actuators_with_states(open_fmu):
    """MuJoCo clips activations at their limits, so that the reference has none that passes them."""
    reference, random = Reference(DRIVEN), np.random.default_rng(1)
    model, data = reference.model, reference.data
    names, inputs = reference.names(), fmu.names_of("Driven", "input")
    states = [f"{inputs[i]}_activation" for i in range(model.nu) if model.actuator_actadr[i] >= 0]
    assert len(states) == model.na == 5
    for _ in range(STATES):
        reference.draw(random)
        data.act = random.uniform(-0.9, 0.9, model.na)
        mujoco.mj_forward(model, data)
        position, velocity, expected = reference.coordinates()
        start = dict(zip([*names, *(f"{name}_velocity" for name in names), *states, *inputs], [*position, *velocity, *data.act, *data.ctrl]))
        instance = open_fmu("Driven").initialize(start)
        assert instance.get(*(f"der({name}_velocity)" for name in names)) == pytest.approx(expected, rel=1e-10, abs=1e-10)
        assert instance.get(*(f"der({name})" for name in states)) == pytest.approx(data.act_dot, rel=1e-12, abs=1e-12)


class Links:
    """Constraints of a model's coupled tendons and their Jacobian, from MuJoCo's lengths, since MuJoCo's constraints are soft."""

    def __init__(self, reference):
        self.model, self.data = reference.model, reference.data
        self.start = self.lengths(self.model.qpos0)[0]

    def lengths(self, position):
        model, data = self.model, self.data
        data.qpos = position
        mujoco.mj_forward(model, data)
        rows = np.zeros((model.ntendon, model.nv))
        for row, first, count in zip(rows, model.ten_J_rowadr, model.ten_J_rownnz):
            row[model.ten_J_colind[first : first + count]] = data.ten_J[first : first + count]
        return data.ten_length.copy(), rows

    def evaluate(self, position):
        lengths, rows = self.lengths(position)
        powers = [np.polynomial.Polynomial(data[:5]) for data in self.model.eq_data]
        pairs = list(zip(self.model.eq_obj1id, self.model.eq_obj2id, powers))
        more = lengths - self.start
        return np.array([more[i] - power(more[j]) for i, j, power in pairs]), np.array([rows[i] - power.deriv()(more[j]) * rows[j] for i, j, power in pairs])


def test_tendons_that_follow_others(open_fmu):
    reference, random = Reference(LINKED), np.random.default_rng(1)
    links, model, data = Links(reference), reference.model, reference.data
    names = reference.names()
    names += [f"{name}_velocity" for name in names]
    for _ in range(STATES):
        reference.draw(random)
        instance = open_fmu("Linked").initialize(dict(zip(names, [*(0.4 * data.qpos), *data.qvel])))
        position, velocity = np.split(np.array(instance.get(*names)), 2)
        drift = (links.evaluate(position + 1e-5 * velocity)[1] - links.evaluate(position - 1e-5 * velocity)[1]) @ velocity / 2e-5
        residual, jacobian = links.evaluate(position)
        assert residual == pytest.approx(0, abs=1e-13) and jacobian @ velocity == pytest.approx(0, abs=1e-12)
        data.qvel = velocity
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        for row, unit in zip(mass, np.eye(model.nv)):
            mujoco.mj_mulM(model, data, row, unit)
        forces = data.qfrc_passive - data.qfrc_bias
        matrix = np.block([[mass, jacobian.T], [jacobian, np.zeros((len(residual), len(residual)))]])
        expected = np.linalg.solve(matrix, [*forces, *-drift])[: model.nv]
        found = instance.get(*(f"der({name})" for name in names[model.nv :]))
        assert np.max(np.abs(found - expected)) < 1e-8 * max(1, np.max(np.abs(expected)))


class Loops:
    """Constraints of a model's connects and welds: MuJoCo's are soft, but its Jacobians are exact."""

    def __init__(self, reference):
        self.model, self.data = reference.model, reference.data
        self.ends = [self.ends_of(i) for i in range(self.model.neq) if self.model.eq_active0[i]]

    def ends_of(self, i):
        """For a constraint: two bodies, each with a point and axes, and True if the axes are constrained."""
        model, data = self.model, self.model.eq_data[i]
        fixed, pair = model.eq_type[i] == mujoco.mjtEq.mjEQ_WELD, (model.eq_obj1id[i], model.eq_obj2id[i])
        if model.eq_objtype[i] == mujoco.mjtObj.mjOBJ_SITE:
            return [(model.site_bodyid[site], model.site_pos[site], Rotation.from_quat(model.site_quat[site], scalar_first=True)) for site in pair], fixed
        one = Rotation.identity()
        if not fixed:
            return [(pair[0], data[:3], one), (pair[1], data[3:6], one)], False
        posed = Rotation.from_quat(data[6:10], scalar_first=True)
        return [(pair[0], data[3:6] + posed.apply(data[:3]), posed), (pair[1], data[:3], one)], True

    def evaluate(self, position):
        """Residuals of the constraints, and their Jacobian."""
        self.data.qpos = position
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        lacks, rows = [], []
        for ends, fixed in self.ends:
            places, axes, moving, turning = [], [], [], []
            for body, point, rotated in ends:
                frame = self.data.xmat[body].reshape(3, 3)
                places.append(self.data.xpos[body] + frame @ point)
                axes.append(Rotation.from_matrix(frame) * rotated)
                jacobians = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
                mujoco.mj_jac(self.model, self.data, *jacobians, places[-1], body)
                moving.append(jacobians[0])
                turning.append(jacobians[1])
            lacks.append(places[1] - places[0])
            rows.append(moving[1] - moving[0])
            if fixed:
                lacks.append((axes[1] * axes[0].inv()).as_rotvec())
                rows.append(turning[1] - turning[0])
        return np.concatenate(lacks), np.concatenate(rows)

    def moved(self, position, velocity, time):
        result = np.array(position)
        mujoco.mj_integratePos(self.model, result, velocity, time)
        return result

    def closed(self, position):
        for _ in range(100):
            residual, jacobian = self.evaluate(position)
            position = self.moved(position, -np.linalg.pinv(jacobian, rcond=1e-9) @ residual, 0.5 if np.max(np.abs(residual)) > 0.5 else 1.0)
        assert np.max(np.abs(self.evaluate(position)[0])) < 1e-12
        return position

    def drift(self, position, velocity):
        """Rate of the Jacobian along the motion times the velocity, by differences of fourth order."""
        of = lambda time: self.evaluate(self.moved(position, velocity, time))[1] @ velocity
        h = 1e-3
        return (8 * (of(h) - of(-h)) - (of(2 * h) - of(-2 * h))) / (12 * h)


@pytest.mark.parametrize("name", EQUALITIES)
def test_loops(name, open_fmu):
    reference, instance = Reference(LOOPED.format(EQUALITIES[name])), open_fmu(name, kind=FMU2Model)
    loops, model, data, random = Loops(reference), reference.model, reference.data, np.random.default_rng(1)
    instance.initialize({})
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    states, names = fmu.states_of(name), reference.names()
    order = [states.index(joint) for joint in names]
    order += [states.index(f"{joint}_velocity") for joint in names]
    state, derivatives = (c_double * len(states))(), (c_double * len(states))()
    for _ in range(STATES):
        reference.draw(random)
        position, velocity = loops.closed(np.array(data.qpos)), np.array(data.qvel)
        jacobian = loops.evaluate(position)[1]
        velocity -= np.linalg.pinv(jacobian, rcond=1e-9) @ (jacobian @ velocity)
        drift = loops.drift(position, velocity)
        data.qpos, data.qvel = position, velocity
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        for i in range(model.nv):
            mujoco.mj_mulM(model, data, mass[i], np.eye(model.nv)[i])
        forces = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        zero = np.zeros((len(drift), len(drift)))
        data.qacc = np.linalg.lstsq(np.block([[mass, jacobian.T], [jacobian, zero]]), np.concatenate([forces, -drift]), rcond=1e-12)[0][: model.nv]
        place, rate, expected = reference.coordinates()
        instance.set(dict(zip(fmu.names_of(name, "input"), data.ctrl)))
        values = np.zeros(len(states))
        values[order] = [*place, *rate]
        state[:] = values
        instance.fmu.setContinuousStates(state, len(state))
        instance.fmu.getDerivatives(derivatives, len(derivatives))
        found = np.array(derivatives)[order][len(names) :]
        assert np.max(np.abs(found - expected)) < 1e-8 * max(1, np.max(np.abs(expected)))


def test_keyframe(open_fmu):
    """The states and controls of a key are those that MuJoCo sets."""
    reference, instance = Reference(LOOPED.format("")), open_fmu("Started")
    mujoco.mj_resetDataKeyframe(reference.model, reference.data, reference.model.key("home").id)
    instance.initialize({})
    position, velocity, _ = reference.coordinates()
    names = reference.names()
    assert [instance.get(name) for name in names] == pytest.approx(position, abs=1e-12)
    assert [instance.get(f"{name}_velocity") for name in names] == pytest.approx(velocity, abs=1e-12)
    assert [instance.get(name) for name in ("r.push_control", "r.e1_control")] == [0.3, 0.4]
