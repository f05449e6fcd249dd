/* <force>, <torque> and <gravity>. */
#pragma once

#include "read/context/attributes.h"

void read_force(struct Reader *reader, xmlNodePtr node);
void read_torque(struct Reader *reader, xmlNodePtr node);

/* Adds the potential of the weight of all bodies of the file. */
void read_gravity(struct Reader *reader, xmlNodePtr node);

/* The coordinate of this name, NULL where there is none. */
const struct Symbol *find_coordinate(const struct Reader *reader, const char *name);
