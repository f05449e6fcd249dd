/*
 * A backward pass finds for each local variable the condition of the guards that use it, directly or through variables
 * with the same condition. Others are always needed, as are instructions that read arrays which change. A forward pass
 * delays the instructions of a region until a guard reads one of them. Variables are written once, so that a delay
 * changes nothing. Both passes are linear in the instructions, times the regions that are open.
 */
#include "program/codegen/regions.h"

#include "base/memory.h"

/* Conditions of variables without a use so far, and of those that are always needed; no slot has these values. */
static const Slot unused = UINT32_MAX, always = UINT32_MAX - 1;

/* A region with fewer instructions takes longer to skip than to compute. */
enum { FEW_INSTRUCTIONS = 8 };

/* True for spaces whose values stay the same while a function runs. */
static bool is_kept(enum Space space) {
  return space <= SPACE_LOCAL && space != SPACE_ACCELERATION;
}

/* True if the instruction computes a local variable from values that stay the same. */
static bool is_movable(const struct Instruction *instruction) {
  const struct OpcodeMetadata *metadata = opcode_metadata(instruction->opcode);
  bool is_kept_everywhere = metadata->result == VALUE && space_of(instruction->result) == SPACE_LOCAL;
  for (int i = 0; i < opcode_arity(instruction->opcode); i++)
    is_kept_everywhere &= metadata->operands[i] == VALUE && is_kept(space_of(instruction->operands[i]));
  return is_kept_everywhere;
}

/* Returns the condition of each instruction. */
static Slot *conditions_of(const struct IrFunction *ir) {
  Slot *needed = allocate(ir->local_count, sizeof *needed), *conditions = allocate(ir->count, sizeof *conditions);
  for (size_t i = 0; i < ir->local_count; i++) needed[i] = unused;
  for (size_t i = ir->count; i-- > 0;) {
    const struct Instruction *instruction = &ir->instructions[i];
    Slot own = is_movable(instruction) ? needed[index_in(instruction->result)] : always;
    if (own == unused) own = always;
    for (int j = 0; j < opcode_arity(instruction->opcode); j++) {
      if (space_of(instruction->operands[j]) != SPACE_LOCAL) continue;
      bool is_guarded = instruction->opcode == GUARD_OF && j == 1 && own == always;
      Slot condition = is_guarded ? instruction->operands[0] : own,
           *known = &needed[index_in(instruction->operands[j])];
      *known = *known == unused || *known == condition ? condition : always;
    }
    conditions[i] = own;
  }
  release(needed);
  return conditions;
}

size_t regions_length(const struct IrFunction *ir) {
  Slot *conditions = conditions_of(ir);
  size_t length = 0;
  for (size_t i = 0; i < ir->count; i++) length += conditions[i] != always;
  release(conditions);
  return length;
}

static void append(struct IrFunction *ir, struct Instruction instruction) {
  APPEND(ir->instructions, ir->count, instruction);
}

/* Returns the open region of a condition, the first of count; opens one if there is none. */
static struct Region *open_region(struct Region **regions, size_t *count, Slot condition) {
  for (size_t i = *count; i-- > 0;)
    if ((*regions)[i].condition == condition) return &(*regions)[i];
  APPEND(*regions, *count, (struct Region){.condition = condition});
  return &(*regions)[*count - 1];
}

/* Appends the instructions of a region in their place, or SKIP with the region if there are enough of them. */
static void close_region(struct SeparatedFunction *separated, struct Region *region) {
  if (region->ir.count < FEW_INSTRUCTIONS) {
    for (size_t i = 0; i < region->ir.count; i++) append(&separated->outer, region->ir.instructions[i]);
  } else {
    struct Instruction skip = {
        .opcode = SKIP, .result = (Slot)separated->region_count, .operands = {region->condition}};
    append(&separated->outer, skip);
    APPEND(separated->regions, separated->region_count, *region);
  }
  region->ir = (struct IrFunction){0};
}

/* Separates the regions of the instructions first .. end - 1. */
static struct SeparatedFunction separate_part(const struct IrFunction *ir, const Slot *conditions, size_t first,
                                              size_t end) {
  struct SeparatedFunction separated = {0};
  struct Region *open = NULL;
  size_t open_count = 0;
  for (size_t i = first; i < end; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (conditions[i] != always) {
      append(&open_region(&open, &open_count, conditions[i])->ir, *instruction);
      continue;
    }
    if (instruction->opcode == GUARD_OF)
      close_region(&separated, open_region(&open, &open_count, instruction->operands[0]));
    append(&separated.outer, *instruction);
  }
  for (size_t i = 0; i < open_count; i++) close_region(&separated, &open[i]); /* later parts have the guards */
  return separated;
}

void regions_separate(const struct IrFunction *ir, const size_t *ends, size_t count, struct SeparatedFunction *parts) {
  Slot *conditions = conditions_of(ir);
  for (size_t i = 0; i < count; i++) parts[i] = separate_part(ir, conditions, i > 0 ? ends[i - 1] : 0, ends[i]);
  release(conditions);
}
