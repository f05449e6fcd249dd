"""The systems with bodies in space, against closed forms, the Newton-Euler equations, and independent reduced equations."""

import fmpy
import numpy as np
import pytest
import sympy as sp
from fmpy.fmi2 import FMU2Model
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import fmu
from closed_forms import free_body_velocity, pendulum_angle, top_cosine, top_nutation
from fmu import DISCARD, ERROR, build_systems
from mechanics import Constrained, rotation, turning, velocity

# One rigid body with a fixed point, described in three ways; its parameters are those of three particles on massless rods to the point.
MASSES = np.array([0.7, 1.1, 0.4])
PLACES = np.array([[0.5, 0.1, -0.2], [-0.3, 0.4, 0.1], [0.2, -0.3, 0.6]])
FRAMES = {
    "HungByAngles": '<coordinate name="p" velocity="vp" unit="rad" start="0.3"/><coordinate name="q" velocity="vq" unit="rad" start="0.7"/>'
    '<coordinate name="r" velocity="vr" unit="rad"/>'
    '<frame name="axes"><rotate axis="z" angle="p"/><rotate axis="x" angle="q"/><rotate axis="z" angle="r"/></frame>',
    "HungByQuaternion": '<coordinate name="a" velocity="va" unit="1" start="1"/><coordinate name="b" velocity="vb" unit="1"/>'
    '<coordinate name="c" velocity="vc" unit="1"/><coordinate name="d" velocity="vd" unit="1"/>'
    '<frame name="axes"><rotate quaternion="a b c d"/></frame>',
}
HUNG = """<system name="{name}" description="Rigid body on a fixed point, pulled at one place">
  <parameter name="g" start="9.81" unit="m/s2"/>
  {frame}
  <body name="body" in="axes" mass="{mass}" x="{centre[0]}" y="{centre[1]}" z="{centre[2]}"
        Ixx="{I[0][0]}" Iyy="{I[1][1]}" Izz="{I[2][2]}" Ixy="{I[0][1]}" Ixz="{I[0][2]}" Iyz="{I[1][2]}"/>
  <point name="place" in="axes" x="{place[0]}" y="{place[1]}" z="{place[2]}"/>
  <gravity z="-g"/>
  <force on="place" x="3" y="-2" z="1"/>
</system>"""
RODS = """<system name="HungByRods" description="The same as particles that rods hold together">
  <parameter name="g" start="9.81" unit="m/s2"/>
  {particles}
  <gravity z="-g"/>
  <force on="p0" x="3" y="-2" z="1"/>
</system>"""
# The governor of the report; its parameters have other names here.
GOVERNOR = (fmu.ROOT / "scripts" / "numerics" / "systems" / "StiffGovernor" / "system.xml").read_text()


def hung(name):
    centre = MASSES @ PLACES / MASSES.sum()
    arms = PLACES - centre
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(MASSES, arms))
    return HUNG.format(name=name, frame=FRAMES[name], mass=MASSES.sum(), centre=centre, I=inertia, place=PLACES[0])


def rods():
    text, places = "", [*PLACES, np.zeros(3)]
    for i, (m, place) in enumerate(zip(MASSES, PLACES)):
        text += "".join(f'<coordinate name="{axis}{i}" velocity="v{axis}{i}" unit="m" start="{start}"/>' for axis, start in zip("xyz", place))
        text += f'<particle name="p{i}" mass="{m}" x="x{i}" y="y{i}" z="z{i}"/>'
    for i in range(3):
        for j in range(i + 1, 4):
            square = " + ".join(f"({axis}{i} - {axis}{j})^2" if j < 3 else f"{axis}{i}^2" for axis in "xyz")
            text += f'<constraint name="rod{i}{j}" unit="m">sqrt({square}) - {float(np.linalg.norm(places[i] - places[j]))}</constraint>'
    return RODS.format(particles=text)


@pytest.fixture(scope="module", autouse=True)
def systems():
    build_systems("spatial", {name: hung(name) for name in FRAMES} | {"HungByRods": rods(), "StiffGovernor": GOVERNOR})


