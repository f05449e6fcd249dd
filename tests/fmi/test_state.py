"""Saved states: repeated steps give the same bits, also in another process, and damaged bytes are an error."""

import json
import random
import struct
import subprocess
import sys
from ctypes import byref, c_char_p, c_size_t, c_void_p

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model

import fmu
from closed_forms import pendulum_angle
from fmu import ERROR, ROOT, build_systems

# The systems of tests/systems have the method erk.
ONE_STEP = [name for name in [*fmu.all_names(), "BeadOnHoop", "TwoCarts"] if name != "Rope"]


def change(instance, name, i):
    """Change an input, its derivative, or a parameter before step i, as an importer may."""
    inputs, parameter = fmu.names_of(name, "input"), fmu.names_of(name, "parameter")[0]
    if inputs and i % 3 == 0:
        instance.set({inputs[0]: np.sin(i) / 10})
    if inputs and instance.description.coSimulation.canInterpolateInputs and i % 4 == 1:
        instance.fmu.setRealInputDerivatives(instance.vr(inputs[0]), [1], [0.3])
    if i % 5 == 3:
        instance.set({parameter: instance.get(parameter) * (1.1 if i % 2 else 0.9)})


def drive(instance, name, steps):
    """Take uneven steps with changes; return all variables at each."""
    rows = []
    # Statistics are omitted, since they also count steps that were undone.
    names = [v.name for v in instance.description.modelVariables if v.type == "Real"]
    for i in range(steps):
        change(instance, name, i)
        instance.step(0.013 * (1 + i % 3))
        rows.append(instance.fmu.getReal(instance.vr(*names)))
    return rows


@pytest.mark.parametrize("name", ONE_STEP)
def test_restored_states_give_the_same_bits(name, open_fmu):
    instance = open_fmu(name).initialize(tolerance=1e-6)
    drive(instance, name, 7)
    state, time = instance.fmu.getFMUstate(), instance.time
    first = drive(instance, name, 12)
    for _ in range(3):
        instance.fmu.setFMUstate(state)
        instance.time = time
        assert drive(instance, name, 12) == first
    instance.free_state(state)


def test_bdf_continues_within_tolerance(open_fmu):
    name, tolerance = "FurutaPendulum", 1e-7
    instance = open_fmu(name).initialize(tolerance=tolerance)
    drive(instance, name, 7)
    state, time = instance.fmu.getFMUstate(), instance.time
    first = np.array(drive(instance, name, 12))
    instance.fmu.setFMUstate(state)
    instance.time = time
    again = np.array(drive(instance, name, 12))
    states = [i for i, v in enumerate(instance.description.modelVariables) if v.name in fmu.states_of(name)]
    np.testing.assert_allclose(again[:, states], first[:, states], atol=100 * tolerance, rtol=100 * tolerance)
    page = (fmu.unpacked(name) / "documentation" / "index.html").read_text()
    assert "within the tolerance, not bit by bit" in page
    instance.free_state(state)


CONTINUE = """
import json, sys
sys.path[:0] = {folders!r}
import fmu, test_state

def continue_from(name, time, data):
    instance = fmu.Instance(name)
    state = instance.fmu.deSerializeFMUstate(bytes.fromhex(data))
    instance.fmu.setFMUstate(state)
    instance.time = time
    return test_state.drive(instance, name, 10)

print(json.dumps([continue_from(*saved) for saved in json.loads(sys.stdin.read())]))
"""


def test_another_process_continues(open_fmu):
    """The bytes contain parameters, inputs and their derivatives, tolerance and step size."""
    saved, here = [], []
    for name in ("SimplePendulum", "ParticleCartesian", "InvertedPendulumCart", "StateFeedback", "TwoCarts"):
        instance = open_fmu(name)
        parameter = fmu.names_of(name, "parameter")[0]
        instance.initialize({parameter: 1.7}, tolerance=1e-5)
        drive(instance, name, 6)
        saved.append([name, instance.time, serialized(instance).hex()])
        here.append(drive(instance, name, 10))
    program = CONTINUE.format(folders=[str(ROOT / "tests" / room) for room in ("support", "fmi")])
    there = subprocess.run([sys.executable, "-c", program], input=json.dumps(saved), capture_output=True, text=True)
    assert there.returncode == 0, there.stderr
    assert json.loads(there.stdout) == here


