"""Rigid boxes thrown onto floors, onto a swinging plate, and beside a ball, and pushed cylinders: simulations complete, and energy never grows."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import fmu
from building import build_systems

pytestmark = pytest.mark.long

HEAD = '<parameter name="m" start="2" unit="kg"/><parameter name="mu" start="0.3" unit="1"/><parameter name="e" start="0" unit="1"/><gravity z="-9.81"/>'


def free(name, place, shape):
    """A freely moving body with a shape."""
    quaternion = "".join(f'<coordinate name="{name}q{i}" velocity="{name}r{i}" unit="1" start="{int(i == 0)}"/>' for i in range(4))
    places = "".join(f'<coordinate name="{name}{x}" velocity="{name}v{x}" unit="m" start="{start}"/>' for x, start in zip("xyz", place))
    return f"""{places}{quaternion}
  <frame name="{name}"><translate x="{name}x" y="{name}y" z="{name}z"/><rotate quaternion="{name}q0 {name}q1 {name}q2 {name}q3"/></frame>
  <body name="{name}Body" in="{name}" mass="m" Ixx="0.02" Iyy="0.03" Izz="0.04"/><shape name="{name}Shape" in="{name}" {shape}/>"""


BOX = 'type="box" sizeX="0.4" sizeY="0.3" sizeZ="0.2"'
CONTACT = '<contact name="{}" between="{}" and="{}" restitution="e" friction="mu"/>'
FLOOR = f"""{free("a", (0, 0, 0.3), BOX)}<shape name="floor" type="plane"/>{CONTACT.format("c", "aShape", "floor")}"""
PLATE = """<coordinate name="h" velocity="vh" unit="m"/><coordinate name="p" velocity="wp" unit="rad"/>
  <frame name="plate"><translate z="h"/><rotate axis="y" angle="p"/></frame><body name="board" in="plate" mass="5" Ixx="1" Iyy="1" Izz="1"/>
  <potential>50*h^2 + 200*p^2</potential>"""
AT_WALL = f"""{free("a", (-0.4, -0.4, 0.1), 'type="box" sizeX="0.2" sizeY="0.2" sizeZ="0.2"')}<shape name="floor" type="plane"/>
  <frame name="side"><translate x="-0.5"/><rotate axis="y" angle="pi/2"/></frame><shape name="wall" in="side" type="plane"/>
  {CONTACT.format("c", "aShape", "floor")}{CONTACT.format("d", "aShape", "wall")}
  <parameter name="Fx" start="0" unit="N/s"/><parameter name="Fy" start="0" unit="N/s"/><parameter name="Fz" start="0" unit="N/s"/>
  <parameter name="height" start="0" unit="m"/><point name="pushed" in="a" z="height"/><force on="pushed" x="Fx*time" y="Fy*time" z="Fz*time"/>
  <state name="given" unit="J" rate="time*(Fx*der(pushed.x) + Fy*der(pushed.y) + Fz*der(pushed.z))"/>"""
FEET = {"TableOnFour": 4, "TableOnSix": 6}


def place_of_foot(index, count):
    return np.array([0.3 * math.cos(2 * math.pi * index / count + 0.1), 0.3 * math.sin(2 * math.pi * index / count + 0.1), -0.28])


def table(count):
    """A body on spherical feet, with a growing push beside its centre of mass."""
    feet = ""
    for index in range(count):
        x, y, z = place_of_foot(index, count)
        feet += f'<shape name="foot{index}" in="a" type="sphere" radius="0.02" x="{x}" y="{y}" z="{z}"/>'
        feet += CONTACT.format(f"c{index}", f"foot{index}", "floor")
    body = free("a", (0, 0, 0.3), "").replace('<shape name="aShape" in="a" />', "")
    return f"""{body}<parameter name="rate" start="2" unit="N/s"/><parameter name="dir" start="0" unit="rad"/>
  <parameter name="off" start="0" unit="m"/><shape name="floor" type="plane"/><point name="pushed" in="a" x="off" y="-0.5*off"/>{feet}
  <force on="pushed" x="rate*time*cos(dir)" y="rate*time*sin(dir)"/>
  <state name="given" unit="J" rate="rate*time*(cos(dir)*der(pushed.x) + sin(dir)*der(pushed.y))"/>"""


HEAP = 12


def heap():
    """Spheres that move in a vertical plane without friction, between two walls."""
    walls = "".join(
        f'<frame name="at{name}"><translate x="{x}"/><rotate axis="y" angle="{angle}"/></frame><shape name="{name}" in="at{name}" type="plane"/>'
        for name, x, angle in [("left", -0.6, "pi/2"), ("right", 0.6, "-pi/2")]
    )
    spheres, pairs = "", []
    for k in range(HEAP):
        x, z = -0.35 + 0.25 * (k % 4) + 0.01 * (k // 4 % 3), 0.15 + 0.22 * (k // 4)
        spheres += f"""<coordinate name="x{k}" velocity="vx{k}" unit="m" start="{x}"/><coordinate name="z{k}" velocity="vz{k}" unit="m" start="{z}"/>
  <particle name="p{k}" mass="m" x="x{k}" z="z{k}"/><shape name="s{k}" in="p{k}" type="sphere" radius="0.1"/>"""
        pairs += [(k, other) for other in ["floor", "left", "right", *(f"s{j}" for j in range(k))]]
    contacts = "".join(f'<contact name="c{k}_{other}" between="s{k}" and="{other}" restitution="e"/>' for k, other in pairs)
    return f'<shape name="floor" type="plane"/>{walls}{spheres}{contacts}'


def column():
    """Two boxes on each other, of which the upper one is pushed with a growing force."""
    boxes = "".join(
        free(f"b{k}", (0, 0, 0.2 * k - 0.1), 'type="box" sizeX="0.4" sizeY="0.6" z="-0.1"')
        + f'<shape name="top{k}" in="b{k}" type="plane" z="0.1"/>'
        + CONTACT.format(f"c{k}", f"b{k}Shape", "top1" if k == 2 else "floor")
        for k in (1, 2)
    )
    return f"""<shape name="floor" type="plane"/>{boxes}<parameter name="rate" start="2" unit="N/s"/><parameter name="dir" start="0" unit="rad"/>
  <parameter name="height" start="0" unit="m"/><point name="pushed" in="b2" z="height"/><force on="pushed" x="rate*time*cos(dir)" y="rate*time*sin(dir)"/>"""


def in_plane(name, height, shape):
    """A body with a shape that moves in a vertical plane."""
    return f"""<coordinate name="{name}x" velocity="{name}vx" unit="m"/><coordinate name="{name}z" velocity="{name}vz" unit="m" start="{height}"/>
  <coordinate name="{name}a" velocity="{name}w" unit="rad"/><frame name="{name}"><translate x="{name}x" z="{name}z"/><rotate axis="y" angle="{name}a"/></frame>
  <body name="{name}Body" in="{name}" mass="m" Ixx="0.03" Iyy="0.03" Izz="0.03"/><shape name="{name}Shape" in="{name}" {shape}/>"""


def rocking_column():
    """Three square boxes on each other that move in a vertical plane."""
    return '<shape name="floor" type="plane"/>' + "".join(
        in_plane(f"b{k}", 0.2 * k - 0.1, 'type="box" sizeX="0.2" z="-0.1"')
        + f'<shape name="top{k}" in="b{k}" type="plane" z="0.1"/>'
        + CONTACT.format(f"c{k}", f"b{k}Shape", f"top{k - 1}" if k > 1 else "floor")
        for k in (1, 2, 3)
    )


DISKS = 9


def disks():
    """Disks with friction that move in a vertical plane, between two walls."""
    walls = "".join(
        f'<frame name="at{name}"><translate x="{x}"/><rotate axis="y" angle="{angle}"/></frame><shape name="{name}" in="at{name}" type="plane"/>'
        for name, x, angle in [("left", -0.35, "pi/2"), ("right", 0.35, "-pi/2")]
    )
    bodies = ""
    for k in range(DISKS):
        start = f'<coordinate name="b{k}x" velocity="b{k}vx" unit="m" start="{-0.22 + 0.22 * (k % 3) + 0.005 * (k // 3)}"/>'
        others = ["floor", "left", "right", *(f"b{j}Shape" for j in range(k))]
        body = in_plane(f"b{k}", 0.15 + 0.22 * (k // 3), 'type="sphere" radius="0.1"')
        bodies += body.replace(f'<coordinate name="b{k}x" velocity="b{k}vx" unit="m"/>', start)
        bodies += "".join(CONTACT.format(f"c{k}_{other}", f"b{k}Shape", other) for other in others)
    return f'<shape name="floor" type="plane"/>{walls}{bodies}'


TEXTS = {
    "Disks": disks(),
    "ThrownInPlane": in_plane("a", 0.4, 'type="box" sizeX="0.3" sizeZ="0.2"') + '<shape name="floor" type="plane"/>' + CONTACT.format("c", "aShape", "floor"),
    "RockingColumn": rocking_column(),
    "PushedColumn": column(),
    "Heap": heap(),
    "ThrownBox": FLOOR,
    "BoxOnPlate": PLATE + FLOOR.replace('name="floor"', 'name="floor" in="plate"'),
    "PushedCylinder": f"""<parameter name="rate" start="2" unit="N/s"/>{free("a", (0, 0, 0.1), 'type="cylinder" radius="0.06" length="0.2"')}
  <point name="top" in="a" z="0.02"/><shape name="floor" type="plane"/>{CONTACT.format("c", "aShape", "floor")}
  <force on="top" x="rate*time" y="0.3*rate*time"/>""",
    "PushedSlab": f"""<parameter name="Fx" start="0" unit="N"/><parameter name="Fy" start="0" unit="N"/>
  {free("a", (0, 0, 0.1), 'type="box" sizeX="0.3" sizeY="0.3" sizeZ="0.2"')}<point name="top" in="a" z="0.1"/><shape name="floor" type="plane"/>
  {CONTACT.format("c", "aShape", "floor")}<force on="top" x="Fx" y="Fy"/>""",
    # Corners on the floor and at one or two walls: where some stick, others cannot part.
    "BoxAtWall": AT_WALL,
    "BoxInCorner": AT_WALL
    + f'''<frame name="back"><translate y="-0.5"/><rotate axis="x" angle="-pi/2"/></frame><shape name="rear" in="back" type="plane"/>
  {CONTACT.format("r", "aShape", "rear")}''',
    **{name: table(count) for name, count in FEET.items()},
    # The distance of ball and box contains a square root, which makes the search for events shorten its intervals.
    "BoxBesideBall": FLOOR + free("b", (0.05, 0, 0.6), 'type="sphere" radius="0.1"') + CONTACT.format("far", "bShape", "aShape"),
}


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("rigid-scenes", {
        name: f'<system name="{name}">{HEAD}{body}<solver tolerance="1e-8"/><experiment stopTime="2"/></system>' for name, body in TEXTS.items()
    })  # fmt: skip


def velocities(*numbers, name="a"):
    return dict(zip([f"{name}{part}" for part in ("vx", "vy", "vz", "r1", "r2", "r3")], numbers))


# Difficult cases: a corner at its friction limit that stops at once, a body that an impact stops completely, a body balanced on two
# corners.
THROWN = [(1.2, 0.1, -1.5, 1.1, -0.3, 0.3), (-0.1, 0.1, 0.0, -0.7, -1.4, 0.3), (0.3, 0.0, 1.3, -0.5, -1.8, 0.8), (-0.9, -1.4, 1.2, -0.1, 1.0, -2.0),
          (-0.3, 1.4, -0.4, -0.8, -0.1, -0.9)]  # fmt: skip


def largest_growth(tolerance):
    """Return the growth of the energy, in J, that errors of the solver may cause in a step."""
    return max(1e-9, 0.1 * (tolerance or 0.0))


def run(name, values, time, tolerance=None, step=0.02):
    """Simulate to a time, or until the simulation stops; return the energies."""
    instance = fmu.Instance(name).initialize(values, tolerance)
    energies = [instance.get("totalEnergy")]
    while instance.time < time - 1e-9:
        instance.step(step)
        energies.append(instance.get("totalEnergy"))
        assert np.isfinite(energies[-1]) and energies[-1] < energies[-2] + largest_growth(tolerance)
    return instance, energies


@pytest.mark.parametrize("thrown", THROWN)
def test_thrown_boxes(thrown):
    """They come to rest on a face, where the floor carries their weight."""
    instance, energies = run("ThrownBox", {"mu": 0.5, "e": 0.5} | velocities(*thrown), 2.0)
    height = instance.get("az")
    assert min(abs(height - half) for half in (0.2, 0.15, 0.1)) < 1e-8 and energies[-1] == pytest.approx(2 * 9.81 * height, abs=1e-8)
    assert sum(instance.get(f"c[{i}].force") for i in range(1, 9)) == pytest.approx(2 * 9.81, rel=1e-9)
    instance.free()


@pytest.mark.parametrize(
    "mu, e, thrown, time",
    [
        (1.0, 0.0, (-0.416, -1.002, -1.063, -1.739, -0.795, 0.412), 0.5),
        (2.0, 0.3, (0.695, 1.349, 0.391, 1.152, -1.573, -0.262), 1.5),
        (0.1, 0.0, (-0.002, -0.485, -1.233, -0.911, 1.128, 1.47), 1.6),
    ],
)
def test_box_on_plate(mu, e, thrown, time):
    """The plate moves away from corners that would stick, with friction on one corner and on several."""
    run("BoxOnPlate", {"mu": mu, "e": e, "az": 0.4} | velocities(*thrown), time)[0].free()


def test_slab_on_three_corners():
    """The fourth corner touches without a force, and rounding of its gap makes no events."""
    values = {"mu": 1.4254541200031945, "avx": 3.5145630763180904, "avy": -1.9242515374913545, "ar3": -1.993404335132431}
    values |= {"Fx": -6.0044303761617, "Fy": -10.778350136403763}
    instance = fmu.Instance("PushedSlab").initialize(values)
    flat = 0
    for _ in range(10):
        instance.step(0.05)
        forces = instance.get(*[f"c[{corner}].force" for corner in range(1, 9)])
        if sum(force > 0 for force in forces) != 3:
            continue
        flat += 1
        assert instance.get("az") == pytest.approx(0.1, abs=1e-12) and sum(forces) == pytest.approx(2 * 9.81, rel=1e-9)
    assert flat > 3 and instance.fmu.getInteger(instance.vr("events"))[0] < 20
    instance.free()


def run_pushed(name, values, time, step, tolerance=None):
    """Simulate to a time; without the work of the push, the energy never grows."""
    instance = fmu.Instance(name).initialize(values, tolerance)
    energies = [instance.get("totalEnergy")]
    while instance.time < time - 1e-9:
        instance.step(step)
        energies.append(instance.get("totalEnergy") - instance.get("given"))
    assert np.diff(energies).max() < max(1e-6, largest_growth(tolerance))
    instance.free()


@pytest.mark.parametrize("name, draw, time", [("BoxAtWall", 16, 2.0), ("BoxAtWall", 18, 3.0), ("BoxAtWall", 19, 3.0), ("BoxInCorner", 6, 1.0),
                                              ("BoxInCorner", 7, 2.5)])  # fmt: skip
def test_box_at_walls(name, draw, time):
    """Random growing pushes on a box that touches floor and walls: it gains no energy but that of the pushes."""
    draws = np.random.default_rng(draw)
    values = {"mu": draws.uniform(0.05, 1), "e": draws.choice([0, 0.5]), "Fx": draws.uniform(-8, 4), "Fy": draws.uniform(-8, 4), "Fz": draws.uniform(-3, 2)}
    values |= {"height": draws.uniform(-0.05, 0.1), "avx": draws.uniform(-1, 0.3), "avy": draws.uniform(-1, 0.3)}
    run_pushed(name, values if draw % 2 == 0 else values | {"avx": 0.0, "avy": 0.0}, time, 0.1)


@pytest.mark.parametrize(
    "mu, rate, direction, off, time",
    [
        (1.4174313530799332, 19.54863040844638, 0.5076502300643817, 0.18220674959850888, 1.08),
        (1.1722362704061469, 17.313360478316266, 4.379471222492805, 0.02825320436629486, 6),
        (1.0617175138913386, 3.3027448783709192, 2.0321547557367214, 0.2793635596126901, 6),
    ],
)
def test_pushed_table(mu, rate, direction, off, time):
    """It tips over two feet, whose frictions hold it, as the forces of the other two vanish at the same time; then it slips."""
    run_pushed("TableOnFour", {"mu": mu, "rate": rate, "dir": direction, "off": off}, time, 0.12)


@pytest.mark.parametrize("name, draw, tolerance, time", [("TableOnSix", 1, 1e-6, 4.0), ("TableOnSix", 7, 1e-6, 1.2), ("TableOnSix", 23, 1e-4, 4.0),
    ("TableOnSix", 115, 1e-6, 4.0), ("TableOnFour", 105, 1e-8, 4.0), ("TableOnFour", 107, 1e-4, 4.0), ("TableOnFour", 109, 1e-6, 4.0)])  # fmt: skip
def test_table_turns_about_a_foot(name, draw, tolerance, time):
    """
    Feet lift, have no friction, and slide as they close again beside one that begins to slip. A foot that is lifted makes no events. One that is
    slow slides on along its velocity. One that would have to pull so that all stick is among those that slip.
    """
    draws = np.random.default_rng(draw)
    values = {key: draws.uniform(*bounds) for key, bounds in {"mu": (0.1, 1.5), "rate": (2, 20), "dir": (0, 6.28), "off": (-0.3, 0.3)}.items()}
    run_pushed(name, values, time, 0.2, tolerance)


@pytest.mark.parametrize("values, tolerance", [
    ({"mu": 1.0899115858256776, "rate": 11.83479078491352, "dir": 4.440743470547105, "off": -0.25606297722320964}, 1e-8),
    ({"mu": 1.0379940897225186, "rate": 14.273263387031172, "dir": 0.6362746292466653, "off": -0.047663312645653544}, 1e-6)])  # fmt: skip
def test_a_table_slides_on(values, tolerance):
    """
    A foot at 2e-8 m/s has no forces along its velocity: it slips along its force. The forces of another one would have no bound. An impulse ends
    its slip, without a warning, as this is within the errors of rest.
    """
    instance = fmu.Instance("TableOnFour").initialize(values, tolerance)
    energies = [instance.get("totalEnergy")]
    while instance.time < 2.0:
        instance.step(0.02)
        energies.append(instance.get("totalEnergy") - instance.get("given"))
    assert np.diff(energies).max() < max(1e-6, largest_growth(tolerance))
    assert not any("an impulse ends the slip" in text for _, _, text in instance.messages)
    instance.free()


@pytest.mark.parametrize("name, draw, tolerance", [("BoxAtWall", 10, 1e-6), ("BoxAtWall", 25, 1e-6), ("BoxInCorner", 0, 1e-8)])
def test_box_without_margin(name, draw, tolerance):
    """A corner at its friction limit, which a wall unloads for a moment, has no margin left: the forces are found again."""
    draws = np.random.default_rng(draw)
    bounds = {"Fx": (-8, 4), "Fy": (-8, 4), "Fz": (-3, 2), "height": (-0.05, 0.1), "avx": (-1, 0.3), "avy": (-1, 0.3)}
    values = {"mu": draws.uniform(0.05, 1), "e": draws.choice([0, 0.5])} | {key: draws.uniform(*limits) for key, limits in bounds.items()}
    run_pushed(name, values, 2.0, 0.1, tolerance)


def test_feet_that_jam_each_other():
    """
    The forces of two feet grow without bound, each pressed by the other's friction, and the solver cannot reach that time. An impulse ends the slip,
    and the simulation continues. The energy does not grow.
    """
    values = {"mu": 0.8303383096343177, "rate": 8.012277556112187, "dir": 2.3518396878919012, "off": 0.29623349705594}
    run_pushed("TableOnFour", values, 6.0, 0.12)


def test_friction_that_held_a_foot_down():
    """
    Where it reaches its limit, the table rests on one foot. With the force of sliding the foot would not slide in its direction, while without a force
    it lifts.
    """
    values = {"mu": 1.2851592071741287, "rate": 15.548462004593746, "dir": 0.20220721354621593, "off": 0.015059918198480349}
    instance = fmu.Instance("TableOnSix").initialize(values)
    feet = np.array([place_of_foot(index, 6) for index in range(6)])

    def lowest():
        turn = Rotation.from_quat(instance.get("aq1", "aq2", "aq3", "aq0"))
        return instance.get("az") + turn.apply(feet)[:, 2].min() - 0.02

    for target in [*np.arange(1, 15) * 0.12, 1.7954]:
        instance.step(target - instance.time)
    force, *friction = instance.get("c0.force", "c0.friction.force", "c0.friction.across.force")
    assert abs(lowest()) < 1e-12 and force > 2 and 0.99 * values["mu"] * force < math.hypot(*friction) < values["mu"] * force
    instance.step(0.01)
    assert lowest() > 1e-5 and instance.get("c0.force") == 0
    instance.free()


def test_box_beside_ball():
    """Just before a corner sticks, the direction of its friction is dominated by rounding, which causes no event."""
    values = {"mu": 1.0} | velocities(0.352, -1.12, -1.495, 1.846, 0.157, 0.711) | velocities(1.447, 1.117, -0.632, 1.866, 1.575, -0.805, name="b")
    run("BoxBesideBall", values, 0.5)[0].free()


@pytest.mark.parametrize("mu, rate", [(0.7816400926771664, 5.4822439358445946), (0.8076550635264025, 5.079936982176392), (0.7589413052262478, 7.861414140515888),
                                      (0.9460060144497955, 18.711018659635584)])  # fmt: skip
def test_pushed_cylinder(mu, rate):
    """
    A standing cylinder, on eight points, tips over the edge between two of them when the force's moment about it exceeds the weight's.
    Shortly before, points that carry little begin to slide, in directions that follow from the forces.
    """
    push = np.array([1.0, 0.3])
    edge = np.array([math.cos(math.pi / 8), math.sin(math.pi / 8)])  # the normal of the edge from 0 to 45 degrees
    tips = 2 * 9.81 * 0.06 * math.cos(math.pi / 8) / (0.12 * rate * push @ edge)
    instance = fmu.Instance("PushedCylinder").initialize({"mu": mu, "rate": rate})
    while instance.time < 0.99 * tips - 1e-9:
        instance.step(0.033 * tips)
    assert np.max(np.abs(instance.get("avx", "avy", "avz", "ar1", "ar2", "ar3"))) < 1e-9
    instance.step(0.04 * tips)
    r1, r2 = instance.get("ar1", "ar2")
    assert r2 * edge[0] - r1 * edge[1] > 1e-4
    instance.free()


@pytest.mark.parametrize("mu, rate, direction, height", [(0.36, 30.3, 2.0, 0.058), (0.51, 26.7, 0.9, 0.09), (0.79, 19.2, 5.1, -0.048), (0.2, 5.6, 3.8, -0.094)])
def test_pushed_column(mu, rate, direction, height):
    """The upper box begins to slide where the push reaches mu m g, and then moves by rate t^3/(6 m); the lower one stays."""
    values = {"mu": mu, "rate": rate, "dir": direction, "height": height}
    instance = fmu.Instance("PushedColumn").initialize(values)
    begins = mu * 2 * 9.81 / rate
    instance.step(0.999 * begins)
    assert instance.get("b2x", "b2y", "b2vx", "b2vy") == pytest.approx([0] * 4, abs=1e-12)
    instance.step(0.101 * begins)
    way = rate * (0.1 * begins) ** 3 / (6 * 2)
    places = [way * math.cos(direction), way * math.sin(direction), 0, 0]
    assert instance.get("b2x", "b2y", "b1x", "b1y") == pytest.approx(places, abs=1e-6 * way)
    instance.free()


def test_a_box_slides_over_the_edge_of_another():
    """The lower one tips where the upper one's pressure and friction have more moment about its edge than its weight. Its corners rest until then."""
    mu, rate, direction, height = 0.7234690311686371, 24.84287911740961, 2.16287443893914, -0.09103236486191624
    begins, weight = mu * 2 * 9.81 / rate, 2 * 9.81

    def overhang(time):
        pressed = rate * (time - begins) ** 3 / (6 * 2) + rate * time * height / weight + 0.1 * mu  # ahead of the lower box's centre
        return 2 * 0.2 + math.cos(direction) * (pressed + 0.2 * mu)

    tips = brentq(overhang, begins, 2.0)
    instance = fmu.Instance("PushedColumn").initialize({"mu": mu, "rate": rate, "dir": direction, "height": height}, 1e-8)
    instance.step(tips - 1e-3)
    assert instance.get("b1vx", "b1vz", "b1r2") == pytest.approx([0] * 3, abs=1e-12)
    instance.step(2e-3)
    assert 1e-7 < instance.get("b1vz") < 1e-4
    instance.free()


