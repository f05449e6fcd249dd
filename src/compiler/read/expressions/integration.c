/*
 * Quadrature with a chosen number of nodes. The integral of f over s from a to b becomes
 *
 *   (b - a) sum over i of w_i f(a + (b - a) s_i),
 *
 * with Gauss-Legendre nodes s_i and weights w_i in (0, 1) (algebra/quadrature.h). The number of nodes is the
 * smallest for which this sum and its derivatives by the moving symbols agree with a rule of many nodes. The bound
 * is 1e-13 of the integral of their magnitude. The comparison is at the start values, and at SAMPLES random states
 * around them. The search ends at CHOICE_LIMIT nodes. Then a search finds how far each variable may move from its
 * start value. Outside of this range the sum is divided by 0, so that the FMU stops in place of returning a wrong
 * result.
 */
#include "read/expressions/integration.h"

#include <math.h>
#include <string.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/expressions/integration_error.h"
#include "names/piecewise_functions.h"

/* Largest number of nodes that lagc chooses, the same for limits that move, and the number of sample states. */
enum { CHOICE_LIMIT = 32, MOVING_CHOICE_LIMIT = 128, SAMPLES = 6 };

/*
 * Distances from the start value, in spreads: of the states that choose nodes, of a range without limit, and of the
 * first trial.
 */
static const double wide = 4.0, endless = 1e6, nearest = 1e-3;

/* Errors relative to the integral of the magnitude: of an exact sum, and the largest one in the range of a variable. */
static const double exactness = 1e-13, still_right = 1e-11;

/* Kinds of symbols that the motion determines. */
static const unsigned moving =
    1u << COORDINATE | 1u << VELOCITY | 1u << STATE | 1u << DISPLACEMENT | 1u << ACCELERATION | 1u << REACTION;

/* The interval of a symbol in which the sum is exact. */
struct ExactRange {
  size_t symbol;
  double low, high;
};

/* A quadrature rule for an integral, and the ranges in which it holds. */
struct QuadratureChoice {
  size_t nodes;
  double worst; /* error, relative to the integral of the magnitude */
  bool is_near; /* the nodes suffice only near the start values */
  struct ExactRange *ranges;
  size_t range_count;
  bool has_value;
};

static double error_by(struct Sampling *sampling, const double *rounding_bounds, size_t nodes) {
  const struct Rule rule = rule_of(nodes);
  return sampling_error(sampling, &rule, rounding_bounds);
}

/*
 * Returns the number of nodes, at least nodes, for the present sample state. Sets the error, which is larger at the
 * limit.
 */
static size_t nodes_at(struct Sampling *sampling, size_t nodes, size_t limit, double *error) {
  double *rounding_bounds = NULL;
  size_t first = nodes;
  for (int attempt = 0; attempt < 2; attempt++) {
    *error = error_by(sampling, rounding_bounds, nodes);
    while (nodes < limit && !(*error <= exactness && error_by(sampling, rounding_bounds, nodes + 1) <= exactness))
      *error = error_by(sampling, rounding_bounds, nodes += nodes < CHOICE_LIMIT ? 1 : 4);
    if (*error <= exactness || attempt == 1) break;
    rounding_bounds = sampling_rounding_bounds(sampling);
    nodes = first;
  }
  release(rounding_bounds);
  return nodes;
}

/* Chooses nodes for the start values and for random states within a number of spreads around them. */
static struct QuadratureChoice choose_within(struct Sampling *sampling, double spreads, size_t limit) {
  struct QuadratureChoice choice = {.nodes = 1};
  for (int sample = 0; sample < SAMPLES; sample++) {
    double error = 0.0;
    if (!sampling_near(sampling, sample == 0 ? 0.0 : spreads)) continue;
    choice.has_value = true;
    choice.nodes = nodes_at(sampling, choice.nodes, limit, &error);
    choice.worst = fmax(choice.worst, error);
  }
  return choice;
}

/* True if the rule holds with one symbol at a number of spreads from its start value, and the others near theirs. */
static bool is_right_at(struct Sampling *sampling, const struct Rule *rule, size_t symbol, double spreads) {
  if (!sampling_at(sampling, symbol, spreads)) return false;
  return sampling_error(sampling, rule, NULL) <= still_right;
}

/*
 * Returns the largest number of spreads of a symbol in one direction at which the rule holds, or INFINITY. Distances
 * grow by factors of 4, since an integrand that decays to 0 far away makes any rule look exact there; bisection then
 * refines.
 */
static double range_towards(struct Sampling *sampling, const struct Rule *rule, size_t symbol, double direction) {
  double right = nearest, wrong = nearest;
  while (wrong < endless && is_right_at(sampling, rule, symbol, direction * wrong)) {
    right = wrong;
    wrong *= 4.0;
  }
  if (wrong >= endless) return INFINITY;
  while (wrong / right > 1.1) {
    double middle = sqrt(right * wrong);
    bool is_right = is_right_at(sampling, rule, symbol, direction * middle);
    *(is_right ? &right : &wrong) = middle;
  }
  return right;
}

