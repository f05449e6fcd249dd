#include "surfaces.h"

#include <math.h>

#include "base/memory.h"
#include "configurations.h"
#include "least_squares.h"

static double norm(const double vector[3]) {
  return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

static void append(struct Surfaces *surfaces, struct SceneSurface surface) {
  APPEND(surfaces->items, surfaces->count, surface);
}

/* True if gap = normal . position + offset for all samples; sets the plane. */
static bool is_plane(const struct SampledPositions *samples, Node gap, struct SceneSurface *surface) {
  struct LeastSquares system = least_squares_create(samples->count, 4);
  double solution[4];
  for (size_t k = 0; k < samples->count; k++) {
    double *row = least_squares_row(&system, k);
    for (int axis = 0; axis < 3; axis++)
      row[1 + axis] = samples->values[k][samples->objects[surface->object].position[axis]];
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

/* A gap that is linear in one coordinate: slope * (coordinate - limit). */
struct Limit {
  size_t coordinate;
  double slope;
};

static bool is_of_coordinate(const struct SampledPositions *samples, Node gap, struct Limit *limit) {
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
    *limit = (struct Limit){i, solution[1]};
    return true;
  }
  return false;
}

/*
 * Moves the coordinate until the gap has this width, by fixed-point iteration with the constraints. Returns the values
 * of the nodes; NULL if it fails.
 */
static double *values_where(const struct Configurations *configurations, Node gap, const struct Limit *limit,
                            double width) {
  double *offsets = allocate(configurations->model->coordinates.count, sizeof *offsets), *values = NULL;
  for (int i = 0; i < 20; i++) {
    values = values_at(configurations, offsets);
    if (values == NULL || fabs(values[gap] - width) < 1e-9) break;
    offsets[limit->coordinate] -= (values[gap] - width) / limit->slope;
    release(values);
    values = NULL;
  }
  release(offsets);
  return values;
}

/* Sets the surface at the end of a path, with the normal from at to beside. False if the object does not move. */
static bool is_end(const struct SceneObject *object, const double *at, const double *beside,
                   struct SceneSurface *surface) {
  for (int axis = 0; axis < 3; axis++) {
    surface->point[axis] = at[object->position[axis]];
    surface->normal[axis] = beside[object->position[axis]] - at[object->position[axis]];
  }
  double length = norm(surface->normal);
  if (!(length > 1e-12)) return false;
  for (int axis = 0; axis < 3; axis++) surface->normal[axis] /= length;
  return true;
}

/* Adds the stop of a coordinate, at the first object that the coordinate moves. */
static void add_stop(struct Surfaces *surfaces, const struct SampledPositions *samples,
                     const struct Configurations *configurations, Node gap) {
  const double little = 1e-4;
  struct Limit limit;
  if (!is_of_coordinate(samples, gap, &limit)) return;
  double *at = values_where(configurations, gap, &limit, 0.0),
         *beside = at == NULL ? NULL : values_where(configurations, gap, &limit, fabs(limit.slope) * little);
  bool is_found = false;
  for (size_t object = 1; object < samples->object_count && beside != NULL && !is_found; object++) {
    struct SceneSurface surface = {.object = object, .is_stop = true};
    is_found = is_end(&samples->objects[object], at, beside, &surface);
    if (is_found) append(surfaces, surface);
  }
  if (at != NULL) release(at);
  if (beside != NULL) release(beside);
}

/* Prepares the evaluation of positions and gaps only, since each stop needs several evaluations. */
static struct Configurations configurations_with_stops(const struct SampledPositions *samples) {
  const struct Switches *switches = &samples->model->switches;
  struct NodeList wanted = {.count = 0};
  for (size_t i = 0; i < switches->contact_count; i++) append_node(&wanted, switches->contacts[i].gap);
  for (size_t object = 0; object < samples->object_count; object++)
    append_nodes(&wanted, samples->objects[object].position, 3);
  return configurations_of(samples->model, &wanted);
}

/* True if moving shapes are visible. Stops are not drawn then, as their place on the shapes is unknown. */
static bool draws_shapes(const struct Mechanism *mechanism) {
  bool draws = false;
  for (size_t i = 0; i < mechanism->shape_count; i++) {
    const struct ContactShape *shape = &mechanism->shapes[i];
    draws |= !shape->is_hidden && (shape->frame != BASE_FRAME || shape->particle != NO_PARTICLE);
  }
  return draws;
}

struct Surfaces find_surfaces(const struct SampledPositions *samples) {
  struct Surfaces surfaces = {.count = 0};
  const struct Switches *switches = &samples->model->switches;
  if (switches->contact_count == 0) return surfaces;
  bool has_stops = !draws_shapes(&samples->model->mechanism);
  struct Configurations configurations = {0};
  if (has_stops) configurations = configurations_with_stops(samples);
  for (size_t i = 0; i < switches->contact_count; i++) {
    size_t before = surfaces.count;
    for (size_t object = 1; object < samples->object_count && surfaces.count == before; object++) {
      struct SceneSurface surface = {.object = object};
      if (is_plane(samples, switches->contacts[i].gap, &surface)) append(&surfaces, surface);
    }
    if (surfaces.count == before && has_stops) add_stop(&surfaces, samples, &configurations, switches->contacts[i].gap);
  }
  return surfaces;
}
