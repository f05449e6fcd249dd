"""Forces of redundant constraints along a motion in which the nearly dependent constraint changes, against NumPy's pinv."""

import numpy as np
import pytest
import sympy as sp
from fmpy.fmi2 import FMU2Model

import fmu

# Two constraints suffice for the particle; at p = 0 the first two are identical.
TURNING = """
<system name="Turning">
  <coordinate name="p" velocity="w" velocityStart="0.7" acceleration="0.3"/>
  <coordinate name="x" velocity="vx" start="1"/><coordinate name="y" velocity="vy" start="2"/>
  <particle mass="1.5" x="x" y="y"/>
  <potential>1.5*9.81*y + 2*x</potential>
  <constraint name="c1">x - cos(p)</constraint>
  <constraint name="c2">cos(p)*(x - cos(p)) + sin(p)*(y - 2 - sin(3*p))</constraint>
  <constraint name="c3">y - 2 - sin(3*p)</constraint>
</system>
"""
# The second constraint depends on y too, but weakly.
NEARLY = """
<system name="{name}">
  <coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/><coordinate name="z" velocity="vz"/>
  <particle mass="1.5" x="x" y="y" z="z"/>
  <potential>1.5*9.81*y + 2*x</potential>
  <constraint name="c1">x - sin(z)</constraint>
  <constraint name="c2">x - sin(z) + {hold}*(y - z^2/2)</constraint>
</system>
"""
HOLDS = {"Nearly3": 1e-3, "Nearly5": 1e-5}
# Constraints in units of different scales.
COPIES = f"""
<system name="Copies">
  <coordinate name="x" velocity="vx" start="0.8"/><coordinate name="y" velocity="vy" start="-0.6" velocityStart="1"/>
  <particle mass="1.5" x="x" y="y"/>
  <potential>1.5*9.81*y</potential>
  <constraint name="c[1]">sqrt(x^2 + y^2) - 1</constraint><constraint name="c[2]">1e3*(sqrt(x^2 + y^2) - 1)</constraint>
  <constraint name="c[3]">1e-3*(sqrt(x^2 + y^2) - 1)</constraint><constraint name="c[4]">7*(1 - sqrt(x^2 + y^2))</constraint>
</system>
"""
SCALES = np.array([1, 1e3, 1e-3, -7])

# Three free bodies with four revolute joints of five constraints each, three of which are redundant.
LENGTHS, GROUND, MASSES = (0.7, 1.8, 1.5), 2.0, (1.5, 2.0, 2.5)
JOINTS = {"O": (None, 0), "A": (0, 1), "B": (1, 2), "C": (2, None)}
STATES = [f"{letter}{i}" for i in range(3) for letter in "xyzabc"]
FORCES = [f"{joint}_{kind}" for joint in JOINTS for kind in ("x", "y", "z", "t1", "t2")]


def four_bar():
    diagonal = np.array([GROUND, 0]) - LENGTHS[0] * np.array([np.cos(0.9), np.sin(0.9)])
    d = np.hypot(*diagonal)
    coupler = np.arctan2(diagonal[1], diagonal[0]) + np.arccos((LENGTHS[1] ** 2 + d**2 - LENGTHS[2] ** 2) / (2 * LENGTHS[1] * d))
    angles, parts, tip = [0.9, coupler], [], np.zeros(2)
    rest = diagonal - LENGTHS[1] * np.array([np.cos(coupler), np.sin(coupler)])
    for i, angle in enumerate([*angles, np.arctan2(rest[1], rest[0])]):
        along = LENGTHS[i] * np.array([np.cos(angle), np.sin(angle)])
        start = dict(zip("xyzabc", [*(tip + along / 2), 0, angle, 0, 0]))
        tip = tip + along
        parts += [f'<coordinate name="{c}{i}" velocity="v{c}{i}" start="{start[c]}" velocityStart="{4 if c + str(i) == "a0" else 0}"/>' for c in start]
        parts.append(f'<frame name="b{i}"><translate x="x{i}" y="y{i}" z="z{i}"/><rotate axis="z" angle="a{i}"/>')
        parts.append(f'<rotate axis="x" angle="b{i}"/><rotate axis="y" angle="c{i}"/></frame>')
        parts.append(f'<body name="bar{i}" in="b{i}" mass="{MASSES[i]}" Ixx="0.01" Iyy="0.1" Izz="0.12"/>')
        parts += [f'<point name="{end}{i}" in="b{i}" x="{sign}{LENGTHS[i] / 2}"/>' for end, sign in (("P", "-"), ("Q", ""))]
    for joint, (i, j) in JOINTS.items():
        for axis in "xyz":
            far = f"P{j}.{axis}" if j is not None else str(GROUND if axis == "x" else 0)
            parts.append(f'<constraint name="{joint}_{axis}">{f"Q{i}.{axis}" if i is not None else 0} - {far}</constraint>')
        for k in (1, 2):
            products = "+".join(f"b{i}.R{r}{k}*b{j}.R{r}3" for r in (1, 2, 3)) if None not in (i, j) else ""
            parts.append(f'<constraint name="{joint}_t{k}">{products or f"b{j if i is None else i}.R{k}3"}</constraint>')
    parts += [f'<output name="F_{name}">{name}.force</output>' for name in FORCES]
    return '<system name="FourBarInSpace">' + "\n".join(parts) + '<gravity y="-9.81" z="-3"/></system>'


