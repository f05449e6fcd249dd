"""Compute a chunk of a sweep in a thread or in a worker of a cluster. It takes the bytes of an FMU and returns the bytes of a Parquet table."""

import hashlib
import io
import tempfile
import threading
import time
from ctypes import CDLL, Structure, addressof, byref, c_char_p, c_double, c_size_t, c_void_p, cast
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from fmpy import calloc, extract, free, read_model_description
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

PROBLEMS = ("logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal")  # log categories of warnings and errors
VARIED = {"Real": float, "Integer": np.intc, "Boolean": np.intc}  # types of variables that a sweep varies, and of their values in C


class Opened(dict):
    """
    Instances by thread and hash of the FMU's archive. The copy that another process gets is empty.

    `loading` is held while FMPy loads a library, since it changes the working directory of the process for that time.
    """

    def __init__(self):
        super().__init__()
        self.loading = threading.Lock()

    def __reduce__(self):
        return Opened, ()


opened = Opened()


class Instance:
    """An instance of an FMU, which each run resets, and the library that performs the runs."""

    def __init__(self, archive, runner):
        self.folder = tempfile.TemporaryDirectory(prefix="sweep-")  # deleted with the worker
        folder = Path(self.folder.name)
        (folder / "system.fmu").write_bytes(archive)
        (folder / "runner").write_bytes(runner)
        unzipped = extract(str(folder / "system.fmu"), self.folder.name)
        self.description, self.messages = read_model_description(unzipped), []
        with opened.loading:
            self.slave = FMU2Slave(guid=self.description.guid, unzipDirectory=unzipped, instanceName="sweep",
                                   modelIdentifier=self.description.coSimulation.modelIdentifier)  # fmt: skip
        self.callbacks = fmi2CallbackFunctions()
        self.logger = fmi2CallbackLoggerTYPE(lambda *words: self.messages.append(words[4].decode().replace("%%", "%")))
        self.environment = c_void_p(cast(self.logger, c_void_p).value)
        self.runner = CDLL(str(folder / "runner"))
        self.runner.sweep_runs.restype = c_size_t
        self.callbacks.logger = cast(self.runner.sweep_log, fmi2CallbackLoggerTYPE)
        self.callbacks.componentEnvironment = addressof(self.environment)
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.slave.instantiate(callbacks=self.callbacks)
        called = ("Reset", "SetupExperiment", "SetReal", "SetInteger", "SetBoolean", "EnterInitializationMode", "ExitInitializationMode", "DoStep", "GetReal", "GetInteger", "GetFMUstate", "SetFMUstate", "FreeFMUstate")
        self.functions = (c_void_p * len(called))(*(cast(getattr(self.slave.dll, f"fmi2{name}"), c_void_p) for name in called))

    def references(self, names):
        known = {variable.name: variable.valueReference for variable in self.description.modelVariables}
        return np.array([known[name] for name in names], dtype=np.uintc)

    def types_of(self, names):
        known = {variable.name: variable.type for variable in self.description.modelVariables}
        return [known[name] for name in names]

    def counts_events(self):
        return any(variable.name == "events" and variable.type == "Integer" for variable in self.description.modelVariables)

    def run(self, sweep, count):
        """Perform the runs of a Sweep; return for each the message of its failure, or None."""
        problems, first, failed = [None] * count, 0, c_char_p()
        while first < count:
            self.messages.clear()
            component = c_void_p(self.slave.component)
            at = self.runner.sweep_runs(self.functions, component, byref(sweep), c_size_t(first), c_size_t(count), byref(failed))
            if at < count:
                problems[at] = "; ".join([f"{failed.value.decode()} failed", *self.messages])
            first = at + 1
        return problems


VALUE, EVENTS, FIRST, EVENTS_OF = 0, 3, 4, 5  # enum RecordKind of single_runs.c; kinds below EVENTS refer to a variable, those from EVENTS_OF on to a contact or friction


class Record(Structure):
    """struct Record of single_runs.c."""

    _fields_ = [("kind", c_size_t), ("variable", c_size_t), ("time", c_double), ("name", c_char_p)]


def variables_fields(name):
    return (f"{name}_count", c_size_t), (f"{name}_references", c_void_p)


class Sweep(Structure):
    """struct Sweep of single_runs.c."""

    _fields_ = [
        *(field for name in ("varied", "integers", "booleans", "watched", "ends", "sampled") for field in variables_fields(name)),
        *((name, c_void_p) for name in ("values", "integer_values", "boolean_values")), ("tolerance", c_double), ("time_count", c_size_t), ("times", c_void_p), *variables_fields("counter"),
        ("record_count", c_size_t), *((name, c_void_p) for name in ("records", "recorded", "samples", "before", "after", "end_values", "seconds")),
    ]  # fmt: skip


def conserved_energies(description):
    """Return the variables of the energy balance; none for a system without a conservation law, such as one with prescribed motion."""
    law = next((v.description or "" for v in description.modelVariables if v.name == "totalEnergy"), "")
    if law.endswith("; constant"):
        return ["totalEnergy", "kineticEnergy"]
    return ["totalEnergy", "kineticEnergy", "nonConservativeWork"] if law.endswith("; changes by nonConservativeWork alone") else []


