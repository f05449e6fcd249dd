#include "solids.h"

#include <math.h>

enum { ROUND = 24, RINGS = 2 * ROUND }; /* points of a circle, and of both end circles of a cylinder */

struct PicturePoint projected(const struct View *view, const double position[3]) {
  struct PicturePoint point = {0.0, 0.0};
  for (int i = 0; i < 3; i++) {
    point.right += view->right[i] * position[i];
    point.up += view->up[i] * position[i];
  }
  return point;
}

static struct PicturePoint corner(const struct View *view, const struct Solid *solid, const double along[3]) {
  double position[3];
  for (int i = 0; i < 3; i++) {
    position[i] = solid->middle[i];
    for (int axis = 0; axis < 3; axis++) position[i] += along[axis] * solid->half[axis] * solid->axis[axis][i];
  }
  return projected(view, position);
}

/* Returns the axis of symmetry, whose two other moments of inertia agree to 0.1 %; -1 for none. */
static int axis_of_revolution(const double moment[3]) {
  for (int axis = 0; axis < 3; axis++) {
    double first = moment[(axis + 1) % 3], second = moment[(axis + 2) % 3];
    if (fabs(first - second) <= 1e-3 * fmax(first, second)) return axis;
  }
  return -1;
}

/*
 * Finds the size from the moments of inertia: m r^2/2 and m (3 r^2 + h^2)/12 of a cylinder of radius r and length h
 * about its axis and across, m (b^2 + c^2)/12 of a box.
 */
static void set_edges(struct Solid *solid, const double moment[3], double mass, int axis) {
  for (int i = 0; i < 3; i++) {
    double across = moment[(i + 1) % 3] + moment[(i + 2) % 3] - moment[i];
    solid->half[i] = sqrt(fmax(1.5 * across / mass, 0.0));
  }
  if (axis < 0) return;
  double radius = sqrt(fmax(2.0 * moment[axis] / mass, 0.0));
  solid->half[(axis + 1) % 3] = solid->half[(axis + 2) % 3] = radius;
  solid->half[axis] = sqrt(fmax(3.0 * moment[(axis + 1) % 3] / mass - 0.75 * radius * radius, 0.0));
}

static void append_filled(struct Drawing *drawing, struct PicturePoint *points, size_t count) {
  struct PicturePoint hull[2 * RINGS + 1];
  size_t size = convex_hull(points, count, hull);
  append_shape(drawing, SOLID, true, hull, size);
  hull[size] = hull[0];
  append_shape(drawing, EDGE, false, hull, size + 1);
}

void append_cylinder(struct Drawing *drawing, const struct View *view, const struct Solid *solid, int axis) {
  struct PicturePoint rings[RINGS];
  for (int i = 0; i < RINGS; i++) {
    double angle = 2.0 * acos(-1.0) * (i % ROUND) / (ROUND - 1), along[3];
    along[axis] = i < ROUND ? -1.0 : 1.0;
    along[(axis + 1) % 3] = cos(angle);
    along[(axis + 2) % 3] = sin(angle);
    rings[i] = corner(view, solid, along);
  }
  for (int end = 0; end < 2; end++) append_shape(drawing, EDGE, false, rings + (size_t)end * ROUND, ROUND);
  append_filled(drawing, rings, RINGS);
}

void append_box(struct Drawing *drawing, const struct View *view, const struct Solid *solid) {
  struct PicturePoint corners[8];
  for (int i = 0; i < 8; i++)
    corners[i] = corner(view, solid, (double[]){i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  for (int i = 0; i < 8; i++)
    for (int bit = 1; bit < 8; bit *= 2)
      if (!(i & bit)) append_line(drawing, EDGE, corners[i], corners[i | bit]);
  append_filled(drawing, corners, 8);
}

/* The outline consists of the points whose tangent planes contain the direction of view. */
void append_ellipsoid(struct Drawing *drawing, const struct View *view, const struct Solid *solid) {
  struct PicturePoint points[ROUND], middle = projected(view, solid->middle);
  for (int i = 0; i < ROUND; i++) {
    double angle = 2.0 * acos(-1.0) * i / ROUND, support = 0.0;
    points[i] = (struct PicturePoint){0.0, 0.0};
    for (int axis = 0; axis < 3; axis++) {
      struct PicturePoint direction = projected(view, solid->axis[axis]);
      double along = solid->half[axis] * (direction.right * cos(angle) + direction.up * sin(angle));
      support += along * along;
      points[i].right += along * solid->half[axis] * direction.right;
      points[i].up += along * solid->half[axis] * direction.up;
    }
    points[i] =
        (struct PicturePoint){middle.right + points[i].right / sqrt(support), middle.up + points[i].up / sqrt(support)};
  }
  append_filled(drawing, points, ROUND);
}

bool is_solid(const struct Body *body) {
  return !body->has_angle && (body->tensor.row[0].along[0] != ZERO || body->tensor.row[2].along[2] != ZERO);
}

void append_solid(struct Drawing *drawing, const struct View *view, const struct Model *model, const struct Body *body,
                  const double *values) {
  const struct Matrix *orientation = &model->mechanism.frames[body->frame].pose.rotation;
  struct Solid solid;
  double moment[3], mass = values[body->mass.node], sum = 0.0;
  for (int i = 0; i < 3; i++) {
    moment[i] = values[body->tensor.row[i].along[i]];
    solid.middle[i] = values[body->position[i].node];
    sum += moment[i] + fabs(solid.middle[i]);
    for (int axis = 0; axis < 3; axis++) {
      solid.axis[axis][i] = values[orientation->row[i].along[axis]];
      sum += fabs(solid.axis[axis][i]);
    }
  }
  if (!(mass > 0.0) || !isfinite(sum) || !(moment[0] + moment[1] + moment[2] > 0.0)) return;
  if (moment[0] == 0.0 && moment[1] == 0.0) { /* planar: drawn as a bar */
    solid.half[0] = sqrt(3.0 * moment[2] / mass);
    append_line(drawing, BAR, corner(view, &solid, (double[]){-1, 0, 0}), corner(view, &solid, (double[]){1, 0, 0}));
    return;
  }
  if (fmax(fabs(moment[1] - moment[0]), fabs(moment[2] - moment[0])) <= 1e-3 * moment[0]) { /* 2/5 m r^2 of a ball */
    for (int i = 0; i < 3; i++) solid.half[i] = sqrt(2.5 * moment[0] / mass);
    append_ellipsoid(drawing, view, &solid);
    return;
  }
  int axis = axis_of_revolution(moment);
  set_edges(&solid, moment, mass, axis);
  if (axis >= 0) append_cylinder(drawing, view, &solid, axis);
  else append_box(drawing, view, &solid);
}