def test_state_is_complete(open_fmu):
    """A restored state includes parameters, inputs and the status, even after an error, and continues with the same bits."""
    values = dict(b=0.3, tau=0.1)
    stayed, instance = (open_fmu("DampedPendulum").initialize(values) for _ in range(2))
    stayed.step(0.1)
    stayed.step(0.1)
    instance.step(0.1)
    state = instance.fmu.getFMUstate()
    before = instance.get("theta", "omega", "b", "tau", "nonConservativeWork")
    instance.set(b=2.0, tau=-1)
    instance.step(0.1)
    with instance.fails(ERROR, "unknown"):
        instance.fmu.getReal([9999])
    instance.fmu.setFMUstate(state)
    assert instance.get("theta", "omega", "b", "tau", "nonConservativeWork") == before
    instance.time = 0.1
    instance.step(0.1)
    names = [v.name for v in instance.description.modelVariables if v.type == "Real"]
    assert instance.get(*names) == stayed.get(*names)
    instance.free_state(state)


@pytest.mark.parametrize("name", ["SimplePendulum", "SimplePendulumLinear"])
def test_restored_parameters_count(name, open_fmu):
    """Values computed from parameters are restored too, before a step and within one: der(omega) and the closed forms."""
    instance = open_fmu(name).initialize(dict(theta=0.5, omega=0.0, l=2.0), tolerance=1e-10)
    state = instance.fmu.getFMUstate()
    linear = name.endswith("Linear")
    instance.set(l=0.5)
    assert instance.get("der(omega)") == pytest.approx(-9.81 / 0.5 * (0.5 if linear else np.sin(0.5)), rel=1e-15)
    instance.step(0.6)
    instance.get("der(omega)")
    instance.fmu.setFMUstate(state)
    assert instance.get("der(omega)") == pytest.approx(-9.81 / 2 * (0.5 if linear else np.sin(0.5)), rel=1e-15)
    instance.time, rate = 0.0, np.sqrt(9.81 / 2)
    for i in range(1, 10):
        instance.step(0.6)
        angle = 0.5 * np.cos(rate * 0.6 * i) if linear else pendulum_angle(0.5, rate, 0.6 * i)
        assert instance.get("theta") == pytest.approx(angle, abs=1e-8)
    instance.free_state(state)


@pytest.mark.parametrize("name", [*fmu.moving_names(), "FurutaPendulum"])
def test_a_parameter_counts_from_the_next_step_on(name, open_fmu):
    """Constants computed for the old parameter are updated: the motion is that of a new instance with the same values."""
    if fmu.is_constrained(name):
        pytest.skip("lengths that are tuned move the state: tests/mechanics/test_constraints.py")
    if name in ("DigitalServo", "HalfCar"):
        pytest.skip("what its modes hold and when it samples are no states that a new instance could start with")
    instance, fresh = open_fmu(name).initialize(tolerance=1e-9), open_fmu(name)
    instance.step(0.01)
    parameters, states = fmu.names_of(name, "parameter"), fmu.states_of(name)
    instance.set({parameter: (1.1 + 0.1 * i) * instance.get(parameter) for i, parameter in enumerate(parameters)})
    names = [*states, *parameters]
    fresh.initialize({key: instance.get(key) for key in names if key != "nonConservativeWork"}, tolerance=1e-9, start_time=0.01)
    work = instance.get("nonConservativeWork") if "nonConservativeWork" in states else 0.0
    for one in (instance, fresh):
        one.step(0.2)
    for key in states:
        before = work if key == "nonConservativeWork" else 0.0
        assert instance.get(key) - before == pytest.approx(fresh.get(key), abs=1e-6, rel=1e-6)