SYSTEMS = {"Turning": TURNING, "Copies": COPIES, "FourBarInSpace": four_bar()}
SYSTEMS |= {name: NEARLY.format(name=name, hold=hold) for name, hold in HOLDS.items()}


@pytest.fixture(scope="module", autouse=True)
def built():
    fmu.build_systems("redundant-motions", SYSTEMS)


def assert_near(forces, jacobian, load, tolerance, share=1e-15):
    """Compare forces with those of least norm that satisfy J^T F = load."""
    expected = np.linalg.pinv(jacobian.T, rcond=share) @ load
    assert np.max(np.abs(forces - expected)) < tolerance * np.max(np.abs(expected)), (forces, expected)


def test_the_dependent_constraint_changes(open_fmu):
    """Forces are right however near p is to the angle at which the first two constraints are identical."""
    near = 10.0 ** np.linspace(-17, 0, 400)
    instance, names = open_fmu("Turning", kind=FMU2Model), ("p", "x", "y", "w", "vx", "vy")
    w = 0.7
    for p in [0.0, *near, *-near, *np.linspace(-3, 3, 200)]:
        instance.put(zip(names, [p, np.cos(p), 2 + np.sin(3 * p), w, -np.sin(p) * w, 3 * np.cos(3 * p) * w]))
        ax, ay = -np.cos(p) * w**2 - 0.3 * np.sin(p), -9 * np.sin(3 * p) * w**2 + 0.9 * np.cos(3 * p)
        jacobian = np.array([[1, 0], [np.cos(p), np.sin(p)], [0, 1]])
        # A constraint that differs from a combination of others by less than 1e-6 counts as dependent.
        tolerance = 2e-9 if abs(p) > 1e-6 else max(abs(p), 1e-13)
        assert_near(instance.get("c1.force", "c2.force", "c3.force"), jacobian, np.array([-2 - 1.5 * ax, -14.715 - 1.5 * ay]), tolerance)


@pytest.mark.parametrize("name", HOLDS)
def test_nearly_dependent_constraints(name, open_fmu):
    instance = open_fmu(name).initialize({"z": 0.3, "x": np.sin(0.3), "y": 0.045, "vz": 0.8, "vx": 0.8 * np.cos(0.3), "vy": 0.24})
    for _ in range(50):
        z, vz = instance.get("z", "vz")
        tangent, turn = np.array([np.cos(z), z, 1]), np.array([-np.sin(z) * vz**2, vz**2, 0])
        a = turn + tangent * (tangent @ (np.array([-2, -14.715, 0]) - 1.5 * turn)) / (1.5 * tangent @ tangent)
        jacobian = np.array([[1, 0, -np.cos(z)], [1, HOLDS[name], -np.cos(z) - HOLDS[name] * z]])
        assert_near(instance.get("c1.force", "c2.force"), jacobian, np.array([-2, -14.715, 0]) - 1.5 * a, 1e-8)
        instance.step(0.02)


def test_copies_in_other_units(open_fmu):
    instance = open_fmu("Copies").initialize()
    for _ in range(200):
        x, y, ax, ay, *forces = instance.get("x", "y", "der(vx)", "der(vy)", *(f"c[{i}].force" for i in range(1, 5)))
        assert_near(forces, np.outer(SCALES, [x, y]), -1.5 * np.array([ax, ay + 9.81]), 1e-12, 1e-9)
        instance.step(0.01)


@pytest.fixture(scope="module")
def jacobian_in_space():
    q = sp.symbols(STATES)
    bodies = [q[6 * i : 6 * i + 6] for i in range(3)]
    rotations = [sp.rot_ccw_axis3(b[3]) * sp.rot_ccw_axis1(b[4]) * sp.rot_ccw_axis2(b[5]) for b in bodies]
    ends = [[sp.Matrix(b[:3]) + sign * R[:, 0] * l / 2 for sign in (-1, 1)] for b, R, l in zip(bodies, rotations, LENGTHS)]
    rows = []
    for i, j in JOINTS.values():
        near, far = ends[i][1] if i is not None else sp.zeros(3, 1), ends[j][0] if j is not None else sp.Matrix([GROUND, 0, 0])
        rows += [*(near - far)]
        axes = rotations[i].T * rotations[j][:, 2] if None not in (i, j) else rotations[j if i is None else i][:, 2]
        rows += [*axes[:2]]
    return sp.lambdify(q, sp.Matrix(rows).jacobian(q))


