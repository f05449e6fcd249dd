/* Meshes in Wavefront's OBJ format: vertices and polygons. */
#pragma once

#include <stdbool.h>

#include "model/mesh.h"

/* Reads the text into an empty mesh of triangles. Returns false with a message in *problem on errors. */
bool obj_read(const char *text, struct Mesh *mesh, char **problem);
