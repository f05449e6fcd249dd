#include <math.h>

#include "base/memory.h"
#include "write/c_text.h"
#include "write/instruction_text.h"
#include "write/statements.h"

/*
 * As many orders get code of their own as have together so many products that their code stays in the processor's cache of
 * decoded instructions, or, where the products of one order take long, in that of instructions. With few recurrences, it is
 * faster as one piece, without a jump that the processor would have to foresee.
 */
enum { UNROLLED_PRODUCTS = 1000, RECURRENCES_IN_ONE_PIECE = 12, PRODUCTS_IN_ONE_PIECE = 400 };

/* What an order may need beside k, x and w: its declaration, and what series() passes for it. */
static const struct {
  enum Space space;
  const char *declaration, *argument;
} further_arguments[] = {
    {SPACE_PARAMETER, "const Real *p", "point->parameter"},
    {SPACE_PREPARED, "const Real *c", "point->prepared"},
    {SPACE_TIME_ROW, "const Real *time", "time"},
    {SPACE_INPUT_ROW, "const Series *restrict input", "input"},
};

enum { FURTHER_COUNT = sizeof further_arguments / sizeof *further_arguments };

static void write_next_function(FILE *file, const struct Program *program) {
  const struct Routine *order = program->series->order;
  fprintf(file, "/* Coefficient k of all series, k + 1 of the state; %zu recurrences */\n",
          program->series->recurrences);
  fputs("static SERIES_INLINE void series_next(int k, ", file);
  for (int i = 0; i < FURTHER_COUNT; i++)
    if (routine_uses(order, further_arguments[i].space)) fprintf(file, "%s, ", further_arguments[i].declaration);
  fputs("Series *restrict x, Series *restrict w) {\n", file);
  write_statements(file, program, order, NULL);
  fputs("}\n\n", file);
}

static void write_next_call(FILE *file, const struct Routine *order, const char *k) {
  fprintf(file, "series_next(%s, ", k);
  for (int i = 0; i < FURTHER_COUNT; i++)
    if (routine_uses(order, further_arguments[i].space)) fprintf(file, "%s, ", further_arguments[i].argument);
  fputs("x, w);\n", file);
}

static void write_call_of_order(FILE *file, const struct Program *program, size_t k) {
  write_next_call(file, program->series->order, format_text("%zu", k));
}

/* How many orders get code of their own. */
static size_t unrolled_orders(size_t recurrences, size_t limit) {
  size_t k = 0, products = 0;
  while (k + 3 < SERIES_LENGTH && products + (k + 1) * recurrences <= limit) products += ++k * recurrences;
  return k;
}

/* Calls with a constant order, which the compiler unrolls. */
static void write_one_piece(FILE *file, const struct Program *program) {
  size_t orders = unrolled_orders(program->series->recurrences, PRODUCTS_IN_ONE_PIECE);
  for (size_t k = 1; k <= orders; k++) {
    fprintf(file, "  if (order <= %zu) return;\n  ", k);
    write_call_of_order(file, program, k);
  }
  fprintf(file, "  for (int k = %zu; k < order && k + 1 < SERIES_LENGTH; k++) ", orders + 1);
  write_next_call(file, program->series->order, "k");
}

static void write_cases(FILE *file, const struct Program *program) {
  size_t orders = unrolled_orders(program->series->recurrences, UNROLLED_PRODUCTS);
  fputs("  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++) {\n    switch (k) {\n", file);
  for (size_t k = 1; k <= orders; k++) {
    fprintf(file, "    case %zu: ", k);
    write_call_of_order(file, program, k);
    fputs("      break;\n", file);
  }
  fputs("    default: ", file);
  write_next_call(file, program->series->order, "k");
  fputs("    }\n  }\n", file);
}

static void write_unrolled_orders(FILE *file, const struct Program *program) {
  if (program->series->recurrences <= RECURRENCES_IN_ONE_PIECE) write_one_piece(file, program);
  else write_cases(file, program);
}

static void declare_time(FILE *file, bool is_used) {
  if (is_used) fputs("  const Series time = {point->time, REAL(1.0)};\n", file);
}

