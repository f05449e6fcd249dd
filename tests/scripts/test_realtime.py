"""Durations of single communication steps."""

import os
import subprocess
import sys

from fmpy import read_model_description

from scripts.bench import realtime
from fmu import archive, unpacked


def test_times_of_steps():
    """All steps of a system with impacts are measured, and the quantiles ascend."""
    row = realtime.measure("BouncingBall", unpacked("BouncingBall"), read_model_description(archive("BouncingBall")), 3000)
    assert row["steps"] == "3000"
    times = [float(row[name]) for name in ("median", "99.9 %", "longest", "longest as seen")]
    assert 0 < times[0] < times[-1] and times == sorted(times)
    assert row["system calls"] in (0, "")
    assert int(row["allocations"]) <= 3  # those of the first step and the first impact, for any number of impacts


def test_an_fmu_that_stops():
    """A missing library is an error, without times."""
    words = realtime.words_for(unpacked("BouncingBall"), read_model_description(archive("BouncingBall")), 10, 1)
    words[1] = "/nonexistent.so"
    assert subprocess.run(words, capture_output=True).returncode != 0


def test_peers():
    """FMPy's solvers take as many steps of the same model."""
    for solver in ("Euler", "CVode"):
        row = realtime.imported_pendulum(solver, 200)
        assert row["steps"] == 200 and 0 < float(row["median"]) <= float(row["longest"]) <= float(row["longest as seen"])


def test_a_peer_in_python(tmp_path):
    """PythonFMU, which scripts/test installs, runs in its own process, since an error in its library would end this one."""
    code = "import sys; from scripts.bench import realtime; print([realtime.python_pendulum(folder, 300)['steps'] for folder in sys.argv[1:]])"
    folders = [tmp_path / name for name in ("first", "second", "third")]
    for folder in folders:
        folder.mkdir()
    result = subprocess.run([sys.executable, "-c", code, *folders], capture_output=True, text=True, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})
    assert result.returncode == 0 and result.stdout == "[300, 300, 300]\n", result.stderr
