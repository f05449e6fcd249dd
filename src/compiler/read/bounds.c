#include "read/bounds.h"

#include <math.h>

#include "algebra/cone.h"
#include "base/memory.h"

static const struct Bounds everything = {-INFINITY, INFINITY};

static const double quarter_turn = 1.57079632679489662; /* pi/2 rad */

static double larger(double a, double b) {
  return a > b ? a : b;
}

static double smaller(double a, double b) {
  return a < b ? a : b;
}

/* Returns a product, in which 0 times an infinite bound is 0. */
static double product(double a, double b) {
  return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

static struct Bounds multiplied(struct Bounds a, struct Bounds b) {
  double corners[] = {product(a.low, b.low), product(a.low, b.high), product(a.high, b.low), product(a.high, b.high)};
  struct Bounds bounds = {corners[0], corners[0]};
  for (int i = 1; i < 4; i++) {
    bounds.low = smaller(bounds.low, corners[i]);
    bounds.high = larger(bounds.high, corners[i]);
  }
  return bounds;
}

/* Returns bounds of the magnitude. */
static struct Bounds magnitude(struct Bounds a) {
  bool passes_zero = a.low < 0.0 && a.high > 0.0;
  return (struct Bounds){passes_zero ? 0.0 : smaller(fabs(a.low), fabs(a.high)), larger(fabs(a.low), fabs(a.high))};
}

static struct Bounds raised(const struct Graph *graph, struct Bounds a, Node exponent) {
  double n = graph_is_constant(graph, exponent) ? graph_value(graph, exponent) : NAN;
  if (isnan(n) || (n < 0.0 && fmod(n, 2.0) != 0.0 && a.low < 0.0))
    return a.low >= 0.0 ? (struct Bounds){0, INFINITY} : everything;
  bool is_even = fmod(n, 2.0) == 0.0, is_whole = n == floor(n);
  if (is_even) a = magnitude(a);
  if (!is_whole) a.low = larger(a.low, 0.0);
  if (n > 0.0) return (struct Bounds){pow(a.low, n), pow(a.high, n)};
  return (struct Bounds){a.high > 0.0 ? pow(a.high, n) : 0.0, a.low > 0.0 ? pow(a.low, n) : INFINITY};
}

static struct Bounds of_symbol(const struct Model *model, Node node) {
  const struct Symbol *symbol = graph_symbol_of(model->graph, node);
  if (symbol->kind == MODE && branch_with_mode(&model->switches, node) != NULL) return (struct Bounds){-1.0, 1.0};
  if (symbol->kind != PARAMETER) return everything;
  const struct Variable *parameter = &model->parameters.items[symbol->index];
  return (struct Bounds){isnan(parameter->minimum) ? -INFINITY : parameter->minimum,
                         isnan(parameter->maximum) ? INFINITY : parameter->maximum};
}

static struct Bounds of_function(enum Operation operation, struct Bounds a) {
  switch (operation) {
  case SINE:
  case COSINE: return (struct Bounds){-1.0, 1.0};
  case TANH: return (struct Bounds){tanh(a.low), tanh(a.high)};
  case ARCSINE: return (struct Bounds){-quarter_turn, quarter_turn};
  case ARCTANGENT: return (struct Bounds){atan(a.low), atan(a.high)};
  case ARCCOSINE: return (struct Bounds){0.0, 2.0 * quarter_turn};
  case COSH: return (struct Bounds){1.0, INFINITY};
  case EXPONENTIAL: return (struct Bounds){exp(a.low), exp(a.high)};
  case ABSOLUTE: return magnitude(a);
  case LOGISTIC:
  case SECH: return (struct Bounds){0.0, 1.0};
  case SIGN: return (struct Bounds){-1.0, 1.0};
  default: return everything;
  }
}

/* True if the node is the sign of the other one, so that their product is its magnitude. */
static bool is_sign_of(const struct Model *model, Node sign, Node node) {
  const struct Branch *branch = branch_with_mode(&model->switches, sign);
  return branch != NULL && branch->indicator == node;
}

static struct Bounds of_product(const struct Model *model, const struct Vertex *vertex, struct Bounds left,
                                struct Bounds right) {
  if (vertex->left == vertex->right) return multiplied(magnitude(left), magnitude(left));
  if (is_sign_of(model, vertex->left, vertex->right)) return magnitude(right);
  if (is_sign_of(model, vertex->right, vertex->left)) return magnitude(left);
  return multiplied(left, right);
}

/* Returns bounds of the right operand where the left one is positive, else 0. */
static struct Bounds guarded(struct Bounds left, struct Bounds right) {
  if (left.high <= 0.0) return (struct Bounds){0.0, 0.0};
  if (left.low > 0.0) return right;
  return (struct Bounds){smaller(right.low, 0.0), larger(right.high, 0.0)};
}

static struct Bounds of_vertex(const struct Model *model, Node node, const struct Bounds *found) {
  const struct Graph *graph = model->graph;
  const struct Vertex *vertex = &graph->vertices[node];
  if (vertex->operation == CONSTANT) return (struct Bounds){vertex->value, vertex->value};
  if (vertex->operation == SYMBOL) return of_symbol(model, node);
  struct Bounds left = found[cone_slot(graph->cone, vertex->left)];
  if (operation_arity(vertex->operation) == 1) return of_function(vertex->operation, left);
  struct Bounds right = found[cone_slot(graph->cone, vertex->right)];
  switch (vertex->operation) {
  case ADD: return (struct Bounds){left.low + right.low, left.high + right.high};
  case MULTIPLY: return of_product(model, vertex, left, right);
  case POWER: return raised(graph, left, vertex->right);
  case MINIMUM: return (struct Bounds){smaller(left.low, right.low), smaller(left.high, right.high)};
  case MAXIMUM: return (struct Bounds){larger(left.low, right.low), larger(left.high, right.high)};
  case GUARD: return guarded(left, right);
  case UNIFORM:
  case LESS: return (struct Bounds){0.0, 1.0};
  default: return everything;
  }
}

struct Bounds bounds_of(const struct Model *model, Node node, const struct KnownBounds *known, size_t count) {
  struct Cone *cone = model->graph->cone;
  cone_collect(cone, model->graph, &node, 1);
  struct Bounds *found = allocate(cone->count, sizeof *found);
  bool *is_known = allocate(cone->count, sizeof *is_known);
  for (size_t i = 0; i < count; i++) {
    if (!cone_has(cone, known[i].node)) continue;
    found[cone_slot(cone, known[i].node)] = known[i].bounds;
    is_known[cone_slot(cone, known[i].node)] = true;
  }
  for (size_t i = 0; i < cone->count; i++) {
    if (!is_known[i]) found[i] = of_vertex(model, cone->nodes[i], found);
    if (isnan(found[i].low) || isnan(found[i].high)) found[i] = everything;
  }
  struct Bounds bounds = found[cone_slot(cone, node)];
  release(is_known);
  release(found);
  return bounds;
}
