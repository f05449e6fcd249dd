"""Code as tables and code as statements give the same bits, number of steps, and messages."""

from math import atan, pi

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from scipy.integrate import quad

from differential.build import compile_system
from differential.simulation import Built
from differential.system import Action, Plan, System
from fmu import lagc
from meshes import obj_text, triangles_of

# Functions that bound steps, constants that depend on parameters, pieces, and a matrix that is singular at r = 0 and for k = 0.
TEXT = """<system name="Forms">
  <parameter name="p" start="-0.4"/><parameter name="k" start="1" min="0"/><parameter name="n" start="0"/>
  <coordinate name="r" velocity="vr" start="1" velocityStart="-0.3"/>
  <coordinate name="phi" velocity="w" start="0.01" velocityStart="1"/>
  <coordinate name="x" velocity="v" start="0.3" velocityStart="-0.7"/>
  <coordinate name="y" velocity="u" start="-0.2" velocityStart="0.5"/>
  <coordinate name="z" velocity="s" velocityStart="0.4"/>
  <particle mass="1" x="r*cos(phi)" y="r*sin(phi)"/>
  <kinetic>k*v^2/2 + cos(x)*u*v/4 + u^2/2 + r^2*u^2/8 + (0.005 + sin(phi)^2)*s^2/2</kinetic>
  <potential>3*(r - 1)^2 + sign(p)*x^2 + sign(n)*y + max(p, 0.3)*y^2 + 2*abs(p)*x^4</potential>
  <force coordinate="x">-tanh(200*(x - 0.1)) + atan2(0.01, 20*(x + 0.05)) + max(x, y) - min(0.2, phi)</force>
  <force coordinate="y">-abs(y)*u + if(x > 0.1, sqrt(x - 0.05), 0) + exp(-(y/0.05)^2)</force>
  <output name="far">atan2(x, p) + max(x, y)</output>
  <output name="push">der(v)*x</output>
  <solver method="taylor" tolerance="1e-9"/>
</system>"""
ALONE = """<system name="Forms">
  <coordinate name="x" velocity="v" start="-0.7" velocityStart="1.1"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">-x + atan2(0.001, x - 0.1)</force>
  <output name="push">der(v)*x</output>
  <solver method="taylor" tolerance="1e-9"/>
</system>"""
# The angle jumps from -pi to pi at x = 0.2.
TURN = """<system name="Forms">
  <coordinate name="x" velocity="v" velocityStart="2"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">atan2(x - 0.2, -1 - x)</force>
  <solver method="taylor" tolerance="1e-9"/>
</system>"""
# A stone whose corners touch a floor: a constraint, a Jacobian by directions, and equal code for each corner.
STONE = """<system name="Forms">
  <coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="z" velocity="vz" unit="m" start="0.25"/>
  <coordinate name="q0" velocity="r0" start="0.8"/><coordinate name="q1" velocity="r1" start="0.6"/>
  <coordinate name="q2" velocity="r2" velocityStart="0.5"/><coordinate name="q3" velocity="r3"/>
  <frame name="f"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>
  <body name="stone" in="f" mass="2" Ixx="0.03" Iyy="0.05" Izz="0.04"/><gravity z="-9.81"/>
  <shape name="skin" in="f" type="mesh" file="stone.obj"/><shape name="floor" type="plane"/>
  <contact name="touch" between="skin" and="floor" stiffness="1e5" damping="1" friction="0.4"/>
  <solver method="{}" tolerance="1e-7"/>
</system>"""
RESULTS = ["r", "phi", "x", "y", "vr", "w", "v", "u", "far", "der(v)", "totalEnergy"]


def stone(corners):
    """Points of an ellipsoid, along a spiral."""
    height, angle = 1 - (2 * np.arange(corners) + 1) / corners, 2.4 * np.arange(corners)
    across = np.sqrt(1 - height**2)
    return np.column_stack([0.2 * across * np.cos(angle), 0.15 * across * np.sin(angle), 0.1 * height])


def built(text, form, folder):
    system = System("Forms", plan=Plan(0.0, 2.0, [Action()], 1e-9, form=form))
    system.xml = lambda: text
    folder.mkdir()
    (folder / "stone.obj").write_text(obj_text(stone(30), triangles_of(stone(30))))
    return Built(compile_system(system, folder))


