/*
 * Level scheduling. The level of an instruction is 1 + the highest level that it must follow. It follows the last
 * writes of its operands, and the last writes and reads of the slot that its result overwrites. Instructions of one
 * level are independent, but for chains of sums, and are sorted by opcode, function and spaces into runs. In a run those
 * of one form follow each other, and chains stay in order. Forms, and instructions of one form, keep the order of the
 * function: results that it writes one after another are then equally spaced. One pass and two sorts: O(n log n). SKIP
 * accesses all slots of its region.
 */
#include "program/tables/schedule.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/sorting.h"

/* The levels at which a slot was last written and read; 0: not yet. */
struct Access {
  size_t written, read;
};

/* The accesses of the slots in each space. */
struct Accesses {
  struct Access *of[SPACE_COUNT];
  size_t count[SPACE_COUNT];
};

static void extend(struct Accesses *accesses, Slot slot) {
  if (index_in(slot) >= accesses->count[space_of(slot)]) accesses->count[space_of(slot)] = index_in(slot) + 1;
}

static void extend_to_slots(struct Accesses *accesses, const struct IrFunction *ir) {
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (opcode_has_result(instruction->opcode)) extend(accesses, instruction->result);
    for (int j = 0; j < opcode_arity(instruction->opcode); j++) extend(accesses, instruction->operands[j]);
  }
}

static struct Accesses accesses_create(const struct SeparatedFunction *function, const struct LoopedBlocks *blocks) {
  struct Accesses accesses = {0};
  extend_to_slots(&accesses, &function->outer);
  for (size_t i = 0; i < function->region_count; i++) extend_to_slots(&accesses, &function->regions[i].ir);
  if (blocks->mass_count > accesses.count[SPACE_MASS]) accesses.count[SPACE_MASS] = blocks->mass_count;
  if (blocks->right_side_count > accesses.count[SPACE_RIGHT_SIDE])
    accesses.count[SPACE_RIGHT_SIDE] = blocks->right_side_count;
  for (int space = 0; space < SPACE_COUNT; space++)
    accesses.of[space] = allocate(accesses.count[space], sizeof(struct Access));
  return accesses;
}

static struct Access *access_of(const struct Accesses *accesses, Slot slot) {
  return &accesses->of[space_of(slot)][index_in(slot)];
}

/* Returns the level of an instruction on a block, which reads and writes the block's whole ranges of both spaces. */
static size_t level_of_block(const struct Accesses *accesses, const struct LoopedBlock *looped, bool factors,
                             size_t level) {
  struct Access *mass = accesses->of[SPACE_MASS] + looped->first_mass;
  struct Access *right_side = accesses->of[SPACE_RIGHT_SIDE] + looped->first_right_side;
  size_t elements = looped->mass_count;
  for (size_t i = 0; i < elements; i++)
    level = larger(level, factors ? larger(mass[i].written, mass[i].read) : mass[i].written);
  for (size_t i = 0; i < looped->block->count && !factors; i++)
    level = larger(level, larger(right_side[i].written, right_side[i].read));
  level++;
  for (size_t i = 0; i < elements; i++) {
    if (factors) mass[i].written = level;
    else mass[i].read = larger(mass[i].read, level);
  }
  for (size_t i = 0; i < looped->block->count && !factors; i++) right_side[i].written = level;
  return level;
}

/* Returns the larger one of the level and of those that the instruction must follow. */
static size_t level_before(const struct Accesses *accesses, const struct Instruction *instruction, size_t level) {
  const struct OpcodeMetadata *metadata = opcode_metadata(instruction->opcode);
  for (int j = 0; j < opcode_arity(instruction->opcode); j++)
    if (metadata->operands[j] != ROW_OF_PAST)
      level = larger(level, access_of(accesses, instruction->operands[j])->written);
  if (opcode_has_result(instruction->opcode)) {
    const struct Access *result = access_of(accesses, instruction->result);
    level = larger(level, larger(result->written, result->read));
  }
  return level;
}

static void record_accesses(const struct Accesses *accesses, const struct Instruction *instruction, size_t level) {
  const struct OpcodeMetadata *metadata = opcode_metadata(instruction->opcode);
  for (int j = 0; j < opcode_arity(instruction->opcode); j++) {
    struct Access *operand = access_of(accesses, instruction->operands[j]);
    if (metadata->operands[j] != ROW_OF_PAST) operand->read = larger(operand->read, level);
  }
  if (opcode_has_result(instruction->opcode)) access_of(accesses, instruction->result)->written = level;
}

