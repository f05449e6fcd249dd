"""The README's examples work when they are pasted."""

import re
import zipfile

import features
import fmpy
import numpy as np
from scipy.integrate import solve_ivp

from building import build_by_cmake
from fmu import BUILD, ROOT, all_names, lagc

README = (ROOT / "README.md").read_text()


def test_own_system(tmp_path):
    system = re.search(r"```xml\n(<system .*?</system>\n)```", README, re.S).group(1)
    assert len(system.splitlines()) <= 15
    archive = build_by_cmake(tmp_path, {"BeadOnHoop": system}) / "BeadOnHoop.fmu"
    documentation = zipfile.ZipFile(archive).read("documentation/index.html").decode()
    equation = re.search(r"equations, here `(.*?)`", README, re.S).group(1)
    assert equation in documentation
    result = fmpy.simulate_fmu(str(archive))
    m, R, W, b, g = 0.1, 0.5, 6, 0.01, 9.81
    exact = solve_ivp(
        lambda t, y: [y[1], (W**2 * np.cos(y[0]) - g / R) * np.sin(y[0]) - b * y[1] / (m * R * R)],
        (0, 10), [0.1, 0], rtol=1e-11, atol=1e-12,
    )
    assert abs(result["theta"][-1] - exact.y[0, -1]) < 1e-6
    assert abs(result["height"][-1] - R * (1 - np.cos(exact.y[0, -1]))) < 1e-6


def test_linearization_as_printed():
    command, expected = re.search(r"    \$ build/bin/(lagc .*)\n((?:    .*\n)+)", README).groups()
    printed = lagc(*command.split()[1:], cwd=ROOT).stdout
    assert "".join(line[4:] + "\n" for line in expected.splitlines()) in printed


def test_python_example(monkeypatch):
    monkeypatch.chdir(ROOT)
    code = re.search(r"```python\n(.*?)```", README, re.S).group(1)
    names = {}
    exec(code, names)
    assert names["result"]["theta"][0] == 3 and names["result"]["time"][-1] == 5


def test_every_system_is_in_the_table():
    table = README[README.index("## The systems") : README.index("## Coupled with others")]
    assert set(re.findall(r"\b[A-Z][A-Za-z]+\b", table)) >= set(all_names())


def test_table_of_features():
    """scripts/features brings it up to date."""
    assert f"<!-- features -->\n{features.table()}\n<!-- end -->" in README


def test_every_command_is_there():
    for script in set(re.findall(r"scripts/(\w+(?:\.\w+)?)", README)):
        assert (ROOT / "scripts" / script).exists()
    assert (BUILD / "bin" / "lagc").exists()
