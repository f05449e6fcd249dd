/*
 * The corners of a mesh's convex hull. Points are compared on a grid of 2^20 steps along the mesh's largest side, on which all signs are exact,
 * so that points that coincide or lie in a plane need no care. Corners are taken one by one, the farthest from the hull of those before
 * it first, until none is farther than 1e-5 of the largest side.
 */
#pragma once

#include <stdbool.h>

#include "model/mesh.h"

/* Finds them once; false where the points are in a plane, to 1e-5 of the largest side. */
bool mesh_find_corners(struct Mesh *mesh);
