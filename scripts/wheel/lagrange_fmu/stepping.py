"""Integrate with SciPy, and change to an implicit method where the equations turn out stiff."""

import numpy as np
from scipy.integrate import DOP853, Radau

from .problem import Problem

LOOK = 200  # steps between two tests for stiffness, whose eigenvalues cost more than a step
TINY, CREEPING = 1e-6, 20  # a step below TINY max(1 s, time) is tiny; CREEPING tiny steps in a row are stagnation
STABLE = 3.0  # -Re(h lambda) above which the system counts as stiff; the stability limit of DOP853 is about 6


class Steps:
    """
    Steps of DOP853 while accuracy limits them, and of Radau IIA from the time at which stability does.

    The test for stiffness looks at the eigenvalues of the Jacobian over the current step.
    """

    def __init__(self, rates, jacobian, span, state, tolerance, what, first_step=None, obstacle=lambda time, state: None):
        """
        Begin at span[0] with `state`.

        rates(time, state) is the right-hand side, and jacobian(time, state) its derivative by the state, which may be approximate.
        Messages of failure begin with `what`. obstacle(time, state) returns the cause of stagnation there as a text, or None.
        """
        self.rates, self.jacobian, self.end, self.what, self.count, self.tiny = rates, jacobian, span[1], what, 0, 0
        self.obstacle = obstacle
        self.words = {"rtol": max(tolerance, 3e-14), "atol": 1e-2 * tolerance}
        self.solver = DOP853(rates, span[0], state, span[1], first_step=first_step, **self.words)

    def take(self):
        """Take a step; return False if the end was reached before. Raise Problem if the solver fails, or stagnates at an obstacle."""
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
        """Count tiny steps in a row; raise Problem if they are a stagnation that has a known cause."""
        solver = self.solver
        is_tiny = solver.step_size < TINY * max(1.0, abs(solver.t)) and solver.status == "running"
        self.tiny = self.tiny + 1 if is_tiny else 0
        obstacle = self.obstacle(solver.t, solver.y) if self.tiny == CREEPING else None
        if obstacle is not None:
            raise Problem(f"{self.what} beyond {solver.t:g} s: {obstacle}; expected an earlier end")

    def is_stiff(self):
        """Return True if a mode decays by more than exp(-STABLE) within the current step."""
        solver = self.solver
        return np.min((np.linalg.eigvals(self.jacobian(solver.t, solver.y)) * (solver.t - solver.t_old)).real) < -STABLE
