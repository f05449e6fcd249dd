"""A seat on a floor with prescribed motion, against the closed form of its frequency response."""

import numpy as np
import pytest

from constrained_systems import check_balance

START = dict(zs=0.0, ms=18.0, md=70.0, ks=7000.0, cs=400.0, kd=50000.0, cd=1000.0)


def response(w):
    """Complex amplitudes of zd, shake, load and the seat's height for a floor of amplitude 1 m, from Newton's law of both masses."""
    seat, driver = START["ms"], START["md"]
    suspension, cushion = START["ks"] + 1j * w * START["cs"], START["kd"] + 1j * w * START["cd"]
    matrix = [[suspension + cushion - seat * w**2, -cushion], [-cushion, cushion - driver * w**2]]
    zs, zd = np.linalg.solve(matrix, [suspension, 0])
    return np.array([zd, -(w**2) * zd, w**2 * (seat * zs + driver * zd), zs])


class Floor:
    """Floor motion z = sin(w t) in cm, set at every communication point."""

    def __init__(self, instance, w):
        self.instance, self.w = instance, w
        self.variables = instance.vr("zb", "der(zb)", "der(der(zb))")

    def derivative(self, order, time):
        return 0.01 * self.w**order * np.sin(self.w * time + order * np.pi / 2)

    def set_input(self, time, highest):
        """Set the input, its derivatives, and the polynomials of each up to this order until the next point."""
        self.instance.fmu.setReal(self.variables, [self.derivative(k, time) for k in range(3)])
        orders = [(k, order) for k in range(3) for order in range(1, highest + 1)]
        values = [self.derivative(k + order, time) for k, order in orders]
        if orders:
            self.instance.fmu.setRealInputDerivatives([self.variables[k] for k, _ in orders], [o for _, o in orders], values)


def shaken(open_fmu, w, step, highest, names, end):
    instance = open_fmu("SeatSuspension").initialize(START | {"der(zb)": 0.01 * w}, 1e-10)
    floor, rows = Floor(instance, w), []
    for i in range(round(end / step)):
        floor.set_input(i * step, highest)
        instance.step(step)
        instance.time = (i + 1) * step
        floor.set_input(instance.time, 0)
        rows.append([instance.time, *instance.fmu.getReal(instance.vr(*names))])
    return np.array(rows)


@pytest.mark.parametrize("w", [2.0, 8.0, 12.0, 40.0])
def test_transmissibility(w, open_fmu):
    """Amplitudes and phases below, at and above the resonance at 9 rad/s and that of the cushion, after the transient."""
    rows = shaken(open_fmu, w, 0.002, 3, ("zd", "shake", "load", "height"), 9.0)
    late = rows[:, 0] > 8.0
    for amplitude, values in zip(response(w), rows.T[1:]):
        expected = 0.01 * (amplitude * np.exp(1j * w * rows[:, 0])).imag
        np.testing.assert_allclose(values[late], expected[late], atol=3e-6 * 0.01 * abs(amplitude))


def test_constant_inputs_are_of_first_order(open_fmu):
    """With constant inputs, half the step gives half the error, as the language reference states."""
    errors = []
    for step in (0.01, 0.005, 0.0025):
        rows = shaken(open_fmu, 8.0, step, 0, ("zd",), 7.0)
        late = rows[:, 0] > 6.0
        exact = 0.01 * (response(8.0)[0] * np.exp(8j * rows[:, 0])).imag
        errors.append(np.max(np.abs(rows[late, 1] - exact[late])))
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.2) and errors[1] / errors[2] == pytest.approx(2, abs=0.1)


def test_work_of_the_floor(open_fmu):
    motions = {"zb": np.polynomial.Polynomial([0, 0.5, -0.3, 0.2])}
    instance = open_fmu("SeatSuspension").initialize({"zs": 0.05, "der(zb)": 0.5, "der(der(zb))": -0.6}, 1e-11)
    check_balance(instance, motions, 2.0, 5, 5.0)
