"""Impacts with friction, forces of sliding contacts, and bounces until rest: NumPy, SciPy and closed forms."""

import itertools

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from scipy.integrate import solve_ivp
from scipy.optimize import nnls

from fmu import DISCARD, ERROR, build_systems
from test_switching import events, to

G = 9.81
SIZE, CONTACTS = 8, 4  # coordinates and contacts of the random systems


def random_system(name, order):
    """A system whose mass matrix, forces, gaps and frictions are parameters; `order` is the order of the elements."""
    every = [(i, k) for i in range(SIZE) for k in range(SIZE)]
    pairs = [(i, k) for i, k in every if i <= k]
    lines = [f'<parameter name="m{i}{k}" start="{int(i == k)}"/>' for i, k in pairs]
    lines += [f'<parameter name="f{i}" start="0"/>' for i in range(SIZE)]
    for c in range(CONTACTS):
        lines += [f'<parameter name="{p}{c}" start="0"/>' for p in ("gap", "e", "mu")]
        lines += [f'<parameter name="{p}{c}{i}" start="{int(i == (2 * c + (p == "t")))}"/>' for p in "nt" for i in range(SIZE)]
    lines += [f'<coordinate name="q{i}" velocity="v{i}"/>' for i in range(SIZE)]
    kinetic = " + ".join(f"{1 if i != k else 0.5}*m{i}{k}*v{i}*v{k}" for i, k in pairs)
    lines.append(f"<kinetic>{kinetic}</kinetic>")
    lines += [f'<force coordinate="q{i}">f{i}</force>' for i in range(SIZE)]
    for c in order:
        row = lambda p, q: " + ".join(f"{p}{c}{i}*{q}{i}" for i in range(SIZE))
        lines.append(f'<contact name="c{c}" gap="gap{c} + {row("n", "q")}" restitution="e{c}"/>')
        lines.append(f'<friction name="r{c}" velocity="{row("t", "v")}" force="mu{c}*c{c}.force"/>')
    text = "\n  ".join(lines)
    return f'<system name="{name}" description="Random contacts with friction">\n  {text}\n  <experiment stopTime="1"/>\n</system>'


def balls(name, order):
    contacts = {
        (i, k): f'<contact name="touch{i}{k}" gap="sqrt((x[{k}] - x[{i}])^2 + (y[{k}] - y[{i}])^2) - 1" restitution="e"/>'
        for i, k in ((1, 2), (1, 3), (2, 3))
    }
    return f"""<system name="{name}" description="A ball that hits two others">
  <parameter name="e" start="1"/>
  <for index="i" from="1" to="3">
    <coordinate name="x[i]" velocity="vx[i]"/><coordinate name="y[i]" velocity="vy[i]"/>
    <particle mass="1" x="x[i]" y="y[i]"/>
  </for>
  {"".join(contacts[pair] for pair in order)}
  <experiment stopTime="2"/>
</system>"""


ROD = """<system name="PainleveRod" description="Uniform rod that slides on its tip">
  <parameter name="mu" start="2"/><parameter name="e" start="0"/><parameter name="theta0" start="1.2"/><parameter name="rise" start="0"/>
  <coordinate name="x" velocity="vx" velocityStart="-1"/>
  <coordinate name="y" velocity="vy" start="sin(theta0)"/>
  <coordinate name="theta" velocity="w" start="theta0"/>
  <body mass="1" x="x" y="y" inertia="1/3" angle="theta"/>
  <potential>9.81*y</potential>
  <contact name="tip" gap="y - sin(theta)" restitution="e"/>
  <friction name="rub" velocity="vx + sin(theta)*w" force="(mu + rise*time)*tip.force"/>
  <experiment stopTime="1"/>
</system>"""

# The rod on two tips side by side, on which the friction grows at once. It may roll and yaw.
TIPS = """<system name="RodOnTips" description="Uniform rod that slides on two tips">
  <parameter name="theta0" start="1.2"/><parameter name="later" start="2"/><mode name="mu" start="0.1"/>
  <coordinate name="x" velocity="vx" velocityStart="-1"/>
  <coordinate name="y" velocity="vy" start="sin(theta0)"/>
  <coordinate name="theta" velocity="w" start="theta0"/>
  <coordinate name="roll" velocity="wr"/><coordinate name="yaw" velocity="wy"/>
  <body mass="1" x="x" y="y" inertia="1/3" angle="theta"/>
  <kinetic>0.1*wr^2 + 0.1*wy^2</kinetic>
  <potential>9.81*y</potential>
  <contact name="left" gap="y - sin(theta) + 0.1*roll" restitution="0"/>
  <contact name="right" gap="y - sin(theta) - 0.1*roll" restitution="0"/>
  <friction name="rubLeft" velocity="vx + sin(theta)*w + 0.1*wy" force="mu*left.force"/>
  <friction name="rubRight" velocity="vx + sin(theta)*w - 0.1*wy" force="mu*right.force"/>
  <event when="time &gt; 0.001"><set mode="mu">later</set></event>
  <experiment stopTime="1"/>
</system>"""