/* Returns the value of a symbol at the end of its range. */
static double end_of(const struct Sampling *sampling, size_t symbol, double spreads, double direction) {
  double start = sampling->start[symbol];
  bool goes_down = sampling->scope->graph->symbols[symbol].kind == PARAMETER && start < 0.0;
  if (isinf(spreads)) return goes_down ? -direction * INFINITY : direction * INFINITY;
  return sampling_value(sampling, symbol, direction * spreads);
}

/* True if a node is a polynomial of its operands. */
static bool is_polynomial(const struct Graph *graph, const struct Vertex *vertex) {
  if (vertex->operation != POWER) return vertex->operation == ADD || vertex->operation == MULTIPLY;
  double exponent = graph_is_constant(graph, vertex->right) ? graph_value(graph, vertex->right) : -1.0;
  return exponent >= 0.0 && exponent == floor(exponent);
}

/*
 * Marks the nodes in which the integrand is not a polynomial. For polynomials a rule that is exact at a few values is
 * exact at all.
 */
static bool *mark_curved(const struct Graph *graph, Node integrand) {
  bool *is_curved = allocate(graph->count, sizeof *is_curved);
  struct Cone *cone = graph->cone;
  cone_collect(cone, graph, &integrand, 1);
  for (size_t index = cone->count; index-- > 0;) {
    const struct Vertex *vertex = &graph->vertices[cone->nodes[index]];
    bool bends = is_curved[cone->nodes[index]] || !is_polynomial(graph, vertex);
    int arity = operation_arity(vertex->operation);
    if (arity > 0) is_curved[vertex->left] |= bends;
    if (arity > 1) is_curved[vertex->right] |= bends;
  }
  return is_curved;
}

static void find_ranges(struct Sampling *sampling, const struct Rule *rule, struct QuadratureChoice *choice) {
  const struct Graph *graph = sampling->scope->graph;
  bool *is_curved = mark_curved(graph, sampling->targets[0]);
  for (size_t i = 0; i < graph->symbol_count; i++) {
    if (!is_curved[graph->symbols[i].node] || !sampling_varies(&graph->symbols[i])) continue;
    double forth = end_of(sampling, i, range_towards(sampling, rule, i, 1.0), 1.0);
    double back =
        graph->symbols[i].kind == TIME ? -INFINITY : end_of(sampling, i, range_towards(sampling, rule, i, -1.0), -1.0);
    if (isinf(forth) && isinf(back)) continue;
    APPEND(choice->ranges, choice->range_count, (struct ExactRange){i, fmin(back, forth), fmax(back, forth)});
  }
  release(is_curved);
}

/*
 * Chooses nodes and ranges. If no number of nodes suffices for random states, limits that move get a range about the
 * start.
 */
static struct QuadratureChoice choose(struct Sampling *sampling, bool limits_move) {
  size_t limit = limits_move ? MOVING_CHOICE_LIMIT : CHOICE_LIMIT;
  struct QuadratureChoice choice = choose_within(sampling, wide, limit);
  if (!choice.has_value || choice.worst > exactness) choice = choose_within(sampling, 1.0, limit);
  if (choice.worst > exactness && limits_move) {
    choice = choose_within(sampling, 0.0, limit);
    choice.nodes = limit;
    choice.is_near = true;
  }
  const struct Rule rule = rule_of(choice.nodes);
  if (choice.has_value && choice.worst <= exactness) find_ranges(sampling, &rule, &choice);
  return choice;
}

/* True the first time that an integral is named in its line; outputs, for example, are read twice. */
static bool is_new(struct Parser *parser, const struct Integral *integral) {
  struct Scope *scope = parser->scope;
  char *key = format_text("%s:%ld:%s", scope->diagnostics->file, current_line(parser), integral->text);
  if (names_find(scope->noted_integrals, key) != NULL) return false;
  names_set(scope->noted_integrals, key, key);
  return true;
}

/* "for x from -4 to 5 and time up to 30, beyond which the FMU stops" */
static char *text_of_ranges(const struct Graph *graph, const struct QuadratureChoice *choice) {
  char *text = copy_text("");
  for (size_t i = 0; i < choice->range_count; i++) {
    const struct ExactRange *range = &choice->ranges[i];
    const char *name = graph->symbols[range->symbol].name, *joint = i == 0 ? "" : " and ";
    if (isinf(range->low)) text = format_text("%s%s%s up to %.3g", text, joint, name, range->high);
    else if (isinf(range->high)) text = format_text("%s%s%s down to %.3g", text, joint, name, range->low);
    else text = format_text("%s%s%s from %.3g to %.3g", text, joint, name, range->low, range->high);
  }
  return text;
}

