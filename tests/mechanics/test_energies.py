"""Energies of Lagrangians that are not quadratic in the velocities, and the power of forces on points that move with time."""

import html
import re

import numpy as np
import pytest
import sympy as sp

from fmu import lagc

SYSTEM = """\
<system name="Energies">
  <parameter name="a" start="1"/>
  <parameter name="b" start="1"/>
  <coordinate name="x" velocity="v" start="1"/>
  <coordinate name="y" velocity="w"/>
  {}
</system>
"""
NAMES = {name: sp.Symbol(name) for name in "a b x y v w time F G".split()}
TWO_MASSES = '<particle mass="a" x="x"/><particle mass="a" x="y"/>'


def page(elements, folder):
    (folder / "system.xml").write_text(SYSTEM.format(elements))
    result = lagc("system.xml", "-o", "out", cwd=folder)
    assert result.returncode == 0, result.stderr
    return html.unescape((folder / "out" / "documentation" / "index.html").read_text())


def formula(text, left):
    """The right side of `left = ...` on the documentation page."""
    (right,) = re.findall(rf"<code.*?>{left} = ([^<]*)</code>", text)
    return sp.sympify(right.replace("^", "**"), locals=NAMES)


# <kinetic> elements, and their energies derived by hand.
KINETIC = [
    ("a*(v^2 + w^2)/2", "a*(v**2 + w**2)/2"),
    ("a*(v + b)^2/2 + w^2", "a*(v + b)**2/2 + w**2"),  # a mass on a moving base has its true energy
    ("a*(v + cos(b*time))^2/2 + w^2", "a*(v + cos(b*time))**2/2 + w**2"),
    ("a*b^2*(1 - sqrt(1 - (v^2 + w^2)/b^2))", "a*b**2*(1/sqrt(1 - (v**2 + w**2)/b**2) - 1)"),
    ("((v + b)^3 - v^3)/(3*b) + w^2", "v**2 + b*v + b**2/3 + w**2"),
    ("(v^2 + w)^2 - v^4", "(v**2 + w)**2 - v**4 + 2*v**2*w"),  # 2 v^2 w + w^2, of third degree
    ("a*(v^4 + w^4)", "3*a*(v**4 + w**4)"),
    ("a*(v^3 + w^2)", "a*(2*v**3 + w**2)"),
    ("sqrt(a^2*v^4 + w^4)", "sqrt(a**2*v**4 + w**4)"),  # homogeneous of degree 2, though no polynomial
    ("a*v^2/(b + x^2) + w^2", "a*v**2/(b + x**2) + w**2"),
    ("a*(v^2 + w^2)/2</kinetic><kinetic>b*x*w", "a*(v**2 + w**2)/2"),  # gyroscopic terms contribute no energy
    ("a*(v^2 + w^2)/2</kinetic><kinetic>b*x^2", "a*(v**2 + w**2)/2 - b*x**2"),
    ("a*v^4</kinetic><kinetic>b*(w + 1)^2/2", "3*a*v**4 + b*(w + 1)**2/2"),
]


@pytest.mark.parametrize("term, energy", KINETIC)
def test_energy_of_kinetic_terms(term, energy, tmp_path):
    text = page(f"<kinetic>{term}</kinetic>", tmp_path)
    assert sp.simplify(formula(text, "K") - sp.sympify(energy, locals=NAMES)) == 0


BALANCES = [
    (TWO_MASSES + "<potential>b*x^2</potential>", "totalEnergy is constant"),
    (TWO_MASSES + '<force coordinate="x">b</force>', "its derivative is P"),
    ("<kinetic>a*(v^4 + w^4)</kinetic>", "totalEnergy is constant"),
    ("<kinetic>a*b^2*(1 - sqrt(1 - (v^2 + w^2)/b^2))</kinetic>", "totalEnergy is constant"),
    (TWO_MASSES + "<potential>b*x*time</potential>", "L depends on time explicitly"),
    (TWO_MASSES + '<particle mass="b" x="x + sin(time)"/>', "so that it is not constant either"),
    (TWO_MASSES + '<particle mass="b" x="x*cos(time)" y="x*sin(time)"/>', "so that it is constant without forces"),
    ("<kinetic>a*((v - b*y)^2 + (w + b*x)^2)/2</kinetic>", "so that it is constant without forces"),
]


@pytest.mark.parametrize("elements, law", BALANCES)
def test_page_names_the_law_of_the_energy(elements, law, tmp_path):
    assert law in page(elements, tmp_path)


def test_power_of_forces(tmp_path):
    """F . dr/dt with r = (x + b t, x y t) is F (v + b) + G (v y t + x w t + x y)."""
    elements = (
        '<input name="F"/><input name="G"/><particle name="p" mass="a" x="x + b*time" y="x*y*time"/>'
        '<particle mass="a" x="y"/><force on="p" x="F" y="G"/><force coordinate="y">3*F</force>'
    )
    power = formula(page(elements, tmp_path), "P")
    expected = sp.sympify("F*(v + b) + G*(v*y*time + x*w*time + x*y) + 3*F*w", locals=NAMES)
    assert sp.expand(power - expected) == 0


def test_relativistic_energy(open_fmu):
    """The energy is m c^2 (gamma - 1) + k r^2 / 2 and is conserved."""
    instance = open_fmu("RelativisticParticle").initialize(dict(x=8, vy=5, m=2, k=3), 1e-12)
    rows = np.array(instance.run(10, 0.1, "totalEnergy", "kineticEnergy", "x", "y", "vx", "vy"))
    _, total, kinetic, x, y, vx, vy = rows.T
    gamma = 1 / np.sqrt(1 - (vx**2 + vy**2) / 10**2)
    assert np.max(gamma) > 1.2
    np.testing.assert_allclose(kinetic, 2 * 10**2 * (gamma - 1), rtol=1e-12)
    np.testing.assert_allclose(total, kinetic + 3 * (x**2 + y**2) / 2, rtol=1e-12)
    np.testing.assert_allclose(total, total[0], rtol=1e-10)


def test_work_on_a_moved_particle(open_fmu):
    """1 N on 1 kg that starts at 2 m/s: after 1 s it moves at 3 m/s, and its energy has grown by (9 - 4) / 2 J."""
    instance = open_fmu("MovingBelt").initialize(dict(m=1, w=2, F=1), 1e-12)
    start = instance.get("totalEnergy")
    instance.run(1, 0.1, "q")
    assert instance.get("nonConservativeWork") == pytest.approx(2.5, rel=1e-12)
    assert instance.get("totalEnergy") - start == pytest.approx(2.5, rel=1e-12)
