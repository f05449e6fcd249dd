"""Poles, frequency responses and step responses of linearized systems, against transfer functions in closed form."""

import math
import subprocess
import sys

import numpy as np
import pytest

import fmu
import package
from building import build_systems
from motions import OSCILLATOR, lagrange_fmu  # noqa: F401

# Two free masses of 1 kg with a spring between them and a force on each, without damping.
ROW = """<system name="Row"><input name="F" unit="N"/><input name="G" unit="N"/><coordinate name="x" velocity="v" unit="m"/><coordinate name="y" velocity="w" unit="m"/>
  <particle mass="1" x="x"/><particle mass="1" x="y"/><potential>8*(x - y)^2/2</potential><force coordinate="x">F</force><force coordinate="y">G</force></system>"""
# An actuator with a lag of 0.5 s, and a direct path.
LAG = """<system name="Lag"><input name="u" unit="1"/><state name="z" rate="(u - z)/0.5" unit="1"/><output name="y" unit="1">3*z + 2*u</output></system>"""
# A mass that lies on a floor, held by a spring sideways.
LYING = """<system name="Lying"><input name="F" unit="N"/><coordinate name="x" velocity="v" unit="m"/><coordinate name="h" velocity="u" unit="m"/><particle mass="2" x="x" y="h"/>
  <gravity y="-9.81"/><potential>18*x^2/2</potential><dissipation>4*v^2/2</dissipation><contact name="floor" gap="h" unit="m"/><force coordinate="x">F</force></system>"""

# A blade that runs at 8 m/s.
SKATE = """<system name="FastSkate"><input name="M" unit="N.m"/><coordinate name="x" velocity="vx" unit="m" velocityStart="8"/><coordinate name="y" velocity="vy" unit="m"/>
  <coordinate name="phi" velocity="w" unit="rad"/><body name="b" mass="5" x="x" y="y" inertia="2" angle="phi"/><force coordinate="phi">M</force>
  <constraint name="blade" unit="m/s">vx*sin(phi) - vy*cos(phi)</constraint></system>"""


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("responses", {"FastSkate": SKATE, "Oscillator": OSCILLATOR, "Row": ROW, "Lag": LAG, "Lying": LYING})


@pytest.fixture(scope="module")
def oscillator(lagrange_fmu):  # noqa: F811
    return lagrange_fmu.linearize(fmu.archive("Oscillator"), {"x": 0})


def test_poles(oscillator):
    """m s^2 + d s + k = 0 with m = 2, d = 1, k = 50."""
    np.testing.assert_allclose(oscillator.poles(), [-0.25 - 1j * math.sqrt(25 - 1 / 16), -0.25 + 1j * math.sqrt(25 - 1 / 16)], rtol=1e-13)


def test_coordinates_are_states_first(lagrange_fmu):  # noqa: F811
    """At every speed v the velocity across the blade is v phi, and the angle is a state."""
    for v in (1, 8, 30):
        with pytest.warns(UserWarning, match=r"not an equilibrium: der\(x\)"):
            found = lagrange_fmu.linearize(fmu.archive("FastSkate"), {"vx": v})
        assert found.states == ["x", "y", "phi", "vx", "w"]
        expected = np.zeros((5, 5))
        expected[0, 3] = expected[2, 4] = 1
        expected[1, 2] = v
        np.testing.assert_allclose(found.A, expected, atol=1e-8 * v)
        np.testing.assert_allclose(found.B, [[0], [0], [0], [0], [0.5]], atol=1e-10)


def test_frequency_response(oscillator):
    """1/(k - m w^2 + d w i); the velocity has w i times that."""
    found = oscillator.bode(frequencies=[0, 1, 5, 100])
    exact = 1 / (50 - 2 * found.frequency**2 + 1j * found.frequency)
    np.testing.assert_allclose(found["x"], exact, rtol=1e-12)
    np.testing.assert_allclose(found["v", "F"], 1j * found.frequency * exact, rtol=1e-12, atol=1e-17)
    place = found.outputs.index("x")
    np.testing.assert_allclose(found.magnitude[:, place, 0], np.abs(exact), rtol=1e-12)
    np.testing.assert_allclose(found.phase[:, place, 0], -np.degrees(np.arctan2(found.frequency, 50 - 2 * found.frequency**2)), atol=1e-10)
    whole = oscillator.bode("x")
    assert whole.frequency[0] == pytest.approx(0.5) and whole.frequency[-1] == pytest.approx(50) and (np.diff(whole.frequency) > 0).all()
    assert np.abs(whole["x"]).max() == pytest.approx(1 / (5 * math.sqrt(1 - 1 / 400)), rel=2e-3)  # of the resonance, which is near a frequency of the grid


def test_step_response(oscillator):
    """1/k (1 - e^(-a t) (cos(w t) + a/w sin(w t)))."""
    found = oscillator.step("x")
    a, w, t = 0.25, math.sqrt(25 - 1 / 16), found.time
    exact = (1 - np.exp(-a * t) * (np.cos(w * t) + a / w * np.sin(w * t))) / 50
    np.testing.assert_allclose(found["x"], exact, atol=1e-14)
    assert t[0] == 0 and t[-1] == pytest.approx(7 / 0.25)
    uneven = oscillator.step("x", "F", times=[0.3, 1, 20])
    np.testing.assert_allclose(uneven["x"], np.interp(uneven.time, t, exact), atol=1e-4)


