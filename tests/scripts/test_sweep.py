"""Sweeps: all runs once, in order and correct; failures recorded; resumed after a kill."""

import itertools
import re
import signal
import subprocess
import sys
import time
import zipfile

import fmpy
import numpy as np
import pyarrow.parquet as pq
import pytest

from fmu import ROOT, archive, build_systems

pytestmark = pytest.mark.release


def command(output, *words):
    return [sys.executable, str(ROOT / "scripts" / "commands" / "sweep.py"), *words, "--output", str(output)]


def sweep(output, *words):
    result = subprocess.run(command(output, *words), capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "scripts")})
    assert result.returncode == 0 and result.stderr == "", result.stderr
    return pq.read_table(output).to_pydict(), result.stdout


def test_grid(tmp_path):
    table, _ = sweep(tmp_path / "grid.parquet", "SimplePendulum", "--vary", "l=0.5:2:20", "--vary", "theta0=0.1:3:15", "--stop", "2")
    assert table["run"] == list(range(300))
    lengths, angles = np.meshgrid(np.linspace(0.5, 2, 20), np.linspace(0.1, 3, 15), indexing="ij")
    np.testing.assert_array_equal(table["l"], lengths.ravel())
    np.testing.assert_array_equal(table["theta"], angles.ravel())
    for run in (0, 137, 299):
        starts = dict(l=table["l"][run], theta=table["theta"][run])
        result = fmpy.simulate_fmu(str(archive("SimplePendulum")), start_values=starts, stop_time=2, output_interval=2, output=["theta"])
        assert table["theta_end"][run] == pytest.approx(result["theta"][-1], abs=1e-12)
    assert np.max(np.abs(table["energyError"])) < 1e-10 and min(table["runTime"]) > 0
    assert set(table["problem"]) == {None}


PULLS = """<system name="Pulls"><parameter name="n" type="Integer" start="1" min="0"/><parameter name="on" type="Boolean" start="true"/><parameter name="F" start="1"/>
  <parameter name="seed" type="Integer" start="0"/><coordinate name="x" velocity="v"/><particle mass="2" x="x"/><force coordinate="x">if(on, n*F, 0)</force>
  <state name="z" rate="gauss(seed, 1)"/></system>"""


def test_integers_and_booleans_vary(tmp_path):
    """x = on n F t^2/4 at 2 s; z is that of the FMU with this seed."""
    build_systems("pulls", {"Pulls": PULLS})
    table, _ = sweep(tmp_path / "pulls.parquet", str(archive("Pulls")), "--vary", "n=1:3:3", "--vary", "on=true,false", "--vary", "F=0.5,2", "--vary", "seed=7,8", "--stop", "2")
    assert [tuple(table[name][run] for name in ("n", "on", "F", "seed")) for run in range(24)] == [*itertools.product((1, 2, 3), (1, 0), (0.5, 2), (7, 8))]
    np.testing.assert_allclose(table["x_end"], np.array(table["on"]) * table["n"] * table["F"], rtol=1e-12)
    for seed in (7, 8):
        result = fmpy.simulate_fmu(str(archive("Pulls")), start_values={"seed": seed}, stop_time=2, output_interval=2, output=["z"])
        assert {z for z, one in zip(table["z_end"], table["seed"]) if one == seed} == {result["z"][-1]}
    table, _ = sweep(tmp_path / "random.parquet", str(archive("Pulls")), "--vary", "n=1:4", "--random", "60", "--stop", "2")
    assert {*table["n"]} == {1, 2, 3, 4}
    for words, message in ((["n=1:2:3"], "'n' is an Integer, and 1.5 is none; expected whole numbers, such as n=1:5:5"), (["on=2"], "'on' is a Boolean, and 2 is none; expected on=0,1")):
        result = subprocess.run(command(tmp_path / "bad.parquet", str(archive("Pulls")), "--vary", *words), capture_output=True, text=True)
        assert result.returncode == 1 and message in result.stderr


