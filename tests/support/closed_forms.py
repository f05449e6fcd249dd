"""Motions in closed form, computed with 30 digits and rounded to doubles."""

import functools

import mpmath
import numpy as np


def precisely(function):
    """Evaluate a function with 30 digits and round its result to doubles."""

    @functools.wraps(function)
    def rounded(*arguments):
        with mpmath.workdps(30):
            result = function(*map(mpmath.mpf, arguments))
            return [float(x) for x in result] if isinstance(result, list) else float(result)

    return rounded


@precisely
def pendulum_angle(theta0, rate, t):
    """Angle of a pendulum released at rest at theta0, with rate = sqrt(g/l): sin(theta/2) = k cd(rate t, k)."""
    k = mpmath.sin(theta0 / 2)
    return 2 * mpmath.asin(k * mpmath.ellipfun("cd", rate * t, m=k * k))


@precisely
def pendulum_half_period(theta0, rate):
    return 2 * mpmath.ellipk(mpmath.sin(theta0 / 2) ** 2) / rate


@precisely
def turning_pendulum_angle(omega0, rate, t):
    """
    Angle of a pendulum that starts at the bottom with omega0 > 2 rate and goes over the top: theta = 2 am(omega0 t / 2, 2 rate / omega0).
    """
    m = (2 * rate / omega0) ** 2
    u, quarter = omega0 * t / 2, mpmath.ellipk(m)
    turns = mpmath.floor(u / (2 * quarter) + 0.5)
    return 2 * (turns * mpmath.pi + mpmath.asin(mpmath.ellipfun("sn", u - 2 * turns * quarter, m=m)))


@precisely
def kepler(mu, r, omega, t):
    """Position on the ellipse that starts at its pericentre (r, 0) with angular velocity omega, by Kepler's equation."""
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
    """Angular velocity at the pericentre r = a (1 - e)."""
    return np.sqrt(mu * a * (1 - e * e)) / (a - a * e) ** 2


def top_cubic(A, C, weight, theta, vphi, vtheta, vpsi):
    """Cubic (du/dt)^2 of a heavy symmetric top with u = cos(theta): its roots in ascending order, and its leading coefficient."""
    spin = C * (vpsi + vphi * mpmath.cos(theta)) / A
    upright = mpmath.sin(theta) ** 2 * vphi + spin * mpmath.cos(theta)
    beta = 2 * weight / A
    alpha = vtheta**2 + mpmath.sin(theta) ** 2 * vphi**2 + beta * mpmath.cos(theta)
    coefficients = [beta, -alpha - spin**2, 2 * spin * upright - beta, alpha - upright**2]
    return sorted(mpmath.re(root) for root in mpmath.polyroots(coefficients, maxsteps=200, extraprec=200)), beta


@precisely
def top_nutation(*top):
    """
    Least and largest cos(theta) and the period of nutation of a heavy top. A, C: moments of inertia about its tip and its axis; weight: m g
    times the distance of the centre of mass; start: theta, vphi, vtheta, vpsi.
    """
    (low, high, far), beta = top_cubic(*top)
    return [low, high, 4 * mpmath.ellipk((high - low) / (far - low)) / mpmath.sqrt(beta * (far - low))]


@precisely
def top_cosine(A, C, weight, theta, vphi, vtheta, vpsi, t):
    """Nutation of a heavy top: cos(theta) = low + (high - low) sn^2."""
    (low, high, far), beta = top_cubic(A, C, weight, theta, vphi, vtheta, vpsi)
    m, rate = (high - low) / (far - low), mpmath.sqrt(beta * (far - low)) / 2
    share = min(max((mpmath.cos(theta) - low) / (high - low), 0), 1)
    phase = mpmath.ellipf(mpmath.asin(mpmath.sqrt(share)), m) * (-1 if vtheta > 0 else 1)
    return low + (high - low) * mpmath.ellipfun("sn", rate * t + phase, m=m) ** 2


@precisely
def free_body_velocity(I1, I2, I3, w1, w2, w3, t):
    """Angular velocity of a free rigid body along its principal axes, I1 < I2 < I3, by Jacobi's elliptic functions."""
    twice = I1 * w1**2 + I2 * w2**2 + I3 * w3**2
    square = (I1 * w1) ** 2 + (I2 * w2) ** 2 + (I3 * w3) ** 2
    exchanged = square < twice * I2  # the same formula applies with the first and the last axis exchanged
    if exchanged:
        (I1, w1), (I3, w3) = (I3, w3), (I1, w1)
    low, high = twice * I3 - square, square - twice * I1
    first, second = mpmath.sqrt(low / (I1 * (I3 - I1))), mpmath.sqrt(low / (I2 * (I3 - I2)))
    last, rate = mpmath.sqrt(high / (I3 * (I3 - I1))), mpmath.sqrt((I3 - I2) * high / (I1 * I2 * I3))
    m, sign = (I2 - I1) * low / ((I3 - I2) * high), 1 if w3 >= 0 else -1
    phase = mpmath.ellipf(mpmath.atan2(w2 / second, sign * w1 / first), m)
    sn, cn, dn = (mpmath.ellipfun(kind, rate * t + phase, m=m) for kind in ("sn", "cn", "dn"))
    velocities = [sign * first * cn, second * sn, sign * last * dn]
    return velocities[::-1] if exchanged else velocities
