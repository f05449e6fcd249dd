"""
Frictions in planes beside constraints and frictions along lines, that hold one load together. Expected values are closed forms, and independent
integrations of the laws by SciPy.
"""

import fmpy
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fmu
from fmu import build_systems

# Forces of the frictions of blocks in a row. A number is that of one in a plane, a text that of one along x.
ROWS = {
    "Two": (3, 3), "OneAlongALine": (3, "3"), "TwoAlongALine": (3, "2", "2"), "LinesBetween": (3, "3", "2", 3), "Ends": (3, None, None, 3),
    "Three": (3, 2, 3, "3"), "LineFirst": ("2", "2", 3, 2), "Four": (2, 3, 2, 2),
}  # fmt: skip
JOINTS = {"slider": "x{1} - x{0} - 1", "rod": "(x{1} - x{0})^2 + (y{1} - y{0})^2 - 1"}
RAMP = 4.0  # N/s


def row(frictions, joint, contacts=False):
    """Blocks of 1 kg in a row along x, each joined to the next one; a growing force along x on the last one."""
    text = '<gravity z="-10"/>'
    for i, force in enumerate(frictions):
        text += f'<coordinate name="x{i}" velocity="v{i}" start="{i}"/><coordinate name="y{i}" velocity="u{i}"/>'
        if contacts:
            text += f'<coordinate name="z{i}" velocity="w{i}"/><particle mass="1" x="x{i}" y="y{i}" z="z{i}"/><contact name="c{i}" gap="z{i}"/>'
        else:
            text += f'<particle mass="1" x="x{i}" y="y{i}"/>'
        if force is not None:
            size = f"{float(force) / 10}*c{i}.force" if contacts else force
            text += f'<friction name="f{i}" velocity="v{i}" {"" if isinstance(force, str) else f"""across="u{i}" """}force="{size}"/>'
        if i > 0:
            text += f'<constraint name="j{i}">{JOINTS[joint].format(i - 1, i)}</constraint>'
    return text + f'<force coordinate="x{len(frictions) - 1}">{RAMP}*time</force>'


# A block with frictions in a plane and along x, which a force along a turning direction moves from rest.
TURNING = """<coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/><particle mass="2" x="x" y="y"/><friction name="f" velocity="vx" across="vy" force="5"/>
  <friction name="g" velocity="vx" force="3"/><force coordinate="x">5.4*time</force><force coordinate="y">1.2*time</force>"""
# A ratchet has another limit backwards, so that its force is not found with the other one's.
RATCHET = """<coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/><particle mass="2" x="x" y="y"/><friction name="f" velocity="vx" across="vy" force="5"/>
  <friction name="g" velocity="vx" force="3" forceBack="6"/><parameter name="rate" start="2"/><force coordinate="x">rate*time</force>"""
# Arms in a horizontal plane, straight or nearly. Masses, lengths, frictions at the ends of the links and in the joints, start, torques by time.
PASSING = ((1.355, 1.568), (0.7821, 0.9102), (2.48, 2.61), (0, 1.91), (0.1495, 0.0128), (3.6207, 0))
FROM_REST = ((1, 1, 1), (1, 1, 1), (0, 2, 2), (0, 0, 0), (0, 0, 0), (0, 20, 0))


def arm(masses, lengths, at_ends, in_joints, start, torques):
    text, x, y, vx, vy = "", "0", "0", "0", "0"
    for i, length in enumerate(lengths):
        angle, rate = "+".join(f"q{k}" for k in range(i + 1)), "+".join(f"w{k}" for k in range(i + 1))
        x, y = f"{x} + {length}*cos({angle})", f"{y} + {length}*sin({angle})"
        vx, vy = f"{vx} - {length}*sin({angle})*({rate})", f"{vy} + {length}*cos({angle})*({rate})"
        text += f'<coordinate name="q{i}" velocity="w{i}" start="{start[i]}"/><particle mass="{masses[i]}" x="{x}" y="{y}"/>'
        text += f'<friction name="end{i}" velocity="{vx}" across="{vy}" force="{at_ends[i]}"/>' if at_ends[i] else ""
        text += f'<friction name="joint{i}" velocity="w{i}" force="{in_joints[i]}"/>' if in_joints[i] else ""
        text += f'<force coordinate="q{i}">{torques[i]}*time</force>' if torques[i] else ""
    return text


