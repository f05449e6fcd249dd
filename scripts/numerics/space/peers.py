"""Simulate bodies in space in exudyn and MuJoCo, as mechanisms/peers.py does in the plane."""

import numpy as np

from numerics.mechanisms import peers as mechanism_peers
from numerics.mechanisms.peers import vector
from numerics.mechanisms.problems import GROUND
from numerics.space.problems import LinkMotions

# 1 for each constrained translation along, and rotation about, three axes, of which the third is the joint's axis.
CONSTRAINED = {"hinge": (1, 1, 1, 1, 1, 0), "slide": (1, 1, 0, 1, 1, 1), "ball": (1, 1, 1, 0, 0, 0)}


def axes_around(axis):
    """Return a rotation matrix whose third column is the axis."""
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across = across / np.linalg.norm(across)
    return np.array([across, np.cross(axis, across), axis]).T


class Exudyn(mechanism_peers.Exudyn):
    """exudyn with positions and Euler parameters as coordinates, and joints as constraints."""

    def build(self, exudyn):
        from exudyn.rigidBodyUtilities import RigidBodyInertia

        self.ground = self.system.CreateGround()
        self.bodies = []
        for link in self.model.links:
            inertia = RigidBodyInertia(mass=link.mass, inertiaTensor=link.inertia)
            self.bodies.append(self.system.CreateRigidBody(referencePosition=list(link.centre), initialVelocity=list(link.velocity),
                                                           initialAngularVelocity=list(link.angular_velocity), inertia=inertia,
                                                           gravity=list(self.model.gravity), returnDict=True))  # fmt: skip
        for i, link in enumerate(self.model.links):
            if link.joint != "free":
                self.join(i, link.above, link.point, axes_around(link.axis), CONSTRAINED[link.joint])
        for closing in self.model.closings:
            self.join(closing.link, closing.other, closing.point, closing.axes, closing.constrained)
        for spring in self.model.springs:
            bodies = [self.body(link) for link, _ in spring.ends]
            places = [list(point - self.model.links[link].centre) for link, point in spring.ends]
            self.system.CreateSpringDamper(itemNumbers=bodies, localPosition0=places[0], localPosition1=places[1],
                                           referenceLength=spring.length, stiffness=spring.stiffness, damping=spring.damping)  # fmt: skip
        kinds = exudyn.OutputVariableType
        kinds = [kinds.Position, kinds.RotationMatrix, kinds.Velocity, kinds.AngularVelocityLocal]
        self.sensors = [[self.system.AddSensor(self.items.SensorNode(nodeNumber=body["nodeNumber"], outputVariableType=kind, storeInternal=True))
                         for kind in kinds] for body in self.bodies]  # fmt: skip

    def body(self, link):
        return self.ground if link is GROUND else self.bodies[link]["bodyNumber"]

    def join(self, link, other, point, axes, constrained):
        self.system.CreateGenericJoint(itemNumbers=[self.body(other), self.body(link)], position=list(point), rotationMatrixAxes=axes,
                                       constrainedAxes=list(constrained), useGlobalFrame=True, show=False)  # fmt: skip

    def recorded(self, points):
        stored = [[self.system.GetSensorStoredData(sensor)[-points:, 1:] for sensor in of_body] for of_body in self.sensors]
        centres, rotations, velocities, angular_velocities = (np.stack([of_body[i] for of_body in stored], axis=1) for i in range(4))
        return LinkMotions(centres, rotations.reshape(*rotations.shape[:2], 3, 3), velocities, angular_velocities)

    def measured(self, points):
        motion = self.recorded(points)
        return self.model.energy(motion), motion


class MuJoCo(mechanism_peers.MuJoCo):
    """MuJoCo with a tree of joints, in which a ball joint has a quaternion."""

    def text(self, step, integrator):
        return mujoco_text(self.model, step, integrator)

    def start(self):
        self.library.mj_resetData(self.mujoco, self.data)
        for link, number in zip(self.model.links, self.numbers):
            first = self.mujoco.body_dofadr[number]
            above = np.zeros(3) if link.above is GROUND else self.model.links[link.above].angular_velocity
            rate = {"hinge": [np.dot(link.axis, np.subtract(link.angular_velocity, above))], "slide": [0.0], "ball": link.angular_velocity,
                    "free": [*link.velocity, *link.angular_velocity]}[link.joint]  # fmt: skip
            self.data.qvel[first : first + len(rate)] = rate

    def state_of(self, data):
        """Return the energy and the LinkMotions."""
        spins, rows = np.zeros(6), []
        for number in self.numbers:
            self.library.mj_objectVelocity(self.mujoco, data, self.library.mjtObj.mjOBJ_XBODY, number, spins, 1)
            axes = data.xmat[number].reshape(3, 3).copy()
            rows.append((data.xpos[number].copy(), axes, axes @ spins[3:], spins[:3].copy()))
        motion = LinkMotions(*(np.array([part]) for part in zip(*rows)))
        return float(self.model.energy(motion)[0]), motion


def mujoco_text(model, step, integrator):
    links, closings, springs = model.links, model.closings, model.springs

    def sites(link):
        return "".join(f'<site name="spring{i}{side}" pos="{vector(point - links[link].centre)}"/>' for i, spring in enumerate(springs)
                       for side, (owner, point) in enumerate(spring.ends) if owner == link)  # fmt: skip

    def nested(above, origin):
        text = ""
        for i, link in enumerate(links):
            if link.above is not above:
                continue
            inertia = vector(link.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])
            place = "" if link.joint == "free" else f'pos="{vector(np.subtract(link.point, link.centre))}"'
            about = f'axis="{vector(link.axis)}" armature="{link.motor!r}" damping="{link.friction!r}"' if link.joint in ("hinge", "slide") else ""
            text += (f'<body name="b{i}" pos="{vector(link.centre - origin)}"><joint type="{link.joint}" {place} {about}/>'
                     f'<inertial pos="0 0 0" mass="{link.mass!r}" fullinertia="{inertia}"/>{sites(i)}{nested(i, link.centre)}</body>')  # fmt: skip
        return text

    # A hinge closes a loop by connecting two points of its axis.
    loops = "".join(f'<connect body1="b{closing.link}" {"" if closing.other is GROUND else f"body2=b{closing.other}"} '
                    f'anchor="{vector(closing.point + shift * closing.axes[:, 2] - links[closing.link].centre)}" '
                    f'solref="{2 * step!r} 1" solimp="0.9999 0.9999 0.001"/>' for closing in closings for shift in (0.0, 0.5))  # fmt: skip
    tendons = "".join(f'<spatial stiffness="{spring.stiffness!r}" springlength="{spring.length!r}" damping="{spring.damping!r}">'
                      f'<site site="spring{i}0"/><site site="spring{i}1"/></spatial>' for i, spring in enumerate(springs))  # fmt: skip
    return (f'<mujoco><compiler angle="radian"/><option timestep="{step!r}" integrator="{integrator}" gravity="{vector(model.gravity)}">'
            f'<flag contact="disable"/></option><worldbody>{nested(GROUND, np.zeros(3))}</worldbody><tendon>{tendons}</tendon>'
            f"<equality>{loops}</equality></mujoco>")  # fmt: skip

