#include "program/series_plan.h"

#include <math.h>
#include <stdlib.h>

#include "memory.h"
#include "algebra/simplify.h"

static void append(struct SeriesPlan *plan, Node node) {
  plan->targets = reallocate(plan->targets, plan->count + 1, sizeof *plan->targets);
  plan->targets[plan->count++] = node;
}

static Node square(struct Graph *graph, Node node) {
  return graph_node(graph, POWER, node, graph_constant(graph, 2.0));
}

/* sign + factor * node^2 */
static Node square_plus(struct Graph *graph, double sign, double factor, Node node) {
  return add(graph, graph_constant(graph, sign), scale(graph, factor, square(graph, node)));
}

/*
 * Whole powers come from smaller ones, so that a base of 0 is no pole, and negative ones are quotients; variable
 * exponents go by exp and log.
 */
static Node auxiliary_of_power(struct Graph *graph, const struct Vertex *vertex) {
  if (!graph_is_constant_in_time(graph, vertex->right))
    return multiply(graph, vertex->right, function(graph, LOGARITHM, vertex->left, ZERO));
  double exponent = graph_is_constant(graph, vertex->right) ? graph_value(graph, vertex->right) : NAN;
  if (exponent == -0.5 || (exponent == floor(exponent) && exponent < -1.0))
    return graph_node(graph, POWER, vertex->left, graph_constant(graph, -exponent));
  if (exponent != floor(exponent) || exponent < 3.0) return ZERO;
  double lower = fmod(exponent, 2.0) == 0.0 ? exponent / 2.0 : exponent - 1.0;
  return graph_node(graph, POWER, vertex->left, graph_constant(graph, lower));
}

/* With y for the node and x for its operand: y' = x' a, or x' / a for the inverse functions, and a is returned. */
static Node auxiliary_of(struct Graph *graph, Node node) {
  const struct Vertex vertex = graph->vertices[node];
  switch (vertex.operation) {
  case SINE: return graph_node(graph, COSINE, vertex.left, ZERO);
  case COSINE: return graph_node(graph, SINE, vertex.left, ZERO);
  case SINH: return graph_node(graph, COSH, vertex.left, ZERO);
  case COSH: return graph_node(graph, SINH, vertex.left, ZERO);
  case TANGENT: return square_plus(graph, 1.0, 1.0, node);
  case TANH: return square_plus(graph, 1.0, -1.0, node);
  case ARCSINE:
  case ARCCOSINE: return power_number(graph, square_plus(graph, 1.0, -1.0, vertex.left), 0.5);
  case ARCTANGENT: return square_plus(graph, 1.0, 1.0, vertex.left);
  case ARSINH: return power_number(graph, square_plus(graph, 1.0, 1.0, vertex.left), 0.5);
  case ARCOSH: return power_number(graph, square_plus(graph, -1.0, 1.0, vertex.left), 0.5);
  case ARTANH: return square_plus(graph, 1.0, -1.0, vertex.left);
  case ATAN2: return add(graph, square(graph, vertex.left), square(graph, vertex.right));
  case POWER: return auxiliary_of_power(graph, &vertex);
  case MINIMUM:
  case MAXIMUM:
  case LESS: return subtract(graph, vertex.left, vertex.right);
  default: return ZERO;
  }
}

/*
 * The name of the kink that a node makes, NULL for none. An inverse function of its own function is piecewise linear:
 * its series goes on where it turns.
 */
static const char *kink_without_series(const struct Graph *graph, Node node) {
  const struct Vertex *vertex = &graph->vertices[node];
  enum Operation inner = operation_arity(vertex->operation) == 1 ? graph->vertices[vertex->left].operation : CONSTANT;
  bool of_wave = inner == SINE || inner == COSINE;
  switch (vertex->operation) {
  case ARCSINE: return of_wave ? "asin of a sine" : NULL;
  case ARCCOSINE: return of_wave ? "acos of a cosine" : NULL;
  case ARCTANGENT: return inner == TANGENT ? "atan of a tangent" : NULL;
  default: return NULL;
  }
}

