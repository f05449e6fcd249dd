/* Elements of the <system> that a robot becomes. */
#pragma once

#include <libxml/tree.h>

#include "read/robots/description/robot.h"

/* The system as it is written. */
struct Writer {
  xmlNodePtr system;
  long line; /* of the link or joint in the file of which the elements tell */
  const struct RobotOptions *options;
  bool has_own_frictions; /* shapes differ in their friction on the ground */
};

xmlNodePtr write_element_in(const struct Writer *writer, xmlNodePtr parent, const char *name);
xmlNodePtr write_element(const struct Writer *writer, const char *name);

void set_attribute(xmlNodePtr node, const char *attribute, char *value);
void set_content(xmlNodePtr node, char *text);

/* Leaves a 0 out, which is what a missing attribute means. */
void set_number(xmlNodePtr node, const char *attribute, double value);

xmlNodePtr write_parameter(const struct Writer *writer, char *name, double value, const char *unit, char *description);
void write_output(const struct Writer *writer, char *name, const char *unit, char *expression, char *description);

/* A coordinate and NAME_velocity. */
xmlNodePtr write_coordinate(const struct Writer *writer, const char *name, const char *unit, const char *description);

/* What keeps an expression between two limits; the expression itself where they are NAN. */
char *clamped(const double limits[2], char *expression);

/*
 * The same with the input NAME_force, or NAME_torque for an angle, of which no more than the effort acts; NAN for all of it.
 * Returns the coordinate.
 */
xmlNodePtr write_motor(const struct Writer *writer, const char *name, const char *unit, double effort,
                       const char *description);

/* The output NAME_beyond, which tells how far the value of this name is beyond its limits. */
void write_beyond(const struct Writer *writer, const char *name, const char *unit, const char *lower,
                  const char *upper);

/* The contacts NAME_min and NAME_max, which keep a position between its limits. */
void write_end_contacts(const struct Writer *writer, const char *name, const char *unit, const char *position,
                        const char *lower, const char *upper);

/* The number in short. */
char *number(double value);

/* "factor*name" in short. */
char *term(double factor, const char *name);
