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
# An arm of two links in a horizontal plane with frictions at both ends, in planes, and in the second joint. It passes the straight position as its end stops.
FIRST, SECOND = (1.355, 0.7821, 2.48), (1.568, 0.9102, 2.61)  # mass, length and friction at its end
JOINT, DRIVE = 1.91, 3.6207
START = (0.1495, 0.0128)
ARM = f"""<coordinate name="q" velocity="w" start="{START[0]}"/><coordinate name="p" velocity="r" start="{START[1]}"/>
  <define name="a">-{FIRST[1]}*sin(q)*w</define><define name="b">{FIRST[1]}*cos(q)*w</define>
  <particle mass="{FIRST[0]}" x="{FIRST[1]}*cos(q)" y="{FIRST[1]}*sin(q)"/><friction name="middle" velocity="a" across="b" force="{FIRST[2]}"/>
  <particle mass="{SECOND[0]}" x="{FIRST[1]}*cos(q) + {SECOND[1]}*cos(q + p)" y="{FIRST[1]}*sin(q) + {SECOND[1]}*sin(q + p)"/>
  <friction name="joint" velocity="r" force="{JOINT}"/>
  <friction name="end" velocity="a - {SECOND[1]}*sin(q + p)*(w + r)" across="b + {SECOND[1]}*cos(q + p)*(w + r)" force="{SECOND[2]}"/>
  <force coordinate="q">{DRIVE}*time</force>"""
SYSTEMS = {f"{name}By{joint.title()}": row(frictions, joint) for name, frictions in ROWS.items() for joint in JOINTS}
SYSTEMS |= {f"{name}OnFloor": row(frictions, "slider", True) for name, frictions in ROWS.items()}
SYSTEMS |= {"TurningLoad": TURNING, "StraightArm": ARM}
KINDS = pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("together", {name: f'<system name="{name}">{text}</system>' for name, text in SYSTEMS.items()})


def at_end(name, variables, kind, tolerance, stop_time):
    rows = fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type=kind, stop_time=stop_time, output_interval=0.1, relative_tolerance=tolerance, output=variables)
    return [rows[variable][-1] for variable in variables]


@KINDS
@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
@pytest.mark.parametrize("name", [name for name in SYSTEMS if name not in ("TurningLoad", "StraightArm")])
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


def arm_rates(time, state):
    """Lagrange's equations of the arm, by the Jacobians of its ends; the law |v| is smooth below 1e-9 m/s."""
    q, p, w, r = state
    (m1, l1, f1), (m2, l2, f2) = FIRST, SECOND
    normal = lambda angle: np.array([-np.sin(angle), np.cos(angle)])  # noqa: E731
    first = np.column_stack([l1 * normal(q), [0, 0]])
    second = np.column_stack([l1 * normal(q) + l2 * normal(q + p), l2 * normal(q + p)])
    drift = -l1 * w**2 * np.array([np.cos(q), np.sin(q)])
    second_drift = drift - l2 * (w + r) ** 2 * np.array([np.cos(q + p), np.sin(q + p)])
    smooth = lambda v: v / np.sqrt(v @ v + 1e-18)  # noqa: E731
    speed = np.array([w, r])
    force = np.array([DRIVE * time, -JOINT * np.sign(r)]) - f1 * first.T @ smooth(first @ speed) - f2 * second.T @ smooth(second @ speed)
    force -= m1 * first.T @ drift + m2 * second.T @ second_drift
    return [w, r, *np.linalg.solve(m1 * first.T @ first + m2 * second.T @ second, force)]


@pytest.mark.parametrize("kind, tolerance", [("CoSimulation", 1e-4), ("CoSimulation", 1e-6), ("CoSimulation", 1e-8), ("ModelExchange", 1e-8)])
def test_the_end_of_a_straight_arm_does_not_stop_the_arm(kind, tolerance):
    """At 1.73 s the end passes rest with an arm that is straight to 1e-5, and moves elsewhere. To stop it there would stop all."""
    rows = fmpy.simulate_fmu(str(fmu.archive("StraightArm")), fmi_type=kind, stop_time=2.0, output_interval=0.1, relative_tolerance=tolerance,
                             output=["q", "p", "w", "r"])  # fmt: skip
    state = lambda time: [rows[name][np.searchsorted(rows["time"], time - 1e-9)] for name in "qpwr"]  # noqa: E731
    expected = solve_ivp(arm_rates, (1.7, 2.0), state(1.7), method="Radau", rtol=1e-9, atol=1e-12).y[:, -1]
    assert state(1.7)[2] > 0.05 and state(2.0) == pytest.approx(expected, abs=max(1e-6, 100 * tolerance))
