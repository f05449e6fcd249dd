"""Bodies in space: frames, quaternions, torques and variables of bodies, against a numerical form of Lagrange's equation."""

import numpy as np
import pytest

from fmu import ERROR, build_systems, lagc
from space import WEIGHTS, Mechanism, array, rotation, rotation_of_quaternion, slope

ARM = """<system name="SpatialArm" description="Sledge on a platform that sways in time, an arm with a skew axis and a wheel">
  <parameter name="ex" start="0.6"/>
  <parameter name="m" start="2" min="0"/>
  <parameter name="g" start="9.81"/>
  <input name="tau"/>
  <coordinate name="s" velocity="vs" start="0.3"/>
  <coordinate name="alpha" velocity="va" start="0.5"/>
  <coordinate name="beta" velocity="vb" start="0.2"/>
  <frame name="wheel" in="arm"> <translate x="0.4" y="0.1*sin(alpha)"/> <rotate axis="z" angle="beta + alpha/2"/> </frame>
  <frame name="platform"> <translate z="0.2*cos(3*time)"/> <rotate axis="y" angle="0.3*sin(2*time)"/> </frame>
  <frame name="arm" in="platform">
    <translate x="s"/>
    <rotate axis="ex 0 2*ex" angle="alpha"/>
    <translate y="0.2"/>
  </frame>
  <body name="beam" in="arm" mass="m" x="0.1" z="0.05*s" Ixx="0.02" Iyy="0.05" Izz="0.06" Ixy="0.004" Ixz="-0.003" Iyz="0.002"/>
  <body name="disk" in="wheel" mass="1.5" x="0.03" Ixx="0.01" Iyy="0.01" Izz="0.02"/>
  <particle name="bolt" in="wheel" mass="0.3" y="0.2"/>
  <point name="tip" in="wheel" x="0.25" z="-0.1"/>
  <particle mass="0.5" x="s" z="s^2"/>
  <force on="tip" x="3" y="-1" z="2" in="arm"/>
  <force on="wheel" z="0.7*vs"/>
  <torque on="disk" x="0.2" z="tau" in="wheel"/>
  <torque on="arm" y="tau" z="-0.4"/>
  <gravity x="1" z="-g"/>
  <work/>
</system>
"""
PLATE = """<system name="SpatialPlate" description="Plate on a spring, turned by a quaternion, with a rotor on it">
  <parameter name="k" start="30" unit="N/m"/>
  <coordinate name="x" velocity="vx" unit="m" start="0.1"/>
  <coordinate name="y" velocity="vy" unit="m"/>
  <coordinate name="z" velocity="vz" unit="m"/>
  <coordinate name="a" velocity="va" unit="1" start="1"/>
  <coordinate name="b" velocity="vb" unit="1" velocityStart="0.3"/>
  <coordinate name="c" velocity="vc" unit="1" velocityStart="0.7"/>
  <coordinate name="d" velocity="vd" unit="1" velocityStart="-0.2"/>
  <coordinate name="psi" velocity="w" unit="rad" velocityStart="20"/>
  <frame name="plate"> <translate x="x" y="y" z="z"/> <rotate quaternion="a b c d"/> </frame>
  <frame name="rotor" in="plate"> <translate z="0.3"/> <rotate axis="0 1 1" angle="psi"/> </frame>
  <body name="board" in="plate" mass="3" x="0.05" Ixx="0.2" Iyy="0.3" Izz="0.45" Iyz="0.02"/>
  <body name="disk" in="rotor" mass="0.5" Ixx="0.001" Iyy="0.002" Izz="0.002"/>
  <point name="corner" in="plate" x="0.4" y="0.3"/>
  <potential>k*(corner.x^2 + corner.y^2 + (corner.z - 1)^2)/2</potential>
  <gravity y="-9.81"/>
  <experiment stopTime="5" stepSize="0.01"/>
</system>
"""
PLANAR = """<system name="PlanarFrame" description="Rods of which the second is placed in the first one's frame">
  <parameter name="g" start="9.81"/>
  <coordinate name="p" velocity="vp" start="0.4"/>
  <coordinate name="q" velocity="vq" start="-0.8"/>
  <body name="upper" mass="2" inertia="0.15" x="sin(p)/2" y="-cos(p)/2" angle="p"/>
  {lower}
  <torque on="upper" z="0.3*vq"/>
  <gravity y="-g"/>
  <output name="h">{height}</output>
</system>
"""
IN_FRAME = """<frame name="elbow" in="upper"> <translate y="-0.5"/> <rotate axis="z" angle="q"/> </frame>
  <body name="lower" in="elbow" mass="1" x="0.1" y="-0.4" Izz="0.07"/>"""