def state(instance, values):
    """The instance in initialization mode with exactly these values."""
    instance.reset()
    instance.fmu.setupExperiment()
    instance.set(values)
    instance.fmu.enterInitializationMode()
    return instance


def quaternion(turn):
    b, c, d, a = turn.as_quat()
    return np.array([a, b, c, d])


def rates_of(q, omega):
    """q' = q omega/2 for an angular velocity along the body axes."""
    a, u = q[0], q[1:]
    return np.array([-u @ omega, *(a * omega + np.cross(u, omega))]) / 2


def test_one_body_in_three_ways(open_fmu):
    """Euler angles, a quaternion, and particles on rods give the same accelerations at random states."""
    angles, parts, constrained = (open_fmu(name) for name in ("HungByAngles", "HungByQuaternion", "HungByRods"))
    random = np.random.default_rng(7)
    for _ in range(50):
        euler, euler_rates = random.uniform(0.3, 2.8, 3), random.uniform(-3, 3, 3)
        state(angles, dict(zip("pqr", euler)) | dict(zip(["vp", "vq", "vr"], euler_rates)))
        turn = Rotation.from_euler("ZXZ", euler)
        omega = np.array(angles.get("body.omegaX", "body.omegaY", "body.omegaZ"))
        sines, cosines = np.sin(euler), np.cos(euler)
        by_hand = [
            euler_rates[0] * sines[1] * sines[2] + euler_rates[1] * cosines[2],
            euler_rates[0] * sines[1] * cosines[2] - euler_rates[1] * sines[2],
            euler_rates[0] * cosines[1] + euler_rates[2],
        ]
        np.testing.assert_allclose(omega, by_hand, atol=1e-13)
        q = quaternion(turn)
        state(parts, dict(zip("abcd", q)) | dict(zip(["va", "vb", "vc", "vd"], rates_of(q, omega))))
        values = {}
        for i, place in enumerate(PLACES):
            values |= dict(zip([f"x{i}", f"y{i}", f"z{i}"], turn.apply(place)))
            values |= dict(zip([f"vx{i}", f"vy{i}", f"vz{i}"], turn.apply(np.cross(omega, place))))
        state(constrained, values)
        expected = constrained.get("der(vx0)", "der(vy0)", "der(vz0)")
        for instance in (angles, parts):
            np.testing.assert_allclose(instance.get("place.ax", "place.ay", "place.az"), expected, rtol=1e-9, atol=1e-9)
        rotations = [f"body.{name}{axis}" for name in ("omega", "alpha") for axis in "XYZ"]
        np.testing.assert_allclose(angles.get(*rotations), parts.get(*rotations), rtol=1e-9, atol=1e-9)
        assert angles.get("totalEnergy") == pytest.approx(constrained.get("totalEnergy"), abs=1e-11)


TOP = dict(m=0.4, l=0.12, I1=9e-4, I3=7e-4, g=9.3)


ABOUT_TIP = TOP["I1"] + TOP["m"] * TOP["l"] ** 2
LEVER = TOP["m"] * TOP["g"] * TOP["l"]


@pytest.mark.parametrize("theta, vphi, vtheta, vpsi", [(0.6, 0.0, 0.0, 160.0), (1.1, -2.0, 3.0, 90.0), (2.0, 5.0, -1.0, -60.0)])
def test_nutation_of_the_top(theta, vphi, vtheta, vpsi, open_fmu):
    """cos(theta) follows Jacobi's elliptic function between two roots of a cubic, with its period; three integrals are conserved."""
    start = dict(theta=theta, vphi=vphi, vtheta=vtheta, vpsi=vpsi)
    top = (ABOUT_TIP, TOP["I3"], LEVER, theta, vphi, vtheta, vpsi)
    low, high, period = top_nutation(*top)
    rows = np.array(open_fmu("HeavyTop").initialize(TOP | start, 1e-12).run(100, 0.05, "theta", "totalEnergy", "pPsi", "pPhi"))
    for column, name in ((2, "totalEnergy"), (3, "pPsi"), (4, "pPhi")):
        assert np.max(np.abs(rows[:, column] - rows[0, column])) < 1e-10 * np.max(np.abs(rows[:, column])), name
    spin = TOP["I3"] * (vpsi + vphi * np.cos(theta))
    assert rows[0, 3:] == pytest.approx([spin, ABOUT_TIP * np.sin(theta) ** 2 * vphi + spin * np.cos(theta)], rel=1e-14)
    cosines = np.cos(rows[:, 1])
    assert low - 1e-10 < np.min(cosines) < low + 0.01 * (high - low)
    assert high + 1e-10 > np.max(cosines) > high - 0.01 * (high - low)
    for t, cosine in zip(rows[:200, 0], cosines):
        assert cosine == pytest.approx(top_cosine(*top, t), abs=1e-10)
    instance = open_fmu("HeavyTop").initialize(TOP | start, 1e-12)
    instance.run(10 * period, period, "theta")
    assert instance.get("theta", "vtheta") == pytest.approx([theta, vtheta], abs=1e-9)


