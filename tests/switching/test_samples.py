"""<sample every offset>: sampled controllers against their difference equations, whose matrices are exponentials."""

import math

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model
from scipy.linalg import expm

import fmi3
import fmu
from fmu import DISCARD, ERROR

METHODS = ["taylor", "auto", "radau", "bdf", "erk", "exact"]
# A damped mass under a sampled controller with an integral; two modes count the samples and store the time of the last one.
SERVO = """
<system name="{name}">
  <parameter name="Ts" start="0.1" unit="s"/>
  <parameter name="t0" start="{offset}" unit="s"/>
  <parameter name="kp" start="3"/>
  <parameter name="kd" start="1.5"/>
  <parameter name="ki" start="0.4"/>
  <coordinate name="x" velocity="v" start="0.2"/>
  <mode name="u"/>
  <mode name="total"/>
  <mode name="k"/>
  <mode name="at" start="-1"/>
  <particle mass="1" x="x"/>
  <force coordinate="x">u - 0.7*v</force>
  <sample every="Ts" offset="t0">
    <set mode="u">kp*(1 - x) - kd*v + ki*total</set>
    <set mode="total">total + 1 - x</set>
    <set mode="k">k + 1</set>
    <set mode="at">time</set>
  </sample>
  <solver method="{method}" tolerance="1e-11"/>
  <experiment stopTime="3"/>
</system>
"""
DIGITS = """
<system name="Digits_{method}">
  <mode name="n"/>
  <state name="x" start="1" rate="n - x"/>
  <sample every="0.15" offset="0.05"><set mode="n">n + 1</set></sample>
  <solver method="{method}" tolerance="1e-11"/>
</system>
"""
DECAY = """
<system name="Decay_{method}">
  <mode name="n"/>
  <state name="z" start="1" rate="-z"/>
  <sample every="0.01"><set mode="n">n + 1</set></sample>
  <solver method="{method}"/>
</system>
"""
# Two rates that exchange their values at common times, and a third that sets a state and a velocity.
RATES = """
<system name="Rates">
  <parameter name="Ts" start="0.1" unit="s"/>
  <coordinate name="x" velocity="v"/>
  <state name="z" rate="1"/>
  <mode name="a" start="1"/>
  <mode name="b" start="2"/>
  <particle mass="1" x="x"/>
  <sample every="Ts"><set mode="a">b</set></sample>
  <sample every="3*Ts"><set mode="b">a + 10</set></sample>
  <sample every="0.25" offset="0.5">
    <set state="z">0</set>
    <set velocity="v">v + z</set>
  </sample>
  <experiment stopTime="3"/>
</system>
"""
# A ball on the ground receives impulses at known times, one of them in flight.
KICKED = """
<system name="Kicked">
  <coordinate name="h" velocity="v"/>
  <particle mass="1" y="h"/>
  <potential>10*h</potential>
  <contact name="ground" gap="h" restitution="0"/>
  <sample every="0.75" offset="0.5"><set velocity="v">5</set></sample>
</system>
"""

# The period is a mode, which the third sample changes: the next sample, at 0.3, keeps its time, and later ones are 0.25 apart.
PACED = """
<system name="Paced_{method}">
  <state name="x" rate="1"/>
  <mode name="dt" start="0.1" unit="s"/>
  <mode name="n"/>
  <mode name="at"/>
  <sample every="dt"><set mode="n">n + 1</set><set mode="at">x</set><set mode="dt">if(n &gt; 1.5, 0.25, 0.1)</set></sample>
  <solver method="{method}"/>
</system>
"""


def name_of(method, offset):
    return f"Servo{method.title()}{'Late' if offset else ''}"


@pytest.fixture(scope="module", autouse=True)
def built():
    servos = {name_of(method, offset): SERVO.format(name=name_of(method, offset), method=method, offset=offset) for method in METHODS for offset in (0.0, 0.25)}
    digits = {f"Digits_{method}": DIGITS.format(method=method) for method in METHODS}
    paced = {f"Paced_{method}": PACED.format(method=method) for method in METHODS}
    decays = {f"Decay_{method}": DECAY.format(method=method) for method in ("taylor", "auto")}
    fmu.build_systems("samples", {"Rates": RATES, "Kicked": KICKED, **servos, **digits, **paced, **decays}, versions=[2, 3])


