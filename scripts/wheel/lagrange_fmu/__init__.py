"""
Build an FMU from the energies and forces of a mechanical system, simulate it, linearize it, and fit it to measurements.

    path = lagrange_fmu.build("pendulum.xml")
    motion = lagrange_fmu.simulate(path, {"theta": 1})
    A, B, C, D = lagrange_fmu.linearize(path, {"theta": 3.14159})[:4]

All functions raise `Problem` on errors. Its text names the cause and the remedy. A likely mistake in a system is a Python warning.
Numbers are in the units of the variables, SI units by default. Values may also be texts with units or expressions, such as "30deg" and "pi/2".
"""

from __future__ import annotations

from . import interrupts  # noqa: F401  # isort: skip  (first, as the other imports take long)

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .calls import checked
from .problem import Problem
from .variables import suggestion, names_of, numbers_by_name, pairs_by_name, some_names

if TYPE_CHECKING:
    import numpy as np

    from .adjoint import Gradient
    from .building import build, check, new
    from .equilibria import Equilibrium
    from .fit_result import Fit
    from .linearization import Linearization
    from .results import Result
    from .session import Simulation
    from .variational import Sensitivities

    __version__: str

__all__ = ["Problem", "build", "check", "equilibrium", "fit", "from_sympy", "gradient", "linearize", "live", "new", "run", "sensitivities", "simulate", "start", "sweep", "words"]


def __getattr__(name: str) -> Any:
    """Import build, check and new at their first use, so that the command starts fast and handles Ctrl-C early."""
    if name == "__version__":
        from importlib.metadata import version

        return version("lagrange-fmu")
    if name in ("build", "check", "new"):
        from . import building

        return checked(getattr(building, name))
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


@checked
def simulate(
    system: str | PathLike[str],
    start_values: Mapping[str, float] | None = None,
    *,
    output: str | Sequence[str] | None = None,
    input: str | PathLike[str] | np.ndarray | Mapping[str, Any] | Callable[..., Any] | Any = None,
    hold: bool = False,
    record_events: bool = True,
    fmi_type: str = "CoSimulation",
    fmi: int | None = None,
    solver: str | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    robot: Mapping[str, str | bool] | None = None,
    **options: Any,
) -> Result:
    """
    Simulate an FMU, or a system, which is built first.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    start_values : dict of float, optional
        Start values of coordinates, velocities, inputs and parameters by name, as numbers or as texts such as "30deg" and "pi/2". Other
        variables keep the start values of the system.
    output : str or sequence of str, optional
        Names of the variables to record in place of all outputs. Local variables, such as "totalEnergy", are allowed.
    input : path, array, dict, DataFrame or callable, optional
        A CSV, a structured array, a dict of arrays or a DataFrame with the columns "time" and names of inputs. Inputs are linear between rows;
        two rows with the same time are a jump. A function of time returns a dict of numbers by name, or a number for each input.
        A function of the time and the simulation, such as lambda t, sim: -sim["x"], gives the inputs that hold over each step.
        A dict of functions and numbers by name is allowed, too.
    hold : bool
        True to hold each input from row to row, or the value of a function over each step, instead of interpolating.
    record_events : bool
        True to record two rows for each event, with the same time: one before and one after the event.
    fmi_type : {"CoSimulation", "ModelExchange"}
        The FMU's own solver, or CVODE as FMPy drives it.
    fmi : {2, 3}, optional
        Version of FMI for a system that is not built yet; 2 by default.
    solver : str, optional
        Method in place of the system's own, for a system that is not built yet.
    stop_time, step : float, optional
        End of the simulation and communication step, in s; by default those of the FMU's experiment.
    tolerance : float, optional
        Relative tolerance; by default that of the FMU's experiment.
    robot : dict, optional
        Options for a robot, as for build().
    **options
        start_time (in s), debug_logging, visible, fmi_call_logger; in model exchange also the options of fmpy.simulate_fmu.

    Returns
    -------
    Result
        A structured array with a row for each communication point and two for each event. Its fields are "time", in s, and the recorded
        variables. It has the methods plot(), animate() and to_pandas().

    Raises
    ------
    Problem
        If a name or an option is unknown, the system cannot be built, or the simulation stops. A stopped simulation raises `problem.Unfinished`,
        whose `motion` has the rows until then.

    Examples
    --------
    >>> motion = lagrange_fmu.simulate("pendulum.xml", {"theta": 1}, stop_time=5)
    >>> motion["theta"][-1]
    """
    from .results import Result
    from .running import motion_of

    words = {"output": output, "input": input, "hold": hold, "fmi_type": fmi_type, "fmi": fmi, "solver": solver, "step": step, "tolerance": tolerance, "robot": robot}
    return Result.of(motion_of(system, start_values, None, stop_time=stop_time, record_events=record_events, **words, **options))


