#include "lagrange.h"

#include <stdlib.h>

#include "differentiate.h"
#include "mass_matrix.h"
#include "memory.h"
#include "simplify.h"

static void symbols_of(const struct VariableList *list, Node *symbols) {
  for (size_t i = 0; i < list->count; i++) symbols[i] = list->items[i].node;
}

/* Q_i, with -dD/dv_i of the dissipation function D added. */
static Node *generalized_forces(struct Model *model, const Node *velocities) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  Node *force = allocate(n, sizeof *force);
  gradient_of(graph, model->dissipation.node, velocities, n, force);
  for (size_t i = 0; i < n; i++) force[i] = subtract(graph, model->forces[i].node, force[i]);
  return force;
}

/* M_ij = d p_i / d v_j, column by column. */
static void derive_mass_matrix(struct Graph *graph, struct Equations *equations, const Node *momentum,
                               const Node *velocities) {
  size_t n = equations->count;
  Node *column = allocate(n, sizeof *column);
  for (size_t j = 0; j < n && !graph->overflow; j++) {
    Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
    seeds[graph->vertices[velocities[j]].left] = ONE;
    derivative_along(graph, momentum + j, n - j, seeds, column);
    for (size_t i = j; i < n; i++) equations->mass[i * n + j] = equations->mass[j * n + i] = column[i - j];
    free(seeds);
  }
  free(column);
}

/* d p / dt splits into M a, along the accelerations, and the rest, along v and time. */
static void derive_right_side(struct Model *model, struct Equations *equations, const Node *momentum,
                              const Node *gradient, const Node *force) {
  struct Graph *graph = model->graph;
  size_t n = equations->count;
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  Node *rate = allocate(n, sizeof *rate), *inertia = allocate(n, sizeof *inertia);
  seeds[graph->vertices[model->time].left] = ONE;
  for (size_t i = 0; i < n; i++)
    seeds[graph->vertices[model->coordinates.items[i].node].left] = model->velocities.items[i].node;
  derivative_along(graph, momentum, n, seeds, rate);
  free(seeds);
  seeds = allocate(graph->symbol_count, sizeof *seeds);
  for (size_t i = 0; i < n; i++)
    seeds[graph->vertices[model->velocities.items[i].node].left] = model->accelerations[i];
  derivative_along(graph, momentum, n, seeds, inertia);
  for (size_t i = 0; i < n; i++) {
    Node right = add(graph, force[i], gradient[i]);
    equations->right_side[i] = subtract(graph, right, rate[i]);
    equations->residual[i] = subtract(graph, inertia[i], equations->right_side[i]);
  }
  free(seeds);
  free(rate);
  free(inertia);
}

/* What of U is stored energy: terms linear in the velocities (magnetic forces) store none. */
static Node stored_energy(struct Model *model, const Node *velocities) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  Node energy = model->potential.node, *slope = allocate(n, sizeof *slope);
  gradient_of(graph, energy, velocities, n, slope);
  for (size_t i = 0; i < n; i++) energy = subtract(graph, energy, multiply(graph, slope[i], velocities[i]));
  free(slope);
  return energy;
}

struct Equations *equations_derive(struct Model *model, struct Diagnostics *diagnostics) {
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  struct Equations *equations = allocate(1, sizeof *equations);
  equations->count = n;
  equations->mass = allocate(n * n, sizeof(Node));
  equations->right_side = allocate(n, sizeof(Node));
  equations->residual = allocate(n, sizeof(Node));
  equations->acceleration = allocate(n, sizeof(Node));
  Node *q = allocate(n, sizeof *q), *v = allocate(n, sizeof *v);
  symbols_of(&model->coordinates, q);
  symbols_of(&model->velocities, v);

  Node lagrangian = subtract(graph, model->kinetic.node, model->potential.node);
  Node *momentum = allocate(n, sizeof *momentum), *gradient = allocate(n, sizeof *gradient);
  gradient_of(graph, lagrangian, v, n, momentum);
  gradient_of(graph, lagrangian, q, n, gradient);
  Node *force = generalized_forces(model, v);
  derive_mass_matrix(graph, equations, momentum, v);
  derive_right_side(model, equations, momentum, gradient, force);
  for (size_t i = 0; i < n; i++)
    equations->power = add(graph, equations->power, multiply(graph, force[i], v[i]));
  equations->kinetic = model->kinetic.node;
  equations->potential = stored_energy(model, v);
  equations->total = add(graph, equations->kinetic, equations->potential);

  if (graph->overflow)
    report_error(diagnostics, 0, "the equations of motion need more than %d operations; expected a smaller system",
                 NODE_LIMIT);
  else if (mass_matrix_check(model, equations, diagnostics)) mass_matrix_factor(model, equations);
  free(q);
  free(v);
  free(momentum);
  free(gradient);
  free(force);
  return equations;
}

void equations_free(struct Equations *equations) {
  if (equations == NULL) return;
  free(equations->mass);
  free(equations->right_side);
  free(equations->residual);
  free(equations->block);
  free(equations->unrolled);
  free(equations->lower);
  free(equations->diagonal);
  free(equations->acceleration);
  free(equations->pivots);
  free(equations);
}
