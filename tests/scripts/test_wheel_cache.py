"""The cache of the Python package: its location, its lifetime, and waiting processes."""

import importlib.util
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from fmu import ROOT

FILE = ROOT / "scripts" / "wheel" / "lagrange_fmu" / "caching.py"


@pytest.fixture
def caching(tmp_path, monkeypatch):
    monkeypatch.setenv("LAGRANGE_FMU_CACHE", str(tmp_path / "cache"))
    return load()


def load():
    specification = importlib.util.spec_from_file_location("caching", FILE)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_where_it_is(tmp_path, monkeypatch):
    """
    The cache is at the configured location, else by the convention of the desktop; among temporary files if the user may not write there.
    """
    caching = load()
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("LAGRANGE_FMU_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert caching.folder() == tmp_path / "home" / ".cache" / "lagrange-fmu"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert caching.folder() == tmp_path / "xdg" / "lagrange-fmu" and caching.folder().is_dir()
    monkeypatch.setenv("LAGRANGE_FMU_CACHE", str(tmp_path / "asked"))
    assert caching.folder() == tmp_path / "asked"
    (tmp_path / "file").touch()
    monkeypatch.setenv("LAGRANGE_FMU_CACHE", str(tmp_path / "file" / "cache"))
    monkeypatch.setattr(caching.tempfile, "gettempdir", lambda: str(tmp_path))
    assert caching.folder() == tmp_path / f"lagrange-fmu-{os.getuid()}"


def test_builds_are_reused(tmp_path, caching, monkeypatch):
    """The key depends on all inputs of the build; the most recently used entries stay."""
    (tmp_path / "new" / "linux64").mkdir(parents=True)
    (tmp_path / "new" / "linux64" / "A.so").write_text("a library")
    keys = [caching.key_of(*words) for words in (("ab", "c"), ("a", "bc"), (b"ab", "c", 2))]
    assert len(set(keys)) == 3
    assert not caching.take(keys[0], tmp_path / "taken")
    caching.keep(keys[0], tmp_path / "new")
    caching.keep(keys[0], tmp_path / "new")  # as by two processes at once
    assert caching.take(keys[0], tmp_path / "taken") and (tmp_path / "taken" / "linux64" / "A.so").read_text() == "a library"
    monkeypatch.setattr(caching, "KEPT", 2)
    caching.keep(keys[1], tmp_path / "new")
    os.utime(caching.folder() / "built" / keys[0], (1, 1))
    caching.take(keys[0], tmp_path / "taken")  # makes it the newest
    os.utime(caching.folder() / "built" / keys[1], (2, 2))
    caching.keep(keys[2], tmp_path / "new")
    assert {path.name for path in (caching.folder() / "built").iterdir()} == {keys[0], keys[2]}


def test_the_first_build_for_a_platform_lets_others_wait(tmp_path, caching):
    """Other processes wait and print that they do; later builds neither wait nor print."""
    script = f"""
import importlib.util, sys
specification = importlib.util.spec_from_file_location("caching", {str(FILE)!r})
caching = importlib.util.module_from_spec(specification)
specification.loader.exec_module(caching)
with caching.first_build("win64", lambda text: print(text, flush=True)):
    sys.stdin.readline()
"""
    first = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert first.stdout.readline().startswith("compiling for win64; the first time")
    reported, waits = [], threading.Event()

    def second_build():
        with caching.first_build("win64", lambda text: (reported.append(text), waits.set())):
            reported.append("built")

    second = threading.Thread(target=second_build)
    second.start()
    assert waits.wait(20) and reported == ["another build compiles the C library of win64; waiting for it to end ..."]
    first.communicate("continue\n", timeout=20)
    second.join(20)
    assert reported[1:] == ["built"]
    with caching.first_build("win64", reported.append):
        pass
    assert len(reported) == 2


def test_a_first_build_that_fails_is_not_the_last(caching):
    reported = []
    for _ in range(2):
        with pytest.raises(ValueError), caching.first_build("win64", reported.append):
            raise ValueError
    assert [text.split(";")[0] for text in reported] == ["compiling for win64", "compiling for win64"]
    assert not Path(caching.folder() / "ready-win64").exists()
