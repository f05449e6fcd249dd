"""
Run a co-simulation of FMI 2.0 or 3.0, with rows at communication points and at events, and piecewise polynomial inputs.

An FMU of FMI 2.0 follows inputs by their derivatives, and one of FMI 3.0 by their values in intermediate update, if it asks for them there. Otherwise
the two halves of a smooth piece get constant inputs u1, u2 with the mean and the first moment of the polynomial. This is of fourth order if the rates are linear in the input (commutator-free Magnus integrator
with two exponentials, S. Blanes and P. Moan 2006).

An event has two rows of one time: before it and after it. FMI 3.0 ends its steps at events. In FMI 2.0 the FMU's counter of events shows that a
step contains one. Bisection, with the step repeated from a saved state, locates it. Then the state at the end of the step is restored.
"""

import itertools
import shutil
import time as clock
import warnings
from ctypes import byref

import numpy as np
from fmpy import extract, platform, supported_platforms
from fmpy.fmi1 import FMICallException
from fmpy.simulation import Recorder, apply_start_values, instantiate_fmu, settable_in_initialization_mode, settable_in_instantiated

from .feedback import Feedback
from .loading import loading
from .problem import Problem
from .signals import REAL, value

EVENTS = "events"  # variable of the FMU that counts events
NEAR = 1e-9  # times that differ by less, relative to a step, are equal
FOUND = 1e-10  # accuracy of the time of an event, relative to a step
EVENT_ROWS = 20  # events of a step that are located; further ones have no rows
LONGEST_SEARCH = 10.0  # s of computation for all events of a run, after which further ones have no rows
OPTIONS = ("start_time", "stop_time", "output_interval", "relative_tolerance", "record_events", "logger", "debug_logging", "visible", "fmi_call_logger")


class Interrupted(Exception):
    """A step failed; `reached` has the rows before it, and `cause` is the exception."""

    def __init__(self, reached, cause):
        super().__init__(str(cause))
        self.reached, self.cause = reached, cause


class Slave:
    """An FMU in co-simulation with its inputs; subclasses have the calls of a version of FMI."""

    def __init__(self, fmu, description, signals):
        self.fmu, self.description, self.signals = fmu, description, signals
        self.setters = self._setters(signals) if signals else []

    @staticmethod
    def _setters(signals):
        """Return (type, references, columns) for each type of variables."""
        ends = np.cumsum([0, *signals.sizes])
        found = {}
        for variable, begin, end in zip(signals.variables, ends[:-1], ends[1:]):
            references, columns = found.setdefault(variable.type, ([], []))
            references.append(variable.valueReference)
            columns.extend(range(begin, end))
        return [(kind, *both) for kind, both in found.items()]

    def set(self, values):
        """Set constant inputs."""
        for kind, references, columns in self.setters:
            numbers = [float(values[i]) if kind in REAL else int(round(values[i])) for i in columns]
            getattr(self.fmu, f"set{'Integer' if kind == 'Enumeration' else kind}")(references, numbers)

    def initialize(self, start_values, piece, start, stop, tolerance):
        """Initialize the FMU; `piece` has the polynomials of the inputs in the first step, or is None."""
        left = apply_start_values(self.fmu, self.description, start_values, settable=settable_in_instantiated)
        self.enter_initialization(start, stop, tolerance)
        left = apply_start_values(self.fmu, self.description, left, settable=settable_in_initialization_mode)
        if piece is not None:
            self.set(piece[0])
        self.fmu.exitInitializationMode()
        if left:
            raise Problem(f"{self.description.modelName} accepts no start values of {', '.join(left)}; expected parameters, inputs or states")

    def constant_halves(self, piece, begin, end):
        """Return a list of (begin, end, values) of constant inputs that replace polynomials: one if these are constant, else two."""
        if not np.any(piece[1:]):
            return [(begin, end, piece[0])]
        scaled = piece * ((end - begin) ** np.arange(len(piece)))[:, None]
        order = np.arange(len(piece))[:, None]
        mean, moment = np.sum(scaled / (order + 1), axis=0), np.sum(scaled * (1 / (order + 2) - 0.5 / (order + 1)), axis=0)
        middle = (begin + end) / 2
        return [(begin, middle, mean - 4 * moment), (middle, end, mean + 4 * moment)]


