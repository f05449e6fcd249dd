"""
A co-simulation from step to step, of FMI 2.0 and 3.0: rows at the communication points and at events, with inputs that are polynomials between them.

In FMI 2.0 the FMU follows inputs by their derivatives. Where it cannot, as in FMI 3.0, each half of a smooth piece has a constant input of the same mean and first
moment, which is right to the fourth order where the rates are linear in the input (commutator-free Magnus integrator, Blanes and Moan 2006, with two exponentials).

An event is two rows of one time: just before it, and behind it. FMI 3.0 ends its steps at events. In FMI 2.0 the FMU's number of events tells that one lies in a
step; the step is repeated from the saved state to halve the time, until it is known. Then the FMU goes on from the end of the step as if nobody had looked.
"""

import itertools
import shutil
import warnings
from ctypes import byref

import numpy as np
from fmpy import extract, platform, supported_platforms
from fmpy.fmi1 import FMICallException
from fmpy.simulation import Recorder, apply_start_values, instantiate_fmu, settable_in_initialization_mode, settable_in_instantiated

from .problem import Problem
from .signals import REAL, value

EVENTS = "events"  # the FMU's variable that counts them
NEAR = 1e-9  # of a step: times that differ by less are one
FOUND = 1e-10  # of a step, to which the time of an event is known
CROWD = 20  # events that are found in a step; more are not told apart
OPTIONS = ("start_time", "stop_time", "output_interval", "relative_tolerance", "record_events", "logger", "debug_logging", "visible", "fmi_call_logger")


class Interrupted(Exception):
    """A step failed; has the rows before it, and why, as `reached` and `cause`."""

    def __init__(self, reached, cause):
        super().__init__(str(cause))
        self.reached, self.cause = reached, cause


class Slave:
    """An FMU with its inputs."""

    def __init__(self, fmu, description, signals):
        self.fmu, self.description, self.signals = fmu, description, signals
        self.setters = self._setters(signals) if signals else []

    @staticmethod
    def _setters(signals):
        """(type, references, columns) of variables of one type."""
        ends = np.cumsum([0, *signals.sizes])
        found = {}
        for variable, begin, end in zip(signals.variables, ends[:-1], ends[1:]):
            references, columns = found.setdefault(variable.type, ([], []))
            references.append(variable.valueReference)
            columns.extend(range(begin, end))
        return [(kind, *both) for kind, both in found.items()]

    def set(self, values):
        """The inputs, held."""
        for kind, references, columns in self.setters:
            numbers = [float(values[i]) if kind in REAL else int(round(values[i])) for i in columns]
            getattr(self.fmu, f"set{'Integer' if kind == 'Enumeration' else kind}")(references, numbers)

    def initialize(self, start_values, piece, start, stop, tolerance):
        """piece: of the inputs in the first step, or None."""
        left = apply_start_values(self.fmu, self.description, start_values, settable=settable_in_instantiated)
        self.enter_initialization(start, stop, tolerance)
        left = apply_start_values(self.fmu, self.description, left, settable=settable_in_initialization_mode)
        if piece is not None:
            self.set(piece[0])
        self.fmu.exitInitializationMode()
        if left:
            raise Problem(f"{self.description.modelName} takes no start values of {', '.join(left)}")

    def held_halves(self, piece, begin, end):
        """(begin, end, value) of constant inputs in place of a polynomial, which may be constant itself."""
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
        self.is_looking = False  # for events, when nothing new is logged

    def enter_initialization(self, start, stop, tolerance):
        self.fmu.setupExperiment(tolerance=tolerance, startTime=start, stopTime=stop)
        self.fmu.enterInitializationMode()

    def begin(self):
        pass

    def jump(self, values):
        self.set(values)

    def events(self):
        return self.fmu.getInteger(self.counter)[0]

    def step(self, begin, end, piece, record):
        """record(time, is_forced) makes a row; piece: of the inputs, or None."""
        parts = [(begin, end, None)]
        if piece is not None and self.follows:
            self.follow(piece)
        elif piece is not None:
            parts = self.held_halves(piece, begin, end)
        saved, count = (self.saved(0), self.events()) if self.can_find and record else (None, 0)
        for low, high, held in parts:
            if held is not None:
                self.set(held)
            self.fmu.doStep(low, high - low)
        if not self.follows and piece is not None:
            self.set(value(piece, end - begin))
        elif saved is not None and self.events() > count:
            self.find_events(saved, count, begin, end, record)

    def follow(self, piece):
        """The polynomials, by derivatives of the orders that they have."""
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

    def saved(self, place):
        """The state, in the memory that this place has."""
        if place == len(self.states):
            self.states.append(self.fmu.getFMUstate())
        else:
            self.fmu.fmi2GetFMUstate(self.fmu.component, byref(self.states[place]))
        return self.states[place]

    def free(self):
        for state in self.states:
            self.fmu.freeFMUstate(state)

    def find_events(self, state, count, begin, end, record):
        """Rows of the events of a step, at whose end the FMU is and stays."""
        last, total = self.saved(1), self.events()
        self.is_looking = True
        try:
            for _ in range(CROWD):
                if count == total:
                    break
                low, high = self.narrowed(state, count, begin, end)
                time = high if low > begin else begin
                self.go(state, begin, low)
                record(time)
                self.go(state, begin, high)
                record(time)
                begin, count, state = high, self.events(), self.saved(2)
        except FMICallException:  # so short a step may fail where the whole one does not
            pass
        self.is_looking = False
        self.fmu.setFMUstate(last)

    def narrowed(self, state, count, begin, end):
        """The times between which the next event is, of which the first may be the beginning."""
        low, high, enough = begin, end, max(FOUND * (end - begin), 4 * np.spacing(abs(end)))
        while high - low > enough:
            middle = (low + high) / 2
            self.go(state, begin, middle)
            low, high = (middle, high) if self.events() == count else (low, middle)
        return low, high

    def go(self, state, begin, end):
        self.fmu.setFMUstate(state)
        if end > begin:
            self.fmu.doStep(begin, end - begin)


