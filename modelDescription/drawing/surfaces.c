#include "surfaces.h"

#include <math.h>

#include "base/memory.h"

enum { MOST_CONTACTS = 40, MOST_SLOPES = 24 }; /* of systems with more contacts or coordinates nothing is found */

/* The derivatives of a gap, and of a position along each axis, by the coordinates. */
struct Slopes {
  Node *gap, *position[3];
};

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The shortest n with which the gap grows by n.dr as the thing is moved by dr; false where other things move the gap too. */
static bool find_normal(const struct Slopes *slopes, size_t count, const double *values, double normal[3]) {
  double matrix[MOST_SLOPES * MOST_SLOPES], factor[MOST_SLOPES], wrong = 0.0;
  for (size_t k = 0; k < count; k++) {
    factor[k] = values[slopes->gap[k]];
    for (size_t l = 0; l < count; l++) {
      matrix[k * count + l] = 0.0;
      for (int i = 0; i < 3; i++)
        matrix[k * count + l] += values[slopes->position[i][k]] * values[slopes->position[i][l]];
    }
  }
  solve_small(count, matrix, factor);
  for (int i = 0; i < 3; i++) {
    normal[i] = 0.0;
    for (size_t k = 0; k < count; k++) normal[i] += values[slopes->position[i][k]] * factor[k];
  }
  for (size_t k = 0; k < count; k++) {
    double grown = 0.0;
    for (int i = 0; i < 3; i++) grown += normal[i] * values[slopes->position[i][k]];
    wrong = fmax(wrong, fabs(grown - values[slopes->gap[k]]));
  }
  return wrong < 1e-9 && fabs(dot(normal, normal) - 1.0) < 1e-9;
}

static void read_position(const struct Thing *thing, const double *values, double position[3]) {
  for (int i = 0; i < 3; i++) position[i] = values[thing->position[i]];
}

/* A plane whose distance from the thing is the gap: at the start, and at another place of the coordinates. */
static bool is_plane(const struct Thing *thing, Node gap, const struct Slopes *slopes, size_t count,
                     const double *const values[2], struct Surface *surface) {
  double normal[3], place[2][3];
  for (int i = 0; i < 2; i++) {
    if (!find_normal(slopes, count, values[i], normal)) return false;
    read_position(thing, values[i], place[i]);
    for (int axis = 0; axis < 3; axis++) place[i][axis] -= values[i][gap] * normal[axis];
    if (i == 0)
      *surface = (struct Surface){{place[0][0], place[0][1], place[0][2]}, {normal[0], normal[1], normal[2]}, false};
  }
  const double shift[3] = {place[1][0] - place[0][0], place[1][1] - place[0][1], place[1][2] - place[0][2]};
  return fabs(dot(normal, surface->normal) - 1.0) < 1e-9 && fabs(dot(shift, normal)) < 1e-9;
}

/* The one coordinate that moves the gap; the number of all for none, or for several. */
static size_t only_coordinate(const struct Slopes *slopes, size_t count) {
  size_t only = count, found = 0;
  for (size_t k = 0; k < count; k++)
    if (slopes->gap[k] != ZERO) {
      only = k;
      found++;
    }
  return found == 1 ? only : count;
}

/* Turns the one coordinate until the gap is closed. NULL where that is not found. */
static double *values_at_stop(const struct Model *model, const struct Equations *equations, Node gap,
                              const struct Slopes *slopes, size_t coordinate) {
  double *offsets = allocate(model->coordinates.count + 1, sizeof *offsets);
  for (int i = 0; i < 20; i++) {
    double *values = values_at(model, equations, offsets);
    if (values == NULL || fabs(values[gap]) < 1e-9) return values;
    offsets[coordinate] -= values[gap] / values[slopes->gap[coordinate]];
    release(values);
    if (!isfinite(offsets[coordinate])) break;
  }
  return NULL;
}

/* The end of the way of a thing that the coordinate moves. */
static bool is_stop(const struct Thing *thing, const struct Slopes *slopes, size_t coordinate, const double *values,
                    struct Surface *surface) {
  double length = 0.0, side = values[slopes->gap[coordinate]] < 0.0 ? -1.0 : 1.0;
  for (int i = 0; i < 3; i++) length = hypot(length, values[slopes->position[i][coordinate]]);
  if (!isnormal(length)) return false;
  read_position(thing, values, surface->place);
  for (int i = 0; i < 3; i++) surface->normal[i] = side * values[slopes->position[i][coordinate]] / length;
  surface->is_stop = true;
  return true;
}

static void append_surface(struct Surfaces *surfaces, const struct Surface *surface) {
  for (size_t i = 0; i < surfaces->count; i++) {
    const struct Surface *other = &surfaces->items[i];
    double shift[3];
    for (int axis = 0; axis < 3; axis++) shift[axis] = other->place[axis] - surface->place[axis];
    if (fabs(dot(surface->normal, other->normal) - 1.0) < 1e-9 && fabs(dot(shift, other->normal)) < 1e-9) return;
  }
  surfaces->items = make_room(surfaces->items, surfaces->count, sizeof *surfaces->items);
  surfaces->items[surfaces->count++] = *surface;
}

/* The derivatives of the positions of all things, and of a gap in each. */
static void set_slopes(const struct Model *model, const struct Things *things, Node gap, struct Slopes *slopes) {
  Node *of_gap = slopes_of(model, gap);
  for (size_t t = 0; t < things->count; t++) {
    slopes[t].gap = of_gap;
    for (int i = 0; i < 3; i++) slopes[t].position[i] = slopes_of(model, things->items[t].position[i]);
  }
}

/* False where nothing of the contact can be seen. values: at two places of the coordinates. */
static bool find_surface(const struct Model *model, const struct Equations *equations, const struct Things *things,
                         Node gap, const double *const values[2], const struct Slopes *slopes,
                         struct Surface *surface) {
  size_t n = model->coordinates.count, only = only_coordinate(slopes, n);
  for (size_t t = 1; t < things->count; t++)
    if (is_plane(&things->items[t], gap, &slopes[t], n, values, surface)) return true;
  const double *stopped = only < n ? values_at_stop(model, equations, gap, slopes, only) : NULL;
  for (size_t t = 1; t < things->count && stopped != NULL; t++)
    if (is_stop(&things->items[t], &slopes[t], only, stopped, surface)) return true;
  return false;
}

struct Surfaces surfaces_of(const struct Model *model, const struct Equations *equations, const struct Things *things) {
  struct Surfaces surfaces = {.count = 0};
  const struct Switches *switches = &model->switches;
  size_t n = model->coordinates.count;
  if (switches->contact_count == 0 || switches->contact_count > MOST_CONTACTS || n > MOST_SLOPES) return surfaces;
  struct Slopes *slopes = allocate(switches->contact_count * things->count, sizeof *slopes); /* by contacts */
  for (size_t c = 0; c < switches->contact_count; c++)
    set_slopes(model, things, switches->contacts[c].gap, slopes + c * things->count);
  double *offsets = allocate(n + 1, sizeof *offsets);
  for (size_t k = 0; k < n; k++) offsets[k] = 0.1 * cos(3.0 * (double)k);
  const double *const values[2] = {values_at(model, equations, NULL), values_at(model, equations, offsets)};
  for (size_t c = 0; c < switches->contact_count && values[0] != NULL && values[1] != NULL; c++) {
    struct Surface surface = {.is_stop = false};
    if (find_surface(model, equations, things, switches->contacts[c].gap, values, slopes + c * things->count, &surface))
      append_surface(&surfaces, &surface);
  }
  return surfaces;
}