# A plate on two tips in space, on which the friction grows at once.
PLATE = """<system name="PlateOnTips" description="Inclined plate that slides on two tips">
  <coordinate name="x" velocity="vx" velocityStart="-2.4"/><coordinate name="y" velocity="vy" velocityStart="0.03"/>
  <coordinate name="z" velocity="vz" start="sin(1.3)"/>
  <coordinate name="yaw" velocity="wy"/><coordinate name="pitch" velocity="wp" start="-1.3"/><coordinate name="roll" velocity="wr"/>
  <frame name="plate"><translate x="x" y="y" z="z"/><rotate axis="z" angle="yaw"/><rotate axis="y" angle="pitch"/><rotate axis="x" angle="roll"/></frame>
  <body name="body" in="plate" mass="1" Ixx="0.1" Iyy="1/3" Izz="1/3 + 0.1"/><gravity z="-9.81"/>
  <mode name="mu" start="0.05"/><event when="time &gt; 0.01"><set mode="mu">1.7</set></event>
  <point name="left" in="plate" x="-1" y="0.06"/><contact name="a" gap="left.z"/>
  <friction name="ra" velocity="left.vx" across="left.vy" force="mu*a.force"/>
  <point name="right" in="plate" x="-1" y="-0.06"/><contact name="b" gap="right.z"/>
  <friction name="rb" velocity="right.vx" across="right.vy" force="mu*b.force"/>
  <output name="slipA">left.vx</output><output name="slipB">right.vx</output><output name="riseB">der(right.z)</output>
  <experiment stopTime="1"/>
</system>"""

WEDGE = """<system name="Wedge" description="Ball that falls into a wedge of 60 degrees">
  <parameter name="e" start="0.8"/><parameter name="mu" start="0"/><parameter name="r" start="0.1"/>
  <coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy" start="1"/><coordinate name="phi" velocity="w"/>
  <body mass="1" x="x" y="y" inertia="0.4*r^2" angle="phi"/>
  <potential>9.81*y</potential>
  <contact name="left" gap="y*sin(pi/6) + x*cos(pi/6)" restitution="e"/>
  <contact name="right" gap="y*sin(pi/6) - x*cos(pi/6)" restitution="e"/>
  <friction name="rubLeft" velocity="vx*sin(pi/6) - vy*cos(pi/6) + r*w" force="mu*left.force"/>
  <friction name="rubRight" velocity="vx*sin(pi/6) + vy*cos(pi/6) + r*w" force="mu*right.force"/>
  <experiment stopTime="2"/>
</system>"""

BLOCK = """<system name="RockingBlock" description="Slender block that rocks on two corners with friction">
  <parameter name="b" start="0.1"/><parameter name="h" start="0.5"/><parameter name="mu" start="1"/>
  <parameter name="theta0" start="0.1"/>
  <coordinate name="x" velocity="vx"/>
  <coordinate name="y" velocity="vy" start="h*cos(theta0) + b*abs(sin(theta0))"/>
  <coordinate name="theta" velocity="w" start="theta0"/>
  <body mass="1" x="x" y="y" inertia="(b^2 + h^2)/3" angle="theta"/>
  <potential>9.81*y</potential>
  <contact name="left" gap="y - b*sin(theta) - h*cos(theta)"/>
  <contact name="right" gap="y + b*sin(theta) - h*cos(theta)"/>
  <friction name="leftFoot" velocity="vx + (h*cos(theta) + b*sin(theta))*w" force="mu*left.force"/>
  <friction name="rightFoot" velocity="vx + (h*cos(theta) - b*sin(theta))*w" force="mu*right.force"/>
  <experiment stopTime="3"/>
</system>"""

LANDING = """<system name="FlatLanding" description="Body that lands flat on five feet with friction">
  <parameter name="mu" start="1"/><parameter name="h" start="0.5"/>
  <coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy" start="h"/><coordinate name="theta" velocity="w"/>
  <body mass="1" x="x" y="y" inertia="0.3" angle="theta"/>
  <potential>9.81*y</potential>
  <for index="i" from="1" to="5">
    <contact name="foot[i]" gap="y + (i - 3)/2*sin(theta) - h*cos(theta)"/>
    <friction name="rub[i]" velocity="vx + (h*cos(theta) + (i - 3)/2*sin(theta))*w" force="mu*foot[i].force"/>
  </for>
  <experiment stopTime="1"/>
</system>"""

INCLINE = """<system name="BallOnIncline" description="Ball that bounces down an incline with friction">
  <parameter name="e" start="0.97"/><parameter name="mu" start="0.3"/><parameter name="a" start="0.2"/>
  <coordinate name="s" velocity="vs"/><coordinate name="h" velocity="vh" start="0.1"/><coordinate name="phi" velocity="w"/>
  <body mass="1" x="s" y="h" inertia="0.4*0.01" angle="phi"/>
  <potential>9.81*(h*cos(a) - s*sin(a))</potential>
  <contact name="plane" gap="h" restitution="e"/>
  <friction name="rub" velocity="vs + 0.1*w" force="mu*plane.force"/>
  <experiment stopTime="30"/>
</system>"""

