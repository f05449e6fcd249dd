"""The plot of scripts/run: which variables share a panel, positions of names, and events."""

import math
import sys

import numpy as np
import pytest

import fmu
from fmu import ROOT

sys.path.insert(0, str(ROOT))
from scripts.library.simulation import event_times, figure_of, panels_of, simulate  # noqa: E402


def panels(name):
    motion = simulate(fmu.archive(name), {})
    return [names for _, names in panels_of(motion.description, motion.outputs)]


def test_variables_that_share_a_panel():
    """
    Angles of a pendulum share a panel; a motor's angle behind a gear of ratio 20 does not. Rounding errors of resting balls are not
    magnified.
    """
    assert ["theta1", "theta2"] in panels("DoublePendulum")
    assert ["theta"] in panels("MotorPendulum") and ["motor.theta"] in panels("MotorPendulum")
    assert [f"theta[{i}]" for i in range(1, 6)] in panels("NewtonsCradle")


def test_events():
    """Events are marked at the times of a ball's bounces."""
    motion = simulate(fmu.archive("BouncingBall"), {"h": 1.0, "e": 0.8})
    marks = event_times(motion.values)
    fall = math.sqrt(2 / 9.81)
    bounces = [fall * (1 + 2 * sum(0.8**k for k in range(1, i + 1))) for i in range(6)]
    np.testing.assert_allclose(marks[:6], bounces, atol=1e-9)
    assert len(event_times(simulate(fmu.archive("SimplePendulum"), {}).values)) == 0


@pytest.mark.parametrize("name", ["BouncingBall", "Rope"])
def test_names_stand_beside_the_curves(name):
    motion = simulate(fmu.archive(name), {}, stop_time=0.5)
    figure = figure_of(motion.description, motion.outputs, event_times(motion.values))
    figure.savefig("/dev/null", format="png")
    for axes in figure.axes:
        legend = axes.get_legend().get_window_extent()
        assert legend.x0 >= axes.get_window_extent().x1 - 1 and legend.x1 <= figure.bbox.x1 and len(axes.get_legend().get_texts()) <= 9


def figure(name, **options):
    motion = simulate(fmu.archive(name), {}, **options)
    drawn = figure_of(motion.description, motion.outputs)
    drawn.savefig("/dev/null", format="png")
    return drawn


def test_many_of_a_kind_have_a_panel_of_their_own():
    """A rope's 200 heights share one panel, whatever their size; the legend names the first and the last."""
    panel_of = {names[0]: names for names in panels("Rope")}
    assert panel_of["x[1]"] == [f"x[{i}]" for i in range(1, 201)] and panel_of["y[1]"] == [f"y[{i}]" for i in range(1, 201)]
    legends = [[text.get_text() for text in axes.get_legend().get_texts()] for axes in figure("Rope", stop_time=0.1).axes]
    assert ["y[1]", "and 198 between", "y[200]"] in legends


def test_nearly_constant_curves_are_level():
    """
    The spin of a gyrocompass, 2000 rad/s to some 1e-9 of it, has readable ticks. The couplers of equal rods do not rotate: their rounding
    errors are not magnified.
    """
    spin = figure("Gyrocompass").axes[-1]
    low, high = spin.get_ylim()
    assert low < 1999 and high > 2001 and spin.yaxis.get_major_formatter().get_offset() == ""
    low, high = figure("NFourBar").axes[1].get_ylim()
    assert low < -0.1 and high > 0.1


def test_a_long_title_is_within_the_picture():
    drawn = figure("FlyballGovernor", stop_time=0.1)
    title = drawn.axes[0].title.get_window_extent()
    assert title.x0 >= 0 and title.x1 <= drawn.bbox.x1