class Slave2(Slave):
    def __init__(self, fmu, description, signals):
        super().__init__(fmu, description, signals)
        abilities = description.coSimulation
        self.follows = abilities.canInterpolateInputs
        counter = next((v for v in description.modelVariables if v.name == EVENTS and v.type == "Integer"), None)
        self.can_find = counter is not None and abilities.canGetAndSetFMUstate and abilities.canHandleVariableCommunicationStepSize
        self.counter = [counter.valueReference] if counter is not None else None
        self.states = []
        self.is_looking = False  # True while events are located, when log messages are repetitions
        self.searched = 0.0  # s of computation

    def enter_initialization(self, start, stop, tolerance):
        self.fmu.setupExperiment(tolerance=tolerance, startTime=start, stopTime=stop)
        self.fmu.enterInitializationMode()

    def begin(self):
        pass

    def change(self, set_values):
        """Call set_values() in a mode in which inputs may jump."""
        set_values()

    def events(self):
        return self.fmu.getInteger(self.counter)[0]

    def step(self, begin, end, piece, record):
        """Take a step; record(time), or None, adds a row at events; `piece` has the polynomials of the inputs, or is None."""
        parts = [(begin, end, None)]
        if piece is not None and self.follows:
            self.follow(piece)
        elif piece is not None:
            parts = self.constant_halves(piece, begin, end)
        saved, count = (self.saved(0), self.events()) if self.can_find and record else (None, 0)
        for low, high, constant in parts:
            if constant is not None:
                self.set(constant)
            self.fmu.doStep(low, high - low)
        if not self.follows and piece is not None:
            self.set(value(piece, end - begin))
        elif saved is not None and self.events() > count:
            self.find_in_time(saved, count, begin, end, record)

    def follow(self, piece):
        """Set polynomial inputs, by their derivatives that are not 0."""
        self.set(piece[0])
        references, orders, rates = [], [], []
        for kind, all_references, columns in self.setters:
            for reference, column in zip(all_references, columns) if kind in REAL else ():
                for order, factor in ((1, 1.0), (2, 2.0), (3, 6.0)):
                    if piece[order, column] != 0.0:
                        references.append(reference)
                        orders.append(order)
                        rates.append(factor * piece[order, column])
        if references:
            self.fmu.setRealInputDerivatives(references, orders, rates)

    def saved(self, slot):
        """Save the FMU state in a slot, whose memory is reused; return it."""
        if slot == len(self.states):
            self.states.append(self.fmu.getFMUstate())
        else:
            self.fmu.fmi2GetFMUstate(self.fmu.component, byref(self.states[slot]))
        return self.states[slot]

    def free(self):
        for state in self.states:
            self.fmu.freeFMUstate(state)

    def find_in_time(self, state, count, begin, end, record):
        """Find events as below, until that has taken too long: it repeats a step some 30 times for each event."""
        started = clock.perf_counter()
        self.find_events(state, count, begin, end, record)
        self.searched += clock.perf_counter() - started
        if self.searched > LONGEST_SEARCH:
            self.can_find = False
            warnings.warn(
                f"events after {end:g} s have no rows, as it takes too long to find their times; expected --fmi 3 (fmi=3), with which the FMU stops at them, "
                "or --no-events (record_events=False)", stacklevel=2,
            )  # fmt: skip

    def find_events(self, state, count, begin, end, record):
        """Add rows for the events of the step that the FMU has just done from `state`; leave the FMU at the end of the step."""
        last, total = self.saved(1), self.events()
        self.is_looking = True
        try:
            for _ in range(EVENT_ROWS):
                if count == total:
                    break
                low, high = self.narrowed(state, count, begin, end)
                time = high if low > begin else begin
                self.go(state, begin, low)
                record(time, is_before=True)
                self.go(state, begin, high)
                record(time)
                begin, count, state = high, self.events(), self.saved(2)
        except FMICallException:  # a very short step may fail although the whole one succeeds
            pass
        self.is_looking = False
        self.fmu.setFMUstate(last)

    def narrowed(self, state, count, begin, end):
        """Return two times that bracket the next event, by bisection; the first may be `begin`."""
        low, high, enough = begin, end, max(FOUND * (end - begin), 4 * np.spacing(abs(end)))
        while high - low > enough:
            middle = (low + high) / 2
            self.go(state, begin, middle)
            low, high = (middle, high) if self.events() == count else (low, middle)
        return (low if low - begin > enough else begin), high

    def go(self, state, begin, end):
        """Restore a state at `begin`, and step to `end`."""
        self.fmu.setFMUstate(state)
        if end > begin:
            self.fmu.doStep(begin, end - begin)


