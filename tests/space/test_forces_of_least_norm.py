"""
A box that sticks to the floor and to a wall with eight corners: 24 forces, of which its motion determines 6. Those of least norm follow from the
pseudo-inverse of the matrix that maps them to force and moment. They may not depend on the frame in which the quaternion describes the box.
"""

import numpy as np
import pytest

from building import build_systems

pytestmark = pytest.mark.long

MASS, SIZES, CENTRE, PUSH = 2.0, np.array([0.8, 0.6, 0.2]), np.array([0.1, -0.05, 0.0]), np.array([-30.0, 1.0, 0.0])
HALF = np.sqrt(0.5)
# Quaternion of the frame at the start, and the position of its origin from the middle of the box, in m along its axes.
FRAMES = {
    "Central": ((1, 0, 0, 0), (0, 0, 0)),
    "Rotated": ((HALF, HALF, 0, 0), (0, 0, 0)),
    "Shifted": ((1, 0, 0, 0), (3, 1, -2)),
    "RotatedAndShifted": ((0.5, 0.5, 0.5, 0.5), (0.3, -0.2, 0.5)),
}


def rotation(w, x, y, z):
    """Return the matrix of a unit quaternion."""
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * across + 2 * across @ across


def system(name):
    """The box stands on the floor z = 0, and touches the wall x = 0; its middle is at half its sizes above and beside them."""
    quaternion, origin = FRAMES[name]
    rotated = rotation(*quaternion)
    sizes, centre = np.abs(rotated.T @ SIZES), rotated.T @ CENTRE - origin
    start = np.array([SIZES[0] / 2, 0, SIZES[2] / 2]) + rotated @ origin
    coordinates = "".join(f'<coordinate name="{a}" velocity="v{a}" unit="m" start="{float(s)!r}"/>' for a, s in zip("xyz", start))
    coordinates += "".join(f'<coordinate name="q{i}" velocity="r{i}" unit="1" start="{float(q)!r}"/>' for i, q in enumerate(quaternion))
    at = lambda place: " ".join(f'{a}="{float(p)!r}"' for a, p in zip("xyz", place))
    return f"""<system name="{name}">
  <gravity z="-9.81"/>{coordinates}
  <frame name="own"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>
  <frame name="middle" in="own"><translate {at(-np.array(origin))}/></frame>
  <frame name="side"><rotate axis="y" angle="pi/2"/></frame>
  <body name="body" in="own" {at(centre)} mass="{MASS}" Ixx="0.1" Iyy="0.1" Izz="0.1"/>
  <shape name="box" in="middle" type="box" sizeX="{sizes[0]}" sizeY="{sizes[1]}" sizeZ="{sizes[2]}"/>
  <shape name="floor" type="plane"/><shape name="wall" in="side" type="plane"/>
  <contact name="below" between="box" and="floor" friction="5"/><contact name="beside" between="box" and="wall" friction="5"/>
  <point name="pushed" in="middle"/><force on="pushed" x="{PUSH[0]}" y="{PUSH[1]}"/>
</system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("least-norm", {name: system(name) for name in FRAMES})


def expected_forces():
    """Return the normal forces on floor and wall, sorted, and the squares of the friction forces in the same order."""
    corners = [np.array([x, y, z]) * SIZES / 2 for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    acting = [(corner, 2) for corner in corners if corner[2] < 0] + [(corner, 0) for corner in corners if corner[0] < 0]
    columns = [np.concatenate([along, np.cross(corner, along)]) for corner, _ in acting for along in np.eye(3)]
    weight = np.array([0, 0, -9.81 * MASS])
    load = np.concatenate([PUSH + weight, np.cross(CENTRE, weight)])
    forces = (np.linalg.pinv(np.transpose(columns)) @ -load).reshape(-1, 3)
    normal = np.array([force[axis] for force, (_, axis) in zip(forces, acting)])
    return [sorted(zip(part, (forces**2).sum(axis=1)[at] - part**2)) for at, part in ((slice(4), normal[:4]), (slice(4, 8), normal[4:]))]


@pytest.mark.parametrize("name", FRAMES)
def test_forces_do_not_depend_on_the_frame(open_fmu, name):
    instance = open_fmu(name)
    instance.initialize()
    instance.run(0.1, 0.05)
    for contact, expected in zip(("below", "beside"), expected_forces()):
        forces = np.array([instance.get(*(f"{contact}[{k}]{part}.force" for part in ("", ".friction", ".friction.across"))) for k in range(1, 9)])
        pressing = sorted((normal, first**2 + second**2) for normal, first, second in forces if normal > 0)
        assert np.array(pressing) == pytest.approx(np.array(expected), rel=1e-9)
    assert np.abs(instance.get("vx", "vy", "vz", "r0", "r1", "r2", "r3")).max() < 1e-12
