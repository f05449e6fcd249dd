"""The Jacobian for bdf and its storage: dense for small systems, sparse for large ones."""

import subprocess

import numpy as np
import pytest
import scipy.linalg

import fmu
from building import runtime
from fmu import ROOT
from linked import linked_members

MASSES = 30

# Masses in a row, each coupled to the previous one; f acts on the last.
LATTICE = """<system name="{name}">
  <parameter name="m" start="0.5"/>
  <parameter name="k" start="1000"/>
  <parameter name="b" start="200"/>
  <input name="f" start="1"/>
  <for index="i" from="1" to="{n}">
    <coordinate name="x[i]" velocity="v[i]"/>
    <particle name="p[i]" mass="m" x="x[i]"/>
  </for>
  <potential>k*x[1]^2/2 {cubic}</potential>
  <dissipation>b*der(x[1])^2/2</dissipation>
  <for index="i" from="2" to="{n}">
    <potential>k*(x[i] - x[i-1])^2/2</potential>
    <dissipation>b*(der(x[i]) - der(x[i-1]))^2/2</dissipation>
  </for>
  <force coordinate="x[{n}]">f</force>
  {further}
  <solver method="bdf"/>
</system>
"""

# Three rods, whose block of the mass matrix is factored at run time; the first is coupled to the row.
RODS = """
  <for index="i" from="1" to="3">
    <coordinate name="a[i]" velocity="w[i]" start="0.1"/>
    <particle name="bob[i]" mass="1" x="sum(j, 1, i, sin(a[j]))" y="-sum(j, 1, i, cos(a[j]))"/>
    <dissipation>0.1*der(a[i])^2</dissipation>
  </for>
  <potential>9.81*(bob[1].y + bob[2].y + bob[3].y) + (bob[1].x - x[1])^2</potential>
  <work/>"""

TEXTS = {
    "RowOfMasses": LATTICE.format(name="RowOfMasses", n=MASSES, cubic="", further=""),
    "RowAndRods": LATTICE.format(name="RowAndRods", n=MASSES, cubic="+ k*x[1]^4", further=RODS),
    "ShortRowAndRods": LATTICE.format(name="ShortRowAndRods", n=2, cubic="+ k*x[1]^4", further=RODS),
}
ELEMENTS = {
    # q' = v; every acceleration depends on the positions and velocities of a mass and its neighbours.
    "RowOfMasses": MASSES + 2 * (3 * MASSES - 2),
    # Three rods add 3 rates q' = v, a full block by angles and velocities, the dependence of each on the position of the mass coupled to
    # the first rod, and that of this mass on the rod's angle. The rate of work of nonpotential forces depends on all velocities.
    "RowAndRods": MASSES + 2 * (3 * MASSES - 2) + 3 + 3 * 3 * 2 + 3 + 1 + MASSES + 3,
    "ShortRowAndRods": 2 + 2 * 4 + 3 + 3 * 3 * 2 + 3 + 1 + 2 + 3,
}


@pytest.fixture(scope="module", autouse=True)
def systems():
    fmu.build_systems("jacobian-systems", TEXTS)


@pytest.mark.parametrize("name", TEXTS)
def test_elements(name, tmp_path):
    """The Jacobian equals the directional derivatives along each state, which other tests compare with SymPy's."""
    source = fmu.archive(name).parent.parent / "systems" / name / "system.c"
    program = tmp_path / "jacobian"
    words = ["gcc", "-O1", f"-I{ROOT}/include", ROOT / "tests" / "c" / "jacobian.c", source, *runtime(2), "-o", program]
    subprocess.run(list(map(str, words)), check=True)
    states, elements, difference = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    assert (int(states), int(elements)) == (len(fmu.states_of(name)), ELEMENTS[name])
    assert float(difference) < 1e-13


@pytest.mark.parametrize("name", TEXTS)
def test_only_large_systems_have_a_sparse_matrix(name):
    members = " ".join(linked_members(name))
    assert ("libklu" in members) == ("sunmatrixsparse" in members) == (name != "ShortRowAndRods")
    assert ("sunmatrixdense" in members) == (name == "ShortRowAndRods")


def test_motion_by_the_sparse_matrix(open_fmu):
    """Motion of x' = A x + B f, against the matrix exponential."""
    m, k, b = 0.5, 1000.0, 200.0
    ties = np.diag([2.0] * (MASSES - 1) + [1.0]) - np.eye(MASSES, k=1) - np.eye(MASSES, k=-1)
    matrix = np.zeros((2 * MASSES + 1, 2 * MASSES + 1))
    matrix[:MASSES, MASSES:-1] = np.eye(MASSES)
    matrix[MASSES:-1, :MASSES] = -k / m * ties
    matrix[MASSES:-1, MASSES:-1] = -b / m * ties
    matrix[2 * MASSES - 1, -1] = 1.0 / m
    instance = open_fmu("RowOfMasses").initialize(tolerance=1e-9)
    names = fmu.states_of("RowOfMasses")
    for time in (0.5, 2.0, 10.0):
        instance.run(time, 0.25)
        exact = scipy.linalg.expm(time * matrix)[:-1, -1]
        assert instance.get(*names) == pytest.approx(exact, abs=1e-8)
    # For a linear system with the exact Jacobian, Newton's method converges in one or two iterations.
    steps, evaluations, jacobians = instance.fmu.getInteger(instance.vr("solverSteps", "derivativeEvaluations", "jacobianEvaluations"))
    assert 0 < steps < evaluations < 2 * steps and 0 < 10 * jacobians < steps


def test_a_step_reuses_the_pattern(open_fmu):
    """Steps, a restored state and a reset reuse the pattern of the factorization."""
    instance = open_fmu("RowAndRods").initialize(tolerance=1e-7)
    instance.step(0.5)
    state = instance.fmu.getFMUState()
    instance.step(0.5)
    first = instance.get(*fmu.states_of("RowAndRods"))
    instance.fmu.setFMUState(state)
    instance.time = 0.5
    instance.set(f=1.0)
    instance.step(0.5)
    assert instance.get(*fmu.states_of("RowAndRods")) == pytest.approx(first, abs=1e-5)
    instance.free_state(state)
