/* What attributes of MJCF say: in an element or by its class, in numbers, and as places. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "read/names/names.h"
#include "read/robots/description/robot_file.h"

enum { ACTUATOR_GROUPS = 31 };

enum InertiaFromGeoms { WHERE_MISSING, ALWAYS, NEVER };

/* How a geom touches others. */
struct MjcfContact {
  xmlNodePtr node, body, moving; /* of the geom, NULL for none; its body; what moves this, else the <worldbody> */
  char *name, *body_name;        /* "" for none */
  double friction;               /* coefficient of sliding friction */
  double dimensions; /* of the force: 1 without friction, 3 with it, 4 and 6 with that of spinning, and rolling */
  double priority;
  unsigned type, affinity; /* masks: two touch where one's type and the other's affinity have a bit in common */
};

/* A <pair> of geoms that touch, or an <exclude> of bodies that do not. */
struct ContactRule {
  xmlNodePtr node;
  char *names[2];
  bool is_pair;
};

struct Mjcf {
  struct RobotFile file;
  xmlNodePtr root;
  double angle; /* rad of the file's unit of angles */
  const char *euler_sequence;
  bool has_automatic_limits;
  enum InertiaFromGeoms inertia_from_geoms;
  double inertia_groups[2];             /* geoms of groups between these have a mass */
  size_t unnamed_count;                 /* bodies without a name so far */
  char *mesh_folder;                    /* of the meshes' files, relative to the robot's; NULL for that itself */
  struct Names *meshes;                 /* that geoms have -> struct MjcfMesh */
  struct MjcfContact ground, *contacts; /* of the plane that is the ground, and of all other geoms that touch */
  struct ContactRule *rules;
  size_t contact_count, rule_count;
  bool has_no_contacts, touches_parents; /* by <flag> */
  bool is_off[ACTUATOR_GROUPS];          /* groups of actuators without force */
  struct Names *places; /* of bodies and sites -> struct Placement in the world, with all joints at their ref */
};

/* An attribute of the element, or of its class or what this inherits; NULL where none of them has it. */
const char *mjcf_text(const struct Mjcf *mjcf, xmlNodePtr node, const char *name);

/* Reports an actuator whose gain and bias would be set by <default>s of another kind. */
void mjcf_check_laws(struct Mjcf *mjcf, xmlNodePtr node);

/* Reports classes that are not defined, or twice, in an element and all that is in it. */
void mjcf_check_classes(struct Mjcf *mjcf, xmlNodePtr node);

/* As many numbers as there are, least to most; 0 where there is none, which leaves the values as they are, or after reporting a mistake. */
size_t mjcf_numbers(struct Mjcf *mjcf, xmlNodePtr node, const char *name, size_t least, size_t most, double *values);

/* One number, of which the usual one is given. */
double mjcf_number(struct Mjcf *mjcf, xmlNodePtr node, const char *name, double usual);

/* The same, of which a negative one is reported. */
double mjcf_number_not_negative(struct Mjcf *mjcf, xmlNodePtr node, const char *name, double usual);

bool mjcf_is(const struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *value);

/* Which of the words, the last of which is NULL, the attribute is; the first where it is missing; reports any other. */
size_t mjcf_word(struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *const *words);

/* The place by pos and one of quat, axisangle, euler, xyaxes, zaxis. */
struct Placement mjcf_placement(struct Mjcf *mjcf, xmlNodePtr node);

/* The turn that brings z along this direction, which is not 0. */
struct Matrix3 rotation_of_z(const double direction[3]);

/* By a quaternion of any length but 0, the real part first. */
struct Matrix3 rotation_of_quaternion(const double q[4]);

/* Divides a vector by its length, and returns this; leaves a 0. */
double make_unit(double vector[3]);

/* Limits by the range and the attribute that says whether it holds; NAN for none. */
void mjcf_limits(struct Mjcf *mjcf, xmlNodePtr node, const char *range, const char *is_limited, double limits[2]);

/* Reports an element that is not read, with what to do about it. */
void mjcf_report_unknown(struct Mjcf *mjcf, xmlNodePtr node, const char *remedy);

/* Reports an attribute that is not 0, false, none or missing, since it would change the motion. */
void mjcf_refuse(struct Mjcf *mjcf, xmlNodePtr node, const char *name);
