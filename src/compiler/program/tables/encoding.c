/*
 * Encodes functions as tables of 32-bit words for the interpreter in src/runtime/support/instructions.c. Instructions
 * with the same opcode, function and spaces form a run, whose header is decoded once; the interpreter loops over its
 * instructions. Compile time is then independent of the length of the code.
 *
 * Local variables are numbered in the order of the table. Instructions of one form, such as those of the points of a
 * shape, then have equally spaced operands. A table has the first of them and the differences: a loop over points.
 */
#include "program/tables/encoding.h"

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
static int32_t index_of(const struct Encoding *encoding, Slot slot) {
  enum Space space = space_of(slot);
  size_t index = index_in(slot);
  if (space == SPACE_NUMBER) return (int32_t)encoding->number[index] - 1;
  return (int32_t)(space >= SPACE_ROW && space != SPACE_TIME_ROW ? index * SERIES_LENGTH : index);
}

static void append_word(struct WordList *words, int32_t word) {
  APPEND(words->items, words->count, word);
}

/* A function in the order of a table, with its regions. */
struct OrderedFunction {
  struct IrFunction outer;
  struct OrderedFunction *regions; /* of SKIP, by its result */
};

/* Numbers local variables in the order of the table. */
struct LocalNumbers {
  size_t *number; /* 1 + the number of each; 0: none yet */
  size_t count;
};

static Slot numbered(struct LocalNumbers *numbers, Slot slot) {
  if (space_of(slot) != SPACE_LOCAL) return slot;
  size_t *number = &numbers->number[index_in(slot)];
  if (*number == 0) *number = ++numbers->count;
  return slot_at(SPACE_LOCAL, *number - 1);
}

/* Numbers the local variables of an ordered function, and of its regions where they stand. */
static void number_locals(struct OrderedFunction *function, struct LocalNumbers *numbers) {
  for (size_t i = 0; i < function->outer.count; i++) {
    struct Instruction *instruction = &function->outer.instructions[i];
    for (int j = 0; j < opcode_arity(instruction->opcode); j++)
      instruction->operands[j] = numbered(numbers, instruction->operands[j]);
    if (opcode_has_result(instruction->opcode)) instruction->result = numbered(numbers, instruction->result);
    if (instruction->opcode == SKIP && function->regions != NULL)
      number_locals(&function->regions[instruction->result], numbers);
  }
}

/* Returns the instructions outside of regions in their order, and those of the regions in theirs. */
static struct OrderedFunction ordered(const struct SeparatedFunction *function, const struct LoopedBlocks *blocks,
                                      const struct Forms *forms) {
  struct OrderedFunction result = {.outer = function->outer};
  size_t *schedule = schedule_create(function, blocks, forms);
  result.outer.instructions = allocate(function->outer.count, sizeof *result.outer.instructions);
  for (size_t i = 0; i < function->outer.count; i++)
    result.outer.instructions[i] = function->outer.instructions[schedule[i]];
  release(schedule);
  if (function->region_count > 0) result.regions = allocate(function->region_count, sizeof *result.regions);
  for (size_t i = 0; i < function->region_count; i++) /* a region contains no others */
    result.regions[i] = ordered(&(struct SeparatedFunction){.outer = function->regions[i].ir}, blocks, forms);
  return result;
}

static void ordered_release(const struct OrderedFunction *function, size_t region_count) {
  for (size_t i = 0; i < region_count; i++) release(function->regions[i].outer.instructions);
  release(function->outer.instructions);
  release(function->regions);
}

/* Returns the word for the result, number 0, or for an operand of an instruction. */
static int32_t word_of(const struct Encoding *encoding, const struct Instruction *instruction, int number) {
  if (number > 0) return index_of(encoding, instruction->operands[number - 1]);
  return opcode_has_result(instruction->opcode) ? index_of(encoding, instruction->result)
                                                : (int32_t)instruction->result;
}

static void append_header(struct WordList *words, const struct Encoding *encoding,
                          const struct Instruction *instruction, size_t count, bool is_spaced) {
  enum Opcode opcode = instruction->opcode;
  append_word(words, (int32_t)opcode);
  append_word(words, (int32_t)count | (is_spaced ? SPACED : 0));
  append_word(words, (int32_t)spaces_of(instruction));
  if (opcode == CALL || opcode == CALL_OF_TWO)
    append_word(words, (int32_t)encoding->function[instruction->function] - 1);
}

/* Returns the difference of a word to that of the instruction before; of the first one the word. */
static int32_t difference_of(const struct Encoding *encoding, const struct Instruction *run, size_t i, int number) {
  int32_t word = word_of(encoding, &run[i], number);
  return i > 0 ? word - word_of(encoding, &run[i - 1], number) : word;
}

/* Returns the number of instructions from the first on, up to count, whose first words are equally spaced. */
static size_t spaced_count(const struct Encoding *encoding, const struct Instruction *run, size_t count, int words) {
  size_t length = count < 2 ? count : 2;
  for (; length >= 2 && length < count; length++)
    for (int j = 0; j < words; j++)
      if (difference_of(encoding, run, length, j) != difference_of(encoding, run, 1, j)) return length;
  return length;
}

/* Appends a word of the first of count instructions, and its difference to that of the next. */
static void append_spaced_word(struct WordList *words, const struct Encoding *encoding, const struct Instruction *run,
                               size_t count, int number) {
  append_word(words, difference_of(encoding, run, 0, number));
  append_word(words, count > 1 ? difference_of(encoding, run, 1, number) : 0);
}

/* Appends instructions whose operands are not equally spaced, as runs whose results are. */
static void append_listed(struct WordList *words, const struct Encoding *encoding,
                          const struct Instruction *instructions, size_t count) {
  for (size_t first = 0, length; first < count; first += length) {
    const struct Instruction *run = instructions + first;
    length = spaced_count(encoding, run, count - first, 1);
    append_header(words, encoding, run, length, false);
    append_spaced_word(words, encoding, run, length, 0);
    for (size_t i = 0; i < length; i++)
      for (int j = 1; j <= opcode_arity(run->opcode); j++) append_word(words, difference_of(encoding, run, i, j));
  }
}

/* Appends a run of instructions whose results and operands are equally spaced. */
static void append_spaced(struct WordList *words, const struct Encoding *encoding,
                          const struct Instruction *instructions, size_t count) {
  append_header(words, encoding, instructions, count, true);
  for (int j = 0; j <= opcode_arity(instructions->opcode); j++)
    append_spaced_word(words, encoding, instructions, count, j);
}

/* Appends the instructions of one run, as several where many are equally spaced. */
static void append_run(struct WordList *words, const struct Encoding *encoding, const struct Instruction *instructions,
                       size_t count) {
  enum { FEWEST_SPACED = 6 }; /* a header and differences take as many words as some 4 instructions */
  size_t listed = 0;
  for (size_t i = 0, length; i < count; i += length) {
    length = spaced_count(encoding, instructions + i, count - i, opcode_arity(instructions->opcode) + 1);
    if (length < FEWEST_SPACED) {
      length = 1;
      continue;
    }
    append_listed(words, encoding, instructions + listed, i - listed);
    append_spaced(words, encoding, instructions + i, length);
    listed = i + length;
  }
  append_listed(words, encoding, instructions + listed, count - listed);
}

static void append_region(struct WordList *words, const struct Encoding *encoding, const struct Instruction *skip,
                          const struct OrderedFunction *region);

static void append_runs(struct WordList *words, const struct Encoding *encoding,
                        const struct OrderedFunction *function) {
  const struct Instruction *instructions = function->outer.instructions;
  for (size_t first = 0, end = 0; first < function->outer.count; first = end) {
    end = first + 1;
    while (end < function->outer.count && same_run(&instructions[first], &instructions[end])) end++;
    if (instructions[first].opcode == SKIP && function->regions != NULL)
      append_region(words, encoding, &instructions[first], &function->regions[instructions[first].result]);
    else append_run(words, encoding, instructions + first, end - first);
  }
}

/* Appends SKIP, with the number of words of its region in place of that of instructions, and the region. */
static void append_region(struct WordList *words, const struct Encoding *encoding, const struct Instruction *skip,
                          const struct OrderedFunction *region) {
  append_word(words, SKIP);
  size_t length = words->count;
  append_word(words, 0);
  append_word(words, (int32_t)spaces_of(skip));
  append_word(words, index_of(encoding, skip->operands[0]));
  size_t first = words->count;
  append_runs(words, encoding, region);
  words->items[length] = (int32_t)(words->count - first);
}

/* Appends a part of a function as a table, whose local variables are numbered from numbers->count on. */
static void append_table(struct WordList *words, const struct Encoding *encoding, const struct SeparatedFunction *part,
                         const struct Forms *forms, struct LocalNumbers *numbers) {
  struct OrderedFunction function = ordered(part, &encoding->program->blocks, forms);
  number_locals(&function, numbers);
  append_runs(words, encoding, &function);
  append_word(words, END);
  ordered_release(&function, part->region_count);
}

void encode(const struct Encoding *encoding, const struct IrFunction *ir, struct WordList *words) {
  struct SeparatedFunction separated;
  regions_separate(ir, &ir->count, 1, &separated);
  struct Forms forms = forms_create(ir);
  struct LocalNumbers numbers = {.number = allocate(ir->local_count, sizeof *numbers.number)};
  append_table(words, encoding, &separated, &forms, &numbers);
  regions_release(&separated, 1);
  release(numbers.number);
  forms_release(&forms);
}

static bool are_equal(const struct Instruction *first, const struct Instruction *second) {
  bool equal =
      first->opcode == second->opcode && first->function == second->function && first->result == second->result;
  for (int i = 0; i < opcode_arity(first->opcode); i++) equal &= first->operands[i] == second->operands[i];
  return equal;
}

/* Returns the number of instructions with which both functions begin. */
static size_t common_count(const struct IrFunction *first, const struct IrFunction *second) {
  size_t count = 0;
  while (count < first->count && count < second->count &&
         are_equal(&first->instructions[count], &second->instructions[count]))
    count++;
  return count;
}

static bool reads_seed(const struct Instruction *instruction) {
  bool reads = false;
  for (int i = 0; i < opcode_arity(instruction->opcode); i++) {
    enum Space space = space_of(instruction->operands[i]);
    reads |= space >= SPACE_SEED_PARAMETER && space <= SPACE_SEED_RESULT;
  }
  return reads;
}

/* Returns a slot of the second function, whose own local variables follow those of the first. */
static Slot moved(Slot slot, const bool *is_common, size_t shift) {
  bool is_own = space_of(slot) == SPACE_LOCAL && !is_common[index_in(slot)];
  return is_own ? slot_at(SPACE_LOCAL, index_in(slot) + shift) : slot;
}

/* Appends to the first function the instructions of the second one from the first that differs on. */
static struct IrFunction joined(const struct IrFunction *first, const struct IrFunction *second, size_t common) {
  struct IrFunction all = *first;
  all.instructions = allocate(first->count + second->count, sizeof *all.instructions);
  for (size_t i = 0; i < first->count; i++) all.instructions[i] = first->instructions[i];
  bool *is_common = allocate(second->local_count, sizeof *is_common);
  for (size_t i = 0; i < common; i++) {
    Slot result = first->instructions[i].result;
    if (opcode_has_result(first->instructions[i].opcode) && space_of(result) == SPACE_LOCAL)
      is_common[index_in(result)] = true;
  }
  all.local_count = first->local_count + second->local_count;
  for (size_t i = common; i < second->count; i++) {
    struct Instruction instruction = second->instructions[i];
    for (int j = 0; j < opcode_arity(instruction.opcode); j++)
      instruction.operands[j] = moved(instruction.operands[j], is_common, first->local_count);
    if (opcode_has_result(instruction.opcode))
      instruction.result = moved(instruction.result, is_common, first->local_count);
    all.instructions[all.count++] = instruction;
  }
  release(is_common);
  return all;
}

void encode_pair(const struct Encoding *encoding, const struct IrFunction *first, const struct IrFunction *second,
                 struct WordList words[PAIR_PARTS]) {
  size_t common = second != NULL ? common_count(first, second) : first->count, steady = 0;
  while (steady < common && !reads_seed(&first->instructions[steady])) steady++;
  struct IrFunction all = second != NULL ? joined(first, second, common) : *first;
  const size_t ends[PAIR_PARTS] = {steady, common, first->count, all.count};
  struct SeparatedFunction parts[PAIR_PARTS];
  regions_separate(&all, ends, PAIR_PARTS, parts);
  struct Forms forms = forms_create(&all);
  struct LocalNumbers numbers = {.number = allocate(all.local_count, sizeof *numbers.number)};
  for (int i = 0; i < PAIR_PARTS; i++) {
    size_t common_locals = numbers.count;
    if (ends[i] > (i > 0 ? ends[i - 1] : 0)) append_table(&words[i], encoding, &parts[i], &forms, &numbers);
    if (i == PAIR_END) numbers.count = common_locals; /* only one of the ends is run */
  }
  regions_release(parts, PAIR_PARTS);
  if (second != NULL) release(all.instructions);
  release(numbers.number);
  forms_release(&forms);
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
  return slot_at(space_of(slot), (size_t)index_of(encoding, slot));
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
