"""Simulate planar mechanisms in exudyn and MuJoCo; models are built before the clock starts, and recorded in a run that is not timed."""

import sys

import numpy as np

from numerics.driver import POINTS
from numerics.mechanisms.problems import GROUND


class Exudyn:
    """exudyn with positions and angles as coordinates, hinges as constraints, and an implicit solver with fixed steps, in one thread."""

    def __init__(self, problem, steps, solver):
        sys.exudynFast = True  # selects the module without range checks
        import exudyn
        import exudyn.itemInterface as items

        self.problem, self.model, self.items = problem, problem.model, items
        container = exudyn.SystemContainer()
        self.system = container.AddSystem()
        self.build(exudyn)
        self.system.Assemble()
        self.solver = getattr(exudyn.DynamicSolverType, solver)
        self.settings = self.fixed_steps(exudyn, steps)

    def build(self, exudyn):
        items = self.items
        self.ground = self.system.AddObject(items.ObjectGround())
        self.bodies, nodes = zip(*[self.add_body(body) for body in self.model.bodies])
        self.sensors = [[self.system.AddSensor(items.SensorNode(nodeNumber=node, outputVariableType=kind, storeInternal=True))
                         for kind in (exudyn.OutputVariableType.Coordinates, exudyn.OutputVariableType.Coordinates_t)]
                        for node in nodes]  # fmt: skip
        for joint in self.model.joints:
            self.add_joint(joint)
        self.add_motor_and_spring()
        self.add_drag()

    def fixed_steps(self, exudyn, steps):
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.endTime = self.problem.end
        settings.timeIntegration.numberOfSteps = steps
        settings.timeIntegration.adaptiveStep = False
        settings.timeIntegration.newton.modifiedNewtonJacUpdatePerStep = True  # takes a third less time
        settings.timeIntegration.verboseMode = 0
        settings.solution.file.write = False
        settings.solution.file.writeInitialValues = False
        settings.parallel.numberOfThreads = 1
        if len(self.bodies) > 20:
            settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
        return settings

    def add_body(self, body):
        """Add a body; return the numbers of its object and its node."""
        items, system, weight = self.items, self.system, [0.0, -self.model.gravity, 0.0]
        if body.inertia == 0.0:
            node = system.AddNode(items.NodePoint2D(referenceCoordinates=body.centre, initialVelocities=body.velocity))
            number = system.AddObject(items.ObjectMassPoint2D(mass=body.mass, nodeNumber=node))
        else:
            node = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[*body.centre, 0.0], initialVelocities=[*body.velocity, body.rate]))
            number = system.AddObject(items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node))
        marker = system.AddMarker(items.MarkerBodyMass(bodyNumber=number))
        system.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=weight))
        return number, node

    def marker(self, body, point):
        centre = np.zeros(2) if body is GROUND else self.model.bodies[body].centre
        number = self.ground if body is GROUND else self.bodies[body]
        return self.system.AddMarker(self.items.MarkerBodyPosition(bodyNumber=number, localPosition=[*(point - centre), 0.0]))

    def add_joint(self, joint):
        """Add a hinge; for a mass point, which has no angle, a constant distance."""
        body = self.model.bodies[joint.body]
        if body.inertia == 0.0:
            markers = [self.marker(joint.other, joint.point), self.marker(joint.body, body.centre)]
            length = float(np.linalg.norm(body.centre - joint.point))
            self.system.AddObject(self.items.ObjectConnectorDistance(markerNumbers=markers, distance=length))
        else:
            markers = [self.marker(joint.other, joint.point), self.marker(joint.body, joint.point)]
            self.system.AddObject(self.items.ObjectJointRevolute2D(markerNumbers=markers))

    def add_motor_and_spring(self):
        items, (body, torque) = self.items, self.model.torque
        if torque != 0.0:
            marker = self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=self.bodies[body]))
            self.system.AddLoad(items.LoadTorqueVector(markerNumber=marker, loadVector=[0.0, 0.0, torque]))
        if self.model.spring is not None:
            body, point, fixed, stiffness, length = self.model.spring
            markers = [self.marker(GROUND, fixed), self.marker(body, point)]
            self.system.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=markers, stiffness=stiffness, referenceLength=length,
                                                                     damping=self.model.damping))  # fmt: skip

    def add_drag(self):
        if self.model.drag != 0.0:
            markers = [self.marker(GROUND, np.zeros(2)), self.marker(0, self.model.bodies[0].centre)]
            damping = [self.model.drag, self.model.drag, 0.0]
            self.system.AddObject(self.items.ObjectConnectorCartesianSpringDamper(markerNumbers=markers, damping=damping))

    def solve(self, period):
        self.settings.solution.sensors.writePeriod = period
        self.system.SolveDynamic(self.settings, solverType=self.solver)

    def run(self):
        self.solve(self.problem.end)

    def recorded(self, points):
        """Return rows of (x, y, angle) of each body, and rows of their rates, at the last `points` recorded times."""
        coordinates = [[self.system.GetSensorStoredData(sensor)[-points:, 1:] for sensor in pair] for pair in self.sensors]
        positions, velocities = (np.hstack([self.padded(pair[i]) for pair in coordinates]) for i in (0, 1))
        return positions + np.concatenate([[*body.centre, 0.0] for body in self.model.bodies]), velocities

    def measured(self, points):
        """Return the energies and the motion of the bodies."""
        positions, velocities = self.recorded(points)
        return self.model.energy(positions, velocities), positions

    def record(self):
        """Return the energies and the compared quantities at the communication points."""
        self.solve(self.problem.end / POINTS)
        energies, motion = self.measured(POINTS)
        return energies, None if self.problem.from_bodies is None else self.problem.from_bodies(motion)

    @staticmethod
    def padded(columns):
        """Append an angle of 0 for mass points."""
        return np.hstack([columns, np.zeros((len(columns), 3 - columns.shape[1]))])