@checked
def start(
    system: str | PathLike[str],
    /,
    start_values: Mapping[str, float | str] | None = None,
    *,
    fmi: int | None = None,
    solver: str | None = None,
    tolerance: float | None = None,
    **values: float | str,
) -> Simulation:
    """
    Start an FMU, or a system, which is built first, for a program that takes its steps.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    start_values : dict of float, optional
        Start values of coordinates, velocities, inputs and parameters by name, as numbers or as texts such as "30deg".
    fmi : {2, 3}, optional
        Version of FMI for a system that is not built yet; 2 by default.
    solver : str, optional
        Method in place of the system's own, for a system that is not built yet.
    tolerance : float, optional
        Relative tolerance; by default that of the FMU's experiment.
    **values
        More start values, by names that are words of Python.

    Returns
    -------
    Simulation
        It reads and sets variables by name, and has step(), save(), restore(), reset() and close().

    Examples
    --------
    >>> with lagrange_fmu.start("cart.xml", theta="5deg") as sim:
    ...     while sim.time < 2:
    ...         sim["F"] = 20 * sim["theta"] + 4 * sim["omega"]
    ...         sim.step(0.01)
    """
    from .session import ARGUMENTS, Simulation

    for name, value in values.items():
        if isinstance(value, Mapping):
            raise Problem(f"'{name}' is not an argument of start; {suggestion(name, ARGUMENTS, 'expected one of these')}")
    return Simulation(system, numbers_by_name(start_values) | numbers_by_name(values), fmi, solver, tolerance)


@checked
def equilibrium(
    system: str | PathLike[str],
    guess: Mapping[str, float | str] | None = None,
    *,
    hold: Mapping[str, float | str] | None = None,
    vary: str | Sequence[str] = (),
) -> Equilibrium:
    """
    Find an equilibrium of a system near a guess: all time derivatives of states are 0, and constraints are satisfied.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    guess : dict of float, optional
        Coordinates, states, inputs and parameters where the search begins; by default their start values.
    hold : dict of float, optional
        Values of coordinates, states, outputs, inputs and parameters at the equilibrium.
    vary : str or sequence of str
        Inputs and parameters to solve for, such as the torque that holds an arm.

    Returns
    -------
    Equilibrium
        `point` has the values by name, for simulate() or linearize(); `outputs` the outputs there. `stability` is "stable", "unstable" or
        "undecided", by the `eigenvalues` of the `linearization`; `constraints` names closed contacts and sticking friction.

    Raises
    ------
    Problem
        If a name is unknown, or no equilibrium is found; the message names the accelerations and rates that remain.

    Examples
    --------
    >>> found = lagrange_fmu.equilibrium("arm.xml", {"elbow": 0.5}, hold={"height": 0.8}, vary=["torque"])
    >>> found.point["torque"], found.stability
    """
    from .equilibria import equilibrium

    return equilibrium(system, numbers_by_name(guess, "guess"), numbers_by_name(hold, "hold"), names_of(vary, "vary"))


