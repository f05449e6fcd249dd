#include "write/instruction_tables.h"

#include "algebra/functions.h"
#include "base/memory.h"
#include "write/c_text.h"

static void write_functions(FILE *file, const struct Encoding *encoding, int arity, const char *type,
                            const char *name) {
  fprintf(file, "static Real (*const %s[])(%s) = {", name, type);
  for (enum Operation function = 0; function < OPERATION_COUNT; function++)
    if (encoding->function[function] > 0 && operation_arity(function) == arity)
      fprintf(file, "FUNCTION(%s), ", function_in_c(function));
  fputs("NULL};\n", file);
}

static void write_blocks(FILE *file, const struct Program *program) {
  fputs("static const struct BlockTable blocks[] = {\n", file);
  for (size_t i = 0; i < program->blocks.count; i++) {
    const struct LoopedBlock *looped = &program->blocks.items[i];
    fprintf(file, "    {%zu, %zu, %zu, ", looped->block->count, looped->first_mass, looped->first_right_side);
    if (block_is_full(looped->block)) fputs("NULL, NULL, ", file);
    else fprintf(file, "start%zu, column%zu, ", i, i);
    fprintf(file, "coordinate%zu, %s},\n", i,
            looped->block->force_count > 0        ? "nonsymmetric_factor, NULL, saddle_least_forces, nonsymmetric_solve"
            : looped->block->constraint_count > 0 ? "saddle_factor, saddle_solve, saddle_least_forces, NULL"
                                                  : "NULL, NULL, NULL, NULL");
  }
  fputs(program->blocks.count == 0 ? "    {0}};\n" : "};\n", file);
}

void instruction_tables_shared(FILE *file, const struct Encoding *encoding) {
  const struct Program *program = encoding->program;
  fputs("static const Real numbers[] = {", file);
  for (size_t i = 0; i < encoding->numbers.count; i++) {
    fputs("CONSTANT(", file);
    write_c_number(file, graph_value(program->model->graph, encoding->numbers.nodes[i]));
    fputs(i % 8 == 7 ? "),\n    " : "), ", file);
  }
  fputs("CONSTANT(0.0)};\n", file);
  write_functions(file, encoding, 1, "Real", "functions");
  write_functions(file, encoding, 2, "Real, Real", "functions_of_two");
  write_blocks(file, program);
  fprintf(file,
          "static const struct InstructionTables tables = {numbers, functions, functions_of_two, blocks, %zu, %zu, "
          "%zu};\n\n",
          encoding->local_count, program->blocks.mass_count, program->blocks.right_side_count);
}

static void write_words(FILE *file, const char *name, const struct WordList *words) {
  fprintf(file, "static const int32_t %s_code[] = {\n", name);
  for (size_t i = 0; i < words->count; i++) fprintf(file, i % 16 == 15 ? "%d,\n" : "%d,", words->items[i]);
  fputs("};\n", file);
  release(words->items);
}

static void write_table(FILE *file, const struct Encoding *encoding, const char *name, const struct IrFunction *ir) {
  struct WordList words = {0};
  encode(encoding, ir, &words);
  write_words(file, name, &words);
  fputs("\n", file);
}

static void begin_frame(FILE *file, bool has_seed) {
  fputs("  struct Frame frame = instructions_frame(&tables, point);\n", file);
  if (has_seed) fputs("  instructions_seed(&frame, seed);\n", file);
}

static void set_base(FILE *file, const char *space, const char *source) {
  fprintf(file, "  frame.base[SPACE_%s] = %s;\n", space, source);
}

