#include "program/codegen/code_generator.h"

#include <math.h>

#include "base/memory.h"

struct CodeGenerator *generator_create(const struct Graph *graph, const struct ParameterConstants *parameter_constants,
                                       size_t coordinates) {
  struct CodeGenerator *generator = allocate(1, sizeof *generator);
  *generator = (struct CodeGenerator){.graph = graph,
                                      .parameter_constants = parameter_constants,
                                      .coordinates = coordinates,
                                      .needs = needs_create(graph),
                                      .local = allocate(graph->count, sizeof(Slot)),
                                      .has_local = allocate(graph->count, sizeof(bool))};
  return generator;
}

struct IrFunction *generator_begin(struct CodeGenerator *generator) {
  for (size_t i = 0; i < generator->computed.count; i++) generator->has_local[generator->computed.nodes[i]] = false;
  generator->computed.count = 0;
  generator->ir = ir_create();
  return generator->ir;
}

static Slot slot_of_symbol(const struct CodeGenerator *generator, const struct Symbol *symbol) {
  size_t index = (size_t)symbol->index, n = generator->coordinates;
  switch (symbol->kind) {
  case PARAMETER:
  case MODE: return slot_at(SPACE_PARAMETER, index);
  case TIME: return slot_at(SPACE_TIME, 0);
  case COORDINATE: return slot_at(SPACE_STATE, index);
  case VELOCITY: return slot_at(SPACE_STATE, n + index);
  case STATE: return slot_at(SPACE_STATE, 2 * n + index);
  case ACCELERATION: return slot_at(SPACE_ACCELERATION, index);
  case INPUT: return slot_at(SPACE_INPUT, index);
  case SEED_PARAMETER: return slot_at(SPACE_SEED_PARAMETER, index);
  case SEED_TIME: return slot_at(SPACE_SEED_TIME, 0);
  case SEED_COORDINATE: return slot_at(SPACE_SEED_STATE, index);
  case SEED_VELOCITY: return slot_at(SPACE_SEED_STATE, n + index);
  case SEED_STATE: return slot_at(SPACE_SEED_STATE, 2 * n + index);
  case SEED_ACCELERATION: return slot_at(SPACE_SEED_ACCELERATION, index);
  case SEED_RESULT: return slot_at(SPACE_SEED_RESULT, index);
  case DISPLACEMENT: /* these are replaced in all expressions and have no seeds */
  case REACTION:
  case DUMMY:
  case SEED_INPUT:
  case SYMBOL_KIND_COUNT: break;
  }
  return slot_at(SPACE_SEED_INPUT, index);
}

Slot generator_slot(const struct CodeGenerator *generator, Node node) {
  if (generator->has_local[node]) return generator->local[node];
  if (graph_is_constant(generator->graph, node)) return slot_at(SPACE_NUMBER, node);
  if (generator->graph->vertices[node].operation == SYMBOL)
    return slot_of_symbol(generator, graph_symbol_of(generator->graph, node));
  return slot_at(SPACE_PARAMETER_CONSTANTS, generator->parameter_constants->slot[node] - 1);
}

void generator_define(struct CodeGenerator *generator, Node node, Slot slot) {
  generator->local[node] = slot;
  generator->has_local[node] = true;
  append_node(&generator->computed, node);
}

void generator_copy(struct CodeGenerator *generator, Slot target, Node node) {
  ir_copy(generator->ir, target, generator_slot(generator, node));
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

static void append_function(struct CodeGenerator *generator, enum Operation function, Slot result,
                            struct FusedOperation fused) {
  Slot left = generator_slot(generator, fused.left),
       right = fused.arity == 2 ? generator_slot(generator, fused.right) : 0;
  if (function == LESS) ir_append(generator->ir, LESS_THAN, result, left, right, 0);
  else if (function == GUARD) ir_append(generator->ir, GUARD_OF, result, left, right, 0);
  else if (function == SIGN) ir_append(generator->ir, SIGN_OF, result, left, 0, 0);
  else ir_append_call(generator->ir, function, result, left, right);
}

static void append_power(struct CodeGenerator *generator, Slot result, struct FusedOperation fused) {
  bool is_number = graph_is_constant(generator->graph, fused.right);
  enum Opcode opcode = is_number ? opcode_of_power(graph_value(generator->graph, fused.right)) : COPY;
  if (opcode == COPY) append_function(generator, POWER, result, fused);
  else ir_append(generator->ir, opcode, result, generator_slot(generator, fused.left), 0, 0);
}

static void append(struct CodeGenerator *generator, Node node, struct FusedOperation fused) {
  static const enum Opcode opcodes[] = {[FUSED_SUM] = SUM,
                                        [FUSED_DIFFERENCE] = DIFFERENCE,
                                        [FUSED_PRODUCT] = PRODUCT,
                                        [FUSED_QUOTIENT] = QUOTIENT,
                                        [FUSED_NEGATION] = NEGATION};
  Slot result = ir_new_local(generator->ir);
  if (fused.kind == FUSED_POWER) append_power(generator, result, fused);
  else if (fused.kind == FUSED_FUNCTION)
    append_function(generator, generator->graph->vertices[node].operation, result, fused);
  else
    ir_append(generator->ir, opcodes[fused.kind], result, generator_slot(generator, fused.left),
              fused.arity == 2 ? generator_slot(generator, fused.right) : 0, 0);
  generator_define(generator, node, result);
}

static bool is_missing(const struct CodeGenerator *generator, Node node) {
  return !is_fetched(generator->needs, node) && !generator->has_local[node];
}

/* Steps that each node adds to the graph's limit of work: it becomes an instruction and a line of code. */
enum { COMPUTE_WORK = 10 };

void generator_compute(struct CodeGenerator *generator, const Node *targets, size_t count, bool preparing) {
  struct NeededNodes *needs = generator->needs;
  if (graph_limit(generator->graph) != NULL) return; /* the limit is reached, and no code will be written */
  needs_collect(needs, targets, count, preparing);
  graph_work(generator->graph, COMPUTE_WORK * needs->cone->count);
  const struct Cone *cone = needs->cone;
  bool *needed = allocate(cone->count, sizeof *needed);
  for (size_t i = 0; i < count; i++) needed[cone_slot(cone, targets[i])] = true;
  for (size_t i = cone->count; i-- > 0;) {
    if (!needed[i] || !is_missing(generator, cone->nodes[i])) continue;
    struct FusedOperation fused = fused_operation_of(needs, cone->nodes[i]);
    needed[cone_slot(cone, fused.left)] = true;
    if (fused.arity == 2) needed[cone_slot(cone, fused.right)] = true;
  }
  for (size_t i = 0; i < cone->count; i++)
    if (needed[i] && is_missing(generator, cone->nodes[i]))
      append(generator, cone->nodes[i], fused_operation_of(needs, cone->nodes[i]));
}
