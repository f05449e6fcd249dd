"""Meshes as shapes: a cube against a box, depths of hulls against SciPy's, rest on a face, and messages for invalid files."""

import ctypes
import re
import subprocess
from itertools import product

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import fmu
from building import BUILD, ROOT, alone, build_systems
from fmu import lagc
from meshes import CUBE, SQUARES, TETRAHEDRON, msh_bytes, obj_text, stl_bytes, stl_text, triangles_of

FREE = """<coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="z" velocity="vz" unit="m"/>
  <coordinate name="q0" velocity="r0" unit="1" start="1"/><coordinate name="q1" velocity="r1" unit="1"/><coordinate name="q2" velocity="r2" unit="1"/>
  <coordinate name="q3" velocity="r3" unit="1"/><frame name="f"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>"""
DROP = """<system name="{}"><parameter name="k" start="1e5" unit="N/m"/>{}<gravity z="-9.81"/>
  <body name="b" in="f" mass="2" Ixx="{inertia}" Iyy="{inertia}" Izz="{inertia}"/>
  <shape name="s" in="f" {}/><shape name="floor" type="plane"/>
  <contact name="touch" between="s" and="floor" stiffness="k" damping="2" friction="0.5"/><experiment stopTime="1" stepSize="0.01"/></system>"""
CRATES = {
    "CrateOfBox": 'type="box" sizeX="0.4" sizeY="0.6" sizeZ="0.2" z="0.03" roll="0.2"',
    "CrateOfStl": 'type="mesh" file="cube.stl" scale="0.4 0.6 0.2" z="0.03" roll="0.2"',
    "CrateOfMsh": 'type="mesh" file="cube.msh" scale="0.4 0.6 0.2" z="0.03" roll="0.2"',
    "CrateOfObj": 'type="mesh" file="cube.OBJ" scale="-0.4 0.6 0.2" z="0.03" roll="0.2"',
}
# More points than hull vertices, in random order, and one that no triangle uses.
STONE = np.random.default_rng(7).normal(size=(40, 3)) * [0.3, 0.2, 0.1]
FILES = {
    "CrateOfStl/cube.stl": stl_text(CUBE, triangles_of(CUBE)),
    "CrateOfMsh/cube.msh": msh_bytes(CUBE, triangles_of(CUBE)),
    "CrateOfObj/cube.OBJ": obj_text(CUBE, SQUARES, -8),
    "Stone/stone.obj": obj_text(np.vstack([STONE, [[9, 9, 9]]]), triangles_of(STONE)),
    "Die/die.stl": stl_text(TETRAHEDRON, triangles_of(TETRAHEDRON)),
}


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: DROP.format(name, FREE, shape, inertia="0.05") for name, shape in CRATES.items()}
    texts["Stone"] = DROP.format("Stone", FREE, 'type="mesh" file="stone.obj"', inertia="0.05").replace('damping="2"', "")
    texts["Die"] = DROP.format("Die", FREE, 'type="mesh" file="die.stl" scale="0.5"', inertia="2*0.5^2/20")
    build_systems("meshes", texts, files=FILES)


def started(name, place, turn):
    x, y, z, w = turn.as_quat()
    instance = fmu.Instance(name, logging=False)
    instance.initialize(dict(zip(("x", "y", "z", "q0", "q1", "q2", "q3"), (*place, w, x, y, z))))
    return instance


def test_a_cube_is_a_box():
    """A text file, and squares with relative indices; a mirror reverses the orientation of triangles."""
    ends = []
    for name in CRATES:
        instance = started(name, [0, 0, 0.4], Rotation.from_euler("xyz", [0.3, 0.5, 0.1]))
        try:
            pressed = 0.0
            while instance.time < 0.299:
                instance.run(instance.time + 0.005, 0.005)
                pressed = max(pressed, instance.get("touch.force"))
            assert pressed > 100
            ends.append([instance.get(variable) for variable in ("z", "vx", "vz", "q0", "r1")])
        finally:
            instance.free()
    assert ends[1] == pytest.approx(ends[0], rel=1e-5, abs=1e-5) and ends[2] == pytest.approx(ends[0], rel=1e-5, abs=1e-5)