@checked
def linearize(
    system: str | PathLike[str], at: Mapping[str, float] | None = None, parameters: Mapping[str, float] | None = None
) -> Linearization:
    """
    Linearize an FMU or a system at a point, by its exact directional derivatives.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    at : dict of float, optional
        Coordinates, velocities and inputs of the point; by default their start values. Initialization moves the point onto the constraints.
    parameters : dict of float, optional
        Values of parameters; by default their start values.

    Returns
    -------
    Linearization
        A named tuple with A (n x n), B (n x m), C (p x n) and D (p x m) for n states, m inputs and p outputs; the names `states`, `inputs` and
        `outputs`; the `point`; and `constraints`, the names of closed contacts and sticking friction. These count as constraints.
        In a system with constraints, the states are a set of independent states.

    Raises
    ------
    Problem
        If a name is unknown, or the system is not differentiable at the point.

    Warns
    -----
    UserWarning
        If the point is not an equilibrium.

    Examples
    --------
    >>> A, B, C, D = lagrange_fmu.linearize("cart.xml", {"theta": 0})[:4]
    """
    from .linearization import linearize

    for name in {*(at or {})} & {*(parameters or {})}:
        raise Problem(f"'{name}' is in at and in parameters; expected it once")
    return linearize(system, numbers_by_name(at, "at") | numbers_by_name(parameters, "parameters"))


@checked
def sensitivities(
    system: str | PathLike[str],
    of: Sequence[str],
    by: Sequence[str],
    times: Sequence[float],
    start_values: Mapping[str, float] | None = None,
    tolerance: float = 1e-10,
) -> Sensitivities:
    """
    Differentiate a motion with respect to start values, parameters and constant inputs, by the variational equations.

    The FMU's own solver integrates the variational equations of a system in XML; SciPy integrates those of an FMU. At an event the
    sensitivities jump (saltation matrix); values at the time of an event are those before it.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    of : sequence of str
        Names of outputs, states and derivatives of states.
    by : sequence of str
        Names of start values, parameters and inputs.
    times : sequence of float
        Increasing times, in s. The motion starts at 0 s.
    start_values : dict of float, optional
        Start values, parameters and inputs of the motion by name.
    tolerance : float
        Relative tolerance.

    Returns
    -------
    Sensitivities
        `values[of]` and `derivatives[of, by]`, arrays over the times.

    Raises
    ------
    Problem
        If the motion has no derivative: at simultaneous events, at a grazing event, or where neighbouring motions enter other modes.

    Examples
    --------
    >>> found = lagrange_fmu.sensitivities("pendulum.xml", of=["theta"], by=["l"], times=[0, 1, 2])
    >>> found.derivatives["theta", "l"]
    """
    from .variational import sensitivities

    return sensitivities(system, some_names(of, "of"), some_names(by, "by"), times, numbers_by_name(start_values), tolerance)


