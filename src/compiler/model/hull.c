/*
 * Convex hull of a mesh by incremental insertion of the farthest point, as in Quickhull. Points are rounded to a grid
 * of STEPS steps along the largest side of the bounding box. So the sign of
 *
 *   det(b - a, c - a, p - a),
 *
 * positive if p is outside of face abc, is exact in 64-bit integers: coincident and coplanar points need no special
 * cases.
 *
 * The hull begins as a tetrahedron of distant points. Each step finds the point farthest from the hull and removes
 * the faces that see it. It connects the horizon, the boundary of these faces, to the point. The loop ends when no
 * point is farther than the tolerance, or at MOST_CORNERS corners. Corners within the tolerance of the hull of the
 * others are then removed. If the hull was full, the search is repeated without them, which leaves fewer points
 * each time. A step costs points times faces, so that the total is linear in the number of points.
 *
 * C. B. Barber, D. P. Dobkin, H. Huhdanpaa, The Quickhull algorithm for convex hulls, ACM Trans. Math. Softw. 22
 * (1996).
 */
#include "model/hull.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/sorting.h"

/*
 * Steps of the grid along the largest side: a determinant of three differences is at most 6 * 2^60, which fits in 64
 * bits. A closed triangulated surface has fewer faces than twice its corners (Euler).
 */
enum { STEPS = 1 << 20, MOST_FACES = 2 * MOST_CORNERS };
static const double tolerance = 1e-5 * STEPS, tie = 2.0; /* in steps */

/* A point on the grid. */
struct Site {
  int64_t at[3];
  size_t point;      /* index into the mesh's points */
  bool is_redundant; /* not needed as a corner */
};

/* A triangle whose corners run anticlockwise seen from outside. */
struct Face {
  const struct Site *corners[3];
  int64_t normal[3]; /* outward, not normalized */
  double length;     /* of the normal */
};

/* A convex polyhedron. Each edge belongs to two faces, in opposite directions. */
struct Hull {
  struct Face faces[2 * MOST_FACES]; /* with room for new faces during a step */
  size_t face_count;
  const struct Site *corners[MOST_CORNERS];
  size_t corner_count;
};

static void difference(const struct Site *a, const struct Site *b, int64_t result[3]) {
  for (int i = 0; i < 3; i++) result[i] = a->at[i] - b->at[i];
}

