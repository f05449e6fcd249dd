"""Events caused by inputs and parameters set between steps, and integrators that detect events late."""

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model, fmi2Real
from scipy.integrate import solve_ivp

import fmu
from fmu import DISCARD, build_systems

PUSHED = '<input name="u"/><coordinate name="x" velocity="v"/><particle mass="1" x="x"/>'
THROWN = '<coordinate name="h" velocity="v" start="1"/><particle mass="1" y="h"/><gravity y="-9.81"/>'
RESTING = '<parameter name="p" start="0"/><coordinate name="x" velocity="v"/><coordinate name="y" velocity="w"/><particle mass="1" x="x"/><particle mass="1" x="y"/>'
ON_FLOOR = '{}<coordinate name="y" velocity="v" start="{}"/><particle mass="1" y="y"/><gravity y="-9.81"/><contact name="floor" gap="y - u" restitution="0.5"/>'
GUIDE = (
    '<parameter name="mu" start="0.3"/><coordinate name="x" velocity="vx" velocityStart="1"/><coordinate name="y" velocity="vy" velocityStart="5"/>'
    '<particle mass="1" x="x" y="y"/><gravity y="-10"/><constraint name="c">x - 0.2*sin(y)</constraint>'
    '<friction name="f" coordinate="y" force="mu*abs(c.force)"/>'
)
# Values set one after the other, and the resulting change of velocity per second.
SET = {
    "More": (PUSHED + '<force coordinate="x">if(u &gt; 0, 10, 0)</force>', "v", [(0, 0), (1, 10), (0, 0), (1, 10), (0, 0), (-1, 0), (0, 0)]),
    "AtLeast": (PUSHED + '<force coordinate="x">if(u &gt;= 1, 10, 0)</force>', "v", [(0, 0), (1, 10), (0, 0), (1, 10)]),
    "Sign": (PUSHED + '<force coordinate="x">10*sign(u)</force>', "v", [(1, 10), (0, 0), (-1, -10), (0, 0)]),
    "Brake": (PUSHED + '<force coordinate="x">2</force><friction name="brake" coordinate="x" force="if(u &gt; 0, 10, 0)"/>', "v",
              [(0, 2), (1, -2), (0, 2), (0, 2)]),
    "Counted": (PUSHED + '<mode name="m"/><event when="u &gt;= 1"><set mode="m">m + 1</set></event><force coordinate="x">m</force>', "v",
                [(0, 0), (1, 1), (0, 1), (1, 2)]),
    "Tuned": (PUSHED.replace('input name="u"', 'parameter name="p" start="0"') + '<mode name="m"/><event when="p &gt;= 1"><set mode="m">m + 1</set></event>'
              '<mode name="n"/><event when="p - 0.5" direction="both"><set mode="n">n + 1</set></event><force coordinate="x">m + 100*n</force>', "v",
              [(0, 0), (1, 101), (0.5, 101), (1, 102), (0, 202)]),
    "Threshold": (RESTING + '<force coordinate="y">if(x &gt;= p, 10, 0) + if(x &gt; p, 1, 0) + 100*sign(x - p)</force>', "w",
                  [(0, 10), (1, -100), (0, 10), (-1, 111), (0, 10)]),
}  # fmt: skip
OTHERS = {
    "SetTo": '<mode name="m"/><coordinate name="x" velocity="v" start="-1"/><particle mass="1" x="x"/><coordinate name="y" velocity="w"/>'
    '<particle mass="1" x="y"/><force coordinate="y">if(x &gt;= 2, 1, 0)</force><event when="time &gt;= 0.5"><set coordinate="x">2</set></event>'
    '<event when="x &gt;= 2"><set mode="m">m + 1</set></event>',
    "Floor": ON_FLOOR.format('<parameter name="u" start="0"/>', 0),
    "Lift": ON_FLOOR.format('<input name="u" derivatives="2"/>', 0),
    "Raised": ON_FLOOR.format('<parameter name="u" start="0"/>', 1),
    "SetTwice": '<coordinate name="x" velocity="v"/><kinetic>v^2/2</kinetic><event when="time &gt;= 1"><set velocity="v">v + 1</set></event>'
    '<event when="time - 1" direction="rising"><set velocity="v">v + 2</set></event>',
    "Shaken": THROWN + '<contact name="table" gap="h - 0.3*sin(3*time)" restitution="0.4"/>',
    "Rising": THROWN + '<contact name="table" gap="h - 0.1*time^2" restitution="0.4"/>',
    "Tie": '<coordinate name="x" velocity="v"/><particle mass="1" x="x"/><force coordinate="x">1 - if(x &gt; 0, 100*x, 0)</force>',
    "Left": '<mode name="n"/><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><force coordinate="x">time*(1 - 4*n)</force>'
    '<event when="x &gt; 0"><set mode="n">1</set></event>',
    "Guided": GUIDE,
    "HertzInside": THROWN + '<force coordinate="h">if(h &lt; 0, max(0, 1e5*(-h)^1.5), 0)</force>',
    "Part": THROWN + '<mode name="n"/><event when="h"><set velocity="v">-v</set><set mode="n">n + 1</set></event>',
    "Host": '<include file="../Part/system.xml" as="a"/>',
}


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {name: text for name, (text, _, _) in SET.items()} | OTHERS
    build_systems("outside", {name: f'<system name="{name}">{text}</system>' for name, text in texts.items()})


