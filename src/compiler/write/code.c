#include "write/code.h"

#include <string.h>

#include "base/memory.h"
#include "base/sorting.h"
#include "mechanics/switching.h"
#include "program/facts/block_facts.h"
#include "write/c_text.h"
#include "write/description.h"
#include "write/statements.h"
#include "write/switch_table.h"
#include "write/instruction_tables.h"

/* The runtime's files but for those of a version of FMI, and its rooms that every FMU has, NULL at the end; the build writes them. */
extern const char *const runtime_sources[];
extern const char *const core_rooms[];

static void include_source(FILE *file, const char *name) {
  fprintf(file, "#include \"%s\"\n", name);
}

/* All files of a room of the runtime: what works together is there or not, so that nobody counts it up. */
static void include_room(FILE *file, const char *room) {
  size_t length = strlen(room);
  for (const char *const *name = runtime_sources; *name != NULL; name++)
    if (strncmp(*name, room, length) == 0 && (*name)[length] == '/') include_source(file, *name);
}

static bool has_oblique_block(const struct Program *program) {
  bool has = false;
  for (size_t i = 0; i < program->blocks.count; i++) has |= program->blocks.items[i].block->force_count > 0;
  return has;
}

static bool has_solver(const struct Program *program, const char *name) {
  return program->solver != NULL && strcmp(program->solver, name) == 0;
}

/*
 * Whether the functions can be compiled over lanes too: see src/ensemble. Blocks in which forces that follow from the
 * accelerations are eliminated work on numbers of one run.
 */
static bool has_lanes(const struct Program *program) {
  bool is_taylor = has_solver(program, "taylor") || has_solver(program, "auto");
  return program->series != NULL && is_taylor && !has_oblique_block(program);
}

/*
 * The files of the runtime that this one needs, for compiling all in one, and for archives whose source is one file. The build
 * adds those of the version of FMI.
 */
static void write_runtime(FILE *file, const struct Program *program) {
  const struct Method *method = program->equations->method;
  const struct Switches *switches = &program->model->switches;
  const struct SwitchingExpressions *switching = program->equations->switching;
  const char *solver = program->solver, *lu = program->lu;
  fputs("#ifdef FMU_IN_ONE_FILE\n", file);
  for (const char *const *room = core_rooms; *room != NULL; room++) include_room(file, *room);
  if (solver != NULL) fprintf(file, "#include \"methods/%s%s.c\"\n", method->uses_library ? "sundials/" : "", solver);
  for (size_t i = 0; method != NULL && i < METHOD_SOURCES && method->sources[i] != NULL; i++)
    include_source(file, method->sources[i]);
  if (lu != NULL) fprintf(file, "#include \"support/%s.c\"\n", lu);
  if (program->is_table) include_source(file, "support/instructions.c");
  if (program->is_table || program->blocks.count > 0) include_source(file, "support/ldlt.c");
  if (program->routines[FUNCTION_ACCELERATIONS] != NULL) include_source(file, "support/saddle.c");
  if (has_oblique_block(program)) include_source(file, "support/oblique.c");
  if (program->routines[FUNCTION_ACCELERATIONS] != NULL) include_source(file, "methods/projection.c");
  if (program->routines[FUNCTION_INDICATORS] != NULL) include_room(file, "events");
  if (switches->contact_count > 0 || switches->friction_count > 0) include_room(file, "contacts");
  if (has_planes(switches)) include_room(file, "planes");
  if (switching != NULL && switching->timed_count > 0) include_room(file, "timing");
  fputs("#endif\n", file);
}

/* What is asked of GCC alone, so that it moves and compiles less; NULL for nothing. */
static const char *optimization_of(const struct Program *program) {
  if (!program->is_table) return NULL;
  /* Long statements of series take a compiler half the time so, and the processor not more. */
  if (!program->series_is_table) return "O1";
  /* Long derivatives go through the processor once, as fast as their code comes: it is a twentieth shorter so. */
  return program->derivatives_are_table ? NULL : "Os";
}

static bool has_random_numbers(const struct Program *program) {
  const struct Graph *graph = program->model->graph;
  bool has = false;
  for (Node node = 0; node < graph->count && !has; node++)
    has = graph->vertices[node].operation == UNIFORM || graph->vertices[node].operation == GAUSS;
  return has;
}

