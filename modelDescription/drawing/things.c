#include "things.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { BASE_FRAME = 0, TRIALS = 3, MOST_POINTS = 60 };

/* The node of NAME.x, NAME.y or NAME.z; ZERO where there is none. */
static Node component(const struct Model *model, const char *name, const char *axis) {
  Node node = ZERO;
  char *full = format_text("%s.%s", name, axis);
  for (size_t i = 0; i < model->mechanism.places.count && node == ZERO; i++)
    if (strcmp(model->mechanism.places.items[i].name, full) == 0) node = model->mechanism.places.items[i].node;
  return node;
}

static void append_thing(struct Things *things, const struct Model *model, struct Thing thing) {
  for (int axis = 0; axis < 3 && thing.name != NULL; axis++)
    thing.position[axis] = component(model, thing.name, axes[axis]);
  things->are_in_space |= thing.position[2] != ZERO;
  things->items = make_room(things->items, things->count, sizeof *things->items);
  things->items[things->count++] = thing;
}

/* Also of a body in the plane whose tensor turns about the third axis alone. */
static enum ThingKind kind_of(const struct Body *body) {
  if (body->has_angle) return BODY_POINT;
  if (body->tensor.row[0].along[0] != ZERO || body->tensor.row[2].along[2] != ZERO) return SOLID_POINT;
  return body->mass.node == ZERO ? MERE_POINT : PARTICLE_POINT;
}

struct Things things_of(const struct Model *model) {
  const struct Mechanism *mechanism = &model->mechanism;
  struct Things things = {.count = 0};
  append_thing(&things, model, (struct Thing){.kind = ORIGIN, .is_framed = true});
  for (size_t i = BASE_FRAME + 1; i < mechanism->frame_count; i++)
    if (!mechanism->frames[i].is_of_body)
      append_thing(
          &things, model,
          (struct Thing){.kind = FRAME_POINT, .name = mechanism->frames[i].name, .is_framed = true, .frame = i});
  for (size_t i = 0; i < mechanism->body_count; i++) {
    const struct Body *body = &mechanism->bodies[i];
    append_thing(&things, model,
                 (struct Thing){.kind = kind_of(body),
                                .name = body->name,
                                .body = body,
                                .is_framed = body->is_in_frame,
                                .frame = body->frame});
  }
  return things;
}

/* Squared. */
static double distance(const struct Thing *first, const struct Thing *second, const double *values) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double way = values[first->position[axis]] - values[second->position[axis]];
    sum += way * way;
  }
  return sum;
}

/* The values of all nodes where the coordinates are moved from their start, each trial otherwise. */
static double *moved_values(const struct Model *model, const struct Equations *equations, int trial) {
  double *offsets = allocate(model->coordinates.count + 1, sizeof *offsets);
  for (size_t i = 0; i < model->coordinates.count; i++) offsets[i] = 0.2 * sin(1.0 + 2.7 * trial * (double)(i + 1));
  return values_at(model, equations, offsets);
}

static bool are_linked(const struct Thing *first, const struct Thing *second, const double *start,
                       double *const values[TRIALS]) {
  double length = distance(first, second, start);
  bool is_same = length > 0.0, moves = false;
  for (int trial = 0; trial < TRIALS; trial++) {
    if (values[trial] == NULL) continue;
    is_same &= fabs(distance(first, second, values[trial]) - length) < 1e-9 * length;
    for (int axis = 0; axis < 3; axis++)
      moves |= values[trial][second->position[axis]] != start[second->position[axis]];
  }
  return is_same && moves;
}

/* Whether the second is in the frame that the first one is. */
static bool holds(const struct Model *model, const struct Thing *first, const struct Thing *second) {
  size_t outer = second->kind == FRAME_POINT ? model->mechanism.frames[second->frame].parent : second->frame;
  return (first->kind == ORIGIN || first->kind == FRAME_POINT) && first->frame == outer;
}

/* What frames alone hold is linked to these. */
static bool may_be_linked(const struct Model *model, const struct Thing *first, const struct Thing *second) {
  bool is_tree = model->constraints.count == 0 && first->is_framed && second->is_framed;
  return !is_tree || holds(model, first, second) || holds(model, second, first);
}

struct Links links_of(const struct Model *model, const struct Equations *equations, const struct Things *things,
                      const double *values) {
  struct Links links = {.count = 0};
  double *moved[TRIALS];
  for (int trial = 0; trial < TRIALS; trial++) moved[trial] = moved_values(model, equations, trial + 1);
  for (size_t i = 0; i < things->count; i++)
    for (size_t j = i + 1; j < things->count && (things->count <= MOST_POINTS || j == i + 1); j++) {
      if (!may_be_linked(model, &things->items[i], &things->items[j])) continue;
      if (!are_linked(&things->items[i], &things->items[j], values, moved)) continue;
      links.items = make_room(links.items, links.count, sizeof *links.items);
      links.items[links.count++] = (struct Link){i, j};
    }
  for (int trial = 0; trial < TRIALS; trial++) release(moved[trial]);
  return links;
}
