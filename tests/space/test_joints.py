"""
<joint>: a free body with a quaternion is attached to the base by each type. Its motion satisfies Newton's and Euler's laws with the forces and
torques of the joint, along the axes of the frame on the base. It also satisfies the constraints of the type.
"""

import re

import fmpy
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from building import build_systems
from fmu import archive, lagc

pytestmark = pytest.mark.long

TYPES = {
    "spherical": "x y z",
    "universal": "x y z aboutZ",
    "revolute": "x y z aboutX aboutY",
    "cylindrical": "x y aboutX aboutY",
    "prismatic": "x y aboutX aboutY aboutZ",
    "planar": "z aboutX aboutY",
    "fixed": "x y z aboutX aboutY aboutZ",
    "screw": "x y z aboutX aboutY",
}  # fmt: skip
MASS, GRAVITY, INERTIA = 2.0, np.array([0.3, -0.5, -9.81]), np.array([0.2, 0.3, 0.12])
WALL, WALL_ROTATED = np.array([0.1, -0.2, 0.4]), Rotation.from_euler("YX", [1.2, 0.4])
GRIP, GRIP_ROTATED = np.array([0.2, 0.1, 0.6]), Rotation.from_euler("XY", [-0.7, 0.3])

SYSTEM = """<system name="Hangs_{type}">
{coordinates}
<frame name="f"><translate x="x" y="y" z="z"/><rotate quaternion="a b c d"/></frame>
<body name="rod" in="f" mass="2" Ixx="0.2" Iyy="0.3" Izz="0.12"/>
<frame name="grip" in="f"><translate x="0.2" y="0.1" z="0.6"/><rotate axis="x" angle="-0.7"/><rotate axis="y" angle="0.3"/></frame>
<frame name="wall"><translate x="0.1" y="-0.2" z="0.4"/><rotate axis="y" angle="1.2"/><rotate axis="x" angle="0.4"/></frame>
<gravity x="0.3" y="-0.5" z="-9.81"/>
<joint name="hinge" type="{type}" from="wall" to="grip"/>
<experiment stopTime="1"/>
</system>"""


# Rotations about x, y and z after which the joint still fits; constrained axes then point in opposite directions.
FLIPS = {
    "universal": [(2.5, 0, 0)],
    "revolute": [(np.pi, 0, 0)],
    "cylindrical": [(np.pi, 0, 0)],
    "prismatic": [(np.pi, 0, 0), (0, np.pi, 0), (0, 0, np.pi)],
    "planar": [(np.pi, 0, 0)],
    "screw": [(np.pi, 0, 0), (0, 0, np.pi)],
}
FLIPPED = [(kind, number) for kind, flips in FLIPS.items() for number in range(len(flips))]


def start_of(kind, flip=(0, 0, 0)):
    """A state that satisfies the joint, with a velocity that it allows: rotated and moved along the free directions."""
    rotations = {"spherical": (0.3, 0.5, -0.4), "universal": (0.4, 0.6, 0), "revolute": (0, 0, 0.8), "cylindrical": (0, 0, 0.8), "planar": (0, 0, 0.8)}
    moves = {"cylindrical": (0, 0, 0.3), "prismatic": (0, 0, 0.3), "planar": (0.2, -0.1, 0)}
    relative = Rotation.from_euler("XYZ", flip) * Rotation.from_euler("XYZ", rotations.get(kind, (0, 0, 0)))
    body = WALL_ROTATED * relative * GRIP_ROTATED.inv()
    place = WALL + WALL_ROTATED.apply(moves.get(kind, (0, 0, 0))) - body.apply(GRIP)
    d = body.as_quat()
    return dict(zip("xyzabcd", map(float, [*place, d[3], *d[:3]])))


def text_of(kind, flip=(0, 0, 0)):
    start = start_of(kind, flip)
    lines = [f'<coordinate name="{q}" velocity="v{q}" unit="{"m" if q in "xyz" else "1"}" start="{start[q]!r}"/>' for q in "xyzabcd"]
    return SYSTEM.format(type=kind, coordinates="\n".join(lines))


