"""The wheel, built and installed for tests that use it."""

import fcntl
import functools
import os
import shutil
import subprocess
import sys

from fmu import ROOT

FOLDER = ROOT / "build" / "wheel"
COMMAND = FOLDER / "venv" / "bin" / "lagrange-fmu"
# Neither a compiler nor CMake nor zip, nor a home with what zig has compiled.
BARE = {"PATH": "/nonexistent", "TMPDIR": str(FOLDER / "scratch"), "LAGRANGE_FMU_CACHE": str(FOLDER / "scratch" / "cache")}


def build_wheel(source, folder, *further):
    """From the folder of a pyproject.toml."""
    words = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "--wheel-dir", folder, *further]
    words.append(source)
    result = subprocess.run(words, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    [wheel] = folder.glob("*.whl")
    return wheel


def build_sdist(folder):
    command = f"import backend; print(backend.build_sdist({str(folder)!r}))"
    subprocess.run([sys.executable, "-c", command], cwd=ROOT / "scripts" / "wheel", check=True, capture_output=True)
    [archive] = folder.glob("*.tar.gz")
    return archive


def _install(wheel):
    """Into an environment of its own, with what the wheel asks for and nothing else."""
    pip = FOLDER / "venv" / "bin" / "pip"
    if not pip.exists():
        subprocess.run([sys.executable, "-m", "venv", FOLDER / "venv"], check=True)
    subprocess.run([pip, "install", "--quiet", "--disable-pip-version-check", "-c", ROOT / "scripts" / "requirements-run.txt", wheel], check=True)
    subprocess.run([pip, "install", "--quiet", "--disable-pip-version-check", "--force-reinstall", "--no-deps", wheel], check=True)


@functools.cache
def installed():
    """The wheel of this tree, after it has been installed where COMMAND is; once in a run of tests, other processes wait."""
    (FOLDER / "scratch").mkdir(parents=True, exist_ok=True)
    this_run = os.environ.get("PYTEST_XDIST_TESTRUNUID", str(os.getpid()))
    with open(FOLDER / "lock", "a+") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        lock.seek(0)
        if lock.read() != this_run:
            shutil.rmtree(FOLDER / "dist", ignore_errors=True)
            _install(build_wheel(ROOT / "scripts" / "wheel", FOLDER / "dist"))
            lock.truncate(0)
            lock.write(this_run)
    [wheel] = (FOLDER / "dist").glob("*.whl")
    return wheel


@functools.cache
def package():
    """The package lagrange_fmu of the wheel, in this process, with its environment's packages."""
    installed()
    [folder] = (FOLDER / "venv" / "lib").glob("python*/site-packages")
    sys.path.append(str(folder))
    import lagrange_fmu

    return lagrange_fmu


def run(*words, cwd, environment=BARE):
    """The command of the wheel in an environment without tools."""
    installed()
    return subprocess.run([COMMAND, *map(str, words)], env=environment, cwd=cwd, capture_output=True, text=True)
