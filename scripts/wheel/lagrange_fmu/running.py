"""Simulate systems, which are built first, and FMUs."""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

from .building import build_with, robot_words
from .input_file import read_input
from .problem import Problem
from .simulation import described, simulate, write_motion
from .variables import numbers_by_name, units_of


def is_fmu(path):
    return Path(path).suffix == ".fmu"


@contextmanager
def fmu_of(system, folder=None, method=None, fmi=None, words=()):
    """
    Yield the path of the FMU of a system; an FMU is yielded as it is.

    The system is built into `folder`, or into a temporary folder that exists until the context ends. `words` are further arguments of lagc.
    """
    if is_fmu(system):
        if method is not None or fmi is not None:
            raise Problem(f"{system} is an FMU, whose solver and version of FMI are fixed; expected a system to choose them for")
        if "--robot" in words:
            raise Problem(f"{system} is an FMU; expected the file of a robot for {words[words.index('--robot') + 1]}")
        yield Path(system)
        return
    with tempfile.TemporaryDirectory() as scratch:
        yield build_with(words, system, output=folder or scratch, solver=method, fmi=fmi or 2)


def motion_of(system, start_values=None, folder=None, /, input=None, solver=None, fmi=None, step=None, tolerance=None, robot=None, **options):
    """Return the Motion of a system or FMU; `input` may be the path of a CSV. The options are those of simulation.simulate."""
    options |= {name: value for name, value in (("output_interval", step), ("relative_tolerance", tolerance)) if value is not None}
    with fmu_of(system, folder, solver, fmi, robot_words(robot)) as fmu:
        signals = read_input(input, units_of(described(fmu))) if isinstance(input, (str, os.PathLike)) else input
        return simulate(fmu, numbers_by_name(start_values), input=signals, **options)


def run(system, start_values=None, folder=".", /, **words):
    """See lagrange_fmu.run."""
    return write_motion(lambda: motion_of(system, start_values, folder, **words), Path(folder))
