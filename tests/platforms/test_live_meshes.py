"""Meshes on the page in which an FMU runs, in headless Chromium: every triangle has the position of the file, and its colour."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fmu
from building import build_systems
from driven_chromium import COLORS_SEEN, chromium, opened
from meshes import TETRAHEDRON, obj_text, stl_text, triangles_of
from scripts.library.live_page.editor import files_of
from scripts.library.live_page.page import page_of
from scripts.library.problem import Problem

# More triangles than the page draws.
ANGLES = np.meshgrid(np.linspace(0, 2 * np.pi, 101)[:-1], np.linspace(0, 2 * np.pi, 61)[:-1])
RING = np.stack([(0.4 + 0.1 * np.cos(ANGLES[1])) * np.cos(ANGLES[0]), (0.4 + 0.1 * np.cos(ANGLES[1])) * np.sin(ANGLES[0]), 0.1 * np.sin(ANGLES[1])], -1)
SQUARES = [[100 * i + j, 100 * i + (j + 1) % 100, 100 * ((i + 1) % 60) + (j + 1) % 100, 100 * ((i + 1) % 60) + j] for i in range(60) for j in range(100)]
DRAWN = """<system name="Drawn"><coordinate name="z" velocity="v" unit="m" start="1"/><frame name="f"><translate z="z"/></frame>
  <body name="b" in="f" mass="2" Ixx="1" Iyy="1" Izz="1"/><gravity z="-0.1"/>
  <shape name="die" in="f" type="mesh" file="die.stl" scale="0.5 0.5 -0.5" x="0.1" roll="0.3" yaw="0.5" color="#e02080"/>
  <shape name="ring" in="f" type="mesh" file="ring.obj" z="-0.2" color="#20c04080"/><shape name="twin" type="mesh" file="ring.obj" x="1.2"/>
  <shape name="ball" in="f" type="sphere" radius="0.1" drawn="false"/>
  <experiment stopTime="1" stepSize="0.01"/></system>"""
MESHES = """() => live.scene.shapes.map((shape) => {
  const mesh = live.scene.meshOfShape(shape, 0);
  mesh.updateMatrixWorld(true);
  const drawn = mesh.children[0].children[0], at = drawn.geometry.attributes.position, index = drawn.geometry.index;
  const point = (i) => new THREE.Vector3().fromBufferAttribute(at, i).applyMatrix4(drawn.matrixWorld).toArray();
  return { corners: Array.from(index.array, point), color: drawn.material.color.getHexString(), opacity: drawn.material.opacity };
})"""


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    build_systems("drawn", {"Drawn": DRAWN}, files={"Drawn/die.stl": stl_text(TETRAHEDRON, triangles_of(TETRAHEDRON)), "Drawn/ring.obj": obj_text(RING.reshape(-1, 3), SQUARES)})
    file = tmp_path_factory.mktemp("live") / "Drawn.html"
    file.write_text(page_of(fmu.archive("Drawn")), encoding="utf-8")
    with chromium() as browser, opened(browser, file) as page:
        yield page


def test_triangles(page):
    """All triangles of a small mesh, to a 65536th of its size; those of a large one lie on it. Shapes that are not drawn are absent."""
    die, ring, twin = page.evaluate(MESHES)
    faces = np.array(TETRAHEDRON)[triangles_of(TETRAHEDRON)] * [0.5, 0.5, -0.5]
    rotated = Rotation.from_euler("xyz", [0.3, 0, 0.5]).apply(faces.reshape(-1, 3)) + [0.1, 0, 0]
    drawn = np.array(die["corners"]).reshape(-1, 3, 3)
    for face in rotated.reshape(-1, 3, 3):
        assert min(np.abs(np.roll(face[::-1], k, axis=0) - other).max() for other in drawn for k in range(3)) < 1e-5
    assert len(drawn) == 4 and (die["color"], die["opacity"]) == ("e02080", 1)
    corners = np.array(ring["corners"]) + [0, 0, 0.2]
    assert np.abs(np.hypot(np.hypot(corners[:, 0], corners[:, 1]) - 0.4, corners[:, 2]) - 0.1).max() < 1e-4
    sides = corners.reshape(-1, 3, 3)
    area = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1).sum() / 2
    assert 1000 < len(sides) <= 4000 and area == pytest.approx(4 * np.pi**2 * 0.4 * 0.1, rel=0.05)
    assert ring["color"] == "20c040" and ring["opacity"] == pytest.approx(128 / 255)
    assert twin["corners"] != ring["corners"] and len(twin["corners"]) == len(ring["corners"])
    assert page.evaluate(COLORS_SEEN) > 100


def test_a_page_that_changes_systems(tmp_path):
    (tmp_path / "die.stl").write_bytes(b"\xff")
    (tmp_path / "system.xml").write_text(DRAWN)
    with pytest.raises(Problem, match="system.xml uses the mesh die.stl, which an editable page cannot contain"):
        files_of(tmp_path / "system.xml")
