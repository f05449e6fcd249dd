"""Simulate bodies in contact by each program; models are built before the clock starts, and processor time counts."""

import itertools
import logging
import time

import numpy as np

from numerics.driver import step
from numerics.switching.peers import contact_rate, damping_ratio
from numerics.touching.problems import DAMPING, GRAVITY, GROUND_FRICTION, HEIGHT, QUADRUPED, SERVOS, STANDS, STIFFNESS, WEIGHT

CPU = time.process_time
CORNER = 1e-4  # m, radius of a box's corners in Drake's continuous plant


class Fmu:
    """The FMU in a C program, in one communication step; if `soft`, with compliant contacts, whose stiffness and creep follow the setting."""

    def __init__(self, problem, setting, soft):
        self.problem, name, body = problem, problem.soft if soft else problem.rigid, problem.body
        values = {"mu": problem.friction, "m": body["mass"], "vx": problem.velocity[0]}
        if "radius" in body:
            values |= {"r": body["radius"], "vy": problem.velocity[1], "slope": problem.slope}
            values |= {"va": problem.spin[0] / 2, "vb": problem.spin[1] / 2} if soft else {"wx": problem.spin[0], "wy": problem.spin[1], "e": problem.restitution}
        if soft:
            values |= {"k": 0.1 / setting, "w": 1e3 * setting}
        else:
            values |= {"h": problem.height}
        values = {key: float(value) for key, value in values.items()}
        self.names = ["x", "y" if "radius" in body else None, "z" if soft else "h"]
        self.words = ("touching", name, values, problem.end, min(setting, 1e-6) if soft else setting, 1)
        self.offset = problem.half_height if soft else 0.0

    def run(self, repeats=3):
        stepped = step(*self.words, repeats, 1)
        if stepped is None:
            raise RuntimeError("it gave up")
        place = [0.0 if name is None else stepped.columns([name])[-1, 0] for name in self.names]
        place[2] -= self.offset
        return stepped.seconds, self.problem.error(place)


class FmuQuadruped:
    """The quadruped as an FMU with compliant contacts."""

    def __init__(self, tolerance):
        self.words = ("touching", "Quadruped", {}, STANDS, tolerance, 1)

    def run(self):
        stepped = step(*self.words, 3, 1)
        if stepped is None:
            raise RuntimeError("it gave up")
        return stepped.seconds, abs(stepped.columns(["weight"])[-1, 0] / WEIGHT - 1)


class MuJoCo:
    """MuJoCo with soft contacts, as stiff as the steps allow, and elliptic friction cones; a spring and damper give the restitution."""

    def __init__(self, problem, length):
        import mujoco

        self.library, self.problem, self.length = mujoco, problem, length
        body, friction = problem.body, f'condim="3" friction="{problem.friction} 0 0"'
        shape = f'type="sphere" size="{body["radius"]}"' if "radius" in body else 'type="box" size="{} {} {}"'.format(*(s / 2 for s in body["sizes"]))
        rate = contact_rate(length)
        law = f"{2 * length} 1" if not problem.restitution else f"{-(rate**2)!r} {-2 * rate * damping_ratio(problem.restitution)!r}"
        contact = f'solref="{law}" solimp="0.9999 0.9999 0.001" {friction}'
        gravity = " ".join(map(repr, map(float, problem.gravity)))
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{length!r}" gravity="{gravity}" cone="elliptic" impratio="100" integrator="implicitfast"/><worldbody>'
            f'<geom type="plane" size="9 9 1" {contact}/><body pos="0 0 {problem.half_height + problem.height}"><freejoint/>'
            f'<geom {shape} mass="{body["mass"]}" {contact}/></body></worldbody></mujoco>'
        )

    def run(self):
        data, problem = self.library.MjData(self.model), self.problem
        data.qvel[:] = [*problem.velocity, *problem.spin]
        begin = CPU()
        self.library.mj_step(self.model, data, round(problem.end / self.length))
        return CPU() - begin, problem.error(data.qpos[:3] - [0, 0, problem.half_height])


class MuJoCoQuadruped:
    """The quadruped in MuJoCo."""

    def __init__(self, length):
        import mujoco

        self.library, self.length = mujoco, length
        text = QUADRUPED.read_text().replace("</robot>", '<mujoco><compiler fusestatic="false"/></mujoco></robot>')
        spec = mujoco.MjSpec.from_string(text)
        spec.body("trunk").add_freejoint()
        spec.body("trunk").pos = [0, 0, HEIGHT]
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9, 9, 1], friction=[GROUND_FRICTION, 0, 0])
        for joint in spec.joints:
            if joint.name in SERVOS:
                joint.stiffness[0], joint.damping[0], joint.springref = STIFFNESS, DAMPING, SERVOS[joint.name]
        for geom in spec.geoms:
            geom.friction, geom.condim = [GROUND_FRICTION, 0, 0], 3
        spec.option.timestep, spec.option.cone, spec.option.integrator = length, mujoco.mjtCone.mjCONE_ELLIPTIC, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        self.model = spec.compile()

    def run(self):
        mujoco, data = self.library, self.library.MjData(self.model)
        for name, angle in SERVOS.items():
            data.joint(name).qpos[0] = angle
        begin = CPU()
        mujoco.mj_step(self.model, data, round(STANDS / self.length))
        seconds, force, total = CPU() - begin, np.zeros(6), 0.0
        mujoco.mj_forward(self.model, data)
        for i in range(data.ncon):
            mujoco.mj_contactForce(self.model, data, i, force)
            total += force[0]
        return seconds, abs(total / WEIGHT - 1)


