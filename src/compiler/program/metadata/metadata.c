#include "program/metadata/metadata.h"

#include <math.h>

#include "base/memory.h"
#include "program/metadata/constraint_metadata.h"
#include "program/metadata/inertia_names.h"

static double value_or(double value, double otherwise) {
  return isnan(value) ? otherwise : value;
}

static const struct ScalarVariable *variables_of(const struct Interface *interface) {
  struct ScalarVariable *variables = allocate(interface->count, sizeof *variables);
  for (size_t i = 0; i < interface->count; i++) {
    variables[i] = interface->variables[i].entry;
    variables[i].start = value_or(variables[i].start, 0.0);
    variables[i].minimum = value_or(variables[i].minimum, -INFINITY);
    variables[i].maximum = value_or(variables[i].maximum, INFINITY);
  }
  return variables;
}

static void add_arrays(struct Lagrangian *metadata, const struct Interface *interface) {
  struct ArrayVariable *arrays = allocate(interface->count, sizeof *arrays);
  for (size_t i = 0; i < interface->count; i++)
    if (interface->variables[i].array_count > 0)
      arrays[metadata->array_count++] = (struct ArrayVariable){i, interface->variables[i].array_count};
  if (metadata->array_count > 0) metadata->arrays = arrays;
}

static void add_following(struct Lagrangian *metadata, const struct Interface *interface) {
  size_t *following = allocate(interface->count, sizeof *following);
  for (size_t i = 0; i < interface->count; i++)
    if (has_following_start(&interface->variables[i].entry)) following[metadata->following_count++] = i;
  if (metadata->following_count > 0) metadata->following = following;
}

static const bool *uses_of_acceleration(const struct Program *program, size_t count) {
  bool *uses = allocate(count, sizeof *uses);
  for (size_t i = 0; i < count; i++)
    uses[i] = graph_depends_on(program->model->graph, program->expressions->result[i], ACCELERATION);
  return uses;
}

static const double *nominals_of(const struct Interface *interface) {
  double *nominal = allocate(interface->state_count, sizeof *nominal);
  for (size_t i = 0; i < interface->count; i++)
    if (interface->variables[i].entry.kind == VARIABLE_STATE)
      nominal[interface->variables[i].entry.index] = value_or(interface->variables[i].nominal, 1.0);
  return nominal;
}

static const int *whole_numbers(const size_t *sizes, size_t count) {
  int *numbers = allocate(count, sizeof *numbers);
  for (size_t i = 0; i < count; i++) numbers[i] = (int)sizes[i];
  return numbers;
}

static struct LuPattern lu_pattern_of(const struct Elimination *factors, size_t rows) {
  int *slot = allocate(rows, sizeof *slot);
  for (size_t i = 0; i < rows; i++) slot[factors->order[i]] = (int)i;
  return (struct LuPattern){slot, whole_numbers(factors->start, rows + 1),
                            whole_numbers(factors->column, factors->start[rows])};
}

static struct ImplicitTable implicit_metadata_of(const struct Program *program) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  struct ImplicitTable metadata = {0};
  if (jacobian == NULL) return metadata;
  metadata.pattern =
      (struct Sparsity){jacobian->count, whole_numbers(jacobian->start, program->interface->state_count + 1),
                        whole_numbers(jacobian->row, jacobian->count)};
  if (program->lu != NULL && jacobian->factors != NULL)
    metadata.lu_pattern = lu_pattern_of(jacobian->factors, program->equations->count + program->equations->rates.count);
  return metadata;
}

static struct StepMetadata step_metadata_of(const struct Program *program) {
  const struct Model *model = program->model;
  return (struct StepMetadata){.nominal = nominals_of(program->interface),
                               .tolerance = interface_tolerance(model),
                               .max_step = value_or(model->solver.max_step, INFINITY),
                               .max_steps = interface_max_steps(model),
                               .work = program->work,
                               .operations = program->operations,
                               .depends_on_time = program->interface->depends_on_time};
}

struct Lagrangian metadata_of(const struct Program *program, size_t work_count) {
  const struct Interface *interface = program->interface;
  const struct SeriesProgram *series = program->series, *output_series = program->output_series;
  size_t scratch = program->is_table ? program->ir_functions[FUNCTION_PREPARE]->local_count : 0;
  struct Lagrangian metadata = {
      .name = program->model->name,
      .coordinate_count = program->equations->count,
      .state_count = interface->state_count,
      .input_count = program->model->inputs.count,
      .parameter_count = program->model->parameters.count + program->model->switches.mode_count,
      .parameter_constants_count = program->parameter_constants->count + scratch,
      .work_count = work_count,
      .sensitivity_count = program->model->sensitivity_count,
      .state_sensitivity_count = program->model->state_sensitivity_count,
      .variable_count = interface->count,
      .variables = variables_of(interface),
      .output_derivative_order = interface->output_derivative_order,
      .inertia_depends_on = inertia_names_of(program),
      .steps = step_metadata_of(program),
      .results = {.count = interface->result_count,
                  .uses_acceleration = uses_of_acceleration(program, interface->result_count)},
      .taylor = {.rows = series != NULL ? series->row_count : 0,
                 .output_rows = output_series != NULL ? output_series->row_count : 0},
      .implicit = implicit_metadata_of(program),
      .constraints = constraint_metadata_of(program)};
  add_arrays(&metadata, interface);
  add_following(&metadata, interface);
  return metadata;
}
