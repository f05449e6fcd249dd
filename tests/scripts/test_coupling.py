"""FMUs of this project coupled with each other and with those of other tools, by masters of this project and of others."""

import subprocess
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssd

from coupling import balance, foreign, hinge, oscillator
from coupling.master import Diverged, Master
from coupling.slaves import FMUS, Slave
from fmu import ROOT, unpacked

pytestmark = pytest.mark.release


def test_gains_of_the_archive_are_those_of_lqr():
    """The gains stored in the SSP are those of the LQR for the cart, to their printed digits."""
    for name, gain in balance.lqr_gains().items():
        assert balance.gains_of_ssp()[name] == pytest.approx(gain, rel=1e-11)


def test_lqr_is_optimal():
    """The cost of the linear closed loop, the solution of a Lyapunov equation, increases when any gain changes."""
    from scipy.linalg import solve_continuous_lyapunov

    A, B = balance.linearization()
    gains = np.array(list(balance.lqr_gains().values()))

    def cost(K):
        closed = A - B @ K[None, :]
        weights = np.diag([10.0, 100.0, 1.0, 1.0]) + np.outer(K, K)
        return np.trace(solve_continuous_lyapunov(closed.T, -weights))

    for i in range(4):
        for factor in (0.98, 1.02):
            changed = gains.copy()
            changed[i] *= factor
            assert cost(changed) > cost(gains)


def late_force(forces_at_first, start, gains, step, count):
    """Simulate with a master that applies the force of the previous step, as parallel masters do."""
    cart, feedback = Slave(FMUS / "InvertedPendulumCart.fmu", **start), Slave(FMUS / "StateFeedback.fmu", **gains)
    rows, pending, late = [], list(forces_at_first), 0.0
    for k in range(1, count + 1):
        feedback.set(**dict(zip(balance.STATES, cart.get(*balance.STATES))))
        cart.set(F=pending.pop(0) if pending else late)
        late = feedback.get("F")
        cart.step_to(k * step)
        rows.append(cart.get(*balance.STATES))
    return np.array(rows)


@pytest.mark.parametrize("start", balance.STARTS.values(), ids=balance.STARTS)
@pytest.mark.parametrize("by, initial", [(balance.by_fmpy_ssp, "zero"), (balance.by_libcosim, "first")])
def test_players_of_the_archive(by, initial, start):
    """FMPy's player applies no force in the first two steps, libcosim that of the start in the first."""
    gains, step = balance.gains_of_ssp(), 0.005
    demand = -(gains["ktheta"] * start["theta"] + gains["komega"] * start["omega"])
    rows = by(start, gains, step)
    expected = late_force([0.0, 0.0] if initial == "zero" else [demand], start, gains, step, len(rows))
    np.testing.assert_allclose(rows[:, 1:], expected, atol=1e-9)
    assert np.max(np.abs(rows[-1, 1:])) < 1e-3


def test_archive_is_valid_and_complete():
    structure = read_ssd(str(balance.SSP), validate=True)
    assert [component.name for component in structure.system.elements] == ["cart", "feedback"]


def units(elements):
    """Exponents of base units, by name of the unit."""
    return {unit.get("name"): dict(unit[0].attrib) for unit in elements}


def test_units_of_the_archive_are_defined():
    """
    SSP 1.0 requires units to be defined in the Units of the file that uses them, for parameter values in their set. Each unit agrees with
    that of the FMUs.
    """
    space = "{http://ssp-standard.org/SSP1/SystemStructure%s}"
    ssc, ssd, ssv = (space % name for name in ("Common", "Description", "ParameterValues"))
    with zipfile.ZipFile(balance.SSP) as archive:
        root = ElementTree.fromstring(archive.read("SystemStructure.ssd"))
    connectors = {real.get("unit") for real in root.iter(f"{ssc}Real")}
    files = [(root.find(f"{ssd}Units"), connectors)]
    files += [(values.find(f"{ssv}Units"), {real.get("unit") for real in values.iter(f"{ssv}Real")}) for values in root.iter(f"{ssv}ParameterSet")]
    descriptions = [ElementTree.parse(unpacked(name) / "modelDescription.xml") for name in ("InvertedPendulumCart", "StateFeedback")]
    of_fmus = {name: unit for description in descriptions for name, unit in units(description.iter("Unit")).items()}
    assert len(files) == 3
    for defined, used in files:
        assert defined is not None and units(defined) == {name: of_fmus[name] for name in used}


def test_the_archive_names_a_master_for_omsimulator():
    """
    OMSimulator's command line takes the master from its own annotation of the system, in SSP 1.0 by literal prefixes; it passes the
    tolerance to the FMUs.
    """
    spaces = {"ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
              "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
              "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"}  # fmt: skip
    with zipfile.ZipFile(balance.SSP) as archive:
        text = archive.read("SystemStructure.ssd").decode()
    root = ElementTree.fromstring(text)
    assert root.get("version") == "1.0"
    (annotation,) = root.findall("ssd:System/ssd:Annotations/ssc:Annotation[@type='org.openmodelica']", spaces)
    (master,) = annotation.findall("oms:Annotations/oms:SimulationInformation/oms:FixedStepMaster", spaces)
    assert "<oms:FixedStepMaster" in text
    assert master.get("description") == "oms-ma" and float(master.get("stepSize")) == 0.005
    assert 0 < float(master.get("absoluteTolerance")) <= 1e-6 and 0 < float(master.get("relativeTolerance")) <= 1e-6