class Slave3(Slave):
    is_looking = False

    def __init__(self, fmu, description, signals):
        super().__init__(fmu, description, signals)
        self.has_events = description.coSimulation.hasEventMode
        if signals and signals.moving:
            warnings.warn(f"FMI 3.0 holds '{signals.moving[0]}' over each step, as an input that moves something; expected FMI 2.0, which follows it", stacklevel=2)

    def enter_initialization(self, start, stop, tolerance):
        self.fmu.enterInitializationMode(tolerance=tolerance, startTime=start, stopTime=stop)

    def begin(self):
        if self.has_events:
            self.update()

    def update(self, values=None):
        """Through event mode, perhaps with other inputs."""
        if values is not None:
            self.set(values)
        needs_more, ends = True, False
        while needs_more and not ends:
            needs_more, ends, *_ = self.fmu.updateDiscreteStates()
        if ends:
            raise Problem(f"{self.description.modelName} ended the simulation at an event")
        self.fmu.enterStepMode()

    def jump(self, values):
        if self.has_events:
            self.fmu.enterEventMode()
            self.update(values)
        else:
            self.set(values)

    def step(self, begin, end, piece, record):
        parts = [(begin, end, None)] if piece is None else [(begin, end, piece[0])] if self.signals.moving else self.held_halves(piece, begin, end)
        for low, high, held in parts:
            if held is not None:
                self.set(held)
            self.reach(low, high, held, lambda time: None if piece is None else value(piece, time - begin), record)
        if piece is not None:
            self.set(value(piece, end - begin))

    def reach(self, time, end, held, inputs, record):
        """Through the events until then."""
        while time < end:
            is_event, ends, is_early, last = self.fmu.doStep(time, end - time)
            if ends:
                raise Problem(f"{self.description.modelName} ended the simulation at {last:.9g} s")
            if is_early and not is_event and last <= time:
                raise Problem(f"{self.description.modelName} makes no steps from {time:.9g} s on")
            time = last if is_early else end
            if is_event:
                self.show(time, inputs, record)
                self.fmu.enterEventMode()
                self.update()
                self.show(time, inputs, record)
                if held is not None:
                    self.set(held)

    def show(self, time, inputs, record):
        """A row with the inputs of that time."""
        if record and inputs(time) is not None:
            self.set(inputs(time))
        if record:
            record(time)

    def free(self):
        pass


def _size(piece, step):
    """Of polynomials over a step, at most."""
    return np.sum(abs(piece) * (step ** np.arange(len(piece)))[:, None], axis=0)


def _jumps(before, piece, step):
    """True if a polynomial begins at another value than the one before ended at; before: that value, and its size."""
    ended, size = before
    return np.any(abs(piece[0] - ended) > NEAR * np.maximum(size, _size(piece, step)))


def _steps(signals, start, stop, interval):
    """(begin, end, whether that is a communication point): the inputs' breaks are ends of steps too."""
    time, count, near = start, 0, NEAR * interval
    while time < stop:
        count += 1
        point = start + count * interval
        point = stop if point > stop - near else point
        for end in [*(signals.breaks_between(time, point, near) if signals else ()), point]:
            yield time, end, end == point
            time = end


def _run(slave, recorder, steps, record_events):
    """The steps, with rows at communication points and at events; each step's inputs are known."""
    record = (lambda time: recorder.sample(time, force=True)) if record_events else None
    before = None
    for time, end, piece, is_point in steps:
        if before is not None and _jumps(before, piece, end - time):
            if record and recorder.lastSampleTime != time:
                record(time)
            slave.jump(piece[0])
            if record:
                record(time)
        slave.step(time, end, piece, record)
        if is_point:
            recorder.sample(end, force=True)
        before = None if piece is None else (value(piece, end - time), _size(piece, end - time))


def co_simulate(archive, description, start_values, signals, output, interval, start, stop, tolerance=None, record_events=True, logger=None, debug_logging=True, visible=False, fmi_call_logger=None):
    """
    A structured array of time and the output, names of variables; Interrupted where a step fails. The tolerance is that of the FMU's experiment where none is given.
    logger: as FMPy's, which is not called for what is only tried.
    """
    if platform not in supported_platforms(archive):
        raise Problem(f"{archive} has no library for {platform} but for {', '.join(supported_platforms(archive)) or 'no platform'}; expected an FMU that was built for this machine")
    folder = extract(archive)
    slave = None

    def log(*words):
        if logger and not (slave and slave.is_looking):
            logger(*words)

    try:
        is_third = description.fmiVersion.startswith("3")
        has_events = is_third and description.coSimulation.hasEventMode
        fmu = instantiate_fmu(folder, description, "CoSimulation", visible, debug_logging, log, fmi_call_logger, None, has_events, has_events)
        recorder = None
        try:
            slave = (Slave3 if is_third else Slave2)(fmu, description, signals)
            steps = ((begin, end, signals and signals.over(begin, end), is_point) for begin, end, is_point in _steps(signals, start, stop, interval))
            first = next(steps)
            slave.initialize(start_values, first[2], start, stop, tolerance)
            slave.begin()
            recorder = Recorder(fmu, description, output, interval)
            recorder.sample(start, force=True)
            _run(slave, recorder, itertools.chain([first], steps), record_events)
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