class Supplier:
    """A callback for intermediate update, which sets the inputs at the times at which the FMU asks for them."""

    def __init__(self):
        self.slave = self.piece = None
        self.begin, self.count = 0.0, 0

    def __call__(self, environment, time, is_asked, *flags):
        if is_asked:
            self.count += 1
            self.slave.set(value(self.piece, time - self.begin))


class Slave3(Slave):
    def __init__(self, fmu, description, signals, supplier=None):
        super().__init__(fmu, description, signals)
        self.has_events = description.coSimulation.hasEventMode
        self.is_looking = False  # True while a step is tried; no messages are logged then
        self.supplier, self.is_asked = supplier, None  # until it is known
        if supplier:
            supplier.slave = self

    def enter_initialization(self, start, stop, tolerance):
        self.fmu.enterInitializationMode(tolerance=tolerance, startTime=start, stopTime=stop)

    def begin(self):
        if self.has_events:
            self.update()

    def update(self):
        """Iterate event mode, and enter step mode."""
        needs_more, ends = True, False
        while needs_more and not ends:
            needs_more, ends, *_ = self.fmu.updateDiscreteStates()
        if ends:
            raise Problem(f"{self.description.modelName} ended the simulation at an event")
        self.fmu.enterStepMode()

    def change(self, set_values):
        if self.has_events:
            self.fmu.enterEventMode()
        set_values()
        if self.has_events:
            self.update()

    def follows(self, begin, end, piece):
        """Return True if the FMU asks for inputs within a step; the first one is tried."""
        if self.supplier:
            self.supplier.begin, self.supplier.piece = begin, piece
        if self.is_asked is None:
            self.is_asked = bool(self.supplier) and self._is_asked(begin, end)
            if not self.is_asked and self.signals.moving:
                warnings.warn(f"the FMU keeps '{self.signals.moving[0]}' constant over each step, although it moves positions; expected FMI 2.0, which follows its derivatives", stacklevel=2)
        return self.is_asked

    def _is_asked(self, begin, end):
        state, self.is_looking = self.fmu.getFMUState(), True
        try:
            self.advance(begin, end, None, lambda time: None, None)
        except (FMICallException, Problem):  # is reported if the step fails again
            pass
        finally:
            self.fmu.setFMUState(state)
            self.fmu.freeFMUState(state)
            self.is_looking = False
        return self.supplier.count > 0

    def step(self, begin, end, piece, record):
        if piece is None or self.follows(begin, end, piece):
            parts = [(begin, end, None)]
        else:
            parts = [(begin, end, piece[0])] if self.signals.moving else self.constant_halves(piece, begin, end)
        for low, high, constant in parts:
            if constant is not None:
                self.set(constant)
            self.advance(low, high, constant, lambda time: None if piece is None else value(piece, time - begin), record)
        if piece is not None:
            self.set(value(piece, end - begin))

    def advance(self, time, end, constant, inputs, record):
        """Step to `end` through all events, with the inputs `constant`; inputs(time) are the true inputs, for rows."""
        while time < end:
            is_event, ends, is_early, last = self.fmu.doStep(time, end - time)
            if ends:
                raise Problem(f"{self.description.modelName} ended the simulation at {last:.9g} s")
            if is_early and not is_event and last <= time:
                raise Problem(f"{self.description.modelName} does not advance from {time:.9g} s")
            time = last if is_early else end
            if is_event:
                self.show(time, inputs, record, is_before=True)
                self.fmu.enterEventMode()
                self.update()
                self.show(time, inputs, record)
                if constant is not None:
                    self.set(constant)

    def show(self, time, inputs, record, is_before=False):
        """Add a row with the true inputs of that time, before or after an event."""
        if record and inputs(time) is not None:
            self.set(inputs(time))
        if record:
            record(time, is_before)

    def free(self):
        pass


