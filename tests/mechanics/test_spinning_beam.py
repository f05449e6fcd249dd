"""
SpinningBeam: a Lagrangian density with Ritz functions, against a rotating rod in tension, published frequencies, and a published motion.
"""

from ctypes import c_double

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model

L, EI, EA, RHO_A = 10.0, 1.4e4, 2.8e7, 1.2
# Frequency of the first bending mode, in sqrt(EI/(rhoA L^4)), at the speed eta in the same unit. Source: A. D. Wright et al., Vibration
# modes of centrifugally stiffened beams, Journal of Applied Mechanics 49, 1982. The values are out of the plane; in the plane the square is
# less by eta^2.
FREQUENCIES = {0: 3.5160, 1: 3.6816, 2: 4.1373, 3: 4.7973, 4: 5.5850, 5: 6.4495, 6: 7.3604}


def tip_stretch(W):
    """Stretch of a rotating rod: EA u'' + rhoA W^2 (s + u) = 0 with u(0) = 0 and u'(L) = 0."""
    k = W * np.sqrt(RHO_A / EA)
    return np.tan(k * L) / k - L


def test_spin_up(open_fmu):
    """
    Motion of Simo and Vu-Quoc: the tip lags by at most 0.58 m, at about 7 s, and returns into line, stretched. Values are read from their
    figure to 0.01 m.
    """
    rows = np.array(open_fmu("SpinningBeam").initialize({}, 1e-9).run(20.0, 0.05, "tipAlong", "tipAcross"))
    time, along, across = rows.T
    assert across.min() == pytest.approx(-0.58, abs=0.01) and time[across.argmin()] == pytest.approx(7.0, abs=0.5)
    late = time > 15
    assert along[late].mean() == pytest.approx(tip_stretch(6.0), rel=2e-3)
    assert np.abs(across[late]).max() < 0.005


@pytest.mark.parametrize("eta", FREQUENCIES)
def test_frequencies(eta, open_fmu):
    """Frequencies are eigenvalues of the linearized motion about steady rotation, by directional derivatives."""
    unit = np.sqrt(EI / (RHO_A * L**4))
    instance = open_fmu("SpinningBeam", kind=FMU2Model).initialize({"W": eta * unit, "T": 1.0}, start_time=2.0)
    instance.fmu.newDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    names = [*(f"w[{i}]" for i in range(1, 4)), *(f"u[{i}]" for i in (1, 2))]
    states = [*names, *(name[0] + "Dot" + name[1:] for name in names)]
    rates = instance.vr(*(f"der({name})" for name in states))

    def jacobian():
        return np.array([instance.fmu.getDirectionalDerivative(rates, instance.vr(state), [1.0]) for state in states]).T

    u = np.zeros(10)
    u[3:5] = -np.linalg.solve(jacobian()[8:10, 3:5], instance.fmu.getReal(rates)[8:10])
    instance.fmu.setContinuousStates((c_double * 10)(*u), 10)
    assert np.abs(instance.fmu.getReal(rates)).max() < 1e-9
    if eta:
        assert instance.get("tipAlong") == pytest.approx(tip_stretch(eta * unit), rel=3e-3)
    lowest = np.sort(np.abs(np.linalg.eigvals(jacobian()).imag))[0]
    published = np.sqrt(FREQUENCIES[eta] ** 2 - eta**2)
    assert 0.9995 * published < lowest / unit < 1.005 * published  # Ritz functions give upper bounds
