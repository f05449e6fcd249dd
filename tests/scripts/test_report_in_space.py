"""Basis of the report of bodies in space: models for other programs, references, accelerations of robots."""

import importlib.util
import math

import numpy as np
import pytest

import fmu
from numerics import driver
from numerics.mechanisms.comparison import METHODS, Fmu, Peer, first_run
from numerics.space import accelerations
from numerics.space.accelerations import ROBOTS, Missing
from numerics.space.problems import PROBLEMS

pytestmark = pytest.mark.release

BRICARD, GOVERNOR, TOP, FREE_BODY, ARM = PROBLEMS


@pytest.fixture(autouse=True)
def built(monkeypatch):
    """Use the FMUs as shipped in place of the builds with each solver."""
    monkeypatch.setattr(driver, "folder_of", lambda solver: fmu.BUILD)


@pytest.fixture
def governor(monkeypatch):
    """The governor with the FMU at a tight tolerance in place of its reference, which takes a minute."""
    stepped = driver.step("taylor", GOVERNOR.system, {}, GOVERNOR.end, 1e-11, driver.POINTS, 0)
    monkeypatch.setitem(vars(GOVERNOR), "exact", stepped.columns(GOVERNOR.compared))


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.system)
def test_energy_at_the_start(problem, open_fmu):
    """The energy is that of the FMU; the governor's springs are at rest. Bricard's rods hang from a horizontal one."""
    expected = open_fmu(problem.system).initialize().get("totalEnergy")
    assert problem.model.start_energy() == pytest.approx(expected, rel=1e-8 if problem is ARM else 1e-13)
    if problem is BRICARD:
        assert expected == pytest.approx(-3 * 9.81, rel=1e-14)


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.system)
def test_links_move_with_their_joints(problem):
    """
    At the start both sides of a hinge or ball joint have the same velocity. The relative rotation of hinges and sliders is about the axis at most.
    """
    links = problem.model.links
    at = lambda link, point: np.add(link.velocity, np.cross(link.angular_velocity, np.subtract(point, link.centre)))
    for link in links:
        above = links[link.above] if link.above is not None else None
        angular_velocity = np.subtract(link.angular_velocity, above.angular_velocity if above else np.zeros(3))
        if link.joint in ("hinge", "ball"):
            assert at(link, link.point) == pytest.approx(at(above, link.point) if above else np.zeros(3), abs=1e-12)
        if link.joint in ("hinge", "slide"):
            assert np.linalg.norm(link.axis) == pytest.approx(1, rel=1e-15)
            assert np.cross(angular_velocity, link.axis) == pytest.approx(np.zeros(3), abs=1e-12)


def test_springs_of_the_governor():
    """The springs have their natural length at the start. They connect the middles of the arms with the sides of the slider."""
    for spring in GOVERNOR.model.springs:
        (_, begin), (_, end) = spring.ends
        assert np.linalg.norm(begin - end) == pytest.approx(spring.length, rel=1e-14)


@pytest.mark.parametrize("problem, measure, largest", [(BRICARD, "drift", 1e-7), (TOP, "error", 1e-8), (FREE_BODY, "error", 1e-5), (ARM, "error", 1e-9)],
                         ids=["A04", "top", "free body", "arm"])  # fmt: skip
def test_errors_of_the_fmu(problem, measure, largest):
    """The references are closed forms, and Pinocchio's algorithm for the arm."""
    assert first_run(problem, "taylor", 1e-8)[1].measured(measure) < largest


# Steps at which errors of the methods of order 2 or more are compared; implicitfast has order 1, and its energy is not compared.
ORDER_TWO = [(BRICARD, "drift", 500, 2000), (FREE_BODY, "error", 2000, 8000), (GOVERNOR, "error", 1000, 4000), (TOP, "error", 4000, 16000)]
CONVERGENT = [
    *((peer, *run) for peer in METHODS[2:4] for run in ORDER_TWO if run[0] is not TOP or "index 2" in peer),
    *(("MuJoCo RK4", *run) for run in (*ORDER_TWO[:2], (GOVERNOR, "error", 20000, 40000), ORDER_TWO[3], (ARM, "error", 100, 200))),
    ("MuJoCo implicitfast", ARM, "error", 200, 2000),
    ("MuJoCo implicitfast", FREE_BODY, "error", 2000, 20000),
]


