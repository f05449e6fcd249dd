/* Meshes in MuJoCo's binary format MSH. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "model/mesh.h"

/* Reads bytes into an empty mesh. Returns false with a message in *problem on errors. */
bool msh_read(const char *bytes, size_t length, struct Mesh *mesh, char **problem);