@pytest.mark.parametrize("name", SET)
def test_a_value_that_is_set_to_a_threshold_has_reached_it(open_fmu, name):
    """Comparisons and signs at a threshold depend on the value, not on the side it came from."""
    text, velocity, steps = SET[name]
    instance = open_fmu(name).initialize()
    for value, change in steps:
        before = instance.get(velocity)
        instance.set({"u" if "<input" in text else "p": value})
        instance.step(1.0)
        assert instance.get(velocity) - before == pytest.approx(change, abs=1e-9), value


def test_a_value_that_an_event_sets_to_a_threshold_has_reached_it(open_fmu):
    instance = open_fmu("SetTo").initialize()
    instance.step(1.0)
    assert instance.get("m", "w") == pytest.approx([1, 0.5])


@pytest.mark.parametrize("name, down", [("Floor", 0.01), ("Floor", 0.5), ("Lift", 0.01), ("Lift", 0.5)])
def test_a_floor_that_recedes_opens_the_contact(open_fmu, name, down):
    instance = open_fmu(name).initialize()
    instance.step(0.1)
    instance.set(u=-down)
    instance.step(0.01)
    assert instance.get("y", "v") == pytest.approx([-9.81 * 0.01**2 / 2, -9.81 * 0.01], abs=1e-12)
    instance.step(0.5)
    assert instance.get("y") >= -down - 1e-12


def test_a_floor_does_not_come_through_a_body(open_fmu):
    instance = open_fmu("Raised").initialize()
    instance.step(0.2)
    instance.set(u=0.9)
    with instance.fails(DISCARD, "the contact 'floor' is penetrated: its gap is -0.09"):
        instance.step(0.1)


def test_the_look_ahead_is_discarded_after_a_change(open_fmu):
    """The first impact would be at 0.4515 s; with tenfold gravity from 0.2 s on it is at 0.3096 s, by the parabola."""
    instance = open_fmu("BouncingBall").initialize()
    for _ in range(20):
        instance.step(0.01)
    instance.set(g=98.1)
    for _ in range(15):
        instance.step(0.01)
    height, speed = 1 - 9.81 * 0.2**2 / 2, 9.81 * 0.2
    at_ground = np.sqrt(speed**2 + 2 * 98.1 * height)
    since = 0.15 - (at_ground - speed) / 98.1
    after = 0.8 * at_ground
    assert instance.get("h", "v") == pytest.approx([after * since - 98.1 * since**2 / 2, after - 98.1 * since], abs=1e-12)


def test_an_impact_is_the_same_in_short_steps_and_long_ones(open_fmu):
    """The impact is the same for short steps and long ones, and from a state saved in between, although the search looks ahead."""
    ends = []
    for step in (1.5, 0.1, 0.03, 0.001):
        instance = open_fmu("BouncingBall").initialize()
        for k in range(round(1.5 / step)):
            if k == 7:
                state = instance.fmu.getFMUstate()
                instance.step(step)
                instance.fmu.setFMUstate(state)
                instance.time = k * step
            instance.step(step)
        ends.append(instance.get("h", "v"))
    assert np.ptp(ends, axis=0) == pytest.approx(0, abs=2e-12)


def test_two_events_cannot_set_the_same_at_once(open_fmu):
    instance = open_fmu("SetTwice").initialize()
    with instance.fails(DISCARD, r"number 1, when=\"time >= 1\", and number 2, when=\"time - 1\", happen at once and both set 'v'"):
        instance.step(2.0)


def exchanged(name, stop, interval, *names):
    archive = str(fmu.archive(name))
    return fmpy.simulate_fmu(archive, fmi_type="ModelExchange", stop_time=stop, output_interval=interval, output=list(names))