def test_a_state_is_used_again(open_fmu):
    """fmi2GetFMUstate reuses a state that is not NULL; fmi2FreeFMUstate sets the pointer to NULL."""
    instance = open_fmu("SimplePendulum").initialize()
    component = c_void_p(instance.fmu.component)
    state = c_void_p()
    instance.fmu.fmi2GetFMUstate(component, byref(state))
    address = state.value
    instance.step(0.5)
    later = instance.get("theta")
    instance.fmu.fmi2GetFMUstate(component, byref(state))
    assert state.value == address
    instance.step(0.5)
    instance.fmu.setFMUstate(state)
    assert instance.get("theta") == later
    instance.fmu.fmi2FreeFMUstate(component, byref(state))
    assert state.value is None
    instance.fmu.fmi2FreeFMUstate(component, byref(state))


def serialized(instance):
    state = instance.fmu.getFMUstate()
    data = instance.fmu.serializeFMUstate(state)
    instance.free_state(state)
    return data


def test_every_flipped_bit_is_an_error(open_fmu):
    instance = open_fmu("SimplePendulum").initialize()
    data = serialized(instance)
    for i in range(len(data)):
        broken = bytearray(data)
        broken[i] ^= 1 << (i % 8)
        with instance.fails(ERROR, "fmi2DeSerializeFMUstate"):
            instance.fmu.deSerializeFMUstate(bytes(broken))
        instance.reset()


