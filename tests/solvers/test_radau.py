"""Radau IIA against closed forms of stiff motions, and the reproducibility of a one-step method."""

import math
import subprocess

import mpmath
import numpy as np
import pytest

import fmu
from closed_forms import pendulum_angle

ROW = (
    '<constant name="N" value="{0}"/><parameter name="k" start="1e4"/><parameter name="b" start="1e4"/><define name="x[0]">0</define>'
    '<for index="i" from="1" to="N"><coordinate name="x[i]" velocity="v[i]" start="sin(pi*i/(N + 1))"/><particle mass="1" x="x[i]"/>'
    '<potential>k*(x[i] - x[i-1])^2/2</potential><dissipation>b*(v[i] - der(x[i-1]))^2/2</dissipation></for>'
    '<potential>k*x[N]^2/2</potential><dissipation>b*v[N]^2/2</dissipation><work/>'
)  # fmt: skip
TEXTS = {
    # rows of masses between two walls, in their slowest mode: dense factors, and sparse ones
    "Row8": ROW.format(8),
    "Row60": ROW.format(60),
    # particles in a strong magnetic field and a viscous liquid: only velocities couple x and y
    "Magnetic": '<parameter name="B" start="1e5"/><parameter name="b" start="1e5"/><for index="i" from="1" to="10">'
    '<coordinate name="x[i]" velocity="v[i]"/><coordinate name="y[i]" velocity="w[i]"/>'
    '<kinetic>(v[i]^2 + w[i]^2)/2</kinetic><force coordinate="x[i]">B*w[i] - b*(v[i] - i)</force>'
    '<force coordinate="y[i]">-B*v[i] - b*w[i]</force></for>',
    # x'' = -b v - k x, overdamped by up to twelve decades
    "Damper": '<parameter name="b" start="1e6"/><parameter name="k" start="1"/><coordinate name="x" velocity="v" start="1"/>'
    '<particle mass="1" x="x"/><force coordinate="x">-b*v - k*x + u</force><input name="u"/><work/>',
    # van der Pol's oscillator as a mass on a spring with negative damping
    "VanDerPol": '<parameter name="mu" start="1e3"/><coordinate name="x" velocity="v" start="2"/><particle mass="1" x="x"/>'
    '<force coordinate="x">mu*(1 - x^2)*v - x</force>',
    # two masses, one of them on a nearly rigid spring: a full mass matrix and a sparse Jacobian
    "Pair": '<parameter name="k" start="1e8"/><coordinate name="x" velocity="v"/><coordinate name="s" velocity="w" start="1e-3"/>'
    '<particle mass="1" x="x"/><particle mass="2" x="x + s"/><potential>k*s^2/2 + x^2/2</potential>'
    '<dissipation>1e5*w^2/2</dissipation>',
    # strongly nonlinear
    "Pendulum": '<coordinate name="theta" velocity="omega" start="3"/><particle mass="1" x="sin(theta)" y="-cos(theta)"/>'
    '<potential>-9.81*cos(theta)</potential>',
    "Oscillator": '<coordinate name="x" velocity="v" start="1"/><particle mass="1" x="x"/><potential>x^2/2</potential>',
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def systems():
    names = {f"Radau{name}": body for name, body in TEXTS.items()}
    fmu.build_systems("radau-systems", {
        name: f'<system name="{name}">{body}<solver method="radau"/><experiment stopTime="0.1"/></system>' for name, body in names.items()
    })  # fmt: skip


def overdamped(b, k, t):
    """x from rest at x = 1."""
    b, k = mpmath.mpf(b), mpmath.mpf(k)
    root = mpmath.sqrt(b * b / 4 - k)
    fast, slow = -b / 2 - root, -k / (b / 2 + root)
    one, other = -fast / (slow - fast), slow / (slow - fast)
    x = one * mpmath.exp(slow * t) + other * mpmath.exp(fast * t)
    return float(x)


@pytest.mark.parametrize("b", [10.0, 1e3, 1e6, 1e9, 1e12])
@pytest.mark.parametrize("step", [10.0, 0.01])
def test_overdamped(b, step, open_fmu):
    instance = open_fmu("RadauDamper")
    with mpmath.workdps(50):
        for tolerance in (1e-4, 1e-7, 1e-10, 1e-13):
            instance.reset().initialize({"b": b}, tolerance)
            instance.run(10.0, step)
            assert instance.get("x") == pytest.approx(overdamped(b, 1, 10), abs=max(20 * tolerance, 1e-12))


def test_orders(open_fmu):
    """The error follows the tolerance down to rounding, and steps remain few, since the order grows."""
    instance, steps = open_fmu("RadauOscillator"), []
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13):
        instance.reset().initialize(tolerance=tolerance)
        instance.step(10.0)
        assert instance.get("x") == pytest.approx(math.cos(10.0), abs=50 * tolerance)
        steps.append(instance.fmu.getInteger(instance.vr("solverSteps"))[0])
    assert steps[-1] < 400


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
def test_nonlinear_motions(tolerance, open_fmu):
    """Newton's method iterates until its error is below the tolerance, in every step."""
    instance = open_fmu("RadauPendulum").initialize(tolerance=tolerance)
    instance.step(20.0)
    assert instance.get("theta") == pytest.approx(float(pendulum_angle(3.0, math.sqrt(9.81), 20.0)), abs=200 * tolerance)


