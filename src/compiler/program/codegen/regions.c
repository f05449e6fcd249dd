/*
 * Variables are local ones, and the rows of a series. A backward pass finds the condition of the guards that use a
 * variable, directly or through others with the same condition. Others are always needed, as are instructions that read
 * arrays which change. In series, an instruction may read what a later one computed at the order before, and the pass is
 * repeated until nothing changes. A forward pass delays the instructions of a region until a guard reads one of
 * them. Variables are written once, so that a delay changes nothing. A pass is linear in the instructions, times the
 * regions that are open.
 */
#include "program/codegen/regions.h"

#include "base/memory.h"

/* Conditions of variables without a use so far, and of those that are always needed; no slot has these values. */
static const Slot unused = UINT32_MAX, always = UINT32_MAX - 1;

/* A region with fewer instructions takes longer to skip than to compute. */
enum { FEW_INSTRUCTIONS = 8 };

/* The conditions of a function's variables. */
struct Conditions {
  Slot *local, *row;
};

/* Returns where the condition of a variable is; NULL for slots that are none. */
static Slot *condition_of(const struct Conditions *conditions, Slot slot) {
  if (space_of(slot) == SPACE_LOCAL) return &conditions->local[index_in(slot)];
  return space_of(slot) == SPACE_ROW && conditions->row != NULL ? &conditions->row[index_in(slot)] : NULL;
}

/* True for spaces whose values, or whose coefficients up to the present order, stay the same while a function runs. */
static bool is_kept(enum Space space) {
  return (space <= SPACE_LOCAL && space != SPACE_ACCELERATION) || (space >= SPACE_ROW && space <= SPACE_TIME_ROW);
}

/* True if the instruction computes a variable from values that stay the same. */
static bool is_movable(const struct Conditions *conditions, const struct Instruction *instruction) {
  bool is_movable = opcode_has_result(instruction->opcode) && condition_of(conditions, instruction->result) != NULL;
  for (int i = 0; i < opcode_arity(instruction->opcode); i++) is_movable &= is_kept(space_of(instruction->operands[i]));
  return is_movable;
}

/* Joins the condition of a further use to that of a variable. */
static void join(Slot *known, Slot condition) {
  if (condition == unused) return;
  *known = *known == unused || *known == condition ? condition : always;
}

static bool is_guard(const struct Instruction *instruction) {
  return instruction->opcode == GUARD_OF || instruction->opcode == SERIES_GUARD;
}

/* Returns the condition under which an instruction is needed. */
static Slot condition_of_instruction(const struct Conditions *conditions, const struct Instruction *instruction) {
  return is_movable(conditions, instruction) ? *condition_of(conditions, instruction->result) : always;
}

/* Hands the conditions of results on to operands, from the last instruction to the first. True if any changed. */
static bool hand_on(const struct IrFunction *ir, const struct Conditions *conditions) {
  bool changed = false;
  for (size_t i = ir->count; i-- > 0;) {
    const struct Instruction *instruction = &ir->instructions[i];
    Slot own = condition_of_instruction(conditions, instruction);
    for (int j = 0; j < opcode_arity(instruction->opcode); j++) {
      Slot *known = condition_of(conditions, instruction->operands[j]);
      if (known == NULL) continue;
      Slot before = *known;
      join(known, is_guard(instruction) && j == 1 && own == always ? instruction->operands[0] : own);
      changed |= *known != before;
    }
  }
  return changed;
}

/* Finds the conditions of all variables; those without a use are always needed, as a row that only a limit reads. */
static void find_conditions(const struct IrFunction *ir, const struct Conditions *conditions, size_t row_count) {
  while (hand_on(ir, conditions)) continue;
  for (size_t i = 0; i < ir->local_count; i++)
    if (conditions->local[i] == unused) conditions->local[i] = always;
  for (size_t i = 0; i < row_count; i++)
    if (conditions->row[i] == unused) conditions->row[i] = always;
  while (hand_on(ir, conditions)) continue;
}

static Slot *unused_variables(size_t count) {
  Slot *conditions = allocate(count, sizeof *conditions);
  for (size_t i = 0; i < count; i++) conditions[i] = unused;
  return conditions;
}

Slot *regions_rows_create(size_t count) {
  return unused_variables(count);
}

void regions_need_row(Slot *row_conditions, size_t row, const Slot *condition) {
  join(&row_conditions[row], condition != NULL ? *condition : always);
}

void regions_find_rows(const struct IrFunction *order, Slot *row_conditions, size_t row_count) {
  struct Conditions conditions = {unused_variables(order->local_count), row_conditions};
  find_conditions(order, &conditions, row_count);
  release(conditions.local);
}

/* Returns the condition of each instruction. */
static Slot *conditions_of(const struct IrFunction *ir) {
  struct Conditions conditions = {unused_variables(ir->local_count), ir->row_conditions};
  Slot *of_instruction = allocate(ir->count, sizeof *of_instruction);
  find_conditions(ir, &conditions, 0);
  for (size_t i = 0; i < ir->count; i++)
    of_instruction[i] = condition_of_instruction(&conditions, &ir->instructions[i]);
  release(conditions.local);
  return of_instruction;
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
    release(region->ir.instructions);
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
    if (is_guard(instruction)) close_region(&separated, open_region(&open, &open_count, instruction->operands[0]));
    append(&separated.outer, *instruction);
  }
  for (size_t i = 0; i < open_count; i++) close_region(&separated, &open[i]); /* later parts have the guards */
  release(open);
  return separated;
}

void regions_separate(const struct IrFunction *ir, const size_t *ends, size_t count, struct SeparatedFunction *parts) {
  Slot *conditions = conditions_of(ir);
  for (size_t i = 0; i < count; i++) parts[i] = separate_part(ir, conditions, i > 0 ? ends[i - 1] : 0, ends[i]);
  release(conditions);
}

void regions_release(struct SeparatedFunction *parts, size_t count) {
  for (size_t i = 0; i < count; i++) {
    for (size_t j = 0; j < parts[i].region_count; j++) release(parts[i].regions[j].ir.instructions);
    release(parts[i].outer.instructions);
    release(parts[i].regions);
  }
}