static const char *kink_at(const struct Graph *graph, Node node) {
  enum Operation operation = graph->vertices[node].operation;
  bool has_pieces =
      operation == MINIMUM || operation == MAXIMUM || operation == ABSOLUTE || operation == SIGN || operation == LESS;
  return has_pieces ? operation_name(operation) : kink_without_series(graph, node);
}

/* What `at` says of the first node below these that changes in time and of which it says something. */
static const char *find_kink(const struct Graph *graph, const Node *nodes, size_t count,
                             const char *(*at)(const struct Graph *, Node)) {
  bool *needed = allocate(graph->count, sizeof *needed);
  const char *kink = NULL;
  graph_mark(graph, nodes, count, needed);
  for (Node node = 0; node < graph->count && kink == NULL; node++)
    if (needed[node] && !graph_is_constant_in_time(graph, node)) kink = at(graph, node);
  free(needed);
  return kink;
}

const char *kink_of(const struct Graph *graph, const Node *nodes, size_t count) {
  return find_kink(graph, nodes, count, kink_at);
}

const char *kink_without_series_of(const struct Graph *graph, const Node *nodes, size_t count) {
  return find_kink(graph, nodes, count, kink_without_series);
}

static void append_equations(struct SeriesPlan *plan, const struct Equations *equations) {
  size_t n = equations->count;
  for (size_t i = 0; i < n; i++) {
    if (!is_looped(equations, i)) {
      append(plan, equations->acceleration[i]);
      continue;
    }
    append(plan, equations->right_side[i]);
    const struct InertiaBlock *block = inertia_block_of(equations->inertia, i);
    size_t row = equations->inertia->place_of[i];
    for (size_t k = block->start[row]; k < block->start[row + 1]; k++) append(plan, block->mass[k]);
  }
}

/* Adds the auxiliary nodes of all nodes that the targets need, and theirs, until there are no new ones. */
static void close(struct SeriesPlan *plan, struct Graph *graph) {
  bool *visited = NULL;
  size_t known = 0;
  for (bool grown = true; grown && !graph->overflow;) {
    size_t size = graph->count;
    bool *needed = allocate(size, sizeof *needed);
    visited = reallocate(visited, size, sizeof *visited);
    for (; known < size; known++) visited[known] = false;
    graph_mark(graph, plan->targets, plan->count, needed);
    grown = false;
    for (Node node = 0; node < size; node++) {
      if (!needed[node] || visited[node] || graph_is_constant_in_time(graph, node)) continue;
      visited[node] = grown = true;
      Node auxiliary = auxiliary_of(graph, node);
      if (auxiliary != ZERO) append(plan, auxiliary);
    }
    free(needed);
  }
  free(visited);
}

/* The plan with its targets given. */
static struct SeriesPlan *finish(struct SeriesPlan *plan, struct Graph *graph) {
  close(plan, graph);
  size_t size = graph->count;
  bool *needed = allocate(size, sizeof *needed);
  graph_mark(graph, plan->targets, plan->count, needed);
  plan->auxiliary = allocate(size, sizeof *plan->auxiliary);
  for (Node node = 0; node < size; node++)
    if (needed[node] && !graph_is_constant_in_time(graph, node)) plan->auxiliary[node] = auxiliary_of(graph, node);
  free(needed);
  return plan;
}

struct SeriesPlan *series_plan_of_motion(struct Graph *graph, const struct Equations *equations, bool with_power) {
  struct SeriesPlan *plan = allocate(1, sizeof *plan);
  append_equations(plan, equations);
  if (with_power) append(plan, equations->power);
  return finish(plan, graph);
}

struct SeriesPlan *series_plan_of_outputs(struct Graph *graph, const Node *outputs, size_t count) {
  struct SeriesPlan *plan = allocate(1, sizeof *plan);
  for (size_t i = 0; i < count; i++) append(plan, outputs[i]);
  return finish(plan, graph);
}

void series_plan_free(struct SeriesPlan *plan) {
  if (plan == NULL) return;
  free(plan->targets);
  free(plan->auxiliary);
  free(plan);
}
