"""
Stabilize the cart's pendulum by a controller at 1 kHz, through the co-simulation FMU.

Positions are measured with noise; the force is bounded and acts after a delay. The controllers, an LQR and an MPC, know the FMU's linearization
only, discretized with x(k+1) = a x(k) + b F(k). A Kalman filter estimates the state.
"""

import time
from typing import NamedTuple

import casadi
import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from optimization.collocation import slopes_of
from optimization.tasks import CART
from scipy.linalg import expm, solve_discrete_are

PERIOD = 1e-3  # s
DELAY = 3  # periods
NOISE = np.array([5e-4, 2e-3])  # standard deviations of the measured x (m) and theta (rad)
FORCE, TRACK = CART.strength[0], 0.28  # N and m
BALANCED = CART._replace(start=np.array([0.2, 0.1, 0.0, 0.0]))  # the controllers begin near upright
WEIGHTS, EFFORT = np.diag([20.0, 10.0, 1.0, 1.0]), 0.02  # weights of the squared states (x, theta, v, omega) and of the squared force
LEAVING = 1e3  # weight of the squared distance beyond the track in m, relative to the scaled weight of forces
BLOCKS, BLOCK = 20, 40  # prediction horizon: number of constant forces, and periods of each


class Plant(NamedTuple):
    """The discrete plant x(k+1) = a x(k) + b F(k); states 0 to 3 are the cart's, and the others the delayed forces, of which state 4 acts."""

    a: np.ndarray
    b: np.ndarray


def plant_of(unpacked, task=BALANCED):
    """Return the Plant of the FMU's linearization in upright position, discretized exactly by the matrix exponential."""
    slopes = slopes_of(unpacked, task)
    states, force = casadi.MX.sym("x", 4), casadi.MX.sym("F")
    matrix = casadi.Function("matrix", [states, force], [casadi.horzcat(casadi.jacobian(slopes(states, force), states), casadi.jacobian(slopes(states, force), force))])
    continuous = np.zeros((5, 5))
    continuous[:4] = matrix(np.zeros(4), 0.0)
    discrete = expm(PERIOD * continuous)[:4]
    count = 4 + DELAY
    a, b = np.zeros((count, count)), np.zeros((count, 1))
    a[:4, :4], a[:4, 4] = discrete[:, :4], discrete[:, 4]
    a[range(4, count - 1), range(5, count)] = 1.0
    b[count - 1] = 1.0
    return Plant(a, b)


def regulator_of(plant):
    """Return the gain of the linear-quadratic regulator, the matrix of its cost-to-go, and the weights of the states."""
    weights = np.zeros_like(plant.a)
    weights[:4, :4] = PERIOD * WEIGHTS
    cost = solve_discrete_are(plant.a, plant.b, weights, np.array([[PERIOD * EFFORT]]))
    gain = np.linalg.solve(PERIOD * EFFORT + plant.b.T @ cost @ plant.b, plant.b.T @ cost @ plant.a)
    return gain, cost, weights


class Regulator:
    """LQR: linear state feedback, saturated at the bounds of the force."""

    def __init__(self, plant):
        self.gain, _, _ = regulator_of(plant)

    def force(self, state):
        return float(np.clip(-self.gain @ state, -FORCE, FORCE)[0])