static void cross(const int64_t a[3], const int64_t b[3], int64_t result[3]) {
  for (int i = 0; i < 3; i++) result[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double length_of(const int64_t vector[3]) {
  return hypot(hypot((double)vector[0], (double)vector[1]), (double)vector[2]);
}

static double distance(const struct Site *a, const struct Site *b) {
  int64_t between[3];
  difference(a, b, between);
  return length_of(between);
}

static struct Face face_of(const struct Site *a, const struct Site *b, const struct Site *c) {
  struct Face face = {.corners = {a, b, c}};
  int64_t along[3], across[3];
  difference(b, a, along);
  difference(c, a, across);
  cross(along, across, face.normal);
  face.length = length_of(face.normal);
  return face;
}

/* Returns the determinant above: positive if the site is outside of the face. The sign is exact. */
static int64_t height_over(const struct Face *face, const struct Site *site) {
  int64_t up[3];
  difference(site, face->corners[0], up);
  return face->normal[0] * up[0] + face->normal[1] * up[1] + face->normal[2] * up[2];
}

/*
 * Returns the largest signed distance of the site from a face, in steps, and sets that face. The site is in the hull if
 * it is not positive.
 */
static double beyond(const struct Hull *hull, const struct Site *site, const struct Face **farthest) {
  double most = -INFINITY;
  for (size_t i = 0; i < hull->face_count; i++) {
    double height = (double)height_over(&hull->faces[i], site) / hull->faces[i].length;
    if (!(height > most)) continue;
    most = height;
    *farthest = &hull->faces[i];
  }
  return most;
}

/* True if one of these faces has the directed edge from a to b. */
static bool has_edge(const struct Face *faces, size_t count, const struct Site *a, const struct Site *b) {
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++)
      if (faces[i].corners[k] == a && faces[i].corners[(k + 1) % 3] == b) return true;
  return false;
}

/* Inserts a corner: triangles to the horizon replace the faces that see it. Coplanar faces do not see it. */
static void add_corner(struct Hull *hull, const struct Site *site) {
  struct Face seeing[2 * MOST_FACES];
  size_t seeing_count = 0, kept = 0;
  for (size_t i = 0; i < hull->face_count; i++)
    if (height_over(&hull->faces[i], site) > 0) seeing[seeing_count++] = hull->faces[i];
    else hull->faces[kept++] = hull->faces[i];
  for (size_t i = 0; i < seeing_count; i++)
    for (int k = 0; k < 3; k++) {
      const struct Site *from = seeing[i].corners[k], *to = seeing[i].corners[(k + 1) % 3];
      if (!has_edge(seeing, seeing_count, to, from)) hull->faces[kept++] = face_of(from, to, site);
    }
  hull->face_count = kept;
  hull->corners[hull->corner_count++] = site;
}

/* Sets the hull to a tetrahedron of distant sites. Returns false if all are within `nearest` of a plane. */
static bool begin_hull(struct Hull *hull, const struct Site *sites, size_t count, double nearest) {
  const struct Site *corners[4] = {sites, sites, sites, sites};
  double most[4] = {0.0};
  for (size_t i = 0; i < count; i++) {
    double far = distance(&sites[i], corners[0]);
    if (!(far > most[1])) continue;
    corners[1] = &sites[i];
    most[1] = far;
  }
  for (size_t i = 0; i < count; i++) {
    double far = face_of(corners[0], corners[1], &sites[i]).length / most[1];
    if (!(far > most[2])) continue;
    corners[2] = &sites[i];
    most[2] = far;
  }
  struct Face base = face_of(corners[0], corners[1], corners[2]);
  for (size_t i = 0; i < count; i++) {
    double far = fabs((double)height_over(&base, &sites[i])) / base.length;
    if (!(far > most[3])) continue;
    corners[3] = &sites[i];
    most[3] = far;
  }
  if (!(most[2] > nearest && most[3] > nearest)) return false;
  bool is_above = height_over(&base, corners[3]) > 0;
  const struct Site *a = corners[0], *b = corners[is_above ? 2 : 1], *c = corners[is_above ? 1 : 2], *d = corners[3];
  *hull = (struct Hull){.faces = {face_of(a, b, c), face_of(b, a, d), face_of(c, b, d), face_of(a, c, d)},
                        .face_count = 4,
                        .corners = {a, b, c, d},
                        .corner_count = 4};
  return true;
}

/*
 * Returns, of the sites within `tie` of the farthest, the one farthest from the face's corners. It is a corner of the
 * convex hull of these sites.
 */
static const struct Site *choose_farthest(const struct Site **sites, size_t count, const struct Face *face,
                                          double height) {
  const struct Site *chosen = sites[0];
  double most = -1.0;
  for (size_t i = 0; i < count; i++) {
    if ((double)height_over(face, sites[i]) / face->length < height - tie) continue;
    double far = 0.0;
    for (int k = 0; k < 3; k++) far += pow(distance(sites[i], face->corners[k]), 2.0);
    if (!(far > most)) continue;
    chosen = sites[i];
    most = far;
  }
  return chosen;
}

/*
 * Inserts sites until none is farther than `nearest`, or the hull is full. Returns false if all sites lie in a plane.
 * *residual: largest distance of a site from the hull's faces, in steps.
 */
static bool grow_hull(struct Hull *hull, const struct Site *sites, size_t count, double nearest, double *residual) {
  if (!begin_hull(hull, sites, count, nearest)) return false;
  const struct Site **outside = allocate(count, sizeof(struct Site *));
  for (size_t i = 0; i < count; i++) outside[i] = &sites[i];
  for (;;) {
    const struct Face *farthest = &hull->faces[0];
    size_t left = 0;
    *residual = 0.0;
    for (size_t i = 0; i < count; i++) {
      const struct Face *face = farthest;
      double height = beyond(hull, outside[i], &face);
      if (height > 0.0) outside[left++] = outside[i];
      if (!(height > *residual)) continue;
      *residual = height;
      farthest = face;
    }
    count = left;
    if (!(*residual > nearest) || hull->corner_count == MOST_CORNERS) break;
    add_corner(hull, choose_farthest(outside, count, farthest, *residual));
  }
  release(outside);
  return true;
}

/* True if the corner is within the tolerance of the hull of the others, as rounded points of faces are. */
static bool is_redundant(const struct Hull *hull, size_t corner) {
  struct Site others[MOST_CORNERS];
  size_t count = 0;
  for (size_t i = 0; i < hull->corner_count; i++)
    if (i != corner) others[count++] = *hull->corners[i];
  struct Hull rest;
  double residual;
  const struct Face *face;
  return grow_hull(&rest, others, count, 0.0, &residual) && beyond(&rest, hull->corners[corner], &face) <= tolerance;
}

static int compare_sites(const void *first, const void *second) {
  const struct Site *a = first, *b = second;
  for (int i = 0; i < 3; i++)
    if (a->at[i] != b->at[i]) return a->at[i] < b->at[i] ? -1 : 1;
  return compare_sizes(&a->point, &b->point);
}

/* Rounds the points to the grid and removes duplicates. Returns the number of sites and sets the grid's step in m. */
static size_t find_sites(const struct Mesh *mesh, struct Site *sites, double *step) {
  double least[3], size = mesh_size(mesh, least);
  *step = size > 0.0 ? size / STEPS : 1.0;
  for (size_t i = 0; i < mesh->point_count; i++) {
    sites[i].point = i;
    for (int axis = 0; axis < 3; axis++) sites[i].at[axis] = llround((mesh->points[i][axis] - least[axis]) / *step);
  }
  qsort(sites, mesh->point_count, sizeof *sites, compare_sites);
  size_t count = 0;
  for (size_t i = 0; i < mesh->point_count; i++) {
    bool is_another = count == 0;
    for (int axis = 0; axis < 3 && !is_another; axis++) is_another = sites[i].at[axis] != sites[count - 1].at[axis];
    if (is_another) sites[count++] = sites[i];
  }
  return count;
}

/* Removes the corners that are not needed from the hull and marks their sites. Returns their number. */
static size_t drop_redundant(struct Hull *hull, struct Site *sites) {
  size_t dropped = 0, i = 0;
  while (i < hull->corner_count) {
    if (is_redundant(hull, i)) {
      sites[hull->corners[i] - sites].is_redundant = true;
      hull->corner_count--;
      for (size_t k = i; k < hull->corner_count; k++) hull->corners[k] = hull->corners[k + 1];
      dropped++;
    } else i++;
  }
  return dropped;
}

/* Removes marked sites; returns the number left. */
static size_t drop_marked(struct Site *sites, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (!sites[i].is_redundant) sites[kept++] = sites[i];
  return kept;
}

bool mesh_find_corners(struct Mesh *mesh) {
  if (mesh->corner_count > 0) return true;
  struct Site *sites = allocate(mesh->point_count, sizeof *sites);
  double step, residual = 0.0;
  size_t count = find_sites(mesh, sites, &step), dropped = 0;
  struct Hull hull = {.corner_count = 0};
  bool is_full = false;
  do { /* if needless corners filled the hull, repeat without them */
    count = drop_marked(sites, count);
    if (!grow_hull(&hull, sites, count, tolerance, &residual)) hull.corner_count = 0;
    is_full = hull.corner_count == MOST_CORNERS;
    dropped = drop_redundant(&hull, sites);
  } while (is_full && dropped > 0);
  mesh->corner_count = hull.corner_count;
  mesh->residual = residual * step;
  for (size_t i = 0; i < mesh->corner_count; i++) mesh->corners[i] = hull.corners[i]->point;
  sort_sizes(mesh->corners, mesh->corner_count);
  release(sites);
  return mesh->corner_count > 0;
}
