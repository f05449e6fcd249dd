"""The systems of fmu/ with first-order states, against closed forms and SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.special import jv, yv


def rows_of(instance, end, step, *names):
    return np.array(instance.run(end, step, *names))


# PidController: K = 2, Ti = 0.5, Td = 0.1, N = 10, Tt = 0.2 and limits of 5 by default.


def test_pid_ramp(open_fmu):
    """Ramp y = t, by an input polynomial: P = -K t, I = -K/Ti t^2/2, D = -K Td (1 - exp(-N t/Td))."""
    instance = open_fmu("PidController").initialize(dict(r=0.0, uMin=-1e3, uMax=1e3), 1e-10)
    for i in range(20):
        time = 0.05 * i
        instance.set(y=time)
        instance.fmu.setRealInputDerivatives(instance.vr("y"), [1], [1.0])
        instance.step(0.05)
        t = instance.time
        instance.set(y=t)
        assert instance.get("u") == pytest.approx(-2 * t - 2 * t**2 - 0.2 * -np.expm1(-100 * t), rel=1e-8)


def test_pid_winds_up_to_its_end(open_fmu):
    """
    r = 1: I = K t/Ti until K + I = 5 at 0.75 s; then I tends to 5 - K + Tt K/Ti = 3.8 with time constant Tt. At 2 s the error becomes 0.
    """
    instance = open_fmu("PidController").initialize({}, 1e-10)
    rows = rows_of(instance, 2.0, 0.05, "I", "u")
    t = rows[:, 0]
    integral = np.where(t < 0.75, 4 * t, 3.8 - 0.8 * np.exp(-(t - 0.75) / 0.2))
    np.testing.assert_allclose(rows[:, 1], integral, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(rows[:, 2], np.minimum(5, 2 + 4 * t), rtol=1e-9)
    instance.set(y=1.0)  # the error is 0: the derivative pushes the output to its lower limit, P = 0
    assert instance.get("u") == -5
    instance.step(1.0)
    assert instance.get("u") == pytest.approx(instance.get("I"), rel=1e-9)  # within the limits, after D has decayed


def test_pid_without_wind_up_would_take_longer(open_fmu):
    """With Tt = 0.2 s the output leaves its limit at once; without anti-windup (Tt = 1e6 s) only after the integral has decreased."""
    slow, fast = (open_fmu("PidController").initialize(dict(Tt=Tt, Td=1e-3), 1e-10) for Tt in (1e6, 0.2))
    for instance in (slow, fast):
        instance.step(2.0)
        instance.set(r=-1.0)
        instance.step(0.5)
    # I(2) = 4 t = 8 without anti-windup, and falls by 4/s: P + I = -2 + 6 at 2.5 s, against -2 + 3.8 - ...
    assert slow.get("u") == pytest.approx(4.0, rel=1e-5)
    assert fast.get("u") == pytest.approx(-2 + (3.8 - 0.8 * np.exp(-1.25 / 0.2)) - 2.0, rel=1e-9)


# BristleFriction (LuGre)


def bristles(t, y, values):
    x, v, z = y
    g = values["Fc"] + (values["Fs"] - values["Fc"]) * np.exp(-((v / values["vs"]) ** 2))
    rate = v - values["sigma0"] * abs(v) / g * z
    friction = values["sigma0"] * z + values["sigma1"] * rate + values["sigma2"] * v
    return [v, (values["k"] * (values["vPull"] * t - x) - friction) / values["m"], rate]


PAPER = dict(m=1.0, k=2.0, vPull=0.1, sigma0=1e5, sigma1=np.sqrt(1e5), sigma2=0.4, Fc=1.0, Fs=1.5, vs=1e-3)


def test_stick_slip_of_bristles(open_fmu):
    """Experiment of figure 3 of the LuGre paper, against Radau in SciPy."""
    rows = rows_of(open_fmu("BristleFriction").initialize({}, 1e-9), 20.0, 0.05, "x", "v", "z")
    solution = solve_ivp(bristles, (0, 20), [0, 0, 0], method="Radau", args=(PAPER,), t_eval=rows[:, 0], rtol=1e-9,
                         atol=[1e-11, 1e-11, 1e-14], max_step=0.05)  # fmt: skip
    np.testing.assert_allclose(rows[:, 1], solution.y[0], atol=3e-6)
    moving = rows[:, 2] > 0.05
    assert 0.1 < np.mean(moving) < 0.9  # stick-slip


def test_presliding(open_fmu):
    """Below Fs, z = F/sigma0 and dx = dz/(1 - F/Fs): the block creeps by -Fs/sigma0 log(1 - F/Fs), some micrometres."""
    instance = open_fmu("BristleFriction").initialize({}, 1e-9)
    for force in (0.2, 0.6, 1.0, 1.2):
        instance.step(force / 0.2 - instance.time)
        assert instance.get("x") == pytest.approx(-1.5e-5 * np.log(1 - force / 1.5), rel=5e-3)


def test_steady_sliding_of_bristles(open_fmu):
    """At a constant velocity the friction is Fc + (Fs - Fc) exp(-(v/vs)^2) + sigma2 v (Stribeck's curve)."""
    for velocity in (5e-4, 1e-3, 2e-3, 0.1):
        start = dict(k=1e6, vPull=velocity, v=velocity, sigma2=2000.0)  # stabilizes the falling part of the curve
        instance = open_fmu("BristleFriction").initialize(start, 1e-9)
        instance.step(2.0)
        assert instance.get("v") == pytest.approx(velocity, rel=1e-5)
        assert instance.get("frictionForce") == pytest.approx(1 + 0.5 * np.exp(-((velocity / 1e-3) ** 2)) + 2000 * velocity, rel=1e-5)


# HydraulicCylinder

OIL = dict(m=50.0, A1=2e-3, A2=1.2e-3, length=0.5, dead=1e-4, E=1.4e9, rho=870.0, pSupply=1.6e7, pTank=1e5, opening=1e-5, alpha=0.7,
           dpLaminar=1e5, leak=1e-12, b=500.0)  # fmt: skip


def cylinder(t, y, u, F, o=OIL):
    x, v, p1, p2 = y
    edge = lambda dp: o["alpha"] * o["opening"] * np.sqrt(2 / o["rho"]) * dp / (dp**2 + o["dpLaminar"] ** 2) ** 0.25
    q1 = u * edge(o["pSupply"] - p1 if u > 0 else p1 - o["pTank"])
    q2 = -u * edge(p2 - o["pTank"] if u > 0 else o["pSupply"] - p2)
    leak = o["leak"] * (p1 - p2)
    return [v, (p1 * o["A1"] - p2 * o["A2"] - F - o["b"] * v) / o["m"],
            o["E"] / (o["dead"] + o["A1"] * x) * (q1 - o["A1"] * v - leak),
            o["E"] / (o["dead"] + o["A2"] * (o["length"] - x)) * (q2 + o["A2"] * v + leak)]  # fmt: skip


@pytest.mark.parametrize("u, F", [(0.5, 0.0), (0.5, 8000.0), (-0.4, 0.0), (0.0, 500.0)])
def test_cylinder(u, F, open_fmu):
    """Extension, extension against a load, retraction, and a closed valve, against SciPy."""
    rows = rows_of(open_fmu("HydraulicCylinder").initialize(dict(u=u, F=F), 1e-9), 0.4, 0.01, "x", "v", "p1", "p2")
    solution = solve_ivp(cylinder, (0, 0.4), [0.1, 0, 5e6, 8e6], method="Radau", args=(u, F), t_eval=rows[:, 0], rtol=1e-10,
                         atol=[1e-12, 1e-12, 1e-3, 1e-3])  # fmt: skip
    for column, scale in enumerate([1e-8, 1e-6, 20.0, 20.0]):
        np.testing.assert_allclose(rows[:, 1 + column], solution.y[column], atol=scale, rtol=1e-6)


def test_cylinder_ends_at_its_stop(open_fmu):
    """
    With the valve open, the piston reaches its stop. The pressures become those of supply and tank, and the stop carries the difference.
    """
    instance = open_fmu("HydraulicCylinder").initialize(dict(u=1.0, leak=0.0), 1e-8)
    instance.step(4.0)
    x, v, p1, p2, force = instance.get("x", "v", "p1", "p2", "x.max.force")
    assert (x, v) == (pytest.approx(0.5, abs=1e-12), pytest.approx(0.0, abs=1e-12))
    assert (p1, p2) == (pytest.approx(1.6e7, rel=1e-6), pytest.approx(1e5, rel=1e-3))
    assert force == pytest.approx(p1 * 2e-3 - p2 * 1.2e-3, rel=1e-9)


def test_steady_speed_of_the_cylinder(open_fmu):
    """Without load and friction p1 A1 = p2 A2 and q1 A2 = q2 A1: (ps - p1) (A2/A1)^2 = p2 - pt (Merritt)."""
    values = dict(length=50.0, b=0.0, leak=0.0, dpLaminar=1.0, u=1.0, x=5.0)
    instance = open_fmu("HydraulicCylinder").initialize(values, 1e-9)
    instance.step(8.0)
    p1 = (1.6e7 * (1.2 / 2) ** 2 + 1e5) / (2 / 1.2 + (1.2 / 2) ** 2)
    assert instance.get("p1") == pytest.approx(p1, rel=1e-4)
    assert instance.get("v") == pytest.approx(0.7 * 1e-5 * np.sqrt(2 / 870 * (1.6e7 - p1)) / 2e-3, rel=1e-4)


# GantryCrane


def test_rope_of_changing_length(open_fmu):
    """
    A load lowered at constant speed by a trolley at rest: l theta'' + 2 l' theta' + g theta = 0 for small angles, with l = l0 + w t. In s =
    2 sqrt(g l)/w this is Bessel's equation: theta = (a J1(s) + b Y1(s))/s.
    """
    w, l0, g = 0.25, 4.0, 9.81
    start = dict(trolleySpeed=0.0, hoistSpeed=w, theta=1e-4, l=l0, w=w, d=0.0, M=1e9, kl=1e9, Fl=1e9)
    rows = rows_of(open_fmu("GantryCrane").initialize(start, 1e-10), 20.0, 0.1, "theta", "l")
    s = lambda t: 2 * np.sqrt(g * (l0 + w * t)) / w
    # d/ds (Z1(s)/s) = -Z2(s)/s
    a, b = np.linalg.solve([[jv(1, s(0)) / s(0), yv(1, s(0)) / s(0)], [-jv(2, s(0)) / s(0), -yv(2, s(0)) / s(0)]], [1e-4, 0])
    t = rows[:, 0]
    np.testing.assert_allclose(rows[:, 2], l0 + w * t, rtol=1e-5)
    np.testing.assert_allclose(rows[:, 1], (a * jv(1, s(t)) + b * yv(1, s(t))) / s(t), atol=3e-8)


def test_crane_between_its_switches(open_fmu):
    """The drive gives its full force while the speed error exceeds Fx/kx; the trolley ends at the stop."""
    instance = open_fmu("GantryCrane").initialize(dict(trolleySpeed=2.0, m=1e-3, J=0.0, d=0.0, Fx=400.0), 1e-9)
    instance.step(1.0)
    assert instance.get("v") == pytest.approx(0.5, rel=1e-4)  # 400 N on 800 kg
    instance.step(20.0)
    x, v, force = instance.get("x", "v", "x.max.force")
    assert (x, v) == (pytest.approx(20.0, abs=1e-9), pytest.approx(0.0, abs=1e-9)) and force == pytest.approx(400.0, rel=1e-3)


def test_crane_in_numbers(open_fmu):
    """With all drives active, the motion agrees with SciPy on Lagrange's equations written by hand."""
    M, m, J, g, d, kx, Fx, kl, Fl = 800.0, 1500.0, 200.0, 9.81, 30.0, 20000.0, 6000.0, 60000.0, 30000.0

    def rates(t, y):
        x, l, a, v, w, o = y
        s, c = np.sin(a), np.cos(a)
        fx, fl = np.clip(kx * (1.0 - v), -Fx, Fx), np.clip(m * g + kl * (w + 0.3), -Fl, Fl)
        ux, uy = v + w * s + l * o * c, -w * c + l * o * s  # velocity of the load
        mass = np.array([[M + m, m * s, m * l * c], [m * s, m + J, 0], [m * l * c, 0, m * l**2]])
        right = [fx - m * (2 * w * o * c - l * o**2 * s) - d * ux, m * l * o**2 + m * g * c - fl - d * (ux * s - uy * c),
                 -2 * m * l * w * o - m * g * l * s - d * l * (ux * c + uy * s)]  # fmt: skip
        return [v, w, o, *np.linalg.solve(mass, right)]

    rows = rows_of(open_fmu("GantryCrane").initialize(dict(hoistSpeed=-0.3), 1e-9), 8.0, 0.1, "x", "l", "theta")
    solution = solve_ivp(rates, (0, 8), [2, 8, 0, 0, 0, 0], method="Radau", t_eval=rows[:, 0], rtol=1e-10, atol=1e-12, max_step=0.01)
    np.testing.assert_allclose(rows[:, 1:], solution.y[:3].T, atol=1e-6)


# DigitalServo

SERVO = dict(R=2.0, L=1e-3, k=0.05, J=2e-5, b=1e-5, Ts=1e-3, q=1e-3, kp=6.0, kd=0.08, uMax=24.0)


def servo(period, s=SERVO):
    """Discrete-time motor over a period of constant voltage: x(t + period) = A x + B u for (theta, omega, i)."""
    rates = np.zeros((4, 4))
    rates[0, 1] = 1
    rates[1, 1:3] = -s["b"] / s["J"], s["k"] / s["J"]
    rates[2, 1:] = -s["k"] / s["L"], -s["R"] / s["L"], 1 / s["L"]
    whole = expm(rates * period)
    return whole[:3, :3], whole[:3, 3]


@pytest.mark.parametrize("ref, q, uMax", [(1.0, 1e-3, 24.0), (1.0, 1e-3, 3.0), (0.02, 2e-3, 24.0)])
def test_servo_is_its_recursion(ref, q, uMax, open_fmu):
    """
    The matrix exponential gives the motion between 200 samples, and the counts of the encoder give the voltage, with and without
    saturation.
    """
    instance = open_fmu("DigitalServo").initialize(dict(ref=ref, q=q, uMax=uMax), 1e-11)
    A, B = servo(SERVO["Ts"])
    x, u, late, count = np.zeros(3), 0.0, 0.0, 0.0
    for k in range(200):
        measured = q * np.round(x[0] / q)
        u, late = late, np.clip(SERVO["kp"] * (ref - measured) - SERVO["kd"] * (measured - count) / SERVO["Ts"], -uMax, uMax)
        count = measured
        instance.step(SERVO["Ts"] / 2)  # a sample at the end of a step belongs to it
        assert instance.get("voltage") == pytest.approx(u, rel=1e-12)
        instance.step(SERVO["Ts"] / 2)
        x = A @ x + B * u
        np.testing.assert_allclose(instance.get("theta", "omega", "i"), x, rtol=1e-7, atol=1e-9)


def test_servo_by_the_z_transform(open_fmu):
    """
    Without quantization by the encoder the loop is linear. Its step response is that of the transfer function from ref to theta, z^-1 P(z)
    kp/(1 + z^-1 P(z) (kp + kd (1 - z^-1)/Ts)), here as a sum over its poles.
    """
    A, B = servo(SERVO["Ts"])
    kp, kd = SERVO["kp"], SERVO["kd"] / SERVO["Ts"]
    # States: theta, omega, i, the delayed voltage, the last count.
    loop = np.zeros((5, 5))
    loop[:3, :3], loop[:3, 3] = A, B
    loop[3, 0], loop[3, 4], loop[4, 0] = -(kp + kd), kd, 1
    poles, vectors = np.linalg.eig(loop)
    assert np.abs(poles).max() < 1
    rest = np.linalg.solve(np.eye(5) - loop, [0, 0, 0, kp, 0])
    assert rest[0] == pytest.approx(1, rel=1e-9)
    shares = np.linalg.solve(vectors, -rest)
    instance = open_fmu("DigitalServo").initialize(dict(q=1e-14, uMax=1e9), 1e-11)
    for k in range(1, 101):
        instance.step(SERVO["Ts"])
        assert instance.get("theta") == pytest.approx((rest + vectors @ (shares * poles**k))[0].real, abs=1e-8)


# WormGear

WORM = dict(J1=1e-3, J2=0.5, n=30.0, load=60.0)


def worm(tau, c, back=1.0, s=WORM):
    """
    Acceleration of the worm and torque L of the teeth: J1 a'' = tau - L - back c L, J2 a''/n = n L - load for L > 0, with back = 1 while it
    lifts and -1 while it lowers.
    """
    loss = 1 + back * c
    acceleration = (tau - loss * s["load"] / s["n"]) / (s["J1"] + loss * s["J2"] / s["n"] ** 2)
    return acceleration, (s["load"] + s["J2"] * acceleration / s["n"]) / s["n"]


@pytest.mark.parametrize("tau, c, omega", [(6.0, 1.5, 0.0), (5.2, 1.5, 3.0), (-1.5, 1.5, -3.0), (0.0, 0.2, 0.0), (3.0, 0.2, 0.0)])
def test_worm_lifts_and_lowers(tau, c, omega, open_fmu):
    """
    Lifting takes extra torque for the loss; a self-locking gear is lowered by the motor; otherwise the load runs down. From rest and in
    motion.
    """
    back = 1.0 if omega > 0 or tau > (1 + c) * 2 else -1.0
    acceleration, _ = worm(tau, c, back)
    instance = open_fmu("WormGear").initialize({"tau": tau, "c": c, "omega": omega, "W": omega / 30}, 1e-9)
    instance.step(0.01)
    assert instance.get("omega") == pytest.approx(omega + 0.01 * acceleration, rel=1e-9)
    assert instance.get("phi") == pytest.approx((0.01 * omega + 0.01**2 / 2 * acceleration) / 30, rel=1e-8)


@pytest.mark.parametrize("tau", [-0.9, 0.0, 2.0, 4.9])
def test_worm_sticks(tau, open_fmu):
    """Nothing moves for torques from (1 - c) load/n = -1 N.m to (1 + c) load/n = 5 N.m."""
    instance = open_fmu("WormGear").initialize({"tau": tau}, 1e-9)
    instance.step(1.0)
    assert instance.get("omega", "a", "phi") == pytest.approx([0, 0, 0], abs=1e-12)


def test_efficiency_of_the_worm(open_fmu):
    """In steady lifting the load receives 1/(1 + c) of the motor's power, at any speed."""
    instance = open_fmu("WormGear").initialize({"tau": 5.0, "omega": 12.0, "W": 0.4}, 1e-9)
    instance.step(0.5)
    assert instance.get("omega") == pytest.approx(12.0, rel=1e-9)
    assert instance.get("power") / (5.0 * instance.get("omega")) == pytest.approx(1 / 2.5, rel=1e-9)


# HalfCar


def half_car():
    """
    Return (A, B) of d/dt x = A x + B n. x: z, pitch, zf, zr, their velocities, roads, forces, filters, integrals; n: noises and bumps of
    both axles.
    """
    m, J, mw, lf, lr, k, c, kt, gain, lag, speed, cut = 700, 1200, 40, 1.2, 1.5, 2e4, 1200, 1.8e5, 1000, 0.01, 20, 0.07
    K, Ti, Td, N = 20, 2, 0.2, 10
    A, B = np.zeros((16, 16)), np.zeros((16, 4))
    A[0:4, 4:8] = np.eye(4)
    mass, arms = np.diag([m, J, mw, mw]), np.array([[1, lf, -1, 0], [1, -lr, 0, -1]])  # stretch of the suspensions
    tyres = np.diag([0, 0, kt, kt])
    inverse = np.linalg.inv(mass)
    A[4:8, 0:4] = -inverse @ (k * arms.T @ arms + tyres)
    A[4:8, 4:8] = -inverse @ (c * arms.T @ arms)
    A[4:8, 8:10] = inverse @ np.array([[0, 0], [0, 0], [kt, 0], [0, kt]])
    A[4:8, 10:12] = inverse @ arms.T
    A[8:10, 8:10] = -cut * speed * np.eye(2)
    heights = np.zeros((2, 16))
    heights[:, :2] = arms[:, :2]
    filters, integrals = np.eye(16)[12:14], np.eye(16)[14:16]
    outputs = -K * heights + integrals + K * N * (filters - heights)
    A[10:12] = gain * outputs / lag - np.eye(16)[10:12] / lag
    A[12:14] = N / Td * (heights - filters)
    A[14:16] = -K / Ti * heights
    B[8, 0] = B[9, 1] = 1
    B[4:8, 2:4] = A[4:8, 8:10]
    return A, B


CAR = ["z", "pitch", "zf", "zr", "vz", "q", "vf", "vr", "roadFront", "roadRear", "forceFront", "forceRear", "front.filtered",
       "rear.filtered", "front.I", "rear.I"]  # fmt: skip


def test_half_car_on_its_road(open_fmu):
    """The exponential of a matrix gives the motion between samples; the rear axle meets the noise of the front axle 27 samples later."""
    instance = open_fmu("HalfCar").initialize({"rough": 0.05}, 1e-10)
    A, B = half_car()
    whole = expm(0.005 * np.block([[A, B], [np.zeros((4, 20))]]))
    x, front = np.zeros(16), []
    for k in range(200):
        noises = instance.get("noiseFront", "noiseRear")  # the sample at the end of a step belongs to it
        front.append(noises[0])
        assert noises[1] == (front[k - 27] if k >= 27 else 0)
        instance.step(0.005)
        x = (whole @ [*x, *noises, 0, 0])[:16]
        np.testing.assert_allclose(instance.get(*CAR), x, rtol=1e-6, atol=1e-9)
    assert np.std(front) == pytest.approx(0.05, rel=0.15) and abs(np.mean(front)) < 0.05 / 5


@pytest.mark.parametrize("w", [3.0, 8.0, 60.0])
def test_half_car_on_waves(w, open_fmu):
    """The response after the transient is that of the transfer function from the height under the front wheel; no noise."""
    instance = open_fmu("HalfCar").initialize({"rough": 0.0}, 1e-9)
    A, B = half_car()
    amplitude = 0.001 * np.linalg.solve(1j * w * np.eye(16) - A, B[:, 2])
    wave = lambda order, t: 0.001 * w**order * np.sin(w * t + order * np.pi / 2)
    for i in range(2400):
        t = i * 0.005
        instance.set(bumpFront=wave(0, t))
        instance.fmu.setRealInputDerivatives(instance.vr("bumpFront") * 3, [1, 2, 3], [wave(order, t) for order in (1, 2, 3)])
        instance.step(0.005)
        if i > 2300:
            expected = (amplitude * np.exp(1j * w * instance.time)).imag
            np.testing.assert_allclose(instance.get(*CAR[:4]), expected[:4], atol=2e-3 * abs(amplitude[:4]).max())


def test_half_car_is_restored_bit_by_bit(open_fmu):
    """From a saved state the same road and the same motion return, to the last bit."""
    instance = open_fmu("HalfCar").initialize({"rough": 0.3, "seed": 7})
    instance.step(0.5)
    saved, time, rows = instance.fmu.getFMUstate(), instance.time, []
    for _ in range(2):
        instance.fmu.setFMUstate(saved)
        instance.time = time
        rows.append(instance.run(1.0, 0.013, *CAR, "noiseRear", "comfort"))
    assert rows[0] == rows[1]
