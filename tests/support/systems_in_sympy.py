"""The systems of fmu/, typed again in SymPy, for comparison with the FMUs."""

import functools

import sympy as sp
from sympy import cos, sin, symbols

from mechanics import System, kinetic, rotation, time, turning, velocity


def particle_cartesian():
    x, y, z, vx, vy, vz = symbols("x y z vx vy vz")
    Fx, Fy, Fz, m, kx, ky, kz, g = symbols("Fx Fy Fz m kx ky kz g")
    q, v = [x, y, z], [vx, vy, vz]
    U = (kx * x**2 + ky * y**2 + kz * z**2) / 2 + m * g * z
    return System(
        q, v, m * (vx**2 + vy**2 + vz**2) / 2, U, [Fx, Fy, Fz], [Fx, Fy, Fz], [m, kx, ky, kz, g], {"particle": (x, y, z)}
    )


def particle_polar():
    r, theta, vr, omega, Fr, Ftheta, m, mu = symbols("r theta vr omega Fr Ftheta m mu")
    T = m * (vr**2 + r**2 * omega**2) / 2
    position = (r * cos(theta), r * sin(theta))
    return System(
        [r, theta], [vr, omega], T, -m * mu / r, [Fr, Ftheta], [Fr, Ftheta], [m, mu], {"particle": position}
    )


def particle_cylindrical():
    rho, theta, z, vrho, omega, vz = symbols("rho theta z vrho omega vz")
    Frho, Ftheta, Fz, m, k, g = symbols("Frho Ftheta Fz m k g")
    T = m * (vrho**2 + rho**2 * omega**2 + vz**2) / 2
    position = (rho * cos(theta), rho * sin(theta), z)
    forces = [Frho, Ftheta, Fz]
    return System(
        [rho, theta, z], [vrho, omega, vz], T, m * g * z + k * rho**2 / 2, forces, forces, [m, k, g],
        {"particle": position},
    )


def particle_spherical():
    r, theta, phi, vr, vtheta, vphi = symbols("r theta phi vr omegaTheta omegaPhi")
    Fr, Ftheta, Fphi, m, g = symbols("Fr Ftheta Fphi m g")
    T = m * (vr**2 + r**2 * vphi**2 + r**2 * sin(phi) ** 2 * vtheta**2) / 2
    position = (r * cos(theta) * sin(phi), r * sin(theta) * sin(phi), r * cos(phi))
    forces = [Fr, Ftheta, Fphi]
    return System(
        [r, theta, phi], [vr, vtheta, vphi], T, m * g * r * cos(phi), forces, forces, [m, g], {"particle": position}
    )


def pendulum(torque=False, linear=False):
    theta, omega, tau, m, l, g, b = symbols("theta omega tau m l g b")
    T, U = m * l**2 * omega**2 / 2, m * g * l * (1 - cos(theta))
    bob = {"bob": (l * sin(theta), -l * cos(theta))}
    if torque:
        return System([theta], [omega], T, U, [tau - b * omega], [tau], [m, l, g, b], bob)
    return System([theta], [omega], T, U, None, [], [m, l, g], bob, {} if linear else None)


def cart(torque=False, linear=False):
    x, theta, v, omega, F, tau, M, m, l, g = symbols("x theta v omega F tau M m l g")
    T = M * v**2 / 2 + m * ((v + l * omega * cos(theta)) ** 2 + (l * omega * sin(theta)) ** 2) / 2
    return System(
        [x, theta], [v, omega], T, m * g * l * cos(theta), [F, tau if torque else sp.Integer(0)],
        [F, tau] if torque else [F], [M, m, l, g],
        {"cart": (x,), "bob": (x + l * sin(theta), l * cos(theta))}, {} if linear else None,
    )


def rotating_pivot():
    theta, omega, m, l, g, r, w, gamma = symbols("theta omega m l g r w gamma")
    position = (r * cos(w * time) + l * cos(theta), -r * sin(w * time) + l * sin(theta))
    U = -m * g * (position[0] * cos(gamma) + position[1] * sin(gamma))
    q, v = [theta], [omega]
    return System(q, v, kinetic([(m, position)], q, v), U, None, [], [m, l, g, r, w, gamma], {"bob": position})