@pytest.fixture(scope="module")
def joints():
    about_x = {f"Turned_{kind}": text_about_x(kind) for kind in THREAD}
    screw = {"Hangs_screw": text_of("screw").replace('to="grip"', 'to="grip" pitch="0.5"')}
    idle = {f"Idle_{kind}": IDLE.format(type=kind, axis=axis).replace('"Idle"', f'"Idle_{kind}"') for kind, axis in {"pin": ' axis="y"', "revolute": ' axis="y"', "spherical": ""}.items()}
    flipped = {f"Flipped_{kind}_{i}": text_of(kind, FLIPS[kind][i]).replace('name="Hangs', 'name="Flipped').replace(f'_{kind}"', f'_{kind}_{i}"', 1) for kind, i in FLIPPED}
    flipped |= {name: text.replace('to="grip"', 'to="grip" pitch="0.5"') for name, text in flipped.items() if "screw" in name}
    build_systems("joints", flipped | about_x | screw | idle | {f"Hangs_{kind}": text_of(kind) for kind in TYPES if kind != "screw"} | {"Pinned": PINNED, "Sprung": SPRUNG, "Screwed": SCREWED, "Upright": UPRIGHT, "Vectors": VECTORS, "Bushed": BUSHED} | {f"Rolls_{shape}": ROLLS.format(shape=shape, coordinates=ROLLING_COORDINATES) for shape in ("wheel", "sphere")})


def simulate(name, outputs, **words):
    return fmpy.simulate_fmu(archive(name), output=outputs, output_interval=0.05, relative_tolerance=1e-10, **words)


@pytest.mark.parametrize("name", [*(f"Hangs_{kind}" for kind in TYPES), *(f"Flipped_{kind}_{number}" for kind, number in FLIPPED)])
def test_joint_obeys_newton_and_euler(joints, name):
    """One component of the torque of a universal joint, or of a screw, gives the whole torque by the geometry."""
    system, kind = name, name.split("_")[1]
    constrained = TYPES[kind].split()
    forces = [f"hinge.{'torque' + name[-1] if 'about' in name else 'force' + name.upper()}" for name in constrained]
    names = [f"{of}{q}" for of in ("", "v") for q in "xyzabcd"] + [f"der(v{q})" for q in "xyz"] + [f"rod.{of}{q}" for of in ("omega", "alpha") for q in "XYZ"]
    result = simulate(system, [*names, *forces, "totalEnergy"])
    assert np.ptp(result["totalEnergy"]) < 1e-8
    moved = 0.0
    for row in result:
        body = Rotation.from_quat([row["b"], row["c"], row["d"], row["a"]])
        place, grip = np.array([row[q] for q in "xyz"]), body.apply(GRIP)
        between, relative = WALL_ROTATED.inv().apply(place + grip - WALL), (WALL_ROTATED.inv() * body * GRIP_ROTATED).as_matrix()
        misfit = dict(zip("xyz", between)) | {"aboutX": relative[1, 2], "aboutY": relative[0, 2], "aboutZ": relative[1, 0] if kind != "universal" else relative[0, 1]}
        assert max(abs(misfit[name]) for name in constrained if (kind, name) != ("screw", "z")) < 1e-9
        force, torque = np.zeros(3), np.zeros(3)
        for name, of in zip(constrained, forces):
            along = -row[of] * WALL_ROTATED.as_matrix()[:, "XYZ".index(name[-1].upper())]
            if kind == "universal" and name == "aboutZ":
                # The torque acts about the common normal of the x axis of the wall and the y axis of the grip.
                across = np.cross(WALL_ROTATED.as_matrix()[:, 0], (body * GRIP_ROTATED).as_matrix()[:, 1])
                along = -row[of] * across / (across @ WALL_ROTATED.as_matrix()[:, 2])
            if kind == "screw" and name == "z":
                torque -= 0.5 / (2 * np.pi) * along
            if "about" in name:
                torque += along
            else:
                force += along
        acceleration = np.array([row[f"der(v{q})"] for q in "xyz"])
        assert MASS * (acceleration - GRAVITY) == pytest.approx(force, abs=1e-7)
        omega, alpha = (np.array([row[f"rod.{of}{q}"] for q in "XYZ"]) for of in ("omega", "alpha"))
        spin = INERTIA * alpha + np.cross(omega, INERTIA * omega)
        assert body.apply(spin) == pytest.approx(np.cross(grip, force) + torque, abs=1e-7)
        moved = max(moved, np.linalg.norm(omega), np.linalg.norm([row[f"v{q}"] for q in "xyz"]))
    assert moved > 0.5 or kind == "fixed"


