"""The package's command for built FMUs: inputs, recorded variables, linearizations, templates, and mistakes."""

import html
import re
import subprocess
import zipfile

import numpy as np
import pyarrow.parquet as pq
import pytest

import fmi3
import fmu
import package
from building import build_systems

# Upright, in a straight ride. x points forward, z up; the products of inertia in the benchmark have the opposite sign.
BICYCLE = """\
<system name="Bicycle" description="Whipple's bicycle">
  <parameter name="v" start="5" unit="m/s"/>
  <parameter name="w" start="1.02" unit="m"/> <parameter name="t" start="0.08" unit="m"/> <parameter name="tilt" start="pi/10" unit="rad"/>
  <parameter name="r" start="0.3" unit="m"/> <parameter name="R" start="0.35" unit="m"/>
  <coordinate name="x" velocity="vx" unit="m" velocityStart="v" fixed="true"/>
  <coordinate name="y" velocity="vy" unit="m" fixed="true"/>
  <coordinate name="z" velocity="vz" unit="m" start="r"/>
  <coordinate name="yaw" velocity="yawRate" unit="rad" fixed="true"/>
  <coordinate name="lean" velocity="leanRate" unit="rad" fixed="true"/>
  <coordinate name="pitch" velocity="pitchRate" unit="rad"/>
  <coordinate name="steer" velocity="steerRate" unit="rad" fixed="true"/>
  <coordinate name="rearTurn" velocity="rearRate" unit="rad" velocityStart="v/r"/>
  <coordinate name="frontTurn" velocity="frontRate" unit="rad" velocityStart="v/R"/>
  <input name="torque" unit="N.m"/>
  <force coordinate="steer">torque</force>
  <frame name="rear"> <translate x="x" y="y" z="z"/> <rotate axis="z" angle="yaw"/> <rotate axis="x" angle="lean"/> <rotate axis="y" angle="pitch"/> </frame>
  <frame name="rearWheel" in="rear"> <rotate axis="y" angle="rearTurn"/> </frame>
  <frame name="rearAxle" in="rearWheel"> <rotate axis="x" angle="pi/2"/> </frame>
  <frame name="fork" in="rear"> <translate x="w + t" z="-r"/> <rotate axis="y" angle="-tilt"/> <rotate axis="z" angle="steer"/> <rotate axis="y" angle="tilt"/> </frame>
  <frame name="frontWheel" in="fork"> <translate x="-t" z="R"/> <rotate axis="y" angle="frontTurn"/> </frame>
  <frame name="frontAxle" in="frontWheel"> <rotate axis="x" angle="pi/2"/> </frame>
  <body name="rider" in="rear" x="0.3" z="0.9 - r" mass="85" Ixx="9.2" Iyy="11" Izz="2.8" Ixz="-2.4"/>
  <body name="back" in="rearWheel" mass="2" Ixx="0.0603" Iyy="0.12" Izz="0.0603"/>
  <body name="bar" in="fork" x="0.9 - w - t" z="0.7" mass="4" Ixx="0.05892" Iyy="0.06" Izz="0.00708" Ixz="0.00756"/>
  <body name="front" in="frontWheel" mass="3" Ixx="0.1405" Iyy="0.28" Izz="0.1405"/>
  <joint name="rearContact" type="rolling" from="base" to="rearAxle" radius="r"/>
  <joint name="frontContact" type="rolling" from="base" to="frontAxle" radius="R"/>
  <gravity z="-9.81"/>
  <experiment stopTime="5"/>
</system>
"""


@pytest.fixture(scope="module")
def command(tmp_path_factory):
    folder = package.assemble(tmp_path_factory.mktemp("package"))
    return lambda *words, cwd: package.run(folder, *words, cwd=cwd)


