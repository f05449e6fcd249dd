"""Measure the footprint of FMUs: bytes by origin, memory and time of an instance, exported symbols, and features that are left out."""

import ctypes
import subprocess
import time

from fmpy.fmi2 import FMU2Slave

import fmu
from linked import linked_members

FEATURES = {
    "input": "inputs", "time": "time", "loops": "factorization of M at run time", "jacobian": "Jacobian",
    "series": "Taylor series", "linear": "A, B", "sundials": "SUNDIALS", "solver": "any solver",
}  # fmt: skip


class Mallinfo(ctypes.Structure):
    """struct mallinfo2 of glibc."""

    _fields_ = [(name, ctypes.c_size_t) for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()]


def heap():
    """Return the bytes of heap memory in use by this process."""
    function = ctypes.CDLL(None).mallinfo2
    function.restype = Mallinfo
    info = function()
    return info.uordblks + info.hblkhd


def code_of(name):
    return (fmu.BUILD / "systems" / name / "system.c").read_text()


def form(name):
    """Return the form of the equations in system.c, see src/compiler/program/program.h."""
    code = code_of(name)
    if "InstructionTables tables" not in code:
        return "statements"
    return "tables" if "series_code[]" in code or "void series(" not in code else "tables, series as statements"


def absent_features(name, members):
    code = code_of(name)
    present = {
        "input": "point->input" in code, "time": "point->time" in code, "loops": any("ldlt.c" in m for m in members),
        "jacobian": "int jacobian(" in code, "series": "void series(" in code, "linear": "void linear(" in code,
        "sundials": any("sundials" in m for m in members), "solver": any(m.startswith("libsolvers.a") for m in members),
    }  # fmt: skip
    return [text for feature, text in FEATURES.items() if not present[feature]]


def instance_costs(name):
    """Return the bytes of an instance after its first step, and the microseconds to instantiate and free one."""
    callbacks = fmu.callbacks_of(None)
    description = fmu.description(name)
    slave = FMU2Slave(guid=description.guid, unzipDirectory=str(fmu.unpacked(name)), instanceName="i",
                      modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
    arguments = (b"i", 1, description.guid.encode(), None, ctypes.byref(callbacks), 0, 0)
    times = []
    for _ in range(200):
        begin = time.perf_counter()
        component = slave.fmi2Instantiate(*arguments)
        slave.fmi2FreeInstance(component)
        times.append(time.perf_counter() - begin)
    before = heap()
    components = [slave.fmi2Instantiate(*arguments) for _ in range(50)]
    for component in components:
        slave.component = component
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slave.doStep(0.0, 1e-3)
    memory = (heap() - before) / len(components)
    for component in components:
        slave.fmi2FreeInstance(component)
    return memory, min(times) * 1e6


def exported_symbols(name):
    words = ["nm", "-D", "--defined-only", str(fmu.library(name))]
    return len(subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines())


def rows():
    """Return a row for each FMU: name, form, bytes of archive, library, equations, runtime, SUNDIALS; memory, time, symbols, absent features."""
    table = []
    for name in fmu.all_names():
        members = linked_members(name)
        equations = sum(size for member, size in members.items() if "system.c.o" in member)
        sundials = sum(size for member, size in members.items() if "sundials" in member and ".c.o" in member and "libsundials" in member)
        runtime = sum(members.values()) - equations - sundials
        table.append([name, form(name), fmu.archive(name).stat().st_size, fmu.library(name).stat().st_size, equations, runtime, sundials,
                      *instance_costs(name), exported_symbols(name), ", ".join(absent_features(name, members))])  # fmt: skip
    return table