def elastic_pendulum():
    r, theta, vr, omega, m, l0, k, c, g = symbols("r theta vr omega m l0 k c g")
    T = m * (vr**2 + r**2 * omega**2) / 2
    U = k * (r - l0) ** 2 / 2 - m * g * r * cos(theta)
    bob = {"bob": (r * sin(theta), -r * cos(theta))}
    return System([r, theta], [vr, omega], T, U, [-c * vr, sp.Integer(0)], [], [m, l0, k, c, g], bob)


def passive_walker():
    """Swing phase of the compass gait, from the positions of hip and legs."""
    swing, stance, omega_swing, omega_stance = symbols("thetaSwing thetaStance omegaSwing omegaStance")
    m_hip, m, a, b, g, slope = symbols("mHip m a b g slope")
    q, v = [swing, stance], [omega_swing, omega_stance]
    leg = (-a * sin(stance), a * cos(stance))
    hip = (-(a + b) * sin(stance), (a + b) * cos(stance))
    other = (hip[0] + b * sin(swing), hip[1] - b * cos(swing))
    rate = lambda place: sum(sp.diff(place, angle) * omega for angle, omega in zip(q, v))
    T = sum(mass * sum(rate(x) ** 2 for x in place) / 2 for mass, place in ((m, leg), (m_hip, hip), (m, other)))
    U = g * (m * leg[1] + m_hip * hip[1] + m * other[1])
    places = {"stanceLeg": leg, "hip": hip, "swingLeg": other}
    return System(q, v, T, U, None, [], [m_hip, m, a, b, g, slope], places)


def double_pendulum():
    theta1, theta2, omega1, omega2, m1, m2, l1, l2, g = symbols("theta1 theta2 omega1 omega2 m1 m2 l1 l2 g")
    T = (
        (m1 + m2) * l1**2 * omega1**2 / 2
        + m2 * l2**2 * omega2**2 / 2
        + m2 * l1 * l2 * omega1 * omega2 * cos(theta1 - theta2)
    )
    U = -(m1 + m2) * g * l1 * cos(theta1) - m2 * g * l2 * cos(theta2)
    upper = (l1 * sin(theta1), -l1 * cos(theta1))
    lower = (upper[0] + l2 * sin(theta2), upper[1] - l2 * cos(theta2))
    return System(
        [theta1, theta2], [omega1, omega2], T, U, None, [], [m1, m2, l1, l2, g], {"upper": upper, "lower": lower}
    )


def chain_pendulum(count=10):
    """n-pendulum with T in closed form: m l^2 / 2 sum_ij (n + 1 - max(i, j)) w_i w_j cos(theta_i - theta_j)."""
    m, l, g = symbols("m l g")
    theta = [sp.Symbol(f"theta[{i}]") for i in range(1, count + 1)]
    omega = [sp.Symbol(f"omega[{i}]") for i in range(1, count + 1)]
    T = sum(
        m * l**2 / 2 * (count - max(i, j)) * omega[i] * omega[j] * cos(theta[i] - theta[j])
        for i in range(count)
        for j in range(count)
    )
    U = -sum(m * g * l * (count - i) * cos(theta[i]) for i in range(count))
    return System(theta, omega, T, U, None, [], [m, l, g])


def bead_on_hoop():
    theta, omega, m, R, W, g = symbols("theta omega m R W g")
    T = m * R**2 * (omega**2 + W**2 * sin(theta) ** 2) / 2
    return System([theta], [omega], T, -m * g * R * cos(theta), None, [], [m, R, W, g])


def spherical_pendulum():
    theta, phi, omega, nu, m, l, g = symbols("theta phi omega nu m l g")
    T = m * l**2 * (omega**2 + sin(theta) ** 2 * nu**2) / 2
    return System([theta, phi], [omega, nu], T, -m * g * l * cos(theta), None, [], [m, l, g])


def furuta_pendulum():
    alpha, theta, nu, omega, tau, Ja, m, J, a, l, b, g = symbols("alpha theta nu omega tau Ja m J a l b g")
    T = (
        (Ja + m * a**2 + (m * l**2 + J) * sin(theta) ** 2) * nu**2 / 2
        + (m * l**2 + J) * omega**2 / 2
        + m * a * l * cos(theta) * nu * omega
    )
    U = m * g * l * cos(theta)
    return System([alpha, theta], [nu, omega], T, U, [tau - b * nu, -b * omega], [tau], [Ja, m, J, a, l, b, g])


