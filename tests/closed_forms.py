"""Motions in closed form, to 30 digits and rounded to doubles."""

import functools

import mpmath
import numpy as np


def precisely(function):
    """With 30 digits inside, and doubles as the result."""

    @functools.wraps(function)
    def rounded(*arguments):
        with mpmath.workdps(30):
            result = function(*map(mpmath.mpf, arguments))
            return [float(x) for x in result] if isinstance(result, list) else float(result)

    return rounded


@precisely
def pendulum_angle(theta0, rate, t):
    """Released at rest at theta0, rate = sqrt(g/l): sin(theta/2) = k cd(rate t, k)."""
    k = mpmath.sin(theta0 / 2)
    return 2 * mpmath.asin(k * mpmath.ellipfun("cd", rate * t, m=k * k))


@precisely
def pendulum_half_period(theta0, rate):
    return 2 * mpmath.ellipk(mpmath.sin(theta0 / 2) ** 2) / rate


@precisely
def turning_pendulum_angle(omega0, rate, t):
    """Over the top from the bottom at omega0 > 2 rate: theta = 2 am(omega0 t / 2, 2 rate / omega0)."""
    m = (2 * rate / omega0) ** 2
    u, quarter = omega0 * t / 2, mpmath.ellipk(m)
    turns = mpmath.floor(u / (2 * quarter) + 0.5)
    return 2 * (turns * mpmath.pi + mpmath.asin(mpmath.ellipfun("sn", u - 2 * turns * quarter, m=m)))


@precisely
def kepler(mu, r, omega, t):
    """Position on the ellipse that starts at its pericentre (r, 0) with the angular velocity omega."""
    a = 1 / (2 / r - (r * omega) ** 2 / mu)
    e = 1 - r / a
    mean = mpmath.sqrt(mu / a**3) * t
    turns = mpmath.floor(mean / (2 * mpmath.pi))
    mean -= 2 * mpmath.pi * turns
    solve = lambda E: E - e * mpmath.sin(E) - mean
    anomaly = mpmath.findroot(solve, (mpmath.mpf(0), 2 * mpmath.pi), solver="anderson", tol=1e-50, maxsteps=200, verify=False)
    return [a * (mpmath.cos(anomaly) - e), a * mpmath.sqrt(1 - e * e) * mpmath.sin(anomaly)]


@precisely
def kepler_period(mu, r, omega):
    return 2 * mpmath.pi * mpmath.sqrt(1 / (2 / r - (r * omega) ** 2 / mu) ** 3 / mu)


def pericentre_velocity(mu, a, e):
    """The angular velocity at r = a (1 - e)."""
    return np.sqrt(mu * a * (1 - e * e)) / (a - a * e) ** 2