def test_several_inputs_and_poles_at_zero(lagrange_fmu):  # noqa: F811
    """
    x/F = (s^2 + 8)/(s^2 (s^2 + 16)) and x/G = 8/(s^2 (s^2 + 16)). The step responses to F are t^2/4 + (1 - cos(4 t))/32 for x, and
    t^2/4 - (1 - cos(4 t))/32 for y.
    """
    linear = lagrange_fmu.linearize(fmu.archive("Row"))
    found = linear.bode(["x"], frequencies=[1, 2, 4, 7])
    w = found.frequency[[0, 1, 3]]
    np.testing.assert_allclose(found["x", "F"][[0, 1, 3]], (8 - w**2) / (-(w**2) * (16 - w**2)), rtol=1e-12)
    np.testing.assert_allclose(found["x", "G"][[0, 1, 3]], 8 / (-(w**2) * (16 - w**2)), rtol=1e-12)
    assert abs(found["x", "F"][2]) > 1e14  # at the pole
    steps = linear.step()
    t = steps.time
    np.testing.assert_allclose(steps["x", "F"], t**2 / 4 + (1 - np.cos(4 * t)) / 32, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(steps["y", "F"], t**2 / 4 - (1 - np.cos(4 * t)) / 32, rtol=1e-11, atol=1e-13)
    assert t[-1] == pytest.approx(6 * 2 * math.pi / 4, rel=1e-6)


def test_states_of_first_order(lagrange_fmu):  # noqa: F811
    """The step response of 3/(1 + s/2) + 2 begins at 2 and ends at 5."""
    linear = lagrange_fmu.linearize(fmu.archive("Lag"))
    assert linear.poles() == pytest.approx([-2])
    step, bode = linear.step(), linear.bode()
    np.testing.assert_allclose(step["y"], 2 + 3 * (1 - np.exp(-2 * step.time)), rtol=1e-13)
    np.testing.assert_allclose(bode["y"], 3 / (1 + 0.5j * bode.frequency) + 2, rtol=1e-13)


def test_closed_contacts_are_named(lagrange_fmu):  # noqa: F811
    """The denominator is 2 s^2 + 4 s + 18: the closed contact fixes the height, and the figure names it."""
    linear = lagrange_fmu.linearize(fmu.archive("Lying"))
    np.testing.assert_allclose(np.sort_complex(linear.poles()), np.sort_complex(np.roots([2, 4, 18])), rtol=1e-8)
    for response in (linear.bode("x"), linear.step("x")):
        figure = response.plot()
        assert "with floor closed or sticking" in figure.axes[0].get_title() and response._repr_png_().startswith(b"\x89PNG")
    figure = linear.bode(["x", "v"]).plot()
    magnitude, phase = figure.axes
    assert magnitude.get_ylabel() == "magnitude [dB]" and phase.get_ylabel() == "phase [deg]" and phase.get_xlabel() == "frequency [rad/s]"
    assert [text.get_text() for text in magnitude.get_legend().get_texts()] == ["x by F", "v by F"]
    line = magnitude.get_lines()[0]
    np.testing.assert_allclose(line.get_ydata(), -20 * np.log10(np.abs(18 - 2 * line.get_xdata() ** 2 + 4j * line.get_xdata())), atol=1e-6)


@pytest.mark.parametrize("code, message", [
    ("linear.bode('z')", "'z' is not an output of the linearization; these are: x, v"),
    ("linear.step('x', 'f')", "'f' is not an input of the linearization; did you mean 'F'?"),
    ("linear.bode()['x', 'H']", "'H' is not an input"),
    ("linear.bode(frequencies=[2, 1])", "the frequencies are not finite, increasing and at least 0"),
    ("linear.bode(frequencies=[])", "the frequencies are not finite"),
    ("linear.step(times=[0, float('nan')])", "the times are not finite"),
    ("linear.step(times=[-1, 1])", "the times are not finite"),
    ("linear._replace(outputs=[]).bode()", "the linearization has no output"),
])  # fmt: skip
def test_mistakes(code, message, oscillator, lagrange_fmu):  # noqa: F811
    with pytest.raises(lagrange_fmu.Problem, match=None) as problem:
        eval(code, {"linear": oscillator})
    assert str(problem.value).startswith(message), problem.value


def test_without_matplotlib(tmp_path):
    """The arrays exist, and plotting names the missing package."""
    (tmp_path / "matplotlib.py").write_text("raise ModuleNotFoundError(name='matplotlib')")
    code = f"import lagrange_fmu\nfound = lagrange_fmu.linearize({str(fmu.archive('Lag'))!r}).step()\nprint(found['y'][0])\nfound.plot()"
    environment = package.environment(package.assemble(tmp_path / "package"))
    environment["PYTHONPATH"] = f"{tmp_path}:{environment['PYTHONPATH']}"
    result = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert result.stdout == "2.0\n" and "Problem: matplotlib is not installed; it comes with pip install matplotlib" in result.stderr
