/* Corners of a mesh's convex hull, for contacts. See hull.c for the method. */
#pragma once

#include <stdbool.h>

#include "model/mesh.h"

/* Finds the corners of the hull once. Returns false if all points lie in a plane, to 1e-5 of the largest side. */
bool mesh_find_corners(struct Mesh *mesh);
