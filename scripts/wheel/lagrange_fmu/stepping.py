"""Steps of SciPy's solvers along what may be stiff."""

import numpy as np
from scipy.integrate import DOP853, Radau

from .problem import Problem

LOOK = 200  # steps, after which is asked what limits them
STABLE = 3.0  # a step over which an explicit method damps; 6 is the limit of DOP853


class Steps:
    """Of DOP853, which is fast where accuracy limits them, and of Radau's method from where stability does."""

    def __init__(self, rates, jacobian, span, state, tolerance, what, first_step=None):
        """rates(time, state); jacobian(time, state): of these by the state, or near that; what: cannot be done where it fails."""
        self.rates, self.jacobian, self.end, self.what, self.count = rates, jacobian, span[1], what, 0
        self.words = {"rtol": max(tolerance, 3e-14), "atol": 1e-2 * tolerance}
        self.solver = DOP853(rates, span[0], state, span[1], first_step=first_step, **self.words)

    def take(self):
        """A step; False where the end is reached already."""
        solver = self.solver
        if solver.status != "running":
            return False
        self.count += 1
        if self.count % LOOK == 0 and isinstance(solver, DOP853) and self.is_stiff():
            solver = self.solver = Radau(self.rates, solver.t, solver.y, self.end, jac=self.jacobian, **self.words)
        message = solver.step()
        if solver.status == "failed":
            raise Problem(f"{self.what} beyond {solver.t:g} s: {message}")
        return True

    def is_stiff(self):
        """Whether it damps something within the present step."""
        solver = self.solver
        return np.min((np.linalg.eigvals(self.jacobian(solver.t, solver.y)) * (solver.t - solver.t_old)).real) < -STABLE
