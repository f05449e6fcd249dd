"""Simulated motion against closed forms, at parameters other than the defaults, and against references."""

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

import fmu
from closed_forms import kepler, pendulum_angle, pericentre_velocity, turning_pendulum_angle
from references import ExactMotion
from systems_in_sympy import system

TOLERANCES = [1e-6, 1e-9]


def largest_error(rows, exact, scale=1.0):
    """Largest difference from exact(t), a list of values, over all rows (t, values...)."""
    return max(np.max(np.abs(np.array(row[1:]) - exact(row[0])) / scale) for row in rows)


@pytest.mark.parametrize("kx", [0.0, 7.0])
def test_particle_on_springs(open_fmu, kx):
    """Each axis is a forced harmonic oscillator, or has a constant acceleration without a spring."""
    m, k, g, force = 0.7, np.array([kx, 11.0, 5.0]), 3.7, np.array([1.5, -2.0, 0.4])
    start, speed = np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, -0.5])
    values = dict(m=m, kx=k[0], ky=k[1], kz=k[2], g=g, Fx=force[0], Fy=force[1], Fz=force[2])
    values |= dict(zip(["x", "y", "z", "vx", "vy", "vz"], [*start, *speed]))
    rows = open_fmu("ParticleCartesian").initialize(values).run(7.3, 0.37, "x", "y", "z")

    def exact(t):
        total = force - np.array([0, 0, m * g])
        if kx == 0.0:
            free = start[0] + speed[0] * t + total[0] / m * t * t / 2
        w = np.sqrt(np.maximum(k, 1e-9) / m)
        rest = total / np.maximum(k, 1e-9)
        x = rest + (start - rest) * np.cos(w * t) + speed / w * np.sin(w * t)
        return np.array([free, x[1], x[2]]) if kx == 0.0 else x

    assert largest_error(rows, exact) < 1e-12 * 40


def test_particle_on_springs_under_a_ramp(open_fmu):
    """A force that grows linearly over each step, given by its derivative, is integrated exactly."""
    m, k, slope = 0.7, 5.0, 0.8
    instance = open_fmu("ParticleCartesian")
    instance.initialize(dict(m=m, kx=k, x=0.0, vy=0.0))
    w, h = np.sqrt(k / m), 0.5
    for i in range(20):
        instance.set(Fx=slope * i * h)
        instance.fmu.setRealInputDerivatives(instance.vr("Fx"), [1], [slope])
        instance.step(h)
        t = (i + 1) * h
        assert instance.get("x") == pytest.approx(slope / k * (t - np.sin(w * t) / w), abs=1e-12)


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("e", [0.0, 0.5, 0.9])
def test_kepler_ellipse(open_fmu, tolerance, e):
    mu, a = 2.5, 1.4
    values = dict(m=3.0, mu=mu, r=a * (1 - e), vr=0.0, theta=0.0, omega=pericentre_velocity(mu, a, e))
    period = 2 * np.pi * np.sqrt(a**3 / mu)
    rows = open_fmu("ParticlePolar").initialize(values, tolerance).run(1.3 * period, period / 20, "particle.x", "particle.y")
    assert largest_error(rows, lambda t: kepler(mu, values["r"], values["omega"], t), a) < 100 * tolerance


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_particle_on_a_radial_spring(open_fmu, tolerance):
    m, k, g = 0.6, 3.0, 1.7
    w = np.sqrt(k / m)
    values = dict(m=m, k=k, g=g, rho=0.8, theta=0.0, z=2.0, vrho=0.3, omega=1.1, vz=0.9)
    names = ["particle.x", "particle.y", "particle.z"]
    rows = open_fmu("ParticleCylindrical").initialize(values, tolerance).run(6, 0.1, *names)

    def exact(t):
        x = 0.8 * np.cos(w * t) + 0.3 / w * np.sin(w * t)
        y = 0.8 * 1.1 / w * np.sin(w * t)
        return [x, y, 2 + 0.9 * t - g * t * t / 2]

    assert largest_error(rows, exact) < 100 * tolerance * 20


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_free_throw_is_a_parabola(open_fmu, tolerance):
    g = 2.3
    position, speed = np.array([0.5, -0.7, 0.4]), np.array([0.9, 0.6, 1.8])
    r = np.linalg.norm(position)
    rho2 = position[0] ** 2 + position[1] ** 2
    vr = position @ speed / r
    values = dict(
        m=1.9, g=g, r=r, theta=np.arctan2(position[1], position[0]), phi=np.arccos(position[2] / r), vr=vr,
        omegaTheta=(position[0] * speed[1] - position[1] * speed[0]) / rho2,
        omegaPhi=(position[2] / r * vr - speed[2]) / np.sqrt(rho2),
    )
    names = ["particle.x", "particle.y", "particle.z"]
    rows = open_fmu("ParticleSpherical").initialize(values, tolerance).run(2, 0.05, *names)
    exact = lambda t: position + speed * t - np.array([0, 0, g * t * t / 2])
    assert largest_error(rows, exact) < 100 * tolerance * 3


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("theta0", [0.3, 2.0, 3.1])
def test_pendulum(open_fmu, tolerance, theta0):
    l, g = 2.3, 4.1
    rows = open_fmu("SimplePendulum").initialize(dict(m=5, l=l, g=g, theta=theta0, omega=0), tolerance).run(20, 0.5, "theta")
    exact = lambda t: [pendulum_angle(theta0, np.sqrt(g / l), t)]
    # Near the top the motion itself amplifies errors.
    sensitivity = 1 / np.cos(theta0 / 2) ** 2
    assert largest_error(rows, exact) < 100 * tolerance * sensitivity


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_pendulum_over_the_top(open_fmu, tolerance):
    l, g, omega0 = 0.8, 9.0, 8.0
    rows = open_fmu("SimplePendulum").initialize(dict(l=l, g=g, theta=0, omega=omega0), tolerance).run(5, 0.1, "theta")
    assert largest_error(rows, lambda t: [turning_pendulum_angle(omega0, np.sqrt(g / l), t)]) < 100 * tolerance * 10