PINNED = """<system name="Pinned">
<parameter name="g" start="9.81" unit="m/s2"/>
<coordinate name="x" velocity="vx" unit="m" start="0.5*sin(2)"/>
<coordinate name="y" velocity="vy" unit="m" start="-0.5*cos(2)"/>
<coordinate name="phi" velocity="w" unit="rad" start="2"/>
<body name="rod" mass="3" x="x" y="y" inertia="3*1^2/12" angle="phi"/>
<point name="end" in="rod" y="0.5"/>
<gravity y="-g"/>
<joint name="hinge" type="pin" from="base" to="end"/>
<output name="pull" unit="N">hinge.forceY</output>
<experiment stopTime="1"/>
</system>"""


def test_pin_in_the_plane(joints):
    # A rod of length 1 that hangs by its end: w^2 = 3 g (cos phi - cos 2), and the hinge gives the acceleration of the centre.
    result = simulate("Pinned", ["phi", "w", "hinge.forceX", "pull"])
    phi, w, g, m, r = result["phi"], result["w"], 9.81, 3.0, 0.5
    assert w**2 == pytest.approx(3 * g * (np.cos(phi) - np.cos(2)), abs=1e-8)
    alpha = -1.5 * g * np.sin(phi)
    assert result["hinge.forceX"] == pytest.approx(-m * r * (alpha * np.cos(phi) - w**2 * np.sin(phi)), abs=1e-7)
    assert result["pull"] == pytest.approx(-m * (g + r * (alpha * np.sin(phi) + w**2 * np.cos(phi))), abs=1e-7)


EXCHANGED = '<frame name="{0}X" in="{0}"><rotate axis="1 1 1" angle="-2*pi/3"/></frame>'


def text_about_x(kind):
    """The same joint on frames with cyclically permuted axes: x in place of z, y in place of x."""
    frames = EXCHANGED.format("wall") + EXCHANGED.format("grip")
    joint = f'<joint name="hinge" type="{kind}" axis="x" from="wallX" to="gripX"{THREAD[kind]}/>'
    return re.sub("<joint.*/>", frames + joint, text_of(kind)).replace("Hangs_", "Turned_")


THREAD = {"cylindrical": "", "screw": ' pitch="0.5"'}


@pytest.mark.parametrize("kind", THREAD)
def test_other_axes(joints, kind):
    forces = {f"{of}{axis}": f"{of}{other}" for of in ("force", "torque") for axis, other in zip("XYZ", "YZX") if (of, axis) != ("torque", "Z")}
    if kind == "cylindrical":
        del forces["forceZ"]
    usual = simulate(f"Hangs_{kind}", [f"hinge.{name}" for name in forces] + ["a", "z"])
    other = simulate(f"Turned_{kind}", [f"hinge.{name}" for name in forces.values()] + ["a", "z"])
    assert np.ptp(usual["a"]) > 0.05
    for one, two in zip(usual.dtype.names[1:], other.dtype.names[1:]):
        assert other[two] == pytest.approx(usual[one], abs=1e-7)


IDLE = """<system name="Idle">
<parameter name="lean" start="0.4" unit="rad"/>
<coordinate name="a" velocity="va" unit="rad" start="2"/>
<coordinate name="b" velocity="vb" unit="rad" start="2"/>
<frame name="wall"><rotate axis="x" angle="0.3"/><rotate axis="1 2 3" angle="lean"/></frame>
<frame name="upper" in="wall"><rotate axis="y" angle="a"/></frame>
<frame name="lower" in="wall"><translate x="0.3"/><rotate axis="y" angle="b"/></frame>
<body name="one" in="upper" mass="2" z="0.5" Iyy="0.1"/><body name="two" in="lower" mass="1" z="0.5" Iyy="0.2"/>
<body name="coupler" in="bar" mass="3" x="0.15" Iyy="0.2"/>
<coordinate name="c" velocity="vc" unit="rad" start="-2"/>
<frame name="bar" in="upper"><translate z="1"/><rotate axis="y" angle="c"/></frame>
<frame name="end" in="bar"><translate x="0.3"/></frame><frame name="tip" in="lower"><translate z="1"/></frame>
<gravity z="-9.81"/>
<joint name="h" type="{type}" from="tip" to="end"{axis}/>
<experiment stopTime="1"/>
</system>"""


