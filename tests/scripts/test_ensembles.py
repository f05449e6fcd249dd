"""
Many runs at once (src/ensemble) agree with single runs of the FMU, whatever the other runs and the processor. Unsupported runs are left to the FMU.
"""

import ctypes
import subprocess

import mpmath
import numpy as np
import pytest

from building import build_systems
from closed_forms import kepler, pendulum_angle
from ensemble_runs import HERE, alone, assert_as_alone, assert_same_bits, ensemble, starts, states
from fmu import ROOT, archive
from scripts.library.ensembles import includes, source_of

# Ranges of the varied values for each system, and the end. F is an input, and the pivot rotates with time.
SYSTEMS = {
    "DoublePendulum": ({"theta1": (-3, 3), "theta2": (-3, 3), "m2": (0.5, 2), "l1": (0.5, 2)}, 2),
    "SimplePendulum": ({"theta": (-3, 3), "l": (0.3, 3), "m": (0.1, 3)}, 10),
    "InvertedPendulumCart": ({"theta": (-3, 3), "F": (-3, 3), "M": (0.5, 3)}, 3),
    "InvertedPendulumCartTorque": ({"theta": (-3, 3), "F": (-3, 3)}, 3),
    "HeavyTop": ({"vpsi": (100, 200), "theta": (0.3, 1)}, 0.5),
    "ParticlePolar": ({"r": (0.5, 2), "omega": (0.5, 1), "mu": (0.5, 2)}, 3),
    "ParticleSpherical": ({"phi": (0.5, 2), "omegaTheta": (-1, 1)}, 2),
    "ParticleCylindrical": ({"rho": (0.5, 2), "omega": (-1, 1), "Fz": (-1, 1)}, 2),
    "RotatingPivotPendulum": ({"theta": (-3, 3), "l": (0.3, 3)}, 3),
    "DampedPendulum": ({"theta": (-3, 3), "tau": (-3, 3), "b": (0, 1)}, 5),  # by auto, but not stiff; so are the next two
    "ElasticPendulum": ({"theta": (-1, 1), "k": (10, 100), "c": (0, 5)}, 2),
    "Gyrocompass": ({"alpha": (-1, 1), "b": (0, 1e-3)}, 0.1),
    "ChainPendulum": ({"m": (0.5, 2), "l": (0.5, 2)}, 0.5),  # mass matrix factored at run time, as for the next one
    "RobotArm": ({"q[1]": (-0.5, 0.5), "w[3]": (-1, 1)}, 0.5),  # as tables
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_each_run_is_that_of_the_fmu_alone(name):
    """There are more runs than lanes; each takes its own number of steps."""
    # Near its sun a planet's velocity changes by its own magnitude in 0.04 s: 2e-10 s are 5e-9 of it.
    assert_as_alone(name, *SYSTEMS[name], 3 * HERE + 1, 8e-9 if name == "ParticlePolar" else 2e-9)


@pytest.mark.parametrize("name", ["DoublePendulum", "RotatingPivotPendulum", "ParticlePolar"])
def test_a_run_has_the_same_bits_among_any_others(name):
    assert_same_bits(name, *SYSTEMS[name])


def test_pendulums_in_closed_form():
    """Released at rest, with different angles and lengths."""
    rows, times = starts({"theta": (-3, 3), "l": (0.3, 3)}, 60), [0.1, 1.0, 7.0]
    values, _ = ensemble("SimplePendulum", ["theta", "l"], ["theta"], times).run(rows)
    exact = [[pendulum_angle(theta, np.sqrt(9.81 / l), t) for t in times] for theta, l in rows]
    np.testing.assert_allclose(values[:, :, 0], exact, atol=1e-9)


def test_orbits_in_closed_form():
    """Start at the pericentre, with different masses of the centre."""
    rows, time = starts({"mu": (0.5, 0.9), "omega": (1, 1.2)}, 60), 10.0
    rows = rows[rows[:, 1] ** 2 < 1.8 * rows[:, 0]]
    values, _ = ensemble("ParticlePolar", ["mu", "omega"], ["r", "theta"], [time]).run(rows)
    r, theta = values[:, 0].T
    exact = np.array([kepler(mu, 1, omega, time) for mu, omega in rows])
    np.testing.assert_allclose(np.array([r * np.cos(theta), r * np.sin(theta)]).T, exact, atol=1e-8)
    assert len(rows) > 20


def test_looser_tolerances_take_lower_orders():
    rows = starts({"theta": (-3, 3)}, 100)
    exact, _ = ensemble("SimplePendulum", ["theta"], ["theta"], [5], tolerance=1e-13).run(rows)
    for tolerance in (1e-4, 1e-7):
        values, _ = ensemble("SimplePendulum", ["theta"], ["theta"], [5], tolerance=tolerance).run(rows)
        assert 1e-3 * tolerance < np.max(np.abs(values - exact)) < 100 * tolerance


SYSTEM = '<system name="{name}"><coordinate name="x" velocity="v"/><particle name="p" mass="1" x="x"/>{more}<solver method="taylor"/></system>'
HILL = '<parameter name="k" start="400"/><potential>exp(-k*(x - 1)^2)</potential><output name="inverse">1/x</output><output name="push">der(v)</output>'
STIFF = '<parameter name="b" start="0"/><potential>b*1e3*x^2/2</potential><dissipation>b*v^2/2</dissipation>'


@pytest.fixture(scope="module")
def of_tests():
    build_systems("ensembles", {name: SYSTEM.format(name=name, more=more) for name, more in (("Hill", HILL), ("Stiff", STIFF))})


def test_a_narrow_hill_is_not_passed_over(of_tests):
    """exp is flat where the particle starts. The hill delays it by the integral of 1/sqrt(v0^2 - 2 V) - 1/v0, or reflects it."""
    values, needs_fmu = ensemble("Hill", ["v"], ["x", "v"], [2.0]).run([[1.3], [1.4143], [1.5], [2.0], [3.0]])
    assert not needs_fmu.any()
    assert values[0, 0, 1] == pytest.approx(-1.3, abs=1e-8) and values[0, 0, 0] < 0
    for speed, value in zip((1.5, 2.0, 3.0), values[2:, 0]):
        delay = mpmath.quad(lambda x: 1 / mpmath.sqrt(speed**2 - 2 * mpmath.exp(-400 * (x - 1) ** 2)) - 1 / mpmath.mpf(speed), [0, 0.8, 0.9, 1, 1.1, 1.2, 2])
        assert value == pytest.approx([speed * (2.0 - float(delay)), speed], abs=1e-7)


def test_values_of_accelerations(of_tests):
    """The force of the hill, 2 k (x - 1) exp(-k (x - 1)^2); and a value that is not finite at the start only."""
    rows = [[0.95], [1.02], [0.0]]
    values, needs_fmu = ensemble("Hill", ["x"], ["push", "inverse"], [0, 1e-6]).run(rows)
    assert list(needs_fmu) == [False, False, True]
    for (x,), value in zip(rows[:2], values):
        assert value[0] == pytest.approx([800 * (x - 1) * np.exp(-400 * (x - 1) ** 2), 1 / x], rel=1e-12)


def test_a_stiff_run_is_left_alone(of_tests):
    """
    Nearly x' = -1000 x, which takes a million steps: the run is left to the FMU, whose message gives the cause. The other run is
    unaffected.
    """
    values, needs_fmu = ensemble("Stiff", ["b", "x", "v"], ["x"], [10.0]).run([[1e5, 1e-3, 0.0], [0.0, 1.0, 2.0]])
    assert list(needs_fmu) == [True, False] and values[1, 0, 0] == pytest.approx(21, rel=1e-14)


def test_where_auto_may_hand_over_is_left_to_it():
    """Springs so stiff that they limit the steps of the series are left to the FMU, beside soft ones."""
    rows = np.array([[1e6, 1e4], [50.0, 1.0], [1e5, 1e4]])
    values, needs_fmu = ensemble("ElasticPendulum", ["k", "c"], states("ElasticPendulum"), [2.0]).run(rows)
    assert list(needs_fmu) == [True, False, True] and np.all(np.isfinite(values[1]))


def test_runs_that_the_fmu_rejects_need_it():
    """
    A length below its minimum, for which the equations do have a motion; and masses so different that the matrix is singular to 14 digits.
    """
    assert list(ensemble("SimplePendulum", ["l"], ["theta"], [1.0]).run([[-1.0], [1.0]])[1]) == [True, False]
    one = ensemble("DoublePendulum", ["m1", "theta1", "theta2"], ["theta1"], [0.1])
    assert list(one.run([[1e-15, 1.0, 1.0], [1.0, 1.0, 1.0]])[1]) == [True, False]


def test_tolerances_beyond_rounding():
    """A defect within rounding does not end a run; long sums of steps use compensated summation."""
    rows, time = starts({"theta": (-3, 3)}, 30), 20.0
    values, needs_fmu = ensemble("SimplePendulum", ["theta"], ["theta"], [time], tolerance=1e-16).run(rows)
    exact = [pendulum_angle(theta, np.sqrt(9.81), time) for (theta,) in rows]
    assert not needs_fmu.any()
    np.testing.assert_allclose(values[:, 0, 0], exact, atol=1e-12)


def test_runs_without_a_solution_are_left_alone():
    """A particle on the axis of its coordinates, an invalid mass, and NaN affect no other run."""
    ranges, recorded = {"phi": (0.5, 2), "m": (0.5, 2)}, states("ParticleSpherical")
    rows = starts(ranges, 40)
    one = ensemble("ParticleSpherical", ranges, recorded, [0, 1])
    values, needs_fmu = one.run(rows)
    assert not needs_fmu.any()
    bad = rows.copy()
    bad[3, 0], bad[4, 1], bad[17, 1], bad[39, 0] = 0.0, 0.0, -1.0, np.nan
    others, needs_fmu = one.run(bad)
    assert list(np.flatnonzero(needs_fmu)) == [3, 4, 17, 39] and np.all(np.isnan(others[needs_fmu]))
    np.testing.assert_array_equal(others[~needs_fmu], values[~needs_fmu])


def test_runs_that_end_in_a_singularity_are_left_alone():
    """Some particles fall into the centre of attraction, from r = 1 after pi/(2 sqrt(2)); others pass it."""
    rows = np.array([[0.0], [0.5], [0.0], [1.0]])
    values, needs_fmu = ensemble("ParticlePolar", ["omega"], ["r", "vr"], [1.0, 1.2]).run(rows)
    assert list(needs_fmu) == [True, False, True, False] and np.all(np.isfinite(values[1::2]))


def test_unsupported_systems_and_values():
    """Exact methods, systems without states, and values that are neither Real nor states are unsupported."""
    for name in ("ParticleCartesian", "StateFeedback"):
        assert source_of(archive(name)) is None, name
    assert not ensemble("SimplePendulum", ["theta"], ["solverSteps"], [1]).supports()
    assert not ensemble("SimplePendulum", ["der(theta)"], ["theta"], [1]).supports()
    assert ensemble("SimplePendulum", ["theta"], ["theta", "kineticEnergy"], [1]).supports()


FUNCTIONS = ["exp(x)", "exp(-x^2)", "1/log(2 + x)", "log(3 + x)", "sin(3*x)*cos(x)", "tan(x/2)", "asin(x/3)", "acos(x/3)", "atan(2*x)", "sinh(x)", "cosh(x)", "tanh(4*x)",
             "asinh(x)", "acosh(3 + x)", "atanh(x/3)", "sqrt(2 + x)", "1/sqrt(2 + x)", "(3 + x)^2.5", "(2 + x^2)^n", "x^3", "1/(2 + x)", "1/(2 + x)^2", "1/(2 + x)^3", "x^5", "x^4",
             "1/(4 + x)^4", "atan2(x, 1 + x^2)", "(1 + x^2)/(3 - x)", "sin(time + x)"]  # fmt: skip


@pytest.mark.parametrize("form", ["statements", "tables"])
def test_functions_and_their_series(form):
    """Each function is the potential of a particle, whose force is its derivative; a start value depends on a parameter."""
    particles = "".join(
        f'<coordinate name="x{i}" velocity="v{i}" start="n/{i + 3}"/><particle name="p{i}" mass="m" x="x{i}"/><potential>{function.replace("exp", "EXP").replace("x", f"x{i}").replace("EXP", "exp")}</potential>'
        for i, function in enumerate(FUNCTIONS)
    )
    head = '<parameter name="m" start="1"/><parameter name="n" start="1.5"/>'
    name = f"FunctionsIn{form.title()}"
    build_systems("ensembles", {name: f'<system name="{name}">{head}{particles}<solver method="taylor"/></system>'}, "--form", form)
    ranges = {"m": (1, 2), "n": (0.5, 2.5), **{f"x{i}": (-0.7, 0.7) for i in range(len(FUNCTIONS) - 3)}}
    rows, recorded = starts(ranges, HERE + 3), states(name)
    values, needs_fmu = ensemble(name, ranges, recorded, [0.4]).run(rows)
    assert not needs_fmu.any()
    for row, value in zip(rows, values):
        np.testing.assert_allclose(value[0], alone(name, dict(zip(ranges, row)), recorded, 0.4)[-1], rtol=1e-9, atol=1e-9)


SINES = """
#include "lane_functions.h"
void sines(size_t count, const double *x, double *s, double *c) {
  for (size_t i = 0; i < count; i += LANES) {
    Lanes lanes, sine, cosine;
    memcpy(&lanes, x + i, sizeof lanes);
    sine = lanes_sin(lanes);
    cosine = lanes_cos(lanes);
    memcpy(s + i, &sine, sizeof sine);
    memcpy(c + i, &cosine, sizeof cosine);
  }
}
"""


def test_sines(tmp_path):
    """
    The error is below 1.5 units in the last place, also near multiples of quarter turns and for large arguments; the sine of infinity is
    NaN.
    """
    (tmp_path / "sines.c").write_text(SINES)
    flags = [f"@{ROOT / 'src' / 'ensemble' / f'lanes{lanes}.flags'}" for lanes in ("", HERE)]
    command = ["cc", *flags, "-fPIC", "-shared", *map(str, includes(ROOT)), tmp_path / "sines.c", "-o", tmp_path / "sines.so", "-fvisibility=default", "-lm"]
    subprocess.run(command, check=True)
    generator = np.random.default_rng(3)
    quarters = np.arange(-2000, 2000) * (np.pi / 2)
    x = np.concatenate([generator.uniform(-4, 4, 4000), generator.uniform(-1.1e5, 1.1e5, 4000), quarters, quarters * (1 + 1e-15), 10.0 ** generator.uniform(-300, 300, 4000)])
    s, c = np.empty_like(x), np.empty_like(x)
    ctypes.CDLL(str(tmp_path / "sines.so")).sines(ctypes.c_size_t(len(x)), *(ctypes.c_void_p(a.ctypes.data) for a in (x, s, c)))
    with mpmath.workprec(1200):
        for function, values in ((mpmath.sin, s), (mpmath.cos, c)):
            exact = [function(mpmath.mpf(a)) for a in x]
            errors = [abs(value - e) / np.spacing(abs(float(e))) for value, e in zip(values, exact)]
            assert max(errors) < 1.5
    nowhere = np.full(8, np.inf)
    ctypes.CDLL(str(tmp_path / "sines.so")).sines(ctypes.c_size_t(8), *(ctypes.c_void_p(a.ctypes.data) for a in (nowhere, s, c)))
    assert np.all(np.isnan(s[:8]) & np.isnan(c[:8]))
