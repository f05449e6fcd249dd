"""A built FMU under its system's plan, in a separate process, so that a crash or a hang is an outcome."""

import multiprocessing
import random
from dataclasses import dataclass, field
from pathlib import Path

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

import fmu

from . import switching_simulation
from .build import Wrong
from .system import course

POINTS = 3  # number of communication points at which all available values are read
ORDERS = 3  # orders of output derivatives


class Built(fmu.Instance):
    """An instance from an unpacked folder instead of a name."""

    def __init__(self, folder):
        self.description = fmpy.read_model_description(str(folder))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.messages, self.time = [], 0.0
        self.fmu = FMU2Slave(
            guid=self.description.guid, unzipDirectory=str(folder), instanceName="instance",
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )  # fmt: skip
        self.callbacks = fmu.callbacks_of(self._log)
        self.fmu.component = None
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=True)

    def problem(self):
        return next((text for status, _, text in reversed(self.messages) if status >= fmu.DISCARD), "")


@dataclass
class Point:
    """The FMU's values at a communication point, with the coefficients of the inputs."""

    time: float
    state: list
    parameters: dict
    inputs: dict
    values: dict  # derivatives and results by name
    directions: list = field(default_factory=list)  # (names, seed, unknowns, values)
    output_derivatives: dict = field(default_factory=dict)  # (name, order): value


@dataclass
class Record:
    rows: list = field(default_factory=list)  # states at the communication points
    points: list = field(default_factory=list)
    rejection: str = None
    unavailable: list = field(default_factory=list)  # messages of failed derivatives
    wrong: str = None


def try_call(record, instance, call):
    try:
        return call()
    except FMICallException:
        record.unavailable.append(instance.problem())
        return None


def read_point(record, instance, system, step, time):
    states, rates = system.positions + system.velocities, system.rates
    results = [v.name for v in instance.description.modelVariables if v.type == "Real" and v.name not in system.states
               and v.causality in ("output", "local") and not v.name.startswith("der(")]  # fmt: skip
    inputs = {name: [value] for name, value in system.inputs.items()} if step is None else step.inputs_at_end()
    parameters = dict(system.parameters) if step is None else step.parameters
    values = try_call(record, instance, lambda: instance.fmu.getReal(instance.vr(*rates, *results)))
    if values is None:
        return
    found = dict(zip(rates + results, values))
    constants = parameters | {mode: found[mode] for mode in system.modes}
    point = Point(time, instance.fmu.getReal(instance.vr(*states)), constants, inputs, found)
    record.points.append(point)
    choose = random.Random(f"{system.name} {time}")
    outputs = [*rates, *system.outputs]
    for knowns in (states, list(parameters), list(inputs)):
        if knowns:
            seed = [choose.uniform(-1, 1) for _ in knowns]
            along = try_call(
                record,
                instance,
                lambda: instance.fmu.getDirectionalDerivative(instance.vr(*outputs), instance.vr(*knowns), seed),
            )
            if along is not None:
                point.directions.append((knowns, seed, outputs, along))
    highest = int(instance.description.coSimulation.maxOutputDerivativeOrder or 0)
    for name in [*states, *system.outputs]:
        for order in range(1, min(ORDERS, highest) + 1):
            derivative = try_call(
                record, instance, lambda: instance.fmu.getRealOutputDerivatives(instance.vr(name), [order])[0]
            )
            if derivative is not None:
                point.output_derivatives[name, order] = derivative


def take_step(record, instance, system, step, states):
    """Take one step, or the same step twice if the plan rewinds."""
    length = step.end - step.time
    saved = instance.fmu.getFMUstate() if step.action.rewind else None
    instance.fmu.doStep(step.time, length)
    row = instance.fmu.getReal(states)
    if saved is not None:
        instance.fmu.setFMUstate(saved)
        instance.free_state(saved)
        instance.fmu.doStep(step.time, length)
        again = instance.fmu.getReal(states)
        if system.method != "bdf" and list(again) != list(row):
            record.wrong = f"the step from {step.time!r} gives other bits when repeated: {row} and {again}"
        row = again
    record.rows.append(list(row))


def simulate(system, folder, record):
    plan = system.plan
    instance = Built(folder)
    states = instance.vr(*system.states)
    selected = {round(i * (len(plan.actions) - 1) / (POINTS - 1)) for i in range(1, POINTS)}
    try:
        instance.initialize({}, plan.tolerance, start_time=plan.start_time)
        record.rows.append(list(instance.fmu.getReal(states)))
        read_point(record, instance, system, None, plan.start_time)
        for i, step in enumerate(course(system)):
            instance.set({**step.action.parameters, **step.action.inputs})
            for name, derivatives in step.action.input_derivatives.items():
                if derivatives:
                    orders = list(range(1, len(derivatives) + 1))
                    instance.fmu.setRealInputDerivatives(instance.vr(name) * len(orders), orders, derivatives)
            take_step(record, instance, system, step, states)
            if i in selected:
                read_point(record, instance, system, step, step.end)
    except FMICallException as error:
        record.rejection = instance.problem()
        if not record.rejection:
            record.wrong = f"{error} without a message"
    finally:
        instance.free()


def in_child(pipe, system, folder):
    record = Record()
    try:
        (switching_simulation.simulate if system.switches else simulate)(system, folder, record)
    except Exception as error:
        record.wrong = f"{type(error).__name__}: {error}"
    pipe.send(record)
    pipe.close()


def simulate_apart(system, folder, time_limit):
    """Return the Record; raise Wrong for a crash or a hang."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    child = context.Process(target=in_child, args=(theirs, system, Path(folder)))
    child.start()
    theirs.close()
    try:
        if not ours.poll(time_limit):
            raise Wrong(f"the FMU runs for more than {time_limit} s")
        return ours.recv()
    except EOFError as error:
        child.join()
        raise Wrong(f"the FMU's process ended with {child.exitcode}") from error
    finally:
        child.kill()
        child.join()
        ours.close()