# A block on a floor, which a bar holds to one on a slope. The floor's friction is in the plane, and the force is across the bar.
TIED = """<coordinate name="x0" velocity="v0"/><coordinate name="y0" velocity="u0"/><coordinate name="z0" velocity="w0"/>
  <coordinate name="x1" velocity="v1" start="1"/><coordinate name="z1" velocity="w1"/><particle mass="1" x="x0" y="y0" z="z0"/>
  <particle mass="1" x="x1" z="z1"/><gravity z="-10"/><constraint name="bar">x1 - x0 - 1</constraint>
  <contact name="floor" gap="z0"/><contact name="slope" gap="z1 + 0.5*(x1 - 1)"/><friction name="f" velocity="v0" across="u0" force="0.75*floor.force"/>
  <friction name="g" velocity="(v1 - 0.5*w1)/sqrt(1.25)" force="0.3*slope.force"/><force coordinate="y0">8*time</force>"""
SLOPES = """<coordinate name="x0" velocity="v0"/><coordinate name="y0" velocity="u0"/><coordinate name="z0" velocity="w0"/>
  <coordinate name="x1" velocity="v1" start="1"/><coordinate name="y1" velocity="u1"/><coordinate name="z1" velocity="w1"/><gravity z="-10"/>
  <particle mass="1.593" x="x0" y="y0" z="z0"/><particle mass="1.732" x="x1" y="y1" z="z1"/>
  <constraint name="rod">((x0 - x1)^2 + (y0 - y1)^2 + (z0 - z1)^2 - 1)/2</constraint>
  <contact name="floor" gap="z0 - 0.01*x0"/><contact name="slope" gap="z1 + 0.32*(x1 - 1)"/>
  <friction name="f" velocity="(v0 + 0.01*w0)/sqrt(1.0001)" across="u0" force="0.7483*floor.force"/>
  <friction name="g" velocity="(v1 - 0.32*w1)/sqrt(1.1024)" force="0.3*slope.force"/>
  <force coordinate="y0">8.748*sin(2.179*time + 0.5) + 2.081*sin(3.947*time)</force><force coordinate="z0">1.811</force>"""
SYSTEMS = {f"{name}By{joint.title()}": row(frictions, joint) for name, frictions in ROWS.items() for joint in JOINTS}
SYSTEMS |= {f"{name}OnFloor": row(frictions, "slider", True) for name, frictions in ROWS.items()}
ROW_SYSTEMS = list(SYSTEMS)
SYSTEMS |= {"TurningLoad": TURNING, "Ratchet": RATCHET, "PassingArm": arm(*PASSING), "ArmFromRest": arm(*FROM_REST), "Tied": TIED, "Slopes": SLOPES}
KINDS = pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("together", {name: f'<system name="{name}">{text}</system>' for name, text in SYSTEMS.items()})


def at_end(name, variables, kind, tolerance, stop_time):
    rows = fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type=kind, stop_time=stop_time, output_interval=0.1, relative_tolerance=tolerance, output=variables)
    return [rows[variable][-1] for variable in variables]


@KINDS
@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
@pytest.mark.parametrize("name", ROW_SYSTEMS)
def test_a_row_of_blocks_slides_once_all_frictions_yield(kind, tolerance, name):
    """All hold the load together up to the sum of their limits. By least norm one reaches its limit long before."""
    frictions = next(ROWS[row] for row in ROWS if name in (f"{row}OnFloor", *(f"{row}By{joint.title()}" for joint in JOINTS)))
    limit = sum(float(force) for force in frictions if force is not None)
    start, end = limit / RAMP, 3.0
    moved = (RAMP * (end**3 - start**3) / 6 - limit * (end - start) ** 2 / 2 - RAMP * start**2 * (end - start) / 2) / len(frictions)
    error = 1e-6 if kind == "CoSimulation" and tolerance < 1e-5 else 1e-3
    assert at_end(name, ["x0"], kind, tolerance, end)[0] == pytest.approx(max(moved, 0.0), abs=error)


