"""Sticking bodies have a velocity of exactly 0 in all expressions; and friction whose limits depend on direction."""

import fmpy
import numpy as np
import pytest

import fmi3
import fmu
from ensemble_runs import ensemble
from fmu import build_systems, lagc

pytestmark = pytest.mark.long

METHODS = ["taylor", "erk", "bdf", "radau", "auto"]
RATIOS = {"2": 2, "3": 3, "4": 4, "5": 5, "7": 7, "0.7": 0.7, "1.5": 1.5, "sqrt(2)": 2**0.5}
GEAR = """<system name="{name}">
  <parameter name="push" start="2"/>
  <coordinate name="a" velocity="w1" unit="rad" velocityStart="1"/>
  <coordinate name="b" velocity="w2" unit="rad"/>
  <kinetic>w1^2/2 + 1.5*w2^2/2</kinetic>
  <constraint name="gear" unit="rad">a - {ratio}*b</constraint>
  <friction name="rub" {rub}/>
  <force coordinate="a">if(time &lt; 1, 0, -push*(time - 1))</force>
  <output name="sign1">sign(w1)</output><output name="sign2">sign(w2)</output>
  <output name="size2">abs(w2)</output><output name="above">if(w2 > 0, 1, 0)</output><output name="seen">w2</output>
  <output name="direction">atan2(w1, w2)</output>
  <solver method="{method}" tolerance="1e-9"/>
</system>
"""
# Friction, its limit at rest, and its force while it slides back.
LAWS = {
    "If": ('coordinate="a" force="if(w1 > 0, 4, 1)"', 1, 1),
    "Sign": ('coordinate="a" force="2.5 + 1.5*sign(w1)"', 2.5, 1),
    "Geared": ('coordinate="a" force="2.5 + 1.5*sign(w2)"', 2.5, 1),
    "Along": ('velocity="2*w1" force="1.25 + 0.75*sign(w1)"', 2.5, 1),
    "Plane": ('velocity="0.6*w1" across="0.8*w1" force="2.5 + 1.5*sign(w1)"', 2.5, 1),
    "Back": ('coordinate="a" force="4" forceBack="1"', 1, 1),
    "Stiction": ('coordinate="a" force="4" forceBack="1" stictionBack="2.5"', 2.5, 1),
}
# A block on a belt that accelerates to and fro; the limit is 4 if the block is faster, and 1 otherwise.
BELT = """<system name="Belt">
  <coordinate name="x" velocity="v"/>
  <particle mass="1" x="x"/>
  <define name="slip">v - 0.5*sin(2*time)</define>
  <friction name="rub" velocity="slip" force="2.5 + 1.5*sign(slip)"/>
  <output name="s">sign(slip)</output>
</system>
"""
# A block pushed to and fro: its limits are 4 and 0.5 while it slides, or 5 and 2 while it sticks.
SHAKEN = """<system name="Shaken{name}">
  <parameter name="forth" start="4"/><parameter name="back" start="0.5"/>
  <coordinate name="x" velocity="v"/>
  <particle mass="2" x="x"/>
  <friction name="rub" coordinate="x" force="forth" forceBack="back" {further}/>
  <force coordinate="x">8*sin(3*time)</force>
</system>
"""
# A worm drive: the friction of its teeth is proportional to their force, with different factors by direction.
TEETH = """<system name="Teeth">
  <coordinate name="a" velocity="w1" velocityStart="{speed}"/><coordinate name="b" velocity="w2" velocityStart="{speed}"/>
  <kinetic>w1^2/2 + w2^2/2</kinetic>
  <constraint name="gear">a - b</constraint>
  <force coordinate="b">-2</force>
  <friction name="rub" coordinate="a" force="0.5*abs(gear.force)" forceBack="0.25*abs(gear.force)"/>
</system>
"""


def gear_name(ratio, law, method="taylor"):
    return f"Gear{list(RATIOS).index(ratio)}{law}{method.title()}"


def gear_text(ratio, law, method="taylor"):
    return GEAR.format(name=gear_name(ratio, law, method), ratio=ratio, rub=LAWS[law][0], method=method)