class MuJoCo:
    """MuJoCo with a tree of hinges, and loops closed by `connect`, as stiff as the time step allows."""

    def __init__(self, problem, steps, integrator):
        import mujoco

        mujoco.set_mju_user_warning(lambda text: None)  # otherwise MuJoCo writes warnings to a file in the current folder
        self.library, self.problem, self.model, self.steps = mujoco, problem, problem.model, steps
        self.mujoco = mujoco.MjModel.from_xml_string(self.text(problem.end / steps, integrator))
        self.data, self.copy = mujoco.MjData(self.mujoco), mujoco.MjData(self.mujoco)
        # MuJoCo's numbers of the bodies, which it orders by depth; 0 is the ground.
        self.numbers = [self.mujoco.body(f"b{i}").id for i in range(self.mujoco.nbody - 1)]

    def text(self, step, integrator):
        self.parents = parents_of(self.model)
        return mujoco_text(self.model, step, integrator)

    def start(self):
        bodies, (driven, torque) = self.model.bodies, self.model.torque
        self.library.mj_resetData(self.mujoco, self.data)
        for i, number in enumerate(self.numbers):
            above = self.parents[i].other
            self.data.qvel[number - 1] = bodies[i].rate - (0.0 if above is GROUND else bodies[above].rate)
        self.data.qfrc_applied[self.numbers[driven] - 1] = torque

    def run(self):
        self.start()
        self.library.mj_step(self.mujoco, self.data, self.steps)

    def record(self):
        self.start()
        return tuple(map(np.array, zip(*[self.advance(self.steps // POINTS) for _ in range(POINTS)])))

    def advance(self, steps):
        """Return energy and compared quantities after this number of steps. They are computed in a copy of the data, which leaves the simulation unchanged."""
        library, model, data = self.library, self.mujoco, self.copy
        library.mj_step(model, self.data, steps)
        data.qpos[:], data.qvel[:] = self.data.qpos, self.data.qvel
        library.mj_fwdPosition(model, data)
        library.mj_fwdVelocity(model, data)
        energy, motion = self.state_of(data)
        return energy, np.nan if self.problem.from_bodies is None else self.problem.from_bodies(motion)[0]

    def state_of(self, data):
        """Return the energy and the motion of the bodies."""
        self.library.mj_energyPos(self.mujoco, data)
        self.library.mj_energyVel(self.mujoco, data)
        angles = {GROUND: 0.0}
        for body in sorted(self.parents, key=lambda body: self.numbers[body]):
            angles[body] = angles[self.parents[body].other] + data.qpos[self.numbers[body] - 1]
        row = np.concatenate([[*data.xipos[number][:2], angles[i]] for i, number in enumerate(self.numbers)])
        return float(np.sum(data.energy)), row[None]


def parents_of(planar):
    """Return the joint that connects each body to the tree, its first one."""
    parents = {}
    for joint in planar.joints:
        parents.setdefault(joint.body, joint)
    return parents


def vector(values):
    return " ".join(repr(float(value)) for value in values)


def mujoco_text(planar, step, integrator):
    """Return the MJCF of a planar mechanism. At the start all frames are parallel to the ground's, and the angles of all hinges are 0."""
    parents, bodies = parents_of(planar), planar.bodies

    def nested(above, origin):
        text = ""
        for i, body in enumerate(bodies):
            joint = parents[i]
            if joint.other is not above:
                continue
            inertia = vector([max(body.inertia, 1e-12)] * 3)
            text += (f'<body name="b{i}" pos="{vector([*(body.centre - origin), 0])}"><joint type="hinge" axis="0 0 1" '
                     f'pos="{vector([*(joint.point - body.centre), 0])}"/><inertial pos="0 0 0" mass="{body.mass!r}" diaginertia="{inertia}"/>')  # fmt: skip
            if planar.spring is not None and planar.spring[0] == i:
                text += f'<site name="pull" pos="{vector([*(planar.spring[1] - body.centre), 0])}"/>'
            text += nested(i, body.centre) + "</body>"
        return text

    loops = "".join(f'<connect body1="b{joint.body}" body2="b{joint.other}" anchor="{vector([*(joint.point - bodies[joint.body].centre), 0])}" '
                    f'solref="{2 * step!r} 1" solimp="0.9999 0.9999 0.001"/>'
                    for joint in planar.joints if joint is not parents[joint.body])  # fmt: skip
    site = tendon = ""
    if planar.spring is not None:
        _, _, fixed, stiffness, length = planar.spring
        site = f'<site name="fixed" pos="{vector([*fixed, 0])}"/>'
        tendon = (f'<tendon><spatial stiffness="{stiffness!r}" springlength="{length!r}">'
                  '<site site="pull"/><site site="fixed"/></spatial></tendon>')  # fmt: skip
    return (f'<mujoco><compiler angle="radian"/><option timestep="{step!r}" integrator="{integrator}" '
            f'gravity="0 -{planar.gravity!r} 0"><flag contact="disable"/></option><worldbody>{site}{nested(GROUND, np.zeros(2))}</worldbody>'
            f"{tendon}<equality>{loops}</equality></mujoco>")  # fmt: skip


# Program and integration method of each peer.
PEERS = {
    "exudyn generalized-alpha": ("exudyn", "GeneralizedAlpha"),
    "exudyn trapezoidal, index 2": ("exudyn", "TrapezoidalIndex2"),
    "MuJoCo RK4": ("MuJoCo", "RK4"),
    "MuJoCo implicitfast": ("MuJoCo", "implicitfast"),
}
