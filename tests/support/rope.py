"""The rope of fmu/Rope, with forces written by hand."""

import numpy as np

N, L = 200, 2.0
D = L / N
START = dict(M=0.2, EA=1e4, EI=1e-3, tau=1e-3, b=0.01, kEnd=0.0, xEnd=1.0, yEnd=0.0, g=9.81)
MASSES = np.append(np.full(N - 1, 1.0), 0.5) / N


def accelerations(p, places, velocities):
    """Accelerations by Newton's law, from the forces of links, of bending (moments of second differences), drag and weight."""
    mass, lifted = p["M"] * MASSES[:, None], np.array([0.0, p["g"]])
    at, rate = (np.vstack([np.zeros(2), values]) for values in (places, velocities))
    link, link_rate = np.diff(at, axis=0), np.diff(rate, axis=0)
    length = np.hypot(*link.T)[:, None]
    along = link / length
    stretching = np.sum(along * link_rate, axis=1)[:, None]
    tension = p["EA"] * ((length - D) + p["tau"] * stretching) / D * along
    force = -p["b"] * D * velocities - mass * lifted - tension
    force[:-1] += tension[1:]
    moment = p["EI"] * (np.diff(at, n=2, axis=0) + p["tau"] * np.diff(rate, n=2, axis=0)) / D**3
    bending = np.zeros_like(at)
    bending[:-2] -= moment
    bending[1:-1] += 2 * moment
    bending[2:] -= moment
    force += bending[1:]
    force[-1] -= p["kEnd"] * (places[-1] - [p["xEnd"], p["yEnd"]])
    return force / mass
