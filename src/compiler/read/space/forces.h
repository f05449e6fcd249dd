/* <force>, <torque> and <gravity>. */
#pragma once

#include "algebra/differentiate.h"
#include "read/context/attributes.h"

/*
 * Adds the generalized forces Q_i = F dr/dq_i of a force F along r, and its power F dr/dt. gradient: derivatives of
 * r with respect to coordinates and time, or of its rate with respect to velocities.
 */
void add_virtual_work(struct Model *model, Node force, const struct Gradient *gradient);

/*
 * Adds a force along a component of a position. displaced: the position as a function of displacements. name: of the
 * body, for messages.
 */
void add_force_along(struct Reader *reader, long line, const char *name, Node displaced, Node force);

/* Adds a torque, given along the base's axes, on a frame. */
void add_torque_on(struct Reader *reader, long line, struct Vector torque, const struct ReferenceFrame *frame);

void read_force(struct Reader *reader, xmlNodePtr node);
void read_torque(struct Reader *reader, xmlNodePtr node);

/* Adds the gravitational potential of all bodies in the current file. */
void read_gravity(struct Reader *reader, xmlNodePtr node);

/* Returns the coordinate of this name; NULL for none. */
const struct Symbol *find_coordinate(const struct Reader *reader, const char *name);