/* Returns the level of an instruction, above the given level, and records its accesses. */
static size_t level_of(const struct Accesses *accesses, const struct Instruction *instruction,
                       const struct SeparatedFunction *function, const struct LoopedBlocks *blocks, size_t level) {
  bool skips = instruction->opcode == SKIP;
  if (!skips && opcode_metadata(instruction->opcode)->result == BLOCK)
    return level_of_block(accesses, &blocks->items[instruction->result], instruction->opcode == FACTOR, level);
  const struct IrFunction *region = skips ? &function->regions[instruction->result].ir : NULL;
  level = level_before(accesses, instruction, level);
  for (size_t i = 0; skips && i < region->count; i++) level = level_before(accesses, &region->instructions[i], level);
  level++;
  record_accesses(accesses, instruction, level);
  for (size_t i = 0; skips && i < region->count; i++) record_accesses(accesses, &region->instructions[i], level);
  return level;
}

/*
 * True if the instruction may return. Such instructions keep their order, so that the first failing check is reported.
 */
static bool may_return(enum Opcode opcode) {
  return opcode == FACTOR || opcode_metadata(opcode)->result == NUMBER;
}

/* An instruction with its level, and its number in the function, by which equal ones keep their order. */
struct ScheduledInstruction {
  size_t level, number;
  uint32_t spaces;
  size_t form;  /* the number of the first instruction of its form */
  size_t chain; /* the number of the first instruction of a chain of sums; else its own */
  const struct Instruction *instruction;
};

static int compare(const void *first, const void *second) {
  const struct ScheduledInstruction *a = first, *b = second;
  if (a->level != b->level) return a->level < b->level ? -1 : 1;
  if (a->instruction->opcode != b->instruction->opcode) return a->instruction->opcode < b->instruction->opcode ? -1 : 1;
  if (a->instruction->function != b->instruction->function)
    return a->instruction->function < b->instruction->function ? -1 : 1;
  if (a->spaces != b->spaces) return a->spaces < b->spaces ? -1 : 1;
  if (a->form != b->form) return a->form < b->form ? -1 : 1;
  if (a->chain != b->chain) return a->chain < b->chain ? -1 : 1;
  return compare_sizes(&a->number, &b->number);
}

uint32_t spaces_of(const struct Instruction *instruction) {
  uint32_t spaces = opcode_has_result(instruction->opcode) ? space_of(instruction->result) : 0;
  for (int j = 0; j < opcode_arity(instruction->opcode); j++)
    spaces |= (uint32_t)space_of(instruction->operands[j]) << (j + 1) * SPACE_BITS;
  return spaces;
}

/* An instruction of a form. */
struct FormUse {
  uint32_t form;
  size_t number;
};

static int compare_uses(const void *first, const void *second) {
  const struct FormUse *a = first, *b = second;
  if (a->form != b->form) return a->form < b->form ? -1 : 1;
  return compare_sizes(&a->number, &b->number);
}

/* Returns the form of each instruction of a function, as the number of the first one of that form. */
static size_t *number_forms(const struct IrFunction *ir, const struct Forms *forms) {
  struct FormUse *uses = allocate(ir->count, sizeof *uses);
  size_t *number = allocate(ir->count, sizeof *number);
  for (size_t i = 0; i < ir->count; i++) uses[i] = (struct FormUse){form_of(forms, &ir->instructions[i]), i};
  if (ir->count > 0) qsort(uses, ir->count, sizeof *uses, compare_uses);
  for (size_t i = 0, first = 0; i < ir->count; i++) {
    if (uses[i].form != uses[first].form) first = i;
    number[uses[i].number] = uses[first].number;
  }
  release(uses);
  return number;
}

/* True if the instruction adds to a sum, its first operand. */
static bool adds_to_sum(const struct Instruction *instruction) {
  enum Opcode opcode = instruction->opcode;
  bool adds = opcode == SUM || opcode == DIFFERENCE || opcode == SERIES_SUM || opcode == SERIES_DIFFERENCE;
  return adds && space_of(instruction->operands[0]) == SPACE_LOCAL && space_of(instruction->result) == SPACE_LOCAL;
}