def test_depths():
    """The force is that of the hull's vertices, in many positions."""
    corners, chance = STONE[ConvexHull(STONE).vertices], np.random.default_rng(3)
    assert 8 < len(corners) < 32
    for turn in Rotation.random(20, random_state=5):
        place = [0, 0, chance.uniform(0, 0.2)]
        depths = -np.minimum(0, (place + turn.apply(corners))[:, 2])
        instance = started("Stone", place, turn)
        try:
            assert instance.get("touch.force") == pytest.approx(1e5 * depths.sum(), rel=1e-9, abs=1e-6)
        finally:
            instance.free()


def test_a_tetrahedron_comes_to_rest():
    """It comes to rest on a face, with its centre at the radius of the inscribed sphere, less the penetration of three vertices."""
    instance = started("Die", [0, 0, 0.4], Rotation.from_euler("xyz", [0.4, 0.2, 0]))
    try:
        instance.run(4.0, 0.01)
        weight = 2 * 9.81
        assert instance.get("touch.force") == pytest.approx(weight, rel=1e-4)
        assert instance.get("z") == pytest.approx(0.5 / np.sqrt(24) - weight / 3e5, abs=1e-6)
    finally:
        instance.free()


class Mesh(ctypes.Structure):
    _fields_ = [("points", ctypes.c_void_p), ("point_count", ctypes.c_size_t), ("triangles", ctypes.c_void_p), ("triangle_count", ctypes.c_size_t),
                ("corners", ctypes.c_size_t * 32), ("corner_count", ctypes.c_size_t), ("residual", ctypes.c_double)]  # fmt: skip


@pytest.fixture(scope="module")
def library():
    """Compile the room of lagc that reads meshes as a library."""
    sources = [*(ROOT / "src/import/meshes").glob("*.c"), *(ROOT / f"src/compiler/model/{name}.c" for name in ("mesh", "hull"))]
    sources += [ROOT / f"src/compiler/base/{name}.c" for name in ("memory", "paths", "platform", "sorting")]
    path = BUILD / "meshes" / "room.so"
    with alone(BUILD / "meshes" / "room.lock"):
        subprocess.run(["gcc", "-O2", "-shared", "-fPIC", "-D_XOPEN_SOURCE=700", f"-I{ROOT}/src/compiler", f"-I{ROOT}/src/import", *sources, "-lm", "-o", path], check=True)
    return ctypes.CDLL(path)


def corners_of(library, points):
    """Hull vertices and the residual, the distance of points beyond their hull; none for flat meshes."""
    points = np.ascontiguousarray(points, dtype=float)
    mesh = Mesh(points=points.ctypes.data, point_count=len(points))
    found = library.mesh_find_corners(ctypes.byref(mesh)) & 0xFF
    assert bool(found) == (mesh.corner_count > 0)
    return list(mesh.corners[: mesh.corner_count]), mesh.residual


def grid_on_cube(count):
    """Points on the faces of a cube, with repeated points on edges and corners; the corners come first."""
    marks = np.linspace(-0.5, 0.5, count)
    faces = [np.roll([side, a, b], axis) for axis in range(3) for side in (-0.5, 0.5) for a, b in product(marks, marks)]
    return np.vstack([CUBE, faces])


def test_hulls(library):
    """The vertices are SciPy's at any position and scale, except those within the tolerance of the others' hull."""
    chance, left_out = np.random.default_rng(11), 0
    for i in range(300):
        points = chance.normal(size=(chance.integers(4, 25), 3)) * chance.uniform(0.1, 1, 3)
        points = (points + chance.normal(size=3)) * 10.0 ** chance.integers(-4, 5)
        corners, residual = corners_of(library, np.vstack([points, points[::-1]]))
        planes, tolerance = ConvexHull(points[corners]).equations, 1e-5 * np.ptp(points, axis=0).max()
        missing = set(ConvexHull(points).vertices) - set(corners)
        assert set(corners) <= set(ConvexHull(points).vertices) and residual <= tolerance, i
        assert all((planes[:, :3] @ points[k] + planes[:, 3]).max() < 1.1 * tolerance for k in missing), i
        left_out += len(missing)
    assert left_out < 3