@pytest.mark.parametrize("fast", [False, True])
def test_steady_precession_of_the_top(fast, open_fmu):
    """A cos(theta) W^2 - C n W + m g l = 0 has a slow and a fast root W."""
    theta, spin = 0.7, 400.0
    roots = np.roots([ABOUT_TIP * np.cos(theta), -TOP["I3"] * spin, LEVER])
    rate = max(roots) if fast else min(roots)
    values = dict(theta=theta, vphi=rate, vpsi=spin - rate * np.cos(theta))
    rows = np.array(open_fmu("HeavyTop").initialize(TOP | values, 1e-12).run(20, 0.1, "theta", "phi"))
    np.testing.assert_allclose(rows[:, 1], theta, atol=1e-10)
    np.testing.assert_allclose(rows[:, 2], rate * rows[:, 0], atol=1e-8)


def test_poles_of_the_top(open_fmu):
    """At theta = 0 phi and psi rotate about the same axis (gimbal lock): neither a start nor a passage is possible."""
    instance = open_fmu("HeavyTop")
    with instance.fails(ERROR, "mass matrix is singular .* depends on .*theta"):
        instance.initialize({"theta": 0.0})
    spin, theta = 20.0, 0.5
    rate = TOP["I3"] * spin / (ABOUT_TIP * (1 + np.cos(theta)))  # equal momenta about both axes, so that the top can become upright
    instance = open_fmu("HeavyTop")
    instance.initialize(TOP | dict(theta=theta, vphi=rate, vtheta=-12.0, vpsi=spin - rate * np.cos(theta)))
    with instance.fails(DISCARD, "singularity|singular"):
        instance.run(0.1, 0.01, "theta")



BODY = dict(m=1.3, I1=0.12, I2=0.2, I3=0.27)


@pytest.mark.parametrize("omega", [(4.0, 0.3, -0.2), (0.2, -0.1, -3.0), (0.01, 4.0, 0.0), (0.0, 3.0, 0.02), (1.0, 2.0, 3.0)])
def test_free_body(omega, open_fmu):
    """
    Jacobi's elliptic functions give the motion; energy and the momentum in space are conserved. About the intermediate axis the body flips
    repeatedly.
    """
    instance = open_fmu("FreeBody").initialize(BODY | dict(zip(["w1", "w2", "w3"], omega)), 1e-13)
    names = ["body.omegaX", "body.omegaY", "body.omegaZ", "totalEnergy", "Lx", "Ly", "Lz", "a", "b", "c", "d"]
    rows = np.array(instance.run(30, 0.1, *names))
    moments = np.array([BODY["I1"], BODY["I2"], BODY["I3"]])
    exact = np.array([free_body_velocity(*moments, *omega, t) for t in rows[:, 0]])
    np.testing.assert_allclose(rows[:, 1:4], exact, atol=1e-9)
    momentum = moments * omega
    assert rows[0, 4] == pytest.approx(momentum @ omega / 2, rel=1e-15)
    np.testing.assert_allclose(rows[:, 4], rows[0, 4], rtol=1e-12)
    np.testing.assert_allclose(rows[:, 5:8], np.tile(momentum, (len(rows), 1)), atol=1e-12 * np.linalg.norm(momentum))
    np.testing.assert_allclose(np.linalg.norm(rows[:, 8:], axis=1), 1, atol=1e-15)
    for row in rows[::20]:  # the quaternion maps the momentum from the body axes to space
        turn = Rotation.from_quat([*row[9:], row[8]])
        np.testing.assert_allclose(turn.apply(moments * row[1:4]), momentum, atol=1e-11)
    if abs(omega[1]) > 3.5:
        assert np.min(rows[:, 2]) < -0.999 * omega[1] and np.sum(np.diff(np.sign(rows[:, 2])) != 0) > 2


