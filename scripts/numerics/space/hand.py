"""Convert the Shadow hand, which the Python package gymnasium-robotics has as MJCF, to one MJCF file and to a URDF of its tree."""

import importlib.util
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

from scipy.spatial.transform import Rotation


def source():
    """Return the path of the MJCF; None if the package or MuJoCo is not installed."""
    spec = importlib.util.find_spec("gymnasium_robotics")
    if spec is None or importlib.util.find_spec("mujoco") is None:
        return None
    return Path(spec.origin).parent / "envs" / "assets" / "hand" / "reach.xml"


def model():
    import mujoco

    return mujoco.MjModel.from_xml_path(str(source()))


def text():
    """Return the MJCF as one text without includes, shapes and dry friction, with explicit inertias of all bodies."""
    import mujoco

    with tempfile.NamedTemporaryFile(suffix=".xml") as file:
        mujoco.mj_saveLastXML(file.name, model())
        root = ET.parse(file.name).getroot()
    for parent in [*root.iter()]:
        for child in [*parent]:
            if (child.tag == "geom" and parent.tag in ("body", "worldbody")) or child.tag in ("mesh", "contact", "sensor"):
                parent.remove(child)
            child.attrib.pop("frictionloss", None)
    return ET.tostring(root, encoding="unicode")


def numbers(values):
    return " ".join(f"{value:.17g}" for value in values)


def placed(place, quaternion):
    """Return the <origin> of a position and a quaternion; rpy of URDF are rotations about fixed axes."""
    return f'<origin xyz="{numbers(place)}" rpy="{numbers(Rotation.from_quat(quaternion, scalar_first=True).as_euler("xyz"))}"/>'


def link(body):
    x, y, z = body.inertia
    inertia = f'<inertia ixx="{x:.17g}" iyy="{y:.17g}" izz="{z:.17g}" ixy="0" ixz="0" iyz="0"/>'
    return f'<link name="link{body.id}"><inertial>{placed(body.ipos, body.iquat)}<mass value="{body.mass[0]:.17g}"/>{inertia}</inertial></link>'


def joint(hand, body):
    """Return the joint of a body, which has one hinge through its origin, or none."""
    hinge = hand.joint(body.jntadr[0]) if body.jntnum[0] else None
    kind, axis = ("continuous", f'<axis xyz="{numbers(hinge.axis)}"/>') if hinge else ("fixed", "")
    assert hinge is None or not hinge.pos.any()
    ends = f'<parent link="link{body.parentid[0]}"/><child link="link{body.id}"/>'
    return f'<joint name="joint{body.id}" type="{kind}">{ends}{placed(body.pos, body.quat)}{axis}</joint>'


def urdf():
    """Return the URDF of the hand, without motors, tendons, and damping, stiffness and armature of joints."""
    hand = model()
    bodies = [hand.body(i) for i in range(1, hand.nbody)]
    parts = [link(body) + joint(hand, body) for body in bodies]
    return f'<robot name="shadow"><link name="link0"/>{"".join(parts)}</robot>'
