#include "write/instruction_text.h"

#include "algebra/functions.h"
#include "base/memory.h"
#include "write/c_text.h"
#include "write/parts.h"

/* Names of the arrays; other spaces are scalars or have two arrays. */
static const char *const arrays[SPACE_COUNT] = {
    [SPACE_PARAMETER] = "p",    [SPACE_PARAMETER_CONSTANTS] = "c", [SPACE_INPUT] = "u",
    [SPACE_ACCELERATION] = "a", [SPACE_SEED_PARAMETER] = "dp",     [SPACE_SEED_INPUT] = "du",
    [SPACE_MASS] = "mass",      [SPACE_SEED_ACCELERATION] = "da",  [SPACE_RIGHT_SIDE] = "side",
    [SPACE_ROW] = "w",          [SPACE_STATE_ROW] = "x",           [SPACE_INPUT_ROW] = "input",
    [SPACE_TARGET_ROW] = "y",   [SPACE_SEED_RESULT] = "dy",
};

static void write_state(FILE *file, const struct Program *program, const char *direction, size_t index) {
  size_t n = program->equations->count;
  if (index < n) fprintf(file, "%sq[%zu]", direction, index);
  else fprintf(file, "%sv[%zu]", direction, index - n);
}

void write_slot(FILE *file, const struct Program *program, Slot slot, enum Role role, const char *target) {
  static const char *const elements[] = {
      [VALUE] = "[0]",    [COEFFICIENT] = "[k]",          [ROW] = "",
      [ROW_OF_PAST] = "", [NEXT_COEFFICIENT] = "[k + 1]", [PAST_COEFFICIENT] = "[k - 1]"};
  enum Space space = space_of(slot);
  size_t index = index_in(slot);
  if ((int)space == SPACE_SHARED) {
    fprintf(file, "s[%zu]", index);
    return;
  }
  switch (space) {
  case SPACE_NUMBER: write_c_number(file, graph_value(program->model->graph, (Node)index)); return;
  case SPACE_STATE: write_state(file, program, "", index); return;
  case SPACE_SEED_STATE: write_state(file, program, "d", index); return;
  case SPACE_TIME: fputs("point->time", file); return;
  case SPACE_SEED_TIME: fputs("seed->time", file); return;
  case SPACE_LOCAL: fprintf(file, role == COEFFICIENT ? "s%zu" : "t%zu", index); return;
  case SPACE_TARGET: fprintf(file, "%s[%zu]", target, index); return;
  case SPACE_TIME_ROW: fputs("time", file); break;
  default: fprintf(file, "%s[%zu]", arrays[space], index); break;
  }
  if (space >= SPACE_ROW) fputs(elements[role], file);
}

/* True if all operands are constants; REAL() then makes the result a vector for ensembles. */
static bool has_only_numbers(const struct Instruction *instruction) {
  int arity = opcode_has_result(instruction->opcode) ? opcode_arity(instruction->opcode) : 0;
  for (int i = 0; i < arity; i++)
    if (space_of(instruction->operands[i]) != SPACE_NUMBER) return false;
  return arity > 0;
}

/* Writes a text of opcode_metadata() with the operands of an instruction. */
static void write_text(FILE *file, const struct Program *program, const struct Instruction *instruction,
                       const char *text, const char *target, const char *opening) {
  const struct OpcodeMetadata *metadata = opcode_metadata(instruction->opcode);
  for (; *text != '\0'; text++) {
    if (*text != '$') {
      fputc(*text, file);
      continue;
    }
    text++;
    if (*text == 'f') fputs(function_in_c(instruction->function), file);
    else if (*text == '(') fputs(opening, file);
    else if (*text == '0' && metadata->result == NUMBER) fprintf(file, "%u", instruction->result);
    else if (*text == '0') write_slot(file, program, instruction->result, metadata->result, target);
    else write_slot(file, program, instruction->operands[*text - '1'], metadata->operands[*text - '1'], target);
  }
}

static void write_expression(FILE *file, const struct Program *program, const struct Instruction *instruction,
                             const char *target, const char *opening) {
  bool is_number = has_only_numbers(instruction);
  if (is_number) fputs("REAL(", file);
  write_text(file, program, instruction, opcode_metadata(instruction->opcode)->statement, target, opening);
  if (is_number) fputs(")", file);
}

/* Writes the start of a call: size and pattern of the block, its row numbers if takes_rows, and its elements. */
static void write_block_call(FILE *file, const struct Program *program, const char *function, bool takes_rows,
                             size_t number) {
  const struct LoopedBlock *looped = &program->blocks.items[number];
  fprintf(file, "%s(%zu, ", function, looped->block->count);
  if (block_is_full(looped->block)) fputs("NULL, NULL", file);
  else fprintf(file, "start%zu, column%zu", number, number);
  if (takes_rows) fprintf(file, ", coordinate%zu", number);
  fprintf(file, ", mass + %zu", looped->first_mass);
}