def test_forces_across_a_planar_motion_are_zero(joints):
    """
    In a plane inclined by numbers and by a parameter, all types that leave the rotation free are equivalent; forces across the plane are 0.
    """
    names = ["a", "va", "h.forceX", "h.forceZ", "totalEnergy"]
    pin, revolute, spherical = (simulate(f"Idle_{kind}", names) for kind in ("pin", "revolute", "spherical"))
    assert np.ptp(pin["a"]) > 0.3 and np.ptp(pin["totalEnergy"]) < 1e-8
    for name in names:
        assert revolute[name] == pytest.approx(pin[name], abs=1e-7) and spherical[name] == pytest.approx(pin[name], abs=1e-7)
    idle = simulate("Idle_revolute", ["h.forceY", "h.torqueX", "h.torqueZ"])
    assert all(np.all(idle[name] == 0) for name in idle.dtype.names[1:])


SPRUNG = """<system name="Sprung">
<parameter name="k" start="30" unit="N/m"/>
<parameter name="c" start="1.2" unit="N.s/m"/>
<for index="i" from="1" to="2">
<coordinate name="x[i]" velocity="vx[i]" unit="m" start="i*0.8"/>
<coordinate name="y[i]" velocity="vy[i]" unit="m" start="i*0.6"/>
<particle name="p[i]" mass="i*0.5" x="x[i]" y="y[i]"/>
</for>
<spring name="s" from="p[1]" to="p[2]" stiffness="k" length="0.7" damping="c"/>
<spring name="tie" from="base" to="p[1]" stiffness="0.01*k"/>
<output name="apart" unit="m">distance(p[1], p[2])</output>
<output name="approach" unit="m/s">-der(distance(p[2], p[1]))</output>
<experiment stopTime="2"/>
</system>"""


def test_spring(joints):
    # Accelerations follow from the reported force, along the line between the ends.
    outputs = ["x[1]", "y[1]", "x[2]", "y[2]", "vx[1]", "vy[1]", "vx[2]", "vy[2]", "der(vx[1])", "der(vy[2])", "s.length", "s.force", "tie.force", "apart", "approach"]
    result = simulate("Sprung", outputs, start_values={"x[2]": 1.5, "y[2]": 2.0})
    between = np.array([result["x[2]"] - result["x[1]"], result["y[2]"] - result["y[1]"]])
    length = np.hypot(*between)
    rate = np.sum(between * [result["vx[2]"] - result["vx[1]"], result["vy[2]"] - result["vy[1]"]], axis=0) / length
    force = 30 * (length - 0.7) + 1.2 * rate
    tie = 0.3 * np.hypot(result["x[1]"], result["y[1]"])
    assert result["s.length"] == pytest.approx(length, rel=1e-12) and result["apart"] == pytest.approx(length, rel=1e-12)
    assert result["approach"] == pytest.approx(-rate, abs=1e-11)
    assert result["s.force"] == pytest.approx(force, abs=1e-10) and result["tie.force"] == pytest.approx(tie, rel=1e-12)
    assert 0.5 * result["der(vx[1])"] == pytest.approx(force * between[0] / length - 0.3 * result["x[1]"], abs=1e-9)
    assert 1.0 * result["der(vy[2])"] == pytest.approx(-force * between[1] / length, abs=1e-9)


SCREWED = """<system name="Screwed">
<parameter name="p" start="-0.02" unit="m"/>
{coordinates}
<frame name="f"><translate x="x" y="y" z="z"/><rotate quaternion="a b c d"/></frame>
<body name="nut" in="f" mass="2" Ixx="0.2" Iyy="0.3" Izz="0.0001"/>
<gravity z="-9.81"/>
<joint name="rod" type="screw" from="base" to="nut" pitch="p"/>
<experiment stopTime="1"/>
</system>""".format(coordinates="\n".join(f'<coordinate name="{q}" velocity="v{q}" unit="{"m" if q in "xyz" else "1"}" start="{int(q == "a")}"/>' for q in "xyzabcd"))