BY_HAND = """<body name="lower" mass="1" inertia="0.07" angle="p + q"
        x="sin(p) + 0.4*sin(p + q) + 0.1*cos(p + q)" y="-cos(p) - 0.4*cos(p + q) + 0.1*sin(p + q)"/>"""
ROTOR = """<system name="SpatialRotor" description="Rotor out of balance: {way} give the load of its bearing">
  <input name="tau"/>
  <coordinate name="phi" velocity="w" start="0.3" velocityStart="5"/>
  {bearing}
  <frame name="shaft"> <translate x="h" z="v"/> <rotate axis="x" angle="tilt"/> <rotate axis="z" angle="phi"/> </frame>
  <body name="rotor" in="shaft" mass="2" x="0.1" z="0.2" Ixx="0.1" Iyy="0.15" Izz="0.2" Ixz="0.03"/>
  <torque on="rotor" x="0.7" z="tau" in="shaft"/>
  <force on="rotor" y="1.5"/>
  <gravity z="-9.81"/>
</system>
"""
BEARINGS = {
    "displacements": '<displacement name="h"/><displacement name="v"/><displacement name="tilt"/>',
    "drives": "".join(f'<coordinate name="{x}" velocity="der{x}" acceleration="0"/>' for x in ("h", "v", "tilt")),
}
MOVED = """<system name="MovedFrame" description="Pendulum on a platform that inputs move and turn">
  <input name="u" derivatives="2"/>
  <input name="f" derivatives="2"/>
  <coordinate name="q" velocity="v" start="0.7"/>
  <frame name="platform"> <translate x="u"/> <rotate axis="0 0.6 0.8" angle="f"/> </frame>
  <frame name="rod" in="platform"> <rotate axis="x" angle="q"/> </frame>
  <body name="bob" in="rod" mass="2" z="-0.5" Ixx="0.1" Iyy="0.12" Izz="0.03"/>
  <body name="deck" in="platform" mass="1" Ixx="0.3" Iyy="0.2" Izz="0.4"/>
  <torque on="bob" y="0.5"/>
  <gravity z="-9.81"/>
  <work/>
</system>
"""
POLE = """<system name="EulerPole">
  <coordinate name="phi" velocity="u"/>
  <coordinate name="theta" velocity="v" start="0.1"/>
  <coordinate name="psi" velocity="w"/>
  <frame name="f"> <rotate axis="z" angle="phi"/> <rotate axis="x" angle="theta"/> <rotate axis="z" angle="psi"/> </frame>
  <body name="b" in="f" mass="1" Ixx="1" Iyy="2" Izz="3"/>
</system>
"""
TEXTS = {
    "EulerPole": POLE,
    "SpatialArm": ARM,
    "SpatialPlate": PLATE,
    "MovedFrame": MOVED,
    "PlanarFrame": PLANAR.format(lower=IN_FRAME, height="lower.y"),
    "PlanarByHand": PLANAR.format(lower=BY_HAND, height="lower.y").replace("PlanarFrame", "PlanarByHand"),
    **{f"Rotor{way}": ROTOR.format(way=way, bearing=bearing).replace("SpatialRotor", f"Rotor{way}") for way, bearing in BEARINGS.items()},
}


@pytest.fixture(scope="module", autouse=True)
def systems():
    build_systems("frames", TEXTS)


def arm_poses(t, q, u):
    """(R, position) of the arm, of the elbow's wheel, and of the tip."""
    s, alpha, beta = q
    platform = rotation([0, 1, 0], 0.3 * np.sin(2 * t))
    origin = array(0, 0, 0.2 * np.cos(3 * t))
    R = platform @ rotation([1, 0, 2], alpha)
    elbow = origin + platform @ array(s, 0, 0) + R @ array(0, 0.2, 0)
    wheel, hub = R @ rotation([0, 0, 1], beta + alpha / 2), elbow + R @ array(0.4, 0.1 * np.sin(alpha), 0)
    return {"arm": (R, elbow), "wheel": (wheel, hub), "tip": (wheel, hub + wheel @ array(0.25, 0, -0.1))}