TOWER = """<system name="BallOnBall" description="Two balls on top of each other that bounce on the ground">
  <parameter name="e" start="0.97"/>
  <coordinate name="a" velocity="va" start="0.1"/><coordinate name="b" velocity="vb" start="0.3"/>
  <particle mass="1" y="a"/><particle mass="1" y="b"/><potential>9.81*(a + b)</potential>
  <stop coordinate="a" min="0" restitution="e"/>
  <contact name="touch" gap="b - a - 0.1" restitution="e"/>
  <experiment stopTime="30"/>
</system>"""


def sledge(name, n):
    """n masses of 1 kg that slide with a sledge of 10 kg, each down its own slope: the friction of each presses all others."""
    parts = "".join(
        f'<coordinate name="z{i}" velocity="w{i}" velocityStart="-0.5"/><particle mass="1" y="z{i}"/><contact name="c{i}" gap="z{i} + 0.5*x"/>'
        for i in range(n)
    )
    return f"""<system name="{name}" description="Masses that a sledge slides on"><parameter name="mu" start="1"/><parameter name="pull" start="0"/>
      <coordinate name="x" velocity="v" velocityStart="1"/><particle mass="10" x="x"/><force coordinate="x">pull</force><gravity y="-9.81"/>{parts}
      <friction name="rub" velocity="v" force="mu*({"+".join(f"c{i}.force" for i in range(n))})"/><experiment stopTime="1"/></system>"""


PAIRS = [(1, 2), (1, 3), (2, 3)]
SYSTEMS = {
    "RandomContacts": random_system("RandomContacts", [0, 1, 2, 3]),
    "RandomContactsTurned": random_system("RandomContactsTurned", [2, 3, 1, 0]),
    "ThreeBalls": balls("ThreeBalls", PAIRS),
    "ThreeBallsTurned": balls("ThreeBallsTurned", PAIRS[::-1]),
    "PainleveRod": ROD,
    "RodOnTips": TIPS,
    "PlateOnTips": PLATE,
    "Wedge": WEDGE,
    "RockingBlock": BLOCK,
    "FlatLanding": LANDING,
    "BallOnIncline": INCLINE,
    "BallOnBall": TOWER,
    "Masses14": sledge("Masses14", 14),
}


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("impacts", SYSTEMS)


# --- Random contacts with friction ---


class Contacts:
    """Random values of such a system; distant contacts are inactive."""

    def __init__(self, rng, largest_mu=3.0):
        self.count = rng.integers(1, CONTACTS + 1)
        a = rng.normal(size=(SIZE, SIZE))
        self.mass = a @ a.T + 10 ** rng.uniform(-3, 0) * np.eye(SIZE)
        self.n, self.t = rng.normal(size=(2, CONTACTS, SIZE))
        self.force = rng.normal(size=SIZE)
        self.v = rng.normal(size=SIZE)
        self.e = rng.uniform(0, 1, CONTACTS) if rng.random() < 0.5 else np.full(CONTACTS, rng.choice([0.0, 1.0, 0.7]))
        self.mu = rng.uniform(0, largest_mu, CONTACTS)
        self.gap = np.where(np.arange(CONTACTS) < self.count, 0.0, 100.0)

    def rows(self):
        return np.vstack([self.n[: self.count], self.t[: self.count]])

    def values(self):
        numbers = {"gap": self.gap, "e": self.e, "mu": self.mu, "f": self.force, "v": self.v}
        values = {f"{p}{i}": x for p, xs in numbers.items() for i, x in enumerate(xs)}
        for p, matrix in (("m", self.mass), ("n", self.n), ("t", self.t)):
            values |= {f"{p}{i}{k}": matrix[i, k] for i in range(len(matrix)) for k in range(SIZE) if p != "m" or k >= i}
        return values

    def start(self, instance):
        instance.reset().initialize(self.values())
        return np.array(instance.get(*[f"v{i}" for i in range(SIZE)]))


def test_impacts_without_restitution_project_the_velocities(open_fmu):
    """Moreau: without friction, a plastic impact of all touching contacts projects the velocities onto J v >= 0 in the metric of M."""
    instance, rng = open_fmu("RandomContacts"), np.random.default_rng(5)
    struck = []
    for _ in range(100):
        case = Contacts(rng, largest_mu=0.0)
        case.force[:], case.e[:] = 0.0, 0.0
        root = np.linalg.cholesky(case.mass)
        effects = np.linalg.solve(root, case.n[: case.count].T)
        impulse = nnls(effects, -root.T @ case.v)[0]
        projected = case.v + np.linalg.solve(root.T, effects @ impulse)
        size = np.sqrt(case.v @ case.mass @ case.v)
        assert root.T @ case.start(instance) == pytest.approx(root.T @ projected, abs=1e-9 * size)
        struck.append(np.sum(impulse > 0))
    assert min(struck) == 0 and max(struck) == CONTACTS


