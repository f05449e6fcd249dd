"""The systems of fmu/ with events, against closed forms and independent integrations; and the events of FMI."""

import fmpy
import mpmath
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import fmu
from fmu import Instance

SWITCHED = ["BouncingBall", "HardStopPendulum", "StickSlip", "NewtonsCradle", "PassiveWalker", "VibratingTable"]
G = 9.81


def value(instance, name):
    """Value of a variable of any type."""
    variable = next(v for v in instance.description.modelVariables if v.name == name)
    read = instance.fmu.getReal if variable.type == "Real" else instance.fmu.getInteger
    return read(instance.vr(name))[0]


def events(instance):
    return value(instance, "events")


def to(instance, time):
    instance.step(time - instance.time)


# --- The ball ---


def bounces(h, e, count):
    """Times of the bounces, and the velocities after them."""
    fall, speed = np.sqrt(2 * h / G), np.sqrt(2 * G * h)
    powers = e ** np.arange(1, count + 1)
    times = fall * (1 + 2 * np.concatenate([[0], np.cumsum(powers[:-1])]))
    return times, speed * powers


@pytest.mark.parametrize("h, e", [(1, 0.8), (0.37, 0.5), (2.3, 0.93), (1, 1), (5, 0.07), (1e-3, 0.8), (1, 0)])
def test_a_ball_bounces_at_the_right_times(open_fmu, h, e):
    instance = open_fmu("BouncingBall").initialize({"h": h, "e": e})
    times, speeds = bounces(h, e, 200)
    end = min(times[-1], np.sqrt(2 * h / G) * (1 + e) / (1 - e) if e < 1 else np.inf)
    for t in np.sort(np.random.default_rng(1).uniform(0, 0.999 * end, 40)):
        to(instance, t)
        k = np.searchsorted(times, t) - 1
        s = t - times[k]
        height = h - G * t**2 / 2 if k < 0 else speeds[k] * s - G * s**2 / 2
        assert instance.get("h") == pytest.approx(height, abs=1e-12 * max(1, h, (k + 1) / 20))
        assert events(instance) == k + 1


@pytest.mark.parametrize("h, e", [(1, 0.8), (0.37, 0.5), (2.3, 0.93), (5, 0.07), (1, 0)])
def test_a_ball_comes_to_rest(open_fmu, h, e):
    instance = open_fmu("BouncingBall").initialize({"h": h, "e": e, "m": 2.5})
    rest = np.sqrt(2 * h / G) * (1 + e) / (1 - e)
    to(instance, rest * (1 - 1e-6))
    assert value(instance, "ground.closed") == (e == 0 and rest * (1 - 1e-6) > np.sqrt(2 * h / G))
    to(instance, rest * (1 + 1e-12))
    assert value(instance, "ground.closed") == 1
    assert instance.get("ground.force") == pytest.approx(2.5 * G, rel=1e-14)
    count = events(instance)
    _, speeds = bounces(h, e, 1000)
    heights = speeds**2 / (2 * G)
    assert np.argmax(heights < 1e-14 * h) <= count <= 1 + np.argmax(heights < 1e-16 * min(h, 1))
    to(instance, rest + 100)
    assert instance.get("h", "v") == pytest.approx([0, 0], abs=1e-15)
    assert events(instance) == count


def test_a_ball_bounces_without_loss_for_long(open_fmu):
    instance = open_fmu("BouncingBall").initialize({"e": 1, "h": 0.01})
    fall = np.sqrt(0.02 / G)
    to(instance, fall * 200000)
    assert events(instance) in (99999, 100000, 100001)
    assert instance.get("totalEnergy") == pytest.approx(0.01 * G, rel=1e-9)


# --- The pendulum ---


def swings(theta0, stop, e, count):
    """Times of the impacts of a pendulum of length 1 released at theta0, and the velocities after them."""
    with mpmath.workdps(30):
        g = mpmath.mpf(G)

        def from_top(energy, angle):
            """Time from rest on the right to an angle, with energy = sin(top/2)^2."""
            k = mpmath.sqrt(energy)
            u = mpmath.asin(mpmath.sin(mpmath.mpf(angle) / 2) / k)
            return (mpmath.ellipk(energy) - mpmath.ellipf(u, energy)) / mpmath.sqrt(g)

        energy, t, result = mpmath.sin(mpmath.mpf(theta0) / 2) ** 2, mpmath.mpf(0), []
        wall = mpmath.sin(mpmath.mpf(stop) / 2) ** 2
        for i in range(count):
            t += from_top(energy, stop) * (1 if i == 0 else 2)
            energy = wall + mpmath.mpf(e) ** 2 * (energy - wall)
            result.append((float(t), float(mpmath.sqrt(4 * g * (energy - wall)))))
    return result


