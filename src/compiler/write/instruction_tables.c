#include "write/instruction_tables.h"

#include "algebra/functions.h"
#include "base/memory.h"
#include "write/c_text.h"
#include "write/instruction_text.h"
#include "write/schedule.h"

static void add_number(struct TableContext *context, Node node) {
  if (context->number[node] > 0) return;
  append_node(&context->numbers, node);
  context->number[node] = context->numbers.count;
}

/* Whether it is written as a table where the program is. */
static bool is_in_tables(const struct Program *program, enum FunctionName name) {
  if (name == FUNCTION_START || name == FUNCTION_SERIES) return program->series_is_table;
  return generated_functions[name].group != IN_SWITCHES;
}

/* Notes the numbers and functions that a routine uses. */
static void note(void *target, enum FunctionName name, const struct Routine *routine) {
  struct TableContext *context = target;
  if (!is_in_tables(context->program, name)) return;
  for (size_t i = 0; i < routine->count; i++) {
    const struct Instruction *instruction = &routine->instructions[i];
    if (instruction->opcode == CALL || instruction->opcode == CALL_OF_TWO) context->function[instruction->function] = 1;
    for (int j = 0; j < opcode_arity(instruction->opcode); j++)
      if (space_of(instruction->operands[j]) == SPACE_NUMBER)
        add_number(context, (Node)index_in(instruction->operands[j]));
  }
}

static void note_limit(struct TableContext *context, const struct SeriesProgram *series) {
  for (size_t i = 0; series != NULL && i < series->limit.count; i++) {
    const struct LimitCheck *check = &series->limit.items[i];
    if (limit_facts(check->rule)->has_exponent && space_of(check->exponent) == SPACE_NUMBER)
      add_number(context, (Node)index_in(check->exponent));
  }
}

struct TableContext *table_context_create(const struct Program *program) {
  struct TableContext *context = allocate(1, sizeof *context);
  *context =
      (struct TableContext){.program = program, .number = allocate(program->model->graph->count, sizeof(size_t))};
  program_visit(program, note, context);
  if (program->series_is_table) note_limit(context, program->series);
  size_t count[3] = {0};
  for (enum Operation function = 0; function < OPERATION_COUNT; function++)
    if (context->function[function] > 0) context->function[function] = ++count[operation_arity(function)];
  return context;
}

static void write_functions(FILE *file, const struct TableContext *context, int arity, const char *type,
                            const char *name) {
  fprintf(file, "static double (*const %s[])(%s) = {", name, type);
  for (enum Operation function = 0; function < OPERATION_COUNT; function++)
    if (context->function[function] > 0 && operation_arity(function) == arity)
      fprintf(file, "%s, ", function_in_c(function));
  fputs("NULL};\n", file);
}

/* Those of prepare() stand behind what it computes, and statements have theirs. */
static void find_most_locals(void *context, enum FunctionName name, const struct Routine *routine) {
  size_t *most = context;
  bool has_own = name == FUNCTION_PREPARE || generated_functions[name].group == IN_SWITCHES;
  if (!has_own && routine->local_count > *most) *most = routine->local_count;
}

/* The local variables of the routine that has most. */
static size_t local_count(const struct Program *program) {
  size_t count = 0;
  program_visit(program, find_most_locals, &count);
  return count;
}

size_t instruction_tables_work_count(const struct TableContext *context) {
  const struct Program *program = context->program;
  size_t rows = row_count(program->equations);
  return local_count(program) + program->blocks.mass_count + program->blocks.side_count + rows;
}

static void write_blocks(FILE *file, const struct Program *program) {
  fputs("static const struct BlockTable blocks[] = {\n", file);
  for (size_t i = 0; i < program->blocks.count; i++) {
    const struct LoopedBlock *looped = &program->blocks.items[i];
    fprintf(file, "    {%zu, %zu, %zu, ", looped->block->count, looped->first_mass, looped->first_side);
    if (block_is_full(looped->block)) fputs("NULL, NULL, ", file);
    else fprintf(file, "start%zu, column%zu, ", i, i);
    fprintf(file, "coordinate%zu, %s},\n", i,
            looped->block->force_count > 0        ? "oblique_factor, NULL, saddle_least_forces, oblique_solve"
            : looped->block->constraint_count > 0 ? "saddle_factor, saddle_solve, saddle_least_forces, NULL"
                                                  : "NULL, NULL, NULL, NULL");
  }
  fputs(program->blocks.count == 0 ? "    {0}};\n" : "};\n", file);
}

void instruction_tables_shared(FILE *file, const struct TableContext *context) {
  const struct Program *program = context->program;
  fputs("static const double numbers[] = {", file);
  for (size_t i = 0; i < context->numbers.count; i++) {
    write_c_number(file, graph_value(program->model->graph, context->numbers.nodes[i]));
    fputs(i % 8 == 7 ? ",\n    " : ", ", file);
  }
  fputs("0.0};\n", file);
  write_functions(file, context, 1, "double", "functions");
  write_functions(file, context, 2, "double, double", "functions_of_two");
  write_blocks(file, program);
  fprintf(file,
          "static const struct InstructionTables tables = {numbers, functions, functions_of_two, blocks, %zu, %zu, "
          "%zu};\n\n",
          local_count(program), program->blocks.mass_count, program->blocks.side_count);
}

