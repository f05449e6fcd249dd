#include "model/sticking_velocities.h"

#include <stdbool.h>

#include "algebra/differentiate.h"
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

/* Returns an expression that is positive unless the velocity of the friction is kept at 0. */
static Node is_free(struct Graph *graph, const struct Friction *friction) {
  return power_number(graph, friction->reported, 2.0);
}

/* Returns the same for a velocity that depends on it by a coefficient; a coefficient of 0 leaves the velocity free. */
static Node is_coupled_free(struct Graph *graph, Node is_free, Node coefficient) {
  Node sign = function(graph, SIGN, coefficient, ZERO);
  return add(graph, is_free, subtract(graph, ONE, power_number(graph, sign, 2.0)));
}

/* --- Velocities of coordinates --- */

/*
 * If the friction acts along c v, with a single velocity v, returns the index of v and its coefficient c. Else returns
 * the number of coordinates.
 */
static size_t coordinate_of(const struct Model *model, const struct Friction *friction, Node *coefficient) {
  struct Graph *graph = model->graph;
  const struct Gradient gradient = gradient_by_kinds(graph, friction->velocity, OF_VELOCITIES);
  if (gradient.count != 1 || friction->is_given) return model->coordinates.count;
  *coefficient = gradient.values[0];
  Node rest = subtract(graph, friction->velocity, multiply(graph, *coefficient, gradient.symbols[0]));
  bool is_alone = simplify_fraction(graph, rest) == ZERO;
  return is_alone ? (size_t)graph_symbol_of(graph, gradient.symbols[0])->index : model->coordinates.count;
}

/* A constraint a x + b y = constant between coordinates, or a x + b y = 0 between velocities; a and b are constant. */
struct Gear {
  size_t coordinate[2];
  Node coefficient[2];
};

static bool read_gear(const struct Model *model, Node constraint, struct Gear *gear) {
  struct Graph *graph = model->graph;
  const unsigned others = 1u << TIME | 1u << INPUT | 1u << MODE;
  if ((graph->vertices[constraint].kinds & others) != 0) return false;
  bool is_of_velocities = graph_depends_on(graph, constraint, VELOCITY);
  if (is_of_velocities && graph_depends_on(graph, constraint, COORDINATE)) return false;
  const struct Gradient gradient = gradient_by_kinds(graph, constraint, OF_VELOCITIES | 1u << COORDINATE);
  if (gradient.count != 2) return false;
  Node rest = constraint;
  for (int i = 0; i < 2; i++) {
    gear->coordinate[i] = (size_t)graph_symbol_of(graph, gradient.symbols[i])->index;
    gear->coefficient[i] = gradient.values[i];
    if (!graph_is_constant_in_time(graph, gradient.values[i])) return false;
    rest = subtract(graph, rest, multiply(graph, gradient.values[i], gradient.symbols[i]));
  }
  return !is_of_velocities || simplify_fraction(graph, rest) == ZERO;
}

/* Returns the gears of the model, and their number. */
static struct Gear *read_gears(const struct Model *model, size_t *count) {
  struct Gear *gears = allocate(model->constraints.count, sizeof *gears);
  *count = 0;
  for (size_t i = 0; i < model->constraints.count; i++)
    if (read_gear(model, model->constraints.items[i].node, &gears[*count])) (*count)++;
  return gears;
}

/*
 * Replaces a velocity by 0 while friction keeps it at 0, and those coupled to it by gears. is_replaced has an element
 * for each coordinate, which ends the recursion.
 */
static void replace_velocity(const struct Model *model, const struct Gear *gears, size_t gear_count, size_t coordinate,
                             Node is_free, bool *is_replaced, Node *replacements) {
  struct Graph *graph = model->graph;
  Node *shown = &replacements[graph->vertices[model->velocities.items[coordinate].node].left];
  *shown = function(graph, GUARD, is_free, *shown);
  is_replaced[coordinate] = true;
  for (size_t i = 0; i < gear_count; i++)
    for (int side = 0; side < 2; side++) {
      size_t other = gears[i].coordinate[1 - side];
      if (gears[i].coordinate[side] != coordinate || is_replaced[other]) continue;
      Node is_other_free = is_coupled_free(graph, is_free, gears[i].coefficient[1 - side]);
      replace_velocity(model, gears, gear_count, other, is_other_free, is_replaced, replacements);
    }
}

static void replace_velocities(struct Model *model) {
  const struct Switches *switches = &model->switches;
  size_t gear_count, n = model->coordinates.count;
  const struct Gear *gears = read_gears(model, &gear_count);
  Node *replacements = own_symbols(model->graph), coefficient = ZERO;
  for (size_t i = 0; i < switches->friction_count; i++) {
    size_t coordinate = coordinate_of(model, &switches->frictions[i], &coefficient);
    if (coordinate == n) continue;
    Node is_removed = is_coupled_free(model->graph, is_free(model->graph, &switches->frictions[i]), coefficient);
    bool *is_replaced = allocate(n, sizeof *is_replaced);
    replace_velocity(model, gears, gear_count, coordinate, is_removed, is_replaced, replacements);
  }
  substitute_in_observers(model, replacements);
}

/* --- Other velocities, such as v - vBelt --- */

/* If value is c f plus a term without velocities, sets *held to that term, the value at f = 0; else returns false. */
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

static void replace_in_indicators(struct Model *model) {
  struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    const struct Friction *friction = &switches->frictions[i];
    Node coefficient = ZERO;
    bool has_other = !friction->is_given && coordinate_of(model, friction, &coefficient) == model->coordinates.count;
    for (size_t j = 0; j < switches->branch_count && has_other; j++) {
      Node *indicator = &switches->branches[j].indicator, rest;
      if (is_along(graph, *indicator, friction->velocity, &rest))
        *indicator = choose_node(graph, is_free(graph, friction), *indicator, rest);
    }
  }
}

void replace_sticking_velocities(struct Model *model) {
  if (model->switches.friction_count == 0) return;
  replace_in_indicators(model);
  replace_velocities(model);
}