def test_screw(joints):
    """A nut descends a rod with a left-hand thread, for many turns, by m z'' = -m g - J (2 pi/p)^2 z''."""
    result = simulate("Screwed", ["z", "vz", "nut.omegaZ", "rod.forceZ", "a", "d", "totalEnergy"])
    t, ratio = result["time"], 2 * np.pi / -0.02
    fall = 9.81 / (1 + 0.0001 * ratio**2 / 2)
    assert fall * 0.5 > 3 * 0.02
    assert result["z"] == pytest.approx(-fall * t**2 / 2, abs=1e-8)
    assert result["nut.omegaZ"] == pytest.approx(ratio * result["vz"], abs=1e-6)
    # The thread constrains the angle itself, not only its rate.
    angle = 2 * np.arctan2(result["d"], result["a"])
    assert np.sin((angle - ratio * result["z"]) / 2) == pytest.approx(0, abs=1e-9)
    assert result["rod.forceZ"] == pytest.approx(-2 * (9.81 - fall), abs=1e-7)
    assert np.ptp(result["totalEnergy"]) < 1e-8


PLANE_ROTATED, RADIUS, SPIN = Rotation.from_euler("YX", [0.1, -0.15]), 0.3, np.array([0.05, 0.05, 0.09])
LEAN = Rotation.from_euler("YX", [0.1, -0.15]) * Rotation.from_euler("X", 1.3)
ROLLING_START = dict(zip("abcd", map(float, LEAN.as_quat()[[3, 0, 1, 2]]))) | dict(zip("xyz", map(float, PLANE_ROTATED.apply([0.5, 0.2, 0.3]) + [0.1, -0.2, 0.4])))
ROLLING_VELOCITY = {"vb": -0.3, "vd": 2.5, "vc": 0.4}
ROLLING_COORDINATES = "\n".join(
    f'<coordinate name="{q}" velocity="v{q}" unit="{"m" if q in "xyz" else "1"}" start="{ROLLING_START[q]!r}" velocityStart="{ROLLING_VELOCITY.get("v" + q, 0)}"/>' for q in "xyzabcd"
)
ROLLS = """<system name="Rolls_{shape}">
{coordinates}
<frame name="plane"><translate x="0.1" y="-0.2" z="0.4"/><rotate axis="y" angle="0.1"/><rotate axis="x" angle="-0.15"/></frame>
<frame name="f"><translate x="x" y="y" z="z"/><rotate quaternion="a b c d"/></frame>
<body name="wheel" in="f" mass="2" Ixx="0.05" Iyy="0.05" Izz="0.09"/>
<gravity x="0.3" y="-0.5" z="-9.81"/>
<joint name="ground" type="rolling" from="plane" to="f" radius="0.3" shape="{shape}"/>
<experiment stopTime="0.6"/>
</system>"""


@pytest.mark.parametrize("shape", ["wheel", "sphere"])
def test_rolling_obeys_newton_and_euler(joints, shape):
    """The reported forces act at the lowest point, which is at rest; the only other force is the weight."""
    forces = [f"ground.force{axis}" for axis in "XYZ"]
    names = [f"{of}{q}" for of in ("", "v") for q in "xyzabcd"] + [f"der(v{q})" for q in "xyz"] + [f"wheel.{of}{q}" for of in ("omega", "alpha") for q in "XYZ"]
    result = simulate(f"Rolls_{shape}", [*names, *forces, "totalEnergy"])
    assert np.ptp(result["totalEnergy"]) < 1e-7
    up, way = PLANE_ROTATED.apply([0, 0, 1]), 0.0
    for row in result:
        body, place = Rotation.from_quat([row["b"], row["c"], row["d"], row["a"]]), np.array([row[q] for q in "xyz"])
        axle = body.apply([0, 0, 1])
        # The lowest point of a circle is along the downward direction perpendicular to the axle.
        down = -up if shape == "sphere" else np.cross(np.cross(axle, -up), axle)
        lever = RADIUS * down / np.linalg.norm(down)
        assert up @ (place + lever - WALL) == pytest.approx(0, abs=1e-9)
        omega, alpha = (np.array([row[f"wheel.{of}{q}"] for q in "XYZ"]) for of in ("omega", "alpha"))
        velocity = np.array([row[f"v{q}"] for q in "xyz"])
        assert velocity + np.cross(body.apply(omega), lever) == pytest.approx(np.zeros(3), abs=1e-8)
        force = -PLANE_ROTATED.apply([row[of] for of in forces])
        assert 2 * (np.array([row[f"der(v{q})"] for q in "xyz"]) - GRAVITY) == pytest.approx(force, abs=1e-7)
        assert body.apply(SPIN * alpha + np.cross(omega, SPIN * omega)) == pytest.approx(np.cross(lever, force), abs=1e-7)
        way = max(way, np.linalg.norm(velocity))
    assert way > 0.5