@KINDS
@pytest.mark.parametrize("tolerance", [1e-5, 1e-6, 1e-8])
def test_the_onset_of_slip_has_the_direction_of_the_law(kind, tolerance):
    """Together they hold forces in a disk along a segment. Its normal is the direction of slip, which turns with the load."""
    load = lambda time: np.array([5.4 * time - 3, 1.2 * time])  # noqa: E731
    start = brentq(lambda time: np.hypot(*load(time)) - 5, 0.5, 3.0)
    rates = lambda time, state: [*state[2:], *(load(time) - 5 * state[2:] / np.hypot(*state[2:])) / 2]  # noqa: E731
    expected = solve_ivp(rates, (start, 3.0), [0.0, 0.0, *(1e-9 * load(start))], method="LSODA", rtol=1e-10, atol=1e-13).y[:, -1]
    error = 1e-6 if kind == "CoSimulation" else 50 * tolerance  # CVODE's own error
    assert at_end("TurningLoad", ["x", "y", "vx", "vy"], kind, tolerance, 3.0) == pytest.approx(expected, abs=error)


@pytest.mark.parametrize("rate, limit", [(2.0, 8.0), (-2.0, -11.0)])
def test_a_ratchet_yields_beside_a_friction_in_a_plane(rate, limit):
    instance = fmu.Instance("Ratchet").initialize({"rate": rate}, tolerance=1e-8)
    start = limit / rate
    instance.step(start - 1e-3)
    assert instance.get("vx") == 0.0
    instance.step(7.0 - start + 1e-3)
    assert instance.get("vx") == pytest.approx(rate * (7.0 - start) ** 2 / 4, abs=1e-7)
    instance.free()


def arm_rates(time, state, parts):
    """Lagrange's equations by the Jacobians of the ends of the links; the law |v| is smooth below 1e-8 m/s."""
    masses, lengths, at_ends, in_joints, _, torques = parts
    count = len(masses)
    angles, rates = np.cumsum(state[:count]), np.cumsum(state[count:])
    jacobian, drift, matrix = np.zeros((2, count)), np.zeros(2), np.zeros((count, count))
    force = np.array(torques) * time - np.array(in_joints) * np.sign(state[count:])
    for i in range(count):
        jacobian[:, : i + 1] += lengths[i] * np.array([[-np.sin(angles[i])], [np.cos(angles[i])]])
        drift = drift - lengths[i] * rates[i] ** 2 * np.array([np.cos(angles[i]), np.sin(angles[i])])
        velocity = jacobian @ state[count:]
        force -= jacobian.T @ (masses[i] * drift + at_ends[i] * velocity / np.sqrt(velocity @ velocity + 1e-16))
        matrix += masses[i] * jacobian.T @ jacobian
    return [*state[count:], *np.linalg.solve(matrix, force)]


def follow_arm(name, parts, kind, tolerance, begin, end):
    """States at the end: of the FMU, and by SciPy from those of the FMU at the beginning."""
    names = [f"{letter}{i}" for letter in "qw" for i in range(len(parts[0]))]
    rows = fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type=kind, stop_time=end, output_interval=0.1, relative_tolerance=tolerance, output=names)
    state = lambda time: [rows[name][np.searchsorted(rows["time"], time - 1e-9)] for name in names]  # noqa: E731
    return state(end), solve_ivp(arm_rates, (begin, end), state(begin), method="Radau", rtol=1e-9, atol=1e-12, args=(parts,)).y[:, -1]


