#include "surfaces.h"

#include <math.h>

#include "base/memory.h"
#include "least_squares.h"

static double norm(const double vector[3]) {
  return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

static void append(struct Surfaces *surfaces, struct Surface surface) {
  surfaces->items = make_room(surfaces->items, surfaces->count, sizeof *surfaces->items);
  surfaces->items[surfaces->count++] = surface;
}

/* Whether gap = normal . position + offset. */
static bool is_plane(const struct Samples *samples, Node gap, struct Surface *surface) {
  struct LeastSquares system = least_squares_create(samples->count, 4);
  double solution[4];
  for (size_t k = 0; k < samples->count; k++) {
    double *row = least_squares_row(&system, k);
    for (int axis = 0; axis < 3; axis++)
      row[1 + axis] = samples->values[k][samples->things[surface->thing].position[axis]];
    row[0] = 1.0;
    row[4] = samples->values[k][gap];
  }
  if (!least_squares_solve(&system, 1, solution)) return false;
  double length = norm(solution + 1);
  if (!(length > 0.0)) return false;
  for (int axis = 0; axis < 3; axis++) {
    surface->normal[axis] = solution[1 + axis] / length;
    surface->point[axis] = -solution[0] / length * surface->normal[axis];
  }
  return true;
}

/* The one coordinate that the gap is, but for a number: gap = sign*(coordinate - limit). */
static bool is_of_coordinate(const struct Samples *samples, Node gap, Node *coordinate, double *limit, double *sign) {
  const struct VariableList *coordinates = &samples->model->coordinates;
  for (size_t i = 0; i < coordinates->count; i++) {
    struct LeastSquares system = least_squares_create(samples->count, 2);
    double solution[2];
    for (size_t k = 0; k < samples->count; k++) {
      double *row = least_squares_row(&system, k);
      row[0] = 1.0;
      row[1] = samples->values[k][coordinates->items[i].node];
      row[2] = samples->values[k][gap];
    }
    if (!least_squares_solve(&system, 2, solution) || fabs(solution[1]) < 1e-9) continue;
    *coordinate = coordinates->items[i].node;
    *limit = -solution[0] / solution[1];
    *sign = solution[1] > 0.0 ? 1.0 : -1.0;
    return true;
  }
  return false;
}

/* The first thing that the coordinate moves, where it is at its limit. */
static void add_stop(struct Surfaces *surfaces, const struct Samples *samples, Node gap) {
  const double little = 1e-4;
  Node coordinate = ZERO;
  double limit = 0.0, sign = 0.0;
  if (!is_of_coordinate(samples, gap, &coordinate, &limit, &sign)) return;
  double *at = sample_with(samples, coordinate, limit),
         *beside = sample_with(samples, coordinate, limit + sign * little);
  for (size_t thing = 1; thing < samples->thing_count; thing++) {
    struct Surface surface = {.thing = thing, .is_stop = true};
    for (int axis = 0; axis < 3; axis++) {
      Node position = samples->things[thing].position[axis];
      surface.point[axis] = at[position];
      surface.normal[axis] = beside[position] - at[position];
    }
    double length = norm(surface.normal);
    if (!(length > 1e-9 * little)) continue;
    for (int axis = 0; axis < 3; axis++) surface.normal[axis] /= length;
    append(surfaces, surface);
    break;
  }
  release(at);
  release(beside);
}

struct Surfaces find_surfaces(const struct Samples *samples) {
  struct Surfaces surfaces = {.count = 0};
  const struct Switches *switches = &samples->model->switches;
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t before = surfaces.count;
    for (size_t thing = 1; thing < samples->thing_count && surfaces.count == before; thing++) {
      struct Surface surface = {.thing = thing};
      if (is_plane(samples, switches->contacts[i].gap, &surface)) append(&surfaces, surface);
    }
    if (surfaces.count == before) add_stop(&surfaces, samples, switches->contacts[i].gap);
  }
  return surfaces;
}