def test_free_body_falls_and_keeps_its_norm(open_fmu):
    """
    The centre of mass follows a parabola; the norm of the quaternion after many steps is as after one. LONG_RUNS=1 takes a million steps.
    """
    import os

    thrown = dict(g=9.81, x=0.2, y=-1.0, z=3.0, vx=1.0, vy=-0.4, vz=7.0)
    instance = open_fmu("FreeBody").initialize(BODY | thrown)
    instance.step(2.0)
    assert instance.get("x", "y", "z") == pytest.approx([2.2, -1.8, 3 + 14 - 9.81 * 2], abs=1e-12)
    instance = open_fmu("FreeBody").initialize()
    for _ in range(30 if "LONG_RUNS" in os.environ else 1):
        instance.step(5000.0)
        q, rates = np.array(instance.get("a", "b", "c", "d")), np.array(instance.get("va", "vb", "vc", "vd"))
        assert abs(q @ q - 1) < 1e-14 and abs(q @ rates) < 1e-14
    assert instance.fmu.getInteger(instance.vr("solverSteps"))[0] > 20000


def test_accelerations_of_the_free_body(open_fmu):
    """Euler's equations hold for any unit quaternion."""
    random = np.random.default_rng(5)
    instance = open_fmu("FreeBody")
    for _ in range(50):
        moments, omega = random.uniform(0.5, 0.9, 3), random.uniform(-3, 3, 3)
        q = quaternion(Rotation.random(rng=random))
        rates = rates_of(q, omega)
        values = dict(zip(["I1", "I2", "I3"], moments)) | dict(zip("abcd", q)) | dict(zip(["va", "vb", "vc", "vd"], rates))
        state(instance, values)
        alpha = -np.cross(omega, moments * omega) / moments
        np.testing.assert_allclose(instance.get("body.alphaX", "body.alphaY", "body.alphaZ"), alpha, atol=1e-12)
        second = rates_of(q, alpha) + rates_of(rates, omega)
        np.testing.assert_allclose(instance.get("der(va)", "der(vb)", "der(vc)", "der(vd)"), second, atol=1e-12)


# Modified Denavit-Hartenberg parameters (twist and length before, offset after), centre of mass, moments of inertia: Armstrong et al. 1986.
LINKS = [
    (0, 0, 0, (0, 0, 0), (0, 0, 0.35)),
    (-np.pi / 2, 0, 0.2435, (0.068, 0.006, -0.016), (0.13, 0.524, 0.539)),
    (0, 0.4318, -0.0934, (0, -0.070, 0.014), (0.066, 0.0125, 0.066)),
    (np.pi / 2, -0.0203, 0.4331, (0, 0, -0.019), (1.8e-3, 1.8e-3, 1.3e-3)),
    (-np.pi / 2, 0, 0, (0, 0, 0), (0.3e-3, 0.3e-3, 0.4e-3)),
    (np.pi / 2, 0, 0, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
]


def newton_euler(q, w, a, masses, gravity, tool):
    """
    Torques at the joints, and position and velocity of the tool, by Craig's recursive Newton-Euler algorithm, outwards and then inwards.
    """
    axis, omega, alpha, pull = np.array([0, 0, 1.0]), np.zeros(3), np.zeros(3), np.array([0, 0, gravity])
    rotations, arms, loads = [], [], []
    place, speed, frame = np.zeros(3), np.zeros(3), np.eye(3)
    for (twist, length, offset, centre, moments), mass, qi, wi, ai in zip(LINKS, masses, q, w, a):
        turn = Rotation.from_euler("XZ", [twist, qi]).as_matrix()
        arm = np.array([length, -np.sin(twist) * offset, np.cos(twist) * offset])
        place, speed = place + frame @ arm, speed + frame @ np.cross(omega, arm)
        pull = turn.T @ (pull + np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm)))
        alpha = turn.T @ alpha + ai * axis + np.cross(turn.T @ omega, wi * axis)
        omega = turn.T @ omega + wi * axis
        frame = frame @ turn
        at_centre = pull + np.cross(alpha, centre) + np.cross(omega, np.cross(omega, centre))
        moments = np.array(moments)
        loads.append((mass * at_centre, moments * alpha + np.cross(omega, moments * omega) + np.cross(centre, mass * at_centre)))
        rotations.append(turn), arms.append(arm)
    end = np.array([0, 0, tool])
    reach = [*(place + frame @ end), *(speed + frame @ np.cross(omega, end))]
    torques, force, moment = [], np.zeros(3), np.zeros(3)
    for i in reversed(range(6)):
        force, moment = force + loads[i][0], moment + loads[i][1]
        torques.append(moment[2])
        force = rotations[i] @ force
        moment = rotations[i] @ moment + np.cross(arms[i], force)
    return np.array(torques[::-1]), reach


