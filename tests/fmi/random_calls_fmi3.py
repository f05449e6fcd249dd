"""
Random sequences of FMI 3.0 calls: random_calls_fmi3.py NUMBER SEED [FMU ...]. Without names it takes all small systems.

The tables of test_life_cycle_fmi3.py, typed from the standard, say what is allowed. A forbidden call must be an error with a message. An
allowed call with values near those of the start must succeed. Values must be finite, also in callbacks. A step that is repeated from a saved
state must give the same numbers.
"""

import math
import random
import subprocess
import sys
from ctypes import CDLL, CFUNCTYPE, POINTER, byref, c_bool, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32, c_void_p, create_string_buffer

import fmi3
import fmu
from test_life_cycle_fmi3 import CS_STATES, ME_STATES, TABLE, arguments

OK, WARNING, DISCARD, ERROR = range(4)
LOG = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
UPDATE = CFUNCTYPE(None, c_void_p, c_double, c_bool, c_bool, c_bool, c_bool, POINTER(c_bool), POINTER(c_double))

# Allowed in event mode of co-simulation (sections 2.3.5 and 4.2), beside the functions that are allowed anywhere.
EVENT_OF_STEPS = {"fmi3UpdateDiscreteStates", "fmi3EnterStepMode", "fmi3Terminate"} | {
    name for name, row in TABLE.items() if name[:7] in ("fmi3Get", "fmi3Set") and row["CS"].split()[CS_STATES.index("step")] == "x" and "OutputDerivatives" not in name
}
ANYWHERE = {"fmi3SetDebugLogging", "fmi3Reset", "fmi3GetFMUState", "fmi3FreeFMUState"}


def flag():
    return c_bool()


