"""Every FMU contains the licence of its own content, and those of the libraries linked into it."""

import pytest

import fmu
from fmi3 import unpacked as unpacked_fmi3
from fmu import ROOT, lagc

OURS = (ROOT / "LICENSE").read_text()
CHAIN = """<system name="Chain"><constant name="N" value="{N}"/>
  <for index="i" from="1" to="N">
    <coordinate name="x[i]" velocity="v[i]" start="0.1"/><kinetic>v[i]^2/2</kinetic><potential>x[i]^4</potential>
  </for>
  <for index="i" from="2" to="N"><potential>(x[i] - x[i-1])^2</potential></for>
  <solver method="{method}"/>
</system>"""


@pytest.mark.parametrize("unpacked", [fmu.unpacked, unpacked_fmi3], ids=["FMI 2.0", "FMI 3.0"])
def test_every_fmu_has_ours(unpacked):
    for name in fmu.all_names():
        folder = unpacked(name)
        assert OURS in (folder / "documentation" / "licenses" / "license.txt").read_text()
        for source in (folder / "sources").glob("*.c"):
            notice = "\n".join(line.removeprefix(" * ").removeprefix(" *") for line in source.read_text().split("*/")[0].split("\n")[1:])
            assert OURS.split() == notice.split(), source


@pytest.mark.parametrize("method, N, names", [
    ("taylor", 2, set()), ("erk", 2, {"sundials.txt"}), ("bdf", 2, {"sundials.txt"}),
    ("bdf", 200, {"sundials.txt", "suitesparse.txt", "LGPL-2.1.txt"}),
])  # fmt: skip
def test_linked_libraries_are_named(method, N, names, tmp_path):
    (tmp_path / "system.xml").write_text(CHAIN.format(method=method, N=N))
    assert lagc("system.xml", "-o", "out", cwd=tmp_path).returncode == 0
    words = (tmp_path / "out" / "documentation" / "licenses" / "license.txt").read_text().removesuffix(OURS).split()
    assert {word.strip(",") for word in words if ".txt" in word} == names


def test_licences_of_libraries():
    """The licences are the libraries' own: Lawrence Livermore's for SUNDIALS, the LGPL for KLU."""
    fmu.build_systems("licensed", {"Chain": CHAIN.format(method="bdf", N=200)})
    folder = fmu.unpacked("Chain") / "documentation" / "licenses"
    assert {path.name for path in folder.iterdir()} == {"license.txt", "sundials.txt", "suitesparse.txt", "LGPL-2.1.txt"}
    assert "Lawrence Livermore" in (folder / "sundials.txt").read_text()
    assert "KLU" in (folder / "suitesparse.txt").read_text() and "GNU LESSER GENERAL PUBLIC LICENSE" in (folder / "LGPL-2.1.txt").read_text()
