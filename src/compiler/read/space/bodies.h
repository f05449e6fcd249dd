/* <particle>, <body> and <point>, in the plane or in frames. */
#pragma once

#include "read/context/attributes.h"

/* Adds a body, particle or point with its kinetic energy and components to the model; of a <frame> the components. */
void read_body(struct Reader *reader, xmlNodePtr node);

/* Assigns a body or particle its number within its file. */
void number_body(struct Reader *reader, xmlNodePtr node);

/*
 * Returns the full name of a body, particle, point or frame. Unnamed bodies and particles get a name with their number.
 * NULL after an error.
 */
char *name_of_body(struct Reader *reader, xmlNodePtr node);

/* Returns the body of this name; NULL for none. */
const struct Body *find_body(const struct Reader *reader, const char *name);
