"""Forces of a fluid on bodies of MJCF, against closed forms; test_robots_in_mujoco.py compares a tree of bodies with MuJoCo."""

import math

import pytest

from building import build_systems

DENSITY, VISCOSITY, G, DURATION = 40.0, 0.6, 3.0, 1.5
SPHERE = f"""<mujoco model="m"><option viscosity="{VISCOSITY}" wind="0.5 0 0" gravity="0 0 {-G}"/><worldbody>
<body name="b"><freejoint/><geom size="0.2" mass="0.4"/></body></worldbody><keyframe><key name="k" qvel="0 1 0 0 0 2"/></keyframe></mujoco>"""
# Boxes of these half sides: one along its own axes, one whose geom is rotated, and one by a full tensor of inertia.
SIDES, MASS, TURN = (0.1, 0.2, 0.3), 2.0, 0.7
MOMENTS = [MASS * sum(side**2 for side in SIDES[:i] + SIDES[i + 1 :]) / 3 for i in range(3)]
SIZE = " ".join(map(str, SIDES))
C, S = math.cos(TURN), math.sin(TURN)
FULL = f"{C**2 * MOMENTS[0] + S**2 * MOMENTS[1]} {S**2 * MOMENTS[0] + C**2 * MOMENTS[1]} {MOMENTS[2]} {C * S * (MOMENTS[0] - MOMENTS[1])} 0 0"
BOXES = f"""<mujoco model="m"><compiler angle="radian"/><option density="{DENSITY}" gravity="0 0 0"/><worldbody>
<body name="straight"><freejoint/><geom type="box" size="{SIZE}" mass="{MASS}"/></body>
<body name="geom" pos="5 0 0"><freejoint/><geom type="box" size="{SIZE}" mass="{MASS}" euler="0 0 {TURN}"/></body>
<body name="full" pos="9 0 0"><freejoint/><inertial pos="0 0 0" mass="{MASS}" fullinertia="{FULL}"/></body>
<body name="spun" pos="-5 0 0"><freejoint/><geom type="box" size="{SIZE}" mass="{MASS}"/></body></worldbody>
<keyframe><key name="k" qvel="2 0 0 0 0 0 {2 * C} {2 * S} 0 0 0 0 {2 * C} {2 * S} 0 0 0 0 0 0 0 0 3 0"/></keyframe></mujoco>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    files = {"Sphere/m.xml": SPHERE, "Boxes/m.xml": BOXES}
    build_systems("in_a_fluid", {name: f'<system name="{name}"><include file="m.xml" as="m" keyframe="k"/></system>' for name in ("Sphere", "Boxes")}, files=files)


def test_a_sphere_in_a_viscous_wind(open_fmu):
    """Velocities relative to the wind decay by exp(-3 pi v d t/m), rotations by exp(-pi v d^3 t/I). The box of a sphere has the side d = sqrt(12/5) r."""
    instance = open_fmu("Sphere").initialize(tolerance=1e-10)
    instance.run(DURATION, 0.1)
    side = math.sqrt(2.4) * 0.2
    rate = 3 * math.pi * VISCOSITY * side / 0.4
    decayed = math.exp(-rate * DURATION)
    assert instance.get("m.b_x_velocity", "m.b_y_velocity", "m.b_z_velocity") == pytest.approx([0.5 * (1 - decayed), decayed, -G / rate * (1 - decayed)], rel=1e-7)
    assert instance.get("m.b_body.omegaZ") == pytest.approx(2 * math.exp(-math.pi * VISCOSITY * side**3 / (0.4 * 0.4 * 0.2**2) * DURATION), rel=1e-7)


@pytest.mark.parametrize("name, turn", [("straight", 0), ("geom", TURN), ("full", TURN)])
def test_drag_along_a_principal_axis(name, turn, open_fmu):
    """m u' = -c u^2 with c = density b_y b_z/2 gives u = u0/(1 + c u0 t/m), along the axis."""
    instance = open_fmu("Boxes").initialize(tolerance=1e-10)
    instance.run(DURATION, 0.1)
    speed = 2 / (1 + DENSITY * 2 * SIDES[1] * SIDES[2] * 2 * DURATION / MASS)
    assert instance.get(f"m.{name}_x_velocity", f"m.{name}_y_velocity", f"m.{name}_z_velocity") == pytest.approx([speed * math.cos(turn), speed * math.sin(turn), 0], abs=1e-8)


def test_drag_about_a_principal_axis(open_fmu):
    """I w' = -c w^2 with c = density b_y (b_x^4 + b_z^4)/64."""
    instance = open_fmu("Boxes").initialize(tolerance=1e-10)
    instance.run(DURATION, 0.1)
    x, y, z = (2 * side for side in SIDES)
    c = DENSITY * y * (x**4 + z**4) / 64
    assert instance.get("m.spun_body.omegaY") == pytest.approx(3 / (1 + c * 3 * DURATION / MOMENTS[1]), rel=1e-8)