def test_push():
    """The force that the script adds moves the cart, and the feedback returns it."""
    gains = balance.lqr_gains()
    push = lambda t: 5.0 * (1.0 <= t < 1.2)
    calm, pushed = (balance.by_fmpy_script(dict(theta=0.0), gains, 0.01, push=p) for p in (None, push))
    assert np.max(np.abs(calm[:, 1:])) == 0.0
    assert np.max(np.abs(pushed[:, 1])) > 0.1 and np.max(np.abs(pushed[-1, 1:])) < 1e-2


@pytest.mark.parametrize("degree", oscillator.DEGREES)
@pytest.mark.parametrize("scheme", oscillator.SCHEMES)
def test_orders(scheme, degree):
    """The order is the degree of the force's polynomial plus one."""
    master = Master(oscillator.M1, oscillator.M2, oscillator.K, oscillator.C, oscillator.OWN)
    errors = []
    for steps in (160, 320):
        states = master.run(scheme, degree, oscillator.START, oscillator.END, steps)
        times = np.linspace(0, oscillator.END, steps + 1)
        exact = oscillator.exact(oscillator.M1, oscillator.M2, oscillator.K, oscillator.C, oscillator.OWN, oscillator.START, times)
        errors.append(np.max(np.abs(states - exact)[:, [0, 2]]))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(degree + 1, abs=0.15)


def limit(scheme, degree, damping=0.2, ratio=1.0):
    k, reduced = 1e4, ratio / (1.0 + ratio)
    master = Master(1.0, ratio, k, 2 * damping * np.sqrt(k * reduced), 1e-3)
    return oscillator.largest_stable_step(master, scheme, degree, np.sqrt(k / reduced))


@pytest.mark.parametrize("ratio", [1.0, 100.0])
def test_limits_of_stability(ratio):
    """
    A force held over the step lags by half a step, which acts as a damping of -k H / 2: the limit is H omega = 4 zeta. With Newton's method
    and a linear force it is H omega = sqrt(12), where k H^2 / 6 mu = 2 without damping.
    """
    assert limit("jacobi", 0, ratio=ratio) == pytest.approx(0.8, rel=0.02)
    assert limit("newton", 1, ratio=ratio) == pytest.approx(np.sqrt(12), rel=0.02)
    assert limit("newton", 0, ratio=ratio) == 100.0


def test_fixed_point_reports_its_failure():
    master = Master(1.0, 1.0, 1e4, 1.0)
    with pytest.raises(Diverged):
        master.run("fixed_point", 1, [1.0, 0.0, 0.0, 0.0], 1.0, 10)


@pytest.fixture(scope="session")
def hinged_pendulum():
    words = [f"-DSYSTEMS={ROOT / 'scripts' / 'coupling' / 'HingedPendulum'}", f"-DTOOLS={ROOT / 'build'}"]
    subprocess.run([ROOT / "scripts" / "build", "build/coupling", *words], check=True)


@pytest.mark.parametrize("scheme, degree, ratio", [
    ("jacobi", 0, 1.0), ("gauss_seidel", 0, 1.0), ("gauss_seidel", 1, 1 / 3), ("gauss_seidel", 2, 1 / 7), ("fixed_point", 1, 1.0),
    ("newton", 2, np.inf),
])  # fmt: skip
def test_limits_of_the_hinge(hinged_pendulum, scheme, degree, ratio):
    """z^(p+1) = -m/M ((p+1) z^p - ...): for Gauss-Seidel z = -1 at m/M = 1 / (2^(p+1) - 1). Beyond this ratio no step is short enough."""
    assert hinge.theory(scheme, degree) == pytest.approx(ratio, rel=0.01)
    assert hinge.limit(scheme, degree) == pytest.approx(ratio, rel=0.03)


@pytest.mark.parametrize("scheme, ratio", [("fixed_point", 0.5), ("newton", 0.5), ("newton", 2.0)])
def test_orders_at_the_hinge(hinged_pendulum, scheme, ratio):
    """The error against the equations of the whole system has the order degree + 1."""
    for degree in oscillator.DEGREES:
        coarse, fine = (hinge.error_of(ratio, scheme, degree, steps) for steps in (200, 400))
        assert np.log2(coarse / fine) == pytest.approx(degree + 1, abs=0.25)


@pytest.mark.parametrize("by", [foreign.by_fmpy, foreign.by_libcosim, foreign.by_ecos])
def test_controller_of_others(by):
    """A controller built by PythonFMU balances the cart under three masters."""
    states = by(foreign.python_controller(), balance.lqr_gains())
    assert np.max(np.abs(states)) < 1e-3


@pytest.mark.parametrize("command, files", [
    ("balance", ["ssp/BalancedCart.ssp", "results/BalancedCart.csv", "results/BalancedCart.png", "results/BalancedCart.gif"]),
])  # fmt: skip
def test_commands(command, files):
    subprocess.run([ROOT / "scripts" / command], check=True, capture_output=True)
    for file in files:
        assert (ROOT / "build" / file).stat().st_size > 1000
