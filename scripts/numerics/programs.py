"""How programs of others run: for how long, how often, how quietly; and FMPy's CVode, which several comparisons have."""

import contextlib
import os
import time
import weakref

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Model

from fmu import archive, unpacked
from numerics.driver import POINTS

SHORT = 1e-3  # seconds of what other work on the machine rarely interrupts
PATIENCE = 20.0  # seconds, after which a run counts as never ending


def timed(run):
    """
    (seconds, result): by the processor's time, or, of what is short, by the machine's. Where a virtual machine is denied its processor, the processor's clock is
    set back by microseconds, and the shortest of many times would be one of those.
    """
    passed, of_processor = time.perf_counter(), time.process_time()
    result = run()
    passed, of_processor = time.perf_counter() - passed, time.process_time() - of_processor
    return passed if passed < SHORT else of_processor, result


def fastest(run, budget=2.0, repeats=10):
    """The shortest time of several runs within a budget of seconds, and the last result."""
    best, spent, result = np.inf, 0.0, None
    while repeats > 0 and (spent < budget or best == np.inf):
        taken, result = timed(run)
        best, spent, repeats = min(best, taken), spent + taken, repeats - 1
    return best, result


def impatient(function, patience=PATIENCE):
    """The function, which raises TimeoutError from so many seconds on."""
    deadline = time.perf_counter() + patience

    def call(*arguments):
        if time.perf_counter() > deadline:
            raise TimeoutError
        return function(*arguments)

    return call


@contextlib.contextmanager
def silence():
    """What C libraries write to the standard error, too."""
    saved, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    try:
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(null)


class FmpyCvode:
    """Model exchange by FMPy, whose CVode knows no Jacobian; loading the FMU is not in the time."""

    def __init__(self, name, starts, end, outputs, tolerance):
        description = read_model_description(archive(name))
        self.folder, self.outputs = str(unpacked(name)), outputs
        self.instance = FMU2Model(guid=description.guid, unzipDirectory=self.folder, instanceName="peer",
                                  modelIdentifier=description.modelExchange.modelIdentifier)  # fmt: skip
        self.instance.instantiate()
        weakref.finalize(self, self.instance.freeInstance)
        self.words = dict(model_description=description, fmu_instance=self.instance, fmi_type="ModelExchange", solver="CVode",
                          stop_time=end, output_interval=end / POINTS, relative_tolerance=tolerance, start_values=starts,
                          output=outputs, record_events=False)  # fmt: skip

    def simulate(self):
        """A row for each of the communication points, unless it gives up."""
        with silence():
            self.instance.reset()
            result = simulate_fmu(self.folder, **self.words)
        return np.array([result[output] for output in self.outputs]).T[1:]
