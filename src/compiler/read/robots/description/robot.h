/* A robot as its URDF or MJCF describes it: links, and joints that connect them to a tree. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "read/robots/description/rigid_body.h"

enum JointType { FIXED, REVOLUTE, CONTINUOUS, PRISMATIC, FLOATING, PLANAR, BALL, JOINT_TYPES };

/* What a link touches with, or looks like: a <shape> of this type, in the link's frame. */
struct Collision {
  const char *type;
  struct Placement place;
  double radius, length, size[3]; /* m, of a cylinder along its z, of a box */
  char *file;                     /* of a mesh, relative to the robot's; NULL of other types */
  double scale[3];                /* of a mesh: m for each unit of the file */
  char *color;                    /* such as "#ff8000ff"; NULL where the file gives none */
  double friction;                /* coefficient of its contact with the ground; NAN where the file gives none */
  bool is_clear;                  /* never touches the ground */
  long line;
};

struct Link {
  char *name;   /* as in the file */
  char *symbol; /* the same as a name of the language */
  long line;
  struct Collision *collisions, *visuals;
  size_t collision_count, visual_count; /* with visuals, these are drawn in place of the others */
  struct RigidBody body;                /* in the link's frame; without inertia where the file gives none */
  /* What robot_connect() finds: */
  struct Joint *joint;                     /* that carries the link; NULL of the root */
  struct Link *first_child, *next_sibling; /* in the order of the file */
  struct Link *next;                       /* parents before their children; NULL of the last */
  struct Link *carrier;     /* the link that moves, or the root, to which this one is fixed; itself if it moves */
  struct Placement place;   /* of this link in its carrier */
  struct RigidBody carried; /* of a carrier: all that is fixed to it, in its frame */
  bool moves_inertia;       /* of a carrier: it or what hangs on it has some */
};

/* Of its coordinates: one number, or of a FLOATING joint x, y, z and the quaternion, of which a BALL has the last four; these are 0 where the file says nothing. */
struct JointStart {
  double position[7], velocity[7];
};

struct Joint {
  char *name, *symbol;
  long line;
  enum JointType type;
  char *parent_name, *child_name;
  struct Placement origin; /* of the child in the parent, where the joint's coordinates are 0 */
  double axis[3];          /* of length 1, in the child */
  double lower, upper;     /* NAN: no limit */
  double damping, friction;
  double armature;        /* inertia of the motor, along the coordinate */
  double stiffness, rest; /* of a spring, and where it is relaxed */
  struct JointStart start;
  bool has_motor;      /* an input for its force or torque; what a file's actuators do comes beside this */
  double effort;       /* the largest force or torque of its motor; NAN: no limit */
  double push[2];      /* limits of what a file's actuators do together, along the coordinate; NAN: none */
  char *pushes;        /* where it has these: what the actuators do, a sum of expressions; NULL before the first */
  char *mimicked_name; /* NULL unless the joint's position is multiplier*(that of the mimicked one) + offset */
  double multiplier, offset;
  /* What robot_connect() finds: */
  struct Link *parent, *child;
  struct Joint *
      leader; /* the joint with the coordinate that gives the position ratio*(that of the leader) + shift; itself mostly */
  double ratio, shift;
  bool is_mimicked;
};

/* How much the length of a transmission grows with the position of a joint. */
struct Pull {
  char *joint_name;
  double coefficient;
  /* What robot_connect() finds: */
  struct Joint *joint;
  char *symbol; /* of the parameter that has the coefficient, where this has a unit; else NULL */
};

/* Its length is the sum of all coefficients times positions; or, through space, that of a line from site to site. */
struct Transmission {
  struct Pull *pulls;
  size_t count;
  char **site_names;
  struct Link **sites; /* as many, found by robot_connect() */
  size_t site_count;   /* 0 unless it is through space */
};

/* A spring, a damper, friction, an inertia and limits along a transmission. */
struct Tendon {
  char *name, *symbol; /* this set by robot_connect() */
  long line;
  struct Transmission transmission;
  double lower, upper; /* NAN: no limit */
  double stiffness, damping, friction, armature;
  double relaxed[2]; /* the lengths between which its spring is relaxed */
  double start;      /* its length where all joints are as placed */
};

enum { TENDON_POWERS = 5 };

/* One tendon is longer than at its start by a polynomial of what another is longer by. */
struct TendonLink {
  char *name;
  long line;
  size_t tendons[2];                 /* among the robot's */
  double coefficient[TENDON_POWERS]; /* of the powers from 0 on; 0 but for the first where there is no other */
};

/* It pushes along a transmission with gear*(gain*control + bias[0] + bias[1]*gear*length + bias[2]*gear*rate). */
struct Actuator {
  char *name;
  long line;
  struct Transmission transmission; /* of one joint, or a tendon's */
  double gear, gain, bias[3];
  double start;                /* of the control */
  double control[2], force[2]; /* limits of the control, and of the force before the gear; NAN: none */
};

/* Holds two links together, beside the tree of joints: their origins, and if it is fixed their axes too. */
struct RobotLoop {
  char *name, *link_names[2];
  struct Link *links[2]; /* set by robot_connect() */
  long line;
  bool is_fixed;
};

/* What an <include> says of a robot beyond its file. */
struct RobotOptions {
  bool floats;     /* the root link moves freely; else it stands in the inertial frame */
  bool has_stops;  /* limits stop the joints; else outputs tell how far these are beyond them */
  bool sticks;     /* the joints' friction is dry; else it lets them creep */
  bool has_ground; /* the links' shapes stand on a plane */
  bool says_ground, says_limits, says_effort; /* the <include> has these attributes, whatever they say */
  const char *standing;                       /* names of the links that do, between blanks; NULL for all that move */
  bool is_effort_limited;                     /* motors push and turn with no more than their effort */
  const char *keyframe;                       /* of MJCF, where the robot starts; NULL for its usual start */
  const char *
      tool; /* the link whose position and velocity are outputs; NULL: the only one without children, if there is one */
};

struct Robot {
  char *name;
  long line;
  struct Link **links;
  struct Joint **joints;
  struct Tendon *tendons;
  struct Actuator *actuators;
  struct RobotLoop *loops;
  struct TendonLink *tendon_links;
  size_t link_count, joint_count, tendon_count, actuator_count, loop_count, tendon_link_count;
  double gravity[3];        /* m/s2 */
  struct Collision *ground; /* the plane on which it stands, which points along its z; NULL: z = 0 */
  struct Link *root;
};
