"""
Random sequences of valid and invalid FMI calls on every FMU: random_calls.py NUMBER [SEED]. Prints the number of calls; equal seeds give equal calls,
by default those of the tests. A model of the life cycle runs beside the FMU. A call that the standard's table forbids must return an error, values
must be finite, and all allocated memory must be freed.
"""

import ctypes
import math
import sys
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2EventInfo
from hypothesis import HealthCheck, seed, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule, run_state_machine_as_test

import fmu
from test_life_cycle import COMMON_CS, CS_STATES, ME, ME_STATES

OK, WARNING, DISCARD, ERROR = range(4)
STEPS_OF_AN_EXAMPLE = 60

calls = 0

# Valid calls are more frequent than invalid ones, so that sequences reach all states.
right_values = st.floats(-3, 3)
wrong_values = st.sampled_from([1e-9, 1e6, -1e300, math.nan, math.inf, -math.inf, 5e-324])
values = st.one_of(*[right_values] * 6, wrong_values, st.floats())
value_references = st.one_of(*[st.integers(0, 15)] * 8, st.sampled_from([40, 1000, 2**32 - 1]))
sizes = st.one_of(*[st.floats(1e-4, 0.05)] * 6, st.sampled_from([0.0, -0.1, 1e-300, 1e-16, math.nan, math.inf]))