def test_truncated_and_foreign_bytes_are_errors(open_fmu):
    instance = open_fmu("SimplePendulum").initialize()
    data = serialized(instance)
    noise = random.Random(4)
    for wrong in (b"", data[:-1], data + b"\0", data[: len(data) // 2], noise.randbytes(len(data)), b"\0" * len(data)):
        with instance.fails(ERROR, "fmi2DeSerializeFMUstate"):
            instance.fmu.deSerializeFMUstate(wrong)
        instance.reset()
    other = serialized(open_fmu("DoublePendulum").initialize())
    with instance.fails(ERROR, "another model"):
        instance.fmu.deSerializeFMUstate(other)
    instance.reset()
    # A state saved for model exchange is for other modes.
    exchange = serialized(open_fmu("SimplePendulum", kind=FMU2Model).initialize())
    with instance.fails(ERROR, "other kind"):
        instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(exchange))


# --- Forged states with the right checksum ---

HEADER = 64  # bytes; the last eight are the checksum of the snapshot, which follows
# The snapshot begins with eight integers, the statistics, and the steps of an integrator. The update in event mode, a mark of redundant constraints,
# the statistics as reported, nine numbers, and values follow.
MODE, CHANGED, WAITING, STATISTICS, COMPLETED_STEPS, UPDATE = HEADER, HEADER + 20, HEADER + 24, HEADER + 32, HEADER + 80, HEADER + 88
REDUNDANT, TIME = HEADER + 96, HEADER + 152
NUMBERS = ["time", "start_time", "stop_time", "tolerance", "suggested_step", "last_start", "last_end", "searched", "switched"]
VALUES = TIME + 8 * len(NUMBERS)


def forged(data, form, place, value):
    """Return the bytes with another value at an offset, and the matching checksum, FNV-1a."""
    data = bytearray(data)
    struct.pack_into(form, data, place, value)
    checksum = 0xCBF29CE484222325
    for byte in data[HEADER:]:
        checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
    struct.pack_into("=Q", data, HEADER - 8, checksum)
    return bytes(data)


def place_of_saved(name):
    """Offset of the solver's own part."""
    count = {cause: len(fmu.names_of(name, cause)) for cause in ("input", "parameter")}
    return VALUES + 8 * (len(fmu.states_of(name)) + 4 * count["input"] + count["parameter"])


def test_forging_nothing_is_no_forgery(open_fmu):
    instance = open_fmu("SimplePendulum").initialize()
    instance.step(0.1)
    data = serialized(instance)
    time = struct.unpack_from("=d", data, TIME)[0]
    assert time == 0.1 and forged(data, "=d", TIME, time) == data
    assert instance.get("theta") == struct.unpack_from("=d", data, VALUES)[0]


FORGERIES = [("=i", MODE, mode) for mode in (-1, 2, 3, 8, 2**31 - 1)]
FORGERIES += [("=i", WAITING, number) for number in (-1, 1, 2**31 - 1)] + [("=i", WAITING + 4, number) for number in (-1, 1000)]
FORGERIES += [("=i", place, value) for place in range(HEADER + 8, WAITING, 4) for value in (-1, 4)]
FORGERIES += [("=q", UPDATE, -1), ("=q", UPDATE, 3), ("=q", REDUNDANT, -1), ("=q", REDUNDANT, 1), ("=q", COMPLETED_STEPS, -1), ("=q", STATISTICS, -1), ("=q", STATISTICS + 16, 2**63 - 1)]
FORGERIES += [("=d", TIME + 8 * i, value) for i in range(len(NUMBERS)) for value in (np.nan, np.inf)]
FORGERIES += [("=d", TIME + 8 * NUMBERS.index("tolerance"), value) for value in (0.0, -1e-6, 1.0)]
FORGERIES += [("=d", TIME + 8 * NUMBERS.index("suggested_step"), -1.0)]
FORGERIES += [("=d", TIME + 8 * NUMBERS.index(number), 1e3) for number in ("last_start", "searched")]


def rejects(instance, data, *forgery):
    with instance.fails(ERROR, "values that no instance can have saved"):
        instance.fmu.deSerializeFMUstate(forged(data, *forgery))
    instance.reset()


@pytest.mark.parametrize("name", ["SimplePendulum", "SimplePendulumLinear", "ElasticPendulum", "BeadOnHoop", "StateFeedback"])
def test_forged_states_are_errors(name, open_fmu):
    """Forged values are errors for every solver and every value of a state."""
    instance = open_fmu(name).initialize()
    instance.step(0.1)
    data = serialized(instance)
    parameter = VALUES + 8 * (len(fmu.states_of(name)) + len(fmu.names_of(name, "input")))
    places = [VALUES] * bool(fmu.states_of(name)) + [parameter]
    for forgery in FORGERIES + [("=d", place, value) for place in places for value in (np.nan, -np.inf)]:
        rejects(instance, data, *forgery)


def test_forged_modes_of_the_other_kind_are_errors(open_fmu):
    instance = open_fmu("SimplePendulum", kind=FMU2Model).initialize()
    data = serialized(instance)
    for mode in (4, 5):
        rejects(instance, data, "=i", MODE, mode)


def test_forged_series_are_errors(open_fmu):
    """The order counts coefficients; a forged one would index outside the series."""
    name = "SimplePendulum"
    instance = open_fmu(name).initialize()
    instance.step(0.1)
    data, saved = serialized(instance), place_of_saved(name)
    interval, order = struct.unpack_from("=dq", data, saved)
    assert 0 < interval < 10 and 4 <= order <= 22
    orders = [-(2**63), -1, 0, 1, 3, 23, 24, 10**6, 2**63 - 1]
    intervals = [np.nan, np.inf, -interval, 2 * interval]
    numbers = range(saved + 16, len(data), 8)  # rounding errors carried along, and the coefficients
    assert len(numbers) == 2 + 2 * 24
    forgeries = [("=q", saved + 8, value) for value in orders] + [("=d", saved, value) for value in intervals]
    for forgery in forgeries + [("=d", place, np.nan) for place in numbers]:
        rejects(instance, data, *forgery)


def test_forged_choices_are_errors(open_fmu):
    """The counters of the solver `auto`, at the end of the state: nine integers and eight numbers."""
    instance = open_fmu("ElasticPendulum").initialize()
    instance.step(0.1)
    data = serialized(instance)
    choice = len(data) - 8 * 17
    method, steps, restarts, windows, wait, wait_factor, stay, is_trial, crosses = range(choice, choice + 72, 8)
    for place in (steps, restarts, windows, wait, wait_factor, stay, is_trial, crosses):
        for value in (-1, 2**63 - 1):
            rejects(instance, data, "=q", place, value)
    forgeries = [(steps, 7), (is_trial, 2), (crosses, 2), (method, 2), (wait_factor, 10**6)]
    for forgery in forgeries:
        rejects(instance, data, "=q", *forgery)
    work, trial_work, predicted_step = choice + 80, choice + 96, choice + 104
    for place in (work, trial_work, predicted_step):
        for value in (np.nan, np.inf, -1.0):
            rejects(instance, data, "=d", place, value)
    for place in (work, trial_work):
        rejects(instance, data, "=d", place, 1e300)  # counts of operations beyond the range of integers
    large = forged(data, "=q", windows, 2**62 - 1)
    instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(large))
    instance.step(10.0)


