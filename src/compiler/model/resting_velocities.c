#include "model/resting_velocities.h"

#include <stdbool.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/node_list.h"
#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"

enum { OF_VELOCITIES = 1u << VELOCITY };

void substitute_in_observers(struct Model *model, const Node *replacements) {
  struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < switches->branch_count; i++)
    substitute(graph, &switches->branches[i].indicator, 1, replacements, &switches->branches[i].indicator);
  for (size_t i = 0; i < switches->event_count; i++)
    for (size_t j = 0; j < switches->events[i].assignment_count; j++) {
      Node *value = &switches->events[i].assignments[j].value;
      substitute(graph, value, 1, replacements, value);
    }
  for (size_t i = 0; i < model->outputs.count; i++)
    substitute(graph, &model->outputs.items[i].node, 1, replacements, &model->outputs.items[i].node);
  for (size_t i = 0; i < model->states.count; i++)
    substitute(graph, &model->states.items[i].rate, 1, replacements, &model->states.items[i].rate);
}

/* Appends a velocity with a new mode, and returns this mode. */
static Node append_resting(struct Model *model, const char *name, struct RestingVelocity resting) {
  struct Switches *switches = &model->switches;
  resting.mode = next_mode(switches, model->graph, format_text("%s.moves", name));
  APPEND(switches->resting, switches->resting_count, resting);
  return resting.mode;
}

Node without_rests(const struct Model *model, Node node) {
  const struct Switches *switches = &model->switches;
  if (switches->resting_count == 0) return node;
  Node *replacements = own_symbols(model->graph);
  for (size_t i = 0; i < switches->resting_count; i++)
    replacements[model->graph->vertices[switches->resting[i].mode].left] = ONE;
  substitute(model->graph, &node, 1, replacements, &node);
  return node;
}

/* --- Velocities of coordinates --- */

/* Collects all that observes the motion: indicators of branches, assignments of events, outputs, rates of states. */
static struct NodeList observers_of(const struct Model *model) {
  const struct Switches *switches = &model->switches;
  struct NodeList observers = {0};
  for (size_t i = 0; i < switches->branch_count; i++) append_node(&observers, switches->branches[i].indicator);
  for (size_t i = 0; i < switches->event_count; i++)
    for (size_t j = 0; j < switches->events[i].assignment_count; j++)
      append_node(&observers, switches->events[i].assignments[j].value);
  for (size_t i = 0; i < model->outputs.count; i++) append_node(&observers, model->outputs.items[i].node);
  for (size_t i = 0; i < model->states.count; i++) append_node(&observers, model->states.items[i].rate);
  return observers;
}

/*
 * Gives each observed velocity a mode that is 1 while the velocity is free, and 0 at rest. Prescribed coordinates have
 * one too: the runtime finds from these which others rest.
 */
static void append_resting_velocities(struct Model *model) {
  struct Graph *graph = model->graph;
  const struct NodeList observers = observers_of(model);
  cone_collect(graph->cone, graph, observers.nodes, observers.count);
  for (size_t i = 0; i < model->velocities.count; i++) {
    const struct Variable *velocity = &model->velocities.items[i];
    bool is_prescribed = model->prescribed.motions[i].is_prescribed;
    if (!is_prescribed && !cone_has(graph->cone, velocity->node)) continue;
    enum RestingKind kind = is_prescribed ? RESTING_PRESCRIBED : RESTING_VELOCITY;
    append_resting(model, velocity->name, (struct RestingVelocity){.kind = kind, .coordinate = i});
  }
}

static void replace_velocities(struct Model *model) {
  const struct Switches *switches = &model->switches;
  struct Graph *graph = model->graph;
  append_resting_velocities(model);
  Node *replacements = own_symbols(graph);
  for (size_t i = 0; i < switches->resting_count; i++) {
    if (switches->resting[i].kind == RESTING_SUM) continue;
    Node velocity = model->velocities.items[switches->resting[i].coordinate].node;
    replacements[graph->vertices[velocity].left] = function(graph, GUARD, switches->resting[i].mode, velocity);
  }
  substitute_in_observers(model, replacements);
}

/* --- Other velocities, such as v - vBelt --- */

/* If value is c f plus a term without velocities, sets *rest to that term, the value at f = 0; else returns false. */
static bool is_along(struct Graph *graph, Node value, Node f, Node *rest) {
  const struct Gradient by = gradient_by_kinds(graph, f, OF_VELOCITIES),
                        of = gradient_by_kinds(graph, value, OF_VELOCITIES);
  bool are_same = of.count == by.count && of.count > 0;
  for (size_t i = 0; i < of.count && are_same; i++) are_same = of.symbols[i] == by.symbols[i];
  if (!are_same) return false;
  Node ratio = divide(graph, of.values[0], by.values[0]);
  *rest = simplify_fraction(graph, subtract(graph, value, multiply(graph, ratio, f)));
  return !graph_depends_on(graph, *rest, VELOCITY);
}

