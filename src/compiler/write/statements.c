#include "write/statements.h"

#include "base/memory.h"
#include "write/instruction_text.h"
#include "write/parts.h"

/* True if the function reads elements from .. to - 1 of the space. */
static bool reads(const struct IrFunction *ir, enum Space space, size_t from, size_t to) {
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    for (int j = 0; j < opcode_arity(instruction->opcode); j++) {
      Slot slot = instruction->operands[j];
      if (space_of(slot) == space && index_in(slot) >= from && index_in(slot) < to) return true;
    }
  }
  return false;
}

static void declare(FILE *file, bool is_used, const char *name, const char *source) {
  if (is_used) fprintf(file, "  const Real *%s = %s;\n", name, source);
}

void statements_declare_point(FILE *file, const struct Program *program, const struct IrFunction *ir) {
  size_t n = program->equations->count;
  declare(file, reads(ir, SPACE_STATE, 0, n), "q", "point->state");
  declare(file, reads(ir, SPACE_STATE, n, program->interface->state_count), "v", format_text("point->state + %zu", n));
  declare(file, ir_uses(ir, SPACE_INPUT), "u", "point->input");
  declare(file, ir_uses(ir, SPACE_PARAMETER), "p", "point->parameter");
  declare(file, ir_uses(ir, SPACE_PARAMETER_CONSTANTS), "c", "point->parameter_constants");
  declare(file, reads(ir, SPACE_SEED_STATE, 0, n), "dq", "seed->state");
  declare(file, reads(ir, SPACE_SEED_STATE, n, program->interface->state_count), "dv",
          format_text("seed->state + %zu", n));
  declare(file, ir_uses(ir, SPACE_SEED_INPUT), "du", "seed->input");
  declare(file, ir_uses(ir, SPACE_SEED_PARAMETER), "dp", "seed->parameter");
  declare(file, ir_uses(ir, SPACE_SEED_RESULT), "dy", "seed->result");
}

/* Declares the arrays of the blocks; functions of series keep the factors in w. */
static void declare_block_spaces(FILE *file, const struct Program *program, const struct IrFunction *ir) {
  if (ir_uses(ir, SPACE_RIGHT_SIDE)) fprintf(file, "  Real side[%zu];\n", program->blocks.right_side_count);
  if (!ir_uses(ir, SPACE_MASS)) return;
  if (ir_uses(ir, SPACE_ROW)) fprintf(file, "  Real *mass = w[%zu];\n", program->series->mass_row);
  else fprintf(file, "  Real mass[%zu];\n", program->blocks.mass_count);
}

void statements_function(FILE *file, const struct Program *program, enum FunctionName name, const char *suffix,
                         const struct IrFunction *ir) {
  const struct GeneratedFunction *text = &generated_functions[name];
  size_t n = program->equations->count;
  write_head(file, name, suffix, ir->operation_count);
  if (takes(name, "*point")) statements_declare_point(file, program, ir);
  if (ir_uses(ir, (enum Space)SPACE_SHARED)) fputs("  Real *s = point->work;\n", file);
  declare_block_spaces(file, program, ir);
  bool has_accelerations = ir_uses(ir, SPACE_ACCELERATION);
  if (text->accelerations == IN_TARGET && has_accelerations) fprintf(file, "  Real *a = %s + %zu;\n", text->target, n);
  if (text->accelerations == IN_WORKSPACE && has_accelerations)
    fprintf(file, "  Real a[%zu];\n", row_count(program->equations));
  write_statements(file, program, ir, text->target);
  fputs(text->returned == RETURNS_STATUS ? "  return 0;\n}\n\n" : "}\n\n", file);
}

size_t statements_in_parts(FILE *file, const struct Program *program, enum FunctionName name) {
  const struct GeneratedFunction *text = &generated_functions[name];
  bool keeps_accelerations = text->accelerations == IN_WORKSPACE;
  struct Parts parts = parts_of(program->ir_functions[name], keeps_accelerations ? row_count(program->equations) : 0);
  if (parts.count == 1) {
    statements_function(file, program, name, "", parts.items[0]);
    return 0;
  }
  for (size_t i = 0; i < parts.count; i++)
    statements_function(file, program, name, format_text("_%zu", i + 1), parts.items[i]);
  write_head(file, name, "", program->ir_functions[name]->operation_count);
  /* called by address, as compilers inline functions with a single call */
  fprintf(file, "  static int (*const parts[])(%s) = {", text->arguments);
  for (size_t i = 0; i < parts.count; i++) fprintf(file, "%s_%zu, ", text->name, i + 1);
  const char *first = parts.steady_count > 0 ? format_text("seed->repeats ? %zu : 0", parts.steady_count) : "0";
  const char *seed = takes(name, "*seed") ? "seed, " : "";
  fprintf(file,
          "};\n  int singular = 0;\n  for (int i = %s; i < %zu && singular == 0; i++)\n"
          "    singular = parts[i](point, %s%s);\n  return singular;\n}\n\n",
          first, parts.count, seed, text->target);
  return parts.shared_count;
}

/* Returns the number of results in a group. */
static size_t size_of_group(const struct Program *program, size_t leader) {
  const struct ResultGroups *groups = &program->groups;
  size_t size = 0;
  for (size_t i = leader; i < groups->count; i++) size += groups->leader[i] == leader;
  return size;
}

/* Writes the function of a group, and one that returns one of its results. */
static void write_group(FILE *file, const struct Program *program, size_t first, size_t size, const char *suffix) {
  statements_function(file, program, FUNCTION_RESULTS, suffix, program->result[first]);
  fprintf(file,
          "static Real result%s(const struct Point *point, const Real *a, size_t slot) {\n  Real value[%zu];\n"
          "  results%s(point, a, value);\n  return value[slot];\n}\n\n",
          suffix, size, suffix);
}

static void write_result(FILE *file, const struct Program *program, size_t first) {
  size_t size = size_of_group(program, first);
  char *suffix = format_text("%zu", first);
  if (size > 1) write_group(file, program, first, size, suffix);
  else statements_function(file, program, FUNCTION_RESULT, suffix, program->result[first]);
}

static void begin_choice(FILE *file, enum FunctionName name) {
  const struct GeneratedFunction *text = &generated_functions[name];
  fprintf(file, "static Real %s(%s, size_t result) {\n  switch (result) {\n", text->name, text->arguments);
}

static void end_choice(FILE *file) {
  fputs("  default: return REAL(NAN);\n  }\n}\n\n", file);
}

void statements_results(FILE *file, const struct Program *program) {
  size_t count = program->interface->result_count;
  if (count == 0) return;
  for (size_t i = 0; i < count; i++)
    if (program->groups.leader[i] == i) write_result(file, program, i);
  begin_choice(file, FUNCTION_RESULT);
  for (size_t i = 0; i < count; i++) {
    size_t leader = program->groups.leader[i];
    fprintf(file, "  case %zu: return result%zu(point, a", i, leader);
    if (size_of_group(program, leader) > 1) fprintf(file, ", %zu", program->groups.slot[i]);
    fputs(");\n", file);
  }
  end_choice(file);
  for (size_t i = 0; i < count; i++) {
    if (program->result_along[i] == NULL) continue;
    statements_function(file, program, FUNCTION_RESULT_ALONG, format_text("%zu", i), program->result_along[i]);
  }
  begin_choice(file, FUNCTION_RESULT_ALONG);
  for (size_t i = 0; i < count; i++)
    if (program->result_along[i] != NULL)
      fprintf(file, "  case %zu: return result_along%zu(point, seed, a, da);\n", i, i);
  end_choice(file);
}
