#include "mechanics/lagrange.h"

#include <math.h>
#include <stdlib.h>

#include "algebra/differentiate.h"
#include "mechanics/energies.h"
#include "mechanics/mass_matrix.h"
#include "memory.h"
#include "algebra/rational.h"
#include "algebra/simplify.h"

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

/* How many operations the nodes take together. */
static size_t operations_of(const struct Graph *graph, const Node *nodes, size_t count) {
  bool *needed = allocate(graph->count, sizeof *needed);
  graph_mark(graph, nodes, count, needed);
  size_t operations = 0;
  for (Node node = 0; node < graph->count; node++)
    operations += needed[node] && operation_arity(graph->vertices[node].operation) > 0;
  free(needed);
  return operations;
}

static void take_shorter(const struct Graph *graph, size_t count, Node *nodes, const Node *others) {
  if (operations_of(graph, others, count) >= operations_of(graph, nodes, count)) return;
  for (size_t i = 0; i < count; i++) nodes[i] = others[i];
}

/* Takes the nodes multiplied out where that makes them shorter. */
static void shorten(struct Graph *graph, size_t count, Node *nodes) {
  Node *others = allocate(count, sizeof *others);
  for (size_t i = 0; i < count; i++) others[i] = simplify_fraction(graph, nodes[i]);
  take_shorter(graph, count, nodes, others);
  free(others);
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
  shorten(graph, n * n, equations->mass);
}

/* Everything that moves with an inertia: coordinates of positions with masses, angles with moments of inertia. */
struct Motions {
  Node *position, *inertia;
  size_t count;
};

static void append_motion(struct Motions *motions, Node position, Node inertia) {
  if (position == ZERO) return;
  motions->position[motions->count] = position;
  motions->inertia[motions->count++] = inertia;
}

static struct Motions motions_of(const struct Model *model) {
  struct Motions motions = {.position = allocate(4 * model->body_count, sizeof(Node)),
                            .inertia = allocate(4 * model->body_count, sizeof(Node))};
  for (size_t i = 0; i < model->body_count; i++) {
    const struct Body *body = &model->bodies[i];
    for (int axis = 0; axis < 3; axis++) append_motion(&motions, body->position[axis].node, body->mass.node);
    append_motion(&motions, body->angle.node, body->inertia.node);
  }
  return motions;
}

/* Directions in the space of all symbols: seeds of d/dt with accelerations, and without them. */
static Node *time_seeds(const struct Model *model, bool with_accelerations) {
  const struct Graph *graph = model->graph;
  Node *seeds = allocate(graph->symbol_count, sizeof *seeds);
  seeds[graph->vertices[model->time].left] = ONE;
  for (size_t i = 0; i < model->coordinates.count; i++) {
    seeds[graph->vertices[model->coordinates.items[i].node].left] = model->velocities.items[i].node;
    if (with_accelerations) seeds[graph->vertices[model->velocities.items[i].node].left] = model->accelerations[i];
  }
  return seeds;
}

/* sum m (d2r/dt2) . dr/dq_i, with the accelerations or with 0 for them. */
static void inertial_forces(struct Model *model, const struct Motions *motions, const Node *coordinates,
                            bool with_accelerations, Node *force) {
  struct Graph *graph = model->graph;
  Node *seeds = time_seeds(model, with_accelerations), *weight = allocate(motions->count, sizeof *weight);
  derivative_along(graph, motions->position, motions->count, seeds, weight);
  derivative_along(graph, weight, motions->count, seeds, weight);
  for (size_t k = 0; k < motions->count; k++) weight[k] = multiply(graph, motions->inertia[k], weight[k]);
  weighted_gradient_of(graph, motions->position, weight, motions->count, coordinates, model->coordinates.count, force);
  free(weight);
  free(seeds);
}

/*
 * Multiplied out, the inertial forces in curvilinear coordinates lose terms that only cancel each other; others grow.
 * left: the inertial forces without and with accelerations, which are replaced where that makes them shorter. Forces
 * and potentials stay as their author wrote them: k*(r - l0) is more accurate than k*r - k*l0.
 */
