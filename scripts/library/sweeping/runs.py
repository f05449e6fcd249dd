"""
Run an FMU over a grid or a random sample of start values and parameters.

Each run is a row of one Parquet file. It has the varied values, the states at the end, the relative error of the energy, the run time, and the
message of a failure. The energy has an error only if the FMU's description of totalEnergy states a conservation law. Finished chunks of runs are kept
beside the file until all are complete, so that the same command continues after a kill. Also a module of the wheel.
"""

import hashlib
import json
import math
import os
import shutil
import sys
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import nullcontext
from numbers import Integral, Real
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from . import worker
from ..ensembles import Ensemble, lanes_here, source_of
from ..problem import Problem
from ..progress import Progress
from ..quantities import number_of, truth_of
from ..simulation import described
from .records import VALUE, check_log, records_of, times_of
from ..variables import startable, unsettable_reason, whole_kind
from ..whole_files import replace

try:
    import fcntl
except ModuleNotFoundError:  # Windows, which cannot lock folders
    fcntl = None

CHUNK, PARTS = 250, 100  # runs of a task at least; number of tasks at most, if that makes them larger
LANES_CHUNK, LANES_PARTS = 1000, 25  # the same for runs in lanes, which are faster than writing their rows
LARGEST_CHUNK = 20000  # runs of a task at most, to bound the memory
LANES_FROM = 2000  # runs from which on lanes save more time than their compilation takes
IN_FLIGHT = 3  # tasks in flight for each thread of a cluster, to hide latency


def known_name(name, description):
    """Return the variable that a name varies: theta for theta, and for theta0, the start value of theta. Raise Problem if there is none."""
    names = startable(description)
    if name in names:
        return name
    if name.endswith("0") and name[:-1] in names:
        return name[:-1]
    raise Problem(f"'{name}' has no start value in {description.modelName}{unsettable_reason(name, description)}; these have one: {', '.join(names)}")


def check_whole(name, values, description):
    """Raise Problem for the first value that the type of the variable does not have."""
    kind = whole_kind(name, description)
    for value in values if kind else ():
        if kind == "a Boolean" and value not in (0, 1):
            raise Problem(f"'{name}' is {kind}, and {value:g} is none; expected {name}=0,1")
        if value % 1 != 0:
            raise Problem(f"'{name}' is {kind}, and {value:g} is none; expected whole numbers, such as {name}=1:5:5")


def in_unit(variable, values):
    """Return a range or values of arguments.py, which may be texts, as numbers in the variable's unit."""
    ends = [number_of(variable.name, truth_of(variable, value), variable.unit or "1") for value in (values[:2] if isinstance(values, tuple) else values)]
    return (*ends, values[2]) if isinstance(values, tuple) else ends


def sample_of(values, count, generator, is_whole):
    """Return `count` random samples of a range or of values."""
    if not isinstance(values, tuple):
        return generator.choice(values, count)
    if is_whole:
        return generator.integers(math.ceil(values[0]), math.floor(values[1]), count, endpoint=True)
    return generator.uniform(*values[:2], count)


def points(variations, random, seed, whole):
    """Return the varied values, runs x variables: the grid, or `random` samples with this seed. Samples of the names `whole` are whole numbers."""
    if random:
        generator = np.random.default_rng(seed)
        return np.array([sample_of(values, random, generator, name in whole) for name, values in variations], dtype=float).T
    axes = []
    for name, values in variations:
        if isinstance(values, tuple) and values[2] is None:
            raise Problem(f"'{name}' has no COUNT; expected {name}=FROM:TO:COUNT, or --random RUNS")
        axes.append(np.linspace(*values) if isinstance(values, tuple) else values)
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def read(path):
    """Read a Parquet file; faster than pyarrow's read_table, which loads the modules for data sets of many files."""
    with pq.ParquetFile(path) as file:
        return file.read()


def lock_of(path, flags):
    """Open and lock the file or folder at the path; return its descriptor, or None if another process has locked it."""
    while True:
        lock = os.open(path, flags)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(lock)
            return None
        if path.exists() and os.path.samestat(os.fstat(lock), os.stat(path)):
            return lock
        os.close(lock)  # another process has renamed or removed it


