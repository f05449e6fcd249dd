"""Optional arrays in FMI 3.0: by CMake, the package and its command."""

import importlib
import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from building import BUILD
from fmu import ROOT
from motions import lagrange_fmu  # noqa: F401

ROW = """<system name="Row"><for index="i" from="1" to="3"><coordinate name="x[i]" velocity="v[i]" unit="m"/><particle mass="1" x="x[i]"/></for></system>"""
POSITIONS = {False: {"x[1]": None, "x[2]": None, "x[3]": None}, True: {"x": "3"}}  # coordinates with their dimension, without arrays and with them


def positions(description):
    variables = ElementTree.fromstring(description).find("ModelVariables")
    dimensions = {variable.get("name"): variable.find("Dimension") for variable in variables}
    return {name: None if size is None else size.get("start") for name, size in dimensions.items() if name[0] == "x"}


@pytest.mark.parametrize("arrays", [False, True])
def test_cmake_makes_arrays_by_choice(arrays, tmp_path):
    """ARRAYS of the build is passed to lagrange_add_fmu, and from there to lagc."""
    (tmp_path / "systems" / "Row").mkdir(parents=True)
    (tmp_path / "systems" / "Row" / "system.xml").write_text(ROW)
    folder = tmp_path / "build"
    words = [f"-DSYSTEMS={tmp_path / 'systems'}", f"-DTOOLS={ROOT / 'build'}", "-DFMI_VERSIONS=3", *(["-DARRAYS=ON"] if arrays else [])]
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, *words], check=True, capture_output=True)
    subprocess.run(["cmake", "--build", folder, "--target", "derive_Row"], check=True, capture_output=True)
    assert positions((folder / "systems" / "Row" / "fmi3" / "modelDescription.xml").read_text()) == POSITIONS[arrays]


@pytest.mark.parametrize("arrays", [False, True])
def test_the_package_makes_arrays_by_choice(arrays, lagrange_fmu, tmp_path, monkeypatch):
    """arrays= of build() and --arrays of the command, without a compiler: only the descriptions are packed."""
    building, command = (importlib.import_module(f"lagrange_fmu.{name}") for name in ("building", "command"))
    for file in (BUILD / "global_names", ROOT / "LICENSE"):
        shutil.copy(file, Path(building.__file__).parent / "runtime")
    monkeypatch.setattr(building, "compile_libraries", lambda folder, name, platforms, fmi: [])
    file = tmp_path / "row.xml"
    file.write_text(ROW)
    by_function = building.build(file, fmi=3, output=tmp_path, arrays=arrays)
    (tmp_path / "by_command").mkdir()
    command.main(["build", str(file), "--fmi", "3", "--output", str(tmp_path / "by_command"), *(["--arrays"] if arrays else [])])
    for archive in (by_function, tmp_path / "by_command" / "Row.fmu"):
        with zipfile.ZipFile(archive) as content:
            assert positions(content.read("modelDescription.xml")) == POSITIONS[arrays]