/* Writes the head of a function and its frame. */
static void begin_function(FILE *file, const struct Encoding *encoding, enum FunctionName name,
                           const struct IrFunction *ir) {
  const struct Program *program = encoding->program;
  const struct GeneratedFunction *text = &generated_functions[name];
  write_head(file, name, "", ir->operation_count);
  if (!takes(name, "*point"))
    fprintf(file, "  const struct Point values = {.parameter = p%s};\n  const struct Point *point = &values;\n",
            takes(name, "*c,") ? ", .parameter_constants = c" : "");
  begin_frame(file, takes(name, "*seed"));
  set_base(file, "TARGET", text->target);
  if (text->accelerations == IN_ARGUMENT) set_base(file, "ACCELERATION", "(Real *)a");
  if (takes(name, "*da")) set_base(file, "SEED_ACCELERATION", "(Real *)da");
  if (takes(name, "*parameter_constants"))
    fprintf(file, "  frame.base[SPACE_LOCAL] = parameter_constants + %zu;\n", program->parameter_constants->count);
  if (text->accelerations == IN_TARGET)
    fprintf(file, "  frame.base[SPACE_ACCELERATION] = %s + %zu;\n", text->target, program->equations->count);
  if (name == FUNCTION_START) {
    set_base(file, "ROW", "*w");
    fprintf(file, "  frame.base[SPACE_MASS] = w[%zu];\n", program->series->mass_row);
  }
}

void instruction_tables_function(FILE *file, const struct Encoding *encoding, enum FunctionName name,
                                 const struct IrFunction *ir) {
  const struct GeneratedFunction *text = &generated_functions[name];
  write_table(file, encoding, text->name, ir);
  begin_function(file, encoding, name, ir);
  fprintf(file, "  %sinstructions_run(&frame, %s_code);\n}\n\n", text->returned == RETURNS_STATUS ? "return " : "",
          text->name);
}

/* Returns the name of the table of a part of two functions. */
static char *name_of_part(enum FunctionName first, enum FunctionName second, int part) {
  static const char *const suffixes[PAIR_PARTS] = {"", "_along", "_end", "_end"};
  return format_text("%s%s", generated_functions[part == PAIR_SECOND_END ? second : first].name, suffixes[part]);
}

/* Returns the further condition of the part of a function that does not depend on the direction. */
static const char *unless_repeated(enum FunctionName name) {
  if (takes(name, "*seed")) return " && !seed->repeats";
  return takes(name, "repeats") ? " && !repeats" : "";
}

void instruction_tables_pair(FILE *file, const struct Encoding *encoding, enum FunctionName first,
                             enum FunctionName second) {
  struct IrFunction *const *ir_functions = encoding->program->ir_functions;
  struct WordList words[PAIR_PARTS] = {0};
  bool is_single = second == first;
  encode_pair(encoding, ir_functions[first], is_single ? NULL : ir_functions[second], words);
  for (int part = 0; part < PAIR_PARTS; part++)
    if (words[part].count > 0) write_words(file, name_of_part(first, second, part), &words[part]);
  fputs("\n", file);
  for (int i = 0; i < (is_single ? 1 : 2); i++) {
    enum FunctionName name = i == 0 ? first : second;
    const int parts[] = {PAIR_STEADY, PAIR_COMMON, i == 0 ? PAIR_END : PAIR_SECOND_END};
    if (ir_functions[name] == NULL) continue;
    begin_function(file, encoding, name, ir_functions[name]);
    fputs("  int singular = 0;\n", file);
    for (int j = 0; j < 3; j++)
      if (words[parts[j]].count > 0)
        fprintf(file, "  if (singular == 0%s) singular = instructions_run(&frame, %s_code);\n",
                j == 0 ? unless_repeated(name) : "", name_of_part(first, second, parts[j]));
    fputs("  return singular;\n}\n\n", file);
  }
}

