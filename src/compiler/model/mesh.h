/* A surface of triangles, as files of meshes give it. */
#pragma once

#include <stddef.h>

/* Of the corners, at which a mesh touches. */
enum { MOST_CORNERS = 32 };

struct Mesh {
  double (*points)[3]; /* m, in the mesh's own axes */
  size_t point_count;
  size_t (*triangles)[3]; /* places of points */
  size_t triangle_count;  /* above 0 */
  /* What mesh_find_corners() finds: the corners of the convex hull, but for what is nearer to the others' hull than is told of. */
  size_t corners[MOST_CORNERS]; /* places of points in ascending order */
  size_t corner_count;          /* 0: not asked for yet */
  double lack;                  /* m, how far the farthest point lies beyond a face of the corners' hull */
};

/* The largest side of the box about it, and that box's least corner, both in m. */
double mesh_side(const struct Mesh *mesh, double least[3]);