def motion_and_messages(form, folder):
    instance = built(TEXT, form, folder)
    try:
        instance.initialize()
        rows = [row[1:] for row in instance.run(2.0, 0.25, *RESULTS)]
        steps = instance.fmu.getInteger(instance.vr("solverSteps", "derivativeEvaluations", "events"))
        along = instance.fmu.getDirectionalDerivative(instance.vr("far", "der(v)"), instance.vr("x", "p", "y"), [0.3, 0.7, -0.4])
        along += instance.fmu.getRealOutputDerivatives(instance.vr("far", "push"), [1, 1])
        reported = []
        for values in ({"r": 0.0}, {"k": 0.0, "x": 0.0}, {"k": 0.05 * (1 + 3e-15), "x": 0.0, "r": 1.0}):
            instance.reset()
            instance.fmu.setupExperiment(startTime=0.0)
            instance.set(values)
            instance.fmu.enterInitializationMode()
            with pytest.raises(FMICallException):
                instance.get("der(v)")
            reported.append(instance.problem())
    finally:
        instance.free()
    return rows, steps, along, reported


def test_tables_equal_statements(tmp_path):
    statements, tables = (motion_and_messages(form, tmp_path / form) for form in ("statements", "tables"))
    assert tables == statements
    assert "'phi'" in statements[3][0] and "'x'" in statements[3][1] and statements[1][2] > 2, statements


def test_slopes_of_accelerations_are_the_same(tmp_path):
    runs = []
    for form in ("statements", "tables"):
        instance = built(ALONE, form, tmp_path / form)
        try:
            instance.initialize()
            rows = instance.run(2.0, 2.0, "x", "v")
            slopes = instance.fmu.getRealOutputDerivatives(instance.vr("push", "push"), [1, 2])
            runs.append((rows, slopes, instance.fmu.getInteger(instance.vr("solverSteps"))))
        finally:
            instance.free()
    assert runs[0] == runs[1]


def test_an_angle_jumps_where_it_does(tmp_path):
    """The force is -pi + arctan((x - 0.2)/(-1 - x)) before the jump, and larger by 2 pi after it; its work is the integral."""
    before, after = (quad(lambda x, turn=turn: turn + atan((x - 0.2) / (-1 - x)), a, b)[0] for turn, a, b in ((-pi, 0, 0.2), (pi, 0.2, 1)))
    rows = []
    for form in ("statements", "tables"):
        instance = built(TURN, form, tmp_path / form)
        try:
            rows.append(instance.initialize().run(0.5, 0.5, "x", "v")[-1][1:] + instance.fmu.getInteger(instance.vr("solverSteps")))
            x, v = rows[-1][:2]
            to_x = after - quad(lambda x: pi + atan((x - 0.2) / (-1 - x)), x, 1)[0]
            assert v**2 / 2 == pytest.approx(2 + before + to_x, abs=1e-7) and x > 0.3
        finally:
            instance.free()
    assert rows[0] == rows[1]


@pytest.mark.long
@pytest.mark.parametrize("method", ["radau", "taylor"])
def test_points_in_tables_move_as_in_statements(method, tmp_path):
    runs = []
    for form in ("statements", "tables"):
        instance = built(STONE.format(method), form, tmp_path / form)
        try:
            instance.initialize()
            rows = instance.run(0.5, 0.1, "x", "z", "q0", "r1", "touch.force", "der(r2)")
            along = instance.fmu.getDirectionalDerivative(instance.vr("der(vz)", "der(r1)"), instance.vr("z", "q1", "vx"), [0.3, 0.7, -0.4])
            runs.append((rows, along, instance.fmu.getInteger(instance.vr("solverSteps", "events"))))
        finally:
            instance.free()
    assert runs[0] == runs[1]
    assert runs[0][2][1] > 3 and runs[0][0][-1][2] < 0.2


def test_points_are_data(tmp_path):
    """A point more takes 5 kB, most of it in functions of statements, and 13 kB if each has code of its own."""
    sizes = []
    for corners in (12, 30):
        (tmp_path / "stone.obj").write_text(obj_text(stone(corners), triangles_of(stone(corners))))
        (tmp_path / "system.xml").write_text(STONE.format("taylor"))
        assert lagc("system.xml", "-o", "out", "--form", "tables", cwd=tmp_path).returncode == 0
        sizes.append((tmp_path / "out" / "system.c").stat().st_size)
    assert sizes[1] - sizes[0] < 18 * 7000
