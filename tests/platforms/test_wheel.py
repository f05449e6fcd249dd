"""The wheel on a machine with Python alone: commands, errors, FMUs equal to those of the tree, identical bytes from two clones."""

import hashlib
import re
import shutil
import subprocess
import sys
import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import fmi3
import fmu
import wheel
from fmu import ROOT

pytestmark = pytest.mark.release


def succeed(*words, cwd, **options):
    result = wheel.run(*words, cwd=cwd, **options)
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_any_linux_can_install_it():
    """The name and the C library symbols fit manylinux. The wheel is small, and contains no paths of this machine."""
    archive = wheel.installed()
    version = re.search(r"project\(lagrange-fmu VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert archive.name == f"lagrange_fmu-{version}-py3-none-manylinux_2_17_x86_64.whl"
    shown = subprocess.run([sys.executable, "-m", "auditwheel", "show", archive], capture_output=True, text=True).stdout
    assert re.search(r'consistent\s+with\s+the\s+following\s+platform\s+tag:\s+"manylinux_2_(5|12|17)_x86_64"', shown), shown
    with zipfile.ZipFile(archive) as file:
        assert sum(member.file_size for member in file.infolist()) < 15e6  # SUNDIALS has 6.7e6, lagc and the laboratory 1.8e6 and 1.7e6, three.js 0.9e6
        assert str(ROOT).encode() not in b"".join(file.read(member) for member in file.namelist())
        assert "lagrange_fmu/licenses/libxml2.txt" in file.namelist()


def test_one_version_of_the_compiler():
    """The wheel's build requirement, its dependency, and the tree's requirement have the same version."""
    pin = (ROOT / "scripts" / "requirements" / "platforms.txt").read_text().split()[-1]
    assert re.findall(r'"(ziglang[^"]*)"', (ROOT / "scripts" / "wheel" / "pyproject.toml").read_text()) == [pin, pin]


# The tag, the program's name and first bytes, and a test of the processor in its header.
OTHER_WHEELS = {
    "aarch64-linux": ("manylinux_2_17_aarch64", "lagc", b"\x7fELF", lambda program: program[18:20] == (183).to_bytes(2, "little")),
    "win64": ("win_amd64", "lagc.exe", b"MZ", lambda program: program[int.from_bytes(program[60:64], "little") :].startswith(b"PE\0\0\x64\x86")),
    "darwin64": ("macosx_11_0_x86_64", "lagc", b"\xcf\xfa\xed\xfe", lambda program: program[4:8] == b"\7\0\0\1"),
    "aarch64-darwin": ("macosx_11_0_arm64", "lagc", b"\xcf\xfa\xed\xfe", lambda program: program[4:8] == b"\x0c\0\0\1"),
}


@pytest.mark.parametrize("platform", OTHER_WHEELS)
def test_wheels_of_other_platforms(platform, tmp_path):
    """The content is that of this machine's wheel, except for lagc, which is for the wheel's own platform."""
    tag, name, beginning, is_for_the_processor = OTHER_WHEELS[platform]
    archive = wheel.build_wheel(ROOT / "scripts" / "wheel", tmp_path, "-C", f"platform={platform}")
    assert archive.name.endswith(f"-py3-none-{tag}.whl")
    with zipfile.ZipFile(archive) as there, zipfile.ZipFile(wheel.installed()) as here:
        program = there.read(f"lagrange_fmu/bin/{name}")
        assert program.startswith(beginning) and is_for_the_processor(program)
        others = {member for member in here.namelist() if "dist-info" not in member} - {"lagrange_fmu/bin/lagc"}
        assert {member for member in there.namelist() if "dist-info" not in member} == others | {f"lagrange_fmu/bin/{name}"}
        for member in others:
            assert there.read(member) == here.read(member), member


def test_a_platform_without_wheels():
    words = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "-C", "platform=vax", ROOT / "scripts" / "wheel"]
    result = subprocess.run(words, capture_output=True, text=True)
    assert result.returncode != 0 and "the platform 'vax' is not known; expected linux64, aarch64-linux, win64, darwin64, aarch64-darwin" in result.stderr