/* A friction along another velocity than that of a coordinate may stick to a body that moves. */
static void replace_in_indicators(struct Model *model) {
  struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    const struct Friction *friction = &switches->frictions[i];
    for (size_t j = 0; j < switches->branch_count && !friction->is_given; j++) {
      Node *indicator = &switches->branches[j].indicator, is_free = power_number(graph, friction->reported, 2.0), rest;
      if (is_along(graph, *indicator, friction->velocity, &rest))
        *indicator = choose_node(graph, is_free, *indicator, rest);
    }
  }
}

/* --- Sums of velocities in indicators, such as w1 - w3 --- */

/*
 * Returns the sum of several velocities from which the value differs by a term without velocities. The coefficients
 * do not depend on velocities; ZERO if the value is not such a sum.
 */
static Node sum_of_velocities(struct Graph *graph, Node value) {
  if (graph_depends_on(graph, value, ACCELERATION)) return ZERO;
  const struct Gradient gradient = gradient_by_kinds(graph, value, OF_VELOCITIES);
  Node sum = ZERO;
  for (size_t i = 0; i < gradient.count; i++) {
    if (gradient.count == 1 || graph_depends_on(graph, gradient.values[i], VELOCITY)) return ZERO;
    sum = add(graph, sum, multiply(graph, gradient.values[i], gradient.symbols[i]));
  }
  return sum;
}

/* Returns the mode of a sum of velocities; adds it if there is none. */
static Node mode_of_sum(struct Model *model, Node sum, const char *name) {
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < switches->resting_count; i++)
    if (switches->resting[i].kind == RESTING_SUM && switches->resting[i].sum == sum) return switches->resting[i].mode;
  return append_resting(model, name, (struct RestingVelocity){.kind = RESTING_SUM, .sum = sum});
}

/* Returns the value without the velocities of a sum while they rest; the value itself if it has none. */
static Node with_resting_sum(struct Model *model, Node value, const char *name) {
  struct Graph *graph = model->graph;
  Node sum = sum_of_velocities(graph, value), rest;
  if (sum == ZERO) return value;
  Node *without = own_symbols(graph);
  for (size_t i = 0; i < model->velocities.count; i++)
    without[graph->vertices[model->velocities.items[i].node].left] = ZERO;
  substitute(graph, &value, 1, without, &rest);
  return choose_node(graph, mode_of_sum(model, sum, name), value, rest);
}

/* Replaces the sum by whose sign an operation decides. */
static bool replace_deciding_sum(void *context, enum Operation operation, Node left, Node right, Node *result) {
  struct Model *model = context;
  bool compares = operation == LESS, decides = operation == SIGN || operation == ABSOLUTE || operation == FLOOR;
  if (!compares && !decides) return false;
  Node value = compares ? subtract(model->graph, right, left) : left;
  Node replaced = with_resting_sum(model, value, "a sum of velocities");
  if (replaced == value) return false;
  *result = function(model->graph, operation, compares ? ZERO : replaced, compares ? replaced : ZERO);
  return true;
}

/*
 * Frictions and constraints may keep a sum of moving velocities at 0. Replaces such sums in the indicators of branches,
 * and where outputs and assignments decide without branches.
 */
static void replace_sums(struct Model *model) {
  struct Switches *switches = &model->switches;
  const struct Rebuilding rebuilding = {model->graph, model, replace_deciding_sum};
  for (size_t i = 0; i < switches->branch_count; i++) {
    struct Branch *branch = &switches->branches[i];
    const char *name = graph_symbol_of(model->graph, branch->mode)->name;
    branch->indicator = with_resting_sum(model, branch->indicator, name);
  }
  for (size_t i = 0; i < switches->event_count; i++)
    for (size_t j = 0; j < switches->events[i].assignment_count; j++) {
      Node *value = &switches->events[i].assignments[j].value;
      *value = rebuild(&rebuilding, *value);
    }
  for (size_t i = 0; i < model->outputs.count; i++)
    model->outputs.items[i].node = rebuild(&rebuilding, model->outputs.items[i].node);
}

void replace_resting_velocities(struct Model *model) {
  if (model->switches.friction_count + model->switches.contact_count == 0) return;
  replace_in_indicators(model);
  replace_sums(model);
  replace_velocities(model);
}