def test_failures_are_recorded(tmp_path):
    table, text = sweep(tmp_path / "poles.parquet", "ParticleSpherical", "--vary", "phi=0,1,2", "--stop", "0.1")
    assert re.search("fmi2ExitInitializationMode.*mass matrix is singular.*'theta'", table["problem"][0])
    assert np.isnan(table["phi_end"][0])
    assert table["problem"][1:] == [None, None] and np.all(np.isfinite(table["phi_end"][1:]))
    assert "3 runs, 1 failed" in text


def test_many_runs_in_lanes(tmp_path):
    """Runs in lanes agree with single runs, with equal shares of the time; a run without a solution has the FMU's message in its row."""
    table, text = sweep(tmp_path / "lanes.parquet", "ParticleSpherical", "--vary", "phi=2:0:2500", "--stop", "0.5")
    assert "2500 runs, 1 failed" in text and re.search("fmi2ExitInitializationMode.*mass matrix is singular.*'theta'", table["problem"][-1])
    assert table["run"] == list(range(2500)) and set(table["problem"][:-1]) == {None}
    assert len(set(table["runTime"])) < 20 and min(table["runTime"]) > 0
    for run in (0, 1234, 2498):
        result = fmpy.simulate_fmu(str(archive("ParticleSpherical")), start_values={"phi": table["phi"][run]}, stop_time=0.5, output_interval=0.5, output=["r", "phi"])
        assert [table[f"{name}_end"][run] for name in ("r", "phi")] == pytest.approx(list(result[-1])[1:], rel=1e-9)
    table, text = sweep(tmp_path / "energies.parquet", "DoublePendulum", "--vary", "theta1=-3:3", "--random", "3000", "--stop", "1")
    assert 0 < np.max(np.abs(table["energyError"])) < 1e-10 and len(set(table["runTime"])) < 20


def test_sources_that_do_not_compile_over_lanes(tmp_path):
    """If sources do not compile, as may happen for another version, the sweep prints the error and runs one by one."""
    fmu = tmp_path / "Other.fmu"
    with zipfile.ZipFile(archive("SimplePendulum")) as source, zipfile.ZipFile(fmu, "w") as target:
        for name in source.namelist():
            target.writestr(name, source.read(name) + (b"#error other" if name.endswith(".c") else b""))
    words = command(tmp_path / "other.parquet", str(fmu), "--vary", "theta=0:3", "--random", "2000", "--stop", "0.1")
    result = subprocess.run(words, capture_output=True, text=True)
    assert "2000 runs, 0 failed" in result.stdout and result.stderr.endswith("Runs are computed one after another.\n") and "#error other" in result.stderr


def test_resumes_after_a_kill(tmp_path):
    """Killed as by a power failure, and started again: each run appears once, and no finished part is repeated."""
    output, words = tmp_path / "killed.parquet", ["BouncingBall", "--vary", "v=-2:2", "--random", "60000", "--stop", "3"]
    first = subprocess.Popen(command(output, *words), env={"PYTHONPATH": str(ROOT / "scripts")}, stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)  # fmt: skip
    for _ in range(6000):
        finished = sorted(tmp_path.glob("*.parts-*/*.parquet"))
        if len(finished) > 5 or first.poll() is not None:
            break
        time.sleep(0.005)
    first.send_signal(signal.SIGKILL)
    first.wait()
    assert not output.exists()
    stamps = {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("*.parts-*/*.parquet")}
    times = {}
    for path in tmp_path.glob("*.parts-*/*.parquet"):
        times |= dict(zip(*(pq.read_table(path).to_pydict()[column] for column in ("run", "runTime"))))
    table, text = sweep(output, *words)
    assert f"{len(times)} of 60000 runs are there already" in text and len(stamps) > 5
    assert table["run"] == list(range(60000))
    assert all(table["runTime"][run] == seconds for run, seconds in times.items())
    assert list(tmp_path.glob("*.parts-*")) == []


