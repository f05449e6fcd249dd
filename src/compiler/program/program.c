#include "program/program.h"

#include "base/memory.h"
#include "program/codegen/regions.h"
#include "program/costs.h"

/*
 * Lengths, in instructions, above which functions become tables, as compile time grows faster than linearly with the
 * length of a function. STATEMENT_LIMIT instructions compile in a second or two, a table of them in a fraction of one.
 * The derivatives and the series get higher limits, since their statements run in a fifth and in three quarters of the
 * time of their tables. Code of kinematic trees, and directional derivatives that give the columns of a Jacobian, are
 * written as several functions, whose compile time grows linearly.
 */
enum {
  STATEMENT_LIMIT = 6000,
  SERIES_STATEMENT_LIMIT = 8000,
  DERIVATIVES_STATEMENT_LIMIT = 20000,
  TREE_STATEMENT_LIMIT = 200000,
  DIRECTIONAL_STATEMENT_LIMIT = 40000
};

/* Up to this many recurrences an order, one loop computes all products; a longer one exceeds the instruction cache. */
enum { RECURRENCES_TOGETHER = 40 };

static void create_results(struct Program *program, struct CodeGenerator *generator) {
  const struct Interface *interface = program->interface;
  const struct Expressions *expressions = program->expressions;
  program->groups = result_groups_of(expressions);
  program->result = allocate(interface->result_count, sizeof(struct IrFunction *));
  program->result_along = allocate(interface->result_count, sizeof(struct IrFunction *));
  for (size_t i = 0; i < interface->count; i++) {
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    if (entry->kind != VARIABLE_RESULT) continue;
    size_t index = entry->index;
    if (program->groups.leader[index] == index) {
      struct NodeList members = group_members(&program->groups, expressions->result, index);
      program->result[index] = ir_of_targets(generator, members.nodes, members.count);
    }
    if (is_unknown(entry))
      program->result_along[index] = ir_of_targets(generator, &expressions->result_along[index], 1);
  }
}

/* A method that takes only the first terms needs the series for the step limits; without limits it needs none. */
static void create_series(struct Program *program, struct CodeGenerator *generator) {
  const struct Expressions *expressions = program->expressions;
  if (expressions->series != NULL) program->series = series_program_of_motion(expressions, &program->blocks, generator);
  if (program->series != NULL && program->equations->method->series != ALL_TERMS && program->series->limit.count == 0)
    program->series = NULL;
  if (expressions->output_series != NULL) program->output_series = series_program_of_outputs(expressions, generator);
  if (expressions->watched_series != NULL) program->watched_series = series_program_of_watched(expressions, generator);
}

static void visit_series(const struct SeriesProgram *series, enum FunctionName start, enum FunctionName order,
                         IrVisitor *visit, void *context) {
  if (series != NULL && series->start != NULL) visit(context, start, series->start);
  if (series != NULL && series->order != NULL) visit(context, order, series->order);
}

void program_visit(const struct Program *program, IrVisitor *visit, void *context) {
  for (enum FunctionName i = 0; i < IR_FUNCTION_COUNT; i++)
    if (program->ir_functions[i] != NULL) visit(context, i, program->ir_functions[i]);
  for (size_t i = 0; i < program->interface->result_count; i++) {
    if (program->result[i] != NULL) visit(context, FUNCTION_RESULT, program->result[i]);
    if (program->result_along[i] != NULL) visit(context, FUNCTION_RESULT_ALONG, program->result_along[i]);
  }
  visit_series(program->series, FUNCTION_START, FUNCTION_SERIES, visit, context);
  visit_series(program->output_series, FUNCTION_OUTPUT_SERIES, FUNCTION_OUTPUT_SERIES, visit, context);
  visit_series(program->watched_series, FUNCTION_WATCHED_LIMIT, FUNCTION_WATCHED_LIMIT, visit, context);
}

static void add_count(void *context, enum FunctionName name, const struct IrFunction *ir) {
  size_t *count = context;
  if (name != FUNCTION_LINEAR) *count += ir->count;
}

size_t instruction_count(const struct Program *program) {
  size_t count = 0;
  program_visit(program, add_count, &count);
  return count;
}