class Parts:
    """
    The finished chunks of a sweep, and its unfinished output.

    The chunks are in a folder beside the output, whose name has the hash of the sweep's plan. The folder is locked against equal sweeps, and the
    output against sweeps of other plans.
    """

    def __init__(self, output, plan):
        digest = hashlib.sha256(json.dumps(plan, sort_keys=True).encode()).hexdigest()[:16]
        self.output = output
        self.folder = output.with_suffix("").parent / f"{output.stem}.parts-{digest}"
        self.unfinished = output.with_suffix(".part")
        self.lock = self._locked()
        self.output_lock = lock_of(self.unfinished, os.O_RDWR | os.O_CREAT) if fcntl else None
        if fcntl and self.output_lock is None:
            if not any(self.folder.iterdir()):
                self.folder.rmdir()
            os.close(self.lock)
            raise Problem(f"another sweep to {output} is running; expected another --output, or to wait for its end")

    def _locked(self):
        """Create and lock the folder; wait for the end of an equal sweep that runs already. Return its descriptor, or None on Windows."""
        while True:
            self.folder.mkdir(parents=True, exist_ok=True)
            if fcntl is None:
                return None
            lock = os.open(self.folder, os.O_RDONLY)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                print("the same sweep runs already; waiting for it to end ...", file=sys.stderr, flush=True)
                fcntl.flock(lock, fcntl.LOCK_EX)
            if self.folder.exists() and os.path.samestat(os.fstat(lock), os.stat(self.folder)):
                return lock
            os.close(lock)  # the other sweep has removed the folder

    def path(self, chunk):
        return self.folder / f"{chunk:06}.parquet"

    def write(self, chunk, data):
        """Write a chunk, bytes of Parquet, atomically."""
        temporary = self.path(chunk).with_suffix(".part")
        temporary.write_bytes(data)
        replace(temporary, self.path(chunk))

    def finished(self, runs_of):
        """Return the set of finished chunks; delete damaged ones."""
        chunks = sorted(int(path.stem) for path in self.folder.glob("*.parquet"))
        whole = [chunk for chunk in chunks if self.is_whole(chunk, len(runs_of(chunk)))]
        for chunk in set(chunks) - set(whole):
            runs = runs_of(chunk)
            print(f"{self.path(chunk)} is damaged: runs {runs.start} to {runs.stop - 1} are run again")
            self.path(chunk).unlink()
        return set(whole)

    def is_whole(self, chunk, runs):
        try:
            return read(self.path(chunk)).num_rows == runs
        except (pa.ArrowException, OSError):
            return False

    def join(self, count):
        """Write all chunks into the output, in the order of the runs, and delete their folder; one chunk is in memory at a time."""
        writer = None
        for chunk in range(count):
            table = read(self.path(chunk))
            writer = writer or pq.ParquetWriter(self.unfinished, table.schema)
            writer.write_table(table)
        writer.close()
        replace(self.unfinished, self.output)
        shutil.rmtree(self.folder)

    def __enter__(self):
        return self

    def __exit__(self, *problem):
        if self.output_lock is not None:
            self.unfinished.unlink(missing_ok=True)
            os.close(self.output_lock)
        if self.lock is not None:
            os.close(self.lock)


def ensemble_of(path, description, names, settings, runner, compile_ensemble):
    """Return the Ensemble that computes many runs at once, or None if the FMU or the varied variables do not allow it."""
    source, states = source_of(path), worker.states_of(description)
    try:
        library = source and compile_ensemble(source, lanes_here(runner))
    except Problem as problem:  # the sources of an FMU of another version may not fit this runtime
        print(f"{problem}\nRuns are computed one after another.", file=sys.stderr)
        return None
    if not library:
        return None
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    recorded = [*states, *worker.conserved_energies(description), *worker.sampled_of(settings)]
    times = sorted({0.0, settings["stop"], *(time for *_, time in settings["records"])})
    ensemble = Ensemble(library, *([references[name] for name in some] for some in (names, recorded)), times, settings["tolerance"])
    return ensemble if ensemble.supports() else None


