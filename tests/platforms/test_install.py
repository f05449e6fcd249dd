"""cmake --install, and a separate project that builds FMUs with the installed files."""

import functools
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import fmu
from building import bring_up_to_date
from fmu import ROOT

pytestmark = pytest.mark.release

BEAD = (ROOT / "tests" / "systems" / "BeadOnHoop" / "system.xml").read_text()  # solver erk
PENDULUM = ROOT / "fmu" / "SimplePendulum" / "system.xml"
# Systems whose solvers differ from the default of systems with a <coordinate>: a robot in MJCF, a state alone, and formulas alone.
SWING = """<mujoco model="Swing"><worldbody><body name="rod"><joint name="hinge" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0 0 -1" size="0.02"/></body></worldbody></mujoco>"""
DECAY = '<system name="Decay"><state name="s" rate="-s" start="1"/><output name="y">s</output></system>'
GAIN = '<system name="Gain"><input name="u" unit="1"/><output name="y" unit="1">2*u</output></system>'


@functools.cache
def installed():
    """The prefix, moved after the installation, since it must be relocatable."""
    bring_up_to_date(ROOT / "build")
    folder = tempfile.TemporaryDirectory(prefix="installed here")
    fmu.temporary_folders.append(folder)
    subprocess.run([ROOT / "scripts" / "package" / "sundials-all"], check=True)
    subprocess.run(["cmake", "--install", ROOT / "build", "--prefix", Path(folder.name) / "first"], check=True, capture_output=True)
    return Path(shutil.move(Path(folder.name) / "first", Path(folder.name) / "second"))