def test_hulls_of_planes(library):
    """
    However many points lie on faces and edges, the hull vertices are the corners of the cube. This also holds for a rotated cube, and for one whose
    faces bulge by half the tolerance.
    """
    points = grid_on_cube(12)
    bulging = points * (1 + 5e-6 * np.prod(1 - np.sort(np.abs(2 * points))[:, :2] ** 2, axis=1, keepdims=True))
    for turn, solid in product([Rotation.identity(), *Rotation.random(20, random_state=2)], (points, bulging)):
        found, _ = corners_of(library, turn.apply(solid) + 0.3)
        assert sorted(map(tuple, np.round(points[found], 3))) == sorted(map(tuple, CUBE))
    for flat in (points[:, :] * [1, 1, 0], points * [1, 0, 0], points * 0 + 0.3, points * [1, 1, 1e-6]):
        for turn in [Rotation.identity(), *Rotation.random(3, random_state=2)]:
            assert corners_of(library, turn.apply(flat))[0] == []


def test_hulls_of_many_points(library):
    """The hull has at most 32 vertices; the residual is the distance of points beyond it."""
    points = np.random.default_rng(4).normal(size=(3000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    corners, residual = corners_of(library, points)
    planes = ConvexHull(points[corners]).equations
    assert len(corners) == 32
    assert residual == pytest.approx((points @ planes[:, :3].T + planes[:, 3]).max(), rel=1e-4)
    assert residual < 0.2


def written(tmp_path, name, content, more=""):
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    text = DROP.format("Told", FREE, f'type="mesh" file="{name}"{more}', inertia="1")
    (tmp_path / "system.xml").write_text(text)
    return lagc("system.xml", "-o", "out", cwd=tmp_path)


def test_text_and_binary_are_the_same(tmp_path):
    """Text and binary files give identical results; other content gives another GUID."""
    points, triangles = np.float32(STONE).astype(float), triangles_of(STONE)
    guids = []
    for content in (stl_text(points, triangles), stl_bytes(points, triangles), b"solid" + stl_bytes(points, triangles)[5:], stl_bytes(2 * points, triangles)):
        assert written(tmp_path, "a.stl", content).returncode == 0
        guids.append(re.search('guid="(.*?)"', (tmp_path / "out" / "modelDescription.xml").read_text())[1])
    assert guids[0] == guids[1] == guids[2] != guids[3]


STL, OBJ = stl_text(CUBE, triangles_of(CUBE)), obj_text(CUBE, SQUARES)
BYTES, MSH = stl_bytes(CUBE, triangles_of(CUBE)), msh_bytes(CUBE, triangles_of(CUBE))


@pytest.mark.parametrize(
    "name, content, message",
    [
        ("a.dae", "", "the mesh 'a.dae' has an unknown format; expected STL or OBJ"),
        ("a.stl", "", "is too short for STL"),
        ("a.stl", "solid a\nendsolid a\n", "the mesh 'a.stl' is empty; expected triangles"),
        ("a.stl", STL[: STL.rindex("endfacet")], "is cut short in line 85; expected endsolid at its end"),
        ("a.stl", STL.replace("-0.5", "nan", 1), "has in line 4 'nan' as a coordinate; expected three finite numbers"),
        ("a.stl", STL.replace("endloop", "vertex 0 0 0\nendloop", 1), "has a facet of 4 corners, which ends in line 9; expected triangles"),
        ("a.stl", STL.replace("outer", "vortex", 1), "has 'vortex' in line 3; expected STL"),
        ("a.stl", BYTES[:-1], "is cut short: it has 12 triangles in its header, and 11 after it"),
        ("a.stl", BYTES[:80] + b"\xff\xff\xff\xff" + BYTES[84:], "is cut short: it has 4294967295 triangles in its header, and 12 after it"),
        ("a.stl", BYTES[:96] + b"\x00\x00\xc0\x7f" + BYTES[100:], "has the coordinate nan in triangle 1; expected finite numbers"),
        ("a.msh", "", "has 0 bytes, and by its header 16; expected MSH"),
        ("a.msh", MSH[:-1], f"has {len(MSH) - 1} bytes, and by its header {len(MSH)}; expected MSH"),
        ("a.msh", b"\xff\xff\xff\xff" + MSH[4:], f"has {len(MSH)} bytes, and by its header 515396"),
        ("a.msh", MSH[:16] + b"\x00\x00\x80\x7f" + MSH[20:], "has the coordinate inf in vertex 1; expected finite numbers"),
        ("a.msh", MSH[:-4] + b"\x08\x00\x00\x00", "has the vertex 8 in face 12, of 8; expected numbers from 0"),
        ("a.obj", "v 0 0 0\n", "the mesh 'a.obj' is empty; expected triangles"),
        ("a.obj", OBJ.replace("f 1 ", "f 9 "), "has the corner '9' in line 9; expected the number of a point above it, from 1 to 8"),
        ("a.obj", OBJ.replace("f 1 ", "f 0 "), "has the corner '0' in line 9"),
        ("a.obj", OBJ.replace("f 1 ", "f -9 "), "has the corner '-9' in line 9"),
        ("a.obj", OBJ + "f 1 2\n", "has a polygon of 2 corners in line 15; expected three or more"),
        ("a.obj", OBJ.replace("-0.5", "1e999", 1), "has in line 1 '1e999' as a coordinate"),
        ("a.obj", OBJ.replace("0.5", "1e12"), "reaches beyond 1e9 m"),
        ("a.obj", obj_text(CUBE * [1, 1, 0], SQUARES), "the mesh of the shape 's' is flat, and cannot touch"),
    ],
)  # fmt: skip
def test_files_that_are_wrong(name, content, message, tmp_path):
    result = written(tmp_path, name, content)
    assert result.returncode == 1 and message in result.stderr and result.stderr.count("\n") == 1, result.stderr


def test_files_of_other_programs(tmp_path):
    """
    lagc reads comments, colours, textures and normals, continued lines, capital letters, Windows line ends, points after the polygons, and
    relative indices.
    """
    lines = [f"v {x} {y} {z} 0.5 0.5 0.5" for x, y, z in CUBE]
    text = "# made\r\nmtllib a.mtl\r\no cube\r\n" + "\r\n".join(lines) + "\r\nvn 0 0 1\r\nvt 0 0\r\ns off\r\nusemtl red\r\n"
    text += "".join(f"f {a + 1}/1/1 {b + 1}//1 \\\r\n {c + 1}/1 {d + 1} # a square\r\n" for a, b, c, d in SQUARES)
    assert written(tmp_path, "a.obj", text + "v 7 7 7").returncode == 0
    scene = (tmp_path / "out" / "modelDescription.xml").read_text()
    for content in (OBJ, obj_text(CUBE, SQUARES, -8)):
        assert written(tmp_path, "a.obj", content).returncode == 0
        assert scene == (tmp_path / "out" / "modelDescription.xml").read_text()
    assert written(tmp_path, "a.stl", STL.upper().replace("SOLID", "solid", 1)).returncode == 0


@pytest.mark.parametrize(
    "attributes, message",
    [
        ('type="mesh" file="none.stl"', "the mesh 'none.stl' cannot be read: No such file or directory; expected an STL or OBJ file"),
        ('type="mesh"', "the mesh 's' has no file"),
        ('type="mesh" file="a.stl" scale="0"', 'scale="0" of <shape> is not valid; expected a number other than 0, or three'),
        ('type="mesh" file="a.stl" scale="1 2"', 'scale="1 2" of <shape> is not valid; expected a number other than 0, or three'),
        ('type="mesh" file="a.stl" scale="1e-12"', "no further than 1e-9 m; expected another scale"),
        ('type="mesh" file="a.stl" radius="1"', "the shape 's' is a mesh, which has no radius"),
        ('type="sphere" radius="1" file="a.stl"', "the shape 's' is a sphere, which has no file"),
        ('type="sphere" radius="1" color="red"', 'color="red" of <shape> is not a color; expected one such as #ff8000'),
    ],
)
def test_messages(attributes, message, tmp_path):
    (tmp_path / "a.stl").write_text(STL)
    (tmp_path / "system.xml").write_text(DROP.format("Told", FREE, attributes, inertia="1"))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr and "Sanitizer" not in result.stderr, result.stderr


def test_planes_alone(tmp_path):
    """A mesh has contacts with planes only, not with spheres or other meshes."""
    (tmp_path / "a.stl").write_text(STL)
    text = DROP.format("Told", FREE, 'type="mesh" file="a.stl"', inertia="1").replace('name="floor" type="plane"', 'name="floor" type="sphere" radius="1"')
    (tmp_path / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and "there is no <contact> between 's' and 'floor', of which one is a mesh; expected a plane for it" in result.stderr