def test_linear_pendulum_is_a_cosine(open_fmu):
    l, g = 1.7, 3.3
    rows = open_fmu("SimplePendulumLinear").initialize(dict(l=l, g=g, theta=0.4, omega=0.2)).run(30, 0.3, "theta")
    w = np.sqrt(g / l)
    assert largest_error(rows, lambda t: [0.4 * np.cos(w * t) + 0.2 / w * np.sin(w * t)]) < 1e-12


def test_linear_cart_falls_exponentially(open_fmu):
    M, m, l, g = 2.0, 0.3, 0.6, 9.0
    rows = open_fmu("InvertedPendulumCartLinear").initialize(dict(M=M, m=m, l=l, g=g, theta=0.01)).run(2, 0.1, "theta", "x")
    rate = np.sqrt((M + m) * g / (M * l))

    def exact(t):
        theta = 0.01 * np.cosh(rate * t)
        return [theta, -(m * l / (M + m)) * (theta - 0.01)]

    assert largest_error(rows, exact) < 1e-11


@pytest.mark.parametrize("mode", [0, 4, 9])
def test_small_modes_of_the_chain(open_fmu, mode):
    """Small angles: M q'' = -K q with M_ij = m l^2 (n + 1 - max(i, j)), K_ii = m g l (n + 1 - i)."""
    n, m, l, g, amplitude = 10, 0.7, 0.4, 5.0, 1e-4
    M = np.array([[m * l * l * (n - max(i, j)) for j in range(n)] for i in range(n)])
    K = np.diag([m * g * l * (n - i) for i in range(n)])
    squares, shapes = eigh(K, M)
    shape = amplitude * shapes[:, mode] / np.max(np.abs(shapes[:, mode]))
    names = [f"theta[{i}]" for i in range(1, n + 1)]
    values = dict(m=m, l=l, g=g, **dict(zip(names, shape)))
    rows = open_fmu("ChainPendulum").initialize(values, 1e-12).run(5, 0.1, *names)
    w = np.sqrt(squares[mode])
    # Nonlinear terms are of third order in the amplitude, and grow with time.
    assert largest_error(rows, lambda t: shape * np.cos(w * t)) < 1e2 * amplitude**3 * w


