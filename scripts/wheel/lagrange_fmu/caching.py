"""
Cache compiled files: the C libraries of platforms, which zig compiles once, and the libraries of FMUs.

The cache is the folder in the environment variable LAGRANGE_FMU_CACHE, by default lagrange-fmu/ in the user's folder for caches. It can be
deleted at any time.
"""

import hashlib
import os
import shutil
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

KEPT = 200  # libraries of FMUs at most; the least recently used ones are deleted


def user_folder():
    """Return the path of the cache by the conventions of the operating system; it may not exist."""
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
    """Create the cache and return its path; a temporary folder if the user may not write to user_folder()."""
    try:
        path = user_folder()
        path.mkdir(parents=True, exist_ok=True)
        if os.access(path, os.W_OK):
            return path
    except (OSError, RuntimeError):  # RuntimeError: the user has no home
        pass
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")
    path = Path(tempfile.gettempdir()) / f"lagrange-fmu-{user}"
    path.mkdir(mode=0o700, exist_ok=True)
    return path


def share_zig_cache():
    """Let zig keep its cache, with the platforms' C libraries, in this cache, too."""
    os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(folder() / "zig"))


def _locked(file):
    """Try to lock a file; return True on success. The end of the process releases the lock."""
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
def first_build(platform, report):
    """
    Serialize the first builds for a platform, of which one compiles the platform's C library, for some minutes.

    Waiting builds report it by report(text). Later builds run concurrently.
    """
    ready = folder() / f"ready-{platform}"
    if ready.exists():
        yield
        return
    with open(folder() / f"lock-{platform}", "w") as lock:
        if not _locked(lock):
            report(f"another build compiles the C library of {platform}; waiting for it to end ...")
            while not _locked(lock):
                time.sleep(0.2)
        if not ready.exists():
            report(f"compiling for {platform}; the first time, with the platform's C library, this takes one to three minutes ...")
        yield
        ready.touch()


def key_of(*contents):
    """Return the key of a build: a hash of all contents that it depends on."""
    sums = hashlib.sha256()
    for content in contents:
        content = content if isinstance(content, bytes) else str(content).encode()
        sums.update(len(content).to_bytes(8, "big") + content)
    return sums.hexdigest()[:32]


def take(key, target):
    """Copy the files of this key into the folder `target`; return True if the cache has them."""
    kept = folder() / "built" / key
    if not kept.is_dir():
        return False
    shutil.copytree(kept, target, dirs_exist_ok=True)
    os.utime(kept)
    return True


def keep(key, source):
    """Store a copy of the folder `source` under the key, and delete the oldest entries."""
    built = folder() / "built"
    built.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=built, prefix=".") as scratch:
        shutil.copytree(source, Path(scratch) / key)
        try:
            (Path(scratch) / key).rename(built / key)
        except OSError:  # another process has stored it already
            return
    oldest_first = sorted((path for path in built.iterdir() if not path.name.startswith(".")), key=lambda path: path.stat().st_mtime)
    for path in oldest_first[:-KEPT]:
        shutil.rmtree(path, ignore_errors=True)