@pytest.mark.long
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [2.0, 0.13, 0.01])
def test_a_period_that_is_a_mode(method, step):
    times = [0.0, 0.1, 0.2, *(0.3 + 0.25 * k for k in range(20))]
    instance = fmu.Instance(f"Paced_{method}").initialize()
    for time, n, at, x in instance.run(2.0, step, "n", "at", "x"):
        passed = [sample for sample in times if sample <= time + 1e-12]
        assert (n, at, x) == (len(passed), pytest.approx(passed[-1], abs=1e-9), pytest.approx(time, abs=1e-9)), time


def exact_servo(end, Ts=0.1, t0=0.0, start=0.0, state=(0.2, 0.0)):
    """x, v, u, sum, k, at after all samples up to the end; between them [x, v, u]' = A [x, v, u]."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, -0.7, 1.0], [0.0, 0.0, 0.0]])
    y, total, count, at, time = np.array([*state, 0.0]), 0.0, 0, -1.0, start
    first = max(0, math.ceil((start - t0) / Ts - 1e-9))
    k = first
    while t0 + k * Ts <= end * (1 + 1e-15):
        sample = t0 + k * Ts
        y = expm(A * (sample - time)) @ y
        y[2] = 3 * (1 - y[0]) - 1.5 * y[1] + 0.4 * total
        total, count, at, time, k = total + 1 - y[0], count + 1, sample, sample, k + 1
    y = expm(A * (end - time)) @ y
    return [*y, total, count, at]


NAMES = ["x", "v", "u", "total", "k", "at"]


@pytest.mark.parametrize("offset", [0.0, 0.25])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [3.0, 0.1, 0.03, 0.007])
def test_a_servo_by_every_method(method, offset, step):
    servo = fmu.Instance(name_of(method, offset)).initialize({"t0": offset})
    for row in servo.run(2.95, step, *NAMES):
        assert row[1:] == pytest.approx(exact_servo(row[0], t0=offset), rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("method", ["taylor", "auto"])
def test_many_samples_in_one_step(method):
    """A decay is not stiff, however many samples interrupt it in one communication step: here 2001."""
    instance = fmu.Instance(f"Decay_{method}").initialize()
    instance.step(20)
    assert instance.get("z", "n") == pytest.approx([math.exp(-20), 2001], abs=1e-7)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [0.01, 0.05, 0.1])
def test_a_sample_a_digit_before_the_end(method, step):
    """0.05 + 2 0.15 is one unit in the last place below 0.35: the rest of the communication step is too short a step for SUNDIALS."""
    instance = fmu.Instance(f"Digits_{method}").initialize()
    x, n, time = 1.0, 0, 0.0
    for k in range(7):
        sample = 0.05 + 0.15 * k
        x, n, time = n + (x - n) * np.exp(time - sample), n + 1, sample
    for i in range(round(1 / step)):
        instance.step(step)
    assert instance.get("n") == n and instance.get("x") == pytest.approx(n + (x - n) * np.exp(time - 1), rel=1e-8)


@pytest.mark.parametrize("start", [0.0, 0.1, 0.13, 5.0])
def test_the_first_sample_is_at_the_start_or_behind_it(start):
    servo = fmu.Instance("ServoTaylor").initialize({"t0": 0.1}, start_time=start)
    for row in servo.run(start + 0.5, 0.05, *NAMES):
        assert row[1:] == pytest.approx(exact_servo(row[0], t0=0.1, start=start), rel=1e-8, abs=1e-8)


def test_there_is_no_drift():
    """Sample times are offset + k Ts without drift, even after many samples; no step loses or repeats one."""
    servo = fmu.Instance("ServoTaylor").initialize({"t0": 0.0, "kp": 0.1})
    for i in range(1, 2001):
        servo.step(0.37 * i - servo.time)
        servo.time = 0.37 * i
        count = servo.get("k")
        assert servo.get("at") == (count - 1) * 0.1
        assert (count - 1) * 0.1 <= servo.time * (1 + 1e-15) < count * 0.1
    assert count == 7401


def test_sums_of_steps_meet_the_samples():
    """Communication points that equal sample times up to rounding show the state after the sample."""
    for opened in (fmu, fmi3):
        servo = opened.Instance("ServoTaylor").initialize({"t0": 0.0})
        for i in range(1, 30):
            servo.fmu.doStep((i - 1) * 0.1, 0.1)
            assert servo.get("k") == i + 1


def test_a_period_that_is_tuned():
    """The next sample keeps its time; those after it follow with the new period."""
    servo = fmu.Instance("ServoTaylor").initialize({"Ts": 0.3})
    times = []
    for i in range(1, 401):
        if i == 40:
            servo.set(Ts=0.07)
        if i == 195:
            servo.set(Ts=0.5)
        servo.step(i * 0.01 - servo.time)
        servo.time = i * 0.01
        if not times or servo.get("at") != times[-1]:
            times.append(servo.get("at"))
    first = [0.0, 0.3, 2 * 0.3]
    second = [0.6 + k * 0.07 for k in range(1, 21)]
    third = [second[-1] + k * 0.5 for k in range(1, 5)]
    assert times == first + second + third


def rates_by_hand(end):
    """Values by order of time, in units of 1/20 s; simultaneous settings use the values before."""
    a, b, x, v, z, rows = 1.0, 2.0, 0.0, 0.0, 0.0, []
    for i in range(int(end * 20) + 1):
        if i > 0:
            x, z = x + v / 20, z + 1 / 20
        a_new = b if i % 2 == 0 else a
        b_new = a + 10 if i % 6 == 0 else b
        a, b = a_new, b_new
        if i >= 10 and (i - 10) % 5 == 0:
            v, z = v + z, 0.0
        rows.append([a, b, x, v, z])
    return rows


@pytest.mark.parametrize("sizes", [1, 2, 60])
def test_several_rates(sizes):
    rates = fmu.Instance("Rates").initialize()
    expected = rates_by_hand(3.0)
    assert rates.get("a", "b") == expected[0][:2] == [2.0, 11.0]
    for i in range(sizes, 61, sizes):
        rates.step(i / 20 - rates.time)
        rates.time = i / 20
        assert rates.get("a", "b", "x", "v", "z") == pytest.approx(expected[i], abs=1e-12)


def test_a_body_on_the_ground_is_kicked():
    """From rest at 0.5 s it flies for 1 s; at 1.25 s, in flight, it receives the next impulse, and so on."""
    body = fmu.Instance("Kicked").initialize()
    body.step(0.4)
    assert body.get("h", "v") == pytest.approx([0.0, 0.0], abs=1e-14)
    h, v = 0.0, 5.0
    for k in range(1, 5):
        h, v = h + v * 0.75 - 5 * 0.75**2, 5.0
        body.step(0.5 + 0.75 * k - body.time)
        body.time = 0.5 + 0.75 * k
        assert body.get("h", "v") == pytest.approx([h, v], abs=1e-10)


@pytest.mark.parametrize("name", [name_of("taylor", 0.0), name_of("radau", 0.0), "Rates", "Kicked"])
def test_states_of_fmus_are_exact(name):
    """States saved within a period and at a sample give the same bits."""
    outputs = [variable.name for variable in fmu.description(name).modelVariables if variable.causality == "output"]
    instance = fmu.Instance(name).initialize()
    for first in (0.43, 0.5):
        instance.reset().initialize()
        instance.step(first)
        state = instance.fmu.getFMUstate()
        ends = []
        for _ in range(2):
            instance.fmu.setFMUstate(state)
            instance.time = first
            for _ in range(7):
                instance.step(0.31)
            ends.append(instance.get(*outputs))
        instance.free_state(state)
        assert ends[0] == ends[1]


@pytest.mark.parametrize("version", [2, 3])
def test_samples_are_time_events_in_model_exchange(version):
    path = fmu.archive("ServoRadau") if version == 2 else fmi3.archive("ServoRadau")
    rows = fmpy.simulate_fmu(str(path), fmi_type="ModelExchange", stop_time=2.95, step_size=0.1, output_interval=0.1, relative_tolerance=1e-10, output=NAMES)
    assert list(rows[-1])[1:] == pytest.approx(exact_servo(2.95), rel=1e-6, abs=1e-6)
    assert rows["k"][-1] == 30


def test_the_next_event_is_the_next_sample():
    rates = fmu.Instance("Rates", kind=FMU2Model).initialize()
    time, times = 0.0, []
    while time < 1.0:
        _, _, _, _, defined, time = rates.fmu.newDiscreteStates()
        rates.fmu.enterContinuousTimeMode()
        assert defined
        times.append(time)
        rates.fmu.setTime(time)
        rates.fmu.enterEventMode()
    assert times == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0], rel=1e-15)


def test_event_mode_of_steps():
    servo = fmi3.Instance("ServoTaylor", eventModeUsed=True, earlyReturnAllowed=True).initialize({"Ts": 0.1})
    times = []
    while servo.time < 1.0:
        _, _, changed, _, defined, following = servo.fmu.updateDiscreteStates()
        servo.fmu.enterStepMode()
        assert defined and not changed
        needed, _, early, time = servo.step(2.0)
        assert needed and early and time == following
        assert servo.get("k") == len(times) + 1
        times.append(time)
        servo.fmu.enterEventMode()
    assert times == [k * 0.1 for k in range(1, 11)]


@pytest.mark.parametrize("period", [0.0, -0.1, 1e-20])
def test_periods_that_are_none(period):
    servo = fmu.Instance("ServoTaylor")
    servo.fmu.setupExperiment(startTime=1.0)
    servo.set(Ts=period)
    servo.fmu.enterInitializationMode()
    with servo.fails(ERROR, 'a <sample> has every="Ts", which is .*; expected a period above 0'):
        servo.fmu.exitInitializationMode()
    servo.reset().initialize()
    servo.step(0.45)
    servo.set(Ts=period)
    with servo.fails(DISCARD, 'a <sample> has every="Ts", which is'):
        servo.step(0.5)


@pytest.mark.parametrize("text, message", [
    ('<sample every="0.1"/>', "a <sample> changes nothing; expected a <set> in it"),
    ('<sample every="-0.1"><set mode="m">1</set></sample>', "every of <sample> is -0.1 at the start values; expected a number above 0"),
    ('<sample every="x"><set mode="m">1</set></sample>', "every of <sample> cannot depend on coordinates, but 'x' does"),
    ('<sample every="l"><set mode="m">1</set></sample>', "unit mismatch: every has the unit m, expected s"),
    ('<sample every="0.1"><set mode="n">1</set></sample>', '<set mode="n">: there is no mode of this name'),
    ('<sample every="0.1"><set mode="m">der(v)</set></sample>', r"a <sample> cannot depend on accelerations, but this one does on 'der\(v\)'"),
    ('<sample><set mode="m">1</set></sample>', "<sample> needs the attribute 'every'"),
])  # fmt: skip
def test_errors(text, message, tmp_path):
    import re

    system = tmp_path / "system.xml"
    system.write_text(f'<system name="A"><parameter name="l" start="1" unit="m"/><coordinate name="x" velocity="v"/><particle mass="1" x="x"/><mode name="m"/>{text}</system>')
    result = fmu.lagc(system, "-o", tmp_path)
    assert result.returncode == 1 and re.search(message, result.stderr), result.stderr


def test_two_samples_that_set_the_same(tmp_path):
    fmu.build_systems("samples", {"Rivals": """