@pytest.mark.parametrize("tied", [False, True])
def test_random_impacts_obey_their_law(open_fmu, tied):
    """
    Impacts one by one, or all at once, obey Newton's law of restitution with at most the given coefficient, and Coulomb's law. The message
    about other outcomes appears where there are some, with few exceptions.
    """
    instance, other = open_fmu("RandomContacts"), open_fmu("RandomContactsTurned", logging=False)
    rng = np.random.default_rng(tied)
    lessened = rotated = several = warned = 0
    for _ in range(400):
        case = Contacts(rng)
        case.force[:] = 0.0  # without external forces, velocities stay as the impact leaves them
        k = case.count
        if tied:
            case.v += np.linalg.pinv(case.n[:k]) @ (-1.0 - case.n[:k] @ case.v)
        v = case.start(instance)
        inverse = np.linalg.inv(case.mass)
        rows, size = case.rows(), np.sqrt(case.v @ case.mass @ case.v)
        impulse = np.linalg.lstsq(rows.T, case.mass @ (v - case.v), rcond=None)[0]
        assert np.allclose(rows.T @ impulse, case.mass @ (v - case.v), atol=1e-9 * size * np.sqrt(np.linalg.norm(case.mass)))
        unit = np.sqrt(np.diag(rows @ inverse @ rows.T))
        normal, along = np.split(impulse, 2)
        tiny = 1e-9 * size / unit
        assert np.all(normal >= -tiny[:k])
        assert np.all(abs(along) <= case.mu[:k] * normal + tiny[k:] + case.mu[:k] * tiny[:k])
        assert v @ case.mass @ v <= size**2 * (1 + 1e-11)
        rates = case.n[:k] @ v
        assert np.all(rates >= -1e-9 * size * unit[:k])
        if tied:
            share = [1.0]
            slip, limit = case.t[:k] @ v, case.mu[:k] * normal
            pressed = normal > 1e-6 * size / unit[:k]
            slides = pressed & (abs(slip) > 1e-9 * size * unit[k:])
            assert np.all(abs(along + np.sign(slip) * limit)[slides] <= 1e-8 * size / unit[k:][slides] * (1 + case.mu[:k][slides]))
            if np.all(case.e[:k] > 0.01) and pressed.any():
                share = rates[pressed] / case.e[:k][pressed]
                assert np.ptp(share) <= 1e-6 * max(1.0, size * unit.max()) and share[0] <= 1 + 1e-7
            if share[0] < 1 - 1e-6:
                lessened += 1
                gains = [gain for gain, _ in impacts_by_trial(case)]
                assert len(gains) > 1 or np.all(np.array(gains) > 0)
                assert k > 1 or v @ case.mass @ v >= size**2 * (1 - 1e-7)  # restitution is reduced no more than energy requires
            else:
                outcomes = [motion for gain, motion in impacts_by_trial(case) if gain <= 1e-12 * size**2]
                has_others = any(not np.allclose(motion, v, atol=1e-6 * size) for motion in outcomes)
                several += has_others
                warns = any("has more than one solution" in text for _, _, text in instance.messages)
                assert has_others or not warns
                warned += warns
        instance.messages.clear()
        swapped = case.start(other)
        rotated += np.allclose(v, swapped, atol=1e-8 * abs(v).max())
    assert rotated == 400
    assert (lessened > 10 and several > 10) or not tied
    assert warned >= 0.9 * several


def impacts_by_trial(case):
    """All solutions without reduced restitution, by trying all modes: twice the energy gained, and the motion."""
    k, found = case.count, []
    w = case.rows() @ np.linalg.inv(case.mass) @ case.rows().T
    before = case.rows() @ case.v
    target = -case.e[:k] * before[:k]
    for modes in itertools.product(("open", "sticks", 1, -1), repeat=k):
        a, b = np.zeros((2 * k, 2 * k)), np.zeros(2 * k)
        for i, mode in enumerate(modes):
            if mode == "open":
                a[i, i] = a[k + i, k + i] = 1.0
                continue
            a[i], b[i] = w[i], target[i] - before[i]
            if mode == "sticks":
                a[k + i], b[k + i] = w[k + i], -before[k + i]
            else:
                a[k + i, k + i], a[k + i, i] = 1.0, mode * case.mu[i]
        z = np.linalg.solve(a, b)
        after = before + w @ z
        fits = np.all(z[:k] >= -1e-10) and np.all(abs(z[k:]) <= case.mu[:k] * z[:k] + 1e-10) and np.all(after[:k] >= target - 1e-10)
        if fits and all(after[k + i] * mode >= 0 for i, mode in enumerate(modes) if mode in (1, -1)):
            found.append((z @ (before + after), case.v + np.linalg.solve(case.mass, case.rows().T @ z)))
    return found


