"""lagc --linearize: A and B as formulas and as numbers, against textbook formulas and SymPy's."""

import re

import numpy as np
import pytest
import sympy as sp

from fmu import ROOT, lagc


def printed(name, *words):
    """Return (A, B) as SymPy formulas and as numbers, and the values for which the numbers hold."""
    result = lagc("--linearize", ROOT / "fmu" / name / "system.xml", *words)
    assert result.returncode == 0, result.stderr
    formulas, numbers = re.split(r"^at .*:$", result.stdout, flags=re.M)
    values = dict(pair.split(" = ") for pair in re.search(r"^at (.*):$", result.stdout, re.M).group(1).split(", "))

    def matrices(text):
        found = []
        for block in re.findall(r"^[AB] =\n((?:  \[.*\]\n?)+)", text, re.M):
            rows = [row.strip(" []").split(", ") for row in block.splitlines()]
            found.append(sp.Matrix([[sp.sympify(entry) for entry in row] for row in rows]))
        return found

    return matrices(formulas), matrices(numbers), {sp.Symbol(k): float(v) for k, v in values.items()}


M, m, l, g, b = sp.symbols("M m l g b")
CART = [[0, 0, 1, 0], [0, 0, 0, 1], [0, -m * g / M, 0, 0], [0, (M + m) * g / (M * l), 0, 0]]
FORCE = [[0], [0], [1 / M], [-1 / (M * l)]]
TORQUE = [[0, 0], [0, 0], [1 / M, -1 / (M * l)], [-1 / (M * l), (M + m) / (M * m * l**2)]]
HANGING = [[0, 0, 1, 0], [0, 0, 0, 1], [0, -m * g / M, 0, 0], [0, -(M + m) * g / (M * l), 0, 0]]
CASES = [
    ("SimplePendulum", ["--at", "theta=0"], [[0, 1], [-g / l, 0]], None),
    ("SimplePendulum", ["--at", "theta=pi"], [[0, 1], [g / l, 0]], None),
    ("DampedPendulum", [], [[0, 1], [-g / l, -b / (m * l**2)]], [[0], [1 / (m * l**2)]]),
    ("InvertedPendulumCart", ["--at", "theta=0"], CART, FORCE),
    ("InvertedPendulumCart", ["--at", "x=2,theta=pi"], HANGING, [[0], [0], [1 / M], [1 / (M * l)]]),
    ("InvertedPendulumCartTorque", [], CART, TORQUE),
]


@pytest.mark.parametrize("name, words, A, B", CASES)
def test_matrices(name, words, A, B):
    formulas, numbers, values = printed(name, *words)
    expected = [sp.Matrix(A)] + ([sp.Matrix(B)] if B else [])
    for formula, number, right in zip(formulas, numbers, expected, strict=True):
        difference = (formula - right).applyfunc(sp.simplify)
        # The program treats pi as a number, so that sin(pi) = 0 only up to rounding.
        assert max(abs(float(entry.subs(values))) for entry in difference) < 1e-13
        np.testing.assert_allclose(
            np.array(number, float), np.array(right.subs(values), float), rtol=1e-13, atol=1e-13
        )


def test_formulas_are_short():
    """The printed formulas are as short as those written by hand."""
    (A, B), _, _ = printed("InvertedPendulumCartTorque")
    assert sum(sp.count_ops(entry) for entry in [*A, *B]) <= 24


def test_linearization_of_a_linearization():
    result = lagc("--linearize", ROOT / "fmu" / "SimplePendulumLinear" / "system.xml")
    assert result.returncode == 1 and "linearization already" in result.stderr


def test_chain_stays_exact():
    """
    Rods that hang at rest: M_ij = m l^2 (N + 1 - max(i, j)) and K_ii = m g l (N + 1 - i). A then has integer multiples of g/l, without
    rounding errors.
    """
    (A,), _, _ = printed("ChainPendulum", "-D", "N=4")
    mass = sp.Matrix(4, 4, lambda i, j: 4 - max(i, j))
    stiffness = sp.diag(4, 3, 2, 1)
    assert A[4:, :4] == -mass.inv() * stiffness * g / l
    assert A[:4, 4:] == sp.eye(4) and A[:4, :4] == A[4:, 4:] == sp.zeros(4)


def warnings_at(point, folder):
    """Warnings for a mass on a linear spring of 1 N/m and a cubic spring, with its equilibrium at x = 0."""
    (folder / "system.xml").write_text(
        '<system name="Spring"><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><potential>x^2/2 + x^4</potential></system>'
    )
    result = lagc("--linearize", "system.xml", "--at", point, cwd=folder)
    assert result.returncode == 0
    return re.findall(r"warning: the operating point is not an equilibrium: v = (\S+), der\(v\) = (\S+); expected 0 for both", result.stderr)


def test_how_near_to_an_equilibrium(tmp_path):
    """Residuals from 1e-9 on give a warning; smaller ones, such as sin(pi), are rounding."""
    assert warnings_at("x=0,v=0", tmp_path) == warnings_at("x=2e-10,v=-2e-10", tmp_path) == []
    assert warnings_at("x=1e-8", tmp_path) == [("0", "-1e-08")] and warnings_at("x=-1e-8", tmp_path) == [("0", "1e-08")]
    assert warnings_at("v=1e-8", tmp_path) == [("1e-08", "0")] and warnings_at("v=-1e-8", tmp_path) == [("-1e-08", "0")]


def test_a_linearization_has_a_solver_of_its_own(tmp_path):
    """A linearization takes neither the method nor the step limits of its system."""
    (tmp_path / "system.xml").write_text(
        '<system name="Spring"><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><potential>x^4 + x^2</potential>'
        '<solver method="erk" maxStep="0.1" maxSteps="50"/></system>'
    )
    line = '<linearization of="system.xml" name="Line"><at name="x" value="0"/>{}</linearization>'
    for element, solver, step in (("", "exact", "INFINITY"), ('<solver method="taylor"/>', "taylor", "INFINITY"), ('<solver method="bdf" maxStep="0.5"/>', "bdf", "0.5")):
        (tmp_path / "line.xml").write_text(line.format(element))
        result = lagc("line.xml", "-o", "out", cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        code = (tmp_path / "out" / "system.c").read_text()
        assert f".solver = &solver_{solver}," in code and f".max_step = {step}," in code and ".max_steps = 50" not in code


def test_events_and_samples_are_left_out(tmp_path):
    """A and B describe the motion between events, with modes at their start values."""
    system = """<system name="S"><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><parameter name="k" start="4"/>
<potential>k*x^2/2</potential><mode name="n" start="3"/><input name="u"/><force coordinate="x">(n - 7)*x + 3*u</force>
<event when="x - 1"><set mode="n">1</set></event><sample every="0.1"><set mode="n">2</set></sample></system>"""
    (tmp_path / "s.xml").write_text(system)
    result = lagc("--linearize", "s.xml", cwd=tmp_path)
    assert result.returncode == 0 and result.stderr == "" and "[-8, 0]" in result.stdout and "[3]" in result.stdout, result
    (tmp_path / "l.xml").write_text('<linearization of="s.xml" name="L"/>')
    assert lagc("l.xml", "-o", "out", cwd=tmp_path).returncode == 0