<system name="Rivals">
  <coordinate name="x" velocity="v"/>
  <mode name="m"/>
  <particle mass="1" x="x"/>
  <sample every="0.2" offset="0.2"><set mode="m">1</set></sample>
  <sample every="0.3" offset="0.3"><set mode="m">2</set></sample>
</system>"""})  # fmt: skip
    rivals = fmu.Instance("Rivals").initialize()
    with rivals.fails(DISCARD, 'the events number 1, every="0.2", and number 2, every="0.3", happen at once and both set \'m\''):
        rivals.step(1.0)


def test_many_runs_at_once():
    """Lanes with different periods agree with the closed form, also at the times of samples."""
    from ensemble_runs import ensemble

    periods, times = np.linspace(0.05, 0.3, 19), [0.3, 1.0, 2.95]
    values, needs_fmu = ensemble("ServoTaylor", ["Ts", "kp"], ["x", "v"], times).run(np.array([[period, 3.0] for period in periods]))
    assert not needs_fmu.any()
    exact = [[exact_servo(time, Ts=period)[:2] for time in times] for period in periods]
    np.testing.assert_allclose(values, exact, atol=1e-8)


@pytest.mark.parametrize("event, message", [
    ('when="time - n*Ts"', 'when="time - n\\*Ts" is 0 at the start and rises, away from 0; expected <sample every='),
    ('when="time - n*Ts" direction="rising"', "is 0 at the start and rises, away from 0"),
    ('when="time - 2"', 'when="time - 2" only rises; expected direction="rising"'),
    ('when="1 - time" direction="rising"', 'only falls; expected direction="falling"'),
    ('when="time + 1" direction="both"', "is 1 at the start and rises, away from 0"),
    ('when="time - 2" direction="rising"', None),
    ('when="2 - time"', None),
    ('when="time - 2" direction="both"', None),
    ('when="time - o"', None),
    ('when="x - time"', None),
    ('when="time &gt;= 0"', 'when="time >= 0" is true at the start, and does not become true later; expected <sample every='),
    ('when="time &gt;= n*Ts"', "is true at the start, and does not become true later"),
    ('when="not time &gt; 2"', "is true at the start"),
    ('when="time &lt; -1"', 'when="time < -1" is never true'),
    ('when="time &gt; 2 and time &lt; 1"', "is true at no time"),
    ('when="time &gt; 0"', None),
    ('when="time &gt; 1 and time &lt; 2"', None),
    ('when="time &lt; 1 or time &gt; 2"', None),
    ('when="time &gt;= o"', None),
    ('when="time &gt;= 0 and x &lt; 1"', None),
    ('when="x^2"', 'when="x\\^2" is never below 0, so that it does not pass 0; expected an expression that changes its sign'),
    ('when="abs(v)"', "is never below 0"),
    ('when="-exp(x) - x^2"', "is never above 0"),
    ('when="2 + sin(x)*cos(v)"', "is never below 0"),
    ('when="2*sin(x) - cos(v)"', None),
    ('when="x^2 - 1e-9"', None),
    ('when="x^3"', None),
    ('when="x^2*v"', None),
    ('when="sin(x) &gt; 2"', 'when="sin\\(x\\) > 2" is true at no time; expected a condition that becomes true'),
    ('when="abs(v) &lt; -1 or tanh(x) &gt; 1"', "is true at no time"),
    ('when="cos(x) &lt; 2"', "is true at all times"),
    ('when="cos(x) &lt; 2 and v &gt; 1"', None),
    ('when="abs(v) &gt; 1"', None),
    ('when="Ts &gt; 1"', None),
    ('when="x &lt; -100 and x &gt; 100"', "is true at no time"),
    ('when="x &gt; 1 and not x &gt; 0"', "is true at no time"),
    ('when="2*x - 3 &gt; 0 and x + 2 &lt; 3"', "is true at no time"),
    ('when="sin(x) &gt; 0.5 and sin(x) &lt; -0.5"', "is true at no time"),
    ('when="2*x - 2*v &gt; 2 and v - x &gt; 1"', "is true at no time"),
    ('when="x &gt;= 1 and x &lt;= 1 and x &gt; 1"', "is true at no time"),
    ('when="o and not o"', "is true at no time"),
    ('when="o &gt; 1.5 and not o"', "is true at no time"),
    ('when="flag and not flag"', "is true at no time"),
    ('when="x &gt; 1 or not x &gt; 1"', "is true at all times"),
    ('when="o or not o"', "is true at all times"),
    ('when="x &gt;= 1 and x &lt;= 1"', None),
    ('when="x &gt; 1 and x &lt; 2"', None),
    ('when="x &lt; -1 or x &gt; 1"', None),
    ('when="x &gt; Ts and x &lt; -Ts"', None),
    ('when="x &gt; 1 and v &lt; 1"', None),
    ('when="o &gt; 2.5 and o &lt; 3.5"', None),
    ('when="o - 5 &gt; 0"', None),
    ('when="o and not n"', None),
    ('when="flag and not o"', None),
    ('when="mod(time, Ts)"', "is never below 0, so that it does not pass 0; expected <sample every="),
    ('when="2 + 3*mod(x, 0.5)"', "is never below 0, .* expected an expression that changes its sign"),
    ('when="-mod(time, Ts)" direction="rising"', "is never above 0"),
    ('when="mod(time, -Ts)"', "is never above 0"),
    ('when="mod(time, Ts) - Ts/2"', None),
    ('when="mod(x, 0.5) - 0.25"', None),
    ('when="sign(x)"', None),
    ('when="t0 - time"', None),
    ('when="time &gt;= t0"', None),
    ('when="time - t0" direction="rising"', None),
    ('when="time - t0"', "only rises"),
    ('when="N*Ts - time"', None),
    ('when="n*t0 - time"', "is 0 at the start and falls, away from 0"),
    ('when="time - q" direction="rising"', None),
    ('when="time + Ts" direction="both"', "is 0.1 at the start and rises"),
    ('when="late - time"', None),
    ('when="time - late" direction="both"', None),
    ('when="time &gt; -late"', None),
    ('when="time &gt; 2 and not flag"', None),
    ('when="not flag and time &lt; 2"', None),
    ('when="t0*time - 1" direction="rising"', None),
    ('when="mod(time, t0)"', "keeps its sign, so that it does not pass 0"),
    ('when="mod(time, t0) + 1"', None),
    ('when="mod(time, Ts) + 1"', "is never below 0"),
])  # fmt: skip
def test_events_that_never_happen(event, message, tmp_path):
    """A mode that another event sets may make the event occur, and so may every value of a parameter within min and max."""
    import re

    system = tmp_path / "system.xml"
    system.write_text('<system name="A"><parameter name="Ts" start="0.1" min="0"/><parameter name="flag" type="Boolean" start="false"/><parameter name="t0" start="0"/><parameter name="N" type="Integer" start="0"/><parameter name="late" start="1" min="0.5" max="2"/><coordinate name="x" velocity="v"/><mode name="q" start="t0"/><mode name="n"/><mode name="o"/><particle mass="1" x="x"/>'
                      f'<event {event}><set mode="n">n + 1</set></event><event when="x - 1"><set mode="o">2</set></event></system>')  # fmt: skip
    messages = fmu.lagc(system, "-o", tmp_path).stderr
    assert re.search(f"the event never happens: .*{message}", messages) if message else "never happens" not in messages, messages


def test_a_sign_is_an_expression_that_passes_0(open_fmu):
    """By default an event is a falling zero, as of 1.5 - t at t = 1.5. A rising zero is none."""
    fmu.build_systems("samples-signs", {"SignTrigger": """<system name="SignTrigger">
  <coordinate name="x" velocity="v" unit="m" start="1.5" velocityStart="-1"/><particle mass="1" x="x"/><mode name="down"/><mode name="up"/>
  <event when="sign(x)"><set mode="down">down + 1</set></event>
  <event when="sign(x)" direction="rising"><set mode="up">up + 1</set></event>
</system>"""})  # fmt: skip
    instance = open_fmu("SignTrigger").initialize()
    instance.step(1.4)
    assert instance.get("down", "up") == [0.0, 0.0]
    instance.step(0.2)
    assert instance.get("down", "up") == [1.0, 0.0]


def test_a_negative_offset(open_fmu):
    """Of the times -0.25 s, 0.75 s, 1.75 s, ... those from the start time on count."""
    fmu.build_systems("samples-early", {"EarlySample": """<system name="EarlySample"><state name="z" rate="1"/><mode name="n"/><mode name="at"/>
  <sample every="1" offset="-0.25"><set mode="n">n + 1</set><set mode="at">z</set></sample></system>"""})
    instance = open_fmu("EarlySample").initialize()
    for time, count in ((0.7, 0), (0.8, 1), (1.7, 1), (1.8, 2)):
        instance.step(time - instance.time)
        assert instance.get("n", "at") == pytest.approx([count, [0, 0.75, 1.75][count]])
