"""
Model exchange of constrained systems by FMPy's CVode, as a table: evaluations, events for projection, and run time.

A pendulum by its angle, SimplePendulum, is the twin in minimal coordinates of PendulumCartesian.
"""

import time
from contextlib import contextmanager
from unittest import mock

import fmpy
from fmpy.fmi2 import FMU2Model

SYSTEMS = ["SimplePendulum", "PendulumCartesian", "FourBar", "Bricard", "FreeBody", "RollingDisk", "KnifeEdge", "AndrewsSqueezer"]
END, FAST = 10.0, {"AndrewsSqueezer": 0.03}  # s; its crank turns a thousand times faster than others
TOLERANCE = 1e-8


@contextmanager
def counted(function):
    """Count the calls of a method of FMU2Model within the block, in a list of one number."""
    count, original = [0], getattr(FMU2Model, function)

    def call(*arguments, **words):
        count[0] += 1
        return original(*arguments, **words)

    with mock.patch.object(FMU2Model, function, call):
        yield count


def row(archive, name):
    """Return a line of Markdown for a system."""
    end = FAST.get(name, END)
    with counted("getDerivatives") as evaluations, counted("enterEventMode") as events:
        begin = time.perf_counter()
        fmpy.simulate_fmu(str(archive), fmi_type="ModelExchange", stop_time=end, relative_tolerance=TOLERANCE, output_interval=end / 100)
        seconds = time.perf_counter() - begin
    return f"| {name} | {end:g} | {evaluations[0]} | {events[0]} | {seconds:.2f} |"


def table(folder):
    """Return the lines of Markdown for the FMUs of a folder."""
    row(folder / f"{SYSTEMS[0]}.fmu", SYSTEMS[0])  # loads FMPy's libraries
    return ["| FMU | simulated, s | evaluations | events | run time, s |", "|---|---|---|---|---|", *(row(folder / f"{name}.fmu", name) for name in SYSTEMS)]
