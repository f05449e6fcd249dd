/* Meshes in STL format, as text or binary. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "model/mesh.h"

/* Reads bytes with a terminating zero into an empty mesh. Returns false with a message in *problem on errors. */
bool stl_read(const char *bytes, size_t length, struct Mesh *mesh, char **problem);