@pytest.mark.parametrize("mu, end, x", [(1e3, 1.0, None), (1e2, 80.0, None)])
def test_van_der_pol(mu, end, x, open_fmu):
    """On the slow branch x agrees with a closed form, and past the jumps with results at a tight tolerance."""
    instance = open_fmu("RadauVanDerPol")
    results = []
    for tolerance in (1e-12, 1e-9, 1e-6):
        instance.reset().initialize({"mu": mu}, tolerance)
        instance.step(end)
        results.append(instance.get("x"))
    assert results[1] == pytest.approx(results[0], abs=1e-6) and results[2] == pytest.approx(results[0], abs=1e-3)
    if mu * end <= 1e3:
        # On the slow branch time follows from x up to terms in 1/mu^2: log x - x^2/2 = (t - t0)/mu.
        slow = mpmath.findroot(lambda y: mpmath.log(y / 2) - (y * y - 4) / 2 - end / mu, 2)
        assert results[0] == pytest.approx(float(slow), abs=1e-5)


def test_inputs_that_change_cost_no_more(open_fmu):
    """After the fast transient a communication step takes one solver step."""
    instance = open_fmu("RadauDamper").initialize({"b": 1e6, "k": 1e6}, tolerance=1e-6)
    for i in range(200):
        instance.set({"u": 1.0 + 0.01 * (i % 5)})
        instance.step(0.01)
    assert instance.fmu.getInteger(instance.vr("solverSteps"))[0] < 1000


def test_repeated_steps_give_the_same_bits(open_fmu):
    """A state serialized between steps of the solver gives the same bits in another instance."""
    for name in ("RadauDamper", "RadauVanDerPol", "RadauPair"):
        first, second = open_fmu(name).initialize(), open_fmu(name).initialize()
        first.run(0.3, 0.03)
        second.fmu.setFMUstate(second.fmu.deSerializeFMUstate(first.fmu.serializeFMUstate(first.fmu.getFMUstate())))
        second.time = first.time
        for instance in (first, second):
            instance.run(1.0, 0.07)
        assert [first.get(v) for v in ("x", "v")] == [second.get(v) for v in ("x", "v")]


def test_a_spring_that_is_nearly_a_rod(open_fmu):
    """After the fast transient the pair moves as one mass of 3 on the spring of stiffness 1."""
    instance = open_fmu("RadauPair").initialize({"x": 1.0, "s": 0.0}, tolerance=1e-9)
    instance.run(5.0, 0.5)
    assert instance.get("x") == pytest.approx(math.cos(5.0 / math.sqrt(3)), abs=1e-7)


def test_work_of_a_stiff_damper(open_fmu):
    """The damper dissipates the energy of the spring, and nothing else changes it."""
    instance = open_fmu("RadauDamper").initialize({"b": 1e6, "k": 1e6}, tolerance=1e-9)
    instance.run(20.0, 1.0)
    x, v, work = (instance.get(name) for name in ("x", "v", "nonConservativeWork"))
    assert np.isfinite([x, v, work]).all() and work == pytest.approx(v * v / 2, abs=1e-6)


def code_of(name):
    return (fmu.BUILD / "radau-systems" / "systems" / name / "system.c").read_text()


@pytest.mark.parametrize("n, factors", [(8, "lu_dense"), (60, "lu_sparse")])
def test_row_of_masses(n, factors, open_fmu):
    """In the slowest mode each mass moves as one on a spring and damper of 4 sin(pi / (2 (n + 1)))^2 times their strength."""
    assert f".lu = &{factors}," in code_of(f"RadauRow{n}")
    instance = open_fmu(f"RadauRow{n}")
    share = 4 * math.sin(math.pi / (2 * (n + 1))) ** 2
    for tolerance in (1e-4, 1e-7, 1e-10):
        for b in (1e4, 1e7):
            instance.reset().initialize({"b": b, "k": 1e4}, tolerance)
            instance.run(3.0, 1.0)
            with mpmath.workdps(50):
                exact = overdamped(share * b, share * 1e4, 3.0)
            found = [instance.get(f"x[{i}]") for i in range(1, n + 1)]
            shape = np.sin(np.pi * np.arange(1, n + 1) / (n + 1))
            np.testing.assert_allclose(found, exact * shape, atol=20 * tolerance)
    # The dampers dissipate the energy of the springs, share k / 2 times the sum of the squares.
    loss = share * 1e4 / 2 * (n + 1) / 2 * (exact**2 - 1) + instance.get("kineticEnergy")
    assert instance.get("nonConservativeWork") == pytest.approx(loss, rel=1e-6)


def test_particles_in_a_magnetic_field(open_fmu):
    """The particles drift with the liquid, at the angle given by the field; the sparse factors need no row pivoting."""
    assert ".lu = &lu_sparse," in code_of("RadauMagnetic")
    instance = open_fmu("RadauMagnetic")
    for field, damping in ((1e5, 1e5), (1e8, 1e5), (1e5, 1e2), (1e3, 1e9)):
        instance.reset().initialize({"B": field, "b": damping}, tolerance=1e-8)
        instance.step(1.0)
        for i in (1, 10):
            rate = damping + 1j * field
            exact = i * damping / rate * (1 + (np.exp(-rate) - 1) / rate)
            assert instance.get(f"x[{i}]") == pytest.approx(exact.real, abs=1e-6)
            assert instance.get(f"y[{i}]") == pytest.approx(exact.imag, abs=1e-6)


@pytest.mark.parametrize("name, is_sparse", [("RadauPair", False), ("RadauRow60", True)])
def test_sources(name, is_sparse):
    """The sources have only the kind of factors that the system needs, and are plain C."""
    source = fmu.unpacked(name) / "sources" / f"{name}.c"
    words = ["gcc", "-std=c11", "-pedantic-errors", "-Wall", "-Wextra", "-Wno-unused-parameter", "-Wno-unused-function"]
    subprocess.run([*words, "-Werror", "-fsyntax-only", source], check=True)
    assert [kind in source.read_text() for kind in ("lu_dense =", "lu_sparse =")] == [not is_sparse, is_sparse]