def test_linkage_in_space(jacobian_in_space, open_fmu):
    """Forces at 1000 points, and their time derivatives by directional derivatives and by output derivatives."""
    instance = open_fmu("FourBarInSpace").initialize(tolerance=1e-11)
    assert sum("is redundant" in text for _, _, text in instance.messages) == 3
    outputs = instance.vr(*(f"F_{name}" for name in FORCES))
    states = [*STATES, *(f"v{name}" for name in STATES)]
    all_forces, rates, others = [], [], []
    for k in range(1000):
        load = np.zeros(18)
        for i, m in enumerate(MASSES):
            ax, ay, spin = instance.get(f"der(vx{i})", f"der(vy{i})", f"der(va{i})")
            load[6 * i : 6 * i + 4] = [-m * ax, -m * (ay + 9.81), -3 * m, -0.12 * spin]
        all_forces.append(instance.fmu.getReal(outputs))
        assert_near(all_forces[-1], jacobian_in_space(*instance.get(*STATES)), load, 1e-10, 1e-9)
        if 400 <= k < 410:
            seed = instance.get(*(f"der({name})" for name in states))
            rates.append(instance.fmu.getDirectionalDerivative(outputs, instance.vr(*states), seed))
            others.append(instance.fmu.getRealOutputDerivatives(outputs, [1] * len(outputs)))
        instance.step(0.002)
    forces = np.array(all_forces)
    weights = {3: 1, 2: -9, 1: 45, -1: -45, -2: 9, -3: -1}  # of central differences of order 6
    differences = sum(weight * forces[400 + k : 410 + k] for k, weight in weights.items()) / (60 * 0.002)
    np.testing.assert_allclose(rates, differences, atol=1e-5 * np.max(np.abs(differences)))
    np.testing.assert_allclose(others, rates, atol=1e-8 * np.max(np.abs(rates)))


def turn(axis, angle, rate, acceleration):
    """Rotations about an axis with their first and halved second time derivatives: arrays [3, samples, 3, 3]."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    series = np.zeros((3, len(angle), 3, 3))
    series[0, :, axis, axis] = 1
    c, s = np.cos(angle), np.sin(angle)
    cosine = np.array([c, -s * rate, (-s * acceleration - c * rate**2) / 2])
    sine = np.array([s, c * rate, (c * acceleration - s * rate**2) / 2])
    series[:, :, first, first] = series[:, :, second, second] = cosine
    series[:, :, second, first], series[:, :, first, second] = sine, -sine
    return series


def product(a, b):
    return np.array([sum(a[i] @ b[k - i] for i in range(k + 1)) for k in range(3)])


def bricard(q, v, a):
    """Time series of points, six of a sixth of the mass for each rod, and of the last rod's end and axes. Rods are (axis, direction)."""
    l, w = 1.0, 0.1
    frame, origin, points = np.tile(np.eye(3), (1, len(q), 1, 1)), np.zeros((3, len(q), 3)), []
    frame = np.concatenate([frame, np.zeros((2, len(q), 3, 3))])
    for i, (axis, along) in enumerate([(1, (1, 0, 0)), (2, (0, -1, 0)), (0, (0, 0, 1)), (1, (-1, 0, 0)), (2, (0, 1, 0))]):
        along = np.array(along)
        frame = product(frame, turn(axis, q[:, i], v[:, i], a[:, i]))
        for k in range(3):
            reach = (l if along[k] else w) / 2 * np.eye(3)[k]
            points += [origin + frame @ (along * l / 2 + sign * reach) for sign in (1, -1)]
        origin = origin + frame @ (along * l)
    return np.array(points), np.concatenate([origin, frame[:, :, 1:, 0]], axis=2)


def test_bricard(open_fmu):
    """Forces at all points of the motion agree with Newton's law for particles equivalent to the rods."""
    q, v, a = ([f"{name}[{i}]{end}" for i in range(1, 6)] for name, end in (("q", ""), ("v", ""), ("der(v", ")")))
    names = [f"{name}.force" for name in ("closeX", "closeY", "closeZ", "axisY", "axisZ")]
    rows = np.array(open_fmu("Bricard").initialize().run(10, 0.01, *q, *v, *a, *names))[:, 1:]
    q, v, a, forces = np.split(rows, 4, axis=1)
    accelerations = 2 * bricard(q, v, a)[0][:, 2] + [0, 9.81, 0]
    along = [bricard(q, np.tile(unit, (len(q), 1)), 0 * a) for unit in np.eye(5)]
    load = np.array([-np.sum(points[:, 1] * accelerations, axis=(0, 2)) / 6 for points, _ in along]).T
    jacobians = np.array([constraints[1] for _, constraints in along]).transpose(1, 2, 0)
    for sample in zip(forces, jacobians, load):
        assert_near(*sample, 1e-9, 1e-9)
