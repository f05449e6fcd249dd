#include "program/values/values.h"

#include <math.h>

#include "base/memory.h"

struct Values *values_create(const struct Graph *graph, const struct ParameterConstants *parameter_constants,
                             size_t coordinates) {
  struct Values *values = allocate(1, sizeof *values);
  *values = (struct Values){.graph = graph,
                            .parameter_constants = parameter_constants,
                            .coordinates = coordinates,
                            .needs = needs_create(graph),
                            .local = allocate(graph->count, sizeof(Slot)),
                            .has_local = allocate(graph->count, sizeof(bool))};
  return values;
}

struct Routine *values_begin(struct Values *values) {
  for (size_t i = 0; i < values->computed.count; i++) values->has_local[values->computed.nodes[i]] = false;
  values->computed.count = 0;
  values->routine = routine_create();
  return values->routine;
}

static Slot slot_of_symbol(const struct Values *values, const struct Symbol *symbol) {
  size_t index = (size_t)symbol->index, n = values->coordinates;
  switch (symbol->kind) {
  case PARAMETER:
  case MODE: return slot_in(SPACE_PARAMETER, index);
  case TIME: return slot_in(SPACE_TIME, 0);
  case COORDINATE: return slot_in(SPACE_STATE, index);
  case VELOCITY: return slot_in(SPACE_STATE, n + index);
  case STATE: return slot_in(SPACE_STATE, 2 * n + index);
  case ACCELERATION: return slot_in(SPACE_ACCELERATION, index);
  case INPUT: return slot_in(SPACE_INPUT, index);
  case SEED_PARAMETER: return slot_in(SPACE_SEED_PARAMETER, index);
  case SEED_TIME: return slot_in(SPACE_SEED_TIME, 0);
  case SEED_COORDINATE: return slot_in(SPACE_SEED_STATE, index);
  case SEED_VELOCITY: return slot_in(SPACE_SEED_STATE, n + index);
  case SEED_STATE: return slot_in(SPACE_SEED_STATE, 2 * n + index);
  case SEED_ACCELERATION: return slot_in(SPACE_SEED_ACCELERATION, index);
  case SEED_RESULT: return slot_in(SPACE_SEED_RESULT, index);
  case DISPLACEMENT: /* these are replaced in all expressions and have no seeds */
  case REACTION:
  case DUMMY:
  case SEED_INPUT:
  case SYMBOL_KIND_COUNT: break;
  }
  return slot_in(SPACE_SEED_INPUT, index);
}

Slot values_slot(const struct Values *values, Node node) {
  if (values->has_local[node]) return values->local[node];
  if (graph_is_constant(values->graph, node)) return slot_in(SPACE_NUMBER, node);
  if (values->graph->vertices[node].operation == SYMBOL)
    return slot_of_symbol(values, graph_symbol_of(values->graph, node));
  return slot_in(SPACE_PARAMETER_CONSTANTS, values->parameter_constants->slot[node] - 1);
}

void values_hold(struct Values *values, Node node, Slot slot) {
  values->local[node] = slot;
  values->has_local[node] = true;
  append_node(&values->computed, node);
}

void values_copy(struct Values *values, Slot target, Node node) {
  routine_copy(values->routine, target, values_slot(values, node));
}

/* Returns the opcode of a constant power that needs no pow(); COPY for none. */
static enum Opcode opcode_of_power(double exponent) {
  static const enum Opcode powers[] = {INVERSE_FOURTH, INVERSE_CUBE, INVERSE_SQUARE, RECIPROCAL, COPY,
                                       COPY,           SQUARE,       CUBE,           FOURTH};
  if (exponent == 0.5) return SQUARE_ROOT;
  if (exponent == -0.5) return INVERSE_ROOT;
  bool is_whole = exponent == floor(exponent) && fabs(exponent) <= 4.0;
  return is_whole ? powers[(int)exponent + 4] : COPY;
}

static void append_function(struct Values *values, enum Operation function, Slot result, struct Form form) {
  Slot left = values_slot(values, form.left), right = form.arity == 2 ? values_slot(values, form.right) : 0;
  if (function == LESS) routine_append(values->routine, LESS_THAN, result, left, right, 0);
  else if (function == GUARD) routine_append(values->routine, GUARD_OF, result, left, right, 0);
  else if (function == SIGN) routine_append(values->routine, SIGN_OF, result, left, 0, 0);
  else routine_append_call(values->routine, function, result, left, right);
}

static void append_power(struct Values *values, Slot result, struct Form form) {
  bool is_number = graph_is_constant(values->graph, form.right);
  enum Opcode opcode = is_number ? opcode_of_power(graph_value(values->graph, form.right)) : COPY;
  if (opcode == COPY) append_function(values, POWER, result, form);
  else routine_append(values->routine, opcode, result, values_slot(values, form.left), 0, 0);
}

static void append(struct Values *values, Node node, struct Form form) {
  static const enum Opcode opcodes[] = {[FORM_SUM] = SUM,
                                        [FORM_DIFFERENCE] = DIFFERENCE,
                                        [FORM_PRODUCT] = PRODUCT,
                                        [FORM_QUOTIENT] = QUOTIENT,
                                        [FORM_NEGATION] = NEGATION};
  Slot result = routine_local(values->routine);
  if (form.kind == FORM_POWER) append_power(values, result, form);
  else if (form.kind == FORM_FUNCTION) append_function(values, values->graph->vertices[node].operation, result, form);
  else
    routine_append(values->routine, opcodes[form.kind], result, values_slot(values, form.left),
                   form.arity == 2 ? values_slot(values, form.right) : 0, 0);
  values_hold(values, node, result);
}

static bool is_missing(const struct Values *values, Node node) {
  return !is_fetched(values->needs, node) && !values->has_local[node];
}

/* Steps that each node adds to the graph's limit of work: it becomes an instruction and a line of code. */
enum { COMPUTE_WORK = 10 };

void values_compute(struct Values *values, const Node *targets, size_t count, bool preparing) {
  struct Needs *needs = values->needs;
  if (graph_limit(values->graph) != NULL) return; /* the limit is reached, and no code will be written */
  needs_collect(needs, targets, count, preparing);
  graph_work(values->graph, COMPUTE_WORK * needs->cone->count);
  const struct Cone *cone = needs->cone;
  bool *needed = allocate(cone->count, sizeof *needed);
  for (size_t i = 0; i < count; i++) needed[cone_slot(cone, targets[i])] = true;
  for (size_t i = cone->count; i-- > 0;) {
    if (!needed[i] || !is_missing(values, cone->nodes[i])) continue;
    struct Form form = form_of(needs, cone->nodes[i]);
    needed[cone_slot(cone, form.left)] = true;
    if (form.arity == 2) needed[cone_slot(cone, form.right)] = true;
  }
  for (size_t i = 0; i < cone->count; i++)
    if (needed[i] && is_missing(values, cone->nodes[i])) append(values, cone->nodes[i], form_of(needs, cone->nodes[i]));
}
