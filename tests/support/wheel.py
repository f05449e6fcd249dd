"""The wheel, built and installed for tests."""

import fcntl
import functools
import os
import shutil
import subprocess
import sys

from fmu import ROOT

FOLDER = ROOT / "build" / "wheel"
COMMAND = FOLDER / "venv" / "bin" / "lagrange-fmu"
# Environment without compiler, CMake, zip, and zig's cache in a home folder.
BARE = {"PATH": "/nonexistent", "TMPDIR": str(FOLDER / "scratch"), "LAGRANGE_FMU_CACHE": str(FOLDER / "scratch" / "cache")}


def build_wheel(source, folder, *further):
    """Build a wheel from a folder with a pyproject.toml."""
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
    """Install a wheel and its requirements into a separate environment."""
    pip = FOLDER / "venv" / "bin" / "pip"
    if not pip.exists():
        subprocess.run([sys.executable, "-m", "venv", FOLDER / "venv"], check=True)
    subprocess.run([pip, "install", "--quiet", "--disable-pip-version-check", "-c", ROOT / "scripts" / "requirements" / "run.txt", wheel], check=True)
    subprocess.run([pip, "install", "--quiet", "--disable-pip-version-check", "--force-reinstall", "--no-deps", wheel], check=True)


@functools.cache
def installed():
    """Install the wheel of this tree where COMMAND is, once in a run of tests; other processes wait. Return the wheel."""
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
    """Import lagrange_fmu of the installed wheel into this process, with the packages of its environment."""
    installed()
    [folder] = (FOLDER / "venv" / "lib").glob("python*/site-packages")
    sys.path.append(str(folder))
    import lagrange_fmu

    return lagrange_fmu


def run(*words, cwd, environment=BARE):
    """Run the command of the wheel in an environment without tools."""
    installed()
    return subprocess.run([COMMAND, *map(str, words)], env=environment, cwd=cwd, capture_output=True, text=True)
