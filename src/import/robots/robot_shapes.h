/* Converts <collision>s and <visual>s of a robot to shapes, and writes the ground and contacts with it. */
#pragma once

#include "robots/robot_elements.h"

/* Returns a coefficient of friction, or the usual one if it is NAN. */
double shape_friction(double friction);

/* Writes PREFIX_stiffness, PREFIX_damping and PREFIX_friction. friction: NAN where contacts differ. */
void write_contact_parameters(const struct Writer *writer, const struct Robot *robot, const char *prefix,
                              double friction);

/* Writes a compliant contact with these parameters. friction: its own coefficient; NAN for that of the parameter. */
void write_shape_contact(const struct Writer *writer, char *name, char *const shapes[2], const char *prefix,
                         double friction);

/* Writes the plane z = 0, or that of the file, and the parameters of contacts with it. */
void write_ground(struct Writer *writer, const struct Robot *robot);

/*
 * Writes the shapes LINK_collision1, ... and LINK_visual1, ... of a link. If the link moves and there is a ground, also
 * writes the contacts LINK_ground1, ... of the former.
 */
void write_shapes(struct Writer *writer, const struct RobotLink *link, bool moves);
