/* <shape>: a plane, or what a frame, body or particle looks like and touches with. */
#pragma once

#include "read/context/attributes.h"

/* Makes its name and type known, which the contacts below it need. */
void declare_shape(struct Reader *reader, xmlNodePtr node);

/* Reads where it is and how large, when all frames are known. */
void place_shape(struct Reader *reader, xmlNodePtr node);

/* The shape that an attribute names; NULL after reporting that there is none. */
const struct ContactShape *shape_of_attribute(struct Reader *reader, xmlNodePtr node, const char *attribute);
