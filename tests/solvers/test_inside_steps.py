"""The interface of every solver to the runtime: its own steps, and the states within the last one."""

import subprocess

import numpy as np
import pytest

import fmu
from building import runtime
from fmu import ROOT

TEXT = """<system name="Oscillator">
  <coordinate name="x" velocity="v" start="1"/>
  <particle name="p" mass="1" x="x"/>
  <potential>x^2/2</potential>
</system>
"""
END = 5.0
# Errors at a third of a step, at the tolerance 1e-9: erk has cubic dense output there; exact has none.
ERRORS = {"taylor": 1e-9, "erk": 1e-5, "bdf": 1e-8, "radau": 1e-8, "auto": 1e-9, "exact": None}


@pytest.mark.parametrize("method", ERRORS)
def test_steps(method, tmp_path):
    (tmp_path / "system.xml").write_text(TEXT)
    assert fmu.lagc("system.xml", "-o", "out", "--solver", method, cwd=tmp_path).returncode == 0
    program = tmp_path / "inside_steps"
    words = ["gcc", "-O1", f"-I{ROOT}/include", f"-I{ROOT}/src/runtime", ROOT / "tests" / "c" / "inside_steps.c",
             tmp_path / "out" / "system.c", *runtime(2), "-o", program]  # fmt: skip
    subprocess.run(list(map(str, words)), check=True)
    output = subprocess.run([program, str(END)], capture_output=True, text=True, check=True).stdout
    start, end, known_inside, inside, known, last = np.array([line.split() for line in output.splitlines()], float).T
    assert start[0] == 0.0 and np.all(start < end) and np.all(start[1:] == end[:-1])
    assert start[-1] < END <= end[-1] and (end[-1] == END or method in ("taylor", "bdf", "radau", "auto"))
    assert np.all(known == 1) and last == pytest.approx(np.cos(end), abs=3e-8)
    assert np.all(known_inside == (method != "exact"))
    if method != "exact":
        assert inside == pytest.approx(np.cos(start + (end - start) / 3), abs=ERRORS[method])