def test_magnetic_circle(open_fmu):
    m, qB, speed = 1.3, 2.1, 0.8
    rows = open_fmu("ChargedParticle").initialize(dict(m=m, qB=qB, vx=0, vy=speed)).run(9, 0.3, "x", "y")
    w = qB / m
    assert largest_error(rows, lambda t: [speed / w * (1 - np.cos(w * t)), speed / w * np.sin(w * t)]) < 1e-12


def test_spherical_pendulum_reference(open_fmu):
    """Published 30-digit reference: l = 1, g = 9.81, theta = 1, phi' = 1 at t = 10."""
    instance = open_fmu("SphericalPendulum").initialize(dict(theta=1, nu=1), 1e-12)
    instance.run(10, 0.1)
    theta, phi = instance.get("theta", "phi")
    assert theta == pytest.approx(0.53437729667938416577, abs=1e-10)
    assert phi == pytest.approx(31.622515398049685580, abs=1e-10)


def test_motor_starts(open_fmu):
    """
    From rest at constant voltage: L i' = V - R i - k w and J w' = k i - b w - M. Each is its final value plus two exponentials, by the
    roots of L J s^2 + (L b + R J) s + R b + k^2.
    """
    R, L, k, J, b, V, M = 0.9, 2e-3, 0.04, 3e-5, 1e-4, 9.0, 0.05
    s = np.roots([L * J, L * b + R * J, R * b + k * k])
    end = np.array([b * V + k * M, k * V - R * M]) / (R * b + k * k)  # steady values of i and w
    slope = np.array([V / L, -M / J])  # at the start
    first = (slope + s[1] * end) / (s[0] - s[1])
    second = -end - first
    instance = open_fmu("Motor")
    instance.initialize(dict(R=R, L=L, k=k, J=J, b=b, voltage=V, load=M))
    for time in (0.0005, 0.004, 0.03, 0.5):
        instance.step(time - instance.time)
        exact = np.real(end + first * np.exp(s[0] * time) + second * np.exp(s[1] * time))
        angle = np.real(end * time + first * np.expm1(s[0] * time) / s[0] + second * np.expm1(s[1] * time) / s[1])
        np.testing.assert_allclose(instance.get("current", "omega"), exact, rtol=1e-11)
        np.testing.assert_allclose(instance.get("charge", "theta"), angle, rtol=1e-11)


def test_stiff_spring_becomes_a_rod(open_fmu):
    """For k -> infinity the motion is that of a rigid pendulum, up to the stretch m (g cos + l omega^2) / k."""
    instance = open_fmu("ElasticPendulum")
    instance.initialize(dict(k=1e10, c=2e5, l0=1.0, r=1.0, theta=0.5, g=9.81), 1e-9)
    rows = instance.run(5, 0.05, "theta", "r")
    exact = lambda t: [pendulum_angle(0.5, np.sqrt(9.81), t), 1.0]
    assert largest_error(rows, exact) < 1e-6
    assert instance.fmu.getInteger(instance.vr("solverSteps"))[0] < 20000


