/*
 * Step limits by bounds of series. The Taylor coefficients of f(u(t)) may vanish at the start of a step, as of a
 * pulse of exp(u) or before a pole of 1/u. The truncated series of f then does not show the feature. The excursion
 * of the polynomial u over a step h,
 *
 *     sum over k >= 1 of |u_k| h^k,
 *
 * bounds |u(t) - u_0| on the complex disc |t| <= h. The runtime shortens h until f has no singularity within the
 * excursion of u_0, and changes at most by the factor e^5 or is constant to rounding. By Cauchy's estimate its
 * coefficients then decay as the truncation assumes. At kinks and jumps u must keep its sign on the real axis. This
 * file finds which checks a system needs: one for each rule, argument and guard, shared by all powers of one base.
 * Whole powers up to HIGHEST_WIDE_POWER need none. One pass over the nodes; at run time, a check costs a few
 * evaluations of a polynomial.
 */
#include "program/series/limits.h"

#include <math.h>
#include <string.h>

#include "algebra/functions.h"
#include "base/memory.h"

/*
 * Guard conditions of the nodes in a series. GUARD(a, b) is b where a > 0, else 0. A node that is needed only under
 * guards whose conditions do not hold may have no value, and must not limit the step.
 *
 * A backward data-flow analysis: each node passes its set of guard conditions to its operands, and a guard passes its
 * own condition to its operand. Repeats until nothing changes. Ends, as the sets only grow and hold at most
 * GUARD_CONDITION_LIMIT conditions. Nodes are numbered after their operands, so that only auxiliary nodes need a second
 * pass.
 */

/* Guard conditions kept for a node; with more, it counts as always needed, which only shortens steps. */
enum { GUARD_CONDITION_LIMIT = 6 };

/*
 * The guard conditions, of which at least one must be positive for the node to be needed. always: needed in any case,
 * also if it has more conditions than the limit.
 */
struct GuardConditions {
  Node nodes[GUARD_CONDITION_LIMIT];
  size_t count;
  bool always;
};

static bool has_guards(const struct Graph *graph) {
  for (Node node = 0; node < graph->count; node++)
    if (graph->vertices[node].operation == GUARD) return true;
  return false;
}

static bool add_guard_condition(struct GuardConditions *guard_conditions, Node guard_condition) {
  if (guard_conditions->always) return false;
  for (size_t i = 0; i < guard_conditions->count; i++)
    if (guard_conditions->nodes[i] == guard_condition) return false;
  if (guard_conditions->count == GUARD_CONDITION_LIMIT) guard_conditions->always = true;
  else guard_conditions->nodes[guard_conditions->count++] = guard_condition;
  return true;
}

/* Adds the guard conditions of one node to those of another. Returns true if these have grown. */
static bool inherit(struct GuardConditions *to, const struct GuardConditions *from) {
  bool grown = from->always && !to->always;
  to->always |= from->always;
  for (size_t i = 0; i < from->count && !to->always; i++) grown |= add_guard_condition(to, from->nodes[i]);
  return grown;
}

/* Passes the guard conditions of a node to its operands. Returns true if any set has grown. */
static bool hand_on(const struct Graph *graph, const struct SeriesPlan *plan, struct GuardConditions *guard_conditions,
                    Node node) {
  const struct Vertex *vertex = &graph->vertices[node];
  int arity = operation_arity(vertex->operation);
  const struct GuardConditions *own = &guard_conditions[node];
  if (!own->always && own->count == 0) return false;
  bool grown = false;
  if (vertex->operation == GUARD) return add_guard_condition(&guard_conditions[vertex->right], vertex->left);
  if (arity > 0) grown |= inherit(&guard_conditions[vertex->left], own);
  if (arity > 1) grown |= inherit(&guard_conditions[vertex->right], own);
  if (plan->auxiliary[node] != ZERO && plan->auxiliary[node] != node)
    grown |= inherit(&guard_conditions[plan->auxiliary[node]], own);
  return grown;
}

/* Returns the guard conditions of each node of the graph; NULL without guards. */
static struct GuardConditions *guard_conditions_of(const struct Graph *graph, const struct SeriesPlan *plan) {
  if (!has_guards(graph)) return NULL;
  struct GuardConditions *guard_conditions = allocate(graph->count, sizeof *guard_conditions);
  for (size_t i = 0; i < plan->root_count; i++) guard_conditions[plan->targets.nodes[i]].always = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (Node node = (Node)graph->count; node-- > 0;) grown |= hand_on(graph, plan, guard_conditions, node);
  }
  return guard_conditions;
}