class Predictor:
    """
    MPC: minimizes the cost over BLOCKS constant forces within the bounds of force and track, and applies the first one.

    The states are eliminated, which leaves a dense quadratic program in the forces; LQR's cost-to-go is the terminal cost. DAQP solves it.
    """

    def __init__(self, plant):
        _, cost, weights = regulator_of(plant)
        count = len(plant.a)
        powers, sums, step = np.eye(count), np.zeros((count, 1)), np.zeros((count, count))
        inner = np.zeros((count + 1, count + 1))
        whole = np.block([[plant.a, plant.b], [np.zeros((1, count)), np.ones((1, 1))]])
        stage = np.zeros_like(whole)
        stage[:count, :count], stage[count, count] = weights, PERIOD * EFFORT
        power = np.eye(count + 1)
        for _ in range(BLOCK):
            inner += power.T @ stage @ power
            power = whole @ power
        a, b = power[:count, :count], power[:count, count:]
        free, forced = np.eye(count), np.zeros((count, BLOCKS))  # derivatives of the state at a block's start by the first state and by the forces
        hessian, mixed, self.track_free, self.track_forced = np.zeros((BLOCKS, BLOCKS)), np.zeros((BLOCKS, count)), [], []
        for k in range(BLOCKS):
            chosen = np.zeros((1, BLOCKS))
            chosen[0, k] = 1.0
            left, right = np.vstack([forced, chosen]), np.vstack([free, np.zeros((1, count))])
            hessian += left.T @ inner @ left
            mixed += left.T @ inner @ right
            free, forced = a @ free, a @ forced + b @ chosen
            self.track_free.append(free[0])  # part of x at the block's end that does not depend on the forces
            self.track_forced.append(forced[0])
        hessian += forced.T @ cost @ forced
        size = hessian.diagonal().max()
        self.mixed = np.vstack([mixed + forced.T @ cost @ free, np.zeros((1, count))]) / size
        # The last unknown is a slack variable, the distance beyond the track, with a large weight: the problem is always feasible.
        self.hessian = np.zeros((BLOCKS + 1, BLOCKS + 1))
        self.hessian[:BLOCKS, :BLOCKS], self.hessian[BLOCKS, BLOCKS] = (hessian + hessian.T) / (2 * size), LEAVING
        self.track_free, left = np.array(self.track_free), np.array(self.track_forced)
        self.track_forced = np.block([[left, -np.ones((BLOCKS, 1))], [left, np.ones((BLOCKS, 1))]])
        shapes = {"h": casadi.Sparsity.dense(*self.hessian.shape), "a": casadi.Sparsity.dense(*self.track_forced.shape)}
        self.solver = casadi.conic("program", "daqp", shapes, {})
        self.least, self.most = (np.append(np.full(BLOCKS, bound), end) for bound, end in ((-FORCE, 0.0), (FORCE, np.inf)))

    def force(self, state):
        room, open_end = self.track_free @ state, np.full(BLOCKS, np.inf)
        found = self.solver(h=self.hessian, g=self.mixed @ state, a=self.track_forced, lbx=self.least, ubx=self.most,
                            lba=np.concatenate([-open_end, -TRACK - room]), uba=np.concatenate([TRACK - room, open_end]))  # fmt: skip
        return float(np.clip(float(found["x"][0]), -FORCE, FORCE))


class Observer:
    """A stationary Kalman filter of the measured positions, with known forces."""

    def __init__(self, plant, start):
        self.plant, self.look = plant, np.eye(2, len(plant.a))
        disturbance = 1e-9 * np.eye(len(plant.a))
        disturbance[2:4, 2:4] = 1e-5 * np.eye(2)
        covariance = solve_discrete_are(plant.a.T, self.look.T, disturbance, np.diag(NOISE**2))
        self.gain = covariance @ self.look.T @ np.linalg.inv(self.look @ covariance @ self.look.T + np.diag(NOISE**2))
        self.state = np.concatenate([start, np.zeros(len(plant.a) - len(start))])

    def correct(self, measured):
        self.state = self.state + self.gain @ (measured - self.look @ self.state)
        return self.state

    def predict(self, force):
        self.state = self.plant.a @ self.state + self.plant.b[:, 0] * force


class ClosedLoopRun(NamedTuple):
    """A closed-loop run, with a row for each period."""

    times: np.ndarray  # s
    states: np.ndarray  # true states, without noise
    forces: np.ndarray  # requested by the controller, in N
    seconds: np.ndarray  # computing time of observer and controller


def run(unpacked, plant, controller, task=BALANCED, duration=5.0, seed=1):
    """Run the nonlinear FMU in closed loop with a controller; return the ClosedLoopRun."""
    description = fmpy.read_model_description(str(unpacked))
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    cart = FMU2Slave(guid=description.guid, unzipDirectory=str(unpacked), modelIdentifier=description.coSimulation.modelIdentifier, instanceName="cart")
    cart.instantiate()
    cart.setupExperiment(startTime=0.0)
    places = [references[name] for name in CART.states]
    cart.setReal([references[name] for name in task.parameters], list(task.parameters.values()))
    cart.setReal(places, task.start)
    cart.enterInitializationMode()
    cart.exitInitializationMode()
    noise = np.random.default_rng(seed).normal(size=(round(duration / PERIOD), 2)) * NOISE
    observer, underway = Observer(plant, [*(task.start[:2] + noise[0]), 0.0, 0.0]), [0.0] * DELAY
    rows, forces, seconds = [], [], []
    for k, error in enumerate(noise):
        rows.append(cart.getReal(places))
        begin = time.perf_counter()
        force = controller.force(observer.correct(rows[-1][:2] + error))
        observer.predict(force)
        seconds.append(time.perf_counter() - begin)
        forces.append(force)
        cart.setReal([references["F"]], [underway.pop(0)])
        underway.append(force)
        cart.doStep(k * PERIOD, PERIOD)
    cart.terminate()
    cart.freeInstance()
    return ClosedLoopRun(PERIOD * np.arange(len(rows)), np.array(rows), np.array(forces), np.array(seconds))


CONTROLLERS = {"LQR": Regulator, "MPC": Predictor}