def interrupted(output, *words):
    """Run a sweep whose result cannot be written; return the folder of its parts."""
    whole = output.with_suffix(".part")
    whole.symlink_to("/dev/full")
    result = subprocess.run(command(output, *words), capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "scripts")})
    whole.unlink(missing_ok=True)
    (line,) = result.stderr.splitlines()
    expected = "cannot be written: No space left on device; expected a writable folder with free space, in which the same command continues"
    assert result.returncode == 1 and line.startswith(f"scripts/sweep: {output} {expected}"), line
    (folder,) = output.parent.glob("*.parts-*")
    return folder


WORDS = ["SimplePendulum", "--vary", "theta=0:3", "--random", "1000", "--stop", "1"]


def test_a_full_disk_loses_nothing(tmp_path):
    """A full disk at the result or at a part gives one line, and the same command resumes."""
    output = tmp_path / "full.parquet"
    folder = interrupted(output, *WORDS)
    assert len(list(folder.glob("*.parquet"))) == 4
    (folder / "000002.parquet").unlink()
    (folder / "000002.part").symlink_to("/dev/full")
    result = subprocess.run(command(output, *WORDS), capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "scripts")})
    (line,) = result.stderr.splitlines()
    assert result.returncode == 1 and f"{output} cannot be written: No space left on device; expected" in line
    (folder / "000002.part").unlink()
    table, text = sweep(output, *WORDS)
    assert "750 of 1000 runs are there already" in text and table["run"] == list(range(1000))


def test_damaged_parts_are_run_again(tmp_path):
    """A truncated part, and one of the right length that was never written to the disk."""
    output = tmp_path / "damaged.parquet"
    folder = interrupted(output, *WORDS)
    cut, empty = folder / "000001.parquet", folder / "000003.parquet"
    cut.write_bytes(cut.read_bytes()[: cut.stat().st_size // 2])
    empty.write_bytes(bytes(empty.stat().st_size))
    table, text = sweep(output, *WORDS)
    assert f"{cut} is damaged: runs 250 to 499 are run again\n" in text
    assert f"{empty} is damaged: runs 750 to 999 are run again\n500 of 1000 runs are there already" in text
    assert table["run"] == list(range(1000)) and set(table["problem"]) == {None}


def test_two_equal_sweeps_at_once(tmp_path):
    """The second waits for the first, and both are correct."""
    words = command(tmp_path / "x.parquet", "SimplePendulum", "--vary", "theta=0:3", "--random", "1500", "--stop", "20")
    both = [subprocess.Popen(words, env={"PYTHONPATH": str(ROOT / "scripts")}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    texts = [process.communicate(timeout=120) for process in both]
    assert [process.returncode for process in both] == [0, 0] and all("1500 runs, 0 failed" in text for text, _ in texts), texts
    assert [path.name for path in tmp_path.iterdir()] == ["x.parquet"] and pq.read_table(tmp_path / "x.parquet").num_rows == 1500


def test_nowhere_to_write():
    result = subprocess.run(command("/proc/x.parquet", *WORDS), capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "scripts")})
    (line,) = result.stderr.splitlines()
    assert result.returncode == 1 and line.startswith("scripts/sweep: ") and "/proc/x" in line


def test_the_energy_has_an_error_only_where_it_has_a_law(tmp_path):
    """A moved pivot does work, and so does a force without <work/>; neither counts as an energy error."""
    words = ["--vary", "theta=0.5,1", "--stop", "2"]
    for name in ("RotatingPivotPendulum", "InvertedPendulumCart"):
        table, text = sweep(tmp_path / f"{name}.parquet", name, *words)
        assert np.all(np.isnan(table["energyError"])) and "error of the energy" not in text
    table, text = sweep(tmp_path / "damped.parquet", "DampedPendulum", *words)
    assert np.max(np.abs(table["energyError"])) < 1e-7 and "error of the energy" in text


@pytest.mark.parametrize("words, message", [
    (["Nothing", "--vary", "l=1:2:3"], "there is no"),
    (["SimplePendulum", "--vary", "q=1:2:3"], "'q' has no start value in SimplePendulum; these have one: theta"),
    (["SimplePendulum", "--vary", "l=1:2"], "'l' has no COUNT"),
    (["SimplePendulum", "--vary", "l"], "is not a range; expected NAME=FROM:TO:COUNT"),
    (["SimplePendulum", "--vary", "l=1:2:3", "--vary", "l=3"], "varies twice"),
    (["SimplePendulum", "--vary", "l=1:2", "--random", "-5"], "random is -5; expected a whole number of runs"),
    (["SimplePendulum", "--vary", "l=1:2:3", "--step", "-1"], "step is -1.0; expected a positive number"),
    (["SimplePendulum", "--vary", "l=1:2:3", "--scheduler", "nowhere"], "no Dask scheduler answers at 'nowhere'"),
])  # fmt: skip
def test_bad_words(words, message, tmp_path):
    result = subprocess.run(command(tmp_path / "x", *words), capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "scripts")})
    assert result.returncode != 0 and message in result.stderr


