#include "names/piecewise_functions.h"

#include <math.h>

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/functions.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/switches.h"

/* Switching functions that are compared per unit of work. */
enum { COMPARISONS = 8 };

static bool depends_on_contacts(const struct Switches *switches, const struct Cone *cone) {
  bool determines = false;
  for (size_t i = 0; i < switches->contact_count; i++) determines |= cone_has(cone, switches->contacts[i].mode);
  for (size_t i = 0; i < switches->friction_count; i++) determines |= cone_has(cone, switches->frictions[i].reported);
  return determines;
}

unsigned deciding_kinds(const struct Scope *scope, Node node) {
  const struct Graph *graph = scope->graph;
  unsigned kinds = graph->vertices[node].kinds;
  if (scope->switches == NULL || !graph_depends_on(graph, node, MODE)) return kinds;
  cone_collect(graph->cone, graph, &node, 1);
  for (size_t i = 0; i < scope->switches->branch_count; i++) {
    const struct Branch *branch = &scope->switches->branches[i];
    if (cone_has(graph->cone, branch->mode)) kinds |= branch->kinds;
  }
  if (depends_on_contacts(scope->switches, graph->cone)) kinds |= CONTACT_STATE;
  return kinds;
}

/* Returns the mode of the switching function of this kind; adds it if there is none. */
static Node mode_of(struct Scope *scope, Node indicator, const char *function, long line, bool is_last_sign) {
  struct Switches *switches = scope->switches;
  graph_work(scope->graph, switches->branch_count / COMPARISONS);
  for (size_t i = switches->branch_count; i-- > 0;)
    if (switches->branches[i].indicator == indicator && switches->branches[i].is_last_sign == is_last_sign)
      return switches->branches[i].mode;
  char *name = format_text("%s in line %ld", function, line);
  Node mode = next_mode(switches, scope->graph, name);
  append_branch(switches, (struct Branch){.mode = mode,
                                          .indicator = indicator,
                                          .kinds = deciding_kinds(scope, indicator),
                                          .is_last_sign = is_last_sign,
                                          .function = function,
                                          .line = scope_line(scope, line)});
  return mode;
}

static bool keeps_whole(const struct Scope *scope) {
  return scope->switches == NULL || scope->keeps_whole;
}

static Node sign_of(struct Scope *scope, Node node, const char *function_name, long line, bool is_last_sign) {
  struct Graph *graph = scope->graph;
  bool may_jump = graph_depends_on(graph, node, PARAMETER) || graph_depends_on(graph, node, MODE);
  bool is_fixed = graph_is_constant_in_time(graph, node) && !(is_last_sign && may_jump);
  if (keeps_whole(scope) || is_fixed) return function(graph, SIGN, node, ZERO);
  Node base;
  double factor = coefficient_of(graph, node, &base);
  if (scope->relevance != ONE) base = choose_node(graph, scope->relevance, base, ONE);
  Node mode = mode_of(scope, base, function_name, line, is_last_sign);
  if (scope->relevance != ONE) mode = function(graph, GUARD, scope->relevance, mode);
  return factor < 0.0 ? negate(graph, mode) : mode;
}

Node branch_of(struct Scope *scope, Node node, const char *function_name, long line) {
  return sign_of(scope, node, function_name, line, false);
}

static const char of_event[] = "the event";

Node last_sign_of(struct Scope *scope, Node node, long line) {
  return sign_of(scope, node, of_event, line, true);
}

Node condition_of_parameters(struct Scope *scope, Node node, long line) {
  return mode_of(scope, node, of_event, line, false);
}

Node piecewise_function(struct Scope *scope, enum Operation operation, Node left, Node right, long line) {
  return piecewise_function_for(scope, operation, left, right, functions[operation].name, line);
}

Node piecewise_function_for(struct Scope *scope, enum Operation operation, Node left, Node right, const char *purpose,
                            long line) {
  struct Graph *graph = scope->graph;
  bool has_two = operation_arity(operation) == 2;
  Node turning = has_two ? subtract(graph, left, right) : left;
  if (keeps_whole(scope) || graph_is_constant_in_time(graph, turning)) return function(graph, operation, left, right);
  Node sign = branch_of(scope, turning, purpose, line);
  switch (operation) {
  case ABSOLUTE: return multiply(graph, sign, left);
  case SIGN: return sign;
  case MAXIMUM: return choose_node(graph, sign, left, right);
  default: return choose_node(graph, negate(graph, sign), left, right);
  }
}

/* Returns the even (parity 0) or odd (parity 1) number nearest to a node: 2 floor((x + 1 - parity)/2) + parity. */
static Node nearest_of_parity(struct Graph *graph, Node node, double parity) {
  Node half = scale(graph, 0.5, add(graph, node, graph_constant(graph, 1.0 - parity)));
  Node twice = scale(graph, 2.0, function(graph, FLOOR, half, ZERO));
  return add(graph, twice, graph_constant(graph, parity));
}

/*
 * Between two zeros of sin(pi x), the sign gives the parity of floor(x). x - 1/2 differs from floor(x) by at most 1/2,
 * and from other numbers of this parity by at least 3/2. So rounding x - 1/2 to this parity is right on the piece and
 * 1/2 beyond its ends. If x rests on an integer (sign 0), that integer is the value.
 */
Node floor_of(struct Scope *scope, Node node, long line) {
  struct Graph *graph = scope->graph;
  if (keeps_whole(scope) || graph_is_constant_in_time(graph, node)) return function(graph, FLOOR, node, ZERO);
  Node sine = function(graph, SINE, scale(graph, acos(-1.0), node), ZERO);
  Node sign = branch_of(scope, sine, "floor", line), middle = subtract(graph, node, graph_constant(graph, 0.5));
  Node at_rest = function(graph, FLOOR, add(graph, node, graph_constant(graph, 0.5)), ZERO);
  Node odd = choose_node(graph, negate(graph, sign), nearest_of_parity(graph, middle, 1.0), at_rest);
  return choose_node(graph, sign, nearest_of_parity(graph, middle, 0.0), odd);
}

/* Returns 1 if left < right, else 0, in terms of a mode. Derivatives of min and max contain it. */
static Node piecewise_less(struct Scope *scope, Node left, Node right, long line) {
  Node difference = subtract(scope->graph, right, left);
  if (graph_is_constant_in_time(scope->graph, difference)) return function(scope->graph, LESS, left, right);
  return function(scope->graph, GUARD, branch_of(scope, difference, "a condition", line), ONE);
}

/* The scope and the line of an expression whose pieces get modes. */
struct Piecewise {
  struct Scope *scope;
  long line;
};

static bool replace_by_modes(void *context, enum Operation operation, Node left, Node right, Node *result) {
  struct Scope *scope = ((struct Piecewise *)context)->scope;
  long line = ((struct Piecewise *)context)->line;
  if (operation == LESS) *result = piecewise_less(scope, left, right, line);
  else if (operation == FLOOR) *result = floor_of(scope, left, line);
  else if (functions[operation].has_pieces) *result = piecewise_function(scope, operation, left, right, line);
  else return false;
  return true;
}

Node with_modes(struct Scope *scope, Node node, long line) {
  struct Piecewise piecewise = {scope, line};
  const struct Rebuilding rebuilding = {scope->graph, &piecewise, replace_by_modes};
  return keeps_whole(scope) ? node : rebuild(&rebuilding, node);
}