def motions(free, s):
    """All accelerations of the gaps, and forces, for which each contact either presses or separates, by trying each combination."""
    found = []
    for closed in itertools.product([False, True], repeat=len(free)):
        closed = np.array(closed)
        force = np.zeros(len(free))
        force[closed] = np.linalg.solve(s[np.ix_(closed, closed)], -free[closed])
        rate = free + s @ force
        if np.all(force >= -1e-12) and np.all(rate[~closed] >= -1e-12):
            found.append(force)
    return found


def test_forces_of_sliding_contacts_are_found_where_there_are_any(open_fmu):
    """The trial of all combinations knows all of them. Where there are several, compliance leads to one. Few are missed."""
    instance, other = open_fmu("RandomContacts"), open_fmu("RandomContactsTurned", logging=False)
    rng = np.random.default_rng(3)
    counts, missed, warned = {0: 0, 1: 0, 2: 0}, 0, 0
    for _ in range(500):
        case = Contacts(rng, 2.0)
        k = case.count
        for _ in range(3):
            case.v -= np.linalg.pinv(case.n[:k]) @ (case.n[:k] @ case.v)
        inverse = np.linalg.inv(case.mass)
        directions = case.n[:k].T - case.t[:k].T * (np.sign(case.t[:k] @ case.v) * case.mu[:k])
        s, free = case.n[:k] @ inverse @ directions, case.n[:k] @ inverse @ case.force
        found = motions(free, s)
        counts[min(len(found), 2)] += 1
        try:
            case.start(instance)
        except FMICallException as error:
            assert error.status == ERROR
            missed += len(found) > 0
            assert len(found) > 0 or any("no force of the contact 'c" in text and "friction 'r" in text for _, _, text in instance.messages)
            instance.messages.clear()
            continue
        forces = instance.get(*[f"c{i}.force" for i in range(k)])
        assert any(forces == pytest.approx(solution, rel=1e-7, abs=1e-9 * abs(solution).max()) for solution in found), found
        warned += reported_other_forces(instance) > 0
        instance.messages.clear()
        case.start(other)
        swapped = other.get(*[f"c{i}.force" for i in range(k)])
        assert any(swapped == pytest.approx(solution, rel=1e-7, abs=1e-9 * abs(solution).max()) for solution in found), found
    assert missed <= 3 and warned > 3, (missed, warned)
    assert min(counts.values()) > 20, counts


# --- Painleve's rod ---


def rod_pressure(theta, mu):
    c, s = np.cos(theta), np.sin(theta)
    return 1 + 3 * c * (c - mu * s)


def test_a_locking_rod_is_an_error(open_fmu):
    assert rod_pressure(1.2, 2) < 0
    instance = open_fmu("PainleveRod")
    with instance.fails(ERROR, "no force of the contact 'tip' is found, .*friction 'rub'.*Painleve"):
        instance.initialize()


def test_a_locking_rod_that_turns_parts(open_fmu):
    """Its tip accelerates upwards. It could also press, but a smaller force would then fall to 0."""
    w, theta = -4.0, 1.2
    instance = open_fmu("PainleveRod").initialize({"w": w, "vy": np.cos(theta) * w})
    assert instance.get("tip.force") == 0
    to(instance, 1e-3)
    assert instance.get("tip.force") == 0
    assert instance.get("y") == pytest.approx(np.sin(theta) + np.cos(theta) * w * 1e-3 - G * 1e-6 / 2, abs=1e-12)


@pytest.mark.parametrize("mu", [2.0, 1.6, 1.3])
def test_a_rod_on_two_tips_stops_by_an_impulse(open_fmu, mu):
    """Sliding has no forces from a friction of 1.376 on. Beyond it an impulse ends the slip; up to it the rod slides on."""
    instance = open_fmu("RodOnTips").initialize({"later": mu}, tolerance=1e-10)
    to(instance, 0.001 - 1e-9)
    theta, vx, vy, w = instance.get("theta", "vx", "vy", "w")
    c, s = np.cos(theta), np.sin(theta)
    slip = vx + s * w
    to(instance, 0.001 + 1e-9)
    if rod_pressure(theta, mu) > 0:
        assert instance.get("vx", "w") == pytest.approx([vx, w], abs=1e-6)
        return
    normal, friction = -np.linalg.solve([[1 + 3 * c**2, -3 * c * s], [-3 * c * s, 1 + 3 * s**2]], [0, slip])
    assert 0 < abs(friction) < mu * normal
    expected = [vx + friction, vy + normal, w + 3 * (s * friction - c * normal)]
    assert instance.get("vx", "vy", "w") == pytest.approx(expected, abs=1e-6)
    assert instance.get("roll", "yaw") == pytest.approx([0, 0], abs=1e-9)
    assert sum("an impulse ends the slip" in text for _, _, text in instance.messages) == 1