def test_robot_arm(open_fmu):
    """By inverse dynamics the FMU's accelerations need the given torques, less those of motors and friction; the tool's position agrees."""
    random = np.random.default_rng(11)
    instance = open_fmu("RobotArm")
    names = lambda pattern: [pattern.format(i) for i in range(1, 7)]
    for _ in range(50):
        q, w, tau = random.uniform(-3, 3, 6), random.uniform(-3, 3, 6), random.uniform(-30, 30, 6)
        masses, gravity, tool = random.uniform(0.2, 9, 6), random.uniform(1, 12), random.uniform(0.1, 0.5)
        values = dict(zip(names("q[{}]"), q)) | dict(zip(names("w[{}]"), w)) | dict(zip(names("m{}")[1:], masses[1:]))
        state(instance, values | dict(g=gravity, d6=tool) | dict(zip(names("tau[{}]"), tau)))
        a = np.array(instance.get(*names("der(w[{}])")))
        motor, gear, friction = (np.array(instance.get(*names(pattern))) for pattern in ("Jm[{}]", "n[{}]", "bm[{}]"))
        torques, reach = newton_euler(q, w, a, masses, gravity, tool)
        np.testing.assert_allclose(torques + gear**2 * (motor * a + friction * w), tau, rtol=1e-10, atol=1e-9)
        np.testing.assert_allclose(instance.get("x", "y", "z", "vx", "vy", "vz"), reach, atol=1e-12)


def test_robot_arm_at_rest_and_free(open_fmu):
    """With the torques that balance gravity the arm stays at rest; without torques and friction its energy is conserved."""
    names = [f"q[{i}]" for i in range(1, 7)]
    q = np.array([0.4, -0.8, 1.1, 0.5, -0.6, 0.2])
    holding, _ = newton_euler(q, np.zeros(6), np.zeros(6), [0, 17.4, 4.8, 0.82, 0.34, 0.09], 9.81, 0.2)
    torques = {f"tau[{i + 1}]": torque for i, torque in enumerate(holding)}
    instance = open_fmu("RobotArm").initialize(dict(zip(names, q)) | torques, 1e-10)
    instance.step(1.0)
    np.testing.assert_allclose(instance.get(*names), q, atol=1e-9)
    free = dict(zip(names, q)) | {f"bm[{i}]": 0.0 for i in range(1, 7)}
    rows = np.array(open_fmu("RobotArm").initialize(free, 1e-12).run(5, 0.1, "totalEnergy", "kineticEnergy"))
    np.testing.assert_allclose(rows[:, 1], rows[0, 1], atol=1e-9)
    assert np.max(rows[:, 2]) > 20


