/* Writes the elements of the <system> that a robot is converted to. */
#pragma once

#include <libxml/tree.h>

#include "robots/description/robot.h"
#include "robots/description/robot_options.h"

/* The system under construction. */
struct Writer {
  xmlNodePtr system;
  long line; /* of the current link or joint in the robot file, for messages */
  const struct RobotOptions *options;
  bool has_own_frictions; /* shapes have different coefficients of friction on the ground */
  double base_height;     /* start of a floating base along z, in m */
};

xmlNodePtr write_element_in(const struct Writer *writer, xmlNodePtr parent, const char *name);

/* Writes an element with attributes, each by its name and its value; NULL follows the last one. */
xmlNodePtr write_element(const struct Writer *writer, const char *name, ...) __attribute__((sentinel));

void set_attribute(xmlNodePtr node, const char *attribute, const char *value);
void set_content(xmlNodePtr node, const char *text);

/* Sets an attribute; omits 0, the default of attributes. */
void set_number(xmlNodePtr node, const char *attribute, double value);

xmlNodePtr write_parameter(const struct Writer *writer, const char *name, double value, const char *unit,
                           const char *description);
void write_output(const struct Writer *writer, const char *name, const char *unit, const char *expression,
                  const char *description);

/* Writes a <coordinate> with the velocity NAME_velocity. */
xmlNodePtr write_coordinate(const struct Writer *writer, const char *name, const char *unit, const char *description);

/* Writes a displacement, and rotations about the fixed axes, in a <frame>. */
void write_placement(const struct Writer *writer, xmlNodePtr frame, const struct Placement *placement);

/* Returns the expression restricted to the limits; the expression itself if they are NAN. */
char *clamped(const double limits[2], char *expression);

/*
 * Like write_coordinate(), with an input NAME_force, or NAME_torque for an angle, and its <force>. effort: largest
 * magnitude of the force; NAN for no limit. Returns the <coordinate>.
 */
xmlNodePtr write_motor(const struct Writer *writer, const char *name, const char *unit, double effort,
                       const char *description);

/* Writes the output NAME_beyond: the distance of the value NAME from its limits, 0 within them. */
void write_excess_of_limits(const struct Writer *writer, const char *name, const char *unit, const char *lower,
                            const char *upper);

/* Writes the contacts NAME_min and NAME_max, which keep a position within its limits. */
void write_end_contacts(const struct Writer *writer, const char *name, const char *unit, const char *position,
                        const char *lower, const char *upper);

/* Returns the shortest text of a number. */
char *number(double value);

/* Returns "factor*name", without a factor of 1. */
char *term(double factor, const char *name);