@pytest.mark.parametrize("kind, tolerance", [("CoSimulation", 1e-4), ("CoSimulation", 1e-6), ("CoSimulation", 1e-8), ("ModelExchange", 1e-8)])
def test_the_end_of_a_straight_arm_does_not_stop_the_arm(kind, tolerance):
    """At 1.73 s the end passes rest with an arm that is straight to 1e-5, and moves elsewhere. To stop it there would stop all."""
    found, expected = follow_arm("PassingArm", PASSING, kind, tolerance, 1.7, 2.0)
    assert found == pytest.approx(expected, abs=max(1e-6, 100 * tolerance)) and found[2] > 0.05


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_a_straight_arm_leaves_rest(tolerance):
    """Its elbow is free to first order: any torque moves it, while two ends slide slowly along the arm."""
    found, expected = follow_arm("ArmFromRest", FROM_REST, "CoSimulation", tolerance, 0.0, 0.3)
    assert found == pytest.approx(expected, abs=2e-3) and found[4] > 3


@KINDS
@pytest.mark.parametrize("tolerance", [1e-5, 1e-6, 1e-8])
def test_a_bar_between_a_floor_and_a_slope(kind, tolerance):
    """The slope's friction carries its part of the load up to 0.9021 s, where both yield; then both blocks slide."""
    across, along = np.sqrt(1.25), 0.3 * 0.5 / np.sqrt(1.25)
    holds = (0.5 - 0.3 / across) * 10 / (1 + along)  # N along the bar
    start = np.sqrt(7.5**2 - holds**2) / 8

    def rates(time, state):
        direction = state / np.hypot(*state)
        return [(holds - 7.5 * direction[0]) / (2 + 0.05 * holds), 8 * time - 7.5 * direction[1]]

    expected = solve_ivp(rates, (start, 1.0), [1e-9 * holds, 1e-9 * 8 * start], method="LSODA", rtol=1e-10, atol=1e-13).y[:, -1]
    assert at_end("Tied", ["u0", "v0"], kind, tolerance, 0.899) == pytest.approx([0, 0], abs=1e-9)
    assert at_end("Tied", ["v0", "u0"], kind, tolerance, 1.0) == pytest.approx(expected, abs=1e-5 if kind == "CoSimulation" else 1e-3)


def slope_rates(time, state):
    """Blocks on two slopes that a rod joins: accelerations, contact and rod forces of one linear system. The law |v| is smooth below 1e-6 m/s."""
    place, velocity = state[:6], state[6:]
    distance, passing = place[:3] - place[3:], velocity[:3] - velocity[3:]
    jacobian = np.array([[-0.01, 0, 1, 0, 0, 0], [0, 0, 0, 0.32, 0, 1], [*distance, *-distance]])
    along, down = np.array([1, 0, 0.01]) / np.sqrt(1.0001), np.array([1, 0, -0.32]) / np.sqrt(1.1024)
    plane, line = np.array([along @ velocity[:3], velocity[1]]), down @ velocity[3:]
    plane, line = plane / np.sqrt(plane @ plane + 1e-12), line / np.sqrt(line**2 + 1e-12)
    forces = jacobian.T.copy()
    forces[:3, 0] -= 0.7483 * (along * plane[0] + np.array([0, plane[1], 0]))
    forces[3:, 1] -= 0.3 * down * line
    load = [0, 8.748 * np.sin(2.179 * time + 0.5) + 2.081 * np.sin(3.947 * time), 1.811 - 15.93, 0, 0, -17.32]
    matrix = np.block([[np.diag([1.593] * 3 + [1.732] * 3), -forces], [jacobian, np.zeros((3, 3))]])
    return [*velocity, *np.linalg.solve(matrix, [*load, 0, 0, -passing @ passing])[:6]]


def test_blocks_on_two_slopes():
    """The floor's friction yields beside that of the slope, whose contact has a part of the load; then all stops. The reference creeps by 1 %."""
    expected = solve_ivp(slope_rates, (0.0, 1.0), [0.0, 0, 0, 1, 0, 0, *[0.0] * 6], method="Radau", rtol=1e-7, atol=1e-11).y[:2, -1]
    for kind, tolerance in [("CoSimulation", 1e-6), ("CoSimulation", 1e-8), ("ModelExchange", 1e-6)]:
        assert at_end("Slopes", ["x0", "y0"], kind, tolerance, 1.0) == pytest.approx(expected, rel=0.03)