def rolling_disk():
    """Lagrange's equation with multipliers; the velocity of the contact point, v + omega x r, is 0."""
    x, y, yaw, lean, spin, vx, vy, vyaw, vlean, vspin, m, R, g = sp.symbols("x y yaw lean spin vx vy vyaw vlean vspin m R g")
    q, v = [x, y, yaw, lean, spin], [vx, vy, vyaw, vlean, vspin]
    fork = rotation("z", yaw) * rotation("x", lean)
    wheel = fork * rotation("y", spin)
    height = R * sp.cos(lean)
    T = m * (vx**2 + vy**2 + velocity(height, q, v) ** 2) / 2 + turning(wheel, [m * R**2 / 4, m * R**2 / 2, m * R**2 / 4], q, v)
    cross = wheel.applyfunc(lambda element: velocity(element, q, v)) * wheel.T
    slip = sp.Matrix([vx, vy, 0]) + cross * fork * sp.Matrix([0, 0, -R])
    return Constrained(q, v, T, m * g * height, [0] * 5, list(slip[:2]), [m, R, g])


def test_accelerations_and_forces_of_the_rolling_disk(open_fmu):
    definition, random = rolling_disk(), np.random.default_rng(3)
    instance = open_fmu("RollingDisk", kind=FMU2Model)
    symbols = [symbol.name for symbol in definition.arguments]
    for _ in range(50):
        values = random.uniform(0.3, 1.3, len(symbols))
        instance.put(zip(symbols[1:], values[1:]))
        ours = instance.get(*[f"der({name})" for name in symbols[6:11]], "gripX.force", "gripY.force")
        np.testing.assert_allclose(ours, definition.solve(values), rtol=1e-9, atol=1e-9)


DISK = dict(m=0.8, R=0.25, g=9.6)
ACROSS, ABOUT, ROLLING = DISK["m"] * DISK["R"] ** 2 * np.array([0.25, 0.5, 1.5])  # the last about the contact point


def test_steady_circles_of_the_rolling_disk(open_fmu):
    """A W^2 sin cos - (C + m R^2) n W cos = m g R sin of the lean, with the precession rate W and the angular velocity n about the axis."""
    for lean, rate in ((0.3, -2.0), (-0.5, 3.0), (1.2, -6.0), (0.4, 15.0)):
        sine, cosine = np.sin(lean), np.cos(lean)
        n = (ACROSS * rate**2 * sine * cosine - DISK["m"] * DISK["g"] * DISK["R"] * sine) / (ROLLING * rate * cosine)
        values = dict(lean=lean, vyaw=rate, vspin=n - rate * sine, vx=DISK["R"] * n, vy=0.0)
        instance = open_fmu("RollingDisk").initialize(DISK | values, 1e-12)
        assert not any("moved to fulfil" in text for _, _, text in instance.messages)
        radius = DISK["R"] * n / rate
        for t, x, y, angle in instance.run(2, 0.1, "x", "y", "lean"):
            assert angle == pytest.approx(lean, abs=1e-7)
            assert [x, y] == pytest.approx([radius * np.sin(rate * t), radius * (1 - np.cos(rate * t))], abs=1e-6)


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_straight_rolling_is_stable_when_fast(factor, open_fmu):
    """For a small lean, (A + m R^2) lean'' = (m g R - (C + m R^2) C n^2/A) lean; a thin disk is stable above v^2 = g R/3."""
    speed = factor * np.sqrt(DISK["g"] * DISK["R"] / 3)
    n, small = speed / DISK["R"], 1e-5
    stiffness = ROLLING * ABOUT * n**2 / ACROSS - DISK["m"] * DISK["g"] * DISK["R"]
    w = np.sqrt(complex(stiffness / (ACROSS + DISK["m"] * DISK["R"] ** 2)))
    values = dict(lean=small, vyaw=-ABOUT * n / ACROSS * small, vspin=n, vx=speed)
    rows = open_fmu("RollingDisk").initialize(DISK | values, 1e-13).run(3.0, 0.1, "lean")
    for t, lean in rows:
        expected = small * np.cos(w * t).real
        assert lean == pytest.approx(expected, abs=1e-4 * small * np.cosh(abs(w) * t))
    assert (factor > 1) == (max(abs(lean) for _, lean in rows) < 1.01 * small)


def test_energy_of_the_rolling_disk(open_fmu):
    rows = np.array(open_fmu("RollingDisk").initialize({}, 1e-12).run(20, 0.1, "totalEnergy"))
    np.testing.assert_allclose(rows[:, 1], rows[0, 1], rtol=1e-11)


