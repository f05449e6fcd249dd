"""Time, limit and silence the runs of other programs; and run FMPy's CVode, which several comparisons use."""

import contextlib
import os
import time
import weakref

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Model

from fmu import archive, unpacked
from numerics.driver import POINTS

SHORT = 1e-3  # s, below which other load rarely interrupts a run
PATIENCE = 20.0  # s, after which a run is stopped


def timed(run):
    """
    Call run(); return the seconds and its result.

    The time is processor time, or for short runs wall-clock time. When a virtual machine loses its processor, the processor clock goes back by
    microseconds. The minimum of many short times would then be wrong.
    """
    passed, of_processor = time.perf_counter(), time.process_time()
    result = run()
    passed, of_processor = time.perf_counter() - passed, time.process_time() - of_processor
    return passed if passed < SHORT else of_processor, result


def fastest(run, budget=2.0, repeats=10):
    """Return the shortest time of several runs within a budget in s, and the last result."""
    best, spent, result = np.inf, 0.0, None
    while repeats > 0 and (spent < budget or best == np.inf):
        taken, result = timed(run)
        best, spent, repeats = min(best, taken), spent + taken, repeats - 1
    return best, result


def with_time_limit(function, patience=PATIENCE):
    """Return the function, which raises TimeoutError once `patience` seconds have passed from now."""
    deadline = time.perf_counter() + patience

    def call(*arguments):
        if time.perf_counter() > deadline:
            raise TimeoutError
        return function(*arguments)

    return call


@contextlib.contextmanager
def silence():
    """Suppress stderr, also the output of C libraries."""
    saved, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    try:
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(null)


class FmpyCvode:
    """Model exchange by FMPy's CVode, which gets no Jacobian; loading the FMU is not part of the time."""

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
        """Return a row for each communication point; fewer if the simulation fails."""
        with silence():
            self.instance.reset()
            result = simulate_fmu(self.folder, **self.words)
        return np.array([result[output] for output in self.outputs]).T[1:]
