#include "mechanics/constraints.h"

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/time_derivative.h"

static void append_row(struct Constraints *constraints, const struct Model *model, size_t row, Node target,
                       enum SymbolKind kind) {
  struct Graph *graph = model->graph;
  struct Gradient gradient = gradient_by_kinds(graph, target, 1u << kind);
  for (size_t i = 0; i < gradient.count; i++) {
    size_t coordinate = (size_t)graph_symbol_of(graph, gradient.symbols[i])->index;
    bool is_prescribed = model->prescribed.motions[coordinate].is_prescribed;
    elements_append(is_prescribed ? &constraints->prescribed : &constraints->jacobian, row, coordinate,
                    gradient.values[i]);
  }
}

static bool has_element(const struct Elements *elements, size_t row, size_t column) {
  bool has = false;
  for (size_t k = 0; k < elements->count; k++)
    has |= elements->positions[k].row == row && elements->positions[k].column == column;
  return has;
}

/*
 * Appends the generalized forces that depend on constraint forces. J gets elements of 0 at their positions, so that its
 * pattern includes them.
 */
static void append_nonsymmetric(struct Constraints *constraints, const struct Model *model) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  for (size_t i = 0; i < n; i++) {
    struct Gradient gradient = gradient_by_kinds(graph, model->forces.along[i].node, 1u << ACCELERATION);
    for (size_t k = 0; k < gradient.count && !model->prescribed.motions[i].is_prescribed; k++) {
      size_t row = (size_t)graph_symbol_of(graph, gradient.symbols[k])->index - n;
      elements_append(&constraints->nonsymmetric, row, i, negate(graph, gradient.values[k]));
      if (!has_element(&constraints->jacobian, row, i)) elements_append(&constraints->jacobian, row, i, ZERO);
    }
  }
}

struct Constraints *constraints_derive(const struct Model *model) {
  struct Graph *graph = model->graph;
  size_t count = model->constraints.count;
  struct Constraints *constraints = allocate(1, sizeof *constraints);
  *constraints = (struct Constraints){.count = count,
                                      .position = allocate(count, sizeof(Node)),
                                      .velocity = allocate(count, sizeof(Node)),
                                      .acceleration = allocate(count, sizeof(Node)),
                                      .acceleration_rest = allocate(count, sizeof(Node))};
  Node *seeds = time_seeds(model, true), *seeds_of_rest = time_seeds(model, false);
  for (size_t j = 0; j < count; j++) {
    Node node = model->constraints.items[j].node;
    bool is_holonomic = !graph_depends_on(graph, node, VELOCITY);
    if (is_holonomic) constraints->position[j] = node;
    append_row(constraints, model, j, node, is_holonomic ? COORDINATE : VELOCITY);
    if (is_holonomic) derivative_along(graph, &node, 1, seeds, &constraints->velocity[j]);
    else constraints->velocity[j] = node;
    derivative_along(graph, &constraints->velocity[j], 1, seeds, &constraints->acceleration[j]);
    derivative_along(graph, &constraints->velocity[j], 1, seeds_of_rest, &constraints->acceleration_rest[j]);
  }
  append_nonsymmetric(constraints, model);
  return constraints;
}

Node constraint_force_along(struct Graph *graph, const struct Elements *elements, size_t element, const Node *forces) {
  return multiply(graph, elements->nodes[element], forces[elements->positions[element].row]);
}

Node *constraint_slopes(struct Graph *graph, const struct Constraints *constraints) {
  const struct Elements *jacobian = &constraints->jacobian;
  Node *slopes = allocate(constraints->count, sizeof *slopes);
  for (size_t k = 0; k < jacobian->count; k++) {
    Node *slope = &slopes[jacobian->positions[k].row];
    *slope = add(graph, *slope, power_number(graph, jacobian->nodes[k], 2.0));
  }
  for (size_t j = 0; j < constraints->count; j++) slopes[j] = power_number(graph, slopes[j], 0.5);
  return slopes;
}

bool depend_on_constraint_force(const struct Model *model, const Node *nodes, size_t count) {
  const struct Graph *graph = model->graph;
  bool depends = false;
  if (model->constraints.count == 0) return false;
  cone_collect(graph->cone, graph, nodes, count);
  for (size_t j = 0; j < model->constraints.count && !depends; j++)
    depends = cone_has(graph->cone, model->unknowns.forces[j]);
  return depends;
}