def charged_particle():
    """m x'' = qB y', m y'' = -qB x'."""
    x, y, vx, vy, m, qB = symbols("x y vx vy m qB")
    return System([x, y], [vx, vy], m * (vx**2 + vy**2) / 2, 0, [qB * vy, -qB * vx], [], [m, qB])


def relativistic_particle():
    x, y, vx, vy, m, k = symbols("x y vx vy m k")
    c = 10
    T = m * c**2 * (1 - sp.sqrt(1 - (vx**2 + vy**2) / c**2))
    return System([x, y], [vx, vy], T, k * (x**2 + y**2) / 2, None, [], [m, k])


def moving_belt():
    q, v, F, m, w = symbols("q v F m w")
    return System([q], [v], m * (v + w) ** 2 / 2, sp.Integer(0), [F], [F], [m, w], {"load": (q + w * time,)})


def two_carts():
    M, m, l, k, g, u = symbols("M m l k g u")
    x = symbols("x[1] x[2]")
    theta, v, omega = symbols("theta[1] theta[2]"), symbols("v[1] v[2]"), symbols("omega[1] omega[2]")
    s, vs = symbols("s vs")
    q, velocities = [x[0], theta[0], x[1], theta[1], s], [v[0], omega[0], v[1], omega[1], vs]
    T = sum(
        M * v[i] ** 2 / 2 + m * (v[i] ** 2 + 2 * l * v[i] * omega[i] * cos(theta[i]) + l**2 * omega[i] ** 2) / 2
        for i in range(2)
    )
    T += M * velocity(s + sp.Rational(1, 20) * sin(2 * time), [s], [vs]) ** 2 / 2
    U = -m * g * l * (cos(theta[0]) + cos(theta[1])) + k * (x[0] - x[1]) ** 2 / 2
    forces = [0, 0, 0, 0, k * (u - s) + cos(time) / 10]
    return System(q, velocities, T, U, [sp.sympify(f) for f in forces], [u], [M, m, l, k, g])


def rolling_disk_with_rod():
    s, phi, v, omega, m, J, r, mr, Jr, d, slope, g = symbols("s phi v omega m J r mr Jr d slope g")
    hinge_velocity = sp.Matrix([v * cos(slope), -v * sin(slope)])
    rod_velocity = hinge_velocity + omega * d * sp.Matrix([cos(phi), sin(phi)])
    T = (m + J / r**2) * v**2 / 2 + mr * rod_velocity.dot(rod_velocity) / 2 + Jr * omega**2 / 2
    U = -(m + mr) * g * s * sin(slope) - mr * g * d * cos(phi)
    return System([s, phi], [v, omega], T, U, None, [], [m, J, r, mr, Jr, d, slope, g])


def functions():
    q, w, u, m, p = symbols("q w u m p", real=True)
    U = sp.sqrt(1 + q**2) + sp.exp(-q) * sp.cosh(p * q) + sp.log(2 + sin(q)) + sp.asinh(q) + 2**q
    U += (sp.Rational(3, 2) + p) ** (q / 3)
    Q = sp.atan2(q, 1 + p**2) + sp.tan(q / 4) + sp.tanh(u) + sp.atan(w) + sp.asin(q / 9) + sp.acos(q / 9)
    Q += sp.sinh(w / 5) + sp.Piecewise((q, q < u), (u, True)) + sp.Piecewise((w, w > 0), (0, True))
    Q += -sp.Rational(1, 10) * sp.Abs(w) * w + sp.sign(u) * p + sp.acosh(2 + q**2) + sp.atanh(q / 9)
    Q += sin(3 * time) * cos(time / 2) - sp.pi * w + q**3 / (1 + time**2)
    return System([q], [w], m * w**2 / 2, U, [Q], [u], [m, p])


def coupled_oscillators():
    m1, m2, k1, k2, k, b1, b2, f1, f2, F = symbols("m1 m2 k1 k2 k b1 b2 f1 f2 F")
    x1, x2, v1, v2 = symbols("x1 x2 v1 v2")
    T = m1 * v1**2 / 2 + m2 * v2**2 / 2
    U = k1 * x1**2 / 2 + k2 * x2**2 / 2 + k * (x1 - x2) ** 2 / 2
    return System([x1, x2], [v1, v2], T, U, [f1 + F - b1 * v1, f2 - b2 * v2], [F], [m1, m2, k1, k2, k, b1, b2, f1, f2])