def configure(folder, lines, *words, systems=None):
    """Configure a project with these lines; return CMake's result."""
    folder.mkdir(parents=True)
    for name, text in (systems or {}).items():
        (folder / name).write_text(text)
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.18)\nproject(Foreign LANGUAGES C)\nfind_package(lagrange-fmu 1 REQUIRED)\n" + lines + "\n"
    )
    command = ["cmake", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={installed()}", f"-DLAGRANGE_PYTHON={sys.executable}", *words]
    return subprocess.run(command, capture_output=True, text=True)


def build(folder):
    return subprocess.run(["cmake", "--build", folder / "build"], capture_output=True, text=True)


def simulate(archive):
    result = fmpy.simulate_fmu(str(archive), stop_time=1, output_interval=0.1, fmi_type="CoSimulation")
    return np.array(result.tolist())


def test_foreign_project(tmp_path):
    """FMUs for this machine by the project's compiler, with and without SUNDIALS, one for two platforms, and those of FMI 3.0."""
    lines = """
      lagrange_add_fmu(SimplePendulum system.xml)
      lagrange_add_fmu(BeadOnHoop bead.xml)
      lagrange_add_fmu(MyFmu mine.xml PLATFORMS linux64 win64 SOLVER auto FMI_VERSIONS 2 3)
      lagrange_add_fmu(ThirdFmu third.xml FMI_VERSIONS 3)
      lagrange_add_fmu(Swing swing.xml SOLVER auto)
      lagrange_add_fmu(Decay decay.xml SOLVER auto)
      lagrange_add_fmu(Gain gain.xml SOLVER auto)
    """
    text = PENDULUM.read_text()
    systems = {"system.xml": text, "bead.xml": BEAD, "swing.xml": SWING, "decay.xml": DECAY, "gain.xml": GAIN}
    systems |= {f"{file}.xml": text.replace('"SimplePendulum"', f'"{name}"', 1) for file, name in (("mine", "MyFmu"), ("third", "ThirdFmu"))}
    folder = tmp_path / "a project"
    result = configure(folder, lines, systems=systems)
    assert result.returncode == 0, result.stderr
    result = build(folder)
    assert result.returncode == 0, result.stdout + result.stderr
    archives = {path.stem: path for path in (folder / "build" / "fmu").iterdir()}
    assert sorted(archives) == ["BeadOnHoop", "Decay", "Gain", "MyFmu", "SimplePendulum", "Swing"]
    third = {path.stem: path for path in (folder / "build" / "fmi3").iterdir()}
    assert sorted(third) == ["MyFmu", "ThirdFmu"]
    for name in ("SimplePendulum", "BeadOnHoop"):
        assert fmpy.supported_platforms(str(archives[name])) == fmpy.supported_platforms(str(fmu.archive(name)))
        np.testing.assert_allclose(simulate(archives[name]), simulate(fmu.archive(name)), rtol=1e-9, atol=1e-12)
    assert set(fmpy.supported_platforms(str(archives["MyFmu"]))) >= {"linux64", "win64"}
    assert set(fmpy.supported_platforms(str(third["MyFmu"]))) >= {"linux64", "win64"}
    for archive in (archives["MyFmu"], *third.values()):
        np.testing.assert_allclose(simulate(archive), simulate(fmu.archive("SimplePendulum")), rtol=1e-7, atol=1e-9)
        assert validate_fmu(str(archive)) == []
    for name in archives:
        description = (Path(fmpy.extract(archives[name], tmp_path / name)) / "modelDescription.xml").read_text()
        assert ("solverHandovers" in description) == (name in ("MyFmu", "Swing", "Decay")), f"SOLVER auto for {name}"


@pytest.mark.parametrize(
    "line, message",
    [
        ("lagrange_add_fmu(Mine missing.xml)", "lagrange_add_fmu(Mine): there is no .*/missing.xml; expected the file of a system"),
        ("lagrange_add_fmu(Mine system.xml PLATFORMS vax)", "the platform 'vax' is not known; expected linux64, win64, darwin64, aarch64-linux, wasm32"),
        ("lagrange_add_fmu(Mine system.xml PLATTFORMS win64)", "unknown words 'PLATTFORMS;win64'; expected PLATFORMS, FMI_VERSIONS, SOLVER, FORM, ARRAYS or ROBOT"),
        ("lagrange_add_fmu(Mine system.xml FMI_VERSIONS 1)", "lagrange_add_fmu(Mine): there is no version 1 of FMI here; expected 2, 3 or both"),
    ],
)
def test_mistakes_in_a_project(line, message, tmp_path):
    result = configure(tmp_path / "project", line, systems={"system.xml": PENDULUM.read_text()})
    assert result.returncode != 0
    assert re.search(message.replace("(Mine)", r"\(Mine\)"), " ".join(result.stderr.split())), result.stderr


def test_another_name_than_the_system(tmp_path):
    configure(tmp_path / "project", "lagrange_add_fmu(Mine system.xml)", systems={"system.xml": PENDULUM.read_text()})
    result = build(tmp_path / "project")
    message = "the system is named 'SimplePendulum'; expected 'Mine', as its folder or lagrange_add_fmu() names it"
    assert result.returncode != 0 and message in " ".join(result.stderr.split()), result.stderr


def test_python_without_zig(tmp_path):
    """The message names the remedy."""
    python = tmp_path / "python3"
    python.write_text(f'#!/bin/sh\nexec {sys.executable} -S -I "$@"\n')
    python.chmod(0o755)
    result = configure(
        tmp_path / "project", "lagrange_add_fmu(Mine system.xml PLATFORMS win64)", f"-DLAGRANGE_PYTHON={python}", systems={"system.xml": PENDULUM.read_text()}
    )
    assert result.returncode != 0
    assert re.search(r"the Python package ziglang, .* pip install ziglang==\d", " ".join(result.stderr.split())), result.stderr


def test_installed_lagc_and_its_man_page():
    lagc = installed() / "bin" / "lagc"
    assert re.fullmatch(r"lagc \d+\.\d+\.\d+\n", subprocess.run([lagc, "--version"], capture_output=True, text=True).stdout)
    usage = subprocess.run([lagc, "--help"], capture_output=True, text=True).stdout
    page = (installed() / "share" / "man" / "man1" / "lagc.1").read_text().replace("\\-", "-")
    options = set(re.findall(r"(?<![\w-])--?[a-zA-Z]+", usage))
    assert options >= {"-o", "-D", "--solver", "--at", "--linearize"}
    assert all(option in page for option in options), options
    methods = re.search(r"--solver METHOD  (.*) in place", usage)[1]
    assert methods in page


def test_nothing_of_the_tree_is_needed():
    """The installed files contain no path of this machine."""
    for path in installed().rglob("*"):
        if path.is_file():
            assert os.fsencode(ROOT) not in path.read_bytes(), path
