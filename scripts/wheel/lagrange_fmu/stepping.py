"""Steps of SciPy's solvers along what may be stiff."""

import numpy as np
from scipy.integrate import DOP853, Radau

from .problem import Problem

LOOK = 200  # steps, after which is asked what limits them
TINY, CREEPING = 1e-6, 20  # of the time: steps that come to nearly nothing; so many in a row
STABLE = 3.0  # a step over which an explicit method damps; 6 is the limit of DOP853


class Steps:
    """Of DOP853, which is fast where accuracy limits them, and of Radau's method from where stability does."""

    def __init__(self, rates, jacobian, span, state, tolerance, what, first_step=None, obstacle=lambda time, state: None):
        """
        rates(time, state); jacobian(time, state): of these by the state, or near that; what: cannot be done where it fails; obstacle(time, state): what
        makes steps come to nearly nothing there, or None.
        """
        self.rates, self.jacobian, self.end, self.what, self.count, self.tiny = rates, jacobian, span[1], what, 0, 0
        self.obstacle = obstacle
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
            raise Problem(f"{self.what} beyond {solver.t:g} s: {self.obstacle(solver.t, solver.y) or message}; expected an earlier end")
        self.look_for_obstacle()
        return True

    def look_for_obstacle(self):
        solver = self.solver
        is_tiny = solver.step_size < TINY * max(1.0, abs(solver.t)) and solver.status == "running"
        self.tiny = self.tiny + 1 if is_tiny else 0
        obstacle = self.obstacle(solver.t, solver.y) if self.tiny == CREEPING else None
        if obstacle is not None:
            raise Problem(f"{self.what} beyond {solver.t:g} s: {obstacle}; expected an earlier end")

    def is_stiff(self):
        """Whether it damps something within the present step."""
        solver = self.solver
        return np.min((np.linalg.eigvals(self.jacobian(solver.t, solver.y)) * (solver.t - solver.t_old)).real) < -STABLE
