"""An FMU with events under its system's plan, by FMI 2.0, by FMI 3.0, or by FMI 3.0 through event mode."""

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave

import fmi3
import fmu

from .system import course

EVENT_LIMIT = 100000  # largest number of events that the importer handles


class Built3(fmi3.Instance):
    """An instance from an unpacked folder instead of a name."""

    def __init__(self, folder, **options):
        self.description = fmpy.read_model_description(str(folder))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.messages, self.time = [], 0.0
        self.fmu = FMU3Slave(guid=self.description.instantiationToken, unzipDirectory=str(folder), instanceName="instance",
                             modelIdentifier=self.description.coSimulation.modelIdentifier)  # fmt: skip
        self.fmu.component = None
        self.fmu.instantiate(loggingOn=True, logMessage=self._log, **options)

    def problem(self):
        return next((text for status, _, text in reversed(self.messages) if status >= fmu.DISCARD), "")


class By2:
    """Importer by FMI 2.0, as the simulation needs it."""

    def __init__(self, system, folder):
        from .simulation import Built

        self.system, self.instance = system, Built(folder)

    def initialize(self):
        self.instance.initialize({}, self.system.plan.tolerance, start_time=self.system.plan.start_time)

    def read(self):
        names, integers = [*self.system.states, *self.system.switches.reals], self.system.switches.integers
        instance = self.instance
        return [*instance.fmu.getReal(instance.vr(*names)), *(instance.fmu.getInteger(instance.vr(*integers)) if integers else [])]

    def step(self, time, end):
        self.instance.fmu.doStep(time, end - time)

    def save(self):
        return self.instance.fmu.getFMUstate()

    def restore(self, saved):
        self.instance.fmu.setFMUstate(saved)
        self.instance.free_state(saved)


class By3(By2):
    def __init__(self, system, folder):
        options = dict(eventModeUsed=True, earlyReturnAllowed=True) if system.plan.event_mode else {}
        self.system, self.instance = system, Built3(folder, **options)

    def initialize(self):
        plan = self.system.plan
        self.instance.initialize(tolerance=plan.tolerance, startTime=plan.start_time)
        if plan.event_mode:
            self.go_through()

    def go_through(self):
        for _ in range(100):
            again, terminate, *_ = self.instance.fmu.updateDiscreteStates()
            if terminate:
                raise AssertionError("the FMU wants to end the simulation")
            if not again:
                self.instance.fmu.enterStepMode()
                return
        raise AssertionError("the discrete states are never up to date")

    def read(self):
        instance, integers = self.instance, self.system.switches.integers
        reals = instance.get(*self.system.states, *self.system.switches.reals)
        return [*reals, *(instance.fmu.getInt32(instance.vr(*integers)) if integers else [])]

    def step(self, time, end):
        fmu3 = self.instance.fmu
        for _ in range(EVENT_LIMIT):
            need, terminate, early, last = fmu3.doStep(time, end - time)
            if not self.system.plan.event_mode and (need or early):
                raise AssertionError("a step ends early though nobody allowed it")
            if need:
                fmu3.enterEventMode()
                self.go_through()
            if terminate or not early:
                return
            if not time <= last <= end:
                raise AssertionError(f"a step from {time!r} to {end!r} ends at {last!r}")
            time = last
            if time >= end:
                return
        raise AssertionError("events without end")

    def save(self):
        return self.instance.fmu.getFMUState()

    def restore(self, saved):
        self.instance.fmu.setFMUState(saved)
        self.instance.fmu.freeFMUState(saved)


def simulate(system, folder, record):
    importer = (By2 if system.plan.fmi == 2 else By3)(system, folder)
    try:
        importer.initialize()
        record.rows.append(importer.read())
        for step in course(system):
            saved = importer.save() if step.action.rewind else None
            importer.step(step.time, step.end)
            row = importer.read()
            if saved is not None:
                importer.restore(saved)
                importer.step(step.time, step.end)
                again = importer.read()
                if system.method != "bdf" and again != row:
                    record.wrong = f"the step from {step.time!r} gives other bits when repeated: {row} and {again}"
            record.rows.append(row)
    except FMICallException as error:
        record.rejection = importer.instance.problem()
        if not record.rejection:
            record.wrong = f"{error} without a message"
    finally:
        importer.instance.free()