def arm_bodies(t, q, u):
    places = arm_poses(t, q, u)
    (R, elbow), (wheel, hub) = places["arm"], places["wheel"]
    tensor = [[0.02, 0.004, -0.003], [0.004, 0.05, 0.002], [-0.003, 0.002, 0.06]]
    return [
        (2, R, elbow + R @ array(0.1, 0, 0.05 * q[0]), tensor),
        (1.5, wheel, hub + wheel @ array(0.03, 0, 0), np.diag([0.01, 0.01, 0.02])),
        (0.3, wheel, hub + wheel @ array(0, 0.2, 0), np.zeros((3, 3))),
        (0.5, np.eye(3, dtype=complex), array(q[0], 0, q[0] ** 2), np.zeros((3, 3))),
    ]


def arm_with(tau, vs):
    """Mechanism with a force that depends on the velocity vs, which is an argument so that differences by velocities exclude it."""

    def power(velocity, spin, at):
        place = lambda name: lambda t, q, u: arm_poses(t, q, u)[name][1]
        rotated = lambda name: lambda t, q, u: arm_poses(t, q, u)[name][0]
        R = np.real(arm_poses(*at[:2], at[3])["arm"][0])
        total = (R @ [3, -1, 2]) @ velocity(place("tip")) + 0.7 * vs * velocity(place("wheel"))[2]
        return total + np.array([0.2, 0, tau]) @ spin(rotated("wheel")) + np.array([0, tau, -0.4]) @ (R @ spin(rotated("arm")))

    return Mechanism(arm_bodies, (1, 0, -9.81), power)


ARM_STATES = ["s", "alpha", "beta", "vs", "va", "vb"]


def test_accelerations_of_an_arm(open_fmu):
    instance, random = open_fmu("SpatialArm"), np.random.default_rng(1)
    for _ in range(5):
        t, states, tau = random.uniform(-1, 1), random.uniform(-2, 2, 6), random.uniform(-2, 2)
        instance.reset().initialize({**dict(zip(ARM_STATES, states)), "tau": tau}, start_time=t)
        expected = arm_with(tau, states[3]).accelerations(t, states[:3], states[3:])
        got = instance.get("der(vs)", "der(va)", "der(vb)")
        assert np.allclose(got, expected, rtol=1e-10, atol=1e-10 * np.max(np.abs(expected)))


