#include "read/expressions/integration_error.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/rounding_bounds.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "mechanics/mass_matrix/pivots.h"
#include "model/model.h"

/* Nodes of each of two parts. */
enum { REFERENCE_NODES = 128 };

static const double golden_section = 0.3819660112501051; /* (3 - sqrt(5))/2 */

/* Kinds of symbols that change during a simulation. */
static const unsigned moving = 1u << COORDINATE | 1u << VELOCITY | 1u << STATE | 1u << DISPLACEMENT |
                               1u << ACCELERATION | 1u << REACTION | 1u << TIME | 1u << INPUT;

struct Rule rule_of(size_t count) {
  struct Rule rule = {.count = count};
  quadrature_rule(count, rule.nodes, rule.weights);
  return rule;
}

bool sampling_varies(const struct Symbol *symbol) {
  return (1u << symbol->kind & (moving | 1u << PARAMETER)) != 0;
}

/* Returns a random number from -1 to 1. */
static double random_number(struct Sampling *sampling) {
  return 2.0 * next_random(&sampling->random) - 2.0;
}

static double scale_of(const struct VariableList *list, size_t index) {
  const struct Variable *variable = index < list->count ? &list->items[index] : NULL;
  if (variable == NULL) return 1.0;
  return variable->nominal > 0.0 ? variable->nominal : fmax(1.0, fabs(variable->start));
}

static double duration_of(const struct Model *model) {
  double start = isnan(model->experiment.start_time) ? 0.0 : model->experiment.start_time;
  return isnan(model->experiment.stop_time) ? 1.0 : model->experiment.stop_time - start;
}

/* Returns the spread of a symbol: a typical distance from its start value. */
static double spread_of(const struct Model *model, const struct Symbol *symbol, double start) {
  size_t index = (size_t)symbol->index;
  switch (symbol->kind) {
  case PARAMETER:
    if (index < model->parameters.count && model->parameters.items[index].type != TYPE_REAL) return 0.0;
    return start == 0.0 ? 1.0 : 0.2 * start; /* a parameter of 0 may hide its term */
  case COORDINATE: return scale_of(&model->coordinates, index);
  case VELOCITY: return scale_of(&model->velocities, index);
  case STATE: return scale_of(&model->states, index);
  case INPUT: return scale_of(&model->inputs, index);
  case TIME: return duration_of(model);
  case ACCELERATION:
  case REACTION: return 1.0;
  default: return 0.0;
  }
}

/* Returns the value of a parameter within its limits; other values stay. */
static double within_limits(const struct Model *model, const struct Symbol *symbol, double value) {
  size_t index = (size_t)symbol->index;
  if (symbol->kind != PARAMETER || index >= model->parameters.count) return value;
  const struct Variable *parameter = &model->parameters.items[index];
  return fmin(fmax(value, parameter->minimum),
              parameter->maximum); /* fmin and fmax ignore NaN, which stands for no limit */
}

double sampling_value(const struct Sampling *sampling, size_t symbol, double spreads) {
  const struct Model *model = sampling->scope->model;
  const struct Symbol *varied = &sampling->scope->graph->symbols[symbol];
  double start = sampling->start[symbol], value = start + spreads * spread_of(model, varied, start);
  bool is_scaled = varied->kind == PARAMETER && start != 0.0;
  if (is_scaled && fabs(spreads) > 1.0) value = spreads > 0.0 ? start * spreads : -start / spreads;
  return within_limits(model, varied, value);
}

static double value_of(struct Sampling *sampling, Node node) {
  const struct Graph *graph = sampling->scope->graph;
  cone_collect(graph->cone, graph, &node, 1);
  graph_evaluate_part(graph, graph->cone->nodes, graph->cone->count, sampling->symbols, sampling->values);
  return sampling->values[node];
}

/* Sets the variables of the enclosing integrals, from the outermost one: to the upper limit, or at random. */
static void place_dummies(struct Sampling *sampling, bool at_end, double share) {
  const struct Scope *scope = sampling->scope;
  for (size_t i = 0; i + 1 < scope->dummy_count; i++) {
    const struct DummyVariable *dummy = &scope->dummies[i];
    double low = value_of(sampling, dummy->low), high = value_of(sampling, dummy->high);
    double position = at_end ? 1.0 : (1.0 + share * random_number(sampling)) / 2.0;
    sampling->symbols[scope->graph->vertices[dummy->symbol].left] = low + (high - low) * position;
  }
}

