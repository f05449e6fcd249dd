#include "mechanics/energies.h"

#include <math.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"

/* True for the velocity of a coordinate, and for an input that is the time derivative of another. */
static bool is_velocity(const struct Model *model, Node node) {
  const struct Symbol *symbol = graph_symbol_of(model->graph, node);
  return symbol->kind == VELOCITY || (symbol->kind == INPUT && is_input_rate(model, (size_t)symbol->index));
}

bool work_includes_all_forces(const struct Model *model) {
  const struct PrescribedMotions *prescribed = &model->prescribed;
  bool is_prescribed = prescribed->inputs_move || prescribed->motion_count > 0;
  return work_of(model) != NULL && (prescribed->states_move || prescribed->constraint != NULL ||
                                    (is_prescribed && model->constraints.count > 0) ||
                                    graph_depends_on(model->graph, model->energies.potential.node, STATE));
}

Node stored_energy(const struct Model *model, Node potential) {
  struct Graph *graph = model->graph;
  struct Gradient slopes = gradient_by_kinds(graph, potential, 1u << VELOCITY | 1u << INPUT);
  Node energy = potential;
  for (size_t i = 0; i < slopes.count; i++)
    if (is_velocity(model, slopes.symbols[i]))
      energy = subtract(graph, energy, multiply(graph, slopes.values[i], slopes.symbols[i]));
  return energy;
}

/*
 * Lowest and highest degree of an expression's terms in the velocities; the highest is INFINITY if it is no polynomial.
 */
struct Degrees {
  double lowest, highest;
};

/*
 * Returns the degrees of a node from those of the nodes below, which are indexed by their positions in the graph's
 * cone.
 */
static struct Degrees degrees_of_vertex(const struct Model *model, Node node, const struct Degrees *of) {
  const struct Graph *graph = model->graph;
  const struct Vertex *vertex = &graph->vertices[node];
  bool is_symbol = vertex->operation == SYMBOL;
  if (!graph_depends_on(graph, node, VELOCITY) && !graph_depends_on(graph, node, INPUT)) return (struct Degrees){0, 0};
  if (is_symbol) return is_velocity(model, node) ? (struct Degrees){1, 1} : (struct Degrees){0, 0};
  struct Degrees left = of[cone_slot(graph->cone, vertex->left)], right = {0, 0};
  if (operation_arity(vertex->operation) == 2) right = of[cone_slot(graph->cone, vertex->right)];
  switch (vertex->operation) {
  case ADD: return (struct Degrees){fmin(left.lowest, right.lowest), fmax(left.highest, right.highest)};
  case MULTIPLY: return (struct Degrees){left.lowest + right.lowest, left.highest + right.highest};
  case POWER: {
    double n = graph_is_constant(graph, vertex->right) ? graph_value(graph, vertex->right) : NAN;
    if (left.highest == 0 && right.highest == 0) return (struct Degrees){0, 0};
    if (n > 0 && n == floor(n)) return (struct Degrees){n * left.lowest, n * left.highest};
    return (struct Degrees){0, INFINITY};
  }
  default: return (struct Degrees){0, left.highest > 0 || right.highest > 0 ? INFINITY : 0};
  }
}

static struct Degrees degrees_of(const struct Model *model, Node target) {
  const struct Graph *graph = model->graph;
  struct Cone *cone = graph->cone;
  cone_collect(cone, graph, &target, 1);
  struct Degrees *of = allocate(cone->count, sizeof *of);
  for (size_t index = 0; index < cone->count; index++) of[index] = degrees_of_vertex(model, cone->nodes[index], of);
  return of[cone_slot(cone, target)];
}

Node energy_of_kinetic_term(const struct Model *model, Node term, bool *is_prescribed) {
  struct Degrees degrees = degrees_of(model, term);
  /* Terms of other degrees may cancel once multiplied out. */
  if (degrees.lowest != 2 || degrees.highest != 2) degrees = degrees_of(model, simplify_fraction(model->graph, term));
  *is_prescribed = degrees.highest == 2 && degrees.lowest < 2;
  return degrees.highest == 2 ? term : negate(model->graph, stored_energy(model, term));
}