def test_components_of_an_arm(open_fmu):
    """Positions and rotations agree with their formulas, velocities and accelerations with differences along the motion."""
    instance = open_fmu("SpatialArm").initialize({"va": 1.5, "vb": -2.0, "tau": 0.3}, tolerance=1e-12)
    step = 1e-3
    names = [*(f"tip.{c}{x}" for c in ("", "v", "a") for x in "xyz"), *(f"disk.{c}{x}" for c in ("omega", "alpha") for x in "XYZ"),
             *(f"wheel.R{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), "beam.x", "beam.vx", "bolt.y", "bolt.vy", "arm.z"]  # fmt: skip
    rows = np.array(instance.run(8 * step, step, *ARM_STATES[:3], *names))
    middle = {name: rows[4, 4 + i] for i, name in enumerate(names)}
    column = {name: rows[:, 4 + i] for i, name in enumerate(names)}
    derivative = lambda values: sum(float(w) * (values[4 + k] - values[4 - k]) for k, w in enumerate(WEIGHTS, 1)) / step
    places = arm_poses(rows[4, 0], rows[4, 1:4], ())
    wheel, tip = np.real(places["tip"][0]), np.real(places["tip"][1])
    assert np.allclose([middle[f"tip.{x}"] for x in "xyz"], tip.astype(float), atol=1e-12)
    assert np.allclose([middle[f"wheel.R{i}{j}"] for i in (1, 2, 3) for j in (1, 2, 3)], wheel.astype(float).ravel(), atol=1e-12)
    assert abs(middle["arm.z"] - float(np.real(places["arm"][1][2]))) < 1e-12
    for thing, rate in [*((f"tip.{x}", f"tip.v{x}") for x in "xyz"), *((f"tip.v{x}", f"tip.a{x}") for x in "xyz"),
                        *((f"disk.omega{x}", f"disk.alpha{x}") for x in "XYZ"), ("beam.x", "beam.vx"), ("bolt.y", "bolt.vy")]:  # fmt: skip
        assert abs(derivative(column[thing]) - middle[rate]) < 1e-8 * (1 + abs(middle[rate])), rate
    R = np.array([[column[f"wheel.R{i}{j}"] for j in (1, 2, 3)] for i in (1, 2, 3)])
    W = R[:, :, 4].T @ derivative(np.moveaxis(R, 2, 0))
    assert np.allclose([W[2, 1], W[0, 2], W[1, 0]], [middle[f"disk.omega{x}"] for x in "XYZ"], atol=1e-8)


def test_work_in_a_frame_that_time_moves(open_fmu):
    """nonConservativeWork of forces and torques agrees with the trapezoidal rule over their power, up to its error of h^2."""
    instance = open_fmu("SpatialArm").initialize({"tau": 0.6})
    rows = np.array(instance.run(0.5, 2e-3, *ARM_STATES, "nonConservativeWork"))
    none = np.zeros(0)
    powers = [float(arm_with(0.6, row[4]).power((row[0], row[1:4], row[4:7], none, none))) for row in rows]
    assert abs(np.trapezoid(powers, rows[:, 0]) - rows[-1, 7]) < 1e-4 * np.max(np.abs(powers))


def random_quaternion_state(random):
    q = random.normal(size=4)
    q /= np.linalg.norm(q)
    rate = random.normal(size=4)
    return [*q], [*(rate - q * (q @ rate))]


def plate_poses(t, q, u):
    R, origin = rotation_of_quaternion(*q[3:7]), q[:3]
    return R, origin, R @ rotation([0, 1, 1], q[7])


def plate_bodies(t, q, u):
    R, origin, rotor = plate_poses(t, q, u)
    return [
        (3, R, origin + R @ array(0.05, 0, 0), [[0.2, 0, 0], [0, 0.3, 0.02], [0, 0.02, 0.45]]),
        (0.5, rotor, origin + R @ array(0, 0, 0.3), np.diag([0.001, 0.002, 0.002])),
    ]


def plate_potential(t, q, u):
    R, origin, _ = plate_poses(t, q, u)
    return 15 * np.sum((origin + R @ array(0.4, 0.3, 0) - array(0, 0, 1)) ** 2)


def test_accelerations_with_a_quaternion(open_fmu):
    plate = Mechanism(plate_bodies, (0, -9.81, 0), potential=plate_potential)
    instance, random = open_fmu("SpatialPlate"), np.random.default_rng(2)
    names = ["x", "y", "z", "a", "b", "c", "d", "psi", "vx", "vy", "vz", "va", "vb", "vc", "vd", "w"]
    for _ in range(3):
        q, rate = random_quaternion_state(random)
        states = [*random.uniform(-1, 1, 3), *q, random.uniform(-3, 3), *random.uniform(-1, 1, 3), *rate, random.uniform(-9, 9)]
        instance.reset().initialize(dict(zip(names, states)))
        norm = np.array([[0, 0, 0, *q, 0]]), [-np.dot(rate, rate)]
        expected = plate.accelerations(0.0, states[:8], states[8:], constraint=norm)
        got = instance.get(*(f"der({v})" for v in names[8:]))
        assert np.allclose(got, expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected)))


def test_quaternion_keeps_norm_and_energy(open_fmu):
    instance = open_fmu("SpatialPlate").initialize(tolerance=1e-10)
    rows = np.array(instance.run(5.0, 0.01, "a", "b", "c", "d", "totalEnergy"))
    assert np.max(np.abs(np.sum(rows[:, 1:5] ** 2, axis=1) - 1)) < 1e-12
    assert np.ptp(rows[:, 5]) < 1e-7 * abs(rows[0, 5])


def test_planar_body_is_a_frame(open_fmu):
    random = np.random.default_rng(3)
    framed, typed = open_fmu("PlanarFrame"), open_fmu("PlanarByHand")
    for _ in range(10):
        values = dict(zip(["p", "q", "vp", "vq"], random.uniform(-3, 3, 4)))
        for instance in (framed, typed):
            instance.reset().initialize(values)
        for name in ("der(vp)", "der(vq)", "h", "lower.x", "kineticEnergy", "potentialEnergy"):
            assert abs(framed.get(name) - typed.get(name)) < 1e-12 * (1 + abs(typed.get(name)))


