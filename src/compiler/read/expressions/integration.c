/*
 * An integral is replaced by Gauss-Legendre quadrature with n nodes x[k] and weights w[k] on the unit interval,
 *
 *   integral from a to b of f(s) ds  ~  (b - a) sum over k of w[k] f(a + (b - a) x[k]).
 *
 * It is exact for polynomials of degree 2 n - 1 and converges geometrically for analytic f. The equations of motion
 * contain an ordinary sum, which is differentiated exactly.
 *
 * n is the smallest number that passes a test at the start values and at SAMPLES - 1 random states. The test compares
 * f, and its derivatives with respect to the moving symbols, with a reference: by n and by n + 1 nodes, the error must
 * be below 1e-13 of the integral of the magnitude. The reference has REFERENCE_NODES nodes in each of two parts,
 * divided by the golden section so that no errors cancel by symmetry. A state that fails with CHOICE_LIMIT nodes is tested
 * again with an allowance for rounding errors; if it fails again, the integral gets a warning. A state costs at most
 * about CHOICE_LIMIT^2 evaluations of f and its derivatives, plus the reference.
 *
 * P. J. Davis, P. Rabinowitz, Methods of Numerical Integration, 2nd edition, 1984, chapters 2 and 4.
 */
#include "read/expressions/integration.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/roundings.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "mechanics/mass_matrix/pivots.h"
#include "model/model.h"
#include "read/names/pieces_of_functions.h"

/* Largest number of nodes that lagc chooses, nodes in each part of the reference, and states that are tested. */
enum { CHOICE_LIMIT = 32, REFERENCE_NODES = 64, SAMPLES = 6 };

/* Relative accuracy of integrals: some 450 roundings, well below the tolerances of solvers. */
static const double exactness = 1e-13;
static const double golden_section = 0.3819660112501051; /* smaller part of the unit interval */

/* Kinds of symbols that vary along a motion other than time and inputs. */
static const unsigned moving =
    1u << COORDINATE | 1u << VELOCITY | 1u << STATE | 1u << DISPLACEMENT | 1u << ACCELERATION | 1u << REACTION;

struct Rule {
  size_t count;
  double nodes[QUADRATURE_LIMIT], weights[QUADRATURE_LIMIT];
};

struct Sampling {
  const struct Scope *scope;
  const Node *targets;
  size_t count;
  double *start, *symbols, *values;   /* per symbol: start value and present value; per node: present value */
  double *sums, *sizes;               /* one per target: quadrature of its value, and of its magnitude */
  double *reference, *reference_size; /* the same by the reference rule */
  uint64_t random;
};

Node replaced(struct Graph *graph, Node node, Node symbol, Node by) {
  Node *replacements = own_symbols(graph), result = ZERO;
  replacements[graph->vertices[symbol].left] = by;
  substitute(graph, &node, 1, replacements, &result);
  release(replacements);
  return result;
}

/* Returns a random number between -1 and 1; next_random() is between 0.5 and 1.5. */
static double random_number(struct Sampling *sampling) {
  return 2.0 * next_random(&sampling->random) - 2.0;
}

static double scale_of(const struct VariableList *list, size_t index) {
  const struct Variable *variable = index < list->count ? &list->items[index] : NULL;
  if (variable == NULL) return 1.0;
  return variable->nominal > 0.0 ? variable->nominal : fmax(1.0, fabs(variable->start));
}

/* Returns the largest deviation of a symbol from its start value in a sample. */
static double spread_of(const struct Model *model, const struct Symbol *symbol, double start) {
  size_t index = (size_t)symbol->index;
  switch (symbol->kind) {
  case PARAMETER:
    if (index < model->parameters.count && model->parameters.items[index].type != TYPE_REAL) return 0.0;
    return start == 0.0 ? 1.0 : 0.2 * start; /* a parameter that is 0 would hide the term that it multiplies */
  case COORDINATE: return scale_of(&model->coordinates, index);
  case VELOCITY: return scale_of(&model->velocities, index);
  case STATE: return scale_of(&model->states, index);
  case INPUT: return scale_of(&model->inputs, index);
  case TIME:
  case ACCELERATION:
  case REACTION: return 1.0;
  default: return 0.0;
  }
}