def test_forged_modes_are_errors(open_fmu):
    """A mode must be a sign, or 0 or 1 for a contact."""
    for name in ("StickSlip", "BouncingBall"):
        instance = open_fmu(name).initialize()
        instance.step(0.1)
        data = serialized(instance)
        before = fmu.names_of(name, "input") + fmu.names_of(name, "parameter")
        first_mode = VALUES + 8 * (len(fmu.states_of(name)) + len(before))
        assert struct.unpack_from("=d", data, first_mode)[0] in (-1.0, 0.0, 1.0)
        for value in (0.5, 2.0, 1e300):
            rejects(instance, data, "=d", first_mode, value)


def test_forged_rounding_errors_are_errors(open_fmu):
    """The rounding errors of the state that the exact method carries along must be finite."""
    name = "SimplePendulumLinear"
    instance = open_fmu(name).initialize()
    instance.step(0.1)
    data, saved = serialized(instance), place_of_saved(name)
    assert len(data) == saved + 16
    for place in (saved, saved + 8):
        rejects(instance, data, "=d", place, np.inf)


@pytest.mark.parametrize("name", ["SimplePendulum", "SimplePendulumLinear", "ElasticPendulum", "BeadOnHoop"])
def test_statistics_do_not_overflow(name, open_fmu):
    """Statistics saturate at 2^31 - 1, which a long-lived instance reaches."""
    instance = open_fmu(name).initialize()
    instance.step(0.1)
    data = serialized(instance)
    state = instance.fmu.deSerializeFMUstate(forged(data, "=q", STATISTICS, 2**31 - 2))
    instance.fmu.setFMUstate(state)
    steps = [instance.fmu.getInteger(instance.vr("solverSteps"))[0]]
    for _ in range(20):
        instance.step(0.5)
        steps += instance.fmu.getInteger(instance.vr("solverSteps"))
    assert steps[0] == 2**31 - 2 and steps == sorted(steps) and steps[-1] == 2**31 - 1
    later = serialized(instance)
    assert struct.unpack_from("=q", later, STATISTICS)[0] > 2**31 - 1
    instance.free_state(state)


def test_serialize_with_a_wrong_size(open_fmu):
    instance = open_fmu("SimplePendulum").initialize()
    component = c_void_p(instance.fmu.component)
    state = instance.fmu.getFMUstate()
    size = c_size_t()
    instance.fmu.fmi2SerializedFMUstateSize(component, state, byref(size))
    for wrong in (0, size.value - 1):
        with instance.fails(ERROR, "size|bytes"):
            instance.fmu.fmi2SerializeFMUstate(component, state, c_char_p(b"\0" * size.value), c_size_t(wrong))
    instance.free_state(state)


def test_serialized_form_has_a_header(open_fmu):
    """The header has a magic word, a version, and the GUID of the model."""
    instance = open_fmu("SimplePendulum").initialize()
    data = serialized(instance)
    assert data[:8] == b"lagrange"
    assert struct.unpack_from("=I", data, 8)[0] >= 1
    assert instance.description.guid.encode() in data