def test_the_source_distribution_builds_the_wheel(tmp_path):
    """It builds away from the tree, without the distribution's libraries that the tree uses; only the path of libxml2 differs in lagc."""
    sources = wheel.build_sdist(tmp_path)
    subprocess.run([sys.executable, "-m", "tarfile", "-e", sources, tmp_path / "unpacked"], check=True)
    [folder] = (tmp_path / "unpacked").iterdir()
    assert (folder / "PKG-INFO").read_text().startswith("Metadata-Version: ")
    contents = []
    for archive in (wheel.installed(), wheel.build_wheel(folder, tmp_path / "dist")):
        with zipfile.ZipFile(archive) as file:
            names = [member for member in file.namelist() if not member.endswith(("/lagc", "/RECORD"))]
            contents.append({member: hashlib.sha256(file.read(member)).hexdigest() for member in names})
    assert contents[0] == contents[1]


def test_from_nothing_to_a_motion(tmp_path):
    succeed("new", "Swing", cwd=tmp_path)
    assert succeed("check", "Swing.xml", cwd=tmp_path) == "Swing: 2 states, 1 input, 3 outputs, 4 parameters; solver auto\n"
    assert succeed("build", "Swing.xml", "-o", "built", cwd=tmp_path) == "built/Swing.fmu\n"
    assert validate_fmu(tmp_path / "built" / "Swing.fmu") == []
    output = succeed("run", "Swing.xml", "theta=2", "b=0", cwd=tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["Swing-motion.html", "Swing.csv", "Swing.fmu", "Swing.xml", "built"]
    assert f"CSV        {tmp_path}/Swing.csv\n" in output and "plot       none, since matplotlib is not installed" in output
    rows = np.genfromtxt(tmp_path / "Swing.csv", delimiter=",", names=True)
    assert rows["theta"][0] == 2 and rows["time"][-1] == 10
    energy = 0.5 * 0.5**2 * rows["omega"] ** 2 + 9.81 * rows["height"]
    np.testing.assert_allclose(energy, energy[0], rtol=1e-7)
    assert (tmp_path / "Swing.fmu").read_bytes() == (tmp_path / "built" / "Swing.fmu").read_bytes()


@pytest.mark.parametrize("template", ["cart", "robot", "bounce", "linkage"])
def test_templates(template, tmp_path):
    succeed("new", "Mine", "--template", template, cwd=tmp_path)
    succeed("run", "Mine.xml", "--stop-time", "1", cwd=tmp_path)
    rows = np.genfromtxt(tmp_path / "Mine.csv", delimiter=",", skip_header=1)
    assert rows[-1, 0] == 1 and np.isfinite(rows).all() and np.ptp(rows[:, 1:], axis=0).max() > 0.1


def test_a_live_page(tmp_path):
    """Bodies can be pulled, and the system can be saved; the page is compiled if the FMU was built before, too."""
    succeed("new", "Mine", "--template", "cart", cwd=tmp_path)
    succeed("build", "Mine.xml", cwd=tmp_path)
    succeed("live", "Mine.xml", cwd=tmp_path)
    page = (tmp_path / "Mine.html").read_text()
    assert '"pulled":{' in page and '"system":"' in page


def test_a_page_to_write_in(tmp_path):
    """The page needs no compiler: it contains lagc and the runtime."""
    succeed("new", "Mine", cwd=tmp_path)
    assert succeed("live", "Mine.xml", "--edit", cwd=tmp_path) == f"{tmp_path}/Mine-edit.html\n"
    page = (tmp_path / "Mine-edit.html").read_text()
    assert '"laboratory":"' in page and '<system name=\\"Mine\\"' in page.replace("\\u003c", "<")
    result = wheel.run("live", "Mine.fmu", "--edit", cwd=tmp_path)
    assert result.returncode != 0 and "Mine.fmu is an FMU, which cannot be edited; expected the system.xml of which it was made" in result.stderr


@pytest.mark.parametrize("name", ["DoublePendulum", "InvertedPendulumCart", "RollingDisk", "StateFeedback"])
def test_it_is_the_fmu_of_the_tree(name, tmp_path):
    """All files except the compiled libraries are equal."""
    succeed("build", ROOT / "fmu" / name, cwd=tmp_path)
    with zipfile.ZipFile(tmp_path / f"{name}.fmu") as built, zipfile.ZipFile(fmu.archive(name)) as packed:
        assert built.namelist() == packed.namelist()
        for member in built.namelist():
            assert member.startswith("binaries/") or built.read(member) == packed.read(member), member
    motions = [fmpy.simulate_fmu(str(path), fmi_type="CoSimulation") for path in (tmp_path / f"{name}.fmu", fmu.archive(name))]
    for column in motions[0].dtype.names:
        np.testing.assert_allclose(motions[0][column], motions[1][column], rtol=1e-8, atol=1e-8)


def test_fmi3(tmp_path):
    """All files except the compiled libraries are those of the tree."""
    succeed("build", ROOT / "fmu" / "DoublePendulum", "--fmi", "3", "--platforms", "linux64", "aarch64-linux", cwd=tmp_path)
    path = tmp_path / "DoublePendulum.fmu"
    with zipfile.ZipFile(path) as built, zipfile.ZipFile(fmi3.archive("DoublePendulum")) as packed:
        libraries = {f"binaries/{folder}/DoublePendulum.so" for folder in ("x86_64-linux", "aarch64-linux")}
        others = set(packed.namelist()) - {"binaries/x86_64-linux/DoublePendulum.so"}
        assert set(built.namelist()) == libraries | others
        for member in others:
            assert built.read(member) == packed.read(member), member
    second, third = (fmpy.simulate_fmu(str(archive), fmi_type="CoSimulation", stop_time=1) for archive in (fmu.archive("DoublePendulum"), path))
    np.testing.assert_allclose(third["theta2"], second["theta2"], rtol=1e-8, atol=1e-8)


def test_another_compiler_of_lagc_changes_nothing(tmp_path):
    """The evaluation order of arguments is unspecified in C; the wheel's lagc is compiled by zig's clang, the tree's by gcc."""
    wheel.installed()
    [lagc] = (wheel.FOLDER / "venv" / "lib").glob("python*/site-packages/lagrange_fmu/bin/lagc")
    for system in [*(ROOT / "fmu").glob("*/system.xml"), *(ROOT / "tests" / "systems").glob("*/system.xml")]:
        for program, folder in ((lagc, "one"), (fmu.LAGC, "other")):
            subprocess.run([program, system, "-o", tmp_path / folder], check=True, capture_output=True)
        for file in ("system.c", "modelDescription.xml", "documentation/index.html"):
            assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "other" / file).read_bytes(), (system, file)