def test_bearing_of_a_rotor(open_fmu):
    """Newton's and Euler's laws about the origin, by displacements and by driven coordinates."""
    random = np.random.default_rng(4)
    tensor = np.array([[0.1, 0, 0.03], [0, 0.15, 0], [0.03, 0, 0.2]])
    for _ in range(5):
        phi, w, tau = random.uniform(-3, 3), random.uniform(-9, 9), random.uniform(-2, 2)
        R = np.array([[np.cos(phi), -np.sin(phi), 0], [np.sin(phi), np.cos(phi), 0], [0, 0, 1]])
        J = 0.2 + 2 * 0.1**2
        alpha = (tau + (R @ [0.1, 0, 0.2])[0] * 1.5) / J
        arm, spin = R @ [0.1, 0, 0.2], np.array([0, 0, w])
        acceleration = np.cross([0, 0, alpha], arm) + np.cross(spin, np.cross(spin, arm))
        given = np.array([0, 1.5, -2 * 9.81])
        force = 2 * acceleration - given
        inertia = R @ tensor @ R.T
        momentum_rate = inertia @ [0, 0, alpha] + np.cross(spin, inertia @ spin) + np.cross(arm, 2 * acceleration)
        moment = momentum_rate - np.cross(arm, given) - R @ [0.7, 0, tau]
        expected = {"der(w)": alpha, "h.force": force[0], "v.force": force[2], "tilt.force": moment[0]}
        for way, sign in (("displacements", -1), ("drives", 1)):
            instance = open_fmu(f"Rotor{way}").initialize({"phi": phi, "w": w, "tau": tau})
            for name, value in expected.items():
                got = instance.get(name) * (1 if name == "der(w)" else sign)
                assert abs(got - value) < 1e-10 * (1 + abs(value)), (way, name)


def moved_bodies(t, q, u):
    platform, origin = rotation([0, 0.6, 0.8], u[1]), array(u[0], 0, 0)
    R = platform @ rotation([1, 0, 0], q[0])
    return [
        (2, R, origin + R @ array(0, 0, -0.5), np.diag([0.1, 0.12, 0.03])),
        (1, platform, origin, np.diag([0.3, 0.2, 0.4])),
    ]


def moved_power(velocity, spin, at):
    bob = lambda t, q, u: moved_bodies(t, q, u)[0][1]
    return np.array([0, 0.5, 0]) @ (np.real(bob(*at[:2], at[3])) @ spin(bob))


def test_frame_that_inputs_move(open_fmu):
    """The platform's drive does work too: the energy changes by nonConservativeWork."""
    mechanism = Mechanism(moved_bodies, (0, 0, -9.81), moved_power)
    instance, random = open_fmu("MovedFrame"), np.random.default_rng(5)
    names = ["q", "v", "u", "f", "der(u)", "der(f)", "der(der(u))", "der(der(f))"]
    for _ in range(5):
        values = random.uniform(-2, 2, 8)
        q, v, u, ru, au = values[:1], values[1:2], values[2:4], values[4:6], values[6:]
        instance.reset().initialize(dict(zip(names, values)))
        a = mechanism.accelerations(0.0, q, v, u, ru, au)
        assert np.allclose([instance.get("der(v)")], a, rtol=1e-10)
        later = lambda s: (s, q + s * v + s * s * a / 2, v + s * a, u + s * ru + s * s * au / 2, ru + s * au)
        assert abs(instance.get("totalEnergy") - float(sum(mechanism.energies(later(0.0))))) < 1e-11 * 50
        change = float(slope(lambda s: sum(mechanism.energies(later(s)))))
        assert abs(instance.get("der(nonConservativeWork)") - change) < 1e-9 * (1 + abs(change))