UPRIGHT = """<system name="Upright">
<coordinate name="x" velocity="v" unit="m"/>
<coordinate name="phi" velocity="w" unit="rad"/>
<frame name="road"><rotate axis="x" angle="-pi/2"/></frame>
<body name="disk" mass="2" x="x" y="0.1" inertia="0.01" angle="phi"/>
<force on="disk" x="3"/>
<joint name="ground" type="rolling" from="road" to="disk" radius="0.1" holds="x"/>
<experiment stopTime="1"/>
</system>"""


def test_wheel_in_the_plane(joints):
    """Coordinates keep the wheel on the road: 3 N accelerate a disk of 2 kg plus 0.01/0.1^2 kg, which rotates as it rolls."""
    result = simulate("Upright", ["x", "phi", "ground.forceX"])
    assert result["x"] == pytest.approx(result["time"] ** 2 / 2, abs=1e-8)
    assert result["phi"] == pytest.approx(-10 * result["x"], abs=1e-8)
    assert result["ground.forceX"] == pytest.approx(1, abs=1e-8)


VECTORS = """<system name="Vectors">
<parameter name="L" start="2" unit="m"/>
<coordinate name="p" velocity="vp" unit="rad" start="0.3" velocityStart="1.1"/>
<coordinate name="q" velocity="vq" unit="rad" start="-0.7" velocityStart="-0.4"/>
<frame name="arm"><rotate axis="z" angle="p"/><translate x="0.5"/><rotate axis="y" angle="q"/></frame>
<body name="rod" in="arm" mass="1" x="0.3" Ixx="0.1" Iyy="0.2" Izz="0.3"/>
<point name="tip" in="arm" x="0.4" y="-0.2" z="0.1"/>
<body name="disk" mass="1" x="L*p" y="L*q/2" inertia="0.1" angle="p"/>
<output name="a" unit="m2">dot(tip, disk - arm)</output>
<output name="b" unit="m2/s">norm(cross(tip - arm, tip.v - rod.v))</output>
<output name="c" unit="m2/s">dot(cross(arm.axisY, -tip), (rod.v + tip.v))</output>
<output name="d" unit="1">dot(arm.axisX, base.axisY) - dot(arm.axisZ, cross(base.axisX, arm.axisY))</output>
<experiment stopTime="1"/>
</system>"""


def test_vectors(joints):
    """Expressions of vectors agree with NumPy's products of rotations."""
    for row in simulate("Vectors", ["p", "q", "vp", "vq", "a", "b", "c", "d"]):
        about_z = Rotation.from_euler("Z", row["p"])
        rotated = about_z * Rotation.from_euler("Y", row["q"])
        arm, omega = about_z.apply([0.5, 0, 0]), [0, 0, row["vp"]] + row["vq"] * about_z.apply([0, 1, 0])
        offsets = {"tip": rotated.apply([0.4, -0.2, 0.1]), "rod": rotated.apply([0.3, 0, 0])}
        velocity = {name: np.cross([0, 0, row["vp"]], arm) + np.cross(omega, offset) for name, offset in offsets.items()}
        tip, (x, y, z) = arm + offsets["tip"], rotated.as_matrix().T
        assert row["a"] == pytest.approx(tip @ (np.array([2 * row["p"], row["q"], 0]) - arm), abs=1e-12)
        assert row["b"] == pytest.approx(np.linalg.norm(np.cross(offsets["tip"], velocity["tip"] - velocity["rod"])), abs=1e-12)
        assert row["c"] == pytest.approx(np.cross(y, -tip) @ (velocity["rod"] + velocity["tip"]), abs=1e-12)
        assert row["d"] == pytest.approx(x[1] - z @ np.cross([1, 0, 0], y), abs=1e-12)