def bricard(alpha):
    """
    Ends of the rods by one angle: the joints have the angles a and b alternately, with sin a + sin b + sin a sin b = 0. Complex values
    serve complex-step derivatives.
    """
    beta = -np.arcsin(np.sin(alpha) / (1 + np.sin(alpha)))
    turn, ends, axes = np.eye(3), [np.zeros(3, complex)], []
    for i, (axis, rod) in enumerate(zip("yzxyz", np.array([[1, 0, 0], [0, -1, 0], [0, 0, 1], [-1, 0, 0], [0, 1, 0]]))):
        k, (c, s) = "xyz".index(axis), ((np.cos(a), np.sin(a)) for a in [beta if i % 2 else alpha]).__next__()
        step = np.eye(3, dtype=complex)
        j, l = (k + 1) % 3, (k + 2) % 3
        step[j, j], step[j, l], step[l, j], step[l, l] = c, -s, s, c
        turn = turn @ step
        ends.append(ends[-1] + turn @ rod)
        axes.append(turn)
    return np.array(ends), np.array(axes)


def bricard_energies(alpha, m=1.0, width=0.1, g=9.81):
    """M(alpha) with T = M alpha'^2/2, and U; the rods are lines with rotational inertia across."""
    step = 1e-30
    (ends, rotations), (moved, rotated) = bricard(alpha + 0j), bricard(alpha + 1j * step)
    rates, spins = moved.imag / step, rotated.imag / step
    ends = ends.real
    M = sum(m / 3 * (u @ u + u @ v + v @ v) for u, v in zip(rates, rates[1:]))
    for i, spin in enumerate(spins):
        for axis in {0, 1, 2} - {[0, 1, 2, 0, 1][i]}:
            M += m * width**2 / 12 * (spin[:, axis] @ spin[:, axis])
    U = m * g * sum(u[1] + v[1] for u, v in zip(ends, ends[1:])) / 2
    return M, U


def test_bricard(open_fmu):
    """
    The single degree of freedom follows its reduced equation. lagc reports one redundant constraint. The energy error is far below the 1e-3
    J of the IFToMM benchmark.
    """
    instance = open_fmu("Bricard").initialize({}, 1e-12)
    assert any("'axisZ' is redundant" in text for _, _, text in instance.messages)
    rows = np.array(instance.run(10, 0.1, "x", "y", "z", "totalEnergy", "q[1]", "q[2]", "q[5]", "P5.x", "P5.z"))
    assert np.max(np.abs(rows[:, 4] - rows[0, 4])) < 1e-9
    np.testing.assert_allclose(rows[:, 5], rows[:, 7], atol=1e-10)
    np.testing.assert_allclose(rows[:, 8:], np.tile([0, 1], (101, 1)), atol=1e-13)

    def derivative(_, state):
        alpha, rate = state
        h = 1e-3  # of central differences of order 6
        points = [bricard_energies(alpha + k * h) for k in (-3, -2, -1, 1, 2, 3)]
        slope = np.array([-1, 9, -45, 45, -9, 1]) @ np.array(points) / (60 * h)
        return [rate, (-slope[1] - slope[0] * rate**2 / 2) / bricard_energies(alpha)[0]]

    exact = solve_ivp(derivative, (0, 10), [0, 0], method="DOP853", rtol=1e-10, atol=1e-11, t_eval=rows[:, 0]).y[0]
    np.testing.assert_allclose(rows[:, 5], exact, atol=1e-7)
    np.testing.assert_allclose(rows[:, 1:4], [bricard(alpha + 0j)[0][3].real for alpha in exact], atol=1e-7)


@pytest.mark.parametrize("tolerance", [1e-7, 1e-8])
def test_bricard_in_model_exchange(tolerance):
    """
    CVode keeps the energy to the 1e-3 J of the benchmark at 1e-8. With a larger drift the redundant constraint counts as independent, and the
    energy moves by 5 J.
    """
    rows = fmpy.simulate_fmu(str(fmu.archive("Bricard")), fmi_type="ModelExchange", solver="CVode", stop_time=10, output_interval=0.01,
                             relative_tolerance=tolerance, output=["totalEnergy"])  # fmt: skip
    assert np.max(np.abs(rows["totalEnergy"] - rows["totalEnergy"][0])) < 1e5 * tolerance


