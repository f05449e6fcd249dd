"""
Every FMU in importers that others wrote, beside FMPy's co-simulation of it.

Also tried and not here: OMSimulator (its Python package downloads the program while it is installed, from a server
other than the package registry: "Failed building wheel for OMSimulator"), PyFMI (on the registry for Python 2 only,
built against an FMI Library that Debian does not package: "Getting requirements to build wheel did not run
successfully"), FMI++ (builds against Boost and SWIG: "Failed building wheel for fmipp"), CoFMUpy (runs FMUs through
FMPy, so it would prove nothing more).
"""

import subprocess
import sys

import fmpy
import numpy as np
import pytest

import fmi3
import fmu
from fmu import BUILD, ROOT

pytestmark = pytest.mark.release

END, STEP = 0.5, 0.01
NANOSECONDS = 10**9  # libcosim counts time in them


def outputs_by_fmpy(name, end=END):
    """The outputs at the end after steps of STEP, by FMPy."""
    outputs = fmu.names_of(name, "output")
    result = fmpy.simulate_fmu(
        str(fmu.unpacked(name)), stop_time=end, output_interval=STEP, output=outputs, fmi_type="CoSimulation"
    )
    assert result["time"][-1] == pytest.approx(end)
    return outputs, np.array([result[output][-1] for output in outputs])


@pytest.mark.parametrize("name", fmu.small_names())
def test_fmpy_model_exchange(name):
    """FMPy's CVode integrates our derivatives; at its tolerance the outputs agree with our own solver."""
    end = 0.02 if name == "AndrewsSqueezer" else END  # its crank turns a thousand times faster than others
    outputs, expected = outputs_by_fmpy(name, end)
    result = fmpy.simulate_fmu(
        str(fmu.unpacked(name)), stop_time=end, output_interval=STEP, output=outputs, fmi_type="ModelExchange",
        relative_tolerance=1e-8,
    )
    ours = np.array([result[output][-1] for output in outputs])
    np.testing.assert_allclose(ours, expected, rtol=1e-4, atol=1e-5)


def test_libcosim(name):
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.FATAL)
    outputs, expected = outputs_by_fmpy(name)
    execution = CosimExecution.from_step_size(round(STEP * NANOSECONDS))
    slave = execution.add_local_slave(CosimLocalSlave(str(fmu.archive(name)), name))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.simulate_until(round(END * NANOSECONDS))
    references = fmu.references(name)
    values = observer.last_real_values(slave, [references[output] for output in outputs])
    np.testing.assert_allclose(values, expected, rtol=1e-9, atol=1e-9)


def values_by_ecos(name, archive, outputs):
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model(name, str(archive))
    with EcosSimulation(STEP, structure=structure) as simulation:
        simulation.init()
        simulation.step(round(END / STEP))
        values = [simulation.get_real(f"{name}::{output}") for output in outputs]
        simulation.terminate()
    return values


def test_ecos(name):
    outputs, expected = outputs_by_fmpy(name)
    np.testing.assert_allclose(values_by_ecos(name, fmu.archive(name), outputs), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["DampedPendulum", "FourBar", "ParticleCartesian", "StateFeedback"])
def test_ecos_with_fmi3(name):
    outputs, expected = outputs_by_fmpy(name)
    np.testing.assert_allclose(values_by_ecos(name, fmi3.archive(name), outputs), expected, rtol=1e-9, atol=1e-9)


def check_by_toolbox(archive, version):
    tool = BUILD / "venv" / "bin" / "fmutool"
    result = subprocess.run([tool, "-input", archive, "-check"], capture_output=True, text=True)
    text = result.stdout + result.stderr
    assert result.returncode == 0, text
    assert f"compliant with {version}" in text and "No semantic error" in text and "ERROR" not in text, text


def test_fmu_manipulation_toolbox_finds_no_error(name):
    check_by_toolbox(fmu.archive(name), "FMI-2.0")


@pytest.mark.parametrize("name", ["ChainPendulum", "FourBar", "StateFeedback"])
def test_fmu_manipulation_toolbox_finds_no_error_with_fmi3(name):
    check_by_toolbox(fmi3.archive(name), "FMI-3.0")


COUPLED = """
import sys
sys.path.insert(0, {support!r})
import fmu
instance = fmu.Instance("ElasticPendulum").initialize(dict(theta=1.0, k=1e6))
print(instance.run(1.0, 0.1, "theta", "r", "omega", "vr")[-1])
"""


def test_two_sundials_in_one_process():
    """
    FMPy's CVode is of another version than the one in our FMU. Loaded first, with all its symbols visible, it must
    not be the one that our FMU calls: the result has the same bits as in a process without it.
    """
    load = (
        "import ctypes, fmpy.sundials\n"
        "from pathlib import Path\n"
        "folder = Path(fmpy.sundials.__file__).parent\n"
        "libraries = sorted(folder.rglob('*.so*'))\n"
        "assert libraries\n"
        "for library in libraries: ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)\n"
    )
    alone, together = (
        subprocess.run(
            [sys.executable, "-c", before + COUPLED.format(support=str(ROOT / "tests" / "support"))],
            capture_output=True, text=True, check=True,
        ).stdout
        for before in ("", load)
    )
    assert alone == together and "nan" not in alone


def test_cart_balanced_by_libcosim():
    """Two of our FMUs coupled by a master of others: the feedback holds the pole up."""
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(5 * NANOSECONDS // 1000)
    cart, feedback = (
        execution.add_local_slave(CosimLocalSlave(str(fmu.archive(name)), name))
        for name in ("InvertedPendulumCart", "StateFeedback")
    )
    of_cart, of_feedback = fmu.references("InvertedPendulumCart"), fmu.references("StateFeedback")
    for name in ("x", "theta", "v", "omega"):
        execution.connect_real_variables(cart, of_cart[name], feedback, of_feedback[name])
    execution.connect_real_variables(feedback, of_feedback["F"], cart, of_cart["F"])
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.simulate_until(15 * NANOSECONDS)
    x, theta = observer.last_real_values(cart, [of_cart["x"], of_cart["theta"]])
    assert abs(theta) < 1e-2 and abs(x) < 0.1