class Run:
    """Instances of one FMU, with random calls."""

    def __init__(self, name, chance):
        self.name, self.chance, self.count = name, chance, 0
        self.description = fmi3.description(name)
        self.library = CDLL(str(fmi3.library(name)))
        variables = self.description.modelVariables
        scalars = [v for v in variables if not v.dimensions]
        self.start = {v.valueReference: float(v.start) for v in scalars if v.start is not None and v.type == "Float64"}
        self.inputs = [v.valueReference for v in scalars if v.causality == "input"]
        self.parameters = [v for v in scalars if v.causality == "parameter" and v.type == "Float64"]
        self.readable = [v.valueReference for v in scalars if v.type == "Float64" and v.variability == "continuous"]
        self.intermediate = [v.valueReference for v in scalars if getattr(v, "intermediateUpdate", False) and v.causality != "input"]
        self.outputs = [v.valueReference for v in scalars if v.causality == "output" and v.type == "Float64"]
        self.initial_knowns = [v.valueReference for v in scalars if v.causality in ("input", "parameter") and v.type == "Float64"]
        self.states = len(self.description.derivatives)
        self.indicators = self.description.numberOfEventIndicators
        cs = self.description.coSimulation
        self.has_events = bool(getattr(cs, "hasEventMode", False))
        self.repeats_bits = b"SUNDIALS" not in b"".join(path.read_bytes() for path in (fmi3.unpacked(name) / "documentation").rglob("*.txt"))
        self.log = LOG(self.hear)
        self.update = UPDATE(self.intermediate_update)
        self.messages, self.trail = [], []

    def hear(self, environment, status, category, message):
        self.messages.append((status, message.decode()))

    def fail(self, what):
        raise AssertionError(f"{self.name} ({self.kind}, events {self.uses_events}, early {self.early}): {what}; messages {self.messages[-3:]}; calls {self.trail[-14:]}")

    def require(self, condition, what):
        if not condition:
            self.fail(what)

    def is_allowed(self, function):
        if function not in TABLE:
            return True
        if self.state == "event" and self.kind == "CS":
            return function in EVENT_OF_STEPS or function in ANYWHERE
        if self.state == "request":
            return function in ("fmi3SetDebugLogging", "fmi3SetFloat64")
        if function == "fmi3EnterEventMode" and self.kind == "CS":
            return self.uses_events and self.state == "step"
        states = CS_STATES if self.kind == "CS" else ME_STATES
        return TABLE[function][self.kind].split()[states.index(self.state)] == "x"

    def call(self, function, *words, may=(OK,)):
        self.count += 1
        self.trail.append((self.state, function, *[getattr(word, "value", None) for word in words]))
        before = len(self.messages)
        raw = getattr(self.library, function)
        raw.restype = c_int
        is_allowed = self.is_allowed(function)
        status = raw(self.component, *words)
        if not is_allowed:
            self.require(status == ERROR, f"{function} is forbidden in {self.state}, but gave {status}")
            self.require(len(self.messages) > before or not self.logging, f"{function} failed without a message")
        else:
            self.require(status in may, f"{function} gave {status} in {self.state}")
        if status == ERROR:
            self.state = "error"
        return status

    def read(self, references):
        target = (c_double * len(references))()
        status = self.call("fmi3GetFloat64", (c_uint32 * len(references))(*references), c_size_t(len(references)), target, c_size_t(len(references)), may=(OK, DISCARD))
        if status == OK:
            self.require(all(math.isfinite(value) for value in target), f"values {list(target)}")
        return status, list(target)

    def begin(self):
        random_ = self.chance
        self.kind = random_.choice(["CS", "CS", "ME"])
        self.uses_events = self.kind == "CS" and self.has_events and random_.random() < 0.6
        self.early = self.kind == "CS" and random_.random() < 0.6
        self.logging = True
        self.observes = random_.random() < 0.6
        self.forbidden_inside = random_.random() < 0.05
        self.saved, self.time, self.state, self.resting = [], 0.0, "instantiated", 0
        self.messages.clear(), self.trail.clear()
        token = self.description.instantiationToken.encode()
        self.asks = bool(self.inputs) and random_.random() < 0.7
        needed = self.intermediate + (self.inputs if self.asks else []) if self.observes else []
        if self.kind == "CS":
            create = self.library.fmi3InstantiateCoSimulation
            words = (b"a", token, None, c_bool(False), c_bool(True), c_bool(self.uses_events), c_bool(self.early), (c_uint32 * len(needed))(*needed), c_size_t(len(needed)), None, self.log)
            words += (self.update if self.observes else None,)
        else:
            create = self.library.fmi3InstantiateModelExchange
            words = (b"a", token, None, c_bool(False), c_bool(True), None, self.log)
        create.restype = c_void_p
        self.component = c_void_p(create(*words))
        self.require(self.component.value, "no instance")

    def end(self):
        for state, *_ in self.saved:
            self.call("fmi3FreeFMUState", byref(state), may=(OK,))
        self.library.fmi3FreeInstance(self.component)

    def set_up(self):
        """Enter initialization mode."""
        if self.call("fmi3EnterInitializationMode", c_bool(True), c_double(self.chance.choice([1e-4, 1e-8])), c_double(0.0), c_bool(False), c_double(0.0)) == OK:
            self.state, self.time = "initialization", 0.0

    def exit_initialization(self):
        status = self.call("fmi3ExitInitializationMode", may=(OK, ERROR))
        if status == OK:
            self.state = "event" if self.kind == "ME" or self.uses_events else "step"
        else:
            self.require(self.messages, "no start, without a message")

    def update_states(self):
        flags = [flag() for _ in range(5)]
        time = c_double()
        status = self.call("fmi3UpdateDiscreteStates", *[byref(f) for f in flags], byref(time), may=(OK, ERROR))
        if status == OK:
            self.next_event = time.value if flags[4].value else None
            self.require(not flags[4].value or time.value > self.time - 1e-12, f"the next event at {time.value}, before {self.time}")

    def intermediate_update(self, environment, time, set_requested, get_allowed, finished, can_return, requested, return_time):
        try:
            outer, self.state = self.state, "request" if set_requested else "intermediate"
            self.inside.append(time)
            if self.inside_failed:
                return
            if set_requested and self.inputs and self.chance.random() < 0.7:
                reference = self.chance.choice(self.inputs)
                self.call("fmi3SetFloat64", (c_uint32 * 1)(reference), c_size_t(1), (c_double * 1)(self.signal(reference, time)), c_size_t(1), may=(OK, DISCARD))
            elif get_allowed and self.intermediate and self.chance.random() < 0.5:
                self.read(self.chance.sample(self.intermediate, min(4, len(self.intermediate))))
            elif self.forbidden_inside and self.chance.random() < 0.1:
                self.any_call()
            self.inside_failed |= self.state == "error"
            if can_return and self.chance.random() < 0.1:
                requested[0], return_time[0] = True, time + self.chance.random() * 0.01
        except BaseException as problem:  # which ctypes would drop
            self.problem = problem
        finally:
            self.state = outer

    def signal(self, reference, time):
        return self.start.get(reference, 0.0) + 0.1 * math.sin(3 * time + reference)

    def do_step(self, size=None, record=None):
        size = size or self.chance.choice([1e-3, 0.01, 0.02, 0.05])
        needed, ends, early, last = flag(), flag(), flag(), c_double(math.nan)
        self.inside, self.inside_failed, self.problem = [], False, None
        was = self.state
        status = self.call("fmi3DoStep", c_double(self.time), c_double(size), c_bool(False), byref(needed), byref(ends), byref(early), byref(last), may=(OK, DISCARD, ERROR))
        if self.problem is not None:
            raise self.problem
        if was != "step":
            return status
        self.require((status == ERROR) == self.inside_failed or self.waiting, f"the step gave {status}, inside {self.inside_failed}")
        if status == OK:
            self.resting = self.resting + 1 if last.value == self.time else 0
            self.require(self.time <= last.value <= self.time + size * (1 + 1e-12), f"ended at {last.value}")
            self.require(self.resting == 0 or needed.value and self.resting < 5, f"{self.resting} steps end where they begin, at {last.value}")
            self.require(early.value or last.value == self.time + size, f"ended at {last.value} without earlyReturn")
            self.require(not early.value or self.early, "an early return that is not allowed")
            self.require(not needed.value or self.uses_events, "an event without event mode")
            requests = 4 if self.observes and self.asks else 0
            self.require(len(self.inside) >= requests, f"{len(self.inside)} callbacks")
            for times in (self.inside[:requests], self.inside[requests:]):
                self.require(times == sorted(times), f"times of callbacks {times}")
            self.time, self.waiting = last.value, needed.value
        elif status == DISCARD:
            self.require(self.messages, "a discard without a message")
        return status

    def set_values(self):
        reference, value = None, None
        if self.inputs and self.chance.random() < 0.6 or not self.parameters:
            if not self.inputs:
                return
            reference = self.chance.choice(self.inputs)
            value = self.signal(reference, self.chance.random())
        else:
            parameter = self.chance.choice(self.parameters)
            reference = parameter.valueReference
            value = self.start[reference] * self.chance.uniform(0.98, 1.02)
            low, high = (float(x) if x is not None else None for x in (parameter.min, parameter.max))
            value = max(value, low) if low is not None else value
            value = min(value, high) if high is not None else value
            if self.kind == "ME" and self.state == "continuous":
                return
        self.call("fmi3SetFloat64", (c_uint32 * 1)(reference), c_size_t(1), (c_double * 1)(value), c_size_t(1), may=(OK,))

    def save(self):
        state = c_void_p()
        if self.call("fmi3GetFMUState", byref(state)) == OK:
            self.saved.append((state, self.state, self.time, self.waiting))

    def restore(self, index=None):
        if not self.saved:
            return
        state, self_state, time, waiting = self.saved[index] if index is not None else self.chance.choice(self.saved)
        was = self.state
        if self.call("fmi3SetFMUState", state, may=(OK, ERROR) if was in ("request", "intermediate") else (OK,)) == OK:
            self.state, self.time, self.waiting, self.resting = self_state, time, waiting, 0

    def serialize(self):
        if not self.saved:
            return
        state, mode, time, waiting = self.chance.choice(self.saved)
        size, copy = c_size_t(), c_void_p()
        self.call("fmi3SerializedFMUStateSize", state, byref(size))
        buffer = create_string_buffer(size.value)
        self.call("fmi3SerializeFMUState", state, buffer, size)
        self.call("fmi3DeserializeFMUState", buffer, size, byref(copy))
        self.saved.append((copy, mode, time, waiting))

    def repeat(self):
        """Make a step from a saved state twice."""
        if self.state != "step" or self.waiting or self.observes:
            return
        self.save()
        ends = []
        for _ in range(2):
            self.do_step(0.01)
            if self.state != "step":
                return
            ends.append((self.time, self.read(self.outputs)))
            self.restore(-1)
        (first, (_, ours)), (second, (_, theirs)) = ends
        limit = 0.0 if self.repeats_bits else 1e-4
        are_near = all(abs(a - b) <= limit * (1 + abs(a)) for a, b in zip(ours, theirs))
        self.require(first == second and are_near, f"a repeated step differs: {ends}")

    def partial(self):
        if not self.outputs or not self.initial_knowns:
            return
        function = self.chance.choice(["fmi3GetDirectionalDerivative", "fmi3GetAdjointDerivative"])
        unknown, known = self.chance.choice(self.outputs), self.chance.choice(self.initial_knowns)
        result = (c_double * 1)()
        one = c_size_t(1)
        may = (OK, ERROR, DISCARD)
        before = len(self.messages)
        status = self.call(function, (c_uint32 * 1)(unknown), one, (c_uint32 * 1)(known), one, (c_double * 1)(1.0), one, result, one, may=may)
        self.require(status == OK or len(self.messages) > before, "no derivative, without a message")
        self.require(status != OK or math.isfinite(result[0]), f"the derivative {result[0]}")

    def exchange(self):
        """Make a step by Euler's method in model exchange."""
        if self.state != "continuous" or self.kind != "ME":
            return
        n = self.states
        x, dx, z0, z1 = (c_double * n)(), (c_double * n)(), (c_double * self.indicators)(), (c_double * self.indicators)()
        h = self.chance.choice([1e-4, 1e-3])
        if self.call("fmi3GetContinuousStates", x, c_size_t(n)) or self.call("fmi3GetContinuousStateDerivatives", dx, c_size_t(n), may=(OK, DISCARD)):
            return
        self.call("fmi3GetEventIndicators", z0, c_size_t(self.indicators), may=(OK, DISCARD))
        self.time += h
        self.call("fmi3SetTime", c_double(self.time))
        self.call("fmi3SetContinuousStates", (c_double * n)(*[a + h * b for a, b in zip(x, dx)]), c_size_t(n))
        self.call("fmi3GetEventIndicators", z1, c_size_t(self.indicators), may=(OK, DISCARD))
        self.require(all(map(math.isfinite, [*x, *dx, *z0, *z1])), "numbers that are not finite")
        enter, ends = flag(), flag()
        self.call("fmi3CompletedIntegratorStep", c_bool(True), byref(enter), byref(ends))
        if enter.value or any((a > 0) != (b > 0) for a, b in zip(z0, z1)) or (self.next_event is not None and self.time >= self.next_event):
            self.handle()

    def handle(self):
        self.call("fmi3EnterEventMode")
        self.state = "event"
        self.update_states()
        if self.state == "event":
            self.leave()

    def leave(self):
        if self.kind == "ME":
            if self.call("fmi3EnterContinuousTimeMode") == OK:
                self.state = "continuous"
        elif self.call("fmi3EnterStepMode") == OK:
            self.state, self.waiting = "step", False

    def any_call(self):
        """Make a forbidden call."""
        function = self.chance.choice(sorted(TABLE))
        if self.is_allowed(function):
            return
        instance = type("", (), {"vr": lambda _, name: [1]})()
        self.call(function, *arguments(instance, function))

    def counts(self):
        integers = [v.valueReference for v in self.description.modelVariables if v.type == "Int64"]
        self.call("fmi3GetInt64", (c_uint32 * len(integers))(*integers), c_size_t(len(integers)), (c_int64 * len(integers))(), c_size_t(len(integers)))

    def step(self):
        chance = self.chance
        if self.state == "instantiated":
            chance.choice([self.set_values, self.set_up, self.set_up, self.save, self.restore, self.serialize])()
        elif self.state == "initialization":
            chance.choice([self.set_values, self.exit_initialization, self.exit_initialization, self.save, self.restore, self.partial, lambda: self.read(self.outputs)])()
        elif self.state in ("error", "terminated"):
            if self.saved and chance.random() < 0.4:
                self.restore()
            elif self.call("fmi3Reset") == OK:
                self.state, self.waiting = "instantiated", False
        elif self.state == "event":
            if chance.random() < 0.6:
                self.update_states()
                if self.state == "event" and chance.random() < 0.8:
                    self.leave()
            else:
                chance.choice([self.set_values, self.save, self.restore, self.serialize, self.partial, self.counts, lambda: self.read(self.readable[:6])])()
        elif self.state == "continuous":
            chance.choice([self.exchange] * 8 + [self.handle, self.save, self.restore, self.serialize, self.partial, self.set_values, lambda: self.read(self.readable[:6])])()
        elif self.state == "step":
            if self.waiting or (self.uses_events and chance.random() < 0.1):
                if chance.random() < 0.85:
                    self.call("fmi3EnterEventMode")
                    self.state = "event"
                else:
                    chance.choice([self.save, self.restore, self.serialize, lambda: self.read(self.outputs)])()
            else:
                chance.choice([self.do_step] * 6 + [self.save, self.restore, self.serialize, self.partial, self.set_values, self.repeat, self.counts, lambda: self.read(self.readable[:6])])()
        if chance.random() < 0.01 and self.state not in ("error",):
            self.any_call()
        if chance.random() < 0.003 and self.is_allowed("fmi3Terminate"):
            self.call("fmi3Terminate")
            self.state = "terminated"

    def go(self, number):
        self.waiting, self.next_event = False, None
        while self.count < number:
            self.begin()
            self.waiting, self.next_event = False, None
            for _ in range(80):
                self.step()
            self.end()
            self.component = None


def main():
    number, seed, *names = sys.argv[1:]
    if len(names) == 1:
        run = Run(names[0], random.Random(f"{seed} {names[0]}"))
        run.go(int(number))
        print(f"{run.count} calls of {names[0]}")
        return
    failed = False
    for name in names or fmu.small_names() + fmu.further_names():
        result = subprocess.run([sys.executable, __file__, number, seed, name], capture_output=True, text=True)
        print(result.stdout.strip() or f"{name} ended with {result.returncode}: {result.stderr[-2500:]}", flush=True)
        failed |= result.returncode != 0
    sys.exit(failed)


if __name__ == "__main__":
    main()