def succeed(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def matrix(name, text):
    """The matrix of the table with this name."""
    rows = re.search(rf"^{name}  .*\n((?:.+\n?)*)", text, re.M)[1].splitlines()
    return np.array([[float(word) for word in row.split()[1:]] for row in rows])


def test_a_cart_to_first_order(command, tmp_path):
    """With a massless rod: (M + m) x'' = F - m l theta'', l theta'' = g theta - x''."""
    text = succeed(command("linearize", fmu.archive("InvertedPendulumCart"), "--at", "theta=0", "--set", "m=2", "l=0.25", cwd=tmp_path))
    M, m, l, g = 1, 2, 0.25, 9.81
    A, B = np.zeros((4, 4)), np.zeros((4, 1))
    A[0, 2] = A[1, 3] = 1
    A[2, 1], A[3, 1], B[2, 0], B[3, 0] = -m * g / M, (M + m) * g / (M * l), 1 / M, -1 / (M * l)
    np.testing.assert_allclose(matrix("A", text), A, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(matrix("B", text), B, rtol=1e-8)
    np.testing.assert_allclose(matrix("C", text)[-1], [1, l, 0, 0])  # xBob


def test_constraints_leave_independent_states(command, tmp_path):
    """A pendulum in x and y at rest at its lowest point has one independent coordinate: x'' = -g/l x."""
    result = command("linearize", fmu.archive("PendulumCartesian"), "--at", "x=0", "y=-1", "vx=0", "vy=0", "--set", "l=1", cwd=tmp_path)
    text = succeed(result)
    np.testing.assert_allclose(matrix("A", text), [[0, 1], [-9.81, 0]], rtol=1e-8, atol=1e-9)
    assert "equilibrium" not in result.stderr and "eigenvalues of A: 0+3.13209j, 0-3.13209j" in text.replace("-0+", "0+").replace("-0-", "0-")


@pytest.fixture(scope="module")
def bicycle():
    build_systems("bicycle", {"Bicycle": BICYCLE})


def test_a_bicycle_rights_itself(bicycle, command, tmp_path):
    """
    Eigenvalues of J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab: Linearized dynamics equations for the balance and steer of a
    bicycle, 2007. Each wheel's contact is one <joint>; the linearization moves coordinates whose start is fixed.
    """
    benchmark = {3: [1.70675605663975 + 2.31582447384325j, -2.63366137253667, -10.3510146724592], 5: [-0.77534188219585 + 4.46486771378823j, -0.32286642900409, -14.0783896927982]}
    for v, expected in benchmark.items():
        text = succeed(command("linearize", fmu.archive("Bicycle"), "--set", f"v={v}", cwd=tmp_path))
        found = np.linalg.eigvals(matrix("A", text))
        found = [value for value in found if abs(value) > 1e-6 and value.imag >= 0]
        np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(expected), rtol=1e-7)


def test_a_bicycle_keeps_its_energy(bicycle, open_fmu):
    """At 4.6 m/s the motion after a push at the handlebar decays, while its energy is conserved."""
    instance = open_fmu("Bicycle").initialize({"v": 4.6})
    instance.set({"torque": 2.0})
    instance.run(0.2, 0.02)
    instance.set({"torque": 0.0})
    energy, leanings = instance.get("totalEnergy"), np.array(instance.run(8.0, 0.02, "lean"))[:, 1]
    assert instance.get("totalEnergy") == pytest.approx(energy, rel=1e-9)
    assert np.max(np.abs(leanings)) > 0.01 and abs(leanings[-1]) < 0.05 * np.max(np.abs(leanings))


def test_points_that_are_no_equilibrium(command, tmp_path):
    assert "the operating point is not an equilibrium: der(omega) = " in command("linearize", fmu.archive("SimplePendulum"), "--at", "theta=1", cwd=tmp_path).stderr


# A block that sticks by friction against a spring, with a pendulum on it.
STUCK = """\
<system name="Stuck"><coordinate name="x" velocity="v" unit="m" start="0.3"/><coordinate name="phi" velocity="omega" unit="rad"/>
  <input name="u" unit="N"/> <particle name="block" mass="2" x="x"/> <particle name="bob" mass="0.5" x="x + 0.4*sin(phi)" y="-0.4*cos(phi)"/>
  <gravity y="-9.81"/> <potential>8*x^2/2</potential> <force coordinate="x">u</force>
  <friction name="rub" velocity="v" force="10"/> <output name="held">rub.force</output>
</system>
"""
# A body in a hollow, which acts as a spring across, with a pendulum on it.
RESTING = """\
<system name="Resting"><coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m"/><coordinate name="phi" velocity="omega" unit="rad"/>
  <particle name="body" mass="2" x="x" y="y"/> <particle name="bob" mass="0.5" x="x + 0.4*sin(phi)" y="y - 0.4*cos(phi)"/>
  <gravity y="-9.81"/> <contact name="ground" gap="y - 0.05*x^2" restitution="0.5"/> <output name="load">ground.force</output>
</system>
"""
# A box on two corners, with a mass on a spring above it.
STANDING = """\
<system name="Standing"><coordinate name="x" velocity="vx" unit="m"/><coordinate name="y" velocity="vy" unit="m" start="0.2"/><coordinate name="phi" velocity="omega" unit="rad"/>
  <coordinate name="s" velocity="r" unit="m" start="-0.7*9.81/50"/> <input name="u" unit="N"/>
  <body name="box" mass="2" inertia="0.02" x="x" y="y" angle="phi"/> <particle name="top" mass="0.7" x="x" y="y + s + 0.4"/>
  <gravity y="-9.81"/> <potential>50*s^2/2</potential> <force coordinate="s">u - 0.3*r*abs(r)</force>
  <contact name="left" gap="y - 0.3*sin(phi) - 0.2*cos(phi)"/> <contact name="right" gap="y + 0.3*sin(phi) - 0.2*cos(phi)"/>
  <friction name="rub" velocity="vx" force="0.5*(left.force + right.force)"/> <output name="load">left.force</output>
</system>
"""


@pytest.fixture(scope="module")
def resting():
    build_systems("resting", {"Stuck": STUCK, "Resting": RESTING, "Standing": STANDING})


@pytest.mark.parametrize("name, constraints, A, B, load", [
    ("Stuck", "rub", [[0, 0, 0], [0, 0, 1], [0, -9.81 / 0.4, 0]], [[0], [0], [0]], [-8, 0.5 * 9.81, 0]),  # x stays, v is 0
    ("Resting", "ground", np.block([[np.zeros((2, 2)), np.eye(2)],
        [np.linalg.solve([[2.5, 0.2], [0.2, 0.08]], -np.diag([2.5 * 9.81 * 0.1, 0.5 * 9.81 * 0.4])), np.zeros((2, 2))]]), None, [0, 0, 0, 0]),
    ("Standing", "left, right, rub", [[0, 0, 0], [0, 0, 1], [0, -50 / 0.7, 0]], [[0], [0], [1 / 0.7]], [0, -25, 0]),
])  # fmt: skip
def test_closed_contacts_and_sticking_frictions_are_constraints(resting, command, tmp_path, name, constraints, A, B, load):
    """Closed contacts and sticking frictions constrain the linearized motion; their forces are outputs, and the result names them."""
    result = command("linearize", fmu.archive(name), cwd=tmp_path)
    text = succeed(result)
    np.testing.assert_allclose(matrix("A", text), A, rtol=1e-8, atol=1e-8)
    if B is not None:
        np.testing.assert_allclose(matrix("B", text), B, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(matrix("C", text)[-1], load, rtol=1e-8, atol=1e-8)
    assert f"contacts that stay closed and frictions that stay stuck: {constraints}\n" in text and result.stderr == ""


@pytest.mark.parametrize("name, text", [("Weightless", RESTING.replace("-9.81", "0")), ("Kink", RESTING.replace("x^2", "abs(x)"))])
def test_where_nothing_presses_and_at_kinks_there_is_no_linearization(command, tmp_path, name, text):
    build_systems("resting", {name: text.replace("Resting", name)})
    result = command("linearize", fmu.archive(name), cwd=tmp_path)
    assert result.returncode == 1 and f"{name} has no linearization at this point: near it, something switches, such as a contact that touches without force; expected a point" in result.stderr


def test_near_a_contact_the_steps_are_small(resting, command, tmp_path):
    """A body 0.1 mm above the ground falls freely."""
    text = succeed(command("linearize", fmu.archive("Resting"), "--at", "y=1e-4", cwd=tmp_path))
    A = np.linalg.solve([[2.5, 0, 0.2], [0, 2.5, 0], [0.2, 0, 0.08]], -np.diag([0, 0, 0.5 * 9.81 * 0.4]))
    A[:, 2] = [0, 0, 0]  # the pendulum falls with the body
    np.testing.assert_allclose(matrix("A", text)[3:, :3], A, rtol=1e-8, atol=1e-8)
    assert "stay closed" not in text


def test_inputs_and_recorded_variables(command, tmp_path):
    """A force F = t on a cart without a pendulum gives x = t^3/6, in either version of FMI."""
    (tmp_path / "F.csv").write_text("time,F\n0,0\n1,1\n")
    for archive in (fmu.archive("InvertedPendulumCart"), fmi3.archive("InvertedPendulumCart")):
        words = ["m=1e-9", "theta=0", "--input", "F.csv", "--stop-time", "1", "--step", "0.25", "--tolerance", "1e-9", "--output", "cart.x", "der(v)"]
        succeed(command("run", archive, *words, cwd=tmp_path))
        rows = np.genfromtxt(tmp_path / "InvertedPendulumCart.csv", delimiter=",", skip_header=1)
        assert (tmp_path / "InvertedPendulumCart.csv").read_text().startswith("time,cart.x,der(v)\n")
        np.testing.assert_allclose(rows[:, 0], [0, 0.25, 0.5, 0.75, 1])
        np.testing.assert_allclose(rows[:, 1], rows[:, 0] ** 3 / 6, atol=1e-7)
        (tmp_path / "InvertedPendulumCart.csv").unlink()


def test_start_values_moved_by_initialization_are_reported(command, tmp_path):
    result = command("run", fmu.archive("FourBar"), "--stop-time", "0.1", cwd=tmp_path)
    assert succeed(result) and "moved to fulfil the constraints: phi from 0.4 to 0.449082" in result.stderr


def test_redundant_constraints_are_named(command, tmp_path):
    """Bricard's loop of six hinges moves, although its constraints leave no freedom by their number."""
    result = command("run", fmu.archive("Bricard"), "--stop-time", "0.1", cwd=tmp_path)
    assert succeed(result) and result.stderr.count("is redundant; the forces are those of least norm") == 1


@pytest.mark.parametrize("template", ["pendulum", "cart", "robot", "bounce", "linkage"])
def test_templates(template, command, tmp_path):
    succeed(command("new", "Mine", "--template", template, cwd=tmp_path))
    result = command("check", "Mine.xml", cwd=tmp_path)
    assert succeed(result).startswith("Mine: ") and result.stderr == ""


def test_options_for_robots(command, tmp_path):
    """The base of a cube moves freely above a ground: 14 states, and the parameters of the contacts."""
    (tmp_path / "cube.urdf").write_text("""<robot name="cube"><link name="cube"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><sphere radius="1"/></geometry></collision></link></robot>""")
    (tmp_path / "cube.xml").write_text('<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody><keyframe><key name="up" qpos="0 0 1 1 0 0 0"/></keyframe></mujoco>')
    result = command("check", "cube.urdf", cwd=tmp_path)
    assert result.returncode == 1 and 'expected one of another type than fixed, or base="floating" in an <include>, or --base floating on the command line' in result.stderr
    assert succeed(command("check", "cube.urdf", "--base", "floating", cwd=tmp_path)).startswith("cube: 14 states, 0 inputs, ")
    for ground in (["--ground"], ["--feet", "cube"]):
        assert ", 4 parameters" in succeed(command("check", "cube.urdf", "--base", "floating", "--self", *ground, "--limits", "stops", "--friction", "sticks", "--effort", "limited", cwd=tmp_path))
    assert "there is no link 'cub' for the ground; did you mean 'cube'?" in command("check", "cube.urdf", "--base", "floating", "--feet", "cub", cwd=tmp_path).stderr
    succeed(command("check", "cube.xml", "--keyframe", "up", cwd=tmp_path))
    assert "there is no <key> 'down'; expected one of up" in command("check", "cube.xml", "--keyframe", "down", cwd=tmp_path).stderr
    assert "options such as base and ground are for robots" in command("check", fmu.ROOT / "fmu" / "SimplePendulum", "--base", "floating", cwd=tmp_path).stderr
    assert "is an FMU; expected the file from which it was made" in command("check", fmu.archive("SimplePendulum"), cwd=tmp_path).stderr
    assert "is an FMU; expected the file of a robot for base=floating" in command("run", fmu.archive("SimplePendulum"), "--base", "floating", cwd=tmp_path).stderr


def test_a_sweep(command, tmp_path):
    """The values of a linear pendulum are theta = theta0 cos(sqrt(g/l) t)."""
    words = ["--vary", "l=0.5,2", "--vary", "theta0=0.1:0.3:3", "--stop-time", "2", "--output", "runs.parquet"]
    assert "6 runs, 0 failed" in succeed(command("sweep", fmu.archive("SimplePendulumLinear"), *words, cwd=tmp_path))
    runs = pq.read_table(tmp_path / "runs.parquet").to_pydict()
    expected = [start * np.cos(2 * np.sqrt(9.81 / l)) for l in (0.5, 2) for start in (0.1, 0.2, 0.3)]
    np.testing.assert_allclose(runs["theta_end"], expected, rtol=1e-9)


@pytest.mark.long
def test_a_sweep_in_lanes(command, tmp_path):
    """A pendulum released at 90 degrees returns after a period of 4 K(1/2) sqrt(l/g); one of length 0 fails."""
    period = 4 * 1.8540746773013719 / np.sqrt(9.81)
    words = ["--vary", f"theta={np.pi / 2!r}", "--vary", "l=0:2:2001", "--stop-time", repr(float(period)), "--output", "runs.parquet"]
    assert "2001 runs, 1 failed" in succeed(command("sweep", fmu.archive("SimplePendulum"), *words, cwd=tmp_path))
    runs = pq.read_table(tmp_path / "runs.parquet").to_pydict()
    assert "mass matrix is singular" in runs["problem"][0]
    assert runs["l"][1000] == 1 and runs["theta_end"][1000] == pytest.approx(np.pi / 2, abs=1e-9)
    assert len(set(runs["runTime"][1:])) < 10  # runs in lanes have equal shares of the time


FUNCTIONS = """
import lagrange_fmu, numpy, pyarrow.parquet
def columns(**words):
    table = pyarrow.parquet.read_table(lagrange_fmu.sweep(FMU, stop_time=2, **words)).to_pydict()
    return table["l"], table["theta"], table["theta_end"]
l, start, end = map(numpy.array, columns(vary={"l": (0.5, 2, 2), "theta0": numpy.linspace(0.1, 0.3, 3)}, output="runs.parquet"))
assert l.tolist() == [0.5] * 3 + [2] * 3
numpy.testing.assert_allclose(end, start * numpy.cos(2 * numpy.sqrt(9.81 / l)), rtol=1e-9)
l, start, end = map(numpy.array, columns(vary={"l": (0.5, 2), "theta": [0.1, 0.2]}, random=50, seed=3))
assert len(l) == 50 and 0.5 <= min(l) < max(l) <= 2 and set(start) == {0.1, 0.2}
numpy.testing.assert_allclose(end, start * numpy.cos(2 * numpy.sqrt(9.81 / l)), rtol=1e-9, atol=1e-12)
print(lagrange_fmu.live(FMU), lagrange_fmu.live(FMU, "here.html"))
print("<contact" in lagrange_fmu.words("restitution"), len(lagrange_fmu.words()) > 5 * len(lagrange_fmu.words("restitution")))
print(set(lagrange_fmu.__all__) <= set(dir(lagrange_fmu)), lagrange_fmu.build.__name__, lagrange_fmu.__version__)
"""


@pytest.mark.long
def test_commands_as_functions(tmp_path):
    """A sweep of a linear pendulum, theta = theta0 cos(sqrt(g/l) t), over a grid and a sample; a page; the reference."""
    folder = package.assemble(tmp_path / "package")
    script = FUNCTIONS.replace("FMU", repr(str(fmu.archive("SimplePendulumLinear"))))
    printed = succeed(package.python(folder, "-c", script, cwd=tmp_path)).splitlines()
    assert printed[-3:] == ["SimplePendulumLinear.html here.html", "True True", "True build 1"]
    assert (tmp_path / "here.html").read_bytes() == (tmp_path / "SimplePendulumLinear.html").read_bytes()
    assert (tmp_path / "runs.parquet").exists() and (tmp_path / "SimplePendulumLinear-sweep.parquet").exists()


SLOW_LOADING = """
import os, time, fmpy.fmi1, lagrange_fmu
from pathlib import Path
load = fmpy.fmi1.cdll.LoadLibrary
def slow_load(path):
    time.sleep(0.3)
    return load(path)
fmpy.fmi1.cdll.LoadLibrary = slow_load
before = os.getcwd()
lagrange_fmu.sweep(FMU, {"l": (0.5, 2, 1000)}, stop_time=0.1, output="runs.parquet")
print(os.getcwd() == before, Path("runs.parquet").exists())
"""


@pytest.mark.long
def test_a_sweep_writes_while_a_thread_loads(tmp_path):
    """FMPy changes the working directory while it loads a library, which here takes longer than the runs of the other thread."""
    folder = package.assemble(tmp_path / "package")
    script = SLOW_LOADING.replace("FMU", repr(str(fmu.archive("SimplePendulumLinear"))))
    assert succeed(package.python(folder, "-c", script, cwd=tmp_path)).endswith("\nTrue True\n")


BROKEN = """
import os, lagrange_fmu
before = os.getcwd()
calls = [lambda: lagrange_fmu.simulate(FMU, stop_time=1), lambda: lagrange_fmu.simulate(FMU, stop_time=1, fmi_type="ModelExchange"),
         lambda: lagrange_fmu.start(FMU), lambda: lagrange_fmu.linearize(FMU)]
for call in calls:
    try:
        call()
    except Exception as problem:
        print("load" in str(problem) or repr(problem), os.getcwd() == before)
"""


def test_an_fmu_that_cannot_be_loaded(tmp_path):
    """FMPy would leave the process in the folder of the library."""
    folder, broken = package.assemble(tmp_path / "package"), tmp_path / "Broken.fmu"
    with zipfile.ZipFile(fmu.archive("SimplePendulum")) as archive, zipfile.ZipFile(broken, "w") as copy:
        for name in archive.namelist():
            copy.writestr(name, b"no library" if name.endswith(".so") else archive.read(name))
    printed = succeed(package.python(folder, "-c", BROKEN.replace("FMU", repr(str(broken))), cwd=tmp_path))
    assert printed == "True True\n" * 4


INTERRUPTED = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # even if the shell of the tests ignores it, as one in the background does
class Interrupt:
    def find_spec(self, name, *where):
        if name == MODULE:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupt())
from lagrange_fmu.__main__ import main
main()
"""


@pytest.mark.parametrize("module", ["lagrange_fmu.calls", "lagrange_fmu.variables", "lagrange_fmu.__main__"])
def test_an_interrupt_while_the_package_is_imported(module, tmp_path):
    """Python imports the package before the module of the command."""
    folder = package.assemble(tmp_path / "package")
    (folder / "sitecustomize.py").write_text(INTERRUPTED.partition("from lagrange_fmu")[0].replace("MODULE", repr(module)))
    result = package.python(folder, "-m", "lagrange_fmu", "run", fmu.archive("SimplePendulum"), cwd=tmp_path)
    assert result.returncode == 130 and result.stderr == ""


@pytest.mark.parametrize("module", ["lagrange_fmu.command", "shtab", "lagrange_fmu.commands.words", "lagrange_fmu.running", "fmpy", "numpy"])
def test_an_interrupt_while_modules_are_imported(module, tmp_path):
    folder = package.assemble(tmp_path / "package")
    result = package.python(folder, "-c", INTERRUPTED.replace("MODULE", repr(module)), "run", fmu.archive("SimplePendulum"), cwd=tmp_path)
    assert result.returncode == 130 and "Traceback" not in result.stderr and list(tmp_path.glob("*.csv")) == []


def test_completion(command, tmp_path):
    """The completion script for bash completes commands, options and files."""
    (tmp_path / "completion").write_text(succeed(command("--print-completion", "bash", cwd=tmp_path)))
    (tmp_path / "arm.urdf").touch()
    for typed, completed in (("linea", "linearize"), ("run --stop", "--stop-time"), ("run ar", "arm.urdf")):
        script = f"source completion; COMP_WORDS=(lagrange-fmu {typed}); COMP_CWORD=${{#COMP_WORDS[@]}}; ((COMP_CWORD--)); _shtab_lagrange_fmu; echo ${{COMPREPLY[@]}}"
        assert subprocess.run(["bash", "-c", script], cwd=tmp_path, capture_output=True, text=True).stdout.split() == [completed]


def test_no_command_shows_the_help(command, tmp_path):
    assert "linearize" in succeed(command(cwd=tmp_path))


def test_reference(command, tmp_path):
    text = succeed(command("words", "restitution", cwd=tmp_path))
    assert "<contact" in text and len(text) < len(succeed(command("words", cwd=tmp_path))) / 5


@pytest.mark.parametrize("words, message", [
    (["run", "text.fmu"], "text.fmu is not an FMU, which is a zip archive"),
    (["run", "none.fmu"], "there is no file none.fmu; expected an FMU"),
    (["linearize", "text.fmu"], "text.fmu is not an FMU, which is a zip archive"),
    (["run", fmu.archive("SimplePendulum"), "--output", "q"], "'q' is not a variable of SimplePendulum; these are: time, "),
    (["run", fmu.archive("InvertedPendulumCart"), "--input", "q.csv"], "'q' is not an input of InvertedPendulumCart; these are: F"),
    (["run", fmu.archive("InvertedPendulumCart"), "--input", "bad.csv"], "bad.csv:3: 'a' is not a number"),
    (["run", fmu.archive("InvertedPendulumCart"), "--input", "back.csv"], "expected lines of finite numbers, whose times do not decrease"),
    (["run", fmu.archive("InvertedPendulumCart"), "--input", "text.fmu"], "the first line is 'no archive'; expected time and names of variables"),
    (["run", fmu.archive("SimplePendulum"), "--solver", "bdf"], "is an FMU, whose solver"),
    (["run", fmu.archive("SimplePendulum"), "--step", "-1"], "'-1' is not a positive number"),
    (["linearize", fmu.archive("SimplePendulum"), "--at", "q=1"], "'q' is not a variable of SimplePendulum"),
    (["linearize", fmi3.archive("SimplePendulum")], "has no directional derivatives of FMI 2.0; expected a system"),
    (["sweep", "text.fmu", "--vary", "l=1:2:3"], "text.fmu is not an FMU, which is a zip archive"),
    (["sweep", fmu.archive("SimplePendulum"), "--vary", "l=1:2"], "'l' has no COUNT; expected l=FROM:TO:COUNT"),
    (["sweep", fmi3.archive("SimplePendulum"), "--vary", "l=1,2"], "SimplePendulum.fmu is of FMI 3.0; expected one of FMI 2.0"),
    (["rnu", "x.fmu"], "invalid choice: 'rnu'; did you mean 'run'?"),
    (["run", "Near.fmu", "--stpo-time", "1"], "unrecognized arguments: --stpo-time 1; did you mean '--stop-time'?"),
    (["live", "Near.fmu", "--folder", "x"], "unrecognized arguments: --folder x; expected one of these: "),
    (["run", "Twni.fmu"], "there is no file Twni.fmu; did you mean 'Twin.fmu'?"),
    (["run", "Twni.xml"], "there is no file Twni.xml; did you mean 'Twin.xml'?"),
    (["run", "near.fum"], "there is no file near.fum; did you mean 'Near.fmu'?"),
    (["run", fmu.archive("SimplePendulum"), "thetta=1"], "'thetta' is not a variable of SimplePendulum; did you mean 'theta'?"),
    (["run", fmu.archive("SimplePendulum"), "--output", "totalenergy"], "'totalenergy' is not a variable of SimplePendulum; did you mean 'totalEnergy'?"),
    (["run", fmu.archive("InvertedPendulumCart"), "--input", "backk.csv"], "there is no file backk.csv; did you mean 'back.csv'?"),
    (["words", "restitutoin"], "the reference says nothing about 'restitutoin'; did you mean 'restitution'?"),
    (["new", "A", "--template", "robott"], "invalid choice: 'robott'; did you mean 'robot'?"),
    (["words", "qqq"], "the reference says nothing about 'qqq'"),
])  # fmt: skip
def test_mistakes(words, message, command, tmp_path):
    for name, text in (("text.fmu", "no archive"), ("Near.fmu", "no archive"), ("Twin.fmu", "no archive"), ("Twin.xml", "no system"), ("q.csv", "time,q\n0,1\n"), ("bad.csv", "time,F\n0,1\n1,a\n"), ("back.csv", "time,F\n1,1\n0,1\n")):
        (tmp_path / name).write_text(text)
    result = command(*words, cwd=tmp_path)
    assert result.returncode in (1, 2) and message in result.stderr and "Traceback" not in result.stderr, result.stderr


FROM_SYMPY = """
import sympy
from sympy.physics.mechanics import KanesMethod, LagrangesMethod, ReferenceFrame, dynamicsymbols
import lagrange_fmu
x, u = dynamicsymbols("x u")
k, m, d = sympy.symbols("k m d")
stop = sympy.Piecewise((k * (x - d) ** 2, x > d), (k * (x + d) ** 2, sympy.And(x < -d, k > 0)), (0, True))
print(lagrange_fmu.check(lagrange_fmu.from_sympy(LagrangesMethod(m * x.diff() ** 2 / 2 - stop, [x]), "Stops.xml", {k: 9, m: 1, d: 2})))
try:
    lagrange_fmu.from_sympy(KanesMethod(ReferenceFrame("N"), q_ind=[x], u_ind=[u], kd_eqs=[u - x.diff()]), "Kane.xml", {})
except lagrange_fmu.Problem as problem:
    print(problem)
"""


def test_pieces_and_kane_of_sympy(tmp_path):
    result = package.python(package.assemble(tmp_path / "package"), "-c", FROM_SYMPY, cwd=tmp_path)
    assert "Stops: 2 states" in succeed(result) and "a KanesMethod has no energies to write; expected a LagrangesMethod" in result.stdout
    potential = re.search("<potential>(.*)</potential>", (tmp_path / "Stops.xml").read_text())[1]
    potential = re.sub(r"\bif\(", "pick(", html.unescape(potential).replace("^", "**"))
    for x, energy in ((3, 9), (1, 0), (-1, 0), (-4, 36)):
        assert eval(potential, {"pick": lambda condition, value, other: value if condition else other}, {"x": x, "k": 9, "d": 2}) == energy


def test_plots_pages_and_tables_of_a_result(tmp_path):
    """Figure, page and table of a motion in Python, after the FMU has been deleted; a picture and a page in Jupyter."""
    folder = package.assemble(tmp_path / "package")
    (tmp_path / "Swing.fmu").write_bytes(fmu.archive("SimplePendulum").read_bytes())
    script = """
import os, lagrange_fmu
motion = lagrange_fmu.simulate("Swing.fmu", {"theta": 1}, stop_time=0.5)
motor = lagrange_fmu.simulate(MOTOR, stop_time=0.5)
os.remove("Swing.fmu")
print(motion.animate().save("swing.html").name, len(motion.plot().axes), motion[10:20].shape, motion["theta"][0])
assert motion._repr_png_().startswith(b"\\x89PNG") and motion.plot()._repr_png_().startswith(b"\\x89PNG")
assert motion.animate()._repr_html_().startswith("<iframe srcdoc=\\"&lt;!doctype html&gt;")
try:
    motor.animate()
except lagrange_fmu.Problem as problem:
    print(problem)
""".replace("MOTOR", repr(str(fmu.archive("SpringDamper"))))
    (tmp_path / "script.py").write_text(script)
    printed = succeed(package.python(folder, "script.py", cwd=tmp_path)).splitlines()
    assert printed == ["swing.html 2 (10,) 1.0", "SpringDamper has no particles, bodies, frames or points to draw; expected some in the system"]
    page = (tmp_path / "swing.html").read_text()
    assert '"recording":{' in page and re.search(r'"start":{[^}]*"theta":1.0[,}]', page)


IN_SENTENCES = """
import sys, lagrange_fmu
FMU = PENDULUM
blocked = ("sympy", "scipy", "scipy.integrate", "pandas", "distributed", "pyarrow")
sys.modules |= dict.fromkeys(blocked)
for call in (lambda: lagrange_fmu.from_sympy(None, "A.xml", {}), lambda: lagrange_fmu.fit(FMU, "data.csv", "l"), lambda: lagrange_fmu.simulate(FMU, stop_time=0.1).to_pandas(),
             lambda: lagrange_fmu.sweep(FMU, {"l": [1, 2]}), lambda: lagrange_fmu.sensitivities(FMU, "theta", "l", [1]),
             lambda: lagrange_fmu.gradient(FMU, "theta", "l", 1)):
    try:
        call()
    except lagrange_fmu.Problem as problem:
        print(problem)
for name in set(blocked) - {"distributed"}:
    del sys.modules[name]
calls = [
    lambda: lagrange_fmu.simulate(FMU, output="totalEnergi"),
    lambda: lagrange_fmu.simulate(FMU, start={"theta": 1}),
    lambda: lagrange_fmu.simulate(FMU, stop_tmie=1),
    lambda: lagrange_fmu.simulate(FMU, [1.0]),
    lambda: lagrange_fmu.simulate(FMU, {"theta": "much"}),
    lambda: lagrange_fmu.simulate(FMU, input=3),
    lambda: lagrange_fmu.simulate(FMU, fmi_type="Cosimulation"),
    lambda: lagrange_fmu.simulate(FMU, stop_time=-1),
    lambda: lagrange_fmu.linearize(FMU, [1]),
    lambda: lagrange_fmu.fit(FMU, "data.csv", vary=[1]),
    lambda: lagrange_fmu.sweep(FMU, {"l": [1, 2]}, scheduler="tcp://127.0.0.1:1"),
    lambda: lagrange_fmu.sweep(FMU, ["l"]),
    lambda: lagrange_fmu.sweep(FMU, {"l": 2}),
    lambda: lagrange_fmu.sweep(FMU, {"l": "1:2:3"}),
    lambda: lagrange_fmu.sweep(FMU, {"l": (1, 2)}),
    lambda: lagrange_fmu.sweep(FMU, {"q": (1, 2, 3)}),
    lambda: lagrange_fmu.sweep(FMU, {"l": (1, 2)}, random=-1),
    lambda: lagrange_fmu.sweep(FMU, {"l": (1, 2, 3)}, seed=-1),
    lambda: lagrange_fmu.sweep(FMU, {"l": (1, 2, 3)}, stop_time=[2]),
    lambda: lagrange_fmu.live(FMU, edit=True),
    lambda: lagrange_fmu.live("pendulum.xml", edit=True, start_values={"l": 1}),
    lambda: lagrange_fmu.live(FMU, start_values={"L": 1}),
    lambda: lagrange_fmu.words("restitutoin"),
    lambda: lagrange_fmu.words("restitutio"),
    lambda: lagrange_fmu.words(3),
    lambda: lagrange_fmu.simulate(None),
    lambda: lagrange_fmu.check(None),
    lambda: lagrange_fmu.sweep(FMU, {"l": (1, 2, 3)}, randm=3),
    lambda: lagrange_fmu.sweep(FMU),
    lambda: lagrange_fmu.build("pendulum.xml", plattforms=["linux64"]),
    lambda: lagrange_fmu.simulate(FMU, input=lambda: 3),
    lambda: lagrange_fmu.simulate(FMU, stop_time="3 kg"),
    lambda: lagrange_fmu.simulate(FMU, step=[0.1]),
    lambda: lagrange_fmu.simulate(FMU, tolerance="small"),
    lambda: lagrange_fmu.simulate(FMU, hold="yes"),
    lambda: lagrange_fmu.simulate(FMU, fmi_type=3),
    lambda: lagrange_fmu.simulate(FMU, input="pendulm.csv"),
    lambda: lagrange_fmu.simulate(FMU, input={"time": [[0, 1], [1, 2]], "F": [1, 2]}),
    lambda: lagrange_fmu.simulate(FMU, input={"time": [0, 1], "F": [[1], [1, 2]]}),
    lambda: lagrange_fmu.run(FMU, folder=3),
    lambda: lagrange_fmu.new(3),
    lambda: lagrange_fmu.sensitivities(FMU, "theta", "l", [[0, 1], [2, 3]]),
    lambda: len(lagrange_fmu.simulate(FMU, stop_time="100 ms", step="50ms")),
    lambda: lagrange_fmu.simulate(FMU, stop_time=0.1)["omgea"],
    lambda: lagrange_fmu.linearize(FMU).bode(frequency=1),
]
for call in calls:
    try:
        print(call())
    except lagrange_fmu.Problem as problem:
        print(problem)
print(lagrange_fmu.simulate(FMU, output="totalEnergy", stop_time=0.1).dtype.names)
"""
SENTENCES = [
    "sympy is not installed; it comes with pip install sympy",
    "derivatives of motions and fits need SciPy; install it with",
    "pandas is not installed; it comes with pip install pandas",
    "pyarrow is not installed; it comes with pip install pyarrow",
    "derivatives of motions and fits need SciPy; install it with",
    "derivatives of motions and fits need SciPy; install it with",
    "'totalEnergi' is not a variable of SimplePendulum; did you mean 'totalEnergy'?",
    "'start' is not an option of this simulation; expected one of these: start_values, output, input, ",
    "'stop_tmie' is not an option of this simulation; did you mean 'stop_time'?",
    "start_values is a list; expected a dict of numbers by name",
    "theta: the value: unknown name 'much'; expected a number, perhaps with its unit",
    "the input is a int; expected the path of a CSV",
    "the type 'Cosimulation' is not known; did you mean 'CoSimulation'?",
    "the simulation is from 0 s to -1 s by ",
    "at is a list; expected a dict of numbers by name",
    "vary has 1; expected names of variables",
    "distributed is not installed; a sweep on a Dask cluster needs it: pip install distributed",
    "vary is ['l']; expected a dict of ranges or values by name, ",
    "vary has 2 for 'l'; expected (FROM, TO, COUNT), or a list of finite numbers",
    "vary has '1:2:3' for 'l'; expected (FROM, TO, COUNT), or a list of finite numbers",
    "vary has (1, 2) for 'l'; expected (FROM, TO, COUNT), (FROM, TO) with random=RUNS, ",
    "'q' has no start value in SimplePendulum; these have one: ",
    "random is -1; expected a whole number of runs",
    "seed is -1; expected a whole number that is not negative",
    "stop_time is [2]; expected a number of seconds, or a text such as '3s'",
    f"{fmu.archive('SimplePendulum')} is an FMU, which cannot be edited; expected the system.xml of which it was made",
    "an editable page of pendulum.xml starts with the values in the file; write l there as start=\"...\", or leave out --edit (edit=True)",
    "'L' is not a variable of SimplePendulum; did you mean 'l'?",
    "the reference says nothing about 'restitutoin'; did you mean 'restitution'?",
    "the reference says nothing about 'restitutio'; did you mean 'restitution'?",
    "word is 3; expected a text",
    "the system is None; expected the path of a system or of an FMU",
    "the system is None; expected the path of a system or of an FMU",
    "'randm' is not an argument of sweep; did you mean 'random'?",
    "sweep: missing a required argument: 'vary'; expected sweep(system, vary, *, random=None, ",
    "'plattforms' is not an argument of build; did you mean 'platforms'?",
    "the function of the input cannot be called with the time alone; expected one such as lambda t: 2*t, ",
    "stop_time: ",
    "step is [0.1]; expected a number of seconds, or a text such as '3s'",
    "tolerance is 'small'; expected a number",
    "hold is 'yes'; expected True or False",
    "fmi_type is 3; expected a text",
    "there is no file pendulm.csv; ",
    "'time' of the input has the shape (2, 2); expected one time for each row",
    "'F' of the input has rows of different lengths; expected a number for each time",
    "folder is 3; expected a path",
    "name is 3; expected a text",
    "the times have the shape (2, 2); expected a list of numbers, in s",
    "3",
    "'omgea' is not recorded; did you mean 'omega'?",
    "'frequency' is not an argument of bode; did you mean 'frequencies'?",
    "('time', 'totalEnergy')",
]


def test_mistakes_in_python(tmp_path):
    """Each mistake raises a Problem with its remedy, without an internal traceback."""
    (tmp_path / "script.py").write_text(IN_SENTENCES.replace("PENDULUM", repr(str(fmu.archive("SimplePendulum")))))
    printed = succeed(package.python(package.assemble(tmp_path / "package"), "script.py", cwd=tmp_path)).splitlines()
    assert len(printed) == len(SENTENCES)
    for line, beginning in zip(printed, SENTENCES):
        assert line.startswith(beginning), line


NAMES = """
import sympy
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols
import lagrange_fmu
x, (k, m) = dynamicsymbols("x"), sympy.symbols("k m")
method = LagrangesMethod(m * x.diff() ** 2 / 2 - k * x**2 / 2, [x])
print(lagrange_fmu.from_sympy(method, "Named.xml", {"k": 9, "m": 1}, start={"x": 2, "v": 3}, speeds=["v"], units={"x": "m"}).read_text())
for words in ({"speed": ["v"]}, {"start": {"y": 1}}, {"speeds": [1]}, {"start": [1]}):
    try:
        lagrange_fmu.from_sympy(method, "Named.xml", {k: 9, m: 1}, **words)
    except lagrange_fmu.Problem as problem:
        print(problem)
"""


def test_names_for_symbols_of_sympy(tmp_path):
    printed = succeed(package.python(package.assemble(tmp_path / "package"), "-c", NAMES, cwd=tmp_path))
    assert '<coordinate name="x" velocity="v" start="2.0" velocityStart="3.0" unit="m" />' in printed
    for message in ("'speed' is not an option of from_sympy; did you mean 'speeds'?", "y is not a coordinate, velocity, state or input of this LagrangesMethod; ", "1 is not a speed", "are a list; expected a dict"):
        assert message in printed