static void write_includes(FILE *file, const struct Program *program) {
  fprintf(file, "/* Equations of motion of %s, written by lagc. */\n", program->model->name);
  if (has_lanes(program))
    fputs("#ifdef LANES /* these functions alone, over lanes */\n#undef FMU_IN_ONE_FILE\n#endif\n", file);
  write_runtime(file, program);
  const char *level = optimization_of(program);
  if (level != NULL)
    fprintf(file, "#if defined(__GNUC__) && !defined(__clang__)\n#pragma GCC optimize(\"%s\")\n#endif\n", level);
  fputs("#include <math.h>\n\n#include \"lagrangian.h\"\n", file);
  if (program->is_table) fputs("#include \"instructions.h\"\n", file);
  if (program->blocks.count > 0) fputs("#include \"ldlt.h\"\n", file);
  if (program->routines[FUNCTION_ACCELERATIONS] != NULL)
    fputs("#include \"saddle.h\"\n\nextern const struct Projection projection;\n", file);
  if (has_oblique_block(program)) fputs("#include \"oblique.h\"\n", file);
  if (has_random_numbers(program)) fputs("#include \"random_numbers.h\"\n", file);
  fputs("\n", file);
}

static void write_numbers(FILE *file, const char *name, const struct InertiaBlock *block, size_t coordinates) {
  struct BlockNumbers numbers = block_numbers_of(block, coordinates);
  fprintf(file, "static const int %s[] = {", name);
  for (size_t i = 0; i < numbers.count; i++) fprintf(file, "%d, ", numbers.items[i]);
  fputs("};\n\n", file);
}

/* What the columns that two rows share take from an element of the first. */
static void write_shared_products(FILE *file, const struct InertiaBlock *block, size_t row, size_t place) {
  const size_t *start = block->start, *column = block->column, other = column[place];
  for (size_t a = place; a-- > start[row];)
    for (size_t b = start[other]; b + 1 < start[other + 1]; b++)
      if (column[a] == column[b]) fprintf(file, "  k%zu -= k%zu * factor%zu;\n", place, a, b);
}

/* The pivot of a row, from the terms of its elements. */
static void write_pivot(FILE *file, const struct InertiaBlock *block, size_t row, bool is_constraint, size_t number) {
  size_t first = block->start[row], last = block->start[row + 1] - 1, n = block->count, elements = block->start[n];
  fprintf(file, "  const Real pivot%zu = k%zu", row, last);
  for (size_t k = first; k < last; k++) fprintf(file, " - term%zu", k);
  if (!is_constraint) {
    fprintf(file, ";\n  REQUIRE(saddle_is_definite(pivot%zu, k%zu), %zu);\n  mass[%zu] = pivot%zu;\n", row, last,
            row + 1, last, row);
    return;
  }
  fprintf(file, ", mobility%zu = REAL(0.0)", row);
  for (size_t k = first; k < last; k++) fprintf(file, " + saddle_mobility(term%zu)", k);
  fprintf(file,
          ";\n  if (ANYWHERE(saddle_is_doubtful(-pivot%zu, mobility%zu, weakest))) {\n"
          "    for (size_t k = 0; k < %zu; k++) mass[k] = mass[%zu + k];\n"
          "    return saddle_factor(%zu, start%zu, column%zu, coordinate%zu, mass);\n  }\n"
          "  mass[%zu] = saddle_pivot(-pivot%zu, mobility%zu, &weakest);\n",
          row, row, elements, elements, n, number, number, number, last, row, row);
}

/*
 * Factors a small block as saddle_factor() does, which is left where a constraint is in doubt. The elements are handed
 * over as numbers: pairs of them that have just been stored would be waited for.
 */
static void write_small_factor(FILE *file, const struct InertiaBlock *block, size_t coordinates, size_t number) {
  size_t n = block->count, elements = block->start[n];
  const size_t *start = block->start, *column = block->column;
  struct BlockNumbers numbers = block_numbers_of(block, coordinates);
  fprintf(file, "static size_t factor%zu(Real *mass", number);
  for (size_t k = 0; k < elements; k++) fprintf(file, ", Real k%zu", k);
  fputs(") {\n  Real weakest = REAL(1.0);\n", file);
  for (size_t k = 0; k < elements; k++) fprintf(file, "  mass[%zu] = k%zu;\n", elements + k, k);
  for (size_t i = 0; i < n; i++) {
    size_t last = start[i + 1] - 1;
    for (size_t k = start[i]; k < last; k++) write_shared_products(file, block, i, k);
    for (size_t k = start[i]; k < last; k++)
      fprintf(file,
              "  const Real factor%zu = k%zu / mass[%zu], term%zu = factor%zu * k%zu;\n"
              "  mass[%zu] = factor%zu;\n",
              k, k, start[column[k] + 1] - 1, k, k, k, k, k);
    write_pivot(file, block, i, numbers.items[i] < 0, number);
  }
  fprintf(
      file,
      "  mass[%zu] = weakest;\n  saddle_balance(%zu, start%zu, column%zu, coordinate%zu, mass);\n  return 0;\n}\n\n",
      2 * elements, n, number, number, number);
}

