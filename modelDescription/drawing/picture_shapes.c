#include "picture_shapes.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

const struct LookStyle looks[LOOK_COUNT] = {
    [GROUND] = {"ground", 1.0, 0.12, {120, 120, 110}}, [AXIS] = {"axis", 0.8, 0.0, {190, 196, 208}},
    [SOLID] = {"solid", 0.0, 0.35, {26, 95, 180}},     [EDGE] = {"solid", 0.8, 0.0, {26, 95, 180}},
    [LINK] = {"link", 1.8, 0.0, {104, 112, 133}},      [ROPE] = {"link", 1.0, 0.0, {104, 112, 133}},
    [BAR] = {"body", 4.5, 0.0, {26, 95, 180}},         [BASE] = {"base", 5.0, 0.0, {29, 36, 51}},
    [HOLE] = {"hole", 2.8, 0.0, {255, 255, 255}},      [PARTICLE] = {"particle", 9.0, 0.0, {26, 95, 180}},
    [JOINT] = {"base", 3.4, 0.0, {29, 36, 51}},        [BOX] = {"body", 2.0, 0.15, {26, 95, 180}},
    [SIGNAL] = {"base", 2.0, 0.0, {29, 36, 51}},
};

void append_shape(struct Drawing *drawing, enum Look look, bool is_filled, const struct PicturePoint *points,
                  size_t count) {
  struct PictureShape shape = {look, is_filled, allocate(count, sizeof *points), count};
  for (size_t i = 0; i < count; i++) shape.points[i] = points[i];
  APPEND(drawing->shapes, drawing->count, shape);
}

void append_line(struct Drawing *drawing, enum Look look, struct PicturePoint from, struct PicturePoint to) {
  append_shape(drawing, look, false, (struct PicturePoint[]){from, to}, 2);
}

void append_label(struct Drawing *drawing, const char *text, struct PicturePoint point) {
  APPEND(drawing->labels, drawing->label_count, (struct PictureLabel){text, point});
}

struct Rectangle rectangle_of(const struct Drawing *drawing) {
  struct Rectangle all = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  for (size_t i = 0; i < drawing->count; i++)
    for (size_t j = 0; j < drawing->shapes[i].count; j++) {
      struct PicturePoint point = drawing->shapes[i].points[j];
      all.least = (struct PicturePoint){fmin(all.least.right, point.right), fmin(all.least.up, point.up)};
      all.most = (struct PicturePoint){fmax(all.most.right, point.right), fmax(all.most.up, point.up)};
    }
  return all;
}

static void fit_point(struct PicturePoint *point, const struct Rectangle *all, double pixels) {
  point->right = PICTURE_SIZE / 2.0 + pixels * (point->right - (all->least.right + all->most.right) / 2.0);
  point->up = PICTURE_SIZE / 2.0 - pixels * (point->up - (all->least.up + all->most.up) / 2.0);
}

bool fit_drawing(struct Drawing *drawing) {
  const double margin = 14.0;
  struct Rectangle all = rectangle_of(drawing);
  double size = fmax(all.most.right - all.least.right, all.most.up - all.least.up);
  drawing->pixels = (PICTURE_SIZE - 2.0 * margin) / size;
  for (size_t i = 0; i < drawing->count; i++)
    for (size_t j = 0; j < drawing->shapes[i].count; j++)
      fit_point(&drawing->shapes[i].points[j], &all, drawing->pixels);
  for (size_t i = 0; i < drawing->label_count; i++) fit_point(&drawing->labels[i].point, &all, drawing->pixels);
  return isnormal(size) && isnormal(drawing->pixels);
}

static int compare_points(const void *first, const void *second) {
  const struct PicturePoint *a = first, *b = second;
  if (a->right != b->right) return a->right < b->right ? -1 : 1;
  return (a->up > b->up) - (a->up < b->up);
}

static double orientation(struct PicturePoint a, struct PicturePoint b, struct PicturePoint c) {
  return (b.right - a.right) * (c.up - a.up) - (b.up - a.up) * (c.right - a.right);
}

/*
 * Appends one chain of the hull, forwards or backwards, by Andrew's monotone chain algorithm: points that do not turn
 * left are removed. O(n log n) with the sort. A. M. Andrew: Another efficient algorithm for convex hulls in two
 * dimensions, 1979.
 */
static size_t append_half_hull(const struct PicturePoint *points, size_t count, bool backwards,
                               struct PicturePoint *hull, size_t length) {
  size_t first = length;
  for (size_t i = 0; i < count; i++) {
    struct PicturePoint point = points[backwards ? count - 1 - i : i];
    while (length >= first + 2 && !(orientation(hull[length - 2], hull[length - 1], point) > 0.0)) length--;
    hull[length++] = point;
  }
  return length - 1; /* its last point begins the other chain */
}

size_t convex_hull(struct PicturePoint *points, size_t count, struct PicturePoint *hull) {
  qsort(points, count, sizeof *points, compare_points);
  return append_half_hull(points, count, true, hull, append_half_hull(points, count, false, hull, 0));
}