/* Writes the start of a call for a small block, with its elements one by one. */
static void write_small_factor_call(FILE *file, const struct Program *program, unsigned number) {
  const struct LoopedBlock *looped = &program->blocks.items[number];
  fprintf(file, "factor%u(mass + %zu", number, looped->first_mass);
  for (size_t i = 0; i < looped->place_count; i++) fprintf(file, ", mass[%zu]", looped->given + i);
}

static void write_block_statement(FILE *file, const struct Program *program, const struct Instruction *instruction) {
  unsigned number = instruction->result;
  const struct InertiaBlock *block = program->blocks.items[number].block;
  bool has_constraints = block->constraint_count > 0, is_nonsymmetric = block->force_count > 0;
  if (instruction->opcode == FACTOR) {
    fprintf(file, "const size_t singular%u = ", number);
    const char *factor = is_nonsymmetric ? "nonsymmetric_factor" : has_constraints ? "saddle_factor" : "ldlt_factor";
    if (program_solves_by_statements(program, number)) write_small_factor_call(file, program, number);
    else write_block_call(file, program, factor, has_constraints, number);
    fprintf(file, ");\n  if (singular%u != 0) return coordinate%u[singular%u - 1]", number, number, number);
  } else {
    bool is_least = instruction->opcode == LEAST_FORCES;
    if (!is_least && program_solves_by_statements(program, number)) {
      const struct LoopedBlock *looped = &program->blocks.items[number];
      fprintf(file, "solve%u(mass + %zu, side + %zu)", number, looped->first_mass, looped->first_right_side);
      return;
    }
    const char *solve = is_nonsymmetric ? "nonsymmetric_solve" : has_constraints ? "saddle_solve" : "ldlt_solve";
    write_block_call(file, program, is_least ? "saddle_least_forces" : solve, is_least || is_nonsymmetric, number);
    fprintf(file, ", side + %zu)", program->blocks.items[number].first_right_side);
  }
}

static void write_statement(FILE *file, const struct Program *program, const struct Instruction *instruction,
                            const char *target, const char *opening) {
  const struct OpcodeMetadata *metadata = opcode_metadata(instruction->opcode);
  if (metadata->result == BLOCK) {
    write_block_statement(file, program, instruction);
    return;
  }
  if (metadata->result != NUMBER && space_of(instruction->result) == SPACE_TARGET && target == NULL)
    fputs("return ", file);
  else if (metadata->result != NUMBER) {
    if (space_of(instruction->result) == SPACE_LOCAL) fputs("const Real ", file);
    write_slot(file, program, instruction->result, metadata->result == ROW ? COEFFICIENT : metadata->result, target);
    fputs(" = ", file);
  }
  write_expression(file, program, instruction, target, opening);
}

void write_statements(FILE *file, const struct Program *program, const struct IrFunction *ir, const char *target) {
  for (size_t i = 0; i < ir->count; i++) {
    fputs("  ", file);
    write_statement(file, program, &ir->instructions[i], target, "(");
    fputs(";\n", file);
  }
}

static bool is_product(const struct Instruction *instruction) {
  return opcode_factors(instruction->opcode) != NULL;
}

void write_statements_around(FILE *file, const struct Program *program, const struct IrFunction *ir) {
  size_t products = 0;
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    const char *opening = "(";
    if (is_product(instruction) && program->products == PRODUCTS_LISTED) opening = "_around(*next++, ";
    else if (is_product(instruction)) opening = format_text("_around(m[%zu], ", products++);
    fputs("    ", file);
    write_statement(file, program, instruction, NULL, opening);
    fputs(";\n", file);
  }
}

size_t write_products(FILE *file, const struct Program *program, const struct IrFunction *ir) {
  size_t products = 0;
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (!is_product(instruction)) continue;
    if (products == 0)
      fputs("/* The products of an order: their number and factors */\n#define SERIES_PRODUCTS(EACH)", file);
    fprintf(file, " \\\n  EACH(%zu, ", products++);
    write_text(file, program, instruction, opcode_factors(instruction->opcode), NULL, "(");
    fputs(")", file);
  }
  if (products > 0) fputs("\n\n", file);
  return products;
}

size_t write_factors(FILE *file, const struct Program *program, const struct IrFunction *ir) {
  size_t products = 0;
  fputs("  const struct SeriesFactors factors[] = {\n", file);
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (!is_product(instruction)) continue;
    fputs("      SERIES_FACTORS(", file);
    write_text(file, program, instruction, opcode_factors(instruction->opcode), NULL, "(");
    fputs(")\n", file);
    products++;
  }
  fputs("  };\n", file);
  return products;
}