@pytest.mark.parametrize("theta0, stop, e", [(1, -0.2, 0.9), (2.5, 0, 0.6), (0.8, 0.3, 1.0), (3.0, -1.5, 0.95)])
def test_a_pendulum_hits_its_stop_at_the_right_times(open_fmu, theta0, stop, e):
    instance = open_fmu("HardStopPendulum").initialize({"theta": theta0, "thetaStop": stop, "e": e}, tolerance=1e-12)
    for i, (t, speed) in enumerate(swings(theta0, stop, e, 8)):
        to(instance, t - 1e-10)
        before = instance.get("omega")
        assert events(instance) == i
        to(instance, t + 1e-10)
        assert events(instance) == i + 1
        assert instance.get("omega") == pytest.approx(speed, abs=1e-8)
        assert instance.get("omega") == pytest.approx(-e * before, abs=1e-8)


def test_a_pendulum_grazes_its_stop_in_the_end(open_fmu):
    """Each impact keeps 0.9 of the velocity, until the pendulum swings between -0.2 and 0.2."""
    instance = open_fmu("HardStopPendulum").initialize(tolerance=1e-11)
    to(instance, 500)
    assert instance.get("totalEnergy") == pytest.approx(-G * np.cos(0.2), rel=1e-9)
    rows = np.array(instance.run(505, 0.01, "theta"))
    assert rows[:, 1].min() >= -0.2 - 1e-9 and rows[:, 1].max() == pytest.approx(0.2, abs=1e-4)


# --- The block ---


@pytest.mark.parametrize("belt, static, sliding", [(0.1, 0.1, 0.05), (0.3, 0.2, 0.12), (0.02, 0.15, 0.1)])
def test_a_block_sticks_and_slips(open_fmu, belt, static, sliding):
    """It slips at k x = muStatic N; x - muSliding N/k then swings until v is that of the belt again."""
    instance = open_fmu("StickSlip").initialize({"vBelt": belt, "muStatic": static, "muSliding": sliding, "v": belt}, tolerance=1e-12)
    reach, centre = 10 * static, 10 * sliding
    way = reach - centre
    slip = 2 * (np.pi - np.arctan(way / belt))
    stick = 2 * way / belt
    begin = reach / belt
    for cycle in range(4):
        start = begin + cycle * (slip + stick)
        to(instance, start - min(0.5, 0.5 * stick))
        assert value(instance, "belt.sliding") == 0
        assert instance.get("belt.force") == pytest.approx(-instance.get("x"), abs=1e-12)
        to(instance, start - 1e-9)
        assert value(instance, "belt.sliding") == 0
        to(instance, start + 1e-9)
        assert value(instance, "belt.sliding") == -1
        assert instance.get("x") == pytest.approx(reach, abs=1e-8)
        for s in np.linspace(0.1, 0.9, 5) * slip:
            to(instance, start + s)
            x, v = centre + way * np.cos(s) + belt * np.sin(s), belt * np.cos(s) - way * np.sin(s)
            assert instance.get("x", "v") == pytest.approx([x, v], abs=1e-9)
            assert instance.get("belt.force") == pytest.approx(-centre, abs=1e-12)
        to(instance, start + slip - 1e-8)
        assert value(instance, "belt.sliding") == -1
        to(instance, start + slip + 1e-8)
        assert value(instance, "belt.sliding") == 0
        assert instance.get("x") == pytest.approx(centre - way, abs=1e-7)


# --- The cradle ---


