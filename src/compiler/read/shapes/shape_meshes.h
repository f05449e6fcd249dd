/* <shape type="mesh">: what it reads of files. */
#pragma once

#include "read/context/attributes.h"

/* Reads the mesh that the element names, once for all that name it in the same scale; NULL after reporting what is wrong. */
struct Mesh *mesh_of_shape(struct Reader *reader, xmlNodePtr node);

/* Finds the corners at which a mesh touches, and tells where these are not all; false after reporting that it is flat. */
bool prepare_corners(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shape);
