"""
Stabilize the cart by a controller of PythonFMU, and by this project's StateFeedback, in the masters FMPy, libcosim and ecos.

Prints for each combination whether the pendulum is balanced.
"""

import subprocess
import sys

import numpy as np

from coupling.balance import END, STATES, by_fmpy_script, lqr_gains
from coupling.slaves import FMUS, ROOT

STEP = 0.005
START = dict(theta=0.2)
FOLDER = ROOT / "build" / "foreign"


def python_controller():
    """Build the FMU of python_controller.py with PythonFMU; return its path."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    script = ROOT / "scripts" / "coupling" / "python_controller.py"
    words = [sys.executable, "-m", "pythonfmu", "build", "-f", script, "-d", FOLDER]
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return FOLDER / "PythonController.fmu"


def by_fmpy(controller, gains):
    return by_fmpy_script(START, gains, STEP, controller=controller)[-1, 1:]


def by_libcosim(controller, gains):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(round(STEP * 10**9))
    archives = {"cart": FMUS / "InvertedPendulumCart.fmu", "feedback": controller}
    slaves = {name: execution.add_local_slave(CosimLocalSlave(str(path), name)) for name, path in archives.items()}
    references = {name: {v.name.decode(): v.reference for v in execution.slave_variables(slave)} for name, slave in slaves.items()}
    for name, values in (("cart", START), ("feedback", gains)):
        for variable, value in values.items():
            execution.real_initial_value(slaves[name], references[name][variable], value)
    for state in STATES:
        execution.connect_real_variables(slaves["cart"], references["cart"][state], slaves["feedback"], references["feedback"][state])
    execution.connect_real_variables(slaves["feedback"], references["feedback"]["F"], slaves["cart"], references["cart"]["F"])
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.simulate_until(round(END * 10**9))
    return observer.last_real_values(slaves["cart"], [references["cart"][state] for state in STATES])


def by_ecos(controller, gains):
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("cart", str(FMUS / "InvertedPendulumCart.fmu"))
    structure.add_model("feedback", str(controller))
    for state in STATES:
        structure.make_real_connection(f"cart::{state}", f"feedback::{state}")
    structure.make_real_connection("feedback::F", "cart::F")
    start = {f"{name}::{variable}": value for name, values in (("cart", START), ("feedback", gains)) for variable, value in values.items()}
    structure.add_parameter_set("start", start)
    with EcosSimulation(STEP, structure=structure) as simulation:
        simulation.init(parameter_set="start")
        simulation.step(round(END / STEP))
        result = [simulation.get_real(f"cart::{state}") for state in STATES]
        simulation.terminate()
    return result


def main():
    gains = lqr_gains()
    controllers = {"PythonFMU's controller": python_controller(), "StateFeedback": FMUS / "StateFeedback.fmu"}
    for master, run in (("FMPy", by_fmpy), ("libcosim", by_libcosim), ("ecos", by_ecos)):
        for name, controller in controllers.items():
            try:
                states = run(controller, gains)
            except Exception as problem:  # any failure of one program must not stop the others
                print(f"{master:9} {name:24} failed: {problem!r}")
                continue
            balanced = np.max(np.abs(states)) < 1e-2
            print(f"{master:9} {name:24} {'balanced' if balanced else 'fell'}: theta = {states[1]:.2e} after {END:g} s", flush=True)


if __name__ == "__main__":
    main()
