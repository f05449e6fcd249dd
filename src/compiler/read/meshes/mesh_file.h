/* Files of meshes. */
#pragma once

#include "model/mesh.h"

/*
 * Reads an STL or OBJ file, its coordinates multiplied by the scale: m for each unit of the file. NULL with what is wrong, and was expected,
 * in *problem.
 */
struct Mesh *mesh_read(const char *path, const double scale[3], char **problem);
