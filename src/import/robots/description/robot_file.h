/* Shared by the readers of robots: numbers and names of a file, and its parts that are not read. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "robots/description/robot.h"
#include "robots/description/robot_options.h"

/*
 * Limits: names of elements that are listed as left out, attributes that are reported as not read, numbers in an
 * attribute.
 */
enum { LEFT_OUT_LIMIT = 20, UNREAD_LIMIT = 100, NUMBERS_LIMIT = 64 };

/* A robot's file while it is read, with the parts of it that are not read. */
struct RobotFile {
  struct Robot *robot;
  const struct RobotOptions *options;
  struct Diagnostics *diagnostics;
  char *left_out[LEFT_OUT_LIMIT]; /* names of elements that do not influence the motion */
  size_t left_out_count;
  char *unread[UNREAD_LIMIT]; /* reported by warn_unread() */
  size_t unread_count;
  char *mesh_problem;   /* of the first mesh that cannot be drawn; NULL for none */
  size_t mesh_problems; /* number of such meshes */
  char *untouched; /* of the first shape that should touch the ground, and cannot: what it is and why; NULL for none */
  long untouched_line;
  size_t untouched_count;
};

/* Returns the next of several names separated by blanks and advances *rest past it; NULL at the end. */
char *next_name(const char **rest);

/* Records a part of the file that is not read, each once, for one common message. */
void leave_out(struct RobotFile *file, const char *what);

/* Records child elements with names that are not in the list, which ends with NULL. */
void leave_out_others(struct RobotFile *file, xmlNodePtr parent, const char *const *names);

/* Warns once per text of a part that is not read and may change the motion. remedy: completes "expected ...". */
void warn_unread(struct RobotFile *file, long line, const char *what, const char *remedy);

/* True if a text requests nothing: "false", "none", "auto", "disable", or zeros. */
bool requests_nothing(const char *text);

/* When an attribute influences the motion: always, with a ground, or with stops. */
enum Condition { ALWAYS_ACTS, ACTS_ON_GROUND, ACTS_AT_STOPS, ACTS_BETWEEN_LINKS };

/* True if an attribute with this condition influences the motion under these options. */
bool condition_holds(const struct RobotOptions *options, enum Condition condition);

/*
 * Names of elements and attributes, separated by blanks. Without remedy they are read or irrelevant; with one they are
 * not read under the condition.
 */
struct Attributes {
  const char *elements, *names, *remedy;
  enum Condition condition;
};

/*
 * Warns of attributes in the element and its descendants that are not read and may change the motion. These have a
 * remedy, or the table does not list them for their element. The last row has no elements.
 */
void check_attributes(struct RobotFile *file, xmlNodePtr node, const struct Attributes *table);

/* Records a mesh that cannot be drawn; does nothing for NULL. */
void note_mesh_problem(struct RobotFile *file, char *problem);

/* Notes a shape that should touch the ground, and cannot. */
void note_untouched(struct RobotFile *file, long line, char *shape);

/* Returns a color such as "#ff8000ff" from red, green, blue and opacity between 0 and 1. */
char *color_text(const double rgba[4]);

/* Warns of all parts that were left out, unless there were errors. */
void report_left_out(struct RobotFile *file);

/* Return the only child element of this name; NULL for none. Report several, and a missing one if required. */
xmlNodePtr child_of(struct RobotFile *file, xmlNodePtr parent, const char *name);
xmlNodePtr required_child_of(struct RobotFile *file, xmlNodePtr parent, const char *name);

/* Returns the value of the attribute; "" after reporting that it is missing. */
char *required_attribute(struct RobotFile *file, xmlNodePtr node, const char *name);

/* Parses finite decimal numbers separated by blanks. Returns their count; 0 for other texts or above the limit. */
size_t parse_numbers(const char *text, size_t limit, double *values);

/*
 * Read one number or three from an attribute, and report errors. read_numbers() returns false and keeps the values if
 * the attribute or the node (NULL) is missing.
 */
bool read_numbers(struct RobotFile *file, xmlNodePtr node, const char *name, size_t count, double *values);
double required_number(struct RobotFile *file, xmlNodePtr node, const char *name);
double number_not_negative(struct RobotFile *file, xmlNodePtr node, const char *name);

/* True if the shapes of the link of this name touch a ground. */
bool link_touches_ground(const struct RobotOptions *options, const char *link);

void add_link(struct RobotFile *file, struct RobotLink *link);
void add_joint(struct RobotFile *file, struct RobotJoint *joint);
