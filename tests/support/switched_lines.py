"""
Linear systems with contacts and dry friction, from event to event. Matrix exponentials give the motion between events, samples and
bisection their times. After an event each combination of modes is tried.
"""

import itertools

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

TOUCHING, RESTING, SHORT_FLIGHT, SAMPLE, AHEAD = 1e-9, 1e-9, 1e-6, 0.002, 1e-7


class Redundant(Exception):
    """The active constraints are linearly dependent, so that their forces are indeterminate."""


class Line:
    """
    System M a = load @ (x, v, 1, cos(w t), sin(w t)), less friction[i] along each velocity rows[i] @ v, with gaps @ x + offsets >= 0 and
    restitution.
    """

    def __init__(self, mass, load, rate, gaps, offsets, restitution, rows, friction):
        self.mass, self.load, self.rate = np.array(mass), np.array(load), rate
        self.n = len(mass)
        self.gaps, self.offsets, self.restitution = np.array(gaps), np.array(offsets), restitution
        self.rows, self.friction = np.array(rows), np.array(friction)
        self.size = 2 * self.n + 3
        self.impacts = 0

    def velocity(self, z):
        return z[self.n : 2 * self.n]

    def gap(self, z):
        return self.gaps @ z[: self.n] + self.offsets

    def closed_rows(self, closed, modes):
        """Rows of the active constraints: closed contacts, then sticking frictions."""
        return np.vstack([self.gaps[list(closed)], self.rows[[i for i, mode in enumerate(modes) if mode == 0]]])

    def linear(self, closed, modes):
        """Accelerations, and forces along the active rows, as matrices that multiply z."""
        rows = self.closed_rows(closed, modes)
        load = self.load.copy()
        for i, mode in enumerate(modes):
            load[:, 2 * self.n] -= mode * self.friction[i] * self.rows[i]
        count = len(rows)
        matrix = np.block([[self.mass, rows.T], [rows, np.zeros((count, count))]])
        solution = np.linalg.pinv(matrix, rcond=1e-12) @ np.vstack([load, np.zeros((count, self.size))])
        return solution[: self.n], solution[self.n :]

    def flow(self, accelerations):
        n = self.n
        matrix = np.zeros((self.size, self.size))
        matrix[:n, n : 2 * n] = np.eye(n)
        matrix[n : 2 * n] = accelerations
        matrix[2 * n + 1, 2 * n + 2], matrix[2 * n + 2, 2 * n + 1] = -self.rate, self.rate
        return matrix

    def stays(self, closed, modes, forces):
        """Rows whose products with z are nonnegative as long as the modes apply."""
        n, rows = self.n, []
        for i in range(len(self.gaps)):
            row = np.zeros(self.size)
            row[:n], row[2 * n] = self.gaps[i], self.offsets[i]
            rows.append(-forces[list(closed).index(i)] if i in closed else row)
        stuck = len(closed)
        for i, mode in enumerate(modes):
            row = np.zeros(self.size)
            if mode == 0:
                row[2 * n] = self.friction[i]
                rows += [row - forces[stuck], row + forces[stuck]]
                stuck += 1
            else:
                row[n : 2 * n] = mode * self.rows[i]
                rows.append(row)
        return np.array(rows)

    def collide(self, z):
        inverse = np.linalg.inv(self.mass)
        for _ in range(10000):
            touching = self.gap(z) <= TOUCHING
            rates = np.where(touching, self.gaps @ self.velocity(z), 0.0)
            if not len(rates) or rates.min() >= -RESTING:
                return
            row = self.gaps[rates.argmin()]
            z[self.n : 2 * self.n] -= (1 + self.restitution) * rates.min() * (inverse @ row) / (row @ inverse @ row)
            self.impacts += 1
        raise AssertionError("impacts without end")

    def rest(self, z):
        """Contacts and frictions at rest; remove the rounding errors of their velocities from z."""
        free, _ = self.linear([], np.sign(self.rows @ self.velocity(z)))
        rates, falls = self.gaps @ self.velocity(z), -self.gaps @ (free @ z)
        close = [
            i
            for i in np.flatnonzero(self.gap(z) <= TOUCHING)
            if rates[i] <= RESTING or (falls[i] > 0 and 2 * rates[i] < SHORT_FLIGHT * falls[i])
        ]
        slow = list(np.flatnonzero(abs(self.rows @ self.velocity(z)) <= RESTING))
        rows = np.vstack([self.gaps[close], self.rows[slow]])
        inverse = np.linalg.inv(self.mass)
        z[self.n : 2 * self.n] -= inverse @ rows.T @ np.linalg.pinv(rows @ inverse @ rows.T, rcond=1e-12) @ rows @ self.velocity(z)
        return close, slow

    def modes(self, z):
        """Modes that apply next: the first combination that a short motion confirms, tried in descending order of active constraints."""
        self.collide(z)
        close, slow = self.rest(z)
        modes = np.sign(self.rows @ self.velocity(z)).astype(int)
        redundant = False
        signs = sorted(itertools.product((0, 1, -1), repeat=len(slow)), key=lambda trial: sum(map(abs, trial)))
        for choice in signs:
            for count in range(len(close), -1, -1):
                for closed in itertools.combinations(close, count):
                    trial = modes.copy()
                    trial[slow] = choice
                    rows = self.closed_rows(closed, trial)
                    redundant |= np.linalg.matrix_rank(rows) < len(rows)
                    accelerations, forces = self.linear(closed, trial)
                    ahead = expm(self.flow(accelerations) * AHEAD) @ z
                    stays = self.stays(closed, trial, forces)
                    if np.all(stays @ ahead > np.where(abs(stays @ z) < 1e-12, -1e-14, -1e-12)):
                        if np.linalg.matrix_rank(rows) < len(rows):
                            raise Redundant
                        return closed, trial
        raise Redundant if redundant else AssertionError("no combination of modes is right")

    def run(self, x, v, times):
        """States at `times`; the first of these is the start time."""
        t = times[0]
        z = np.concatenate([x, v, [1.0, np.cos(self.rate * t), np.sin(self.rate * t)]])
        states, self.events = [], []
        closed, modes = self.modes(z)
        states.append(z.copy())
        for end in times[1:]:
            while True:
                found = self.advance(z, end - t, closed, modes)
                z, t, is_end = found[0], end if found[2] else t + found[1], found[2]
                if is_end:
                    break
                self.events.append(t)
                assert len(self.events) < 5000
                closed, modes = self.modes(z)
            states.append(z.copy())
        self.closed, self.sliding = closed, modes
        return np.array(states)

    def advance(self, z, length, closed, modes):
        accelerations, forces = self.linear(closed, modes)
        flow, stays = self.flow(accelerations), self.stays(closed, modes, forces)
        count = max(4, int(np.ceil(length / SAMPLE)))
        step = length / count
        once = expm(flow * step)
        samples = np.empty((count + 1, self.size))
        samples[0] = z
        for k in range(count):
            samples[k + 1] = once @ samples[k]
        values = samples @ stays.T
        first = min(first_fall(values[:, i], step, samples, flow, row) for i, row in enumerate(stays))
        if first == np.inf:
            return samples[-1], length, True
        return expm(flow * first) @ z, first, False


