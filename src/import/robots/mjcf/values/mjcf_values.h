/* An MJCF file while it is read, and values of attributes, from elements or their default classes. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "names/names.h"
#include "robots/description/robot_file.h"
#include "robots/expansion/mjcf_replicas.h"

/* MuJoCo's groups 0 to 30 of actuators. */
enum { ACTUATOR_GROUPS = 31 };

enum InertiaFromGeoms { WHERE_MISSING, ALWAYS, NEVER };

/* Contact attributes of a geom. */
struct MjcfContact {
  xmlNodePtr node, body, moving; /* geom, or NULL; its body; nearest body with a joint, else <worldbody> */
  char *name, *body_name;        /* "" for none */
  struct RobotLink *link;        /* has the geom among its collisions, at the index */
  size_t index;
  double friction;   /* coefficient of sliding friction */
  double dimensions; /* condim: 1 without friction, 3 with sliding friction, 4 also torsional, 6 also rolling */
  double priority;
  unsigned type, affinity; /* bit masks: two geoms touch if one's type and the other's affinity have a common bit */
};

/* A <pair> of geoms that touch, or an <exclude> of bodies that do not. */
struct ContactRule {
  xmlNodePtr node;
  char *names[2];
  bool is_pair;
};

/* The settings of a file, by its <compiler>. */
struct MjcfCompiler {
  struct EulerAngles angles;
  bool has_automatic_limits, aligns_free;
  enum InertiaFromGeoms inertia_from_geoms;
  double least_mass, least_moment; /* of each body, and of its principal moments */
  bool balances_moments;           /* moments that no body can have become their mean */
  bool fits_bounds;                /* shapes are fitted to the bounding boxes of meshes */
  double inertia_groups[2];        /* geoms of groups in this range have a mass */
  char *mesh_folder;               /* folder of mesh files, relative to the file; NULL for its own */
  char *file;                      /* relative to the robot's file; NULL for that */
};

/* An MJCF file while it is read. */
struct Mjcf {
  struct RobotFile file;
  xmlNodePtr root;
  struct MjcfCompiler *compilers;       /* of the robot's file, and of each attached one */
  size_t attached_count;                /* of attached files */
  double total_mass;                    /* kg; of all bodies together; -1 for the sum in the file */
  size_t unnamed_count;                 /* number of bodies without a name so far */
  struct Names *meshes;                 /* used meshes by name -> struct MjcfMesh */
  struct MjcfContact ground, *contacts; /* of the ground plane, and of all other geoms that touch */
  struct ContactRule *rules;
  size_t contact_count, rule_count;
  bool has_no_contacts, touches_parents; /* set by <flag> */
  unsigned disabled;                     /* a bit for each feature in mjcf_flags.c */
  bool is_off[ACTUATOR_GROUPS];          /* disabled groups of actuators */
  struct Names *bodies;                  /* names of bodies */
  struct Names *placements; /* bodies and sites -> struct Placement in the world, with all joints at their ref */
};

/* Reports an error on the line of an element. */
#define mjcf_error(mjcf, node, ...) report_error((mjcf)->file.diagnostics, line_of(node), __VA_ARGS__)

/* Returns the settings of the file that an element belongs to. */
const struct MjcfCompiler *mjcf_compiler(const struct Mjcf *mjcf, xmlNodePtr node);

/* Returns an attribute of the element or of its classes, innermost first; NULL if none has it. */
const char *mjcf_text(const struct Mjcf *mjcf, xmlNodePtr node, const char *name);

/*
 * True if the first of two attributes prevails: the element has it, or of its classes with either one the innermost has
 * it. Reports both in one place.
 */
bool mjcf_prevails(struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *other);

/* Reports an actuator whose gain and bias MuJoCo would take from <default>s of another kind. */
void mjcf_check_laws(struct Mjcf *mjcf, xmlNodePtr node);

/* Reports classes that are undefined or defined twice, in an element and its descendants. */
void mjcf_check_classes(struct Mjcf *mjcf, xmlNodePtr node);

/*
 * Reads least to most numbers and returns their count. If the attribute is missing, or after reporting an error,
 * returns 0 and keeps the values.
 */
size_t mjcf_numbers(struct Mjcf *mjcf, xmlNodePtr node, const char *name, size_t least, size_t most, double *values);

/* Returns a number; usual if the attribute is missing. */
double mjcf_number(struct Mjcf *mjcf, xmlNodePtr node, const char *name, double usual);

/* Like mjcf_number(), but reports negative numbers. */
double mjcf_number_not_negative(struct Mjcf *mjcf, xmlNodePtr node, const char *name, double usual);

/* True if the attribute of an element, or of its default class, has this value. */
bool mjcf_is(const struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *value);

/* Returns the index of the value among the words, which end with NULL; 0 if it is missing. Reports others. */
size_t mjcf_word(struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *const *words);

/* Returns the placement by pos and one of quat, axisangle, euler, xyaxes, zaxis. */
struct Placement mjcf_placement(struct Mjcf *mjcf, xmlNodePtr node);

/* Returns the shortest rotation that takes z to this direction, which is not 0. */
struct Matrix3 rotation_of_z(const double direction[3]);

/* Normalizes a vector and returns its length; keeps a zero vector. */
double make_unit(double vector[3]);

/* Sets the limits of `range`, if the attribute `is_limited` or its default says that they apply; else NAN. */
void mjcf_limits(struct Mjcf *mjcf, xmlNodePtr node, const char *range, const char *is_limited, double limits[2]);

/*
 * Reports an element that is not supported and would change the motion, the first of its name in parents of one name.
 * remedy: completes "expected ...".
 */
void mjcf_report_unknown(struct Mjcf *mjcf, xmlNodePtr node, const char *remedy);

/* Reports attributes that are not supported and would change the motion, unless they are 0, false, none or missing. */
void mjcf_reject(struct Mjcf *mjcf, xmlNodePtr node, const char *names);
