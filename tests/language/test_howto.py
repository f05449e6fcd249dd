"""fmu/howto: every example builds and moves as its closed form says, every number agrees with that form, and commands exist."""

import re
import zipfile

import numpy as np
import pyarrow.parquet as parquet
import pytest
from fmpy.ssp.simulation import simulate_ssp
from scipy.linalg import expm
from scipy.optimize import brentq

import fmu
from closed_forms import pendulum_angle, pendulum_half_period
from examples import check_motion, check_numbers, examples_of, settings_of
from fmu import ROOT, build_systems
from motions import lagrange_fmu  # noqa: F401

PAGES = {path.stem: path.read_text() for path in sorted((ROOT / "fmu" / "howto").glob("*.md"))}
EXAMPLES = {name: text for page in PAGES.values() for name, text in examples_of(page).items()}
G = 9.81


def at_end(example, values):
    """A motion of which only the values at the end have a closed form."""
    stop = float(re.search(r'stopTime="([\d.]+)"', EXAMPLES[example]).group(1))
    return lambda t: values if t > stop - 1e-9 else {}


def clock_rate():
    """Small oscillations: sqrt(g (M l + m l/2)/J)."""
    M, m, length, R = 0.5, 0.1, 0.6, 0.08
    return np.sqrt(G * (M * length + m * length / 2) / (m * length**2 / 3 + M * (length**2 + R**2 / 2)))


def sampled_speed(t):
    k = int(t / 0.02 + 1e-9)
    at_sample, torque = 100 * (1 - 0.5**k), 50 * 0.5**k
    return {"omega": at_sample + torque / 0.02 * (t - 0.02 * k), "u": torque}


def oscillation(t, k=20.0, b=1.0):
    d, w = b / 2, np.sqrt(k - b * b / 4)
    return 0.3 * np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))


def curling(t):
    stop = min(t, 2 / (0.02 * G))
    return {"x": 2 * stop - 0.02 * G * stop**2 / 2, "v": 2 - 0.02 * G * stop}


GEAR = (6 - 40 / (10 * 0.8)) / (10 * 1e-3 + 0.5 / (10 * 0.8))  # acceleration of the load
BRAKE_STOP = (0.4 + 50 * 0.01) * 5 / (0.4 * 2000 * 0.1 - 50 * G * 0.1)


def brake(t):
    moving = min(t, BRAKE_STOP)
    held = t >= BRAKE_STOP
    return {"phi": 5 * moving * (1 - moving / (2 * BRAKE_STOP)), "omega": 5 * (1 - moving / BRAKE_STOP), "torque": 50 * G * 0.1 if held else 80.0}


TAUT, SWING, RATE = np.sqrt(8 / G), np.arccos(0.512), np.sqrt(G / 5)


def fall(t):
    """Free fall until the rope is taut, then a pendulum whose phase follows from its angle and amplitude."""
    if t < TAUT:
        return {"x": 3.0, "y": -G * t**2 / 2, "tension": 0.0}
    lead = brentq(lambda s: pendulum_angle(SWING, RATE, s) - np.arcsin(0.6), 0, pendulum_half_period(SWING, RATE) / 2, xtol=1e-14)
    angle = pendulum_angle(SWING, RATE, t - TAUT + lead)
    return {"x": 5 * np.sin(angle), "y": -5 * np.cos(angle), "tension": 80 * G * (3 * np.cos(angle) - 2 * np.cos(SWING))}


def freewheel(t):
    """Both gain 4 rad/s2, the motor alone 20 rad/s2."""
    motor = 4 * t if t < 1 else 4 - 20 * (t - 1) if t < 1.5 else -6 + 20 * (t - 1.5) if t < 2 else 4 * (t - 1)
    return {"wMotor": motor, "wWheel": 4 * t if t < 1 else 4.0 if t < 2 else 4 * (t - 1), "torque": 1.6 if t < 1 or t > 2 else 0.0}


DRAINED = np.sqrt(2 / G) * 0.5 / 0.02  # s


def draining(t):
    level = max(0.0, 1 - t / DRAINED) ** 2
    return {"h1": level, "h2": 1 - level, "flow": 0.02 * np.sqrt(2 * G * level)}


def tyre(t):
    J, R, V, C, sigma, M = 1.2, 0.3, 20, 60000, 0.4, 300
    rates = np.array([[0, -R * C / J, -M / J], [R / sigma, -V / sigma, 0], [0, 0, 0]])
    speed, slip, _ = expm(t * rates) @ [0, 0, 1]
    return {"omega": V / R + speed, "slip": slip, "F": C * slip}


def hanging_platform(t):
    angle = pendulum_angle(0.8, np.sqrt(G / 0.3), t)
    return {"a": angle, "b": 0.0, "c": angle}


def filling(step):
    """Levels from 0 to 5 s where each FMU uses the outputs of the previous step."""
    levels = [0.0, 2 * step]
    while len(levels) <= round(5 / step):
        levels.append(levels[-1] + 2 * step * (1 - levels[-2]))
    return np.array(levels)


