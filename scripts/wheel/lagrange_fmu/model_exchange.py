"""Start an FMU at given values, and evaluate its derivatives and their directional derivatives."""

import shutil
from contextlib import contextmanager

import numpy as np
from fmpy import extract
from fmpy.fmi1 import FMICallException

from .loading import loading
from .models import Model2, Model3, Slave2, Slave3
from .problem import Problem
from .running import fmu_of, is_fmu
from .simulation import described
from .variables import checked_start, settable, units_of

ADJOINT = ("--adjoint",)  # argument of lagc
RESTS = {".closed": 1, ".sliding": 0}  # suffixes of mode variables, and the value at which the mode constrains the motion
COUNTERS = {"solverSteps", "derivativeEvaluations", "jacobianEvaluations", "solverHandovers", "events"}  # discrete variables that are not modes


def along(of, by):
    """Return the name of the variable d(of)/d(by) in an FMU of `lagc --along`; `of` is a state, der(STATE) or an output."""
    return f"der({of[4:-1]}.by.{by})" if of.startswith("der(") else f"{of}.by.{by}"


def lagc_options(by):
    """Return the arguments of lagc that add the variational equations for these names."""
    return [word for name in by for word in ("--along", name)]


class Point:
    """
    An FMU that is restarted repeatedly at a point.

    The lists `states`, `derivatives`, `settable` and `outputs` leave out the sensitivities NAME.by.PARAMETER, where `by` lists the parameters.
    """

    def __init__(self, model, description, values, by=(), messages=()):
        """Wrap a model; `values` by name are set at each start, and `messages` is the list to which the model logs."""
        self.model, self.values, self.messages = model, values, messages
        self.in_series = None  # the Point of the same system in co-simulation with sensitivities as states, which stops at events
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
        self.description, self.name, self.units = description, description.modelName, units_of(description)
        self.limits = {v.name: tuple(float(end) if end is not None else none for end, none in ((v.min, -np.inf), (v.max, np.inf))) for v in description.modelVariables}
        self.nominals = {v.name: abs(float(v.nominal or 1.0)) for v in description.modelVariables}
        self.starts = {v.name: float(v.start) for v in description.modelVariables if v.name in self.states}
        self.indicator_count = description.numberOfEventIndicators
        modes = [v for v in description.modelVariables if v.variability == "discrete" and v.causality == "local" and v.name not in COUNTERS]
        self.numbers, self.switches = ([v.name for v in modes if (v.type in ("Real", "Float64")) == is_number] for is_number in (True, False))

    def read(self, names):
        return np.array(self.model.getReal([self.references[name] for name in names])) if names else np.empty(0)

    def given(self, names, states, values=None):
        """
        Return the start values of the variables `names`, a list, after a start with `values` that gave `states`.

        For a state this is the value before initialization moved it onto the constraints.
        """
        known = self.values | (values or {})
        read = dict(zip(names, self.read(names)))
        return [known[name] if name in known else self._unmoved(name, read[name], known, states) if name in self.states else read[name] for name in names]

    def _unmoved(self, name, moved, values, states):
        """
        Return the value of a state that leads to the same start.

        The candidates are the start value of modelDescription.xml, and `moved`, the value after initialization, for a start value that depends
        on parameters. Raise Problem if neither reproduces `states`.
        """
        for value in (self.starts[name], moved):
            if np.allclose(self.start(values=values | {name: value}), states, rtol=1e-9, atol=1e-12):
                return value
        raise Problem(f"the start value of '{name}' follows from parameters, and constraints move it; expected a value for it by start_values")

    def start(self, states=None, values=None):
        """Initialize the FMU at `states` and `values` by name; return the states after initialization."""
        values = self.values | (values or {}) | (dict(zip(self.states, states)) if states is not None else {})
        self.model.start_over()
        if values:
            self.model.setReal([self.references[name] for name in values], list(values.values()))
        self.model.enterInitializationMode()
        self.model.exitInitializationMode()
        return self._continue()

    def _continue(self):
        """Leave event mode for continuous-time mode; return the states."""
        self.model.newDiscreteStates()
        self.model.enterContinuousTimeMode()
        return self.read(self.states)

    def projected(self, at, states):
        """
        Project `states` onto the constraints, among them the contacts that are closed and the friction that sticks at the states `at`.

        Return None if a closed contact opens or sticking friction slides. Event mode does the projection, since it moves fixed coordinates, too.
        In a system with event indicators and without such constraints initialization does it, since event mode may change other modes.
        """
        self.start(at)
        constraining = self.constraining()
        if self.indicator_count and not constraining:
            return self.start(states)
        self.set_states(states)
        self.model.enterEventMode()
        moved = self._continue()
        return moved if self.constraining() == constraining else None

    def constraining(self):
        """Return the names of the closed contacts and of the sticking friction."""
        modes = dict(zip([*self.numbers, *self.switches], self.modes()))
        at_rest = [name.removesuffix(end) for name, mode in modes.items() for end, rest in RESTS.items() if name.endswith(end) and mode == rest]
        return [name for name in at_rest if modes.get(name.removesuffix(".friction") + ".closed") != 0]  # friction of an open contact holds nothing

    def modes(self):
        """Return the values of all mode variables, in the order of `numbers` and `switches`."""
        numbers, switches = ([self.references[name] for name in names] for names in (self.numbers, self.switches))
        return [*(self.model.getReal(numbers) if numbers else ()), *(self.model.whole_numbers(switches) if switches else ())]

    def differing(self, modes, others):
        """Return the names of the mode variables whose values differ."""
        return [name for name, mode, other in zip([*self.numbers, *self.switches], modes, others) if mode != other]

    def set_states(self, states):
        """Set the continuous states, in the order of `self.states`."""
        self.model.set_states(np.ascontiguousarray(states, dtype=float))

    def indicators(self):
        """Return the event indicators."""
        return self.model.indicators(self.indicator_count) if self.indicator_count else np.empty(0)

    def jacobian(self, unknowns, knowns):
        """Return the matrix d(unknowns)/d(knowns), by a directional derivative for each known."""
        references = [self.references[name] for name in unknowns]
        columns = [self.model.getDirectionalDerivative(references, [self.references[name]], [1.0]) for name in knowns] if unknowns else []
        return np.array(columns).T.reshape(len(unknowns), len(knowns))


