"""
HangingCable: accelerations against matrices of finite elements, rest against the elastic catenary, and modes against Bessel functions and
those of a beam.
"""

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.optimize import brentq, root
from scipy.special import jn_zeros

import fmu
from motions import lagrange_fmu  # noqa: F401

N = 20
START = dict(L=2.0, rhoA=0.1, EA=500.0, EI=1e-3, b=0.01, kEnd=0.0, xEnd=1.0, yEnd=0.0, g=9.81)
NODES = range(N + 1)
# Coordinates of one axis in the order of the elements: position and slope of each node. The first position is the pin's.
ORDER = {axis: [name for k in NODES for name in (f"{axis}[{k}]", f"slope{axis.upper()}[{k}]")][1:] for axis in "xy"}
RATES = {axis: [name for k in NODES for name in (f"v{axis}[{k}]", f"w{axis}[{k}]")][1:] for axis in "xy"}
GAUSS, WEIGHTS = leggauss(8)
S, WEIGHTS = (GAUSS + 1) / 2, WEIGHTS / 2
SHAPES = np.array([1 - 3 * S**2 + 2 * S**3, S - 2 * S**2 + S**3, 3 * S**2 - 2 * S**3, S**3 - S**2])
SLOPES = np.array([6 * S**2 - 6 * S, 1 - 4 * S + 3 * S**2, 6 * S - 6 * S**2, 3 * S**2 - 2 * S])
CURVES = np.array([12 * S - 6, 6 * S - 4, 6 - 12 * S, 6 * S - 2])


def accelerations(p, u, v):
    """Accelerations of all coordinates, u[axis, coordinate], from the consistent mass matrix and the integrals of the forces."""
    a, count = p["L"] / N, 2 * N + 2
    scale = np.array([1, a, 1, a])
    mass, force = np.zeros((count, count)), np.zeros((2, count))
    n, n1, n2 = SHAPES.T * scale, SLOPES.T * scale / a, CURVES.T * scale / a**2
    consistent = a * np.einsum("g,gi,gj->ij", WEIGHTS, n, n)
    for e in range(N):
        own = slice(2 * e, 2 * e + 4)
        mass[own, own] += p["rhoA"] * consistent
        slope, curve = n1 @ u[:, own].T, n2 @ u[:, own].T
        pull = p["EA"] * (np.sum(slope**2, axis=1) - 1)[:, None] / 2 * slope
        force[:, own] -= a * (np.einsum("g,gx,gi->xi", WEIGHTS, pull, n1) + p["EI"] * np.einsum("g,gx,gi->xi", WEIGHTS, curve, n2))
        force[:, own] -= p["b"] * v[:, own] @ consistent
        force[1, own] -= p["rhoA"] * p["g"] * a * WEIGHTS @ n
    force[:, -2] -= p["kEnd"] * (u[:, -2] - [p["xEnd"], p["yEnd"]])
    return np.linalg.solve(mass[1:, 1:], force[:, 1:].T).T


def test_accelerations(open_fmu):
    instance, random = open_fmu("HangingCable"), np.random.default_rng(3)
    for _ in range(10):
        p = {name: value * random.uniform(0.5, 2) for name, value in (START | dict(kEnd=50.0, yEnd=0.3)).items()}
        u, v = random.normal(size=(2, 2, 2 * N + 2))
        u[:, 0] = v[:, 0] = 0
        state = {name: value for names, values in ((ORDER, u), (RATES, v)) for k, axis in enumerate("xy") for name, value in zip(names[axis], values[k, 1:])}
        instance.reset().initialize(p | state)
        exact = accelerations(p, u, v)
        for k, axis in enumerate("xy"):
            ours = instance.get(*(f"der({name})" for name in RATES[axis]))
            np.testing.assert_allclose(ours, exact[k], rtol=0, atol=1e-11 * np.abs(exact).max())


def test_energy_is_constant(open_fmu):
    instance = open_fmu("HangingCable").initialize(dict(b=0.0), tolerance=1e-8)
    rows = np.array(instance.run(0.5, 0.1, "totalEnergy", "kineticEnergy"))
    assert rows[-1, 2] > 0.1 and np.ptp(rows[:, 1]) < 1e-7