def held_arm():
    """The position feedback carries the weight and the sliding friction."""
    return brentq(lambda q: 60 * (1 - q) - 2 * G * 0.3 * np.sin(q) - 0.5, 0, 1)


# Closed form of each example at any time, by variable name, and the largest error.
MOTIONS = {
    "HangingPlatform": (hanging_platform, 1e-6),
    "ClockPendulum": (lambda t: {"theta": pendulum_angle(0.5, clock_rate(), t)}, 1e-6),
    "SpeedControl": (sampled_speed, 1e-9),
    "Oscillator": (lambda t: {"x": oscillation(t)}, 1e-7),
    "Curling": (curling, 1e-10),
    "Slider": (lambda t: {"x": 0.1 * np.cos(2 * t)}, 1e-7),
    "Plant": (lambda t: {"h": 2 * np.exp(-t / 4)}, 1e-7),
    "LossyGear": (lambda t: {"b": GEAR * t**2 / 2, "a": 10 * GEAR * t**2 / 2, "teeth.force": (0.5 * GEAR + 40) / 10}, 1e-9),
    "HoistBrake": (brake, 1e-9),
    "Fall": (fall, 1e-3),
    "Freewheel": (freewheel, 1e-9),
    "TyreRig": (tyre, 1e-3),
    "DrainingTank": (draining, 1e-7),
    "Tank": (lambda t: {"h": 0.0}, 0.0),
    "LevelControl": (lambda t: {"q": 4.0}, 0.0),
    "OneArm": (lambda t: {"shoulder": 0.0}, 0.0),
    "HeldArm": (at_end("HeldArm", {"arm.shoulder": held_arm()}), 1e-6),
}
# The bold numbers of each page, in their order.
NUMBERS = {
    "close-a-loop": [2 * pendulum_half_period(0.8, np.sqrt(G / 0.3))],
    "draw-a-system": [2 * pendulum_half_period(0.5, clock_rate())],
    "sampled-controller": [50],
    "sweep-on-many-machines": [4 / (2 * 0.02 * G)],
    "import-into-fmpy": [pendulum_angle(0.5, np.sqrt(G / 0.5), 5)],
    "import-into-omsimulator": [2 * pendulum_half_period(0.5, np.sqrt(G / 0.5))],
    "import-into-casadi": [1.1],
    "integrate-into-cmake": [2 * np.exp(-2)],
    "gear-with-losses": [GEAR / 2, (2 - 1 / 0.8) * 4],
    "brake": [BRAKE_STOP, 50 * G * 0.1],
    "rope": [TAUT, SWING],
    "one-way-clutch": [1.6, 4, 8],
    "tyre": [-1000],
    "tanks": [DRAINED],
    "couple-by-ssp": [max(abs(filling(0.01) - 1 + np.exp(-0.02 * np.arange(501))))],
    "robot-from-urdf": [held_arm()],
}


@pytest.fixture(scope="module", autouse=True)
def examples():
    build_systems("howto", EXAMPLES, files={"HeldArm/onearm.urdf": EXAMPLES["OneArm"]})


def test_every_example_is_checked():
    assert set(MOTIONS) == set(EXAMPLES)


@pytest.mark.parametrize("name", MOTIONS)
def test_example_moves_by_its_closed_form(name, open_fmu):
    motion, allowed = MOTIONS[name]
    check_motion(open_fmu(name).initialize(), EXAMPLES[name], motion, allowed)


@pytest.mark.parametrize("page", PAGES)
def test_numbers_are_those_of_the_closed_forms(page):
    check_numbers(PAGES[page], NUMBERS.get(page, []))


@pytest.mark.parametrize("page", PAGES)
def test_page_is_short(page):
    """At most 500 words outside of examples."""
    assert len(re.sub(r"```.*?```", "", PAGES[page], flags=re.S).split()) <= 500


@pytest.mark.parametrize("page", PAGES)
def test_commands_name_variables_of_the_page(page):
    for name, words in re.findall(r"lagrange-fmu run (\w+)\.xml *([^`\n#]*)", PAGES[page]):
        if name in EXAMPLES:
            assert set(settings_of(words)) <= {variable.name for variable in fmu.description(name).modelVariables}, name


@pytest.mark.parametrize("step", [0.1, 0.01])
def test_coupled_by_ssp(step, tmp_path):
    structure = re.search(r"```ssd\n(.*?)```", PAGES["couple-by-ssp"], re.S).group(1)
    with zipfile.ZipFile(tmp_path / "Filling.ssp", "w") as archive:
        archive.writestr("SystemStructure.ssd", structure)
        for name in ("Tank", "LevelControl"):
            archive.write(fmu.archive(name), f"resources/{name}.fmu")
    result = simulate_ssp(str(tmp_path / "Filling.ssp"), stop_time=5, step_size=step)
    np.testing.assert_allclose(result["tank.h"], filling(step), rtol=0, atol=1e-9)


