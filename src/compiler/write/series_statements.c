
#include "base/memory.h"
#include "write/c_text.h"
#include "write/instruction_text.h"
#include "write/statements.h"

static void declare_time(FILE *file, bool is_used) {
  if (is_used) fputs("  const Series time = {point->time, REAL(1.0)};\n", file);
}

/* Writes the head of the loop over orders, and the middle terms of products. */
static void begin_orders(FILE *file, const struct Program *program, size_t products) {
  size_t listed = program->products == PRODUCTS_LISTED ? write_factors(file, program, program->series->order) : 0;
  fputs("  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++) {\n", file);
  if (products > 0) fprintf(file, "    Real m[%zu];\n    SERIES_MIDDLES(SERIES_PRODUCTS);\n", products);
  if (listed > 0)
    fprintf(file, "    Real m[%zu];\n    const Real *next = m;\n    series_middles(k, %zu, factors, m);\n", listed,
            listed);
}

static void write_series(FILE *file, const struct Program *program) {
  const struct IrFunction *order = program->series->order;
  size_t products = program->products == PRODUCTS_TOGETHER ? write_products(file, program, order) : 0;
  write_head(file, FUNCTION_SERIES, "", order->operation_count);
  declare_time(file, ir_uses(order, SPACE_TIME_ROW));
  statements_declare_point(file, program, order);
  if (program->blocks.count > 0)
    fprintf(file, "  const Real *mass = w[%zu];\n  Real side[%zu];\n", program->series->mass_row,
            program->blocks.right_side_count);
  begin_orders(file, program, products);
  if (program->products == PRODUCTS_APART) write_statements(file, program, order, NULL);
  else write_statements_around(file, program, order);
  fputs("  }\n}\n\n", file);
}

static void write_check(FILE *file, const struct Program *program, const struct LimitCheck *check) {
  const struct LimitMetadata *metadata = limit_metadata(check->rule);
  fputs("  ", file);
  if (check->is_guarded) {
    fputs("LIMIT_WHERE(", file);
    write_slot(file, program, check->guard_condition, VALUE, NULL);
    fputs(" > 0.0, ", file);
  }
  fprintf(file, "series_limit_%s(limit, ", metadata->name);
  write_slot(file, program, check->row, ROW, NULL);
  if (metadata->has_two_rows) {
    fputs(", ", file);
    write_slot(file, program, check->other_row, ROW, NULL);
  }
  if (metadata->has_function) fprintf(file, ", \"%s\"", check->function);
  if (metadata->has_exponent) {
    fputs(", ", file);
    write_slot(file, program, check->exponent, VALUE, NULL);
  }
  if (metadata->has_share) {
    fputs(", ", file);
    write_c_number(file, check->share);
  }
  fputs(check->is_guarded ? "));\n" : ");\n", file);
}

/* Returns the set of spaces that the checks read. */
static uint32_t spaces_of(const struct LimitChecks *checks) {
  uint32_t spaces = 0;
  for (size_t i = 0; i < checks->count; i++) {
    const struct LimitCheck *check = &checks->items[i];
    spaces |= 1u << space_of(check->row) | 1u << space_of(check->other_row);
    if (limit_metadata(check->rule)->has_exponent) spaces |= 1u << space_of(check->exponent);
    if (check->is_guarded) spaces |= 1u << space_of(check->guard_condition);
  }
  return spaces;
}

static void write_limit(FILE *file, const struct Program *program) {
  const struct LimitChecks *checks = &program->series->limit;
  const struct IrFunction spaces = {.spaces = spaces_of(checks)}; /* has spaces, no instructions */
  write_head(file, FUNCTION_LIMIT, "", checks->count);
  declare_time(file, ir_uses(&spaces, SPACE_TIME_ROW));
  statements_declare_point(file, program, &spaces);
  for (size_t i = 0; i < checks->count; i++) write_check(file, program, &checks->items[i]);
  fputs("}\n\n", file);
}

void statements_series(FILE *file, const struct Program *program) {
  statements_function(file, program, FUNCTION_START, "", program->series->start);
  write_series(file, program);
  if (program->series->limit.count > 0) write_limit(file, program);
}

void statements_output_series(FILE *file, const struct Program *program) {
  const struct SeriesProgram *series = program->output_series;
  struct IrFunction both = *series->start; /* with the spaces of both, for the declarations */
  both.spaces |= series->order->spaces;
  write_head(file, FUNCTION_OUTPUT_SERIES, "", series->start->operation_count);
  declare_time(file, ir_uses(&both, SPACE_TIME_ROW));
  statements_declare_point(file, program, &both);
  if (ir_uses(&both, SPACE_ACCELERATION)) fprintf(file, "  Real a[%zu];\n", program->equations->count);
  write_statements(file, program, series->start, "y");
  fputs("  for (int k = 1; k <= order && k + 1 < SERIES_LENGTH; k++) {\n", file);
  write_statements(file, program, series->order, NULL);
  fputs("  }\n}\n\n", file);
}

void statements_watched_limit(FILE *file, const struct Program *program) {
  const struct SeriesProgram *series = program->watched_series;
  struct IrFunction all = *series->start; /* with the spaces of all, for the declarations */
  all.spaces |= series->order->spaces | spaces_of(&series->limit);
  write_head(file, FUNCTION_WATCHED_LIMIT, "", series->start->operation_count);
  declare_time(file, ir_uses(&all, SPACE_TIME_ROW));
  statements_declare_point(file, program, &all);
  write_statements(file, program, series->start, NULL);
  fputs("  for (int k = 1; k <= limit->order; k++) {\n", file);
  write_statements(file, program, series->order, NULL);
  fputs("  }\n", file);
  for (size_t i = 0; i < series->limit.count; i++) write_check(file, program, &series->limit.items[i]);
  fputs("}\n\n", file);
}