/* Restricts a parameter to its range; other values are unchanged. */
static double within_limits(const struct Model *model, const struct Symbol *symbol, double value) {
  size_t index = (size_t)symbol->index;
  if (symbol->kind != PARAMETER || index >= model->parameters.count) return value;
  const struct Variable *parameter = &model->parameters.items[index];
  return fmin(fmax(value, parameter->minimum), parameter->maximum); /* fmin and fmax ignore NaN, which means no limit */
}

static double value_of(struct Sampling *sampling, Node node) {
  const struct Graph *graph = sampling->scope->graph;
  cone_collect(graph->cone, graph, &node, 1);
  graph_evaluate_part(graph, graph->cone->nodes, graph->cone->count, sampling->symbols, sampling->values);
  return sampling->values[node];
}

/*
 * Sets the values of all symbols: start values for share = 0, random values around them else. Enclosing dummies get
 * values in their intervals.
 */
static void choose_state(struct Sampling *sampling, double share) {
  const struct Scope *scope = sampling->scope;
  const struct Graph *graph = scope->graph;
  for (size_t i = 0; i < graph->symbol_count; i++) {
    const struct Symbol *symbol = &graph->symbols[i];
    double start = sampling->start[i], spread = spread_of(scope->model, symbol, start);
    sampling->symbols[i] = within_limits(scope->model, symbol, start + share * random_number(sampling) * spread);
  }
  for (size_t i = 0; i + 1 < scope->dummy_count; i++) {
    const struct Dummy *dummy = &scope->dummies[i];
    double low = value_of(sampling, dummy->low), high = value_of(sampling, dummy->high);
    sampling->symbols[graph->vertices[dummy->symbol].left] =
        low + (high - low) * (1.0 + share * random_number(sampling)) / 2.0;
  }
}

/* Adds the quadrature over a part of the interval, from and to as fractions of it, to the sums. */
static void add_part(struct Sampling *sampling, const struct Rule *rule, double from, double to) {
  const struct Scope *scope = sampling->scope;
  const struct Graph *graph = scope->graph;
  const struct Dummy *dummy = &scope->dummies[scope->dummy_count - 1];
  double low = value_of(sampling, dummy->low), high = value_of(sampling, dummy->high);
  cone_collect(graph->cone, graph, sampling->targets, sampling->count);
  for (size_t k = 0; k < rule->count; k++) {
    double share = from + (to - from) * rule->nodes[k];
    sampling->symbols[graph->vertices[dummy->symbol].left] = low + (high - low) * share;
    graph_evaluate_part(graph, graph->cone->nodes, graph->cone->count, sampling->symbols, sampling->values);
    for (size_t j = 0; j < sampling->count; j++) {
      double term = (to - from) * rule->weights[k] * sampling->values[sampling->targets[j]];
      sampling->sums[j] += term;
      sampling->sizes[j] += fabs(term);
    }
  }
  graph_work(graph, rule->count * graph->cone->count);
}

static struct Rule rule_of(size_t count) {
  struct Rule rule = {.count = count};
  quadrature_rule(count, rule.nodes, rule.weights);
  return rule;
}

static void clear_sums(struct Sampling *sampling) {
  memset(sampling->sums, 0, sampling->count * sizeof *sampling->sums);
  memset(sampling->sizes, 0, sampling->count * sizeof *sampling->sizes);
}

/* Computes the reference. Returns false if a value is not finite. */
static bool find_reference(struct Sampling *sampling) {
  const struct Rule rule = rule_of(REFERENCE_NODES);
  bool is_finite = true;
  clear_sums(sampling);
  add_part(sampling, &rule, 0.0, golden_section);
  add_part(sampling, &rule, golden_section, 1.0);
  for (size_t j = 0; j < sampling->count; j++) {
    sampling->reference[j] = sampling->sums[j];
    sampling->reference_size[j] = sampling->sizes[j];
    is_finite &= isfinite(sampling->sums[j]);
  }
  return is_finite;
}

/*
 * Returns the largest error of the targets by this number of nodes, beyond the rounding error bound, relative to the
 * integral of the magnitude.
 */
static double error_of(struct Sampling *sampling, const double *roundings, size_t nodes) {
  const struct Rule rule = rule_of(nodes);
  double worst = 0.0;
  clear_sums(sampling);
  add_part(sampling, &rule, 0.0, 1.0);
  for (size_t j = 0; j < sampling->count; j++) {
    double error = fabs(sampling->sums[j] - sampling->reference[j]) - 4.0 * DBL_EPSILON * roundings[j];
    double size = fmax(sampling->sizes[j], sampling->reference_size[j]);
    if (size > 0.0 && !(error / size <= worst)) worst = error / size;
  }
  return worst;
}