HEAD = '<system name="Wrong"><parameter name="p" start="1" unit="m"/><coordinate name="q" velocity="v" unit="rad"/>\n'
MESSAGES = [
    ('<frame name="f" in="g"/>', "there is no frame 'g'; expected the name of a <frame>"),
    ('<frame name="arm"/><frame name="f" in="amr"/>', "there is no frame 'amr'; did you mean 'arm'?"),
    ('<frame name="f" in="g"/><frame name="g" in="f"/>', "in a circle: frame f -> frame g -> frame f"),
    ('<frame name="base"><translate x="p*q"/></frame>', "the name 'base' belongs to the frame at rest; expected another name"),
    ('<particle name="base" in="base" mass="1" x="p*q"/>', "the name 'base' belongs to the frame at rest"),
    ('<body name="base" mass="1" x="p*q" inertia="p*q" angle="q"/>', "the name 'base' belongs to the frame at rest"),
    ('<frame name="f"/><point name="f"/>', "a frame, point or body named 'f' is already defined"),
    ('<frame name="f"><rotate axis="z"/></frame>', 'the rotation of <rotate> is not determined; expected axis="..." angle="...", or quaternion="..."'),
    ('<frame name="f"><rotate axis="0 1" angle="q"/></frame>', "axis of <rotate> has 2 parts; expected 3 expressions between blanks"),
    ('<frame name="f"><rotate axis="0 0 0" angle="q"/></frame>', "the axis of <rotate> has the length 0; expected a direction"),
    ('<frame name="f"><rotate axis="q 0 1" angle="q"/></frame>', "axis of <rotate> cannot depend on coordinates"),
    ('<frame name="f"><rotate quaternion="1 0 q"/></frame>', "quaternion of <rotate> has 3 parts; expected 4"),
    ('<frame name="f"><rotate quaternion="1 0 0 0"/></frame>', "the quaternion of 'f' contains no coordinate"),
    ('<frame name="f"><translate x="q"/></frame>', "unit mismatch: x has the unit rad, expected m"),
    ('<frame name="f"><rotate axis="x" angle="p"/></frame>', "unit mismatch: the angle has the unit m, expected rad"),
    ('<body name="b" mass="1" in="base" x="p*q" angle="q" inertia="1"/>', "a <body> in a frame rotates with it; expected Ixx"),
    ('<body name="b" mass="1" x="p*q"/>', "the rotation of <body> is not determined; expected angle and inertia, or in="),
    ('<body name="b" mass="1" in="f" Ixx="q"/><frame name="f"/>', "Ixx of <body> cannot depend on coordinates"),
    ('<particle name="b" mass="1" x="p*q"/><torque on="b" z="1"/>', "there is no frame or body 'b' for this torque"),
    ('<particle name="b" mass="1" in="base" x="p*q"/><torque on="b" z="1"/>', "there is no frame or body 'b' for this torque"),
    ('''<coordinate name="a" velocity="va"/><frame name="f"><rotate quaternion="a 0*q 0*q 0*q"/></frame>
     <body name="b" in="f" mass="1" Ixx="1" Iyy="1" Izz="1"/>''', "the quaternion of f is 0 at the start values; expected a norm of 1"),
    ('<frame name="f"/><torque on="f" z="p"/>', "unit mismatch: z has the unit m, expected kg.m2/s2"),
    ('<frame name="f"/><output name="o">f.u</output>', "unknown name 'f.u'; expected f.x or f.y or f.z or f.R11"),
    ('<point name="t" x="p"/><output name="o">t.omegaX</output>', "unknown name 't.omegaX'; expected t.x or t.y"),
    ('<gravity z="-9.81*q"/>', "z of <gravity> cannot depend on coordinates"),
    ('<gravity z="p"/>', "unit mismatch: z has the unit m, expected m/s2"),
    ('<force coordinate="q" in="base">1</force>', "the direction of <force> is not determined; expected coordinate="),
]


@pytest.mark.parametrize("text, message", MESSAGES)
def test_message(text, message, tmp_path):
    (tmp_path / "system.xml").write_text(f'{HEAD}<particle mass="1" x="p*sin(q)" y="p*cos(q)"/>{text}</system>')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr, result.stderr
    assert "circle" not in message or result.stderr.count("system.xml:") == 1, result.stderr


@pytest.mark.parametrize("moments, reported", [('Ixx="1" Iyy="1" Izz="2.3"', True), ('Ixx="1" Iyy="1" Izz="2"', False), ('Izz="1"', False),
                                           ('Ixx="1" Iyy="1" Izz="1" Ixy="0.7"', True), ("", False)])  # fmt: skip
def test_moments_of_no_body_give_a_warning(moments, reported, tmp_path):
    """A principal moment is at most the sum of the other two; 1 + 0.7 exceeds 1 - 0.7 + 1."""
    (tmp_path / "system.xml").write_text(f'''{HEAD}<frame name="f"><rotate axis="z" angle="q"/></frame>
      <particle mass="1" x="p*sin(q)" y="p*cos(q)"/><body name="b" in="f" mass="0" {moments}/></system>''')
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 0 and ("no body can have the moments of inertia of 'b'" in result.stderr) == reported, result.stderr


def test_gimbal_lock_of_euler_angles_is_an_error(open_fmu):
    """At gimbal lock two axes of rotation coincide."""
    instance = open_fmu("EulerPole")
    with instance.fails(ERROR, "mass matrix is singular .*'(phi|psi)'"):
        instance.initialize({"theta": 0.0, "v": 0.3, "w": 1.0})
    instance = open_fmu("EulerPole").initialize({"theta": 0.5, "v": -0.3, "w": 1.0})
    assert abs(instance.get("b.omegaZ") - 1.0) < 1e-15