class DrakePlant:
    """
    A MultibodyPlant of Drake on a plane: discrete with steps of a length in s, or continuous with a penetration in m and a creep in m/s.

    Spheres have point contact, stiffer with smaller settings. A box has hydroelastic contact in the discrete plant, since point contact would act
    at one corner only. In the continuous plant, a point at each corner has contact.
    """

    def __init__(self, setting, is_continuous, friction, gravity):
        from pydrake.math import RigidTransform
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
        from pydrake.geometry import AddContactMaterial, AddRigidHydroelasticProperties, HalfSpace, ProximityProperties
        from pydrake.systems.framework import DiagramBuilder

        self.builder, self.setting, self.is_continuous = DiagramBuilder(), setting, is_continuous
        self.plant, _ = AddMultibodyPlantSceneGraph(self.builder, time_step=0.0 if is_continuous else setting)
        logging.getLogger("drake").setLevel(logging.ERROR)  # suppresses the warning that half spaces do not touch deformable bodies
        self.friction = CoulombFriction(friction, friction)
        properties = ProximityProperties()
        AddContactMaterial(friction=self.friction, properties=properties)
        if not is_continuous:
            AddRigidHydroelasticProperties(properties)
        self.plant.RegisterCollisionGeometry(self.plant.world_body(), RigidTransform(), HalfSpace(), "ground", properties)
        self.plant.mutable_gravity_field().set_gravity_vector(gravity)

    def finish(self):
        from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig

        self.plant.Finalize()
        self.plant.set_penetration_allowance(self.setting if self.is_continuous else self.setting**1.5)
        if self.is_continuous:
            self.plant.set_stiction_tolerance(self.setting)
        self.diagram = self.builder.Build()
        self.simulator = Simulator(self.diagram)
        if self.is_continuous:
            ApplySimulatorConfig(SimulatorConfig(integration_scheme="radau3", accuracy=min(self.setting, 1e-3)), self.simulator)
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())

    def advance(self, end):
        self.simulator.Initialize()
        begin = CPU()
        self.simulator.AdvanceTo(end)
        return CPU() - begin


class Drake:
    """A problem in Drake; each run builds the plant again."""

    def __init__(self, problem, setting, is_continuous):
        self.problem, self.setting, self.is_continuous = problem, setting, is_continuous
        self.build()

    def build(self):
        from pydrake.geometry import AddCompliantHydroelasticProperties, AddContactMaterial, Box, ProximityProperties, Sphere
        from pydrake.math import RigidTransform
        from pydrake.multibody.tree import SpatialInertia

        problem, body = self.problem, self.problem.body
        self.world = world = DrakePlant(self.setting, self.is_continuous, problem.friction, problem.gravity)
        if "radius" in body:
            inertia, shape = SpatialInertia.SolidSphereWithMass(body["mass"], body["radius"]), Sphere(body["radius"])
        else:
            inertia, shape = SpatialInertia.SolidBoxWithMass(body["mass"], *body["sizes"]), Box(*body["sizes"])
        self.body = world.plant.AddRigidBody("body", inertia)
        properties = ProximityProperties()
        AddContactMaterial(friction=world.friction, properties=properties)
        places = {(0, 0, 0): shape}
        if "radius" not in body and self.is_continuous:
            places = {corner: Sphere(CORNER) for corner in itertools.product(*((-size / 2 + CORNER, size / 2 - CORNER) for size in body["sizes"]))}
        elif "radius" not in body:
            AddCompliantHydroelasticProperties(min(body["sizes"]), 1e4 / self.setting, properties)
        for place, touching in places.items():
            world.plant.RegisterCollisionGeometry(self.body, RigidTransform(place), touching, f"body {place}", properties)
        world.finish()

    def run(self):
        from pydrake.math import RigidTransform
        from pydrake.multibody.math import SpatialVelocity

        self.build()
        problem, world = self.problem, self.world
        place = RigidTransform([0, 0, problem.half_height + problem.height])
        world.plant.SetFreeBodyPose(world.context, self.body, place)
        velocity = SpatialVelocity(problem.spin, problem.velocity)
        world.plant.SetFreeBodySpatialVelocity(context=world.context, body=self.body, V_JpJc=velocity)
        seconds = world.advance(problem.end)
        found = world.plant.EvalBodyPoseInWorld(world.context, self.body).translation()
        return seconds, problem.error(found - [0, 0, problem.half_height])


class DrakeQuadruped:
    """The quadruped in Drake."""

    def __init__(self, setting, is_continuous):
        self.words = setting, is_continuous

    def run(self):
        from pydrake.math import RigidTransform
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.tree import RevoluteSpring

        world = DrakePlant(*self.words, GROUND_FRICTION, (0, 0, -GRAVITY))
        plant = world.plant
        Parser(plant).AddModels(str(QUADRUPED))
        for name, angle in SERVOS.items():
            joint = plant.GetJointByName(name)
            joint.set_default_angle(angle)
            joint.set_default_damping(DAMPING)
            plant.AddForceElement(RevoluteSpring(joint, angle, STIFFNESS))
        world.finish()
        plant.SetFreeBodyPose(world.context, plant.GetBodyByName("trunk"), RigidTransform([0, 0, HEIGHT]))
        seconds = world.advance(STANDS)
        results = plant.get_contact_results_output_port().Eval(world.context)
        total = sum(results.point_pair_contact_info(i).contact_force()[2] for i in range(results.num_point_pair_contacts()))
        return seconds, abs(abs(total) / WEIGHT - 1)