static void place_symbols(struct Sampling *sampling, double share) {
  const struct Graph *graph = sampling->scope->graph;
  for (size_t i = 0; i < graph->symbol_count; i++) {
    double spreads = share * random_number(sampling);
    bool is_time = graph->symbols[i].kind == TIME;
    sampling->symbols[i] = sampling_value(sampling, i, is_time ? fabs(spreads) : spreads);
  }
}

/*
 * Adds the quadrature over a part of the interval, given by shares from 0 to 1, to the sums and to those of magnitudes.
 */
static void add_part(struct Sampling *sampling, const struct Rule *rule, double from, double to) {
  const struct Scope *scope = sampling->scope;
  const struct Graph *graph = scope->graph;
  const struct DummyVariable *dummy = &scope->dummies[scope->dummy_count - 1];
  cone_collect(graph->cone, graph, sampling->targets, sampling->count);
  for (size_t k = 0; k < rule->count; k++) {
    sampling->symbols[graph->vertices[dummy->symbol].left] = from + (to - from) * rule->nodes[k];
    graph_evaluate_part(graph, graph->cone->nodes, graph->cone->count, sampling->symbols, sampling->values);
    for (size_t j = 0; j < sampling->count; j++) {
      double term = (to - from) * rule->weights[k] * sampling->values[sampling->targets[j]];
      sampling->sums[j] += term;
      sampling->sizes[j] += fabs(term);
    }
  }
  graph_work(graph, rule->count * graph->cone->count / 4);
}

static void clear_sums(struct Sampling *sampling) {
  memset(sampling->sums, 0, sampling->count * sizeof *sampling->sums);
  memset(sampling->sizes, 0, sampling->count * sizeof *sampling->sizes);
}

/*
 * Computes the reference by two parts in the ratio of the golden section, so that no symmetry cancels errors. False if
 * a value is not finite.
 */
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

bool sampling_near(struct Sampling *sampling, double share) {
  bool is_finite = false;
  for (int halvings = 0; halvings < 10 && !is_finite; halvings++, share /= 2.0) {
    place_symbols(sampling, share);
    place_dummies(sampling, false, share);
    is_finite = find_reference(sampling);
  }
  return is_finite;
}

bool sampling_at(struct Sampling *sampling, size_t symbol, double spreads) {
  place_symbols(sampling, 1.0);
  sampling->symbols[symbol] = sampling_value(sampling, symbol, spreads);
  place_dummies(sampling, true, 1.0);
  return find_reference(sampling);
}

double sampling_error(struct Sampling *sampling, const struct Rule *rule, const double *rounding_bounds) {
  double worst = 0.0;
  clear_sums(sampling);
  add_part(sampling, rule, 0.0, 1.0);
  for (size_t j = 0; j < sampling->count; j++) {
    double rounding = rounding_bounds != NULL ? 4.0 * DBL_EPSILON * rounding_bounds[j] : 0.0;
    double error = fabs(sampling->sums[j] - sampling->reference[j]) - rounding;
    double size = fmax(sampling->sizes[j], sampling->reference_size[j]);
    if (size > 0.0 && !(error / size <= worst)) worst = error / size;
  }
  return worst;
}

/* The bound of a sum is the integral of the bounds of its terms. */
double *sampling_rounding_bounds(const struct Sampling *sampling) {
  struct Graph *graph = sampling->scope->graph;
  size_t count = sampling->count;
  Node *bounds = allocate(count, sizeof *bounds);
  rounding_bounds_of(graph, sampling->targets, count, bounds);
  struct Sampling bounded = *sampling;
  bounded.targets = bounds;
  bounded.values = allocate(graph->count, sizeof *bounded.values);
  bounded.sums = allocate(count, sizeof *bounded.sums);
  bounded.sizes = allocate(count, sizeof *bounded.sizes);
  bounded.reference = allocate(count, sizeof *bounded.reference);
  bounded.reference_size = allocate(count, sizeof *bounded.reference_size);
  find_reference(&bounded);
  release(bounded.values);
  return bounded.reference;
}

/* The dummy's symbol stands for the share of the interval. */
struct Sampling sampling_create(struct Scope *scope, Node value) {
  struct Graph *graph = scope->graph;
  const struct DummyVariable *dummy = &scope->dummies[scope->dummy_count - 1];
  Node length = subtract(graph, dummy->high, dummy->low);
  Node position = add(graph, dummy->low, multiply(graph, length, dummy->symbol));
  Node share = multiply(graph, length, substitute_symbol(graph, value, dummy->symbol, position));
  struct Gradient slopes = gradient_by_kinds(graph, share, moving);
  size_t count = slopes.count + 1;
  Node *targets = allocate(count, sizeof *targets);
  targets[0] = share;
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
