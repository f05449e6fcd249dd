"""Files are written completely or not at all, and errors name the file; the rows before a simulation stopped are kept."""

import subprocess
from contextlib import suppress
from types import SimpleNamespace

import numpy as np
import pytest

from scripts.pages import html_page
import package
from building import build_systems
from fmu import archive
from motions import lagrange_fmu  # noqa: F401
from scripts.library.problem import Problem
from scripts.library.whole_files import write_whole

# x = t, until the square root becomes undefined at 1.1 s.
WALL = """\
<system name="Wall">
  <parameter name="m" start="1" unit="kg"/> <parameter name="c" start="0" unit="N"/> <parameter name="L" start="1.1" unit="m"/>
  <coordinate name="x" velocity="v" unit="m" velocityStart="1"/>
  <kinetic>m*v^2/2</kinetic>
  <force coordinate="x">c*sqrt(1 - x/L)</force>
  <experiment stopTime="2" stepSize="0.25"/>
</system>
"""


def test_a_file_that_fails_leaves_the_one_before(tmp_path, monkeypatch):
    path = tmp_path / "page.html"
    assert write_whole(path, "good") == path

    def full(*words):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(Problem, match="page.html cannot be written: No space left on device"):
        write_whole(path, "worse")
    assert path.read_text() == "good" and [file.name for file in tmp_path.iterdir()] == ["page.html"]


def test_tables_and_systems_that_fail_leave_the_ones_before(lagrange_fmu, tmp_path, monkeypatch):  # noqa: F811
    """Tables of reports, and the files of a fit."""
    from lagrange_fmu import fit_result

    table, system = tmp_path / "table.csv", tmp_path / "fitted.xml"
    html_page.write_csv(table, ["a", "b"], [[1, 2]])
    assert table.read_bytes() == b"a,b\r\n1,2\r\n"
    system.write_text("good")
    (tmp_path / "wall.xml").write_text(WALL)
    fit = SimpleNamespace(system=tmp_path / "wall.xml", shared=["m"], values={"m": 2.0})

    def full(*words):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(Problem, match="table.csv cannot be written: No space left on device"):
        html_page.write_csv(table, ["a"], [[3]])
    with pytest.raises(lagrange_fmu.Problem, match="fitted.xml cannot be written: No space left on device"):
        fit_result.Fit.write_system(fit, system)
    assert table.read_bytes() == b"a,b\r\n1,2\r\n" and system.read_text() == "good"


def test_devices_and_links(tmp_path):
    """Devices are written to, not replaced; the target of a link is replaced."""
    write_whole("/dev/null", "nothing")
    (tmp_path / "link").symlink_to(tmp_path / "target")
    write_whole(tmp_path / "link", b"content")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "target").read_bytes() == b"content"


@pytest.fixture(scope="module")
def command(tmp_path_factory):
    folder = package.assemble(tmp_path_factory.mktemp("package"))
    return lambda *words, cwd: package.run(folder, *words, cwd=cwd)


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 2 MB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "none", folder], capture_output=True).returncode != 0:
        pytest.skip("this user cannot mount a file system")
    yield folder
    subprocess.run(["umount", folder], check=True)


def fill(folder):
    """Fill the file system."""
    with open(folder / "rest", "wb", buffering=0) as file, suppress(OSError):
        while True:
            file.write(bytes(4096))


def test_a_full_disk(small_disk, command):
    """Existing files stay; no empty file hinders the next try; the message names the file."""
    assert command("run", archive("SimplePendulum"), cwd=small_disk).returncode == 0
    csv = small_disk / "SimplePendulum.csv"
    before = csv.read_bytes()
    fill(small_disk)
    for words, name in ((("run", archive("SimplePendulum")), "SimplePendulum.csv"), (("new", "Mine"), "Mine.xml")):
        result = command(*words, cwd=small_disk)
        assert result.returncode == 1 and f"{name} cannot be written: No space left on device" in result.stderr
    assert csv.read_bytes() == before and not (small_disk / "Mine.xml").exists()
    (small_disk / "rest").unlink()
    assert command("new", "Mine", cwd=small_disk).returncode == 0


def test_a_simulation_that_stops(command, tmp_path):
    """The rows until then are in a file of another name, no rows of an earlier run remain, and the message appears once."""
    build_systems("wall", {"Wall": WALL})
    assert command("run", archive("Wall"), "--stop-time", "0.5", cwd=tmp_path).returncode == 0
    assert (tmp_path / "Wall.csv").exists()
    result = command("run", archive("Wall"), cwd=tmp_path)
    (line,) = result.stderr.splitlines()
    assert result.returncode == 1 and "status" not in line and line.endswith("the motion until 1 s is in Wall-stopped.csv"), line
    rows = np.genfromtxt(tmp_path / "Wall-stopped.csv", delimiter=",", names=True)
    np.testing.assert_allclose(rows["time"], [0, 0.25, 0.5, 0.75, 1])
    np.testing.assert_allclose(rows["x"], rows["time"], atol=1e-12)
    assert not (tmp_path / "Wall.csv").exists()
    assert command("run", archive("Wall"), "--stop-time", "0.5", cwd=tmp_path).returncode == 0
    assert (tmp_path / "Wall.csv").exists() and not (tmp_path / "Wall-stopped.csv").exists()
