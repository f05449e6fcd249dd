"""Values with units on command lines and in Python, against conversion factors of the SI brochure and the international yard and pound."""

import math
import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest

import package
from fmu import LAGC, ROOT, archive

sys.path.insert(0, str(ROOT))
from scripts.library.problem import Problem  # noqa: E402
from scripts.library.quantities import number_of  # noqa: E402
from scripts.library.simulation import simulate  # noqa: E402


@pytest.fixture(scope="module")
def command(tmp_path_factory):
    folder = package.assemble(tmp_path_factory.mktemp("package"))
    return lambda *words, cwd: package.run(folder, *words, cwd=cwd)


@pytest.mark.parametrize("text, unit, number", [
    ("0.5", "rad", 0.5), ("-1e-3", "1", -1e-3), ("pi/2", "rad", math.pi / 2), ("2*sin(pi/6)^2", "1", 0.5),
    (" 30 deg ", "rad", math.pi / 6), ("-90 °", "rad", -math.pi / 2), ("180deg/s", "rad/s", math.pi), ("60rpm", "rad/s", 2 * math.pi),
    ("20cm", "m", 0.2), ("1.5e3mm", "m", 1.5), ("1inch", "m", 0.0254), ("500g", "kg", 0.5), ("5min", "s", 300), ("36km/h", "m/s", 10),
    ("3l/min", "m3/s", 5e-5), ("2bar", "Pa", 2e5), ("20degC", "K", 293.15), ("10%", "1", 0.1), ("2N.mm", "N.m", 2e-3), ("7N", "kg.m/s2", 7), ("45deg", "deg", 45),
    ("pi/2", "furlong", math.pi / 2), ("3furlong", "furlong", 3),
])  # fmt: skip
def test_values(text, unit, number):
    assert number_of("x", text, unit) == pytest.approx(number, rel=1e-15)


@pytest.mark.parametrize("text, unit, message", [
    ("30kg", "rad", "x: '30kg' is in kg; expected a value in rad"),
    ("20cm", "1", "x: '20cm' is in cm; expected a value in 1"),
    ("1Hz", "rad/s", "x: '1Hz' is in Hz; expected a value in rad/s"),
    ("3furlong", "m", "x: the unit 'furlong' of '3furlong' is not known; expected a value in m"),
    ("3m", "furlong", "x: '3m' is in m; expected a value in furlong"),
    ("half", "m", "x: the value: unknown name 'half'; expected a number, perhaps with its unit, such as 0.5, pi/2 or 30deg"),
    ("1/0", "m", "x: the value: a division by zero has no value"),
    ("2 3", "m", "x: the value: "),
    ("", "m", "x: the value: expected a number"),
    ("nan", "m", "x: 'nan' is not finite; expected a finite number in m"),
    ("1e400m", "mm", "x: "),
    ("0x10", "m", "x: the value: '0x' is not a number"),
    ("1,5", "m", "x: the value: "),
    ("m=3", "m", "x: the value: "),
])  # fmt: skip
def test_wrong_values(text, unit, message):
    with pytest.raises(Problem) as problem:
        number_of("x", text, unit)
    assert str(problem.value).startswith(message)


def test_lagc_needs_both_words():
    for words in (["--value", "x=1"], ["--value", "1", "--unit", "m"], ["--unit", "m"]):
        result = subprocess.run([LAGC, *words], capture_output=True, text=True)
        assert result.returncode == 1 and result.stderr.startswith("usage: lagc")


def test_start_values():
    """height = l (1 - cos(30 deg)) at the start."""
    motion = simulate(archive("SimplePendulum"), {"theta": "30deg", "l": "20cm", "m": "pi/4"}, stop_time=0.1)
    assert motion.outputs["theta"][0] == pytest.approx(math.pi / 6, rel=1e-15)
    assert motion.start["l"] == 0.2 and motion.start["m"] == pytest.approx(math.pi / 4, rel=1e-15)
    with pytest.raises(Problem, match="^l: '2kg' is in kg; expected a value in m$"):
        simulate(archive("SimplePendulum"), {"l": "2kg"})


@pytest.mark.long
def test_commands(command, tmp_path):
    fmu = archive("SimplePendulum")
    ran = command("run", fmu, "theta=30deg", "l=20cm", "--stop-time", "0.1", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert np.genfromtxt(tmp_path / "SimplePendulum.csv", delimiter=",", names=True)["theta"][0] == pytest.approx(math.pi / 6, rel=1e-15)
    wrong = command("run", fmu, "theta=30kg", cwd=tmp_path)
    assert wrong.returncode == 1 and wrong.stderr == "lagrange-fmu: theta: '30kg' is in kg; expected a value in rad\n"

    found = command("linearize", fmu, "--at", "theta=180deg", "--set", "l=20cm", cwd=tmp_path)
    assert "at theta = 3.14159265" in found.stdout and "7.00357" in found.stdout  # sqrt(g/l), at the upper equilibrium

    data = tmp_path / "data.csv"
    swings = simulate(fmu, {"l": 0.4, "theta": 0.2}, output=["theta"], stop_time=1).outputs
    np.savetxt(data, np.column_stack([swings["time"], swings["theta"]]), delimiter=",", header="time,theta", comments="")
    words = ["--vary", "l", "--bounds", "l=10cm:100cm", "--set", "theta=0.2", "l=50cm", "--noise", "theta=0.1deg"]
    fitted = command("fit", fmu, data, *words, cwd=tmp_path)
    assert float(fitted.stdout.split()[1]) == pytest.approx(0.4, rel=1e-6), fitted.stdout + fitted.stderr
    beyond = command("fit", fmu, data, "--vary", "l", "--bounds", "l=10cm:20cm", "--set", "l=50cm", cwd=tmp_path)
    assert "the initial value 0.5 of 'l' is outside its bounds, 0.1 and 0.2" in beyond.stderr


def test_sweeps(tmp_path):
    command = [sys.executable, ROOT / "scripts" / "commands" / "sweep.py", "SimplePendulum", "--stop", "0.1", "--output", tmp_path / "runs.parquet"]
    subprocess.run([*command, "--vary", "theta=0deg:90deg:3", "--vary", "l=20cm,0.5"], check=True, capture_output=True)
    runs = pq.read_table(tmp_path / "runs.parquet").to_pydict()
    assert sorted(set(runs["l"])) == [0.2, 0.5]
    theta = next(values for name, values in runs.items() if name.startswith("theta") and max(values) == pytest.approx(math.pi / 2))
    assert sorted(set(np.round(theta, 12))) == pytest.approx([0, math.pi / 4, math.pi / 2])
    wrong = subprocess.run([*command, "--vary", "l=1kg,2"], capture_output=True, text=True)
    assert wrong.returncode == 1 and "l: '1kg' is in kg; expected a value in m" in wrong.stderr