def test_platforms(tmp_path):
    succeed("new", "Swing", cwd=tmp_path)
    succeed("build", "Swing.xml", "--platforms", "linux64", "aarch64-linux", cwd=tmp_path)
    with zipfile.ZipFile(tmp_path / "Swing.fmu") as file:
        binaries = [member for member in file.namelist() if member.startswith("binaries/")]
        assert binaries == ["binaries/aarch64-linux/Swing.so", "binaries/linux64/Swing.so"]
        assert [file.read(member)[18] for member in binaries] == [183, 62]  # the processors, in ELF


def test_solvers_of_sundials(tmp_path):
    """The wheel contains the SUNDIALS libraries for all platforms."""
    for solver in ("bdf", "erk", "radau"):
        words = ["--solver", solver, "-o", solver]
        succeed("build", ROOT / "fmu" / "DoublePendulum", *words, *(["--platforms", "linux64", "aarch64-linux"] if solver == "bdf" else []), cwd=tmp_path)
    motions = [fmpy.simulate_fmu(str(path), stop_time=1) for path in sorted(tmp_path.glob("*/DoublePendulum.fmu"))]
    assert len(motions) == 3
    for motion in motions[:2]:
        np.testing.assert_allclose(motion["theta2"], motions[2]["theta2"], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("words, message", [
    (["build", "nothing.xml"], "there is no file nothing.xml; expected a system in XML"),
    (["check", "."], "there is no file system.xml; expected a system in XML"),
    (["check", "bad.xml"], "bad.xml:2: the potential: unknown name 'q'"),
    (["build", "good.xml", "--platforms", "win46"], "the platform 'win46' is not known; did you mean 'win64'?"),
    (["build", "good.xml", "--solver", "euler"], "--solver euler is not known; expected taylor,"),
    (["build", "good.xml", "-o", "good.xml"], "good.xml/Good.fmu cannot be written: File exists; expected a writable folder with"),
    (["run", "good.xml", "x=abc"], "x: the value: unknown name 'abc'; expected a number, perhaps with its unit"),
    (["run", "good.xml", "x"], "'x' is not NAME=VALUE"),
    (["run", "good.xml", "y=1"], "'y' is not a variable of Good; these can be: x, v"),
    (["new", "3D"], "'3D' cannot name a system; expected letters, digits and _"),
    (["new", "good"], "good.xml exists already; expected another name"),
    (["make"], "invalid choice: 'make'; choose from: new, check, show, build"),
])  # fmt: skip
def test_mistakes(words, message, tmp_path):
    (tmp_path / "good.xml").write_text('<system name="Good"><coordinate name="x" velocity="v"/><particle mass="1" x="x"/></system>')
    (tmp_path / "bad.xml").write_text('<system name="Bad"><coordinate name="x" velocity="v"/><particle mass="1" x="x"/>\n<potential>q</potential></system>')
    result = wheel.run(*words, cwd=tmp_path)
    assert result.returncode in (1, 2) and message in result.stderr and "Traceback" not in result.stderr, result.stderr


def test_no_arguments_show_the_help(tmp_path):
    """As with pip, the command without arguments shows the help."""
    shown = succeed(cwd=tmp_path)
    assert shown == succeed("--help", cwd=tmp_path) and "linearize" in shown


def test_a_likely_mistake_is_a_warning(tmp_path):
    (tmp_path / "one.xml").write_text(
        '<system name="One"><parameter name="m" start="1" unit="kg"/><parameter name="k" start="1"/><coordinate name="x" velocity="v" unit="m"/>'
        '<particle mass="m" x="x"/></system>'
    )
    assert "one.xml:1: warning: 'k' has no unit" in wheel.run("check", "one.xml", cwd=tmp_path).stderr
    with pytest.warns(UserWarning, match="'k' has no unit"):
        wheel.package().check(tmp_path / "one.xml")


def test_from_python(tmp_path):
    lagrange_fmu = wheel.package()
    path = lagrange_fmu.build(ROOT / "fmu" / "SimplePendulum", output=tmp_path, solver="radau")
    assert path == tmp_path / "SimplePendulum.fmu"
    from_file, from_fmu = (lagrange_fmu.simulate(system, {"theta": 0.5}, stop_time=1, solver=None) for system in (ROOT / "fmu" / "SimplePendulum", path))
    np.testing.assert_allclose(from_file["theta"], from_fmu["theta"], rtol=1e-8, atol=1e-9)
    written = lagrange_fmu.run(path, {"theta": 0.5}, folder=tmp_path / "results")
    assert written["CSV"].exists() and written["plot"].stat().st_size > 10_000
    with pytest.raises(lagrange_fmu.Problem, match="there is no file"):
        lagrange_fmu.build(tmp_path / "nothing")
    with pytest.raises(lagrange_fmu.Problem, match="the platform 'win46' is not known; did you mean 'win64'"):
        lagrange_fmu.build(ROOT / "fmu" / "SimplePendulum", platforms="win46")
    with pytest.raises(lagrange_fmu.Problem, match="the version 1 of FMI is not known; expected 2 or 3"):
        lagrange_fmu.build(ROOT / "fmu" / "SimplePendulum", fmi=1)


def test_two_clones_give_the_same_bytes(tmp_path):
    clone = tmp_path / "else where, over there"
    for folder in ("fmu", "include", "modelDescription", "scripts", "src"):
        shutil.copytree(ROOT / folder, clone / folder, ignore=shutil.ignore_patterns("__pycache__"))
    for file in ("CMakeLists.txt", "LICENSE"):
        shutil.copy(ROOT / file, clone)
    for folder in ("libxml2", "sundials-all"):
        shutil.copytree(ROOT / "build" / folder, clone / "build" / folder)
    contents = []
    for archive in (wheel.installed(), wheel.build_wheel(clone / "scripts" / "wheel", tmp_path / "dist")):
        with zipfile.ZipFile(archive) as file:
            contents.append({member: hashlib.sha256(file.read(member)).hexdigest() for member in file.namelist()})
    assert contents[0] == contents[1]
