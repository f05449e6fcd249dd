"""The examples of README.md and of the pages beside the systems work as pasted, and the listed files exist."""

import re
import zipfile

from scripts.checks import features
import fmpy
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from building import build_by_cmake
from fmu import BUILD, ROOT, all_names, lagc

README = (ROOT / "README.md").read_text()
SYSTEMS = (ROOT / "fmu" / "SYSTEMS.md").read_text()
SOLVERS = (ROOT / "fmu" / "SOLVERS.md").read_text()
FOLDERS = (ROOT / "fmu", ROOT / "fmu" / "howto", ROOT / "fmu" / "theory")
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "src/README.md", "scripts/README.md")),
    *(page for folder in FOLDERS for page in sorted(folder.glob("*.md"))),
]


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
    command, expected = re.search(r"    \$ build/bin/(lagc .*)\n((?:    .*\n)+)", SOLVERS).groups()
    printed = lagc(*command.split()[1:], cwd=ROOT).stdout
    assert "".join(line[4:] + "\n" for line in expected.splitlines()) in printed


def anchors(page):
    """Anchors of the headings, as GitHub generates them."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", page.read_text(), flags=re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def test_short_enough():
    assert len(README.splitlines()) <= 100


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\((?!https?:)([^)\s]+)\)", re.sub(r"```.*?```", "", page.read_text(), flags=re.S)):
        file, _, anchor = target.partition("#")
        place = page.parent / file if file else page
        assert place.exists(), target
        assert not anchor or anchor in anchors(place), target


def test_robot(tmp_path):
    robot = re.search(r"```xml\n(<robot .*?</robot>\n)```", README, re.S).group(1)
    (tmp_path / "arm.urdf").write_text(robot)
    result = lagc(tmp_path / "arm.urdf", "-o", tmp_path)
    assert result.returncode == 0 and result.stderr == ""
    # The equation has the moment of inertia about the joint, 0.06 + 2 * 0.3^2.
    assert "0.24*der(shoulder_velocity) = shoulder_torque" in (tmp_path / "documentation" / "index.html").read_text()


def test_python_example(monkeypatch):
    monkeypatch.chdir(ROOT)
    code = re.search(r"```python\n(.*?)```", README, re.S).group(1)
    names = {}
    exec(code, names)
    assert names["result"]["theta"][0] == 3 and names["result"]["time"][-1] == 5


def test_every_system_is_in_the_table():
    table = SYSTEMS[: SYSTEMS.index("## What each FMU offers")]
    assert set(re.findall(r"\b[A-Z][A-Za-z]+\b", table)) >= set(all_names())


def test_table_of_features():
    """The table is that which scripts/checks/features writes."""
    assert f"<!-- features -->\n{features.table()}\n<!-- end -->" in SYSTEMS


def test_every_command_is_there():
    for script in set(re.findall(r"\bscripts/([\w./-]*\w)", "".join(page.read_text() for page in PAGES))):
        assert (ROOT / "scripts" / script).exists()
    assert (BUILD / "bin" / "lagc").exists()
