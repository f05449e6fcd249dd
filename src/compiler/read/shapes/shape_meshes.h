/* Meshes of <shape type="mesh">. */
#pragma once

#include "read/context/attributes.h"

/* Returns the mesh of an element; equal files and scales share one mesh. NULL after reporting an error. */
struct Mesh *mesh_of_shape(struct Reader *reader, xmlNodePtr node);

/* Finds the corners at which a mesh touches, and notes if there are more. Returns false after reporting a flat mesh. */
bool prepare_corners(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shape);

/* Warns of the meshes that have more corners. */
void warn_of_coarse_meshes(const struct Reader *reader);
