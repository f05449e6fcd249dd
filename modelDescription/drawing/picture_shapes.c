#include "picture_shapes.h"

#include <math.h>

#include "base/memory.h"

const struct LookStyle looks[LOOK_COUNT] = {
    [GROUND] = {1.0, 0.12, {120, 120, 110}},  [SOLID] = {0.8, 0.35, {26, 95, 180}},
    [LINK] = {1.8, 0.0, {104, 112, 133}},     [PARTICLE] = {9.0, 0.0, {26, 95, 180}},
    [JOINT] = {4.2, 0.0, {29, 36, 51}},       [SIGNAL] = {2.0, 0.0, {29, 36, 51}},
    [BAR] = {4.5, 0.0, {26, 95, 180}},        [RIM] = {149.0, 0.0, {29, 36, 51}},
    [FLANGE] = {145.0, 0.0, {174, 199, 229}},
};

void append_shape(struct Drawing *drawing, enum Look look, bool is_filled, const struct PicturePoint *points,
                  size_t count) {
  struct PictureShape shape = {look, is_filled, allocate(count, sizeof *points), count};
  for (size_t i = 0; i < count; i++) shape.points[i] = points[i];
  APPEND(drawing->shapes, drawing->count, shape);
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
  double pixels = (PICTURE_SIZE - 2.0 * margin) / size;
  for (size_t i = 0; i < drawing->count; i++)
    for (size_t j = 0; j < drawing->shapes[i].count; j++) fit_point(&drawing->shapes[i].points[j], &all, pixels);
  return isnormal(size) && isnormal(pixels);
}

/* Takes the outermost point in each of many directions. */
void append_hull(struct Drawing *drawing, enum Look look, bool is_filled, const struct PicturePoint *points,
                 size_t count) {
  enum { WAYS = 72 };
  struct PicturePoint hull[WAYS + 1];
  size_t size = 0, last = count;
  for (int i = 0; i < WAYS; i++) {
    double right = cos(2.0 * acos(-1.0) * i / WAYS), up = sin(2.0 * acos(-1.0) * i / WAYS);
    size_t most = 0;
    for (size_t k = 1; k < count; k++)
      if (right * (points[k].right - points[most].right) + up * (points[k].up - points[most].up) > 0.0) most = k;
    if (most != last) hull[size++] = points[most];
    last = most;
  }
  hull[size] = hull[0];
  if (is_filled) append_shape(drawing, look, true, hull, size);
  append_shape(drawing, look, false, hull, size + 1);
}