static size_t count_of(const struct IrFunction *ir) {
  return ir != NULL ? ir->count : 0;
}

bool program_solves_by_statements(const struct Program *program, size_t number) {
  /* rows up to which unrolled code is short */
  enum { ROWS = 3 };
  const struct InertiaBlock *block = program->blocks.items[number].block;
  return !program->is_table && block->count <= ROWS && block->constraint_count > 0 && block->force_count == 0;
}

/* True if the columns of the Jacobian are directional derivatives that can be written as several functions. */
static bool has_columns_in_parts(const struct Program *program) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  return jacobian != NULL && jacobian->value == NULL && program->blocks.count == 0;
}

/* True if a table skips most of the function where its conditions fail, which statements would compute. */
static bool is_mostly_regions(const struct IrFunction *ir) {
  return ir != NULL && 2 * regions_length(ir) > ir->count;
}

static void choose_form(struct Program *program, enum CodeForm form) {
  const struct SeriesProgram *series = program->series;
  size_t length = series != NULL ? count_of(series->start) + count_of(series->order) : 0;
  bool all = form == TABLES || form == ALL_TABLES;
  program->is_table = all || (form == BY_SIZE && instruction_count(program) > STATEMENT_LIMIT);
  size_t switch_length = 0;
  for (enum FunctionName i = LAGRANGIAN_IR_FUNCTIONS; i < IR_FUNCTION_COUNT; i++)
    switch_length += count_of(program->ir_functions[i]);
  program->switches_are_table =
      form == ALL_TABLES || (form == BY_SIZE && program->is_table && switch_length > STATEMENT_LIMIT);
  program->series_is_table = all || (program->is_table && length > SERIES_STATEMENT_LIMIT);
  if (series != NULL && program->equations->method->series == ALL_TERMS)
    program->products = series->recurrences <= RECURRENCES_TOGETHER ? PRODUCTS_TOGETHER : PRODUCTS_LISTED;
  size_t limit = inertia_has_trees(program->equations->inertia) ? TREE_STATEMENT_LIMIT : DERIVATIVES_STATEMENT_LIMIT;
  const struct IrFunction *derivatives = program->ir_functions[FUNCTION_DERIVATIVES],
                          *directional = program->ir_functions[FUNCTION_DIRECTIONAL];
  program->derivatives_are_table =
      all || (program->is_table && (count_of(derivatives) > limit || is_mostly_regions(derivatives)));
  bool is_long = count_of(directional) > DIRECTIONAL_STATEMENT_LIMIT || is_mostly_regions(directional);
  program->directional_is_table = all || (program->is_table && (is_long || !has_columns_in_parts(program)));
}

static void choose_parts_of_runtime(struct Program *program) {
  const struct Method *method = program->equations->method;
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  if (method == NULL) return;
  program->solver = method_solver(method, program->interface->state_count, jacobian != NULL ? jacobian->count : 0);
  if (method->factors) program->lu = jacobian != NULL && jacobian->factors != NULL ? "lu_sparse" : "lu_dense";
  program->work = step_work_of(program);
  if (method->series == ALL_TERMS) program->operations = operation_counts_of(program);
}

struct Program *program_create(const struct Expressions *expressions, enum CodeForm form) {
  struct Program *program = allocate(1, sizeof *program);
  *program = (struct Program){.model = expressions->model,
                              .equations = expressions->equations,
                              .interface = expressions->interface,
                              .expressions = expressions};
  struct NodeList targets = expressions_targets(expressions);
  program->parameter_constants = parameter_constants_create(expressions->model->graph, targets);
  program->blocks = looped_blocks_of(expressions->equations);
  struct CodeGenerator *generator =
      generator_create(expressions->model->graph, program->parameter_constants, expressions->equations->count);
  for (enum FunctionName i = 0; i < IR_FUNCTION_COUNT; i++)
    if (has_function(program, i)) program->ir_functions[i] = generated_functions[i].build(program, generator);
  create_results(program, generator);
  create_series(program, generator);
  choose_form(program, form);
  choose_parts_of_runtime(program);
  return program;
}