def energy_errors(before, after):
    """Return the error of the energy balance of each run, relative to its largest energy; NaN without a conservation law."""
    if before.shape[1] == 0:
        return np.full(len(before), np.nan)
    work = after[:, 2] - before[:, 2] if before.shape[1] > 2 else 0.0
    scale = np.maximum(np.maximum(np.abs(before[:, 0]), before[:, 1]), after[:, 1])
    return (after[:, 0] - before[:, 0] - work) / np.where(scale > 0, scale, 1.0)


def states_of(description):
    return [unknown.variable.derivative.name for unknown in description.derivatives]


@dataclass
class Results:
    """The results of n runs, arrays with a row for each."""

    before: np.ndarray  # energies at the start, in the order of conserved_energies()
    after: np.ndarray  # energies at the end
    ends: np.ndarray  # states at the end
    recorded: np.ndarray  # a column for each record
    seconds: np.ndarray  # run times in s
    problems: np.ndarray  # messages of failures; None for a run without

    def replace(self, runs, others):
        """Replace the rows of some runs; `runs` is a mask."""
        for name, values in vars(others).items():
            getattr(self, name)[runs] = values


def sampled_of(settings):
    """Return the names of the recorded variables, each once."""
    return list(dict.fromkeys(name for _, kind, name, _ in settings["records"] if kind < EVENTS))


def run_by_fmi(instance, rows, names, settings):
    """Perform the runs one after another, by the functions of FMI; return their Results."""
    states, watched, sampled, records = states_of(instance.description), conserved_energies(instance.description), sampled_of(settings), settings["records"]
    types, count = instance.types_of(names), len(rows)
    varied = [[name for name, kind in zip(names, types) if kind == one] for one in VARIED]
    values = [np.ascontiguousarray(rows[:, [kind == one for kind in types]], dtype=number) for one, number in VARIED.items()]
    variables = [instance.references(of) for of in (*varied, watched, states, sampled)]
    counter = instance.references(["events"] if any(VALUE < kind < EVENTS_OF for _, kind, _, _ in records) and instance.counts_events() else [])
    names_events = any(kind >= EVENTS_OF for _, kind, _, _ in records)
    instance.slave.setDebugLogging(names_events, ["logEvents", *PROBLEMS] if names_events else [])
    before, after = (np.full((count, len(watched)), np.nan) for _ in range(2))
    ends, seconds = np.full((count, len(states)), np.nan), np.zeros(count)
    recorded, samples, times = np.full((count, len(records)), np.nan), np.zeros((3, len(sampled))), np.array(settings["times"], dtype=float)
    wanted = (Record * len(records))(*((kind, sampled.index(name) if name in sampled else 0, time, name and name.encode()) for _, kind, name, time in records))
    sweep = Sweep(*(word for references in variables for word in (len(references), references.ctypes.data)), *(part.ctypes.data for part in values), settings["tolerance"] or 0.0, len(times), times.ctypes.data,
                  len(counter), counter.ctypes.data, len(records), addressof(wanted), *(a.ctypes.data for a in (recorded, samples, before, after, ends, seconds)))  # fmt: skip
    problems = np.array(instance.run(sweep, count), dtype=object)
    recorded[problems != None] = np.nan  # noqa: E711: elementwise comparison
    return Results(before, after, ends, recorded, seconds, problems)


def run_in_lanes(ensemble, instance, rows, names, settings):
    """
    Perform the runs in SIMD lanes, and by FMI those that the lanes leave; return their Results.

    Each run in lanes gets an equal share of their time. All records must be values at times.
    """
    begin, states, watched = time.perf_counter(), len(states_of(instance.description)), len(conserved_energies(instance.description))
    values, needs_fmu = ensemble.run(rows)
    seconds, sampled, times = np.full(len(rows), (time.perf_counter() - begin) / len(rows)), sampled_of(settings), list(ensemble.times)
    energies = values[:, :, states : states + watched]
    columns = [values[:, times.index(at), states + watched + sampled.index(name)] for _, _, name, at in settings["records"]]
    recorded = np.stack(columns, axis=1) if columns else np.empty((len(rows), 0))
    results = Results(energies[:, 0], energies[:, -1], values[:, -1, :states], recorded, seconds, np.full(len(rows), None))
    if needs_fmu.any():
        results.replace(needs_fmu, run_by_fmi(instance, rows[needs_fmu], names, settings))
    return results


def run_chunk(archive, runner, numbers, rows, names, settings, ensemble=None):
    """
    Perform the runs `numbers`, with start values `rows` (runs x names); return their table as bytes of Parquet.

    `archive` and `runner` are the bytes of the FMU and of the library of single_runs.c. `ensemble` is an Ensemble, or None.
    """
    key = threading.get_ident(), hashlib.sha256(archive).hexdigest()
    if key not in opened:
        opened[key] = Instance(archive, runner)
    instance = opened[key]
    one = rows, names, settings
    results = run_in_lanes(ensemble, instance, *one) if ensemble else run_by_fmi(instance, *one)
    columns = {"run": np.array(numbers)} | dict(zip(names, rows.T))
    columns |= {f"{state}_end": column for state, column in zip(states_of(instance.description), results.ends.T)}
    columns |= {column: values for (column, *_), values in zip(settings["records"], results.recorded.T)}
    columns |= {"energyError": energy_errors(results.before, results.after), "runTime": results.seconds}
    columns |= {"problem": pa.array(results.problems, pa.string())}
    buffer = io.BytesIO()
    pq.write_table(pa.table(columns), buffer)
    return buffer.getvalue()