static void shorten_inertial_forces(struct Graph *graph, const struct Equations *equations, const Node *accelerations,
                                    Node *left[2]) {
  size_t n = equations->count;
  shorten(graph, n, left[0]);
  Node *other = allocate(n, sizeof *other);
  for (size_t i = 0; i < n; i++) {
    other[i] = left[0][i];
    for (size_t j = 0; j < n; j++)
      other[i] = add(graph, other[i], multiply(graph, equations->mass[i * n + j], accelerations[j]));
  }
  take_shorter(graph, n, left[1], other);
  free(other);
}

/* right_side: what Lagrange's equation leaves when the accelerations are 0; residual: M a - right_side. */
static void derive_motion(struct Model *model, struct Equations *equations, const Node *coordinates,
                          const Node *velocities, const Node *force) {
  struct Graph *graph = model->graph;
  size_t n = equations->count;
  struct Motions motions = motions_of(model);
  Node lagrangian = subtract(graph, model->explicit_kinetic.node, model->potential.node);
  Node *momentum = allocate(n, sizeof *momentum), *gradient = allocate(n, sizeof *gradient);
  Node *rate = allocate(n, sizeof *rate), *inertial = allocate(n, sizeof *inertial);
  Node *left[2] = {allocate(n, sizeof(Node)), allocate(n, sizeof(Node))};
  gradient_of(graph, lagrangian, velocities, n, momentum);
  gradient_of(graph, lagrangian, coordinates, n, gradient);
  for (int with_accelerations = 0; with_accelerations <= 1; with_accelerations++) {
    Node *seeds = time_seeds(model, with_accelerations == 1);
    derivative_along(graph, momentum, n, seeds, rate);
    inertial_forces(model, &motions, coordinates, with_accelerations == 1, inertial);
    for (size_t i = 0; i < n; i++) left[with_accelerations][i] = add(graph, inertial[i], rate[i]);
    free(seeds);
  }
  shorten_inertial_forces(graph, equations, model->accelerations, left);
  for (size_t i = 0; i < n; i++) {
    Node right = add(graph, force[i], gradient[i]);
    equations->right_side[i] = subtract(graph, right, left[0][i]);
    equations->residual[i] = subtract(graph, left[1][i], right);
  }
  free(motions.position);
  free(motions.inertia);
  free(momentum);
  free(gradient);
  free(rate);
  free(inertial);
  free(left[0]);
  free(left[1]);
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

  Node *momentum = allocate(n, sizeof *momentum), *force = generalized_forces(model, v);
  gradient_of(graph, subtract(graph, model->kinetic.node, model->potential.node), v, n, momentum);
  derive_mass_matrix(graph, equations, momentum, v);
  derive_motion(model, equations, q, v, force);
  for (size_t i = 0; i < n; i++) equations->power = add(graph, equations->power, multiply(graph, force[i], v[i]));
  equations->power = add(graph, equations->power, model->driven_power.node);
  equations->kinetic = model->kinetic_energy.node;
  equations->potential = stored_energy(model, model->potential.node);
  equations->total = add(graph, equations->kinetic, equations->potential);

  if (graph->overflow)
    report_error(diagnostics, 0, "the equations of motion need more than %d operations; expected a smaller system",
                 NODE_LIMIT);
  else if (mass_matrix_check(model, equations, diagnostics)) mass_matrix_factor(model, equations);
  free(q);
  free(v);
  free(momentum);
  free(force);
  return equations;
}

/* Whether the nodes are made of finite numbers. */
static bool are_finite(const struct Graph *graph, const Node *nodes, size_t count) {
  bool *needed = allocate(graph->count, sizeof *needed), finite = true;
  graph_mark(graph, nodes, count, needed);
  for (Node node = 0; node < graph->count && finite; node++)
    finite = !needed[node] || !graph_is_constant(graph, node) || isfinite(graph_value(graph, node));
  free(needed);
  return finite;
}

void equations_check_finite(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics) {
  const Node *nodes = equations->explicit_form ? equations->acceleration : equations->residual;
  size_t wrong = 0;
  if (are_finite(model->graph, nodes, equations->count)) return;
  while (are_finite(model->graph, nodes + wrong, 1)) wrong++;
  report_error(diagnostics, model->velocities.items[wrong].line,
               "the equation of der(%s) has a coefficient that is not finite; expected numbers below 1e308, and no "
               "point at a pole",
               model->velocities.items[wrong].name);
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
