"""
Simulate in model exchange, by CVODE of FMPy.

FMPy holds inputs over a step of CVODE. Here setTime of the FMU also sets the inputs, so that each evaluation has the inputs of its time.
"""

import shutil
import sys
from contextlib import contextmanager

import numpy as np
from fmpy import extract, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.simulation import instantiate_fmu

from .co_simulation import NEAR, Slave
from .loading import loading


class Failed(Exception):
    """CVODE stopped."""


@contextmanager
def failures():
    """Raise Failed where CVODE of FMPy fails; the FMU has logged why. Python prints no calls that failed in a callback."""

    def without_calls(unraisable, hook=sys.unraisablehook):
        if not isinstance(unraisable.exc_value, FMICallException):
            hook(unraisable)

    before, sys.unraisablehook = sys.unraisablehook, without_calls
    try:
        yield
    except Exception as failure:
        if type(failure) not in (Exception, RuntimeError):  # those of FMPy
            raise
        raise Failed(str(failure)) from None
    finally:
        sys.unraisablehook = before


class Followed(Slave):
    """An FMU whose inputs follow a table, linear between rows. At two rows of one time the second takes effect in event mode."""

    def __init__(self, fmu, description, signals, table):
        super().__init__(fmu, description, signals)
        self.times, self.values = table["time"], np.column_stack([table[v.name].reshape(len(table), -1) for v in signals.variables])
        self.jumps = np.flatnonzero(np.diff(self.times) == 0)
        self.time, self.set_time, self.enter_event_mode = self.times[0], fmu.setTime, fmu.enterEventMode
        self.pass_jumps()
        fmu.setTime, fmu.enterEventMode = self.go_to, self.enter_event

    def pass_jumps(self):
        """Select the rows between the last jump and the next one."""
        passed = np.count_nonzero(self.times[self.jumps] <= self.time + NEAR * (self.times[-1] - self.times[0]))
        ends = [0, *(self.jumps + 1), len(self.times)]
        self.rows = slice(ends[passed], ends[passed + 1])

    def go_to(self, time):
        """Set the time of the FMU, and its inputs at this time."""
        self.set_time(time)
        self.time, times, values = time, self.times[self.rows], self.values[self.rows]
        self.set([np.interp(time, times, column) for column in values.T])

    def enter_event(self):
        self.enter_event_mode()
        self.pass_jumps()


def exchange(archive, description, start_values, signals, output, interval, start, stop, logger, debug_logging=True, visible=False, fmi_call_logger=None, **options):
    """Simulate an FMU; return a structured array of the time and the variables named in `output`. The options are those of simulate_fmu."""
    table = None if signals is None else signals.as_table(start, stop, interval)
    times = {"start_time": start, "stop_time": stop, "output_interval": interval}
    folder = extract(archive)
    try:
        with loading():
            fmu = instantiate_fmu(folder, description, "ModelExchange", visible, debug_logging, logger, fmi_call_logger)
        try:
            if table is not None:
                Followed(fmu, description, signals, table)
            words = {"start_values": start_values, "input": table, "output": output, "model_description": description, "fmu_instance": fmu}
            with failures():
                return simulate_fmu(folder, fmi_type="ModelExchange", **words, **times, **options)
        finally:
            fmu.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
