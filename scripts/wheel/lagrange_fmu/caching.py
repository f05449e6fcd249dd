"""
What stays on this machine: the C libraries of platforms, which zig compiles once, and the libraries of FMUs that were built already.
They are in the folder that LAGRANGE_FMU_CACHE names, else in lagrange-fmu/ of the user's folder for caches, and can be deleted.
"""

import hashlib
import os
import shutil
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

KEPT = 200  # libraries of FMUs; those that were not used for longest go


def user_folder():
    """Where the user's programs keep what can be had again; of the system's own conventions."""
    if "LAGRANGE_FMU_CACHE" in os.environ:
        return Path(os.environ["LAGRANGE_FMU_CACHE"])
    if os.name == "nt":
        base = os.environ.get("LOCALAPPDATA")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base or tempfile.gettempdir()) / "lagrange-fmu"


def folder():
    """Likewise, and it is there; one among the temporary files where the user may not write."""
    try:
        path = user_folder()
        path.mkdir(parents=True, exist_ok=True)
        if os.access(path, os.W_OK):
            return path
    except (OSError, RuntimeError):  # no home
        pass
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")
    path = Path(tempfile.gettempdir()) / f"lagrange-fmu-{user}"
    path.mkdir(mode=0o700, exist_ok=True)
    return path


def keep_what_zig_compiles():
    """Of the platforms' C libraries in this folder too, where zig needs no home of the user."""
    os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(folder() / "zig"))


def _locked(file):
    """Takes the lock if it is free, and says whether it was; the end of the process frees it."""
    try:
        if os.name == "nt":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


@contextmanager
def first_build(platform, tell):
    """
    While a platform's C library is compiled, which takes a minute, other builds for it wait, and say so by tell(text). Once that is done
    builds go side by side.
    """
    ready = folder() / f"ready-{platform}"
    if ready.exists():
        yield
        return
    with open(folder() / f"lock-{platform}", "w") as lock:
        if not _locked(lock):
            tell(f"another build compiles the C library of {platform}; waiting for it to end ...")
            while not _locked(lock):
                time.sleep(0.2)
        if not ready.exists():
            tell(f"compiling for {platform}; the first time, with the platform's C library, this takes up to a minute ...")
        yield
        ready.touch()


def key_of(*contents):
    """Of what is built, by all that it is built from."""
    sums = hashlib.sha256()
    for content in contents:
        content = content if isinstance(content, bytes) else str(content).encode()
        sums.update(len(content).to_bytes(8, "big") + content)
    return sums.hexdigest()[:32]


def take(key, target):
    """Copies what was kept under the key into the folder target; says whether there was anything."""
    kept = folder() / "built" / key
    if not kept.is_dir():
        return False
    shutil.copytree(kept, target, dirs_exist_ok=True)
    os.utime(kept)
    return True


def keep(key, source):
    """Keeps a copy of the folder source under the key."""
    built = folder() / "built"
    built.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=built, prefix=".") as scratch:
        shutil.copytree(source, Path(scratch) / key)
        try:
            (Path(scratch) / key).rename(built / key)
        except OSError:  # another process was first
            return
    oldest_first = sorted((path for path in built.iterdir() if not path.name.startswith(".")), key=lambda path: path.stat().st_mtime)
    for path in oldest_first[:-KEPT]:
        shutil.rmtree(path, ignore_errors=True)
