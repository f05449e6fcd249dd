"""Conserved quantities, and the energy balance with the work of forces."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fmu

TOLERANCE = 1e-11

# Systems without friction, inputs or explicit time, started far from rest.
CONSERVATIVE = {
    "ParticleCartesian": dict(m=0.7, kx=3, x=2, vy=3, vz=-1),
    "ParticlePolar": dict(r=1, omega=1.3, mu=1.4),
    "ParticleCylindrical": dict(rho=1, omega=2, vz=3, k=5),
    "ParticleSpherical": dict(r=2, phi=1.2, omegaTheta=0.8, omegaPhi=0.3, g=1),
    "SimplePendulum": dict(theta=3, omega=0.5, l=0.4, m=3),
    "InvertedPendulumCart": dict(theta=0.3, omega=2, v=1, m=0.9),
    "InvertedPendulumCartTorque": dict(theta=2, omega=-5, v=1, M=0.4),
    "ElasticPendulum": dict(c=0, k=50, r=1.3, theta=1),
    "DoublePendulum": dict(theta1=2, theta2=-1, omega1=3),
    "ChainPendulum": {"theta[1]": 1.5, "theta[7]": -0.9, "omega[3]": 1, "l": 0.3},
    "SphericalPendulum": dict(theta=1.5, nu=2),
    "RollingDiskWithRod": dict(phi=2, v=1),
}


@pytest.mark.parametrize("name", CONSERVATIVE)
def test_energy_is_conserved(name, open_fmu):
    instance = open_fmu(name).initialize(CONSERVATIVE[name], TOLERANCE)
    rows = np.array(instance.run(3, 0.1, "totalEnergy", "kineticEnergy"))
    assert np.ptp(rows[:, 2]) > 0.1, "the motion exchanges no energy, so the test would see nothing"
    assert np.ptp(rows[:, 1]) < 1e3 * TOLERANCE * (1 + np.max(rows[:, 2]))


def test_momentum_of_the_cart(open_fmu):
    M, m, l = 1.3, 0.8, 0.9
    instance = open_fmu("InvertedPendulumCart").initialize(dict(M=M, m=m, l=l, theta=1, v=0.4), TOLERANCE)
    for _, v, theta, omega in instance.run(5, 0.1, "v", "theta", "omega"):
        assert (M + m) * v + m * l * omega * np.cos(theta) == pytest.approx((M + m) * 0.4, abs=1e-8)


@pytest.mark.parametrize("name, radius", [("ParticlePolar", "r"), ("ParticleCylindrical", "rho")])
def test_angular_momentum(name, radius, open_fmu):
    instance = open_fmu(name).initialize({radius: 1.5, "omega": 0.6}, TOLERANCE)
    for _, r, omega in instance.run(5, 0.1, radius, "omega"):
        assert r * r * omega == pytest.approx(1.5**2 * 0.6, rel=1e-8)


def test_angular_momentum_about_the_vertical(open_fmu):
    instance = open_fmu("ParticleSpherical").initialize(dict(r=2, phi=1, omegaTheta=0.7, vr=0.2, g=1), TOLERANCE)
    for _, r, phi, rate in instance.run(2, 0.1, "r", "phi", "omegaTheta"):
        assert (r * np.sin(phi)) ** 2 * rate == pytest.approx((2 * np.sin(1)) ** 2 * 0.7, rel=1e-8)


def test_work_on_the_damped_pendulum(open_fmu):
    """The change of K + U equals the work of friction and of a torque that changes at every step."""
    instance = open_fmu("DampedPendulum").initialize(dict(b=0.7, theta=1.2, m=2, l=0.6), TOLERANCE)
    start = instance.get("totalEnergy")
    for i in range(200):
        instance.set(tau=3 * np.sin(0.2 * i))
        instance.step(0.05)
        energy, work = instance.get("totalEnergy", "nonConservativeWork")
        assert energy - start == pytest.approx(work, abs=1e-7)
    assert abs(work) > 1


def test_friction_takes_energy(open_fmu):
    instance = open_fmu("DampedPendulum").initialize(dict(b=0.3, theta=2), TOLERANCE)
    energies = [row[1] for row in instance.run(20, 0.1, "totalEnergy")]
    assert all(later < earlier for earlier, later in zip(energies, energies[1:]))


def test_power_of_the_force_on_the_cart(open_fmu):
    """With a constant force, the change of K + U equals the force times the displacement of the cart."""
    instance = open_fmu("InvertedPendulumCart").initialize(dict(theta=0.5, F=2.5), TOLERANCE)
    start = instance.get("totalEnergy")
    for _, energy, x in instance.run(5, 0.1, "totalEnergy", "x"):
        assert energy - start == pytest.approx(2.5 * x, abs=1e-7)


def test_the_lost_term(open_fmu):
    """
    A common error in derivations of this system drops m l x' theta' sin(theta) from dL/dtheta. The same term of d/dt dL/domega then remains in the
    equation of theta. The wrong equation does not conserve energy; the FMU does.
    """
    M, m, l, g = 1.0, 0.3, 0.5, 9.81
    start = [0.0, 0.4, 1.0, 0.0]

    def wrong(t, state):
        x, theta, v, omega = state
        sine, cosine = np.sin(theta), np.cos(theta)
        mass = [[M + m, m * l * cosine], [m * l * cosine, m * l * l]]
        right = [m * l * omega**2 * sine, m * g * l * sine + m * l * v * omega * sine]
        return [v, omega, *np.linalg.solve(mass, right)]

    def energy(x, theta, v, omega):
        kinetic = (M + m) * v**2 / 2 + m * l * v * omega * np.cos(theta) + m * l**2 * omega**2 / 2
        return kinetic + m * g * l * np.cos(theta)

    copied = solve_ivp(wrong, (0, 5), start, rtol=1e-12, atol=1e-12, method="DOP853")
    initial = energy(*start)
    assert np.max(np.abs(energy(*copied.y) - initial)) > 0.1 * initial
    names = ["x", "theta", "v", "omega"]
    instance = open_fmu("InvertedPendulumCart")
    instance.initialize(dict(zip(names, start)) | dict(M=M, m=m, l=l, g=g), 1e-12)
    rows = np.array(instance.run(5, 0.05, *names))
    assert np.max(np.abs(energy(*rows[:, 1:].T) - initial)) < 1e-9 * initial


def test_couplers_against_their_formulas(open_fmu):
    """The systems without coordinates give the values of their closed formulas."""
    random = np.random.default_rng(3)
    spring = open_fmu("SpringDamper").initialize()
    feedback = open_fmu("StateFeedback").initialize()
    for _ in range(50):
        k, c, l0, x1, v1, x2, v2 = random.uniform(-3, 3, 7)
        spring.set(k=k, c=c, l0=l0, x1=x1, v1=v1, x2=x2, v2=v2)
        force = k * (x2 - x1 - l0) + c * (v2 - v1)
        np.testing.assert_allclose(spring.get("F1", "F2"), [force, -force], rtol=1e-13)
        kx, kt, kv, ko, xref, x, theta, v, omega = random.uniform(-3, 3, 9)
        umax = random.uniform(0, 20)
        feedback.set(kx=kx, ktheta=kt, kv=kv, komega=ko, xref=xref, umax=umax, x=x, theta=theta, v=v, omega=omega)
        demand = -(kx * (x - xref) + kt * theta + kv * v + ko * omega)
        assert feedback.get("F") == pytest.approx(np.clip(demand, -umax, umax), rel=1e-13)
        spring.step(0.1)
        feedback.step(0.1)