def catenary(p, s):
    """
    Positions and tension at the points s of a cable without bending, in equilibrium. The pull along it is n = (H, V + rhoA g s), and
    EA (l^2 - 1)/2 l = |n| gives the stretch l (Green's strain); r' = l n/|n| is integrated from the pin by Gauss and Legendre.
    """

    def pull_at(unknown, s):
        return np.column_stack([np.full(s.shape, unknown[0]), unknown[1] + p["rhoA"] * p["g"] * s])

    def slope_at(unknown, s):
        pull = pull_at(unknown, s)
        size = np.hypot(*pull.T)
        stretch = [brentq(lambda x: p["EA"] * (x**2 - 1) / 2 * x - one, 1, 10, xtol=1e-15) for one in size]
        return pull * (stretch / size)[:, None]

    def places(unknown, s):
        parts = [np.diff(one)[0] * WEIGHTS @ slope_at(unknown, one[0] + np.diff(one)[0] * S) for one in zip(s, s[1:])]
        return np.vstack([np.zeros(2), np.cumsum(parts, axis=0)])

    def imbalance(unknown):
        return p["kEnd"] * (np.array([p["xEnd"], p["yEnd"]]) - places(unknown, s)[-1]) - pull_at(unknown, s[-1:])[0]

    found = root(imbalance, [0.3, -1.0], tol=1e-13).x
    return places(found, s), slope_at(found, s), np.hypot(*pull_at(found, s[:1])[0])


@pytest.mark.parametrize("end, errors", [(dict(xEnd=1.0, yEnd=0.0), (1e-4, 1e-2)), (dict(xEnd=1.5, yEnd=-0.4), (5e-6, 1.5e-3))])
def test_catenary(end, errors, open_fmu):
    """Released beside it, the cable with both ends held comes to rest in the catenary, but for the error of cubic elements."""
    p = START | end | dict(EI=0.0, kEnd=1e4, b=1.0)
    s = p["L"] / N * np.arange(N + 1)
    places, slopes, tension = catenary(p, s)
    bump = 0.05 * np.sin(np.pi * s / p["L"]), 0.05 * np.pi / p["L"] * np.cos(np.pi * s / p["L"])
    start = {name: value for k, axis in enumerate("xy") for name, value in zip(ORDER[axis], np.column_stack([places[:, k] + bump[0], slopes[:, k] + bump[1]]).ravel()[1:])}
    instance = open_fmu("HangingCable").initialize(p | start, tolerance=1e-6)
    instance.step(4.0)
    for k, axis in enumerate("xy"):
        ours = np.array([0.0, *instance.get(*ORDER[axis])]).reshape(N + 1, 2)
        np.testing.assert_allclose(ours[:, 0], places[:, k], atol=errors[0])
        np.testing.assert_allclose(ours[:, 1], slopes[:, k], atol=errors[1])
    assert instance.get("tension") == pytest.approx(tension, rel=3e-3)


def frequencies(found):
    return np.unique(np.round(np.sort(found.eigenvalues.imag[found.eigenvalues.imag > 0]), 9))


def test_swings_of_a_hanging_cable(lagrange_fmu):  # noqa: F811
    """j/2 sqrt(g/L) for the zeros j of J0 (D. Bernoulli), of a cable that does not stretch."""
    p = START | dict(EA=1e8, EI=0.0, b=0.0, tilt=0.0)
    found = lagrange_fmu.equilibrium(fmu.archive("HangingCable"), p)
    np.testing.assert_allclose(frequencies(found)[:5], jn_zeros(0, 5) / 2 * np.sqrt(p["g"] / p["L"]), rtol=2e-5)


@pytest.mark.filterwarnings("ignore:the operating point is not an equilibrium")  # its rates are rounding errors times EA
def test_vibrations_of_a_beam(lagrange_fmu):  # noqa: F811
    """Without weight it is a beam on a pin: tan(z) = tanh(z), and the frequency z^2 sqrt(EI/(rhoA L^4)) (Euler and Bernoulli)."""
    p = START | dict(g=0.0, EI=1.0, EA=1e6, b=0.0, tilt=0.0)
    found = lagrange_fmu.linearize(fmu.archive("HangingCable"), p)
    zeros = [brentq(lambda z: np.tan(z) - np.tanh(z), np.pi * (k + 0.2), np.pi * (k + 0.3)) for k in range(1, 4)]
    ours = np.sort(np.linalg.eigvals(found.A).imag)
    ours = ours[ours > 1]  # it turns about the pin at frequency 0
    np.testing.assert_allclose(ours[:3], np.square(zeros) * np.sqrt(p["EI"] / (p["rhoA"] * p["L"] ** 4)), rtol=1e-4)