def lattice(count=8):
    m, k, b, c, F = symbols("m k b c F")
    x = [sp.Symbol(f"x[{i}]") for i in range(1, count + 1)]
    v = [sp.Symbol(f"v[{i}]") for i in range(1, count + 1)]
    stretches = [right - left for left, right in zip([0, *x], [*x, 0])]
    U = sum(k * s**2 / 2 + b * s**4 / 4 for s in stretches)
    Q = [sp.Integer(0)] * count
    for i in range(1, count):
        damping = c * (v[i] - v[i - 1])
        Q[i - 1] += damping
        Q[i] -= damping
    Q[0] += F
    positions = {f"mass[{i + 1}]": (x[i],) for i in range(count)}
    return System(x, v, sum(m * vi**2 / 2 for vi in v), U, Q, [F], [m, k, b, c], positions)


def seat_suspension():
    zs, zd, vs, vd, ms, md, ks, cs, kd, cd = symbols("zs zd vs vd ms md ks cs kd cd")
    zb, rate, acceleration = symbols("zb der(zb) der(der(zb))")
    T = ms * (rate + vs) ** 2 / 2 + md * vd**2 / 2
    U = (ks * zs**2 + kd * (zd - zb - zs) ** 2) / 2
    cushion = cd * (vd - rate - vs)
    return System(
        [zs, zd], [vs, vd], T, U, [cushion - cs * vs, -cushion], [zb, rate, acceleration],
        [ms, md, ks, cs, kd, cd], {"seat": (0, 0, zb + zs), "driver": (0, 0, zd)}, rates={zb: rate, rate: acceleration},
    )


def inerter_tree():
    m, b, a, k = symbols("m b a k")
    x = [sp.Symbol(f"x[{i}]") for i in range(1, 8)]
    v = [sp.Symbol(f"v[{i}]") for i in range(1, 8)]
    T = sum(m * vi**2 / 2 for vi in v)
    for child in range(1, 7):
        parent = (child - 1) // 2
        stretch, rate = x[child] - x[parent], v[child] - v[parent]
        T += b / 2 * (rate * (1 + (stretch / a) ** 2)) ** 2
    return System(x, v, T, sum(k * xi**2 / 2 for xi in x), None, [], [m, b, a, k])


def motor():
    """DC motor by Kirchhoff's voltage law of the armature and Newton's law of the rotor."""
    charge, theta, current, omega, voltage, load = symbols("charge theta current omega voltage load")
    R, L, k, J, b = symbols("R L k J b")
    forces = [voltage - R * current - k * omega, k * current - b * omega - load]
    T = L * current**2 / 2 + J * omega**2 / 2
    return System([charge, theta], [current, omega], T, sp.Integer(0), forces, [voltage, load], [R, L, k, J, b])


def motor_pendulum():
    theta, omega, voltage, m, l, g, n, c, d = symbols("theta omega voltage m l g n c d")
    charge, phi, current, nu, R, L, k, J, b = symbols(" ".join(f"motor.{s}" for s in "charge theta current omega R L k J b".split()))
    shaft = c * (phi / n - theta) + d * (nu / n - omega)
    T = m * l**2 * omega**2 / 2 + L * current**2 / 2 + J * nu**2 / 2
    U = m * g * l * (1 - cos(theta)) + c * (phi / n - theta) ** 2 / 2
    damper = d * (nu / n - omega)
    assert sp.simplify(shaft - damper + sp.diff(U, theta) - m * g * l * sin(theta)) == 0
    forces = [damper, voltage - R * current - k * nu, k * current - b * nu - damper / n]
    return System(
        [theta, charge, phi], [omega, current, nu], T, U, forces, [voltage], [m, l, g, n, c, d, R, L, k, J, b],
        {"bob": (l * sin(theta), -l * cos(theta))},
    )


def heavy_top():
    phi, theta, psi, vphi, vtheta, vpsi, m, l, I1, I3, g = symbols("phi theta psi vphi vtheta vpsi m l I1 I3 g")
    q, v = [phi, theta, psi], [vphi, vtheta, vpsi]
    turn = rotation("z", phi) * rotation("x", theta) * rotation("z", psi)
    centre = turn * sp.Matrix([0, 0, l])
    T = kinetic([(m, centre)], q, v) + turning(turn, [I1, I1, I3], q, v)
    return System(q, v, T, m * g * centre[2], None, [], [m, l, I1, I3, g], {"rotor": tuple(centre)})