def test_on_a_cluster_that_exists(tmp_path):
    """A sweep can use an existing scheduler; a dying worker loses no runs."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        words = ["SimplePendulum", "--vary", "theta=0:3", "--random", "8000", "--stop", "5", "--scheduler", cluster.scheduler_address]
        running = subprocess.Popen(command(tmp_path / "x.parquet", *words), env={"PYTHONPATH": str(ROOT / "scripts")})
        while not list(tmp_path.glob("*.parts-*/*.parquet")):
            assert running.poll() is None
            time.sleep(0.05)
        cluster.workers[0].process.process._process.kill()
        assert running.wait(timeout=120) == 0
    table = pq.read_table(tmp_path / "x.parquet").to_pydict()
    assert table["run"] == list(range(8000)) and set(table["problem"]) == {None}


def test_kills_at_random_times_lose_nothing(tmp_path):
    """
    Runs in lanes, killed while Python loads, while runs are computed, and while parts are written and joined. The file equals that of an
    undisturbed sweep.
    """
    words = ["SimplePendulum", "--vary", "theta=-3:3", "--random", "200000", "--stop", "1"]
    begin = time.monotonic()
    whole, _ = sweep(tmp_path / "whole.parquet", *words)
    length, generator, output = time.monotonic() - begin, np.random.default_rng(4), tmp_path / "killed.parquet"
    for kill in range(12):
        process = subprocess.Popen(command(output, *words), env={"PYTHONPATH": str(ROOT / "scripts")}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(generator.uniform(0.2, 1) * length)
        process.send_signal(signal.SIGKILL)
        if process.wait() == 0:  # it completed before the kill; the next one starts anew
            output.unlink()
    killed, _ = sweep(output, *words)
    assert {name: values for name, values in killed.items() if name != "runTime"} == {name: values for name, values in whole.items() if name != "runTime"}
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == []


def test_two_different_sweeps_to_one_file(tmp_path):
    """The second ends with a message, and the first is complete."""
    output = tmp_path / "x.parquet"
    words = ["SimplePendulum", "--vary", "theta=0:3", "--random", "1500", "--stop"]
    first = subprocess.Popen(command(output, *words, "1500"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not output.with_suffix(".part").exists():
        assert first.poll() is None
        time.sleep(0.005)
    second = subprocess.run(command(output, *words, "1"), capture_output=True, text=True)
    assert second.returncode == 1 and second.stderr == f"scripts/sweep: another sweep to {output} is running; expected another --output, or to wait for its end\n"
    assert first.wait(timeout=120) == 0
    table = pq.read_table(output)
    assert table.num_rows == 1500 and [path.name for path in tmp_path.iterdir()] == ["x.parquet"]
