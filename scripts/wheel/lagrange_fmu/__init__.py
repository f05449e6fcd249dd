"""
Energies and forces of a mechanical system become an FMU.

    path = lagrange_fmu.build("pendulum.xml")
    motion = lagrange_fmu.simulate(path, {"theta": 1})
    A, B, C, D = lagrange_fmu.linearize(path, {"theta": 3.14159})[:4]

What goes wrong is a Problem, whose text names the thing and the remedy; what is a likely mistake in a system is a warning.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .problem import Problem
from .variables import instead, names_of, numbers_by_name

if TYPE_CHECKING:
    import numpy as np

    from .adjoint import Gradient
    from .building import build, check, new
    from .fit_result import Fit
    from .linearization import Linearization
    from .results import Result
    from .variational import Sensitivities

    __version__: str

__all__ = ["Problem", "build", "check", "fit", "from_sympy", "gradient", "linearize", "live", "new", "run", "sensitivities", "simulate", "sweep", "words"]


def __getattr__(name: str) -> Any:
    """Imports these at their first use, so that the command soon takes interrupts."""
    if name == "__version__":
        from importlib.metadata import version

        return version("lagrange-fmu")
    if name in ("build", "check", "new"):
        from . import building

        return getattr(building, name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


def simulate(
    system: str | PathLike[str],
    start_values: Mapping[str, float] | None = None,
    *,
    output: str | Sequence[str] | None = None,
    input: str | PathLike[str] | np.ndarray | Mapping[str, Any] | Callable[[float], Any] | Any = None,
    hold: bool = False,
    record_events: bool = True,
    fmi_type: str = "CoSimulation",
    fmi: int | None = None,
    solver: str | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    **options: Any,
) -> Result:
    """
    The motion of an FMU, or of a system, which is built first: a structured NumPy array with a row for each communication point and two for each event, which
    have time, in s, and all outputs, in SI units, by name. It has plot(), animate() and to_pandas().

    start_values: of coordinates, velocities, inputs and parameters by name, in SI units
    output: the names of the variables to record in place of all outputs; local ones, such as "totalEnergy", can be had so
    input: a CSV with time and the names of inputs in its first line, or a structured array, a dict of arrays or a DataFrame of these; linear between its rows, and two rows
        of one time are a jump. Or a function of time that returns a dict of numbers by name, or a number for each input; or a dict of such functions and numbers
    hold: the values of the input are held from row to row, or those of a function over each step
    record_events: rows just before and just behind each event, of the same time
    fmi_type: "CoSimulation", by the FMU's own solver, or "ModelExchange", by CVode of FMPy
    fmi, solver: the version of FMI, 2 or 3, and the method in place of the system's own, where the FMU is not built yet
    stop_time, step: in s; tolerance: relative. Else as the FMU's experiment says
    options: start_time, in s, debug_logging, visible, fmi_call_logger; in model exchange others of fmpy.simulate_fmu
    """
    from .results import Result
    from .running import motion_of

    words = {"output": output, "input": input, "hold": hold, "fmi_type": fmi_type, "fmi": fmi, "solver": solver, "step": step, "tolerance": tolerance}
    return Result.of(motion_of(system, start_values, None, stop_time=stop_time, record_events=record_events, **words, **options))


def linearize(
    system: str | PathLike[str], at: Mapping[str, float] | None = None, parameters: Mapping[str, float] | None = None
) -> Linearization:
    """
    The matrices A (n x n), B (n x m), C (p x n), D (p x m) of an FMU or a system to first order, for n states, m inputs and p outputs, as a
    named tuple, which also has the names `states`, `inputs`, `outputs` and the `point`. `at` gives coordinates, velocities and inputs
    where they are not their start values. Where there are constraints, the states are as many as are independent; `constraints` names
    the contacts that are closed and the frictions that stick at the point, and are taken as constraints.
    """
    from .linearization import linearize

    return linearize(system, numbers_by_name(at, "at") | numbers_by_name(parameters, "parameters"))


def sensitivities(
    system: str | PathLike[str],
    of: Sequence[str],
    by: Sequence[str],
    times: Sequence[float],
    start_values: Mapping[str, float] | None = None,
    tolerance: float = 1e-10,
) -> Sensitivities:
    """
    The derivatives of outputs and states `of`, at increasing times in s of a motion that starts at 0 s, by start values, parameters and inputs `by`, which are constant: `.values[of]` and
    `.derivatives[of, by]` are arrays over the times. By the variational equations to the relative tolerance, in the FMU's own solver for systems in XML, else with SciPy; events change
    them by what they make of neighbouring motions; at the time of an event they are those before it. Several events at once, one that is only touched,
    and one behind which neighbours are in other modes are refused.
    """
    from .variational import sensitivities

    return sensitivities(system, names_of(of, "of"), names_of(by, "by"), times, numbers_by_name(start_values), tolerance)


def gradient(
    system: str | PathLike[str],
    of: str | None = None,
    by: Sequence[str] = (),
    stop_time: float | None = None,
    *,
    data: str | PathLike[str] | np.ndarray | None = None,
    integral: bool = False,
    noise: Mapping[str, float] | None = None,
    start_values: Mapping[str, float] | None = None,
    tolerance: float = 1e-10,
) -> Gradient:
    """
    The derivatives of one number by parameters, start values and inputs `by`, which are constant: `.derivatives[by]`, beside the `.value`. The number is
    the output or state `of` at the stop time, in s, or its integral over the motion until then; or, of `data`, the sum of the squares of the differences
    between measurements and the motion, in units of the `noise`: data and noise are as for fit(). By the adjoint equation backwards along the motion to the
    relative tolerance, with SciPy: many parameters take no longer than one. Events are treated, and refused, as by sensitivities().
    """
    from .adjoint import gradient

    return gradient(system, of, names_of(by, "by"), stop_time, data, integral, numbers_by_name(noise, "noise"), numbers_by_name(start_values), tolerance)


def fit(
    system: str | PathLike[str],
    data: str | PathLike[str] | np.ndarray | Sequence[Any],
    vary: Sequence[str],
    start_values: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    noise: Mapping[str, float] | None = None,
    each: Sequence[str] = (),
    loss: str = "linear",
) -> Fit:
    """
    Parameters and start values `vary` such that the motion meets data: a CSV with time, measured outputs or states and, where there are some,
    inputs in its first line, perhaps with units; or a structured array of these; or several experiments; NaN, or nothing, is what was not measured. Least squares from the start values on, with the exact
    derivatives, within the bounds, which are min and max of the FMU where none are given. `noise` has standard deviations by measured name; where it
    is not given all columns count the same. `each` has start values, parameters or inputs which are found for each experiment by itself, beginning where
    these were measured first. `loss` "soft_l1", "huber" or "cauchy" counts residuals beyond the noise less than by their squares, for data with outliers. The Fit has values, deviations,
    intervals of 95 %, what the data do not determine and remarks, such as of a misfit; it can write_page() and write_system(). A motion that cannot be computed is a
    rejected step. Where there are no exact derivatives, differences are taken. Ctrl-C ends the search with the best values so far.
    """
    from .fitting import fit

    return fit(system, data, names_of(vary, "vary"), numbers_by_name(start_values), dict(bounds or {}), numbers_by_name(noise, "noise"), names_of(each, "each"), loss)


def run(
    system: str | PathLike[str], start_values: Mapping[str, float] | None = None, folder: str | PathLike[str] = ".", **words: Any
) -> dict[str, Path | str]:
    """
    Simulates, with the words of simulate(), and leaves NAME.fmu, NAME.csv, NAME.png and NAME-motion.html in the folder; the path of each by its kind, or why
    there is none.
    """
    from .running import run

    return run(system, start_values, folder, **words)


def live(system: str | PathLike[str], output: str | PathLike[str] | None = None, *, edit: bool = False) -> Path:
    """
    Writes the page in which the FMU of a system runs, in any browser and without a network, and returns its path: `output`, else NAME.html in the
    current folder. With `edit` the system can be changed in the page; it is NAME-edit.html then.
    """
    from .pages import live

    return live(system, output, edit)


def sweep(
    system: str | PathLike[str],
    vary: Mapping[str, tuple[float, ...] | Sequence[float] | np.ndarray],
    *,
    random: int | None = None,
    seed: int = 0,
    stop_time: float | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    record: str | Sequence[str] | None = None,
    scheduler: str | None = None,
    output: str | PathLike[str] | None = None,
) -> Path:
    """
    Simulates from a grid or a random sample of start values and parameters, on all cores, and returns the path of a Parquet file with a run in each row:
    `output`, else NAME-sweep.parquet in the current folder. Finished runs of a sweep that is interrupted are kept beside it, and the same call goes on with them.

    vary: by name a range, which is a tuple (FROM, TO, COUNT), or a list or an array of values; several make a grid
    random: the number of runs of a random sample in place of the grid, from ranges (FROM, TO) and among values; seed: of the sample
    stop_time, step: in s; tolerance: relative. Else to the end of the FMU's experiment, in one step, and the FMU's tolerance
    record: columns beside the states at the end: "NAME.max", "NAME.min", "NAME@end", "NAME@TIME", "events", "events.first", and of a single contact or friction "NAME.events",
        "NAME.first"; extremes are sampled at each `step`, else at the FMU's step size
    scheduler: the address of a Dask cluster, which runs them in place of this machine's cores
    """
    from .sweeps import sweep

    return sweep(system, vary, random=random, seed=seed, stop_time=stop_time, step=step, tolerance=tolerance, record=record, scheduler=scheduler, output=output)


def words(word: str | None = None) -> str:
    """What the reference of the language says about an element, attribute or function; all of it without a word."""
    from .reference import words

    return words(word)


def from_sympy(method: Any, path: str | PathLike[str], parameters: Mapping[Any, float], **options: Any) -> Path:
    """Writes the system of a LagrangesMethod of sympy.physics.mechanics: see lagrange_fmu.sympy_system.from_sympy."""
    try:
        from .sympy_system import OPTIONS, from_sympy
    except ModuleNotFoundError as missing:
        raise Problem(f"{missing.name} is not installed; it comes with pip install sympy") from None

    for name in options:
        if name not in OPTIONS:
            raise Problem(f"'{name}' is not an option of from_sympy; {instead(name, OPTIONS, 'expected one of these')}")
    return from_sympy(method, path, parameters, **options)