# Systems without a closed form, against SymPy's equations at 20 digits.
REFERENCES = {
    "DampedPendulum": dict(theta=2.5, omega=-1, m=0.7, l=1.3, g=5, b=0.4, tau=0.3),
    "InvertedPendulumCart": dict(x=0.1, theta=0.7, v=-0.3, omega=0.2, M=2, m=0.6, l=0.9, g=7, F=0.5),
    "InvertedPendulumCartTorque": dict(x=0.1, theta=0.7, v=-0.3, omega=0.2, M=2, m=0.6, l=0.9, g=7, F=0.5, tau=-0.2),
    "RotatingPivotPendulum": dict(theta=0.4, omega=1, m=2, l=0.8, g=6, r=0.3, w=3, gamma=0.5),
    "ElasticPendulum": dict(r=1.1, theta=0.8, vr=0, omega=0.5, m=1.2, l0=0.9, k=900, c=3, g=6),
    "DoublePendulum": dict(theta1=0.8, theta2=-0.4, omega1=0, omega2=1, m1=0.7, m2=1.4, l1=1.2, l2=0.6, g=8),
    "ChainPendulum": {f"theta[{i}]": 0.1 * i for i in range(1, 11)} | dict(m=0.3, l=0.5, g=6),
    "ParticlePolar": dict(r=1.2, theta=0, vr=0.1, omega=0.7, m=0.8, mu=0.9, Fr=0.05, Ftheta=0.02),
    "MotorPendulum": {"theta": 0.8, "motor.theta": 12.0, "voltage": 3.0, "m": 0.4, "l": 0.35, "g": 8, "n": 15, "c": 30, "d": 0.2,
                      "motor.R": 0.7, "motor.L": 2e-3, "motor.k": 0.06, "motor.J": 5e-5, "motor.b": 1e-4},
    "BeadOnHoop": dict(theta=0.3, omega=0, m=0.4, R=0.7, W=5, g=9),
    "FurutaPendulum": dict(alpha=0, theta=0.4, tau=0.02),
    "TwoCarts": {"x[1]": 0.3, "theta[2]": 0.9, "u": 0.1, "M": 1.5, "k": 20},
    "RollingDiskWithRod": dict(phi=1.0, slope=0.2),
}


@functools.cache
def reference(name, end):
    definition = system(name)
    return ExactMotion(definition, fmu.start_values(name) | REFERENCES[name], 30).trajectory([end])[0]


def error_of(name, tolerance, open_fmu):
    """Largest error at the end, relative to states larger than 1."""
    end = 1.0 if name == "ChainPendulum" else 2.0
    definition, exact = system(name), reference(name, end)
    states = [s.name for s in [*definition.q, *definition.v]]
    rows = open_fmu(name).initialize(REFERENCES[name], tolerance).run(end, 0.05, *states)
    return np.max(np.abs(rows[-1][1:] - exact) / np.maximum(1, np.abs(exact)))


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("name", REFERENCES)
def test_against_reference(name, tolerance, open_fmu):
    assert error_of(name, tolerance, open_fmu) < 100 * tolerance


@pytest.mark.parametrize("name", [name for name in REFERENCES if name in fmu.all_names() and name != "ElasticPendulum"])
def test_against_reference_at_the_limit_of_doubles(name, open_fmu):
    """Only rounding errors remain, including those of the start values, amplified by the motion."""
    assert error_of(name, 1e-14, open_fmu) < 1e-13


def test_forces_with_kinks(open_fmu):
    """A force of all functions of the language, with their kinks, agrees with SciPy's Dormand-Prince method of order 8."""
    definition, values = system("Functions"), dict(m=1.5, q=0.2, w=0.5, u=0.7, p=0.3)
    right_side = definition.right_side(lambda t: [values["u"]], [values["m"], values["p"]])
    exact = solve_ivp(right_side, (0, 2), [values["q"], values["w"]], method="DOP853", rtol=2.3e-14, atol=1e-14).y[:, -1]
    for tolerance in TOLERANCES:
        rows = open_fmu("Functions").initialize(values, tolerance).run(2.0, 0.05, "q", "w")
        assert np.max(np.abs(rows[-1][1:] - exact)) < 100 * tolerance


@pytest.mark.parametrize("name", sorted([*fmu.moving_names(), *fmu.further_names()]))
def test_communication_steps_do_not_matter(name, open_fmu):
    tolerance, end = 1e-8, 1.0
    instance = open_fmu(name)
    states = fmu.states_of(name)
    outcomes = []
    for step in (end, 0.1, 0.003, None):
        instance.reset().initialize(tolerance=tolerance)
        if step is not None:
            outcomes.append(instance.run(end, step, *states)[-1][1:])
            continue
        random = np.random.default_rng(1)
        for target in [*np.sort(random.uniform(0, end, 20)), end]:
            instance.step(target - instance.time)
            instance.time = target
        outcomes.append(instance.fmu.getReal(instance.vr(*states)))
    spread = np.ptp(np.array(outcomes), axis=0) / np.maximum(1, np.abs(outcomes[0]))
    assert np.max(spread) < 100 * tolerance