@pytest.fixture(scope="module", autouse=True)
def built():
    texts = {gear_name(ratio, law): gear_text(ratio, law) for ratio in RATIOS for law in ("If", "Sign")}
    texts |= {gear_name("3", law, method): gear_text("3", law, method) for law in LAWS for method in METHODS}
    build_systems("sticking", texts | {"Belt": BELT, "Shaken": SHAKEN.format(name="", further=""),
                                       "ShakenHeld": SHAKEN.format(name="Held", further='stiction="5" stictionBack="2"')})  # fmt: skip
    build_systems("sticking-fmi3", {"Sticking3": gear_text("3", "Sign").replace(gear_name("3", "Sign"), "Sticking3")}, versions=[3])


def velocity_of_gear(ratio, law, time):
    """Velocity after the slip, when 2 (t - 1) exceeds the limit at rest, against the force of sliding back."""
    _, stiction, force = LAWS[law]
    slip = 1 + stiction / 2
    impulse = (time - 1) ** 2 - (slip - 1) ** 2 - force * (time - slip)
    return -max(impulse, 0) / (1 + 1.5 / RATIOS[ratio] ** 2)


def check_rest(instance):
    assert instance.get("sign1", "sign2", "size2", "above", "seen", "direction") == [0] * 6


@pytest.mark.parametrize("law", ["If", "Sign"])
@pytest.mark.parametrize("ratio", RATIOS)
def test_a_limit_at_rest_is_that_of_velocity_0(open_fmu, ratio, law):
    instance = open_fmu(gear_name(ratio, law)).initialize()
    for _ in range(14):
        instance.step(0.1)
        if instance.time > 0.8:
            check_rest(instance)
    instance.run(3, 0.1, "w1")
    assert instance.get("w1") == pytest.approx(velocity_of_gear(ratio, law, 3), abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("law", LAWS)
def test_by_each_method_and_in_model_exchange(open_fmu, law, method):
    name = gear_name("3", law, method)
    instance = open_fmu(name).initialize()
    instance.run(1.4, 0.1, "w1")
    check_rest(instance)
    instance.run(3, 0.1, "w1")
    assert instance.get("w1") == pytest.approx(velocity_of_gear("3", law, 3), abs=1e-7)
    outputs = ["w1", "sign1", "sign2", "size2", "above", "direction"]
    rows = fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type="ModelExchange", stop_time=3, output_interval=0.1, relative_tolerance=1e-9,
                             output=outputs)  # fmt: skip
    rest = rows[(rows["time"] > 0.9) & (rows["time"] < 1.4)]
    assert len(rest) > 3 and all(not np.any(rest[output]) for output in outputs[1:])
    assert rows["w1"][-1] == pytest.approx(velocity_of_gear("3", law, 3), abs=1e-6)


def test_in_fmi_3():
    for kind in ("CoSimulation", "ModelExchange"):
        rows = fmpy.simulate_fmu(str(fmi3.archive("Sticking3")), fmi_type=kind, stop_time=3, output_interval=0.1, output=["w1", "sign2"])
        assert not np.any(rows["sign2"][(rows["time"] > 0.9) & (rows["time"] < 2.2)])
        assert rows["w1"][-1] == pytest.approx(velocity_of_gear("3", "Sign", 3), abs=1e-4)


def test_in_ensembles():
    """Slip starts later for a smaller push."""
    forces = np.linspace(1.5, 2.5, 5)
    values, _ = ensemble(gear_name("3", "Sign"), ["push"], ["w1", "sign2"], [2.0, 4.0]).run([[push] for push in forces])
    assert not np.any(values[:, 0, 1])
    for push, (velocity, sign) in zip(forces, values[:, 1]):
        slip = 1 + 2.5 / push
        expected = push / 2 * (9 - (slip - 1) ** 2) - (4 - slip)
        assert (velocity, sign) == pytest.approx((-expected / (1 + 1.5 / 9), -1), abs=1e-9)


def test_sticking_velocities_have_no_derivatives(open_fmu):
    instance = open_fmu(gear_name("3", "Sign")).initialize()
    instance.run(1.4, 0.1, "w1")
    assert instance.fmu.getDirectionalDerivative(instance.vr("size2", "seen"), instance.vr("w1"), [1.0]) == [0, 0]


def test_a_belt(open_fmu):
    """The belt carries the block, since its acceleration is at most 1; at rest on it the friction holds up to 2.5."""
    instance = open_fmu("Belt").initialize()
    for time, _, sign, force in instance.run(5, 0.05, "v", "s", "rub.force"):
        assert sign == 0 and force == pytest.approx(-np.cos(2 * time), abs=1e-12)


