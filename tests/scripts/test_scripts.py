"""Scripts: wrong arguments, folders outside the clone, interrupted set-up, and two processes at once."""

import fcntl
import os
import re
import shutil
import subprocess
import sys

import pytest

import fmu
from fmu import ROOT

SIMULATE = [sys.executable, str(ROOT / "scripts" / "commands" / "run.py")]


@pytest.mark.parametrize("word, message", [
    ("der(theta)=1", "'der(theta)' of SimplePendulum cannot be set; these can be: theta, omega, m, l, g"),
    ("solverSteps=3", "'solverSteps' of SimplePendulum cannot be set"),
    ("totalEnergy=3", "'totalEnergy' of SimplePendulum cannot be set"),
    ("q=3", "'q' is not a variable of SimplePendulum; these can be: theta"),
])  # fmt: skip
def test_settings_that_are_wrong(word, message, tmp_path):
    result = subprocess.run([*SIMULATE, fmu.archive("SimplePendulum"), word], capture_output=True, text=True, cwd=tmp_path)
    assert result.returncode == 1 and message in result.stderr and "Traceback" not in result.stderr
    assert list(tmp_path.iterdir()) == []


def script(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("#!/usr/bin/env bash\n" + text)
    path.chmod(0o755)


# Fake Python that logs its arguments, and creates environments with a working pip.
PYTHON = """
echo "python $*" >>"$LOG"
if [ "$1 $2" = "-m venv" ]; then
  echo made >"$SIGNAL"
  read <"$SIGNAL"
  mkdir -p "$3/bin"
  cp "$0" "$3/bin/python"
fi
"""


class Clone:
    """The scripts with fake Python and CMake that log their calls."""

    def __init__(self, folder):
        self.folder, self.log = folder, folder / "log"
        shutil.copytree(ROOT / "scripts", folder / "scripts")
        for name in ("fmu", "build"):
            (folder / name).mkdir()
        script(folder / "bin" / "python3", PYTHON)
        script(folder / "bin" / "cmake", 'echo "cmake $*" >>"$LOG"\n')
        script(folder / "bin" / "dpkg-query", """printf "%s install ok installed\\n" "${@:4}"\n""")
        self.signal = folder / "signal"
        os.mkfifo(self.signal)
        path = f"{folder / 'bin'}:{os.environ['PATH']}"
        self.environment = {**os.environ, "PATH": path, "LOG": str(self.log), "SIGNAL": str(self.signal)}

    def start(self, *words, cwd=None):
        words = [self.folder / "scripts" / words[0], *words[1:]]
        return subprocess.Popen(words, env=self.environment, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run(self, *words, cwd=None):
        process = self.start(*words, cwd=cwd)
        output, errors = process.communicate(timeout=60)
        return process.returncode, output + errors

    def calls(self):
        return self.log.read_text().splitlines() if self.log.exists() else []

    def let_python_go(self):
        """Wait until the environment is being made, and let that continue."""
        self.signal.read_text()
        self.signal.write_text("on\n")


@pytest.fixture
def clone(tmp_path):
    return Clone(tmp_path / "a clone")


def made(clone):
    return sum("-m venv" in call for call in clone.calls())


def test_a_setup_that_was_stopped_is_made_good(clone):
    """Killed while the environment is made: the next set-up makes it anew, and the one after finds it complete."""
    stopped = clone.start("setup", "run")
    clone.signal.read_text()
    stopped.kill()
    clone.signal.write_text("on\n")
    stopped.communicate()
    shutil.rmtree(clone.folder / "build" / "venv")
    script(clone.folder / "build" / "venv" / "bin" / "python", 'echo "No module named pip" >&2\nexit 1\n')
    next_one = clone.start("setup", "run")
    clone.let_python_go()
    output, errors = next_one.communicate(timeout=60)
    assert next_one.returncode == 0, output + errors
    assert made(clone) == 2 and "pip install" in clone.calls()[-1]
    before = clone.calls()
    assert clone.run("setup", "run")[0] == 0
    assert [call for call in clone.calls()[len(before) :] if "venv" in call or "pip" in call] == ["python -c import ensurepip, venv"]


def test_two_setups_at_once(clone):
    first = clone.start("setup", "run")
    clone.signal.read_text()
    second = clone.start("setup", "run")
    assert "scripts/setup: waiting for another one" in second.stderr.readline()
    clone.signal.write_text("on\n")
    assert first.wait(timeout=60) == 0 and second.wait(timeout=60) == 0
    assert made(clone) == 1


def test_a_build_waits_for_another_in_its_folder(clone):
    (clone.folder / "build" / "one").mkdir()
    with open(clone.folder / "build" / "one" / "build.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        waiting = clone.start("build", "build/one")
        assert "scripts/build: waiting for another one, which works in build/one" in waiting.stderr.readline()
        assert clone.run("build", "build/two")[0] == 0
        assert clone.calls() and not any("build/one" in call for call in clone.calls())
    assert waiting.wait(timeout=60) == 0
    assert any("--build build/one" in call for call in clone.calls())


def test_a_sweep_builds_its_own_fmu_alone(clone):
    """A sweep builds one FMU without configuring again; checking all FMUs takes longer than a small sweep."""
    stamp = "".join(path.read_text() for path in sorted((ROOT / "scripts" / "requirements").glob("*.txt")))
    script(clone.folder / "build" / "venv" / "bin" / "python", 'echo "python $*" >>"$LOG"\n')
    (clone.folder / "build" / "venv" / "installed-sweep").write_text(stamp)
    for name in ("One", "Other"):
        (clone.folder / "fmu" / name).mkdir()
        (clone.folder / "fmu" / name / "system.xml").touch()
    (clone.folder / "build" / "Makefile").touch()
    assert clone.run("sweep", "--stop", "1", "One", "--vary", "l=1,2")[0] == 0
    (call,) = [call for call in clone.calls() if call.startswith("cmake")]
    assert re.fullmatch("cmake --build build --parallel [0-9]+ --target sweep_runs fmu_One", call)


@pytest.fixture
def ready(clone):
    """A clone after set-up."""
    stamp = "".join(path.read_text() for path in sorted((ROOT / "scripts" / "requirements").glob("*.txt")))
    script(clone.folder / "build" / "venv" / "bin" / "python", 'echo "python $*" >>"$LOG"\n')
    (clone.folder / "build" / "venv" / "installed-run").write_text(stamp)
    return clone


def add(folder):
    folder.mkdir(parents=True)
    (folder / "system.xml").write_text("<system/>")
    return folder


@pytest.mark.parametrize("word", ["own/Bead", "own/Bead/", "own/Bead/system.xml", "own", "./own/../own"])
def test_a_folder_of_ones_own(word, ready, tmp_path):
    """The folder is relative to the current one, and only its FMU is built."""
    bead = add(tmp_path / "else where" / "own" / "Bead")
    status, text = ready.run("run", word, "theta=1", cwd=tmp_path / "else where")
    assert status == 0, text
    assert any(f"-DSYSTEMS={bead}" in call for call in ready.calls())
    assert ready.calls()[-1] == "python scripts/commands/run.py build/own/fmu/Bead.fmu theta=1"


def test_a_robot(ready, tmp_path):
    """CMake writes the name of the FMU, which lagc takes from the content of the file."""
    (tmp_path / "arm.urdf").write_text('<robot name="arm 6"/>')
    (ready.folder / "build" / "own").mkdir()
    (ready.folder / "build" / "own" / "system_names").write_text("arm_6\n")
    status, text = ready.run("run", "arm.urdf", "elbow=1", cwd=tmp_path)
    assert status == 0, text
    assert any(f"-DSYSTEMS={tmp_path}/arm.urdf" in call for call in ready.calls())
    assert ready.calls()[-1] == "python scripts/commands/run.py build/own/fmu/arm_6.fmu elbow=1"


def test_options_of_a_run(ready):
    add(ready.folder / "fmu" / "Pendulum")
    status, text = ready.run("run", "Pendulum", "theta=1", "--stop-time", "2", "--no-events", cwd=ready.folder)
    assert status == 0, text
    assert ready.calls()[-1] == "python scripts/commands/run.py build/fmu/Pendulum.fmu theta=1 --stop-time 2 --no-events"


def test_an_unknown_option_of_a_run(ready):
    """It is found before anything is built."""
    status, text = ready.run("run", "Pendulum", "--stoptime=2", cwd=ready.folder)
    assert status == 2 and "scripts/run: there is no option --stoptime; see scripts/run --help" in text and ready.calls() == []


def test_a_file_of_any_name(tmp_path):
    """The FMU has the name that the system has in its file."""
    (tmp_path / "draft 3.xml").write_text('<!-- mine --><system\n description="a mass" name="Sled"><coordinate name="x" velocity="v"/><kinetic>v^2/2</kinetic></system>')
    result = subprocess.run([ROOT / "scripts" / "build", tmp_path / "built", f"-DSYSTEMS={tmp_path / 'draft 3.xml'}", f"-DTOOLS={fmu.BUILD}"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert fmu.fmpy.read_model_description(tmp_path / "built" / "fmu" / "Sled.fmu").modelName == "Sled"
    (tmp_path / "draft 3.xml").write_text("<sled/>")
    result = subprocess.run([ROOT / "scripts" / "build", tmp_path / "built", f"-DSYSTEMS={tmp_path / 'draft 3.xml'}", f"-DTOOLS={fmu.BUILD}"], capture_output=True, text=True)
    assert result.returncode != 0 and 'expected <system name="...">, <robot name="...">' in " ".join(result.stderr.split())


@pytest.mark.parametrize("name", ["arm 6", "腕", "é1-b", "𝄞_"])
def test_names_of_robots(name, tmp_path):
    """CMake finds the name that lagc gives to the robot."""
    link = "<link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
    (tmp_path / "arm.urdf").write_text(f'<robot name="{name}">{link}</robot>')
    assert fmu.lagc("arm.urdf", "-o", "out", "--robot", "base=floating", cwd=tmp_path).returncode == 0
    [expected] = re.findall('modelName="([^"]*)"', (tmp_path / "out" / "modelDescription.xml").read_text())
    found = subprocess.run([sys.executable, ROOT / "scripts" / "package" / "robot_symbol.py", name], capture_output=True, text=True)
    assert found.stdout == f"{expected}\n"


@pytest.mark.parametrize("command", ["run", "live"])
def test_options_for_a_robot(command, ready, tmp_path):
    """They may stand anywhere, and reach lagc by CMake; pages get them for the variant whose bodies can be pulled."""
    (tmp_path / "dog.urdf").write_text('<robot name="dog"/>')
    (ready.folder / "build" / "own").mkdir()
    (ready.folder / "build" / "own" / "system_names").write_text("dog\n")
    (ready.folder / "build" / "venv" / "installed-live").write_text((ready.folder / "build" / "venv" / "installed-run").read_text())
    given = ["--base", "floating", "dog.urdf", "--feet", "A,B", "elbow=1", "--limits=stops", "--friction", "sticks", "--keyframe", "home"]
    status, text = ready.run(command, *given, cwd=tmp_path)
    assert status == 0, text
    words = ["base=floating", "ground=A B", "limits=stops", "friction=sticks", "keyframe=home"]
    assert any(f"-DROBOT={';'.join(words)}" in call for call in ready.calls())
    last = ready.calls()[-1]
    assert " build/own/fmu/dog.fmu " in last and " elbow=1" in last
    assert command == "run" or all(f"--robot={word}" in last for word in words)
    assert ready.run(command, "dog.urdf", "--base", cwd=tmp_path)[1].endswith(f"scripts/{command}: --base needs a value; see scripts/{command} --help\n")
    add(ready.folder / "fmu" / "Pendulum")
    assert "Pendulum is no file of a robot; expected one for ground=true" in ready.run(command, "Pendulum", "--ground", cwd=tmp_path)[1]


@pytest.mark.parametrize("word", ["Pendulum", "fmu/Pendulum", "fmu/Pendulum/system.xml"])
def test_a_system_of_the_clone(word, ready):
    add(ready.folder / "fmu" / "Pendulum")
    status, text = ready.run("run", word, cwd=ready.folder)
    assert status == 0, text
    assert not any("SYSTEMS" in call for call in ready.calls())
    assert ready.calls()[-1] == "python scripts/commands/run.py build/fmu/Pendulum.fmu"


def test_systems_that_are_not_there(ready, tmp_path):
    add(ready.folder / "fmu" / "Pendulum")
    status, text = ready.run("run", "Nothing", cwd=tmp_path)
    assert status == 1 and f"neither fmu/Nothing/system.xml nor {tmp_path}/Nothing/system.xml; the systems in fmu are: Pendulum\n" in text
    one, two = add(tmp_path / "own" / "One"), add(tmp_path / "own" / "Two")
    status, text = ready.run("run", "own", cwd=tmp_path)
    assert status == 1 and f"{tmp_path}/own holds several systems; name one of them: {one} {two}\n" in text
    assert ready.calls() == []


# Fake apt-get, whose source package may be missing, and fake CMake, whose build may fail.
APT = """
echo "apt-get $*" >>"$LOG"
case "$*" in *" source "*) test "$SOURCE" = there && touch sundials_1.orig.tar.xz ;; esac
"""
CMAKE = """
echo "cmake $*" >>"$LOG"
case "$*" in
*"-E tar"*) mkdir sundials-1 ;;
*--build*) test "$MADE" = well ;;
*--install*) mkdir -p build/sundials-unfinished/ready/lib ;;
esac
"""


@pytest.fixture
def source(clone):
    """A clone in which the source of SUNDIALS is available and compiles."""
    script(clone.folder / "bin" / "apt-get", APT)
    script(clone.folder / "bin" / "cmake", CMAKE)
    clone.environment |= {"SOURCE": "there", "MADE": "well"}
    return clone


def test_sundials_is_built_once(source):
    status, text = source.run("package/sundials")
    assert (status, text) == (0, "Building SUNDIALS\n")
    build = source.folder / "build"
    assert {path.name for path in (build / "sundials").iterdir()} == {"lib", "version"}
    assert not (build / "sundials-unfinished").exists()
    calls = source.calls()
    for call in calls:  # all files of apt are in the build folder
        if call.startswith("apt-get"):
            assert all(f"{place}={build}/sundials-unfinished/" in call for place in ("Dir::State::lists", "Dir::Cache"))
    assert source.run("package/sundials") == (0, "") and source.calls() == calls
    # Another packaged version is built anew.
    script(source.folder / "bin" / "dpkg-query", "echo another\n")
    assert source.run("package/sundials")[0] == 0 and len(source.calls()) == 2 * len(calls)


@pytest.mark.parametrize("what, message", [
    ({"SOURCE": "away"}, "the source package libsundials-dev install ok installed cannot be had"),
    ({"MADE": "badly"}, "SUNDIALS cannot be built from its source package"),
])  # fmt: skip
def test_without_the_source_of_sundials(what, message, source):
    """The script prints a message, succeeds, and does not try again until asked."""
    source.environment |= what
    status, text = source.run("package/sundials")
    assert status == 0 and text.splitlines()[-1].startswith(f"scripts/package/sundials: {message}") and "packaged SUNDIALS" in text
    assert not (source.folder / "build" / "sundials").exists()
    calls = source.calls()
    assert source.run("package/sundials") == (0, "") and source.calls() == calls
    shutil.rmtree(source.folder / "build" / "sundials-failed")
    source.environment |= {"SOURCE": "there", "MADE": "well"}
    assert source.run("package/sundials") == (0, "Building SUNDIALS\n")


def test_a_build_of_sundials_that_was_stopped(source):
    unfinished = source.folder / "build" / "sundials-unfinished"
    (unfinished / "ready").mkdir(parents=True)
    (unfinished / "sundials-0").mkdir()
    assert source.run("package/sundials") == (0, "Building SUNDIALS\n")
    assert (source.folder / "build" / "sundials" / "version").exists() and not unfinished.exists()


@pytest.mark.parametrize("pip, made, message", [(0, "well", ""), (1, "well", ""), (0, "badly", "cannot be built"), (1, "badly", "cannot be built")])
def test_sundials_is_built_while_pip_works(pip, made, message, source):
    """If one of them fails, the other completes and its messages appear."""
    source.environment["MADE"] = made
    # pip ends when SUNDIALS starts to compile.
    script(source.folder / "bin" / "cmake", CMAKE.replace("*--build*)", '*--build*) echo built >"$SIGNAL";'))
    script(source.folder / "bin" / "python3", PYTHON.replace('echo made >"$SIGNAL"\n  read <"$SIGNAL"', "")
           + f'case "$*" in *"pip install"*) read <"$SIGNAL"; echo "words of pip" >&2; exit {pip} ;; esac\n')
    status, text = source.run("setup", "test")
    assert (status != 0) == (pip != 0) and "words of pip" in text and message in text
    assert (source.folder / "build" / "sundials" / "version").exists() == (made == "well")
    assert (source.folder / "build" / "venv" / "installed-test").exists() == (pip == 0)


@pytest.mark.parametrize("solver, is_built", [("<solver method='bdf'/>", True), ('<solver method = "erk" />', True), ("", False)])
def test_who_waits_for_sundials(solver, is_built, source, ready):
    """SUNDIALS is built only for systems that need it."""
    (add(ready.folder / "fmu" / "Pendulum") / "system.xml").write_text(f"<system>{solver}</system>")
    assert ready.run("run", "Pendulum")[0] == 0
    assert (ready.folder / "build" / "sundials" / "version").exists() == is_built


@pytest.mark.parametrize("words, status", [(["--help"], 0), (["-h"], 0), ([], 1), (["-DFMI_VERSIONS=2"], 1)])
def test_build_shows_its_usage(words, status):
    result = subprocess.run([ROOT / "scripts" / "build", *words], capture_output=True, text=True)
    assert result.returncode == status and result.stdout.startswith("usage: scripts/build FOLDER")


def test_names_of_test_files():
    """pytest imports each file of tests by its name alone, so that no two may share one."""
    names = [path.name for path in (ROOT / "tests").rglob("test_*.py")]
    assert len(names) == len(set(names)), [name for name in set(names) if names.count(name) > 1]
