/* Reads files of meshes. */
#pragma once

#include "model/mesh.h"

/*
 * Reads an STL or OBJ file and multiplies the coordinates by the scale, in m per unit of the file. Returns NULL with a
 * message in *problem on errors.
 */
struct Mesh *mesh_read(const char *path, const double scale[3], char **problem);