def test_a_cradle_hands_its_push_on(open_fmu):
    instance = open_fmu("NewtonsCradle").initialize(tolerance=1e-12)
    rate = np.sqrt(G / 0.2)
    half = float(2 * mpmath.ellipk(mpmath.sin(0.25) ** 2) / rate)
    energy = instance.get("totalEnergy")
    names = [f"theta[{i}]" for i in range(1, 6)]
    for i in range(6):
        to(instance, half * (i + 1) - 1e-3)  # at the turning point on the other side
        expected = np.zeros(5)
        expected[4 if i % 2 == 0 else 0] = (0.5 if i % 2 == 0 else -0.5) * np.cos(1e-3 * rate)
        assert instance.get(*names) == pytest.approx(expected, abs=2e-6)
        middle = np.delete(instance.get(*names), 4 if i % 2 == 0 else 0)
        assert middle == pytest.approx(np.zeros(4), abs=1e-11)
        assert instance.get("totalEnergy") == pytest.approx(energy, rel=1e-10)


def test_two_balls_let_two_balls_go(open_fmu):
    instance = open_fmu("NewtonsCradle").initialize({"theta[2]": -0.5}, tolerance=1e-12)
    to(instance, float(2 * mpmath.ellipk(mpmath.sin(0.25) ** 2) / np.sqrt(G / 0.2)))
    assert instance.get(*(f"theta[{i}]" for i in range(1, 6))) == pytest.approx([0, 0, 0, 0.5, 0.5], abs=1e-9)


def test_a_cradle_loses_by_restitution(open_fmu):
    """Of two balls, the first passes on (1 + e)/2 of the relative velocity, whichever pair closes fastest."""
    e, instance = 0.8, open_fmu("NewtonsCradle")
    instance.initialize({"e": e}, tolerance=1e-12)
    hit = float(mpmath.ellipk(mpmath.sin(0.25) ** 2) / np.sqrt(G / 0.2))
    to(instance, hit + 1e-9)
    speed = np.sqrt(2 * G / 0.2 * (1 - np.cos(0.5)))
    expected = np.array([speed, 0, 0, 0, 0])
    while (closing := -np.diff(expected)).max() > 1e-13:
        i = closing.argmax()
        expected[i] -= (1 + e) / 2 * closing[i]
        expected[i + 1] += (1 + e) / 2 * closing[i]
    assert instance.get(*(f"omega[{i}]" for i in range(1, 6))) == pytest.approx(expected, abs=1e-7)


# --- The walker ---


class Walker:
    """
    Two legs in four coordinates: the hip, and the angles of the legs. Forces constrain the stance foot, and impulses act on the swing foot.
    """

    m, hip, a, b = 5.0, 10.0, 0.5, 0.5
    slope = np.pi / 60

    def points(self, q):
        """Jacobians of the hip and the masses of the legs."""
        jacobians = [np.array([[1, 0, 0, 0], [0, 1, 0, 0]])] + [self.on_leg(q, leg, self.b) for leg in (0, 1)]
        return jacobians

    def on_leg(self, q, leg, distance):
        row = np.zeros((2, 4))
        row[0, 0] = row[1, 1] = 1
        row[:, 2 + leg] = distance * np.array([np.cos(q[2 + leg]), np.sin(q[2 + leg])])
        return row

    def bend(self, q, v, leg, distance):
        return distance * v[2 + leg] ** 2 * np.array([-np.sin(q[2 + leg]), np.cos(q[2 + leg])])

    def mass(self, q):
        return sum(m * J.T @ J for m, J in zip((self.hip, self.m, self.m), self.points(q)))

    def full(self, y):
        """Coordinates and velocities from those of the legs (swing, stance), with the stance foot at 0."""
        l = self.a + self.b
        s, w, vs, vw = y[1], y[0], y[3], y[2]
        return (np.array([-l * np.sin(s), l * np.cos(s), w, s]), np.array([-l * np.cos(s) * vs, -l * np.sin(s) * vs, vw, vs]))

    def rates(self, t, y):
        q, v = self.full(y)
        load = -np.array([0, self.hip * G, 0, 0])
        for leg in (0, 1):
            J = self.on_leg(q, leg, self.b)
            load -= self.m * J.T @ (self.bend(q, v, leg, self.b) + [0, G])
        foot = self.on_leg(q, 1, self.a + self.b)
        matrix = np.block([[self.mass(q), foot.T], [foot, np.zeros((2, 2))]])
        a = np.linalg.solve(matrix, np.concatenate([load, -self.bend(q, v, 1, self.a + self.b)]))
        return [y[2], y[3], a[2], a[3]]

    def strike(self, y):
        q, v = self.full(y)
        foot, inverse = self.on_leg(q, 0, self.a + self.b), np.linalg.inv(self.mass(q))
        v = v - inverse @ foot.T @ np.linalg.solve(foot @ inverse @ foot.T, foot @ v)
        return np.array([y[1], y[0], v[3], v[2]])

    def step(self, y):
        def touches(t, y):
            return y[0] + y[1] + 2 * self.slope if t > 0.3 else 1.0  # not at the start

        touches.terminal = True
        found = solve_ivp(self.rates, (0, 2), y, "DOP853", rtol=1e-12, atol=1e-13, events=touches)
        return found.t[-1], self.strike(found.y[:, -1])