/* The index of a place in its space, as tables count it. */
static uint32_t index_of(const struct TableContext *context, Place place) {
  enum Space space = space_of(place);
  size_t index = index_in(place);
  if (space == SPACE_NUMBER) return (uint32_t)context->number[index] - 1;
  return (uint32_t)(space >= SPACE_ROW && space != SPACE_TIME_ROW ? index * SERIES_LENGTH : index);
}

static uint32_t encoded(const struct TableContext *context, Place place) {
  return place_in(space_of(place), index_of(context, place));
}

/* Writes numbers in lines. */
struct CodeLine {
  FILE *file;
  size_t count;
};

static void write_word(struct CodeLine *line, uint32_t word) {
  fprintf(line->file, line->count++ % 16 == 15 ? "%u,\n" : "%u,", word);
}

/* The instructions first .. end - 1 of the schedule, which are one run. */
static void write_run(struct CodeLine *line, const struct TableContext *context, const struct Routine *routine,
                      const size_t *schedule, size_t first, size_t end) {
  const struct Instruction *instructions = routine->instructions;
  enum Opcode opcode = instructions[schedule[first]].opcode;
  write_word(line, opcode);
  write_word(line, (uint32_t)(end - first));
  write_word(line, spaces_of(&instructions[schedule[first]]));
  if (opcode == CALL || opcode == CALL_OF_TWO)
    write_word(line, (uint32_t)context->function[instructions[schedule[first]].function] - 1);
  for (size_t i = first; i < end; i++) {
    const struct Instruction *instruction = &instructions[schedule[i]];
    write_word(line, opcode_has_result(opcode) ? index_of(context, instruction->result) : instruction->result);
    for (int j = 0; j < opcode_arity(opcode); j++) write_word(line, index_of(context, instruction->operands[j]));
  }
}

/* The table of a routine, with its END. */
static void write_code(struct CodeLine *line, const struct TableContext *context, const struct Routine *routine) {
  size_t *schedule = schedule_create(routine, &context->program->blocks);
  for (size_t first = 0, end = 0; first < routine->count; first = end) {
    const struct Instruction *instruction = &routine->instructions[schedule[first]];
    while (end < routine->count && same_run(instruction, &routine->instructions[schedule[end]])) end++;
    write_run(line, context, routine, schedule, first, end);
  }
  write_word(line, END);
}

static void write_table(FILE *file, const struct TableContext *context, const char *name,
                        const struct Routine *routine) {
  struct CodeLine line = {.file = file};
  fprintf(file, "static const uint32_t %s_code[] = {\n", name);
  write_code(&line, context, routine);
  fputs("};\n\n", file);
}

static void begin_frame(FILE *file, bool has_seed) {
  fputs("  struct Frame frame = instructions_frame(&tables, point);\n", file);
  if (has_seed) fputs("  instructions_seed(&frame, seed);\n", file);
}

static void set_base(FILE *file, const char *space, const char *source) {
  fprintf(file, "  frame.base[SPACE_%s] = %s;\n", space, source);
}

void instruction_tables_function(FILE *file, const struct TableContext *context, enum FunctionName name,
                                 const struct Routine *routine) {
  const struct Program *program = context->program;
  const struct GeneratedFunction *text = &generated_functions[name];
  write_table(file, context, text->name, routine);
  write_head(file, name, "", routine->operation_count);
  if (!takes(name, "*point"))
    fprintf(file, "  const struct Point values = {.parameter = p%s};\n  const struct Point *point = &values;\n",
            takes(name, "*c,") ? ", .prepared = c" : "");
  begin_frame(file, takes(name, "*seed"));
  set_base(file, "TARGET", text->target);
  if (takes(name, "*da")) set_base(file, "SEED_ACCELERATION", "(double *)da");
  if (takes(name, "*prepared"))
    fprintf(file, "  frame.base[SPACE_LOCAL] = prepared + %zu;\n", program->prepared->count);
  if (text->accelerations == IN_TARGET)
    fprintf(file, "  frame.base[SPACE_ACCELERATION] = %s + %zu;\n", text->target, program->equations->count);
  if (name == FUNCTION_START) {
    set_base(file, "ROW", "*w");
    fprintf(file, "  frame.base[SPACE_MASS] = w[%zu];\n", program->series->mass_row);
  }
  fprintf(file, "  %sinstructions_run(&frame, %s_code);\n}\n\n", text->returned == RETURNS_STATUS ? "return " : "",
          text->name);
}

