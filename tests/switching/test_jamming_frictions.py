"""
Worm gears whose friction is proportional to the force of the gear: jamming, where the message names both elements, and Painleve's paradox.
"""

import fmpy
import pytest
from fmpy.fmi1 import FMICallException

import fmu
from fmu import build_systems

# With f = -gear.force, w > 0 and U on the worm: worm*w' = U + f - c |f|, and wheel*w'/10 = -10 f. So k f - c |f| = -U with k = 1 + 100
# worm/wheel. For U < 0 and c >= k there is no solution, since the left side is then never positive.
WORM = """<system name="{name}">
  <coordinate name="a" velocity="w" unit="rad" velocityStart="1"/><coordinate name="b" velocity="v" unit="rad" velocityStart="0.1"/>
  <kinetic>{worm}*w^2/2 + v^2/2</kinetic>
  <constraint name="gear" unit="rad">a - 10*b</constraint>
  <friction name="teeth" coordinate="a" force="2*abs(gear.force)"/>
  <force coordinate="a">{load}</force>
  <solver method="{method}"/>
</system>
"""
AT_ONCE, LATER = "-24", "if(time &lt; 0.5, 0, -24)"
JAMS = {
    "WormAtOnce": (0.001, AT_ONCE, "taylor"),
    "WormLocks": (0.01, AT_ONCE, "taylor"),  # c = k: singular equations
    "WormLater": (0.001, LATER, "taylor"),
    "WormLocksLater": (0.01, LATER, "bdf"),
    "WormRadau": (0.001, LATER, "radau"),
}
# k = 3: while w > 0, f = 24/(k - c) = 24, and w' = -100 f stops w = 1 after 1/2400 s; then the gear reverses with f = 24/(k + c).
TURNS = (0.02, AT_ONCE, "taylor")
# From rest. Forward motion has no solution f, as above, and sticking with f = 0 balances no load. Backward motion requires k f + c |f| =
# 24: f = 24/(k + c) continues backwards, f = -24/(c - k) does not. So each k has one motion. A gear that already moves backwards may
# continue with either.
AT_REST = {
    f"WormRest{number}{method.title()}": (worm, load, method)
    for number, (worm, load) in enumerate([(0.001, AT_ONCE), (0.02, AT_ONCE), (0.001, LATER), (0.001, "-24*time")])
    for method in ("taylor", "radau")
}

# k = 3, c = 1 + 4 t: f = 1/(k - c) grows up to 0.5 s. Until then w > 0 has lost 100 times its integral, a few hundred at most.
GROWS = WORM.replace("{worm}", "0.02").replace("2*abs", "(1 + 4*time)*abs").replace("{load}", "-1").replace('="1"', '="5000"').replace('="0.1"', '="500"')


@pytest.fixture(scope="module", autouse=True)
def built():
    systems = JAMS | {"WormTurns": TURNS}
    texts = {name: WORM.format(name=name, worm=worm, load=load, method=method) for name, (worm, load, method) in systems.items()}
    for name, (worm, load, method) in AT_REST.items():
        texts[name] = WORM.format(name=name, worm=worm, load=load, method=method).replace('velocityStart="1"', "").replace('velocityStart="0.1"', "")
    texts["WormBack"] = WORM.format(name="WormBack", worm=0.001, load=AT_ONCE, method="taylor").replace('velocityStart="', 'velocityStart="-')
    for method in ("taylor", "radau", "bdf"):
        texts[f"WormGrows{method.title()}"] = GROWS.format(name=f"WormGrows{method.title()}", method=method)
    build_systems("jamming-frictions", texts)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", JAMS)
def test_a_worm_that_jams(name, kind):
    messages = []
    log = lambda *words: messages.append(words[-1].decode())
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(str(fmu.archive(name)), stop_time=1, output_interval=0.1, fmi_type=kind, logger=log)
    time = 0 if JAMS[name][1] == AT_ONCE else 0.5
    expected = f"time {time}: the force of the constraint 'gear' has no solution, as the friction 'teeth', which follows from it, slides"
    found = [message for message in messages if message.startswith(expected)]
    assert found and found[0].endswith("both jam each other (Painleve's paradox); expected less friction, or another load"), messages
    assert not any("mass matrix" in message or "in place of sign" in message for message in messages)


def test_a_worm_that_turns():
    result = fmpy.simulate_fmu(str(fmu.archive("WormTurns")), stop_time=1, output_interval=0.1, output=["w", "gear.force"])
    assert -result["gear.force"][1:] == pytest.approx(24 / 5, abs=1e-9)
    assert result["w"][-1] == pytest.approx(-100 * 24 / 5 * (1 - 1 / 2400), rel=1e-9)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", AT_REST)
def test_a_worm_at_rest_slides_back(name, kind):
    worm, load, _ = AT_REST[name]
    result = fmpy.simulate_fmu(str(fmu.archive(name)), stop_time=1, output_interval=0.1, fmi_type=kind, output=["w", "gear.force"])
    force = 24 / (1 + 100 * worm + 2)
    impulse = 1 if load == AT_ONCE else 0.5
    assert (-result["gear.force"][-1], result["w"][-1]) == pytest.approx((force, -100 * force * impulse), rel=1e-4 if kind == "ModelExchange" else 1e-8)


def test_a_worm_with_two_motions():
    messages = []
    log = lambda *words: messages.append(words[-1].decode())
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(str(fmu.archive("WormBack")), stop_time=1, output_interval=0.1, logger=log)
    assert any(m.startswith("time 0: the friction 'teeth', whose force follows from constraint forces, can stick or slide in more than one way") for m in messages), messages
    assert not any("no solution" in message for message in messages)


@pytest.mark.parametrize("method", ["Taylor", "Radau", "Bdf"])
def test_a_worm_that_jams_on_its_way(open_fmu, method):
    instance = open_fmu(f"WormGrows{method}").initialize()
    with instance.fails(fmu.DISCARD, "the force of the constraint 'gear' has no solution, as the friction 'teeth', .* jam each other"):
        instance.step(1.0)
    text = next(text for _, _, text in instance.messages if "jam each other" in text)
    assert float(text.split()[1][:-1]) == pytest.approx(0.5, abs=1e-4)