@checked
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
    Differentiate one number of a motion with respect to many parameters, by the adjoint equation.

    The number is the output or state `of` at the stop time, or its integral, or the sum of squared residuals against `data`. SciPy integrates
    the adjoint equation backwards in time. The cost does not grow with the number of parameters, unless an event or the start depends on them.
    Events are handled as in sensitivities().

    Parameters
    ----------
    system : path
        A system in XML, a robot in URDF, a folder that contains a system.xml, or an FMU of FMI 3.0 without arrays.
    of : str, optional
        Name of an output or state. Give either `of` or `data`.
    by : sequence of str
        Names of parameters, start values and constant inputs.
    stop_time : float, optional
        End of the motion, in s; required with `of`.
    data : path or structured array, optional
        Measurements, as for fit().
    integral : bool
        True for the integral of `of` over the motion, in place of its value at the end.
    noise : dict of float, optional
        Standard deviations by measured name, as for fit(); the residuals are divided by them.
    start_values : dict of float, optional
        Start values, parameters and inputs of the motion by name.
    tolerance : float
        Relative tolerance.

    Returns
    -------
    Gradient
        `value`, and `derivatives` by name.

    Raises
    ------
    Problem
        If the motion has no derivative, as in sensitivities().

    Examples
    --------
    >>> found = lagrange_fmu.gradient("pendulum.xml", "theta", by=["l", "b"], stop_time=2)
    >>> found.derivatives["l"]
    """
    from .adjoint import gradient

    return gradient(system, of, some_names(by, "by"), stop_time, data, integral, numbers_by_name(noise, "noise"), numbers_by_name(start_values), tolerance)


@checked
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
    Fit parameters and start values to measurements, by nonlinear least squares with exact derivatives.

    The search is a trust-region method within bounds. A motion that cannot be computed rejects the step. A motion without exact derivatives
    is differentiated by finite differences. Ctrl-C ends the search and returns the best values so far.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    data : path, structured array, or a list of these
        Measurements, one item for each experiment. The columns are "time", measured outputs or states, and measured inputs. The first line of a CSV
        names them, optionally with units. A dict of arrays or a DataFrame is allowed too. NaN and empty cells are missing measurements.
    vary : sequence of str
        Names of the parameters and start values to fit, common to all experiments.
    start_values : dict of float, optional
        Initial guesses of these, and values of other variables.
    bounds : dict of (float, float), optional
        Bounds by name; by default the variables' min and max.
    noise : dict of float, optional
        Standard deviations by measured name; by default all columns have equal weight.
    each : sequence of str
        Names of start values, parameters or inputs to fit for each experiment separately. Their initial guesses are their first measurements.
    loss : {"linear", "soft_l1", "huber", "cauchy"}
        Loss function. The last three are robust against outliers and need `noise`.

    Returns
    -------
    Fit
        Values, standard deviations, intervals of 95 %, undetermined directions, and remarks, such as a misfit. It has the methods
        write_page() and write_system().

    Raises
    ------
    Problem
        If a name is unknown, the data are malformed, or the motion from the initial guesses cannot be computed.

    Examples
    --------
    >>> fit = lagrange_fmu.fit("pendulum.xml", "data.csv", vary=["l", "b"], noise={"theta": 0.01})
    >>> print(fit)
    """
    from .fitting import fit

    return fit(system, data, names_of(vary, "vary"), numbers_by_name(start_values), pairs_by_name(bounds), numbers_by_name(noise, "noise"), names_of(each, "each"), loss)


@checked
def run(
    system: str | PathLike[str], start_values: Mapping[str, float] | None = None, folder: str | PathLike[str] = ".", **words: Any
) -> dict[str, Path | str]:
    """
    Simulate a system or an FMU, and write NAME.fmu, NAME.csv, NAME.png and NAME-motion.html.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    start_values : dict of float, optional
        As for simulate().
    folder : path
        Folder of the results.
    **words
        Further arguments of simulate().

    Returns
    -------
    dict
        The path of each result by its kind ("FMU", "CSV", "plot", "animation"), or a text with the reason why it does not exist.

    Raises
    ------
    Problem
        As simulate(). A simulation that stops leaves NAME-stopped.csv.

    Examples
    --------
    >>> lagrange_fmu.run("pendulum.xml", {"theta": 1}, "results")["CSV"]
    """
    from .running import run

    return run(system, start_values, folder, **words)


@checked
def live(system: str | PathLike[str], output: str | PathLike[str] | None = None, *, edit: bool = False, start_values: Mapping[str, float | str] | None = None, robot: Mapping[str, str | bool] | None = None) -> Path:
    """
    Write a page in which the FMU of a system runs, in any browser and without a network.

    Parameters
    ----------
    system : path
        A system in XML, a robot in URDF, a folder that contains a system.xml, or an FMU, which `edit` excludes.
    output : path, optional
        The page; by default NAME.html, or NAME-edit.html with `edit`, in the current folder.
    edit : bool
        True to show the system beside its motion, so that it can be changed in the page.
    start_values : dict, optional
        Start values, parameters and inputs by name with which the page begins, as numbers or texts such as "30deg"; not with `edit`.
    robot : dict, optional
        Options for a robot, as for build().

    Returns
    -------
    Path
        The path of the page.

    Raises
    ------
    Problem
        If the system cannot be built, or an FMU is to be edited.

    Examples
    --------
    >>> page = lagrange_fmu.live("pendulum.xml", edit=True)
    """
    from .pages import live

    return live(system, start_values, output, edit, robot)