@pytest.mark.parametrize("mu, spins, slides", [(1.0605673135181113, (-0.33902690883089304, 0.05774454736569212, -0.13192005833572873), -0.5683863809517765),
                                               (0.9337377284522126, (0.16166872080247408, -0.43100676376797753, 0.20280164710971882), 0.28662775767141896)])  # fmt: skip
def test_rocking_column(mu, spins, slides):
    """It comes to rest. Contacts that close as others come to rest have no impact, and frictions that stop with others have no velocity."""
    instance, energies = run("RockingColumn", {"mu": mu, "b3vx": slides} | dict(zip(("b1w", "b2w", "b3w"), spins)), 2.0)
    weights = [instance.get(f"c{k}[1].force") + instance.get(f"c{k}[2].force") for k in (1, 2, 3)]
    assert weights == pytest.approx([3 * 2 * 9.81, 2 * 2 * 9.81, 2 * 9.81], rel=1e-9)
    assert energies[-1] == pytest.approx(2 * 9.81 * sum(instance.get("b1z", "b2z", "b3z")), abs=1e-9)
    instance.free()


@pytest.mark.parametrize("tolerance", [1e-5, 1e-6, 1e-7, 1e-8])
def test_a_box_lands_while_it_creeps(tolerance):
    """The friction of one corner creeps where that of the other one sticks, and stops with it. What rounding leaves has no direction."""
    values = {"mu": 0.37081416067949374, "e": 0.3, "aa": 0.7292743564716355, "avx": -1.397045628314454, "avz": -0.7565318281430371, "aw": -1.1113084408259906}
    instance, energies = run("ThrownInPlane", values, 2.0, tolerance, step=0.05)
    assert energies[-1] == pytest.approx(2 * 9.81 * instance.get("az"), abs=1e-9) and instance.get("az") == pytest.approx(0.1, abs=1e-9)
    instance.free()


