"""
Every FMU in other importers, against FMPy's co-simulation.

Other importers that were tried are not usable here:

- OMSimulator: its Python package downloads the program during installation, from another server: "Failed building wheel for OMSimulator".
- PyFMI: the package is for Python 2 only. It is built against an FMI Library that Debian does not package: "Getting requirements to build wheel did not run successfully".
- FMI++: it builds against Boost and SWIG: "Failed building wheel for fmipp".
- CoFMUpy: it runs FMUs through FMPy, so that it would test nothing more.
"""

import os
import subprocess
import sys

import numpy as np
import pytest

import fmi3
import fmu
from fmu import BUILD, ROOT
from importing import constrained, packages, programs

pytestmark = pytest.mark.release

END, STEP = 0.5, packages.STEP
NANOSECONDS = packages.NANOSECONDS
ARCHIVES = {2: fmu.archive, 3: fmi3.archive}
SMOOTH = ["DampedPendulum", "FourBar", "MotorPendulum", "ParticleSpherical"]


def check(run, version, kind, name, bound, end=END):
    """Compare the outputs at the end with those of FMPy's co-simulation."""
    outputs = fmu.names_of(name, "output")
    expected = packages.fmpy(fmu.archive(name), "CS", end, outputs)
    values = run(ARCHIVES[version](name), kind, end, outputs)
    np.testing.assert_allclose(np.array(values, float), expected, rtol=bound, atol=bound)


@pytest.mark.parametrize("name", fmu.small_names())
def test_fmpy_model_exchange(name):
    """FMPy's CVode integrates the FMU's derivatives; its outputs agree with those of the FMU's solver, to its tolerance."""
    end = 0.02 if name == "AndrewsSqueezer" else END  # its crank turns a thousand times faster than others
    check(packages.fmpy, 2, "ME", name, 1e-4, end)


@pytest.mark.parametrize("version, run", [(2, packages.libcosim), (2, packages.ecos), (3, packages.ecos)])
def test_masters(name, version, run):
    check(run, version, "CS", name, 1e-9)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["SimplePendulum", "FourBar", "BouncingBall"])
def test_pathsim(name, version):
    check(packages.pathsim, version, "ME", name, 1e-6)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", SMOOTH)
def test_casadi(name, version):
    """CasADi's CVODES uses the Jacobians of the FMU."""
    check(packages.casadi, version, "ME", name, 1e-5)


def test_table(capfd, monkeypatch):
    """
    Unknown FMUs and importers that are not installed give an error with the available names; an importer that crashes gives a sentence.
    """
    from importing import __main__ as table

    for words, message in ((["--by", "Nobody"], "Nobody is not installed; expected FMPy"), (["Nothing"], "there is no FMU Nothing")):
        monkeypatch.setattr(sys, "argv", ["scripts/importers", *words])
        with pytest.raises(SystemExit):
            table.main()
        assert message in capfd.readouterr().err
    assert table.simulated(lambda: os._exit(3)) == "the process ended with code 3"
    assert table.simulated(lambda: 1 / 0) == "ZeroDivisionError: division by zero"
    rows = [["FMPy", 2, "CS", "One", 2e-9], ["FMPy", 2, "CS", "Other", "error 1.0e+00"]]
    assert table.table(rows, {"FMPy": "1.2"})[2] == "| FMPy | 1.2 | 1 of 2, 2e-09 | – | – | – |"


def test_cost_of_constraints():
    """
    Bounds: 10 events a second, and ten times the error of the same motion in minimal coordinates. Evaluations are at most three times those of the
    pendulum in minimal coordinates (AndrewsSqueezer: of 1000 s a second).
    """
    rows = {name: (float(end), int(evaluations), int(events), quotient) for name, end, evaluations, events, _, _, _, quotient in
            (line.strip("| ").split(" | ") for line in constrained.table(BUILD / "fmu")[2:])}  # fmt: skip
    assert set(rows) == set(constrained.SYSTEMS)
    for name, (end, _, events, quotient) in rows.items():
        assert events <= 10 * end * (1000 if name == "AndrewsSqueezer" else 1)
        assert name == "SimplePendulum" or float(quotient) <= 10
    assert rows["PendulumCartesian"][1] <= 3 * rows["SimplePendulum"][1]
    assert rows["SimplePendulum"][2] == 0 and rows["FourBar"][2] > 0


PROGRAM = """#!/bin/sh
{check}
cat > {file} <<'END'
{rows}
END
"""


@pytest.mark.parametrize("program, run, check, file, rows", [
    ("OMSimulator", programs.omsimulator, "", "out.csv", 'time, model.root.fmu.y\n0, 1\n0.5, 7.5'),
    ("fmusim", programs.fmusim, "", "out.csv", '"time","y"\n0,1\n0.5,7.5'),
    ("fmi4ctest", programs.fmi4c, "", "out.csv", "time,y\n0,1\n0.5,7.5"),
    ("MasterSimulator", programs.mastersim, 'grep -q \'simulator 0 0 fmu .* "X.fmu"\' project.msim && mkdir -p project/results || exit 1',
     "project/results/values.csv", "Time [s]\tfmu.y [m]\n0\t1\n0.5\t7.5"),
])  # fmt: skip
def test_programs_on_the_path(program, run, check, file, rows, tmp_path, monkeypatch):
    """A stand-in for each program writes the kind of file that its manual describes, with names, units and quotes."""
    (tmp_path / program).write_text(PROGRAM.format(check=check, file=file, rows=rows))
    (tmp_path / program).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    assert run("X.fmu", "CS", 0.5, ["y"]) == [7.5]


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
    FMPy's CVode is of another version than that in the FMU. Loaded first, with all symbols visible, it must not replace the FMU's own: the
    result has the same bits as in a process without it.
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
    """Two FMUs of this project coupled by libcosim: the feedback keeps the pole upright."""
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
