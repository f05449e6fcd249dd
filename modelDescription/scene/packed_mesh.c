/*
 * Vertex clustering: all points in a cell of a cubic grid become the first of them, and triangles with fewer than three
 * distinct corners vanish. The grid starts at 16-bit resolution. Each coarser one has 0.7 times as many cells a side, until at most MOST_DRAWN
 * triangles are left; it ends, since a single cell leaves none. A pass costs O(n log n) for n points. J. Rossignac, P.
 * Borrel: Multi-resolution 3D approximations for rendering complex scenes, 1993.
 */
#include "scene/packed_mesh.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/sorting.h"

/* Largest 16-bit coordinate; cells on a side of the first coarser grid. */
enum { STEPS = 65535, COARSE = 512 };

/* A point and its cell in the grid. */
struct Cell {
  uint64_t key;
  size_t point;
};

static int compare_cells(const void *first, const void *second) {
  const struct Cell *a = first, *b = second;
  if (a->key != b->key) return a->key < b->key ? -1 : 1;
  return compare_sizes(&a->point, &b->point);
}

static uint64_t number_of(const struct PackedMesh *packed, const struct Mesh *mesh, size_t point, int axis) {
  return (uint64_t)llround((mesh->points[point][axis] - packed->least[axis]) / packed->step);
}

/*
 * Merges points that share a cell of a grid with `cells` cells along each axis. sorted[] lists the points that are
 * left, before and after. Returns their number.
 */
static size_t merge_points(const struct PackedMesh *packed, const struct Mesh *mesh, uint64_t cells,
                           struct Cell *sorted, size_t count, size_t *merged) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) {
    sorted[i].key = 0;
    for (int axis = 0; axis < 3; axis++)
      sorted[i].key = sorted[i].key << 16 | number_of(packed, mesh, sorted[i].point, axis) * cells / STEPS;
  }
  qsort(sorted, count, sizeof *sorted, compare_cells);
  for (size_t i = 0; i < count; i++) {
    if (kept == 0 || sorted[i].key != sorted[kept - 1].key) sorted[kept++] = sorted[i];
    merged[sorted[i].point] = sorted[kept - 1].point;
  }
  return kept;
}

/* Returns the point that this one was merged into, with path compression. */
static size_t merged_into(size_t *merged, size_t point) {
  while (merged[point] != point) point = merged[point] = merged[merged[point]];
  return point;
}

/* True if the triangle still has three distinct corners. */
static bool has_three_corners(const struct Mesh *mesh, size_t triangle, size_t *merged, size_t corners[3]) {
  for (int k = 0; k < 3; k++) corners[k] = merged_into(merged, mesh->triangles[triangle][k]);
  return corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
}

static size_t count_triangles(const struct Mesh *mesh, size_t *merged) {
  size_t count = 0, corners[3];
  for (size_t i = 0; i < mesh->triangle_count; i++) count += has_three_corners(mesh, i, merged, corners);
  return count;
}

/* A list of 16-bit numbers. */
struct NumberList {
  unsigned char *bytes;
  size_t length;
};

static void append_number(struct NumberList *numbers, uint64_t number) {
  for (int shift = 0; shift < 16; shift += 8) {
    APPEND(numbers->bytes, numbers->length, (unsigned char)(number >> shift & 0xff));
  }
}

/* Encodes in base64; there is no padding, as the numbers come in groups of 6 bytes. */
static char *text_of_numbers(const struct NumberList *numbers) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char *text = allocate(numbers->length / 3 * 4 + 1, 1), *next = text;
  for (size_t i = 0; i < numbers->length; i += 3) {
    unsigned three = (unsigned)numbers->bytes[i] << 16 | (unsigned)numbers->bytes[i + 1] << 8 | numbers->bytes[i + 2];
    for (int shift = 18; shift >= 0; shift -= 6) *next++ = digits[three >> shift & 63];
  }
  return text;
}

/* Encodes the mesh; points are numbered in the order of their first use. */
static void write_numbers(struct PackedMesh *packed, const struct Mesh *mesh, size_t *merged) {
  struct NumberList points = {NULL, 0}, triangles = {NULL, 0};
  size_t *numbers = allocate(mesh->point_count, sizeof *numbers), count = 0, corners[3];
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    if (!has_three_corners(mesh, i, merged, corners)) continue;
    for (int k = 0; k < 3; k++) {
      if (numbers[corners[k]] == 0) {
        numbers[corners[k]] = ++count;
        for (int axis = 0; axis < 3; axis++) append_number(&points, number_of(packed, mesh, corners[k], axis));
      }
      append_number(&triangles, numbers[corners[k]] - 1);
    }
  }
  packed->points = text_of_numbers(&points);
  packed->triangles = text_of_numbers(&triangles);
  release(numbers);
}

struct PackedMesh pack_mesh(const struct Mesh *mesh) {
  struct PackedMesh packed = {.points = NULL};
  packed.step = mesh_size(mesh, packed.least) / STEPS;
  if (!(packed.step > 0.0)) packed.step = 1.0;
  size_t *merged = allocate(mesh->point_count, sizeof *merged);
  struct Cell *sorted = allocate(mesh->point_count, sizeof *sorted);
  for (size_t i = 0; i < mesh->point_count; i++) sorted[i].point = merged[i] = i;
  uint64_t cells = STEPS;
  size_t count = merge_points(&packed, mesh, cells, sorted, mesh->point_count, merged);
  while (count_triangles(mesh, merged) > MOST_DRAWN) {
    cells = cells > COARSE ? COARSE : cells * 7 / 10;
    count = merge_points(&packed, mesh, cells, sorted, count, merged);
  }
  write_numbers(&packed, mesh, merged);
  release(sorted);
  release(merged);
  return packed;
}