def taylor(flow, row, z):
    """Taylor coefficients of row @ z, highest first, of the motion that starts at z."""
    coefficients = []
    for k in range(14):
        coefficients.append(row @ z)
        z = flow @ z / (k + 1)
    return coefficients[::-1]


def first_fall(values, step, samples, flow, row):
    """First time at which a value becomes negative."""
    below = values < -1e-12
    middle = values[1:-1]
    dips = (middle < values[:-2]) & (middle <= values[2:]) & (middle < 0.25 * (values[:-2] + values[2:] - 2 * middle))
    below[1:-1] |= dips & (middle >= 0)
    for k in np.flatnonzero(below):
        base = max(k - 1, 0)
        polynomial = taylor(flow, row, samples[base])
        times = np.linspace(0, step * (1 if values[k] < 0 else 2), 65)
        if base == 0:  # the value may leave 0 for a short time
            times = np.concatenate([[0], np.geomspace(1e-8, times[-1], 200)])
        fine = np.polyval(polynomial, times)
        for j in np.flatnonzero(fine < -1e-12):
            if j == 0 or max(fine[:j]) <= 0:
                return step * base
            if fine[j - 1] > 0:
                return step * base + brentq(lambda t: np.polyval(polynomial, t), times[j - 1], times[j], xtol=1e-15, rtol=1e-15)
    return np.inf
