"""Sweeps of the clone and of the package: what one can, the other can, to the same results."""

import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest

import package
from building import ROOT, build_systems
from ensemble_runs import HERE
from fmu import all_names, archive
from scripts.ensembles import source_of

# Its method is auto, and it has events, so that the runtime for single lanes needs most that a system may refer to.
BALL = """\
<system name="BallInOil">
  <parameter name="m" start="1" unit="kg" min="0"/> <parameter name="c" start="0.5" unit="N.s/m"/> <parameter name="g" start="9.81" unit="m/s2"/>
  <coordinate name="h" velocity="v" unit="m" start="1"/>
  <kinetic>m*v^2/2</kinetic>
  <potential>m*g*h</potential>
  <dissipation>c*v^2/2</dissipation>
  <contact name="ground" gap="h" restitution="0.7" unit="m"/>
  <output name="speed" unit="m/s">abs(v)</output>
  <solver method="auto"/>
  <experiment stopTime="1.4" stepSize="0.01"/>
</system>
"""


class Ball:
    """Its flights: h(t) = h0 - u t + tau (v0 + u) (1 - exp(-t/tau)) with tau = m/c and u = g tau."""

    def __init__(self, c, g=9.81):
        self.tau, self.u = 1 / c, g / c

    def at(self, t, h, v):
        fading = np.exp(-t / self.tau)
        return h - self.u * t + self.tau * (v + self.u) * (1 - fading), -self.u + (v + self.u) * fading

    def impact(self, h, v):
        """The time of the next impact, by Newton's method from beyond it, where the fall is concave."""
        t = 2 * (max(v, 0) + np.sqrt(v**2 + 2 * 9.81 * h)) / 9.81 + 0.1
        for _ in range(60):
            height, speed = self.at(t, h, v)
            t -= height / speed
        return t

    def flights(self, end, h=1.0, v=0.0, e=0.7):
        """(begin, height, velocity) of each flight until the end."""
        found, t = [(0.0, h, v)], 0.0
        while (t := t + (rest := self.impact(h, v))) < end:
            h, v = 0.0, -e * self.at(rest, h, v)[1]
            found.append((t, h, v))
        return found


@pytest.fixture(scope="module")
def assembled(tmp_path_factory):
    return package.assemble(tmp_path_factory.mktemp("package"))


@pytest.fixture(params=["clone", "package"])
def command(request, assembled):
    """The command line of a sweep, and the process's environment."""
    clone = [sys.executable, ROOT / "scripts" / "sweep.py"], {"PYTHONPATH": str(ROOT / "scripts")}
    return clone if request.param == "clone" else ([sys.executable, "-m", "lagrange_fmu", "sweep"], package.environment(assembled))


@pytest.fixture
def sweep(command, tmp_path):
    def run(*words):
        words = [*command[0], *words, "--output", tmp_path / "runs.parquet"]
        result = subprocess.run(list(map(str, words)), env=command[1], capture_output=True, text=True)
        assert result.returncode == 0 and result.stderr == "", result.stderr
        return pq.read_table(tmp_path / "runs.parquet").to_pydict(), result.stdout

    return run


@pytest.fixture(scope="module")
def ball():
    build_systems("ball-in-oil", {"BallInOil": BALL})
    return archive("BallInOil")


@pytest.mark.parametrize("count", [40, 2000])
def test_a_damped_ball(count, ball, sweep):
    """Its bounces in closed form, by few runs, which the FMU does, and by many, which are done in lanes."""
    table, text = sweep(ball, "--vary", f"c=0.1:2:{count}")
    assert f"{count} runs, 0 failed" in text
    for run in range(0, count, count // 20):
        ball = Ball(table["c"][run])
        begin, *start = ball.flights(1.4)[-1]
        assert [table["h_end"][run], table["v_end"][run]] == pytest.approx(ball.at(1.4 - begin, *start), rel=1e-7, abs=1e-8)


@pytest.mark.release
def test_all_systems_over_lanes(assembled, tmp_path):
    """Each library of the package is complete: it can be loaded with all that it refers to, wherever the clone's can."""
    sources = {name: source for name in all_names() if (source := source_of(archive(name)))}
    assert len(sources) > 25
    for name, source in sources.items():
        (tmp_path / f"{name}.c").write_text(source)
    code = """
import os, sys
from ctypes import CDLL
from pathlib import Path
from tempfile import TemporaryDirectory
from lagrange_fmu.sweeps import compile_ensemble
for path in sys.argv[2:]:
    with TemporaryDirectory() as folder:
        CDLL(str(compile_ensemble(Path(folder), Path(path).read_text(), int(sys.argv[1]))), mode=os.RTLD_NOW).ensemble_serves
"""
    result = package.python(assembled, "-c", code, HERE, *sorted(tmp_path.glob("*.c")), cwd=tmp_path)
    assert result.returncode == 0, result.stderr