static const struct LimitMetadata metadata[LIMIT_RULE_COUNT] = {
    [LIMIT_EXPONENTIAL] = {.name = "exponential", .has_function = true},
    [LIMIT_HYPERBOLIC] = {.name = "hyperbolic", .has_function = true},
    [LIMIT_BOUNDED] = {.name = "bounded", .has_function = true},
    [LIMIT_TANH] = {.name = "tanh"},
    [LIMIT_TANGENT] = {.name = "tangent"},
    [LIMIT_POSITIVE] = {.name = "positive", .has_function = true},
    [LIMIT_QUOTIENT] = {.name = "quotient", .has_share = true},
    [LIMIT_ROOT] = {.name = "root", .has_share = true},
    [LIMIT_WHOLE_POWER] = {.name = "whole_power", .has_share = true},
    [LIMIT_DIVISION] = {.name = "division", .has_two_rows = true, .has_share = true},
    [LIMIT_POWER] = {.name = "power", .has_exponent = true},
    [LIMIT_SIGN] = {.name = "sign", .has_function = true},
    [LIMIT_ANGLE] = {.name = "angle", .has_two_rows = true},
};

const struct LimitMetadata *limit_metadata(enum LimitRule rule) {
  return &metadata[rule];
}

/* A check before its rows have slots; ZERO for rows that it does not have. */
struct PendingCheck {
  enum LimitRule rule;
  Node rows[2];
  const char *function;
  Node exponent; /* known only at run time; ZERO for none */
  double share;  /* for powers with a constant exponent, else NAN */
  size_t next;   /* 1 + the next check with the same first row, 0 for none */
  bool is_covered;
  Node guard_condition; /* the guard condition under which it applies; ZERO: always */
};

/* The checks that were found, with an index by their first rows. */
struct PendingChecks {
  const struct SeriesBuilder *builder;
  struct PendingCheck *items;
  size_t count;
  size_t *first;                                  /* for each node: 1 + the first check with this row, 0 for none */
  const struct GuardConditions *guard_conditions; /* guard conditions of the present node; NULL: always needed */
};

/* Adds a check, or merges it with an equal one. Of two powers of one base, the smaller share is the stricter. */
static void append_under(struct PendingChecks *list, struct PendingCheck check, Node guard_condition) {
  check.guard_condition = guard_condition;
  size_t *end = &list->first[check.rows[0]];
  for (; *end != 0; end = &list->items[*end - 1].next) {
    struct PendingCheck *other = &list->items[*end - 1];
    if (other->rule != check.rule || other->rows[1] != check.rows[1] || other->exponent != check.exponent ||
        other->guard_condition != check.guard_condition)
      continue;
    if (check.share < other->share) other->share = check.share;
    return;
  }
  size_t number = list->count + 1;
  *end = number;
  APPEND(list->items, list->count, check);
}

/* Adds a check for each guard condition of the present node. */
static void append(struct PendingChecks *list, struct PendingCheck check) {
  const struct GuardConditions *guard_conditions = list->guard_conditions;
  if (guard_conditions == NULL || guard_conditions->always) {
    append_under(list, check, ZERO);
    return;
  }
  for (size_t i = 0; i < guard_conditions->count; i++) append_under(list, check, guard_conditions->nodes[i]);
}

static bool can_have_row(const struct SeriesBuilder *builder, Node node) {
  return !is_constant_series(builder, node) &&
         (builder->is_computed[node] || builder->graph->vertices[node].operation == SYMBOL);
}

/* Strips constant factors and inner powers from base^exponent; they do not change the relative variation. */
static Node bare_base(const struct SeriesBuilder *builder, Node base, double *exponent) {
  const struct Graph *graph = builder->graph;
  for (;;) {
    const struct Vertex *vertex = &graph->vertices[base];
    Node inner = base;
    double factor = 1.0;
    if (vertex->operation == MULTIPLY && is_constant_series(builder, vertex->left)) inner = vertex->right;
    else if (vertex->operation == MULTIPLY && is_constant_series(builder, vertex->right)) inner = vertex->left;
    else if (vertex->operation == POWER && graph_is_constant(graph, vertex->right)) {
      inner = vertex->left;
      factor = graph_value(graph, vertex->right);
    }
    if (inner == base || !can_have_row(builder, inner)) return base;
    base = inner;
    *exponent *= factor;
  }
}

/* Adds the check of a quotient. A numerator that vanishes throughout a motion lifts the limit at run time. */
static void check_division(struct PendingChecks *list, Node numerator, Node denominator) {
  double exponent = -1.0;
  Node base = bare_base(list->builder, denominator, &exponent);
  struct PendingCheck check = {.rule = LIMIT_QUOTIENT, .rows = {base}, .share = series_limit_share(exponent)};
  if (can_have_row(list->builder, numerator)) {
    check.rule = LIMIT_DIVISION;
    check.rows[1] = numerator;
  }
  append(list, check);
}

static void check_number_power(struct PendingChecks *list, Node base, double exponent) {
  base = bare_base(list->builder, base, &exponent);
  bool is_whole = exponent == floor(exponent);
  if (is_whole && exponent > 0.0 && exponent <= HIGHEST_WIDE_POWER) return;
  enum LimitRule rule = exponent < 0.0 ? LIMIT_QUOTIENT : is_whole ? LIMIT_WHOLE_POWER : LIMIT_ROOT;
  append(list, (struct PendingCheck){.rule = rule, .rows = {base}, .share = series_limit_share(exponent)});
}