def simulate(executor, width, archive, runner, rows, names, settings, parts, ensemble=None):
    """Compute all chunks that are not finished, `width` tasks at a time, and write each as it ends; return the number of chunks."""
    least, most = (LANES_CHUNK, LANES_PARTS) if ensemble else (CHUNK, PARTS)
    size = min(max(least, -(-len(rows) // most)), LARGEST_CHUNK)
    count = -(-len(rows) // size)
    runs_of = lambda chunk: range(chunk * size, min((chunk + 1) * size, len(rows)))
    finished = parts.finished(runs_of)
    waiting = [chunk for chunk in range(count) if chunk not in finished]
    done = sum(len(runs_of(chunk)) for chunk in finished)
    if done:
        print(f"{done} of {len(rows)} runs are there already")
    progress, running = Progress(len(rows), done), {}
    while waiting or running:
        while waiting and len(running) < width:
            chunk = waiting.pop(0)
            numbers = runs_of(chunk)
            some = rows[numbers.start : numbers.stop]
            future = executor.submit(worker.run_chunk, archive, runner, numbers, some, names, settings, ensemble)
            running[future] = chunk
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            chunk = running.pop(future)
            parts.write(chunk, future.result())
            progress("runs", len(runs_of(chunk)))
    return count


def simulate_in_threads(*words):
    """Compute all chunks in a thread for each core. Runs are in C, without Python's global interpreter lock."""
    executor = ThreadPoolExecutor(os.cpu_count())
    try:
        return simulate(executor, 2 * os.cpu_count(), *words)
    finally:
        executor.shutdown(wait=False, cancel_futures=True)  # does not wait for runs in progress, which may take long


def client_of(address):
    """Return a client of the Dask cluster with this scheduler; raise Problem if it does not answer."""
    try:
        import cloudpickle
        from distributed import Client
    except ModuleNotFoundError as missing:
        raise Problem(f"{missing.name} is not installed; a sweep on a Dask cluster needs it: pip install distributed") from None
    try:
        client = Client(address)
    except (OSError, ValueError) as problem:
        raise Problem(f"no Dask scheduler answers at '{address}': {problem}; expected an address such as tcp://HOST:8786") from None
    cloudpickle.register_pickle_by_value(worker)  # sends the module to the workers, which need not have it
    return client


def simulate_with_dask(client, *words):
    """Compute all chunks on a Dask cluster."""
    return simulate(client.get_executor(pure=False, retries=3), IN_FLIGHT * max(1, sum(client.nthreads().values())), *words)


def print_summary(output):
    """Print the numbers of runs and failures, and the largest error of the energy; one row group is in memory at a time."""
    count, failed, first, largest = 0, 0, None, None  # largest: relative error of the energy; None without a conservation law
    with pq.ParquetFile(output) as file:
        for group in range(file.num_row_groups):
            table = file.read_row_group(group, columns=["energyError", "problem"])
            count += table.num_rows
            problems = table["problem"].drop_null()
            failed += len(problems)
            first = first or (problems[0].as_py() if problems else None)
            errors = np.abs(table["energyError"].to_numpy())
            errors = errors[np.isfinite(errors)]
            if errors.size:
                largest = max(largest or 0.0, np.max(errors))
    print(f"{count} runs, {failed} failed")
    if failed:
        print(f"the first failure: {first}")
    if largest is not None:
        print(f"largest relative error of the energy: {largest:.3g}")
    print(f"result  {output.resolve()}")


def check_words(words):
    """Raise Problem for the first number that is out of its range."""
    for name, least, expected in (("random", 1, "a whole number of runs"), ("seed", 0, "a whole number that is not negative")):
        value = getattr(words, name)
        if value is not None and not (isinstance(value, Integral) and value >= least):
            raise Problem(f"{name} is {value!r}; expected {expected}")
    for name in ("stop_time", "step", "tolerance"):
        value = getattr(words, name)
        if value is not None and not (isinstance(value, Real) and 0 < value < math.inf):
            raise Problem(f"{name} is {value!r}; expected a positive number")


def report(run):
    """Call run(), which returns the path of a sweep's file, and print a summary; for a command line."""
    try:
        output = run()
    except KeyboardInterrupt:
        print("interrupted; finished runs are kept, and the same command continues with them", file=sys.stderr)
        os._exit(130)  # does not wait for runs in progress, which may take long
    print_summary(output)


def sweep(path, folder, words, runner, compile_ensemble):
    """
    Sweep an FMU into a Parquet file, by the arguments of arguments.py; return its path.

    `runner` is the shared library of single_runs.c. compile_ensemble(source, lanes) returns the library of ensembles.py, or None.
    """
    check_words(words)
    description = described(path)
    if description.fmiVersion != "2.0":
        raise Problem(f"{path} is of FMI {description.fmiVersion}; expected one of FMI 2.0")
    names = [known_name(name, description) for name, _ in words.vary]
    if len(set(names)) < len(names):
        raise Problem("a variable varies twice; expected it once")
    variables, whole = {variable.name: variable for variable in description.modelVariables}, [name for name in names if whole_kind(name, description)]
    rows = points([(name, in_unit(variables[name], values)) for name, (_, values) in zip(names, words.vary)], words.random, words.seed, whole)
    for name, values in zip(names, rows.T):
        check_whole(name, np.unique(values), description)
    experiment = description.defaultExperiment
    stop = words.stop_time or float(experiment.stopTime if experiment and experiment.stopTime else 1.0)
    records = records_of(words.record, description, stop)
    check_log(path, records)
    settings = {"stop": stop, "times": times_of(records, description, stop, words.step).tolist(), "tolerance": words.tolerance, "records": records}
    output = Path(words.output or Path(folder) / f"{description.modelName}-sweep.parquet")
    archive = Path(path).read_bytes()
    ensemble = None
    at_times = all(kind == VALUE for _, kind, *_ in records)  # lanes record no extremes and no events
    if len(rows) >= LANES_FROM and at_times and not whole and not words.scheduler:  # lanes vary numbers only; the workers of a cluster may have other processors
        ensemble = ensemble_of(path, description, names, settings, runner, compile_ensemble)
    plan = {"fmu": hashlib.sha256(archive).hexdigest(), "names": names, "rows": hashlib.sha256(rows.tobytes()).hexdigest(), "lanes": ensemble is not None, **settings}
    try:
        # An absolute path, since the working directory is another one while a thread loads an FMU.
        with client_of(words.scheduler) if words.scheduler else nullcontext() as client, Parts(output.absolute(), plan) as parts:
            task = archive, Path(runner).read_bytes(), rows, names, settings, parts
            count = simulate_with_dask(client, *task) if client else simulate_in_threads(*task, ensemble)
            parts.join(count)
    except OSError as problem:
        reason = os.strerror(problem.errno) if problem.errno else problem
        remedy = "expected a writable folder with free space, in which the same command continues with the finished runs that are kept beside it"
        raise Problem(f"{output} cannot be written: {reason}; {remedy}") from None
    return output
