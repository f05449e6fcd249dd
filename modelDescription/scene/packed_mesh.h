/* Meshes as pages draw them: coarse enough to be small, and as text. */
#pragma once

#include "model/mesh.h"

/* A mesh is drawn by at most so many triangles, which are less than 130 kB. */
enum { MOST_DRAWN = 4000 };

/* Base64 of unsigned numbers of 16 bits, the least byte first: three of each point, and three of each triangle. */
struct PackedMesh {
  char *points;          /* a coordinate is that of the least corner, plus the number times the step */
  char *triangles;       /* places of points */
  double least[3], step; /* m */
};

/* Points that come into one cell of a grid become the first of them; the grid is the finest with few enough triangles. */
struct PackedMesh pack_mesh(const struct Mesh *mesh);