/* Returns a rounding error bound for each target, in units of DBL_EPSILON: the integral of the integrand's bound. */
static double *roundings_in(const struct Sampling *sampling) {
  struct Graph *graph = sampling->scope->graph;
  Node *bounds = allocate(sampling->count, sizeof *bounds);
  roundings_of(graph, sampling->targets, sampling->count, bounds);
  struct Sampling bounded = *sampling;
  bounded.targets = bounds;
  bounded.values = allocate(graph->count, sizeof *bounded.values);
  bounded.sums = allocate(sampling->count, sizeof *bounded.sums);
  bounded.sizes = allocate(sampling->count, sizeof *bounded.sizes);
  bounded.reference = allocate(sampling->count, sizeof *bounded.reference);
  bounded.reference_size = allocate(sampling->count, sizeof *bounded.reference_size);
  find_reference(&bounded);
  return bounded.reference;
}

/*
 * Returns the number of nodes that the present state needs, at least `nodes`, and sets the remaining error. The second
 * attempt allows for rounding errors.
 */
static size_t nodes_at(struct Sampling *sampling, size_t nodes, double *error) {
  double *roundings = allocate(sampling->count, sizeof *roundings);
  size_t first = nodes;
  for (int attempt = 0; attempt < 2; attempt++) {
    *error = error_of(sampling, roundings, nodes);
    while (nodes < CHOICE_LIMIT && !(*error <= exactness && error_of(sampling, roundings, nodes + 1) <= exactness))
      *error = error_of(sampling, roundings, ++nodes);
    if (*error <= exactness || attempt == 1) break;
    roundings = roundings_in(sampling);
    nodes = first;
  }
  return nodes;
}

static bool find_state(struct Sampling *sampling, double share) {
  bool is_finite = false;
  for (int halvings = 0; halvings < 10 && !is_finite; halvings++, share /= 2.0) {
    choose_state(sampling, share);
    is_finite = find_reference(sampling);
  }
  return is_finite;
}

/* Prepares to sample the integrand and its derivatives with respect to the moving symbols. */
static struct Sampling sampling_of(struct Scope *scope, Node value) {
  struct Graph *graph = scope->graph;
  struct Gradient slopes = gradient_by_kinds(graph, value, moving);
  size_t count = slopes.count + 1;
  Node *targets = allocate(count, sizeof *targets);
  targets[0] = value;
  for (size_t i = 0; i < slopes.count; i++) targets[i + 1] = slopes.values[i];
  return (struct Sampling){.scope = scope,
                           .targets = targets,
                           .count = count,
                           .start = start_values(scope->model),
                           .symbols = allocate(graph->symbol_count, sizeof(double)),
                           .values = allocate(graph->count, sizeof(double)),
                           .sums = allocate(count, sizeof(double)),
                           .sizes = allocate(count, sizeof(double)),
                           .reference = allocate(count, sizeof(double)),
                           .reference_size = allocate(count, sizeof(double))};
}

/* True for the first message about an integral on its line. Some expressions are parsed twice, as those of outputs. */
static bool is_new(struct Parser *parser, const struct Integral *integral) {
  struct Scope *scope = parser->scope;
  char *key = format_text("%s:%ld:%s", scope->diagnostics->file, current_line(parser), integral->text);
  if (names_find(scope->noted_integrals, key) != NULL) return false;
  names_set(scope->noted_integrals, key, key);
  return true;
}