class Calls(RuleBasedStateMachine):
    @initialize(
        name=st.sampled_from(fmu.small_names()), kind=st.sampled_from([FMU2Slave, FMU2Model]), logging=st.booleans()
    )
    def instantiate(self, name, kind, logging):
        self.memory = fmu.Memory()
        callbacks = fmu.callbacks_of(self.log, self.memory.allocate, self.memory.release)
        self.instance = fmu.Instance(name, kind=kind, logging=logging, callbacks=callbacks)
        self.table = COMMON_CS if kind is FMU2Slave else ME
        self.states = CS_STATES if kind is FMU2Slave else ME_STATES
        self.state, self.experiment, self.time = "instantiated", False, 0.0
        self.saved, self.count = [], 0

    def log(self, environment, name, status, category, message):
        assert status in (OK, WARNING, DISCARD, ERROR) and category.startswith(b"log") and message

    def call(self, function, *words):
        """Make the call, check its status against the table, and follow errors in the model."""
        global calls
        calls += 1
        self.count += 1
        raw = self.instance.fmu.dll[function]
        raw.restype = c_int
        status = raw(c_void_p(self.instance.fmu.component), *words)
        assert status in (OK, WARNING, DISCARD, ERROR)
        allowed = function not in self.table or self.table[function].split()[self.states.index(self.state)] == "x"
        if not allowed:
            assert status == ERROR, f"{function} in {self.state}"
        if status == ERROR:
            self.state = "error"
            if self.count % 4 > 0 and function not in ("fmi2Reset", "fmi2ExitInitializationMode"):
                self.start_anew()
        return status

    def go(self, function, state, *words):
        if self.call(function, *words) == OK:
            self.state = state

    @precondition(lambda self: self.state in ("instantiated", "initialization") or self.count % 5 == 0)
    @rule(tolerance=values, start=st.sampled_from([0.0, 1.0, math.nan]), stop=st.sampled_from([None, 0.1, 5.0, -1.0]))
    def setup_experiment(self, tolerance, start, stop):
        defined = 1 if 0 < tolerance < 1 else 0
        words = (defined, c_double(tolerance), c_double(start), int(stop is not None), c_double(stop or 0.0))
        if self.call("fmi2SetupExperiment", *words) == OK:
            self.experiment, self.time = True, start

    @precondition(lambda self: self.state in ("instantiated", "initialization") or self.count % 5 == 0)
    @rule()
    def initialization(self):
        ready = self.experiment
        if self.call("fmi2EnterInitializationMode") == OK:
            assert ready
            self.state = "initialization"

    @precondition(lambda self: self.state in ("instantiated", "initialization") or self.count % 5 == 0)
    @rule()
    def exit_initialization(self):
        self.go("fmi2ExitInitializationMode", "step complete" if self.table is COMMON_CS else "event")

    @precondition(lambda self: self.state in ("instantiated", "error", "terminated"))
    @rule()
    def start_anew(self):
        """Reset and go straight to stepping, so that most sequences get there."""
        self.go("fmi2Reset", "instantiated")
        self.call("fmi2SetupExperiment", 1, c_double(1e-4), c_double(0.0), 0, c_double(0.0))
        self.experiment, self.time = True, 0.0
        self.go("fmi2EnterInitializationMode", "initialization")
        self.go("fmi2ExitInitializationMode", "step complete" if self.table is COMMON_CS else "event")
        if self.table is ME:
            self.go("fmi2EnterContinuousTimeMode", "continuous")

    @precondition(lambda self: self.count % 5 == 0)
    @rule()
    def terminate(self):
        self.go("fmi2Terminate", "terminated")

    @precondition(lambda self: self.count % 5 == 0)
    @rule()
    def reset(self):
        if self.call("fmi2Reset") == OK:
            self.state, self.experiment = "instantiated", False

    @precondition(lambda self: self.table is COMMON_CS or self.count % 5 == 0)
    @rule(size=sizes, away=st.sampled_from([0.0, 0.0, 0.0, 1.0]))
    def do_step(self, size, away):
        self.do_step_of(size, away)

    def do_step_of(self, size, away):
        start = self.time
        status = self.call("fmi2DoStep", c_double(start + away), c_double(size), 1)
        if status == OK:
            self.time = start + size
        elif status == DISCARD:
            self.state = "step failed"
            reached = c_double(math.nan)
            assert self.call("fmi2GetRealStatus", 2, byref(reached)) == OK
            assert start <= reached.value <= start + size

    @precondition(lambda self: self.state == "step complete")
    @rule(count=st.integers(1, 5), size=st.floats(1e-4, 0.02), slope=right_values, order=st.integers(1, 3))
    def steps(self, count, size, slope, order):
        """Valid steps, with inputs that change during them, and outputs read at their ends."""
        inputs = [v.name for v in self.instance.description.modelVariables if v.causality == "input"]
        outputs = [v.name for v in self.instance.description.modelVariables if v.causality == "output"]
        for _ in range(count):
            if self.state != "step complete":
                return
            if inputs:
                self.signal("fmi2SetRealInputDerivatives", inputs[-1], order, slope)
            self.do_step_of(size, 0.0)
            if self.state == "step complete":
                assert math.isfinite(self.signal("fmi2GetRealOutputDerivatives", outputs[0], 1, 0.0))

    def signal(self, function, name, order, value):
        numbers = (c_double * 1)(value)
        vr = (c_uint * 1)(*self.instance.vr(name))
        assert self.call(function, vr, c_size_t(1), (c_int * 1)(order), numbers) in (OK, DISCARD)
        return numbers[0]

    @precondition(lambda self: self.state not in ("instantiated", "error"))
    @rule(data=st.data(), seed=right_values)
    def right_directional_derivative(self, data, seed):
        every = self.instance.description.modelVariables
        unknown = data.draw(st.sampled_from([v for v in every if v.causality == "output" or v.name.startswith("der(")]))
        known = data.draw(st.sampled_from([v for v in every if v.causality in ("input", "parameter")]))
        result = (c_double * 1)()
        is_starting = self.state == "initialization"  # the start may be a kink: next to it, touching bodies separate or penetrate
        status = self.call(
            "fmi2GetDirectionalDerivative", (c_uint * 1)(unknown.valueReference), c_size_t(1),
            (c_uint * 1)(known.valueReference), c_size_t(1), (c_double * 1)(seed), result,
        )
        assert (status in (OK, DISCARD) or is_starting) and math.isfinite(result[0])

    @rule(vrs=st.lists(value_references, max_size=5), which=st.sampled_from(["Real", "Integer", "Boolean", "String"]))
    def get(self, vrs, which):
        kind = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}[which]
        before = 123.0 if which == "Real" else 123
        target = (kind * len(vrs))(*([before] * len(vrs) if which != "String" else []))
        self.call(f"fmi2Get{which}", (c_uint * len(vrs))(*vrs), c_size_t(len(vrs)), target)
        if which == "Real":
            assert all(math.isfinite(value) for value in target)

    @rule(vrs=st.lists(value_references, max_size=4), data=st.data())
    def set_real(self, vrs, data):
        numbers = [data.draw(values) for _ in vrs]
        self.call("fmi2SetReal", (c_uint * len(vrs))(*vrs), c_size_t(len(vrs)), (c_double * len(vrs))(*numbers))

    @rule(data=st.data())
    def set_inputs(self, data):
        """Set inputs and tunable parameters within their ranges, so that the motion changes."""
        names = [
            v.name
            for v in self.instance.description.modelVariables
            if v.causality == "input" or (v.causality == "parameter" and self.state != "continuous")
        ]
        if names:
            name = data.draw(st.sampled_from(names))
            vr = self.instance.vr(name)[0]
            self.call("fmi2SetReal", (c_uint * 1)(vr), c_size_t(1), (c_double * 1)(data.draw(st.floats(0.1, 3))))

    @precondition(lambda self: self.count % 5 == 0)
    @rule(which=st.sampled_from(["Integer", "Boolean", "String"]), count=st.integers(0, 2))
    def set_discrete(self, which, count):
        kind = c_char_p if which == "String" else c_int
        self.call(f"fmi2Set{which}", (c_uint * count)(), c_size_t(count), (kind * count)())

    @rule()
    def save(self):
        state = c_void_p()
        if self.call("fmi2GetFMUstate", byref(state)) == OK:
            self.saved.append((state, self.state, self.experiment, self.time))

    @precondition(lambda self: self.saved)
    @rule(data=st.data())
    def restore(self, data):
        state, mode, experiment, time = data.draw(st.sampled_from(self.saved))
        assert self.call("fmi2SetFMUstate", state) == OK
        self.state, self.experiment, self.time = mode, experiment, time

    @precondition(lambda self: self.saved)
    @rule(data=st.data(), flip=st.booleans())
    def serialize(self, data, flip):
        state = self.saved[-1][0]
        size, copy = c_size_t(), c_void_p()
        assert self.call("fmi2SerializedFMUstateSize", state, byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert self.call("fmi2SerializeFMUstate", state, buffer, size) == OK
        if flip:
            place = data.draw(st.integers(0, size.value - 1))
            buffer[place] = bytes([buffer.raw[place] ^ 1])
        status = self.call("fmi2DeSerializeFMUstate", buffer, size, byref(copy))
        assert status == (ERROR if flip else OK)
        self.call("fmi2FreeFMUstate", byref(copy))
        assert not copy.value

    @precondition(lambda self: self.saved)
    @rule()
    def drop(self):
        assert self.call("fmi2FreeFMUstate", byref(self.saved.pop()[0])) == OK

    @rule(unknowns=st.lists(value_references, max_size=3), knowns=st.lists(value_references, max_size=3), seed=values)
    def directional_derivative(self, unknowns, knowns, seed):
        result = (c_double * len(unknowns))()
        self.call(
            "fmi2GetDirectionalDerivative", (c_uint * len(unknowns))(*unknowns), c_size_t(len(unknowns)),
            (c_uint * len(knowns))(*knowns), c_size_t(len(knowns)), (c_double * len(knowns))(*[seed] * len(knowns)), result,
        )
        assert all(math.isfinite(value) for value in result)

    @precondition(lambda self: self.table is COMMON_CS or self.count % 5 == 0)
    @rule(vr=value_references, order=st.integers(-1, 5), value=values, output=st.booleans())
    def derivative_of_a_signal(self, vr, order, value, output):
        function = "fmi2GetRealOutputDerivatives" if output else "fmi2SetRealInputDerivatives"
        numbers = (c_double * 1)(0.0 if output else value)
        self.call(function, (c_uint * 1)(vr), c_size_t(1), (c_int * 1)(order), numbers)
        assert not output or math.isfinite(numbers[0])

    @precondition(lambda self: self.table is COMMON_CS or self.count % 5 == 0)
    @rule(function=st.sampled_from(["fmi2GetStatus", "fmi2GetRealStatus", "fmi2GetIntegerStatus", "fmi2GetBooleanStatus",
                                    "fmi2GetStringStatus"]), kind=st.integers(-1, 5))
    def status(self, function, kind):
        self.call(function, kind, (c_double * 1)())

    @precondition(lambda self: self.count % 5 == 0)
    @rule(function=st.sampled_from(["fmi2CancelStep", "fmi2GetReal", "fmi2SetReal", "fmi2GetFMUstate", "fmi2SetFMUstate"]))
    def null_arguments(self, function):
        assert self.call(function, None, c_size_t(3), None) == ERROR

    @precondition(lambda self: self.table is ME or self.count % 5 == 0)
    @rule(count=st.integers(0, 7), data=st.data())
    def continuous_states(self, count, data):
        right = data.draw(st.booleans())
        size = len(self.instance.description.derivatives) if right else count
        numbers = (c_double * size)(*[data.draw(st.floats(-2, 2)) for _ in range(size)])
        function = data.draw(
            st.sampled_from(["fmi2SetContinuousStates", "fmi2GetContinuousStates", "fmi2GetDerivatives",
                             "fmi2GetNominalsOfContinuousStates", "fmi2GetEventIndicators"])
        )
        self.call(function, numbers, c_size_t(size))
        assert all(math.isfinite(value) for value in numbers)

    @precondition(lambda self: self.table is ME or self.count % 5 == 0)
    @rule(time=values)
    def set_time(self, time):
        self.call("fmi2SetTime", c_double(time))

    @precondition(lambda self: self.table is ME or self.count % 5 == 0)
    @rule(which=st.sampled_from(["event", "continuous", "discrete", "step"]))
    def modes(self, which):
        flags = (c_int(), c_int())
        if which == "event":
            self.go("fmi2EnterEventMode", "event")
        elif which == "continuous":
            self.go("fmi2EnterContinuousTimeMode", "continuous")
        elif which == "discrete":
            self.call("fmi2NewDiscreteStates", byref(fmi2EventInfo()))
        else:
            self.call("fmi2CompletedIntegratorStep", 1, byref(flags[0]), byref(flags[1]))

    @rule(on=st.booleans(), categories=st.lists(st.sampled_from([b"logAll", b"logEvents", b"logStatusError", b"none"]),
                                                max_size=2))
    def debug_logging(self, on, categories):
        self.call("fmi2SetDebugLogging", int(on), c_size_t(len(categories)), (c_char_p * len(categories))(*categories))

    def teardown(self):
        if hasattr(self, "instance"):
            for state, *_ in self.saved:
                self.call("fmi2FreeFMUstate", byref(state))
            self.instance.free()
            assert not self.memory.alive


def main():
    wanted, seed_number = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    # Kept open, so that a leak report at the end can name the FMU.
    libraries = [ctypes.CDLL(fmu.library(name)) for name in fmu.small_names()]
    run_state_machine_as_test(
        seed(seed_number)(Calls),
        settings=settings(
            max_examples=max(1, wanted // STEPS_OF_AN_EXAMPLE), stateful_step_count=STEPS_OF_AN_EXAMPLE, deadline=None,
            database=None, suppress_health_check=list(HealthCheck),
        ),
    )
    print(f"{calls} calls of {len(libraries)} FMUs")


if __name__ == "__main__":
    main()
