/* A robot as described by URDF or MJCF: links, and joints that connect them to a tree. SI units throughout. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "robots/description/rigid_body.h"

/* PRESCRIBED: inputs move the child. */
enum RobotJointType { FIXED, REVOLUTE, CONTINUOUS, PRISMATIC, FLOATING, PLANAR, BALL, PRESCRIBED, JOINT_TYPES };

/* Geometry of a link for contacts or drawing, in the link's frame. type: as in <shape type="...">. */
struct Collision {
  const char *type;
  struct Placement placement;
  double radius, length, size[3]; /* m; cylinders are along their z axis; size is that of a box */
  char *file;                     /* of a mesh, relative to the robot file; NULL for other types */
  double scale[3];                /* of a mesh: m per unit of the file */
  double (*corners)[3];           /* of a mesh: where it may touch, m, in its own frame */
  size_t corner_count;            /* 0 for other types, and if it is only drawn */
  char *color;                    /* such as "#ff8000ff"; NULL if the file gives none */
  double friction;                /* coefficient on the ground; NAN if the file gives none */
  bool is_clear;                  /* never touches the ground */
  long line;
};

/* A link of a robot: a rigid body with shapes. */
struct RobotLink {
  char *name;   /* as in the file */
  char *symbol; /* the name as an identifier of the language */
  long line;
  struct Collision *collisions, *visuals;
  size_t collision_count, visual_count; /* visuals, if any, are drawn instead of collisions */
  struct RigidBody body;                /* in the link's frame; without inertia if the file gives none */
  double weightless;                    /* share of its weight that a force at its centre of mass balances */
  struct Matrix3 axes;                  /* principal axes of the body by columns, where the file gives them, has_axes */
  bool has_axes;
  /* Results of robot_connect(): */
  struct RobotJoint *joint;                     /* that moves the link relative to its parent; NULL for the root */
  struct RobotLink *first_child, *next_sibling; /* in the order of the file */
  struct RobotLink *next;                       /* in depth-first order, parents first; NULL for the last */
  struct RobotLink *carrier;  /* the nearest link, from this one upward, that is movable or the root */
  struct Placement placement; /* of this link in its carrier's frame */
  struct RigidBody carried;   /* of a carrier: all links that are fixed to it, merged, in its frame */
  bool moves_inertia;         /* of a carrier: it or one of its descendants has inertia */
};

/*
 * Start values of a joint's coordinates: one number; for FLOATING x, y, z and a quaternion; for BALL a quaternion in
 * the last four. The quaternion is 0 if the file gives none. For PRESCRIBED x, y, z, roll, pitch, yaw.
 */
struct JointStart {
  double position[7], velocity[7];
};

/* True unless the quaternion is 0, which stands for none. */
static inline bool is_quaternion(const double q[4]) {
  return q[0] != 0 || q[1] != 0 || q[2] != 0 || q[3] != 0;
}

/* A joint between two links. The child has this joint only. */
struct RobotJoint {
  char *name, *symbol;
  long line;
  enum RobotJointType type;
  char *parent_name, *child_name;
  struct Placement origin; /* of the child in the parent, at zero coordinates */
  double axis[3];          /* unit vector in the child's frame */
  double lower, upper;     /* limits of the position; NAN for none */
  double damping, friction;
  double armature;                     /* inertia of the motor in terms of the coordinate */
  double stiffness, rest;              /* of a spring, and its unstressed position */
  double time_constant, damping_ratio; /* of a spring and damper that are not yet known; 0 for none */
  struct JointStart start;
  bool has_motor;            /* has an input for its force or torque, in addition to the file's actuators */
  double effort;             /* largest force or torque of the motor; NAN for no limit */
  double actuator_limits[2]; /* limits of the sum of the file's actuators, along the coordinate; NAN for none */
  char *actuator_forces;     /* if there are such limits: their sum as an expression; NULL for none so far */
  char *mimicked_name;       /* position = multiplier*(that of this joint) + offset; NULL if it mimics none */
  double multiplier, offset;
  /* Results of robot_connect(): */
  struct RobotLink *parent, *child;
  struct RobotJoint *leader; /* position = ratio*(that of the leader) + shift; mostly the joint itself */
  double ratio, shift;
  bool is_mimicked;
};