static size_t choose_nodes(struct Parser *parser, const struct Integral *integral) {
  const struct Diagnostics *diagnostics = parser->scope->diagnostics;
  struct Sampling sampling = sampling_of(parser->scope, integral->value);
  size_t nodes = 1;
  double worst = 0.0;
  bool has_value = false;
  for (int sample = 0; sample < SAMPLES; sample++) {
    double error = 0.0;
    if (!find_state(&sampling, sample == 0 ? 0.0 : 1.0)) continue;
    has_value = true;
    nodes = nodes_at(&sampling, nodes, &error);
    worst = fmax(worst, error);
  }
  if (!has_value)
    FAIL(parser, "%s: %s has no finite value; expected one at the start values and near them", parser->place.what,
         integral->text);
  else if (!is_new(parser, integral)) return nodes;
  else if (worst > exactness)
    report_warning(diagnostics, current_line(parser),
                   "%s has a relative error of %.1g by %zu nodes; expected an integrand that neither oscillates nor "
                   "has kinks and poles, "
                   "in parts where it does, or a number of nodes as a fifth argument",
                   integral->text, worst, nodes);
  else
    report_note(diagnostics, current_line(parser), "%s is exact to 1e-13 by %zu node%s near the start values",
                integral->text, nodes, nodes == 1 ? "" : "s");
  return nodes;
}

/* Returns the weighted sum over the nodes for an expression of the dummy. */
static Node sum_over(struct Parser *parser, const struct Rule *rule, Node value) {
  struct Graph *graph = parser->graph;
  const struct Dummy dummy = parser->scope->dummies[parser->scope->dummy_count - 1];
  Node length = subtract(graph, dummy.high, dummy.low), sum = ZERO;
  for (size_t k = 0; k < rule->count && graph_limit(graph) == NULL; k++) {
    Node point = add(graph, dummy.low, scale(graph, rule->nodes[k], length));
    Node term = with_pieces(parser->scope, replaced(graph, value, dummy.symbol, point), current_line(parser));
    sum = add(graph, sum, scale(graph, rule->weights[k], term));
  }
  return multiply(graph, length, sum);
}

/* True if a node with these derivatives is quadratic in the moving symbols. Sets its second derivatives. */
static bool is_quadratic(struct Graph *graph, const struct Gradient *slopes, struct Gradient *curvatures) {
  for (size_t i = 0; i < slopes->count; i++) {
    curvatures[i] = gradient_by_kinds(graph, slopes->values[i], moving);
    for (size_t j = 0; j < curvatures[i].count; j++)
      if ((graph->vertices[curvatures[i].values[j]].kinds & moving) != 0) return false;
  }
  return true;
}

static Node at_rest(struct Graph *graph, Node node) {
  Node *replacements = own_symbols(graph), result = ZERO;
  for (size_t i = 0; i < graph->symbol_count; i++)
    if ((1u << graph->symbols[i].kind & moving) != 0) replacements[i] = ZERO;
  substitute(graph, &node, 1, replacements, &result);
  release(replacements);
  return result;
}

/*
 * Integrates the coefficients of an expression that is quadratic in the moving symbols. They are constants, like masses
 * and stiffnesses that are given as numbers.
 */
static Node sum_of_quadratic(struct Parser *parser, const struct Rule *rule, Node value, const struct Gradient *slopes,
                             const struct Gradient *curvatures) {
  struct Graph *graph = parser->graph;
  Node sum = sum_over(parser, rule, at_rest(graph, value));
  for (size_t i = 0; i < slopes->count; i++) {
    Node slope = sum_over(parser, rule, at_rest(graph, slopes->values[i]));
    sum = add(graph, sum, multiply(graph, slopes->symbols[i], slope));
    for (size_t j = 0; j < curvatures[i].count; j++) {
      Node half = scale(graph, 0.5, sum_over(parser, rule, curvatures[i].values[j]));
      Node square = multiply(graph, slopes->symbols[i], curvatures[i].symbols[j]);
      sum = add(graph, sum, multiply(graph, square, half));
    }
  }
  return sum;
}

Node integrate(struct Parser *parser, const struct Integral *integral) {
  struct Graph *graph = parser->graph;
  const struct Dummy dummy = parser->scope->dummies[parser->scope->dummy_count - 1];
  const struct Rule rule = rule_of(integral->given > 0 ? integral->given : choose_nodes(parser, integral));
  unsigned kinds = graph->vertices[dummy.low].kinds | graph->vertices[dummy.high].kinds;
  if (parser->failed) return ZERO;
  struct Gradient slopes = gradient_by_kinds(graph, integral->value, moving);
  struct Gradient *curvatures = allocate(slopes.count, sizeof *curvatures);
  if ((kinds & moving) == 0 && slopes.count > 0 && is_quadratic(graph, &slopes, curvatures))
    return sum_of_quadratic(parser, &rule, integral->value, &slopes, curvatures);
  return sum_over(parser, &rule, integral->value);
}
