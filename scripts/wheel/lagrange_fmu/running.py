"""Simulating systems that need not be built yet."""

import tempfile
from pathlib import Path

from .building import build
from .simulation import simulate, write_results


def is_fmu(path):
    return Path(path).suffix == ".fmu"


def motion_of(system, start_values=None, **options):
    with tempfile.TemporaryDirectory() as scratch:
        fmu = system if is_fmu(system) else build(system, output=scratch)
        return simulate(fmu, start_values or {}, **options)


def run(system, start_values=None, folder="."):
    fmu = Path(system) if is_fmu(system) else build(system, output=folder)
    return write_results(simulate(fmu, start_values or {}), Path(folder))
