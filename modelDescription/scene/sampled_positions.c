#include "sampled_positions.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "configurations.h"

/*
 * Index of the base. Number of samples without constraints, which overdetermine every test. Largest number of
 * constraints taken into account, as the cost of a test grows with its third power.
 */
enum { BASE = 0, FEWEST = 8, MOST_CONSTRAINTS = 16 };

/* Returns the node of NAME.x, NAME.y or NAME.z; ZERO for none. */
static Node component(const struct Model *model, const char *name, const char *axis) {
  char *full = format_text("%s.%s", name, axis);
  for (size_t i = 0; i < model->mechanism.element_variables.count; i++)
    if (strcmp(model->mechanism.element_variables.items[i].name, full) == 0)
      return model->mechanism.element_variables.items[i].node;
  return ZERO;
}

/* Appends an object with its position. A body outside frames has its own components, where given. */
static void append_object(struct SampledPositions *samples, struct SceneObject object) {
  const struct Body *body = object.body;
  bool is_free = body != NULL && !body->is_in_frame;
  for (int axis = 0; axis < 3 && object.name != NULL; axis++)
    if (!is_free || body->has_position[axis])
      object.position[axis] = is_free ? body->position[axis].node : component(samples->model, object.name, axes[axis]);
  APPEND(samples->objects, samples->object_count, object);
}

/* Returns the index of the object of a frame, which may be a body; 0 for the base. */
static size_t object_of_frame(const struct SampledPositions *samples, size_t frame) {
  size_t object = samples->object_count;
  while (frame != BASE && --object > 0)
    if (strcmp(samples->objects[object].name, samples->model->mechanism.frames[frame].name) == 0) return object;
  return 0;
}

static void find_objects(struct SampledPositions *samples) {
  const struct Mechanism *mechanism = &samples->model->mechanism;
  append_object(samples, (struct SceneObject){.name = NULL});
  for (size_t i = BASE + 1; i < mechanism->frame_count; i++)
    if (!mechanism->frames[i].is_of_body)
      append_object(samples, (struct SceneObject){.name = mechanism->frames[i].name});
  size_t first_body = samples->object_count;
  for (size_t i = 0; i < mechanism->body_count; i++) {
    const struct Body *body = &mechanism->bodies[i];
    append_object(samples,
                  (struct SceneObject){
                      .name = body->name, .body = body, .angle = body->angle.node, .is_planar = body->has_angle});
  }
  for (size_t i = BASE + 1, object = 1; i < mechanism->frame_count; i++)
    if (!mechanism->frames[i].is_of_body)
      samples->objects[object++].frame = object_of_frame(samples, mechanism->frames[i].parent);
  for (size_t i = 0; i < mechanism->body_count; i++)
    if (mechanism->bodies[i].is_in_frame)
      samples->objects[first_body + i].frame = object_of_frame(samples, mechanism->bodies[i].frame);
}

static void find_constraints(struct SampledPositions *samples) {
  const struct VariableList *all = &samples->model->constraints;
  for (size_t i = 0; i < all->count && samples->constraint_count <= MOST_CONSTRAINTS; i++) {
    if (!holds_positions(samples->model, i)) continue;
    APPEND(samples->constraints, samples->constraint_count, i);
  }
  if (samples->constraint_count > MOST_CONSTRAINTS) samples->constraint_count = 0;
}

/* Returns a different offset for each sample and symbol, 0 for the first sample. */
static double moved(size_t sample, size_t symbol) {
  return sample == 0 ? 0.0 : 0.4 * sin(1.0 + 2.7 * (double)sample * (double)(symbol + 1));
}

static double *moved_symbols(const struct Model *model, size_t sample, bool is_still, const double *parameters) {
  double *symbols = start_values(model);
  for (size_t i = 0; i < model->graph->symbol_count; i++) {
    enum SymbolKind kind = model->graph->symbols[i].kind;
    bool is_moved = kind == COORDINATE || (!is_still && (kind == INPUT || kind == TIME));
    if (is_moved) symbols[i] += moved(sample, i);
  }
  for (size_t i = 0; parameters != NULL && i < model->parameters.count; i++)
    symbols[model->graph->vertices[model->parameters.items[i].node].left] += parameters[i];
  return symbols;
}

static Node later(Node first, Node second) {
  return first > second ? first : second;
}

/* Returns the last node that is evaluated; the equations derived from it are far more. */
static Node last_node(const struct SampledPositions *samples) {
  const struct Model *model = samples->model;
  Node last = ZERO;
  for (size_t i = 0; i < samples->object_count; i++) {
    const struct SceneObject *object = &samples->objects[i];
    for (int axis = 0; axis < 3; axis++) last = later(last, object->position[axis]);
    last = later(last, object->angle);
  }
  for (size_t i = 0; i < model->coordinates.count; i++) last = later(last, model->coordinates.items[i].node);
  for (size_t i = 0; i < model->constraints.count; i++) last = later(last, model->constraints.items[i].node);
  for (size_t i = 0; i < model->switches.contact_count; i++) last = later(last, model->switches.contacts[i].gap);
  return last;
}

struct SampledPositions sample_positions(const struct Model *model, bool is_still, const double *parameters) {
  struct SampledPositions samples = {.model = model};
  find_objects(&samples);
  find_constraints(&samples);
  samples.count = FEWEST + 2 * samples.constraint_count;
  samples.values = allocate(samples.count, sizeof *samples.values);
  for (size_t k = 0; k < samples.count; k++) {
    double *symbols = moved_symbols(model, k, is_still, parameters);
    samples.values[k] = graph_evaluate_first(model->graph, symbols, (size_t)last_node(&samples) + 1);
    release(symbols);
  }
  return samples;
}

void release_positions(struct SampledPositions *samples) {
  for (size_t k = 0; k < samples->count; k++) release(samples->values[k]);
  samples->count = 0;
}
