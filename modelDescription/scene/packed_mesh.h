/* Meshes for pages: simplified, and encoded as text. */
#pragma once

#include "model/mesh.h"

/* Triangles of a simplified mesh, which take less than 130 kB. */
enum { MOST_DRAWN = 4000 };

/* Base64 of unsigned 16-bit numbers, low byte first: three for each point, and three for each triangle. */
struct PackedMesh {
  char *points;          /* coordinate = least + number * step */
  char *triangles;       /* indices of points */
  double least[3], step; /* m */
};

/* Simplifies a mesh by clustering its points in cells of a grid, the finest one that leaves few enough triangles. */
struct PackedMesh pack_mesh(const struct Mesh *mesh);
