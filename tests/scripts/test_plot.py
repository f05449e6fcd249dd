"""The plot that scripts/run leaves: what is drawn together, where names stand, and events."""

import math
import sys

import numpy as np
import pytest

import fmu
from fmu import ROOT

sys.path.insert(0, str(ROOT))
from scripts.simulation import event_times, figure_of, panels_of, simulate  # noqa: E402


def panels(name):
    motion = simulate(fmu.archive(name), {})
    return [names for _, names in panels_of(motion.description, motion.outputs)]


def test_what_is_drawn_together():
    """Angles of a pendulum are; that of a motor whose gear has a ratio of 20 is not, nor are balls that rest but for rounding drawn large."""
    assert ["theta1", "theta2"] in panels("DoublePendulum")
    assert ["theta"] in panels("MotorPendulum") and ["motor.theta"] in panels("MotorPendulum")
    assert [f"theta[{i}]" for i in range(1, 6)] in panels("NewtonsCradle")


def test_events():
    """A ball's bounces, each within a step of the results before its mark."""
    motion = simulate(fmu.archive("BouncingBall"), {"h": 1.0, "e": 0.8})
    marks = event_times(motion.values)
    fall = math.sqrt(2 / 9.81)
    bounces = [fall * (1 + 2 * sum(0.8**k for k in range(1, i + 1))) for i in range(6)]
    step = motion.values["time"][1]
    assert np.all((marks[:6] >= bounces) & (marks[:6] - bounces <= step * (1 + 1e-9)))
    assert len(event_times(simulate(fmu.archive("SimplePendulum"), {}).values)) == 0


@pytest.mark.parametrize("name", ["BouncingBall", "Rope"])
def test_names_stand_beside_the_curves(name):
    motion = simulate(fmu.archive(name), {}, stop_time=0.5)
    figure = figure_of(motion.description, motion.outputs, event_times(motion.values))
    figure.savefig("/dev/null", format="png")
    for axes in figure.axes:
        legend = axes.get_legend().get_window_extent()
        assert legend.x0 >= axes.get_window_extent().x1 - 1 and legend.x1 <= figure.bbox.x1 and len(axes.get_legend().get_texts()) <= 9