def shaken(limits, end):
    """v by small steps of the closed forms between stopping and slipping, under the force 8 sin(3 t)."""
    forth, back, stick_forth, stick_back = limits
    times = np.linspace(0, end, 200001)
    v, mode, step = np.zeros_like(times), 0, times[1]
    for i, time in enumerate(times[:-1]):
        push = 8 * np.sin(3 * (time + step / 2))
        if mode == 0:
            mode = 1 if push > stick_forth else -1 if push < -stick_back else 0
        rate = (push - forth if mode > 0 else push + back if mode < 0 else 0) / 2
        v[i + 1] = v[i] + step * rate
        if mode * v[i + 1] < 0:
            v[i + 1], mode = 0, 0
    return times, v


@pytest.mark.parametrize("name, limits", [("Shaken", (4, 0.5, 4, 0.5)), ("ShakenHeld", (4, 0.5, 5, 2))])
def test_limits_by_direction(open_fmu, name, limits):
    times, expected = shaken(limits, 4)
    instance = open_fmu(name).initialize()
    for _ in range(80):
        instance.step(0.05)
        (v, force), time = instance.get("v", "rub.force"), instance.time
        assert v == pytest.approx(np.interp(time, times, expected), abs=2e-4)
        sliding = instance.fmu.getInteger(instance.vr("rub.sliding"))[0]
        assert force == pytest.approx({1: limits[0], -1: -limits[1], 0: 8 * np.sin(3 * time)}[sliding], abs=1e-9)
    rows = fmpy.simulate_fmu(str(fmu.archive(name)), fmi_type="ModelExchange", stop_time=4, output_interval=0.05, output=["v"])
    np.testing.assert_allclose(rows["v"], np.interp(rows["time"], times, expected), atol=5e-4)


@pytest.mark.parametrize("speed", [1, -1])
def test_limits_by_direction_that_follow_from_a_constraint(open_fmu, speed):
    """For the teeth: a' = -rub + N, b' = -2 - N with a' = b', where the friction is mu |N| against the velocity."""
    name = "TeethForth" if speed > 0 else "TeethBack"
    build_systems(f"sticking-{name}", {name: TEETH.format(speed=speed).replace('"Teeth"', f'"{name}"')})
    instance = open_fmu(name).initialize()
    push = 0.5 if speed > 0 else -0.25
    # N - push |N| = -2 - N with N < 0.
    force = -2 / (2 + push)
    instance.run(0.1, 0.1, "w1")
    assert instance.get("w1") == pytest.approx(speed + 0.1 * (-2 - force), abs=1e-12)
    assert instance.get("rub.force") == pytest.approx(push * abs(force), abs=1e-12)


@pytest.mark.parametrize("words, message", [
    ('coordinate="x" force="mu*m*g" forceBack="m"', "unit mismatch: forceBack has the unit kg, expected kg.m/s2"),
    ('coordinate="x" force="mu*m*g" stictionBack="m"', "unit mismatch: stictionBack has the unit kg, expected kg.m/s2"),
    ('coordinate="x" force="mu*m*g" forceBack="m*der(v)"', "the forceBack of a friction depends on 'der(v)'"),
    ('coordinate="x" force="mu*ground.force" forceBack="2*mu*ground.force"', "a <friction> has forceBack, but follows from the force of a contact"),
    ('velocity="v" across="w" force="mu*m*g" stictionBack="m*g"', "a <friction> has both across and stictionBack"),
])  # fmt: skip
def test_errors(tmp_path, words, message):
    path = tmp_path / "system.xml"
    path.write_text(f"""<system name="S">
  <parameter name="m" start="1" unit="kg"/><parameter name="g" start="9.81" unit="m/s2"/><parameter name="mu" start="0.5" unit="1"/>
  <coordinate name="x" velocity="v" unit="m"/><coordinate name="y" velocity="w" unit="m"/><particle mass="m" x="x" y="y"/>
  <potential>m*g*y</potential><contact name="ground" gap="y" unit="m"/>
  <friction name="rub" {words}/>
</system>""")
    result = lagc(path, "-o", tmp_path)
    assert result.returncode == 1 and f"system.xml:5: {message}" in result.stderr