/* Sums of a function that are computed as chains in one run. */
struct Chains {
  size_t *before; /* of each instruction: 1 + that which computes the sum to which it adds; 0 for none */
  bool *is_long;  /* of each instruction: it belongs to a chain that is longer than chains of its form are many */
};

/*
 * Finds the chains. Many sums of one form, as for the points of a shape, are no chains: all first steps are a run, then
 * all second steps.
 */
static struct Chains chains_create(const struct IrFunction *ir, size_t local_count, const size_t *form) {
  struct Chains chains = {allocate(ir->count, sizeof *chains.before), allocate(ir->count, sizeof *chains.is_long)};
  size_t *writer = allocate(local_count, sizeof *writer), *length = allocate(ir->count, sizeof *length);
  size_t *count_of_form = allocate(ir->count, sizeof *count_of_form);
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    count_of_form[form[i]]++;
    size_t before = adds_to_sum(instruction) ? writer[index_in(instruction->operands[0])] : 0;
    bool continues = before > 0 && ir->instructions[before - 1].opcode == instruction->opcode;
    chains.before[i] = continues ? before : 0;
    length[i] = continues ? length[before - 1] + 1 : 1;
    if (opcode_has_result(instruction->opcode) && space_of(instruction->result) == SPACE_LOCAL)
      writer[index_in(instruction->result)] = i + 1;
  }
  for (size_t i = ir->count; i-- > 0;) {
    if (chains.before[i] == 0) continue;
    if (!chains.is_long[i]) chains.is_long[i] = length[i] > count_of_form[form[i]];
    chains.is_long[chains.before[i] - 1] |= chains.is_long[i];
  }
  release(writer);
  release(length);
  release(count_of_form);
  return chains;
}

/*
 * Puts an instruction into the level of the one that computes the sum to which it adds, so that it follows in the same
 * run. Returns false if the other operand is not ready.
 */
static bool continues_chain(const struct Accesses *accesses, const struct ScheduledInstruction *before,
                            struct ScheduledInstruction *added) {
  const struct Instruction *instruction = added->instruction;
  if (before->instruction->opcode != instruction->opcode || before->spaces != added->spaces ||
      access_of(accesses, instruction->operands[1])->written >= before->level)
    return false;
  added->level = before->level;
  added->form = before->form;
  added->chain = before->chain;
  record_accesses(accesses, instruction, added->level);
  return true;
}

size_t *schedule_create(const struct SeparatedFunction *function, const struct LoopedBlocks *blocks,
                        const struct Forms *forms) {
  const struct IrFunction *ir = &function->outer;
  struct Accesses accesses = accesses_create(function, blocks);
  struct ScheduledInstruction *scheduled = allocate(ir->count, sizeof *scheduled);
  size_t *order = allocate(ir->count, sizeof *order), *form = number_forms(ir, forms);
  struct Chains chains = chains_create(ir, accesses.count[SPACE_LOCAL], form);
  size_t last_check = 0;
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    bool checks = may_return(instruction->opcode);
    scheduled[i] = (struct ScheduledInstruction){
        .number = i, .spaces = spaces_of(instruction), .form = form[i], .chain = i, .instruction = instruction};
    size_t before = chains.is_long[i] ? chains.before[i] : 0;
    if (before == 0 || !continues_chain(&accesses, &scheduled[before - 1], &scheduled[i]))
      scheduled[i].level = level_of(&accesses, instruction, function, blocks, checks ? last_check : 0);
    if (checks) last_check = scheduled[i].level;
  }
  if (ir->count > 0) qsort(scheduled, ir->count, sizeof *scheduled, compare);
  for (size_t i = 0; i < ir->count; i++) order[i] = scheduled[i].number;
  for (int space = 0; space < SPACE_COUNT; space++) release(accesses.of[space]);
  release(scheduled);
  release(form);
  release(chains.before);
  release(chains.is_long);
  return order;
}

bool same_run(const struct Instruction *first, const struct Instruction *second) {
  return first->opcode != SKIP && first->opcode == second->opcode && first->function == second->function &&
         spaces_of(first) == spaces_of(second);
}
