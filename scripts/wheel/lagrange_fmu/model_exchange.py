"""An FMU in model exchange: started at values, with its derivatives and their directional derivatives."""

import shutil
from contextlib import contextmanager

import numpy as np
from fmpy import extract
from fmpy.fmi1 import FMICallException

from .models import Model2, Model3, Slave2, Slave3
from .problem import Problem
from .running import fmu_of, is_fmu
from .simulation import check_start, described, units_of
from .variables import settable

ADJOINT = ("--adjoint",)  # words for lagc
RESTS = {".closed": 1, ".sliding": 0}  # ends of names of modes, with the value of one that constrains the motion
COUNTERS = {"solverSteps", "derivativeEvaluations", "jacobianEvaluations", "solverHandovers", "events"}  # what is discrete beside modes


def along(of, by):
    """The variable that is the derivative of a state, its derivative or an output by a value, where lagc derived these."""
    return f"der({of[4:-1]}.by.{by})" if of.startswith("der(") else f"{of}.by.{by}"


def words_for(by):
    """For lagc, which derives them so."""
    return [word for name in by for word in ("--along", name)]


class Point:
    """An FMU that is started again and again at a point; by: names, the derivatives by which are variables of their own, which are not listed."""

    def __init__(self, model, description, values, by=(), messages=()):
        """messages: what the model logs."""
        self.model, self.values, self.messages = model, values, messages
        self.in_series = None  # the same in co-simulation, where the derivatives are in its series and it stops at events
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.names = {reference: name for name, reference in self.references.items()}
        outputs = [v.name for v in description.modelVariables if v.causality == "output"]
        self.derivatives = [unknown.variable.name for unknown in description.derivatives]
        self.states = [unknown.variable.derivative.name for unknown in description.derivatives]
        ends = tuple(f".by.{name}" for name in by)
        self.derivatives, self.states, self.settable, self.outputs = (
            [name for name in names if not name.removesuffix(")").endswith(ends)] for names in (self.derivatives, self.states, settable(description), outputs)
        )
        self.inputs = [v.name for v in description.modelVariables if v.causality == "input"]
        self.name, self.units = description.modelName, units_of(description)
        self.limits = {v.name: tuple(float(end) if end is not None else none for end, none in ((v.min, -np.inf), (v.max, np.inf))) for v in description.modelVariables}
        self.starts = {v.name: float(v.start) for v in description.modelVariables if v.name in self.states}
        self.indicator_count = description.numberOfEventIndicators
        modes = [v for v in description.modelVariables if v.variability == "discrete" and v.causality == "local" and v.name not in COUNTERS]
        self.numbers, self.switches = ([v.name for v in modes if (v.type in ("Real", "Float64")) == is_number] for is_number in (True, False))

    def read(self, names):
        return np.array(self.model.getReal([self.references[name] for name in names])) if names else np.empty(0)

    def given(self, names, states, values=None):
        """What these started at, a list, where values by name were set and made these states; a state: before constraints moved it."""
        known = self.values | (values or {})
        read = dict(zip(names, self.read(names)))
        return [known[name] if name in known else self._unmoved(name, read[name], known, states) if name in self.states else read[name] for name in names]

    def _unmoved(self, name, moved, values, states):
        """What has to be set for the same start: what modelDescription.xml tells, or, where that follows parameters, what was found."""
        for value in (self.starts[name], moved):
            if np.allclose(self.start(values=values | {name: value}), states, rtol=1e-9, atol=1e-12):
                return value
        raise Problem(f"the start value of '{name}' follows parameters, and constraints move it; expected a value for it by start_values")

    def start(self, states=None, values=None):
        """The states that initialization makes of those, and of values by name."""
        values = self.values | (values or {}) | (dict(zip(self.states, states)) if states is not None else {})
        self.model.start_over()
        if values:
            self.model.setReal([self.references[name] for name in values], list(values.values()))
        self.model.enterInitializationMode()
        self.model.exitInitializationMode()
        return self._go_on()

    def _go_on(self):
        """From event mode; the states."""
        self.model.newDiscreteStates()
        self.model.enterContinuousTimeMode()
        return self.read(self.states)

    def held(self, at, states):
        """
        The nearest states to these that fulfil the constraints, among them the contacts that are closed and the frictions that stick in the states `at`; None
        where one of these does not stay so. Initialization keeps fixed coordinates, event mode moves them too, but what else can switch may do so there.
        """
        self.start(at)
        constraining = self.constraining()
        if self.indicator_count and not constraining:
            return self.start(states)
        self.set_states(states)
        self.model.enterEventMode()
        moved = self._go_on()
        return moved if self.constraining() == constraining else None

    def constraining(self):
        """The contacts that are closed and the frictions that stick, by name."""
        modes = dict(zip([*self.numbers, *self.switches], self.modes()))
        return [name.removesuffix(end) for name, mode in modes.items() for end, rest in RESTS.items() if name.endswith(end) and mode == rest]

    def modes(self):
        """Of what switches; the same list where that does the same."""
        numbers, switches = ([self.references[name] for name in names] for names in (self.numbers, self.switches))
        return [*(self.model.getReal(numbers) if numbers else ()), *(self.model.whole_numbers(switches) if switches else ())]

    def differing(self, modes, others):
        """The names of those that are not the same."""
        return [name for name, mode, other in zip([*self.numbers, *self.switches], modes, others) if mode != other]

    def set_states(self, states):
        """In the order of `states`."""
        self.model.set_states(np.ascontiguousarray(states, dtype=float))

    def indicators(self):
        """What changes its sign at events."""
        return self.model.indicators(self.indicator_count) if self.indicator_count else np.empty(0)

    def jacobian(self, unknowns, knowns):
        references = [self.references[name] for name in unknowns]
        columns = [self.model.getDirectionalDerivative(references, [self.references[name]], [1.0]) for name in knowns] if unknowns else []
        return np.array(columns).T.reshape(len(unknowns), len(knowns))


