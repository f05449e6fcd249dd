#include "write/parts.h"

#include "base/memory.h"

/* Instructions of a part; compilation of all parts then takes linear time. */
enum { PART_LENGTH = 1500 };

/* Where a local variable is used. */
struct LocalUse {
  /* part: the part that computes it; shared: 1 + its index in the shared space, 0 if only one part uses it */
  size_t part, shared;
};

static void note_use(struct LocalUse *locals, Slot slot, size_t part, size_t *shared_count) {
  if (space_of(slot) != SPACE_LOCAL) return;
  struct LocalUse *local = &locals[index_in(slot)];
  if (local->part != part && local->shared == 0) local->shared = ++*shared_count;
}

/* Returns the end of the part. It has only instructions that do not depend on the direction, or none of them. */
static size_t end_of_part(const struct IrFunction *ir, size_t steady_count, size_t first) {
  size_t end = first + PART_LENGTH < ir->count ? first + PART_LENGTH : ir->count;
  return first < steady_count && end > steady_count ? steady_count : end;
}

static struct LocalUse *find_shared(const struct IrFunction *ir, size_t steady_count, size_t *shared_count) {
  struct LocalUse *locals = allocate(ir->local_count, sizeof *locals);
  for (size_t i = 0, part = 0, end = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (i == end) {
      end = end_of_part(ir, steady_count, i);
      part++;
    }
    for (int j = 0; j < opcode_arity(instruction->opcode); j++)
      note_use(locals, instruction->operands[j], part, shared_count);
    if (opcode_has_result(instruction->opcode) && space_of(instruction->result) == SPACE_LOCAL)
      locals[index_in(instruction->result)].part = part;
  }
  return locals;
}

/* Returns the slot in a part. keeps_accelerations: they come first in the shared space. */
static Slot placed(const struct LocalUse *locals, bool keeps_accelerations, Slot slot) {
  if (space_of(slot) == SPACE_ACCELERATION && keeps_accelerations)
    return slot_at((enum Space)SPACE_SHARED, index_in(slot));
  if (space_of(slot) != SPACE_LOCAL || locals[index_in(slot)].shared == 0) return slot;
  return slot_at((enum Space)SPACE_SHARED, locals[index_in(slot)].shared - 1);
}

static struct IrFunction *part_of(const struct IrFunction *ir, const struct LocalUse *locals, bool keeps_accelerations,
                                  size_t first, size_t end) {
  struct IrFunction *part = ir_create();
  for (size_t i = first; i < end; i++) {
    struct Instruction instruction = ir->instructions[i];
    Slot *operands = instruction.operands;
    for (int j = 0; j < opcode_arity(instruction.opcode); j++)
      operands[j] = placed(locals, keeps_accelerations, operands[j]);
    if (opcode_has_result(instruction.opcode))
      instruction.result = placed(locals, keeps_accelerations, instruction.result);
    ir_append(part, instruction.opcode, instruction.result, operands[0], operands[1], operands[2]);
    part->instructions[part->count - 1].function = instruction.function;
  }
  return part;
}

/* True if an instruction depends on the direction or writes a target. Updates is_along for its local variable. */
static bool note_along(const struct Instruction *instruction, bool *is_along) {
  bool along = false;
  for (int j = 0; j < opcode_arity(instruction->opcode); j++) {
    enum Space space = space_of(instruction->operands[j]);
    along |= (space >= SPACE_SEED_PARAMETER && space <= SPACE_SEED_RESULT) ||
             (space == SPACE_LOCAL && is_along[index_in(instruction->operands[j])]);
  }
  if (!opcode_has_result(instruction->opcode)) return along;
  if (space_of(instruction->result) == SPACE_LOCAL) is_along[index_in(instruction->result)] = along;
  return along || space_of(instruction->result) == SPACE_TARGET;
}

/* Returns the instructions reordered: first those that do not depend on the direction, steady_count of them. */
static struct IrFunction *with_steady_first(const struct IrFunction *ir, size_t *steady_count) {
  struct IrFunction *sorted = ir_create();
  bool *is_along = allocate(ir->local_count, sizeof *is_along);
  *sorted = *ir;
  sorted->instructions = allocate(ir->count, sizeof *sorted->instructions);
  size_t count = 0;
  for (size_t i = 0; i < ir->count; i++)
    if (!note_along(&ir->instructions[i], is_along)) sorted->instructions[count++] = ir->instructions[i];
  *steady_count = count;
  for (size_t i = 0; i < ir->count; i++)
    if (note_along(&ir->instructions[i], is_along)) sorted->instructions[count++] = ir->instructions[i];
  return sorted;
}

struct Parts parts_of(struct IrFunction *ir, size_t accelerations) {
  struct Parts parts = {.items = allocate(2 + ir->count / PART_LENGTH, sizeof(struct IrFunction *))};
  bool has_blocks = ir_uses(ir, SPACE_RIGHT_SIDE) || ir_uses(ir, SPACE_MASS);
  if (has_blocks || ir->count <= 2 * (size_t)PART_LENGTH) {
    parts.items[parts.count++] = ir;
    return parts;
  }
  size_t steady_count = 0;
  if (ir_uses(ir, SPACE_SEED_STATE)) ir = with_steady_first(ir, &steady_count);
  parts.shared_count = accelerations;
  const struct LocalUse *locals = find_shared(ir, steady_count, &parts.shared_count);
  for (size_t first = 0, end; first < ir->count; first = end) {
    end = end_of_part(ir, steady_count, first);
    if (first < steady_count) parts.steady_count++;
    parts.items[parts.count++] = part_of(ir, locals, accelerations > 0, first, end);
  }
  return parts;
}
