"""
Simulate FMUs in importers that are Python packages. Each function simulates one FMU from 0 s on and returns its outputs at the end:

    run(archive, kind, end, outputs)

`archive` is the path of an FMU of FMI 2.0 or 3.0. `kind` is "CS" for co-simulation or "ME" for model exchange, `end` is in s, and `outputs` are names.
In model exchange importers integrate with the relative tolerance TOLERANCE; in co-simulation masters step by STEP.
"""

import tempfile
from importlib.metadata import version as version_of

import numpy as np

STEP = 0.01  # s
TOLERANCE = 1e-8  # relative
NANOSECONDS = 10**9  # nanoseconds in a second; libcosim counts time in them


def fmpy(archive, kind, end, outputs, tolerance=None):
    import fmpy

    words = {"CS": "CoSimulation", "ME": "ModelExchange"}
    tolerance = tolerance or (TOLERANCE if kind == "ME" else None)
    result = fmpy.simulate_fmu(str(archive), stop_time=end, output_interval=min(STEP, end), output=outputs,
                               fmi_type=words[kind], relative_tolerance=tolerance)  # fmt: skip
    if abs(result["time"][-1] - end) > 1e-9:
        raise RuntimeError(f"ended at {result['time'][-1]:g} s")
    return [result[output][-1] for output in outputs]


def libcosim(archive, kind, end, outputs):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(round(STEP * NANOSECONDS))
    slave = execution.add_local_slave(CosimLocalSlave(str(archive), "fmu"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    if not execution.simulate_until(round(end * NANOSECONDS)):
        raise RuntimeError("a step failed")
    references = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
    return observer.last_real_values(slave, [references[output] for output in outputs])


def ecos(archive, kind, end, outputs):
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("fmu", str(archive))
    with EcosSimulation(STEP, structure=structure) as simulation:
        simulation.init()
        simulation.step(round(end / STEP))
        values = [simulation.get_real(f"fmu::{output}") for output in outputs]
        simulation.terminate()
    return values


def casadi(archive, kind, end, outputs):
    """Simulate by CVODES with the FMU's Jacobian. CasADi has no events, and does not run the FMU's initialization."""
    import casadi
    import fmpy

    with tempfile.TemporaryDirectory() as folder:
        builder = casadi.DaeBuilder("fmu", str(fmpy.extract(archive, folder)), {})
        first = fmpy.simulate_fmu(str(archive), stop_time=1e-6, output=[*builder.x(), *builder.u()])[0]  # after initialization
        start = lambda names: np.array([first[name] for name in names])
        function = builder.create("f", ["t", "x", "u"], ["ode", "y"])
        t, x, u = casadi.MX.sym("t"), casadi.MX.sym("x", builder.nx()), casadi.MX.sym("u", builder.nu())
        ode, y = function(t, x, u)
        inputs, state = start(builder.u()), start(builder.x())
        if builder.nx():
            options = {"reltol": TOLERANCE, "abstol": TOLERANCE / 100}
            integrator = casadi.integrator("i", "cvodes", {"t": t, "x": x, "u": u, "ode": ode}, 0.0, end, options)
            state = integrator(x0=state, u=inputs)["xf"]
        values = dict(zip(builder.y(), np.array(function(end, state, inputs)[1]).ravel()))
        return [values[output] for output in outputs]


def pathsim(archive, kind, end, outputs):
    """
    Simulate by pathsim's Runge-Kutta method of order 5, with event location.

    pathsim sets all inputs, so constants provide their start values. It takes the first co-simulation step at time 0, so outputs belong to the
    next communication point.
    """
    from pathsim import Connection, Simulation
    from pathsim.blocks import Constant
    from pathsim.solvers import RKDP54
    from pathsim_fmi import CoSimulationFMU, ModelExchangeFMU

    block = ModelExchangeFMU(str(archive)) if kind == "ME" else CoSimulationFMU(str(archive), dt=STEP)
    variables = block.fmu_wrapper.model_description.modelVariables
    sources = [Constant(float(v.start)) for v in variables if v.causality == "input"]
    links = [Connection(source, block[i]) for i, source in enumerate(sources)]
    simulation = Simulation([*sources, block], links, dt=min(STEP, end), Solver=RKDP54, tolerance_lte_rel=TOLERANCE,
                            tolerance_lte_abs=TOLERANCE / 100, log=False)  # fmt: skip
    simulation.run(end if kind == "ME" else end - STEP / 2)
    names = [v.name for v in variables if v.causality == "output"]
    values = dict(zip(names, block.outputs.to_array()))
    return [values[output] for output in outputs]


def pyfmi(archive, kind, end, outputs):
    """Simulate by PyFMI; in model exchange by CVode of Assimulo."""
    from pyfmi import load_fmu

    model = load_fmu(str(archive), kind=kind, log_level=0)
    options = model.simulate_options() | {"ncp": round(end / STEP) or 1}
    if kind == "ME":
        options["CVode_options"] = options["CVode_options"] | {"rtol": TOLERANCE, "atol": TOLERANCE / 100}
    with tempfile.NamedTemporaryFile(suffix=".mat") as file:
        result = model.simulate(final_time=end, options=options | {"result_file_name": file.name})
        return [result[output][-1] for output in outputs]


def of(package):
    """Return a function that returns the installed version of a package."""
    return lambda: version_of(package)


# Name: (function that returns the installed version, supported (version of FMI, kind), function that simulates).
BOTH = [(2, "CS"), (2, "ME"), (3, "CS"), (3, "ME")]
IMPORTERS = {
    "FMPy": (of("fmpy"), BOTH, fmpy),
    "libcosim": (of("libcosimpy"), [(2, "CS")], libcosim),
    "ecos": (of("ecospy"), [(2, "CS"), (3, "CS")], ecos),
    "CasADi": (of("casadi"), [(2, "ME"), (3, "ME")], casadi),
    "pathsim": (of("pathsim"), BOTH, pathsim),
    "PyFMI": (of("pyfmi"), BOTH, pyfmi),
}
