"""Wrap co-simulation FMUs for a master: values by name, steps, saved states."""

import tempfile
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave

ROOT = Path(__file__).resolve().parent.parent.parent
FMUS = ROOT / "build" / "fmu"


class Slave:
    """A co-simulation FMU with its current time."""

    def __init__(self, archive, **starts):
        self.folder = tempfile.TemporaryDirectory()  # deleted with the slave
        folder = fmpy.extract(archive, self.folder.name)
        description = fmpy.read_model_description(folder)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName=description.modelName,
                             modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
        self.fmu.instantiate()
        self.start(**starts)

    def start(self, tolerance=None, **starts):
        self.fmu.setupExperiment(startTime=0.0, tolerance=tolerance)
        self.set(**starts)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def restart(self, tolerance=None, **starts):
        self.fmu.reset()
        self.start(tolerance, **starts)

    def set(self, **values):
        if values:
            self.fmu.setReal([self.references[name] for name in values], list(values.values()))

    def get(self, *names):
        values = self.fmu.getReal([self.references[name] for name in names])
        return values[0] if len(names) == 1 else values

    def set_derivatives(self, name, derivatives):
        """Set the derivatives of an input for the next step, from order 1 on."""
        if len(derivatives):
            references = [self.references[name]] * len(derivatives)
            self.fmu.setRealInputDerivatives(references, list(range(1, len(derivatives) + 1)), [float(d) for d in derivatives])

    def partial(self, output, known):
        """Return the partial derivative of an output, or of der(STATE), by a state or an input."""
        return self.fmu.getDirectionalDerivative([self.references[output]], [self.references[known]], [1.0])[0]

    def step_to(self, target):
        self.fmu.doStep(self.time, target - self.time)
        self.time = target

    def save(self):
        return self.fmu.getFMUstate(), self.time

    def restore(self, saved):
        """Restore a saved state, and free it."""
        state, self.time = saved
        self.fmu.setFMUstate(state)
        self.fmu.freeFMUstate(state)