@pytest.mark.parametrize("interval", [0.03, 0.5, 3])
@pytest.mark.parametrize("name, floor", [("Shaken", lambda t: 0.3 * np.sin(3 * t)), ("Rising", lambda t: 0.1 * t**2)])
def test_nothing_falls_through_a_contact_in_model_exchange(open_fmu, name, floor, interval):
    """Bounces fade on a moving floor; the body's height is not a polynomial of time."""
    result = exchanged(name, 3, interval, "h")
    assert np.min(result["h"] - floor(result["time"])) > -1e-6
    instance = open_fmu(name).initialize()
    instance.step(3.0)
    assert result["h"][-1] == pytest.approx(instance.get("h"), abs=1e-3)


def test_an_indicator_is_not_zero_behind_an_event(open_fmu):
    """An importer detects an impact late; afterwards the body is at the contact, and the indicator is positive."""
    instance = open_fmu("Rising", kind=FMU2Model).initialize()
    model = instance.fmu
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    model.setContinuousStates((fmi2Real * 2)(-1e-11, -1.0), 2)
    model.enterEventMode()
    model.newDiscreteStates()
    state, indicator = (fmi2Real * 2)(), (fmi2Real * 1)()
    model.getContinuousStates(state, 2)
    model.getEventIndicators(indicator, 1)
    assert list(state) == pytest.approx([0, 0.4], abs=1e-15) and indicator[0] > 5e-12


def test_an_importer_detects_a_departure_from_zero():
    """The indicator is zero at the start itself."""
    assert exchanged("Tie", 1, 0.25, "x")["x"][-1] == pytest.approx((1 - np.cos(10)) / 100, abs=1e-5)
    assert exchanged("Left", 1, 0.25, "x")["x"][-1] == pytest.approx(-0.5, abs=1e-5)


def test_a_bounce_that_is_tiny_beside_its_communication_step(open_fmu):
    """The step starts just before an impact, without knowledge of earlier bounces, and is a thousand times as long as the next one."""
    for before in np.linspace(0, 0.01, 100):
        instance = open_fmu("Shaken").initialize(tolerance=1e-9)
        for end in (1.1 - before, 1.101 - before, 3.0):  # it rests from 1.1009 s on
            instance.step(end - instance.time)
        assert instance.get("h") == pytest.approx(0.3 * np.sin(9), abs=1e-12)


@pytest.mark.parametrize("interval", [0.1, 1.2])
def test_an_event_that_the_projection_moves_is_seen(open_fmu, interval):
    def rate(_, s):
        y, v = s
        f, d = 0.2 * np.cos(y), -0.2 * np.sin(y)
        # The slot's force along x is c, and y'' = -10 - f c - mu |c| sign(v), where c = x'' = f y'' + d v^2.
        for sign in (1, -1):
            c = (-10 * f + d * v * v) / (1 + f * f + f * 0.3 * sign * np.sign(v))
            if c * sign >= 0:
                return [v, -10 - f * c - 0.3 * abs(c) * np.sign(v)]

    result = exchanged("Guided", 1.2, interval, "y", "vy")
    instance = open_fmu("Guided").initialize(tolerance=1e-9)
    instance.step(1.2)
    expected = solve_ivp(rate, [0, 1.2], [0, 5], rtol=1e-10, atol=1e-12, max_step=1e-3).y[:, -1]
    assert instance.get("y", "vy") == pytest.approx(expected, abs=1e-5)
    assert [result["y"][-1], result["vy"][-1]] == pytest.approx(expected, abs=1e-3)


def test_a_branch_without_a_value_in_a_closed_piece(open_fmu):
    instance = open_fmu("HertzInside").initialize(tolerance=1e-9)
    instance.step(2.0)
    assert instance.get("h") > -0.05 and instance.get("kineticEnergy") < 9.9
    force = lambda t, y: [y[1], -9.81 + 1e5 * max(-y[0], 0) ** 1.5]
    expected = solve_ivp(force, (0, 2), [1, 0], method="DOP853", rtol=1e-11, atol=1e-13, max_step=1e-3).y[:, -1]
    assert instance.get("h", "v") == pytest.approx(expected, abs=1e-5)
    assert exchanged("HertzInside", 2, 0.1, "h")["h"][-1] == pytest.approx(expected[0], abs=1e-4)


def test_events_of_an_included_system(open_fmu):
    part, host = open_fmu("Part").initialize(), open_fmu("Host").initialize()
    for instance in (part, host):
        instance.step(2.0)
    assert host.get("a.h", "a.v", "a.n") == pytest.approx(part.get("h", "v", "n"), abs=1e-12) and part.get("n") == 2
