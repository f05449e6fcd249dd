"""
Tabulate model exchange of constrained systems by FMPy's CVode: evaluations, events for projection, run time, and the largest error of a state in
tolerances. The same motion in minimal coordinates (minimal.py) is beside it.

The error is |x - x0|/max(1, |x0|), where x0 is by the FMU's own solver at a tolerance of 1e-13. Both errors contain the integrator's errors
along the constraints, as the motion amplifies them. Their quotient is the price of the constraints.

A pendulum by its angle, SimplePendulum, is the twin in minimal coordinates of PendulumCartesian.
"""

import time
from contextlib import contextmanager
from unittest import mock

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Model

from importing import minimal

SYSTEMS = ["SimplePendulum", "PendulumCartesian", "FourBar", "Bricard", "FreeBody", "RollingDisk", "KnifeEdge", "AndrewsSqueezer"]
END, FAST = 10.0, {"AndrewsSqueezer": 0.03}  # s; its crank turns a thousand times faster than others
TOLERANCE, EXACT = 1e-8, 1e-13
ROWS = 100  # rows of the result


@contextmanager
def counted(function):
    """Count the calls of a method of FMU2Model within the block, in a list of one number."""
    count, original = [0], getattr(FMU2Model, function)

    def call(*arguments, **words):
        count[0] += 1
        return original(*arguments, **words)

    with mock.patch.object(FMU2Model, function, call):
        yield count


def states_in(result, names, times):
    """Return the states at the times from a result with further rows at events, of which the later one counts."""
    rows = np.searchsorted(result["time"], times + 1e-9 * times[-1]) - 1
    return np.array([result[name][rows] for name in names]).T


def errors(archive, result, names, times):
    """Return the largest errors of a result and of the motion in minimal coordinates, in tolerances."""
    exact = states_in(fmpy.simulate_fmu(str(archive), stop_time=times[-1], relative_tolerance=EXACT, output_interval=times[1], output=names), names, times)
    found = states_in(result, names, times), minimal.motion(str(archive), times, TOLERANCE, exact[0])
    return [np.max(np.abs(one - exact) / np.maximum(1, np.abs(exact))) / TOLERANCE for one in found]


def row(archive, name):
    """Return a line of Markdown for a system."""
    end = FAST.get(name, END)
    times = np.linspace(0, end, ROWS + 1)
    names = [unknown.variable.derivative.name for unknown in fmpy.read_model_description(archive).derivatives]
    with counted("getDerivatives") as evaluations, counted("enterEventMode") as events:
        begin = time.perf_counter()
        result = fmpy.simulate_fmu(str(archive), fmi_type="ModelExchange", stop_time=end, relative_tolerance=TOLERANCE, output_interval=times[1], output=names)
        seconds = time.perf_counter() - begin
    line = f"| {name} | {end:g} | {evaluations[0]} | {events[0]} | {seconds:.2f} |"
    if name not in minimal.FORMS:
        return f"{line} – | – | – |"
    own, least = errors(archive, result, names, times)
    return f"{line} {own:,.0f} | {least:,.0f} | {own / least:.1f} |"


def table(folder):
    """Return the lines of Markdown for the FMUs of a folder."""
    row(folder / f"{SYSTEMS[0]}.fmu", SYSTEMS[0])  # loads FMPy's libraries
    head = "| FMU | simulated, s | evaluations | events | run time, s | error, tolerances | in minimal coordinates | quotient |"
    return [head, "|---" * 8 + "|", *(row(folder / f"{name}.fmu", name) for name in SYSTEMS)]