/* Solves a small block by its factors, as saddle_solve() does where nothing is to be refined. */
static void write_small_solve(FILE *file, const struct InertiaBlock *block, size_t number) {
  size_t n = block->count;
  const size_t *start = block->start, *column = block->column;
  fprintf(file,
          "static inline void solve%zu(const Real *mass, Real *side) {\n"
          "  if (ANYWHERE(saddle_is_weak(%zu, mass))) {\n"
          "    saddle_solve(%zu, start%zu, column%zu, mass, side);\n    return;\n  }\n",
          number, start[n], n, number, number);
  for (size_t i = 0; i < n; i++)
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++)
      fprintf(file, "  side[%zu] -= mass[%zu] * side[%zu];\n", i, k, column[k]);
  for (size_t i = 0; i < n; i++) fprintf(file, "  side[%zu] /= mass[%zu];\n", i, start[i + 1] - 1);
  for (size_t i = n; i-- > 0;)
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++)
      fprintf(file, "  side[%zu] -= mass[%zu] * side[%zu];\n", column[k], k, i);
  fputs("}\n\n", file);
}

/* The pattern of each large block's factors, and what its rows are. */
static void write_blocks(FILE *file, const struct Program *program) {
  for (size_t i = 0; i < program->blocks.count; i++) {
    const struct InertiaBlock *block = program->blocks.items[i].block;
    if (!block_is_full(block)) {
      write_sizes(file, "size_t", format_text("start%zu", i), block->start, block->count + 1);
      write_sizes(file, "size_t", format_text("column%zu", i), block->column, block->start[block->count]);
    }
    write_numbers(file, format_text("coordinate%zu", i), block, program->equations->count);
    if (!program_solves_by_statements(program, i)) continue;
    write_small_factor(file, block, program->equations->count, i);
    write_small_solve(file, block, i);
  }
}

/* Where a simulation spends its time, statements may stand among tables. */
static bool is_in_statements(const struct Program *program, enum FunctionName name) {
  return (name == FUNCTION_DERIVATIVES && !program->derivatives_are_table) ||
         (name == FUNCTION_DIRECTIONAL && !program->directional_is_table);
}

/*
 * The functions of one routine that struct Lagrangian holds, as far as the system has them. Returns how much of the workspace
 * those need that are statements in parts.
 */
static size_t write_routines(FILE *file, const struct Program *program, const struct Encoding *tables) {
  size_t shared = 0;
  for (enum FunctionName i = 0; i < LAGRANGIAN_ROUTINES; i++) {
    const struct Routine *routine = program->routines[i];
    if (routine == NULL) continue;
    if (tables == NULL) statements_function(file, program, i, "", routine);
    else if (is_in_statements(program, i)) shared = larger(shared, statements_in_parts(file, program, i));
    else instruction_tables_function(file, tables, i, routine);
  }
  return shared;
}

static void write_as_statements(FILE *file, const struct Program *program) {
  write_routines(file, program, NULL);
  if (program->series != NULL) statements_series(file, program);
  if (program->output_series != NULL) statements_output_series(file, program);
  statements_results(file, program);
  switching_write(file, program);
  description_write(file, program, 0);
}

static void write_as_tables(FILE *file, const struct Program *program) {
  struct Encoding *tables = encoding_create(program);
  instruction_tables_shared(file, tables);
  size_t shared = write_routines(file, program, tables);
  if (program->series != NULL && program->series_is_table) instruction_tables_series(file, tables);
  else if (program->series != NULL) statements_series(file, program);
  if (program->output_series != NULL) instruction_tables_output_series(file, tables);
  instruction_tables_results(file, tables);
  switching_write(file, program);
  description_write(file, program, larger(encoding_work_count(tables), shared));
}

void code_write(FILE *file, const struct Program *program) {
  write_includes(file, program);
  write_blocks(file, program);
  if (program->is_table) write_as_tables(file, program);
  else write_as_statements(file, program);
}