@checked
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
    Simulate a grid or a random sample of start values and parameters, on all cores.

    An interrupted sweep keeps its finished runs beside the output. The same call continues with the others.

    Parameters
    ----------
    system : path
        An FMU, a system in XML, a robot in URDF, or a folder that contains a system.xml.
    vary : dict
        By name, a range (FROM, TO, COUNT) as a tuple, or a list or array of values. Several names make a grid.
    random : int, optional
        Number of runs of a random sample in place of the grid. Ranges are then (FROM, TO).
    seed : int
        Seed of the random sample.
    stop_time, step : float, optional
        End of each run and communication step, in s; by default the end of the FMU's experiment, in one step.
    tolerance : float, optional
        Relative tolerance; by default that of the FMU.
    record : str or sequence of str, optional
        Columns beside the states at the end: "NAME.max", "NAME.min", "NAME@end", "NAME@TIME", "events", "events.first", and for a
        contact or friction "NAME.events" and "NAME.first". Extremes are sampled at each `step`, by default at the FMU's step size.
    scheduler : str, optional
        Address of a Dask cluster, which computes the runs in place of this machine.
    output : path, optional
        The Parquet file; by default NAME-sweep.parquet in the current folder.

    Returns
    -------
    Path
        The path of the Parquet file, which has a row for each run.

    Raises
    ------
    Problem
        If a name or a range is invalid, or pyarrow is not installed.

    Examples
    --------
    >>> runs = lagrange_fmu.sweep("pendulum.xml", {"l": (0.5, 2, 50), "theta": [0.1, 1]}, record="theta.max")
    """
    from .sweeps import sweep

    return sweep(system, vary, random=random, seed=seed, stop_time=stop_time, step=step, tolerance=tolerance, record=record, scheduler=scheduler, output=output)


@checked
def words(word: str | None = None) -> str:
    """
    Return the paragraphs of the language reference that mention a word.

    Parameters
    ----------
    word : str, optional
        An element, attribute or function; by default the whole reference is returned.

    Returns
    -------
    str
        Text in Markdown.

    Raises
    ------
    Problem
        If the reference does not mention the word.

    Examples
    --------
    >>> print(lagrange_fmu.words("restitution"))
    """
    from .reference import words

    return words(word)


@checked
def from_sympy(method: Any, path: str | PathLike[str], parameters: Mapping[Any, float], **options: Any) -> Path:
    """
    Write the system of a LagrangesMethod of sympy.physics.mechanics as XML.

    Symbols may be given by their names in all dicts.

    Parameters
    ----------
    method : LagrangesMethod
        Lagrangian, forces and constraints; form_lagranges_equations() is not needed.
    path : path
        The file to write, NAME.xml; NAME is the name of the system.
    parameters : dict of float
        Values of the symbols of the method.
    **options
        start, speeds, description, stop_time, outputs, units, constraints, points: see lagrange_fmu.sympy_system.from_sympy.

    Returns
    -------
    Path
        The path of the file.

    Raises
    ------
    Problem
        If SymPy is not installed, a value is missing, or an expression has no counterpart in the language.

    Examples
    --------
    >>> system = lagrange_fmu.from_sympy(method, "Pendulum.xml", {m: 1, l: 0.5, g: 9.81}, start={theta: 1})
    """
    try:
        from .sympy_system import OPTIONS, from_sympy
    except ModuleNotFoundError as missing:
        raise Problem(f"{missing.name} is not installed; it comes with pip install sympy") from None

    for name in options:
        if name not in OPTIONS:
            raise Problem(f"'{name}' is not an option of from_sympy; {suggestion(name, OPTIONS, 'expected one of these')}")
    return from_sympy(method, path, parameters, **options)