def _size(piece, step):
    """Return bounds of the polynomials over a step."""
    return np.sum(abs(piece) * (step ** np.arange(len(piece)))[:, None], axis=0)


def _jumps(before, piece, step):
    """Return True if a polynomial does not begin at the last value of the one before; `before` is that value and its bound."""
    ended, size = before
    return np.any(abs(piece[0] - ended) > NEAR * np.maximum(size, _size(piece, step)))


def _steps(signals, start, stop, interval):
    """Yield (begin, end, True if `end` is a communication point); steps also end at the breaks of inputs."""
    time, count, near = start, 0, NEAR * interval
    while time < stop:
        count += 1
        point = start + count * interval
        point = stop if point > stop - near else point
        for end in [*(signals.breaks_between(time, point, near) if signals else ()), point]:
            yield time, end, end == point
            time = end


def _run(slave, recorder, steps, record_events, feedback=None):
    """Take the steps, (begin, end, polynomials of the inputs, is_point), with rows at communication points and at events; apply the feedback after each."""

    def add_row(time, is_before=False):
        if not (is_before and time - recorder.lastSampleTime <= 4 * np.spacing(abs(time))):  # a communication point at an event has the row before it
            recorder.sample(time, force=True)

    record, before = add_row if record_events else None, None
    for time, end, piece, is_point in steps:
        if before is not None and _jumps(before, piece, end - time):
            if record:
                record(time, is_before=True)
            slave.change(lambda: slave.set(piece[0]))  # noqa: B023 - called at once
            if record:
                record(time)
        slave.step(time, end, piece, record)
        if is_point and recorder.lastSampleTime != end:  # an event at this point has added rows
            recorder.sample(end, force=True)
        if feedback:
            feedback.apply(end)
        before = None if piece is None else (value(piece, end - time), _size(piece, end - time))


def check_platform(archive):
    if platform not in supported_platforms(archive):
        raise Problem(f"{archive} has libraries for {', '.join(supported_platforms(archive)) or 'no platform'}, not for {platform}; expected an FMU that was built for this machine")


def co_simulate(archive, description, start_values, signals, output, interval, start, stop, tolerance=None, feedback=None, record_events=True, logger=None, debug_logging=True, visible=False, fmi_call_logger=None):
    """
    Simulate an FMU; return a structured array of the time, in s, and the variables named in `output`.

    A `tolerance` of None leaves the choice to the FMU. `feedback` is the function of Feedback, in place of `signals`. `logger` is called as by FMPy, but not for steps that are repeated to locate events.
    Raise Interrupted if a step fails, and Problem if the FMU has no library for this platform.
    """
    check_platform(archive)
    folder = extract(archive)
    slave = None

    def log(*words):
        if logger and not (slave and slave.is_looking):
            logger(*words)

    try:
        is_third = description.fmiVersion.startswith("3")
        has_events = is_third and description.coSimulation.hasEventMode
        abilities = description.coSimulation
        supplier = Supplier() if is_third and signals and abilities.providesIntermediateUpdate and abilities.canGetAndSetFMUstate else None
        within = {"intermediate_update": supplier, "required_intermediate_variables": [v.valueReference for v in signals.variables]} if supplier else {}
        with loading():
            fmu = instantiate_fmu(folder, description, "CoSimulation", visible, debug_logging, log, fmi_call_logger, None, has_events, has_events, **within)
        recorder = None
        try:
            slave = Slave3(fmu, description, signals, supplier) if is_third else Slave2(fmu, description, signals)
            steps = ((begin, end, signals and signals.over(begin, end), is_point) for begin, end, is_point in _steps(signals, start, stop, interval))
            first = next(steps)
            slave.initialize(start_values, first[2], start, stop, tolerance)
            slave.begin()
            follow = feedback and Feedback(feedback, slave, description)
            if follow:
                follow.apply(start)
            recorder = Recorder(fmu, description, output, interval)
            recorder.sample(start, force=True)
            _run(slave, recorder, itertools.chain([first], steps), record_events, follow)
            fmu.terminate()
        except (FMICallException, Problem) as problem:
            if recorder is None:
                raise
            raise Interrupted(recorder.result(), problem) from None
        finally:
            if slave:
                slave.free()
            fmu.freeInstance()
        return recorder.result()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