def test_a_walker_walks(open_fmu):
    """Each step agrees with an integration and plastic impact in four coordinates; the start is near the published cycle."""
    walker, names = Walker(), ("thetaSwing", "thetaStance", "omegaSwing", "omegaStance")
    instance = open_fmu("PassiveWalker").initialize(tolerance=1e-12)
    y, t, foot = np.array([-0.3234, 0.2187, -0.3772, -1.0918]), 0.0, 0.0
    for i in range(6):
        length, after = walker.step(y)
        to(instance, t + 0.4 * length)
        middle = solve_ivp(walker.rates, (0, 0.4 * length), y, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        assert instance.get(*names) == pytest.approx(middle, abs=1e-8)
        to(instance, t + length + 1e-9)
        assert value(instance, "steps") == i + 1
        assert instance.get(*names) == pytest.approx(after, abs=1e-7)
        foot += np.sin(after[1]) - np.sin(after[0])
        assert value(instance, "foot") == pytest.approx(foot, abs=1e-7)
        assert instance.get("hip.x", "hip.y") == pytest.approx([foot - np.sin(after[1]), np.cos(after[1]) - foot * np.tan(np.radians(3))], abs=1e-6)
        y, t = after, t + length
    assert foot > 2
    to(instance, 10.0)
    assert value(instance, "steps") == 13


def test_a_walker_has_the_published_cycle(open_fmu):
    walker = Walker()
    # The foot lies on the slope at the start, which relates the two angles: a map of three numbers.
    extend = lambda z: np.array([-2 * walker.slope - z[0], *z])
    back = lambda z: walker.step(extend(z))[1][1:]
    cycle = fsolve(lambda z: back(z) - z, [0.2187, -0.3772, -1.0918], xtol=1e-12)
    assert extend(cycle) == pytest.approx([-0.3234, 0.2187, -0.3772, -1.0918], abs=6e-4)
    derivative = np.column_stack([(back(cycle + d) - back(cycle - d)) / 2e-5 for d in 1e-5 * np.eye(3)])
    assert max(abs(np.linalg.eigvals(derivative))) < 0.9
    names = ("thetaSwing", "thetaStance", "omegaSwing", "omegaStance")
    instance = open_fmu("PassiveWalker").initialize(dict(zip(names, extend(cycle))), tolerance=1e-12)
    period = walker.step(extend(cycle))[0]
    to(instance, 20 * period + 1e-7)
    assert value(instance, "steps") == 20
    to(instance, 20.5 * period)
    half = instance.get(*names)
    instance.reset().initialize(dict(zip(names, extend(cycle))), tolerance=1e-12)
    to(instance, 0.5 * period)
    assert half == pytest.approx(instance.get(*names), abs=1e-8)


# --- The table ---


def test_a_ball_bounces_in_step_with_a_table(open_fmu):
    """With the velocity g T/2 after the bounce, A w cos(phase) = (g T/2) (1 - e)/(1 + e)."""
    rate, e = 188.49555921538759, 0.8
    amplitude = 0.7 * G / rate**2
    period = 2 * np.pi / rate
    phase = np.arccos(G * period / 2 * (1 - e) / (1 + e) / (amplitude * rate))
    start = phase / rate
    values = {"amplitude": amplitude, "h": amplitude * np.sin(phase), "v": G * period / 2}
    instance = open_fmu("VibratingTable").initialize(values, tolerance=1e-12, start_time=start)
    for i in (1, 2, 3, 50, 300):
        to(instance, start + (i - 0.5) * period)
        assert events(instance) == i - 1
        assert instance.get("h") == pytest.approx(values["h"] + G * period**2 / 8, rel=1e-9)


def test_a_ball_bounces_on_a_table_impact_by_impact(open_fmu):
    """The first bounces, by bisection in 40 digits. They are chaotic, so that errors grow with each."""
    instance = open_fmu("VibratingTable").initialize(tolerance=1e-13)
    with mpmath.workdps(40):
        A, w, e, g = mpmath.mpf(0.001), mpmath.mpf(188.49555921538759), mpmath.mpf(0.8), mpmath.mpf(G)
        t, h, v = mpmath.mpf(0), mpmath.mpf(0.01), mpmath.mpf(0)
        for i in range(12):
            gap = lambda s: h + v * s - g * s * s / 2 - A * mpmath.sin(w * (t + s))
            s = mpmath.mpf(10) ** -7 if i > 0 else mpmath.mpf(0)
            while gap(s + mpmath.mpf(10) ** -4) > 0:
                s += mpmath.mpf(10) ** -4
            s = mpmath.findroot(gap, (s, s + mpmath.mpf(10) ** -4), solver="anderson", tol=1e-60)
            t, h, v = t + s, h + v * s - g * s * s / 2, v - g * s
            table = A * w * mpmath.cos(w * t)
            v = table - e * (v - table)
            error = 1e-12 * 5.0**i
            to(instance, float(t) - error)
            assert events(instance) == i
            to(instance, float(t) + error)
            assert events(instance) == i + 1
            assert instance.get("v") == pytest.approx(float(v), abs=1e4 * error)


def test_a_ball_leaves_a_table_where_it_falls_faster(open_fmu):
    rate, e, amplitude = 50.0, 0.0, 2 * G / 50.0**2
    instance = open_fmu("VibratingTable").initialize({"frequency": rate, "e": e, "amplitude": amplitude, "h": 0, "v": amplitude * rate}, tolerance=1e-12)
    leaves = np.arcsin(0.5) / rate
    to(instance, leaves - 1e-11)
    assert value(instance, "table.closed") == 1
    assert instance.get("table.force") == pytest.approx(0, abs=1e-7)
    to(instance, leaves + 1e-11)
    assert value(instance, "table.closed") == 0
    s = 0.01
    to(instance, leaves + s)
    assert instance.get("h") == pytest.approx(G / rate**2 + amplitude * rate * np.sqrt(0.75) * s - G * s**2 / 2, abs=1e-12)


# --- FMI ---


@pytest.mark.parametrize("name", SWITCHED + ["SimplePendulum"])
def test_indicators_are_counted(name):
    description = fmu.description(name)
    assert (description.numberOfEventIndicators > 0) == (name in SWITCHED)
    instance = Instance(name, FMU2Model).initialize()
    count = description.numberOfEventIndicators
    indicators = (fmpy.fmi2.fmi2Real * max(count, 1))()
    instance.fmu.getEventIndicators(indicators, count)
    assert np.all(np.isfinite(indicators))
    with instance.fails(fmu.ERROR, "the number of event indicators"):
        instance.fmu.getEventIndicators(indicators, count + 1)
    instance.free()


ENDS = {"BouncingBall": 2.0, "HardStopPendulum": 5, "StickSlip": 30, "NewtonsCradle": 2, "PassiveWalker": 3, "VibratingTable": 0.15}


@pytest.mark.parametrize("name", SWITCHED)
def test_model_exchange_agrees_with_co_simulation(open_fmu, name):
    instance = open_fmu(name).initialize(tolerance=1e-12)
    states = [s for s in fmu.states_of(name)]
    to(instance, ENDS[name])
    result = fmpy.simulate_fmu(str(fmu.unpacked(name)), fmi_type="ModelExchange", stop_time=ENDS[name], output=states,
                               relative_tolerance=1e-11, output_interval=ENDS[name] / 10)  # fmt: skip
    last = [result[s][-1] for s in states]
    assert last == pytest.approx(instance.get(*states), abs=1e-4 if name == "VibratingTable" else 1e-6)


@pytest.mark.parametrize("name", SWITCHED)
def test_an_importer_that_ignores_indicators_gets_something_sane(name):
    instance = Instance(name, FMU2Model).initialize()
    model, t, step = instance.fmu, 0.0, 1e-4
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    count = instance.description.numberOfContinuousStates
    energy = instance.get("totalEnergy")
    x, dx = (fmpy.fmi2.fmi2Real * count)(), (fmpy.fmi2.fmi2Real * count)()
    for _ in range(8000):
        model.getContinuousStates(x, count)
        model.getDerivatives(dx, count)
        t += step
        model.setTime(t)
        for i in range(count):
            x[i] += step * dx[i]
        model.setContinuousStates(x, count)
        enter, _ = model.completedIntegratorStep()
        if enter:
            model.enterEventMode()
            for _ in range(100):
                again = model.newDiscreteStates()[0]
                if not again:
                    break
            model.enterContinuousTimeMode()
    assert np.all(np.isfinite(x))
    if name not in ("StickSlip", "PassiveWalker", "VibratingTable"):
        assert instance.get("totalEnergy") <= energy + 0.02 * abs(energy) + 1e-3
    if name == "BouncingBall":
        assert -1e-2 < instance.get("h") < 0.7
    instance.free()


def test_a_ball_rests_in_model_exchange_too():
    """After a fall of 1 mm with little restitution the ball is at rest most of the time; the contact stays closed."""
    result = fmpy.simulate_fmu(str(fmu.unpacked("BouncingBall")), fmi_type="ModelExchange", stop_time=3, start_values={"h": 1e-3, "e": 0.2},
                               output=["h", "ground.closed", "ground.force"], relative_tolerance=1e-9, output_interval=0.25)  # fmt: skip
    late = result[result["time"] > 0.5]
    assert len(late) >= 10
    assert abs(late["h"]).max() < 1e-9
    assert np.all(late["ground.closed"] == 1) and late["ground.force"] == pytest.approx(np.full(len(late), G))


MIDDLES = {"BouncingBall": (1.5, 3.9), "HardStopPendulum": (0.9, 3), "StickSlip": (11.5, 9), "NewtonsCradle": (0.3, 1),
           "PassiveWalker": (1.0, 1.5), "VibratingTable": (0.07, 0.1)}  # fmt: skip


@pytest.mark.parametrize("serialized", [False, True])
@pytest.mark.parametrize("name", SWITCHED)
def test_states_are_kept_with_their_modes(open_fmu, name, serialized):
    instance = open_fmu(name).initialize()
    middle, way = MIDDLES[name]
    names = fmu.states_of(name)
    to(instance, middle)
    state = instance.fmu.getFMUstate()
    first = [row for row in instance.run(middle + way, way / 7, *names)], events(instance)
    if serialized:
        data = instance.fmu.serializeFMUstate(state)
        instance.free_state(state)
        state = instance.fmu.deSerializeFMUstate(data)
    instance.fmu.setFMUstate(state)
    instance.time = middle
    second = [row for row in instance.run(middle + way, way / 7, *names)], events(instance)
    assert first == second
    instance.free_state(state)


@pytest.mark.parametrize("name", SWITCHED)
def test_communication_steps_do_not_matter(open_fmu, name):
    middle, way = MIDDLES[name]
    names, ends = fmu.states_of(name), []
    for count in (1, 17, 391):
        instance = open_fmu(name).initialize(tolerance=1e-12)
        instance.run(middle + way, (middle + way) / count, *names)
        ends.append((instance.get(*names), events(instance)))
    for state, number in ends[1:]:
        assert state == pytest.approx(ends[0][0], abs=1e-6 if name == "VibratingTable" else 1e-9)
        assert abs(number - ends[0][1]) <= (1 if name == "BouncingBall" else 0)


@pytest.mark.parametrize("name", SWITCHED)
def test_reset_forgets_modes(open_fmu, name):
    instance = open_fmu(name)
    runs = []
    for _ in range(2):
        instance.reset().initialize()
        assert events(instance) == 0
        runs.append((instance.run(MIDDLES[name][0], MIDDLES[name][0] / 5, *fmu.states_of(name)), events(instance)))
    assert runs[0] == runs[1]