@contextmanager
def _opened(fmu, description, in_series, messages):
    """The FMU as a model, which appends what it logs to the messages."""
    folder = extract(str(fmu))
    kind = {("2.0", False): Model2, ("2.0", True): Slave2, ("3.0", False): Model3, ("3.0", True): Slave3}[description.fmiVersion, in_series]
    try:
        model = kind(guid=description.guid, unzipDirectory=folder, instanceName="model", modelIdentifier=description.modelExchange.modelIdentifier)
        model.begin(messages)
        try:
            yield model
        finally:
            model.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _check_abilities(fmu, description, adjoint):
    version, kind, what = ("3.0", "adjoint", "providesAdjointDerivatives") if adjoint else ("2.0", "directional", "providesDirectionalDerivative")
    if description.fmiVersion != version or not getattr(description.modelExchange, what, False):
        raise Problem(f"{fmu} has no {kind} derivatives of FMI {version}; expected a system, or an FMU that was built of it with --fmi {version[0]}")
    array = next((v.name for v in description.modelVariables if v.dimensions), None)
    if array is not None:
        raise Problem(f"'{array}' of {fmu} is an array, whose elements have no names; expected the system that the FMU was built of")


@contextmanager
def opened(system, values, method=None, what="be linearized there", adjoint=False, by=(), stops_at_events=False, messages=None, in_steps=False):
    """
    The Point of an FMU, or of a system that is built for it, with values by name; what it cannot do is a Problem. It has directional derivatives,
    as FMI 2.0 has them, or adjoint ones, of FMI 3.0; or it is in co-simulation, with the derivatives by these names as variables, of FMI 3.0 where
    it is to stop at events; or in co-simulation without derivatives, in_steps. messages: those of another one, to which what it logs is appended.
    """
    messages = [] if messages is None else messages
    words = ADJOINT if adjoint else words_for(by)
    with fmu_of(system, method=method, fmi=3 if (adjoint or stops_at_events) and not is_fmu(system) else None, words=words) as fmu:
        description = described(fmu)
        if not (stops_at_events or in_steps):
            _check_abilities(fmu, description, adjoint)
        check_start(values, description)
        with _opened(fmu, description, in_steps or bool(by), messages) as model:
            try:
                yield Point(model, description, values, by, messages)
            except FMICallException as problem:
                raise Problem("; ".join([f"{description.modelName} cannot {what}", *(messages or [str(problem)])])) from None
