"""Robots whose links are meshes: search paths, contacts, drawings; mistakes in purely visual elements are no errors."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fmu
from building import build_systems
from fmu import lagc
from meshes import CUBE, SQUARES, obj_text, stl_text, triangles_of

INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
ORIGIN = '<origin xyz="0.1 0 0.05" rpy="0.2 0.1 0.3"/>'
CUBE_STL, CUBE_OBJ = stl_text(CUBE, triangles_of(CUBE)), obj_text(CUBE, SQUARES)
ROBOT = """<robot name="roller"><material name="sand"><color rgba="1 0.5 0 1"/></material>
  <link name="roller"><inertial><mass value="3"/>{INERTIA}</inertial>{}</link></robot>""".replace("{INERTIA}", INERTIA)
SYSTEM = '<system name="{}"><include file="{}" as="r" base="floating" ground="true"/></system>'
COLLISION = f'<collision>{ORIGIN}<geometry>{{}}</geometry></collision>'
SEEN = "<visual>{}<geometry>{}</geometry>{}</visual>"
MESH = '<mesh filename="package://roller_description/meshes/cube.stl" scale="0.4 0.6 -0.2"/>'
WITHOUT_GROUND = ' ground="true"'


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {"RollerOfBox": SYSTEM.format("RollerOfBox", "roller.urdf"), "RollerOfMesh": SYSTEM.format("RollerOfMesh", "a/urdf/roller.urdf")}
    files = {
        "RollerOfBox/roller.urdf": ROBOT.format(COLLISION.format('<box size="0.4 0.6 0.2"/>')),
        "RollerOfMesh/a/urdf/roller.urdf": ROBOT.format(COLLISION.format(MESH)),
        "RollerOfMesh/a/meshes/cube.stl": CUBE_STL,
    }
    build_systems("robots-with-meshes", texts, files=files)


def test_a_cube_is_a_box():
    """The force is the same in every position."""
    for i, turn in enumerate(Rotation.random(8, random_state=1)):
        forces = []
        for name in ("RollerOfBox", "RollerOfMesh"):
            x, y, z, w = turn.as_quat()
            instance = fmu.Instance(name, logging=False)
            try:
                instance.initialize({"r.base_z": 0.02 * i, "r.base_qw": w, "r.base_qx": x, "r.base_qy": y, "r.base_qz": z})
                forces.append(instance.get("r.roller_ground1.force"))
            finally:
                instance.free()
        assert forces[0] > 0 and forces[1] == pytest.approx(forces[0], rel=1e-9)


def scene_of_file(tmp_path, robot, system, ground):
    """The shapes drawn, and the messages of lagc."""
    (tmp_path / "system.xml").write_text(system.format("Told", robot).replace(*([WITHOUT_GROUND, ""] if not ground else ["", ""])))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    tree = ElementTree.parse(tmp_path / "out" / "modelDescription.xml")
    return [element for element in tree.iter() if element.tag in ("shape", "mesh") and element.get("type") != "plane"], result.stderr


def scene_of(tmp_path, parts, ground=False):
    (tmp_path / "robot.urdf").write_text(ROBOT.format(parts))
    return scene_of_file(tmp_path, "robot.urdf", SYSTEM, ground)


def test_visuals_are_drawn(tmp_path):
    """Visuals are drawn in their colours in place of collision shapes; a mesh used twice is stored once."""
    (tmp_path / "cube.obj").write_text(CUBE_OBJ)
    parts = COLLISION.format('<sphere radius="0.3"/>')
    parts += SEEN.format(ORIGIN, '<mesh filename="cube.obj"/>', '<material name="sand"/>') + SEEN.format("", '<mesh filename="file://cube.obj"/>', "")
    parts += SEEN.format("", '<box size="0.1 0.2 0.3"/>', '<material name=""><color rgba="0 0 2 0.5"/></material>')
    things, reported = scene_of(tmp_path, parts, ground=True)
    assert [thing.tag for thing in things] == ["mesh", "shape", "shape", "shape"] and "warning" not in reported
    assert [thing.get("color") for thing in things[1:]] == ["#ff8000ff", None, "#0000ff80"]
    assert things[1].get("mesh") == things[2].get("mesh") == things[0].get("id")
    assert [float(things[1].get(name)) for name in ("x", "z", "roll", "pitch", "yaw")] == pytest.approx([0.1, 0.05, 0.2, 0.1, 0.3])
    assert "roller_ground1.force" in (tmp_path / "out" / "modelDescription.xml").read_text()


@pytest.mark.parametrize("folder", ["roller_description/meshes", "meshes", "../roller_description/meshes", "../../meshes", "../meshes"])
def test_packages(tmp_path, folder):
    """Packages are found beside the robot's file and above, with the package's name and without."""
    home = tmp_path / "a" / "b"
    (home / folder).mkdir(parents=True)
    (home / folder / "cube.stl").write_text(CUBE_STL)
    things, reported = scene_of(home, COLLISION.format(MESH))
    assert [thing.tag for thing in things] == ["mesh", "shape"] and reported == ""


@pytest.mark.parametrize(
    "mesh, problem",
    [
        ('<mesh filename="package://nowhere/cube.stl"/>', "the mesh 'package://nowhere/cube.stl' does not exist; expected a path relative to this file, or"),
        ('<mesh filename="arm.dae"/>', "the mesh 'arm.dae' has an unknown format; expected STL or OBJ"),
        ('<mesh filename="short.stl"/>', "the mesh 'short.stl' is too short for STL"),
        ('<mesh filename="cube.obj" scale="1 2"/>', "the scale of a <mesh> is '1 2'; expected three numbers other than 0"),
        ('<mesh filename="cube.obj" scale="1 0 1"/>', "the scale of a <mesh> is '1 0 1'"),
        ("<mesh/>", "the mesh '' does not exist"),
        ('<box size="1 2"/>', None),
        ('<sphere radius="-1"/>', None),
        ('<box size="1 1 1"/><box size="2 1 1"/>', None),
        ("", None),
    ],
)  # fmt: skip
def test_visuals_that_are_wrong(tmp_path, mesh, problem):
    """A robot needs no visuals; its collision shapes are drawn instead."""
    for name, text in {"arm.dae": "<COLLADA/>", "short.stl": "", "cube.obj": CUBE_OBJ}.items():
        (tmp_path / name).write_text(text)
    good = SEEN.format("", '<sphere radius="0.2"/>', "")
    things, reported = scene_of(tmp_path, COLLISION.format('<sphere radius="0.3"/>') + SEEN.format("", mesh, "") + good)
    assert [thing.get("radius") for thing in things] == ["0.3"] and "depend on them: visual (included" in reported
    assert problem is None or f"1 mesh is not drawn; the first: {problem}" in reported
    things, reported = scene_of(tmp_path, SEEN.format("", mesh, "") + good)
    assert [thing.get("radius") for thing in things] == ["0.2"]


def test_meshes_without_contact(tmp_path):
    """A flat mesh is drawn without contact; a round one has contact at some of its vertices, with a message."""
    (tmp_path / "cube.obj").write_text(obj_text(CUBE * [1, 1, 0], SQUARES))
    things, reported = scene_of(tmp_path, COLLISION.format('<mesh filename="cube.obj"/>'))
    assert len(things) == 2 and reported == ""
    things, reported = scene_of(tmp_path, COLLISION.format('<mesh filename="cube.obj"/>'), ground=True)
    assert things == [] and "a <collision> of the link 'roller' touches nothing: the mesh 'cube.obj' is flat; expected a volume" in reported
    ball = np.random.default_rng(1).normal(size=(200, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    (tmp_path / "cube.obj").write_text(obj_text(ball, triangles_of(ball)))
    things, reported = scene_of(tmp_path, COLLISION.format('<mesh filename="cube.obj"/>'), ground=True)
    assert len(things) == 2 and re.search(r"touches at 32 of them; it reaches up to 0\.\d+ m beyond these", reported)


MJCF = """<mujoco model="roller"><compiler meshdir="parts"/>
<asset><mesh name="cube" file="cube.stl" scale="0.4 0.6 -0.2"/><mesh file="cube.stl"/><mesh name="lost" file="lost.stl"/><material name="sand" rgba="1 0.5 0 1"/></asset>
<worldbody><body name="roller"><freejoint/><inertial mass="3" diaginertia="1 1 1"/>{}</body></worldbody></mujoco>"""
MJCF_SYSTEM = SYSTEM.replace(' base="floating"', "")


def mjcf_scene_of(tmp_path, parts, ground=False):
    (tmp_path / "parts").mkdir(exist_ok=True)
    (tmp_path / "parts" / "cube.stl").write_text(CUBE_STL)
    (tmp_path / "robot.xml").write_text(MJCF.format(parts))
    return scene_of_file(tmp_path, "robot.xml", MJCF_SYSTEM, ground)


def test_geoms_that_are_meshes(tmp_path):
    """Geoms without contact are drawn in place of those with contact; colours are those of geoms and materials."""
    seen = '<geom type="mesh" mesh="cube" contype="0" conaffinity="0" material="sand" pos="0.1 0 0"/><geom contype="0" conaffinity="0" size="0.1" rgba="0 0 1 0.5"/>'
    things, reported = mjcf_scene_of(tmp_path, f'{seen}<geom type="mesh" mesh="cube"/>', ground=True)
    assert [(thing.tag, thing.get("color")) for thing in things] == [("mesh", None), ("shape", "#ff8000ff"), ("shape", "#0000ff80")] and reported == ""
    assert float(things[1].get("x")) == 0.1
    variables = (tmp_path / "out" / "modelDescription.xml").read_text()
    assert "r.roller_ground1.force" in variables and "r.roller_ground2.force" not in variables


# Sides 0.2, 0.4 and 0.6 m, the longest one along y: half of them are those of the box to which shapes are fitted.
FITTED = """<mujoco model="fitted"><compiler fitaabb="{}"/><asset><mesh name="cube" file="cube.stl" scale="0.4 0.6 -0.2"/></asset>
<worldbody><body name="part"><joint name="j" {} stiffness="1"/><geom type="{}" mesh="cube" pos="{}" fitscale="2"/></body></worldbody></mujoco>"""
AXIS, SLIDE = 'axis="0 1 0"', 'type="slide"'


def inertia_of_fitted(tmp_path, shape, joint, bounds="false"):
    """The mass or the moment of inertia about the joint: 1 N/m or N.m/rad accelerates it by 1 over that."""
    center = np.mean(CUBE, axis=0) * [0.4, 0.6, -0.2]
    (tmp_path / "cube.stl").write_text(CUBE_STL)
    (tmp_path / "robot.xml").write_text(FITTED.format(bounds, joint, shape, " ".join(map(str, -center))))
    result = lagc("--linearize", "robot.xml", cwd=tmp_path)
    if result.returncode != 0:
        return result.stderr
    rows = [line for line in result.stdout.splitlines() if line.strip().startswith("[")]
    return -1 / float(rows[-1].strip(" []").split(",")[0])


@pytest.mark.parametrize(
    "shape, volume, turning",
    [
        ("box", 8 * 0.2 * 0.4 * 0.6, (0.2**2 + 0.4**2) / 3),
        ("ellipsoid", 4 / 3 * np.pi * 0.2 * 0.4 * 0.6, (0.2**2 + 0.4**2) / 5),
        ("sphere", 4 / 3 * np.pi * 0.4**3, 2 / 5 * 0.4**2),
        ("cylinder", np.pi * 0.3**2 * 1.2, 0.3**2 / 2),
    ],
)
def test_shapes_that_are_fitted_to_meshes(shape, volume, turning, tmp_path):
    """Those of MuJoCo: the means of the sides of the box, twice as large by fitscale; the longest one is the axis."""
    mass = 1000 * volume
    assert inertia_of_fitted(tmp_path, shape, SLIDE) == pytest.approx(mass, rel=1e-5)
    assert inertia_of_fitted(tmp_path, shape, AXIS) == pytest.approx(mass * turning, rel=1e-5)


def test_a_capsule_that_is_fitted_to_a_mesh(tmp_path):
    """The straight part is shorter than the longest side by half a radius at each end."""
    radius, half = 0.3, 0.6 - 0.15
    ball, rod = 1000 * 4 / 3 * np.pi * radius**3, 1000 * np.pi * radius**2 * 2 * half
    assert inertia_of_fitted(tmp_path, "capsule", SLIDE) == pytest.approx(ball + rod, rel=1e-5)
    assert inertia_of_fitted(tmp_path, "capsule", AXIS) == pytest.approx(ball * 2 / 5 * radius**2 + rod * radius**2 / 2, rel=1e-5)


def test_shapes_that_are_fitted_to_bounds(tmp_path):
    assert 'robot.xml:2: a <geom> of type box is fitted to a mesh by fitaabb="true", which is not read' in inertia_of_fitted(tmp_path, "box", SLIDE, "true")


def test_one_warning_for_all_lost_meshes(tmp_path):
    lost = "".join(COLLISION.format(f'<mesh filename="lost{i}.obj"/>') for i in range(3))
    report = scene_of(tmp_path, lost + COLLISION.format('<sphere radius="0.3"/>'), ground=True)[1]
    assert report.count("touches nothing: the mesh 'lost") == 1 and "; 2 other shapes touch nothing either" in report


def test_meshes_of_mjcf_that_are_lost(tmp_path):
    """Missing meshes give a message, and an error only if the motion depends on them."""
    loss = '<geom type="mesh" mesh="lost"/>'
    assert "1 mesh is not drawn; the first: the mesh 'parts/lost.stl' does not exist" in mjcf_scene_of(tmp_path, loss)[1]
    assert "a <geom> of type mesh of the body 'roller' touches nothing: the mesh 'parts/lost.stl' does not exist" in mjcf_scene_of(tmp_path, loss, ground=True)[1]
    (tmp_path / "robot.xml").write_text(MJCF.replace("<inertial", "<site").replace("mass=", "name=").replace(' diaginertia="1 1 1"', "").format(loss))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and "robot.xml:3: the inertia of a <geom> of type mesh is not known: the mesh 'parts/lost.stl' does not exist" in result.stderr


@pytest.mark.parametrize("ground", [False, True])
def test_a_mesh_of_mjcf_touches_as_that_of_urdf(ground, tmp_path):
    (tmp_path / "cube.stl").write_text(CUBE_STL)
    urdf, _ = scene_of(tmp_path, '<collision><geometry><mesh filename="cube.stl" scale="0.4 0.6 -0.2"/></geometry></collision>', ground)
    mjcf, _ = mjcf_scene_of(tmp_path, '<geom type="mesh" mesh="cube"/>', ground)
    assert [{key: value for key, value in thing.items() if key not in ("name", "in")} for thing in urdf] == [
        {key: value for key, value in thing.items() if key not in ("name", "in")} for thing in mjcf
    ]