def gyrocompass():
    alpha, phi, nu, omega, J, C, W, latitude, b = symbols("alpha phi nu omega J C W latitude b")
    q, v = [alpha, phi], [nu, omega]
    turn = rotation("z", W * time) * rotation("y", -latitude) * rotation("x", alpha) * rotation("z", phi)
    T = turning(turn, [J, J, C], q, v)
    return System(q, v, T, sp.Integer(0), [-b * nu, sp.Integer(0)], [], [J, C, W, latitude, b])


def flyball_governor():
    """Flyball governor; the lengths of the springs follow in the rotating plane of shaft and arm."""
    psi, s, Omega, vs = symbols("psi s Omega vs")
    alpha, nu = symbols("alpha[1] alpha[2]"), symbols("nu[1] nu[2]")
    rho, L, w, e, h, mBall, k, c, l0, g = symbols("rho L w e h mBall k c l0 g")
    q, v = [psi, s, *alpha], [Omega, vs, *nu]
    prism, mSlider = rho * L * w**2, rho * e**3
    along, across = prism * w**2 / 6, prism * (L**2 + w**2) / 12
    T = (along + mSlider * e**2 / 6) * Omega**2 / 2 + mSlider * vs**2 / 2
    U = prism * g * L / 2 + mSlider * g * s
    Q, positions = [sp.Integer(0)] * 4, {"slider": (0, 0, s)}
    for i in range(2):
        outwards = rotation("z", psi + i * sp.pi)
        place = lambda way: outwards * sp.Matrix([h + way * cos(alpha[i]), 0, L - way * sin(alpha[i])])
        T += kinetic([(prism, place(L / 2)), (mBall, place(L))], q, v)
        T += turning(outwards * rotation("y", alpha[i]), [along, across, across], q, v)
        length = sp.sqrt((L / 2 * cos(alpha[i])) ** 2 + (L - L / 2 * sin(alpha[i]) - s) ** 2)
        U += prism * g * place(L / 2)[2] + mBall * g * place(L)[2] + k * (length - l0) ** 2 / 2
        rate = velocity(length, q, v)
        Q = [Qj - c * rate * sp.diff(length, qj) for Qj, qj in zip(Q, q)]
        positions[f"ball[{i + 1}]"] = tuple(place(L))
    return System(q, v, T, U, Q, [], [rho, L, w, e, h, mBall, k, c, l0, g], positions)


DEFINITIONS = {
    "HeavyTop": heavy_top,
    "Gyrocompass": gyrocompass,
    "FlyballGovernor": flyball_governor,
    "Motor": motor,
    "MotorPendulum": motor_pendulum,
    "ParticleCartesian": particle_cartesian,
    "ParticlePolar": particle_polar,
    "ParticleCylindrical": particle_cylindrical,
    "ParticleSpherical": particle_spherical,
    "SimplePendulum": pendulum,
    "SimplePendulumLinear": functools.partial(pendulum, linear=True),
    "DampedPendulum": functools.partial(pendulum, torque=True),
    "InvertedPendulumCart": cart,
    "InvertedPendulumCartLinear": functools.partial(cart, linear=True),
    "InvertedPendulumCartTorque": functools.partial(cart, torque=True),
    "InvertedPendulumCartTorqueLinear": functools.partial(cart, torque=True, linear=True),
    "RotatingPivotPendulum": rotating_pivot,
    "ElasticPendulum": elastic_pendulum,
    "PassiveWalker": passive_walker,
    "DoublePendulum": double_pendulum,
    "ChainPendulum": chain_pendulum,
    "SeatSuspension": seat_suspension,
    "BeadOnHoop": bead_on_hoop,
    "SphericalPendulum": spherical_pendulum,
    "FurutaPendulum": furuta_pendulum,
    "ChargedParticle": charged_particle,
    "RelativisticParticle": relativistic_particle,
    "MovingBelt": moving_belt,
    "TwoCarts": two_carts,
    "RollingDiskWithRod": rolling_disk_with_rod,
    "Functions": functions,
    "CoupledOscillators": coupled_oscillators,
    "Lattice": lattice,
    "InerterTree": inerter_tree,
}


@functools.cache
def system(name):
    return DEFINITIONS[name]()