@pytest.mark.parametrize("name", fmu.all_names())
def test_reset_is_a_new_instance(name, open_fmu):
    """A reset gives the same bits as a new instance, even after hundreds of resets."""
    fresh = drive(open_fmu(name).initialize(tolerance=1e-6), name, 5)
    instance = open_fmu(name)
    parameter = fmu.names_of(name, "parameter")[0]
    for i in range(200):
        instance.initialize({parameter: 1.5}, tolerance=1e-3)
        instance.step(0.02)
        instance.reset()
    instance.initialize(tolerance=1e-6)
    counts = [v.name for v in instance.description.modelVariables if v.type == "Integer" and "." not in v.name]  # without modes
    assert instance.fmu.getInteger(instance.vr(*counts)) == [0] * len(counts)
    assert drive(instance, name, 5) == fresh


@pytest.mark.parametrize("name", fmu.all_names())
def test_instances_are_independent(name, open_fmu):
    """Steps of one instance between those of another change nothing."""
    alone = drive(open_fmu(name).initialize(), name, 6)
    first, second = open_fmu(name).initialize(), open_fmu(name)
    parameter = fmu.names_of(name, "parameter")[0]
    second.initialize({parameter: 1.1 * fmu.start_values(name)[parameter]})
    interleaved = []
    names = [v.name for v in first.description.modelVariables if v.type == "Real"]
    for i in range(6):
        change(first, name, i)
        second.step(0.01)
        first.step(0.013 * (1 + i % 3))
        second.fmu.getReal(second.vr(*names))
        interleaved.append(first.fmu.getReal(first.vr(*names)))
    assert interleaved == alone


# A slab on four corners that is dropped, and pushed beside its centre of mass by a growing force.
PUSHED_SLAB = f"""<system name="PushedSlab">
  <parameter name="mu" start="0.5"/><parameter name="drop" start="0"/><gravity z="-9.81"/>
  <coordinate name="x" velocity="vx"/><coordinate name="y" velocity="vy"/><coordinate name="z" velocity="vz" start="0.05 + drop"/>
  {"".join(f'<coordinate name="q{i}" velocity="r{i}" start="{int(i == 0)}"/>' for i in range(4))}
  <frame name="slab"><translate x="x" y="y" z="z"/><rotate quaternion="q0 q1 q2 q3"/></frame>
  <body name="body" in="slab" mass="2" Ixx="0.02" Iyy="0.03" Izz="0.04"/><shape name="floor" type="plane"/>
  <shape name="box" in="slab" type="box" sizeX="0.4" sizeY="0.3" sizeZ="0.1"/><contact name="c" between="box" and="floor" friction="mu"/>
  <point name="pushed" in="slab" y="0.1"/><force on="pushed" x="10*time" y="3*time"/><experiment stopTime="2"/>
</system>"""


def test_every_mode_of_a_friction_in_a_plane_is_restored(open_fmu):
    """Corners of a slab fly, stick, begin to slip, creep and slide. Each state continues with the same bits."""
    build_systems("states", {"PushedSlab": PUSHED_SLAB})
    instance = open_fmu("PushedSlab").initialize({"drop": 0.01})
    corners = [(f"c[{i}].closed", f"c[{i}].friction.sliding") for i in range(1, 9)]
    seen = set()
    for _ in range(80):
        state = instance.fmu.getFMUstate()
        seen |= {tuple(instance.fmu.getInteger(instance.vr(*corner))) for corner in corners}
        instance.step(0.02)
        first = instance.get("x", "y", "z", "r3")
        instance.fmu.setFMUstate(state)
        instance.time -= 0.02
        instance.step(0.02)
        assert instance.get("x", "y", "z", "r3") == first
        instance.free_state(state)
    assert seen >= {(0, 0), (1, 0), (1, 1)}
