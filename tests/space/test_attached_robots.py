"""Attached files of MJCF, against the same robot in one file, which test_robots_in_mujoco.py compares in MuJoCo."""

import re

from attached_arms import TEXTS
from fmu import lagc


def variables(path):
    """The names of all variables, each with its start value."""
    found = re.findall(r'<ScalarVariable name="([^"]*)"[^>]*>\s*<Real(?:[^>]*? start="([^"]*)")?', path.read_text())
    return [(name, float(start or 0)) for name, start in found]


def test_the_robot_is_that_of_one_file(tmp_path):
    for name, text in TEXTS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    for name in ("top", "flat"):
        result = lagc(f"{name}.xml", "-o", name, cwd=tmp_path)
        assert result.returncode == 0, result.stderr
    attached, flat = (variables(tmp_path / name / "modelDescription.xml") for name in ("top", "flat"))
    assert len(flat) > 100 and [name for name, _ in attached] == [name for name, _ in flat]
    wrong = [(name, start, value) for (name, start), (_, value) in zip(attached, flat) if abs(start - value) > 1e-12 * max(1, abs(value))]
    assert wrong == []
