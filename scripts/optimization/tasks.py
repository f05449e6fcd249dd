"""Define the tasks of time-optimal motions."""

import numpy as np

from optimization.collocation import Task
from scripts.library.problem import Problem
from scripts.library.variables import checked_start

# Swing-up of the pendulum, from hanging at rest to upright at rest at the same position, with 15 N on a track of 0.8 m.
CART = Task(
    fmu="InvertedPendulumCart",
    states=["x", "theta", "v", "omega"],
    inputs=["F"],
    start=np.array([0.0, np.pi, 0.0, 0.0]),
    end=np.zeros(4),
    strength=np.array([15.0]),
    state_bounds={0: 0.4},
    duration=2.0,
    swings=1.0,
    intervals=40,
    points=6,
    parameters={},
    has_hessian=True,
)
# Swing-up of both rods by a motor that is too weak to hold them horizontal.
DOUBLE_PENDULUM = Task(
    fmu="DrivenDoublePendulum",
    states=["theta1", "theta2", "omega1", "omega2"],
    inputs=["tau"],
    start=np.zeros(4),
    end=np.array([np.pi, np.pi, 0.0, 0.0]),
    strength=np.array([8.0]),
    state_bounds={},
    duration=2.0,
    swings=1.0,
    intervals=60,
    points=6,
    parameters={},
    has_hessian=True,
)
# Motion between two poses, with the maximal joint torques of a PUMA 560 (P. Corke: Robotics, Vision and Control).
ARM = Task(
    fmu="RobotArm",
    states=[f"{name}[{i}]" for name in "qw" for i in range(1, 7)],
    inputs=[f"tau[{i}]" for i in range(1, 7)],
    start=np.array([0.0, -0.5, 0.5, 0.0, 0.3, 0.0, *6 * [0.0]]),
    end=np.array([1.5, 0.4, -0.5, 1.0, -0.3, 1.5, *6 * [0.0]]),
    strength=np.array([97.6, 186.4, 89.4, 24.2, 20.1, 21.3]),
    state_bounds={},
    duration=1.0,
    swings=1.0,
    intervals=20,
    points=4,
    parameters={},
    has_hessian=False,
)
TASKS = {"cart": CART, "double-pendulum": DOUBLE_PENDULUM, "arm": ARM}


def with_values(task, values, description):
    """Return the task with other parameters, and another state at its start; values are numbers, or texts with units, by name."""
    numbers = checked_start(values, description)
    for name in numbers:
        if name in task.inputs:
            raise Problem(f"'{name}' is an input of {task.fmu}, which the optimization finds; expected parameters and states")
    start = [numbers.pop(name, value) for name, value in zip(task.states, task.start)]
    return task._replace(start=np.array(start), parameters=task.parameters | numbers)