@pytest.mark.parametrize("tolerance", [1e-9, 1e-10, 1e-11])
def test_two_impulses_end_the_slip_of_a_plate(open_fmu, tolerance):
    """
    The tip rises by 1e-10 m; at larger tolerances this bounce is lost.
    The first one stops the right tip and leaves the left one at 0.0138 m/s, again without forces. The second one stops that. The right tip then
    rises at 4.6e-5 m/s, and slips at 0.01356 m/s. The values are those of Gauss-Seidel iterations on the law of impulses, with rates after 1e-9 s.
    """
    instance = open_fmu("PlateOnTips").initialize({}, tolerance=tolerance)
    to(instance, 0.01 + 1e-8)
    assert instance.get("slipA") == pytest.approx(0, abs=1e-7)
    assert instance.get("slipB") == pytest.approx(0.01356, abs=5e-6) and instance.get("riseB") == pytest.approx(4.6e-5, abs=5e-7)
    assert instance.get("a.force") > 0 and instance.get("b.force") == 0
    to(instance, 0.1)


def test_a_rod_parts_before_it_locks(open_fmu):
    """p falls from 0.7 to 0, and so does the force (Genot and Brogliato); until then the motion is that of an ODE."""
    mu, theta, w, slip = 1.5, 0.8, 1.0, -30.0

    def rate(t, state):
        theta, w, _ = state
        force = (G - np.sin(theta) * w**2) / rod_pressure(theta, mu)
        return [w, 3 * force * (mu * np.sin(theta) - np.cos(theta)), mu * force]

    locks = lambda t, state: rod_pressure(state[0], mu) - 1e-6
    locks.terminal = True
    path = solve_ivp(rate, (0, 1), [theta, w, slip - np.sin(theta) * w], events=locks, rtol=1e-12, atol=1e-12, dense_output=True)
    start = {"mu": mu, "theta0": theta, "w": w, "vy": np.cos(theta) * w, "vx": slip - np.sin(theta) * w}
    instance = open_fmu("PainleveRod").initialize(start, tolerance=1e-11)
    for share in (0.5, 0.9, 0.99):
        to(instance, share * path.t[-1])
        assert instance.get("theta", "w", "vx") == pytest.approx(path.sol(instance.time), rel=1e-8)
    energy = instance.get("totalEnergy")
    to(instance, 1.1 * path.t[-1])
    assert instance.get("totalEnergy") <= energy and instance.get("tip.force") == 0 and events(instance) == 1
    assert instance.get("y") > np.sin(instance.get("theta"))


@pytest.mark.parametrize("mu, theta, rise, tolerance", [(1.3, 0.9, 100.0, 1e-11), (1.35, 0.85, 3.0, 1e-6), (1.4, 0.9, 3.0, 1e-8)])
def test_a_jamming_rod_is_reported(open_fmu, mu, theta, rise, tolerance):
    """With growing friction p falls to 0 while the rod still presses: the force diverges, and its pole may look like a zero."""
    rate = lambda t, state: [state[1], 3 * (G - np.sin(state[0]) * state[1] ** 2) / rod_pressure(state[0], mu + rise * t) * ((mu + rise * t) * np.sin(state[0]) - np.cos(state[0]))]
    locks = lambda t, state: rod_pressure(state[0], mu + rise * t) - 1e-9
    locks.terminal = True
    path = solve_ivp(rate, (0, 1), [theta, 0], events=locks, rtol=1e-12, atol=1e-12)
    instance = open_fmu("PainleveRod").initialize({"mu": mu, "theta0": theta, "rise": rise, "vx": -30}, tolerance=tolerance)
    with instance.fails(DISCARD, "the friction 'rub' slides and presses the contact 'tip' together ever more .* a jam"):
        instance.step(0.1)
    reported = next(text for _, _, text in instance.messages if "jam" in text)
    assert float(reported.split()[1][:-1]) == pytest.approx(path.t[-1], rel=1e-4)


def reported_other_forces(instance):
    return sum("may have another solution" in text for _, _, text in instance.messages)


def test_many_contacts_that_press_each_other(open_fmu):
    """
    Each force F satisfies F = 9.81 + k n F with k = 0.5 (mu - 0.5)/10, positive up to n k = 1. Beyond that a pull lifts all contacts, or
    all press with forces that a small change lets fall to 0.
    """
    instance = open_fmu("Masses14").initialize({"mu": 1})
    assert instance.get("c0.force", "c13.force") == pytest.approx(2 * [9.81 / (1 - 14 * 0.025)], rel=1e-9)
    assert reported_other_forces(instance) == 0
    instance = open_fmu("Masses14").initialize({"mu": 3.1, "pull": 400})
    for _ in range(3):
        instance.step(0.01)
    assert instance.get("c0.force") == 0
    instance = open_fmu("Masses14")
    with instance.fails(ERROR, "no force of the contact 'c0' is found"):
        instance.initialize({"mu": 3.1})