/* A joint's contribution to the length of a transmission: coefficient*position. */
struct TransmissionTerm {
  char *joint_name;
  double coefficient;
  /* Results of robot_connect(): */
  struct RobotJoint *joint;
  char *symbol; /* parameter with the coefficient if that has a unit; else NULL */
};

/* Its length is the sum of coefficients times positions, or of the distances along sites (spatial tendon). */
struct Transmission {
  struct TransmissionTerm *terms;
  size_t count;
  char **site_names;
  struct RobotLink **sites; /* as many, results of robot_connect() */
  size_t site_count;        /* 0 unless the transmission is spatial */
};

/* A spring, damper, friction, inertia and limits along a transmission. */
struct Tendon {
  char *name, *symbol; /* symbol: result of robot_connect() */
  long line;
  struct Transmission transmission;
  double lower, upper; /* limits of the length; NAN for none */
  double stiffness, damping, friction, armature;
  double relaxed[2]; /* interval of lengths without spring force */
  double start;      /* length with all joints as placed */
};

/* Coefficients of the polynomial between two tendons or joints, as in MuJoCo's polycoef. */
enum { COUPLING_POWERS = 5 };

/* A tendon or joint in a coupling, and its length or position with all joints as placed. */
struct CoupledPart {
  char *name;
  struct Transmission transmission;
  double start;
};

/* A constraint: the displacement of one tendon or joint from its start is a polynomial of that of another. */
struct Coupling {
  char *name;
  long line;
  struct CoupledPart parts[2];
  double coefficient[COUPLING_POWERS]; /* of the powers from 0 on; only that of power 0 if there is no second part */
};

/* Dynamics between the control and the activation, which acts in its place. */
enum ActuatorDynamics { WITHOUT_STATE, FILTER, INTEGRATOR };

/* The links of a wrench: it acts on one, and reversed on the support; each part is along the axes of a link. */
enum WrenchLink { WRENCH_LINK, WRENCH_SUPPORT, FORCE_AXES, TORQUE_AXES, WRENCH_LINKS };

/* The force and torque of an actuator at a site, or at a free or ball joint, for an actuator force of 1. */
struct Wrench {
  double force[3], torque[3];
  char *names[WRENCH_LINKS];             /* NULL for no support, or for the axes of the base */
  struct RobotLink *links[WRENCH_LINKS]; /* results of robot_connect() */
};

/*
 * A force along a transmission: gear*(gain*control + bias[0] + bias[1]*gear*length + bias[2]*gear*rate). The gain is
 * gain[0] + gain[1]*gear*length + gain[2]*gear*rate.
 */
struct Actuator {
  char *name;
  long line;
  struct Transmission transmission; /* of one joint, or that of a tendon; empty with a wrench */
  struct Wrench *wrench;            /* NULL for a force along the transmission */
  double gear, gain[3], bias[3];
  enum ActuatorDynamics dynamics;
  double time_constant; /* s; of a filter */
  double activation[2]; /* limits of the activation; NAN for none */
  double start_activation;
  double start;                /* of the control */
  double control[2], force[2]; /* limits of the control, and of the force before the gear; NAN for none */
};

/* Closes a kinematic loop: the origins of two links coincide, and their axes too if is_fixed. */
struct RobotLoop {
  char *name, *link_names[2];
  struct RobotLink *links[2]; /* results of robot_connect() */
  long line;
  bool is_fixed;
};

/* Two shapes that touch each other: collisions of links by their indices. friction: NAN if the file gives none. */
struct ShapePair {
  struct RobotLink *links[2];
  size_t indices[2];
  double friction;
  long line;
};

/* A fluid around the robot, in SI units; zeros for none. */
struct Fluid {
  double density, viscosity, wind[3];
};

static inline bool fluid_acts(const struct Fluid *fluid) {
  return fluid->density > 0 || fluid->viscosity > 0;
}

/* A robot. After robot_connect() its links form a tree. */
struct Robot {
  char *name;
  long line;
  struct RobotLink **links;
  struct RobotJoint **joints;
  struct Tendon *tendons;
  struct Actuator *actuators;
  struct RobotLoop *loops;
  struct Coupling *couplings;
  struct ShapePair *pairs;
  size_t pair_count;
  size_t link_count, joint_count, tendon_count, actuator_count, loop_count, coupling_count;
  double gravity[3]; /* m/s2 */
  struct Fluid fluid;
  struct Collision *ground; /* plane of the ground, normal to its z axis; NULL for z = 0 */
  struct RobotLink *root;
};
