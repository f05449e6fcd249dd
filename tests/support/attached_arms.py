"""A robot whose file attaches others, and the same robot in one file, as MuJoCo 4.0.0 writes it by mj_saveLastXML."""

CUBE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
BOX = '<geom type="box" size="0.1 0.2 0.3"/>'
# In degrees, with other defaults than those of the arm.
TOP = f"""<mujoco model="top">
<default><joint damping="7" stiffness="2"/><geom density="200"/><default class="c"><joint frictionloss="1"/></default></default>
<asset><model name="arm" file="parts/arm.xml"/></asset>
<worldbody>
  <body name="base" childclass="c"><joint name="turn" axis="0 0 1"/>{BOX}
    <frame pos="0 0 1" euler="90 0 0"><attach model="arm" body="a" prefix="x_"/></frame>
    <replicate count="2" sep="-" offset="0 1 0"><attach model="arm" body="b1" prefix="y_"/></replicate>
  </body>
  <attach model="arm" prefix="z_"/>
</worldbody>
<actuator><motor name="first" joint="x_j"/></actuator></mujoco>"""
# In radians. The tip is in a third file, relative to this one.
ARM = f"""<mujoco model="arm"><compiler angle="radian" eulerseq="XYZ" meshdir="shapes"/><option gravity="1 0 0"/>
<default><joint damping="0.3"/><geom density="500"/><default class="k"><joint armature="0.1"/></default></default>
<asset><mesh file="cube.obj"/><model name="tip" file="more/tip.xml"/></asset>
<worldbody><site name="s0" pos="1 1 1"/><frame pos="0.5 0 0" euler="0 0 1">
  <body name="up" pos="0.1 0 0" childclass="k">{BOX}<joint name="lift" axis="0 1 0"/>
    <body name="a" pos="0.1 0.2 0.3" euler="0.3 0 0.4"><joint name="j" axis="0 1 0" ref="0.2"/><joint name="m" type="slide" class="main"/>{BOX}
      <replicate count="2" offset="0.3 0 0" euler="0 0 0.2"><body name="b" pos="0.2 0 0"><joint name="h" axis="1 0 0"/><geom type="mesh" mesh="cube" pos="0 0 0.1"/></body></replicate>
      <attach model="tip" body="t" prefix="t_"/>
    </body></body></frame></worldbody>
<tendon><fixed name="t" stiffness="3"><joint joint="j" coef="1"/><joint joint="h0" coef="2"/></fixed><fixed name="out"><joint joint="lift" coef="1"/><joint joint="h0" coef="2"/></fixed></tendon>
<equality><weld name="w" body1="world" body2="a"/></equality>
<actuator><motor name="m" joint="j"/><motor joint="h1"/><motor name="no" joint="lift"/><position name="mt" tendon="t" kp="2"/><motor name="mo" tendon="out"/><motor name="tip" joint="t_p"/></actuator>
<keyframe><key name="home" qpos="1"/></keyframe></mujoco>"""
TIP = f"""<mujoco model="tip"><default><joint damping="0.7"/></default><asset><mesh name="m" file="tip.obj"/></asset>
<worldbody><body name="t" euler="0 0 90"><joint name="p"/>{BOX}<geom type="mesh" mesh="m"/></body></worldbody><actuator><motor name="p" joint="p" gear="2"/></actuator></mujoco>"""


def box(density):
    return BOX.replace("/>", f' density="{density}"/>')


def finger(name, joint):
    return f'<body name="{name}" pos="0.2 0 0"><joint name="{joint}" axis="1 0 0" damping="0.3" armature="0.1"/><geom type="mesh" mesh="cube" density="500" pos="0 0 0.1"/></body>'


def arm(p):
    """The body a of the arm, whose joints have the armature of the class k, except for m."""
    fingers = finger(f"{p}b0", f"{p}h0") + f'<frame pos="0.3 0 0" euler="0 0 0.2">{finger(f"{p}b1", f"{p}h1")}</frame>'
    tip = f'<body name="{p}t_t" euler="0 0 1.5707963267948966"><joint name="{p}t_p" damping="0.7"/>{box(1000)}<geom type="mesh" mesh="tip"/></body>'
    joints = f'<joint name="{p}j" axis="0 1 0" ref="0.2" damping="0.3" armature="0.1"/><joint name="{p}m" type="slide" damping="0.3"/>'
    return f'<body name="{p}a" pos="0.1 0.2 0.3" euler="0.3 0 0.4">{joints}{box(500)}{fingers}{tip}</body>'


def tendon(name, first, second, more=""):
    return f'<fixed name="{name}" {more}><joint joint="{first}" coef="1"/><joint joint="{second}" coef="2"/></fixed>'


def motors(p, upper="", last=""):
    own = f'<motor name="{p}m" joint="{p}j"/><motor joint="{p}h1"/>{upper}<position name="{p}mt" tendon="{p}t" kp="2"/>{last}'
    return f'{own}<motor name="{p}tip" joint="{p}t_p"/><motor name="{p}t_p" joint="{p}t_p" gear="2"/>'


FLAT = f"""<mujoco model="top"><compiler angle="radian" eulerseq="XYZ"/>
<asset><mesh name="cube" file="parts/shapes/cube.obj"/><mesh name="tip" file="parts/more/tip.obj"/></asset>
<worldbody>
  <body name="base"><joint name="turn" axis="0 0 1" damping="7" stiffness="2" frictionloss="1"/>{box(200)}
    <frame pos="0 0 1" euler="1.5707963267948966 0 0">{arm("x_")}</frame>{finger("y_b1-0", "y_h1-0")}<frame pos="0 1 0">{finger("y_b1-1", "y_h1-1")}</frame>
  </body>
  <site name="z_s0" pos="1 1 1"/>
  <frame pos="0.5 0 0" euler="0 0 1"><body name="z_up" pos="0.1 0 0">{box(500)}<joint name="z_lift" axis="0 1 0" damping="0.3" armature="0.1"/>{arm("z_")}</body></frame>
</worldbody>
<tendon>{"".join(tendon(f"{p}t", f"{p}j", f"{p}h0", 'stiffness="3"') for p in ("x_", "z_"))}{tendon("z_out", "z_lift", "z_h0")}</tendon>
<equality><weld name="x_w" body1="world" body2="x_a"/><weld name="z_w" body1="world" body2="z_a"/></equality>
<actuator><motor name="first" joint="x_j"/>{motors("x_")}<motor joint="y_h1-0"/><motor joint="y_h1-1"/>
{motors("z_", '<motor name="z_no" joint="z_lift"/>', '<motor name="z_mo" tendon="z_out"/>')}</actuator></mujoco>"""


TEXTS = {"top.xml": TOP, "flat.xml": FLAT, "parts/arm.xml": ARM, "parts/more/tip.xml": TIP, "parts/shapes/cube.obj": CUBE, "parts/more/tip.obj": CUBE}