@contextmanager
def _opened(fmu, description, in_series, messages):
    """Extract and instantiate the FMU; yield a model that appends its log messages to the list `messages`."""
    folder = extract(str(fmu))
    kind = {("2.0", False): Model2, ("2.0", True): Slave2, ("3.0", False): Model3, ("3.0", True): Slave3}[description.fmiVersion, in_series]
    try:
        with loading():
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
    Yield the Point of an FMU, or of a system, which is built first, with `values` by name.

    By default it is in model exchange with the directional derivatives of FMI 2.0, or, if `adjoint`, with the adjoint derivatives of FMI 3.0.
    With `by` it is in co-simulation and has the sensitivities to these names as variables; if `stops_at_events`, it is of FMI 3.0.
    If `in_steps`, it is in co-simulation without derivatives. The list `messages` receives its log messages.
    Raise Problem if the FMU lacks these abilities or fails; the text of a failure contains "cannot" and `what`.
    """
    messages = [] if messages is None else messages
    options = ADJOINT if adjoint else lagc_options(by)
    with fmu_of(system, method=method, fmi=3 if (adjoint or stops_at_events) and not is_fmu(system) else None, words=options) as fmu:
        description = described(fmu)
        if not (stops_at_events or in_steps):
            _check_abilities(fmu, description, adjoint)
        values = checked_start(values, description)
        with _opened(fmu, description, in_steps or bool(by), messages) as model:
            try:
                yield Point(model, description, values, by, messages)
            except FMICallException as problem:
                raise Problem("; ".join([f"{description.modelName} cannot {what}", *(messages or [str(problem)])])) from None