static void write_series(FILE *file, const struct Program *program) {
  const struct Routine *order = program->series->order;
  write_head(file, FUNCTION_SERIES, "", order->operation_count);
  declare_time(file, routine_uses(order, SPACE_TIME_ROW));
  if (program->series_is_unrolled) write_unrolled_orders(file, program);
  else {
    statements_declare_point(file, program, order);
    if (program->blocks.count > 0)
      fprintf(file, "  const Real *mass = w[%zu];\n  Real side[%zu];\n", program->series->mass_row,
              program->blocks.side_count);
    fputs("  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++) {\n", file);
    write_statements(file, program, order, NULL);
    fputs("  }\n", file);
  }
  fputs("}\n\n", file);
}

static void write_check(FILE *file, const struct Program *program, const struct LimitCheck *check) {
  const struct LimitFacts *facts = limit_facts(check->rule);
  fputs("  ", file);
  if (check->is_gated) {
    fputs("LIMIT_WHERE(", file);
    write_place(file, program, check->opener, VALUE, NULL);
    fputs(" > 0.0, ", file);
  }
  fprintf(file, "series_limit_%s(limit, ", facts->name);
  write_place(file, program, check->row, ROW, NULL);
  if (facts->has_two_rows) {
    fputs(", ", file);
    write_place(file, program, check->other_row, ROW, NULL);
  }
  if (facts->has_function) fprintf(file, ", \"%s\"", check->function);
  if (facts->has_exponent) {
    fputs(", ", file);
    write_place(file, program, check->exponent, VALUE, NULL);
  }
  if (facts->has_share) {
    fputs(", ", file);
    write_c_number(file, check->share);
  }
  fputs(check->is_gated ? "));\n" : ");\n", file);
}

/* The spaces that checks read. */
static uint32_t spaces_of(const struct LimitChecks *checks) {
  uint32_t spaces = 0;
  for (size_t i = 0; i < checks->count; i++) {
    const struct LimitCheck *check = &checks->items[i];
    spaces |= 1u << space_of(check->row) | 1u << space_of(check->other_row);
    if (limit_facts(check->rule)->has_exponent) spaces |= 1u << space_of(check->exponent);
    if (check->is_gated) spaces |= 1u << space_of(check->opener);
  }
  return spaces;
}

static void write_limit(FILE *file, const struct Program *program) {
  const struct LimitChecks *checks = &program->series->limit;
  const struct Routine spaces = {.spaces = spaces_of(checks)}; /* none but for its spaces */
  write_head(file, FUNCTION_LIMIT, "", checks->count);
  declare_time(file, routine_uses(&spaces, SPACE_TIME_ROW));
  statements_declare_point(file, program, &spaces);
  for (size_t i = 0; i < checks->count; i++) write_check(file, program, &checks->items[i]);
  fputs("}\n\n", file);
}

void statements_series(FILE *file, const struct Program *program) {
  if (program->series_is_unrolled) write_next_function(file, program);
  statements_function(file, program, FUNCTION_START, "", program->series->start);
  write_series(file, program);
  if (program->series->limit.count > 0) write_limit(file, program);
}

void statements_output_series(FILE *file, const struct Program *program) {
  const struct SeriesProgram *series = program->output_series;
  struct Routine both = *series->start; /* with the spaces of both, for the declarations */
  both.spaces |= series->order->spaces;
  write_head(file, FUNCTION_OUTPUT_SERIES, "", series->start->operation_count);
  declare_time(file, routine_uses(&both, SPACE_TIME_ROW));
  statements_declare_point(file, program, &both);
  if (routine_uses(&both, SPACE_ACCELERATION)) fprintf(file, "  Real a[%zu];\n", program->equations->count);
  write_statements(file, program, series->start, "y");
  fputs("  for (int k = 1; k <= order && k + 1 < SERIES_LENGTH; k++) {\n", file);
  write_statements(file, program, series->order, NULL);
  fputs("  }\n}\n\n", file);
}

void statements_watched_limit(FILE *file, const struct Program *program) {
  const struct SeriesProgram *series = program->watched_series;
  struct Routine all = *series->start; /* with the spaces of all, for the declarations */
  all.spaces |= series->order->spaces | spaces_of(&series->limit);
  write_head(file, FUNCTION_WATCHED_LIMIT, "", series->start->operation_count);
  declare_time(file, routine_uses(&all, SPACE_TIME_ROW));
  statements_declare_point(file, program, &all);
  write_statements(file, program, series->start, NULL);
  fputs("  for (int k = 1; k <= limit->order; k++) {\n", file);
  write_statements(file, program, series->order, NULL);
  fputs("  }\n", file);
  for (size_t i = 0; i < series->limit.count; i++) write_check(file, program, &series->limit.items[i]);
  fputs("}\n\n", file);
}
