/* <force>, <torque> and <gravity>. */
#pragma once

#include "algebra/differentiate.h"
#include "read/context/attributes.h"

/*
 * Adds a force F along r: generalized forces Q_i = F dr/dq_i, and the power F dr/dt. levers: the derivatives of r by
 * coordinates and time, or of its rate by velocities.
 */
void add_virtual_work(struct Model *model, Node force, const struct Gradient *levers);

/* Adds a force along a component of a position, which is a function of displacements too; name: of what it acts on. */
void add_force_along(struct Reader *reader, long line, const char *name, Node displaced, Node force);

/* Adds a torque along the base's axes on what turns with a frame. */
void add_torque_on(struct Reader *reader, long line, struct Vector torque, const struct ReferenceFrame *frame);

void read_force(struct Reader *reader, xmlNodePtr node);
void read_torque(struct Reader *reader, xmlNodePtr node);

/* Adds the potential of the weight of all bodies of the file. */
void read_gravity(struct Reader *reader, xmlNodePtr node);

/* The coordinate of this name, NULL where there is none. */
const struct Symbol *find_coordinate(const struct Reader *reader, const char *name);