static void check_power(struct PendingChecks *list, Node node) {
  const struct Graph *graph = list->builder->graph;
  const struct Vertex *vertex = &graph->vertices[node];
  Node auxiliary = list->builder->plan->auxiliary[node];
  if (graph_is_constant(graph, vertex->right))
    check_number_power(list, vertex->left, graph_value(graph, vertex->right));
  else if (is_constant_series(list->builder, vertex->right))
    append(list,
           (struct PendingCheck){.rule = LIMIT_POWER, .rows = {vertex->left}, .exponent = vertex->right, .share = NAN});
  else if (can_have_row(list->builder, auxiliary))
    append(list,
           (struct PendingCheck){.rule = LIMIT_EXPONENTIAL, .rows = {auxiliary}, .function = "pow", .share = NAN});
}

static enum LimitRule rule_named(const char *name) {
  int rule = 0;
  while (strcmp(metadata[rule].name, name) != 0) rule++;
  return (enum LimitRule)rule;
}

/* Adds the check that the table of functions names for an operand or an auxiliary node. */
static void check_by_rule(struct PendingChecks *list, const char *rule, Node row, const char *function) {
  if (rule != NULL && can_have_row(list->builder, row))
    append(list, (struct PendingCheck){.rule = rule_named(rule), .rows = {row}, .function = function, .share = NAN});
}

static void check_function(struct PendingChecks *list, Node node) {
  const struct SeriesBuilder *builder = list->builder;
  const struct Vertex *vertex = &builder->graph->vertices[node];
  const struct Function *function = &functions[vertex->operation];
  /* LESS only occurs in derivatives of min and max */
  const char *name = vertex->operation == LESS ? "min or max" : function->name;
  check_by_rule(list, function->operand_limit, vertex->left, name);
  check_by_rule(list, function->auxiliary_limit, builder->plan->auxiliary[node], name);
  bool is_angle =
      function->recurrence == ANGLE && can_have_row(builder, vertex->left) && can_have_row(builder, vertex->right);
  if (is_angle)
    append(list, (struct PendingCheck){.rule = LIMIT_ANGLE, .rows = {vertex->left, vertex->right}, .share = NAN});
}

/* Marks checks of quotients that a check of the denominator alone covers. */
static void find_covered(struct PendingChecks *list) {
  for (size_t i = 0; i < list->count; i++) {
    struct PendingCheck *check = &list->items[i];
    if (check->rule != LIMIT_DIVISION) continue;
    for (size_t j = list->first[check->rows[0]]; j != 0; j = list->items[j - 1].next)
      check->is_covered |= list->items[j - 1].rule == LIMIT_QUOTIENT && list->items[j - 1].share <= check->share &&
                           list->items[j - 1].guard_condition == check->guard_condition;
  }
}

static struct LimitChecks take_rows(struct SeriesBuilder *builder, const struct PendingChecks *list) {
  struct LimitChecks checks = {.items = allocate(list->count, sizeof *checks.items)};
  for (size_t i = 0; i < list->count; i++) {
    const struct PendingCheck *check = &list->items[i];
    if (check->is_covered) continue;
    struct LimitCheck *taken = &checks.items[checks.count++];
    *taken = (struct LimitCheck){.rule = check->rule, .function = check->function, .share = check->share};
    taken->row = series_row(builder, check->rows[0]);
    if (check->rows[1] != ZERO) taken->other_row = series_row(builder, check->rows[1]);
    if (check->exponent != ZERO) taken->exponent = generator_slot(builder->generator, check->exponent);
    taken->is_guarded = check->guard_condition != ZERO;
    if (taken->is_guarded) taken->guard_condition = generator_slot(builder->generator, check->guard_condition);
  }
  return checks;
}

struct LimitChecks limits_of(struct SeriesBuilder *builder) {
  struct PendingChecks list = {.builder = builder,
                               .items = make_room(NULL, 0, sizeof *list.items),
                               .first = allocate(builder->graph->count, sizeof(size_t))};
  struct GuardConditions *guard_conditions = guard_conditions_of(builder->graph, builder->plan);
  for (size_t i = 0; i < builder->nodes.count; i++) {
    Node node = builder->nodes.nodes[i];
    list.guard_conditions = guard_conditions != NULL ? &guard_conditions[node] : NULL;
    struct FusedOperation fused = fused_operation_of(builder->needs, node);
    if (fused.kind == FUSED_POWER) check_power(&list, node);
    else if (fused.kind == FUSED_FUNCTION) check_function(&list, node);
    else if (fused.kind == FUSED_QUOTIENT && can_have_row(builder, fused.right))
      check_division(&list, fused.left, fused.right);
  }
  if (guard_conditions != NULL) release(guard_conditions);
  find_covered(&list);
  struct LimitChecks checks = take_rows(builder, &list);
  release(list.items);
  release(list.first);
  return checks;
}