# --- Ties ---


@pytest.mark.parametrize("name", ["ThreeBalls", "ThreeBallsTurned"])
@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_a_ball_hits_two_at_once(open_fmu, name, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    start = [(-1, 0), (np.sqrt(3) / 2, 0.5), (np.sqrt(3) / 2, -0.5)]
    expected = [(-0.2, 0), (0.6, np.sqrt(3) / 5), (0.6, -np.sqrt(3) / 5)]
    values = {f"{q}[{i + 1}]": x for i, p in enumerate(start) for q, x in zip("xy", turn @ p)}
    v = turn @ (1, 0)
    instance = open_fmu(name).initialize({**values, "vx[1]": v[0], "vy[1]": v[1]})
    instance.step(1.5)
    for i, p in enumerate(expected):
        assert instance.get(f"vx[{i + 1}]", f"vy[{i + 1}]") == pytest.approx(turn @ p, abs=1e-12)


@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_a_ball_falls_into_a_wedge(open_fmu, mu):
    """The ball leaves straight up: it closes both gaps with half its velocity, and friction acts equally on both sides."""
    instance = open_fmu("Wedge").initialize({"mu": mu})
    to(instance, np.sqrt(2 / G) + 0.1)
    speed = np.sqrt(2 * G)
    # normal impulses p along (+-cos 30, sin 30): the ball slides on both walls, since sticking would exceed mu
    assert instance.get("x", "vx", "w") == pytest.approx([0, 0, 0], abs=1e-12)
    assert instance.get("vy") == pytest.approx(0.8 * speed - G * 0.1, rel=1e-12)
    assert events(instance) == 1


# --- Bounces that take long to come to rest ---


@pytest.mark.parametrize("e, steps", [(0.96, 1), (0.96, 2000), (0.99, 1), (0.999, 1)])
def test_long_bounces_end_in_rest(open_fmu, e, steps):
    """The second ball is far above at first; then both are close to each other."""
    instance = open_fmu("BallOnBall").initialize({"e": e, "a": 0.05, "b": 1e9})
    rest = np.sqrt(2 * 0.05 / G) * (1 + e) / (1 - e)
    before = 0.999 * rest
    to(instance, before)
    assert instance.get("a") > 0 or abs(instance.get("va")) > 0
    start = instance.time
    for k in range(1, steps + 1):
        to(instance, start + k / steps * 0.0011 * rest)
    assert instance.get("a", "va") == [0, 0]
    assert events(instance) == pytest.approx(np.log(1e-7) / np.log(e), rel=0.3)


@pytest.mark.parametrize("e", [0.93, 0.97, 0.99])
def test_two_balls_bounce_until_both_rest(open_fmu, e):
    instance = open_fmu("BallOnBall").initialize({"e": e})
    energy = instance.get("totalEnergy")
    for _ in range(60):
        instance.step(1.0)
        assert instance.get("totalEnergy") <= energy + 1e-12
        energy = instance.get("totalEnergy")
    assert instance.get("a", "b", "va", "vb") == pytest.approx([0, 0.1, 0, 0], abs=1e-12)
    assert instance.get("a.min.force") == pytest.approx(2 * G)


def incline(e, mu, a, t):
    """Velocities along an incline, and the spin: impact by impact, then with the friction of rolling or sliding."""
    fall = G * np.cos(a)
    vs = w = now = 0.0
    flight, speed = np.sqrt(2 * 0.1 / fall), np.sqrt(2 * 0.1 * fall)
    while flight > 1e-9:
        if now + flight >= t:
            return vs + G * np.sin(a) * (t - now), w
        now += flight
        vs += G * np.sin(a) * flight
        slip = vs + 0.1 * w
        push = -np.clip(slip / 3.5, -mu * (1 + e) * speed, mu * (1 + e) * speed)
        vs, w = vs + push, w + push * 0.1 / 0.004
        speed *= e
        flight = 2 * speed / fall
    if mu >= 2 / 7 * np.tan(a):  # it rolls in the end: the mean force of many small impacts is that at rest
        slip = vs + 0.1 * w
        rate = G * np.sin(a) - 3.5 * mu * fall
        slides = max(0.0, min(t - now, -slip / rate)) if slip > 0 else 0.0
        vs, w = vs + (G * np.sin(a) - mu * fall) * slides, w - mu * fall * 0.1 / 0.004 * slides
        rest = 5 / 7 * G * np.sin(a) * (t - now - slides)
        return vs + rest, w - rest / 0.1
    return vs + (G * np.sin(a) - mu * fall) * (t - now), w - mu * fall * 0.1 / 0.004 * (t - now)


@pytest.mark.parametrize("mu", [0.02, 0.3])
def test_a_ball_bounces_down_an_incline(open_fmu, mu):
    for e in (0.5, 0.96, 0.99):
        instance = open_fmu("BallOnIncline").initialize({"e": e, "mu": mu})
        for t in (0.5, 3.0, 10.0, 35.0):
            to(instance, t)
            assert instance.get("vs", "w") == pytest.approx(incline(e, mu, 0.2, t), rel=2e-6)
    assert instance.get("h", "vh") == [0, 0]


# --- The rocking block ---


def housner(b, h, theta, count):
    """Times of the changes of corner, and the angular velocities after them, without slipping (Housner)."""
    slender, radius = np.arctan2(b, h), np.hypot(b, h)
    factor = 1 - 1.5 * np.sin(slender) ** 2
    lands = lambda t, y: y[0]
    lands.terminal, lands.direction = True, -1
    now, state, found = 0.0, [theta, 0.0], []
    for _ in range(count):
        path = solve_ivp(lambda t, y: [y[1], -3 * G / (4 * radius) * np.sin(slender - y[0])], (0, 10), state, events=lands, rtol=1e-12, atol=1e-14)
        now += path.t[-1]
        state = [0.0, -factor * path.y[1, -1]]
        found.append((now, state[1]))
    return found


@pytest.mark.parametrize("mu", [1.0, 10.0])
def test_a_block_rocks_by_housner(open_fmu, mu):
    instance = open_fmu("RockingBlock").initialize({"mu": mu}, tolerance=1e-11)
    sign = -1
    for time, speed in housner(0.1, 0.5, 0.1, 12):
        to(instance, time + 1e-8)
        assert instance.get("w") == pytest.approx(sign * speed, abs=2e-7)
        sign = -sign
    to(instance, 15.0)
    assert instance.get("theta", "vx", "vy", "w", "y") == pytest.approx([0, 0, 0, 0, 0.5], abs=1e-12)
    assert instance.get("left.force") + instance.get("right.force") == pytest.approx(G)


def frictionless_block(b, h, theta, times):
    """Angle and velocity of a block on frictionless ground: its centre moves vertically."""
    inertia = (b**2 + h**2) / 3
    now, state, side, found = 0.0, np.array([theta, 0.0]), np.sign(theta), []

    def rate(t, y):
        """y of the centre is side b sin(theta) + h cos(theta); Lagrange's equation for theta alone."""
        first, second = side * b * np.cos(y[0]) - h * np.sin(y[0]), -side * b * np.sin(y[0]) - h * np.cos(y[0])
        return [y[1], -first * (second * y[1] ** 2 + G) / (inertia + first**2)]

    lands = lambda t, y: side * y[0]
    lands.terminal, lands.direction = True, -1
    for time in times:
        while now < time:
            path = solve_ivp(rate, (now, time), state, events=lands, rtol=1e-12, atol=1e-14)
            now, state = path.t[-1], path.y[:, -1]
            if len(path.t_events[0]):  # vertical inelastic impulse at the other corner: its velocity is 0 afterwards
                w, vy = state[1], side * b * state[1]
                impulse = -(vy + side * b * w) / (1 + b**2 / inertia)
                side, state = -side, np.array([0.0, w + side * b * impulse / inertia])
        found.append(state)
    return np.array(found)


def test_a_block_without_friction_slides_on_its_feet(open_fmu):
    instance = open_fmu("RockingBlock").initialize({"mu": 0.0}, tolerance=1e-11)
    times = np.linspace(0.1, 1.1, 11)
    for time, state in zip(times, frictionless_block(0.1, 0.5, 0.1, times)):
        to(instance, time)
        assert instance.get("theta", "w") == pytest.approx(state, abs=1e-8)
        assert instance.get("vx") == pytest.approx(0, abs=1e-12)
    to(instance, 5.0)
    assert instance.get("w") == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("mu", np.arange(1, 20) / 10)
@pytest.mark.parametrize("vx", [0.2, 0.5, 1.0, 2.0, 3.0])
def test_a_body_lands_flat_on_many_feet(open_fmu, mu, vx):
    """It stays flat, as the resultant force passes the height h of the centre between the feet at -1 and 1: it then slides or sticks."""
    h, vy = 0.5, -1.0
    after = max(vx + mu * vy, 0.0)
    assert h * (vx - after) < 1.0  # the offset of the resultant
    instance = open_fmu("FlatLanding").initialize({"mu": mu, "vx": vx, "vy": vy})
    assert instance.get("vx", "vy", "w") == pytest.approx([after, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("mu", [0.05, 0.1, 0.15, 0.2, 0.25, 0.4, 3.0])
def test_a_block_rests_for_every_friction(open_fmu, mu):
    instance = open_fmu("RockingBlock").initialize({"mu": mu})
    energy = instance.get("totalEnergy")
    for _ in range(30):
        instance.step(0.5)
        assert instance.get("totalEnergy") <= energy + 1e-9
        energy = instance.get("totalEnergy")
    assert instance.get("theta", "vx", "w") == pytest.approx([0, 0, 0], abs=1e-12)