@pytest.mark.parametrize("peer, problem, measure, rough, fine", CONVERGENT, ids=lambda value: getattr(value, "system", str(value)))
def test_peers_converge(peer, problem, measure, rough, fine, governor):
    """Peers model the same mechanism, since their errors converge."""
    if importlib.util.find_spec(peer.split()[0].lower()) is None:
        pytest.skip(f"{peer} is not installed")
    rough, fine = (first_run(problem, peer, steps)[1].measured(measure) for steps in (rough, fine))
    assert fine < 0.3 * rough and fine < 0.03


@pytest.mark.parametrize("peer", METHODS[2:5])
def test_bricard_in_other_programs(peer):
    """Energy would be conserved without a constraint, too: the position of the third joint is that of the FMU."""
    if importlib.util.find_spec(peer.split()[0].lower()) is None:
        pytest.skip(f"{peer} is not installed")
    (_, ours), (_, theirs) = Fmu(BRICARD, 1e-10, "taylor", 60).record(), Peer(BRICARD, 2000, peer).record()
    np.testing.assert_allclose(theirs, ours, atol=1e-3)


def test_row_of_accelerations():
    """The ratio is the median of ratios, not the ratio of medians; the FMU alone has none."""
    times = [(1e-6, 2e-6, 1e-6), (2e-6, 8e-6, 3e-6), (4e-6, 4e-6, 2e-6)]
    assert accelerations.row("R", "axes", times) == ["R", "axes", 2000, *map(pytest.approx, (4000, 2000, 2, 1))]
    name, text, ours, *others = accelerations.row("R", "axes", [(3e-6,), (1e-6,), (2e-6,)])
    assert ours == 2000 and len(others) == 4 and all(map(math.isnan, others))


def test_accelerations_without_pinocchio(monkeypatch, tmp_path):
    """
    The report has a sentence if the package, the compiler or a header is missing in the folders of all Debian releases. So has a quick report that
    would have to compile the program.
    """
    monkeypatch.setattr(accelerations, "FOLDER", tmp_path)
    monkeypatch.setattr(accelerations, "HEADERS", [("here.h", [tmp_path / "elsewhere", tmp_path], "libeigen3-dev")] * 2)
    (tmp_path / "here.h").touch()
    monkeypatch.setattr(accelerations.shutil, "which", lambda name: "/usr/bin/g++")
    with pytest.raises(Missing, match="takes minutes to compile"):
        accelerations.pinocchio_program("aba", True)
    monkeypatch.setattr(accelerations, "HEADERS", [("Eigen/Core", [tmp_path], "libeigen3-dev")] * 2)
    with pytest.raises(Missing, match="needs Eigen/Core .*libeigen3-dev"):
        accelerations.pinocchio_program("aba", False)
    monkeypatch.setattr(accelerations.shutil, "which", lambda name: None)
    with pytest.raises(Missing, match="needs g\\+\\+"):
        accelerations.pinocchio_program("aba", False)
    monkeypatch.setattr(accelerations.importlib.util, "find_spec", lambda name: None)
    assert accelerations.rows(False) == ([], ["No accelerations of robots: Pinocchio (the Python package pin) is not installed here."])


def test_accelerations_of_the_fmu_alone(monkeypatch, tmp_path):
    """If Pinocchio's program does not compile, the report has the first error and the FMU's times."""
    monkeypatch.setattr(accelerations, "FOLDER", tmp_path)
    monkeypatch.setattr(accelerations, "ROUND", 1e-3)
    monkeypatch.setattr(accelerations, "ROBOTS", ROBOTS[:1])

    def fail(name, quick):
        raise RuntimeError("g++ ends with 1: no such type")

    monkeypatch.setattr(accelerations, "pinocchio_program", fail)
    (line,), sentences = accelerations.rows(True)
    assert sentences == ["g++ ends with 1: no such type"] and line[0] == "UR5" and line[2] > 0 and math.isnan(line[4])
