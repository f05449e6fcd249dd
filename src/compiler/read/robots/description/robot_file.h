/* What the readers of robots share: a file's numbers and names, and what was left out of it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "read/robots/description/robot.h"

enum { LEFT_OUT_LIMIT = 20, UNREAD_LIMIT = 100, NUMBERS_LIMIT = 64 };

struct RobotFile {
  struct Robot *robot;
  const struct RobotOptions *options;
  struct Diagnostics *diagnostics;
  char *left_out[LEFT_OUT_LIMIT]; /* kinds of elements that were not read */
  size_t left_out_count;
  char *unread[UNREAD_LIMIT]; /* what warn_unread() has reported */
  size_t unread_count;
  char *mesh_problem;   /* of the first mesh that cannot be drawn; NULL for none */
  size_t mesh_problems; /* how many there are */
};

/* The next of several names with blanks between them, which *rest then stands behind; NULL for none. */
char *next_name(const char **rest);

void leave_out(struct RobotFile *file, const char *what);

/* Notes the elements inside that are none of these names, of which the last is NULL. */
void leave_out_others(struct RobotFile *file, xmlNodePtr parent, const char *const *names);

/* Warns once of something that is not read and may change the motion, with the remedy. */
void warn_unread(struct RobotFile *file, long line, const char *what, const char *remedy);

/* True of a text that asks for nothing: "false", "none", "auto", "disable", or numbers that are all 0. */
bool says_nothing(const char *text);

/* When an attribute acts: with any <include>, or one that asks for a ground, or for stops. */
enum Condition { ALWAYS_ACTS, ACTS_ON_GROUND, ACTS_AT_STOPS };

bool condition_holds(const struct RobotOptions *options, enum Condition condition);

/* Attributes of elements, names with blanks between them: read or without influence where there is no remedy, else not read. */
struct Attributes {
  const char *elements, *names, *remedy;
  enum Condition condition;
};

/*
 * Warns of attributes in the element, and all that is in it, that are not read and may change the motion: those with a remedy, and
 * any others of an element in the table. The last row has no elements.
 */
void check_attributes(struct RobotFile *file, xmlNodePtr node, const struct Attributes *table);

/* Notes why a mesh cannot be drawn; NULL for nothing. */
void note_mesh_problem(struct RobotFile *file, char *problem);

/* As pages have it, such as "#ff8000ff", by shares of red, green, blue, and how little is seen through it. */
char *color_text(const double rgba[4]);

/* Warns of all that was left out, unless there were errors. */
void tell_left_out(struct RobotFile *file);

/* The one element of this name in another one; NULL where there is none. */
xmlNodePtr child_of(struct RobotFile *file, xmlNodePtr parent, const char *name);
xmlNodePtr required_child_of(struct RobotFile *file, xmlNodePtr parent, const char *name);

/* "" after reporting that there is none. */
char *required_attribute(struct RobotFile *file, xmlNodePtr node, const char *name);

/* Finite decimal numbers with blanks between them, as many as the limit at most; how many; 0 where the text is anything else. */
size_t parse_numbers(const char *text, size_t limit, double *values);

/* One number or three; leaves the values as they are where there is no such attribute, or no such element (NULL); returns whether there is. */
bool read_numbers(struct RobotFile *file, xmlNodePtr node, const char *name, size_t count, double *values);
double required_number(struct RobotFile *file, xmlNodePtr node, const char *name);
double number_not_negative(struct RobotFile *file, xmlNodePtr node, const char *name);

/* Whether the shapes of a link of this name touch a ground. */
bool link_touches_ground(const struct RobotOptions *options, const char *link);

void add_link(struct RobotFile *file, struct Link *link);
void add_joint(struct RobotFile *file, struct Joint *joint);
