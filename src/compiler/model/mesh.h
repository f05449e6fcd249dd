/* A surface of triangles, as read from a file. */
#pragma once

#include <stddef.h>

/* Most corners at which a mesh may touch; each costs a contact. */
enum { MOST_CORNERS = 32 };

/* A surface. Each of its points belongs to a triangle. */
struct Mesh {
  double (*points)[3]; /* m, along the mesh's own axes */
  size_t point_count;
  size_t (*triangles)[3]; /* indices of points */
  size_t triangle_count;  /* above 0 */
  /*
   * Vertices of the convex hull, as found by mesh_find_corners(): without those that lie closer to the hull of the
   * others than its tolerance.
   */
  size_t corners[MOST_CORNERS]; /* indices of points, ascending */
  size_t corner_count;          /* 0 until they are found */
  double residual;              /* m: distance of the farthest point outside the hull of the corners */
};

/* Returns the longest side of the bounding box, and its least corner, in m. */
double mesh_size(const struct Mesh *mesh, double least[3]);
