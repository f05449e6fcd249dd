#include "drawn_points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { BASE = 0, TRIALS = 3, MOST_POINTS = 60 };

/* What is drawn as a point: of a frame, or of a body; NULL for the origin. */
struct Thing {
  enum PointKind kind;
  const char *name;
  const struct Body *body;
  Node position[3];
};

struct Things {
  struct Thing *items;
  size_t count;
  bool are_in_space;
};

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

static enum PointKind kind_of(const struct Body *body) {
  if (body->has_angle) return BODY_POINT;
  return body->mass.node == ZERO ? MERE_POINT : PARTICLE_POINT;
}

static struct Things things_of(const struct Model *model) {
  struct Things things = {.count = 0};
  append_thing(&things, model, (struct Thing){.kind = ORIGIN});
  for (size_t i = BASE + 1; i < model->mechanism.frame_count; i++)
    if (!model->mechanism.frames[i].is_of_body)
      append_thing(&things, model, (struct Thing){.kind = FRAME_POINT, .name = model->mechanism.frames[i].name});
  for (size_t i = 0; i < model->mechanism.body_count; i++)
    append_thing(
        &things, model,
        (struct Thing){
            kind_of(&model->mechanism.bodies[i]), model->mechanism.bodies[i].name, &model->mechanism.bodies[i], {0}});
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
static double *moved_values(const struct Model *model, int trial) {
  double *symbols = start_values(model);
  for (size_t i = 0; i < model->coordinates.count && trial > 0; i++)
    symbols[model->graph->vertices[model->coordinates.items[i].node].left] +=
        0.3 * sin(1.0 + 2.7 * trial * (double)(i + 1));
  double *values = graph_evaluate(model->graph, symbols);
  return values;
}

/* Points whose distance is the same wherever the coordinates are, and of which one moves. */
static bool are_linked(const struct Thing *first, const struct Thing *second, double *const values[TRIALS]) {
  double length = distance(first, second, values[0]);
  bool is_same = length > 0.0, moves = false;
  for (int trial = 1; trial < TRIALS; trial++) {
    is_same &= fabs(distance(first, second, values[trial]) - length) < 1e-9 * length;
    for (int axis = 0; axis < 3; axis++)
      moves |= values[trial][second->position[axis]] != values[0][second->position[axis]];
  }
  return is_same && moves;
}

static void find_links(struct Drawing *drawing, const struct Things *things, double *const values[TRIALS]) {
  for (size_t i = 0; i < things->count; i++)
    for (size_t j = i + 1; j < things->count && things->count <= MOST_POINTS; j++) {
      if (!are_linked(&things->items[i], &things->items[j], values)) continue;
      drawing->links = make_room(drawing->links, drawing->link_count, sizeof *drawing->links);
      drawing->links[drawing->link_count++] = (struct DrawnLink){i, j};
    }
}

/* In the plane x to the right and y upwards; in space from above and aside, where gravity points down. */
static void project(const struct Things *things, const struct Model *model, const double position[3], double *right,
                    double *up) {
  const double azimuth = -1.1, elevation = 0.35;
  int upward = 2;
  for (int axis = 0; axis < 3; axis++)
    if (model->mechanism.gravity.along[axis] != ZERO) upward = axis;
  double first = position[(upward + 1) % 3], second = position[(upward + 2) % 3];
  *right = things->are_in_space ? -sin(azimuth) * first + cos(azimuth) * second : position[0];
  *up = things->are_in_space
            ? -sin(elevation) * (cos(azimuth) * first + sin(azimuth) * second) + cos(elevation) * position[upward]
            : position[1];
}

/* A uniform bar of mass m and length l has the moment of inertia m l^2/12. */
static void set_bar(struct DrawnPoint *point, const struct Body *body, const double *values) {
  double half = sqrt(3.0 * values[body->inertia.node] / values[body->mass.node]), angle = values[body->angle.node];
  if (!isfinite(half)) return;
  point->half_right = half * cos(angle);
  point->half_up = half * sin(angle);
}

static void place_points(struct Drawing *drawing, const struct Things *things, const struct Model *model,
                         const double *values) {
  drawing->points = allocate(things->count, sizeof *drawing->points);
  for (size_t i = 0; i < things->count; i++) {
    const struct Thing *thing = &things->items[i];
    struct DrawnPoint *point = &drawing->points[i];
    const double position[3] = {values[thing->position[0]], values[thing->position[1]], values[thing->position[2]]};
    point->kind = thing->kind;
    project(things, model, position, &point->right, &point->up);
    if (thing->kind == BODY_POINT) set_bar(point, thing->body, values);
    if (!isfinite(point->right) || !isfinite(point->up)) return; /* no point after this one is drawn */
    drawing->count++;
  }
}

struct Drawing drawing_of(const struct Model *model) {
  struct Drawing drawing = {.count = 0};
  struct Things things = things_of(model);
  double *values[TRIALS];
  for (int trial = 0; trial < TRIALS; trial++) values[trial] = moved_values(model, trial);
  place_points(&drawing, &things, model, values[0]);
  if (drawing.count == things.count) find_links(&drawing, &things, values);
  return drawing;
}
