/* Meshes in STL, as text or binary. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "model/mesh.h"

/* Reads the bytes, behind which stands a 0, into an empty mesh; false with what is wrong in *problem, such as "is cut short". */
bool stl_read(const char *bytes, size_t length, struct Mesh *mesh, char **problem);
