"""Rods, joints and surfaces that lagc writes to <scene>, against the systems."""

import xml.etree.ElementTree as ElementTree

import pytest

import fmu

HEAD = '<system name="Held"><parameter name="l" start="2"/><parameter name="g" start="9.81"/>'


def scene_of(path, folder):
    result = fmu.lagc(path, "-o", folder)
    assert (result.returncode, result.stderr) == (0, "")
    return ElementTree.parse(folder / "modelDescription.xml").getroot().find("VendorAnnotations/Tool/scene")


def test_joints_of_a_linkage(tmp_path):
    """Crank, coupler and rocker of lengths a, b, c on pivots d apart; loopX and loopY close the loop."""
    joints = scene_of(fmu.ROOT / "fmu" / "FourBar" / "system.xml", tmp_path).findall("joint")
    assert {(one.get("of"), one.get("with")): [one.get(name) for name in ("x", "y", "withX", "withY")] for one in joints} == {
        ("crank", None): ["-0.5*a", "0", "0", "0"],
        ("rocker", None): ["-0.5*c", "0", "d", "0"],
        ("coupler", "crank"): ["-0.5*b", "0", "0.5*a", "0"],
        ("rocker", "coupler"): ["0.5*c", "0", "0.5*b", "0"],
    }
    (closing,) = (one for one in joints if one.get("force1"))
    assert [closing.get(name) for name in ("force1", "x1", "y1", "force2", "x2", "y2")] == ["loopX.force", "1", "0", "loopY.force", "0", "1"]


def test_places_of_joints(tmp_path):
    """Linear combinations of parameters plus a constant; a number if the expression is not linear."""
    (tmp_path / "system.xml").write_text(f"""{HEAD}<parameter name="h" start="0.3"/><coordinate name="phi" velocity="omega"/>
  <body name="bar" mass="1" inertia="1" angle="phi" x="h - 2*l + 0.1 + 0.5*l*cos(phi)" y="sqrt(l) + 0.5*l*sin(phi)"/></system>""")
    (joint,) = scene_of(tmp_path / "system.xml", tmp_path).findall("joint")
    assert [joint.get(name) for name in ("x", "y", "withX", "withY")] == ["-0.5*l", "0", "-2*l + h + 0.1", "1.414213562"]


@pytest.mark.parametrize("constraint, factor", [("sqrt(x^2 + y^2) - l", "-1"), ("(x^2 + y^2 - l^2)/2", "-2"), ("l^2 - x^2 - y^2", "4")])
def test_a_rod_by_a_constraint(tmp_path, constraint, factor):
    """The tension is force*|grad c|; it pulls the ball towards the origin if c increases outwards."""
    (tmp_path / "system.xml").write_text(f"""{HEAD}<coordinate name="x" velocity="vx" start="2"/><coordinate name="y" velocity="vy"/>
  <particle name="ball" mass="1" x="x" y="y"/><potential>g*y</potential><constraint name="rod">{constraint}</constraint></system>""")
    (rod,) = scene_of(tmp_path / "system.xml", tmp_path).findall("rod")
    assert rod.attrib == {"to": "ball", "force": "rod.force", "factor": factor}


def test_surfaces(tmp_path):
    """A slope at the distance 0.5 from the origin, and a stop of an angle."""
    (tmp_path / "system.xml").write_text(f"""{HEAD}<coordinate name="x" velocity="vx" start="3"/><coordinate name="y" velocity="vy"/>
  <coordinate name="phi" velocity="omega"/>
  <particle name="ball" mass="1" x="x" y="y"/><particle name="bob" mass="1" x="l*sin(phi)" z="-l*cos(phi)"/>
  <potential>g*y</potential><contact name="slope" gap="0.6*x + 0.8*y - 0.5" restitution="0.5"/>
  <stop coordinate="phi" max="0.5*pi" restitution="0.5"/></system>""")
    plane, stop = scene_of(tmp_path / "system.xml", tmp_path).findall("surface")
    numbers = [[float(one.get(name)) for name in ("x", "y", "z", "nx", "ny", "nz")] for one in (plane, stop)]
    assert numbers[0] == pytest.approx([0.3, 0.4, 0, 0.6, 0.8, 0]) and plane.get("of") == "ball" and plane.get("stop") is None
    assert numbers[1] == pytest.approx([2, 0, 0, 0, 0, -1], abs=1e-4) and stop.get("of") == "bob" and stop.get("stop") == "true"


def test_stops_of_bodies_with_shapes(tmp_path):
    """The contact position of shapes is unknown: a drawn block would intersect them."""
    (tmp_path / "system.xml").write_text(f"""{HEAD}<coordinate name="phi" velocity="omega"/><frame name="arm"><rotate axis="y" angle="phi"/></frame>
  <body name="rod" in="arm" x="l" mass="1" Iyy="1"/><shape name="rodShape" in="arm" type="capsule" radius="0.1" length="l"/>
  <stop coordinate="phi" max="0.5*pi"/></system>""")
    assert scene_of(tmp_path / "system.xml", tmp_path).findall("surface") == []


def test_stops_of_a_closed_chain(tmp_path):
    """Each stop is shown at a position where the chain is still closed, found by partial steps, since a large chain allows no full step."""
    inside = ""
    for k in range(20, 0, -1):
        joint = f'<joint axis="{"0 1 0" if k % 2 else "0 0.6 0.8"}" range="-1 1"/><inertial pos="0.1 0 0" mass="4" diaginertia="0.007 0.017 0.017"/>'
        inside = f'<body name="b{k}" pos="0.2 0 0" euler="0 0.3 0">{joint}{inside}</body>'
    closing = '<equality><connect body1="b20" anchor="0.2 0 0"/></equality>'
    (tmp_path / "chain.xml").write_text(f'<mujoco><compiler angle="radian"/><worldbody>{inside}</worldbody>{closing}</mujoco>')
    (tmp_path / "stops.xml").write_text('<system name="S"><include file="chain.xml" as="r" limits="stops"/></system>')
    assert any(surface.get("stop") for surface in scene_of(tmp_path / "stops.xml", tmp_path).findall("surface"))
