#include "program/tables/forms.h"

#include "base/memory.h"

/* Joins a number to a hash, as in FNV-1a. */
static uint32_t join(uint32_t hash, uint32_t number) {
  return (hash ^ number) * 16777619u;
}

static bool is_row(Slot slot) {
  return space_of(slot) == SPACE_ROW;
}

static size_t rows_in(const struct IrFunction *ir) {
  size_t count = 0;
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (opcode_has_result(instruction->opcode) && is_row(instruction->result) && index_in(instruction->result) >= count)
      count = index_in(instruction->result) + 1;
    for (int j = 0; j < opcode_arity(instruction->opcode); j++)
      if (is_row(instruction->operands[j]) && index_in(instruction->operands[j]) >= count)
        count = index_in(instruction->operands[j]) + 1;
  }
  return count;
}

static uint32_t form_of_slot(const struct Forms *forms, Slot slot) {
  switch (space_of(slot)) {
  case SPACE_NUMBER:
  case SPACE_PARAMETER:
  case SPACE_PARAMETER_CONSTANTS: return (uint32_t)space_of(slot);
  case SPACE_LOCAL: return forms->of_local[index_in(slot)];
  case SPACE_ROW: return forms->of_row[index_in(slot)];
  default: return slot;
  }
}

uint32_t form_of(const struct Forms *forms, const struct Instruction *instruction) {
  uint32_t form = join(join(2166136261u, (uint32_t)instruction->opcode), (uint32_t)instruction->function);
  for (int j = 0; j < opcode_arity(instruction->opcode); j++)
    form = join(form, form_of_slot(forms, instruction->operands[j]));
  return form;
}

struct Forms forms_create(const struct IrFunction *ir) {
  struct Forms forms = {allocate(ir->local_count, sizeof(uint32_t)), allocate(rows_in(ir), sizeof(uint32_t))};
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (!opcode_has_result(instruction->opcode)) continue;
    uint32_t form = form_of(&forms, instruction);
    if (space_of(instruction->result) == SPACE_LOCAL) forms.of_local[index_in(instruction->result)] = form;
    if (is_row(instruction->result)) forms.of_row[index_in(instruction->result)] = form;
  }
  return forms;
}

void forms_release(struct Forms *forms) {
  release(forms->of_local);
  release(forms->of_row);
}
