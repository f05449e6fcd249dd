#include "model/prescribed_frictions.h"

#include "algebra/differentiate.h"
#include "base/memory.h"

/*
 * Returns the only velocity in a permanent constraint that is not prescribed yet; the number of coordinates if there
 * are several, or none.
 */
static size_t only_free_velocity(const struct Model *model, Node constraint, const bool *is_prescribed) {
  const struct Graph *graph = model->graph;
  size_t n = model->coordinates.count, found = n;
  enum SymbolKind kind = graph_depends_on(graph, constraint, VELOCITY) ? VELOCITY : COORDINATE;
  const struct Gradient gradient = gradient_by_kinds(model->graph, constraint, 1u << kind);
  for (size_t i = 0; i < gradient.count; i++) {
    size_t index = (size_t)graph_symbol_of(graph, gradient.symbols[i])->index;
    if (is_prescribed[index]) continue;
    if (found < n || graph_depends_on(graph, gradient.values[i], MODE)) return n;
    found = index;
  }
  return found;
}

/* Returns, for each velocity, whether it is prescribed, directly or through constraints. */
static bool *prescribed_velocities(const struct Model *model) {
  size_t n = model->coordinates.count;
  bool *is_prescribed = allocate(n, sizeof *is_prescribed), grows = true;
  for (size_t i = 0; i < n; i++) is_prescribed[i] = model->prescribed.motions[i].is_prescribed;
  while (grows) {
    grows = false;
    for (size_t i = 0; i < model->constraints.count; i++) {
      size_t found = only_free_velocity(model, model->constraints.items[i].node, is_prescribed);
      if (found == n) continue;
      is_prescribed[found] = grows = true;
    }
  }
  return is_prescribed;
}

static bool has_prescribed_velocity(const struct Model *model, const struct Friction *friction,
                                    const bool *is_prescribed) {
  const struct Gradient gradient = gradient_by_kinds(model->graph, friction->velocity, 1u << VELOCITY);
  bool all = true;
  for (size_t i = 0; i < gradient.count; i++)
    all &= is_prescribed[graph_symbol_of(model->graph, gradient.symbols[i])->index];
  return all;
}

/* Adds a branch on the sign of the velocity, unless the friction is in a plane: the runtime monitors its speed. */
static void follow_sign(struct Model *model, const struct Friction *friction) {
  const struct Variable *constraint = &model->constraints.items[friction->constraint];
  append_branch(&model->switches, (struct Branch){.mode = friction->mode,
                                                  .indicator = friction->velocity,
                                                  .is_of_friction = true,
                                                  .kinds = model->graph->vertices[friction->velocity].kinds,
                                                  .function = format_text("the friction '%s'", constraint->name),
                                                  .line = constraint->line});
}

void find_prescribed_frictions(struct Model *model) {
  struct Switches *switches = &model->switches;
  if (switches->friction_count == 0) return;
  const bool *is_prescribed = prescribed_velocities(model);
  size_t parts;
  for (size_t i = 0; i < switches->friction_count; i += parts) {
    struct Friction *friction = &switches->frictions[i];
    bool all = true;
    parts = friction->plane.axis == NO_PLANE ? 1 : 2;
    for (size_t part = 0; part < parts; part++) all &= has_prescribed_velocity(model, &friction[part], is_prescribed);
    for (size_t part = 0; part < parts && all; part++) {
      friction[part].is_given = true;
      model->constraints.items[friction[part].constraint].node = ZERO;
    }
    if (all && parts == 1) follow_sign(model, friction);
  }
}
