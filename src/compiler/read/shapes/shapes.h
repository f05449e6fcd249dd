/* <shape>: the geometry of a frame, body or particle, for drawing and for contacts; or a plane. */
#pragma once

#include "read/context/attributes.h"

/* Declares the name and type of a shape, which contacts below it refer to. */
void declare_shape(struct Reader *reader, xmlNodePtr node);

/* Reads its position and size, when all frames are known. */
void place_shape(struct Reader *reader, xmlNodePtr node);

/* Returns the shape that an attribute names; NULL after reporting that there is none. */
const struct ContactShape *shape_of_attribute(struct Reader *reader, xmlNodePtr node, const char *attribute);
