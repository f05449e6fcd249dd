"""
Vectors in expressions: products with numbers, sums, and angular velocities along the base axes, against closed forms for Euler angles.
"""

import numpy as np
import pytest

from fmu import build_systems, lagc

START = {"p": 0.3, "t": 0.7, "s": -0.4, "vp": 1.1, "vt": -0.6, "vs": 2.3}
SYSTEM = """<system name="TurnVectors" description="Body that is turned by Euler angles">
  <parameter name="k" start="2" unit="1/s"/>
  <parameter name="m" start="3" unit="kg"/>
  <coordinate name="p" velocity="vp" unit="rad"/><coordinate name="t" velocity="vt" unit="rad"/><coordinate name="s" velocity="vs" unit="rad"/>
  <frame name="top"><rotate axis="z" angle="p"/><rotate axis="x" angle="t"/><rotate axis="z" angle="s"/></frame>
  <body name="rod" in="top" mass="m" x="0.1" y="0.2" z="0.3" Ixx="1" Iyy="1.5" Izz="2"/>
  <output name="wx" unit="rad/s">rod.wx</output>
  <output name="wy" unit="rad/s">dot(rod.omega, base.axisY)</output>
  <output name="wz" unit="rad/s">dot(rod.omega, 2*base.axisZ)/2</output>
  <output name="lever" unit="m/s">norm(rod.v - cross(rod.omega, rod))</output>
  <output name="along" unit="kg.m/s">dot(m*rod.v/2 + m*k*rod/4 - sin(p)*2*m*rod.v*k/k, -top.axisX)</output>
  <output name="scaled" unit="m2">norm(2*cross(rod, 3/4*(rod + 1/k*rod.v)))</output>
</system>"""


@pytest.fixture(scope="module", autouse=True)
def systems():
    build_systems("vectors", {"TurnVectors": SYSTEM})


def turn(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == "z" else [[1, 0, 0], [0, c, -s], [0, s, c]])


def test_vectors(open_fmu):
    instance = open_fmu("TurnVectors").initialize(START)
    p, t, s, vp, vt, vs = START.values()
    rotation = turn("z", p) @ turn("x", t) @ turn("z", s)
    omega = np.array([vt * np.cos(p) + vs * np.sin(t) * np.sin(p), vt * np.sin(p) - vs * np.sin(t) * np.cos(p), vp + vs * np.cos(t)])
    place = rotation @ [0.1, 0.2, 0.3]
    velocity = np.cross(omega, place)
    along = -(3 * velocity / 2 + 6 * place / 4 - 6 * np.sin(p) * velocity) @ rotation[:, 0]
    found = [instance.get(name) for name in ("wx", "wy", "wz", "lever", "along", "scaled")]
    expected = [*omega, 0.0, along, 2 * np.linalg.norm(np.cross(place, 0.75 * (place + velocity / 2)))]
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize(
    "bad, message",
    [
        ("norm(m)", "a number is no vector; expected * and a vector after it"),
        ("norm(m*2)", "a number is no vector; expected * and a vector after it"),
        ("norm(2*)", "expected the name of a <particle>, <body>, <point> or <frame>, or base"),
        ("norm(m*rod + rod.v)", "unit mismatch: kg.m and m/s in one sum"),
        ("norm(rod/0)", "division by zero"),
        ("norm(rod*rod)", "unknown name 'rod'"),
    ],
)
def test_bad_vectors(bad, message, tmp_path):
    (tmp_path / "system.xml").write_text(SYSTEM.replace("</system>", f'<output name="bad">{bad}</output></system>'))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr
