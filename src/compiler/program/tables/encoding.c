/*
 * Encodes functions as tables of 32-bit words for the interpreter in src/runtime/support/instructions.c. Instructions
 * with the same opcode, function and spaces form a run, whose header is decoded once; the interpreter loops over its
 * instructions. Compile time is then independent of the length of the code.
 */
#include "program/tables/encoding.h"

#include "algebra/functions.h"
#include "base/memory.h"
#include "program/tables/schedule.h"

static void add_number(struct Encoding *encoding, Node node) {
  if (encoding->number[node] > 0) return;
  append_node(&encoding->numbers, node);
  encoding->number[node] = encoding->numbers.count;
}

/* True if the function is a table in a program that has tables. */
static bool is_in_tables(const struct Program *program, enum FunctionName name) {
  if (name == FUNCTION_START || name == FUNCTION_SERIES) return program->series_is_table;
  return program->switches_are_table || generated_functions[name].group != IN_SWITCHES;
}

/* Collects the constants and functions that a function in tables uses. */
static void note(void *target, enum FunctionName name, const struct IrFunction *ir) {
  struct Encoding *encoding = target;
  if (!is_in_tables(encoding->program, name)) return;
  for (size_t i = 0; i < ir->count; i++) {
    const struct Instruction *instruction = &ir->instructions[i];
    if (instruction->opcode == CALL || instruction->opcode == CALL_OF_TWO)
      encoding->function[instruction->function] = 1;
    for (int j = 0; j < opcode_arity(instruction->opcode); j++)
      if (space_of(instruction->operands[j]) == SPACE_NUMBER)
        add_number(encoding, (Node)index_in(instruction->operands[j]));
  }
}

static void note_limit(struct Encoding *encoding, const struct SeriesProgram *series) {
  for (size_t i = 0; series != NULL && i < series->limit.count; i++) {
    const struct LimitCheck *check = &series->limit.items[i];
    if (limit_metadata(check->rule)->has_exponent && space_of(check->exponent) == SPACE_NUMBER)
      add_number(encoding, (Node)index_in(check->exponent));
  }
}

/*
 * Updates the largest number of local variables. prepare() keeps its own after its results, and statements declare
 * theirs.
 */
static void find_most_locals(void *target, enum FunctionName name, const struct IrFunction *ir) {
  struct Encoding *encoding = target;
  const struct Program *program = encoding->program;
  bool has_own =
      name == FUNCTION_PREPARE || (!program->switches_are_table && generated_functions[name].group == IN_SWITCHES);
  if (!has_own && ir->local_count > encoding->local_count) encoding->local_count = ir->local_count;
}

struct Encoding *encoding_create(const struct Program *program) {
  struct Encoding *encoding = allocate(1, sizeof *encoding);
  *encoding = (struct Encoding){.program = program, .number = allocate(program->model->graph->count, sizeof(size_t))};
  program_visit(program, note, encoding);
  program_visit(program, find_most_locals, encoding);
  if (program->series_is_table) note_limit(encoding, program->series);
  if (program->switches_are_table) note_limit(encoding, program->watched_series);
  size_t count[3] = {0};
  for (enum Operation function = 0; function < OPERATION_COUNT; function++)
    if (encoding->function[function] > 0) encoding->function[function] = ++count[operation_arity(function)];
  return encoding;
}

size_t encoding_work_count(const struct Encoding *encoding) {
  const struct Program *program = encoding->program;
  return encoding->local_count + program->blocks.mass_count + program->blocks.right_side_count +
         row_count(program->equations);
}

/* Returns the index of a slot in its space, in numbers; rows have SERIES_LENGTH numbers each. */
static uint32_t index_of(const struct Encoding *encoding, Slot slot) {
  enum Space space = space_of(slot);
  size_t index = index_in(slot);
  if (space == SPACE_NUMBER) return (uint32_t)encoding->number[index] - 1;
  return (uint32_t)(space >= SPACE_ROW && space != SPACE_TIME_ROW ? index * SERIES_LENGTH : index);
}

static void append_word(struct WordList *words, uint32_t word) {
  APPEND(words->items, words->count, word);
}

/* Appends one run: instructions first .. end - 1 of the schedule. */
static void append_run(struct WordList *words, const struct Encoding *encoding, const struct IrFunction *ir,
                       const size_t *schedule, size_t first, size_t end) {
  const struct Instruction *instructions = ir->instructions;
  enum Opcode opcode = instructions[schedule[first]].opcode;
  append_word(words, opcode);
  append_word(words, (uint32_t)(end - first));
  append_word(words, spaces_of(&instructions[schedule[first]]));
  if (opcode == CALL || opcode == CALL_OF_TWO)
    append_word(words, (uint32_t)encoding->function[instructions[schedule[first]].function] - 1);
  for (size_t i = first; i < end; i++) {
    const struct Instruction *instruction = &instructions[schedule[i]];
    append_word(words, opcode_has_result(opcode) ? index_of(encoding, instruction->result) : instruction->result);
    for (int j = 0; j < opcode_arity(opcode); j++) append_word(words, index_of(encoding, instruction->operands[j]));
  }
}

static void append_region(struct WordList *words, const struct Encoding *encoding, const struct Instruction *skip,
                          const struct Region *region);

/* Appends the runs of a function whose regions are separated. */
static void append_runs(struct WordList *words, const struct Encoding *encoding,
                        const struct SeparatedFunction *function) {
  const struct IrFunction *ir = &function->outer;
  size_t *schedule = schedule_create(function, &encoding->program->blocks);
  for (size_t first = 0, end = 0; first < ir->count; first = end) {
    const struct Instruction *instruction = &ir->instructions[schedule[first]];
    end = first + 1;
    while (end < ir->count && same_run(instruction, &ir->instructions[schedule[end]])) end++;
    if (instruction->opcode == SKIP && function->regions != NULL) /* a region contains no others */
      append_region(words, encoding, instruction, &function->regions[instruction->result]);
    else append_run(words, encoding, ir, schedule, first, end);
  }
  release(schedule);
}

/* Appends SKIP, with the number of words of its region in place of that of instructions, and the region. */
static void append_region(struct WordList *words, const struct Encoding *encoding, const struct Instruction *skip,
                          const struct Region *region) {
  append_word(words, SKIP);
  size_t length = words->count;
  append_word(words, 0);
  append_word(words, spaces_of(skip));
  append_word(words, index_of(encoding, region->condition));
  size_t first = words->count;
  append_runs(words, encoding, &(struct SeparatedFunction){.outer = region->ir});
  words->items[length] = (uint32_t)(words->count - first);
}

void encode(const struct Encoding *encoding, const struct IrFunction *ir, struct WordList *words) {
  struct SeparatedFunction separated = regions_separate(ir);
  append_runs(words, encoding, &separated);
  append_word(words, END);
}

struct IrTables encode_all(const struct Encoding *encoding, struct IrFunction *const *ir_functions,
                           const struct ResultGroups *groups) {
  struct IrTables tables = {.start = allocate(groups->count, sizeof *tables.start), .slot = groups->slot};
  for (size_t i = 0; i < groups->count; i++) {
    size_t leader = groups->leader[i];
    tables.start[i] = leader < i ? tables.start[leader] : tables.words.count;
    if (tables.slot[i] > tables.largest_slot) tables.largest_slot = tables.slot[i];
    if (ir_functions[i] == NULL) continue;
    encode(encoding, ir_functions[i], &tables.words);
    tables.operation_count += ir_functions[i]->operation_count;
  }
  append_word(&tables.words, END);
  return tables;
}

static Slot encoded(const struct Encoding *encoding, Slot slot) {
  return slot_at(space_of(slot), index_of(encoding, slot));
}

struct LimitCheck encoded_check(const struct Encoding *encoding, const struct LimitCheck *check) {
  const struct LimitMetadata *metadata = limit_metadata(check->rule);
  return (struct LimitCheck){.rule = check->rule,
                             .row = encoded(encoding, check->row),
                             .other_row = metadata->has_two_rows ? encoded(encoding, check->other_row) : 0,
                             .function = metadata->has_function ? check->function : NULL,
                             .share = check->share,
                             .exponent = metadata->has_exponent ? encoded(encoding, check->exponent) : 0,
                             .is_guarded = check->is_guarded,
                             .guard_condition = check->is_guarded ? encoded(encoding, check->guard_condition) : 0};
}
