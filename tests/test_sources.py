"""FMUs without SUNDIALS carry their sources, and FMPy builds them anew (rule 24)."""

import shutil
import subprocess

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from lxml import etree

import fmu
from fmu import ROOT

WITH_SOURCES = [name for name in fmu.all_names() if name != "ElasticPendulum"]


def test_who_has_sources(name):
    folder = fmu.unpacked(name) / "sources"
    assert folder.exists() == (name in WITH_SOURCES)
    if name not in WITH_SOURCES:
        return
    root = etree.parse(fmu.unpacked(name) / "modelDescription.xml").getroot()
    for section in ("ModelExchange", "CoSimulation"):
        listed = [file.get("name") for file in root.findall(f"{section}/SourceFiles/File")]
        assert sorted(listed) == sorted(path.name for path in folder.glob("*.c"))
    # FMI's own headers are the importer's.
    assert not {"fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"} & {path.name for path in folder.iterdir()}


@pytest.mark.parametrize("name", ["SimplePendulum", "InvertedPendulumCartLinear", "ChainPendulum", "StateFeedback"])
def test_fmpy_builds_the_sources(name, tmp_path):
    folder = tmp_path / name
    shutil.copytree(fmu.unpacked(name), folder)
    shutil.rmtree(folder / "binaries")
    build_platform_binary(folder)
    assert (folder / "binaries" / "linux64" / f"{name}.so").exists()
    built, packed = (
        fmpy.simulate_fmu(str(path), stop_time=2, output_interval=0.1, fmi_type="CoSimulation")
        for path in (folder, fmu.unpacked(name))
    )
    for output in packed.dtype.names:
        # Another compiler setting may contract a * b + c: rounding, no more.
        np.testing.assert_allclose(built[output], packed[output], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_sources_are_plain_c11(compiler, tmp_path):
    """Without any extension of the compiler, and with all its warnings."""
    for name in ("SimplePendulum", "ParticleCartesian", "StateFeedback"):
        sources = sorted((fmu.unpacked(name) / "sources").glob("*.c"))
        words = [compiler, "-std=c11", "-pedantic-errors", "-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror"]
        library = tmp_path / f"{name}.so"
        result = subprocess.run([*words, "-shared", "-fPIC", "-O1", *sources, "-o", library, "-lm"], capture_output=True, text=True)
        assert result.returncode == 0, result.stderr
    assert str(ROOT) not in (fmu.unpacked("SimplePendulum") / "sources" / "system.c").read_text()


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("option", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_fast_math_is_refused(compiler, option):
    """It takes away the checks for what is not finite, and the sums that carry their rounding along."""
    sources = sorted((fmu.unpacked("ChainPendulum") / "sources").glob("*.c"))
    assert len(sources) > 20
    for source in sources:
        words = [compiler, "-std=c11", "-O2", "-E", "-o", "/dev/null", source, option]
        result = subprocess.run(words, capture_output=True, text=True)
        assert result.returncode != 0 and "-ffast-math makes results wrong" in result.stderr, source.name