def test_overloaded_gear_and_brake(open_fmu):
    """The pages' statements on other torques and forces."""
    for torque, direction in [(4.5, 0), (3.01, 0), (2.99, -1)]:
        gear = open_fmu("LossyGear").initialize({"tau": torque})
        gear.step(1)
        assert gear.get("b") == pytest.approx(0, abs=1e-12) if direction == 0 else gear.get("b") < 0, torque
    hoist = open_fmu("HoistBrake").initialize({"F": 1000})
    hoist.step(2)
    assert hoist.get("omega") == pytest.approx(5 + (50 * G * 0.1 - 40) / 0.9 * 2, rel=1e-9)


@pytest.mark.parametrize("force", ["F", "max(0, F)", "abs(F)"])
def test_brake_released_by_a_ramp(force, open_fmu):
    """The input may fall to 0 within steps, where rounding brings it below."""
    text = EXAMPLES["HoistBrake"].replace("HoistBrake", "RampedBrake").replace("mu*F*R", f"mu*{force}*R").replace("muRest*F", f"muRest*{force}")
    build_systems("howto-ramp", {"RampedBrake": text})
    hoist = open_fmu("RampedBrake").initialize({"F": 2000})
    hoist.step(0.3)
    hoist.fmu.setRealInputDerivatives(hoist.vr("F"), [1], [-2500])
    hoist.step(0.8)
    hoist.set(F=0)
    hoist.step(0.9)
    # It slips from F = m g/muRest on, which is when the rest of the ramp begins.
    slips, rate, ends = 0.3 + (2000 - 50 * G / 0.45) / 2500, 50 * G * 0.1, 1.1
    braking = 0.4 * 0.1 * (2000 * (ends - slips) - 2500 * ((ends - 0.3) ** 2 - (slips - 0.3) ** 2) / 2)
    assert hoist.get("omega") == pytest.approx((rate * (2 - slips) - braking) / 0.9, rel=1e-4)


def test_jacobian_in_casadi():
    casadi = pytest.importorskip("casadi")
    builder = casadi.DaeBuilder("slider", str(fmu.unpacked("Slider")), {})
    function = builder.create("f", ["x", "u"], ["ode"])
    assert np.array(function([0.1, 0], [3])).ravel() == pytest.approx([0, 1.1], abs=1e-14)
    by_states, by_inputs = function.factory("J", ["x", "u"], ["jac:ode:x", "jac:ode:u"])([0.1, 0], [3])
    assert np.array(by_states.full()) == pytest.approx(np.array([[0, 1], [-4, 0]])) and by_inputs.full().ravel() == pytest.approx([0, 0.5])


def test_fit(lagrange_fmu, tmp_path, monkeypatch):  # noqa: F811
    """The data of the page give the values that it shows, which are near the true ones."""
    monkeypatch.chdir(tmp_path)
    page = PAGES["fit-data"]
    exec(re.search(r"```python\n(.*?)```", page, re.S).group(1), {})
    found = lagrange_fmu.fit(fmu.archive("Oscillator"), "data.csv", ["k", "b"])
    shown = {name: (float(value), float(deviation)) for name, value, deviation in re.findall(r"^    (\w)  (\S+) \+- (\S+)$", page, re.M)}
    for name, true in (("k", 25.0), ("b", 2.0)):
        value, deviation = shown[name]
        assert found.values[name] == pytest.approx(value, rel=1e-6)
        assert abs(value - true) < 2 * deviation


def test_sweep(lagrange_fmu, tmp_path, monkeypatch):  # noqa: F811
    """Every stone that stops within the run has gone v^2/(2 mu g)."""
    monkeypatch.chdir(tmp_path)
    records = lagrange_fmu.sweep(fmu.archive("Curling"), {"mu": (0.01, 0.03, 5), "v": [1, 2, 3]}, record=["x@end", "ice.events"])
    table = parquet.read_table(records).to_pydict()
    assert len(table["run"]) == 15
    for mu, v, x, events in zip(table["mu"], table["v"], table["x@end"], table["ice.events"], strict=True):
        if events:
            assert x == pytest.approx(v**2 / (2 * mu * G), rel=1e-9)


def texts_of_sources():
    """Texts of the sources of compiler, runtime and scripts, which contain all messages, with adjacent literals joined."""
    files = [path for folder in ("src", "scripts", "modelDescription") for kind in ("*.c", "*.h", "*.py") for path in (ROOT / folder).rglob(kind)]
    joined = re.sub(r'"\s*\n\s*"', "", "\n".join(path.read_text(errors="replace") for path in files))
    return joined.replace('\\"', '"')


def test_messages_of_the_faq_are_those_of_the_sources():
    texts = texts_of_sources()
    page = (ROOT / "fmu" / "FAQ.md").read_text()
    messages = re.findall(r"^\| `(.*?)` \|", page, re.M)
    assert len(messages) >= 25
    for message in messages:
        for part in message.split("..."):
            assert part.strip() in texts, message


def test_glossary_has_one_sentence_each():
    terms = re.findall(r"^- \*\*.*$", (ROOT / "fmu" / "GLOSSARY.md").read_text(), re.M)
    assert len(terms) >= 40
    for term in terms:
        assert term.endswith(".") and not re.search(r"[a-z]\. [A-Z]", term), term