static void report_choice(struct Parser *parser, const struct Integral *integral,
                          const struct QuadratureChoice *choice) {
  const struct Diagnostics *diagnostics = parser->scope->diagnostics;
  long line = current_line(parser);
  const char *plural = choice->nodes == 1 ? "" : "s", *ranges = text_of_ranges(parser->graph, choice);
  if (choice->worst > exactness)
    report_warning(diagnostics, line,
                   "%s has a relative error of %.1g by %zu nodes; expected an integrand that neither oscillates nor "
                   "has kinks and poles, in parts where it does, or a number of nodes as a fifth argument",
                   integral->text, choice->worst, choice->nodes);
  else if (choice->is_near && choice->range_count > 0)
    report_warning(diagnostics, line,
                   "%s needs more than %zu nodes; it is right for %s alone, beyond which the FMU stops; expected a "
                   "<state> with the integrand as its rate, or a number of nodes as a fifth argument",
                   integral->text, choice->nodes, ranges);
  else if (choice->range_count > 0)
    report_note(diagnostics, line, "%s is exact to 1e-13 by %zu node%s for %s, beyond which the FMU stops",
                integral->text, choice->nodes, plural, ranges);
  else
    report_note(diagnostics, line, "%s is exact to 1e-13 by %zu node%s near the start values", integral->text,
                choice->nodes, plural);
}

static struct QuadratureChoice choose_nodes(struct Parser *parser, const struct Integral *integral, bool limits_move) {
  struct Sampling sampling = sampling_create(parser->scope, integral->value);
  struct QuadratureChoice choice = choose(&sampling, limits_move);
  if (!choice.has_value)
    FAIL(parser, "%s: %s is not finite at or near the start values; expected an integrand that is finite there",
         parser->location.what, integral->text);
  else if (is_new(parser, integral)) report_choice(parser, integral, &choice);
  return choice;
}

/* Returns a node that is 1 where another one is positive, else 0. */
static Node step_function(struct Graph *graph, Node node) {
  return function(graph, GUARD, function(graph, SIGN, node, ZERO), ONE);
}

/* Returns the sum, divided by 0 beyond the ranges. */
static Node within_ranges(struct Graph *graph, const struct QuadratureChoice *choice, Node sum) {
  Node inside = ONE;
  for (size_t i = 0; i < choice->range_count; i++) {
    const struct ExactRange *range = &choice->ranges[i];
    Node symbol = graph->symbols[range->symbol].node;
    if (!isinf(range->high)) {
      Node high = graph_constant(graph, range->high);
      inside = multiply(graph, inside, step_function(graph, subtract(graph, high, symbol)));
    }
    if (!isinf(range->low)) {
      Node low = graph_constant(graph, range->low);
      inside = multiply(graph, inside, step_function(graph, subtract(graph, symbol, low)));
    }
  }
  return divide(graph, sum, inside);
}

/* Returns the quadrature sum of an expression of the dummy. */
static Node sum_over(struct Parser *parser, const struct Rule *rule, Node value) {
  struct Graph *graph = parser->graph;
  const struct DummyVariable dummy = parser->scope->dummies[parser->scope->dummy_count - 1];
  Node length = subtract(graph, dummy.high, dummy.low), sum = ZERO;
  for (size_t k = 0; k < rule->count && graph_limit(graph) == NULL; k++) {
    Node point = add(graph, dummy.low, scale(graph, rule->nodes[k], length));
    Node term = with_modes(parser->scope, substitute_symbol(graph, value, dummy.symbol, point), current_line(parser));
    sum = add(graph, sum, scale(graph, rule->weights[k], term));
  }
  return multiply(graph, length, sum);
}

/* True if the node is a polynomial of second degree in the moving symbols, whose second derivatives are constants. */
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
 * Returns the sum for an integrand that is quadratic in the moving symbols. Only its coefficients are integrated: they
 * are constants, such as masses and stiffnesses.
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
  const struct DummyVariable dummy = parser->scope->dummies[parser->scope->dummy_count - 1];
  unsigned kinds = graph->vertices[dummy.low].kinds | graph->vertices[dummy.high].kinds;
  bool limits_move = (kinds & (moving | 1u << TIME | 1u << INPUT | 1u << DUMMY)) != 0;
  struct QuadratureChoice choice = {.nodes = integral->given};
  if (integral->given == 0) choice = choose_nodes(parser, integral, limits_move);
  if (parser->failed) return ZERO;
  const struct Rule rule = rule_of(choice.nodes);
  struct Gradient slopes = gradient_by_kinds(graph, integral->value, moving);
  struct Gradient *curvatures = allocate(slopes.count, sizeof *curvatures);
  bool is_short = (kinds & moving) == 0 && slopes.count > 0 && is_quadratic(graph, &slopes, curvatures);
  Node sum = is_short ? sum_of_quadratic(parser, &rule, integral->value, &slopes, curvatures)
                      : sum_over(parser, &rule, integral->value);
  return within_ranges(graph, &choice, sum);
}
