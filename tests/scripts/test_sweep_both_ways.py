"""Sweeps of the clone and of the package have the same features and results."""

import subprocess
import sys
import zipfile

import numpy as np
import pyarrow.parquet as pq
import pytest

import package
from building import ROOT, build_systems
from ensemble_runs import HERE
from fmu import all_names, archive
from scripts.library.ensembles import source_of

# The method is auto and there are events, so that the runtime for single lanes needs most symbols that a system may refer to.
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
    """Flights with linear drag: h(t) = h0 - u t + tau (v0 + u) (1 - exp(-t/tau)) with tau = m/c and u = g tau."""

    def __init__(self, c, g=9.81):
        self.tau, self.u = 1 / c, g / c

    def at(self, t, h, v):
        fading = np.exp(-t / self.tau)
        return h - self.u * t + self.tau * (v + self.u) * (1 - fading), -self.u + (v + self.u) * fading

    def impact(self, h, v):
        """Time of the next impact, by Newton's method from beyond it, where the height is concave."""
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
    """Command line of a sweep, and the environment of its process."""
    clone = [sys.executable, ROOT / "scripts" / "commands" / "sweep.py"], {"PYTHONPATH": str(ROOT / "scripts")}
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
    """The bounces follow a closed form, for few runs, by the FMU, and for many, in lanes."""
    table, text = sweep(ball, "--vary", f"c=0.1:2:{count}")
    assert f"{count} runs, 0 failed" in text
    for run in range(0, count, count // 20):
        ball = Ball(table["c"][run])
        begin, *start = ball.flights(1.4)[-1]
        assert [table["h_end"][run], table["v_end"][run]] == pytest.approx(ball.at(1.4 - begin, *start), rel=1e-7, abs=1e-8)


def test_bounces_are_recorded(sweep):
    """
    A ball bounces at t0 (1 + 2 e + ... + 2 e^n), t0 = sqrt(2 h/g), to the height e^2n h and with the speed e^n sqrt(2 g h). The recorded
    time h@0.3 lies between bounces.
    """
    table, _ = sweep(archive("BouncingBall"), "--vary", "h=1,2", "--vary", "e=0.6,0.7,0.8", "--vary", "v=0,2", "--stop", "2", "--record", "h.max,h.min,v.max, v.min,h@0.3", "--record", "ground.events,ground.first,events,totalEnergy")
    for h, e, v, *found in zip(*(table[name] for name in ("h", "e", "v", "h.max", "h.min", "v.max", "v.min", "h@0.3", "ground.first", "ground.events", "events", "totalEnergy@end"))):
        speed = np.sqrt(v**2 + 2 * 9.81 * h)
        first = (v + speed) / 9.81
        expected = [h + v**2 / (2 * 9.81), 0, max(v, e * speed), -speed, h + v * 0.3 - 9.81 * 0.3**2 / 2, first]
        assert found[:6] == pytest.approx(expected, rel=1e-8, abs=1e-8)
        bounces = first + 2 * speed / 9.81 * np.cumsum([0, *(e ** np.arange(1, 40))])
        count = np.count_nonzero(bounces < 2)
        assert found[6] == found[7] and (found[6] == count if count < 40 else found[6] > 15)
        assert found[8] == pytest.approx(9.81 * h + v**2 / 2 if count == 0 else e ** (2 * count) * speed**2 / 2, rel=1e-7, abs=1e-9)


def test_extremes_between_samples(sweep):
    """omega at the lowest point is sqrt(2 g/l (1 - cos theta0)), which lies between samples."""
    table, _ = sweep(archive("SimplePendulum"), "--vary", "theta=0.5:3:5", "--stop", "20", "--step", "0.01", "--record", "omega.max,omega.min,theta.min,theta.max")
    starts = np.linspace(0.5, 3, 5)
    for name, expected in (("omega.max", np.sqrt(2 * 9.81 * (1 - np.cos(starts)))), ("theta.max", starts)):
        np.testing.assert_allclose(table[name], expected, rtol=1e-6)
        np.testing.assert_allclose(table[name.replace("max", "min")], -expected, rtol=1e-6)


def test_values_at_times_in_lanes(sweep):
    """Values of many runs agree with those of a free fall."""
    table, _ = sweep(archive("BouncingBall"), "--vary", "h=10:20:2000", "--stop", "1", "--record", "h@0.25,v@0.5,h,h@0")
    h = np.linspace(10, 20, 2000)
    for name, expected in (("h@0.25", h - 9.81 / 32), ("v@0.5", np.full(2000, -9.81 / 2)), ("h@end", h - 9.81 / 2), ("h@0", h)):
        np.testing.assert_allclose(table[name], expected, rtol=1e-9)
    assert len(set(table["runTime"])) < 20


@pytest.mark.parametrize("record, message", [
    ("quux.max", "'quux.max' of record is not known in BouncingBall; expected NAME.max, NAME.min, NAME@end"),
    ("h.maxi", "'h.maxi' of record is not known in BouncingBall; did you mean 'h.max'?"),
    ("totalEnegy@1", "'totalEnegy@1' of record is not known in BouncingBall; did you mean 'totalEnergy@1'?"),
    ("h@3", "'h@3' of record has no time from 0 to 2 s; expected NAME@end or NAME@TIME"),
    ("groud.events", "'groud' of 'groud.events' is neither a contact nor a friction of BouncingBall; did you mean 'ground'?"),
])  # fmt: skip
def test_values_that_cannot_be_recorded(command, tmp_path, record, message):
    words = [*command[0], archive("BouncingBall"), "--vary", "h=1,2", "--stop", "2", "--record", record, "--output", tmp_path / "runs.parquet"]
    result = subprocess.run(list(map(str, words)), env=command[1], capture_output=True, text=True)
    assert result.returncode == 1 and message in result.stderr and not (tmp_path / "runs.parquet").exists(), result.stderr


BESIDE = """<system name="Beside"><parameter name="u" start="1"/>
<coordinate name="a" velocity="va" start="1"/><coordinate name="b" velocity="vb" start="2"/><particle mass="1" x="a"/><particle mass="1" x="b"/>
<potential>9.81*(a + b)</potential><contact name="low" gap="a" restitution="0.7"/><contact name="high" gap="b" restitution="0.7"/>
<coordinate name="x" velocity="v" velocityStart="u"/><particle mass="1" x="x"/><friction name="rub" coordinate="x" force="1"/>
<force coordinate="x">if(time &lt; 0.1, 1, 0)</force></system>"""


def test_events_of_each_contact_and_friction(sweep):
    """
    Two balls bounce at t0 (1 + 2 e + ... + 2 e^n), t0 = sqrt(2 h/g), beside a block that the friction stops at 0.1 s + u/mu, as a force
    balances the friction at first.
    """
    build_systems("recorded-beside", {"Beside": BESIDE})
    table, _ = sweep(archive("Beside"), "--vary", "u=0.5,1", "--vary", "a=0.5,1", "--stop", "1.4", "--record", "low.events,low.first,high.events,high.first,rub.events,rub.first,events,b.max")
    for u, a, *found in zip(*(table[name] for name in ("u", "a", "low.events", "high.events", "rub.events", "events", "low.first", "high.first", "rub.first", "b.max"))):
        first = np.sqrt(2 * np.array([a, 2]) / 9.81)
        counts = [np.count_nonzero(t * (1 + 2 * np.cumsum([0, *(0.7 ** np.arange(1, 9))])) < 1.4) for t in first]
        assert found[:4] == [*counts, 1, sum(counts) + 2], "the force switches, too"
        assert found[4:] == pytest.approx([*first, 0.1 + u, 2], rel=1e-9)


def test_events_of_a_collision_chain(sweep):
    """The first of four balls that touch in a row is hit. All contacts between them switch at that time, and at no other."""
    balls = "".join(f'<coordinate name="x{i}" velocity="v{i}" start="{place}"/><particle mass="1" x="x{i}"/>' for i, place in enumerate((-1, 0, 1, 2)))
    contacts = "".join(f'<contact name="c{i}" gap="x{i + 1} - x{i} - {0.5 if i == 0 else 1}" restitution="1"/>' for i in range(3))
    build_systems("recorded-chain", {"Chain": f'<system name="Chain">{balls}{contacts}</system>'})
    table, _ = sweep(archive("Chain"), "--vary", "v0=1,2", "--stop", "1", "--record", ",".join(f"c{i}.{what}" for i in range(3) for what in ("events", "first")))
    for i in range(3):
        assert table[f"c{i}.events"] == [1, 1] and table[f"c{i}.first"] == pytest.approx([0.5, 0.25])


def test_an_fmu_that_does_not_report_what_switches(command, tmp_path):
    with zipfile.ZipFile(archive("BouncingBall")) as old, zipfile.ZipFile(tmp_path / "Old.fmu", "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name).replace(b"life cycle, and what switches", b"life cycle"))
    words = [*command[0], tmp_path / "Old.fmu", "--vary", "h=1,2", "--record", "ground.events", "--output", tmp_path / "runs.parquet"]
    result = subprocess.run(list(map(str, words)), env=command[1], capture_output=True, text=True)
    assert result.returncode == 1 and "Old.fmu does not report which contact or friction switches; expected an FMU that is built anew, or --record events" in result.stderr


@pytest.mark.release
def test_all_systems_over_lanes(assembled, tmp_path):
    """Each library of the package is complete: it loads with all its references, as the clone's does."""
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
        CDLL(str(compile_ensemble(Path(folder), Path(path).read_text(), int(sys.argv[1]))), mode=os.RTLD_NOW).ensemble_supports
"""
    result = package.python(assembled, "-c", code, HERE, *sorted(tmp_path.glob("*.c")), cwd=tmp_path)
    assert result.returncode == 0, result.stderr