def test_governor_without_width_is_that_by_particles(open_fmu):
    """The governor with thin rods on the axis equals the one by particles, whose angles are from the vertical."""
    w, slider = 1e-5, 3.0
    rho = 0.3 / w**2
    e = (slider / rho) ** (1 / 3)
    J = (0.3 * w**2 + slider * e**2) / 6
    values = {"rho": rho, "w": w, "e": e, "h": 0.0, "alpha[1]": np.pi / 3, "alpha[2]": np.pi / 3, "s": 1 - np.cos(np.pi / 6)}
    ours = open_fmu("FlyballGovernor").initialize(values, 1e-10)
    theirs = open_fmu("StiffGovernor").initialize(dict(J=J), 1e-10)
    for _ in range(20):
        ours.step(0.1)
        theirs.step(0.1)
        s, alpha, other, Omega = ours.get("s", "alpha[1]", "alpha[2]", "Omega")
        assert other == pytest.approx(alpha, abs=1e-9)
        assert [1 - s, np.pi / 2 - alpha, Omega] == pytest.approx(theirs.get("s", "alpha", "Omega"), abs=1e-6)


def test_governor(open_fmu):
    """The motion agrees with SciPy on SymPy's equations; the shaft's angular momentum is constant; the dampers dissipate energy."""
    from systems_in_sympy import system

    definition = system("FlyballGovernor")
    instance = open_fmu("FlyballGovernor").initialize({}, 1e-9)
    names = [symbol.name for symbol in (*definition.q, *definition.v)]
    start, parameters = instance.get(*names), instance.get(*[symbol.name for symbol in definition.parameters])
    derivative = definition.right_side(lambda t: [], parameters)
    times = np.linspace(0, 10, 101)
    exact = solve_ivp(derivative, (0, 10), start, method="LSODA", rtol=1e-10, atol=1e-11, t_eval=times).y
    rows = np.array(instance.run(10, 0.1, *names, "totalEnergy"))
    np.testing.assert_allclose(rows[:, 1:-1], exact.T, atol=2e-5)
    assert np.all(np.diff(rows[:, -1]) < 1e-7) and rows[-1, -1] < rows[0, -1] - 1e-4


def test_gyrocompass(open_fmu):
    """About north it swings as a pendulum with g/l = H W cos(latitude)/J, up to a term of W^2, by Jacobi's elliptic function."""
    values = dict(J=0.004, C=0.006, W=7.292115e-5, latitude=0.9, spin=3000.0, alpha=1.3)
    instance = open_fmu("Gyrocompass").initialize(values, 1e-11)
    north = values["W"] * np.cos(values["latitude"])
    H = values["C"] * (values["spin"] + north * np.cos(values["alpha"]))
    rate = np.sqrt(H * north / values["J"])
    for t, alpha, spin in instance.run(100, 1.0, "alpha", "rotor.omegaZ"):
        assert alpha == pytest.approx(pendulum_angle(values["alpha"], rate, t), abs=1e-5)
        assert values["C"] * spin == pytest.approx(H, rel=1e-12)


def test_gyrocompass_that_turns_fast(open_fmu):
    """The motion obeys J alpha'' = J (W cos)^2 sin(alpha) cos(alpha) - H W cos sin(alpha) - b alpha'."""
    J, C, W, latitude, b = 0.7, 0.9, 1.3, 0.4, 0.2
    north = W * np.cos(latitude)
    H = C * (5 + north * np.cos(0.5))
    values = dict(J=J, C=C, W=W, latitude=latitude, b=b, spin=5.0)
    rows = np.array(open_fmu("Gyrocompass").initialize(values, 1e-11).run(10, 0.1, "alpha"))
    equation = lambda t, y: [y[1], (north**2 * np.cos(y[0]) - H * north / J) * np.sin(y[0]) - b / J * y[1]]
    exact = solve_ivp(equation, (0, 10), [0.5, 0], method="DOP853", rtol=1e-12, atol=1e-13, t_eval=rows[:, 0]).y[0]
    np.testing.assert_allclose(rows[:, 1], exact, atol=1e-9)