static void write_results(FILE *file, const struct Encoding *encoding, enum FunctionName name,
                          struct IrFunction *const *ir_functions, const struct ResultGroups *groups) {
  const struct GeneratedFunction *text = &generated_functions[name];
  struct IrTables tables = encode_all(encoding, ir_functions, groups);
  const char *type = tables.largest_slot <= UINT8_MAX ? "unsigned char" : "uint16_t";
  write_words(file, text->name, &tables.words);
  write_sizes(file, "uint32_t", format_text("%s_start", text->name), tables.start, groups->count);
  write_sizes(file, type, format_text("%s_slot", text->name), tables.slot, groups->count);
  fprintf(file, "\n/* %s; %zu operations in all */\nstatic Real %s(%s, size_t result) {\n", text->comment,
          tables.operation_count, text->name, text->arguments);
  begin_frame(file, takes(name, "*seed"));
  fprintf(file, "  Real value[%zu] = {REAL(NAN)};\n", tables.largest_slot + 1);
  set_base(file, "TARGET", "value");
  set_base(file, "ACCELERATION", "(Real *)a");
  if (takes(name, "*da")) set_base(file, "SEED_ACCELERATION", "(Real *)da");
  fprintf(file, "  instructions_run(&frame, %s_code + %s_start[result]);\n  return value[%s_slot[result]];\n}\n\n",
          text->name, text->name, text->name);
}

void instruction_tables_results(FILE *file, const struct Encoding *encoding) {
  size_t count = encoding->program->interface->result_count;
  if (count == 0) return;
  const struct ResultGroups alone = groups_of_one(count);
  write_results(file, encoding, FUNCTION_RESULT, encoding->program->result, &encoding->program->groups);
  write_results(file, encoding, FUNCTION_RESULT_ALONG, encoding->program->result_along, &alone);
}

static void set_rows(FILE *file) {
  fputs("  Series time = {point->time, REAL(1.0)};\n", file);
  set_base(file, "TIME_ROW", "time");
  set_base(file, "ROW", "(Real *)w");
  set_base(file, "STATE_ROW", "(Real *)x");
  set_base(file, "INPUT_ROW", "(Real *)input");
}

static void write_limit(FILE *file, const struct Encoding *encoding) {
  const struct LimitChecks *checks = &encoding->program->series->limit;
  fputs("static const struct LimitCheck limit_checks[] = {\n", file);
  for (size_t i = 0; i < checks->count; i++) {
    struct LimitCheck check = encoded_check(encoding, &checks->items[i]);
    fprintf(file, "    {%d, %u, %u, ", check.rule, check.row, check.other_row);
    if (check.function != NULL) write_c_string(file, check.function);
    else fputs("NULL", file);
    fputs(", ", file);
    write_c_number(file, check.share);
    fprintf(file, ", %u, %s, %u},\n", check.exponent, check.is_guarded ? "true" : "false", check.guard_condition);
  }
  fputs("};\n\n", file);
  write_head(file, FUNCTION_LIMIT, "", checks->count);
  begin_frame(file, false);
  set_rows(file);
  fprintf(file, "  instructions_limit(&frame, limit_checks, %zu, limit);\n}\n\n", checks->count);
}

void instruction_tables_series(FILE *file, const struct Encoding *encoding) {
  const struct SeriesProgram *series = encoding->program->series;
  instruction_tables_function(file, encoding, FUNCTION_START, series->start);
  write_table(file, encoding, "series", series->order);
  write_head(file, FUNCTION_SERIES, "", series->order->operation_count);
  begin_frame(file, false);
  set_rows(file);
  fprintf(file,
          "  frame.base[SPACE_MASS] = w[%zu];\n"
          "  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++) instructions_run_order(&frame, series_code, "
          "k);\n}\n\n",
          series->mass_row);
  if (series->limit.count > 0) write_limit(file, encoding);
}

void instruction_tables_output_series(FILE *file, const struct Encoding *encoding) {
  const struct SeriesProgram *series = encoding->program->output_series;
  write_table(file, encoding, "output_start", series->start);
  write_table(file, encoding, "output_series", series->order);
  write_head(file, FUNCTION_OUTPUT_SERIES, "", series->start->operation_count);
  begin_frame(file, false);
  set_rows(file);
  set_base(file, "TARGET_ROW", "*y");
  fputs("  instructions_run(&frame, output_start_code);\n"
        "  for (int k = 1; k <= order && k + 1 < SERIES_LENGTH; k++) instructions_run_order(&frame, "
        "output_series_code, k);\n}\n\n",
        file);
}