def test_a_heap_lands():
    """
    Twelve spheres fall between walls. Their impacts do not end one after another, and those that then come to rest close others.
    Energy is lost, and no two spheres come closer than their radii.
    """
    instance = fmu.Instance("Heap").initialize()
    energy = instance.get("totalEnergy")
    for _ in range(5):
        instance.step(0.1)
        assert instance.get("totalEnergy") <= energy + 1e-9
        energy = instance.get("totalEnergy")
    places = np.array([instance.get(f"x{k}", f"z{k}") for k in range(HEAP)])
    distances = [np.linalg.norm(places[i] - places[k]) for i in range(HEAP) for k in range(i)]
    assert min(distances) >= 0.2 - 1e-9 and places[:, 1].min() >= 0.1 - 1e-9
    assert min(distances) <= 0.2 + 1e-9
    instance.free()


@pytest.mark.parametrize("least, draw, e", [(0.2, 0, 0.5), (0.2, 2, 0), (0.2, 5, 0), (1, 52, 0)])
def test_disks_with_friction(least, draw, e):
    """
    The disks come to lie on each other in few events: bounces below the tolerance are lost, and forces are found. With much friction some jam: an
    impulse ends their slip. The energy does not grow, and no disk is in another one or in a wall.
    """
    draws = np.random.default_rng(draw)
    values = {"mu": draws.uniform(least, 1 if least < 1 else 2), "e": draws.choice([0, 0.5])}
    assert values["e"] == e
    for k in range(DISKS):
        values |= {f"b{k}w": draws.uniform(-5, 5), f"b{k}vx": draws.uniform(-0.5, 0.5)}
    instance, energies = run("Disks", values, 2.0, 1e-4)
    places = np.array([instance.get(f"b{k}x", f"b{k}z") for k in range(DISKS)])
    distances = [np.linalg.norm(places[i] - places[k]) for i in range(DISKS) for k in range(i)]
    assert min(distances) > 0.2 - 1e-7 and places[:, 1].min() > 0.1 - 1e-7 and np.abs(places[:, 0]).max() < 0.25 + 1e-7
    assert instance.fmu.getInteger(instance.vr("events"))[0] < 300
    instance.free()
