/* Meshes in Wavefront's OBJ: its points and polygons. */
#pragma once

#include <stdbool.h>

#include "model/mesh.h"

/* Reads the text into an empty mesh, polygons as triangles; false with what is wrong in *problem. */
bool obj_read(const char *text, struct Mesh *mesh, char **problem);