BUSHED = """<system name="Bushed">
{coordinates}
<frame name="f"><translate x="x" y="y" z="z"/><rotate quaternion="a b c d"/></frame>
<body name="rod" in="f" mass="2" Ixx="0.2" Iyy="0.3" Izz="0.12"/>
<frame name="wall"><translate x="0.1" y="-0.2" z="0.4"/><rotate axis="y" angle="1.2"/><rotate axis="x" angle="0.4"/></frame>
<bushing from="wall" to="rod" stiffness="30 40 50" damping="1 2 3" torsion="4" torsionDamping="0.1 0.2 0.3"/>
<experiment stopTime="1"/>
</system>""".format(coordinates="\n".join(f'<coordinate name="{q}" velocity="v{q}" unit="{"m" if q in "xyz" else "1"}" start="{(q == "a") + 0.1 * (q in "xyz")}" velocityStart="{0.5 * (q in "bdy")}"/>' for q in "xyzabcd"))


def test_bushing(joints):
    """
    Forces and torques act along the axes of the wall; equal torsional stiffness about all axes gives 4 sin(angle) about the axis of
    rotation.
    """
    names = [f"{of}{q}" for of in ("", "v") for q in "xyzabcd"] + [f"der(v{q})" for q in "xyz"] + [f"rod.{of}{q}" for of in ("omega", "alpha") for q in "XYZ"]
    for row in simulate("Bushed", names):
        body = Rotation.from_quat([row["b"], row["c"], row["d"], row["a"]])
        place, velocity, acceleration = (np.array([row[name.format(q)] for q in "xyz"]) for name in ("{}", "v{}", "der(v{})"))
        omega, alpha = (np.array([row[f"rod.{of}{q}"] for q in "XYZ"]) for of in ("omega", "alpha"))
        back = WALL_ROTATED.inv()
        force = -np.array([30, 40, 50]) * back.apply(place - WALL) - np.array([1, 2, 3]) * back.apply(velocity)
        turn = (back * body).as_rotvec()
        torque = -4 * np.sinc(np.linalg.norm(turn) / np.pi) * turn - np.array([0.1, 0.2, 0.3]) * back.apply(body.apply(omega))
        assert 2 * acceleration == pytest.approx(WALL_ROTATED.apply(force), abs=1e-8)
        assert body.apply(INERTIA * alpha + np.cross(omega, INERTIA * omega)) == pytest.approx(WALL_ROTATED.apply(torque), abs=1e-7)


