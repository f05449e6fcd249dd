/* <particle> and <body>, planar ones and those in frames, and <point>. */
#pragma once

#include "read/context/attributes.h"

/* Enters a body, particle or point into the model, with its energy and its places; of a <frame>, the places. */
void read_body(struct Reader *reader, xmlNodePtr node);

/* Notes the number of a body or particle among those of its file. */
void number_body(struct Reader *reader, xmlNodePtr node);

/* The own name of a body, particle, point or frame, or one by the number of a body or particle. */
char *name_of_body(struct Reader *reader, xmlNodePtr node);

/* NULL where there is none of this name. */
const struct Body *find_body(const struct Reader *reader, const char *name);