/* leader: of each result, the first of those that one routine computes, whose places follow from it. */
static void write_results(FILE *file, const struct TableContext *context, enum FunctionName name,
                          struct Routine *const *routines, const size_t *leader, size_t count) {
  const struct GeneratedFunction *text = &generated_functions[name];
  struct CodeLine line = {.file = file};
  size_t *start = allocate(count, sizeof *start), *place = allocate(count, sizeof *place), operations = 0, largest = 0;
  fprintf(file, "static const uint32_t %s_code[] = {\n", text->name);
  for (size_t i = 0; i < count; i++) {
    start[i] = leader[i] < i ? start[leader[i]] : line.count;
    place[i] = i - leader[i];
    if (place[i] > largest) largest = place[i];
    if (routines[i] == NULL) continue;
    write_code(&line, context, routines[i]);
    operations += routines[i]->operation_count;
  }
  write_word(&line, END);
  fputs("};\n", file);
  write_sizes(file, "uint32_t", format_text("%s_start", text->name), start, count);
  write_sizes(file, "unsigned char", format_text("%s_place", text->name), place, count);
  fprintf(file, "\n/* %s; %zu operations for all of them */\nstatic double %s(%s, size_t result) {\n", text->comment,
          operations, text->name, text->arguments);
  begin_frame(file, takes(name, "*seed"));
  fprintf(file, "  double value[%zu] = {NAN};\n", largest + 1);
  set_base(file, "TARGET", "value");
  set_base(file, "ACCELERATION", "(double *)a");
  if (takes(name, "*da")) set_base(file, "SEED_ACCELERATION", "(double *)da");
  fprintf(file, "  instructions_run(&frame, %s_code + %s_start[result]);\n  return value[%s_place[result]];\n}\n\n",
          text->name, text->name, text->name);
}

void instruction_tables_results(FILE *file, const struct TableContext *context) {
  size_t count = context->program->interface->result_count;
  if (count == 0) return;
  size_t *alone = allocate(count, sizeof *alone);
  for (size_t i = 0; i < count; i++) alone[i] = i;
  write_results(file, context, FUNCTION_RESULT, context->program->result, context->program->leader, count);
  write_results(file, context, FUNCTION_RESULT_ALONG, context->program->result_along, alone, count);
}

static void set_rows(FILE *file) {
  fputs("  Series time = {point->time, 1.0};\n", file);
  set_base(file, "TIME_ROW", "time");
  set_base(file, "ROW", "(double *)w");
  set_base(file, "STATE_ROW", "(double *)x");
  set_base(file, "INPUT_ROW", "(double *)input");
}

static void write_limit(FILE *file, const struct TableContext *context) {
  const struct LimitChecks *checks = &context->program->series->limit;
  fputs("static const struct LimitCheck limit_checks[] = {\n", file);
  for (size_t i = 0; i < checks->count; i++) {
    const struct LimitCheck *check = &checks->items[i];
    const struct LimitFacts *facts = limit_facts(check->rule);
    fprintf(file, "    {%d, %u, %u, ", check->rule, encoded(context, check->row),
            facts->has_two_rows ? encoded(context, check->other_row) : 0u);
    if (facts->has_function) write_c_string(file, check->function);
    else fputs("NULL", file);
    fputs(", ", file);
    write_c_number(file, check->share);
    fprintf(file, ", %u, %s, %u},\n", facts->has_exponent ? encoded(context, check->exponent) : 0u,
            check->is_gated ? "true" : "false", check->is_gated ? encoded(context, check->opener) : 0u);
  }
  fputs("};\n\n", file);
  write_head(file, FUNCTION_LIMIT, "", checks->count);
  begin_frame(file, false);
  set_rows(file);
  fprintf(file, "  instructions_limit(&frame, limit_checks, %zu, limit);\n}\n\n", checks->count);
}

void instruction_tables_series(FILE *file, const struct TableContext *context) {
  const struct SeriesProgram *series = context->program->series;
  instruction_tables_function(file, context, FUNCTION_START, series->start);
  write_table(file, context, "series", series->order);
  write_head(file, FUNCTION_SERIES, "", series->order->operation_count);
  begin_frame(file, false);
  set_rows(file);
  fprintf(file,
          "  frame.base[SPACE_MASS] = w[%zu];\n"
          "  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++) instructions_run_order(&frame, series_code, "
          "k);\n}\n\n",
          series->mass_row);
  if (series->limit.count > 0) write_limit(file, context);
}

void instruction_tables_output_series(FILE *file, const struct TableContext *context) {
  const struct SeriesProgram *series = context->program->output_series;
  write_table(file, context, "output_start", series->start);
  write_table(file, context, "output_series", series->order);
  write_head(file, FUNCTION_OUTPUT_SERIES, "", series->start->operation_count);
  begin_frame(file, false);
  set_rows(file);
  set_base(file, "TARGET_ROW", "*y");
  fputs("  instructions_run(&frame, output_start_code);\n"
        "  for (int k = 1; k <= order && k + 1 < SERIES_LENGTH; k++) instructions_run_order(&frame, "
        "output_series_code, k);\n}\n\n",
        file);
}