BAD = [
    ('<joint name="h" type="pin" from="base" to="tip"/>', "there is nothing named 'tip' for this <joint>"),
    ('<frame name="far"><translate z="0.1"/></frame><joint name="h" type="revolute" from="far" to="bob"/>', "the joint 'h' cannot be assembled: z is -0.1 at all times; expected ends for which it is 0"),
    ('<joint name="h" type="spherical" from="base" to="bob" axis="x"/>', '<joint type="spherical"> has no axis; expected it without the attribute \'axis\''),
    ('<spring from="bob" to="base"/>', "<spring> has neither stiffness nor damping"),
    ('<spring from="bob" to="tip" stiffness="k"/>', "there is no point 'tip'"),
    ('<spring from="bob" to="base" stiffness="2*x"/>', "stiffness of <spring> cannot depend on coordinates"),
    ('<output name="o">distance(bob)</output>', "expected ',' between the two points of distance"),
    ('<joint name="h" type="hinge" from="base" to="bob"/>', "expected pin, spherical, universal, revolute, cylindrical, prismatic, planar, fixed, screw or rolling"),
    ('<joint name="h" type="pin" from="bob" to="bob"/>', "nothing moves along or about the axes that the joint 'h' constrains; expected 'bob' and 'bob' that move"),
    ('<bushing from="base" to="bob"/>', "<bushing> has neither stiffness nor damping"),
    ('<bushing from="base" to="bob" stiffness="1 2"/>', "the stiffness of <bushing> has 2 parts; expected one, or three"),
    ('<bushing from="base" to="tip" stiffness="1"/>', "there is nothing named 'tip' for this <bushing>"),
    ('<bushing from="base" to="bob" torsion="1"/>', "the energy of <bushing> is the same at all times; expected 'base' and 'bob' that move or rotate"),
    ('<output name="o">dot(bob, tip)</output>', "there is no point 'tip'"),
    ('<output name="o">dot(bob)</output>', "expected ',' between the two vectors of dot"),
    ('<output name="o">norm(bob, bob)</output>', "expected ')' after the vector of norm"),
    ('<output name="o">norm(+bob)</output>', "or a vector such as arm.axisX, tip.v or cross(...), found '+'"),
    ('<output name="o">cross(bob, bob)</output>', "cross(...) is a vector; expected it in dot(...) or norm(...)"),
    ('<parameter name="d" start="1" unit="m"/><output name="o">norm(bob + base.axisX)</output>', "m and 1 in one sum"),
    ('<output name="o">distance(bob, base.axisX)</output>', "distance(...) is between two points"),
    ('<output name="o">norm(bob.axisW)</output>', "there is no point 'bob.axisW'"),
    ('<point name="tip" x="x"/><potential>dot(tip.v, tip.v)*tip.v</potential>', "unknown name 'tip.v'"),
    ('<point name="tip" x="x"/><particle mass="1" x="norm(tip.v)"/>', "cannot depend on velocities, but 'tip.vx' does"),
    ('<joint name="h" type="screw" from="base" to="bob"/>', "<joint type=\"screw\"> needs the attribute 'pitch'"),
    ('<joint name="h" type="screw" from="base" to="bob" pitch="0"/>', "the pitch of <joint> is 0; expected a length"),
    ('<joint name="h" type="pin" from="base" to="bob" radius="1"/>', "<joint> has the attribute 'radius' with type=\"rolling\" alone"),
    ('<joint name="h" type="rolling" from="base" to="bob" radius="1"/>', "'bob' has no axes and cannot roll; expected a <frame> or <body>"),
    ('<body name="disk" mass="1" x="x" y="1" inertia="1" angle="y"/><frame name="road"><rotate axis="x" angle="-pi/2"/></frame><joint name="h" type="rolling" from="road" to="disk" radius="1"/>',
     'expected the axes along which something moves, such as holds="x y"'),
    ('<spring from="bob" to="bob" stiffness="k"/>', "the ends 'bob' and 'bob' of <spring> are 0 m apart at all times; expected two that move"),
]  # fmt: skip


@pytest.mark.parametrize("line, message", BAD)
def test_errors(tmp_path, line, message):
    file = tmp_path / "system.xml"
    file.write_text(f"""<system name="Bad"><parameter name="k" start="1"/><coordinate name="x" velocity="v"/><coordinate name="y" velocity="w"/>
<particle name="bob" mass="1" x="x" y="y"/>
{line}
</system>""")
    result = lagc(file, "-o", tmp_path)
    assert result.returncode == 1 and f"{file}:3: " in result.stderr and message in result.stderr, result.stderr


def test_a_mistake_in_a_spring_is_reported_once(tmp_path):
    """A wrong unit of the stiffness, which is used for energy, length and force, is reported once; a negative stiffness gives a warning."""
    (tmp_path / "system.xml").write_text("""<system name="Bad"><parameter name="c" start="2" unit="N"/>
<coordinate name="x" velocity="v" unit="m"/><particle name="bob" mass="1" x="x"/>
<spring name="s" from="base" to="bob" stiffness="c"/><spring from="base" to="bob" stiffness="-3" damping="-1"/>
</system>""")
    lines = lagc("system.xml", "-o", "out", cwd=tmp_path).stderr.splitlines()
    assert lines == ["system.xml:3: unit mismatch: stiffness has the unit kg.m/s2, expected kg/s2"]
    (tmp_path / "system.xml").write_text((tmp_path / "system.xml").read_text().replace('stiffness="c"', 'stiffness="c/1"').replace('unit="N"', 'unit="N/m"'))
    lines = lagc("system.xml", "-o", "out", cwd=tmp_path).stderr.splitlines()
    assert lines == [f"system.xml:3: warning: the {of} of <spring> is {value} at the start values; expected none below 0" for of, value in (("stiffness", -3), ("damping", -1))]
